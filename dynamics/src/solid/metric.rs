//! Blocks in the plane whose cells along the first axis have another length in each layer across the second one; polar blocks.
//!
//! Such a block solves
//!
//! ```text
//! A ∂ₜU = (1/h) B¹ ∂_ξ U + B² ∂_y U + κ Q̂ U
//! ```
//!
//! with ξ in cells along the first axis, h(y) their length and κ(y) the curvature of the lines along it. B¹ and B² are
//! symmetric and Q̂ is antisymmetric, so that ½∫U·AU dξ dy is conserved: all cells have one volume, and all that is proved
//! of sweeps holds.
//!
//! In polar coordinates, with the angle along the first axis and the radius along the second one, h = r Δθ, κ = 1/r, and the
//! fields are U = √r (v, σ): the root makes volumes uniform and Q̂ antisymmetric (in the plane of (v_r, σ_rr): ½; of
//! (v_r, σ_θθ): −1; of (v_θ, σ_rθ) of a symmetric stress: 3/2).

use crate::simd::Number;
use crate::solid::medium::Medium;
use models::solid::waves::Field;

/// Lengths and curvatures by layer across the second axis of a block in the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// Length of a cell along the first axis, m.
    pub spacing: Vec<f64>,
    /// Curvature of the lines along the first axis, whose centre is towards smaller coordinates of the second one, 1/m;
    /// none where lines are straight.
    pub curvature: Vec<f64>,
}

impl Metric {
    /// A polar block: so many layers of this width, m, from an inner radius on, m, and cells of this angle. Fields are √r
    /// times the physical ones, and the spacing of the grid is the angle and the width.
    pub fn polar(inner: f64, layers: usize, [angle, width]: [f64; 2]) -> Self {
        let radii = (0..layers).map(|layer| inner + (layer as f64 + 0.5) * width);
        Self {
            spacing: radii.clone().map(|radius| radius * angle).collect(),
            curvature: radii.map(f64::recip).collect(),
        }
    }

    /// The least length of a cell along the first axis, m.
    pub(crate) fn least_spacing(&self) -> f64 {
        self.spacing.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// Whether it is one of so many layers.
    pub(crate) fn is_sound(&self, layers: usize) -> bool {
        let is_positive = |value: &f64| *value > 0.0 && value.is_finite();
        self.spacing.len() == layers
            && self.spacing.iter().all(is_positive)
            && (self.curvature.is_empty() || self.curvature.len() == layers)
            && self.curvature.iter().all(|value| value.is_finite())
    }
}

/// A plane of phase space in which the geometry rotates the state: a velocity or spin v of inertia m against the stresses
/// y = q·σ,
///
/// ```text
/// m v̇ = κ y,  σ̇ = −κ Cq v,
/// ```
///
/// where Cq are the stresses of strains q. With Ω² = q·Cq/m it is a rotation by the angle κΩt.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GeometricPlane {
    /// Place of v in the list of fields.
    pub(crate) velocity: usize,
    /// Places of stresses, and q.
    pub(crate) weights: Vec<(usize, f64)>,
    /// Places of stresses, and Cq, Pa or N.
    pub(crate) moduli: Vec<(usize, f64)>,
    /// m, kg/m³ or kg/m.
    inertia: f64,
    /// Ω, m/s.
    frequency: f64,
}

impl GeometricPlane {
    /// Those of a medium of the plane: along the second axis half of each pair's own stress acts; and the first axis turns
    /// the direction of velocities, so that stresses across it act on the other one.
    pub(crate) fn of_medium(medium: &Medium) -> Vec<Self> {
        let [across, along] = [0, 1].map(|axis| &medium.pairs[axis]);
        let place = |field: Field| medium.fields.iter().position(|own| *own == field);
        let plane = |pair: &models::solid::waves::Pair| {
            let mut weights = vec![(pair.stress, 0.5)];
            let turned = match pair.velocity {
                Field::Velocity(0) => Some((Field::Velocity(1), 1.0)),
                Field::Velocity(1) => Some((Field::Velocity(0), -1.0)),
                _ => None,
            };
            if let Some((other, weight)) = turned {
                let pairs = across.iter().filter(|own| own.velocity == other);
                weights.extend(pairs.map(|own| (own.stress, weight)));
            }
            let mut merged: Vec<(usize, f64)> = Vec::new();
            for (field, weight) in weights {
                let place = place(field)?;
                match merged.iter_mut().find(|own| own.0 == place) {
                    Some(own) => own.1 += weight,
                    None => merged.push((place, weight)),
                }
            }
            let mut moduli = vec![0.0; medium.fields.len()];
            for &(index, weight) in &merged {
                let pairs = || across.iter().chain(along);
                let own = pairs().find(|own| own.stress == medium.fields[index])?;
                moduli[index] += weight * own.modulus;
                for (passive, ratio) in &own.passive_stresses {
                    moduli[place(*passive)?] += weight * ratio * own.modulus;
                }
            }
            let stiffness: f64 = merged.iter().map(|&(index, weight)| weight * moduli[index]).sum();
            let moduli = moduli.into_iter().enumerate().filter(|(_, value)| *value != 0.0);
            Some(Self {
                velocity: place(pair.velocity)?,
                weights: merged,
                moduli: moduli.collect(),
                inertia: pair.inertia,
                frequency: (stiffness / pair.inertia).sqrt(),
            })
        };
        along.iter().filter_map(plane).collect()
    }

    /// Cq at a place.
    pub(crate) fn modulus(&self, place: usize) -> f64 {
        self.moduli.iter().find(|own| own.0 == place).map_or(0.0, |own| own.1)
    }

    /// Constants of the rotation of lines of a curvature, 1/m, over a time, s: cos φ, sin φ/(mΩ), sin φ/Ω and
    /// (1 − cos φ)/(mΩ²), φ = κΩt.
    pub(crate) fn rotation(&self, curvature: f64, time: f64) -> [f64; 4] {
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

/// v after such a rotation, and the strain times which Cq is lost.
#[inline(always)]
pub(crate) fn rotated_by_geometry<N: Number>([cos, a, b, c]: [N; 4], v: N, y: N) -> [N; 2] {
    [cos * v + a * y, b * v + c * y]
}
