//! Measures verdicts per second of both methods of assessment, on random states of every model.
//!
//! `cargo bench --bench verdicts`. Both methods are timed separately, starting from a checked state: (a) model-blind:
//! linearise, expand the dispersion polynomial, assess all directions; (b) the closed form of the model, on the states
//! for which it gives an answer. For (b) the complete evaluation of a map point is timed as well: from the numbers of
//! the case, with all checks and the background that they determine.

#[path = "../tests/states/mod.rs"]
mod states;

use analysis::flows::FlowWorkspace;
use analysis::growth::Verdict;
use models::flow::state::{DeformingFlow, MaterialState};
use models::flow::{FlowKind, Model};
use models::registry;
use rayon::prelude::*;
use states::{ParameterRange, create_random_numbers};
use std::hint::black_box;
use std::time::Instant;
use testkit::flows::FlowParameters;

/// Number of rounds; the median is reported.
const ROUND_COUNT: usize = 7;
/// Number of random states per model.
const STATE_COUNT: u64 = 2_000;

struct StateSample {
    parameters: FlowParameters,
    state: MaterialState,
    model: Model,
    flow: DeformingFlow,
}

/// Generates random states of a model: half of them with a dilatancy angle ν > 0 and, independently, half with
/// gradients and accelerations.
fn generate_samples(kind: FlowKind) -> Vec<StateSample> {
    (0..STATE_COUNT)
        .map(|seed| {
            let random = &mut create_random_numbers(seed);
            let (is_dilatant, has_gradients) = (seed % 2 == 0, seed / 2 % 2 == 0);
            let (parameters, state) = states::generate_state(
                random,
                kind,
                ParameterRange::GranularMaterials,
                is_dilatant,
                has_gradients,
            );
            let (model, flow) = states::build_flow(kind, &parameters, &state);
            StateSample { parameters, state, model, flow }
        })
        .collect()
}

/// Measures samples per second, median over the rounds; each sample is assessed `repeat_count` times per round.
fn measure_rate<W: Send>(
    pool: &rayon::ThreadPool,
    samples: &[&StateSample],
    repeat_count: usize,
    create_workspace: impl Fn() -> W + Sync,
    assess: impl Fn(&mut W, &StateSample) + Sync,
) -> f64 {
    let mut seconds: Vec<f64> = (0..ROUND_COUNT)
        .map(|_| {
            let start = Instant::now();
            pool.install(|| {
                (0..repeat_count * samples.len())
                    .into_par_iter()
                    .with_min_len(64)
                    .for_each_init(&create_workspace, |w, i| assess(w, samples[i % samples.len()]));
            });
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    (repeat_count * samples.len()) as f64 / seconds[ROUND_COUNT / 2]
}

fn main() {
    let by_model = registry::STANDARD_FLOWS.map(|kind| (kind.name(), generate_samples(kind)));
    let mut groups: Vec<(&str, Vec<&StateSample>)> =
        by_model.iter().map(|(name, samples)| (*name, samples.iter().collect())).collect();
    groups.push(("all models", by_model.iter().flat_map(|(_, samples)| samples).collect()));

    println!("verdicts per second, medians of {ROUND_COUNT} rounds");
    println!(
        "threads  model              (a) model-blind  (b) closed form  (b) with checks  answered"
    );
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads");
        for (name, samples) in &groups {
            let model_blind =
                measure_rate(&pool, samples, 1, FlowWorkspace::default, |workspace, s| {
                    black_box(workspace.assess(&s.model, &s.flow).expect("finite coefficients"));
                });
            let answered: Vec<&StateSample> = samples
                .iter()
                .copied()
                .filter(|s| s.model.closed_form_verdict(&s.flow).is_some())
                .collect();
            let repeat_count = 1_000_000 / answered.len().max(1);
            let closed_form = measure_rate(
                &pool,
                &answered,
                repeat_count,
                || (),
                |(), s| {
                    black_box(s.model.closed_form_verdict(black_box(&s.flow)).map(Verdict::from));
                },
            );
            let with_checks = measure_rate(
                &pool,
                &answered,
                repeat_count,
                || (),
                |(), s| {
                    let (model, flow) = states::build_flow(
                        s.model.kind(),
                        black_box(&s.parameters),
                        black_box(&s.state),
                    );
                    black_box(model.closed_form_verdict(&flow).map(Verdict::from));
                },
            );
            let share = 100.0 * answered.len() as f64 / samples.len() as f64;
            println!(
                "{threads:7}  {name:17}  {model_blind:15.3e}  {closed_form:15.3e}  {with_checks:15.3e}  {share:6.1} %"
            );
        }
    }
}
