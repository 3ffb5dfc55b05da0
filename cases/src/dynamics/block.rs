//! The sections `[[block]]`: rectangular blocks of cells that tile the grid of a blocky medium.

use super::grid::{MAX_CELLS, SolidGrid};
use super::region::to_section_table;
use super::tiling::{PlacedBlock, TilingFault, find_contacts};
use super::time_function::format_count;
use crate::error::CaseError;
use crate::kind::NO_YIELD_NAME;
use crate::material::Material;
use crate::named_enum::named_enum;
use crate::schema::{
    AllowedRange, CountConstraint, KeyCondition, KeyGroup, KeySchema, ListLength, TableSchema,
    ValueType,
};
use crate::section::{SectionReader, TableWriter};
use models::common::decimal::ToPlainText;
use std::ops::Range;

/// Maximum number of blocks of a case.
pub const MAX_BLOCKS: usize = 1_000_000;

/// Tolerance for the distance of block corners from cell corners, relative to the cell spacing.
const CELL_TOLERANCE: f64 = 1e-6;

/// Type of a pair of counts, one along each axis, each at least 1.
const COUNT_PAIR_TYPE: ValueType =
    ValueType::CountList { length: [2, 2], minimum: 1, order: CountConstraint::Unconstrained };

/// Key `model`: constants that override the section `[model]`.
const MODEL_KEY: KeySchema = KeySchema::new_optional(
    "model",
    ValueType::SectionKeys("model"),
    "",
    "{ mu = 2e10 }",
    "keys that override [model]",
);
/// Key `yield`: constants that override the section `[yield]`.
const YIELD_KEY: KeySchema = KeySchema::new_optional(
    "yield",
    ValueType::SectionKeys("yield"),
    "",
    "{ kind = \"none\" }",
    "keys that override [yield]; kind none makes the blocks elastic",
);
/// Condition of keys that are allowed only together with the key `materials`.
const MATERIALS_CONDITION: &[KeyCondition] = &[KeyCondition::Present("materials")];

/// Schema of the items of the key `materials`.
const MATERIALS_SCHEMA: TableSchema = TableSchema::new_inline_table(
    "materials",
    "one of several materials of the copies of a block",
    &[KeyGroup::new(&[MODEL_KEY, YIELD_KEY])],
);

/// Schema of the sections `[[block]]`.
pub(super) const SCHEMA: TableSchema = TableSchema::new_list(
    "block",
    "rectangular block of cells of a blocky medium in plane strain, and its copies; all blocks have the same spacing and tile their bounding box, which replaces the section [grid]; not together with [[region]]",
    &[
        KeyGroup::new(&[
            KeySchema::new_optional(
                "name",
                ValueType::Name,
                "",
                "\"rock\"",
                "name of the block and its copies, for [[joint]]",
            ),
            KeySchema::new_required(
                "cells",
                COUNT_PAIR_TYPE,
                "",
                "[10, 10]",
                "number of cells of one block along each axis; at least 3 along an axis with joints",
            )
            .with_note("cells of one block along each axis"),
            KeySchema::new_required(
                "spacing",
                ValueType::PerAxis(ListLength::Two),
                "m",
                "0.005",
                "cell size; one number, or one per axis; equal in all blocks",
            )
            .with_note("cell size; or give size")
            .with_conditions(&[KeyCondition::Absent("size")]),
            KeySchema::new_optional(
                "size",
                ValueType::PerAxis(ListLength::Two),
                "m",
                "[0.05, 0.05]",
                "size of one block, cells times spacing; replaces spacing",
            )
            .with_note("size of one block"),
            KeySchema::new_optional(
                "origin",
                ValueType::Numbers(ListLength::Two),
                "m",
                "[0.0, 0.0]",
                "lower corner of the first copy, a whole number of cells from the other blocks; default: 0",
            )
            .with_note("lower corner of the first copy"),
            KeySchema::new_with_default(
                "repeat",
                COUNT_PAIR_TYPE,
                "",
                "[1, 1]",
                "number of copies along each axis",
            ),
            KeySchema::new_with_default(
                "row_shift",
                ValueType::Number(AllowedRange::NotNegative),
                "m",
                "0.0",
                "shift along x₁ of every second row of copies, as in masonry; parts of a block close these rows at both ends; a whole number of cells, less than a block",
            ),
        ]),
        KeyGroup::with_conditions(&[KeyCondition::Absent("materials")], &[MODEL_KEY, YIELD_KEY]),
        KeyGroup::new(&[
            KeySchema::new_optional(
                "materials",
                ValueType::TableList(&MATERIALS_SCHEMA),
                "",
                "[{ model = { mu = 2e10 } }, { model = { mu = 3e10 } }]",
                "materials of the copies, assigned by pattern; replaces model and yield",
            ),
            KeySchema::new_with_default(
                "pattern",
                ValueType::OneOf(|_| {
                    MaterialPattern::ALL.iter().map(|own| own.name().to_owned()).collect()
                }),
                "",
                "\"checkerboard\"",
                "arrangement of the materials: checkerboard, rows (along x₁), columns (along x₂), or list",
            )
            .with_conditions(MATERIALS_CONDITION),
            KeySchema::new_required(
                "list",
                ValueType::IndexList,
                "",
                "[0]",
                "index of the material of each copy, from 0, row by row and along x₁ first; parts of blocks count",
            )
            .with_note("one index of materials for each copy")
            .with_conditions(&[
                KeyCondition::Present("materials"),
                KeyCondition::HasValue("pattern", &["list"]),
            ]),
        ]),
    ],
);

named_enum! {
    /// Arrangement of several materials in the copies of a block; row and column of a copy are counted from 0.
    MaterialPattern {
        /// The material of a copy is row + column modulo the number of materials.
        Checkerboard = "checkerboard",
        /// The material of a copy is its row modulo the number of materials.
        Rows = "rows",
        /// The material of a copy is its column modulo the number of materials.
        Columns = "columns",
        /// The material of each copy is listed.
        List = "list"
    }
}

/// A section `[[block]]`: a block and its copies.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockEntry {
    /// Name of the block and its copies, by which joints select faces.
    pub name: Option<String>,
    /// Number of cells of one block along each axis.
    pub cells: [usize; 2],
    /// Cell spacing along each axis, m.
    pub spacing: [f64; 2],
    /// Lower corner of the first copy, m.
    pub origin: [f64; 2],
    /// Number of copies along each axis.
    pub repeat: [usize; 2],
    /// Shift along x₁ of every second row of copies, m.
    pub row_shift: f64,
    /// Materials of the copies, at least one.
    pub materials: Vec<Material>,
    /// Arrangement of the materials in the copies.
    pub pattern: MaterialPattern,
    /// Indices of the materials of all copies for [`MaterialPattern::List`], else empty.
    pub material_list: Vec<usize>,
}

impl BlockEntry {
    /// Reads a section except its materials; `first` is the first section, whose cell spacing all blocks have.
    fn read_geometry(section: &SectionReader, first: Option<&Self>) -> Result<Self, CaseError> {
        let cells: [usize; 2] = to_pair(section.read_required("cells")?);
        if section.has_key("size") && section.has_key("spacing") {
            let found = format!("found beside spacing ({})", section.locate("spacing"));
            let allowed = "give either size or spacing: size is cells times spacing";
            return Err(section.key_error("size", found, allowed));
        }
        let (spacing_key, own_spacing) = match section.read_optional::<Vec<f64>>("size")? {
            Some(size) => ("size", [0, 1].map(|axis| size[axis] / cells[axis] as f64)),
            None => {
                let given: Vec<f64> = section.read_required("spacing")?;
                ("spacing", [given[0], given[1]])
            }
        };
        let spacing = first.map_or(own_spacing, |first| first.spacing);
        if let Some(axis) =
            (0..2).find(|&axis| (own_spacing[axis] - spacing[axis]).abs() > 1e-9 * spacing[axis])
        {
            let found = format!(
                "cells of {} m along x{}, but of {} m in block[0] ({})",
                own_spacing[axis].to_plain_text(),
                axis + 1,
                spacing[axis].to_plain_text(),
                section.positions().locate("block[0]"),
            );
            let allowed = "all blocks are parts of one uniform grid: give them the same spacing";
            return Err(section.key_error(spacing_key, found, allowed));
        }
        let origin: Vec<f64> = section.read_optional("origin")?.unwrap_or(vec![0.0; 2]);
        let repeat = to_pair(section.read_or_default("repeat")?);
        let entry = Self {
            name: section.read_optional("name")?,
            cells,
            spacing,
            origin: [origin[0], origin[1]],
            repeat,
            row_shift: section.read_or_default("row_shift")?,
            materials: Vec::new(),
            pattern: MaterialPattern::default(),
            material_list: Vec::new(),
        };
        entry.check_counts(section)?;
        Ok(entry)
    }

    /// Checks the row shift, the number of copies and the number of cells.
    fn check_counts(&self, section: &SectionReader) -> Result<(), CaseError> {
        let [width, h] = [self.cells[0] as f64 * self.spacing[0], self.spacing[0]];
        let shift = self.row_shift / h;
        if (shift - shift.round()).abs() > CELL_TOLERANCE || shift.round() >= self.cells[0] as f64 {
            let found = format!(
                "found {} m, {} cells of {} m",
                self.row_shift.to_plain_text(),
                shift.to_plain_text(),
                h.to_plain_text()
            );
            let allowed = format!(
                "expected a whole number of cells, less than a block of {width} m",
                width = width.to_plain_text()
            );
            return Err(section.key_error("row_shift", found, allowed));
        }
        let copies = self.repeat[0].checked_mul(self.repeat[1]);
        if copies.is_none_or(|copies| copies > MAX_BLOCKS) {
            let found = format!("found {} × {} copies", self.repeat[0], self.repeat[1]);
            let allowed = format!("expected at most {MAX_BLOCKS} blocks in total");
            return Err(section.key_error("repeat", found, allowed));
        }
        let lengths = [0, 1].map(|axis| self.repeat[axis].checked_mul(self.cells[axis]));
        let total = lengths[0].zip(lengths[1]).and_then(|(one, other)| one.checked_mul(other));
        if total.is_none_or(|total| total > MAX_CELLS) {
            let found = format!(
                "{} × {} blocks of {} × {} cells",
                self.repeat[0], self.repeat[1], self.cells[0], self.cells[1]
            );
            let allowed = format!("expected at most {MAX_CELLS} cells in total");
            return Err(section.key_error("cells", found, allowed));
        }
        Ok(())
    }

    /// Reads the materials of the copies; `read_material` reads the tables `model` and `yield` of a section.
    fn read_materials(
        &mut self,
        section: &SectionReader,
        read_material: &impl Fn(&SectionReader) -> Result<Material, CaseError>,
    ) -> Result<(), CaseError> {
        if !section.has_key("materials") {
            self.materials = vec![read_material(section)?];
            return Ok(());
        }
        if let Some(key) = ["model", "yield"].into_iter().find(|key| section.has_key(key)) {
            let found = format!("found beside materials ({})", section.locate("materials"));
            let allowed = "give either model and yield, or materials";
            return Err(section.key_error(key, found, allowed));
        }
        for table in section.open_list(&MATERIALS_SCHEMA)? {
            self.materials.push(read_material(&table)?);
            table.finish()?;
        }
        if self.materials.is_empty() {
            let allowed = "give at least one material { model = { ... } }";
            return Err(section.key_error("materials", "an empty list", allowed));
        }
        let patterns = MaterialPattern::ALL;
        let pattern = section.read_optional_choice("pattern", patterns, MaterialPattern::name)?;
        self.pattern = pattern.unwrap_or_default();
        if self.pattern != MaterialPattern::List {
            return Ok(());
        }
        self.material_list = section.read_required("list")?;
        let (count, copies) = (self.materials.len(), self.copies().count());
        if self.material_list.len() != copies {
            let found = format!("{} indices for {copies} copies", self.material_list.len());
            return Err(section.key_error("list", found, "give one index for each copy"));
        }
        if let Some(index) = self.material_list.iter().find(|index| **index >= count) {
            let found = format!("found {index} with {count} materials");
            let allowed = format!("expected indices from 0 to {}", count - 1);
            return Err(section.key_error("list", found, allowed));
        }
        Ok(())
    }

    /// Returns column, row and cells of each copy relative to the lower corner of the first copy, row by row. A shifted
    /// row begins with a part of a block, as long as the shift, and ends with the rest of a block.
    fn copies(&self) -> impl Iterator<Item = ([usize; 2], [Range<usize>; 2])> + '_ {
        let [n1, n2] = self.cells;
        let shift = (self.row_shift / self.spacing[0]).round() as usize;
        let width = self.repeat[0] * n1;
        (0..self.repeat[1]).flat_map(move |row| {
            let shift = if row % 2 == 1 { shift } else { 0 };
            let count = self.repeat[0] + usize::from(shift > 0);
            let start = move |column: usize| match (shift, column) {
                (0, _) => column * n1,
                (_, 0) => 0,
                _ => (shift + (column - 1) * n1).min(width),
            };
            (0..count).map(move |column| {
                let along = start(column)..start(column + 1);
                ([column, row], [along, row * n2..(row + 1) * n2])
            })
        })
    }

    /// Returns the index in [`materials`](Self::materials) of the material of a copy.
    fn copy_material_index(&self, copy: usize, [column, row]: [usize; 2]) -> usize {
        match self.pattern {
            MaterialPattern::Checkerboard => (row + column) % self.materials.len().max(1),
            MaterialPattern::Rows => row % self.materials.len().max(1),
            MaterialPattern::Columns => column % self.materials.len().max(1),
            MaterialPattern::List => self.material_list.get(copy).copied().unwrap_or(0),
        }
    }

    /// Formats the section `[[block]]` as TOML with all values.
    pub(super) fn to_toml(&self) -> String {
        let resolved = match &self.name {
            Some(name) => TableWriter::default().with_text("name", name),
            None => TableWriter::default(),
        };
        let resolved = resolved
            .with_number("cells", self.cells)
            .with_number("spacing", self.spacing)
            .with_number("origin", self.origin)
            .with_number("repeat", self.repeat)
            .with_number("row_shift", self.row_shift);
        let resolved = match self.materials.as_slice() {
            [material] if self.pattern == MaterialPattern::Checkerboard => {
                write_material(resolved, material)
            }
            materials => {
                let tables: Vec<TableWriter> = materials
                    .iter()
                    .map(|own| write_material(TableWriter::default(), own))
                    .collect();
                let resolved = resolved.with_table_list("materials", &tables);
                let resolved = resolved.with_text("pattern", self.pattern.name());
                match self.pattern {
                    MaterialPattern::List => resolved.with_number("list", &self.material_list),
                    _ => resolved,
                }
            }
        };
        resolved.to_section_toml(&SCHEMA)
    }
}

/// Adds the tables `model` and `yield` of a material to a table.
fn write_material(table: TableWriter, material: &Material) -> TableWriter {
    let table = table.with_table("model", &to_section_table(material, "model"));
    match material.yield_set {
        Some(_) => table.with_table("yield", &to_section_table(material, "yield")),
        None => table.with_table("yield", &TableWriter::default().with_text("kind", NO_YIELD_NAME)),
    }
}

/// Converts a list of two counts to a pair.
fn to_pair(counts: Vec<usize>) -> [usize; 2] {
    [counts[0], counts[1]]
}

/// Reads the sections `[[block]]` except their materials.
fn read_geometries<'a>(
    root: &SectionReader<'a>,
) -> Result<Vec<(SectionReader<'a>, BlockEntry)>, CaseError> {
    let mut entries: Vec<(SectionReader, BlockEntry)> = Vec::new();
    for mut section in root.open_list(&SCHEMA)? {
        section.scope.dimensions = Some(2);
        let first = entries.first().map(|(_, first)| first);
        let entry = BlockEntry::read_geometry(&section, first)?;
        entries.push((section, entry));
    }
    if entries.is_empty() {
        let allowed = "add [[block]] with cells and spacing, or a section [grid]";
        return Err(root.key_error("block", "an empty list", allowed));
    }
    let blocks = |entry: &BlockEntry| entry.repeat[0].saturating_add(1) * entry.repeat[1];
    let total: usize = entries.iter().map(|(_, entry)| blocks(entry)).sum();
    if total > 2 * MAX_BLOCKS {
        let allowed = format!("expected at most {MAX_BLOCKS} blocks in total");
        return Err(root.key_error("block", format!("found up to {total} blocks"), allowed));
    }
    Ok(entries)
}

/// Reads the bounding box of the blocks as a grid.
pub(super) fn read_bounding_grid(root: &SectionReader) -> Result<SolidGrid, CaseError> {
    if root.has_key("grid") {
        let found = format!("found beside [[block]] ({})", root.locate("block[0]"));
        let allowed = "leave it out: the grid is the bounding box of the blocks";
        return Err(root.key_error("grid", found, allowed));
    }
    if root.has_key("region") {
        let found = format!("found beside [[block]] ({})", root.locate("block[0]"));
        let allowed = "give the blocks a model or materials instead, or leave out the blocks";
        return Err(root.key_error("region", found, allowed));
    }
    let entries = read_geometries(root)?;
    let (_, first) = &entries[0];
    let lower = [0, 1].map(|axis| {
        entries.iter().map(|(_, entry)| entry.origin[axis]).fold(f64::INFINITY, f64::min)
    });
    let mut cells = [0usize; 2];
    for (section, entry) in &entries {
        for (axis, count) in cells.iter_mut().enumerate() {
            let offset = cell_offset(section, entry, lower, axis)?;
            *count = offset.saturating_add(entry.repeat[axis] * entry.cells[axis]).max(*count);
        }
    }
    let total = cells[0].checked_mul(cells[1]);
    if total.is_none_or(|total| total > MAX_CELLS) {
        let found = format!("a bounding box of {} × {} cells", cells[0], cells[1]);
        let allowed = format!("expected at most {MAX_CELLS} cells in total");
        return Err(root.key_error("block", found, allowed));
    }
    let (spacing, origin) = (first.spacing.to_vec(), lower.to_vec());
    let grid = SolidGrid { cells: cells.to_vec(), spacing, origin, polar_bounds: None };
    let (section, _) = &entries[0];
    grid.check_resolution(section, if section.has_key("size") { "size" } else { "spacing" })?;
    Ok(grid)
}

/// Returns the distance of the first copy of a block from the lower corner of the bounding box along an axis, in cells.
fn cell_offset(
    section: &SectionReader,
    entry: &BlockEntry,
    lower: [f64; 2],
    axis: usize,
) -> Result<usize, CaseError> {
    let offset = (entry.origin[axis] - lower[axis]) / entry.spacing[axis];
    if offset > MAX_CELLS as f64 {
        let found = format!("found x{} = {}", axis + 1, entry.origin[axis].to_plain_text());
        let allowed = format!("{offset:e} cells from the other blocks; expected a tiling");
        return Err(section.key_error("origin", found, allowed));
    }
    if (offset - offset.round()).abs() > CELL_TOLERANCE {
        let found = format!(
            "found x{} = {}, {} cells of {} m from {}, the lower end of the blocks",
            axis + 1,
            entry.origin[axis].to_plain_text(),
            offset.to_plain_text(),
            entry.spacing[axis].to_plain_text(),
            lower[axis].to_plain_text(),
        );
        let allowed = "faces of blocks must conform: expected a whole number of cells";
        return Err(section.key_error("origin", found, allowed));
    }
    Ok(offset.round() as usize)
}

/// Blocks read from the sections `[[block]]`, which tile their bounding box.
pub(super) struct BlockTiling {
    /// Sections `[[block]]`.
    pub(super) entries: Vec<BlockEntry>,
    /// Materials of all sections.
    pub(super) materials: Vec<Material>,
    /// Blocks and their copies.
    pub(super) blocks: Vec<PlacedBlock>,
    /// Common faces of two blocks.
    pub(super) contacts: Vec<super::tiling::BlockContact>,
}

/// Reads the sections `[[block]]` and places the blocks in `grid`, their bounding box.
pub(super) fn read_blocks(
    root: &SectionReader,
    grid: &SolidGrid,
    read_material: impl Fn(&SectionReader) -> Result<Material, CaseError>,
) -> Result<BlockTiling, CaseError> {
    let (mut entries, mut materials) = (Vec::new(), Vec::new());
    let mut blocks = Vec::new();
    let lower = [grid.origin[0], grid.origin[1]];
    for (index, (section, mut entry)) in read_geometries(root)?.into_iter().enumerate() {
        entry.read_materials(&section, &read_material)?;
        let (first, second) =
            (cell_offset(&section, &entry, lower, 0)?, cell_offset(&section, &entry, lower, 1)?);
        for (number, (copy, [along, across])) in entry.copies().enumerate() {
            blocks.push(PlacedBlock {
                entry_index: index,
                cells: [
                    first + along.start..first + along.end,
                    second + across.start..second + across.end,
                ],
                material_index: materials.len() + entry.copy_material_index(number, copy),
            });
        }
        materials.extend(entry.materials.iter().cloned());
        if materials.len() > super::MAX_REGIONS {
            let found = format!("more than {} materials", super::MAX_REGIONS);
            return Err(section.key_error("materials", found, "reduce the number of materials"));
        }
        section.finish()?;
        entries.push(entry);
    }
    let extent = [grid.cells[0], grid.cells[1]];
    let contacts = find_contacts(&blocks, extent)
        .map_err(|fault| tiling_error(root, grid, &blocks, &fault))?;
    Ok(BlockTiling { entries, materials, blocks, contacts })
}

/// Builds the error of blocks that do not tile their bounding box.
fn tiling_error(
    root: &SectionReader,
    grid: &SolidGrid,
    blocks: &[PlacedBlock],
    fault: &TilingFault,
) -> CaseError {
    let lower_edge =
        |axis: usize, cell: usize| grid.origin[axis] + cell as f64 * grid.spacing[axis];
    let key = |block: usize| format!("block[{}]", blocks[block].entry_index);
    let describe = |block: usize| {
        let name = key(block);
        format!("{name} ({})", root.positions().locate(&name))
    };
    let extent = |block: usize| {
        let ranges = [0, 1].map(|axis| {
            let own = &blocks[block].cells[axis];
            format!(
                "x{} from {} to {}",
                axis + 1,
                lower_edge(axis, own.start).to_plain_text(),
                lower_edge(axis, own.end).to_plain_text()
            )
        });
        ranges.join(", ")
    };
    let point = |cell: [usize; 2]| {
        format!(
            "[{}, {}]",
            lower_edge(0, cell[0]).to_plain_text(),
            lower_edge(1, cell[1]).to_plain_text()
        )
    };
    match *fault {
        TilingFault::Overlap { first, second, corner } => root.key_error(
            &key(second),
            format!(
                "the block with {} overlaps {} at {}",
                extent(second),
                describe(first),
                point(corner)
            ),
            "blocks must tile their bounding box: move or shrink one of the two",
        ),
        TilingFault::Gap { block, corner, length } => root.key_error(
            &key(block),
            format!(
                "no block at {}, in a gap of {} along x1 beside the block with {}",
                point(corner),
                format_count(length, "cell"),
                extent(block)
            ),
            "blocks must tile their bounding box: move or enlarge a block, or add one",
        ),
    }
}

/// Rounds a coordinate to 12 digits, for messages.
pub(super) fn round_coordinate(x: f64) -> f64 {
    format!("{x:.11e}").parse::<f64>().unwrap_or(x) + 0.0
}
