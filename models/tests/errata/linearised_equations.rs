//! Errata of the linearised equations in Harris & Grekova (2005): eqs (83), (86), (87).

use crate::errata::system::compare_random_flows;
use crate::support::{DifferentiableReal, DoubleDouble, dd};

/// Eq. (83): c₅₅ is printed as −2 Q_D cos 2Δ; the derivative of the rotation equation with respect to ψ is
/// −4 Q_D cos 2Δ.
#[test]
fn eq_83_misprints_c55() {
    compare_random_flows(1, |_, system, comparison| {
        let unit = dd(system.state.shear_rate) * system.cos_twice_noncoaxiality();
        let (printed, corrected) = (-(unit * dd(2.0)), -(unit * dd(4.0)));
        let truth = system.c[4][4];
        comparison.add_case(truth.into(), printed.into(), corrected.into(), truth.to_f64().abs());
    });
}

/// Eq. (83): c₃₁ and c₃₂ are printed as ρI ∂ⱼΩ; the advection of the prescribed moment of inertia adds ρΩ ∂ⱼI.
#[test]
fn eq_83_misprints_c31_and_c32() {
    compare_random_flows(2, |_, system, comparison| {
        for j in 0..2 {
            let printed = system.density() * system.inertia() * dd(system.state.spin_gradient[j]);
            let inertia = dd(system.state.inertia_gradient[j]);
            let corrected = printed + system.density() * system.spin * inertia;
            let truth = system.c[2][j];
            comparison.add_case(truth.into(), printed.into(), corrected.into(), 0.0);
        }
    });
}

/// Eq. (86): B²₅₁ is printed as sin φ; the correct value is sin φ + cos 2Ψ.
#[test]
fn eq_86_misprints_b51() {
    compare_random_flows(3, |_, system, comparison| {
        let angle = dd(system.state.stress_angle);
        let printed = system.friction_angle().sin();
        let corrected = printed + (angle + angle).cos();
        comparison.add_case(system.b[1][4][0].into(), printed.into(), corrected.into(), 1.0);
    });
}

/// Eq. (87): the deviatoric stress Q_Σ is printed with 4Σ₁₂² in place of (Σ₁₂ + Σ₂₁)², which is valid only for a
/// symmetric stress. Reference: the deviator from which a stress with the rotational stress r = ±m is constructed.
#[test]
fn eq_87_misprints_the_deviatoric_stress() {
    compare_random_flows(4, |_, system, comparison| {
        let (p, r) = (dd(system.state.pressure), dd(system.flow.stress.rotational_stress));
        let angle = dd(system.state.stress_angle);
        let (s, c) = (angle + angle).sin_cos();
        let q = system.yield_deviator;
        let stress = [[-p + q * c, r + q * s], [-r + q * s, -p - q * c]];
        let normal = stress[0][0] - stress[1][1];
        let deviator = |shear: DoubleDouble| (normal * normal + shear * shear).sqrt() * dd(0.5);
        let printed = deviator(stress[0][1] + stress[0][1]);
        let corrected = deviator(stress[0][1] + stress[1][0]);
        comparison.add_case(q.into(), printed.into(), corrected.into(), 0.0);
        // The crate's stress tensor has the same deviator.
        let tensor = system.flow.stress.to_tensor();
        let own = 0.5 * (tensor[0][0] - tensor[1][1]).hypot(tensor[0][1] + tensor[1][0]);
        assert!((own / q.to_f64() - 1.0).abs() < 1e-14);
    });
}
