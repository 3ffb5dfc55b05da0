//! Return mapping in lanes without initial stress, by projection, if all yield sets are of one kind: Mises' set in all
//! its forms, with the energy it dissipates. Its formulas are derived at
//! [`Mises::project`](models::yield_set::parameters::Mises::project); if the condition depends on one part of the
//! stress only, the root is in closed form. Stresses at the apex and on the half-line before it are mapped by that
//! scalar function. For polyhedra all conditions are evaluated in lanes, and a stress beyond a condition is projected
//! by the scalar function. All other configurations are mapped by `return_mapping`.
//!
//! A lane does not depend on its neighbours: stresses within their sets are unchanged to the bit, wherever rows are
//! cut.

use crate::simd::{Group, Number, Real, SimdKernel, Vector};
use crate::solid::medium::{Medium, component};
use models::solid::parameters::Isotropic;
use models::solid::waves::Field;
use models::yield_set::parameters::{ActiveCondition, Mises};
use models::yield_set::return_mapping::{Equation, Iterate, PARTS};

/// Yield sets by pattern.
#[derive(Clone)]
pub(super) enum Sets<T: Real> {
    Mises(Strengths<T>),
    /// Conditions of interlayer sets: stresses that satisfy all of them are unchanged, all others are projected by the
    /// scalar function.
    HalfSpaces(Vec<Vec<HalfSpace<T::Lanes>>>),
}

/// Half-space n·s ≤ k in lanes.
#[derive(Clone)]
pub(super) struct HalfSpace<N> {
    /// Offsets of stresses, and components of n.
    normal: Vec<(usize, N)>,
    strength: N,
}

/// Mises' sets by pattern.
#[derive(Clone)]
pub(super) struct Strengths<T: Real> {
    force: Matrix,
    couple: Matrix,
    /// Parts of the stress with a nonzero weight in any condition.
    seen: [bool; PARTS],
    by_pattern: Vec<Strength<T::Lanes>>,
}

/// Offsets of the components of a force or couple stress.
#[derive(Clone, Default)]
pub(super) struct Matrix {
    pub(super) normal: Option<[usize; 3]>,
    /// Offsets of the components ij and ji; twice the same if one field stands for both.
    pub(super) pairs: Vec<[usize; 2]>,
}

impl Matrix {
    pub(super) fn new(fields: &[Field], pitch: usize, of: fn(usize, usize) -> Field) -> Self {
        let index = |i: usize, j: usize| fields.iter().position(|own| *own == of(i, j));
        let place = |i: usize, j: usize| Some(index(i, j)? * pitch);
        let normal = [place(0, 0), place(1, 1), place(2, 2)];
        let pairs = [[0, 1], [0, 2], [1, 2]].into_iter().filter_map(|[i, j]| {
            let [one, other] = [place(i, j), place(j, i)];
            Some([one.or(other)?, other.or(one)?])
        });
        Self {
            normal: match normal {
                [Some(a), Some(b), Some(c)] => Some([a, b, c]),
                _ => None,
            },
            pairs: pairs.collect(),
        }
    }
}

/// Mises' set in lanes.
#[derive(Clone, Copy)]
struct Strength<N> {
    /// k; in lanes without yield set greater than any stress.
    strength: N,
    /// Friction coefficient κ.
    friction: N,
    /// κK, decrease of the mean stress per plastic multiplier.
    shift: N,
    /// a = 2κ²K, with the bulk modulus K.
    a: N,
    /// 2/(a + d), plastic multiplier per excess of τ̄, with the rate d = Dp of the force deviator; then ½d.
    softness: N,
    half_rate: N,
    /// Weights p, rates Dp and compliances 1/D of the parts of the stress.
    weights: [N; PARTS],
    rates: [N; PARTS],
    compliances: [N; PARTS],
}

impl Strength<f64> {
    /// Returns the set of a medium without yield condition: `strength` is beyond any stress.
    fn none(strength: f64) -> Self {
        let mut rates = [0.0; PARTS];
        // Any nonzero value.
        rates[0] = 1.0;
        let [weights, compliances] = [[0.0; PARTS]; 2];
        let [friction, shift, a, half_rate] = [0.0; 4];
        let softness = 1.0;
        Self { strength, friction, shift, a, softness, half_rate, weights, rates, compliances }
    }

    fn new(set: &Mises, solid: &Isotropic) -> Self {
        let bulk = solid.lambda + 2.0 / 3.0 * solid.mu;
        let Mises { friction, strength, .. } = *set;
        let [shift, a] = [friction * bulk, 2.0 * friction * friction * bulk];
        // Parts without weight or stiffness are not mapped.
        let parts = set
            .parts(solid)
            .map(|part| if part[0] > 0.0 && part[1] > 0.0 { part } else { [0.0; 2] });
        Self {
            strength,
            friction,
            shift,
            a,
            softness: 2.0 / (a + parts[0][0] * parts[0][1]),
            half_rate: 0.5 * parts[0][0] * parts[0][1],
            weights: parts.map(|[weight, _]| weight),
            rates: parts.map(|[weight, stiffness]| weight * stiffness),
            compliances: parts.map(|[weight, stiffness]| match weight > 0.0 {
                true => 1.0 / stiffness,
                false => 0.0,
            }),
        }
    }
}

/// Returns a strength beyond any stress whose products do not overflow.
fn boundless<T: Real>() -> f64 {
    if size_of::<T>() == 4 { 1e15 } else { 1e120 }
}

impl<T: Real> Sets<T> {
    /// Creates the sets of all lane patterns; `None` for sets of both kinds, or of another kind. The offset of a field
    /// is its index times `pitch`.
    pub(super) fn new(media: &[Medium], patterns: &[Vec<u16>], pitch: usize) -> Option<Self> {
        match Strengths::new(media, patterns, pitch) {
            Some(strengths) => Some(Self::Mises(strengths)),
            None => half_spaces::<T>(media, patterns, pitch).map(Self::HalfSpaces),
        }
    }
}

/// Returns the conditions by pattern; `None` if a set is not a polyhedron.
fn half_spaces<T: Real>(
    media: &[Medium],
    patterns: &[Vec<u16>],
    pitch: usize,
) -> Option<Vec<Vec<HalfSpace<T::Lanes>>>> {
    let fields = &media[0].fields;
    /// Condition: n by field, and k.
    struct Condition {
        normal: Vec<f64>,
        strength: f64,
    }
    let mut conditions: Vec<Vec<Condition>> = Vec::new();
    for medium in media {
        let Some(set) = &medium.yields else {
            conditions.push(Vec::new());
            continue;
        };
        let of = |(condition, strength): (ActiveCondition, f64)| {
            let component = |&field: &Field| match field {
                // One field stands for both components ij and ji in classical solids.
                Field::Stress(i, j) if i != j && medium.rotation.is_none() => {
                    condition.normal.force[i][j] + condition.normal.force[j][i]
                }
                _ => component(field, &condition.normal).unwrap_or(0.0),
            };
            Condition { normal: fields.iter().map(component).collect(), strength }
        };
        conditions.push(set.half_spaces()?.into_iter().map(of).collect());
    }
    let most = conditions.iter().map(Vec::len).max().unwrap_or(0);
    let by_pattern = patterns.iter().map(|pattern| {
        let half_space = |index: usize| {
            let lanes = |value: &dyn Fn(&Condition) -> f64, other: f64| {
                T::Lanes::by_lane(|lane| {
                    let own = conditions[usize::from(pattern[lane])].get(index);
                    T::from_f64(own.map_or(other, value))
                })
            };
            let normal = (0..fields.len())
                .filter(|&index| conditions.iter().flatten().any(|own| own.normal[index] != 0.0))
                .map(|index| (index * pitch, lanes(&|own| own.normal[index], 0.0)))
                .collect();
            HalfSpace { normal, strength: lanes(&|own| own.strength, boundless::<T>()) }
        };
        (0..most).map(half_space).collect()
    });
    Some(by_pattern.collect())
}

impl<T: Real> Strengths<T> {
    /// Creates Mises' sets of all lane patterns; `None` if a set is of another kind.
    fn new(media: &[Medium], patterns: &[Vec<u16>], pitch: usize) -> Option<Self> {
        let fields = &media[0].fields;
        let of_medium: Vec<Strength<f64>> = media
            .iter()
            .map(|medium| match &medium.yields {
                None => Some(Strength::none(boundless::<T>())),
                Some(set) => Some(Strength::new(set.downcast()?, medium.law.downcast()?)),
            })
            .collect::<Option<_>>()?;
        let by_pattern = patterns.iter().map(|pattern| {
            let lanes = |value: &dyn Fn(&Strength<f64>) -> f64| {
                T::Lanes::by_lane(|lane| T::from_f64(value(&of_medium[usize::from(pattern[lane])])))
            };
            let parts = |value: &dyn Fn(&Strength<f64>) -> [f64; PARTS]| {
                std::array::from_fn(|part| lanes(&|own| value(own)[part]))
            };
            Strength {
                strength: lanes(&|own| own.strength),
                friction: lanes(&|own| own.friction),
                shift: lanes(&|own| own.shift),
                a: lanes(&|own| own.a),
                softness: lanes(&|own| own.softness),
                half_rate: lanes(&|own| own.half_rate),
                weights: parts(&|own| own.weights),
                rates: parts(&|own| own.rates),
                compliances: parts(&|own| own.compliances),
            }
        });
        let seen = |part: usize| of_medium.iter().any(|own| own.weights[part] > 0.0);
        Some(Self {
            force: Matrix::new(fields, pitch, Field::Stress),
            couple: Matrix::new(fields, pitch, Field::Couple),
            by_pattern: by_pattern.collect(),
            seen: std::array::from_fn(seen),
        })
    }

    fn sees_deviator_alone(&self) -> bool {
        !self.seen[1..].contains(&true)
    }
}

/// Kernel: return mapping of adjacent groups of a row.
pub(super) struct Correct<'a, T: Real> {
    /// Data from the first of the groups on.
    pub(super) data: &'a mut [T::Lanes],
    pub(super) patterns: &'a [u32],
    pub(super) sets: &'a Sets<T>,
    /// By pattern, whether any lane has a yield set.
    pub(super) yields: &'a [bool],
    /// Plastic dissipation by group and lane, J/m³; added to.
    pub(super) dissipated: &'a mut [f64],
    /// Groups with stresses left to the scalar projection, and masks of their lanes.
    pub(super) left: &'a mut Vec<(usize, u16)>,
}

impl<T: Real> SimdKernel<T> for Correct<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        match self.sets {
            Sets::HalfSpaces(all) => {
                for (index, &pattern) in self.patterns.iter().enumerate() {
                    let (group, pattern) = (&self.data[index..], pattern as usize);
                    if !self.yields[pattern] {
                        continue;
                    }
                    let lanes = beyond::<T, V>(group, &all[pattern]);
                    if lanes != 0 {
                        self.left.push((index, lanes));
                    }
                }
            }
            Sets::Mises(strengths) if strengths.sees_deviator_alone() => {
                self.each::<V, true>(strengths);
            }
            Sets::Mises(strengths) => self.each::<V, false>(strengths),
        }
    }
}

impl<T: Real> Correct<'_, T> {
    /// Maps Mises' sets; sets that depend on the deviator of the force stress only have a separate compiled loop.
    #[inline(always)]
    fn each<V: Vector<T>, const DEVIATOR: bool>(self, strengths: &Strengths<T>) {
        let lanes = T::Lanes::COUNT;
        for (index, &pattern) in self.patterns.iter().enumerate() {
            let group = &mut self.data[index..];
            if !self.yields[pattern as usize] {
                continue;
            }
            let own = &strengths.by_pattern[pattern as usize];
            let mut lost = T::Lanes::ZERO;
            let Done { mapped, left } = correct::<T, V, DEVIATOR>(group, own, strengths, &mut lost);
            if mapped != 0 {
                let dissipated = &mut self.dissipated[index * lanes..][..lanes];
                for (own, lost) in dissipated.iter_mut().zip(lost.lanes()) {
                    let lost = lost.to_f64();
                    // NaN also enters the stress, where it is detected.
                    debug_assert!(lost.is_nan() || lost >= 0.0, "the correction adds energy");
                    *own += lost.max(0.0);
                }
            }
            if left != 0 {
                self.left.push((index, left));
            }
        }
    }
}

/// Returns the mask of the lanes whose stress violates any condition.
#[inline(always)]
fn beyond<T: Real, V: Vector<T>>(group: &[T::Lanes], half_spaces: &[HalfSpace<T::Lanes>]) -> u16 {
    let mut lanes = 0;
    for half_space in half_spaces {
        let mut value = V::ZERO;
        for (place, component) in &half_space.normal {
            value = value + V::load(component) * V::load(&group[*place]);
        }
        lanes |= value.greater_lanes(V::load(&half_space.strength));
    }
    lanes
}

/// Masks of the lanes of a group after the return mapping.
struct Done {
    mapped: u16,
    /// Lanes beyond their sets that are left to the scalar projection.
    left: u16,
}

/// Returns the mean, and ½|·|² of the symmetric deviator and of the antisymmetric part of a stress.
#[inline(always)]
fn invariants<T: Real, V: Vector<T>>(group: &[T::Lanes], matrix: &Matrix) -> (V, V, V) {
    let (mut mean, mut deviator, mut antisymmetric) = (V::ZERO, V::ZERO, V::ZERO);
    if let Some([a, b, c]) = matrix.normal {
        let (a, b, c) = (V::load(&group[a]), V::load(&group[b]), V::load(&group[c]));
        mean = V::THIRD * (a + b + c);
        let (ab, bc, ca) = (a - b, b - c, c - a);
        deviator = V::HALF * V::THIRD * (ab * ab + bc * bc + ca * ca);
    }
    for &[one, other] in &matrix.pairs {
        let (one, other) = (V::load(&group[one]), V::load(&group[other]));
        let (sum, difference) = (V::HALF * (one + other), V::HALF * (one - other));
        deviator = deviator + sum * sum;
        antisymmetric = antisymmetric + difference * difference;
    }
    (mean, deviator, antisymmetric)
}

/// Scales a stress in the masked lanes: subtracts the fraction `deviator` of the symmetric deviator and, unless
/// `DEVIATOR`, the fraction `antisymmetric` of the antisymmetric part, and adds `more` to the mean.
#[inline(always)]
fn relax<T: Real, V: Vector<T>, const DEVIATOR: bool>(
    group: &mut [T::Lanes],
    lanes: u16,
    matrix: &Matrix,
    (mean, more): (V, V),
    (deviator, antisymmetric): (V, V),
) {
    if let Some(normal) = matrix.normal {
        for place in normal {
            let own = V::load(&group[place]);
            let moved = own + (more - deviator * (own - mean));
            own.with_lanes(lanes, moved).store(&mut group[place]);
        }
    }
    for &[one, other] in &matrix.pairs {
        let (a, b) = (V::load(&group[one]), V::load(&group[other]));
        let symmetric = deviator * (V::HALF * (a + b));
        if DEVIATOR {
            a.with_lanes(lanes, a - symmetric).store(&mut group[one]);
            if other != one {
                b.with_lanes(lanes, b - symmetric).store(&mut group[other]);
            }
            continue;
        }
        let antisymmetric = antisymmetric * (V::HALF * (a - b));
        a.with_lanes(lanes, a - (symmetric + antisymmetric)).store(&mut group[one]);
        if other != one {
            b.with_lanes(lanes, b - (symmetric - antisymmetric)).store(&mut group[other]);
        }
    }
}

#[inline(always)]
fn correct<T: Real, V: Vector<T>, const DEVIATOR: bool>(
    group: &mut [T::Lanes],
    own: &Strength<T::Lanes>,
    strengths: &Strengths<T>,
    lost: &mut T::Lanes,
) -> Done {
    let Strengths { force, couple, seen, .. } = strengths;
    let (mean, deviator, antisymmetric) = invariants::<T, V>(group, force);
    // Invariants ½|s̄|² of each part.
    let mut squares = [deviator, antisymmetric, V::ZERO, V::ZERO, V::ZERO];
    let mut couple_mean = V::ZERO;
    let sees_couples = !DEVIATOR && (seen[2] || seen[3] || seen[4]);
    if sees_couples {
        let (mean, deviator, antisymmetric) = invariants::<T, V>(group, couple);
        couple_mean = mean;
        squares[2] = deviator;
        squares[3] = V::HALF * (V::ONE + V::ONE + V::ONE) * mean * mean;
        squares[4] = antisymmetric;
    }
    let mut square = V::load(&own.weights[0]) * squares[0];
    for part in 1..PARTS {
        if !DEVIATOR && seen[part] {
            square = square + V::load(&own.weights[part]) * squares[part];
        }
    }
    let strength = V::load(&own.strength);
    let room = strength - V::load(&own.friction) * mean;
    // Lanes whose mean stress alone is beyond the set.
    let left = V::MIN_POSITIVE.greater_lanes(room);
    let mapped = square.greater_lanes(room * room) & !left;
    if mapped == 0 {
        return Done { mapped, left };
    }
    let (shares, multiplier, parts_lost) = if DEVIATOR {
        let (share, multiplier) = one_rate::<T, V>(square, room, own);
        let mut shares = [V::ZERO; PARTS];
        shares[0] = share;
        (shares, multiplier, V::load(&own.compliances[0]) * squares[0] * share * share)
    } else {
        several_rates::<T, V>(squares, room, own, seen)
    };
    let quarter = V::QUARTER * V::load(&own.a) * multiplier;
    V::ZERO.with_lanes(mapped, parts_lost + (strength + quarter) * multiplier).store(lost);
    let more = -(V::load(&own.shift) * multiplier);
    relax::<T, V, DEVIATOR>(group, mapped, force, (mean, more), (shares[0], shares[1]));
    if sees_couples {
        let less = -(shares[3] * couple_mean);
        relax::<T, V, false>(group, mapped, couple, (couple_mean, less), (shares[2], shares[4]));
    }
    Done { mapped, left }
}

/// Returns the fraction that the deviator loses, and λ, if h(x) = 0 is linear: for an excess τ̄ − r, λ = 2(τ̄ − r)/(a +
/// d), and the deviator loses the fraction d λ/(2τ̄), with its rate d = Dp.
#[inline(always)]
fn one_rate<T: Real, V: Vector<T>>(square: V, room: V, own: &Strength<T::Lanes>) -> (V, V) {
    let shear = square.sqrt();
    let multiplier = V::load(&own.softness) * (shear - room).max(V::ZERO);
    // Avoids 0/0 in lanes without stress.
    (V::load(&own.half_rate) * multiplier / shear.max(V::MIN_POSITIVE), multiplier)
}

/// Returns the fraction that each part loses, λ, and the energy loss of the parts: by [`Equation::solve`].
#[inline(always)]
fn several_rates<T: Real, V: Vector<T>>(
    squares: [V; PARTS],
    room: V,
    own: &Strength<T::Lanes>,
    seen: &[bool; PARTS],
) -> ([V; PARTS], V, V) {
    let a = V::load(&own.a);
    let mut rates = [V::ZERO; PARTS];
    for (rate, own) in rates.iter_mut().zip(&own.rates) {
        *rate = V::load(own);
    }
    let mut weighted = [V::ZERO; PARTS];
    for part in 0..PARTS {
        weighted[part] = V::load(&own.weights[part]) * squares[part];
    }
    let Iterate { x, kept, .. } =
        Equation { squares: weighted, rates, a, shear_capacity: room, seen }.solve();
    let mut shares = [V::ZERO; PARTS];
    let (mut square_left, mut loss) = (V::ZERO, V::ZERO);
    for part in 0..PARTS {
        if seen[part] {
            let fraction = kept[part];
            shares[part] = x * rates[part] * fraction;
            square_left = square_left + weighted[part] * fraction * fraction;
            let compliance = V::load(&own.compliances[part]);
            loss = loss + compliance * squares[part] * shares[part] * shares[part];
        }
    }
    (shares, (x + x) * square_left.sqrt(), loss)
}
