//! Right-hand side of the flow: time derivatives of the vorticity and of the internal variable (spin ω or stress angle
//! ψ).
//!
//! With v = Γx + v′, v′ divergence-free, and the vorticity ζ = ∂₁v′₂ − ∂₂v′₁, the curl of the momentum balance is
//!
//! ```text
//! ∂ₜζ = (∂₁² − ∂₂²) T₁₂ − ∂₁∂₂ (T₁₁ − T₂₂),   T = q N(ψ)/ρ − v′ ⊗ v′,   q = p sin φ + c cos φ
//! ```
//!
//! in coordinates that move with Γx, with N = \[\[cos 2ψ, sin 2ψ\], \[sin 2ψ, −cos 2ψ\]\]. Advection by Γx and the
//! force that maintains Γ do not contribute, since the vorticity of an incompressible plane flow is neither stretched
//! nor rotated.

use super::closure::{
    Closure, Deformation, coaxial_double_angle, double_shearing_rate, harris_grekova_double_angle,
};
use super::pressure::{Convergence, PressureEquation, PressureSolver, assemble_right_hand_side};
use super::spectral::{FourierSeries, ModeWaveVector, ModeWaveVectors};
use super::{FlowProblem, LeftDomain};
use models::common::elementary::Elementary;
use num_complex::Complex64;
use rayon::prelude::*;

/// Number of points per parallel task.
const POINTS_PER_TASK: usize = 4096;

/// Computes exp(Γt) of a traceless Γ, with Γ² = −det Γ I.
pub(super) fn matrix_exponential(gradient: [[f64; 2]; 2], time: f64) -> [[f64; 2]; 2] {
    let [[a, b], [c, d]] = gradient;
    let square = b * c - a * d;
    let angle = square.abs().sqrt() * time;
    // exp(Γt) = even·I + odd·Γ
    let (even, odd) = if angle.abs() < 1e-4 {
        // Taylor series; the next terms are below rounding.
        let z = square * time * time;
        (1.0 + z / 2.0, time * (1.0 + z / 6.0))
    } else if square > 0.0 {
        (angle.cr_cosh(), angle.cr_sinh() / angle * time)
    } else {
        (angle.cr_cos(), angle.cr_sin() / angle * time)
    };
    [[even + odd * a, odd * b], [odd * c, even + odd * d]]
}

/// Fields at the points of the box from the last evaluation, and constants.
pub(super) struct PointValues {
    pub(super) problem: FlowProblem,
    sin_phi: f64,
    /// Cohesion term c cos φ of the deviatoric stress, Pa.
    cohesion_term: f64,
    /// Sign of cos 2(ψ − ψ_D) in the background flow at time 0.
    branch: f64,
    /// Shear rate Q_D below which a run ends, 1/s (plastic potential).
    min_shear_rate: f64,
    /// Velocity perturbation v′, m/s, by axis.
    pub(super) velocity: [Vec<f64>; 2],
    /// ∂₁v′₁ = −∂₂v′₂, ∂₁v′₂ and ∂₂v′₁, 1/s.
    perturbation_gradient: [Vec<f64>; 3],
    /// Internal variable: ω, rad/s, or ψ, rad, background flow included; empty for the plastic potential.
    pub(super) internal_variable: Vec<f64>,
    /// cos 2ψ and sin 2ψ of the stress angle ψ at the points.
    pub(super) stress_double_angle: [Vec<f64>; 2],
    /// Pressure perturbation p − P₀, Pa, with the mean pressure P₀.
    pub(super) pressure: Vec<f64>,
}

/// Failure of an evaluation at a point: point index (x₁ fastest) and description.
type PointFailure = (usize, String);

impl PointValues {
    fn new(problem: FlowProblem) -> Self {
        let count: usize = problem.points.iter().product();
        let values = || vec![0.0; count];
        let background = Deformation::new(problem.velocity_gradient);
        let [cos, sin] = to_double_angle(problem.stress_angle);
        let [normal_difference, shear_rate_12] = background.deviator;
        let internal_variable =
            if problem.closure.internal_variable().is_some() { values() } else { Vec::new() };
        Self {
            sin_phi: problem.friction_angle.cr_sin(),
            cohesion_term: problem.cohesion * problem.friction_angle.cr_cos(),
            branch: (normal_difference * cos + shear_rate_12 * sin).signum(),
            min_shear_rate: problem.min_shear_rate * background.shear_rate(),
            velocity: [values(), values()],
            perturbation_gradient: [values(), values(), values()],
            internal_variable,
            stress_double_angle: [values(), values()],
            pressure: values(),
            problem,
        }
    }

    /// Computes deviatoric deformation rate and vorticity at a point, Γ included.
    #[inline(always)]
    fn deformation(&self, point: usize) -> Deformation {
        let [[g11, g12], [g21, g22]] = self.problem.velocity_gradient;
        let [a, b, c] = self.perturbation_gradient.each_ref().map(|own| own[point]);
        Deformation::new([[g11 + a, g12 + c], [g21 + b, g22 - a]])
    }

    /// Computes the shear rates Q_D at the points, 1/s.
    pub(super) fn shear_rates(&self) -> Vec<f64> {
        (0..self.pressure.len()).map(|point| self.deformation(point).shear_rate()).collect()
    }

    /// Computes the deviatoric stress q = p sin φ + c cos φ, Pa.
    #[inline(always)]
    fn deviatoric_stress(&self, point: usize) -> f64 {
        (self.problem.pressure + self.pressure[point]) * self.sin_phi + self.cohesion_term
    }

    /// Computes the source of the pressure equation, −ρ ∂ᵢvⱼ∂ⱼvᵢ without the part of the background flow, Pa/m².
    #[inline(always)]
    fn pressure_source(&self, point: usize) -> f64 {
        let [[g11, g12], [g21, g22]] = self.problem.velocity_gradient;
        let [a, b, c] = self.perturbation_gradient.each_ref().map(|own| own[point]);
        let mixed = (g11 - g22) * a + g12 * b + g21 * c;
        -2.0 * self.problem.density * (mixed + a * a + b * c)
    }

    /// Computes T₁₂ = q sin 2ψ/ρ − v′₁v′₂, m²/s².
    #[inline(always)]
    fn shear_momentum_flux(&self, point: usize) -> f64 {
        let [v1, v2] = self.velocity.each_ref().map(|own| own[point]);
        self.deviatoric_stress(point) * self.stress_double_angle[1][point] / self.problem.density
            - v1 * v2
    }

    /// Computes T₁₁ − T₂₂ = 2q cos 2ψ/ρ − (v′₁² − v′₂²), m²/s².
    #[inline(always)]
    fn normal_momentum_flux_difference(&self, point: usize) -> f64 {
        let [v1, v2] = self.velocity.each_ref().map(|own| own[point]);
        2.0 * self.deviatoric_stress(point) * self.stress_double_angle[0][point]
            / self.problem.density
            - (v1 * v1 - v2 * v2)
    }

    /// Computes Dψ/Dt of double shearing, rad/s.
    #[inline(always)]
    fn stress_angle_rate(&self, point: usize) -> f64 {
        let direction = self.stress_double_angle.each_ref().map(|own| own[point]);
        double_shearing_rate(&self.deformation(point), self.problem.rotation_ratio, direction)
    }

    /// Updates cos 2ψ and sin 2ψ at all points; fails if ψ is undetermined at a point.
    fn update_double_angles(&mut self) -> Result<(), PointFailure> {
        let mut direction = std::mem::take(&mut self.stress_double_angle);
        let [cosines, sines] = &mut direction;
        let values = &*self;
        let first = cosines
            .par_chunks_mut(POINTS_PER_TASK)
            .zip(sines.par_chunks_mut(POINTS_PER_TASK))
            .enumerate()
            .filter_map(|(part, (cosines, sines))| {
                let mut first = None;
                for (point, (cos, sin)) in
                    (POINTS_PER_TASK * part..).zip(cosines.iter_mut().zip(sines))
                {
                    match values.double_angle(point) {
                        Some(found) => [*cos, *sin] = found,
                        None => first = first.or(Some(point)),
                    }
                }
                first
            })
            .min();
        self.stress_double_angle = direction;
        first.map_or(Ok(()), |point| Err((point, self.describe_undetermined_angle(point))))
    }

    #[inline(always)]
    fn double_angle(&self, point: usize) -> Option<[f64; 2]> {
        let deformation = self.deformation(point);
        match self.problem.closure {
            Closure::HarrisGrekova => harris_grekova_double_angle(
                &deformation,
                self.problem.rotation_ratio,
                self.branch,
                self.internal_variable[point],
            ),
            Closure::DoubleShearing => {
                let found = to_double_angle(self.internal_variable[point]);
                found[0].is_finite().then_some(found)
            }
            Closure::PlasticPotential => coaxial_double_angle(&deformation, self.min_shear_rate),
        }
    }

    /// Describes why the stress angle of a point is undetermined.
    fn describe_undetermined_angle(&self, point: usize) -> String {
        let deformation = self.deformation(point);
        let rate = deformation.shear_rate();
        match self.problem.closure {
            Closure::HarrisGrekova => {
                let spin = self.internal_variable[point];
                let required_rate =
                    self.problem.rotation_ratio * (spin - deformation.half_vorticity).abs();
                format!(
                    "no stress angle: sin φ |ω − s₂₁| = {required_rate:.6e} exceeds Q_D = {rate:.6e} 1/s"
                )
            }
            Closure::DoubleShearing => "the stress angle is not finite".to_owned(),
            Closure::PlasticPotential => {
                format!("Q_D = {rate:.6e} 1/s is below {:.6e}: nearly rigid", self.min_shear_rate)
            }
        }
    }

    /// Computes the mean powers; fails unless the deviatoric stress q is positive at all points.
    fn compute_powers(&self) -> Result<MeanPowers, PointFailure> {
        let (density, count) = (self.problem.density, self.pressure.len());
        let [[g11, g12], [g21, g22]] = self.problem.velocity_gradient;
        let partial_sums: Vec<(Option<usize>, [f64; 3])> = (0..count.div_ceil(POINTS_PER_TASK))
            .into_par_iter()
            .map(|part| {
                let (mut first, mut sums) = (None, [0.0; 3]);
                for point in POINTS_PER_TASK * part..count.min(POINTS_PER_TASK * (part + 1)) {
                    let [cos, sin] = self.stress_double_angle.each_ref().map(|own| own[point]);
                    let [v1, v2] = self.velocity.each_ref().map(|own| own[point]);
                    let [a, b, c] = self.perturbation_gradient.each_ref().map(|own| own[point]);
                    let q = self.deviatoric_stress(point);
                    // The negated comparison also catches NaN.
                    if !matches!(q.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater)) {
                        first = first.or(Some(point));
                    }
                    let [normal_difference, shear_rate_12] = self.deformation(point).deviator;
                    sums[0] -= density * (g11 * v1 * v1 + (g12 + g21) * v1 * v2 + g22 * v2 * v2);
                    sums[1] -= q * (2.0 * cos * a + sin * (b + c));
                    sums[2] += q * (cos * normal_difference + sin * shear_rate_12);
                }
                (first, sums)
            })
            .collect();
        if let Some(point) = partial_sums.iter().find_map(|part| part.0) {
            let (p, q) =
                (self.problem.pressure + self.pressure[point], self.deviatoric_stress(point));
            return Err((point, format!("p = {p:.6e} Pa, so that q = {q:.6e} Pa is not positive")));
        }
        // Fixed order of the partial sums: the same bits for any number of threads.
        let [background, stress, internal] = partial_sums.iter().fold([0.0; 3], |all, (_, own)| {
            std::array::from_fn(|i| all[i] + own[i] / count as f64)
        });
        Ok(MeanPowers { background, stress, internal })
    }
}

/// Mean powers of the last evaluated state, W/m³; symbols: [`FlowEnergy`](super::FlowEnergy).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct MeanPowers {
    /// Power of the background flow, −ρ⟨v′·Γv′⟩, W/m³.
    pub(super) background: f64,
    /// Power of the stress, −⟨qN : ∇v′⟩, W/m³.
    pub(super) stress: f64,
    /// Internal power ⟨2Q_D q cos 2Δ⟩, W/m³.
    pub(super) internal: f64,
}

/// Right-hand side of the equations of the flow, with its buffers.
pub(super) struct FlowEquations {
    /// Fields at the points of the box, from the last evaluation.
    pub(super) points: PointValues,
    pub(super) series: FourierSeries,
    /// Wave vectors at the time of the last evaluation.
    waves: ModeWaveVectors,
    pressure_solver: PressureSolver,
    pub(super) powers: MeanPowers,
    /// Modes of p − P₀; initial guess of the next pressure solution.
    pub(super) pressure: Vec<Complex64>,
    /// Buffers for the modes of fields that are transformed.
    mode_buffers: [Vec<Complex64>; 3],
    pressure_right_hand_side: Vec<Complex64>,
    /// Numbers of pressure solutions (one per evaluation of the right-hand side) and of their iterations.
    pub(super) evaluation_counts: [usize; 2],
    /// Relative residual of the last pressure solution.
    pub(super) pressure_residual: f64,
}

impl FlowEquations {
    pub(super) fn new(problem: FlowProblem) -> Self {
        let series = FourierSeries::new(problem.points);
        let modes = || vec![Complex64::ZERO; series.mode_count()];
        Self {
            waves: ModeWaveVectors::new(
                &series,
                problem.lengths,
                matrix_exponential(problem.velocity_gradient, 0.0),
            ),
            points: PointValues::new(problem),
            powers: MeanPowers::default(),
            pressure: modes(),
            mode_buffers: [modes(), modes(), modes()],
            pressure_right_hand_side: modes(),
            pressure_solver: PressureSolver::new(&series),
            series,
            evaluation_counts: [0; 2],
            pressure_residual: 0.0,
        }
    }

    pub(super) fn problem(&self) -> &FlowProblem {
        &self.points.problem
    }

    /// Returns the number of complex numbers in the state vector: the Fourier modes of the vorticity, then those of the
    /// internal variable (spin ω or stress angle ψ), if any; then one number with the works of the background flow
    /// (real part) and of the stress (imaginary part); then the internal variable of the background flow.
    pub(super) fn state_length(&self) -> usize {
        self.series.mode_count()
            * (1 + usize::from(self.problem().closure.internal_variable().is_some()))
            + 2
    }

    /// Computes the time derivative of ω or ψ of the background flow, which is independent of perturbations.
    fn background_rate(&self, internal_variable: f64) -> f64 {
        let FlowProblem { closure, velocity_gradient, spin_acceleration, rotation_ratio, .. } =
            self.problem();
        match closure {
            Closure::HarrisGrekova => *spin_acceleration,
            Closure::DoubleShearing => {
                let deformation = Deformation::new(*velocity_gradient);
                double_shearing_rate(
                    &deformation,
                    *rotation_ratio,
                    to_double_angle(internal_variable),
                )
            }
            Closure::PlasticPotential => 0.0,
        }
    }

    /// Computes the wave vectors at a time, s.
    pub(super) fn compute_wave_vectors(&self, time: f64) -> ModeWaveVectors {
        let deformation = matrix_exponential(self.problem().velocity_gradient, time);
        ModeWaveVectors::new(&self.series, self.problem().lengths, deformation)
    }

    /// Computes the time derivative of a state.
    ///
    /// # Errors
    /// The stress angle is undetermined or the deviatoric stress q is not positive at a point, or the pressure solution
    /// does not converge.
    pub(super) fn compute_rates(
        &mut self,
        time: f64,
        state: &[Complex64],
        rates: &mut [Complex64],
    ) -> Result<(), LeftDomain> {
        let (count, size) = (self.series.mode_count(), self.state_length());
        let (vorticity, other_state) = state.split_at(count);
        let (vorticity_rates, other_rates) = rates.split_at_mut(count);
        let deformation = matrix_exponential(self.problem().velocity_gradient, time);
        self.waves.deform(&self.series, self.points.problem.lengths, deformation);
        self.evaluate_fields(vorticity, other_state);
        self.points.update_double_angles().map_err(|fault| self.locate_failure(fault, time))?;
        self.solve_pressure(time)?;
        self.powers =
            self.points.compute_powers().map_err(|fault| self.locate_failure(fault, time))?;
        self.compute_vorticity_rates(vorticity_rates);
        if self.problem().closure.internal_variable().is_some() {
            self.compute_internal_variable_rates(other_state[0].re, &mut other_rates[..count]);
        }
        let MeanPowers { background, stress, .. } = self.powers;
        other_rates[size - count - 2] = Complex64::new(background, stress);
        other_rates[size - count - 1] = self.background_rate(state[size - 1].re).into();
        Ok(())
    }

    /// Converts the failure at a point to an error with its position in the initial box.
    fn locate_failure(&self, (point, description): PointFailure, time: f64) -> LeftDomain {
        let FlowProblem { points, lengths, .. } = self.problem();
        let index = [point % points[0], point / points[0]];
        let coordinate =
            |axis: usize| (index[axis] as f64 + 0.5) * lengths[axis] / points[axis] as f64;
        LeftDomain { description, position: Some([coordinate(0), coordinate(1)]), time }
    }

    /// Evaluates velocity, velocity gradient, and ω or ψ at the points, from the modes.
    fn evaluate_fields(&mut self, vorticity: &[Complex64], other_state: &[Complex64]) {
        let PointValues {
            velocity: [v1, v2],
            perturbation_gradient: [g11, g21, g12],
            internal_variable,
            ..
        } = &mut self.points;
        let (series, waves) = (&mut self.series, &self.waves);
        // Velocity modes from vorticity modes: v̂ = iζ̂ (k₂, −k₁)/k².
        let i = Complex64::I;
        series.transform_inverse(
            vorticity,
            waves,
            |w| i * (w.components[1] * w.inverse_square),
            v1,
        );
        series.transform_inverse(
            vorticity,
            waves,
            |w| -i * (w.components[0] * w.inverse_square),
            v2,
        );
        let second = |w: &ModeWaveVector, a: usize, b: usize| {
            Complex64::from(w.components[a] * w.components[b] * w.inverse_square)
        };
        series.transform_inverse(vorticity, waves, |w| -second(w, 0, 1), g11);
        series.transform_inverse(vorticity, waves, |w| second(w, 0, 0), g21);
        series.transform_inverse(vorticity, waves, |w| -second(w, 1, 1), g12);
        if !internal_variable.is_empty() {
            series.transform_inverse(
                &other_state[..series.mode_count()],
                waves,
                |_| Complex64::ONE,
                internal_variable,
            );
        }
    }

    /// Solves for the pressure, as modes and at the points.
    fn solve_pressure(&mut self, time: f64) -> Result<(), LeftDomain> {
        let (series, waves, points) = (&mut self.series, &self.waves, &self.points);
        let [cosines, sines] = points.stress_double_angle.each_ref().map(Vec::as_slice);
        let [cos, sin, source] = &mut self.mode_buffers;
        series.transform_forward(|point| cosines[point], cos);
        series.transform_forward(|point| sines[point], sin);
        series.transform_forward(|point| points.pressure_source(point), source);
        let stress = points.problem.pressure * points.sin_phi + points.cohesion_term;
        assemble_right_hand_side(
            series,
            waves,
            source,
            [cos, sin],
            stress,
            &mut self.pressure_right_hand_side,
        );
        let equation = PressureEquation {
            waves,
            sin_phi: points.sin_phi,
            stress_double_angle: [cosines, sines],
            mean_double_angle: [cos[0].re, sin[0].re],
        };
        let tolerance = points.problem.pressure_tolerance;
        let pressure = &mut self.pressure;
        let solved = self.pressure_solver.solve(
            series,
            &equation,
            &self.pressure_right_hand_side,
            tolerance,
            pressure,
        );
        let Convergence { iterations, residual } = solved.map_err(|solved| {
            // A failed solution may be non-finite and must not be the next initial guess.
            pressure.fill(Complex64::ZERO);
            let (residual, count) = (solved.residual, solved.iterations);
            let description =
                format!("no pressure: residual {residual:.1e} after {count} iterations");
            LeftDomain { description, position: None, time }
        })?;
        self.evaluation_counts =
            [self.evaluation_counts[0] + 1, self.evaluation_counts[1] + iterations];
        self.pressure_residual = residual;
        series.transform_inverse(
            &self.pressure,
            waves,
            |_| Complex64::ONE,
            &mut self.points.pressure,
        );
        Ok(())
    }

    /// Computes the time derivative of the vorticity.
    fn compute_vorticity_rates(&mut self, rates: &mut [Complex64]) {
        let (series, points) = (&mut self.series, &self.points);
        let [shear, difference, _] = &mut self.mode_buffers;
        series.transform_forward(|point| points.shear_momentum_flux(point), shear);
        series.transform_forward(|point| points.normal_momentum_flux_difference(point), difference);
        series.fill_modes(rates, &self.waves, |wave, i| {
            let [k1, k2] = wave.components;
            k1 * k2 * difference[i] - (k1 * k1 - k2 * k2) * shear[i]
        });
    }

    /// Computes the time derivative of ω or ψ; `mean`: mean of that field over the box.
    fn compute_internal_variable_rates(&mut self, mean: f64, rates: &mut [Complex64]) {
        let (series, points) = (&mut self.series, &self.points);
        let [first_flux, second_flux, source] = &mut self.mode_buffers;
        let [v1, v2] = &points.velocity;
        series.transform_forward(
            |point| v1[point] * (points.internal_variable[point] - mean),
            first_flux,
        );
        series.transform_forward(
            |point| v2[point] * (points.internal_variable[point] - mean),
            second_flux,
        );
        if points.problem.closure == Closure::DoubleShearing {
            series.transform_forward(|point| points.stress_angle_rate(point), source);
        } else {
            source.fill(Complex64::ZERO);
            source[0].re = points.problem.spin_acceleration;
        }
        let i = Complex64::I;
        series.fill_modes(rates, &self.waves, |wave, index| {
            let [k1, k2] = wave.components;
            source[index] - i * (k1 * first_flux[index] + k2 * second_flux[index])
        });
    }
}

/// Computes cos 2ψ and sin 2ψ of the angle ψ = `angle`, rad.
#[inline(always)]
pub(super) fn to_double_angle(angle: f64) -> [f64; 2] {
    let (sin, cos) = (2.0 * angle).cr_sin_cos();
    [cos, sin]
}
