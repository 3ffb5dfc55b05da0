//! The perturbation at the beginning of a run.

use crate::case::flow::{Disturbed, FlowRun, Grid, Initial, Wave};
use crate::case::{CaseError, radians};
use dynamics::flow::Problem;
use files::npz::{Values, read};
use models::elementary::{Elementary, cr_cis, cr_from_polar};
use models::granular_flow::RotationKind;
use num_complex::Complex64;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Perturbations at the points, the first axis running fastest.
pub(super) struct Fields {
    /// Of the velocity, m/s.
    pub(super) velocity: [Vec<f64>; 2],
    /// Of the spin, rad/s, or of the stress angle, rad; zero where neither evolves.
    pub(super) inner: Vec<f64>,
}

/// The sum of all parts.
///
/// # Errors
/// The archive that a part names is not what it should be.
pub(super) fn fields(run: &FlowRun, problem: &Problem) -> Result<Fields, CaseError> {
    let grid = &run.grid;
    let zeros = || vec![0.0; grid.count()];
    let mut fields = Fields { velocity: [zeros(), zeros()], inner: zeros() };
    for (index, part) in run.initial.iter().enumerate() {
        match part {
            Initial::Mode(wave) => fields.add(grid, wave.field, &[of_wave(wave)], None),
            Initial::Packet { wave, at, radius } => {
                fields.add(grid, wave.field, &[of_wave(wave)], Some((*at, *radius)));
            }
            Initial::Noise { field, from, to, amplitude, seed } => {
                fields.add(
                    grid,
                    *field,
                    &noise(*from, *to, in_si(*field, *amplitude), *seed),
                    None,
                );
            }
            Initial::Uniform { field, amplitude } => {
                let amplitude = in_si(*field, *amplitude);
                fields.inner.iter_mut().for_each(|value| *value += amplitude);
            }
            Initial::File { path, checksum } => {
                fields.add_file(run, problem, path, *checksum).map_err(|(found, allowed)| {
                    run.locate(&format!("initial[{index}].path"), found, allowed)
                })?;
            }
        }
    }
    Ok(fields)
}

/// An amplitude in the units of the solver.
fn in_si(field: Disturbed, amplitude: f64) -> f64 {
    if field == Disturbed::StressAngle { amplitude.to_radians() } else { amplitude }
}

/// A mode and its amplitude c in Re c exp(ik·y).
type Mode = ([i64; 2], Complex64);

fn of_wave(wave: &Wave) -> Mode {
    let amplitude = in_si(wave.field, wave.amplitude);
    (wave.mode, cr_from_polar(amplitude, radians(wave.phase_deg)))
}

/// All modes of a band, one of each pair of opposite ones, of a root mean square. The phase of a mode
/// depends on nothing but the seed and the mode.
fn noise(from: f64, to: f64, amplitude: f64, seed: u64) -> Vec<Mode> {
    let most = to as i64;
    let in_band = |[m1, m2]: &[i64; 2]| {
        let square = (m1 * m1 + m2 * m2) as f64;
        (from * from..=to * to).contains(&square)
    };
    let modes: Vec<[i64; 2]> = (0..=most)
        .flat_map(|m1| (if m1 == 0 { 1 } else { -most }..=most).map(move |m2| [m1, m2]))
        .filter(in_band)
        .collect();
    let each = amplitude * (2.0 / modes.len() as f64).sqrt();
    let phase = |mode: [i64; 2]| {
        let hash = mode.iter().fold(mix(seed), |hash, m| mix(hash ^ m.cast_unsigned()));
        2.0 * PI * (hash >> 11) as f64 / (1u64 << 53) as f64
    };
    modes.into_iter().map(|mode| (mode, cr_from_polar(each, phase(mode)))).collect()
}

/// A step of SplitMix64 (Steele, Lea & Flood 2014).
fn mix(state: u64) -> u64 {
    let mut z = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// exp(iπh/n) for all h of a turn.
fn turn(points: usize) -> Vec<Complex64> {
    (0..2 * points).map(|half| cr_cis(PI * half as f64 / points as f64)).collect()
}

/// exp(2πimy/L) at the points of an axis, from a turn. Whole turns are taken off in whole numbers.
fn along(mode: i64, turn: &[Complex64]) -> impl Iterator<Item = Complex64> {
    let count = turn.len() as i64;
    (0..count / 2).map(move |i| turn[(mode * (2 * i + 1)).rem_euclid(count) as usize])
}

/// Σ Re c exp(ik·y) at the points, by way of sums along the second axis.
fn sum(grid: &Grid, modes: impl IntoIterator<Item = Mode>) -> Vec<f64> {
    let [columns, rows] = grid.cells;
    let [column_turn, row_turn] = grid.cells.map(turn);
    let mut by_first: BTreeMap<i64, Vec<Complex64>> = BTreeMap::new();
    for ([m1, m2], amplitude) in modes {
        let sums = by_first.entry(m1).or_insert_with(|| vec![Complex64::ZERO; rows]);
        for (sum, wave) in sums.iter_mut().zip(along(m2, &row_turn)) {
            *sum += amplitude * wave;
        }
    }
    let mut values = vec![0.0; grid.count()];
    for (m1, sums) in by_first {
        let waves: Vec<Complex64> = along(m1, &column_turn).collect();
        for (row, sum) in values.chunks_exact_mut(columns).zip(sums) {
            for (value, wave) in row.iter_mut().zip(&waves) {
                *value += sum.re * wave.re - sum.im * wave.im;
            }
        }
    }
    values
}

/// exp(−(r/radius)²) of the nearest of all images of its middle, at the points.
fn bell(grid: &Grid, at: [f64; 2], radius: f64) -> Vec<f64> {
    let [first, second] = [0, 1].map(|axis| -> Vec<f64> {
        let length = grid.lengths[axis];
        let distance = |i: usize| {
            let distance = (grid.position(axis, i) - at[axis]).abs();
            distance.min(length - distance)
        };
        (0..grid.cells[axis]).map(|i| (-(distance(i) / radius).powi(2)).cr_exp()).collect()
    });
    second.iter().flat_map(|b| first.iter().map(move |a| a * b)).collect()
}

impl Fields {
    /// Adds modes of a field, under a bell if there is one.
    fn add(
        &mut self,
        grid: &Grid,
        field: Disturbed,
        modes: &[Mode],
        envelope: Option<([f64; 2], f64)>,
    ) {
        let envelope = envelope.map(|(at, radius)| bell(grid, at, radius));
        // Points take shorter waves for longer ones.
        let greatest = grid.greatest_modes();
        let holds = |mode: &[i64; 2]| {
            mode.iter().zip(greatest).all(|(m, most)| m.unsigned_abs() <= most as u64)
        };
        let modes: Vec<Mode> = modes.iter().copied().filter(|own| holds(&own.0)).collect();
        let add = |own: &mut [f64], mut values: Vec<f64>| {
            if let Some(bell) = &envelope {
                values.iter_mut().zip(bell).for_each(|(value, bell)| *value *= bell);
            }
            own.iter_mut().zip(values).for_each(|(own, value)| *own += value);
        };
        if field != Disturbed::Velocity {
            return add(&mut self.inner, sum(grid, modes.iter().copied()));
        }
        // ξ⊥ = (−k₂, k₁)/|k|.
        let across = |mode: [i64; 2], axis: usize| {
            let k = [0, 1].map(|axis| mode[axis] as f64 / grid.lengths[axis]);
            [-k[1], k[0]][axis] / k[0].root_sum_square(k[1])
        };
        for (axis, own) in self.velocity.iter_mut().enumerate() {
            let modes = modes.iter().map(|(mode, c)| (*mode, c * across(*mode, axis)));
            add(own, sum(grid, modes));
        }
    }

    /// Adds the perturbation that an archive holds; or what is wrong with it, and what is allowed.
    fn add_file(
        &mut self,
        run: &FlowRun,
        problem: &Problem,
        path: &str,
        checksum: u32,
    ) -> Result<(), (String, &'static str)> {
        const NEEDS: &str =
            "an archive (NPZ) with v1, v2 and the field that evolves, such as fields.npz of a run";
        let unusable = |cause: &str| (format!("'{path}': {cause}"), NEEDS);
        let bytes = std::fs::read(path).map_err(|error| unusable(&error.to_string()))?;
        if files::checksum(&bytes) != checksum {
            let allowed = "bring it back, or run the case again from the file that names it";
            return Err((format!("'{path}' has changed since the case was read"), allowed));
        }
        let arrays = read(&bytes).map_err(|error| unusable(&error.to_string()))?;
        let shape = [run.grid.cells[1], run.grid.cells[0]];
        let [v1, v2] = &mut self.velocity;
        // The archive holds the whole of these, not the perturbation.
        let inner = match run.rotation {
            RotationKind::IntrinsicSpin => Some(("w", problem.spin)),
            RotationKind::StressAxes => Some(("psi", problem.stress_angle)),
            RotationKind::None | RotationKind::Free => None,
        };
        let inner = inner.map(|(name, mean)| (name, &mut self.inner, mean));
        for (name, own, mean) in [("v1", v1, 0.0), ("v2", v2, 0.0)].into_iter().chain(inner) {
            let array = arrays.iter().find(|array| array.name == name);
            let array = array.ok_or_else(|| unusable(&format!("no array {name}")))?;
            let Values::F64(values) = &array.values else {
                return Err(unusable(&format!("{name} has no numbers of 64 bits")));
            };
            if array.shape != shape {
                let found = format!("{name} is of shape {:?}, not {shape:?}", array.shape);
                return Err(unusable(&found));
            }
            if values.iter().any(|value| !value.is_finite()) {
                return Err(unusable(&format!("{name} is not finite everywhere")));
            }
            own.iter_mut().zip(values).for_each(|(own, value)| *own += value - mean);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(cells: [usize; 2]) -> Grid {
        Grid { cells, lengths: [0.1, 0.3] }
    }

    /// A wave has its values, and its velocity is across the wave vector.
    #[test]
    fn waves_are_transverse() {
        let grid = grid([16, 24]);
        let (mode, amplitude, phase_deg) = ([2, -3], 0.7, 25.0);
        let wave = Wave { mode, field: Disturbed::Velocity, amplitude, phase_deg };
        let zeros = || vec![0.0; grid.count()];
        let mut fields = Fields { velocity: [zeros(), zeros()], inner: zeros() };
        fields.add(&grid, wave.field, &[of_wave(&wave)], None);
        let k = [2.0 * PI * 2.0 / 0.1, -2.0 * PI * 3.0 / 0.3];
        let size = k[0].hypot(k[1]);
        for j in 0..24 {
            for i in 0..16 {
                let y = [grid.position(0, i), grid.position(1, j)];
                let cosine = (k[0] * y[0] + k[1] * y[1] + 25f64.to_radians()).cos();
                let expected = [-k[1] / size, k[0] / size].map(|own| 0.7 * own * cosine);
                for (own, expected) in fields.velocity.iter().zip(expected) {
                    assert!((own[j * 16 + i] - expected).abs() < 1e-13, "{i} {j}");
                }
            }
        }
        assert!(fields.inner.iter().all(|value| *value == 0.0));
    }

    /// Noise has its root mean square, is the same function on finer points, and another for another seed.
    #[test]
    fn noise_does_not_depend_on_the_grid() {
        let modes = noise(2.0, 5.0, 0.3, 7);
        let mean_square = |values: &[f64]| {
            values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64
        };
        let coarse = sum(&grid([16, 16]), modes.iter().copied());
        assert!((mean_square(&coarse).sqrt() - 0.3).abs() < 1e-13);
        // Three times as many points: every third of them is a coarse one.
        let fine = sum(&grid([48, 48]), modes.iter().copied());
        for j in 0..16 {
            for i in 0..16 {
                let (one, other) = (coarse[j * 16 + i], fine[(3 * j + 1) * 48 + 3 * i + 1]);
                assert!((one - other).abs() < 1e-12);
            }
        }
        let other = sum(&grid([16, 16]), noise(2.0, 5.0, 0.3, 8));
        let product: f64 = coarse.iter().zip(&other).map(|(a, b)| a * b).sum();
        assert!(product.abs() < 0.5 * 256.0 * 0.09, "{product}");
        // A wider band has the phases of the narrower one.
        let wider: BTreeMap<[i64; 2], f64> =
            noise(1.0, 9.0, 1.0, 7).iter().map(|(mode, c)| (*mode, c.arg())).collect();
        assert!(modes.iter().all(|(mode, c)| (wider[mode] - c.arg()).abs() < 1e-14));
        assert_eq!(noise(1.0, 1.0, 1.0, 0).len(), 2);
    }

    /// A bell is greatest at its middle and goes on across the edges of the box.
    #[test]
    fn bells_are_periodic() {
        let grid = grid([20, 20]);
        let bell = bell(&grid, [0.0025, 0.15], 0.02);
        let middle = grid.nearest(&[0.0025, 0.15]);
        let greatest = bell.iter().fold(0.0f64, |a, b| a.max(*b));
        assert!((bell[middle] - greatest).abs() < 1e-14);
        let (left, right) = (bell[middle - middle % 20 + 19], bell[middle + 1]);
        assert!((left - right).abs() < 1e-15, "{left} {right}");
    }
}
