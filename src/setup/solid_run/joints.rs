//! Interlayers of the solver from the joints of a blocky medium.

use super::GridConverter;
use super::geometry::is_periodic;
use crate::Error;
use crate::case::dynamics::{Blocks, JointEntry, JointSelector};
use dynamics::solid::interlayers::{InterlayerLaw, InterlayerPlane, Interlayers, PlaneLaws};
use models::interface::layer::LayerLaw;

impl GridConverter<'_> {
    /// Creates the interlayers of the joints, one set per axis that has some.
    pub(super) fn create_interlayers(&self) -> Result<Vec<Interlayers>, Error> {
        let Some(blocks) = self.dynamics.blocks.as_ref().filter(|own| own.has_joints()) else {
            return Ok(Vec::new());
        };
        if self.medium.pairs.iter().any(|pairs| pairs.len() != 2) {
            let found = "joints between blocks of a Cosserat solid";
            let allowed = "classical solids: a joint has no law for spins and couple stresses";
            return Err(self.dynamics.error_at("joint", found, allowed).into());
        }
        let laws: Vec<LayerLaw<f64>> =
            blocks.joint_laws().map(|own| own.material.law(own.mass)).collect();
        let faces = blocks.compute_faces()?;
        let by_axis = (0..2).map(|axis| Interlayers {
            axis,
            laws: laws.iter().map(|law| InterlayerLaw::Plane(*law, axis)).collect(),
            planes: self
                .create_seam(blocks, axis)
                .into_iter()
                .chain(create_planes(blocks, axis, &faces[axis]))
                .collect(),
            has_open_ends: false,
        });
        Ok(by_axis.filter(|own| !own.planes.is_empty()).collect())
    }

    /// Returns the joints between the last and the first blocks along a periodic axis, those that all faces normal to
    /// the axis have; `None` without them.
    fn create_seam(&self, blocks: &Blocks, axis: usize) -> Option<InterlayerPlane> {
        if !is_periodic(self.dynamics, axis) {
            return None;
        }
        let is_everywhere = |joint: &JointEntry| matches!(&joint.selector, JointSelector::Every { axes, inside: None } if axes[axis]);
        let law = blocks.joints.iter().rposition(is_everywhere)?;
        Some(InterlayerPlane { cell: 0, laws: PlaneLaws::Uniform(law as u16) })
    }
}

/// Returns the planes with joints normal to an axis; `faces`: joint at the lower face of each cell.
fn create_planes(blocks: &Blocks, axis: usize, faces: &[Option<u16>]) -> Vec<InterlayerPlane> {
    let row = blocks.cells[0];
    let laws_at = |cell: usize| -> Vec<Option<u16>> {
        let lines = 0..blocks.cells[1 - axis];
        lines
            .map(|line| faces[if axis == 0 { cell + row * line } else { line + row * cell }])
            .collect()
    };
    let plane = |cell: usize| {
        let laws = laws_at(cell);
        let first = laws.iter().flatten().next()?;
        let laws = match laws.iter().all(|law| *law == Some(*first)) {
            true => PlaneLaws::Uniform(*first),
            false => PlaneLaws::ByFace(laws),
        };
        Some(InterlayerPlane { cell, laws })
    };
    (0..blocks.cells[axis]).filter_map(plane).collect()
}
