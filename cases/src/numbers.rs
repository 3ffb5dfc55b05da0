//! Scalar numbers of a case, by section.

use models::common::parameter::{Parameter, Presence};

/// Scalar numbers of a case as given in its file: SI units, angles in degrees, `None` for an absent key without
/// default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CaseNumbers {
    /// Constants of the model.
    pub model_constants: ConstantValues,
    /// Number of dimensions of a solid; 0 if the kind of model fixes it.
    pub dimensions: usize,
    /// Constants of the yield set.
    pub yield_constants: ConstantValues,
    /// Plastic multiplier rate Λ of the background state of a yielding solid, 1/s.
    pub plastic_rate: f64,
    /// Stress of a yielding solid, section `[stress]`.
    pub stress: StressNumbers,
    /// State of a flow at a point, section `[background]`.
    pub background: BackgroundNumbers,
    /// Wave vector at which the roots of the dispersion relation are listed, section `[wave]`.
    pub wave: WaveNumbers,
    /// Parameters, then numbers of the background, of a model given as equations.
    pub equation_numbers: Vec<f64>,
}

/// Values of constants by name, in the units of a case file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConstantValues(Vec<(&'static str, f64)>);

impl ConstantValues {
    /// Returns the value of the constant `name`, if set.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.search_name(name).ok().map(|index| self.0[index].1)
    }

    /// Sets the constant `name`.
    pub fn set_value(&mut self, name: &'static str, value: f64) {
        match self.search_name(name) {
            Ok(index) => self.0[index].1 = value,
            Err(index) => self.0.insert(index, (name, value)),
        }
    }

    /// Finds a name by binary search: its index, or the insertion index as error.
    fn search_name(&self, name: &str) -> Result<usize, usize> {
        self.0.binary_search_by(|(own, _)| (*own).cmp(name))
    }

    /// Resets a constant to the default of `presence`; removes it if there is no default.
    pub(super) fn reset(&mut self, name: &'static str, presence: Presence) {
        match presence {
            Presence::Default(value) => self.set_value(name, value),
            _ => self.0.retain(|(own, _)| *own != name),
        }
    }

    /// Replaces the content of `values` by the values of the constants `parameters` of a model, in SI units and rad;
    /// NaN for absent constants.
    pub fn collect_si_values<'a>(
        &self,
        parameters: impl IntoIterator<Item = &'a Parameter>,
        values: &mut Vec<f64>,
    ) {
        values.clear();
        let value = |own: &Parameter| own.to_si(self.value(own.name).unwrap_or(f64::NAN));
        values.extend(parameters.into_iter().map(value));
    }
}

/// Section `[stress]`; units and meanings are in the table of [`keys`](crate::keys()).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // documented by the rows of `keys`
pub struct StressNumbers {
    pub pressure: f64,
    pub deviatoric_stress: f64,
    pub stress_angle_deg: f64,
    pub out_of_plane_stress: f64,
    pub rotational_stress: f64,
    pub couple_stress: [f64; 2],
}

/// Section `[background]`; units and meanings are in the table of [`keys`](crate::keys()).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[allow(missing_docs)] // documented by the rows of `keys`
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
pub struct WaveNumbers {
    /// Wave number k, 1/m; positive.
    pub wave_number: f64,
    /// Direction ψ_K of the wave vector, degrees anticlockwise from x₁.
    pub direction_deg: f64,
    /// Elevation of the wave vector above the plane of x₁ and x₂, degrees.
    pub elevation_deg: f64,
    /// Largest wave number of dispersion curves, 1/m; 0 for an automatic value.
    pub max_wave_number: f64,
}
