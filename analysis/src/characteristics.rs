//! Characteristic directions of the steady equations: real and complex roots of det(ξ₁ B̃¹ + ξ₂ B̃²) with
//! B̃ⁱ = Bⁱ + Vᵢ A.
//!
//! The determinant is the product of the determinants of the irreducible blocks of the matrix's pattern of non-zero
//! entries. Each block groups the unknowns of one family of characteristics; roots shared by two families are simple
//! roots of each factor, hence well-conditioned.

use crate::form::BinaryForm;
use crate::{polynomial, roots};
use models::common::elementary::{Elementary, Modulus};
use models::{LinearisedSystem, Rounded};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// Real characteristic direction of the steady equations.
#[derive(Clone, Debug, PartialEq)]
pub struct RealCharacteristic {
    /// Angle of the characteristic curve from x₁, rad, in [0, π); perpendicular to the wave vector (ξ₁, ξ₂) at which
    /// the determinant vanishes.
    pub angle: f64,
    /// Bound on the error of the angle, rad.
    pub bound: f64,
    /// Multiplicity as a root of the full determinant: 1 for each factor that changes sign, 2 for each that touches
    /// zero.
    pub multiplicity: usize,
    /// Family: the fields that may jump across the characteristic, such as "stress and velocity", or "streamline".
    pub family: String,
}

/// Type of the steady equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EquationType {
    /// Hyperbolic: all roots are real.
    Hyperbolic,
    /// Mixed: some roots are real.
    Mixed,
    /// Elliptic: no root is real.
    Elliptic,
}

/// Characteristics of the steady equations.
#[derive(Clone, Debug, PartialEq)]
pub struct Characteristics {
    /// Real characteristics by ascending angle.
    pub real: Vec<RealCharacteristic>,
    /// Complex characteristics: tangent of the complex angle, with the family.
    pub complex: Vec<(Complex64, String)>,
    /// Families whose factor of the determinant vanishes identically, so that every direction is
    /// characteristic for them: convected fields in a material at rest.
    pub arbitrary_families: Vec<String>,
    /// Type of the steady equations; `None` if the determinant has no roots.
    pub equation_type: Option<EquationType>,
}

/// Error: characteristics are not defined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CharacteristicsError {
    /// The numbers of equations and unknowns differ, or all entries of the matrix are structural zeros.
    #[error("the steady equations do not determine their unknowns")]
    Indeterminate,
    /// The equations have derivatives of second or higher order: write them as first-order equations.
    #[error("characteristics are those of first-order equations")]
    HigherOrder,
}

/// Computes the characteristics of a square system.
///
/// # Errors
/// The system is not square, all entries of its steady matrices are structural zeros, or it has terms of higher order.
pub fn characteristics(
    system: &LinearisedSystem<2>,
) -> Result<Characteristics, CharacteristicsError> {
    if system.equations.len() != system.unknowns.len() {
        return Err(CharacteristicsError::Indeterminate);
    }
    if !system.higher_terms.is_empty() {
        return Err(CharacteristicsError::HigherOrder);
    }
    let steady = steady_matrices(system);
    let blocks = irreducible_blocks(&steady).ok_or(CharacteristicsError::Indeterminate)?;
    let mut found = Characteristics {
        real: Vec::new(),
        complex: Vec::new(),
        arbitrary_families: Vec::new(),
        equation_type: None,
    };
    for (rows, columns) in blocks {
        let family = family_name(system, &columns);
        let form = determinant(&steady, &rows, &columns);
        let Some(form) = form.filter(BinaryForm::is_nonzero) else {
            found.arbitrary_families.push(family);
            continue;
        };
        let zeros = form.zeros();
        for zero in &zeros {
            let angle = (zero.angle + FRAC_PI_2).rem_euclid(PI);
            let multiplicity = if zero.has_sign_change { 1 } else { 2 };
            merge_characteristic(&mut found.real, angle, zero.bound, multiplicity, &family);
        }
        let real: usize = zeros.iter().map(|z| if z.has_sign_change { 1 } else { 2 }).sum();
        found.complex.extend(
            complex_roots(&form, form.degree() - real.min(form.degree()))
                .into_iter()
                .map(|root| (root, family.clone())),
        );
    }
    name_streamlines(system, &mut found.real);
    found.real.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    found.equation_type = match (found.real.is_empty(), found.complex.is_empty()) {
        (true, true) => None,
        (true, false) => Some(EquationType::Elliptic),
        (false, true) => Some(EquationType::Hyperbolic),
        (false, false) => Some(EquationType::Mixed),
    };
    Ok(found)
}

/// The matrices Bⁱ + Vᵢ A of the steady equations; entry (row, column) holds both.
fn steady_matrices(system: &LinearisedSystem<2>) -> Vec<Vec<[Rounded; 2]>> {
    let v =
        system.velocity.map(|v| if v == 0.0 { Rounded::ZERO } else { Rounded::from_rounded(v) });
    (0..system.equations.len())
        .map(|i| {
            (0..system.unknowns.len())
                .map(|j| [0, 1].map(|d| system.b[d][(i, j)] + v[d] * system.a[(i, j)]))
                .collect()
        })
        .collect()
}

/// Blocks (rows, columns) of the block triangular form (Dulmage & Mendelsohn 1958; Tarjan 1972): a maximum matching of
/// rows and columns, then the strongly connected components. `None` if all entries are structural zeros.
fn irreducible_blocks(matrix: &[Vec<[Rounded; 2]>]) -> Option<Vec<(Vec<usize>, Vec<usize>)>> {
    let n = matrix.len();
    let present = |i: usize, j: usize| matrix[i][j].iter().any(|x| !x.is_structural_zero());
    // Convected fields in a material at rest have an empty row or column; these are matched last, with each other, so
    // that the other families are still found.
    let mut row_of = vec![usize::MAX; n];
    /// Augmenting path from `row` in the bipartite graph of rows and columns (Kuhn's algorithm).
    fn augment_matching(
        row: usize,
        n: usize,
        present: &dyn Fn(usize, usize) -> bool,
        row_of: &mut [usize],
        seen: &mut [bool],
    ) -> bool {
        for column in 0..n {
            if present(row, column) && !seen[column] {
                seen[column] = true;
                if row_of[column] == usize::MAX
                    || augment_matching(row_of[column], n, present, row_of, seen)
                {
                    row_of[column] = row;
                    return true;
                }
            }
        }
        false
    }
    let mut unmatched = Vec::new();
    for row in 0..n {
        if !augment_matching(row, n, &present, &mut row_of, &mut vec![false; n]) {
            unmatched.push(row);
        }
    }
    let mut free = (0..n).filter(|&c| row_of[c] == usize::MAX).collect::<Vec<_>>();
    if unmatched.len() == n {
        return None;
    }
    for row in unmatched {
        row_of[free.pop()?] = row;
    }
    // Reachability between columns through their matched rows; n is small.
    let mut reach = vec![vec![false; n]; n];
    for (from, row) in reach.iter_mut().enumerate() {
        for (to, cell) in row.iter_mut().enumerate() {
            *cell = from == to || present(row_of[from], to);
        }
    }
    for via in 0..n {
        for from in 0..n {
            for to in 0..n {
                reach[from][to] |= reach[from][via] && reach[via][to];
            }
        }
    }
    let mut blocks: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
    for column in 0..n {
        let home = blocks
            .iter_mut()
            .find(|(_, columns)| reach[columns[0]][column] && reach[column][columns[0]]);
        match home {
            Some((rows, columns)) => {
                rows.push(row_of[column]);
                columns.push(column);
            }
            None => blocks.push((vec![row_of[column]], vec![column])),
        }
    }
    Some(blocks)
}

/// Determinant of a block as a binary form in (ξ₁, ξ₂), up to a positive factor; `None` if it is a structural zero, if
/// a coefficient is not finite, or if the block is too large.
fn determinant(
    matrix: &[Vec<[Rounded; 2]>],
    rows: &[usize],
    columns: &[usize],
) -> Option<BinaryForm> {
    let entry = |i: usize, j: usize| {
        let [first, second] = matrix[rows[i]][columns[j]];
        [Rounded::ZERO, first, second, Rounded::ZERO]
    };
    polynomial::block_determinant(rows.len(), false, entry)
}

/// Name of the family of fields in `columns`.
fn family_name(system: &LinearisedSystem<2>, columns: &[usize]) -> String {
    let mut names: Vec<&str> = columns.iter().map(|&c| system.unknowns[c].family).collect();
    names.sort_unstable();
    names.dedup();
    names.join(" and ")
}

/// Adds a characteristic to `list`, or its multiplicity and family to a known one at the same angle within the bounds.
fn merge_characteristic(
    list: &mut Vec<RealCharacteristic>,
    angle: f64,
    bound: f64,
    multiplicity: usize,
    family: &str,
) {
    let near = |c: &&mut RealCharacteristic| {
        let gap = (c.angle - angle).abs();
        gap.min(PI - gap) <= 4.0 * (c.bound + bound)
    };
    match list.iter_mut().find(near) {
        Some(same) => {
            same.multiplicity += multiplicity;
            if !same.family.split(" and ").any(|f| f == family) {
                let mut names: Vec<&str> = same.family.split(" and ").collect();
                names.push(family);
                names.sort_unstable();
                same.family = names.join(" and ");
            }
        }
        None => list.push(RealCharacteristic { angle, bound, multiplicity, family: family.into() }),
    }
}

/// Adds "streamline" to the families of characteristics along the velocity, in place of "spin" and "density".
fn name_streamlines(system: &LinearisedSystem<2>, real: &mut [RealCharacteristic]) {
    let [v1, v2] = system.velocity;
    if v1 == 0.0 && v2 == 0.0 {
        return;
    }
    let stream = v2.cr_atan2(v1).rem_euclid(PI);
    for c in real {
        let gap = (c.angle - stream).abs();
        if gap.min(PI - gap) <= 4.0 * (c.bound + f64::EPSILON) {
            let others: Vec<&str> =
                c.family.split(" and ").filter(|f| !matches!(*f, "spin" | "density")).collect();
            c.family = if others.is_empty() {
                "streamline".into()
            } else {
                format!("{} and streamline", others.join(" and "))
            };
        }
    }
}

/// The `count` roots farthest from the real axis, as tangents of the complex characteristic angle.
fn complex_roots(form: &BinaryForm, count: usize) -> Vec<Complex64> {
    if count == 0 {
        return Vec::new();
    }
    // F(ξ₁, ξ₂) = 0 with ξ₂ = t ξ₁, and tan of the characteristic is −ξ₁/ξ₂ = −1/t.
    let mut polynomial: Vec<Complex64> =
        form.coefficients.iter().map(|f| Complex64::from(f.value)).collect();
    let size = polynomial.iter().map(|c| c.modulus()).fold(0.0, f64::max);
    while polynomial.last().is_some_and(|c| c.modulus() <= 1e-15 * size) {
        polynomial.pop();
    }
    let mut found = roots::solve(&polynomial);
    // Distance of a complex direction from the real directions: imaginary part of the angle.
    let off_real = |t: &Complex64| t.im.abs() / (1.0 + t.norm_sqr());
    found.sort_by(|a, b| off_real(b).total_cmp(&off_real(a)));
    found.truncate(count);
    found.into_iter().map(|t| -1.0 / t).collect()
}
