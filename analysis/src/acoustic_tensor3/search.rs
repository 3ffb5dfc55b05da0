//! Search for the strongest flutter and the slowest wave over all wave normals in space.

use super::eigenbasis::{Eigenbasis, MAX_VELOCITIES};
use super::elastic_waves::AcousticTensor3;
use super::error::NormalSearchError;
use super::extremes::{Flutter, SlowestSpeed, WaveExtremes};
use super::geodesic_grid::{COARSE_SUBDIVISIONS, FINE_SUBDIVISIONS};
use super::minimise::minimise;
use super::rank_one::RankOneUpdate;
use super::secular_equation::assemble_secular_equation;
use super::secular_roots::{EigenvaluePair, SecularRoots};
use super::tensor_update::{TensorUpdate, WEIGHT_TOLERANCE};
use super::wave_grid::LANES;
use num_complex::Complex64;

/// Reusable memory of [`AcousticTensor3::search_extremes`], which allocates it when it first searches.
#[derive(Clone, Debug, Default)]
pub struct NormalSearchWorkspace {
    pub(super) coarse_roots: Vec<SecularRoots>,
    pub(super) squared_growth: Vec<f64>,
}

impl AcousticTensor3 {
    /// Creates a workspace for [`search_extremes`](Self::search_extremes); use one per thread.
    pub fn new_workspace(&self) -> NormalSearchWorkspace {
        let count = self.grid().coarse_points.len();
        NormalSearchWorkspace {
            coarse_roots: vec![SecularRoots::NONE; count],
            squared_growth: vec![f64::NEG_INFINITY; count],
        }
    }

    /// Strongest flutter and slowest real wave over all directions, to 1e-9 rad where they are smooth functions of the
    /// direction, or to the rounding of their values.
    ///
    /// Flutter in a cap that contains a circle of radius [`COVERING_RADIUS`](Self::COVERING_RADIUS) is always found,
    /// since a grid point lies in it. Smaller caps are found from the directions in which two real eigenvalues are
    /// closest. (Im c²)² below 1e-13 times the square of the largest number in the secular equation counts as rounding.
    ///
    /// # Errors
    /// A vector has the wrong length or is not finite.
    pub fn search_extremes(
        &self,
        update: &RankOneUpdate,
        workspace: &mut NormalSearchWorkspace,
    ) -> Result<WaveExtremes, NormalSearchError> {
        Ok(self.search_projected(&self.project_update(update)?, None, workspace))
    }

    /// [`search_extremes`](Self::search_extremes) for projected vectors. If a slow wave is given (normal, c² in the unit
    /// of stored speeds) for which the secular function is at most 1 in all directions, only directions are searched in
    /// which the weights allow flutter: in all others, which have one root below the poles, no wave is slower.
    pub(super) fn search_projected(
        &self,
        tensor_update: &TensorUpdate,
        slowest: Option<([f64; 3], f64)>,
        workspace: &mut NormalSearchWorkspace,
    ) -> WaveExtremes {
        let grid = self.grid();
        if workspace.coarse_roots.len() != grid.coarse_points.len() {
            *workspace = self.new_workspace();
        }
        let NormalSearchWorkspace { coarse_roots, squared_growth } = workspace;
        for (place, (roots, growth)) in
            coarse_roots.iter_mut().zip(squared_growth.iter_mut()).enumerate()
        {
            let index = grid.coarse_points[place] as usize;
            let normal = &grid.normals[index];
            let secular = match &self.isotropic {
                Some(waves) => waves.secular_equation_at(tensor_update, normal),
                None => tensor_update.secular_equation_at(
                    normal,
                    &grid.eigenbasis_at(index),
                    &grid.groups[index],
                ),
            };
            *roots = match slowest.is_some() && secular.is_far_from_flutter() {
                true => SecularRoots::NONE,
                false => secular.solve_roots(),
            };
            *growth = roots.critical_pair.map_or(f64::NEG_INFINITY, |pair| pair.squared_growth());
        }

        let mut best = ScaledExtremes {
            slowest: slowest.unwrap_or((grid.normals[0], f64::INFINITY)),
            is_bounded: slowest.is_some(),
            flutter: None,
        };
        self.refine_coarse_extremes(tensor_update, coarse_roots, squared_growth, &mut best);
        self.search_fine_grid(tensor_update, coarse_roots, squared_growth, &mut best);
        self.scale_extremes(tensor_update, best.slowest, best.flutter)
    }

    /// Extremes in the units of speeds, from the slowest wave (normal, c²) and the strongest flutter in the unit of
    /// stored speeds.
    pub(super) fn scale_extremes(
        &self,
        update: &TensorUpdate,
        (normal, value): ([f64; 3], f64),
        flutter: Option<([f64; 3], EigenvaluePair)>,
    ) -> WaveExtremes {
        let unit = self.squared_speed_unit;
        WaveExtremes {
            flutter: flutter.map(|(normal, pair)| Flutter {
                max_imaginary_speed: (unit * pair.squared_growth()).sqrt(),
                squared_speed: Complex64::new(pair.mean, (-pair.squared_half_difference).sqrt())
                    * unit,
                normal,
            }),
            slowest: SlowestSpeed {
                squared_speed: value * unit,
                normal,
                rounding: 64.0 * f64::EPSILON * (1.0 + update.max_norm_product) * unit,
            },
        }
    }

    /// Refines the smallest c² and the strongest flutter of the coarse grid, and further local extrema that may exceed
    /// them.
    fn refine_coarse_extremes(
        &self,
        tensor_update: &TensorUpdate,
        coarse_roots: &[SecularRoots],
        squared_growth: &[f64],
        best: &mut ScaledExtremes,
    ) {
        let grid = self.grid();
        let (least, most) = coarse_roots.iter().zip(squared_growth.iter()).enumerate().fold(
            (0, 0),
            |(least, most), (place, (roots, &own))| {
                let least = if roots.smallest_real < coarse_roots[least].smallest_real {
                    place
                } else {
                    least
                };
                (least, if own > squared_growth[most] { place } else { most })
            },
        );
        if !best.is_bounded || coarse_roots[least].smallest_real < best.slowest.1 {
            let point = grid.coarse_points[least] as usize;
            self.refine_slowest(tensor_update, point, COARSE_SUBDIVISIONS, best);
        }
        if coarse_roots[most].critical_pair.is_some() {
            self.refine_flutter(
                tensor_update,
                grid.coarse_points[most] as usize,
                COARSE_SUBDIVISIONS,
                best,
            );
        }
        for place in 0..coarse_roots.len() {
            let neighbour_values = &grid.coarse_neighbours[place];
            // Between a grid point and half the distance to its neighbours a quadratic changes by a quarter of the
            // difference; eight times as much is allowed for.
            let own = coarse_roots[place].smallest_real;
            let (lowest, highest) = min_and_max(
                neighbour_values
                    .iter()
                    .map(|&i| coarse_roots[i as usize].smallest_real)
                    .filter(|value| value.is_finite()),
            );
            if place != least && own <= lowest && own - 2.0 * (highest - own) < best.slowest.1 {
                self.refine_slowest(
                    tensor_update,
                    grid.coarse_points[place] as usize,
                    COARSE_SUBDIVISIONS,
                    best,
                );
            }
            let own = squared_growth[place];
            let (_, highest) =
                min_and_max(neighbour_values.iter().map(|&i| squared_growth[i as usize]));
            let finite = neighbour_values
                .iter()
                .map(|&i| squared_growth[i as usize])
                .filter(|g| g.is_finite());
            let (lowest, _) = min_and_max(finite);
            let target = best.flutter.map_or(0.0, |(_, pair)| pair.squared_growth());
            if place != most
                && coarse_roots[place].critical_pair.is_some()
                && own >= highest
                && (lowest > own || own + 2.0 * (own - lowest) > target)
            {
                self.refine_flutter(
                    tensor_update,
                    grid.coarse_points[place] as usize,
                    COARSE_SUBDIVISIONS,
                    best,
                );
            }
        }
    }

    /// Searches the fine grid for complex speeds missed by the coarse grid and for c² below the smallest so far.
    fn search_fine_grid(
        &self,
        tensor_update: &TensorUpdate,
        coarse_roots: &[SecularRoots],
        squared_growth: &[f64],
        best: &mut ScaledExtremes,
    ) {
        let grid = self.grid();
        let mut products = [[0.0; LANES]; MAX_VELOCITIES];
        let mut flags = [false; LANES];
        let mut thresholds = [0.0; LANES];
        let mut found = [(0, f64::NEG_INFINITY); 8];
        for (index, chunk) in grid.chunks.iter().enumerate() {
            let mut parents = grid.coarse_parents[index * LANES..].iter().take(LANES);
            if best.is_bounded && parents.all(|&parent| coarse_roots[parent as usize].is_complex) {
                continue;
            }
            let target = best.slowest.1 - 1e-12;
            self.compute_weight_products(tensor_update, index, &mut products, &mut thresholds);
            // At the smallest c² so far, if it is below all λ_g, a negative 1 − Σ w_g/(λ_g − λ) proves that a smaller
            // root exists.
            let mut sides = [1.0; LANES];
            let mut lowest = [0.0_f64; LANES];
            let mut is_above = [false; LANES];
            for (products, values) in
                products.iter().zip(&chunk.squared_speed).take(self.velocity_count)
            {
                for lane in 0..LANES {
                    sides[lane] -= products[lane] / (values[lane] - target);
                    lowest[lane] = lowest[lane].min(products[lane] + thresholds[lane]);
                    is_above[lane] |= values[lane] <= target;
                }
            }
            if best.is_bounded {
                (sides, is_above) = ([1.0; LANES], [false; LANES]);
            }
            for lane in 0..LANES {
                flags[lane] = (lowest[lane] < 0.0) | (sides[lane] < 0.0) | is_above[lane];
            }
            for lane in (0..LANES).filter(|&lane| flags[lane]) {
                let place = index * LANES + lane;
                if place >= grid.normals.len() {
                    continue;
                }
                let seeks_slower = sides[lane] < 0.0 || is_above[lane];
                let parent_place = grid.coarse_parents[place] as usize;
                let parent = &coarse_roots[parent_place];
                if parent.is_complex && !seeks_slower {
                    continue;
                }
                let own: [f64; MAX_VELOCITIES] = std::array::from_fn(|k| products[k][lane]);
                let secular = assemble_secular_equation(
                    &grid.groups[place],
                    &own[..self.velocity_count],
                    thresholds[lane],
                );
                if seeks_slower {
                    let least = secular.solve_roots().smallest_real;
                    if least < best.slowest.1 - 1e-12 {
                        self.refine_slowest(tensor_update, place, FINE_SUBDIVISIONS, best);
                    }
                }
                if parent.is_complex || secular.pole_count < 2 || secular.sign_changes() < 3 {
                    continue;
                }
                let is_real_at =
                    |pair: EigenvaluePair| secular.has_real_roots_by_sign_at(pair.mean);
                if secular.pole_count > 2
                    && secular.sign_changes() == 3
                    && (parent.critical_pair.is_some_and(is_real_at)
                        || secular.has_real_roots_by_signs())
                {
                    continue;
                }
                let roots = secular.solve_roots();
                if let (true, Some(pair)) = (roots.is_complex, roots.critical_pair) {
                    // At the edge of a known cap growth rises towards its interior.
                    let own = pair.squared_growth();
                    let is_edge = grid.coarse_neighbours[parent_place].iter().any(|&i| {
                        coarse_roots[i as usize].is_complex && squared_growth[i as usize] > own
                    });
                    if !is_edge {
                        insert_strongest(&mut found, (place, own), &grid.coarse_parents);
                    }
                }
            }
        }
        for (place, _) in found.into_iter().filter(|found| found.1 > f64::NEG_INFINITY) {
            self.refine_flutter(tensor_update, place, FINE_SUBDIVISIONS, best);
        }
    }

    /// Products of the components of α and β along each eigenvector of Γₑ, for a chunk of directions; and the
    /// thresholds of zero for their sums, one for each direction.
    pub(super) fn compute_weight_products(
        &self,
        tensor_update: &TensorUpdate,
        index: usize,
        products: &mut [[f64; LANES]; MAX_VELOCITIES],
        thresholds: &mut [f64; LANES],
    ) {
        let grid = self.grid();
        let chunk = &grid.chunks[index];
        if let Some(waves) = &self.isotropic {
            return waves.compute_weights(tensor_update, &chunk.normal, products, thresholds);
        }
        let entries: usize = self.blocks.iter().map(|&(_, size)| size * size).sum();
        let eigenvectors = &grid.eigenvectors[index * entries..(index + 1) * entries];
        let [x, y, z] = &chunk.normal;
        let (mut squares, mut other_squares) = ([0.0; LANES], [0.0; LANES]);
        let mut entry = 0;
        for &(first, size) in &self.blocks {
            let (mut alpha, mut beta) =
                ([[0.0; LANES]; MAX_VELOCITIES], [[0.0; LANES]; MAX_VELOCITIES]);
            for velocity in first..first + size {
                let (a, b) = (&tensor_update.alpha[velocity], &tensor_update.beta[velocity]);
                let (mut own_alpha, mut own_beta) = ([0.0; LANES], [0.0; LANES]);
                for lane in 0..LANES {
                    own_alpha[lane] = a[0] * x[lane] + a[1] * y[lane] + a[2] * z[lane];
                    own_beta[lane] = b[0] * x[lane] + b[1] * y[lane] + b[2] * z[lane];
                }
                for lane in 0..LANES {
                    squares[lane] += own_alpha[lane] * own_alpha[lane];
                    other_squares[lane] += own_beta[lane] * own_beta[lane];
                }
                for k in 0..size {
                    let basis = &eigenvectors[entry];
                    for lane in 0..LANES {
                        alpha[k][lane] += basis[lane] * own_alpha[lane];
                        beta[k][lane] += basis[lane] * own_beta[lane];
                    }
                    entry += 1;
                }
            }
            for k in 0..size {
                for lane in 0..LANES {
                    products[first + k][lane] = alpha[k][lane] * beta[k][lane];
                }
            }
        }
        for lane in 0..LANES {
            thresholds[lane] = WEIGHT_TOLERANCE * (squares[lane] * other_squares[lane]).sqrt();
        }
    }

    /// Relevant eigenvalues of Γ = Γₑ − αβᵀ at `normal`; fast if `nearby_basis` is close to the eigenvectors of Γₑ
    /// there.
    fn solve_roots_near(
        &self,
        tensor_update: &TensorUpdate,
        nearby_basis: &Eigenbasis,
        normal: &[f64; 3],
    ) -> SecularRoots {
        self.secular_equation_near(tensor_update, nearby_basis, normal).solve_roots()
    }

    /// Minimises the smallest real eigenvalue of Γ over the wave normal, starting at the grid point `place`, and
    /// updates `best`; `frequency` is the number of subdivisions of the grid.
    fn refine_slowest(
        &self,
        tensor_update: &TensorUpdate,
        place: usize,
        frequency: usize,
        best: &mut ScaledExtremes,
    ) {
        let nearby_basis = self.grid().eigenbasis_at(place);
        let function = |normal: &[f64; 3]| {
            self.solve_roots_near(tensor_update, &nearby_basis, normal).smallest_real
        };
        let radius = 1.3 / frequency as f64;
        let found = minimise(self.grid().normals[place], radius, best.slowest.1, function);
        if found.1 < best.slowest.1 {
            best.slowest = found;
        }
    }

    /// Maximises (Im c)² of flutter over the wave normal, starting at the grid point `place`, and updates `best`;
    /// `frequency` is the number of subdivisions of the grid.
    fn refine_flutter(
        &self,
        tensor_update: &TensorUpdate,
        place: usize,
        frequency: usize,
        best: &mut ScaledExtremes,
    ) {
        let nearby_basis = self.grid().eigenbasis_at(place);
        let target = best.flutter.map_or(0.0, |(_, pair)| pair.squared_growth());
        let function = |normal: &[f64; 3]| {
            let roots = self.solve_roots_near(tensor_update, &nearby_basis, normal);
            roots.critical_pair.map_or(f64::INFINITY, |pair| -pair.squared_growth())
        };
        let radius = 1.3 / frequency as f64;
        let (normal, value) = minimise(self.grid().normals[place], radius, -target, function);
        let roots = self.solve_roots_near(tensor_update, &nearby_basis, &normal);
        if let (true, true, Some(pair)) = (-value > target, roots.is_complex, roots.critical_pair) {
            best.flutter = Some((normal, pair));
        }
    }
}

/// Inserts a direction (grid point, (Im c)²) into `list`, which is sorted by descending (Im c)². Of directions with the
/// same nearest point of the coarse grid only the strongest is kept; the weakest direction drops out.
fn insert_strongest(list: &mut [(usize, f64)], own: (usize, f64), coarse_parents: &[u32]) {
    let same = |other: &(usize, f64)| {
        other.1 > f64::NEG_INFINITY && coarse_parents[other.0] == coarse_parents[own.0]
    };
    let end = list.iter().position(same).unwrap_or(list.len() - 1);
    if own.1 > list[end].1 {
        list[end] = own;
        let place = list[..end].iter().take_while(|other| other.1 >= own.1).count();
        list[place..=end].rotate_right(1);
    }
}

/// Slowest wave (normal, c²) and strongest flutter (normal, eigenvalue pair) known so far, in scaled units.
struct ScaledExtremes {
    slowest: ([f64; 3], f64),
    /// Whether directions with a single root below the poles have no slower wave.
    is_bounded: bool,
    flutter: Option<([f64; 3], EigenvaluePair)>,
}

/// Minimum and maximum of `values`.
fn min_and_max(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}
