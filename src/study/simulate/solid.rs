//! Simulation of a solid.

use super::cost::Written;
use super::plan::number_of_snapshots;
use super::record::energy_unit;
use super::watch::{Found, View, output_times, receivers_table, run};
use super::{
    Bytes, Cost, Effort, Fields, FinalLedger, Head, IllPosed, Job, Plan, Quantity, Receiver,
    Recorder, RunResult, StopCause, Stopped, TableKind, Warning, Work,
};
use crate::Error;
use crate::case::dynamics::{
    Action, Component, Condition, Dynamics, Kernel, Ledger as LedgerKind, Load, Precision, Side,
    SideCondition, Splitting, TimeFunction,
};
use crate::case::{Case, CaseError};
use crate::setup::solid_run::{Setup, cell_at, centre, media, probe, time_steps};
use dynamics::SolverReal;
use dynamics::domain::memory;
use dynamics::ledger::{Energy, Ledger};
use dynamics::medium::Medium;
use dynamics::simulation::{
    Simulation as _, SolidAccount, SolidFault, SolidFields, SolidSimulation, SolverChoice,
    TimeSteps,
};

/// Default number of ledger rows.
const LINES: usize = 1000;

/// Memory of the program and its pictures, bytes.
const PROGRAM: f64 = 36.0 * 1048576.0;

/// Numbers per field that the solver stores for each line along the last axis, in two dimensions.
const LINE_IN_THE_PLANE: f64 = 36.0;
const LINE_IN_SPACE: f64 = 4.0;

/// Simulation of a solid with its media.
pub(super) struct SolidJob<'a> {
    case: &'a Case,
    dynamics: &'a Dynamics,
    media: Vec<Medium>,
    /// Names of the output quantities of a cell in order: fields, then time integrals.
    names: Vec<String>,
}

impl<'a> SolidJob<'a> {
    pub(super) fn new(case: &'a Case, dynamics: &'a Dynamics) -> Result<Self, Error> {
        let media = media(case, dynamics)?;
        let fields = media[0].fields.iter().map(|field| Component(*field).to_string());
        let integrals = dynamics.output.integrals.iter().filter_map(|own| own.integral());
        let names = fields.chain(integrals).collect();
        Ok(Self { case, dynamics, media, names })
    }

    /// Estimates the peak memory of a run, bytes: the solver and the copies of the fields for a checkpoint, for the
    /// results or for a snapshot, whichever is greatest.
    fn memory(&self, keeps_snapshots: bool) -> Bytes {
        let Dynamics { grid, output, scheme, initial, .. } = self.dynamics;
        let fields = self.media[0].fields.len();
        let (solver, number) = match scheme.precision {
            Precision::F64 => (memory::<f64>(&self.solver_cells(), fields), size_of::<f64>()),
            Precision::F32 => (memory::<f32>(&self.solver_cells(), fields), size_of::<f32>()),
        };
        // Interface states and boundary values of the lines along the last axis, per field; constants by measurement.
        let cells = self.solver_cells();
        let lines: usize = cells.iter().rev().skip(1).product();
        let of_line = if cells.len() == 2 { LINE_IN_THE_PLANE } else { LINE_IN_SPACE };
        let lines = (lines * fields * number) as f64 * of_line;
        let wide = size_of::<f64>() as f64;
        let saved = (fields * number) as f64;
        let shown = wide * self.names.len() as f64;
        let checkpoint = 2.0 * saved + 2.0 * wide * output.integrals.len() as f64;
        let result = saved + shown;
        // Solver states before and after the snapshot, interpolated fields and file buffers, which do not all coexist.
        let snapshot = match output.snapshot_interval > 0.0 {
            true => saved + 2.5 * shown + 2.0 * wide * self.numbers_of_snapshot() as f64,
            false => 0.0,
        };
        let kept = match keeps_snapshots {
            true => number_of_snapshots(output.snapshot_interval, self.dynamics.time.duration),
            false => 0.0,
        };
        let copies = checkpoint.max(result).max(snapshot)
            + kept * shown
            + wide * initial.len() as f64
            + size_of::<u16>() as f64;
        Bytes(PROGRAM + solver + lines + grid.count() as f64 * copies)
    }

    /// Returns the numbers of cells in the axis order of the solver: in three dimensions with alternating splitting the
    /// last axis with a reflecting side is moved to the front.
    fn solver_cells(&self) -> Vec<usize> {
        let Dynamics { grid, scheme, .. } = self.dynamics;
        let mut cells = grid.cells.clone();
        if cells.len() == 3 && scheme.splitting == Splitting::Alternating {
            let reflects = |axis: &usize| {
                [false, true].into_iter().any(|is_upper| {
                    let side = Side { axis: *axis, is_upper };
                    let of_side = |own: &&SideCondition| own.side == side && own.part.is_none();
                    let last = self.dynamics.sides.iter().rev().find(of_side);
                    !last.is_some_and(|own| {
                        matches!(own.condition, Condition::Periodic | Condition::NonReflecting)
                    })
                })
            };
            let first = (0..3).rev().find(reflects).unwrap_or(0);
            cells[..=first].rotate_right(1);
        }
        cells
    }

    /// Returns the numbers per cell in a snapshot: velocity vectors have three components, and yielding solids have a
    /// dissipation field.
    fn numbers_of_snapshot(&self) -> usize {
        let yields = self.media.iter().any(|medium| medium.yields.is_some());
        self.names.len() + 3 - self.dynamics.grid.dimensions() + usize::from(yields)
    }
}

impl SolidJob<'_> {
    /// Estimates the cost of `steps` steps.
    fn cost(&self, steps: f64) -> Cost {
        let Dynamics { grid, output, time, scheme, receivers, .. } = self.dynamics;
        let count = grid.count() as f64;
        let fields = self.media[0].fields.len() as f64;
        let lines = match output.ledger_interval {
            0.0 => steps.min(LINES as f64),
            seconds => steps.min(time.duration / seconds),
        };
        let columns: usize = receivers.iter().map(|own| own.fields.len()).sum();
        let row = if columns > 0 { 1.0 + columns as f64 } else { 0.0 };
        let written = Written {
            snapshots: number_of_snapshots(output.snapshot_interval, time.duration),
            numbers: count * self.numbers_of_snapshot() as f64,
            cells: lines * 9.0 + steps * row,
        };
        Cost::of_solid(steps, count * fields, scheme.ledger == LedgerKind::Full, written)
    }
}

impl Job for SolidJob<'_> {
    fn plan(&self, keeps_snapshots: bool) -> Result<Plan, Error> {
        let (dynamics, media) = (self.dynamics, &self.media);
        let TimeSteps { count, step, limit, .. } = time_steps(dynamics, media)?;
        let cells = dynamics.grid.cells.clone();
        let work = Work::Solid { cells, fields: media[0].fields.len(), steps: count, step, limit };
        let memory = self.memory(keeps_snapshots);
        let plan = Plan { work, memory, cost: self.cost(count as f64) };
        plan.if_memory_suffices(|found| {
            let allowed = "ask for fewer cells, or for scheme.precision = \"f32\"";
            dynamics.locate("grid.cells", found, allowed)
        })
    }

    fn refuse_excess(&self, plan: &Plan) -> Result<(), Error> {
        plan.cost.refuse_excess(|key, found, allowed| self.dynamics.locate(key, found, allowed))
    }

    fn check(&self) -> Result<(), Error> {
        let media = self.media.clone();
        match self.dynamics.grid.dimensions() {
            2 => drop(Setup::<2>::new(self.case, self.dynamics, media)?),
            _ => drop(Setup::<3>::new(self.case, self.dynamics, media)?),
        }
        Ok(())
    }

    fn warnings(&self) -> Result<Vec<Warning>, Error> {
        const FEW: f64 = 4.0;
        let step = time_steps(self.dynamics, &self.media)?.step;
        let loads = self.dynamics.loads.iter().map(|load| ("load", &load.time)).enumerate();
        let sources = self.dynamics.sources.iter().map(|own| ("source", &own.time)).enumerate();
        let warning = |(index, (name, time)): (usize, (&str, &TimeFunction))| {
            let shortest = time.shortest().filter(|time| *time < FEW * step)?;
            let entry = format!("{name}[{index}]");
            Some(Warning::FewSteps { entry, steps: shortest / step })
        };
        let mut warnings: Vec<Warning> = loads.chain(sources).filter_map(warning).collect();
        if self.dynamics.time.courant == 1.0 {
            let loads = self.dynamics.loads.iter().enumerate();
            let of_load = |own: &Load| match &own.action {
                Action::Point { kernel, .. } => *kernel == Kernel::Cell,
                Action::Whole | Action::Part(_) => false,
            };
            let loads = loads.filter(|own| of_load(own.1)).map(|own| ("load", own.0));
            let sources = self.dynamics.sources.iter().enumerate();
            let sources =
                sources.filter(|own| own.1.kernel == Kernel::Cell).map(|own| ("source", own.0));
            warnings.extend(
                loads
                    .chain(sources)
                    .map(|(name, index)| Warning::Sawtooth { entry: format!("{name}[{index}]") }),
            );
        }
        Ok(warnings)
    }

    fn ill_posed(&self) -> Result<Option<IllPosed>, Error> {
        // Solids are elastic or have associated ideal plasticity; the solver refuses all others.
        Ok(None)
    }

    fn carry_out(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error> {
        match (self.dynamics.grid.dimensions(), self.dynamics.scheme.precision) {
            (2, Precision::F64) => self.simulate::<f64, 2>(recorder),
            (2, Precision::F32) => self.simulate::<f32, 2>(recorder),
            (_, Precision::F64) => self.simulate::<f64, 3>(recorder),
            (_, Precision::F32) => self.simulate::<f32, 3>(recorder),
        }
    }
}

/// Returns the number of steps between two ledger rows.
fn interval(seconds: f64, step: f64) -> usize {
    ((seconds / step).round() as usize).max(1)
}

impl SolidJob<'_> {
    fn simulate<T: SolverReal, const D: usize>(
        &self,
        recorder: &mut dyn Recorder,
    ) -> Result<RunResult, Error> {
        let dynamics = self.dynamics;
        let simulation = self.simulation::<T, D>()?;
        if let (false, Some(cell)) = (recorder.is_resumed(), simulation.first_beyond_yield()) {
            return Err(self.beyond_yield(cell).into());
        }
        let steps = simulation.time_steps();
        let lines = match dynamics.output.ledger_interval {
            0.0 => steps.count.div_ceil(LINES),
            seconds => interval(seconds, steps.step),
        };
        let duration = dynamics.time.duration;
        let accounts = lines as f64 * steps.step;
        let output = output_times(accounts, dynamics.output.snapshot_interval, duration);
        let found = run(self, simulation, &output, duration, recorder)?;
        Ok(self.result(steps, found))
    }

    /// Creates the solver in its initial state.
    fn simulation<T: SolverReal, const D: usize>(&self) -> Result<SolidSimulation<T, D>, Error> {
        let dynamics = self.dynamics;
        let Setup { problem, steps, initial } =
            Setup::<D>::new(self.case, dynamics, self.media.clone())?;
        let of_cell = &problem.of_cell;
        let probes = dynamics.receivers.iter().map(|own| probe(dynamics, of_cell, own)).collect();
        let solver = match dynamics.scheme.ledger {
            LedgerKind::Light => SolverChoice::Fused { threads: rayon::current_num_threads() },
            LedgerKind::Full => SolverChoice::Reference,
        };
        let simulation = SolidSimulation::new(problem, steps, initial, probes, solver);
        Ok(simulation
            .map_err(|error| dynamics.locate("grid", error.to_string(), "see docs/case-file.md"))?)
    }

    /// Creates the error that the initial stress is beyond yield.
    fn beyond_yield(&self, cell: usize) -> CaseError {
        let place = centre(self.dynamics, cell);
        let found = format!("a stress beyond yield in the cell at {place:?}");
        let allowed =
            "initial stresses, and those of [initial_stress] with them, within the yield set";
        self.dynamics.locate("initial", found, allowed)
    }

    fn result(&self, steps: TimeSteps, found: Found<SolidAccount>) -> RunResult {
        let dynamics = self.dynamics;
        let SolidAccount { energy, ledger, initial_energy, .. } = found.last;
        let mut terms = vec![
            ("kinetic", energy.kinetic),
            ("stored", energy.stored),
            ("at_start", initial_energy),
            ("sides", ledger.inflow),
            ("sources", ledger.sources),
            ("initial_stress", ledger.released),
            ("plastic", ledger.plastic),
        ];
        let is_full = dynamics.scheme.ledger == LedgerKind::Full;
        if is_full {
            terms.push(("numerical", ledger.numerical));
        }
        terms.push((if is_full { "residual" } else { "balance" }, found.last.balance()));
        let receiver = |own: &crate::case::dynamics::Receiver<_>| Receiver {
            name: own.name.clone(),
            at: own.at.clone(),
            cell: Some(centre(dynamics, cell_at(dynamics, &own.at))),
            interpolation: Some(own.interpolation.name()),
            point: None,
        };
        RunResult {
            title: self.case.title.clone(),
            model: None,
            cells: dynamics.grid.cells.clone(),
            length: None,
            steps: found.steps,
            step: Some(steps.step),
            time: found.time,
            precision: Some(dynamics.scheme.precision.name()),
            order: Some(dynamics.scheme.order.name()),
            velocity_gradient: None,
            deformation: None,
            fields: found.fields,
            ledger: FinalLedger { unit: energy_unit(self.case), terms },
            receivers: dynamics.receivers.iter().map(receiver).collect(),
            stopped: found.stopped,
            records: found.records,
        }
    }
}

impl<T: SolverReal, const D: usize> View<SolidSimulation<T, D>> for SolidJob<'_> {
    fn receivers(&self) -> Option<(Head, Vec<usize>)> {
        receivers_table(self.case, &self.dynamics.receivers, &self.names)
    }

    fn tables(&self) -> Vec<Head> {
        let mut header =
            vec!["time", "kinetic", "stored", "sides", "sources", "initial_stress", "plastic"];
        header.extend(match self.dynamics.scheme.ledger {
            LedgerKind::Full => ["numerical", "residual"].as_slice(),
            LedgerKind::Light => &["balance"],
        });
        let header = header.into_iter().map(str::to_owned).collect();
        vec![Head::new(self.case, TableKind::Ledger, header)]
    }

    fn rows(&self, account: &SolidAccount) -> Vec<Vec<f64>> {
        let Ledger { inflow, sources, released, plastic, numerical, .. } = account.ledger;
        let Energy { kinetic, stored, .. } = account.energy;
        let mut row = vec![account.time, kinetic, stored, inflow, sources, released, plastic];
        if self.dynamics.scheme.ledger == LedgerKind::Full {
            row.push(numerical);
        }
        row.push(account.balance());
        vec![row]
    }

    fn fields(&self, simulation: &SolidSimulation<T, D>, fields: SolidFields, time: f64) -> Fields {
        let grid = &self.dynamics.grid;
        let middles = |axis| (0..grid.cells[axis]).map(|i| grid.centre(axis, i)).collect();
        let has_regions = !self.dynamics.regions.is_empty();
        let named = self.names.iter().zip(fields.values);
        Fields {
            time,
            coordinates: (0..grid.dimensions()).map(middles).collect(),
            deformation: None,
            quantities: named.map(|(name, own)| Quantity::new(name.clone(), own)).collect(),
            dissipation: fields.dissipated,
            regions: match has_regions {
                true => simulation.problem().of_cell.clone(),
                false => Vec::new(),
            },
        }
    }

    fn effort(&self, simulation: &SolidSimulation<T, D>, _last: &SolidAccount) -> Effort {
        Effort::Solid {
            energy: simulation.account().energy.total(),
            cells: simulation.problem().grid.count(),
            threads: simulation.threads(),
        }
    }

    fn stopped(&self, fault: &SolidFault, saved: f64) -> Stopped {
        let cause = match fault.place {
            Some((field, cell)) => StopCause::Field { field, place: centre(self.dynamics, cell) },
            None => StopCause::Energy,
        };
        Stopped { cause, time: fault.time, saved }
    }
}
