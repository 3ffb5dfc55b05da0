//! Faces between cells of media with contacts. The Riemann problem has the impedance of closed contacts, the stiffest,
//! except at two kinds of faces.
//!
//! - Open pores: if the pores of both cells stay open during the sweep, the face has the impedances of open pores. The
//!   strain that a sweep of duration t can cause in a cell of length h is estimated as 2(t/h)·Σ(|Δv| + |Δs|/z), summed
//!   over the three faces between the four cells of the stencil, with the velocities v and stresses s of the longitudinal
//!   pair and the impedance z of open pores. A smaller impedance where pores may collapse would feed energy
//!   into the stiffer state. A plastic skeleton excludes such faces: with them, the limited reconstruction keeps a
//!   compaction shock behind an elastic precursor that is too weak, against the entropy condition, on any grid.
//! - Faces of granular media: the traction is in the cone of those that the friction cone admits on a plane; see
//!   [`separation`]. Media whose friction cone transmits tension have no such faces.

#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

pub(crate) mod separation;

use super::cell::CellConstants;
use super::contact_law::ContactLaw;
use super::medium::Medium;
use super::problem::Problem;
use super::reconstruction::{InterlayerStencil, Slopes};
use super::riemann::{InterfaceState, RiemannInvariants, State};
use crate::simd::{LaneGroup, Number, Real, Vector};
use models::solid::waves::VelocityStressPair;
use models::uniaxial::NO_LIMIT;
use separation::{ExcessInvariants, TractionCone, continuity, tangential_magnitude};

/// Constants of a medium at faces normal to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ContactConstants<N> {
    /// Constants of a cell with open pores; those of the cell itself in other media.
    pub(crate) open: CellConstants<N>,
    /// Ratio z/z′ of the impedances of closed and open pores.
    pub(crate) impedance_ratio: N,
    /// Porosity θ₀; [`NO_LIMIT`] in media without pores, which count as open, and −[`NO_LIMIT`] in those with a plastic
    /// skeleton, which count as collapsed.
    pub(crate) porosity: N,
    /// Greatest strain per sum of velocity jumps, 2t/h, s/m.
    pub(crate) strain_per_velocity: N,
    /// Greatest strain per sum of stress jumps, 2t/(hz) with the impedance z of open pores, 1/Pa.
    pub(crate) strain_per_stress: N,
    /// The same for transverse pairs, s/m and 1/Pa, in terms of longitudinal strain: a shear strain γ changes what keeps
    /// open contacts open as much as the longitudinal strain (æ/c)γ/√2/r, see `excess_compliances`; 0 in media that do
    /// not separate.
    pub(crate) shear_strains: [N; 2],
    /// Greatest ratio of tangential to normal traction; [`NO_LIMIT`] in media that do not separate.
    pub(crate) friction: N,
    /// Strain that closes open contacts: 1/(3kr) per sum of the normal components of the excess stress, less æc/(Mr) per
    /// norm of its deviator, 1/Pa, with r = 1 + √(2/3) æ/c; 0 in media that do not separate. The excess q keeps the
    /// contacts open while tr q/(3k) > (æc/M)|dev q|, and a longitudinal strain e changes the difference by at most r|e|.
    pub(crate) excess_compliances: [N; 2],
}

impl<T: Real> ContactConstants<T> {
    /// Creates the constants for sweeps of duration t along an axis with cells of length h; `duration`: t/h, s/m.
    fn new(
        medium: &Medium,
        axis: usize,
        duration: f64,
        (slopes, has_interfaces): (Slopes, bool),
    ) -> Self {
        let closed = medium.pairs[axis].iter().find(|pair| pair.is_longitudinal());
        let mut open = closed.expect("a pair of longitudinal waves").clone();
        let closed_impedance = open.impedance();
        let mut porosity = NO_LIMIT;
        match &medium.contact {
            Some(ContactLaw::Porous { .. }) if medium.is_plastic() => porosity = -NO_LIMIT,
            Some(ContactLaw::Porous { law, skeleton, .. }) => {
                open.modulus = skeleton.lambda + 2.0 * skeleton.mu;
                porosity = law.porosity;
            }
            _ => {}
        }
        let separating = match &medium.contact {
            Some(ContactLaw::Granular { law, .. }) => {
                law.traction_friction().map(|friction| (law, friction))
            }
            _ => None,
        };
        let transverse = medium.pairs[axis].iter().find(|pair| !pair.is_longitudinal());
        let (mut shear_strains, mut friction, mut excess_compliances) =
            ([0.0; 2], NO_LIMIT, [0.0; 2]);
        if let Some((law, traction_friction)) = separating {
            let slope = law.friction / law.intensity_factor;
            let of_strain = 1.0 + (2.0f64 / 3.0).sqrt() * slope;
            let of_shear = 2.0 * duration * slope * 0.5f64.sqrt() / of_strain;
            let impedance = transverse.map_or(1.0, VelocityStressPair::impedance);
            shear_strains = [of_shear, of_shear / impedance];
            friction = traction_friction;
            excess_compliances = [
                1.0 / (3.0 * law.bulk_modulus * of_strain),
                law.friction * law.intensity_factor / (law.energy_modulus * of_strain),
            ];
        }
        Self {
            open: slopes.cell_constants(&open, open.speed() * duration, has_interfaces),
            impedance_ratio: T::from_f64(closed_impedance / open.impedance()),
            porosity: T::from_f64(porosity),
            strain_per_velocity: T::from_f64(2.0 * duration),
            strain_per_stress: T::from_f64(2.0 * duration / open.impedance()),
            shear_strains: shear_strains.map(T::from_f64),
            friction: T::from_f64(friction),
            excess_compliances: excess_compliances.map(T::from_f64),
        }
    }
}

impl<T: Real> ContactConstants<T> {
    /// Creates the constants of all media of a problem, for sweeps of half a step along an axis with cells of one
    /// length.
    pub(crate) fn by_medium<const D: usize>(problem: &Problem<D>, axis: usize) -> Vec<Self> {
        Self::with_spacing(problem, axis, problem.grid.spacing[axis])
    }

    /// Creates the constants of all media for sweeps along the rows of a layer, if cell lengths depend on the layer: by
    /// layer, in the order of `layers` (indices in the whole grid). Porosities have the factor of the fields.
    pub(crate) fn by_layer<const D: usize>(
        problem: &Problem<D>,
        layers: impl Iterator<Item = usize>,
    ) -> Vec<Vec<Self>> {
        let Some(metric) = &problem.metric else { return Vec::new() };
        let constants = |layer: usize| {
            let mut all = Self::with_spacing(problem, 0, metric.spacing[layer]);
            let factor = T::from_f64(problem.field_factor(layer));
            all.iter_mut().for_each(|own| own.porosity = factor * own.porosity);
            all
        };
        layers.map(constants).collect()
    }

    fn with_spacing<const D: usize>(problem: &Problem<D>, axis: usize, spacing: f64) -> Vec<Self> {
        let duration = 0.5 * problem.step / spacing;
        let reconstruction = (problem.scheme.slopes, problem.has_interfaces());
        let constants = |medium| Self::new(medium, axis, duration, reconstruction);
        problem.media.iter().map(constants).collect()
    }

    /// Creates the constants of a group from those of its lanes.
    pub(crate) fn group(lane: impl Fn(usize) -> Self) -> ContactConstants<T::Lanes> {
        let lanes_of = |of: fn(&Self) -> T| T::Lanes::from_lanes(|index| of(&lane(index)));
        ContactConstants {
            open: CellConstants::from_lanes(|index| lane(index).open),
            impedance_ratio: lanes_of(|own| own.impedance_ratio),
            porosity: lanes_of(|own| own.porosity),
            strain_per_velocity: lanes_of(|own| own.strain_per_velocity),
            strain_per_stress: lanes_of(|own| own.strain_per_stress),
            shear_strains: [
                lanes_of(|own| own.shear_strains[0]),
                lanes_of(|own| own.shear_strains[1]),
            ],
            friction: lanes_of(|own| own.friction),
            excess_compliances: [
                lanes_of(|own| own.excess_compliances[0]),
                lanes_of(|own| own.excess_compliances[1]),
            ],
        }
    }

    /// Sets the constants of a lane of a group.
    pub(crate) fn set_lane(lanes: &mut ContactConstants<T::Lanes>, lane: usize, own: &Self) {
        lanes.open.set_lane(lane, &own.open);
        lanes.impedance_ratio.lanes_mut()[lane] = own.impedance_ratio;
        lanes.porosity.lanes_mut()[lane] = own.porosity;
        lanes.strain_per_velocity.lanes_mut()[lane] = own.strain_per_velocity;
        lanes.strain_per_stress.lanes_mut()[lane] = own.strain_per_stress;
        lanes.friction.lanes_mut()[lane] = own.friction;
        for index in 0..2 {
            lanes.shear_strains[index].lanes_mut()[lane] = own.shear_strains[index];
            lanes.excess_compliances[index].lanes_mut()[lane] = own.excess_compliances[index];
        }
    }
}

impl<V: Number> ContactConstants<V> {
    /// Whether the media of all lanes separate at faces.
    pub(crate) fn separates<T: Real>(&self) -> bool
    where
        V: LaneGroup<T>,
    {
        self.friction.lanes().iter().all(|friction| *friction < T::from_f64(NO_LIMIT))
    }

    /// Estimates the greatest strain that the jumps of the longitudinal pair at the face between two cells can cause
    /// during the sweep.
    #[inline(always)]
    pub(crate) fn face_strain(&self, [lower, upper]: [State<V>; 2]) -> V {
        self.strain_per_velocity * magnitude(upper.velocity - lower.velocity)
            + self.strain_per_stress * magnitude(upper.stress - lower.stress)
    }

    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &ContactConstants<T::Lanes>) -> Self
    where
        V: Vector<T>,
    {
        Self {
            open: CellConstants::load(&from.open),
            impedance_ratio: V::load(&from.impedance_ratio),
            porosity: V::load(&from.porosity),
            strain_per_velocity: V::load(&from.strain_per_velocity),
            strain_per_stress: V::load(&from.strain_per_stress),
            shear_strains: [V::load(&from.shear_strains[0]), V::load(&from.shear_strains[1])],
            friction: V::load(&from.friction),
            excess_compliances: [
                V::load(&from.excess_compliances[0]),
                V::load(&from.excess_compliances[1]),
            ],
        }
    }
}

/// Value of the history variables of ghosts beyond a physical boundary: the pores count as collapsed, and a face beside
/// them is not open. Greater than porosities without limit, also with the factor of the fields of a polar block.
pub(crate) const BOUNDARY_HISTORY: f64 = -1e6 * NO_LIMIT;

/// State of the contacts in the two cells beside a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceContacts<N> {
    /// Volumetric strains; `None` without porous media.
    pub(crate) volumetric_strain: Option<[N; 2]>,
    /// Factors of the porosities, which are those of the fields in polar blocks; else 1.
    pub(crate) porosity_factors: [N; 2],
    /// Excess stresses; `None` without media that separate.
    pub(crate) excess: Option<[ExcessInvariants<N>; 2]>,
}

/// Cells around a face: states and constants of all pairs of waves in four cells, and the constants of the contacts.
pub(crate) struct FaceStencil<'a, N, const P: usize> {
    pub(crate) states: [[State<N>; 4]; P],
    pub(crate) cells: [[&'a CellConstants<N>; 4]; P],
    pub(crate) contacts: [&'a ContactConstants<N>; 4],
    /// Index of the longitudinal pair.
    pub(crate) longitudinal: usize,
}

impl<N: Number, const P: usize> FaceStencil<'_, N, P> {
    /// Solves the Riemann problems of all pairs; returns the interface states for the cells below and above the face.
    #[inline(always)]
    pub(crate) fn solve(
        &self,
        beside: &FaceContacts<N>,
        slopes: Slopes,
    ) -> [[InterfaceState<N>; 2]; P] {
        let longitudinal = self.longitudinal;
        let has_open_pores = match beside.volumetric_strain {
            Some(strains) => self.has_open_pores(strains, beside.porosity_factors),
            None => N::ZERO,
        };
        let [first, lower, upper, last] = self.cells[longitudinal];
        let mut present = [*first, *lower, *upper, *last];
        for depth in 0..4 {
            present[depth] =
                select_constants(has_open_pores, &self.contacts[depth].open, &present[depth]);
        }
        let mut cells = self.cells;
        cells[longitudinal] = [&present[0], &present[1], &present[2], &present[3]];
        let (mut continuity, mut is_boundary) = ([N::ONE; 3], N::ZERO);
        if let Some([below, above]) = beside.excess {
            continuity = self.continuity(&cells);
            is_boundary = below.is_outside().max(above.is_outside());
        }
        let unsolved = InterfaceState { difference: N::ZERO, sum: N::ZERO };
        let mut solutions = [[unsolved; 2]; P];
        for pair in 0..P {
            let [_, lower, upper, _] = cells[pair];
            let [right, left] = face_waves(self.states[pair], cells[pair], continuity, slopes);
            // Mirror images have no slope across a boundary.
            let below = RiemannInvariants::from_state(self.states[pair][1], lower);
            let above = RiemannInvariants::from_state(self.states[pair][2], upper);
            let waves = [
                is_boundary.select_gt(N::ZERO, below.right, right),
                is_boundary.select_gt(N::ZERO, above.left, left),
            ];
            solutions[pair] = InterfaceState::riemann([lower.impedance, upper.impedance], waves);
        }
        if let Some(excess) = beside.excess {
            self.separate(&cells, excess, is_boundary, &mut solutions);
        }
        for side in 0..2 {
            // Scaled by the impedance of closed contacts, as the update of the cell requires.
            let ratio = self.contacts[1 + side].impedance_ratio;
            let ratio = has_open_pores.select_gt(N::ZERO, ratio, N::ONE);
            let state = &mut solutions[longitudinal][side];
            state.difference = ratio * state.difference;
        }
        solutions
    }

    /// Estimates the greatest longitudinal strain that the sweep can cause in each of the two cells beside the face.
    #[inline(always)]
    fn greatest_strains(&self) -> [N; 2] {
        let states = &self.states[self.longitudinal];
        let mut strains = [N::ZERO; 2];
        for side in 0..2 {
            for face in 0..3 {
                let states = [states[face], states[face + 1]];
                strains[side] = strains[side] + self.contacts[1 + side].face_strain(states);
            }
        }
        strains
    }

    /// Returns 1 where the pores of both cells stay open during the sweep, else 0.
    #[inline(always)]
    fn has_open_pores(&self, volumetric_strain: [N; 2], porosity_factors: [N; 2]) -> N {
        let greatest_strains = self.greatest_strains();
        let mut is_open = N::ONE;
        for side in 0..2 {
            let porosity = porosity_factors[side] * self.contacts[1 + side].porosity;
            let pores = porosity + volumetric_strain[side];
            is_open = pores.select_gt(greatest_strains[side], is_open, N::ZERO);
        }
        is_open
    }

    /// Returns for the three faces of the stencil 0 where the cells separate, else 1; see [`continuity`].
    #[inline(always)]
    fn continuity(&self, cells: &[[&CellConstants<N>; 4]; P]) -> [N; 3] {
        let mut result = [N::ONE; 3];
        for face in 0..3 {
            let [below, above] = [self.contacts[face].friction, self.contacts[face + 1].friction];
            let mut tractions = [N::ZERO; P];
            let mut stresses = [N::ZERO; 2];
            for pair in 0..P {
                let [lower, upper] = [cells[pair][face], cells[pair][face + 1]];
                let states = [self.states[pair][face], self.states[pair][face + 1]];
                let waves = [
                    RiemannInvariants::from_state(states[0], lower).right,
                    RiemannInvariants::from_state(states[1], upper).left,
                ];
                let impedances = [lower.impedance, upper.impedance];
                tractions[pair] = InterfaceState::riemann(impedances, waves)[0].sum;
                for side in 0..2 {
                    stresses[side] = stresses[side] + magnitude(states[side].stress);
                }
            }
            // The stress of a medium that does not separate does not matter.
            let no_limit = N::from_f64(NO_LIMIT);
            let stress = no_limit.select_gt(below, stresses[0], N::ZERO)
                + no_limit.select_gt(above, stresses[1], N::ZERO);
            result[face] = continuity(below.min(above), tractions, self.longitudinal, stress);
        }
        result
    }

    /// Cuts the tractions of a face to the cone of those that media which separate admit, and divides the gap between
    /// the velocities of both sides; see [`separation`].
    #[inline(always)]
    fn separate(
        &self,
        cells: &[[&CellConstants<N>; 4]; P],
        excess: [ExcessInvariants<N>; 2],
        is_boundary: N,
        solutions: &mut [[InterfaceState<N>; 2]; P],
    ) {
        let [below, above] = [self.contacts[1].friction, self.contacts[2].friction];
        let friction = below.min(above);
        let separates = N::from_f64(NO_LIMIT).select_gt(friction, N::ONE - is_boundary, N::ZERO);
        // Share of the gap that the lower cell takes as strain.
        let share = above.select_gt(below, N::ONE, below.select_gt(above, N::ZERO, N::HALF));
        let mut tractions = [N::ZERO; P];
        let mut admittances = [N::ZERO; P];
        for pair in 0..P {
            let [_, lower, upper, _] = cells[pair];
            tractions[pair] = solutions[pair][0].sum;
            admittances[pair] = N::ONE / lower.impedance + N::ONE / upper.impedance;
        }
        let longitudinal = self.longitudinal;
        let transverse = if longitudinal == 0 { P - 1 } else { 0 };
        let cone = TractionCone::new(friction, admittances[transverse] / admittances[longitudinal]);
        let tangential = tangential_magnitude(tractions, longitudinal);
        let (normal, factor) = cone.project(tractions[longitudinal], tangential);
        let stays_open = self.stays_open(excess);
        for pair in 0..P {
            let [_, lower, upper, _] = cells[pair];
            let closed = tractions[pair];
            let admitted = if pair == longitudinal { normal } else { factor * closed };
            let admitted = stays_open.select_gt(N::ZERO, N::ZERO, admitted);
            let admitted = separates.select_gt(N::ZERO, admitted, closed);
            // The velocity of the closed face divides the gap in the ratio of the impedances. In one medium it is kept, bit
            // for bit.
            let excess_share = upper.impedance / (lower.impedance + upper.impedance) - share;
            let is_shifted = separates * magnitude(excess_share);
            let shift = excess_share * (admittances[pair] * (closed - admitted));
            let impedances = [lower.impedance, upper.impedance];
            for side in 0..2 {
                let state = &mut solutions[pair][side];
                let shifted = state.difference - impedances[side] * shift;
                state.difference = is_shifted.select_gt(N::ZERO, shifted, state.difference);
                state.sum = admitted;
            }
        }
    }

    /// Returns 1 where the contacts of separating media beside the face are open and stay so during the sweep, else 0.
    #[inline(always)]
    fn stays_open(&self, excess: [ExcessInvariants<N>; 2]) -> N {
        let mut stays_open = N::ONE;
        for side in 0..2 {
            let contact = self.contacts[1 + side];
            let (mut strain, mut stress) = (N::ZERO, N::ZERO);
            for face in 0..3 {
                strain = strain
                    + separation::face_strain(contact, self.jump_states(face), self.longitudinal);
            }
            for pair in 0..P {
                stress = stress + magnitude(self.states[pair][1 + side].stress);
            }
            let own = separation::stays_open(excess[side].opening(contact), strain, stress);
            let separates = N::from_f64(NO_LIMIT).select_gt(contact.friction, own, N::ONE);
            stays_open = stays_open * separates;
        }
        stays_open
    }

    /// Returns the states of all pairs in the two cells beside a face of the stencil.
    #[inline(always)]
    fn jump_states(&self, face: usize) -> [[State<N>; 2]; P] {
        let mut states = [[self.states[0][0]; 2]; P];
        for pair in 0..P {
            states[pair] = [self.states[pair][face], self.states[pair][face + 1]];
        }
        states
    }
}

/// Computes the time-averaged waves at a face from the four cells around it.
#[inline(always)]
fn face_waves<N: Number>(
    states: [State<N>; 4],
    cells: [&CellConstants<N>; 4],
    continuity: [N; 3],
    slopes: Slopes,
) -> [N; 2] {
    let [first, lower, upper, _] = cells;
    let carried = slopes.carried_invariants(
        [states[0], states[1], states[2]],
        [first, lower, upper],
        [continuity[0], continuity[1]],
    );
    let around = [states[1], states[2], states[3]];
    slopes.face_values_in_mixed_media(carried, around, cells, Some(continuity)).0
}

/// Returns the constants `one` where `condition` is positive, else `other`.
#[inline(always)]
fn select_constants<N: Number>(
    condition: N,
    one: &CellConstants<N>,
    other: &CellConstants<N>,
) -> CellConstants<N> {
    let zero = N::ZERO;
    CellConstants {
        impedance: condition.select_gt(zero, one.impedance, other.impedance),
        half_courant: condition.select_gt(zero, one.half_courant, other.half_courant),
        velocity_factor: condition.select_gt(zero, one.velocity_factor, other.velocity_factor),
        mean_slope_weight: condition.select_gt(
            zero,
            one.mean_slope_weight,
            other.mean_slope_weight,
        ),
        upwind_bound: condition.select_gt(zero, one.upwind_bound, other.upwind_bound),
        upwind_weight: condition.select_gt(zero, one.upwind_weight, other.upwind_weight),
        central_weight: condition.select_gt(zero, one.central_weight, other.central_weight),
        downwind_weight: condition.select_gt(zero, one.downwind_weight, other.downwind_weight),
    }
}

#[inline(always)]
pub(crate) fn magnitude<N: Number>(value: N) -> N {
    value.max(-value)
}

/// Faces of a porous medium along a line: what one face leaves to the next. The results are those of [`FaceStencil`] for
/// cells of one medium.
#[derive(Clone, Copy)]
pub(crate) struct OpenPoresStencil<V> {
    /// Estimates of the strain that the jumps at the next face and at the face below it can cause, from the lower one.
    strains: [V; 2],
    /// Volume of the open pores of the group below the next face.
    opening: V,
}

impl<V: Number> OpenPoresStencil<V> {
    /// Creates the stencil of the face between the last two of three groups; `opening`: volume of the open pores of the
    /// second one.
    #[inline(always)]
    pub(crate) fn new(
        [first, lower, upper]: [State<V>; 3],
        opening: V,
        constants: &ContactConstants<V>,
    ) -> Self {
        let strains =
            [constants.face_strain([first, lower]), constants.face_strain([lower, upper])];
        Self { strains, opening }
    }

    /// Solves the Riemann problem at the middle of the three faces between four groups, and advances to the next face;
    /// `opening`: volume of the open pores of the third group.
    #[inline(always)]
    pub(crate) fn solve<T: Real>(
        &mut self,
        states: [State<V>; 4],
        opening: V,
        cell: &CellConstants<V>,
        constants: &ContactConstants<V>,
    ) -> InterfaceState<V>
    where
        V: Vector<T>,
    {
        let strain = constants.face_strain([states[2], states[3]]);
        let greatest_strain = self.strains[0] + self.strains[1] + strain;
        let lanes =
            self.opening.greater_lanes(greatest_strain) & opening.greater_lanes(greatest_strain);
        let open = &constants.open;
        let cell = CellConstants {
            impedance: cell.impedance.blend_lanes(lanes, open.impedance),
            mean_slope_weight: cell.mean_slope_weight.blend_lanes(lanes, open.mean_slope_weight),
            upwind_bound: cell.upwind_bound.blend_lanes(lanes, open.upwind_bound),
            ..*cell
        };
        let stencil = InterlayerStencil { continuity: [V::ONE; 3], weights: [[V::ZERO; 4]; 2] };
        let waves =
            Slopes::Limited.incident_waves_beside_interlayers(None, states, &cell, &stencil);
        let mut face = InterfaceState::riemann_equal_impedance(waves);
        // Scaled by the impedance of closed contacts, as the update of the cell requires.
        face.difference = V::ONE.blend_lanes(lanes, constants.impedance_ratio) * face.difference;
        *self = Self { strains: [self.strains[1], strain], opening };
        face
    }
}
