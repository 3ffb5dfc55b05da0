//! Strain rates due to velocity gradients, spins and spin gradients.

use crate::random_solids::solid;
use crate::support::Random;
use crate::tensors::{conjugate, tensor};
use nalgebra::{DVector, Matrix3};
use wellposed_models::solid::stress::Component::Force;
use wellposed_models::solid::symbol::{Velocity, plane};

/// Permutation symbol εᵢⱼₖ.
fn permutation(i: usize, j: usize, k: usize) -> f64 {
    let (i, j, k) = (i as f64, j as f64, k as f64);
    (j - i) * (k - j) * (k - i) / 2.0
}

/// The strain operators give Λ̇ᵢⱼ = ∂ⱼvᵢ + εᵢⱼₖωₖ and Ṁᵢⱼ = ∂ⱼωᵢ for random velocity gradients, spins and spin
/// gradients, and zero for a rigid rotation vᵢ = εᵢₖⱼωₖxⱼ.
#[test]
fn strain_rates() {
    let mut random = Random::new(4);
    for number in 0..60 {
        let solid = solid(&mut random, number % 3);
        let layout = solid.layout::<3>();
        let rates = solid.rates::<3>();
        let spin: [f64; 3] = std::array::from_fn(|_| random.within(-1.0, 1.0));
        let rate_of = |velocity: &Matrix3<f64>, bend: &Matrix3<f64>| {
            let mut rate = DVector::zeros(rates.stresses());
            for axis in 0..3 {
                let along = layout.velocities.iter().map(|v| match v {
                    Velocity::Translation(i) => velocity[(*i, axis)],
                    Velocity::Spin(k) => bend[(*k, axis)],
                });
                let along = DVector::from_iterator(rates.velocities(), along);
                rate += &rates.gradient[axis] * along;
            }
            let own = layout.velocities.iter().map(|v| match v {
                Velocity::Translation(_) => 0.3, // arbitrary: uniform translations cause no strain
                Velocity::Spin(k) => spin[*k],
            });
            rate + &rates.rotation * DVector::from_iterator(rates.velocities(), own)
        };
        let rigid = Matrix3::from_fn(|i, j| (0..3).map(|k| permutation(i, k, j) * spin[k]).sum());
        assert!(rate_of(&rigid, &Matrix3::zeros()).amax() <= 1e-15);

        let (velocity, bend) = (tensor(&mut random), tensor(&mut random));
        let strain = Matrix3::from_fn(|i, j| {
            velocity[(i, j)] + (0..3).map(|k| permutation(i, j, k) * spin[k]).sum::<f64>()
        });
        let strain = if number % 3 == 0 { velocity } else { strain };
        let own = rate_of(&velocity, &bend);
        for (component, own) in layout.stresses.iter().zip(own.iter()) {
            let expected = conjugate(*component, &strain, &bend);
            assert!((own - expected).abs() <= 1e-15, "{component:?}: {own} {expected}");
        }
    }
    // In plane strain Λ̇₂₁ = ∂₁v₂ − ω₃, and σ₂₁ − σ₁₂ is the source of spin.
    let layout = plane(solid(&mut random, 2).theory());
    let place = layout.stresses.iter().position(|c| *c == Force(1, 0)).unwrap();
    assert_eq!(layout.rotation()[(place, 2)], -1.0);
    assert_eq!(layout.gradient(0)[(place, 1)], 1.0);
}
