//! Constants of a cell for a wave pair: impedance, Courant number, and the reconstruction weights that depend on them.

use crate::simd::{LaneGroup, Number, Real, Vector};

/// Constants of a cell for a wave pair. C is the Courant number; for the weights and the bound of the reconstruction
/// some constructors use another C.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellConstants<N> {
    /// Impedance z, kg/(m²s) for translations.
    pub impedance: N,
    /// C/2, with the Courant number C: change of the stress s per difference of 2zv between the interface states.
    pub(crate) half_courant: N,
    /// C/(2z): change of the velocity v per difference of 2s between the interface states.
    pub(crate) velocity_factor: N,
    /// (1 − C)/4: half-slope correction per sum of the upwind and the downwind difference, unlimited.
    pub(crate) mean_slope_weight: N,
    /// (1 − C)/C: bound of the half-slope correction per upwind difference (Roe 1985).
    pub(crate) upwind_bound: N,
    /// Fourth order: weight of the upwind difference, (1 − C²)(2 + C)/24.
    pub(crate) upwind_weight: N,
    /// Fourth order: weight of the difference to the downwind cell, (1 − C)/2 − C(1 − C²)/12.
    pub(crate) central_weight: N,
    /// Fourth order: weight of the next downwind difference, −(1 − C²)(2 − C)/24.
    pub(crate) downwind_weight: N,
}

impl<T: Real> CellConstants<T> {
    /// Creates the constants from the impedance, kg/(m²s) for translations, and the Courant number in \[0, 1\].
    pub fn new(impedance: f64, courant: f64) -> Self {
        Self::with_reconstruction_courant(courant, impedance, courant)
    }

    /// Creates the constants as [`Self::new`] does, for
    /// [`Slopes::FourthOrder`](crate::solid::line::Slopes::FourthOrder) in problems with several media or interlayers.
    /// With the weights of `interface_weights` the energy never grows for C ≥ 0.02. Waves with C < 0.02 use the weights
    /// for C = 0.02. These are stable for smaller C too, since with the same face values a smaller Courant number
    /// leaves less energy; they add at most 2 % of the dissipation of the first-order scheme.
    pub fn with_interfaces(impedance: f64, courant: f64) -> Self {
        Self::with_reconstruction_courant(courant.max(0.02), impedance, courant)
    }

    /// Creates constants for the first-order scheme, whichever [`Slopes`](crate::solid::line::Slopes) the sweep
    /// applies: the weights are those for C = 1, which are zero.
    pub(crate) fn with_constant_reconstruction(impedance: f64, courant: f64) -> Self {
        Self { upwind_bound: T::ZERO, ..Self::with_reconstruction_courant(1.0, impedance, courant) }
    }

    fn with_reconstruction_courant(
        reconstruction_courant: f64,
        impedance: f64,
        courant: f64,
    ) -> Self {
        Self {
            impedance: T::from_f64(impedance),
            half_courant: T::from_f64(0.5 * courant),
            velocity_factor: T::from_f64(0.5 * courant / impedance),
            mean_slope_weight: T::from_f64(0.25 * (1.0 - reconstruction_courant)),
            // Finite for C → 0, where the bound is hardly ever active.
            upwind_bound: T::from_f64((1.0 - courant) / courant.max(1e-6)),
            upwind_weight: T::from_f64(
                (1.0 - reconstruction_courant)
                    * (1.0 + reconstruction_courant)
                    * (2.0 + reconstruction_courant)
                    / 24.0,
            ),
            central_weight: T::from_f64(
                (1.0 - reconstruction_courant)
                    * (0.5 - reconstruction_courant * (1.0 + reconstruction_courant) / 12.0),
            ),
            downwind_weight: T::from_f64(
                -(1.0 - reconstruction_courant)
                    * (1.0 + reconstruction_courant)
                    * (2.0 - reconstruction_courant)
                    / 24.0,
            ),
        }
    }

    /// Returns the Courant number C = cΔt/h, in \[0, 1\].
    pub fn courant(&self) -> T {
        self.half_courant + self.half_courant
    }
}

impl<L> CellConstants<L> {
    /// Creates the constants of a group from those of its lanes.
    pub(crate) fn from_lanes<T: Real>(lane: impl Fn(usize) -> CellConstants<T>) -> Self
    where
        L: LaneGroup<T>,
    {
        let lanes_of =
            |value: fn(&CellConstants<T>) -> T| L::from_lanes(|index| value(&lane(index)));
        Self {
            impedance: lanes_of(|cell| cell.impedance),
            half_courant: lanes_of(|cell| cell.half_courant),
            velocity_factor: lanes_of(|cell| cell.velocity_factor),
            mean_slope_weight: lanes_of(|cell| cell.mean_slope_weight),
            upwind_bound: lanes_of(|cell| cell.upwind_bound),
            upwind_weight: lanes_of(|cell| cell.upwind_weight),
            central_weight: lanes_of(|cell| cell.central_weight),
            downwind_weight: lanes_of(|cell| cell.downwind_weight),
        }
    }
}

impl<V: Number> CellConstants<V> {
    /// Returns 1 if the other cell has another impedance or Courant number, else 0.
    #[inline(always)]
    pub(crate) fn contrast(&self, other: &Self) -> V {
        let impedance = other.impedance - self.impedance;
        let courant = other.half_courant - self.half_courant;
        let size = impedance * impedance + courant * courant;
        (size * (V::ONE / V::MIN_POSITIVE)).min(V::ONE)
    }

    /// Computes the reflection coefficient (y − z)/(y + z) of the face between this cell, of impedance z, and another
    /// one, of impedance y.
    #[inline(always)]
    pub(crate) fn reflection_coefficient(&self, other: &Self) -> V {
        (other.impedance - self.impedance) / (other.impedance + self.impedance)
    }

    /// Fourth order: computes the time-averaged wave at the face between the second and the third of four cells of
    /// equal constants, numbered in the direction of propagation, from the values of the wave in the cells; a formula
    /// in their differences would require more additions.
    #[inline(always)]
    pub(crate) fn face_value(&self, values: [V; 4]) -> V {
        let weights = [
            self.upwind_weight,
            V::ONE + self.upwind_weight - self.central_weight,
            self.central_weight - self.downwind_weight,
            self.downwind_weight,
        ];
        Self::weighted_face_value(weights, values)
    }

    /// Fourth order in one medium: returns the weights of the cells of [`Self::face_value`] where interlayers lie between
    /// some of the cells, in the order first, second, third, fourth; the weights of the first and of the third and
    /// fourth cell enter with the signs of [`Self::weighted_face_value`]. `continuity`: 0 at an interlayer, 1 at any
    /// other of the three faces between the cells. Differences across interlayers have no weight. The others have those
    /// of [`Self::interface_weights`], or without interlayers those of [`Self::face_value`].
    #[inline(always)]
    pub(crate) fn interlayer_weights(&self, continuity: [V; 3]) -> [V; 4] {
        let [upwind, central, downwind] = continuity;
        let (beside, _) = self.interface_weights(continuity);
        let full = upwind * central * downwind;
        // Beside another medium the upwind difference has a weight, across an interlayer none.
        let upwind_weight = full * self.upwind_weight + upwind * beside[0];
        let central_weight = full * self.central_weight + beside[1];
        let downwind_weight = full * self.downwind_weight + beside[2];
        [
            upwind_weight,
            V::ONE + upwind_weight - central_weight,
            central_weight - downwind_weight,
            downwind_weight,
        ]
    }

    /// Computes [`Self::face_value`] with given weights of the four cells; see [`Self::interlayer_weights`].
    #[inline(always)]
    pub(crate) fn weighted_face_value(weights: [V; 4], values: [V; 4]) -> V {
        let [first, second, third, fourth] = values;
        weights[1] * second - weights[0] * first + (weights[2] * third + weights[3] * fourth)
    }

    /// Returns for each of the first three of four adjacent cells 1 if the next cell has the same impedance and Courant
    /// number, else 0.
    #[inline(always)]
    pub(crate) fn equality_flags([one, two, three, four]: [&Self; 4]) -> [V; 3] {
        [V::ONE - one.contrast(two), V::ONE - two.contrast(three), V::ONE - three.contrast(four)]
    }

    /// Returns 1 − C, with the Courant number C of the reconstruction weights.
    #[inline(always)]
    pub(crate) fn one_minus_courant(&self) -> V {
        let half = self.mean_slope_weight + self.mean_slope_weight;
        half + half
    }

    /// Fourth order near interfaces: returns the weights of the differences whose sum is the face value minus the cell
    /// mean, for the face between this cell and the downwind cell. The array holds the weights of three differences:
    /// from the upwind cell to this cell, across the face, and from the downwind cell to the next one. The second value
    /// is the weight of the additional difference due to scattering at the face. The arguments are 1 or 0: whether the
    /// constants of these three pairs of cells are equal, in the same order.
    ///
    /// The weights divided by 1 − C are constants or linear functions of C, fitted to the most accurate linear
    /// reconstruction that increases the energy of no wave. Reconstructions that are exact for linear profiles would
    /// increase the energy of some waves.
    #[inline(always)]
    pub(crate) fn interface_weights(&self, [upwind, downwind, beyond]: [V; 3]) -> ([V; 3], V) {
        let one_minus_courant = self.one_minus_courant();
        let courant = V::ONE - one_minus_courant;
        let before = one_minus_courant * (upwind * downwind * (V::ONE - beyond));
        let at_face = one_minus_courant * (upwind * (V::ONE - downwind));
        let behind = one_minus_courant * ((V::ONE - upwind) * downwind * beyond);
        // Blocks of equal cells that are two cells long, and one cell long.
        let of_two = one_minus_courant * ((V::ONE - upwind) * downwind * (V::ONE - beyond));
        let of_one = one_minus_courant * ((V::ONE - upwind) * (V::ONE - downwind));
        let weights = [
            before * linear_fit(courant, 0.0820, 0.1723)
                + at_face * linear_fit(courant, 0.3974, 0.0477)
                + behind * linear_fit(courant, 0.1002, 0.0749)
                + of_two * V::from_f64(0.1)
                + of_one * V::from_f64(0.2),
            before * linear_fit(courant, 0.3837, -0.1727)
                + behind * linear_fit(courant, 0.4666, 0.0192)
                + of_two * V::from_f64(0.2),
            -(behind * linear_fit(courant, 0.0842, 0.0737)),
        ];
        (weights, at_face * linear_fit(courant, 0.0903, 0.0039) + of_one * V::from_f64(0.09))
    }

    /// Extracts the constants of a lane of a group.
    #[inline(always)]
    pub(crate) fn lane<T: Real>(&self, lane: usize) -> CellConstants<T>
    where
        V: LaneGroup<T>,
    {
        CellConstants {
            impedance: self.impedance.lanes()[lane],
            half_courant: self.half_courant.lanes()[lane],
            velocity_factor: self.velocity_factor.lanes()[lane],
            mean_slope_weight: self.mean_slope_weight.lanes()[lane],
            upwind_bound: self.upwind_bound.lanes()[lane],
            upwind_weight: self.upwind_weight.lanes()[lane],
            central_weight: self.central_weight.lanes()[lane],
            downwind_weight: self.downwind_weight.lanes()[lane],
        }
    }

    /// Sets the constants of a lane of a group.
    #[inline(always)]
    pub(crate) fn set_lane<T: Real>(&mut self, lane: usize, own: &CellConstants<T>)
    where
        V: LaneGroup<T>,
    {
        self.impedance.lanes_mut()[lane] = own.impedance;
        self.half_courant.lanes_mut()[lane] = own.half_courant;
        self.velocity_factor.lanes_mut()[lane] = own.velocity_factor;
        self.mean_slope_weight.lanes_mut()[lane] = own.mean_slope_weight;
        self.upwind_bound.lanes_mut()[lane] = own.upwind_bound;
        self.upwind_weight.lanes_mut()[lane] = own.upwind_weight;
        self.central_weight.lanes_mut()[lane] = own.central_weight;
        self.downwind_weight.lanes_mut()[lane] = own.downwind_weight;
    }

    /// Loads the constants of a group.
    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &CellConstants<T::Lanes>) -> Self
    where
        V: Vector<T>,
    {
        Self {
            impedance: V::load(&from.impedance),
            half_courant: V::load(&from.half_courant),
            velocity_factor: V::load(&from.velocity_factor),
            mean_slope_weight: V::load(&from.mean_slope_weight),
            upwind_bound: V::load(&from.upwind_bound),
            upwind_weight: V::load(&from.upwind_weight),
            central_weight: V::load(&from.central_weight),
            downwind_weight: V::load(&from.downwind_weight),
        }
    }
}

/// Linear function of the Courant number. Not a closure, which would not inherit the SIMD target features.
#[inline(always)]
fn linear_fit<V: Number>(courant: V, intercept: f64, slope: f64) -> V {
    V::from_f64(intercept) + V::from_f64(slope) * courant
}
