//! Taylor models against arithmetic of 31 digits: at every point of the box the function lies within the enclosure, whose
//! error falls with the square of the box.

use crate::support::{DifferentiableReal, DoubleDouble, RIGHT_ANGLE, RandomNumbers, dd};
use std::f64::consts::PI;
use wellposed_models::common::scalar::{Function, Scalar};
use wellposed_models::common::taylor_model::TaylorModel;

/// The points of the square at which enclosures are compared: corners, centre and random points.
const POINT_COUNT: usize = 8;

/// A Taylor model with the exact values of the function at the points, and the largest magnitude of an intermediate result,
/// which scales the error of the 31-digit arithmetic.
#[derive(Clone, Copy)]
struct TrackedModel {
    model: TaylorModel,
    exact_values: [DoubleDouble; POINT_COUNT],
    magnitude: f64,
}

impl TrackedModel {
    fn combine(model: TaylorModel, exact: impl Fn(usize) -> DoubleDouble, magnitude: f64) -> Self {
        let exact_values: [DoubleDouble; POINT_COUNT] = std::array::from_fn(exact);
        let largest = exact_values.iter().map(|own| own.to_f64().abs()).fold(magnitude, f64::max);
        Self { model, exact_values, magnitude: largest }
    }

    fn range(&self) -> [f64; 2] {
        let values = self.exact_values.map(DoubleDouble::to_f64);
        values
            .iter()
            .fold([f64::INFINITY, f64::NEG_INFINITY], |own, &x| [own[0].min(x), own[1].max(x)])
    }

    /// Verifies the enclosure and the certain sign at all points, and returns whether half of the remainder would not
    /// suffice; `None` if the reference is not accurate enough.
    fn verify(&self, points: &[[f64; 2]; POINT_COUNT], what: &str) -> Option<bool> {
        let TaylorModel { value, slopes, remainder } = self.model;
        let noise = 1e-27 * self.magnitude;
        if noise > 1e-3 * remainder {
            return None;
        }
        let mut needs_all = false;
        for (exact, [u, v]) in self.exact_values.iter().zip(points) {
            let linear = dd(value) + dd(slopes[0]) * dd(*u) + dd(slopes[1]) * dd(*v);
            let error = (linear - *exact).abs().to_f64();
            assert!(
                error <= remainder * (1.0 + 1e-12) + noise,
                "{what}: error {error:e} beyond {remainder:e} at ({u}, {v}): {:?}",
                self.model
            );
            needs_all |= error > 0.5 * remainder;
            let exact = exact.to_f64();
            if let (Some(sign), true) = (self.model.sign(), exact.abs() > noise) {
                assert_eq!(f64::from(sign), exact.signum(), "{what}");
            }
            let [low, high] = self.model.range();
            assert!(low <= exact + noise && exact - noise <= high, "{what}");
        }
        Some(needs_all)
    }
}

fn exp(x: DoubleDouble) -> DoubleDouble {
    // The series of x/1024, squared ten times.
    let x = x * dd(1.0 / 1024.0);
    let (mut sum, mut term) = (dd(1.0), dd(1.0));
    for n in 1..20 {
        term = term * x / dd(f64::from(n));
        sum = sum + term;
    }
    (0..10).fold(sum, |own, _| own * own)
}

/// Solves f(y) = x by Newton's method from the double nearest to the root.
fn invert(
    start: f64,
    value_and_slope: impl Fn(DoubleDouble) -> (DoubleDouble, DoubleDouble),
    x: DoubleDouble,
) -> DoubleDouble {
    (0..3).fold(dd(start), |y, _| {
        let (value, slope) = value_and_slope(y);
        y - (value - x) / slope
    })
}

fn arctangent(x: DoubleDouble) -> DoubleDouble {
    let tangent = |y: DoubleDouble| {
        let (sine, cosine) = y.sin_cos();
        let own = sine / cosine;
        (own, dd(1.0) + own * own)
    };
    invert(x.to_f64().atan(), tangent, x)
}

fn arcsine(x: DoubleDouble) -> DoubleDouble {
    invert(x.to_f64().asin(), |y| y.sin_cos(), x)
}

fn logarithm(x: DoubleDouble) -> DoubleDouble {
    invert(x.to_f64().ln(), |y| (exp(y), exp(y)), x)
}

/// The function in 31 digits; `None` outside the range in which the reference keeps them.
fn reference(
    function: Function,
    own: &TrackedModel,
) -> Option<impl Fn(DoubleDouble) -> DoubleDouble> {
    let [low, high] = own.range();
    let is_within = |least: f64, most: f64| least < low && high < most;
    let is_defined = match function {
        Function::Sqrt | Function::Ln => is_within(1e-6, 1e6),
        Function::Asin | Function::Acos => is_within(-0.999, 0.999),
        Function::Tan => is_within(-1.5, 1.5),
        Function::Exp | Function::Sinh | Function::Cosh | Function::Tanh => is_within(-20.0, 20.0),
        _ => is_within(-1e3, 1e3),
    };
    is_defined.then_some(move |x: DoubleDouble| match function {
        Function::Sqrt => x.sqrt(),
        Function::Exp => exp(x),
        Function::Ln => logarithm(x),
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        Function::Tan => x.sin() / x.cos(),
        Function::Asin => arcsine(x),
        Function::Acos => RIGHT_ANGLE - arcsine(x),
        Function::Atan => arctangent(x),
        Function::Sinh => (exp(x) - exp(-x)) * dd(0.5),
        Function::Cosh => (exp(x) + exp(-x)) * dd(0.5),
        Function::Tanh => (exp(x) - exp(-x)) / (exp(x) + exp(-x)),
        Function::Abs => x.abs(),
        Function::Sign if x.to_f64() == 0.0 => dd(0.0),
        Function::Sign => dd(x.to_f64().signum()),
    })
}

const FUNCTIONS: [Function; 14] = [
    Function::Sqrt,
    Function::Exp,
    Function::Ln,
    Function::Sin,
    Function::Cos,
    Function::Tan,
    Function::Asin,
    Function::Acos,
    Function::Atan,
    Function::Sinh,
    Function::Cosh,
    Function::Tanh,
    Function::Abs,
    Function::Sign,
];

fn random_points(random: &mut RandomNumbers) -> [[f64; 2]; POINT_COUNT] {
    let mut points = [[0.0; 2]; POINT_COUNT];
    for (index, point) in points.iter_mut().enumerate() {
        *point = match index {
            0..4 => [[-1.0, 1.0][index % 2], [-1.0, 1.0][index / 2]],
            4 => [0.0; 2],
            _ => [random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)],
        };
    }
    points
}

/// A parameter from `low` to `high`, with its exact values at the points.
fn parameter(axis: usize, low: f64, high: f64, points: &[[f64; 2]; POINT_COUNT]) -> TrackedModel {
    let exact = |point: usize| {
        let place = (dd(1.0) + dd(points[point][axis])) * dd(0.5);
        dd(low) + (dd(high) - dd(low)) * place
    };
    TrackedModel::combine(TaylorModel::parameter(axis, low, high), exact, low.abs().max(high.abs()))
}

/// 100,000 boxes, on each a random sequence of ten operations on a shared pool of functions, so that terms recur with
/// opposite sign and cancel; sizes of boxes from 1e-8 to 1 of the parameter.
#[test]
fn functions_lie_within_their_enclosures() {
    let mut random = RandomNumbers::new(4040);
    let (mut steps, mut certain, mut tight, mut applied) = (0, 0, 0, [0; FUNCTIONS.len()]);
    for _ in 0..100_000 {
        let points = random_points(&mut random);
        let mut pool: Vec<TrackedModel> = Vec::new();
        for index in 0..4 {
            let value = random.signed_uniform(0.1, 10.0);
            let half = value.abs() * 10f64.powf(random.uniform(-8.0, 0.0));
            pool.push(match index {
                0 | 1 => parameter(index, value - half, value + half, &points),
                2 => TrackedModel::combine(TaylorModel::from_exact(value), |_| dd(value), 0.0),
                _ => {
                    let shift = value * random.uniform(-1.0, 1.0) * f64::EPSILON / 2.0;
                    let exact = move |_| dd(value) + dd(shift);
                    TrackedModel::combine(TaylorModel::from_rounded(value), exact, value.abs())
                }
            });
        }
        for _ in 0..10 {
            let [a, b] = [0; 2].map(|_| pool[random.uniform_index(pool.len())]);
            let values = |operation: fn(DoubleDouble, DoubleDouble) -> DoubleDouble| {
                let (a, b) = (a.exact_values, b.exact_values);
                move |point: usize| operation(a[point], b[point])
            };
            let size = a.magnitude.max(b.magnitude);
            let product = a.magnitude * b.magnitude;
            let (next, what) = match random.uniform_index(6) {
                0 => (TrackedModel::combine(a.model + b.model, values(|x, y| x + y), size), "sum"),
                1 => (
                    TrackedModel::combine(a.model - b.model, values(|x, y| x - y), size),
                    "difference",
                ),
                2 => (
                    TrackedModel::combine(a.model * b.model, values(|x, y| x * y), product),
                    "product",
                ),
                3 => {
                    let least =
                        b.exact_values.iter().map(|own| own.to_f64().abs()).fold(1e9, f64::min);
                    let size = product / (least * least);
                    (
                        TrackedModel::combine(a.model / b.model, values(|x, y| x / y), size),
                        "quotient",
                    )
                }
                _ => {
                    let index = random.uniform_index(FUNCTIONS.len());
                    let function = FUNCTIONS[index];
                    let Some(exact) = reference(function, &a) else { continue };
                    applied[index] += 1;
                    // A bound on the growth of errors of the reference.
                    let growth =
                        if a.range()[1].abs().max(a.range()[0].abs()) < 20.0 { 1e10 } else { 1e3 };
                    let size = match function {
                        Function::Sin | Function::Cos | Function::Abs | Function::Sign => {
                            a.magnitude.max(1.0)
                        }
                        _ => a.magnitude * growth,
                    };
                    let next = TrackedModel::combine(
                        a.model.apply(function),
                        |point| exact(a.exact_values[point]),
                        size,
                    );
                    (next, "function")
                }
            };
            let is_moderate = next.magnitude < 1e30 && next.model.value.abs() < 1e12;
            if !(next.model.is_finite() && is_moderate) {
                continue;
            }
            if let Some(needs_all) = next.verify(&points, what) {
                steps += 1;
                tight += usize::from(needs_all);
            }
            certain += usize::from(next.model.sign().is_some());
            pool.push(next);
        }
    }
    println!("{steps} steps, {certain} certain signs, {tight} tight, functions {applied:?}");
    assert!(steps > 300_000 && certain > steps / 2);
    // With half of the remainder many enclosures would be wrong.
    assert!(20 * tight > steps, "{tight} of {steps}");
    assert!(applied.iter().all(|&count| count > 1_000), "{applied:?}");
}

/// With half the box the remainder is a quarter, until rounding governs it.
#[test]
fn remainder_falls_with_the_square_of_the_box() {
    let enclose = |half: f64| {
        let x = TaylorModel::parameter(0, 1.3 - half, 1.3 + half);
        let y = TaylorModel::parameter(1, 0.7 - half, 0.7 + half);
        let angle = x.apply(Function::Sin).atan2(x + y.apply(Function::Sqrt));
        ((angle * y - x) / (x + y.power(x))).remainder
    };
    for half in [1e-1, 1e-2, 1e-3, 1e-4] {
        let ratio = enclose(half) / enclose(0.5 * half);
        assert!((3.8..5.0).contains(&ratio), "{half}: {ratio}");
    }
    assert!(enclose(1e-9) < 1e-14);
}

/// Numbers whose powers overflow or underflow are not enclosed, or rightly.
#[test]
fn extreme_numbers_are_not_enclosed_too_narrowly() {
    for scale in [1e-300, 1e-161, 1e-120, 1e-60, 1e60, 1e120, 1e170, 1e300] {
        let x = TaylorModel::parameter(0, 0.5 * scale, 1.5 * scale);
        let (least, most) = (0.5 * scale, 1.5 * scale);
        let check = |enclosure: TaylorModel, ends: [f64; 2]| {
            let [low, high] = enclosure.range();
            let is_too_narrow = low > ends[0] || high < ends[1];
            assert!(!is_too_narrow, "{scale}: [{low}, {high}] for {ends:?}");
        };
        check(TaylorModel::from_exact(1.0) / x, [1.0 / most, 1.0 / least]);
        check(x.apply(Function::Sqrt), [least.sqrt(), most.sqrt()]);
        check(x.apply(Function::Ln), [least.ln(), most.ln()]);
        check(x * x, [least * least, most * most]);
    }
}

/// Polar angles of points of boxes in all quadrants, against doubles; away from the negative axis the enclosures are not much
/// wider than the angles at the corners.
#[test]
fn polar_angles_lie_within_their_enclosures() {
    let random = &mut RandomNumbers::new(17);
    let mut enclosed = 0;
    for _ in 0..20_000 {
        let (radius, angle) = (10f64.powf(random.uniform(-3.0, 3.0)), random.uniform(-PI, PI));
        let half = radius * 10f64.powf(random.uniform(-9.0, -0.5));
        let [x, y] = [radius * angle.cos(), radius * angle.sin()];
        let [first, second] = [[x - half, x + half], [y - half, y + half]];
        let model = TaylorModel::parameter(1, second[0], second[1])
            .atan2(TaylorModel::parameter(0, first[0], first[1]));
        if !model.is_finite() {
            continue;
        }
        enclosed += 1;
        let [low, high] = model.range();
        let corners = [0, 1, 2, 3].map(|corner| {
            let value = second[corner / 2].atan2(first[corner % 2]);
            let rounding = 4e-16 * value.abs();
            assert!(low <= value + rounding && high >= value - rounding, "{value}: {low} {high}");
            value
        });
        let least = corners.iter().fold(4.0, |a: f64, b| a.min(*b));
        let most = corners.iter().fold(-4.0, |a: f64, b| a.max(*b));
        // Near the negative axis the ordinate divides.
        let is_wide = half > 0.05 * radius || (x < 0.0 && y.abs() < -x);
        assert!(is_wide || high - low < 1.5 * (most - least) + 3e-14, "{model:?} {corners:?}");
    }
    assert!(enclosed > 19_000, "{enclosed}");
}
