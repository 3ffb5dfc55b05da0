//! Energy of a solid, and ledger of the work and dissipation of its steps.

use crate::exact_sum::ExactSum;
use crate::solid::problem::Problem;

/// Work and dissipation of the steps so far, J (plane strain: per unit thickness).
///
/// Energy after − energy before = inflow + sources + released − plastic − viscous − numerical. Each term is computed
/// separately, none as a residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Work on the boundaries, positive inwards.
    pub inflow: f64,
    /// Work of sources and gravity.
    pub sources: f64,
    /// Work of the initial stress on plastic strain.
    pub released: f64,
    /// Plastic dissipation.
    pub plastic: f64,
    /// Dissipation of dashpots.
    pub viscous: f64,
    /// Numerical dissipation; see [`Account`](crate::solid::line::Account). Zero in the ledger of the fused solver.
    pub numerical: f64,
    /// Smallest plastic dissipation of a cell in a step, divided by the energy stored in the cell, if negative
    /// (rounding errors only).
    pub least_plastic: f64,
}

impl Ledger {
    /// Returns the change of energy according to all terms, J.
    pub fn change(&self) -> f64 {
        self.inflow + self.sources + self.released - self.plastic - self.viscous - self.numerical
    }
}

/// Energy of the deviation from the initial stress, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy of velocities and spins.
    pub kinetic: f64,
    /// Energy of stresses and memory variables.
    pub stored: f64,
    /// Kinetic energy of interlayers.
    pub interlayer_kinetic: f64,
    /// Stored energy of interlayers.
    pub interlayer_stored: f64,
}

impl Energy {
    /// Returns the total energy, J.
    pub fn total(&self) -> f64 {
        self.kinetic + self.stored + (self.interlayer_kinetic + self.interlayer_stored)
    }
}

/// Energy sums over the cells and faces of a solver. They are exact, hence independent of the order of cells and of the
/// numbers of subdomains and threads.
#[derive(Clone, Debug, Default)]
pub(crate) struct EnergySums {
    /// Sum of kinetic energy densities, J/m³; likewise `stored`.
    pub(crate) kinetic: ExactSum,
    pub(crate) stored: ExactSum,
    /// Kinetic energy of interlayers, J; likewise `interlayer_stored`.
    pub(crate) interlayer_kinetic: ExactSum,
    pub(crate) interlayer_stored: ExactSum,
}

impl EnergySums {
    /// Adds the sums of another subdomain.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.kinetic.merge(&other.kinetic);
        self.stored.merge(&other.stored);
        self.interlayer_kinetic.merge(&other.interlayer_kinetic);
        self.interlayer_stored.merge(&other.interlayer_stored);
    }

    /// Converts to energies; `volume` of a cell, m³.
    pub(crate) fn energy(&self, volume: f64) -> Energy {
        Energy {
            kinetic: volume * self.kinetic.value(),
            stored: volume * self.stored.value(),
            interlayer_kinetic: self.interlayer_kinetic.value(),
            interlayer_stored: self.interlayer_stored.value(),
        }
    }
}

/// Exact sums of work over faces and cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkSums {
    /// Work on the boundaries, J.
    pub(crate) inflow: ExactSum,
    /// Sum of the work densities of sources and gravity, J/m³.
    pub(crate) sources: ExactSum,
    /// Numerical dissipation, J.
    pub(crate) numerical: ExactSum,
    /// See [`Ledger::least_plastic`].
    pub(crate) least_plastic: f64,
}

impl WorkSums {
    /// Adds the sums of another subdomain.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.inflow.merge(&other.inflow);
        self.sources.merge(&other.sources);
        self.numerical.merge(&other.numerical);
        self.least_plastic = self.least_plastic.min(other.least_plastic);
    }

    /// Returns numbers with the same exact sums, for checkpoints.
    pub(crate) fn parts(&self) -> WorkParts {
        let Self { inflow, sources, numerical, least_plastic } = self;
        [inflow.parts(), sources.parts(), numerical.parts(), vec![*least_plastic]]
    }

    /// Restores the sums from such numbers.
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

/// Numbers whose sums are the boundary work, J, the work of sources, J/m³, and the numerical dissipation, J; then
/// [`Ledger::least_plastic`].
pub type WorkParts = [Vec<f64>; 4];

/// Dissipation of the laws of each cell, J/m³, by cell or by lane; lists are empty if no medium needs them.
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
    /// Creates the lists that the media of a problem need; `zeros` allocates one.
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

    /// Returns the three lists: plastic, released, viscous.
    pub(crate) fn all(&self) -> [&Vec<f64>; 3] {
        [&self.plastic, &self.released, &self.viscous]
    }

    /// Returns the three lists for modification.
    pub(crate) fn all_mut(&mut self) -> [&mut Vec<f64>; 3] {
        [&mut self.plastic, &mut self.released, &mut self.viscous]
    }
}

/// All terms of a ledger as exact sums.
#[derive(Clone, Debug, Default)]
pub(crate) struct LedgerSums {
    pub(crate) work: WorkSums,
    /// Sums over cells of the lists of [`CellDissipation::all`].
    pub(crate) dissipation: [ExactSum; 3],
}

impl LedgerSums {
    /// Adds the sums of another subdomain.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.work.merge(&other.work);
        let both = self.dissipation.iter_mut().zip(&other.dissipation);
        both.for_each(|(own, other)| own.merge(other));
    }

    /// Converts to a ledger; `volume` of a cell, m³.
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
