//! Files with the fields and joints of a part of the cells at one time, and their values for the whole grid.

use super::boxes::{BoxCopy, count_cells};
use crate::case::dynamics::SolidGrid;
use crate::cli::folder::{OutputError, create_write_error};
use crate::study::simulate::{FaceRecord, FieldSource, FieldStore, JointFace, OutputFields};
use files::FileError;
use files::section_file::{
    SectionFileError, SectionFileProblem, visit_section, visit_sections, write_sections,
    write_sections_in_pieces,
};
use serde_json::{Value, json};
use std::io::{self, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Sections of the description, and of the values other than those of quantities, whose sections have their names.
const ABOUT: &str = "about";
const DISSIPATION: &str = "dissipation";
const REGION: &str = "region";
const JOINTS: &str = "joints";

/// Number of numbers that describe a face of a joint.
const FACE_NUMBERS: usize = 14;

/// Bytes of fields up to which a store keeps them in memory.
const IN_MEMORY_BYTES: usize = 4 << 20;

/// Creates a store for the fields before a step: in memory or, if they are large, in a file without a name in a folder, which
/// the system removes with the process.
pub(in crate::cli) fn create_field_store(folder: &Path) -> Box<dyn FieldStore> {
    Box::new(tempfile::spooled_tempfile_in(IN_MEMORY_BYTES, folder))
}

/// Writes the fields of the cells `cells` along each axis to a file, a few layers of cells at a time.
///
/// # Errors
/// The file cannot be written.
pub(in crate::cli) fn write_fields(
    path: &Path,
    fields: &dyn FieldSource,
    cells: &[Range<usize>],
) -> Result<(), OutputError> {
    let failed = |source| FileError { path: path.to_owned(), action: "write", source };
    let description = fields.describe();
    let mut slabs = fields.slabs();
    let first =
        slabs.next().transpose().map_err(|error| create_write_error(path, &failed(error)))?;
    let first = first.unwrap_or_default();
    let about = format_about(&description, cells);
    let joints = encode_faces(&description.joint_faces);
    let count = fields.layer_count() * fields.layer_size();
    let sizes = arrays(&first).map(|(name, values)| (name.to_owned(), count * values.value_size()));
    let mut sections = vec![(ABOUT.to_owned(), about.len())];
    sections.extend(sizes);
    sections.push((JOINTS.to_owned(), joints.len()));
    let sections: Vec<(&str, usize)> =
        sections.iter().map(|(name, length)| (name.as_str(), *length)).collect();
    let written = write_sections_in_pieces(path, &sections, |pieces| {
        pieces.append(0, about.as_bytes())?;
        for slab in std::iter::once(Ok(first)).chain(slabs) {
            for (index, (_, values)) in arrays(&slab?).enumerate() {
                pieces.append(1 + index, &values.encode())?;
            }
        }
        pieces.append(sections.len() - 1, &joints)
    });
    written.map_err(|error| create_write_error(path, &error))
}

/// Writes the joints of the cells `cells` along each axis to a file without values by cell.
///
/// # Errors
/// The file cannot be written.
pub(in crate::cli) fn write_joints(
    path: &Path,
    (faces, time): (&[JointFace], f64),
    cells: &[Range<usize>],
) -> Result<(), OutputError> {
    let about = format_about(&OutputFields { time, ..OutputFields::default() }, cells);
    let sections = [(ABOUT, about.as_bytes()), (JOINTS, &encode_faces(faces))];
    write_sections(path, &sections).map_err(|error| create_write_error(path, &error))
}

/// Formats the section that describes the others.
fn format_about(fields: &OutputFields, cells: &[Range<usize>]) -> String {
    let ends: Vec<[usize; 2]> = cells.iter().map(|own| [own.start, own.end]).collect();
    let names: Vec<&str> = fields.quantities.iter().map(|own| own.name.as_str()).collect();
    json!({ "time": fields.time.to_bits(), "cells": ends, "names": names }).to_string()
}

fn encode_faces(faces: &[JointFace]) -> Vec<u8> {
    faces.iter().flat_map(face_numbers).flat_map(f64::to_le_bytes).collect()
}

/// Iterates over the arrays of fields, with the names of their sections.
fn arrays(fields: &OutputFields) -> impl Iterator<Item = (&str, Numbers<'_>)> {
    let quantities = fields.quantities.iter();
    let quantities = quantities.map(|own| (own.name.as_str(), Numbers::Real(&own.values)));
    let dissipation = (DISSIPATION, Numbers::Real(&fields.plastic_dissipation));
    let regions = (REGION, Numbers::Indices(&fields.region_indices));
    quantities.chain([dissipation, regions].into_iter().filter(|own| !own.1.is_empty()))
}

/// Values of a section.
enum Numbers<'a> {
    Real(&'a [f64]),
    Indices(&'a [u16]),
}

impl Numbers<'_> {
    fn is_empty(&self) -> bool {
        match self {
            Self::Real(values) => values.is_empty(),
            Self::Indices(values) => values.is_empty(),
        }
    }

    /// Returns the size of an encoded value, bytes.
    fn value_size(&self) -> usize {
        match self {
            Self::Real(_) => size_of::<f64>(),
            Self::Indices(_) => size_of::<i32>(),
        }
    }

    fn encode(&self) -> Vec<u8> {
        match self {
            Self::Real(values) => files::encode_numbers(values),
            Self::Indices(values) => {
                values.iter().flat_map(|own| i32::from(*own).to_le_bytes()).collect()
            }
        }
    }
}

fn face_numbers(face: &JointFace) -> [f64; FACE_NUMBERS] {
    let FaceRecord {
        slip,
        opening,
        slip_time,
        fracture_time,
        normal_stress,
        shear_stress,
        porosity,
        pressure,
        fluid_velocity,
    } = face.record;
    let [x1, x2] = face.position;
    let (axis, joint) = (face.axis as f64, face.joint_index as f64);
    [
        x1,
        x2,
        axis,
        face.length,
        joint,
        slip,
        opening,
        slip_time,
        fracture_time,
        normal_stress,
        shear_stress,
        porosity,
        pressure,
        fluid_velocity,
    ]
}

fn face_from_numbers(numbers: &[f64; FACE_NUMBERS]) -> JointFace {
    let [x1, x2, axis, length, joint, state @ ..] = *numbers;
    let [
        slip,
        opening,
        slip_time,
        fracture_time,
        normal_stress,
        shear_stress,
        porosity,
        pressure,
        fluid_velocity,
    ] = state;
    JointFace {
        position: [x1, x2],
        axis: axis as usize,
        length,
        joint_index: joint as usize,
        record: FaceRecord {
            slip,
            opening,
            slip_time,
            fracture_time,
            normal_stress,
            shear_stress,
            porosity,
            pressure,
            fluid_velocity,
        },
    }
}

/// Sorts the faces of joints as a single process lists them: by row of cells, axis, and column of cells.
fn sort_faces(faces: &mut [JointFace], grid: &SolidGrid) {
    faces.sort_by_cached_key(|face| {
        // A face is at the lower end of its cell along the axis, and at its centre along the other one.
        let [column, row] = [0, 1].map(|axis| {
            let end = if axis == face.axis { 0.0 } else { 0.5 };
            ((face.position[axis] - grid.origin[axis]) / grid.spacing[axis] - end).round() as i64
        });
        (row, face.axis, column)
    });
}

/// Files with the fields of all parts of a grid.
pub(in crate::cli) struct FieldParts {
    /// Files, and their cells along each axis.
    files: Vec<(PathBuf, Vec<Range<usize>>)>,
    /// Time of the fields, s.
    pub(in crate::cli) time: f64,
    /// Names of the quantities in their order.
    pub(in crate::cli) names: Vec<String>,
    pub(in crate::cli) has_dissipation: bool,
    pub(in crate::cli) has_regions: bool,
}

impl FieldParts {
    /// Opens the files of all parts of a grid of `grid_cells` cells.
    ///
    /// # Errors
    /// A file cannot be read, is damaged, or the parts do not fill the grid.
    pub(in crate::cli) fn open(
        paths: Vec<PathBuf>,
        grid_cells: &[usize],
    ) -> Result<Self, OutputError> {
        let mut all = Self {
            files: Vec::new(),
            time: 0.0,
            names: Vec::new(),
            has_dissipation: false,
            has_regions: false,
        };
        for path in paths {
            let mut about = Vec::new();
            visit(&path, |name, _, content| {
                all.has_dissipation |= name == DISSIPATION;
                all.has_regions |= name == REGION;
                if name == ABOUT { content.read_to_end(&mut about).map(drop) } else { Ok(()) }
            })?;
            let (time, cells, names) = serde_json::from_slice(&about)
                .ok()
                .and_then(|about: Value| parse_about(&about))
                .filter(|(_, cells, _)| cells.len() == grid_cells.len())
                .ok_or_else(|| OutputError::from_invalid_content(&path, "not a part of fields"))?;
            (all.time, all.names) = (time, names);
            all.files.push((path, cells));
        }
        let count: usize = all.files.iter().map(|(_, cells)| count_cells(cells)).sum();
        match (all.files.last(), count == grid_cells.iter().product::<usize>()) {
            (Some((path, _)), false) => Err(OutputError::from_invalid_content(
                path,
                "one of parts that do not fill the grid",
            )),
            _ => Ok(all),
        }
    }

    /// Reads the values of a section with values of `size` bytes for all cells of the grid.
    fn read_bytes(
        &self,
        section: &str,
        size: usize,
        grid_cells: &[usize],
    ) -> Result<Vec<u8>, OutputError> {
        let grid: Vec<Range<usize>> = grid_cells.iter().map(|count| 0..*count).collect();
        let mut bytes = vec![0; size * count_cells(&grid)];
        for (path, cells) in &self.files {
            let copy = BoxCopy::new(cells, &grid);
            visit_section(path, section, |_, content| copy.read(size, content, &mut bytes))
                .map_err(|error| describe_error(path, error))?;
        }
        Ok(bytes)
    }

    /// Reads the values of a quantity, or the plastic dissipation, in all cells of the grid.
    ///
    /// # Errors
    /// A file cannot be read or is damaged.
    pub(in crate::cli) fn read_values(
        &self,
        name: &str,
        grid_cells: &[usize],
    ) -> Result<Vec<f64>, OutputError> {
        let bytes = self.read_bytes(name, size_of::<f64>(), grid_cells)?;
        Ok(bytes.as_chunks().0.iter().map(|own| f64::from_le_bytes(*own)).collect())
    }

    /// Reads the indices of the regions of all cells of the grid.
    ///
    /// # Errors
    /// A file cannot be read or is damaged.
    pub(in crate::cli) fn read_regions(
        &self,
        grid_cells: &[usize],
    ) -> Result<Vec<i32>, OutputError> {
        let bytes = self.read_bytes(REGION, size_of::<i32>(), grid_cells)?;
        Ok(bytes.as_chunks().0.iter().map(|own| i32::from_le_bytes(*own)).collect())
    }

    /// Reads the faces of joints of all parts.
    ///
    /// # Errors
    /// A file cannot be read or is damaged.
    pub(in crate::cli) fn read_joints(
        &self,
        grid: &SolidGrid,
    ) -> Result<Vec<JointFace>, OutputError> {
        let mut faces = Vec::new();
        for (path, _) in &self.files {
            let read = visit_section(path, JOINTS, |_, content| {
                let mut bytes = Vec::new();
                content.read_to_end(&mut bytes)?;
                let numbers: Vec<f64> =
                    bytes.as_chunks().0.iter().map(|own| f64::from_le_bytes(*own)).collect();
                faces.extend(numbers.as_chunks().0.iter().map(face_from_numbers));
                Ok(())
            });
            read.map_err(|error| describe_error(path, error))?;
        }
        sort_faces(&mut faces, grid);
        Ok(faces)
    }
}

/// Returns time, cells and names of quantities; `None` if the description is another one.
fn parse_about(about: &Value) -> Option<(f64, Vec<Range<usize>>, Vec<String>)> {
    let index = |value: &Value| usize::try_from(value.as_u64()?).ok();
    let range = |own: &Value| Some(index(&own[0])?..index(&own[1])?);
    let cells = about["cells"].as_array()?.iter().map(range).collect::<Option<_>>()?;
    let names = about["names"].as_array()?.iter().map(|name| Some(name.as_str()?.to_owned()));
    Some((f64::from_bits(about["time"].as_u64()?), cells, names.collect::<Option<_>>()?))
}

/// Visits the sections of a file.
fn visit(
    path: &Path,
    visit: impl FnMut(&str, u64, &mut dyn Read) -> io::Result<()>,
) -> Result<(), OutputError> {
    visit_sections(path, visit).map_err(|error| describe_error(path, error))
}

pub(super) fn describe_error(
    path: &Path,
    SectionFileError { problem, .. }: SectionFileError,
) -> OutputError {
    match problem {
        SectionFileProblem::Io(error) => OutputError::from_read_error(path, &error),
        problem => OutputError::from_invalid_content(path, problem),
    }
}
