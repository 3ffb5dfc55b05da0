//! Errata of the eliminated equations in Harris & Grekova (2005): eqs (100)–(126).

use crate::errata::comparison::{Comparison, EXACT_TOLERANCE};
use crate::errata::elimination::Elimination;
use crate::errata::system::{compare_random_flows, for_random_flows, random_complex, random_wave};
use crate::support::{Complex, complex};

/// Eq. (100), the sum of e₅₁ × first and e₅₂ × second momentum row, is printed with the coefficient of ψ in place of
/// the coefficient of p. Reference: the rows summed for an amplitude that satisfies the rotation row.
#[test]
fn eq_100_misprints_the_coefficient_of_pressure() {
    compare_random_flows(5, |random, system, comparison| {
        let e = system.coefficient_matrix(random_wave(random));
        let frequency = random_complex(random);
        let mut z: [Complex; 5] = std::array::from_fn(|_| random_complex(random));
        // Scales the pressure amplitude to the magnitude of the other terms.
        z[3] = z[3] * complex(system.state.density, 0.0);
        z[2] = -((e[4][0] * z[0] + e[4][1] * z[1] + e[4][4] * z[4]) / e[4][2]);
        let rs = Complex::from(system.density()) * frequency;
        let row = |i: usize| (0..5).fold(rs * z[i], |sum, j| sum + e[i][j] * z[j]);
        let truth = e[4][0] * row(0) + e[4][1] * row(1);
        let both = |j: usize| e[4][0] * e[0][j] + e[4][1] * e[1][j];
        let others =
            both(0) * z[0] + both(1) * z[1] - rs * e[4][2] * z[2] + (both(4) - e[4][4] * rs) * z[4];
        let printed_pressure = (e[0][4] * e[4][0] + e[1][4] * e[4][1]) * z[3];
        let size = others.abs() + printed_pressure.abs() + (both(3) * z[3]).abs();
        comparison.add_case(truth, others + printed_pressure, others + both(3) * z[3], size);
    });
}

/// Eqs (101)–(104): f₅₁ is printed with e₁₅ and e₂₅ in place of e₁₄ and e₂₄. Reference: ψ for v = (1, 0), ω = 0 by
/// elimination. The other three coefficients of (104) and eqs (101), (102) are correct.
#[test]
fn eq_104_misprints_f51() {
    compare_random_flows(6, |random, system, comparison| {
        let own = Elimination::new(&system, random_wave(random));
        let frequency = random_complex(random);
        let rs = own.density * frequency;
        let (e, mut size) = (&own.e, 0.0f64);
        for column in 0..2 {
            let mut v = [Complex::default(); 3];
            v[column] = complex(1.0, 0.0);
            let truth = own.eliminate_numerically(frequency, v);
            let numerators = [0, 1].map(|i| {
                own.velocity_numerators[i][column] + own.inertia_numerators[i][column] * rs
            });
            for (numerator, truth) in numerators.into_iter().zip(truth) {
                assert!((numerator - truth).abs() <= EXACT_TOLERANCE * truth.abs());
            }
            size = size.max(truth[1].abs());
        }
        let truth =
            own.eliminate_numerically(frequency, [complex(1.0, 0.0), 0.0.into(), 0.0.into()])[1];
        let velocity = e[3][0] * e[4][1] - e[3][1] * e[4][0];
        let printed = (e[0][4] * e[1][0] - e[1][4] * e[0][0]) * velocity;
        comparison.add_case(truth, printed, own.velocity_numerators[1][0], size);
    });
}

/// Eq. (105): g₄₃ is printed twice, as −g₅₃ and as g₅₃. Reference: p and ψ for v = 0, ω = 1 by elimination.
#[test]
fn eq_105_misprints_g43_as_g53() {
    let (mut first, mut second) = (Comparison::default(), Comparison::default());
    for_random_flows(7, |random, system| {
        let own = Elimination::new(&system, random_wave(random));
        let frequency = random_complex(random);
        let rs = own.density * frequency;
        let e = &own.e;
        let [p, psi] =
            own.eliminate_numerically(frequency, [0.0.into(), 0.0.into(), complex(1.0, 0.0)]);
        let printed = e[4][2] * (e[3][0] * e[0][3] + e[3][1] * e[1][3]);
        first.add_case(p, printed * rs, own.inertia_numerators[0][2] * rs, 0.0);
        second.add_case(p, -(printed * rs), own.inertia_numerators[0][2] * rs, 0.0);
        // The second printed line is a correct formula for g₅₃.
        assert!((psi + printed * rs).abs() <= EXACT_TOLERANCE * psi.abs());
    });
    first.assert_mostly_misprinted();
    second.assert_mostly_misprinted();
}

/// Eq. (107) for hᵢⱼ is printed with columns 5 and 6 in place of columns 4 and 5 (p, ψ) of the 5×5 system. Reference:
/// the reduced momentum rows by elimination at two frequencies. With any column in place of the missing sixth column
/// the printed form is wrong. Eq. (108), iᵢⱼ = 0, holds only with the correction.
#[test]
fn eq_107_misprints_the_columns() {
    let mut comparisons: [Comparison; 6] = Default::default();
    let mut vanishing = Comparison::default();
    for_random_flows(8, |random, system| {
        let own = Elimination::new(&system, random_wave(random));
        for (number, comparison) in comparisons.iter_mut().enumerate() {
            let (row, column) = (number / 3, number % 3);
            // The reduced entry, minus g ρ²ς² on the diagonal, is hᵢⱼ ρς + iᵢⱼ: linear in ρς.
            let [first, second] =
                [random_complex(random), random_complex(random)].map(|frequency| {
                    let rs = own.density * frequency;
                    let entry = own.reduced_entry_numerically(frequency, row, column);
                    let diagonal = if row == column { own.g * rs * rs } else { 0.0.into() };
                    (entry - diagonal, rs)
                });
            let truth = (first.0 - second.0) / (first.1 - second.1);
            let constant = first.0 - truth * first.1;
            let size = first.0.abs().max(second.0.abs()) / first.1.abs().min(second.1.abs());
            let f = if column < 2 {
                own.e[row][3] * own.velocity_numerators[0][column]
                    + own.e[row][4] * own.velocity_numerators[1][column]
            } else {
                0.0.into()
            };
            assert!(constant.abs() <= EXACT_TOLERANCE * size * first.1.abs(), "eq. (108)");
            for sixth in 0..5 {
                let printed = own.reduced_coefficient(row, column, 4, sixth);
                comparison.add_case(
                    truth,
                    printed,
                    own.reduced_coefficient(row, column, 3, 4),
                    0.0,
                );
            }
            if column < 2 {
                let i = own.e[row][column] * own.f;
                let printed = own.e[row][4] * own.velocity_numerators[0][column];
                vanishing.add_case(0.0.into(), i + printed, i + f, i.abs());
            }
        }
    });
    comparisons.into_iter().for_each(Comparison::assert_mostly_misprinted);
    vanishing.assert_mostly_misprinted();
}

/// Eqs (123)–(125) are correct as printed once eqs (105) and (107) are corrected. Eq. (126) is printed with b₄ⱼ, which
/// also has the wrong power of k, in place of e₄ⱼ. Reference: the sums of products of hᵢⱼ.
#[test]
fn eq_126_misprints_e4j() {
    let mut comparisons: [Comparison; 2] = Default::default();
    for_random_flows(9, |random, system| {
        let own = Elimination::new(&system, random_wave(random));
        let e = &own.e;
        let h = |i: usize, j: usize| own.reduced_coefficient(i, j, 3, 4);
        let (c31, c32, c53, c55) = (e[2][0], e[2][1], e[4][2], e[4][4]);
        let stress = e[0][3] * e[1][4] - e[0][4] * e[1][3];
        let bracket = e[3][1] * (e[0][0] * e[1][3] - e[0][3] * e[1][0])
            + e[3][0] * (e[1][1] * e[0][3] - e[1][3] * e[0][1]);
        let equal = |a: Complex, b: Complex, size: f64| (a - b).abs() <= EXACT_TOLERANCE * size;

        assert!(equal(h(0, 0) + h(1, 1), own.f + own.f + c55 * bracket, own.f.abs()), "(123)");
        let products = [h(0, 0) * h(1, 1), h(0, 1) * h(1, 0)];
        let size = products[0].abs() + products[1].abs();
        let printed = own.f * own.f + c55 * bracket * own.f;
        assert!(equal(products[0] - products[1], printed, size), "(124)");
        let products = [c31 * h(0, 2), c32 * h(1, 2)];
        let size = products[0].abs() + products[1].abs();
        let printed = c53 * stress * (c31 * e[3][1] - c32 * e[3][0]);
        assert!(equal(products[0] + products[1], printed, size), "(125)");

        let products = [
            c32 * (h(0, 2) * h(1, 0) - h(0, 0) * h(1, 2)),
            c31 * (h(0, 1) * h(1, 2) - h(0, 2) * h(1, 1)),
        ];
        let size = products[0].abs() + products[1].abs();
        let with = |e41: Complex, e42: Complex| c53 * (c32 * e41 - c31 * e42) * stress * own.f;
        for (axis, comparison) in comparisons.iter_mut().enumerate() {
            let b = &system.b[axis][3];
            let printed = with(b[0].into(), b[1].into());
            comparison.add_case(products[0] + products[1], printed, with(e[3][0], e[3][1]), size);
        }
    });
    comparisons.into_iter().for_each(Comparison::assert_mostly_misprinted);
}
