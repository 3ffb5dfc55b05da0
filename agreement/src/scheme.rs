//! Von Neumann analysis of the solver for solids: the exact amplification matrix of a time step for a plane wave, from
//! the matrices of the analysis.
//!
//! In energy coordinates y = LᵀU, A = LLᵀ, the equations are ẏ = Σ B̂ⁱ∂ᵢy + Q̂y with B̂ⁱ symmetric and Q̂
//! antisymmetric; the projection Π onto the tangent space of a yield surface is orthogonal. A sweep of Δt/2 along axis
//! i multiplies exp(iκ·x) by V diag(g) Vᵀ, where B̂ⁱ = V diag(c) Vᵀ and, with θ = κᵢhᵢ, for waves that propagate to the
//! right with Courant number C = |c|Δt/(2hᵢ)
//!
//! ```text
//! g = 1 − C (1 − e^(−iθ)) f,  f = 1 + (1 − e^(−iθ)) (α + β e^(iθ) + γ e^(2iθ)),
//! α = (1 − C²)(2 + C)/24,  β = (1 − C)/2 − C(1 − C²)/12,  γ = −(1 − C²)(2 − C)/24.
//! ```
//!
//! Let X, Y, Z be these sweeps, x a quarter sweep (Δt/4) along the first axis, R = e^(½Q̂Δt), and Π = I without
//! yielding. In n steps the amplitude is multiplied by
//!
//! ```text
//! two-cyclic, midpoint reflection    Gⁿ, G = X Y Z R (2Π − I) R Z Y X,
//! two-cyclic, return mapping         Gⁿ, G = Π X Y Z R R Z Y X,
//! alternating, return mapping        x (M X)ⁿ⁻¹ M x, M = Π Y Z R X R Z Y,
//! ```
//!
//! where the last x completes the sweeps for output.
//!
//! The module shares only these formulas and the names of options with the solver.

use dynamics::problem::{PlasticStep, Splitting};
use models::common::elementary::{Elementary, cr_cis};
use models::common::product::triple_product;
use models::common::rates::SymmetricForm;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use num_complex::Complex64;

type ComplexMatrix = DMatrix<Complex64>;

/// Cell size and time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discretisation<const D: usize> {
    /// Edge lengths of a cell, m.
    pub spacing: [f64; D],
    /// Time step Δt, s.
    pub time_step: f64,
}

/// Amplification matrices of a plane wave, in energy coordinates.
#[derive(Clone, Debug)]
pub struct Propagator {
    /// Amplification matrix of the first step.
    first_step: ComplexMatrix,
    /// Amplification matrix of each subsequent step.
    later_step: ComplexMatrix,
    /// Matrix from the state after a step to the output state.
    output_matrix: ComplexMatrix,
}

impl Propagator {
    /// Amplitudes after 0, `every`, 2 `every` … `count` × `every` steps for the unit vector `wave` as initial state:
    /// inner products of `wave` with the output state.
    pub fn amplitudes(
        &self,
        wave: &DVector<Complex64>,
        every: usize,
        count: usize,
    ) -> Vec<Complex64> {
        let mut state = &self.first_step * wave;
        let mut amplitudes = vec![wave.dotc(wave)];
        for index in 1..=every * count {
            if index > 1 {
                state = &self.later_step * state;
            }
            if index % every == 0 {
                amplitudes.push(wave.dotc(&(&self.output_matrix * &state)));
            }
        }
        amplitudes
    }
}

/// Linearised equations in energy coordinates, with a fixed set of active yield conditions.
#[derive(Clone, Debug)]
pub struct EnergyForm<const D: usize> {
    /// Transformation Lᵀ from unknowns to energy coordinates.
    pub energy_transform: DMatrix<f64>,
    /// Transformation L⁻ᵀ from energy coordinates to unknowns.
    pub inverse_transform: DMatrix<f64>,
    /// Eigenvectors V and eigenvalues c of B̂ⁱ, for each axis i.
    axis_eigenpairs: [SymmetricEigen<f64, nalgebra::Dyn>; D],
    b: [DMatrix<f64>; D],
    q: DMatrix<f64>,
    /// Projection Π onto the tangent space of the yield surface.
    tangent_projection: DMatrix<f64>,
    /// Unit normals L⁻¹n/|L⁻¹n| in energy coordinates, one for each active condition.
    normals: Vec<DVector<f64>>,
}

impl<const D: usize> EnergyForm<D> {
    /// Creates the equations from the symmetric form and the yield normals with respect to all unknowns; `None` if the
    /// energy is not positive definite or the normals are linearly dependent.
    pub fn new(form: &SymmetricForm<D>, normals: &[DVector<f64>]) -> Option<Self> {
        let lower = form.a.clone().cholesky()?.l();
        // Forward substitution needs no pivoting, so the result does not depend on the choice of units.
        let inverse =
            lower.solve_lower_triangular(&DMatrix::identity(lower.nrows(), lower.nrows()))?;
        let scaled = |m: &DMatrix<f64>| triple_product(&inverse, m, &inverse.transpose());
        let size = lower.nrows();
        // Normalised, since conditions on stresses and on couple stresses have values of different units.
        let unit = |normal: &DVector<f64>| (&inverse * normal).try_normalize(0.0);
        let normals: Vec<DVector<f64>> = normals.iter().map(unit).collect::<Option<_>>()?;
        let mut tangent = DMatrix::identity(size, size);
        if !normals.is_empty() {
            let all = DMatrix::from_columns(&normals);
            tangent -= &all * (all.transpose() * &all).try_inverse()? * all.transpose();
        }
        let b = form.b.each_ref().map(scaled);
        Some(Self {
            axis_eigenpairs: b.each_ref().map(|b| ((b + b.transpose()) * 0.5).symmetric_eigen()),
            q: scaled(&form.q),
            b,
            energy_transform: lower.transpose(),
            inverse_transform: inverse.transpose(),
            tangent_projection: tangent,
            normals,
        })
    }

    /// Symbol i Σ κᵢB̂ⁱ + Q̂ of the equations without the projection Π.
    fn symbol(&self, wave: [f64; D]) -> ComplexMatrix {
        let mut symbol = to_complex(&self.q);
        for (b, k) in self.b.iter().zip(wave) {
            symbol += b.map(|x| Complex64::new(0.0, k * x));
        }
        symbol
    }

    /// Plane waves y = Re ŷ exp(i(κ·x − ωt)) of the wave vector κ (1/m): frequencies ω (rad/s, positive, descending)
    /// and unit amplitudes ŷ in energy coordinates.
    pub fn compute_waves(&self, wave: [f64; D]) -> Vec<(f64, DVector<Complex64>)> {
        /// Frequencies below this fraction of the largest are treated as zero.
        const MIN_RELATIVE_FREQUENCY: f64 = 1e-9;
        let tangent = to_complex(&self.tangent_projection);
        let symbol = &tangent * self.symbol(wave) * &tangent * Complex64::i();
        let eigen = ((&symbol + symbol.adjoint()) * Complex64::from(0.5)).symmetric_eigen();
        let greatest = eigen.eigenvalues.amax();
        let mut waves: Vec<(f64, DVector<Complex64>)> = (0..eigen.eigenvalues.len())
            .filter(|&i| eigen.eigenvalues[i] > MIN_RELATIVE_FREQUENCY * greatest)
            .map(|i| (eigen.eigenvalues[i], eigen.eigenvectors.column(i).into_owned()))
            .collect();
        waves.sort_by(|a, b| b.0.total_cmp(&a.0));
        // The polarisations of a multiple frequency are not unique, and the scheme is anisotropic: choose a basis.
        let mut first = 0;
        while first < waves.len() {
            let is_other =
                |own: &(f64, _)| waves[first].0 - own.0 > MIN_RELATIVE_FREQUENCY * greatest;
            let end = waves.iter().position(is_other).unwrap_or(waves.len());
            if end > first + 1 {
                let vectors: Vec<_> = waves[first..end].iter().map(|own| own.1.clone()).collect();
                let chosen = canonical_basis(&DMatrix::from_columns(&vectors));
                for (own, vector) in waves[first..end].iter_mut().zip(chosen) {
                    own.1 = vector;
                }
            }
            first = end;
        }
        waves
    }

    /// Bounds on the value of an active yield condition in a wave of the given amplitude (energy coordinates), and on
    /// its time derivative during elastic response (Cauchy–Schwarz inequality; normals have unit length).
    pub fn bounds(&self, wave: [f64; D], amplitude: &DVector<Complex64>) -> [f64; 2] {
        [amplitude.norm(), (self.symbol(wave) * amplitude).norm()]
    }

    /// Stress normal to the yield surface, as a vector of unknowns, for which every active condition has unit value
    /// in energy coordinates (unit distance from the surface). `None` without active conditions, if their normals are
    /// linearly dependent, or if a plastic multiplier is not positive.
    pub fn yield_normal_stress(&self) -> Option<DVector<f64>> {
        if self.normals.is_empty() {
            return None;
        }
        let all = DMatrix::from_columns(&self.normals);
        let share = (all.transpose() * &all).try_inverse()?
            * DVector::from_element(self.normals.len(), 1.0);
        // Plastic multipliers; all are positive if all conditions remain active.
        share.iter().all(|own| *own > 0.0).then(|| &self.inverse_transform * all * share)
    }

    /// Amplification matrices of the wave vector κ (1/m). The midpoint reflection requires two-cyclic sweeps.
    pub fn propagator(
        &self,
        wave: [f64; D],
        grid: &Discretisation<D>,
        plastic_step: PlasticStep,
        splitting: Splitting,
    ) -> Propagator {
        let size = self.q.nrows();
        let half = self.rotation_matrix(0.5 * grid.time_step);
        let tangent = to_complex(&self.tangent_projection);
        let sweeps: Vec<ComplexMatrix> =
            (0..D).map(|axis| self.sweep_matrix(axis, wave[axis], grid, 0.5)).collect();
        // The sweep along the last axis is the innermost one.
        let wrap_sweep = |sweeps: &[ComplexMatrix], inner: ComplexMatrix| {
            sweeps.iter().rev().fold(inner, |inner, sweep| sweep * inner * sweep)
        };
        let two_cyclic = |step: ComplexMatrix| Propagator {
            first_step: step.clone(),
            later_step: step,
            output_matrix: ComplexMatrix::identity(size, size),
        };
        match (plastic_step, splitting) {
            (PlasticStep::MidpointReflection, _) => {
                let mirror =
                    to_complex(&(&self.tangent_projection * 2.0 - DMatrix::identity(size, size)));
                two_cyclic(wrap_sweep(&sweeps, &half * mirror * &half))
            }
            (PlasticStep::ReturnMapping, Splitting::TwoCyclic) => {
                two_cyclic(tangent * wrap_sweep(&sweeps, &half * &half))
            }
            (PlasticStep::ReturnMapping, Splitting::Alternating) => {
                let quarter = self.sweep_matrix(0, wave[0], grid, 0.25);
                let rest = tangent * wrap_sweep(&sweeps[1..], &half * &sweeps[0] * &half);
                Propagator {
                    first_step: &rest * &quarter,
                    later_step: rest * &sweeps[0],
                    output_matrix: quarter,
                }
            }
        }
    }

    /// Amplification matrix of a sweep along `axis`, with component `k` (1/m) of the wave vector, over a fraction of
    /// the step.
    fn sweep_matrix(
        &self,
        axis: usize,
        k: f64,
        grid: &Discretisation<D>,
        fraction: f64,
    ) -> ComplexMatrix {
        let h = grid.spacing[axis];
        let (sin, cos) = (k * h).cr_sin_cos();
        let factor = |speed: f64| {
            let courant = fraction * speed.abs() * grid.time_step / h;
            let (rest, both) = (1.0 - courant, 1.0 - courant * courant);
            let weights = [
                both * (2.0 + courant) / 24.0,
                0.5 * rest - courant * both / 12.0,
                -both * (2.0 - courant) / 24.0,
            ];
            let difference = Complex64::new(1.0 - cos, sin);
            let next = Complex64::new(cos, sin);
            let correction = weights[0] + next * (weights[1] + next * weights[2]);
            let to_right = 1.0 - courant * difference * (1.0 + difference * correction);
            // Solutions of ẇ = c∂w propagate to the left for c > 0.
            if speed > 0.0 { to_right.conj() } else { to_right }
        };
        let eigen = &self.axis_eigenpairs[axis];
        let vectors = to_complex(&eigen.eigenvectors);
        &vectors * ComplexMatrix::from_diagonal(&eigen.eigenvalues.map(factor)) * vectors.adjoint()
    }

    /// Rotation exp(Q̂t) over a time t (s).
    fn rotation_matrix(&self, time: f64) -> ComplexMatrix {
        let symbol = self.q.map(|x| Complex64::new(0.0, x));
        let eigen = ((&symbol + symbol.adjoint()) * Complex64::from(0.5)).symmetric_eigen();
        let turn = eigen.eigenvalues.map(|frequency| cr_cis(-frequency * time));
        &eigen.eigenvectors * ComplexMatrix::from_diagonal(&turn) * eigen.eigenvectors.adjoint()
    }
}

/// Canonical orthonormal basis of the span of orthonormal columns, a function of the span only: projections of the
/// coordinate axes, orthogonalised by Gram–Schmidt.
fn canonical_basis(columns: &ComplexMatrix) -> Vec<DVector<Complex64>> {
    /// Minimum length of an accepted projection: with at most 24 axes the longest of the projections onto a space of
    /// any dimension is at least 1/√24 > 0.1 long.
    const MIN_PROJECTION_LENGTH: f64 = 0.1;
    let (size, count) = columns.shape();
    let mut chosen: Vec<DVector<Complex64>> = Vec::new();
    for axis in 0..size {
        // Projection P e = V (V* e) of the coordinate axis e.
        let mut vector: DVector<Complex64> = columns * columns.row(axis).adjoint();
        for _ in 0..2 {
            for own in &chosen {
                let component = own.dotc(&vector);
                vector -= own * component;
            }
        }
        let norm = vector.norm();
        if norm > MIN_PROJECTION_LENGTH && chosen.len() < count {
            chosen.push(vector.unscale(norm));
        }
    }
    chosen
}

fn to_complex(matrix: &DMatrix<f64>) -> ComplexMatrix {
    matrix.map(Complex64::from)
}
