//! Memory allocations of time steps after the first ones: none in one subdomain, in several a number that does not grow
//! with the steps.

use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{InterlayerCoupleLimits, InterlayerYieldSet, Mises};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use wellposed_dynamics::boundary::{Boundary, Load, Source};
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};

struct CountingAllocator;

/// Number of allocations by all threads.
static ALLOCATION_COUNT: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Number of allocations by this thread: threads of the test harness may allocate at any time.
    static THREAD_ALLOCATION_COUNT: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: all calls are forwarded unchanged to the system allocator.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATION_COUNT.fetch_add(1, Ordering::Relaxed);
        THREAD_ALLOCATION_COUNT.set(THREAD_ALLOCATION_COUNT.get() + 1);
        // SAFETY: the caller meets the requirements of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the pointer comes from `alloc` above, hence from the system allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

/// Counts the allocations of `steps` steps in `subdomain_count` subdomains: by this thread, and by all threads.
fn count_allocations(problem: &Problem<2>, subdomain_count: usize, steps: usize) -> [usize; 2] {
    let mut decomposed: DecomposedDomain<f64, 2> =
        DecomposedDomain::new(problem, subdomain_count).expect("sound");
    decomposed
        .set_field(SolidField::Velocity(0), &(0..405).map(|i| (i % 7) as f64).collect::<Vec<_>>());
    decomposed.advance(3).expect("threads");
    let counts = || [THREAD_ALLOCATION_COUNT.get(), ALLOCATION_COUNT.load(Ordering::Relaxed)];
    let before = counts();
    decomposed.advance(steps).expect("threads");
    let after = counts();
    [after[0] - before[0], after[1] - before[1]]
}

/// Verifies that steps of one subdomain allocate no memory, and that the number of allocations by the threads of three
/// subdomains does not increase with the number of steps.
#[test]
fn steps_allocate_nothing() {
    let couple = Some(CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 });
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let solid = Isotropic::new(1.4, 0.9, 1.2, Some(rotation)).expect("sound moduli");
    let layers = InterlayerCoupleLimits { strength: 0.16, friction: 0.3, dilatancy: 0.3 };
    let sets = [
        YieldSet::from(Mises::new_drucker_prager(0.2, 0.3, 0.3)),
        YieldSet::from(InterlayerYieldSet {
            shear_strength: 0.2,
            shear_friction: 0.5,
            shear_dilatancy: 0.5,
            couple: Some(layers),
        }),
    ];
    let schemes = [
        Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection),
        Scheme {
            splitting: Splitting::Alternating,
            ..Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping)
        },
    ];
    for (set, scheme) in
        sets.into_iter().flat_map(|set| schemes.map(move |scheme| (set.clone(), scheme)))
    {
        let medium = Medium::new(solid, 2).with_yield_set(set);
        let step = 2.0 * 0.1 / medium.max_speed();
        let signal: wellposed_dynamics::boundary::Signal = Arc::new(f64::sin);
        let faces = vec![(2, 1.0)];
        let load = Load { axis: 0, end: 1, pair: 0, faces, signal: signal.clone() };
        let amplitudes = vec![(SolidField::Spin(2), 1.0), (SolidField::Stress(0, 0), 1.0)];
        let source = Source { cells: vec![(40, 1.0)], amplitudes, signal };
        let grid = Grid { cells: [15, 27], spacing: [0.1, 0.1] };
        let boundaries =
            [[Boundary::Fixed, Boundary::Free], [Boundary::Periodic, Boundary::Periodic]];
        let problem = Problem {
            loads: vec![load],
            sources: vec![source],
            ..Problem::new(grid, vec![medium], vec![0; 405], boundaries, step, scheme)
        };
        assert_eq!(count_allocations(&problem, 1, 200)[0], 0);
        // Threads allocate when they start, when they wait for the first time, and for the messages in flight (up to 16
        // in each direction between neighbours), at unpredictable times; the number must not scale with the steps.
        let [_, short_run_count] = count_allocations(&problem, 3, 10);
        let [_, long_run_count] = count_allocations(&problem, 3, 1000);
        assert!(long_run_count < short_run_count + 300, "{short_run_count} {long_run_count}");
    }
}
