//! Characteristics of the steady equations against Harris & Grekova (2005), eq. 70, and against
//! the roots of the determinant in 256 bits.

use crate::support::exact::{System256, solve_roots};
use crate::support::real256::{Complex256, Real256};
use crate::support::states::{
    DilatancyKind, FlowSample, RandomNumbers, sample_order_one, seeded_generator,
};
use crate::support::verdicts::angular_distance;
use models::flow::FlowKind;
use models::flow::state::MaterialState;
use models::registry;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_4, PI};
use wellposed_analysis::characteristics::{
    Characteristics, CharacteristicsError, EquationType, RealCharacteristic, characteristics,
};

fn compute_characteristics(sample: &FlowSample) -> Characteristics {
    characteristics(&sample.system).expect("as many equations as unknowns")
}

/// Removes the characteristic at `angle` from the list and verifies its bound, multiplicity and family.
fn remove_characteristic(
    list: &mut Vec<RealCharacteristic>,
    angle: f64,
    multiplicity: usize,
    family: &str,
) {
    let at = list.iter().position(|c| angular_distance(c.angle, angle) < 1e-13);
    let Some(at) = at else { panic!("nothing at {} ({family}) in {list:?}", angle.rem_euclid(PI)) };
    let found = list.remove(at);
    assert_eq!((found.multiplicity, found.family.as_str()), (multiplicity, family), "{found:?}");
    assert!(found.bound < 1e-11, "{found:?}");
}

/// Random sample whose velocity is at least 1e-3 rad from the stress and velocity characteristics, so that no two
/// directions coincide.
fn sample_with_distinct_directions(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
    gradients: bool,
) -> FlowSample {
    loop {
        let sample = sample_order_one(random, kind, dilatancy, gradients);
        let stream = sample.state.velocity[1].atan2(sample.state.velocity[0]);
        let angles = [sample.parameters.friction_angle, sample.parameters.dilatancy_angle];
        let apart = angles.into_iter().all(|angle| {
            [1.0, -1.0].into_iter().all(|sign| {
                let own = sample.state.stress_angle + sign * (FRAC_PI_4 + 0.5 * angle);
                angular_distance(own, stream) > 1e-3
            })
        });
        if apart {
            return sample;
        }
    }
}

/// Verifies eq. 70: streamlines (double if the density evolves) and Ψ ± (π/4 + φ/2), for the stress angle Ψ and the
/// friction angle φ, both double, with stress and velocity in one family, for every dilatancy angle and independent of
/// gradients.
#[test]
fn harris_grekova_has_the_characteristics_of_equation_70() {
    for seed in 0..400 {
        let random = &mut seeded_generator(0x70 + seed);
        let dilatancy =
            if seed.is_multiple_of(2) { DilatancyKind::Zero } else { DilatancyKind::Positive };
        let sample = sample_with_distinct_directions(
            random,
            registry::HARRIS_GREKOVA,
            dilatancy,
            seed % 4 < 2,
        );
        let found = compute_characteristics(&sample);
        assert_eq!(found.equation_type, Some(EquationType::Hyperbolic));
        assert!(found.complex.is_empty() && found.arbitrary_families.is_empty());
        let mut real = found.real;
        let epsilon = FRAC_PI_4 + 0.5 * sample.parameters.friction_angle;
        let [v1, v2] = sample.state.velocity;
        remove_characteristic(
            &mut real,
            sample.state.stress_angle + epsilon,
            2,
            "stress and velocity",
        );
        remove_characteristic(
            &mut real,
            sample.state.stress_angle - epsilon,
            2,
            "stress and velocity",
        );
        remove_characteristic(&mut real, v2.atan2(v1), 1 + (seed % 2) as usize, "streamline");
        assert!(real.is_empty(), "left over: {real:?}");
    }
}

/// Verifies stress characteristics at Ψ ± (π/4 + φ/2) and velocity characteristics at Ψ ± (π/4 + ν/2), for the stress
/// angle Ψ, friction angle φ and dilatancy angle ν; they coincide for ν = φ.
#[test]
fn plastic_potential_separates_stress_and_velocity_characteristics() {
    for seed in 0..400 {
        let random = &mut seeded_generator(0x71 + seed);
        let dilatancy = [DilatancyKind::Zero, DilatancyKind::Positive, DilatancyKind::Associated]
            [(seed % 3) as usize];
        let sample = sample_with_distinct_directions(
            random,
            registry::PLASTIC_POTENTIAL,
            dilatancy,
            seed.is_multiple_of(2),
        );
        let mut real = compute_characteristics(&sample).real;
        let psi = sample.state.stress_angle;
        let (phi, nu) = (sample.parameters.friction_angle, sample.parameters.dilatancy_angle);
        for sign in [1.0, -1.0] {
            let stress = psi + sign * (FRAC_PI_4 + 0.5 * phi);
            let velocity = psi + sign * (FRAC_PI_4 + 0.5 * nu);
            if dilatancy == DilatancyKind::Associated {
                remove_characteristic(&mut real, stress, 2, "stress and velocity");
            } else {
                remove_characteristic(&mut real, stress, 1, "stress");
                remove_characteristic(&mut real, velocity, 1, "velocity");
            }
        }
        if dilatancy != DilatancyKind::Zero {
            let [v1, v2] = sample.state.velocity;
            remove_characteristic(&mut real, v2.atan2(v1), 1, "streamline");
        }
        assert!(real.is_empty(), "left over: {real:?}");
    }
}

/// Roots ξ₂/ξ₁ of det(ξ₁(B¹ + V₁A) + ξ₂(B² + V₂A)) over the first four unknowns, in 256 bits.
fn steady_roots(sample: &FlowSample) -> Vec<Complex256> {
    let s = &sample.system;
    let velocity = s.velocity.map(Real256::from);
    let entry = |i: usize, j: usize| {
        let [first, second] = [0, 1].map(|d| {
            Real256::from(s.b[d][(i, j)].value) + velocity[d] * Real256::from(s.a[(i, j)].value)
        });
        [Real256::ZERO, first, second, Real256::ZERO]
    };
    let entries = (0..4).map(|i| (0..4).map(|j| entry(i, j)).collect()).collect();
    let mut polynomial = vec![Complex256::ZERO; 5];
    for ([_, _, c], value) in (System256 { size: 4, entries }).polynomial().terms {
        polynomial[usize::from(c)] = Complex256::from_real(value);
    }
    solve_roots(&polynomial)
}

/// Verifies double shearing with inertia, a quartic that does not factor: slow flow is hyperbolic, fast flow mixed or
/// elliptic. All real and complex roots are compared with 256 bits.
#[test]
fn double_shearing_with_inertia_has_characteristics_of_its_quartic() {
    let mut types = std::collections::BTreeMap::<String, usize>::new();
    let (mut worst_real, mut worst_complex) = (0.0f64, 0.0f64);
    for seed in 0..600 {
        let random = &mut seeded_generator(0x72 + seed);
        let dilatancy =
            if seed.is_multiple_of(2) { DilatancyKind::Zero } else { DilatancyKind::Positive };
        let sample = sample_order_one(random, registry::DOUBLE_SHEARING, dilatancy, seed % 4 < 2);
        let speed = random.log_uniform(1e-1, 10.0);
        let state =
            MaterialState { velocity: sample.state.velocity.map(|v| v * speed), ..sample.state };
        let sample = FlowSample::new(registry::DOUBLE_SHEARING, sample.parameters, state);
        let found = compute_characteristics(&sample);
        let wanted = steady_roots(&sample);
        assert_eq!(wanted.len(), 4);
        let off_real = |t: Complex64| t.im.abs() / (1.0 + t.norm_sqr());
        // Skip nearly double roots, which rounding may make real or complex.
        let nearest = wanted
            .iter()
            .enumerate()
            .flat_map(|(i, a)| {
                wanted[..i].iter().map(|b| (a.to_complex64() - b.to_complex64()).norm())
            })
            .fold(f64::MAX, f64::min);
        if nearest < 1e-3 {
            continue;
        }
        let mut real = 0;
        for t in wanted.iter().map(|t| t.to_complex64()) {
            if off_real(t) < 1e-30 {
                real += 1;
                // The characteristic is perpendicular to the wave vector (1, t).
                let angle = t.re.atan() + std::f64::consts::FRAC_PI_2;
                let own = found.real.iter().filter(|c| c.family.contains("stress"));
                let gap = own.map(|c| angular_distance(c.angle, angle)).fold(f64::MAX, f64::min);
                assert!(gap < 1e-11, "seed {seed}: {angle} missing in {found:?}");
                worst_real = worst_real.max(gap);
            } else {
                let own = found.complex.iter().map(|c| c.0);
                let gap = own.map(|c| (c * t + 1.0).norm()).fold(f64::MAX, f64::min);
                assert!(gap < 1e-9, "seed {seed}: {t} missing in {found:?}");
                worst_complex = worst_complex.max(gap);
            }
        }
        let own: usize =
            found.real.iter().filter(|c| c.family.contains("stress")).map(|c| c.multiplicity).sum();
        assert_eq!((own, found.complex.len()), (real, 4 - real), "seed {seed}: {found:?}");
        let kind = match (real, dilatancy) {
            (4, _) => EquationType::Hyperbolic,
            (0, DilatancyKind::Zero) => EquationType::Elliptic,
            _ => EquationType::Mixed,
        };
        assert_eq!(found.equation_type, Some(kind));
        *types.entry(format!("{kind:?}")).or_default() += 1;
        // The density is convected along streamlines.
        let [v1, v2] = sample.state.velocity;
        let stream = found.real.iter().filter(|c| {
            c.family == "streamline" && angular_distance(c.angle, v2.atan2(v1)) < 1e-13
        });
        assert_eq!(stream.count(), usize::from(dilatancy == DilatancyKind::Positive), "{found:?}");
    }
    println!("{types:?}; deviations {worst_real:.1e} (angles), {worst_complex:.1e} (complex)");
    assert!(types.len() >= 2, "{types:?}");
}

/// Verifies that in a material at rest every direction is characteristic for fields that are only convected.
#[test]
fn at_rest_convected_fields_have_arbitrary_characteristics() {
    for seed in 0..100 {
        let random = &mut seeded_generator(0x73 + seed);
        let at_rest = |random: &mut RandomNumbers, kind, dilatancy| {
            let sample = sample_order_one(random, kind, dilatancy, seed.is_multiple_of(2));
            FlowSample::new(
                kind,
                sample.parameters,
                MaterialState { velocity: [0.0; 2], ..sample.state },
            )
        };
        for (kind, dilatancy, arbitrary, each) in [
            (registry::HARRIS_GREKOVA, DilatancyKind::Zero, &["spin"][..], 2),
            (registry::HARRIS_GREKOVA, DilatancyKind::Positive, &["density", "spin"][..], 2),
            (registry::PLASTIC_POTENTIAL, DilatancyKind::Zero, &[][..], 1),
            (registry::PLASTIC_POTENTIAL, DilatancyKind::Positive, &["density"][..], 1),
            (registry::DOUBLE_SHEARING, DilatancyKind::Zero, &[][..], 2),
            (registry::DOUBLE_SHEARING, DilatancyKind::Positive, &["density"][..], 2),
        ] {
            let sample = at_rest(random, kind, dilatancy);
            let found = compute_characteristics(&sample);
            let mut own: Vec<&str> = found.arbitrary_families.iter().map(String::as_str).collect();
            own.sort_unstable();
            assert_eq!(own, arbitrary, "{kind:?} {dilatancy:?}");
            let epsilon = FRAC_PI_4 + 0.5 * sample.parameters.friction_angle;
            let mut real = found.real;
            for sign in [1.0, -1.0] {
                let angle = sample.state.stress_angle + sign * epsilon;
                let family = if each == 2 { "stress and velocity" } else { "stress" };
                // At rest the rotation rate of the double-shearing model is ∂ₜψ alone, so stress and velocity separate
                // there too.
                remove_characteristic(&mut real, angle, each, family);
            }
        }
    }
}

/// Verifies that the free-rotating model, with one equation too few, has no characteristics.
#[test]
fn free_rotating_model_has_no_characteristics() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        let sample =
            sample_order_one(&mut seeded_generator(0x74), registry::FREE_ROTATING, dilatancy, true);
        assert_eq!(characteristics(&sample.system), Err(CharacteristicsError::Indeterminate));
    }
}
