//! Growth of short waves by brute force: the largest Re ς over many directions, in 256 bits at wave numbers large
//! enough to show its order in k.

use super::exact::DispersionReference;
use super::wide::{Wide, WideComplex};

/// Supremum S(k) of Re ς over the directions at some wave numbers.
#[derive(Clone, Debug)]
pub struct Brute {
    /// Wave number k, S(k) and direction (rad).
    pub at: Vec<(f64, f64, f64)>,
    /// Whether S is infinite at a finite wave number.
    pub blows_up: bool,
}

impl Brute {
    /// Order in k between the last two wave numbers; 0 if S is not positive.
    pub fn order(&self) -> f64 {
        let [.., (k0, s0, _), (k1, s1, _)] = self.at[..] else { panic!("two wave numbers") };
        // Smaller values of S are rounding of zero in 256 bits.
        if s0 <= 1e-30 || s1 <= 1e-30 { 0.0 } else { (s1 / s0).ln() / (k1 / k0).ln() }
    }

    /// S/k^order at the largest wave number.
    pub fn coefficient(&self, order: f64) -> f64 {
        let (k, s, _) = self.at[self.at.len() - 1];
        s / k.powf(order)
    }
}

/// Real zeros of the leading forms F_ij (largest j for each power of ς): crossed, touched or nearly touched.
pub fn degenerate_directions(p: &DispersionReference) -> Vec<Wide> {
    let mut centres: Vec<Wide> = Vec::new();
    for i in 0..=p.degree() {
        let orders = p.terms.iter().filter(|t| t.0[0] == i).map(|t| t.0[1] + t.0[2]);
        let Some(j) = orders.max() else { continue };
        if j == 0 {
            continue;
        }
        let coefficients: Vec<(u8, u8, f64)> = {
            let own = p.terms.iter().filter(|t| t.0[0] == i && t.0[1] + t.0[2] == j);
            let size = own.clone().map(|t| t.1.exponent()).max().unwrap_or(0);
            own.map(|t| (t.0[1], t.0[2], t.1.shifted(-size).to_f64())).collect()
        };
        let value = |angle: f64| {
            let (s, c) = angle.sin_cos();
            let term = |&(b, e, x): &(u8, u8, f64)| x * c.powi(b.into()) * s.powi(e.into());
            coefficients.iter().map(term).sum::<f64>()
        };
        const STEPS: usize = 720;
        let step = std::f64::consts::PI / STEPS as f64;
        let samples: Vec<f64> = (0..STEPS + 2).map(|n| value((n as f64 - 0.5) * step)).collect();
        let greatest = samples.iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let mut include = |angle: Wide| {
            let near = |own: &Wide| (*own - angle).abs().to_f64() < 1e-25;
            if !centres.iter().any(near) {
                centres.push(angle);
            }
        };
        for n in 1..=STEPS {
            let angle = (n as f64 - 0.5) * step;
            let [before, here, after] = [samples[n - 1], samples[n], samples[n + 1]];
            if here * after <= 0.0 {
                let (mut a, mut b) = (angle, angle + step);
                for _ in 0..52 {
                    let middle = 0.5 * (a + b);
                    if value(a) * value(middle) <= 0.0 { b = middle } else { a = middle }
                }
                if let Some(zero) = newton(p, i, j, Wide::from(0.5 * (a + b)), false) {
                    include(zero);
                }
            }
            let touches = here.abs() <= before.abs() && here.abs() <= after.abs();
            // Nearly touched zeros are candidates as well.
            if touches && here.abs() < 1e-2 * greatest {
                let extremum = newton(p, i, j, Wide::from(angle), true);
                extremum.into_iter().for_each(&mut include);
            }
        }
    }
    centres
}

/// A zero of F_ij, or of its slope, by Newton's iteration with finite differences in 256 bits.
fn newton(p: &DispersionReference, i: u8, j: u8, start: Wide, of_slope: bool) -> Option<Wide> {
    let h = Wide::from(1.0).shifted(-60);
    let f = |x: Wide| p.form(i, j, x);
    let slope = |x: Wide| (f(x + h) - f(x - h)).shifted(59);
    let curvature = |x: Wide| (f(x + h) - f(x).shifted(1) + f(x - h)).shifted(120);
    let mut x = start;
    for _ in 0..60 {
        let (value, rate) = if of_slope { (slope(x), curvature(x)) } else { (f(x), slope(x)) };
        if rate.is_zero() {
            return None;
        }
        let step = value * rate.recip();
        x = x - step;
        if step.exponent() < -200 {
            break;
        }
    }
    ((x - start).abs().to_f64() < 0.01).then_some(x)
}

/// Directions next to the centres in which, at the wave number k, the real or the imaginary part of the coefficient of
/// some power of ς vanishes: roots may be much larger or smaller there than in neighbouring directions.
fn resonances(p: &DispersionReference, k: Wide, centres: &[Wide], reach: f64) -> Vec<Wide> {
    let value = |power: usize, part: usize, angle: Wide| {
        let (sin, cos) = angle.sin_cos();
        let c = p.at(k, cos, sin).get(power).copied().unwrap_or(WideComplex::ZERO);
        if part == 0 { c.re } else { c.im }
    };
    let mut found: Vec<Wide> = Vec::new();
    for &centre in centres {
        for side in [1.0, -1.0] {
            let steps = (2.0 * reach * k.log2()) as i32;
            let offsets: Vec<f64> =
                (2..steps).map(|n| side * (-0.5 * f64::from(n)).exp2()).collect();
            let row: Vec<Vec<WideComplex>> = offsets
                .iter()
                .map(|&x| {
                    let (sin, cos) = (centre + Wide::from(x)).sin_cos();
                    p.at(k, cos, sin)
                })
                .collect();
            // Directions in which two roots come close to each other.
            let gaps: Vec<f64> = row.iter().map(|c| gap(c, 0.0)).collect();
            for n in 1..gaps.len() - 1 {
                if gaps[n] > gaps[n - 1] || gaps[n] > gaps[n + 1] || gaps[n] > 0.5 {
                    continue;
                }
                let at = |log: f64| {
                    let (sin, cos) = (centre + Wide::from(side * log.exp2())).sin_cos();
                    gap(&p.at(k, cos, sin), 0.0)
                };
                let (mut a, mut b) = (-0.5 * (n as f64 + 3.0), -0.5 * (n as f64 + 1.0));
                for _ in 0..48 {
                    let (x, y) = (a + 0.382 * (b - a), a + 0.618 * (b - a));
                    if at(x) < at(y) { b = y } else { a = x }
                }
                found.push(centre + Wide::from(side * (0.5 * (a + b)).exp2()));
            }
            for power in 0..=usize::from(p.degree()) {
                for part in 0..2 {
                    let of = |c: &Vec<WideComplex>| {
                        let c = c.get(power).copied().unwrap_or(WideComplex::ZERO);
                        if part == 0 { c.re } else { c.im }
                    };
                    for (n, pair) in row.windows(2).enumerate() {
                        let (f, g) = (of(&pair[0]), of(&pair[1]));
                        if f.is_zero() || g.is_zero() || f.is_negative() == g.is_negative() {
                            continue;
                        }
                        // Illinois variant of regula falsi.
                        let mut a = centre + Wide::from(offsets[n]);
                        let mut b = centre + Wide::from(offsets[n + 1]);
                        let (mut fa, mut fb) = (f, g);
                        for _ in 0..40 {
                            let x = (a * fb - b * fa) * (fb - fa).recip();
                            let fx = value(power, part, x);
                            let step = (x - b).abs();
                            if fx.is_negative() != fb.is_negative() {
                                (a, fa) = (b, fb);
                            } else {
                                fa = fa.shifted(-1);
                            }
                            (b, fb) = (x, fx);
                            if fx.is_zero() || step.exponent() < -250 {
                                break;
                            }
                        }
                        let near =
                            |own: &Wide| (*own - b).exponent() < (centre - b).exponent() - 40;
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

/// Smallest distance between two roots relative to their size, among sizes above `least`; in double precision, which
/// suffices to locate candidates.
fn gap(polynomial: &[WideComplex], least: f64) -> f64 {
    let plain: Vec<_> = polynomial.iter().map(|c| c.to_c64()).collect();
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
fn collisions(p: &DispersionReference, wave: f64) -> Vec<Wide> {
    let k = Wide::from(wave);
    let gap = |angle: f64| {
        let (sin, cos) = Wide::from(angle).sin_cos();
        gap(&p.at(k, cos, sin), 1e-3 * wave)
    };
    const STEPS: usize = 240;
    let step = std::f64::consts::PI / STEPS as f64;
    let samples: Vec<f64> = (0..STEPS + 2).map(|n| gap(step * (n as f64 - 0.6))).collect();
    let mut found = Vec::new();
    for n in 1..=STEPS {
        let [before, here, after] = [samples[n - 1], samples[n], samples[n + 1]];
        if here > before || here > after || here > 0.3 {
            continue;
        }
        let (mut a, mut b) = (step * (n as f64 - 1.6), step * (n as f64 + 0.4));
        for _ in 0..60 {
            let (x, y) = (a + 0.382 * (b - a), a + 0.618 * (b - a));
            if gap(x) < gap(y) { b = y } else { a = x }
        }
        found.push(Wide::from(0.5 * (a + b)));
    }
    found
}

/// A tested direction with its growth S.
#[derive(Clone, Copy)]
struct Candidate {
    s: Wide,
    centre: Wide,
    place: f64,
    sign: f64,
}

/// Computes S at the wave numbers `waves`, over `dense` uniform directions and clusters around `centres` with offsets
/// k^(−s), 0 < s < `reach`, then refines the largest values; with `fine` clusters around resonances and collisions are
/// as dense.
pub fn brute(
    p: &DispersionReference,
    waves: &[f64],
    dense: usize,
    centres: &[Wide],
    reach: f64,
    fine: bool,
) -> Brute {
    let growth = |k: Wide, centre: Wide, offset: f64| p.growth(k, centre + Wide::from(offset));
    let colliding = collisions(p, waves[waves.len() - 1]);
    let mut at = Vec::new();
    let mut worst_before: Option<(Candidate, f64)> = None;
    for &wave in waves {
        let k = Wide::from(wave);
        let mut all = centres.to_vec();
        all.extend(resonances(p, k, centres, reach));
        all.extend(&colliding);
        let known = centres.len();
        // Sign 0: no centre, `place` is an angle; otherwise `place` is log₂ of the offset from the centre.
        let mut met: Vec<Candidate> = Vec::new();
        let previous = at.last().map(|&(_, _, direction): &(f64, f64, f64)| direction);
        for n in 0..dense {
            let place = std::f64::consts::PI * (n as f64 + 0.3) / dense as f64;
            let s = growth(k, Wide::ZERO, place);
            met.push(Candidate { s, centre: Wide::ZERO, place, sign: 0.0 });
        }
        // Worst direction at the previous wave number, with the offset scaled as the same power of k.
        if let Some((last, wave_before)) = worst_before
            && last.sign != 0.0
            && last.place > -9e3
        {
            let place = last.place * wave.log2() / f64::log2(wave_before);
            let s = growth(k, last.centre, last.sign * place.exp2());
            met.push(Candidate { s, place, ..last });
        }
        if let Some(place) = previous {
            let s = growth(k, Wide::ZERO, place);
            met.push(Candidate { s, centre: Wide::ZERO, place, sign: 0.0 });
        }
        const STEPS: usize = 28;
        let step = reach * wave.log2() / STEPS as f64;
        for (index, &centre) in all.iter().enumerate() {
            met.push(Candidate { s: growth(k, centre, 0.0), centre, place: -1e4, sign: 1.0 });
            // Fewer samples around resonances and collisions, which are accurate candidates.
            for n in (1..=STEPS).step_by(if fine || index < known { 1 } else { 3 }) {
                for sign in [1.0, -1.0] {
                    let place = -step * n as f64;
                    let s = growth(k, centre, sign * place.exp2());
                    met.push(Candidate { s, centre, place, sign });
                }
            }
        }
        met.sort_by(|a, b| b.s.partial_cmp(&a.s).expect("ordered"));
        let offset = |c: &Candidate, x: f64| if c.sign == 0.0 { x } else { c.sign * x.exp2() };
        let mut best = met[0];
        let refined = if fine { 24 } else { 5 };
        let angles = met.iter().filter(|c| c.sign == 0.0).take(refined);
        let offsets = met.iter().filter(|c| c.sign != 0.0 && c.place > -9e3).take(refined);
        for start in angles.chain(offsets) {
            let width = if start.sign == 0.0 { std::f64::consts::PI / dense as f64 } else { step };
            const RATIO: f64 = 0.618_033_988_749_894_9;
            let f = |x: f64| growth(k, start.centre, offset(start, x));
            let (mut a, mut b) = (start.place - width, start.place + width);
            let (mut x, mut y) = (b - RATIO * (b - a), a + RATIO * (b - a));
            let (mut fx, mut fy) = (f(x), f(y));
            for _ in 0..22 {
                if fx >= fy {
                    (b, y, fy) = (y, x, fx);
                    x = b - RATIO * (b - a);
                    fx = f(x);
                } else {
                    (a, x, fx) = (x, y, fy);
                    y = a + RATIO * (b - a);
                    fy = f(y);
                }
            }
            let (s, place) = if fx >= fy { (fx, x) } else { (fy, y) };
            if s > best.s {
                best = Candidate { s, place, ..*start };
            }
        }
        worst_before = Some((best, wave));
        let Candidate { s, centre, place, .. } = best;
        let direction = (centre + Wide::from(offset(&best, place))).to_f64();
        at.push((wave, s.to_f64(), direction.rem_euclid(std::f64::consts::PI)));
    }
    // Blow-up at fixed wave numbers, next to a zero of the leading coefficient. A moderate wave number is included,
    // since at large ones the unbounded part of a root can be small, like k⁻² over the offset.
    let blows_up = [Wide::from(1234.5), Wide::from(waves[0])].into_iter().any(|fixed| {
        let mut all = centres.to_vec();
        all.extend(resonances(p, fixed, centres, reach));
        all.iter().any(|&centre| {
            [1.0, -1.0].into_iter().any(|sign| {
                // Smaller distances would lose a double zero of the coefficient in 256 bits.
                let [far, near, nearest] =
                    [1e-25, 1e-30, 1e-35].map(|x| growth(fixed, centre, sign * x));
                let grows = |a: Wide, b: Wide| !a.is_negative() && !a.is_zero() && b > a.shifted(5);
                nearest > fixed && grows(far, near) && grows(near, nearest)
            })
        })
    });
    Brute { at, blows_up }
}
