//! Fourier series on a rectangular box: resolved modes, wave vectors and transforms.
//!
//! Modes up to ⌊(N − 1)/3⌋ are resolved along each axis of N points (2/3 rule): in products of two series they are
//! free of aliasing. Of a real series the modes with m₁ ≥ 0 are stored, m₂ fastest: 0, 1, …, K₂, −K₂, …, −1.

use num_complex::Complex64;
use rayon::prelude::*;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftPlanner};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Number of columns or rows per parallel task: several, so that reads with the stride of a row use whole cache lines.
const LINES_PER_TASK: usize = 8;

/// Mode numbers m₁ and m₂ along the axes.
pub type ModeNumbers = [i32; 2];

/// Resolved modes and their transforms.
pub struct FourierSeries {
    points: [usize; 2],
    /// Largest resolved mode numbers K₁ and K₂ along the axes.
    max_modes: [usize; 2],
    rows_forward: Arc<dyn RealToComplex<f64>>,
    rows_inverse: Arc<dyn ComplexToReal<f64>>,
    columns_forward: Arc<dyn Fft<f64>>,
    columns_inverse: Arc<dyn Fft<f64>>,
    /// Buffer for values that are transformed along the first axis only.
    half_transformed: Vec<Complex64>,
}

pub use models::common::fourier::max_dealiased_modes;

impl FourierSeries {
    /// Creates the transforms for `points` points along each axis: even, at least 4.
    pub fn new(points: [usize; 2]) -> Self {
        let mut real = RealFftPlanner::new();
        let mut complex = FftPlanner::new();
        let max_modes = max_dealiased_modes(points);
        Self {
            points,
            max_modes,
            rows_forward: real.plan_fft_forward(points[0]),
            rows_inverse: real.plan_fft_inverse(points[0]),
            columns_forward: complex.plan_fft_forward(points[1]),
            columns_inverse: complex.plan_fft_inverse(points[1]),
            half_transformed: vec![Complex64::ZERO; (max_modes[0] + 1) * points[1]],
        }
    }

    /// Returns the number of points along each axis.
    pub fn points(&self) -> [usize; 2] {
        self.points
    }

    /// Returns the largest mode number along each axis.
    pub fn max_modes(&self) -> [usize; 2] {
        self.max_modes
    }

    /// Returns the number of stored modes for each m₁.
    pub fn column_length(&self) -> usize {
        2 * self.max_modes[1] + 1
    }

    /// Returns the number of stored modes.
    pub fn mode_count(&self) -> usize {
        (self.max_modes[0] + 1) * self.column_length()
    }

    /// Returns the mode with a storage index.
    pub fn mode(&self, index: usize) -> ModeNumbers {
        let (column, position) = (index / self.column_length(), index % self.column_length());
        let is_negative = position > self.max_modes[1];
        [column as i32, position as i32 - if is_negative { self.column_length() as i32 } else { 0 }]
    }

    /// Returns the storage index of a mode: `None` if it is unresolved or only its conjugate, −m, is stored.
    pub fn mode_index(&self, [first, second]: ModeNumbers) -> Option<usize> {
        let [max_first, max_second] = self.max_modes.map(|number| number as i32);
        let is_stored = (0..=max_first).contains(&first) && second.abs() <= max_second;
        let column = self.column_length();
        is_stored.then(|| first as usize * column + second.rem_euclid(column as i32) as usize)
    }

    /// Forward transform: computes modes from values at the points (first axis fastest).
    ///
    /// # Panics
    /// `modes` does not have [`mode_count`](Self::mode_count) entries.
    pub fn transform_forward(
        &mut self,
        value: impl Fn(usize) -> f64 + Sync,
        modes: &mut [Complex64],
    ) {
        let [columns, rows] = self.points;
        let (stored, height, max_modes) =
            (self.max_modes[0] + 1, self.column_length(), self.max_modes[1]);
        let scale = 1.0 / (columns * rows) as f64;
        self.half_transformed.par_chunks_mut(LINES_PER_TASK * stored).enumerate().for_each(
            |(block, half)| {
                let plan = &self.rows_forward;
                let (mut row, mut spectrum) = (plan.make_input_vec(), plan.make_output_vec());
                let mut scratch = plan.make_scratch_vec();
                for (index, half) in half.chunks_mut(stored).enumerate() {
                    let first = (LINES_PER_TASK * block + index) * columns;
                    for (point, own) in (first..).zip(&mut row) {
                        *own = value(point);
                    }
                    plan.process_with_scratch(&mut row, &mut spectrum, &mut scratch)
                        .expect("lengths of the plan");
                    half.copy_from_slice(&spectrum[..stored]);
                }
            },
        );
        let half = &self.half_transformed;
        modes.par_chunks_mut(LINES_PER_TASK * height).enumerate().for_each(|(block, modes)| {
            let plan = &self.columns_forward;
            let first = LINES_PER_TASK * block;
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
                modes[..=max_modes].copy_from_slice(&buffer[..=max_modes]);
                modes[max_modes + 1..].copy_from_slice(&buffer[rows - max_modes..]);
            }
        });
    }

    /// Inverse transform: computes values at the points from modes, each stored one multiplied by `factor` of its wave
    /// vector.
    ///
    /// # Panics
    /// `values` does not have one entry per point.
    pub fn transform_inverse(
        &mut self,
        modes: &[Complex64],
        waves: &ModeWaveVectors,
        factor: impl Fn(&ModeWaveVector) -> Complex64 + Sync,
        values: &mut [f64],
    ) {
        let [columns, rows] = self.points;
        let (stored, height, max_modes) =
            (self.max_modes[0] + 1, self.column_length(), self.max_modes[1]);
        let given = modes.par_chunks(height).zip(waves.by_mode.par_chunks(height));
        self.half_transformed.par_chunks_mut(rows).zip(given).for_each(|(half, (modes, waves))| {
            let plan = &self.columns_inverse;
            half.fill(Complex64::ZERO);
            let given = modes.iter().zip(waves).map(|(value, wave)| factor(wave) * value);
            for (place, value) in given.enumerate() {
                half[if place > max_modes { place + rows - height } else { place }] = value;
            }
            let mut scratch = vec![Complex64::ZERO; plan.get_inplace_scratch_len()];
            plan.process_with_scratch(half, &mut scratch);
        });
        let half = &self.half_transformed;
        values.par_chunks_mut(LINES_PER_TASK * columns).enumerate().for_each(|(block, values)| {
            let plan = &self.rows_inverse;
            let first = LINES_PER_TASK * block;
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
                // The imaginary part of the mean of a row is rounding error only.
                spectrum[0].im = 0.0;
                plan.process_with_scratch(spectrum, row, &mut scratch)
                    .expect("lengths of the plan");
            }
        });
    }

    /// Sets each mode to `value` of its wave vector and storage index.
    pub fn fill_modes(
        &self,
        modes: &mut [Complex64],
        waves: &ModeWaveVectors,
        value: impl Fn(&ModeWaveVector, usize) -> Complex64 + Sync,
    ) {
        let height = self.column_length();
        modes.par_chunks_mut(height).zip(waves.by_mode.par_chunks(height)).enumerate().for_each(
            |(column, (modes, waves))| {
                for (place, (own, wave)) in modes.iter_mut().zip(waves).enumerate() {
                    *own = value(wave, column * height + place);
                }
            },
        );
    }

    /// Computes the mean of the product of two real series from their modes.
    pub fn mean_product(&self, one: &[Complex64], other: &[Complex64]) -> f64 {
        let height = self.column_length();
        // Fixed order of the column sums: the same bits for any number of threads.
        let column_product = |(one, other): (&[Complex64], &[Complex64])| -> f64 {
            one.iter().zip(other).map(|(a, b)| a.re * b.re + a.im * b.im).sum()
        };
        let columns: Vec<f64> =
            one.par_chunks(height).zip(other.par_chunks(height)).map(column_product).collect();
        // Factor 2: conjugate modes are not stored.
        columns[0] + 2.0 * columns[1..].iter().sum::<f64>()
    }
}

/// Wave vector of a mode and functions of it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ModeWaveVector {
    /// Components of the wave vector k = k(cos θ, sin θ), 1/m.
    pub components: [f64; 2],
    /// Inverse square of the wave number, 1/k², m²; 0 for k = 0.
    pub inverse_square: f64,
    /// cos 2θ and sin 2θ of the direction θ of the wave vector; 0 for k = 0.
    pub double_angle: [f64; 2],
}

/// Wave vectors of all stored modes in a deformed box, in the order of storage.
#[derive(Clone, Debug)]
pub struct ModeWaveVectors {
    /// Wave vectors of the modes (1, 0) and (0, 1), 1/m.
    basis: [[f64; 2]; 2],
    by_mode: Vec<ModeWaveVector>,
}

impl ModeWaveVectors {
    /// Computes k = F⁻ᵀ(2πm/L) for the modes m of a box of initial edges L, m, with deformation gradient F, det F = 1.
    pub fn new(series: &FourierSeries, lengths: [f64; 2], deformation: [[f64; 2]; 2]) -> Self {
        let mut waves = Self {
            basis: [[0.0; 2]; 2],
            by_mode: vec![ModeWaveVector::default(); series.mode_count()],
        };
        waves.deform(series, lengths, deformation);
        waves
    }

    /// Recomputes the wave vectors for another deformation gradient.
    pub fn deform(&mut self, series: &FourierSeries, lengths: [f64; 2], f: [[f64; 2]; 2]) {
        self.basis = basis_wave_vectors(lengths, f);
        let basis = self.basis;
        self.by_mode.par_chunks_mut(series.column_length()).enumerate().for_each(
            |(column, waves)| {
                for (place, wave) in waves.iter_mut().enumerate() {
                    let components =
                        combine_basis(basis, series.mode(column * series.column_length() + place));
                    let [k1, k2] = components;
                    let square = k1 * k1 + k2 * k2;
                    let inverse_square = if square == 0.0 { 0.0 } else { 1.0 / square };
                    let double_angle =
                        [(k1 * k1 - k2 * k2) * inverse_square, 2.0 * k1 * k2 * inverse_square];
                    *wave = ModeWaveVector { components, inverse_square, double_angle };
                }
            },
        );
    }

    /// Computes the wave vector of a mode, 1/m.
    pub fn wave_vector(&self, mode: ModeNumbers) -> [f64; 2] {
        combine_basis(self.basis, mode)
    }
}

/// Computes the wave vectors of the modes (1, 0) and (0, 1), 1/m; arguments: those of [`ModeWaveVectors::new`].
pub(super) fn basis_wave_vectors(
    lengths: [f64; 2],
    [[f11, f12], [f21, f22]]: [[f64; 2]; 2],
) -> [[f64; 2]; 2] {
    let [k1, k2] = lengths.map(|length| TAU / length);
    [[f22 * k1, -f12 * k1], [-f21 * k2, f11 * k2]]
}

/// Computes the wave vector of a mode from those of the modes (1, 0) and (0, 1).
pub(super) fn combine_basis([one, other]: [[f64; 2]; 2], mode: ModeNumbers) -> [f64; 2] {
    let [first, second] = mode.map(f64::from);
    [first * one[0] + second * other[0], first * one[1] + second * other[1]]
}
