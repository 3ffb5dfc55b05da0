//! Range checks for the precision of the solver: products of constants neither overflow nor underflow; loads, sources
//! and initial values, multiplied by their profiles and time functions, exceed the flush-to-zero threshold unless they
//! are rotations, their energies do not underflow, and their stresses do not overflow in the return mapping.

use crate::Error;
use crate::case::dynamics::{
    FaceLoad, InitialStateTerm, JointLaw, LoadProfile, LoadedArea, PlanePulseInput, Precision,
    Samples, SolidRun, SourceKind, StateComponent, TimeFunction,
};
use crate::case::{Case, CaseError};
use crate::setup::solid;
use dynamics::medium::Medium;
use models::InputError;
use models::common::decimal::ToPlainText;
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use std::cell::RefCell;

/// Allowed ranges of constants and drives (loads, sources and initial values) for a precision.
struct PrecisionRange {
    precision_name: &'static str,
    /// Largest magnitude of a constant; the smallest nonzero magnitude is its inverse. Powers up to the third and
    /// products of a few moduli, inertias, impedances and strengths must be representable.
    max_constant: f64,
    /// Smallest nonzero and largest amplitude of a drive, in SI units. The smallest is far above the threshold below
    /// which the solver flushes decaying values to zero, and its square is a normal number: energies are summed in
    /// `f64`. The cube of the largest is finite: the return mapping multiplies stresses.
    amplitude_range: [f64; 2],
    /// Largest mass of a joint relative to the mass ZΔt of the layer that a wave crosses in a step Δt in a medium of
    /// impedance Z, both per area. A step changes the velocity of a heavier joint by so little that rounding errors,
    /// which add up over the steps, exceed about 10⁻³ of it.
    max_joint_mass: f64,
}

impl PrecisionRange {
    fn from_precision(precision: Precision) -> Self {
        match precision {
            Precision::F64 => Self {
                precision_name: "f64",
                max_constant: 1e90,
                amplitude_range: [1e-140, 1e90],
                max_joint_mass: 1e12,
            },
            Precision::F32 => Self {
                precision_name: "f32",
                max_constant: 1e15,
                amplitude_range: [1e-20, 1e12],
                max_joint_mass: 1e4,
            },
        }
    }

    fn contains_constant(&self, constant: f64) -> bool {
        is_within(constant, self.max_constant)
    }

    /// Returns whether a quotient or product of two constants, such as a stiffness, is in range.
    fn contains_product(&self, value: f64) -> bool {
        is_within(value, self.max_constant.powi(2))
    }
}

/// Returns whether a number is 0 or of a magnitude from 1/`max` to `max`.
fn is_within(number: f64, max: f64) -> bool {
    number == 0.0 || (1.0 / max..=max).contains(&number.abs())
}

/// Checks that the constants of all media are in the range of the precision.
///
/// # Errors
/// A constant is out of range.
pub(super) fn check_constants(case: &Case, solid_run: &SolidRun) -> Result<(), Error> {
    let range = PrecisionRange::from_precision(solid_run.scheme.precision);
    let materials = solid_run.materials();
    let own = materials.is_empty().then_some(&case.material);
    for material in own.into_iter().chain(materials) {
        let constants =
            solid::constants_by_name(material).map_err(|error| material.locate_error(error))?;
        if let Some((input, value)) =
            constants.into_iter().find(|own| !range.contains_constant(own.1))
        {
            let allowed = format!(
                "numbers from {:e} to {:e} in {}, in other units if need be",
                1.0 / range.max_constant,
                range.max_constant,
                range.precision_name
            );
            let found = value.to_plain_text();
            let error = InputError { input, rejected_value: found, allowed_values: allowed };
            return Err(material.locate_error(error).into());
        }
    }
    Ok(())
}

/// Checks that the constants of all joints, and their masses, stiffnesses and impedances, are in the range of the
/// precision, and that the masses are at most [`PrecisionRange::max_joint_mass`]; `step` is the time step Δt, s.
///
/// # Errors
/// A constant, mass, stiffness or impedance is out of range.
pub(super) fn check_joints(
    solid_run: &SolidRun,
    media: &[Medium],
    step: f64,
) -> Result<(), CaseError> {
    let Some(blocks) = &solid_run.blocks else { return Ok(()) };
    let range = PrecisionRange::from_precision(solid_run.scheme.precision);
    let [least_impedance, _] = impedance_range(media);
    for (index, law) in blocks.joint_laws().enumerate() {
        if let Some((key, found, allowed)) = find_joint_fault(&range, law, least_impedance * step) {
            let key = format!("joint[{index}]{key}");
            return Err(solid_run.key_error(&key, found, allowed));
        }
    }
    Ok(())
}

/// Returns the key within the joint, the value found and the values allowed of the first constant of a joint that is
/// out of range; `cell_mass`: the mass ZΔt, kg/m², to which that of the joint is compared.
fn find_joint_fault(
    range: &PrecisionRange,
    law: &JointLaw,
    cell_mass: f64,
) -> Option<(String, String, String)> {
    let PrecisionRange { precision_name: name, max_constant, max_joint_mass, .. } = *range;
    let allowed = |max: f64| format!("numbers from {:e} to {max:e} in {name}", 1.0 / max);
    let constants = law.kind.parameters.iter().zip(&law.constants);
    let mut constants = constants.filter_map(|(own, value)| Some((own.name, (*value)?)));
    if let Some((constant, value)) = constants.find(|own| !range.contains_constant(own.1)) {
        let units = ", in other units if need be";
        return Some((
            format!(".{constant}"),
            format!("found {value}", value = value.to_plain_text()),
            allowed(max_constant) + units,
        ));
    }
    for (mass, stiffness) in law.material.masses().into_iter().zip(law.material.stiffnesses()) {
        let impedance = mass.sqrt() * stiffness.sqrt();
        for (quantity, value, unit) in
            [("mass", mass, "kg/m²"), ("impedance √(mK)", impedance, "Pa·s/m")]
        {
            if !range.contains_constant(value) {
                let found = format!("found constants that give the {quantity} {value:.1e} {unit}");
                return Some((String::new(), found, allowed(max_constant)));
            }
        }
        if !range.contains_product(stiffness) {
            let found = format!("found constants that give the stiffness {stiffness:.1e} Pa/m");
            return Some((String::new(), found, allowed(max_constant.powi(2))));
        }
        let max_mass = max_joint_mass * cell_mass;
        if mass > max_mass {
            let found = format!("found constants that give the mass {mass:.1e} kg/m²");
            let allowed = format!(
                "at most {max_mass:.1e} kg/m² in {name}, {max_joint_mass:e} times the mass of the \
                 layer that a wave crosses in a step: rounding hides the motion of heavier joints"
            );
            return Some((String::new(), found, allowed));
        }
    }
    // All further constants of the law: compliances, fluidities, impedance and speed of the fluid.
    let all = RefCell::new(Vec::new());
    law.material.to_law(law.mass).map(|constant| all.borrow_mut().push(constant));
    let odd = all.into_inner().into_iter().find(|constant| !range.contains_product(*constant))?;
    let found = format!("found constants whose products or quotients reach {odd:.1e}");
    Some((String::new(), found, allowed(max_constant.powi(2))))
}

/// Returns the smallest and the largest impedance of all waves in all media, Pa·s/m.
fn impedance_range(media: &[Medium]) -> [f64; 2] {
    let pairs = media.iter().flat_map(|medium| medium.pairs.iter().flatten());
    pairs.fold([f64::INFINITY, 0.0], |[least, greatest], pair| {
        [least.min(pair.impedance()), greatest.max(pair.impedance())]
    })
}

/// Value of the case that drives the solid, and the tables that multiply it.
struct Drive<'a> {
    /// Entry of the case, such as `load[0]`.
    entry: String,
    field: SolidField,
    /// Amplitude of the field, in SI units; of a point load or source that of one face or cell.
    amplitude: f64,
    profile: Option<&'a LoadProfile>,
    time_function: Option<&'a TimeFunction>,
}

impl<'a> Drive<'a> {
    /// Returns the tables with their keys.
    fn tables(&self) -> Vec<(String, &'a Samples)> {
        let profile = self.profile.and_then(LoadProfile::samples);
        let time = self.time_function.and_then(TimeFunction::samples);
        let key = |samples: &Samples| match samples.source_file() {
            Some(_) => "time.file",
            None => "time.samples",
        };
        let profile = profile.map(|samples| ("profile.samples", samples));
        let tables = profile.into_iter().chain(time.map(|samples| (key(samples), samples)));
        tables.map(|(key, samples)| (format!("{}.{key}", self.entry), samples)).collect()
    }
}

/// Range of the amplitudes of all waves of a run.
pub(super) struct WaveRange<'a> {
    solid_run: &'a SolidRun,
    range: PrecisionRange,
    /// Smallest and largest impedance Z of all media.
    impedances: [f64; 2],
}

impl<'a> WaveRange<'a> {
    pub(super) fn new(solid_run: &'a SolidRun, media: &[Medium]) -> Self {
        let range = PrecisionRange::from_precision(solid_run.scheme.precision);
        Self { solid_run, range, impedances: impedance_range(media) }
    }

    /// Returns the smallest amplitude of |amplitude| and of the conjugate quantity in a wave, σ = Zv with the impedances
    /// Z of all media, and the largest amplitude of the stress.
    fn amplitudes_in_waves(&self, field: SolidField, amplitude: f64) -> [f64; 2] {
        let size = amplitude.abs();
        let [least, greatest] = self.impedances;
        let [low, high] = match field {
            SolidField::Velocity(_) | SolidField::Spin(_) => [size * least, size * greatest],
            _ => [size / greatest, size],
        };
        [size.min(low), size.max(high)]
    }

    /// Returns the amplitude in waves that is out of range; `None` if all are in range, or if the amplitude is 0.
    fn find_fault(&self, field: SolidField, amplitude: f64) -> Option<f64> {
        let [min, max] = self.range.amplitude_range;
        let [low, high] = self.amplitudes_in_waves(field, amplitude);
        match amplitude == 0.0 || (low >= min && high <= max) {
            true => None,
            false => Some(if low < min { low } else { high }),
        }
    }

    /// Creates the error at a key whose values `found` excite waves of amplitude `size`.
    fn wave_error(&self, key: &str, found: &str, size: f64) -> CaseError {
        let [min, max] = self.range.amplitude_range;
        let found = format!("found {found}: waves of {size:.1e} in SI units");
        let allowed =
            format!("waves from {min:e} to {max:e} in {}, or none", self.range.precision_name);
        self.solid_run.key_error(key, found, allowed)
    }

    /// Checks the amplitude of a drive, and its products with the profile and the time function.
    fn check_drive(&self, drive: &Drive) -> Result<(), CaseError> {
        let mut amplitude = drive.amplitude;
        let key = format!("{}.amplitude", drive.entry);
        if let Some(size) = self.find_fault(drive.field, amplitude) {
            return Err(self.wave_error(&key, &amplitude.to_plain_text(), size));
        }
        for (key, samples) in drive.tables() {
            let max = samples.max_magnitude();
            let found = format!(
                "values up to {max} times {amplitude}",
                max = max.to_plain_text(),
                amplitude = amplitude.to_plain_text()
            );
            amplitude *= max;
            if let Some(size) = self.find_fault(drive.field, amplitude) {
                return Err(self.wave_error(&key, &found, size));
            }
        }
        Ok(())
    }

    /// Checks that the sum of all loads and sources, as stresses, is at most the largest amplitude: their waves can meet.
    fn check_sum(&self, drives: &[Drive]) -> Result<(), CaseError> {
        let mut sum = 0.0;
        for drive in drives {
            let tables = drive.tables();
            let factor: f64 = tables.iter().map(|(_, samples)| samples.max_magnitude()).product();
            let [_, high] = self.amplitudes_in_waves(drive.field, drive.amplitude * factor);
            sum += high;
            if sum > self.range.amplitude_range[1] {
                let key = format!("{}.amplitude", drive.entry);
                let found = format!(
                    "{} and the loads and sources before it",
                    drive.amplitude.to_plain_text()
                );
                return Err(self.wave_error(&key, &found, sum));
            }
        }
        Ok(())
    }

    /// Checks that the initial state up to the term `initial[index]` is not too large; `max` is the largest magnitude of
    /// its values of `field`.
    pub(super) fn check_initial_values(
        &self,
        index: usize,
        field: SolidField,
        max: f64,
    ) -> Result<(), CaseError> {
        let [_, high] = self.amplitudes_in_waves(field, max);
        // The negated comparison refuses NaN, too.
        if high <= self.range.amplitude_range[1] {
            return Ok(());
        }
        let found = format!(
            "an initial state with {} up to {}",
            StateComponent(field),
            max.to_plain_text()
        );
        Err(self.wave_error(&format!("initial[{index}]"), &found, high))
    }

    /// Checks that gravity and the initial stress are not too large: the velocity that gravity gives to a free solid
    /// within the duration, and the stresses of all layers.
    pub(super) fn check_gravity_and_initial_stress(
        &self,
        acceleration: &[f64],
        layers: &[Stress],
    ) -> Result<(), CaseError> {
        let max = self.range.amplitude_range[1];
        let gravity_key = "gravity.acceleration";
        for pull in acceleration {
            let velocity = pull * self.solid_run.time.duration;
            let [_, high] = self.amplitudes_in_waves(SolidField::Velocity(0), velocity);
            if *pull != 0.0 && (high.is_nan() || high > max) {
                let found = format!(
                    "{pull}, a velocity of {velocity:.1e} m/s at the end",
                    pull = pull.to_plain_text()
                );
                return Err(self.wave_error(gravity_key, &found, high));
            }
        }
        for (component, value) in &self.solid_run.initial_stress {
            if value.abs() > max {
                let key = format!("initial_stress.{component}");
                return Err(self.wave_error(&key, &value.to_plain_text(), value.abs()));
            }
        }
        let components =
            layers.iter().flat_map(|own| own.force.iter().chain(&own.couple).flatten());
        match components.copied().find(|value| value.is_nan() || value.abs() > max) {
            Some(value) => {
                let found = format!("a weight that gives the stress {value:.1e} Pa");
                Err(self.wave_error(gravity_key, &found, value.abs()))
            }
            None => Ok(()),
        }
    }
}

/// Checks that the amplitudes of loads, sources and initial values other than rotations, and of the waves that they
/// excite, are 0 or within [`PrecisionRange::amplitude_range`], also multiplied by their profiles and time functions.
///
/// # Errors
/// An amplitude is too small or too large.
pub(super) fn check_amplitudes(range: &WaveRange) -> Result<(), CaseError> {
    let solid_run = range.solid_run;
    let loads = solid_run.loads.iter().enumerate().map(|(index, load)| Drive {
        entry: format!("load[{index}]"),
        field: load.component.0,
        amplitude: amplitude_per_face(solid_run, load),
        profile: load.profile.as_ref(),
        time_function: Some(&load.time_function),
    });
    let sources = solid_run.sources.iter().enumerate().map(|(index, source)| Drive {
        entry: format!("source[{index}]"),
        field: SolidField::Stress(0, 0),
        amplitude: compute_source_stress(&source.kind, &solid_run.grid.spacing),
        profile: None,
        time_function: Some(&source.time_function),
    });
    let drives: Vec<Drive> = loads.chain(sources).collect();
    drives.iter().try_for_each(|drive| range.check_drive(drive))?;
    range.check_sum(&drives)?;
    for (index, initial) in solid_run.initial_terms.iter().enumerate() {
        let (field, amplitude, time_function) = match initial {
            InitialStateTerm::Pulse { component: field, amplitude, .. }
            | InitialStateTerm::Uniform { component: field, amplitude, .. } => {
                (field.0, *amplitude, None)
            }
            InitialStateTerm::PlaneWave { amplitude, .. } => {
                (SolidField::Velocity(0), *amplitude, None)
            }
            InitialStateTerm::PlanePulse(PlanePulseInput { amplitude, waveform, .. }) => {
                (SolidField::Velocity(0), *amplitude, Some(waveform))
            }
            InitialStateTerm::Rotation { .. }
            | InitialStateTerm::RigidRotation { .. }
            | InitialStateTerm::Loosening { .. } => continue,
        };
        let entry = format!("initial[{index}]");
        range.check_drive(&Drive { entry, field, amplitude, profile: None, time_function })?;
    }
    Ok(())
}

/// Returns the largest component of a source as a stress, Pa, or couple stress, N/m, if one cell takes the whole
/// source: moments are divided by the cell volume, forces and couples by the largest face area.
fn compute_source_stress(kind: &SourceKind, spacing: &[f64]) -> f64 {
    let max_abs = |values: &[f64]| values.iter().fold(0.0f64, |max, value| max.max(value.abs()));
    let volume: f64 = spacing.iter().product();
    let min_spacing = spacing.iter().copied().fold(f64::INFINITY, f64::min);
    match kind {
        SourceKind::Force(values) | SourceKind::Couple(values) => {
            max_abs(values) * min_spacing / volume
        }
        SourceKind::Moment(rows) => {
            rows.iter().map(|row| max_abs(row)).fold(0.0, f64::max) / volume
        }
        SourceKind::Explosion(moment) => moment.abs() / volume,
    }
}

/// Returns the amplitude of a load on one face. The amplitude of a point load is an integral over the boundary, which
/// is divided by the face area.
fn amplitude_per_face(solid_run: &SolidRun, load: &FaceLoad) -> f64 {
    match load.loaded_area {
        LoadedArea::Point { .. } => {
            let axes = load.face.tangential_axes(solid_run.grid.dimensions());
            let area: f64 = axes.into_iter().map(|axis| solid_run.grid.spacing[axis]).product();
            load.amplitude / area
        }
        LoadedArea::WholeFace | LoadedArea::Rectangle(_) => load.amplitude,
    }
}
