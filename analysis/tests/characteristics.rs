//! Characteristics of the steady equations against Harris & Grekova (2005), eq. 70, and against
//! the roots of the determinant in 256 bits.

mod support;

use models::flow::FlowKind;
use models::flow::state::State;
use models::registry;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_4, PI};
use support::exact::{WideSystem, roots};
use support::states::{Dilatancy, Random, Sample, seeded, tame};
use support::wide::{Wide, WideComplex};
use wellposed_analysis::characteristics::{
    Characteristic, Characteristics, NoCharacteristics, Type, characteristics,
};

fn angle_between(a: f64, b: f64) -> f64 {
    let gap = (a - b).rem_euclid(PI);
    gap.min(PI - gap)
}

fn of(sample: &Sample) -> Characteristics {
    characteristics(&sample.system).expect("as many equations as unknowns")
}

/// Removes the characteristic at `angle` from the list and verifies its bound, multiplicity and family.
fn take(list: &mut Vec<Characteristic>, angle: f64, multiplicity: usize, family: &str) {
    let at = list.iter().position(|c| angle_between(c.angle, angle) < 1e-13);
    let Some(at) = at else { panic!("nothing at {} ({family}) in {list:?}", angle.rem_euclid(PI)) };
    let found = list.remove(at);
    assert_eq!((found.multiplicity, found.family.as_str()), (multiplicity, family), "{found:?}");
    assert!(found.bound < 1e-11, "{found:?}");
}

/// Random sample whose velocity is at an angle to the stress characteristics, so that no two directions coincide.
fn generic(random: &mut Random, kind: FlowKind, dilatancy: Dilatancy, gradients: bool) -> Sample {
    loop {
        let sample = tame(random, kind, dilatancy, gradients);
        let stream = sample.state.velocity[1].atan2(sample.state.velocity[0]);
        let angles = [sample.parameters.friction_angle, sample.parameters.dilatancy_angle];
        let apart = angles.into_iter().all(|angle| {
            [1.0, -1.0].into_iter().all(|sign| {
                let own = sample.state.stress_angle + sign * (FRAC_PI_4 + 0.5 * angle);
                angle_between(own, stream) > 1e-3
            })
        });
        if apart {
            return sample;
        }
    }
}

/// Verifies eq. 70: streamlines (double if the density evolves) and Ψ ± (π/4 + φ/2), both double, with stress and
/// velocity in one family, for every ν and independent of gradients.
#[test]
fn harris_grekova_has_the_characteristics_of_equation_70() {
    for seed in 0..400 {
        let random = &mut seeded(0x70 + seed);
        let dilatancy = if seed.is_multiple_of(2) { Dilatancy::Zero } else { Dilatancy::Positive };
        let sample = generic(random, registry::HARRIS_GREKOVA, dilatancy, seed % 4 < 2);
        let found = of(&sample);
        assert_eq!(found.kind, Some(Type::Hyperbolic));
        assert!(found.complex.is_empty() && found.arbitrary.is_empty());
        let mut real = found.real;
        let epsilon = FRAC_PI_4 + 0.5 * sample.parameters.friction_angle;
        let [v1, v2] = sample.state.velocity;
        take(&mut real, sample.state.stress_angle + epsilon, 2, "stress and velocity");
        take(&mut real, sample.state.stress_angle - epsilon, 2, "stress and velocity");
        take(&mut real, v2.atan2(v1), 1 + (seed % 2) as usize, "streamline");
        assert!(real.is_empty(), "left over: {real:?}");
    }
}

/// Verifies stress characteristics at Ψ ± (π/4 + φ/2) and velocity characteristics at Ψ ± (π/4 + ν/2), which coincide
/// for ν = φ.
#[test]
fn plastic_potential_separates_stress_and_velocity() {
    for seed in 0..400 {
        let random = &mut seeded(0x71 + seed);
        let dilatancy =
            [Dilatancy::Zero, Dilatancy::Positive, Dilatancy::Associated][(seed % 3) as usize];
        let sample =
            generic(random, registry::PLASTIC_POTENTIAL, dilatancy, seed.is_multiple_of(2));
        let mut real = of(&sample).real;
        let psi = sample.state.stress_angle;
        let (phi, nu) = (sample.parameters.friction_angle, sample.parameters.dilatancy_angle);
        for sign in [1.0, -1.0] {
            let stress = psi + sign * (FRAC_PI_4 + 0.5 * phi);
            let velocity = psi + sign * (FRAC_PI_4 + 0.5 * nu);
            if dilatancy == Dilatancy::Associated {
                take(&mut real, stress, 2, "stress and velocity");
            } else {
                take(&mut real, stress, 1, "stress");
                take(&mut real, velocity, 1, "velocity");
            }
        }
        if dilatancy != Dilatancy::Zero {
            let [v1, v2] = sample.state.velocity;
            take(&mut real, v2.atan2(v1), 1, "streamline");
        }
        assert!(real.is_empty(), "left over: {real:?}");
    }
}

/// Roots ξ₂/ξ₁ of det(ξ₁(B¹ + V₁A) + ξ₂(B² + V₂A)) over the first four unknowns, in 256 bits.
fn steady_roots(sample: &Sample) -> Vec<WideComplex> {
    let s = &sample.system;
    let velocity = s.velocity.map(Wide::from);
    let entry = |i: usize, j: usize| {
        let [first, second] = [0, 1].map(|d| {
            Wide::from(s.b[d][(i, j)].value) + velocity[d] * Wide::from(s.a[(i, j)].value)
        });
        [Wide::ZERO, first, second, Wide::ZERO]
    };
    let entries = (0..4).map(|i| (0..4).map(|j| entry(i, j)).collect()).collect();
    let mut polynomial = vec![WideComplex::ZERO; 5];
    for ([_, _, c], value) in (WideSystem { size: 4, entries }).polynomial().terms {
        polynomial[usize::from(c)] = WideComplex::real(value);
    }
    roots(&polynomial)
}

/// Verifies double shearing with inertia, a quartic that does not factor: slow flow is hyperbolic, fast flow mixed or
/// elliptic. All real and complex roots are compared with 256 bits.
#[test]
fn double_shearing_with_inertia_against_its_quartic() {
    let mut types = std::collections::BTreeMap::<String, usize>::new();
    let (mut worst_real, mut worst_complex) = (0.0f64, 0.0f64);
    for seed in 0..600 {
        let random = &mut seeded(0x72 + seed);
        let dilatancy = if seed.is_multiple_of(2) { Dilatancy::Zero } else { Dilatancy::Positive };
        let sample = tame(random, registry::DOUBLE_SHEARING, dilatancy, seed % 4 < 2);
        let speed = random.decades(1e-1, 10.0);
        let state = State { velocity: sample.state.velocity.map(|v| v * speed), ..sample.state };
        let sample = Sample::new(registry::DOUBLE_SHEARING, sample.parameters, state);
        let found = of(&sample);
        let wanted = steady_roots(&sample);
        assert_eq!(wanted.len(), 4);
        let off_real = |t: Complex64| t.im.abs() / (1.0 + t.norm_sqr());
        // Skip nearly double roots, which rounding may make real or complex.
        let nearest = wanted
            .iter()
            .enumerate()
            .flat_map(|(i, a)| wanted[..i].iter().map(|b| (a.to_c64() - b.to_c64()).norm()))
            .fold(f64::MAX, f64::min);
        if nearest < 1e-3 {
            continue;
        }
        let mut real = 0;
        for t in wanted.iter().map(|t| t.to_c64()) {
            if off_real(t) < 1e-30 {
                real += 1;
                // The characteristic is perpendicular to the wave vector (1, t).
                let angle = t.re.atan() + std::f64::consts::FRAC_PI_2;
                let own = found.real.iter().filter(|c| c.family.contains("stress"));
                let gap = own.map(|c| angle_between(c.angle, angle)).fold(f64::MAX, f64::min);
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
            (4, _) => Type::Hyperbolic,
            (0, Dilatancy::Zero) => Type::Elliptic,
            _ => Type::Mixed,
        };
        assert_eq!(found.kind, Some(kind));
        *types.entry(format!("{kind:?}")).or_default() += 1;
        // The density is convected along streamlines.
        let [v1, v2] = sample.state.velocity;
        let stream = found
            .real
            .iter()
            .filter(|c| c.family == "streamline" && angle_between(c.angle, v2.atan2(v1)) < 1e-13);
        assert_eq!(stream.count(), usize::from(dilatancy == Dilatancy::Positive), "{found:?}");
    }
    println!("{types:?}; deviations {worst_real:.1e} (angles), {worst_complex:.1e} (complex)");
    assert!(types.len() >= 2, "{types:?}");
}

/// Verifies that in a material at rest every direction is characteristic for fields that are only convected.
#[test]
fn at_rest_convected_fields_have_arbitrary_characteristics() {
    for seed in 0..100 {
        let random = &mut seeded(0x73 + seed);
        let at_rest = |random: &mut Random, kind, dilatancy| {
            let sample = tame(random, kind, dilatancy, seed.is_multiple_of(2));
            Sample::new(kind, sample.parameters, State { velocity: [0.0; 2], ..sample.state })
        };
        for (kind, dilatancy, arbitrary, each) in [
            (registry::HARRIS_GREKOVA, Dilatancy::Zero, &["spin"][..], 2),
            (registry::HARRIS_GREKOVA, Dilatancy::Positive, &["density", "spin"][..], 2),
            (registry::PLASTIC_POTENTIAL, Dilatancy::Zero, &[][..], 1),
            (registry::PLASTIC_POTENTIAL, Dilatancy::Positive, &["density"][..], 1),
            (registry::DOUBLE_SHEARING, Dilatancy::Zero, &[][..], 2),
            (registry::DOUBLE_SHEARING, Dilatancy::Positive, &["density"][..], 2),
        ] {
            let sample = at_rest(random, kind, dilatancy);
            let found = of(&sample);
            let mut own: Vec<&str> = found.arbitrary.iter().map(String::as_str).collect();
            own.sort_unstable();
            assert_eq!(own, arbitrary, "{kind:?} {dilatancy:?}");
            let epsilon = FRAC_PI_4 + 0.5 * sample.parameters.friction_angle;
            let mut real = found.real;
            for sign in [1.0, -1.0] {
                let angle = sample.state.stress_angle + sign * epsilon;
                let family = if each == 2 { "stress and velocity" } else { "stress" };
                // At rest the rotation rate of the double-shearing model is ∂ₜψ alone, so stress and velocity separate
                // there too.
                take(&mut real, angle, each, family);
            }
        }
    }
}

/// Verifies that the free-rotating model, with one equation too few, has no characteristics.
#[test]
fn free_rotating_determines_nothing() {
    for dilatancy in [Dilatancy::Zero, Dilatancy::Positive] {
        let sample = tame(&mut seeded(0x74), registry::FREE_ROTATING, dilatancy, true);
        assert_eq!(characteristics(&sample.system), Err(NoCharacteristics::Indeterminate));
    }
}
