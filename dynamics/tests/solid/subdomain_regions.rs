//! Subdomains without access to the whole problem: each is created from the problem of its own region, and halos are
//! exchanged by the caller.

use crate::support::media::isotropic;
use crate::support::noise;
use models::solid::parameters::Theory;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use wellposed_dynamics::boundary::{Boundary, Condition, Load, Signal, Source};
use wellposed_dynamics::decomposition::Decomposition;
use wellposed_dynamics::domain::{Domain, HaloExchange};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::simd::Real;
use wellposed_dynamics::solid::region::Region;

type Lanes = <f64 as Real>::Lanes;

/// Error of an exchange with a lost neighbour.
#[derive(Clone, Debug, PartialEq)]
struct LostNeighbour;

/// Sender to and receiver from a neighbouring subdomain.
type ChannelPair = (Sender<Vec<Lanes>>, Receiver<Vec<Lanes>>);

/// Channels to neighbours by axis and end; sending fails after `remaining_messages` messages.
struct ChannelExchange {
    channels: HashMap<(usize, usize), ChannelPair>,
    remaining_messages: usize,
}

impl HaloExchange<Lanes> for ChannelExchange {
    type Error = LostNeighbour;

    fn send(
        &mut self,
        axis: usize,
        end: usize,
        values: &[Lanes],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), LostNeighbour> {
        let Some((to, _)) = self.channels.get(&(axis, end)) else { return Ok(()) };
        self.remaining_messages = self.remaining_messages.checked_sub(1).ok_or(LostNeighbour)?;
        to.send(ranges.flat_map(|range| values[range].to_vec()).collect())
            .map_err(|_| LostNeighbour)
    }

    fn receive(
        &mut self,
        axis: usize,
        end: usize,
        values: &mut [Lanes],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), LostNeighbour> {
        let Some((_, from)) = self.channels.get(&(axis, end)) else { return Ok(()) };
        let mut received = from.recv().map_err(|_| LostNeighbour)?.into_iter();
        for range in ranges {
            values[range].iter_mut().zip(&mut received).for_each(|(own, new)| *own = new);
        }
        assert!(received.next().is_none(), "neighbours agree on the length of messages");
        Ok(())
    }
}

fn connect_subdomains<const D: usize>(
    plan: &Decomposition<D>,
    remaining_messages: usize,
) -> Vec<ChannelExchange> {
    let subdomain_count = plan.regions().len();
    let mut exchanges: Vec<_> = (0..subdomain_count)
        .map(|_| ChannelExchange { channels: HashMap::new(), remaining_messages })
        .collect();
    for part in 0..subdomain_count {
        for axis in 0..D {
            let Some(next) = plan.neighbour(part, axis, 1) else { continue };
            let ((to, from_part), (back, from_next)) = (channel(), channel());
            exchanges[part].channels.insert((axis, 1), (to, from_next));
            exchanges[next].channels.insert((axis, 0), (back, from_part));
        }
    }
    exchanges
}

fn two_media<const D: usize>() -> Vec<Medium> {
    let solid = |factor: f64| isotropic(Theory::Cosserat, factor);
    let set = Mises { antisymmetric_weight: 0.5, ..Mises::new_drucker_prager(0.3, 0.2, 0.2) };
    vec![Medium::new(solid(1.0), D).with_yield_set(YieldSet::from(set)), Medium::new(solid(2.3), D)]
}

/// Builds the problem of a region from functions of the coordinates: no list is longer than the region.
fn region_problem<const D: usize>(
    grid: Grid<D>,
    region: &Region<D>,
    splitting: Splitting,
) -> Problem<D> {
    let media = two_media::<D>();
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let step = 1.9 * 0.1 / speed;
    let cells = region.global_cells();
    let cell_media = cells.iter().map(|&cell| u16::from(noise(cell as u64) > 0.2)).collect();
    let mut boundaries: [[Boundary; 2]; D] =
        std::array::from_fn(|_| [Boundary::Free, Boundary::NonReflecting]);
    boundaries[1] = [Boundary::Periodic, Boundary::Periodic];
    // Three kinds of conditions alternate from face to face and from pair to pair.
    let condition = |pair: usize, face: usize| match (pair + face) % 3 {
        0 => Condition::Velocity(0.1),
        1 => Condition::NonReflecting,
        _ => Condition::Traction(0.0),
    };
    let pairs = media[0].pairs[0].len();
    let faces = region.global_faces(0);
    let by_face = |pair: usize| faces.iter().map(|&face| condition(pair, face)).collect::<Vec<_>>();
    boundaries[0][1] = Boundary::ByFace((0..pairs).map(by_face).collect());
    let scheme = Scheme { splitting, ..Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping) };
    let mut problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
    let signal: Signal = Arc::new(move |time: f64| 0.3 * (0.7 * time / step).sin());
    let loaded = faces.iter().enumerate().filter(|(_, face)| **face % 2 == 0);
    problem.loads.push(Load {
        axis: 0,
        end: 0,
        pair: 0,
        faces: loaded.map(|(own, _)| (own, 0.4)).collect(),
        signal: signal.clone(),
    });
    let acts = cells.iter().enumerate().filter(|(_, cell)| **cell % 17 == 3);
    problem.sources.push(Source {
        cells: acts.map(|(own, _)| (own, 0.5)).collect(),
        amplitudes: vec![(SolidField::Velocity(1), 1e-3), (SolidField::Stress(0, 0), 2e-3)],
        signal,
    });
    problem.acceleration[1] = 0.2;
    let stress = |layer: usize| {
        let force = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { -0.05 * layer as f64 } else { 0.0 })
        });
        Stress { force, ..Stress::default() }
    };
    problem.initial_stress = Some((0, (0..grid.cells[0]).map(stress).collect()));
    problem
}

/// Returns the initial value of a field in a cell of the whole grid.
fn initial_value(field: usize, cell: usize) -> f64 {
    noise((field * 100_003 + cell) as u64)
}

/// Fills a domain, advances it by `passes` passes, and returns its fields by owned cell.
fn run_passes<const D: usize>(
    domain: &mut Domain<f64, D>,
    region: &Region<D>,
    channels: &mut ChannelExchange,
    passes: usize,
) -> Result<Vec<Vec<f64>>, LostNeighbour> {
    let fields = domain.fields().to_vec();
    let cells = region.owned_global_cells();
    for (index, field) in fields.iter().enumerate() {
        let values: Vec<f64> = cells.iter().map(|&cell| initial_value(index, cell)).collect();
        domain.set_field(*field, &values);
    }
    for _ in 0..passes {
        domain.advance_pass(1, channels)?;
    }
    Ok(fields.iter().filter_map(|field| domain.values(*field)).collect())
}

/// Final fields of a subdomain, which runs in its own thread.
type SubdomainFields = Result<Vec<Vec<f64>>, LostNeighbour>;

fn run_subdomains<const D: usize>(
    grid: Grid<D>,
    plan: &Decomposition<D>,
    splitting: Splitting,
    messages: usize,
) -> Vec<SubdomainFields> {
    let outcomes = Mutex::new(vec![Ok(Vec::new()); plan.regions().len()]);
    std::thread::scope(|scope| {
        for (part, mut links) in connect_subdomains(plan, messages).into_iter().enumerate() {
            let (region, outcomes) = (&plan.regions()[part], &outcomes);
            scope.spawn(move || {
                let problem = region_problem(grid, region, splitting);
                assert_eq!(problem.cell_media.len(), region.count());
                let domain = Domain::new_subdomain(&problem, region, plan.max_pass_steps());
                let outcome = run_passes(&mut domain.expect("sound"), region, &mut links, 12);
                outcomes.lock().expect("no thread panics")[part] = outcome;
            });
        }
    });
    outcomes.into_inner().expect("no thread panics")
}

fn compare_decompositions<const D: usize>(
    cells: [usize; D],
    cuts: &[[usize; D]],
    splitting: Splitting,
) {
    let grid = Grid { cells, spacing: [0.1; D] };
    let whole = Region::from_grid(cells);
    let problem = region_problem(grid, &whole, splitting);
    let mut domain: Domain<f64, D> = Domain::new(&problem).expect("sound");
    let mut no_exchange = ChannelExchange { channels: HashMap::new(), remaining_messages: 0 };
    let expected = run_passes(&mut domain, &whole, &mut no_exchange, 12).expect("no neighbours");
    assert!(domain.ledger().plastic_dissipation > 0.0 && domain.ledger().source_work != 0.0);
    let is_periodic = problem.boundaries.each_ref().map(|own| own[0] == Boundary::Periodic);
    for &parts in cuts {
        let plan =
            Decomposition::new(&grid, is_periodic, problem.pass_limits(), parts).expect("room");
        let outcomes = run_subdomains(grid, &plan, splitting, usize::MAX);
        for (region, outcome) in plan.regions().iter().zip(outcomes) {
            let found = outcome.expect("no line is cut");
            for (field, values) in found.iter().enumerate() {
                for (&cell, value) in region.owned_global_cells().iter().zip(values) {
                    let expected = expected[field][cell];
                    assert!(value.to_bits() == expected.to_bits(), "{parts:?} {field} {cell}");
                }
            }
        }
    }
}

#[test]
fn subdomains_built_from_their_regions_equal_the_whole_domain() {
    for splitting in [Splitting::TwoCyclic, Splitting::Alternating] {
        compare_decompositions([21, 17], &[[2, 2], [3, 2], [1, 4], [3, 1]], splitting);
        compare_decompositions([13, 9, 11], &[[2, 2, 2], [2, 1, 1], [1, 2, 1]], splitting);
    }
}

/// Verifies that restricting the problem of the whole grid gives the problem built from the coordinates.
#[test]
fn restricted_problem_equals_the_problem_built_from_coordinates() {
    let grid = Grid { cells: [13, 9, 11], spacing: [0.1; 3] };
    let whole = region_problem(grid, &Region::from_grid(grid.cells), Splitting::TwoCyclic);
    let plan = Decomposition::new(&grid, [false, true, false], whole.pass_limits(), [2, 2, 2]);
    for region in plan.expect("room").regions() {
        let expected = region_problem(grid, region, Splitting::TwoCyclic);
        let restricted = whole.restrict_to(region);
        assert_eq!(expected.cell_media, restricted.cell_media);
        assert_eq!(expected.boundaries, restricted.boundaries);
        // The lists of the restricted problem are in the order of the whole grid, which differs from that of the region
        // where a halo wraps around: sort them by the index in the region.
        let (mut faces, mut cells) =
            (restricted.loads[0].faces.clone(), restricted.sources[0].cells.clone());
        faces.sort_by_key(|own| own.0);
        cells.sort_by_key(|own| own.0);
        assert_eq!(expected.loads[0].faces, faces);
        assert_eq!(expected.sources[0].cells, cells);
    }
}

/// Verifies that a lost link ends the adjacent subdomains, and all that wait for them, with an error, without deadlock.
#[test]
fn lost_neighbours_cause_errors() {
    let grid = Grid { cells: [21, 17], spacing: [0.1; 2] };
    let problem = region_problem(grid, &Region::from_grid(grid.cells), Splitting::TwoCyclic);
    let plan =
        Decomposition::new(&grid, [false, true], problem.pass_limits(), [2, 2]).expect("room");
    for messages in [0, 1, 7, 40] {
        let outcomes = run_subdomains(grid, &plan, Splitting::TwoCyclic, messages);
        assert!(outcomes.iter().all(|outcome| *outcome == Err(LostNeighbour)), "{messages}");
    }
}

#[test]
fn problems_of_other_regions_are_refused() {
    let grid = Grid { cells: [21, 17], spacing: [0.1; 2] };
    let whole = region_problem(grid, &Region::from_grid(grid.cells), Splitting::TwoCyclic);
    let plan = Decomposition::new(&grid, [false, true], whole.pass_limits(), [2, 2]).expect("room");
    let region = &plan.regions()[0];
    let refused = Domain::<f64, 2>::new_subdomain(&whole, region, plan.max_pass_steps());
    assert!(
        matches!(refused, Err(DomainError::CellCount { actual: 357, expected }) if expected == region.count())
    );
}
