//! Blocky media: blocks in one uniform grid, and the joints between them.

use super::block::{BlockEntry, BlockTiling, read_blocks};
use super::joint::{JointEntry, JointLaw};
use super::reader::SolidReader;
use super::tiling::{BlockContact, PlacedBlock};
use crate::error::CaseError;
use crate::key_positions::KeyPositions;
use crate::material::Material;
use crate::section::SectionReader;

/// Blocky medium of a case: the sections `[[block]]` and `[[joint]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Blocks {
    /// Number of cells of the bounding box along each axis.
    pub cells: [usize; 2],
    /// Cell spacing along each axis, m.
    pub spacing: [f64; 2],
    /// Lower corner of the bounding box, m.
    pub origin: [f64; 2],
    /// Blocks and their copies, which tile the bounding box.
    pub blocks: Vec<PlacedBlock>,
    /// Materials, to which the blocks refer by index; at most [`MAX_REGIONS`](super::MAX_REGIONS).
    pub materials: Vec<Material>,
    /// Sections `[[block]]`.
    pub entries: Vec<BlockEntry>,
    /// Common faces of two blocks: those normal to x₁, then those normal to x₂.
    pub contacts: Vec<BlockContact>,
    /// Sections `[[joint]]`; [`BlockContact::joint`] is an index into this list.
    pub joints: Vec<JointEntry>,
    positions: KeyPositions,
}

impl Blocks {
    /// Returns the index of the block that contains a cell; `None` outside the grid. Looks through all blocks; for many
    /// cells use [`compute_cell_blocks`](Self::compute_cell_blocks).
    pub fn block_of_cell(&self, cell: [usize; 2]) -> Option<usize> {
        let contains =
            |block: &PlacedBlock| (0..2).all(|axis| block.cells[axis].contains(&cell[axis]));
        self.blocks.iter().position(contains)
    }

    /// Returns the name of a block; `None` if it has none.
    pub fn block_name(&self, block: usize) -> Option<&str> {
        self.entries.get(self.blocks.get(block)?.entry)?.name.as_deref()
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

    /// Returns whether two neighbours are separated by a joint.
    pub fn has_joints(&self) -> bool {
        self.contacts.iter().any(|contact| contact.joint.is_some())
    }

    /// Computes the index of the block of each cell, first axis fastest.
    ///
    /// # Errors
    /// Memory allocation fails.
    pub fn compute_cell_blocks(&self) -> Result<Vec<u32>, CaseError> {
        // Block indices fit u32: at most 2·MAX_BLOCKS blocks are read.
        self.fill_blocks(0, |block| block as u32)
    }

    /// Computes the index of the material of each cell, first axis fastest.
    ///
    /// # Errors
    /// Memory allocation fails.
    pub fn compute_cell_materials(&self) -> Result<Vec<u16>, CaseError> {
        // Material indices fit u16: at most MAX_REGIONS materials are read.
        self.fill_blocks(0, |block| self.blocks[block].material as u16)
    }

    /// Computes the joint at the lower face of each cell, for the faces normal to each axis: an index into
    /// [`joints`](Self::joints), or `None` inside a block, between welded blocks and on the boundary. Both lists have
    /// one entry per cell, first axis fastest.
    ///
    /// # Errors
    /// Memory allocation fails.
    pub fn compute_faces(&self) -> Result<[Vec<Option<u16>>; 2], CaseError> {
        let mut faces = [self.allocate(None)?, self.allocate(None)?];
        let row = self.cells[0];
        for contact in self.contacts.iter().filter(|contact| contact.joint.is_some()) {
            let own = &mut faces[contact.axis];
            match contact.axis {
                0 => contact
                    .along
                    .clone()
                    .for_each(|j| own[contact.position + row * j] = contact.joint),
                _ => {
                    let start = row * contact.position;
                    own[start + contact.along.start..start + contact.along.end].fill(contact.joint);
                }
            }
        }
        Ok(faces)
    }

    fn fill_blocks<T: Copy>(
        &self,
        initial: T,
        value: impl Fn(usize) -> T,
    ) -> Result<Vec<T>, CaseError> {
        let mut all = self.allocate(initial)?;
        for (index, block) in self.blocks.iter().enumerate() {
            let [along, across] = &block.cells;
            for j in across.clone() {
                let start = self.cells[0] * j;
                all[start + along.start..start + along.end].fill(value(index));
            }
        }
        Ok(all)
    }

    fn allocate<T: Copy>(&self, value: T) -> Result<Vec<T>, CaseError> {
        let count = self.cells[0] * self.cells[1];
        let mut all = Vec::new();
        if all.try_reserve_exact(count).is_err() {
            let found = format!("no memory for {count} cells");
            return Err(self.positions.error_at("block", found, "reduce the number of cells"));
        }
        all.resize(count, value);
        Ok(all)
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
        self.entries[self.blocks[block].entry].name.as_deref()
    }
}

impl SolidReader<'_> {
    /// Reads the sections `[[block]]` and `[[joint]]`; `None` without blocks.
    pub(super) fn read_blocky_medium(
        &self,
        root: &SectionReader,
        material_of: impl Fn(&SectionReader) -> Result<Material, CaseError>,
    ) -> Result<Option<Blocks>, CaseError> {
        if !root.has_key("block") {
            if root.has_key("joint") {
                let allowed = "joints lie between blocks: add [[block]] with cells and spacing in \
                               place of [grid], or leave the joints out";
                return Err(root.error_at("joint", "found without [[block]]", allowed));
            }
            return Ok(None);
        }
        let mut tiling = read_blocks(root, self.grid, material_of)?;
        let joints = self.read_joints(root, &mut tiling)?;
        let pair = |list: &[f64]| [list[0], list[1]];
        Ok(Some(Blocks {
            cells: [self.grid.cells[0], self.grid.cells[1]],
            spacing: pair(&self.grid.spacing),
            origin: pair(&self.grid.origin),
            blocks: tiling.blocks,
            materials: tiling.materials,
            entries: tiling.entries,
            contacts: tiling.contacts,
            joints,
            positions: root.positions().clone(),
        }))
    }
}
