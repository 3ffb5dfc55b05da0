//! Sweeps of sixth and eighth order: symbol of the step, and what is refused.

use crate::support::random::NoiseSequence;
use models::solid::parameters::Isotropic;
use models::solid::waves::VelocityStressPair;
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::f64::consts::TAU;
use wellposed_dynamics::boundary::{Boundary, Condition};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::{Slopes, WideOrder};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;

const WIDE_ORDERS: [Slopes; 2] = [Slopes::Wide(WideOrder::Sixth), Slopes::Wide(WideOrder::Eighth)];

/// Turns a problem into one with a wide stencil: its first medium everywhere, without what such a stencil excludes. Faces
/// that were non-reflecting are free.
pub fn with_wide_stencil<const D: usize>(mut problem: Problem<D>, order: WideOrder) -> Problem<D> {
    problem.media.truncate(1);
    problem.cell_media.fill(0);
    problem.interlayers.clear();
    problem.metric = None;
    problem.scheme.slopes = Slopes::Wide(order);
    let close = |condition: &mut Condition| {
        if *condition == Condition::NonReflecting {
            *condition = Condition::Traction(0.0);
        }
    };
    for boundary in problem.boundaries.iter_mut().flatten() {
        match boundary {
            Boundary::NonReflecting => *boundary = Boundary::Free,
            Boundary::ByPair(conditions) => conditions.iter_mut().for_each(close),
            Boundary::ByFace(conditions) => conditions.iter_mut().flatten().for_each(close),
            Boundary::Periodic | Boundary::Fixed | Boundary::Free => {}
        }
    }
    problem
}

/// Wave numbers (periods along each axis of the grid) of twelve directions.
const DIRECTIONS: [[i32; 2]; 12] = [
    [1, 0],
    [0, 1],
    [1, 1],
    [1, -1],
    [2, 1],
    [1, 2],
    [2, -1],
    [3, 1],
    [1, 3],
    [3, 2],
    [-2, 3],
    [4, 3],
];

fn classical_medium() -> Medium {
    Medium::new(Isotropic::new(1.3, 0.7, 1.1, None).expect("sound moduli"), 2)
}

/// Factor by which a sweep multiplies the right-going wave exp(iθj): the polynomial through 2R + 1 cells around a cell, at
/// the distance C upwind of it (Strang 1962).
fn amplification(courant: f64, angle: f64, radius: i32) -> Complex64 {
    let nodes = || -radius..=radius;
    nodes()
        .map(|own| {
            let others = nodes().filter(|other| *other != own);
            let weight: f64 = others
                .map(|other| (-courant - f64::from(other)) / f64::from(own - other))
                .product();
            Complex64::from_polar(weight, f64::from(own) * angle)
        })
        .sum()
}

/// Matrix by which a sweep along an axis multiplies the amplitudes of the fields of a plane wave; `angle`: phase per cell
/// along the axis.
fn sweep_matrix(
    medium: &Medium,
    axis: usize,
    angle: f64,
    per_speed: f64,
    radius: i32,
) -> DMatrix<Complex64> {
    let count = medium.fields.len();
    let place = |field| medium.fields.iter().position(|own| *own == field).expect("a field");
    let mut product = DMatrix::identity(count, count);
    for pair in &medium.pairs[axis] {
        let pair: &VelocityStressPair = pair;
        let (velocity, stress) = (place(pair.velocity), place(pair.stress));
        let impedance = pair.impedance();
        let right = amplification(pair.speed() * per_speed, angle, radius);
        let left = right.conj();
        let mut matrix = DMatrix::identity(count, count);
        let (kept, exchanged) = ((right + left) * 0.5, (left - right) * 0.5);
        matrix[(velocity, velocity)] = kept;
        matrix[(stress, stress)] = kept;
        matrix[(velocity, stress)] = exchanged / impedance;
        matrix[(stress, velocity)] = exchanged * impedance;
        for (field, ratio) in &pair.passive_stresses {
            matrix[(place(*field), stress)] = (kept - 1.0) * *ratio;
            matrix[(place(*field), velocity)] = exchanged * impedance * *ratio;
        }
        product = matrix * product;
    }
    product
}

fn plane_problem(
    cells: [usize; 2],
    courant: f64,
    slopes: Slopes,
    splitting: Splitting,
) -> Problem<2> {
    let medium = classical_medium();
    let grid = Grid { cells, spacing: [0.2, 0.23] };
    let step = 2.0 * courant * 0.2 / medium.max_speed();
    let periodic = [Boundary::Periodic, Boundary::Periodic];
    let scheme = Scheme { splitting, ..Scheme::new(slopes, PlasticStep::ReturnMapping) };
    let count = grid.count();
    Problem::new(grid, vec![medium], vec![0; count], [periodic.clone(), periodic], step, scheme)
}

/// Verifies that plane waves of random amplitudes in twelve directions on three grids are multiplied by the product of the
/// matrices of the sweeps in each step: phase and damping of the step are those of its symbol. With alternating sweeps, one
/// of a quarter of a step along x starts the run and, for output, ends it.
#[test]
fn plane_waves_follow_the_symbol_of_the_step() {
    check_symbol(Splitting::TwoCyclic);
    check_symbol(Splitting::Alternating);
}

fn check_symbol(splitting: Splitting) {
    let mut random = NoiseSequence::new(7);
    let steps = 9;
    for (slopes, radius) in WIDE_ORDERS.into_iter().zip([3, 4]) {
        for (cells, courant) in [([12, 15], 1.0), ([20, 24], 0.6), ([31, 40], 0.17)] {
            let problem = plane_problem(cells, courant, slopes, splitting);
            let medium = &problem.media[0];
            for direction in DIRECTIONS {
                let angles: [f64; 2] = std::array::from_fn(|axis| {
                    TAU * f64::from(direction[axis]) / cells[axis] as f64
                });
                let [x, y, quarter] = [(0, 0.5), (1, 0.5), (0, 0.25)].map(|(axis, fraction)| {
                    let per_speed = fraction * problem.step / problem.grid.spacing[axis];
                    sweep_matrix(medium, axis, angles[axis], per_speed, radius)
                });
                let mut amplitudes = DMatrix::from_fn(medium.fields.len(), 1, |_, _| {
                    Complex64::new(random.uniform_symmetric(), random.uniform_symmetric())
                });
                let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
                let values = |amplitude: Complex64| -> Vec<f64> {
                    let value = |cell: usize| {
                        let angle = angles[0] * (cell % cells[0]) as f64
                            + angles[1] * (cell / cells[0]) as f64;
                        (amplitude * Complex64::cis(angle)).re
                    };
                    (0..cells[0] * cells[1]).map(value).collect()
                };
                for (field, amplitude) in medium.fields.iter().zip(&amplitudes) {
                    domain.set_field(*field, &values(*amplitude));
                }
                for step in 0..steps {
                    domain.advance();
                    let sweeps = match splitting {
                        Splitting::TwoCyclic => [&x, &y, &y, &x],
                        Splitting::Alternating if step == 0 => [&quarter, &y, &x, &y],
                        Splitting::Alternating => [&x, &y, &x, &y],
                    };
                    for sweep in sweeps {
                        amplitudes = sweep * amplitudes;
                    }
                }
                if splitting == Splitting::Alternating {
                    amplitudes = quarter * amplitudes;
                }
                let mut output = Vec::new();
                for cell in 0..cells[0] * cells[1] {
                    domain.output_cell(cell, &mut output);
                }
                let count = medium.fields.len();
                for (index, (field, amplitude)) in medium.fields.iter().zip(&amplitudes).enumerate()
                {
                    let found = output.iter().skip(index).step_by(count);
                    for (found, expected) in found.zip(values(*amplitude)) {
                        assert!(
                            (found - expected).abs() < 1e-12,
                            "{slopes:?} {cells:?} {direction:?} {field:?}: {found} {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// Verifies that rows of more groups than the sweep kernel keeps invariants of are those of the reference solver, bit by bit.
#[test]
fn long_rows_equal_the_reference() {
    let mut random = NoiseSequence::new(11);
    for slopes in WIDE_ORDERS {
        for side in [Boundary::Periodic, Boundary::Free] {
            // 163 groups of eight lanes, the last one not full.
            let mut problem = plane_problem([1301, 5], 0.8, slopes, Splitting::TwoCyclic);
            problem.boundaries[0] = [side.clone(), side];
            let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
            let mut reference: Reference<f64, 2> = Reference::new(&problem).expect("sound");
            for field in problem.media[0].fields.clone() {
                let values: Vec<f64> =
                    (0..problem.grid.count()).map(|_| random.uniform_symmetric()).collect();
                domain.set_field(field, &values);
                reference.set_field(field, &values);
            }
            (0..3).for_each(|_| domain.advance());
            reference.advance(3);
            for field in &problem.media[0].fields {
                assert_eq!(domain.values(*field), reference.values(*field), "{slopes:?} {field:?}");
            }
        }
    }
}

/// Verifies that wide stencils are refused where they are not valid.
#[test]
fn invalid_problems_are_refused() {
    for slopes in WIDE_ORDERS {
        let valid = plane_problem([12, 9], 0.5, slopes, Splitting::Alternating);
        assert!(valid.validate().is_ok());
        let refused = |change: fn(&mut Problem<2>)| {
            let mut problem = valid.clone();
            change(&mut problem);
            assert!(matches!(problem.validate(), Err(DomainError::WideStencil(_))));
        };
        refused(|problem| problem.media.push(classical_medium()));
        refused(|problem| {
            problem.grid.cells = [54, 2];
        });
        // Non-reflecting sides, as a whole, for one pair of fields, or on one face.
        refused(|problem| problem.boundaries[1] = [Boundary::Free, Boundary::NonReflecting]);
        refused(|problem| {
            let open = vec![Condition::Traction(0.0), Condition::NonReflecting];
            problem.boundaries[0] = [Boundary::ByPair(open), Boundary::Fixed];
        });
        refused(|problem| {
            let mut by_face = vec![vec![Condition::Velocity(0.0); 9]; 2];
            by_face[1][8] = Condition::NonReflecting;
            problem.boundaries[0] = [Boundary::Free, Boundary::ByFace(by_face)];
        });
        let symmetry = Boundary::new_symmetry(&valid.media[0], 1);
        let boundaries = [[Boundary::Free, Boundary::Fixed], [symmetry, Boundary::Free]];
        assert!(Problem { boundaries, ..valid }.validate().is_ok());
    }
}
