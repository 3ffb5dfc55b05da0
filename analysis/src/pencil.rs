//! The roots ς of the dispersion relation det L(ς, ik) = 0 at a given wave vector, for first-order equations
//! det(ςA + ik(cos θ B¹ + sin θ B²) + C) = 0.
//!
//! The pencil is equilibrated and its generalised eigenvalues are computed by the QZ algorithm;
//! the number of finite eigenvalues follows from the degree of the exact polynomial, not from a
//! threshold on the eigenvalues (a block of index 2 makes infinite eigenvalues appear finite). The
//! finite eigenvalues are then refined on that polynomial. Roots of equations of higher order, which are no pencil, and
//! of large systems are those of the polynomial from the start.

use crate::AnalysisError;
use crate::list::StackList;
use crate::polynomial::DispersionPolynomial;
use crate::qz::{self, Qz};
use crate::scaling::ScaledSystem;
use models::LinearisedSystem;
use models::common::elementary::{Elementary, Modulus};
use num_complex::Complex64;

/// Roots of the dispersion relation at one wave vector.
#[derive(Clone, Debug, PartialEq)]
pub enum PencilRoots {
    /// Regular pencil: finitely many roots.
    Regular {
        /// The finite roots ς, 1/s, by descending real part.
        finite: Vec<Complex64>,
        /// Number of infinite roots, due to algebraic equations.
        infinite: usize,
    },
    /// Singular pencil: det ≡ 0, or the numbers of equations and unknowns differ.
    Singular {
        /// Generic rank of the pencil.
        rank: usize,
    },
}

/// A linearised system prepared for analysis, independent of direction: scaled system and dispersion polynomial. Keep
/// one per thread and [`update`](Self::update) it.
#[derive(Clone, Debug, Default)]
pub struct Pencil {
    /// The system in scaled units.
    pub scaled: ScaledSystem,
    /// Dispersion polynomial; if the system is not square, that of an earlier system.
    pub polynomial: DispersionPolynomial,
    is_singular: bool,
}

impl Pencil {
    /// Replaces the system, reusing memory.
    ///
    /// # Errors
    /// See [`AnalysisError`].
    pub fn update(&mut self, system: &LinearisedSystem<2>) -> Result<(), AnalysisError> {
        self.scaled.update(system)?;
        let square = system.equations.len() == system.unknowns.len();
        self.is_singular = !square;
        if square {
            self.polynomial.update(&self.scaled)?;
            self.is_singular = !self.polynomial.forms().iter().any(|term| term.form.is_nonzero());
        }
        Ok(())
    }

    /// Whether det ≡ 0 within rounding, or the system is not square.
    pub fn is_singular(&self) -> bool {
        self.is_singular
    }

    /// Rank of ςA + κ₁B¹ + κ₂B² + C at generic ς, κ, by elimination with complete pivoting.
    pub fn generic_rank(&self) -> usize {
        let s = &self.scaled.system;
        let (time, first, second) =
            (Complex64::new(0.7, 0.4), Complex64::new(-0.3, 1.1), Complex64::new(0.9, 0.6));
        let entry = |at: (usize, usize)| {
            let first_order = time * s.a[at].value
                + first * s.b[0][at].value
                + second * s.b[1][at].value
                + s.c[at].value;
            let higher = s.higher_terms.iter().filter(|term| (term.row, term.column) == at);
            higher.fold(first_order, |sum, term| {
                let [b, c] = term.space_powers.map(u32::from);
                let powers = time.powu(term.time_power.into()) * first.powu(b) * second.powu(c);
                sum + powers * term.coefficient.value
            })
        };
        let (rows, columns) = (s.equations.len(), s.unknowns.len());
        let mut matrix: StackList<StackList<Complex64>> =
            (0..rows).map(|i| (0..columns).map(|j| entry((i, j))).collect()).collect();
        let mut largest = None;
        for rank in 0..rows.min(columns) {
            let places = (rank..rows).flat_map(|i| (rank..columns).map(move |j| (i, j)));
            let size = |&(i, j): &(usize, usize)| matrix[i][j].modulus();
            let pivot = places.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or((rank, rank));
            let found = size(&pivot);
            if found <= 1e-13 * *largest.get_or_insert(found) {
                return rank;
            }
            matrix.swap(rank, pivot.0);
            matrix.iter_mut().for_each(|row| row.swap(rank, pivot.1));
            let (above, below) = matrix.split_at_mut(rank + 1);
            let top = &above[rank];
            for row in below {
                let factor = row[rank] / top[rank];
                for (x, y) in row[rank..].iter_mut().zip(&top[rank..]) {
                    *x -= factor * y;
                }
            }
        }
        rows.min(columns)
    }

    /// All roots at the wave number `k` (1/m) and the direction of the wave vector (rad).
    pub fn roots(&self, k: f64, direction: f64) -> PencilRoots {
        if self.is_singular {
            return PencilRoots::Singular { rank: self.generic_rank() };
        }
        // Number of roots if all equations were differential equations of their order in time.
        let time_order = |row: usize| {
            let own = self.scaled.system.higher_terms.iter().filter(|term| term.row == row);
            own.map(|term| usize::from(term.time_power)).max().unwrap_or(0).max(1)
        };
        let size: usize = (0..self.scaled.system.equations.len()).map(time_order).sum();
        let along = self.polynomial.along(direction);
        let count = along.coefficients_at(k).len() - 1;
        let mut guesses = self.generalised_eigenvalues(k, direction);
        // Infinite eigenvalues sort last.
        guesses.sort_by(|a, b| a.modulus().total_cmp(&b.modulus()));
        guesses.truncate(count);
        let mut finite = along.roots(k, &guesses).into_vec();
        finite.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        PencilRoots::Regular { infinite: size.saturating_sub(finite.len()), finite }
    }

    /// The finite generalised eigenvalues ς, 1/s, of the equilibrated pencil; empty for equations of higher order and
    /// for more than [`MAX_SIZE`](qz::MAX_SIZE) equations, or if an entry is not finite or QZ does not converge.
    pub fn generalised_eigenvalues(&self, k: f64, direction: f64) -> Vec<Complex64> {
        let system = &self.scaled.system;
        if !system.higher_terms.is_empty() || system.equations.len() > qz::MAX_SIZE {
            return Vec::new();
        }
        self.compute_generalised_eigenvalues(&mut Qz::default(), k, direction).to_vec()
    }

    /// Computes the [`generalised_eigenvalues`](Self::generalised_eigenvalues) in the workspace `qz`, without
    /// allocation.
    pub fn compute_generalised_eigenvalues<'q>(
        &self,
        qz: &'q mut Qz,
        k: f64,
        direction: f64,
    ) -> &'q [Complex64] {
        self.equilibrate(qz, k, direction);
        let v = &self.scaled.system.velocity;
        let (sin, cos) = direction.cr_sin_cos();
        let convection = Complex64::new(0.0, -k * (v[0] * cos + v[1] * sin));
        let Some(values) = qz.solve() else { return &[] };
        for value in &mut *values {
            *value = *value * self.scaled.rate_unit + convection;
        }
        values
    }

    /// Loads the pencil −(i k̂ (cos θ B̂¹ + sin θ B̂²) + Ĉ) − ς̂ Â of the scaled system, in the frame of the material,
    /// into `qz` and equilibrates it.
    pub fn equilibrate(&self, qz: &mut Qz, k: f64, direction: f64) {
        let s = &self.scaled.system;
        let size = s.equations.len().min(s.unknowns.len());
        let (sin, cos) = direction.cr_sin_cos();
        let k_scaled = k / self.scaled.wave_number_unit;
        let (first, second) = (k_scaled * cos, k_scaled * sin);
        qz.equilibrate(
            size,
            |i, j| {
                let at = (i, j);
                let wave = first * s.b[0][at].value + second * s.b[1][at].value;
                -Complex64::new(s.c[at].value, wave)
            },
            |i, j| s.a[(i, j)].value.into(),
        );
    }
}
