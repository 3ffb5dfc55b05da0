//! Yield normals against finite differences of the yield function, and the tangent stiffness against the formula for
//! all conditions at once.

mod support;

use nalgebra::{DMatrix, DVector};
use support::{Random, Wide, wide};
use wellposed_models::Rounded;
use wellposed_models::common::rounding::UNIT_ROUNDOFF;
use wellposed_models::common::system::Matrix;
use wellposed_models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use wellposed_models::solid::stress::{Component, Stress};
use wellposed_models::solid::symbol::{plane, space};
use wellposed_models::yield_set::YieldSet;
use wellposed_models::yield_set::parameters::{
    ActiveCondition, Interlayer, InterlayerCouple, Mises,
};
use wellposed_models::yield_set::tangent::tangent;

fn solid(random: &mut Random, theory: Theory) -> Isotropic {
    let mu = random.within(0.5, 2.0);
    let gamma = random.within(0.2, 2.0);
    let couple = CoupleModuli {
        beta: gamma * (random.within(0.1, 2.0) - 2.0 / 3.0),
        gamma,
        eta: random.within(0.2, 2.0),
    };
    let microrotation = Microrotation {
        alpha: random.within(0.1, 2.0),
        inertia: random.within(0.2, 2.0),
        couple: (theory == Theory::Cosserat).then_some(couple),
    };
    let lambda = mu * (random.within(0.1, 3.0) - 2.0 / 3.0);
    let rotating = (theory != Theory::Classical).then_some(microrotation);
    Isotropic::new(lambda, mu, 1.0, rotating).unwrap()
}

fn random_stress(random: &mut Random) -> Stress {
    let mut tensor = || std::array::from_fn(|_| std::array::from_fn(|_| random.generic(0.1, 1.0)));
    Stress { force: tensor(), couple: tensor() }
}

fn mises(random: &mut Random) -> Mises {
    let friction = random.within(0.1, 0.8);
    Mises {
        friction,
        dilatancy: friction * random.within(0.2, 0.9),
        antisymmetric_weight: random.within(0.3, 3.0),
        symmetric_length: Some(random.within(0.5, 2.0)),
        antisymmetric_length: Some(random.within(0.5, 2.0)),
        ..Mises::von_mises(random.within(0.5, 2.0))
    }
    .check()
    .unwrap()
}

fn interlayer(random: &mut Random) -> Interlayer {
    let couple = InterlayerCouple {
        strength: random.within(0.5, 2.0),
        friction: random.within(0.2, 0.9),
        dilatancy: random.within(0.1, 0.2),
    };
    Interlayer {
        shear_strength: random.within(0.5, 2.0),
        shear_friction: random.within(0.2, 0.9),
        shear_dilatancy: random.within(0.1, 0.2),
        couple: Some(couple),
    }
    .check()
    .unwrap()
}

/// The condition with associated flow: flow direction equal to the yield normal.
fn associated(mut condition: ActiveCondition) -> ActiveCondition {
    condition.flow = condition.normal;
    condition
}

fn components() -> impl Iterator<Item = Component> {
    let pairs = (0..9).map(|n| (n / 3, n % 3));
    pairs
        .clone()
        .map(|(i, j)| Component::Force(i, j))
        .chain(pairs.map(|(i, j)| Component::Couple(i, j)))
}

/// Checks `gradient` against ∂f/∂s by central differences over ±h. Truncation error h² f'''/6 and rounding error over h
/// are about 1e-10 each for stresses and radii of curvature of order 0.1 and more.
fn check_gradient(value: impl Fn(&Stress) -> f64, gradient: &Stress, stress: &Stress) -> f64 {
    const H: f64 = 2e-6;
    let mut worst = 0.0f64;
    for component in components() {
        let [mut up, mut down] = [*stress; 2];
        component.set(&mut up, component.value_in(stress) + H);
        component.set(&mut down, component.value_in(stress) - H);
        let difference = (value(&up) - value(&down)) / (2.0 * H);
        worst = worst.max((difference - component.value_in(gradient)).abs());
    }
    assert!(worst <= 2e-9, "{worst:e} at {stress:?}");
    worst
}

/// Normals are gradients of the yield function, flow directions gradients of the plastic potential.
#[test]
fn normals_are_gradients() {
    let mut random = Random::new(1);
    let mut worst = 0.0f64;
    for _ in 0..500 {
        let set = mises(&mut random);
        let stress = random_stress(&mut random);
        let condition = set.condition(&stress).unwrap();
        let value = |s: &Stress| YieldSet::from(set).value(s);
        worst = worst.max(check_gradient(value, &condition.normal, &stress));
        // The flow direction is the gradient of the plastic potential: f with the dilatancy in place of the friction.
        let potential = Mises { friction: set.dilatancy, ..set };
        let value = |s: &Stress| YieldSet::from(potential).value(s);
        worst = worst.max(check_gradient(value, &condition.flow, &stress));

        // The yield function is the maximum over the eight half-spaces; it must exceed the other values by 0.01.
        let set = interlayer(&mut random);
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
        let own = YieldSet::from(set).value(&stress);
        assert!((own - greatest).abs() <= 1e-15, "{own} {greatest}");
        if values.iter().filter(|v| **v > greatest - 0.01).count() > 1 {
            continue;
        }
        // The half-space, including its sign, that attains the maximum.
        let value = |s: &Stress| YieldSet::from(set).value(s);
        let (nearest, _) = set
            .half_spaces()
            .find(|(condition, strength)| {
                let product: f64 =
                    components().map(|c| c.value_in(&condition.normal) * c.value_in(&stress)).sum();
                (product - strength - greatest).abs() <= 1e-14
            })
            .unwrap();
        worst = worst.max(check_gradient(value, &nearest.normal, &stress));
    }
    println!("normals: {worst:e}");
    assert_eq!(interlayer(&mut random).half_spaces().count(), 8);
}

/// Normals of a deviator of 1e-9 times the pressure are exact to rounding, since its differences are exact.
#[test]
fn normals_under_pressure() {
    let set = Mises::drucker_prager(1.0, 0.5, 0.5);
    let mut stress = Stress::default();
    let mean = -(2f64.powi(30));
    for (i, own) in [3.0, -1.0, -2.0].into_iter().enumerate() {
        stress.force[i][i] = mean + own;
    }
    // |s|² = 14, τ̄ = √7.
    assert!((set.equivalent_shear(&stress) - 7f64.sqrt()).abs() <= 1e-15);
    let normal = set.condition(&stress).unwrap().normal;
    for (i, own) in [3.0, -1.0, -2.0].into_iter().enumerate() {
        let expected = own / (2.0 * 7f64.sqrt()) + 0.5 / 3.0;
        assert!((normal.force[i][i] - expected).abs() <= 1e-15);
    }
}

#[test]
fn zero_stress_is_inside() {
    let mut random = Random::new(2);
    let zero = Stress::default();
    for _ in 0..100 {
        let set = YieldSet::from(mises(&mut random));
        assert!(set.value(&zero) < 0.0 && set.active(&zero, 1e-9).is_empty());
        let set = YieldSet::from(interlayer(&mut random));
        assert!(set.value(&zero) < 0.0 && set.active(&zero, 1e-9).is_empty());
    }
    assert_eq!(mises(&mut random).condition(&zero), None);
    // Without strength zero stress is the apex: on the boundary, all conditions active.
    let couple = InterlayerCouple { strength: 0.0, friction: 0.5, dilatancy: 0.5 };
    let set = Interlayer {
        shear_strength: 0.0,
        shear_friction: 0.5,
        shear_dilatancy: 0.5,
        couple: Some(couple),
    };
    assert_eq!(YieldSet::from(set).value(&zero), 0.0);
    assert_eq!(YieldSet::from(set).active(&zero, 1e-9).len(), 8);
}

#[test]
fn constants_out_of_range_are_rejected_by_name() {
    let sound = Mises::drucker_prager(1.0, 0.5, 0.1);
    assert!(sound.check().is_ok());
    let broken: [(&str, Mises); 6] = [
        ("strength", Mises { strength: 0.0, ..sound }),
        ("friction", Mises { friction: -0.1, ..sound }),
        ("dilatancy", Mises { dilatancy: f64::NAN, ..sound }),
        ("antisymmetric_weight", Mises { antisymmetric_weight: -1.0, ..sound }),
        ("symmetric_length", Mises { symmetric_length: Some(0.0), ..sound }),
        ("antisymmetric_length", Mises { antisymmetric_length: Some(-1.0), ..sound }),
    ];
    for (key, set) in broken {
        assert_eq!(set.check().unwrap_err().input, key);
    }
    let sound = interlayer(&mut Random::new(3));
    let with = |change: fn(&mut InterlayerCouple)| {
        let mut couple = sound.couple.unwrap();
        change(&mut couple);
        Interlayer { couple: Some(couple), ..sound }
    };
    let broken: [(&str, Interlayer); 6] = [
        ("shear_strength", Interlayer { shear_strength: -1.0, ..sound }),
        ("shear_friction", Interlayer { shear_friction: f64::INFINITY, ..sound }),
        ("shear_dilatancy", Interlayer { shear_dilatancy: f64::NAN, ..sound }),
        ("couple_strength", with(|c| c.strength = -1.0)),
        ("couple_friction", with(|c| c.friction = -1.0)),
        ("couple_dilatancy", with(|c| c.dilatancy = f64::NAN)),
    ];
    for (key, set) in broken {
        assert_eq!(set.check().unwrap_err().input, key);
    }
}

// ---------------------------------------------------------------- Tangent stiffness

fn vector(stresses: &[Component], gradient: &Stress) -> Vec<f64> {
    stresses.iter().map(|c| c.derivative(gradient)).collect()
}

/// Computes D − DM(H + NᵀDM)⁻¹NᵀD in double-double precision; H is diagonal.
fn direct(
    d: &[Vec<Wide>],
    normals: &[Vec<Wide>],
    flows: &[Vec<Wide>],
    hardening: &[f64],
) -> Vec<Vec<Wide>> {
    let (size, count) = (d.len(), normals.len());
    let sum = |terms: &mut dyn Iterator<Item = Wide>| terms.fold(wide(0.0), |x, y| x + y);
    let images: Vec<Vec<Wide>> = flows
        .iter()
        .map(|m| (0..size).map(|i| sum(&mut (0..size).map(|j| d[i][j] * m[j]))).collect())
        .collect();
    // Gauss–Jordan elimination of (H + NᵀDM | NᵀD) with partial pivoting.
    let mut rows: Vec<Vec<Wide>> = (0..count)
        .map(|a| {
            let left = (0..count).map(|b| {
                let entry = sum(&mut (0..size).map(|i| normals[a][i] * images[b][i]));
                if a == b { entry + wide(hardening[a]) } else { entry }
            });
            let right = (0..size).map(|j| sum(&mut (0..size).map(|i| normals[a][i] * d[i][j])));
            left.chain(right).collect()
        })
        .collect();
    for column in 0..count {
        let pivot = (column..count)
            .max_by(|a, b| {
                let size = |r: &usize| rows[*r][column].abs().value();
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

fn lift(values: &[f64]) -> Vec<Wide> {
    values.iter().map(|x| wide(*x)).collect()
}

fn values(matrix: &Matrix) -> DMatrix<f64> {
    matrix.map(|entry| entry.value)
}

/// Test case: elastic stiffness in plane strain or in space, and active conditions: one Mises condition, or one to four
/// interlayer conditions.
struct Case {
    stresses: Vec<Component>,
    elastic: Matrix,
    conditions: Vec<ActiveCondition>,
}

fn case(random: &mut Random, number: usize) -> Case {
    let theory = [Theory::Classical, Theory::Reduced, Theory::Cosserat][number % 3];
    let solid = solid(random, theory);
    let in_plane = number.is_multiple_of(2);
    let layout = if in_plane { plane(theory) } else { space(theory) };
    let stresses: Vec<Component> = layout.all_stresses().collect();
    let elastic = solid.stiffness(layout.all_stresses());
    let stress = random_stress(random);
    let conditions = if number % 4 < 2 {
        let condition = mises(random).condition(&stress).unwrap();
        vec![ActiveCondition { hardening: random.within(0.0, 0.5), ..condition }]
    } else {
        // One sign of each condition, in random order; no couple conditions without couple stress.
        let set = interlayer(random);
        let set = if theory == Theory::Cosserat { set } else { Interlayer { couple: None, ..set } };
        let mut pairs: Vec<ActiveCondition> = set
            .half_spaces()
            .map(|(condition, _)| condition)
            .collect::<Vec<_>>()
            .chunks(2)
            .map(|pair| pair[random.below(2)])
            .collect();
        for i in (1..pairs.len()).rev() {
            pairs.swap(i, random.below(i + 1));
        }
        pairs.truncate(1 + random.below(pairs.len()));
        pairs
    };
    Case { stresses, elastic, conditions }
}

/// The tangent stiffness annihilates normals and flow directions of ideal conditions, does not depend on their order,
/// and for associated flow is symmetric, positive semidefinite and at most the elastic stiffness.
#[test]
fn tangent_keeps_to_the_conditions() {
    let mut random = Random::new(4);
    let [mut worst_order, mut worst_null] = [0.0f64; 2];
    let mut several = 0;
    for number in 0..3000 {
        let Case { stresses, elastic, conditions } = case(&mut random, number);
        let own = values(&tangent(&elastic, &stresses, &conditions).unwrap());
        several += usize::from(conditions.len() > 1);
        let size = elastic.map(|x| x.value).amax();
        for condition in conditions.iter().filter(|c| c.hardening == 0.0) {
            let normal = DVector::from_vec(vector(&stresses, &condition.normal));
            let flow = DVector::from_vec(vector(&stresses, &condition.flow));
            let null = (own.transpose() * normal).amax().max((&own * flow).amax()) / size;
            worst_null = worst_null.max(null);
            assert!(null <= 1e-13, "{null:e}");
        }
        // The result does not depend on the order of the conditions.
        let mut reversed = conditions.clone();
        reversed.reverse();
        let other = values(&tangent(&elastic, &stresses, &reversed).unwrap());
        worst_order = worst_order.max((&own - other).amax() / size);
        assert!(worst_order <= 1e-13, "{worst_order:e}");
        // For associated flow: symmetric, positive semidefinite, and at most the elastic stiffness.
        let conditions: Vec<ActiveCondition> = conditions.into_iter().map(associated).collect();
        let own = values(&tangent(&elastic, &stresses, &conditions).unwrap());
        assert!((&own - own.transpose()).amax() <= 1e-14 * size);
        let least = |m: DMatrix<f64>| m.symmetric_eigenvalues().min();
        assert!(least(own.clone()) >= -1e-13 * size);
        assert!(least(values(&elastic) - &own) >= -1e-13 * size);
        // The tangent stiffness differs from the elastic stiffness.
        assert!((values(&elastic) - &own).amax() > 1e-3 * size);
    }
    println!("order {worst_order:e}, null directions {worst_null:e}");
    assert!(several > 500, "{several}");
}

/// The rounding bounds of the tangent stiffness cover the formula for all conditions at once, evaluated in
/// double-double precision for the given inputs and for inputs perturbed within their bounds.
#[test]
fn tangent_is_the_direct_formula_within_its_bounds() {
    let mut random = Random::new(5);
    let (mut worst, mut widest) = (0.0f64, 0.0f64);
    for number in 0..3000 {
        let Case { stresses, elastic, conditions } = case(&mut random, number);
        let own = tangent(&elastic, &stresses, &conditions).unwrap();
        let size = values(&elastic).amax();
        for perturbed in [false, true] {
            let mut part = || if perturbed { random.within(-1.0, 1.0) } else { 0.0 };
            let mut moved = |x: &Rounded| wide(x.value) + wide(x.bound * part());
            let d: Vec<Vec<Wide>> =
                elastic.row_iter().map(|row| row.iter().map(&mut moved).collect()).collect();
            // The plastic modulus is rounded from a decimal: perturb it by one unit roundoff.
            let hardening: Vec<f64> = conditions
                .iter()
                .map(|c| c.hardening * (1.0 + if perturbed { -UNIT_ROUNDOFF } else { 0.0 }))
                .collect();
            let mut vectors = |of: fn(&ActiveCondition) -> &Stress| -> Vec<Vec<Wide>> {
                conditions
                    .iter()
                    .map(|condition| {
                        let values = vector(&stresses, of(condition));
                        let largest = values.iter().fold(0.0f64, |x, y| x.max(y.abs()));
                        let bound = 8.0 * UNIT_ROUNDOFF * largest;
                        let moved = |x: Wide| match x.high {
                            0.0 => x,
                            _ => x + wide(bound * part()),
                        };
                        lift(&values).into_iter().map(moved).collect()
                    })
                    .collect()
            };
            let (normals, flows) = (vectors(|c| &c.normal), vectors(|c| &c.flow));
            let exact = direct(&d, &normals, &flows, &hardening);
            for (own, exact) in own.row_iter().zip(&exact).flat_map(|(own, exact)| {
                own.iter().copied().collect::<Vec<_>>().into_iter().zip(exact.clone())
            }) {
                let error = (wide(own.value) - exact).abs().value();
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
    // The bounds are not too wide.
    assert!(widest <= 1e-10, "{widest:e}");
}

#[test]
fn conditions_with_dependent_normals_are_skipped() {
    let mut random = Random::new(6);
    for number in 0..500 {
        let Case { stresses, elastic, conditions } = case(&mut random, number);
        // Every condition twice; associated and without hardening, since with hardening the plastic flow would be
        // distributed over equal conditions.
        let ideal: Vec<ActiveCondition> = conditions
            .into_iter()
            .map(|c| ActiveCondition { hardening: 0.0, ..associated(c) })
            .collect();
        let once = tangent(&elastic, &stresses, &ideal).unwrap();
        let twice: Vec<ActiveCondition> = ideal.iter().chain(&ideal).copied().collect();
        assert_eq!(tangent(&elastic, &stresses, &twice).unwrap(), once);
    }
    // At the apex all eight conditions are active: four normals span (σ₁₁, σ₂₁, m₃₁), the other four span the remaining
    // stresses, so the tangent stiffness is zero in any order.
    let solid = solid(&mut random, Theory::Cosserat);
    let stresses = plane(Theory::Cosserat).stresses;
    let elastic = solid.stiffness(stresses.iter().copied());
    let mut all: Vec<ActiveCondition> =
        interlayer(&mut random).half_spaces().map(|(c, _)| associated(c)).collect();
    for _ in 0..50 {
        for i in (1..all.len()).rev() {
            all.swap(i, random.below(i + 1));
        }
        let own = values(&tangent(&elastic, stresses, &all).unwrap());
        assert!(own.amax() <= 1e-13 * values(&elastic).amax(), "{own}");
    }
}

/// For a Drucker–Prager cone n·Dm = μ + κκ̂K. If contraction or softening makes H + n·Dm ≤ 0, the error contains the
/// value; slightly above the critical dilatancy the tangent stiffness exists.
#[test]
fn no_response() {
    let mut random = Random::new(7);
    for _ in 0..200 {
        let solid = solid(&mut random, Theory::Classical);
        let (mu, bulk) = (solid.mu, solid.lambda + 2.0 / 3.0 * solid.mu);
        let stresses = space(Theory::Classical).stresses;
        let elastic = solid.stiffness(stresses.iter().copied());
        let mut stress = random_stress(&mut random);
        for i in 0..3 {
            for j in 0..i {
                stress.force[i][j] = stress.force[j][i];
            }
        }
        let friction = random.within(0.2, 0.9);
        let critical = -mu / (friction * bulk);
        for (dilatancy, hardening) in [
            (critical * random.within(1.0001, 3.0), 0.0),
            (0.3, -(mu + friction * 0.3 * bulk) * random.within(1.0001, 2.0)),
        ] {
            let set = Mises { hardening, ..Mises::drucker_prager(1.0, friction, dilatancy) };
            let condition = set.condition(&stress).unwrap();
            let error = tangent(&elastic, stresses, &[condition]).unwrap_err();
            let expected = hardening + mu + friction * dilatancy * bulk;
            let size = mu + friction * dilatancy.abs() * bulk + hardening.abs();
            assert!((error.value - expected).abs() <= 1e-14 * size, "{error} {expected}");
            assert_eq!(error.condition, "yield");
            assert!(error.to_string().contains(&format!("{:e}", error.value)), "{error}");
        }
        // Slightly above the critical dilatancy.
        let set = Mises::drucker_prager(1.0, friction, critical * 0.9999);
        assert!(tangent(&elastic, stresses, &[set.condition(&stress).unwrap()]).is_ok());
    }
}

/// If n·Dm is zero to within rounding, its sign is uncertain: the result is an error, not a division by it, and the
/// condition is not mistaken for a linearly dependent one.
#[test]
fn no_response_at_the_critical_dilatancy() {
    let mut random = Random::new(8);
    let mut passed_over = 0;
    for _ in 0..200 {
        let solid = solid(&mut random, Theory::Classical);
        let bulk = solid.lambda + 2.0 / 3.0 * solid.mu;
        let stresses = space(Theory::Classical).stresses;
        let elastic = solid.stiffness(stresses.iter().copied());
        let mut stress = Stress::default();
        (stress.force[0][1], stress.force[1][0]) = (1.0, 1.0);
        stress.force[2][2] = random.within(0.1, 1.0);
        let set = Mises::drucker_prager(1.0, 0.5, -solid.mu / (0.5 * bulk));
        match tangent(&elastic, stresses, &[set.condition(&stress).unwrap()]) {
            Err(error) => assert!(error.value.abs() <= 1e-14 * solid.mu),
            Ok(own) => {
                assert_eq!(own, elastic);
                passed_over += 1;
            }
        }
    }
    assert_eq!(passed_over, 0, "of 200");
}

/// Stress rate of an ideally plastic solid that yields at `stress`, from the nonlinear law; `strain`: the strain rate.
fn stress_rate(
    elastic: &DMatrix<f64>,
    set: &Mises,
    list: &[Component],
    stress: &DVector<f64>,
    strain: &DVector<f64>,
) -> DVector<f64> {
    let mut tensor = Stress::default();
    for (component, value) in list.iter().zip(stress.iter()) {
        component.set(&mut tensor, *value);
    }
    let condition = set.condition(&tensor).expect("off the axis");
    let [n, m] = [condition.normal, condition.flow].map(|g| DVector::from_vec(vector(list, &g)));
    let rate = n.dot(&(elastic * strain)) / n.dot(&(elastic * &m));
    elastic * (strain - m * rate)
}

/// In a background that flows plastically at the rate Λ with constant stress, perturbations of the stress relax with
/// the matrix −D_t Λ∇²f; verified by finite differences of the nonlinear law.
#[test]
fn perturbations_of_a_flowing_background_relax_by_the_curvature() {
    let random = &mut Random::new(31);
    let mut worst = 0.0f64;
    for number in 0..300 {
        let theory = [Theory::Classical, Theory::Reduced, Theory::Cosserat][number % 3];
        let solid = solid(random, theory);
        let layout = if number % 2 == 0 { plane(theory) } else { space(theory) }.carrying();
        let list: Vec<Component> = layout.all_stresses().collect();
        let set = mises(random);
        let stress = DVector::from_fn(list.len(), |_, _| random.generic(0.1, 1.0));
        let mut tensor = Stress::default();
        for (component, value) in list.iter().zip(stress.iter()) {
            component.set(&mut tensor, *value);
        }
        let condition = set.condition(&tensor).expect("off the axis");
        let stiffness = solid.stiffness(layout.all_stresses());
        let elastic = values(&stiffness);
        let plastic_rate = random.within(0.2, 2.0);
        let strain = DVector::from_vec(vector(&list, &condition.flow)) * plastic_rate;
        let at = |stress: &DVector<f64>| stress_rate(&elastic, &set, &list, stress, &strain);
        assert!(at(&stress).amax() < 1e-13, "the background's stress stays");

        let curvature = set.curvature(&tensor, &list).expect("off the axis");
        assert!((&curvature - curvature.transpose()).amax() < 1e-14 * curvature.amax());
        let least = curvature.clone().symmetric_eigenvalues().min();
        assert!(least > -1e-14 * curvature.amax(), "{least:e}");
        // Scaling of the stress does not change the flow direction: the curvature along it is zero.
        let along = DVector::from_fn(list.len(), |i, _| {
            let mut deviator = tensor;
            let mean = (0..3).map(|i| deviator.force[i][i]).sum::<f64>() / 3.0;
            for i in 0..3 {
                deviator.force[i][i] -= mean;
            }
            list[i].value_in(&deviator)
        });
        if number % 2 == 1 || theory != Theory::Classical {
            assert!((&curvature * along).amax() < 1e-13 * curvature.amax());
        }

        let tangent = values(&tangent(&stiffness, &list, &[condition]).expect("response"));
        let expected = -tangent * curvature * plastic_rate;
        let step = 1e-5;
        for column in 0..list.len() {
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
    // Errors of central differences: h² times third derivatives, and rounding over h.
    assert!(worst < 1e-6);
}
