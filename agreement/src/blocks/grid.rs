//! Periodic grid of blocks in the solver, complex states on it, and their time integration.

use super::layer::LinearLayer;
use crate::MeasurementError;
use dynamics::domain::Domain;
use dynamics::problem::Problem;
use dynamics::solid::interlayers::{
    InterlayerFace, InterlayerLaw, InterlayerPlane, Interlayers, PlaneLaws,
};
use models::common::elementary::Modulus;
use models::interface::history;
use models::interface::layer::LayerLaw;
use models::solid::waves::SolidField;
use num_complex::Complex64;

/// Fields of a classical (not micropolar) solid in plane strain: velocities and stresses.
pub(super) const PLANE_FIELDS: [SolidField; 5] = [
    SolidField::Velocity(0),
    SolidField::Velocity(1),
    SolidField::Stress(0, 0),
    SolidField::Stress(1, 1),
    SolidField::Stress(0, 1),
];

/// Largest number of cell updates of a simulation.
const MAX_CELL_UPDATES: f64 = 5e8;
/// Fraction of the linear range of layers that the tractions of the initial state reach.
const LINEAR_RANGE_FRACTION: f64 = 1e-6;

/// Rectangular arrangement of equal blocks in a periodic grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BlockGrid {
    /// Cells of a block along each axis.
    pub cells_per_block: [usize; 2],
    /// Blocks along each axis.
    pub block_counts: [usize; 2],
    /// Cells by which every second row is shifted along x₁.
    pub row_shift: usize,
}

/// Location of a cell: column and row of its block, and indices of the cell in the block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CellLocation {
    /// Column and row; the column is −1 where a shifted row continues a block of the period before.
    pub block: [i64; 2],
    /// Indices of the cell in the block.
    pub cell: [usize; 2],
}

impl BlockGrid {
    pub(super) fn cells_per_axis(&self) -> [usize; 2] {
        [0, 1].map(|axis| self.cells_per_block[axis] * self.block_counts[axis])
    }

    pub(super) fn cell_count(&self) -> usize {
        self.cells_per_axis().into_iter().product()
    }

    /// Locates the cell with an index in the grid, first axis fastest.
    pub(super) fn locate_cell(&self, index: usize) -> CellLocation {
        let [width, _] = self.cells_per_axis();
        let [n1, n2] = self.cells_per_block.map(|count| count as i64);
        let (i, j) = ((index % width) as i64, (index / width) as i64);
        let row = j / n2;
        let i = i - if row % 2 == 1 { self.row_shift as i64 } else { 0 };
        CellLocation {
            block: [i.div_euclid(n1), row],
            cell: [i.rem_euclid(n1) as usize, (j % n2) as usize],
        }
    }

    /// Index of the lower neighbour of a cell along an axis in the periodic grid, and whether it is in the period
    /// before.
    pub(super) fn lower_neighbour(&self, index: usize, axis: usize) -> (usize, bool) {
        let [width, height] = self.cells_per_axis();
        match axis {
            0 if index.is_multiple_of(width) => (index + width - 1, true),
            0 => (index - 1, false),
            _ if index < width => (index + width * (height - 1), true),
            _ => (index - width, false),
        }
    }

    /// Builds the interlayers between the blocks, across each axis that has a law.
    pub(super) fn build_interlayers(&self, laws: &[Option<LayerLaw<f64>>; 2]) -> Vec<Interlayers> {
        let [width, height] = self.cells_per_axis();
        let across = |axis: usize| {
            let law = laws[axis]?;
            let lines = if axis == 0 { width } else { height };
            let faces = if axis == 0 { height } else { width };
            let has_layer = |line: usize, face: usize| {
                let index = if axis == 0 { line + width * face } else { face + width * line };
                self.locate_cell(index).cell[axis] == 0
            };
            let plane = |cell: usize| {
                let laws = (0..faces).map(|face| has_layer(cell, face).then_some(0));
                match PlaneLaws::from_faces(laws) {
                    PlaneLaws::Runs(runs) if runs.iter().all(|own| own.1.is_none()) => None,
                    laws => Some(InterlayerPlane { cell, laws }),
                }
            };
            Some(Interlayers {
                axis,
                laws: vec![InterlayerLaw::Plane(law, axis)],
                planes: (0..lines).filter_map(plane).collect(),
                has_open_ends: false,
            })
        };
        [0, 1].into_iter().filter_map(across).collect()
    }
}

/// Values of a wave at a face of cells, for one traction component of the layer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FaceMode {
    /// Mean velocity of both faces of the layer, m/s.
    pub velocity: Complex64,
    /// Opening rate, m/s.
    pub opening_rate: Complex64,
    /// Traction, Pa.
    pub stress: Complex64,
    /// Delayed traction S/(1 + iωτ), Pa, of the traction S and the retardation time τ.
    pub delayed_stress: Complex64,
}

impl FaceMode {
    pub(super) fn scale(self, factor: Complex64) -> Self {
        Self {
            velocity: self.velocity * factor,
            opening_rate: self.opening_rate * factor,
            stress: self.stress * factor,
            delayed_stress: self.delayed_stress * factor,
        }
    }
}

/// Complex fields of all cells and history variables of all faces.
#[derive(Clone, Debug)]
struct ComplexState {
    fields: Vec<Vec<Complex64>>,
    history: Vec<Complex64>,
}

/// Wave on a grid: a state, and the complex conjugate of the derivative of the energy at this state. The amplitude of
/// the wave in a state is the sum of products of both.
pub(super) struct WaveState {
    state: ComplexState,
    energy_gradient: ComplexState,
}

/// Values of a wave in a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellMode {
    /// Values of [`PLANE_FIELDS`].
    pub values: [Complex64; 5],
    /// Momentum densities, kg/(m²s), and strains: derivatives of the energy density by [`PLANE_FIELDS`].
    pub energy_gradient: [Complex64; 5],
}

impl WaveState {
    /// Assembles a wave from its values in each cell and the normal and tangential component at each face, scaled so
    /// that the layers remain in their linear range.
    pub(super) fn new(
        problem: &Problem<2>,
        layers: &[Option<LinearLayer>; 2],
        cell: impl Fn(usize) -> CellMode,
        face: impl Fn(&InterlayerFace) -> [FaceMode; 2],
    ) -> Self {
        let grid = problem.grid;
        let cells: Vec<CellMode> = (0..grid.count()).map(cell).collect();
        let fields = |value: &dyn Fn(&CellMode) -> [Complex64; 5]| -> Vec<Vec<Complex64>> {
            (0..5).map(|field| cells.iter().map(|own| value(own)[field]).collect()).collect()
        };
        let volume = grid.volume();
        let mut state = ComplexState { fields: fields(&|own| own.values), history: Vec::new() };
        let mut energy_gradient = ComplexState {
            fields: fields(&|own| own.energy_gradient.map(|value| value.conj() * volume)),
            history: Vec::new(),
        };
        let mut used_fraction: f64 = 0.0;
        for own in problem.interlayer_faces() {
            let Some(layer) = &layers[own.axis] else { continue };
            let modes = face(&own);
            let area = volume / grid.spacing[own.axis];
            state.history.resize(own.history.end, Complex64::ZERO);
            energy_gradient.history.resize(own.history.end, Complex64::ZERO);
            used_fraction = used_fraction.max(
                layer
                    .linear_range
                    .used_fraction(modes[0].stress.modulus(), modes[1].stress.modulus()),
            );
            let starts = [history::NORMAL_MOTION, history::SHEAR_MOTION];
            for (index, (component, mode)) in layer.components.iter().zip(modes).enumerate() {
                let mut set =
                    |place: usize, value: Complex64, weight: f64, conjugate: Complex64| {
                        state.history[own.history.start + place] = value;
                        energy_gradient.history[own.history.start + place] =
                            conjugate.conj() * (weight * area);
                    };
                let (velocity, rate) = (mode.velocity, mode.opening_rate);
                let mass = component.mass;
                set(starts[index], velocity, mass.mass, velocity);
                set(starts[index] + 1, rate, mass.opening_mass, rate);
                let compliance = component.compliance;
                // Normal traction, or strain of a porous layer.
                let strain = layer.strain_per_stress.filter(|_| index == 0).unwrap_or(1.0);
                let weight = compliance.elastic / strain;
                set(starts[index] + 2, mode.stress * strain, weight, mode.stress);
                if component.is_viscous() {
                    let delayed = mode.delayed_stress;
                    set(history::DELAYED_STRESS, delayed, compliance.delayed, delayed);
                }
            }
        }
        if used_fraction > 0.0 {
            let scale = LINEAR_RANGE_FRACTION / used_fraction;
            let all = state.fields.iter_mut().flatten().chain(&mut state.history);
            all.for_each(|value| *value *= scale);
        }
        Self { state, energy_gradient }
    }

    /// Measures the amplitudes of the wave in the solver, initially and after each `per_sample` steps, `samples` times,
    /// relative to the first. Real and imaginary part need two simulations, since the solver has real fields.
    pub(super) fn measure_amplitudes(
        &self,
        problem: &Problem<2>,
        samples: usize,
        per_sample: usize,
    ) -> Result<Vec<Complex64>, MeasurementError> {
        let updates = (samples * per_sample) as f64 * problem.grid.count() as f64;
        if updates > MAX_CELL_UPDATES {
            return Err(MeasurementError::TooManyUpdates {
                updates,
                max_updates: MAX_CELL_UPDATES,
            });
        }
        let mut sums = vec![Complex64::ZERO; samples + 1];
        #[allow(clippy::type_complexity, reason = "two pairs")]
        let parts: [(fn(&Complex64) -> f64, Complex64); 2] =
            [(|value| value.re, Complex64::ONE), (|value| value.im, Complex64::I)];
        for (part, factor) in parts {
            let mut domain = Domain::<f64, 2>::new(problem)?;
            for (field, values) in PLANE_FIELDS.into_iter().zip(&self.state.fields) {
                domain.set_field(field, &values.iter().map(part).collect::<Vec<f64>>());
            }
            let history: Vec<f64> = self.state.history.iter().map(part).collect();
            domain.set_interlayer_history(&mut history.into_iter());
            for (index, sum) in sums.iter_mut().enumerate() {
                if index > 0 {
                    (0..per_sample).for_each(|_| domain.advance());
                }
                *sum += factor * self.project_amplitude(&domain);
            }
        }
        let first = sums[0];
        let amplitudes: Vec<Complex64> = sums.into_iter().map(|sum| sum / first).collect();
        match amplitudes.iter().all(|own| own.is_finite() && own.modulus() > 0.0) {
            true => Ok(amplitudes),
            false => Err(MeasurementError::VanishingAmplitude),
        }
    }

    fn project_amplitude(&self, domain: &Domain<f64, 2>) -> Complex64 {
        let product = |energy_gradient: &[Complex64], values: Vec<f64>| -> Complex64 {
            energy_gradient
                .iter()
                .zip(values)
                .map(|(energy_gradient, value)| energy_gradient * value)
                .sum()
        };
        let fields = PLANE_FIELDS.into_iter().zip(&self.energy_gradient.fields);
        let of_cells: Complex64 = fields
            .map(|(field, energy_gradient)| {
                product(energy_gradient, domain.values(field).unwrap_or_default())
            })
            .sum();
        of_cells + product(&self.energy_gradient.history, domain.interlayer_history())
    }
}
