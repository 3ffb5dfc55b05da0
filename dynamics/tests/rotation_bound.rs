//! What a bound on the natural rotation of a step costs and gains: the rotation of spins against antisymmetric stress is
//! exact, its splitting from the sweeps is not.

use models::cosserat::parameters::{CoupleModuli, Isotropic, Microrotation};
use models::cosserat::waves::Field;
use std::f64::consts::TAU;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, Placement, Problem, Scheme, Splitting};

const COURANT: f64 = 0.9;
const ALPHA: f64 = 1e8;
const INERTIA: f64 = 8.0;

/// Blocks of 0.2 m: own length √((γ + η)/4α) = 42 mm, ω* = √(4α/j) = 7071 rad/s.
fn solid() -> Isotropic {
    let couple = CoupleModuli { beta: 3.6e5, gamma: 3.6e5, eta: 3.6e5 };
    let rotation = Microrotation { alpha: ALPHA, inertia: INERTIA, couple: Some(couple) };
    Isotropic::new(2e8, 2e8, 2000.0, Some(rotation)).expect("sound moduli")
}

const FIELDS: [Field; 5] = [
    Field::Velocity(1),
    Field::Spin(2),
    Field::Stress(1, 0),
    Field::Stress(0, 1),
    Field::Couple(2, 0),
];

/// A transverse plane wave along x₁: the angular frequency of a branch (0: shear, 1: spin), rad/s, and the amplitudes of
/// cos and sin of kx − ωt of [`FIELDS`], from
///
/// ```text
/// (ρω² − (μ + α)k²)(jω² − (γ + η)k² − 4α) = 4α²k².
/// ```
fn wave(k: f64, branch: usize) -> (f64, [[f64; 2]; 5]) {
    let Isotropic { mu, density, .. } = solid();
    let (plus, minus, couple) = (mu + ALPHA, mu - ALPHA, 7.2e5);
    let (a, b) = (plus * k * k / density, (couple * k * k + 4.0 * ALPHA) / INERTIA);
    let product = a * b - 4.0 * (ALPHA * k).powi(2) / (density * INERTIA);
    let upper = 0.5 * (a + b) + (0.25 * (a - b) * (a - b) + a * b - product).sqrt();
    let square = [product / upper, upper][branch];
    let frequency = square.sqrt();
    // v = Re e^(i(kx − ωt)): the spin is −i times this.
    let spin = (density * square - plus * k * k) / (2.0 * ALPHA * k);
    let amplitudes = [
        [1.0, 0.0],
        [0.0, spin],
        [-(plus * k + 2.0 * ALPHA * spin) / frequency, 0.0],
        [-(minus * k - 2.0 * ALPHA * spin) / frequency, 0.0],
        [0.0, -couple * k * spin / frequency],
    ];
    (frequency, amplitudes)
}

/// L2 error after a period, all fields by their energy, over the wave; and the angle of a step, degrees.
fn error(
    cells: usize,
    lengths: f64,
    branch: usize,
    degrees: f64,
    splitting: Splitting,
) -> [f64; 2] {
    let medium = Medium::isotropic(&solid(), 2);
    let own_length = (7.2e5 / (4.0 * ALPHA)).sqrt();
    let k = TAU / (lengths * own_length);
    let h = lengths * own_length / cells as f64;
    let (frequency, amplitudes) = wave(k, branch);
    let natural = (4.0 * ALPHA / INERTIA).sqrt();
    let longest = (2.0 * COURANT * h / medium.greatest_speed()).min(degrees.to_radians() / natural);
    let period = TAU / frequency;
    let steps = (period / longest).ceil();
    let periodic = || [Boundary::Periodic, Boundary::Periodic];
    let problem = Problem::new(
        Grid { cells: [cells, 1], spacing: [h; 2] },
        vec![medium],
        vec![0; cells],
        [periodic(), periodic()],
        period / steps,
        Scheme { splitting, ..Scheme::new(Slopes::Limited, Placement::Last) },
    );
    let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("a sound domain");
    // Means of cells.
    let mean = (0.5 * k * h).sin() / (0.5 * k * h);
    let values = |index: usize, cell: usize| {
        let (sin, cos) = (k * h * (cell as f64 + 0.5)).sin_cos();
        mean * (amplitudes[index][0] * cos + amplitudes[index][1] * sin)
    };
    for (index, field) in FIELDS.into_iter().enumerate() {
        domain.set(field, &(0..cells).map(|cell| values(index, cell)).collect::<Vec<_>>());
    }
    (0..steps as usize).for_each(|_| domain.advance());
    let places =
        FIELDS.map(|own| domain.fields().iter().position(|field| *field == own).expect("a field"));
    let mut sums = [[0.0; 2]; 5];
    for cell in 0..cells {
        let mut shown = Vec::new();
        domain.show(cell, &mut shown);
        for (index, &place) in places.iter().enumerate() {
            let exact = values(index, cell);
            sums[index][0] += (shown[place] - exact).powi(2);
            sums[index][1] += exact * exact;
        }
    }
    let weights = [2000.0, INERTIA, 1.0 / 3e8, 1.0 / 3e8, 1.0 / 7.2e5];
    let total = |which: usize| -> f64 {
        sums.iter().zip(weights).map(|(sum, weight)| weight * sum[which]).sum()
    };
    [(total(0) / total(1)).sqrt(), (period / steps * natural).to_degrees()]
}

/// Prints the table of the README: a wave of the shear branch and one of the spin branch, after a period.
#[test]
fn what_a_bound_on_the_rotation_does() {
    let degrees = [10.0, 30.0, 60.0, 90.0, 180.0];
    for (branch, lengths) in [(0, 200.0), (0, 50.0), (1, 50.0), (1, 15.0)] {
        for cells in [10, 20, 40, 80] {
            for splitting in [Splitting::Alternating, Splitting::TwoCyclic] {
                let all = degrees.map(|degrees| error(cells, lengths, branch, degrees, splitting));
                let words = all.map(|[error, angle]| format!("{:.3} ({angle:.0})", 100.0 * error));
                println!("| {branch} {lengths} {cells} {splitting:?} | {} |", words.join(" | "));
            }
        }
    }
}
