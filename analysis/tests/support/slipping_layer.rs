//! One slipping layer, with its acoustic tensor in closed form.

use models::common::rates::RateEquations;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::InterlayerYieldSet;
use models::yield_set::tangent::tangent_stiffness;

/// A plane solid with μ = ρ = 1 and one layer slipping.
#[derive(Clone, Copy)]
pub struct SlippingLayer {
    /// Lamé modulus λ.
    pub lambda: f64,
    /// Cosserat couple modulus α.
    pub alpha: f64,
    /// Friction coefficient κ of the layer.
    pub friction: f64,
    /// Dilatancy coefficient of the layer.
    pub dilatancy: f64,
}

impl SlippingLayer {
    pub fn equations(self) -> RateEquations<2> {
        let couple = Some(CoupleModuli { beta: 0.2, gamma: 0.4, eta: 0.3 });
        let rotation = Microrotation { alpha: self.alpha, inertia: 1.0, couple };
        let solid = Isotropic::new(self.lambda, 1.0, 1.0, Some(rotation)).expect("sound moduli");
        let layout = solid.layout::<2>();
        let set = InterlayerYieldSet {
            shear_strength: 1.0,
            shear_friction: self.friction,
            shear_dilatancy: self.dilatancy,
            couple: None,
        };
        let mut stress = Stress::default();
        stress.force[0][0] = -1.0;
        stress.force[1][0] = 1.0 + self.friction;
        let active = YieldSet::from(set).active_conditions(&stress, 1e-9);
        assert_eq!(active.len(), 1);
        let list: Vec<_> = layout.all_stresses().collect();
        let stiffness = tangent_stiffness(&solid.stiffness(layout.all_stresses()), &list, &active);
        layout.rates(&stiffness.expect("response"), 1.0, 1.0)
    }

    /// Trace and determinant of the acoustic tensor of the translations, Γ = Γₑ − a bᵀ/h, in closed form, for a wave
    /// normal at `angle` (rad); a and b are the tractions of D m and D n.
    pub fn acoustic_invariants(self, angle: f64) -> [f64; 2] {
        let Self { lambda, alpha, .. } = self;
        // D m over (σ11, σ22, σ21, σ12) for the flow direction m = (κ̂, 0, 1, 0) with dilatancy κ̂; for D n, with the
        // yield normal n, κ̂ is replaced by the friction κ.
        let image = |k: f64| [(lambda + 2.0) * k, lambda * k, 1.0 + alpha, 1.0 - alpha];
        let (a, b) = (image(self.dilatancy), image(self.friction));
        let h = self.friction * a[0] + a[2];
        let (s, c) = angle.sin_cos();
        // Traction of a stress on the face with normal (c, s); the second index of a stress is the normal.
        let traction = |d: [f64; 4]| [d[0] * c + d[3] * s, d[2] * c + d[1] * s];
        let (ta, tb) = (traction(a), traction(b));
        let n = [c, s];
        let entry = |i: usize, j: usize| {
            let kronecker = f64::from(i == j);
            (lambda + 1.0 - alpha) * n[i] * n[j] + (1.0 + alpha) * kronecker - ta[i] * tb[j] / h
        };
        let determinant = entry(0, 0) * entry(1, 1) - entry(0, 1) * entry(1, 0);
        [entry(0, 0) + entry(1, 1), determinant]
    }
}
