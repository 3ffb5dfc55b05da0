//! Blocky media: blocks of cells of one uniform grid, and the joints between blocks.

use super::block::{BlockEntry, BlockTiling, read_blocks};
use super::joint::{JointEntry, JointLaw};
use super::joint_keys::{LAYER_END_NAMES, LAYER_ENDS};
use super::reader::SolidReader;
use super::tiling::{BlockContact, PlacedBlock};
use crate::error::CaseError;
use crate::key_positions::KeyPositions;
use crate::material::Material;
use crate::section::SectionReader;
use models::interface::parameters::LayerMaterial;

/// Blocky medium of a case: the sections `[[block]]` and `[[joint]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    /// Number of cells of the bounding box along each axis.
    pub cells: [usize; 2],
    /// Cell spacing along each axis, m.
    pub spacing: [f64; 2],
    /// Lower corner of the bounding box, m.
    pub origin: [f64; 2],
    /// All blocks, including the copies; they tile the bounding box.
    pub blocks: Vec<PlacedBlock>,
    /// Materials, to which the blocks refer by index; at most [`MAX_REGIONS`](super::MAX_REGIONS).
    pub materials: Vec<Material>,
    /// Sections `[[block]]`.
    pub entries: Vec<BlockEntry>,
    /// Common faces of two blocks: those normal to x₁, then those normal to x₂.
    pub contacts: Vec<BlockContact>,
    /// Sections `[[joint]]`; [`BlockContact::joint_index`] is an index into this list.
    pub joints: Vec<JointEntry>,
    positions: KeyPositions,
}

impl Blocks {
    /// Returns the index of the block that contains a cell; `None` outside the grid. Searches all blocks: for many
    /// cells use [`compute_cell_blocks`](Self::compute_cell_blocks).
    pub fn block_of_cell(&self, cell: [usize; 2]) -> Option<usize> {
        let contains =
            |block: &PlacedBlock| (0..2).all(|axis| block.cells[axis].contains(&cell[axis]));
        self.blocks.iter().position(contains)
    }

    /// Returns the name of a block; `None` if it has none.
    pub fn block_name(&self, block: usize) -> Option<&str> {
        self.entries.get(self.blocks.get(block)?.entry_index)?.name.as_deref()
    }

    /// Returns the section of a material, as a key for messages: `block[0]` or `block[0].materials[1]`.
    pub fn material_section(&self, material: usize) -> String {
        let mut index = material;
        for (number, entry) in self.entries.iter().enumerate() {
            match entry.materials.len() {
                1 if index == 0 => return format!("block[{number}]"),
                count if index < count => return format!("block[{number}].materials[{index}]"),
                count => index -= count,
            }
        }
        String::new()
    }

    /// Returns the laws of the joints, in the order of the sections.
    pub fn joint_laws(&self) -> impl ExactSizeIterator<Item = &JointLaw> {
        self.joints.iter().map(|joint| &joint.law)
    }

    /// Returns whether any two neighbouring blocks are separated by a joint.
    pub fn has_joints(&self) -> bool {
        self.contacts.iter().any(|contact| contact.joint_index.is_some())
    }

    /// Returns whether saturated layers normal to an axis have open ends at the boundaries of the domain.
    pub fn has_open_ends(&self, axis: usize) -> bool {
        self.saturated_joints(axis).iter().any(|joint| self.joints[*joint].law.has_open_ends)
    }

    /// Returns the indices of the saturated joints that have faces normal to an axis.
    fn saturated_joints(&self, axis: usize) -> Vec<usize> {
        let contacts = self.contacts.iter().filter(|contact| contact.axis == axis);
        let mut own: Vec<usize> =
            contacts.filter_map(|contact| contact.joint_index.map(usize::from)).collect();
        own.sort_unstable();
        own.dedup();
        own.retain(|joint| matches!(self.joints[*joint].law.material, LayerMaterial::Saturated(_)));
        own
    }

    /// Checks that all saturated layers along an axis have the same ends, and that layers with open ends have ends.
    pub(super) fn check_layer_ends(&self, is_periodic: [bool; 2]) -> Result<(), CaseError> {
        let word =
            |joint: usize| LAYER_END_NAMES[usize::from(self.joints[joint].law.has_open_ends)];
        let of_axes = [0, 1].map(|axis| self.saturated_joints(axis));
        let key = |joint: usize| format!("joint[{joint}].{LAYER_ENDS}");
        for (axis, own) in of_axes.iter().enumerate() {
            let Some((first, others)) = own.split_first() else { continue };
            if let Some(odd) = others.iter().find(|joint| word(**joint) != word(*first)) {
                let found = format!(
                    "found '{}', beside '{}' of joint[{first}] ({})",
                    word(*odd),
                    word(*first),
                    self.positions.locate(&format!("joint[{first}]"))
                );
                let allowed =
                    format!("the same for all saturated joints with layers along x{}", 2 - axis);
                return Err(self.positions.key_error(&key(*odd), found, allowed));
            }
        }
        for (joint, entry) in self.joints.iter().enumerate() {
            let along = |axis: &usize| of_axes[1 - axis].contains(&joint);
            let axes: Vec<usize> = (0..2).filter(along).collect();
            if entry.law.has_open_ends
                && !axes.is_empty()
                && axes.iter().all(|axis| is_periodic[*axis])
            {
                let found = "found 'open' with periodic boundaries";
                let allowed = "leave it out: layers along a periodic axis have no ends";
                return Err(self.positions.key_error(&key(joint), found, allowed));
            }
        }
        Ok(())
    }

    /// Computes the index of the block of each cell, first axis fastest.
    ///
    /// # Errors
    /// Memory allocation fails.
    pub fn compute_cell_blocks(&self) -> Result<Vec<u32>, CaseError> {
        // Block indices fit u32: at most 2·MAX_BLOCKS blocks are read.
        self.fill_cells_by_block(0, |block| block as u32)
    }

    /// Computes the index of the material of each cell, first axis fastest.
    ///
    /// # Errors
    /// Memory allocation fails.
    pub fn compute_cell_materials(&self) -> Result<Vec<u16>, CaseError> {
        // Material indices fit u16: at most MAX_REGIONS materials are read.
        self.fill_cells_by_block(0, |block| self.blocks[block].material_index as u16)
    }

    /// Returns a function that computes the index of the material of a cell, without a list of all cells: from a table of
    /// the rectangles between all planes in which blocks begin.
    pub fn material_function(&self) -> impl Fn(usize) -> u16 + Send + Sync + 'static {
        let starts: [Vec<usize>; 2] = [0, 1].map(|axis| {
            let mut starts: Vec<usize> =
                self.blocks.iter().map(|block| block.cells[axis].start).collect();
            starts.sort_unstable();
            starts.dedup();
            starts
        });
        let [columns, rows] = starts.each_ref().map(Vec::len);
        let mut table = vec![0; columns * rows];
        for block in &self.blocks {
            let [across, along] = [0, 1].map(|axis| {
                let index = |cell: usize| starts[axis].partition_point(|start| *start < cell);
                index(block.cells[axis].start)..index(block.cells[axis].end)
            });
            for row in along {
                // Material indices fit u16: at most MAX_REGIONS materials are read.
                table[row * columns..][across.clone()].fill(block.material_index as u16);
            }
        }
        let length = self.cells[0];
        move |cell| {
            let place = [cell % length, cell / length];
            let [column, row] = [0, 1].map(|axis| {
                starts[axis].partition_point(|start| *start <= place[axis]).saturating_sub(1)
            });
            table[row * columns + column]
        }
    }

    /// Returns for each cell the value of `value` at the index of its block.
    fn fill_cells_by_block<T: Copy>(
        &self,
        initial: T,
        value: impl Fn(usize) -> T,
    ) -> Result<Vec<T>, CaseError> {
        let mut cell_values = self.allocate_cells(initial)?;
        for (index, block) in self.blocks.iter().enumerate() {
            let [along, across] = &block.cells;
            for j in across.clone() {
                let start = self.cells[0] * j;
                cell_values[start + along.start..start + along.end].fill(value(index));
            }
        }
        Ok(cell_values)
    }

    /// Allocates a list with the same value for each cell; an error if there is not enough memory.
    fn allocate_cells<T: Copy>(&self, value: T) -> Result<Vec<T>, CaseError> {
        let count = self.cells[0] * self.cells[1];
        let mut cell_values = Vec::new();
        if cell_values.try_reserve_exact(count).is_err() {
            let found = format!("no memory for {count} cells");
            return Err(self.positions.key_error("block", found, "reduce the number of cells"));
        }
        cell_values.resize(count, value);
        Ok(cell_values)
    }

    /// Formats the sections as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let blocks: String = self.entries.iter().map(BlockEntry::to_toml).collect();
        blocks + &self.joints.iter().map(JointEntry::to_toml).collect::<String>()
    }
}

impl BlockTiling {
    /// Returns the name of a block; `None` if it has none.
    pub(super) fn block_name(&self, block: usize) -> Option<&str> {
        self.entries[self.blocks[block].entry_index].name.as_deref()
    }
}

impl SolidReader<'_> {
    /// Reads the sections `[[block]]` and `[[joint]]`; `None` without blocks.
    pub(super) fn read_blocky_medium(
        &self,
        root: &SectionReader,
        read_material: impl Fn(&SectionReader) -> Result<Material, CaseError>,
    ) -> Result<Option<Blocks>, CaseError> {
        if !root.has_key("block") {
            if root.has_key("joint") {
                let allowed = "joints lie between blocks: add [[block]] with cells and spacing in \
                               place of [grid], or leave the joints out";
                return Err(root.key_error("joint", "found without [[block]]", allowed));
            }
            return Ok(None);
        }
        let mut tiling = read_blocks(root, self.grid, read_material)?;
        let joints = self.read_joints(root, &mut tiling)?;
        let to_pair = |list: &[f64]| [list[0], list[1]];
        Ok(Some(Blocks {
            cells: [self.grid.cells[0], self.grid.cells[1]],
            spacing: to_pair(&self.grid.spacing),
            origin: to_pair(&self.grid.origin),
            blocks: tiling.blocks,
            materials: tiling.materials,
            entries: tiling.entries,
            contacts: tiling.contacts,
            joints,
            positions: root.positions().clone(),
        }))
    }
}
