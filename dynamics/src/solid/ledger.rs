//! The energy there is, and what steps did to it.

/// What steps do to the energy, J (in plane strain of a slice of unit thickness).
///
/// Energy after − energy before = inflow + sources + released − plastic − viscous − numerical. Each term is computed, none
/// as a residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Work at the sides, positive inwards.
    pub inflow: f64,
    /// Work of sources and gravity.
    pub sources: f64,
    /// Work of the initial stress on plastic strain.
    pub released: f64,
    /// Plastic dissipation.
    pub plastic: f64,
    /// Dissipation of dashpots.
    pub viscous: f64,
    /// What the scheme itself dissipates; see [`Account`](crate::solid::line::Account). Zero where the ledger is light.
    pub numerical: f64,
    /// The least plastic dissipation of a cell in a step, over the energy stored there, where it is negative:
    /// by rounding alone.
    pub least_plastic: f64,
}

/// Numbers of a ledger.
const TERMS: usize = 7;

/// Numbers of a [`Total`].
pub(crate) const TOTAL_NUMBERS: usize = 2 * TERMS;

impl Ledger {
    /// What all terms together do to the energy.
    pub fn change(&self) -> f64 {
        self.inflow + self.sources + self.released - self.plastic - self.viscous - self.numerical
    }

    fn numbers(self) -> [f64; TERMS] {
        let Self { inflow, sources, released, plastic, viscous, numerical, least_plastic } = self;
        [inflow, sources, released, plastic, viscous, numerical, least_plastic]
    }

    fn from_numbers(numbers: [f64; TERMS]) -> Self {
        let [inflow, sources, released, plastic, viscous, numerical, least_plastic] = numbers;
        Self { inflow, sources, released, plastic, viscous, numerical, least_plastic }
    }

    /// Each term of both.
    fn with(self, other: Self, term: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            inflow: term(self.inflow, other.inflow),
            sources: term(self.sources, other.sources),
            released: term(self.released, other.released),
            plastic: term(self.plastic, other.plastic),
            viscous: term(self.viscous, other.viscous),
            numerical: term(self.numerical, other.numerical),
            least_plastic: self.least_plastic.min(other.least_plastic),
        }
    }
}

/// Sums over many steps, whose terms may be a thousand times the energy: with compensation (Kahan 1965).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Total {
    sum: Ledger,
    rest: Ledger,
}

impl Total {
    /// As numbers.
    pub(crate) fn numbers(&self) -> [f64; TOTAL_NUMBERS] {
        let [sum, rest] = [self.sum, self.rest].map(Ledger::numbers);
        std::array::from_fn(|i| if i < TERMS { sum[i] } else { rest[i - TERMS] })
    }

    /// From the same numbers.
    pub(crate) fn from_numbers(numbers: [f64; TOTAL_NUMBERS]) -> Self {
        let of = |first: usize| Ledger::from_numbers(std::array::from_fn(|i| numbers[first + i]));
        Self { sum: of(0), rest: of(TERMS) }
    }

    pub(crate) fn add(&mut self, step: Ledger) {
        let term = step.with(self.rest, |new, rest| new + rest);
        let sum = self.sum.with(term, |sum, new| sum + new);
        let added = sum.with(self.sum, |sum, before| sum - before);
        (self.sum, self.rest) = (sum, term.with(added, |new, added| new - added));
    }

    /// The sum of totals in their order.
    pub(crate) fn sum<'a>(totals: impl IntoIterator<Item = &'a Self>) -> Ledger {
        let mut all = Self::default();
        for own in totals {
            all.add(own.sum);
            all.add(own.rest);
        }
        all.sum
    }
}

/// Energy of the deviation from the initial stress, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Of motion and spin.
    pub kinetic: f64,
    /// Of the stress and of memory variables.
    pub stored: f64,
    /// Of the motion of interlayers.
    pub interlayer_kinetic: f64,
    /// Of their stress.
    pub interlayer_stored: f64,
}

impl Energy {
    /// All of it.
    pub fn total(&self) -> f64 {
        self.kinetic + self.stored + (self.interlayer_kinetic + self.interlayer_stored)
    }

    /// The sum of energies in their order.
    pub fn sum<'a>(energies: impl IntoIterator<Item = &'a Self>) -> Self {
        energies.into_iter().fold(Self::default(), |sum, own| Self {
            kinetic: sum.kinetic + own.kinetic,
            stored: sum.stored + own.stored,
            interlayer_kinetic: sum.interlayer_kinetic + own.interlayer_kinetic,
            interlayer_stored: sum.interlayer_stored + own.interlayer_stored,
        })
    }
}
