//! What acts in a cell between sweeps: the rotation of spins against antisymmetric stress, relaxation, and the yield sets.

use super::materials::Materials;
use super::plastic::Sets;
use super::relaxation::Relaxations;
use crate::simd::{Group, Real};
use crate::solid::medium::Medium;
use models::common::elementary::Elementary;
use models::solid::stress::Stress;
use models::solid::waves::Field;

/// Constants of the rotation of a spin and antisymmetric stress by a time: cos, √(αj) sin, sin/√(αj).
pub(super) type SpinStressRotation<N> = [N; 3];

/// Local laws by lane pattern.
#[derive(Clone)]
pub(super) struct LocalLaws<T: Real> {
    /// Rotations over a whole and over half a step.
    pub(super) rotations: Vec<[SpinStressRotation<T::Lanes>; 2]>,
    /// Places of a spin and of both stresses that rotate against each other.
    pub(super) rotated: Vec<[usize; 3]>,
    /// Relaxation of stresses; `None` where nothing relaxes.
    pub(super) relaxations: Option<Relaxations<T>>,
    /// Whether any lane of a pattern yields.
    pub(super) yields: Vec<bool>,
    /// Yield sets in lanes.
    pub(super) sets: Option<Sets<T>>,
    /// The axis along which the initial stress varies, and the stress in each layer across it.
    pub(super) initial_stress: Option<(usize, Vec<Stress>)>,
}

/// Places of spins and of the stresses that rotate with them, where fields are so far apart.
pub(super) fn rotated_fields(fields: &[Field], pitch: usize) -> Vec<[usize; 3]> {
    let place = |field: Field| Some(fields.iter().position(|own| *own == field)? * pitch);
    let triple = |k: usize| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        Some([place(Field::Spin(k))?, place(Field::Stress(i, j))?, place(Field::Stress(j, i))?])
    };
    (0..3).filter_map(triple).collect()
}

impl<T: Real> LocalLaws<T> {
    /// Those of media, by pattern, for a time step, s.
    pub(super) fn new<const D: usize>(
        materials: &Materials<T, D>,
        patterns: &[Vec<u16>],
        pitch: usize,
        step: f64,
        initial_stress: Option<(usize, Vec<Stress>)>,
    ) -> Self {
        let (media, fields) = (&materials.media, &materials.fields);
        let rotation = |medium: &Medium, part: f64| {
            let Some(rotation) = medium.rotation else { return [1.0, 0.0, 0.0] };
            let (sin, cos) = (rotation.frequency * part * step).cr_sin_cos();
            [cos, rotation.ratio * sin, sin / rotation.ratio]
        };
        let rotations = patterns.iter().map(|pattern| {
            [1.0, 0.5].map(|part| {
                [0, 1, 2].map(|which| {
                    let own = |lane: usize| rotation(&media[usize::from(pattern[lane])], part);
                    T::Lanes::by_lane(|lane| T::of(own(lane)[which]))
                })
            })
        });
        let yields = |medium: &u16| media[usize::from(*medium)].yields.is_some();
        let is_plastic = media.iter().any(|medium| medium.yields.is_some());
        Self {
            rotations: rotations.collect(),
            rotated: rotated_fields(fields, pitch),
            relaxations: Relaxations::new(media, patterns, fields, pitch, step),
            yields: patterns.iter().map(|pattern| pattern.iter().any(yields)).collect(),
            sets: Sets::new(media, patterns, pitch).filter(|_| is_plastic),
            initial_stress,
        }
    }
}
