//! A flow as a simulation: one step after the other, each as long as its tolerance allows.
//!
//! The duration has 200 parts of one length, at whose ends steps end, whatever output is asked for. Output within
//! a step comes from a flow that goes from the state before the step to the time that is asked for on its own
//! way, as accurate as all steps.

use super::{RegularTimes, Simulation, State, from_bytes, number, to_bytes};
use crate::flow::{Energy, Flow, FlowError, Left, Problem, Snapshot};
use std::cmp::Ordering;

/// Parts of the duration at whose ends steps end.
const PARTS: f64 = 200.0;

/// Energy of a flow's perturbation, and what changed it.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowAccount {
    /// s.
    pub time: f64,
    /// Energy and works.
    pub energy: Energy,
    /// Kinetic energy at the beginning, J/m³.
    pub initial_energy: f64,
    /// Kinetic energy by shells of modes, J/m³; see [`Flow::spectrum`].
    pub spectrum: Vec<f64>,
}

impl FlowAccount {
    /// Energy that no term accounts for, J/m³: the error of the steps.
    pub fn balance(&self) -> f64 {
        self.energy.kinetic - self.initial_energy - self.energy.background - self.energy.stress
    }
}

/// All fields of a flow.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowFields {
    /// By [field](Flow::fields) and point, x₁ running fastest.
    pub values: Vec<Vec<f64>>,
    /// Where the box is; see [`Flow::deformation`].
    pub deformation: [[f64; 2]; 2],
}

/// A flow in time. Runs on the threads of the surrounding pool; bits do not depend on their number.
pub struct FlowSimulation {
    flow: Flow,
    duration: f64,
    /// Ends of the parts of the duration.
    ends: RegularTimes,
    /// Points whose fields are recorded.
    probes: Vec<usize>,
    initial_energy: f64,
    /// The state before the last step.
    before: Option<Snapshot>,
    /// Whether the present state has not been handed over as a record.
    is_new: bool,
}

impl FlowSimulation {
    /// The background alone, for a duration in s; it is to be [perturbed](Self::perturb) or
    /// [restored](Simulation::restore). `probes` are points, x₁ running fastest.
    ///
    /// # Errors
    /// The first number of the problem that cannot be.
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

    /// Adds the perturbation that the flow begins with; see [`Flow::perturb`].
    ///
    /// # Errors
    /// A point has no stress.
    ///
    /// # Panics
    /// The number of values is not that of the points.
    pub fn perturb(&mut self, velocity: [&[f64]; 2], inner: &[f64]) -> Result<(), Left> {
        self.flow.perturb(velocity, inner)?;
        self.initial_energy = self.flow.energy().kinetic;
        self.is_new = true;
        Ok(())
    }

    /// The flow.
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

    /// Looks at the flow at a time, s, during the last step.
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
