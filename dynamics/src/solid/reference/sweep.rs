//! Sweep along an axis: line by line with ghosts, wave pair by wave pair.

use super::{Reference, lane_index};
use crate::simd::Real;
use crate::solid::cell::CellConstants;
use crate::solid::domain::SolverReal;
use crate::solid::ghosts::{
    BoundaryFaces, CLOSURE_CELLS, GhostCoefficients, compute_ghosts, image, set_times,
};
use crate::solid::interface::{LineState, sweep_with_interlayers};
use crate::solid::interlayers::with_pair_count;
use crate::solid::line::{self, SweepAccount};
use crate::solid::problem::Problem;
use crate::solid::reconstruction::{MAX_GHOSTS, Slopes};
use crate::solid::riemann::State;
use models::interface::Interval;
use models::solid::waves::SolidField;

/// A wave pair along an axis, with its constants by medium.
#[derive(Clone)]
pub(super) struct ReferenceWavePair<T: Real> {
    /// Cell length along the axis, m; `step_fraction`: fraction of a time step per sweep.
    spacing: f64,
    step_fraction: f64,
    /// Indices of velocity and stress of the pair among the fields.
    pub(super) velocity: usize,
    pub(super) stress: usize,
    /// Cell constants by medium.
    pub(super) cells: Vec<CellConstants<T>>,
    ghost_coefficients: Vec<GhostCoefficients<T>>,
    /// Field indices of the passive stresses, which any medium couples to the pair, and by medium the coupling ratio
    /// ds′/ds of the passive stress s′ to the stress s of the pair.
    pub(super) passive_stresses: Vec<(usize, Vec<T>)>,
}

impl<T: Real> ReferenceWavePair<T> {
    /// Creates a wave pair along an axis with cell length `spacing`, m, and sweeps of `step_fraction` of the time step.
    pub(super) fn new<const D: usize>(
        problem: &Problem<D>,
        (axis, spacing): (usize, f64),
        pair: usize,
        step_fraction: f64,
    ) -> Self {
        let Problem { media, scheme, step, .. } = problem;
        let fields = &media[0].fields;
        let field_index =
            |field: SolidField| fields.iter().position(|own| *own == field).unwrap_or(0);
        let pairs = || media.iter().map(|medium| &medium.pairs[axis][pair]);
        let mut passive_indices: Vec<usize> = pairs()
            .flat_map(|own| &own.passive_stresses)
            .map(|(field, _)| field_index(*field))
            .collect();
        passive_indices.sort_unstable();
        passive_indices.dedup();
        let passive = |index: usize| {
            let ratio = |own: &models::solid::waves::VelocityStressPair| {
                let found = own.passive_stresses.iter().find(|own| own.0 == fields[index]);
                T::from_f64(found.map_or(0.0, |own| own.1))
            };
            (index, pairs().map(ratio).collect())
        };
        let cell = |own: &models::solid::waves::VelocityStressPair| {
            let courant = own.speed() * (step_fraction * step / spacing);
            scheme.slopes.cell_constants(own, courant, problem.has_interfaces())
        };
        let cells: Vec<CellConstants<T>> = pairs().map(cell).collect();
        Self {
            spacing,
            step_fraction,
            velocity: field_index(media[0].pairs[axis][pair].velocity),
            stress: field_index(media[0].pairs[axis][pair].stress),
            ghost_coefficients: cells.iter().map(GhostCoefficients::new).collect(),
            cells,
            passive_stresses: passive_indices.into_iter().map(passive).collect(),
        }
    }
}

/// A line of cells along an axis.
#[derive(Clone, Copy)]
pub(super) struct GridLine {
    pub(super) axis: usize,
    /// Index of the first cell of the line.
    pub(super) first: usize,
    /// Difference of the indices of successive cells.
    pub(super) stride: usize,
    /// Number of cells of the line.
    pub(super) count: usize,
    /// Index of the line among the faces of its boundaries.
    pub(super) face: usize,
}

impl GridLine {
    pub(super) fn cell(&self, index: usize) -> usize {
        self.first + index * self.stride
    }

    /// Returns the position in the line of the cell at a depth (0: outermost cell) from an end; it wraps around if the
    /// line has no more than `depth` cells.
    pub(super) fn index_from_end(&self, end: usize, depth: usize) -> usize {
        [depth % self.count, self.count - 1 - depth % self.count][end]
    }
}

/// Velocities, stresses and constants of a wave pair along a line, ghosts included, and the accounts of its cells.
pub(super) struct LineFields<T> {
    pub(super) velocity: Vec<T>,
    pub(super) stress: Vec<T>,
    pub(super) cells: Vec<CellConstants<T>>,
    pub(super) accounts: Vec<SweepAccount>,
}

impl<T: Real> LineFields<T> {
    pub(super) fn new() -> Self {
        Self { velocity: Vec::new(), stress: Vec::new(), cells: Vec::new(), accounts: Vec::new() }
    }

    fn push(&mut self, (state, cell): (State<T>, CellConstants<T>)) {
        self.velocity.push(state.velocity);
        self.stress.push(state.stress);
        self.cells.push(cell);
    }
}

/// Returns the states of a line by wave pair; `None` if there are not `P` pairs.
fn line_states<T: Real, const P: usize>(
    line_fields: &mut [LineFields<T>],
) -> Option<[LineState<'_, T>; P]> {
    let states = line_fields.iter_mut().map(|own| LineState {
        velocity: &mut own.velocity,
        stress: &mut own.stress,
        cells: &own.cells,
        accounts: Some(&mut own.accounts),
    });
    states.collect::<Vec<_>>().try_into().ok()
}

impl<T: SolverReal, const D: usize> Reference<T, D> {
    /// Sweeps by half a step along an axis; `times`: times at which boundary values of longitudinal and of other waves
    /// are taken, and time at the end of the sweep, s.
    pub(super) fn sweep(&mut self, axis: usize, times: ([f64; 2], f64)) {
        if self.shear_steps.relative_duration(self.steps) == 0.0 {
            let waves = std::mem::take(&mut self.held_shear_waves[axis]);
            self.sweep_axis(axis, |_| &waves, times);
            self.held_shear_waves[axis] = waves;
            return;
        }
        let waves = std::mem::take(&mut self.waves[axis]);
        let waves_by_layer = std::mem::take(&mut self.waves_by_layer);
        self.sweep_axis(
            axis,
            |row| waves_by_layer.get(row).filter(|_| axis == 0).unwrap_or(&waves),
            times,
        );
        (self.waves[axis], self.waves_by_layer) = (waves, waves_by_layer);
    }

    /// Sweeps by a quarter of a step along the first axis; `times` as for [`Self::sweep`].
    pub(super) fn sweep_quarter_step(&mut self, times: ([f64; 2], f64)) {
        let waves = std::mem::take(&mut self.quarter_step_waves);
        self.sweep_axis(0, |_| &waves, times);
        self.quarter_step_waves = waves;
    }

    /// Sweeps along an axis; `times` as for [`Self::sweep`]; `waves` returns the wave pairs of a line, given its face
    /// index.
    fn sweep_axis<'a>(
        &mut self,
        axis: usize,
        waves: impl Fn(usize) -> &'a Vec<ReferenceWavePair<T>>,
        (middles, end): ([f64; 2], f64),
    ) {
        set_times(&mut self.boundaries[axis], middles);
        let mut line_fields = Vec::new();
        let [length, layer] = [self.problem.grid.cells[0], self.problem.grid.faces(D - 1)];
        let count = self.problem.grid.cells[axis];
        let faces = self.problem.grid.faces(axis);
        // Strides between cells along the axis and between rows of lines, and number of lines per row.
        let (stride, next, lines) = match axis {
            0 => (1, length, 1),
            _ if axis + 1 == D => (layer, length, length),
            _ => (length, layer, length),
        };
        for face in 0..faces {
            let first = face / lines * next + face % lines;
            let line = GridLine { axis, first, stride, count, face };
            let waves = waves(face);
            line_fields.resize_with(waves.len(), LineFields::new);
            self.sweep_line(line, waves, &mut line_fields, end);
        }
    }

    /// Sweeps a line; `end`: time at the end of the sweep, s.
    fn sweep_line(
        &mut self,
        line: GridLine,
        waves: &[ReferenceWavePair<T>],
        line_fields: &mut [LineFields<T>],
        end: f64,
    ) {
        let boundaries = &self.boundaries[line.axis];
        let mut powers = vec![[0.0; 2]; waves.len()];
        for (pair, wave) in waves.iter().enumerate() {
            let line_fields = &mut line_fields[pair];
            self.fill_line(line_fields, line, (pair, wave), boundaries);
            powers[pair] = [0, 1].map(|end| self.boundary_power(line_fields, line, pair, end));
            line_fields.accounts.clear();
            line_fields.accounts.resize(line.count, SweepAccount::default());
        }
        if !self.contact_faces[line.axis].is_empty() {
            self.sweep_line_with_contacts(line, line_fields);
        } else if self.interlayers.has_interlayers_across(line.axis) {
            let mut interlayers = self.interlayers.line_interlayers(line);
            let step = 0.5 * self.problem.step;
            let relative_duration = self.shear_steps.relative_duration(self.steps);
            let holds_shear = relative_duration == 0.0;
            let interval = Interval {
                end: T::from_f64(end),
                step: T::from_f64(step),
                tangential_step: T::from_f64(step * relative_duration.max(1.0)),
            };
            with_pair_count!(waves.len(), P => {
                if let Some(lines) = line_states::<T, P>(line_fields) {
                    sweep_with_interlayers(lines, self.slopes, &mut interlayers, &interval);
                }
            });
            self.interlayers.store_line(line, &interlayers, holds_shear);
        } else {
            for own in line_fields.iter_mut() {
                let LineFields { velocity, stress, cells, accounts } = own;
                line::sweep(velocity, stress, cells, self.slopes, Some(accounts));
            }
        }
        for ((wave, line_fields), powers) in waves.iter().zip(line_fields).zip(powers) {
            let time = wave.step_fraction * self.problem.step;
            // Accounts are powers per area: the factor is area times duration, m² s.
            let face_time = self.problem.grid.volume() / wave.spacing * time;
            let ghosts = self.slopes.ghosts();
            for position in 0..line.count {
                let cell = line.cell(position);
                let medium = usize::from(self.problem.cell_media[cell]);
                let change = line_fields.stress[ghosts + position] - self.fields[wave.stress][cell];
                self.fields[wave.velocity][cell] = line_fields.velocity[ghosts + position];
                self.fields[wave.stress][cell] = line_fields.stress[ghosts + position];
                for (index, ratios) in &wave.passive_stresses {
                    let value = &mut self.fields[*index][cell];
                    *value = *value + ratios[medium] * change;
                }
                self.work
                    .numerical_dissipation
                    .add(face_time * line_fields.accounts[position].dissipation);
            }
            for work in powers.into_iter().filter(|work| *work != 0.0) {
                self.work.boundary_work.add(face_time * work);
            }
        }
    }

    /// Fills `line_fields` with velocities, stresses and constants of a wave pair along a line, ghosts included.
    pub(super) fn fill_line(
        &self,
        line_fields: &mut LineFields<T>,
        line: GridLine,
        wave: (usize, &ReferenceWavePair<T>),
        boundaries: &[BoundaryFaces<T>; 2],
    ) {
        line_fields.velocity.clear();
        line_fields.stress.clear();
        line_fields.cells.clear();
        let [front, back] = [0, 1].map(|end| self.compute_end_ghosts(line, wave, boundaries, end));
        let ghosts = self.slopes.ghosts();
        front[..ghosts].iter().rev().for_each(|own| line_fields.push(*own));
        (0..line.count)
            .for_each(|position| line_fields.push(self.read_cell(line, wave.1, position)));
        back[..ghosts].iter().for_each(|own| line_fields.push(*own));
    }

    /// Returns state and constants of a cell of a line.
    fn read_cell(
        &self,
        line: GridLine,
        wave: &ReferenceWavePair<T>,
        position: usize,
    ) -> (State<T>, CellConstants<T>) {
        let cell = line.cell(position);
        let state = State {
            velocity: self.fields[wave.velocity][cell],
            stress: self.fields[wave.stress][cell],
        };
        (state, wave.cells[usize::from(self.problem.cell_media[cell])])
    }

    /// Computes states and constants of the ghosts beyond an end of a line, nearest first; those beyond the ghosts of the
    /// reconstruction have no meaning.
    fn compute_end_ghosts(
        &self,
        line: GridLine,
        (pair, wave): (usize, &ReferenceWavePair<T>),
        boundaries: &[BoundaryFaces<T>; 2],
        end: usize,
    ) -> [(State<T>, CellConstants<T>); MAX_GHOSTS] {
        let cell_from_end =
            |end: usize, depth: usize| self.read_cell(line, wave, line.index_from_end(end, depth));
        let BoundaryFaces::Physical(rule) = &boundaries[end] else {
            return std::array::from_fn(|depth| cell_from_end(1 - end, depth));
        };
        let face = lane_index::<T>(line.face);
        if line.count >= CLOSURE_CELLS && !self.slopes.is_wide() {
            let outer_cells: [_; CLOSURE_CELLS] =
                std::array::from_fn(|depth| cell_from_end(end, depth));
            let medium = self.problem.cell_media[line.cell(line.index_from_end(end, 0))];
            let ghost_coefficients = &wave.ghost_coefficients[usize::from(medium)];
            let (states, cells) = (outer_cells.map(|own| own.0), outer_cells.map(|own| own.1));
            let rule = rule.face_coefficients(pair, face);
            let ghost_states = compute_ghosts(
                boundaries[end].closure(),
                states,
                rule,
                end,
                cells.each_ref(),
                ghost_coefficients,
            );
            return std::array::from_fn(|depth| {
                let own = depth.min(ghost_states.len() - 1);
                (ghost_states[own], cells[own])
            });
        }
        let mirror_state = |rule: [T; 5], own: State<T>| State {
            velocity: image([rule[0], rule[1]], own.velocity),
            stress: image([rule[2], rule[3]], own.stress),
        };
        std::array::from_fn(|depth| {
            let (mut source_state, cell) = cell_from_end(end, depth);
            // In a line of one cell the second ghost is the image of the ghost at the other end.
            if let (BoundaryFaces::Physical(other), true) =
                (&boundaries[1 - end], depth >= line.count)
            {
                source_state = mirror_state(other.face_coefficients(pair, face), source_state);
            }
            (mirror_state(rule.face_coefficients(pair, face), source_state), cell)
        })
    }

    /// Computes the power per area that the boundary supplies at an end of a line in the sweep that follows, W/m²,
    /// positive inwards.
    fn boundary_power(
        &self,
        line_fields: &LineFields<T>,
        line: GridLine,
        pair: usize,
        end: usize,
    ) -> f64 {
        match &self.boundaries[line.axis][end] {
            BoundaryFaces::Physical(rule)
                if rule.can_do_work_at(pair, lane_index::<T>(line.face)) => {}
            _ => return 0.0,
        }
        let first = [0, line.count][end];
        let cell_at = |place: usize| {
            let LineFields { velocity, stress, cells, .. } = line_fields;
            let place = first + place;
            (State { velocity: velocity[place], stress: stress[place] }, cells[place])
        };
        let slopes = if self.problem.separates() { Slopes::Godunov } else { self.slopes };
        let power = line::boundary_power(cell_at, slopes);
        if end == 0 { -power } else { power }
    }
}
