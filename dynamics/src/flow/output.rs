//! Output of a flow: fields, energies, modes; saving and restoring its state.

use super::equations::matrix_exponential;
use super::spectral::{ModeNumbers, basis_wave_vectors, combine_basis};
use super::{Closure, FlowEnergy, FlowField, FlowSnapshot, FlowSolver, StepControl};
use models::common::elementary::Elementary;
use num_complex::Complex64;

impl FlowSolver {
    /// Returns the deformation gradient F = exp(Γt): the point y of the initial box is now at Fy.
    pub fn deformation_gradient(&self) -> [[f64; 2]; 2] {
        matrix_exponential(self.equations.problem().velocity_gradient, self.time)
    }

    /// Returns the output fields, velocities first.
    pub fn output_fields(&self) -> Vec<FlowField> {
        self.equations.problem().closure.output_fields()
    }

    /// Returns the values of all [`output_fields`](Self::output_fields) at the points (x₁ fastest).
    pub fn output_values(&self) -> Vec<Vec<f64>> {
        let points = &self.equations.points;
        let value = |field: &FlowField| match field {
            FlowField::Velocity(axis) => points.velocity[*axis].clone(),
            FlowField::Spin => points.internal_variable.clone(),
            FlowField::StressAngle
                if self.equations.problem().closure == Closure::DoubleShearing =>
            {
                points.internal_variable.clone()
            }
            FlowField::StressAngle => {
                let [cos, sin] = &points.stress_double_angle;
                cos.iter().zip(sin).map(|(cos, sin)| 0.5 * sin.cr_atan2(*cos)).collect()
            }
            FlowField::Pressure => {
                points.pressure.iter().map(|p| self.equations.problem().pressure + p).collect()
            }
            FlowField::ShearRate => points.shear_rates(),
        };
        self.output_fields().iter().map(value).collect()
    }

    /// Computes the energy of the perturbation and the works.
    pub fn energy(&self) -> FlowEnergy {
        let works = self.state[self.state.len() - 2];
        FlowEnergy {
            kinetic: self.mode_energies().iter().map(|own| own.1).sum(),
            background_work: works.re,
            stress_work: works.im,
            internal_power: self.equations.powers.internal,
        }
    }

    /// Computes |m| and the kinetic energy, J/m³, of each stored mode m; the energy includes that of −m if −m is not
    /// stored.
    fn mode_energies(&self) -> Vec<(f64, f64)> {
        let waves = self.equations.compute_wave_vectors(self.time);
        let series = &self.equations.series;
        let energy_of_mode = |index: usize| {
            let mode = series.mode(index);
            let [first, second] = mode.map(f64::from);
            let [k1, k2] = waves.wave_vector(mode);
            let square = k1 * k1 + k2 * k2;
            let share = if first == 0.0 { 0.5 } else { 1.0 };
            let energy = match square {
                0.0 => 0.0,
                _ => {
                    share * self.equations.problem().density * self.state[index].norm_sqr() / square
                }
            };
            (first.root_sum_square(second), energy)
        };
        (0..series.mode_count()).map(energy_of_mode).collect()
    }

    /// Computes the kinetic energy, J/m³, by shells n − ½ ≤ |m| < n + ½ of the mode numbers m, n = 1, 2, …; modes
    /// beyond the last shell are added to that shell.
    pub fn energy_spectrum(&self) -> Vec<f64> {
        let shell_count = self.equations.series.max_modes().into_iter().max().unwrap_or(1);
        let mut shells = vec![0.0; shell_count];
        for (number, energy) in self.mode_energies() {
            let shell = (number + 0.5).floor() as usize;
            shells[shell.clamp(1, shell_count) - 1] += energy;
        }
        shells
    }

    /// Returns the largest mode numbers m₁ and m₂ that are resolved.
    pub fn max_modes(&self) -> [usize; 2] {
        self.equations.series.max_modes()
    }

    /// Computes the present wave vector of a mode, 1/m.
    pub fn wave_vector(&self, mode: ModeNumbers) -> [f64; 2] {
        let lengths = self.equations.problem().lengths;
        combine_basis(basis_wave_vectors(lengths, self.deformation_gradient()), mode)
    }

    /// Returns the amplitudes of mode m, the factors of exp(ik·y) with the initial wave vector k and the position y in
    /// the initial box, measured from the first point: of the vorticity ζ, 1/s, and of ω or ψ (zero without internal
    /// variable); then their time derivatives. `None` if the mode is not resolved.
    pub fn mode_amplitudes(&self, mode: ModeNumbers) -> Option<[[Complex64; 2]; 2]> {
        let series = &self.equations.series;
        let (index, is_conjugate) = match series.mode_index(mode) {
            Some(index) => (index, false),
            None => (series.mode_index(mode.map(|m| -m))?, true),
        };
        let amplitudes = |values: &[Complex64]| {
            let amplitude = |offset: usize| match values[..values.len() - 2].get(offset + index) {
                Some(value) if is_conjugate => value.conj(),
                Some(value) => *value,
                None => Complex64::ZERO,
            };
            [amplitude(0), amplitude(series.mode_count())]
        };
        Some([amplitudes(&self.state), amplitudes(&self.rates)])
    }

    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> FlowSnapshot {
        let flat = |values: &[Complex64]| values.iter().flat_map(|v| [v.re, v.im]).collect();
        let control = &self.control;
        let numbers = vec![
            self.time,
            control.step,
            control.error,
            control.spectral_radius,
            control.steps_since_estimate as f64,
            control.estimate_time,
        ];
        FlowSnapshot {
            steps: self.steps,
            solver_arrays: vec![
                numbers,
                flat(&self.state),
                flat(&self.equations.pressure),
                flat(&control.eigenvector),
            ],
        }
    }

    /// Restores a snapshot; `false` if it belongs to another problem.
    pub fn restore(&mut self, snapshot: &FlowSnapshot) -> bool {
        let [numbers, state, pressure, direction] = snapshot.solver_arrays.as_slice() else {
            return false;
        };
        let [time, step, error, rate, steps_since_estimate, estimate_time] = numbers.as_slice()
        else {
            return false;
        };
        let lengths = [2 * self.state.len(), 2 * self.equations.pressure.len()];
        let fits = [state.len(), pressure.len()] == lengths
            && (direction.is_empty() || direction.len() == lengths[0]);
        if !fits {
            return false;
        }
        let complex = |values: &[f64]| -> Vec<Complex64> {
            values.as_chunks().0.iter().map(|[re, im]| Complex64::new(*re, *im)).collect()
        };
        (self.time, self.steps, self.state) = (*time, snapshot.steps, complex(state));
        self.equations.pressure = complex(pressure);
        self.control = StepControl {
            step: *step,
            error: *error,
            spectral_radius: *rate,
            steps_since_estimate: *steps_since_estimate as usize,
            estimate_time: *estimate_time,
            eigenvector: complex(direction),
        };
        // Succeeds, since the stress of a saved state exists.
        self.equations.compute_rates(self.time, &self.state, &mut self.rates).is_ok()
    }
}
