//! Numbers and sizes of the messages of a pass, see [`HaloExchange`](super::HaloExchange).

use super::SolverReal;
use super::build::select_tile_sizes;
use super::layout::Layout;
use crate::simd::LaneGroup;
use crate::solid::problem::Problem;
use crate::solid::region::Region;
use std::ops::Range;

/// Messages that a subdomain sends to one neighbour in a pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct MessageVolume {
    pub(crate) messages: usize,
    /// Bytes of all messages, without history variables of interlayers.
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
    // Interlayers have messages of their own along the last axis.
    let per_layer = if problem.interlayers.is_empty() { blocks } else { 2 * blocks };
    let group_bytes = T::Lanes::COUNT * size_of::<T>();
    let exchanged: usize = layout.exchanged_fields.iter().map(ExactSizeIterator::len).sum();
    std::array::from_fn(|axis| {
        [0, 1].map(|end| {
            let width = layout.halo(axis)[end];
            if width == 0 {
                return MessageVolume::default();
            }
            if axis + 1 == D {
                let bytes = width * layout.rows * exchanged * group_bytes;
                return MessageVolume { messages: width * per_layer, bytes };
            }
            let cells: [Range<usize>; D] = layout.halo_box(axis, end, true);
            let values =
                cells.iter().map(ExactSizeIterator::len).product::<usize>() * layout.field_count;
            let bytes = values.div_ceil(T::Lanes::COUNT) * group_bytes;
            MessageVolume { messages: 1, bytes }
        })
    })
}
