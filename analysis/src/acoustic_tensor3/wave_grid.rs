//! Eigenbases of the elastic acoustic tensor Γₑ on the geodesic grid of wave normals.

use super::eigenbasis::{Eigenbasis, EigenvalueGroups, MAX_VELOCITIES, new_identity};
use super::elastic_waves::AcousticTensor3;
use super::geodesic_grid::{MAX_NEIGHBOURS, build_grid_pair};

/// Number of wave normals that the inner loops process together (SIMD lanes).
pub(super) const LANES: usize = 32;

/// Grid of wave normals with the eigenvalues and eigenvectors of Γₑ.
#[derive(Clone, Debug)]
pub(super) struct WaveGrid {
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
    /// Eigenvectors of each chunk, block by block, with the velocity as slow and the eigenvalue as fast index; none in
    /// isotropic solids.
    pub(super) eigenvectors: Vec<[f64; LANES]>,
    /// Index of the first velocity and number of velocities of each block of `eigenvectors`.
    blocks: Vec<(usize, usize)>,
}

/// Wave normals and elastic eigenvalues of `LANES` directions.
#[derive(Clone, Debug)]
pub(super) struct DirectionChunk {
    pub(super) normal: [[f64; LANES]; 3],
    pub(super) squared_speed: [[f64; LANES]; MAX_VELOCITIES],
}

impl WaveGrid {
    /// Computes the eigenbases on the grid, in about 0.1 s.
    pub(super) fn new(tensor: &AcousticTensor3) -> Self {
        let (normals, coarse_points, coarse_neighbours, coarse_parents) = build_grid_pair();
        let count = normals.len();
        // Isotropic solids need no stored eigenvectors.
        let blocks = if tensor.isotropic.is_some() { Vec::new() } else { tensor.blocks.clone() };
        let entries: usize = blocks.iter().map(|&(_, size)| size * size).sum();
        let (mut groups, mut chunks, mut eigenvectors) = (Vec::new(), Vec::new(), Vec::new());
        for start in (0..count).step_by(LANES) {
            let mut chunk = DirectionChunk {
                normal: [[0.0; LANES]; 3],
                squared_speed: [[1.0; LANES]; MAX_VELOCITIES],
            };
            let first = eigenvectors.len();
            eigenvectors.resize(first + entries, [0.0; LANES]);
            for lane in 0..LANES {
                // Pad the last chunk with the last direction.
                let normal = &normals[(start + lane).min(count - 1)];
                let (values, basis, own_groups) = match &tensor.isotropic {
                    Some(waves) => (waves.eigenvalues(), new_identity(), *waves.groups()),
                    None => {
                        let (values, basis) = tensor.elastic_eigenbasis(normal, &new_identity());
                        let groups = EigenvalueGroups::new(&values[..tensor.velocity_count]);
                        (values, basis, groups)
                    }
                };
                for (lanes, component) in chunk.normal.iter_mut().zip(normal) {
                    lanes[lane] = *component;
                }
                let pairs = chunk.squared_speed.iter_mut().zip(values);
                for (lanes, value) in pairs.take(tensor.velocity_count) {
                    lanes[lane] = value;
                }
                let mut entry = first;
                for &(block, size) in &blocks {
                    for row in &basis[block..block + size] {
                        for &component in &row[block..block + size] {
                            eigenvectors[entry][lane] = component;
                            entry += 1;
                        }
                    }
                }
                if start + lane < count {
                    groups.push(own_groups);
                }
            }
            chunks.push(chunk);
        }
        Self {
            normals,
            groups,
            coarse_parents,
            coarse_points,
            coarse_neighbours,
            chunks,
            eigenvectors,
            blocks,
        }
    }

    /// Eigenvalues at each of `normals`.
    pub(super) fn squared_speeds(&self) -> impl Iterator<Item = [f64; MAX_VELOCITIES]> {
        (0..self.normals.len())
            .map(|point| self.chunks[point / LANES].squared_speed.map(|lanes| lanes[point % LANES]))
    }

    /// Largest eigenvalue on the grid, for solids with `velocity_count` velocities.
    pub(super) fn fastest(&self, velocity_count: usize) -> f64 {
        let of_all = |largest: f64, values: [f64; MAX_VELOCITIES]| {
            values[..velocity_count].iter().fold(largest, |largest, &value| largest.max(value))
        };
        self.squared_speeds().fold(0.0, of_all)
    }

    /// Multiplies the eigenvalues by `factor`.
    pub(super) fn scale(&mut self, factor: f64) {
        let chunked = self.chunks.iter_mut().flat_map(|chunk| &mut chunk.squared_speed).flatten();
        let grouped = self.groups.iter_mut().flat_map(|groups| &mut groups.values);
        chunked.chain(grouped).for_each(|value| *value *= factor);
    }

    /// Eigenvectors of Γₑ at the grid point of index `point`; zero in isotropic solids, which do not need them.
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
}
