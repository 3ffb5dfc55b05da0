//! Thin grids: rows lie along a long axis, sweeps along idle axes, which are periodic and have one cell, are left out, and a
//! thread advances several parts of a long row. Results must be equal bit for bit to those of the reference solver, which
//! sweeps along all axes, one after the other. That thin grids do not depend on the orientation is tested in `thin_grids` of
//! the program.

use crate::configurations::{
    FLUSHED_MAGNITUDES, compare_problems, random_media, random_problem_in_grid,
};
use crate::support::noise;
use crate::support::random::NoiseSequence;
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;

/// Creates a random problem of lines, or in space also of layers, one cell thick, in most cases periodic across.
fn random_thin_problem<const D: usize>(random: &mut NoiseSequence) -> Problem<D> {
    let media = random_media::<D>(random);
    let long = random.uniform_index(D);
    let other = random.uniform_index(D);
    let cells = std::array::from_fn(|axis| match axis {
        _ if axis == long => random.choose(&[12, 13, 16, 30, 31, 62, 126, 300]),
        _ if axis == other => random.choose(&[1, 4, 9]),
        _ => 1,
    });
    let grid = Grid { cells, spacing: [0.1; D] };
    let is_periodic = cells.map(|count| count == 1 && !random.is_one_in(3));
    let mut problem = random_problem_in_grid(random, media, grid, is_periodic);
    // Faces of interlayers are not idle.
    if random.is_one_in(2) {
        problem.interlayers.clear();
    }
    problem
}

#[test]
fn thin_grids_equal_the_reference() {
    compare_problems::<f64, 2>((7_000_000, 40), FLUSHED_MAGNITUDES[0], random_thin_problem);
    compare_problems::<f64, 3>((8_000_000, 40), FLUSHED_MAGNITUDES[0], random_thin_problem);
    compare_problems::<f32, 2>((9_000_000, 15), FLUSHED_MAGNITUDES[1], random_thin_problem);
    compare_problems::<f32, 3>((9_500_000, 15), FLUSHED_MAGNITUDES[1], random_thin_problem);
}

/// Compares a long line, cut into parts of the size of a cache, with the reference solver.
fn compare_long_line<const D: usize>(
    long: usize,
    splitting: Splitting,
    random: &mut NoiseSequence,
) {
    let cells = std::array::from_fn(|axis| if axis == long { 12_001 } else { 1 });
    let grid = Grid { cells, spacing: [0.1; D] };
    let media = random_media::<D>(random);
    let mut problem = random_problem_in_grid(random, media, grid, cells.map(|count| count == 1));
    problem.interlayers.clear();
    problem.scheme =
        Scheme { splitting, ..Scheme::new(problem.scheme.slopes, PlasticStep::default()) };
    let first = problem.first_axis();
    let mut reference = Reference::<f64, D>::with_first_axis(first, &problem).expect("sound");
    let watched = [0, 5_999, 6_000, 12_000, 5_461, 12_001];
    reference.watch_cells(&watched);
    let values = |index: usize| -> Vec<f64> {
        (0..grid.count()).map(|cell| noise((cell + 20_000 * index) as u64)).collect()
    };
    let fields = reference.fields().to_vec();
    for (index, field) in fields.iter().enumerate() {
        reference.set_field(*field, &values(index));
    }
    reference.advance(3);
    let records = reference.take_records();
    for threads in [1, 2, 3] {
        let mut line =
            DecomposedDomain::<f64, D>::with_first_axis(first, &problem, threads).expect("sound");
        line.watch_cells(&watched);
        for (index, field) in fields.iter().enumerate() {
            line.set_field(*field, &values(index));
        }
        line.advance(2).expect("threads");
        let snapshot = line.snapshot();
        let mut line = DecomposedDomain::<f64, D>::with_first_axis(first, &problem, 4 - threads)
            .expect("sound");
        line.watch_cells(&watched);
        assert!(line.restore(&snapshot));
        line.advance(1).expect("threads");
        let label = format!("{cells:?}, {splitting:?}, {threads} threads");
        assert!(line.snapshot().fields == reference.snapshot().fields, "{label}");
        assert!(line.snapshot().cell_sums == reference.snapshot().cell_sums, "{label}");
        assert!(line.output_values() == reference.output_values(), "{label}");
        assert!(line.energy() == reference.energy(), "{label}");
        let found = line.take_records();
        assert!(!found.is_empty() && records.ends_with(&found), "{label}");
    }
}

#[test]
fn parts_of_long_lines_equal_the_reference() {
    let mut random = NoiseSequence::new(77);
    for splitting in [Splitting::TwoCyclic, Splitting::Alternating] {
        (0..2).for_each(|axis| compare_long_line::<2>(axis, splitting, &mut random));
        (0..3).for_each(|axis| compare_long_line::<3>(axis, splitting, &mut random));
    }
}
