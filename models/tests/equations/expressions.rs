//! Random expressions: their derivatives and rounding bounds against dual numbers in 31 digits.

use crate::equations::text_models::model_text;
use crate::support::{DifferentiableReal, DoubleDouble, Dual, RandomNumbers, dd};
use wellposed_models::LinearisedSystem;
use wellposed_models::Rounded;
use wellposed_models::equations::{JetVariable, TextModel, TextState, TextWorkspace};

/// A random expression in the four jet variables u, d1(u), w, d1(w).
enum Tree {
    Number(f64),
    Variable(usize),
    Binary(char, Box<[Tree; 2]>),
    Call(&'static str, Box<Tree>),
    Call2(&'static str, Box<[Tree; 2]>),
    WholePower(Box<Tree>, i32),
    RealPower(Box<Tree>, f64),
}

const VARIABLES: [&str; 4] = ["u", "d1(u)", "w", "d1(w)"];
const FUNCTIONS: [&str; 14] = [
    "sqrt", "exp", "ln", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh",
    "abs", "sign",
];

fn draw(random: &mut RandomNumbers, depth: usize) -> Tree {
    let leaf = depth == 0 || random.bernoulli(0.15);
    if leaf {
        return if random.bernoulli(0.25) {
            // Decimals that are no doubles, so that their rounding matters.
            Tree::Number((random.uniform(0.1, 9.9) * 1e3).round() / 1e3)
        } else {
            Tree::Variable(random.uniform_index(VARIABLES.len()))
        };
    }
    let inner = |random: &mut RandomNumbers| Box::new(draw(random, depth - 1));
    match random.uniform_index(12) {
        0..=5 => {
            let sign = ['+', '-', '*', '*', '/', '+'][random.uniform_index(6)];
            Tree::Binary(sign, Box::new([draw(random, depth - 1), draw(random, depth - 1)]))
        }
        6 => Tree::WholePower(inner(random), [2, 3, -1, -2, 4][random.uniform_index(5)]),
        7 => Tree::RealPower(inner(random), [0.3, 1.7, -0.6, 2.5][random.uniform_index(4)]),
        8 => {
            let name = ["atan2", "min", "max"][random.uniform_index(3)];
            Tree::Call2(name, Box::new([draw(random, depth - 1), draw(random, depth - 1)]))
        }
        _ => Tree::Call(FUNCTIONS[random.uniform_index(FUNCTIONS.len())], inner(random)),
    }
}

impl Tree {
    fn text(&self) -> String {
        match self {
            Self::Number(value) => format!("{value}"),
            Self::Variable(index) => VARIABLES[*index].into(),
            Self::Binary(sign, both) => format!("({} {sign} {})", both[0].text(), both[1].text()),
            Self::Call(name, inner) => format!("{name}({})", inner.text()),
            Self::Call2(name, both) => format!("{name}({}, {})", both[0].text(), both[1].text()),
            Self::WholePower(inner, n) => format!("({})^{n}", inner.text()),
            Self::RealPower(inner, p) => format!("({})^{p}", inner.text()),
        }
    }
}

/// The decimal number nearest to a double, to 31 digits: numbers here have at most three decimals.
fn decimal(value: f64) -> DoubleDouble {
    dd((value * 1e3).round()) / dd(1e3)
}

fn exp(x: DoubleDouble) -> DoubleDouble {
    // exp x = (exp x/2¹²)^(2¹²) by Taylor series; the squarings lose 12 of about 104 bits.
    let y = x * dd(1.0 / 4096.0);
    let (mut sum, mut term) = (dd(0.0), dd(1.0));
    for n in 1..20 {
        sum = sum + term;
        term = term * y / dd(f64::from(n));
    }
    (0..12).fold(sum, |power, _| power * power)
}

fn ln(x: DoubleDouble) -> DoubleDouble {
    let mut y = dd(x.high.ln());
    for _ in 0..2 {
        y = y + (x - exp(y)) / exp(y);
    }
    y
}

fn atan(x: DoubleDouble) -> DoubleDouble {
    // atan x = y + atan((x − tan y)/(1 + x tan y)), with y accurate to a double.
    let y = dd(x.high.atan());
    let (sine, cosine) = y.sin_cos();
    let rest = (x * cosine - sine) / (cosine + x * sine);
    y + rest
}

fn asin(x: DoubleDouble) -> DoubleDouble {
    atan(x / ((dd(1.0) - x) * (dd(1.0) + x)).sqrt())
}

/// Value, derivative and second derivative of a function of one argument.
fn apply(name: &str, x: DoubleDouble) -> [DoubleDouble; 3] {
    let (one, two) = (dd(1.0), dd(2.0));
    let (sine, cosine) = x.sin_cos();
    let complement = (one - x) * (one + x);
    match name {
        "sqrt" => {
            let root = x.sqrt();
            [root, dd(0.5) / root, -(dd(0.25) / (root * x))]
        }
        "exp" => [exp(x); 3],
        "ln" => [ln(x), one / x, -(one / (x * x))],
        "sin" => [sine, cosine, -sine],
        "cos" => [cosine, -sine, -cosine],
        "tan" => {
            let tangent = sine / cosine;
            let slope = one / (cosine * cosine);
            [tangent, slope, two * tangent * slope]
        }
        "asin" => {
            let slope = one / complement.sqrt();
            [asin(x), slope, x * slope / complement]
        }
        "acos" => {
            let slope = one / complement.sqrt();
            let right_angle = crate::support::RIGHT_ANGLE;
            [right_angle - asin(x), -slope, -(x * slope / complement)]
        }
        "atan" => {
            let slope = one / (one + x * x);
            [atan(x), slope, -(two * x * slope * slope)]
        }
        "sinh" | "cosh" | "tanh" => {
            let (up, down) = (exp(x), exp(-x));
            let (sine, cosine) = ((up - down) * dd(0.5), (up + down) * dd(0.5));
            // Taylor series of sinh where the difference of exponentials cancels.
            let sine = if x.high.abs() > 0.3 {
                sine
            } else {
                let (mut sum, mut term) = (dd(0.0), x);
                for n in 1..16 {
                    sum = sum + term;
                    term = term * x * x / dd(f64::from(2 * n * (2 * n + 1)));
                }
                sum
            };
            match name {
                "sinh" => [sine, cosine, sine],
                "cosh" => [cosine, sine, cosine],
                _ => {
                    let slope = one / (cosine * cosine);
                    let value = sine / cosine;
                    [value, slope, -(two * value * slope)]
                }
            }
        }
        "abs" => [x.abs(), dd(x.high.signum()), dd(0.0)],
        "sign" => [dd(x.high.signum()), dd(0.0), dd(0.0)],
        _ => unreachable!("{name}"),
    }
}

/// A value, its derivative along one direction, and the sums of the sizes of the terms that both are sums of.
#[derive(Clone, Copy)]
struct Traced {
    number: Dual<DoubleDouble>,
    value_size: f64,
    slope_size: f64,
}

impl Traced {
    fn compose(self, [value, first, second]: [DoubleDouble; 3]) -> Self {
        let derivative = first * self.number.derivative;
        let [f, f1, f2] = [value, first, second].map(|own| own.to_f64().abs());
        Self {
            number: Dual { value, derivative },
            value_size: f + f1 * self.value_size,
            slope_size: (f1 + f2 * self.value_size) * self.slope_size,
        }
    }

    fn negated(self) -> Self {
        Self { number: -self.number, ..self }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            number: self.number + other.number,
            value_size: self.value_size + other.value_size,
            slope_size: self.slope_size + other.slope_size,
        }
    }

    fn times(self, other: Self) -> Self {
        Self {
            number: self.number * other.number,
            value_size: self.value_size * other.value_size,
            slope_size: self.value_size * other.slope_size + self.slope_size * other.value_size,
        }
    }

    fn reciprocal(self) -> Self {
        let (x, one) = (self.number.value, dd(1.0));
        self.compose([one / x, -(one / (x * x)), dd(2.0) / (x * x * x)])
    }
}

fn evaluate(tree: &Tree, variables: &[Dual<DoubleDouble>; 4]) -> Traced {
    let leaf = |number: Dual<DoubleDouble>| Traced {
        number,
        value_size: number.value.to_f64().abs(),
        slope_size: number.derivative.to_f64().abs(),
    };
    match tree {
        Tree::Number(value) => leaf(Dual { value: decimal(*value), derivative: dd(0.0) }),
        Tree::Variable(index) => leaf(variables[*index]),
        Tree::Binary(sign, both) => {
            let [a, b] = [0, 1].map(|side| evaluate(&both[side], variables));
            match sign {
                '+' => a.plus(b),
                '-' => a.plus(b.negated()),
                '*' => a.times(b),
                _ => a.times(b.reciprocal()),
            }
        }
        Tree::Call(name, inner) => {
            let x = evaluate(inner, variables);
            x.compose(apply(name, x.number.value))
        }
        Tree::Call2("atan2", both) => {
            let [y, x] = [0, 1].map(|side| evaluate(&both[side], variables));
            let (a, b) = (y.number.value, x.number.value);
            let square = a * a + b * b;
            // Half-angle formula without cancellation: tan(θ/2) = y/(r + x) or (r − x)/y.
            let radius = square.sqrt();
            let half = if b.high >= 0.0 { a / (radius + b) } else { (radius - b) / a };
            let value = dd(2.0) * atan(half);
            let derivative = (b * y.number.derivative - a * x.number.derivative) / square;
            let (size_a, size_b) = (y.value_size, x.value_size);
            let r2 = square.to_f64();
            let amplification = 1.0 + 4.0 * (size_a * size_a + size_b * size_b) / r2;
            Traced {
                number: Dual { value, derivative },
                value_size: value.to_f64().abs() + (size_a * size_b + size_b * size_a) / r2,
                slope_size: amplification * (size_b * y.slope_size + size_a * x.slope_size) / r2,
            }
        }
        Tree::Call2(name, both) => {
            let [a, b] = [0, 1].map(|side| evaluate(&both[side], variables));
            let first = (a.number.value - b.number.value).high > 0.0;
            if first == (*name == "max") { a } else { b }
        }
        Tree::WholePower(inner, n) => {
            let x = evaluate(inner, variables);
            let power = (0..n.unsigned_abs()).fold(dd(1.0), |own, _| own * x.number.value);
            let value = if *n < 0 { dd(1.0) / power } else { power };
            let (x0, n) = (x.number.value, f64::from(*n));
            let first = dd(n) * value / x0;
            x.compose([value, first, dd(n - 1.0) * first / x0])
        }
        Tree::RealPower(inner, p) => {
            let x = evaluate(inner, variables);
            let (x0, p) = (x.number.value, decimal(*p));
            let value = exp(p * ln(x0));
            let first = p * value / x0;
            // The exponent is a rounded decimal: an error of its last bit counts with the logarithm.
            let mut found = x.compose([value, first, (p - dd(1.0)) * first / x0]);
            let amplification = 1.0 + (p * ln(x0)).to_f64().abs();
            found.value_size *= amplification;
            found.slope_size *= amplification;
            found
        }
    }
}

/// 2,000 random expressions with finite derivatives: all their derivatives by jet variables agree with dual numbers in 31
/// digits to 1e-12 of the sum of the sizes of their terms, and rounding bounds contain the truth; so do value and total
/// derivative.
#[test]
fn derivatives_of_random_expressions_agree_with_dual_numbers() {
    let mut random = RandomNumbers::new(36);
    let (mut accepted, mut undefined, mut largest_error) = (0, 0, 0.0f64);
    while accepted < 2000 {
        let depth = 2 + random.uniform_index(4);
        let tree = draw(&mut random, depth);
        // The second equation is the total derivative of the first, and keeps both unknowns in the model.
        let text = tree.text();
        let equations =
            [("value", format!("{text} = 0*u")), ("slope", format!("d1({text}) = u + w"))];
        let equations: Vec<(&str, &str)> =
            equations.iter().map(|(name, text)| (*name, text.as_str())).collect();
        let built = model_text(1, &[("u", "-"), ("w", "-")], &[], &[], &[], &equations);
        let model = TextModel::new(&built).unwrap_or_else(|error| panic!("{text}: {error}"));
        let values = [0; 6].map(|_| random.signed_uniform(0.1, 2.0));
        // u, d1 u, w, d1 w, d1 d1 u, d1 d1 w.
        let variable =
            |unknown: usize, order: u8| JetVariable { unknown, orders: [0, order, 0, 0] };
        let variables = [
            variable(0, 0),
            variable(0, 1),
            variable(1, 0),
            variable(1, 1),
            variable(0, 2),
            variable(1, 2),
        ];
        let state = TextState {
            background: variables
                .iter()
                .zip(values)
                .map(|(&own, value)| (own, Rounded::from_exact(value)))
                .collect(),
            ..TextState::default()
        };
        let mut workspace = TextWorkspace::default();
        let mut system = LinearisedSystem::<1>::default();
        let point = |slopes: [f64; 4]| -> [Dual<DoubleDouble>; 4] {
            std::array::from_fn(|i| Dual { value: dd(values[i]), derivative: dd(slopes[i]) })
        };
        let total = evaluate(&tree, &point([values[1], values[4], values[3], values[5]]));
        let is_tame = total.value_size < 1e6 && total.slope_size < 1e6;
        let linearised = model.linearise(&state, &mut workspace, &mut system);
        let residuals = model.residuals(&state, &mut workspace);
        let (Ok(()), Ok(residuals)) = (linearised, residuals) else {
            undefined += 1;
            assert!(undefined < 20_000, "few expressions are defined");
            continue;
        };
        if !is_tame {
            continue;
        }
        let mut compare = |what: &str, found: Rounded, truth: DoubleDouble, size: f64| {
            let error = (dd(found.value) - truth).to_f64().abs();
            // The reference has 31 digits of each term.
            assert!(
                error <= found.bound + 1e-28 * size,
                "{text}: {what}: {found:?}, not {truth:?}"
            );
            assert!(error <= 1e-12 * size, "{text}: {what}: {error:e} of {size:e}");
            largest_error = largest_error.max(error / size.max(f64::MIN_POSITIVE));
        };
        compare("value", residuals[0].residual, total.number.value, total.value_size);
        let rest = values[0] + values[2];
        let slope = total.number.derivative - dd(values[0]) - dd(values[2]);
        compare(
            "total derivative",
            residuals[1].residual,
            slope,
            total.slope_size + rest.abs() + 4.0,
        );
        for (index, name) in VARIABLES.into_iter().enumerate() {
            let direction: [f64; 4] = std::array::from_fn(|i| f64::from(i == index));
            let truth = evaluate(&tree, &point(direction));
            let at = (0, index / 2);
            let found = if index % 2 == 0 { system.c[at] } else { system.b[0][at] };
            compare(name, found, truth.number.derivative, truth.slope_size);
        }
        accepted += 1;
    }
    println!("largest error {largest_error:e} of the terms; {undefined} expressions undefined");
}
