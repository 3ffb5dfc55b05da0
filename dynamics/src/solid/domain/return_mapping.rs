//! Return mapping of total stresses in lanes, the initial stress included, by the projection P or the reflection 2P −
//! I, with any kinds of yield sets side by side.
//!
//! Every operation is that of the scalar projection ([`Medium::project`]), in the same order and in double precision:
//! results are equal to the bit. Groups in which no lane yields are skipped after the condition is evaluated. Newton's
//! method runs on a batch of blocks: converged blocks do not wait for the others. Lanes are projected by the scalar
//! function if the mean may reach the apex, and if the set is a polyhedron, whose half-spaces are tested in lanes, or
//! of another kind.
//!
//! A block of eight stresses takes 16 to 19 divisions and 3 to 4 roots in a classical solid with initial stress: three
//! divisions and one root per step of Newton's method, two divisions per energy. Newton's method is bound by the
//! division unit; the rest of the time is spent on about 400 additions, multiplications and comparisons.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors, parts and lanes")]

mod batch;

use self::batch::{BATCH, Batch, Found, Pending};
use super::total_stress::{
    Block, InitialStress, Tensors, TotalStressSets, WIDTH, Wide, load_cone, load_moduli,
    load_tensors, tensors,
};
use crate::simd::{Group, Instructions, Number, SimdKernel, Vector};
use crate::solid::cell_laws::correction;
use crate::solid::medium::Medium;
use models::common::number::third;
use models::solid::parameters::stored_energy;
use models::solid::stress::{Shape, Stress, Tensor};
use models::yield_set::return_mapping::{Cone, Mapped, PARTS, Parts, ROUNDING, sum_of};

/// Kernel: return mapping of adjacent blocks of a row.
pub(super) struct MapStresses<'a> {
    pub(super) mapping: &'a TotalStressSets,
    pub(super) media: &'a [Medium],
    /// Data from the first of the blocks on.
    pub(super) data: &'a mut [Wide],
    /// Distance between two fields in `data`, in blocks.
    pub(super) pitch: usize,
    /// Lane patterns by group.
    pub(super) patterns: &'a [u32],
    /// By pattern, whether any lane has a yield set.
    pub(super) yields: &'a [bool],
    /// Blocks per group: 1 in double, 2 in single precision.
    pub(super) blocks_per_group: usize,
    /// Initial stress: empty without one, one entry for all blocks, or one entry per block of the row.
    pub(super) initial: &'a [InitialStress],
    pub(super) reflects: bool,
    /// Index of the first group in its row; number of lanes that are cells in every group of the row; number of leading
    /// groups of the row with one more.
    pub(super) row: [usize; 3],
    /// Plastic dissipation by block and lane, J/m³; added to.
    pub(super) dissipated: &'a mut [f64],
    /// Work of the initial stress by block and lane, J/m³; added to; empty without initial stress.
    pub(super) released: &'a mut [f64],
    /// By group, mask of the lanes of own cells; `None` if the row has no own cells.
    pub(super) own_lanes: Option<&'a [u16]>,
    /// Smallest ratio of plastic dissipation to stored energy over own cells; updated.
    pub(super) least_plastic: &'a mut f64,
    /// Set to true if any stress is mapped.
    pub(super) has_mapped: &'a mut bool,
}

/// Runs the kernel with an instruction set; compiled once, in this crate.
pub(super) fn map_in_lanes(instructions: Instructions, work: MapStresses<'_>) {
    instructions.run::<f64>(work);
}

impl SimdKernel<f64> for MapStresses<'_> {
    #[inline(always)]
    fn run<V: Vector<f64>>(mut self) {
        const PLANE: Shape = Shape { is_symmetric: true, is_plane: true, has_couples: false };
        const SPACE: Shape = Shape { is_plane: false, ..PLANE };
        const COSSERAT_PLANE: Shape = Shape { is_plane: true, ..Shape::ANY };
        const DEVIATOR: [bool; PARTS] = [true, false, false, false, false];
        let seen = self.mapping.seen;
        match self.mapping.shape {
            PLANE => self.each::<V>(PLANE, &DEVIATOR),
            SPACE => self.each::<V>(SPACE, &DEVIATOR),
            COSSERAT_PLANE => self.each::<V>(COSSERAT_PLANE, &seen),
            _ => self.each::<V>(Shape::ANY, &seen),
        }
    }
}

/// Energy changes of the return mapping in lanes, J/m³.
struct Taken<V> {
    dissipated: V,
    released: V,
    /// Ratio of dissipation to stored energy if negative, else zero.
    shares: V,
}

impl<V: Number> Taken<V> {
    const NONE: Self = Self { dissipated: V::ZERO, released: V::ZERO, shares: V::ZERO };
}

/// Trial stress in lanes, and its parts.
struct Trial<V> {
    stress: Tensors<V>,
    parts: Parts<V>,
    /// Weighted invariants ½p|s̄|² of the parts.
    weighted: [V; PARTS],
    /// Square of the equivalent shear stress τ̄, Pa².
    square: V,
    /// Shear capacity r.
    room: V,
}

impl<V: Vector<f64>> Trial<V> {
    #[inline(always)]
    fn new(shape: Shape, seen: &[bool; PARTS], cone: &Cone<V>, stress: Tensors<V>) -> Self {
        let parts = Parts::new(shape, &stress[0], &stress[1]);
        let weighted = parts.weighted(cone, seen);
        let room = cone.strength - cone.friction * parts.force.0;
        Self { stress, parts, weighted, square: sum_of(&weighted, seen), room }
    }

    /// Whether all lanes are within the set, by a sufficient test.
    #[inline(always)]
    fn is_inside(&self) -> bool {
        !self.square.any_gt(self.room * self.room) && !V::ZERO.any_gt(self.room)
    }

    /// Returns the mask of the lanes beyond the set by more than rounding, as in
    /// [`Mises::project`](models::yield_set::parameters::Mises::project).
    #[inline(always)]
    fn yielding(&self, shape: Shape, cone: &Cone<V>, shear: V) -> u16 {
        let mean = self.parts.force.0;
        let size = shear + cone.friction * mean.max(-mean) + cone.strength;
        let excess = shear - self.room;
        let possible = excess.greater_lanes(V::from_f64(ROUNDING) * size);
        // The excess is mostly far greater, so that the root in the rounding bound of the components is not needed.
        let allowed = V::from_f64(1.0 / ROUNDING) * excess - size;
        let [force, couple] = cone.rounding_weights;
        let [deviator, antisymmetric, couple_deviator, couple_mean, couple_antisymmetric] =
            self.parts.squares;
        let three = V::from_f64(3.0);
        let rounded = force * (deviator + antisymmetric + three * mean * mean)
            + couple * (couple_deviator + couple_mean + couple_antisymmetric);
        let certain = (V::from_f64(0.999) * allowed * allowed).greater_lanes(rounded)
            & (V::from_f64(0.5 / ROUNDING) * excess).greater_lanes(size);
        if possible & !certain == 0 {
            return possible;
        }
        let [force, couple] =
            [force * shape.square(0, &self.stress[0]), couple * shape.square(1, &self.stress[1])];
        let rounded = (force + couple).sqrt();
        excess.greater_lanes(V::from_f64(ROUNDING) * (size + rounded))
    }

    /// Returns the mask of the lanes that may be mapped to the apex.
    #[inline(always)]
    fn beyond_apex(&self) -> u16 {
        V::ZERO.greater_lanes(self.room) | V::MIN_POSITIVE.greater_lanes(self.square)
    }
}

impl<'a> MapStresses<'a> {
    #[inline(always)]
    fn each<V: Vector<f64>>(&mut self, shape: Shape, seen: &[bool; PARTS]) {
        let count = self.patterns.len() * self.blocks_per_group;
        // Energy of the initial stress, and the number of the block for which it was computed.
        let mut energy = (V::ZERO, usize::MAX);
        let mut batch = Batch { count: 0, found: [Found::NONE; BATCH], was_found: false };
        for first in (0..count).step_by(BATCH) {
            batch.count = 0;
            let mut pending = Pending { count: 0, all: [0; BATCH] };
            for place in first..count.min(first + BATCH) {
                if self.yields[self.patterns[place >> self.log_of_blocks_per_group()] as usize] {
                    self.look((shape, seen), place, &mut batch, &mut pending);
                }
            }
            self.iterate(seen, &mut batch, pending);
            for index in 0..batch.count {
                self.finish((shape, seen), &batch.found[index], &mut energy);
            }
            if batch.count > 0 {
                *self.has_mapped = true;
            }
        }
    }

    /// Returns log₂ of the number of blocks per group.
    #[inline(always)]
    const fn log_of_blocks_per_group(&self) -> u32 {
        self.blocks_per_group.trailing_zeros()
    }

    /// Returns number and constants of the block at a place of the row.
    #[inline(always)]
    fn block(&self, place: usize) -> (usize, &'a Block) {
        let pattern = self.patterns[place >> self.log_of_blocks_per_group()] as usize;
        let number = pattern * self.blocks_per_group + (place & (self.blocks_per_group - 1));
        (number, &self.mapping.blocks[number])
    }

    /// Tests a block for lanes beyond their sets, and adds it to the batch if there are any.
    #[inline(always)]
    fn look<V: Vector<f64>>(
        &self,
        (shape, seen): (Shape, &[bool; PARTS]),
        place: usize,
        batch: &mut Batch<V>,
        pending: &mut Pending,
    ) {
        let (_, block) = self.block(place);
        let initial = self.initial_at(place);
        let cone = load_cone::<V>(&block.cone);
        let stress = self.stress::<V>(shape, place, initial);
        let is_plain = block.half_spaces.is_empty() && block.others == 0;
        // If the previous block yielded, this one probably does too: skip the cheaper test.
        if is_plain && shape.is_symmetric && !batch.was_found && is_inside(shape, &cone, &stress[0])
        {
            return;
        }
        batch.was_found = false;
        let trial = Trial::new(shape, seen, &cone, stress);
        if is_plain && trial.is_inside() {
            return;
        }
        let cells = self.cells(place);
        let mut alone = block.others & cells;
        if !is_plain {
            alone |= self.beyond_half_spaces::<V>(place, block, initial) & cells;
        }
        let shear = trial.square.max(V::MIN_POSITIVE).sqrt();
        let yielding = trial.yielding(shape, &cone, shear) & block.cones & cells;
        let beyond = trial.beyond_apex() & yielding;
        let (alone, lanes) = (alone | beyond, yielding & !beyond);
        if alone | lanes == 0 {
            return;
        }
        let found = &mut batch.found[batch.count];
        (found.place, found.lanes, found.alone) = (place, lanes, alone);
        found.room = trial.room.max(V::ZERO);
        found.at.shear = shear;
        for part in 0..PARTS {
            if seen[part] {
                found.squares[part] = trial.weighted[part];
            }
        }
        if shape.is_symmetric {
            let (mean, deviator, _) = &trial.parts.force;
            let diagonal = [deviator[0][0], deviator[1][1], deviator[2][2]];
            found.symmetric = (*mean, diagonal, trial.parts.squares[0]);
        }
        pending.push(batch.count, lanes != 0);
        batch.was_found = true;
        batch.count += 1;
    }

    /// Iterates Newton's method until all blocks have converged; converged blocks do not wait for the others.
    #[inline(always)]
    fn iterate<V: Vector<f64>>(
        &self,
        seen: &[bool; PARTS],
        batch: &mut Batch<V>,
        mut pending: Pending,
    ) {
        let mut left = Pending { count: 0, all: [0; BATCH] };
        for &index in &pending.all[..pending.count] {
            let found = &mut batch.found[usize::from(index)];
            let cone = load_cone::<V>(&self.block(found.place).1.cone);
            let (equation, at) = found.equation(seen, &cone);
            let at = equation.at(equation.first(&equation.at_zero(at.shear)));
            found.set(seen, &at);
            left.push(index.into(), at.excess.any_gt(V::ZERO));
        }
        pending = left;
        while pending.count > 0 {
            let mut left = Pending { count: 0, all: [0; BATCH] };
            for &index in &pending.all[..pending.count] {
                let found = &mut batch.found[usize::from(index)];
                let cone = load_cone::<V>(&self.block(found.place).1.cone);
                let (equation, at) = found.equation(seen, &cone);
                let next = equation.next(&at);
                if !next.any_gt(at.x) {
                    continue;
                }
                let at = equation.at(next);
                found.set(seen, &at);
                left.push(index.into(), at.excess.any_gt(V::ZERO));
            }
            pending = left;
        }
    }

    /// Maps the lanes of a block beyond their sets and accumulates their energies.
    #[inline(always)]
    fn finish<V: Vector<f64>>(
        &mut self,
        (shape, seen): (Shape, &[bool; PARTS]),
        found: &Found<V>,
        (energy, known): &mut (V, usize),
    ) {
        let place = found.place;
        let (number, block) = self.block(place);
        let initial = self.initial_at(place);
        let mut taken = Taken::NONE;
        let mut alone = found.alone;
        if found.lanes != 0 {
            let moduli = load_moduli::<V>(&block.moduli);
            if let Some(initial) = initial
                && (*known != number || self.initial.len() > 1)
            {
                let [force, couple] = load_tensors::<V>(&initial.0);
                (*energy, *known) = (stored_energy(shape, &force, &couple, &moduli), number);
            }
            let cone = load_cone::<V>(&block.cone);
            alone |=
                self.map((shape, seen), found, (&cone, &moduli), (initial, *energy), &mut taken);
        }
        if alone != 0 {
            let mut own = Taken::NONE;
            self.map_alone((place, alone), &block.media, initial, &mut own);
            taken.dissipated = taken.dissipated.with_lanes(alone, V::load(&own.dissipated));
            taken.released = taken.released.with_lanes(alone, V::load(&own.released));
            taken.shares = taken.shares.with_lanes(alone, V::load(&own.shares));
        }
        add_lanes(&mut self.dissipated[place * WIDTH..][..WIDTH], taken.dissipated);
        if let Some(released) = self.released.get_mut(place * WIDTH..(place + 1) * WIDTH) {
            add_lanes(released, taken.released);
        }
        if V::ZERO.any_gt(taken.shares) {
            self.note_shares(place, taken.shares);
        }
    }

    /// Updates the smallest ratio of dissipation to stored energy over own cells.
    #[inline(never)]
    fn note_shares<V: Vector<f64>>(&mut self, place: usize, shares: V) {
        let Some(own) = self.own_lanes else { return };
        let half = place & (self.blocks_per_group - 1);
        let own = own[place >> self.log_of_blocks_per_group()] >> (half * WIDTH);
        let mut wide = Wide::ZERO;
        shares.store(&mut wide);
        for lane in (0..WIDTH).filter(|lane| own >> lane & 1 == 1) {
            *self.least_plastic = self.least_plastic.min(wide.lanes()[lane]);
        }
    }

    /// Returns the initial stress of a block, if there is one.
    #[inline(always)]
    fn initial_at(&self, place: usize) -> Option<&'a InitialStress> {
        match self.initial {
            [] => None,
            [one] => Some(one),
            all => all.get(self.row[0] * self.blocks_per_group + place),
        }
    }

    /// Returns the mask of the lanes that are cells.
    #[inline(always)]
    fn cells(&self, place: usize) -> u16 {
        let [first, whole, rest] = self.row;
        let (index, half) =
            (place >> self.log_of_blocks_per_group(), place & (self.blocks_per_group - 1));
        let own = whole + usize::from(first + index < rest);
        let own = own.saturating_sub(half * WIDTH).min(WIDTH);
        (1 << own) - 1
    }

    /// Loads the total stress of a block.
    #[inline(always)]
    fn stress<V: Vector<f64>>(
        &self,
        shape: Shape,
        place: usize,
        initial: Option<&InitialStress>,
    ) -> Tensors<V> {
        let mut stress = [[[V::ZERO; 3]; 3]; 2];
        for which in 0..if shape.has_couples { 2 } else { 1 } {
            for i in 0..3 {
                for j in 0..3 {
                    if which == 0 && shape.is_symmetric && j < i {
                        stress[0][i][j] = stress[0][j][i];
                    } else if shape.has(which, i, j) {
                        stress[which][i][j] = self.component([which, i, j], place, initial);
                    }
                }
            }
        }
        stress
    }

    /// Loads a component of the total stress of a block.
    #[inline(always)]
    fn component<V: Vector<f64>>(
        &self,
        [which, i, j]: [usize; 3],
        place: usize,
        initial: Option<&InitialStress>,
    ) -> V {
        let own = match self.mapping.places[which][i][j] {
            Some(field) => V::load(&self.data[field * self.pitch + place]),
            None => V::ZERO,
        };
        match initial {
            Some(initial) => own + V::load(&initial.0[which][i][j]),
            None => own + V::ZERO,
        }
    }

    /// Returns the mask of the lanes beyond a half-space, even if only by rounding.
    #[inline(always)]
    fn beyond_half_spaces<V: Vector<f64>>(
        &self,
        place: usize,
        block: &Block,
        initial: Option<&InitialStress>,
    ) -> u16 {
        let mut lanes = 0;
        for half_space in &block.half_spaces {
            let mut value = V::ZERO;
            for (component, normal) in &half_space.normal {
                value = value + V::load(normal) * self.component(*component, place, initial);
            }
            lanes |= value.greater_lanes(V::load(&half_space.strength));
        }
        lanes
    }

    /// Maps the given lanes of a block; returns the mask of those left to the scalar projection.
    #[inline(always)]
    fn map<V: Vector<f64>>(
        &mut self,
        (shape, seen): (Shape, &[bool; PARTS]),
        found: &Found<V>,
        (cone, moduli): (&Cone<V>, &[[V; 3]; 2]),
        (initial, energy): (Option<&InitialStress>, V),
        taken: &mut Taken<V>,
    ) -> u16 {
        let Found { place, lanes, .. } = *found;
        let (_, root) = found.equation(seen, cone);
        let stress = self.stress::<V>(shape, place, initial);
        let parts = found.parts(shape, &stress);
        let mean = parts.force.0;
        let mapped =
            Mapped::new(cone, &parts.squares, [V::ONE, root.x], root.reciprocal, root.kept, seen);
        // Lanes whose mean is recovered from the yield condition, by the scalar function. τ̄ = 1/(1/τ̄) is rounded
        // there.
        let least = cone.strength + root.shear * V::from_f64(1.0 - 4.0 * f64::EPSILON);
        let size = cone.friction * (mean.max(-mean) + mapped.mean_drop);
        let left = size.greater_lanes(least) & lanes;
        let (force, couple) = parts.scaled(shape, &mapped.kept, mean - mapped.mean_drop);
        let own = [force, couple];
        let mut plastic = [[[V::ZERO; 3]; 3]; 2];
        let mut greatest = V::ZERO;
        for which in 0..if shape.has_couples { 2 } else { 1 } {
            for i in 0..3 {
                for j in 0..3 {
                    if shape.has(which, i, j) {
                        let change = stress[which][i][j] - own[which][i][j];
                        plastic[which][i][j] = change;
                        greatest = greatest.max(change.max(-change));
                    }
                }
            }
        }
        let lanes = lanes & !left & greatest.greater_lanes(V::ZERO);
        let of_plastic = match self.reflects || initial.is_some() {
            true => stored_energy(shape, &plastic[0], &plastic[1], moduli),
            false => V::ZERO,
        };
        let times = if self.reflects { V::ONE + V::ONE } else { V::ONE };
        let beyond = if self.reflects { of_plastic } else { V::ZERO };
        let dissipated = times * (mapped.energy_lost - beyond);
        taken.dissipated = V::ZERO.with_lanes(lanes, dissipated);
        if V::ZERO.greater_lanes(dissipated) & lanes != 0 {
            let energy = stored_energy(shape, &stress[0], &stress[1], moduli);
            let share = dissipated / energy.max(V::MIN_POSITIVE);
            taken.shares = V::ZERO.with_lanes(lanes, share.min(V::ZERO));
        }
        if let Some(initial) = initial {
            let mut both = plastic;
            for which in 0..if shape.has_couples { 2 } else { 1 } {
                for i in 0..3 {
                    for j in 0..3 {
                        if shape.has(which, i, j) {
                            both[which][i][j] =
                                plastic[which][i][j] + V::load(&initial.0[which][i][j]);
                        }
                    }
                }
            }
            let of_both = stored_energy(shape, &both[0], &both[1], moduli);
            let released = times * (of_both - of_plastic - energy);
            taken.released = V::ZERO.with_lanes(lanes, released);
        }
        self.put(shape, (place, lanes), (&own, &plastic), initial);
        left
    }

    /// Stores the mapped stress, or its reflection, minus the initial stress.
    #[inline(always)]
    fn put<V: Vector<f64>>(
        &mut self,
        shape: Shape,
        (place, lanes): (usize, u16),
        (own, plastic): (&Tensors<V>, &Tensors<V>),
        initial: Option<&InitialStress>,
    ) {
        for which in 0..if shape.has_couples { 2 } else { 1 } {
            for i in 0..3 {
                for j in 0..3 {
                    if !shape.has(which, i, j) || (shape.is_symmetric && j < i) {
                        continue;
                    }
                    let Some(field) = self.mapping.targets[which][i][j] else { continue };
                    let mut moved = own[which][i][j];
                    if self.reflects {
                        moved = moved - plastic[which][i][j];
                    }
                    if let Some(initial) = initial {
                        moved = moved - V::load(&initial.0[which][i][j]);
                    }
                    let block = &mut self.data[field * self.pitch + place];
                    V::load(block).with_lanes(lanes, moved).store(block);
                }
            }
        }
    }

    /// Maps lanes by the scalar function.
    #[inline(never)]
    fn map_alone(
        &mut self,
        (place, lanes): (usize, u16),
        media: &[u16; WIDTH],
        initial: Option<&InitialStress>,
        taken: &mut Taken<Wide>,
    ) {
        for lane in (0..WIDTH).filter(|lane| lanes >> lane & 1 == 1) {
            let mut deviation = [[[0.0; 3]; 3]; 2];
            for which in 0..2 {
                for i in 0..3 {
                    for j in 0..3 {
                        if let Some(field) = self.mapping.places[which][i][j] {
                            let block = &self.data[field * self.pitch + place];
                            deviation[which][i][j] = block.lanes()[lane];
                        }
                    }
                }
            }
            let [force, couple] = deviation;
            let (medium, initial) =
                (&self.media[usize::from(media[lane])], initial.map(|own| own.of(lane)));
            let deviation = Stress { force, couple };
            let Some(done) = correction(medium, &deviation, initial.as_ref(), self.reflects) else {
                continue;
            };
            taken.dissipated.lanes_mut()[lane] = done.dissipated;
            taken.released.lanes_mut()[lane] = done.released;
            taken.shares.lanes_mut()[lane] = done.share.min(0.0);
            for which in 0..2 {
                for i in 0..3 {
                    for j in 0..3 {
                        if let Some(field) = self.mapping.targets[which][i][j] {
                            let block = &mut self.data[field * self.pitch + place];
                            block.lanes_mut()[lane] = tensors(&done.stress)[which][i][j];
                        }
                    }
                }
            }
        }
    }
}

/// Whether a symmetric stress is within the set in all lanes, by fewer operations than [`Trial::is_inside`]: the
/// deviator's |s|² = ⅓ Σ (σᵢᵢ − σⱼⱼ)² + 2 Σ σᵢⱼ² (sums over i < j) differs from that of the parts by a few roundings,
/// of which the condition allows 32.
#[inline(always)]
fn is_inside<V: Vector<f64>>(shape: Shape, cone: &Cone<V>, stress: &Tensor<V>) -> bool {
    let mut off_diagonal = V::ZERO;
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        if shape.has(0, i, j) {
            off_diagonal = off_diagonal + stress[i][j] * stress[i][j];
        }
    }
    let [a, b, c] = [stress[0][0], stress[1][1], stress[2][2]];
    let (ab, bc, ca) = (a - b, b - c, c - a);
    let square = V::THIRD * (ab * ab + bc * bc + ca * ca) + (off_diagonal + off_diagonal);
    let room = cone.strength - cone.friction * third(a + b + c);
    !(cone.half_weights[0] * square).any_gt(room * room) && !V::ZERO.any_gt(room)
}

/// Adds `more` to a list, lane by lane.
#[inline(always)]
fn add_lanes<V: Vector<f64>>(to: &mut [f64], more: V) {
    let mut wide = Wide::ZERO;
    wide.lanes_mut().copy_from_slice(to);
    (V::load(&wide) + more).store(&mut wide);
    to.copy_from_slice(wide.lanes());
}
