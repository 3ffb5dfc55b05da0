//! Projections onto yield sets: the conditions of optimality, written with the support function of
//! each set and evaluated in twice the precision, and a conic solver's answer.
//!
//! s = P(s̄) exactly if s ∈ F and the plastic strain e = D⁻¹(s̄ − s) does its greatest work over F
//! at s: e·s = sup over w ∈ F of e·w. The supremum is finite on a cone of e only, which e must be in.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors")]

mod support;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SecondOrderConeT,
    SolverStatus, SupportedConeT,
};
use support::{Random, Wide, wide};
use wellposed_models::solid::parameters::{
    CoupleModuli, Isotropic, Microrotation, PlaneCompliances,
};
use wellposed_models::solid::stress::Stress;
use wellposed_models::yield_set::parameters::{Interlayer, InterlayerCouple, Mises};
use wellposed_models::yield_set::projection::PlaneMetric;

/// The accuracy asked of every condition of optimality, relative to the terms that it compares.
const OPTIMALITY: f64 = 1e-12;

/// 10 to a power between the two.
fn decades(random: &mut Random, from: f64, to: f64) -> f64 {
    10f64.powf(random.within(from, to))
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Rotation {
    Classical,
    Reduced,
    Cosserat,
}

fn solid(random: &mut Random, rotation: Rotation) -> Isotropic {
    let mu = decades(random, 6.0, 10.0);
    // K between 0.03 and 30 times μ.
    let lambda = mu * (decades(random, -1.5, 1.5) - 2.0 / 3.0);
    let gamma = mu * decades(random, -6.0, 0.0);
    let couple = CoupleModuli {
        beta: gamma * (decades(random, -1.0, 1.0) - 2.0 / 3.0),
        gamma,
        eta: gamma * decades(random, -1.5, 1.0),
    };
    let microrotation = Microrotation {
        alpha: mu * decades(random, -2.0, 1.0),
        inertia: decades(random, -6.0, 3.0),
        couple: (rotation == Rotation::Cosserat).then_some(couple),
    };
    Isotropic::new(lambda, mu, 2000.0, (rotation != Rotation::Classical).then_some(microrotation))
        .unwrap()
}

// ---------------------------------------------------------------- Mises

type Tensor = [[Wide; 3]; 3];

/// Deviator, antisymmetric part, couple deviator, couple mean and couple antisymmetric part.
type Parts = [Tensor; 5];

fn parts(stress: &Stress) -> (Wide, Parts) {
    let split = |t: &[[f64; 3]; 3]| {
        let mean = (wide(t[0][0]) + wide(t[1][1]) + wide(t[2][2])) / wide(3.0);
        let half = wide(0.5);
        let mut result = [[[wide(0.0); 3]; 3]; 3];
        for i in 0..3 {
            result[2][i][i] = mean;
            for j in 0..3 {
                result[0][i][j] = (wide(t[i][j]) + wide(t[j][i])) * half - result[2][i][j];
                result[1][i][j] = (wide(t[i][j]) - wide(t[j][i])) * half;
            }
        }
        (mean, result)
    };
    let (mean, [deviator, antisymmetric, _]) = split(&stress.force);
    let (_, [couple_deviator, couple_antisymmetric, couple_mean]) = split(&stress.couple);
    (mean, [deviator, antisymmetric, couple_deviator, couple_mean, couple_antisymmetric])
}

fn product(a: &Tensor, b: &Tensor) -> f64 {
    let sum = a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| *x * *y);
    sum.fold(wide(0.0), |x, y| x + y).value()
}

/// The D of the five parts; 0 where the solid has none of them.
fn stiffnesses(solid: &Isotropic) -> [f64; 5] {
    let couple = solid.couple().unwrap_or(CoupleModuli { beta: 0.0, gamma: 0.0, eta: 0.0 });
    [
        2.0 * solid.mu,
        2.0 * solid.microrotation.map_or(0.0, |m| m.alpha),
        2.0 * couple.gamma,
        3.0 * couple.beta + 2.0 * couple.gamma,
        2.0 * couple.eta,
    ]
}

fn weights(set: &Mises) -> [f64; 5] {
    let inverse_square = |l: Option<f64>| l.map_or(0.0, |l| l.powi(-2));
    let symmetric = inverse_square(set.symmetric_length);
    let antisymmetric = inverse_square(set.antisymmetric_length);
    [1.0, set.antisymmetric_weight, symmetric, symmetric, antisymmetric]
}

fn bulk(solid: &Isotropic) -> f64 {
    solid.lambda + 2.0 / 3.0 * solid.mu
}

/// Twice the elastic energy.
fn energy(solid: &Isotropic, stress: &Stress) -> f64 {
    let (mean, parts) = parts(stress);
    let shares = parts.iter().zip(stiffnesses(solid));
    mean.value().powi(2) / bulk(solid)
        + shares.filter(|(_, d)| *d > 0.0).map(|(t, d)| product(t, t) / d).sum::<f64>()
}

fn minus(a: &Stress, b: &Stress) -> Stress {
    let minus = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] - b[i][j]))
    };
    Stress { force: minus(a.force, b.force), couple: minus(a.couple, b.couple) }
}

/// Greatest of the residuals, each over its own scale.
#[derive(Clone, Copy, Debug, Default)]
struct Residuals {
    feasibility: f64,
    complementarity: f64,
    normality: f64,
    energy: f64,
    idempotence: f64,
}

impl Residuals {
    fn worst(&mut self, other: &Self) {
        self.feasibility = self.feasibility.max(other.feasibility);
        self.complementarity = self.complementarity.max(other.complementarity);
        self.normality = self.normality.max(other.normality);
        self.energy = self.energy.max(other.energy);
        self.idempotence = self.idempotence.max(other.idempotence);
    }

    fn check(&self, what: impl std::fmt::Debug) {
        let all =
            [self.feasibility, self.complementarity, self.normality, self.energy, self.idempotence];
        assert!(all.iter().all(|r| *r <= OPTIMALITY), "{self:?} at {what:?}");
    }
}

fn mises_residuals(set: &Mises, solid: &Isotropic, trial: &Stress) -> Residuals {
    let projection = set.project(solid, trial);
    let stress = projection.stress;
    let (mean_trial, parts_trial) = parts(trial);
    let (mean, parts) = parts(&stress);
    let (d, p) = (stiffnesses(solid), weights(set));
    let shear = (0..5)
        .filter(|&j| d[j] > 0.0)
        .map(|j| 0.5 * p[j] * product(&parts[j], &parts[j]))
        .sum::<f64>()
        .sqrt();
    let size = shear + set.friction * mean.value().abs() + set.strength;
    let value = shear + set.friction * mean.value() - set.strength;
    // The components, and not the parts, are rounded.
    let largest = [&stress.force, &stress.couple]
        .map(|t| t.iter().flatten().fold(0.0f64, |largest, x| largest.max(x.abs())));
    let heaviest = [p[0].max(p[1]), p[2].max(p[4])].map(f64::sqrt);
    let rounded = heaviest[0] * largest[0] + heaviest[1] * largest[1];
    let feasibility = (value / (size + rounded)).max(0.0);

    // e, its dual norm √(2 Σ |e|²/p), and the multiplier.
    let mean_strain = (mean_trial - mean).value() / bulk(solid);
    let strain: Parts = std::array::from_fn(|j| {
        std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                if d[j] > 0.0 {
                    (parts_trial[j][r][c] - parts[j][r][c]) / wide(d[j])
                } else {
                    wide(0.0)
                }
            })
        })
    });
    let (norm_trial, norm) = (energy(solid, trial).sqrt(), energy(solid, &stress).sqrt());
    let dual = (0..5)
        .filter(|&j| p[j] > 0.0)
        .map(|j| 2.0 / p[j] * product(&strain[j], &strain[j]))
        .sum::<f64>()
        .sqrt();
    let multiplier = if set.friction > 0.0 { mean_strain / set.friction } else { dual };
    // The dual norm of a strain of energy norm 1 is at most this.
    let dual_scale = (0..5)
        .filter(|&j| p[j] * d[j] > 0.0)
        .map(|j| (2.0 / (p[j] * d[j])).sqrt())
        .fold(0.0, f64::max);
    let mut scale = dual_scale;
    if set.friction > 0.0 {
        scale += 1.0 / (set.friction * bulk(solid).sqrt());
    }
    let mut normality = ((dual - multiplier) / (scale * norm_trial)).max(0.0);
    if set.friction == 0.0 {
        normality = normality.max(mean_strain.abs() * bulk(solid).sqrt() / norm_trial);
    }
    // Where the cone is smooth the two agree: e is λn.
    if shear > 0.0 {
        normality = normality.max((dual - multiplier).abs() / (scale * norm_trial));
    }
    // λ by projection onto n in the energy norm, which no small weight blows up.
    let along = |j: usize| d[j] * p[j] / (2.0 * shear);
    let fitted = (0..5).map(|j| along(j) * product(&strain[j], &parts[j])).sum::<f64>()
        + bulk(solid) * set.friction * mean_strain;
    let square = (0..5)
        .map(|j| along(j) * p[j] / (2.0 * shear) * product(&parts[j], &parts[j]))
        .sum::<f64>()
        + bulk(solid) * set.friction.powi(2);
    let fitted = fitted / square;
    // Away from the apex e is λ times the normal p s/2τ̄, whose direction is that of s to within the
    // rounding of the components of s; where nothing limits a part, its e is 0.
    let (mut residual, mut turned) = (0.0, 0.0);
    for j in (0..5).filter(|&j| d[j] > 0.0) {
        let share = if shear > 0.0 { fitted * p[j] / (2.0 * shear) } else { 0.0 };
        let mut own = strain[j];
        for (own, s) in own.iter_mut().flatten().zip(parts[j].iter().flatten()) {
            *own = *own - *s * wide(share);
        }
        if shear > 0.0 || p[j] == 0.0 {
            residual += d[j] * product(&own, &own);
            turned += d[j] * (share * largest[usize::from(j > 1)] * f64::EPSILON).powi(2);
        }
    }
    let allowed = norm_trial + 4.0 * turned.sqrt() / OPTIMALITY;
    normality = normality.max(residual.sqrt() / allowed);
    let work =
        mean.value() * mean_strain + (0..5).map(|j| product(&strain[j], &parts[j])).sum::<f64>();
    let complementarity = (work - multiplier * set.strength).abs()
        / (norm_trial * norm + (norm_trial * scale + multiplier) * set.strength);

    // What is lost: the difference of the energies, which only a large loss shows.
    let lost = 0.5 * (energy(solid, trial) - energy(solid, &stress));
    assert!(projection.energy_lost >= 0.0, "{projection:?}");
    let energy_residual = (lost - projection.energy_lost).abs() / (norm_trial * norm_trial);
    let again = set.project(solid, &stress);
    let idempotence = energy(solid, &minus(&again.stress, &stress)).sqrt() / norm.max(1e-300);
    if set.equivalent_shear(trial) + set.friction * mean_of(trial) <= set.strength {
        assert_eq!((stress, projection.energy_lost), (*trial, 0.0), "inside");
    }
    Residuals { feasibility, complementarity, normality, energy: energy_residual, idempotence }
}

fn random_stress(random: &mut Random, set: &Mises, solid: &Isotropic) -> Stress {
    let mut tensor = |own: f64, scale: f64| {
        let mut t = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..=i {
                let (s, a) = (random.within(-1.0, 1.0), random.within(-1.0, 1.0));
                let a = if i == j { 0.0 } else { a * own };
                (t[i][j], t[j][i]) = ((s + a) * scale, (s - a) * scale);
            }
        }
        t
    };
    let d = stiffnesses(solid);
    let rotating = f64::from(u8::from(d[1] > 0.0));
    let length = set.symmetric_length.or(set.antisymmetric_length).unwrap_or(1.0);
    let with_couple = f64::from(u8::from(d[2] > 0.0));
    Stress {
        force: tensor(rotating, set.strength),
        couple: tensor(1.0, set.strength * length * with_couple),
    }
}

fn scaled(stress: &Stress, by: f64) -> Stress {
    let scaled = |t: [[f64; 3]; 3]| t.map(|row| row.map(|x| x * by));
    Stress { force: scaled(stress.force), couple: scaled(stress.couple) }
}

/// From 1e-6 to 1e6 yield stresses, along every part alone, near the axis and around the normal
/// cone of the apex.
fn mises_trial(random: &mut Random, set: &Mises, solid: &Isotropic) -> Stress {
    let mut trial = random_stress(random, set, solid);
    let size = decades(random, -6.0, 6.0);
    match random.below(5) {
        0 => scaled(&trial, size),
        1 => {
            // Some parts only.
            let keep: [bool; 5] = std::array::from_fn(|_| random.below(2) == 0);
            let (mean, parts) = parts(&trial);
            for i in 0..3 {
                for j in 0..3 {
                    let sum = |range: std::ops::Range<usize>| {
                        let kept = range.filter(|&n| keep[n]);
                        kept.map(|n| parts[n][i][j]).fold(wide(0.0), |x, y| x + y).value()
                    };
                    trial.force[i][j] = sum(0..2);
                    trial.couple[i][j] = sum(2..5);
                }
                trial.force[i][i] += mean.value();
            }
            scaled(&trial, size)
        }
        2 => {
            // Towards the axis.
            let mean = mean_of(&trial);
            let mut near = scaled(&trial, decades(random, -12.0, 0.0));
            for i in 0..3 {
                near.force[i][i] += mean;
            }
            scaled(&near, size)
        }
        3 => {
            // Onto the edge of the apex's normal cone, a little inside, a little outside.
            let (d, p) = (stiffnesses(solid), weights(set));
            let (_, parts) = parts(&trial);
            let dual = (0..5)
                .filter(|&j| p[j] * d[j] > 0.0)
                .map(|j| 2.0 * product(&parts[j], &parts[j]) / (p[j] * d[j] * d[j]))
                .sum::<f64>()
                .sqrt();
            let off = random.generic(0.0, 2.0) * decades(random, -17.0, -1.0);
            let friction = set.friction;
            let old = mean_of(&trial);
            let shift = friction * bulk(solid) * dual * size * (1.0 + off);
            let mut edge = scaled(&trial, size);
            for i in 0..3 {
                edge.force[i][i] += shift - old * size;
                if friction > 0.0 {
                    edge.force[i][i] += set.strength / friction;
                }
            }
            edge
        }
        _ => {
            // Onto the surface, a little inside, a little outside.
            let shear = set.equivalent_shear(&trial);
            let value = shear + set.friction * mean_of(&trial);
            if value <= 0.0 {
                return trial;
            }
            let off = random.generic(0.0, 2.0) * decades(random, -17.0, -1.0);
            scaled(&trial, set.strength / value * (1.0 + off))
        }
    }
}

fn mean_of(stress: &Stress) -> f64 {
    (stress.force[0][0] + stress.force[1][1] + stress.force[2][2]) / 3.0
}

fn mises_set(random: &mut Random, cone: bool, micropolar: bool) -> Mises {
    let mut set = Mises::von_mises(decades(random, 3.0, 8.0));
    if cone {
        set.friction = decades(random, -3.0, 0.5);
        set.dilatancy = set.friction;
    }
    if micropolar {
        set.antisymmetric_weight = decades(random, -2.0, 1.0);
        set.symmetric_length = (random.below(4) > 0).then(|| decades(random, -3.0, 0.0));
        set.antisymmetric_length = (random.below(4) > 0).then(|| decades(random, -3.0, 0.0));
    }
    set
}

const SETS: [(&str, Rotation, bool, bool); 6] = [
    ("von Mises", Rotation::Classical, false, false),
    ("Drucker-Prager", Rotation::Classical, true, false),
    ("Drucker-Prager in a Cosserat solid", Rotation::Cosserat, true, false),
    ("Cosserat-Mises, reduced", Rotation::Reduced, false, true),
    ("Cosserat-Mises", Rotation::Cosserat, false, true),
    ("Cosserat-Drucker-Prager", Rotation::Cosserat, true, true),
];

#[test]
fn mises_projections_are_optimal() {
    for (number, (name, rotation, cone, micropolar)) in SETS.into_iter().enumerate() {
        let mut random = Random::new(1000 + number as u64);
        let mut worst = Residuals::default();
        let (mut inside, mut apex) = (0, 0);
        for _ in 0..20_000 {
            let solid = solid(&mut random, rotation);
            let set = mises_set(&mut random, cone, micropolar);
            let trial = mises_trial(&mut random, &set, &solid);
            let residuals = mises_residuals(&set, &solid, &trial);
            residuals.check((name, set, solid, trial, set.project(&solid, &trial)));
            worst.worst(&residuals);
            let projection = set.project(&solid, &trial);
            inside += usize::from(projection.stress == trial);
            apex += usize::from(set.equivalent_shear(&projection.stress) < 1e-9 * set.strength);
        }
        println!("{name}: {inside} inside, {apex} on the axis, {worst:?}");
        assert!((2000..15_000).contains(&inside), "{name}: {inside} of 20,000 inside");
        assert!(!cone || apex > 1000, "{name}: {apex} of 20,000 at the apex");
    }
}

/// With one stiffness in play the answer is a formula: radial return, and return to the cone.
#[test]
fn radial_return() {
    let solid = Isotropic::new(3.0, 2.0, 1.0, None).unwrap();
    let mut trial = Stress::default();
    (trial.force[0][1], trial.force[1][0]) = (5.0, 5.0);
    let projection = Mises::von_mises(2.0).project(&solid, &trial);
    assert!((projection.stress.force[0][1] - 2.0).abs() < 1e-15);
    // ½(25 − 4)/μ
    assert!((projection.energy_lost - 5.25).abs() < 1e-14);
    // τ̄ = 5, σ_m = 1, κ = ½, K = 13/3: λ = (5 + ½ − 2)/(μ + κ²K) = 42/37.
    for i in 0..3 {
        trial.force[i][i] = 1.0;
    }
    let cone = Mises::drucker_prager(2.0, 0.5, 0.1);
    let projection = cone.project(&solid, &trial);
    let multiplier = 42.0 / 37.0;
    assert!((projection.stress.force[1][0] - (5.0 - 2.0 * multiplier)).abs() < 1e-14);
    assert!((projection.stress.force[2][2] - (1.0 - multiplier * 0.5 * 13.0 / 3.0)).abs() < 1e-14);
    // Far up the axis: the apex k/κ.
    for i in 0..3 {
        trial.force[i][i] = 1000.0;
    }
    let apex = cone.project(&solid, &trial).stress;
    assert_eq!(apex.force, [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]]);
}

// ---------------------------------------------------------------- interlayer

/// A plane solid as this test knows it: compliances, α₂, and whether σ₂₁ = σ₁₂ throughout.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: [f64; 2],
    /// a₂, b₂; classical: strain of σ₁₂ = σ₂₁ under both, 1/(2μ), and 0.
    shear: [f64; 2],
    couple: Option<f64>,
    classical: bool,
}

impl Plane {
    fn of(solid: &Isotropic) -> Self {
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

    /// D⁻¹ s for the difference of two stresses.
    fn strain(&self, s: &[Wide; 6]) -> [f64; 6] {
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

    fn norm(&self, s: &[f64; 6]) -> f64 {
        let strain = self.strain(&s.map(wide));
        s.iter().zip(strain).map(|(s, e)| s * e).sum::<f64>().max(0.0).sqrt()
    }
}

/// [k, κ] of shear and couple conditions.
fn constants(set: &Interlayer) -> [[f64; 2]; 2] {
    let couple = set.couple.map_or([0.0, 0.0], |c| [c.strength, c.friction]);
    [[set.shear_strength, set.shear_friction], couple]
}

/// The excess of e_n over what the conditions of one face put there, and the supremum of the work of
/// e over the pyramid.
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
    // Components of e of energy norm 1 are at most these.
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
        // Σ λ × (how far inside), each term of which is at least 0.
        let complementarity = (work - support).abs() / work_scale;
        (normality, complementarity)
    };
    let (normality, complementarity) = if solid.classical {
        // Only the sum of the two shear strains does work on σ₁₂ = σ₂₁: some division of it among the
        // faces must do.
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
enum Degenerate {
    No,
    /// τ₀/κ_τ = μ₀/κ_μ: four conditions meet in the apex.
    CommonApex,
    /// Some strengths and frictions are zero.
    Zeros,
}

fn interlayer_set(random: &mut Random, degenerate: Degenerate, couple: bool) -> Interlayer {
    let shear_strength = decades(random, 3.0, 7.0);
    let shear_friction = decades(random, -2.0, 0.7);
    // A length of about a block, as the couple stress has it.
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
            // Powers of two: the apex is common to the last bit.
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
        // Planes and axes of symmetry.
        if drop == 0 && random.below(2) == 0 && !(solid.classical && (2..4).contains(&i)) {
            *component = 0.0;
        }
    }
    if random.below(4) == 0 {
        // On edges, faces and the apex, or just off them.
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

/// A plane solid: classical, reduced or Cosserat, or cubic.
fn plane_solid(random: &mut Random, kind: usize) -> (Plane, PlaneMetric) {
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

/// Across the plane the stress follows from the same plastic strain: with Δσ₃₃ = ν (Δσ₁₁ + Δσ₂₂) Hooke's
/// law in space gives a plastic strain with nothing across the plane, whose work on no admissible stress is
/// greater than on the projection; so it minimises the energy over σ₃₃, too.
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

// ---------------------------------------------------------------- Clarabel

/// argmin ½|w − w̄|² with A w + (in the cones) = b.
fn clarabel(
    center: &[f64],
    rows: &[Vec<f64>],
    b: &[f64],
    cones: &[SupportedConeT<f64>],
) -> Vec<f64> {
    let n = center.len();
    let a = CscMatrix::from(rows);
    let settings = DefaultSettingsBuilder::default()
        .verbose(false)
        .tol_gap_abs(1e-10)
        .tol_gap_rel(1e-10)
        .tol_feas(1e-10)
        .build()
        .unwrap();
    let q: Vec<f64> = center.iter().map(|x| -x).collect();
    let mut solver =
        DefaultSolver::new(&CscMatrix::identity(n), &q, &a, b, cones, settings).unwrap();
    solver.solve();
    assert!(
        matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved),
        "{:?}",
        solver.solution.status
    );
    solver.solution.x.clone()
}

fn half_square_distance(a: &[f64], b: &[f64]) -> f64 {
    0.5 * a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>()
}

/// How far the own answer lies above the solver's, relatively, and the distance between them.
fn compare(own: &[f64], theirs: &[f64], center: &[f64]) -> (f64, f64) {
    let (mine, reference) =
        (half_square_distance(own, center), half_square_distance(theirs, center));
    ((mine - reference) / reference, (2.0 * half_square_distance(own, theirs)).sqrt())
}

/// Orthonormal 3×3 matrices: five symmetric deviators, three antisymmetric ones, δ/√3.
fn basis() -> [[[f64; 3]; 3]; 9] {
    let mut basis = [[[0.0; 3]; 3]; 9];
    let half = 0.5f64.sqrt();
    for (number, (i, j)) in [(0, 1), (1, 2), (0, 2)].into_iter().enumerate() {
        (basis[number][i][j], basis[number][j][i]) = (half, half);
        (basis[5 + number][i][j], basis[5 + number][j][i]) = (half, -half);
    }
    (basis[3][0][0], basis[3][1][1]) = (half, -half);
    let sixth = 6f64.sqrt().recip();
    (basis[4][0][0], basis[4][1][1], basis[4][2][2]) = (sixth, sixth, -2.0 * sixth);
    for i in 0..3 {
        basis[8][i][i] = 3f64.sqrt().recip();
    }
    basis
}

#[test]
fn mises_projections_match_a_conic_solver() {
    let basis = basis();
    let (mut above, mut apart) = (f64::NEG_INFINITY, 0.0f64);
    let mut random = Random::new(31);
    let mut done = 0;
    while done < 300 {
        let (_, rotation, cone, micropolar) = SETS[done % SETS.len()];
        let solid = solid(&mut random, rotation);
        let set = mises_set(&mut random, cone, micropolar);
        let trial = random_stress(&mut random, &set, &solid);
        let trial = scaled(&trial, decades(&mut random, 0.0, 2.0));
        let value = set.equivalent_shear(&trial) + set.friction * mean_of(&trial);
        if value < 1.5 * set.strength {
            continue;
        }
        let scale = energy(&solid, &trial).sqrt();
        let (d, p) = (stiffnesses(&solid), weights(&set));
        // Coordinates in which the energy is ½|w|²: s = √D w, part by part.
        let part_of = |number: usize| match number {
            0..5 => Some(0),
            5..8 => Some(1),
            8 => None,
            9..14 => Some(2),
            17 => Some(3),
            _ => Some(4),
        };
        let stiffness = |number: usize| part_of(number).map_or(3.0 * bulk(&solid), |part| d[part]);
        let used: Vec<usize> = (0..18).filter(|&n| stiffness(n) > 0.0).collect();
        let coordinates = |stress: &Stress| -> Vec<f64> {
            let along = |&n: &usize| {
                let tensor = if n < 9 { &stress.force } else { &stress.couple };
                let matrix = &basis[n % 9];
                let sum: f64 = (0..9).map(|i| tensor[i / 3][i % 3] * matrix[i / 3][i % 3]).sum();
                sum / stiffness(n).sqrt() / scale
            };
            used.iter().map(along).collect()
        };
        let strength = set.strength / scale;
        let size = used
            .iter()
            .filter_map(|&n| part_of(n).map(|part| (0.5 * p[part] * d[part]).sqrt()))
            .fold(0.0, f64::max);
        // (k − κσ_m, √½p s …) in the second-order cone, divided by its largest coefficient.
        let mut rows = vec![vec![0.0; used.len()]; 1 + used.len()];
        let mut b = vec![0.0; 1 + used.len()];
        b[0] = strength / size;
        for (column, &n) in used.iter().enumerate() {
            match part_of(n) {
                None => rows[0][column] = set.friction * bulk(&solid).sqrt() / size,
                Some(part) => rows[1 + column][column] = -(0.5 * p[part] * d[part]).sqrt() / size,
            }
        }
        let center = coordinates(&trial);
        let theirs = clarabel(&center, &rows, &b, &[SecondOrderConeT(1 + used.len())]);
        let own = coordinates(&set.project(&solid, &trial).stress);
        let (objective, distance) = compare(&own, &theirs, &center);
        assert!(objective <= 1e-9, "{objective:e}: {set:?} {solid:?} {trial:?}");
        assert!(distance <= 1e-4, "{distance:e}: {set:?} {solid:?} {trial:?}");
        (above, apart) = (above.max(objective), apart.max(distance));
        done += 1;
    }
    println!("Mises: objective at most {above:e} above, stresses {apart:e} apart");
}

#[test]
fn interlayer_projections_match_a_conic_solver() {
    let (mut above, mut apart) = (f64::NEG_INFINITY, 0.0f64);
    let mut random = Random::new(32);
    let mut done = 0;
    while done < 400 {
        let kind = done % 4;
        let (solid, metric) = plane_solid(&mut random, kind);
        let degenerate = [Degenerate::No, Degenerate::CommonApex][random.below(2)];
        let set = interlayer_set(&mut random, degenerate, solid.couple.is_some());
        let mut trial: [f64; 6] = std::array::from_fn(|i| match i {
            0..4 => set.shear_strength * random.within(-1.0, 1.0),
            _ => set.couple.map_or(0.0, |c| c.strength * random.within(-1.0, 1.0)),
        });
        if solid.classical {
            trial[3] = trial[2];
        }
        let size = decades(&mut random, 0.0, 2.0);
        trial = trial.map(|x| x * size);
        let stress = set.project(&metric, &trial).stress;
        let scale = solid.norm(&trial);
        if solid.norm(&std::array::from_fn(|i| trial[i] - stress[i])) < 0.1 * scale {
            continue;
        }
        // Orthonormal coordinates: sums and differences over √2 times the root of the compliance.
        let roots = |[a, b]: [f64; 2]| [(0.5 * (a - b)).sqrt(), (0.5 * (a + b)).sqrt()];
        let ([ns, nd], [ss, sd]) = (roots(solid.normal), roots(solid.shear));
        let couple = solid.couple.map_or(0.0, |a| a.recip().sqrt());
        let coordinates = |s: &[f64; 6]| -> Vec<f64> {
            let mut all = vec![ns * (s[0] + s[1]), nd * (s[0] - s[1]), ss * (s[2] + s[3])];
            if !solid.classical {
                all.push(sd * (s[2] - s[3]));
            }
            if solid.couple.is_some() {
                all.extend([couple * s[4], couple * s[5]]);
            }
            all.iter().map(|x| x / scale).collect()
        };
        // Rows of the conditions in those coordinates: the stresses of unit coordinates.
        let n = coordinates(&trial).len();
        let stress_of = |coordinate: usize| -> [f64; 6] {
            let mut s = [0.0; 6];
            match (coordinate, solid.classical) {
                (0, _) => (s[0], s[1]) = (0.5 / ns, 0.5 / ns),
                (1, _) => (s[0], s[1]) = (0.5 / nd, -0.5 / nd),
                (2, _) => (s[2], s[3]) = (0.5 / ss, 0.5 / ss),
                (3, false) => (s[2], s[3]) = (0.5 / sd, -0.5 / sd),
                (other, _) => s[other] = couple.recip(),
            }
            s
        };
        let [[tau, kappa_tau], [m, kappa_m]] = constants(&set);
        let (mut rows, mut b) = (Vec::new(), Vec::new());
        for face in 0..2 {
            for (strength, friction, own, limited) in
                [(tau, kappa_tau, 2 + face, true), (m, kappa_m, 4 + face, set.couple.is_some())]
            {
                for sign in [1.0, -1.0] {
                    if limited {
                        let row: Vec<f64> = (0..n)
                            .map(stress_of)
                            .map(|s| friction * s[face] + sign * s[own])
                            .collect();
                        let norm = row.iter().map(|x| x * x).sum::<f64>().sqrt();
                        rows.push(row.iter().map(|x| x / norm).collect::<Vec<f64>>());
                        b.push(strength / norm / scale);
                    }
                }
            }
        }
        let center = coordinates(&trial);
        let theirs = clarabel(&center, &rows, &b, &[NonnegativeConeT(b.len())]);
        let own = coordinates(&stress);
        let (objective, distance) = compare(&own, &theirs, &center);
        assert!(objective <= 1e-9, "{objective:e}: {set:?} {solid:?} {trial:?}");
        assert!(distance <= 1e-4, "{distance:e}: {set:?} {solid:?} {trial:?}");
        (above, apart) = (above.max(objective), apart.max(distance));
        done += 1;
    }
    println!("interlayer: objective at most {above:e} above, stresses {apart:e} apart");
}
