//! Time-domain granular flow: the equations of Harris & Grekova (2005) and related models, ν = 0, in a periodic box
//! that deforms with a homogeneous flow Γx.
//!
//! - [`Closure`]: equation for the stress angle; `equations`: right-hand side, from the balance laws;
//! - `pressure`: equation for the pressure, from the incompressibility constraint;
//! - [`spectral`]: Fourier series in the box, whose wave vectors k(t) = exp(−Γᵀt) k₀ deform with it;
//! - [`perturbation`]: initial perturbations;
//! - `chebyshev`: Runge–Kutta–Chebyshev coefficients; [`Flow`] chooses the number of stages and the step size.
//!
//! The body force that maintains Γ is (Γ² − ½ tr Γ²) x = 0, since Γ² = −det Γ I for traceless Γ; the remaining force
//! −det Γ x is curl-free. A steady spin requires the uniform body moment −2r/ρ of the rotational stress r.

mod chebyshev;
mod closure;
mod equations;
pub mod perturbation;
mod pressure;
pub mod spectral;
mod view;

use chebyshev::{scheme, stability_limit, stages};
pub use closure::Closure;
use equations::Equations;
use models::common::elementary::{Elementary, cr_cis};
use num_complex::Complex64;
use pressure::combine;

/// Maximum number of stages of a step.
const MAX_STAGES: usize = 2000;
/// Number of steps, and deformation of the box, after which the spectral radius is estimated again.
const LOOK: (usize, f64) = (25, 0.02);
/// Maximum number of successive reductions of a step.
const MAX_CUTS: usize = 20;
/// Maximum deformation of the box in a step, Δt |Γ|.
const SHEAR: f64 = 0.25;
/// Rounding error of a step relative to the norm of the state.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// A field of a flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// A component of v − Γx, m/s.
    Velocity(usize),
    /// The spin ω, rad/s.
    Spin,
    /// Angle ψ of the major principal stress from x₁, rad; in (−π/2, π/2] unless it is an evolving variable.
    StressAngle,
    /// The pressure p, Pa.
    Pressure,
    /// The magnitude Q_D of the deviatoric deformation rate, 1/s.
    ShearRate,
}

/// A homogeneous flow and the box in which it is perturbed; SI units, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// Equation for the stress angle.
    pub closure: Closure,
    /// Density ρ, kg/m³; > 0.
    pub density: f64,
    /// Friction angle φ, rad; in (0, π/2).
    pub friction_angle: f64,
    /// e_r/c_r of the flow rule (sin φ in double shearing at constant volume): sin 2(ψ − ψ_D) is this ratio times the
    /// relative rotation (ω − s₂₁)/Q_D. Unused by coaxial models.
    pub rotation_ratio: f64,
    /// Cohesion c, Pa; ≥ 0.
    pub cohesion: f64,
    /// Mean pressure P₀, Pa; > −c cot φ.
    pub pressure: f64,
    /// Velocity gradient Γ, entry \[i\]\[j\] = ∂ⱼVᵢ, 1/s; traceless, with non-zero deformation rate.
    pub velocity_gradient: [[f64; 2]; 2],
    /// Initial stress angle Ψ of the background, rad.
    pub stress_angle: f64,
    /// Initial spin Ω of the background, rad/s (Harris–Grekova only).
    pub spin: f64,
    /// DΩ/Dt, rad/s² (Harris–Grekova only).
    pub spin_acceleration: f64,
    /// Number of points along each axis of the box; even, at least 4.
    pub points: [usize; 2],
    /// Initial edge lengths of the box along x₁ and x₂, m.
    pub lengths: [f64; 2],
    /// Maximum error of a step relative to the norm of the perturbation.
    pub tolerance: f64,
    /// Maximum residual of the pressure equation relative to its right-hand side.
    pub pressure_tolerance: f64,
    /// Q_D relative to that of the background below which a run ends (plastic potential only).
    pub least_shear_rate: f64,
}

/// An invalid problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// Too few points, or an odd number of them.
    #[error("{0:?} points: an even number of at least 4 is needed along each axis")]
    Points([usize; 2]),
    /// A parameter out of its range.
    #[error("{name} cannot be {value}")]
    Number {
        /// Name of the parameter.
        name: &'static str,
        /// Value of the parameter.
        value: f64,
    },
    /// A background flow that changes volume or does not deform.
    #[error("the velocity gradient {0:?} must have trace 0 and deform")]
    Gradient([[f64; 2]; 2]),
}

impl Problem {
    /// Checks all parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), FlowError> {
        if self.points.iter().any(|points| *points < 4 || points % 2 == 1) {
            return Err(FlowError::Points(self.points));
        }
        let positive = [
            ("the density", self.density),
            ("the friction angle", self.friction_angle),
            ("the length of the box", self.lengths[0]),
            ("the length of the box", self.lengths[1]),
            ("the tolerance", self.tolerance),
            ("the tolerance of the pressure", self.pressure_tolerance),
            ("the deviatoric stress", self.deviator()),
            ("the cosine of the friction angle", self.friction_angle.cr_cos()),
        ];
        let finite = [
            ("the ratio of the flow rule", self.rotation_ratio),
            ("the cohesion", self.cohesion),
            ("the stress angle", self.stress_angle),
            ("the spin", self.spin),
            ("the spin's acceleration", self.spin_acceleration),
            ("the least shear rate", self.least_shear_rate),
        ];
        let odd = positive.iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        if let Some(&(name, value)) = odd.or(finite.iter().find(|own| !own.1.is_finite())) {
            return Err(FlowError::Number { name, value });
        }
        let gradient = self.velocity_gradient;
        let rate = shear_rate_of(gradient);
        let trace = gradient[0][0] + gradient[1][1];
        if !(rate > 0.0 && rate.is_finite() && trace.abs() <= 1e-12 * rate) {
            return Err(FlowError::Gradient(gradient));
        }
        Ok(())
    }

    /// Returns the deviatoric stress q of the background, Pa.
    fn deviator(&self) -> f64 {
        self.pressure * self.friction_angle.cr_sin() + self.cohesion * self.friction_angle.cr_cos()
    }
}

/// Computes Q_D of a velocity gradient, 1/s.
fn shear_rate_of(gradient: [[f64; 2]; 2]) -> f64 {
    closure::Deformation::new(gradient).shear_rate()
}

/// A point has left the fully deforming region, or the equations have no solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what}")]
pub struct Left {
    /// Description with values.
    pub what: String,
    /// Position in the initial box, m; `None` if no single point is concerned.
    pub at: Option<[f64; 2]>,
    /// Time, s.
    pub time: f64,
}

/// Energy of the perturbation and works since time 0 per volume, J/m³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy ½ρ⟨|v′|²⟩.
    pub kinetic: f64,
    /// Work of the background flow, −∫ρ⟨v′·Γv′⟩dt.
    pub background: f64,
    /// Work of the stress, −∫⟨qN : ∇v′⟩dt.
    pub stress: f64,
    /// Internal power ⟨2Q_D q cos 2Δ⟩, W/m³.
    pub power: f64,
}

/// State of a flow, sufficient to continue it bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Number of steps done.
    pub steps: usize,
    /// Arrays in a fixed order: numbers of the step size control, state, pressure modes, direction of the power method.
    pub parts: Vec<Vec<f64>>,
}

/// Step size control.
#[derive(Clone, Debug)]
struct Control {
    /// Next step size, s; NaN before the first step.
    step: f64,
    /// Error of the last step divided by its tolerance.
    error: f64,
    /// Estimated spectral radius of the equations, 1/s; NaN if it must be computed.
    rate: f64,
    /// Number of steps since the last estimate.
    age: usize,
    /// Time of the last estimate, s.
    looked: f64,
    /// Eigenvector estimate of the power method.
    direction: Vec<Complex64>,
}

/// Time-domain flow. Uses the surrounding thread pool; results do not depend on the number of threads.
pub struct Flow {
    /// Right-hand side; between steps its point values are those of the state.
    equations: Equations,
    time: f64,
    steps: usize,
    /// Modes of ζ, then of ω or ψ; then works of background and stress; then ω or ψ of the background.
    state: Vec<Complex64>,
    /// Time derivative of the state.
    rates: Vec<Complex64>,
    control: Control,
    /// Number of stages of the last step.
    stages: usize,
}

impl Flow {
    /// The unperturbed background flow; [`values`](Self::values) are defined after perturbing or restoring it.
    ///
    /// # Errors
    /// The first invalid parameter. Whether the background stress exists is checked by [`perturb`](Self::perturb).
    pub fn new(problem: &Problem) -> Result<Self, FlowError> {
        problem.check()?;
        Ok(Self::background(problem.clone()))
    }

    /// Returns the unperturbed background flow of the same problem.
    pub(crate) fn unperturbed(&self) -> Self {
        Self::background(self.equations.problem().clone())
    }

    /// The background flow of a checked problem.
    fn background(problem: Problem) -> Self {
        let closure = problem.closure;
        let background = match closure {
            Closure::HarrisGrekova => problem.spin,
            Closure::DoubleShearing | Closure::PlasticPotential => problem.stress_angle,
        };
        let equations = Equations::new(problem);
        let size = equations.size();
        let mut flow = Self {
            equations,
            time: 0.0,
            steps: 0,
            state: vec![Complex64::ZERO; size],
            rates: vec![Complex64::ZERO; size],
            control: Control {
                step: f64::NAN,
                error: 1.0,
                rate: f64::NAN,
                age: 0,
                looked: 0.0,
                direction: Vec::new(),
            },
            stages: 0,
        };
        flow.state[size - 1].re = background;
        if closure.internal_variable().is_some() {
            flow.state[flow.equations.series.count()].re = background;
        }
        flow
    }

    /// Adds perturbations at the points (i + ½)L₁/N₁, (j + ½)L₂/N₂ (x₁ fastest): of the velocity, m/s, and of ω, rad/s,
    /// or ψ, rad. The velocity is projected onto divergence-free fields, and both onto the resolved modes.
    ///
    /// # Errors
    /// The stress is undetermined at a point; the flow is then unchanged.
    ///
    /// # Panics
    /// The number of values differs from the number of points.
    pub fn perturb(
        &mut self,
        velocity: [&[f64]; 2],
        internal_variable: &[f64],
    ) -> Result<(), Left> {
        self.apply_or_restore(|flow| flow.add(velocity, internal_variable))
    }

    fn add(&mut self, velocity: [&[f64]; 2], internal_variable: &[f64]) -> Result<(), Left> {
        let count: usize = self.equations.problem().points.iter().product();
        assert!(velocity.iter().all(|own| own.len() == count), "a value for each point");
        let waves = self.equations.waves(self.time);
        let series = &mut self.equations.series;
        let modes = velocity.map(|values| {
            let mut modes = vec![Complex64::ZERO; series.count()];
            series.forward(|point| values[point], &mut modes);
            modes
        });
        let stored = series.count();
        let mut added = vec![Complex64::ZERO; stored];
        series.fill(&mut added, &waves, |wave, i| {
            let [k1, k2] = wave.vector;
            Complex64::I * (k1 * modes[1][i] - k2 * modes[0][i])
        });
        combine(&mut self.state[..stored], 1.0, &added, 1.0);
        if self.equations.problem().closure.internal_variable().is_some() {
            assert_eq!(internal_variable.len(), count, "a value for each point");
            self.equations.series.forward(|point| internal_variable[point], &mut added);
            combine(&mut self.state[stored..2 * stored], 1.0, &added, 1.0);
        }
        self.control.step = f64::NAN;
        self.control.rate = f64::NAN;
        self.equations.rates(self.time, &self.state, &mut self.rates)
    }

    /// Makes one step of the size that the tolerance allows, at most to `until`, s.
    ///
    /// # Errors
    /// A point has left the fully deforming region, or no step meets the tolerance; the state is then unchanged.
    pub fn advance(&mut self, until: f64) -> Result<(), Left> {
        if until <= self.time {
            return Ok(());
        }
        self.apply_or_restore(|flow| flow.step_towards(until))
    }

    /// Makes a step of size `step`, s, without error control, with at least `least_stages` stages.
    ///
    /// # Errors
    /// See [`advance`](Self::advance); or the step requires more than the maximum number of stages.
    pub fn advance_by(&mut self, step: f64, least_stages: usize) -> Result<(), Left> {
        self.apply_or_restore(|flow| {
            flow.look()?;
            let end = flow.time + step;
            let (state, rates, _) = flow.try_step(step, end, least_stages)?;
            flow.accept(state, rates, end);
            Ok(())
        })
    }

    /// Applies `action`; if it fails, restores the state and all point values.
    fn apply_or_restore(
        &mut self,
        action: impl FnOnce(&mut Self) -> Result<(), Left>,
    ) -> Result<(), Left> {
        let (state, pressure) = (self.state.clone(), self.equations.pressure.clone());
        action(self).inspect_err(|_| {
            (self.state, self.equations.pressure) = (state, pressure);
            // Fails only if the stress was undetermined before.
            let _ = self.equations.rates(self.time, &self.state, &mut self.rates);
        })
    }

    fn accept(&mut self, state: Vec<Complex64>, rates: Vec<Complex64>, time: f64) {
        (self.state, self.rates, self.time) = (state, rates, time);
        (self.steps, self.control.age) = (self.steps + 1, self.control.age + 1);
    }

    fn step_towards(&mut self, until: f64) -> Result<(), Left> {
        let rest = until - self.time;
        if self.control.step.is_nan() {
            self.control.rate = self.greatest_rate()?;
            self.control.step = self.first_step(rest)?;
        }
        self.look()?;
        let start = self.equations.pressure.clone();
        let (mut cuts, mut last_left) = (0, None);
        loop {
            // The step ends before the box has deformed by `SHEAR`. The remaining time is divided into equal steps, to
            // avoid a very short last one.
            let sheared = (self.time - self.control.looked) * self.turning_rate() + SHEAR;
            let fastest = self.control.rate * (2.0 * sheared).cr_exp();
            let longest = self
                .control
                .step
                .min(SHEAR / self.turning_rate())
                .min(0.9 * stability_limit(MAX_STAGES) / fastest);
            let step = rest / (rest / longest).ceil().max(1.0);
            let end = if step == rest { until } else { self.time + step };
            if end <= self.time {
                // Report the point that made the steps this short, if any.
                let stuck = || self.stuck("a step is below the rounding of the time");
                return Err(last_left.unwrap_or_else(stuck));
            }
            match self.try_step(step, end, 0) {
                Ok((state, rates, error)) if error <= 1.0 => {
                    let factor = 0.8
                        * error.max(1e-6).cr_powf(-1.0 / 3.0)
                        * (self.control.error.max(1e-3) / error.max(1e-3)).cr_powf(0.1);
                    // A step shortened to end at `until` must not reduce the next step size.
                    let next = step * factor.clamp(0.1, 5.0);
                    self.control.step = if step < longest { next.max(longest) } else { next };
                    self.control.error = error;
                    self.accept(state, rates, end);
                    return Ok(());
                }
                Ok((.., error)) if error.is_finite() => {
                    self.control.step = step * (0.8 * error.cr_powf(-1.0 / 3.0)).clamp(0.1, 0.8);
                }
                Ok(_) if cuts >= MAX_CUTS => return Err(self.stuck("no step has finite values")),
                Err(left) if cuts >= MAX_CUTS => return Err(left),
                Err(left) => {
                    last_left = Some(left);
                    self.control.step = 0.25 * step;
                }
                Ok(_) => self.control.step = 0.25 * step,
            }
            cuts += 1;
            self.equations.pressure.copy_from_slice(&start);
            // Near the boundary of the fully deforming region the estimate itself may fail.
            if self.control.age > 0
                && let Ok(rate) = self.greatest_rate()
            {
                self.control.rate = rate;
            }
            self.equations.pressure.copy_from_slice(&start);
        }
    }

    /// Error without a position.
    fn stuck(&self, what: &str) -> Left {
        Left { what: what.to_owned(), at: None, time: self.time }
    }

    /// Returns state and time derivative after a step, and the error divided by its tolerance.
    fn try_step(
        &mut self,
        step: f64,
        end: f64,
        least_stages: usize,
    ) -> Result<(Vec<Complex64>, Vec<Complex64>, f64), Left> {
        // Decay rates depend on length and direction of the wave vectors, which change at the rate |Γ| at most: the
        // spectral radius grows by exp(2|Γ|t) at most.
        let ahead = end - self.control.looked;
        let product = step * self.control.rate * (2.0 * self.turning_rate() * ahead).cr_exp();
        self.stages = stages(product).max(least_stages);
        if self.stages > MAX_STAGES {
            return Err(self.stuck(&format!("a step of {step:e} s asks for too many stages")));
        }
        let mut last = self.state.clone();
        let mut before = last.clone();
        let mut rates = self.rates.clone();
        let mut time = self.time;
        for (index, stage) in scheme(self.stages).into_iter().enumerate() {
            if index > 0 {
                self.equations.rates(time, &last, &mut rates)?;
            }
            // Yⱼ overwrites Yⱼ₋₂.
            if index == 0 {
                combine(&mut last, 1.0, &rates, step * stage.rate);
            } else {
                combine(&mut before, stage.nu, &last, stage.mu);
                combine(&mut before, 1.0, &self.state, 1.0 - stage.mu - stage.nu);
                combine(&mut before, 1.0, &rates, step * stage.rate);
                combine(&mut before, 1.0, &self.rates, step * stage.first);
                std::mem::swap(&mut last, &mut before);
            }
            time = self.time + step * stage.time;
        }
        self.equations.rates(end, &last, &mut rates)?;
        // Error estimate 0.8 (y − y⁺) + 0.4 h (y′ + y⁺′) (Sommeijer, Shampine & Verwer 1998).
        before.copy_from_slice(&self.state);
        combine(&mut before, 0.8, &last, -0.8);
        combine(&mut before, 1.0, &self.rates, 0.4 * step);
        combine(&mut before, 1.0, &rates, 0.4 * step);
        let allowed = self.allowed(&self.state).max(self.allowed(&last));
        Ok((last, rates, self.norm(&before) / allowed))
    }

    /// Returns Q_D of the background, 1/s.
    fn shear_rate(&self) -> f64 {
        shear_rate_of(self.equations.problem().velocity_gradient)
    }

    /// Returns |Γ| = Q_D + |s₂₁|, an upper bound of the relative rate of change of wave vectors, 1/s.
    fn turning_rate(&self) -> f64 {
        let gradient = self.equations.problem().velocity_gradient;
        self.shear_rate() + closure::Deformation::new(gradient).half_vorticity.abs()
    }

    /// Computes the root-mean-square norm, 1/s; ψ is multiplied by 2Q_D.
    fn norm(&self, state: &[Complex64]) -> f64 {
        let series = &self.equations.series;
        let unit = match self.equations.problem().closure {
            Closure::DoubleShearing => 2.0 * self.shear_rate(),
            _ => 1.0,
        };
        let fields = state[..state.len() - 2].chunks(series.count());
        let squares =
            fields.zip([1.0, unit]).map(|(own, unit)| unit * unit * series.product(own, own));
        squares.sum::<f64>().sqrt()
    }

    /// Computes the error tolerance of a step to this state: relative to the perturbation, plus rounding.
    fn allowed(&self, state: &[Complex64]) -> f64 {
        let mut perturbation = state.to_vec();
        let count = self.equations.series.count();
        if perturbation.len() > count + 2 {
            perturbation[count].re -= state[state.len() - 1].re;
        }
        let tolerance = self.equations.problem().tolerance;
        tolerance * self.norm(&perturbation) + ROUNDING * (self.norm(state) + self.shear_rate())
    }

    /// Updates the estimate of the spectral radius if it is outdated.
    fn look(&mut self) -> Result<(), Left> {
        let Control { rate, age, looked, .. } = self.control;
        let (steps, shear) = LOOK;
        if rate.is_nan() || age >= steps || (self.time - looked) * self.turning_rate() > shear {
            self.control.rate = self.greatest_rate()?;
        }
        Ok(())
    }

    /// Estimates the spectral radius, 1/s, by the nonlinear power method (finite differences), with a safety factor of
    /// 1.2.
    fn greatest_rate(&mut self) -> Result<f64, Left> {
        const MOST: usize = 50;
        let start = self.equations.pressure.clone();
        let (time, size) = (self.time, 1e-6 * self.shear_rate());
        if self.control.direction.is_empty() {
            // Start vector: equal amplitudes in all modes, scattered phases.
            self.control.direction = (0..self.state.len() as u64)
                .map(|index| cr_cis((index * index % 1_000_003) as f64))
                .collect();
        }
        let mut direction = std::mem::take(&mut self.control.direction);
        let mut rates = vec![Complex64::ZERO; self.state.len()];
        let mut rate = 0.0;
        for round in 0..MOST {
            let size_of_fields = direction.len() - 2;
            direction[size_of_fields..].fill(Complex64::ZERO);
            let norm = self.norm(&direction);
            let mut state = self.state.clone();
            combine(&mut state, 1.0, &direction, size / norm);
            self.equations.rates(time, &state, &mut rates)?;
            combine(&mut rates, 1.0, &self.rates, -1.0);
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
        self.control.direction = direction;
        (self.control.age, self.control.looked) = (0, time);
        self.equations.pressure.copy_from_slice(&start);
        if !rate.is_finite() {
            return Err(self.stuck("rates that are not finite"));
        }
        // At least the rate of the background.
        Ok(1.2 * rate.max(self.shear_rate()))
    }

    /// Estimates the first step size, s, from the change of the time derivative along a short Euler step.
    fn first_step(&mut self, rest: f64) -> Result<f64, Left> {
        let start = self.equations.pressure.clone();
        let step = rest.min(1.0 / self.control.rate);
        let mut state = self.state.clone();
        combine(&mut state, 1.0, &self.rates, step);
        let mut rates = vec![Complex64::ZERO; state.len()];
        // If the Euler step leaves the fully deforming region, the first step is reduced later.
        if self.equations.rates(self.time + step, &state, &mut rates).is_ok() {
            combine(&mut rates, step, &self.rates, -step);
            let error = self.norm(&rates) / self.allowed(&self.state);
            self.equations.pressure.copy_from_slice(&start);
            return Ok(rest.min(step * 0.1 / error.max(1e-8).sqrt()));
        }
        self.equations.pressure.copy_from_slice(&start);
        Ok(step)
    }

    /// Returns the time, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Returns the number of steps done.
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Returns the number of stages of the last step.
    pub fn stages(&self) -> usize {
        self.stages
    }

    /// Returns the number of evaluations of the right-hand side and of all iterations for the pressure in them.
    pub fn effort(&self) -> [usize; 2] {
        self.equations.effort
    }

    /// Returns the relative residual of the last pressure solution.
    pub fn pressure_residual(&self) -> f64 {
        self.equations.residual
    }
}
