//! Plane blocks whose cell length along the first axis varies by layer across the second axis; polar blocks.
//!
//! Such a block solves
//!
//! ```text
//! A ∂ₜU = (1/h) B¹ ∂_ξ U + B² ∂_y U + κ Q̂ U
//! ```
//!
//! with the state U = (v, σ), ξ in cells along the first axis, the cell length h(y), and the curvature κ(y) of the
//! lines along that axis. A, B¹ and B² are symmetric and Q̂ is antisymmetric, so that ½∫U·AU dξ dy is conserved: all
//! cells have the same volume, and the energy estimates of the sweeps hold.
//!
//! In polar coordinates (angle along the first axis, radius along the second), h = r Δθ, κ = 1/r and U = √r (v, σ): the
//! factor √r makes volumes uniform and Q̂ antisymmetric. Entries of Q̂: ½ for (v_r, σ_rr), −1 for (v_r, σ_θθ), 3/2 for
//! (v_θ, σ_rθ) of a symmetric stress.
//!
//! Laws with thresholds (yield sets, contacts) hold for the physical fields U/f, f = √r. The laws are homogeneous: if
//! fields and thresholds (strength, porosity) are multiplied by f, so are the results, and energies by f². Thresholds of
//! the layer are therefore f times those of the medium, history variables are stored with the factor f, and the
//! dissipation of a cell, per unit of the uniform volume, is the true one. The rotation by the curvature conserves the
//! energy of closed contacts as sweeps do; its strain increment reaches the laws of contacts in the same way, through
//! the change −Cq e of the stress, so that a law completes the rotation as it completes a sweep.

use crate::simd::Number;
use crate::solid::medium::Medium;
use models::solid::waves::SolidField;

/// Cell length and curvature by layer across the second axis of a plane block.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// By layer, length of a cell along the first axis, m.
    pub spacing: Vec<f64>,
    /// By layer, curvature of the lines along the first axis, 1/m, positive if the centre of curvature is at smaller
    /// coordinates of the second axis; empty if the lines are straight.
    pub curvature: Vec<f64>,
    /// By layer, the ratio f > 0 of the fields to the physical ones, √m in polar blocks; empty if it is 1.
    pub field_factors: Vec<f64>,
}

impl Metric {
    /// Creates the metric of a polar block: inner radius, m, number of layers, cell angle, rad, and layer width, m.
    /// Fields are √r times the physical ones; the grid spacing is \[angle, width\].
    pub fn new_polar(inner: f64, layers: usize, [angle, width]: [f64; 2]) -> Self {
        let radii = (0..layers).map(|layer| inner + (layer as f64 + 0.5) * width);
        Self {
            spacing: radii.clone().map(|radius| radius * angle).collect(),
            curvature: radii.clone().map(f64::recip).collect(),
            field_factors: radii.map(f64::sqrt).collect(),
        }
    }

    /// Returns the smallest cell length along the first axis, m.
    pub(crate) fn min_spacing(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Returns whether each of `layers` layers has a positive, finite cell length and, unless all lines are straight, a
    /// finite curvature.
    pub(crate) fn is_valid(&self, layers: usize) -> bool {
        let is_positive = |value: &f64| *value > 0.0 && value.is_finite();
        self.spacing.len() == layers
            && self.spacing.iter().all(is_positive)
            && (self.curvature.is_empty() || self.curvature.len() == layers)
            && self.curvature.iter().all(|value| value.is_finite())
            && (self.field_factors.is_empty() || self.field_factors.len() == layers)
            && self.field_factors.iter().all(is_positive)
    }
}

/// Plane of the state space in which the curvature κ, 1/m, rotates the state: a velocity or spin v of inertia m and the
/// weighted sum of stresses y = q·σ,
///
/// ```text
/// m v̇ = κ y,  σ̇ = −κ Cq v,
/// ```
///
/// where Cq is the stress of the strain q. With Ω² = q·Cq/m this is a rotation by the angle κΩt over a time t.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CurvatureRotation {
    /// Field index of the velocity or spin v.
    pub(crate) velocity: usize,
    /// Field indices of stresses, and entries of q.
    pub(crate) weights: Vec<(usize, f64)>,
    /// Field indices of stresses, and entries of Cq, Pa or N.
    pub(crate) moduli: Vec<(usize, f64)>,
    /// Inertia m of v: kg/m³ for a velocity, kg/m for a spin.
    inertia: f64,
    /// Ω, m/s: rotation angle per curvature and time.
    frequency: f64,
}

impl CurvatureRotation {
    /// Creates the planes of each medium. All media have the same entries of Cq, zeros where a medium does not couple to the
    /// stress: subtracting a zero changes the sign of another one, and cells of all media go through the same operations.
    pub(crate) fn from_media(media: &[Medium]) -> Vec<Vec<Self>> {
        let mut all: Vec<Vec<Self>> = media.iter().map(Self::from_medium).collect();
        for plane in 0..all.first().map_or(0, Vec::len) {
            let mut indices: Vec<usize> =
                all.iter().flat_map(|own| &own[plane].moduli).map(|own| own.0).collect();
            indices.sort_unstable();
            indices.dedup();
            for own in &mut all {
                own[plane].moduli =
                    indices.iter().map(|&index| (index, own[plane].modulus(index))).collect();
            }
        }
        all
    }

    /// Creates the planes of a medium, one for each wave pair along the second axis. Along the second axis, half of the
    /// stress of each wave pair enters q; along the first axis the direction of velocities rotates, so that stresses on
    /// faces normal to that axis act on the other velocity.
    fn from_medium(medium: &Medium) -> Vec<Self> {
        let [across, along] = [0, 1].map(|axis| &medium.pairs[axis]);
        let field_index = |field: SolidField| medium.fields.iter().position(|own| *own == field);
        let plane = |pair: &models::solid::waves::VelocityStressPair| {
            let mut weights = vec![(pair.stress, 0.5)];
            let rotated_velocity = match pair.velocity {
                SolidField::Velocity(0) => Some((SolidField::Velocity(1), 1.0)),
                SolidField::Velocity(1) => Some((SolidField::Velocity(0), -1.0)),
                _ => None,
            };
            if let Some((other, weight)) = rotated_velocity {
                let pairs = across.iter().filter(|own| own.velocity == other);
                weights.extend(pairs.map(|own| (own.stress, weight)));
            }
            let mut merged: Vec<(usize, f64)> = Vec::new();
            for (field, weight) in weights {
                let index = field_index(field)?;
                match merged.iter_mut().find(|own| own.0 == index) {
                    Some(own) => own.1 += weight,
                    None => merged.push((index, weight)),
                }
            }
            let mut moduli = vec![0.0; medium.fields.len()];
            for &(index, weight) in &merged {
                let pairs = || across.iter().chain(along);
                let stress_pair =
                    pairs().find(|stress_pair| stress_pair.stress == medium.fields[index])?;
                moduli[index] += weight * stress_pair.modulus;
                for (passive, ratio) in &stress_pair.passive_stresses {
                    moduli[field_index(*passive)?] += weight * ratio * stress_pair.modulus;
                }
            }
            let stiffness: f64 = merged.iter().map(|&(index, weight)| weight * moduli[index]).sum();
            let moduli = moduli.into_iter().enumerate().filter(|(_, value)| *value != 0.0);
            Some(Self {
                velocity: field_index(pair.velocity)?,
                weights: merged,
                moduli: moduli.collect(),
                inertia: pair.inertia,
                frequency: (stiffness / pair.inertia).sqrt(),
            })
        };
        along.iter().filter_map(plane).collect()
    }

    /// Returns the entry of Cq for a field, given by its index, Pa or N; 0 if there is none.
    fn modulus(&self, index: usize) -> f64 {
        self.moduli.iter().find(|own| own.0 == index).map_or(0.0, |own| own.1)
    }

    /// Computes the rotation coefficients for a curvature κ, 1/m, and a time t, s: cos φ, sin φ/(mΩ), sin φ/Ω and (1 −
    /// cos φ)/(mΩ²), φ = κΩt.
    pub(crate) fn coefficients(&self, curvature: f64, time: f64) -> [f64; 4] {
        use models::common::elementary::Elementary;
        let Self { inertia, frequency, .. } = *self;
        let angle = curvature * frequency * time;
        let ((sin, cos), (half_sin, _)) = (angle.cr_sin_cos(), (0.5 * angle).cr_sin_cos());
        let one_less_cos = 2.0 * half_sin * half_sin;
        [
            cos,
            sin / (inertia * frequency),
            sin / frequency,
            one_less_cos / (inertia * frequency * frequency),
        ]
    }
}

/// Rotates v and y by the coefficients of [`CurvatureRotation::coefficients`]: returns the new v and the scalar e of
/// the stress change −Cq e.
#[inline(always)]
pub(crate) fn rotate_pair_by_curvature<N: Number>([cos, a, b, c]: [N; 4], v: N, y: N) -> [N; 2] {
    [cos * v + a * y, b * v + c * y]
}
