//! State components of a solid and their names in case files.

use crate::kind::ModelKind;
use crate::schema::SchemaScope;
use models::solid::parameters::Theory;
use models::solid::waves::{SolidField, state_fields};
use std::fmt;

/// A state component of a solid, e.g. `v1`, `w3`, `sigma12`, `m31`. The second index of a stress or couple stress is
/// the face normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct StateComponent(pub SolidField);

impl StateComponent {
    /// Returns all components of a theory in 2 (plane strain) or 3 dimensions.
    pub fn all_components(theory: Theory, dimensions: usize) -> Vec<Self> {
        state_fields(theory, dimensions).into_iter().map(Self).collect()
    }

    /// Returns the history variables of a medium with contacts that outputs offer.
    pub const CONTACT_COMPONENTS: [Self; 2] =
        [Self(SolidField::VolumetricStrain), Self(SolidField::PoreClosure)];

    /// Returns the components that a boundary load may prescribe on faces normal to `axis` (numbered from 0):
    /// velocities, spins (in Cosserat solids with couple stress), and the stresses and couple stresses that act on the
    /// face.
    pub fn face_components(theory: Theory, dimensions: usize, axis: usize) -> Vec<Self> {
        let acts = |component: &Self| match component.0 {
            SolidField::Velocity(_) => true,
            // Without couple stress, i.e. in classical and reduced Cosserat solids, a load cannot prescribe a spin.
            SolidField::Spin(_) => theory == Theory::Cosserat,
            SolidField::Stress(i, j) => j == axis || (theory == Theory::Classical && i == axis),
            SolidField::Couple(_, j) => j == axis,
            SolidField::ViscousStrain(..)
            | SolidField::ExcessStress(..)
            | SolidField::SpringStress(..)
            | SolidField::PlasticStrain(..)
            | SolidField::VolumetricStrain
            | SolidField::PoreClosure => false,
        };
        Self::all_components(theory, dimensions).into_iter().filter(acts).collect()
    }

    /// Returns whether the component is a velocity or a spin.
    pub const fn is_velocity(self) -> bool {
        matches!(self.0, SolidField::Velocity(_) | SolidField::Spin(_))
    }

    /// Returns the name of the time integral of a velocity or spin (displacement `u1`, rotation `phi3`); `None` for
    /// other components.
    pub fn integral_name(self) -> Option<String> {
        match self.0 {
            SolidField::Velocity(i) => Some(format!("u{}", i + 1)),
            SolidField::Spin(k) => Some(format!("phi{}", k + 1)),
            _ => None,
        }
    }

    /// Finds the component `name` in the list `among`. In classical solids the order of the indices of a stress is
    /// arbitrary: `sigma21` is a synonym of `sigma12`.
    pub fn find_by_name(name: &str, theory: Theory, among: &[Self]) -> Option<Self> {
        let is_named = |component: &&Self| {
            let transposed = match component.0 {
                SolidField::Stress(i, j) if theory == Theory::Classical => SolidField::Stress(j, i),
                field => field,
            };
            component.to_string() == name || Self(transposed).to_string() == name
        };
        among.iter().find(is_named).copied()
    }
}

/// Formats the component name of case files.
impl fmt::Display for StateComponent {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            SolidField::Velocity(i) => write!(formatter, "v{}", i + 1),
            SolidField::Spin(k) => write!(formatter, "w{}", k + 1),
            SolidField::Stress(i, j) => write!(formatter, "sigma{}{}", i + 1, j + 1),
            SolidField::Couple(k, j) => write!(formatter, "m{}{}", k + 1, j + 1),
            SolidField::ViscousStrain(i, j) => {
                write!(formatter, "viscous_strain{}{}", i + 1, j + 1)
            }
            SolidField::ExcessStress(i, j) => {
                write!(formatter, "excess_stress{}{}", i + 1, j + 1)
            }
            SolidField::SpringStress(i, j) => {
                write!(formatter, "spring_stress{}{}", i + 1, j + 1)
            }
            SolidField::PlasticStrain(i, j) => {
                write!(formatter, "plastic_strain{}{}", i + 1, j + 1)
            }
            SolidField::VolumetricStrain => formatter.write_str("volumetric_strain"),
            SolidField::PoreClosure => formatter.write_str("pore_closure"),
        }
    }
}

impl From<SolidField> for StateComponent {
    fn from(field: SolidField) -> Self {
        Self(field)
    }
}

impl From<StateComponent> for SolidField {
    fn from(component: StateComponent) -> Self {
        component.0
    }
}

/// Returns the names of components in case files.
pub(super) fn component_names(components: &[StateComponent]) -> Vec<String> {
    components.iter().map(StateComponent::to_string).collect()
}

/// Returns the components of the solid of the case; if its theory is unknown, all components of a Cosserat solid.
pub(super) fn components_in_scope(scope: &SchemaScope) -> Vec<StateComponent> {
    let theory = match scope.kind {
        Some(ModelKind::Solid(solid)) => solid.theory,
        _ => Theory::Cosserat,
    };
    StateComponent::all_components(theory, scope.dimensions.unwrap_or(3))
}
