//! Blocky media in the solvers of two-dimensional grids against exact solutions of the discrete equations: Bloch waves
//! of a chain of blocks, and an interlayer between half-spaces of unequal impedances.

use crate::support::blocky::{
    BLOCK_LENGTH, ROCK_DENSITY, ROCK_SPEEDS, THICKNESSES, elastic_layer, layer_material,
};
use crate::support::chain::{BlockChain, ChainState};
use crate::support::interlayers::{elastic_component, layers_of_all_kinds};
use crate::support::random::NoiseSequence;
use models::interface::elastic::ElasticLayer;
use models::interface::history::{NORMAL_MOTION, NORMAL_STATE, SHEAR_MOTION, SHEAR_STRESS};
use models::interface::layer::LayerLaw;
use models::interface::{FaceLaw, FaceState, Interval, RiemannData};
use models::solid::parameters::Isotropic;
use models::solid::waves::{SolidField, VelocityStressPair};
use std::f64::consts::{PI, TAU};
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::solid::interlayers::{InterlayerLaw, Interlayers};

/// Number of lines across the direction of propagation of a chain.
const LINE_COUNT: usize = 3;
const CELLS_PER_BLOCK: usize = 10;
const BLOCK_COUNT: usize = 8;

/// Waves of a chain along an axis: those with the velocity component `component`, 0 normal and 1 tangential to the
/// interlayers, in rock whose P waves have `speeds[0]` and whose S waves `speeds[1]`, m/s; shear waves are swept in one
/// of `shear_interval` steps.
#[derive(Clone, Copy, Debug)]
struct ChainWaves {
    axis: usize,
    component: usize,
    speeds: [f64; 2],
    shear_interval: usize,
    /// Thickness of the interlayers, m.
    thickness: f64,
}

impl ChainWaves {
    /// Impedance of the rock, kg/(m²s).
    fn impedance(&self) -> f64 {
        ROCK_DENSITY * self.speeds[self.component]
    }

    /// Duration of a sweep of these waves at Courant number 1, s.
    fn sweep(&self) -> f64 {
        BLOCK_LENGTH / CELLS_PER_BLOCK as f64 / self.speeds[self.component]
    }

    /// Returns the chain with time in sweeps, and stress in units of the impedance of the rock times a velocity.
    fn chain(&self) -> BlockChain {
        let (z, sweep) = (self.impedance(), self.sweep());
        let material = layer_material(self.thickness);
        let compliances = [material.normal_compliance(), material.tangential_compliance()];
        let law = elastic_component(
            material.mass() / (z * sweep),
            compliances[self.component] * z / sweep,
        );
        BlockChain {
            cells_per_block: CELLS_PER_BLOCK,
            block_count: BLOCK_COUNT,
            z: 1.0,
            law,
            step: 1.0,
        }
    }

    /// Returns the problem of the periodic chain.
    fn problem(&self) -> Problem<2> {
        let axis = self.axis;
        let mut cells = [LINE_COUNT; 2];
        cells[axis] = BLOCK_COUNT * CELLS_PER_BLOCK;
        let spacing = BLOCK_LENGTH / CELLS_PER_BLOCK as f64;
        let law = InterlayerLaw::Plane(elastic_layer(self.thickness), axis);
        let interlayers = Interlayers::new_regular(axis, cells[axis], [0, CELLS_PER_BLOCK], law);
        let boundaries = [0, 1].map(|_| [Boundary::Periodic, Boundary::Periodic]);
        let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
        let grid = Grid { cells, spacing: [spacing; 2] };
        let (count, step) = (grid.count(), 2.0 * spacing / self.speeds[0]);
        let [longitudinal, shear] = self.speeds.map(|speed| ROCK_DENSITY * speed * speed);
        let solid = Isotropic::new(longitudinal - 2.0 * shear, shear, ROCK_DENSITY, None);
        let rock = Medium::new(solid.expect("sound moduli"), 2);
        Problem {
            interlayers: vec![interlayers],
            shear_interval: self.shear_interval,
            ..Problem::new(grid, vec![rock], vec![0; count], boundaries, step, scheme)
        }
    }

    /// Wave pair of these waves.
    fn pair<'a>(&self, problem: &'a Problem<2>) -> &'a VelocityStressPair {
        let index = [self.axis, 1 - self.axis][self.component];
        &problem.media[0].pairs[self.axis][index]
    }

    /// Indices of the history variables velocity and stress of these waves.
    fn history_indices(&self) -> [usize; 2] {
        [[NORMAL_MOTION, NORMAL_STATE], [SHEAR_MOTION, SHEAR_STRESS]][self.component]
    }

    /// Returns the coordinate of a cell of a problem along the axis.
    fn coordinate(&self, problem: &Problem<2>, cell: usize) -> usize {
        [cell % problem.grid.cells[0], cell / problem.grid.cells[0]][self.axis]
    }

    /// Sets the cells and interlayers of a domain to a state of the chain.
    fn set_state(&self, domain: &mut Domain<f64, 2>, problem: &Problem<2>, state: &ChainState) {
        let z = self.impedance();
        let cell_values = |values: &[f64], factor: f64| -> Vec<f64> {
            let value = |cell| factor * values[self.coordinate(problem, cell)];
            (0..problem.grid.count()).map(value).collect()
        };
        let pair = self.pair(problem);
        domain.set_field(pair.velocity, &cell_values(&state.velocity, 1.0));
        domain.set_field(pair.stress, &cell_values(&state.stress, z));
        for (field, ratio) in &pair.passive_stresses {
            domain.set_field(*field, &cell_values(&state.stress, ratio * z));
        }
        let (mut history, [velocity_index, stress_index]) = (Vec::new(), self.history_indices());
        for face in problem.interlayer_faces() {
            let [velocity, stress] =
                state.layers[self.coordinate(problem, face.cell) / CELLS_PER_BLOCK];
            history.resize(face.history.end, 0.0);
            history[face.history.start + velocity_index] = velocity;
            history[face.history.start + stress_index] = z * stress;
        }
        domain.set_interlayer_history(&mut history.into_iter());
    }

    /// Computes the largest deviation of a domain from a state of the chain, all fields included.
    fn deviation(&self, domain: &Domain<f64, 2>, problem: &Problem<2>, state: &ChainState) -> f64 {
        let z = self.impedance();
        let pair = self.pair(problem);
        let mut max_deviation = 0.0f64;
        for field in domain.fields() {
            let passive = pair.passive_stresses.iter().find(|passive| passive.0 == *field);
            let (expected, factor, unit) = match passive {
                Some((_, ratio)) => (&state.stress, *ratio, z),
                None if *field == pair.velocity => (&state.velocity, 1.0, 1.0),
                None if *field == pair.stress => (&state.stress, 1.0, z),
                None => (&state.stress, 0.0, z),
            };
            for (cell, value) in domain.values(*field).expect("a field").iter().enumerate() {
                let expected = factor * expected[self.coordinate(problem, cell)];
                max_deviation = max_deviation.max((value / unit - expected).abs());
            }
        }
        let (history, [velocity_index, stress_index]) =
            (domain.interlayer_history(), self.history_indices());
        for face in problem.interlayer_faces() {
            let variables = &history[face.history.clone()];
            let [velocity, stress] =
                state.layers[self.coordinate(problem, face.cell) / CELLS_PER_BLOCK];
            max_deviation = max_deviation.max((variables[velocity_index] - velocity).abs());
            max_deviation = max_deviation.max((variables[stress_index] / z - stress).abs());
        }
        max_deviation
    }

    /// Computes the largest deviation from a mode, by its amplitude, in `rounds` times 50 steps (100 sweeps) of these
    /// waves, and the frequency of the mode, rad/s. Rounding errors of a sweep are a few 1e-16 of the amplitude and add
    /// up linearly at most: 4000 sweeps stay below 1e-11.
    fn verify_mode(&self, phase: f64, branch: usize, rounds: usize) -> f64 {
        let (problem, chain) = (self.problem(), self.chain());
        let frequency = chain.mode_frequency(phase, branch);
        let mode = chain.mode(frequency, phase);
        let mut domain = Domain::<f64, 2>::new(&problem).expect("sound");
        self.set_state(&mut domain, &problem, &mode.state(0));
        let mut error = 0.0f64;
        for _ in 0..rounds {
            (0..50 * self.shear_interval).for_each(|_| domain.advance());
            let sweeps = (domain.time() / self.sweep()).round() as usize;
            error = error.max(self.deviation(&domain, &problem, &mode.state(sweeps)));
        }
        let error = error / mode.amplitude();
        let frequency = frequency / self.sweep();
        println!("{self:?}, branch {branch}, κh {phase:.4}: {:.5} kHz, {error:e}", frequency / TAU);
        assert!(error < 1e-11, "{error:e}");
        frequency
    }
}

/// Verifies that P modes of a chain oscillate as e^{iωt} with ω of the discrete Bloch relation over 500 steps of the
/// two-dimensional solver, along both axes, band edges included.
#[test]
fn modes_of_a_chain_of_blocks_have_the_frequencies_of_the_bloch_relation() {
    // Frequencies of the lowest branch at κh = π/4, π/2, π, kHz, of the equations before their discretisation.
    let continuous_frequencies = [
        [11.96405, 23.91230, 45.89261],
        [8.96731, 17.56580, 28.44161],
        [5.11290, 9.73241, 14.47159],
    ];
    for (thickness, frequencies) in THICKNESSES.into_iter().zip(continuous_frequencies) {
        for (branch, axis) in [(0, 0), (1, 1)] {
            let waves = ChainWaves {
                axis,
                component: 0,
                speeds: ROCK_SPEEDS,
                shear_interval: 1,
                thickness,
            };
            for (phase, continuous_frequency) in
                [0.25 * PI, 0.5 * PI, PI].into_iter().zip(frequencies)
            {
                let frequency = waves.verify_mode(phase, branch, 10);
                if branch == 0 {
                    // The scheme replaces ω in the layers by (2/Δt) tan ½ωΔt, larger by the relative amount
                    // (ωΔt)²/12 + …; it lowers the frequency by less than that.
                    let bound = (frequency * waves.sweep()).powi(2) / 10.0;
                    let relative = 1.0 - frequency / (TAU * 1e3) / continuous_frequency;
                    assert!((-1e-6..bound).contains(&relative), "{relative} {bound}");
                }
            }
        }
    }
}

/// Verifies the same for S modes, which have Courant number 1 if P waves are 2 or 3 times as fast and shear waves are
/// swept in one of as many steps; P modes of that scheme remain exact, too.
#[test]
fn shear_modes_of_a_chain_of_blocks_have_the_frequencies_of_the_bloch_relation() {
    check_shear_modes(2, &[0.5 * PI], 10);
}

#[test]
fn shear_modes_swept_in_one_of_three_steps_have_the_frequencies_of_the_bloch_relation() {
    check_shear_modes(3, &[0.5 * PI], 10);
}

#[test]
#[ignore = "a minute"]
fn shear_modes_have_the_frequencies_of_the_bloch_relation_over_many_steps() {
    for shear_interval in [2, 3] {
        check_shear_modes(shear_interval, &[0.25 * PI, 0.5 * PI, PI], 40);
    }
}

/// Checks S modes at three phases and P modes at the phases `longitudinal_phases`.
fn check_shear_modes(shear_interval: usize, longitudinal_phases: &[f64], rounds: usize) {
    let shear_phases: &[f64] = &[0.25 * PI, 0.5 * PI, PI];
    for thickness in THICKNESSES {
        // Branches along the axes 0 and 1.
        let branches = if shear_interval == 2 { [0, 1] } else { [1, 0] };
        for (axis, branch) in branches.into_iter().enumerate() {
            for (component, phases) in [(1, shear_phases), (0, longitudinal_phases)] {
                for phase in phases {
                    let speeds = [ROCK_SPEEDS[1] * shear_interval as f64, ROCK_SPEEDS[1]];
                    let waves = ChainWaves { axis, component, speeds, shear_interval, thickness };
                    waves.verify_mode(*phase, branch, rounds);
                }
            }
        }
    }
}

/// Half-spaces with an interlayer normal to the first axis between them. P waves have Courant number 1 in both.
struct HalfSpaces {
    problem: Problem<2>,
    law: LayerLaw<f64>,
    /// Initial velocity and stress by cell.
    velocity: Vec<f64>,
    stress: Vec<f64>,
}

impl HalfSpaces {
    /// Creates half-spaces of `cells` cells each, of speed 1 and the impedances `impedance`; sweeps have duration and
    /// cells have length 1.
    fn new(
        cells: usize,
        impedance: [f64; 2],
        law: LayerLaw<f64>,
        mut value: impl FnMut() -> f64,
    ) -> Self {
        // The ratio λ/(λ + 2μ) = ½ is a power of two.
        let medium = |z: f64| {
            Medium::new(Isotropic::new(0.5 * z, 0.25 * z, z, None).expect("sound moduli"), 2)
        };
        let count = 2 * cells;
        let interlayer_law = InterlayerLaw::Plane(law, 0);
        let boundaries = [
            [Boundary::NonReflecting, Boundary::NonReflecting],
            [Boundary::Periodic, Boundary::Periodic],
        ];
        let problem = Problem {
            interlayers: vec![Interlayers::new_regular(0, count, [cells, count], interlayer_law)],
            ..Problem::new(
                Grid { cells: [count, 1], spacing: [1.0; 2] },
                impedance.map(medium).to_vec(),
                (0..count).map(|cell| u16::from(cell >= cells)).collect(),
                boundaries,
                2.0,
                Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping),
            )
        };
        let velocity = (0..count).map(|_| value()).collect();
        let stress = (0..count).map(|_| value()).collect();
        Self { problem, law, velocity, stress }
    }

    fn cells(&self) -> usize {
        self.problem.grid.cells[0] / 2
    }

    /// Returns the impedance of a cell for P waves.
    fn impedance(&self, cell: usize) -> f64 {
        self.problem.media[usize::from(self.problem.cell_media[cell])].pairs[0][0].impedance()
    }

    /// Advances the face law alone by `sweeps` sweeps, with the waves of the initial state that arrive one cell per
    /// sweep; returns the history variables after each sweep and the states of both sides during each sweep.
    fn advance_face(&self, sweeps: usize) -> (Vec<Vec<f64>>, Vec<[FaceState<f64>; 2]>) {
        let cells = self.cells();
        let mut history = vec![0.0; self.law.history_variable_count()];
        let [before, after] = [cells - 1, cells].map(|cell| self.velocity[cell]);
        self.law.initialise(&[[before, after], [0.0; 2]], &mut history);
        let impedance = [self.impedance(cells - 1), self.impedance(cells)];
        let (mut histories, mut states) = (Vec::new(), Vec::new());
        for sweep in 0..sweeps {
            let (lower, upper) = (cells - 1 - sweep, cells + sweep);
            let normal = RiemannData {
                impedance,
                invariant: [
                    impedance[0] * self.velocity[lower] - self.stress[lower],
                    impedance[1] * self.velocity[upper] + self.stress[upper],
                ],
            };
            // Waves of shear have half the speed; their impedance has no effect without shear.
            let shear = RiemannData { impedance: impedance.map(|z| 0.5 * z), invariant: [0.0; 2] };
            let interval = Interval::new((sweep + 1) as f64, 1.0);
            states.push(self.law.advance(&[normal, shear], &interval, &mut history)[0]);
            histories.push(history.clone());
        }
        (histories, states)
    }

    /// Returns the stress and the velocity of each cell after the sweeps in which the face had `states`: the waves of
    /// the initial state and those that left the face.
    fn exact_cells(&self, states: &[[FaceState<f64>; 2]]) -> Vec<[f64; 2]> {
        let (cells, sweeps) = (self.cells(), states.len());
        let wave = |cell: usize, sign: f64| {
            self.stress[cell] + sign * self.impedance(cell) * self.velocity[cell]
        };
        let exact = |cell: usize| {
            let z = self.impedance(cell);
            // Right-going wave s − zv and left-going wave s + zv.
            let right = match cell.checked_sub(cells).filter(|distance| *distance < sweeps) {
                Some(distance) => {
                    let face = states[sweeps - 1 - distance][1];
                    face.stress - z * face.velocity
                }
                None => cell.checked_sub(sweeps).map_or(0.0, |from| wave(from, -1.0)),
            };
            let distance = (cells - 1).checked_sub(cell).filter(|distance| *distance < sweeps);
            let left = match distance {
                Some(distance) => {
                    let face = states[sweeps - 1 - distance][0];
                    face.stress + z * face.velocity
                }
                None if cell + sweeps < 2 * cells => wave(cell + sweeps, 1.0),
                None => 0.0,
            };
            [0.5 * (left + right), 0.5 * (left - right) / z]
        };
        (0..2 * cells).map(exact).collect()
    }
}

const LONGITUDINAL_FIELDS: [SolidField; 2] = [SolidField::Stress(0, 0), SolidField::Velocity(0)];

/// Verifies both solvers of the grid against the law of the face alone: to the bit between equal impedances, for
/// constants and waves whose numbers are represented exactly through eight sweeps, so that no order of additions
/// matters; between the impedances 1 and 3 the cells above the interlayer divide by 3, and rounding errors of a few ε
/// per sweep of values below 16 are added. The numbers in the law itself are exact there, too.
#[test]
fn interlayer_between_half_spaces_equals_the_face_law_bit_by_bit() {
    let elastic = |mass, compliance| {
        LayerLaw::Elastic(ElasticLayer { components: [elastic_component(mass, compliance); 2] })
    };
    let mut random = NoiseSequence::new(70 << 40);
    for (impedance, law, tolerance) in [
        ([1.0, 1.0], elastic(1.0, 1.0), 0.0),
        ([1.0, 3.0], elastic(0.5, 0.375), 8.0 * 8.0 * 16.0 * f64::EPSILON),
    ] {
        let mut max_error = 0.0f64;
        for _ in 0..20 {
            let value = || random.uniform_index(17) as f64 - 8.0;
            let half_spaces = HalfSpaces::new(12, impedance, law, value);
            let (mut fused, mut reference) = (
                DecomposedDomain::<f64, 2>::new(&half_spaces.problem, 1).expect("sound"),
                Reference::<f64, 2>::new(&half_spaces.problem).expect("sound"),
            );
            for (field, values) in
                LONGITUDINAL_FIELDS.into_iter().zip([&half_spaces.stress, &half_spaces.velocity])
            {
                fused.set_field(field, values);
                reference.set_field(field, values);
            }
            fused.initialise_interlayers();
            reference.initialise_interlayers();
            for sweeps in [2, 4, 6, 8] {
                fused.advance(1).expect("threads");
                reference.advance(1);
                let (histories, states) = half_spaces.advance_face(sweeps);
                let mut expected = histories[sweeps - 1].clone();
                // Cells beyond the reach of the sides.
                let reached_cells = sweeps..24 - sweeps;
                expected.extend(
                    half_spaces.exact_cells(&states)[reached_cells.clone()].iter().flatten(),
                );
                for (mut found, values) in [
                    (
                        fused.interlayer_history(),
                        LONGITUDINAL_FIELDS.map(|field| fused.values(field)),
                    ),
                    (
                        reference.interlayer_history(),
                        LONGITUDINAL_FIELDS.map(|field| reference.values(field)),
                    ),
                ] {
                    let values = values.map(|values| values.expect("a field"));
                    found.extend(reached_cells.clone().flat_map(|i| [values[0][i], values[1][i]]));
                    assert_eq!(found.len(), expected.len());
                    for (found, expected) in found.iter().zip(&expected) {
                        max_error = max_error.max((found - expected).abs());
                    }
                }
            }
        }
        println!("{impedance:?}: {max_error:e}");
        assert!(max_error <= tolerance, "{impedance:?}: {max_error:e}");
    }
}

/// Verifies layers of all kinds between half-spaces against the law of the face alone, with random waves. Laws are
/// contractions of the incoming waves except at fracture, so rounding errors of the cells do not grow: 200 sweeps stay
/// below 200·16·ε of the largest value of order 10.
#[test]
fn layers_of_all_kinds_between_half_spaces_equal_their_face_laws() {
    let mut random = NoiseSequence::new(71 << 40);
    let (steps, cells) = (100, 210);
    let mut max_error = 0.0f64;
    for (index, law) in layers_of_all_kinds(&mut random).into_iter().enumerate() {
        let impedance = [0; 2].map(|_| 3f64.powf(random.uniform_symmetric()));
        let half_spaces = HalfSpaces::new(cells, impedance, law, || random.uniform_symmetric());
        let mut fused = DecomposedDomain::<f64, 2>::new(&half_spaces.problem, 1).expect("sound");
        for (field, values) in
            LONGITUDINAL_FIELDS.into_iter().zip([&half_spaces.stress, &half_spaces.velocity])
        {
            fused.set_field(field, values);
        }
        fused.initialise_interlayers();
        fused.advance(steps).expect("threads");
        let (histories, states) = half_spaces.advance_face(2 * steps);
        let mut error = 0.0f64;
        let last = &histories[2 * steps - 1];
        assert!(last[NORMAL_STATE] != 0.0);
        for (value, expected) in fused.interlayer_history().iter().zip(last) {
            error = error.max((value - expected).abs() / expected.abs().max(1.0));
        }
        let exact = half_spaces.exact_cells(&states);
        for (index, field) in LONGITUDINAL_FIELDS.into_iter().enumerate() {
            let values = fused.values(field).expect("a field");
            // Cells beyond the reach of the sides.
            for cell in 2 * steps..2 * cells - 2 * steps {
                error = error.max((values[cell] - exact[cell][index]).abs());
            }
        }
        println!("{index}: {error:e}");
        assert!(error < 7e-13, "{law:?}: {error:e}");
        max_error = max_error.max(error);
    }
    println!("{max_error:e}");
}
