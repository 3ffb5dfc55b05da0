//! Systems built by hand, entry by entry.

use models::common::system::Unknown;
use models::{LinearisedSystem, Rounded};

const EQUATION_NAMES: [&str; 8] = ["1", "2", "3", "4", "5", "6", "7", "8"];
const UNKNOWNS: [Unknown; 8] = {
    let mut list = [Unknown { name: "", family: "a" }; 8];
    let mut n = 0;
    while n < 8 {
        list[n].name = EQUATION_NAMES[n];
        n += 1;
    }
    list
};

/// Operator that acts on an unknown; an entry multiplies the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DerivativeOperator {
    /// ∂ₜ: derivative with respect to time.
    TimeDerivative,
    /// ∂₁: derivative along x₁.
    DerivativeX1,
    /// ∂₂: derivative along x₂.
    DerivativeX2,
    /// 1: the unknown itself.
    Identity,
}
pub use DerivativeOperator::{
    DerivativeX1 as X, DerivativeX2 as Y, Identity as C, TimeDerivative as T,
};

/// A system with `rows` equations for `columns` unknowns and exact coefficients.
pub fn build_system(
    rows: usize,
    columns: usize,
    entries: &[(usize, usize, DerivativeOperator, f64)],
) -> LinearisedSystem<2> {
    let mut system = LinearisedSystem::default();
    system.reset(&UNKNOWNS[..columns], &EQUATION_NAMES[..rows], [0.0; 2]);
    for &(row, column, part, value) in entries {
        let at = (row, column);
        let slot = match part {
            T => &mut system.a[at],
            X => &mut system.b[0][at],
            Y => &mut system.b[1][at],
            C => &mut system.c[at],
        };
        *slot = Rounded::from_exact(slot.value + value);
    }
    system
}
