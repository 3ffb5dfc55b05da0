//! Boundary conditions as ghost cells.
//!
//! Across a plane of symmetry, ghost values are mirror images, which is exact. At a free (fixed) boundary the normal
//! derivative of the velocity (stress) is not zero: an image has a kink at the boundary, which limiters take for an
//! extremum, and the face state has a first-order error. Ghost values are therefore chosen such that the unmodified
//! sweep computes more accurate face states from them: [`limited`] and [`fourth_order`].

use crate::simd::{self, Group, Number, Real};
use crate::solid::boundary::{Boundary, Condition, Load, Signal};
use crate::solid::cell::CellConstants;
use crate::solid::reconstruction::{GHOSTS, Slopes};
use crate::solid::riemann::{RiemannInvariants, State};

/// Boundary at an end of an axis, in the form that the sweeps use.
#[derive(Clone)]
pub(crate) enum BoundaryFaces<T: Real> {
    Periodic,
    /// Outer end of a halo: ghost values are arbitrary.
    Exchange,
    /// Physical boundary with ghost values (±v + a, ±s + b); signs and shifts are zero at non-reflecting faces.
    Physical(GhostRule<T>),
}

impl<T: Real> BoundaryFaces<T> {
    /// Returns the reconstruction beside the boundary; [`Slopes::Godunov`] means that ghost values are images.
    #[inline(always)]
    pub(crate) fn closure(&self) -> Closure {
        match self {
            Self::Physical(mirror) if mirror.is_one_sided => mirror.closure,
            _ => Closure { slopes: Slopes::Godunov, is_open: false },
        }
    }

    /// Returns the ghost rule of a physical boundary.
    pub(crate) fn mirror(&self) -> Option<&GhostRule<T>> {
        match self {
            Self::Physical(mirror) => Some(mirror),
            Self::Periodic | Self::Exchange => None,
        }
    }
}

/// Evaluates the loads on both boundaries of an axis at time `time`, s.
pub(crate) fn set_time<T: Real>(sides: &mut [BoundaryFaces<T>; 2], time: f64) {
    for side in sides {
        if let BoundaryFaces::Physical(mirror) = side {
            mirror.set_time(time);
        }
    }
}

/// Storage position of a face: group index and lane.
pub(crate) type Slot = (usize, usize);

/// Ghost rule of a boundary: signs and shifts by wave pair and face.
#[derive(Clone)]
pub(crate) struct GhostRule<T: Real> {
    /// Sign of v, shift of v, sign of s, shift of s, weight. Weight 1: one-sided reconstruction of the wave that
    /// arrives at the boundary, 0: mirror image.
    by_face: Vec<[T::Lanes; 5]>,
    /// Number of face groups per pair; 1 if all faces have the same rule.
    groups: usize,
    /// Whether all faces have the same rule (the usual case).
    pub(crate) is_uniform: bool,
    loads: Vec<SideLoad>,
    /// Whether any face has a one-sided reconstruction.
    pub(crate) is_one_sided: bool,
    closure: Closure,
    /// Whether boundary work can be non-zero.
    pub(crate) does_work: bool,
}

/// Reconstruction beside a boundary.
#[derive(Clone, Copy)]
pub(crate) struct Closure {
    pub(crate) slopes: Slopes,
    /// Whether any face is non-reflecting.
    pub(crate) is_open: bool,
}

#[derive(Clone)]
struct SideLoad {
    /// Slot in `by_face`, index of the shift (1 or 3), and twice the amplitude.
    entries: Vec<(Slot, usize, f64)>,
    /// Shifts of the same entries without load.
    bases: Vec<f64>,
    signal: Signal,
}

impl<T: Real> GhostRule<T> {
    /// Ghost rule of `boundary` for the faces of a region. `faces`: face index in the boundary's list, ascending, and
    /// slot. A uniform boundary stores one entry, since it is read at both ends of every row.
    pub(crate) fn new(
        boundary: &Boundary,
        pairs: usize,
        (faces, groups): (&[(usize, Slot)], usize),
        is_loaded: bool,
        slopes: Slopes,
    ) -> Self {
        // Without slopes, images give the same face states.
        let one_sided = if slopes == Slopes::Godunov { 0.0 } else { 1.0 };
        // A subdomain holds only some of the faces of a by-face boundary: its closure must not depend on which.
        let is_by_face = matches!(boundary, Boundary::ByFace(_));
        let entry = |condition| match condition {
            Some(Condition::Velocity(given)) => [-1.0, 2.0 * given, 1.0, 0.0, one_sided],
            Some(Condition::Traction(given)) => [1.0, 0.0, -1.0, 2.0 * given, one_sided],
            Some(Condition::NonReflecting) => [0.0, 0.0, 0.0, 0.0, one_sided],
            Some(Condition::OddVelocity) => [-1.0, 0.0, 1.0, 0.0, 0.0],
            Some(Condition::OddStress) => [1.0, 0.0, -1.0, 0.0, 0.0],
            None => [0.0; 5],
        };
        // Non-zero shifts are stored by face: they would alter padding lanes.
        let alike = |pair: usize| {
            let mut all = faces.iter().map(|(face, _)| entry(boundary.condition(pair, *face)));
            let first = all.next()?;
            let is_still = first[1] == 0.0 && first[3] == 0.0;
            (is_still && all.all(|own| own == first)).then_some(first)
        };
        let alike = (0..pairs).map(alike).collect::<Option<Vec<_>>>().filter(|_| !is_loaded);
        if let Some(entries) = alike {
            let does_work = entries.iter().any(|own| own[0] == 0.0);
            let is_one_sided =
                entries.iter().any(|own| own[4] != 0.0) || (is_by_face && one_sided != 0.0);
            let closure = Closure { slopes, is_open: does_work || is_by_face };
            let lanes = |own: [f64; 5]| own.map(|value| T::Lanes::all(T::from_f64(value)));
            let by_face = entries.into_iter().map(lanes).collect();
            return Self {
                by_face,
                groups: 1,
                is_uniform: true,
                loads: Vec::new(),
                is_one_sided,
                closure,
                does_work,
            };
        }
        let mut by_face = vec![[T::Lanes::ZERO; 5]; pairs * groups];
        let (mut does_work, mut is_one_sided, mut is_open) =
            (false, is_by_face && one_sided != 0.0, is_by_face);
        for pair in 0..pairs {
            for &(face, (group, lane)) in faces {
                let entry = entry(boundary.condition(pair, face));
                does_work |= entry[0] == 0.0 || entry[1] != 0.0 || entry[3] != 0.0;
                is_one_sided |= entry[4] != 0.0;
                is_open |= entry[0] == 0.0;
                for (lanes, value) in by_face[pair * groups + group].iter_mut().zip(entry) {
                    lanes.lanes_mut()[lane] = T::from_f64(value);
                }
            }
        }
        let closure = Closure { slopes, is_open };
        Self {
            by_face,
            groups,
            is_uniform: false,
            loads: Vec::new(),
            is_one_sided,
            closure,
            does_work,
        }
    }

    /// Adds a load; it has no effect on non-reflecting faces.
    pub(crate) fn add(&mut self, load: &Load, faces: &[(usize, Slot)]) {
        let (mut entries, mut bases) = (Vec::new(), Vec::new());
        for &(face, amplitude) in &load.faces {
            let from = faces.partition_point(|own| own.0 < face);
            for &(_, (group, lane)) in faces[from..].iter().take_while(|own| own.0 == face) {
                let place = load.pair * self.groups + group;
                let sign = self.by_face[place][0].lanes()[lane].to_f64();
                if sign != 0.0 {
                    let which = if sign < 0.0 { 1 } else { 3 };
                    entries.push(((place, lane), which, 2.0 * amplitude));
                    bases.push(self.by_face[place][which].lanes()[lane].to_f64());
                }
            }
        }
        if !entries.is_empty() {
            self.loads.push(SideLoad { entries, bases, signal: load.signal.clone() });
            self.does_work = true;
        }
    }

    /// Evaluates the shifts at time `time`, s.
    pub(crate) fn set_time(&mut self, time: f64) {
        for load in &self.loads {
            for (&((place, lane), which, _), &base) in load.entries.iter().zip(&load.bases) {
                self.by_face[place][which].lanes_mut()[lane] = T::from_f64(base);
            }
        }
        for load in &self.loads {
            let value = (load.signal)(time);
            for &((place, lane), which, amplitude) in &load.entries {
                let own = &mut self.by_face[place][which].lanes_mut()[lane];
                *own = *own + T::from_f64(amplitude * value);
            }
        }
    }

    /// Returns whether a face can do work now: it is non-reflecting, or its given velocity or traction is non-zero.
    pub(crate) fn does_work_on(&self, pair: usize, slot: Slot) -> bool {
        let [sign, velocity, _, stress, _] = self.face_at(pair, slot);
        self.does_work && (sign == T::ZERO || velocity != T::ZERO || stress != T::ZERO)
    }

    pub(crate) fn closure(&self) -> Closure {
        self.closure
    }

    /// Returns the rule of a group of faces, in the order of `by_face`.
    #[inline(always)]
    pub(crate) fn face(&self, pair: usize, group: usize) -> &[T::Lanes; 5] {
        &self.by_face[pair * self.groups + group.min(self.groups - 1)]
    }

    /// Returns the rule of one face.
    pub(crate) fn face_at(&self, pair: usize, (group, lane): Slot) -> [T; 5] {
        self.face(pair, group).map(|lanes| lanes.lanes()[lane])
    }
}

/// Computes the mirror image sign · value + shift.
#[inline(always)]
pub(crate) fn image<N: Number>([sign, shift]: [N; 2], own: N) -> N {
    sign * own + shift
}

/// Number of cells next to a boundary that determine its ghost values.
pub(crate) const BESIDE: usize = 3;

/// Computes the ghost states beyond an end of a line (0: lower, 1: upper), nearest first. `beside`, `cells`: states and
/// constants of the outermost cells; `mirror`: result of [`GhostRule::face`]; `coefficients`: of the outermost cell.
#[inline(always)]
pub(crate) fn ghosts<N: Number>(
    closure: Closure,
    beside: [State<N>; BESIDE],
    mirror: [N; 5],
    end: usize,
    cells: [&CellConstants<N>; BESIDE],
    coefficients: &GhostCoefficients<N>,
) -> [State<N>; GHOSTS] {
    let [sign_v, shift_v, sign_s, shift_s, _] = mirror;
    let image_of = |own: State<N>| State {
        velocity: image([sign_v, shift_v], own.velocity),
        stress: image([sign_s, shift_s], own.stress),
    };
    let images = [image_of(beside[0]), image_of(beside[1])];
    match closure.slopes {
        Slopes::Godunov => images,
        Slopes::Limited => {
            limited([beside[0], beside[1]], images, mirror, end, [cells[0], cells[1]])
        }
        Slopes::FourthOrder => {
            fourth_order(closure.is_open, (beside, images), mirror, end, cells, coefficients)
        }
    }
}

/// Returns the characteristic variables that arrive at the boundary and leave it.
#[inline(always)]
fn by_way<N: Number>(end: usize, state: State<N>, cell: &CellConstants<N>) -> [N; 2] {
    let RiemannInvariants { right, left } = RiemannInvariants::of(state, cell);
    if end == 0 { [left, right] } else { [right, left] }
}

/// Reflecting closure: flux corrections/(1 − C) by flux, power of C and difference: those of the unfolded arriving wave
/// over the two outermost cells and their images, outwards.
const REFLECTING: [[[f64; 3]; 4]; 3] = [
    [
        [-0.020542, -0.082548, 0.066958],
        [-0.04781, -0.293982, 0.387252],
        [-1.061536, 1.881096, -1.321698],
        [0.833778, -1.02964, 0.880974],
    ],
    [
        [0.15665, -0.068548, -0.1103],
        [0.123486, 0.097652, -0.031454],
        [1.179124, -2.385758, 1.03048],
        [-1.56615, 2.452018, -0.87399],
    ],
    [
        [-0.077896, 0.134494, -0.011028],
        [0.258254, -0.701944, -0.190086],
        [-2.583206, 4.883552, -0.457988],
        [3.354494, -5.74239, 0.598212],
    ],
];

/// Non-reflecting closure: (face value − upwind mean)/(1 − C) by face, power of C and difference. Faces: last interior
/// face and boundary (arriving wave), last interior face (leaving wave). Differences: between the three outermost
/// cells, in the direction of propagation.
const OPEN: [[[f64; 2]; 3]; 3] = [
    [[1.0 / 12.0, 0.33211 + 1.0 / 12.0], [0.25089, -0.24095], [-0.0514, 0.02737]],
    [[0.0, 0.40692], [-0.25572, 0.25506], [0.24459, -0.22165]],
    [[0.5, -1.0 / 12.0], [0.12798, -0.15611], [-0.02068, 0.03919]],
];

#[inline(always)]
fn polynomials<N: Number, const POWERS: usize, const COUNT: usize>(
    coefficients: &[[f64; COUNT]; POWERS],
    courant: N,
) -> [N; COUNT] {
    let mut values = [N::ZERO; COUNT];
    for power in coefficients.iter().rev() {
        for (value, coefficient) in values.iter_mut().zip(power) {
            *value = *value * courant + N::from_f64(*coefficient);
        }
    }
    values
}

#[inline(always)]
fn dot<N: Number>([a, b, c]: [N; 3], [one, two, three]: [N; 3]) -> N {
    a * one + b * two + c * three
}

/// Coefficients of [`fourth_order`]: ghost value corrections per difference beside the boundary. They depend only on
/// the Courant number of the outermost cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GhostCoefficients<N> {
    /// 0 at C = 1 (exact shift by one cell, no correction), else 1.
    moves: N,
    /// Reflecting boundary: arriving wave in the nearest and farther ghost; leaving wave, per reflection coefficient.
    reflecting: [[N; 3]; 4],
    /// Non-reflecting boundary, per two differences: arriving wave in both ghosts, leaving wave in the nearest ghost;
    /// last row: leaving wave in the farther ghost, from its nearest ghost and outermost cell values and a difference.
    open: [[N; 3]; 4],
    /// Non-reflecting boundary of several media: coefficient that cancels the upwind difference in the farther ghost.
    plain: N,
}

impl<N: Number> GhostCoefficients<N> {
    #[inline(always)]
    pub(crate) fn new(cell: &CellConstants<N>) -> Self {
        let one_minus_courant = cell.one_minus_courant();
        let courant = N::ONE - one_minus_courant;
        let moving = (one_minus_courant - N::from_f64(1e-6)).max(N::ZERO);
        let per_staying = N::ONE / one_minus_courant.max(N::from_f64(1e-6));
        // Fourth-order weights divided by 1 − C.
        let twelfth = N::from_f64(1.0 / 12.0);
        let upwind = N::HALF * twelfth * (N::ONE + courant) * (N::ONE + N::ONE + courant);
        let central = N::HALF - twelfth * courant * (N::ONE + courant);
        let downwind = -(N::HALF * twelfth * (N::ONE + courant) * (N::ONE + N::ONE - courant));
        let (per_upwind, per_downwind) = (N::ONE / upwind, N::ONE / downwind);
        let passed = N::ONE + cell.upwind - cell.central;

        // Ghosts are downwind of the boundary for the arriving wave and upwind for the leaving wave.
        let [inside, at_side, outside] = [
            polynomials(&REFLECTING[0], courant),
            polynomials(&REFLECTING[1], courant),
            polynomials(&REFLECTING[2], courant),
        ];
        let mut reflecting = [[N::ZERO; 3]; 4];
        for i in 0..3 {
            let out = inside[i] * per_downwind;
            let back = -(outside[i] * per_upwind);
            reflecting[0][i] = out;
            reflecting[1][i] = out + (at_side[i] - central * out) * per_downwind;
            reflecting[2][i] = back;
            reflecting[3][i] = (passed * back * per_staying - at_side[i]) * per_upwind;
        }

        let [face, side, back] = [
            polynomials(&OPEN[0], courant),
            polynomials(&OPEN[1], courant),
            polynomials(&OPEN[2], courant),
        ];
        let next = [(face[0] - upwind) * per_downwind, (face[1] - central) * per_downwind, N::ZERO];
        let farther = [
            next[0] + (side[0] - central * next[0]) * per_downwind,
            next[1] + (side[1] - upwind - central * next[1]) * per_downwind,
            N::ZERO,
        ];
        let back = [(central - back[0]) * per_upwind, (downwind - back[1]) * per_upwind, N::ZERO];
        let carried = per_staying * per_upwind;
        let from_next = [
            N::ONE + carried * (N::ONE - cell.central),
            carried * cell.central,
            carried * cell.downwind,
        ];
        Self {
            moves: (moving * (N::ONE / N::MIN_POSITIVE)).min(N::ONE),
            reflecting,
            open: [next, farther, back, from_next],
            plain: upwind * per_downwind,
        }
    }

    const NONE: Self = Self {
        moves: N::ZERO,
        plain: N::ZERO,
        reflecting: [[N::ZERO; 3]; 4],
        open: [[N::ZERO; 3]; 4],
    };

    /// Loads the coefficients of a group of lanes.
    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &GhostCoefficients<T::Lanes>) -> Self
    where
        N: simd::Vector<T>,
    {
        let mut own =
            Self { moves: N::load(&from.moves), plain: N::load(&from.plain), ..Self::NONE };
        for form in 0..4 {
            for i in 0..3 {
                own.reflecting[form][i] = N::load(&from.reflecting[form][i]);
                own.open[form][i] = N::load(&from.open[form][i]);
            }
        }
        own
    }

    /// Stores the coefficients as a group of lanes.
    #[inline(always)]
    pub(crate) fn group<T: Real>(&self) -> GhostCoefficients<T::Lanes>
    where
        N: simd::Vector<T>,
    {
        let mut group = GhostCoefficients::NONE;
        self.moves.store(&mut group.moves);
        self.plain.store(&mut group.plain);
        for form in 0..4 {
            for i in 0..3 {
                self.reflecting[form][i].store(&mut group.reflecting[form][i]);
                self.open[form][i].store(&mut group.open[form][i]);
            }
        }
        group
    }
}

/// Ghost values for [`Slopes::FourthOrder`]: a linear, energy-stable closure.
///
/// At a reflecting boundary the unfolded wave is W = (O₁, O₀ | I₀′, I₁′): arriving wave O in the two outermost cells
/// and its images. Images alone conserve energy, but ∂W has a kink at the boundary: first-order error. No closure
/// that is exact for linear waves conserves energy: slopes a inside and b outside change it by C(1 − C²)/12 (a² − b²).
/// [`REFLECTING`], a mean of fits to pulses and to the kink, corrects the flux at the boundary and both fluxes at the
/// next face; the sweep remains a contraction (test `no_line_gains_energy`). At a non-reflecting boundary the incoming
/// wave is zero and the arriving wave is reconstructed one-sidedly: [`OPEN`]. If the three outermost cells are not of
/// one medium, images are used, and non-reflecting faces take the arriving wave of the outermost cell.
#[inline(always)]
fn fourth_order<N: Number>(
    is_open: bool,
    (beside, images): ([State<N>; BESIDE], [State<N>; GHOSTS]),
    [sign_v, _, sign_s, _, one_sided]: [N; 5],
    end: usize,
    cells: [&CellConstants<N>; BESIDE],
    coefficients: &GhostCoefficients<N>,
) -> [State<N>; GHOSTS] {
    let cell = cells[0];
    let two_alike = N::ONE - cell.contrast(cells[1]);
    let of_one = two_alike * (N::ONE - cells[1].contrast(cells[2]));
    let corrected = one_sided * of_one * coefficients.moves;
    let reflection = N::HALF * (sign_s - sign_v);

    let [out, own_in] = by_way(end, beside[0], cell);
    let [out_behind, in_behind] = by_way(end, beside[1], cell);
    let [image_out, image_in] = by_way(end, images[0], cell);
    let [image_out_behind, image_in_behind] = by_way(end, images[1], cell);

    let unfolded = [out - out_behind, image_out - out, image_out_behind - image_out];
    let [to_out, to_out_behind, to_in, to_in_behind] = coefficients.reflecting;
    let reflected = corrected * reflection;
    let mut nearest = [
        image_out + corrected * dot(to_out, unfolded),
        image_in + reflected * dot(to_in, unfolded),
    ];
    let mut farther = [
        image_out_behind + corrected * dot(to_out_behind, unfolded),
        image_in_behind + reflected * dot(to_in_behind, unfolded),
    ];

    if is_open {
        let third = by_way(end, beside[2], cell);
        let (before, last) = (out_behind - third[0], out - out_behind);
        let [to_next, to_farther, to_back, from_next] = coefficients.open;
        let next_out = out + (to_next[0] * before + to_next[1] * last);
        let farther_out = out + (to_farther[0] * before + to_farther[1] * last);
        let (first, second) = (in_behind - own_in, third[1] - in_behind);
        let next_in = own_in + (to_back[0] * first + to_back[1] * second);
        let farther_in = dot(from_next, [next_in, own_in, first]);
        let open = N::ONE - reflection * reflection;
        let plain = open * one_sided * (N::ONE - corrected);
        let open = open * corrected;
        let held = N::ONE - open - plain;
        nearest =
            [held * nearest[0] + open * next_out + plain * out, held * nearest[1] + open * next_in];
        farther = [
            held * farther[0]
                + open * farther_out
                + plain * (out - two_alike * (coefficients.plain * last)),
            held * farther[1] + open * farther_in,
        ];
    }
    let half_admittance = N::HALF / cell.impedance;
    // The result at reflecting faces must not depend on whether other faces are non-reflecting.
    let open_face = N::ONE - reflection * reflection;
    let of_one = if is_open { open_face + (N::ONE - open_face) * of_one } else { of_one };
    let one_sided = one_sided * of_one;
    let made = [
        state_of(end == 0, nearest, half_admittance),
        state_of(end == 0, farther, half_admittance),
    ];
    [chosen(one_sided, made[0], images[0]), chosen(one_sided, made[1], images[1])]
}

/// Ghost values for [`Slopes::Limited`].
///
/// O is the arriving, I the leaving wave, index 0 in the outermost and 1 in the next cell; C the Courant number;
/// γ = ½(σ_s − σ_v) the reflection coefficient (−1: traction, 1: velocity, 0: non-reflecting). At the face
/// I* = γ O* + 2g_s ∓ 2z g_v and O* = O₀ + (1 − C) x. In smooth states x is half the slope a = O₀ − O₁; in rough states
/// this could increase the energy. The averaging of the leaving wave dissipates at least (w − Cy)² − β, with
/// w = γ(I₀ − I*) and y half of its limited slope, which bounds x:
///
/// ```text
/// x = a (½ − κ(1 − t)),  t = min(1, 15/4 · max(0, (w − Cy)² − β)/(C a²)),
/// κ = ½C/(1 + C + √((1 + C)² − C(1 − C²))),
/// β = max(0, y² − ((1 − ½C)b − (1 − C)y)² + ¼(1 − C)b²),  b = γ(I₁ − I₀).
/// ```
///
/// `tests/solid/energy.rs` searches for states that gain energy in a sweep; none is known. The nearest ghost has
/// O = O₀ + 4x − a, which yields this half slope in the outermost cell, and I of the linear wave through I* and I₀.
#[inline(always)]
fn limited<N: Number>(
    [own, behind]: [State<N>; 2],
    images: [State<N>; GHOSTS],
    [sign_v, shift_v, sign_s, shift_s, one_sided]: [N; 5],
    end: usize,
    [cell, cell_behind]: [&CellConstants<N>; 2],
) -> [State<N>; GHOSTS] {
    // Images where the two cells are of different media: the dissipation bound holds in one medium only.
    let one_sided = one_sided * (N::ONE - cell.contrast(cell_behind));
    let is_lower = end == 0;
    let [arriving, leaving] = by_way(end, own, cell);
    let [arriving_behind, leaving_behind] = by_way(end, behind, cell);
    let given = cell.impedance * shift_v;
    let given = if is_lower { shift_s - given } else { shift_s + given };
    let reflection = N::HALF * (sign_s - sign_v);
    let reflects = reflection * reflection;
    let courant = cell.half_courant + cell.half_courant;
    let one_minus_courant = N::ONE - courant;
    let passed = N::ONE + courant;
    // Extrapolation from the face at mid-step to the cell centre, then to the ghost centre.
    let stretch = N::ONE + reflects * (one_minus_courant / passed);
    let steep = arriving - arriving_behind;

    // Lower bound of the dissipation by averaging.
    let w = reflection * (leaving - given) - arriving - N::HALF * one_minus_courant * steep;
    let b = reflection * (leaving_behind - leaving);
    let upwind = stretch * w;
    let y = (N::QUARTER * (upwind + b))
        .minmod3(upwind / courant.max(N::MIN_POSITIVE), b / one_minus_courant.max(N::MIN_POSITIVE));
    let averaged = w - courant * y;
    let half_staying = one_minus_courant * y;
    let passing = (N::ONE - cell.half_courant) * b - half_staying;
    let kept = y * y - passing * passing + N::QUARTER * one_minus_courant * (b * b);
    let budget = averaged * averaged - kept.max(N::ZERO);
    let needed = (courant * (steep * steep)).max(N::MIN_POSITIVE);
    // 4 would use the whole dissipation.
    let most = (N::ONE + N::ONE) + (N::ONE + N::ONE) - N::QUARTER;
    let share = (most * budget.max(N::ZERO) / needed).min(N::ONE);
    let root = (passed * passed - courant * (one_minus_courant * passed)).sqrt();
    let unpaid = cell.half_courant / (passed + root);
    let x = steep * (N::HALF - unpaid * (N::ONE - share));

    let incoming = reflection * (arriving + one_minus_courant * x) + given;
    let downwind = (x + x) + (x + x) - steep;
    let to_ghost = stretch * (leaving - incoming);
    let to_farther = (reflects + reflects) * to_ghost - to_ghost;
    let nearest = [arriving + downwind, leaving - to_ghost];
    let farther = [arriving + downwind, leaving - to_ghost - to_farther];
    let half_admittance = N::HALF / cell.impedance;
    let nearest = state_of(is_lower, nearest, half_admittance);
    let farther = state_of(is_lower, farther, half_admittance);
    [chosen(one_sided, nearest, images[0]), chosen(one_sided, farther, images[1])]
}

/// Converts the arriving and the leaving characteristic variable to a state.
#[inline(always)]
fn state_of<N: Number>(
    is_lower: bool,
    [arriving, leaving]: [N; 2],
    half_admittance: N,
) -> State<N> {
    let difference = if is_lower { arriving - leaving } else { leaving - arriving };
    State { velocity: half_admittance * difference, stress: N::HALF * (arriving + leaving) }
}

/// Selects by weight: 1 gives `one`, 0 gives `other`, bit for bit.
#[inline(always)]
fn chosen<N: Number>(weight: N, one: State<N>, other: State<N>) -> State<N> {
    let rest = N::ONE - weight;
    State {
        velocity: weight * one.velocity + rest * other.velocity,
        stress: weight * one.stress + rest * other.stress,
    }
}
