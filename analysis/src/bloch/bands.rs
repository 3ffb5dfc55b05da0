//! Lowest Bloch waves of a cell at a wave vector, with decay rate and polarisation, for elastic and viscous joints.

use super::cell::{Cell, CellModel, DegreeControl, Joint};
use super::zone::ZonePoint;
use super::{BlochError, ensure};
use models::common::elementary::{Elementary, Modulus};
use num_complex::Complex64;

/// Frequency, decay rate and polarisation of a Bloch wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlochWave {
    /// Angular frequency Re ω, rad/s.
    pub frequency: f64,
    /// Decay rate Im ω of e^{iωt}, 1/s; zero without viscosity, negative for waves that grow.
    pub decay_rate: f64,
    /// Share of the kinetic energy of the blocks in the displacement along κ: 1 for longitudinal, 0 for transverse
    /// waves, ½ for rotating blocks; `None` at κ = 0 and with viscosity.
    pub longitudinal_share: Option<f64>,
}

/// Bloch waves at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct WavesAtWaveVector {
    /// The lowest waves, ascending in frequency.
    pub waves: Vec<BlochWave>,
    /// Smallest ω² of all waves of the discretisation, rad²/s²; `None` with viscosity.
    pub min_squared_frequency: Option<f64>,
    /// Largest growth rate −Im ω of a mode, 1/s, also if it is within rounding; zero if all modes decay.
    pub max_growth_rate: f64,
    /// Bound on the rounding error of the growth rate, 1/s.
    pub growth_rounding: f64,
}

/// Solver for the lowest Bloch waves of a cell, with Legendre polynomials of a fixed degree.
#[derive(Clone, Debug)]
pub struct BandSolver {
    model: CellModel,
    /// Number of waves at each wave vector.
    wave_count: usize,
    is_viscous: bool,
    /// Estimate of the largest relative error of a frequency at the vertices of the path, by extrapolation to infinite
    /// degree, for the cell without delayed openings.
    pub frequency_error: f64,
}

/// Point of a path in the Brillouin zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint {
    /// Distance along the path, 1/m.
    pub distance: f64,
    /// Wave vector κ, 1/m.
    pub wave_vector: [f64; 2],
}

/// Samples a path of straight sides with `samples` steps on each side; returns the points, and the distances of its
/// vertices along the path, 1/m.
///
/// # Errors
/// `samples` is 0.
pub fn sample_path(
    path: &[ZonePoint],
    samples: usize,
) -> Result<(Vec<PathPoint>, Vec<f64>), BlochError> {
    ensure(samples > 0, "samples", samples, "at least 1")?;
    let (mut points, mut vertices, mut distance) = (Vec::new(), Vec::new(), 0.0);
    for (i, vertex) in path.iter().enumerate() {
        if i == 0 {
            points.push(PathPoint { distance, wave_vector: vertex.wave_vector });
        } else {
            let [start, end] = [path[i - 1].wave_vector, vertex.wave_vector];
            let length = (end[0] - start[0]).root_sum_square(end[1] - start[1]);
            for step in 1..=samples {
                let share = step as f64 / samples as f64;
                let wave_vector =
                    [0, 1].map(|axis| start[axis] + share * (end[axis] - start[axis]));
                points.push(PathPoint { distance: distance + share * length, wave_vector });
            }
            distance += length;
        }
        vertices.push(distance);
    }
    Ok((points, vertices))
}

impl BandSolver {
    /// Creates a solver with the smallest degree for which the lowest `count` frequencies at the vertices of a path are
    /// as accurate as requested.
    ///
    /// # Errors
    /// An iteration for eigenvalues does not converge.
    pub fn new(
        cell: &Cell,
        path: &[ZonePoint],
        count: usize,
        control: &DegreeControl,
    ) -> Result<Self, BlochError> {
        let elastic = cell.map_joints(Joint::instantaneous);
        let (mut degree, mut frequency_error) = (control.first_degree, 0.0f64);
        for (i, point) in path.iter().enumerate() {
            if path[..i].contains(point) {
                continue;
            }
            let found = elastic.solve(point.wave_vector, count, control)?;
            degree = degree.max(found.degree);
            let floor = 4.0 * found.modes.rounding;
            let pairs = found.modes.squared_frequencies.iter().zip(&found.squared_frequencies);
            let errors = pairs
                .filter(|(raw, _)| raw.abs() > floor)
                .map(|(raw, best)| 0.5 * (raw - best).abs() / raw.abs());
            frequency_error = errors.fold(frequency_error.max(found.frequency_error), f64::max);
        }
        Ok(Self {
            model: CellModel::new(cell, degree),
            wave_count: count,
            is_viscous: cell.is_viscous(),
            frequency_error,
        })
    }

    /// Degree of the Legendre polynomials.
    pub fn degree(&self) -> usize {
        self.model.degree()
    }

    /// Galerkin matrices of the cell.
    pub const fn model(&self) -> &CellModel {
        &self.model
    }

    /// Solves for the lowest waves at the wave vector κ, 1/m.
    ///
    /// # Errors
    /// κ is not finite, or the iteration for eigenvalues does not converge.
    pub fn solve(&self, wave_vector: [f64; 2]) -> Result<WavesAtWaveVector, BlochError> {
        match self.is_viscous {
            true => self.solve_damped(wave_vector),
            false => self.solve_elastic(wave_vector),
        }
    }

    fn solve_elastic(&self, wave_vector: [f64; 2]) -> Result<WavesAtWaveVector, BlochError> {
        let modes = self.model.modes(wave_vector, self.wave_count, true)?;
        let length = wave_vector[0].root_sum_square(wave_vector[1]);
        let normal = (length > 0.0).then(|| wave_vector.map(|x| x / length));
        let waves = modes.frequencies().into_iter().enumerate().map(|(index, frequency)| {
            let vector: Vec<Complex64> = modes.eigenvectors.column(index).iter().copied().collect();
            BlochWave {
                frequency,
                decay_rate: 0.0,
                longitudinal_share: normal.map(|n| self.model.longitudinal_share(&vector, n)),
            }
        });
        let least = modes.squared_frequencies.first().copied();
        Ok(WavesAtWaveVector {
            waves: waves.collect(),
            min_squared_frequency: least,
            max_growth_rate: (-least.unwrap_or(0.0)).max(0.0).sqrt(),
            growth_rounding: modes.rounding.sqrt(),
        })
    }

    fn solve_damped(&self, wave_vector: [f64; 2]) -> Result<WavesAtWaveVector, BlochError> {
        let modes = self.model.damped_modes(wave_vector)?;
        // The double eigenvalue zero of the two translations at κ = 0 is perturbed by the square root of the rounding,
        // relative to the largest frequency.
        let largest = modes.frequencies.last().map_or(0.0, |omega| omega.modulus());
        let growth_rounding = (modes.rounding * largest).sqrt();
        let is_zero = |omega: &Complex64| omega.modulus() <= growth_rounding;
        let mut waves = Vec::new();
        if wave_vector == [0.0; 2] {
            waves
                .resize(2, BlochWave { frequency: 0.0, decay_rate: 0.0, longitudinal_share: None });
        }
        let is_translation = |omega: &Complex64| wave_vector == [0.0; 2] && is_zero(omega);
        let own = modes.frequencies.iter().filter(|omega| !is_translation(omega));
        waves.extend(own.map(|omega| BlochWave {
            frequency: omega.re,
            decay_rate: omega.im,
            longitudinal_share: None,
        }));
        waves.truncate(self.wave_count);
        let rates = modes.frequencies.iter().map(|omega| omega.im);
        let growth = rates.chain(modes.decay_rates.iter().copied()).map(|rate| -rate);
        Ok(WavesAtWaveVector {
            waves,
            min_squared_frequency: None,
            max_growth_rate: growth.fold(0.0, f64::max),
            growth_rounding,
        })
    }
}

impl WavesAtWaveVector {
    /// Whether no mode grows by more than rounding.
    pub fn is_stable(&self) -> bool {
        self.max_growth_rate <= self.growth_rounding
    }
}

impl CellModel {
    /// Share ∫|u·n|²/∫|u|² of the displacement along the unit vector n = `normal`, integrated over all blocks.
    pub fn longitudinal_share(&self, unknowns: &[Complex64], normal: [f64; 2]) -> f64 {
        let count = (self.degree() + 1) * (self.degree() + 1);
        let (mut along, mut total) = (0.0, 0.0);
        for block in unknowns.chunks_exact(2 * count) {
            let (first, second) = block.split_at(count);
            for (x, y) in first.iter().zip(second) {
                along += (x * normal[0] + y * normal[1]).norm_sqr();
                total += x.norm_sqr() + y.norm_sqr();
            }
        }
        if total > 0.0 { along / total } else { 0.0 }
    }
}

/// Reorders damped waves at consecutive points so that each index follows a branch: complex frequencies are
/// extrapolated linearly from the two previous points and matched to the nearest ones, but not across the `vertices`
/// (distances, 1/m), where branches have kinks. Branches of undamped waves are already ordered by frequency.
pub fn follow_branches(points: &[PathPoint], vertices: &[f64], waves: &mut [WavesAtWaveVector]) {
    let omega = |wave: &BlochWave| Complex64::new(wave.frequency, wave.decay_rate);
    for i in 1..waves.len() {
        let (before, rest) = waves.split_at_mut(i);
        let Some(last) = before.last() else { continue };
        let has_slope = i >= 2 && !vertices.contains(&points[i - 1].distance);
        let predicted: Vec<Complex64> = last
            .waves
            .iter()
            .enumerate()
            .map(|(branch, wave)| match before.get(i.wrapping_sub(2)) {
                Some(earlier) if has_slope && branch < earlier.waves.len() => {
                    omega(wave) * 2.0 - omega(&earlier.waves[branch])
                }
                _ => omega(wave),
            })
            .collect();
        let found = &mut rest[0].waves;
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (branch, expected) in predicted.iter().enumerate() {
            for (index, wave) in found.iter().enumerate() {
                pairs.push(((omega(wave) - expected).modulus(), branch, index));
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut assigned_indices: Vec<Option<usize>> = vec![None; found.len()];
        for (_, branch, index) in pairs {
            let is_taken = assigned_indices.contains(&Some(branch));
            if branch < found.len() && !is_taken && assigned_indices[index].is_none() {
                assigned_indices[index] = Some(branch);
            }
        }
        let mut free = (0..found.len()).filter(|branch| !assigned_indices.contains(&Some(*branch)));
        let order: Vec<usize> = assigned_indices
            .iter()
            .map(|place| place.or_else(|| free.next()).unwrap_or(0))
            .collect();
        let mut ordered = found.clone();
        for (wave, place) in found.iter().zip(order) {
            ordered[place] = *wave;
        }
        *found = ordered;
    }
}
