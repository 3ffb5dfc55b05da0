//! A solid in the form that the sweeps require: wave pairs, rotation, relaxation and yield set.

use crate::solid::cell_laws::REFLECTION;
use crate::solid::contact_law::ContactLaw;
use models::common::elementary::Elementary;
use models::rheology::relaxation::StandardLinearSolid;
use models::solid::ElasticLaw;
use models::solid::parameters::Isotropic;
use models::solid::stress::Stress;
use models::solid::waves::{SolidField, SpinRotation, VelocityStressPair};
use models::yield_set::YieldSet;
use models::yield_set::projection::Projection;
use std::collections::BTreeMap;

/// A solid: wave pairs along the axes, spin rotation, relaxation and yield set.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// Velocities, spins and stresses: the fields of the state without [history variables](Self::history_fields).
    pub fields: Vec<SolidField>,
    /// Wave pairs by axis; all media of a theory have the same velocities and stresses in the same order.
    pub pairs: Vec<Vec<VelocityStressPair>>,
    /// Rotation that couples spins and antisymmetric stress.
    pub rotation: Option<SpinRotation>,
    /// Elastic law: relates stress, strain and stored energy.
    pub law: ElasticLaw,
    /// Relaxation of the stress deviator; the other constants of the medium are then those of the unrelaxed solid.
    pub relaxation: Option<StandardLinearSolid>,
    /// Yield set of the stress, with associated flow rule; dilatancy angles are not used.
    pub yield_set: Option<YieldSet>,
    /// Relaxation time τ of the overstress, s (Duvaut & Lions 1976): beyond the yield set σ̇ = C:ε̇ − (σ − Pσ)/τ with the
    /// projection P onto it. For a von Mises set it is a hinge parallel to a dashpot η, with τ = η/(2μc²) for τ² = c² s:s.
    /// `None`: plastic flow without viscosity.
    pub overstress_time: Option<f64>,
    /// Contact of particles or of the walls of pores; the elastic law is then that of closed contacts.
    pub contact: Option<ContactLaw>,
}

impl Medium {
    /// Creates an elastic solid in 2 (plane strain) or 3 dimensions. A law given by compliances is one of plane strain;
    /// its out-of-plane stresses remain zero.
    pub fn new(law: impl Into<ElasticLaw>, dimensions: usize) -> Self {
        let law = law.into();
        Self {
            fields: law.state_fields(dimensions),
            pairs: (0..dimensions).map(|axis| law.pairs(dimensions, axis)).collect(),
            rotation: law.rotation(),
            law,
            relaxation: None,
            yield_set: None,
            overstress_time: None,
            contact: None,
        }
    }

    /// Creates a medium with contacts in 2 (plane strain) or 3 dimensions.
    pub fn with_contact(contact: ContactLaw, dimensions: usize) -> Self {
        Self { contact: Some(contact), ..Self::new(contact.closed_solid(), dimensions) }
    }

    /// Creates a standard linear solid in 2 (plane strain) or 3 dimensions: waves propagate in the unrelaxed solid, and
    /// the stress deviator relaxes locally, with history variables.
    pub fn with_relaxation(solid: StandardLinearSolid, dimensions: usize) -> Self {
        Self { relaxation: Some(solid), ..Self::new(solid.unrelaxed(), dimensions) }
    }

    /// Returns the history variables of the law, which a domain stores after [`fields`](Self::fields): with relaxation
    /// one viscous strain per component of the symmetric stress, and those of a contact.
    pub fn history_fields(&self) -> Vec<SolidField> {
        let by_component = |create: fn(usize, usize) -> SolidField| {
            self.fields.iter().filter_map(move |field| match *field {
                SolidField::Stress(i, j) if i <= j => Some(create(i, j)),
                _ => None,
            })
        };
        let mut fields = Vec::new();
        if self.relaxation.is_some() {
            fields.extend(by_component(SolidField::ViscousStrain));
        }
        match self.contact {
            Some(
                contact @ (ContactLaw::Granular { .. }
                | ContactLaw::PorousCone { .. }
                | ContactLaw::PorousPlasticCone { .. }),
            ) => {
                fields.extend(by_component(SolidField::ExcessStress));
                if contact.damped_spring().is_some() {
                    fields.extend(by_component(SolidField::SpringStress));
                }
                if contact.plastic_spring_modulus().is_some() {
                    fields.extend(by_component(SolidField::PlasticStrain));
                }
            }
            Some(ContactLaw::Porous { .. }) => {
                fields.extend([SolidField::VolumetricStrain, SolidField::PoreClosure]);
            }
            None => {}
        }
        fields
    }

    /// Returns the fields of a state with these media: those of the media, then the history variables of all media.
    pub fn state_fields(media: &[Self]) -> Vec<SolidField> {
        let mut fields = media.first().map_or(Vec::new(), |medium| medium.fields.clone());
        for field in media.iter().flat_map(Self::history_fields) {
            if !fields.contains(&field) {
                fields.push(field);
            }
        }
        fields
    }

    /// Whether the medium can flow plastically: by a yield set, or by the yield stress of particles in contact.
    pub fn is_plastic(&self) -> bool {
        self.yield_set.is_some() || self.contact.is_some_and(|own| own.is_plastic())
    }

    /// Returns the work of a time step in a cell, in tenths of that in an elastic cell with the same fields. Ratios of the
    /// rates in BENCHMARKS.md, 1000² and 150³ cells, in which all cells are of one medium: yielding everywhere 1.1 to 1.3,
    /// granular 4 and porous media 2 times the work of the elastic solid. Relaxation has not been measured, and counts as
    /// elastic.
    pub fn relative_work(&self) -> u64 {
        match self.contact {
            Some(ContactLaw::Granular { .. }) => 40,
            Some(_) => 20,
            None if self.yield_set.is_some() => 12,
            None => 10,
        }
    }

    /// Whether stresses relax: in a standard linear solid, or by viscous particles in contact.
    pub fn relaxes(&self) -> bool {
        let has_viscous_particles =
            matches!(self.contact, Some(ContactLaw::Granular { particles: Some(_), .. }));
        self.relaxation.is_some() || has_viscous_particles
    }

    /// Returns the solid with a yield set, which must be admissible for the law.
    #[must_use]
    pub fn with_yield_set(self, set: impl Into<YieldSet>) -> Self {
        Self { yield_set: Some(set.into()), ..self }
    }

    /// Returns the solid with a relaxation time of the overstress, s; > 0.
    #[must_use]
    pub fn with_overstress_time(self, time: f64) -> Self {
        Self { overstress_time: Some(time), ..self }
    }

    /// Returns the weight of the stress itself in the return mapping of a step, s, or of a reflection: the part of the
    /// overstress that remains after it.
    pub(crate) fn mapping_weight(&self, reflects: bool, step: f64) -> f64 {
        match (reflects, self.overstress_time) {
            (true, _) => REFLECTION,
            (false, Some(time)) => (-step / time).cr_exp(),
            (false, None) => 0.0,
        }
    }

    /// Returns the largest wave speed, m/s.
    pub fn max_speed(&self) -> f64 {
        self.pairs.iter().flatten().map(VelocityStressPair::speed).fold(0.0, f64::max)
    }

    /// Computes the energy stored by a stress without viscous strain and without collapsed pores, J/m³.
    pub fn stored_energy(&self, stress: &Stress) -> f64 {
        match &self.contact {
            Some(ContactLaw::Porous { skeleton, .. }) => skeleton.stored_energy(stress),
            _ => self.law.stored_energy(stress),
        }
    }

    /// Returns the inertia of a velocity (ρ, kg/m³) or a spin (j, kg/m); 0 for all other fields.
    pub fn inertia(&self, field: SolidField) -> f64 {
        let wave_pair = self.pairs.iter().flatten().find(|pair| pair.velocity == field);
        match (wave_pair, field) {
            (Some(pair), _) => pair.inertia,
            // A spin without couple stress has no wave pair.
            (None, SolidField::Spin(_)) => self.law.inertia(),
            (None, _) => 0.0,
        }
    }

    /// Projects a trial stress onto the yield set in the energy norm; also returns the energy lost, J/m³. Without yield
    /// set the stress is unchanged.
    pub fn project(&self, trial: &Stress) -> Projection<Stress> {
        match &self.yield_set {
            Some(set) => set.project(&self.law, trial),
            None => Projection { stress: *trial, energy_lost: 0.0 },
        }
    }

    /// Projects the stress of a state onto the yield set. `values` are those of [`fields`](Self::fields), with total
    /// stresses; values beyond these fields are not changed.
    pub fn make_admissible(&self, values: &mut [f64]) {
        if self.yield_set.is_none() {
            return;
        }
        let mut stress = Stress::default();
        for (&field, &value) in self.fields.iter().zip(values.iter()) {
            match field {
                SolidField::Stress(i, j) => {
                    stress.force[i][j] = value;
                    // In classical solids one field represents both symmetric components.
                    if self.rotation.is_none() {
                        stress.force[j][i] = value;
                    }
                }
                SolidField::Couple(k, j) => stress.couple[k][j] = value,
                _ => {}
            }
        }
        let stress = self.project(&stress).stress;
        for (&field, value) in self.fields.iter().zip(values) {
            *value = stress_component(field, &stress).unwrap_or(*value);
        }
    }
}

/// Returns the component of a stress that a field represents; `None` for fields that are no stresses.
pub(crate) fn stress_component(field: SolidField, stress: &Stress) -> Option<f64> {
    match field {
        SolidField::Stress(i, j) => Some(stress.force[i][j]),
        SolidField::Couple(k, j) => Some(stress.couple[k][j]),
        _ => None,
    }
}

/// Computes the energy density of a medium as a quadratic form in the fields of a domain: two field indices and a
/// coefficient per term; coefficients of stresses follow from the stored energy of one and of two unit components.
/// Products of two stresses are omitted if their coefficient is only rounding.
fn energy_terms(medium: &Medium, fields: &[SolidField]) -> Vec<(usize, usize, f64)> {
    let is_symmetric = medium.rotation.is_none();
    let stress = |places: &[usize]| {
        let mut stress = Stress::default();
        for &place in places {
            match fields[place] {
                SolidField::Stress(i, j) => {
                    stress.force[i][j] = 1.0;
                    if is_symmetric {
                        stress.force[j][i] = 1.0;
                    }
                }
                SolidField::Couple(k, j) => stress.couple[k][j] = 1.0,
                _ => {}
            }
        }
        medium.stored_energy(&stress)
    };
    let history = |solid: &Isotropic, places: &[usize], value: fn(SolidField) -> HistoryStress| {
        let mut stress = Stress::default();
        for &place in places {
            if let Some((i, j, value)) = value(fields[place]) {
                stress.force[i][j] += value;
                stress.force[j][i] = stress.force[i][j];
            }
        }
        solid.stored_energy(&stress)
    };
    let mut terms = Vec::new();
    for (one, &field) in fields.iter().enumerate() {
        match field {
            SolidField::ViscousStrain(i, j) => {
                let modulus = medium.relaxation.map_or(0.0, |solid| solid.viscous_strain_modulus());
                // One field represents both off-diagonal components.
                terms.push((one, one, if i == j { modulus } else { 2.0 * modulus }));
            }
            SolidField::PoreClosure => {
                // The skeleton has the stress σ − k_bκδ: ½(σ − k_bκδ):a:(σ − k_bκδ) + ½k_bκ² with a:δ = δ/(3k_a).
                let Some(ContactLaw::Porous { law, .. }) = &medium.contact else { continue };
                let ratio = law.contact_modulus / law.skeleton_modulus;
                terms.push((one, one, 0.5 * law.contact_modulus * (1.0 + ratio)));
                let is_normal =
                    |own: &SolidField| matches!(own, SolidField::Stress(i, j) if i == j);
                let normal = fields.iter().enumerate().filter(|own| is_normal(own.1));
                terms.extend(normal.map(|(other, _)| (one, other, -ratio / 3.0)));
            }
            SolidField::ExcessStress(..) => {
                if let Some(solid) = medium.contact.and_then(|own| own.excess_solid()) {
                    let energy = |places: &[usize]| history(&solid, places, excess_stress);
                    add_quadratic_terms(&mut terms, one, energy);
                }
            }
            SolidField::PlasticStrain(..) => {
                let Some(contact) = &medium.contact else { continue };
                let constants = (contact.excess_solid(), contact.plastic_spring_modulus());
                let (Some(solid), Some(modulus)) = constants else { continue };
                // Terms of the stress 2μ_bεᵖ, which is of the size of the other one.
                let energy = |places: &[usize]| history(&solid, places, excess_stress);
                let mut own = Vec::new();
                add_quadratic_terms(&mut own, one, energy);
                let is_strain =
                    |place: usize| matches!(fields[place], SolidField::PlasticStrain(..));
                terms.extend(own.into_iter().map(|(one, other, factor)| {
                    let power = i32::from(is_strain(one)) + i32::from(is_strain(other));
                    (one, other, factor * modulus.powi(power))
                }));
            }
            SolidField::SpringStress(..) => {
                // ½b:(C⁻¹ − C*⁻¹):b with the stiffness C* of the closed solid.
                let Some(contact) = &medium.contact else { continue };
                let Some((_, spring)) = contact.damped_spring() else { continue };
                let closed = contact.closed_solid();
                add_quadratic_terms(&mut terms, one, |places| {
                    history(&spring, places, spring_stress)
                        - history(&closed, places, spring_stress)
                });
            }
            _ if medium.inertia(field) > 0.0 => {
                terms.push((one, one, 0.5 * medium.inertia(field)));
            }
            _ if !field.is_history() => add_quadratic_terms(&mut terms, one, stress),
            _ => {}
        }
    }
    terms.retain(|term| term.2 != 0.0);
    terms
}

/// Indices and value of a stress that a unit history variable contributes; `None` if it contributes none.
type HistoryStress = Option<(usize, usize, f64)>;

/// Returns the stress of a unit excess, or of a unit 2μ_bεᵖ, in the energy of an excess.
fn excess_stress(field: SolidField) -> HistoryStress {
    match field {
        SolidField::ExcessStress(i, j) => Some((i, j, 1.0)),
        SolidField::PlasticStrain(i, j) => Some((i, j, -1.0)),
        _ => None,
    }
}

/// Returns the unit stress of the spring of particles.
fn spring_stress(field: SolidField) -> HistoryStress {
    match field {
        SolidField::SpringStress(i, j) => Some((i, j, 1.0)),
        _ => None,
    }
}

/// Adds the square of a field, and its products with the fields before it, of an energy that is known for unit fields.
fn add_quadratic_terms(
    terms: &mut Vec<(usize, usize, f64)>,
    one: usize,
    energy: impl Fn(&[usize]) -> f64,
) {
    let square = energy(&[one]);
    terms.push((one, one, square));
    for other in 0..one {
        let product = energy(&[one, other]) - square - energy(&[other]);
        if product.abs() > 1e-14 * square {
            terms.push((one, other, product));
        }
    }
}

/// Computes the energy densities of media as quadratic forms in the fields of a domain: two field indices and one
/// coefficient per medium. Kinetic terms come first; their number is returned, too.
pub(crate) fn energy_terms_by_medium(
    media: &[Medium],
    fields: &[SolidField],
) -> (BTreeMap<[usize; 2], Vec<f64>>, usize) {
    let mut terms: BTreeMap<[usize; 2], Vec<f64>> = BTreeMap::new();
    for (index, medium) in media.iter().enumerate() {
        for (one, other, factor) in energy_terms(medium, fields) {
            let term = terms.entry([one, other]).or_insert_with(|| vec![0.0; media.len()]);
            term[index] = factor;
        }
    }
    // Velocities and spins are the first fields.
    let is_kinetic = |indices: &&[usize; 2]| media[0].inertia(fields[indices[0]]) > 0.0;
    let kinetic = terms.keys().filter(is_kinetic).count();
    (terms, kinetic)
}
