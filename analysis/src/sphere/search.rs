//! Search for the strongest flutter and the slowest wave over all wave normals in space.

use super::change::{Change, NO_WEIGHT};
use super::eigenbasis::{Basis, Groups, SIZE};
use super::elastic_waves::{AcousticTensor3, LANES};
use super::error::SphereError;
use super::extremes::{Extremes, Flutter, Slowest};
use super::geodesic_grid::{COARSE, FINE};
use super::minimise::minimise;
use super::rank_one::RankOne;
use super::secular_equation::secular;
use super::secular_roots::{RootPair, SecularRoots};
use num_complex::Complex64;

/// Reusable memory of [`AcousticTensor3::search`].
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(super) coarse: Vec<SecularRoots>,
    pub(super) growth: Vec<f64>,
}

impl AcousticTensor3 {
    /// Creates a workspace for [`search`](Self::search); use one per thread.
    pub fn workspace(&self) -> Workspace {
        let none = SecularRoots { least: f64::INFINITY, pair: None, is_complex: false };
        Workspace {
            coarse: vec![none; self.coarse.len()],
            growth: vec![f64::NEG_INFINITY; self.coarse.len()],
        }
    }

    /// Strongest flutter and slowest real wave over all directions, to 1e-9 rad where they are smooth functions of the
    /// direction, or to the rounding of their values.
    ///
    /// Flutter in a cap that contains a circle of radius [`COVERING_RADIUS`](Self::COVERING_RADIUS) is always found,
    /// since a grid point lies in it. Smaller caps are found from the directions in which two real eigenvalues are
    /// closest. (Im c²)² below 1e-13 of the squared speeds involved counts as rounding.
    ///
    /// # Errors
    /// A vector has the wrong length or is not finite.
    pub fn search(
        &self,
        update: &RankOne,
        workspace: &mut Workspace,
    ) -> Result<Extremes, SphereError> {
        let change = self.change(update)?;
        if workspace.coarse.len() != self.coarse.len() {
            *workspace = self.workspace();
        }
        let Workspace { coarse, growth } = workspace;
        for (place, (roots, growth)) in coarse.iter_mut().zip(growth.iter_mut()).enumerate() {
            let index = self.coarse[place] as usize;
            let normal = &self.normals[index];
            *roots = change.at(normal, &self.basis(index), &self.groups[index]).roots();
            *growth = roots.pair.map_or(f64::NEG_INFINITY, |pair| pair.growth_squared());
        }

        let mut best = ScaledExtremes { slowest: (self.normals[0], f64::INFINITY), flutter: None };
        let (least, most) = coarse.iter().zip(growth.iter()).enumerate().fold(
            (0, 0),
            |(least, most), (place, (roots, &own))| {
                let least = if roots.least < coarse[least].least { place } else { least };
                (least, if own > growth[most] { place } else { most })
            },
        );
        self.refine_slowest(&change, self.coarse[least] as usize, COARSE, &mut best);
        if coarse[most].pair.is_some() {
            self.refine_flutter(&change, self.coarse[most] as usize, COARSE, &mut best);
        }
        for place in 0..coarse.len() {
            let around = &self.neighbours[place];
            // Between a grid point and half the distance to its neighbours a quadratic changes by a quarter of the
            // difference; eight times as much is allowed for.
            let own = coarse[place].least;
            let (lowest, highest) = bounds(around.iter().map(|&i| coarse[i as usize].least));
            if place != least && own <= lowest && own - 2.0 * (highest - own) < best.slowest.1 {
                self.refine_slowest(&change, self.coarse[place] as usize, COARSE, &mut best);
            }
            let own = growth[place];
            let (_, highest) = bounds(around.iter().map(|&i| growth[i as usize]));
            let finite = around.iter().map(|&i| growth[i as usize]).filter(|g| g.is_finite());
            let (lowest, _) = bounds(finite);
            let goal = best.flutter.map_or(0.0, |(_, pair)| pair.growth_squared());
            if place != most
                && coarse[place].pair.is_some()
                && own >= highest
                && (lowest > own || own + 2.0 * (own - lowest) > goal)
            {
                self.refine_flutter(&change, self.coarse[place] as usize, COARSE, &mut best);
            }
        }
        self.search_between(&change, coarse, &mut best);

        let (normal, value) = best.slowest;
        Ok(Extremes {
            flutter: best.flutter.map(|(normal, pair)| Flutter {
                growth: (self.unit * pair.growth_squared()).sqrt(),
                speed_squared: Complex64::new(pair.middle, (-pair.square).sqrt()) * self.unit,
                normal,
            }),
            slowest: Slowest {
                speed_squared: value * self.unit,
                normal,
                rounding: 64.0 * f64::EPSILON * (1.0 + change.largest) * self.unit,
            },
        })
    }

    /// Searches the fine grid for complex speeds missed by the coarse grid and for c² below the smallest so far.
    fn search_between(&self, change: &Change, coarse: &[SecularRoots], best: &mut ScaledExtremes) {
        let mut products = [[0.0; LANES]; SIZE];
        let mut flags = [false; LANES];
        let mut tiny = [0.0; LANES];
        let mut found = [(0, f64::NEG_INFINITY); 8];
        for (index, chunk) in self.chunks.iter().enumerate() {
            let target = best.slowest.1 - 1e-12;
            self.products(change, index, &mut products, &mut tiny);
            // At the smallest c² so far, if it is below all λ_g, a negative 1 − Σ w_g/(λ_g − λ) proves that a smaller
            // root exists.
            let mut sides = [1.0; LANES];
            let mut lowest = [0.0_f64; LANES];
            let mut is_above = [false; LANES];
            for (products, values) in products.iter().zip(&chunk.speed_squared).take(self.size) {
                for lane in 0..LANES {
                    sides[lane] -= products[lane] / (values[lane] - target);
                    lowest[lane] = lowest[lane].min(products[lane] + tiny[lane]);
                    is_above[lane] |= values[lane] <= target;
                }
            }
            for lane in 0..LANES {
                flags[lane] = (lowest[lane] < 0.0) | (sides[lane] < 0.0) | is_above[lane];
            }
            for lane in (0..LANES).filter(|&lane| flags[lane]) {
                let place = index * LANES + lane;
                if place >= self.normals.len() {
                    continue;
                }
                let own: [f64; SIZE] = std::array::from_fn(|k| products[k][lane]);
                let secular = secular(&self.groups[place], &own[..self.size], tiny[lane]);
                if sides[lane] < 0.0 || is_above[lane] {
                    let least = secular.roots().least;
                    if least < best.slowest.1 - 1e-12 {
                        self.refine_slowest(change, place, FINE, best);
                    }
                }
                let parent = &coarse[self.parents[place] as usize];
                if parent.is_complex || secular.count < 2 || secular.changes() < 3 {
                    continue;
                }
                if secular.count > 2
                    && secular.changes() == 3
                    && parent.pair.is_some_and(|pair| secular.is_real_by(pair.middle))
                {
                    continue;
                }
                let roots = secular.roots();
                if let (true, Some(pair)) = (roots.is_complex, roots.pair) {
                    keep_strongest(&mut found, (place, pair.growth_squared()), &self.parents);
                }
            }
        }
        for (place, _) in found.into_iter().filter(|found| found.1 > f64::NEG_INFINITY) {
            self.refine_flutter(change, place, FINE, best);
        }
    }

    /// Products α̂β̂ in the eigenbasis of Γₑ, per eigenvalue, for a chunk of directions.
    pub(super) fn products(
        &self,
        change: &Change,
        index: usize,
        products: &mut [[f64; LANES]; SIZE],
        tiny: &mut [f64; LANES],
    ) {
        let chunk = &self.chunks[index];
        let entries: usize = self.blocks.iter().map(|&(_, size)| size * size).sum();
        let bases = &self.bases[index * entries..(index + 1) * entries];
        let [x, y, z] = &chunk.normal;
        let (mut squares, mut other_squares) = ([0.0; LANES], [0.0; LANES]);
        let mut entry = 0;
        for &(first, size) in &self.blocks {
            let (mut alpha, mut beta) = ([[0.0; LANES]; SIZE], [[0.0; LANES]; SIZE]);
            for velocity in first..first + size {
                let (a, b) = (&change.alpha[velocity], &change.beta[velocity]);
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
                    let basis = &bases[entry];
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
            tiny[lane] = NO_WEIGHT * (squares[lane] * other_squares[lane]).sqrt();
        }
    }

    /// Eigenvalues at `normal`; fast if `near` is close to the eigenvectors of Γₑ there.
    fn roots_near(&self, change: &Change, near: &Basis, normal: &[f64; 3]) -> SecularRoots {
        let (values, basis) = self.elastic(normal, near);
        change.at(normal, &basis, &Groups::new(&values[..self.size])).roots()
    }

    /// Minimises the smallest real eigenvalue from the grid point `place` and updates `best`; `frequency` is the
    /// number of subdivisions of the grid.
    fn refine_slowest(
        &self,
        change: &Change,
        place: usize,
        frequency: usize,
        best: &mut ScaledExtremes,
    ) {
        let near = self.basis(place);
        let function = |normal: &[f64; 3]| self.roots_near(change, &near, normal).least;
        let radius = 1.3 / frequency as f64;
        let found = minimise(self.normals[place], radius, best.slowest.1, function);
        if found.1 < best.slowest.1 {
            best.slowest = found;
        }
    }

    /// Maximises the growth of flutter from the grid point `place` and updates `best`; `frequency` is the number of
    /// subdivisions of the grid.
    fn refine_flutter(
        &self,
        change: &Change,
        place: usize,
        frequency: usize,
        best: &mut ScaledExtremes,
    ) {
        let near = self.basis(place);
        let goal = best.flutter.map_or(0.0, |(_, pair)| pair.growth_squared());
        let function = |normal: &[f64; 3]| {
            let roots = self.roots_near(change, &near, normal);
            roots.pair.map_or(f64::INFINITY, |pair| -pair.growth_squared())
        };
        let radius = 1.3 / frequency as f64;
        let (normal, value) = minimise(self.normals[place], radius, -goal, function);
        let roots = self.roots_near(change, &near, &normal);
        if let (true, true, Some(pair)) = (-value > goal, roots.is_complex, roots.pair) {
            best.flutter = Some((normal, pair));
        }
    }
}

/// Inserts a direction into the descending list unless one with the same parent is stronger.
fn keep_strongest(list: &mut [(usize, f64)], own: (usize, f64), parents: &[u32]) {
    let same =
        |other: &(usize, f64)| other.1 > f64::NEG_INFINITY && parents[other.0] == parents[own.0];
    let end = list.iter().position(same).unwrap_or(list.len() - 1);
    if own.1 > list[end].1 {
        list[end] = own;
        let place = list[..end].iter().take_while(|other| other.1 >= own.1).count();
        list[place..=end].rotate_right(1);
    }
}

/// Slowest wave (normal, c²) and strongest flutter (normal, pair) so far, in scaled units.
struct ScaledExtremes {
    pub(super) slowest: ([f64; 3], f64),
    pub(super) flutter: Option<([f64; 3], RootPair)>,
}

/// Minimum and maximum of `values`.
fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}
