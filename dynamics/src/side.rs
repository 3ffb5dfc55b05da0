//! Sides as sweeps see them: mirrors with a sign and a shift.

use crate::boundary::{Boundary, Condition, Load, Signal};
use crate::line::State;
use crate::real::Real;
use std::ops::Range;

/// What lies beyond a side, ready for the sweeps.
#[derive(Clone)]
pub(crate) enum Side<T: Real> {
    /// The opposite side.
    Periodic,
    /// Another part of the same domain.
    Cut,
    /// A mirror: ghosts are (±v + a, ±s + b), or nothing.
    Mirror(Mirror<T>),
}

/// Signs and shifts by pair and face.
#[derive(Clone)]
pub(crate) struct Mirror<T: Real> {
    /// Sign of v, shift of v, sign of s, shift of s.
    by_face: Vec<[T; 4]>,
    /// Faces of a pair.
    faces: usize,
    loads: Vec<SideLoad>,
    /// Whether work may be done here.
    pub(crate) works: bool,
}

#[derive(Clone)]
struct SideLoad {
    /// Places in `by_face`, which of the four, and twice the amplitude.
    entries: Vec<(usize, usize, f64)>,
    /// The same places without any load.
    bases: Vec<f64>,
    signal: Signal,
}

impl<T: Real> Mirror<T> {
    pub(crate) fn new(boundary: &Boundary, pairs: usize, faces: Range<usize>) -> Self {
        let entry = |condition| match condition {
            Some(Condition::Velocity(given)) => [-1.0, 2.0 * given, 1.0, 0.0],
            Some(Condition::Traction(given)) => [1.0, 0.0, -1.0, 2.0 * given],
            Some(Condition::NonReflecting) | None => [0.0; 4],
        };
        let by_face: Vec<[f64; 4]> = (0..pairs)
            .flat_map(|pair| faces.clone().map(move |face| (pair, face)))
            .map(|(pair, face)| entry(boundary.condition(pair, face)))
            .collect();
        let works = by_face.iter().any(|e| e[0] == 0.0 || e[1] != 0.0 || e[3] != 0.0);
        let by_face = by_face.into_iter().map(|entry| entry.map(T::of)).collect();
        Self { by_face, faces: faces.len(), loads: Vec::new(), works }
    }

    /// Adds a load on faces counted from `first`; on faces of open sides there is nothing to be given.
    pub(crate) fn add(&mut self, load: &Load, first: usize) {
        let mut entries = Vec::new();
        for &(face, amplitude) in &load.faces {
            let Some(own) = face.checked_sub(first).filter(|own| *own < self.faces) else {
                continue;
            };
            let place = load.pair * self.faces + own;
            match self.by_face[place].map(T::wide) {
                [sign, ..] if sign < 0.0 => entries.push((place, 1, 2.0 * amplitude)),
                [sign, ..] if sign > 0.0 => entries.push((place, 3, 2.0 * amplitude)),
                _ => {}
            }
        }
        if !entries.is_empty() {
            let bases = entries.iter().map(|&(place, which, _)| self.by_face[place][which].wide());
            let (bases, signal) = (bases.collect(), load.signal.clone());
            self.loads.push(SideLoad { entries, bases, signal });
            self.works = true;
        }
    }

    /// The shifts at a time.
    pub(crate) fn set_time(&mut self, time: f64) {
        for load in &self.loads {
            for (&(place, which, _), &base) in load.entries.iter().zip(&load.bases) {
                self.by_face[place][which] = T::of(base);
            }
        }
        for load in &self.loads {
            let value = (load.signal)(time);
            for &(place, which, amplitude) in &load.entries {
                self.by_face[place][which] = self.by_face[place][which] + T::of(amplitude * value);
            }
        }
    }

    /// The ghost of a cell.
    #[inline(always)]
    pub(crate) fn ghost(&self, pair: usize, face: usize, own: State<T>) -> State<T> {
        let [v, a, s, b] = self.by_face[pair * self.faces + face];
        State { velocity: v * own.velocity + a, stress: s * own.stress + b }
    }
}
