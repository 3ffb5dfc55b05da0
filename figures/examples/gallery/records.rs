//! Example seismograms and energy ledgers.

use crate::sampling::sample_interval;
use wellposed_figures::{LedgerFigure, LedgerTerm, SeismogramFigure, SeismogramPanel, Trace};

/// Builds pulses recorded at receivers; the last quantity is zero, and one receiver has NaN values in an interval.
pub fn build_seismogram([panels, receivers]: [usize; 2], samples: usize) -> SeismogramFigure {
    let labels = [
        "velocity v₁, m/s",
        "velocity v₂, m/s",
        "stress σ₁₁, Pa",
        "stress σ₁₂, Pa",
        "rotation rate Ω₃, 1/s",
        "couple stress μ₃₁, N/m",
    ];
    let times = sample_interval(0.0, 0.8, samples);
    let sizes = [3e-3, 1.4e-3, 2.2e4, 9e3, 4e-7, 0.0];
    let value = |panel: usize, receiver: usize, time: f64| {
        let arrival = 0.12 + 0.11 * receiver as f64;
        let beats = if samples > 100_000 { 4000.0 } else { 90.0 };
        let since = time - arrival;
        let offset = if panel == 2 { -5e4 } else { 0.0 };
        if receiver == 2 && (0.55..0.6).contains(&time) {
            f64::NAN
        } else if since < 0.0 {
            offset
        } else {
            let decay = (-9.0 * since).exp() / (1.0 + 0.5 * receiver as f64);
            offset + sizes[panel] * decay * (beats * since + panel as f64).sin()
        }
    };
    let trace = |panel: usize, receiver: usize| Trace {
        name: format!("receiver R{}", receiver + 1),
        values: times.iter().map(|time| value(panel, receiver, *time)).collect(),
    };
    let panel = |panel: usize| SeismogramPanel {
        label: labels[if panels < 6 && panel == 2 { 5 } else { panel }].to_owned(),
        traces: (0..receivers)
            .map(|receiver| trace(if panels < 6 && panel == 2 { 5 } else { panel }, receiver))
            .collect(),
    };
    SeismogramFigure {
        title: "What the receivers record".to_owned(),
        subtitle: "Cosserat solid, 400 × 300 cells".to_owned(),
        time_label: "time t, s".to_owned(),
        panels: (0..panels).map(panel).collect(),
        times,
    }
}

/// Builds the energy ledger of a shot in a yielding solid, with a residual of a few percent of the largest energy if
/// `is_coarse`, otherwise of the order of rounding.
pub fn build_ledger(is_coarse: bool) -> LedgerFigure {
    let times = sample_interval(0.0, 0.5, 2_000);
    let term = |name: &str, value: &dyn Fn(f64) -> f64| LedgerTerm {
        name: name.to_owned(),
        values: times.iter().map(|time| value(*time)).collect(),
    };
    let came = |t: f64| 3200.0 * (1.0 - (-30.0 * t).exp());
    let left = |t: f64| -900.0 * (t - 0.3).max(0.0) / 0.2;
    let lost = |t: f64| 1.0 - (-4.0 * t).exp();
    let swings = |t: f64| 0.5 + 0.5 * (60.0 * t).cos() * (-9.0 * t).exp();
    let all = |t: f64| came(t) + left(t) - 1300.0 * lost(t) - 160.0 * t;
    let balance = if is_coarse {
        term("balance, share of the largest energy", &|t| 0.03 * lost(t))
    } else {
        term("residual, share of the largest energy", &|t| {
            2e-13 * t.sqrt() * ((1e5 * t).sin() + (3e4 * t * t).sin())
        })
    };
    LedgerFigure {
        title: "Where the energy goes".to_owned(),
        subtitle: "Cosserat solid, 400 × 300 cells".to_owned(),
        time_label: "time t, s".to_owned(),
        energy_label: "energy, J/m".to_owned(),
        terms: vec![
            term("kinetic", &|t| all(t) * swings(t)),
            term("stored", &|t| all(t) * (1.0 - swings(t))),
            term("work of the boundaries", &left),
            term("work of sources and gravity", &came),
            term("work of the initial stress", &|t| 220.0 * t),
            term("plastic dissipation", &|t| 1300.0 * lost(t)),
            term("numerical dissipation", &|t| 160.0 * t),
        ],
        times: times.clone(),
        residual: balance,
    }
}
