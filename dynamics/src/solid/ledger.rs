//! The energy there is, and what steps did to it.

use crate::exact_sum::ExactSum;
use crate::solid::problem::Problem;

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

impl Ledger {
    /// What all terms together do to the energy.
    pub fn change(&self) -> f64 {
        self.inflow + self.sources + self.released - self.plastic - self.viscous - self.numerical
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
}

/// Sums over the cells and faces of a solver. They are exact, so that they depend neither on the order of cells in memory nor
/// on the number of parts and threads.
#[derive(Clone, Debug, Default)]
pub(crate) struct EnergySums {
    /// Per volume of a cell, J/m³.
    pub(crate) kinetic: ExactSum,
    pub(crate) stored: ExactSum,
    /// J.
    pub(crate) interlayer_kinetic: ExactSum,
    pub(crate) interlayer_stored: ExactSum,
}

impl EnergySums {
    /// Adds those of another part.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.kinetic.merge(&other.kinetic);
        self.stored.merge(&other.stored);
        self.interlayer_kinetic.merge(&other.interlayer_kinetic);
        self.interlayer_stored.merge(&other.interlayer_stored);
    }

    /// The energy, where cells have this volume, m³.
    pub(crate) fn energy(&self, volume: f64) -> Energy {
        Energy {
            kinetic: volume * self.kinetic.value(),
            stored: volume * self.stored.value(),
            interlayer_kinetic: self.interlayer_kinetic.value(),
            interlayer_stored: self.interlayer_stored.value(),
        }
    }
}

/// What steps add up over faces and cells, exactly.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkSums {
    /// Work at the sides, J.
    pub(crate) inflow: ExactSum,
    /// Work of sources and gravity per volume of a cell, J/m³.
    pub(crate) sources: ExactSum,
    /// Dissipation of the scheme, J.
    pub(crate) numerical: ExactSum,
    /// See [`Ledger::least_plastic`].
    pub(crate) least_plastic: f64,
}

impl WorkSums {
    /// Adds those of another part.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.inflow.merge(&other.inflow);
        self.sources.merge(&other.sources);
        self.numerical.merge(&other.numerical);
        self.least_plastic = self.least_plastic.min(other.least_plastic);
    }

    /// Numbers with the same sums, without rounding.
    pub(crate) fn parts(&self) -> WorkParts {
        let Self { inflow, sources, numerical, least_plastic } = self;
        [inflow.parts(), sources.parts(), numerical.parts(), vec![*least_plastic]]
    }

    /// The sums of such numbers.
    pub(crate) fn from_parts([inflow, sources, numerical, least]: &WorkParts) -> Self {
        let sum = |parts: &[f64]| parts.iter().copied().collect();
        Self {
            inflow: sum(inflow),
            sources: sum(sources),
            numerical: sum(numerical),
            least_plastic: least.iter().copied().fold(0.0, f64::min),
        }
    }
}

/// Numbers whose sums are the work at the sides, J, that of sources, J/m³, and the dissipation of the scheme, J; then
/// [`Ledger::least_plastic`].
pub type WorkParts = [Vec<f64>; 4];

/// What the laws of each cell dissipate, J/m³, by cell or by lane; empty where nothing does.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellDissipation {
    /// Plastic dissipation.
    pub(crate) plastic: Vec<f64>,
    /// Work of the initial stress on plastic strain.
    pub(crate) released: Vec<f64>,
    /// Dissipation of dashpots.
    pub(crate) viscous: Vec<f64>,
}

impl CellDissipation {
    /// What the media of a problem need; `zeros` makes a list.
    pub(crate) fn new<const D: usize>(problem: &Problem<D>, zeros: impl Fn() -> Vec<f64>) -> Self {
        let list = |is_needed: bool| if is_needed { zeros() } else { Vec::new() };
        let is_plastic = problem.media.iter().any(|medium| medium.yields.is_some());
        let relaxes = problem.media.iter().any(|medium| medium.relaxation.is_some());
        Self {
            plastic: list(is_plastic),
            released: list(is_plastic && problem.initial_stress.is_some()),
            viscous: list(relaxes),
        }
    }

    /// By kind.
    pub(crate) fn all(&self) -> [&Vec<f64>; 3] {
        [&self.plastic, &self.released, &self.viscous]
    }

    /// By kind, to be set.
    pub(crate) fn all_mut(&mut self) -> [&mut Vec<f64>; 3] {
        [&mut self.plastic, &mut self.released, &mut self.viscous]
    }
}

/// All terms of a ledger in exact sums.
#[derive(Clone, Debug, Default)]
pub(crate) struct LedgerSums {
    pub(crate) work: WorkSums,
    /// Over cells, of [`CellDissipation::all`].
    pub(crate) dissipation: [ExactSum; 3],
}

impl LedgerSums {
    /// Adds those of another part.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.work.merge(&other.work);
        let both = self.dissipation.iter_mut().zip(&other.dissipation);
        both.for_each(|(own, other)| own.merge(other));
    }

    /// The ledger, where cells have this volume, m³.
    pub(crate) fn ledger(&self, volume: f64) -> Ledger {
        let [plastic, released, viscous] =
            self.dissipation.each_ref().map(|sum| volume * sum.value());
        Ledger {
            inflow: self.work.inflow.value(),
            sources: volume * self.work.sources.value(),
            released,
            plastic,
            viscous,
            numerical: self.work.numerical.value(),
            least_plastic: self.work.least_plastic,
        }
    }
}
