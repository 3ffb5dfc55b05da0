//! Plane waves in a solid given by its [rate equations](RateEquations), whose matrices are the inertia M, the tangent
//! stiffness D, the gradient operators Gⁱ, the operator Z of the spins and the relaxation R.
//!
//! With v = v̂ exp(ςt + ik n·x) and H(k) = ik Σ nᵢGⁱ + Z the stresses can be eliminated exactly,
//!
//! ```text
//! ς² M v̂ = −H* D H v̂,    M^(−½) H*DH M^(−½) = k²Γ + kN₁ + N₀,    ω² = −ς²,
//! ```
//!
//! where * is the conjugate transpose. The dispersion relation has one branch ω(k) for each velocity; the other roots
//! of the rate equations are ς = 0, self-equilibrated stresses. Γ is the acoustic tensor: its eigenvalues are the
//! squared characteristic speeds c². For symmetric D the matrices are Hermitian and every ω² is real; otherwise c² may
//! be complex (flutter) or negative (divergence). The relaxation R, of lower order, is included in [`roots`] only.

use crate::dense;
use crate::qz::Qz;
use models::LinearisedSystem;
use models::common::elementary::{Elementary, Modulus};
use models::common::product::{product, triple_product};
use models::common::rates::RateEquations;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

type ComplexMatrix = DMatrix<Complex64>;

/// Plane waves along one direction, split into decoupled families.
#[derive(Clone, Debug)]
pub struct DirectionalWaves {
    /// Families in the order of their first velocity in the basis (n, t₁, t₂).
    pub families: Vec<WaveFamily>,
}

/// A family of waves: velocities coupled with each other and decoupled from the rest.
#[derive(Clone, Debug)]
pub struct WaveFamily {
    /// Polarisation of the family.
    pub polarisation: Polarisation,
    /// Coefficients Γ, N₁, N₀ of k², k and 1.
    coefficients: [ComplexMatrix; 3],
    is_hermitian: bool,
}

/// Polarisation of a family of waves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Polarisation {
    /// Displacement along the wave vector.
    Longitudinal,
    /// Displacement normal to the wave vector, with or without microrotation.
    Transverse,
    /// Microrotation about an axis normal to the wave vector, without displacement.
    Rotation,
    /// Microrotation about the wave vector.
    Torsion,
    /// Coupled motions of several kinds.
    Coupled,
}

impl Polarisation {
    /// Name of the polarisation in output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Longitudinal => "longitudinal",
            Self::Transverse => "transverse",
            Self::Rotation => "rotation",
            Self::Torsion => "torsion",
            Self::Coupled => "coupled",
        }
    }
}

/// One branch of the dispersion relation at one wave number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveMode {
    /// Squared frequency ω², rad²/s².
    pub squared_frequency: Complex64,
    /// Slope dω²/dk along the direction of the wave vector, rad²·m/s²; the group speed is dω/dk = slope/(2ω).
    pub slope: Complex64,
}

/// Band gap: a frequency interval in which no wave of a family propagates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrequencyInterval {
    /// Lower end, rad/s.
    pub lower: f64,
    /// Upper end, rad/s; may be infinite.
    pub upper: f64,
}

/// Kind of a velocity in the basis (n, t₁, t₂), n the wave normal: along n or across it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Motion {
    TranslationAlong,
    TranslationAcross,
    SpinAlong,
    SpinAcross,
}

/// Relative size below which a coupling, speed or frequency counts as zero: a few hundred roundings of the largest
/// entry.
const ZERO_TOLERANCE: f64 = 1e-13;

/// Squared characteristic speeds c² along the unit vector `normal`, m²/s², by descending real part.
pub fn squared_speeds<const D: usize>(
    equations: &RateEquations<D>,
    normal: [f64; D],
) -> Vec<Complex64> {
    let mut all: Vec<Complex64> = DirectionalWaves::from_equations(equations, normal)
        .families
        .iter()
        .flat_map(WaveFamily::squared_speeds)
        .collect();
    all.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    all
}

/// All roots ς along the unit vector `normal` at the wave number `k` (1/m), 1/s, relaxation included: the eigenvalues
/// of the first-order equations. Roots that are zero within rounding (self-equilibrated stresses) are omitted. A single
/// NaN if an entry is not finite or the iteration does not converge.
pub fn roots<const D: usize>(
    equations: &RateEquations<D>,
    normal: [f64; D],
    k: f64,
) -> Vec<Complex64> {
    let mut system = LinearisedSystem::default();
    equations.linearise(&mut system);
    let (nv, ns) = (equations.velocity_count(), equations.stress_count());
    // Scale velocities by M^(−½) and stresses by the square root of the largest stiffness; A is diagonal.
    let largest = equations.stiffness_values().amax().sqrt();
    let unit = |i: usize| match i < nv {
        true => system.a[(i, i)].value.sqrt().recip(),
        false => largest,
    };
    let symbol = ComplexMatrix::from_fn(nv + ns, nv + ns, |i, j| {
        let along: f64 = (0..D).map(|axis| system.b[axis][(i, j)].value * normal[axis]).sum();
        let entry = Complex64::new(system.c[(i, j)].value, k * along);
        -entry * (unit(j) / (unit(i) * system.a[(i, i)].value))
    });
    let Some(roots) = dense::eigenvalues(symbol) else {
        return vec![Complex64::new(f64::NAN, f64::NAN)];
    };
    let largest = roots.iter().map(|root| root.modulus()).fold(0.0, f64::max);
    roots.iter().copied().filter(|root| root.modulus() > ZERO_TOLERANCE * largest).collect()
}

impl DirectionalWaves {
    /// Plane waves along the unit vector `normal`.
    pub fn from_equations<const D: usize>(equations: &RateEquations<D>, normal: [f64; D]) -> Self {
        DispersionForms::new(equations).waves_along(normal)
    }
}

/// Dispersion matrix of a solid as a function of the direction, for waves along many directions: with the velocities
/// scaled by M^(−½), in components along the coordinate axes,
///
/// ```text
/// Γ = Σ nᵢnⱼ Gⁱᵀ D Gʲ,    N₁ = i Σ nᵢ (Zᵀ D Gⁱ − Gⁱᵀ D Z),    N₀ = Zᵀ D Z.
/// ```
#[derive(Clone, Debug)]
pub struct DispersionForms<const D: usize> {
    /// Coefficients of nᵢnⱼ in Γ.
    second: [[DMatrix<f64>; D]; D],
    /// Coefficients of nᵢ in N₁, without the factor i.
    first: [DMatrix<f64>; D],
    /// N₀.
    zeroth: DMatrix<f64>,
    is_hermitian: bool,
}

impl<const D: usize> DispersionForms<D> {
    /// Computes the coefficients of rate equations.
    pub fn new(equations: &RateEquations<D>) -> Self {
        let stiffness = equations.stiffness_values();
        let scaled = |strain: &DMatrix<f64>| {
            DMatrix::from_fn(strain.nrows(), strain.ncols(), |stress, velocity| {
                strain[(stress, velocity)] * equations.inertia[velocity].value.sqrt().recip()
            })
        };
        let gradient = equations.gradient.each_ref().map(scaled);
        let rotation = scaled(&equations.rotation);
        let gradient_stress = gradient.each_ref().map(|own| product(&stiffness, own));
        let rotation_stress = product(&stiffness, &rotation);
        let between =
            |strain: &DMatrix<f64>, stress: &DMatrix<f64>| product(&strain.transpose(), stress);
        let asymmetry = (&stiffness - stiffness.transpose()).amax();
        Self {
            second: gradient
                .each_ref()
                .map(|own| gradient_stress.each_ref().map(|other| between(own, other))),
            first: std::array::from_fn(|axis| {
                between(&rotation, &gradient_stress[axis])
                    - between(&gradient[axis], &rotation_stress)
            }),
            zeroth: between(&rotation, &rotation_stress),
            is_hermitian: asymmetry <= ZERO_TOLERANCE * stiffness.amax(),
        }
    }

    /// Plane waves along the unit vector `normal`.
    pub fn waves_along(&self, normal: [f64; D]) -> DirectionalWaves {
        let size = self.zeroth.nrows();
        let (basis, motions) = build_velocity_basis(size, normal);
        let transposed = basis.transpose();
        let turned = |m: &DMatrix<f64>| triple_product(&transposed, m, &basis);
        let (mut second, mut first) = (DMatrix::zeros(size, size), DMatrix::zeros(size, size));
        for (i, row) in self.second.iter().enumerate() {
            first += &self.first[i] * normal[i];
            for (j, form) in row.iter().enumerate() {
                second += form * (normal[i] * normal[j]);
            }
        }
        let real = |m: DMatrix<f64>| m.map(|x| Complex64::new(x, 0.0));
        let coefficients = [
            real(turned(&second)),
            turned(&first).map(|x| Complex64::new(0.0, x)),
            real(turned(&self.zeroth)),
        ];
        let families = coupled_components(&coefficients).into_iter().map(|members| {
            let part = |m: &ComplexMatrix| {
                let block = m.select_rows(&members).select_columns(&members);
                if self.is_hermitian { (&block + block.adjoint()).scale(0.5) } else { block }
            };
            let own: Vec<Motion> = members.iter().map(|&i| motions[i]).collect();
            WaveFamily {
                polarisation: classify_polarisation(&own),
                coefficients: coefficients.each_ref().map(part),
                is_hermitian: self.is_hermitian,
            }
        });
        DirectionalWaves { families: families.collect() }
    }
}

/// Basis of `size` velocities, in columns: translations along (n, t₁, t₂), then spins about these axes, with their kinds.
fn build_velocity_basis<const D: usize>(
    size: usize,
    normal: [f64; D],
) -> (DMatrix<f64>, Vec<Motion>) {
    let axes = orthonormal_axes(normal);
    let mut basis = DMatrix::zeros(size, size);
    for (row, column) in (0..D).flat_map(|i| (0..D).map(move |j| (i, j))) {
        basis[(row, column)] = axes[column][row];
        // In the plane the only spin is about the third axis, for every wave normal.
        if size == 2 * D {
            basis[(D + row, D + column)] = axes[column][row];
        }
    }
    if size == D + 1 {
        basis[(D, D)] = 1.0;
    }
    let translations =
        (0..D).map(|i| if i == 0 { Motion::TranslationAlong } else { Motion::TranslationAcross });
    let spins = (D..size).map(|i| match i - D {
        0 if size == 2 * D => Motion::SpinAlong,
        _ => Motion::SpinAcross,
    });
    (basis, translations.chain(spins).collect())
}

/// Orthonormal vectors of which the first is `normal`.
fn orthonormal_axes<const D: usize>(normal: [f64; D]) -> [[f64; D]; D] {
    let mut axes = [[0.0; D]; D];
    axes[0] = normal;
    if D == 2 {
        axes[1][0] = -normal[1];
        axes[1][1] = normal[0];
        return axes;
    }
    // t₁ is the cross product of n with the coordinate axis farthest from n, which is the longest of the three.
    let least = (0..3).min_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
    let (i, j) = ((least + 1) % 3, (least + 2) % 3);
    let length = normal[i].root_sum_square(normal[j]);
    axes[1][i] = -normal[j] / length;
    axes[1][j] = normal[i] / length;
    for a in 0..3 {
        let (b, c) = ((a + 1) % 3, (a + 2) % 3);
        axes[2][a] = normal[b] * axes[1][c] - normal[c] * axes[1][b];
    }
    axes
}

/// Connected components of the velocities under the coupling of all matrices.
fn coupled_components(coefficients: &[ComplexMatrix; 3]) -> Vec<Vec<usize>> {
    let size = coefficients[0].nrows();
    let largest = coefficients.each_ref().map(|m| m.iter().fold(0.0f64, |a, b| a.max(b.modulus())));
    let couples = |i: usize, j: usize| {
        coefficients.iter().zip(largest).any(|(m, largest)| {
            m[(i, j)].modulus().max(m[(j, i)].modulus()) > ZERO_TOLERANCE * largest
        })
    };
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for i in 0..size {
        let (joined, apart): (Vec<_>, Vec<_>) =
            sets.into_iter().partition(|set| set.iter().any(|&j| couples(i, j)));
        let mut own: Vec<usize> = joined.into_iter().flatten().chain([i]).collect();
        own.sort_unstable();
        sets = apart;
        sets.push(own);
    }
    sets.sort();
    sets
}

/// Polarisation of a family with these kinds of velocities.
fn classify_polarisation(motions: &[Motion]) -> Polarisation {
    use Motion::{SpinAcross, SpinAlong, TranslationAcross, TranslationAlong};
    match motions {
        [TranslationAlong] => Polarisation::Longitudinal,
        [SpinAlong] => Polarisation::Torsion,
        _ if motions.iter().all(|&m| m == SpinAcross) => Polarisation::Rotation,
        _ if motions.iter().all(|&m| matches!(m, TranslationAcross | SpinAcross)) => {
            Polarisation::Transverse
        }
        _ => Polarisation::Coupled,
    }
}

impl WaveFamily {
    /// Number of branches.
    pub fn branch_count(&self) -> usize {
        self.coefficients[0].nrows()
    }

    /// Squared characteristic speeds c², m²/s², by descending real part.
    pub fn squared_speeds(&self) -> Vec<Complex64> {
        eigenvalues(&self.coefficients[0], self.is_hermitian)
    }

    /// Matrix k²Γ + kN₁ + N₀ of the dispersion relation, rad²/s², at the wave number `k` (1/m).
    fn dispersion_matrix(&self, k: f64) -> ComplexMatrix {
        let [second, first, zeroth] = &self.coefficients;
        second.scale(k * k) + first.scale(k) + zeroth
    }

    /// ω² of the branches at the wave number `k` (1/m), rad²/s², by ascending real part.
    pub fn squared_frequencies(&self, k: f64) -> Vec<Complex64> {
        let mut all = eigenvalues(&self.dispersion_matrix(k), self.is_hermitian);
        all.reverse();
        all
    }

    /// Returns the branches at the wave number `k` (1/m), by ascending Re ω², with their slopes. The slope is x*(2kΓ +
    /// N₁)x (Hellmann–Feynman) if the matrix is Hermitian; otherwise it is computed by central differences.
    pub fn modes(&self, k: f64) -> Vec<WaveMode> {
        if !self.is_hermitian {
            let step = 1e-5 * k;
            let [before, here, after] =
                [k - step, k, k + step].map(|k| self.squared_frequencies(k));
            // Conjugate pairs have no natural order: match each to the nearest.
            let nearest = |list: &[Complex64], to: Complex64| {
                let nearer = |a: Complex64, b: &Complex64| {
                    if (b - to).modulus() < (a - to).modulus() { *b } else { a }
                };
                list.iter().fold(list[0], nearer)
            };
            let slope = |square: Complex64| {
                (nearest(&after, square) - nearest(&before, square)) / (2.0 * step)
            };
            let mode =
                |&square: &Complex64| WaveMode { squared_frequency: square, slope: slope(square) };
            return here.iter().map(mode).collect();
        }
        let [second, first, _] = &self.coefficients;
        let rate = second.scale(2.0 * k) + first;
        let eigen = self.dispersion_matrix(k).symmetric_eigen();
        let mut modes: Vec<WaveMode> = (0..self.branch_count())
            .map(|i| {
                let x = eigen.eigenvectors.column(i);
                let slope = (x.adjoint() * &rate * x)[(0, 0)];
                WaveMode { squared_frequency: eigen.eigenvalues[i].into(), slope: slope.re.into() }
            })
            .collect();
        modes.sort_by(|a, b| a.squared_frequency.re.total_cmp(&b.squared_frequency.re));
        modes
    }

    /// ω² at k = 0, rad²/s², ascending: cut-off frequencies squared, and zeros.
    pub fn squared_cut_offs(&self) -> Vec<Complex64> {
        self.squared_frequencies(0.0)
    }

    /// The limits of ω² as k → ∞, rad²/s², ascending, of the branches whose characteristic speed is
    /// zero: on the null space of Γ, to second order of perturbation theory,
    ///
    /// ```text
    /// ω² → eig P (N₀ − N₁ Γ⁺ N₁) P.
    /// ```
    ///
    /// P is the projector onto the null space. Empty if no speed is zero, or D is not symmetric.
    pub fn squared_short_wave_limits(&self) -> Vec<f64> {
        if !self.is_hermitian {
            return Vec::new();
        }
        let [second, first, zeroth] = &self.coefficients;
        let eigen = second.clone().symmetric_eigen();
        let largest = eigen.eigenvalues.amax();
        let is_zero = |i: usize| eigen.eigenvalues[i].abs() <= ZERO_TOLERANCE * largest;
        let (null, moving): (Vec<usize>, Vec<usize>) =
            (0..self.branch_count()).partition(|&i| is_zero(i));
        if null.is_empty() {
            return Vec::new();
        }
        let still = eigen.eigenvectors.select_columns(&null);
        let mut limit = still.adjoint() * zeroth * &still;
        for i in moving {
            let x = eigen.eigenvectors.column(i);
            let coupling = still.adjoint() * first * x;
            limit -= (&coupling * coupling.adjoint()).unscale(eigen.eigenvalues[i]);
        }
        let mut limits: Vec<f64> = limit.symmetric_eigenvalues().iter().copied().collect();
        limits.sort_by(f64::total_cmp);
        limits
    }

    /// Returns the band gaps, ascending: frequency intervals in which no wave of the family propagates; empty if D is
    /// not symmetric. Assumes that branches are monotonic in k. This holds for two velocities: with λ = ω², (λ − ak²)(λ
    /// − d) = c²k² and ad ≥ c² give dλ/dk² ≥ 0 on both branches. Each branch begins at a cut-off and ends at a
    /// short-wave limit or at infinity; larger families have a branch from zero to infinity.
    pub fn band_gaps(&self) -> Vec<FrequencyInterval> {
        if !self.is_hermitian {
            return Vec::new();
        }
        let frequency = |square: f64| square.max(0.0).sqrt();
        let starts = self.squared_cut_offs();
        // Both lists ascend: branches of zero speed are the lowest at short waves.
        let limits = self.squared_short_wave_limits();
        let largest = starts.iter().map(|s| s.re).chain(limits.iter().copied()).fold(0.0, f64::max);
        let cleaned = |square: f64| if square <= 1e-12 * largest { 0.0 } else { square };
        let mut ranges: Vec<[f64; 2]> = (0..self.branch_count())
            .map(|branch| {
                let start = cleaned(starts[branch].re);
                let end = limits.get(branch).map_or(f64::INFINITY, |&limit| cleaned(limit));
                [frequency(start.min(end)), frequency(start.max(end))]
            })
            .collect();
        ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut bands = Vec::new();
        let mut reached = 0.0;
        for [low, high] in ranges {
            if low > reached * (1.0 + 1e-12) {
                bands.push(FrequencyInterval { lower: reached, upper: low });
            }
            reached = f64::max(reached, high);
        }
        if reached.is_finite() {
            bands.push(FrequencyInterval { lower: reached, upper: f64::INFINITY });
        }
        bands
    }
}

/// Eigenvalues of a matrix by descending real part; NaN if the QZ iteration does not converge.
fn eigenvalues(matrix: &ComplexMatrix, is_hermitian: bool) -> Vec<Complex64> {
    let size = matrix.nrows();
    let mut values: Vec<Complex64> = match size {
        1 => vec![matrix[(0, 0)]],
        _ if is_hermitian => {
            matrix.symmetric_eigenvalues().iter().map(|&x| Complex64::new(x, 0.0)).collect()
        }
        2 => eigenvalues_2x2(matrix).to_vec(),
        _ => {
            let mut qz = Qz::default();
            let identity = |i, j| Complex64::new(f64::from(u8::from(i == j)), 0.0);
            qz.equilibrate(size, |i, j| matrix[(i, j)], identity);
            match qz.solve() {
                Some(values) => values.to_vec(),
                None => vec![Complex64::new(f64::NAN, f64::NAN); size],
            }
        }
    };
    values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    values
}

/// Eigenvalues of a 2 × 2 matrix: m ± √(h² + bc) with half sum m and half difference h of the diagonal.
fn eigenvalues_2x2(matrix: &ComplexMatrix) -> [Complex64; 2] {
    let (a, d) = (matrix[(0, 0)], matrix[(1, 1)]);
    let (middle, half) = ((a + d) * 0.5, (a - d) * 0.5);
    let root = (half * half + matrix[(0, 1)] * matrix[(1, 0)]).sqrt();
    [middle + root, middle - root]
}

/// Frequencies (rad/s, positive, descending) and amplitudes of the plane waves of an elastic solid with the wave vector
/// κ, 1/m: U = Re û exp(i(κ·x − ωt)), in the order of the unknowns.
///
/// Solves L⁻¹(iκB + Q)L⁻ᵀ y = −iω y with A = LLᵀ and a skew-Hermitian matrix; û = L⁻ᵀy. Empty if the equations have no
/// symmetric form with a positive definite A. Zero frequencies are omitted.
pub fn plane_waves<const D: usize>(
    equations: &RateEquations<D>,
    wave_vector: [f64; D],
) -> Vec<(f64, DVector<Complex64>)> {
    /// Frequencies below this fraction of the largest count as zero.
    const ZERO_FREQUENCY_TOLERANCE: f64 = 1e-9;
    let Some(form) = equations.symmetric_form() else { return Vec::new() };
    let inverse = form.a.cholesky().and_then(|factor| factor.l().try_inverse());
    let Some(inverse) = inverse else { return Vec::new() };
    let scaled = |m: &DMatrix<f64>| triple_product(&inverse, m, &inverse.transpose());
    let mut symbol = scaled(&form.q).map(|x| Complex64::new(0.0, x));
    for (b, k) in form.b.iter().zip(wave_vector) {
        symbol += scaled(b).map(|x| Complex64::new(-k * x, 0.0));
    }
    // The symbol is Hermitian up to rounding; symmetrise it.
    let eigen = (&symbol + symbol.adjoint()).scale(0.5).symmetric_eigen();
    let greatest = eigen.eigenvalues.amax();
    let back = inverse.transpose().map(Complex64::from);
    let mut waves: Vec<(f64, DVector<Complex64>)> = eigen
        .eigenvalues
        .iter()
        .enumerate()
        .filter(|(_, frequency)| **frequency > ZERO_FREQUENCY_TOLERANCE * greatest)
        .map(|(i, frequency)| (*frequency, &back * eigen.eigenvectors.column(i)))
        .collect();
    waves.sort_by(|a, b| b.0.total_cmp(&a.0));
    waves
}
