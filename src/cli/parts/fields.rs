//! Files with the fields and joints of a part of the cells at one time, and their values for the whole grid.

use super::boxes::{BoxCopy, count_cells};
use crate::case::dynamics::SolidGrid;
use crate::cli::folder::{OutputError, create_write_error};
use crate::study::simulate::{FaceRecord, JointFace, OutputFields};
use files::section_file::{
    SectionFileError, SectionFileProblem, visit_sections, write_sections_with,
};
use serde_json::{Value, json};
use std::borrow::Cow;
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

/// Writes the fields of the cells `cells` along each axis to a file.
///
/// # Errors
/// The file cannot be written.
pub(in crate::cli) fn write_fields(
    path: &Path,
    fields: &OutputFields,
    cells: &[Range<usize>],
) -> Result<(), OutputError> {
    let ends: Vec<[usize; 2]> = cells.iter().map(|own| [own.start, own.end]).collect();
    let names: Vec<&str> = fields.quantities.iter().map(|own| own.name.as_str()).collect();
    let about = json!({ "time": fields.time.to_bits(), "cells": ends, "names": names }).to_string();
    let faces: Vec<f64> = fields.joint_faces.iter().flat_map(face_numbers).collect();
    let mut contents: Vec<(&str, Numbers)> = vec![(ABOUT, Numbers::Text(&about))];
    let quantities = fields.quantities.iter();
    contents.extend(quantities.map(|own| (own.name.as_str(), Numbers::Real(&own.values))));
    if !fields.plastic_dissipation.is_empty() {
        contents.push((DISSIPATION, Numbers::Real(&fields.plastic_dissipation)));
    }
    if !fields.region_indices.is_empty() {
        contents.push((REGION, Numbers::Indices(&fields.region_indices)));
    }
    contents.push((JOINTS, Numbers::Real(&faces)));
    let sections: Vec<(&str, usize)> =
        contents.iter().map(|(name, own)| (*name, own.encoded_length())).collect();
    // One section at a time: all together would take as much memory as the fields.
    write_sections_with(path, &sections, |index| Cow::Owned(contents[index].1.encode()))
        .map_err(|error| create_write_error(path, &error))
}

/// Content of a section.
enum Numbers<'a> {
    Text(&'a str),
    Real(&'a [f64]),
    Indices(&'a [u16]),
}

impl Numbers<'_> {
    fn encoded_length(&self) -> usize {
        match self {
            Self::Text(text) => text.len(),
            Self::Real(values) => size_of_val(*values),
            Self::Indices(values) => values.len() * size_of::<i32>(),
        }
    }

    fn encode(&self) -> Vec<u8> {
        match self {
            Self::Text(text) => text.as_bytes().to_vec(),
            Self::Real(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
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
            visit(path, |name, _, content| match name == section {
                true => copy.read(size, content, &mut bytes),
                false => Ok(()),
            })?;
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
            visit(path, |name, _, content| {
                if name == JOINTS {
                    let mut bytes = Vec::new();
                    content.read_to_end(&mut bytes)?;
                    let numbers: Vec<f64> =
                        bytes.as_chunks().0.iter().map(|own| f64::from_le_bytes(*own)).collect();
                    faces.extend(numbers.as_chunks().0.iter().map(face_from_numbers));
                }
                Ok(())
            })?;
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
    visit_sections(path, visit).map_err(|SectionFileError { problem, .. }| match problem {
        SectionFileProblem::Io(error) => OutputError::from_read_error(path, &error),
        problem => OutputError::from_invalid_content(path, problem),
    })
}
