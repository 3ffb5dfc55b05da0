//! A Runge–Kutta–Chebyshev step of second order (Sommeijer, Shampine & Verwer 1998): s stages bear decay
//! rates up to about ⅔s²/h, each at the price of one evaluation.

/// Damping of the stability polynomial between its ends.
const DAMPING: f64 = 2.0 / 13.0;

/// Greatest product of decay rate and step of so many stages.
pub(super) fn reach(stages: usize) -> f64 {
    let squared = (stages * stages) as f64;
    2.0 / 3.0 * (squared - 1.0) * (1.0 - 2.0 * DAMPING / 15.0)
}

/// Least number of stages for a product of decay rate and step.
pub(super) fn stages(product: f64) -> usize {
    let estimate = (1.0 + 1.5 * product / (1.0 - 2.0 * DAMPING / 15.0)).sqrt();
    (estimate.ceil() as usize).max(2)
}

/// What makes a stage of those before:
/// Yⱼ = (1 − μ − ν) Y₀ + μ Yⱼ₋₁ + ν Yⱼ₋₂ + h (rate F(Yⱼ₋₁) + first F(Y₀)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stage {
    pub(super) mu: f64,
    pub(super) nu: f64,
    pub(super) rate: f64,
    pub(super) first: f64,
    /// Time of Yⱼ in steps.
    pub(super) time: f64,
}

/// All stages but Y₀.
pub(super) fn scheme(stages: usize) -> Vec<Stage> {
    let s = stages as f64;
    let w0 = 1.0 + DAMPING / (s * s);
    // T, T′ and T″ at w₀.
    let mut chebyshev = vec![[1.0, 0.0, 0.0], [w0, 1.0, 0.0]];
    for j in 2..=stages {
        let ([a, da, dda], [b, db, ddb]) = (chebyshev[j - 1], chebyshev[j - 2]);
        chebyshev.push([
            2.0 * w0 * a - b,
            2.0 * a + 2.0 * w0 * da - db,
            4.0 * da + 2.0 * w0 * dda - ddb,
        ]);
    }
    let [_, slope, curvature] = chebyshev[stages];
    let w1 = slope / curvature;
    let b = |j: usize| {
        let [_, slope, curvature] = chebyshev[j.max(2)];
        curvature / (slope * slope)
    };
    let time = |j: usize| match j {
        1 => w1 * chebyshev[2][2] / chebyshev[2][1] / chebyshev[2][1],
        _ => w1 * chebyshev[j][2] / chebyshev[j][1],
    };
    let first = Stage { mu: 1.0, nu: 0.0, rate: b(1) * w1, first: 0.0, time: time(1) };
    let later = (2..=stages).map(|j| {
        let rate = 2.0 * b(j) * w1 / b(j - 1);
        Stage {
            mu: 2.0 * b(j) * w0 / b(j - 1),
            nu: -b(j) / b(j - 2),
            rate,
            first: -(1.0 - b(j - 1) * chebyshev[j - 1][0]) * rate,
            time: time(j),
        }
    });
    [first].into_iter().chain(later).collect()
}
