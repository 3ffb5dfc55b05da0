//! Flutter: absent for associated flow; small caps of flutter are found in every orientation.

use super::directions::{fibonacci_directions, maximise_by_pattern_search};
use super::random_solids::{
    Tensor, random_anisotropic, random_cosserat_mises, random_isotropic, random_rotation,
    random_stress, random_tensor, rank_one_update, rotate_tensor, search_extremes,
};
use crate::support::states::seeded_generator;
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::yield_set::parameters::{ActiveCondition, Mises};
use nalgebra::Vector3;
use wellposed_analysis::acoustic_tensor3::{AcousticTensor3, RankOneUpdate};

#[test]
fn associated_flow_never_flutters() {
    check_associated_flow(8);
}

/// Checks `solids` random solids, each with 24 yield sets.
fn check_associated_flow(solids: usize) {
    let random = &mut seeded_generator(5);
    for solid in 0..solids {
        let is_cosserat = solid % 2 == 1;
        let solid = random_isotropic(random, is_cosserat);
        let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
        for _ in 0..24 {
            let mut set = random_cosserat_mises(random);
            set.dilatancy = set.friction;
            set.hardening = random.uniform(-0.3, 1.0);
            let condition = set.condition(&random_stress(random, is_cosserat)).unwrap();
            let Ok(update) = rank_one_update(&solid, &condition) else { continue };
            assert_eq!(search_extremes(&tensor, &update).flutter, None);
        }
    }
}

#[test]
fn associated_flow_without_softening_has_no_negative_squared_speed() {
    check_associated_flow_without_softening(16);
}

/// Checks `solids` random anisotropic solids.
fn check_associated_flow_without_softening(solids: usize) {
    let random = &mut seeded_generator(6);
    for case in 0..solids {
        let elastic = random_anisotropic(random, case % 2 == 1);
        let tensor = AcousticTensor3::new(&elastic).unwrap();
        let normal: Vec<f64> =
            (0..elastic.stress_count()).map(|_| random.uniform(-1.0, 1.0)).collect();
        let update = RankOneUpdate::new(&elastic, &normal, &normal, 0.0).unwrap();
        let found = search_extremes(&tensor, &update);
        assert_eq!(found.flutter, None);
        assert!(found.slowest.squared_speed >= -found.slowest.rounding);
    }
}

#[test]
fn classical_drucker_prager_solids_never_flutter() {
    check_drucker_prager_solids(6);
}

#[test]
#[ignore = "takes half a minute"]
fn many_solids_do_not_flutter() {
    check_associated_flow(50);
    check_associated_flow_without_softening(100);
    check_drucker_prager_solids(40);
    check_small_caps(25);
}

/// Checks `solids` random solids, each with 30 yield sets.
fn check_drucker_prager_solids(solids: usize) {
    let random = &mut seeded_generator(7);
    for _ in 0..solids {
        let solid = random_isotropic(random, false);
        let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
        for _ in 0..30 {
            let set =
                Mises::new_drucker_prager(1.0, random.uniform(0.0, 2.0), random.uniform(-1.0, 2.0));
            let condition = set.condition(&random_stress(random, false)).unwrap();
            let Ok(update) = rank_one_update(&solid, &condition) else { continue };
            assert_eq!(search_extremes(&tensor, &update).flutter, None);
        }
    }
}

/// A classical isotropic solid with the yield normal `normal` and the flow direction `normal` plus a multiple (argument
/// `flow_multiple`) of `second_gradient`; `normal_image` is D applied to the normal. For a wave normal n the update of
/// the acoustic tensor is −αβᵀ/ρ; with w_p = (n·α)(n·β)/ρ and w_s = α·β/ρ − w_p its discriminant is known in closed
/// form.
struct FlutterCap<'a> {
    solid: &'a Isotropic,
    normal: Tensor,
    second_gradient: Tensor,
    normal_image: Tensor,
}

impl<'a> FlutterCap<'a> {
    fn new(solid: &'a Isotropic, [normal, other]: [Tensor; 2]) -> Self {
        Self {
            solid,
            normal,
            second_gradient: other,
            normal_image: apply_hookes_law(solid, &normal),
        }
    }

    fn flow_direction(&self, flow_multiple: f64) -> Tensor {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| self.normal[i][j] + flow_multiple * self.second_gradient[i][j])
        })
    }

    /// Negative discriminant −[(c_p² − w_p − c_s² + w_s)² + 4 w_p w_s], in units of c_p⁴ with the pressure-wave speed
    /// c_p and the shear-wave speed c_s; positive in flutter, −1 without a rate response.
    fn negative_discriminant(&self, flow_multiple: f64, n: [f64; 3]) -> f64 {
        let image = apply_hookes_law(self.solid, &self.flow_direction(flow_multiple));
        let mut response = 0.0;
        let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            for j in 0..3 {
                response += self.normal[i][j] * image[i][j];
                a[i] += image[i][j] * n[j];
                b[i] += self.normal_image[i][j] * n[j];
            }
        }
        let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        let unit = self.solid.lambda + 2.0 * self.solid.mu;
        let fast = dot(n, a) * dot(n, b) / (response * unit);
        let slow = dot(a, b) / (response * unit) - fast;
        let difference = 1.0 - fast - self.solid.mu / unit + slow;
        if response > 0.0 { -(difference * difference + 4.0 * fast * slow) } else { -1.0 }
    }

    /// Direction in which the negative discriminant is largest, and its value there.
    fn max_negative_discriminant(&self, flow_multiple: f64) -> ([f64; 3], f64) {
        let start =
            fibonacci_directions(1000).fold(([0.0; 3], -1.0), |best: ([f64; 3], f64), n| {
                let value = self.negative_discriminant(flow_multiple, n);
                if value > best.1 { (n, value) } else { best }
            });
        maximise_by_pattern_search(start.0, 0.05, |n| self.negative_discriminant(flow_multiple, n))
    }

    /// Largest radius of the cap of flutter around `centre`, rad, over 16 directions.
    fn max_cap_radius(&self, flow_multiple: f64, centre: [f64; 3]) -> f64 {
        let centre = Vector3::from(centre);
        let first = centre.cross(&Vector3::new(0.3, -0.5, 0.8)).normalize();
        let second = centre.cross(&first);
        (0..16).fold(0.0, |largest: f64, i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::PI / 8.0).sin_cos();
            let at = |r: f64| (centre + (first * cos + second * sin) * r).normalize().into();
            let (mut inside, mut outside) = (0.0, 1.0);
            while outside - inside > 1e-6 {
                let middle = 0.5 * (inside + outside);
                if self.negative_discriminant(flow_multiple, at(middle)) > 0.0 {
                    inside = middle
                } else {
                    outside = middle
                }
            }
            largest.max(inside)
        })
    }
}

/// Hooke's law λ tr(t) δ + 2μ t.
fn apply_hookes_law(solid: &Isotropic, t: &Tensor) -> Tensor {
    let trace = t[0][0] + t[1][1] + t[2][2];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            2.0 * solid.mu * t[i][j] + if i == j { solid.lambda * trace } else { 0.0 }
        })
    })
}

#[test]
fn small_caps_of_flutter_are_found_in_every_orientation() {
    check_small_caps(8);
}

/// Checks `count` random caps of each radius, in eight orientations each.
fn check_small_caps(count: usize) {
    let random = &mut seeded_generator(9);
    let mut counts = [0; 3];
    let mut smallest_growth = f64::INFINITY;
    while counts[0] < count {
        let solid = random_isotropic(random, false);
        let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
        let cap = FlutterCap::new(&solid, [0, 1].map(|_| random_tensor(random, true)));
        // Multiples of the second gradient: no flutter with `none`, flutter with `some`.
        let (mut none, mut some) = (0.0, 1.0);
        let mut peak = cap.max_negative_discriminant(some);
        if peak.1 <= 1e-3 {
            continue;
        }
        // Shrink the cap to the target radius by approaching associated flow.
        for (target, own_count) in [1.0_f64, 0.3, 0.1].iter().zip(&mut counts) {
            for _ in 0..60 {
                let flow_multiple = 0.5 * (none + some);
                let next = cap.max_negative_discriminant(flow_multiple);
                if next.1 > 0.0 && cap.max_cap_radius(flow_multiple, next.0) > target.to_radians() {
                    (some, peak) = (flow_multiple, next);
                } else {
                    none = flow_multiple;
                }
                if some - none < 1e-14 {
                    break;
                }
            }
            assert!(peak.1 > 0.0);
            for _ in 0..8 {
                let q = random_rotation(random);
                let symmetric =
                    |t: Tensor| Stress { force: rotate_tensor(&q, &t), couple: [[0.0; 3]; 3] };
                let condition = ActiveCondition {
                    name: "",
                    normal: symmetric(cap.normal),
                    flow_direction: symmetric(cap.flow_direction(some)),
                    hardening: 0.0,
                };
                let found = search_extremes(&tensor, &rank_one_update(&solid, &condition).unwrap());
                let Some(flutter) = found.flutter else {
                    panic!("missed: a cap of {target}°, depth {:e}, {solid:?}", peak.1)
                };
                smallest_growth =
                    smallest_growth.min(flutter.max_imaginary_speed / solid.speeds().longitudinal);
            }
            *own_count += 1;
            none = 0.0;
        }
    }
    println!("{counts:?} caps of 1°, 0.3°, 0.1°; growth down to {smallest_growth:e} c_p");
}
