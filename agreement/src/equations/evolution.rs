//! Models given as equations: plane waves followed in time, compared with the roots of the dispersion relation.
//!
//! For a Fourier field ẑ(t) exp(ik·x) the linearised equations are Σ Mₘ dᵐẑ/dtᵐ = 0. The matrices Mₘ are differences of
//! the nonlinear residual, in which the time derivatives of each order are perturbed by themselves, so that nothing
//! comes from the differentiation of the expressions. The first-order form E ẏ + A y = 0 is reduced to index 1 and
//! integrated (see `differential_algebraic`).
//!
//! - A run starts from the mode of each simple root: the vector that the equations at this root annihilate best. Growth
//!   rate and frequency are fitted to its amplitude.
//! - A run starts from a state that contains all modes, projected on the constraints. States at equal intervals satisfy
//!   the linear recurrence whose characteristic roots are exp(ςΔ) (Prony 1795), multiple roots included.
//! - The number of independent solutions is the number of finite roots.
//!
//! **Tolerances.** The symbols of both sides agree to [`SYMBOL_TOLERANCE`] of the terms of each entry. To first order
//! such a change of all entries moves the simple root ς with the left and right vectors w and x by at most
//! `SYMBOL_TOLERANCE` × |w|ᵀ(|E||ς| + |A|)|x| / |wᴴE x|, which is the tolerance of the root. To it come the error of the
//! method, |ςΔt|⁵/7200 = 4e-11 of ς, and the rounding of the states, amplified by other modes and the fit. A recurrence may be off by [`SYMBOL_TOLERANCE`] of its terms per root.

use super::differential_algebraic::{RadauStepper, ReducedEquations, radau_stability_function};
use super::{PerturbedResidual, SYMBOL_TOLERANCE};
use crate::fit::{fit_rate, max_rate_error};
use models::common::elementary::{Elementary, Modulus, cr_cis};
use models::equations::MultiIndex;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

type Matrix = DMatrix<Complex64>;
type Vector = DVector<Complex64>;

/// Product of root and time step; at 0.05 the error of a step, relative to the change in it, is 4e-11.
const STEP_ANGLE: f64 = 0.05;

/// Relative error of a rate due to the method, z⁵/7200 at z = [`STEP_ANGLE`].
const METHOD_ERROR: f64 = STEP_ANGLE * STEP_ANGLE * STEP_ANGLE * STEP_ANGLE * STEP_ANGLE / 7200.0;

/// Number of steps of a run that measures a rate, unless a faster growing mode would emerge from rounding.
const MODE_STEPS: [usize; 2] = [8, 64];

/// Largest growth of other modes relative to the measured one over a run.
const MAX_CONTAMINATION_GROWTH: f64 = 1e4;

/// Steps between the states of a recurrence: the fastest mode turns or changes by two radians or e-folds.
const RECURRENCE_INTERVAL: usize = 40;

/// Roots slower than this fraction of the fastest one are followed over the time that this fraction takes.
const SLOWEST_FOLLOWED: f64 = 1e-3;

/// Tolerance, as a fraction of the largest root, above which a root counts as multiple.
const MAX_RESOLVED_TOLERANCE: f64 = 1e-3;

/// Evolution of the mode of a root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeEvolution {
    /// Root ς of the dispersion relation, 1/s, in the frame of the background velocity.
    pub predicted: Complex64,
    /// Rate fitted to the amplitude, 1/s.
    pub measured: Complex64,
    /// Largest difference that agrees, 1/s.
    pub tolerance: f64,
}

impl ModeEvolution {
    /// Whether both rates agree.
    pub fn is_within_tolerance(&self) -> bool {
        (self.measured - self.predicted).modulus() <= self.tolerance
    }
}

/// Evolution of the modes of a wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveEvolution {
    /// Modes of simple roots.
    pub modes: Vec<ModeEvolution>,
    /// Number of roots, of which those without mode coincide with others to within their tolerance.
    pub root_count: usize,
    /// Number of independent solutions of the equations in time.
    pub solution_count: usize,
    /// Number of times that constraints were differentiated; 1 for incompressibility.
    pub differentiation_count: usize,
    /// Largest residual of the undifferentiated constraints at the end of runs, relative to the state.
    pub constraint_residual: f64,
    /// Residual of the recurrence of the roots for a state of all modes, relative to its terms.
    pub recurrence_error: f64,
}

impl WaveEvolution {
    /// Largest residual of the recurrence that agrees.
    pub fn recurrence_tolerance(&self) -> f64 {
        SYMBOL_TOLERANCE * self.root_count.max(1) as f64
    }

    /// Whether the numbers of solutions, all rates, and the recurrence agree.
    pub fn is_in_agreement(&self) -> bool {
        self.root_count == self.solution_count
            && self.modes.iter().all(ModeEvolution::is_within_tolerance)
            && self.recurrence_error <= self.recurrence_tolerance()
    }

    /// Largest difference of a rate, relative to the largest root; 0 without modes.
    pub fn max_relative_difference(&self) -> f64 {
        let size = self.modes.iter().map(|own| own.predicted.modulus()).fold(0.0, f64::max);
        let difference = self
            .modes
            .iter()
            .map(|own| (own.measured - own.predicted).modulus())
            .fold(0.0, f64::max);
        if difference == 0.0 { 0.0 } else { difference / size }
    }
}

/// Evolution in time of the waves of one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub enum Evolution {
    /// The waves were followed.
    Followed(WaveEvolution),
    /// The equations are singular, so that they do not determine the evolution.
    Singular,
    /// The waves were not followed.
    NotFollowed,
}

/// Follows the waves of the wave vector k with ik = `factors` in time, and compares them with the `roots` of the
/// dispersion relation, 1/s, in the frame of the background velocity.
pub(super) fn follow_wave(
    residual: &PerturbedResidual,
    factors: &[Complex64; 3],
    roots: &[Complex64],
) -> Evolution {
    try_follow(residual, factors, roots).map_or(Evolution::Singular, Evolution::Followed)
}

/// As [`follow_wave`]; `None` if the equations in time are singular or the residual is defined at no pair of amplitudes.
fn try_follow(
    residual: &PerturbedResidual,
    factors: &[Complex64; 3],
    roots: &[Complex64],
) -> Option<WaveEvolution> {
    let largest = roots.iter().map(|root| root.modulus()).fold(0.0, f64::max);
    let rate_unit = if largest > 0.0 { largest } else { 1.0 };
    let matrices = measure_time_orders(residual, factors)?;
    let (e, a) = build_first_order_form(&matrices, rate_unit)?;
    let equations = ReducedEquations::new(e.clone(), a.clone())?;
    let scaled: Vec<Complex64> = roots.iter().map(|root| root / rate_unit).collect();
    let mut constraint_residual = 0.0f64;
    let mut modes = Vec::new();
    for &root in &scaled {
        let (mode, tolerance) = find_mode(&e, &a, root);
        let is_simple = tolerance <= MAX_RESOLVED_TOLERANCE;
        if !is_simple {
            continue;
        }
        let (measured, rounding, end) = measure_rate(&equations, &scaled, root, &mode)?;
        let tolerance = tolerance + METHOD_ERROR * root.modulus() + rounding;
        constraint_residual = constraint_residual.max(equations.constraint_residual(&end));
        modes.push(ModeEvolution {
            predicted: root * rate_unit,
            measured: measured * rate_unit,
            tolerance: tolerance * rate_unit,
        });
    }
    let recurrence_error = measure_recurrence(&equations, &scaled, &mut constraint_residual)?;
    Some(WaveEvolution {
        modes,
        root_count: roots.len(),
        solution_count: equations.dimension(),
        differentiation_count: equations.differentiated.nrows(),
        constraint_residual,
        recurrence_error,
    })
}

/// Coefficient matrices Mₘ of the time derivatives of order m of a Fourier field, by differences of the residual;
/// entries within their rounding are zero.
fn measure_time_orders(
    residual: &PerturbedResidual,
    factors: &[Complex64; 3],
) -> Option<Vec<Matrix>> {
    let (rows, columns) = (residual.model.equations().len(), residual.model.unknowns().len());
    let largest_order = (0..columns).map(|own| residual.time_order(own)).max().unwrap_or(0);
    (0..=largest_order)
        .map(|order| {
            let factor = |[time, space @ ..]: MultiIndex| {
                if time != order {
                    return Complex64::ZERO;
                }
                let powers = factors.iter().zip(space);
                powers.map(|(factor, power)| factor.powu(power.into())).product()
            };
            let mut matrix = Matrix::zeros(rows, columns);
            for column in (0..columns).filter(|own| order <= residual.time_order(*own)) {
                let own = residual.measure_column(column, &factor)?;
                for (row, (value, noise)) in own.into_iter().enumerate() {
                    if value.modulus() > noise {
                        matrix[(row, column)] = value;
                    }
                }
            }
            Some(matrix)
        })
        .collect()
}

/// Matrices E and A of the first-order form in time units of 1/`rate_unit`, equilibrated; `None` if an equation or an
/// unknown has no coefficient.
///
/// An unknown whose largest time derivative is of order d has the states z, ż, …, of which the last has order d − 1; an
/// algebraic unknown is a state itself.
fn build_first_order_form(matrices: &[Matrix], rate_unit: f64) -> Option<(Matrix, Matrix)> {
    let (rows, columns) = matrices.first()?.shape();
    if rows != columns {
        return None;
    }
    let powers: Vec<f64> = (0..matrices.len() as i32).map(|m| rate_unit.powi(m)).collect();
    let size_at = |i: usize, j: usize| {
        matrices
            .iter()
            .zip(&powers)
            .map(|(m, power)| m[(i, j)].modulus() * power)
            .fold(0.0, f64::max)
    };
    let sizes = DMatrix::from_fn(rows, columns, size_at);
    let [row_scales, column_scales] = equilibrate(&sizes)?;
    let order = |j: usize| {
        (0..matrices.len()).rev().find(|m| matrices[*m].column(j).camax() > 0.0).unwrap_or(0)
    };
    let orders: Vec<usize> = (0..columns).map(order).collect();
    let first_states: Vec<usize> = orders
        .iter()
        .scan(0, |next, order| {
            let own = *next;
            *next += (*order).max(1);
            Some(own)
        })
        .collect();
    let count: usize = orders.iter().map(|order| (*order).max(1)).sum();
    let (mut e, mut a) = (Matrix::zeros(count, count), Matrix::zeros(count, count));
    let mut next_row = rows;
    for (j, (&order, &first)) in orders.iter().zip(&first_states).enumerate() {
        for i in 0..rows {
            let scaled =
                |m: usize| matrices[m][(i, j)] * (powers[m] * row_scales[i] * column_scales[j]);
            for m in 0..order.max(1) {
                a[(i, first + m)] = scaled(m);
            }
            if order > 0 {
                e[(i, first + order - 1)] = scaled(order);
            }
        }
        for m in 1..order {
            (e[(next_row, first + m - 1)], a[(next_row, first + m)]) =
                (Complex64::ONE, -Complex64::ONE);
            next_row += 1;
        }
    }
    Some((e, a))
}

/// Scales of rows and columns that bring the largest entry of each to about one (Ruiz 2001); `None` if one has none.
fn equilibrate(sizes: &DMatrix<f64>) -> Option<[Vec<f64>; 2]> {
    let (mut rows, mut columns) = (vec![1.0; sizes.nrows()], vec![1.0; sizes.ncols()]);
    for _ in 0..20 {
        let scaled = DMatrix::from_fn(rows.len(), columns.len(), |i, j| {
            sizes[(i, j)] * rows[i] * columns[j]
        });
        let largest_in_rows: Vec<f64> = scaled.row_iter().map(|row| row.amax()).collect();
        let largest_in_columns: Vec<f64> = scaled.column_iter().map(|own| own.amax()).collect();
        if largest_in_rows.iter().chain(&largest_in_columns).any(|own| *own <= 0.0 || own.is_nan())
        {
            return None;
        }
        rows.iter_mut().zip(&largest_in_rows).for_each(|(own, largest)| *own /= largest.sqrt());
        columns.iter_mut().zip(&largest_in_columns).for_each(|(own, size)| *own /= size.sqrt());
    }
    Some([rows, columns])
}

/// The vector that the equations annihilate best at the rate `root`, and the tolerance of the root.
fn find_mode(e: &Matrix, a: &Matrix, root: Complex64) -> (Vector, f64) {
    let svd = (e * root + a).svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return (Vector::zeros(0), f64::INFINITY) };
    let last = e.ncols() - 1;
    let (left, mode) = (u.column(last).into_owned(), v_t.row(last).adjoint());
    let size = |own: &Matrix| own.map(|entry| entry.modulus());
    let sizes = size(e) * root.modulus() + size(a);
    let change = left.map(|own| own.modulus()).dot(&(sizes * mode.map(|own| own.modulus())));
    let slope = left.dotc(&(e * &mode)).modulus();
    (mode, SYMBOL_TOLERANCE * change / slope)
}

/// Rate fitted to the amplitude of `mode` in a run that starts from it, its error due to rounding, and the last state.
fn measure_rate(
    equations: &ReducedEquations,
    roots: &[Complex64],
    root: Complex64,
    mode: &Vector,
) -> Option<(Complex64, f64, Vector)> {
    let slowest = SLOWEST_FOLLOWED;
    let mut time_step =
        STEP_ANGLE / if root == Complex64::ZERO { 1.0 } else { root.modulus().max(slowest) };
    // Growth of the other modes by the method itself in one step, relative to that of this mode.
    let growth = |time_step: f64| {
        let factor = |own: Complex64| radau_stability_function(own * time_step).modulus();
        roots.iter().map(|own| factor(*own)).fold(0.0, f64::max) / factor(root)
    };
    let [fewest, most] = MODE_STEPS;
    let allowed = |steps: usize| MAX_CONTAMINATION_GROWTH.cr_powf(1.0 / steps as f64);
    while growth(time_step) > allowed(fewest) {
        time_step *= 0.5;
    }
    let found = growth(time_step);
    let steps = (fewest..=most).rev().find(|steps| found <= allowed(*steps)).unwrap_or(fewest);
    let stepper = RadauStepper::new(equations, time_step);
    let mut state = mode.clone();
    let (mut times, mut amplitudes) = (vec![0.0], vec![mode.dotc(&state)]);
    for step in 1..=steps {
        state = stepper.step(&state)?;
        times.push(time_step * step as f64);
        amplitudes.push(mode.dotc(&state));
    }
    let rate = fit_rate(&times, &amplitudes);
    // Each state is rounded by a few units in the last place per unknown, which other modes amplify.
    let error = MAX_CONTAMINATION_GROWTH * f64::EPSILON * state.len() as f64;
    let rounding = max_rate_error(error, time_step * steps as f64);
    Some((Complex64::new(rate.growth_rate, -rate.frequency), rounding, state))
}

/// Residual of the recurrence with the characteristic roots exp(ςΔ) for a run that starts from a consistent state with
/// components along all modes, relative to the sizes of its terms.
fn measure_recurrence(
    equations: &ReducedEquations,
    roots: &[Complex64],
    constraint_residual: &mut f64,
) -> Option<f64> {
    if equations.dimension() == 0 {
        return Some(0.0);
    }
    let interval = STEP_ANGLE * RECURRENCE_INTERVAL as f64;
    let mut coefficients = vec![Complex64::ONE];
    for root in roots {
        let z = root * interval;
        let factor = cr_cis(z.im) * z.re.cr_exp();
        // Times x − factor; coefficients ascend.
        coefficients.insert(0, Complex64::ZERO);
        for index in 0..coefficients.len() - 1 {
            let next = coefficients[index + 1];
            coefficients[index] -= factor * next;
        }
    }
    let size = equations.consistent_states.nrows();
    let start = Vector::from_fn(size, |i, _| cr_cis(2.4 * (i * i) as f64 + 0.7 * i as f64));
    let stepper = RadauStepper::new(equations, STEP_ANGLE);
    let mut states = vec![equations.project(&start)];
    for _ in 0..coefficients.len() {
        let mut state = states[states.len() - 1].clone();
        for _ in 0..RECURRENCE_INTERVAL {
            state = stepper.step(&state)?;
        }
        *constraint_residual = constraint_residual.max(equations.constraint_residual(&state));
        states.push(state);
    }
    let error = |first: usize| {
        let terms = coefficients.iter().zip(&states[first..]);
        let size: f64 = terms.clone().map(|(own, state)| own.modulus() * state.norm()).sum();
        let sum = terms.fold(Vector::zeros(start.len()), |sum, (own, state)| sum + state * *own);
        sum.norm() / size
    };
    Some(error(0).max(error(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use models::Rounded;
    use models::equations::{JetVariable, ModelText, NamedText, Quantity, TextModel, TextState};

    fn build(
        unknowns: &[&str],
        equations: &[&str],
        background: &[(usize, [u8; 4], f64)],
    ) -> (TextModel, TextState) {
        let quantity = |name: &&str| Quantity { name: (*name).into(), unit: None };
        let name =
            |(i, text): (usize, &&str)| NamedText { name: format!("e{i}"), text: (*text).into() };
        let text = ModelText {
            dimensions: 2,
            unknowns: unknowns.iter().map(quantity).collect(),
            equations: equations.iter().enumerate().map(name).collect(),
            ..ModelText::default()
        };
        let mut state = TextState::default();
        for &(unknown, orders, value) in background {
            state.set_background(JetVariable { unknown, orders }, Rounded::from_rounded(value));
        }
        (TextModel::new(&text).expect("a model"), state)
    }

    fn follow(
        (model, state): &(TextModel, TextState),
        k: [f64; 2],
        roots: &[Complex64],
    ) -> Option<WaveEvolution> {
        let factors = [k[0], k[1], 0.0].map(|k| Complex64::new(0.0, k));
        let residual = PerturbedResidual::new(model, state).expect("smooth");
        match follow_wave(&residual, &factors, roots) {
            Evolution::Followed(found) => Some(found),
            _ => None,
        }
    }

    fn assert_rates(found: &WaveEvolution, expected: &[Complex64]) {
        assert!(found.is_in_agreement(), "{found:?}");
        assert_eq!(found.modes.len(), expected.len());
        let size = expected.iter().map(|own| own.modulus()).fold(0.0, f64::max);
        for (mode, expected) in found.modes.iter().zip(expected) {
            assert!((mode.measured - expected).modulus() < 1e-9 * size, "{mode:?}, not {expected}");
            // The tolerance is no more than a few of the changes of entries that it stands for.
            assert!(mode.tolerance < 1e-5 * size, "{mode:?}");
        }
    }

    /// A damped string, of second order in time, with a second unknown that relaxes much faster and one that grows.
    #[test]
    fn rates_of_fast_slow_and_growing_modes_are_measured() {
        let model = build(
            &["u", "c", "g"],
            &[
                "3*dt(dt(u)) + 0.2*dt(u) = 5*(d1(d1(u)) + d2(d2(u))) + c^3",
                "dt(c) + 1e4*(c - u^2) = 0",
                "dt(g) + 0.7*(d1(d1(g)) + d2(d2(g))) = 0",
            ],
            &[(0, [0; 4], 0.0), (1, [0; 4], 0.0)],
        );
        let square = 1.3f64 * 1.3 + 0.4 * 0.4;
        let (damping, stiffness) = (0.2 / 3.0, 5.0 / 3.0 * square);
        let frequency = (stiffness - 0.25 * damping * damping).sqrt();
        let roots = [
            Complex64::new(0.7 * square, 0.0),
            Complex64::new(-0.5 * damping, frequency),
            Complex64::new(-0.5 * damping, -frequency),
            Complex64::new(-1e4, 0.0),
        ];
        let found = follow(&model, [1.3, -0.4], &roots).expect("regular");
        assert_rates(&found, &roots);
        assert_eq!((found.solution_count, found.differentiation_count), (4, 0));
        for index in 0..4 {
            let mut wrong = roots;
            wrong[index] *= 1.0 + 3e-5;
            let found = follow(&model, [1.3, -0.4], &wrong).expect("regular");
            assert!(!found.is_in_agreement(), "{index}: {found:?}");
        }
        let found = follow(&model, [1.3, -0.4], &roots[..3]).expect("regular");
        assert!(!found.is_in_agreement(), "{found:?}");
    }

    /// Incompressible flow decays as −νk²; the constraint is differentiated once, and its drift is rounding.
    #[test]
    fn incompressible_flow_decays_and_keeps_its_constraint() {
        let model = build(
            &["v1", "v2", "p"],
            &[
                "2*(dt(v1) + v1*d1(v1) + v2*d2(v1)) = -d1(p) + 0.3*(d1(d1(v1)) + d2(d2(v1)))",
                "2*(dt(v2) + v1*d1(v2) + v2*d2(v2)) = -d2(p) + 0.3*(d1(d1(v2)) + d2(d2(v2)))",
                "d1(v1) + d2(v2) = 0",
            ],
            &[(0, [0; 4], 0.8)],
        );
        let roots = [Complex64::new(-0.15 * (4.0 + 9.0), -0.8 * 2.0)];
        let found = follow(&model, [2.0, 3.0], &roots).expect("regular");
        assert_rates(&found, &roots);
        assert_eq!(found.differentiation_count, 1);
        assert!(found.constraint_residual < 1e-12, "{found:?}");
    }

    /// Double roots have no mode of their own, and are compared by the recurrence.
    #[test]
    fn multiple_roots_are_compared_together() {
        let model = build(&["u", "w"], &["dt(u) = w - 2*u", "dt(w) = -2*w"], &[]);
        let double = [Complex64::new(-2.0, 0.0); 2];
        let found = follow(&model, [1.0, 0.0], &double).expect("regular");
        assert!(found.is_in_agreement() && found.modes.is_empty(), "{found:?}");
        let found = follow(&model, [1.0, 0.0], &double.map(|own| own * 1.001)).expect("regular");
        assert!(!found.is_in_agreement(), "{found:?}");
    }

    #[test]
    fn equations_that_do_not_determine_the_evolution_are_not_followed() {
        let model = build(&["u", "w"], &["dt(u) + d1(w) = 0", "2*dt(u) + 2*d1(w) = 0"], &[]);
        assert_eq!(follow(&model, [1.0, 0.5], &[]), None);
        let model = build(&["u", "w"], &["dt(u) + d1(w) = 0"], &[]);
        assert_eq!(follow(&model, [1.0, 0.5], &[]), None);
    }
}
