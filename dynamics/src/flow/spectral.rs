//! Fourier series on a rectangular box: resolved modes, wave vectors and transforms.
//!
//! Modes up to one third of the number of points are resolved along each axis (2/3 rule), so that products of two
//! series are free of aliasing. Of a real series the modes with m₁ ≥ 0 are stored, m₂ fastest: 0, 1, …, K₂, −K₂, …, −1.

use num_complex::Complex64;
use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Number of columns or rows per task: reads across them use whole cache lines.
const BLOCK: usize = 8;

/// A mode number along each axis.
pub type Mode = [i32; 2];

/// Resolved modes and their transforms.
pub struct Series {
    points: [usize; 2],
    /// Largest mode numbers K₁, K₂.
    greatest: [usize; 2],
    rows_forward: Arc<dyn RealToComplex<f64>>,
    rows_inverse: Arc<dyn ComplexToReal<f64>>,
    columns_forward: Arc<dyn Fft<f64>>,
    columns_inverse: Arc<dyn Fft<f64>>,
    /// Buffer: data transformed along one axis.
    half: Vec<Complex64>,
}

pub use models::common::fourier::greatest_modes;

impl Series {
    /// Series on `points` points along each axis: even, at least 4.
    pub fn new(points: [usize; 2]) -> Self {
        let mut real = RealFftPlanner::new();
        let mut complex = FftPlanner::new();
        let greatest = greatest_modes(points);
        Self {
            points,
            greatest,
            rows_forward: real.plan_fft_forward(points[0]),
            rows_inverse: real.plan_fft_inverse(points[0]),
            columns_forward: complex.plan_fft_forward(points[1]),
            columns_inverse: complex.plan_fft_inverse(points[1]),
            half: vec![Complex64::ZERO; (greatest[0] + 1) * points[1]],
        }
    }

    /// Number of points along each axis.
    pub fn points(&self) -> [usize; 2] {
        self.points
    }

    /// Largest mode number along each axis.
    pub fn greatest(&self) -> [usize; 2] {
        self.greatest
    }

    /// Number of stored modes for each m₁.
    pub fn column(&self) -> usize {
        2 * self.greatest[1] + 1
    }

    /// Number of stored modes.
    pub fn count(&self) -> usize {
        (self.greatest[0] + 1) * self.column()
    }

    /// Returns the mode with a storage index.
    pub fn mode(&self, index: usize) -> Mode {
        let (column, place) = (index / self.column(), index % self.column());
        let wraps = place > self.greatest[1];
        [column as i32, place as i32 - if wraps { self.column() as i32 } else { 0 }]
    }

    /// Returns the storage index of a mode: `None` if it is unresolved or only its conjugate, −m, is stored.
    pub fn index(&self, [first, second]: Mode) -> Option<usize> {
        let [most, across] = self.greatest.map(|greatest| greatest as i32);
        let is_kept = (0..=most).contains(&first) && second.abs() <= across;
        let column = self.column();
        is_kept.then(|| first as usize * column + second.rem_euclid(column as i32) as usize)
    }

    /// Forward transform: modes from values at the points (first axis fastest).
    ///
    /// # Panics
    /// Never: buffers have the lengths of their plans.
    pub fn forward(&mut self, value: impl Fn(usize) -> f64 + Sync, modes: &mut [Complex64]) {
        let [columns, rows] = self.points;
        let (stored, height, greatest) = (self.greatest[0] + 1, self.column(), self.greatest[1]);
        let scale = 1.0 / (columns * rows) as f64;
        self.half.par_chunks_mut(BLOCK * stored).enumerate().for_each(|(block, half)| {
            let plan = &self.rows_forward;
            let (mut row, mut spectrum) = (plan.make_input_vec(), plan.make_output_vec());
            let mut scratch = plan.make_scratch_vec();
            for (index, half) in half.chunks_mut(stored).enumerate() {
                let first = (BLOCK * block + index) * columns;
                for (point, own) in (first..).zip(&mut row) {
                    *own = value(point);
                }
                plan.process_with_scratch(&mut row, &mut spectrum, &mut scratch)
                    .expect("lengths of the plan");
                half.copy_from_slice(&spectrum[..stored]);
            }
        });
        let half = &self.half;
        modes.par_chunks_mut(BLOCK * height).enumerate().for_each(|(block, modes)| {
            let plan = &self.columns_forward;
            let first = BLOCK * block;
            let width = modes.len() / height;
            let mut buffer = vec![Complex64::ZERO; width * rows];
            let mut scratch = vec![Complex64::ZERO; plan.get_inplace_scratch_len()];
            for (j, row) in half.chunks(stored).enumerate() {
                for (i, value) in row[first..first + width].iter().enumerate() {
                    buffer[i * rows + j] = scale * value;
                }
            }
            plan.process_with_scratch(&mut buffer, &mut scratch);
            for (modes, buffer) in modes.chunks_mut(height).zip(buffer.chunks(rows)) {
                modes[..=greatest].copy_from_slice(&buffer[..=greatest]);
                modes[greatest + 1..].copy_from_slice(&buffer[rows - greatest..]);
            }
        });
    }

    /// Inverse transform: values at the points from modes, each stored one multiplied by `factor` of its wave vector.
    ///
    /// # Panics
    /// Never: buffers have the lengths of their plans.
    pub fn inverse(
        &mut self,
        modes: &[Complex64],
        waves: &Waves,
        factor: impl Fn(&Wave) -> Complex64 + Sync,
        values: &mut [f64],
    ) {
        let [columns, rows] = self.points;
        let (stored, height, greatest) = (self.greatest[0] + 1, self.column(), self.greatest[1]);
        let given = modes.par_chunks(height).zip(waves.all.par_chunks(height));
        self.half.par_chunks_mut(rows).zip(given).for_each(|(half, (modes, waves))| {
            let plan = &self.columns_inverse;
            half.fill(Complex64::ZERO);
            let given = modes.iter().zip(waves).map(|(value, wave)| factor(wave) * value);
            for (place, value) in given.enumerate() {
                half[if place > greatest { place + rows - height } else { place }] = value;
            }
            let mut scratch = vec![Complex64::ZERO; plan.get_inplace_scratch_len()];
            plan.process_with_scratch(half, &mut scratch);
        });
        let half = &self.half;
        values.par_chunks_mut(BLOCK * columns).enumerate().for_each(|(block, values)| {
            let plan = &self.rows_inverse;
            let first = BLOCK * block;
            let width = values.len() / columns;
            let mut scratch = plan.make_scratch_vec();
            // Unresolved modes are zero. The transform overwrites its input.
            let mut spectra = vec![Complex64::ZERO; width * (columns / 2 + 1)];
            for (i, column) in half.chunks(rows).take(stored).enumerate() {
                for (j, value) in column[first..first + width].iter().enumerate() {
                    spectra[j * (columns / 2 + 1) + i] = *value;
                }
            }
            for (row, spectrum) in
                values.chunks_mut(columns).zip(spectra.chunks_mut(columns / 2 + 1))
            {
                // Imaginary part of the mean of a row: rounding only.
                spectrum[0].im = 0.0;
                plan.process_with_scratch(spectrum, row, &mut scratch)
                    .expect("lengths of the plan");
            }
        });
    }

    /// Sets each mode to `value` of its wave vector and storage index.
    pub fn fill(
        &self,
        modes: &mut [Complex64],
        waves: &Waves,
        value: impl Fn(&Wave, usize) -> Complex64 + Sync,
    ) {
        let height = self.column();
        modes.par_chunks_mut(height).zip(waves.all.par_chunks(height)).enumerate().for_each(
            |(column, (modes, waves))| {
                for (place, (own, wave)) in modes.iter_mut().zip(waves).enumerate() {
                    *own = value(wave, column * height + place);
                }
            },
        );
    }

    /// Computes the mean of the product of two real series from their modes.
    pub fn product(&self, one: &[Complex64], other: &[Complex64]) -> f64 {
        let height = self.column();
        // Fixed order of the column sums: the same bits for any number of threads.
        let of_column = |(one, other): (&[Complex64], &[Complex64])| -> f64 {
            one.iter().zip(other).map(|(a, b)| a.re * b.re + a.im * b.im).sum()
        };
        let columns: Vec<f64> =
            one.par_chunks(height).zip(other.par_chunks(height)).map(of_column).collect();
        // Factor 2: conjugate modes are not stored.
        columns[0] + 2.0 * columns[1..].iter().sum::<f64>()
    }
}

/// Wave vector of a mode and functions of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wave {
    /// k = k(cos θ, sin θ), 1/m.
    pub vector: [f64; 2],
    /// 1/k², m²; 0 for k = 0.
    pub inverse_square: f64,
    /// cos 2θ and sin 2θ; 0 for k = 0.
    pub doubled: [f64; 2],
}

/// Wave vectors of all resolved modes in a deformed box.
#[derive(Clone, Debug)]
pub struct Waves {
    /// Wave vectors of the modes (1, 0) and (0, 1), 1/m.
    basis: [[f64; 2]; 2],
    all: Vec<Wave>,
}

impl Waves {
    /// Computes k = F⁻ᵀ(2πm/L) for a box of initial edges L, m, with deformation gradient F, det F = 1.
    pub fn new(series: &Series, lengths: [f64; 2], deformation: [[f64; 2]; 2]) -> Self {
        let mut waves = Self { basis: [[0.0; 2]; 2], all: vec![Wave::default(); series.count()] };
        waves.deform(series, lengths, deformation);
        waves
    }

    /// Recomputes the wave vectors for another deformation gradient.
    pub fn deform(&mut self, series: &Series, lengths: [f64; 2], f: [[f64; 2]; 2]) {
        let [k1, k2] = lengths.map(|length| TAU / length);
        let [[f11, f12], [f21, f22]] = f;
        self.basis = [[f22 * k1, -f12 * k1], [-f21 * k2, f11 * k2]];
        let basis = self.basis;
        self.all.par_chunks_mut(series.column()).enumerate().for_each(|(column, waves)| {
            for (place, wave) in waves.iter_mut().enumerate() {
                let vector = vector(basis, series.mode(column * series.column() + place));
                let [k1, k2] = vector;
                let square = k1 * k1 + k2 * k2;
                let inverse_square = if square == 0.0 { 0.0 } else { 1.0 / square };
                let doubled =
                    [(k1 * k1 - k2 * k2) * inverse_square, 2.0 * k1 * k2 * inverse_square];
                *wave = Wave { vector, inverse_square, doubled };
            }
        });
    }

    /// Computes the wave vector of a mode, 1/m.
    pub fn vector(&self, mode: Mode) -> [f64; 2] {
        vector(self.basis, mode)
    }
}

fn vector([one, other]: [[f64; 2]; 2], mode: Mode) -> [f64; 2] {
    let [first, second] = mode.map(f64::from);
    [first * one[0] + second * other[0], first * one[1] + second * other[1]]
}
