//! Verdicts against closed forms and against systems whose growth is known by construction.

mod support;

use models::LinearisedSystem;
use models::flow::double_shearing::parameters::DoubleShearing;
use models::flow::harris_grekova::parameters::HarrisGrekova;
use models::flow::plastic_potential::parameters::PlasticPotential;
use models::flow::state::State;
use models::registry;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use support::brute::{brute, degenerate_directions};
use support::exact::{DispersionReference, WideSystem};
use support::planted::{C, Part, T, X, Y, system};
use support::states::{Dilatancy, Sample, seeded, tame, wild};
use testkit::flows::Parameters;
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;

fn judge(system: &LinearisedSystem<2>) -> Verdict {
    let mut pencil = Pencil::default();
    pencil.update(system).expect("finite coefficients");
    assess(&pencil).verdict
}

/// (order, coefficient, direction) of an ill-posed verdict.
fn growth(verdict: &Verdict) -> (f64, f64, f64) {
    match verdict {
        Verdict::IllPosed { growth: Some(g), direction } => {
            (g.order.value(), g.coefficient, *direction)
        }
        other => panic!("{other:?}"),
    }
}

fn angle_between(a: f64, b: f64) -> f64 {
    let gap = (a - b).rem_euclid(PI);
    gap.min(PI - gap)
}

/// The greatest value of a function of an angle of period π, by a fine scan and a shrinking grid.
fn greatest(f: impl Fn(f64) -> f64) -> (f64, f64) {
    let mut best = (f64::NEG_INFINITY, 0.0);
    let (mut centre, mut width) = (FRAC_PI_2, FRAC_PI_2);
    for round in 0..14 {
        let steps = if round == 0 { 20_000 } else { 40 };
        for n in -steps..=steps {
            let angle = centre + width * f64::from(n) / f64::from(steps);
            let value = f(angle);
            if value > best.0 {
                best = (value, angle);
            }
        }
        (centre, width) = (best.1, 4.0 * width / f64::from(steps));
    }
    best
}

/// With another non-coaxiality.
fn turned(sample: &Sample, noncoaxiality: f64) -> Sample {
    let state = State { noncoaxiality: Some(noncoaxiality), ..sample.state };
    Sample::new(sample.kind(), sample.parameters, state)
}

/// Harris–Grekova with ν = 0: ill-posed 1e-9 degrees beyond 45 degrees, well-posed as much
/// before, marginal in between; with and without gradients, in units far from 1.
#[test]
fn harris_grekova_flips_at_45_degrees() {
    for seed in 0..200 {
        let random = &mut seeded(0x45 + seed);
        let sample = if seed.is_multiple_of(2) {
            tame(random, registry::HARRIS_GREKOVA, Dilatancy::Zero, seed.is_multiple_of(4))
        } else {
            wild(random, registry::HARRIS_GREKOVA, Dilatancy::Zero)
        };
        for sign in [1.0, -1.0] {
            let at = |degrees: f64| judge(&turned(&sample, sign * degrees.to_radians()).system);
            let inside = at(45.0 - 1e-9);
            assert_eq!(inside, Verdict::WellPosed, "seed {seed}: {:?}", sample.state);
            let (order, coefficient, _) = growth(&at(45.0 + 1e-9));
            assert!(order == 2.0 && coefficient > 0.0);
            assert_eq!(at(45.0).name(), "marginal", "seed {seed}");
        }
    }
}

/// Order, coefficient and direction against the closed forms, maximised here: to 1e-9.
#[test]
fn coefficients_and_directions_are_those_of_the_closed_forms() {
    let mut worst = [0.0f64; 3];
    for seed in 0..300 {
        let random = &mut seeded(0xc1 + seed);
        let wide_range = seed.is_multiple_of(3);
        let mut sample = |kind, dilatancy| {
            let gradients = seed.is_multiple_of(2);
            if wide_range {
                wild(random, kind, dilatancy)
            } else {
                tame(random, kind, dilatancy, gradients)
            }
        };
        let beta = |s: &Sample, angle: f64| 2.0 * (s.state.stress_angle - angle);

        // Beyond its bound, where it grows.
        let s = sample(registry::HARRIS_GREKOVA, Dilatancy::Zero);
        let s = turned(
            &s,
            s.flow.noncoaxiality.signum() * (FRAC_PI_2 - 0.3 * s.flow.noncoaxiality.abs()),
        );
        let constants = s.parameters.constants(registry::HARRIS_GREKOVA);
        let own = HarrisGrekova::from_constants(&constants).expect("in range");
        let (q, rho, rate) = (s.flow.stress.deviator.value, s.flow.density, s.flow.shear_rate);
        let exact =
            |a: f64| own.leading_coefficient(q, rho, rate, s.flow.noncoaxiality, beta(&s, a));
        let mut check = |slot: usize, order: f64, sample: &Sample, exact: &dyn Fn(f64) -> f64| {
            let (wanted, _) = greatest(exact);
            let (found_order, coefficient, direction) = growth(&judge(&sample.system));
            assert_eq!(found_order, order, "seed {seed}: {sample:?}");
            let error =
                (coefficient / wanted - 1.0).abs().max((exact(direction) / wanted - 1.0).abs());
            assert!(
                error < 1e-9,
                "seed {seed}: {coefficient:e}, {wanted:e}, off by {error:e}: {sample:?}"
            );
            worst[slot] = worst[slot].max(error);
        };
        check(0, 2.0, &s, &exact);

        let s = sample(registry::DOUBLE_SHEARING, Dilatancy::Zero);
        let constants = s.parameters.constants(registry::DOUBLE_SHEARING);
        let own = DoubleShearing::from_constants(&constants).expect("in range");
        let (q, rho) = (s.flow.stress.deviator.value, s.flow.density);
        check(1, 1.0, &s, &|a| own.leading_coefficient(q, rho, beta(&s, a)));

        let dilatancy = if seed.is_multiple_of(2) { Dilatancy::Zero } else { Dilatancy::Positive };
        let s = sample(registry::PLASTIC_POTENTIAL, dilatancy);
        let constants = s.parameters.constants(registry::PLASTIC_POTENTIAL);
        let own = PlasticPotential::from_constants(&constants).expect("in range");
        let (q, rho, rate) = (s.flow.stress.deviator.value, s.flow.density, s.flow.shear_rate);
        let exact = |a: f64| own.leading_coefficient(q, rho, rate, beta(&s, a));
        // Where the sector is wide enough for this file's own search.
        if (s.parameters.friction_angle - s.parameters.dilatancy_angle).abs() > 0.05 {
            check(2, 2.0, &s, &exact);
            let (rate, cosine) = own.worst(q, rho, rate);
            let (_, coefficient, direction) = growth(&judge(&s.system));
            assert!((coefficient / rate - 1.0).abs() < 1e-9);
            assert!((beta(&s, direction).cos() - cosine).abs() < 1e-7);
        }
    }
    println!(
        "greatest deviations: Harris–Grekova {:.1e}, double shearing {:.1e}, plastic potential {:.1e}",
        worst[0], worst[1], worst[2]
    );
}

/// Sectors of growth between ν and φ however thin, both for ν < φ and for ν > φ, and none at ν = φ.
#[test]
fn plastic_potential_down_to_thin_sectors() {
    let mut worst = 0.0f64;
    for seed in 0..60 {
        let random = &mut seeded(0x55 + seed);
        let base = tame(random, registry::PLASTIC_POTENTIAL, Dilatancy::Associated, false);
        let phi = base.parameters.friction_angle;
        for gap in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9, -1e-2, -1e-4, -1e-6, -1e-9] {
            let parameters = Parameters { dilatancy_angle: phi - gap, ..base.parameters };
            let sample = Sample::new(registry::PLASTIC_POTENTIAL, parameters, base.state);
            let (order, coefficient, direction) = growth(&judge(&sample.system));
            assert_eq!(order, 2.0);
            let constants = sample.parameters.constants(registry::PLASTIC_POTENTIAL);
            let own = PlasticPotential::from_constants(&constants).expect("in range");
            let (q, rho, rate) =
                (sample.flow.stress.deviator.value, sample.flow.density, sample.flow.shear_rate);
            let (wanted, cosine) = own.worst(q, rho, rate);
            let error = (coefficient / wanted - 1.0).abs();
            // The angles leave that many digits of their difference.
            assert!(error < 1e-9 + 1e-14 / gap.abs(), "{gap:e}: {coefficient:e} for {wanted:e}");
            if gap.abs() >= 1e-3 {
                worst = worst.max(error);
            }
            let beta = 2.0 * (sample.state.stress_angle - direction);
            assert!((beta.cos() - cosine).abs() < gap.abs(), "{gap:e}: outside the sector");
        }
        let verdict = judge(&base.system);
        assert_ne!(verdict.name(), "ill-posed", "associated, uniform: {verdict:?}");
    }
    println!("greatest deviation of the coefficient down to 1e-3 rad: {worst:.1e}");
}

/// The bounds of the sectors of growth: from the closed form to 1e-12 rad, where the leading growth
/// rate changes sign; from the linearised equations to 1e-8 rad, and nothing beside them.
#[test]
fn bounds_of_the_sectors_of_growth() {
    let mut worst = 0.0f64;
    for seed in 0..200 {
        let random = &mut seeded(0x5ec + seed);
        let base = tame(random, registry::PLASTIC_POTENTIAL, Dilatancy::Associated, seed % 2 == 0);
        let phi = base.parameters.friction_angle;
        for gap in [1e-1, 1e-3, 1e-6, -1e-2, -1e-6] {
            let parameters = Parameters { dilatancy_angle: phi - gap, ..base.parameters };
            let sample = Sample::new(registry::PLASTIC_POTENTIAL, parameters, base.state);
            let constants = sample.parameters.constants(registry::PLASTIC_POTENTIAL);
            let own = PlasticPotential::from_constants(&constants).expect("in range");
            let sector = own.sector();
            let inside = 0.5 * (sector[0] + sector[1]);
            for bound in sector {
                let outwards = (bound - inside).signum() * 1e-12;
                let rate = |beta: f64| own.leading_coefficient(1.0, 1.0, 1.0, beta);
                assert!(rate(bound - outwards) > 0.0 && rate(bound + outwards) < 0.0, "{gap:e}");
            }
            let mut pencil = Pencil::default();
            pencil.update(&sample.system).expect("finite coefficients");
            let found = assess(&pencil);
            assert_eq!(growth(&found.verdict).0, 2.0, "{gap:e}: {found:?}");
            for beta in sector.into_iter().flat_map(|b| [b, -b]) {
                let wanted = sample.state.stress_angle - 0.5 * beta;
                let error = found
                    .degenerate
                    .iter()
                    .map(|d| angle_between(d.angle, wanted))
                    .fold(f64::MAX, f64::min);
                assert!(error < 1e-8, "{gap:e}: off by {error:e}: {:?}", found.degenerate);
                worst = worst.max(error);
            }
        }
    }
    println!("greatest deviation of a bound: {worst:.1e} rad");
}

/// ν = φ on a uniform background in the widest ranges.
#[test]
fn associated_uniform_is_never_ill_posed() {
    let mut counts = std::collections::BTreeMap::<&str, usize>::new();
    for seed in 0..500 {
        let random = &mut seeded(0xa5 + seed);
        let sample = wild(random, registry::PLASTIC_POTENTIAL, Dilatancy::Associated);
        let state = State {
            pressure_gradient: [0.0; 2],
            stress_angle_gradient: [0.0; 2],
            density_gradient: [0.0; 2],
            ..sample.state
        };
        let sample = Sample::new(registry::PLASTIC_POTENTIAL, sample.parameters, state);
        let verdict = judge(&sample.system);
        assert_ne!(verdict.name(), "ill-posed", "{verdict:?}: {sample:?}");
        *counts.entry(verdict.name()).or_default() += 1;
    }
    println!("{counts:?}");
}

/// Harris–Grekova with ν > 0 on a uniform background without rotational stress: the bound on |Δ|,
/// 1e-9 degrees either side; just beyond it growth without bound at finite k, at the angle where
/// the highest coefficient has its double zero; far beyond, where that coefficient has one sign
/// again, order 2.
#[test]
fn dilatant_harris_grekova_flips_at_its_bound() {
    let mut names = std::collections::BTreeMap::<&str, usize>::new();
    for seed in 0..200 {
        let random = &mut seeded(0xd1 + seed);
        let base = tame(random, registry::HARRIS_GREKOVA, Dilatancy::Positive, false);
        let parameters = Parameters { rotational_strength: Some(0.0), ..base.parameters };
        let state = State { velocity: [0.0; 2], ..base.state };
        let base = Sample::new(registry::HARRIS_GREKOVA, parameters, state);
        let bound = base.model.noncoaxiality_bound().expect("this model has one");
        let (phi, nu) = (parameters.friction_angle, parameters.dilatancy_angle);
        for sign in [1.0, -1.0] {
            let at = |delta: f64| judge(&turned(&base, sign * delta).system);
            let inside = at(bound - 1e-9f64.to_radians());
            *names.entry(inside.name()).or_default() += 1;
            assert_eq!(inside, Verdict::WellPosed, "seed {seed}: {base:?}");
            let beyond = at(bound + 1e-9f64.to_radians());
            let Verdict::IllPosed { growth: None, direction } = beyond else {
                panic!("seed {seed}, just beyond: {beyond:?}")
            };
            // cos 2Δ cos ν [X − Y cos β] + sin 2Δ Z sin β touches zero where its slope does:
            // cos β = Y/X.
            let beta = 2.0 * (base.state.stress_angle - direction);
            let (x, y) =
                ((phi - nu).cos() + nu.sin() * phi.sin(), phi.sin() * (phi - nu).cos() + nu.sin());
            assert!((beta.cos() - y / x).abs() < 1e-4, "seed {seed}: {} for {}", beta.cos(), y / x);
            // In between, at some finite distance.
            assert!(matches!(
                at(0.5 * (bound + FRAC_PI_4)),
                Verdict::IllPosed { growth: None, .. }
            ));
            assert!(matches!(
                at(FRAC_PI_2 - 0.5 * (bound + FRAC_PI_4)),
                Verdict::IllPosed { growth: None, .. }
            ));
            let (order, _, _) = growth(&at(FRAC_PI_2 - 0.9 * bound));
            assert_eq!(order, 2.0);
        }
    }
    println!("just inside: {names:?}");
}

/// One equation too few: indeterminate, with the rank.
#[test]
fn free_rotating_is_indeterminate() {
    for dilatancy in [Dilatancy::Zero, Dilatancy::Positive] {
        for seed in 0..100 {
            let random = &mut seeded(0xf1 + seed);
            let sample = wild(random, registry::FREE_ROTATING, dilatancy);
            let unknowns = sample.system.unknowns.len();
            let wanted = Verdict::Indeterminate { rank: unknowns - 1, unknowns };
            assert_eq!(judge(&sample.system), wanted, "{sample:?}");
        }
    }
}

/// What a planted system is to be found to be.
#[derive(Clone, Copy, Debug)]
enum Wanted {
    Bounded,
    /// Order, coefficient and, where there is only one, direction in degrees.
    Grows(f64, f64, Option<f64>),
    /// Unbounded at finite wave numbers, in the direction in degrees.
    BlowsUp(f64),
    /// Rank.
    Indeterminate(usize),
}
use Wanted::{BlowsUp, Bounded, Grows, Indeterminate};

type Entries = Vec<(usize, usize, Part, f64)>;

/// ∏ dᵢ + (−1)^(n+1) ∏ sᵢ: a cycle with diagonal entries d and the next ones s. Each entry is a
/// list of terms.
fn cycle(diagonal: &[&[(Part, f64)]], next: &[&[(Part, f64)]]) -> (usize, Entries) {
    let n = diagonal.len();
    let mut entries = Vec::new();
    for i in 0..n {
        entries.extend(diagonal[i].iter().map(|&(part, x)| (i, i, part, x)));
        entries.extend(next[i].iter().map(|&(part, x)| (i, (i + 1) % n, part, x)));
    }
    (n, entries)
}

fn planted() -> Vec<(&'static str, LinearisedSystem<2>, Wanted)> {
    let mut list: Vec<(&'static str, LinearisedSystem<2>, Wanted)> = Vec::new();
    let mut square = |name, (n, entries): (usize, Entries), wanted| {
        list.push((name, system(n, n, &entries), wanted));
    };
    let (t, x, one): (&[_], &[_], &[_]) = (&[(T, 1.0)], &[(X, 1.0)], &[(C, 1.0)]);
    let minus = |part| [(part, -1.0)];
    let moving: &[_] = &[(T, 1.0), (X, 1.0)];

    // ς + κ₁ = 0
    square("transport", (1, vec![(0, 0, T, 1.0), (0, 0, X, 1.0)]), Bounded);
    square("decay", (1, vec![(0, 0, T, 1.0), (0, 0, C, 5.0)]), Bounded);
    square("order 0", (1, vec![(0, 0, T, 1.0), (0, 0, C, -5.0)]), Bounded);
    // ς ∓ (κ₁² + κ₂²) = 0
    let heat = |sign: f64| {
        let mut e: Entries = vec![(0, 0, T, 1.0)];
        for (i, part) in [(1, X), (2, Y)] {
            e.extend([(0, i, part, 1.0), (i, 0, part, sign), (i, i, C, 1.0)]);
        }
        (3, e)
    };
    square("heat", heat(1.0), Bounded);
    square("backward heat", heat(-1.0), Grows(2.0, 1.0, None));
    let mut mixed = heat(1.0);
    mixed.1[4] = (0, 2, Y, -3.0);
    square("heat along x, backward along y", mixed, Grows(2.0, 3.0, Some(90.0)));
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
    square("acoustics", (3, wave.clone()), Bounded);
    // In a frame that moves obliquely every power of ς is there, and every root imaginary.
    let mut carried = wave.clone();
    for i in 0..3 {
        carried.extend([(i, i, X, 0.3), (i, i, Y, -0.7)]);
    }
    square("acoustics carried along", (3, carried), Bounded);
    let mut damped = wave.clone();
    damped.extend([(0, 0, C, 0.7), (1, 1, C, 0.2)]);
    square("damped acoustics", (3, damped), Bounded);
    let mut fed = wave.clone();
    fed.extend([(0, 0, C, -0.7), (1, 2, C, 0.4), (2, 1, C, 0.9)]);
    square("acoustics with feeding terms of order 0", (3, fed), Bounded);
    square("wave equation in one dimension", cycle(&[t, t], &[x, x]), Bounded);
    square("telegraph equation", cycle(&[&[(T, 1.0), (C, 1.0)], t], &[x, x]), Bounded);
    square("Cauchy–Riemann in time", cycle(&[t, t], &[&minus(X), x]), Grows(1.0, 1.0, Some(0.0)));
    // ς² + κ₁² + 4 κ₂²: elliptic Cauchy problem.
    let mut elliptic = wave;
    elliptic[4] = (1, 0, X, -1.0);
    elliptic[6] = (2, 0, Y, -4.0);
    square("elliptic Cauchy problem", (3, elliptic), Grows(1.0, 2.0, Some(90.0)));
    // ς² + κ³, ς³ + κ², ς² + κ, ς³ + κ, ς⁵ + κ²
    let third = (3f64).sqrt() / 2.0;
    square("order 3/2", cycle(&[t, t, one], &[x, x, x]), Grows(1.5, 0.5f64.sqrt(), Some(0.0)));
    square("order 2/3", cycle(&[t, t, t], &[x, x, one]), Grows(2.0 / 3.0, 1.0, Some(0.0)));
    square("order 1/2", cycle(&[t, t], &[&minus(X), one]), Grows(0.5, 0.5f64.sqrt(), Some(0.0)));
    square("order 1/3", cycle(&[t, t, t], &[x, one, one]), Grows(1.0 / 3.0, third, Some(0.0)));
    square(
        "order 2/5",
        cycle(&[t, t, t, t, t], &[x, x, one, one, one]),
        Grows(0.4, 1.0, Some(0.0)),
    );
    // ς = κ₁³κ₂: greatest at 30°. ς² = κ⁶ and −κ⁶; ς + κ³ only disperses.
    let four = 3.0 * 3f64.sqrt() / 16.0;
    square(
        "order 4",
        cycle(&[t, one, one, one], &[x, x, x, &[(Y, 1.0)]]),
        Grows(4.0, four, Some(30.0)),
    );
    square(
        "order 3",
        cycle(&[t, t, one, one, one, one], &[x, x, x, x, x, &minus(X)]),
        Grows(3.0, 1.0, Some(0.0)),
    );
    square("waves of order 3", cycle(&[t, t, one, one, one, one], &[x; 6]), Bounded);
    square("dispersion of order 3", cycle(&[t, one, one], &[x, x, x]), Bounded);
    // (ς + κ)² + ε² κ²: the real part is a small share of the root.
    for (name, e) in [("a hundredth real", 1e-2), ("a thousandth real", 1e-3)] {
        let (s, minus): (&[_], &[_]) = (&[(X, e)], &[(X, -e)]);
        square(name, cycle(&[moving, moving], &[s, minus]), Grows(1.0, e, Some(0.0)));
    }
    // (ς + κ)(ς² + κ²): odd powers of κ meet.
    let mut apart = cycle(&[t, t], &[&minus(X), x]);
    apart.0 = 3;
    apart.1.extend([(2, 2, T, 1.0), (2, 2, X, 1.0)]);
    square("transport beside Cauchy–Riemann", apart, Grows(1.0, 1.0, Some(0.0)));
    // (ς + κ)² + κ: a repeated real root split at order 1/2; (ς + κ)² + 1: not split.
    square(
        "weakly hyperbolic",
        cycle(&[moving, moving], &[&minus(X), one]),
        Grows(0.5, 0.5f64.sqrt(), Some(0.0)),
    );
    square("repeated but bounded", cycle(&[moving, moving], &[&minus(C), one]), Bounded);
    square("two equal transports", cycle(&[moving, moving], &[&[], &[]]), Bounded);
    // (ς + κ)² − κ² / … with a third order: (ς + κ)³ + κ: order 1/3.
    square(
        "triple root split at order 1/3",
        cycle(&[moving, moving, moving], &[x, one, one]),
        Grows(1.0 / 3.0, third, Some(0.0)),
    );
    // (ς + κ)³ + κ²
    square(
        "triple root split at order 2/3",
        cycle(&[moving, moving, moving], &[x, x, one]),
        Grows(2.0 / 3.0, 1.0, Some(0.0)),
    );
    // ς² + κ⁴ = 0: dispersive waves; ς² + κ⁴ + c κ³: growth c k/2 upon them.
    square("beam", cycle(&[t, t, one, one], &[x, x, x, &minus(X)]), Bounded);
    square(
        "beam with growth of order 1",
        cycle(&[t, t, one, one], &[x, x, x, &[(X, -1.0), (C, -0.5)]]),
        Grows(1.0, 0.25, Some(0.0)),
    );
    // Neutral leading root, next order decays.
    square(
        "beam with decay",
        cycle(&[&[(T, 1.0), (C, 0.3)], &[(T, 1.0), (C, 0.3)], one, one], &[x, x, x, &minus(X)]),
        Bounded,
    );
    // Incompressible flow: index 2.
    let euler: Entries = vec![
        (0, 0, T, 1.0),
        (1, 1, T, 1.0),
        (0, 2, X, 1.0),
        (1, 2, Y, 1.0),
        (2, 0, X, 1.0),
        (2, 1, Y, 1.0),
    ];
    square("incompressible Euler", (3, euler.clone()), Bounded);
    let mut darcy = euler.clone();
    darcy.extend([(0, 0, C, 2.0), (1, 1, C, 2.0), (0, 1, C, 1.0)]);
    square("incompressible with drag", (3, darcy), Bounded);
    // Stokes: stress s = ∇v as further unknowns, u − ∂₁s₁ − ∂₂s₂ …
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
    square("Stokes", stokes(1.0), Bounded);
    square("backward Stokes", stokes(-1.0), Grows(2.0, 1.0, None));
    // No time derivative at all.
    square("elliptic, no time", cycle(&[x, x], &[&[(Y, 1.0)], &[(Y, -1.0)]]), Bounded);
    square("algebraic", cycle(&[one, one], &[&[(C, 0.5)], &[(C, -0.5)]]), Bounded);
    // ς(1 − κ₁²) + κ₂² = 0: order 2 in one direction alone.
    square(
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
    // ς κ₁ + κ₂ = 0: −tan θ; ς κ₁ = κ₂²: an imaginary root however large.
    square(
        "tangent",
        (2, vec![(0, 0, T, 1.0), (0, 1, C, 1.0), (1, 0, Y, -1.0), (1, 1, X, 1.0)]),
        BlowsUp(90.0),
    );
    square(
        "waves of unbounded speed",
        (2, vec![(0, 0, T, 1.0), (0, 1, Y, 1.0), (1, 0, Y, 1.0), (1, 1, X, 1.0)]),
        Bounded,
    );
    // Singular: equal rows; a zero column; a dependent row.
    square(
        "equal rows",
        (2, vec![(0, 0, T, 1.0), (0, 1, X, 2.0), (1, 0, T, 1.0), (1, 1, X, 2.0)]),
        Indeterminate(1),
    );
    square(
        "an unknown that nothing names",
        (2, vec![(0, 0, T, 1.0), (1, 0, X, 1.0)]),
        Indeterminate(1),
    );
    list.push((
        "two equations for three",
        system(2, 3, &[(0, 0, T, 1.0), (1, 1, T, 1.0), (0, 2, X, 1.0)]),
        Indeterminate(2),
    ));
    list.push((
        "three equations for two",
        system(3, 2, &[(0, 0, T, 1.0), (1, 1, T, 1.0), (2, 0, X, 1.0)]),
        Indeterminate(2),
    ));
    list
}

/// Whether a verdict is the wanted one; `None` if it asserts nothing.
fn fulfils(verdict: &Verdict, wanted: Wanted) -> Option<bool> {
    Some(match (verdict, wanted) {
        (Verdict::Marginal { .. }, _) => return None,
        (Verdict::WellPosed, Bounded) => true,
        (Verdict::IllPosed { growth: Some(g), direction }, Grows(order, coefficient, at)) => {
            g.order.value() == order
                && (g.coefficient / coefficient - 1.0).abs() < 1e-9
                && at.is_none_or(|at| angle_between(at.to_radians(), *direction) < 1e-4)
        }
        (Verdict::IllPosed { growth: None, direction }, BlowsUp(at)) => {
            angle_between(at.to_radians(), *direction) < 1e-12
        }
        (Verdict::Indeterminate { rank, .. }, Indeterminate(wanted)) => *rank == wanted,
        _ => false,
    })
}

/// Systems planted with a known answer.
#[test]
fn planted_systems_are_recognised() {
    let (mut wrong, mut marginal) = (Vec::new(), Vec::new());
    for (name, system, wanted) in planted() {
        let verdict = judge(&system);
        let message = format!("{name}: wanted {wanted:?}, found {verdict:?}");
        match fulfils(&verdict, wanted) {
            Some(true) => {}
            Some(false) => wrong.push(message),
            None => marginal.push(message),
        }
    }
    assert!(wrong.is_empty(), "{} wrong:\n{}", wrong.len(), wrong.join("\n"));
    assert!(marginal.is_empty(), "{} marginal:\n{}", marginal.len(), marginal.join("\n"));
}

/// Dispersive waves with growth of the next order: its order at least, and its size to 2 %.
#[test]
fn growth_next_to_neutral_roots_is_seen() {
    let (_, system, _) = planted()
        .into_iter()
        .find(|(name, _, _)| *name == "beam with growth of order 1")
        .expect("planted above");
    let (order, coefficient, _) = growth(&judge(&system));
    assert!(order == 1.0 && (coefficient / 0.25 - 1.0).abs() < 0.02, "{order}, {coefficient}");
}

/// Imaginary roots that only rounding could move are not called growth.
#[test]
fn waves_are_not_called_growth() {
    for (name, system, _) in planted() {
        if ["acoustics", "acoustics carried along", "beam", "waves of order 3"].contains(&name) {
            assert_ne!(judge(&system).name(), "ill-posed", "{name}");
        }
    }
}

/// ς = k² sin(θ − a) sin(a + w − θ): growth in a sector of width w alone.
#[test]
fn thin_sectors_of_growth_are_found() {
    for width in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10] {
        for a in [0.4, 1.1, 2.3, 3.0] {
            let b: f64 = a + width;
            let entries = [
                (0, 0, T, 1.0),
                (1, 1, C, 1.0),
                (0, 1, X, -f64::sin(a)),
                (0, 1, Y, f64::cos(a)),
                (1, 0, X, -b.sin()),
                (1, 0, Y, b.cos()),
            ];
            let (order, coefficient, direction) = growth(&judge(&system(2, 2, &entries)));
            assert_eq!(order, 2.0);
            let wanted = (0.5 * width).sin().powi(2);
            // The entries know the two directions to a unit in their last place.
            let error = (coefficient / wanted - 1.0).abs();
            assert!(error < 1e-12 + 8.0 * f64::EPSILON / width, "{width:e}: {error:e}");
            assert!(angle_between(direction, a + 0.5 * width) < 0.5 * width, "{width:e}");
        }
    }
}

/// The same planted systems in other units and other axes say the same.
#[test]
fn planted_systems_in_other_units() {
    let random = &mut seeded(77);
    for (name, planted, wanted) in planted() {
        let mut scaled = planted.clone();
        let (rows, columns) = scaled.a.shape();
        let (rate, length) = (
            (random.within(-20.0, 20.0)).round().exp2(),
            random.within(-20.0, 20.0).round().exp2(),
        );
        let factors: Vec<f64> =
            (0..rows + columns).map(|_| random.within(-30.0, 30.0).round().exp2()).collect();
        for i in 0..rows {
            for j in 0..columns {
                let f = factors[i] * factors[rows + j];
                for (matrix, unit) in [(&mut scaled.a, rate), (&mut scaled.c, 1.0)] {
                    matrix[(i, j)].value *= f * unit;
                }
                for b in &mut scaled.b {
                    b[(i, j)].value *= f * length;
                }
            }
        }
        let wanted = match wanted {
            // ς̂ rate = …, k̂ = k length.
            Grows(m, c, at) => Grows(m, c / rate * length.powf(m), at),
            other => other,
        };
        let verdict = judge(&scaled);
        assert_ne!(fulfils(&verdict, wanted), Some(false), "{name}: {wanted:?}, {verdict:?}");
        assert_eq!(verdict.name(), judge(&planted).name(), "{name}");
    }
}

/// Exactly singular pencils with coefficients of 50 bits: products of three of them do not fit in
/// twice the working precision.
#[test]
fn dense_singular_pencils_are_recognised() {
    for seed in 0..200 {
        let random = &mut seeded(0x516 + seed);
        let n = 3 + (seed % 3) as usize;
        let mut integer = || (random.bits() >> 16) as f64 - (46f64).exp2();
        let mut entries: Entries = Vec::new();
        for part in [T, X, Y, C] {
            for j in 0..n {
                let mut last = 0.0;
                for i in 0..n - 1 {
                    let value = integer();
                    entries.push((i, j, part, value));
                    last += value;
                }
                entries.push((n - 1, j, part, last));
            }
        }
        let verdict = judge(&system(n, n, &entries));
        assert_eq!(verdict, Verdict::Indeterminate { rank: n - 1, unknowns: n }, "seed {seed}");
    }
}

/// A matrix A that is exactly singular, densely filled: one root fewer, and the verdict of what is
/// left.
#[test]
fn dense_singular_a_leaves_no_spurious_root() {
    for seed in 0..100 {
        let random = &mut seeded(0xa1 + seed);
        let mut integer = || (random.bits() >> 16) as f64 - (46f64).exp2();
        let n = 4;
        let mut entries: Entries = Vec::new();
        for j in 0..n {
            let mut last = 0.0;
            for i in 0..n - 1 {
                let value = integer();
                entries.push((i, j, T, value));
                last += value;
            }
            entries.push((n - 1, j, T, last));
            for i in 0..n {
                entries.push((i, j, C, integer()));
            }
        }
        let system = system(n, n, &entries);
        let mut pencil = Pencil::default();
        pencil.update(&system).expect("finite coefficients");
        let exact = WideSystem::of(&system).at_wave([1.0, 0.0]).len() - 1;
        assert_eq!(exact, n - 1);
        assert_eq!(pencil.polynomial.at_wave(1.0, 0.3).len() - 1, exact, "seed {seed}");
        assert_eq!(judge(&system), Verdict::WellPosed, "seed {seed}");
    }
}

/// A random system of 2 to 4 equations with few entries, integers or not.
fn small(seed: u64, integers: bool) -> LinearisedSystem<2> {
    let random = &mut seeded(0x5a11 + seed);
    let n = 2 + (seed % 3) as usize;
    let mut entries: Entries = Vec::new();
    for i in 0..n {
        for j in 0..n {
            for part in [T, X, Y, C] {
                if random.chance(if part == T { 0.3 } else { 0.4 }) {
                    let value = if integers {
                        random.within(-3.49, 3.49).round()
                    } else {
                        random.signed(0.3, 3.0)
                    };
                    if value != 0.0 {
                        entries.push((i, j, part, value));
                    }
                }
            }
        }
    }
    system(n, n, &entries)
}

/// Random small systems, far from any physics: what is asserted agrees with brute force.
#[test]
fn small_random_systems_agree_with_brute_force() {
    agree_with_brute_force(false, 200);
}

/// The same with small integers, for which many directions coincide.
#[test]
fn small_integer_systems_agree_with_brute_force() {
    agree_with_brute_force(true, 200);
}

#[test]
#[ignore = "some minutes: cargo test --release -p wellposed-analysis --test verdict many -- --ignored"]
fn many_small_systems_agree_with_brute_force() {
    agree_with_brute_force(false, 500);
    agree_with_brute_force(true, 500);
}

/// What is wrong with a verdict, by brute force; `fine` takes longer and misses less.
fn difference(verdict: &Verdict, p: &DispersionReference, fine: bool) -> Option<String> {
    match verdict {
        Verdict::Indeterminate { .. } => {
            return (!p.terms.is_empty()).then(|| "not singular".to_string());
        }
        _ if p.terms.is_empty() => return Some("singular".to_string()),
        Verdict::Marginal { .. } => return None,
        _ if p.degree() == 0 => {
            return (*verdict != Verdict::WellPosed).then(|| "no roots at all".to_string());
        }
        _ => {}
    }
    let force = brute(p, &[1e8, 1e13], 60, &degenerate_directions(p), 3.2, fine);
    let wrong = match verdict {
        Verdict::WellPosed => force.blows_up || force.order().abs() > 0.05,
        Verdict::IllPosed { growth: None, .. } => !force.blows_up,
        Verdict::IllPosed { growth: Some(g), .. } => {
            let order = g.order.value();
            let ratio = force.coefficient(order) / g.coefficient;
            (force.order() - order).abs() > 0.05 || (ratio - 1.0).abs() > 0.02 || force.blows_up
        }
        _ => false,
    };
    wrong.then(|| format!("order {:.4} {force:?}", force.order()))
}

fn agree_with_brute_force(integers: bool, systems: u64) {
    let results: Vec<(String, Option<String>)> = (0..systems)
        .into_par_iter()
        .map(|seed| {
            let own = small(seed, integers);
            let verdict = judge(&own);
            let p = WideSystem::of(&own).polynomial();
            let problem =
                difference(&verdict, &p, false).and_then(|_| difference(&verdict, &p, true));
            let name = match &verdict {
                Verdict::IllPosed { growth: Some(g), .. } => {
                    format!("order {}/{}", g.order.numerator, g.order.denominator)
                }
                Verdict::IllPosed { growth: None, .. } => "unbounded at finite k".into(),
                other => other.name().into(),
            };
            (name, problem.map(|p| format!("seed {seed}: {verdict:?}: {p}")))
        })
        .collect();
    let mut counts = std::collections::BTreeMap::<&str, usize>::new();
    for (name, _) in &results {
        *counts.entry(name).or_default() += 1;
    }
    println!("{counts:?}");
    let wrong: Vec<&String> = results.iter().filter_map(|r| r.1.as_ref()).collect();
    wrong.iter().for_each(|w| println!("{w}"));
    assert!(wrong.is_empty(), "{} of {systems} disagree", wrong.len());
    let marginal = counts.get("marginal").copied().unwrap_or(0) as u64;
    assert!(100 * marginal <= systems, "{marginal} of {systems} are called marginal");
}
