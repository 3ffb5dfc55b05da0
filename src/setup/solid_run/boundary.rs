//! Boundary conditions and loads of a solid simulation, converted to the faces of the grid.

use super::GridConverter;
use super::geometry::{distance, find_whole_boundary_condition};
use crate::Error;
use crate::case::dynamics::{
    BoundaryConditionKind, BoundaryFace, FaceCondition, FaceLoad, LoadedArea, StateComponent,
};
use dynamics::boundary::{Boundary, Condition, Load};
use std::sync::Arc;

impl GridConverter<'_> {
    /// Returns the tangential coordinates, m, of the face centres of a boundary, with the first tangential axis
    /// fastest.
    fn face_centres(&self, boundary: BoundaryFace) -> impl Iterator<Item = Vec<f64>> {
        let grid = &self.solid_run.grid;
        let axes = boundary.tangential_axes(grid.dimensions());
        let count = axes.iter().map(|axis| grid.cells[*axis]).product();
        (0..count).map(move |face: usize| {
            let mut rest = face;
            axes.iter()
                .map(|&axis| {
                    let index = rest % grid.cells[axis];
                    rest /= grid.cells[axis];
                    grid.cell_centre(axis, index)
                })
                .collect()
        })
    }

    pub(super) fn create_boundary(&self, boundary: BoundaryFace) -> Result<Boundary, Error> {
        let pairs = &self.first_medium.pairs[boundary.axis];
        let last = find_whole_boundary_condition(self.solid_run, boundary);
        if last.is_some_and(|entry| entry.condition == BoundaryConditionKind::Periodic) {
            return Ok(Boundary::Periodic);
        }
        // Lists by face, which every process has, only where conditions differ between faces.
        let mut by_pair = vec![Condition::Traction(0.0); pairs.len()];
        let mut by_face: Option<Vec<Vec<Condition>>> = None;
        let face_count =
            self.solid_run.grid.cell_count() / self.solid_run.grid.cells[boundary.axis];
        let spread = |by_pair: &[Condition]| {
            by_pair.iter().map(|condition| vec![*condition; face_count]).collect()
        };
        let own = |entry: &(usize, &FaceCondition)| entry.1.face == boundary;
        for (index, entry) in self.solid_run.boundary_conditions.iter().enumerate().filter(own) {
            let of_pair: Vec<Condition> = match &entry.condition {
                // This periodic condition is overridden by a later entry; otherwise the function has returned above.
                BoundaryConditionKind::Periodic => continue,
                BoundaryConditionKind::Free => vec![Condition::Traction(0.0); pairs.len()],
                BoundaryConditionKind::Fixed => vec![Condition::Velocity(0.0); pairs.len()],
                BoundaryConditionKind::NonReflecting => vec![Condition::NonReflecting; pairs.len()],
                BoundaryConditionKind::Symmetry | BoundaryConditionKind::Antisymmetry => {
                    let mirror = match entry.condition {
                        BoundaryConditionKind::Symmetry => {
                            Boundary::new_symmetry(&self.first_medium, boundary.axis)
                        }
                        _ => Boundary::new_antisymmetry(&self.first_medium, boundary.axis),
                    };
                    match mirror {
                        Boundary::ByPair(conditions) => conditions,
                        _ => Vec::new(),
                    }
                }
                BoundaryConditionKind::Mixed { fixed_components } => pairs
                    .iter()
                    .map(|pair| match fixed_components.contains(&StateComponent(pair.velocity)) {
                        true => Condition::Velocity(0.0),
                        false => Condition::Traction(0.0),
                    })
                    .collect(),
            };
            let Some(rectangle) = &entry.rectangle else {
                (by_pair, by_face) = (of_pair, None);
                continue;
            };
            let by_face = by_face.get_or_insert_with(|| spread(&by_pair));
            let mut is_empty = true;
            for (face, middle) in self.face_centres(boundary).enumerate() {
                if rectangle.contains(&middle) {
                    is_empty = false;
                    for (own, condition) in by_face.iter_mut().zip(&of_pair) {
                        own[face] = *condition;
                    }
                }
            }
            self.check_not_empty(is_empty, &format!("boundary[{index}]"))?;
        }
        // A load sets the type of condition on its faces; two loads must not set different types.
        let mut loaded: Vec<Option<Vec<Option<Condition>>>> = vec![None; pairs.len()];
        let own = |entry: &(usize, &FaceLoad)| entry.1.face == boundary;
        for (index, load) in self.solid_run.loads.iter().enumerate().filter(own) {
            let (pair, condition) = self.find_driven_pair(index, load)?;
            let faces = self.compute_loaded_faces(index, load)?;
            let said = loaded[pair].get_or_insert_with(|| vec![None; face_count]);
            for (face, _) in &faces {
                if said[*face].replace(condition).is_some_and(|own| own != condition) {
                    let found = format!("{} on faces with another load", load.component);
                    let allowed = "either the velocity or the stress of a wave on a face";
                    let key = format!("load[{index}].field");
                    return Err(self.solid_run.key_error(&key, found, allowed).into());
                }
            }
            if matches!(load.loaded_area, LoadedArea::WholeFace) && by_face.is_none() {
                by_pair[pair] = condition;
            } else if by_face.is_some() || by_pair[pair] != condition {
                let by_face = by_face.get_or_insert_with(|| spread(&by_pair));
                faces.iter().for_each(|(face, _)| by_face[pair][*face] = condition);
            }
        }
        Ok(by_face.map_or(Boundary::ByPair(by_pair), Boundary::ByFace))
    }

    fn check_not_empty(&self, is_empty: bool, key: &str) -> Result<(), Error> {
        match is_empty {
            true => {
                let found = "no face of the side has its middle in it";
                let allowed = "make it larger than a cell, or move it onto the side";
                Err(self.solid_run.key_error(key, found, allowed).into())
            }
            false => Ok(()),
        }
    }

    /// Returns the index of the velocity–stress pair that a load drives, and the type of condition that the load sets.
    fn find_driven_pair(&self, index: usize, load: &FaceLoad) -> Result<(usize, Condition), Error> {
        let pairs = self.first_medium.pairs[load.face.axis].iter().enumerate();
        for (pair_index, pair) in pairs {
            if pair.velocity == load.component.0 {
                return Ok((pair_index, Condition::Velocity(0.0)));
            }
            if pair.stress == load.component.0 {
                return Ok((pair_index, Condition::Traction(0.0)));
            }
        }
        let found = format!("{} does not act on {}", load.component, load.face.name());
        let allowed =
            "expected a velocity or spin of the side, or a stress whose second index is its axis";
        Err(self.solid_run.key_error(&format!("load[{index}].field"), found, allowed).into())
    }

    /// Returns the indices of the faces of a load, and the amplitude on each.
    fn compute_loaded_faces(
        &self,
        index: usize,
        load: &FaceLoad,
    ) -> Result<Vec<(usize, f64)>, Error> {
        let faces = self.face_centres(load.face).enumerate();
        let axes = load.face.tangential_axes(self.solid_run.grid.dimensions());
        let to = |a: &[f64], b: &[f64]| distance(self.solid_run, &axes, a, b);
        let amplitude = |middle: &[f64]| match &load.profile {
            Some(profile) => load.amplitude * profile.evaluate(&axes, middle, to),
            None => load.amplitude,
        };
        let found: Vec<(usize, f64)> = match &load.loaded_area {
            LoadedArea::WholeFace => {
                faces.map(|(face, middle)| (face, amplitude(&middle))).collect()
            }
            LoadedArea::Rectangle(part) => faces
                .filter(|(_, middle)| part.contains(middle))
                .map(|(face, middle)| (face, amplitude(&middle)))
                .collect(),
            LoadedArea::Point { position: at, kernel } => {
                let area: f64 =
                    axes.iter().map(|&axis| self.solid_run.grid.spacing[axis]).product();
                let mut point = at.clone();
                let end = self.solid_run.grid.axis_bounds(load.face.axis);
                point.insert(load.face.axis, end[usize::from(load.face.is_upper)]);
                let key = format!("load[{index}]");
                let shares = self
                    .compute_checked_shares(&axes, &point, *kernel, load.component.0, &key)?
                    .into_iter();
                shares.map(|(face, share)| (face, load.amplitude * share / area)).collect()
            }
        };
        self.check_not_empty(found.is_empty(), &format!("load[{index}]"))?;
        if load.amplitude != 0.0 && load.profile.is_some() && found.iter().all(|own| own.1 == 0.0) {
            let key = format!("load[{index}].profile");
            let found = "0 in the middle of every face that the load is on";
            let allowed =
                "one that is not 0 there: move it onto the side, or make it wider than a cell";
            return Err(self.solid_run.key_error(&key, found, allowed).into());
        }
        Ok(found)
    }

    pub(super) fn create_load(&self, index: usize, load: &FaceLoad) -> Result<Load, Error> {
        let (pair, _) = self.find_driven_pair(index, load)?;
        let time = load.time_function.clone();
        let mut faces = self.compute_loaded_faces(index, load)?;
        let grid = &self.solid_run.grid;
        if grid.is_polar() {
            // The fields of the solver are √r times the physical ones.
            for (face, amplitude) in &mut faces {
                let radius = match load.face.axis {
                    1 => grid.axis_bounds(1)[usize::from(load.face.is_upper)],
                    _ => grid.cell_centre(1, *face),
                };
                *amplitude *= radius.sqrt();
            }
        }
        Ok(Load {
            axis: load.face.axis,
            end: usize::from(load.face.is_upper),
            pair,
            faces,
            signal: Arc::new(move |t| time.evaluate(t)),
        })
    }
}
