//! Laws of contacts after each sweep, cell by cell; see [`crate::solid::contact_law`].

use super::Reference;
use super::sweep::{GridLine, LineFields};
use crate::solid::contact_faces::separation::ExcessInvariants;
use crate::solid::contact_faces::{BOUNDARY_HISTORY, FaceContacts, FaceStencil};
use crate::solid::contact_law::{ContactLaw, ParticleRelaxation, TensorPlaces};
use crate::solid::domain::SolverReal;
use crate::solid::ghosts::BoundaryFaces;
use crate::solid::interlayers::with_pair_count;
use crate::solid::line::advance;
use crate::solid::medium::Medium;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::riemann::{InterfaceState, State};
use models::porous::PoreState;
use models::rheology::relaxation::SymmetricTensor;
use models::solid::waves::SolidField;

/// Fields of the laws of granular media, and of pores with contact by cone.
const STRESS_AND_EXCESS: [fn(usize, usize) -> SolidField; 2] =
    [SolidField::Stress, SolidField::ExcessStress];

impl<T: SolverReal, const D: usize> Reference<T, D> {
    /// Completes the elastic step of a sweep in all media with contacts.
    pub(super) fn apply_contact_laws(&mut self) {
        if !self.problem.has_contacts() {
            return;
        }
        for cell in 0..self.problem.grid.count() {
            let factor = T::from_f64(self.field_factor(cell));
            match self.medium(cell).contact {
                Some(ContactLaw::Granular { law, .. }) => {
                    let mut law = law.map(T::from_f64);
                    law.yield_stress = factor * law.yield_stress;
                    law.corner_pressure = factor * law.corner_pressure;
                    match D {
                        2 => self.complete_granular_step::<1>(cell, &law),
                        _ => self.complete_granular_step::<3>(cell, &law),
                    }
                }
                Some(ContactLaw::Porous { law, .. }) => {
                    let mut law = law.map(T::from_f64);
                    law.porosity = factor * law.porosity;
                    self.complete_pore_step(cell, &law);
                }
                Some(ContactLaw::PorousCone { law, .. }) => {
                    let mut law = law.map(T::from_f64);
                    law.offset = factor * law.offset;
                    match D {
                        2 => self.complete_cone_step::<1>(cell, &law),
                        _ => self.complete_cone_step::<3>(cell, &law),
                    }
                }
                Some(ContactLaw::PorousPlasticCone { law, .. }) => {
                    let law = law.map(T::from_f64).with_field_factor(factor);
                    match D {
                        2 => self.complete_plastic_cone_step::<1>(cell, &law),
                        _ => self.complete_plastic_cone_step::<3>(cell, &law),
                    }
                }
                None => {}
            }
        }
    }

    /// Relaxes the stresses of viscous particles in contact over a step.
    pub(super) fn relax_contacts(&mut self) {
        let step = self.problem.step;
        let relaxation = |medium: &Medium| {
            let law = medium.contact?.relaxation(step)?;
            Some(law.map(T::from_f64))
        };
        let laws: Vec<_> = self.problem.media.iter().map(relaxation).collect();
        if laws.iter().all(Option::is_none) {
            return;
        }
        for cell in 0..self.problem.grid.count() {
            let Some(law) = laws[usize::from(self.problem.cell_media[cell])] else { continue };
            let law = law.with_field_factor(T::from_f64(self.field_factor(cell)));
            match D {
                2 => self.relax_contact::<1>(cell, &law),
                _ => self.relax_contact::<3>(cell, &law),
            }
        }
    }

    fn relax_contact<const SHEAR_COUNT: usize>(
        &mut self,
        cell: usize,
        law: &ParticleRelaxation<T>,
    ) {
        const FIELDS: [fn(usize, usize) -> SolidField; 3] =
            [SolidField::Stress, SolidField::ExcessStress, SolidField::SpringStress];
        let (after, loss) = law.apply(self.tensors::<3, SHEAR_COUNT>(cell, FIELDS));
        self.store_tensors(cell, FIELDS, after);
        self.dissipation.viscous_dissipation[cell] += loss.to_f64();
    }

    /// Sweeps all wave pairs of a line with contacts.
    pub(super) fn sweep_line_with_contacts(
        &self,
        line: GridLine,
        line_fields: &mut [LineFields<T>],
    ) {
        let slopes = self.problem.scheme.slopes;
        let media: Vec<usize> =
            self.line_cells(line).map(|cell| usize::from(self.problem.cell_media[cell])).collect();
        let history = |field: SolidField| {
            let place = self.field_index(field)?;
            let values: Vec<T> =
                self.line_cells(line).map(|cell| self.fields[place][cell]).collect();
            Some(self.with_boundary_values(line, values))
        };
        let strain = history(SolidField::VolumetricStrain);
        let excess = |components: &[[usize; 2]]| -> Vec<Vec<T>> {
            let component = |&[i, j]: &[usize; 2]| history(SolidField::ExcessStress(i, j));
            components.iter().filter_map(component).collect()
        };
        let normal = excess(&[[0, 0], [1, 1], [2, 2]]);
        let shear = excess(&[[0, 1], [0, 2], [1, 2]]);
        let invariants = |cell: usize| {
            let squares = shear.iter().map(|own| own[cell] * own[cell]);
            ExcessInvariants::new(
                [normal[0][cell], normal[1][cell], normal[2][cell]],
                squares.fold(T::ZERO, |sum, square| sum + square),
            )
        };
        // Constants along rows already have the factors of the layer.
        let factors: Vec<T> = match line.axis + 1 == D {
            true => {
                self.line_cells(line).map(|cell| T::from_f64(self.field_factor(cell))).collect()
            }
            false => vec![T::ONE; media.len()],
        };
        let beside = |upper: usize| FaceContacts {
            porosity_factors: [factors[upper - 1], factors[upper]],
            volumetric_strain: strain.as_ref().map(|own| [own[upper - 1], own[upper]]),
            excess: self.problem.separates().then(|| [upper - 1, upper].map(invariants)),
        };
        let mut pairs = self.problem.media[0].pairs[line.axis].iter();
        let longitudinal = pairs.position(|pair| pair.is_longitudinal()).unwrap_or(0);
        // By face and pair, from the states before the sweep.
        let constants = match line.axis {
            0 if !self.contact_faces_by_layer.is_empty() => {
                &self.contact_faces_by_layer[line.cell(0) / self.problem.grid.cells[0]]
            }
            axis => &self.contact_faces[axis],
        };
        let solve = |upper: usize| {
            let contacts = std::array::from_fn(|i| &constants[media[upper - 2 + i]]);
            let states = |own: &LineFields<T>| {
                std::array::from_fn(|i| State {
                    velocity: own.velocity[upper - 2 + i],
                    stress: own.stress[upper - 2 + i],
                })
            };
            with_pair_count!(line_fields.len(), P => {
                let face: FaceStencil<'_, T, P> = FaceStencil {
                    states: std::array::from_fn(|pair| states(&line_fields[pair])),
                    cells: std::array::from_fn(|pair| {
                        std::array::from_fn(|i| &line_fields[pair].cells[upper - 2 + i])
                    }),
                    contacts,
                    longitudinal,
                };
                face.solve(&beside(upper), slopes).to_vec()
            })
        };
        let solutions: Vec<Vec<[InterfaceState<T>; 2]>> =
            (GHOSTS..=GHOSTS + line.count).map(solve).collect();
        for (pair, own) in line_fields.iter_mut().enumerate() {
            let LineFields { velocity, stress, cells, accounts } = own;
            let at_face =
                |_: [State<T>; 4], _: [&_; 4], upper: usize| solutions[upper - GHOSTS][pair];
            advance(velocity, stress, cells, at_face, Some(accounts));
        }
    }

    /// Returns the cells of a line, and for each of its ghosts the cell whose image it is.
    fn line_cells(&self, line: GridLine) -> impl Iterator<Item = usize> {
        let is_periodic =
            move |end: usize| matches!(self.boundaries[line.axis][end], BoundaryFaces::Periodic);
        let source = move |place: usize| {
            let (end, depth) = match place.checked_sub(GHOSTS) {
                None => (0, GHOSTS - 1 - place),
                Some(index) if index < line.count => return line.cell(index),
                Some(index) => (1, index - line.count),
            };
            let end = if is_periodic(end) { 1 - end } else { end };
            line.cell(line.index_from_end(end, depth))
        };
        (0..line.count + 2 * GHOSTS).map(source)
    }

    /// Sets the history variable of the ghosts beyond physical boundaries.
    fn with_boundary_values(&self, line: GridLine, mut values: Vec<T>) -> Vec<T> {
        let end = GHOSTS + line.count;
        for (boundary, ghosts) in
            self.boundaries[line.axis].iter().zip([0..GHOSTS, end..end + GHOSTS])
        {
            if matches!(boundary, BoundaryFaces::Physical(_)) {
                values[ghosts].fill(T::from_f64(BOUNDARY_HISTORY));
            }
        }
        values
    }

    /// Returns the places of a tensor; `None` if no medium has it.
    fn tensor_places(&self, create: fn(usize, usize) -> SolidField) -> Option<TensorPlaces> {
        TensorPlaces::find(&self.state_fields, create)
    }

    /// Returns tensors of a cell; zero if no medium has them.
    fn tensors<const COUNT: usize, const SHEAR_COUNT: usize>(
        &self,
        cell: usize,
        fields: [fn(usize, usize) -> SolidField; COUNT],
    ) -> [SymmetricTensor<T, SHEAR_COUNT>; COUNT] {
        fields.map(|create| match self.tensor_places(create) {
            Some(places) => places.read(|place| self.fields[place][cell]),
            None => SymmetricTensor::ZERO,
        })
    }

    /// Stores tensors of a cell that a medium has.
    fn store_tensors<const COUNT: usize, const SHEAR_COUNT: usize>(
        &mut self,
        cell: usize,
        fields: [fn(usize, usize) -> SolidField; COUNT],
        tensors: [SymmetricTensor<T, SHEAR_COUNT>; COUNT],
    ) {
        for (create, tensor) in fields.into_iter().zip(tensors) {
            let Some(places) = self.tensor_places(create) else { continue };
            let normal = places.normal.iter().zip(tensor.normal);
            for (&place, value) in normal.chain(places.shear.iter().zip(tensor.shear)) {
                self.fields[place][cell] = value;
            }
        }
    }

    fn complete_granular_step<const SHEAR_COUNT: usize>(
        &mut self,
        cell: usize,
        law: &models::granular_medium::GranularContact<T>,
    ) {
        let [stress, excess] = self.tensors::<2, SHEAR_COUNT>(cell, STRESS_AND_EXCESS);
        let step = law.complete_step(stress, excess);
        self.store_tensors(cell, STRESS_AND_EXCESS, [step.stress, step.excess]);
        if let Some(sum) = self.dissipation.plastic_dissipation.get_mut(cell) {
            *sum += step.plastic_dissipation.to_f64();
        }
        self.add_contact_loss(step.other_loss);
    }

    fn complete_cone_step<const SHEAR_COUNT: usize>(
        &mut self,
        cell: usize,
        law: &models::porous::PoreConeLaw<T>,
    ) {
        let [stress, excess] = self.tensors::<2, SHEAR_COUNT>(cell, STRESS_AND_EXCESS);
        let step = law.complete_step(stress, excess);
        self.store_tensors(cell, STRESS_AND_EXCESS, [step.stress, step.excess]);
        self.add_contact_loss(step.energy_loss);
    }

    fn complete_plastic_cone_step<const SHEAR_COUNT: usize>(
        &mut self,
        cell: usize,
        law: &models::porous::PlasticPoreConeLaw<T>,
    ) {
        const FIELDS: [fn(usize, usize) -> SolidField; 3] =
            [SolidField::Stress, SolidField::ExcessStress, SolidField::PlasticStrain];
        let [stress, excess, strain] = self.tensors::<3, SHEAR_COUNT>(cell, FIELDS);
        let step = law.complete_step(stress, excess, strain);
        self.store_tensors(cell, FIELDS, [step.stress, step.excess, step.plastic_strain]);
        if let Some(sum) = self.dissipation.plastic_dissipation.get_mut(cell) {
            *sum += step.plastic_dissipation.to_f64();
        }
        self.add_contact_loss(step.other_loss);
    }

    fn complete_pore_step(&mut self, cell: usize, law: &models::porous::PoreLaw<T>) {
        let normal = self.tensor_places(SolidField::Stress).expect("fields of the medium").normal;
        let place = |field| self.field_index(field).expect("a field of the medium");
        let history = [SolidField::VolumetricStrain, SolidField::PoreClosure].map(place);
        let [volumetric_strain, closure] = history.map(|place| self.fields[place][cell]);
        let [a, b, c] = normal.map(|place| self.fields[place][cell]);
        let before = PoreState { volumetric_strain, closure };
        let step = law.complete_step(T::THIRD * (a + b + c), before);
        for place in normal {
            let value = &mut self.fields[place][cell];
            *value = *value + step.mean_stress_change;
        }
        self.fields[history[0]][cell] = step.state.volumetric_strain;
        self.fields[history[1]][cell] = step.state.closure;
        self.add_contact_loss(step.energy_loss);
    }

    /// Adds an energy density, J/m³, to the numerical dissipation.
    fn add_contact_loss(&mut self, loss: T) {
        let volume = self.problem.grid.volume();
        self.work.numerical_dissipation.add(volume * loss.to_f64());
    }
}
