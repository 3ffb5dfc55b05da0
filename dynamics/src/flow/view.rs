//! Output of a flow: fields, energies, modes; saving and restoring its state.

use super::equations::exponential;
use super::spectral::Mode;
use super::{Closure, Control, Energy, Field, Flow, Snapshot};
use models::common::elementary::Elementary;
use num_complex::Complex64;

impl Flow {
    /// Returns the deformation gradient F = exp(Γt): the point y of the initial box is now at Fy.
    pub fn deformation(&self) -> [[f64; 2]; 2] {
        exponential(self.equations.problem().velocity_gradient, self.time)
    }

    /// Returns the output fields, velocities first.
    pub fn fields(&self) -> Vec<Field> {
        self.equations.problem().closure.fields()
    }

    /// Returns the values of all [`fields`](Self::fields) at the points (x₁ fastest).
    pub fn values(&self) -> Vec<Vec<f64>> {
        let points = &self.equations.points;
        let value = |field: &Field| match field {
            Field::Velocity(axis) => points.velocity[*axis].clone(),
            Field::Spin => points.internal_variable.clone(),
            Field::StressAngle if self.equations.problem().closure == Closure::DoubleShearing => {
                points.internal_variable.clone()
            }
            Field::StressAngle => {
                let [cos, sin] = &points.direction;
                cos.iter().zip(sin).map(|(cos, sin)| 0.5 * sin.cr_atan2(*cos)).collect()
            }
            Field::Pressure => {
                points.pressure.iter().map(|p| self.equations.problem().pressure + p).collect()
            }
            Field::ShearRate => points.shear_rates(),
        };
        self.fields().iter().map(value).collect()
    }

    /// Computes the energy of the perturbation and the works.
    pub fn energy(&self) -> Energy {
        let works = self.state[self.state.len() - 2];
        Energy {
            kinetic: self.shells().iter().map(|own| own.1).sum(),
            background: works.re,
            stress: works.im,
            power: self.equations.powers.internal,
        }
    }

    /// Computes |m| and the kinetic energy, J/m³, of each stored mode together with its conjugate.
    fn shells(&self) -> Vec<(f64, f64)> {
        let waves = self.equations.waves(self.time);
        let series = &self.equations.series;
        let of_mode = |index: usize| {
            let mode = series.mode(index);
            let [first, second] = mode.map(f64::from);
            let [k1, k2] = waves.vector(mode);
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
        (0..series.count()).map(of_mode).collect()
    }

    /// Computes the kinetic energy by shells n − ½ ≤ |m| < n + ½, n = 1, 2, …, J/m³; modes beyond the last shell are
    /// added to it.
    pub fn spectrum(&self) -> Vec<f64> {
        let most = self.equations.series.greatest().into_iter().max().unwrap_or(1);
        let mut shells = vec![0.0; most];
        for (number, energy) in self.shells() {
            let shell = (number + 0.5).floor() as usize;
            shells[shell.clamp(1, most) - 1] += energy;
        }
        shells
    }

    /// Returns the largest mode numbers m₁ and m₂ that are resolved.
    pub fn greatest_modes(&self) -> [usize; 2] {
        self.equations.series.greatest()
    }

    /// Computes the present wave vector of a mode, 1/m.
    pub fn wave_vector(&self, mode: Mode) -> [f64; 2] {
        self.equations.waves(self.time).vector(mode)
    }

    /// Returns the amplitudes of mode m, of exp(ik·y) with y from the first point: of the vorticity ζ, 1/s, and of ω or
    /// ψ; then their time derivatives. `None` if the mode is not resolved.
    pub fn mode(&self, mode: Mode) -> Option<[[Complex64; 2]; 2]> {
        let series = &self.equations.series;
        let (index, is_conjugate) = match series.index(mode) {
            Some(index) => (index, false),
            None => (series.index(mode.map(|m| -m))?, true),
        };
        let of = |values: &[Complex64]| {
            let pick = |offset: usize| match values[..values.len() - 2].get(offset + index) {
                Some(value) if is_conjugate => value.conj(),
                Some(value) => *value,
                None => Complex64::ZERO,
            };
            [pick(0), pick(series.count())]
        };
        Some([of(&self.state), of(&self.rates)])
    }

    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> Snapshot {
        let flat = |values: &[Complex64]| values.iter().flat_map(|v| [v.re, v.im]).collect();
        let control = &self.control;
        let numbers = vec![
            self.time,
            control.step,
            control.error,
            control.rate,
            control.age as f64,
            control.looked,
        ];
        Snapshot {
            steps: self.steps,
            parts: vec![
                numbers,
                flat(&self.state),
                flat(&self.equations.pressure),
                flat(&control.direction),
            ],
        }
    }

    /// Restores a snapshot; `false` if it belongs to another problem.
    pub fn restore(&mut self, snapshot: &Snapshot) -> bool {
        let [numbers, state, pressure, direction] = snapshot.parts.as_slice() else { return false };
        let [time, step, error, rate, age, looked] = numbers.as_slice() else { return false };
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
        self.control = Control {
            step: *step,
            error: *error,
            rate: *rate,
            age: *age as usize,
            looked: *looked,
            direction: complex(direction),
        };
        // Succeeds, since the stress of a saved state exists.
        self.equations.rates(self.time, &self.state, &mut self.rates).is_ok()
    }
}
