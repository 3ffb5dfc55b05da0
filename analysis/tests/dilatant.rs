//! Growth in the models with dilatancy, on both sides of the bounds on the non-coaxiality: which
//! parts of the background decide, and that brute force in 256 bits sees the same.

mod support;

use models::granular_flow::Kind;
use models::granular_flow::Parameters;
use models::granular_flow::state::State;
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_4;
use support::brute::{brute, degenerate_directions};
use support::states::{Dilatancy, Random, Sample, reference, tame};
use wellposed_analysis::growth::{Verdict, assess};
use wellposed_analysis::pencil::Pencil;

fn verdict(sample: &Sample) -> Verdict {
    let mut pencil = Pencil::default();
    pencil.update(&sample.system).expect("finite coefficients");
    assess(&pencil).verdict
}

fn name(verdict: &Verdict) -> String {
    match verdict {
        Verdict::IllPosed { growth: Some(g), .. } => {
            format!("order {}/{}", g.order.numerator, g.order.denominator)
        }
        Verdict::IllPosed { growth: None, .. } => "unbounded at finite k".into(),
        other => other.name().into(),
    }
}

/// What the background has besides a constant rate of deformation.
#[derive(Clone, Copy, Debug)]
enum Background {
    Uniform,
    RotationalStress,
    PressureGradient,
    StressAngleGradient,
    DensityGradient,
    SpinGradient,
    InertiaGradient,
    All,
}
use Background::{
    All, DensityGradient, InertiaGradient, PressureGradient, RotationalStress, SpinGradient,
    StressAngleGradient, Uniform,
};

/// Growth of dilatant Harris–Grekova inside and outside its bound.
///
/// Outside, the coefficient of the highest power of ς changes sign; a gradient of the stress angle
/// gives that coefficient an imaginary part of lower order in k, so that it has no real zero, and
/// the growth is finite, of order 3. Inside, what accelerates the material (the gradients of pressure
/// and of stress angle stand in its momentum) makes layers grow, and so does a rotational stress.
const FOUND: [(Background, &str, &str); 8] = [
    (Uniform, "well-posed", "unbounded at finite k"),
    (RotationalStress, "order 2/5", "unbounded at finite k"),
    (PressureGradient, "order 1/2", "unbounded at finite k"),
    (StressAngleGradient, "order 1/2", "order 3/1"),
    (DensityGradient, "well-posed", "unbounded at finite k"),
    (SpinGradient, "well-posed", "unbounded at finite k"),
    (InertiaGradient, "well-posed", "unbounded at finite k"),
    (All, "order 1/2", "order 3/1"),
];

/// A random state at a distance from the bound of 1e-9 to 0.3, log-uniform: of the bound inside, of
/// what is left to 45° outside.
fn harris_grekova(random: &mut Random, background: Background, inside: bool) -> Sample {
    let base = tame(random, Kind::HarrisGrekova, Dilatancy::Positive, true);
    let given = base.state;
    let uniform = State {
        pressure_gradient: [0.0; 2],
        stress_angle_gradient: [0.0; 2],
        density_gradient: [0.0; 2],
        spin_gradient: [0.0; 2],
        inertia_gradient: [0.0; 2],
        inertia_rate: 0.0,
        ..given
    };
    let state = match background {
        Uniform | RotationalStress => uniform,
        PressureGradient => State { pressure_gradient: given.pressure_gradient, ..uniform },
        StressAngleGradient => {
            State { stress_angle_gradient: given.stress_angle_gradient, ..uniform }
        }
        DensityGradient => State { density_gradient: given.density_gradient, ..uniform },
        SpinGradient => State { spin_gradient: given.spin_gradient, ..uniform },
        InertiaGradient => State {
            inertia_gradient: given.inertia_gradient,
            inertia_rate: given.inertia_rate,
            ..uniform
        },
        All => given,
    };
    let strength = match background {
        RotationalStress | All => random.within(0.1, 1.0),
        _ => 0.0,
    };
    let parameters = Parameters { rotational_strength: Some(strength), ..base.parameters };
    let bound = base.model.noncoaxiality_bound().expect("the model has one");
    let distance = random.decades(1e-9, 0.3);
    let size =
        if inside { bound * (1.0 - distance) } else { bound + distance * (FRAC_PI_4 - bound) };
    let noncoaxiality = Some(if random.chance(0.5) { size } else { -size });
    Sample::new(Kind::HarrisGrekova, parameters, State { noncoaxiality, ..state })
}

/// 1000 random states on each side of the bound for each background.
#[test]
fn harris_grekova_on_both_sides_of_its_bound() {
    for (background, inside, outside) in FOUND {
        for (is_inside, expected) in [(true, inside), (false, outside)] {
            let wrong: Vec<String> = (0..1000u64)
                .into_par_iter()
                .filter_map(|seed| {
                    let sample = harris_grekova(&mut Random::new(seed), background, is_inside);
                    let found = name(&verdict(&sample));
                    (found != expected).then(|| format!("seed {seed}: {found}"))
                })
                .collect();
            assert!(wrong.is_empty(), "{background:?}, inside {is_inside}: {wrong:?}");
        }
    }
}

/// What brute force says of a verdict: growth at three wave numbers over four decades.
///
/// Growth of fractional order nears its asymptote like k^(−1/5) at the slowest, 2.5e-4 at the least
/// of these wave numbers; constants of that correction take up the rest of the tolerance.
fn differs(sample: &Sample, verdict: &Verdict) -> Option<String> {
    let polynomial = reference(sample).polynomial();
    let waves = [1e18, 1e20, 1e22];
    let force = brute(&polynomial, &waves, 60, &degenerate_directions(&polynomial), 1.6, true);
    let agrees = match verdict {
        Verdict::WellPosed => !force.blows_up && force.order().abs() < 0.02,
        Verdict::IllPosed { growth: None, .. } => force.blows_up,
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let order = growth.order.value();
            let is_close = |&(k, s, _): &(f64, f64, f64)| {
                (s / k.powf(order) / growth.coefficient - 1.0).abs() < 0.01
            };
            !force.blows_up && force.at.iter().all(is_close)
        }
        _ => false,
    };
    (!agrees).then(|| format!("{verdict:?}: {force:?}"))
}

#[test]
fn brute_force_confirms_harris_grekova_with_dilatancy() {
    const STATES: u64 = 3;
    let wrong: Vec<String> = (0..16 * STATES)
        .into_par_iter()
        .filter_map(|index| {
            let (background, ..) = FOUND[index as usize % 8];
            let is_inside = index / 8 % 2 == 0;
            let sample = harris_grekova(&mut Random::new(0xbf + index), background, is_inside);
            let problem = differs(&sample, &verdict(&sample))?;
            Some(format!("{background:?}, inside {is_inside}: {problem}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The associated plastic potential and dilatant double shearing with accelerations and gradients.
#[test]
fn brute_force_confirms_the_other_models_with_dilatancy() {
    const STATES: u64 = 12;
    let kinds = [
        (Kind::PlasticPotential, Dilatancy::Associated),
        (Kind::DoubleShearing, Dilatancy::Positive),
    ];
    let found: Vec<(String, Option<String>)> = (0..2 * STATES)
        .into_par_iter()
        .map(|index| {
            let (kind, dilatancy) = kinds[index as usize % 2];
            let sample = tame(&mut Random::new(0xd5 + index), kind, dilatancy, true);
            let verdict = verdict(&sample);
            let problem = differs(&sample, &verdict);
            (format!("{kind:?} {}", name(&verdict)), problem)
        })
        .collect();
    for (name, problem) in &found {
        println!("{name}");
        assert!(problem.is_none(), "{name}: {problem:?}");
    }
}
