//! Elastic acoustic tensor Γₑ and its eigenbases on the geodesic grid of wave normals.

use super::eigenbasis::{Eigenbasis, EigenvalueGroups, MAX_VELOCITIES, diagonalise, new_identity};
use super::error::NormalSearchError;
use super::geodesic_grid::{MAX_NEIGHBOURS, build_grid_pair};
use models::common::product::triple_product;
use models::common::rates::RateEquations;
use nalgebra::DMatrix;

/// Number of wave normals that the inner loops process together (SIMD lanes).
pub(super) const LANES: usize = 32;

/// Elastic acoustic tensor Γₑ(n) of a solid in space, with its eigenbases on a grid of wave normals; serves every
/// [rank-one update](super::rank_one::RankOneUpdate) of the stiffness of that solid, from any thread.
///
/// Stored speeds are in units of the fastest elastic wave of the grid. Velocities whose gradients are not strains
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
    /// Wave normals of the grid.
    pub(super) normals: Vec<[f64; 3]>,
    /// Groups of equal eigenvalues at each of `normals`.
    pub(super) groups: Vec<EigenvalueGroups>,
    /// Index in `coarse_points` of the nearest point of the coarse grid to each of `normals`.
    pub(super) coarse_parents: Vec<u32>,
    /// Coarse grid, as indices into `normals`.
    pub(super) coarse_points: Vec<u32>,
    /// Neighbours of the coarse grid points, as indices into `coarse_points`; if fewer than six, the first is repeated.
    pub(super) coarse_neighbours: Vec<[u32; MAX_NEIGHBOURS]>,
    /// Wave normals and eigenvalues in chunks of `LANES` directions, as structure of arrays; the last chunk is padded.
    pub(super) chunks: Vec<DirectionChunk>,
    /// Eigenvectors of each chunk, block by block, with the velocity as slow and the eigenvalue as fast index.
    pub(super) eigenvectors: Vec<[f64; LANES]>,
}

/// Wave normals and elastic eigenvalues of `LANES` directions.
#[derive(Clone, Debug)]
pub(super) struct DirectionChunk {
    pub(super) normal: [[f64; LANES]; 3],
    pub(super) squared_speed: [[f64; LANES]; MAX_VELOCITIES],
}

impl AcousticTensor3 {
    /// Bound on the covering radius of the grid, rad (0.9°), the largest distance of a direction to the nearest grid
    /// point or its opposite.
    pub const COVERING_RADIUS: f64 = 0.9 * std::f64::consts::PI / 180.0;

    /// Computes the elastic acoustic tensor and its eigenbases on the grid, in about 0.1 s.
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
        let (normals, coarse_points, coarse_neighbours, coarse_parents) = build_grid_pair();
        let mut tensor = Self {
            squared_speed_unit: 1.0,
            stress_count: stresses,
            velocity_count: size,
            blocks,
            scaled_divergence: std::array::from_fn(|axis| rows(axis, &order)),
            form_tensors,
            normals,
            groups: Vec::new(),
            coarse_parents,
            coarse_points,
            coarse_neighbours,
            chunks: Vec::new(),
            eigenvectors: Vec::new(),
        };
        tensor.compute_waves()?;
        Ok(tensor)
    }

    /// Fills `groups`, `chunks` and `eigenvectors`, and normalises by the fastest wave.
    fn compute_waves(&mut self) -> Result<(), NormalSearchError> {
        let count = self.normals.len();
        let mut fastest: f64 = 0.0;
        let mut waves = Vec::with_capacity(count);
        for &normal in &self.normals {
            let wave = self.elastic_eigenbasis(&normal, &new_identity());
            for &value in &wave.0[..self.velocity_count] {
                fastest = fastest.max(value);
            }
            waves.push(wave);
        }
        for ((values, _), &normal) in waves.iter().zip(&self.normals) {
            if let Some(&value) = values[..self.velocity_count]
                .iter()
                .find(|&&value| value.is_nan() || value <= 1e-14 * fastest)
            {
                return Err(NormalSearchError::NotPositiveDefinite {
                    normal,
                    squared_speed: value,
                });
            }
        }
        self.squared_speed_unit = fastest;
        for tensor in self.form_tensors.iter_mut().flatten().flatten() {
            *tensor /= fastest;
        }
        for rows in &mut self.scaled_divergence {
            *rows /= fastest.sqrt();
        }
        let entries: usize = self.blocks.iter().map(|&(_, size)| size * size).sum();
        for start in (0..count).step_by(LANES) {
            let mut chunk = DirectionChunk {
                normal: [[0.0; LANES]; 3],
                squared_speed: [[1.0; LANES]; MAX_VELOCITIES],
            };
            let first = self.eigenvectors.len();
            self.eigenvectors.resize(first + entries, [0.0; LANES]);
            for lane in 0..LANES {
                // Pad the last chunk with the last direction.
                let point = (start + lane).min(count - 1);
                let (values, basis) = &waves[point];
                for axis in 0..3 {
                    chunk.normal[axis][lane] = self.normals[point][axis];
                }
                for (lanes, value) in
                    chunk.squared_speed.iter_mut().zip(values).take(self.velocity_count)
                {
                    lanes[lane] = value / fastest;
                }
                let mut entry = first;
                for &(block, size) in &self.blocks {
                    for row in &basis[block..block + size] {
                        for &component in &row[block..block + size] {
                            self.eigenvectors[entry][lane] = component;
                            entry += 1;
                        }
                    }
                }
                if start + lane < count {
                    let scaled = values.map(|value| value / fastest);
                    self.groups.push(EigenvalueGroups::new(&scaled[..self.velocity_count]));
                }
            }
            self.chunks.push(chunk);
        }
        Ok(())
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

    /// Eigenvectors of Γₑ at the grid point of index `point`.
    pub(super) fn eigenbasis_at(&self, point: usize) -> Eigenbasis {
        let mut basis = [[0.0; MAX_VELOCITIES]; MAX_VELOCITIES];
        let entries: usize = self.blocks.iter().map(|&(_, size)| size * size).sum();
        let mut entry = point / LANES * entries;
        for &(first, size) in &self.blocks {
            for row in &mut basis[first..first + size] {
                for component in &mut row[first..first + size] {
                    *component = self.eigenvectors[entry][point % LANES];
                    entry += 1;
                }
            }
        }
        basis
    }

    /// Wave normals of the grid, one of each pair n, −n.
    pub fn normals(&self) -> &[[f64; 3]] {
        &self.normals
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
