//! Riemann problem between two cells: characteristic variables, interface states (fluxes), and the update of a cell
//! (Godunov 1959). The formulas are generic over the number type: [`sweep`](crate::solid::line::sweep) applies them
//! cell by cell, the fused solver to many lines in SIMD lanes.

use super::cell::CellConstants;
use crate::simd::{Number, Real, Vector};

/// Velocity and stress of a wave pair in a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State<N> {
    pub(crate) velocity: N,
    pub(crate) stress: N,
}

/// Characteristic variables: s − zv (right-going) and s + zv (left-going).
#[derive(Clone, Copy, Debug)]
pub(crate) struct RiemannInvariants<N> {
    pub(crate) right: N,
    pub(crate) left: N,
}

impl<N: Number> RiemannInvariants<N> {
    pub(crate) const ZERO: Self = Self { right: N::ZERO, left: N::ZERO };

    #[inline(always)]
    pub(crate) fn from_state(state: State<N>, cell: &CellConstants<N>) -> Self {
        let zv = cell.impedance * state.velocity;
        Self { right: state.stress - zv, left: state.stress + zv }
    }

    /// Maps the invariants of a neighbour to this cell through the scattering matrix of the face: w = (1 − ρ)w′ + ρŵ,
    /// with the invariant w′ of the neighbour, the reflection coefficient ρ = (y − z)/(y + z) of the impedances y of
    /// the neighbour and z of this cell, and the counter-propagating invariant ŵ of this cell. By time reversal the
    /// same formula gives the outgoing waves. Scattering conserves energy, so that the mapped values can be treated as
    /// those of a line without interface. With ρ = 0 zeros keep their signs: x − (0 − 0·y) = x, but −0 + 0·y = 0 for y ≥ 0.
    #[inline(always)]
    pub(crate) fn transmit(self, neighbour: Self, reflection: N) -> Self {
        let right = reflection * (self.left - neighbour.right);
        let left = reflection * (self.right - neighbour.left);
        Self { right: neighbour.right - (N::ZERO - right), left: neighbour.left - (N::ZERO - left) }
    }

    /// Multiplies both invariants by a factor.
    #[inline(always)]
    pub(crate) fn scale(self, factor: N) -> Self {
        Self { right: factor * self.right, left: factor * self.left }
    }

    /// Returns the invariants of the next cell minus those of this one.
    #[inline(always)]
    pub(crate) fn difference(self, next: Self) -> Self {
        Self { right: next.right - self.right, left: next.left - self.left }
    }

    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &RiemannInvariants<T::Lanes>) -> Self
    where
        N: Vector<T>,
    {
        Self { right: N::load(&from.right), left: N::load(&from.left) }
    }

    #[inline(always)]
    pub(crate) fn store<T: Real>(self, to: &mut RiemannInvariants<T::Lanes>)
    where
        N: Vector<T>,
    {
        self.right.store(&mut to.right);
        self.left.store(&mut to.left);
    }
}

/// Velocity v* and stress s* at a face, the solution of the Riemann problem, scaled by the impedance z of the cell that
/// uses it: difference = 2zv*, sum = 2s*.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InterfaceState<N> {
    pub(crate) difference: N,
    pub(crate) sum: N,
}

impl<N: Number> InterfaceState<N> {
    /// Solves the Riemann problem between cells of equal impedance; `left` = s − zv of the left cell, `right` = s + zv
    /// of the right cell. The result is the same for both.
    #[inline(always)]
    pub(crate) fn riemann_equal_impedance([left, right]: [N; 2]) -> Self {
        Self { difference: right - left, sum: left + right }
    }

    /// Solves the Riemann problem between cells of impedances z and y with incident waves `left` = s − zv and `right` =
    /// s + yv: v* = (right − left)/(z + y), s* = (y left + z right)/(z + y). Computed with the reflection coefficient
    /// (y − z)/(y + z); if it is zero, equal to [`Self::riemann_equal_impedance`] bit for bit. Returns the state scaled
    /// for the left and for the right cell. In the cell of smaller impedance, the relative rounding error of v* is
    /// about ε times the ratio of the larger to the smaller impedance.
    #[inline(always)]
    pub(crate) fn riemann([z, y]: [N; 2], waves: [N; 2]) -> [Self; 2] {
        let reflection = (y - z) / (y + z);
        let Self { difference, sum } = Self::riemann_equal_impedance(waves);
        let sum = sum - reflection * difference;
        [
            Self { difference: (N::ONE - reflection) * difference, sum },
            Self { difference: (N::ONE + reflection) * difference, sum },
        ]
    }

    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &InterfaceState<T::Lanes>) -> Self
    where
        N: Vector<T>,
    {
        Self { difference: N::load(&from.difference), sum: N::load(&from.sum) }
    }

    #[inline(always)]
    pub(crate) fn store<T: Real>(self, to: &mut InterfaceState<T::Lanes>)
    where
        N: Vector<T>,
    {
        self.difference.store(&mut to.difference);
        self.sum.store(&mut to.sum);
    }
}

/// Finite-volume update of a cell from its two interface states.
#[inline(always)]
pub(crate) fn update_cell<N: Number>(
    state: State<N>,
    [left, right]: [InterfaceState<N>; 2],
    cell: &CellConstants<N>,
) -> State<N> {
    State {
        velocity: state.velocity + cell.velocity_factor * (right.sum - left.sum),
        stress: state.stress + cell.half_courant * (right.difference - left.difference),
    }
}

#[cfg(test)]
mod tests {
    use super::InterfaceState;

    /// Verifies that [`InterfaceState::riemann`] equals [`InterfaceState::riemann_equal_impedance`] bit for bit for
    /// equal impedances, signs of zeros included.
    #[test]
    fn riemann_agrees_bitwise_with_the_solution_for_equal_impedances() {
        let numbers = [0.0, -0.0, 1.0, -1.0 / 3.0, 1e-310, -7e200, 0.1, -0.1];
        for (left, right) in numbers.iter().flat_map(|l| numbers.map(|r| (*l, r))) {
            let expected: InterfaceState<f64> =
                InterfaceState::riemann_equal_impedance([left, right]);
            for interface_state in InterfaceState::riemann([0.7; 2], [left, right]) {
                assert_eq!(interface_state.difference.to_bits(), expected.difference.to_bits());
                assert_eq!(interface_state.sum.to_bits(), expected.sum.to_bits());
            }
        }
    }
}
