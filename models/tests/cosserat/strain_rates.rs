//! Strain rates due to velocity gradients, spins and spin gradients.

use crate::cosserat::random_solids::random_solid;
use crate::cosserat::tensors::{conjugate_strain, random_tensor};
use crate::support::RandomNumbers;
use nalgebra::{DVector, Matrix3};
use wellposed_models::solid::stress::StressComponent::Force;
use wellposed_models::solid::symbol::{Velocity, plane_layout};

/// Permutation symbol εᵢⱼₖ.
fn permutation_symbol(i: usize, j: usize, k: usize) -> f64 {
    let (i, j, k) = (i as f64, j as f64, k as f64);
    (j - i) * (k - j) * (k - i) / 2.0
}

/// The strain operators give Λ̇ᵢⱼ = ∂ⱼvᵢ + εᵢⱼₖωₖ and Ṁᵢⱼ = ∂ⱼωᵢ for random velocity gradients, spins and spin
/// gradients, and zero for a rigid rotation vᵢ = εᵢₖⱼωₖxⱼ.
#[test]
fn strain_rates_follow_from_velocity_gradients_and_spins() {
    let mut random = RandomNumbers::new(4);
    for number in 0..60 {
        let solid = random_solid(&mut random, number % 3);
        let layout = solid.layout::<3>();
        let rates = solid.rates::<3>();
        let spin: [f64; 3] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
        let strain_rate = |velocity: &Matrix3<f64>, curvature: &Matrix3<f64>| {
            let mut rate = DVector::zeros(rates.stress_count());
            for axis in 0..3 {
                let along = layout.velocities.iter().map(|v| match v {
                    Velocity::Translation(i) => velocity[(*i, axis)],
                    Velocity::Spin(k) => curvature[(*k, axis)],
                });
                let along = DVector::from_iterator(rates.velocity_count(), along);
                rate += &rates.gradient[axis] * along;
            }
            let own = layout.velocities.iter().map(|v| match v {
                Velocity::Translation(_) => 0.3, // arbitrary: uniform translations cause no strain
                Velocity::Spin(k) => spin[*k],
            });
            rate + &rates.rotation * DVector::from_iterator(rates.velocity_count(), own)
        };
        let rigid =
            Matrix3::from_fn(|i, j| (0..3).map(|k| permutation_symbol(i, k, j) * spin[k]).sum());
        assert!(strain_rate(&rigid, &Matrix3::zeros()).amax() <= 1e-15);

        let (velocity, curvature) = (random_tensor(&mut random), random_tensor(&mut random));
        let strain = Matrix3::from_fn(|i, j| {
            velocity[(i, j)] + (0..3).map(|k| permutation_symbol(i, j, k) * spin[k]).sum::<f64>()
        });
        let strain = if number % 3 == 0 { velocity } else { strain };
        let own = strain_rate(&velocity, &curvature);
        for (component, own) in layout.stresses.iter().zip(own.iter()) {
            let expected = conjugate_strain(*component, &strain, &curvature);
            assert!((own - expected).abs() <= 1e-15, "{component:?}: {own} {expected}");
        }
    }
    // In plane strain Λ̇₂₁ = ∂₁v₂ − ω₃.
    let layout = plane_layout(random_solid(&mut random, 2).theory());
    let place = layout.stresses.iter().position(|c| *c == Force(1, 0)).unwrap();
    assert_eq!(layout.rotation()[(place, 2)], -1.0);
    assert_eq!(layout.gradient(0)[(place, 1)], 1.0);
}
