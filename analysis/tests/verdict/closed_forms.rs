//! Verdicts of the granular-flow models against their closed forms.

use crate::support::maximise::maximise_over_half_turn;
use crate::support::states::{
    DilatancyKind, FlowSample, sample_order_one, sample_wide_range, seeded_generator,
    with_noncoaxiality,
};
use crate::support::verdicts::{angular_distance, compute_verdict, expect_growth};
use models::flow::double_shearing::parameters::DoubleShearing;
use models::flow::harris_grekova::parameters::HarrisGrekova;
use models::flow::plastic_potential::parameters::PlasticPotential;
use models::flow::state::MaterialState;
use models::registry;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use testkit::flows::FlowParameters;
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;

/// Verifies Harris–Grekova with dilatancy angle ν = 0: ill-posed at a non-coaxiality |Δ| of 45° + 1e-9°, well-posed at
/// 45° − 1e-9°, marginal at 45°; with and without gradients, in units far from 1.
#[test]
fn harris_grekova_is_ill_posed_beyond_45_degrees() {
    for seed in 0..200 {
        let random = &mut seeded_generator(0x45 + seed);
        let sample = if seed.is_multiple_of(2) {
            sample_order_one(
                random,
                registry::HARRIS_GREKOVA,
                DilatancyKind::Zero,
                seed.is_multiple_of(4),
            )
        } else {
            sample_wide_range(random, registry::HARRIS_GREKOVA, DilatancyKind::Zero)
        };
        for sign in [1.0, -1.0] {
            let at = |degrees: f64| {
                compute_verdict(&with_noncoaxiality(&sample, sign * degrees.to_radians()).system)
            };
            let inside = at(45.0 - 1e-9);
            assert_eq!(inside, Verdict::WellPosed, "seed {seed}: {:?}", sample.state);
            let (order, coefficient, _) = expect_growth(&at(45.0 + 1e-9));
            assert!(order == 2.0 && coefficient > 0.0);
            assert_eq!(at(45.0).name(), "marginal", "seed {seed}");
        }
    }
}

/// Verifies order, coefficient and direction against the maximised closed forms, to 1e-9.
#[test]
fn coefficients_and_directions_are_those_of_the_closed_forms() {
    let mut worst = [0.0f64; 3];
    for seed in 0..300 {
        let random = &mut seeded_generator(0xc1 + seed);
        let wide_range = seed.is_multiple_of(3);
        let mut sample = |kind, dilatancy| {
            let gradients = seed.is_multiple_of(2);
            if wide_range {
                sample_wide_range(random, kind, dilatancy)
            } else {
                sample_order_one(random, kind, dilatancy, gradients)
            }
        };
        let beta = |s: &FlowSample, angle: f64| 2.0 * (s.state.stress_angle - angle);

        // Harris–Grekova with a non-coaxiality |Δ| beyond its bound of 45°, where short waves grow.
        let s = sample(registry::HARRIS_GREKOVA, DilatancyKind::Zero);
        let s = with_noncoaxiality(
            &s,
            s.flow.noncoaxiality.signum() * (FRAC_PI_2 - 0.3 * s.flow.noncoaxiality.abs()),
        );
        let constants = s.parameters.to_constants(registry::HARRIS_GREKOVA);
        let own = HarrisGrekova::from_constants(&constants).expect("in range");
        let (q, rho, rate) = (s.flow.stress.deviator.value, s.flow.density, s.flow.shear_rate);
        let exact =
            |a: f64| own.growth_coefficient(q, rho, rate, s.flow.noncoaxiality, beta(&s, a));
        let mut check =
            |slot: usize, order: f64, sample: &FlowSample, exact: &dyn Fn(f64) -> f64| {
                let (wanted, _) = maximise_over_half_turn(20_000, exact);
                let (found_order, coefficient, direction) =
                    expect_growth(&compute_verdict(&sample.system));
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

        let s = sample(registry::DOUBLE_SHEARING, DilatancyKind::Zero);
        let constants = s.parameters.to_constants(registry::DOUBLE_SHEARING);
        let own = DoubleShearing::from_constants(&constants).expect("in range");
        let (q, rho) = (s.flow.stress.deviator.value, s.flow.density);
        check(1, 1.0, &s, &|a| own.growth_coefficient(q, rho, beta(&s, a)));

        let dilatancy =
            if seed.is_multiple_of(2) { DilatancyKind::Zero } else { DilatancyKind::Positive };
        let s = sample(registry::PLASTIC_POTENTIAL, dilatancy);
        let constants = s.parameters.to_constants(registry::PLASTIC_POTENTIAL);
        let own = PlasticPotential::from_constants(&constants).expect("in range");
        let (q, rho, rate) = (s.flow.stress.deviator.value, s.flow.density, s.flow.shear_rate);
        let exact = |a: f64| own.growth_coefficient(q, rho, rate, beta(&s, a));
        // Only sectors wide enough for `maximise_over_half_turn`.
        if (s.parameters.friction_angle - s.parameters.dilatancy_angle).abs() > 0.05 {
            check(2, 2.0, &s, &exact);
            let (rate, cosine) = own.fastest_growth(q, rho, rate);
            let (_, coefficient, direction) = expect_growth(&compute_verdict(&s.system));
            assert!((coefficient / rate - 1.0).abs() < 1e-9);
            assert!((beta(&s, direction).cos() - cosine).abs() < 1e-7);
        }
    }
    println!(
        "greatest deviations: Harris–Grekova {:.1e}, double shearing {:.1e}, plastic potential {:.1e}",
        worst[0], worst[1], worst[2]
    );
}

/// Verifies growth in sectors as narrow as φ − ν = ±1e-9 rad, and no growth at ν = φ.
#[test]
fn plastic_potential_grows_in_thin_sectors() {
    let mut worst = 0.0f64;
    for seed in 0..60 {
        let random = &mut seeded_generator(0x55 + seed);
        let base =
            sample_order_one(random, registry::PLASTIC_POTENTIAL, DilatancyKind::Associated, false);
        let phi = base.parameters.friction_angle;
        for gap in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9, -1e-2, -1e-4, -1e-6, -1e-9] {
            let parameters = FlowParameters { dilatancy_angle: phi - gap, ..base.parameters };
            let sample = FlowSample::new(registry::PLASTIC_POTENTIAL, parameters, base.state);
            let (order, coefficient, direction) = expect_growth(&compute_verdict(&sample.system));
            assert_eq!(order, 2.0);
            let constants = sample.parameters.to_constants(registry::PLASTIC_POTENTIAL);
            let own = PlasticPotential::from_constants(&constants).expect("in range");
            let (q, rho, rate) =
                (sample.flow.stress.deviator.value, sample.flow.density, sample.flow.shear_rate);
            let (wanted, cosine) = own.fastest_growth(q, rho, rate);
            let error = (coefficient / wanted - 1.0).abs();
            // The tolerance contains 1e-14/|φ − ν|: the relative rounding error of φ − ν is about ε φ/|φ − ν|.
            assert!(error < 1e-9 + 1e-14 / gap.abs(), "{gap:e}: {coefficient:e} for {wanted:e}");
            if gap.abs() >= 1e-3 {
                worst = worst.max(error);
            }
            let beta = 2.0 * (sample.state.stress_angle - direction);
            assert!((beta.cos() - cosine).abs() < gap.abs(), "{gap:e}: outside the sector");
        }
        let verdict = compute_verdict(&base.system);
        assert_ne!(verdict.name(), "ill-posed", "associated, uniform: {verdict:?}");
    }
    println!("greatest deviation of the coefficient down to 1e-3 rad: {worst:.1e}");
}

/// Verifies the bounds of the sectors of growth: from the closed form to 1e-12 rad, against sign changes of the leading
/// growth rate; from the linearised equations to 1e-8 rad.
#[test]
fn bounds_of_growth_sectors_agree_with_the_closed_form() {
    let mut worst = 0.0f64;
    for seed in 0..200 {
        let random = &mut seeded_generator(0x5ec + seed);
        let base = sample_order_one(
            random,
            registry::PLASTIC_POTENTIAL,
            DilatancyKind::Associated,
            seed % 2 == 0,
        );
        let phi = base.parameters.friction_angle;
        for gap in [1e-1, 1e-3, 1e-6, -1e-2, -1e-6] {
            let parameters = FlowParameters { dilatancy_angle: phi - gap, ..base.parameters };
            let sample = FlowSample::new(registry::PLASTIC_POTENTIAL, parameters, base.state);
            let constants = sample.parameters.to_constants(registry::PLASTIC_POTENTIAL);
            let own = PlasticPotential::from_constants(&constants).expect("in range");
            let sector = own.unstable_sector();
            let inside = 0.5 * (sector[0] + sector[1]);
            for bound in sector {
                let outwards = (bound - inside).signum() * 1e-12;
                let rate = |beta: f64| own.growth_coefficient(1.0, 1.0, 1.0, beta);
                assert!(rate(bound - outwards) > 0.0 && rate(bound + outwards) < 0.0, "{gap:e}");
            }
            let mut pencil = Pencil::default();
            pencil.update(&sample.system).expect("finite coefficients");
            let found = assess(&pencil);
            assert_eq!(expect_growth(&found.verdict).0, 2.0, "{gap:e}: {found:?}");
            for beta in sector.into_iter().flat_map(|b| [b, -b]) {
                let wanted = sample.state.stress_angle - 0.5 * beta;
                let error = found
                    .degenerate_directions
                    .iter()
                    .map(|d| angular_distance(d.angle, wanted))
                    .fold(f64::MAX, f64::min);
                assert!(
                    error < 1e-8,
                    "{gap:e}: off by {error:e}: {:?}",
                    found.degenerate_directions
                );
                worst = worst.max(error);
            }
        }
    }
    println!("greatest deviation of a bound: {worst:.1e} rad");
}

/// Verifies that ν = φ on a uniform background is never ill-posed, in the widest ranges.
#[test]
fn associated_uniform_flow_is_never_ill_posed() {
    let mut counts = std::collections::BTreeMap::<&str, usize>::new();
    for seed in 0..500 {
        let random = &mut seeded_generator(0xa5 + seed);
        let sample =
            sample_wide_range(random, registry::PLASTIC_POTENTIAL, DilatancyKind::Associated);
        let state = MaterialState {
            pressure_gradient: [0.0; 2],
            stress_angle_gradient: [0.0; 2],
            density_gradient: [0.0; 2],
            ..sample.state
        };
        let sample = FlowSample::new(registry::PLASTIC_POTENTIAL, sample.parameters, state);
        let verdict = compute_verdict(&sample.system);
        assert_ne!(verdict.name(), "ill-posed", "{verdict:?}: {sample:?}");
        *counts.entry(verdict.name()).or_default() += 1;
    }
    println!("{counts:?}");
}

/// Verifies Harris–Grekova with ν > 0 on a uniform background without rotational stress: the bound on |Δ| to 1e-9
/// degrees on both sides; just beyond it growth is unbounded at finite k, at the angle of the double zero of the
/// highest coefficient; far beyond, where that coefficient has one sign again, growth is of order 2.
#[test]
fn dilatant_harris_grekova_is_ill_posed_beyond_its_bound() {
    let mut names = std::collections::BTreeMap::<&str, usize>::new();
    for seed in 0..200 {
        let random = &mut seeded_generator(0xd1 + seed);
        let base =
            sample_order_one(random, registry::HARRIS_GREKOVA, DilatancyKind::Positive, false);
        let parameters = FlowParameters { rotational_strength: Some(0.0), ..base.parameters };
        let state = MaterialState { velocity: [0.0; 2], ..base.state };
        let base = FlowSample::new(registry::HARRIS_GREKOVA, parameters, state);
        let bound = base.model.noncoaxiality_bound().expect("this model has one");
        let (phi, nu) = (parameters.friction_angle, parameters.dilatancy_angle);
        for sign in [1.0, -1.0] {
            let at = |delta: f64| compute_verdict(&with_noncoaxiality(&base, sign * delta).system);
            let inside = at(bound - 1e-9f64.to_radians());
            *names.entry(inside.name()).or_default() += 1;
            assert_eq!(inside, Verdict::WellPosed, "seed {seed}: {base:?}");
            let beyond = at(bound + 1e-9f64.to_radians());
            let Verdict::IllPosed { growth: None, direction } = beyond else {
                panic!("seed {seed}, just beyond: {beyond:?}")
            };
            // The highest coefficient cos 2Δ cos ν [X − Y cos β] + sin 2Δ Z sin β, with X = `x` and Y = `y` below,
            // touches zero where its slope vanishes: cos β = Y/X.
            let beta = 2.0 * (base.state.stress_angle - direction);
            let (x, y) =
                ((phi - nu).cos() + nu.sin() * phi.sin(), phi.sin() * (phi - nu).cos() + nu.sin());
            assert!((beta.cos() - y / x).abs() < 1e-4, "seed {seed}: {} for {}", beta.cos(), y / x);
            // At a finite distance beyond the bound.
            assert!(matches!(
                at(0.5 * (bound + FRAC_PI_4)),
                Verdict::IllPosed { growth: None, .. }
            ));
            assert!(matches!(
                at(FRAC_PI_2 - 0.5 * (bound + FRAC_PI_4)),
                Verdict::IllPosed { growth: None, .. }
            ));
            let (order, _, _) = expect_growth(&at(FRAC_PI_2 - 0.9 * bound));
            assert_eq!(order, 2.0);
        }
    }
    println!("just inside: {names:?}");
}

/// Verifies that the free-rotating model, with one equation too few, is indeterminate, and its rank.
#[test]
fn free_rotating_is_indeterminate() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        for seed in 0..100 {
            let random = &mut seeded_generator(0xf1 + seed);
            let sample = sample_wide_range(random, registry::FREE_ROTATING, dilatancy);
            let unknowns = sample.system.unknowns.len();
            let wanted = Verdict::Indeterminate { rank: unknowns - 1, unknowns };
            assert_eq!(compute_verdict(&sample.system), wanted, "{sample:?}");
        }
    }
}
