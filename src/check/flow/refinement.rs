//! What finer and finer grids make of one perturbation.

use super::background::{Background, refused};
use super::waves::{LEAST, TIMES, amplitudes, times};
use super::{Fastest, Refinement};
use crate::Error;
use crate::case::Converted;
use crate::case::flow::FlowRun;
use crate::check::fit::rate;
use crate::progress::Progress;
use crate::run::{flow_problem, perturbation};
use analysis::growth::Verdict;
use analysis::newton::Order;
use dynamics::flow::spectral::Mode;
use dynamics::flow::{Closure, Flow as Solver, Problem};
use models::elementary::Elementary;
use models::granular_flow::InputError;
use num_complex::Complex64;
use rayon::prelude::*;

/// What grids make of the perturbation of a case in its model.
pub(super) fn refinement(
    converted: &Converted,
    run: &FlowRun,
    grids: &[usize],
    progress: &Progress,
) -> Result<Refinement, Error> {
    let Converted { case, lost_noncoaxiality_deg } = converted;
    let background = Background::new(case)?;
    let limit = match &background.verdict {
        Verdict::IllPosed { growth: Some(growth), .. } => Order::value(growth.order),
        _ => 0.0,
    };
    let fastest = |points: &usize| {
        let found = fastest(&background, run, [*points; 2]);
        progress.tick(1);
        found
    };
    let grids = grids.iter().map(fastest).collect::<Result<_, _>>()?;
    Ok(Refinement {
        kind: case.kind,
        limit,
        grids,
        shear_rate: background.flow.shear_rate,
        lost_noncoaxiality_deg: *lost_noncoaxiality_deg,
    })
}

/// The mode of a grid that grows fastest, predicted and measured.
fn fastest(background: &Background, run: &FlowRun, points: [usize; 2]) -> Result<Fastest, Error> {
    let case = background.case;
    // Of a whole of which one wave is a small part.
    let problem = Problem { tolerance: 3e-7, ..flow_problem(case, points, run.grid.lengths)? };
    let initial = perturbation(run, &problem)?;
    let mut solver = Solver::new(&problem).map_err(|error| refused(case, error))?;
    let [v1, v2] = &initial.0;
    solver.perturb([v1, v2], &initial.1).map_err(|error| refused(case, error))?;
    let [most, across] = solver.greatest_modes().map(|greatest| greatest as i32);
    // Those that the perturbation holds, one of each pair of opposite ones.
    let all: Vec<(Mode, f64)> = (0..=most)
        .flat_map(|first| (-across..=across).map(move |second| [first, second]))
        .filter(|mode| *mode > [0, 0])
        .map(|mode| (mode, amplitudes(&solver, mode)[0].norm()))
        .collect();
    let greatest = all.iter().map(|own| own.1).fold(0.0, f64::max);
    let is_held = |own: &&(Mode, f64)| greatest > 0.0 && own.1 > 1e-3 * greatest;
    let modes: Vec<Mode> = all.iter().filter(is_held).map(|own| own.0).collect();
    let growth = |mode: &Mode| {
        let wave = solver.wave_vector(*mode);
        let modes = background.moving(wave).map(|own| own.modes());
        let rates = modes.map(|own| own.iter().map(|own| own.0).collect::<Vec<_>>());
        rates.map(|rates| (*mode, rates))
    };
    let all: Vec<(Mode, Vec<Complex64>)> =
        modes.par_iter().map(growth).collect::<Result<_, _>>()?;
    let growth_of = |own: &(Mode, Vec<Complex64>)| own.1.first().map_or(f64::MIN, |rate| rate.re);
    let (mode, rates) =
        all.iter().max_by(|a, b| growth_of(a).total_cmp(&growth_of(b))).ok_or_else(|| {
            let found = "a perturbation that moves nothing on these grids".to_owned();
            let allowed =
                "noise of v, say, up to the greatest mode number of the finest".to_owned();
            Error::from(case.locate(InputError { key: "initial", found, allowed }))
        })?;
    let stiffest = all.iter().flat_map(|own| &own.1).map(|rate| rate.norm()).fold(0.0, f64::max);
    let shear_rate = background.flow.shear_rate;
    // Three e-folds; where nothing grows, as long as hundreds of stages reach.
    let duration = (3.0 / rates.first().map_or(0.0, |rate| rate.re).max(0.0))
        .min(0.1 / shear_rate)
        .min(2e3 / stiffest);
    let wave = solver.wave_vector(*mode);
    let mut measured = vec![amplitudes(&solver, *mode)];
    let count = if problem.closure == Closure::PlasticPotential { 2 } else { 3 };
    let (duration, predicted) = {
        let mut duration = duration;
        loop {
            let predicted = background.predicted(wave, measured[0], count, duration)?;
            // What decays is followed while it is far above rounding.
            let left = predicted.iter().map(|own| own[0].norm()).fold(f64::MAX, f64::min);
            if left > LEAST * predicted[0][0].norm() || duration < 1e-9 / shear_rate {
                break (duration, predicted);
            }
            duration *= 0.5;
        }
    };
    for time in times(duration).into_iter().skip(1) {
        while solver.time() < time {
            solver.advance(time).map_err(|error| refused(case, error))?;
        }
        measured.push(amplitudes(&solver, *mode));
    }
    // Of the last half, when what decays is gone.
    let half = TIMES / 2;
    let of_rate = |all: &[[Complex64; 2]]| {
        rate(&times(duration)[half..], &all[half..].iter().map(|own| own[0]).collect::<Vec<_>>())
            .growth
    };
    Ok(Fastest {
        points,
        mode: *mode,
        number: wave[0].root_sum_square(wave[1]),
        predicted: of_rate(&predicted),
        measured: of_rate(&measured),
    })
}
