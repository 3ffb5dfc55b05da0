//! The roots ς of det(ςA + ik(cos θ B¹ + sin θ B²) + C) at a given wave.
//!
//! The pencil is equilibrated and its generalised eigenvalues are computed by the QZ algorithm;
//! how many of them are finite follows from the degree of the exact polynomial, not from a
//! threshold on the eigenvalues (an index-2 block leaves infinite ones that look finite). The
//! finite ones are then polished on that polynomial.

use crate::AnalysisError;
use crate::polynomial::DispersionPolynomial;
use crate::scaling::{Entry, ScaledSystem, balance};
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::ComputeEigenvectors;
use faer::linalg::gevd::{gevd_cplx, gevd_scratch};
use faer::{Mat, Par};
use models::LinearisedSystem;
use nalgebra::DMatrix;
use num_complex::Complex64;

/// The roots at one wave.
#[derive(Clone, Debug, PartialEq)]
pub enum Roots {
    /// The system determines finitely many.
    Regular {
        /// The finite roots ς, 1/s, by descending real part.
        finite: Vec<Complex64>,
        /// How many roots are infinite: algebraic equations.
        infinite: usize,
    },
    /// det ≡ 0, or fewer equations than unknowns: every ς is a root.
    Singular {
        /// Generic rank of the pencil.
        rank: usize,
    },
}

/// Everything that the analysis derives from a system before it looks at a direction; keep one
/// per thread and [`update`](Self::update) it.
#[derive(Clone, Debug, Default)]
pub struct Pencil {
    /// The system in its own units.
    pub scaled: ScaledSystem,
    /// Its dispersion polynomial; of no meaning where the system is not square.
    pub polynomial: DispersionPolynomial,
    is_singular: bool,
}

impl Pencil {
    /// Takes a system.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn update(&mut self, system: &LinearisedSystem<2>) -> Result<(), AnalysisError> {
        self.scaled.update(system)?;
        let square = system.equations.len() == system.unknowns.len();
        self.is_singular = !square;
        if square {
            self.polynomial.update(&self.scaled)?;
            self.is_singular = !self.polynomial.forms().iter().any(|term| term.form.is_certain());
        }
        Ok(())
    }

    /// Whether det ≡ 0 within rounding, or the system is not square.
    pub fn is_singular(&self) -> bool {
        self.is_singular
    }

    /// Rank of ςA + κ₁B¹ + κ₂B² + C at generic ς, κ.
    pub fn generic_rank(&self) -> usize {
        let s = &self.scaled.system;
        let (time, first, second) =
            (Complex64::new(0.7, 0.4), Complex64::new(-0.3, 1.1), Complex64::new(0.9, 0.6));
        let matrix = DMatrix::from_fn(s.equations.len(), s.unknowns.len(), |i, j| {
            let at = (i, j);
            time * s.a[at].value
                + first * s.b[0][at].value
                + second * s.b[1][at].value
                + s.c[at].value
        });
        matrix.rank(1e-11)
    }

    /// All roots at the wave number `k` (1/m) and the direction of the wave vector (rad).
    pub fn roots(&self, k: f64, direction: f64) -> Roots {
        if self.is_singular {
            return Roots::Singular { rank: self.generic_rank() };
        }
        let size = self.scaled.system.equations.len();
        let count = self.polynomial.at_wave(k, direction).len() - 1;
        let mut guesses = self.generalised_eigenvalues(k, direction);
        // Infinite ones last, whatever they look like.
        guesses.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        guesses.truncate(count);
        let mut finite = self.polynomial.roots(k, direction, &guesses);
        finite.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        Roots::Regular { infinite: size - finite.len(), finite }
    }

    /// The finite-looking generalised eigenvalues ς, 1/s, as QZ leaves them, of the equilibrated
    /// pencil; empty where QZ fails.
    pub fn generalised_eigenvalues(&self, k: f64, direction: f64) -> Vec<Complex64> {
        let s = &self.scaled.system;
        let n = s.equations.len();
        let k_scaled = k / self.scaled.wave_number;
        let (sin, cos) = direction.sin_cos();
        let entry = |i: usize, j: usize| {
            let wave = k_scaled * (cos * s.b[0][(i, j)].value + sin * s.b[1][(i, j)].value);
            Complex64::new(s.c[(i, j)].value, wave)
        };
        let mut entries = Vec::with_capacity(2 * n * n);
        for row in 0..n {
            for column in 0..n {
                for (group, size) in
                    [(0, entry(row, column).norm()), (1, s.a[(row, column)].value.abs())]
                {
                    if size > 0.0 {
                        entries.push(Entry { row, column, group, log: size.log2() });
                    }
                }
            }
        }
        let scales = balance(&entries, n, n, 1);
        let (rows, columns, rate) = (&scales.rows, &scales.columns, scales.groups[0]);
        let mut left = Mat::from_fn(n, n, |i, j| -entry(i, j) * rows[i] * columns[j]);
        let mut right = Mat::from_fn(n, n, |i, j| {
            Complex64::from(s.a[(i, j)].value * rows[i] * columns[j] * rate)
        });
        let (mut alpha, mut beta) = (Diag::zeros(n), Diag::zeros(n));
        let no = ComputeEigenvectors::No;
        let parameters = Default::default();
        let mut memory = MemBuffer::new(gevd_scratch::<Complex64>(n, no, no, Par::Seq, parameters));
        let result = gevd_cplx(
            left.as_mut(),
            right.as_mut(),
            alpha.as_mut(),
            beta.as_mut(),
            None,
            None,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        );
        if result.is_err() {
            return Vec::new();
        }
        let v = &s.velocity;
        let convection = Complex64::new(0.0, -k * (v[0] * cos + v[1] * sin));
        (0..n)
            .map(|i| (alpha[i], beta[i]))
            .filter(|(_, b)| *b != Complex64::ZERO)
            .map(|(a, b)| a / b * rate * self.scaled.rate + convection)
            .collect()
    }
}
