//! Simulation of a flow.

use super::cost::OutputVolume;
use super::observer::{
    OutputConverter, SimulationOutput, create_output_times, create_receiver_table,
    run_with_recorder,
};
use super::plan::snapshot_count;
use super::recorder::energy_unit;
use super::{
    Bytes, Cost, FieldQuantity, FinalLedger, IllPosedness, OutputFields, ProblemSize, Recorder,
    RunReceiver, RunResult, SimulationJob, SimulationPlan, SimulationWarning, StepStatistics,
    StopCause, StopReport, TableHeader, TableKind,
};
use crate::case::Case;
use crate::case::flow::{FlowQuantity, FlowRun};
use crate::setup::flow_run;
use crate::{Error, setup};
use analysis::StateError;
use analysis::flows::FlowWorkspace;
use analysis::growth::Verdict;
use dynamics::flow::{FlowEnergy, FlowProblem, LeftDomain};
use dynamics::simulation::{FlowAccount, FlowFields, FlowSimulation};
use models::common::elementary::Modulus;
use std::ops::Range;

/// Upper bound of the number of `f64` values stored per grid point: 24, measured for 1024² points, plus those of a
/// checkpoint and a snapshot.
const NUMBERS_PER_POINT: f64 = 40.0;

/// Default number of intervals between ledger rows.
const DEFAULT_LEDGER_ROWS: f64 = 200.0;

/// Number of wave directions over 180° in the estimate of the largest rate.
const DIRECTION_COUNT: usize = 36;

/// Largest stable product of the time step, s, and a decay rate, 1/s, for the maximum of 2000 stages per step.
const MAX_STEP_RATE_PRODUCT: f64 = 2.4e6;

/// Simulation of a flow, with its case and its solver problem.
pub(super) struct FlowJob<'a> {
    case: &'a Case,
    flow_run: &'a FlowRun,
    problem: FlowProblem,
    /// Quantities in the output fields of the flow.
    quantities: Vec<FlowQuantity>,
}

impl<'a> FlowJob<'a> {
    pub(super) fn new(case: &'a Case, run: &'a FlowRun) -> Result<Self, Error> {
        let problem = flow_run::create_run_problem(case, run)?;
        let quantities = FlowQuantity::all_fields(run.rotation);
        Ok(Self { case, flow_run: run, problem, quantities })
    }

    /// Returns the largest |ς|, 1/s, of waves with the largest wave number of the grid along an axis in the uniform
    /// flow, over [`DIRECTION_COUNT`] directions; `None` if the flow cannot be analysed.
    fn max_rate(&self) -> Option<f64> {
        let mut workspace = FlowWorkspace::default();
        workspace
            .assess(&self.case.build_model().ok()?, &self.case.solve_mean_flow().ok()?)
            .ok()?;
        let [_, number] = self.wave_number_range();
        let polynomial = &workspace.pencil.polynomial;
        let directions =
            (0..DIRECTION_COUNT).map(|i| std::f64::consts::PI * i as f64 / DIRECTION_COUNT as f64);
        let roots = directions.flat_map(|direction| polynomial.roots(number, direction, &[]));
        Some(roots.map(|root| root.modulus()).filter(|rate| rate.is_finite()).fold(0.0, f64::max))
    }

    /// Estimates the smallest possible cost. Steps are 1/[`DEFAULT_LEDGER_ROWS`] of the duration, or shorter if the
    /// fast decay of short waves would require too many stages; each snapshot and each further ledger row costs one
    /// more step.
    fn estimate_cost(&self) -> Cost {
        let FlowRun { grid, output, time, receivers, .. } = self.flow_run;
        let output_count = |interval: f64| snapshot_count(interval, time.duration);
        let snapshots = output_count(output.snapshot_interval);
        let lines = output_count(output.ledger_interval).max(DEFAULT_LEDGER_ROWS);
        let product = time.duration * self.max_rate().unwrap_or(0.0);
        let steps = DEFAULT_LEDGER_ROWS.max(product / MAX_STEP_RATE_PRODUCT);
        let stages = (1.5 * product / steps).sqrt().max(2.0);
        let looked = steps + snapshots + (lines - DEFAULT_LEDGER_ROWS);
        let columns: usize = receivers.iter().map(|own| own.fields.len()).sum();
        let [first, second] = grid.max_mode_numbers();
        let written = OutputVolume {
            snapshot_count: snapshots,
            numbers_per_snapshot: grid.point_count() as f64 * self.quantities.len() as f64,
            numbers_in_tables: lines * (8 + first.max(second)) as f64
                + steps * (1 + columns) as f64,
        };
        Cost::estimate_flow_cost([steps, looked * stages], grid.point_count() as f64, written)
    }

    /// Returns the smallest and the largest initial wave number of the grid's modes along an axis, 1/m.
    fn wave_number_range(&self) -> [f64; 2] {
        let grid = &self.flow_run.grid;
        let least = grid.lengths.map(|length| 2.0 * std::f64::consts::PI / length);
        let modes = grid.max_mode_numbers();
        let greatest = [0, 1].map(|axis| modes[axis] as f64 * least[axis]);
        [least[0].min(least[1]), greatest[0].max(greatest[1])]
    }
}

impl SimulationJob for FlowJob<'_> {
    fn plan(&self, keeps_snapshots: bool, rank_count: usize) -> Result<SimulationPlan, Error> {
        let run = self.flow_run;
        let work = ProblemSize::Flow {
            point_counts: run.grid.points,
            model_title: self.case.material.kind.title(),
            duration: run.time.duration,
            wave_numbers: self.wave_number_range(),
        };
        let snapshots = snapshot_count(run.output.snapshot_interval, run.time.duration);
        let kept = if keeps_snapshots { snapshots * self.quantities.len() as f64 } else { 0.0 };
        let needed =
            (NUMBERS_PER_POINT + kept) * size_of::<f64>() as f64 * run.grid.point_count() as f64;
        let plan = SimulationPlan {
            problem_size: work,
            rank_count,
            required_memory: Bytes(needed),
            cost: self.estimate_cost(),
        };
        plan.check_memory(|found| run.key_error("grid.cells", found, "ask for fewer points"))
    }

    fn refuse_excess(&self, plan: &SimulationPlan) -> Result<(), Error> {
        plan.cost.refuse_excess(|key, found, allowed| self.flow_run.key_error(key, found, allowed))
    }

    fn check_case(&self) -> Result<(), Error> {
        flow_run::assemble_perturbation(self.flow_run, &self.problem)?;
        Ok(())
    }

    fn find_warnings(&self) -> Result<Vec<SimulationWarning>, Error> {
        Ok(Vec::new())
    }

    fn find_ill_posedness(&self) -> Result<Option<IllPosedness>, Error> {
        let flow = self.case.solve_mean_flow()?;
        let located = |error: StateError| setup::locate_state_error(&self.case.material, error);
        let model = self.case.build_model().map_err(|error| located(error.into()))?;
        let judged = FlowWorkspace::default().decide_verdict(&model, &flow);
        let (verdict, _) = judged.map_err(|error| located(error.into()))?;
        let Verdict::IllPosed { growth, direction } = verdict else { return Ok(None) };
        let [_, number] = self.wave_number_range();
        Ok(Some(IllPosedness {
            growth,
            direction_deg: direction.to_degrees(),
            max_wave_number: number,
        }))
    }

    fn execute(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error> {
        let (case, duration) = (self.flow_run, self.flow_run.time.duration);
        let probes =
            case.receivers.iter().map(|own| case.grid.nearest_point(&own.position)).collect();
        let mut simulation = FlowSimulation::new(&self.problem, duration, probes)
            .map_err(|error| case.key_error("grid", error.to_string(), "see docs/case-file.md"))?;
        // Creates the error that the initial perturbation itself leaves the domain of the solver.
        let create_domain_exit_error = |left: LeftDomain| {
            let allowed = "expected a smaller perturbation, which leaves the flow deforming";
            case.key_error("initial", StopCause::from(&left).to_string(), allowed)
        };
        if !recorder.is_resumed() {
            let fields = flow_run::assemble_perturbation(case, &self.problem)?;
            let [v1, v2] = &fields.velocity;
            simulation
                .perturb([v1, v2], &fields.internal_variable)
                .map_err(create_domain_exit_error)?;
        }
        let lines = match case.output.ledger_interval {
            0.0 => duration / DEFAULT_LEDGER_ROWS,
            seconds => seconds,
        };
        let output = create_output_times(lines, case.output.snapshot_interval, duration);
        run_with_recorder(self, simulation, &output, duration, recorder)
            .map(|found| self.create_result(found))
    }
}

impl FlowJob<'_> {
    fn create_result(&self, found: SimulationOutput<FlowAccount>) -> RunResult {
        let grid = &self.flow_run.grid;
        let energy = found.final_account.energy;
        let terms = vec![
            ("kinetic", energy.kinetic),
            ("at_start", found.final_account.initial_energy),
            ("background", energy.background_work),
            ("stress", energy.stress_work),
            ("balance", found.final_account.balance()),
            ("power", energy.internal_power),
        ];
        let receiver = |own: &crate::case::dynamics::ReceiverPoint<FlowQuantity>| {
            let point = grid.nearest_point(&own.position);
            let index = [point % grid.points[0], point / grid.points[0]];
            RunReceiver {
                name: own.name.clone(),
                position: own.position.clone(),
                cell_centre: None,
                interpolation: None,
                grid_point: Some([
                    grid.point_coordinate(0, index[0]),
                    grid.point_coordinate(1, index[1]),
                ]),
            }
        };
        RunResult {
            title: self.case.title.clone(),
            model: Some(self.case.material.kind.name()),
            solid_verdict: None,
            cell_counts: grid.points.to_vec(),
            box_lengths: Some(grid.lengths),
            step_count: found.step_count,
            time_step: None,
            final_time: found.final_time,
            precision: None,
            reconstruction: None,
            velocity_gradient: Some(self.problem.velocity_gradient),
            deformation_gradient: found.fields.deformation_gradient,
            has_field_values: found.has_field_values,
            fields: found.fields,
            final_ledger: FinalLedger { unit: energy_unit(self.case), terms },
            large_strain: None,
            joint_summary: None,
            receivers: self.flow_run.receivers.iter().map(receiver).collect(),
            stop_report: found.stop_report,
            records: found.records,
            is_part: false,
        }
    }
}

impl FlowJob<'_> {
    /// Converts output fields at a time, s, whose values `values` returns.
    fn convert_fields(
        &self,
        fields: &FlowFields,
        time: f64,
        values: impl Fn(&Vec<f64>) -> Vec<f64>,
    ) -> OutputFields {
        let grid = &self.flow_run.grid;
        let points =
            |axis| (0..grid.points[axis]).map(|i| grid.point_coordinate(axis, i)).collect();
        let named = self.quantities.iter().zip(&fields.values);
        OutputFields {
            time,
            coordinates: (0..2).map(points).collect(),
            deformation_gradient: Some(fields.deformation_gradient),
            quantities: named
                .map(|(own, all)| FieldQuantity::new(own.array_name().to_owned(), values(all)))
                .collect(),
            plastic_dissipation: Vec::new(),
            region_indices: Vec::new(),
            joint_faces: Vec::new(),
        }
    }
}

impl OutputConverter<FlowSimulation> for FlowJob<'_> {
    fn receiver_table(&self) -> Option<(TableHeader, Vec<usize>)> {
        let names: Vec<&str> = self.quantities.iter().map(|own| own.name()).collect();
        create_receiver_table(self.case, &self.flow_run.receivers, &names)
    }

    fn to_display_unit(&self, index: usize, value: f64) -> f64 {
        self.quantities[index % self.quantities.len()].to_display_unit(value)
    }

    fn account_tables(&self) -> Vec<TableHeader> {
        let header = ["time", "kinetic", "background", "stress", "balance", "power"];
        let ledger = header.map(str::to_owned).to_vec();
        let [most, across] = self.flow_run.grid.max_mode_numbers();
        let shells = (1..=most.max(across)).map(|shell| shell.to_string());
        let spectrum = ["time".to_owned()].into_iter().chain(shells).collect();
        let head = |kind, columns| TableHeader::new(self.case, kind, columns);
        vec![head(TableKind::Ledger, ledger), head(TableKind::Spectrum, spectrum)]
    }

    fn account_rows(&self, account: &FlowAccount) -> Vec<Vec<f64>> {
        let FlowEnergy {
            kinetic,
            background_work: background,
            stress_work: stress,
            internal_power: power,
        } = account.energy;
        let ledger = vec![account.time, kinetic, background, stress, account.balance(), power];
        let spectrum = [account.time].iter().chain(&account.energy_spectrum).copied().collect();
        vec![ledger, spectrum]
    }

    /// Fields of a flow are computed together.
    fn layers(&self, _simulation: &FlowSimulation) -> [usize; 2] {
        [1, self.flow_run.grid.point_count()]
    }

    fn convert_layers(
        &self,
        _simulation: &FlowSimulation,
        fields: &FlowFields,
        _layers: Range<usize>,
        time: f64,
    ) -> OutputFields {
        self.convert_fields(fields, time, Clone::clone)
    }

    fn describe_fields(
        &self,
        _simulation: &FlowSimulation,
        fields: &FlowFields,
        time: f64,
    ) -> OutputFields {
        self.convert_fields(fields, time, |_| Vec::new())
    }

    fn step_statistics(&self, simulation: &FlowSimulation, last: &FlowAccount) -> StepStatistics {
        let flow = simulation.flow();
        let [evaluations, iterations] = flow.evaluation_counts();
        StepStatistics::Flow {
            energy: last.energy.kinetic,
            stage_count: flow.stage_count(),
            evaluation_count: evaluations,
            iteration_count: iterations,
            thread_count: rayon::current_num_threads(),
        }
    }

    fn stop_report(&self, left: &LeftDomain, saved: f64) -> StopReport {
        StopReport { cause: left.into(), detection_time: left.time, last_valid_time: saved }
    }
}
