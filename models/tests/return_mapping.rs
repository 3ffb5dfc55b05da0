//! Bitwise equality of optimised operations of the return mapping with the plain formulas.

use crate::support::{RandomNumbers, draw_log_uniform};
use wellposed_models::common::number::{Number, divide_by_three};
use wellposed_models::yield_set::return_mapping::{ConsistencyEquation, EIGENSPACE_COUNT};

/// `divide_by_three` is bitwise equal to the division by 3 in double and single precision.
#[test]
fn multiplication_by_one_third_is_bitwise_equal_to_division() {
    let mut random = RandomNumbers::new(81);
    let edges = [0.0, 1.0, -3.0, 1e-290, f64::MAX, f64::MIN];
    let near: Vec<f64> = (0..2000).map(|i| f64::from_bits(1.0f64.to_bits() + i)).collect();
    for x in edges.into_iter().chain(near) {
        assert_eq!(divide_by_three(x).to_bits(), (x / 3.0).to_bits(), "{x:e}");
    }
    for _ in 0..1_000_000 {
        let x = random.uniform(-1.0, 1.0) * draw_log_uniform(&mut random, -290.0, 308.0);
        assert_eq!(divide_by_three(x).to_bits(), (x / 3.0).to_bits(), "{x:e}");
        let x = (random.uniform(-1.0, 1.0) * draw_log_uniform(&mut random, -28.0, 38.0)) as f32;
        assert_eq!(divide_by_three(x).to_bits(), (x / 3.0).to_bits(), "{x:e}");
    }
}

/// Plain Newton's method, which evaluates the step by its formula and iterates until the step is zero; returns x.
fn solve_by_plain_newton<N: Number>(equation: &ConsistencyEquation<N>) -> N {
    let mut x = N::ZERO;
    loop {
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in (0..EIGENSPACE_COUNT).filter(|part| equation.active[*part]) {
            let fraction = N::ONE / (N::ONE + x * equation.weighted_stiffnesses[part]);
            let term = equation.squares[part] * fraction * fraction;
            norm = norm + term;
            slope = slope + term * fraction * equation.weighted_stiffnesses[part];
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

/// Number of random equations for which [`ConsistencyEquation::solve`] differs from the plain Newton's method.
fn count_differing_roots<N: Number + PartialEq>(seed: u64) -> usize {
    let mut random = RandomNumbers::new(seed);
    let draw = |number: usize| {
        let count = 1 + number % EIGENSPACE_COUNT;
        let seen: [bool; EIGENSPACE_COUNT] = std::array::from_fn(|part| part < count);
        let stress = draw_log_uniform(&mut random, -3.0, 9.0);
        let squares: [f64; EIGENSPACE_COUNT] =
            std::array::from_fn(|_| random.uniform(0.0, 1.0) * stress * stress);
        let rates: [f64; EIGENSPACE_COUNT] =
            std::array::from_fn(|_| draw_log_uniform(&mut random, -1.0, 1.0) * 1e9);
        let shear = squares[..count].iter().sum::<f64>().sqrt();
        // The equivalent shear stress exceeds the shear capacity by a relative 1e-13 (close to the yield surface) to
        // 1e3 (far outside).
        let shear_capacity = shear / (1.0 + draw_log_uniform(&mut random, -13.0, 3.0));
        let a =
            [0.0, draw_log_uniform(&mut random, -2.0, 1.0) * 1e9][number / EIGENSPACE_COUNT % 2];
        let [squares, rates] = [squares, rates].map(|own| own.map(N::from_f64));
        let [a, shear_capacity] = [a, shear_capacity].map(N::from_f64);
        let equation = ConsistencyEquation {
            squares,
            weighted_stiffnesses: rates,
            a,
            shear_capacity,
            active: &seen,
        };
        equation.solve().x != solve_by_plain_newton(&equation)
    };
    (0..200_000).map(draw).filter(|differs| *differs).count()
}

/// `ConsistencyEquation::solve` is bitwise equal to the plain Newton's method in double and single precision.
#[test]
fn roots_are_bitwise_equal_to_plain_newton_iteration() {
    assert_eq!(count_differing_roots::<f64>(82), 0);
    assert_eq!(count_differing_roots::<f32>(83), 0);
}
