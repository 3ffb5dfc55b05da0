//! Systems whose growth is known by construction.

use crate::support::system_entries::{C, DerivativeOperator, T, X, Y, build_system};
use models::LinearisedSystem;

/// Expected verdict on a system whose growth is known.
#[derive(Clone, Copy, Debug)]
pub enum ExpectedVerdict {
    /// Bounded growth: well-posed.
    Bounded,
    /// Unbounded growth: order, coefficient and, if unique, direction in degrees.
    Growth(f64, f64, Option<f64>),
    /// Unbounded at finite wave numbers, in the direction in degrees.
    UnboundedAtFiniteWaveNumber(f64),
    /// Rank of the pencil.
    Indeterminate(usize),
}
use ExpectedVerdict::{Bounded, Growth, Indeterminate, UnboundedAtFiniteWaveNumber};

/// Entries of a system: row, column, derivative operator and coefficient of each.
pub type SystemEntries = Vec<(usize, usize, DerivativeOperator, f64)>;

/// Cyclic matrix with diagonal entries d and entries s next to the diagonal, of determinant ∏ dᵢ + (−1)^(n+1) ∏ sᵢ.
/// Each entry is a list of terms.
fn cyclic_system(
    diagonal: &[&[(DerivativeOperator, f64)]],
    next: &[&[(DerivativeOperator, f64)]],
) -> (usize, SystemEntries) {
    let n = diagonal.len();
    let mut entries = Vec::new();
    for i in 0..n {
        entries.extend(diagonal[i].iter().map(|&(part, x)| (i, i, part, x)));
        entries.extend(next[i].iter().map(|&(part, x)| (i, (i + 1) % n, part, x)));
    }
    (n, entries)
}

type OperatorTerm = (DerivativeOperator, f64);

/// Entries of a single operator: ∂ₜ, ∂₁ and 1.
const ELEMENTARY_TERMS: [&[OperatorTerm]; 3] = [&[(T, 1.0)], &[(X, 1.0)], &[(C, 1.0)]];
/// Entry ∂ₜ + ∂₁ of the transport equation.
const TRANSPORT_TERMS: &[OperatorTerm] = &[(T, 1.0), (X, 1.0)];

fn negated_term(part: DerivativeOperator) -> [OperatorTerm; 1] {
    [(part, -1.0)]
}

/// Coefficient √3/2 of growth of order 1/3: the largest real part of a cube root of −i.
fn order_one_third_coefficient() -> f64 {
    (3f64).sqrt() / 2.0
}

/// Name, linearised system and expected verdict.
type KnownSystem = (&'static str, LinearisedSystem<2>, ExpectedVerdict);

struct KnownSystemList(Vec<KnownSystem>);

impl KnownSystemList {
    fn push_square(
        &mut self,
        name: &'static str,
        (n, entries): (usize, SystemEntries),
        wanted: ExpectedVerdict,
    ) {
        self.0.push((name, build_system(n, n, &entries), wanted));
    }
}

/// Adds transport and heat equations: orders of growth 0 and 2.
fn add_parabolic(list: &mut KnownSystemList) {
    // Dispersion relations of the first three systems: ς + κ₁ = 0, ς + 5 = 0, ς − 5 = 0.
    list.push_square("transport", (1, vec![(0, 0, T, 1.0), (0, 0, X, 1.0)]), Bounded);
    list.push_square("decay", (1, vec![(0, 0, T, 1.0), (0, 0, C, 5.0)]), Bounded);
    list.push_square("order 0", (1, vec![(0, 0, T, 1.0), (0, 0, C, -5.0)]), Bounded);
    // Dispersion relations ς ∓ (κ₁² + κ₂²) = 0.
    let heat = |sign: f64| {
        let mut e: SystemEntries = vec![(0, 0, T, 1.0)];
        for (i, part) in [(1, X), (2, Y)] {
            e.extend([(0, i, part, 1.0), (i, 0, part, sign), (i, i, C, 1.0)]);
        }
        (3, e)
    };
    list.push_square("heat", heat(1.0), Bounded);
    list.push_square("backward heat", heat(-1.0), Growth(2.0, 1.0, None));
    let mut mixed = heat(1.0);
    mixed.1[4] = (0, 2, Y, -3.0);
    list.push_square("heat along x, backward along y", mixed, Growth(2.0, 3.0, Some(90.0)));
}

/// Adds wave equations with damping, sources and advection, and elliptic counterparts.
fn add_hyperbolic(list: &mut KnownSystemList) {
    let [t, x, _] = ELEMENTARY_TERMS;
    // Dispersion relations ς² = κ² and ς² = −κ² in one and two dimensions.
    let wave: SystemEntries = vec![
        (0, 0, T, 1.0),
        (1, 1, T, 1.0),
        (2, 2, T, 1.0),
        (0, 1, X, 1.0),
        (1, 0, X, 1.0),
        (0, 2, Y, 1.0),
        (2, 0, Y, 1.0),
    ];
    list.push_square("acoustics", (3, wave.clone()), Bounded);
    // In an obliquely moving frame every power of ς occurs and every root is imaginary.
    let mut carried = wave.clone();
    for i in 0..3 {
        carried.extend([(i, i, X, 0.3), (i, i, Y, -0.7)]);
    }
    list.push_square("acoustics carried along", (3, carried), Bounded);
    let mut damped = wave.clone();
    damped.extend([(0, 0, C, 0.7), (1, 1, C, 0.2)]);
    list.push_square("damped acoustics", (3, damped), Bounded);
    let mut fed = wave.clone();
    fed.extend([(0, 0, C, -0.7), (1, 2, C, 0.4), (2, 1, C, 0.9)]);
    list.push_square("acoustics with feeding terms of order 0", (3, fed), Bounded);
    list.push_square("wave equation in one dimension", cyclic_system(&[t, t], &[x, x]), Bounded);
    list.push_square(
        "telegraph equation",
        cyclic_system(&[&[(T, 1.0), (C, 1.0)], t], &[x, x]),
        Bounded,
    );
    list.push_square(
        "Cauchy–Riemann in time",
        cyclic_system(&[t, t], &[&negated_term(X), x]),
        Growth(1.0, 1.0, Some(0.0)),
    );
    // Dispersion polynomial ς² + κ₁² + 4 κ₂² of an elliptic Cauchy problem.
    let mut elliptic = wave;
    elliptic[4] = (1, 0, X, -1.0);
    elliptic[6] = (2, 0, Y, -4.0);
    list.push_square("elliptic Cauchy problem", (3, elliptic), Growth(1.0, 2.0, Some(90.0)));
}

/// Adds systems with other orders of growth, from 1/3 to 4, and neutral counterparts.
fn add_other_orders(list: &mut KnownSystemList) {
    let [t, x, one] = ELEMENTARY_TERMS;
    // Dispersion polynomials of the next five systems: ς² + κ³, ς³ + κ², ς² + κ, ς³ + κ, ς⁵ + κ².
    list.push_square(
        "order 3/2",
        cyclic_system(&[t, t, one], &[x, x, x]),
        Growth(1.5, 0.5f64.sqrt(), Some(0.0)),
    );
    list.push_square(
        "order 2/3",
        cyclic_system(&[t, t, t], &[x, x, one]),
        Growth(2.0 / 3.0, 1.0, Some(0.0)),
    );
    list.push_square(
        "order 1/2",
        cyclic_system(&[t, t], &[&negated_term(X), one]),
        Growth(0.5, 0.5f64.sqrt(), Some(0.0)),
    );
    list.push_square(
        "order 1/3",
        cyclic_system(&[t, t, t], &[x, one, one]),
        Growth(1.0 / 3.0, order_one_third_coefficient(), Some(0.0)),
    );
    list.push_square(
        "order 2/5",
        cyclic_system(&[t, t, t, t, t], &[x, x, one, one, one]),
        Growth(0.4, 1.0, Some(0.0)),
    );
    // Dispersion polynomials of the next four systems: ς − κ₁³κ₂, with the largest growth at 30°; ς² + κ⁶; ς² − κ⁶ and
    // ς + κ³, which have imaginary roots only.
    let four = 3.0 * 3f64.sqrt() / 16.0;
    list.push_square(
        "order 4",
        cyclic_system(&[t, one, one, one], &[x, x, x, &[(Y, 1.0)]]),
        Growth(4.0, four, Some(30.0)),
    );
    list.push_square(
        "order 3",
        cyclic_system(&[t, t, one, one, one, one], &[x, x, x, x, x, &negated_term(X)]),
        Growth(3.0, 1.0, Some(0.0)),
    );
    list.push_square(
        "waves of order 3",
        cyclic_system(&[t, t, one, one, one, one], &[x; 6]),
        Bounded,
    );
    list.push_square("dispersion of order 3", cyclic_system(&[t, one, one], &[x, x, x]), Bounded);
}

/// Adds systems with repeated roots, and with terms that split them.
fn add_repeated_roots(list: &mut KnownSystemList) {
    let [t, x, one] = ELEMENTARY_TERMS;
    // Dispersion polynomial (ς + κ)² + e²κ²: the real part of a root is a small fraction e of its modulus.
    for (name, e) in [("a hundredth real", 1e-2), ("a thousandth real", 1e-3)] {
        let (s, minus): (&[_], &[_]) = (&[(X, e)], &[(X, -e)]);
        list.push_square(
            name,
            cyclic_system(&[TRANSPORT_TERMS, TRANSPORT_TERMS], &[s, minus]),
            Growth(1.0, e, Some(0.0)),
        );
    }
    // Dispersion polynomial (ς + κ)(ς² + κ²): even and odd powers of κ occur.
    let mut apart = cyclic_system(&[t, t], &[&negated_term(X), x]);
    apart.0 = 3;
    apart.1.extend([(2, 2, T, 1.0), (2, 2, X, 1.0)]);
    list.push_square("transport beside Cauchy–Riemann", apart, Growth(1.0, 1.0, Some(0.0)));
    // Dispersion polynomials of the next two systems: (ς + κ)² + κ, whose repeated root is split at order 1/2; (ς + κ)²
    // + 1, whose roots differ by a constant.
    list.push_square(
        "weakly hyperbolic",
        cyclic_system(&[TRANSPORT_TERMS, TRANSPORT_TERMS], &[&negated_term(X), one]),
        Growth(0.5, 0.5f64.sqrt(), Some(0.0)),
    );
    list.push_square(
        "repeated but bounded",
        cyclic_system(&[TRANSPORT_TERMS, TRANSPORT_TERMS], &[&negated_term(C), one]),
        Bounded,
    );
    list.push_square(
        "two equal transports",
        cyclic_system(&[TRANSPORT_TERMS, TRANSPORT_TERMS], &[&[], &[]]),
        Bounded,
    );
    // Dispersion polynomial (ς + κ)³ + κ: order 1/3.
    list.push_square(
        "triple root split at order 1/3",
        cyclic_system(&[TRANSPORT_TERMS, TRANSPORT_TERMS, TRANSPORT_TERMS], &[x, one, one]),
        Growth(1.0 / 3.0, order_one_third_coefficient(), Some(0.0)),
    );
    // Dispersion polynomial (ς + κ)³ + κ²: order 2/3.
    list.push_square(
        "triple root split at order 2/3",
        cyclic_system(&[TRANSPORT_TERMS, TRANSPORT_TERMS, TRANSPORT_TERMS], &[x, x, one]),
        Growth(2.0 / 3.0, 1.0, Some(0.0)),
    );
}

/// Adds dispersive waves whose growth or decay is of the order next to the leading one.
fn add_dispersive(list: &mut KnownSystemList) {
    let [t, x, one] = ELEMENTARY_TERMS;
    // Dispersion polynomials of the next two systems: ς² + κ⁴, dispersive waves; ς² + κ⁴ + c κ³, dispersive waves with
    // growth c k/2.
    list.push_square(
        "beam",
        cyclic_system(&[t, t, one, one], &[x, x, x, &negated_term(X)]),
        Bounded,
    );
    list.push_square(
        "beam with growth of order 1",
        cyclic_system(&[t, t, one, one], &[x, x, x, &[(X, -1.0), (C, -0.5)]]),
        Growth(1.0, 0.25, Some(0.0)),
    );
    // The roots are neutral to leading order and decay at the next order.
    list.push_square(
        "beam with decay",
        cyclic_system(
            &[&[(T, 1.0), (C, 0.3)], &[(T, 1.0), (C, 0.3)], one, one],
            &[x, x, x, &negated_term(X)],
        ),
        Bounded,
    );
}

/// Adds incompressible flows, whose pencils have index 2.
fn add_incompressible(list: &mut KnownSystemList) {
    // Euler equations.
    let euler: SystemEntries = vec![
        (0, 0, T, 1.0),
        (1, 1, T, 1.0),
        (0, 2, X, 1.0),
        (1, 2, Y, 1.0),
        (2, 0, X, 1.0),
        (2, 1, Y, 1.0),
    ];
    list.push_square("incompressible Euler", (3, euler.clone()), Bounded);
    let mut darcy = euler.clone();
    darcy.extend([(0, 0, C, 2.0), (1, 1, C, 2.0), (0, 1, C, 1.0)]);
    list.push_square("incompressible with drag", (3, darcy), Bounded);
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
    list.push_square("Stokes", stokes(1.0), Bounded);
    list.push_square("backward Stokes", stokes(-1.0), Growth(2.0, 1.0, None));
}

/// Adds systems with few or no time derivatives, and with roots that are unbounded at finite wave numbers.
fn add_no_time_derivative(list: &mut KnownSystemList) {
    let [_, x, one] = ELEMENTARY_TERMS;
    // No time derivative at all.
    list.push_square(
        "elliptic, no time",
        cyclic_system(&[x, x], &[&[(Y, 1.0)], &[(Y, -1.0)]]),
        Bounded,
    );
    list.push_square(
        "algebraic",
        cyclic_system(&[one, one], &[&[(C, 0.5)], &[(C, -0.5)]]),
        Bounded,
    );
    // Dispersion relation ς(1 − κ₁²) + κ₂² = 0: growth of order 2 in one direction only.
    list.push_square(
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
        Growth(2.0, 1.0, Some(90.0)),
    );
    // Dispersion relations of the next two systems: ς κ₁ + κ₂ = 0, ς = −tan θ; ς κ₁ = κ₂², imaginary roots of unbounded
    // modulus.
    list.push_square(
        "tangent",
        (2, vec![(0, 0, T, 1.0), (0, 1, C, 1.0), (1, 0, Y, -1.0), (1, 1, X, 1.0)]),
        UnboundedAtFiniteWaveNumber(90.0),
    );
    list.push_square(
        "waves of unbounded speed",
        (2, vec![(0, 0, T, 1.0), (0, 1, Y, 1.0), (1, 0, Y, 1.0), (1, 1, X, 1.0)]),
        Bounded,
    );
}

/// Adds systems whose equations do not determine the unknowns.
fn add_singular(list: &mut KnownSystemList) {
    // Equal rows; a zero column; fewer equations than unknowns; more equations than unknowns.
    list.push_square(
        "equal rows",
        (2, vec![(0, 0, T, 1.0), (0, 1, X, 2.0), (1, 0, T, 1.0), (1, 1, X, 2.0)]),
        Indeterminate(1),
    );
    list.push_square(
        "an unknown that nothing names",
        (2, vec![(0, 0, T, 1.0), (1, 0, X, 1.0)]),
        Indeterminate(1),
    );
    list.0.push((
        "two equations for three",
        build_system(2, 3, &[(0, 0, T, 1.0), (1, 1, T, 1.0), (0, 2, X, 1.0)]),
        Indeterminate(2),
    ));
    list.0.push((
        "three equations for two",
        build_system(3, 2, &[(0, 0, T, 1.0), (1, 1, T, 1.0), (2, 0, X, 1.0)]),
        Indeterminate(2),
    ));
}

/// All systems whose growth is known by construction.
pub fn known_systems() -> Vec<KnownSystem> {
    let mut list = KnownSystemList(Vec::new());
    for add in [
        add_parabolic,
        add_hyperbolic,
        add_other_orders,
        add_repeated_roots,
        add_dispersive,
        add_incompressible,
        add_no_time_derivative,
        add_singular,
    ] {
        add(&mut list);
    }
    list.0
}
