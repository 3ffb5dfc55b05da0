//! Pictures of the simulation of a solid.

use super::SOLID_LEDGER_TERMS;
use super::display::axis_label;
use super::fluid::FluidState;
use super::joints::{JointLineScale, create_face_line_sets, create_line_sets};
use super::polar::{PolarRaster, polar_label, reflect_components};
use super::profile::create_profile;
use super::records::{create_ledger_picture, create_seismograms, select_evenly_spaced_indices};
use super::snapshot::read_array;
use crate::case::Case;
use crate::case::dynamics::{
    FaceLoad, FaceQuantity, LoadedArea, PlottedQuantity, RegionShape, SolidGrid, SolidRun,
    SourceKind, StateComponent,
};
use crate::report::ReportPicture;
use crate::report::format::{case_title, format_short};
use crate::study::simulate::{OutputFields, RunRecords, quantity_unit};
use figures::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind, FieldOutline};
use models::common::elementary::Elementary;
use models::solid::waves::SolidField;
use std::fmt::Write as _;

/// Indices of the axes in symbols.
const AXIS_INDICES: [&str; 3] = ["₁", "₂", "₃"];

/// Creates all pictures of a run except the animation.
pub(super) fn create_pictures(
    case: &Case,
    solid_run: &SolidRun,
    fields: &OutputFields,
    records: &RunRecords,
) -> Vec<ReportPicture> {
    let final_state = |stem, shown| {
        let figure = create_figure(case, solid_run, fields, shown);
        match create_profile(&figure, None) {
            Some(profile) => ReportPicture::new(stem, move |format| profile.draw(format)),
            None => ReportPicture::new(stem, move |format| figure.draw(format)),
        }
    };
    let mut pictures = vec![final_state("run", solid_run.output.plotted_quantity)];
    pictures.extend(create_record_pictures(case, records));
    if !fields.plastic_dissipation.is_empty()
        && solid_run.output.plotted_quantity != PlottedQuantity::Dissipation
    {
        pictures.push(final_state("dissipation", PlottedQuantity::Dissipation));
    }
    if let Some(figure) = create_fluid_figure(case, solid_run, fields) {
        pictures.push(ReportPicture::new("fluid", move |format| figure.draw(format)));
    }
    pictures
}

/// Returns the names of the quantities whose values the picture of the final state shows.
pub fn list_drawn_quantities(solid_run: &SolidRun) -> Vec<String> {
    match solid_run.output.plotted_quantity {
        PlottedQuantity::Speed => list_velocities(solid_run).collect(),
        other => vec![other.name().to_string()],
    }
}

/// Iterates over the names of the components of the velocity.
fn list_velocities(solid_run: &SolidRun) -> impl Iterator<Item = String> {
    (1..=solid_run.grid.dimensions()).map(|axis| format!("v{axis}"))
}

/// Creates the pictures of receivers and of the energy ledger.
pub(super) fn create_record_pictures(case: &Case, records: &RunRecords) -> Vec<ReportPicture> {
    let seismograms = records.receivers.as_ref().map(|table| create_seismograms(case, table));
    let ledger = create_ledger_picture(case, &records.ledger, SOLID_LEDGER_TERMS);
    seismograms.into_iter().chain(ledger).collect()
}

/// Creates the figure of the circulation of the fluid in saturated joints; `None` without such joints.
fn create_fluid_figure(
    case: &Case,
    solid_run: &SolidRun,
    fields: &OutputFields,
) -> Option<FieldFigure> {
    let blocks = solid_run.blocks.as_ref()?;
    let FluidState { pressures, arrows } =
        FluidState::new(blocks, &solid_run.grid, &fields.joint_faces)?;
    let figure = PlaneSection::new(solid_run).create_figure(
        case,
        PlottedQuantity::Speed,
        fields.time,
        pressures,
    );
    Some(FieldFigure {
        label: "pressure of fluid p (Pa)".to_owned(),
        is_signed: true,
        contour_levels: None,
        arrows: Some(arrows),
        line_sets: create_line_sets(blocks, &[], JointLineScale::default()),
        ..figure
    })
}

/// Creates the figure of the quantity `shown` in the final state; in three dimensions, of the section normal to x₂
/// through the first source or, without sources, through the middle of the grid.
fn create_figure(
    case: &Case,
    solid_run: &SolidRun,
    fields: &OutputFields,
    shown: PlottedQuantity,
) -> FieldFigure {
    let section = PlaneSection::new(solid_run);
    let values: Vec<f64> = match shown {
        PlottedQuantity::Speed => {
            let of_axis = |name: String| fields.get(&name);
            let axes: Vec<&[f64]> = list_velocities(solid_run).filter_map(of_axis).collect();
            let of_cell = |cell: usize| {
                let along = axes.iter().map(|values| cell_value(values, cell));
                along.fold(0.0, Elementary::root_sum_square)
            };
            section.cell_indices().map(of_cell).collect()
        }
        PlottedQuantity::Dissipation => section
            .cell_indices()
            .map(|cell| cell_value(&fields.plastic_dissipation, cell))
            .collect(),
        // Faces have the colours of the scale, cells have none.
        PlottedQuantity::Face(_) => section.cell_indices().map(|_| 0.0).collect(),
        other => {
            let values = fields.get(&other.name()).unwrap_or_default();
            section.cell_indices().map(|cell| cell_value(values, cell)).collect()
        }
    };
    let mut figure = section.create_figure(case, shown, fields.time, values);
    figure.is_root_scaled = figure.is_signed && has_weak_waves(&figure.values);
    if fields.region_indices.iter().any(|region| *region != fields.region_indices[0]) {
        let region = |cell: usize| fields.region_indices.get(cell).copied().unwrap_or(0);
        let regions = section.cell_indices().map(region).collect();
        figure.material_indices = section.to_raster(regions, u16::MAX);
    }
    if !fields.plastic_dissipation.is_empty() && shown != PlottedQuantity::Dissipation {
        let has_yielded = |cell| cell_value(&fields.plastic_dissipation, cell) > 0.0;
        let yielded = section.cell_indices().map(has_yielded).collect();
        figure.has_yielded = section.to_raster(yielded, false);
    }
    if let Some(blocks) = &solid_run.blocks {
        let faces = &fields.joint_faces;
        figure.line_sets = match shown {
            PlottedQuantity::Face(quantity) => create_face_line_sets(blocks, faces, quantity),
            _ => create_line_sets(blocks, faces, JointLineScale::new(faces)),
        };
    }
    figure
}

/// Returns whether most of the motion is weak beside a few cells, as body waves are beside a surface wave: more than a
/// twentieth of the cells exceed a hundredth of the largest magnitude, fewer than one in 200 a quarter of it.
pub(super) fn has_weak_waves(values: &[f64]) -> bool {
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let share = |level: f64| {
        let above = values.iter().filter(|value| value.abs() > level * largest).count();
        above as f64 / values.len().max(1) as f64
    };
    largest.is_finite() && share(0.01) > 0.05 && share(0.25) < 0.005
}

/// Returns the name of a source, with the direction of a force along an axis.
fn describe_source(kind: &SourceKind) -> String {
    if let SourceKind::Force(components) = kind {
        let mut acting = components.iter().enumerate().filter(|(_, force)| **force != 0.0);
        if let (Some((axis, force)), None) = (acting.next(), acting.next()) {
            let sign = if *force < 0.0 { "−" } else { "" };
            return format!("force along {sign}x{}", AXIS_INDICES[axis]);
        }
    }
    kind.name().to_owned()
}

/// Returns the value of a cell; 0 if it is absent.
fn cell_value(values: &[f64], cell: usize) -> f64 {
    values.get(cell).copied().unwrap_or(0.0)
}

/// Plane section of the grid of a solid that is drawn in a picture.
pub(super) struct PlaneSection<'a> {
    solid_run: &'a SolidRun,
    /// Axes, from 0, that span the plane of the section.
    axes: [usize; 2],
    /// Index of the section's layer of cells along x₂; `None` in two dimensions.
    layer: Option<usize>,
    /// Raster of a polar grid, whose picture is in Cartesian coordinates; `None` for a rectangular one.
    polar: Option<PolarRaster>,
}

impl<'a> PlaneSection<'a> {
    pub(super) fn new(solid_run: &'a SolidRun) -> Self {
        let grid = &solid_run.grid;
        let layer = (grid.dimensions() == 3).then(|| {
            let [first, last] = grid.axis_bounds(1);
            let at =
                solid_run.sources.first().map_or(0.5 * (first + last), |source| source.position[1]);
            let index = ((at - grid.origin[1]) / grid.spacing[1]).floor().max(0.0) as usize;
            index.min(grid.cells[1] - 1)
        });
        let axes = if layer.is_none() { [0, 1] } else { [0, 2] };
        Self { solid_run, axes, layer, polar: PolarRaster::new(grid) }
    }

    /// Converts values of the cells of the section to those of the cells of the picture; `outside` beyond the body.
    fn to_raster<V: Copy>(&self, values: Vec<V>, outside: V) -> Vec<V> {
        match &self.polar {
            Some(polar) => polar.nearest(&values, outside),
            None => values,
        }
    }

    /// Iterates over the indices of the cells in the section, x₁ fastest.
    fn cell_indices(&self) -> impl Iterator<Item = usize> {
        let cells = &self.solid_run.grid.cells;
        let [columns, rows] = self.axes.map(|axis| cells[axis]);
        let (layer, depth) = (self.layer, cells[1]);
        (0..rows).flat_map(move |j| {
            (0..columns).map(move |i| match layer {
                None => j * columns + i,
                Some(layer) => (j * depth + layer) * columns + i,
            })
        })
    }

    /// Returns the outlines of the shapes of the initial state. Blocks have joints instead, which shapes of whole blocks
    /// would cover.
    fn create_outlines(&self) -> Vec<FieldOutline> {
        let SolidRun { grid, blocks, initial_terms, .. } = self.solid_run;
        let shapes = initial_terms.iter().filter_map(|term| Some((term.name(), term.shape()?)));
        let outline = |(name, shape): (&str, &RegionShape)| {
            let is_inside = |cell: usize| {
                let mut rest = cell;
                let coordinate = |axis: usize| {
                    let index = rest % grid.cells[axis];
                    rest /= grid.cells[axis];
                    grid.cell_centre(axis, index)
                };
                let centre: Vec<f64> = (0..grid.dimensions()).map(coordinate).collect();
                shape.contains(&centre)
            };
            FieldOutline {
                label: format!("edge of the initial {}", name.replace('-', " ")),
                is_inside: self.to_raster(self.cell_indices().map(is_inside).collect(), false),
            }
        };
        let is_part = |own: &FieldOutline| own.is_inside.contains(&false);
        match blocks {
            Some(_) => Vec::new(),
            None => shapes.map(outline).filter(is_part).collect(),
        }
    }

    /// Reads the regions of the cells of the picture from a snapshot; empty if it has no regions.
    pub(super) fn read_snapshot_regions(&self, bytes: &[u8]) -> Vec<u16> {
        let cells = self.solid_run.grid.cell_count();
        let all = files::vti::read_integers(bytes, "region");
        let Some(all) = all.filter(|all| all.len() >= cells) else { return Vec::new() };
        let region = |cell: usize| u16::try_from(all[cell]).unwrap_or(u16::MAX);
        self.to_raster(self.cell_indices().map(region).collect(), u16::MAX)
    }

    /// Returns the position of a point load; `None` for a distributed one.
    fn point_load_position(&self, load: &FaceLoad) -> Option<Vec<f64>> {
        let grid = &self.solid_run.grid;
        let LoadedArea::Point { position, .. } = &load.loaded_area else { return None };
        let [first, last] = grid.axis_bounds(load.face.axis);
        let mut place = vec![if load.face.is_upper { last } else { first }; grid.dimensions()];
        for (axis, middle) in load.face.tangential_axes(grid.dimensions()).into_iter().zip(position)
        {
            place[axis] = *middle;
        }
        Some(place)
    }

    /// Returns the points of the line in which a distributed load meets the section; `None` for a point load, and where
    /// they do not meet.
    fn loaded_line(&self, load: &FaceLoad) -> Option<Vec<[f64; 2]>> {
        let grid = &self.solid_run.grid;
        let tangential = load.face.tangential_axes(grid.dimensions());
        let range = |axis: usize| -> Option<[f64; 2]> {
            let bounds = grid.axis_bounds(axis);
            let LoadedArea::Rectangle(part) = &load.loaded_area else { return Some(bounds) };
            let index = tangential.iter().position(|own| *own == axis)?;
            Some([part.lower_corner[index].max(bounds[0]), part.upper_corner[index].min(bounds[1])])
        };
        if matches!(load.loaded_area, LoadedArea::Point { .. }) {
            return None;
        }
        if let Some(layer) = self.layer {
            let [low, high] = range(1)?;
            let is_met = (low..=high).contains(&grid.cell_centre(1, layer));
            if load.face.axis == 1 || !is_met {
                return None;
            }
        }
        let along = self.axes.into_iter().position(|axis| axis != load.face.axis)?;
        let [low, high] = range(self.axes[along])?;
        let [first, last] = grid.axis_bounds(load.face.axis);
        let on_face = if load.face.is_upper { last } else { first };
        // A polar grid has angles along its first axis: an arc has a point every two degrees.
        let is_arc = grid.is_polar() && along == 0;
        let count = if is_arc { ((high - low) / 2.0).ceil().max(1.0) as usize } else { 1 };
        let point = |index: usize| {
            let mut place = [on_face; 2];
            place[along] = low + (high - low) * index as f64 / count as f64;
            if grid.is_polar() { SolidGrid::to_cartesian(place) } else { place }
        };
        (low < high).then(|| (0..=count).map(point).collect())
    }

    /// Reads the values of `picture`, the plotted quantity, on the section from a snapshot; an error message if they
    /// are absent.
    pub(super) fn read_snapshot_values(
        &self,
        bytes: &[u8],
        picture: PlottedQuantity,
    ) -> Result<Vec<f64>, String> {
        let name = match picture {
            PlottedQuantity::Face(_) => return Ok(self.cell_indices().map(|_| 0.0).collect()),
            PlottedQuantity::Speed
            | PlottedQuantity::Component(StateComponent(SolidField::Velocity(_))) => {
                "velocity [m/s]".to_owned()
            }
            _ => format!("{} [{}]", picture.name(), quantity_unit(&picture.name())),
        };
        let all = read_array(bytes, &name, self.solid_run.grid.cell_count())?;
        let of = |cell: usize| match picture {
            PlottedQuantity::Speed => all[3 * cell..3 * cell + 3]
                .iter()
                .fold(0.0, |s, v| Elementary::root_sum_square(s, *v)),
            PlottedQuantity::Component(StateComponent(SolidField::Velocity(i))) => {
                match self.solid_run.grid.is_polar() {
                    true => {
                        let cartesian = [all[3 * cell], all[3 * cell + 1]];
                        reflect_components(&self.solid_run.grid, cell, cartesian)[i]
                    }
                    false => all[3 * cell + i],
                }
            }
            _ => all[cell],
        };
        Ok(self.cell_indices().map(of).collect())
    }

    pub(super) fn create_figure(
        &self,
        case: &Case,
        picture: PlottedQuantity,
        time: f64,
        values: Vec<f64>,
    ) -> FieldFigure {
        let solid_run = self.solid_run;
        let grid = &solid_run.grid;
        let mut subtitle = format!("t = {} s", format_short(time));
        if let Some(layer) = self.layer {
            let _ =
                write!(subtitle, ", section x₂ = {} m", format_short(grid.cell_centre(1, layer)));
        }
        let axis = |axis: usize| {
            let [from, to] = grid.axis_bounds(axis);
            FieldAxis { label: format!("x{} (m)", AXIS_INDICES[axis]), start: from, end: to }
        };
        let mark = |at: &[f64], name: &str, kind: FieldMarkKind| {
            let is_near = self.layer.is_none_or(|layer| {
                (at[1] - grid.cell_centre(1, layer)).abs() <= 0.5 * grid.spacing[1]
            });
            let at = self.axes.map(|axis| at[axis]);
            let at = if grid.is_polar() { SolidGrid::to_cartesian(at) } else { at };
            is_near.then(|| FieldMark { position: at, name: name.to_owned(), kind })
        };
        let named: Vec<usize> = select_evenly_spaced_indices(solid_run.receivers.len()).collect();
        let name = |index: usize| match named.contains(&index) {
            true => solid_run.receivers[index].name.as_str(),
            false => "",
        };
        let receivers = solid_run.receivers.iter().enumerate();
        let sources = solid_run.sources.iter();
        let label = match picture {
            PlottedQuantity::Speed => "speed |v| (m/s)".to_owned(),
            _ => axis_label(&picture.name()),
        };
        let figure = match &self.polar {
            Some(polar) => FieldFigure {
                x: polar.x.clone(),
                y: polar.y.clone(),
                columns: polar.columns,
                rows: polar.rows,
                values: polar.interpolate(&values),
                body: Some(polar.body()),
                label: polar_label(&label),
                ..FieldFigure::default()
            },
            None => FieldFigure {
                x: axis(self.axes[0]),
                y: axis(self.axes[1]),
                columns: grid.cells[self.axes[0]],
                rows: grid.cells[self.axes[1]],
                values,
                label,
                ..FieldFigure::default()
            },
        };
        let loads = solid_run.loads.iter();
        let point_loads = loads
            .clone()
            .filter_map(|load| mark(&self.point_load_position(load)?, "", FieldMarkKind::Source));
        FieldFigure {
            title: case_title(case),
            subtitle,
            is_signed: !matches!(
                picture,
                PlottedQuantity::Speed
                    | PlottedQuantity::Porosity
                    | PlottedQuantity::Dissipation
                    | PlottedQuantity::Face(FaceQuantity::Slip | FaceQuantity::Opening)
            ),
            limit: None,
            fixed_limit: None,
            // The contour levels of the case are values of its plotted quantity, hence apply to no other quantity.
            contour_levels: match picture {
                PlottedQuantity::Face(_) => Some(Vec::new()),
                _ => solid_run
                    .output
                    .contour_levels
                    .clone()
                    .filter(|_| picture == solid_run.output.plotted_quantity),
            },
            material_indices: Vec::new(),
            has_yielded: Vec::new(),
            outlines: self.create_outlines(),
            line_sets: Vec::new(),
            arrows: None,
            marks: receivers
                .filter_map(|(index, own)| {
                    mark(&own.position, name(index), FieldMarkKind::Receiver)
                })
                .chain(sources.filter_map(|own| {
                    mark(&own.position, &describe_source(&own.kind), FieldMarkKind::Source)
                }))
                .chain(point_loads)
                .collect(),
            loaded_lines: loads.filter_map(|load| self.loaded_line(load)).collect(),
            ..figure
        }
    }
}
