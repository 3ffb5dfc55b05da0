//! Verdicts proved over boxes against verdicts at points by other methods.

use crate::support::states::{RandomNumbers, seeded_generator};
use models::common::scalar::Scalar;
use models::common::taylor_model::TaylorModel;
use models::elastoplastic::{PlasticState, Solid};
use models::solid::ElasticLaw;
use models::solid::parameters::{Isotropic, Microrotation};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerYieldSet, Mises};
use wellposed_analysis::certified::{BoxVerdict, DirectionForm, SlippingLayers, YieldCone};
use wellposed_analysis::growth::Verdict;
use wellposed_analysis::solids::{AcousticTensorCache, SolidAssessor};

/// A number that runs over an interval along an axis of the box, or that is constant.
#[derive(Clone, Copy, Debug)]
struct BoxNumber {
    low: f64,
    high: f64,
    axis: Option<usize>,
}

impl BoxNumber {
    fn enclose(self) -> TaylorModel {
        match self.axis {
            Some(axis) => TaylorModel::parameter(axis, self.low, self.high),
            None => TaylorModel::from_rounded(self.low),
        }
    }

    /// The value at a point (u, v) of the square.
    fn at(self, point: [f64; 2]) -> f64 {
        let place = self.axis.map_or(0.0, |axis| 0.5 * (1.0 + point[axis]));
        self.low + (self.high - self.low) * place
    }
}

/// Draws `N` numbers of which two run over intervals of the size `half`.
fn draw_box<const N: usize>(
    random: &mut RandomNumbers,
    ranges: [[f64; 2]; N],
    half: f64,
) -> [BoxNumber; N] {
    let first = random.uniform_index(N);
    let second = (first + 1 + random.uniform_index(N - 1)) % N;
    std::array::from_fn(|index| {
        let [low, high] = ranges[index];
        let value = random.uniform(low, high);
        let axis = [first, second].iter().position(|&own| own == index);
        let half = if axis.is_some() { half * (high - low) } else { 0.0 };
        BoxNumber { low: value - half, high: value + half, axis }
    })
}

fn random_point(random: &mut RandomNumbers) -> [f64; 2] {
    // Corners and edges as often as the inside.
    [0; 2].map(|_| random.uniform(-1.5, 1.5).clamp(-1.0, 1.0))
}

/// Number of decided boxes, of those at whose points the other method decides the same, and of undecided ones.
#[derive(Debug, Default)]
struct Counts {
    well_posed: usize,
    ill_posed: usize,
    open: usize,
}

/// Compares the verdict over `boxes` boxes of each size with verdicts at points of them.
fn compare<const N: usize>(
    seed: u64,
    (boxes, may_be_well_posed): (usize, bool),
    ranges: [[f64; 2]; N],
    prove: impl Fn([TaylorModel; N], bool) -> BoxVerdict,
    create: impl Fn([f64; N], bool) -> Solid,
) {
    let random = &mut seeded_generator(seed);
    let cache = AcousticTensorCache::default();
    let mut assessor = SolidAssessor::new(&cache);
    for half in [0.0, 1e-3, 1e-2] {
        let mut counts = Counts::default();
        for _ in 0..boxes {
            let numbers = draw_box(random, ranges, half);
            let flag = random.bernoulli(0.5);
            let proved = prove(numbers.map(BoxNumber::enclose), flag);
            let own = match proved {
                BoxVerdict::WellPosed => &mut counts.well_posed,
                BoxVerdict::IllPosed => &mut counts.ill_posed,
                BoxVerdict::NotDecided => &mut counts.open,
            };
            *own += 1;
            let values = numbers.map(|own| own.at(random_point(random)));
            let Ok((found, _)) = assessor.assess(&create(values, flag)) else {
                assert_eq!(proved, BoxVerdict::NotDecided, "no response at {values:?}");
                continue;
            };
            let is_contradiction = matches!(
                (proved, &found.verdict),
                (BoxVerdict::WellPosed, Verdict::IllPosed { .. })
                    | (BoxVerdict::IllPosed, Verdict::WellPosed)
            );
            assert!(!is_contradiction, "{proved:?} at {values:?} {flag}: {found:?}");
        }
        println!("boxes of {half}: {counts:?}");
        let is_well_posed = if may_be_well_posed { 10 * counts.well_posed > boxes } else { true };
        assert!(is_well_posed && 10 * counts.ill_posed > boxes, "{counts:?}");
        // Undecided: boxes that the boundary crosses, and states without response.
        if half == 0.0 {
            assert!(20 * counts.open < boxes, "{counts:?}");
        }
    }
}

fn isotropic(lambda: f64, mu: f64, microrotation: Option<Microrotation>) -> ElasticLaw {
    Isotropic::new(lambda, mu, 1.7, microrotation).expect("positive moduli").into()
}

#[test]
fn slip_along_layers_is_decided_as_by_the_dispersion_polynomial() {
    // λ, μ, α, friction, dilatancy.
    let ranges = [[0.2, 2.0], [0.3, 2.0], [0.05, 1.0], [0.05, 1.2], [-0.3, 1.2]];
    for has_spin in [false, true] {
        let prove = |numbers: [TaylorModel; 5], is_positive| {
            let [lambda, mu, alpha, friction, dilatancy] = numbers;
            let alpha = if has_spin { alpha } else { TaylorModel::ZERO };
            SlippingLayers { lambda, mu, alpha, friction, dilatancy, is_positive }.verdict()
        };
        let create = |[lambda, mu, alpha, friction, dilatancy]: [f64; 5], is_positive: bool| {
            let microrotation =
                has_spin.then_some(Microrotation { alpha, inertia: 0.8, couple: None });
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
        };
        // Without microrotation there is flutter but for associated flow.
        compare(31, (1500, has_spin), ranges, prove, create);
    }
}

#[test]
fn shear_bands_are_decided_as_by_the_search_over_the_sphere() {
    // λ, μ, friction, dilatancy, hardening, σ₃₃, by σ₁₁ = −σ₂₂ = 1.
    let ranges = [[0.0, 2.0], [0.3, 2.0], [0.0, 1.2], [-0.3, 1.2], [-0.4, 0.3], [-1.5, 1.5]];
    let prove = |numbers: [TaylorModel; 6], is_positive| {
        let [lambda, mu, friction, dilatancy, hardening, third] = numbers;
        let unit = TaylorModel::from_exact(if is_positive { 1.0 } else { -1.0 });
        let principal_stresses = [unit, -unit, third];
        YieldCone { lambda, mu, friction, dilatancy, hardening, principal_stresses }.verdict()
    };
    let create = |numbers: [f64; 6], is_positive: bool| {
        let [lambda, mu, friction, dilatancy, hardening, third] = numbers;
        let unit = if is_positive { 1.0 } else { -1.0 };
        let mut direction = Stress::default();
        (direction.force[0][0], direction.force[1][1], direction.force[2][2]) =
            (unit, -unit, third);
        let set = Mises { hardening, ..Mises::new_drucker_prager(10.0, friction, dilatancy) };
        let set = YieldSet::from(set.check().expect("a set"));
        let plastic = PlasticState::from_stress(set, 0.0, &direction, 0.0).expect("a state");
        Solid::new(isotropic(lambda, mu, None), 3, Some(plastic))
    };
    compare(32, (100, true), ranges, prove, create);
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
        .verdict()
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
        assert_eq!(form.is_positive(), c > 0.0, "{a} {c} {half}");
        assert_eq!(form.negative_direction().is_some(), c < 0.0, "{a} {c} {half}");
    }
}
