//! Projection onto interlayer yield sets: optimality conditions, and the out-of-plane stress.

use crate::projection::random_solids::random_solid;
use crate::projection::residuals::{OPTIMALITY_TOLERANCE, OptimalityResiduals};
use crate::support::{DoubleDouble, RandomNumbers, dd, draw_log_uniform};
use wellposed_models::solid::parameters::{Isotropic, PlaneCompliances, Theory};
use wellposed_models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet};
use wellposed_models::yield_set::projection::PlaneMetric;

/// Plane-strain solid by its compliances, computed independently of the crate.
#[derive(Clone, Copy, Debug)]
pub struct PlaneSolid {
    pub normal_compliances: [f64; 2],
    /// Compliances a₂ and b₂ of the shear stresses, 1/Pa; in classical solids 1/(2μ) and 0.
    pub shear_compliances: [f64; 2],
    pub couple_modulus: Option<f64>,
    pub is_classical: bool,
}

impl PlaneSolid {
    pub fn from_isotropic(solid: &Isotropic) -> Self {
        let (lambda, mu) = (solid.lambda, solid.mu);
        let alpha = solid.microrotation.map(|m| m.alpha);
        let four = 4.0 * mu * (lambda + mu);
        Self {
            normal_compliances: [(lambda + 2.0 * mu) / four, lambda / four],
            shear_compliances: alpha.map_or([0.5 / mu, 0.0], |alpha| {
                [0.25 / alpha + 0.25 / mu, 0.25 / alpha - 0.25 / mu]
            }),
            couple_modulus: solid.couple().map(|c| c.gamma + c.eta),
            is_classical: alpha.is_none(),
        }
    }

    /// Computes the strain D⁻¹s of a stress difference s.
    pub fn strain(&self, s: &[DoubleDouble; 6]) -> [f64; 6] {
        let pair =
            |[a, b]: [f64; 2], x: DoubleDouble, y: DoubleDouble| (dd(a) * x - dd(b) * y).to_f64();
        let couple =
            |x: DoubleDouble| self.couple_modulus.map_or(0.0, |modulus| x.to_f64() / modulus);
        [
            pair(self.normal_compliances, s[0], s[1]),
            pair(self.normal_compliances, s[1], s[0]),
            pair(self.shear_compliances, s[2], s[3]),
            pair(self.shear_compliances, s[3], s[2]),
            couple(s[4]),
            couple(s[5]),
        ]
    }

    pub fn energy_norm(&self, s: &[f64; 6]) -> f64 {
        let strain = self.strain(&s.map(dd));
        s.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>().max(0.0).sqrt()
    }
}

/// Strength and friction [k, κ] of the shear conditions, then of the couple conditions.
pub fn strengths_and_frictions(set: &InterlayerYieldSet) -> [[f64; 2]; 2] {
    let couple = set.couple.map_or([0.0, 0.0], |c| [c.strength, c.friction]);
    [[set.shear_strength, set.shear_friction], couple]
}

/// Returns for the strain e = (e_n, e_s, e_c) = (`normal`, `shear`, `couple`) on one face the excess
/// e_n − κ_τ|e_s| − κ_μ|e_c|, zero for plastic strains off the apex and ≥ 0 at the apex, and the support function
/// sup e·w over the admissible stresses w.
fn face_support_function(
    set: &InterlayerYieldSet,
    [normal, shear, couple]: [f64; 3],
) -> (f64, f64) {
    let [[tau, kappa_tau], [m, kappa_m]] = strengths_and_frictions(set);
    let excess = normal - kappa_tau * shear.abs() - kappa_m * couple.abs();
    let cut_off = [(tau, kappa_tau), (m, kappa_m)]
        .into_iter()
        .filter(|(_, friction)| *friction > 0.0)
        .map(|(strength, friction)| strength / friction)
        .fold(f64::INFINITY, f64::min);
    let support = if cut_off.is_finite() { cut_off * excess.max(0.0) } else { 0.0 };
    (excess, tau * shear.abs() + m * couple.abs() + support)
}

fn compute_interlayer_residuals(
    set: &InterlayerYieldSet,
    metric: &PlaneMetric,
    solid: &PlaneSolid,
    trial: &[f64; 6],
) -> OptimalityResiduals {
    let projection = set.project(metric, trial);
    let stress = projection.stress;
    let [[tau, kappa_tau], [m, kappa_m]] = strengths_and_frictions(set);
    let mut feasibility = 0.0f64;
    let mut inside = true;
    for face in 0..2 {
        for (strength, friction, own, limited) in
            [(tau, kappa_tau, 2 + face, true), (m, kappa_m, 4 + face, set.couple.is_some())]
        {
            let value = stress[own].abs() + friction * stress[face] - strength;
            let size = stress[own].abs() + friction * stress[face].abs() + strength;
            if limited && value > 0.0 {
                feasibility = feasibility.max(value / size);
            }
            let at_trial = trial[own].abs() + friction * trial[face];
            inside &= !limited || at_trial <= strength;
        }
    }
    if *trial == [0.0; 6] {
        assert!(inside && stress == *trial);
        return OptimalityResiduals::default();
    }
    let change: [DoubleDouble; 6] = std::array::from_fn(|i| dd(trial[i]) - dd(stress[i]));
    let strain = solid.strain(&change);
    let (norm_trial, norm) = (solid.energy_norm(trial), solid.energy_norm(&stress));
    // Upper bounds of the components of a strain of energy norm 1.
    let compliance = [
        solid.normal_compliances[0],
        solid.shear_compliances[0],
        solid.couple_modulus.map_or(0.0, |a| 1.0 / a),
    ]
    .map(f64::sqrt);
    let scale = norm_trial * (compliance[0] + kappa_tau * compliance[1] + kappa_m * compliance[2]);
    let work_scale = (norm_trial * (norm + tau * compliance[1] + m * compliance[2])).max(1e-300);
    let friction_free = kappa_tau == 0.0 && kappa_m == 0.0;
    let residuals_for_shears = |shears: [f64; 2]| {
        let (mut normality, mut support) = (0.0f64, 0.0);
        for face in 0..2 {
            let (excess, face_support) =
                face_support_function(set, [strain[face], shears[face], strain[4 + face]]);
            let outside = if friction_free { excess.abs() } else { (-excess).max(0.0) };
            normality = normality.max(outside / scale);
            support += face_support;
        }
        let work: f64 = stress.iter().zip(strain).map(|(s, e)| s * e).sum();
        // The difference of support function and work is the complementarity Σ λ (k − n·s), a sum of non-negative
        // terms.
        let complementarity = (work - support).abs() / work_scale;
        (normality, complementarity)
    };
    let (normality, complementarity) = if solid.is_classical {
        // σ₁₂ = σ₂₁ does work on the sum of the two shear strains only: the conditions must hold for some division of
        // the sum between the two faces.
        let sum = strain[2] + strain[3];
        let mut candidates = vec![sum, 0.0, 0.5 * sum];
        if kappa_tau > 0.0 {
            let sign = sum.signum();
            candidates.push(sign * strain[0] / kappa_tau);
            candidates.push(sum - sign * strain[1] / kappa_tau);
        }
        candidates
            .into_iter()
            .map(|first| residuals_for_shears([first, sum - first]))
            .min_by(|a, b| a.0.max(a.1).total_cmp(&b.0.max(b.1)))
            .unwrap()
    } else {
        residuals_for_shears([strain[2], strain[3]])
    };
    assert!(projection.energy_lost >= 0.0, "{projection:?}");
    let lost = 0.5 * (norm_trial * norm_trial - norm * norm);
    let energy = (lost - projection.energy_lost).abs() / (norm_trial * norm_trial).max(1e-300);
    let again = set.project(metric, &stress).stress;
    let idempotence =
        solid.energy_norm(&std::array::from_fn(|i| again[i] - stress[i])) / norm.max(1e-300);
    if inside {
        assert_eq!((stress, projection.energy_lost), (*trial, 0.0), "inside");
    }
    OptimalityResiduals { feasibility, complementarity, normality, energy, idempotence }
}

#[derive(Clone, Copy, Debug)]
pub enum DegenerateKind {
    Regular,
    /// τ₀/κ_τ = μ₀/κ_μ: the four conditions of a face meet at a common apex.
    CommonApex,
    /// Some strengths and frictions are zero.
    ZeroConstants,
}

pub fn random_interlayer_set(
    random: &mut RandomNumbers,
    degenerate: DegenerateKind,
    couple: bool,
) -> InterlayerYieldSet {
    let shear_strength = draw_log_uniform(random, 3.0, 7.0);
    let shear_friction = draw_log_uniform(random, -2.0, 0.7);
    // Block size, m: order of magnitude of the ratio of couple constants to force constants.
    let length = draw_log_uniform(random, -3.0, 0.0);
    let mut own = InterlayerCoupleLimits {
        strength: shear_strength * length * draw_log_uniform(random, -1.0, 1.0),
        friction: length * draw_log_uniform(random, -1.0, 1.0),
        dilatancy: 0.0,
    };
    let mut set = InterlayerYieldSet {
        shear_strength,
        shear_friction,
        shear_dilatancy: 0.0,
        couple: couple.then_some(own),
    };
    match degenerate {
        DegenerateKind::Regular => {}
        DegenerateKind::CommonApex => {
            // The ratio of couple to shear constants is a power of two, so that τ₀/κ_τ = μ₀/κ_μ bitwise.
            let ratio = 2f64.powi(-(random.uniform_index(10) as i32));
            own.strength = set.shear_strength * ratio;
            own.friction = set.shear_friction * ratio;
        }
        DegenerateKind::ZeroConstants => {
            let mut zero = |x: &mut f64| *x = if random.uniform_index(2) == 0 { 0.0 } else { *x };
            zero(&mut set.shear_strength);
            zero(&mut set.shear_friction);
            zero(&mut own.strength);
            zero(&mut own.friction);
        }
    }
    set.couple = couple.then_some(own);
    set.check().unwrap()
}

fn random_interlayer_trial(
    random: &mut RandomNumbers,
    set: &InterlayerYieldSet,
    solid: &PlaneSolid,
) -> [f64; 6] {
    let [[tau, kappa_tau], [m, kappa_m]] = strengths_and_frictions(set);
    let strength = if tau > 0.0 { tau } else { 1e5 };
    let couple_strength = if m > 0.0 { m } else { 1e3 };
    let size = draw_log_uniform(random, -6.0, 6.0);
    let mut trial: [f64; 6] = std::array::from_fn(|i| match i {
        0..4 => strength * random.uniform(-1.0, 1.0),
        _ if solid.couple_modulus.is_some() => couple_strength * random.uniform(-1.0, 1.0),
        _ => 0.0,
    });
    if solid.is_classical {
        trial[3] = trial[2];
    }
    let drop = random.uniform_index(4);
    for (i, component) in trial.iter_mut().enumerate() {
        *component *= size;
        // In a quarter of the cases each component, except shear stresses of classical solids, is zero with probability
        // ½: the trial stress is in a plane or on an axis of symmetry of the set.
        if drop == 0 && random.uniform_index(2) == 0 && !(solid.is_classical && (2..4).contains(&i))
        {
            *component = 0.0;
        }
    }
    if random.uniform_index(4) == 0 {
        // In a quarter of the cases random components place the trial stress on or near edges, faces or apex of the
        // set.
        let off =
            if random.uniform_index(2) == 0 { 0.0 } else { draw_log_uniform(random, -16.0, -2.0) };
        for face in 0..2 {
            let cut_off = [(tau, kappa_tau), (m, kappa_m)]
                .into_iter()
                .filter(|(_, friction)| *friction > 0.0)
                .map(|(strength, friction)| strength / friction)
                .fold(f64::INFINITY, f64::min);
            if random.uniform_index(3) == 0 && cut_off.is_finite() {
                trial[face] = cut_off * (1.0 + off);
            }
            if !solid.is_classical && random.uniform_index(2) == 0 {
                trial[2 + face] = (tau - kappa_tau * trial[face]) * (1.0 + off);
            }
            if solid.couple_modulus.is_some() && random.uniform_index(2) == 0 {
                trial[4 + face] = (kappa_m * trial[face] - m) * (1.0 + off);
            }
        }
    }
    trial
}

/// Random plane-strain solid: classical (`kind` 0), reduced Cosserat (1), Cosserat (2) or cubic (3).
pub fn random_plane_solid(random: &mut RandomNumbers, kind: usize) -> (PlaneSolid, PlaneMetric) {
    let theory = [Theory::Classical, Theory::Reduced, Theory::Cosserat][kind.min(2)];
    let isotropic = random_solid(random, theory);
    if kind < 3 {
        return (PlaneSolid::from_isotropic(&isotropic), PlaneMetric::from(&isotropic));
    }
    let [a1, a2] = [draw_log_uniform(random, -10.0, -6.0), draw_log_uniform(random, -10.0, -6.0)];
    let compliances = PlaneCompliances {
        a1,
        b1: a1 * random.uniform(-0.98, 0.98),
        a2,
        b2: a2 * random.uniform(-0.98, 0.98),
        alpha2: draw_log_uniform(random, 0.0, 8.0),
        density: 1.0,
        inertia: 1.0,
    };
    let plane = PlaneSolid {
        normal_compliances: [compliances.a1, compliances.b1],
        shear_compliances: [compliances.a2, compliances.b2],
        couple_modulus: Some(compliances.alpha2),
        is_classical: false,
    };
    (plane, PlaneMetric::from(&compliances))
}

/// Projections onto interlayer sets satisfy the optimality conditions, also for sets with a common apex or zero
/// constants.
#[test]
fn interlayer_projections_are_optimal() {
    let kinds = ["classical", "reduced", "Cosserat", "cubic"];
    for degenerate in
        [DegenerateKind::Regular, DegenerateKind::CommonApex, DegenerateKind::ZeroConstants]
    {
        for (kind, name) in kinds.into_iter().enumerate() {
            let mut random = RandomNumbers::new(2000 + kind as u64);
            let mut worst = OptimalityResiduals::default();
            let mut inside = 0;
            for _ in 0..20_000 {
                let (solid, metric) = random_plane_solid(&mut random, kind);
                let set =
                    random_interlayer_set(&mut random, degenerate, solid.couple_modulus.is_some());
                let trial = random_interlayer_trial(&mut random, &set, &solid);
                let residuals = compute_interlayer_residuals(&set, &metric, &solid, &trial);
                residuals.assert_below_tolerance((
                    name,
                    degenerate,
                    set,
                    solid,
                    trial,
                    set.project(&metric, &trial),
                ));
                worst.accumulate_max(&residuals);
                inside += usize::from(set.project(&metric, &trial).stress == trial);
            }
            println!("{name}, {degenerate:?}: {inside} inside, {worst:?}");
            assert!(inside < 12_000, "{name}: {inside} of 20,000 inside");
        }
    }
}

/// The out-of-plane stress follows from the same plastic strain: with Δσ₃₃ = ν (Δσ₁₁ + Δσ₂₂) Hooke's law in space gives
/// a plastic strain without out-of-plane component. Among the admissible stresses the work of this strain is largest at
/// the projected stress, so the projection minimises the energy over σ₃₃ too.
#[test]
fn out_of_plane_stress_follows_from_the_in_plane_plastic_strain() {
    let mut random = RandomNumbers::new(5);
    let mut moved = 0;
    for _ in 0..200 {
        let solid = random_solid(&mut random, Theory::Cosserat);
        let (metric, plane) = (PlaneMetric::from(&solid), PlaneSolid::from_isotropic(&solid));
        let set = random_interlayer_set(&mut random, DegenerateKind::Regular, true);
        let trial = random_interlayer_trial(&mut random, &set, &plane);
        let stress = set.project(&metric, &trial).stress;
        moved += usize::from(stress != trial);
        let change: [f64; 6] = std::array::from_fn(|i| trial[i] - stress[i]);
        let poisson = 0.5 * solid.lambda / (solid.lambda + solid.mu);
        let across = poisson * (change[0] + change[1]);
        let mean_part =
            solid.lambda * (change[0] + change[1] + across) / (3.0 * solid.lambda + 2.0 * solid.mu);
        let [first, second, third] =
            [change[0], change[1], across].map(|own| (own - mean_part) / (2.0 * solid.mu));
        let size = (change[0].abs() + change[1].abs()) / solid.mu;
        assert!(third.abs() <= 1e-13 * size, "{third:e} of {size:e}");
        let mut strain = plane.strain(&change.map(dd));
        (strain[0], strain[1]) = (first, second);
        for _ in 0..20 {
            let other = random_interlayer_trial(&mut random, &set, &plane);
            let other = set.project(&metric, &other).stress;
            let work: f64 = (0..6).map(|i| strain[i] * (other[i] - stress[i])).sum();
            let size = plane.energy_norm(&trial)
                * (plane.energy_norm(&other) + plane.energy_norm(&stress));
            assert!(work <= OPTIMALITY_TOLERANCE * size, "{work:e} of {size:e}");
        }
    }
    assert!(moved > 50, "{moved} of 200 outside");
}
