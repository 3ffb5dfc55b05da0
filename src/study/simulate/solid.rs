//! Simulation of a solid.

use super::cost::OutputVolume;
use super::observer::{
    OutputConverter, SimulationOutput, create_output_times, create_receiver_table,
    run_with_recorder,
};
use super::plan::snapshot_count;
use super::record::energy_unit;
use super::{
    Bytes, Cost, FieldQuantity, FinalLedger, IllPosedness, JointFace, JointSummary, OutputFields,
    ProblemSize, Recorder, RunReceiver, RunResult, SimulationJob, SimulationPlan,
    SimulationWarning, StepStatistics, StopCause, StopReport, TableHeader, TableKind,
};
use crate::Error;
use crate::case::dynamics::{
    Blocks, BoundaryConditionKind, BoundaryFace, DimensionalSplitting, FaceCondition, FaceLoad,
    Kernel, LedgerDetail as LedgerKind, LoadedArea, Precision, SolidRun, StateComponent,
    TimeFunction,
};
use crate::case::{Case, CaseError};
use crate::setup::solid_run::{
    SolidSetup, cell_centre, compute_time_steps, containing_cell, create_media, create_probe,
};
use dynamics::SolverReal;
use dynamics::domain::memory_bytes;
use dynamics::medium::Medium;
use dynamics::simulation::{
    Simulation as _, SolidAccount, SolidFault, SolidFields, SolidSimulation, SolverChoice,
    TimeSteps,
};

/// Default limit of the number of intervals between ledger rows.
const DEFAULT_LEDGER_ROWS: usize = 1000;

/// Memory of the program and its pictures, bytes.
const PROGRAM_MEMORY: f64 = 36.0 * 1048576.0;

/// Numbers that the solver stores, besides the fields, per pair of waves and line along the last axis in two dimensions,
/// or along the last two axes in three, by measurement: interface states and boundary values.
const NUMBERS_PER_LINE: f64 = 12.0;

/// Lanes that pad a row of lines, by measurement.
const PADDING_LANES: usize = 10;

/// Copies of a snapshot that are in memory while it is written, by measurement: interpolated, encoded and in buffers.
const SNAPSHOT_COPIES: f64 = 3.8;

/// Numbers that the output stores per face of a joint: state, position and ends.
const NUMBERS_PER_JOINT_FACE: f64 = 16.0;

/// Memory of a face of a joint in multiples of its output, by measurement: history variables, their copies for
/// checkpoints, lists of faces, and copies of the output while files and pictures are created.
const JOINT_COPIES: f64 = 9.4;

/// Numbers that a ledger with numerical dissipation (`TotalsAndDissipation`) keeps per field and cell, by measurement.
const FULL_LEDGER_NUMBERS: f64 = 1.0;

/// Simulation of a solid with its media.
pub(super) struct SolidJob<'a> {
    case: &'a Case,
    dynamics: &'a SolidRun,
    media: Vec<Medium>,
    /// Names of the output quantities of a cell in order: fields, then time integrals.
    quantity_names: Vec<String>,
}

impl<'a> SolidJob<'a> {
    pub(super) fn new(case: &'a Case, dynamics: &'a SolidRun) -> Result<Self, Error> {
        let media = create_media(case, dynamics)?;
        let fields = media[0].fields.iter().map(|field| StateComponent(*field).to_string());
        let integrals =
            dynamics.output.integrated_components.iter().filter_map(|own| own.integral_name());
        let names = fields.chain(integrals).collect();
        Ok(Self { case, dynamics, media, quantity_names: names })
    }

    /// Estimates the peak memory of a run, bytes: that of the program, of the solver, of its initial values and of its
    /// ledger, plus the copies of the fields for a checkpoint, for the results or for a snapshot, whichever is largest,
    /// plus all snapshots if `keeps_snapshots` is set.
    fn estimate_memory(&self, keeps_snapshots: bool) -> Bytes {
        let SolidRun { grid, output, scheme, initial_terms: initial, .. } = self.dynamics;
        let fields = self.media[0].fields.len();
        let (solver, number) = match scheme.precision {
            Precision::F64 => (memory_bytes::<f64>(&self.solver_cells(), fields), size_of::<f64>()),
            Precision::F32 => (memory_bytes::<f32>(&self.solver_cells(), fields), size_of::<f32>()),
        };
        let line_count = match self.solver_cells()[..] {
            [n1, _] => n1,
            [n1, n2, n3] => (n1 + PADDING_LANES) * (n2 + n3),
            _ => 0,
        };
        let pairs = self.media[0].pairs.iter().map(Vec::len).max().unwrap_or(0);
        let lines = NUMBERS_PER_LINE * (line_count * pairs * number) as f64;
        let wide = size_of::<f64>() as f64;
        let saved = (fields * number) as f64;
        let shown = wide * self.quantity_names.len() as f64;
        let checkpoint = 2.0 * saved + 2.0 * wide * output.integrated_components.len() as f64;
        let result = saved + shown;
        let snapshot = match output.snapshot_interval > 0.0 {
            true => SNAPSHOT_COPIES * wide * self.numbers_per_snapshot_cell() as f64,
            false => 0.0,
        };
        let ledger = match scheme.ledger_detail {
            LedgerKind::TotalsAndDissipation => FULL_LEDGER_NUMBERS * wide * fields as f64,
            LedgerKind::Totals => 0.0,
        };
        let kept = match keeps_snapshots {
            true => snapshot_count(output.snapshot_interval, self.dynamics.time.duration),
            false => 0.0,
        };
        let copies = checkpoint.max(result).max(snapshot)
            + kept * shown
            + ledger
            + wide * initial.len() as f64
            + size_of::<u16>() as f64;
        let joints = wide * NUMBERS_PER_JOINT_FACE * self.joint_face_count() as f64;
        let joint_copies = JOINT_COPIES + kept;
        Bytes(
            PROGRAM_MEMORY
                + solver
                + lines
                + grid.cell_count() as f64 * copies
                + joints * joint_copies,
        )
    }

    /// Returns the numbers of cells in the axis order of the solver, as
    /// [`Problem::first_axis`](dynamics::problem::Problem::first_axis) decides: in three dimensions with alternating
    /// splitting the last axis with a reflecting boundary is moved to the front.
    fn solver_cells(&self) -> Vec<usize> {
        let SolidRun { grid, scheme, .. } = self.dynamics;
        let mut cells = grid.cells.clone();
        if cells.len() == 3 && scheme.splitting == DimensionalSplitting::Alternating {
            let is_reflecting = |own: &FaceCondition| match own.condition {
                BoundaryConditionKind::Free
                | BoundaryConditionKind::Fixed
                | BoundaryConditionKind::Mixed { .. } => true,
                BoundaryConditionKind::Symmetry
                | BoundaryConditionKind::Antisymmetry
                | BoundaryConditionKind::Periodic
                | BoundaryConditionKind::NonReflecting => false,
            };
            let has_reflecting_face = |axis: &usize| {
                [false, true].into_iter().any(|is_upper| {
                    let face = BoundaryFace { axis: *axis, is_upper };
                    // From the last condition of the whole face on; a face without one is free.
                    let conditions = &self.dynamics.boundary_conditions;
                    let of_face: Vec<_> =
                        conditions.iter().filter(|own| own.face == face).collect();
                    let whole = of_face.iter().rposition(|own| own.rectangle.is_none());
                    whole.is_none_or(|whole| of_face[whole..].iter().any(|own| is_reflecting(own)))
                })
            };
            let first = (0..3).rev().find(has_reflecting_face).unwrap_or(0);
            cells[..=first].rotate_right(1);
        }
        cells
    }

    /// Returns the number of faces of joints.
    fn joint_face_count(&self) -> usize {
        let contacts = self.dynamics.blocks.iter().flat_map(|blocks| &blocks.contacts);
        contacts.filter(|own| own.joint.is_some()).map(|own| own.along.len()).sum()
    }

    /// Returns the numbers per cell in a snapshot: velocity vectors have three components, and yielding solids have a
    /// dissipation field.
    fn numbers_per_snapshot_cell(&self) -> usize {
        let yields = self.media.iter().any(|medium| medium.yield_set.is_some());
        self.quantity_names.len() + 3 - self.dynamics.grid.dimensions() + usize::from(yields)
    }
}

impl SolidJob<'_> {
    /// Estimates the cost of `steps` steps.
    fn estimate_cost(&self, steps: f64) -> Cost {
        let SolidRun { grid, output, time, scheme, receivers, .. } = self.dynamics;
        let count = grid.cell_count() as f64;
        let fields = self.media[0].fields.len() as f64;
        let lines = match output.ledger_interval {
            0.0 => steps.min(DEFAULT_LEDGER_ROWS as f64),
            seconds => steps.min(time.duration / seconds),
        };
        let columns: usize = receivers.iter().map(|own| own.fields.len()).sum();
        let row = if columns > 0 { 1.0 + columns as f64 } else { 0.0 };
        let joint_faces = self.joint_face_count() as f64;
        let written = OutputVolume {
            snapshots: snapshot_count(output.snapshot_interval, time.duration),
            numbers_per_snapshot: count * self.numbers_per_snapshot_cell() as f64
                + NUMBERS_PER_JOINT_FACE * joint_faces,
            // `joints.vtp` and `joints.npz` together are about as large as `joints.csv`.
            table_numbers: lines * 9.0 + steps * row + 2.0 * NUMBERS_PER_JOINT_FACE * joint_faces,
        };
        Cost::estimate_solid_cost(
            steps,
            count * fields,
            scheme.ledger_detail == LedgerKind::TotalsAndDissipation,
            written,
        )
    }
}

impl SimulationJob for SolidJob<'_> {
    fn plan(&self, keeps_snapshots: bool) -> Result<SimulationPlan, Error> {
        let (dynamics, media) = (self.dynamics, &self.media);
        let TimeSteps { count, step, limit, .. } = compute_time_steps(dynamics, media)?;
        let cells = dynamics.grid.cells.clone();
        let work = ProblemSize::Solid {
            cells,
            fields: media[0].fields.len(),
            steps: count,
            time_step: step,
            limit,
        };
        let memory = self.estimate_memory(keeps_snapshots);
        let plan = SimulationPlan { size: work, memory, cost: self.estimate_cost(count as f64) };
        plan.check_memory(|found| {
            let allowed = "ask for fewer cells, or for scheme.precision = \"f32\"";
            dynamics.error_at("grid.cells", found, allowed)
        })
    }

    fn refuse_excess(&self, plan: &SimulationPlan) -> Result<(), Error> {
        plan.cost.refuse_excess(|key, found, allowed| self.dynamics.error_at(key, found, allowed))
    }

    fn check_case(&self) -> Result<(), Error> {
        let media = self.media.clone();
        match self.dynamics.grid.dimensions() {
            2 => drop(SolidSetup::<2>::new(self.case, self.dynamics, media)?),
            _ => drop(SolidSetup::<3>::new(self.case, self.dynamics, media)?),
        }
        Ok(())
    }

    fn warnings(&self) -> Result<Vec<SimulationWarning>, Error> {
        const MIN_STEPS: f64 = 4.0;
        let step = compute_time_steps(self.dynamics, &self.media)?.step;
        let loads =
            self.dynamics.loads.iter().map(|load| ("load", &load.time_function)).enumerate();
        let sources =
            self.dynamics.sources.iter().map(|own| ("source", &own.time_function)).enumerate();
        let warning = |(index, (name, time)): (usize, (&str, &TimeFunction))| {
            let shortest = time.shortest_time_scale().filter(|time| *time < MIN_STEPS * step)?;
            let entry = format!("{name}[{index}]");
            Some(SimulationWarning::FewSteps { entry, steps: shortest / step })
        };
        let mut warnings: Vec<SimulationWarning> =
            loads.chain(sources).filter_map(warning).collect();
        if self.dynamics.time.courant_number == 1.0 {
            let loads = self.dynamics.loads.iter().enumerate();
            let of_load = |own: &FaceLoad| match &own.loaded_area {
                LoadedArea::Point { kernel, .. } => *kernel == Kernel::Cell,
                LoadedArea::WholeFace | LoadedArea::Rectangle(_) => false,
            };
            let loads = loads.filter(|own| of_load(own.1)).map(|own| ("load", own.0));
            let sources = self.dynamics.sources.iter().enumerate();
            let sources =
                sources.filter(|own| own.1.kernel == Kernel::Cell).map(|own| ("source", own.0));
            warnings.extend(loads.chain(sources).map(|(name, index)| {
                SimulationWarning::Sawtooth { entry: format!("{name}[{index}]") }
            }));
        }
        Ok(warnings)
    }

    fn find_ill_posedness(&self) -> Result<Option<IllPosedness>, Error> {
        // The solver accepts only elastic solids and associated ideal plasticity, whose equations are well-posed.
        Ok(None)
    }

    fn execute(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error> {
        match (self.dynamics.grid.dimensions(), self.dynamics.scheme.precision) {
            (2, Precision::F64) => self.run_simulation::<f64, 2>(recorder),
            (2, Precision::F32) => self.run_simulation::<f32, 2>(recorder),
            (_, Precision::F64) => self.run_simulation::<f64, 3>(recorder),
            (_, Precision::F32) => self.run_simulation::<f32, 3>(recorder),
        }
    }
}

/// Returns the number of steps between two ledger rows, at an interval of about `seconds`; at least 1.
fn steps_between_rows(seconds: f64, step: f64) -> usize {
    ((seconds / step).round() as usize).max(1)
}

impl SolidJob<'_> {
    fn run_simulation<T: SolverReal, const D: usize>(
        &self,
        recorder: &mut dyn Recorder,
    ) -> Result<RunResult, Error> {
        let dynamics = self.dynamics;
        let simulation = self.create_simulation::<T, D>()?;
        if let (false, Some(cell)) = (recorder.is_resumed(), simulation.first_beyond_yield()) {
            return Err(self.beyond_yield_error(cell).into());
        }
        let steps = simulation.time_steps();
        let lines = match dynamics.output.ledger_interval {
            0.0 => steps.count.div_ceil(DEFAULT_LEDGER_ROWS),
            seconds => steps_between_rows(seconds, steps.step),
        };
        let duration = dynamics.time.duration;
        let accounts = lines as f64 * steps.step;
        let output = create_output_times(accounts, dynamics.output.snapshot_interval, duration);
        let found = run_with_recorder(self, simulation, &output, duration, recorder)?;
        Ok(self.create_result(steps, found))
    }

    /// Creates the solver in its initial state.
    fn create_simulation<T: SolverReal, const D: usize>(
        &self,
    ) -> Result<SolidSimulation<T, D>, Error> {
        let dynamics = self.dynamics;
        let SolidSetup { problem, time_steps, initial_fields } =
            SolidSetup::<D>::new(self.case, dynamics, self.media.clone())?;
        let of_cell = &problem.cell_media;
        let probes =
            dynamics.receivers.iter().map(|own| create_probe(dynamics, of_cell, own)).collect();
        let solver = match dynamics.scheme.ledger_detail {
            LedgerKind::Totals => SolverChoice::Fused { threads: rayon::current_num_threads() },
            LedgerKind::TotalsAndDissipation => SolverChoice::Reference,
        };
        let simulation = SolidSimulation::new(problem, time_steps, initial_fields, probes, solver);
        Ok(simulation.map_err(|error| {
            dynamics.error_at("grid", error.to_string(), "see docs/case-file.md")
        })?)
    }

    /// Creates the error that the initial stress is beyond yield.
    fn beyond_yield_error(&self, cell: usize) -> CaseError {
        let place = cell_centre(self.dynamics, cell);
        let found = format!("a stress beyond yield in the cell at {place:?}");
        let allowed =
            "initial stresses, and those of [initial_stress] with them, within the yield set";
        self.dynamics.error_at("initial", found, allowed)
    }

    /// Returns the terms of the energy ledger, J, by name.
    fn ledger_terms(&self, account: &SolidAccount) -> Vec<(&'static str, f64)> {
        let SolidAccount { energy, ledger, .. } = account;
        let mut terms = vec![
            ("kinetic", energy.kinetic),
            ("stored", energy.stored),
            ("boundary_work", ledger.boundary_work),
            ("source_work", ledger.source_work),
            ("initial_stress_work", ledger.initial_stress_work),
            ("plastic_dissipation", ledger.plastic_dissipation),
        ];
        if self.dynamics.blocks.as_ref().is_some_and(Blocks::has_joints) {
            let losses = ledger.interlayer_losses;
            terms.extend([
                ("joint_kinetic", energy.interlayer_kinetic),
                ("joint_stored", energy.interlayer_stored),
                ("fluid_kinetic", energy.fluid_kinetic),
                ("fluid_stored", energy.fluid_stored),
                ("joint_plastic_dissipation", losses.plastic),
                ("joint_viscous_dissipation", losses.viscous),
                ("joint_released_energy", losses.released),
                ("joint_fracture_energy", losses.fracture),
                ("fluid_dissipation", losses.fluid),
            ]);
        }
        let is_full = self.dynamics.scheme.ledger_detail == LedgerKind::TotalsAndDissipation;
        if is_full {
            terms.push(("numerical_dissipation", ledger.numerical_dissipation));
        }
        terms.push((if is_full { "residual" } else { "balance" }, account.balance()));
        terms
    }

    fn create_result(&self, steps: TimeSteps, found: SimulationOutput<SolidAccount>) -> RunResult {
        let dynamics = self.dynamics;
        let mut terms = self.ledger_terms(&found.final_account);
        terms.insert(2, ("at_start", found.final_account.initial_energy));
        let receiver = |own: &crate::case::dynamics::ReceiverPoint<_>| RunReceiver {
            name: own.name.clone(),
            position: own.position.clone(),
            cell_centre: Some(cell_centre(dynamics, containing_cell(dynamics, &own.position))),
            interpolation: Some(own.interpolation.name()),
            grid_point: None,
        };
        RunResult {
            title: self.case.title.clone(),
            model: None,
            cells: dynamics.grid.cells.clone(),
            box_lengths: None,
            steps: found.steps,
            time_step: Some(steps.step),
            time: found.time,
            precision: Some(dynamics.scheme.precision.name()),
            order: Some(dynamics.scheme.reconstruction.name()),
            velocity_gradient: None,
            deformation: None,
            joints: JointSummary::new(&found.fields.joints),
            fields: found.fields,
            ledger: FinalLedger { unit: energy_unit(self.case), terms },
            receivers: dynamics.receivers.iter().map(receiver).collect(),
            stop_report: found.stop_report,
            records: found.records,
        }
    }
}

impl<T: SolverReal, const D: usize> OutputConverter<SolidSimulation<T, D>> for SolidJob<'_> {
    fn receiver_table(&self) -> Option<(TableHeader, Vec<usize>)> {
        create_receiver_table(self.case, &self.dynamics.receivers, &self.quantity_names)
    }

    fn account_tables(&self) -> Vec<TableHeader> {
        let terms = self.ledger_terms(&SolidAccount::default());
        let names = std::iter::once("time").chain(terms.into_iter().map(|term| term.0));
        let header = names.map(str::to_owned).collect();
        vec![TableHeader::new(self.case, TableKind::Ledger, header)]
    }

    fn account_rows(&self, account: &SolidAccount) -> Vec<Vec<f64>> {
        let terms = self.ledger_terms(account).into_iter();
        vec![std::iter::once(account.time).chain(terms.map(|term| term.1)).collect()]
    }

    fn convert_fields(
        &self,
        simulation: &SolidSimulation<T, D>,
        fields: SolidFields,
        time: f64,
    ) -> OutputFields {
        let grid = &self.dynamics.grid;
        let middles = |axis| (0..grid.cells[axis]).map(|i| grid.cell_centre(axis, i)).collect();
        let has_regions =
            self.dynamics.materials().len() > usize::from(self.dynamics.blocks.is_some());
        let joint = |(face, record)| JointFace::new(grid, &face, record);
        let named = self.quantity_names.iter().zip(fields.values);
        OutputFields {
            time,
            coordinates: (0..grid.dimensions()).map(middles).collect(),
            deformation: None,
            quantities: named.map(|(name, own)| FieldQuantity::new(name.clone(), own)).collect(),
            dissipation: fields.plastic_dissipation,
            regions: match has_regions {
                true => simulation.problem().cell_media.clone(),
                false => Vec::new(),
            },
            joints: fields.interlayers.into_iter().map(joint).collect(),
        }
    }

    fn step_statistics(
        &self,
        simulation: &SolidSimulation<T, D>,
        _last: &SolidAccount,
    ) -> StepStatistics {
        StepStatistics::Solid {
            energy: simulation.account().energy.total(),
            cells: simulation.problem().grid.count(),
            threads: simulation.threads(),
        }
    }

    fn stop_report(&self, fault: &SolidFault, saved: f64) -> StopReport {
        let cause = match fault.location {
            Some((field, cell)) => {
                StopCause::NonFiniteField { field, cell_centre: cell_centre(self.dynamics, cell) }
            }
            None => StopCause::NonFiniteEnergy,
        };
        StopReport { cause, time: fault.time, last_valid_time: saved }
    }
}
