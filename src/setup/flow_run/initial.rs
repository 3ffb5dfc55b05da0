//! Initial perturbation of a flow simulation.

use crate::case::flow::{Disturbed, FlowRun, Initial, Wave};
use crate::case::{CaseError, radians};
use dynamics::flow::Problem;
use dynamics::flow::perturbation::{Lattice, PlaneWave, noise, wave};
use files::npz::{Values, read_some};
use models::flow::RotationKind;
use std::path::Path;

/// Maximum size of an archive: this number of arrays of the grid plus [`LARGEST`] bytes.
const MAX_ARRAYS: u64 = 64;
const LARGEST: u64 = 1 << 20;

/// Perturbations at the grid points, first axis fastest.
pub(crate) struct Fields {
    /// Velocity perturbation, m/s.
    pub(crate) velocity: [Vec<f64>; 2],
    /// Perturbation of the spin, rad/s, or of the stress angle, rad; zero if neither evolves.
    pub(crate) inner: Vec<f64>,
}

/// Sums all parts of the initial perturbation.
///
/// # Errors
/// The archive named by a part is unusable.
pub(crate) fn fields(run: &FlowRun, problem: &Problem) -> Result<Fields, CaseError> {
    let lattice = Lattice { count: run.grid.cells, lengths: run.grid.lengths };
    let zeros = || vec![0.0; run.grid.count()];
    let mut fields = Fields { velocity: [zeros(), zeros()], inner: zeros() };
    for (index, part) in run.initial.iter().enumerate() {
        match part {
            Initial::Mode(wave) => fields.add(lattice, wave.field, &[of_wave(wave)], None),
            Initial::Packet { wave, at, radius } => {
                let bell = lattice.bell(*at, *radius);
                fields.add(lattice, wave.field, &[of_wave(wave)], Some(&bell));
            }
            Initial::Noise { field, from, to, amplitude, seed } => {
                let waves = noise(*from, *to, in_si(*field, *amplitude), *seed);
                fields.add(lattice, *field, &waves, None);
            }
            Initial::Uniform { field, amplitude } => {
                let amplitude = in_si(*field, *amplitude);
                fields.inner.iter_mut().for_each(|value| *value += amplitude);
            }
            Initial::File { path, checksum } => {
                fields.add_file(run, problem, path, *checksum).map_err(|(found, allowed)| {
                    run.locate(&format!("initial[{index}].path"), found, allowed)
                })?;
            }
        }
    }
    Ok(fields)
}

/// Converts an amplitude to SI units and rad.
fn in_si(field: Disturbed, amplitude: f64) -> f64 {
    if field == Disturbed::StressAngle { amplitude.to_radians() } else { amplitude }
}

fn of_wave(own: &Wave) -> PlaneWave {
    wave(own.mode, in_si(own.field, own.amplitude), radians(own.phase_deg))
}

impl Fields {
    /// Adds plane waves to a field, multiplied by the envelope if given.
    fn add(
        &mut self,
        lattice: Lattice,
        field: Disturbed,
        waves: &[PlaneWave],
        envelope: Option<&[f64]>,
    ) {
        let add = |own: &mut [f64], values: Vec<f64>| {
            own.iter_mut().zip(values).for_each(|(own, value)| *own += value);
        };
        match field {
            Disturbed::Velocity => {
                let velocity = lattice.transverse(waves, envelope);
                self.velocity.iter_mut().zip(velocity).for_each(|(own, values)| add(own, values));
            }
            Disturbed::Spin | Disturbed::StressAngle => {
                add(&mut self.inner, lattice.scalar(waves, envelope));
            }
        }
    }

    /// Adds the perturbation in an archive; the error holds the fault and the requirement.
    fn add_file(
        &mut self,
        run: &FlowRun,
        problem: &Problem,
        path: &str,
        checksum: u32,
    ) -> Result<(), (String, &'static str)> {
        const NEEDS: &str =
            "an archive (NPZ) with v1, v2 and the field that evolves, such as fields.npz of a run";
        let unusable = |cause: &str| (format!("'{path}': {cause}"), NEEDS);
        let points = run.grid.count();
        let most = LARGEST + MAX_ARRAYS.saturating_mul(8 * points as u64);
        let bytes = files::read_regular_within(Path::new(path), most)
            .map_err(|error| unusable(&error.to_string()))?;
        if files::checksum(&bytes) != checksum {
            let allowed = "bring it back, or run the case again from the file that names it";
            return Err((format!("'{path}' has changed since the case was read"), allowed));
        }
        let is_wanted = |name: &str| ["v1", "v2", "w", "psi"].contains(&name);
        let arrays =
            read_some(&bytes, is_wanted, points).map_err(|error| unusable(&error.to_string()))?;
        let shape = [run.grid.cells[1], run.grid.cells[0]];
        let [v1, v2] = &mut self.velocity;
        // The archive holds total values; the mean is subtracted.
        let inner = match run.rotation {
            RotationKind::IntrinsicSpin => Some(("w", problem.spin)),
            RotationKind::StressAxes => Some(("psi", problem.stress_angle)),
            RotationKind::None | RotationKind::Free => None,
        };
        let inner = inner.map(|(name, mean)| (name, &mut self.inner, mean));
        for (name, own, mean) in [("v1", v1, 0.0), ("v2", v2, 0.0)].into_iter().chain(inner) {
            let array = arrays.iter().find(|array| array.name == name);
            let array = array.ok_or_else(|| unusable(&format!("no array {name}")))?;
            let Values::F64(values) = &array.values else {
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
