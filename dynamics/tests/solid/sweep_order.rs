//! Sweeps that start with another axis: the result must equal that of the same body in permuted coordinates with sweeps
//! that start with the first axis.

use crate::support::noise;
use models::rheology::relaxation::StandardLinearSolid;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use std::sync::Arc;
use wellposed_dynamics::boundary::{Boundary, Condition, Load, Source};
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{
    Grid, PlasticStep, Problem, Scheme, Splitting, choose_first_axis,
};
use wellposed_dynamics::reference::Reference;

/// Numbers of cells along the axes of the body.
const BODY_CELLS: [usize; 3] = [11, 13, 9];

/// Coordinate axis of each axis of the body; an even permutation, so that spins keep their signs.
type Frame = [usize; 3];
const BODY_FRAME: Frame = [0, 1, 2];
/// Frame in which the body's third axis is the first.
const ROTATED_FRAME: Frame = [1, 2, 0];

fn field_in_frame(field: SolidField, frame: Frame) -> SolidField {
    match field {
        SolidField::Velocity(i) => SolidField::Velocity(frame[i]),
        SolidField::Spin(k) => SolidField::Spin(frame[k]),
        SolidField::Stress(i, j) => SolidField::Stress(frame[i], frame[j]),
        SolidField::Couple(k, j) => SolidField::Couple(frame[k], frame[j]),
        SolidField::ViscousStrain(i, j) => {
            let [i, j] = [frame[i], frame[j]];
            SolidField::ViscousStrain(i.min(j), i.max(j))
        }
        SolidField::ExcessStress(i, j) => {
            let [i, j] = [frame[i], frame[j]];
            SolidField::ExcessStress(i.min(j), i.max(j))
        }
        SolidField::SpringStress(i, j) => {
            let [i, j] = [frame[i], frame[j]];
            SolidField::SpringStress(i.min(j), i.max(j))
        }
        SolidField::PlasticStrain(i, j) => {
            let [i, j] = [frame[i], frame[j]];
            SolidField::PlasticStrain(i.min(j), i.max(j))
        }
        SolidField::VolumetricStrain | SolidField::PoreClosure => field,
    }
}

/// Returns the indices of a cell along the axes of the body.
fn body_indices(cell: usize, frame: Frame) -> [usize; 3] {
    let mut indices = [0; 3];
    let mut remaining_index = cell;
    for axis in 0..3 {
        let body_axis = frame.iter().position(|to| *to == axis).expect("an axis");
        indices[body_axis] = remaining_index % BODY_CELLS[body_axis];
        remaining_index /= BODY_CELLS[body_axis];
    }
    indices
}

fn cell_in_frame(indices: [usize; 3], frame: Frame) -> usize {
    let cell_count: usize = BODY_CELLS.iter().product();
    (0..cell_count).find(|cell| body_indices(*cell, frame) == indices).expect("a cell")
}

/// Returns a pseudo-random number for a cell of the body and a quantity.
fn body_cell_noise(indices: [usize; 3], number: usize) -> f64 {
    noise((indices[0] + 100 * (indices[1] + 100 * (indices[2] + 100 * number))) as u64)
}

fn problem_in_frame(frame: Frame) -> Problem<3> {
    let rotation = |factor: f64| Microrotation {
        alpha: 0.6,
        inertia: 0.37,
        couple: Some(CoupleModuli { beta: 0.3 * factor, gamma: 0.7 * factor, eta: 0.45 * factor }),
    };
    let set = YieldSet::from(Mises {
        antisymmetric_weight: 0.5,
        ..Mises::new_drucker_prager(0.3, 0.2, 0.2)
    });
    let media = [1.0, 2.3].map(|factor| {
        let solid = Isotropic::new(1.4 * factor, 0.9 * factor, 1.2, Some(rotation(factor)));
        let solid = solid.expect("sound moduli");
        let relaxing = StandardLinearSolid::from_unrelaxed(solid, 0.4, 0.2);
        match factor > 1.0 {
            true => Medium::new(solid, 3).with_yield_set(set.clone()),
            false => Medium::with_relaxation(relaxing.expect("sound constants"), 3),
        }
    });
    let count: usize = BODY_CELLS.iter().product();
    let cell_media = (0..count).map(|cell| u16::from(body_indices(cell, frame)[2] > 4)).collect();
    let mut grid = Grid { cells: [0; 3], spacing: [0.0; 3] };
    for (own, to) in frame.into_iter().enumerate() {
        grid.cells[to] = BODY_CELLS[own];
        grid.spacing[to] = [0.1, 0.12, 0.11][own];
    }
    // Boundary conditions: by face and component across the body's first axis, periodic across the second, free and
    // fixed across the third.
    let component = |pair_velocity: SolidField, number: usize| {
        let body = |to: usize| frame.iter().position(|own| *own == to).expect("an axis");
        match pair_velocity {
            SolidField::Velocity(i) => number + body(i),
            SolidField::Spin(k) => number + 3 + body(k),
            other => panic!("{other:?} is no velocity"),
        }
    };
    let face_cells = |own: usize| -> Vec<[usize; 3]> {
        (0..count)
            .map(|cell| body_indices(cell, frame))
            .filter(|indices| indices[own] == 0)
            .collect()
    };
    let by_face = |end: usize| {
        let pairs = media[0].pairs[frame[0]].iter();
        let pair_conditions = |velocity: SolidField| {
            let condition = |indices: &[usize; 3]| match body_cell_noise(
                *indices,
                component(velocity, 10 * end),
            ) {
                value if value < -0.3 => Condition::Velocity(0.1 * value),
                value if value < 0.3 => Condition::Traction(0.1 * value),
                _ => Condition::NonReflecting,
            };
            face_cells(0).iter().map(condition).collect()
        };
        Boundary::ByFace(pairs.map(|pair| pair_conditions(pair.velocity)).collect())
    };
    let mut boundaries = [(); 3].map(|()| [Boundary::Periodic, Boundary::Periodic]);
    boundaries[frame[0]] = [by_face(0), by_face(1)];
    boundaries[frame[2]] = [Boundary::Free, Boundary::Fixed];
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let scheme = Scheme {
        splitting: Splitting::Alternating,
        ..Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping)
    };
    let step = 1.7 * 0.1 / speed;
    let mut problem = Problem::new(grid, media.to_vec(), cell_media, boundaries, step, scheme);
    let normal = SolidField::Velocity(frame[2]);
    let pairs = &problem.media[0].pairs[frame[2]];
    let pair = pairs.iter().position(|pair| pair.velocity == normal).expect("a pair");
    let faces =
        face_cells(2).iter().map(|indices| body_cell_noise(*indices, 50)).enumerate().collect();
    let signal = Arc::new(move |time: f64| 0.3 * (0.7 * time / step).sin());
    problem.loads.push(Load { axis: frame[2], end: 0, pair, faces, signal: signal.clone() });
    let amplitudes = [SolidField::Velocity(1), SolidField::Spin(0), SolidField::Stress(0, 2)];
    problem.sources.push(Source {
        cells: [[3, 4, 5], [10, 0, 8]].map(|indices| (cell_in_frame(indices, frame), 0.5)).to_vec(),
        amplitudes: amplitudes.map(|own| (field_in_frame(own, frame), 1e-3)).to_vec(),
        signal,
    });
    problem.acceleration[frame[1]] = 0.3;
    problem
}

#[test]
fn changing_the_first_axis_is_a_rotation_of_the_body() {
    let steps = 12;
    let watched = [[0, 0, 0], [5, 6, 7], [10, 12, 8], [3, 1, 0]];
    let run = |frame: Frame, first: usize, parts: usize| {
        let problem = problem_in_frame(frame);
        let mut decomposed =
            DecomposedDomain::<f64, 3>::with_first_axis(first, &problem, parts).expect("sound");
        let count: usize = BODY_CELLS.iter().product();
        // Fields in the order of the solver in the frame of the body.
        let fields = DecomposedDomain::<f64, 3>::new(&self::problem_in_frame(BODY_FRAME), 1)
            .expect("sound")
            .fields()
            .to_vec();
        for (number, own) in fields.iter().enumerate() {
            let value =
                |cell: usize| 0.2 * body_cell_noise(body_indices(cell, frame), 100 + number);
            decomposed
                .set_field(field_in_frame(*own, frame), &(0..count).map(value).collect::<Vec<_>>());
        }
        decomposed.watch_cells(&watched.map(|at| cell_in_frame(at, frame)));
        decomposed.advance(steps).expect("threads");
        let solver_fields = decomposed.fields().to_vec();
        let index_of =
            |own: SolidField| solver_fields.iter().position(|to| *to == field_in_frame(own, frame));
        // Results by field and cell of the body: output values, solver values, records, dissipated energy.
        let cells: Vec<usize> =
            (0..count).map(|own| cell_in_frame(body_indices(own, BODY_FRAME), frame)).collect();
        let output = decomposed.output_values();
        let records = decomposed.take_records();
        let width = decomposed.quantity_count();
        let mut results: Vec<Vec<f64>> = Vec::new();
        for own in fields {
            let index = index_of(own).expect("a field");
            results.push(cells.iter().map(|cell| output[index][*cell]).collect());
            let values = decomposed.values(field_in_frame(own, frame)).expect("a field");
            results.push(cells.iter().map(|cell| values[*cell]).collect());
            results.push(records.chunks_exact(width).map(|values| values[index]).collect());
        }
        let dissipated = decomposed.plastic_dissipation();
        results.push(cells.iter().map(|cell| dissipated[*cell]).collect());
        (results, decomposed.energy().total(), decomposed.ledger().boundary_work)
    };
    let (rotated, energy, inflow) = run(ROTATED_FRAME, 0, 1);
    let (same, _, _) = run(BODY_FRAME, 2, 3);
    let (found, other_energy, other_inflow) = run(BODY_FRAME, 2, 1);
    // Results are equal up to rounding only: the projection onto the yield set sums components in the order of the
    // axes.
    let largest = rotated.iter().flatten().fold(0.0, |most: f64, value| most.max(value.abs()));
    for (own, other) in rotated.iter().flatten().zip(found.iter().flatten()) {
        assert!((own - other).abs() < 1e-12 * largest, "{own} or {other}");
    }
    assert!((energy - other_energy).abs() < 1e-12 * energy);
    assert!((inflow - other_inflow).abs() < 1e-12 * energy);
    let bits = |all: &[Vec<f64>]| all.concat().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&same), bits(&found));
    // The reference solver agrees if its sweeps start with the same axis.
    let problem = problem_in_frame(BODY_FRAME);
    let mut decomposed =
        DecomposedDomain::<f64, 3>::with_first_axis(2, &problem, 1).expect("sound");
    let mut reference = Reference::<f64, 3>::with_first_axis(2, &problem).expect("sound");
    let count: usize = BODY_CELLS.iter().product();
    for (number, field) in decomposed.fields().to_vec().into_iter().enumerate() {
        let value =
            |cell: usize| 0.2 * body_cell_noise(body_indices(cell, BODY_FRAME), 100 + number);
        let values: Vec<f64> = (0..count).map(value).collect();
        decomposed.set_field(field, &values);
        reference.set_field(field, &values);
    }
    let watched = watched.map(|at| cell_in_frame(at, BODY_FRAME));
    decomposed.watch_cells(&watched);
    reference.watch_cells(&watched);
    decomposed.advance(steps).expect("threads");
    reference.advance(steps);
    assert_eq!(decomposed.take_records(), reference.take_records());
    assert_eq!(bits(&decomposed.output_values()), bits(&reference.output_values()));
    assert_eq!(decomposed.plastic_dissipation(), reference.plastic_dissipation());
    assert_eq!(decomposed.snapshot().fields, reference.snapshot().fields);
    // Sweeps that start with the first axis give another result.
    let (first_axis_results, _, _) = run(BODY_FRAME, 0, 1);
    let differs = first_axis_results
        .iter()
        .flatten()
        .zip(found.iter().flatten())
        .any(|(a, b)| (a - b).abs() > 1e-4);
    assert!(differs);
}

/// Verifies that the axis of reflecting boundaries is swept first by default, and that runs resume from a snapshot.
#[test]
fn reflecting_boundaries_select_the_first_axis() {
    let problem = problem_in_frame(BODY_FRAME);
    assert_eq!(problem.first_axis(), 2);
    assert_eq!(self::problem_in_frame(ROTATED_FRAME).first_axis(), 1);
    let open = || [Boundary::NonReflecting, Boundary::NonReflecting];
    let mut still = problem.clone();
    still.boundaries[2] = open();
    assert_eq!(still.first_axis(), 0);
    still.boundaries[0] = open();
    still.boundaries[1] = [Boundary::new_symmetry(&still.media[0], 1), Boundary::NonReflecting];
    assert_eq!(still.first_axis(), 0);
    still.boundaries[1] = [Boundary::NonReflecting, Boundary::Fixed];
    assert_eq!(still.first_axis(), 1);
    still.scheme.splitting = Splitting::TwoCyclic;
    assert_eq!(still.first_axis(), 0);
    // Rows of fewer than eight cells would leave most SIMD lanes empty, unless they are normal to a free surface.
    let first_axis = |cells: &[usize], reflecting: &[usize], is_alternating| {
        choose_first_axis(cells, |axis| reflecting.contains(&axis), is_alternating)
    };
    assert_eq!(first_axis(&[1, 100], &[0], true), 1);
    assert_eq!(first_axis(&[8, 100], &[], true), 0);
    assert_eq!(first_axis(&[4, 7], &[1], true), 0);
    assert_eq!(first_axis(&[60, 60, 1], &[0, 1, 2], true), 1);
    assert_eq!(first_axis(&[60, 60, 4], &[0, 1, 2], true), 2);
    assert_eq!(first_axis(&[6, 60, 60], &[0], true), 0);
    assert_eq!(first_axis(&[1, 60, 60], &[0], true), 1);
    assert_eq!(first_axis(&[2, 60, 60], &[2], false), 1);

    let start = || DecomposedDomain::<f64, 3>::with_first_axis(2, &problem, 2).expect("sound");
    let (mut whole, mut resumed) = (start(), start());
    whole.advance(7).expect("threads");
    resumed.advance(3).expect("threads");
    let snapshot = resumed.snapshot();
    let mut resumed = start();
    assert!(resumed.restore(&snapshot));
    resumed.advance(4).expect("threads");
    assert!(whole.snapshot() == resumed.snapshot());
    assert!(whole.energy().total() > 0.0);
    assert_eq!(DecomposedDomain::<f64, 3>::usable_threads(2, &problem, 16), 3);
    assert_eq!(DecomposedDomain::<f64, 3>::usable_threads(0, &problem, 16), 3);
}
