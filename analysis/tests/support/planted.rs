//! Systems built by hand, entry by entry.

use models::common::system::Unknown;
use models::{LinearisedSystem, Rounded};

const NAMES: [&str; 8] = ["1", "2", "3", "4", "5", "6", "7", "8"];
const UNKNOWNS: [Unknown; 8] = {
    let mut list = [Unknown { name: "", family: "a" }; 8];
    let mut n = 0;
    while n < 8 {
        list[n].name = NAMES[n];
        n += 1;
    }
    list
};

/// Derivative or unknown multiplied by an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// ∂ₜ
    T,
    /// ∂₁
    X,
    /// ∂₂
    Y,
    /// 1
    C,
}
pub use Part::{C, T, X, Y};

/// A system with `rows` equations for `columns` unknowns and exact coefficients.
pub fn system(
    rows: usize,
    columns: usize,
    entries: &[(usize, usize, Part, f64)],
) -> LinearisedSystem<2> {
    let mut system = LinearisedSystem::default();
    system.reset(&UNKNOWNS[..columns], &NAMES[..rows], [0.0; 2]);
    for &(row, column, part, value) in entries {
        let at = (row, column);
        let slot = match part {
            T => &mut system.a[at],
            X => &mut system.b[0][at],
            Y => &mut system.b[1][at],
            C => &mut system.c[at],
        };
        *slot = Rounded::exact(slot.value + value);
    }
    system
}
