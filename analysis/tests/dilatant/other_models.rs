//! The plastic potential and double shearing with dilatancy.

use crate::backgrounds::{ACCELERATED, ALL, UNIFORM, with};
use crate::support::states::{Dilatancy, Sample, seeded, tame, wild};
use crate::support::verdicts::{coefficient, judge, name};
use models::registry;
use rayon::prelude::*;
use testkit::flows::Parameters;

/// Verifies that the associated plastic potential is well-posed without acceleration and grows at order 1/2 with it.
#[test]
fn associated_plastic_potential_by_background() {
    for parts in [0, 2, 4, 6, 8, 10, 12, 14] {
        let wanted = if parts & ACCELERATED == 0 { "well-posed" } else { "order 1/2" };
        let wrong: Vec<String> = (0..300u64)
            .into_par_iter()
            .filter_map(|seed| {
                let random = &mut seeded(0xb7_0000 + seed);
                let base = loop {
                    let (kind, dilatancy) = (registry::PLASTIC_POTENTIAL, Dilatancy::Associated);
                    let base = if seed % 2 == 0 {
                        tame(random, kind, dilatancy, true)
                    } else {
                        wild(random, kind, dilatancy)
                    };
                    if base.state.pressure_gradient != [0.0; 2] {
                        break base;
                    }
                };
                let state = with(parts, base.state);
                let sample = Sample::new(base.kind(), base.parameters, state);
                let found = name(&judge(&sample.system));
                (found != wanted).then(|| format!("seed {seed}: {found}: {sample:?}"))
            })
            .collect();
        assert!(wrong.is_empty(), "{parts:#b}: {} differ: {wrong:#?}", wrong.len());
    }
}

/// Verifies growth next to the associated flow rule in every background, at relative distances of ν from φ of 1e-9 to
/// 0.3: order 2 with the coefficient q tan²((φ − ν)/2)/(2 ρ Q_D). Doubles determine the difference of two angles to a
/// rounding divided by it.
#[test]
fn plastic_potential_beside_the_associated_flow_rule() {
    (0..1000u64).into_par_iter().for_each(|seed| {
        let random = &mut seeded(0xb8_0000 + seed);
        let parts = [UNIFORM, ALL][seed as usize % 2];
        let base = tame(random, registry::PLASTIC_POTENTIAL, Dilatancy::Associated, true);
        let phi = base.parameters.friction_angle;
        let distance = random.decades(1e-9, 0.3);
        let sign = if random.chance(0.5) { 1.0 } else { -1.0 };
        let dilatancy_angle = phi * (1.0 + sign * distance);
        let parameters = Parameters { dilatancy_angle, ..base.parameters };
        let sample = Sample::new(base.kind(), parameters, with(parts, base.state));
        let verdict = judge(&sample.system);
        assert_eq!(name(&verdict), "order 2/1", "seed {seed}, {distance:e}");
        let flow = &sample.flow;
        let wanted = flow.stress.deviator.value * (0.5 * (phi - dilatancy_angle)).tan().powi(2)
            / (2.0 * flow.density * flow.shear_rate);
        let error = (coefficient(&verdict) / wanted - 1.0).abs();
        assert!(error < 1e-9 + 1e-14 / distance, "seed {seed}, {distance:e}: off by {error:e}");
    });
}

/// Verifies growth of dilatant double shearing in every background: order 1 with the coefficient √(q cos(φ − 2ν)(1 +
/// sin φ)/{ρ sin(φ − ν)[cos(φ − ν) + sin ν]}).
#[test]
fn double_shearing_with_dilatancy() {
    (0..1000u64).into_par_iter().for_each(|seed| {
        let random = &mut seeded(0xb9_0000 + seed);
        let base = if seed % 2 == 0 {
            tame(random, registry::DOUBLE_SHEARING, Dilatancy::Positive, true)
        } else {
            wild(random, registry::DOUBLE_SHEARING, Dilatancy::Positive)
        };
        let state = with([0, 2, 4, 6, 8, 10, 12, 14][seed as usize / 2 % 8], base.state);
        let sample = Sample::new(base.kind(), base.parameters, state);
        let verdict = judge(&sample.system);
        assert_eq!(name(&verdict), "order 1/1", "seed {seed}: {sample:?}");
        let (phi, nu) = (base.parameters.friction_angle, base.parameters.dilatancy_angle);
        let above = sample.flow.stress.deviator.value * (phi - 2.0 * nu).cos() * (1.0 + phi.sin());
        let below = sample.flow.density * (phi - nu).sin() * ((phi - nu).cos() + nu.sin());
        let error = (coefficient(&verdict) / (above / below).sqrt() - 1.0).abs();
        assert!(error < 1e-9, "seed {seed}: off by {error:e}");
    });
}
