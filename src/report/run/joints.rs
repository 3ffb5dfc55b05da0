//! Files of the joints of a blocky medium (table, archive, VTK), and the lines that show joints in pictures.

use crate::Error;
use crate::case::dynamics::{Blocks, FaceQuantity, SolidGrid};
use crate::report::{ArrayData, DataArray, DataFile, DataTable};
use crate::study::simulate::{FaceRecord, JOINT_QUANTITIES, JointFace};
use figures::{FieldLine, FieldLineSet, FieldLineStyle};
use files::csv::CsvCell;
use files::npz::{ArrayValues, NpzArray, NpzError, read_selected_arrays};
use files::vti::{POINTS_ARRAY, PolyData, Storage};

/// Column of a table of joints: name, unit, and value by face.
type FaceColumn = (&'static str, &'static str, fn(&JointFace) -> f64);

/// Columns of position and identity of a face, which precede its [`JOINT_QUANTITIES`]; the axis is counted from 1.
const POSITION_COLUMNS: [FaceColumn; 4] = [
    ("x1", "m", |face| face.position[0]),
    ("x2", "m", |face| face.position[1]),
    ("axis", "1", |face| (face.axis + 1) as f64),
    ("joint", "1", |face| face.joint_index as f64),
];

/// Creates the table of all faces, with one row per face.
pub(super) fn create_table(faces: &[JointFace]) -> DataFile<'_> {
    let rows = faces.iter().map(|face| {
        let place = POSITION_COLUMNS.iter().map(|(_, _, value)| value(face));
        let state = JOINT_QUANTITIES.iter().map(|(_, _, value)| value(&face.record));
        place.chain(state).map(CsvCell::Number).collect()
    });
    let columns = column_units().map(|(name, unit)| (name.to_owned(), unit.into())).collect();
    DataFile::Table(DataTable { columns, rows: Box::new(rows) })
}

/// Iterates over the names and units of all columns.
fn column_units() -> impl Iterator<Item = (&'static str, &'static str)> {
    let columns = POSITION_COLUMNS.iter().map(|(name, unit, _)| (*name, *unit));
    columns.chain(JOINT_QUANTITIES.iter().map(|(name, unit, _)| (*name, *unit)))
}

/// Creates the arrays of all faces, one per column.
pub(super) fn create_arrays(faces: &[JointFace]) -> DataFile<'_> {
    let (names, units): (Vec<&str>, Vec<&str>) = column_units().unzip();
    let along = [("face", faces.len())];
    let mut arrays = vec![
        DataArray::texts("names", "column", &names),
        DataArray::texts("units", "column", &units),
    ];
    for (name, unit, value) in POSITION_COLUMNS {
        let values = faces.iter().map(value);
        let values = match unit {
            "m" => ArrayData::F64(values.collect()),
            _ => ArrayData::I32(values.map(|value| value as i32).collect()),
        };
        arrays.push(DataArray::new(name, &along, unit, values));
    }
    for (name, unit, value) in JOINT_QUANTITIES {
        let values: Vec<f64> = faces.iter().map(|face| value(&face.record)).collect();
        arrays.push(DataArray::numbers(name, &along, unit, values));
    }
    DataFile::Arrays(arrays)
}

/// Creates the ParaView file of all faces, one line each.
///
/// # Errors
/// A coordinate or the time is not finite.
pub fn create_joint_lines(faces: &[JointFace], time: f64) -> Result<PolyData, Error> {
    let ends: Vec<[[f64; 2]; 2]> = faces.iter().map(JointFace::ends).collect();
    let mut lines = PolyData::new(&ends, Storage::Plain)?;
    lines.set_time(time)?;
    let integers = |value: fn(&JointFace) -> usize| -> Vec<i32> {
        faces.iter().map(|face| value(face) as i32).collect()
    };
    lines.add_array("axis", &integers(|face| face.axis + 1))?;
    lines.add_array("joint", &integers(|face| face.joint_index))?;
    for (name, unit, value) in JOINT_QUANTITIES {
        let values: Vec<f64> = faces.iter().map(|face| value(&face.record)).collect();
        lines.add_array(&array_name(name, unit), &values)?;
    }
    Ok(lines)
}

/// Returns the name of a quantity in ParaView files.
fn array_name(name: &str, unit: &str) -> String {
    if unit == "1" { name.to_owned() } else { format!("{name} [{unit}]") }
}

/// Creates the state of a face from its quantities by name.
fn build_record(value: impl Fn(&str) -> Option<f64>) -> Option<FaceRecord<f64>> {
    // Times of events that have not happened are not-a-number in files.
    let time = |name| value(name).map(|time: f64| if time.is_nan() { 0.0 } else { time });
    Some(FaceRecord {
        slip: value("slip")?,
        opening: value("opening")?,
        slip_time: time("slip_time")?,
        fracture_time: time("fracture_time")?,
        normal_stress: value("normal_stress")?,
        shear_stress: value("shear_stress")?,
        porosity: value("porosity")?,
        pressure: value("pressure")?,
        fluid_velocity: value("fluid_velocity")?,
    })
}

/// Reads the faces from the archive of a run on a plane grid.
///
/// # Errors
/// The archive is damaged. If it is valid but contains other arrays, the list of faces is empty.
pub fn read_joints(bytes: &[u8], grid: &SolidGrid) -> Result<Vec<JointFace>, NpzError> {
    let is_numbers = |name: &str| !["names", "units"].contains(&name);
    let arrays = read_selected_arrays(bytes, is_numbers, 2 * grid.cell_count())?;
    let array = |name: &str| arrays.iter().find(|array: &&NpzArray| array.name == name);
    let number = |name: &str, face: usize| match &array(name)?.values {
        ArrayValues::F64(values) => values.get(face).copied(),
        ArrayValues::I32(values) => values.get(face).map(|value| f64::from(*value)),
        _ => None,
    };
    let face = |index: usize| {
        let axis = match number("axis", index)? {
            1.0 => 0,
            2.0 => 1,
            _ => return None,
        };
        Some(JointFace {
            position: [number("x1", index)?, number("x2", index)?],
            axis,
            length: *grid.spacing.get(1 - axis)?,
            joint_index: number("joint", index)? as usize,
            record: build_record(|name| number(name, index))?,
        })
    };
    let count = array("x1").map_or(0, |array| array.shape.first().copied().unwrap_or(0));
    Ok((0..count).map_while(face).collect())
}

/// Reads the faces of joints from the ParaView file of a snapshot, for drawing; sets the index of the joint to 0, since
/// it is not read.
///
/// # Errors
/// An array is absent or too short; the error is a message.
pub(super) fn read_joint_lines(bytes: &[u8]) -> Result<Vec<JointFace>, String> {
    let read = |name: &str| {
        files::vti::read_plain_values(bytes, name).ok_or_else(|| format!("no array {name}"))
    };
    let points = read(POINTS_ARRAY)?;
    let state = JOINT_QUANTITIES.map(|(name, unit, _)| read(&array_name(name, unit)));
    let state: Vec<Vec<f64>> = state.into_iter().collect::<Result<_, String>>()?;
    let face = |(index, ends): (usize, &[f64; 6])| {
        let [from, to] = [[ends[0], ends[1]], [ends[3], ends[4]]];
        let axis = usize::from(from[1] == to[1]);
        let value = |name: &str| {
            let column = JOINT_QUANTITIES.iter().position(|own| own.0 == name)?;
            state[column].get(index).copied()
        };
        Some(JointFace {
            position: [0, 1].map(|axis| 0.5 * (from[axis] + to[axis])),
            axis,
            length: to[1 - axis] - from[1 - axis],
            joint_index: 0,
            record: build_record(value)?,
        })
    };
    let faces = points.as_chunks().0.iter().enumerate().map(face);
    faces.collect::<Option<_>>().ok_or_else(|| "too few values of joints".to_owned())
}

/// Largest slip and opening of joints, m, in a run or in a state; the widest lines in pictures correspond to them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointLineScale {
    max_slip: f64,
    /// Largest slip of a broken face, m.
    max_broken_slip: f64,
    max_opening: f64,
    has_broken: bool,
}

impl JointLineScale {
    /// Determines the largest slip and opening of a state.
    pub(super) fn new(faces: &[JointFace]) -> Self {
        let mut own = Self::default();
        for face in faces {
            match face.stage() {
                JointStage::Open => own.max_opening = own.max_opening.max(face.record.opening),
                JointStage::Broken => {
                    own.has_broken = true;
                    own.max_broken_slip = own.max_broken_slip.max(face.record.slip);
                }
                JointStage::Slipped => own.max_slip = own.max_slip.max(face.record.slip),
                JointStage::Intact => {}
            }
        }
        own
    }

    /// Returns the scale for the joint lines of both: the larger of each pair of limits.
    #[must_use]
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            max_slip: self.max_slip.max(other.max_slip),
            max_broken_slip: self.max_broken_slip.max(other.max_broken_slip),
            max_opening: self.max_opening.max(other.max_opening),
            has_broken: self.has_broken || other.has_broken,
        }
    }
}

/// Stage that a face of a joint has reached, which determines its line style in pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum JointStage {
    Intact,
    Slipped,
    /// Broken, but not open.
    Broken,
    Open,
}

impl JointFace {
    fn stage(&self) -> JointStage {
        match () {
            () if self.is_open() => JointStage::Open,
            () if self.is_broken() => JointStage::Broken,
            () if self.has_slipped() => JointStage::Slipped,
            () => JointStage::Intact,
        }
    }
}

/// Smallest slip of joints that is drawn, as a share of the largest slip of broken joints.
const SMALLEST_VISIBLE_SHARE: f64 = 0.05;

/// Creates the lines of the joints of a blocky medium: outlines of the blocks, then slipped, broken and open faces.
/// Which sets there are depends only on the scale. Empty without joints.
pub(super) fn create_line_sets(
    blocks: &Blocks,
    faces: &[JointFace],
    scale: JointLineScale,
) -> Vec<FieldLineSet> {
    if !blocks.has_joints() {
        return Vec::new();
    }
    let set = |style, label: &str, limit: f64, lines| FieldLineSet {
        style,
        label: label.to_owned(),
        unit: if limit > 0.0 { "m".to_owned() } else { String::new() },
        lines,
        limit,
    };
    let select = |stage, value: fn(&FaceRecord<f64>) -> f64| -> Vec<FieldLine> {
        let own = faces.iter().filter(|face| face.stage() == stage);
        let line = |face: &JointFace| FieldLine {
            axis: face.axis,
            centre: face.position,
            length: face.length,
            value: value(&face.record),
        };
        own.map(line).collect()
    };
    let mut sets = vec![set(FieldLineStyle::Outline, "joints", 0.0, create_outlines(blocks))];
    // Beside much larger slip of broken joints the lines would be too thin to be seen.
    if scale.max_slip > SMALLEST_VISIBLE_SHARE * scale.max_broken_slip {
        let lines = select(JointStage::Slipped, |own| own.slip);
        sets.push(set(FieldLineStyle::Solid, "slip", scale.max_slip, lines));
    }
    if scale.has_broken {
        let lines = select(JointStage::Broken, |own| own.slip);
        let label = match scale.max_broken_slip > 0.0 {
            true => "broken and closed, slip",
            false => "broken and closed",
        };
        sets.push(set(FieldLineStyle::Dotted, label, scale.max_broken_slip, lines));
    }
    if scale.max_opening > 0.0 {
        let lines = select(JointStage::Open, |own| own.opening);
        sets.push(set(FieldLineStyle::Gap, "open, gap", scale.max_opening, lines));
    }
    sets
}

/// Returns the value of a plotted quantity of a face.
pub(super) fn face_value(record: &FaceRecord<f64>, quantity: FaceQuantity) -> f64 {
    match quantity {
        FaceQuantity::Slip => record.slip,
        FaceQuantity::Opening => record.opening,
        FaceQuantity::Pressure => record.pressure,
    }
}

/// Creates the lines of a picture of a quantity of joints: outlines of the blocks, then the faces in the colours of
/// their values. Empty without joints.
pub(super) fn create_face_line_sets(
    blocks: &Blocks,
    faces: &[JointFace],
    quantity: FaceQuantity,
) -> Vec<FieldLineSet> {
    if !blocks.has_joints() {
        return Vec::new();
    }
    let line = |face: &JointFace| FieldLine {
        axis: face.axis,
        centre: face.position,
        length: face.length,
        value: face_value(&face.record, quantity),
    };
    let set = |style, label: &str, lines| FieldLineSet {
        style,
        label: label.to_owned(),
        unit: String::new(),
        lines,
        limit: 0.0,
    };
    let label = match quantity {
        FaceQuantity::Slip => "slip",
        FaceQuantity::Opening => "opening",
        FaceQuantity::Pressure => "pressure",
    };
    vec![
        set(FieldLineStyle::Outline, "joints", create_outlines(blocks)),
        set(FieldLineStyle::Coloured, label, faces.iter().map(line).collect()),
    ]
}

/// Returns the common faces of adjacent blocks that are connected by joints.
fn create_outlines(blocks: &Blocks) -> Vec<FieldLine> {
    let contacts = blocks.contacts.iter().filter(|contact| contact.joint_index.is_some());
    let line = |contact: &crate::case::dynamics::BlockContact| {
        let (axis, along) = (contact.axis, 1 - contact.axis);
        let coordinate =
            |axis: usize, cells: f64| blocks.origin[axis] + cells * blocks.spacing[axis];
        let mut centre = [0.0; 2];
        centre[axis] = coordinate(axis, contact.plane_index as f64);
        let middle = 0.5 * (contact.tangential_cells.start + contact.tangential_cells.end) as f64;
        centre[along] = coordinate(along, middle);
        let length = contact.tangential_cells.len() as f64 * blocks.spacing[along];
        FieldLine { axis, centre, length, value: 0.0 }
    };
    contacts.map(line).collect()
}
