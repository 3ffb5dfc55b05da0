//! State components of a solid and their names in case files.

use crate::kind::Kind;
use crate::schema::Scope;
use models::solid::parameters::Theory;
use models::solid::waves::{Field, fields};
use std::fmt;

/// A state component of a solid, e.g. `v1`, `w3`, `sigma12`, `m31`. The second index of a stress or couple stress is
/// the face normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Component(pub Field);

impl Component {
    /// Returns all components of a theory in 2 (plane strain) or 3 dimensions.
    pub fn all(theory: Theory, dimensions: usize) -> Vec<Self> {
        fields(theory, dimensions).into_iter().map(Self).collect()
    }

    /// Returns the components that a boundary load may prescribe on faces normal to `axis` (numbered from 0):
    /// velocities, spins, and the stresses and couple stresses that act on the face.
    pub fn on_side(theory: Theory, dimensions: usize, axis: usize) -> Vec<Self> {
        let acts = |component: &Self| match component.0 {
            Field::Velocity(_) => true,
            // Without couple stress no spin is transmitted across a face.
            Field::Spin(_) => theory == Theory::Cosserat,
            Field::Stress(i, j) => j == axis || (theory == Theory::Classical && i == axis),
            Field::Couple(_, j) => j == axis,
            Field::ViscousStrain(..) => false,
        };
        Self::all(theory, dimensions).into_iter().filter(acts).collect()
    }

    /// Returns whether the component is a velocity or a spin.
    pub const fn is_velocity(self) -> bool {
        matches!(self.0, Field::Velocity(_) | Field::Spin(_))
    }

    /// Returns the name of the time integral of a velocity or spin (displacement `u1`, rotation `phi3`); `None` for
    /// other components.
    pub fn integral(self) -> Option<String> {
        match self.0 {
            Field::Velocity(i) => Some(format!("u{}", i + 1)),
            Field::Spin(k) => Some(format!("phi{}", k + 1)),
            Field::Stress(..) | Field::Couple(..) | Field::ViscousStrain(..) => None,
        }
    }

    /// Finds the component `name` in the list `among`. In classical solids `sigma21` is a synonym of `sigma12`.
    pub fn find(name: &str, theory: Theory, among: &[Self]) -> Option<Self> {
        let is_named = |component: &&Self| {
            let transposed = match component.0 {
                Field::Stress(i, j) if theory == Theory::Classical => Field::Stress(j, i),
                field => field,
            };
            component.to_string() == name || Self(transposed).to_string() == name
        };
        among.iter().find(is_named).copied()
    }
}

/// Formats the component name of case files.
impl fmt::Display for Component {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Field::Velocity(i) => write!(formatter, "v{}", i + 1),
            Field::Spin(k) => write!(formatter, "w{}", k + 1),
            Field::Stress(i, j) => write!(formatter, "sigma{}{}", i + 1, j + 1),
            Field::Couple(k, j) => write!(formatter, "m{}{}", k + 1, j + 1),
            Field::ViscousStrain(i, j) => write!(formatter, "viscous_strain{}{}", i + 1, j + 1),
        }
    }
}

impl From<Field> for Component {
    fn from(field: Field) -> Self {
        Self(field)
    }
}

impl From<Component> for Field {
    fn from(component: Component) -> Self {
        component.0
    }
}

/// Returns the names of components in case files.
pub(super) fn names(components: &[Component]) -> Vec<String> {
    components.iter().map(Component::to_string).collect()
}

/// Returns the components of the solid of the case; if its theory is unknown, all components of a Cosserat solid.
pub(super) fn components(scope: &Scope) -> Vec<Component> {
    let theory = match scope.kind {
        Some(Kind::Solid(solid)) => solid.theory,
        _ => Theory::Cosserat,
    };
    Component::all(theory, scope.dimensions.unwrap_or(3))
}
