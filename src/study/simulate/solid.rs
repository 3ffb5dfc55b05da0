//! Simulation of a solid.

mod memory;

use super::cost::OutputVolume;
use super::derived_fields::{add_volumetric_strain, find_largest_strain, porosity};
use super::observer::{
    OutputConverter, SimulationOutput, create_output_times, create_receiver_table,
    run_with_recorder,
};
use super::plan::snapshot_count;
use super::recorder::energy_unit;
use super::{
    Cost, FieldQuantity, FinalLedger, IllPosedness, JointFace, JointSummary, OutputFields,
    OutputPart, ProblemSize, Recorder, RunReceiver, RunResult, SimulationJob, SimulationPlan,
    SimulationWarning, StepStatistics, StopCause, StopReport, TableHeader, TableKind,
};
use crate::Error;
use crate::case::dynamics::{
    Blocks, CourantWaves, FaceLoad, Kernel, LedgerDetail, LoadedArea, Precision, SolidRun,
    StateComponent, TimeFunction,
};
use crate::case::{Case, CaseError};
use crate::setup::solid_run::{
    SolidSetup, cell_centre, compute_time_steps, create_media, create_probe, find_containing_cell,
};
use crate::study::decide_solid_verdict;
use dynamics::SolverReal;
use dynamics::decomposition::communicator::Communicator;
use dynamics::medium::Medium;
use dynamics::simulation::{
    Simulation as _, SolidAccount, SolidFault, SolidFields, SolidSimulation, SolverChoice,
    StepFraction, TimeSteps,
};
use models::common::decimal::ToPlainText;
use std::ops::Range;
use std::sync::Arc;

/// Default limit of the number of intervals between ledger rows.
const DEFAULT_LEDGER_ROWS: usize = 1000;

/// Number of values that the output stores per face of a joint: state, position and ends.
const NUMBERS_PER_JOINT_FACE: f64 = 16.0;

/// Simulation of a solid, with its case and the media of its regions or blocks.
pub(super) struct SolidJob<'a> {
    pub(super) case: &'a Case,
    pub(super) solid_run: &'a SolidRun,
    pub(super) media: Vec<Medium>,
    /// Names of the output quantities of a cell in order: fields, then time integrals.
    quantity_names: Vec<String>,
}

impl<'a> SolidJob<'a> {
    pub(super) fn new(case: &'a Case, solid_run: &'a SolidRun) -> Result<Self, Error> {
        let media = create_media(case, solid_run)?;
        let state_fields = Medium::state_fields(&media);
        let fields = state_fields.iter().map(|field| StateComponent(*field).to_string());
        let integrals =
            solid_run.output.integrated_components.iter().filter_map(|own| own.integral_name());
        let names = fields.chain(integrals).collect();
        Ok(Self { case, solid_run, media, quantity_names: names })
    }

    fn yields(&self) -> bool {
        self.media.iter().any(|medium| medium.is_plastic())
    }

    /// Returns the number of faces of all joints.
    fn joint_face_count(&self) -> usize {
        let contacts = self.solid_run.blocks.iter().flat_map(|blocks| &blocks.contacts);
        contacts.filter(|own| own.joint_index.is_some()).map(|own| own.tangential_cells.len()).sum()
    }

    /// Returns the number of values per cell in a snapshot: velocity vectors have three components, and yielding solids
    /// have a dissipation field.
    fn numbers_per_snapshot_cell(&self) -> usize {
        self.quantity_names.len() + 3 - self.solid_run.grid.dimensions()
            + usize::from(self.yields())
    }
}

impl SolidJob<'_> {
    /// Estimates the cost of `steps` time steps.
    fn estimate_cost(&self, steps: f64) -> Cost {
        let SolidRun { grid, output, time, scheme, receivers, .. } = self.solid_run;
        let count = grid.cell_count() as f64;
        let fields = Medium::state_fields(&self.media).len() as f64;
        let lines = match output.ledger_interval {
            0.0 => steps.min(DEFAULT_LEDGER_ROWS as f64),
            seconds => steps.min(time.duration / seconds),
        };
        let columns: usize = receivers.iter().map(|own| own.fields.len()).sum();
        let row = if columns > 0 { 1.0 + columns as f64 } else { 0.0 };
        let joint_faces = self.joint_face_count() as f64;
        let written = OutputVolume {
            snapshot_count: snapshot_count(output.snapshot_interval, time.duration),
            numbers_per_snapshot: count * self.numbers_per_snapshot_cell() as f64
                + NUMBERS_PER_JOINT_FACE * joint_faces,
            // `joints.vtp` and `joints.npz` together are about as large as `joints.csv`.
            numbers_in_tables: lines * 9.0
                + steps * row
                + 2.0 * NUMBERS_PER_JOINT_FACE * joint_faces,
        };
        Cost::estimate_solid_cost(
            steps,
            count * fields,
            scheme.ledger_detail == LedgerDetail::TotalsAndDissipation,
            written,
        )
    }
}

impl SimulationJob for SolidJob<'_> {
    fn plan(&self, keeps_snapshots: bool, rank_count: usize) -> Result<SimulationPlan, Error> {
        let (solid_run, media) = (self.solid_run, &self.media);
        let TimeSteps { count, step, limit, shear_interval, .. } =
            compute_time_steps(solid_run, media)?;
        let cells = solid_run.grid.cells.clone();
        let work = ProblemSize::Solid {
            cell_counts: cells,
            field_count: Medium::state_fields(media).len(),
            step_count: count,
            time_step: step,
            step_limit: limit,
            shear_interval,
        };
        let memory = self.estimate_memory(keeps_snapshots, [1.0 / rank_count as f64; 2]);
        let plan = SimulationPlan {
            problem_size: work,
            rank_count,
            required_memory: memory,
            cost: self.estimate_cost(count as f64),
        };
        plan.check_memory(|found| {
            let allowed = "ask for fewer cells, or for scheme.precision = \"f32\"";
            solid_run.key_error("grid.cells", found, allowed)
        })
    }

    fn refuse_excess(&self, plan: &SimulationPlan) -> Result<(), Error> {
        plan.cost.refuse_excess(|key, found, allowed| self.solid_run.key_error(key, found, allowed))
    }

    fn check_case(&self) -> Result<(), Error> {
        let media = self.media.clone();
        let solver = SolverChoice::Fused { threads: 1 };
        match self.solid_run.grid.dimensions() {
            2 => drop(SolidSetup::<2>::new(self.case, self.solid_run, media, &solver)?),
            _ => drop(SolidSetup::<3>::new(self.case, self.solid_run, media, &solver)?),
        }
        Ok(())
    }

    fn find_warnings(&self) -> Result<Vec<SimulationWarning>, Error> {
        const MIN_STEPS_PER_TIME_SCALE: f64 = 4.0;
        /// Largest number of rows of cells of a column, in which waves are plane.
        const MAX_ROWS_OF_COLUMN: usize = 4;
        let step = compute_time_steps(self.solid_run, &self.media)?.step;
        let loads =
            self.solid_run.loads.iter().map(|load| ("load", &load.time_function)).enumerate();
        let sources =
            self.solid_run.sources.iter().map(|own| ("source", &own.time_function)).enumerate();
        let warning = |(index, (name, time)): (usize, (&str, &TimeFunction))| {
            let shortest = time
                .shortest_time_scale()
                .filter(|time| *time < MIN_STEPS_PER_TIME_SCALE * step)?;
            let entry = format!("{name}[{index}]");
            Some(SimulationWarning::FewSteps {
                entry_key: entry,
                steps_per_time_scale: shortest / step,
            })
        };
        let mut warnings: Vec<SimulationWarning> =
            loads.chain(sources).filter_map(warning).collect();
        let wide_axes =
            self.solid_run.grid.cells.iter().filter(|count| **count > MAX_ROWS_OF_COLUMN);
        if self.solid_run.time.courant_waves == CourantWaves::Shear && wide_axes.count() > 1 {
            warnings.push(SimulationWarning::ObliqueWaves);
        }
        if self.solid_run.time.courant_number == 1.0 {
            let loads = self.solid_run.loads.iter().enumerate();
            let of_load = |own: &FaceLoad| match &own.loaded_area {
                LoadedArea::Point { kernel, .. } => *kernel == Kernel::Cell,
                LoadedArea::WholeFace | LoadedArea::Rectangle(_) => false,
            };
            let loads = loads.filter(|own| of_load(own.1)).map(|own| ("load", own.0));
            let sources = self.solid_run.sources.iter().enumerate();
            let sources =
                sources.filter(|own| own.1.kernel == Kernel::Cell).map(|own| ("source", own.0));
            warnings.extend(loads.chain(sources).map(|(name, index)| {
                SimulationWarning::Sawtooth { entry_key: format!("{name}[{index}]") }
            }));
        }
        Ok(warnings)
    }

    fn find_ill_posedness(&self) -> Result<Option<IllPosedness>, Error> {
        // The solver accepts only elastic solids and associated ideal plasticity, whose equations are well-posed.
        Ok(None)
    }

    fn execute(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error> {
        match (self.solid_run.grid.dimensions(), self.solid_run.scheme.precision) {
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
        let solid_run = self.solid_run;
        let ranks = (recorder.communicator(), recorder.is_resumed());
        let simulation = self.create_simulation::<T, D>(ranks)?;
        if let (false, Some(cell)) =
            (recorder.is_resumed(), simulation.first_cell_outside_yield_set())
        {
            return Err(self.create_beyond_yield_error(cell).into());
        }
        let steps = simulation.time_steps();
        let lines = match solid_run.output.ledger_interval {
            0.0 => steps.count.div_ceil(DEFAULT_LEDGER_ROWS),
            seconds => steps_between_rows(seconds, steps.step),
        };
        let duration = solid_run.time.duration;
        let accounts = lines as f64 * steps.step;
        let output = create_output_times(accounts, solid_run.output.snapshot_interval, duration);
        let found = run_with_recorder(self, simulation, &output, duration, recorder)?;
        let mut result = self.create_result(steps, found);
        if let Some(communicator) = recorder.communicator() {
            result.is_part = communicator.size() > 1;
            result.combine_ranks(&*communicator);
        }
        Ok(result)
    }

    /// Creates the solver with the initial state of the case; with several ranks, its part of this one. A resumed run may
    /// have another number of ranks than parts in the case.
    fn create_simulation<T: SolverReal, const D: usize>(
        &self,
        (communicator, is_resumed): (Option<Arc<dyn Communicator>>, bool),
    ) -> Result<SolidSimulation<T, D>, Error> {
        let solid_run = self.solid_run;
        let threads = rayon::current_num_threads();
        let solver = match (solid_run.scheme.ledger_detail, communicator) {
            (LedgerDetail::TotalsAndDissipation, _) => SolverChoice::Reference,
            (LedgerDetail::Totals, Some(communicator)) if communicator.size() > 1 => {
                let fits = |own: &Vec<usize>| {
                    !is_resumed || own.iter().product::<usize>() == communicator.size()
                };
                let parts = solid_run.part_counts.clone().filter(fits);
                SolverChoice::Ranks { communicator, threads, parts }
            }
            (LedgerDetail::Totals, _) => SolverChoice::Fused { threads },
        };
        let SolidSetup { problem, time_steps, initial_fields } =
            SolidSetup::<D>::new(self.case, solid_run, self.media.clone(), &solver)?;
        let medium_index = |cell| problem.medium_index(cell);
        let receivers = solid_run.receivers.iter();
        let probes = receivers.map(|own| create_probe(solid_run, medium_index, own)).collect();
        let simulation = SolidSimulation::new(problem, time_steps, initial_fields, probes, solver);
        Ok(simulation.map_err(|error| {
            solid_run.key_error("grid", error.to_string(), "see docs/case-file.md")
        })?)
    }

    /// Creates the error that the initial stress is outside the yield set.
    fn create_beyond_yield_error(&self, cell: usize) -> CaseError {
        let place = cell_centre(self.solid_run, cell);
        let found =
            format!("a stress beyond yield in the cell at {place}", place = place.to_plain_text());
        let allowed =
            "initial stresses, and those of [initial_stress] with them, within the yield set";
        self.solid_run.key_error("initial", found, allowed)
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
        if self.solid_run.blocks.as_ref().is_some_and(Blocks::has_joints) {
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
        let is_full = self.solid_run.scheme.ledger_detail == LedgerDetail::TotalsAndDissipation;
        if is_full {
            terms.push(("numerical_dissipation", ledger.numerical_dissipation));
        }
        terms.push((if is_full { "residual" } else { "balance" }, account.balance()));
        terms
    }

    fn create_result(&self, steps: TimeSteps, found: SimulationOutput<SolidAccount>) -> RunResult {
        let solid_run = self.solid_run;
        const MAX_SMALL_STRAIN: f64 = 1.0;
        let strain = found.largest_strain;
        let large_strain = (strain > MAX_SMALL_STRAIN && strain.is_finite()).then_some(strain);
        let mut terms = self.ledger_terms(&found.final_account);
        terms.insert(2, ("at_start", found.final_account.initial_energy));
        let receiver = |own: &crate::case::dynamics::ReceiverPoint<_>| RunReceiver {
            name: own.name.clone(),
            position: own.position.clone(),
            cell_centre: Some(cell_centre(
                solid_run,
                find_containing_cell(solid_run, &own.position),
            )),
            interpolation: Some(own.interpolation.name()),
            grid_point: None,
        };
        RunResult {
            title: self.case.title.clone(),
            model: None,
            solid_verdict: decide_solid_verdict(self.case),
            cell_counts: solid_run.grid.cells.clone(),
            box_lengths: None,
            step_count: found.step_count,
            time_step: Some(steps.step),
            final_time: found.final_time,
            precision: Some(solid_run.scheme.precision.name()),
            reconstruction: Some(solid_run.scheme.reconstruction.name()),
            velocity_gradient: None,
            deformation_gradient: None,
            joint_summary: JointSummary::new(&found.fields.joint_faces),
            fields: found.fields,
            final_ledger: FinalLedger { unit: energy_unit(self.case), terms },
            large_strain,
            receivers: solid_run.receivers.iter().map(receiver).collect(),
            stop_report: found.stop_report,
            records: found.records,
            is_part: false,
            has_field_values: found.has_field_values,
        }
    }

    /// Returns the coordinates along each axis of the cells of some layers of this process, m.
    fn cell_centres<T: SolverReal, const D: usize>(
        &self,
        simulation: &SolidSimulation<T, D>,
        layers: &Range<usize>,
    ) -> Vec<Vec<f64>> {
        let mut cells = simulation.own_cells().clone();
        let first = cells[D - 1].start;
        cells[D - 1] = first + layers.start..first + layers.end;
        let centre = |axis: usize, index| self.solid_run.grid.cell_centre(axis, index);
        let along = cells.into_iter().enumerate();
        along.map(|(axis, own)| own.map(|index| centre(axis, index)).collect()).collect()
    }

    /// Converts the output fields of the cells of some layers of this process at a time, s.
    fn convert_cells<T: SolverReal, const D: usize>(
        &self,
        simulation: &SolidSimulation<T, D>,
        (layers, fields): (Range<usize>, SolidFields),
        time: f64,
    ) -> OutputFields {
        let grid = &self.solid_run.grid;
        let has_regions =
            self.solid_run.materials().len() > usize::from(self.solid_run.blocks.is_some());
        let joint = |(face, record)| JointFace::new(grid, &face, record);
        let named = self.quantity_names.iter().zip(fields.values);
        let mut quantities: Vec<FieldQuantity> =
            named.map(|(name, own)| FieldQuantity::new(name.clone(), own)).collect();
        // Indices of media fit u16.
        let cell_media: Vec<u16> =
            simulation.cell_media_in(layers.clone()).map(|own| own as u16).collect();
        quantities.extend(porosity(&self.media, &cell_media, &quantities));
        add_volumetric_strain(&self.media, &cell_media, &mut quantities);
        OutputFields {
            time,
            coordinates: self.cell_centres(simulation, &layers),
            deformation_gradient: None,
            quantities,
            plastic_dissipation: fields.plastic_dissipation,
            region_indices: if has_regions { cell_media } else { Vec::new() },
            joint_faces: fields.interlayers.into_iter().map(joint).collect(),
        }
    }
}

impl<T: SolverReal, const D: usize> OutputConverter<SolidSimulation<T, D>> for SolidJob<'_> {
    fn receiver_table(&self) -> Option<(TableHeader, Vec<usize>)> {
        create_receiver_table(self.case, &self.solid_run.receivers, &self.quantity_names)
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

    fn layers(&self, simulation: &SolidSimulation<T, D>) -> [usize; 2] {
        [simulation.own_cells()[D - 1].len(), simulation.layer_size()]
    }

    fn convert_layers(
        &self,
        simulation: &SolidSimulation<T, D>,
        _fields: &StepFraction,
        layers: Range<usize>,
        time: f64,
    ) -> OutputFields {
        let fields = simulation.fields_in(layers.clone());
        self.convert_cells(simulation, (layers, fields), time)
    }

    fn describe_fields(
        &self,
        simulation: &SolidSimulation<T, D>,
        _fields: &StepFraction,
        time: f64,
    ) -> OutputFields {
        let interlayers = simulation.interlayer_records();
        let [layer_count, _] = self.layers(simulation);
        let fields = SolidFields { interlayers, ..simulation.fields_in(0..0) };
        let coordinates = self.cell_centres(simulation, &(0..layer_count));
        OutputFields { coordinates, ..self.convert_cells(simulation, (0..0, fields), time) }
    }

    fn step_fraction(&self, StepFraction(fraction): &StepFraction) -> Option<f64> {
        (*fraction < 1.0).then_some(*fraction)
    }

    fn find_largest_strain(&self, fields: &OutputFields) -> f64 {
        find_largest_strain(&self.media, fields)
    }

    fn find_part(&self, simulation: &SolidSimulation<T, D>) -> Option<OutputPart> {
        let state = simulation.state_part()?;
        Some(OutputPart { state, cells: simulation.own_cells().to_vec() })
    }

    fn step_statistics(
        &self,
        simulation: &SolidSimulation<T, D>,
        _last: &SolidAccount,
    ) -> StepStatistics {
        StepStatistics::Solid {
            energy: simulation.account().energy.total(),
            cell_count: simulation.problem().grid.count(),
            thread_count: simulation.threads(),
        }
    }

    fn stop_report(&self, fault: &SolidFault, saved: f64) -> StopReport {
        let cause = match fault.location {
            Some((field, cell)) => {
                StopCause::NonFiniteField { field, cell_centre: cell_centre(self.solid_run, cell) }
            }
            None => StopCause::NonFiniteEnergy,
        };
        StopReport { cause, detection_time: fault.time, last_valid_time: saved }
    }
}
