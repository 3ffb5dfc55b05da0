//! Branches of the plane waves of a solid: frequencies, speeds and band gaps against the wave number.

use super::directional_waves;
use crate::waves::{FrequencyInterval, WaveFamily, WaveMode};
use models::common::elementary::Modulus;
use models::elastoplastic::Solid;
use models::yield_set::tangent::NoResponse;
use num_complex::Complex64;

/// Number of wave numbers of a dispersion curve.
const CURVE_SAMPLES: usize = 600;

/// Families of plane waves with the same dispersion relation.
#[derive(Clone, Debug)]
pub struct BranchGroup {
    /// Representative family of the group.
    pub family: WaveFamily,
    /// Number of families with this dispersion relation.
    pub family_count: usize,
    /// Band gaps: frequency intervals in which no wave of the group propagates.
    pub band_gaps: Vec<FrequencyInterval>,
    /// Whether energy is conserved or dissipated, so that negative ω² is rounding.
    is_symmetric_hyperbolic: bool,
}

/// A branch at one wave number, exp(ςt + ikx) with ς = −iω. A complex ω² comes with its conjugate, so one of the four
/// roots ς grows at the rate |Im ω|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchPoint {
    /// Wave number k, 1/m.
    pub wave_number: f64,
    /// Frequency Re ω, rad/s.
    pub frequency: f64,
    /// Growth rate |Im ω|, 1/s.
    pub growth_rate: f64,
    /// Phase speed Re ω/k, m/s.
    pub phase_speed: f64,
    /// Group speed Re dω/dk, m/s; 0 if Re ω = 0.
    pub group_speed: f64,
}

/// Families of plane waves along the unit vector `normal`, of the elastic solid if `is_elastic`; families of the same
/// polarisation are grouped if their frequencies agree at 0, 0.3 and 1 times the wave number `max_wave_number` (1/m).
///
/// # Errors
/// The rate response of the yielding solid is not defined.
pub fn group_branches(
    solid: &Solid,
    normal: [f64; 3],
    max_wave_number: f64,
    is_elastic: bool,
) -> Result<Vec<BranchGroup>, NoResponse> {
    let mut groups: Vec<BranchGroup> = Vec::new();
    for family in directional_waves(solid, normal, is_elastic)?.families {
        let is_same = |other: &BranchGroup| {
            let at = |f: &WaveFamily, k: f64| f.squared_frequencies(k);
            other.family.polarisation == family.polarisation
                && other.family.branch_count() == family.branch_count()
                && [0.0, 0.3 * max_wave_number, max_wave_number].iter().all(|&k| {
                    let (a, b) = (at(&other.family, k), at(&family, k));
                    let largest = a.iter().map(|x| x.modulus()).fold(0.0, f64::max);
                    a.iter().zip(&b).all(|(x, y)| (x - y).modulus() <= 1e-12 * largest)
                })
        };
        match groups.iter_mut().find(|group| is_same(group)) {
            Some(group) => group.family_count += 1,
            None => {
                let band_gaps = family.band_gaps();
                let is_symmetric_hyperbolic = is_elastic || solid.is_symmetric_hyperbolic();
                groups.push(BranchGroup {
                    family,
                    is_symmetric_hyperbolic,
                    family_count: 1,
                    band_gaps,
                });
            }
        }
    }
    Ok(groups)
}

/// Wave numbers of a dispersion curve up to `max_wave_number`, 1/m.
fn sample_wave_numbers(max_wave_number: f64) -> impl Iterator<Item = f64> {
    (1..=CURVE_SAMPLES).map(move |i| max_wave_number * i as f64 / CURVE_SAMPLES as f64)
}

impl BranchPoint {
    fn new(wave_number: f64, mode: &WaveMode, is_symmetric_hyperbolic: bool) -> Self {
        let square = match is_symmetric_hyperbolic {
            // `max` would turn NaN into zero, and hide an overflow.
            true if mode.squared_frequency.re < 0.0 => Complex64::ZERO,
            true => mode.squared_frequency.re.into(),
            false => mode.squared_frequency,
        };
        let omega = square.sqrt();
        Self {
            wave_number,
            frequency: omega.re,
            growth_rate: omega.im.abs(),
            phase_speed: omega.re / wave_number,
            group_speed: if omega.re == 0.0 { 0.0 } else { (mode.slope / (2.0 * omega)).re },
        }
    }
}

impl BranchGroup {
    /// Name of a branch, numbered from the lowest frequency.
    pub fn label(&self, branch: usize) -> String {
        let place = match (self.family.branch_count(), branch) {
            (1, _) => String::new(),
            (2, 0) => ", lower branch".into(),
            (2, _) => ", upper branch".into(),
            (_, n) => format!(", branch {}", n + 1),
        };
        let count = match self.family_count {
            1 => String::new(),
            2 => " (double)".to_owned(),
            count => format!(" ({count}-fold)"),
        };
        format!("{}{place}{count}", self.family.polarisation.name())
    }

    /// Curves of all branches up to the wave number `max_wave_number`, 1/m, in 600 points.
    pub fn curves(&self, max_wave_number: f64) -> Vec<Vec<BranchPoint>> {
        let mut curves: Vec<Vec<BranchPoint>> =
            (0..self.family.branch_count()).map(|_| Vec::new()).collect();
        for k in sample_wave_numbers(max_wave_number) {
            for (curve, point) in curves.iter_mut().zip(self.points_at(k)) {
                curve.push(point);
            }
        }
        curves
    }

    /// Nonzero cut-off frequencies (ω at k = 0), rad/s.
    pub fn cut_offs(&self) -> Vec<f64> {
        let squares = self.family.squared_cut_offs();
        let largest = squares.iter().map(|x| x.re).fold(0.0, f64::max);
        squares.iter().filter(|x| x.re > 1e-12 * largest).map(|x| x.re.sqrt()).collect()
    }

    /// All branches at one wave number, 1/m.
    pub fn points_at(&self, wave_number: f64) -> Vec<BranchPoint> {
        let modes = self.family.modes(wave_number);
        modes
            .iter()
            .map(|mode| BranchPoint::new(wave_number, mode, self.is_symmetric_hyperbolic))
            .collect()
    }

    /// Characteristic speeds c, m/s: real part and magnitude of the imaginary part.
    pub fn speeds(&self) -> Vec<[f64; 2]> {
        let speed = |square: &Complex64| match self.is_symmetric_hyperbolic {
            true => [square.re.max(0.0).sqrt(), 0.0],
            false => [square.sqrt().re, square.sqrt().im.abs()],
        };
        self.family.squared_speeds().iter().map(speed).collect()
    }

    /// Limits of the frequencies of branches of speed zero as k → ∞, rad/s.
    pub fn short_wave_limits(&self) -> Vec<f64> {
        self.family.squared_short_wave_limits().iter().map(|x| x.max(0.0).sqrt()).collect()
    }
}
