//! Fields that follow from the state of media with contacts.

use super::{FieldQuantity, OutputFields};
use crate::case::dynamics::StateComponent;
use dynamics::contact_law::ContactLaw;
use dynamics::medium::Medium;
use models::solid::waves::SolidField;

/// Adds the volumetric strain tr ε = tr(σ + x)/(3(k_a + k_b)) of media whose pores have a contact by cone, from the stress
/// and its excess x, to the field of the volumetric strain, which is 0 in media without one.
///
/// Media with a contact by cone have no field of the porosity: shear dilates the contact, so that the volume of the pores
/// does not follow from tr ε alone.
pub(super) fn add_volumetric_strain(
    media: &[Medium],
    cell_media: &[u16],
    quantities: &mut Vec<FieldQuantity>,
) {
    let compliance = |medium: &Medium| match medium.contact {
        Some(
            ContactLaw::PorousCone { closed, .. } | ContactLaw::PorousPlasticCone { closed, .. },
        ) => 1.0 / (3.0 * closed.lambda + 2.0 * closed.mu),
        _ => 0.0,
    };
    let compliances: Vec<f64> = media.iter().map(compliance).collect();
    if compliances.iter().all(|own| *own == 0.0) {
        return;
    }
    let mut strains = vec![0.0; cell_media.len()];
    for axis in 0..3 {
        for field in [SolidField::Stress(axis, axis), SolidField::ExcessStress(axis, axis)] {
            let name = StateComponent(field).to_string();
            let Some(found) = quantities.iter().find(|own| own.name == name) else { return };
            for (cell, strain) in strains.iter_mut().enumerate() {
                let compliance = compliances[usize::from(cell_media[cell])];
                *strain += compliance * found.values[cell];
            }
        }
    }
    let name = StateComponent(SolidField::VolumetricStrain).to_string();
    match quantities.iter_mut().find(|own| own.name == name) {
        Some(found) => found.values.iter_mut().zip(strains).for_each(|(sum, own)| *sum += own),
        None => quantities.push(FieldQuantity::new(name, strains)),
    }
}

/// Computes the porosity θ₀ + tr ε − κ from the volumetric strain and the closure κ of the pores; 0 in media without
/// pores. `None` if no medium has pores.
pub(super) fn porosity(
    media: &[Medium],
    cell_media: &[u16],
    quantities: &[FieldQuantity],
) -> Option<FieldQuantity> {
    let values = |field: SolidField| {
        let name = StateComponent(field).to_string();
        Some(&quantities.iter().find(|own| own.name == name)?.values)
    };
    let strains = values(SolidField::VolumetricStrain)?;
    let closures = values(SolidField::PoreClosure)?;
    let porosity = |(cell, medium): (usize, &u16)| match media[usize::from(*medium)].contact {
        Some(ContactLaw::Porous { law, .. }) => law.porosity + strains[cell] - closures[cell],
        _ => 0.0,
    };
    let values = cell_media.iter().enumerate().map(porosity).collect();
    Some(FieldQuantity::new("porosity".to_owned(), values))
}

/// Estimates the largest strain of the fields: the size of a stress component relative to ρc², or of a velocity component to
/// c, with the density ρ and the largest speed c of the medium of a cell, which is the strain of a plane wave of that stress
/// or velocity. Values that are not a number do not count.
pub(super) fn find_largest_strain(media: &[Medium], fields: &OutputFields) -> f64 {
    let scales: Vec<[f64; 2]> = media
        .iter()
        .map(|medium| {
            let speed = medium.max_speed();
            [speed, medium.inertia(SolidField::Velocity(0)) * speed * speed]
        })
        .collect();
    let mut largest: f64 = 0.0;
    for quantity in &fields.quantities {
        let scale_index = match quantity.unit {
            "m/s" => 0,
            "Pa" => 1,
            _ => continue,
        };
        for (cell, value) in quantity.values.iter().enumerate() {
            let medium = fields.region_indices.get(cell).map_or(0, |index| usize::from(*index));
            let strain = scales.get(medium).map_or(0.0, |scale| value.abs() / scale[scale_index]);
            largest = largest.max(strain);
        }
    }
    largest
}
