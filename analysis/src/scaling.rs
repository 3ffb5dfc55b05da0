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
    /// Index of the common factor of the entry: 0 for none, else `groups[group − 1]`.
    pub group: usize,
    /// Base-two logarithm of the modulus of the coefficient.
    pub log2_modulus: f64,
}

/// Row, column and group scales that bring the entries near one.
#[derive(Clone, Debug)]
pub(crate) struct EntryScales {
    pub rows: StackList<f64>,
    pub columns: StackList<f64>,
    pub groups: StackList<f64>,
}

/// Number of sweeps of coordinate descent.
const BALANCE_SWEEPS: usize = 6;

/// Minimises the sum over the entries of (log₂ of the modulus + log₂ of the scales of row, column and group)² by sweeps
/// of coordinate descent; the scales returned are rounded to powers of two.
pub(crate) fn balance_entries(
    entries: &[MatrixEntry],
    rows: usize,
    columns: usize,
    groups: usize,
) -> EntryScales {
    let offsets = [0, rows, rows + columns];
    let mut logs: StackList<f64, 32> = smallvec![0.0; rows + columns + groups];
    let mut sums: StackList<(f64, u32), 32> = smallvec![(0.0, 0); logs.len()];
    let slots = |e: &MatrixEntry| {
        [
            Some(offsets[0] + e.row),
            Some(offsets[1] + e.column),
            e.group.checked_sub(1).map(|g| offsets[2] + g),
        ]
    };
    for _ in 0..BALANCE_SWEEPS {
        for kind in 0..3 {
            sums.fill((0.0, 0));
            for entry in entries {
                let slots = slots(entry);
                let Some(own) = slots[kind] else { continue };
                let rest: f64 =
                    slots.iter().flatten().filter(|&&s| s != own).map(|&s| logs[s]).sum();
                sums[own] = (sums[own].0 + entry.log2_modulus + rest, sums[own].1 + 1);
            }
            let end = *offsets.get(kind + 1).unwrap_or(&logs.len());
            for slot in offsets[kind]..end {
                let (sum, terms) = sums[slot];
                logs[slot] = if terms > 0 { -sum / f64::from(terms) } else { 0.0 };
            }
        }
    }
    let mut powers = logs.iter().map(|log| log.round().clamp(-1000.0, 1000.0).cr_exp2());
    EntryScales {
        rows: powers.by_ref().take(rows).collect(),
        columns: powers.by_ref().take(columns).collect(),
        groups: powers.collect(),
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
        self.entries.clear();
        let groups: [(&RoundedMatrix, usize); 4] =
            [(&system.c, 0), (&system.a, 1), (&system.b[0], 2), (&system.b[1], 2)];
        for (matrix, group) in groups {
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
                            group,
                            log2_modulus: x.value.abs().cr_log2(),
                        });
                    }
                }
            }
        }
        let scales =
            balance_entries(&self.entries, system.equations.len(), system.unknowns.len(), 2);
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
        let finite =
            |m: &RoundedMatrix| m.iter().all(|x| x.value.is_finite() && x.bound.is_finite());
        let s = &self.system;
        if [&s.a, &s.b[0], &s.b[1], &s.c].into_iter().all(finite) {
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
        // |entry| = 2^(rᵢ + cⱼ + g): the scales must compensate all three exponents.
        let (r, c, g) = ([10.0, -7.0, 33.0], [4.0, 0.0, -21.0], [0.0, 50.0]);
        let mut entries = Vec::new();
        for (row, r) in r.iter().enumerate() {
            for (column, c) in c.iter().enumerate() {
                for (group, g) in g.iter().enumerate() {
                    entries.push(MatrixEntry { row, column, group, log2_modulus: r + c + g });
                }
            }
        }
        let scales = balance_entries(&entries, 3, 3, 1);
        for e in &entries {
            let factor = if e.group == 0 { 1.0 } else { scales.groups[0] };
            let log =
                e.log2_modulus + (scales.rows[e.row] * scales.columns[e.column] * factor).log2();
            assert!(log.abs() <= 1.5, "{e:?} left at {log}");
        }
    }
}
