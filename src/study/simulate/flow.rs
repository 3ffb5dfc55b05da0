//! Simulation of a flow.

use super::cost::Written;
use super::plan::number_of_snapshots;
use super::record::energy_unit;
use super::watch::{Found, View, output_times, receivers_table, run};
use super::{
    Bytes, Cost, Effort, Fields, FinalLedger, Head, IllPosed, Job, Plan, Quantity, Receiver,
    Recorder, RunResult, StopCause, Stopped, TableKind, Warning, Work,
};
use crate::case::Case;
use crate::case::flow::{FlowRun, Quantity as Shown};
use crate::setup::flow_run;
use crate::{Error, setup};
use analysis::StateError;
use analysis::flows::Workspace;
use analysis::growth::Verdict;
use dynamics::flow::{Energy, Left, Problem};
use dynamics::simulation::{FlowAccount, FlowFields, FlowSimulation};

/// Upper bound of the numbers stored per point: 24 measured for 1024² points, plus those of checkpoint and snapshot.
const NUMBERS: f64 = 40.0;

/// Default number of ledger rows.
const LINES: f64 = 200.0;

/// Number of wave directions in the estimate of the greatest rate.
const DIRECTIONS: usize = 36;

/// Greatest stable product of time step and decay rate, with the maximum of 2000 stages per step.
const MAX_PRODUCT: f64 = 2.4e6;

/// Simulation of a flow with its solver problem.
pub(super) struct FlowJob<'a> {
    case: &'a Case,
    run: &'a FlowRun,
    problem: Problem,
    /// Output fields of the flow.
    quantities: Vec<Shown>,
}

impl<'a> FlowJob<'a> {
    pub(super) fn new(case: &'a Case, run: &'a FlowRun) -> Result<Self, Error> {
        let problem = flow_run::problem(case, run)?;
        let quantities = Shown::all(run.rotation);
        Ok(Self { case, run, problem, quantities })
    }

    /// Returns the greatest |ς| of waves of the grid in the uniform flow, 1/s; `None` if it cannot be analysed.
    fn greatest_rate(&self) -> Option<f64> {
        let mut workspace = Workspace::default();
        workspace.assess(&self.case.flow_model().ok()?, &self.case.mean_flow().ok()?).ok()?;
        let [_, number] = self.wave_numbers();
        let polynomial = &workspace.pencil.polynomial;
        let directions =
            (0..DIRECTIONS).map(|i| std::f64::consts::PI * i as f64 / DIRECTIONS as f64);
        let roots = directions.flat_map(|direction| polynomial.roots(number, direction, &[]));
        Some(roots.map(|root| root.norm()).filter(|rate| rate.is_finite()).fold(0.0, f64::max))
    }

    /// Estimates the least cost: steps of 1/200 of the duration, shorter ones if fast decay of short waves requires too
    /// many stages, and a further step for each snapshot and each ledger row beyond [`LINES`].
    fn cost(&self) -> Cost {
        let FlowRun { grid, output, time, receivers, .. } = self.run;
        let looks = |interval: f64| number_of_snapshots(interval, time.duration);
        let snapshots = looks(output.snapshot_interval);
        let lines = looks(output.ledger_interval).max(LINES);
        let product = time.duration * self.greatest_rate().unwrap_or(0.0);
        let steps = LINES.max(product / MAX_PRODUCT);
        let stages = (1.5 * product / steps).sqrt().max(2.0);
        let looked = steps + snapshots + (lines - LINES);
        let columns: usize = receivers.iter().map(|own| own.fields.len()).sum();
        let [first, second] = grid.greatest_modes();
        let written = Written {
            snapshots,
            numbers: grid.count() as f64 * self.quantities.len() as f64,
            cells: lines * (8 + first.max(second)) as f64 + steps * (1 + columns) as f64,
        };
        Cost::of_flow([steps, looked * stages], grid.count() as f64, written)
    }

    /// Returns the least and greatest initial wave number of the box along an axis, 1/m.
    fn wave_numbers(&self) -> [f64; 2] {
        let grid = &self.run.grid;
        let least = grid.lengths.map(|length| 2.0 * std::f64::consts::PI / length);
        let modes = grid.greatest_modes();
        let greatest = [0, 1].map(|axis| modes[axis] as f64 * least[axis]);
        [least[0].min(least[1]), greatest[0].max(greatest[1])]
    }
}

impl Job for FlowJob<'_> {
    fn plan(&self, keeps_snapshots: bool) -> Result<Plan, Error> {
        let run = self.run;
        let work = Work::Flow {
            points: run.grid.cells,
            model: self.case.material.kind.title(),
            duration: run.time.duration,
            wave_numbers: self.wave_numbers(),
        };
        let snapshots = number_of_snapshots(run.output.snapshot_interval, run.time.duration);
        let kept = if keeps_snapshots { snapshots * self.quantities.len() as f64 } else { 0.0 };
        let needed = (NUMBERS + kept) * size_of::<f64>() as f64 * run.grid.count() as f64;
        let plan = Plan { work, memory: Bytes(needed), cost: self.cost() };
        plan.if_memory_suffices(|found| run.locate("grid.cells", found, "ask for fewer points"))
    }

    fn refuse_excess(&self, plan: &Plan) -> Result<(), Error> {
        plan.cost.refuse_excess(|key, found, allowed| self.run.locate(key, found, allowed))
    }

    fn check(&self) -> Result<(), Error> {
        flow_run::fields(self.run, &self.problem)?;
        Ok(())
    }

    fn warnings(&self) -> Result<Vec<Warning>, Error> {
        Ok(Vec::new())
    }

    fn ill_posed(&self) -> Result<Option<IllPosed>, Error> {
        let flow = self.case.mean_flow()?;
        let located = |error: StateError| setup::locate(&self.case.material, error);
        let model = self.case.flow_model().map_err(|error| located(error.into()))?;
        let judged = Workspace::default().decide(&model, &flow);
        let (verdict, _) = judged.map_err(|error| located(error.into()))?;
        let Verdict::IllPosed { growth, direction } = verdict else { return Ok(None) };
        let [_, number] = self.wave_numbers();
        Ok(Some(IllPosed { growth, direction_deg: direction.to_degrees(), number }))
    }

    fn carry_out(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error> {
        let (case, duration) = (self.run, self.run.time.duration);
        let probes = case.receivers.iter().map(|own| case.grid.nearest(&own.at)).collect();
        let mut simulation = FlowSimulation::new(&self.problem, duration, probes)
            .map_err(|error| case.locate("grid", error.to_string(), "see docs/case-file.md"))?;
        // The initial perturbation itself is outside of the solver's domain.
        let too_much = |left: Left| {
            let allowed = "a smaller perturbation, which leaves the flow deforming";
            case.locate("initial", StopCause::from(&left).to_string(), allowed)
        };
        if !recorder.is_resumed() {
            let fields = flow_run::fields(case, &self.problem)?;
            let [v1, v2] = &fields.velocity;
            simulation.perturb([v1, v2], &fields.inner).map_err(too_much)?;
        }
        let lines = match case.output.ledger_interval {
            0.0 => duration / LINES,
            seconds => seconds,
        };
        let output = output_times(lines, case.output.snapshot_interval, duration);
        run(self, simulation, &output, duration, recorder).map(|found| self.result(found))
    }
}

impl FlowJob<'_> {
    fn result(&self, found: Found<FlowAccount>) -> RunResult {
        let grid = &self.run.grid;
        let energy = found.last.energy;
        let terms = vec![
            ("kinetic", energy.kinetic),
            ("at_start", found.last.initial_energy),
            ("background", energy.background),
            ("stress", energy.stress),
            ("balance", found.last.balance()),
            ("power", energy.power),
        ];
        let receiver = |own: &crate::case::dynamics::Receiver<Shown>| {
            let point = grid.nearest(&own.at);
            let index = [point % grid.cells[0], point / grid.cells[0]];
            Receiver {
                name: own.name.clone(),
                at: own.at.clone(),
                cell: None,
                interpolation: None,
                point: Some([grid.position(0, index[0]), grid.position(1, index[1])]),
            }
        };
        RunResult {
            title: self.case.title.clone(),
            model: Some(self.case.material.kind.name()),
            cells: grid.cells.to_vec(),
            length: Some(grid.lengths),
            steps: found.steps,
            step: None,
            time: found.time,
            precision: None,
            order: None,
            velocity_gradient: Some(self.problem.velocity_gradient),
            deformation: found.fields.deformation,
            fields: found.fields,
            ledger: FinalLedger { unit: energy_unit(self.case), terms },
            receivers: self.run.receivers.iter().map(receiver).collect(),
            stopped: found.stopped,
            records: found.records,
        }
    }
}

impl View<FlowSimulation> for FlowJob<'_> {
    fn receivers(&self) -> Option<(Head, Vec<usize>)> {
        let names: Vec<&str> = self.quantities.iter().map(|own| own.name()).collect();
        receivers_table(self.case, &self.run.receivers, &names)
    }

    fn to_display_unit(&self, place: usize, value: f64) -> f64 {
        self.quantities[place % self.quantities.len()].to_display_unit(value)
    }

    fn tables(&self) -> Vec<Head> {
        let header = ["time", "kinetic", "background", "stress", "balance", "power"];
        let ledger = header.map(str::to_owned).to_vec();
        let [most, across] = self.run.grid.greatest_modes();
        let shells = (1..=most.max(across)).map(|shell| shell.to_string());
        let spectrum = ["time".to_owned()].into_iter().chain(shells).collect();
        let head = |kind, columns| Head::new(self.case, kind, columns);
        vec![head(TableKind::Ledger, ledger), head(TableKind::Spectrum, spectrum)]
    }

    fn rows(&self, account: &FlowAccount) -> Vec<Vec<f64>> {
        let Energy { kinetic, background, stress, power } = account.energy;
        let ledger = vec![account.time, kinetic, background, stress, account.balance(), power];
        let spectrum = [account.time].iter().chain(&account.spectrum).copied().collect();
        vec![ledger, spectrum]
    }

    fn fields(&self, _simulation: &FlowSimulation, fields: FlowFields, time: f64) -> Fields {
        let grid = &self.run.grid;
        let points = |axis| (0..grid.cells[axis]).map(|i| grid.position(axis, i)).collect();
        let named = self.quantities.iter().zip(fields.values);
        Fields {
            time,
            coordinates: (0..2).map(points).collect(),
            deformation: Some(fields.deformation),
            quantities: named
                .map(|(own, values)| Quantity::new(own.array().to_owned(), values))
                .collect(),
            dissipation: Vec::new(),
            regions: Vec::new(),
        }
    }

    fn effort(&self, simulation: &FlowSimulation, last: &FlowAccount) -> Effort {
        let flow = simulation.flow();
        let [evaluations, iterations] = flow.effort();
        Effort::Flow {
            energy: last.energy.kinetic,
            stages: flow.stages(),
            evaluations,
            iterations,
            threads: rayon::current_num_threads(),
        }
    }

    fn stopped(&self, left: &Left, saved: f64) -> Stopped {
        Stopped { cause: left.into(), time: left.time, saved }
    }
}
