//! Numbers and sizes of the messages of a pass, see [`HaloExchange`](super::HaloExchange).

use super::SolverReal;
use super::build::select_tile_sizes;
use super::interlayer_faces::LaneInterlayers;
use super::layout::Layout;
use crate::simd::LaneGroup;
use crate::solid::problem::Problem;
use crate::solid::region::Region;
use std::ops::Range;

/// Messages that a subdomain sends to one neighbour in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MessageVolume {
    pub(crate) messages: usize,
    /// Bytes of all messages.
    pub(crate) bytes: usize,
}

/// Returns the messages of a subdomain of a problem to the neighbours at both ends of each axis.
pub(crate) fn message_volumes<T: SolverReal, const D: usize>(
    problem: &Problem<D>,
    region: &Region<D>,
) -> [[MessageVolume; 2]; D] {
    let layout = Layout::new::<T>(problem, region);
    let block_rows = select_tile_sizes::<T, D>(problem, &layout, region).block_rows;
    let blocks = layout.rows.div_ceil(block_rows.min(layout.rows));
    let interlayers = LaneInterlayers::<T, D>::without_stencils(problem, &layout, region);
    // Interlayers have messages of their own along the last axis.
    let per_layer = if interlayers.has_interlayers() { 2 * blocks } else { blocks };
    let group_bytes = T::Lanes::COUNT * size_of::<T>();
    let exchanged: usize = layout.exchanged_fields.iter().map(ExactSizeIterator::len).sum();
    std::array::from_fn(|axis| {
        [0, 1].map(|end| {
            let width = layout.halo(axis)[end];
            if width == 0 {
                return MessageVolume::default();
            }
            if axis + 1 == D {
                let owned = layout.owned_layers();
                let sent = match end {
                    0 => owned.start..owned.start + width,
                    _ => owned.end - width..owned.end,
                };
                let history = |layer| {
                    interlayers
                        .exchanged_ranges(&layout, layer, &(0..layout.rows))
                        .map(|own| own.len())
                        .sum::<usize>()
                };
                let groups = width * layout.rows * exchanged + sent.map(history).sum::<usize>();
                let bytes = groups * group_bytes;
                return MessageVolume { messages: width * per_layer, bytes };
            }
            let cells: [Range<usize>; D] = layout.halo_box(axis, end, true);
            let values = cells.iter().map(ExactSizeIterator::len).product::<usize>()
                * layout.field_count
                + interlayers.variables_in_box(&layout, &cells);
            let bytes = values.div_ceil(T::Lanes::COUNT) * group_bytes;
            MessageVolume { messages: 1, bytes }
        })
    })
}
