//! Domain decomposition: results must be bit-identical to those of the undecomposed domain.

use crate::support::media::{cubic_compliances, isotropic};
use crate::support::noise;
use models::solid::parameters::{Isotropic, Theory};
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::{Boundary, Load, Source};
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::ledger::Ledger;
use wellposed_dynamics::line::{HALO, Slopes};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::InstructionSet;

pub(crate) fn two_solids() -> [Isotropic; 2] {
    solids_in_theory(Theory::Cosserat)
}

pub(crate) fn solids_in_theory(theory: Theory) -> [Isotropic; 2] {
    [1.0, 2.3].map(|factor| isotropic(theory, factor))
}

fn check_decompositions<T: SolverReal, const D: usize>(
    boundaries: &[[Boundary; 2]; D],
    cells: [usize; D],
    plastic_step: PlasticStep,
) {
    let problem = random_problem_of_solids(two_solids(), boundaries, cells, plastic_step);
    compare_decompositions::<T, D>(&problem, [11, 19]);
}

/// Returns a problem whose cells are of two media at random.
pub(crate) fn random_problem_of_solids<const D: usize>(
    [soft, stiff]: [Isotropic; 2],
    boundaries: &[[Boundary; 2]; D],
    cells: [usize; D],
    plastic_step: PlasticStep,
) -> Problem<D> {
    // Only the first medium yields.
    let set = Mises { antisymmetric_weight: 0.5, ..Mises::new_drucker_prager(0.3, 0.2, 0.2) };
    let media = [Medium::new(soft, D).with_yield_set(YieldSet::from(set)), Medium::new(stiff, D)];
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let count: usize = cells.iter().product();
    let cell_media: Vec<u16> = (0..count).map(|i| u16::from(noise(i as u64) > 0.2)).collect();
    let grid = Grid { cells, spacing: [0.1; D] };
    let step = 1.9 * 0.1 / speed;
    let scheme = Scheme::new(Slopes::Limited, plastic_step);
    Problem::new(grid, media.to_vec(), cell_media, boundaries.clone(), step, scheme)
}

/// Compares decompositions, instruction sets and the reference solver with the undecomposed domain, from noise, after
/// `steps` in two calls: halos of the first must not affect the second.
fn compare_decompositions<T: SolverReal, const D: usize>(problem: &Problem<D>, steps: [usize; 2]) {
    let (cells, count) = (problem.grid.cells, problem.grid.count());
    let step_count = steps[0] + steps[1];
    let mut whole: Domain<T, D> = Domain::new(problem).expect("sound");
    let values = |index: usize| -> Vec<T> {
        (0..count).map(|cell| T::from_f64(noise((10_000 * index + cell) as u64))).collect()
    };
    let fields = whole.fields().to_vec();
    for (index, &field) in fields.iter().enumerate() {
        whole.set_field(field, &values(index));
    }
    for _ in 0..step_count {
        whole.advance();
    }
    let mut reference: Reference<T, D> = Reference::new(problem).expect("sound");
    for (index, &field) in fields.iter().enumerate() {
        reference.set_field(field, &values(index));
    }
    reference.advance(step_count);
    for &field in &fields {
        let (found, expected) = (reference.values(field), whole.values(field));
        assert!(to_bits(found) == to_bits(expected), "reference, {field:?}");
    }
    // Sums over the cells are exact, hence independent of their order.
    assert_eq!(reference.energy(), whole.energy());
    let (found, expected) = (reference.ledger(), whole.ledger());
    assert_eq!(Ledger { numerical_dissipation: 0.0, ..found }, expected);
    assert!(found.numerical_dissipation > 0.0);

    // Decompositions along the last axis, along each other axis that is long enough, and along all of these.
    let along =
        |axis: usize, count: usize| std::array::from_fn(|own| if own == axis { count } else { 1 });
    let is_long_enough = |axis: &usize| cells[*axis] >= 2 * HALO;
    let divided_axes = std::array::from_fn(|axis| if is_long_enough(&axis) { 2 } else { 1 });
    let mut cuts: Vec<[usize; D]> = (1..=3).map(|count| along(D - 1, count)).collect();
    cuts.extend(
        (0..D - 1).filter(is_long_enough).map(|axis| along(axis, (cells[axis] / HALO).min(3))),
    );
    let with_widest_set =
        cuts.into_iter().map(|subdomain_counts| (subdomain_counts, InstructionSet::widest()));
    for (subdomain_counts, set) in
        with_widest_set.chain(InstructionSet::available_sets().map(|set| (divided_axes, set)))
    {
        let mut decomposed: DecomposedDomain<T, D> =
            DecomposedDomain::with_subdomains(0, problem, subdomain_counts).expect("sound");
        decomposed.set_instructions(set);
        for (index, &field) in fields.iter().enumerate() {
            decomposed.set_field(field, &values(index));
        }
        for own in steps {
            decomposed.advance(own).expect("threads");
        }
        for &field in &fields {
            let (found, expected) = (decomposed.values(field), whole.values(field));
            assert!(
                to_bits(found) == to_bits(expected),
                "{subdomain_counts:?} parts, {set:?}, {field:?}"
            );
        }
        assert_eq!(decomposed.energy(), whole.energy());
        assert_eq!(decomposed.ledger(), whole.ledger());
    }
}

fn to_bits<T: SolverReal>(values: Option<Vec<T>>) -> Vec<u64> {
    values.expect("a field").iter().map(|value| value.to_f64().to_bits()).collect()
}

#[test]
fn decompositions_equal_the_whole_domain() {
    let pair = |b: &Boundary| [b.clone(), b.clone()];
    for last in [Boundary::Periodic, Boundary::Fixed, Boundary::Free, Boundary::NonReflecting] {
        for plastic_step in [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection] {
            // Row lengths that end before, within and after the last two lanes of a SIMD group.
            let lengths = match plastic_step {
                PlasticStep::ReturnMapping => [9, 16],
                PlasticStep::MidpointReflection => [14, 23],
            };
            for length in lengths {
                check_decompositions::<f64, 2>(
                    &[pair(&Boundary::Free), pair(&last)],
                    [length, 13],
                    plastic_step,
                );
            }
            let boundaries = [pair(&Boundary::Periodic), pair(&Boundary::Fixed), pair(&last)];
            check_decompositions::<f64, 3>(&boundaries, [5, 4, 12], plastic_step);
        }
    }
}

/// Verifies decomposition of grids whose halos are sent in several messages.
#[test]
fn decompositions_with_long_halos_equal_the_whole_domain() {
    let free = || [Boundary::Free, Boundary::Free];
    let periodic = || [Boundary::Periodic, Boundary::Periodic];
    let step = PlasticStep::default();
    let plane = random_problem_of_solids(two_solids(), &[periodic(), free()], [17, 4100], step);
    compare_decompositions::<f64, 2>(&plane, [1, 2]);
    let space =
        random_problem_of_solids(two_solids(), &[free(), periodic(), free()], [9, 50, 110], step);
    compare_decompositions::<f64, 3>(&space, [1, 1]);
}

/// Verifies decomposition in each theory: halos must contain the fields that are changed by sweeps along the last axis
/// and by the spin–stress rotation.
#[test]
fn decompositions_equal_the_whole_domain_in_every_theory() {
    let pair = |b: &Boundary| [b.clone(), b.clone()];
    let boundaries = [pair(&Boundary::Free), pair(&Boundary::Fixed), pair(&Boundary::Periodic)];
    for theory in [Theory::Classical, Theory::Reduced, Theory::Cosserat] {
        for plastic_step in [PlasticStep::ReturnMapping, PlasticStep::MidpointReflection] {
            let solids = solids_in_theory(theory);
            let problem = random_problem_of_solids(solids, &boundaries, [9, 5, 12], plastic_step);
            compare_decompositions::<f64, 3>(&problem, [11, 19]);
        }
    }
}

/// Verifies decomposition with layers wider than a tile, and with more layers than are processed at once in a
/// subdomain, over five steps.
#[test]
fn decompositions_equal_the_whole_domain_in_wide_layers() {
    check_wide_layers([2, 3], &[Boundary::Periodic]);
}

#[test]
#[ignore = "takes a minute"]
fn decompositions_equal_the_whole_domain_in_wide_layers_over_many_steps() {
    check_wide_layers([11, 19], &[Boundary::Periodic, Boundary::NonReflecting]);
}

/// Compares decompositions after `steps`, in two calls; the largest grid with each of `boundaries_of_last_axis` at both
/// ends of the last axis.
fn check_wide_layers(steps: [usize; 2], boundaries_of_last_axis: &[Boundary]) {
    fn compare<const D: usize>(
        boundaries: &[[Boundary; 2]; D],
        cells: [usize; D],
        plastic_step: PlasticStep,
        steps: [usize; 2],
    ) {
        let problem = random_problem_of_solids(two_solids(), boundaries, cells, plastic_step);
        compare_decompositions::<f64, D>(&problem, steps);
    }
    let pair = |b: &Boundary| [b.clone(), b.clone()];
    let boundaries = [pair(&Boundary::Free), pair(&Boundary::Periodic)];
    compare(&boundaries, [300, 27], PlasticStep::ReturnMapping, steps);
    for middle in [Boundary::Periodic, Boundary::NonReflecting] {
        let boundaries = [pair(&Boundary::Free), pair(&middle), pair(&Boundary::Fixed)];
        compare(&boundaries, [9, 19, 20], PlasticStep::ReturnMapping, steps);
    }
    // Boundary work at the ends of rows and layers that are processed in tiles.
    let open = pair(&Boundary::NonReflecting);
    compare(
        &[open.clone(), open.clone(), open.clone()],
        [9, 25, 13],
        PlasticStep::ReturnMapping,
        steps,
    );
    // All layers are processed in tiles of rows; the last tile has fewer rows than the distance by which a sweep trails
    // the previous one.
    for last in boundaries_of_last_axis {
        let boundaries = [open.clone(), pair(&Boundary::Free), pair(last)];
        compare(&boundaries, [66, 41, 12], PlasticStep::MidpointReflection, steps);
    }
}

/// Verifies a single cell of another medium at positions around the largest run length of groups of equal media.
#[test]
fn fused_solver_equals_the_reference_around_a_single_cell() {
    fn check_single_cell<const D: usize>(cells: [usize; D], odd: usize) {
        let media = two_solids().map(|solid| Medium::new(solid, D));
        let count = cells.iter().product();
        let cell_media = (0..count).map(|cell| u16::from(cell == odd)).collect();
        let grid = Grid { cells, spacing: [0.1; D] };
        let step = 1.9 * 0.1 / media.each_ref().map(Medium::max_speed)[1];
        let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Fixed]);
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let problem = Problem::new(grid, media.to_vec(), cell_media, boundaries, step, scheme);
        let mut domain: Domain<f64, D> = Domain::new(&problem).expect("sound");
        let mut reference: Reference<f64, D> = Reference::new(&problem).expect("sound");
        let fields = domain.fields().to_vec();
        for (index, &field) in fields.iter().enumerate() {
            let value = |cell| noise((10_000 * index + cell) as u64);
            let values: Vec<f64> = (0..count).map(value).collect();
            domain.set_field(field, &values);
            reference.set_field(field, &values);
        }
        domain.advance();
        reference.advance(1);
        for field in fields {
            let (found, expected) = (domain.values(field), reference.values(field));
            assert!(to_bits(found) == to_bits(expected), "{cells:?}, {odd}, {field:?}");
        }
    }
    for place in [0, 1, 253, 254, 255, 256, 257, 258, 509, 510, 511, 512, 513] {
        // A row of 4200 cells has 526 SIMD groups, and each lane holds a contiguous segment of the row: the cell is in
        // the first lane, then in the fourth.
        check_single_cell([4200, 2], place);
        check_single_cell([4200, 2], 3 * 526 + place);
        check_single_cell([2, 600], 2 * place);
        check_single_cell([2, 600, 2], 2 * place);
        check_single_cell([2, 2, 600], 4 * place);
    }
}

/// Verifies single precision, in which groups have twice as many lanes.
#[test]
fn decompositions_equal_the_whole_domain_in_single_precision() {
    let pair = |b: &Boundary| [b.clone(), b.clone()];
    let boundaries = [pair(&Boundary::Fixed), pair(&Boundary::NonReflecting)];
    for length in [9, 31, 32] {
        // Small subdomains, and subdomains that make several steps per pass.
        check_decompositions::<f32, 2>(&boundaries, [length, 13], PlasticStep::MidpointReflection);
        check_decompositions::<f32, 2>(&boundaries, [length, 26], PlasticStep::MidpointReflection);
    }
}

/// Verifies that runs resumed from a snapshot in another decomposition have the bits of uninterrupted runs.
#[test]
fn runs_resume_from_snapshots() {
    let media = [Medium::new(two_solids()[0], 2)];
    let set = YieldSet::from(Mises::new_drucker_prager(0.3, 0.2, 0.2));
    let media = media.map(|medium| medium.with_yield_set(set.clone()));
    let grid = Grid { cells: [14, 33], spacing: [0.1, 0.1] };
    let boundaries = std::array::from_fn(|_| [Boundary::Fixed, Boundary::NonReflecting]);
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
    let step = 1.9 * 0.1 / media[0].max_speed();
    let problem = Problem::new(grid, media.to_vec(), vec![0; 462], boundaries, step, scheme);
    let start = || {
        let mut decomposed: DecomposedDomain<f64, 2> =
            DecomposedDomain::new(&problem, 2).expect("sound");
        let values: Vec<f64> = (0..462).map(noise).collect();
        decomposed.set_field(SolidField::Velocity(0), &values);
        decomposed
    };
    let (mut whole, mut first) = (start(), start());
    whole.advance(40).expect("threads");
    first.advance(17).expect("threads");
    let mut second: DecomposedDomain<f64, 2> = DecomposedDomain::new(&problem, 3).expect("sound");
    assert!(second.restore(&first.snapshot()));
    second.advance(23).expect("threads");
    assert_eq!(second.snapshot(), whole.snapshot());
    assert_eq!((second.ledger(), second.time()), (whole.ledger(), whole.time()));
    let mut other = first.snapshot();
    other.fields.pop();
    assert!(!second.restore(&other));

    // The reference solver resumes from its own snapshots, but not from one with a missing field.
    let start = || Reference::<f64, 2>::new(&problem).expect("sound");
    let (mut whole, mut first) = (start(), start());
    for solver in [&mut whole, &mut first] {
        solver.set_field(SolidField::Velocity(0), &(0..462).map(noise).collect::<Vec<_>>());
    }
    whole.advance(40);
    first.advance(17);
    let mut second = start();
    assert!(second.restore(&first.snapshot()));
    second.advance(23);
    assert_eq!(second.snapshot(), whole.snapshot());
    assert_eq!((second.ledger(), second.time()), (whole.ledger(), whole.time()));
    assert!(!second.restore(&other));
}

/// Verifies single layers and single cells, with image ghosts (fixed and free boundaries) and periodic ghosts, against
/// the reference solver; fixed and free boundaries do no work.
#[test]
fn single_layers_equal_the_reference() {
    let medium = Medium::new(two_solids()[0], 2);
    for cells in [[6, 1], [1, 6], [1, 1], [2, 1]] {
        for ends in [
            [Boundary::Periodic, Boundary::Periodic],
            [Boundary::Fixed, Boundary::Free],
            [Boundary::Free, Boundary::Fixed],
            [Boundary::Fixed, Boundary::Fixed],
        ] {
            let boundaries = [ends.clone(), ends.clone()];
            let (grid, step) = (Grid { cells, spacing: [0.1; 2] }, 0.2 / medium.max_speed());
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
            let count = grid.count();
            let problem =
                Problem::new(grid, vec![medium.clone()], vec![0; count], boundaries, step, scheme);
            let (mut decomposed, mut reference) = build_both_solvers(&problem);
            let start = decomposed.energy().total();
            decomposed.advance(20).expect("threads");
            reference.advance(20);
            assert!(decomposed.energy().total() <= start * (1.0 + 1e-13), "{cells:?} {ends:?}");
            for inflow in [decomposed.ledger().boundary_work, reference.ledger().boundary_work] {
                assert!(inflow.abs() < 1e-13 * start, "{cells:?} {ends:?}");
            }
            assert_eq!(decomposed.snapshot().fields, reference.snapshot().fields);
        }
    }
}

/// Creates the fused and the reference solver with the same noise as initial values.
fn build_both_solvers(problem: &Problem<2>) -> (DecomposedDomain<f64, 2>, Reference<f64, 2>) {
    let mut decomposed = DecomposedDomain::new(problem, 1).expect("sound");
    let mut reference = Reference::new(problem).expect("sound");
    for (index, field) in decomposed.fields().to_vec().into_iter().enumerate() {
        let value = |cell: usize| noise((100 * index + cell) as u64);
        let values: Vec<f64> = (0..problem.grid.count()).map(value).collect();
        decomposed.set_field(field, &values);
        reference.set_field(field, &values);
    }
    (decomposed, reference)
}

/// Verifies the boundary work in the ledger against the reference solver, for single rows between loaded boundaries.
#[test]
fn boundary_work_on_single_layers_equals_the_reference() {
    let medium = Medium::new(two_solids()[0], 2);
    for cells in [[6, 1], [1, 6], [1, 1], [9, 2]] {
        let grid = Grid { cells, spacing: [0.1; 2] };
        let (count, step) = (grid.count(), 0.2 / medium.max_speed());
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let boundaries = std::array::from_fn(|_| [Boundary::NonReflecting, Boundary::Free]);
        let media = vec![medium.clone()];
        let mut problem = Problem::new(grid, media, vec![0; count], boundaries, step, scheme);
        for axis in 0..2 {
            let faces = (0..grid.faces(axis)).map(|face| (face, 0.7)).collect();
            let signal = Arc::new(|time: f64| 1.0 + time);
            problem.loads.push(Load { axis, end: 1, pair: 0, faces, signal });
        }
        let (mut decomposed, mut reference) = build_both_solvers(&problem);
        decomposed.advance(20).expect("threads");
        reference.advance(20);
        let inflows = [decomposed.ledger().boundary_work, reference.ledger().boundary_work];
        assert!(
            (inflows[0] - inflows[1]).abs() < 1e-13 * inflows[1].abs(),
            "{cells:?} {inflows:?}"
        );
    }
}

/// Verifies that small values in the tails of waves are flushed to zero before they become subnormal, at the same step
/// in all decompositions, instruction sets and solvers. The other values are compared with a run in double precision,
/// in which nothing of this magnitude is flushed.
#[test]
fn small_values_are_flushed_in_all_subdomains() {
    // Thirteen subdomains of 121 layers have nine or ten layers each: for every `flat` some of the small values are in
    // a halo.
    (0..9).step_by(4).for_each(|flat| check_flush([20, 121], 0, flat, Boundary::Free));
    check_flush([9, 3, 121], 0, 0, Boundary::Free);
    // Periodic: small values wrap around where a subdomain is its own neighbour.
    check_flush([20, 146], 73, 0, Boundary::Periodic);
}

/// Verifies flushing with initial values of order one up to `flat` layers from the layer `from`; beyond, they decay by
/// the factor exp(−3.5) per layer.
fn check_flush<const D: usize>(cells: [usize; D], from: usize, flat: usize, last: Boundary) {
    const FLUSH_LIMIT: f64 = 1.29e-26;
    let [soft, stiff] = two_solids().map(|solid| Medium::new(solid, D));
    let step = 1.9 * 0.1 / stiff.max_speed();
    let media = vec![soft.with_yield_set(YieldSet::from(Mises::new_von_mises(0.2))), stiff];
    let grid = Grid { cells, spacing: [0.1; D] };
    let cell_media = (0..grid.count()).map(|i| u16::from(noise(i as u64) > 0.2)).collect();
    let mut boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    boundaries[D - 1] = [last.clone(), last];
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
    let problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
    let layer = grid.count() / cells[D - 1];
    // In single precision the values underflow within half of the layers.
    let decay = |i: usize| (-3.5 * (i / layer).abs_diff(from).saturating_sub(flat) as f64).exp();
    let value = |index: usize, i: usize| noise((31 * index + i) as u64) * decay(i);

    let mut double_precision: DecomposedDomain<f64, D> =
        DecomposedDomain::new(&problem, 1).expect("sound");
    let fields = double_precision.fields().to_vec();
    for (index, &field) in fields.iter().enumerate() {
        double_precision
            .set_field(field, &(0..grid.count()).map(|i| value(index, i)).collect::<Vec<_>>());
    }
    double_precision.advance(33).expect("threads");

    let mut reference: Reference<f32, D> = Reference::new(&problem).expect("sound");
    for (index, &field) in fields.iter().enumerate() {
        let values = (0..grid.count()).map(|i| value(index, i) as f32);
        reference.set_field(field, &values.collect::<Vec<_>>());
    }
    reference.advance(33);
    let expected: Vec<u64> =
        fields.iter().flat_map(|field| to_bits(reference.values(*field))).collect();
    for subdomain_counts in [1, 2, 13] {
        // Every instruction set in one subdomain, the widest in several.
        let sets = InstructionSet::available_sets();
        for instructions in
            sets.filter(|own| subdomain_counts == 1 || *own == InstructionSet::widest())
        {
            let mut decomposed: DecomposedDomain<f32, D> =
                DecomposedDomain::new(&problem, subdomain_counts).expect("sound");
            decomposed.set_instructions(instructions);
            for (index, &field) in fields.iter().enumerate() {
                let values = (0..grid.count()).map(|i| value(index, i) as f32);
                decomposed.set_field(field, &values.collect::<Vec<_>>());
            }
            let small_values = |decomposed: &DecomposedDomain<f32, D>| {
                let values = fields.iter().filter_map(|field| decomposed.values(*field)).flatten();
                values.filter(|value| *value != 0.0 && f64::from(value.abs()) < FLUSH_LIMIT).count()
            };
            decomposed.advance(15).expect("threads");
            assert!(small_values(&decomposed) > 0);
            decomposed.advance(1).expect("threads");
            assert_eq!(small_values(&decomposed), 0, "{subdomain_counts} {instructions:?}");
            // The next flush comes after the first step of a two-step pass, in a restored solver.
            decomposed.advance(1).expect("threads");
            let mut other: DecomposedDomain<f32, D> =
                DecomposedDomain::new(&problem, subdomain_counts).expect("sound");
            other.set_instructions(instructions);
            assert!(other.restore(&decomposed.snapshot()));
            let mut decomposed = other;
            decomposed.advance(14).expect("threads");
            assert!(small_values(&decomposed) > 0);
            decomposed.advance(2).expect("threads");
            assert!(decomposed.ledger().plastic_dissipation > 0.0);
            let mut found = Vec::new();
            for &field in &fields {
                let values = decomposed.values(field).expect("one");
                for (found, exact) in
                    values.iter().zip(double_precision.values(field).expect("one"))
                {
                    assert!((f64::from(*found) - exact).abs() < 3e-6, "{field:?} {found} {exact}");
                }
                found.extend(to_bits(Some(values)));
            }
            assert!(expected == found, "{subdomain_counts} {instructions:?}");
        }
    }
}

/// Verifies that a panic of one thread, as a user-supplied time function may cause, does not leave the other threads
/// waiting.
#[test]
#[should_panic(expected = "a scoped thread panicked")]
fn panic_of_a_thread_does_not_block_the_others() {
    let medium = Medium::new(two_solids()[0], 2);
    let step = 1.9 * 0.1 / medium.max_speed();
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let grid = Grid { cells: [9, 24], spacing: [0.1; 2] };
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
    let mut problem = Problem::new(grid, vec![medium], vec![0; 216], boundaries, step, scheme);
    let has_panicked = AtomicBool::new(false);
    let signal = Arc::new(move |time: f64| {
        assert!(time < 5.0 * step || has_panicked.swap(true, Ordering::Relaxed), "once");
        1.0
    });
    let amplitudes = vec![(SolidField::Velocity(1), 0.1)];
    problem.sources.push(Source { cells: vec![(4, 1.0)], amplitudes, signal });
    let mut decomposed: DecomposedDomain<f64, 2> =
        DecomposedDomain::new(&problem, 2).expect("sound");
    decomposed.advance(40).expect("threads");
}

/// Verifies that media given by moduli and by compliances can be combined in one problem: the results do not depend on
/// their order in the list of media.
#[test]
fn media_by_moduli_and_by_compliances_can_be_mixed() {
    let solid = two_solids()[0];
    let media = [Medium::new(solid, 2), Medium::new(cubic_compliances(), 2)];
    let fields = [0, 1].map(|first| {
        let media = vec![media[first].clone(), media[1 - first].clone()];
        let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
        let step = 1.9 * 0.1 / speed;
        let grid = Grid { cells: [20, 9], spacing: [0.1; 2] };
        let cell_media = (0..180).map(|cell| (noise(cell) > 0.0) as u16 ^ first as u16).collect();
        let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Fixed]);
        let scheme = Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping);
        let problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
        let mut decomposed: DecomposedDomain<f64, 2> =
            DecomposedDomain::new(&problem, 1).expect("sound");
        decomposed.set_field(SolidField::Velocity(0), &(0..180).map(noise).collect::<Vec<_>>());
        let start = decomposed.energy().total();
        decomposed.advance(20).expect("threads");
        assert!(decomposed.energy().total() < start);
        decomposed.snapshot().fields
    });
    assert_eq!(fields[0], fields[1]);
}

#[test]
fn invalid_decompositions_are_refused() {
    let media = [Medium::new(two_solids()[0], 2)];
    let grid = Grid { cells: [4, 11], spacing: [0.1, 0.1] };
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
    let problem = Problem::new(grid, media.to_vec(), vec![0; 44], boundaries, 1e-3, scheme);
    for (subdomain_count, expected) in [(0, true), (3, true), (2, false)] {
        let result = DecomposedDomain::<f64, 2>::new(&problem, subdomain_count);
        let is_refused = matches!(
            result,
            Err(DomainError::SubdomainCount { axis: 1, actual, cells: 11, .. })
                if actual == subdomain_count
        );
        assert_eq!(is_refused, expected, "{subdomain_count}");
    }
}
