//! Tiling of a rectangle by rectangular blocks: check of the tiling, and the common faces of neighbours (contacts).
//!
//! Both are computed by a sweep line that moves across the blocks. The sweep keeps the front (skyline): intervals along
//! the line, each with the block that ends there. Blocks are added in the order of their lower ends. They tile their
//! bounding box if and only if each added block begins exactly at the front, and the front ends at the upper end. A
//! sweep of n blocks takes O(n log n) operations.

use std::collections::BTreeMap;
use std::ops::Range;

/// A block in the grid: a rectangle of cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlacedBlock {
    /// Index of the section `[[block]]`, from 0.
    pub entry_index: usize,
    /// Cells along each axis.
    pub cells: [Range<usize>; 2],
    /// Index of the material.
    pub material_index: usize,
}

/// Common face of two blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockContact {
    /// Axis normal to the face.
    pub axis: usize,
    /// Index along the normal axis of the plane of the face: that of the cells above it.
    pub plane_index: usize,
    /// Range of cells of the face along the other axis.
    pub tangential_cells: Range<usize>,
    /// Indices of the blocks below and above the face.
    pub block_indices: [usize; 2],
    /// Index of the joint; `None` if the blocks are welded.
    pub joint_index: Option<u16>,
}

/// Fault of a tiling, the first one found: two blocks overlap, or cells belong to no block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum TilingFault {
    /// Two blocks have common cells.
    Overlap {
        /// Block that was placed first.
        first: usize,
        /// Other block.
        second: usize,
        /// Lower corner of the common cells.
        corner: [usize; 2],
    },
    /// A row of cells belongs to no block.
    Gap {
        /// Neighbour of the gap: the block above it, else below it.
        block: usize,
        /// Lower corner of the gap.
        corner: [usize; 2],
        /// Number of cells of the gap along x₁.
        length: usize,
    },
}

/// Interval of the front: the region below it is covered by blocks.
#[derive(Clone, Copy)]
struct FrontInterval {
    /// End of the interval along the sweep line; its start is the key of the map of intervals.
    end: usize,
    /// Position of the front along the sweep axis.
    height: usize,
    /// Index of the block that ends at the front; `None` at the start of the sweep.
    block: Option<usize>,
}

/// Checks that blocks tile a box of `extent` cells, and returns the common faces of blocks: normal to x₁ first, then
/// normal to x₂.
pub(super) fn find_contacts(
    blocks: &[PlacedBlock],
    extent: [usize; 2],
) -> Result<Vec<BlockContact>, TilingFault> {
    // The first sweep, along x₂, finds every fault, so that gaps are described along x₁.
    let normal_to_x2 = sweep_along_axis(blocks, extent, 1)?;
    let mut contacts = sweep_along_axis(blocks, extent, 0)?;
    contacts.extend(normal_to_x2);
    Ok(contacts)
}

/// Checks the tiling by a sweep along `axis` and returns the contacts normal to it.
fn sweep_along_axis(
    blocks: &[PlacedBlock],
    extent: [usize; 2],
    axis: usize,
) -> Result<Vec<BlockContact>, TilingFault> {
    let other = 1 - axis;
    let corner = |position: usize, along: usize| match axis {
        0 => [position, along],
        _ => [along, position],
    };
    let mut order: Vec<usize> = (0..blocks.len()).collect();
    order.sort_by_key(|&block| {
        (blocks[block].cells[axis].start, blocks[block].cells[other].start, block)
    });
    let mut front = BTreeMap::new();
    front.insert(0, FrontInterval { end: extent[other], height: 0, block: None });
    let mut contacts = Vec::new();
    for block in order {
        let Range { start: bottom, end: top } = blocks[block].cells[axis];
        let along = blocks[block].cells[other].clone();
        let first = front.range(..=along.start).next_back().map_or(0, |(start, _)| *start);
        let touched_intervals: Vec<(usize, FrontInterval)> =
            front.range(first..along.end).map(|(start, own)| (*start, *own)).collect();
        for &(start, own) in &touched_intervals {
            let common = start.max(along.start)..own.end.min(along.end);
            if own.height > bottom {
                let first = own.block.unwrap_or(block);
                let corner = corner(bottom, common.start);
                return Err(TilingFault::Overlap { first, second: block, corner });
            }
            if own.height < bottom {
                let (corner, length) = (corner(own.height, common.start), common.len());
                return Err(TilingFault::Gap { block, corner, length });
            }
            if let Some(below) = own.block {
                contacts.push(BlockContact {
                    axis,
                    plane_index: bottom,
                    tangential_cells: common,
                    block_indices: [below, block],
                    joint_index: None,
                });
            }
            front.remove(&start);
            if start < along.start {
                front.insert(start, FrontInterval { end: along.start, ..own });
            }
            if own.end > along.end {
                front.insert(along.end, own);
            }
        }
        let end = along.end;
        front.insert(along.start, FrontInterval { end, height: top, block: Some(block) });
    }
    let unfilled = front.iter().find(|(_, own)| own.height < extent[axis]);
    match unfilled {
        Some((&start, own)) => Err(TilingFault::Gap {
            block: own.block.unwrap_or(0),
            corner: corner(own.height, start),
            length: own.end - start,
        }),
        None => Ok(contacts),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new_block(cells: [Range<usize>; 2]) -> PlacedBlock {
        PlacedBlock { entry_index: 0, cells, material_index: 0 }
    }

    /// Splits a rectangle at random into blocks that tile it.
    fn split_rectangle(
        cells: [Range<usize>; 2],
        depth: usize,
        random: &mut impl FnMut() -> usize,
        all: &mut Vec<PlacedBlock>,
    ) {
        let axis = random() % 2;
        let own = cells[axis].clone();
        if depth == 0 || own.len() < 2 {
            return all.push(new_block(cells));
        }
        let middle = own.start + 1 + random() % (own.len() - 1);
        for part in [own.start..middle, middle..own.end] {
            let mut inner = cells.clone();
            inner[axis] = part;
            split_rectangle(inner, depth - 1, random, all);
        }
    }

    /// Lists for each cell the indices of the blocks that contain it.
    fn cell_owners(blocks: &[PlacedBlock], [n1, n2]: [usize; 2]) -> Vec<Vec<usize>> {
        let mut cell_owners = vec![Vec::new(); n1 * n2];
        for (index, block) in blocks.iter().enumerate() {
            for j in block.cells[1].clone() {
                for i in block.cells[0].clone() {
                    cell_owners[i + n1 * j].push(index);
                }
            }
        }
        cell_owners
    }

    /// Contacts and faults of random tilings, sound and damaged, agree with a search over all cells.
    #[test]
    fn contacts_and_faults_of_random_tilings_equal_those_of_all_cells() {
        let mut state = 1u64;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as usize
        };
        let extent = [23, 17];
        for round in 0..400 {
            let mut blocks = Vec::new();
            split_rectangle([0..extent[0], 0..extent[1]], 5, &mut random, &mut blocks);
            let index = random() % blocks.len();
            // Every second tiling is damaged: a block is removed or moved by one cell.
            match round % 4 {
                1 if blocks.len() > 1 => _ = blocks.remove(index),
                3 => {
                    let own = &mut blocks[index].cells[0];
                    if own.end < extent[0] {
                        *own = own.start + 1..own.end + 1;
                    }
                }
                _ => {}
            }
            let cell_owners = cell_owners(&blocks, extent);
            let is_tiling = cell_owners.iter().all(|own| own.len() == 1);
            match find_contacts(&blocks, extent) {
                Ok(contacts) => {
                    assert!(is_tiling, "{blocks:?}");
                    let mut expected = 0;
                    for (cell, own) in cell_owners.iter().enumerate() {
                        let [i, j] = [cell % extent[0], cell / extent[0]];
                        let is_face = |axis: usize| {
                            let below = match axis {
                                0 => i.checked_sub(1).map(|i| i + extent[0] * j),
                                _ => j.checked_sub(1).map(|j| i + extent[0] * j),
                            };
                            below.filter(|below| cell_owners[*below] != *own)
                        };
                        for (axis, below) in (0..2).filter_map(|axis| Some((axis, is_face(axis)?)))
                        {
                            expected += 1;
                            let [position, along] = if axis == 0 { [i, j] } else { [j, i] };
                            let pair = [cell_owners[below][0], own[0]];
                            assert!(contacts.iter().any(|contact| contact.axis == axis
                                && contact.plane_index == position
                                && contact.tangential_cells.contains(&along)
                                && contact.block_indices == pair));
                        }
                    }
                    let total: usize =
                        contacts.iter().map(|contact| contact.tangential_cells.len()).sum();
                    assert_eq!(total, expected);
                }
                Err(TilingFault::Overlap { first, second, corner: [i, j] }) => {
                    let own = &cell_owners[i + extent[0] * j];
                    assert!(own.contains(&first) && own.contains(&second) && first != second);
                }
                Err(TilingFault::Gap { corner: [i, j], length, .. }) => {
                    for i in i..i + length {
                        assert!(cell_owners[i + extent[0] * j].is_empty());
                    }
                }
            }
        }
    }
}
