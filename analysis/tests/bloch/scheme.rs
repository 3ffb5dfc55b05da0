//! Discrete chain: eigenvalues of the update matrix of blocks at Courant number 1 with the layer laws of the models.

use super::media::{THICKNESSES, build_medium};
use models::interface::RiemannData;
use models::interface::elastic::ElasticComponent;
use models::interface::opening_line::{LayerMass, OpeningLine};
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::PI;
use wellposed_analysis::bloch::BlochError;
use wellposed_analysis::bloch::chain::{Chain, ChainElement, ChainPolarisation, LayerCompliance};

/// Number of cells of the block.
const CELLS_PER_BLOCK: usize = 10;
const TIME_STEP: f64 = 1.0;
/// Impedance of the block; speed 1, cells of length 1.
const IMPEDANCE: f64 = 2.0;

/// Layer of the test: mass, compliance C₀ and, if viscous, (C₁, τ).
#[derive(Clone, Copy)]
struct Layer {
    mass: LayerMass<f64>,
    compliance: f64,
    delayed: Option<[f64; 2]>,
}

/// Advances a period of the chain by one step. The state consists of the rightgoing (zv − σ) and the leftgoing (zv + σ)
/// Riemann invariants of the cells, then V, d, S and the traction of the delayed spring of the layer at the lower end;
/// `ghost` is the rightgoing invariant of the last cell of the previous period.
fn advance_period(layer: &Layer, ghost: f64, state: &[f64]) -> (Vec<f64>, f64) {
    let (right, rest) = state.split_at(CELLS_PER_BLOCK);
    let (left, history) = rest.split_at(CELLS_PER_BLOCK);
    let incoming = RiemannData { impedance: [IMPEDANCE; 2], invariant: [ghost, left[0]] };
    let mut variables = [history[0], history[1], history[2]];
    let mut spring = history[3];
    let states = match layer.delayed {
        None => {
            let law = ElasticComponent { mass: layer.mass, compliance: layer.compliance };
            law.advance(incoming, TIME_STEP, &mut variables)
        }
        Some([delayed, time]) => {
            // d = C₀Ṡ + ė with e = C₁s, S = s + τṡ, by the midpoint rule: s_mid = (s + rS_mid)/(1 + r), r = Δt/(2τ).
            let line =
                OpeningLine::new(incoming, layer.mass, [variables[0], variables[1]], TIME_STEP);
            let r = 0.5 * TIME_STEP / time;
            let rate = 2.0 * layer.compliance / TIME_STEP;
            let factor = 2.0 * delayed / TIME_STEP * r / (1.0 + r);
            let stress = variables[2];
            // d = rate (S_mid − S) + 2C₁(s_mid − s)/Δt,  s_mid − s = r(S_mid − s)/(1 + r).
            let middle = (rate * stress + factor * spring + line.free_opening_rate)
                / (rate + factor + line.admittance);
            let spring_middle = (spring + r * middle) / (1.0 + r);
            spring = 2.0 * spring_middle - spring;
            let finished = line.complete_step(middle);
            variables = [finished.motion[0], finished.motion[1], 2.0 * middle - stress];
            finished.states
        }
    };
    let [before, after] = states;
    let mut next = vec![0.0; state.len()];
    next[0] = IMPEDANCE * after.velocity - after.stress;
    next[1..CELLS_PER_BLOCK].copy_from_slice(&right[..CELLS_PER_BLOCK - 1]);
    next[CELLS_PER_BLOCK..2 * CELLS_PER_BLOCK - 1].copy_from_slice(&left[1..]);
    next[2 * CELLS_PER_BLOCK..2 * CELLS_PER_BLOCK + 3].copy_from_slice(&variables);
    next[2 * CELLS_PER_BLOCK + 3] = spring;
    // The leftgoing invariant that enters the last cell of the period before.
    (next, IMPEDANCE * before.velocity + before.stress)
}

/// Update matrix of a period at the phase shift κh: the step is linear, so its columns are steps of unit vectors.
fn update_matrix(layer: &Layer, shift: f64) -> DMatrix<Complex64> {
    let n = 2 * CELLS_PER_BLOCK + 4;
    let mut matrix = DMatrix::zeros(n, n);
    let mut unit = vec![0.0; n];
    // Fields of the next period are e^{−iκh} times those of this one.
    let phase = Complex64::from_polar(1.0, -shift);
    let mut add = |column: usize, weight: Complex64, (next, outgoing): (Vec<f64>, f64)| {
        for (row, value) in next.into_iter().enumerate() {
            matrix[(row, column)] += weight * value;
        }
        matrix[(2 * CELLS_PER_BLOCK - 1, column)] += weight * outgoing * phase;
    };
    for column in 0..n {
        unit[column] = 1.0;
        add(column, Complex64::from(1.0), advance_period(layer, 0.0, &unit));
        unit[column] = 0.0;
    }
    add(CELLS_PER_BLOCK - 1, phase.inv(), advance_period(layer, 1.0, &unit));
    matrix
}

fn build_chain(layer: &Layer) -> Chain {
    let [delayed, retardation_time] = layer.delayed.unwrap_or_default();
    let compliance = LayerCompliance { elastic: layer.compliance, delayed, retardation_time };
    Chain::new(vec![
        ChainElement::Block { length: CELLS_PER_BLOCK as f64, speed: 1.0, impedance: IMPEDANCE },
        ChainElement::Layer { mass: layer.mass, compliance },
    ])
    .and_then(|chain| chain.with_time_step(TIME_STEP))
    .expect("valid")
}

/// Frequencies −i ln(λ)/Δt of the eigenvalues λ of the update matrix.
fn scheme_frequencies(layer: &Layer, shift: f64) -> Vec<Complex64> {
    let values = update_matrix(layer, shift).schur().eigenvalues().expect("converged");
    let values = values.iter().filter(|value| value.norm() > 1e-8);
    values.map(|value| -Complex64::i() * value.ln() / TIME_STEP).collect()
}

/// Verifies that every branch of the chain with a time step is an eigenvalue of the update matrix of the scheme, and
/// every eigenvalue on the unit circle with 0 < ω < π/Δt a branch.
#[test]
fn frequencies_of_the_scheme_are_exact() {
    let (mut worst, mut count) = (0.0f64, 0);
    for (mass, compliance) in [(0.7, 3.0), (5.0, 0.2), (0.05, 20.0)] {
        for is_lumped in [false, true] {
            let mass = match is_lumped {
                true => LayerMass::new_lumped(mass),
                false => LayerMass::new_box(mass),
            };
            let layer = Layer { mass, compliance, delayed: None };
            let chain = build_chain(&layer);
            for shift in [0.2, 0.5 * PI, 2.8, PI] {
                let mut expected: Vec<f64> = scheme_frequencies(&layer, shift)
                    .iter()
                    .filter(|omega| omega.im.abs() < 1e-9)
                    .map(|omega| omega.re)
                    .filter(|omega| (1e-6..PI - 1e-6).contains(omega))
                    .collect();
                expected.sort_by(f64::total_cmp);
                // At κh and −κh the scheme has the same frequencies, once each with a positive and a negative sign.
                let found = chain.frequencies_below(shift, PI - 1e-6).expect("branches");
                assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
                for (found, expected) in found.iter().zip(&expected) {
                    worst = worst.max((found - expected).abs());
                    count += 1;
                }
                assert!(matches!(
                    chain.frequency(3 * CELLS_PER_BLOCK, shift),
                    Err(BlochError::NoSuchBranch { .. })
                ));
            }
        }
    }
    println!("{count} frequencies, worst {worst:e}/Δt");
    assert!(worst < 1e-12, "{worst:e}");
}

/// Verifies that damped waves of viscous layers are eigenvalues of the update matrix.
#[test]
fn damped_frequencies_of_the_scheme_are_exact() {
    let mut worst = 0.0f64;
    for is_lumped in [false, true] {
        let mass = if is_lumped { LayerMass::new_lumped(0.7) } else { LayerMass::new_box(0.7) };
        let layer = Layer { mass, compliance: 2.0, delayed: Some([3.0, 4.0]) };
        let chain = build_chain(&layer);
        for shift in [0.2, 0.5 * PI, 2.8] {
            let values = scheme_frequencies(&layer, shift);
            for branch in 0..6 {
                let found = chain.damped_frequency(branch, shift).expect("a wave");
                let distance = |value: &Complex64| (found - value).norm();
                worst = worst.max(values.iter().map(distance).fold(f64::INFINITY, f64::min));
                assert!(found.im > 0.0);
            }
        }
    }
    println!("worst {worst:e}/Δt");
    assert!(worst < 1e-12, "{worst:e}");
}

/// Verifies that a mode started from its eigenvector evolves as e^{iωt} over 2000 steps, band edges included.
#[test]
fn modes_of_the_scheme_oscillate_at_the_frequency_of_the_chain() {
    let mut worst = 0.0f64;
    for thickness in THICKNESSES {
        // Units: block of 10 cells and time steps, impedance 2.
        let medium = build_medium(thickness);
        let unit = medium.period / 5000.0 / CELLS_PER_BLOCK as f64;
        let factor = IMPEDANCE / (2700.0 * 5000.0) / unit;
        let layer = Layer {
            mass: LayerMass::new_box(medium.layer.mass() * factor),
            compliance: medium.layer.normal_compliance() / factor / unit / unit,
            delayed: None,
        };
        for shift in [0.25 * PI, 0.5 * PI, PI] {
            let omega = build_chain(&layer).frequency(0, shift).expect("a branch");
            let matrix = update_matrix(&layer, shift);
            let turn = Complex64::from_polar(1.0, omega * TIME_STEP);
            // Eigenvector by inverse iteration.
            let n = matrix.nrows();
            let shifted = &matrix - DMatrix::identity(n, n) * (turn * (1.0 + 1e-13));
            let factors = shifted.lu();
            let mut vector = DVector::from_element(n, Complex64::from(1.0));
            for _ in 0..3 {
                vector = factors.solve(&vector).expect("regular");
                vector /= Complex64::from(vector.norm());
            }
            let mut state = vector.clone();
            for _ in 0..2000 {
                state = &matrix * state;
            }
            let expected = Complex64::from_polar(1.0, 2000.0 * omega * TIME_STEP);
            worst = worst.max((state - vector * expected).norm());
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-11, "{worst:e}");
}

/// Verifies that the polarisation selects wave speed and layer stiffness.
#[test]
fn polarisations_differ() {
    let medium = build_medium(1e-3);
    let speeds = [ChainPolarisation::Longitudinal, ChainPolarisation::Transverse]
        .map(|p| super::media::build_single_block_chain(&medium, false, p).long_wave_speed());
    // One direction of layers only: ρ′δ/h once.
    for (speed, (stiffness, modulus)) in
        speeds.into_iter().zip(medium.layer_stiffness().into_iter().zip([6.75e10, 2.43e10]))
    {
        let compliance: f64 = 1.0 / modulus + 1.0 / (stiffness * 0.05);
        assert!((speed * (compliance * 2730.0).sqrt() - 1.0).abs() < 1e-14);
    }
}
