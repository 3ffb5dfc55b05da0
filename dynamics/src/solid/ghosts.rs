//! Boundary conditions as ghost cells.
//!
//! Across a symmetry plane, mirror images as ghost values are exact. At a free (fixed) boundary the normal derivative
//! of the velocity (stress) is not zero: the mirror image has a kink at the boundary, which limiters take for an
//! extremum, and the face state has a first-order error. Ghost values are therefore chosen such that the unmodified
//! sweep computes more accurate face states from them: [`compute_limited_ghosts`] and [`compute_fourth_order_ghosts`].

mod coefficients;

use crate::simd::{LaneGroup, Number, Real};
use crate::solid::boundary::{Boundary, Condition, Load, Signal};
use crate::solid::cell::CellConstants;
use crate::solid::reconstruction::{GHOSTS, Slopes};
use crate::solid::riemann::{RiemannInvariants, State};
pub(crate) use coefficients::GhostCoefficients;
#[cfg(doc)]
use coefficients::{OPEN_FACE_COEFFICIENTS, REFLECTING_FLUX_COEFFICIENTS};

/// Boundary at an end of an axis, in the form that the sweeps use.
#[derive(Clone)]
pub(crate) enum BoundaryFaces<T: Real> {
    Periodic,
    /// Outer end of a halo: ghost values are arbitrary.
    HaloEnd,
    /// Physical boundary with ghost values ±v + a, ±s + b; signs and shifts are zero at non-reflecting faces.
    Physical(GhostRule<T>),
}

impl<T: Real> BoundaryFaces<T> {
    /// Returns the reconstruction beside the boundary; [`Slopes::Godunov`] means that ghost values are mirror images.
    #[inline(always)]
    pub(crate) fn closure(&self) -> BoundaryClosure {
        match self {
            Self::Physical(ghost_rule) if ghost_rule.is_one_sided => ghost_rule.closure,
            _ => BoundaryClosure { slopes: Slopes::Godunov, has_open_faces: false },
        }
    }

    /// Returns the ghost rule of a physical boundary.
    pub(crate) fn ghost_rule(&self) -> Option<&GhostRule<T>> {
        match self {
            Self::Physical(ghost_rule) => Some(ghost_rule),
            Self::Periodic | Self::HaloEnd => None,
        }
    }
}

/// Evaluates the loads on both boundaries of an axis at these times, s: those on longitudinal waves, and the others.
pub(crate) fn set_times<T: Real>(boundaries: &mut [BoundaryFaces<T>; 2], times: [f64; 2]) {
    for boundary in boundaries {
        if let BoundaryFaces::Physical(ghost_rule) = boundary {
            ghost_rule.set_times(times);
        }
    }
}

/// Storage position of a face: group index and lane.
pub(crate) type LaneIndex = (usize, usize);

/// Ghost rule of a boundary: signs and shifts of its mirror images by wave pair and face, and the loads that change the
/// shifts.
#[derive(Clone)]
pub(crate) struct GhostRule<T: Real> {
    /// By wave pair and face group: sign of v, shift of v, sign of s, shift of s, weight. Weight 1: one-sided
    /// reconstruction of the wave that arrives at the boundary, weight 0: mirror image.
    rules: Vec<[T::Lanes; 5]>,
    /// Number of face groups per pair; 1 if all faces have the same rule.
    groups_per_pair: usize,
    /// Whether all faces have the same rule (the usual case).
    pub(crate) is_uniform: bool,
    loads: Vec<BoundaryLoad>,
    /// Whether any face has a one-sided reconstruction.
    pub(crate) is_one_sided: bool,
    closure: BoundaryClosure,
    /// Whether boundary work can be non-zero.
    pub(crate) can_do_work: bool,
}

/// Reconstruction beside a boundary.
#[derive(Clone, Copy)]
pub(crate) struct BoundaryClosure {
    pub(crate) slopes: Slopes,
    /// Whether any face is non-reflecting.
    pub(crate) has_open_faces: bool,
}

#[derive(Clone)]
struct BoundaryLoad {
    /// Index of an element of `rules` and lane, index of the shift (1 or 3), and twice the amplitude.
    entries: Vec<(LaneIndex, usize, f64)>,
    /// Shifts of these entries without the load.
    unloaded_shifts: Vec<f64>,
    signal: Signal,
    is_longitudinal: bool,
}

impl<T: Real> GhostRule<T> {
    /// Creates the ghost rule of `boundary` for the faces of a region. `faces`: index of each face in the boundary,
    /// ascending, and its storage position; `groups`: number of face groups. A uniform boundary stores one entry, since
    /// the rule is read at both ends of every row.
    pub(crate) fn new(
        boundary: &Boundary,
        pairs: usize,
        (faces, groups): (&[(usize, LaneIndex)], usize),
        is_loaded: bool,
        slopes: Slopes,
    ) -> Self {
        // Without slopes, mirror images give the same face states.
        let one_sided = if slopes == Slopes::Godunov { 0.0 } else { 1.0 };
        // A subdomain holds only some of the faces of a boundary with conditions by face: its closure must not depend
        // on which faces these are.
        let is_by_face = matches!(boundary, Boundary::ByFace(_));
        let entry = |condition| match condition {
            Some(Condition::Velocity(given)) => [-1.0, 2.0 * given, 1.0, 0.0, one_sided],
            Some(Condition::Traction(given)) => [1.0, 0.0, -1.0, 2.0 * given, one_sided],
            Some(Condition::NonReflecting) => [0.0, 0.0, 0.0, 0.0, one_sided],
            Some(Condition::OddVelocity) => [-1.0, 0.0, 1.0, 0.0, 0.0],
            Some(Condition::OddStress) => [1.0, 0.0, -1.0, 0.0, 0.0],
            None => [0.0; 5],
        };
        // Rules with non-zero shifts are stored by face, since they would alter padding lanes.
        let uniform_entries = |pair: usize| {
            let mut face_entries =
                faces.iter().map(|(face, _)| entry(boundary.condition(pair, *face)));
            let first = face_entries.next()?;
            let is_homogeneous = first[1] == 0.0 && first[3] == 0.0;
            (is_homogeneous && face_entries.all(|own| own == first)).then_some(first)
        };
        let uniform_entries =
            (0..pairs).map(uniform_entries).collect::<Option<Vec<_>>>().filter(|_| !is_loaded);
        if let Some(entries) = uniform_entries {
            let can_do_work = entries.iter().any(|own| own[0] == 0.0);
            let is_one_sided =
                entries.iter().any(|own| own[4] != 0.0) || (is_by_face && one_sided != 0.0);
            let closure = BoundaryClosure { slopes, has_open_faces: can_do_work || is_by_face };
            let lanes = |own: [f64; 5]| own.map(|value| T::Lanes::splat(T::from_f64(value)));
            let rules = entries.into_iter().map(lanes).collect();
            return Self {
                rules,
                groups_per_pair: 1,
                is_uniform: true,
                loads: Vec::new(),
                is_one_sided,
                closure,
                can_do_work,
            };
        }
        let mut rules = vec![[T::Lanes::ZERO; 5]; pairs * groups];
        let (mut can_do_work, mut is_one_sided, mut has_open_faces) =
            (false, is_by_face && one_sided != 0.0, is_by_face);
        for pair in 0..pairs {
            for &(face, (group, lane)) in faces {
                let entry = entry(boundary.condition(pair, face));
                can_do_work |= entry[0] == 0.0 || entry[1] != 0.0 || entry[3] != 0.0;
                is_one_sided |= entry[4] != 0.0;
                has_open_faces |= entry[0] == 0.0;
                for (lanes, value) in rules[pair * groups + group].iter_mut().zip(entry) {
                    lanes.lanes_mut()[lane] = T::from_f64(value);
                }
            }
        }
        let closure = BoundaryClosure { slopes, has_open_faces };
        Self {
            rules,
            groups_per_pair: groups,
            is_uniform: false,
            loads: Vec::new(),
            is_one_sided,
            closure,
            can_do_work,
        }
    }

    /// Adds a load, on longitudinal or other waves; it has no effect on non-reflecting faces.
    pub(crate) fn add_load(
        &mut self,
        load: &Load,
        is_longitudinal: bool,
        faces: &[(usize, LaneIndex)],
    ) {
        let (mut entries, mut unloaded_shifts) = (Vec::new(), Vec::new());
        for &(face, amplitude) in &load.faces {
            let from = faces.partition_point(|own| own.0 < face);
            for &(_, (group, lane)) in faces[from..].iter().take_while(|own| own.0 == face) {
                let rule_index = load.pair * self.groups_per_pair + group;
                let sign = self.rules[rule_index][0].lanes()[lane].to_f64();
                if sign != 0.0 {
                    let shift_index = if sign < 0.0 { 1 } else { 3 };
                    entries.push(((rule_index, lane), shift_index, 2.0 * amplitude));
                    unloaded_shifts
                        .push(self.rules[rule_index][shift_index].lanes()[lane].to_f64());
                }
            }
        }
        if !entries.is_empty() {
            let signal = load.signal.clone();
            self.loads.push(BoundaryLoad { entries, unloaded_shifts, signal, is_longitudinal });
            self.can_do_work = true;
        }
    }

    /// Evaluates the shifts at these times, s: those of longitudinal waves, and the others.
    pub(crate) fn set_times(&mut self, [longitudinal, other]: [f64; 2]) {
        for load in &self.loads {
            for (&((rule_index, lane), shift_index, _), &unloaded_shift) in
                load.entries.iter().zip(&load.unloaded_shifts)
            {
                self.rules[rule_index][shift_index].lanes_mut()[lane] = T::from_f64(unloaded_shift);
            }
        }
        for load in &self.loads {
            let value = (load.signal)(if load.is_longitudinal { longitudinal } else { other });
            for &((rule_index, lane), shift_index, amplitude) in &load.entries {
                let shift = &mut self.rules[rule_index][shift_index].lanes_mut()[lane];
                *shift = *shift + T::from_f64(amplitude * value);
            }
        }
    }

    /// Returns whether a face can do work now: it is non-reflecting, or its given velocity or traction is non-zero.
    pub(crate) fn can_do_work_at(&self, pair: usize, slot: LaneIndex) -> bool {
        let [sign, velocity, _, stress, _] = self.face_coefficients(pair, slot);
        self.can_do_work && (sign == T::ZERO || velocity != T::ZERO || stress != T::ZERO)
    }

    pub(crate) fn closure(&self) -> BoundaryClosure {
        self.closure
    }

    /// Returns the rule of a group of faces: sign of v, shift of v, sign of s, shift of s, weight.
    #[inline(always)]
    pub(crate) fn group_coefficients(&self, pair: usize, group: usize) -> &[T::Lanes; 5] {
        &self.rules[pair * self.groups_per_pair + group.min(self.groups_per_pair - 1)]
    }

    /// Returns the rule of one face: sign of v, shift of v, sign of s, shift of s, weight.
    pub(crate) fn face_coefficients(&self, pair: usize, (group, lane): LaneIndex) -> [T; 5] {
        self.group_coefficients(pair, group).map(|lanes| lanes.lanes()[lane])
    }
}

/// Computes the mirror image sign · value + shift.
#[inline(always)]
pub(crate) fn image<N: Number>([sign, shift]: [N; 2], own: N) -> N {
    sign * own + shift
}

/// Number of cells next to a boundary that determine its ghost values.
pub(crate) const CLOSURE_CELLS: usize = 3;

/// Computes the ghost states beyond an end of a line (0: lower, 1: upper), nearest first. `outer_states`, `cells`:
/// states and constants of the outermost cells, outermost first; `ghost_rule`: result of
/// [`GhostRule::face_coefficients`]; `coefficients`: those of the outermost cell.
#[inline(always)]
pub(crate) fn compute_ghosts<N: Number>(
    closure: BoundaryClosure,
    outer_states: [State<N>; CLOSURE_CELLS],
    ghost_rule: [N; 5],
    end: usize,
    cells: [&CellConstants<N>; CLOSURE_CELLS],
    coefficients: &GhostCoefficients<N>,
) -> [State<N>; GHOSTS] {
    let [sign_v, shift_v, sign_s, shift_s, _] = ghost_rule;
    let image_of = |own: State<N>| State {
        velocity: image([sign_v, shift_v], own.velocity),
        stress: image([sign_s, shift_s], own.stress),
    };
    let images = [image_of(outer_states[0]), image_of(outer_states[1])];
    match closure.slopes {
        Slopes::Godunov | Slopes::Wide(_) => images,
        Slopes::Limited => compute_limited_ghosts(
            [outer_states[0], outer_states[1]],
            images,
            ghost_rule,
            end,
            [cells[0], cells[1]],
        ),
        Slopes::FourthOrder => compute_fourth_order_ghosts(
            closure.has_open_faces,
            (outer_states, images),
            ghost_rule,
            end,
            cells,
            coefficients,
        ),
    }
}

/// Returns two characteristic variables: the one that arrives at the boundary and the one that leaves it.
#[inline(always)]
fn split_characteristics<N: Number>(
    end: usize,
    state: State<N>,
    cell: &CellConstants<N>,
) -> [N; 2] {
    let RiemannInvariants { right, left } = RiemannInvariants::from_state(state, cell);
    if end == 0 { [left, right] } else { [right, left] }
}

#[inline(always)]
/// Computes the scalar product of two vectors of three components.
fn dot<N: Number>([a, b, c]: [N; 3], [one, two, three]: [N; 3]) -> N {
    a * one + b * two + c * three
}

/// Ghost values for [`Slopes::FourthOrder`]: a linear, energy-stable closure.
///
/// At a reflecting boundary the unfolded wave is W = (O₁, O₀ | I₀′, I₁′): the arriving wave O in the two outermost
/// cells (index 0: outermost) and its images I′. Images alone conserve energy, but ∂W has a kink at the boundary, which
/// causes a first-order error. No closure that is exact for linear waves conserves energy: slopes a inside and b
/// outside change it by C(1 − C²)/12 (a² − b²). [`REFLECTING_FLUX_COEFFICIENTS`], a mean of fits to pulses and to the
/// kink, correct the flux at the boundary and both fluxes at the next face; the sweep remains a contraction (test
/// `no_line_gains_energy`). At a non-reflecting boundary the incoming wave is zero and the arriving wave is
/// reconstructed one-sidedly: [`OPEN_FACE_COEFFICIENTS`]. If the three outermost cells are not of one medium, images
/// are used, and non-reflecting faces take the arriving wave of the outermost cell.
#[inline(always)]
fn compute_fourth_order_ghosts<N: Number>(
    has_open_faces: bool,
    (outer_states, images): ([State<N>; CLOSURE_CELLS], [State<N>; GHOSTS]),
    [sign_v, _, sign_s, _, one_sided]: [N; 5],
    end: usize,
    cells: [&CellConstants<N>; CLOSURE_CELLS],
    coefficients: &GhostCoefficients<N>,
) -> [State<N>; GHOSTS] {
    let cell = cells[0];
    let are_two_alike = N::ONE - cell.contrast(cells[1]);
    let are_three_alike = are_two_alike * (N::ONE - cells[1].contrast(cells[2]));
    let corrected = one_sided * are_three_alike * coefficients.correction_flag;
    let reflection = N::HALF * (sign_s - sign_v);

    let [out, own_in] = split_characteristics(end, outer_states[0], cell);
    let [out_behind, in_behind] = split_characteristics(end, outer_states[1], cell);
    let [image_out, image_in] = split_characteristics(end, images[0], cell);
    let [image_out_behind, image_in_behind] = split_characteristics(end, images[1], cell);

    let unfolded = [out - out_behind, image_out - out, image_out_behind - image_out];
    let [to_out, to_out_behind, to_in, to_in_behind] = coefficients.reflecting_weights;
    let reflected = corrected * reflection;
    let mut nearest = [
        image_out + corrected * dot(to_out, unfolded),
        image_in + reflected * dot(to_in, unfolded),
    ];
    let mut farther = [
        image_out_behind + corrected * dot(to_out_behind, unfolded),
        image_in_behind + reflected * dot(to_in_behind, unfolded),
    ];

    if has_open_faces {
        let third = split_characteristics(end, outer_states[2], cell);
        let (before, last) = (out_behind - third[0], out - out_behind);
        let [to_next, to_farther, to_back, from_next] = coefficients.open_weights;
        let next_out = out + (to_next[0] * before + to_next[1] * last);
        let farther_out = out + (to_farther[0] * before + to_farther[1] * last);
        let (first, second) = (in_behind - own_in, third[1] - in_behind);
        let next_in = own_in + (to_back[0] * first + to_back[1] * second);
        let farther_in = dot(from_next, [next_in, own_in, first]);
        let open_weight = N::ONE - reflection * reflection;
        let upwind_weight = open_weight * one_sided * (N::ONE - corrected);
        let open_weight = open_weight * corrected;
        let reflecting_weight = N::ONE - open_weight - upwind_weight;
        nearest = [
            reflecting_weight * nearest[0] + open_weight * next_out + upwind_weight * out,
            reflecting_weight * nearest[1] + open_weight * next_in,
        ];
        farther = [
            reflecting_weight * farther[0]
                + open_weight * farther_out
                + upwind_weight * (out - are_two_alike * (coefficients.upwind_cancellation * last)),
            reflecting_weight * farther[1] + open_weight * farther_in,
        ];
    }
    let half_admittance = N::HALF / cell.impedance;
    // The result at reflecting faces must not depend on whether other faces are non-reflecting.
    let open_face = N::ONE - reflection * reflection;
    let are_three_alike = if has_open_faces {
        open_face + (N::ONE - open_face) * are_three_alike
    } else {
        are_three_alike
    };
    let one_sided = one_sided * are_three_alike;
    let ghosts = [
        state_from_characteristics(end == 0, nearest, half_admittance),
        state_from_characteristics(end == 0, farther, half_admittance),
    ];
    [blend(one_sided, ghosts[0], images[0]), blend(one_sided, ghosts[1], images[1])]
}

/// Ghost values for [`Slopes::Limited`].
///
/// O is the wave that arrives at the boundary, I the wave that leaves it, index 0 in the outermost and 1 in the next
/// cell; * denotes the face value; C is the Courant number; g_v and g_s are the prescribed velocity and traction; γ =
/// ½(σ_s − σ_v) is the reflection coefficient, with the signs σ of the ghost rule (−1: traction, 1: velocity, 0:
/// non-reflecting). At the face I* = γ O* + 2g_s ∓ 2z g_v (− at the lower, + at the upper end) and O* = O₀ + (1 − C) x.
/// In smooth states the half slope x of the arriving wave is ½a with a = O₀ − O₁; in rough states this value could
/// increase the energy. Cell averaging of the leaving wave dissipates at least (w − Cy)² − β, where w = γ(I₀ − I*) for
/// x = ½a (at non-reflecting faces w = −O*) and y is γ times half of the limited slope of the leaving wave. The
/// dissipation limits x:
///
/// ```text
/// x = a (½ − κ(1 − t)),  t = min(1, 15/4 · max(0, (w − Cy)² − β)/(C a²)),
/// κ = ½C/(1 + C + √((1 + C)² − C(1 − C²))),
/// β = max(0, y² − ((1 − ½C)b − (1 − C)y)² + ¼(1 − C)b²),  b = γ(I₁ − I₀).
/// ```
///
/// `tests/solid/energy.rs` searches for states that gain energy in a sweep; none is known. In the nearest ghost the
/// arriving wave is O₀ − a + 4x, which yields the half slope x in the outermost cell, and the leaving wave is the
/// linear function through I* and I₀.
#[inline(always)]
fn compute_limited_ghosts<N: Number>(
    [own, behind]: [State<N>; 2],
    images: [State<N>; GHOSTS],
    [sign_v, shift_v, sign_s, shift_s, one_sided]: [N; 5],
    end: usize,
    [cell, cell_behind]: [&CellConstants<N>; 2],
) -> [State<N>; GHOSTS] {
    // Mirror images where the two cells are of different media: the bound of the dissipation holds in one medium only.
    let one_sided = one_sided * (N::ONE - cell.contrast(cell_behind));
    let is_lower = end == 0;
    let [arriving, leaving] = split_characteristics(end, own, cell);
    let [arriving_behind, leaving_behind] = split_characteristics(end, behind, cell);
    let given_invariant = cell.impedance * shift_v;
    let given_invariant =
        if is_lower { shift_s - given_invariant } else { shift_s + given_invariant };
    let reflection = N::HALF * (sign_s - sign_v);
    let reflects = reflection * reflection;
    let courant = cell.half_courant + cell.half_courant;
    let one_minus_courant = N::ONE - courant;
    let one_plus_courant = N::ONE + courant;
    // Extrapolation from the face at mid-step to the cell centre, then to the ghost centre.
    let extrapolation = N::ONE + reflects * (one_minus_courant / one_plus_courant);
    let steep = arriving - arriving_behind;

    // Lower bound of the dissipation by averaging.
    let w =
        reflection * (leaving - given_invariant) - arriving - N::HALF * one_minus_courant * steep;
    let b = reflection * (leaving_behind - leaving);
    let upwind = extrapolation * w;
    let y = (N::QUARTER * (upwind + b))
        .minmod3(upwind / courant.max(N::MIN_POSITIVE), b / one_minus_courant.max(N::MIN_POSITIVE));
    let averaged = w - courant * y;
    let outflow_part = one_minus_courant * y;
    let inflow_part = (N::ONE - cell.half_courant) * b - outflow_part;
    let beta = y * y - inflow_part * inflow_part + N::QUARTER * one_minus_courant * (b * b);
    let excess_dissipation = averaged * averaged - beta.max(N::ZERO);
    let required_dissipation = (courant * (steep * steep)).max(N::MIN_POSITIVE);
    // A factor of 4 would use the whole dissipation.
    let gain = (N::ONE + N::ONE) + (N::ONE + N::ONE) - N::QUARTER;
    let t = (gain * excess_dissipation.max(N::ZERO) / required_dissipation).min(N::ONE);
    let root = (one_plus_courant * one_plus_courant
        - courant * (one_minus_courant * one_plus_courant))
        .sqrt();
    let kappa = cell.half_courant / (one_plus_courant + root);
    let x = steep * (N::HALF - kappa * (N::ONE - t));

    let incoming = reflection * (arriving + one_minus_courant * x) + given_invariant;
    let downwind = (x + x) + (x + x) - steep;
    let to_ghost = extrapolation * (leaving - incoming);
    let to_farther = (reflects + reflects) * to_ghost - to_ghost;
    let nearest = [arriving + downwind, leaving - to_ghost];
    let farther = [arriving + downwind, leaving - to_ghost - to_farther];
    let half_admittance = N::HALF / cell.impedance;
    let nearest = state_from_characteristics(is_lower, nearest, half_admittance);
    let farther = state_from_characteristics(is_lower, farther, half_admittance);
    [blend(one_sided, nearest, images[0]), blend(one_sided, farther, images[1])]
}

/// Converts the arriving and the leaving characteristic variable to a state.
#[inline(always)]
fn state_from_characteristics<N: Number>(
    is_lower: bool,
    [arriving, leaving]: [N; 2],
    half_admittance: N,
) -> State<N> {
    let difference = if is_lower { arriving - leaving } else { leaving - arriving };
    State { velocity: half_admittance * difference, stress: N::HALF * (arriving + leaving) }
}

/// Selects by weight, if both states are finite: 1 gives `one`, 0 gives `other`, bit for bit except for the sign of
/// zeros.
#[inline(always)]
fn blend<N: Number>(weight: N, one: State<N>, other: State<N>) -> State<N> {
    let other_weight = N::ONE - weight;
    State {
        velocity: weight * one.velocity + other_weight * other.velocity,
        stress: weight * one.stress + other_weight * other.stress,
    }
}
