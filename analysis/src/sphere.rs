//! Flutter and shear bands of a yielding solid in space, over all directions of the wave normal.
//!
//! One active yield condition changes the elastic stiffness D by a matrix of rank one, `D − a bᵀ` with
//! `a = D m/(H + n·Dm)` and `b = D n` (Rudnicki & Rice 1975; Rice 1976). Waves with the unit normal n
//! have the speeds c given by
//!
//! ```text
//! c² ∈ spectrum of Γ(n) = Γₑ(n) − α(n) β(n)ᵀ,   Γₑ = M^(−½) G(n)ᵀ D G(n) M^(−½),
//! α = M^(−½) G(n)ᵀ a,   β = M^(−½) G(n)ᵀ b,   G(n) = Σ nᵢ Gⁱ.
//! ```
//!
//! Γₑ is symmetric. In its eigenbasis, with equal eigenvalues λ_g put together, an eigenvalue of
//! multiplicity m stays m − 1 times, and the others solve the secular equation
//!
//! ```text
//! 1 = Σ w_g/(λ_g − λ),   w_g = the part of α·β that lies in the eigenspace of λ_g.
//! ```
//!
//! Write the signs of the w_g in the order of the λ_g between a + in front and a − behind. Between two
//! equal signs next to each other the two sides of the equation cross at least once, so that with only
//! one change of sign all eigenvalues are real. **Flutter takes a negative weight on a slower wave and a
//! positive one on a faster wave.** Under associated flow all w_g ≥ 0. An isotropic classical solid whose
//! m and n differ by an isotropic tensor alone (Drucker–Prager) has w ≥ 0 on the shear waves, which are
//! the slower ones: no flutter either (Loret, Prevost & Harireche 1990).
//!
//! The search starts on a geodesic grid ([`Sphere::COVERING_RADIUS`]), on which the eigenbases of Γₑ are
//! computed once per elastic solid, and ends with Newton's method in the tangent plane. Short waves grow
//! as Re ς ≈ |Im c| k.
//!
//! Sources: J. W. Rudnicki & J. R. Rice, J. Mech. Phys. Solids 23 (1975) 371–394; J. R. Rice, The
//! localization of plastic deformation, 14th IUTAM Congress (1976); B. Loret, J. H. Prevost &
//! O. Harireche, Eur. J. Mech. A 9 (1990) 225–231; G. H. Golub, SIAM Review 15 (1973) 318–334.

use models::common::elementary::cr_from_polar;
use models::common::product::triple_product;
use models::common::rates::RateEquations;
use nalgebra::DMatrix;
use num_complex::Complex64;
use std::collections::HashMap;

/// Velocities at most.
const SIZE: usize = 6;
/// Directions that the inner loops take at a time.
const LANES: usize = 32;
/// Subdivisions of an edge of the icosahedron: of the grid, and of its part where everything is computed.
const FINE: usize = 51;
const COARSE: usize = 17;
/// Neighbours of a point of the geodesic grid.
const NEIGHBOURS: usize = 6;
/// Eigenvalues of Γₑ closer than this, relative to the larger, count as equal.
const EQUAL: f64 = 1e-10;
/// Weights below this part of the largest number in the secular equation may change sign on the way to the
/// next direction of the coarse grid.
const SLIGHT: f64 = 0.004;
/// Roots of such directions farther apart than this, in the same unit, do not meet before that.
const REACH: f64 = 0.1;
/// Weights below this part of |α||β| count as zero.
const NO_WEIGHT: f64 = 1e-15;
/// (Im λ)² below this part of the square of the largest number in the secular equation is rounding.
const NO_FLUTTER: f64 = 1e-13;

/// An elastic solid, or a change of its stiffness, that cannot be searched.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SphereError {
    /// Too many velocities.
    #[error("{0} velocities: waves in space are searched for solids with at most {SIZE}")]
    TooLarge(usize),
    /// A number overflowed.
    #[error("a coefficient of the solid is not finite: its numbers are too large or too small")]
    NotFinite,
    /// Vectors and stiffness do not belong together.
    #[error("{given} components are given for {needed} stresses")]
    Mismatch {
        /// Components given.
        given: usize,
        /// Stresses of the solid.
        needed: usize,
    },
    /// The elastic stiffness does not make waves of every direction and polarisation.
    #[error(
        "the elastic solid has no waves with the normal ({}, {}, {}): its least c² is {speed_squared:e} \
         m²/s² and must be positive", normal[0], normal[1], normal[2]
    )]
    NotElastic {
        /// The wave normal.
        normal: [f64; 3],
        /// Least c², m²/s².
        speed_squared: f64,
    },
    /// The solid has no rate of response while it yields.
    #[error("no response while yielding: H + n·Dm = {0:e} Pa must be positive")]
    NoResponse(f64),
}

/// The change −a bᵀ of the stiffness while one yield condition is active.
#[derive(Clone, Debug, PartialEq)]
pub struct RankOne {
    /// a = D m/(H + n·Dm), dimensionless where the gradients of the condition are.
    pub image: Vec<f64>,
    /// b = D n, in the units of the stiffness.
    pub covector: Vec<f64>,
}

impl RankOne {
    /// The change that a condition makes with its gradient n, the direction m of plastic flow, both by
    /// the stresses of `elastic`, and the plastic modulus H, Pa.
    ///
    /// # Errors
    /// Vectors of another length; H + n·Dm that is not positive.
    pub fn new(
        elastic: &RateEquations<3>,
        normal: &[f64],
        flow: &[f64],
        hardening: f64,
    ) -> Result<Self, SphereError> {
        let needed = elastic.stresses();
        for vector in [normal, flow] {
            if vector.len() != needed {
                return Err(SphereError::Mismatch { given: vector.len(), needed });
            }
        }
        let product = |vector: &[f64]| -> Vec<f64> {
            let row = |i| (0..needed).map(|j| elastic.stiffness[(i, j)].value * vector[j]).sum();
            (0..needed).map(row).collect()
        };
        let (mut image, covector) = (product(flow), product(normal));
        let response = hardening + normal.iter().zip(&image).map(|(n, d)| n * d).sum::<f64>();
        if response.is_nan() {
            return Err(SphereError::NotFinite);
        }
        if response <= 0.0 {
            return Err(SphereError::NoResponse(response));
        }
        for component in &mut image {
            *component /= response;
        }
        Ok(Self { image, covector })
    }
}

/// The strongest flutter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flutter {
    /// Supremum of |Im c| over the directions with complex c², m/s: short waves grow as this times k.
    pub growth: f64,
    /// c² there, m²/s²; the conjugate is a c² too.
    pub speed_squared: Complex64,
    /// The wave normal.
    pub normal: [f64; 3],
}

/// The slowest wave among those with real c².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slowest {
    /// Least real c², m²/s². Zero is a stationary discontinuity, the onset of a shear band; below, waves
    /// grow as √(−c²) k. Infinite if no direction has a real c².
    pub speed_squared: f64,
    /// The wave normal, which is the normal of the band.
    pub normal: [f64; 3],
    /// How far rounding may have moved `speed_squared`, m²/s².
    pub rounding: f64,
}

/// What was found over all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Flutter, if there is any.
    pub flutter: Option<Flutter>,
    /// The least real c².
    pub slowest: Slowest,
}

impl Extremes {
    /// The greater |Im c| of flutter and of negative c², m/s; 0 without either.
    pub fn growth(&self) -> f64 {
        let divergence = (-self.slowest.speed_squared).max(0.0).sqrt();
        self.flutter.map_or(divergence, |flutter| flutter.growth.max(divergence))
    }
}

/// The directions of an elastic solid and its waves in them; serves every [`RankOne`] change of that
/// solid's stiffness, from any thread.
///
/// Speeds are in units of the fastest elastic wave of the grid. Velocities that no gradient strains
/// (the spins of a reduced Cosserat solid) carry no waves and are left out.
#[derive(Clone, Debug)]
pub struct Sphere {
    /// (Fastest elastic wave)², m²/s².
    unit: f64,
    stresses: usize,
    /// Velocities that carry waves, blocks that do not act on each other one after the other.
    size: usize,
    /// First velocity and size of the blocks.
    blocks: Vec<(usize, usize)>,
    /// M^(−½) Gⁱᵀ by the three axes: velocities × stresses, in units of √unit.
    balance: [DMatrix<f64>; 3],
    /// Γₑ(n) = Σ over pairs of axes nᵢnⱼ T: 11, 22, 33, 23, 13, 12.
    acoustic: [[[f64; SIZE]; SIZE]; 6],
    /// Wave normals.
    normals: Vec<[f64; 3]>,
    /// How eigenvalues go together at each of `normals`.
    groups: Vec<Groups>,
    /// The point of the coarse grid, by its place in `coarse`, next to each of `normals`.
    parents: Vec<u32>,
    /// The coarse grid, by places in `normals`.
    coarse: Vec<u32>,
    /// Its neighbours, by places in `coarse`; fewer than six repeat the first.
    neighbours: Vec<[u32; NEIGHBOURS]>,
    /// The same as structure of arrays.
    chunks: Vec<Chunk>,
    /// Eigenvectors of each chunk, block after block: by velocity, then by eigenvalue.
    bases: Vec<[f64; LANES]>,
}

#[derive(Clone, Debug)]
struct Chunk {
    normal: [[f64; LANES]; 3],
    speed_squared: [[f64; LANES]; SIZE],
}

/// Different eigenvalues of Γₑ in a direction.
#[derive(Clone, Copy, Debug, Default)]
struct Groups {
    count: usize,
    value: [f64; SIZE],
    multiplicity: [u8; SIZE],
    /// The group of each eigenvalue.
    of: [u8; SIZE],
}

/// What [`Sphere::search`] needs room for.
#[derive(Clone, Debug)]
pub struct Workspace {
    coarse: Vec<Roots>,
    growth: Vec<f64>,
}

/// α and β as linear functions of the wave normal.
struct Change {
    size: usize,
    alpha: [[f64; 3]; SIZE],
    beta: [[f64; 3]; SIZE],
    /// A bound on |α||β| over all normals.
    largest: f64,
}

/// Γₑ's eigenvectors in a direction.
type Basis = [[f64; SIZE]; SIZE];

/// The secular equation 1 = Σ w/(λ_g − λ) of a direction, weights that vanish left out.
#[derive(Clone, Copy, Debug, Default)]
struct Secular {
    count: usize,
    pole: [f64; SIZE],
    weight: [f64; SIZE],
    /// Eigenvalues that stay.
    kept: [f64; SIZE],
    kept_count: usize,
}

/// A pair of eigenvalues `middle` ± √`square`, complex for `square` < 0.
#[derive(Clone, Copy, Debug)]
struct Pair {
    middle: f64,
    square: f64,
}

/// What counts among the eigenvalues of a direction.
#[derive(Clone, Copy, Debug)]
struct Roots {
    /// The least real one; infinite if there is none.
    least: f64,
    /// The pair that is complex or nearest to becoming so, if one can.
    pair: Option<Pair>,
    is_complex: bool,
}

impl Pair {
    /// (Im c)² = (|λ| − Re λ)/2, and its analytic continuation to real pairs of positive middle, where
    /// it is negative. Real pairs of negative middle do not flutter: negative too.
    fn growth_squared(&self) -> f64 {
        if self.square >= 0.0 && self.middle <= 0.0 {
            return -self.square;
        }
        let modulus = (self.middle * self.middle - self.square).max(0.0).sqrt();
        if self.middle > 0.0 {
            // Without cancellation.
            -0.5 * self.square / (modulus + self.middle)
        } else {
            0.5 * (modulus - self.middle)
        }
    }
}

impl Secular {
    /// q(x) = Π(x − λ_g) + Σ w_g Π over h ≠ g (x − λ_h), which vanishes at the eigenvalues, and q′.
    fn polynomial(&self, x: f64) -> (f64, f64) {
        let (mut product, mut product_slope, mut sum, mut sum_slope) = (1.0, 0.0, 0.0, 0.0);
        for (pole, weight) in self.pole.iter().zip(&self.weight).take(self.count) {
            let distance = x - pole;
            sum_slope = sum_slope * distance + sum + weight * product_slope;
            sum = sum * distance + weight * product;
            product_slope = product_slope * distance + product;
            product *= distance;
        }
        (product + sum, product_slope + sum_slope)
    }

    fn complex_polynomial(&self, x: Complex64) -> (Complex64, Complex64) {
        let [zero, one] = [Complex64::new(0.0, 0.0), Complex64::new(1.0, 0.0)];
        let (mut product, mut product_slope, mut sum, mut sum_slope) = (one, zero, zero, zero);
        for (pole, weight) in self.pole.iter().zip(&self.weight).take(self.count) {
            let distance = x - pole;
            sum_slope = sum_slope * distance + sum + product_slope * weight;
            sum = sum * distance + product * weight;
            product_slope = product_slope * distance + product;
            product *= distance;
        }
        (product + sum, product_slope + sum_slope)
    }

    /// Changes of sign of +, w₁ … w_g, −: with one, all eigenvalues are real; with three, all but two.
    fn changes(&self) -> usize {
        let (mut changes, mut positive) = (0, true);
        for &weight in &self.weight[..self.count] {
            if (weight > 0.0) != positive {
                changes += 1;
                positive = !positive;
            }
        }
        changes + usize::from(positive)
    }

    /// Largest of the numbers in the equation.
    fn size(&self) -> f64 {
        let all = self.pole[..self.count].iter().chain(&self.weight[..self.count]);
        all.fold(0.0, |largest: f64, x| largest.max(x.abs()))
    }

    /// The interval below pole `index`, with bounds on the roots outside the poles.
    fn interval(&self, index: usize) -> (f64, f64) {
        let part = |sign: f64| {
            self.weight[..self.count].iter().fold(0.0, |sum, w| sum + (sign * w).max(0.0))
        };
        let low = if index == 0 { self.pole[0] - part(1.0) } else { self.pole[index - 1] };
        let high =
            if index == self.count { self.pole[index - 1] + part(-1.0) } else { self.pole[index] };
        (low, high)
    }

    /// Whether the interval below pole `index` has an odd number of roots.
    fn is_odd(&self, index: usize) -> bool {
        let below = index == 0 || self.weight[index - 1] > 0.0;
        let above = index < self.count && self.weight[index] > 0.0;
        below == above
    }

    /// The sign of q at the upper end of the interval below pole `index`.
    fn sign_above(&self, index: usize) -> f64 {
        // Σ w_g Π(λ_index − λ_h): one factor is negative for each pole above.
        if index == self.count {
            return 1.0;
        }
        let flips = (self.count - 1 - index) % 2 == 1;
        if (self.weight[index] > 0.0) == flips { -1.0 } else { 1.0 }
    }

    /// A step from `x` towards the root of the interval below pole `index`: the zero of
    /// c + a/(λ_below − y) + b/(λ_above − y) that has the values and slopes of the sums over the poles
    /// below and above (R.-C. Li 1993, "Solving secular equations stably and efficiently"). Not a number
    /// where that has none.
    fn rational_step(&self, index: usize, x: f64) -> f64 {
        let (mut value, mut below, mut above) = (1.0, 0.0, 0.0);
        // Over all, with weights of zero beyond the last pole: as many divisions at a time as there are.
        let (mut parts, mut slopes) = ([0.0; SIZE], [0.0; SIZE]);
        for g in 0..SIZE {
            let inverse = 1.0 / (self.pole[g] - x);
            parts[g] = self.weight[g] * inverse;
            slopes[g] = parts[g] * inverse;
        }
        for g in 0..self.count {
            value -= parts[g];
            if g < index { below -= slopes[g] } else { above -= slopes[g] }
        }
        if index == 0 || index == self.count {
            // One pole: c + b/(λ − y).
            let (pole, slope) = match index {
                0 => (self.pole[0], above),
                _ => (self.pole[self.count - 1], below),
            };
            let distance = pole - x;
            return distance * value / (value - slope * distance);
        }
        let (left, right) = (self.pole[index - 1] - x, self.pole[index] - x);
        // c (l − s)(r − s) + a (r − s) + b (l − s) = 0 with a = ψ′l², b = φ′r² and the step s.
        let constant = value - below * left - above * right;
        let (a, b) = (below * left * left, above * right * right);
        let linear = constant * (left + right) + a + b;
        let last = value * left * right;
        let root = (linear * linear - 4.0 * constant * last).sqrt();
        // Of the two the one that vanishes with the value.
        2.0 * last / (linear + root.copysign(linear))
    }

    /// A root in an interval with an odd number of them: rational steps, then Newton's method, halving
    /// where it leaves. `size` is that of the [equation](Self::size), `is_simple` whether no interval has three.
    fn root(&self, index: usize, size: f64, is_simple: bool) -> f64 {
        let (mut low, mut high) = self.interval(index);
        let sign = self.sign_above(index);
        let is_inner = 0 < index && index < self.count;
        // Newton's method from below all roots comes to the least of them in one direction.
        let mut x = if index == 0 { low } else { 0.5 * (low + high) };
        if is_inner || is_simple {
            let mut from = x;
            for _ in 0..8 {
                let step = self.rational_step(index, from);
                let next = from + step;
                if !(next > low && next < high) {
                    break;
                }
                from = next;
                if step.abs() <= 3e-2 * (high - low) {
                    x = next;
                    break;
                }
            }
        }
        let mut last = high - low;
        let rounding = f64::EPSILON * size;
        for _ in 0..120 {
            let (value, slope) = self.polynomial(x);
            let step = value / slope;
            // Where the step is rounding the sign of q says no more.
            if value == 0.0 || step.abs() <= rounding {
                return if value == 0.0 { x } else { (x - step).clamp(low, high) };
            }
            if value * sign > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let mut next = x - step;
            if !(next > low && next < high && step.abs() <= 0.9 * last) {
                next = 0.5 * (low + high);
            }
            last = (next - x).abs();
            if last <= rounding || next == x {
                return next;
            }
            x = next;
        }
        x
    }

    /// The two roots that the equation of two poles has.
    fn quadratic(&self) -> Pair {
        let [first, second] = [self.pole[0] - self.weight[0], self.pole[1] - self.weight[1]];
        let half = 0.5 * (first - second);
        Pair {
            middle: 0.5 * (first + second),
            square: half * half + self.weight[0] * self.weight[1],
        }
    }

    /// The eigenvalues that matter.
    fn roots(&self) -> Roots {
        let mut least =
            self.kept[..self.kept_count].iter().fold(f64::INFINITY, |least, &x| least.min(x));
        let mut pair = None;
        match (self.count, self.changes()) {
            (0, _) => {}
            (1, _) => least = least.min(self.pole[0] - self.weight[0]),
            (2, _) => pair = Some(self.quadratic()),
            (_, 1) => {
                let least_index = usize::from(self.weight[0] < 0.0);
                let size = self.size();
                let slight = SLIGHT * size;
                if self.weight[..self.count].iter().all(|w| w.abs() > slight) {
                    least = least.min(self.root(least_index, size, true));
                } else {
                    // The sign of a slight weight may change next to here.
                    let is_slight = |pole: usize| {
                        self.weight[..self.count].get(pole).is_some_and(|w| w.abs() <= slight)
                    };
                    let mut previous = f64::NEG_INFINITY;
                    for index in (0..=self.count).filter(|&index| self.is_odd(index)) {
                        let is_beside = is_slight(index) || (index > 0 && is_slight(index - 1));
                        if !is_beside && index != least_index {
                            previous = f64::NEG_INFINITY;
                            continue;
                        }
                        let root = self.root(index, size, true);
                        if root - previous < REACH * size {
                            pair = self.nearer(pair, previous, root);
                        }
                        least = least.min(root);
                        previous = root;
                    }
                }
            }
            (_, 3) => {
                let (found, rest) = self.last_two();
                let found = &found[..self.count - 2];
                least = found.iter().fold(least, |least, &x| least.min(x));
                pair = Some(rest);
                if rest.square >= 0.0 {
                    // Of three roots in one interval any two may be the last.
                    let root = rest.square.sqrt();
                    least = least.min(rest.middle - root);
                    let last = [rest.middle - root, rest.middle + root];
                    for &x in found {
                        for y in last {
                            pair = self.nearer(pair, x, y);
                        }
                    }
                }
            }
            _ => {
                let all = self.all();
                let all = &all[..self.count];
                for (index, root) in all.iter().enumerate() {
                    let own = Pair { middle: root.re, square: -(root.im * root.im) };
                    if root.im == 0.0 {
                        least = least.min(root.re);
                        for other in all[..index].iter().filter(|other| other.im == 0.0) {
                            pair = self.nearer(pair, root.re, other.re);
                        }
                    } else if pair.is_none_or(|p| p.growth_squared() < own.growth_squared()) {
                        pair = Some(own);
                    }
                }
            }
        }
        let mut is_complex = false;
        if let Some(pair) = &pair {
            let size = self.size();
            is_complex = pair.square < -NO_FLUTTER * size * size;
            if !is_complex {
                // With two roots of one sign the smaller comes from their product.
                let root = pair.square.max(0.0).sqrt();
                least = least.min(pair.middle - root);
            }
        }
        Roots { least, pair, is_complex }
    }

    /// Two real roots without a pole of more than slight weight between them, if they are nearer to becoming complex than `pair`.
    fn nearer(&self, pair: Option<Pair>, x: f64, y: f64) -> Option<Pair> {
        let half = 0.5 * (x - y);
        let own = Pair { middle: 0.5 * (x + y), square: half * half };
        let slight = SLIGHT * self.size();
        let is_between =
            |(pole, weight): (&f64, &f64)| (pole - x) * (pole - y) < 0.0 && weight.abs() > slight;
        let is_far = pair.is_some_and(|pair| pair.growth_squared() >= own.growth_squared())
            || self.pole.iter().zip(&self.weight).take(self.count).any(is_between);
        if is_far { pair } else { Some(own) }
    }

    /// One root of each interval that must have one, and the other two by their sum and by q:
    /// −¼(difference)² = q(x)/Π(x − found) in the middle x between them.
    fn last_two(&self) -> ([f64; SIZE], Pair) {
        let (mut found, mut count) = ([0.0; SIZE], 0);
        let mut sum = 0.0;
        for index in 0..self.count {
            sum += self.pole[index] - self.weight[index];
        }
        let size = self.size();
        for index in 0..=self.count {
            if count < self.count - 2 && self.is_odd(index) {
                found[count] = self.root(index, size, false);
                sum -= found[count];
                count += 1;
            }
        }
        let mut middle = 0.5 * sum;
        // In the middle of three roots q says nothing: then beside it.
        let is_near = |x: f64| found[..count].iter().any(|f| (x - f).abs() <= 1e-7 * size);
        let mut shift = 0.0;
        while is_near(middle + shift) && shift < size {
            shift = if shift == 0.0 { 1e-3 * size } else { 2.0 * shift };
        }
        let at = middle + shift;
        let mut value = self.polynomial(at).0;
        for f in &found[..count] {
            value /= at - f;
        }
        let mut square = shift * shift - value;
        // The difference of large numbers made the sum; where the pair is complex and well apart Newton's
        // method makes up for it.
        if square < -1e-10 * size * size {
            let mut root = Complex64::new(middle, (-square).sqrt());
            for _ in 0..2 {
                let (value, slope) = self.complex_polynomial(root);
                let next = root - value / slope;
                if next.is_finite() && (next - root).norm() < 0.1 * root.im {
                    root = next;
                }
            }
            middle = root.re;
            square = -(root.im * root.im);
        }
        (found, Pair { middle, square })
    }

    /// All roots by Aberth's method; those within rounding of the real axis are put on it.
    fn all(&self) -> [Complex64; SIZE] {
        let mut roots = [Complex64::new(0.0, 0.0); SIZE];
        let size = self.size();
        for (index, root) in roots.iter_mut().enumerate().take(self.count) {
            let weight = self.weight[index].abs();
            *root = Complex64::new(self.pole[index], 0.0)
                + cr_from_polar(weight.max(1e-3 * size), 0.7 + 1.3 * index as f64);
        }
        for _ in 0..200 {
            let mut moved: f64 = 0.0;
            for index in 0..self.count {
                let x = roots[index];
                let (value, slope) = self.complex_polynomial(x);
                if value.norm() == 0.0 {
                    continue;
                }
                let mut repulsion = Complex64::new(0.0, 0.0);
                for other in (0..self.count).filter(|&other| other != index) {
                    repulsion += (x - roots[other]).inv();
                }
                let step = (slope / value - repulsion).inv();
                if step.is_finite() {
                    roots[index] = x - step;
                    moved = moved.max(step.norm());
                }
            }
            if moved <= 1e-15 * size {
                break;
            }
        }
        let limit = NO_FLUTTER.sqrt() * size;
        for root in &mut roots[..self.count] {
            if root.im.abs() <= limit {
                root.im = 0.0;
            }
        }
        roots
    }

    /// Whether a point proves that all eigenvalues are real: with three changes of sign, q of the other
    /// sign than at the ends of an interval with an even number of roots.
    fn is_real_by(&self, x: f64) -> bool {
        let index = self.pole[..self.count].iter().take_while(|&&pole| pole < x).count();
        !self.is_odd(index) && self.polynomial(x).0 * self.sign_above(index) < 0.0
    }
}

impl Change {
    fn at(&self, normal: &[f64; 3], basis: &Basis, groups: &Groups) -> Secular {
        let product = |row: &[f64; 3]| row[0] * normal[0] + row[1] * normal[1] + row[2] * normal[2];
        let (mut alpha, mut beta) = ([0.0; SIZE], [0.0; SIZE]);
        let rows = self.alpha.iter().zip(&self.beta).zip(basis).take(self.size);
        for ((own_alpha, own_beta), row) in rows {
            let (a, b) = (product(own_alpha), product(own_beta));
            for k in 0..self.size {
                alpha[k] += row[k] * a;
                beta[k] += row[k] * b;
            }
        }
        let mut products = [0.0; SIZE];
        for k in 0..self.size {
            products[k] = alpha[k] * beta[k];
        }
        let square = |x: &[f64; SIZE]| x.iter().fold(0.0, |sum, x| sum + x * x);
        secular(groups, &products[..self.size], NO_WEIGHT * (square(&alpha) * square(&beta)).sqrt())
    }
}

/// Puts the products αβ of equal eigenvalues together.
fn secular(groups: &Groups, products: &[f64], tiny: f64) -> Secular {
    let mut weight = [0.0; SIZE];
    for (&product, &group) in products.iter().zip(&groups.of) {
        weight[usize::from(group)] += product;
    }
    let mut secular = Secular::default();
    let members = groups.value.iter().zip(&groups.multiplicity).zip(&weight).take(groups.count);
    for ((&value, &multiplicity), &weight) in members {
        let is_free = weight.abs() <= tiny;
        for _ in usize::from(!is_free)..usize::from(multiplicity) {
            secular.kept[secular.kept_count] = value;
            secular.kept_count += 1;
        }
        if !is_free {
            secular.pole[secular.count] = value;
            secular.weight[secular.count] = weight;
            secular.count += 1;
        }
    }
    secular
}

impl Groups {
    fn new(eigenvalues: &[f64]) -> Self {
        let mut order: [usize; SIZE] = std::array::from_fn(|i| i);
        let order = &mut order[..eigenvalues.len()];
        order.sort_by(|&i, &j| eigenvalues[i].total_cmp(&eigenvalues[j]));
        let mut groups = Self::default();
        let mut previous = f64::NEG_INFINITY;
        for &index in order.iter() {
            let value = eigenvalues[index];
            if value - previous > EQUAL * value.abs() {
                groups.value[groups.count] = value;
                groups.count += 1;
            }
            previous = value;
            groups.of[index] = groups.count.saturating_sub(1) as u8;
            groups.multiplicity[groups.count.saturating_sub(1)] += 1;
        }
        groups
    }
}

/// Jacobi's method for the block of a symmetric matrix: its eigenvalues come to stand in the diagonal, in
/// ascending order, the eigenvectors into the columns of `basis`.
fn diagonalise(matrix: &mut Basis, basis: &mut Basis, (first, size): (usize, usize)) {
    let range = first..first + size;
    let trace = range.clone().fold(0.0, |sum, i| sum + matrix[i][i].abs());
    for _ in 0..40 {
        let mut is_done = true;
        for p in range.clone() {
            for q in p + 1..first + size {
                let entry = matrix[p][q];
                if entry.abs() <= 1e-18 * trace {
                    continue;
                }
                is_done = false;
                let ratio = (matrix[q][q] - matrix[p][p]) / (2.0 * entry);
                let tangent = ratio.signum() / (ratio.abs() + (1.0 + ratio * ratio).sqrt());
                let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
                let sine = tangent * cosine;
                matrix[p][p] -= tangent * entry;
                matrix[q][q] += tangent * entry;
                matrix[p][q] = 0.0;
                matrix[q][p] = 0.0;
                for i in range.clone() {
                    if i != p && i != q {
                        let (x, y) = (matrix[i][p], matrix[i][q]);
                        matrix[i][p] = cosine * x - sine * y;
                        matrix[i][q] = sine * x + cosine * y;
                        matrix[p][i] = matrix[i][p];
                        matrix[q][i] = matrix[i][q];
                    }
                    let (x, y) = (basis[i][p], basis[i][q]);
                    basis[i][p] = cosine * x - sine * y;
                    basis[i][q] = sine * x + cosine * y;
                }
            }
        }
        if is_done {
            break;
        }
    }
    for end in (first + 1..first + size).rev() {
        for p in first..end {
            if matrix[p][p] > matrix[p + 1][p + 1] {
                let lower = matrix[p][p];
                matrix[p][p] = matrix[p + 1][p + 1];
                matrix[p + 1][p + 1] = lower;
                for row in &mut basis[range.clone()] {
                    row.swap(p, p + 1);
                }
            }
        }
    }
}

/// Points of an icosahedron's faces divided into `frequency`² triangles, on the unit sphere, one of each
/// pair n, −n; and the triangles between them.
fn geodesic(frequency: usize) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::with_capacity(12);
    for axis in 0..3 {
        for (one, other) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
            let mut corner = [0.0; 3];
            corner[(axis + 1) % 3] = one;
            corner[(axis + 2) % 3] = other;
            corners.push(corner);
        }
    }
    let is_edge =
        |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>() < 5.0;
    let (mut points, mut places, mut triangles) = (Vec::new(), HashMap::new(), Vec::new());
    let divisions = frequency as f64;
    for first in 0..12 {
        for second in first + 1..12 {
            for third in second + 1..12 {
                let [p, q, r] = [&corners[first], &corners[second], &corners[third]];
                if !(is_edge(p, q) && is_edge(q, r) && is_edge(p, r)) {
                    continue;
                }
                let mut place = |i: usize, j: usize| {
                    let (u, v) = (i as f64 / divisions, j as f64 / divisions);
                    let w = (frequency - i - j) as f64 / divisions;
                    let mut point: [f64; 3] =
                        std::array::from_fn(|axis| u * p[axis] + v * q[axis] + w * r[axis]);
                    // One of n and −n: the first component that does not vanish is positive.
                    let leading = point.iter().rev().find(|x| x.abs() > 1e-9).copied();
                    if leading.is_some_and(|x| x < 0.0) {
                        point = point.map(|x| -x);
                    }
                    let point = unit(point);
                    let key = point.map(|x| (x * 1e7).round() as i64);
                    *places.entry(key).or_insert_with(|| {
                        points.push(point);
                        points.len() - 1
                    })
                };
                for i in 0..frequency {
                    for j in 0..frequency - i {
                        triangles.push([place(i, j), place(i + 1, j), place(i, j + 1)]);
                        if i + j + 2 <= frequency {
                            triangles.push([place(i + 1, j + 1), place(i + 1, j), place(i, j + 1)]);
                        }
                    }
                }
            }
        }
    }
    (points, triangles)
}

fn dot(x: &[f64; 3], y: &[f64; 3]) -> f64 {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

fn unit(x: [f64; 3]) -> [f64; 3] {
    let length = dot(&x, &x).sqrt();
    x.map(|x| x / length)
}

/// Two unit vectors across a unit vector and each other.
fn tangents(n: &[f64; 3]) -> [[f64; 3]; 2] {
    let smallest = (0..3).fold(0, |least, i| if n[i].abs() < n[least].abs() { i } else { least });
    let mut first = n.map(|x| -x * n[smallest]);
    first[smallest] += 1.0;
    let first = unit(first);
    let second = [
        n[1] * first[2] - n[2] * first[1],
        n[2] * first[0] - n[0] * first[2],
        n[0] * first[1] - n[1] * first[0],
    ];
    [first, second]
}

/// Step of the differences by which smooth functions are refined in the end, rad: rounding over step
/// and the square of the step are both below 1e-9.
const LAST_STEP: f64 = 2e-5;

/// A minimum near a direction, by Newton's method with differences in the tangent plane; where the
/// function is not smooth, by trying the points around with ever smaller steps. The end is a Newton step
/// below 1e-9 rad or steps below 1e-10 rad. Gives up once the quadratic that fits the function stays
/// above `target` by far.
fn minimise(
    start: [f64; 3],
    radius: f64,
    target: f64,
    mut function: impl FnMut(&[f64; 3]) -> f64,
) -> ([f64; 3], f64) {
    let mut best = (start, function(&start));
    let (mut trust, mut h) = (radius, 0.25 * radius);
    for _ in 0..100 {
        let (centre, middle) = best;
        let [first, second] = tangents(&centre);
        let mut at = |x: f64, y: f64| {
            let point = unit(std::array::from_fn(|i| centre[i] + x * first[i] + y * second[i]));
            let value = function(&point);
            if value < best.1 {
                best = (point, value);
            }
            (point, value)
        };
        let [east, west, north, south, both, neither] =
            [(h, 0.0), (-h, 0.0), (0.0, h), (0.0, -h), (h, h), (-h, -h)].map(|(x, y)| at(x, y).1);
        let gradient = [(east - west) / (2.0 * h), (north - south) / (2.0 * h)];
        let square = h * h;
        let xx = (east - 2.0 * middle + west) / square;
        let yy = (north - 2.0 * middle + south) / square;
        let xy = (both - east - north + 2.0 * middle - west - south + neither) / (2.0 * square);
        let determinant = xx * yy - xy * xy;
        let is_bowl = xx > 0.0 && determinant > 1e-12 * xx * xx && determinant.is_finite();
        let mut is_lower = false;
        if is_bowl {
            let mut step = [
                (xy * gradient[1] - yy * gradient[0]) / determinant,
                (xy * gradient[0] - xx * gradient[1]) / determinant,
            ];
            let gain = -0.5 * (gradient[0] * step[0] + gradient[1] * step[1]);
            let length = (step[0] * step[0] + step[1] * step[1]).sqrt();
            if length <= trust && middle - 4.0 * gain > target {
                return best;
            }
            let shortened = (trust / length).min(1.0);
            step = step.map(|x| shortened * x);
            let (point, value) = at(step[0], step[1]);
            if value <= middle + 4.0 * f64::EPSILON * middle.abs() {
                // Rounding may put a point of the stencil a little below.
                if best.1 >= value - 4.0 * f64::EPSILON * middle.abs() || length < h {
                    best = (point, value);
                }
                is_lower = true;
                if length < 1e-9 && h <= LAST_STEP {
                    return best;
                }
                h = length.clamp(LAST_STEP.min(h), h);
            }
        }
        if !is_lower && best.1 >= middle {
            // Nothing lower at this distance: nearer by there is not much either.
            let around = [east, west, north, south, both, neither];
            let rise = around.iter().filter(|value| value.is_finite());
            let rise = rise.fold(0.0, |rise: f64, value| rise.max(value - middle));
            if rise > 0.0 && middle - 2.0 * rise > target {
                return best;
            }
            h *= 0.25;
            trust *= 0.25;
            if h < 1e-10 {
                return best;
            }
        }
    }
    best
}

impl Sphere {
    /// No direction is farther than this from a starting point or its opposite, rad: 0.9°.
    pub const COVERING_RADIUS: f64 = 0.9 * std::f64::consts::PI / 180.0;

    /// Computes the elastic waves in all starting directions. Takes about 0.1 s.
    ///
    /// # Errors
    /// More than six velocities; numbers that are not finite; an elastic solid that has no waves of some
    /// direction and polarisation.
    pub fn new(elastic: &RateEquations<3>) -> Result<Self, SphereError> {
        let stresses = elastic.stresses();
        let stiffness = elastic.stiffness_values();
        let carries =
            |&v: &usize| elastic.gradient.iter().any(|g| g.column(v).iter().any(|&x| x != 0.0));
        let moving: Vec<usize> = (0..elastic.velocities()).filter(carries).collect();
        let size = moving.len();
        if size > SIZE {
            return Err(SphereError::TooLarge(size));
        }

        // T = M^(−½) Gⁱᵀ D Gʲ M^(−½).
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
            return Err(SphereError::NotFinite);
        }

        // Velocities that act on each other, together.
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
        for (place, &v) in order.iter().enumerate() {
            match blocks.last_mut() {
                Some((first, length)) if block[order[*first]] == block[v] => *length += 1,
                _ => blocks.push((place, 1)),
            }
        }
        let order: Vec<usize> = order.iter().map(|&v| moving[v]).collect();

        let sorted = products(&order);
        let mut acoustic = [[[0.0; SIZE]; SIZE]; 6];
        for (tensor, (i, j)) in
            acoustic.iter_mut().zip([(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)])
        {
            for v in 0..size {
                for w in 0..size {
                    let pair =
                        |i: usize, j: usize| 0.5 * (sorted[i][j][(v, w)] + sorted[i][j][(w, v)]);
                    tensor[v][w] = if i == j { pair(i, i) } else { pair(i, j) + pair(j, i) };
                }
            }
        }

        let (normals, coarse, neighbours, parents) = grids();
        let mut sphere = Self {
            unit: 1.0,
            stresses,
            size,
            blocks,
            balance: std::array::from_fn(|axis| rows(axis, &order)),
            acoustic,
            normals,
            groups: Vec::new(),
            parents,
            coarse,
            neighbours,
            chunks: Vec::new(),
            bases: Vec::new(),
        };
        sphere.compute_waves()?;
        Ok(sphere)
    }

    /// Fills `groups`, `chunks` and `bases`, and makes the fastest wave the unit.
    fn compute_waves(&mut self) -> Result<(), SphereError> {
        let count = self.normals.len();
        let mut fastest: f64 = 0.0;
        let mut waves = Vec::with_capacity(count);
        for &normal in &self.normals {
            let wave = self.elastic(&normal, &identity());
            for &value in &wave.0[..self.size] {
                fastest = fastest.max(value);
            }
            waves.push(wave);
        }
        for ((values, _), &normal) in waves.iter().zip(&self.normals) {
            if let Some(&value) = values[..self.size]
                .iter()
                .find(|&&value| value.is_nan() || value <= 1e-14 * fastest)
            {
                return Err(SphereError::NotElastic { normal, speed_squared: value });
            }
        }
        self.unit = fastest;
        for tensor in self.acoustic.iter_mut().flatten().flatten() {
            *tensor /= fastest;
        }
        for rows in &mut self.balance {
            *rows /= fastest.sqrt();
        }
        let entries: usize = self.blocks.iter().map(|&(_, size)| size * size).sum();
        for start in (0..count).step_by(LANES) {
            let mut chunk =
                Chunk { normal: [[0.0; LANES]; 3], speed_squared: [[1.0; LANES]; SIZE] };
            let first = self.bases.len();
            self.bases.resize(first + entries, [0.0; LANES]);
            for lane in 0..LANES {
                // The last chunk is filled up with the last direction.
                let place = (start + lane).min(count - 1);
                let (values, basis) = &waves[place];
                for axis in 0..3 {
                    chunk.normal[axis][lane] = self.normals[place][axis];
                }
                for (lanes, value) in chunk.speed_squared.iter_mut().zip(values).take(self.size) {
                    lanes[lane] = value / fastest;
                }
                let mut entry = first;
                for &(block, size) in &self.blocks {
                    for row in &basis[block..block + size] {
                        for &component in &row[block..block + size] {
                            self.bases[entry][lane] = component;
                            entry += 1;
                        }
                    }
                }
                if start + lane < count {
                    let scaled = values.map(|value| value / fastest);
                    self.groups.push(Groups::new(&scaled[..self.size]));
                }
            }
            self.chunks.push(chunk);
        }
        Ok(())
    }

    /// Eigenvalues and eigenvectors of Γₑ; quick where `near` has nearly its eigenvectors.
    fn elastic(&self, n: &[f64; 3], near: &Basis) -> ([f64; SIZE], Basis) {
        let factors =
            [n[0] * n[0], n[1] * n[1], n[2] * n[2], n[1] * n[2], n[0] * n[2], n[0] * n[1]];
        let (mut matrix, mut basis) = ([[0.0; SIZE]; SIZE], *near);
        for &(first, size) in &self.blocks {
            let range = first..first + size;
            let mut half = [[0.0; SIZE]; SIZE];
            for i in range.clone() {
                for j in range.clone() {
                    let mut entry = 0.0;
                    for (factor, tensor) in factors.iter().zip(&self.acoustic) {
                        entry += factor * tensor[i][j];
                    }
                    for k in range.clone() {
                        half[i][k] += entry * near[j][k];
                    }
                }
            }
            for i in range.clone() {
                for k in range.clone() {
                    for l in range.clone() {
                        matrix[k][l] += near[i][k] * half[i][l];
                    }
                }
            }
            diagonalise(&mut matrix, &mut basis, (first, size));
        }
        (std::array::from_fn(|k| matrix[k][k]), basis)
    }

    /// Γₑ's eigenvectors at a starting direction.
    fn basis(&self, place: usize) -> Basis {
        let mut basis = [[0.0; SIZE]; SIZE];
        let entries: usize = self.blocks.iter().map(|&(_, size)| size * size).sum();
        let mut entry = place / LANES * entries;
        for &(first, size) in &self.blocks {
            for row in &mut basis[first..first + size] {
                for component in &mut row[first..first + size] {
                    *component = self.bases[entry][place % LANES];
                    entry += 1;
                }
            }
        }
        basis
    }

    /// Room for [`search`](Self::search), one per thread.
    pub fn workspace(&self) -> Workspace {
        let none = Roots { least: f64::INFINITY, pair: None, is_complex: false };
        Workspace {
            coarse: vec![none; self.coarse.len()],
            growth: vec![f64::NEG_INFINITY; self.coarse.len()],
        }
    }

    /// The starting directions; −n stands for n too.
    pub fn normals(&self) -> &[[f64; 3]] {
        &self.normals
    }

    fn change(&self, update: &RankOne) -> Result<Change, SphereError> {
        for vector in [&update.image, &update.covector] {
            if vector.len() != self.stresses {
                let given = vector.len();
                return Err(SphereError::Mismatch { given, needed: self.stresses });
            }
        }
        let project = |vector: &[f64]| -> [[f64; 3]; SIZE] {
            std::array::from_fn(|v| {
                std::array::from_fn(|axis| {
                    if v >= self.size {
                        return 0.0;
                    }
                    (0..self.stresses)
                        .fold(0.0, |sum, s| sum + self.balance[axis][(v, s)] * vector[s])
                })
            })
        };
        let (mut alpha, mut beta) = (project(&update.image), project(&update.covector));
        let norm = |rows: &[[f64; 3]; SIZE]| {
            rows.iter().flatten().fold(0.0, |sum: f64, x| sum + x * x).sqrt()
        };
        let (first, second) = (norm(&alpha), norm(&beta));
        let largest = first * second;
        if !largest.is_finite() {
            return Err(SphereError::NotFinite);
        }
        // Only the product matters.
        if largest > 0.0 {
            let balanced = (second / first).sqrt();
            alpha.iter_mut().flatten().for_each(|x| *x *= balanced);
            beta.iter_mut().flatten().for_each(|x| *x /= balanced);
        }
        Ok(Change { size: self.size, alpha, beta, largest })
    }

    /// The squares of all characteristic speeds of waves with that unit normal, m²/s², the real ones
    /// first.
    ///
    /// # Errors
    /// See [`search`](Self::search).
    pub fn speeds_squared(
        &self,
        update: &RankOne,
        normal: [f64; 3],
    ) -> Result<Vec<Complex64>, SphereError> {
        let change = self.change(update)?;
        let (values, basis) = self.elastic(&normal, &identity());
        let groups = Groups::new(&values[..self.size]);
        let secular = change.at(&normal, &basis, &groups);
        let mut roots: Vec<Complex64> =
            secular.kept[..secular.kept_count].iter().map(|&x| Complex64::new(x, 0.0)).collect();
        match (secular.count, secular.changes()) {
            (0, _) => {}
            (2, _) => push_pair(&mut roots, &secular.quadratic()),
            (count, 1) => {
                for index in (0..=count).filter(|&index| secular.is_odd(index)) {
                    roots.push(Complex64::new(secular.root(index, secular.size(), true), 0.0));
                }
            }
            (count, 3) => {
                let (found, rest) = secular.last_two();
                roots.extend(found[..count - 2].iter().map(|&x| Complex64::new(x, 0.0)));
                push_pair(&mut roots, &rest);
            }
            (count, _) => roots.extend(&secular.all()[..count]),
        }
        roots.sort_by(|x, y| {
            let key = |z: &Complex64| z.im != 0.0;
            key(x).cmp(&key(y)).then(x.re.total_cmp(&y.re)).then(x.im.total_cmp(&y.im))
        });
        Ok(roots.into_iter().map(|root| root * self.unit).collect())
    }

    /// The strongest flutter and the slowest real wave over all directions, to 1e-9 rad where they are
    /// smooth, or to the rounding of their values.
    ///
    /// Flutter in a cap that holds a circle of radius [`COVERING_RADIUS`](Self::COVERING_RADIUS) is
    /// found: a starting point lies in it. Smaller caps are found from the directions in which two real
    /// eigenvalues are nearest to each other. (Im c²)² below 1e-13 of the squared speeds involved is taken
    /// for rounding.
    ///
    /// # Errors
    /// Vectors of the wrong length, or not finite.
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

        let mut best = Best { slowest: (self.normals[0], f64::INFINITY), flutter: None };
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
            // Half the distance to the neighbours is within reach: a quarter of the difference for a
            // quadratic; eight times as much is allowed for.
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

    /// The fine grid: complex speeds in directions whose neighbours of the coarse grid have none, and c²
    /// below the least so far.
    fn search_between(&self, change: &Change, coarse: &[Roots], best: &mut Best) {
        let mut products = [[0.0; LANES]; SIZE];
        let mut flags = [false; LANES];
        let mut tiny = [0.0; LANES];
        let mut found = [(0, f64::NEG_INFINITY); 8];
        for (index, chunk) in self.chunks.iter().enumerate() {
            let target = best.slowest.1 - 1e-12;
            self.products(change, index, &mut products, &mut tiny);
            // Below all λ_g the sides of the secular equation at the least c² so far tell whether there
            // is a lower one.
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

    /// α̂β̂ for each eigenvalue of Γₑ in a chunk of directions.
    fn products(
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

    fn roots_near(&self, change: &Change, near: &Basis, normal: &[f64; 3]) -> Roots {
        let (values, basis) = self.elastic(normal, near);
        change.at(normal, &basis, &Groups::new(&values[..self.size])).roots()
    }

    fn refine_slowest(&self, change: &Change, place: usize, frequency: usize, best: &mut Best) {
        let near = self.basis(place);
        let function = |normal: &[f64; 3]| self.roots_near(change, &near, normal).least;
        let radius = 1.3 / frequency as f64;
        let found = minimise(self.normals[place], radius, best.slowest.1, function);
        if found.1 < best.slowest.1 {
            best.slowest = found;
        }
    }

    fn refine_flutter(&self, change: &Change, place: usize, frequency: usize, best: &mut Best) {
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

/// Puts a direction into the descending list unless one with the same parent is stronger.
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

struct Best {
    slowest: ([f64; 3], f64),
    flutter: Option<([f64; 3], Pair)>,
}

fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

fn identity() -> Basis {
    std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))))
}

fn push_pair(roots: &mut Vec<Complex64>, pair: &Pair) {
    let root = Complex64::new(pair.square, 0.0).sqrt();
    roots.extend([pair.middle - root, pair.middle + root]);
}

type Grids = (Vec<[f64; 3]>, Vec<u32>, Vec<[u32; NEIGHBOURS]>, Vec<u32>);

/// The fine grid; the coarse one by places in it; neighbours in the coarse one; nearest in the coarse one.
fn grids() -> Grids {
    let (fine, _) = geodesic(FINE);
    let (coarse, triangles) = geodesic(COARSE);
    let nearest = |grid: &[[f64; 3]], n: &[f64; 3]| {
        let distance = |place: usize| dot(&grid[place], n).abs();
        let closer = |best, place| if distance(place) > distance(best) { place } else { best };
        (0..grid.len()).fold(0, closer) as u32
    };
    let parents = fine.iter().map(|n| nearest(&coarse, n)).collect();
    let places = coarse.iter().map(|n| nearest(&fine, n)).collect();
    let mut around: Vec<Vec<u32>> = vec![Vec::new(); coarse.len()];
    for triangle in triangles {
        for i in 0..3 {
            for j in (0..3).filter(|&j| j != i) {
                let other = triangle[j] as u32;
                if !around[triangle[i]].contains(&other) {
                    around[triangle[i]].push(other);
                }
            }
        }
    }
    let neighbours = around
        .iter()
        .map(|list| std::array::from_fn(|i| list.get(i).or(list.first()).copied().unwrap_or(0)))
        .collect();
    (fine, places, neighbours, parents)
}
