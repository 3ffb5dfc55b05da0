//! Places of the history variables of interlayers in memory, by layers and rows.

use super::LaneInterlayers;
use crate::simd::Real;
use crate::solid::domain::layout::Layout;
use std::ops::Range;

impl<T: Real, const D: usize> LaneInterlayers<T, D> {
    /// Returns the ranges of all history variables of `rows` of a layer.
    pub(in crate::solid::domain) fn history_ranges(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> Vec<Range<usize>> {
        let mut stored: Vec<_> = self.last_axis_range(layout, layer, rows).into_iter().collect();
        if let Some(own) = &self.across[0] {
            let [from, to] = [rows.start, rows.end].map(|row| layer * layout.rows + row);
            stored.push(
                own.history_start + from * own.history_stride
                    ..own.history_start + to * own.history_stride,
            );
        }
        for own in self.across[1..D - 1].iter().flatten() {
            let is_end = rows.end == own.has_plane.len();
            for place in rows.start..rows.end + usize::from(is_end) {
                if own.has_history_at(place) {
                    let start = own.history_index(layer * layout.groups, place);
                    stored.push(start..start + layout.groups * own.history_stride);
                }
            }
        }
        stored
    }

    /// Returns the range of the history variables of the interlayers below a layer across the last axis, for `rows` of
    /// the layer; `None` if there is no interlayer.
    fn last_axis_range(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> Option<Range<usize>> {
        let own = self.across[D - 1].as_ref()?;
        let [from, to] = [rows.start, rows.end].map(|row| row * layout.groups);
        own.has_history_at(layer)
            .then(|| own.history_index(from, layer)..own.history_index(to, layer))
    }

    /// Returns the ranges of the history variables of rows of a layer that are copied into a halo along the last axis:
    /// those of interlayers across the last axis, and in the plane also across the first axis, since passes have
    /// several steps there.
    pub(in crate::solid::domain) fn exchanged_ranges(
        &self,
        layout: &Layout<D>,
        layer: usize,
        rows: &Range<usize>,
    ) -> impl Iterator<Item = Range<usize>> + use<T, D> {
        let in_row = match (D, &self.across[0]) {
            (2, Some(own)) => Some(
                own.history_start + layer * own.history_stride
                    ..own.history_start + (layer + 1) * own.history_stride,
            ),
            _ => None,
        };
        self.last_axis_range(layout, layer, rows).into_iter().chain(in_row)
    }
}
