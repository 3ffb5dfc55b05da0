//! Return mapping without initial stress in SIMD lanes, by projection, if all yield sets are of one kind: Mises' set in
//! all its forms, with the energy it dissipates, or polyhedra. The formulas for Mises' set are derived at
//! [`Mises::project`](models::yield_set::parameters::Mises::project); if the yield condition depends, apart from the
//! mean, on the deviator of the force stress only, its root is in closed form. Stresses whose mean is at or beyond the
//! apex are mapped by that scalar function. For polyhedra all conditions are evaluated in lanes, and a stress that
//! violates a condition is projected by the scalar function. All other configurations are mapped by `return_mapping`.
//!
//! Lanes are mapped independently of each other, so that the result in a cell does not depend on the decomposition;
//! stresses within their sets are unchanged bit for bit.

use crate::simd::{LaneGroup, Number, Real, SimdKernel, Vector};
use crate::solid::medium::{Medium, stress_component};
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use models::yield_set::parameters::{ActiveCondition, Mises};
use models::yield_set::return_mapping::{ConsistencyEquation, EIGENSPACE_COUNT, NewtonIterate};

/// Yield sets of one kind, in lanes, by lane pattern.
#[derive(Clone)]
pub(super) enum YieldSets<T: Real> {
    Mises(MisesSets<T>),
    /// Conditions of polyhedral sets: stresses that satisfy all of them are unchanged, all others are projected by the
    /// scalar function.
    HalfSpaces(Vec<Vec<LaneHalfSpace<T::Lanes>>>),
}

/// Half-space n·s ≤ k in lanes.
#[derive(Clone)]
pub(super) struct LaneHalfSpace<N> {
    /// Offsets of stresses, and the corresponding components of n.
    normal: Vec<(usize, N)>,
    strength: N,
}

/// Mises' sets by lane pattern.
#[derive(Clone)]
pub(super) struct MisesSets<T: Real> {
    force: TensorOffsets,
    couple: TensorOffsets,
    /// Flags of the eigenspaces of the stress with a nonzero weight in any set.
    active_eigenspaces: [bool; EIGENSPACE_COUNT],
    by_pattern: Vec<MisesConstants<T::Lanes>>,
}

/// Offsets of the components of a force or couple stress.
#[derive(Clone, Default)]
pub(super) struct TensorOffsets {
    pub(super) normal: Option<[usize; 3]>,
    /// Offsets of the components ij and ji, which are the same if one field stands for both.
    pub(super) pairs: Vec<[usize; 2]>,
}

impl TensorOffsets {
    pub(super) fn new(
        fields: &[SolidField],
        pitch: usize,
        component_field: fn(usize, usize) -> SolidField,
    ) -> Self {
        let index =
            |i: usize, j: usize| fields.iter().position(|own| *own == component_field(i, j));
        let offset = |i: usize, j: usize| Some(index(i, j)? * pitch);
        let normal = [offset(0, 0), offset(1, 1), offset(2, 2)];
        let pairs = [[0, 1], [0, 2], [1, 2]].into_iter().filter_map(|[i, j]| {
            let [upper, lower] = [offset(i, j), offset(j, i)];
            Some([upper.or(lower)?, lower.or(upper)?])
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

/// Constants of Mises' set in lanes.
#[derive(Clone, Copy)]
struct MisesConstants<N> {
    /// Strength k, Pa; in lanes without yield set greater than any stress.
    strength: N,
    /// Friction coefficient κ; 0 in lanes without yield set.
    friction: N,
    /// Decrease κK of the mean stress per plastic multiplier, Pa, with the bulk modulus K.
    mean_drop: N,
    /// Coefficient a = 2κ²K, Pa.
    a: N,
    /// Plastic multiplier per excess of the equivalent shear stress τ̄, 2/(a + d), 1/Pa, with the product d = Dp of
    /// stiffness and weight of the deviator of the force stress; then ½d, Pa.
    multiplier_per_excess: N,
    half_rate: N,
    /// Weights p, products Dp and compliances 1/D of the eigenspaces, with the stiffnesses D.
    weights: [N; EIGENSPACE_COUNT],
    rates: [N; EIGENSPACE_COUNT],
    compliances: [N; EIGENSPACE_COUNT],
}

impl MisesConstants<f64> {
    /// Creates the constants of a medium without yield condition: `strength` is beyond any stress.
    fn with_unbounded_strength(strength: f64) -> Self {
        let mut rates = [0.0; EIGENSPACE_COUNT];
        // Any nonzero value, since the weights are zero.
        rates[0] = 1.0;
        let [weights, compliances] = [[0.0; EIGENSPACE_COUNT]; 2];
        let [friction, mean_drop, a, half_rate] = [0.0; 4];
        let multiplier_per_excess = 1.0;
        Self {
            strength,
            friction,
            mean_drop,
            a,
            multiplier_per_excess,
            half_rate,
            weights,
            rates,
            compliances,
        }
    }

    fn new(set: &Mises, solid: &Isotropic) -> Self {
        let bulk = solid.lambda + 2.0 / 3.0 * solid.mu;
        let Mises { friction, strength, .. } = *set;
        let [mean_drop, a] = [friction * bulk, 2.0 * friction * friction * bulk];
        // Eigenspaces without weight or stiffness are not mapped.
        let eigenspaces = set
            .eigenspace_coefficients(solid)
            .map(|part| if part[0] > 0.0 && part[1] > 0.0 { part } else { [0.0; 2] });
        Self {
            strength,
            friction,
            mean_drop,
            a,
            multiplier_per_excess: 2.0 / (a + eigenspaces[0][0] * eigenspaces[0][1]),
            half_rate: 0.5 * eigenspaces[0][0] * eigenspaces[0][1],
            weights: eigenspaces.map(|[weight, _]| weight),
            rates: eigenspaces.map(|[weight, stiffness]| weight * stiffness),
            compliances: eigenspaces.map(|[weight, stiffness]| match weight > 0.0 {
                true => 1.0 / stiffness,
                false => 0.0,
            }),
        }
    }
}

/// Returns a strength beyond any stress whose products do not overflow.
fn unbounded_strength<T: Real>() -> f64 {
    if size_of::<T>() == 4 { 1e15 } else { 1e120 }
}

impl<T: Real> YieldSets<T> {
    /// Creates the sets of all lane patterns; `None` if some sets are Mises' and others polyhedra, or if a set is of
    /// another kind. The offset of a field is its index times `pitch`.
    pub(super) fn new(media: &[Medium], patterns: &[Vec<u16>], pitch: usize) -> Option<Self> {
        match MisesSets::new(media, patterns, pitch) {
            Some(mises_sets) => Some(Self::Mises(mises_sets)),
            None => create_half_spaces::<T>(media, patterns, pitch).map(Self::HalfSpaces),
        }
    }
}

/// Creates the half-spaces of polyhedral sets by lane pattern; `None` if a set is not a polyhedron.
fn create_half_spaces<T: Real>(
    media: &[Medium],
    patterns: &[Vec<u16>],
    pitch: usize,
) -> Option<Vec<Vec<LaneHalfSpace<T::Lanes>>>> {
    let fields = &media[0].fields;
    /// Condition n·s ≤ k: components of n by field, and k.
    struct HalfSpaceCondition {
        normal: Vec<f64>,
        strength: f64,
    }
    let mut conditions: Vec<Vec<HalfSpaceCondition>> = Vec::new();
    for medium in media {
        let Some(set) = &medium.yield_set else {
            conditions.push(Vec::new());
            continue;
        };
        let half_space_condition = |(condition, strength): (ActiveCondition, f64)| {
            let component = |&field: &SolidField| match field {
                // One field stands for both components ij and ji in classical solids.
                SolidField::Stress(i, j) if i != j && medium.rotation.is_none() => {
                    condition.normal.force[i][j] + condition.normal.force[j][i]
                }
                _ => stress_component(field, &condition.normal).unwrap_or(0.0),
            };
            HalfSpaceCondition { normal: fields.iter().map(component).collect(), strength }
        };
        conditions.push(set.half_spaces()?.into_iter().map(half_space_condition).collect());
    }
    let max_count = conditions.iter().map(Vec::len).max().unwrap_or(0);
    let by_pattern = patterns.iter().map(|pattern| {
        let half_space = |index: usize| {
            let lanes = |value: &dyn Fn(&HalfSpaceCondition) -> f64, default_value: f64| {
                T::Lanes::from_lanes(|lane| {
                    let condition = conditions[usize::from(pattern[lane])].get(index);
                    T::from_f64(condition.map_or(default_value, value))
                })
            };
            let normal = (0..fields.len())
                .filter(|&index| {
                    conditions.iter().flatten().any(|condition| condition.normal[index] != 0.0)
                })
                .map(|index| (index * pitch, lanes(&|own| own.normal[index], 0.0)))
                .collect();
            LaneHalfSpace {
                normal,
                strength: lanes(&|own| own.strength, unbounded_strength::<T>()),
            }
        };
        (0..max_count).map(half_space).collect()
    });
    Some(by_pattern.collect())
}

impl<T: Real> MisesSets<T> {
    /// Creates Mises' sets of all lane patterns; `None` if a set is of another kind.
    fn new(media: &[Medium], patterns: &[Vec<u16>], pitch: usize) -> Option<Self> {
        let fields = &media[0].fields;
        let constants_by_medium: Vec<MisesConstants<f64>> = media
            .iter()
            .map(|medium| match &medium.yield_set {
                None => Some(MisesConstants::with_unbounded_strength(unbounded_strength::<T>())),
                Some(set) => Some(MisesConstants::new(set.downcast()?, medium.law.downcast()?)),
            })
            .collect::<Option<_>>()?;
        let by_pattern = patterns.iter().map(|pattern| {
            let lanes = |value: &dyn Fn(&MisesConstants<f64>) -> f64| {
                T::Lanes::from_lanes(|lane| {
                    T::from_f64(value(&constants_by_medium[usize::from(pattern[lane])]))
                })
            };
            let eigenspace_lanes =
                |value: &dyn Fn(&MisesConstants<f64>) -> [f64; EIGENSPACE_COUNT]| {
                    std::array::from_fn(|part| lanes(&|own| value(own)[part]))
                };
            MisesConstants {
                strength: lanes(&|own| own.strength),
                friction: lanes(&|own| own.friction),
                mean_drop: lanes(&|own| own.mean_drop),
                a: lanes(&|own| own.a),
                multiplier_per_excess: lanes(&|own| own.multiplier_per_excess),
                half_rate: lanes(&|own| own.half_rate),
                weights: eigenspace_lanes(&|own| own.weights),
                rates: eigenspace_lanes(&|own| own.rates),
                compliances: eigenspace_lanes(&|own| own.compliances),
            }
        });
        let active_eigenspaces =
            |part: usize| constants_by_medium.iter().any(|own| own.weights[part] > 0.0);
        Some(Self {
            force: TensorOffsets::new(fields, pitch, SolidField::Stress),
            couple: TensorOffsets::new(fields, pitch, SolidField::Couple),
            by_pattern: by_pattern.collect(),
            active_eigenspaces: std::array::from_fn(active_eigenspaces),
        })
    }

    /// Whether the yield conditions depend, apart from the mean, on the deviator of the force stress only.
    fn is_deviatoric(&self) -> bool {
        !self.active_eigenspaces[1..].contains(&true)
    }
}

/// Kernel: return mapping of adjacent groups of a row by projection.
pub(super) struct ProjectionKernel<'a, T: Real> {
    /// Field values from the first of these groups on.
    pub(super) field_data: &'a mut [T::Lanes],
    pub(super) lane_pattern_indices: &'a [u32],
    pub(super) yield_sets: &'a YieldSets<T>,
    /// By lane pattern, whether any lane has a yield set.
    pub(super) has_yield_set: &'a [bool],
    /// Ratio of the fields of the row to the physical fields, with which strengths are multiplied.
    pub(super) field_factor: T,
    /// Accumulated plastic dissipation by group and lane, J/m³.
    pub(super) dissipation: &'a mut [f64],
    /// Groups with stresses left to the scalar projection (index among these groups), and masks of their lanes.
    pub(super) scalar_lanes: &'a mut Vec<(usize, u16)>,
}

impl<T: Real> SimdKernel<T> for ProjectionKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let factor = <V as Vector<T>>::splat(self.field_factor);
        match self.yield_sets {
            YieldSets::HalfSpaces(all) => {
                for (index, &pattern) in self.lane_pattern_indices.iter().enumerate() {
                    let (group, pattern) = (&self.field_data[index..], pattern as usize);
                    if !self.has_yield_set[pattern] {
                        continue;
                    }
                    let lanes = lanes_beyond_half_spaces::<T, V>(group, &all[pattern], factor);
                    if lanes != 0 {
                        self.scalar_lanes.push((index, lanes));
                    }
                }
            }
            YieldSets::Mises(mises_sets) if mises_sets.is_deviatoric() => {
                self.map_groups::<V, true>(mises_sets);
            }
            YieldSets::Mises(mises_sets) => self.map_groups::<V, false>(mises_sets),
        }
    }
}

impl<T: Real> ProjectionKernel<'_, T> {
    /// Maps stresses onto Mises' sets; for sets that depend on the deviator of the force stress only, a separate loop
    /// is compiled.
    #[inline(always)]
    fn map_groups<V: Vector<T>, const DEVIATOR: bool>(self, mises_sets: &MisesSets<T>) {
        let lanes = T::Lanes::COUNT;
        let factor = <V as Vector<T>>::splat(self.field_factor);
        for (index, &pattern) in self.lane_pattern_indices.iter().enumerate() {
            let group = &mut self.field_data[index..];
            if !self.has_yield_set[pattern as usize] {
                continue;
            }
            let constants = &mises_sets.by_pattern[pattern as usize];
            let mut energy_loss = T::Lanes::ZERO;
            let MappingLanes { mapped_lanes, scalar_lanes } = map_group::<T, V, DEVIATOR>(
                group,
                (constants, factor),
                mises_sets,
                &mut energy_loss,
            );
            if mapped_lanes != 0 {
                let dissipation = &mut self.dissipation[index * lanes..][..lanes];
                for (own, energy_loss) in dissipation.iter_mut().zip(energy_loss.lanes()) {
                    let energy_loss = energy_loss.to_f64();
                    // A NaN also enters the stress, where it is detected.
                    debug_assert!(
                        energy_loss.is_nan() || energy_loss >= 0.0,
                        "the correction adds energy"
                    );
                    *own += energy_loss.max(0.0);
                }
            }
            if scalar_lanes != 0 {
                self.scalar_lanes.push((index, scalar_lanes));
            }
        }
    }
}

/// Returns the mask of the lanes whose stress violates any of the conditions.
#[inline(always)]
fn lanes_beyond_half_spaces<T: Real, V: Vector<T>>(
    group: &[T::Lanes],
    half_spaces: &[LaneHalfSpace<T::Lanes>],
    factor: V,
) -> u16 {
    let mut lanes = 0;
    for half_space in half_spaces {
        let mut value = V::ZERO;
        for (offset, component) in &half_space.normal {
            value = value + V::load(component) * V::load(&group[*offset]);
        }
        lanes |= value.greater_lanes(factor * V::load(&half_space.strength));
    }
    lanes
}

/// Masks of the lanes of a group after the return mapping.
struct MappingLanes {
    mapped_lanes: u16,
    /// Lanes left to the scalar projection, since their mean stress is at or beyond the apex.
    scalar_lanes: u16,
}

/// Returns the mean of a stress, and ½|·|² of its symmetric deviator and of its antisymmetric part.
#[inline(always)]
fn stress_invariants<T: Real, V: Vector<T>>(
    group: &[T::Lanes],
    offsets: &TensorOffsets,
) -> (V, V, V) {
    let (mut mean, mut deviator, mut antisymmetric) = (V::ZERO, V::ZERO, V::ZERO);
    if let Some([a, b, c]) = offsets.normal {
        let (a, b, c) = (V::load(&group[a]), V::load(&group[b]), V::load(&group[c]));
        mean = V::THIRD * (a + b + c);
        let (ab, bc, ca) = (a - b, b - c, c - a);
        deviator = V::HALF * V::THIRD * (ab * ab + bc * bc + ca * ca);
    }
    for &[one, other] in &offsets.pairs {
        let (one, other) = (V::load(&group[one]), V::load(&group[other]));
        let (sum, difference) = (V::HALF * (one + other), V::HALF * (one - other));
        deviator = deviator + sum * sum;
        antisymmetric = antisymmetric + difference * difference;
    }
    (mean, deviator, antisymmetric)
}

/// Scales a stress in the masked lanes: subtracts the fraction `deviator` of the symmetric deviator and, unless
/// `DEVIATOR`, the fraction `antisymmetric` of the antisymmetric part, and adds `mean_change` to the mean.
#[inline(always)]
fn scale_stress<T: Real, V: Vector<T>, const DEVIATOR: bool>(
    group: &mut [T::Lanes],
    lanes: u16,
    offsets: &TensorOffsets,
    (mean, mean_change): (V, V),
    (deviator, antisymmetric): (V, V),
) {
    if let Some(normal) = offsets.normal {
        for offset in normal {
            let stress = V::load(&group[offset]);
            let mapped = stress + (mean_change - deviator * (stress - mean));
            stress.blend_lanes(lanes, mapped).store(&mut group[offset]);
        }
    }
    for &[one, other] in &offsets.pairs {
        let (a, b) = (V::load(&group[one]), V::load(&group[other]));
        let symmetric = deviator * (V::HALF * (a + b));
        if DEVIATOR {
            a.blend_lanes(lanes, a - symmetric).store(&mut group[one]);
            if other != one {
                b.blend_lanes(lanes, b - symmetric).store(&mut group[other]);
            }
            continue;
        }
        let antisymmetric = antisymmetric * (V::HALF * (a - b));
        a.blend_lanes(lanes, a - (symmetric + antisymmetric)).store(&mut group[one]);
        if other != one {
            b.blend_lanes(lanes, b - (symmetric - antisymmetric)).store(&mut group[other]);
        }
    }
}

#[inline(always)]
fn map_group<T: Real, V: Vector<T>, const DEVIATOR: bool>(
    group: &mut [T::Lanes],
    (constants, factor): (&MisesConstants<T::Lanes>, V),
    mises_sets: &MisesSets<T>,
    energy_loss: &mut T::Lanes,
) -> MappingLanes {
    let MisesSets { force, couple, active_eigenspaces, .. } = mises_sets;
    let (mean, deviator, antisymmetric) = stress_invariants::<T, V>(group, force);
    // Invariants ½|s̄|² of the trial stress s̄ by eigenspace.
    let mut squares = [deviator, antisymmetric, V::ZERO, V::ZERO, V::ZERO];
    let mut couple_mean = V::ZERO;
    let has_couples =
        !DEVIATOR && (active_eigenspaces[2] || active_eigenspaces[3] || active_eigenspaces[4]);
    if has_couples {
        let (mean, deviator, antisymmetric) = stress_invariants::<T, V>(group, couple);
        couple_mean = mean;
        squares[2] = deviator;
        squares[3] = V::HALF * (V::ONE + V::ONE + V::ONE) * mean * mean;
        squares[4] = antisymmetric;
    }
    let mut square = V::load(&constants.weights[0]) * squares[0];
    for part in 1..EIGENSPACE_COUNT {
        if !DEVIATOR && active_eigenspaces[part] {
            square = square + V::load(&constants.weights[part]) * squares[part];
        }
    }
    let strength = factor * V::load(&constants.strength);
    let shear_capacity = strength - V::load(&constants.friction) * mean;
    // Lanes whose mean stress alone is at or beyond the apex of the set.
    let scalar_lanes = V::MIN_POSITIVE.greater_lanes(shear_capacity);
    let mapped_lanes = square.greater_lanes(shear_capacity * shear_capacity) & !scalar_lanes;
    if mapped_lanes == 0 {
        return MappingLanes { mapped_lanes, scalar_lanes };
    }
    let (removed_fractions, multiplier, parts_loss) = if DEVIATOR {
        let (removed_fraction, multiplier) =
            solve_single_rate::<T, V>(square, shear_capacity, constants);
        let mut removed_fractions = [V::ZERO; EIGENSPACE_COUNT];
        removed_fractions[0] = removed_fraction;
        (
            removed_fractions,
            multiplier,
            V::load(&constants.compliances[0]) * squares[0] * removed_fraction * removed_fraction,
        )
    } else {
        solve_several_rates::<T, V>(squares, shear_capacity, constants, active_eigenspaces)
    };
    let quarter = V::QUARTER * V::load(&constants.a) * multiplier;
    V::ZERO
        .blend_lanes(mapped_lanes, parts_loss + (strength + quarter) * multiplier)
        .store(energy_loss);
    let mean_change = -(V::load(&constants.mean_drop) * multiplier);
    scale_stress::<T, V, DEVIATOR>(
        group,
        mapped_lanes,
        force,
        (mean, mean_change),
        (removed_fractions[0], removed_fractions[1]),
    );
    if has_couples {
        let couple_mean_change = -(removed_fractions[3] * couple_mean);
        scale_stress::<T, V, false>(
            group,
            mapped_lanes,
            couple,
            (couple_mean, couple_mean_change),
            (removed_fractions[2], removed_fractions[4]),
        );
    }
    MappingLanes { mapped_lanes, scalar_lanes }
}

/// Returns the fraction that the deviator loses, and the plastic multiplier λ, if only the deviator and the mean of the
/// force stress enter the yield condition: for an excess τ̄ − r over the shear capacity r, λ = 2(τ̄ − r)/(a + d), and
/// the deviator loses the fraction d λ/(2τ̄), with d = Dp. `square` = τ̄².
#[inline(always)]
fn solve_single_rate<T: Real, V: Vector<T>>(
    square: V,
    shear_capacity: V,
    constants: &MisesConstants<T::Lanes>,
) -> (V, V) {
    let shear = square.sqrt();
    let multiplier =
        V::load(&constants.multiplier_per_excess) * (shear - shear_capacity).max(V::ZERO);
    // Avoids 0/0 in lanes without stress.
    (V::load(&constants.half_rate) * multiplier / shear.max(V::MIN_POSITIVE), multiplier)
}

/// Returns by eigenspace the fraction that the stress loses, the plastic multiplier λ, and the energy loss in the
/// eigenspaces, J/m³, by [`ConsistencyEquation::solve`]. `squares`: ½|s̄|² by eigenspace.
#[inline(always)]
fn solve_several_rates<T: Real, V: Vector<T>>(
    squares: [V; EIGENSPACE_COUNT],
    shear_capacity: V,
    constants: &MisesConstants<T::Lanes>,
    active_eigenspaces: &[bool; EIGENSPACE_COUNT],
) -> ([V; EIGENSPACE_COUNT], V, V) {
    let a = V::load(&constants.a);
    let mut rates = [V::ZERO; EIGENSPACE_COUNT];
    for (rate, constants) in rates.iter_mut().zip(&constants.rates) {
        *rate = V::load(constants);
    }
    let mut weighted = [V::ZERO; EIGENSPACE_COUNT];
    for part in 0..EIGENSPACE_COUNT {
        weighted[part] = V::load(&constants.weights[part]) * squares[part];
    }
    let NewtonIterate { x, scale_factors, .. } = ConsistencyEquation {
        squares: weighted,
        weighted_stiffnesses: rates,
        a,
        shear_capacity,
        active: active_eigenspaces,
    }
    .solve();
    let mut removed_fractions = [V::ZERO; EIGENSPACE_COUNT];
    let (mut remaining_square, mut loss) = (V::ZERO, V::ZERO);
    for part in 0..EIGENSPACE_COUNT {
        if active_eigenspaces[part] {
            let scale_factor = scale_factors[part];
            removed_fractions[part] = x * rates[part] * scale_factor;
            remaining_square = remaining_square + weighted[part] * scale_factor * scale_factor;
            let compliance = V::load(&constants.compliances[part]);
            loss = loss
                + compliance * squares[part] * removed_fractions[part] * removed_fractions[part];
        }
    }
    (removed_fractions, (x + x) * remaining_square.sqrt(), loss)
}
