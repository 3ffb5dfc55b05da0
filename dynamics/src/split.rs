//! A domain in parts: slabs along the last axis, each in a thread of its own.
//!
//! A part carries a halo of [`GHOSTS`] layers of its neighbours' cells and refreshes it before each sweep
//! along the last axis. What the sweep makes of the halo itself is thrown away with the next refreshment,
//! so that every cell sees the same operations as in the whole: the same bits.

use crate::domain::{Boundary, Domain, DomainError, Grid, Scheme};
use crate::line::GHOSTS;
use crate::medium::Medium;
use crate::real::Real;
use models::cosserat::waves::Field;
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};

/// What crosses the cuts of a part: towards smaller and towards greater coordinates.
pub trait Halo<T> {
    /// Hands over the outermost layers of the part.
    fn begin(&mut self, send: [&[T]; 2]);

    /// Brings those of its neighbours; what has no neighbour is left as it is.
    fn finish(&mut self, receive: [&mut [T]; 2]);
}

/// The halo of a part whose neighbours are other threads of the process.
#[derive(Debug, Default)]
pub struct Channels<T> {
    neighbours: [Option<Neighbour<T>>; 2],
}

/// To a neighbour, and from it.
type Neighbour<T> = (Sender<Vec<T>>, Receiver<Vec<T>>);

impl<T: Real> Halo<T> for Channels<T> {
    fn begin(&mut self, send: [&[T]; 2]) {
        for (neighbour, layers) in self.neighbours.iter().zip(send) {
            if let Some((sender, _)) = neighbour {
                // A neighbour that is gone has panicked: its thread is joined, and tells.
                let _ = sender.send(layers.to_vec());
            }
        }
    }

    fn finish(&mut self, receive: [&mut [T]; 2]) {
        for (neighbour, layers) in self.neighbours.iter().zip(receive) {
            if let Some((_, receiver)) = neighbour
                && let Ok(received) = receiver.recv()
            {
                layers.copy_from_slice(&received);
            }
        }
    }
}

/// A slab with its halo.
#[derive(Debug)]
struct Part<T, const D: usize, H> {
    domain: Domain<T, D>,
    halo: H,
    /// Cells of a layer.
    layer: usize,
    /// Layers of its own.
    own: Range<usize>,
    send: [Vec<T>; 2],
    receive: [Vec<T>; 2],
}

impl<T: Real, const D: usize, H: Halo<T>> Part<T, D, H> {
    fn advance(&mut self) {
        let Self { domain, halo, layer, own, send, receive } = self;
        let mut exchange = |domain: &mut Domain<T, D>| {
            let layers = |range: Range<usize>| range.start * *layer..range.end * *layer;
            let edges = [own.start..own.start + GHOSTS, own.end - GHOSTS..own.end].map(layers);
            for (buffer, edge) in send.iter_mut().zip(edges) {
                buffer.clear();
                for values in domain.state() {
                    buffer.extend_from_slice(&values[edge.clone()]);
                }
            }
            let [first, last] = send.each_ref().map(Vec::as_slice);
            halo.begin([first, last]);
            let [first, last] = receive.each_mut().map(Vec::as_mut_slice);
            halo.finish([first, last]);
            let total = domain.state().first().map_or(0, Vec::len);
            let halos = [0..own.start * *layer, own.end * *layer..total];
            for (buffer, place) in receive.iter().zip(halos) {
                if place.is_empty() {
                    continue;
                }
                let size = place.len();
                for (field, values) in domain.state_mut().iter_mut().enumerate() {
                    values[place.clone()]
                        .copy_from_slice(&buffer[field * size..(field + 1) * size]);
                }
            }
        };
        domain.advance_with(&mut exchange, None);
    }
}

/// A domain in parts.
#[derive(Debug)]
pub struct Split<T, const D: usize> {
    parts: Vec<Part<T, D, Channels<T>>>,
}

impl<T: Real, const D: usize> Split<T, D> {
    /// A domain at rest, in `count` parts.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(
        grid: Grid<D>,
        media: &[Medium],
        of_cell: &[u16],
        boundaries: &[[Boundary; 2]; D],
        step: f64,
        scheme: Scheme,
        count: usize,
    ) -> Result<Self, DomainError> {
        let layers = grid.cells[D - 1];
        let layer: usize = grid.cells[..D - 1].iter().product();
        if of_cell.len() != layer * layers {
            return Err(DomainError::Cells { found: of_cell.len(), needed: layer * layers });
        }
        if count == 0 || layers / count.max(1) < GHOSTS {
            return Err(DomainError::Parts { found: count, cells: layers });
        }
        let is_periodic = boundaries[D - 1][0] == Boundary::Periodic;
        let mut parts = Vec::with_capacity(count);
        for index in 0..count {
            let range = index * layers / count..(index + 1) * layers / count;
            let is_cut =
                [index > 0, index + 1 < count].map(|inside| count > 1 && (inside || is_periodic));
            let halo = is_cut.map(|cut| if cut { GHOSTS } else { 0 });
            let own = halo[0]..halo[0] + range.len();
            let mut own_grid = grid;
            own_grid.cells[D - 1] = own.end + halo[1];
            // Layers count round where the domain does.
            let own_media: Vec<u16> = (0..own_grid.cells[D - 1])
                .flat_map(|place| {
                    let at = (range.start + layers + place - halo[0]) % layers;
                    of_cell[at * layer..(at + 1) * layer].iter().copied()
                })
                .collect();
            let mut own_boundaries = boundaries.clone();
            for (side, cut) in own_boundaries[D - 1].iter_mut().zip(is_cut) {
                if cut {
                    *side = Boundary::Free;
                }
            }
            let domain =
                Domain::new(own_grid, media.to_vec(), own_media, own_boundaries, step, scheme)?;
            let size = domain.fields().len() * layer * GHOSTS;
            let room = || [vec![T::ZERO; size], vec![T::ZERO; size]];
            let (send, receive) = (room(), room());
            let halo = Channels { neighbours: [None, None] };
            parts.push(Part { domain, halo, layer, own, send, receive });
        }
        for index in 0..count {
            let next = (index + 1) % count;
            if count == 1 || (next == 0 && !is_periodic) {
                continue;
            }
            let ((forth, from_behind), (back, from_ahead)) = (channel(), channel());
            parts[index].halo.neighbours[1] = Some((forth, from_ahead));
            parts[next].halo.neighbours[0] = Some((back, from_behind));
        }
        Ok(Self { parts })
    }

    /// Advances all fields by `steps` time steps, each part in a thread of its own.
    pub fn advance(&mut self, steps: usize) {
        std::thread::scope(|scope| {
            for part in &mut self.parts {
                scope.spawn(move || (0..steps).for_each(|_| part.advance()));
            }
        });
    }

    /// The values of a field, the first axis running fastest; `None` if there is no such field.
    pub fn values(&self, field: Field) -> Option<Vec<T>> {
        let mut all = Vec::new();
        for part in &self.parts {
            let own = part.own.start * part.layer..part.own.end * part.layer;
            all.extend_from_slice(&part.domain.values(field)?[own]);
        }
        Some(all)
    }

    /// Sets the values of a field; of those beyond the end of either nothing happens.
    pub fn set(&mut self, field: Field, values: &[T]) {
        let mut rest = values;
        for part in &mut self.parts {
            let own = part.own.start * part.layer..part.own.end * part.layer;
            let size = own.len().min(rest.len());
            if let Some(place) = part.domain.values_mut(field) {
                place[own.start..own.start + size].copy_from_slice(&rest[..size]);
            }
            rest = &rest[size..];
        }
    }
}
