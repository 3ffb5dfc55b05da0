//! QZ algorithm: finite generalised eigenvalues λ of a small dense pencil, L x = λ R x, without allocation.
//!
//! Rows, columns and the unit of λ are first scaled by powers of two, as in [`scaling`](crate::scaling). Three steps
//! follow, with permutations and unitary rotations only, so each eigenvalue is exact for a pencil that differs from the
//! scaled one by a modest multiple of ε‖L‖, ε‖R‖:
//!
//! 1. infinite eigenvalues that appear as exact zeros of R are deflated by the staircase of P. Van Dooren (Linear
//!    Algebra and its Applications 27, 1979, 103–140); they belong to algebraic equations;
//! 2. the remaining pencil is reduced to Hessenberg–triangular form;
//! 3. the single-shift QZ iteration triangularises it (C. B. Moler & G. W. Stewart, SIAM Journal on Numerical Analysis
//!    10, 1973, 241–256; G. H. Golub & C. F. Van Loan, Matrix Computations, section 7.7).

use num_complex::Complex64;
use std::ops::Range;

/// Maximum number of rows of a pencil.
pub const MAX_SIZE: usize = 10;

type PencilMatrix = [[Complex64; MAX_SIZE]; MAX_SIZE];

const EPSILON: f64 = f64::EPSILON;
/// Magnitude below which an entry counts as zero: the largest entry is near one. The fourth power of the threshold does
/// not underflow.
const ZERO_THRESHOLD: f64 = 1e-75;
/// Maximum number of QZ steps per eigenvalue; two or three are typical.
const MAX_QZ_STEPS: usize = 40;
/// Number of sweeps of the equilibration.
const EQUILIBRATION_SWEEPS: usize = 6;
/// Placeholder for the logarithm of zero.
const LOG_OF_ZERO: f64 = -1e6;

/// Workspace of the QZ algorithm: a pencil L − λR and its eigenvalues. Keep one per thread.
#[derive(Clone, Debug)]
pub struct Qz {
    size: usize,
    /// L, overwritten by its triangular form.
    left: PencilMatrix,
    /// R, overwritten by its triangular form.
    right: PencilMatrix,
    rate_exponent: i32,
    eigenvalues: [Complex64; MAX_SIZE],
}

impl Default for Qz {
    fn default() -> Self {
        let zero = [[Complex64::ZERO; MAX_SIZE]; MAX_SIZE];
        Self {
            size: 0,
            left: zero,
            right: zero,
            rate_exponent: 0,
            eigenvalues: [Complex64::ZERO; MAX_SIZE],
        }
    }
}

/// Complex Givens rotation (c s; −s̄ c) that maps (f, g) to (r, 0).
#[derive(Clone, Copy)]
struct GivensRotation {
    c: f64,
    s: Complex64,
}

impl GivensRotation {
    /// Rotation that annihilates g, and r: c = |f|/h, s = (f/|f|) ḡ/h, r = (f/|f|) h with h² = |f|² + |g|².
    #[inline(always)]
    fn from_annihilation(f: Complex64, g: Complex64) -> (Self, Complex64) {
        let (f2, g2) = (f.norm_sqr(), g.norm_sqr());
        if g2 <= ZERO_THRESHOLD * ZERO_THRESHOLD {
            return (Self { c: 1.0, s: Complex64::ZERO }, f);
        }
        if f2 <= ZERO_THRESHOLD * ZERO_THRESHOLD {
            let modulus = g2.sqrt();
            return (Self { c: 0.0, s: g.conj() / modulus }, modulus.into());
        }
        let h2 = f2 + g2;
        let inverse = 1.0 / (f2 * h2).sqrt();
        (Self { c: f2 * inverse, s: f * g.conj() * inverse }, f * (h2 * inverse))
    }

    /// (x, y) ← (c x + s y, c y − s̄ x).
    #[inline(always)]
    fn apply(self, x: &mut Complex64, y: &mut Complex64) {
        // Real and imaginary parts have the same sequence of operations, so that the compiler can vectorise them.
        let (c, re, im) = (self.c, self.s.re, self.s.im);
        let (minus_re, minus_im) = (0.0 - re, 0.0 - im);
        (*x, *y) = (
            Complex64::new(
                c * x.re + re * y.re + minus_im * y.im,
                c * x.im + re * y.im + im * y.re,
            ),
            Complex64::new(
                c * y.re + minus_re * x.re + minus_im * x.im,
                c * y.im + minus_re * x.im + im * x.re,
            ),
        );
    }

    /// Rotates rows i and j, in the given columns.
    #[inline(always)]
    fn rotate_rows(self, matrix: &mut PencilMatrix, [i, j]: [usize; 2], columns: Range<usize>) {
        let Ok([x, y]) = matrix.get_disjoint_mut([i, j]) else { return };
        for (x, y) in x[columns.clone()].iter_mut().zip(&mut y[columns]) {
            self.apply(x, y);
        }
    }

    /// Rotates columns i and j, in the given rows.
    #[inline(always)]
    fn rotate_columns(self, matrix: &mut PencilMatrix, [i, j]: [usize; 2], rows: Range<usize>) {
        for row in &mut matrix[rows] {
            let (mut x, mut y) = (row[i], row[j]);
            self.apply(&mut x, &mut y);
            (row[i], row[j]) = (x, y);
        }
    }
}

impl Qz {
    /// Loads the pencil L − λR of `size` ≤ [`MAX_SIZE`] rows (the leading block of a larger one) and equilibrates
    /// it.
    #[inline]
    pub fn equilibrate(
        &mut self,
        size: usize,
        left: impl Fn(usize, usize) -> Complex64,
        right: impl Fn(usize, usize) -> Complex64,
    ) {
        self.size = size.min(MAX_SIZE);
        for i in 0..self.size {
            for j in 0..self.size {
                (self.left[i][j], self.right[i][j]) = (left(i, j), right(i, j));
            }
        }
        // Specialised for the sizes 4, 5 and 6, with loops of constant length.
        match self.size {
            4 => self.scale_by_powers_of_two::<4>(),
            5 => self.scale_by_powers_of_two::<5>(),
            6 => self.scale_by_powers_of_two::<6>(),
            _ => self.scale_by_powers_of_two::<MAX_SIZE>(),
        }
    }

    /// Minimises Σ (log |Lᵢⱼ| + rᵢ + cⱼ)² + Σ (log |Rᵢⱼ| + rᵢ + cⱼ + g)² over the non-zero entries by sweeps through
    /// rᵢ, cⱼ and g (all in binary logarithms), then scales L and R to largest entries near one.
    fn scale_by_powers_of_two<const N: usize>(&mut self) {
        let n = if N < MAX_SIZE { N } else { self.size };
        let mut logs = [[[f64::NEG_INFINITY; N]; N]; 2];
        // Numbers of entries and sums of logarithms, by row, by column, and of R as a whole.
        let mut count = [[0.0; N]; N];
        let [mut row_logs, mut row_count, mut row_right] = [[0.0; N]; 3];
        let [mut column_logs, mut column_count, mut column_right] = [[0.0; N]; 3];
        let [mut right_logs, mut right_count] = [0.0; 2];
        for i in 0..n {
            for j in 0..n {
                let (l, r) =
                    (approximate_log2(self.left[i][j]), approximate_log2(self.right[i][j]));
                (logs[0][i][j], logs[1][i][j]) = (l, r);
                let (l, l_count) = if l > LOG_OF_ZERO { (l, 1.0) } else { (0.0, 0.0) };
                let (r, r_count) = if r > LOG_OF_ZERO { (r, 1.0) } else { (0.0, 0.0) };
                count[i][j] = l_count + r_count;
                row_logs[i] += l + r;
                row_count[i] += l_count + r_count;
                row_right[i] += r_count;
                column_logs[j] += l + r;
                column_count[j] += l_count + r_count;
                column_right[j] += r_count;
                right_logs += r;
                right_count += r_count;
            }
        }
        let inverse = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
        let (row_weight, column_weight) = (row_count.map(inverse), column_count.map(inverse));
        let right_weight = inverse(right_count);
        let ([mut r, mut c], mut g) = ([[0.0; N]; 2], 0.0);
        for _ in 0..EQUILIBRATION_SWEEPS {
            let (mut sums, mut right_sum) = (column_logs, right_logs);
            for i in 0..n {
                let mut sum = row_logs[i] + row_right[i] * g;
                for j in 0..n {
                    sum += count[i][j] * c[j];
                }
                r[i] = -sum * row_weight[i];
                for j in 0..n {
                    sums[j] += count[i][j] * r[i];
                }
                right_sum += row_right[i] * r[i];
            }
            for j in 0..n {
                c[j] = -(sums[j] + column_right[j] * g) * column_weight[j];
                right_sum += column_right[j] * c[j];
            }
            g = -right_sum * right_weight;
        }
        let (r, c) = (r.map(round_to_integer), c.map(round_to_integer));
        // Logarithms of the largest entries of L and R.
        let mut tops = [LOG_OF_ZERO; 2];
        for (logs, top) in logs.iter().zip(&mut tops) {
            for i in 0..n {
                for j in 0..n {
                    *top = max(*top, logs[i][j] + r[i] + c[j]);
                }
            }
        }
        let [left_top, right_top] =
            tops.map(|top| if top > 0.5 * LOG_OF_ZERO { round_to_integer(top) } else { 0.0 });
        for (i, r) in r[..n].iter().enumerate() {
            for (j, c) in c[..n].iter().enumerate() {
                let total = r + c;
                self.left[i][j] =
                    multiply_by_power_of_two(self.left[i][j], (total - left_top) as i32);
                self.right[i][j] =
                    multiply_by_power_of_two(self.right[i][j], (total - right_top) as i32);
            }
        }
        self.rate_exponent = (left_top - right_top) as i32;
    }

    /// Entries (i, j) of the equilibrated L and R, until [`solve`](Self::solve) overwrites them.
    pub fn equilibrated_entries(&self, i: usize, j: usize) -> [Complex64; 2] {
        [self.left[i][j], self.right[i][j]]
    }

    /// Binary exponent e of the scaled unit of λ: λ = 2^e × the eigenvalue of the equilibrated pencil.
    pub fn rate_exponent(&self) -> i32 {
        self.rate_exponent
    }

    /// The finite eigenvalues λ in the unit before scaling; `None` if an entry is not finite or the iteration does not
    /// converge.
    pub fn solve(&mut self) -> Option<&mut [Complex64]> {
        let norms = [frobenius_norm(&self.left, self.size), frobenius_norm(&self.right, self.size)];
        if !norms.iter().all(|norm| norm.is_finite()) {
            return None;
        }
        let size = self.deflate_infinite();
        self.reduce_to_hessenberg(size);
        self.iterate_qz(size, norms)?;
        let mut found = 0;
        for i in 0..size {
            let value =
                multiply_by_power_of_two(self.left[i][i] / self.right[i][i], self.rate_exponent);
            if value.is_finite() {
                self.eigenvalues[found] = value;
                found += 1;
            }
        }
        Some(&mut self.eigenvalues[..found])
    }

    /// Deflates infinite eigenvalues while R is exactly singular; returns the size of the remaining leading block. With
    /// a unitary Q, a permutation P and R of rank r,
    ///
    /// ```text
    /// Q L P = (L₁)    Q R P = (R₁)
    ///         (L₂),           ( 0),   R₁ of r rows.
    /// ```
    ///
    /// A unitary Z makes L₂ Z = (0 U) with a triangular U, which carries infinite eigenvalues; the other eigenvalues
    /// are those of the first r columns of L₁ Z and R₁ Z.
    fn deflate_infinite(&mut self) -> usize {
        let mut size = self.size;
        loop {
            let rank = self.triangularise(size);
            if rank == size {
                return size;
            }
            let (left, right) = (&mut self.left, &mut self.right);
            for i in (rank..size).rev() {
                for j in 0..i {
                    if left[i][j] != Complex64::ZERO {
                        let (rotation, r) =
                            GivensRotation::from_annihilation(left[i][i], left[i][j]);
                        (left[i][i], left[i][j]) = (r, Complex64::ZERO);
                        rotation.rotate_columns(left, [i, j], 0..i);
                        rotation.rotate_columns(right, [i, j], 0..rank);
                    }
                }
            }
            size = rank;
        }
    }

    /// Pivoted QR factorisation of R by rotations, with the largest remaining entry as pivot; returns the rank.
    fn triangularise(&mut self, size: usize) -> usize {
        let (left, right) = (&mut self.left, &mut self.right);
        for k in 0..size {
            let (mut greatest, mut pivot) = (0.0, None);
            for (i, row) in right[..size].iter().enumerate().skip(k) {
                for (j, entry) in row[..size].iter().enumerate().skip(k) {
                    let square = entry.norm_sqr();
                    if square > greatest {
                        (greatest, pivot) = (square, Some((i, j)));
                    }
                }
            }
            let Some((i, j)) = pivot else { return k };
            for matrix in [&mut *left, &mut *right] {
                if let Ok([own, other]) = matrix.get_disjoint_mut([k, i]) {
                    own[..size].swap_with_slice(&mut other[..size]);
                }
                if j != k {
                    matrix[..size].iter_mut().for_each(|row| row.swap(k, j));
                }
            }
            for i in k + 1..size {
                if right[i][k] != Complex64::ZERO {
                    let (rotation, r) = GivensRotation::from_annihilation(right[k][k], right[i][k]);
                    (right[k][k], right[i][k]) = (r, Complex64::ZERO);
                    rotation.rotate_rows(right, [k, i], k + 1..size);
                    rotation.rotate_rows(left, [k, i], 0..size);
                }
            }
        }
        size
    }

    /// Reduces L to Hessenberg form while R stays triangular (Golub & Van Loan, algorithm 7.7.1).
    fn reduce_to_hessenberg(&mut self, size: usize) {
        let (left, right) = (&mut self.left, &mut self.right);
        for j in 0..size.saturating_sub(2) {
            for i in (j + 2..size).rev() {
                let (rotation, r) = GivensRotation::from_annihilation(left[i - 1][j], left[i][j]);
                (left[i - 1][j], left[i][j]) = (r, Complex64::ZERO);
                rotation.rotate_rows(left, [i - 1, i], j + 1..size);
                rotation.rotate_rows(right, [i - 1, i], i - 1..size);
                let (rotation, r) = GivensRotation::from_annihilation(right[i][i], right[i][i - 1]);
                (right[i][i], right[i][i - 1]) = (r, Complex64::ZERO);
                rotation.rotate_columns(right, [i, i - 1], 0..i);
                rotation.rotate_columns(left, [i, i - 1], 0..size);
            }
        }
    }

    /// Single-shift QZ iteration: reduces the subdiagonal of L to zero, from the bottom. `None` if it does not
    /// converge.
    fn iterate_qz(&mut self, size: usize, [left_norm, right_norm]: [f64; 2]) -> Option<()> {
        let (left, right) = (&mut self.left, &mut self.right);
        let (mut end, mut steps, mut exceptional) = (size, 0, Complex64::ZERO);
        while end > 1 {
            // Thresholds ε²‖L‖, ε²‖R‖ in the first ten steps, ε‖L‖, ε‖R‖ later; entries of L are also deflated below ε
            // times their diagonal neighbours. Small thresholds are more accurate for eigenvalues far from the others.
            let share = if steps < 10 { EPSILON * EPSILON } else { EPSILON };
            let (floor, singular) =
                ((share * left_norm).max(2.0 * ZERO_THRESHOLD), share * right_norm);
            // Active block first..end: the last block with a non-zero subdiagonal.
            let mut first = end - 1;
            while first > 0 {
                let diagonal = l1_norm(left[first - 1][first - 1]) + l1_norm(left[first][first]);
                if l1_norm(left[first][first - 1]) <= (EPSILON * diagonal).max(floor) {
                    left[first][first - 1] = Complex64::ZERO;
                    break;
                }
                first -= 1;
            }
            if first + 1 == end {
                (end, steps, exceptional) = (first, 0, Complex64::ZERO);
                continue;
            }
            // Deflate an eigenvalue at the end that is infinite up to rounding.
            let (k, last) = (end - 2, end - 1);
            if l1_norm(right[last][last]) <= singular {
                right[last][last] = Complex64::ZERO;
                let (rotation, r) =
                    GivensRotation::from_annihilation(left[last][last], left[last][k]);
                (left[last][last], left[last][k]) = (r, Complex64::ZERO);
                rotation.rotate_columns(left, [last, k], first..last);
                rotation.rotate_columns(right, [last, k], first..last);
                continue;
            }
            steps += 1;
            if steps > MAX_QZ_STEPS {
                return None;
            }
            // Every tenth step uses an exceptional shift, to break cycles.
            let mut shift = if steps % 10 == 0 {
                exceptional += left[end - 1][end - 2] / right[end - 2][end - 2];
                exceptional
            } else {
                wilkinson_shift(left, right, end - 2)
            };
            // An infinite eigenvalue inside the block: with a zero shift the iteration moves it up and out of the
            // block.
            if !shift.is_finite() || l1_norm(shift) * singular > left_norm {
                shift = Complex64::ZERO;
            }
            // The first rotation maps the first column of (L − σR) R⁻¹ to a multiple of e₁ and creates a bulge in L and
            // R; rotations from both sides chase the bulge out at the bottom.
            let x = left[first][first] - shift * right[first][first];
            let mut next = GivensRotation::from_annihilation(x, left[first + 1][first]);
            for k in first..end - 1 {
                let (rotation, r) = next;
                if k > first {
                    (left[k][k - 1], left[k + 1][k - 1]) = (r, Complex64::ZERO);
                }
                rotation.rotate_rows(right, [k, k + 1], k..end);
                let (back, r) =
                    GivensRotation::from_annihilation(right[k + 1][k + 1], right[k + 1][k]);
                rotation.rotate_rows(left, [k, k + 1], k..end);
                (right[k + 1][k + 1], right[k + 1][k]) = (r, Complex64::ZERO);
                back.rotate_columns(left, [k + 1, k], first..end.min(k + 3));
                if k + 2 < end {
                    next = GivensRotation::from_annihilation(left[k + 1][k], left[k + 2][k]);
                }
                back.rotate_columns(right, [k + 1, k], first..k + 1);
            }
        }
        Some(())
    }
}

/// Wilkinson's shift: the eigenvalue nearest to the last entry of this matrix, made of rows and columns k, k + 1 of L
/// (`left`) and R (`right`):
///
/// ```text
/// (a b) (p q)⁻¹   (a/p  (b − q a/p)/s)
/// (d e) (0 s)   = (d/p  (e − q d/p)/s).
/// ```
fn wilkinson_shift(left: &PencilMatrix, right: &PencilMatrix, k: usize) -> Complex64 {
    let (p, s) = (right[k][k].inv(), right[k + 1][k + 1].inv());
    let q = right[k][k + 1];
    let (upper, lower) = (left[k][k] * p, left[k + 1][k] * p);
    let corner = (left[k][k + 1] - q * upper) * s;
    let last = (left[k + 1][k + 1] - q * lower) * s;
    let half = 0.5 * (upper - last);
    let product = corner * lower;
    let root = square_root(half * half + product);
    // Sign of the square root that avoids cancellation.
    let sum = if half.re * root.re + half.im * root.im < 0.0 { half - root } else { half + root };
    if sum == Complex64::ZERO { last } else { last - product / sum }
}

/// √z for moduli far from overflow.
fn square_root(z: Complex64) -> Complex64 {
    let part = (0.5 * (z.norm_sqr().sqrt() + z.re.abs())).sqrt();
    if part == 0.0 {
        return Complex64::ZERO;
    }
    let other = 0.5 * z.im / part;
    if z.re >= 0.0 {
        Complex64::new(part, other)
    } else {
        Complex64::new(other.abs(), part.copysign(z.im))
    }
}

/// Frobenius norm √Σ|entry|² of the leading block.
fn frobenius_norm(matrix: &PencilMatrix, size: usize) -> f64 {
    let entries = matrix[..size].iter().flat_map(|row| &row[..size]);
    entries.map(|entry| entry.norm_sqr()).sum::<f64>().sqrt()
}

/// |re| + |im|: the modulus within √2.
fn l1_norm(z: Complex64) -> f64 {
    z.re.abs() + z.im.abs()
}

/// Maximum of two numbers, without the NaN handling of `f64::max`.
#[inline(always)]
fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Base-two logarithm of the larger of |Re z| and |Im z|, within 0.09 for normal numbers; about −1022 for subnormal
/// numbers, [`LOG_OF_ZERO`] for zero.
#[inline(always)]
fn approximate_log2(z: Complex64) -> f64 {
    const MANTISSA_SCALE: f64 = (1u64 << 52) as f64;
    let size = max(z.re.abs(), z.im.abs());
    // The bits of a double, read as an integer, are a piecewise linear logarithm.
    let log = size.to_bits() as i64 as f64 * (1.0 / MANTISSA_SCALE) - 1023.0;
    if size > 0.0 { log } else { LOG_OF_ZERO }
}

/// Rounds to the nearest integer, for moduli below 2⁵¹.
#[inline(always)]
fn round_to_integer(x: f64) -> f64 {
    const ROUNDING_SHIFT: f64 = 1.5 * (1u64 << 52) as f64;
    (x + ROUNDING_SHIFT) - ROUNDING_SHIFT
}

/// Product z 2^e; an exponent beyond ±2044 is replaced by ±2044.
#[inline(always)]
fn multiply_by_power_of_two(z: Complex64, e: i32) -> Complex64 {
    let power = |e: i32| f64::from_bits(((e + 1023) as u64) << 52);
    if (-1022..=1023).contains(&e) {
        z * power(e)
    } else {
        // The factor 2^e is out of range, but its square root is not.
        let e = e.clamp(-2044, 2044);
        z * power(e / 2) * power(e - e / 2)
    }
}
