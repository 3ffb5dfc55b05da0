//! Verdicts proved over boxes against verdicts at points of them by methods that know no closed form.

mod flows;
mod solids;

use crate::support::states::{RandomNumbers, seeded_generator};
use models::common::scalar::Scalar;
use models::common::taylor_model::TaylorModel;
use rayon::prelude::*;
use wellposed_analysis::certified::BoxVerdict;
use wellposed_analysis::growth::Verdict;

/// A number that runs over an interval along an axis of the box, or that is constant.
#[derive(Clone, Copy, Debug)]
struct BoxNumber {
    low: f64,
    high: f64,
    axis: Option<usize>,
}

impl BoxNumber {
    /// The interval of the same size about `value`.
    fn moved_to(self, value: f64) -> Self {
        let half = 0.5 * (self.high - self.low);
        Self { low: value - half, high: value + half, ..self }
    }

    fn enclose(self) -> TaylorModel {
        match self.axis {
            Some(axis) => TaylorModel::parameter(axis, self.low, self.high),
            None => TaylorModel::from_rounded(self.low),
        }
    }

    /// The value at a point (u, v) of the square.
    fn at(self, point: [f64; 2]) -> f64 {
        let place = self.axis.map_or(0.0, |axis| 0.5 * (1.0 + point[axis]));
        (self.low + (self.high - self.low) * place).clamp(self.low, self.high)
    }
}

/// Draws `N` numbers within `ranges`, of which two run over intervals of the size `half`, in parts of the ranges.
fn draw_box<const N: usize>(
    random: &mut RandomNumbers,
    ranges: [[f64; 2]; N],
    half: f64,
) -> [BoxNumber; N] {
    let first = random.uniform_index(N);
    let second = (first + 1 + random.uniform_index(N - 1)) % N;
    std::array::from_fn(|index| {
        let [low, high] = ranges[index];
        let axis = [first, second].iter().position(|&own| own == index);
        let half = if axis.is_some() { half * (high - low) } else { 0.0 };
        let value = random.uniform(low + half, high - half);
        BoxNumber { low: (value - half).max(low), high: (value + half).min(high), axis }
    })
}

fn random_point(random: &mut RandomNumbers) -> [f64; 2] {
    // Corners and edges as often as the inside.
    [0; 2].map(|_| random.uniform(-1.5, 1.5).clamp(-1.0, 1.0))
}

/// Half the size of a box: none, or of any magnitude up to a twentieth.
fn random_half(random: &mut RandomNumbers) -> f64 {
    if random.bernoulli(0.1) { 0.0 } else { random.log_uniform(1e-9, 0.05) }
}

/// The verdict proved over a box, and the verdict of the other method at a point (u, v) of it, `None` without a state.
struct BoxSample<'a> {
    proved: BoxVerdict,
    verdict_at: Box<dyn FnMut([f64; 2]) -> Option<Verdict> + 'a>,
}

/// Numbers of boxes by certified verdict, and of points in decided boxes by the verdict of the other method.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    well_posed: usize,
    ill_posed: usize,
    open: usize,
    points: usize,
    marginal: usize,
}

impl Counts {
    fn add(self, other: Self) -> Self {
        Self {
            well_posed: self.well_posed + other.well_posed,
            ill_posed: self.ill_posed + other.ill_posed,
            open: self.open + other.open,
            points: self.points + other.points,
            marginal: self.marginal + other.marginal,
        }
    }

    fn boxes(&self) -> usize {
        self.well_posed + self.ill_posed + self.open
    }
}

/// Verifies that no verdict at `points` points of each decided box contradicts the certified verdict, for `boxes` boxes.
fn compare(
    seed: u64,
    [boxes, points]: [usize; 2],
    draw: impl Fn(&mut RandomNumbers) -> BoxSample<'static> + Sync,
) -> Counts {
    let assess_box = |index: u64| {
        let random = &mut seeded_generator((seed << 32) + index);
        let mut sample = draw(random);
        let mut counts = Counts::default();
        match sample.proved {
            BoxVerdict::WellPosed => counts.well_posed = 1,
            BoxVerdict::IllPosed => counts.ill_posed = 1,
            BoxVerdict::NotDecided => {
                counts.open = 1;
                return counts;
            }
        }
        counts.points = points;
        for _ in 0..points {
            let point = random_point(random);
            let found = (sample.verdict_at)(point);
            let agrees = match (&found, sample.proved) {
                (Some(Verdict::Marginal { .. }), _) => {
                    counts.marginal += 1;
                    true
                }
                (Some(Verdict::WellPosed), BoxVerdict::WellPosed)
                | (Some(Verdict::IllPosed { .. }), BoxVerdict::IllPosed) => true,
                _ => false,
            };
            assert!(agrees, "{seed}, box {index}: {:?} at {point:?}: {found:?}", sample.proved);
        }
        counts
    };
    (0..boxes as u64).into_par_iter().map(assess_box).reduce(Counts::default, Counts::add)
}

/// A family of boxes, with the share of all points that it takes, and the least shares of its boxes that must be proved
/// well-posed and ill-posed, in percent.
struct Family {
    name: &'static str,
    draw: fn(&mut RandomNumbers) -> BoxSample<'static>,
    share: f64,
    least: [usize; 2],
}

/// Compares all families at `points` points or more of decided boxes.
fn compare_families(points: usize) {
    const POINTS_PER_BOX: usize = 8;
    let mut all = Counts::default();
    for (seed, family) in flows::FAMILIES.iter().chain(&solids::FAMILIES).enumerate() {
        let least_decided = (family.least[0] + family.least[1]) as f64 / 100.0;
        let wanted = family.share * points as f64 / least_decided;
        let boxes = (wanted / POINTS_PER_BOX as f64).ceil() as usize;
        let counts = compare(seed as u64, [boxes, POINTS_PER_BOX], family.draw);
        println!("{}: {counts:?}", family.name);
        let [well_posed, ill_posed] = family.least.map(|percent| percent * counts.boxes());
        assert!(100 * counts.well_posed >= well_posed, "{}: {counts:?}", family.name);
        assert!(100 * counts.ill_posed >= ill_posed, "{}: {counts:?}", family.name);
        // The other method decides most points, too.
        assert!(10 * counts.marginal < counts.points, "{}: {counts:?}", family.name);
        all = all.add(counts);
    }
    println!("all: {all:?}");
    assert!(all.points >= points, "{all:?}");
}

#[test]
fn verdicts_proved_over_boxes_hold_at_their_points() {
    compare_families(10_000);
}

#[test]
#[ignore = "takes minutes"]
fn verdicts_proved_over_boxes_hold_at_a_million_points() {
    compare_families(1_000_000);
}
