//! Band structure on paths of the Brillouin zone, band gaps over the zone, speeds of long waves, stability.

use super::cell::{Cell, CellModel, DegreeControl};
use super::{BlochError, ensure};
use models::common::elementary::Elementary;
use std::f64::consts::PI;

/// Named vertex of the Brillouin zone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZonePoint {
    /// Name: Γ, X, M, Y.
    pub name: &'static str,
    /// Wave vector κ, 1/m.
    pub wave_vector: [f64; 2],
}

/// Frequencies along a path of the Brillouin zone.
#[derive(Clone, Debug, PartialEq)]
pub struct BandStructure {
    /// Vertices of the path with their distance along the path, 1/m.
    pub vertices: Vec<(f64, ZonePoint)>,
    /// Frequencies at points along the path, in its order.
    pub samples: Vec<BandSample>,
    /// Degree of the Legendre polynomials.
    pub degree: usize,
    /// Estimate of the largest relative error of a frequency at the vertices, by extrapolation to infinite degree.
    pub frequency_error: f64,
    /// Whether all frequencies of all samples are real within rounding: no wave grows.
    pub is_stable: bool,
}

/// Frequencies at a point of a path.
#[derive(Clone, Debug, PartialEq)]
pub struct BandSample {
    /// Distance along the path, 1/m.
    pub distance: f64,
    /// Wave vector κ, 1/m.
    pub wave_vector: [f64; 2],
    /// Angular frequencies, rad/s, ascending.
    pub frequencies: Vec<f64>,
}

/// Total band gap: an interval of angular frequencies without Bloch wave of any wave vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TotalGap {
    /// Number of branches below the gap.
    pub bands_below: usize,
    /// Lower edge, rad/s: the largest frequency of the band below, with its wave vector, 1/m.
    pub lower: (f64, [f64; 2]),
    /// Upper edge, rad/s: the smallest frequency of the band above, with its wave vector, 1/m.
    pub upper: (f64, [f64; 2]),
}

/// Speeds of long waves in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongWaveSpeeds {
    /// Speeds, m/s, the slower first.
    pub speeds: [f64; 2],
    /// Estimate of the relative error of the extrapolation κ → 0.
    pub error: f64,
}

/// Phase shifts |κ|h, rad, from which speeds are extrapolated to κ → 0, with the larger period h; each half the one
/// before.
const LONG_WAVE_SHIFTS: [f64; 3] = [0.2, 0.1, 0.05];
/// Number of halvings of the step in the compass search (pattern search) for a band edge.
const COMPASS_SEARCH_HALVINGS: usize = 12;

impl Cell {
    /// Vertices of the Brillouin zone of the cell: Γ, X = (π/H₁, 0), M = (π/H₁, π/H₂) and Y = (0, π/H₂).
    pub fn zone_points(&self) -> [ZonePoint; 4] {
        let [x, y] = self.periods().map(|period| PI / period);
        let point = |name, wave_vector| ZonePoint { name, wave_vector };
        [point("Γ", [0.0, 0.0]), point("X", [x, 0.0]), point("M", [x, y]), point("Y", [0.0, y])]
    }

    /// Vertices of the path Γ–X–M–Γ, continued to Y if the periods differ.
    pub fn standard_path(&self) -> Vec<ZonePoint> {
        let [gamma, x, m, y] = self.zone_points();
        let [width, height] = self.periods();
        match width == height {
            true => vec![gamma, x, m, gamma],
            false => vec![gamma, x, m, gamma, y],
        }
    }

    /// Frequencies of the lowest `count` branches along a path with `samples` ≥ 1 steps on each side. From
    /// `control.first_degree` the degree is raised by 2 until the frequencies at the vertices are as accurate as
    /// requested.
    ///
    /// # Errors
    /// A wave vector is not finite, `samples` is 0, or an iteration for eigenvalues does not converge.
    pub fn band_structure(
        &self,
        path: &[ZonePoint],
        count: usize,
        samples: usize,
        control: &DegreeControl,
    ) -> Result<BandStructure, BlochError> {
        ensure(samples > 0, "samples", samples, "at least 1")?;
        let (mut degree, mut frequency_error) = (control.first_degree, 0.0f64);
        for point in path {
            let converged = self.solve(point.wave_vector, count, control)?;
            degree = degree.max(converged.degree);
            let floor = 4.0 * converged.modes.rounding;
            let pairs =
                converged.modes.squared_frequencies.iter().zip(&converged.squared_frequencies);
            let errors = pairs
                .filter(|(raw, _)| raw.abs() > floor)
                .map(|(raw, best)| 0.5 * (raw - best).abs() / raw.abs());
            frequency_error = errors.fold(frequency_error.max(converged.frequency_error), f64::max);
        }
        let model = CellModel::new(self, degree);
        let mut structure = BandStructure {
            vertices: Vec::new(),
            samples: Vec::new(),
            degree,
            frequency_error,
            is_stable: true,
        };
        let mut add = |distance: f64, wave_vector: [f64; 2]| -> Result<(), BlochError> {
            let modes = model.modes(wave_vector, count, false)?;
            structure.is_stable &= modes.is_stable();
            let frequencies = modes.frequencies();
            structure.samples.push(BandSample { distance, wave_vector, frequencies });
            Ok(())
        };
        let mut distance = 0.0;
        let mut vertices = Vec::new();
        for (i, point) in path.iter().enumerate() {
            if i == 0 {
                add(0.0, point.wave_vector)?;
            } else {
                let [start, end] = [path[i - 1].wave_vector, point.wave_vector];
                let length = (end[0] - start[0]).root_sum_square(end[1] - start[1]);
                for step in 1..=samples {
                    let share = step as f64 / samples as f64;
                    let at = [0, 1].map(|axis| start[axis] + share * (end[axis] - start[axis]));
                    add(distance + share * length, at)?;
                }
                distance += length;
            }
            vertices.push((distance, *point));
        }
        structure.vertices = vertices;
        Ok(structure)
    }

    /// Speeds of the two long waves along the unit vector `normal`: ω/κ at three wave numbers, extrapolated to κ = 0 in
    /// powers of κ².
    ///
    /// # Errors
    /// The vector is not finite, or an iteration for eigenvalues does not converge.
    pub fn long_wave_speeds(
        &self,
        normal: [f64; 2],
        degree: usize,
    ) -> Result<LongWaveSpeeds, BlochError> {
        let model = CellModel::new(self, degree);
        let [width, height] = self.periods();
        let period = width.max(height);
        let mut squares = [[0.0; 2]; 3];
        for (square, shift) in squares.iter_mut().zip(LONG_WAVE_SHIFTS) {
            let wave_number = shift / period;
            let modes = model.modes(normal.map(|x| wave_number * x), 2, false)?;
            for (square, found) in square.iter_mut().zip(&modes.squared_frequencies) {
                *square = found / (wave_number * wave_number);
            }
        }
        let mut result = LongWaveSpeeds { speeds: [0.0; 2], error: 0.0 };
        for (index, speed) in result.speeds.iter_mut().enumerate() {
            let [first, second, third] = squares.map(|square| square[index]);
            let [coarse, fine] = [second + (second - first) / 3.0, third + (third - second) / 3.0];
            let best = fine + (fine - coarse) / 15.0;
            *speed = best.max(0.0).sqrt();
            result.error = result.error.max(0.5 * (best - fine).abs() / best.abs());
        }
        Ok(result)
    }
}

impl CellModel {
    /// Total band gaps among the lowest `count` branches, from `samples` × 2`samples` wave vectors in half the
    /// Brillouin zone (ω(−κ) = ω(κ)) and its vertices; a compass search refines the edges. The search is local: a gap
    /// may be narrower if a band has another, larger extremum between samples.
    ///
    /// # Errors
    /// `samples` is 0, or an iteration for eigenvalues does not converge.
    pub fn total_gaps(&self, count: usize, samples: usize) -> Result<Vec<TotalGap>, BlochError> {
        ensure(samples > 0, "samples", samples, "at least 1")?;
        let steps = self.periods.map(|period| PI / period / samples as f64);
        // Frequencies ascend, so their index is that of the branch.
        let frequencies = |wave_vector: [f64; 2]| -> Result<Vec<f64>, BlochError> {
            Ok(self.modes(wave_vector, count, false)?.frequencies())
        };
        // Smallest and largest frequency of each band with the wave vector.
        let mut extremes: Vec<[(f64, [f64; 2]); 2]> = Vec::new();
        let samples = samples as i32;
        for i in 0..=samples {
            for j in (1 - samples)..=samples {
                let at = [f64::from(i) * steps[0], f64::from(j) * steps[1]];
                for (band, frequency) in frequencies(at)?.into_iter().enumerate() {
                    if band == extremes.len() {
                        extremes.push([(frequency, at); 2]);
                    }
                    let [least, largest] = &mut extremes[band];
                    if frequency < least.0 {
                        *least = (frequency, at);
                    }
                    if frequency > largest.0 {
                        *largest = (frequency, at);
                    }
                }
            }
        }
        let refine = |band: usize, start: (f64, [f64; 2]), sign: f64| {
            let (mut best, mut scale) = (start, 0.5);
            for _ in 0..COMPASS_SEARCH_HALVINGS {
                let mut is_better = true;
                while is_better {
                    is_better = false;
                    for [x, y] in [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]] {
                        let [first, second] = best.1;
                        let at = [first + scale * x * steps[0], second + scale * y * steps[1]];
                        let frequency = frequencies(at)?.get(band).copied().unwrap_or(best.0);
                        // Relative changes below 1e-12 are rounding.
                        if sign * (frequency - best.0) > 1e-12 * best.0 {
                            (best, is_better) = ((frequency, at), true);
                        }
                    }
                }
                scale *= 0.5;
            }
            Ok::<_, BlochError>(best)
        };
        let mut gaps = Vec::new();
        for (below, pair) in extremes.windows(2).enumerate() {
            let ([_, lower], [upper, _]) = (pair[0], pair[1]);
            if upper.0 <= lower.0 {
                continue;
            }
            let (lower, upper) = (refine(below, lower, 1.0)?, refine(below + 1, upper, -1.0)?);
            if upper.0 > lower.0 {
                gaps.push(TotalGap { bands_below: below + 1, lower, upper });
            }
        }
        Ok(gaps)
    }
}
