//! Boundary conditions and loads.

use super::Place;
use super::geometry::{distance, whole_side};
use crate::Error;
use crate::case::dynamics::{
    Action, Component, Condition as SideKind, Load as SideLoad, Side, SideCondition,
};
use dynamics::boundary::{Boundary, Condition, Load};
use std::sync::Arc;

impl Place<'_> {
    /// Returns the face centres of a side along its axes, m, the first axis fastest.
    fn faces(&self, side: Side) -> Vec<Vec<f64>> {
        let grid = &self.dynamics.grid;
        let mut faces = vec![Vec::new()];
        for axis in side.axes(grid.dimensions()).into_iter().rev() {
            faces = faces
                .iter()
                .flat_map(|face| (0..grid.cells[axis]).map(move |index| (face, index)))
                .map(|(face, index)| {
                    let mut face = face.clone();
                    face.insert(0, grid.centre(axis, index));
                    face
                })
                .collect();
        }
        faces
    }

    pub(super) fn boundary(&self, side: Side) -> Result<Boundary, Error> {
        let pairs = &self.medium.pairs[side.axis];
        let last = whole_side(self.dynamics, side);
        if last.is_some_and(|entry| entry.condition == SideKind::Periodic) {
            return Ok(Boundary::Periodic);
        }
        let faces = self.faces(side);
        let mut by_face = vec![vec![Condition::Traction(0.0); faces.len()]; pairs.len()];
        let own = |entry: &(usize, &SideCondition)| entry.1.side == side;
        for (index, entry) in self.dynamics.sides.iter().enumerate().filter(own) {
            let of_pair: Vec<Condition> = match &entry.condition {
                // A later entry overrides a periodic condition.
                SideKind::Periodic => continue,
                SideKind::Free => vec![Condition::Traction(0.0); pairs.len()],
                SideKind::Fixed => vec![Condition::Velocity(0.0); pairs.len()],
                SideKind::NonReflecting => vec![Condition::NonReflecting; pairs.len()],
                SideKind::Symmetry | SideKind::Antisymmetry => {
                    let mirror = match entry.condition {
                        SideKind::Symmetry => Boundary::symmetry(&self.medium, side.axis),
                        _ => Boundary::antisymmetry(&self.medium, side.axis),
                    };
                    match mirror {
                        Boundary::Given(conditions) => conditions,
                        _ => Vec::new(),
                    }
                }
                SideKind::Mixed { held } => pairs
                    .iter()
                    .map(|pair| match held.contains(&Component(pair.velocity)) {
                        true => Condition::Velocity(0.0),
                        false => Condition::Traction(0.0),
                    })
                    .collect(),
            };
            let mut is_empty = true;
            for (face, middle) in faces.iter().enumerate() {
                if entry.part.as_ref().is_none_or(|part| part.contains(middle)) {
                    is_empty = false;
                    for (own, condition) in by_face.iter_mut().zip(&of_pair) {
                        own[face] = *condition;
                    }
                }
            }
            self.refuse_empty(is_empty, &format!("side[{index}]"))?;
        }
        // A load sets the type of condition on its faces; two loads must not set different types.
        let mut said = vec![vec![None; faces.len()]; pairs.len()];
        for (index, load) in self.dynamics.loads.iter().enumerate() {
            if load.side == side {
                let (pair, condition) = self.pair_of(index, load)?;
                for (face, _) in self.loaded(index, load)? {
                    if said[pair][face].replace(condition).is_some_and(|own| own != condition) {
                        let found = format!("{} on faces with another load", load.field);
                        let allowed = "either the velocity or the stress of a wave on a face";
                        let key = format!("load[{index}].field");
                        return Err(self.dynamics.locate(&key, found, allowed).into());
                    }
                    by_face[pair][face] = condition;
                }
            }
        }
        Ok(Boundary::ByFace(by_face))
    }

    fn refuse_empty(&self, is_empty: bool, key: &str) -> Result<(), Error> {
        match is_empty {
            true => {
                let found = "no face of the side has its middle in it";
                let allowed = "make it larger than a cell, or move it onto the side";
                Err(self.dynamics.locate(key, found, allowed).into())
            }
            false => Ok(()),
        }
    }

    /// Returns the index of the velocity-stress pair that a load drives and the type of its condition.
    fn pair_of(&self, index: usize, load: &SideLoad) -> Result<(usize, Condition), Error> {
        let pairs = self.medium.pairs[load.side.axis].iter().enumerate();
        for (place, pair) in pairs {
            if pair.velocity == load.field.0 {
                return Ok((place, Condition::Velocity(0.0)));
            }
            if pair.stress == load.field.0 {
                return Ok((place, Condition::Traction(0.0)));
            }
        }
        let found = format!("{} does not act on {}", load.field, load.side.name());
        let allowed = "a velocity or spin of the side, or a stress whose second index is its axis";
        Err(self.dynamics.locate(&format!("load[{index}].field"), found, allowed).into())
    }

    /// Returns the faces of a load and their amplitudes.
    fn loaded(&self, index: usize, load: &SideLoad) -> Result<Vec<(usize, f64)>, Error> {
        let faces = self.faces(load.side).into_iter().enumerate();
        let axes = load.side.axes(self.dynamics.grid.dimensions());
        let to = |a: &[f64], b: &[f64]| distance(self.dynamics, &axes, a, b);
        let amplitude = |middle: &[f64]| match &load.profile {
            Some(profile) => load.amplitude * profile.value(&axes, middle, to),
            None => load.amplitude,
        };
        let found: Vec<(usize, f64)> = match &load.action {
            Action::Whole => faces.map(|(face, middle)| (face, amplitude(&middle))).collect(),
            Action::Part(part) => faces
                .filter(|(_, middle)| part.contains(middle))
                .map(|(face, middle)| (face, amplitude(&middle)))
                .collect(),
            Action::Point { at, kernel } => {
                let area: f64 = axes.iter().map(|&axis| self.dynamics.grid.spacing[axis]).product();
                let mut point = at.clone();
                let end = self.dynamics.grid.extent(load.side.axis);
                point.insert(load.side.axis, end[usize::from(load.side.is_upper)]);
                let key = format!("load[{index}]");
                let shares = self.shares(&axes, &point, *kernel, load.field.0, &key)?.into_iter();
                shares.map(|(face, share)| (face, load.amplitude * share / area)).collect()
            }
        };
        self.refuse_empty(found.is_empty(), &format!("load[{index}]"))?;
        if load.amplitude != 0.0 && load.profile.is_some() && found.iter().all(|own| own.1 == 0.0) {
            let key = format!("load[{index}].profile");
            let found = "0 in the middle of every face that the load is on";
            let allowed =
                "one that is not 0 there: move it onto the side, or make it wider than a cell";
            return Err(self.dynamics.locate(&key, found, allowed).into());
        }
        Ok(found)
    }

    pub(super) fn load(&self, index: usize, load: &SideLoad) -> Result<Load, Error> {
        let (pair, _) = self.pair_of(index, load)?;
        let time = load.time.clone();
        Ok(Load {
            axis: load.side.axis,
            end: usize::from(load.side.is_upper),
            pair,
            faces: self.loaded(index, load)?,
            signal: Arc::new(move |t| time.value(t)),
        })
    }
}
