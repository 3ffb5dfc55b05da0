//! The printed errors of Harris & Grekova (2005), one test per erratum.
//!
//! Each test holds the printed formula and the corrected one against a truth that uses neither: the
//! derivative of the nonlinear equations, an elimination carried out in complex arithmetic, or a
//! determinant expanded in 31 digits. It fails when the corrected form misses the truth, and it
//! fails when the printed form would do as well (then the erratum is none).
//!
//! Numbering of rows and columns as in the paper for ν = 0: rows momentum 1, 2, spin, continuity,
//! rotation; columns v₁, v₂, ω, p, ψ. Indices in code count from zero: e₁₄ is `e[0][3]`.

mod support;

use support::equations::{SPIN, linearised};
use support::states::{self, Dilatancy};
use support::{
    Complex, Polynomial, Random, Real, Wide, complex, determinant, evaluate, product,
    quadratic_roots, wide,
};
use testkit::flows::Parameters;
use wellposed_models::flow::harris_grekova::parameters::HarrisGrekova;
use wellposed_models::flow::state::{Coulomb, Flow, State};
use wellposed_models::registry;

const STATES: usize = 250;

/// 31 digits, minus those that sums of a few hundred products lose.
const EXACT: f64 = 1e-22;
/// A printed form counts as wrong beyond this fraction of the truth's own size; the states are
/// generic, so a wrong form is off by a number of order one in nearly all of them.
const WRONG: f64 = 1e-4;

/// An incompressible background and its linearisation, from the nonlinear equations.
struct Incompressible {
    parameters: Parameters,
    state: State,
    flow: Flow,
    /// Columns v₁ v₂ ω p ψ.
    a: [[Wide; 5]; 5],
    b: [[[Wide; 5]; 5]; 2],
    c: [[Wide; 5]; 5],
    spin: Wide,
    q: Wide,
}

impl Incompressible {
    fn random(random: &mut Random) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(random, kind, Dilatancy::Zero);
        let state = states::random_state(random, kind, Dilatancy::Zero);
        Self::new(random, parameters, state)
    }

    fn new(random: &mut Random, parameters: Parameters, state: State) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let model = states::model(kind, &parameters);
        let flow = states::flow(&model, &state);
        let (given, fields) = states::exact_point(random, &parameters, kind, &state, &flow);
        let full = linearised(&given, &fields);
        // For ν = 0 the volume row (50) is cos φ times the continuity row of eqs (81)–(86).
        let cosine = given.friction_angle.cos();
        let cut = |m: [[Wide; 6]; 6]| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| if i == 3 { m[i][j] / cosine } else { m[i][j] })
            })
        };
        Self {
            parameters,
            state,
            flow,
            a: cut(full.a),
            b: full.b.map(cut),
            c: cut(full.c),
            spin: fields.z[SPIN],
            q: given.friction_angle.sin() * fields.z[3] + given.cohesion * cosine,
        }
    }

    /// The same with no gradients but the velocity's.
    fn uniform(random: &mut Random) -> Self {
        let kind = registry::HARRIS_GREKOVA;
        let parameters = states::random_parameters(random, kind, Dilatancy::Zero);
        let state = State {
            pressure_gradient: [0.0; 2],
            stress_angle_gradient: [0.0; 2],
            spin_gradient: [0.0; 2],
            inertia_gradient: [0.0; 2],
            inertia_rate: 0.0,
            ..states::random_state(random, kind, Dilatancy::Zero)
        };
        Self::new(random, parameters, state)
    }

    fn phi(&self) -> Wide {
        wide(self.parameters.friction_angle)
    }
    fn density(&self) -> Wide {
        wide(self.state.density)
    }
    fn inertia(&self) -> Wide {
        wide(self.parameters.moment_of_inertia.expect("Harris–Grekova has one"))
    }
    /// cos 2Δ
    fn coaxiality(&self) -> Wide {
        let delta = wide(self.flow.noncoaxiality);
        (delta + delta).cos()
    }
    /// Direction (cos θ, sin θ) with β = 2(Ψ_Σ − θ).
    fn direction(&self, beta: Wide) -> [Wide; 2] {
        let (s, c) = (wide(self.state.stress_angle) - beta * wide(0.5)).sin_cos();
        [c, s]
    }

    /// E = i k·B + C (eqs 92, 93).
    fn e(&self, wave: [Wide; 2]) -> [[Complex; 5]; 5] {
        std::array::from_fn(|i| {
            std::array::from_fn(|j| Complex {
                re: self.c[i][j],
                im: wave[0] * self.b[0][i][j] + wave[1] * self.b[1][i][j],
            })
        })
    }

    /// det(A ς + E), exactly (eq. 97).
    fn dispersion(&self, wave: [Wide; 2]) -> Polynomial {
        let e = self.e(wave);
        let matrix: Vec<Vec<Polynomial>> = (0..5)
            .map(|i| {
                (0..5)
                    .map(|j| match (self.a[i][j].high != 0.0, e[i][j].abs() != 0.0) {
                        (true, _) => vec![e[i][j], self.a[i][j].into()],
                        (false, true) => vec![e[i][j]],
                        (false, false) => vec![],
                    })
                    .collect()
            })
            .collect();
        determinant(&matrix)
    }
}

/// The constituents of the paper's elimination, eqs (103)–(105), the ones without errors as
/// printed, the others corrected.
#[derive(Clone, Copy)]
struct Elimination {
    e: [[Complex; 5]; 5],
    density: Complex,
    f: Complex,
    g: Complex,
    /// Coefficients of v₁, v₂ in the numerators of p (row 0) and ψ (row 1).
    fs: [[Complex; 2]; 2],
    /// Coefficients of ρς v₁, ρς v₂, ρς ω in the same.
    gs: [[Complex; 3]; 2],
}

impl Elimination {
    fn new(system: &Incompressible, wave: [Wide; 2]) -> Self {
        let e = system.e(wave);
        let (c53, c55) = (e[4][2], e[4][4]);
        let velocity = e[3][1] * e[4][0] - e[3][0] * e[4][1];
        let [e14, e15, e24, e25] = [e[0][3], e[0][4], e[1][3], e[1][4]];
        let (along_p, along_psi) = (e[3][0] * e14 + e[3][1] * e24, e[3][0] * e15 + e[3][1] * e25);
        Self {
            e,
            density: system.density().into(),
            f: (e14 * e25 - e15 * e24) * velocity,
            g: c55 * along_p,
            fs: [
                [
                    (e[1][0] * e15 - e[0][0] * e25) * velocity,
                    (e15 * e[1][1] - e25 * e[0][1]) * velocity,
                ],
                [
                    -((e14 * e[1][0] - e24 * e[0][0]) * velocity),
                    -((e14 * e[1][1] - e24 * e[0][1]) * velocity),
                ],
            ],
            gs: [
                [
                    -(c55 * (e[0][0] * e[3][0] + e[3][1] * e[1][0])),
                    -(c55 * (e[3][0] * e[0][1] + e[3][1] * e[1][1])),
                    c53 * along_psi,
                ],
                [Complex::default(), Complex::default(), -(c53 * along_p)],
            ],
        }
    }

    /// p and ψ from v₁, v₂, ω by Cramer's rule: continuity times momentum (99), and rotation times
    /// momentum with the frequency carried over by the rotation row itself (100), multiplied out
    /// here from the rows and not from the printed equations. Times f + gρς.
    fn directly(&self, frequency: Complex, v: [Complex; 3]) -> [Complex; 2] {
        let e = &self.e;
        let rs = self.density * frequency;
        let along = |row: usize, column: usize| e[row][0] * e[0][column] + e[row][1] * e[1][column];
        let rotation = |column: usize| along(4, column) - rs * e[4][column];
        let matrix = [[along(3, 3), along(3, 4)], [rotation(3), rotation(4)]];
        let right = [
            -(along(3, 0) * v[0] + along(3, 1) * v[1]),
            -(along(4, 0) * v[0] + along(4, 1) * v[1] + rotation(2) * v[2]),
        ];
        let determinant = matrix[0][0] * matrix[1][1] - matrix[0][1] * matrix[1][0];
        let common = self.f + self.g * rs;
        [
            (right[0] * matrix[1][1] - right[1] * matrix[0][1]) / determinant * common,
            (right[1] * matrix[0][0] - right[0] * matrix[1][0]) / determinant * common,
        ]
    }

    /// Entries of the two momentum rows after the elimination, times f + gρς; column 0, 1, 2.
    fn reduced_directly(&self, frequency: Complex, row: usize, column: usize) -> Complex {
        let mut v = [Complex::default(); 3];
        v[column] = complex(1.0, 0.0);
        let [p, psi] = self.directly(frequency, v);
        let rs = self.density * frequency;
        let mut own = self.e[row][column];
        if row == column {
            own = own + rs;
        }
        own * (self.f + self.g * rs) + self.e[row][3] * p + self.e[row][4] * psi
    }

    /// h_ij of eq. (107) with the columns `p` and `psi` (zero-based) for those of e.
    fn h(&self, row: usize, column: usize, p: usize, psi: usize) -> Complex {
        let mut h = self.e[row][p] * self.gs[0][column] + self.e[row][psi] * self.gs[1][column];
        if column < 2 {
            h = h + self.e[row][column] * self.g;
            if row == column {
                h = h + self.f;
            }
        }
        h
    }

    /// F of eq. (110) as polynomials in ς.
    fn reduced(&self, inertia: Wide) -> Vec<Vec<Polynomial>> {
        let rho = self.density;
        let mut matrix: Vec<Vec<Polynomial>> = (0..2)
            .map(|i| {
                (0..3)
                    .map(|j| {
                        let mut entry = vec![Complex::default(), self.h(i, j, 3, 4) * rho];
                        if i == j {
                            entry.push(self.g * rho * rho);
                        }
                        entry
                    })
                    .collect()
            })
            .collect();
        matrix.push(vec![
            vec![self.e[2][0]],
            vec![self.e[2][1]],
            vec![self.e[2][2], rho * inertia.into()],
        ]);
        matrix
    }
}

fn random_wave(random: &mut Random) -> [Wide; 2] {
    [wide(random.generic(0.3, 5.0)), wide(random.generic(0.3, 5.0))]
}

fn random_complex(random: &mut Random) -> Complex {
    complex(random.generic(0.3, 3.0), random.generic(0.3, 3.0))
}

/// Counts where a printed form misses the truth and insists on the corrected one.
#[derive(Default)]
struct Comparison {
    compared: usize,
    printed_wrong: usize,
}

impl Comparison {
    /// `size`: of the terms that make up the truth.
    fn add(&mut self, truth: Complex, printed: Complex, corrected: Complex, size: f64) {
        let size = size.max(truth.abs());
        let corrected = (corrected - truth).abs();
        assert!(
            corrected <= EXACT * size,
            "the corrected form is off by {corrected:e} of {size:e}"
        );
        self.compared += 1;
        self.printed_wrong += usize::from((printed - truth).abs() > WRONG * size);
    }

    /// The printed form is wrong in practically every generic state.
    fn finish(self) {
        assert!(self.compared >= 200);
        assert!(
            self.printed_wrong * 100 >= self.compared * 95,
            "the printed form holds in {} of {}",
            self.compared - self.printed_wrong,
            self.compared
        );
    }
}

/// c₅₅ is printed as −2 Q_D cos 2Δ; the rotation equation's derivative with respect to ψ is twice
/// that.
#[test]
fn eq_83_c55() {
    let mut random = Random::new(1);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let unit = wide(system.state.shear_rate) * system.coaxiality();
        let (printed, corrected) = (-(unit * wide(2.0)), -(unit * wide(4.0)));
        let truth = system.c[4][4];
        comparison.add(truth.into(), printed.into(), corrected.into(), truth.value().abs());
    }
    comparison.finish();
}

/// c₃₁, c₃₂ are printed as ρI ∂ⱼΩ; the prescribed moment of inertia is convected as well.
#[test]
fn eq_83_c31_c32() {
    let mut random = Random::new(2);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        for j in 0..2 {
            let printed = system.density() * system.inertia() * wide(system.state.spin_gradient[j]);
            let inertia = wide(system.state.inertia_gradient[j]);
            let corrected = printed + system.density() * system.spin * inertia;
            let truth = system.c[2][j];
            comparison.add(truth.into(), printed.into(), corrected.into(), 0.0);
        }
    }
    comparison.finish();
}

/// B²₅₁ is printed as sin φ.
#[test]
fn eq_86_b51() {
    let mut random = Random::new(3);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let angle = wide(system.state.stress_angle);
        let printed = system.phi().sin();
        let corrected = printed + (angle + angle).cos();
        comparison.add(system.b[1][4][0].into(), printed.into(), corrected.into(), 1.0);
    }
    comparison.finish();
}

/// Q_Σ is printed with 4Σ₁₂², which is the deviator only of a symmetric stress. Truth: the deviator
/// that the stress was made from, r = ±m.
#[test]
fn eq_87_deviator() {
    let mut random = Random::new(4);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let (p, r) = (wide(system.state.pressure), wide(system.flow.stress.rotational));
        let angle = wide(system.state.stress_angle);
        let (s, c) = (angle + angle).sin_cos();
        let q = system.q;
        let stress = [[-p + q * c, r + q * s], [-r + q * s, -p - q * c]];
        let normal = stress[0][0] - stress[1][1];
        let deviator = |shear: Wide| (normal * normal + shear * shear).sqrt() * wide(0.5);
        let printed = deviator(stress[0][1] + stress[0][1]);
        let corrected = deviator(stress[0][1] + stress[1][0]);
        comparison.add(q.into(), printed.into(), corrected.into(), 0.0);
        // The crate's tensor leads to the same deviator.
        let tensor = system.flow.stress.tensor();
        let own = 0.5 * (tensor[0][0] - tensor[1][1]).hypot(tensor[0][1] + tensor[1][0]);
        assert!((own / q.value() - 1.0).abs() < 1e-14);
    }
    comparison.finish();
}

/// Eq. (100): e₅₁ × first + e₅₂ × second momentum row. Printed with the coefficient of ψ for that of
/// p. Truth: the rows themselves, summed at an amplitude that satisfies the rotation row.
#[test]
fn eq_100_coefficient_of_pressure() {
    let mut random = Random::new(5);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let e = system.e(random_wave(&mut random));
        let frequency = random_complex(&mut random);
        let mut z: [Complex; 5] = std::array::from_fn(|_| random_complex(&mut random));
        // Pressures of the size of the other terms.
        z[3] = z[3] * complex(system.state.density, 0.0);
        z[2] = -((e[4][0] * z[0] + e[4][1] * z[1] + e[4][4] * z[4]) / e[4][2]);
        let rs = Complex::from(system.density()) * frequency;
        let row = |i: usize| (0..5).fold(rs * z[i], |sum, j| sum + e[i][j] * z[j]);
        let truth = e[4][0] * row(0) + e[4][1] * row(1);
        let both = |j: usize| e[4][0] * e[0][j] + e[4][1] * e[1][j];
        let others =
            both(0) * z[0] + both(1) * z[1] - rs * e[4][2] * z[2] + (both(4) - e[4][4] * rs) * z[4];
        let printed_pressure = (e[0][4] * e[4][0] + e[1][4] * e[4][1]) * z[3];
        let size = others.abs() + printed_pressure.abs() + (both(3) * z[3]).abs();
        comparison.add(truth, others + printed_pressure, others + both(3) * z[3], size);
    }
    comparison.finish();
}

/// Eqs (101)–(104): f₅₁ is printed with e₁₅, e₂₅. Truth: ψ for v = (1, 0), ω = 0 by elimination. The
/// other three of (104) and (101), (102) themselves hold.
#[test]
fn eq_104_f51() {
    let mut random = Random::new(6);
    let mut comparison = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let own = Elimination::new(&system, random_wave(&mut random));
        let frequency = random_complex(&mut random);
        let rs = own.density * frequency;
        let (e, mut size) = (&own.e, 0.0f64);
        for column in 0..2 {
            let mut v = [Complex::default(); 3];
            v[column] = complex(1.0, 0.0);
            let truth = own.directly(frequency, v);
            let numerators = [0, 1].map(|i| own.fs[i][column] + own.gs[i][column] * rs);
            for (numerator, truth) in numerators.into_iter().zip(truth) {
                assert!((numerator - truth).abs() <= EXACT * truth.abs());
            }
            size = size.max(truth[1].abs());
        }
        let truth = own.directly(frequency, [complex(1.0, 0.0), 0.0.into(), 0.0.into()])[1];
        let velocity = e[3][0] * e[4][1] - e[3][1] * e[4][0];
        let printed = (e[0][4] * e[1][0] - e[1][4] * e[0][0]) * velocity;
        comparison.add(truth, printed, own.fs[1][0], size);
    }
    comparison.finish();
}

/// Eq. (105): g₄₃ is printed twice, with both signs of what is −g₅₃. Truth: p and ψ for v = 0,
/// ω = 1 by elimination.
#[test]
fn eq_105_g43_g53() {
    let mut random = Random::new(7);
    let (mut first, mut second) = (Comparison::default(), Comparison::default());
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let own = Elimination::new(&system, random_wave(&mut random));
        let frequency = random_complex(&mut random);
        let rs = own.density * frequency;
        let e = &own.e;
        let [p, psi] = own.directly(frequency, [0.0.into(), 0.0.into(), complex(1.0, 0.0)]);
        let printed = e[4][2] * (e[3][0] * e[0][3] + e[3][1] * e[1][3]);
        first.add(p, printed * rs, own.gs[0][2] * rs, 0.0);
        second.add(p, -(printed * rs), own.gs[0][2] * rs, 0.0);
        // The second line is g₅₃.
        assert!((psi + printed * rs).abs() <= EXACT * psi.abs());
    }
    first.finish();
    second.finish();
}

/// Eq. (107): columns 5, 6 are printed where the 5×5 system has its columns 4, 5 (p, ψ). Truth: the
/// reduced momentum rows by elimination at two frequencies. There is no sixth column; whichever
/// column is taken for it, the printed form fails. Eq. (108), i = 0, holds with the correction only.
#[test]
fn eq_107_columns() {
    let mut random = Random::new(8);
    let mut comparisons: [Comparison; 6] = Default::default();
    let mut vanishing = Comparison::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let own = Elimination::new(&system, random_wave(&mut random));
        for (number, comparison) in comparisons.iter_mut().enumerate() {
            let (row, column) = (number / 3, number % 3);
            // Without g ρ²ς² on the diagonal and divided by ρς, what is left is h + i/(ρς).
            let [first, second] =
                [random_complex(&mut random), random_complex(&mut random)].map(|frequency| {
                    let rs = own.density * frequency;
                    let entry = own.reduced_directly(frequency, row, column);
                    let diagonal = if row == column { own.g * rs * rs } else { 0.0.into() };
                    (entry - diagonal, rs)
                });
            let truth = (first.0 - second.0) / (first.1 - second.1);
            let constant = first.0 - truth * first.1;
            let size = first.0.abs().max(second.0.abs()) / first.1.abs().min(second.1.abs());
            let f = if column < 2 {
                own.e[row][3] * own.fs[0][column] + own.e[row][4] * own.fs[1][column]
            } else {
                0.0.into()
            };
            assert!(constant.abs() <= EXACT * size * first.1.abs(), "eq. (108)");
            for sixth in 0..5 {
                let printed = own.h(row, column, 4, sixth);
                comparison.add(truth, printed, own.h(row, column, 3, 4), 0.0);
            }
            if column < 2 {
                let i = own.e[row][column] * own.f;
                let printed = own.e[row][4] * own.fs[0][column];
                vanishing.add(0.0.into(), i + printed, i + f, i.abs());
            }
        }
    }
    comparisons.into_iter().for_each(Comparison::finish);
    vanishing.finish();
}

/// Eqs (123)–(125) hold as printed once (105), (107) are corrected.
/// Eq. (126): b₄ⱼ is printed for e₄ⱼ; a coefficient of one axis has not even the right power of k.
#[test]
fn eq_126_e4j() {
    let mut random = Random::new(9);
    let mut comparisons: [Comparison; 2] = Default::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let own = Elimination::new(&system, random_wave(&mut random));
        let e = &own.e;
        let h = |i: usize, j: usize| own.h(i, j, 3, 4);
        let (c31, c32, c53, c55) = (e[2][0], e[2][1], e[4][2], e[4][4]);
        let stress = e[0][3] * e[1][4] - e[0][4] * e[1][3];
        let bracket = e[3][1] * (e[0][0] * e[1][3] - e[0][3] * e[1][0])
            + e[3][0] * (e[1][1] * e[0][3] - e[1][3] * e[0][1]);
        let equal = |a: Complex, b: Complex, size: f64| (a - b).abs() <= EXACT * size;

        assert!(equal(h(0, 0) + h(1, 1), own.f + own.f + c55 * bracket, own.f.abs()), "(123)");
        let products = [h(0, 0) * h(1, 1), h(0, 1) * h(1, 0)];
        let size = products[0].abs() + products[1].abs();
        let printed = own.f * own.f + c55 * bracket * own.f;
        assert!(equal(products[0] - products[1], printed, size), "(124)");
        let products = [c31 * h(0, 2), c32 * h(1, 2)];
        let size = products[0].abs() + products[1].abs();
        let printed = c53 * stress * (c31 * e[3][1] - c32 * e[3][0]);
        assert!(equal(products[0] + products[1], printed, size), "(125)");

        let products = [
            c32 * (h(0, 2) * h(1, 0) - h(0, 0) * h(1, 2)),
            c31 * (h(0, 1) * h(1, 2) - h(0, 2) * h(1, 1)),
        ];
        let size = products[0].abs() + products[1].abs();
        let with = |e41: Complex, e42: Complex| c53 * (c32 * e41 - c31 * e42) * stress * own.f;
        for (axis, comparison) in comparisons.iter_mut().enumerate() {
            let b = &system.b[axis][3];
            let printed = with(b[0].into(), b[1].into());
            comparison.add(products[0] + products[1], printed, with(e[3][0], e[3][1]), size);
        }
    }
    comparisons.into_iter().for_each(Comparison::finish);
}

/// A₁/k⁸ of eq. (138): ē₅₂ is printed for ē₄₂ in its first brace, ē₂₅ for ē₂₄ in its second. Truth:
/// the coefficient of (ρς)³ of det F (110), expanded. With either misprint alone it fails.
#[test]
fn eq_138_scaled_coefficient() {
    let mut random = Random::new(10);
    let mut comparisons: [Comparison; 3] = Default::default();
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let wave = random_wave(&mut random);
        let own = Elimination::new(&system, wave);
        let k = Complex::from((wave[0] * wave[0] + wave[1] * wave[1]).sqrt());
        let bar = own.e.map(|row| row.map(|x| x / k));
        let k2 = k * k;
        let (f, g) = (own.f / (k2 * k2), own.g / k2);
        let inertia = Complex::from(system.inertia());
        let [c12, c21, c31, c32] = [bar[0][1], bar[1][0], bar[2][0], bar[2][1]];
        let [c53, c55] = [bar[4][2], bar[4][4]];
        let stress = bar[0][3] * bar[1][4] - bar[0][4] * bar[1][3];
        let value = |e42: Complex, e24: Complex| {
            let bracket = |e42: Complex, e24: Complex| {
                e42 * (bar[0][0] * bar[1][3] - bar[0][3] * c21)
                    + bar[3][0] * (bar[1][1] * bar[0][3] - e24 * c12)
            };
            let e33 = bar[2][2];
            inertia * f * f
                + (inertia * c55 * bracket(e42, bar[1][3]) + (e33 + e33) / k * g) * f
                + (c55 * e33 * bracket(bar[3][1], e24)
                    - c53 * (c31 * bar[3][1] - c32 * bar[3][0]) * stress)
                    / k
                    * g
        };
        let rho = own.density;
        let expanded = determinant(&own.reduced(system.inertia()));
        let truth = expanded[3] / (rho * rho * rho) / (k2 * k2 * k2 * k2);
        let corrected = value(bar[3][1], bar[1][3]);
        let printed =
            [value(bar[4][1], bar[1][4]), value(bar[4][1], bar[1][3]), value(bar[3][1], bar[1][4])];
        for (comparison, printed) in comparisons.iter_mut().zip(printed) {
            // The terms with the misprints are small beside I f², the rounding is not: what
            // counts as wrong is any deviation of a million times the tolerance.
            let size = truth.abs();
            let off = (corrected - truth).abs();
            assert!(off <= EXACT * size, "corrected (138) is off by {off:e} of {size:e}");
            comparison.compared += 1;
            comparison.printed_wrong += usize::from((printed - truth).abs() > 1e6 * EXACT * size);
        }
    }
    comparisons.into_iter().for_each(Comparison::finish);
}

/// Eq. (149), for whose c₅₅ the printed (83) was used, is twice too large. Truth: the larger root of
/// the exact determinant at k = 1e9 1/m in a uniform background, where corrections are of relative
/// size 1/k² (a few thousand over 1e18).
#[test]
fn eq_149_leading_root() {
    let mut random = Random::new(11);
    for _ in 0..STATES {
        let system = Incompressible::uniform(&mut random);
        let beta = wide(random.generic(0.0, 3.0));
        let gap = beta.cos() - system.phi().sin();
        if gap.value().abs() < 0.05 {
            continue;
        }
        let k = 1e9;
        let wave = system.direction(beta).map(|x| x * wide(k));
        let root = quadratic_roots(&system.dispersion(wave))[0] / complex(k * k, 0.0);
        let below = system.density()
            * wide(system.state.shear_rate)
            * system.coaxiality()
            * (wide(1.0) - system.phi().sin() * beta.cos());
        let printed = (-(system.q * gap * gap / below)).value();
        let off = |x: f64| (root - complex(x, 0.0)).abs() / root.abs();
        // ς/k² has the imaginary part −k·V/k², below 1e-6 of the rest here at |gap| ≥ 0.05.
        assert!(off(printed) > 0.9, "the printed (149) holds");
        assert!(off(printed / 2.0) < 1e-5, "off by {:e}", off(printed / 2.0));
        assert!((root.re.value() / (printed / 2.0) - 1.0).abs() < 1e-12);
    }
}

/// Eq. (150) against the halved (149), of which it is another form: printed with sin⁴ for one of the
/// sines and a factor 4.
#[test]
fn eq_150_product_of_sines() {
    let mut random = Random::new(12);
    let mut comparisons: [Comparison; 2] = Default::default();
    for _ in 0..STATES {
        let phi = wide(random.within(0.15, 1.2));
        let x = wide(random.generic(0.05, 1.5));
        let quarter = support::RIGHT_ANGLE * wide(0.5);
        let half = phi * wide(0.5);
        let gap = (x + x).cos() - phi.sin();
        let truth = gap * gap * wide(0.5);
        let (first, second) = ((x + quarter - half).sin(), (x - quarter + half).sin());
        let (first, second) = (first * first, second * second);
        let corrected = first * second * wide(2.0);
        // The extra square, and without it the factor.
        let printed = [wide(4.0) * first * second * second, wide(4.0) * first * second];
        for (comparison, printed) in comparisons.iter_mut().zip(printed) {
            comparison.add(truth.into(), printed.into(), corrected.into(), 1e-3);
        }
    }
    comparisons.into_iter().for_each(Comparison::finish);
}

/// Eq. (160): the degenerate wave vectors (154) have the direction (−sin, cos) of Ψ ± ε; printed with
/// (sin, cos). Truth: the stress and the velocity characteristics (67), (68), from the matrices.
#[test]
fn eq_160_degenerate_directions() {
    let mut random = Random::new(13);
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let epsilon = support::RIGHT_ANGLE * wide(0.5) + system.phi() * wide(0.5);
        for epsilon in [epsilon, -epsilon] {
            let (s, c) = (wide(system.state.stress_angle) + epsilon).sin_cos();
            let factors = |wave: [Wide; 2]| {
                let e =
                    |i: usize, j: usize| wave[0] * system.b[0][i][j] + wave[1] * system.b[1][i][j];
                let stress = e(0, 3) * e(1, 4) - e(0, 4) * e(1, 3);
                let velocity = e(3, 1) * e(4, 0) - e(3, 0) * e(4, 1);
                [stress.value().abs() / system.q.value(), velocity.value().abs()]
            };
            assert!(factors([-s, c]).iter().all(|x| *x < 1e-28));
            // For the printed form both are 2|sin Ψ| × a factor, zero only for special Ψ.
            let special = (s * c).value().abs() < 1e-2;
            assert!(special || factors([s, c]).iter().all(|x| *x > 1e-3));
        }
    }
}

/// Eq. (121): det F (110) is a quintic, but its factor ς²(f + gρς) was brought in by the elimination.
/// Truth: det(Aς + E) expanded in 31 digits; the coefficients of ς³, ς⁴, ς⁵ are reached by no
/// permutation, so they are exactly absent, and det F is that factor times the determinant.
#[test]
fn eq_121_spurious_factor() {
    let mut random = Random::new(14);
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let wave = random_wave(&mut random);
        let exact = system.dispersion(wave);
        assert_eq!(exact.len(), 3, "det(Aς + E) has degree 2");
        let own = Elimination::new(&system, wave);
        let quintic = determinant(&own.reduced(system.inertia()));
        assert_eq!(quintic.len(), 6, "det F is a quintic");

        let zero = Complex::default();
        let spurious = [zero, zero, own.f, own.g * own.density];
        let expected = product(&spurious, &exact);
        // Equal up to a constant factor (momentum rows times f + gρς, and ρ², and signs).
        let factor = quintic[5] / expected[5];
        for (degree, (&q, &x)) in quintic.iter().zip(&expected).enumerate() {
            let size = quintic.iter().map(|c| c.abs()).fold(0.0, f64::max);
            assert!((q - factor * x).abs() <= 1e-20 * size, "coefficient of ς^{degree}");
        }
        // The crate's pencil has the same degree.
        let model = states::model(registry::HARRIS_GREKOVA, &system.parameters);
        let own = states::symbol(&model, &system.flow);
        assert_eq!(states::dispersion(&own, wave).len(), 3);
    }
}

/// Eq. (131): of its cubic's three roots −f/(gρ) is none of the system's, and neither is the "neutral"
/// ς = 0 of the text before it: the determinant does not vanish there.
#[test]
fn eq_131_roots_that_are_none() {
    let mut random = Random::new(15);
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let wave = random_wave(&mut random);
        let exact = system.dispersion(wave);
        let own = Elimination::new(&system, wave);
        let claimed = -(own.f / (own.g * own.density));
        let cubic = determinant(&own.reduced(system.inertia()));
        let relative = |polynomial: &[Complex], x: Complex| {
            let size: f64 =
                polynomial.iter().enumerate().map(|(n, c)| c.abs() * x.abs().powi(n as i32)).sum();
            evaluate(polynomial, x).abs() / size
        };
        assert!(relative(&cubic[2..], claimed) < 1e-20, "a root of the printed cubic");
        assert!(relative(&exact, claimed) > 1e-6, "but not of the system");
        assert!(relative(&exact, 0.0.into()) > 1e-9, "ς = 0 is no root");
        for root in quadratic_roots(&exact) {
            assert!(relative(&exact, root) < 1e-25);
            assert!(relative(&cubic, root) < 1e-18, "the system's roots are among the quintic's");
        }
    }
}

/// Eqs (142)–(145): the root of order k² is claimed to be double. Truth: of the two roots one grows
/// like k² and the other like k.
#[test]
fn eq_142_to_145_simple_root() {
    let mut random = Random::new(16);
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let beta = wide(random.generic(0.0, 3.0));
        if (beta.cos() - system.phi().sin()).value().abs() < 0.05 {
            continue;
        }
        let roots_at = |k: f64| {
            quadratic_roots(&system.dispersion(system.direction(beta).map(|x| x * wide(k))))
        };
        let (near, far) = (roots_at(1e9), roots_at(1e10));
        let order = |n: usize| (far[n].abs() / near[n].abs()).log10();
        // Corrections of relative size (gradients)/k/gap², below 1e-4 here.
        assert!((order(0) - 2.0).abs() < 1e-3, "order {} in k", order(0));
        assert!(order(1) < 1.001, "order {} in k", order(1));
    }
}

/// Eq. (163): in a degenerate direction ς = 0 is claimed to be a triple root; it is none at all.
#[test]
fn eq_163_no_zero_root() {
    let mut random = Random::new(17);
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        // cos β = sin φ
        let beta = support::RIGHT_ANGLE - system.phi();
        for beta in [beta, -beta] {
            let wave = system.direction(beta).map(|x| x * wide(30.0));
            let exact = system.dispersion(wave);
            assert_eq!(exact.len(), 3);
            let [large, small] = quadratic_roots(&exact);
            assert!(small.abs() > 1e-6 * large.abs(), "{small:?} is a root near zero");
            let constant = exact[0].abs();
            let size = exact[2].abs() * large.abs() * large.abs();
            assert!(constant > 1e-8 * size);
        }
    }
}

/// Eqs (130), (136) take k → ∞ in each direction by itself. That does not bound the growth: in
///
/// ```text
/// ∂ₜw = ∂₁²∂₂²w + ∂₂⁶w,   ς = k₁²k₂² − k₂⁶,
/// ```
///
/// a first-order system in w and its derivatives with constant coefficients like (77), ς tends to
/// −∞ or is 0 along every ray, so that (130) calls it well-posed, while the supremum over all
/// directions grows like k³ (at k₂ ≈ (k²/3)^¼).
#[test]
fn eq_130_and_136_limits_along_rays() {
    // Unknowns w, ∂₁w, ∂₁²w, ∂₁²∂₂w, ∂₂w, ∂₂²w … ∂₂⁵w; last row first: ∂ₜw = ∂₂(∂₁²∂₂w) + ∂₂(∂₂⁵w).
    let dispersion = |wave: [f64; 2]| {
        let mut matrix: Vec<Vec<Polynomial>> = vec![vec![vec![]; 9]; 9];
        let i_k = wave.map(|k| complex(0.0, k));
        matrix[0][0] = vec![0.0.into(), 1.0.into()];
        matrix[0][3] = vec![-i_k[1]];
        matrix[0][8] = vec![-i_k[1]];
        // Row n defines unknown n as the derivative of another.
        for (n, axis, of) in
            [(1, 0, 0), (2, 0, 1), (3, 1, 2), (4, 1, 0), (5, 1, 4), (6, 1, 5), (7, 1, 6), (8, 1, 7)]
        {
            matrix[n][n] = vec![1.0.into()];
            matrix[n][of] = vec![-i_k[axis]];
        }
        let polynomial = determinant(&matrix);
        assert_eq!(polynomial.len(), 2);
        (-(polynomial[0] / polynomial[1])).re.value()
    };
    let expected = 2.5f64 * 2.5 * 0.7 * 0.7 - 0.7f64.powi(6);
    assert!((dispersion([2.5, 0.7]) - expected).abs() < 1e-12);

    // Along every one of 181 rays the limit is −∞, or 0 along the first axis.
    for degree in 0..=180 {
        let (sine, cosine) = match degree {
            0 | 180 => (0.0, 1.0),
            _ => f64::from(degree).to_radians().sin_cos(),
        };
        let far = dispersion([1e6 * cosine, 1e6 * sine]);
        assert!(far <= 0.0, "along {degree} degrees: {far:e}");
    }
    // Over all directions at one k the growth is unbounded, of order 3 in k.
    let supremum = |k: f64| {
        (1..20_000)
            .map(|n| {
                let angle = 2.0 * f64::from(n) / 20_000.0 / k.sqrt();
                dispersion([k * angle.cos(), k * angle.sin()])
            })
            .fold(f64::MIN, f64::max)
    };
    let (near, far) = (supremum(1e3), supremum(1e4));
    assert!(near > 0.0 && ((far / near).log10() - 3.0).abs() < 0.01, "{near:e} {far:e}");
}

/// The same in the model itself. As k → ∞ with β − β₀ = s/k fixed times 1/k (a layer around a
/// degenerate direction), Re ς tends to a function of s that is greater, somewhere in the layer,
/// than its limits along all rays, the degenerate one included: the bound on the growth is not
/// seen by (130).
#[test]
fn eq_130_and_136_layers_of_the_model() {
    let mut random = Random::new(18);
    let mut found = 0;
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        if system.coaxiality().value() < 0.1 {
            continue;
        }
        let k = 1e8;
        let growth = |beta: Wide| {
            let roots =
                quadratic_roots(&system.dispersion(system.direction(beta).map(|x| x * wide(k))));
            roots.map(|x| x.re.value()).into_iter().fold(f64::MIN, f64::max)
        };
        let ends = [support::RIGHT_ANGLE - system.phi(), system.phi() - support::RIGHT_ANGLE];
        // Along the rays: the slow root, and the degenerate directions exactly.
        let slow = -(system.c[2][2] / (system.density() * system.inertia())).value();
        let along_rays = ends.map(growth).into_iter().fold(slow, f64::max);
        let in_layers = (-100..=100)
            .flat_map(|n| ends.map(|end| growth(end + wide(f64::from(n) / k))))
            .fold(f64::MIN, f64::max);
        assert!(in_layers.is_finite() && in_layers < 1e6, "bounded in the layers");
        found += usize::from(in_layers > along_rays + 1e-3 * (1.0 + along_rays.abs()));
    }
    assert!(found >= 10, "the layers never exceed the rays: found {found}");
}

/// Abstract and section 8: "incompressible flows are well-posed" holds only for |Ψ_D − Ψ_Σ| < π/4.
/// Beyond, a root of the exact determinant grows like k² with the coefficient of (149) halved; within,
/// the growth tends to a number.
#[test]
fn abstract_only_below_45_degrees() {
    let mut random = Random::new(19);
    let (mut beyond, mut within) = (0, 0);
    for _ in 0..STATES {
        let system = Incompressible::random(&mut random);
        let beta = wide(random.generic(0.0, 3.0));
        let gap = (beta.cos() - system.phi().sin()).value();
        let degrees = system.flow.noncoaxiality.abs().to_degrees();
        if gap.abs() < 0.05 || (degrees - 45.0).abs() < 1.0 {
            continue;
        }
        let growth = |k: f64| {
            quadratic_roots(&system.dispersion(system.direction(beta).map(|x| x * wide(k))))
                .map(|x| x.re.value())
                .into_iter()
                .fold(f64::MIN, f64::max)
        };
        if degrees > 45.0 {
            beyond += 1;
            let model = HarrisGrekova::new(
                Coulomb::new(system.parameters.friction_angle, system.parameters.cohesion).unwrap(),
                0.0,
                system.parameters.moment_of_inertia.unwrap(),
                system.parameters.rotational_strength.unwrap(),
            )
            .unwrap();
            let coefficient = model.leading_coefficient(
                system.q.value(),
                system.state.density,
                system.state.shear_rate,
                system.flow.noncoaxiality,
                beta.value(),
            );
            assert!(coefficient > 0.0);
            // Gradients over k: below 1e-6 × 1/gap² at k = 1e10.
            assert!((growth(1e10) / 1e20 / coefficient - 1.0).abs() < 1e-4);
        } else {
            within += 1;
            // The slow root, −c₃₃/(ρI) + O(1/(k gap²)); the other is far to the left.
            let slow = -(system.c[2][2] / (system.density() * system.inertia())).value();
            assert!((growth(1e10) - slow).abs() < 1e-3 * (1.0 + slow.abs()));
        }
    }
    assert!(beyond > 60 && within > 60);
    let kind = registry::HARRIS_GREKOVA;
    let parameters = states::random_parameters(&mut random, kind, Dilatancy::Zero);
    let bound = parameters.model(kind).unwrap().noncoaxiality_bound().unwrap();
    assert!((bound - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
}
