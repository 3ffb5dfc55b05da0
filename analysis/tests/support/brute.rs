//! Growth of short waves by brute force: the greatest Re ς over very many directions, in 256 bits
//! at wave numbers so great that its order in k can be read off.

use super::exact::DispersionReference;
use super::wide::Wide;

/// sup over directions of Re ς at some wave numbers.
#[derive(Clone, Debug)]
pub struct Brute {
    /// (k, S(k), direction), the last as a centre and an offset in double precision.
    pub at: Vec<(f64, f64, f64)>,
    /// Whether S is infinite already at a fixed wave number.
    pub blows_up: bool,
}

impl Brute {
    /// Order in k between the last two wave numbers; 0 where S is not positive.
    pub fn order(&self) -> f64 {
        let [.., (k0, s0, _), (k1, s1, _)] = self.at[..] else { panic!("two wave numbers") };
        // What is left of zero in 256 bits is no growth.
        if s0 <= 1e-30 || s1 <= 1e-30 { 0.0 } else { (s1 / s0).ln() / (k1 / k0).ln() }
    }

    /// S/k^order at the greatest wave number.
    pub fn coefficient(&self, order: f64) -> f64 {
        let (k, s, _) = self.at[self.at.len() - 1];
        s / k.powf(order)
    }
}

/// Real zeros of the leading forms F_ij (for each power of ς the greatest j), crossed, touched or
/// nearly so.
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
            // Near misses are as good a place to look.
            if touches && here.abs() < 1e-2 * greatest {
                let extremum = newton(p, i, j, Wide::from(angle), true);
                extremum.into_iter().for_each(&mut include);
            }
        }
    }
    centres
}

/// A zero of F_ij, or of its slope, by Newton's iteration with differences in 256 bits.
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

/// A direction that was tried.
#[derive(Clone, Copy)]
struct Candidate {
    s: Wide,
    centre: Wide,
    place: f64,
    sign: f64,
}

/// S at the wave numbers `waves`, over `dense` directions all round and clusters about `centres`
/// with offsets k^(−s), 0 < s < `reach`, then refined.
pub fn brute(
    p: &DispersionReference,
    waves: &[f64],
    dense: usize,
    centres: &[Wide],
    reach: f64,
) -> Brute {
    let growth = |k: Wide, centre: Wide, offset: f64| p.growth(k, centre + Wide::from(offset));
    let mut at = Vec::new();
    for &wave in waves {
        let k = Wide::from(wave);
        // Sign 0: no centre, the place is an angle; else the place is log₂ of the offset.
        let mut met: Vec<Candidate> = Vec::new();
        let previous = at.last().map(|&(_, _, direction): &(f64, f64, f64)| direction);
        for n in 0..dense {
            let place = std::f64::consts::PI * (n as f64 + 0.3) / dense as f64;
            let s = growth(k, Wide::ZERO, place);
            met.push(Candidate { s, centre: Wide::ZERO, place, sign: 0.0 });
        }
        if let Some(place) = previous {
            let s = growth(k, Wide::ZERO, place);
            met.push(Candidate { s, centre: Wide::ZERO, place, sign: 0.0 });
        }
        const STEPS: usize = 28;
        let step = reach * wave.log2() / STEPS as f64;
        for &centre in centres {
            met.push(Candidate { s: growth(k, centre, 0.0), centre, place: -1e4, sign: 1.0 });
            for n in 1..=STEPS {
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
        let angles = met.iter().filter(|c| c.sign == 0.0).take(5);
        let offsets = met.iter().filter(|c| c.sign != 0.0 && c.place > -9e3).take(4);
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
        let Candidate { s, centre, place, .. } = best;
        let direction = (centre + Wide::from(offset(&best, place))).to_f64();
        at.push((wave, s.to_f64(), direction.rem_euclid(std::f64::consts::PI)));
    }
    // At a fixed wave number, next to a zero of the highest power's coefficient.
    let fixed = Wide::from(waves[0]);
    let blows_up = centres.iter().any(|&centre| {
        [1.0, -1.0].into_iter().any(|sign| {
            let [far, near, nearest] =
                [1e-30, 1e-35, 1e-40].map(|x| growth(fixed, centre, sign * x));
            let grows = |a: Wide, b: Wide| !a.is_negative() && !a.is_zero() && b > a.shifted(13);
            grows(far, near) && grows(near, nearest)
        })
    });
    Brute { at, blows_up }
}
