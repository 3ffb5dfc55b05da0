//! Rate, verdicts per second, of both methods of assessment, on random states of every model.
//!
//! `cargo bench --bench verdicts`. Both methods are timed separately, starting from a checked state: (a) model-blind:
//! linearise, expand the dispersion polynomial, assess all directions; (b) the closed form of the model, on the states
//! for which it gives an answer. For (b) the complete evaluation of a map point is timed as well: from the numbers of
//! the case, with all checks and the background that they determine.

#[path = "../tests/states/mod.rs"]
mod states;

use analysis::flows::Workspace;
use analysis::growth::Verdict;
use models::flow::state::{Flow, State};
use models::flow::{FlowKind, Model};
use models::registry;
use rayon::prelude::*;
use states::{Range, seeded};
use std::hint::black_box;
use std::time::Instant;
use testkit::flows::Parameters;

/// Number of rounds; the median is reported.
const ROUNDS: usize = 7;
/// Number of states per model.
const STATES: u64 = 2_000;

struct Sample {
    parameters: Parameters,
    state: State,
    model: Model,
    flow: Flow,
}

/// Random states of a model: half of them with ν > 0 and, independently, half with gradients and accelerations.
fn samples(kind: FlowKind) -> Vec<Sample> {
    (0..STATES)
        .map(|seed| {
            let random = &mut seeded(seed);
            let (dilatant, gradients) = (seed % 2 == 0, seed / 2 % 2 == 0);
            let (parameters, state) =
                states::random(random, kind, Range::Materials, dilatant, gradients);
            let (model, flow) = states::flow(kind, &parameters, &state);
            Sample { parameters, state, model, flow }
        })
        .collect()
}

/// Measures samples per second, median over the rounds; each sample is assessed `repeats` times per round.
fn rate<W: Send>(
    pool: &rayon::ThreadPool,
    samples: &[&Sample],
    repeats: usize,
    workspace: impl Fn() -> W + Sync,
    judge: impl Fn(&mut W, &Sample) + Sync,
) -> f64 {
    let mut seconds: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let start = Instant::now();
            pool.install(|| {
                (0..repeats * samples.len())
                    .into_par_iter()
                    .with_min_len(64)
                    .for_each_init(&workspace, |w, i| judge(w, samples[i % samples.len()]));
            });
            start.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    (repeats * samples.len()) as f64 / seconds[ROUNDS / 2]
}

fn main() {
    let by_model = registry::STANDARD_FLOWS.map(|kind| (kind.name(), samples(kind)));
    let mut groups: Vec<(&str, Vec<&Sample>)> =
        by_model.iter().map(|(name, samples)| (*name, samples.iter().collect())).collect();
    groups.push(("all models", by_model.iter().flat_map(|(_, samples)| samples).collect()));

    println!("verdicts per second, medians of {ROUNDS} rounds");
    println!(
        "threads  model              (a) model-blind  (b) closed form  (b) with checks  answered"
    );
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.expect("threads");
        for (name, samples) in &groups {
            let model_blind = rate(&pool, samples, 1, Workspace::default, |workspace, s| {
                black_box(workspace.assess(&s.model, &s.flow).expect("finite coefficients"));
            });
            let answered: Vec<&Sample> = samples
                .iter()
                .copied()
                .filter(|s| s.model.closed_form(&s.flow).is_some())
                .collect();
            let repeats = 1_000_000 / answered.len().max(1);
            let closed_form = rate(
                &pool,
                &answered,
                repeats,
                || (),
                |(), s| {
                    black_box(s.model.closed_form(black_box(&s.flow)).map(Verdict::from));
                },
            );
            let with_checks = rate(
                &pool,
                &answered,
                repeats,
                || (),
                |(), s| {
                    let (model, flow) =
                        states::flow(s.model.kind(), black_box(&s.parameters), black_box(&s.state));
                    black_box(model.closed_form(&flow).map(Verdict::from));
                },
            );
            let share = 100.0 * answered.len() as f64 / samples.len() as f64;
            println!(
                "{threads:7}  {name:17}  {model_blind:15.3e}  {closed_form:15.3e}  {with_checks:15.3e}  {share:6.1} %"
            );
        }
    }
}
