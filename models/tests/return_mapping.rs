//! Optimised operations of the return mapping are bitwise equal to the plain formulas.

mod support;

use support::{Random, decades};
use wellposed_models::common::number::{Number, third};
use wellposed_models::yield_set::return_mapping::{Equation, PARTS};

/// `third` is bitwise equal to the division by 3 in double and single precision.
#[test]
fn thirds_are_quotients_to_the_bit() {
    let mut random = Random::new(81);
    let edges = [0.0, 1.0, -3.0, 1e-290, f64::MAX, f64::MIN];
    let near: Vec<f64> = (0..2000).map(|i| f64::from_bits(1.0f64.to_bits() + i)).collect();
    for x in edges.into_iter().chain(near) {
        assert_eq!(third(x).to_bits(), (x / 3.0).to_bits(), "{x:e}");
    }
    for _ in 0..1_000_000 {
        let x = random.within(-1.0, 1.0) * decades(&mut random, -290.0, 308.0);
        assert_eq!(third(x).to_bits(), (x / 3.0).to_bits(), "{x:e}");
        let x = (random.within(-1.0, 1.0) * decades(&mut random, -28.0, 38.0)) as f32;
        assert_eq!(third(x).to_bits(), (x / 3.0).to_bits(), "{x:e}");
    }
}

/// Plain Newton's method: two divisions per step, until the step is zero.
fn newton<N: Number>(equation: &Equation<N>) -> N {
    let mut x = N::ZERO;
    loop {
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in (0..PARTS).filter(|part| equation.seen[*part]) {
            let fraction = N::ONE / (N::ONE + x * equation.rates[part]);
            let term = equation.squares[part] * fraction * fraction;
            norm = norm + term;
            slope = slope + term * fraction * equation.rates[part];
        }
        let reciprocal = N::ONE / norm.sqrt();
        let slope = slope / norm * reciprocal;
        let excess = N::ONE - equation.a * x - equation.shear_capacity * reciprocal;
        let next = x + (excess / (equation.a + equation.shear_capacity * slope)).max(N::ZERO);
        if !next.any_gt(x) {
            return x;
        }
        x = next;
    }
}

/// Number of random equations for which [`Equation::solve`] differs from the plain Newton's method.
fn others<N: Number + PartialEq>(seed: u64) -> usize {
    let mut random = Random::new(seed);
    let draw = |number: usize| {
        let count = 1 + number % PARTS;
        let seen: [bool; PARTS] = std::array::from_fn(|part| part < count);
        let stress = decades(&mut random, -3.0, 9.0);
        let squares: [f64; PARTS] =
            std::array::from_fn(|_| random.within(0.0, 1.0) * stress * stress);
        let rates: [f64; PARTS] = std::array::from_fn(|_| decades(&mut random, -1.0, 1.0) * 1e9);
        let shear = squares[..count].iter().sum::<f64>().sqrt();
        // The shear stress exceeds the shear capacity by a relative 1e-13 (close to the yield surface) to 1e3 (far outside).
        let room = shear / (1.0 + decades(&mut random, -13.0, 3.0));
        let a = [0.0, decades(&mut random, -2.0, 1.0) * 1e9][number / PARTS % 2];
        let [squares, rates] = [squares, rates].map(|own| own.map(N::from_f64));
        let [a, room] = [a, room].map(N::from_f64);
        let equation = Equation { squares, rates, a, shear_capacity: room, seen: &seen };
        equation.solve().x != newton(&equation)
    };
    (0..200_000).map(draw).filter(|is_other| *is_other).count()
}

/// `Equation::solve` is bitwise equal to the plain Newton's method in double and single precision.
#[test]
fn roots_are_those_of_newtons_method_to_the_bit() {
    assert_eq!(others::<f64>(82), 0);
    assert_eq!(others::<f32>(83), 0);
}
