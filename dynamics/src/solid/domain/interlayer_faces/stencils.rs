//! Stencils of the reconstruction beside interlayers. The stencil of a face consists of the four groups around it; it
//! is characterised by the lanes with interlayers at the three faces between these groups, which determine its weights.

use super::AxisInterlayers;
use crate::simd::{Number, Real, Vector};
use crate::solid::domain::material_table::MaterialTable;
use crate::solid::reconstruction::InterlayerStencil;

impl<T: Real> AxisInterlayers<T> {
    /// Numbers the different stencils and sets the stencil index of every face. Also computes their reconstruction
    /// weights if `table` holds the constants of all lines along the axis and has a single lane pattern (one medium).
    pub(super) fn set_stencils(&mut self, table: Option<&MaterialTable<T>>) {
        let line_length = match self.pattern_stride {
            0 => self.pattern_indices.len(),
            stride => stride,
        };
        // By stencil, masks of the lanes with interlayers at its three faces; stencil 0 has none.
        let mut stencil_lanes = vec![[0; 3]];
        for line in self.pattern_indices.chunks(line_length) {
            let interlayer_lanes = |place: usize| {
                line.get(place).map_or(0, |index| self.patterns[*index as usize].interlayer_lanes)
            };
            for place in 0..line_length {
                let lanes = [place.wrapping_sub(1), place, place + 1].map(interlayer_lanes);
                let found = stencil_lanes.iter().position(|known| *known == lanes);
                let index = found.unwrap_or_else(|| {
                    stencil_lanes.push(lanes);
                    stencil_lanes.len() - 1
                });
                self.stencil_indices.push(index as u32);
            }
        }
        let Some(table) = table.filter(|table| table.has_single_pattern()) else { return };
        self.cells_per_stencil = table.cells_per_pattern;
        for lanes in stencil_lanes {
            let continuity = lanes.map(|mask| T::Lanes::ONE.blend_lanes(mask, T::Lanes::ZERO));
            let to_stencil = |cell| InterlayerStencil::new(cell, continuity);
            self.stencils.extend(table.cell_constants.iter().map(to_stencil));
        }
    }
}
