//! Growth of short waves by brute force: the largest Re ς over many directions, in 256 bits at wave numbers large
//! enough to show its order in k.

use super::exact::DispersionReference;
use super::real256::{Complex256, Real256};

/// Supremum S(k) of Re ς over all directions, at several wave numbers k.
#[derive(Clone, Debug)]
pub struct BruteForceGrowth {
    /// Wave number k, S(k) and direction (rad).
    pub samples: Vec<(f64, f64, f64)>,
    /// Whether S is infinite at a finite wave number.
    pub is_unbounded_at_finite_k: bool,
}

impl BruteForceGrowth {
    /// Order in k between the last two wave numbers; 0 if S is not positive.
    pub fn order(&self) -> f64 {
        let [.., (k0, s0, _), (k1, s1, _)] = self.samples[..] else { panic!("two wave numbers") };
        // Smaller values of S are rounding of zero in 256 bits.
        if s0 <= 1e-30 || s1 <= 1e-30 { 0.0 } else { (s1 / s0).ln() / (k1 / k0).ln() }
    }

    /// S/k^order at the largest wave number.
    pub fn coefficient(&self, order: f64) -> f64 {
        let (k, s, _) = self.samples[self.samples.len() - 1];
        s / k.powf(order)
    }
}

/// Directions in which a leading form F_ij of P = Σ ςⁱ F_ij (the largest degree j for each i) changes sign, or in which
/// |F_ij| has a local minimum below 1/100 of its maximum (a double zero or nearly one).
pub fn find_degenerate_directions(polynomial: &DispersionReference) -> Vec<Real256> {
    let mut centres: Vec<Real256> = Vec::new();
    for i in 0..=polynomial.degree() {
        let orders = polynomial.terms.iter().filter(|t| t.0[0] == i).map(|t| t.0[1] + t.0[2]);
        let Some(j) = orders.max() else { continue };
        if j == 0 {
            continue;
        }
        let coefficients: Vec<(u8, u8, f64)> = {
            let own = polynomial.terms.iter().filter(|t| t.0[0] == i && t.0[1] + t.0[2] == j);
            let size = own.clone().map(|t| t.1.exponent()).max().unwrap_or(0);
            own.map(|t| (t.0[1], t.0[2], t.1.multiply_by_power_of_two(-size).to_f64())).collect()
        };
        let value = |angle: f64| {
            let (s, c) = angle.sin_cos();
            let term = |&(b, e, x): &(u8, u8, f64)| x * c.powi(b.into()) * s.powi(e.into());
            coefficients.iter().map(term).sum::<f64>()
        };
        const SCAN_STEPS: usize = 720;
        let step = std::f64::consts::PI / SCAN_STEPS as f64;
        let samples: Vec<f64> =
            (0..SCAN_STEPS + 2).map(|n| value((n as f64 - 0.5) * step)).collect();
        let greatest = samples.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let mut include = |angle: Real256| {
            let near = |own: &Real256| (*own - angle).abs().to_f64() < 1e-25;
            if !centres.iter().any(near) {
                centres.push(angle);
            }
        };
        for n in 1..=SCAN_STEPS {
            let angle = (n as f64 - 0.5) * step;
            let [before, here, after] = [samples[n - 1], samples[n], samples[n + 1]];
            if here * after <= 0.0 {
                let (mut a, mut b) = (angle, angle + step);
                for _ in 0..52 {
                    let middle = 0.5 * (a + b);
                    if value(a) * value(middle) <= 0.0 { b = middle } else { a = middle }
                }
                if let Some(zero) =
                    refine_zero_by_newton(polynomial, i, j, Real256::from(0.5 * (a + b)), false)
                {
                    include(zero);
                }
            }
            let touches = here.abs() <= before.abs() && here.abs() <= after.abs();
            // A local minimum of |F_ij| that is not zero is a candidate as well.
            if touches && here.abs() < 1e-2 * greatest {
                let extremum = refine_zero_by_newton(polynomial, i, j, Real256::from(angle), true);
                extremum.into_iter().for_each(&mut include);
            }
        }
    }
    centres
}

/// A zero of F_ij, or of its slope, by Newton's iteration with finite differences in 256 bits.
fn refine_zero_by_newton(
    polynomial: &DispersionReference,
    i: u8,
    j: u8,
    start: Real256,
    is_extremum: bool,
) -> Option<Real256> {
    let h = Real256::from(1.0).multiply_by_power_of_two(-60);
    let f = |x: Real256| polynomial.evaluate_form(i, j, x);
    let slope = |x: Real256| (f(x + h) - f(x - h)).multiply_by_power_of_two(59);
    let curvature = |x: Real256| {
        (f(x + h) - f(x).multiply_by_power_of_two(1) + f(x - h)).multiply_by_power_of_two(120)
    };
    let mut x = start;
    for _ in 0..60 {
        let (value, rate) = if is_extremum { (slope(x), curvature(x)) } else { (f(x), slope(x)) };
        if rate.is_zero() {
            return None;
        }
        let step = value * rate.reciprocal();
        x = x - step;
        if step.exponent() < -200 {
            break;
        }
    }
    ((x - start).abs().to_f64() < 0.01).then_some(x)
}

/// Directions next to the centres in which, at the wave number k, the real or the imaginary part of the coefficient of
/// some power of ς vanishes, or two roots come close to each other: roots may be much larger or smaller there than in
/// neighbouring directions.
fn find_resonances(
    polynomial: &DispersionReference,
    k: Real256,
    centres: &[Real256],
    max_offset_exponent: f64,
) -> Vec<Real256> {
    let value = |power: usize, part: usize, angle: Real256| {
        let (sin, cos) = angle.sin_cos();
        let c =
            polynomial.coefficients_at(k, cos, sin).get(power).copied().unwrap_or(Complex256::ZERO);
        if part == 0 { c.re } else { c.im }
    };
    let mut found: Vec<Real256> = Vec::new();
    for &centre in centres {
        for side in [1.0, -1.0] {
            let steps = (2.0 * max_offset_exponent * k.log2()) as i32;
            let offsets: Vec<f64> =
                (2..steps).map(|n| side * (-0.5 * f64::from(n)).exp2()).collect();
            let row: Vec<Vec<Complex256>> = offsets
                .iter()
                .map(|&x| {
                    let (sin, cos) = (centre + Real256::from(x)).sin_cos();
                    polynomial.coefficients_at(k, cos, sin)
                })
                .collect();
            // Directions in which two roots come close to each other.
            let gaps: Vec<f64> = row.iter().map(|c| min_root_gap(c, 0.0)).collect();
            for n in 1..gaps.len() - 1 {
                if gaps[n] > gaps[n - 1] || gaps[n] > gaps[n + 1] || gaps[n] > 0.5 {
                    continue;
                }
                let at = |log: f64| {
                    let (sin, cos) = (centre + Real256::from(side * log.exp2())).sin_cos();
                    min_root_gap(&polynomial.coefficients_at(k, cos, sin), 0.0)
                };
                let (mut a, mut b) = (-0.5 * (n as f64 + 3.0), -0.5 * (n as f64 + 1.0));
                for _ in 0..48 {
                    let (x, y) = (a + 0.382 * (b - a), a + 0.618 * (b - a));
                    if at(x) < at(y) { b = y } else { a = x }
                }
                found.push(centre + Real256::from(side * (0.5 * (a + b)).exp2()));
            }
            for power in 0..=usize::from(polynomial.degree()) {
                for part in 0..2 {
                    let of = |c: &Vec<Complex256>| {
                        let c = c.get(power).copied().unwrap_or(Complex256::ZERO);
                        if part == 0 { c.re } else { c.im }
                    };
                    for (n, pair) in row.windows(2).enumerate() {
                        let (f, g) = (of(&pair[0]), of(&pair[1]));
                        if f.is_zero() || g.is_zero() || f.is_negative() == g.is_negative() {
                            continue;
                        }
                        // Illinois variant of regula falsi.
                        let mut a = centre + Real256::from(offsets[n]);
                        let mut b = centre + Real256::from(offsets[n + 1]);
                        let (mut fa, mut fb) = (f, g);
                        for _ in 0..40 {
                            let x = (a * fb - b * fa) * (fb - fa).reciprocal();
                            let fx = value(power, part, x);
                            let step = (x - b).abs();
                            if fx.is_negative() != fb.is_negative() {
                                (a, fa) = (b, fb);
                            } else {
                                fa = fa.multiply_by_power_of_two(-1);
                            }
                            (b, fb) = (x, fx);
                            if fx.is_zero() || step.exponent() < -250 {
                                break;
                            }
                        }
                        let near =
                            |own: &Real256| (*own - b).exponent() < (centre - b).exponent() - 40;
                        if !found.iter().any(near) {
                            found.push(b);
                        }
                    }
                }
            }
        }
    }
    found
}

/// Smallest distance between two roots, relative to the sum of their moduli, over all pairs whose sum exceeds `least`;
/// in double precision, which suffices to locate candidates.
fn min_root_gap(polynomial: &[Complex256], least: f64) -> f64 {
    let plain: Vec<_> = polynomial.iter().map(|c| c.to_complex64()).collect();
    let roots = wellposed_analysis::roots::solve(&plain);
    let mut found = f64::INFINITY;
    for (n, a) in roots.iter().enumerate() {
        for b in &roots[n + 1..] {
            let size = a.norm() + b.norm();
            if size > least {
                found = found.min((a - b).norm() / size);
            }
        }
    }
    found
}

/// Directions in which two roots of order 1 or more come close to each other at a large wave number.
fn find_collisions(polynomial: &DispersionReference, wave: f64) -> Vec<Real256> {
    let k = Real256::from(wave);
    let gap = |angle: f64| {
        let (sin, cos) = Real256::from(angle).sin_cos();
        min_root_gap(&polynomial.coefficients_at(k, cos, sin), 1e-3 * wave)
    };
    const SCAN_STEPS: usize = 240;
    let step = std::f64::consts::PI / SCAN_STEPS as f64;
    let samples: Vec<f64> = (0..SCAN_STEPS + 2).map(|n| gap(step * (n as f64 - 0.6))).collect();
    let mut found = Vec::new();
    for n in 1..=SCAN_STEPS {
        let [before, here, after] = [samples[n - 1], samples[n], samples[n + 1]];
        if here > before || here > after || here > 0.3 {
            continue;
        }
        let (mut a, mut b) = (step * (n as f64 - 1.6), step * (n as f64 + 0.4));
        for _ in 0..60 {
            let (x, y) = (a + 0.382 * (b - a), a + 0.618 * (b - a));
            if gap(x) < gap(y) { b = y } else { a = x }
        }
        found.push(Real256::from(0.5 * (a + b)));
    }
    found
}

/// A tested direction, `centre` + `sign` × 2^`position` (rad; the angle `position` if `sign` is 0), with its growth S.
#[derive(Clone, Copy)]
struct GrowthCandidate {
    growth: Real256,
    centre: Real256,
    position: f64,
    sign: f64,
}

/// Computes S at the wave numbers `wave_numbers`, over `direction_count` uniform directions and clusters around
/// `centres` with offsets k^(−s), 0 < s ≤ `max_offset_exponent`, then refines the largest values; with `is_fine`
/// clusters around resonances and collisions are as dense as those around `centres`, and more values are refined.
pub fn compute_growth_by_brute_force(
    polynomial: &DispersionReference,
    wave_numbers: &[f64],
    direction_count: usize,
    centres: &[Real256],
    max_offset_exponent: f64,
    is_fine: bool,
) -> BruteForceGrowth {
    let growth = |k: Real256, centre: Real256, offset: f64| {
        polynomial.max_growth_rate(k, centre + Real256::from(offset))
    };
    let colliding = find_collisions(polynomial, wave_numbers[wave_numbers.len() - 1]);
    let mut at = Vec::new();
    let mut worst_before: Option<(GrowthCandidate, f64)> = None;
    for &wave in wave_numbers {
        let k = Real256::from(wave);
        let mut all = centres.to_vec();
        all.extend(find_resonances(polynomial, k, centres, max_offset_exponent));
        all.extend(&colliding);
        let known = centres.len();
        let mut candidates: Vec<GrowthCandidate> = Vec::new();
        let previous = at.last().map(|&(_, _, direction): &(f64, f64, f64)| direction);
        for n in 0..direction_count {
            let position = std::f64::consts::PI * (n as f64 + 0.3) / direction_count as f64;
            let s = growth(k, Real256::ZERO, position);
            candidates.push(GrowthCandidate {
                growth: s,
                centre: Real256::ZERO,
                position,
                sign: 0.0,
            });
        }
        // Worst direction at the previous wave number, with the offset scaled as the same power of k.
        if let Some((last, wave_before)) = worst_before
            && last.sign != 0.0
            && last.position > -9e3
        {
            let position = last.position * wave.log2() / f64::log2(wave_before);
            let s = growth(k, last.centre, last.sign * position.exp2());
            candidates.push(GrowthCandidate { growth: s, position, ..last });
        }
        if let Some(position) = previous {
            let s = growth(k, Real256::ZERO, position);
            candidates.push(GrowthCandidate {
                growth: s,
                centre: Real256::ZERO,
                position,
                sign: 0.0,
            });
        }
        const OFFSET_STEPS: usize = 28;
        let step = max_offset_exponent * wave.log2() / OFFSET_STEPS as f64;
        for (index, &centre) in all.iter().enumerate() {
            candidates.push(GrowthCandidate {
                growth: growth(k, centre, 0.0),
                centre,
                position: -1e4,
                sign: 1.0,
            });
            // Fewer samples around resonances and collisions, which are accurate candidates.
            for n in (1..=OFFSET_STEPS).step_by(if is_fine || index < known { 1 } else { 3 }) {
                for sign in [1.0, -1.0] {
                    let position = -step * n as f64;
                    let s = growth(k, centre, sign * position.exp2());
                    candidates.push(GrowthCandidate { growth: s, centre, position, sign });
                }
            }
        }
        candidates.sort_by(|a, b| b.growth.partial_cmp(&a.growth).expect("ordered"));
        let offset =
            |c: &GrowthCandidate, x: f64| if c.sign == 0.0 { x } else { c.sign * x.exp2() };
        let mut best = candidates[0];
        let refined = if is_fine { 24 } else { 5 };
        let angles = candidates.iter().filter(|c| c.sign == 0.0).take(refined);
        let offsets =
            candidates.iter().filter(|c| c.sign != 0.0 && c.position > -9e3).take(refined);
        for start in angles.chain(offsets) {
            let width = if start.sign == 0.0 {
                std::f64::consts::PI / direction_count as f64
            } else {
                step
            };
            let (s, position) = search_golden_section(
                |x| growth(k, start.centre, offset(start, x)),
                [start.position - width, start.position + width],
            );
            if s > best.growth {
                best = GrowthCandidate { growth: s, position, ..*start };
            }
        }
        worst_before = Some((best, wave));
        let GrowthCandidate { growth: s, centre, position, .. } = best;
        let direction = (centre + Real256::from(offset(&best, position))).to_f64();
        at.push((wave, s.to_f64(), direction.rem_euclid(std::f64::consts::PI)));
    }
    let is_unbounded_at_finite_k = [1234.5, wave_numbers[0]].into_iter().any(|fixed| {
        is_unbounded_at(polynomial, Real256::from(fixed), centres, max_offset_exponent)
    });
    BruteForceGrowth { samples: at, is_unbounded_at_finite_k }
}

/// Maximum and its position of a unimodal function in [a, b], by 22 golden-section steps.
fn search_golden_section(f: impl Fn(f64) -> Real256, [mut a, mut b]: [f64; 2]) -> (Real256, f64) {
    const GOLDEN_RATIO_INVERSE: f64 = 0.618_033_988_749_894_9;
    let (mut x, mut y) = (b - GOLDEN_RATIO_INVERSE * (b - a), a + GOLDEN_RATIO_INVERSE * (b - a));
    let (mut fx, mut fy) = (f(x), f(y));
    for _ in 0..22 {
        if fx >= fy {
            (b, y, fy) = (y, x, fx);
            x = b - GOLDEN_RATIO_INVERSE * (b - a);
            fx = f(x);
        } else {
            (a, x, fx) = (x, y, fy);
            y = a + GOLDEN_RATIO_INVERSE * (b - a);
            fy = f(y);
        }
    }
    if fx >= fy { (fx, x) } else { (fy, y) }
}

/// Whether S is infinite at the wave number k: next to a zero of the leading coefficient it grows with 1/distance. At
/// large wave numbers the unbounded part of a root can be small, of order k⁻²/distance.
fn is_unbounded_at(
    polynomial: &DispersionReference,
    k: Real256,
    centres: &[Real256],
    max_offset_exponent: f64,
) -> bool {
    let mut directions = centres.to_vec();
    directions.extend(find_resonances(polynomial, k, centres, max_offset_exponent));
    directions.iter().any(|&centre| {
        [1.0, -1.0].into_iter().any(|sign| {
            // Smaller distances would lose a double zero of the coefficient in 256 bits.
            let [far, near, nearest] = [1e-25, 1e-30, 1e-35]
                .map(|x| polynomial.max_growth_rate(k, centre + Real256::from(sign * x)));
            let increases = |a: Real256, b: Real256| {
                !a.is_negative() && !a.is_zero() && b > a.multiply_by_power_of_two(5)
            };
            nearest > k && increases(far, near) && increases(near, nearest)
        })
    })
}
