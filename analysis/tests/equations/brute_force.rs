//! Verdicts on the bundled cases against brute force in 256 bits to k = 1e8, in the scaled unit of the equations.

use super::linearised::Assessed;
use crate::support::brute_force::{compute_growth_by_brute_force, find_degenerate_directions};
use crate::support::exact::{DispersionReference, solve_roots};
use crate::support::real256::Real256;
use crate::support::states::seeded_generator;
use rayon::prelude::*;
use std::f64::consts::PI;
use wellposed_analysis::growth::Verdict;
use wellposed_analysis::pencil::Pencil;

/// Wave numbers in the scaled unit.
const WAVE_NUMBERS: [f64; 2] = [1e6, 1e8];

/// Growth rates below this part of the largest root are rounding: entries rounded to doubles split double roots.
const SPLIT_BY_ROUNDING: f64 = 1e-6;

/// States other than those of the files: numbers at which the published verdict is another one.
const OTHER_STATES: &[(&str, &[&str])] = &[
    ("mu-of-i", &["background.v1.d2=100.0"]),
    ("mu-of-i", &["model.parameters.mu_s=1.3", "model.parameters.mu_2=1.5"]),
    ("barker-gray", &["background.v1.d2=1e5"]),
    ("heat", &["model.parameters.kappa=0.4"]),
    ("cahn-hilliard", &["model.parameters.kappa=0"]),
    ("cahn-hilliard", &["model.parameters.kappa=-0.05"]),
    ("euler-spinodal", &["background.rho=20.0"]),
    ("two-layers", &["background.u1=0.0", "background.u2=0.0"]),
    ("compressible-i-dependent", &["model.parameters.C0=-2e5"]),
    ("compressible-i-dependent", &["model.parameters.beta0=2.5", "model.parameters.beta1=-5.0"]),
];

/// Growth by brute force: whether it is unbounded at a finite wave number, order in k, scaled coefficient of the order
/// `order`.
struct Found {
    is_unbounded: bool,
    order: f64,
    growth_rate: f64,
}

impl Found {
    fn coefficient(&self, order: f64) -> f64 {
        self.growth_rate / WAVE_NUMBERS[1].powf(order)
    }
}

/// Growth of plane waves over all directions of a plane, or along x₁ only in one of the `dimensions`; `fine` as in
/// [`compute_growth_by_brute_force`].
fn search_plane(
    p: &DispersionReference,
    directions: usize,
    dimensions: usize,
    fine: bool,
) -> Found {
    let (sin, cos) = Real256::from(if dimensions == 1 { 0.0 } else { 0.7 }).sin_cos();
    let largest = solve_roots(&p.coefficients_at(Real256::from(WAVE_NUMBERS[1]), cos, sin))
        .into_iter()
        .fold(0.0, |sum: f64, root| sum.max(root.modulus().to_f64()));
    let rate = |k: f64, angle: Real256| p.max_growth_rate(Real256::from(k), angle).to_f64();
    let (rates, is_unbounded) = match dimensions {
        1 => (WAVE_NUMBERS.map(|k| rate(k, Real256::ZERO)), false),
        2 => {
            let centres = find_degenerate_directions(p);
            let force =
                compute_growth_by_brute_force(p, &WAVE_NUMBERS, directions, &centres, 1.6, fine);
            ([force.samples[0].1, force.samples[1].1], force.is_unbounded_at_finite_k)
        }
        // Both transverse waves of an isotropic medium have the same roots in all directions: no search for collisions.
        _ => {
            let uniform =
                (0..directions).map(|own| Real256::from(PI * own as f64 / directions as f64));
            let uniform: Vec<Real256> = uniform.collect();
            let centres = find_degenerate_directions(p);
            let sampled = WAVE_NUMBERS.map(|k| {
                let offset = |step: i32| Real256::from(k.powf(-0.1 * f64::from(step)));
                let beside = centres.iter().flat_map(|centre| {
                    (1..=16).flat_map(move |step| [*centre + offset(step), *centre - offset(step)])
                });
                let all = uniform.iter().chain(&centres).copied().chain(beside);
                all.map(|angle| rate(k, angle)).fold(f64::NEG_INFINITY, f64::max)
            });
            (sampled, false)
        }
    };
    let is_growing = rates[0] > 0.0 && rates[1] > SPLIT_BY_ROUNDING * largest;
    let order = (rates[1] / rates[0]).ln() / (WAVE_NUMBERS[1] / WAVE_NUMBERS[0]).ln();
    Found { is_unbounded, order: if is_growing { order } else { 0.0 }, growth_rate: rates[1] }
}

/// Compares the verdict on a state with brute force: in space in the plane that decides and in `planes` random ones.
fn compare(state: &Assessed, planes: usize, directions: usize, fine: bool) -> Result<(), String> {
    let verdict = &state.found.assessment.verdict;
    let dimensions = state.model.dimensions();
    let mut pencils = vec![state.workspace.plane.pencil.clone()];
    if let Some(deciding) = state.found.plane {
        let system = &state.workspace.space_system;
        let mut random = seeded_generator(0x59ace);
        let others = (0..planes).map(|_| {
            let normal: [f64; 3] = std::array::from_fn(|_| random.uniform(-1.0, 1.0));
            span_plane(normal)
        });
        pencils = std::iter::once(deciding)
            .chain(others)
            .map(|plane| {
                let (mut own, mut pencil) = Default::default();
                system.restrict_to_plane(&plane, &mut own);
                Pencil::update(&mut pencil, &own).expect("finite");
                pencil
            })
            .collect();
    }
    if matches!(verdict, Verdict::Indeterminate { .. }) {
        return match pencils.iter().all(Pencil::is_singular) {
            true => Ok(()),
            false => Err("regular".to_owned()),
        };
    }
    for (index, pencil) in pencils.iter().enumerate() {
        let p = DispersionReference::from_linearised(&pencil.scaled.system);
        let found = search_plane(&p, directions, dimensions, fine);
        let summary = format!("plane {index}: order {}, rate {:e}", found.order, found.growth_rate);
        let is_confirmed = match verdict {
            Verdict::WellPosed => !found.is_unbounded && found.order.abs() < 0.02,
            Verdict::IllPosed { growth: None, .. } => index > 0 || found.is_unbounded,
            // Other planes grow at most as fast as the one that decides.
            Verdict::IllPosed { growth: Some(growth), .. } => {
                let order = growth.order.to_f64();
                let unit = pencil.scaled.wave_number_unit.powf(order) / pencil.scaled.rate_unit;
                let ratio = found.coefficient(order) / (growth.coefficient * unit);
                let is_equal = (found.order - order).abs() < 0.05 && (ratio - 1.0).abs() < 0.02;
                !found.is_unbounded && (is_equal || index > 0 && ratio < 1.02)
            }
            _ => return Err(format!("{verdict:?}")),
        };
        if !is_confirmed {
            return Err(format!("{verdict:?}, but {summary}, unbounded: {}", found.is_unbounded));
        }
    }
    Ok(())
}

/// Unit vectors that span the plane normal to a vector.
fn span_plane(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let cross = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] {
        let own = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let length = own.iter().map(|x| x * x).sum::<f64>().sqrt();
        own.map(|x| x / length)
    };
    let first = cross(normal, [0.3, -0.5, 0.8]);
    [first, cross(normal, first)]
}

/// Checks the cases of at most `unknowns` unknowns.
fn confirm(unknowns: usize, planes: usize, directions: usize, is_fine: bool) {
    let prefix = "cases/equations/";
    let bundled = cases::CASES.iter().filter_map(|(path, _)| path.strip_prefix(prefix));
    let mut states: Vec<(&str, &[&str])> =
        bundled.map(|own| (own.strip_suffix(".toml").expect("a case"), &[][..])).collect();
    assert!(states.len() >= 25, "{states:?}");
    states.extend(OTHER_STATES);
    let wrong: Vec<String> = states
        .par_iter()
        .filter_map(|(name, sets)| {
            let sets: Vec<String> = sets.iter().map(|&own| own.to_owned()).collect();
            let state = Assessed::new(name, &sets);
            if state.model.unknowns().len() > unknowns {
                return None;
            }
            let start = std::time::Instant::now();
            // A coarse search may miss the growth in a narrow layer; it never finds growth that the finer one misses.
            let compared = compare(&state, planes, directions, is_fine)
                .or_else(|_| compare(&state, planes, directions, true));
            println!("{name} {sets:?}: {:?} in {:.1?}", state.verdict(), start.elapsed());
            compared.err().map(|error| format!("{name} {sets:?}: {error}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The verdict on each bundled case, and on states of other verdicts, is that of brute force: order, coefficient to 2 %,
/// in the plane that decides and in another one; without the largest models.
#[test]
fn verdicts_agree_with_brute_force() {
    confirm(6, 1, 16, false);
}

#[test]
#[ignore = "some minutes: cargo test --release -p wellposed-analysis --test analysis equations::brute -- --ignored"]
fn verdicts_agree_with_brute_force_in_many_planes() {
    confirm(usize::MAX, 40, 180, true);
}
