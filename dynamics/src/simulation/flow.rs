//! Simulation of a flow with error-controlled step sizes.
//!
//! The duration is divided into 200 equal intervals, at whose ends steps end whatever output is requested. Output
//! within a step comes from a copy of the flow that is restored to the state before the step and advanced to the output
//! time with the same tolerance.

use super::{RegularTimes, Simulation, State, from_bytes, number, to_bytes};
use crate::flow::{Energy, Flow, FlowError, Left, Problem, Snapshot};
use std::cmp::Ordering;

/// Number of intervals of the duration at whose ends steps end.
const PARTS: f64 = 200.0;

/// Energy of a flow's perturbation and its balance.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowAccount {
    /// Time, s.
    pub time: f64,
    /// Kinetic energy and works, J/m³.
    pub energy: Energy,
    /// Kinetic energy at time 0, J/m³.
    pub initial_energy: f64,
    /// Kinetic energy by shells of modes, J/m³; see [`Flow::spectrum`].
    pub spectrum: Vec<f64>,
}

impl FlowAccount {
    /// Returns the energy change not explained by the works, J/m³: the time integration error.
    pub fn balance(&self) -> f64 {
        self.energy.kinetic - self.initial_energy - self.energy.background - self.energy.stress
    }
}

/// Output fields of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowFields {
    /// By [field](Flow::fields) and point (x₁ fastest).
    pub values: Vec<Vec<f64>>,
    /// Deformation gradient of the box; see [`Flow::deformation`].
    pub deformation: [[f64; 2]; 2],
}

/// Time-domain simulation of a flow. Uses the surrounding thread pool; results do not depend on the number of threads.
pub struct FlowSimulation {
    flow: Flow,
    duration: f64,
    /// Ends of the intervals of the duration.
    ends: RegularTimes,
    /// Points whose fields are recorded.
    probes: Vec<usize>,
    initial_energy: f64,
    /// Snapshot before the last step.
    before: Option<Snapshot>,
    /// Whether the present state has not been recorded yet.
    is_new: bool,
}

impl FlowSimulation {
    /// The unperturbed background flow for a duration, s; to be [perturbed](Self::perturb) or
    /// [restored](Simulation::restore). `probes`: point indices, x₁ fastest.
    ///
    /// # Errors
    /// The first invalid number of the problem.
    pub fn new(problem: &Problem, duration: f64, probes: Vec<usize>) -> Result<Self, FlowError> {
        Ok(Self {
            flow: Flow::new(problem)?,
            duration,
            ends: RegularTimes::new(duration / PARTS, duration),
            probes,
            initial_energy: 0.0,
            before: None,
            is_new: false,
        })
    }

    /// Adds the initial perturbation; see [`Flow::perturb`].
    ///
    /// # Errors
    /// The stress is undetermined at a point.
    ///
    /// # Panics
    /// The number of values differs from the number of points.
    pub fn perturb(&mut self, velocity: [&[f64]; 2], inner: &[f64]) -> Result<(), Left> {
        self.flow.perturb(velocity, inner)?;
        self.initial_energy = self.flow.energy().kinetic;
        self.is_new = true;
        Ok(())
    }

    /// Returns the flow.
    pub fn flow(&self) -> &Flow {
        &self.flow
    }

    fn account_of(&self, flow: &Flow) -> FlowAccount {
        FlowAccount {
            time: flow.time(),
            energy: flow.energy(),
            initial_energy: self.initial_energy,
            spectrum: flow.spectrum(),
        }
    }

    /// Evaluates `look` for the flow at `time`, s, within the last step.
    fn at<R>(&self, time: f64, look: impl FnOnce(&Flow) -> R) -> Result<R, Left> {
        let Some(before) = self.before.as_ref().filter(|_| self.compare(time) == Ordering::Less)
        else {
            return Ok(look(&self.flow));
        };
        let mut aside = self.flow.unperturbed();
        aside.restore(before);
        while aside.time() < time {
            aside.advance(time)?;
        }
        Ok(look(&aside))
    }
}

fn fields_of(flow: &Flow) -> FlowFields {
    FlowFields { values: flow.values(), deformation: flow.deformation() }
}

impl Simulation for FlowSimulation {
    type Account = FlowAccount;
    type Fields = FlowFields;
    type Fault = Left;

    fn steps(&self) -> usize {
        self.flow.steps()
    }

    fn time(&self) -> f64 {
        self.flow.time()
    }

    fn is_finished(&self) -> bool {
        self.flow.time() >= self.duration
    }

    fn compare(&self, time: f64) -> Ordering {
        let now = self.flow.time();
        match (self.ends.is_one(time, now), time < now) {
            (true, _) => Ordering::Equal,
            (false, true) => Ordering::Less,
            (false, false) => Ordering::Greater,
        }
    }

    fn advance(&mut self, _due: f64) -> Result<(), Left> {
        let time = self.flow.time();
        self.before = Some(self.flow.snapshot());
        self.flow.advance(self.ends.time(self.ends.until(time)).unwrap_or(self.duration))?;
        self.is_new = true;
        Ok(())
    }

    fn drain_records<E>(
        &mut self,
        mut deliver: impl FnMut(f64, &[f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.probes.is_empty() || !std::mem::take(&mut self.is_new) {
            return Ok(());
        }
        let values = self.flow.values();
        let of_point = |&point: &usize| values.iter().map(move |values| values[point]);
        let state: Vec<f64> = self.probes.iter().flat_map(of_point).collect();
        deliver(self.flow.time(), &state)
    }

    fn account(&self) -> FlowAccount {
        self.account_of(&self.flow)
    }

    fn account_at(&self, time: f64) -> Result<FlowAccount, Left> {
        self.at(time, |flow| self.account_of(flow))
    }

    fn fields(&self) -> FlowFields {
        fields_of(&self.flow)
    }

    fn fields_at(&self, time: f64) -> Result<FlowFields, Left> {
        self.at(time, fields_of)
    }

    fn state(&self) -> State {
        let Snapshot { steps, parts } = self.flow.snapshot();
        State {
            steps,
            time: self.flow.time(),
            initial_energy: self.initial_energy,
            sections: number("part", parts.iter().map(|part| to_bytes(part))).collect(),
        }
    }

    fn restore(&mut self, state: &State) -> bool {
        let Some(parts) = state.numbered("part").map(from_bytes).collect::<Option<_>>() else {
            return false;
        };
        let snapshot = Snapshot { steps: state.steps, parts };
        self.initial_energy = state.initial_energy;
        (self.before, self.is_new) = (None, false);
        self.flow.restore(&snapshot)
    }
}
