//! Places of the history variables of interlayers in memory, by layers and rows.

use super::LaneInterlayers;
use crate::simd::{LaneGroup, Real};
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

    /// Returns the number of groups that the history variables at the lower faces of the cells in a box fill.
    pub(in crate::solid::domain) fn packed_history_groups(
        &self,
        layout: &Layout<D>,
        cells: &[Range<usize>; D],
    ) -> usize {
        let sites = self.sites_in_box(layout, cells);
        let variables: usize = sites.iter().map(|site| self.variables(site.axis)).sum();
        variables.div_ceil(T::Lanes::COUNT)
    }

    /// Packs the history variables at the lower faces of the cells in a box.
    pub(in crate::solid::domain) fn pack_history(
        &self,
        layout: &Layout<D>,
        cells: &[Range<usize>; D],
    ) -> Vec<T::Lanes> {
        let sites = self.sites_in_box(layout, cells);
        let numbers: Vec<T> = sites.iter().flat_map(|site| self.history(site)).collect();
        let group = |numbers: &[T]| {
            T::Lanes::from_lanes(|lane| numbers.get(lane).copied().unwrap_or(T::ZERO))
        };
        numbers.chunks(T::Lanes::COUNT).map(group).collect()
    }

    /// Unpacks the history variables at the lower faces of the cells in a box.
    pub(in crate::solid::domain) fn unpack_history(
        &mut self,
        layout: &Layout<D>,
        cells: &[Range<usize>; D],
        packed: &[T::Lanes],
    ) {
        let mut numbers = packed.iter().flat_map(|group| group.lanes()).copied();
        for site in self.sites_in_box(layout, cells) {
            self.set_history(&site, &mut numbers);
        }
    }
}
