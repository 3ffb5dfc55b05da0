//! Yield normals against finite differences of the yield function, and the tangent stiffness against the formula for
//! all conditions at once.

use crate::support::yield_sets::{random_interlayer, random_mises};
use crate::support::{DoubleDouble, RandomNumbers, dd};
use nalgebra::{DMatrix, DVector};
use wellposed_models::Rounded;
use wellposed_models::common::rounding::UNIT_ROUNDOFF;
use wellposed_models::common::system::RoundedMatrix;
use wellposed_models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use wellposed_models::solid::stress::{Stress, StressComponent};
use wellposed_models::solid::symbol::{plane_layout, space_layout};
use wellposed_models::yield_set::YieldSet;
use wellposed_models::yield_set::parameters::{
    ActiveCondition, InterlayerCoupleLimits, InterlayerYieldSet, Mises,
};
use wellposed_models::yield_set::tangent::tangent_stiffness;

fn random_solid(random: &mut RandomNumbers, theory: Theory) -> Isotropic {
    let mu = random.uniform(0.5, 2.0);
    let gamma = random.uniform(0.2, 2.0);
    let couple = CoupleModuli {
        beta: gamma * (random.uniform(0.1, 2.0) - 2.0 / 3.0),
        gamma,
        eta: random.uniform(0.2, 2.0),
    };
    let microrotation = Microrotation {
        alpha: random.uniform(0.1, 2.0),
        inertia: random.uniform(0.2, 2.0),
        couple: (theory == Theory::Cosserat).then_some(couple),
    };
    let lambda = mu * (random.uniform(0.1, 3.0) - 2.0 / 3.0);
    let rotating = (theory != Theory::Classical).then_some(microrotation);
    Isotropic::new(lambda, mu, 1.0, rotating).unwrap()
}

fn random_stress(random: &mut RandomNumbers) -> Stress {
    let mut tensor =
        || std::array::from_fn(|_| std::array::from_fn(|_| random.signed_uniform(0.1, 1.0)));
    Stress { force: tensor(), couple: tensor() }
}

/// The condition with associated flow: flow direction equal to the yield normal.
fn with_associated_flow(mut condition: ActiveCondition) -> ActiveCondition {
    condition.flow_direction = condition.normal;
    condition
}

fn all_components() -> impl Iterator<Item = StressComponent> {
    let pairs = (0..9).map(|n| (n / 3, n % 3));
    pairs
        .clone()
        .map(|(i, j)| StressComponent::Force(i, j))
        .chain(pairs.map(|(i, j)| StressComponent::Couple(i, j)))
}

/// Checks `gradient` against central differences over ±h of the function `value` of the stress, and returns the largest
/// difference. The truncation error h² f'''/6 and the rounding error divided by h are about 1e-10 each for stresses and
/// radii of curvature of order 0.1 and more.
fn check_gradient(value: impl Fn(&Stress) -> f64, gradient: &Stress, stress: &Stress) -> f64 {
    const STEP: f64 = 2e-6;
    let mut worst = 0.0f64;
    for component in all_components() {
        let [mut up, mut down] = [*stress; 2];
        component.set(&mut up, component.value_in(stress) + STEP);
        component.set(&mut down, component.value_in(stress) - STEP);
        let difference = (value(&up) - value(&down)) / (2.0 * STEP);
        worst = worst.max((difference - component.value_in(gradient)).abs());
    }
    assert!(worst <= 2e-9, "{worst:e} at {stress:?}");
    worst
}

/// Normals are gradients of the yield function, flow directions gradients of the plastic potential.
#[test]
fn yield_normals_are_gradients_of_the_yield_function() {
    let mut random = RandomNumbers::new(1);
    let mut worst = 0.0f64;
    for _ in 0..500 {
        let set = random_mises(&mut random);
        let stress = random_stress(&mut random);
        let condition = set.condition(&stress).unwrap();
        let value = |s: &Stress| YieldSet::from(set).yield_function(s);
        worst = worst.max(check_gradient(value, &condition.normal, &stress));
        // The flow direction is the gradient of the plastic potential: f with the dilatancy in place of the friction.
        let potential = Mises { friction: set.dilatancy, ..set };
        let value = |s: &Stress| YieldSet::from(potential).yield_function(s);
        worst = worst.max(check_gradient(value, &condition.flow_direction, &stress));

        // Compared only if no other half-space comes within 0.01 of the maximum over the eight, the yield function.
        let set = random_interlayer(&mut random);
        let couple = set.couple.unwrap();
        let values: Vec<f64> = [0, 1]
            .into_iter()
            .flat_map(|face| {
                let (normal, other) = (stress.force[face][face], 1 - face);
                [
                    stress.force[other][face].abs() + set.shear_friction * normal
                        - set.shear_strength,
                    stress.couple[2][face].abs() + couple.friction * normal - couple.strength,
                ]
            })
            .collect();
        let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let own = YieldSet::from(set).yield_function(&stress);
        assert!((own - greatest).abs() <= 1e-15, "{own} {greatest}");
        if values.iter().filter(|v| **v > greatest - 0.01).count() > 1 {
            continue;
        }
        // The half-space, including its sign, that attains the maximum.
        let value = |s: &Stress| YieldSet::from(set).yield_function(s);
        let (nearest, _) = set
            .half_spaces()
            .find(|(condition, strength)| {
                let product: f64 = all_components()
                    .map(|c| c.value_in(&condition.normal) * c.value_in(&stress))
                    .sum();
                (product - strength - greatest).abs() <= 1e-14
            })
            .unwrap();
        worst = worst.max(check_gradient(value, &nearest.normal, &stress));
    }
    println!("normals: {worst:e}");
    assert_eq!(random_interlayer(&mut random).half_spaces().count(), 8);
}

/// The normal at a deviator of 1e-9 times the pressure is exact to rounding, since stress differences are exact.
#[test]
fn yield_normal_is_exact_under_high_pressure() {
    let set = Mises::new_drucker_prager(1.0, 0.5, 0.5);
    let mut stress = Stress::default();
    let mean = -(2f64.powi(30));
    for (i, own) in [3.0, -1.0, -2.0].into_iter().enumerate() {
        stress.force[i][i] = mean + own;
    }
    // The deviator s has |s|² = 14, so τ̄ = √7.
    assert!((set.equivalent_shear(&stress) - 7f64.sqrt()).abs() <= 1e-15);
    let normal = set.condition(&stress).unwrap().normal;
    for (i, own) in [3.0, -1.0, -2.0].into_iter().enumerate() {
        let expected = own / (2.0 * 7f64.sqrt()) + 0.5 / 3.0;
        assert!((normal.force[i][i] - expected).abs() <= 1e-15);
    }
}

#[test]
fn zero_stress_is_in_the_yield_set() {
    let mut random = RandomNumbers::new(2);
    let zero = Stress::default();
    for _ in 0..100 {
        let set = YieldSet::from(random_mises(&mut random));
        assert!(set.yield_function(&zero) < 0.0 && set.active_conditions(&zero, 1e-9).is_empty());
        let set = YieldSet::from(random_interlayer(&mut random));
        assert!(set.yield_function(&zero) < 0.0 && set.active_conditions(&zero, 1e-9).is_empty());
    }
    assert_eq!(random_mises(&mut random).condition(&zero), None);
    // Without strength zero stress is the apex: it is on the yield surface, and all conditions are active.
    let couple = InterlayerCoupleLimits { strength: 0.0, friction: 0.5, dilatancy: 0.5 };
    let set = InterlayerYieldSet {
        shear_strength: 0.0,
        shear_friction: 0.5,
        shear_dilatancy: 0.5,
        couple: Some(couple),
    };
    assert_eq!(YieldSet::from(set).yield_function(&zero), 0.0);
    assert_eq!(YieldSet::from(set).active_conditions(&zero, 1e-9).len(), 8);
}

#[test]
fn constants_out_of_range_are_rejected_by_name() {
    let sound = Mises::new_drucker_prager(1.0, 0.5, 0.1);
    assert!(sound.check().is_ok());
    let broken: [(&str, Mises); 6] = [
        ("strength", Mises { strength: 0.0, ..sound }),
        ("friction", Mises { friction: -0.1, ..sound }),
        ("dilatancy", Mises { dilatancy: f64::NAN, ..sound }),
        ("antisymmetric_weight", Mises { antisymmetric_weight: -1.0, ..sound }),
        ("symmetric_length", Mises { symmetric_internal_length: Some(0.0), ..sound }),
        ("antisymmetric_length", Mises { antisymmetric_internal_length: Some(-1.0), ..sound }),
    ];
    for (key, set) in broken {
        assert_eq!(set.check().unwrap_err().input, key);
    }
    let sound = random_interlayer(&mut RandomNumbers::new(3));
    let with = |change: fn(&mut InterlayerCoupleLimits)| {
        let mut couple = sound.couple.unwrap();
        change(&mut couple);
        InterlayerYieldSet { couple: Some(couple), ..sound }
    };
    let broken: [(&str, InterlayerYieldSet); 6] = [
        ("shear_strength", InterlayerYieldSet { shear_strength: -1.0, ..sound }),
        ("shear_friction", InterlayerYieldSet { shear_friction: f64::INFINITY, ..sound }),
        ("shear_dilatancy", InterlayerYieldSet { shear_dilatancy: f64::NAN, ..sound }),
        ("couple_strength", with(|c| c.strength = -1.0)),
        ("couple_friction", with(|c| c.friction = -1.0)),
        ("couple_dilatancy", with(|c| c.dilatancy = f64::NAN)),
    ];
    for (key, set) in broken {
        assert_eq!(set.check().unwrap_err().input, key);
    }
}

// ---------------------------------------------------------------- Tangent stiffness

/// Derivatives of a function of the stress with respect to `stresses`, from its gradient with respect to all entries.
fn component_derivatives(stresses: &[StressComponent], gradient: &Stress) -> Vec<f64> {
    stresses.iter().map(|c| c.derivative(gradient)).collect()
}

/// Computes the tangent stiffness D − DM(H + NᵀDM)⁻¹NᵀD in double-double precision from the elastic stiffness D, the
/// matrices N of normals and M of flow directions, and the diagonal matrix H of plastic moduli.
fn direct_tangent(
    d: &[Vec<DoubleDouble>],
    normals: &[Vec<DoubleDouble>],
    flows: &[Vec<DoubleDouble>],
    hardening: &[f64],
) -> Vec<Vec<DoubleDouble>> {
    let (size, count) = (d.len(), normals.len());
    let sum = |terms: &mut dyn Iterator<Item = DoubleDouble>| terms.fold(dd(0.0), |x, y| x + y);
    let images: Vec<Vec<DoubleDouble>> = flows
        .iter()
        .map(|m| (0..size).map(|i| sum(&mut (0..size).map(|j| d[i][j] * m[j]))).collect())
        .collect();
    // Gauss–Jordan elimination of (H + NᵀDM | NᵀD) with partial pivoting.
    let mut rows: Vec<Vec<DoubleDouble>> = (0..count)
        .map(|a| {
            let left = (0..count).map(|b| {
                let entry = sum(&mut (0..size).map(|i| normals[a][i] * images[b][i]));
                if a == b { entry + dd(hardening[a]) } else { entry }
            });
            let right = (0..size).map(|j| sum(&mut (0..size).map(|i| normals[a][i] * d[i][j])));
            left.chain(right).collect()
        })
        .collect();
    for column in 0..count {
        let pivot = (column..count)
            .max_by(|a, b| {
                let size = |r: &usize| rows[*r][column].abs().to_f64();
                size(a).total_cmp(&size(b))
            })
            .unwrap();
        rows.swap(column, pivot);
        let own = rows[column].clone();
        for (number, row) in rows.iter_mut().enumerate() {
            if number != column {
                let factor = row[column] / own[column];
                for (x, y) in row.iter_mut().zip(&own) {
                    *x = *x - factor * *y;
                }
            }
        }
    }
    let mut result = d.to_vec();
    for i in 0..size {
        for j in 0..size {
            for a in 0..count {
                result[i][j] = result[i][j] - images[a][i] * rows[a][count + j] / rows[a][a];
            }
        }
    }
    result
}

fn to_double_double(values: &[f64]) -> Vec<DoubleDouble> {
    values.iter().map(|x| dd(*x)).collect()
}

fn rounded_values(matrix: &RoundedMatrix) -> DMatrix<f64> {
    matrix.map(|entry| entry.value)
}

/// Test case: elastic stiffness in plane strain or in space, and active conditions: one Mises condition, or one to four
/// interlayer conditions.
struct TangentCase {
    stresses: Vec<StressComponent>,
    stiffness: RoundedMatrix,
    conditions: Vec<ActiveCondition>,
}

fn random_case(random: &mut RandomNumbers, number: usize) -> TangentCase {
    let theory = [Theory::Classical, Theory::Reduced, Theory::Cosserat][number % 3];
    let solid = random_solid(random, theory);
    let in_plane = number.is_multiple_of(2);
    let layout = if in_plane { plane_layout(theory) } else { space_layout(theory) };
    let stresses: Vec<StressComponent> = layout.all_stresses().collect();
    let stiffness = solid.stiffness(layout.all_stresses());
    let stress = random_stress(random);
    let conditions = if number % 4 < 2 {
        let condition = random_mises(random).condition(&stress).unwrap();
        vec![ActiveCondition { hardening: random.uniform(0.0, 0.5), ..condition }]
    } else {
        // One sign of each condition, in random order; no couple conditions without couple stress.
        let set = random_interlayer(random);
        let set = if theory == Theory::Cosserat {
            set
        } else {
            InterlayerYieldSet { couple: None, ..set }
        };
        let mut pairs: Vec<ActiveCondition> = set
            .half_spaces()
            .map(|(condition, _)| condition)
            .collect::<Vec<_>>()
            .chunks(2)
            .map(|pair| pair[random.uniform_index(2)])
            .collect();
        for i in (1..pairs.len()).rev() {
            pairs.swap(i, random.uniform_index(i + 1));
        }
        pairs.truncate(1 + random.uniform_index(pairs.len()));
        pairs
    };
    TangentCase { stresses, stiffness, conditions }
}

/// The tangent stiffness annihilates normals and flow directions of conditions without hardening, does not depend on
/// the order of the conditions, and for associated flow is symmetric, positive semidefinite and at most the elastic
/// stiffness.
#[test]
fn tangent_annihilates_normals_and_flow_directions() {
    let mut random = RandomNumbers::new(4);
    let [mut worst_order, mut worst_null] = [0.0f64; 2];
    let mut several = 0;
    for number in 0..3000 {
        let TangentCase { stresses, stiffness, conditions } = random_case(&mut random, number);
        let own = rounded_values(&tangent_stiffness(&stiffness, &stresses, &conditions).unwrap());
        several += usize::from(conditions.len() > 1);
        let size = stiffness.map(|x| x.value).amax();
        for condition in conditions.iter().filter(|c| c.hardening == 0.0) {
            let normal = DVector::from_vec(component_derivatives(&stresses, &condition.normal));
            let flow =
                DVector::from_vec(component_derivatives(&stresses, &condition.flow_direction));
            let null = (own.transpose() * normal).amax().max((&own * flow).amax()) / size;
            worst_null = worst_null.max(null);
            assert!(null <= 1e-13, "{null:e}");
        }
        let mut reversed = conditions.clone();
        reversed.reverse();
        let other = rounded_values(&tangent_stiffness(&stiffness, &stresses, &reversed).unwrap());
        worst_order = worst_order.max((&own - other).amax() / size);
        assert!(worst_order <= 1e-13, "{worst_order:e}");
        let conditions: Vec<ActiveCondition> =
            conditions.into_iter().map(with_associated_flow).collect();
        let own = rounded_values(&tangent_stiffness(&stiffness, &stresses, &conditions).unwrap());
        assert!((&own - own.transpose()).amax() <= 1e-14 * size);
        let least = |m: DMatrix<f64>| m.symmetric_eigenvalues().min();
        assert!(least(own.clone()) >= -1e-13 * size);
        assert!(least(rounded_values(&stiffness) - &own) >= -1e-13 * size);
        // The tangent stiffness differs from the elastic stiffness.
        assert!((rounded_values(&stiffness) - &own).amax() > 1e-3 * size);
    }
    println!("order {worst_order:e}, null directions {worst_null:e}");
    assert!(several > 500, "{several}");
}

/// The rounding bounds of the tangent stiffness cover the formula for all conditions at once, evaluated in
/// double-double precision for the given inputs and for inputs perturbed within their bounds.
#[test]
fn rounding_bounds_of_the_tangent_cover_the_direct_formula() {
    let mut random = RandomNumbers::new(5);
    let (mut worst, mut widest) = (0.0f64, 0.0f64);
    for number in 0..3000 {
        let TangentCase { stresses, stiffness, conditions } = random_case(&mut random, number);
        let own = tangent_stiffness(&stiffness, &stresses, &conditions).unwrap();
        let size = rounded_values(&stiffness).amax();
        for perturbed in [false, true] {
            let mut part = || if perturbed { random.uniform(-1.0, 1.0) } else { 0.0 };
            let mut moved = |x: &Rounded| dd(x.value) + dd(x.bound * part());
            let d: Vec<Vec<DoubleDouble>> =
                stiffness.row_iter().map(|row| row.iter().map(&mut moved).collect()).collect();
            // The plastic modulus is rounded from a decimal: perturb it by one unit roundoff.
            let hardening: Vec<f64> = conditions
                .iter()
                .map(|c| c.hardening * (1.0 + if perturbed { -UNIT_ROUNDOFF } else { 0.0 }))
                .collect();
            let mut vectors = |of: fn(&ActiveCondition) -> &Stress| -> Vec<Vec<DoubleDouble>> {
                conditions
                    .iter()
                    .map(|condition| {
                        let values = component_derivatives(&stresses, of(condition));
                        // Force and couple components have different units and bounds.
                        let bounds = [false, true].map(|is_couple| {
                            let pairs = stresses.iter().zip(&values);
                            let same_unit = pairs.filter(|(c, _)| c.is_couple() == is_couple);
                            8.0 * UNIT_ROUNDOFF * same_unit.fold(0.0f64, |x, y| x.max(y.1.abs()))
                        });
                        let moved = |(c, x): (&StressComponent, DoubleDouble)| match x.high {
                            0.0 => x,
                            _ => x + dd(bounds[usize::from(c.is_couple())] * part()),
                        };
                        stresses.iter().zip(to_double_double(&values)).map(moved).collect()
                    })
                    .collect()
            };
            let (normals, flows) = (vectors(|c| &c.normal), vectors(|c| &c.flow_direction));
            let exact = direct_tangent(&d, &normals, &flows, &hardening);
            for (own, exact) in own.row_iter().zip(&exact).flat_map(|(own, exact)| {
                own.iter().copied().collect::<Vec<_>>().into_iter().zip(exact.clone())
            }) {
                let error = (dd(own.value) - exact).abs().to_f64();
                assert!(error <= own.bound, "{error:e} beyond {own:?}: {conditions:?}");
                if !perturbed {
                    worst = worst.max(error / size);
                }
                widest = widest.max(own.bound / size);
            }
        }
    }
    println!("off by {worst:e}, bounds up to {widest:e}");
    assert!(worst <= 1e-13, "{worst:e}");
    // The rounding bounds are not far too large.
    assert!(widest <= 1e-10, "{widest:e}");
}

#[test]
fn linearly_dependent_conditions_are_skipped() {
    let mut random = RandomNumbers::new(6);
    for number in 0..500 {
        let TangentCase { stresses, stiffness, conditions } = random_case(&mut random, number);
        // Every condition is given twice, with associated flow and without hardening, since with hardening the plastic
        // flow would be distributed over equal conditions.
        let ideal: Vec<ActiveCondition> = conditions
            .into_iter()
            .map(|c| ActiveCondition { hardening: 0.0, ..with_associated_flow(c) })
            .collect();
        let once = tangent_stiffness(&stiffness, &stresses, &ideal).unwrap();
        let twice: Vec<ActiveCondition> = ideal.iter().chain(&ideal).copied().collect();
        assert_eq!(tangent_stiffness(&stiffness, &stresses, &twice).unwrap(), once);
    }
    // At the apex all eight conditions are active: four normals span (σ₁₁, σ₂₁, m₃₁), the other four span the remaining
    // stresses, so the tangent stiffness is zero in any order.
    let solid = random_solid(&mut random, Theory::Cosserat);
    let stresses = plane_layout(Theory::Cosserat).stresses;
    let stiffness = solid.stiffness(stresses.iter().copied());
    let mut all: Vec<ActiveCondition> = random_interlayer(&mut random)
        .half_spaces()
        .map(|(c, _)| with_associated_flow(c))
        .collect();
    for _ in 0..50 {
        for i in (1..all.len()).rev() {
            all.swap(i, random.uniform_index(i + 1));
        }
        let own = rounded_values(&tangent_stiffness(&stiffness, stresses, &all).unwrap());
        assert!(own.amax() <= 1e-13 * rounded_values(&stiffness).amax(), "{own}");
    }
}

/// For a Drucker–Prager cone with friction κ and dilatancy κ̂ in a solid with shear modulus μ and bulk modulus K
/// n·Dm = μ + κκ̂K. If contraction or softening makes the plastic denominator H + n·Dm ≤ 0, the error contains its
/// value; slightly above the critical dilatancy the tangent stiffness exists.
#[test]
fn nonpositive_plastic_denominator_is_an_error() {
    let mut random = RandomNumbers::new(7);
    for _ in 0..200 {
        let solid = random_solid(&mut random, Theory::Classical);
        let (mu, bulk) = (solid.mu, solid.lambda + 2.0 / 3.0 * solid.mu);
        let stresses = space_layout(Theory::Classical).stresses;
        let stiffness = solid.stiffness(stresses.iter().copied());
        let mut stress = random_stress(&mut random);
        for i in 0..3 {
            for j in 0..i {
                stress.force[i][j] = stress.force[j][i];
            }
        }
        let friction = random.uniform(0.2, 0.9);
        let critical = -mu / (friction * bulk);
        for (dilatancy, hardening) in [
            (critical * random.uniform(1.0001, 3.0), 0.0),
            (0.3, -(mu + friction * 0.3 * bulk) * random.uniform(1.0001, 2.0)),
        ] {
            let set = Mises { hardening, ..Mises::new_drucker_prager(1.0, friction, dilatancy) };
            let condition = set.condition(&stress).unwrap();
            let error = tangent_stiffness(&stiffness, stresses, &[condition]).unwrap_err();
            let expected = hardening + mu + friction * dilatancy * bulk;
            let size = mu + friction * dilatancy.abs() * bulk + hardening.abs();
            assert!((error.value - expected).abs() <= 1e-14 * size, "{error} {expected}");
            assert_eq!(error.condition, "yield");
            assert!(error.to_string().contains(&format!("{:e}", error.value)), "{error}");
        }
        let set = Mises::new_drucker_prager(1.0, friction, critical * 0.9999);
        assert!(
            tangent_stiffness(&stiffness, stresses, &[set.condition(&stress).unwrap()]).is_ok()
        );
    }
}

/// If the plastic denominator n·Dm is zero to within rounding, its sign is uncertain: the result is an error, not a
/// division by n·Dm, and the condition is not mistaken for a linearly dependent one.
#[test]
fn uncertain_plastic_denominator_is_an_error() {
    let mut random = RandomNumbers::new(8);
    let mut skipped = 0;
    for _ in 0..200 {
        let solid = random_solid(&mut random, Theory::Classical);
        let bulk = solid.lambda + 2.0 / 3.0 * solid.mu;
        let stresses = space_layout(Theory::Classical).stresses;
        let stiffness = solid.stiffness(stresses.iter().copied());
        let mut stress = Stress::default();
        (stress.force[0][1], stress.force[1][0]) = (1.0, 1.0);
        stress.force[2][2] = random.uniform(0.1, 1.0);
        let set = Mises::new_drucker_prager(1.0, 0.5, -solid.mu / (0.5 * bulk));
        match tangent_stiffness(&stiffness, stresses, &[set.condition(&stress).unwrap()]) {
            Err(error) => assert!(error.value.abs() <= 1e-14 * solid.mu),
            Ok(own) => {
                assert_eq!(own, stiffness);
                skipped += 1;
            }
        }
    }
    assert_eq!(skipped, 0, "of 200");
}

/// Stress rate of an ideally plastic solid that yields at `stress`, from the nonlinear law at the strain rate `strain`.
fn stress_rate(
    stiffness: &DMatrix<f64>,
    set: &Mises,
    components: &[StressComponent],
    stress: &DVector<f64>,
    strain: &DVector<f64>,
) -> DVector<f64> {
    let mut tensor = Stress::default();
    for (component, value) in components.iter().zip(stress.iter()) {
        component.set(&mut tensor, *value);
    }
    let condition = set.condition(&tensor).expect("off the axis");
    let [n, m] = [condition.normal, condition.flow_direction]
        .map(|g| DVector::from_vec(component_derivatives(components, &g)));
    let rate = n.dot(&(stiffness * strain)) / n.dot(&(stiffness * &m));
    stiffness * (strain - m * rate)
}

/// In a background that flows plastically at the multiplier rate Λ with constant stress, perturbations s′ of the stress
/// obey ṡ′ = −D_t Λ∇²f s′ with the tangent stiffness D_t and the Hessian ∇²f of the yield function; verified by finite
/// differences of the nonlinear law.
#[test]
fn perturbations_of_plastic_flow_relax_with_the_curvature_of_the_yield_surface() {
    let random = &mut RandomNumbers::new(31);
    let mut worst = 0.0f64;
    for number in 0..300 {
        let theory = [Theory::Classical, Theory::Reduced, Theory::Cosserat][number % 3];
        let solid = random_solid(random, theory);
        let layout = if number % 2 == 0 { plane_layout(theory) } else { space_layout(theory) }
            .with_out_of_plane();
        let components: Vec<StressComponent> = layout.all_stresses().collect();
        let set = random_mises(random);
        let stress = DVector::from_fn(components.len(), |_, _| random.signed_uniform(0.1, 1.0));
        let mut tensor = Stress::default();
        for (component, value) in components.iter().zip(stress.iter()) {
            component.set(&mut tensor, *value);
        }
        let condition = set.condition(&tensor).expect("off the axis");
        let stiffness = solid.stiffness(layout.all_stresses());
        let stiffness_values = rounded_values(&stiffness);
        let plastic_rate = random.uniform(0.2, 2.0);
        let strain =
            DVector::from_vec(component_derivatives(&components, &condition.flow_direction))
                * plastic_rate;
        let at = |stress: &DVector<f64>| {
            stress_rate(&stiffness_values, &set, &components, stress, &strain)
        };
        assert!(at(&stress).amax() < 1e-13, "the background's stress stays");

        let curvature = set.curvature(&tensor, &components).expect("off the axis");
        assert!((&curvature - curvature.transpose()).amax() < 1e-14 * curvature.amax());
        let least = curvature.clone().symmetric_eigenvalues().min();
        assert!(least > -1e-14 * curvature.amax(), "{least:e}");
        // Scaling the stress at constant mean does not change the flow direction: this direction has zero curvature.
        let along = DVector::from_fn(components.len(), |i, _| {
            let mut deviator = tensor;
            let mean = (0..3).map(|i| deviator.force[i][i]).sum::<f64>() / 3.0;
            for i in 0..3 {
                deviator.force[i][i] -= mean;
            }
            components[i].value_in(&deviator)
        });
        if number % 2 == 1 || theory != Theory::Classical {
            assert!((&curvature * along).amax() < 1e-13 * curvature.amax());
        }

        let tangent = rounded_values(
            &tangent_stiffness(&stiffness, &components, &[condition]).expect("response"),
        );
        let expected = -tangent * curvature * plastic_rate;
        let step = 1e-5;
        for column in 0..components.len() {
            let moved = |sign: f64| {
                let mut moved = stress.clone();
                moved[column] += sign * step;
                at(&moved)
            };
            let slope = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            worst = worst.max((slope - expected.column(column)).amax() / expected.amax());
        }
    }
    println!("{worst:e}");
    // Tolerance: errors of central differences, h² times third derivatives and rounding errors over h.
    assert!(worst < 1e-6);
}
