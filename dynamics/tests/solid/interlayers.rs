//! Interlayers on a line: sweeps against a dense solution of the discrete equations, Bloch dispersion of a chain,
//! energy ledger, decay of energy, a velocity step and a pulse through an interlayer.

use crate::support::chain::BlockChain;
use crate::support::interlayers::elastic_component;
use crate::support::random::CongruentialGenerator;
use models::interface::elastic::{ElasticComponent, ElasticLayer};
use models::interface::{FaceLaw, FaceState, Interval, RiemannData};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;
use std::f64::consts::PI;
use wellposed_dynamics::solid::interface::{Interlayer, LineState, sweep_with_interlayers};
use wellposed_dynamics::solid::line::{CellConstants, GHOSTS, Slopes, SweepAccount, energy};

type LineInterlayer = Interlayer<f64, ElasticLayer<f64, 1>>;

/// Computes the energy of an interlayer, J/m².
fn layer_energy(own: &LineInterlayer) -> f64 {
    own.law.energy(&own.history).total()
}

const ALL_SLOPES: [Slopes; 3] = [Slopes::Godunov, Slopes::Limited, Slopes::FourthOrder];

/// A periodic line: cells without ghosts, and interlayers at the lower faces of some cells.
#[derive(Clone)]
struct InterlayerLine {
    velocity: Vec<f64>,
    stress: Vec<f64>,
    cells: Vec<CellConstants<f64>>,
    /// Interlayers in the order of their cells.
    layers: Vec<LineInterlayer>,
}

impl InterlayerLine {
    fn new_at_rest(
        cells: Vec<CellConstants<f64>>,
        layers: &[(usize, ElasticComponent<f64>)],
    ) -> Self {
        let zeros = vec![0.0; cells.len()];
        Self {
            velocity: zeros.clone(),
            stress: zeros,
            cells,
            layers: layers
                .iter()
                .map(|&(upper_cell, law)| Interlayer {
                    upper_cell,
                    law: ElasticLayer { components: [law] },
                    history: vec![0.0; 3],
                })
                .collect(),
        }
    }

    /// Advances the line by one step and returns the power dissipated by the sweep in the cells, W/m².
    fn advance(&mut self, slopes: Slopes, step: f64) -> f64 {
        let count = self.cells.len();
        let periodic_index = |i: usize| (i + count - GHOSTS) % count;
        let periodic_indices: Vec<usize> = (0..count + 2 * GHOSTS).map(periodic_index).collect();
        let mut velocity: Vec<f64> = periodic_indices.iter().map(|&i| self.velocity[i]).collect();
        let mut stress: Vec<f64> = periodic_indices.iter().map(|&i| self.stress[i]).collect();
        let cells: Vec<CellConstants<f64>> =
            periodic_indices.iter().map(|&i| self.cells[i]).collect();
        // Interlayers at ghosts and at the upper end are periodic copies.
        let mut layers: Vec<LineInterlayer> = (0..count + 2 * GHOSTS)
            .filter_map(|i| {
                let source = self.layers.iter().find(|own| own.upper_cell == periodic_index(i))?;
                Some(Interlayer { upper_cell: i, ..source.clone() })
            })
            .collect();
        let mut accounts = vec![SweepAccount::default(); count];
        let line = LineState {
            velocity: &mut velocity,
            stress: &mut stress,
            cells: &cells,
            accounts: Some(&mut accounts),
        };
        sweep_with_interlayers([line], slopes, &mut layers, &Interval::new(1.0, step));
        let interior = GHOSTS..GHOSTS + count;
        self.velocity.copy_from_slice(&velocity[interior.clone()]);
        self.stress.copy_from_slice(&stress[interior.clone()]);
        for layer in &mut self.layers {
            let advanced = layers.iter().find(|own| own.upper_cell == layer.upper_cell + GHOSTS);
            layer.history = advanced.expect("it is inside").history.clone();
        }
        accounts.iter().sum::<SweepAccount>().dissipation
    }

    /// Computes the energy of the cells, J/m², for sweeps of the duration `step`, s.
    fn cell_energy(&self, step: f64) -> f64 {
        let pad = |own: &[f64]| [&[0.0; GHOSTS], own, &[0.0; GHOSTS]].concat();
        let mut cells = self.cells.clone();
        cells.splice(0..0, [self.cells[0]; GHOSTS]);
        cells.extend([self.cells[0]; GHOSTS]);
        step * energy(&pad(&self.velocity), &pad(&self.stress), &cells)
    }

    fn total_energy(&self, step: f64) -> f64 {
        self.cell_energy(step) + self.layers.iter().map(layer_energy).sum::<f64>()
    }
}

/// Verifies steps at Courant number 1, where waves move by one cell, against a dense solution of the discrete equations
/// of two interlayers.
#[test]
fn steps_at_courant_number_one_equal_a_dense_solution() {
    let mut random = CongruentialGenerator::new(1);
    let mut max_error = 0.0f64;
    for _ in 0..20 {
        let impedance = [random.log10_uniform(-1.0, 1.0), random.log10_uniform(-1.0, 1.0)];
        let step = random.log10_uniform(-1.0, 1.0);
        let laws: [ElasticComponent<f64>; 2] = std::array::from_fn(|_| {
            let mut size = || step * random.log10_uniform(-1.0, 1.0);
            elastic_component(size(), size())
        });
        // A ring of two blocks with two interlayers.
        let count = 12;
        let z = |i: usize| impedance[i / 6];
        let cells: Vec<CellConstants<f64>> =
            (0..count).map(|i| CellConstants::new(z(i), 1.0)).collect();
        let mut line = InterlayerLine::new_at_rest(cells, &[(0, laws[0]), (6, laws[1])]);
        for i in 0..count {
            (line.velocity[i], line.stress[i]) =
                (random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        }
        let (mut v, mut s) = (line.velocity.clone(), line.stress.clone());
        let mut layer_states = [[0.0; 2]; 2];
        for number in 0..500 {
            let slopes = ALL_SLOPES[number % 3];
            // Unknowns of each interlayer: v⁻, v⁺, σ⁻, σ⁺ on its lower and upper face, and its velocity V and stress S
            // after the step.
            let mut matrix = DMatrix::zeros(12, 12);
            let mut right = DVector::zeros(12);
            for face in 0..2 {
                let (above, first) = (6 * face, 6 * face);
                let below = (above + count - 1) % count;
                let (mass, compliance) = (laws[face].mass.mass, laws[face].compliance);
                let [velocity, stress] = layer_states[face];
                let equations: [(&[(usize, f64)], f64); 6] = [
                    (&[(0, z(below)), (2, -1.0)], z(below) * v[below] - s[below]),
                    (&[(1, z(above)), (3, 1.0)], z(above) * v[above] + s[above]),
                    (&[(0, 1.0), (1, 1.0), (4, -1.0)], velocity),
                    (&[(2, 1.0), (3, 1.0), (5, -1.0)], stress),
                    (&[(2, 1.0), (3, -1.0), (4, mass / step)], mass / step * velocity),
                    (&[(0, 1.0), (1, -1.0), (5, compliance / step)], compliance / step * stress),
                ];
                for (row, (terms, known)) in equations.into_iter().enumerate() {
                    for &(unknown, factor) in terms {
                        matrix[(first + row, first + unknown)] = factor;
                    }
                    right[first + row] = known;
                }
            }
            let solved = matrix.lu().solve(&right).expect("regular");
            // Right- and left-going waves of a cell come from the neighbouring cell or from the face.
            let (old_v, old_s) = (v.clone(), s.clone());
            for i in 0..count {
                let [before, after] = [(i + count - 1) % count, (i + 1) % count];
                let to_right = match i % 6 {
                    0 => solved[i + 3] - z(i) * solved[i + 1],
                    _ => old_s[before] - z(i) * old_v[before],
                };
                let to_left = match i % 6 {
                    5 => solved[after + 2] + z(i) * solved[after],
                    _ => old_s[after] + z(i) * old_v[after],
                };
                (v[i], s[i]) = (0.5 * (to_left - to_right) / z(i), 0.5 * (to_left + to_right));
            }
            layer_states = [[solved[4], solved[5]], [solved[10], solved[11]]];
            line.advance(slopes, step);
            for i in 0..count {
                max_error = max_error.max((v[i] - line.velocity[i]).abs() * z(i).sqrt());
                max_error = max_error.max((s[i] - line.stress[i]).abs() / z(i).sqrt());
            }
            for (own, states) in line.layers.iter().zip(layer_states) {
                let law = own.law.components[0];
                let [mass, compliance] = [law.mass.mass / step, law.compliance / step];
                max_error = max_error.max((states[0] - own.history[0]).abs() * mass.sqrt());
                max_error = max_error.max((states[1] - own.history[2]).abs() * compliance.sqrt());
            }
        }
    }
    println!("{max_error:e}");
    assert!(max_error < 1e-12, "{max_error:e}");
}

/// Computes the largest deviation of a mode of a chain from e^{iωt} over `steps` steps, relative to its amplitude.
fn mode_error(chain: &BlockChain, frequency: f64, phase: f64, steps: usize) -> f64 {
    let mode = chain.mode(frequency, phase);
    let cells = vec![CellConstants::new(chain.z, 1.0); chain.cells_per_block * chain.block_count];
    let layers: Vec<_> =
        (0..chain.block_count).map(|i| (i * chain.cells_per_block, chain.law)).collect();
    let mut line = InterlayerLine::new_at_rest(cells, &layers);
    let start = mode.state(0);
    (line.velocity, line.stress) = (start.velocity, start.stress);
    for (own, [v, s]) in line.layers.iter_mut().zip(start.layers) {
        own.history = vec![v, 0.0, s];
    }
    let mut max_deviation = 0.0f64;
    for number in 1..=steps {
        line.advance(Slopes::FourthOrder, chain.step);
        let state = mode.state(number);
        for i in 0..state.velocity.len() {
            max_deviation = max_deviation.max((state.stress[i] - line.stress[i]).abs());
            max_deviation =
                max_deviation.max((state.velocity[i] - line.velocity[i]).abs() * chain.z);
        }
        for (own, layer) in line.layers.iter().zip(state.layers) {
            max_deviation = max_deviation.max((own.history[0] - layer[0]).abs() * chain.z);
            max_deviation = max_deviation.max((own.history[2] - layer[1]).abs());
        }
    }
    max_deviation / mode.amplitude()
}

/// Verifies that modes of a chain oscillate as e^{iωt} with ω of the Bloch relation, band edges included.
#[test]
fn modes_of_a_chain_have_the_frequencies_of_the_bloch_relation() {
    for (z, mass, compliance) in [(1.0, 0.3, 0.8), (2.0, 3.0, 0.5), (1.3, 0.5, 4.0)] {
        let law = elastic_component(mass, compliance);
        let chain = BlockChain { cells_per_block: 10, block_count: 8, z, law, step: 0.1 };
        for branch in [0, 1, 2] {
            // The last phase is a band edge.
            for phase in [0.25 * PI, 0.5 * PI, 0.75 * PI, PI] {
                let frequency = chain.mode_frequency(phase, branch);
                let error = mode_error(&chain, frequency, phase, 2000);
                println!("z {z}, branch {branch}, κh {phase:.4}: ω {frequency:.12}, {error:e}");
                assert!(error < 1e-11, "{error:e}");
            }
        }
    }
}

/// Returns a random line of several media, with interlayers of different constants at random faces, and its step, s.
fn random_line(random: &mut CongruentialGenerator, count: usize) -> (InterlayerLine, f64) {
    let step = random.log10_uniform(-1.0, 1.0);
    let mut cells: Vec<CellConstants<f64>> = Vec::new();
    while cells.len() < count {
        let cell = CellConstants::with_interfaces(
            random.log10_uniform(-1.0, 1.0),
            random.uniform(0.0, 1.0).max(1e-3),
        );
        let length = random.uniform(1.0, 6.0) as usize;
        cells.extend(vec![cell; length.min(count - cells.len())]);
    }
    let mut layers = Vec::new();
    let mut upper_cell = random.uniform(0.0, 3.0) as usize;
    while upper_cell < count {
        let [mass, compliance] = [0; 2].map(|_| step * random.log10_uniform(-3.0, 3.0));
        layers.push((upper_cell, elastic_component(mass, compliance)));
        upper_cell += random.uniform(1.0, 7.0) as usize;
    }
    let mut line = InterlayerLine::new_at_rest(cells, &layers);
    for i in 0..count {
        let z = line.cells[i].impedance;
        line.velocity[i] = random.uniform(-1.0, 1.0) / z.sqrt();
        line.stress[i] = random.uniform(-1.0, 1.0) * z.sqrt();
    }
    for layer in &mut line.layers {
        let [v, s] = [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)];
        layer.history = vec![v, 0.0, s];
    }
    (line, step)
}

/// Verifies that the energy of cells and interlayers changes by minus the dissipation of the cells, over 20,000 steps
/// between unequal impedances.
#[test]
fn ledger_of_a_line_closes() {
    let mut random = CongruentialGenerator::new(3);
    for slopes in ALL_SLOPES {
        let (mut line, step) = random_line(&mut random, 24);
        // At Courant number 1 sweeps have no numerical dissipation.
        for cell in &mut line.cells {
            *cell = CellConstants::new(cell.impedance, 1.0);
        }
        let start = line.total_energy(step);
        let (mut max_residual, mut exchanged_energy) = (0.0f64, 0.0);
        let layer_energies =
            |line: &InterlayerLine| line.layers.iter().map(layer_energy).sum::<f64>();
        for _ in 0..20_000 {
            let (before, initial_layer_energy) = (line.total_energy(step), layer_energies(&line));
            let dissipated = step * line.advance(slopes, step);
            max_residual =
                max_residual.max((line.total_energy(step) - before + dissipated).abs() / start);
            exchanged_energy += (layer_energies(&line) - initial_layer_energy).abs();
        }
        println!("{slopes:?}: {max_residual:e} in a step, {exchanged_energy} of {start} exchanged");
        assert!(max_residual < 1e-14, "{max_residual:e}");
        assert!((line.total_energy(step) / start - 1.0).abs() < 1e-11);
        assert!(exchanged_energy > 10.0 * start);
    }
}

#[test]
fn ledger_of_a_line_closes_at_all_courant_numbers() {
    let mut random = CongruentialGenerator::new(4);
    for number in 0..600 {
        let (mut line, step) = random_line(&mut random, 24);
        let start = line.total_energy(step);
        for _ in 0..20 {
            let before = line.total_energy(step);
            let dissipated = step * line.advance(ALL_SLOPES[number % 3], step);
            let residual = (line.total_energy(step) - before + dissipated).abs();
            assert!(residual < 1e-13 * start, "{residual:e} of {start}");
        }
    }
}

#[test]
fn energy_of_a_line_never_grows() {
    let mut random = CongruentialGenerator::new(5);
    for number in 0..3000 {
        let (mut line, step) = random_line(&mut random, 30);
        let mut before = line.total_energy(step);
        for _ in 0..100 {
            line.advance(ALL_SLOPES[number % 3], step);
            let now = line.total_energy(step);
            assert!(now <= before * (1.0 + 1e-13), "{number}: {now:e} after {before:e}");
            before = now;
        }
    }
}

/// Verifies second order for a step of velocity v₀ through an interlayer of mass m (kg/m²) and compliance C (m/Pa)
/// between half-spaces of impedance z, against the mean over each time step of the exact velocity behind the
/// interlayer, v⁺ = v₀(1 − exp(−2zt/m) − exp(−2t/(Cz))).
#[test]
fn velocity_step_through_an_interlayer_converges_at_second_order() {
    let (z, law) = (1.3, elastic_component(2.1, 0.7));
    let mean = |rate: f64, [from, to]: [f64; 2]| {
        ((-rate * from).exp() - (-rate * to).exp()) / (rate * (to - from))
    };
    let error = |count: usize| {
        let time = 2.0;
        let step = time / count as f64;
        let (mut history, mut max_error) = ([0.0; 3], 0.0f64);
        for i in 0..count {
            // Right-going wave with v = v₀ = 1: σ = −z v.
            let incoming = RiemannData { impedance: [z; 2], invariant: [2.0 * z, 0.0] };
            let FaceState { velocity, .. } = law.advance(incoming, step, &mut history)[1];
            let times = [i, i + 1].map(|i| i as f64 * step);
            let exact = 1.0
                - mean(2.0 * z / law.mass.mass, times)
                - mean(2.0 / (law.compliance * z), times);
            max_error = max_error.max((velocity - exact).abs());
        }
        max_error
    };
    let errors = [100, 200, 400, 800].map(error);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.9..2.1).contains(&order), "order {order}");
    }
}

/// Verifies the order in Δt, at fixed Courant number, for a smooth pulse through an interlayer on a line.
#[test]
fn pulse_through_an_interlayer_converges() {
    let (z, law) = (1.3f64, elastic_component(0.21, 0.07));
    // Transmission coefficient for e^{iωt}: z′ = √(m/C), ψ = 2 arctan ½ω√(mC).
    let layer_impedance = (law.mass.mass / law.compliance).sqrt();
    let transmitted = |frequency: f64| {
        let psi = 2.0 * (0.5 * frequency * (law.mass.mass * law.compliance).sqrt()).atan();
        let i = Complex::new(0.0, 0.5 * (z / layer_impedance + layer_impedance / z) * psi.sin());
        (Complex::from(psi.cos()) + i).inv()
    };
    // Ring of length 4 with c = 1: a right-going pulse centred at 1.4, the interlayer at 2. The run ends before any
    // wave reaches the interlayer a second time.
    let error = |count: usize, courant: f64, slopes: Slopes| {
        let h = 4.0 / count as f64;
        let steps = (1.5 / (courant * h)).round();
        let step = 1.5 / steps;
        let cells = vec![CellConstants::with_interfaces(z, step / h); count];
        let mut line = InterlayerLine::new_at_rest(cells, &[(count / 2, law)]);
        // Pulse cos⁸ πx of width 1.
        let pulse_shape = |x: f64| if x.abs() < 0.5 { (PI * x).cos().powi(8) } else { 0.0 };
        for i in 0..count {
            let x = (i as f64 + 0.5) * h - 1.4;
            line.velocity[i] = pulse_shape(x) / z;
            line.stress[i] = -pulse_shape(x);
        }
        for _ in 0..steps as usize {
            line.advance(slopes, step);
        }
        // Exact solution by a Fourier series of period 4.
        let harmonics = 400;
        let coefficient = |k: i32| {
            let points = 4000;
            let sum: Complex<f64> = (0..points)
                .map(|i| {
                    let t = 4.0 * (f64::from(i) + 0.5) / f64::from(points) - 2.0;
                    Complex::from_polar(pulse_shape(t), -0.5 * PI * f64::from(k) * t)
                })
                .sum();
            sum / f64::from(points)
        };
        let terms: Vec<_> = (-harmonics..=harmonics)
            .map(|k| (k, coefficient(k) * transmitted(0.5 * PI * f64::from(k))))
            .filter(|term| term.1.norm() > 1e-14)
            .collect();
        let exact = |x: f64| -> f64 {
            terms
                .iter()
                .map(|&(k, c)| (c * Complex::from_polar(1.0, 0.5 * PI * f64::from(k) * x)).re)
                .sum()
        };
        let mut total_error = 0.0;
        for i in count / 2..count {
            let x = (i as f64 + 0.5) * h;
            // Time minus travel time from the initial pulse centre at 1.4.
            total_error += h * (z * line.velocity[i] - exact(1.5 + 1.4 - x)).abs();
        }
        total_error
    };
    // The interlayer law is second-order accurate; lower-order reconstruction next to it hardly affects smooth waves.
    for (slopes, courant, min_order) in [
        (Slopes::Godunov, 1.0, 1.9),
        (Slopes::FourthOrder, 0.5, 1.8),
        (Slopes::Limited, 0.5, 1.8),
        (Slopes::Godunov, 0.5, 0.7),
    ] {
        let errors = [200, 400, 800].map(|count| error(count, courant, slopes));
        let order = (errors[1] / errors[2]).log2();
        println!("{slopes:?}, C = {courant}: {errors:?}, order {order}");
        assert!(order > min_order, "order {order}");
    }
}
