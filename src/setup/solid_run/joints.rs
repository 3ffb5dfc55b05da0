//! Creation of solver interlayers from the joints of a blocky medium.

use super::GridConverter;
use super::geometry::is_periodic;
use crate::Error;
use crate::case::dynamics::{BlockContact, Blocks, CourantWaves, JointEntry, JointSelector};
use crate::study::format::format_short;
use dynamics::solid::interlayers::{InterlayerLaw, InterlayerPlane, Interlayers, PlaneLaws};
use models::interface::layer::LayerLaw;
use models::interface::parameters::LayerMaterial;

/// Largest number of cells that waves of the fluid may pass in a step, as the solver requires.
const MAX_FLUID_CELLS: f64 = 2.0;

impl GridConverter<'_> {
    /// Creates the interlayers of the joints, one set for each axis that has joints normal to it, for steps of `step`, s.
    pub(super) fn create_interlayers(&self, step: f64) -> Result<Vec<Interlayers>, Error> {
        let Some(blocks) = self.solid_run.blocks.as_ref().filter(|own| own.has_joints()) else {
            return Ok(Vec::new());
        };
        if self.first_medium.pairs.iter().any(|pairs| pairs.len() != 2) {
            let found = "joints between blocks of a Cosserat solid";
            let allowed = "classical solids: a joint has no law for spins and couple stresses";
            return Err(self.solid_run.key_error("joint", found, allowed).into());
        }
        self.check_fluid_speeds(blocks, step)?;
        let laws: Vec<LayerLaw<f64>> =
            blocks.joint_laws().map(|own| own.material.to_law(own.mass)).collect();
        self.check_components(blocks, &laws)?;
        let by_axis = (0..2).map(|axis| Interlayers {
            axis,
            laws: laws.iter().map(|law| InterlayerLaw::Plane(*law, axis)).collect(),
            planes: self
                .create_periodic_joint_plane(blocks, axis)
                .into_iter()
                .chain(create_planes(blocks, axis))
                .collect(),
            has_open_ends: blocks.has_open_ends(axis),
        });
        Ok(by_axis.filter(|own| !own.planes.is_empty()).collect())
    }

    /// Checks that the components of all joints are independent if shear waves have longer steps than longitudinal ones.
    fn check_components(&self, blocks: &Blocks, laws: &[LayerLaw<f64>]) -> Result<(), Error> {
        let are_coupled = |law: &LayerLaw<f64>| law.normal_variable_count().is_none();
        match blocks.joint_laws().zip(laws).find(|(_, law)| are_coupled(law)) {
            Some((joint, _)) if self.solid_run.time.courant_waves == CourantWaves::Shear => {
                let found = format!("joints of the kind {}", joint.kind.name);
                let allowed = "expected joints whose normal and tangential components are independent: elastic, viscous or porous; else leave courant_of out";
                Err(self.solid_run.key_error("time.courant_of", found, allowed).into())
            }
            _ => Ok(()),
        }
    }

    /// Checks that waves of the fluid in saturated layers pass at most [`MAX_FLUID_CELLS`] cells in a step.
    fn check_fluid_speeds(&self, blocks: &Blocks, step: f64) -> Result<(), Error> {
        for contact in &blocks.contacts {
            let Some(joint) = contact.joint_index.map(usize::from) else { continue };
            let LayerMaterial::Saturated(layer) = &blocks.joints[joint].law.material else {
                continue;
            };
            let cells = layer.fluid_speed() * step / blocks.spacing[1 - contact.axis];
            if cells > MAX_FLUID_CELLS {
                let found = format!(
                    "found {:e}: waves of the fluid, {} m/s, pass {} cells in a step of {} s",
                    layer.fluid_stiffness,
                    format_short(layer.fluid_speed()),
                    format_short(cells),
                    format_short(step)
                );
                let bound = layer.fluid_stiffness * (MAX_FLUID_CELLS / cells).powi(2);
                let allowed = format!(
                    "expected at most {MAX_FLUID_CELLS} cells: at most {} Pa, or a smaller time.courant",
                    format_short(bound)
                );
                let key = format!("joint[{joint}].fluid_stiffness");
                return Err(self.solid_run.key_error(&key, found, allowed).into());
            }
        }
        Ok(())
    }

    /// Returns the joint law between the last and the first blocks along a periodic axis, if the case sets one for all
    /// faces normal to that axis; `None` otherwise.
    fn create_periodic_joint_plane(&self, blocks: &Blocks, axis: usize) -> Option<InterlayerPlane> {
        if !is_periodic(self.solid_run, axis) {
            return None;
        }
        let is_everywhere = |joint: &JointEntry| matches!(&joint.selector, JointSelector::FacesNormalTo { axes, inside: None } if axes[axis]);
        let law = blocks.joints.iter().rposition(is_everywhere)?;
        Some(InterlayerPlane { cell: 0, laws: PlaneLaws::Uniform(law as u16) })
    }
}

/// Returns the planes that contain joints normal to an axis, from the joints alone: no rank lists the faces of all cells.
fn create_planes(blocks: &Blocks, axis: usize) -> Vec<InterlayerPlane> {
    let is_own = |contact: &&BlockContact| contact.axis == axis && contact.joint_index.is_some();
    let mut joints: Vec<&BlockContact> = blocks.contacts.iter().filter(is_own).collect();
    joints.sort_by_key(|own| (own.plane_index, own.tangential_cells.start));
    let plane = |joints: &[&BlockContact]| {
        let mut end = 0;
        let mut runs = Vec::new();
        for joint in joints {
            let cells = &joint.tangential_cells;
            runs.push((cells.start - end, None));
            runs.push((cells.len(), joint.joint_index));
            end = cells.end;
        }
        runs.push((blocks.cells[1 - axis] - end, None));
        InterlayerPlane { cell: joints[0].plane_index, laws: PlaneLaws::from_runs(runs) }
    };
    joints.chunk_by(|one, other| one.plane_index == other.plane_index).map(plane).collect()
}
