//! Plane waves of every branch in the plane and in space: errors and orders of convergence against the exact solution.

use crate::support::media::{THEORIES, isotropic, rate_equations, unknown_name};
use models::common::rates::SymmetricForm;
use models::solid::parameters::Theory;
use models::solid::waves::SolidField;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;
use std::f64::consts::PI;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};

/// Computes frequencies ω (rad/s, positive, ascending) and amplitudes û of the plane waves U = Re û exp(i(κ·x − ωt))
/// with the wave vector κ, from the symmetric form with the matrices A, B and Q: i L⁻¹(iκB + Q)L⁻ᵀ y = ω y, with
/// A = LLᵀ and û = L⁻ᵀ y.
fn plane_wave_modes<const D: usize>(
    form: &SymmetricForm<D>,
    wave: [f64; D],
) -> Vec<(f64, DVector<Complex64>)> {
    let lower = form.a.clone().cholesky().expect("positive definite").l();
    let inverse = lower.clone().try_inverse().expect("regular");
    let half = |m: &DMatrix<f64>| &inverse * m * inverse.transpose();
    let mut symbol = half(&form.q).map(|x| Complex64::new(0.0, x));
    for (b, k) in form.b.iter().zip(wave) {
        symbol += half(b).map(|x| Complex64::new(-k * x, 0.0));
    }
    let symbol = (&symbol + symbol.adjoint()).scale(0.5);
    let eigen = symbol.symmetric_eigen();
    let back = inverse.transpose().map(Complex64::from);
    let mut modes: Vec<(f64, DVector<Complex64>)> = (0..eigen.eigenvalues.len())
        .filter(|&i| eigen.eigenvalues[i] > 1e-6)
        .map(|i| (eigen.eigenvalues[i], &back * eigen.eigenvectors.column(i)))
        .collect();
    modes.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Shear waves in space have double eigenvalues, whose eigenvectors are arbitrary: choose two linear polarisations
    // normal to the wave vector in which all fields are non-zero.
    for i in 1..modes.len() {
        if modes[i].0 - modes[i - 1].0 < 1e-9 * modes[i].0 {
            let pair = [modes[i - 1].1.clone(), modes[i].1.clone()];
            let across = [[1.0, -1.0, 0.0], [1.0, 1.0, -2.0]];
            let part = |mode: usize, axis: usize| -> Complex64 {
                (0..3).map(|j| pair[mode][j] * across[axis][j]).sum::<Complex64>()
                    / across[axis].iter().map(|x| x * x).sum::<f64>().sqrt()
            };
            let [[a, b], [c, d]] = [0, 1].map(|axis| [0, 1].map(|mode| part(mode, axis)));
            for (place, turn) in [(i - 1, 0.3), (i, 0.3 + 0.5 * PI)] {
                let [p, q] = [turn.cos(), turn.sin()];
                let shares = [d * p - b * q, a * q - c * p];
                let size = shares[0].norm().hypot(shares[1].norm());
                modes[place].1 = (&pair[0] * shares[0] + &pair[1] * shares[1]).unscale(size);
            }
        }
    }
    modes
}

/// Computes the errors of a plane wave of unit energy density, means over the cells, maxima over several times: of each
/// component, and of velocity, spin, stress and couple stress as vectors or tensors.
fn plane_wave_errors<const D: usize>(
    theory: Theory,
    count: usize,
    branch: usize,
    slopes: Slopes,
) -> PlaneWaveErrors {
    let solid = isotropic(theory, 1.0);
    let equations = rate_equations::<D>(&solid);
    let form = equations.symmetric_form().expect("elastic");
    let wave = wave_vector::<D>();
    let (frequency, amplitude) = plane_wave_modes(&form, wave).swap_remove(branch);
    let medium = Medium::new(solid, D);
    let h = 1.0 / count as f64;
    // End time in wave periods, not an integer; the Courant number is no integer for any family of waves.
    const END_TIME_PERIODS: f64 = 2.87;
    let time = END_TIME_PERIODS * 2.0 * PI / frequency;
    // Steps in proportion to the cells, so that the Courant number is the same on all grids.
    let steps = (16.0 * time * medium.max_speed() / (2.0 * 0.93)).ceil() / 16.0 / h;
    let steps = steps.round();
    let grid = Grid { cells: [count; D], spacing: [h; D] };
    let mut domain: Domain<f64, D> = Domain::new(&Problem::new(
        grid,
        vec![medium],
        vec![0; count.pow(D as u32)],
        std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]),
        time / steps,
        Scheme::new(slopes, PlasticStep::MidpointReflection),
    ))
    .expect("a sound domain");
    // Cell means: the value at the cell centre times a factor for each axis.
    let factor: f64 = wave.iter().map(|k| (0.5 * k * h).sin() / (0.5 * k * h)).product();
    let phase = |cell: usize| -> f64 {
        let mut remaining_index = cell;
        wave.iter()
            .map(|k| {
                let index = remaining_index % count;
                remaining_index /= count;
                k * h * (index as f64 + 0.5)
            })
            .sum()
    };
    let fields = domain.fields().to_vec();
    // Index of a field among the unknowns of the rate equations.
    let unknown_index = |field: &SolidField| {
        let name = unknown_name(*field);
        let unknown_index = equations.unknowns.iter().position(|unknown| unknown.name == name);
        unknown_index.expect("an unknown")
    };
    let unknown_indices: Vec<usize> = fields.iter().map(unknown_index).collect();
    let exact = |unknown_index: usize, cell: usize, time: f64| {
        factor * (amplitude[unknown_index] * Complex64::cis(phase(cell) - frequency * time)).re
    };
    let cells = count.pow(D as u32);
    for (&field, &unknown_index) in fields.iter().zip(&unknown_indices) {
        domain.set_field(
            field,
            &(0..cells).map(|cell| exact(unknown_index, cell, 0.0)).collect::<Vec<_>>(),
        );
    }
    let kind = |field: &SolidField| match field {
        SolidField::Velocity(_) => 0,
        SolidField::Spin(_) => 1,
        SolidField::Couple(..) => 3,
        _ => 2,
    };
    // Errors are evaluated at several times, since at a single one errors of different kinds may cancel.
    let mut max_errors = vec![0.0f64; fields.len()];
    let mut max_errors_by_kind = [0.0f64; 4];
    let mut done = 0;
    for instant in [1.37, 1.87, 2.37, END_TIME_PERIODS] {
        let until = (steps * instant / END_TIME_PERIODS).round() as usize;
        for _ in done..until {
            domain.advance();
        }
        done = until;
        let time = time / steps * until as f64;
        let mut squares = vec![[0.0f64; 4]; cells];
        for ((field, &unknown_index), max_error) in
            fields.iter().zip(&unknown_indices).zip(&mut max_errors)
        {
            // Errors are in units of the square root of energy: the wave has unit energy density, and some fields
            // vanish in it.
            let weight = form.a[(unknown_index, unknown_index)].sqrt();
            let values = domain.values(*field).expect("a field");
            let mut sum = 0.0;
            for ((cell, value), squares) in values.iter().enumerate().zip(&mut squares) {
                let error = weight * (value - exact(unknown_index, cell, time)).abs();
                sum += error;
                squares[kind(field)] += error * error;
            }
            *max_error = max_error.max(sum / cells as f64);
        }
        for (kind, max_error) in max_errors_by_kind.iter_mut().enumerate() {
            let sum: f64 = squares.iter().map(|squares| squares[kind].sqrt()).sum();
            *max_error = max_error.max(sum / cells as f64);
        }
    }
    PlaneWaveErrors {
        component_errors: fields.iter().map(|field| unknown_name(*field)).zip(max_errors).collect(),
        field_errors: FIELD_KINDS.into_iter().zip(max_errors_by_kind).collect(),
    }
}

const FIELD_KINDS: [&str; 4] = ["velocity", "spin", "stress", "couple stress"];

/// Errors of a plane wave by component, and by field (velocity, spin, stress, couple stress), with their names.
struct PlaneWaveErrors {
    component_errors: Vec<(String, f64)>,
    field_errors: Vec<(&'static str, f64)>,
}

impl PlaneWaveErrors {
    /// Returns the largest error of all components.
    fn max_component_error(&self) -> f64 {
        self.component_errors.iter().map(|own| own.1).fold(0.0, f64::max)
    }
}

/// Returns the wave vector: 2π (1, 2) in the plane, 2π (1, 1, 1) in space.
fn wave_vector<const D: usize>() -> [f64; D] {
    std::array::from_fn(|axis| if D == 2 && axis == 1 { 4.0 * PI } else { 2.0 * PI })
}

fn branch_count<const D: usize>(theory: Theory) -> usize {
    let form = rate_equations::<D>(&isotropic(theory, 1.0)).symmetric_form().expect("elastic");
    let wave = wave_vector::<D>();
    plane_wave_modes(&form, wave).len()
}

/// Verifies the order of convergence between the two finest grids for every branch: at least `least[0]` for the largest
/// component error, at least `least[1]` for each field whose error exceeds a tenth of the largest one. Orders of single
/// components are only printed: where errors of different origin cancel, they are not asymptotic.
fn check_orders<const D: usize>(counts: &[usize], slopes: Slopes, min_orders: [f64; 2]) {
    let [.., second_finest, finest] = counts else { panic!("two grids") };
    let order_of = |[before, after]: [f64; 2]| {
        (before / after).ln() / (*finest as f64 / *second_finest as f64).ln()
    };
    let mut low_orders = Vec::new();
    for theory in THEORIES {
        for branch in 0..branch_count::<D>(theory) {
            let errors: Vec<PlaneWaveErrors> =
                counts.iter().map(|&n| plane_wave_errors::<D>(theory, n, branch, slopes)).collect();
            let [.., coarse, fine] = errors.as_slice() else { panic!("two grids") };
            let largest_error = fine.max_component_error();
            let component_errors: Vec<f64> =
                errors.iter().map(PlaneWaveErrors::max_component_error).collect();
            let order = order_of([coarse.max_component_error(), largest_error]);
            println!(
                "{D}D {theory:?} branch {branch} {slopes:?}: errors {component_errors:?}, order {order:.3}"
            );
            if order <= min_orders[0] {
                low_orders.push(format!("{theory:?} branch {branch}: order {order}"));
            }
            for ((field, before), (_, after)) in coarse.field_errors.iter().zip(&fine.field_errors)
            {
                let field_order = order_of([*before, *after]);
                if *after > 1e-6 * largest_error {
                    println!("  {field} {after:.2e} order {field_order:.3}");
                }
                // Fields with small errors are perturbed by the errors of the others.
                if *after > 0.1 * largest_error && field_order <= min_orders[1] {
                    low_orders
                        .push(format!("{theory:?} branch {branch} {field}: order {field_order}"));
                }
            }
            for ((name, before), (_, after)) in
                coarse.component_errors.iter().zip(&fine.component_errors)
            {
                if *after > 1e-6 * largest_error {
                    println!("    {name} {after:.2e} order {:.3}", order_of([*before, *after]));
                }
            }
        }
    }
    assert!(low_orders.is_empty(), "{D}D {slopes:?}: {low_orders:#?}");
}

#[test]
fn plane_waves_converge_in_the_plane_without_limiter() {
    check_orders::<2>(&[64, 128], Slopes::FourthOrder, [1.9, 1.8]);
}

#[test]
fn plane_waves_converge_in_the_plane() {
    // On 64 cells the limiter still clips a considerable fraction of each crest.
    check_orders::<2>(&[128, 256], Slopes::Limited, [1.85, 1.85]);
}

#[test]
fn plane_waves_converge_in_space() {
    check_orders::<3>(&[16, 32], Slopes::FourthOrder, [1.8, 1.8]);
}

/// Verifies the orders of every branch on grids fine enough for the asymptotic orders of the scheme.
#[test]
#[ignore = "two minutes: cargo test --release -p wellposed-dynamics --test solid plane_waves::fine -- --ignored --nocapture"]
fn fine_grids_in_the_plane_show_the_asymptotic_orders() {
    check_orders::<2>(&[64, 128, 256, 512], Slopes::Limited, [1.9; 2]);
    check_orders::<2>(&[64, 128, 256, 512], Slopes::FourthOrder, [1.9; 2]);
}

/// Verifies the orders in space; a wavelength is 74 cells of the finest grid.
#[test]
#[ignore = "half an hour"]
fn fine_grids_in_space_show_the_asymptotic_orders() {
    check_orders::<3>(&[16, 32, 64, 128], Slopes::Limited, [1.9; 2]);
}

#[test]
#[ignore = "half an hour"]
fn fine_grids_in_space_without_limiter_show_the_asymptotic_orders() {
    check_orders::<3>(&[16, 32, 64, 128], Slopes::FourthOrder, [1.9; 2]);
}
