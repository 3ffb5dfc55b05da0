//! What a domain needs of a problem, and the order in which it needs it.

use super::complete::ClosingSides;
use super::plastic::Sets;
use super::{AtATime, Buffer, CHUNK, Domain, EnergyTerms, Kick, RowEnds, groups, pitch};
use crate::boundary::{Boundary, Load};
use crate::kernel::{Carried, Instructions, Table, Wave};
use crate::ledger::{Ledger, Total};
use crate::line::{Account, Cell, GHOSTS, HALO, Slopes};
use crate::medium::{Medium, energy_terms};
use crate::problem::{Detail, Placement, Problem, Scheme};
use crate::real::{Group, Number, Real};
use crate::side::{GhostCoefficients, Mirror, Side, Slot};
use models::common::elementary::Elementary;
use models::solid::waves::Field;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

/// Media in the lanes of a group; numbered as they turn up.
#[derive(Default)]
struct Patterns {
    known: HashMap<Vec<u16>, u32>,
    all: Vec<Vec<u16>>,
}

impl Patterns {
    fn number(&mut self, lanes: Vec<u16>) -> u32 {
        let (all, next) = (&mut self.all, self.known.len() as u32);
        *self.known.entry(lanes).or_insert_with_key(|lanes| {
            all.push(lanes.clone());
            next
        })
    }

    /// Patterns of the groups of a row, and of the ghosts in front of it and behind.
    fn row<T: Real>(&mut self, media: &[u16], is_periodic: bool) -> (Vec<u32>, [u32; 2 * GHOSTS]) {
        let (lanes, length, groups) =
            (T::Lanes::COUNT as isize, media.len(), groups::<T>(media.len()) as isize);
        // Mirror images, or what comes round. In lanes that are neither cells nor ghosts stands any medium.
        let at = |x: isize| {
            let inside = usize::try_from(x).ok().and_then(|x| media.get(x));
            let beyond =
                if x < 0 { (-1 - x) as usize } else { x as usize - length.min(x as usize) };
            let depth = beyond % length;
            let own = if (x < 0) == is_periodic { length - 1 - depth } else { depth };
            inside.copied().unwrap_or(media[own])
        };
        let mut group =
            |place: isize| self.number((0..lanes).map(|lane| at(lane * groups + place)).collect());
        let own = (0..groups).map(&mut group).collect();
        (own, [-1, -2, groups, groups + 1].map(group))
    }
}

/// The place of a value in a list, which has each one once.
fn number<N: PartialEq>(all: &mut Vec<N>, value: N) -> usize {
    all.iter().position(|own| *own == value).unwrap_or_else(|| {
        all.push(value);
        all.len() - 1
    })
}

/// By group, how many behind it along lines of so many groups have the same pattern, or 255 of these; then
/// zeros for ghosts.
fn alike(patterns: &[u32], stride: usize, count: usize, ghosts: usize) -> Vec<u8> {
    let mut alike = vec![0_u8; patterns.len() + ghosts];
    for group in (0..patterns.len()).rev() {
        if group / stride % count + 1 < count && patterns[group] == patterns[group + stride] {
            alike[group] = alike[group + stride].saturating_add(1);
        }
    }
    alike
}

/// So many zeros, in great pages where the system has such: a sweep across rows is on another small page with
/// every cell, and a processor knows the addresses of few.
fn zeros<N: Number>(count: usize) -> Vec<N> {
    let mut room: Vec<N> = Vec::with_capacity(count);
    #[cfg(target_os = "linux")]
    {
        const PAGE: usize = 1 << 12;
        let free = room.spare_capacity_mut();
        let before = free.as_ptr().cast::<u8>().align_offset(PAGE);
        let length = size_of_val(free).saturating_sub(before) / PAGE * PAGE;
        if length > 0 {
            // SAFETY: whole pages of a room that is ours; how the system keeps them does not change what they hold.
            // Where it cannot do it, it goes on as ever.
            unsafe {
                libc::madvise(
                    free.as_mut_ptr().cast::<u8>().add(before).cast(),
                    length,
                    libc::MADV_HUGEPAGE,
                );
            }
        }
    }
    room.resize(count, N::ZERO);
    room
}

impl<T: Real, const D: usize> Domain<T, D> {
    /// The part of a sound problem in these layers across the last axis, cut where there are others beyond, for
    /// passes of so many steps at most.
    pub(crate) fn slab(
        problem: &Problem<D>,
        own: Range<usize>,
        is_cut: [bool; 2],
        most_steps: usize,
    ) -> Self {
        let whole = problem.grid;
        let [length, last] = [whole.cells[0], whole.cells[D - 1]];
        let (layer, halves) = (whole.faces(D - 1), 2 * most_steps);
        let media = problem.media.clone();
        let fields = &media[0].fields;
        let groups = groups::<T>(length);
        let pitch = pitch(groups);
        let index = |field: Field| fields.iter().position(|own| *own == field);
        let place = |field: Field| Some(index(field)? * pitch);

        let is_own_halo = problem.boundaries[D - 1][0] == Boundary::Periodic && own.len() == last;
        let halo = is_cut.map(|cut| if cut || is_own_halo { most_steps * HALO } else { 0 });
        // Layers count round where the domain does.
        let layers: Vec<usize> = (0..halo[0] + own.len() + halo[1])
            .map(|index| (index + own.start + halo[0] * last - halo[0]) % last)
            .collect();
        let of_layer = |values: usize| values * layer..(values + 1) * layer;
        let of_cell: Vec<u16> =
            layers.iter().flat_map(|&index| &problem.of_cell[of_layer(index)]).copied().collect();

        let slopes = problem.scheme.slopes;
        let mut constants = Vec::new();
        let mut ratios = Vec::new();
        let mut wave = |axis: usize, pair: usize, sweep: f64| {
            // What follows in any medium, in the others by a ratio of zero.
            let all = media.iter().flat_map(|medium| &medium.pairs[axis][pair].followers);
            let mut followers: Vec<usize> = all.filter_map(|(field, _)| index(*field)).collect();
            followers.sort_unstable();
            followers.dedup();
            let cells: Vec<Cell<T>> = media
                .iter()
                .map(|medium| {
                    let own = &medium.pairs[axis][pair];
                    let courant = own.speed() * (sweep * problem.step / whole.spacing[axis]);
                    let (impedance, courant) = (own.impedance(), courant.min(1.0));
                    match (slopes, media.len()) {
                        (Slopes::Godunov, _) => Cell::constant(impedance, courant),
                        (Slopes::FourthOrder, 2..) => Cell::among_others(impedance, courant),
                        _ => Cell::new(impedance, courant),
                    }
                })
                .collect();
            let of_followers = followers.iter().map(|&index| {
                let ratio = |medium: &Medium| {
                    let mut own = medium.pairs[axis][pair].followers.iter();
                    own.find(|own| own.0 == fields[index]).map_or(0.0, |own| own.1)
                };
                media.iter().map(ratio).collect::<Vec<f64>>()
            });
            let pair = &media[0].pairs[axis][pair];
            Wave {
                velocity: place(pair.velocity).unwrap_or(0),
                stress: place(pair.stress).unwrap_or(0),
                constants: number(&mut constants, cells),
                ratios: of_followers.map(|ratio| number(&mut ratios, ratio)).collect(),
                followers: followers.into_iter().map(|index| index * pitch).collect(),
            }
        };
        let waves: [Vec<Wave>; D] = std::array::from_fn(|axis| {
            (0..media[0].pairs[axis].len()).map(|pair| wave(axis, pair, 0.5)).collect()
        });
        let alternates = problem.scheme.alternates();
        let pairs = (0..media[0].pairs[0].len()).filter(|_| alternates);
        let quarter_waves: Vec<Wave> = pairs.map(|pair| wave(0, pair, 0.25)).collect();

        let mut known = Patterns::default();
        let is_periodic = problem.boundaries[0][0] == Boundary::Periodic;
        let rows: Vec<_> =
            of_cell.chunks(length).map(|row| known.row::<T>(row, is_periodic)).collect();
        let mut patterns: Vec<u32> = rows.iter().flat_map(|row| row.0.iter().copied()).collect();
        let across = groups * layer / length;
        // The group and lane of a cell.
        let slot =
            |cell: usize| (cell / length * groups + cell % length % groups, cell % length / groups);

        let side = |axis: usize, end: usize| {
            let boundary = &problem.boundaries[axis][end];
            if axis + 1 == D && halo[end] > 0 {
                return Side::Cut;
            }
            if *boundary == Boundary::Periodic {
                return Side::Periodic;
            }
            let mut faces: Vec<(usize, Slot)> = if axis + 1 == D {
                (0..layer).map(|face| (face, slot(face))).collect()
            } else {
                // Those of the layer, and how they stand together.
                let own = layer / whole.cells[axis];
                let of_face = |index: usize, face: usize| match axis {
                    0 => {
                        let row = index * own + face;
                        (row / T::Lanes::COUNT, row % T::Lanes::COUNT)
                    }
                    _ => (index * groups + slot(face).0, slot(face).1),
                };
                let of_layer = |(index, &layer): (usize, &usize)| {
                    (0..own).map(move |face| (layer * own + face, of_face(index, face)))
                };
                layers.iter().enumerate().flat_map(of_layer).collect()
            };
            faces.sort_unstable();
            let groups = match axis {
                0 => rows.len().div_ceil(T::Lanes::COUNT),
                _ if axis + 1 == D => across,
                _ => layers.len() * groups,
            };
            let own = |load: &&Load| (load.axis, load.end) == (axis, end);
            let loads: Vec<&Load> = problem.loads.iter().filter(own).collect();
            let pairs = media[0].pairs[axis].len();
            let is_loaded = !loads.is_empty();
            let mut mirror = Mirror::new(boundary, pairs, (&faces, groups), is_loaded, slopes);
            loads.into_iter().for_each(|load| mirror.add(load, &faces));
            Side::Mirror(mirror)
        };
        let sides: [[Side<T>; 2]; D] =
            std::array::from_fn(|axis| std::array::from_fn(|end| side(axis, end)));

        // Where each layer of the whole stands.
        let mut standing: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (index, &layer) in layers.iter().enumerate() {
            standing.entry(layer).or_default().push(index);
        }
        let kicks = problem.sources.iter().map(|source| {
            let mut cells = Vec::new();
            for &(cell, share) in &source.cells {
                for index in standing.get(&(cell / layer)).into_iter().flatten() {
                    let (group, lane) = slot(index * layer + cell % layer);
                    cells.push((group, lane, share));
                }
            }
            cells.sort_by_key(|&(group, lane, _)| (group, lane));
            let amplitudes = source.amplitudes.iter();
            let amplitudes = amplitudes.filter_map(|&(f, a)| Some((place(f)?, a))).collect();
            Kick { cells, amplitudes, signal: source.signal.clone(), now: vec![[0.0; 2]; halves] }
        });
        let initial_stress =
            problem.initial_stress.clone().map(|(axis, stress)| match axis + 1 == D {
                true => (axis, layers.iter().map(|&layer| stress[layer]).collect()),
                false => (axis, stress),
            });
        let turning = (0..3).filter_map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            Some([place(Field::Spin(k))?, place(Field::Stress(i, j))?, place(Field::Stress(j, i))?])
        });
        let turning: Vec<_> = turning.collect();
        let is_plastic = media.iter().any(|medium| medium.yields.is_some());
        // In a pass of one step a halo goes as far as the second sweep along the last axis, which reads its own fields
        // and what has been turned with them. Further steps read all, and so does a correction before that sweep.
        let whole_state =
            D == 2 || alternates || (is_plastic && problem.scheme.placement == Placement::Middle);
        let read = |place: &usize| {
            waves[D - 1].iter().any(|wave| [wave.velocity, wave.stress].contains(place))
        };
        let turned_with = |place: &usize| {
            turning.iter().any(|turn: &[usize; 3]| turn.contains(place) && turn.iter().any(read))
        };
        let mut exchanged: Vec<Range<usize>> = Vec::new();
        for place in (0..fields.len()).map(|index| index * pitch) {
            if whole_state || read(&place) || turned_with(&place) {
                match exchanged.last_mut() {
                    Some(last) if last.end == place => last.end += pitch,
                    _ => exchanged.push(place..place + pitch),
                }
            }
        }
        let integrals = problem.integrals.iter().filter_map(|&field| place(field));
        let cells = of_cell.len();
        let longest = whole.cells.iter().copied().max().unwrap_or(0).max(layers.len());
        let longest = longest + 2 * GHOSTS;
        let own_groups = patterns.len();
        // From a group to the next one, and groups of a line.
        let lines: [[usize; 2]; D] = std::array::from_fn(|axis| match axis {
            0 => [1, groups],
            _ if axis + 1 == D => [across, layers.len()],
            _ => [groups, whole.cells[axis]],
        });
        let alike = lines.map(|[stride, count]| match known.all.len() {
            1 => Vec::new(),
            _ => alike(&patterns, stride, count, 2 * GHOSTS * CHUNK * groups),
        });
        patterns.extend(vec![0; 2 * GHOSTS * CHUNK * groups]);
        let carried = std::array::from_fn(|axis| {
            let lines = match axis {
                0 => CHUNK,
                _ if axis + 1 == D => across,
                _ => layers.len() * groups,
            };
            let room = vec![Carried::empty(); lines * waves.get(axis).map_or(0, Vec::len)];
            vec![room; halves]
        });
        let buffer = Buffer {
            carried,
            way: Vec::with_capacity(longest),
            left: Vec::with_capacity(across),
            velocity: vec![T::ZERO; longest],
            stress: vec![T::ZERO; longest],
            cells: vec![Cell::new(1.0, 0.0); longest],
            accounts: vec![Account::default(); longest],
        };
        let row = pitch * fields.len() * size_of::<T::Lanes>();
        let come_round = problem.boundaries[1][0] == Boundary::Periodic;
        let at_a_time = match (problem.scheme.detail, D) {
            (Detail::Full, _) => AtATime::ALL,
            (Detail::Light, 3) => AtATime::in_space(row, come_round),
            (Detail::Light, _) => AtATime::ROWS,
        };
        let mut grid = whole;
        grid.cells[D - 1] = own.len();
        let mut domain = Self {
            grid,
            halo,
            is_own_halo,
            of_cell,
            step: problem.step,
            most_steps,
            pass_steps: 0,
            scheme: match slopes {
                // Of their cells the weights are zero.
                Slopes::Godunov => Scheme { slopes: Slopes::FourthOrder, ..problem.scheme },
                _ => problem.scheme,
            },
            instructions: Instructions::best(),
            waves,
            quarter_waves,
            table: Table {
                cells: Vec::new(),
                waves: 0,
                ratios: Vec::new(),
                followers: 0,
                ghost_coefficients: Vec::new(),
            },
            turns: Vec::new(),
            yields: Vec::new(),
            turning,
            exchanged,
            energy_terms: EnergyTerms { places: Vec::new(), kinetic: 0, factors: Vec::new() },
            groups,
            pitch,
            rows: layer / length,
            across,
            row_ends: RowEnds::new(length, groups),
            data: zeros(patterns.len() / groups * fields.len() * pitch),
            patterns,
            alike,
            row_patterns: match known.all.len() {
                1 => Vec::new(),
                _ => rows.iter().map(|row| row.1).collect(),
            },
            closing_sides: vec![
                ClosingSides::new(&sides[0]);
                if alternates { most_steps } else { 0 }
            ],
            sides: vec![sides; halves],
            kicks: kicks.collect(),
            acceleration: problem.acceleration,
            initial_stress,
            sets: None,
            dissipated: zeros(if is_plastic { own_groups * T::Lanes::COUNT } else { 0 }),
            integrals: integrals.map(|place| (place, vec![0.0; cells])).collect(),
            steps: 0,
            watched: Vec::new(),
            records: vec![Vec::new(); most_steps],
            at_a_time,
            ahead: 0,
            ledgers: vec![vec![Ledger::default(); layers.len() + 2]; halves],
            totals: vec![Total::default(); own.len()],
            buffer,
            media,
        };
        domain.tabulate(&known.all, &constants, &ratios);
        domain
    }

    /// The constants of all patterns, by medium those of all waves and the ratios of followers.
    fn tabulate(&mut self, patterns: &[Vec<u16>], constants: &[Vec<Cell<T>>], ratios: &[Vec<f64>]) {
        let lanes = |pattern: &[u16], value: &dyn Fn(&Medium) -> f64| {
            T::Lanes::by_lane(|lane| T::of(value(&self.media[usize::from(pattern[lane])])))
        };
        let media = &self.media;
        let mut table = Table {
            waves: constants.len(),
            followers: ratios.len(),
            cells: Vec::with_capacity(patterns.len() * constants.len()),
            ratios: Vec::with_capacity(patterns.len() * ratios.len()),
            ghost_coefficients: Vec::new(),
        };
        for pattern in patterns {
            table.cells.extend(constants.iter().map(|cells| {
                let own = |value: fn(&Cell<T>) -> T| {
                    T::Lanes::by_lane(|lane| value(&cells[usize::from(pattern[lane])]))
                };
                Cell {
                    impedance: own(|cell| cell.impedance),
                    half_courant: own(|cell| cell.half_courant),
                    to_velocity: own(|cell| cell.to_velocity),
                    mean_slope: own(|cell| cell.mean_slope),
                    steepest: own(|cell| cell.steepest),
                    upwind: own(|cell| cell.upwind),
                    central: own(|cell| cell.central),
                    downwind: own(|cell| cell.downwind),
                }
            }));
            let lanes = |ratio: &Vec<f64>| {
                T::Lanes::by_lane(|lane| T::of(ratio[usize::from(pattern[lane])]))
            };
            table.ratios.extend(ratios.iter().map(lanes));
        }
        if table.is_of_one_pattern() {
            table.ghost_coefficients = table.cells.iter().map(GhostCoefficients::new).collect();
        }
        let turns = patterns.iter().map(|pattern| {
            [1.0, 0.5].map(|part| {
                [0, 1, 2].map(|which| {
                    lanes(pattern, &|medium| {
                        let Some(rotation) = medium.rotation else {
                            return [1.0, 0.0, 0.0][which];
                        };
                        let (sin, cos) = (rotation.frequency * part * self.step).cr_sin_cos();
                        [cos, rotation.ratio * sin, sin / rotation.ratio][which]
                    })
                })
            })
        });
        let turns = turns.collect();
        let yields = |medium: &u16| media[usize::from(*medium)].yields.is_some();
        let yields = patterns.iter().map(|pattern| pattern.iter().any(yields)).collect();
        // Coefficients by term; kinetic terms in front, since velocities and spins are.
        let mut terms: BTreeMap<[usize; 2], Vec<f64>> = BTreeMap::new();
        for (index, medium) in media.iter().enumerate() {
            for (one, other, factor) in energy_terms(medium) {
                let term = terms.entry([one, other]).or_insert_with(|| vec![0.0; media.len()]);
                term[index] = factor;
            }
        }
        let is_kinetic = |indices: &[usize; 2]| media[0].inertia(media[0].fields[indices[0]]) > 0.0;
        let kinetic = terms.keys().filter(|indices| is_kinetic(indices)).count();
        let factors = patterns.iter().map(|pattern| {
            let of =
                |term: &Vec<f64>| T::Lanes::by_lane(|lane| T::of(term[usize::from(pattern[lane])]));
            terms.values().map(of).collect()
        });
        let factors = factors.collect();
        let places = terms.keys().map(|indices| indices.map(|index| index * self.pitch)).collect();
        let is_plastic = media.iter().any(|medium| medium.yields.is_some());
        self.sets = Sets::new(media, patterns, self.pitch).filter(|_| is_plastic);
        (self.table, self.turns, self.yields) = (table, turns, yields);
        self.energy_terms = EnergyTerms { places, kinetic, factors };
    }
}
