//! Verifies that assessing a point of a map allocates no heap memory.

mod states;

use analysis::flows::{FlowWorkspace, Route};
use models::registry;
use states::{ParameterRange, create_random_numbers};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use wellposed::case::{Case, SweepParameter};

thread_local! {
    static ALLOCATION_COUNT: Cell<usize> = const { Cell::new(0) };
}

/// System allocator that counts allocations per thread.
struct CountingAllocator;

// SAFETY: every call is forwarded to the system allocator unchanged.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATION_COUNT.with(|count| count.set(count.get() + 1));
        // SAFETY: guaranteed by the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: guaranteed by the caller.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

const STATE_CASE: &str = "
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
fn closed_form_verdict_allocates_no_memory() {
    let mut case = Case::parse(STATE_CASE, "state.toml", &[]).expect("a case");
    let swept = SweepParameter::find_by_name("background.noncoaxiality_deg").expect("a parameter");
    let mut workspace = FlowWorkspace::default();
    let friction = SweepParameter::find_by_name("model.friction_angle_deg").expect("a parameter");
    let (index, friction) = friction.model_constant(case.material.kind).expect("a constant");
    let (mut model, mut constants) = (case.build_model().expect("a model"), case.model_constants());
    let before = ALLOCATION_COUNT.with(Cell::get);
    for delta in 0..45 {
        case.set_number(swept, f64::from(delta));
        constants[index] = friction.to_si(30.0 + 0.1 * f64::from(delta));
        model.set_constants(&constants).expect("in range");
        let background = model.background(&case.to_flow_state()).expect("a state");
        let flow = background.flow().expect("on yield");
        let (_, route) = workspace.decide_verdict(&model, flow).expect("a verdict");
        assert_eq!(route, Route::ClosedForm);
    }
    assert_eq!(ALLOCATION_COUNT.with(Cell::get), before);
}

/// Verifies the linearised equations of every model, with the dilatancy angle ν = 0 and ν > 0, with and without
/// gradients and accelerations: after the workspace of a thread has grown to the size of the model, assessing a state
/// allocates no memory, except for the text that explains a marginal state.
#[test]
fn assessment_of_linearised_equations_allocates_no_memory() {
    const STATE_COUNT: u64 = 1000;
    for kind in registry::STANDARD_FLOWS {
        for (is_dilatant, has_gradients) in
            [(false, false), (false, true), (true, false), (true, true)]
        {
            let mut workspace = FlowWorkspace::default();
            let mut marginal = 0;
            // All states have been assessed in the first round, so that the workspace has its final size in the second
            // one.
            for (round, seed) in
                (0..2).flat_map(|round| (0..STATE_COUNT).map(move |seed| (round, seed)))
            {
                let random = &mut create_random_numbers(seed);
                let (parameters, state) = states::generate_state(
                    random,
                    kind,
                    ParameterRange::GranularMaterials,
                    is_dilatant,
                    has_gradients,
                );
                let (model, flow) = states::build_flow(kind, &parameters, &state);
                let before = ALLOCATION_COUNT.with(Cell::get);
                let assessment = workspace.assess(&model, &flow).expect("finite");
                let allocated = ALLOCATION_COUNT.with(Cell::get) - before;
                if assessment.verdict.name() == "marginal" {
                    marginal += 1;
                } else if round > 0 {
                    assert_eq!(allocated, 0, "{kind:?}, seed {seed}: {parameters:?} {state:?}");
                }
            }
            assert!(marginal < STATE_COUNT / 100, "{marginal}");
        }
    }
}
