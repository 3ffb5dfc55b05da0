//! Faces between cells of media with contacts. The Riemann problem has the impedance of closed contacts, the stiffest,
//! except at two kinds of faces.
//!
//! - Open pores: if the pores of both cells stay open during the sweep, the face has the impedances of open pores. The
//!   strain that a sweep of duration t can cause in a cell of length h is estimated as 2(t/h)·Σ(|Δv| + |Δs|/z), summed
//!   over the three faces between the four cells of the stencil, with the velocities v and stresses s of the longitudinal
//!   pair and the impedance z of open pores. A smaller impedance where pores may collapse would feed energy
//!   into the stiffer state. A plastic skeleton excludes such faces: with them, the limited reconstruction keeps a
//!   compaction shock behind an elastic precursor that is too weak, against the entropy condition, on any grid.
//! - Open faces of granular media: where the contacts of both cells stay open during the sweep, by the same estimate, or
//!   where the normal stress of the face would be tensile, the face has no traction, and each side has its own velocity
//!   v ∓ s/z. Between two granular cells both take half of the rate at which the face opens as strain; beside a solid the
//!   granular cell takes all of it. Media whose friction cone transmits tension have no such faces.
//!
//! Faces of physical boundaries always have the impedance of closed contacts and transmit tension.

#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::cell::CellConstants;
use super::contact_law::ContactLaw;
use super::medium::Medium;
use super::problem::Problem;
use super::reconstruction::{InterlayerStencil, Slopes};
use super::riemann::{InterfaceState, State};
use crate::simd::{LaneGroup, Number, Real, Vector};
use models::uniaxial::NO_LIMIT;

/// Constants of a medium at faces normal to an axis, for the longitudinal pair of waves.
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
    /// 1 in granular media without tension, else 0.
    pub(crate) is_granular: N,
    /// Volumetric strain of open contacts per sum of the normal components of the excess stress, 1/(3k), 1/Pa; 0 in other
    /// media.
    pub(crate) excess_compliance: N,
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
        let granular = match &medium.contact {
            Some(ContactLaw::Granular { law, .. }) if !law.transmits_tension() => Some(law),
            _ => None,
        };
        Self {
            open: slopes.cell_constants(&open, open.speed() * duration, has_interfaces),
            impedance_ratio: T::from_f64(closed_impedance / open.impedance()),
            porosity: T::from_f64(porosity),
            strain_per_velocity: T::from_f64(2.0 * duration),
            strain_per_stress: T::from_f64(2.0 * duration / open.impedance()),
            is_granular: T::from_f64(f64::from(u8::from(granular.is_some()))),
            excess_compliance: T::from_f64(
                granular.map_or(0.0, |law| 1.0 / (3.0 * law.bulk_modulus)),
            ),
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

    /// Sets the constants of a lane of a group.
    pub(crate) fn set_lane(lanes: &mut ContactConstants<T::Lanes>, lane: usize, own: &Self) {
        lanes.open.set_lane(lane, &own.open);
        lanes.impedance_ratio.lanes_mut()[lane] = own.impedance_ratio;
        lanes.porosity.lanes_mut()[lane] = own.porosity;
        lanes.strain_per_velocity.lanes_mut()[lane] = own.strain_per_velocity;
        lanes.strain_per_stress.lanes_mut()[lane] = own.strain_per_stress;
        lanes.is_granular.lanes_mut()[lane] = own.is_granular;
        lanes.excess_compliance.lanes_mut()[lane] = own.excess_compliance;
    }
}

impl<V: Number> ContactConstants<V> {
    /// Estimates the greatest strain that the jumps at the face between two cells can cause during the sweep.
    #[inline(always)]
    fn face_strain(&self, [lower, upper]: [State<V>; 2]) -> V {
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
            is_granular: V::load(&from.is_granular),
            excess_compliance: V::load(&from.excess_compliance),
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
    /// Sum of the normal components of the excess stress, Pa; `None` without granular media.
    pub(crate) excess: Option<[N; 2]>,
}

/// Cells around a face: states and constants of a wave pair in four cells, and the constants of the contacts.
pub(crate) struct FaceStencil<'a, N> {
    pub(crate) states: [State<N>; 4],
    pub(crate) cells: [&'a CellConstants<N>; 4],
    pub(crate) contacts: [&'a ContactConstants<N>; 4],
}

/// Interface states of a pair of waves for both cells, and 1 where the face has no traction, else 0; `None` without
/// granular media.
pub(crate) type OpenFace<N> = ([InterfaceState<N>; 2], Option<N>);

impl<N: Number> FaceStencil<'_, N> {
    /// Solves the Riemann problem of the longitudinal pair.
    #[inline(always)]
    pub(crate) fn solve_longitudinal(
        &self,
        beside: &FaceContacts<N>,
        slopes: Slopes,
    ) -> OpenFace<N> {
        let has_open_pores = match beside.volumetric_strain {
            Some(strains) => self.has_open_pores(strains, beside.porosity_factors),
            None => N::ZERO,
        };
        let mut cells = [*self.cells[0], *self.cells[1], *self.cells[2], *self.cells[3]];
        for depth in 0..4 {
            cells[depth] =
                select_constants(has_open_pores, &self.contacts[depth].open, self.cells[depth]);
        }
        let waves = face_waves(self.states, [&cells[0], &cells[1], &cells[2], &cells[3]], slopes);
        let mut solution = InterfaceState::riemann([cells[1].impedance, cells[2].impedance], waves);
        for side in 0..2 {
            // Scaled by the impedance of closed contacts, as the update of the cell requires.
            let ratio = self.contacts[1 + side].impedance_ratio;
            let ratio = has_open_pores.select_gt(N::ZERO, ratio, N::ONE);
            solution[side].difference = ratio * solution[side].difference;
        }
        let Some(excess) = beside.excess else { return (solution, None) };
        let is_open = self.is_open(excess, solution[0].sum);
        (self.open_face(waves, solution, is_open), Some(is_open))
    }

    /// Solves the Riemann problem of a transverse pair at a face that is open where `is_open` is 1; `None` without
    /// granular media.
    #[inline(always)]
    pub(crate) fn solve_transverse(
        &self,
        is_open: Option<N>,
        slopes: Slopes,
    ) -> [InterfaceState<N>; 2] {
        let waves = face_waves(self.states, self.cells, slopes);
        let impedances = [self.cells[1].impedance, self.cells[2].impedance];
        let solution = InterfaceState::riemann(impedances, waves);
        match is_open {
            Some(is_open) => self.open_face(waves, solution, is_open),
            None => solution,
        }
    }

    /// Estimates the greatest strain that the sweep can cause in each of the two cells beside the face.
    #[inline(always)]
    fn greatest_strains(&self) -> [N; 2] {
        let mut strains = [N::ZERO; 2];
        for side in 0..2 {
            for face in 0..3 {
                let states = [self.states[face], self.states[face + 1]];
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

    /// Returns 1 where a granular medium has no traction at the face, else 0; `normal_stress`: a positive multiple of the
    /// normal stress that the closed face would have.
    #[inline(always)]
    fn is_open(&self, excess: [N; 2], normal_stress: N) -> N {
        let [lower, upper] = [self.contacts[1].is_granular, self.contacts[2].is_granular];
        let boundary = N::from_f64(0.5 * BOUNDARY_HISTORY);
        let greatest_strains = self.greatest_strains();
        let (mut stay_open, mut is_inner) = (N::ONE, lower.max(upper));
        for side in 0..2 {
            let contact = self.contacts[1 + side];
            // Open contacts have an excess and no stress.
            let stress = magnitude(self.states[1 + side].stress);
            let opening = excess[side] * contact.excess_compliance;
            let stays_open = opening.select_gt(
                greatest_strains[side],
                stress.select_gt(N::ZERO, N::ZERO, N::ONE),
                N::ZERO,
            );
            stay_open = stay_open * contact.is_granular.select_gt(N::ZERO, stays_open, N::ONE);
            is_inner = boundary.select_gt(excess[side], N::ZERO, is_inner);
        }
        is_inner * normal_stress.select_gt(N::ZERO, N::ONE, stay_open)
    }

    /// Replaces the solution of the Riemann problem where the face is open.
    #[inline(always)]
    fn open_face(
        &self,
        [left, right]: [N; 2],
        solution: [InterfaceState<N>; 2],
        is_open: N,
    ) -> [InterfaceState<N>; 2] {
        let [lower, upper] = [self.cells[1].impedance, self.cells[2].impedance];
        let [granular_below, granular_above] =
            [self.contacts[1].is_granular, self.contacts[2].is_granular];
        // Twice the shares of the opening that the cells take as strain: 2 and 0, both 1, or 0 and 2. In one medium the
        // velocity is that of the closed face, bit for bit.
        let above_weight = granular_below * (N::ONE + N::ONE - granular_above);
        let below_weight = N::ONE + N::ONE - above_weight;
        // Velocities of both sides, −left/lower and right/upper, times the impedance of each cell.
        let ratios = [lower / upper, upper / lower];
        let scaled = [[-left, ratios[0] * right], [-(ratios[1] * left), right]];
        let mut result = solution;
        for side in 0..2 {
            let [below, above] = scaled[side];
            let velocity = below_weight * below + above_weight * above;
            let state = &mut result[side];
            state.difference = is_open.select_gt(N::ZERO, velocity, state.difference);
            state.sum = is_open.select_gt(N::ZERO, N::ZERO, state.sum);
        }
        result
    }
}

/// Computes the time-averaged waves at a face from the four cells around it.
#[inline(always)]
fn face_waves<N: Number>(
    states: [State<N>; 4],
    cells: [&CellConstants<N>; 4],
    slopes: Slopes,
) -> [N; 2] {
    let [first, lower, upper, _] = cells;
    let carried = slopes.carried_invariants(
        [states[0], states[1], states[2]],
        [first, lower, upper],
        [N::ONE; 2],
    );
    slopes.face_values_in_mixed_media(carried, [states[1], states[2], states[3]], cells, None).0
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
fn magnitude<N: Number>(value: N) -> N {
    value.max(-value)
}

/// Faces of a granular medium along a line: what one face leaves to the next. The results are those of [`FaceStencil`]
/// for cells of one medium.
#[derive(Clone, Copy)]
pub(crate) struct SeparationStencil<V> {
    /// Estimates of the strain that the jumps at the next face and at the face below it can cause, from the lower one.
    strains: [V; 2],
    below: ContactState<V>,
}

/// Contacts of a group of cells.
#[derive(Clone, Copy)]
struct ContactState<V> {
    /// Volumetric strain by which the contacts are open.
    opening: V,
    /// Mask of the lanes that are under stress or beyond a physical boundary.
    stressed: u16,
    outside: u16,
}

impl<V: Number> ContactState<V> {
    #[inline(always)]
    fn new<T: Real>(state: State<V>, excess: V, constants: &ContactConstants<V>) -> Self
    where
        V: Vector<T>,
    {
        let boundary = <V as Number>::from_f64(0.5 * BOUNDARY_HISTORY);
        Self {
            opening: excess * constants.excess_compliance,
            stressed: magnitude(state.stress).greater_lanes(V::ZERO),
            outside: boundary.greater_lanes(excess),
        }
    }
}

impl<V: Number> SeparationStencil<V> {
    /// Creates the stencil of the face between two groups; `excess`: that of the lower one, `first_strain`: what
    /// [`Self::lower_strain`] has returned.
    #[inline(always)]
    pub(crate) fn new<T: Real>(
        states: [State<V>; 2],
        first_strain: V,
        excess: V,
        constants: &ContactConstants<V>,
    ) -> Self
    where
        V: Vector<T>,
    {
        Self {
            strains: [first_strain, constants.face_strain(states)],
            below: ContactState::new(states[0], excess, constants),
        }
    }

    /// Returns the estimate for the face below the next one.
    #[inline(always)]
    pub(crate) fn lower_strain(&self) -> V {
        self.strains[0]
    }

    /// Returns the mask of the lanes without traction at the face below the first of two groups, and advances to the
    /// next face. `excess`: that of the first group; `normal_stress`: a positive multiple of the normal stress that the
    /// closed face would have.
    #[inline(always)]
    pub(crate) fn find_open_lanes<T: Real>(
        &mut self,
        states: [State<V>; 2],
        excess: V,
        normal_stress: V,
        constants: &ContactConstants<V>,
    ) -> u16
    where
        V: Vector<T>,
    {
        let above = ContactState::new(states[0], excess, constants);
        let strain = constants.face_strain(states);
        let greatest_strain = self.strains[0] + self.strains[1] + strain;
        let stay_open = self.below.opening.greater_lanes(greatest_strain)
            & above.opening.greater_lanes(greatest_strain)
            & !(self.below.stressed | above.stressed);
        let is_tensile = normal_stress.greater_lanes(V::ZERO);
        let is_granular = constants.is_granular.greater_lanes(V::ZERO);
        let outside = self.below.outside | above.outside;
        *self = Self { strains: [self.strains[1], strain], below: above };
        (stay_open | is_tensile) & is_granular & !outside
    }
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
