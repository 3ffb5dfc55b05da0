//! Simulation of a flow with error-controlled step sizes.
//!
//! The duration is divided into 200 equal intervals. Steps end at the ends of these intervals, but not at output times:
//! they do not depend on the output. Output within a step comes from a copy of the flow that is restored to the state
//! before the step and advanced to the output time with the same tolerance.

use super::{
    AdvanceError, CellSections, RegularTimes, Simulation, SimulationState, StateSource, from_bytes,
    number_sections, to_bytes,
};
use crate::flow::{FlowEnergy, FlowError, FlowProblem, FlowSnapshot, FlowSolver, LeftDomain};
use std::cmp::Ordering;

/// Number of intervals of the duration at whose ends steps end.
const INTERVAL_COUNT: f64 = 200.0;

/// Energy account of a flow: energy of the perturbation, and works.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowAccount {
    /// Time of the account, s.
    pub time: f64,
    /// Kinetic energy and works, J/m³.
    pub energy: FlowEnergy,
    /// Kinetic energy at time 0, J/m³.
    pub initial_energy: f64,
    /// Kinetic energy by shells of modes, J/m³; see [`FlowSolver::energy_spectrum`].
    pub energy_spectrum: Vec<f64>,
}

impl FlowAccount {
    /// Returns the energy change not explained by the works, J/m³: the time integration error.
    pub fn balance(&self) -> f64 {
        self.energy.kinetic
            - self.initial_energy
            - self.energy.background_work
            - self.energy.stress_work
    }
}

/// Output fields of a flow, and the deformation of its box.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowFields {
    /// Values by [field](FlowSolver::output_fields) and point (x₁ fastest).
    pub values: Vec<Vec<f64>>,
    /// Deformation gradient of the box; see [`FlowSolver::deformation_gradient`].
    pub deformation_gradient: [[f64; 2]; 2],
}

/// Time-domain simulation of a flow. It uses the thread pool of the caller; results do not depend on the number of
/// threads.
pub struct FlowSimulation {
    flow: FlowSolver,
    duration: f64,
    /// Ends of the intervals of the duration.
    interval_ends: RegularTimes,
    /// Indices of the points whose fields are recorded.
    probes: Vec<usize>,
    initial_energy: f64,
    /// State before the last step; `None` before the first step since creating or restoring the simulation.
    snapshot_before_step: Option<FlowSnapshot>,
    /// Whether the present state has not been recorded yet.
    has_new_record: bool,
}

impl FlowSimulation {
    /// Creates the simulation of an unperturbed background flow for `duration`, s; the flow is to be
    /// [perturbed](Self::perturb) or [restored](Simulation::restore). `probes`: point indices, x₁ fastest.
    ///
    /// # Errors
    /// The first invalid parameter of the problem.
    pub fn new(
        problem: &FlowProblem,
        duration: f64,
        probes: Vec<usize>,
    ) -> Result<Self, FlowError> {
        Ok(Self {
            flow: FlowSolver::new(problem)?,
            duration,
            interval_ends: RegularTimes::new(duration / INTERVAL_COUNT, duration),
            probes,
            initial_energy: 0.0,
            snapshot_before_step: None,
            has_new_record: false,
        })
    }

    /// Adds the initial perturbation; see [`FlowSolver::perturb`].
    ///
    /// # Errors
    /// The stress is undetermined at a point, or the pressure solution does not converge.
    ///
    /// # Panics
    /// The number of values differs from the number of points; without internal variable, its values are ignored.
    pub fn perturb(
        &mut self,
        velocity: [&[f64]; 2],
        internal_variable: &[f64],
    ) -> Result<(), LeftDomain> {
        self.flow.perturb(velocity, internal_variable)?;
        self.initial_energy = self.flow.energy().kinetic;
        self.has_new_record = true;
        Ok(())
    }

    /// Returns the flow solver in its present state.
    pub fn flow(&self) -> &FlowSolver {
        &self.flow
    }

    fn compute_account(&self, flow: &FlowSolver) -> FlowAccount {
        FlowAccount {
            time: flow.time(),
            energy: flow.energy(),
            initial_energy: self.initial_energy,
            energy_spectrum: flow.energy_spectrum(),
        }
    }

    /// Calls `evaluate` for the flow at `time`, s, within or at the end of the last step.
    fn evaluate_at<R>(
        &self,
        time: f64,
        evaluate: impl FnOnce(&FlowSolver) -> R,
    ) -> Result<R, LeftDomain> {
        let Some(before) = self
            .snapshot_before_step
            .as_ref()
            .filter(|_| self.compare_time(time) == Ordering::Less)
        else {
            return Ok(evaluate(&self.flow));
        };
        let mut copy = self.flow.to_unperturbed();
        copy.restore(before);
        while copy.time() < time {
            copy.advance(time)?;
        }
        Ok(evaluate(&copy))
    }
}

fn collect_fields(flow: &FlowSolver) -> FlowFields {
    FlowFields { values: flow.output_values(), deformation_gradient: flow.deformation_gradient() }
}

impl Simulation for FlowSimulation {
    type Account = FlowAccount;
    type Fields = FlowFields;
    type Fault = LeftDomain;

    fn steps(&self) -> usize {
        self.flow.steps()
    }

    fn time(&self) -> f64 {
        self.flow.time()
    }

    fn is_finished(&self) -> bool {
        self.flow.time() >= self.duration
    }

    fn compare_time(&self, time: f64) -> Ordering {
        let now = self.flow.time();
        match (self.interval_ends.is_same_time(time, now), time < now) {
            (true, _) => Ordering::Equal,
            (false, true) => Ordering::Less,
            (false, false) => Ordering::Greater,
        }
    }

    fn advance(&mut self, _due: f64) -> Result<(), AdvanceError<LeftDomain>> {
        let time = self.flow.time();
        self.snapshot_before_step = Some(self.flow.snapshot());
        let end = self.interval_ends.time(self.interval_ends.count_until(time));
        self.flow.advance(end.unwrap_or(self.duration)).map_err(AdvanceError::Fault)?;
        self.has_new_record = true;
        Ok(())
    }

    fn drain_records<E>(
        &mut self,
        mut deliver: impl FnMut(f64, &[f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        if self.probes.is_empty() || !std::mem::take(&mut self.has_new_record) {
            return Ok(());
        }
        let output = self.flow.output_values();
        let point_values = |&point: &usize| output.iter().map(move |values| values[point]);
        let state: Vec<f64> = self.probes.iter().flat_map(point_values).collect();
        deliver(self.flow.time(), &state)
    }

    fn account(&self) -> FlowAccount {
        self.compute_account(&self.flow)
    }

    fn account_at(&self, time: f64) -> Result<FlowAccount, LeftDomain> {
        self.evaluate_at(time, |flow| self.compute_account(flow))
    }

    fn fields(&self) -> FlowFields {
        collect_fields(&self.flow)
    }

    fn fields_at(&self, time: f64) -> Result<FlowFields, LeftDomain> {
        self.evaluate_at(time, collect_fields)
    }

    fn restore_with_cells(
        &mut self,
        state: &SimulationState,
        _cells: &mut dyn CellSections,
    ) -> bool {
        let Some(solver_arrays) =
            state.numbered_sections("part").map(from_bytes).collect::<Option<_>>()
        else {
            return false;
        };
        let snapshot = FlowSnapshot { steps: state.steps, solver_arrays };
        self.initial_energy = state.initial_energy;
        (self.snapshot_before_step, self.has_new_record) = (None, false);
        self.flow.restore(&snapshot)
    }
}

impl StateSource for FlowSimulation {
    fn state_without_cells(&self) -> SimulationState {
        let FlowSnapshot { steps, solver_arrays } = self.flow.snapshot();
        SimulationState {
            steps,
            time: self.flow.time(),
            initial_energy: self.initial_energy,
            sections: number_sections("part", solver_arrays.iter().map(|array| to_bytes(array)))
                .collect(),
        }
    }
}
