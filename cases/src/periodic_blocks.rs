//! Periodic blocky medium of a case: copies of one block with one law of joints along each axis.

use super::case::Case;
use super::dynamics::{Blocks, JointLaw, SolidRun};
use super::error::CaseError;
use super::kind::ModelKind;
use super::material::Material;
use models::common::decimal::{format_distinct, format_exact};
use models::interface::homogenised::{BlockMaterial, BlockyMedium};
use models::registry;
use models::solid::parameters::Isotropic;

/// Periodic blocky medium: copies of one block in rows, with one law of joints on the faces normal to each axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PeriodicBlocks {
    /// Elastic material of the blocks.
    pub material: BlockMaterial,
    /// Side lengths of a block along each axis, m.
    pub size: [f64; 2],
    /// Number of blocks along each axis.
    pub count: [usize; 2],
    /// Shift along x₁ of every second row, m.
    pub row_shift: f64,
    /// Laws of the joints normal to x₁ and to x₂.
    pub joints: [JointLaw; 2],
    /// Whether the blocks have a yield set.
    pub has_yielding_blocks: bool,
}

/// Square blocks with the same joints along both axes.
#[derive(Clone, Debug, PartialEq)]
pub struct SquareBlocks {
    /// Constants of the blocks and elastic constants of the joints.
    pub medium: BlockyMedium,
    /// Law of the joints.
    pub joint: JointLaw,
    /// Number of blocks along each axis.
    pub count: [usize; 2],
}

/// Largest relative difference of the side lengths of a block that counts as square.
const SIDE_TOLERANCE: f64 = 1e-9;

impl Case {
    /// Returns whether the case is a blocky medium with joints: any two neighbouring blocks are separated by a joint.
    pub fn has_joints(&self) -> bool {
        self.blocks().is_some_and(Blocks::has_joints)
    }

    fn blocks(&self) -> Option<&Blocks> {
        self.solid_run.as_ref()?.blocks.as_ref()
    }

    /// Returns the case with the material of the first block as its material; without blocks the case itself.
    pub fn with_block_material(&self) -> Self {
        let mut case = self.clone();
        if let Some(first) = self.blocks().and_then(|blocks| blocks.materials.first()) {
            case.material = first.clone();
        }
        case
    }

    /// Returns the run and the blocks of a blocky medium.
    ///
    /// # Errors
    /// The case has no blocks; the message says how to add them.
    pub fn require_blocks(&self) -> Result<(&SolidRun, &Blocks), CaseError> {
        let found = self.solid_run.as_ref().zip(self.blocks());
        found.ok_or_else(|| {
            let allowed = "expected a blocky medium, a classical solid with [[block]] and [[joint]] in place of [grid]; \
                           start from one: wellposed cases show instant-rotation-elastic > blocks.toml";
            let (key, found) = match self.medium().kind {
                kind @ ModelKind::Flow(_) => ("model.kind", format!("found '{}', a flow", kind.name())),
                _ => ("block", "missing".to_owned()),
            };
            self.material.positions.key_error(key, found, allowed)
        })
    }

    /// Returns the periodic medium of a blocky case.
    ///
    /// # Errors
    /// The case has no blocks or no joints, several kinds of blocks or materials, blocks without joints along an axis,
    /// different joints along one axis, or blocks that are not classical elastic solids.
    pub fn to_periodic_blocks(&self) -> Result<PeriodicBlocks, CaseError> {
        let (run, blocks) = self.require_blocks()?;
        if let Some(second) = blocks.entries.get(1) {
            let name = second.name.as_deref().map_or(String::new(), |name| format!(" '{name}'"));
            let found = format!("found a second kind of block{name}");
            let allowed =
                "expected one kind of block, which repeats: a periodic medium; keep one [[block]]";
            return Err(run.key_error("block[1]", found, allowed));
        }
        let entry = &blocks.entries[0];
        if blocks.materials.len() > 1 {
            let found = format!("found {} materials", blocks.materials.len());
            let allowed = "expected blocks of one material: give model in place of materials";
            return Err(run.key_error("block[0].materials", found, allowed));
        }
        let joints = [joint_along(0, run, blocks)?, joint_along(1, run, blocks)?];
        let material = &blocks.materials[0];
        Ok(PeriodicBlocks {
            material: block_material(material)?,
            size: [0, 1].map(|axis| entry.cells[axis] as f64 * entry.spacing[axis]),
            count: entry.repeat,
            row_shift: entry.row_shift,
            joints,
            has_yielding_blocks: material.yield_set.is_some(),
        })
    }

    /// Returns the medium of a case with square elastic blocks and the same joints along both axes.
    ///
    /// # Errors
    /// An error of [`to_periodic_blocks`](Self::to_periodic_blocks); the blocks are not square, their rows are shifted,
    /// they yield, the joints differ, are saturated or have lumped masses.
    pub fn to_square_blocks(&self) -> Result<SquareBlocks, CaseError> {
        let own = self.to_periodic_blocks()?;
        let error = |path: &str, found: String, allowed: &str| match &self.solid_run {
            Some(run) => run.key_error(path, found, allowed),
            None => self.material.positions.key_error(path, found, allowed),
        };
        let [width, height] = own.size;
        if (width - height).abs() > SIDE_TOLERANCE * width {
            let found = {
                let [width, height] = format_distinct([width, height]);
                format!("found blocks of {width} m × {height} m")
            };
            let allowed = "expected square blocks, equal along both axes";
            return Err(error("block[0].cells", found, allowed));
        }
        if own.row_shift != 0.0 {
            let found = format!("found {} m", format_exact(own.row_shift));
            let allowed = "expected 0: the equivalent continuum is that of aligned rows";
            return Err(error("block[0].row_shift", found, allowed));
        }
        if own.has_yielding_blocks {
            let allowed = "expected elastic blocks: yielding of blocks is not in the interlayer yield set; \
                           leave [yield] out";
            return Err(error("yield.kind", "found blocks that yield".into(), allowed));
        }
        let [first, second] = own.joints;
        let joint_key = |axis: usize| {
            let joint = self.blocks().and_then(|blocks| first_joint(axis, blocks));
            format!("joint[{}]", joint.unwrap_or(0))
        };
        if first != second {
            let found = format!("found other values than in {}, normal to x1", joint_key(0));
            let allowed = "expected the same joints along both axes: the continuum of different joints is \
                           not supported; wellposed dispersion has their Bloch waves";
            return Err(error(&joint_key(1), found, allowed));
        }
        let Some(layer) = first.material.to_elastic_material() else {
            let found = format!("found {}", first.kind.name);
            let allowed =
                "expected elastic, elastic-plastic or breaking: the continuum has no fluid";
            return Err(error(&format!("{}.kind", joint_key(0)), found, allowed));
        };
        let medium = BlockyMedium { block: own.material, layer, period: width };
        Ok(SquareBlocks { medium, joint: first, count: own.count })
    }
}

/// Returns the index of the first joint normal to an axis.
fn first_joint(axis: usize, blocks: &Blocks) -> Option<u16> {
    blocks
        .contacts
        .iter()
        .filter(|contact| contact.axis == axis)
        .find_map(|contact| contact.joint_index)
}

/// Returns the law of all joints normal to an axis.
fn joint_along(axis: usize, run: &SolidRun, blocks: &Blocks) -> Result<JointLaw, CaseError> {
    let name = axis + 1;
    let Some(first) = first_joint(axis, blocks) else {
        let found = format!("found no joint normal to x{name}");
        let allowed = "expected joints between all blocks along both axes: add [[joint]] with every = \
                       \"all\", and repeat at least 2 along both axes";
        return Err(run.key_error("joint", found, allowed));
    };
    let law = &blocks.joints[usize::from(first)].law;
    for contact in blocks.contacts.iter().filter(|contact| contact.axis == axis) {
        match contact.joint_index {
            None => {
                let found = format!("found welded neighbours along x{name}");
                let allowed = "expected joints between all blocks: add every = \"all\"";
                return Err(run.key_error(&format!("joint[{first}]"), found, allowed));
            }
            Some(joint) if blocks.joints[usize::from(joint)].law != *law => {
                let found =
                    format!("found other values than in joint[{first}], also normal to x{name}");
                let allowed = "expected one law of joints along each axis: a periodic medium";
                return Err(run.key_error(&format!("joint[{joint}]"), found, allowed));
            }
            Some(_) => {}
        }
    }
    Ok(law.clone())
}

/// Returns the elastic material of the blocks: c₁ = √((λ + 2μ)/ρ), c₂ = √(μ/ρ).
fn block_material(material: &Material) -> Result<BlockMaterial, CaseError> {
    let not_classical = || {
        let found = format!("found {}", material.kind.name());
        let allowed = "expected classical: the blocks are classical elastic solids";
        material.positions.key_error("model.kind", found, allowed)
    };
    let ModelKind::Solid(kind) = material.kind else { return Err(not_classical()) };
    if kind != registry::CLASSICAL {
        return Err(not_classical());
    }
    let mut constants = Vec::new();
    material.numbers.model_constants.collect_si_values(kind.parameters, &mut constants);
    let law = kind.build_law(&constants).map_err(|error| material.locate_error(error))?;
    let Some(Isotropic { lambda, mu, density, .. }) = law.downcast::<Isotropic>() else {
        return Err(not_classical());
    };
    Ok(BlockMaterial {
        density: *density,
        longitudinal_speed: ((lambda + 2.0 * mu) / density).sqrt(),
        shear_speed: (mu / density).sqrt(),
    })
}
