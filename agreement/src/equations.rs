//! Models given as equations: the symbol L(ς, ik) of the linearised equations, by differentiation of the expressions,
//! compared with differences of the nonlinear residual.
//!
//! The residual is evaluated at the points of one period of a wave, on the jet of the background, which is constant, plus
//! the jet of the Fourier field ε Re(ẑ exp(ςt + ik·x)), whose derivatives are exact. Its first Fourier coefficient is
//! ε L ẑ + O(ε³). The central difference at the amplitudes ε and ε/2, extrapolated to ε = 0 (Richardson 1911), is the
//! column of L; among amplitudes ε of powers of two the pair that agrees best is taken (Ridders 1982), before differences
//! leave the range of small amplitudes.
//!
//! Waves followed in time are compared in [`evolution`].

mod differential_algebraic;
pub mod evolution;

use analysis::StateError;
use analysis::equations::EquationsWorkspace;
use analysis::pencil::PencilRoots;
use evolution::{Evolution, follow_wave};
use models::LinearisedSystem;
use models::common::elementary::{Elementary, Modulus, cr_cis};
use models::equations::{
    EvaluationError, JetVariable, MultiIndex, TextModel, TextState, TextWorkspace,
};
use num_complex::Complex64;
use std::cell::RefCell;
use std::f64::consts::{LN_10, TAU};

/// Largest relative difference between both symbols.
pub const SYMBOL_TOLERANCE: f64 = 1e-6;

/// Number of waves that are followed in time: each wave number twice.
pub const MAX_FOLLOWED: usize = 6;

/// Number of points of one period: enough to separate the first coefficient from those up to the sixth.
const POINT_COUNT: usize = 8;

/// Binary logarithms of the amplitudes.
const AMPLITUDE_EXPONENTS: std::ops::RangeInclusive<i32> = -80..=60;

/// Comparison of both symbols at one wave.
#[derive(Clone, Debug, PartialEq)]
pub struct SymbolComparison {
    /// Wave vector, 1/m, with as many components as dimensions.
    pub wave_vector: Vec<f64>,
    /// Complex rate ς at which the symbols are compared, 1/s, in the frame of the background velocity.
    pub rate: Complex64,
    /// Largest difference of an entry, relative to the sum of the sizes of its terms; infinite if differences fail.
    pub error: f64,
    /// Row and column of this entry.
    pub worst_entry: (usize, usize),
}

impl SymbolComparison {
    /// Whether both symbols agree to [`SYMBOL_TOLERANCE`].
    pub fn is_within_tolerance(&self) -> bool {
        self.error <= SYMBOL_TOLERANCE
    }
}

/// Comparison of the linearised equations and of the evolution in time at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveComparison {
    /// Comparison of both symbols.
    pub symbol: SymbolComparison,
    /// Evolution in time.
    pub evolution: Evolution,
}

/// Compares both symbols of a model, and its waves in time with the roots of the dispersion relation, at `count` waves
/// about the wave number `wave_number` (1/m), in directions that fill the circle or sphere evenly, or in one dimension at
/// wave numbers that fill two decades evenly; `state` is completed by
/// the background derivatives that it asks for. The first [`MAX_FOLLOWED`] waves are followed in time.
///
/// # Errors
/// The state does not satisfy the equations, or cannot be analysed.
pub fn compare_waves(
    model: &TextModel,
    state: &mut TextState,
    wave_number: f64,
    count: usize,
) -> Result<Vec<WaveComparison>, StateError> {
    let mut workspace = EquationsWorkspace::default();
    workspace.assess(model, state)?;
    let mut system = LinearisedSystem::<3>::default();
    model.linearise(state, &mut TextWorkspace::default(), &mut system)?;
    let residual = PerturbedResidual::new(model, state)?;
    (0..count)
        .map(|index| {
            let k = wave_number * spread_wave_number(model.dimensions(), index);
            let (direction, elevation) = spread_direction(model.dimensions(), index);
            let wave_vector = to_wave_vector(k, direction, elevation);
            // Roots in the frame of the background velocity.
            let turning: f64 = wave_vector.iter().zip(system.velocity).map(|(k, v)| k * v).sum();
            let roots: Option<Vec<Complex64>> =
                match workspace.roots(model, k, direction, elevation)? {
                    PencilRoots::Regular { finite, .. } => Some(
                        finite.iter().map(|root| root + Complex64::new(0.0, turning)).collect(),
                    ),
                    PencilRoots::Singular { .. } => None,
                };
            let rate = largest_rate(roots.as_deref()) * cr_cis(0.6 + 2.1 * index as f64);
            let symbol = compare_wave(&residual, &system, wave_vector, rate);
            let evolution = match roots {
                Some(_) if index >= MAX_FOLLOWED => Evolution::NotFollowed,
                Some(roots) => {
                    let factors = wave_vector.map(|k| Complex64::new(0.0, k));
                    follow_wave(&residual, &factors, &roots)
                }
                None => Evolution::Singular,
            };
            Ok(WaveComparison { symbol, evolution })
        })
        .collect()
}

/// Multiples of the golden ratio, which fill a unit interval evenly.
fn golden_fraction(index: usize) -> f64 {
    (0.2 + 0.618_033_988_749_894_9 * index as f64).fract()
}

/// Wave number relative to the given one. Waves of one dimension do not differ in direction.
fn spread_wave_number(dimensions: usize, index: usize) -> f64 {
    match index {
        3.. if dimensions == 1 => (LN_10 * (2.0 * golden_fraction(index) - 1.0)).cr_exp(),
        _ => [1.0, 0.31, 2.7][index % 3],
    }
}

/// Directions and elevations, rad, at the steps of the golden ratio.
fn spread_direction(dimensions: usize, index: usize) -> (f64, f64) {
    let turn = golden_fraction(index);
    match dimensions {
        1 => (0.0, 0.0),
        2 => (TAU * turn, 0.0),
        _ => (TAU * turn, (2.0 * (0.3 + 0.37 * index as f64).fract() - 1.0).cr_asin()),
    }
}

fn to_wave_vector(k: f64, direction: f64, elevation: f64) -> [f64; 3] {
    let (sin, cos) = direction.cr_sin_cos();
    let (up, along) = elevation.cr_sin_cos();
    [k * along * cos, k * along * sin, k * up]
}

/// Largest modulus of the roots at a wave, 1/s: a rate at which terms with time derivatives matter; 1 without roots.
fn largest_rate(roots: Option<&[Complex64]>) -> f64 {
    let found = roots.unwrap_or(&[]).iter().map(|root| root.modulus()).fold(0.0, f64::max);
    if found > 0.0 && found.is_finite() { found } else { 1.0 }
}

fn compare_wave(
    residual: &PerturbedResidual,
    system: &LinearisedSystem<3>,
    wave_vector: [f64; 3],
    rate: Complex64,
) -> SymbolComparison {
    let (rows, columns) = (system.equations.len(), system.unknowns.len());
    let factors = wave_vector.map(|k| Complex64::new(0.0, k));
    let (mut error, mut worst_entry) = (0.0f64, (0, 0));
    let derivative = |orders| derivative_factor(orders, &factors, rate);
    for column in 0..columns {
        let measured = residual.measure_column(column, &derivative);
        for row in 0..rows {
            let (value, size, rounding) = symbol_entry(system, (row, column), &factors, rate);
            let own = match measured.as_ref().map(|own| own[row]) {
                // The rounding of the coefficients, and that of the residual divided by the amplitude, is no
                // disagreement.
                Some((found, noise)) => {
                    let (difference, allowance) = ((found - value).modulus(), noise + rounding);
                    let is_accurate = allowance < 0.1 * SYMBOL_TOLERANCE * size;
                    let excess =
                        if is_accurate { difference } else { (difference - allowance).max(0.0) };
                    if excess == 0.0 { 0.0 } else { excess / size }
                }
                None => f64::INFINITY,
            };
            if own > error || own.is_nan() {
                (error, worst_entry) = (own, (row, column));
            }
        }
    }
    let wave_vector = wave_vector[..residual.model.dimensions()].to_vec();
    SymbolComparison { wave_vector, rate, error, worst_entry }
}

/// Value of an entry of the symbol, the sum of the sizes of its terms, and the bound on its error by rounding.
fn symbol_entry(
    system: &LinearisedSystem<3>,
    at: (usize, usize),
    factors: &[Complex64; 3],
    rate: Complex64,
) -> (Complex64, f64, f64) {
    let mut terms = vec![(Complex64::ONE, system.c[at]), (rate, system.a[at])];
    terms.extend(system.b.iter().zip(factors).map(|(b, factor)| (*factor, b[at])));
    for term in system.higher_terms.iter().filter(|term| (term.row, term.column) == at) {
        let powers = factors.iter().zip(term.space_powers);
        let space: Complex64 = powers.map(|(factor, power)| factor.powu(power.into())).product();
        terms.push((rate.powu(term.time_power.into()) * space, term.coefficient));
    }
    let value = terms.iter().map(|(factor, own)| factor * own.value).sum();
    let size = terms.iter().map(|(factor, own)| factor.modulus() * own.value.abs()).sum();
    let rounding = terms.iter().map(|(factor, own)| factor.modulus() * own.bound).sum();
    (value, size, rounding)
}

/// Estimate of an entry from pairs of amplitudes, in ascending order.
#[derive(Clone, Copy, Default)]
struct Estimate {
    /// Extrapolated value and the rounding of the differences, of the pair that agrees best.
    best: Option<(Complex64, f64)>,
    /// Disagreement of that pair.
    least_change: f64,
    /// Whether amplitudes have left the range in which differences approach the derivative.
    has_left_range: bool,
}

/// Factor by which the disagreement of a pair must exceed the rounding of its differences to show that the amplitude is
/// beyond a kink or no longer small.
const RANGE_FACTOR: f64 = 1e6;

impl Estimate {
    fn add_pair(&mut self, narrow: Complex64, wide: Complex64, noise: f64) {
        if self.has_left_range {
            return;
        }
        let extrapolated = (4.0 * narrow - wide) / 3.0;
        let difference = (narrow - wide).modulus() / 3.0;
        let change = difference + noise;
        self.has_left_range = self.best.is_some()
            && difference > RANGE_FACTOR * noise
            && change > 10.0 * self.least_change;
        if self.best.is_none() || change < self.least_change {
            (self.best, self.least_change) = (Some((extrapolated, noise)), change);
        }
    }
}

/// The nonlinear residual about a background.
struct PerturbedResidual<'a> {
    model: &'a TextModel,
    state: &'a TextState,
    /// Jet variables of the residual and their values at the background in its frame, ascending.
    jets: Vec<(JetVariable, f64)>,
}

impl<'a> PerturbedResidual<'a> {
    fn new(model: &'a TextModel, state: &'a TextState) -> Result<Self, EvaluationError> {
        let jets = RefCell::new(Vec::new());
        let jet = |variable: JetVariable| {
            let value = model.background_jet(state, variable).value;
            jets.borrow_mut().push((variable, value));
            value
        };
        model.evaluate_residuals(state, &mut Vec::new(), jet, |_| 0.0)?;
        let mut jets = jets.into_inner();
        jets.sort_by_key(|(variable, _)| *variable);
        Ok(Self { model, state, jets })
    }

    fn background(&self, variable: JetVariable) -> f64 {
        let index = self.jets.binary_search_by_key(&variable, |(own, _)| *own);
        index.map_or(0.0, |index| self.jets[index].1)
    }

    /// Largest order of the time derivatives of an unknown in the residual.
    fn time_order(&self, unknown: usize) -> u8 {
        let own = self.jets.iter().filter(|(variable, _)| variable.unknown == unknown);
        own.map(|(variable, _)| variable.orders[0]).max().unwrap_or(0)
    }

    /// A column of the symbol by differences of the residual, with the rounding of each entry; `None` if the residual is
    /// defined at no pair of amplitudes. The factor of each derivative of the Fourier field is that of `derivative`.
    fn measure_column(
        &self,
        column: usize,
        derivative: &dyn Fn(MultiIndex) -> Complex64,
    ) -> Option<Vec<(Complex64, f64)>> {
        // Smaller changes would be lost to the rounding of the background's own value and derivatives.
        let own = self.state.background.iter().filter(|(variable, _)| variable.unknown == column);
        let smallest = own
            .map(|(variable, value)| (value.value.abs(), derivative(variable.orders).modulus()))
            .filter(|(_, factor)| *factor > 0.0)
            .map(|(size, factor)| 1e-10 * size / factor)
            .fold(0.0, f64::max);
        let mut estimates = vec![Estimate::default(); self.model.equations().len()];
        let mut narrow: Option<(Vec<Complex64>, Vec<f64>)> = None;
        for exponent in AMPLITUDE_EXPONENTS {
            let amplitude = f64::from(exponent).cr_exp2();
            if amplitude < smallest {
                continue;
            }
            let wide = self.difference(column, derivative, amplitude);
            if let (Some((narrow, sizes)), Some((wide, _))) = (&narrow, &wide) {
                for (row, estimate) in estimates.iter_mut().enumerate() {
                    let noise = 32.0 * f64::EPSILON * sizes[row] / (0.5 * amplitude);
                    estimate.add_pair(narrow[row], wide[row], noise);
                }
            }
            narrow = wide;
            if estimates.iter().all(|own| own.has_left_range) {
                break;
            }
        }
        estimates.into_iter().map(|own| own.best).collect()
    }

    /// First Fourier coefficient of the central difference of the residual, divided by the amplitude, and the largest
    /// magnitude of each residual; `None` where the residual is not defined.
    fn difference(
        &self,
        column: usize,
        derivative: &dyn Fn(MultiIndex) -> Complex64,
        amplitude: f64,
    ) -> Option<(Vec<Complex64>, Vec<f64>)> {
        let (model, rows) = (self.model, self.model.equations().len());
        let (mut sums, mut sizes) = (vec![Complex64::ZERO; rows], vec![0.0f64; rows]);
        let mut registers = Vec::new();
        for point in 0..POINT_COUNT {
            let phase = cr_cis(TAU * point as f64 / POINT_COUNT as f64);
            let field = |sign: f64, variable: JetVariable| {
                if variable.unknown != column {
                    return 0.0;
                }
                sign * amplitude * (phase * derivative(variable.orders)).re
            };
            for sign in [1.0, -1.0] {
                let jet = |variable| self.background(variable) + field(sign, variable);
                let velocity = |axis: usize| {
                    model
                        .velocity_unknown(axis)
                        .map_or(0.0, |unknown| field(sign, JetVariable { unknown, orders: [0; 4] }))
                };
                let (found, terms) = model
                    .evaluate_residuals_and_terms(self.state, &mut registers, jet, velocity)
                    .ok()?;
                for row in 0..rows {
                    sums[row] += sign * found[row] * phase.conj();
                    sizes[row] = sizes[row].max(terms[row]);
                }
            }
        }
        // Σ over points of Re(L ẑ e^(iφ)) e^(−iφ) is L ẑ POINT_COUNT/2; both signs count twice.
        let scale = 1.0 / (POINT_COUNT as f64 * amplitude);
        sums.iter_mut().for_each(|sum| *sum *= scale);
        sums.iter().all(|sum| sum.is_finite()).then_some((sums, sizes))
    }
}

/// Factor ςᵃ Π (ikᵢ)^bᵢ of a derivative of a Fourier field.
fn derivative_factor(
    [time, space @ ..]: MultiIndex,
    factors: &[Complex64; 3],
    rate: Complex64,
) -> Complex64 {
    let powers = factors.iter().zip(space).map(|(factor, power)| factor.powu(power.into()));
    rate.powu(time.into()) * powers.product::<Complex64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use models::Rounded;
    use models::equations::{ModelText, NamedText, Quantity};

    /// A model with products, roots, a moving frame and second derivatives.
    fn build_model() -> (TextModel, TextState) {
        let quantity = |name: &str| Quantity { name: name.into(), unit: None };
        let text = |name: &str, text: &str| NamedText { name: name.into(), text: text.into() };
        let model = ModelText {
            dimensions: 2,
            unknowns: vec![quantity("u"), quantity("v"), quantity("p")],
            velocity: vec!["u".into(), "v".into()],
            parameters: vec![quantity("a")],
            definitions: vec![text("s", "a*p*sqrt(1 + d2(u)^2 + p^2)")],
            equations: vec![
                text("first", "p*D(u) = d1(d2(s)) - sin(v)*dt(p)"),
                text("second", "D(v) = d2(s)/p + exp(-u^2)*d1(d1(d1(p)))"),
                text("third", "dt(p) + d1(p*u) + d2(p*v) = max(p, u)*d2(u)"),
            ],
            driven: ["first", "second", "third"].map(String::from).to_vec(),
        };
        let model = TextModel::new(&model).expect("a model");
        let mut state = TextState { parameters: vec![0.7], ..TextState::default() };
        for (unknown, orders, value) in [
            (0, [0; 4], 0.3),
            (0, [0, 0, 1, 0], 1.4),
            (1, [0; 4], -0.6),
            (1, [0, 1, 0, 0], 0.2),
            (2, [0; 4], 1.7),
            (2, [1, 0, 0, 0], 0.4),
            (2, [0, 1, 1, 0], -0.9),
        ] {
            state.set_background(JetVariable { unknown, orders }, Rounded::from_rounded(value));
        }
        (model, state)
    }

    #[test]
    fn symbols_agree_to_the_rounding_of_differences() {
        let (model, mut state) = build_model();
        let found = compare_waves(&model, &mut state, 3.0, 12).expect("a state");
        let largest = found.iter().map(|own| own.symbol.error).fold(0.0, f64::max);
        assert!(found.iter().all(|own| own.symbol.is_within_tolerance()), "{found:?}");
        assert!(largest < 1e-8, "{largest:e}");
    }

    /// A relative change of any coefficient by 1e-5 is found.
    #[test]
    fn a_wrong_coefficient_is_found() {
        let (model, state) = build_model();
        let mut system = LinearisedSystem::<3>::default();
        model.linearise(&state, &mut TextWorkspace::default(), &mut system).expect("smooth");
        let (wave, rate) = ([2.0, -1.0, 0.0], Complex64::new(0.8, 1.9));
        let error = |system: &LinearisedSystem<3>| {
            let residual = PerturbedResidual::new(&model, &state).expect("smooth");
            let comparison = compare_wave(&residual, system, wave, rate);
            (comparison.error, comparison.worst_entry)
        };
        assert!(error(&system).0 < 1e-8);
        for index in 0..system.higher_terms.len() {
            let mut wrong = system.clone();
            let term = &mut wrong.higher_terms[index];
            term.coefficient.value *= 1.0 + 1e-5;
            let place = (term.row, term.column);
            let (found, entry) = error(&wrong);
            assert!(found > SYMBOL_TOLERANCE && entry == place, "{index}: {found:e} at {entry:?}");
        }
        for row in 0..3 {
            for column in 0..3 {
                let mut wrong = system.clone();
                let matrices = [&mut wrong.a, &mut wrong.c];
                for matrix in matrices.into_iter().chain(&mut wrong.b) {
                    let own = &mut matrix[(row, column)];
                    if own.value != 0.0 {
                        own.value *= 1.0 + 1e-4;
                        break;
                    }
                }
                if wrong.a != system.a || wrong.b != system.b || wrong.c != system.c {
                    let (found, entry) = error(&wrong);
                    assert!(found > SYMBOL_TOLERANCE, "{row}, {column}: {found:e}");
                    assert_eq!(entry, (row, column));
                }
            }
        }
    }
}
