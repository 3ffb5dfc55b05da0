//! Factorisation of the corner coefficients of the Newton polygon.
//!
//! Let ς = O(k^m), with m between the slopes of the two edges that meet in a corner. Every nonzero entry of ςA + κ₁B¹ +
//! κ₂B² + C then has one leading term. A transversal is a choice of one entry per row and column; its order in k is the
//! sum of the orders of its entries. The corner coefficient is the determinant of the leading terms of those entries
//! that belong to a transversal of maximal order. These entries form blocks, and the determinant is the product of the
//! block determinants. A granular flow has a block of the stresses and a block of the velocities.

use crate::form::BinaryForm;
use crate::list::{StackList, list};
use crate::polynomial;
use crate::scaling::ScaledSystem;
use models::Rounded;
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
    // Returns the leading term of an entry: its order in k times the denominator of `slope`, and its coefficients of ς,
    // κ₁, κ₂ and 1.
    let leading = |i: usize, j: usize| -> Option<(i64, [Rounded; 4])> {
        let at = (i, j);
        let (a, b, c) = (system.a[at], [system.b[0][at], system.b[1][at]], system.c[at]);
        let zero = Rounded::ZERO;
        let wave = !(b[0].is_structural_zero() && b[1].is_structural_zero());
        [
            (!a.is_structural_zero(), time, [a, zero, zero, zero]),
            (wave, space, [zero, b[0], b[1], zero]),
            (!c.is_structural_zero(), 0, [zero, zero, zero, c]),
        ]
        .into_iter()
        .filter(|(present, _, _)| *present)
        .max_by_key(|(_, order, _)| *order)
        .map(|(_, order, part)| (order, part))
    };
    let entries: StackList<StackList<_, 8>, 8> =
        (0..n).map(|i| (0..n).map(|j| leading(i, j)).collect()).collect();

    // `first`: by bit mask of a set of columns, the largest order of a transversal of these columns and the first rows.
    // `last`: the largest order of a transversal of the remaining columns and rows.
    const NO_TRANSVERSAL: i64 = i64::MIN / 4;
    let mut first: StackList<i64, 64> = smallvec![NO_TRANSVERSAL; 1 << n];
    let mut last = first.clone();
    (first[0], last[(1 << n) - 1]) = (0, 0);
    for set in 0..1usize << n {
        let row = set.count_ones() as usize;
        for column in (0..n).filter(|c| set >> c & 1 == 0) {
            if let Some((order, _)) = entries[row][column] {
                let with = set | 1 << column;
                first[with] = first[with].max(first[set] + order);
            }
        }
    }
    for set in (0..(1usize << n) - 1).rev() {
        let row = set.count_ones() as usize;
        for column in (0..n).filter(|c| set >> c & 1 == 0) {
            if let Some((order, _)) = entries[row][column] {
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
    let mut takes_part = list![list![false; n]; n];
    for set in 0..(1usize << n) - 1 {
        let row = set.count_ones() as usize;
        for column in (0..n).filter(|c| set >> c & 1 == 0) {
            let Some((order, _)) = entries[row][column] else { continue };
            if first[set] + order + last[set | 1 << column] == greatest {
                takes_part[row][column] = true;
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
        let terms = polynomial::block_determinant(rows.len(), |i, j| {
            let (row, column) = (rows[i], columns[j]);
            match entries[row][column] {
                Some((_, part)) if takes_part[row][column] => part,
                _ => [Rounded::ZERO; 4],
            }
        })?;
        let mut terms = terms.into_iter();
        terms.next().filter(|_| terms.len() == 0).map(|term| term.form)
    };
    names.into_iter().map(factor).collect::<Option<_>>().unwrap_or_default()
}
