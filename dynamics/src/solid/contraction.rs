//! Verifies energy stability of the linear schemes: largest singular value of a sweep of lines with all combinations of
//! boundaries, Courant numbers and media.

use crate::simd::{Group, Real};
use crate::solid::boundary::{Boundary, Condition};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{BESIDE, GhostCoefficients, GhostRule, ghosts};
use crate::solid::line::sweep;
use crate::solid::reconstruction::{GHOSTS, Slopes};
use crate::solid::riemann::State;
use nalgebra::DMatrix;

/// Linear congruential generator, the same on every machine.
struct Random(u64);

impl Random {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
    }
}

const FREE: Condition = Condition::Traction(0.0);
const FIXED: Condition = Condition::Velocity(0.0);
const KINDS: [Condition; 5] =
    [FREE, FIXED, Condition::NonReflecting, Condition::OddVelocity, Condition::OddStress];

/// One sweep of a line between two boundaries.
fn step<T: Real>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    sides: [Condition; 2],
) {
    let count = cells.len();
    let state = |i: usize| State { velocity: velocity[i], stress: stress[i] };
    let made = [0, 1].map(|end| {
        let place = |depth: usize| if end == 0 { depth } else { count - 1 - depth };
        let boundary = Boundary::Given(vec![sides[end]]);
        let mirror: GhostRule<T> =
            GhostRule::new(&boundary, 1, (&[(0, (0, 0))], 1), false, Slopes::FourthOrder);
        let numbers = mirror.face(0, 0).map(|lanes| lanes.lanes()[0]);
        let inside: [usize; BESIDE] = std::array::from_fn(|depth| place(depth.min(count - 1)));
        let around = inside.map(|i| &cells[i]);
        if count >= BESIDE {
            let coefficients = GhostCoefficients::new(around[0]);
            ghosts(mirror.closure(), inside.map(state), numbers, end, around, &coefficients)
        } else {
            [0, 1].map(|depth| {
                let own = state(place(depth));
                let [v, a, s, b, _] = numbers;
                State { velocity: v * own.velocity + a, stress: s * own.stress + b }
            })
        }
    });
    let line = |own: &[T], pick: fn(&State<T>) -> T| -> Vec<T> {
        let mut all: Vec<T> = made[0].iter().rev().map(pick).collect();
        all.extend(own);
        all.extend(made[1].iter().map(pick));
        all
    };
    let mut all_cells = vec![cells[1], cells[0]];
    all_cells.extend(cells);
    all_cells.extend([cells[count - 1], cells[count - 2]]);
    let mut v = line(velocity, |own| own.velocity);
    let mut s = line(stress, |own| own.stress);
    sweep(&mut v, &mut s, &all_cells, Slopes::FourthOrder, None);
    velocity.copy_from_slice(&v[GHOSTS..GHOSTS + count]);
    stress.copy_from_slice(&s[GHOSTS..GHOSTS + count]);
}

/// Computes ‖G‖² − 1 of a sweep G, in the energy norm (zv² + s²/z)/C.
fn growth<T: Real>(cells: &[CellConstants<T>], sides: [Condition; 2]) -> f64 {
    let count = cells.len();
    let unit = |i: usize| {
        let (z, c) = (cells[i % count].impedance.to_f64(), cells[i % count].courant().to_f64());
        if i < count { (z / c).sqrt() } else { (1.0 / (z * c)).sqrt() }
    };
    let columns: Vec<Vec<f64>> = (0..2 * count)
        .map(|one| {
            let mut v = vec![T::ZERO; count];
            let mut s = vec![T::ZERO; count];
            if one < count {
                v[one] = T::from_f64(1.0 / unit(one))
            } else {
                s[one - count] = T::from_f64(1.0 / unit(one))
            }
            step(&mut v, &mut s, cells, sides);
            v.iter().chain(&s).enumerate().map(|(i, x)| x.to_f64() * unit(i)).collect()
        })
        .collect();
    let matrix = DMatrix::from_fn(2 * count, 2 * count, |i, j| columns[j][i]);
    let norm = matrix
        .try_svd(false, false, f64::EPSILON, 1000)
        .map_or(f64::NAN, |own| own.singular_values.max());
    norm * norm - 1.0
}

fn greatest(found: &mut (f64, String), growth: f64, what: impl Fn() -> String) {
    if growth.is_nan() || growth > found.0 {
        *found = (growth, what());
    }
}

#[test]
fn no_line_gains_energy() {
    let mut found = (f64::MIN, String::new());
    let courants =
        (1..100).map(|i| 0.01 * f64::from(i)).chain([1e-4, 0.999, 0.9999, 0.999_999_9, 1.0]);
    for courant in courants {
        for count in [2, 3, 4, 5, 6, 9] {
            let cells = vec![CellConstants::<f64>::new(1.0, courant); count];
            for one in KINDS {
                for other in KINDS {
                    greatest(&mut found, growth(&cells, [one, other]), || {
                        format!("C = {courant}, {count} cells, {one:?}, {other:?}")
                    });
                }
            }
        }
    }
    println!("{found:?}");
    assert!(found.0 < 1e-14, "{found:?}");
}

/// Random blocks of media, from single cells to long blocks.
#[test]
fn no_line_of_media_gains_energy() {
    let mut random = Random(1);
    let mut found = (f64::MIN, String::new());
    for attempt in 0..20000 {
        let count = random.within(3.0, 15.0) as usize;
        let longest = [1.0, 2.0, 3.0, 8.0][attempt % 4];
        let decades = random.within(0.0, 3.0);
        let mut cells = Vec::new();
        while cells.len() < count {
            let own = CellConstants::<f64>::among_others(
                10f64.powf(random.within(-decades, decades)),
                10f64.powf(random.within(-3.0, 0.0)),
            );
            let length = random.within(1.0, longest + 1.0) as usize;
            cells.extend(vec![own; length.min(count - cells.len())]);
        }
        let sides = [0, 1].map(|_| KINDS[random.within(0.0, 5.0) as usize]);
        let shape: Vec<_> = cells.iter().map(|cell| (cell.impedance, cell.courant())).collect();
        greatest(&mut found, growth(&cells, sides), || format!("{sides:?}, {shape:?}"));
    }
    println!("{found:?}");
    assert!(found.0 < 1e-14, "{found:?}");
}

/// Verifies that in single precision the energy grows by rounding only.
#[test]
fn in_single_precision_rounding_alone_gains() {
    let mut found = (f64::MIN, String::new());
    for courant in (1..100).map(|i| 0.01 * f64::from(i)).chain([0.999, 0.9999, 1.0]) {
        let cells = vec![CellConstants::<f32>::new(1.0, courant); 5];
        for one in KINDS {
            for other in KINDS {
                greatest(&mut found, growth(&cells, [one, other]), || {
                    format!("C = {courant}, {one:?}, {other:?}")
                });
            }
        }
    }
    println!("{found:?}");
    assert!(found.0 < 1e-6, "{found:?}");
}
