//! Geometric shapes: the key `shape` and its parameters.

use super::reader::SolidReader;
use crate::error::CaseError;
use crate::position_checks::check_order;
use crate::schema::{AllowedRange, KeyCondition, KeySchema, ListLength, ValueType};
use crate::section::{SectionReader, TableWriter};
use models::common::elementary::Elementary;

const POINT_TYPE: ValueType = ValueType::Numbers(ListLength::GridAxes);
const LENGTH_TYPE: ValueType = ValueType::Number(AllowedRange::Positive);
const BOX_CONDITION: &[KeyCondition] = &[KeyCondition::HasValue("shape", &["box"])];
const BALL_CONDITION: &[KeyCondition] = &[KeyCondition::HasValue("shape", &["circle", "sphere"])];
const LAYER_CONDITION: &[KeyCondition] = &[KeyCondition::HasValue("shape", &["layer"])];
const HALF_SPACE_CONDITION: &[KeyCondition] =
    &[KeyCondition::HasValue("shape", &["half-plane", "half-space"])];

/// Keys of the parameters of a shape.
pub(super) const SHAPE_KEYS: &[KeySchema] = &[
    KeySchema::new_required("from", POINT_TYPE, "m", "[-10.0, -20.0]", "lower corner, included")
        .with_note("lower corner")
        .with_conditions(BOX_CONDITION),
    KeySchema::new_required("to", POINT_TYPE, "m", "[10.0, -10.0]", "upper corner, excluded")
        .with_note("upper corner")
        .with_conditions(BOX_CONDITION),
    KeySchema::new_required("center", POINT_TYPE, "m", "[50.0, -25.0]", "centre")
        .with_note("centre")
        .with_conditions(BALL_CONDITION),
    KeySchema::new_required("radius", LENGTH_TYPE, "m", "10.0", "radius")
        .with_conditions(BALL_CONDITION),
    KeySchema::new_required(
        "axis",
        ValueType::Axis,
        "",
        "2",
        "axis normal to the layer, numbered from 1",
    )
    .with_note("an axis")
    .with_conditions(LAYER_CONDITION),
    KeySchema::new_required(
        "from",
        ValueType::Number(AllowedRange::Finite),
        "m",
        "-100.0",
        "lower coordinate along the axis, included",
    )
    .with_note("a coordinate along the axis")
    .with_conditions(LAYER_CONDITION),
    KeySchema::new_required(
        "to",
        ValueType::Number(AllowedRange::Finite),
        "m",
        "-50.0",
        "upper coordinate along the axis, excluded",
    )
    .with_note("a coordinate along the axis")
    .with_conditions(LAYER_CONDITION),
    KeySchema::new_required(
        "point",
        POINT_TYPE,
        "m",
        "[50.0, 0.0]",
        "point on the boundary plane, in 2D on the boundary line",
    )
    .with_note("point on the boundary")
    .with_conditions(HALF_SPACE_CONDITION),
    KeySchema::new_required(
        "normal",
        ValueType::Direction,
        "",
        "[1.0, 0.0]",
        "normal vector that points into the shape; any length",
    )
    .with_note("normal vector that points into the shape")
    .with_conditions(HALF_SPACE_CONDITION),
];

/// A geometric shape in the plane or in space.
#[derive(Clone, Debug, PartialEq)]
pub enum RegionShape {
    /// Box: lower corner ≤ x < upper corner along each axis.
    Box {
        /// Lower corner, m.
        lower_corner: Vec<f64>,
        /// Upper corner, m.
        upper_corner: Vec<f64>,
    },
    /// Open disc (2 dimensions) or open ball (3 dimensions).
    Ball {
        /// Centre, m.
        center: Vec<f64>,
        /// Radius, m; positive.
        radius: f64,
    },
    /// Layer: lower ≤ x < upper coordinate along one axis.
    Layer {
        /// Axis normal to the layer, numbered from 0.
        axis: usize,
        /// Lower coordinate, m.
        lower_coordinate: f64,
        /// Upper coordinate, m.
        upper_coordinate: f64,
    },
    /// Half-space (half-plane in two dimensions) on the side of the boundary plane to which the normal points. Each
    /// point of the boundary plane belongs to exactly one of the two half-spaces with opposite normals.
    HalfSpace {
        /// A point of the boundary plane, m.
        point: Vec<f64>,
        /// Inward normal, of any length but 0.
        normal: Vec<f64>,
    },
    /// The complement of all other regions.
    Complement,
    /// The whole grid.
    WholeGrid,
}

impl RegionShape {
    /// Returns the name in case files of 2 or 3 dimensions.
    pub const fn name(&self, dimensions: usize) -> &'static str {
        match (self, dimensions) {
            (Self::Box { .. }, _) => "box",
            (Self::Ball { .. }, 2) => "circle",
            (Self::Ball { .. }, _) => "sphere",
            (Self::Layer { .. }, _) => "layer",
            (Self::HalfSpace { .. }, 2) => "half-plane",
            (Self::HalfSpace { .. }, _) => "half-space",
            (Self::Complement, _) => "rest",
            (Self::WholeGrid, _) => "everywhere",
        }
    }

    /// Returns the names of the shapes in `dimensions` dimensions, including `extra`, the shape without parameters that
    /// the section allows.
    pub(super) fn allowed_names(dimensions: usize, extra: &Self) -> [&'static str; 5] {
        match dimensions {
            2 => ["box", "circle", "layer", "half-plane", extra.name(2)],
            _ => ["box", "sphere", "layer", "half-space", extra.name(3)],
        }
    }

    /// Returns the names of the shapes in `dimensions` dimensions, or in 2 and 3 dimensions if unknown; `extra` is the
    /// shape without parameters that the section allows.
    pub(super) fn allowed_names_in_scope(dimensions: Option<usize>, extra: &Self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for d in dimensions.map_or(2..=3, |d| d..=d) {
            for name in Self::allowed_names(d, extra) {
                if !names.iter().any(|own| own == name) {
                    names.push(name.to_owned());
                }
            }
        }
        names
    }

    /// Returns whether the shape contains a point; false for [`RegionShape::Complement`], which depends on the other
    /// regions.
    pub fn contains(&self, x: &[f64]) -> bool {
        match self {
            Self::Box { lower_corner: from, upper_corner: to } => {
                x.iter().zip(from.iter().zip(to)).all(|(x, (from, to))| (from..to).contains(&x))
            }
            Self::Ball { center, radius } => {
                let distance =
                    x.iter().zip(center).fold(0f64, |sum, (x, c)| sum.root_sum_square(x - c));
                distance < *radius
            }
            Self::Layer { axis, lower_coordinate: from, upper_coordinate: to } => {
                x.get(*axis).is_some_and(|x| (from..to).contains(&x))
            }
            Self::HalfSpace { point, normal } => {
                let terms = x.iter().zip(point.iter().zip(normal)).map(|(x, (p, n))| (x - p) * n);
                let side: f64 = terms.sum();
                let leading = normal.iter().copied().find(|n| *n != 0.0).unwrap_or(0.0);
                side > 0.0 || (side == 0.0 && leading > 0.0)
            }
            Self::Complement => false,
            Self::WholeGrid => true,
        }
    }

    /// Adds the keys of the shape to a table.
    pub(super) fn write_keys(&self, resolved: TableWriter, dimensions: usize) -> TableWriter {
        let resolved = resolved.with_text("shape", self.name(dimensions));
        match self {
            Self::Box { lower_corner: from, upper_corner: to } => {
                resolved.with_number("from", from).with_number("to", to)
            }
            Self::Ball { center, radius } => {
                resolved.with_number("center", center).with_number("radius", radius)
            }
            Self::Layer { axis, lower_coordinate: from, upper_coordinate: to } => resolved
                .with_number("axis", axis + 1)
                .with_number("from", from)
                .with_number("to", to),
            Self::HalfSpace { point, normal } => {
                resolved.with_number("point", point).with_number("normal", normal)
            }
            Self::Complement | Self::WholeGrid => resolved,
        }
    }
}

impl SolidReader<'_> {
    /// Reads a shape; `extra` is the shape without parameters that is allowed in this section.
    pub(super) fn read_shape(
        &self,
        section: &SectionReader,
        extra: &RegionShape,
    ) -> Result<RegionShape, CaseError> {
        let d = self.dimensions();
        let (names, others) =
            (RegionShape::allowed_names(d, extra), RegionShape::allowed_names(5 - d, extra));
        let found = section.node("shape").and_then(crate::node::Node::as_text).unwrap_or_default();
        if let Some(index) = others.iter().position(|other| *other == found)
            && names[index] != found
        {
            let found = format!("found '{found}' in a grid of {d} dimensions");
            return Err(section.key_error("shape", found, format!("write {}", names[index])));
        }
        let index = section.read_choice("shape", &[0, 1, 2, 3, 4], |index: usize| names[index])?;
        if self.grid.is_polar() && matches!(index, 1 | 3) {
            let found = format!("found '{}' on a polar grid", names[index]);
            let allowed = "expected box or layer: x1 is the angle in degrees, x2 the radius";
            return Err(section.key_error("shape", found, allowed));
        }
        Ok(match index {
            0 => {
                let (from, to): (Vec<f64>, Vec<f64>) =
                    (section.read_required("from")?, section.read_required("to")?);
                check_order(section, &from, &to)?;
                RegionShape::Box { lower_corner: from, upper_corner: to }
            }
            1 => RegionShape::Ball {
                center: section.read_required("center")?,
                radius: section.read_required("radius")?,
            },
            2 => {
                let axis = section.read_required::<usize>("axis")? - 1;
                let (from, to) = (section.read_required("from")?, section.read_required("to")?);
                check_order(section, &[from], &[to])?;
                RegionShape::Layer { axis, lower_coordinate: from, upper_coordinate: to }
            }
            3 => RegionShape::HalfSpace {
                point: section.read_required("point")?,
                normal: section.read_required("normal")?,
            },
            _ => extra.clone(),
        })
    }
}
