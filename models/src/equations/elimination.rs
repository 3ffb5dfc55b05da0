//! Elimination of algebraic unknowns from the linearised equations.
//!
//! Where an equation contains an unknown without derivatives and with a number p as coefficient, as in a definition of a
//! stress `s = …`, it gives this unknown: the Schur complement Lᵢⱼ − Lᵢ꜀ Lᵣⱼ/p of the symbol L removes its row r and its
//! column c. Entries stay polynomials in ς and κ, and the determinant changes by the factor ±p alone.

use super::graph::{Graph, JetVariable, MAX_ORDER, MultiIndex, NodeId};
use super::model::MAX_NODES;
use std::collections::BTreeMap;

/// Linearised equations without the eliminated unknowns.
#[derive(Clone, Debug)]
pub(super) struct Elimination {
    /// Equations that remain.
    pub(super) rows: Vec<usize>,
    /// Unknowns that remain.
    pub(super) columns: Vec<usize>,
    /// Coefficients that remain, with equations and unknowns of the whole model.
    pub(super) entries: Vec<(usize, JetVariable, NodeId)>,
}

/// Entries by equation, unknown and derivative.
type Entries = BTreeMap<(usize, usize, MultiIndex), NodeId>;

/// Eliminates unknowns from the coefficients `derivatives` of `row_count` equations for `column_count` unknowns, as long
/// as the remaining entries have derivatives of fourth order at most.
pub(super) fn eliminate(
    graph: &mut Graph,
    derivatives: &[(usize, JetVariable, NodeId)],
    [row_count, column_count]: [usize; 2],
) -> Elimination {
    let (mut rows, mut columns): (Vec<usize>, Vec<usize>) =
        ((0..row_count).collect(), (0..column_count).collect());
    let mut entries: Entries = derivatives
        .iter()
        .map(|&(row, variable, node)| ((row, variable.unknown, variable.orders), node))
        .collect();
    // Each step adds products; a dense system is left as it is before it fills the memory.
    while graph.len() < MAX_NODES
        && let Some((row, column)) = find_pivot(graph, &entries)
    {
        remove(graph, &mut entries, row, column);
        rows.retain(|own| *own != row);
        columns.retain(|own| *own != column);
    }
    let to_entry = |((row, unknown, orders), node)| (row, JetVariable { unknown, orders }, node);
    Elimination { rows, columns, entries: entries.into_iter().map(to_entry).collect() }
}

/// The pivot that adds the fewest products, by equation and unknown.
fn find_pivot(graph: &Graph, entries: &Entries) -> Option<(usize, usize)> {
    let order = |orders: &MultiIndex| orders.iter().sum::<u8>();
    let cost = |row: usize, column: usize, orders: &MultiIndex, node: NodeId| {
        let is_number = graph.as_exact_number(node).is_some_and(|value| value != 0.0);
        if order(orders) > 0 || !is_number {
            return None;
        }
        let others =
            |(own, unknown, _): &(usize, usize, MultiIndex)| (*own == row, *unknown == column);
        let keys = || entries.keys();
        let largest = |side: (bool, bool)| {
            keys().filter(|own| others(own) == side).map(|own| order(&own.2)).max()
        };
        let count = |side: (bool, bool)| keys().filter(|own| others(own) == side).count();
        // The unknown must have no other derivative in this equation.
        let is_product_allowed = match (largest((false, true)), largest((true, false))) {
            (Some(left), Some(right)) => left + right <= MAX_ORDER,
            _ => true,
        };
        (count((true, true)) == 1 && is_product_allowed)
            .then(|| count((false, true)) * count((true, false)))
    };
    entries
        .iter()
        .filter_map(|((row, column, orders), node)| {
            Some((cost(*row, *column, orders, *node)?, *row, *column))
        })
        .min()
        .map(|(_, row, column)| (row, column))
}

/// Removes equation `row` and unknown `column` by their pivot.
fn remove(graph: &mut Graph, entries: &mut Entries, row: usize, column: usize) {
    let pivot = entries[&(row, column, [0; 4])];
    let take = |side: (bool, bool)| -> Vec<((usize, usize, MultiIndex), NodeId)> {
        let is_own = |key: &(usize, usize, MultiIndex)| (key.0 == row, key.1 == column) == side;
        entries.iter().filter(|(key, _)| is_own(key)).map(|(key, node)| (*key, *node)).collect()
    };
    let (left, right) = (take((false, true)), take((true, false)));
    for (left_key, left_node) in left {
        for &(right_key, right_node) in &right {
            let product = graph.multiply(left_node, right_node);
            let change = graph.divide(product, pivot);
            let orders = std::array::from_fn(|i| left_key.2[i] + right_key.2[i]);
            let key = (left_key.0, right_key.1, orders);
            let node = match entries.get(&key) {
                // Equal expressions cancel exactly, not but for their rounding.
                Some(&own) if own == change => None,
                Some(&own) => Some(graph.subtract(own, change)),
                None => Some(graph.negate(change)),
            };
            match node.filter(|own| graph.as_exact_number(*own) != Some(0.0)) {
                Some(node) => entries.insert(key, node),
                None => entries.remove(&key),
            };
        }
    }
    entries.retain(|key, _| key.0 != row && key.1 != column);
}
