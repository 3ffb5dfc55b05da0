//! Passes of several steps equal single steps.

use crate::decomposition::two_solids;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use std::sync::Arc;
use wellposed_dynamics::boundary::{Boundary, Load, Signal, Source};
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;

/// Verifies that passes of several steps equal single steps, with time-dependent boundaries and sources, also in the
/// records after each step.
#[test]
fn multi_step_passes_equal_single_steps() {
    check_multi_step_passes(
        [20, 33],
        [640, 3, 337, 330, 3],
        &ALL_BOUNDARIES,
        &ALL_SUBDOMAIN_COUNTS,
    );
    // In three dimensions a pass makes one step, in tiles of rows.
    let counts = [[1, 1], [1, 4], [2, 2]];
    check_multi_step_passes([66, 50, 17], WATCHED_CELLS_IN_SPACE, &[Boundary::Periodic], &counts);
}

#[test]
#[ignore = "takes half a minute"]
fn passes_equal_single_steps_at_many_boundaries_in_space() {
    let counts = &ALL_SUBDOMAIN_COUNTS;
    check_multi_step_passes([66, 50, 17], WATCHED_CELLS_IN_SPACE, &ALL_BOUNDARIES, counts);
}

const ALL_BOUNDARIES: [Boundary; 4] =
    [Boundary::Periodic, Boundary::Fixed, Boundary::Free, Boundary::NonReflecting];
/// Numbers of subdomains along the first and the last axis.
const ALL_SUBDOMAIN_COUNTS: [[usize; 2]; 6] = [[1, 1], [1, 2], [1, 3], [1, 4], [3, 1], [2, 2]];
const WATCHED_CELLS_IN_SPACE: [usize; 5] = [56_099, 3, 5_000, 2_700, 3];

/// Compares runs with each of `boundaries_of_last_axis` at both ends of the last axis, in these numbers of subdomains
/// along the first and the last axis.
fn check_multi_step_passes<const D: usize>(
    cells: [usize; D],
    watched: [usize; 5],
    boundaries_of_last_axis: &[Boundary],
    subdomain_counts: &[[usize; 2]],
) {
    let medium = Medium::new(two_solids()[0], D);
    let set = YieldSet::from(Mises::new_von_mises(0.2));
    let medium = medium.with_yield_set(set);
    let step = 1.9 * 0.1 / medium.max_speed();
    for last in boundaries_of_last_axis {
        let grid = Grid { cells, spacing: [0.1; D] };
        let mut boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
        boundaries[D - 1] = [last.clone(), last.clone()];
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let mut problem = Problem::new(
            grid,
            vec![medium.clone()],
            vec![0; grid.count()],
            boundaries,
            step,
            scheme,
        );
        let signal: Signal = Arc::new(move |time: f64| 0.3 * (2.0 * time / step).sin());
        let faces = (5..20).map(|face| (face, 0.7)).collect();
        problem.loads.push(Load { axis: 0, end: 1, pair: 0, faces, signal: signal.clone() });
        problem.sources.push(Source {
            cells: vec![(4, 0.5), (337, 0.5)],
            amplitudes: vec![(SolidField::Velocity(1), 0.1), (SolidField::Stress(0, 0), 0.2)],
            signal,
        });
        problem.integrated_fields = vec![SolidField::Velocity(0)];
        let mut whole: Domain<f64, D> = Domain::new(&problem).expect("sound");
        let mut expected = Vec::new();
        for _ in 0..21 {
            whole.advance();
            watched.iter().for_each(|&cell| whole.output_cell(cell, &mut expected));
        }
        assert!(whole.ledger().plastic_dissipation > 0.0);
        let mut reference: Reference<f64, D> = Reference::new(&problem).expect("sound");
        reference.watch_cells(&watched);
        reference.advance(21);
        assert_eq!(reference.take_records(), expected);
        let mut snapshots = None;
        let along = |first: usize, last: usize| -> [usize; D] {
            std::array::from_fn(|axis| match axis {
                0 => first,
                _ if axis + 1 == D => last,
                _ => 1,
            })
        };
        for [first, last] in subdomain_counts {
            let subdomain_counts = along(*first, *last);
            let mut decomposed: DecomposedDomain<f64, D> =
                DecomposedDomain::with_subdomains(0, &problem, subdomain_counts).expect("sound");
            decomposed.watch_cells(&watched);
            decomposed.advance(3).expect("threads");
            decomposed.advance(18).expect("threads");
            assert_eq!(decomposed.take_records(), expected, "{subdomain_counts:?}");
            let snapshot = decomposed.snapshot();
            for (&field, found) in whole.fields().iter().zip(&snapshot.fields) {
                assert_eq!(
                    *found,
                    whole.values(field).expect("one"),
                    "{subdomain_counts:?} {field:?}"
                );
            }
            assert_eq!(decomposed.ledger(), whole.ledger());
            assert_eq!(
                *snapshots.get_or_insert(snapshot.clone()),
                snapshot,
                "{subdomain_counts:?}"
            );
        }
    }
}
