//! Growth that is unbounded at finite wave numbers: a root passes through infinity where the coefficient of the highest
//! power of ς vanishes.

use crate::form::{BinaryForm, FormZero};
use crate::layers::expand_along_direction;
use crate::list::StackList;
use crate::polynomial::DispersionTerm;
use crate::puiseux::{self, Monomial};
use crate::roots;
use crate::rounded_complex::{RoundedComplex, imaginary_power};
use models::Rounded;
use models::common::elementary::Modulus;
use num_complex::Complex64;
use std::f64::consts::PI;

/// Large wave number, in scaled units, at which generic properties are tested.
const GENERIC_WAVE_NUMBER: f64 = 1.37e3;

/// Searches for a direction in which the coefficient of the highest power of ς vanishes at a finite wave number k while
/// a root with positive real part passes through infinity; returns the limit of this direction as k → ∞, and whether
/// the growth is certain. `None` if there is no such direction, or if a term of the highest power of ς is doubtful.
pub(crate) fn find_unbounded_direction(
    certain: &[DispersionTerm],
    doubtful: &[&DispersionTerm],
) -> Option<(f64, bool)> {
    let highest = certain.iter().map(|t| t.time_power).max()?;
    if doubtful.iter().any(|t| t.time_power == highest) {
        return None;
    }
    let tops: StackList<&DispersionTerm> =
        certain.iter().filter(|t| t.time_power == highest).collect();
    let zeros = match tops[..] {
        [only] => only.form.zeros(),
        _ => {
            // Real and imaginary part of the coefficient at the wave number `GENERIC_WAVE_NUMBER`, each as a form of a
            // single degree.
            let part = |parity: usize| {
                let own = || tops.iter().filter(move |t| t.form.degree() % 2 == parity);
                let degree = own().map(|t| t.form.degree()).max()?;
                let mut sum = BinaryForm::new_zero(degree);
                for term in own() {
                    let j = term.form.degree();
                    let sign = if (j / 2).is_multiple_of(2) { 1.0 } else { -1.0 };
                    sum.add_scaled(
                        &term.form,
                        Rounded::from_exact(sign * GENERIC_WAVE_NUMBER.powi(j as i32)),
                    );
                }
                Some(sum)
            };
            match (part(0), part(1)) {
                (Some(one), None) | (None, Some(one)) => one.zeros(),
                (Some(even), Some(odd)) => {
                    let others = odd.zeros();
                    let shared = |z: &FormZero| {
                        others.iter().any(|o| {
                            angular_distance(o.angle, z.angle) <= 2.0 * (o.bound + z.bound)
                        })
                    };
                    even.zeros().into_iter().filter(shared).collect()
                }
                (None, None) => StackList::new(),
            }
        }
    };
    let mut doubt = None;
    for zero in zeros {
        if !has_growing_root_at_infinity(certain, highest, &zero) {
            continue;
        }
        // Limit of the direction as k → ∞.
        let direction = tops
            .iter()
            .max_by_key(|t| t.form.degree())
            .into_iter()
            .flat_map(|t| t.form.zeros())
            .map(|z| z.angle)
            .min_by(|a, b| {
                angular_distance(*a, zero.angle).total_cmp(&angular_distance(*b, zero.angle))
            })
            .unwrap_or(zero.angle);
        let exact = tops.iter().all(|t| t.form.is_zero_on_axis(zero.angle));
        if zero.has_sign_change || exact {
            return Some((direction, true));
        }
        doubt = Some((direction, false));
    }
    doubt
}

/// Whether, at a generic wave number, roots ς with positive real part tend to infinity as the wave vector approaches
/// the direction `zero`.
fn has_growing_root_at_infinity(
    certain: &[DispersionTerm],
    highest: usize,
    zero: &FormZero,
) -> bool {
    let axis = zero.axis();
    [1.0, -1.0].into_iter().any(|side: f64| {
        let mut terms = StackList::new();
        for term in certain {
            let degree = term.form.degree();
            for (l, f) in
                expand_along_direction(&term.form, axis, zero.bound).into_iter().enumerate()
            {
                if l == 0 && term.time_power == highest {
                    continue;
                }
                let size = GENERIC_WAVE_NUMBER.powi((degree - l) as i32) * side.powi(l as i32);
                let value =
                    RoundedComplex::from_i_power(f * Rounded::from_exact(size), degree as i64);
                terms.push(Monomial { x_power: term.time_power, k_power: -(l as i64), value });
            }
        }
        puiseux::combine_like_terms(&mut terms);
        puiseux::asymptotic_growth(&terms, 1, None).growth.is_some()
    })
}

/// Directions, rad, in which [`find_pole`] searches equations of higher order in two dimensions.
pub(crate) const SAMPLED_DIRECTIONS: [f64; 24] = {
    let mut directions = [0.0; 24];
    let mut index = 0;
    while index < 24 {
        directions[index] = index as f64 * PI / 24.0;
        index += 1;
    }
    directions
};

/// Searches `directions` for one in which the coefficient of the highest power of ς has a zero at a finite wave number
/// k > 0, while the next one does not vanish and the root that passes through infinity grows on one side.
pub(crate) fn find_pole(certain: &[DispersionTerm], directions: &[f64]) -> Option<f64> {
    let highest = certain.iter().map(|t| t.time_power).max()?;
    if highest == 0 || certain.iter().filter(|t| t.time_power == highest).count() < 2 {
        return None;
    }
    directions.iter().copied().find(|&direction| {
        // Coefficient of ςⁿ at k: Σ F (ik)^j.
        let coefficient = |power: usize, k: f64| -> Complex64 {
            let own = certain.iter().filter(|t| t.time_power == power);
            own.map(|t| {
                let degree = t.form.degree();
                let size = t.form.evaluate_at_angle(direction).value * k.powi(degree as i32);
                imaginary_power(degree as i64) * size
            })
            .sum()
        };
        let tops = certain.iter().filter(|t| t.time_power == highest);
        let lowest = tops.clone().map(|t| t.form.degree()).min().unwrap_or(0);
        // Zeros of one polynomial in k with complex coefficients, divided by its lowest power.
        let mut polynomial: StackList<Complex64> = StackList::new();
        for term in tops {
            let degree = term.form.degree() - lowest;
            polynomial.resize(polynomial.len().max(degree + 1), Complex64::ZERO);
            let value = term.form.evaluate_at_angle(direction).value;
            polynomial[degree] += imaginary_power(term.form.degree() as i64) * value;
        }
        while polynomial.last().is_some_and(|c| c.modulus() == 0.0) {
            polynomial.pop();
        }
        let is_real = |k: &Complex64| k.re > 0.0 && k.im.abs() <= 1e-9 * k.re;
        roots::solve(&polynomial).into_iter().filter(is_real).any(|k| {
            [1e-6, -1e-6].into_iter().any(|offset| {
                let beside = k.re * (1.0 + offset);
                let root = -coefficient(highest - 1, beside) / coefficient(highest, beside);
                root.re > 1e-3 * root.modulus() && root.re > 0.0
            })
        })
    })
}

/// Angle between two directions modulo π, rad.
pub(crate) fn angular_distance(a: f64, b: f64) -> f64 {
    let gap = (a - b).rem_euclid(PI);
    gap.min(PI - gap)
}
