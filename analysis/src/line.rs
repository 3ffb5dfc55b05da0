//! Verdict on equations in one space dimension: waves along one line.

use crate::finite_wave_number::find_pole;
use crate::growth::{
    Assessment, Verdict, decide_verdict, describe_doubtful_term, exponents, is_above_polygon,
};
use crate::growth_accumulator::GrowthAccumulator;
use crate::list::{StackList, list};
use crate::newton_polygon::{GrowthOrder, is_on_edge, newton_polygon_corners};
use crate::pencil::Pencil;
use crate::polynomial::DispersionTerm;
use crate::puiseux::{self, Monomial, solve_nonzero_roots};
use crate::rounded_complex::RoundedComplex;

/// Assesses the system in `pencil` for waves along x₁ only; it has no derivatives by x₂.
pub fn assess_line(pencil: &Pencil) -> Assessment {
    let mut assessment = Assessment {
        verdict: Verdict::WellPosed,
        orders: StackList::new(),
        degenerate_directions: StackList::new(),
    };
    if pencil.is_singular() {
        let unknowns = pencil.scaled.system.unknowns.len();
        assessment.verdict = Verdict::Indeterminate { rank: pencil.generic_rank(), unknowns };
        return assessment;
    }
    let terms = pencil.polynomial.forms();
    let (certain, doubtful): (StackList<DispersionTerm, 24>, StackList<DispersionTerm, 24>) =
        terms.iter().cloned().partition(|term| term.form.is_nonzero());
    let corners = newton_polygon_corners(certain.iter().map(exponents));
    let growing = corners.windows(2).filter(|pair| pair[1].1 > pair[0].1);
    assessment.orders = growing
        .clone()
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            (GrowthOrder::new(b.1 - a.1, a.0 - b.0), (a.0 - b.0) as usize)
        })
        .collect();
    if let Some(term) = doubtful.iter().find(|term| is_above_polygon(term, &corners)) {
        assessment.verdict = describe_doubtful_term(term);
        return assessment;
    }
    if let Some(direction) = find_pole(&certain, &[0.0]) {
        assessment.verdict = Verdict::IllPosed { growth: None, direction };
        return assessment;
    }
    let monomials: StackList<Monomial, 32> = certain
        .iter()
        .map(|term| {
            let degree = term.form.degree() as i64;
            let value = RoundedComplex::from_i_power(term.form.coefficients[0], degree);
            Monomial { x_power: term.time_power, k_power: degree, value }
        })
        .collect();
    let mut accumulator = GrowthAccumulator::default();
    accumulator.record_root_growth(puiseux::asymptotic_growth(&monomials, 1, None), 0.0);
    for pair in growing {
        let edge = (pair[0], pair[1]);
        let ((highest, _), (lowest, _)) = edge;
        let mut face = list![RoundedComplex::default(); (highest - lowest) as usize + 1];
        for m in &monomials {
            if is_on_edge((m.x_power as i64, m.k_power), edge) {
                face[m.x_power - lowest as usize] += m.value;
            }
        }
        // Roots that agree within rounding may be a growing and a decaying one.
        let is_double = |bound: f64, multiplicity: usize| multiplicity > 1 && bound > 0.0;
        let order = GrowthOrder::new(edge.1.1 - edge.0.1, highest - lowest);
        for root in solve_nonzero_roots(&face) {
            if root.is_neutral() && is_double(root.bound, root.multiplicity) {
                accumulator.record_undecided(
                    format!("distance between neutral roots of order {}", order.to_f64()),
                    0.0,
                    root.bound,
                );
            }
        }
    }
    assessment.verdict = decide_verdict(accumulator, pencil);
    assessment
}
