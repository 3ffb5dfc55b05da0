//! The starting points of the search cover all directions.

use super::random_solids::random_isotropic;
use crate::support::states::seeded_generator;
use nalgebra::Vector3;
use wellposed_analysis::acoustic_tensor3::AcousticTensor3;

#[test]
fn every_direction_is_near_a_starting_point() {
    let random = &mut seeded_generator(1);
    let solid = random_isotropic(random, false);
    let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
    let points: Vec<Vector3<f64>> =
        tensor.normals().iter().flat_map(|&n| [Vector3::from(n), -Vector3::from(n)]).collect();
    // The farthest directions are circumcentres of three points without a nearer point.
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
    assert!(
        farthest > 0.5 * AcousticTensor3::COVERING_RADIUS
            && farthest <= AcousticTensor3::COVERING_RADIUS
    );
    // Random directions, independent of the neighbourhoods.
    for _ in 0..2000 {
        let n = Vector3::from_fn(|_, _| random.uniform(-1.0, 1.0)).normalize();
        let nearest = points.iter().fold(-1.0, |best: f64, p| best.max(p.dot(&n)));
        assert!(nearest >= AcousticTensor3::COVERING_RADIUS.cos());
    }
}
