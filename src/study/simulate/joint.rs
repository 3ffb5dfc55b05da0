//! State of the joints of a blocky medium for output.

use crate::case::dynamics::SolidGrid;
use dynamics::solid::interlayers::InterlayerFace;
pub use models::interface::layer::FaceRecord;
use serde::ser::SerializeMap as _;
use serde::{Serialize, Serializer};

/// Name, unit and value of a quantity of a joint face.
pub type JointQuantity = (&'static str, &'static str, fn(&FaceRecord<f64>) -> f64);

/// Quantities of a joint face in the order of the files. Times of events that have not happened are not-a-number;
/// other quantities that the law of a joint does not have are zero.
pub const JOINT_QUANTITIES: [JointQuantity; 9] = [
    ("normal_stress", "Pa", |own| own.normal_stress),
    ("shear_stress", "Pa", |own| own.shear_stress),
    ("slip", "m", |own| own.slip),
    ("opening", "m", |own| own.opening),
    ("slip_time", "s", |own| event_time(own.slip_time)),
    ("fracture_time", "s", |own| event_time(own.fracture_time)),
    ("porosity", "1", |own| own.porosity),
    ("pressure", "Pa", |own| own.pressure),
    ("fluid_velocity", "m/s", |own| own.fluid_velocity),
];

/// Returns the time of an event, s; not-a-number if it has not happened (time 0).
fn event_time(time: f64) -> f64 {
    if time > 0.0 { time } else { f64::NAN }
}

/// State of one face of a joint, i.e. of the interface between two adjacent cells of different blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFace {
    /// Coordinates of the centre of the face, m.
    pub position: [f64; 2],
    /// Index of the axis normal to the face, counted from 0.
    pub axis: usize,
    /// Length of the face in the plane, m.
    pub length: f64,
    /// Index of the section `[[joint]]` of the case.
    pub joint_index: usize,
    /// State of the face; quantities that the law of the joint does not have, and times of events that have not
    /// happened, are zero.
    pub record: FaceRecord<f64>,
}

impl JointFace {
    /// Creates the output of an interlayer face of a solid on a plane grid.
    pub(super) fn new(grid: &SolidGrid, face: &InterlayerFace, record: FaceRecord<f64>) -> Self {
        let InterlayerFace { axis, cell, law, .. } = *face;
        let cell = [cell % grid.cells[0], cell / grid.cells[0]];
        let mut position = [0, 1].map(|along| grid.cell_centre(along, cell[along]));
        position[axis] = grid.origin[axis] + cell[axis] as f64 * grid.spacing[axis];
        Self { position, axis, length: grid.spacing[1 - axis], joint_index: law, record }
    }

    /// Returns the coordinates of both ends of the face, m.
    pub fn ends(&self) -> [[f64; 2]; 2] {
        let mut ends = [self.position; 2];
        ends[0][1 - self.axis] -= 0.5 * self.length;
        ends[1][1 - self.axis] += 0.5 * self.length;
        ends
    }

    /// Returns whether the face has slipped.
    pub fn has_slipped(&self) -> bool {
        self.record.slip > 0.0
    }

    /// Returns whether the face is open.
    pub fn is_open(&self) -> bool {
        self.record.opening > 0.0
    }

    /// Returns whether the face has broken.
    pub fn is_broken(&self) -> bool {
        self.record.fracture_time > 0.0
    }
}

/// Serialises the face as its columns in files, with the axis counted from 1.
impl Serialize for JointFace {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(4 + JOINT_QUANTITIES.len()))?;
        map.serialize_entry("x1", &self.position[0])?;
        map.serialize_entry("x2", &self.position[1])?;
        map.serialize_entry("axis", &(self.axis + 1))?;
        map.serialize_entry("joint", &self.joint_index)?;
        for (name, _, value) in JOINT_QUANTITIES {
            map.serialize_entry(name, &value(&self.record))?;
        }
        map.end()
    }
}

/// Numbers of slipped, open and broken faces of all joints, and their extreme values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct JointSummary {
    /// Number of faces, one per pair of adjacent cells.
    #[serde(rename = "faces")]
    pub face_count: usize,
    /// Number of faces that have slipped.
    #[serde(rename = "slipped")]
    pub slipped_count: usize,
    /// Number of faces that are open.
    #[serde(rename = "open")]
    pub open_count: usize,
    /// Number of faces that have broken.
    #[serde(rename = "broken")]
    pub broken_count: usize,
    /// Largest slip of a face, m.
    #[serde(rename = "largest_slip")]
    pub max_slip: f64,
    /// Largest opening of a face, m.
    #[serde(rename = "largest_opening")]
    pub max_opening: f64,
    /// Time of the first slip, s; `None` without slip.
    pub first_slip_time: Option<f64>,
    /// Time of the first fracture, s; `None` without fracture.
    pub first_fracture_time: Option<f64>,
}

impl JointSummary {
    /// Summarises the state of all faces; `None` without faces.
    pub fn new(faces: &[JointFace]) -> Option<Self> {
        let count = |is_selected: fn(&JointFace) -> bool| {
            faces.iter().filter(|face| is_selected(face)).count()
        };
        let largest = |value: fn(&FaceRecord<f64>) -> f64| {
            faces.iter().fold(0.0, |largest: f64, face| largest.max(value(&face.record)))
        };
        let first = |time: fn(&FaceRecord<f64>) -> f64| {
            let times = faces.iter().map(|face| time(&face.record));
            times.filter(|time| *time > 0.0).reduce(f64::min)
        };
        (!faces.is_empty()).then(|| Self {
            face_count: faces.len(),
            slipped_count: count(JointFace::has_slipped),
            open_count: count(JointFace::is_open),
            broken_count: count(JointFace::is_broken),
            max_slip: largest(|own| own.slip),
            max_opening: largest(|own| own.opening),
            first_slip_time: first(|own| own.slip_time),
            first_fracture_time: first(|own| own.fracture_time),
        })
    }
}

impl JointSummary {
    /// Returns counts, extremes and times as numbers; 0 for times of events that have not happened.
    pub(super) fn to_numbers(self) -> [f64; 8] {
        [
            self.face_count as f64,
            self.slipped_count as f64,
            self.open_count as f64,
            self.broken_count as f64,
            self.max_slip,
            self.max_opening,
            self.first_slip_time.unwrap_or(0.0),
            self.first_fracture_time.unwrap_or(0.0),
        ]
    }

    /// Returns the summary with these numbers; `None` without faces.
    pub(super) fn from_numbers(numbers: &[f64; 8]) -> Option<Self> {
        let time = |time: f64| (time > 0.0).then_some(time);
        (numbers[0] > 0.0).then(|| Self {
            face_count: numbers[0] as usize,
            slipped_count: numbers[1] as usize,
            open_count: numbers[2] as usize,
            broken_count: numbers[3] as usize,
            max_slip: numbers[4],
            max_opening: numbers[5],
            first_slip_time: time(numbers[6]),
            first_fracture_time: time(numbers[7]),
        })
    }

    /// Summarises the faces of two summaries.
    pub(super) fn merge(self, other: Self) -> Self {
        let first = |one: Option<f64>, other| [one, other].into_iter().flatten().reduce(f64::min);
        Self {
            face_count: self.face_count + other.face_count,
            slipped_count: self.slipped_count + other.slipped_count,
            open_count: self.open_count + other.open_count,
            broken_count: self.broken_count + other.broken_count,
            max_slip: self.max_slip.max(other.max_slip),
            max_opening: self.max_opening.max(other.max_opening),
            first_slip_time: first(self.first_slip_time, other.first_slip_time),
            first_fracture_time: first(self.first_fracture_time, other.first_fracture_time),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new_face(record: FaceRecord<f64>) -> JointFace {
        JointFace { position: [1.0, 0.25], axis: 0, length: 0.5, joint_index: 2, record }
    }

    /// Verifies counts, extremes and times of first events, and that faces at rest have no such times.
    #[test]
    fn faces_are_counted_by_state() {
        let faces = [
            FaceRecord::default(),
            FaceRecord { slip: 2e-6, slip_time: 3e-5, ..FaceRecord::default() },
            FaceRecord {
                slip: 1e-6,
                slip_time: 2e-5,
                fracture_time: 4e-5,
                ..FaceRecord::default()
            },
            FaceRecord { opening: 5e-6, fracture_time: 3e-5, ..FaceRecord::default() },
        ]
        .map(new_face);
        let expected = JointSummary {
            face_count: 4,
            slipped_count: 2,
            open_count: 1,
            broken_count: 2,
            max_slip: 2e-6,
            max_opening: 5e-6,
            first_slip_time: Some(2e-5),
            first_fracture_time: Some(3e-5),
        };
        assert_eq!(JointSummary::new(&faces), Some(expected));
        let [one, other] =
            [&faces[..3], &faces[3..]].map(|own| JointSummary::new(own).expect("faces"));
        assert_eq!(one.merge(other), expected);
        assert_eq!(JointSummary::from_numbers(&expected.to_numbers()), Some(expected));
        assert_eq!(JointSummary::from_numbers(&[0.0; 8]), None);
        assert_eq!(JointSummary::new(&[]), None);
        let still = JointSummary::new(&faces[..1]).expect("a face");
        assert_eq!((still.first_slip_time, still.first_fracture_time), (None, None));
    }

    /// Verifies the ends of a face, and that times of absent events are serialised as null.
    #[test]
    fn faces_are_serialised_by_columns() {
        let face = new_face(FaceRecord { slip_time: 3e-5, ..FaceRecord::default() });
        assert_eq!(face.ends(), [[1.0, 0.0], [1.0, 0.5]]);
        let json = serde_json::to_value(&face).expect("JSON");
        let expected = [("axis", 1.0), ("joint", 2.0), ("x2", 0.25), ("slip_time", 3e-5)];
        assert!(expected.into_iter().all(|(name, value)| json[name].as_f64() == Some(value)));
        assert!(json["fracture_time"].is_null());
    }
}
