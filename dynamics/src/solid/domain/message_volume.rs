//! Numbers and sizes of the messages of a pass, see [`HaloExchange`](super::HaloExchange).

use super::SolverReal;
use super::build::select_tile_sizes;
use super::halo::{messages_per_piece, packed_groups};
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
    let per_layer = blocks * messages_per_piece(&interlayers);
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
            let groups = |cells: [Range<usize>; D]| {
                let fields = match axis {
                    0 => packed_groups::<T, D>(&layout, &cells),
                    _ => layout.row_ranges(&cells).map(|own| own.len()).sum(),
                };
                fields + interlayers.packed_history_groups(&layout, &cells)
            };
            let pieces = || layout.halo_pieces(axis, end, true);
            MessageVolume {
                messages: pieces().count() * messages_per_piece(&interlayers),
                bytes: pieces().map(groups).sum::<usize>() * group_bytes,
            }
        })
    })
}
