//! Pictures of the simulation of a solid.

use super::display::axis_label;
use super::fluid::FluidState;
use super::joints::{JointScale, create_line_sets};
use super::records::{create_ledger_picture, create_seismograms, evenly_spaced_indices};
use super::snapshot::read_array;
use crate::case::Case;
use crate::case::dynamics::{PlottedQuantity as Shown, SolidRun, StateComponent};
use crate::report::ReportPicture;
use crate::report::format::{case_title, format_short};
use crate::study::simulate::{OutputFields, RunRecords, quantity_unit};
use figures::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
use models::common::elementary::Elementary;
use models::solid::waves::SolidField;
use std::fmt::Write as _;

/// Creates all pictures of a run except the animation.
pub(super) fn create_pictures(
    case: &Case,
    dynamics: &SolidRun,
    fields: &OutputFields,
    records: &RunRecords,
) -> Vec<ReportPicture> {
    let final_state = |stem, shown| {
        let figure = create_figure(case, dynamics, fields, shown);
        ReportPicture::new(stem, move |format| figure.draw(format))
    };
    let mut pictures = vec![final_state("run", dynamics.output.plotted_quantity)];
    pictures.extend(records.receivers.as_ref().map(|table| create_seismograms(case, table)));
    let describe_term = |name: &str| match name {
        "kinetic" => "kinetic energy",
        "stored" => "stored energy",
        // Finished runs of earlier versions have the second names.
        "boundary_work" | "sides" => "work of the boundaries",
        "source_work" | "sources" => "work of sources and gravity",
        "initial_stress_work" | "initial_stress" => "work of the initial stress",
        "plastic_dissipation" | "plastic" => "plastic dissipation",
        "joint_kinetic" => "kinetic energy of joints",
        "joint_stored" => "stored energy of joints",
        "fluid_kinetic" => "kinetic energy of the fluid",
        "fluid_stored" => "energy of the fluid pressure",
        "joint_plastic_dissipation" => "plastic dissipation of joints",
        "joint_viscous_dissipation" => "viscous dissipation of joints",
        "joint_released_energy" => "energy released by open cracks",
        "joint_fracture_energy" => "energy lost at fracture",
        "fluid_dissipation" => "numerical dissipation of the fluid",
        "numerical_dissipation" | "numerical" => "numerical dissipation",
        "residual" => "residual",
        _ => "balance: numerical dissipation",
    };
    pictures.extend(create_ledger_picture(case, &records.ledger, describe_term));
    if !fields.dissipation.is_empty() && dynamics.output.plotted_quantity != Shown::Dissipation {
        pictures.push(final_state("dissipation", Shown::Dissipation));
    }
    if let Some(figure) = create_fluid_figure(case, dynamics, fields) {
        pictures.push(ReportPicture::new("fluid", move |format| figure.draw(format)));
    }
    pictures
}

/// Creates the figure of the circulation of the fluid in saturated joints; `None` without such joints.
fn create_fluid_figure(
    case: &Case,
    dynamics: &SolidRun,
    fields: &OutputFields,
) -> Option<FieldFigure> {
    let blocks = dynamics.blocks.as_ref()?;
    let FluidState { pressures, arrows } = FluidState::new(blocks, &dynamics.grid, &fields.joints)?;
    let figure =
        PlaneSection::new(dynamics).create_figure(case, Shown::Speed, fields.time, pressures);
    Some(FieldFigure {
        label: "pressure of fluid p, Pa".to_owned(),
        is_signed: true,
        contour_levels: None,
        arrows: Some(arrows),
        line_sets: create_line_sets(blocks, &[], JointScale::default()),
        ..figure
    })
}

/// Creates the figure of the quantity `shown` in the final state; in three dimensions, of the section normal to x₂
/// through the first source or, without sources, through the middle of the grid.
fn create_figure(
    case: &Case,
    dynamics: &SolidRun,
    fields: &OutputFields,
    shown: Shown,
) -> FieldFigure {
    let section = PlaneSection::new(dynamics);
    let values: Vec<f64> = match shown {
        Shown::Speed => {
            let of_axis = |i| fields.get(&format!("v{i}"));
            let axes: Vec<&[f64]> = (1..=dynamics.grid.dimensions()).filter_map(of_axis).collect();
            let of_cell = |cell: usize| {
                let along = axes.iter().map(|values| cell_value(values, cell));
                along.fold(0.0, Elementary::root_sum_square)
            };
            section.cell_indices().map(of_cell).collect()
        }
        Shown::Dissipation => {
            section.cell_indices().map(|cell| cell_value(&fields.dissipation, cell)).collect()
        }
        other => {
            let values = fields.get(&other.name()).unwrap_or_default();
            section.cell_indices().map(|cell| cell_value(values, cell)).collect()
        }
    };
    let mut figure = section.create_figure(case, shown, fields.time, values);
    if fields.regions.iter().any(|region| *region != fields.regions[0]) {
        let region = |cell: usize| fields.regions.get(cell).copied().unwrap_or(0);
        figure.material_indices = section.cell_indices().map(region).collect();
    }
    if !fields.dissipation.is_empty() && shown != Shown::Dissipation {
        figure.has_yielded = section
            .cell_indices()
            .map(|cell| cell_value(&fields.dissipation, cell) > 0.0)
            .collect();
    }
    if let Some(blocks) = &dynamics.blocks {
        figure.line_sets =
            create_line_sets(blocks, &fields.joints, JointScale::new(&fields.joints));
    }
    figure
}

/// Returns the value of a cell; 0 if it is absent.
fn cell_value(values: &[f64], cell: usize) -> f64 {
    values.get(cell).copied().unwrap_or(0.0)
}

/// Plane section of the grid of a solid, to be drawn.
pub(super) struct PlaneSection<'a> {
    dynamics: &'a SolidRun,
    /// Axes that span the plane.
    axes: [usize; 2],
    /// Index of the section's layer of cells along x₂; `None` in two dimensions.
    layer: Option<usize>,
}

impl<'a> PlaneSection<'a> {
    pub(super) fn new(dynamics: &'a SolidRun) -> Self {
        let grid = &dynamics.grid;
        let layer = (grid.dimensions() == 3).then(|| {
            let [first, last] = grid.axis_bounds(1);
            let at =
                dynamics.sources.first().map_or(0.5 * (first + last), |source| source.position[1]);
            let index = ((at - grid.origin[1]) / grid.spacing[1]).floor().max(0.0) as usize;
            index.min(grid.cells[1] - 1)
        });
        Self { dynamics, axes: if layer.is_none() { [0, 1] } else { [0, 2] }, layer }
    }

    /// Iterates over the indices of the cells in the section, x₁ fastest.
    fn cell_indices(&self) -> impl Iterator<Item = usize> {
        let cells = &self.dynamics.grid.cells;
        let [columns, rows] = self.axes.map(|axis| cells[axis]);
        let (layer, depth) = (self.layer, cells[1]);
        (0..rows).flat_map(move |j| {
            (0..columns).map(move |i| match layer {
                None => j * columns + i,
                Some(layer) => (j * depth + layer) * columns + i,
            })
        })
    }

    /// Reads the values of `picture`, the plotted quantity, on the section from a snapshot; an error message if they
    /// are absent.
    pub(super) fn read_snapshot_values(
        &self,
        bytes: &[u8],
        picture: Shown,
    ) -> Result<Vec<f64>, String> {
        let name = match picture {
            Shown::Speed | Shown::Component(StateComponent(SolidField::Velocity(_))) => {
                "velocity [m/s]".to_owned()
            }
            _ => format!("{} [{}]", picture.name(), quantity_unit(&picture.name())),
        };
        let all = read_array(bytes, &name, self.dynamics.grid.cell_count())?;
        let of = |cell: usize| match picture {
            Shown::Speed => all[3 * cell..3 * cell + 3]
                .iter()
                .fold(0.0, |s, v| Elementary::root_sum_square(s, *v)),
            Shown::Component(StateComponent(SolidField::Velocity(i))) => all[3 * cell + i],
            _ => all[cell],
        };
        Ok(self.cell_indices().map(of).collect())
    }

    pub(super) fn create_figure(
        &self,
        case: &Case,
        picture: Shown,
        time: f64,
        values: Vec<f64>,
    ) -> FieldFigure {
        let dynamics = self.dynamics;
        let grid = &dynamics.grid;
        let mut subtitle = format!("t = {} s", format_short(time));
        if let Some(layer) = self.layer {
            let _ =
                write!(subtitle, ", section x₂ = {} m", format_short(grid.cell_centre(1, layer)));
        }
        let axis = |axis: usize| {
            let [from, to] = grid.axis_bounds(axis);
            FieldAxis {
                label: format!("x{}, m", ["₁", "₂", "₃"][axis]), start: from, end: to
            }
        };
        let mark = |at: &[f64], name: &str, kind: FieldMarkKind| {
            let is_near = self.layer.is_none_or(|layer| {
                (at[1] - grid.cell_centre(1, layer)).abs() <= 0.5 * grid.spacing[1]
            });
            let at = self.axes.map(|axis| at[axis]);
            is_near.then(|| FieldMark { position: at, name: name.to_owned(), kind })
        };
        let named: Vec<usize> = evenly_spaced_indices(dynamics.receivers.len()).collect();
        let name = |index: usize| match named.contains(&index) {
            true => dynamics.receivers[index].name.as_str(),
            false => "",
        };
        let receivers = dynamics.receivers.iter().enumerate();
        let sources = dynamics.sources.iter();
        FieldFigure {
            title: case_title(case),
            subtitle,
            x: axis(self.axes[0]),
            y: axis(self.axes[1]),
            columns: grid.cells[self.axes[0]],
            rows: grid.cells[self.axes[1]],
            values,
            label: match picture {
                Shown::Speed => "speed |v|, m/s".to_owned(),
                _ => axis_label(&picture.name()),
            },
            is_signed: !matches!(picture, Shown::Speed | Shown::Dissipation),
            limit: None,
            fixed_limit: None,
            // The contour levels of the case are values of its plotted quantity, hence apply to no other quantity.
            contour_levels: dynamics
                .output
                .contour_levels
                .clone()
                .filter(|_| picture == dynamics.output.plotted_quantity),
            material_indices: Vec::new(),
            has_yielded: Vec::new(),
            line_sets: Vec::new(),
            arrows: None,
            marks: receivers
                .filter_map(|(index, own)| {
                    mark(&own.position, name(index), FieldMarkKind::Receiver)
                })
                .chain(
                    sources.filter_map(|own| {
                        mark(&own.position, own.kind.name(), FieldMarkKind::Source)
                    }),
                )
                .collect(),
        }
    }
}
