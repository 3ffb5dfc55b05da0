//! The numbers of a case, by section.

use models::parameter::Parameter as Constant;

/// The numbers of a case exactly as its file states them: SI units, angles in degrees, `None`
/// where a key without default is absent.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Numbers {
    /// Constants of flow models.
    pub flow: Constants,
    /// Constants of a solid.
    pub solid: SolidNumbers,
    /// Constants of its yield set.
    pub yields: YieldNumbers,
    /// Stress of a yielding solid.
    pub stress: StressNumbers,
    /// State of the flow at the point.
    pub background: BackgroundNumbers,
    /// Wave at which roots are listed.
    pub wave: Wave,
}

/// Values of constants by name, in the units of a case file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Constants(Vec<(&'static str, f64)>);

impl Constants {
    /// The value of that name.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.0.iter().find(|(own, _)| *own == name).map(|(_, value)| *value)
    }

    /// Sets a value.
    pub fn set(&mut self, name: &'static str, value: f64) {
        match self.0.iter_mut().find(|(own, _)| *own == name) {
            Some((_, own)) => *own = value,
            None => self.0.push((name, value)),
        }
    }

    /// Removes a value.
    pub(super) fn remove(&mut self, name: &str) {
        self.0.retain(|(own, _)| *own != name);
    }

    /// The values of a model's constants, in the order in which it lists them, in SI units and rad; NaN for those
    /// that are absent.
    pub fn in_order(&self, parameters: &[Constant], values: &mut Vec<f64>) {
        values.clear();
        let value = |own: &Constant| own.to_si(self.get(own.name).unwrap_or(f64::NAN));
        values.extend(parameters.iter().map(value));
    }
}

/// Section `[model]` of solids; units and meanings in [`keys`](crate::keys()).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // one row of `keys` per field says it once
pub struct SolidNumbers {
    pub lambda: f64,
    pub mu: f64,
    pub alpha: f64,
    pub beta: f64,
    pub gamma: f64,
    pub eta: f64,
    pub a1: f64,
    pub b1: f64,
    pub a2: f64,
    pub b2: f64,
    pub alpha2: f64,
    pub density: f64,
    pub inertia: f64,
    pub dimensions: usize,
}

/// Section `[yield]`; units and meanings in [`keys`](crate::keys()).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // one row of `keys` per field says it once
pub struct YieldNumbers {
    pub shear_strength: f64,
    pub shear_friction: f64,
    pub shear_dilatancy: f64,
    pub couple_strength: f64,
    pub couple_friction: f64,
    pub couple_dilatancy: f64,
    pub strength: f64,
    pub friction: f64,
    pub dilatancy: f64,
    pub antisymmetric_weight: f64,
    pub symmetric_length: f64,
    pub antisymmetric_length: f64,
    pub hardening: f64,
    pub plastic_rate: f64,
}

/// Section `[stress]`; units and meanings in [`keys`](crate::keys()).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // one row of `keys` per field says it once
pub struct StressNumbers {
    pub pressure: f64,
    pub deviatoric_stress: f64,
    pub stress_angle_deg: f64,
    pub out_of_plane_stress: f64,
    pub rotational_stress: f64,
    pub couple_stress: [f64; 2],
}

/// Section `[background]`; units and meanings in [`keys`](crate::keys()).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // one row of `keys` per field says it once
pub struct BackgroundNumbers {
    pub density: f64,
    pub pressure: f64,
    pub stress_angle_deg: f64,
    pub shear_rate: f64,
    pub velocity: [f64; 2],
    pub half_vorticity: f64,
    pub noncoaxiality_deg: Option<f64>,
    pub spin: Option<f64>,
    pub pressure_gradient: [f64; 2],
    pub stress_angle_gradient_deg: [f64; 2],
    pub density_gradient: [f64; 2],
    pub spin_gradient: [f64; 2],
    pub spin_acceleration: f64,
    pub inertia_rate: f64,
    pub inertia_gradient: [f64; 2],
    pub rotational_stress: Option<f64>,
    pub deviatoric_stress: Option<f64>,
    pub velocity_gradient: Option<[[f64; 2]; 2]>,
    pub acceleration: Option<[f64; 2]>,
    pub body_moment: Option<f64>,
    pub stress_angle_rate_deg: Option<f64>,
}

/// Section `[wave]`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wave {
    /// Wave number k, 1/m; positive.
    pub number: f64,
    /// Direction ψ_K of the wave vector, degrees anticlockwise from x₁.
    pub direction_deg: f64,
    /// Its angle above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
    /// Greatest wave number of dispersion curves, 1/m; 0 for what suits the solid.
    pub greatest_number: f64,
}
