//! Equilibration of a linearised system: units in which its coefficients are of comparable size.
//!
//! Rows, columns, the unit of time and the unit of length are scaled by powers of two, so no bit
//! of any coefficient is lost. The scales minimise the sum of squares of the logarithms of all
//! non-zero coefficients, by a few sweeps of coordinate descent.

use crate::AnalysisError;
use crate::list::StackList;
use models::LinearisedSystem;
use models::common::elementary::Elementary;
use models::common::system::RoundedMatrix;
use smallvec::smallvec;

/// A system in scaled units: ς = `rate_unit` ς̂, k = `wave_number_unit` k̂.
#[derive(Clone, Debug, Default)]
pub struct ScaledSystem {
    /// The scaled coefficients. `velocity` stays in m/s.
    pub system: LinearisedSystem<2>,
    /// Unit of ς, 1/s.
    pub rate_unit: f64,
    /// Unit of k, 1/m.
    pub wave_number_unit: f64,
    entries: Vec<MatrixEntry>,
}

/// A non-zero coefficient, for [`balance_entries`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MatrixEntry {
    pub row: usize,
    pub column: usize,
    /// Powers of the common factors of the entry, the scales `groups`.
    pub group_powers: [u8; 2],
    /// Base-two logarithm of the modulus of the coefficient.
    pub log2_modulus: f64,
}

/// Row, column and group scales that bring the entries near one.
#[derive(Clone, Debug)]
pub(crate) struct EntryScales {
    pub rows: StackList<f64>,
    pub columns: StackList<f64>,
    pub groups: [f64; 2],
}

/// Number of sweeps of coordinate descent.
const BALANCE_SWEEPS: usize = 6;

/// Minimises the sum over the entries of (log₂ of the modulus + log₂ of the scales of row, column and groups, each to its
/// power)² by sweeps of coordinate descent; the scales returned are rounded to powers of two.
pub(crate) fn balance_entries(entries: &[MatrixEntry], rows: usize, columns: usize) -> EntryScales {
    let mut row_logs: StackList<f64, 16> = smallvec![0.0; rows];
    let mut column_logs: StackList<f64, 16> = smallvec![0.0; columns];
    let mut group_logs = [0.0; 2];
    let mut sums: StackList<(f64, u32), 16> = smallvec![(0.0, 0); rows.max(columns)];
    let minimum = |(sum, squares): (f64, u32)| {
        if squares > 0 { -sum / f64::from(squares) } else { 0.0 }
    };
    for _ in 0..BALANCE_SWEEPS {
        let add = |sums: &mut [(f64, u32)], slot: usize, terms: [f64; 2]| {
            let (sum, count) = sums[slot];
            sums[slot] = (sum + terms[0] + terms[1], count + 1);
        };
        sums.fill((0.0, 0));
        for e in entries {
            add(&mut sums, e.row, [e.log2_modulus, column_logs[e.column] + e.factor(group_logs)]);
        }
        row_logs.iter_mut().zip(&sums).for_each(|(log, sum)| *log = minimum(*sum));
        sums.fill((0.0, 0));
        for e in entries {
            add(&mut sums, e.column, [e.log2_modulus, row_logs[e.row] + e.factor(group_logs)]);
        }
        column_logs.iter_mut().zip(&sums).for_each(|(log, sum)| *log = minimum(*sum));
        for group in 0..2 {
            let mut others = group_logs;
            others[group] = 0.0;
            let (mut sum, mut squares) = (0.0, 0);
            for e in entries.iter().filter(|e| e.group_powers[group] != 0) {
                let (power, rest) =
                    (e.group_powers[group], row_logs[e.row] + column_logs[e.column]);
                let weight = f64::from(power);
                sum = sum + weight * e.log2_modulus + weight * (rest + e.factor(others));
                squares += u32::from(power) * u32::from(power);
            }
            group_logs[group] = minimum((sum, squares));
        }
    }
    let power = |log: &f64| log.round().clamp(-1000.0, 1000.0).cr_exp2();
    EntryScales {
        rows: row_logs.iter().map(power).collect(),
        columns: column_logs.iter().map(power).collect(),
        groups: group_logs.each_ref().map(power),
    }
}

impl MatrixEntry {
    /// Logarithm of the common factor of the entry.
    fn factor(&self, group_logs: [f64; 2]) -> f64 {
        match self.group_powers {
            [0, 0] => 0.0,
            [1, 0] => group_logs[0],
            [0, 1] => group_logs[1],
            [a, b] => f64::from(a) * group_logs[0] + f64::from(b) * group_logs[1],
        }
    }
}

impl ScaledSystem {
    /// Scales `system` into `self`.
    ///
    /// # Errors
    /// [`AnalysisError::NotFinite`] if a coefficient is not finite, before or after scaling.
    pub fn update(&mut self, system: &LinearisedSystem<2>) -> Result<(), AnalysisError> {
        let own = &mut self.system;
        own.reset(system.unknowns, system.equations, system.velocity);
        own.a.copy_from(&system.a);
        own.c.copy_from(&system.c);
        for (own, given) in own.b.iter_mut().zip(&system.b) {
            own.copy_from(given);
        }
        own.higher_terms.extend_from_slice(&system.higher_terms);
        self.entries.clear();
        let groups: [(&RoundedMatrix, [u8; 2]); 4] = [
            (&system.c, [0, 0]),
            (&system.a, [1, 0]),
            (&system.b[0], [0, 1]),
            (&system.b[1], [0, 1]),
        ];
        for (matrix, group_powers) in groups {
            for column in 0..matrix.ncols() {
                for row in 0..matrix.nrows() {
                    let x = matrix[(row, column)];
                    if !(x.value.is_finite() && x.bound.is_finite()) {
                        return Err(AnalysisError::NotFinite { equation: system.equations[row] });
                    }
                    // Skip coefficients that are zero within rounding.
                    if x.value.abs() > x.bound {
                        self.entries.push(MatrixEntry {
                            row,
                            column,
                            group_powers,
                            log2_modulus: x.value.abs().cr_log2(),
                        });
                    }
                }
            }
        }
        for term in &system.higher_terms {
            let x = term.coefficient;
            if !(x.value.is_finite() && x.bound.is_finite()) {
                return Err(AnalysisError::NotFinite { equation: system.equations[term.row] });
            }
            if x.value.abs() > x.bound {
                self.entries.push(MatrixEntry {
                    row: term.row,
                    column: term.column,
                    group_powers: [term.time_power, term.wave_number_power()],
                    log2_modulus: x.value.abs().cr_log2(),
                });
            }
        }
        let scales = balance_entries(&self.entries, system.equations.len(), system.unknowns.len());
        (self.rate_unit, self.wave_number_unit) = (scales.groups[0], scales.groups[1]);
        let apply = |matrix: &mut RoundedMatrix, factor: f64| {
            for column in 0..matrix.ncols() {
                for row in 0..matrix.nrows() {
                    let scale = scales.rows[row] * scales.columns[column] * factor;
                    let x = &mut matrix[(row, column)];
                    (x.value, x.bound) = (x.value * scale, x.bound * scale);
                }
            }
        };
        apply(&mut self.system.a, self.rate_unit);
        apply(&mut self.system.c, 1.0);
        for b in &mut self.system.b {
            apply(b, self.wave_number_unit);
        }
        for term in &mut self.system.higher_terms {
            let units = self.rate_unit.powi(term.time_power.into())
                * self.wave_number_unit.powi(term.wave_number_power().into());
            let scale = scales.rows[term.row] * scales.columns[term.column] * units;
            let x = &mut term.coefficient;
            (x.value, x.bound) = (x.value * scale, x.bound * scale);
        }
        let finite =
            |m: &RoundedMatrix| m.iter().all(|x| x.value.is_finite() && x.bound.is_finite());
        let s = &self.system;
        let higher = s.higher_terms.iter().map(|term| term.coefficient);
        let higher_are_finite =
            higher.into_iter().all(|x| x.value.is_finite() && x.bound.is_finite());
        if higher_are_finite && [&s.a, &s.b[0], &s.b[1], &s.c].into_iter().all(finite) {
            Ok(())
        } else {
            Err(AnalysisError::NotFinite { equation: system.equations[0] })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_that_are_products_of_scales_are_balanced_to_ones() {
        // |entry| = 2^(rᵢ + cⱼ + a g₁ + b g₂): the scales must compensate all exponents.
        let (r, c, g) = ([10.0, -7.0, 33.0], [4.0, 0.0, -21.0], [50.0, -13.0]);
        let powers = [[0, 0], [1, 0], [0, 1], [0, 2], [2, 1], [1, 4]];
        let mut entries = Vec::new();
        for (row, r) in r.iter().enumerate() {
            for (column, c) in c.iter().enumerate() {
                for group_powers in powers {
                    let [a, b] = group_powers.map(f64::from);
                    let log2_modulus = r + c + a * g[0] + b * g[1];
                    entries.push(MatrixEntry { row, column, group_powers, log2_modulus });
                }
            }
        }
        let scales = balance_entries(&entries, 3, 3);
        for e in &entries {
            let [a, b] = e.group_powers.map(i32::from);
            let factor = scales.groups[0].powi(a) * scales.groups[1].powi(b);
            let log =
                e.log2_modulus + (scales.rows[e.row] * scales.columns[e.column] * factor).log2();
            assert!(log.abs() <= 4.0, "{e:?} left at {log}");
        }
    }
}
