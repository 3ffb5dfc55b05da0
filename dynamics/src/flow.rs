//! Time-domain granular flow at constant volume (dilatancy angle ν = 0): the equations of Harris & Grekova (2005) and
//! related models, in a periodic box that deforms with a homogeneous background flow of velocity Γx.
//!
//! - [`FlowProblem`]: background flow, box, tolerances;
//! - [`Closure`]: equation for the stress angle; `equations`: right-hand side, from the balance laws;
//! - `pressure`: equation for the pressure, from the incompressibility constraint;
//! - [`spectral`]: Fourier series in the box, whose wave vectors k(t) = exp(−Γᵀt) k₀ deform with it;
//! - [`perturbation`]: initial perturbations;
//! - `chebyshev`: Runge–Kutta–Chebyshev coefficients; [`FlowSolver`] chooses the number of stages and the step size.
//!
//! A steady velocity gradient Γ at uniform stress requires the body force Γ²x = −det Γ x per unit mass, m/s², since Γ
//! is traceless (Γ² = −det Γ I); it is curl-free and does not enter the vorticity equation. A steady spin requires the
//! uniform body moment −2r/ρ per unit mass, m²/s², of the rotational stress r, Pa.

mod chebyshev;
mod closure;
mod equations;
mod output;
pub mod perturbation;
mod pressure;
mod problem;
pub mod spectral;

use chebyshev::{compute_coefficients, required_stages, stability_limit};
pub use closure::Closure;
use equations::FlowEquations;
use models::common::elementary::{Elementary, cr_cis};
use num_complex::Complex64;
use pressure::axpby;
use problem::gradient_shear_rate;
pub use problem::{FlowError, FlowProblem};

/// Maximum number of stages of a step.
const MAX_STAGES: usize = 2000;
/// Number of steps after which the spectral radius is estimated again.
const SPECTRAL_RADIUS_STEPS: usize = 25;
/// Deformation |Γ|t of the box after which the spectral radius is estimated again.
const SPECTRAL_RADIUS_SHEAR: f64 = 0.02;
/// Number of successive reductions of a step after which it fails if it has no result or a non-finite one; reductions
/// by the error estimate are not limited.
const MAX_STEP_REDUCTIONS: usize = 20;
/// Maximum deformation |Γ|Δt of the box in a step with error control.
const MAX_STEP_SHEAR: f64 = 0.25;
/// Rounding error of a step relative to the sum of the norm of the state and the background shear rate.
const STEP_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Callback before an evaluation of the right-hand side, called with the time of the evaluation, s.
pub type EvaluationCallback<'a> = &'a mut dyn FnMut(f64);

/// Field of a granular flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlowField {
    /// Component 0 or 1 of the velocity perturbation v′ = v − Γx, m/s.
    Velocity(usize),
    /// The spin ω, rad/s.
    Spin,
    /// Angle ψ of the major principal stress from x₁, rad; in (−π/2, π/2] unless ψ is the internal variable (double
    /// shearing).
    StressAngle,
    /// The pressure p, Pa.
    Pressure,
    /// The shear rate Q_D, the magnitude of the deviatoric deformation rate, 1/s.
    ShearRate,
}

/// Error: a point has left the fully deforming region, the equations have no solution, or no step is possible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{description}")]
pub struct LeftDomain {
    /// Description of the failure, with the values that cause it.
    pub description: String,
    /// Position in the initial box, m; `None` if no single point is concerned.
    pub position: Option<[f64; 2]>,
    /// Time of the failed evaluation, or of the start of the failed step, s.
    pub time: f64,
}

/// Energy ledger of the perturbation: energy and works since time 0 per volume, J/m³. v′: velocity perturbation; ⟨⟩:
/// mean over the box; qN: deviatoric stress with q = p sin φ + c cos φ and N = \[\[cos 2ψ, sin 2ψ\], \[sin 2ψ, −cos
/// 2ψ\]\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowEnergy {
    /// Kinetic energy ½ρ⟨|v′|²⟩ of the perturbation, J/m³.
    pub kinetic: f64,
    /// Work of the background flow, −∫ρ⟨v′·Γv′⟩dt, J/m³.
    pub background_work: f64,
    /// Work of the stress, −∫⟨qN : ∇v′⟩dt, J/m³.
    pub stress_work: f64,
    /// Internal power ⟨2Q_D q cos 2Δ⟩, W/m³, with the shear rate Q_D and Δ = ψ_D − ψ, the angle from the major
    /// principal stress to the major principal deformation rate.
    pub internal_power: f64,
}

/// State of a flow, sufficient to continue it bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowSnapshot {
    /// Number of steps done since time 0.
    pub steps: usize,
    /// Arrays of the solver in a fixed order: numbers of the step size control, state, pressure modes, eigenvector
    /// estimate of the power method.
    pub solver_arrays: Vec<Vec<f64>>,
}

/// State of the step size control.
#[derive(Clone, Debug)]
struct StepControl {
    /// Next step size, s; NaN if it must be estimated (before the first step and after perturbing).
    step: f64,
    /// Error of the last step with error control divided by its tolerance; 1 before the first one.
    error: f64,
    /// Estimated spectral radius of the equations, 1/s; NaN if it must be computed.
    spectral_radius: f64,
    /// Number of steps since the last estimate.
    steps_since_estimate: usize,
    /// Time of the last estimate, s.
    estimate_time: f64,
    /// Estimate of the dominant eigenvector, by the power method; empty before the first estimate.
    eigenvector: Vec<Complex64>,
}

/// Time-domain flow solver. It uses the thread pool of the caller; results do not depend on the number of threads.
pub struct FlowSolver {
    /// Right-hand side; between steps its point values are those of the present state.
    equations: FlowEquations,
    time: f64,
    steps: usize,
    /// Modes of the vorticity ζ, 1/s, then of the internal variable (ω or ψ), if any; then the works of the background
    /// flow (real part) and of the stress (imaginary part); then ω or ψ of the background flow.
    state: Vec<Complex64>,
    /// Time derivative of the state.
    rates: Vec<Complex64>,
    control: StepControl,
    /// Number of stages of the last step.
    stage_count: usize,
}

impl FlowSolver {
    /// Returns the unperturbed background flow; [`output_values`](Self::output_values) are defined after perturbing or
    /// restoring it.
    ///
    /// # Errors
    /// The first invalid parameter. Whether the background stress exists is checked by [`perturb`](Self::perturb).
    pub fn new(problem: &FlowProblem) -> Result<Self, FlowError> {
        problem.check_parameters()?;
        Ok(Self::from_checked_problem(problem.clone()))
    }

    /// Returns the unperturbed background flow of the same problem.
    pub(crate) fn to_unperturbed(&self) -> Self {
        Self::from_checked_problem(self.equations.problem().clone())
    }

    /// Returns the unperturbed background flow of a checked problem.
    fn from_checked_problem(problem: FlowProblem) -> Self {
        let closure = problem.closure;
        let background = match closure {
            Closure::HarrisGrekova => problem.spin,
            Closure::DoubleShearing | Closure::PlasticPotential => problem.stress_angle,
        };
        let equations = FlowEquations::new(problem);
        let size = equations.state_length();
        let mut flow = Self {
            equations,
            time: 0.0,
            steps: 0,
            state: vec![Complex64::ZERO; size],
            rates: vec![Complex64::ZERO; size],
            control: StepControl {
                step: f64::NAN,
                error: 1.0,
                spectral_radius: f64::NAN,
                steps_since_estimate: 0,
                estimate_time: 0.0,
                eigenvector: Vec::new(),
            },
            stage_count: 0,
        };
        flow.state[size - 1].re = background;
        if closure.internal_variable().is_some() {
            flow.state[flow.equations.series.mode_count()].re = background;
        }
        flow
    }

    /// Adds perturbations at the points (i + ½)L₁/N₁, (j + ½)L₂/N₂ (x₁ fastest), with edges L and numbers of points N
    /// of the box: of the velocity, m/s, and of ω, rad/s, or ψ, rad. The velocity is projected onto divergence-free
    /// fields, and both perturbations onto the resolved modes.
    ///
    /// # Errors
    /// The stress is undetermined at a point, or the pressure solution does not converge; fields are then unchanged.
    ///
    /// # Panics
    /// The number of values differs from the number of points; without internal variable, its values are ignored.
    pub fn perturb(
        &mut self,
        velocity: [&[f64]; 2],
        internal_variable: &[f64],
    ) -> Result<(), LeftDomain> {
        self.apply_or_restore(|flow| flow.add_perturbation(velocity, internal_variable))
    }

    /// Adds perturbations as [`perturb`](Self::perturb) does; if this fails, the fields are undefined.
    fn add_perturbation(
        &mut self,
        velocity: [&[f64]; 2],
        internal_variable: &[f64],
    ) -> Result<(), LeftDomain> {
        let count: usize = self.equations.problem().points.iter().product();
        assert!(velocity.iter().all(|own| own.len() == count), "a value for each point");
        let waves = self.equations.compute_wave_vectors(self.time);
        let series = &mut self.equations.series;
        let modes = velocity.map(|values| {
            let mut modes = vec![Complex64::ZERO; series.mode_count()];
            series.transform_forward(|point| values[point], &mut modes);
            modes
        });
        let stored = series.mode_count();
        let mut added = vec![Complex64::ZERO; stored];
        series.fill_modes(&mut added, &waves, |wave, i| {
            let [k1, k2] = wave.components;
            Complex64::I * (k1 * modes[1][i] - k2 * modes[0][i])
        });
        axpby(&mut self.state[..stored], 1.0, &added, 1.0);
        if self.equations.problem().closure.internal_variable().is_some() {
            assert_eq!(internal_variable.len(), count, "a value for each point");
            self.equations.series.transform_forward(|point| internal_variable[point], &mut added);
            axpby(&mut self.state[stored..2 * stored], 1.0, &added, 1.0);
        }
        self.control.step = f64::NAN;
        self.control.spectral_radius = f64::NAN;
        self.equations.compute_rates(self.time, &self.state, &mut self.rates)
    }

    /// Makes one step of the size that the tolerance allows, at most to `until`, s; none if the flow is there already.
    ///
    /// # Errors
    /// A point has left the fully deforming region, or no step meets the tolerance; the state is then unchanged.
    pub fn advance(&mut self, until: f64) -> Result<(), LeftDomain> {
        self.advance_with(until, &mut |_| {})
    }

    /// Makes one step as [`advance`](Self::advance) does, and calls `on_evaluation` before each evaluation of the
    /// right-hand side with the time of the evaluation, s. A step on a large grid may take minutes.
    ///
    /// # Errors
    /// See [`advance`](Self::advance).
    pub fn advance_with(
        &mut self,
        until: f64,
        on_evaluation: EvaluationCallback,
    ) -> Result<(), LeftDomain> {
        if until <= self.time {
            return Ok(());
        }
        self.apply_or_restore(|flow| flow.step_towards(until, on_evaluation))
    }

    /// Makes a step of size `step`, s, without error control, with at least `min_stages` stages.
    ///
    /// # Errors
    /// See [`advance`](Self::advance); or the step requires more than the maximum number of stages.
    pub fn advance_by(&mut self, step: f64, min_stages: usize) -> Result<(), LeftDomain> {
        self.apply_or_restore(|flow| {
            flow.update_spectral_radius(&mut |_| {})?;
            let end = flow.time + step;
            let (state, rates, _) = flow.try_step(step, end, min_stages, &mut |_| {})?;
            flow.accept_step(state, rates, end);
            Ok(())
        })
    }

    /// Applies `action`; if it fails, restores the state and all point values.
    fn apply_or_restore(
        &mut self,
        action: impl FnOnce(&mut Self) -> Result<(), LeftDomain>,
    ) -> Result<(), LeftDomain> {
        let (state, pressure) = (self.state.clone(), self.equations.pressure.clone());
        action(self).inspect_err(|_| {
            (self.state, self.equations.pressure) = (state, pressure);
            // Fails only if the stress was undetermined before.
            let _ = self.equations.compute_rates(self.time, &self.state, &mut self.rates);
        })
    }

    /// Makes the result of a step the present state; `time`: end of the step, s.
    fn accept_step(&mut self, state: Vec<Complex64>, rates: Vec<Complex64>, time: f64) {
        (self.state, self.rates, self.time) = (state, rates, time);
        (self.steps, self.control.steps_since_estimate) =
            (self.steps + 1, self.control.steps_since_estimate + 1);
    }

    /// Makes one step towards the time `until`, s, as [`advance_with`](Self::advance_with) does; if this fails, the
    /// state is undefined.
    fn step_towards(
        &mut self,
        until: f64,
        on_evaluation: EvaluationCallback,
    ) -> Result<(), LeftDomain> {
        let remaining_time = until - self.time;
        if self.control.step.is_nan() {
            self.control.spectral_radius = self.estimate_spectral_radius(on_evaluation)?;
            self.control.step = self.estimate_first_step(remaining_time, on_evaluation)?;
        }
        self.update_spectral_radius(on_evaluation)?;
        let start = self.equations.pressure.clone();
        let (mut reductions, mut last_left) = (0, None);
        loop {
            // In a step the box deforms by at most `MAX_STEP_SHEAR`. The remaining time is divided into equal steps, to
            // avoid a very short last one.
            let step_shear =
                (self.time - self.control.estimate_time) * self.gradient_norm() + MAX_STEP_SHEAR;
            let fastest = self.control.spectral_radius * (2.0 * step_shear).cr_exp();
            let longest = self
                .control
                .step
                .min(MAX_STEP_SHEAR / self.gradient_norm())
                .min(0.9 * stability_limit(MAX_STAGES) / fastest);
            let step = remaining_time / (remaining_time / longest).ceil().max(1.0);
            let end = if step == remaining_time { until } else { self.time + step };
            if end <= self.time {
                // Report the point whose failure made the steps this short, if any.
                let limiting_failure =
                    || self.error_without_position("a step is below the rounding of the time");
                return Err(last_left.unwrap_or_else(limiting_failure));
            }
            match self.try_step(step, end, 0, on_evaluation) {
                Ok((state, rates, error)) if error <= 1.0 => {
                    let factor = 0.8
                        * error.max(1e-6).cr_powf(-1.0 / 3.0)
                        * (self.control.error.max(1e-3) / error.max(1e-3)).cr_powf(0.1);
                    // A step shortened to end at `until` must not reduce the next step size.
                    let next = step * factor.clamp(0.1, 5.0);
                    self.control.step = if step < longest { next.max(longest) } else { next };
                    self.control.error = error;
                    self.accept_step(state, rates, end);
                    return Ok(());
                }
                Ok((.., error)) if error.is_finite() => {
                    self.control.step = step * (0.8 * error.cr_powf(-1.0 / 3.0)).clamp(0.1, 0.8);
                }
                Ok(_) if reductions >= MAX_STEP_REDUCTIONS => {
                    return Err(self.error_without_position("no step has finite values"));
                }
                Err(left) if reductions >= MAX_STEP_REDUCTIONS => return Err(left),
                Err(left) => {
                    last_left = Some(left);
                    self.control.step = 0.25 * step;
                }
                Ok(_) => self.control.step = 0.25 * step,
            }
            reductions += 1;
            self.equations.pressure.copy_from_slice(&start);
            // Near the boundary of the fully deforming region the estimate itself may fail.
            if self.control.steps_since_estimate > 0
                && let Ok(rate) = self.estimate_spectral_radius(on_evaluation)
            {
                self.control.spectral_radius = rate;
            }
            self.equations.pressure.copy_from_slice(&start);
        }
    }

    /// Creates the error of a failure that concerns no single point.
    fn error_without_position(&self, description: &str) -> LeftDomain {
        LeftDomain { description: description.to_owned(), position: None, time: self.time }
    }

    /// Computes a step of size `step`, s, that ends at time `end`, s. Returns state and time derivative after it, and
    /// the error estimate divided by its tolerance.
    fn try_step(
        &mut self,
        step: f64,
        end: f64,
        min_stages: usize,
        on_evaluation: EvaluationCallback,
    ) -> Result<(Vec<Complex64>, Vec<Complex64>, f64), LeftDomain> {
        // Decay rates depend on length and direction of the wave vectors, which change at the rate |Γ| at most: the
        // spectral radius grows by a factor exp(2|Γ|t) at most.
        let elapsed = end - self.control.estimate_time;
        let product =
            step * self.control.spectral_radius * (2.0 * self.gradient_norm() * elapsed).cr_exp();
        self.stage_count = required_stages(product).max(min_stages);
        if self.stage_count > MAX_STAGES {
            return Err(self.error_without_position(&format!(
                "a step of {step:e} s asks for too many stages"
            )));
        }
        let mut last = self.state.clone();
        let mut before = last.clone();
        let mut rates = self.rates.clone();
        let mut time = self.time;
        for (index, stage) in compute_coefficients(self.stage_count).into_iter().enumerate() {
            if index > 0 {
                on_evaluation(time);
                self.equations.compute_rates(time, &last, &mut rates)?;
            }
            // The stage vector Yⱼ overwrites Yⱼ₋₂.
            if index == 0 {
                axpby(&mut last, 1.0, &rates, step * stage.mu_tilde);
            } else {
                axpby(&mut before, stage.nu, &last, stage.mu);
                axpby(&mut before, 1.0, &self.state, 1.0 - stage.mu - stage.nu);
                axpby(&mut before, 1.0, &rates, step * stage.mu_tilde);
                axpby(&mut before, 1.0, &self.rates, step * stage.gamma_tilde);
                std::mem::swap(&mut last, &mut before);
            }
            time = self.time + step * stage.time;
        }
        on_evaluation(end);
        self.equations.compute_rates(end, &last, &mut rates)?;
        // Error estimate 0.8 (y − y⁺) + 0.4 h (y′ + y⁺′) of a step of size h from state y to y⁺ (Sommeijer, Shampine &
        // Verwer 1998).
        before.copy_from_slice(&self.state);
        axpby(&mut before, 0.8, &last, -0.8);
        axpby(&mut before, 1.0, &self.rates, 0.4 * step);
        axpby(&mut before, 1.0, &rates, 0.4 * step);
        let allowed = self.error_tolerance(&self.state).max(self.error_tolerance(&last));
        Ok((last, rates, self.norm(&before) / allowed))
    }

    /// Returns the shear rate Q_D of the background flow, 1/s.
    fn shear_rate(&self) -> f64 {
        gradient_shear_rate(self.equations.problem().velocity_gradient)
    }

    /// Returns |Γ| = Q_D + |s₂₁| (shear rate plus magnitude of half the vorticity), an upper bound of the relative rate
    /// of change of wave vectors, 1/s.
    fn gradient_norm(&self) -> f64 {
        let gradient = self.equations.problem().velocity_gradient;
        self.shear_rate() + closure::Deformation::new(gradient).half_vorticity.abs()
    }

    /// Computes the root of the sum of the mean squares of ζ and of ω or 2Q_D ψ over the box, 1/s.
    fn norm(&self, state: &[Complex64]) -> f64 {
        let series = &self.equations.series;
        let unit = match self.equations.problem().closure {
            Closure::DoubleShearing => 2.0 * self.shear_rate(),
            _ => 1.0,
        };
        let fields = state[..state.len() - 2].chunks(series.mode_count());
        let squares =
            fields.zip([1.0, unit]).map(|(own, unit)| unit * unit * series.mean_product(own, own));
        squares.sum::<f64>().sqrt()
    }

    /// Computes the error tolerance of a step to this state, 1/s: the relative tolerance times the norm of the
    /// perturbation, plus rounding.
    fn error_tolerance(&self, state: &[Complex64]) -> f64 {
        let mut perturbation = state.to_vec();
        let count = self.equations.series.mode_count();
        if perturbation.len() > count + 2 {
            perturbation[count].re -= state[state.len() - 1].re;
        }
        let tolerance = self.equations.problem().tolerance;
        tolerance * self.norm(&perturbation)
            + STEP_ROUNDING * (self.norm(state) + self.shear_rate())
    }

    /// Updates the estimate of the spectral radius if it is outdated.
    fn update_spectral_radius(
        &mut self,
        on_evaluation: EvaluationCallback,
    ) -> Result<(), LeftDomain> {
        let StepControl { spectral_radius, steps_since_estimate, estimate_time, .. } = self.control;
        let sheared = (self.time - estimate_time) * self.gradient_norm();
        if spectral_radius.is_nan()
            || steps_since_estimate >= SPECTRAL_RADIUS_STEPS
            || sheared > SPECTRAL_RADIUS_SHEAR
        {
            self.control.spectral_radius = self.estimate_spectral_radius(on_evaluation)?;
        }
        Ok(())
    }

    /// Estimates the spectral radius, 1/s, by the nonlinear power method (finite differences), with a safety factor of
    /// 1.2.
    fn estimate_spectral_radius(
        &mut self,
        on_evaluation: EvaluationCallback,
    ) -> Result<f64, LeftDomain> {
        const MAX_ITERATIONS: usize = 50;
        let start = self.equations.pressure.clone();
        let (time, size) = (self.time, 1e-6 * self.shear_rate());
        if self.control.eigenvector.is_empty() {
            // Start vector: equal amplitudes in all modes, scattered phases.
            self.control.eigenvector = (0..self.state.len() as u64)
                .map(|index| cr_cis((index * index % 1_000_003) as f64))
                .collect();
        }
        let mut direction = std::mem::take(&mut self.control.eigenvector);
        let mut rates = vec![Complex64::ZERO; self.state.len()];
        let mut rate = 0.0;
        for round in 0..MAX_ITERATIONS {
            let size_of_fields = direction.len() - 2;
            direction[size_of_fields..].fill(Complex64::ZERO);
            let norm = self.norm(&direction);
            let mut state = self.state.clone();
            axpby(&mut state, 1.0, &direction, size / norm);
            on_evaluation(time);
            self.equations.compute_rates(time, &state, &mut rates)?;
            axpby(&mut rates, 1.0, &self.rates, -1.0);
            let found = self.norm(&rates) / size;
            if found > 0.0 {
                std::mem::swap(&mut direction, &mut rates);
            }
            let is_settled = round > 1 && (found - rate).abs() <= 0.01 * found;
            rate = found;
            if is_settled || found == 0.0 {
                break;
            }
        }
        self.control.eigenvector = direction;
        (self.control.steps_since_estimate, self.control.estimate_time) = (0, time);
        self.equations.pressure.copy_from_slice(&start);
        if !rate.is_finite() {
            return Err(self.error_without_position("rates that are not finite"));
        }
        // Lower bound: 1.2 times the shear rate of the background flow.
        Ok(1.2 * rate.max(self.shear_rate()))
    }

    /// Estimates the first step size, s, from the change of the time derivative over a short Euler step.
    fn estimate_first_step(
        &mut self,
        rest: f64,
        on_evaluation: EvaluationCallback,
    ) -> Result<f64, LeftDomain> {
        let start = self.equations.pressure.clone();
        let step = rest.min(1.0 / self.control.spectral_radius);
        let mut state = self.state.clone();
        axpby(&mut state, 1.0, &self.rates, step);
        let mut rates = vec![Complex64::ZERO; state.len()];
        // If the Euler step leaves the fully deforming region, the first step is reduced later.
        on_evaluation(self.time + step);
        if self.equations.compute_rates(self.time + step, &state, &mut rates).is_ok() {
            axpby(&mut rates, step, &self.rates, -step);
            let error = self.norm(&rates) / self.error_tolerance(&self.state);
            self.equations.pressure.copy_from_slice(&start);
            return Ok(rest.min(step * 0.1 / error.max(1e-8).sqrt()));
        }
        self.equations.pressure.copy_from_slice(&start);
        Ok(step)
    }

    /// Returns the time of the present state, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Returns the number of steps done since time 0.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Returns the number of stages of the last step.
    pub fn stage_count(&self) -> usize {
        self.stage_count
    }

    /// Returns the number of evaluations of the right-hand side, and the total number of iterations for the pressure.
    pub fn evaluation_counts(&self) -> [usize; 2] {
        self.equations.evaluation_counts
    }

    /// Returns the relative residual of the last pressure solution.
    pub fn pressure_residual(&self) -> f64 {
        self.equations.pressure_residual
    }
}
