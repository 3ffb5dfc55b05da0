//! Stiffness and mass matrices of a cell for Legendre polynomials of a given degree.

use super::legendre::{gauss_legendre, gradient_integral, normalised_legendre, stiffness_integral};
use super::{BlockRow, Cell, CellBlock, Joint, JointComponent, JointDelay};
use models::common::elementary::cr_cis;
use nalgebra::DMatrix;
use num_complex::Complex64;

/// Galerkin matrices of a [`Cell`], for all wave vectors.
///
/// Unknowns: for each block in turn, for u₁ and then u₂, the coefficients of √(2m+1)Pₘ(ξ) √(2n+1)Pₙ(η)/√(area), index
/// m(p + 1) + n, with ξ, η in [−1, 1].
#[derive(Clone, Debug)]
pub struct CellModel {
    pub(in crate::bloch) periods: [f64; 2],
    degree: usize,
    stiffness: HermitianFamily,
    mass: HermitianFamily,
    /// Widths and heights of the blocks, m.
    block_sides: Vec<[f64; 2]>,
    /// Whether a corner of a block touches the side of another block between its ends.
    has_staggered_joints: bool,
    /// Delayed openings at the quadrature points of viscous joints. The openings are polynomials of degree p along a
    /// contact, so their values at p + 1 points determine them.
    pub(super) delayed_openings: Vec<DelayedOpening>,
}

/// Delayed opening of a viscous joint at a quadrature point, for one displacement component.
#[derive(Clone, Debug)]
pub(super) struct DelayedOpening {
    /// Lattice vector from the block before the joint to the one after it, in periods.
    pub shift: [i32; 2],
    /// Index of the first unknown of both blocks for this component.
    pub first_unknowns: [usize; 2],
    /// Values of the basis polynomials of both blocks at the point, 1/m.
    pub polynomial_values: [Vec<f64>; 2],
    /// Quadrature weight of the point, m.
    pub quadrature_weight: f64,
    /// Instantaneous stiffness K, Pa/m.
    pub stiffness: f64,
    /// Delayed compliance and retardation time.
    pub delay: JointDelay,
}

/// Hermitian matrix C + Σ (e^{−iκ·a} Cₐ + e^{iκ·a} Cₐᵀ) over lattice vectors a = (s₁H₁, s₂H₂).
#[derive(Clone, Debug)]
struct HermitianFamily {
    constant: DMatrix<f64>,
    shifted_terms: Vec<([i32; 2], DMatrix<f64>)>,
}

/// Part of a face that two blocks share.
struct Contact<'c> {
    joint: &'c Joint,
    /// Axis normal to the face.
    axis: usize,
    /// Indices of the blocks with smaller and with greater coordinate along the normal.
    blocks: [usize; 2],
    /// Lattice vector from the cell of the first block to that of the second, in periods.
    shift: [i32; 2],
    /// Contact as an interval of the coordinate in [−1, 1] along the face of each block.
    intervals: [[f64; 2]; 2],
    /// Length of the contact, m.
    length: f64,
}

/// Shortest contact of two blocks, relative to the period.
const CONTACT_TOLERANCE: f64 = 1e-12;
/// Largest difference of the ends of a contact from those of a side, in coordinates in [−1, 1], for which it covers the
/// whole side.
const INTERVAL_TOLERANCE: f64 = 1e-9;

impl CellModel {
    /// Assembles the matrices for Legendre polynomials of degree ≤ `degree` in each direction; at least 1.
    pub fn new(cell: &Cell, degree: usize) -> Self {
        let degree = degree.max(1);
        let block_size = 2 * (degree + 1) * (degree + 1);
        let blocks: Vec<(&CellBlock, f64)> = cell
            .rows()
            .iter()
            .flat_map(|row| row.blocks.iter().map(|block| (block, row.height)))
            .collect();
        let size = block_size * blocks.len();
        let family =
            || HermitianFamily { constant: DMatrix::zeros(size, size), shifted_terms: vec![] };
        let mut model = Self {
            periods: cell.periods(),
            degree,
            stiffness: family(),
            mass: family(),
            block_sides: blocks.iter().map(|(block, height)| [block.width, *height]).collect(),
            has_staggered_joints: false,
            delayed_openings: vec![],
        };
        for (index, (block, height)) in blocks.into_iter().enumerate() {
            model.add_block(index, block, height);
        }
        for contact in find_contacts(cell) {
            let is_full = |[start, end]: [f64; 2]| end - start > 2.0 - INTERVAL_TOLERANCE;
            model.has_staggered_joints |= !contact.intervals.into_iter().all(is_full);
            model.add_contact(&contact);
        }
        model
    }

    /// Degree p of the Legendre polynomials.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Order q of the error (p + ½)^(−q) of ω² for polynomials of degree p. It is limited by a singularity r log r of
    /// the displacement at corners of blocks: q = 4 if corners meet corners, q = 2 in masonry, where they meet sides.
    pub fn convergence_order(&self) -> i32 {
        if self.has_staggered_joints { 2 } else { 4 }
    }

    /// Number of unknowns of the Galerkin method.
    pub fn size(&self) -> usize {
        self.mass.constant.nrows()
    }

    /// Stiffness matrix, Pa/m², with the instantaneous stiffness of viscous joints, and mass matrix, kg/m³, at the wave
    /// vector κ, 1/m.
    pub fn matrices(&self, wave_vector: [f64; 2]) -> [DMatrix<Complex64>; 2] {
        let phases = [0, 1].map(|axis| wave_vector[axis] * self.periods[axis]);
        [&self.stiffness, &self.mass].map(|family| family.evaluate(phases))
    }

    /// Displacement u, for a vector of unknowns, at the point (ξ, η) in [−1, 1]² of block `block`, counted row by row;
    /// zero if there is no such block.
    pub fn displacement(
        &self,
        unknowns: &[Complex64],
        block: usize,
        [x, y]: [f64; 2],
    ) -> [Complex64; 2] {
        let Some([width, height]) = self.block_sides.get(block) else {
            return [Complex64::ZERO; 2];
        };
        let [along, across] = [x, y].map(|x| normalised_legendre(self.degree, x));
        let scale = 1.0 / (width * height).sqrt();
        [0, 1].map(|component| {
            let mut sum = Complex64::ZERO;
            for (m, first) in along.iter().enumerate() {
                for (n, second) in across.iter().enumerate() {
                    if let Some(unknown) = unknowns.get(self.unknown_index(block, component, m, n))
                    {
                        sum += unknown * (first * second * scale);
                    }
                }
            }
            sum
        })
    }

    fn unknown_index(&self, block: usize, component: usize, m: usize, n: usize) -> usize {
        let line = self.degree + 1;
        ((2 * block + component) * line + m) * line + n
    }

    /// Adds elastic and kinetic energy of a block in plane strain: ½λ(u₁,₁ + u₂,₂)² + μ[u₁,₁² + u₂,₂² + ½(u₁,₂ +
    /// u₂,₁)²].
    fn add_block(&mut self, index: usize, block: &CellBlock, height: f64) {
        let (lambda, mu) = (block.material.lame_modulus(), block.material.shear_modulus());
        let modulus = block.material.longitudinal_modulus();
        // The normalised polynomials are orthonormal for the mean; d/dx = (2/side) d/dξ.
        let sides = [block.width, height];
        let bending = |axis: usize, m, n| 2.0 / sides[axis].powi(2) * stiffness_integral(m, n);
        let slope = |axis: usize, m, n| gradient_integral(m, n) / sides[axis];
        let line = self.degree + 1;
        let identity = |m: usize, n: usize| f64::from(u8::from(m == n));
        for (m, n) in (0..line * line).map(|i| (i / line, i % line)) {
            for component in 0..2 {
                let at = self.unknown_index(index, component, m, n);
                self.mass.constant[(at, at)] += block.material.density;
            }
            for (k, l) in (0..line * line).map(|i| (i / line, i % line)) {
                let [along, across] =
                    [bending(0, m, k) * identity(n, l), bending(1, n, l) * identity(m, k)];
                let mut add = |row, column, value| {
                    let at = (
                        self.unknown_index(index, row, m, n),
                        self.unknown_index(index, column, k, l),
                    );
                    self.stiffness.constant[at] += value;
                };
                if along != 0.0 || across != 0.0 {
                    add(0, 0, modulus * along + mu * across);
                    add(1, 1, mu * along + modulus * across);
                }
                // λ ∂₁(m, n) ∂₂(k, l) + μ ∂₂(m, n) ∂₁(k, l), for u₁ with (m, n) and u₂ with (k, l).
                let coupling =
                    lambda * slope(0, k, m) * slope(1, n, l) + mu * slope(0, m, k) * slope(1, l, n);
                if coupling != 0.0 {
                    add(0, 1, coupling);
                    let at =
                        (self.unknown_index(index, 1, k, l), self.unknown_index(index, 0, m, n));
                    self.stiffness.constant[at] += coupling;
                }
            }
        }
    }

    /// Adds elastic and kinetic energy of a joint by Gauss–Legendre quadrature, which is exact for these polynomials.
    fn add_contact(&mut self, contact: &Contact) {
        let line = self.degree + 1;
        let edge: [Vec<f64>; 2] = [1.0, -1.0].map(|end| normalised_legendre(self.degree, end));
        for [node, weight] in gauss_legendre(line) {
            // Values of the polynomials of both blocks at the node.
            let polynomial_values: [Vec<f64>; 2] = [0, 1].map(|side| {
                let [start, end] = contact.intervals[side];
                let local = start + 0.5 * (end - start) * (node + 1.0);
                let along = normalised_legendre(self.degree, local);
                let [width, height] = self.block_sides[contact.blocks[side]];
                let scale = 1.0 / (width * height).sqrt();
                let value = |i: usize| match contact.axis {
                    0 => edge[side][i / line] * along[i % line] * scale,
                    _ => along[i / line] * edge[side][i % line] * scale,
                };
                (0..line * line).map(value).collect()
            });
            let weight = weight * contact.length;
            let [normal, tangential] = [&contact.joint.normal, &contact.joint.tangential];
            let components =
                if contact.axis == 0 { [normal, tangential] } else { [tangential, normal] };
            for (component, JointComponent { mass, stiffness, delay }) in
                components.into_iter().enumerate()
            {
                let starts = contact.blocks.map(|block| self.unknown_index(block, component, 0, 0));
                if let Some(delay) = *delay {
                    self.delayed_openings.push(DelayedOpening {
                        shift: contact.shift,
                        first_unknowns: starts,
                        polynomial_values: polynomial_values.clone(),
                        quadrature_weight: weight,
                        stiffness: *stiffness,
                        delay,
                    });
                }
                let quarter = 0.25 * mass.mass;
                let opening = mass.opening_mass;
                self.stiffness.add_coupling(
                    contact.shift,
                    starts,
                    &polynomial_values,
                    [weight * stiffness, -weight * stiffness],
                );
                self.mass.add_coupling(
                    contact.shift,
                    starts,
                    &polynomial_values,
                    [weight * (quarter + opening), weight * (quarter - opening)],
                );
            }
        }
    }
}

impl HermitianFamily {
    /// Adds the quadratic form a(|x|² + |y|²) + 2b Re(x̄y), (a, b) the last argument, of the displacements x, y of two
    /// blocks at a point of their contact.
    fn add_coupling(
        &mut self,
        shift: [i32; 2],
        starts: [usize; 2],
        polynomial_values: &[Vec<f64>; 2],
        [own, cross]: [f64; 2],
    ) {
        for side in 0..2 {
            add_outer_product(
                &mut self.constant,
                [starts[side]; 2],
                [&polynomial_values[side]; 2],
                own,
            );
        }
        if shift == [0, 0] {
            let both = [&polynomial_values[0], &polynomial_values[1]];
            add_outer_product(&mut self.constant, starts, both, cross);
            add_outer_product(
                &mut self.constant,
                [starts[1], starts[0]],
                [both[1], both[0]],
                cross,
            );
            return;
        }
        let found = self.shifted_terms.iter().position(|(other, _)| *other == shift);
        let term_index = found.unwrap_or_else(|| {
            let size = self.constant.nrows();
            self.shifted_terms.push((shift, DMatrix::zeros(size, size)));
            self.shifted_terms.len() - 1
        });
        add_outer_product(
            &mut self.shifted_terms[term_index].1,
            starts,
            [&polynomial_values[0], &polynomial_values[1]],
            cross,
        );
    }

    fn evaluate(&self, phases: [f64; 2]) -> DMatrix<Complex64> {
        let mut matrix = self.constant.map(Complex64::from);
        for ([first, second], part) in &self.shifted_terms {
            let angle = f64::from(*first) * phases[0] + f64::from(*second) * phases[1];
            let factor = cr_cis(-angle);
            let size = part.nrows();
            for column in 0..size {
                for row in 0..size {
                    let value = part[(row, column)];
                    if value != 0.0 {
                        matrix[(row, column)] += factor * value;
                        matrix[(column, row)] += factor.conj() * value;
                    }
                }
            }
        }
        matrix
    }
}

/// Adds `factor` times the outer product of the vectors `left` and `right` to a matrix, from entry (`row`, `column`)
/// on.
fn add_outer_product(
    matrix: &mut DMatrix<f64>,
    [row, column]: [usize; 2],
    [left, right]: [&Vec<f64>; 2],
    factor: f64,
) {
    for (j, y) in right.iter().enumerate() {
        for (i, x) in left.iter().enumerate() {
            matrix[(row + i, column + j)] += factor * x * y;
        }
    }
}

/// Finds all contacts between blocks of a cell and with blocks of neighbouring cells.
fn find_contacts(cell: &Cell) -> Vec<Contact<'_>> {
    const WHOLE_SIDE: [f64; 2] = [-1.0, 1.0];
    let [period, _] = cell.periods();
    let rows = cell.rows();
    let mut first_block = 0;
    let starts: Vec<usize> = rows
        .iter()
        .map(|row| {
            first_block += row.blocks.len();
            first_block - row.blocks.len()
        })
        .collect();
    // Left faces and widths of the blocks of a row.
    let spans = |row: usize| {
        let mut left = rows[row].offset;
        rows[row].blocks.iter().map(move |block| {
            left += block.width;
            [left - block.width, block.width]
        })
    };
    let mut all = Vec::new();
    for (row, BlockRow { height, blocks, .. }) in rows.iter().enumerate() {
        let above = (row + 1) % rows.len();
        let wraps = i32::from(row + 1 == rows.len());
        for (i, (block, [left, width])) in blocks.iter().zip(spans(row)).enumerate() {
            let next = (i + 1) % blocks.len();
            all.push(Contact {
                joint: &block.right_joint,
                axis: 0,
                blocks: [starts[row] + i, starts[row] + next],
                shift: [i32::from(i + 1 == blocks.len()), 0],
                intervals: [WHOLE_SIDE; 2],
                length: *height,
            });
            for (j, [other, other_width]) in spans(above).enumerate() {
                // Images of the upper block that touch this one.
                let lowest = ((left - other - other_width) / period).floor() as i32;
                let highest = ((left + width - other) / period).ceil() as i32;
                for image in lowest..=highest {
                    let other = other + f64::from(image) * period;
                    let start = left.max(other);
                    let end = (left + width).min(other + other_width);
                    if end - start <= CONTACT_TOLERANCE * period {
                        continue;
                    }
                    let local = |x: f64, left: f64, width: f64| {
                        ((x - left) / width * 2.0 - 1.0).clamp(-1.0, 1.0)
                    };
                    let interval =
                        |left, width| [local(start, left, width), local(end, left, width)];
                    all.push(Contact {
                        joint: &block.top_joint,
                        axis: 1,
                        blocks: [starts[row] + i, starts[above] + j],
                        shift: [image, wraps],
                        intervals: [interval(left, width), interval(other, other_width)],
                        length: end - start,
                    });
                }
            }
        }
    }
    all
}
