//! Elastic waves whose speeds do not depend on the direction.

use super::eigenbasis::{EigenvalueGroups, MAX_VELOCITIES};
use super::secular_equation::{SecularEquation, assemble_secular_equation};
use super::tensor_update::{TensorUpdate, WEIGHT_TOLERANCE};
use super::unit_vectors::dot;

/// Coefficients closer than this, relative to the largest, count as equal.
const EQUALITY_TOLERANCE: f64 = 1e-13;

/// Waves of an isotropic solid: translations and, with couple stress, spins, each a vector with longitudinal waves and
/// two transverse waves, Γₑ(ν) = c_t² I + (c_l² − c_t²) ννᵀ for each vector.
///
/// The eigenvectors are ν and the vectors perpendicular to it, so the weights of the secular equation are
/// w_l = (ν·α)(ν·β) and w_t = α·β − w_l.
#[derive(Clone, Debug)]
pub(super) struct IsotropicWaves {
    /// Squared speeds of longitudinal and transverse waves of translations, then of spins.
    squared_speeds: [f64; 4],
    /// Number of `squared_speeds`: 2, with spins 4.
    count: usize,
    /// Groups of equal eigenvalues.
    groups: EigenvalueGroups,
}

impl IsotropicWaves {
    /// Tests the form Γₑ(n) = Σ nᵢnⱼ Tᵢⱼ of the tensors of pairs of axes 11, 22, 33, 23, 13, 12; `None` if the solid is
    /// not isotropic.
    pub(super) fn new(
        form_tensors: &[[[f64; MAX_VELOCITIES]; MAX_VELOCITIES]; 6],
        velocity_count: usize,
    ) -> Option<Self> {
        if velocity_count != 3 && velocity_count != 6 {
            return None;
        }
        let mut squared_speeds = [0.0; 4];
        let mut expected = [[[0.0; MAX_VELOCITIES]; MAX_VELOCITIES]; 6];
        for vector in 0..velocity_count / 3 {
            let first = 3 * vector;
            let (longitudinal, transverse) =
                (form_tensors[0][first][first], form_tensors[1][first][first]);
            squared_speeds[2 * vector] = longitudinal;
            squared_speeds[2 * vector + 1] = transverse;
            for (tensor, (i, j)) in
                expected.iter_mut().zip([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)])
            {
                if i == j {
                    for axis in 0..3 {
                        tensor[first + axis][first + axis] = transverse;
                    }
                    tensor[first + i][first + i] = longitudinal;
                } else {
                    tensor[first + i][first + j] = longitudinal - transverse;
                    tensor[first + j][first + i] = longitudinal - transverse;
                }
            }
        }
        let entries = || form_tensors.iter().flatten().flatten();
        let largest = entries().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let is_isotropic = entries()
            .zip(expected.iter().flatten().flatten())
            .all(|(x, y)| (x - y).abs() <= EQUALITY_TOLERANCE * largest);
        is_isotropic.then(|| {
            let mut waves =
                Self { squared_speeds, count: 2 * velocity_count / 3, groups: Default::default() };
            waves.group_equal_speeds();
            waves
        })
    }

    fn group_equal_speeds(&mut self) {
        self.groups = EigenvalueGroups::new(&self.eigenvalues()[..self.velocity_count()]);
    }

    /// Number of velocities.
    fn velocity_count(&self) -> usize {
        3 * self.count / 2
    }

    /// Eigenvalues of Γₑ: of each vector that of the longitudinal wave and twice that of the transverse waves.
    pub(super) fn eigenvalues(&self) -> [f64; MAX_VELOCITIES] {
        let [longitudinal, transverse, torsion, rotation] = self.squared_speeds;
        [longitudinal, transverse, transverse, torsion, rotation, rotation]
    }

    /// Groups of equal [`eigenvalues`](Self::eigenvalues).
    pub(super) fn groups(&self) -> &EigenvalueGroups {
        &self.groups
    }

    /// Squared speeds of longitudinal and transverse waves of translations, then, if there are any, of spins.
    pub(super) fn squared_speeds(&self) -> &[f64] {
        &self.squared_speeds[..self.count]
    }

    /// Largest squared speed.
    pub(super) fn fastest(&self) -> f64 {
        self.squared_speeds().iter().fold(0.0, |largest: f64, &x| largest.max(x))
    }

    /// Multiplies the squared speeds by `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        self.squared_speeds = self.squared_speeds.map(|x| x * factor);
        self.group_equal_speeds();
    }

    /// Secular equation in the direction `normal`.
    pub(super) fn secular_equation_at(
        &self,
        update: &TensorUpdate,
        normal: &[f64; 3],
    ) -> SecularEquation {
        let (mut products, mut threshold) = ([[0.0]; MAX_VELOCITIES], [0.0]);
        self.compute_weights(update, &normal.map(|x| [x]), &mut products, &mut threshold);
        let products = products.map(|[product]| product);
        assemble_secular_equation(&self.groups, &products[..self.velocity_count()], threshold[0])
    }

    /// Weights w_g in the place of one velocity of each group, for `N` wave normals, and their thresholds of zero.
    pub(super) fn compute_weights<const N: usize>(
        &self,
        update: &TensorUpdate,
        normals: &[[f64; N]; 3],
        weights: &mut [[f64; N]; MAX_VELOCITIES],
        thresholds: &mut [f64; N],
    ) {
        let (mut squares, mut other_squares) = ([0.0; N], [0.0; N]);
        for first in (0..self.velocity_count()).step_by(3) {
            let (mut along, mut other_along, mut product) = ([0.0; N], [0.0; N], [0.0; N]);
            for axis in 0..3 {
                let (a, b) = (&update.alpha[first + axis], &update.beta[first + axis]);
                for lane in 0..N {
                    let n = [normals[0][lane], normals[1][lane], normals[2][lane]];
                    let (a, b) = (dot(a, &n), dot(b, &n));
                    along[lane] += n[axis] * a;
                    other_along[lane] += n[axis] * b;
                    product[lane] += a * b;
                    squares[lane] += a * a;
                    other_squares[lane] += b * b;
                }
            }
            for lane in 0..N {
                weights[first][lane] = along[lane] * other_along[lane];
                weights[first + 1][lane] = product[lane] - weights[first][lane];
                weights[first + 2][lane] = 0.0;
            }
        }
        for lane in 0..N {
            thresholds[lane] = WEIGHT_TOLERANCE * (squares[lane] * other_squares[lane]).sqrt();
        }
    }
}
