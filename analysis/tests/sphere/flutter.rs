//! Flutter: absent for associated flow; small caps of flutter are found in every orientation.

use crate::directions::{maximise_by_pattern_search, spiral};
use crate::random_solids::{
    Tensor, anisotropic, cosserat_mises, isotropic, random_stress, random_tensor, rotation, search,
    turned, update,
};
use crate::support::states::seeded;
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::yield_set::parameters::{ActiveCondition, Mises};
use nalgebra::Vector3;
use wellposed_analysis::sphere::{AcousticTensor3, RankOne};

#[test]
fn associated_flow_never_flutters() {
    let random = &mut seeded(5);
    for solid in 0..50 {
        let is_cosserat = solid % 2 == 1;
        let solid = isotropic(random, is_cosserat);
        let sphere = AcousticTensor3::new(&solid.rates()).unwrap();
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
        let sphere = AcousticTensor3::new(&elastic).unwrap();
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
        let sphere = AcousticTensor3::new(&solid.rates()).unwrap();
        for _ in 0..30 {
            let set = Mises::drucker_prager(1.0, random.within(0.0, 2.0), random.within(-1.0, 2.0));
            let condition = set.condition(&random_stress(random, false)).unwrap();
            let Ok(update) = update(&solid, &condition) else { continue };
            assert_eq!(search(&sphere, &update).flutter, None);
        }
    }
}

/// Classical isotropic solid with two symmetric gradients; the flow direction is the first plus a multiple of the
/// second. With w_p = (n·α)(n·β)/ρ and w_s = α·β/ρ − w_p the discriminant is known in closed form.
struct Cap<'a> {
    solid: &'a Isotropic,
    normal: Tensor,
    other: Tensor,
    covector: Tensor,
}

impl<'a> Cap<'a> {
    fn new(solid: &'a Isotropic, [normal, other]: [Tensor; 2]) -> Self {
        Self { solid, normal, other, covector: hooke(solid, &normal) }
    }

    fn flow(&self, part: f64) -> Tensor {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| self.normal[i][j] + part * self.other[i][j])
        })
    }

    /// Negative discriminant in units of (c_p²)², positive in flutter; −1 without a rate response.
    fn excess(&self, part: f64, n: [f64; 3]) -> f64 {
        let image = hooke(self.solid, &self.flow(part));
        let mut response = 0.0;
        let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            for j in 0..3 {
                response += self.normal[i][j] * image[i][j];
                a[i] += image[i][j] * n[j];
                b[i] += self.covector[i][j] * n[j];
            }
        }
        let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        let unit = self.solid.lambda + 2.0 * self.solid.mu;
        let fast = dot(n, a) * dot(n, b) / (response * unit);
        let slow = dot(a, b) / (response * unit) - fast;
        let difference = 1.0 - fast - self.solid.mu / unit + slow;
        if response > 0.0 { -(difference * difference + 4.0 * fast * slow) } else { -1.0 }
    }

    /// Direction of the largest excess, and its value.
    fn most(&self, part: f64) -> ([f64; 3], f64) {
        let start = spiral(1000).fold(([0.0; 3], -1.0), |best: ([f64; 3], f64), n| {
            let value = self.excess(part, n);
            if value > best.1 { (n, value) } else { best }
        });
        maximise_by_pattern_search(start.0, 0.05, |n| self.excess(part, n))
    }

    /// Radius of the cap of flutter around `centre`, rad.
    fn radius(&self, part: f64, centre: [f64; 3]) -> f64 {
        let centre = Vector3::from(centre);
        let first = centre.cross(&Vector3::new(0.3, -0.5, 0.8)).normalize();
        let second = centre.cross(&first);
        (0..16).fold(0.0, |largest: f64, i| {
            let (sin, cos) = (f64::from(i) * std::f64::consts::PI / 8.0).sin_cos();
            let at = |r: f64| (centre + (first * cos + second * sin) * r).normalize().into();
            let (mut inside, mut outside) = (0.0, 1.0);
            while outside - inside > 1e-6 {
                let middle = 0.5 * (inside + outside);
                if self.excess(part, at(middle)) > 0.0 { inside = middle } else { outside = middle }
            }
            largest.max(inside)
        })
    }
}

/// Hooke's law λ tr(t) δ + 2μ t.
fn hooke(solid: &Isotropic, t: &Tensor) -> Tensor {
    let trace = t[0][0] + t[1][1] + t[2][2];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            2.0 * solid.mu * t[i][j] + if i == j { solid.lambda * trace } else { 0.0 }
        })
    })
}

#[test]
fn small_caps_of_flutter_are_found_wherever_they_are() {
    let random = &mut seeded(9);
    let mut planted = [0; 3];
    let mut smallest_growth = f64::INFINITY;
    while planted[0] < 25 {
        let solid = isotropic(random, false);
        let sphere = AcousticTensor3::new(&solid.rates()).unwrap();
        let cap = Cap::new(&solid, [0, 1].map(|_| random_tensor(random, true)));
        // Multiples of the second gradient: no flutter with `none`, flutter with `some`.
        let (mut none, mut some) = (0.0, 1.0);
        let mut peak = cap.most(some);
        if peak.1 <= 1e-3 {
            continue;
        }
        // Shrink the cap to the target radius by approaching associated flow.
        for (target, count) in [1.0_f64, 0.3, 0.1].iter().zip(&mut planted) {
            for _ in 0..60 {
                let part = 0.5 * (none + some);
                let next = cap.most(part);
                if next.1 > 0.0 && cap.radius(part, next.0) > target.to_radians() {
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
                    normal: symmetric(cap.normal),
                    flow: symmetric(cap.flow(some)),
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
