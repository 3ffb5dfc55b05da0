//! Tests of the energy stability of the linear schemes: the largest singular value of the sweep of a line, for all
//! pairs of boundary conditions, many Courant numbers, and random media.

use crate::simd::{LaneGroup, Real};
use crate::solid::boundary::{Boundary, Condition};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{CLOSURE_CELLS, GhostCoefficients, GhostRule, compute_ghosts};
use crate::solid::line::sweep;
use crate::solid::random_lines::LinearCongruentialGenerator;
use crate::solid::reconstruction::{Slopes, WideOrder};
use crate::solid::riemann::State;
use nalgebra::DMatrix;

const FREE_BOUNDARY: Condition = Condition::Traction(0.0);
const FIXED_BOUNDARY: Condition = Condition::Velocity(0.0);
const CONDITIONS: [Condition; 5] = [
    FREE_BOUNDARY,
    FIXED_BOUNDARY,
    Condition::NonReflecting,
    Condition::OddVelocity,
    Condition::OddStress,
];

/// Sweeps a line between two boundaries once with a linear reconstruction.
fn sweep_between_boundaries<T: Real>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    conditions: [Condition; 2],
    slopes: Slopes,
) {
    let count = cells.len();
    let state = |i: usize| State { velocity: velocity[i], stress: stress[i] };
    let ghosts = [0, 1].map(|end| {
        let cell_index = |depth: usize| if end == 0 { depth } else { count - 1 - depth };
        let boundary = Boundary::ByPair(vec![conditions[end]]);
        let beside = if slopes.is_wide() { Slopes::Godunov } else { slopes };
        let ghost_rule: GhostRule<T> =
            GhostRule::new(&boundary, 1, (&[(0, (0, 0))], 1), false, beside);
        let numbers = ghost_rule.group_coefficients(0, 0).map(|lanes| lanes.lanes()[0]);
        let outer_indices: [usize; CLOSURE_CELLS] =
            std::array::from_fn(|depth| cell_index(depth.min(count - 1)));
        let outer_cells = outer_indices.map(|i| &cells[i]);
        if count >= CLOSURE_CELLS && !slopes.is_wide() {
            let coefficients = GhostCoefficients::new(outer_cells[0]);
            compute_ghosts(
                ghost_rule.closure(),
                outer_indices.map(state),
                numbers,
                end,
                outer_cells,
                &coefficients,
            )
            .to_vec()
        } else {
            let image = |depth| {
                let image_source = state(cell_index(depth));
                let [v, a, s, b, _] = numbers;
                State {
                    velocity: v * image_source.velocity + a,
                    stress: s * image_source.stress + b,
                }
            };
            (0..slopes.ghosts()).map(image).collect()
        }
    });
    let line = |own: &[T], pick: fn(&State<T>) -> T| -> Vec<T> {
        let mut line_values: Vec<T> = ghosts[0].iter().rev().map(pick).collect();
        line_values.extend(own);
        line_values.extend(ghosts[1].iter().map(pick));
        line_values
    };
    let ghosts = slopes.ghosts();
    let all_cells: Vec<_> = cells[..ghosts]
        .iter()
        .rev()
        .chain(cells)
        .chain(cells[count - ghosts..].iter().rev())
        .copied()
        .collect();
    let mut v = line(velocity, |own| own.velocity);
    let mut s = line(stress, |own| own.stress);
    sweep(&mut v, &mut s, &all_cells, slopes, None);
    velocity.copy_from_slice(&v[ghosts..ghosts + count]);
    stress.copy_from_slice(&s[ghosts..ghosts + count]);
}

/// Computes ‖G‖² − 1 of a sweep G, in the energy norm with the square Σ (zv² + s²/z)/C over the cells.
fn energy_growth<T: Real>(
    cells: &[CellConstants<T>],
    conditions: [Condition; 2],
    slopes: Slopes,
) -> f64 {
    let count = cells.len();
    let unit = |i: usize| {
        let (z, c) = (cells[i % count].impedance.to_f64(), cells[i % count].courant().to_f64());
        if i < count { (z / c).sqrt() } else { (1.0 / (z * c)).sqrt() }
    };
    let columns: Vec<Vec<f64>> = (0..2 * count)
        .map(|one| {
            let mut v = vec![T::ZERO; count];
            let mut s = vec![T::ZERO; count];
            if one < count {
                v[one] = T::from_f64(1.0 / unit(one))
            } else {
                s[one - count] = T::from_f64(1.0 / unit(one))
            }
            sweep_between_boundaries(&mut v, &mut s, cells, conditions, slopes);
            v.iter().chain(&s).enumerate().map(|(i, x)| x.to_f64() * unit(i)).collect()
        })
        .collect();
    let matrix = DMatrix::from_fn(2 * count, 2 * count, |i, j| columns[j][i]);
    let norm = matrix
        .try_svd(false, false, f64::EPSILON, 1000)
        .map_or(f64::NAN, |own| own.singular_values.max());
    norm * norm - 1.0
}

/// Keeps the larger of two growths and its description; a growth that is NaN counts as the largest.
fn update_maximum(maximum: &mut (f64, String), growth: f64, describe: impl Fn() -> String) {
    if growth.is_nan() || growth > maximum.0 {
        *maximum = (growth, describe());
    }
}

#[test]
fn no_line_gains_energy() {
    check_lines(Slopes::FourthOrder, &[2, 3, 4, 5, 6, 9]);
}

#[test]
fn no_line_gains_energy_with_wide_stencils() {
    check_lines(Slopes::Wide(WideOrder::Sixth), &[3, 4, 7, 11]);
    check_lines(Slopes::Wide(WideOrder::Eighth), &[4, 5, 8, 13]);
}

/// Verifies that no line of one medium gains energy, for lines of `counts` cells.
fn check_lines(slopes: Slopes, counts: &[usize]) {
    let mut maximum = (f64::MIN, String::new());
    let courants =
        (1..100).map(|i| 0.01 * f64::from(i)).chain([1e-4, 0.999, 0.9999, 0.999_999_9, 1.0]);
    for courant in courants {
        for &count in counts {
            let cells = vec![CellConstants::<f64>::new(1.0, courant); count];
            for one in CONDITIONS {
                for other in CONDITIONS {
                    let growth = energy_growth(&cells, [one, other], slopes);
                    update_maximum(&mut maximum, growth, || {
                        format!("C = {courant}, {count} cells, {one:?}, {other:?}")
                    });
                }
            }
        }
    }
    println!("{maximum:?}");
    assert!(maximum.0 < 1e-14, "{maximum:?}");
}

/// Verifies that no wave gains energy in lines of random blocks of media, from single cells to long blocks.
#[test]
fn no_line_of_several_media_gains_energy() {
    let mut random = LinearCongruentialGenerator::new(1);
    let mut maximum = (f64::MIN, String::new());
    for attempt in 0..20000 {
        let cells = random.cells([3.0, 15.0], attempt);
        let conditions = [0, 1].map(|_| CONDITIONS[random.uniform(0.0, 5.0) as usize]);
        let shape: Vec<_> = cells.iter().map(|cell| (cell.impedance, cell.courant())).collect();
        let growth = energy_growth(&cells, conditions, Slopes::FourthOrder);
        update_maximum(&mut maximum, growth, || format!("{conditions:?}, {shape:?}"));
    }
    println!("{maximum:?}");
    assert!(maximum.0 < 1e-14, "{maximum:?}");
}

const LINEAR_ORDERS: [Slopes; 3] =
    [Slopes::FourthOrder, Slopes::Wide(WideOrder::Sixth), Slopes::Wide(WideOrder::Eighth)];

/// Verifies that in single precision the energy grows by no more than rounding errors.
#[test]
fn single_precision_energy_grows_by_rounding_only() {
    let mut maximum = (f64::MIN, String::new());
    for courant in (1..100).map(|i| 0.01 * f64::from(i)).chain([0.999, 0.9999, 1.0]) {
        let cells = vec![CellConstants::<f32>::new(1.0, courant); 5];
        for slopes in LINEAR_ORDERS {
            for one in CONDITIONS {
                for other in CONDITIONS {
                    let growth = energy_growth(&cells, [one, other], slopes);
                    update_maximum(&mut maximum, growth, || {
                        format!("{slopes:?}, C = {courant}, {one:?}, {other:?}")
                    });
                }
            }
        }
    }
    println!("{maximum:?}");
    assert!(maximum.0 < 1e-6, "{maximum:?}");
}
