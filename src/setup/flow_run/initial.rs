//! Initial perturbation of a flow simulation.

use crate::case::flow::{FlowPerturbation, FlowRun, HarmonicPerturbation, PerturbedField};
use crate::case::{CaseError, degrees_to_radians};
use dynamics::flow::FlowProblem;
use dynamics::flow::perturbation::{FourierMode, Lattice, generate_noise, plane_wave};
use files::npz::{ArrayValues, read_selected_arrays};
use models::flow::RotationKind;
use std::path::Path;

/// Maximum size of an archive of initial fields, given as a number of arrays with one `f64` per grid point;
/// [`MAX_ARCHIVE_OVERHEAD_BYTES`] bytes are added.
const MAX_ARCHIVE_ARRAYS: u64 = 64;
const MAX_ARCHIVE_OVERHEAD_BYTES: u64 = 1 << 20;

/// Initial perturbations of the evolving fields at the grid points, first axis fastest.
pub(crate) struct PerturbationFields {
    /// Perturbations of both velocity components, m/s.
    pub(crate) velocity: [Vec<f64>; 2],
    /// Perturbation of the spin, rad/s, or of the stress angle, rad; zero if neither evolves.
    pub(crate) internal_variable: Vec<f64>,
}

/// Sums all terms of the initial perturbation.
///
/// # Errors
/// The archive named by a term is unusable.
pub(crate) fn assemble_perturbation(
    run: &FlowRun,
    problem: &FlowProblem,
) -> Result<PerturbationFields, CaseError> {
    let lattice = Lattice { points: run.grid.points, lengths: run.grid.lengths };
    let zeros = || vec![0.0; run.grid.point_count()];
    let mut fields =
        PerturbationFields { velocity: [zeros(), zeros()], internal_variable: zeros() };
    for (index, part) in run.perturbation_terms.iter().enumerate() {
        match part {
            FlowPerturbation::Mode(wave) => {
                fields.add_waves(lattice, wave.field, &[to_fourier_mode(wave)], None)
            }
            FlowPerturbation::Packet { carrier: wave, centre: at, radius } => {
                let bell = lattice.evaluate_gaussian(*at, *radius);
                fields.add_waves(lattice, wave.field, &[to_fourier_mode(wave)], Some(&bell));
            }
            FlowPerturbation::Noise {
                field,
                min_wave_number: from,
                max_wave_number: to,
                amplitude,
                seed,
            } => {
                let waves = generate_noise(*from, *to, to_si(*field, *amplitude), *seed);
                fields.add_waves(lattice, *field, &waves, None);
            }
            FlowPerturbation::Uniform { field, amplitude } => {
                let amplitude = to_si(*field, *amplitude);
                fields.internal_variable.iter_mut().for_each(|value| *value += amplitude);
            }
            FlowPerturbation::File { path, checksum } => {
                fields.add_archive(run, problem, path, *checksum).map_err(|(found, allowed)| {
                    run.key_error(&format!("initial[{index}].path"), found, allowed)
                })?;
            }
        }
    }
    Ok(fields)
}

/// Converts an amplitude to the SI unit of its field: stress angles from degrees to rad; others are in SI units
/// already.
fn to_si(field: PerturbedField, amplitude: f64) -> f64 {
    if field == PerturbedField::StressAngle { amplitude.to_radians() } else { amplitude }
}

fn to_fourier_mode(own: &HarmonicPerturbation) -> FourierMode {
    plane_wave(own.mode, to_si(own.field, own.amplitude), degrees_to_radians(own.phase_deg))
}

impl PerturbationFields {
    /// Adds plane waves to a field, multiplied by the envelope if there is one; waves of the velocity are transverse.
    fn add_waves(
        &mut self,
        lattice: Lattice,
        field: PerturbedField,
        waves: &[FourierMode],
        envelope: Option<&[f64]>,
    ) {
        let add = |own: &mut [f64], values: Vec<f64>| {
            own.iter_mut().zip(values).for_each(|(own, value)| *own += value);
        };
        match field {
            PerturbedField::Velocity => {
                let velocity = lattice.evaluate_transverse(waves, envelope);
                self.velocity.iter_mut().zip(velocity).for_each(|(own, values)| add(own, values));
            }
            PerturbedField::Spin | PerturbedField::StressAngle => {
                add(&mut self.internal_variable, lattice.evaluate_scalar(waves, envelope));
            }
        }
    }

    /// Adds the perturbation stored in the NPZ archive `path`; the error holds the fault and the requirement on the
    /// archive.
    fn add_archive(
        &mut self,
        run: &FlowRun,
        problem: &FlowProblem,
        path: &str,
        checksum: u32,
    ) -> Result<(), (String, &'static str)> {
        const ARCHIVE_REQUIREMENT: &str =
            "an archive (NPZ) with v1, v2 and the field that evolves, such as fields.npz of a run";
        let unusable = |cause: &str| (format!("'{path}': {cause}"), ARCHIVE_REQUIREMENT);
        let points = run.grid.point_count();
        let most =
            MAX_ARCHIVE_OVERHEAD_BYTES + MAX_ARCHIVE_ARRAYS.saturating_mul(8 * points as u64);
        let bytes = files::read_regular_file_up_to(Path::new(path), most)
            .map_err(|error| unusable(&error.to_string()))?;
        if files::checksum(&bytes) != checksum {
            let allowed = "bring it back, or run the case again from the file that names it";
            return Err((format!("'{path}' has changed since the case was read"), allowed));
        }
        let is_wanted = |name: &str| ["v1", "v2", "w", "psi"].contains(&name);
        let arrays = read_selected_arrays(&bytes, is_wanted, points)
            .map_err(|error| unusable(&error.to_string()))?;
        let shape = [run.grid.points[1], run.grid.points[0]];
        let [v1, v2] = &mut self.velocity;
        // The archive contains spins or stress angles including their mean value, which is subtracted. Its velocities
        // are perturbations already.
        let internal_variable = match run.rotation {
            RotationKind::IntrinsicSpin => Some(("w", problem.spin)),
            RotationKind::StressAxes => Some(("psi", problem.stress_angle)),
            RotationKind::None | RotationKind::Free => None,
        };
        let internal_variable =
            internal_variable.map(|(name, mean)| (name, &mut self.internal_variable, mean));
        for (name, own, mean) in
            [("v1", v1, 0.0), ("v2", v2, 0.0)].into_iter().chain(internal_variable)
        {
            let array = arrays.iter().find(|array| array.name == name);
            let array = array.ok_or_else(|| unusable(&format!("no array {name}")))?;
            let ArrayValues::F64(values) = &array.values else {
                return Err(unusable(&format!("{name} has no numbers of 64 bits")));
            };
            if array.shape != shape {
                let found = format!("{name} is of shape {:?}, not {shape:?}", array.shape);
                return Err(unusable(&found));
            }
            if values.iter().any(|value| !value.is_finite()) {
                return Err(unusable(&format!("{name} is not finite everywhere")));
            }
            own.iter_mut().zip(values).for_each(|(own, value)| *own += value - mean);
        }
        Ok(())
    }
}
