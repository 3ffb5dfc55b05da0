//! Projection onto cones of Mises and Drucker–Prager type: optimality conditions and radial return.

use crate::projection::random_solids::random_solid;
use crate::projection::residuals::{OPTIMALITY_TOLERANCE, OptimalityResiduals};
use crate::support::{DoubleDouble, RandomNumbers, dd, draw_log_uniform};
use wellposed_models::solid::parameters::{CoupleModuli, Isotropic, Theory};
use wellposed_models::solid::stress::Stress;
use wellposed_models::yield_set::parameters::Mises;

type DoubleDoubleTensor = [[DoubleDouble; 3]; 3];

/// Components of a stress in the eigenspaces of Hooke's law: deviator and antisymmetric part of the force stress;
/// deviator, mean and antisymmetric part of the couple stress.
type EigenspaceTensors = [DoubleDoubleTensor; 5];

pub fn decompose_stress(stress: &Stress) -> (DoubleDouble, EigenspaceTensors) {
    let split = |t: &[[f64; 3]; 3]| {
        let mean = (dd(t[0][0]) + dd(t[1][1]) + dd(t[2][2])) / dd(3.0);
        let half = dd(0.5);
        let mut result = [[[dd(0.0); 3]; 3]; 3];
        for i in 0..3 {
            result[2][i][i] = mean;
            for j in 0..3 {
                result[0][i][j] = (dd(t[i][j]) + dd(t[j][i])) * half - result[2][i][j];
                result[1][i][j] = (dd(t[i][j]) - dd(t[j][i])) * half;
            }
        }
        (mean, result)
    };
    let (mean, [deviator, antisymmetric, _]) = split(&stress.force);
    let (_, [couple_deviator, couple_antisymmetric, couple_mean]) = split(&stress.couple);
    (mean, [deviator, antisymmetric, couple_deviator, couple_mean, couple_antisymmetric])
}

pub fn double_contraction(a: &DoubleDoubleTensor, b: &DoubleDoubleTensor) -> f64 {
    let sum = a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| *x * *y);
    sum.fold(dd(0.0), |x, y| x + y).to_f64()
}

/// Stiffnesses D of the five eigenspaces, Pa or N; 0 if the solid has no such stress.
pub fn eigenspace_stiffnesses(solid: &Isotropic) -> [f64; 5] {
    let couple = solid.couple().unwrap_or(CoupleModuli { beta: 0.0, gamma: 0.0, eta: 0.0 });
    [
        2.0 * solid.mu,
        2.0 * solid.microrotation.map_or(0.0, |m| m.alpha),
        2.0 * couple.gamma,
        3.0 * couple.beta + 2.0 * couple.gamma,
        2.0 * couple.eta,
    ]
}

pub fn eigenspace_weights(set: &Mises) -> [f64; 5] {
    let inverse_square = |l: Option<f64>| l.map_or(0.0, |l| l.powi(-2));
    let symmetric = inverse_square(set.symmetric_internal_length);
    let antisymmetric = inverse_square(set.antisymmetric_internal_length);
    [1.0, set.antisymmetric_weight, symmetric, symmetric, antisymmetric]
}

pub fn bulk_modulus(solid: &Isotropic) -> f64 {
    solid.lambda + 2.0 / 3.0 * solid.mu
}

/// Twice the elastic energy of a stress, J/m³.
pub fn twice_elastic_energy(solid: &Isotropic, stress: &Stress) -> f64 {
    let (mean, parts) = decompose_stress(stress);
    let tensors_and_stiffnesses = parts.iter().zip(eigenspace_stiffnesses(solid));
    mean.to_f64().powi(2) / bulk_modulus(solid)
        + tensors_and_stiffnesses
            .filter(|(_, d)| *d > 0.0)
            .map(|(t, d)| double_contraction(t, t) / d)
            .sum::<f64>()
}

fn subtract(a: &Stress, b: &Stress) -> Stress {
    let subtract = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] - b[i][j]))
    };
    Stress { force: subtract(a.force, b.force), couple: subtract(a.couple, b.couple) }
}

fn compute_mises_residuals(set: &Mises, solid: &Isotropic, trial: &Stress) -> OptimalityResiduals {
    let projection = set.project(solid, trial);
    let stress = projection.stress;
    let (mean_trial, parts_trial) = decompose_stress(trial);
    let (mean, parts) = decompose_stress(&stress);
    let (d, p) = (eigenspace_stiffnesses(solid), eigenspace_weights(set));
    let shear = (0..5)
        .filter(|&j| d[j] > 0.0)
        .map(|j| 0.5 * p[j] * double_contraction(&parts[j], &parts[j]))
        .sum::<f64>()
        .sqrt();
    let size = shear + set.friction * mean.to_f64().abs() + set.strength;
    let value = shear + set.friction * mean.to_f64() - set.strength;
    // Rounding errors scale with the stress components, which may exceed the deviators and antisymmetric parts.
    let largest = [&stress.force, &stress.couple]
        .map(|t| t.iter().flatten().fold(0.0f64, |largest, x| largest.max(x.abs())));
    let heaviest = [p[0].max(p[1]), p[2].max(p[4])].map(f64::sqrt);
    let rounded = heaviest[0] * largest[0] + heaviest[1] * largest[1];
    let feasibility = (value / (size + rounded)).max(0.0);

    // Plastic strain e, its dual norm √(2 Σ |e|²/p) with the weights p in τ̄² = ½ Σ p|s|², and the multiplier λ.
    let mean_strain = (mean_trial - mean).to_f64() / bulk_modulus(solid);
    let strain: EigenspaceTensors = std::array::from_fn(|j| {
        std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                if d[j] > 0.0 {
                    (parts_trial[j][r][c] - parts[j][r][c]) / dd(d[j])
                } else {
                    dd(0.0)
                }
            })
        })
    });
    let (norm_trial, norm) =
        (twice_elastic_energy(solid, trial).sqrt(), twice_elastic_energy(solid, &stress).sqrt());
    let dual = (0..5)
        .filter(|&j| p[j] > 0.0)
        .map(|j| 2.0 / p[j] * double_contraction(&strain[j], &strain[j]))
        .sum::<f64>()
        .sqrt();
    let multiplier = if set.friction > 0.0 { mean_strain / set.friction } else { dual };
    // Upper bound of the dual norm of a strain of energy norm 1.
    let dual_scale = (0..5)
        .filter(|&j| p[j] * d[j] > 0.0)
        .map(|j| (2.0 / (p[j] * d[j])).sqrt())
        .fold(0.0, f64::max);
    let mut scale = dual_scale;
    if set.friction > 0.0 {
        scale += 1.0 / (set.friction * bulk_modulus(solid).sqrt());
    }
    let mut normality = ((dual - multiplier) / (scale * norm_trial)).max(0.0);
    if set.friction == 0.0 {
        normality = normality.max(mean_strain.abs() * bulk_modulus(solid).sqrt() / norm_trial);
    }
    // Off the apex e = λn, so the dual norm equals the multiplier.
    if shear > 0.0 {
        normality = normality.max((dual - multiplier).abs() / (scale * norm_trial));
    }
    // The multiplier λ by projection of e onto n in the energy norm, which is well-conditioned for small weights.
    let along = |j: usize| d[j] * p[j] / (2.0 * shear);
    let fitted = (0..5).map(|j| along(j) * double_contraction(&strain[j], &parts[j])).sum::<f64>()
        + bulk_modulus(solid) * set.friction * mean_strain;
    let square = (0..5)
        .map(|j| along(j) * p[j] / (2.0 * shear) * double_contraction(&parts[j], &parts[j]))
        .sum::<f64>()
        + bulk_modulus(solid) * set.friction.powi(2);
    let fitted = fitted / square;
    // Off the apex e is λ times the normal p s/2τ̄ in each eigenspace. Its direction is the direction of s up to the
    // rounding errors of the components of s; in eigenspaces without weight (p = 0) e is 0.
    let (mut residual, mut turned) = (0.0, 0.0);
    for j in (0..5).filter(|&j| d[j] > 0.0) {
        let share = if shear > 0.0 { fitted * p[j] / (2.0 * shear) } else { 0.0 };
        let mut own = strain[j];
        for (own, s) in own.iter_mut().flatten().zip(parts[j].iter().flatten()) {
            *own = *own - *s * dd(share);
        }
        if shear > 0.0 || p[j] == 0.0 {
            residual += d[j] * double_contraction(&own, &own);
            turned += d[j] * (share * largest[usize::from(j > 1)] * f64::EPSILON).powi(2);
        }
    }
    let allowed = norm_trial + 4.0 * turned.sqrt() / OPTIMALITY_TOLERANCE;
    normality = normality.max(residual.sqrt() / allowed);
    let work = mean.to_f64() * mean_strain
        + (0..5).map(|j| double_contraction(&strain[j], &parts[j])).sum::<f64>();
    let complementarity = (work - multiplier * set.strength).abs()
        / (norm_trial * norm + (norm_trial * scale + multiplier) * set.strength);

    // Energy lost, as the difference of the elastic energies; its rounding error scales with the energy of the trial
    // stress.
    let lost = 0.5 * (twice_elastic_energy(solid, trial) - twice_elastic_energy(solid, &stress));
    assert!(projection.energy_lost >= 0.0, "{projection:?}");
    let energy_residual = (lost - projection.energy_lost).abs() / (norm_trial * norm_trial);
    let again = set.project(solid, &stress);
    let idempotence =
        twice_elastic_energy(solid, &subtract(&again.stress, &stress)).sqrt() / norm.max(1e-300);
    if set.equivalent_shear(trial) + set.friction * mean_stress(trial) <= set.strength {
        assert_eq!((stress, projection.energy_lost), (*trial, 0.0), "inside");
    }
    OptimalityResiduals {
        feasibility,
        complementarity,
        normality,
        energy: energy_residual,
        idempotence,
    }
}

pub fn random_stress(random: &mut RandomNumbers, set: &Mises, solid: &Isotropic) -> Stress {
    let mut tensor = |own: f64, scale: f64| {
        let mut t = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..=i {
                let (s, a) = (random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
                let a = if i == j { 0.0 } else { a * own };
                (t[i][j], t[j][i]) = ((s + a) * scale, (s - a) * scale);
            }
        }
        t
    };
    let d = eigenspace_stiffnesses(solid);
    let rotating = f64::from(u8::from(d[1] > 0.0));
    let length = set.symmetric_internal_length.or(set.antisymmetric_internal_length).unwrap_or(1.0);
    let with_couple = f64::from(u8::from(d[2] > 0.0));
    Stress {
        force: tensor(rotating, set.strength),
        couple: tensor(1.0, set.strength * length * with_couple),
    }
}

pub fn scale_stress(stress: &Stress, factor: f64) -> Stress {
    let scale_stress = |t: [[f64; 3]; 3]| t.map(|row| row.map(|x| x * factor));
    Stress { force: scale_stress(stress.force), couple: scale_stress(stress.couple) }
}

/// Random trial stress. It is general, has components in some eigenspaces only, is near the hydrostatic axis, or is
/// near the boundary of the normal cone of the apex, each with a magnitude of 1e-6 to 1e6 times the strength; or it is
/// near the yield surface.
fn random_mises_trial(random: &mut RandomNumbers, set: &Mises, solid: &Isotropic) -> Stress {
    let mut trial = random_stress(random, set, solid);
    let size = draw_log_uniform(random, -6.0, 6.0);
    match random.uniform_index(5) {
        0 => scale_stress(&trial, size),
        1 => {
            // The components in a random subset of the eigenspaces.
            let is_included: [bool; 5] = std::array::from_fn(|_| random.uniform_index(2) == 0);
            let (mean, parts) = decompose_stress(&trial);
            for i in 0..3 {
                for j in 0..3 {
                    let sum = |range: std::ops::Range<usize>| {
                        let included = range.filter(|&n| is_included[n]);
                        included.map(|n| parts[n][i][j]).fold(dd(0.0), |x, y| x + y).to_f64()
                    };
                    trial.force[i][j] = sum(0..2);
                    trial.couple[i][j] = sum(2..5);
                }
                trial.force[i][i] += mean.to_f64();
            }
            scale_stress(&trial, size)
        }
        2 => {
            // The deviation from the mean stress is scaled by 1e-12 to 1: near the hydrostatic axis.
            let mean = mean_stress(&trial);
            let mut near = scale_stress(&trial, draw_log_uniform(random, -12.0, 0.0));
            for i in 0..3 {
                near.force[i][i] += mean;
            }
            scale_stress(&near, size)
        }
        3 => {
            // Near the boundary of the normal cone of the apex, inside or outside.
            let (d, p) = (eigenspace_stiffnesses(solid), eigenspace_weights(set));
            let (_, parts) = decompose_stress(&trial);
            let dual = (0..5)
                .filter(|&j| p[j] * d[j] > 0.0)
                .map(|j| 2.0 * double_contraction(&parts[j], &parts[j]) / (p[j] * d[j] * d[j]))
                .sum::<f64>()
                .sqrt();
            let off = random.signed_uniform(0.0, 2.0) * draw_log_uniform(random, -17.0, -1.0);
            let friction = set.friction;
            let old = mean_stress(&trial);
            let shift = friction * bulk_modulus(solid) * dual * size * (1.0 + off);
            let mut edge = scale_stress(&trial, size);
            for i in 0..3 {
                edge.force[i][i] += shift - old * size;
                if friction > 0.0 {
                    edge.force[i][i] += set.strength / friction;
                }
            }
            edge
        }
        _ => {
            // The stress is scaled to be near the yield surface, inside or outside.
            let shear = set.equivalent_shear(&trial);
            let value = shear + set.friction * mean_stress(&trial);
            if value <= 0.0 {
                return trial;
            }
            let off = random.signed_uniform(0.0, 2.0) * draw_log_uniform(random, -17.0, -1.0);
            scale_stress(&trial, set.strength / value * (1.0 + off))
        }
    }
}

pub fn mean_stress(stress: &Stress) -> f64 {
    (stress.force[0][0] + stress.force[1][1] + stress.force[2][2]) / 3.0
}

pub fn random_mises_set(random: &mut RandomNumbers, cone: bool, micropolar: bool) -> Mises {
    let mut set = Mises::new_von_mises(draw_log_uniform(random, 3.0, 8.0));
    if cone {
        set.friction = draw_log_uniform(random, -3.0, 0.5);
        set.dilatancy = set.friction;
    }
    if micropolar {
        set.antisymmetric_weight = draw_log_uniform(random, -2.0, 1.0);
        set.symmetric_internal_length =
            (random.uniform_index(4) > 0).then(|| draw_log_uniform(random, -3.0, 0.0));
        set.antisymmetric_internal_length =
            (random.uniform_index(4) > 0).then(|| draw_log_uniform(random, -3.0, 0.0));
    }
    set
}

pub const YIELD_SET_CASES: [(&str, Theory, bool, bool); 6] = [
    ("von Mises", Theory::Classical, false, false),
    ("Drucker-Prager", Theory::Classical, true, false),
    ("Drucker-Prager in a Cosserat solid", Theory::Cosserat, true, false),
    ("Cosserat-Mises, reduced", Theory::Reduced, false, true),
    ("Cosserat-Mises", Theory::Cosserat, false, true),
    ("Cosserat-Drucker-Prager", Theory::Cosserat, true, true),
];

/// Projections onto cones of Mises type satisfy the optimality conditions.
#[test]
fn mises_projections_are_optimal() {
    for (number, (name, theory, cone, micropolar)) in YIELD_SET_CASES.into_iter().enumerate() {
        let mut random = RandomNumbers::new(1000 + number as u64);
        let mut worst = OptimalityResiduals::default();
        let (mut inside, mut apex) = (0, 0);
        for _ in 0..20_000 {
            let solid = random_solid(&mut random, theory);
            let set = random_mises_set(&mut random, cone, micropolar);
            let trial = random_mises_trial(&mut random, &set, &solid);
            let residuals = compute_mises_residuals(&set, &solid, &trial);
            residuals.assert_below_tolerance((
                name,
                set,
                solid,
                trial,
                set.project(&solid, &trial),
            ));
            worst.accumulate_max(&residuals);
            let projection = set.project(&solid, &trial);
            inside += usize::from(projection.stress == trial);
            apex += usize::from(set.equivalent_shear(&projection.stress) < 1e-9 * set.strength);
        }
        println!("{name}: {inside} inside, {apex} on the axis, {worst:?}");
        assert!((2000..15_000).contains(&inside), "{name}: {inside} of 20,000 inside");
        assert!(!cone || apex > 1000, "{name}: {apex} of 20,000 at the apex");
    }
}

/// In a classical solid, where only the deviator has a weight, the projection has a closed form: radial return to the
/// cylinder, return to the cone, and return to the apex.
#[test]
fn projection_in_a_classical_solid_has_the_closed_form() {
    let solid = Isotropic::new(3.0, 2.0, 1.0, None).unwrap();
    let mut trial = Stress::default();
    (trial.force[0][1], trial.force[1][0]) = (5.0, 5.0);
    let projection = Mises::new_von_mises(2.0).project(&solid, &trial);
    assert!((projection.stress.force[0][1] - 2.0).abs() < 1e-15);
    // Energy lost: ½(τ̄² − k²)/μ = ½(25 − 4)/2.
    assert!((projection.energy_lost - 5.25).abs() < 1e-14);
    // Multiplier λ for τ̄ = 5, σ_m = 1, κ = ½, K = 13/3: λ = (5 + ½ − 2)/(μ + κ²K) = 42/37.
    for i in 0..3 {
        trial.force[i][i] = 1.0;
    }
    let cone = Mises::new_drucker_prager(2.0, 0.5, 0.1);
    let projection = cone.project(&solid, &trial);
    let multiplier = 42.0 / 37.0;
    assert!((projection.stress.force[1][0] - (5.0 - 2.0 * multiplier)).abs() < 1e-14);
    assert!((projection.stress.force[2][2] - (1.0 - multiplier * 0.5 * 13.0 / 3.0)).abs() < 1e-14);
    // A large mean stress maps to the apex, σ_m = k/κ.
    for i in 0..3 {
        trial.force[i][i] = 1000.0;
    }
    let apex = cone.project(&solid, &trial).stress;
    assert_eq!(apex.force, [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]]);
}
