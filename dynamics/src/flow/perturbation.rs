//! Initial perturbations of a flow at the points of its box: waves, wave packets and random Fourier series.

use super::spectral::max_dealiased_modes;
use models::common::elementary::{Elementary, cr_cis, cr_from_polar};
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Mode numbers m and amplitude c of the wave Re c exp(ik·y), k = 2π(m₁/L₁, m₂/L₂), at the position y in the initial
/// box of edges L, m.
pub type FourierMode = ([i64; 2], Complex64);

/// Regular grid of points in the initial box, at the centres of equal rectangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Number of points along each axis of the box.
    pub points: [usize; 2],
    /// Edge lengths of the initial box, m.
    pub lengths: [f64; 2],
}

/// Returns the wave A cos(k·y + phase) with A = `amplitude` and `phase` in rad.
pub fn plane_wave(mode: [i64; 2], amplitude: f64, phase: f64) -> FourierMode {
    (mode, cr_from_polar(amplitude, phase))
}

/// Generates a random series of all modes with `from` ≤ |m| ≤ `to` (one of each pair ±m), of equal amplitudes, with
/// root mean square `amplitude`. The phase of a mode depends only on the seed and the mode.
pub fn generate_noise(from: f64, to: f64, amplitude: f64, seed: u64) -> Vec<FourierMode> {
    let max_number = to as i64;
    let in_band = |[m1, m2]: &[i64; 2]| {
        let square = (m1 * m1 + m2 * m2) as f64;
        (from * from..=to * to).contains(&square)
    };
    let modes: Vec<[i64; 2]> = (0..=max_number)
        .flat_map(|m1| (if m1 == 0 { 1 } else { -max_number }..=max_number).map(move |m2| [m1, m2]))
        .filter(in_band)
        .collect();
    let each = amplitude * (2.0 / modes.len() as f64).sqrt();
    let phase = |mode: [i64; 2]| {
        let hash =
            mode.iter().fold(splitmix64(seed), |hash, m| splitmix64(hash ^ m.cast_unsigned()));
        2.0 * PI * (hash >> 11) as f64 / (1u64 << 53) as f64
    };
    modes.into_iter().map(|mode| (mode, cr_from_polar(each, phase(mode)))).collect()
}

/// Makes one step of the SplitMix64 generator (Steele, Lea & Flood 2014).
fn splitmix64(state: u64) -> u64 {
    let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Tabulates exp(iπh/n), h = 0 … 2n − 1, for an axis with n = `points` points.
fn tabulate_roots_of_unity(points: usize) -> Vec<Complex64> {
    (0..2 * points).map(|half| cr_cis(PI * half as f64 / points as f64)).collect()
}

/// Iterates over exp(2πimy/L) at the points y = (j + ½)L/n of an axis, m = `mode`, from the table of
/// [`tabulate_roots_of_unity`]; the table index m(2j + 1) is reduced modulo 2n.
fn iterate_phases(mode: i64, table: &[Complex64]) -> impl Iterator<Item = Complex64> {
    let count = table.len() as i64;
    (0..count / 2).map(move |i| table[(mode * (2 * i + 1)).rem_euclid(count) as usize])
}

impl Lattice {
    /// Returns the coordinate of a point along an axis, m.
    fn position(&self, axis: usize, index: usize) -> f64 {
        (index as f64 + 0.5) * self.lengths[axis] / self.points[axis] as f64
    }

    /// Evaluates a scalar field at the points (x₁ fastest), multiplied by an optional envelope. Unresolved modes are
    /// omitted, since they would be aliased.
    pub fn evaluate_scalar(&self, waves: &[FourierMode], envelope: Option<&[f64]>) -> Vec<f64> {
        apply_envelope(envelope, self.sum_modes(self.select_resolved_modes(waves)))
    }

    /// Evaluates a transverse velocity, along (−k₂, k₁)/|k|, by axis and point; envelope and unresolved modes as in
    /// [`evaluate_scalar`](Self::evaluate_scalar).
    pub fn evaluate_transverse(
        &self,
        waves: &[FourierMode],
        envelope: Option<&[f64]>,
    ) -> [Vec<f64>; 2] {
        let across = |mode: [i64; 2], axis: usize| {
            let k = [0, 1].map(|axis| mode[axis] as f64 / self.lengths[axis]);
            [-k[1], k[0]][axis] / k[0].root_sum_square(k[1])
        };
        [0, 1].map(|axis| {
            let waves =
                self.select_resolved_modes(waves).map(|(mode, c)| (mode, c * across(mode, axis)));
            apply_envelope(envelope, self.sum_modes(waves))
        })
    }

    /// Selects the waves whose modes are resolved on this grid of points.
    fn select_resolved_modes<'a>(
        &self,
        waves: &'a [FourierMode],
    ) -> impl Iterator<Item = FourierMode> + use<'a> {
        let max_modes = max_dealiased_modes(self.points);
        let is_resolved = move |wave: &FourierMode| {
            wave.0.iter().zip(max_modes).all(|(m, max)| m.unsigned_abs() <= max as u64)
        };
        waves.iter().copied().filter(is_resolved)
    }

    /// Evaluates Σ Re c exp(ik·y) at the points, by partial sums along the second axis.
    fn sum_modes(&self, waves: impl IntoIterator<Item = FourierMode>) -> Vec<f64> {
        let [columns, rows] = self.points;
        let [column_roots, row_roots] = self.points.map(tabulate_roots_of_unity);
        let mut by_first: BTreeMap<i64, Vec<Complex64>> = BTreeMap::new();
        for ([m1, m2], amplitude) in waves {
            let sums = by_first.entry(m1).or_insert_with(|| vec![Complex64::ZERO; rows]);
            for (sum, wave) in sums.iter_mut().zip(iterate_phases(m2, &row_roots)) {
                *sum += amplitude * wave;
            }
        }
        let mut values = vec![0.0; columns * rows];
        for (m1, sums) in by_first {
            let waves: Vec<Complex64> = iterate_phases(m1, &column_roots).collect();
            for (row, sum) in values.chunks_exact_mut(columns).zip(sums) {
                for (value, wave) in row.iter_mut().zip(&waves) {
                    *value += sum.re * wave.re - sum.im * wave.im;
                }
            }
        }
        values
    }

    /// Evaluates the Gaussian exp(−(r/radius)²) at the points; r, m: distance from the nearest periodic image of
    /// `centre`.
    pub fn evaluate_gaussian(&self, centre: [f64; 2], radius: f64) -> Vec<f64> {
        let [first, second] = [0, 1].map(|axis| -> Vec<f64> {
            let length = self.lengths[axis];
            let distance = |i: usize| {
                let distance = (self.position(axis, i) - centre[axis]).abs();
                distance.min(length - distance)
            };
            (0..self.points[axis]).map(|i| (-(distance(i) / radius).powi(2)).cr_exp()).collect()
        });
        second.iter().flat_map(|b| first.iter().map(move |a| a * b)).collect()
    }
}

/// Multiplies values at the points by an envelope, if there is one.
fn apply_envelope(envelope: Option<&[f64]>, mut values: Vec<f64>) -> Vec<f64> {
    if let Some(bell) = envelope {
        values.iter_mut().zip(bell).for_each(|(value, bell)| *value *= bell);
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build_lattice(count: [usize; 2]) -> Lattice {
        Lattice { points: count, lengths: [0.1, 0.3] }
    }

    /// Verifies the values of a wave against the formula, and that its velocity is normal to the wave vector.
    #[test]
    fn waves_are_transverse() {
        let grid = build_lattice([16, 24]);
        let wave = plane_wave([2, -3], 0.7, 25f64.to_radians());
        let velocity = grid.evaluate_transverse(&[wave], None);
        let k = [2.0 * PI * 2.0 / 0.1, -2.0 * PI * 3.0 / 0.3];
        let size = k[0].hypot(k[1]);
        for j in 0..24 {
            for i in 0..16 {
                let y = [grid.position(0, i), grid.position(1, j)];
                let cosine = (k[0] * y[0] + k[1] * y[1] + 25f64.to_radians()).cos();
                let expected = [-k[1] / size, k[0] / size].map(|own| 0.7 * own * cosine);
                for (own, expected) in velocity.iter().zip(expected) {
                    assert!((own[j * 16 + i] - expected).abs() < 1e-13, "{i} {j}");
                }
            }
        }
    }

    /// Verifies the root mean square of noise, its independence of the grid, and that it depends on the seed.
    #[test]
    fn noise_does_not_depend_on_the_grid() {
        let modes = generate_noise(2.0, 5.0, 0.3, 7);
        let mean_square = |values: &[f64]| {
            values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
        };
        let coarse = build_lattice([16, 16]).evaluate_scalar(&modes, None);
        assert!((mean_square(&coarse).sqrt() - 0.3).abs() < 1e-13);
        // On a grid three times as fine, every third point is a point of the coarse grid.
        let fine = build_lattice([48, 48]).evaluate_scalar(&modes, None);
        for j in 0..16 {
            for i in 0..16 {
                let (coarse_value, fine_value) =
                    (coarse[j * 16 + i], fine[(3 * j + 1) * 48 + 3 * i + 1]);
                assert!((coarse_value - fine_value).abs() < 1e-12);
            }
        }
        let fine_value =
            build_lattice([16, 16]).evaluate_scalar(&generate_noise(2.0, 5.0, 0.3, 8), None);
        let product: f64 = coarse.iter().zip(&fine_value).map(|(a, b)| a * b).sum();
        assert!(product.abs() < 0.5 * 256.0 * 0.09, "{product}");
        // In a wider band, the modes that both bands contain have the same phases.
        let wider: BTreeMap<[i64; 2], f64> =
            generate_noise(1.0, 9.0, 1.0, 7).iter().map(|(mode, c)| (*mode, c.arg())).collect();
        assert!(modes.iter().all(|(mode, c)| (wider[mode] - c.arg()).abs() < 1e-14));
        assert_eq!(generate_noise(1.0, 1.0, 1.0, 0).len(), 2);
    }

    /// Verifies that a Gaussian is largest next to its centre and periodic along x₁.
    #[test]
    fn gaussians_are_periodic() {
        let bell = build_lattice([20, 20]).evaluate_gaussian([0.0025, 0.15], 0.02);
        // The centre is midway between the points (i, j) = (0, 9) and (0, 10), the latter with index 10·20 + 0.
        let middle = 200;
        let largest = bell.iter().fold(0.0f64, |a, b| a.max(*b));
        assert!((bell[middle] - largest).abs() < 1e-14);
        let (left, right) = (bell[middle - middle % 20 + 19], bell[middle + 1]);
        assert!((left - right).abs() < 1e-15, "{left} {right}");
    }
}
