//! Verdicts on the plastic potential and on double shearing with dilatancy.

use super::backgrounds::{ACCELERATING_FLAGS, ALL_FLAGS, UNIFORM, restrict_background};
use crate::support::states::{
    DilatancyKind, FlowSample, sample_order_one, sample_wide_range, seeded_generator,
};
use crate::support::verdicts::{compute_verdict, growth_coefficient, verdict_label};
use models::registry;
use rayon::prelude::*;
use testkit::flows::FlowParameters;

/// Verifies that the associated plastic potential is well-posed without acceleration and grows at order 1/2 with it.
#[test]
fn associated_plastic_potential_grows_only_if_accelerated() {
    check_associated_potential(100);
}

/// Checks `count` random states of each background.
fn check_associated_potential(count: u64) {
    for parts in [0, 2, 4, 6, 8, 10, 12, 14] {
        let wanted = if parts & ACCELERATING_FLAGS == 0 { "well-posed" } else { "order 1/2" };
        let wrong: Vec<String> = (0..count)
            .into_par_iter()
            .filter_map(|seed| {
                let random = &mut seeded_generator(0xb7_0000 + seed);
                let base = loop {
                    let (kind, dilatancy) =
                        (registry::PLASTIC_POTENTIAL, DilatancyKind::Associated);
                    let base = if seed % 2 == 0 {
                        sample_order_one(random, kind, dilatancy, true)
                    } else {
                        sample_wide_range(random, kind, dilatancy)
                    };
                    if base.state.pressure_gradient != [0.0; 2] {
                        break base;
                    }
                };
                let state = restrict_background(parts, base.state);
                let sample = FlowSample::new(base.kind(), base.parameters, state);
                let found = verdict_label(&compute_verdict(&sample.system));
                (found != wanted).then(|| format!("seed {seed}: {found}: {sample:?}"))
            })
            .collect();
        assert!(wrong.is_empty(), "{parts:#b}: {} differ: {wrong:#?}", wrong.len());
    }
}

/// Verifies growth near the associated flow rule, in uniform backgrounds and in backgrounds with all gradients, at
/// relative distances |ν − φ|/φ from 1e-9 to 0.3: order 2 with the coefficient q tan²((φ − ν)/2)/(2 ρ Q_D) for the
/// deviator q, density ρ and shear rate Q_D. The tolerance contains 1e-14/distance, since the relative rounding error
/// of φ − ν is about ε divided by the relative distance.
#[test]
fn plastic_potential_near_the_associated_flow_rule_grows_at_order_two() {
    check_near_associated_flow(300);
}

/// Checks `count` random states.
fn check_near_associated_flow(count: u64) {
    (0..count).into_par_iter().for_each(|seed| {
        let random = &mut seeded_generator(0xb8_0000 + seed);
        let parts = [UNIFORM, ALL_FLAGS][seed as usize % 2];
        let base =
            sample_order_one(random, registry::PLASTIC_POTENTIAL, DilatancyKind::Associated, true);
        let phi = base.parameters.friction_angle;
        let distance = random.log_uniform(1e-9, 0.3);
        let sign = if random.bernoulli(0.5) { 1.0 } else { -1.0 };
        let dilatancy_angle = phi * (1.0 + sign * distance);
        let parameters = FlowParameters { dilatancy_angle, ..base.parameters };
        let sample =
            FlowSample::new(base.kind(), parameters, restrict_background(parts, base.state));
        let verdict = compute_verdict(&sample.system);
        assert_eq!(verdict_label(&verdict), "order 2/1", "seed {seed}, {distance:e}");
        let flow = &sample.flow;
        let wanted = flow.stress.deviator.value * (0.5 * (phi - dilatancy_angle)).tan().powi(2)
            / (2.0 * flow.density * flow.shear_rate);
        let error = (growth_coefficient(&verdict) / wanted - 1.0).abs();
        assert!(error < 1e-9 + 1e-14 / distance, "seed {seed}, {distance:e}: off by {error:e}");
    });
}

/// Verifies growth of dilatant double shearing in every background: order 1, squared coefficient q cos(φ − 2ν) (1 + sin
/// φ)/{ρ sin(φ − ν) [cos(φ − ν) + sin ν]} with the deviator q and the density ρ.
#[test]
fn dilatant_double_shearing_grows_at_order_one() {
    check_double_shearing(300);
}

/// Checks `count` random states.
fn check_double_shearing(count: u64) {
    (0..count).into_par_iter().for_each(|seed| {
        let random = &mut seeded_generator(0xb9_0000 + seed);
        let base = if seed % 2 == 0 {
            sample_order_one(random, registry::DOUBLE_SHEARING, DilatancyKind::Positive, true)
        } else {
            sample_wide_range(random, registry::DOUBLE_SHEARING, DilatancyKind::Positive)
        };
        let state =
            restrict_background([0, 2, 4, 6, 8, 10, 12, 14][seed as usize / 2 % 8], base.state);
        let sample = FlowSample::new(base.kind(), base.parameters, state);
        let verdict = compute_verdict(&sample.system);
        assert_eq!(verdict_label(&verdict), "order 1/1", "seed {seed}: {sample:?}");
        let (phi, nu) = (base.parameters.friction_angle, base.parameters.dilatancy_angle);
        let above = sample.flow.stress.deviator.value * (phi - 2.0 * nu).cos() * (1.0 + phi.sin());
        let below = sample.flow.density * (phi - nu).sin() * ((phi - nu).cos() + nu.sin());
        let error = (growth_coefficient(&verdict) / (above / below).sqrt() - 1.0).abs();
        assert!(error < 1e-9, "seed {seed}: off by {error:e}");
    });
}

#[test]
#[ignore = "takes ten seconds"]
fn many_states_have_the_orders_and_coefficients_of_closed_forms() {
    check_associated_potential(300);
    check_near_associated_flow(1000);
    check_double_shearing(1000);
}
