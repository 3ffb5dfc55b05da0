//! Projection onto interlayer yield sets: optimality, and the out-of-plane stress.

use crate::random_solids::{Rotation, solid};
use crate::residuals::{OPTIMALITY, Residuals};
use crate::support::{Random, Wide, decades, wide};
use wellposed_models::solid::parameters::{Isotropic, PlaneCompliances};
use wellposed_models::yield_set::parameters::{Interlayer, InterlayerCouple};
use wellposed_models::yield_set::projection::PlaneMetric;

/// Plane-strain solid by its compliances, computed independently of the crate.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    pub normal: [f64; 2],
    /// Compliances a₂, b₂, 1/Pa; in classical solids 1/(2μ) and 0.
    pub shear: [f64; 2],
    pub couple: Option<f64>,
    pub classical: bool,
}

impl Plane {
    pub fn of(solid: &Isotropic) -> Self {
        let (lambda, mu) = (solid.lambda, solid.mu);
        let alpha = solid.microrotation.map(|m| m.alpha);
        let four = 4.0 * mu * (lambda + mu);
        Self {
            normal: [(lambda + 2.0 * mu) / four, lambda / four],
            shear: alpha.map_or([0.5 / mu, 0.0], |alpha| {
                [0.25 / alpha + 0.25 / mu, 0.25 / alpha - 0.25 / mu]
            }),
            couple: solid.couple().map(|c| c.gamma + c.eta),
            classical: alpha.is_none(),
        }
    }

    /// Computes the strain D⁻¹s of a stress difference s.
    pub fn strain(&self, s: &[Wide; 6]) -> [f64; 6] {
        let pair = |[a, b]: [f64; 2], x: Wide, y: Wide| (wide(a) * x - wide(b) * y).value();
        let couple = |x: Wide| self.couple.map_or(0.0, |modulus| x.value() / modulus);
        [
            pair(self.normal, s[0], s[1]),
            pair(self.normal, s[1], s[0]),
            pair(self.shear, s[2], s[3]),
            pair(self.shear, s[3], s[2]),
            couple(s[4]),
            couple(s[5]),
        ]
    }

    pub fn norm(&self, s: &[f64; 6]) -> f64 {
        let strain = self.strain(&s.map(wide));
        s.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>().max(0.0).sqrt()
    }
}

/// Strength and friction [k, κ] of the shear and couple conditions.
pub fn constants(set: &Interlayer) -> [[f64; 2]; 2] {
    let couple = set.couple.map_or([0.0, 0.0], |c| [c.strength, c.friction]);
    [[set.shear_strength, set.shear_friction], couple]
}

/// For the strain e = (`normal`, `shear`, `couple`) of one face: the excess e_n − κ_τ|e_s| − κ_μ|e_c|, zero for plastic
/// strains off the apex and ≥ 0 at it, and the support function sup e·w over the admissible stresses w.
fn face_support(set: &Interlayer, [normal, shear, couple]: [f64; 3]) -> (f64, f64) {
    let [[tau, kappa_tau], [m, kappa_m]] = constants(set);
    let excess = normal - kappa_tau * shear.abs() - kappa_m * couple.abs();
    let cut_off = [(tau, kappa_tau), (m, kappa_m)]
        .into_iter()
        .filter(|(_, friction)| *friction > 0.0)
        .map(|(strength, friction)| strength / friction)
        .fold(f64::INFINITY, f64::min);
    let most = if cut_off.is_finite() { cut_off * excess.max(0.0) } else { 0.0 };
    (excess, tau * shear.abs() + m * couple.abs() + most)
}

fn interlayer_residuals(
    set: &Interlayer,
    metric: &PlaneMetric,
    solid: &Plane,
    trial: &[f64; 6],
) -> Residuals {
    let projection = set.project(metric, trial);
    let stress = projection.stress;
    let [[tau, kappa_tau], [m, kappa_m]] = constants(set);
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
        return Residuals::default();
    }
    let change: [Wide; 6] = std::array::from_fn(|i| wide(trial[i]) - wide(stress[i]));
    let strain = solid.strain(&change);
    let (norm_trial, norm) = (solid.norm(trial), solid.norm(&stress));
    // Upper bounds of the components of a strain of energy norm 1.
    let compliance =
        [solid.normal[0], solid.shear[0], solid.couple.map_or(0.0, |a| 1.0 / a)].map(f64::sqrt);
    let scale = norm_trial * (compliance[0] + kappa_tau * compliance[1] + kappa_m * compliance[2]);
    let work_scale = (norm_trial * (norm + tau * compliance[1] + m * compliance[2])).max(1e-300);
    let friction_free = kappa_tau == 0.0 && kappa_m == 0.0;
    let of_shears = |shears: [f64; 2]| {
        let (mut normality, mut support) = (0.0f64, 0.0);
        for face in 0..2 {
            let (excess, most) = face_support(set, [strain[face], shears[face], strain[4 + face]]);
            let outside = if friction_free { excess.abs() } else { (-excess).max(0.0) };
            normality = normality.max(outside / scale);
            support += most;
        }
        let work: f64 = stress.iter().zip(strain).map(|(s, e)| s * e).sum();
        // Σ λ × distance from the conditions, a sum of non-negative terms.
        let complementarity = (work - support).abs() / work_scale;
        (normality, complementarity)
    };
    let (normality, complementarity) = if solid.classical {
        // Only the sum of the two shear strains does work on σ₁₂ = σ₂₁: the conditions must hold for some division of
        // the sum between the faces.
        let sum = strain[2] + strain[3];
        let mut candidates = vec![sum, 0.0, 0.5 * sum];
        if kappa_tau > 0.0 {
            let sign = sum.signum();
            candidates.push(sign * strain[0] / kappa_tau);
            candidates.push(sum - sign * strain[1] / kappa_tau);
        }
        candidates
            .into_iter()
            .map(|first| of_shears([first, sum - first]))
            .min_by(|a, b| a.0.max(a.1).total_cmp(&b.0.max(b.1)))
            .unwrap()
    } else {
        of_shears([strain[2], strain[3]])
    };
    assert!(projection.energy_lost >= 0.0, "{projection:?}");
    let lost = 0.5 * (norm_trial * norm_trial - norm * norm);
    let energy = (lost - projection.energy_lost).abs() / (norm_trial * norm_trial).max(1e-300);
    let again = set.project(metric, &stress).stress;
    let idempotence = solid.norm(&std::array::from_fn(|i| again[i] - stress[i])) / norm.max(1e-300);
    if inside {
        assert_eq!((stress, projection.energy_lost), (*trial, 0.0), "inside");
    }
    Residuals { feasibility, complementarity, normality, energy, idempotence }
}

#[derive(Clone, Copy, Debug)]
pub enum Degenerate {
    No,
    /// τ₀/κ_τ = μ₀/κ_μ: the four conditions of a face meet at a common apex.
    CommonApex,
    /// Some strengths and frictions are zero.
    Zeros,
}

pub fn interlayer_set(random: &mut Random, degenerate: Degenerate, couple: bool) -> Interlayer {
    let shear_strength = decades(random, 3.0, 7.0);
    let shear_friction = decades(random, -2.0, 0.7);
    // Length of the order of a block, m, by which couple and force constants differ.
    let length = decades(random, -3.0, 0.0);
    let mut own = InterlayerCouple {
        strength: shear_strength * length * decades(random, -1.0, 1.0),
        friction: length * decades(random, -1.0, 1.0),
        dilatancy: 0.0,
    };
    let mut set = Interlayer {
        shear_strength,
        shear_friction,
        shear_dilatancy: 0.0,
        couple: couple.then_some(own),
    };
    match degenerate {
        Degenerate::No => {}
        Degenerate::CommonApex => {
            // Ratios are powers of two, so that the apices are bitwise equal.
            let ratio = 2f64.powi(-(random.below(10) as i32));
            own.strength = set.shear_strength * ratio;
            own.friction = set.shear_friction * ratio;
        }
        Degenerate::Zeros => {
            let mut zero = |x: &mut f64| *x = if random.below(2) == 0 { 0.0 } else { *x };
            zero(&mut set.shear_strength);
            zero(&mut set.shear_friction);
            zero(&mut own.strength);
            zero(&mut own.friction);
        }
    }
    set.couple = couple.then_some(own);
    set.check().unwrap()
}

fn interlayer_trial(random: &mut Random, set: &Interlayer, solid: &Plane) -> [f64; 6] {
    let [[tau, kappa_tau], [m, kappa_m]] = constants(set);
    let strength = if tau > 0.0 { tau } else { 1e5 };
    let couple_strength = if m > 0.0 { m } else { 1e3 };
    let size = decades(random, -6.0, 6.0);
    let mut trial: [f64; 6] = std::array::from_fn(|i| match i {
        0..4 => strength * random.within(-1.0, 1.0),
        _ if solid.couple.is_some() => couple_strength * random.within(-1.0, 1.0),
        _ => 0.0,
    });
    if solid.classical {
        trial[3] = trial[2];
    }
    let drop = random.below(4);
    for (i, component) in trial.iter_mut().enumerate() {
        *component *= size;
        // Some components zero: planes and axes of symmetry.
        if drop == 0 && random.below(2) == 0 && !(solid.classical && (2..4).contains(&i)) {
            *component = 0.0;
        }
    }
    if random.below(4) == 0 {
        // On or near edges, faces and the apex.
        let off = if random.below(2) == 0 { 0.0 } else { decades(random, -16.0, -2.0) };
        for face in 0..2 {
            let cut_off = [(tau, kappa_tau), (m, kappa_m)]
                .into_iter()
                .filter(|(_, friction)| *friction > 0.0)
                .map(|(strength, friction)| strength / friction)
                .fold(f64::INFINITY, f64::min);
            if random.below(3) == 0 && cut_off.is_finite() {
                trial[face] = cut_off * (1.0 + off);
            }
            if !solid.classical && random.below(2) == 0 {
                trial[2 + face] = (tau - kappa_tau * trial[face]) * (1.0 + off);
            }
            if solid.couple.is_some() && random.below(2) == 0 {
                trial[4 + face] = (kappa_m * trial[face] - m) * (1.0 + off);
            }
        }
    }
    trial
}

/// Random plane-strain solid: classical (`kind` 0), reduced Cosserat (1), Cosserat (2) or cubic (3).
pub fn plane_solid(random: &mut Random, kind: usize) -> (Plane, PlaneMetric) {
    let rotation = [Rotation::Classical, Rotation::Reduced, Rotation::Cosserat][kind.min(2)];
    let isotropic = solid(random, rotation);
    if kind < 3 {
        return (Plane::of(&isotropic), PlaneMetric::from(&isotropic));
    }
    let [a1, a2] = [decades(random, -10.0, -6.0), decades(random, -10.0, -6.0)];
    let compliances = PlaneCompliances {
        a1,
        b1: a1 * random.within(-0.98, 0.98),
        a2,
        b2: a2 * random.within(-0.98, 0.98),
        alpha2: decades(random, 0.0, 8.0),
        density: 1.0,
        inertia: 1.0,
    };
    let plane = Plane {
        normal: [compliances.a1, compliances.b1],
        shear: [compliances.a2, compliances.b2],
        couple: Some(compliances.alpha2),
        classical: false,
    };
    (plane, PlaneMetric::from(&compliances))
}

/// Projections onto interlayer sets satisfy the optimality conditions, also for degenerate sets.
#[test]
fn interlayer_projections_are_optimal() {
    let kinds = ["classical", "reduced", "Cosserat", "cubic"];
    for degenerate in [Degenerate::No, Degenerate::CommonApex, Degenerate::Zeros] {
        for (kind, name) in kinds.into_iter().enumerate() {
            let mut random = Random::new(2000 + kind as u64);
            let mut worst = Residuals::default();
            let mut inside = 0;
            for _ in 0..20_000 {
                let (solid, metric) = plane_solid(&mut random, kind);
                let set = interlayer_set(&mut random, degenerate, solid.couple.is_some());
                let trial = interlayer_trial(&mut random, &set, &solid);
                let residuals = interlayer_residuals(&set, &metric, &solid, &trial);
                residuals.check((
                    name,
                    degenerate,
                    set,
                    solid,
                    trial,
                    set.project(&metric, &trial),
                ));
                worst.worst(&residuals);
                inside += usize::from(set.project(&metric, &trial).stress == trial);
            }
            println!("{name}, {degenerate:?}: {inside} inside, {worst:?}");
            assert!(inside < 12_000, "{name}: {inside} of 20,000 inside");
        }
    }
}

/// The out-of-plane stress follows from the same plastic strain: with Δσ₃₃ = ν (Δσ₁₁ + Δσ₂₂) Hooke's law in space gives
/// a plastic strain without out-of-plane component. Its work is largest at the projection among admissible stresses, so
/// the projection minimises the energy over σ₃₃ too.
#[test]
fn stress_across_the_plane() {
    let mut random = Random::new(5);
    let mut moved = 0;
    for _ in 0..200 {
        let solid = solid(&mut random, Rotation::Cosserat);
        let (metric, plane) = (PlaneMetric::from(&solid), Plane::of(&solid));
        let set = interlayer_set(&mut random, Degenerate::No, true);
        let trial = interlayer_trial(&mut random, &set, &plane);
        let stress = set.project(&metric, &trial).stress;
        moved += usize::from(stress != trial);
        let change: [f64; 6] = std::array::from_fn(|i| trial[i] - stress[i]);
        let poisson = 0.5 * solid.lambda / (solid.lambda + solid.mu);
        let across = poisson * (change[0] + change[1]);
        let share =
            solid.lambda * (change[0] + change[1] + across) / (3.0 * solid.lambda + 2.0 * solid.mu);
        let [first, second, third] =
            [change[0], change[1], across].map(|own| (own - share) / (2.0 * solid.mu));
        let size = (change[0].abs() + change[1].abs()) / solid.mu;
        assert!(third.abs() <= 1e-13 * size, "{third:e} of {size:e}");
        let mut strain = plane.strain(&change.map(wide));
        (strain[0], strain[1]) = (first, second);
        for _ in 0..20 {
            let other = interlayer_trial(&mut random, &set, &plane);
            let other = set.project(&metric, &other).stress;
            let work: f64 = (0..6).map(|i| strain[i] * (other[i] - stress[i])).sum();
            let size = plane.norm(&trial) * (plane.norm(&other) + plane.norm(&stress));
            assert!(work <= OPTIMALITY * size, "{work:e} of {size:e}");
        }
    }
    assert!(moved > 50, "{moved} of 200 outside");
}
