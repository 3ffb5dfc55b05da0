//! Elimination of pressure and stress angle by Harris & Grekova (2005), eqs (99)–(110).

use crate::errata::system::IncompressibleFlow;
use crate::support::{Complex, DoubleDouble, Polynomial, complex};

/// Coefficients of the elimination in Harris & Grekova (2005), eqs (103)–(105), with printed errors corrected. The
/// amplitudes p and ψ have the common denominator f + gρς.
#[derive(Clone, Copy)]
pub struct Elimination {
    pub e: [[Complex; 5]; 5],
    pub density: Complex,
    pub f: Complex,
    pub g: Complex,
    /// Coefficients of v₁, v₂ in the numerators of p (row 0) and ψ (row 1).
    pub velocity_numerators: [[Complex; 2]; 2],
    /// Coefficients of ρς v₁, ρς v₂, ρς ω in the numerators of p (row 0) and ψ (row 1).
    pub inertia_numerators: [[Complex; 3]; 2],
}

impl Elimination {
    pub fn new(system: &IncompressibleFlow, wave: [DoubleDouble; 2]) -> Self {
        let e = system.coefficient_matrix(wave);
        let (c53, c55) = (e[4][2], e[4][4]);
        let velocity = e[3][1] * e[4][0] - e[3][0] * e[4][1];
        let [e14, e15, e24, e25] = [e[0][3], e[0][4], e[1][3], e[1][4]];
        let (along_p, along_psi) = (e[3][0] * e14 + e[3][1] * e24, e[3][0] * e15 + e[3][1] * e25);
        Self {
            e,
            density: system.density().into(),
            f: (e14 * e25 - e15 * e24) * velocity,
            g: c55 * along_p,
            velocity_numerators: [
                [
                    (e[1][0] * e15 - e[0][0] * e25) * velocity,
                    (e15 * e[1][1] - e25 * e[0][1]) * velocity,
                ],
                [
                    -((e14 * e[1][0] - e24 * e[0][0]) * velocity),
                    -((e14 * e[1][1] - e24 * e[0][1]) * velocity),
                ],
            ],
            inertia_numerators: [
                [
                    -(c55 * (e[0][0] * e[3][0] + e[3][1] * e[1][0])),
                    -(c55 * (e[3][0] * e[0][1] + e[3][1] * e[1][1])),
                    c53 * along_psi,
                ],
                [Complex::default(), Complex::default(), -(c53 * along_p)],
            ],
        }
    }

    /// Computes p and ψ, multiplied by f + gρς, from v₁, v₂, ω by Cramer's rule from two combinations of rows: the
    /// momentum rows weighted by the continuity row (99), and weighted by the rotation row, which also eliminates ρς v
    /// (100). The combinations are computed from the rows, not from the printed equations.
    pub fn eliminate_numerically(&self, frequency: Complex, v: [Complex; 3]) -> [Complex; 2] {
        let e = &self.e;
        let rs = self.density * frequency;
        let along = |row: usize, column: usize| e[row][0] * e[0][column] + e[row][1] * e[1][column];
        let rotation = |column: usize| along(4, column) - rs * e[4][column];
        let matrix = [[along(3, 3), along(3, 4)], [rotation(3), rotation(4)]];
        let right = [
            -(along(3, 0) * v[0] + along(3, 1) * v[1]),
            -(along(4, 0) * v[0] + along(4, 1) * v[1] + rotation(2) * v[2]),
        ];
        let determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
        let common = self.f + self.g * rs;
        [
            (right[0] * matrix[1][1] - right[1] * matrix[0][1]) / determinant * common,
            (right[1] * matrix[0][0] - right[0] * matrix[1][0]) / determinant * common,
        ]
    }

    /// Entry (`row`, `column`) of the momentum rows after the elimination, multiplied by f + gρς; columns v₁, v₂, ω.
    pub fn reduced_entry_numerically(
        &self,
        frequency: Complex,
        row: usize,
        column: usize,
    ) -> Complex {
        let mut v = [Complex::default(); 3];
        v[column] = complex(1.0, 0.0);
        let [p, psi] = self.eliminate_numerically(frequency, v);
        let rs = self.density * frequency;
        let mut own = self.e[row][column];
        if row == column {
            own = own + rs;
        }
        own * (self.f + self.g * rs) + self.e[row][3] * p + self.e[row][4] * psi
    }

    /// Coefficient hᵢⱼ of eq. (107), i = `row`, j = `column`, with the columns `p` and `psi` of e (all counted from 0).
    pub fn reduced_coefficient(&self, row: usize, column: usize, p: usize, psi: usize) -> Complex {
        let mut h = self.e[row][p] * self.inertia_numerators[0][column]
            + self.e[row][psi] * self.inertia_numerators[1][column];
        if column < 2 {
            h = h + self.e[row][column] * self.g;
            if row == column {
                h = h + self.f;
            }
        }
        h
    }

    /// Matrix F of eq. (110), whose entries are polynomials in ς.
    pub fn reduced_matrix(&self, inertia: DoubleDouble) -> Vec<Vec<Polynomial>> {
        let rho = self.density;
        let mut matrix: Vec<Vec<Polynomial>> = (0..2)
            .map(|i| {
                (0..3)
                    .map(|j| {
                        let mut entry =
                            vec![Complex::default(), self.reduced_coefficient(i, j, 3, 4) * rho];
                        if i == j {
                            entry.push(self.g * rho * rho);
                        }
                        entry
                    })
                    .collect()
            })
            .collect();
        matrix.push(vec![
            vec![self.e[2][0]],
            vec![self.e[2][1]],
            vec![self.e[2][2], rho * inertia.into()],
        ]);
        matrix
    }
}
