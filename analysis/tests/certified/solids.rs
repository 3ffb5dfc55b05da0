//! Boxes of solids with one slipping layer in the plane and with yield cones in space.

use super::{BoxNumber, BoxSample, Counts, Family, compare, draw_box, random_half};
use crate::support::states::{RandomNumbers, seeded_generator};
use models::common::scalar::Scalar;
use models::common::taylor_model::TaylorModel;
use models::elastoplastic::{PlasticState, Solid};
use models::solid::ElasticLaw;
use models::solid::parameters::{Isotropic, Microrotation};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerYieldSet, Mises};
use std::sync::LazyLock;
use wellposed_analysis::certified::{BoxVerdict, DirectionForm, SlippingLayers, YieldCone};
use wellposed_analysis::solids::{AcousticTensorCache, SolidAssessor};

pub const FAMILIES: [Family; 3] = [
    Family {
        name: "slipping layers with spin",
        draw: |random| {
            let half = random_half(random);
            draw_layers(random, half, true)
        },
        share: 0.1,
        least: [50, 20],
    },
    Family {
        name: "slipping layers",
        draw: |random| {
            let half = random_half(random);
            draw_layers(random, half, false)
        },
        share: 0.05,
        least: [0, 70],
    },
    Family {
        name: "yield cones",
        draw: |random| {
            let half = random_half(random);
            draw_cone(random, half)
        },
        share: 0.1,
        least: [50, 30],
    },
];

/// Verdicts on the solids of a box; the proof must not decide where a solid has no response.
fn sample<const N: usize>(
    proved: BoxVerdict,
    numbers: [BoxNumber; N],
    create: impl Fn([f64; N]) -> Solid + 'static,
) -> BoxSample<'static> {
    static CACHE: LazyLock<AcousticTensorCache> = LazyLock::new(AcousticTensorCache::default);
    let mut assessor = SolidAssessor::new(&CACHE);
    let verdict_at = move |point: [f64; 2]| {
        let solid = create(numbers.map(|own| own.at(point)));
        assessor.assess(&solid).ok().map(|(found, _)| found.verdict)
    };
    BoxSample { proved, verdict_at: Box::new(verdict_at) }
}

fn isotropic(lambda: f64, mu: f64, microrotation: Option<Microrotation>) -> ElasticLaw {
    Isotropic::new(lambda, mu, 1.7, microrotation).expect("positive moduli").into()
}

/// Layers of which two of λ, μ, α, friction and dilatancy run over intervals.
fn draw_layers(random: &mut RandomNumbers, half: f64, has_spin: bool) -> BoxSample<'static> {
    let ranges = [[0.2, 2.0], [0.3, 2.0], [0.05, 1.0], [0.05, 1.2], [-0.3, 1.2]];
    let mut numbers = draw_box(random, ranges, half);
    if half > 0.0 && random.bernoulli(0.2) {
        // Associated flow inside or nearby.
        numbers[4] = numbers[4].moved_to(numbers[3].low + half * random.uniform(-4.0, 4.0));
    }
    let is_positive = random.bernoulli(0.5);
    let [lambda, mu, alpha, friction, dilatancy] = numbers.map(BoxNumber::enclose);
    let alpha = if has_spin { alpha } else { TaylorModel::ZERO };
    let proved =
        SlippingLayers { lambda, mu, alpha, friction, dilatancy, is_positive }.prove().verdict;
    sample(proved, numbers, move |[lambda, mu, alpha, friction, dilatancy]| {
        let microrotation = has_spin.then_some(Microrotation { alpha, inertia: 0.8, couple: None });
        let set = InterlayerYieldSet {
            shear_strength: 1.0,
            shear_friction: friction,
            shear_dilatancy: dilatancy,
            couple: None,
        };
        let set = YieldSet::from(set.check().expect("a set"));
        let active = [usize::from(!is_positive)];
        let plastic = PlasticState::with_active(set, &active).expect("a condition");
        Solid::new(isotropic(lambda, mu, microrotation), 2, Some(plastic))
    })
}

/// Cones under stresses with σ₁₁ = −σ₂₂ = ±1, of which two of λ, μ, friction, dilatancy, hardening and σ₃₃ run over intervals.
fn draw_cone(random: &mut RandomNumbers, half: f64) -> BoxSample<'static> {
    let ranges = [[0.0, 2.0], [0.3, 2.0], [0.0, 1.2], [-0.3, 1.2], [-0.4, 0.3], [-1.5, 1.5]];
    let mut numbers = draw_box(random, ranges, half);
    if half > 0.0 && random.bernoulli(0.2) {
        // Associated flow inside or nearby.
        numbers[3] = numbers[3].moved_to(numbers[2].low + half * random.uniform(-4.0, 4.0));
    }
    let unit = if random.bernoulli(0.5) { 1.0 } else { -1.0 };
    let [lambda, mu, friction, dilatancy, hardening, third] = numbers.map(BoxNumber::enclose);
    let exact = TaylorModel::from_exact;
    let principal_stresses = [exact(unit), exact(-unit), third];
    let proved = YieldCone { lambda, mu, friction, dilatancy, hardening, principal_stresses }
        .prove()
        .verdict;
    sample(proved, numbers, move |[lambda, mu, friction, dilatancy, hardening, third]| {
        let mut direction = Stress::default();
        (direction.force[0][0], direction.force[1][1], direction.force[2][2]) =
            (unit, -unit, third);
        let set = Mises { hardening, ..Mises::new_drucker_prager(10.0, friction, dilatancy) };
        let set = YieldSet::from(set.check().expect("a set"));
        let plastic = PlasticState::from_stress(set, 0.0, &direction, 0.0).expect("a state");
        Solid::new(isotropic(lambda, mu, None), 3, Some(plastic))
    })
}

/// Compares boxes of three sizes, one point of each; both verdicts are frequent, and hardly a point is not decided.
fn compare_sizes(
    seed: u64,
    boxes: usize,
    may_be_well_posed: bool,
    draw: impl Fn(&mut RandomNumbers, f64) -> BoxSample<'static> + Sync,
) {
    for (offset, half) in [0.0, 1e-3, 1e-2].into_iter().enumerate() {
        let seed = seed + offset as u64;
        let counts: Counts = compare(seed, [boxes, 1], |random| draw(random, half));
        println!("boxes of {half}: {counts:?}");
        let is_well_posed = !may_be_well_posed || 10 * counts.well_posed > boxes;
        assert!(is_well_posed && 10 * counts.ill_posed > boxes, "{counts:?}");
        // Undecided: boxes that the boundary crosses, and states without response.
        if half == 0.0 {
            assert!(20 * counts.open < boxes, "{counts:?}");
        }
    }
}

#[test]
fn slip_along_layers_is_decided_as_by_the_dispersion_polynomial() {
    for has_spin in [false, true] {
        // Without microrotation there is flutter but for associated flow.
        compare_sizes(31, 1500, has_spin, |random, half| draw_layers(random, half, has_spin));
    }
}

#[test]
fn shear_bands_are_decided_as_by_the_search_over_the_sphere() {
    compare_sizes(34, 100, true, draw_cone);
}

/// Under strong friction, κ > √3, stresses near uniaxial compression never reach the cone: with σ₃₃ = −1 and |q| ≤ 0.06 those of
/// the largest |q| do, but not q = 0.
#[test]
fn stresses_that_never_yield_are_not_decided() {
    let verdict = |q: [f64; 2]| {
        let exact = TaylorModel::from_exact;
        let q = TaylorModel::parameter(0, q[0], q[1]);
        YieldCone {
            lambda: exact(1.0),
            mu: exact(1.0),
            friction: exact(1.74),
            dilatancy: exact(1.7),
            hardening: exact(0.2),
            principal_stresses: [q, -q, exact(-1.0)],
        }
        .prove()
        .verdict
    };
    assert_eq!(verdict([-0.06, 0.06]), BoxVerdict::NotDecided);
    assert_eq!(verdict([0.3, 0.31]), BoxVerdict::WellPosed);
}

/// A form whose least value over all directions is known: (n₁ − a n₂)² (n₁² + n₂²) + c (n₁² + n₂²)², with the least value c
/// in the direction (a, 1), found positive or negative however small c is against the box.
#[test]
fn signs_of_forms_are_those_of_their_least_values() {
    let random = &mut seeded_generator(33);
    for _ in 0..2000 {
        let (a, half) = (random.uniform(-3.0, 3.0), 10f64.powf(random.uniform(-6.0, -1.0)));
        let c = random.signed_uniform(1.5, 5.0) * half;
        let level = TaylorModel::parameter(0, c - half, c + half);
        let exact = TaylorModel::from_exact;
        let round = DirectionForm::new(vec![exact(1.0), exact(0.0), exact(1.0)]);
        let line = DirectionForm::new(vec![exact(1.0), exact(-a)]);
        let form = &(&(&line * &line) * &round) + &(level * &(&round * &round));
        assert_eq!(form.prove_positive().is_some(), c > 0.0, "{a} {c} {half}");
        assert_eq!(form.prove_negative().is_some(), c < 0.0, "{a} {c} {half}");
    }
}
