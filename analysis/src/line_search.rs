//! One-dimensional searches: golden section, bisection, and sectors in which a predicate holds.

/// Inverse (√5 − 1)/2 of the golden ratio.
const GOLDEN_RATIO_INVERSE: f64 = 0.618_033_988_749_894_9;

/// Bracketing interval of a maximum after golden-section search.
pub(crate) struct Bracket {
    ends: [f64; 2],
    /// The two inner points: [value, position].
    inner_points: [[f64; 2]; 2],
}

impl Bracket {
    /// Midpoint of the bracketing interval.
    pub(crate) fn midpoint(&self) -> f64 {
        0.5 * (self.ends[0] + self.ends[1])
    }

    /// The larger of the two inner values, and its position.
    pub(crate) fn best_point(&self) -> [f64; 2] {
        let [x, y] = self.inner_points;
        if x[0] >= y[0] { x } else { y }
    }
}

/// Golden-section search: narrows the interval [a, b] around the maximum of a unimodal function in at most `steps`
/// steps, or until its length is at most `tolerance` (|a| + |b|).
pub(crate) fn search_golden_section(
    f: impl Fn(f64) -> f64,
    [mut a, mut b]: [f64; 2],
    steps: usize,
    tolerance: Option<f64>,
) -> Bracket {
    let at = |x: f64| [f(x), x];
    let (mut x, mut y) =
        (at(b - GOLDEN_RATIO_INVERSE * (b - a)), at(a + GOLDEN_RATIO_INVERSE * (b - a)));
    for _ in 0..steps {
        if tolerance.is_some_and(|tolerance| b - a <= tolerance * (a.abs() + b.abs())) {
            break;
        }
        if x[0] >= y[0] {
            (b, y) = (y[1], x);
            x = at(b - GOLDEN_RATIO_INVERSE * (b - a));
        } else {
            (a, x) = (x[1], y);
            y = at(a + GOLDEN_RATIO_INVERSE * (b - a));
        }
    }
    Bracket { ends: [a, b], inner_points: [x, y] }
}

/// Position of the maximum of a unimodal function in [a, b], to within 1e-12 (|a| + |b|).
pub(crate) fn argmax_unimodal(f: impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    /// Maximum number of steps; they shrink the interval to 3e-13 of its initial length.
    const MAX_STEPS: usize = 60;
    search_golden_section(f, [a, b], MAX_STEPS, Some(1e-12)).midpoint()
}

/// Bisects [low, high] `steps` times around a point at which `predicate` changes.
pub(crate) fn bisect(
    [mut low, mut high]: [f64; 2],
    steps: usize,
    predicate: impl Fn(f64) -> bool,
) -> [f64; 2] {
    let was = predicate(low);
    for _ in 0..steps {
        let middle = 0.5 * (low + high);
        if predicate(middle) == was { low = middle } else { high = middle }
    }
    [low, high]
}

/// Sectors of a period in which a predicate holds, as first and last angle; ends are refined by `bisections` bisections
/// between each of the `samples` and the angle a `step` later. The last sector may end beyond the period. If the
/// predicate is the same at all samples: the whole period if it holds, else no sector.
pub(crate) fn find_sectors(
    samples: impl Iterator<Item = f64>,
    step: f64,
    period: f64,
    bisections: usize,
    predicate: impl Fn(f64) -> bool,
) -> Vec<[f64; 2]> {
    let is_edge = |&angle: &f64| predicate(angle) != predicate(angle + step);
    let edge = |angle: f64| {
        let [low, high] = bisect([angle, angle + step], bisections, &predicate);
        (0.5 * (low + high), !predicate(angle))
    };
    let edges: Vec<(f64, bool)> = samples.filter(is_edge).map(edge).collect();
    let Some(first) = edges.first() else {
        return if predicate(0.0) { vec![[0.0, period]] } else { Vec::new() };
    };
    let after = edges.iter().skip(1).map(|edge| edge.0).chain([first.0 + period]);
    let sectors = edges.iter().zip(after).filter(|((_, begins), _)| *begins);
    sectors.map(|(&(from, _), to)| [from, to]).collect()
}
