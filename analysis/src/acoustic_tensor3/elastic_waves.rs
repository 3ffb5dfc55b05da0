//! Elastic acoustic tensor Γₑ of a solid in space.

use super::eigenbasis::{Eigenbasis, MAX_VELOCITIES, diagonalise};
use super::error::NormalSearchError;
use super::isotropic_waves::IsotropicWaves;
use super::wave_grid::WaveGrid;
use models::common::product::triple_product;
use models::common::rates::RateEquations;
use nalgebra::DMatrix;
use std::sync::OnceLock;

/// Elastic acoustic tensor Γₑ(n) of a solid in space; serves every [rank-one update](super::rank_one::RankOneUpdate) of
/// the stiffness of that solid, from any thread.
///
/// Stored speeds are in units of the fastest elastic wave. Velocities whose gradients are not strains
/// (the spins of a reduced Cosserat solid) carry no waves and are omitted.
#[derive(Clone, Debug)]
pub struct AcousticTensor3 {
    /// Squared speed of the fastest elastic wave, m²/s².
    pub(super) squared_speed_unit: f64,
    /// Number of stress components.
    pub(super) stress_count: usize,
    /// Number of velocities that carry waves; they are ordered by decoupled blocks.
    pub(super) velocity_count: usize,
    /// Index of the first velocity and number of velocities of each decoupled block.
    pub(super) blocks: Vec<(usize, usize)>,
    /// M^(−½) Gⁱᵀ for each of the three axes i: velocities × stresses, in units of √`squared_speed_unit`.
    pub(super) scaled_divergence: [DMatrix<f64>; 3],
    /// Symmetric matrices T of the quadratic form Γₑ(n) = Σ nᵢnⱼ Tᵢⱼ, summed over the pairs of axes ij = 11, 22, 33,
    /// 23, 13, 12, one matrix for each pair.
    form_tensors: [[[f64; MAX_VELOCITIES]; MAX_VELOCITIES]; 6],
    /// Speeds of an isotropic solid; `None` if they depend on the direction.
    pub(super) isotropic: Option<IsotropicWaves>,
    /// Eigenbases on the grid of the search; in isotropic solids, computed when first needed.
    grid: OnceLock<WaveGrid>,
}

impl AcousticTensor3 {
    /// Bound on the covering radius of the grid, rad (0.9°), the largest distance of a direction to the nearest grid
    /// point or its opposite.
    pub const COVERING_RADIUS: f64 = 0.9 * std::f64::consts::PI / 180.0;

    /// Computes the elastic acoustic tensor; if the elastic speeds depend on the direction, also the eigenbases on the
    /// grid of the search, in about 0.1 s.
    ///
    /// # Errors
    /// More than six velocities, numbers that are not finite, or a direction in which the elastic acoustic tensor is
    /// not positive definite.
    pub fn new(elastic: &RateEquations<3>) -> Result<Self, NormalSearchError> {
        let stresses = elastic.stress_count();
        let stiffness = elastic.stiffness_values();
        let carries =
            |&v: &usize| elastic.gradient.iter().any(|g| g.column(v).iter().any(|&x| x != 0.0));
        let moving: Vec<usize> = (0..elastic.velocity_count()).filter(carries).collect();
        let size = moving.len();
        if size > MAX_VELOCITIES {
            return Err(NormalSearchError::TooLarge(size));
        }

        // Products M^(−½) Gⁱᵀ D Gʲ M^(−½) for all pairs of axes i, j, with the velocities in the given order.
        let rows = |axis: usize, order: &[usize]| {
            DMatrix::from_fn(size, stresses, |v, s| {
                elastic.gradient[axis][(s, order[v])] / elastic.inertia[order[v]].value.sqrt()
            })
        };
        let products = |order: &[usize]| -> [[DMatrix<f64>; 3]; 3] {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    triple_product(&rows(i, order), &stiffness, &rows(j, order).transpose())
                })
            })
        };
        let all = products(&moving);
        if all.iter().flatten().any(|t| t.iter().any(|x| !x.is_finite())) {
            return Err(NormalSearchError::NotFinite);
        }

        let (order, blocks) = coupled_blocks(&all, size);
        let order: Vec<usize> = order.iter().map(|&v| moving[v]).collect();

        let form_tensors = quadratic_form_tensors(&products(&order), size);
        let isotropic = IsotropicWaves::new(&form_tensors, size);
        let mut tensor = Self {
            squared_speed_unit: 1.0,
            stress_count: stresses,
            velocity_count: size,
            blocks,
            scaled_divergence: std::array::from_fn(|axis| rows(axis, &order)),
            form_tensors,
            isotropic,
            grid: OnceLock::new(),
        };
        tensor.normalise_speeds()?;
        Ok(tensor)
    }

    /// Scales to the unit of the fastest wave, after checking that all waves have positive speeds.
    fn normalise_speeds(&mut self) -> Result<(), NormalSearchError> {
        let check = |normal: [f64; 3], values: &[f64], fastest: f64| {
            let bad = values.iter().find(|&&value| value.is_nan() || value <= 1e-14 * fastest);
            bad.map_or(Ok(()), |&squared_speed| {
                Err(NormalSearchError::NotPositiveDefinite { normal, squared_speed })
            })
        };
        let fastest = match &mut self.isotropic {
            Some(waves) => {
                let fastest = waves.fastest();
                check([1.0, 0.0, 0.0], waves.squared_speeds(), fastest)?;
                waves.scale(1.0 / fastest);
                fastest
            }
            None => {
                let mut grid = WaveGrid::new(self);
                let fastest = grid.fastest(self.velocity_count);
                for (&normal, values) in grid.normals.iter().zip(grid.squared_speeds()) {
                    check(normal, &values[..self.velocity_count], fastest)?;
                }
                grid.scale(1.0 / fastest);
                let _ = self.grid.set(grid);
                fastest
            }
        };
        self.squared_speed_unit = fastest;
        for tensor in self.form_tensors.iter_mut().flatten().flatten() {
            *tensor /= fastest;
        }
        for rows in &mut self.scaled_divergence {
            *rows /= fastest.sqrt();
        }
        Ok(())
    }

    /// Eigenbases on the grid of the search.
    pub(super) fn grid(&self) -> &WaveGrid {
        self.grid.get_or_init(|| WaveGrid::new(self))
    }

    /// Eigenvalues and eigenvectors of Γₑ for the wave normal n; fast if `nearby_basis` is close to the eigenvectors.
    pub(super) fn elastic_eigenbasis(
        &self,
        n: &[f64; 3],
        nearby_basis: &Eigenbasis,
    ) -> ([f64; MAX_VELOCITIES], Eigenbasis) {
        let factors =
            [n[0] * n[0], n[1] * n[1], n[2] * n[2], n[1] * n[2], n[0] * n[2], n[0] * n[1]];
        let (mut matrix, mut basis) = ([[0.0; MAX_VELOCITIES]; MAX_VELOCITIES], *nearby_basis);
        for &(first, size) in &self.blocks {
            let range = first..first + size;
            let mut half = [[0.0; MAX_VELOCITIES]; MAX_VELOCITIES];
            for i in range.clone() {
                for j in range.clone() {
                    let mut entry = 0.0;
                    for (factor, tensor) in factors.iter().zip(&self.form_tensors) {
                        entry += factor * tensor[i][j];
                    }
                    for k in range.clone() {
                        half[i][k] += entry * nearby_basis[j][k];
                    }
                }
            }
            for i in range.clone() {
                for k in range.clone() {
                    for l in range.clone() {
                        matrix[k][l] += nearby_basis[i][k] * half[i][l];
                    }
                }
            }
            diagonalise(&mut matrix, &mut basis, (first, size));
        }
        (std::array::from_fn(|k| matrix[k][k]), basis)
    }

    /// Wave normals of the grid of the search, one of each pair n, −n.
    pub fn normals(&self) -> &[[f64; 3]] {
        &self.grid().normals
    }
}

/// Permutation of the velocities into decoupled blocks, with first velocity and size of each block.
fn coupled_blocks(all: &[[DMatrix<f64>; 3]; 3], size: usize) -> (Vec<usize>, Vec<(usize, usize)>) {
    let mut block: Vec<usize> = (0..size).collect();
    for v in 0..size {
        for w in 0..size {
            if all.iter().flatten().any(|t| t[(v, w)] != 0.0 || t[(w, v)] != 0.0) {
                let (kept, gone) = (block[v].min(block[w]), block[v].max(block[w]));
                block.iter_mut().filter(|b| **b == gone).for_each(|b| *b = kept);
            }
        }
    }
    let mut order: Vec<usize> = (0..size).collect();
    order.sort_by_key(|&v| block[v]);
    let mut blocks: Vec<(usize, usize)> = Vec::new();
    for (point, &v) in order.iter().enumerate() {
        match blocks.last_mut() {
            Some((first, length)) if block[order[*first]] == block[v] => *length += 1,
            _ => blocks.push((point, 1)),
        }
    }
    (order, blocks)
}

/// Symmetric matrices T of the quadratic form Γₑ(n) = Σ nᵢnⱼ Tᵢⱼ, summed over the pairs of axes ij = 11, 22, 33, 23,
/// 13, 12; for i ≠ j the matrix is the sum of the products for ij and ji.
fn quadratic_form_tensors(
    sorted: &[[DMatrix<f64>; 3]; 3],
    size: usize,
) -> [[[f64; MAX_VELOCITIES]; MAX_VELOCITIES]; 6] {
    let mut form_tensors = [[[0.0; MAX_VELOCITIES]; MAX_VELOCITIES]; 6];
    for (tensor, (i, j)) in
        form_tensors.iter_mut().zip([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)])
    {
        for v in 0..size {
            for w in 0..size {
                let pair = |i: usize, j: usize| 0.5 * (sorted[i][j][(v, w)] + sorted[i][j][(w, v)]);
                tensor[v][w] = if i == j { pair(i, i) } else { pair(i, j) + pair(j, i) };
            }
        }
    }
    form_tensors
}
