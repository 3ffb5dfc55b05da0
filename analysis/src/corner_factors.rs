//! Factorisation of the corner coefficients of the Newton polygon.
//!
//! Let ς = O(k^m), with m between the slopes of the two edges that meet in a corner. Every nonzero entry of ςA + κ₁B¹ +
//! κ₂B² + C then has one leading term. A transversal is a choice of one entry per row and column; its order in k is the
//! sum of the orders of its entries. The corner coefficient is the determinant of the leading terms of those entries
//! that belong to a transversal of maximal order. These entries form blocks, and the determinant is the product of the
//! block determinants. A granular flow has a block of the stresses and a block of the velocities.

use crate::form::BinaryForm;
use crate::list::StackList;
use crate::polynomial;
use crate::scaling::ScaledSystem;
use models::Rounded;
use models::common::system::RoundedMatrix;
use smallvec::smallvec;

/// Factors of the corner coefficient for ς = O(k^m), m = `slope`\[0\]/`slope`\[1\]; empty if the pattern has one block
/// only or no transversal, if the determinant of a block is not a single term, or for equations of higher order.
pub(crate) fn factor_corner_coefficient(
    scaled: &ScaledSystem,
    slope: [i64; 2],
) -> StackList<BinaryForm, 4> {
    let system = &scaled.system;
    let n = system.equations.len();
    let [time, space] = slope;
    if !system.higher_terms.is_empty() {
        return StackList::new();
    }
    // Order in k of the leading term of an entry, times the denominator of `slope`; `None` if the entry is zero.
    let zero = Rounded::ZERO;
    let order = |i: usize, j: usize| -> Option<i64> {
        let at = (i, j);
        let present = |matrix: &RoundedMatrix| !matrix[at].is_structural_zero();
        let wave = present(&system.b[0]) || present(&system.b[1]);
        let own = [(present(&system.a), time), (wave, space), (present(&system.c), 0)];
        own.into_iter().filter(|(present, _)| *present).map(|(_, order)| order).max()
    };
    // Coefficients of ς, κ₁, κ₂ and 1 of the leading term; of terms of equal order, the last.
    let leading = |i: usize, j: usize, order: i64| -> [Rounded; 4] {
        let at = (i, j);
        let [a, b1, b2, c] = [system.a[at], system.b[0][at], system.b[1][at], system.c[at]];
        if order == 0 && !c.is_structural_zero() {
            [zero, zero, zero, c]
        } else if order == space && !(b1.is_structural_zero() && b2.is_structural_zero()) {
            [zero, b1, b2, zero]
        } else {
            [a, zero, zero, zero]
        }
    };
    let orders: StackList<Option<i64>, 64> =
        (0..n * n).map(|index| order(index / n, index % n)).collect();

    // `first`: by bit mask of a set of columns, the largest order of a transversal of these columns and the first rows.
    // `last`: the largest order of a transversal of the remaining columns and rows.
    const NO_TRANSVERSAL: i64 = i64::MIN / 4;
    let mut first: StackList<i64, 64> = smallvec![NO_TRANSVERSAL; 1 << n];
    let mut last = first.clone();
    (first[0], last[(1 << n) - 1]) = (0, 0);
    for set in 0..1usize << n {
        let row = set.count_ones() as usize;
        for column in (0..n).filter(|c| set >> c & 1 == 0) {
            if let Some(order) = orders[row * n + column] {
                let with = set | 1 << column;
                first[with] = first[with].max(first[set] + order);
            }
        }
    }
    for set in (0..(1usize << n) - 1).rev() {
        let row = set.count_ones() as usize;
        for column in (0..n).filter(|c| set >> c & 1 == 0) {
            if let Some(order) = orders[row * n + column] {
                last[set] = last[set].max(last[set | 1 << column] + order);
            }
        }
    }
    let greatest = last[0];
    if greatest < 0 {
        return StackList::new();
    }

    // Entries on transversals of the largest order connect rows and columns into blocks.
    let mut block: StackList<usize, 32> = (0..2 * n).collect();
    let mut takes_part: StackList<bool, 64> = smallvec![false; n * n];
    for set in 0..(1usize << n) - 1 {
        let row = set.count_ones() as usize;
        for column in (0..n).filter(|c| set >> c & 1 == 0) {
            let Some(order) = orders[row * n + column] else { continue };
            if first[set] + order + last[set | 1 << column] == greatest {
                takes_part[row * n + column] = true;
                let (old, new) = (block[n + column], block[row]);
                block.iter_mut().filter(|b| **b == old).for_each(|b| *b = new);
            }
        }
    }
    let mut names = StackList::<usize>::from_slice(&block[..n]);
    names.sort_unstable();
    names.dedup();
    if names.len() < 2 {
        return StackList::new();
    }
    let factor = |name: usize| {
        let rows: StackList<usize> = (0..n).filter(|&i| block[i] == name).collect();
        let columns: StackList<usize> = (0..n).filter(|&j| block[n + j] == name).collect();
        polynomial::block_determinant(rows.len(), true, |i, j| {
            let (row, column) = (rows[i], columns[j]);
            match orders[row * n + column] {
                Some(order) if takes_part[row * n + column] => leading(row, column, order),
                _ => [Rounded::ZERO; 4],
            }
        })
    };
    names.into_iter().map(factor).collect::<Option<_>>().unwrap_or_default()
}
