//! Symmetric tensors in the groups of a row.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use crate::simd::{Real, Vector};
use crate::solid::contact_law::TensorPlaces;
use models::rheology::relaxation::SymmetricTensor;

/// Offsets of the components of a symmetric tensor in a group.
#[derive(Clone, Copy)]
pub(super) struct ComponentOffsets<const SHEAR_COUNT: usize> {
    normal: [usize; 3],
    shear: [usize; SHEAR_COUNT],
    /// Upper bound, exclusive, of the offsets.
    extent: usize,
}

impl<const SHEAR_COUNT: usize> ComponentOffsets<SHEAR_COUNT> {
    #[inline(always)]
    pub(super) fn new(places: &TensorPlaces, extent: usize) -> Self {
        let mut own = Self { normal: places.normal, shear: [0; SHEAR_COUNT], extent };
        // Checked once, not in every group.
        for i in 0..3 {
            assert!(own.normal[i] < extent);
        }
        for i in 0..SHEAR_COUNT {
            own.shear[i] = places.shear[i];
            assert!(own.shear[i] < extent);
        }
        own
    }

    #[inline(always)]
    pub(super) fn load<T: Real, V: Vector<T>>(
        &self,
        group: &[T::Lanes],
    ) -> SymmetricTensor<V, SHEAR_COUNT> {
        let group = &group[..self.extent];
        let mut tensor = SymmetricTensor::ZERO;
        for i in 0..3 {
            tensor.normal[i] = V::load(&group[self.normal[i]]);
        }
        for i in 0..SHEAR_COUNT {
            tensor.shear[i] = V::load(&group[self.shear[i]]);
        }
        tensor
    }

    /// Stores all lanes of a tensor.
    #[inline(always)]
    pub(super) fn store_all<T: Real, V: Vector<T>>(
        &self,
        group: &mut [T::Lanes],
        after: &SymmetricTensor<V, SHEAR_COUNT>,
    ) {
        let group = &mut group[..self.extent];
        for i in 0..3 {
            after.normal[i].store(&mut group[self.normal[i]]);
        }
        for i in 0..SHEAR_COUNT {
            after.shear[i].store(&mut group[self.shear[i]]);
        }
    }

    /// Stores the masked lanes of a tensor that had the values `before`.
    #[inline(always)]
    pub(super) fn store<T: Real, V: Vector<T>>(
        &self,
        group: &mut [T::Lanes],
        lanes: u16,
        before: &SymmetricTensor<V, SHEAR_COUNT>,
        after: &SymmetricTensor<V, SHEAR_COUNT>,
    ) {
        let group = &mut group[..self.extent];
        for i in 0..3 {
            let value = before.normal[i].blend_lanes(lanes, after.normal[i]);
            value.store(&mut group[self.normal[i]]);
        }
        for i in 0..SHEAR_COUNT {
            let value = before.shear[i].blend_lanes(lanes, after.shear[i]);
            value.store(&mut group[self.shear[i]]);
        }
    }
}
