//! Errata of the linearised equations: eqs (83), (86), (87).

use crate::comparison::Comparison;
use crate::support::{Random, Real, Wide, wide};
use crate::system::{Incompressible, STATES};

/// Eq. (83): c₅₅ is printed as −2 Q_D cos 2Δ; the derivative of the rotation equation with respect to ψ is
/// −4 Q_D cos 2Δ.
#[test]
fn eq_83_c55() {
    let mut random = Random::new(1);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let unit = wide(system.state.shear_rate) * system.coaxiality();
        let (printed, corrected) = (-(unit * wide(2.0)), -(unit * wide(4.0)));
        let truth = system.c[4][4];
        comparison.add(truth.into(), printed.into(), corrected.into(), truth.value().abs());
    }
    comparison.finish();
}

/// Eq. (83): c₃₁ and c₃₂ are printed as ρI ∂ⱼΩ; the advection of the prescribed moment of inertia adds ρΩ ∂ⱼI.
#[test]
fn eq_83_c31_c32() {
    let mut random = Random::new(2);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        for j in 0..2 {
            let printed = system.density() * system.inertia() * wide(system.state.spin_gradient[j]);
            let inertia = wide(system.state.inertia_gradient[j]);
            let corrected = printed + system.density() * system.spin * inertia;
            let truth = system.c[2][j];
            comparison.add(truth.into(), printed.into(), corrected.into(), 0.0);
        }
    }
    comparison.finish();
}

/// Eq. (86): B²₅₁ is printed as sin φ; the correct value is sin φ + cos 2Ψ.
#[test]
fn eq_86_b51() {
    let mut random = Random::new(3);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let angle = wide(system.state.stress_angle);
        let printed = system.phi().sin();
        let corrected = printed + (angle + angle).cos();
        comparison.add(system.b[1][4][0].into(), printed.into(), corrected.into(), 1.0);
    }
    comparison.finish();
}

/// Eq. (87): Q_Σ is printed with 4Σ₁₂², which is valid only for a symmetric stress. Reference: the deviator from which
/// a stress with r = ±m is constructed.
#[test]
fn eq_87_deviator() {
    let mut random = Random::new(4);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let (p, r) = (wide(system.state.pressure), wide(system.flow.stress.rotational));
        let angle = wide(system.state.stress_angle);
        let (s, c) = (angle + angle).sin_cos();
        let q = system.q;
        let stress = [[-p + q * c, r + q * s], [-r + q * s, -p - q * c]];
        let normal = stress[0][0] - stress[1][1];
        let deviator = |shear: Wide| (normal * normal + shear * shear).sqrt() * wide(0.5);
        let printed = deviator(stress[0][1] + stress[0][1]);
        let corrected = deviator(stress[0][1] + stress[1][0]);
        comparison.add(q.into(), printed.into(), corrected.into(), 0.0);
        // The crate's stress tensor has the same deviator.
        let tensor = system.flow.stress.tensor();
        let own = 0.5 * (tensor[0][0] - tensor[1][1]).hypot(tensor[0][1] + tensor[1][0]);
        assert!((own / q.value() - 1.0).abs() < 1e-14);
    }
    comparison.finish();
}
