//! Systems whose growth is known by construction.

use crate::support::planted::{C, Part, T, X, Y, system};
use models::LinearisedSystem;

/// Expected verdict on a planted system.
#[derive(Clone, Copy, Debug)]
pub enum Wanted {
    Bounded,
    /// Order, coefficient and, if unique, direction in degrees.
    Grows(f64, f64, Option<f64>),
    /// Unbounded at finite wave numbers, in the direction in degrees.
    BlowsUp(f64),
    /// Rank.
    Indeterminate(usize),
}
use Wanted::{BlowsUp, Bounded, Grows, Indeterminate};

/// Row, column, derivative and coefficient.
pub type Entries = Vec<(usize, usize, Part, f64)>;

/// Cyclic matrix with diagonal entries d and entries s next to the diagonal, of determinant ∏ dᵢ + (−1)^(n+1) ∏ sᵢ.
/// Each entry is a list of terms.
fn cycle(diagonal: &[&[(Part, f64)]], next: &[&[(Part, f64)]]) -> (usize, Entries) {
    let n = diagonal.len();
    let mut entries = Vec::new();
    for i in 0..n {
        entries.extend(diagonal[i].iter().map(|&(part, x)| (i, i, part, x)));
        entries.extend(next[i].iter().map(|&(part, x)| (i, (i + 1) % n, part, x)));
    }
    (n, entries)
}

type Term = (Part, f64);

/// ∂ₜ, ∂₁ and 1.
const ELEMENTARY_TERMS: [&[Term]; 3] = [&[(T, 1.0)], &[(X, 1.0)], &[(C, 1.0)]];
/// ∂ₜ + ∂₁.
const MOVING: &[Term] = &[(T, 1.0), (X, 1.0)];

fn minus(part: Part) -> [Term; 1] {
    [(part, -1.0)]
}

/// The coefficient of growth of order 1/3.
fn third() -> f64 {
    (3f64).sqrt() / 2.0
}

/// Name, system and expected verdict.
type Planted = (&'static str, LinearisedSystem<2>, Wanted);

struct Systems(Vec<Planted>);

impl Systems {
    fn square(&mut self, name: &'static str, (n, entries): (usize, Entries), wanted: Wanted) {
        self.0.push((name, system(n, n, &entries), wanted));
    }
}

/// Transport and heat: orders 0 and 2.
fn parabolic(list: &mut Systems) {
    // ς + κ₁ = 0
    list.square("transport", (1, vec![(0, 0, T, 1.0), (0, 0, X, 1.0)]), Bounded);
    list.square("decay", (1, vec![(0, 0, T, 1.0), (0, 0, C, 5.0)]), Bounded);
    list.square("order 0", (1, vec![(0, 0, T, 1.0), (0, 0, C, -5.0)]), Bounded);
    // ς ∓ (κ₁² + κ₂²) = 0
    let heat = |sign: f64| {
        let mut e: Entries = vec![(0, 0, T, 1.0)];
        for (i, part) in [(1, X), (2, Y)] {
            e.extend([(0, i, part, 1.0), (i, 0, part, sign), (i, i, C, 1.0)]);
        }
        (3, e)
    };
    list.square("heat", heat(1.0), Bounded);
    list.square("backward heat", heat(-1.0), Grows(2.0, 1.0, None));
    let mut mixed = heat(1.0);
    mixed.1[4] = (0, 2, Y, -3.0);
    list.square("heat along x, backward along y", mixed, Grows(2.0, 3.0, Some(90.0)));
}

/// Wave equations with damping, feeding terms and advection, and elliptic counterparts.
fn hyperbolic(list: &mut Systems) {
    let [t, x, _] = ELEMENTARY_TERMS;
    // ς² = κ² and ς² = −κ² in one and two dimensions.
    let wave: Entries = vec![
        (0, 0, T, 1.0),
        (1, 1, T, 1.0),
        (2, 2, T, 1.0),
        (0, 1, X, 1.0),
        (1, 0, X, 1.0),
        (0, 2, Y, 1.0),
        (2, 0, Y, 1.0),
    ];
    list.square("acoustics", (3, wave.clone()), Bounded);
    // In an obliquely moving frame every power of ς occurs and every root is imaginary.
    let mut carried = wave.clone();
    for i in 0..3 {
        carried.extend([(i, i, X, 0.3), (i, i, Y, -0.7)]);
    }
    list.square("acoustics carried along", (3, carried), Bounded);
    let mut damped = wave.clone();
    damped.extend([(0, 0, C, 0.7), (1, 1, C, 0.2)]);
    list.square("damped acoustics", (3, damped), Bounded);
    let mut fed = wave.clone();
    fed.extend([(0, 0, C, -0.7), (1, 2, C, 0.4), (2, 1, C, 0.9)]);
    list.square("acoustics with feeding terms of order 0", (3, fed), Bounded);
    list.square("wave equation in one dimension", cycle(&[t, t], &[x, x]), Bounded);
    list.square("telegraph equation", cycle(&[&[(T, 1.0), (C, 1.0)], t], &[x, x]), Bounded);
    list.square(
        "Cauchy–Riemann in time",
        cycle(&[t, t], &[&minus(X), x]),
        Grows(1.0, 1.0, Some(0.0)),
    );
    // ς² + κ₁² + 4 κ₂²: elliptic Cauchy problem.
    let mut elliptic = wave;
    elliptic[4] = (1, 0, X, -1.0);
    elliptic[6] = (2, 0, Y, -4.0);
    list.square("elliptic Cauchy problem", (3, elliptic), Grows(1.0, 2.0, Some(90.0)));
}

/// Other orders of growth, and neutral counterparts.
fn orders(list: &mut Systems) {
    let [t, x, one] = ELEMENTARY_TERMS;
    // ς² + κ³, ς³ + κ², ς² + κ, ς³ + κ, ς⁵ + κ²
    list.square("order 3/2", cycle(&[t, t, one], &[x, x, x]), Grows(1.5, 0.5f64.sqrt(), Some(0.0)));
    list.square("order 2/3", cycle(&[t, t, t], &[x, x, one]), Grows(2.0 / 3.0, 1.0, Some(0.0)));
    list.square(
        "order 1/2",
        cycle(&[t, t], &[&minus(X), one]),
        Grows(0.5, 0.5f64.sqrt(), Some(0.0)),
    );
    list.square(
        "order 1/3",
        cycle(&[t, t, t], &[x, one, one]),
        Grows(1.0 / 3.0, third(), Some(0.0)),
    );
    list.square(
        "order 2/5",
        cycle(&[t, t, t, t, t], &[x, x, one, one, one]),
        Grows(0.4, 1.0, Some(0.0)),
    );
    // ς = κ₁³κ₂: largest at 30°. ς² = κ⁶ and −κ⁶; ς + κ³ is dispersive only.
    let four = 3.0 * 3f64.sqrt() / 16.0;
    list.square(
        "order 4",
        cycle(&[t, one, one, one], &[x, x, x, &[(Y, 1.0)]]),
        Grows(4.0, four, Some(30.0)),
    );
    list.square(
        "order 3",
        cycle(&[t, t, one, one, one, one], &[x, x, x, x, x, &minus(X)]),
        Grows(3.0, 1.0, Some(0.0)),
    );
    list.square("waves of order 3", cycle(&[t, t, one, one, one, one], &[x; 6]), Bounded);
    list.square("dispersion of order 3", cycle(&[t, one, one], &[x, x, x]), Bounded);
}

/// Repeated roots and terms that split them.
fn repeated_roots(list: &mut Systems) {
    let [t, x, one] = ELEMENTARY_TERMS;
    // (ς + κ)² + ε² κ²: the real part is a small fraction of the root.
    for (name, e) in [("a hundredth real", 1e-2), ("a thousandth real", 1e-3)] {
        let (s, minus): (&[_], &[_]) = (&[(X, e)], &[(X, -e)]);
        list.square(name, cycle(&[MOVING, MOVING], &[s, minus]), Grows(1.0, e, Some(0.0)));
    }
    // (ς + κ)(ς² + κ²): even and odd powers of κ occur.
    let mut apart = cycle(&[t, t], &[&minus(X), x]);
    apart.0 = 3;
    apart.1.extend([(2, 2, T, 1.0), (2, 2, X, 1.0)]);
    list.square("transport beside Cauchy–Riemann", apart, Grows(1.0, 1.0, Some(0.0)));
    // (ς + κ)² + κ: a repeated real root split at order 1/2; (ς + κ)² + 1: not split.
    list.square(
        "weakly hyperbolic",
        cycle(&[MOVING, MOVING], &[&minus(X), one]),
        Grows(0.5, 0.5f64.sqrt(), Some(0.0)),
    );
    list.square("repeated but bounded", cycle(&[MOVING, MOVING], &[&minus(C), one]), Bounded);
    list.square("two equal transports", cycle(&[MOVING, MOVING], &[&[], &[]]), Bounded);
    // (ς + κ)³ + κ: order 1/3.
    list.square(
        "triple root split at order 1/3",
        cycle(&[MOVING, MOVING, MOVING], &[x, one, one]),
        Grows(1.0 / 3.0, third(), Some(0.0)),
    );
    // (ς + κ)³ + κ²
    list.square(
        "triple root split at order 2/3",
        cycle(&[MOVING, MOVING, MOVING], &[x, x, one]),
        Grows(2.0 / 3.0, 1.0, Some(0.0)),
    );
}

/// Dispersive waves with growth or decay of the next order.
fn beams(list: &mut Systems) {
    let [t, x, one] = ELEMENTARY_TERMS;
    // ς² + κ⁴ = 0: dispersive waves; ς² + κ⁴ + c κ³: dispersive waves with growth c k/2.
    list.square("beam", cycle(&[t, t, one, one], &[x, x, x, &minus(X)]), Bounded);
    list.square(
        "beam with growth of order 1",
        cycle(&[t, t, one, one], &[x, x, x, &[(X, -1.0), (C, -0.5)]]),
        Grows(1.0, 0.25, Some(0.0)),
    );
    // Leading roots neutral, decay at the next order.
    list.square(
        "beam with decay",
        cycle(&[&[(T, 1.0), (C, 0.3)], &[(T, 1.0), (C, 0.3)], one, one], &[x, x, x, &minus(X)]),
        Bounded,
    );
}

/// Incompressible flow, of index 2.
fn incompressible(list: &mut Systems) {
    // Euler equations.
    let euler: Entries = vec![
        (0, 0, T, 1.0),
        (1, 1, T, 1.0),
        (0, 2, X, 1.0),
        (1, 2, Y, 1.0),
        (2, 0, X, 1.0),
        (2, 1, Y, 1.0),
    ];
    list.square("incompressible Euler", (3, euler.clone()), Bounded);
    let mut darcy = euler.clone();
    darcy.extend([(0, 0, C, 2.0), (1, 1, C, 2.0), (0, 1, C, 1.0)]);
    list.square("incompressible with drag", (3, darcy), Bounded);
    // Stokes: gradients s = ∇v as further unknowns.
    let stokes = |sign: f64| {
        let mut e = euler.clone();
        for (i, first) in [(0, 3), (1, 5)] {
            for (j, part) in [(0, X), (1, Y)] {
                let s = first + j;
                e.extend([(i, s, part, -sign), (s, i, part, -1.0), (s, s, C, 1.0)]);
            }
        }
        (7, e)
    };
    list.square("Stokes", stokes(1.0), Bounded);
    list.square("backward Stokes", stokes(-1.0), Grows(2.0, 1.0, None));
}

/// Few time derivatives or none, and roots that are unbounded at finite wave numbers.
fn no_time_derivative(list: &mut Systems) {
    let [_, x, one] = ELEMENTARY_TERMS;
    // No time derivative at all.
    list.square("elliptic, no time", cycle(&[x, x], &[&[(Y, 1.0)], &[(Y, -1.0)]]), Bounded);
    list.square("algebraic", cycle(&[one, one], &[&[(C, 0.5)], &[(C, -0.5)]]), Bounded);
    // ς(1 − κ₁²) + κ₂² = 0: order 2 in one direction only.
    list.square(
        "growth in one direction alone",
        (
            3,
            vec![
                (0, 0, T, 1.0),
                (0, 1, Y, 1.0),
                (1, 0, Y, -1.0),
                (1, 1, C, 1.0),
                (1, 2, X, 1.0),
                (2, 1, X, 1.0),
                (2, 2, C, 1.0),
            ],
        ),
        Grows(2.0, 1.0, Some(90.0)),
    );
    // ς κ₁ + κ₂ = 0: ς = −tan θ; ς κ₁ = κ₂²: imaginary roots of unbounded size.
    list.square(
        "tangent",
        (2, vec![(0, 0, T, 1.0), (0, 1, C, 1.0), (1, 0, Y, -1.0), (1, 1, X, 1.0)]),
        BlowsUp(90.0),
    );
    list.square(
        "waves of unbounded speed",
        (2, vec![(0, 0, T, 1.0), (0, 1, Y, 1.0), (1, 0, Y, 1.0), (1, 1, X, 1.0)]),
        Bounded,
    );
}

/// Equations that do not determine the unknowns.
fn singular(list: &mut Systems) {
    // Singular: equal rows; a zero column; a dependent row.
    list.square(
        "equal rows",
        (2, vec![(0, 0, T, 1.0), (0, 1, X, 2.0), (1, 0, T, 1.0), (1, 1, X, 2.0)]),
        Indeterminate(1),
    );
    list.square(
        "an unknown that nothing names",
        (2, vec![(0, 0, T, 1.0), (1, 0, X, 1.0)]),
        Indeterminate(1),
    );
    list.0.push((
        "two equations for three",
        system(2, 3, &[(0, 0, T, 1.0), (1, 1, T, 1.0), (0, 2, X, 1.0)]),
        Indeterminate(2),
    ));
    list.0.push((
        "three equations for two",
        system(3, 2, &[(0, 0, T, 1.0), (1, 1, T, 1.0), (2, 0, X, 1.0)]),
        Indeterminate(2),
    ));
}

/// All systems.
pub fn planted() -> Vec<Planted> {
    let mut list = Systems(Vec::new());
    for add in [
        parabolic,
        hyperbolic,
        orders,
        repeated_roots,
        beams,
        incompressible,
        no_time_derivative,
        singular,
    ] {
        add(&mut list);
    }
    list.0
}
