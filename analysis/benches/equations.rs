//! Measures verdicts per second of the built-in flow models and of the same models given as equations, and the time of a
//! verdict in space.
//!
//! `cargo bench -p wellposed-analysis --bench equations`. Both start from a checked state: linearise, expand the dispersion
//! polynomial, assess all directions; the model given as equations also checks that the background satisfies them.

#[path = "../tests/support/mod.rs"]
mod support;

use models::equations::{TextModel, TextState};
use models::registry;
use std::hint::black_box;
use std::time::Instant;
use support::states::{DilatancyKind, FlowSample, sample_order_one, seeded_generator};
use support::typed_flows::type_in;
use wellposed_analysis::equations::EquationsWorkspace;
use wellposed_analysis::flows::FlowWorkspace;

/// Number of rounds; the median is reported.
const ROUND_COUNT: usize = 7;
/// Number of random states per model.
const STATE_COUNT: u64 = 200;

fn read_case(name: &str) -> cases::Case {
    let path = format!("cases/equations/{name}.toml");
    let (_, text) = cases::CASES.iter().find(|(own, _)| *own == path).expect("a bundled case");
    cases::Case::parse(text, &path, &[]).expect("a case")
}

/// Median time of a call, s.
fn measure(mut call: impl FnMut()) -> f64 {
    let mut seconds: Vec<f64> = (0..ROUND_COUNT)
        .map(|_| {
            let start = Instant::now();
            call();
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[ROUND_COUNT / 2]
}

fn main() {
    println!("| model | built-in, 1/s | as equations, 1/s | ratio | operations |");
    println!("|---|---|---|---|---|");
    for (name, kind) in [
        ("harris-grekova", registry::HARRIS_GREKOVA),
        ("double-shearing", registry::DOUBLE_SHEARING),
        ("plastic-potential", registry::PLASTIC_POTENTIAL),
        ("free-rotating", registry::FREE_ROTATING),
    ] {
        let text =
            read_case(&format!("typed-{name}")).equations.expect("equations").model.text().clone();
        let samples: Vec<(FlowSample, TextModel, TextState)> = (0..STATE_COUNT)
            .map(|seed| {
                let random = &mut seeded_generator(seed);
                let dilatancy =
                    if seed % 2 == 0 { DilatancyKind::Zero } else { DilatancyKind::Positive };
                let sample = sample_order_one(random, kind, dilatancy, seed / 2 % 2 == 0);
                let (model, state) = type_in(&sample, &text);
                (sample, model, state)
            })
            .collect();
        let mut built_in = FlowWorkspace::default();
        let own = measure(|| {
            for (sample, ..) in &samples {
                black_box(built_in.assess(&sample.model, &sample.flow).expect("finite"));
            }
        });
        let mut typed = EquationsWorkspace::default();
        let other = measure(|| {
            for (_, model, state) in &samples {
                black_box(typed.assess(model, &mut state.clone()).expect("smooth"));
            }
        });
        let rate = |seconds: f64| STATE_COUNT as f64 / seconds;
        println!(
            "| {name} | {:.3e} | {:.3e} | {:.2} | {} |",
            rate(own),
            rate(other),
            own / other,
            samples[1].1.operation_count()
        );
    }
    println!("\n| case | dimensions | unknowns | s per verdict |\n|---|---|---|---|");
    for name in
        ["mu-of-i", "corotational-maxwell", "compressible-navier-stokes", "viscoelastic-space"]
    {
        let case = read_case(name);
        let equations = case.require_equations().expect("equations");
        let mut workspace = EquationsWorkspace::default();
        let seconds = measure(|| {
            let mut state = equations.state(&case.material.numbers);
            black_box(workspace.assess(&equations.model, &mut state).expect("smooth"));
        });
        let unknowns = equations.model.unknowns().len();
        println!("| {name} | {} | {unknowns} | {seconds:.3e} |", equations.model.dimensions());
    }
}
