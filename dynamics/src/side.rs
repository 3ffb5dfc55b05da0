//! Sides as sweeps see them: ghost states beyond them.
//!
//! Across a plane of symmetry they are mirror images, which is exact. Elsewhere the normal derivative of the velocity
//! on a free side, or of the stress on a fixed one, is not zero, and an image would have a kink there that makes the
//! limiter flatten the wave that arrives: the error of the face state would be of first order. Here that wave is
//! reconstructed from its own side ([`ghosts`]), the condition gives the wave that leaves, and both are put into
//! ghosts from which the sweeps make just these face states.

use crate::boundary::{Boundary, Condition, Load, Signal};
use crate::line::{Cell, GHOSTS, Slopes, State, Waves};
use crate::real::{Group, Number, Real};

/// What lies beyond a side, ready for the sweeps.
#[derive(Clone)]
pub(crate) enum Side<T: Real> {
    /// The opposite side.
    Periodic,
    /// A halo ends here: what lies beyond it does not matter.
    Cut,
    /// A mirror: ghosts are (±v + a, ±s + b), or nothing.
    Mirror(Mirror<T>),
}

impl<T: Real> Side<T> {
    /// The mirror, where there is one.
    pub(crate) fn mirror(&self) -> Option<&Mirror<T>> {
        match self {
            Self::Mirror(mirror) => Some(mirror),
            Self::Periodic | Self::Cut => None,
        }
    }
}

/// Both sides of an axis as they are at a time.
pub(crate) fn set_time<T: Real>(sides: &mut [Side<T>; 2], time: f64) {
    for side in sides {
        if let Side::Mirror(mirror) = side {
            mirror.set_time(time);
        }
    }
}

/// Where a face stands: a group of faces, and a lane.
pub(crate) type Slot = (usize, usize);

/// Signs and shifts by pair and face.
#[derive(Clone)]
pub(crate) struct Mirror<T: Real> {
    /// Sign of v, shift of v, sign of s, shift of s; 1 where the arriving wave is reconstructed from its own side,
    /// 0 where ghosts are images.
    by_face: Vec<[T::Lanes; 5]>,
    /// Groups of faces of a pair; one stands for all where they are alike.
    groups: usize,
    loads: Vec<SideLoad>,
    /// Whether any wave is reconstructed from its own side.
    pub(crate) is_one_sided: bool,
    /// Whether work may be done here.
    pub(crate) works: bool,
}

#[derive(Clone)]
struct SideLoad {
    /// Places in `by_face`, which of the four, and twice the amplitude.
    entries: Vec<(Slot, usize, f64)>,
    /// The same places without any load.
    bases: Vec<f64>,
    signal: Signal,
}

impl<T: Real> Mirror<T> {
    /// The faces of a side by their numbers in the whole of it, in order, and where they stand here. What is the
    /// same at all faces, as it is at most sides without loads, is kept once: it is looked up at both ends of every
    /// row.
    pub(crate) fn new(
        boundary: &Boundary,
        pairs: usize,
        (faces, groups): (&[(usize, Slot)], usize),
        is_loaded: bool,
        slopes: Slopes,
    ) -> Self {
        // Without slopes images give the same face states.
        let one_sided = if slopes == Slopes::Godunov { 0.0 } else { 1.0 };
        let entry = |condition| match condition {
            Some(Condition::Velocity(given)) => [-1.0, 2.0 * given, 1.0, 0.0, one_sided],
            Some(Condition::Traction(given)) => [1.0, 0.0, -1.0, 2.0 * given, one_sided],
            Some(Condition::NonReflecting) => [0.0, 0.0, 0.0, 0.0, one_sided],
            Some(Condition::OddVelocity) => [-1.0, 0.0, 1.0, 0.0, 0.0],
            Some(Condition::OddStress) => [1.0, 0.0, -1.0, 0.0, 0.0],
            None => [0.0; 5],
        };
        // Shifts would move lanes that are no cells.
        let alike = |pair: usize| {
            let mut all = faces.iter().map(|(face, _)| entry(boundary.condition(pair, *face)));
            let first = all.next()?;
            let is_still = first[1] == 0.0 && first[3] == 0.0;
            (is_still && all.all(|own| own == first)).then_some(first)
        };
        let alike = (0..pairs).map(alike).collect::<Option<Vec<_>>>().filter(|_| !is_loaded);
        if let Some(entries) = alike {
            let works = entries.iter().any(|own| own[0] == 0.0);
            let is_one_sided = entries.iter().any(|own| own[4] != 0.0);
            let lanes = |own: [f64; 5]| own.map(|value| T::Lanes::all(T::of(value)));
            let by_face = entries.into_iter().map(lanes).collect();
            return Self { by_face, groups: 1, loads: Vec::new(), is_one_sided, works };
        }
        let mut by_face = vec![[T::Lanes::ZERO; 5]; pairs * groups];
        let (mut works, mut is_one_sided) = (false, false);
        for pair in 0..pairs {
            for &(face, (group, lane)) in faces {
                let entry = entry(boundary.condition(pair, face));
                works |= entry[0] == 0.0 || entry[1] != 0.0 || entry[3] != 0.0;
                is_one_sided |= entry[4] != 0.0;
                for (lanes, value) in by_face[pair * groups + group].iter_mut().zip(entry) {
                    lanes.lanes_mut()[lane] = T::of(value);
                }
            }
        }
        Self { by_face, groups, loads: Vec::new(), is_one_sided, works }
    }

    /// Adds a load; on faces of open sides there is nothing to be given.
    pub(crate) fn add(&mut self, load: &Load, faces: &[(usize, Slot)]) {
        let (mut entries, mut bases) = (Vec::new(), Vec::new());
        for &(face, amplitude) in &load.faces {
            let from = faces.partition_point(|own| own.0 < face);
            for &(_, (group, lane)) in faces[from..].iter().take_while(|own| own.0 == face) {
                let place = load.pair * self.groups + group;
                let sign = self.by_face[place][0].lanes()[lane].wide();
                if sign != 0.0 {
                    let which = if sign < 0.0 { 1 } else { 3 };
                    entries.push(((place, lane), which, 2.0 * amplitude));
                    bases.push(self.by_face[place][which].lanes()[lane].wide());
                }
            }
        }
        if !entries.is_empty() {
            self.loads.push(SideLoad { entries, bases, signal: load.signal.clone() });
            self.works = true;
        }
    }

    /// The shifts at a time.
    pub(crate) fn set_time(&mut self, time: f64) {
        for load in &self.loads {
            for (&((place, lane), which, _), &base) in load.entries.iter().zip(&load.bases) {
                self.by_face[place][which].lanes_mut()[lane] = T::of(base);
            }
        }
        for load in &self.loads {
            let value = (load.signal)(time);
            for &((place, lane), which, amplitude) in &load.entries {
                let own = &mut self.by_face[place][which].lanes_mut()[lane];
                *own = *own + T::of(amplitude * value);
            }
        }
    }

    /// Whether work is done on a face now: neither its velocity nor its traction is zero.
    pub(crate) fn works_on(&self, pair: usize, (group, lane): Slot) -> bool {
        let [sign, velocity, _, stress, _] =
            self.face(pair, group).map(|lanes| lanes.lanes()[lane]);
        self.works && (sign == T::ZERO || velocity != T::ZERO || stress != T::ZERO)
    }

    /// Sign of v, shift of v, sign of s, shift of s, and whether the arriving wave is reconstructed from its own side.
    #[inline(always)]
    pub(crate) fn face(&self, pair: usize, group: usize) -> &[T::Lanes; 5] {
        &self.by_face[pair * self.groups + group.min(self.groups - 1)]
    }
}

/// The image of a value by a sign and a shift.
#[inline(always)]
pub(crate) fn image<N: Number>([sign, shift]: [N; 2], own: N) -> N {
    sign * own + shift
}

/// The ghosts beyond an end (0 towards smaller coordinates, 1 towards greater ones), the nearest first, from the two
/// outermost cells, their constants and what [`Mirror::face`] gives.
///
/// O is the wave that arrives and I the one that leaves, with index 0 in the outermost cell and 1 behind it, C the
/// Courant number, γ = ½(σ_s − σ_v) the coefficient of reflection: −1 for given tractions, 1 for given velocities, 0
/// for open sides. The condition gives I* = γ O* + 2g_s ∓ 2z g_v at the face, where O* = O₀ + (1 − C) x, and x is half
/// of the slope a = O₀ − O₁ where the state is smooth. In rough states that could increase the energy; what the cell
/// loses at the least by averaging the wave that leaves, (w − Cy)² − β with w = γ(I₀ − I*) and y half of the limited
/// slope there, pays for it, and
///
/// ```text
/// x = a (½ − κ(1 − t)),  t = min(1, 15/4 · max(0, (w − Cy)² − β)/(C a²)),
/// κ = ½C/(1 + C + √((1 + C)² − C(1 − C²))),
/// β = max(0, y² − ((1 − ½C)b − (1 − C)y)² + ¼(1 − C)b²),  b = γ(I₁ − I₀).
/// ```
///
/// No state is known in which a sweep increases the energy (`tests/energy.rs` looks for one). The nearest ghost has the
/// O that makes this lead in the outermost cell, 4x − a beyond O₀, and the I of a straight wave through I* and I₀.
#[inline(always)]
pub(crate) fn ghosts<N: Number>(
    [own, behind]: [State<N>; 2],
    [sign_v, shift_v, sign_s, shift_s, one_sided]: [N; 5],
    end: usize,
    [cell, cell_behind]: [&Cell<N>; 2],
) -> [State<N>; GHOSTS] {
    // Images where the two cells are of different media: the payment is that of one.
    let one_sided = one_sided * (N::ONE - cell.contrast(cell_behind));
    let (near, far) = (Waves::of(own, cell), Waves::of(behind, cell));
    let is_lower = end == 0;
    let (arriving, arriving_behind) =
        if is_lower { (near.left, far.left) } else { (near.right, far.right) };
    let (leaving, leaving_behind) =
        if is_lower { (near.right, far.right) } else { (near.left, far.left) };
    let given = cell.impedance * shift_v;
    let given = if is_lower { shift_s - given } else { shift_s + given };
    let reflection = N::HALF * (sign_s - sign_v);
    let reflects = reflection * reflection;
    let courant = cell.half_courant + cell.half_courant;
    let staying = N::ONE - courant;
    let passed = N::ONE + courant;
    // From the middle of the step at the face to the middle of the cell, and on to the middle of a ghost.
    let stretch = N::ONE + reflects * (staying / passed);
    let steep = arriving - arriving_behind;

    // Paid by averaging.
    let w = reflection * (leaving - given) - arriving - N::HALF * staying * steep;
    let b = reflection * (leaving_behind - leaving);
    let upwind = stretch * w;
    let y = (N::QUARTER * (upwind + b))
        .bounded(upwind / courant.greatest(N::LEAST), b / staying.greatest(N::LEAST));
    let averaged = w - courant * y;
    let half_staying = staying * y;
    let passing = (N::ONE - cell.half_courant) * b - half_staying;
    let kept = y * y - passing * passing + N::QUARTER * staying * (b * b);
    let budget = averaged * averaged - kept.greatest(N::ZERO);
    let needed = (courant * (steep * steep)).greatest(N::LEAST);
    // 4 would be all that is paid.
    let most = (N::ONE + N::ONE) + (N::ONE + N::ONE) - N::QUARTER;
    let share = (most * budget.greatest(N::ZERO) / needed).least(N::ONE);
    let root = (passed * passed - courant * (staying * passed)).root();
    let unpaid = cell.half_courant / (passed + root);
    let x = steep * (N::HALF - unpaid * (N::ONE - share));

    let incoming = reflection * (arriving + staying * x) + given;
    let downwind = (x + x) + (x + x) - steep;
    let to_ghost = stretch * (leaving - incoming);
    let to_farther = (reflects + reflects) * to_ghost - to_ghost;
    let nearest = [arriving + downwind, leaving - to_ghost];
    let farther = [arriving + downwind, leaving - to_ghost - to_farther];
    let half_admittance = N::HALF / cell.impedance;
    let nearest = state_of(is_lower, nearest, half_admittance);
    let farther = state_of(is_lower, farther, half_admittance);
    let images = (
        State {
            velocity: image([sign_v, shift_v], own.velocity),
            stress: image([sign_s, shift_s], own.stress),
        },
        State {
            velocity: image([sign_v, shift_v], behind.velocity),
            stress: image([sign_s, shift_s], behind.stress),
        },
    );
    [chosen(one_sided, nearest, images.0), chosen(one_sided, farther, images.1)]
}

/// The state of an arriving and a leaving wave.
#[inline(always)]
fn state_of<N: Number>(
    is_lower: bool,
    [arriving, leaving]: [N; 2],
    half_admittance: N,
) -> State<N> {
    let difference = if is_lower { arriving - leaving } else { leaving - arriving };
    State { velocity: half_admittance * difference, stress: N::HALF * (arriving + leaving) }
}

/// By weight 1 the first state, by weight 0 the second one, to the bit.
#[inline(always)]
fn chosen<N: Number>(weight: N, one: State<N>, other: State<N>) -> State<N> {
    let rest = N::ONE - weight;
    State {
        velocity: weight * one.velocity + rest * other.velocity,
        stress: weight * one.stress + rest * other.stress,
    }
}
