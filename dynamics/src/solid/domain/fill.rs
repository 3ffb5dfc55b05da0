//! SIMD kernels that fill ghost cells at the ends of lines.

use super::rows::Rows;
use super::table::{Table, WavePair};
use crate::simd::{Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{BESIDE, GhostRule, ghosts, image};
use crate::solid::reconstruction::GHOSTS;
use crate::solid::riemann::State;

/// Kernel: fills the ghosts of all waves along rows before the sweep, for the work at boundaries.
pub(crate) struct Fill<'a, T: Real> {
    pub(crate) data: &'a mut [T::Lanes],
    pub(crate) waves: &'a [WavePair],
    pub(crate) rows: Rows<'a, T>,
    pub(crate) count: usize,
}

impl<T: Real> SimdKernel<T> for Fill<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        for (pair, wave) in self.waves.iter().enumerate() {
            self.rows.fill::<V>(self.data, wave, pair, 0..self.count);
        }
    }
}

/// Kernel: fills the ghosts at one depth beyond an end of adjacent lines, as images, group by group.
pub(crate) struct FillEnd<'a, T: Real> {
    pub(crate) data: &'a mut [T::Lanes],
    pub(crate) waves: &'a [WavePair],
    /// Ghost rules to be applied, in this order.
    pub(crate) mirrors: [Option<&'a GhostRule<T>>; 2],
    /// Data indices of the first line's source group and of its ghost; the other lines follow group by group.
    pub(crate) places: [usize; 2],
    pub(crate) lines: usize,
    pub(crate) face: usize,
}

impl<T: Real> SimdKernel<T> for FillEnd<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { data, waves, mirrors, places: [own, ghost], lines, face } = self;
        for (pair, &WavePair { velocity, stress, .. }) in waves.iter().enumerate() {
            for line in 0..lines {
                let group = &data[own + line..];
                let mut seen =
                    State { velocity: V::load(&group[velocity]), stress: V::load(&group[stress]) };
                for mirror in mirrors.into_iter().flatten() {
                    let [v, a, s, b, _] = mirror.face(pair, face + line);
                    seen.velocity = image([V::load(v), V::load(a)], seen.velocity);
                    seen.stress = image([V::load(s), V::load(b)], seen.stress);
                }
                let group = &mut data[ghost + line..];
                seen.velocity.store(&mut group[velocity]);
                seen.stress.store(&mut group[stress]);
            }
        }
    }
}

/// Kernel: fills the ghosts beyond an end of adjacent lines where some wave has a one-sided reconstruction.
pub(crate) struct FillOneSided<'a, T: Real> {
    pub(crate) data: &'a mut [T::Lanes],
    pub(crate) waves: &'a [WavePair],
    pub(crate) mirror: &'a GhostRule<T>,
    pub(crate) end: usize,
    /// By depth, the data index of the first line's cell; the other lines follow group by group.
    pub(crate) beside: [usize; BESIDE],
    /// By depth, the data index of the first line's ghost.
    pub(crate) ghosts: [usize; GHOSTS],
    pub(crate) lines: usize,
    pub(crate) face: usize,
    pub(crate) table: &'a Table<T>,
    /// By depth, the patterns from the group of the first line on.
    pub(crate) patterns: [&'a [u32]; BESIDE],
}

impl<T: Real> SimdKernel<T> for FillOneSided<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { data, waves, mirror, end, lines, face, table, .. } = self;
        let closure = mirror.closure();
        for (pair, wave) in waves.iter().enumerate() {
            for line in 0..lines {
                let [first, second, third] = self.patterns;
                let cells: [CellConstants<V>; BESIDE] = [
                    CellConstants::load(table.cell(first[line], wave)),
                    CellConstants::load(table.cell(second[line], wave)),
                    CellConstants::load(table.cell(third[line], wave)),
                ];
                let [v, a, s, b, one_sided] = mirror.face(pair, face + line);
                let mirror = [V::load(v), V::load(a), V::load(s), V::load(b), V::load(one_sided)];
                let [first, second, third] = self.beside;
                let beside = [
                    state_at(&data[first + line..], wave),
                    state_at(&data[second + line..], wave),
                    state_at(&data[third + line..], wave),
                ];
                let coefficients = table.ghost_coefficients(wave, &cells[0]);
                let cells = [&cells[0], &cells[1], &cells[2]];
                let made = ghosts(closure, beside, mirror, end, cells, &coefficients);
                for (place, state) in self.ghosts.into_iter().zip(made) {
                    let group = &mut data[place + line..];
                    state.velocity.store(&mut group[wave.velocity]);
                    state.stress.store(&mut group[wave.stress]);
                }
            }
        }
    }
}

/// Loads velocity and stress of a pair of waves in a group.
#[inline(always)]
fn state_at<T: Real, V: Vector<T>>(group: &[T::Lanes], wave: &WavePair) -> State<V> {
    State { velocity: V::load(&group[wave.velocity]), stress: V::load(&group[wave.stress]) }
}
