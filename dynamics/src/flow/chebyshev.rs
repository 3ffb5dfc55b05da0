//! Second-order Runge–Kutta–Chebyshev method (Sommeijer, Shampine & Verwer 1998): with s stages, each one evaluation of
//! the right-hand side, a step of size h is stable for decay rates up to about ⅔s²/h.

/// Damping ε of the stability polynomial.
const DAMPING: f64 = 2.0 / 13.0;

/// Computes the stability limit: the largest product of decay rate and step size for a number of stages.
pub(super) fn stability_limit(stages: usize) -> f64 {
    let squared = (stages * stages) as f64;
    2.0 / 3.0 * (squared - 1.0) * (1.0 - 2.0 * DAMPING / 15.0)
}

/// Computes the smallest number of stages, at least 2, that is stable for a product of decay rate and step size.
pub(super) fn required_stages(product: f64) -> usize {
    let estimate = (1.0 + 1.5 * product / (1.0 - 2.0 * DAMPING / 15.0)).sqrt();
    (estimate.ceil() as usize).max(2)
}

/// Coefficients of stage j of a step of size h from the state Y₀, with the right-hand side F:
/// Yⱼ = (1 − μ − ν) Y₀ + μ Yⱼ₋₁ + ν Yⱼ₋₂ + h (μ̃ F(Yⱼ₋₁) + γ̃ F(Y₀)).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StageCoefficients {
    pub(super) mu: f64,
    pub(super) nu: f64,
    pub(super) mu_tilde: f64,
    pub(super) gamma_tilde: f64,
    /// Time of Yⱼ since the start of the step, in units of the step size.
    pub(super) time: f64,
}

/// Computes the coefficients of stages 1 … s, s = `stages`.
pub(super) fn compute_coefficients(stages: usize) -> Vec<StageCoefficients> {
    let s = stages as f64;
    let w0 = 1.0 + DAMPING / (s * s);
    // Chebyshev polynomials Tⱼ, Tⱼ′ and Tⱼ″ at w₀.
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
    let first = StageCoefficients {
        mu: 1.0,
        nu: 0.0,
        mu_tilde: b(1) * w1,
        gamma_tilde: 0.0,
        time: time(1),
    };
    let later = (2..=stages).map(|j| {
        let rate = 2.0 * b(j) * w1 / b(j - 1);
        StageCoefficients {
            mu: 2.0 * b(j) * w0 / b(j - 1),
            nu: -b(j) / b(j - 2),
            mu_tilde: rate,
            gamma_tilde: -(1.0 - b(j - 1) * chebyshev[j - 1][0]) * rate,
            time: time(j),
        }
    });
    [first].into_iter().chain(later).collect()
}
