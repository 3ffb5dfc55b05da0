//! Sides as sweeps see them: mirrors with a sign and a shift.

use crate::boundary::{Boundary, Condition, Load, Signal};
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

/// Where a face stands: a group of faces, and a lane.
pub(crate) type Slot = (usize, usize);

/// Signs and shifts by pair and face.
#[derive(Clone)]
pub(crate) struct Mirror<T: Real> {
    /// Sign of v, shift of v, sign of s, shift of s.
    by_face: Vec<[T::Lanes; 4]>,
    /// Groups of faces of a pair; one stands for all where they are alike.
    groups: usize,
    loads: Vec<SideLoad>,
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
    ) -> Self {
        let entry = |condition| match condition {
            Some(Condition::Velocity(given)) => [-1.0, 2.0 * given, 1.0, 0.0],
            Some(Condition::Traction(given)) => [1.0, 0.0, -1.0, 2.0 * given],
            Some(Condition::NonReflecting) | None => [0.0; 4],
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
            let lanes = |own: [f64; 4]| own.map(|value| T::Lanes::all(T::of(value)));
            let by_face = entries.into_iter().map(lanes).collect();
            return Self { by_face, groups: 1, loads: Vec::new(), works };
        }
        let mut by_face = vec![[T::Lanes::ZERO; 4]; pairs * groups];
        let mut works = false;
        for pair in 0..pairs {
            for &(face, (group, lane)) in faces {
                let entry = entry(boundary.condition(pair, face));
                works |= entry[0] == 0.0 || entry[1] != 0.0 || entry[3] != 0.0;
                for (lanes, value) in by_face[pair * groups + group].iter_mut().zip(entry) {
                    lanes.lanes_mut()[lane] = T::of(value);
                }
            }
        }
        Self { by_face, groups, loads: Vec::new(), works }
    }

    /// Adds a load; on faces of open sides there is nothing to be given.
    pub(crate) fn add(&mut self, load: &Load, faces: &[(usize, Slot)]) {
        let (mut entries, mut bases) = (Vec::new(), Vec::new());
        for &(face, amplitude) in &load.faces {
            let from = faces.partition_point(|own| own.0 < face);
            for &(_, (group, lane)) in faces[from..].iter().take_while(|own| own.0 == face) {
                let place = load.pair * self.groups + group;
                let [sign, ..] = self.by_face[place].map(|lanes| lanes.lanes()[lane].wide());
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

    /// Sign of v, shift of v, sign of s, shift of s.
    #[inline(always)]
    pub(crate) fn face(&self, pair: usize, group: usize) -> &[T::Lanes; 4] {
        &self.by_face[pair * self.groups + group.min(self.groups - 1)]
    }
}

/// What a mirror of a sign and a shift shows.
#[inline(always)]
pub(crate) fn shown<N: Number>([sign, shift]: [N; 2], own: N) -> N {
    sign * own + shift
}
