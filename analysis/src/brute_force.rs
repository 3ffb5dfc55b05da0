//! Order of growth of short waves by brute force: roots at large wave numbers beside a direction.

use crate::pencil::Pencil;
use models::common::elementary::Elementary;

/// Wave numbers, in the scaled unit of the system, ascending.
const WAVE_NUMBERS: [f64; 3] = [1e4, 1e6, 1e8];

/// Number of offsets k^(−s) from the direction on each side, rad, 0 < s ≤ [`MAX_OFFSET_ORDER`].
const OFFSET_COUNT: usize = 32;

/// Largest order s of the offsets.
const MAX_OFFSET_ORDER: f64 = 1.6;

/// Least order that is taken as growth: bounded growth rates may still rise slowly.
pub(crate) const LEAST_ORDER: f64 = 0.2;

/// Order in k, to k = 1e8 in the scaled unit, of the fastest growth beside the direction `angle` (rad) that rounding
/// cannot explain; 0 where no growth rate rises over all wave numbers.
pub(crate) fn sample_growth_order(pencil: &Pencil, angle: f64) -> f64 {
    let unit = pencil.polynomial.wave_number_unit;
    let mut largest = 0.0f64;
    for step in 1..=OFFSET_COUNT {
        let order = MAX_OFFSET_ORDER * step as f64 / OFFSET_COUNT as f64;
        for side in [1.0, -1.0] {
            let rate = |k: f64| {
                let direction = angle + side * (-order * k.cr_ln()).cr_exp();
                pencil.polynomial.along(direction).certain_growth_rate(k * unit)
            };
            // Most directions have no growth at the largest wave number: the others are not needed.
            let mut above = rate(WAVE_NUMBERS[2]);
            let mut least = f64::INFINITY;
            for index in [1, 0] {
                if least <= largest || above == 0.0 {
                    break;
                }
                let below = rate(WAVE_NUMBERS[index]);
                let ratio = WAVE_NUMBERS[index + 1] / WAVE_NUMBERS[index];
                let found = if below > 0.0 { (above / below).cr_ln() / ratio.cr_ln() } else { 0.0 };
                least = least.min(found);
                above = below;
            }
            if least.is_finite() && above > 0.0 {
                largest = largest.max(least);
            }
        }
    }
    if largest < LEAST_ORDER { 0.0 } else { largest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::growth::{self, Verdict};
    use models::common::system::{HigherTerm, Unknown};
    use models::{LinearisedSystem, Rounded};
    use std::f64::consts::FRAC_PI_2;

    const UNKNOWNS: [Unknown; 1] = [Unknown { name: "u", family: "" }];

    /// Pencil of Σ value ς^a κ₁^b κ₂^c over the terms ([a, b, c], value), of second order in all.
    fn build_pencil(terms: &[([u8; 3], f64)]) -> Pencil {
        let mut system = LinearisedSystem::default();
        system.reset(&UNKNOWNS, &["equation"], [0.0; 2]);
        for &([time_power, b, c], value) in terms {
            let coefficient = Rounded::from_rounded(value);
            match [time_power, b, c] {
                [0, 0, 0] => system.c[(0, 0)] = coefficient,
                [1, 0, 0] => system.a[(0, 0)] = coefficient,
                [0, 1, 0] => system.b[0][(0, 0)] = coefficient,
                [0, 0, 1] => system.b[1][(0, 0)] = coefficient,
                _ => system.higher_terms.push(HigherTerm {
                    row: 0,
                    column: 0,
                    time_power,
                    space_powers: [b, c],
                    coefficient,
                }),
            }
        }
        let mut pencil = Pencil::default();
        pencil.update(&system).expect("finite");
        pencil
    }

    /// ς² + k₁² = i k₂: order ½ along x₂ alone, with bounded growth elsewhere.
    #[test]
    fn growth_in_a_layer_is_found() {
        let pencil = build_pencil(&[([2, 0, 0], 1.0), ([0, 2, 0], -1.3), ([0, 0, 1], -0.7)]);
        let Verdict::IllPosed { growth: Some(growth), .. } = growth::assess(&pencil).verdict else {
            panic!("order 1/2")
        };
        assert_eq!(growth.order.to_f64(), 0.5);
        let found = sample_growth_order(&pencil, FRAC_PI_2);
        assert!((found - 0.5).abs() < 0.02, "{found}");
    }

    /// ς² = κ₁² + 0.3ς: waves of one speed that vanishes along x₂, with a bounded growth rate.
    #[test]
    fn bounded_growth_has_order_zero() {
        let pencil = build_pencil(&[([2, 0, 0], 1.0), ([0, 2, 0], -1.3), ([1, 0, 0], -0.3)]);
        assert_eq!(growth::assess(&pencil).verdict, Verdict::WellPosed);
        assert_eq!(sample_growth_order(&pencil, FRAC_PI_2), 0.0);
    }

    /// (ς² − κ₁²)²: both roots are double, and rounding splits them by 1e-8 of their size.
    #[test]
    fn rounding_of_double_roots_is_no_growth() {
        let terms = [([2, 0, 0], 1.0), ([0, 2, 0], -0.1), ([0, 0, 2], -0.7)];
        let mut square = Vec::new();
        for (one, a) in terms {
            for (other, b) in terms {
                square.push((std::array::from_fn(|i| one[i] + other[i]), a * b));
            }
        }
        let pencil = build_pencil(&square);
        for angle in [0.0, 0.4, FRAC_PI_2] {
            assert_eq!(sample_growth_order(&pencil, angle), 0.0, "{angle}");
        }
    }
}
