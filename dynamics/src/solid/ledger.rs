//! Energy of a solid, and ledger of the work and dissipation of its steps.

use crate::exact_sum::ExactSum;
use crate::solid::medium::Medium;
use crate::solid::problem::Problem;
use models::interface::FaceEnergy;

/// Work and dissipation of the steps so far, J (plane strain: per unit thickness).
///
/// Energy after − energy before = boundary work + source work + initial-stress work − plastic − viscous − numerical
/// dissipation, apart from rounding and the flushing of subnormals. Each term is computed separately, none as a
/// residual.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Work done at the boundaries, J, positive inwards.
    pub boundary_work: f64,
    /// Work of sources and gravity, J.
    pub source_work: f64,
    /// Work of the initial stress on plastic strain, J.
    pub initial_stress_work: f64,
    /// Plastic dissipation in cells, J.
    pub plastic_dissipation: f64,
    /// Dissipation of the dashpots of relaxing media, J.
    pub viscous_dissipation: f64,
    /// Energy dissipated by interlayers, by cause, J.
    pub interlayer_losses: InterlayerLosses,
    /// Numerical dissipation, J; see [`SweepAccount`](crate::solid::line::SweepAccount). The fused solver does not
    /// compute it: its ledger has zero here, and the balance lacks this term.
    pub numerical_dissipation: f64,
    /// Smallest ratio, over all cells and steps, of the plastic dissipation of a cell in a step to the energy stored by
    /// its trial stress, if negative, else 0; negative values are rounding errors.
    pub min_dissipation_ratio: f64,
}

impl Ledger {
    /// Returns the change of energy according to all terms, J.
    pub fn energy_change(&self) -> f64 {
        self.boundary_work + self.source_work + self.initial_stress_work
            - self.plastic_dissipation
            - self.viscous_dissipation
            - self.interlayer_losses.total()
            - self.numerical_dissipation
    }
}

/// Energy that interlayers have dissipated, J; see [`FaceEnergy`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct InterlayerLosses {
    /// Plastic dissipation, J: slip, and opening of elastic-plastic layers.
    pub plastic: f64,
    /// Viscous dissipation of interlayers, J.
    pub viscous: f64,
    /// Stored shear energy released by cracks that opened, J.
    pub released: f64,
    /// Stored energy lost at fracture, J.
    pub fracture: f64,
    /// Numerical dissipation of the flow of the fluid along saturated layers, J.
    pub fluid: f64,
}

impl InterlayerLosses {
    /// Returns the sum of all terms, J.
    pub fn total(&self) -> f64 {
        (self.plastic + self.viscous) + (self.released + self.fracture) + self.fluid
    }
}

/// Energy of the deviation from the initial stress, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Kinetic energy of velocities and spins of cells, J.
    pub kinetic: f64,
    /// Energy stored by stresses and history variables of cells, J.
    pub stored: f64,
    /// Kinetic energy of interlayers, J.
    pub interlayer_kinetic: f64,
    /// Stored energy of interlayers, J.
    pub interlayer_stored: f64,
    /// Kinetic energy of the fluid in interlayers, J.
    pub fluid_kinetic: f64,
    /// Energy stored by the pressure of the fluid in interlayers, J.
    pub fluid_stored: f64,
}

impl Energy {
    /// Returns the total energy, J.
    pub fn total(&self) -> f64 {
        self.kinetic
            + self.stored
            + (self.interlayer_kinetic + self.interlayer_stored)
            + (self.fluid_kinetic + self.fluid_stored)
    }
}

/// Energy sums over the cells and faces of a solver. They are exact, hence independent of the order of cells and of the
/// numbers of subdomains and threads.
#[derive(Clone, Debug, Default)]
pub(crate) struct EnergySums {
    /// Sum of kinetic energy densities, J/m³; likewise `stored`.
    pub(crate) kinetic: ExactSum,
    pub(crate) stored: ExactSum,
    /// Sums of the energies of interlayers, J.
    pub(crate) interlayers: InterlayerSums,
}

/// Sums over interlayer faces of the terms of [`FaceEnergy`], J: energies, then losses.
#[derive(Clone, Debug, Default)]
pub(crate) struct InterlayerSums([ExactSum; 9]);

impl InterlayerSums {
    /// Adds a face of area `area`, m².
    pub(crate) fn add(&mut self, energy: &FaceEnergy<f64>, area: f64) {
        let terms = [
            energy.kinetic,
            energy.stored,
            energy.fluid_kinetic,
            energy.fluid_stored,
            energy.plastic_dissipation,
            energy.viscous_dissipation,
            energy.released_energy,
            energy.fracture_energy,
            energy.fluid_dissipation,
        ];
        for (sum, term) in self.0.iter_mut().zip(terms) {
            sum.add(area * term);
        }
    }

    fn merge(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(own, other)| own.merge(other));
    }

    /// Returns the energies dissipated by interlayers, J.
    fn losses(&self) -> InterlayerLosses {
        let [.., plastic, viscous, released, fracture, fluid] =
            self.0.each_ref().map(ExactSum::to_f64);
        InterlayerLosses { plastic, viscous, released, fracture, fluid }
    }
}

/// Sums of a subdomain that are added to those of others, on threads or on other ranks.
pub(crate) trait Sums: Default {
    /// Adds the sums of another subdomain.
    fn merge(&mut self, other: &Self);

    /// Returns for each sum a list of numbers with the same exact sum.
    fn to_terms(&self) -> Vec<Vec<f64>>;

    /// Restores the sums from the lists that [`to_terms`](Self::to_terms) returns.
    fn from_terms(terms: &[Vec<f64>]) -> Self;
}

/// Returns the exact sum of the list at an index; zero if there is none.
fn sum_list(terms: &[Vec<f64>], index: usize) -> ExactSum {
    terms.get(index).into_iter().flatten().copied().collect()
}

impl Sums for EnergySums {
    fn merge(&mut self, other: &Self) {
        self.kinetic.merge(&other.kinetic);
        self.stored.merge(&other.stored);
        self.interlayers.merge(&other.interlayers);
    }

    fn to_terms(&self) -> Vec<Vec<f64>> {
        let all = [&self.kinetic, &self.stored].into_iter().chain(&self.interlayers.0);
        all.map(ExactSum::to_terms).collect()
    }

    fn from_terms(terms: &[Vec<f64>]) -> Self {
        let interlayers = InterlayerSums(std::array::from_fn(|index| sum_list(terms, 2 + index)));
        Self { kinetic: sum_list(terms, 0), stored: sum_list(terms, 1), interlayers }
    }
}

impl EnergySums {
    /// Converts the sums to energies, J; `volume` of a cell, m³.
    pub(crate) fn to_energy(&self, volume: f64) -> Energy {
        let [interlayer_kinetic, interlayer_stored, fluid_kinetic, fluid_stored, ..] =
            self.interlayers.0.each_ref().map(|sum| sum.to_f64());
        Energy {
            kinetic: volume * self.kinetic.to_f64(),
            stored: volume * self.stored.to_f64(),
            interlayer_kinetic,
            interlayer_stored,
            fluid_kinetic,
            fluid_stored,
        }
    }
}

/// Exact sums of work and numerical dissipation over faces and cells, and the smallest dissipation ratio.
#[derive(Clone, Debug, Default)]
pub(crate) struct WorkSums {
    /// Work done at the boundaries, J.
    pub(crate) boundary_work: ExactSum,
    /// Sum of the work densities of sources and gravity, J/m³.
    pub(crate) source_work: ExactSum,
    /// Numerical dissipation, J.
    pub(crate) numerical_dissipation: ExactSum,
    /// See [`Ledger::min_dissipation_ratio`].
    pub(crate) min_dissipation_ratio: f64,
}

impl Sums for WorkSums {
    fn merge(&mut self, other: &Self) {
        self.boundary_work.merge(&other.boundary_work);
        self.source_work.merge(&other.source_work);
        self.numerical_dissipation.merge(&other.numerical_dissipation);
        self.min_dissipation_ratio = self.min_dissipation_ratio.min(other.min_dissipation_ratio);
    }

    fn to_terms(&self) -> Vec<Vec<f64>> {
        self.to_partial_sums().into()
    }

    fn from_terms(terms: &[Vec<f64>]) -> Self {
        let list = |index: usize| terms.get(index).cloned().unwrap_or_default();
        Self::from_partial_sums(&std::array::from_fn(list))
    }
}

impl WorkSums {
    /// Converts each sum to a few numbers of the same exact sum, for checkpoints.
    pub(crate) fn to_partial_sums(&self) -> WorkPartialSums {
        let Self { boundary_work, source_work, numerical_dissipation, min_dissipation_ratio } =
            self;
        [
            boundary_work.to_terms(),
            source_work.to_terms(),
            numerical_dissipation.to_terms(),
            vec![*min_dissipation_ratio],
        ]
    }

    /// Restores the sums from the numbers that [`Self::to_partial_sums`] returns.
    pub(crate) fn from_partial_sums(
        [boundary_work, source_work, numerical_dissipation, least]: &WorkPartialSums,
    ) -> Self {
        let sum = |parts: &[f64]| parts.iter().copied().collect();
        Self {
            boundary_work: sum(boundary_work),
            source_work: sum(source_work),
            numerical_dissipation: sum(numerical_dissipation),
            min_dissipation_ratio: least.iter().copied().fold(0.0, f64::min),
        }
    }
}

/// Lists of numbers whose sums are the boundary work, J, the work of sources and gravity, J/m³, and the numerical
/// dissipation, J; then a list with [`Ledger::min_dissipation_ratio`] only.
pub type WorkPartialSums = [Vec<f64>; 4];

/// Dissipation and work of the laws of each cell, J/m³, by cell or by lane; a list is empty if the problem does not
/// need it.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellDissipation {
    /// Plastic dissipation, J/m³.
    pub(crate) plastic_dissipation: Vec<f64>,
    /// Work of the initial stress on plastic strain, J/m³.
    pub(crate) initial_stress_work: Vec<f64>,
    /// Dissipation of the dashpots of relaxing media, with that of the plastic flow during relaxation, J/m³.
    pub(crate) viscous_dissipation: Vec<f64>,
}

impl CellDissipation {
    /// Creates the lists that the media and the initial stress of a problem need; `zeros` allocates one.
    ///
    /// # Errors
    /// Those of `zeros`.
    pub(crate) fn new<E, const D: usize>(
        problem: &Problem<D>,
        zeros: impl Fn() -> Result<Vec<f64>, E>,
    ) -> Result<Self, E> {
        let list = |is_needed: bool| if is_needed { zeros() } else { Ok(Vec::new()) };
        let is_plastic = problem.media.iter().any(Medium::is_plastic);
        let relaxes = problem.media.iter().any(Medium::relaxes);
        Ok(Self {
            plastic_dissipation: list(is_plastic)?,
            initial_stress_work: list(is_plastic && problem.initial_stress.is_some())?,
            viscous_dissipation: list(relaxes)?,
        })
    }

    /// Returns the three lists: plastic dissipation, work of the initial stress, dissipation of dashpots.
    pub(crate) fn lists(&self) -> [&Vec<f64>; 3] {
        [&self.plastic_dissipation, &self.initial_stress_work, &self.viscous_dissipation]
    }

    /// Returns the lists of [`Self::lists`] for modification.
    pub(crate) fn lists_mut(&mut self) -> [&mut Vec<f64>; 3] {
        [
            &mut self.plastic_dissipation,
            &mut self.initial_stress_work,
            &mut self.viscous_dissipation,
        ]
    }
}

/// All terms of a ledger as exact sums.
#[derive(Clone, Debug, Default)]
pub(crate) struct LedgerSums {
    pub(crate) work: WorkSums,
    /// Sums over cells of the lists of [`CellDissipation::lists`], J/m³.
    pub(crate) dissipation: [ExactSum; 3],
    pub(crate) interlayers: InterlayerSums,
}

impl Sums for LedgerSums {
    fn merge(&mut self, other: &Self) {
        self.work.merge(&other.work);
        let sums = self.dissipation.iter_mut().zip(&other.dissipation);
        sums.for_each(|(own, other)| own.merge(other));
        self.interlayers.merge(&other.interlayers);
    }

    fn to_terms(&self) -> Vec<Vec<f64>> {
        let others = self.dissipation.iter().chain(&self.interlayers.0);
        self.work.to_terms().into_iter().chain(others.map(ExactSum::to_terms)).collect()
    }

    fn from_terms(terms: &[Vec<f64>]) -> Self {
        Self {
            work: WorkSums::from_terms(terms),
            dissipation: std::array::from_fn(|index| sum_list(terms, 4 + index)),
            interlayers: InterlayerSums(std::array::from_fn(|index| sum_list(terms, 7 + index))),
        }
    }
}

impl LedgerSums {
    /// Converts the sums to a ledger, J; `volume` of a cell, m³.
    pub(crate) fn to_ledger(&self, volume: f64) -> Ledger {
        let [plastic_dissipation, initial_stress_work, viscous_dissipation] =
            self.dissipation.each_ref().map(|sum| volume * sum.to_f64());
        Ledger {
            boundary_work: self.work.boundary_work.to_f64(),
            source_work: volume * self.work.source_work.to_f64(),
            initial_stress_work,
            plastic_dissipation,
            viscous_dissipation,
            interlayer_losses: self.interlayers.losses(),
            numerical_dissipation: self.work.numerical_dissipation.to_f64(),
            min_dissipation_ratio: self.work.min_dissipation_ratio,
        }
    }
}
