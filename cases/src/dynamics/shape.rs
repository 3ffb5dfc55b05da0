//! Geometric shapes: the key `shape` and its parameters.

use super::reader::Reader;
use crate::error::CaseError;
use crate::position::check_order;
use crate::schema::{Condition, Item, Length, Range, Type};
use crate::section::{Resolved, Section};
use models::common::elementary::Elementary;

const POINT: Type = Type::Numbers(Length::Axes);
const LENGTH: Type = Type::Number(Range::Positive);
const BOX: &[Condition] = &[Condition::Is("shape", &["box"])];
const BALL: &[Condition] = &[Condition::Is("shape", &["circle", "sphere"])];
const LAYER: &[Condition] = &[Condition::Is("shape", &["layer"])];
const HALF: &[Condition] = &[Condition::Is("shape", &["half-plane", "half-space"])];

/// Keys of the parameters of a shape.
pub(super) const ITEMS: &[Item] = &[
    Item::required(
        "from",
        POINT,
        "m",
        "[-10.0, -20.0]",
        "corner of least coordinates, which is in it",
    )
    .note("corner of least coordinates")
    .when(BOX),
    Item::required(
        "to",
        POINT,
        "m",
        "[10.0, -10.0]",
        "corner of greatest coordinates, which is not in it",
    )
    .note("corner of greatest coordinates")
    .when(BOX),
    Item::required("center", POINT, "m", "[50.0, -25.0]", "centre").note("centre").when(BALL),
    Item::required("radius", LENGTH, "m", "10.0", "radius").when(BALL),
    Item::required("axis", Type::Axis, "", "2", "the axis normal to the layer, from 1")
        .note("an axis")
        .when(LAYER),
    Item::required(
        "from",
        Type::Number(Range::Finite),
        "m",
        "-100.0",
        "first coordinate, which is in it",
    )
    .note("a coordinate along the axis")
    .when(LAYER),
    Item::required(
        "to",
        Type::Number(Range::Finite),
        "m",
        "-50.0",
        "last coordinate, which is not in it",
    )
    .note("a coordinate along the axis")
    .when(LAYER),
    Item::required("point", POINT, "m", "[50.0, 0.0]", "a point of its edge")
        .note("a point of the edge")
        .when(HALF),
    Item::required("normal", Type::Direction, "", "[1.0, 0.0]", "points into it; of any length")
        .note("points into the shape")
        .when(HALF),
];

/// A geometric shape in the plane or in space.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Box: from ≤ x < to along each axis.
    Box {
        /// Lower corner, m.
        from: Vec<f64>,
        /// Upper corner, m.
        to: Vec<f64>,
    },
    /// Open disc (2 dimensions) or ball (3 dimensions).
    Ball {
        /// Centre, m.
        center: Vec<f64>,
        /// Radius, m; positive.
        radius: f64,
    },
    /// Layer: from ≤ x < to along one axis.
    Layer {
        /// Axis normal to the layer, numbered from 0.
        axis: usize,
        /// Lower coordinate, m.
        from: f64,
        /// Upper coordinate, m.
        to: f64,
    },
    /// Half-space (half-plane in two dimensions) on the side of the normal. Each point of the boundary plane belongs to
    /// exactly one of the two half-spaces with opposite normals.
    HalfSpace {
        /// A point of the boundary plane, m.
        point: Vec<f64>,
        /// Inward normal, of any length but 0.
        normal: Vec<f64>,
    },
    /// The complement of all other regions.
    Rest,
    /// The whole grid.
    Everywhere,
}

impl Shape {
    /// Returns the name in case files of 2 or 3 dimensions.
    pub const fn name(&self, dimensions: usize) -> &'static str {
        match (self, dimensions) {
            (Self::Box { .. }, _) => "box",
            (Self::Ball { .. }, 2) => "circle",
            (Self::Ball { .. }, _) => "sphere",
            (Self::Layer { .. }, _) => "layer",
            (Self::HalfSpace { .. }, 2) => "half-plane",
            (Self::HalfSpace { .. }, _) => "half-space",
            (Self::Rest, _) => "rest",
            (Self::Everywhere, _) => "everywhere",
        }
    }

    /// Returns the names of the shapes in `dimensions` dimensions, including the allowed shape `extra` without
    /// parameters.
    pub(super) fn names(dimensions: usize, extra: &Self) -> [&'static str; 5] {
        match dimensions {
            2 => ["box", "circle", "layer", "half-plane", extra.name(2)],
            _ => ["box", "sphere", "layer", "half-space", extra.name(3)],
        }
    }

    /// Returns the names of the shapes in `dimensions` dimensions, or in 2 and 3 dimensions if unknown.
    pub(super) fn words(dimensions: Option<usize>, extra: &Self) -> Vec<String> {
        let mut words: Vec<String> = Vec::new();
        for d in dimensions.map_or(2..=3, |d| d..=d) {
            for name in Self::names(d, extra) {
                if !words.iter().any(|own| own == name) {
                    words.push(name.to_owned());
                }
            }
        }
        words
    }

    /// Returns whether the shape contains a point; false for [`Shape::Rest`], which depends on the other regions.
    pub fn contains(&self, x: &[f64]) -> bool {
        match self {
            Self::Box { from, to } => {
                x.iter().zip(from.iter().zip(to)).all(|(x, (from, to))| (from..to).contains(&x))
            }
            Self::Ball { center, radius } => {
                let distance =
                    x.iter().zip(center).fold(0f64, |sum, (x, c)| sum.root_sum_square(x - c));
                distance < *radius
            }
            Self::Layer { axis, from, to } => x.get(*axis).is_some_and(|x| (from..to).contains(&x)),
            Self::HalfSpace { point, normal } => {
                let terms = x.iter().zip(point.iter().zip(normal)).map(|(x, (p, n))| (x - p) * n);
                let side: f64 = terms.sum();
                let leading = normal.iter().copied().find(|n| *n != 0.0).unwrap_or(0.0);
                side > 0.0 || (side == 0.0 && leading > 0.0)
            }
            Self::Rest => false,
            Self::Everywhere => true,
        }
    }

    /// Adds the keys of the shape to a table.
    pub(super) fn resolved(&self, resolved: Resolved, dimensions: usize) -> Resolved {
        let resolved = resolved.text("shape", self.name(dimensions));
        match self {
            Self::Box { from, to } => resolved.number("from", from).number("to", to),
            Self::Ball { center, radius } => {
                resolved.number("center", center).number("radius", radius)
            }
            Self::Layer { axis, from, to } => {
                resolved.number("axis", axis + 1).number("from", from).number("to", to)
            }
            Self::HalfSpace { point, normal } => {
                resolved.number("point", point).number("normal", normal)
            }
            Self::Rest | Self::Everywhere => resolved,
        }
    }
}

impl Reader<'_> {
    /// Reads a shape; `extra` is the shape without parameters that is allowed in this section.
    pub(super) fn shape(&self, section: &Section, extra: &Shape) -> Result<Shape, CaseError> {
        let d = self.dimensions();
        let (names, others) = (Shape::names(d, extra), Shape::names(5 - d, extra));
        let found = section.node("shape").and_then(crate::node::Node::text).unwrap_or_default();
        if let Some(index) = others.iter().position(|other| *other == found)
            && names[index] != found
        {
            let found = format!("found '{found}' in a grid of {d} dimensions");
            return Err(section.error("shape", found, format!("write {}", names[index])));
        }
        let index = section.choice("shape", &[0, 1, 2, 3, 4], |index: usize| names[index])?;
        Ok(match index {
            0 => {
                let (from, to): (Vec<f64>, Vec<f64>) =
                    (section.required("from")?, section.required("to")?);
                check_order(section, &from, &to)?;
                Shape::Box { from, to }
            }
            1 => Shape::Ball {
                center: section.required("center")?,
                radius: section.required("radius")?,
            },
            2 => {
                let axis = section.required::<usize>("axis")? - 1;
                let (from, to) = (section.required("from")?, section.required("to")?);
                check_order(section, &[from], &[to])?;
                Shape::Layer { axis, from, to }
            }
            3 => Shape::HalfSpace {
                point: section.required("point")?,
                normal: section.required("normal")?,
            },
            _ => extra.clone(),
        })
    }
}
