//! Verifies that assessing a point of a map allocates no heap memory.

mod states;

use analysis::flows::{Route, Workspace};
use models::registry;
use states::{Range, seeded};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use wellposed::case::{Case, Parameter};

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// System allocator that counts allocations per thread.
struct Counting;

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: guaranteed by the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: guaranteed by the caller.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const CASE: &str = "
[model]
kind = 'harris-grekova'
friction_angle_deg = 30
moment_of_inertia = 1.25e-7
rotational_strength = 5
[background]
density = 1600
pressure = 1000
stress_angle_deg = 17
shear_rate = 2
pressure_gradient = [10, 20]
";

#[test]
fn a_formula_needs_no_memory() {
    let mut case = Case::parse(CASE, "state.toml", &[]).expect("a case");
    let swept = Parameter::find("background.noncoaxiality_deg").expect("a parameter");
    let mut workspace = Workspace::default();
    let friction = Parameter::find("model.friction_angle_deg").expect("a parameter");
    let (place, friction) = friction.constant_of(case.material.kind).expect("a constant");
    let (mut model, mut constants) = (case.flow_model().expect("a model"), case.model_constants());
    let before = ALLOCATIONS.with(Cell::get);
    for delta in 0..45 {
        case.set(swept, f64::from(delta));
        constants[place] = friction.to_si(30.0 + 0.1 * f64::from(delta));
        model.set(&constants).expect("in range");
        let background = model.background(&case.state()).expect("a state");
        let flow = background.flow().expect("on yield");
        let (_, route) = workspace.decide(&model, flow).expect("a verdict");
        assert_eq!(route, Route::ClosedForm);
    }
    assert_eq!(ALLOCATIONS.with(Cell::get), before);
}

/// Verifies the linearised equations of every model, with ν = 0 and ν > 0, with and without gradients and
/// accelerations: after the workspace of a thread has grown to the size of the model, a state allocates no memory,
/// except for the text that explains a marginal state.
#[test]
fn the_linearised_equations_need_no_memory() {
    const STATES: u64 = 1000;
    for kind in registry::STANDARD_FLOWS {
        for (dilatant, gradients) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut workspace = Workspace::default();
            let mut marginal = 0;
            // After the first round the workspace has been used with blocks of every size and layers of every kind.
            for (round, seed) in (0..2).flat_map(|round| (0..STATES).map(move |seed| (round, seed)))
            {
                let random = &mut seeded(seed);
                let (parameters, state) =
                    states::random(random, kind, Range::Materials, dilatant, gradients);
                let (model, flow) = states::flow(kind, &parameters, &state);
                let before = ALLOCATIONS.with(Cell::get);
                let assessment = workspace.assess(&model, &flow).expect("finite");
                let taken = ALLOCATIONS.with(Cell::get) - before;
                if assessment.verdict.name() == "marginal" {
                    marginal += 1;
                } else if round > 0 {
                    assert_eq!(taken, 0, "{kind:?}, seed {seed}: {parameters:?} {state:?}");
                }
            }
            assert!(marginal < STATES / 100, "{marginal}");
        }
    }
}
