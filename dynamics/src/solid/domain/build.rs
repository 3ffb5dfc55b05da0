//! A domain, or a part of it, made of a problem.

use super::boundaries::Boundaries;
use super::diagnostics::Diagnostics;
use super::interfaces::Interfaces;
use super::law::{LocalLaws, rotated_fields};
use super::layout::{Layout, groups_of_blocks, pitch};
use super::materials::Materials;
use super::memory::{Buffer, zeros};
use super::schedule::{Schedule, TileSizes};
use super::sources::{CellSource, Sources};
use super::{Domain, SolverReal};
use crate::simd::{Instructions, Real};
use crate::solid::boundary::Boundary;
use crate::solid::problem::{Detail, Grid, Placement, Problem, Scheme};
use crate::solid::reconstruction::{HALO, Slopes};
use models::solid::waves::Field;
use std::ops::Range;

impl<const D: usize> Layout<D> {
    /// That of layers of a problem across the last axis, cut where there are others beyond, for passes of so many steps
    /// at most.
    fn new<T: Real>(
        problem: &Problem<D>,
        own: &Range<usize>,
        is_cut: [bool; 2],
        most_steps: usize,
    ) -> Self {
        let mut cells = problem.grid.cells;
        let last = cells[D - 1];
        cells[D - 1] = own.len();
        let block = problem.interlayers_across(0).map_or(1, |own| own.every);
        let groups = groups_of_blocks::<T>(cells[0], block);
        let periodic_in_place =
            problem.boundaries[D - 1][0] == Boundary::Periodic && own.len() == last;
        let halo = is_cut.map(|cut| if cut || periodic_in_place { most_steps * HALO } else { 0 });
        let pitch = pitch(groups);
        Self {
            cells,
            halo,
            periodic_in_place,
            fields: problem.fields().len(),
            groups,
            pitch,
            rows: cells[1..D - 1].iter().product(),
            exchanged: exchanged(problem, pitch),
        }
    }
}

/// Parts of a row that the halo of a neighbour needs.
///
/// In a pass of one step these are the fields that the second sweep along the last axis reads, and those
/// rotated with them. If two steps share a pass, or if relaxation or the midpoint return mapping precede that sweep, all
/// fields are exchanged.
fn exchanged<const D: usize>(problem: &Problem<D>, pitch: usize) -> Vec<Range<usize>> {
    let Problem { media, scheme, .. } = problem;
    let fields = &problem.fields();
    let is_plastic = media.iter().any(|medium| medium.yields.is_some());
    let whole_state = D == 2
        || scheme.alternates()
        || media.iter().any(|medium| medium.relaxation.is_some())
        || (is_plastic && scheme.placement == Placement::Middle);
    let place = |field: Field| fields.iter().position(|own| *own == field).map(|own| own * pitch);
    let read = |of: &usize| {
        let mut pairs = media[0].pairs[D - 1].iter();
        pairs
            .any(|pair| [pair.velocity, pair.stress].into_iter().any(|own| place(own) == Some(*of)))
    };
    let rotated = rotated_fields(fields, pitch);
    let rotated_with =
        |of: &usize| rotated.iter().any(|triple| triple.contains(of) && triple.iter().any(read));
    let mut exchanged: Vec<Range<usize>> = Vec::new();
    for place in (0..fields.len()).map(|index| index * pitch) {
        if whole_state || read(&place) || rotated_with(&place) {
            match exchanged.last_mut() {
                Some(last) if last.end == place => last.end += pitch,
                _ => exchanged.push(place..place + pitch),
            }
        }
    }
    exchanged
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// The part of a sound problem in these layers across the last axis, cut where there are others beyond, for
    /// passes of so many steps at most.
    pub(crate) fn slab(
        problem: &Problem<D>,
        own: Range<usize>,
        is_cut: [bool; 2],
        most_steps: usize,
    ) -> Self {
        let layout = Layout::new::<T>(problem, &own, is_cut, most_steps);
        let (layer, last) = (layout.layer_cells(), problem.grid.cells[D - 1]);
        // Layers of the problem, those of the halo included; they count round where the domain does.
        let layers: Vec<usize> = (0..layout.layers())
            .map(|index| (index + own.start + layout.halo[0] * last - layout.halo[0]) % last)
            .collect();
        let of_layer = |values: usize| values * layer..(values + 1) * layer;
        let of_cell: Vec<u16> =
            layers.iter().flat_map(|&index| &problem.of_cell[of_layer(index)]).copied().collect();
        let (materials, patterns) = Materials::new(problem, of_cell, &layout);
        let media = &materials.media;
        let fields = &materials.fields;
        let initial_stress =
            problem.initial_stress.clone().map(|(axis, stress)| match axis + 1 == D {
                true => (axis, layers.iter().map(|&layer| stress[layer]).collect()),
                false => (axis, stress),
            });
        let reflects = problem.scheme.placement == Placement::Middle;
        let law = LocalLaws::new(
            &materials,
            &patterns,
            (layout.groups, layout.pitch),
            (problem.step, reflects),
            initial_stress,
        );
        let source = |own| CellSource::new(own, fields, &layers, &layout, 2 * most_steps);
        let sources = Sources {
            list: problem.sources.iter().map(source).collect(),
            acceleration: problem.acceleration,
        };
        let row = layout.row_size() * size_of::<T::Lanes>();
        let is_periodic = problem.boundaries[1][0] == Boundary::Periodic;
        let tiles = match (problem.scheme.detail, D) {
            (Detail::Full, _) => TileSizes::ALL,
            (Detail::Light, 3) => TileSizes::in_space(row, is_periodic),
            (Detail::Light, _) => TileSizes::ROWS,
        };
        let is_plastic = media.iter().any(|medium| medium.yields.is_some());
        let pairs = std::array::from_fn(|axis| materials.waves[axis].len());
        let interfaces = Interfaces::new(problem, &layout, &layers);
        Self {
            interfaces,
            grid: Grid { cells: layout.cells, spacing: problem.grid.spacing },
            step: problem.step,
            scheme: match problem.scheme.slopes {
                // The weights of their cells are zero.
                Slopes::Godunov => Scheme { slopes: Slopes::FourthOrder, ..problem.scheme },
                _ => problem.scheme,
            },
            instructions: Instructions::best(),
            boundary: Boundaries::new(problem, &layers, &layout, most_steps),
            sources,
            schedule: Schedule::new(most_steps, tiles),
            data: zeros(
                layout.layers() * layout.rows * layout.row_size()
                    + 2 * crate::solid::reconstruction::GHOSTS
                        * super::schedule::CHUNK
                        * layout.row_size(),
            ),
            diagnostics: Diagnostics::new::<T, D>(
                &layout,
                (fields, &problem.integrals),
                is_plastic,
                most_steps,
            ),
            buffer: Buffer::new(&layout, pairs, 2 * most_steps, law.needs_wide_blocks()),
            law,
            layout,
            materials,
        }
    }
}
