//! Branches of the plane waves of a solid: frequencies, speeds and forbidden bands against the wave number.

use super::waves;
use crate::waves::{Family, ForbiddenBand, Mode};
use models::elastoplastic::Solid;
use models::yield_set::tangent::NoResponse;
use num_complex::Complex64;

/// Number of wave numbers of a dispersion curve.
const SAMPLES: usize = 600;

/// Families of plane waves with the same dispersion relation.
#[derive(Clone, Debug)]
pub struct BranchGroup {
    /// Representative family of the group.
    pub family: Family,
    /// Number of families with this dispersion relation.
    pub count: usize,
    /// Forbidden bands: frequency intervals in which no wave of the group propagates.
    pub bands: Vec<ForbiddenBand>,
    /// Whether energy is conserved or dissipated, so that negative ω² is rounding.
    keeps_energy: bool,
}

/// A branch at one wave number, exp(ςt + ikx) with ς = −iω. A complex ω² comes with its conjugate, so one of the four
/// roots ς grows at the rate |Im ω|.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BranchPoint {
    /// Wave number k, 1/m.
    pub number: f64,
    /// Frequency Re ω, rad/s.
    pub frequency: f64,
    /// Growth rate |Im ω|, 1/s.
    pub growth_rate: f64,
    /// Phase speed Re ω/k, m/s.
    pub phase_speed: f64,
    /// Group speed Re dω/dk, m/s; 0 if Re ω = 0.
    pub group_speed: f64,
}

/// Families of plane waves along the unit vector `normal`, of the elastic solid if `stays_elastic`; families whose
/// frequencies agree up to the wave number `greatest` (1/m) are grouped.
///
/// # Errors
/// The rate response of the yielding solid is not defined.
pub fn branches(
    solid: &Solid,
    normal: [f64; 3],
    greatest: f64,
    stays_elastic: bool,
) -> Result<Vec<BranchGroup>, NoResponse> {
    let mut groups: Vec<BranchGroup> = Vec::new();
    for family in waves(solid, normal, stays_elastic)?.families {
        let is_same = |other: &BranchGroup| {
            let at = |f: &Family, k: f64| f.squared_frequencies(k);
            other.family.polarisation == family.polarisation
                && other.family.branches() == family.branches()
                && [0.0, 0.3 * greatest, greatest].iter().all(|&k| {
                    let (a, b) = (at(&other.family, k), at(&family, k));
                    let largest = a.iter().map(|x| x.norm()).fold(0.0, f64::max);
                    a.iter().zip(&b).all(|(x, y)| (x - y).norm() <= 1e-12 * largest)
                })
        };
        match groups.iter_mut().find(|group| is_same(group)) {
            Some(group) => group.count += 1,
            None => {
                let bands = family.forbidden_bands();
                let keeps_energy = stays_elastic || solid.keeps_energy();
                groups.push(BranchGroup { family, keeps_energy, count: 1, bands });
            }
        }
    }
    Ok(groups)
}

/// Wave numbers of a dispersion curve up to `greatest`, 1/m.
fn numbers(greatest: f64) -> impl Iterator<Item = f64> {
    (1..=SAMPLES).map(move |i| greatest * i as f64 / SAMPLES as f64)
}

impl BranchPoint {
    fn new(number: f64, mode: &Mode, keeps_energy: bool) -> Self {
        let square = match keeps_energy {
            true => mode.squared_frequency.re.max(0.0).into(),
            false => mode.squared_frequency,
        };
        let omega = square.sqrt();
        Self {
            number,
            frequency: omega.re,
            growth_rate: omega.im.abs(),
            phase_speed: omega.re / number,
            group_speed: if omega.re == 0.0 { 0.0 } else { (mode.slope / (2.0 * omega)).re },
        }
    }
}

impl BranchGroup {
    /// Name of a branch, numbered from the lowest frequency.
    pub fn label(&self, branch: usize) -> String {
        let place = match (self.family.branches(), branch) {
            (1, _) => String::new(),
            (2, 0) => ", lower branch".into(),
            (2, _) => ", upper branch".into(),
            (_, n) => format!(", branch {}", n + 1),
        };
        let count = if self.count > 1 { format!(" (×{})", self.count) } else { String::new() };
        format!("{}{place}{count}", self.family.polarisation.name())
    }

    /// Curves of all branches up to the wave number `greatest`, 1/m, in 600 points.
    pub fn curves(&self, greatest: f64) -> Vec<Vec<BranchPoint>> {
        let mut curves: Vec<Vec<BranchPoint>> =
            (0..self.family.branches()).map(|_| Vec::new()).collect();
        for k in numbers(greatest) {
            for (curve, point) in curves.iter_mut().zip(self.at(k)) {
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
    pub fn at(&self, number: f64) -> Vec<BranchPoint> {
        let modes = self.family.modes(number);
        modes.iter().map(|mode| BranchPoint::new(number, mode, self.keeps_energy)).collect()
    }

    /// Characteristic speeds c, m/s: real part and magnitude of the imaginary part.
    pub fn speeds(&self) -> Vec<[f64; 2]> {
        let speed = |square: &Complex64| match self.keeps_energy {
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
