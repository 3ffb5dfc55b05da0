//! Rate equations of a solid as data, and their symmetric-hyperbolic form.
//!
//! Valid for elastic and elastoplastic solids: with generalised velocities v (translational velocities, spins) and the
//! stresses s that are work-conjugate to their gradients,
//!
//! ```text
//! M v̇ = Σ ∂ᵢ(Gⁱᵀ s) − Zᵀ s,    ṡ = D (Σ Gⁱ ∂ᵢv + Z v − R s).
//! ```
//!
//! M is the diagonal mass matrix. Gⁱ and Z are the strain operators; the balances of momentum and spin have their
//! transposes, which conserves energy. D is the tangent stiffness (not the constant `D` of the types, the number of
//! space dimensions). R is the relaxation due to plastic flow of the background: on a curved yield surface a
//! perturbation of the stress rotates the flow direction.

use crate::common::product::triple_product;
use crate::common::rounding::Rounded;
use crate::common::system::{LinearisedSystem, RoundedMatrix, Unknown};
use nalgebra::DMatrix;

/// Rate equations in `D` space dimensions; see the [module](self).
#[derive(Clone, Debug, PartialEq)]
pub struct RateEquations<const D: usize> {
    /// Unknowns: velocities v, then stresses s.
    pub unknowns: &'static [Unknown],
    /// Names of the equations: balances, then constitutive laws.
    pub equations: &'static [&'static str],
    /// Diagonal of the mass matrix M, one entry per velocity: kg/m³ for translations, kg/m for spins.
    pub inertia: Vec<Rounded>,
    /// Tangent stiffness, matrix D (rows and columns: stresses), Pa or N.
    pub stiffness: RoundedMatrix,
    /// Gradient operators Gⁱ (rows: stresses, columns: velocities), dimensionless.
    pub gradient: [DMatrix<f64>; D],
    /// Operator Z of the strain rates due to the spins themselves, not their gradients (rows: stresses, columns:
    /// velocities), dimensionless.
    pub rotation: DMatrix<f64>,
    /// Relaxation R (rows and columns: stresses), 1/(Pa·s); zero unless the background flows plastically.
    pub relaxation: RoundedMatrix,
}

/// A symmetric-hyperbolic system `A U̇ = Σ Bⁱ ∂ᵢU + Q U` for U = (v, s), velocities v and stresses s, in the notation
/// of Sadovskii & Sadovskaya (2019, "Elastic Cosserat continuum"): A symmetric positive definite, Bⁱ symmetric, Q
/// antisymmetric without plastic flow.
#[derive(Clone, Debug, PartialEq)]
pub struct SymmetricForm<const D: usize> {
    /// Matrix A = diag(M, D⁻¹); for an elastic solid ½ U·AU is the density of kinetic and elastic energy.
    pub a: DMatrix<f64>,
    /// Symmetric flux matrices Bⁱ.
    pub b: [DMatrix<f64>; D],
    /// Source matrix Q: antisymmetric, minus the relaxation R in the block of the stresses if the background flows
    /// plastically. R is positive semidefinite and damps perturbations.
    pub q: DMatrix<f64>,
}

impl<const D: usize> RateEquations<D> {
    /// Number of velocities.
    pub fn velocity_count(&self) -> usize {
        self.inertia.len()
    }

    /// Number of stresses.
    pub fn stress_count(&self) -> usize {
        self.stiffness.nrows()
    }

    /// The tangent stiffness without its rounding bounds.
    pub fn stiffness_values(&self) -> DMatrix<f64> {
        self.stiffness.map(|entry| entry.value)
    }

    /// Writes the linearised system `A ∂ₜz + Σ Bⁱ∂ᵢz + C z = 0` in the material frame (V = 0), solved for the stress
    /// rates.
    pub fn linearise(&self, system: &mut LinearisedSystem<D>) {
        let (nv, ns) = (self.velocity_count(), self.stress_count());
        system.reset(self.unknowns, self.equations, [0.0; D]);
        for (i, &inertia) in self.inertia.iter().enumerate() {
            system.a[(i, i)] = inertia;
            for s in 0..ns {
                for axis in 0..D {
                    system.b[axis][(i, nv + s)] = Rounded::from_exact(-self.gradient[axis][(s, i)]);
                }
                system.c[(i, nv + s)] = Rounded::from_exact(self.rotation[(s, i)]);
            }
        }
        let strain_coefficient = |law: usize, strain: &DMatrix<f64>, velocity: usize| {
            (0..ns)
                .map(|s| strain[(s, velocity)] * -self.stiffness[(law, s)])
                .fold(Rounded::ZERO, std::ops::Add::add)
        };
        for law in 0..ns {
            system.a[(nv + law, nv + law)] = Rounded::ONE;
            for stress in 0..ns {
                system.c[(nv + law, nv + stress)] = (0..ns)
                    .map(|s| self.stiffness[(law, s)] * self.relaxation[(s, stress)])
                    .fold(Rounded::ZERO, std::ops::Add::add);
            }
            for velocity in 0..nv {
                for axis in 0..D {
                    system.b[axis][(nv + law, velocity)] =
                        strain_coefficient(law, &self.gradient[axis], velocity);
                }
                system.c[(nv + law, velocity)] = strain_coefficient(law, &self.rotation, velocity);
            }
        }
    }

    /// The symmetric-hyperbolic form; `None` if the stiffness is not positive definite, or not symmetric to within
    /// 1e-12 of its largest entry.
    pub fn symmetric_form(&self) -> Option<SymmetricForm<D>> {
        let (nv, ns) = (self.velocity_count(), self.stress_count());
        let stiffness = self.stiffness_values();
        if (&stiffness - stiffness.transpose()).amax() > 1e-12 * stiffness.amax() {
            return None;
        }
        let compliance = stiffness.cholesky()?.inverse();
        let n = nv + ns;
        let mut a = DMatrix::zeros(n, n);
        for (i, inertia) in self.inertia.iter().enumerate() {
            a[(i, i)] = inertia.value;
        }
        a.view_mut((nv, nv), (ns, ns)).copy_from(&compliance);
        let b = std::array::from_fn(|axis| {
            let mut b = DMatrix::zeros(n, n);
            b.view_mut((nv, 0), (ns, nv)).copy_from(&self.gradient[axis]);
            b.view_mut((0, nv), (nv, ns)).copy_from(&self.gradient[axis].transpose());
            b
        });
        let mut q = DMatrix::zeros(n, n);
        q.view_mut((nv, 0), (ns, nv)).copy_from(&self.rotation);
        q.view_mut((0, nv), (nv, ns)).copy_from(&-self.rotation.transpose());
        q.view_mut((nv, nv), (ns, ns)).copy_from(&-self.relaxation.map(|entry| entry.value));
        Some(SymmetricForm { a, b, q })
    }
}

impl<const D: usize> SymmetricForm<D> {
    /// Galerkin restriction of the system to the subspace spanned by the columns of `basis`, e.g. the tangent plane of
    /// a yield surface (Sadovskii & Sadovskaya 2019, "Elastic-plastic Cosserat continuum"). The restricted system is
    /// symmetric-hyperbolic if these columns are linearly independent.
    pub fn restrict(&self, basis: &DMatrix<f64>) -> Self {
        let restrict = |m: &DMatrix<f64>| triple_product(&basis.transpose(), m, basis);
        Self {
            a: restrict(&self.a),
            b: std::array::from_fn(|axis| restrict(&self.b[axis])),
            q: restrict(&self.q),
        }
    }
}
