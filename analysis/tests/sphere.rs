//! Flutter and shear bands over all directions against brute force, planted caps of flutter, invariances
//! and Rudnicki & Rice's closed form.

mod support;

use models::common::rates::RateEquations;
use models::common::rounding::Rounded;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::stress::{Component, Stress};
use models::yield_set::parameters::{ActiveCondition, Mises};
use nalgebra::{DMatrix, DVector, Rotation3, Vector3};
use support::states::{Random, seeded};
use wellposed_analysis::sphere::{Extremes, RankOne, Sphere, SphereError};

type Tensor = [[f64; 3]; 3];

fn isotropic(random: &mut Random, is_cosserat: bool) -> Isotropic {
    let mu = random.decades(0.1, 10.0);
    let microrotation = is_cosserat.then(|| {
        let gamma = random.decades(0.1, 10.0);
        Microrotation {
            alpha: random.decades(0.05, 5.0),
            inertia: random.decades(0.1, 10.0),
            couple: Some(CoupleModuli {
                beta: random.within(-0.6 * gamma, 3.0 * gamma),
                gamma,
                eta: random.decades(0.1, 10.0),
            }),
        }
    });
    Isotropic {
        lambda: mu * random.within(-0.6, 4.0),
        mu,
        density: random.decades(0.3, 3.0),
        microrotation,
    }
}

fn random_tensor(random: &mut Random, is_symmetric: bool) -> Tensor {
    let mut t: Tensor = std::array::from_fn(|_| std::array::from_fn(|_| random.within(-1.0, 1.0)));
    if is_symmetric {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            t[j][i] = t[i][j];
        }
    }
    t
}

fn random_stress(random: &mut Random, is_cosserat: bool) -> Stress {
    let force = random_tensor(random, !is_cosserat);
    let couple = if is_cosserat { random_tensor(random, false) } else { [[0.0; 3]; 3] };
    Stress { force, couple }
}

fn rotation(random: &mut Random) -> Tensor {
    let axis = Vector3::from_fn(|_, _| random.within(-1.0, 1.0));
    let turned = Rotation3::new(axis.normalize() * random.within(0.0, 6.0));
    std::array::from_fn(|i| std::array::from_fn(|j| turned[(i, j)]))
}

fn turned(q: &Tensor, t: &Tensor) -> Tensor {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let mut sum = 0.0;
            for k in 0..3 {
                for l in 0..3 {
                    sum += q[i][k] * q[j][l] * t[k][l];
                }
            }
            sum
        })
    })
}

fn components(solid: &Isotropic) -> Vec<Component> {
    solid.layout::<3>().all_stresses().collect()
}

fn vector(list: &[Component], gradient: &Stress) -> Vec<f64> {
    list.iter().map(|c| c.derivative(gradient)).collect()
}

fn update(solid: &Isotropic, condition: &ActiveCondition) -> Result<RankOne, SphereError> {
    let list = components(solid);
    RankOne::new(
        &solid.rates::<3>(),
        &vector(&list, &condition.normal),
        &vector(&list, &condition.flow),
        condition.hardening,
    )
}

fn cosserat_mises(random: &mut Random) -> Mises {
    Mises {
        antisymmetric_weight: random.within(0.0, 2.0),
        symmetric_length: Some(random.decades(0.3, 3.0)),
        antisymmetric_length: Some(random.decades(0.3, 3.0)),
        ..Mises::drucker_prager(1.0, random.within(0.0, 1.5), random.within(-0.5, 1.5))
    }
}

fn search(sphere: &Sphere, update: &RankOne) -> Extremes {
    sphere.search(update, &mut sphere.workspace()).unwrap()
}

/// M^(−½) G(n)ᵀ (D − a bᵀ) G(n) M^(−½), and its eigenvalues by nalgebra.
fn brute_speeds(elastic: &RateEquations<3>, update: &RankOne, n: [f64; 3]) -> Vec<(f64, f64)> {
    let tangent = elastic.stiffness_values()
        - DVector::from_vec(update.image.clone())
            * DVector::from_vec(update.covector.clone()).transpose();
    let mut g = DMatrix::zeros(elastic.stresses(), elastic.velocities());
    for (gradient, component) in elastic.gradient.iter().zip(n) {
        g += gradient * component;
    }
    for (v, inertia) in elastic.inertia.iter().enumerate() {
        g.column_mut(v).scale_mut(1.0 / inertia.value.sqrt());
    }
    let acoustic = g.transpose() * tangent * g;
    acoustic.complex_eigenvalues().iter().map(|z| (z.re, z.im)).collect()
}

/// Least real c² and greatest |Im c| of complex ones. Multiple roots split by the root of rounding.
fn brute_extremes(speeds: &[(f64, f64)]) -> (f64, f64) {
    let size = speeds.iter().fold(0.0, |size: f64, (re, im)| size.max(re.abs()).max(im.abs()));
    let (mut least, mut growth) = (f64::INFINITY, 0.0_f64);
    for &(re, im) in speeds {
        if im.abs() < 1e-5 * size {
            least = least.min(re);
        } else {
            growth = growth.max((0.5 * (re.hypot(im) - re)).sqrt());
        }
    }
    (least, growth)
}

fn spiral(count: usize) -> impl Iterator<Item = [f64; 3]> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..count).map(move |i| {
        let z = 1.0 - (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (golden * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    })
}

/// Maximum of a function near a direction by trying ever smaller steps.
fn climb(start: [f64; 3], mut step: f64, function: impl Fn([f64; 3]) -> f64) -> ([f64; 3], f64) {
    let mut best = (start, function(start));
    while step > 1e-9 {
        let centre = Vector3::from(best.0);
        let first = centre.cross(&if centre.x.abs() < 0.6 { Vector3::x() } else { Vector3::y() });
        let first = first.normalize();
        let second = centre.cross(&first);
        let before = best.1;
        for i in 0..8 {
            let (sin, cos) = (std::f64::consts::FRAC_PI_4 * f64::from(i)).sin_cos();
            let point = (centre + (first * cos + second * sin) * step).normalize();
            let value = function(point.into());
            if value > best.1 {
                best = (point.into(), value);
            }
        }
        if best.1 <= before {
            step *= 0.5;
        }
    }
    best
}

fn compare_with_brute_force(
    elastic: &RateEquations<3>,
    sphere: &Sphere,
    update: &RankOne,
    worst: &mut [f64; 2],
) -> bool {
    let found = search(sphere, update);
    let speeds = |n| brute_extremes(&brute_speeds(elastic, update, n));
    let unit = spiral(50)
        .flat_map(|n| brute_speeds(elastic, update, n))
        .fold(0.0, |size: f64, (re, im)| size.max(re.hypot(im)));
    let (mut slowest, mut flutter) = (([0.0; 3], f64::INFINITY), ([0.0; 3], 0.0));
    for n in spiral(3000) {
        let (least, growth) = speeds(n);
        if least < slowest.1 {
            slowest = (n, least);
        }
        if growth > flutter.1 {
            flutter = (n, growth);
        }
    }
    let least = -climb(slowest.0, 0.02, |n| -speeds(n).0).1;
    let own = &found.slowest;
    // Ours is at least as good, and is what it says.
    let difference = (own.speed_squared - least) / unit;
    assert!(difference < 1e-9, "{own:?}, brute force {least:e} at {:?}", slowest.0);
    let nearest = |n, re: f64, im: f64| {
        let there = brute_speeds(elastic, update, n);
        there.iter().fold(f64::INFINITY, |d, z| d.min((z.0 - re).hypot(z.1 - im))) / unit
    };
    // A double root of nalgebra's is off by the root of rounding.
    assert!(nearest(own.normal, own.speed_squared, 0.0) < 1e-6, "{own:?}");
    worst[0] = worst[0].max(difference.abs());
    let growth = if flutter.1 > 0.0 { climb(flutter.0, 0.02, |n| speeds(n).1).1 } else { 0.0 };
    let own = found.flutter.map_or(0.0, |flutter| flutter.growth);
    let difference = (growth - own) / unit.sqrt();
    assert!(difference < 1e-8, "{:?}, brute force {growth:e} at {:?}", found.flutter, flutter.0);
    if let Some(flutter) = found.flutter {
        let z = flutter.speed_squared;
        let distance = nearest(flutter.normal, z.re, z.im);
        assert!(distance < 1e-6, "{flutter:?} is off by {distance:e}");
    }
    if growth > 0.0 {
        worst[1] = worst[1].max(difference.abs());
    }
    found.flutter.is_some()
}

#[test]
fn every_direction_is_near_a_starting_point() {
    let random = &mut seeded(1);
    let solid = isotropic(random, false);
    let sphere = Sphere::new(&solid.rates()).unwrap();
    let points: Vec<Vector3<f64>> =
        sphere.normals().iter().flat_map(|&n| [Vector3::from(n), -Vector3::from(n)]).collect();
    // The farthest directions have the same distance to three points and none nearer.
    let mut farthest: f64 = 0.0;
    for p in &points {
        if p.z < -0.1 {
            continue;
        }
        let near: Vec<&Vector3<f64>> =
            points.iter().filter(|q| (*q - p).norm() < 0.07 && *q != p).collect();
        let next: Vec<_> = near.iter().filter(|q| (**q - p).norm() < 0.045).collect();
        for (i, q) in next.iter().enumerate() {
            for r in &next[..i] {
                let centre = (**q - p).cross(&(**r - p));
                if centre.norm() < 1e-9 {
                    continue;
                }
                let centre = centre.normalize();
                let centre = if centre.dot(p) < 0.0 { -centre } else { centre };
                let radius = (centre - p).norm();
                if radius < 0.04 && near.iter().all(|s| (centre - **s).norm() >= radius - 1e-9) {
                    farthest = farthest.max(2.0 * (0.5 * radius).asin());
                }
            }
        }
    }
    println!("covering radius {:.4}°, {} points", farthest.to_degrees(), points.len() / 2);
    assert!(farthest > 0.5 * Sphere::COVERING_RADIUS && farthest <= Sphere::COVERING_RADIUS);
    // And without the neighbourhoods.
    for _ in 0..2000 {
        let n = Vector3::from_fn(|_, _| random.within(-1.0, 1.0)).normalize();
        let nearest = points.iter().fold(-1.0, |best: f64, p| best.max(p.dot(&n)));
        assert!(nearest >= Sphere::COVERING_RADIUS.cos());
    }
}

#[test]
fn agrees_with_brute_force_for_yielding_solids() {
    let random = &mut seeded(2);
    let (mut worst, mut flutter, mut total) = ([0.0; 2], 0, 0);
    for case in 0..60 {
        let is_cosserat = case % 2 == 1;
        let mut solid = isotropic(random, is_cosserat);
        // Waves of rotation as fast as pressure waves, or slightly faster: they flutter.
        if case % 4 == 1 {
            let couple = solid.couple().unwrap();
            let fast = couple.beta + 2.0 * couple.gamma;
            let longitudinal = (solid.lambda + 2.0 * solid.mu) / solid.density;
            let microrotation = solid.microrotation.as_mut().unwrap();
            microrotation.inertia = fast / (longitudinal * random.within(0.9, 1.6));
        }
        let mut set = cosserat_mises(random);
        if !is_cosserat {
            set = Mises::drucker_prager(1.0, set.friction, set.dilatancy);
        } else if case % 4 == 1 {
            set.friction = 1.5;
            set.dilatancy = -0.5;
        }
        let condition = set.condition(&random_stress(random, is_cosserat)).unwrap();
        let Ok(update) = update(&solid, &condition) else { continue };
        let elastic = solid.rates();
        let sphere = Sphere::new(&elastic).unwrap();
        flutter += u32::from(compare_with_brute_force(&elastic, &sphere, &update, &mut worst));
        total += 1;
    }
    println!("{flutter} of {total} flutter; worst {worst:?}");
    assert!(flutter >= 3 && total >= 40);
}

/// A solid whose stiffness is a random positive definite matrix.
fn anisotropic(random: &mut Random, is_cosserat: bool) -> RateEquations<3> {
    let mut elastic = isotropic(random, is_cosserat).rates::<3>();
    let size = elastic.stresses();
    let factor = DMatrix::from_fn(size, size, |_, _| random.within(-1.0, 1.0));
    let stiffness = &factor * factor.transpose() + DMatrix::identity(size, size);
    elastic.stiffness = stiffness.map(Rounded::exact);
    elastic
}

#[test]
fn agrees_with_brute_force_for_any_gradients() {
    let random = &mut seeded(3);
    let (mut worst, mut flutter, mut total) = ([0.0; 2], 0, 0);
    for case in 0..80 {
        let is_cosserat = case % 2 == 1;
        let elastic = if case % 4 < 2 {
            isotropic(random, is_cosserat).rates()
        } else {
            anisotropic(random, is_cosserat)
        };
        let size = elastic.stresses();
        let mut gradient = || -> Vec<f64> { (0..size).map(|_| random.within(-1.0, 1.0)).collect() };
        let (normal, other) = (gradient(), gradient());
        let part = random.within(0.0, 1.2);
        let flow: Vec<f64> = normal.iter().zip(&other).map(|(n, o)| n + part * o).collect();
        let Ok(update) = RankOne::new(&elastic, &normal, &flow, 0.0) else { continue };
        let sphere = Sphere::new(&elastic).unwrap();
        flutter += u32::from(compare_with_brute_force(&elastic, &sphere, &update, &mut worst));
        total += 1;
    }
    println!("{flutter} of {total} flutter; worst {worst:?}");
    assert!(flutter >= 20 && total >= 60);
}

#[test]
fn all_speeds_of_a_direction_are_those_of_brute_force() {
    let random = &mut seeded(4);
    let mut worst: f64 = 0.0;
    for case in 0..40 {
        let is_cosserat = case % 2 == 1;
        let elastic = anisotropic(random, is_cosserat);
        let sphere = Sphere::new(&elastic).unwrap();
        for _ in 0..50 {
            let size = elastic.stresses();
            let mut vector =
                || -> Vec<f64> { (0..size).map(|_| random.signed(1e-3, 3.0)).collect() };
            let update = RankOne { image: vector(), covector: vector() };
            let n = Vector3::from_fn(|_, _| random.within(-1.0, 1.0)).normalize().into();
            let own = sphere.speeds_squared(&update, n).unwrap();
            let brute = brute_speeds(&elastic, &update, n);
            let unit = brute.iter().fold(0.0, |size: f64, z| size.max(z.0.hypot(z.1)));
            assert_eq!(own.len(), brute.len());
            for z in own {
                let distance = brute
                    .iter()
                    .fold(f64::INFINITY, |d, other| d.min((z.re - other.0).hypot(z.im - other.1)));
                worst = worst.max(distance / unit);
            }
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-7);
}

#[test]
fn associated_flow_never_flutters() {
    let random = &mut seeded(5);
    for solid in 0..50 {
        let is_cosserat = solid % 2 == 1;
        let solid = isotropic(random, is_cosserat);
        let sphere = Sphere::new(&solid.rates()).unwrap();
        for _ in 0..24 {
            let mut set = cosserat_mises(random);
            set.dilatancy = set.friction;
            set.hardening = random.within(-0.3, 1.0);
            let condition = set.condition(&random_stress(random, is_cosserat)).unwrap();
            let Ok(update) = update(&solid, &condition) else { continue };
            assert_eq!(search(&sphere, &update).flutter, None);
        }
    }
}

#[test]
fn associated_flow_without_softening_has_no_negative_square_of_speed() {
    let random = &mut seeded(6);
    for case in 0..100 {
        let elastic = anisotropic(random, case % 2 == 1);
        let sphere = Sphere::new(&elastic).unwrap();
        let normal: Vec<f64> = (0..elastic.stresses()).map(|_| random.within(-1.0, 1.0)).collect();
        let update = RankOne::new(&elastic, &normal, &normal, 0.0).unwrap();
        let found = search(&sphere, &update);
        assert_eq!(found.flutter, None);
        assert!(found.slowest.speed_squared >= -found.slowest.rounding);
    }
}

#[test]
fn classical_drucker_prager_solids_never_flutter() {
    let random = &mut seeded(7);
    for _ in 0..40 {
        let solid = isotropic(random, false);
        let sphere = Sphere::new(&solid.rates()).unwrap();
        for _ in 0..30 {
            let set = Mises::drucker_prager(1.0, random.within(0.0, 2.0), random.within(-1.0, 2.0));
            let condition = set.condition(&random_stress(random, false)).unwrap();
            let Ok(update) = update(&solid, &condition) else { continue };
            assert_eq!(search(&sphere, &update).flutter, None);
        }
    }
}

#[test]
fn rotation_changes_nothing() {
    let random = &mut seeded(8);
    let (mut worst, mut flutter) = ([0.0_f64; 2], 0);
    for case in 0..80 {
        let is_cosserat = case % 2 == 1;
        let solid = isotropic(random, is_cosserat);
        let sphere = Sphere::new(&solid.rates()).unwrap();
        for _ in 0..10 {
            let part = random.within(0.1, 0.8);
            let [normal, other] = [0, 1].map(|_| random_stress(random, is_cosserat));
            let mix = |x: &Tensor, y: &Tensor| -> Tensor {
                std::array::from_fn(|i| std::array::from_fn(|j| x[i][j] + part * y[i][j]))
            };
            let flow = Stress {
                force: mix(&normal.force, &other.force),
                couple: mix(&normal.couple, &other.couple),
            };
            let q = rotation(random);
            let turn =
                |s: &Stress| Stress { force: turned(&q, &s.force), couple: turned(&q, &s.couple) };
            let of = |normal: Stress, flow: Stress| {
                let condition = ActiveCondition { name: "", normal, flow, hardening: 0.1 };
                update(&solid, &condition).map(|update| search(&sphere, &update))
            };
            let (Ok(first), Ok(second)) = (of(normal, flow), of(turn(&normal), turn(&flow))) else {
                continue;
            };
            let size = solid.speeds().longitudinal.powi(2);
            let difference = (first.slowest.speed_squared - second.slowest.speed_squared) / size;
            worst[0] = worst[0].max(difference.abs());
            assert_eq!(first.flutter.is_some(), second.flutter.is_some());
            if let (Some(first), Some(second)) = (first.flutter, second.flutter) {
                let difference = (first.growth - second.growth) / first.growth;
                worst[1] = worst[1].max(difference.abs());
                flutter += 1;
            }
        }
    }
    println!("{flutter} flutter; worst {worst:?}");
    assert!(worst[0] < 1e-11 && worst[1] < 1e-9 && flutter > 20);
}

#[test]
fn small_caps_of_flutter_are_found_wherever_they_are() {
    let random = &mut seeded(9);
    let mut planted = [0; 3];
    let mut smallest_growth = f64::INFINITY;
    while planted[0] < 25 {
        // In an isotropic solid w_p = (n·α)(n·β)/ρ and w_s = α·β/ρ − w_p, so that the discriminant is
        // known in closed form.
        let solid = isotropic(random, false);
        let sphere = Sphere::new(&solid.rates()).unwrap();
        let [normal, other] = [0, 1].map(|_| random_tensor(random, true));
        let hooke = |t: &Tensor| -> Tensor {
            let trace = t[0][0] + t[1][1] + t[2][2];
            std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    2.0 * solid.mu * t[i][j] + if i == j { solid.lambda * trace } else { 0.0 }
                })
            })
        };
        let flow = |part: f64| -> Tensor {
            std::array::from_fn(|i| std::array::from_fn(|j| normal[i][j] + part * other[i][j]))
        };
        let covector = hooke(&normal);
        // −(discriminant), in units of (c_p²)².
        let excess = |part: f64, n: [f64; 3]| {
            let image = hooke(&flow(part));
            let mut response = 0.0;
            let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
            for i in 0..3 {
                for j in 0..3 {
                    response += normal[i][j] * image[i][j];
                    a[i] += image[i][j] * n[j];
                    b[i] += covector[i][j] * n[j];
                }
            }
            let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
            let unit = solid.lambda + 2.0 * solid.mu;
            let fast = dot(n, a) * dot(n, b) / (response * unit);
            let slow = dot(a, b) / (response * unit) - fast;
            let difference = 1.0 - fast - solid.mu / unit + slow;
            if response > 0.0 { -(difference * difference + 4.0 * fast * slow) } else { -1.0 }
        };
        let most = |part: f64| {
            let start = spiral(1000).fold(([0.0; 3], -1.0), |best: ([f64; 3], f64), n| {
                let value = excess(part, n);
                if value > best.1 { (n, value) } else { best }
            });
            climb(start.0, 0.05, |n| excess(part, n))
        };
        // No flutter with `none`, flutter with `some`.
        let (mut none, mut some) = (0.0, 1.0);
        let mut peak = most(some);
        if peak.1 <= 1e-3 {
            continue;
        }
        // The cap that is left as the flow comes nearer to the associated one, and its radius.
        let radius = |part: f64, centre: [f64; 3]| {
            let centre = Vector3::from(centre);
            let first = centre.cross(&Vector3::new(0.3, -0.5, 0.8)).normalize();
            let second = centre.cross(&first);
            (0..16).fold(0.0, |largest: f64, i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::PI / 8.0).sin_cos();
                let at = |r: f64| (centre + (first * cos + second * sin) * r).normalize().into();
                let (mut inside, mut outside) = (0.0, 1.0);
                while outside - inside > 1e-6 {
                    let middle = 0.5 * (inside + outside);
                    if excess(part, at(middle)) > 0.0 { inside = middle } else { outside = middle }
                }
                largest.max(inside)
            })
        };
        for (target, count) in [1.0_f64, 0.3, 0.1].iter().zip(&mut planted) {
            for _ in 0..60 {
                let part = 0.5 * (none + some);
                let next = most(part);
                if next.1 > 0.0 && radius(part, next.0) > target.to_radians() {
                    (some, peak) = (part, next);
                } else {
                    none = part;
                }
                if some - none < 1e-14 {
                    break;
                }
            }
            assert!(peak.1 > 0.0);
            for _ in 0..8 {
                let q = rotation(random);
                let symmetric = |t: Tensor| Stress { force: turned(&q, &t), couple: [[0.0; 3]; 3] };
                let condition = ActiveCondition {
                    name: "",
                    normal: symmetric(normal),
                    flow: symmetric(flow(some)),
                    hardening: 0.0,
                };
                let found = search(&sphere, &update(&solid, &condition).unwrap());
                let Some(flutter) = found.flutter else {
                    panic!("missed: a cap of {target}°, depth {:e}, {solid:?}", peak.1)
                };
                smallest_growth = smallest_growth.min(flutter.growth / solid.speeds().longitudinal);
            }
            *count += 1;
            none = 0.0;
        }
    }
    println!("{planted:?} caps of 1°, 0.3°, 0.1°; growth down to {smallest_growth:e} c_p");
}

#[test]
fn shear_bands_start_as_rudnicki_and_rice_say() {
    let random = &mut seeded(10);
    let (mut worst, mut count) = ([0.0_f64; 2], 0);
    while count < 120 {
        let poisson: f64 = random.within(-0.1, 0.45);
        let shear = random.decades(0.1, 10.0);
        let solid = Isotropic {
            lambda: 2.0 * shear * poisson / (1.0 - 2.0 * poisson),
            mu: shear,
            density: random.decades(0.3, 3.0),
            microrotation: None,
        };
        let (friction, dilatancy) = (random.within(0.0, 1.2), random.within(-0.3, 1.2));
        // Principal deviators over τ̄ in descending order, at a Lode angle in (0°, 60°).
        let lode = random.within(0.02, 0.98) * std::f64::consts::FRAC_PI_3;
        let deviators = [0.0, 2.0, 4.0].map(|third: f64| {
            2.0 / 3.0_f64.sqrt() * (lode - third * std::f64::consts::FRAC_PI_3).cos()
        });
        let [largest, middle, smallest] = [deviators[0], deviators[1], deviators[2]];
        let sum = (dilatancy + friction) / 3.0;
        let xi = (1.0 + poisson) * sum - middle * (1.0 - poisson);
        if xi - smallest < 0.05 || largest - xi < 0.05 {
            continue;
        }
        let expected = shear
            * ((1.0 + poisson) / (9.0 * (1.0 - poisson)) * (dilatancy - friction).powi(2)
                - 0.5 * (1.0 + poisson) * (middle + sum).powi(2));
        let angle = ((xi - smallest) / (largest - xi)).sqrt().atan();
        let q = rotation(random);
        let (scale, pressure) = (random.decades(0.1, 10.0), random.within(-1.0, 1.0));
        let mut principal = [[0.0; 3]; 3];
        for i in 0..3 {
            principal[i][i] = scale * deviators[i] + pressure;
        }
        let stress = Stress { force: turned(&q, &principal), couple: [[0.0; 3]; 3] };
        let sphere = Sphere::new(&solid.rates()).unwrap();
        let with = |hardening: f64| {
            let set = Mises { hardening, ..Mises::drucker_prager(1.0, friction, dilatancy) };
            update(&solid, &set.condition(&stress).unwrap()).map(|update| search(&sphere, &update))
        };
        let bulk = solid.lambda + 2.0 / 3.0 * shear;
        let least = -shear - bulk * friction * dilatancy;
        let (mut below, mut above) = (least + 1e-3 * shear, expected.max(0.0) + shear);
        assert!(with(above).unwrap().slowest.speed_squared > 0.0);
        let mut onset = None;
        while above - below > 1e-13 * shear {
            let hardening = 0.5 * (below + above);
            let slowest = with(hardening).unwrap().slowest;
            if slowest.speed_squared <= 0.0 {
                below = hardening;
                onset = Some(slowest.normal);
            } else {
                above = hardening;
            }
            if hardening == below && hardening == above {
                break;
            }
        }
        let normal = onset.unwrap();
        let along = |axis: usize| (0..3).map(|i| q[i][axis] * normal[i]).sum::<f64>().abs();
        // θ₀ is the angle from the direction of the least principal stress to the band's normal.
        let found = along(0).atan2(along(2));
        worst[0] = worst[0].max((below - expected).abs() / shear);
        worst[1] = worst[1].max((found - angle).abs()).max(along(1));
        count += 1;
    }
    println!("worst h_cr {:e} G, angle {:e} rad over {count}", worst[0], worst[1]);
    assert!(worst[0] < 1e-10 && worst[1] < 1e-6);
}

#[test]
fn threads_and_workspaces_change_no_bit() {
    let random = &mut seeded(11);
    let elastic = anisotropic(random, true);
    let sphere = Sphere::new(&elastic).unwrap();
    let updates: Vec<RankOne> = (0..16)
        .filter_map(|_| {
            let mut vector = || -> Vec<f64> {
                (0..elastic.stresses()).map(|_| random.within(-1.0, 1.0)).collect()
            };
            let (normal, mut flow) = (vector(), vector());
            flow.iter_mut().zip(&normal).for_each(|(f, n)| *f += n);
            RankOne::new(&elastic, &normal, &flow, 0.0).ok()
        })
        .collect();
    assert!(updates.len() > 8);
    let mut workspace = sphere.workspace();
    let one: Vec<Extremes> =
        updates.iter().map(|update| sphere.search(update, &mut workspace).unwrap()).collect();
    let many: Vec<Extremes> = std::thread::scope(|scope| {
        let threads: Vec<_> =
            updates.iter().map(|update| scope.spawn(|| search(&sphere, update))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let bits = |list: &[Extremes]| format!("{list:?}");
    assert_eq!(bits(&one), bits(&many));
}

#[test]
fn what_cannot_be_searched_is_refused() {
    let random = &mut seeded(12);
    let mut elastic = isotropic(random, false).rates::<3>();
    let normal = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(
        RankOne::new(&elastic, &normal[..5], &normal, 0.0),
        Err(SphereError::Mismatch { given: 5, needed: 6 })
    );
    let backwards = normal.map(|x| -x);
    let refused = RankOne::new(&elastic, &normal, &backwards, 0.0);
    assert!(matches!(refused, Err(SphereError::NoResponse(response)) if response < 0.0));
    let sphere = Sphere::new(&elastic).unwrap();
    let mut update = RankOne::new(&elastic, &normal, &normal, 0.0).unwrap();
    update.image[0] = f64::NAN;
    let mut workspace = sphere.workspace();
    assert_eq!(sphere.search(&update, &mut workspace), Err(SphereError::NotFinite));
    update.image.clear();
    let refused = sphere.search(&update, &mut workspace);
    assert_eq!(refused, Err(SphereError::Mismatch { given: 0, needed: 6 }));
    elastic.stiffness[(0, 0)] = Rounded::exact(-1.0);
    assert!(matches!(Sphere::new(&elastic), Err(SphereError::NotElastic { .. })));
    elastic.stiffness[(0, 0)] = Rounded::exact(f64::INFINITY);
    assert!(matches!(Sphere::new(&elastic), Err(SphereError::NotFinite)));
}

#[test]
fn spins_without_couple_stress_carry_no_waves() {
    let microrotation = Some(Microrotation { alpha: 0.3, inertia: 1.0, couple: None });
    let solid = Isotropic { lambda: 1.0, mu: 1.0, density: 1.0, microrotation };
    let sphere = Sphere::new(&solid.rates()).unwrap();
    let none = RankOne { image: vec![0.0; 9], covector: vec![0.0; 9] };
    let found = search(&sphere, &none);
    assert!((found.slowest.speed_squared - 1.3).abs() < 1e-14);
    assert_eq!(found.growth(), 0.0);
}
