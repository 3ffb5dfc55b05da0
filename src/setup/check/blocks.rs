//! Plans of the checks of blocky media: periodic media of the blocks and joints of a case.

use super::CheckExtent;
use crate::case::dynamics::{BlockEntry, Blocks, JointEntry, MaterialPattern};
use crate::case::{Case, Material};
use crate::setup;
use agreement::blocks::{BlockSettings, BlockyCell, Layer, SolverBlocks};
use models::InputError;
use models::interface::homogenised::BlockMaterial;
use models::solid::parameters::Isotropic;

/// Number of cells of a block along each axis, by grid, if rows are not shifted.
const CELLS: [usize; 3] = [4, 8, 16];
/// Largest number of blocks of a period.
const MAX_PERIOD: usize = 4;
/// Largest number of cells of a block on the coarsest grid.
const MAX_COARSE_CELLS: usize = 12;

/// Periodic blocky medium, and the waves to be measured in it.
#[derive(Clone, Debug, PartialEq)]
pub struct BlocksPlan {
    /// Key of the section in the case, such as `block[0]`.
    pub region_key: String,
    /// Layers and blocks in words.
    pub title: String,
    /// Experiment, or the reason why nothing is measured.
    pub experiment: Result<BlocksExperiment, String>,
}

/// Medium as described to the analysis and to the solver, and the waves.
#[derive(Clone, Debug, PartialEq)]
pub struct BlocksExperiment {
    /// Medium of the analysis.
    pub predicted: BlockyCell,
    /// Medium of the solver.
    pub measured: SolverBlocks,
    /// Waves and solver settings.
    pub settings: BlockSettings,
}

/// Plans the checks of the blocky media of a case: for each `[[block]]` the periodic medium of its copies, once for each
/// kind of joint that they have; empty without joints.
///
/// # Errors
/// A material is invalid.
pub(super) fn plan_blocks(case: &Case, extent: CheckExtent) -> Result<Vec<BlocksPlan>, InputError> {
    let run = case.solid_run.as_ref();
    let Some(blocks) = run.and_then(|own| own.blocks.as_ref()).filter(|own| own.has_joints())
    else {
        return Ok(Vec::new());
    };
    let mut plans: Vec<BlocksPlan> = Vec::new();
    for (index, entry) in blocks.entries.iter().enumerate() {
        let [across1, across2] = [0, 1].map(|axis| joints_of_entry(blocks, index, axis));
        let count = across1.len().max(across2.len());
        for number in 0..count {
            let joints = [&across1, &across2]
                .map(|own| own.get(number).or(own.last()).map(|&joint| &blocks.joints[joint]));
            for arrangement in arrangements(entry) {
                let plan = plan_medium(case, entry, (index, joints), &arrangement, extent)?;
                let is_known = plans.iter().any(|other| other.experiment == plan.experiment);
                if !is_known {
                    plans.push(plan);
                }
            }
        }
    }
    if extent == CheckExtent::Short {
        plans.truncate(1);
    }
    Ok(plans)
}

/// Returns joints of different laws between copies of a block, normal to an axis; without such, those with other blocks.
fn joints_of_entry(blocks: &Blocks, entry: usize, axis: usize) -> Vec<usize> {
    let find = |sides: usize| {
        let mut found: Vec<usize> = Vec::new();
        for contact in blocks.contacts.iter().filter(|own| own.axis == axis) {
            let is_own = |block: &&usize| blocks.blocks[**block].entry == entry;
            let Some(joint) = contact.joint.map(usize::from) else { continue };
            let is_new = |other: &usize| blocks.joints[*other].law != blocks.joints[joint].law;
            if contact.blocks.iter().filter(is_own).count() >= sides && found.iter().all(is_new) {
                found.push(joint);
            }
        }
        found
    };
    let own = find(2);
    if own.is_empty() { find(1) } else { own }
}

/// Blocks of a period along each axis, and the materials of these blocks, row by row.
struct Arrangement<'a> {
    blocks: [usize; 2],
    materials: Vec<&'a Material>,
}

/// Periodic arrangements of the copies of a block. Copies of a list of materials, in shifted rows of several materials,
/// or of more than [`MAX_PERIOD`] blocks in a period are replaced by one medium for each material.
fn arrangements(entry: &BlockEntry) -> Vec<Arrangement<'_>> {
    let all = &entry.materials;
    let count = all.len();
    let is_shifted = entry.row_shift > 0.0;
    let period = match entry.pattern {
        _ if count == 1 || is_shifted => None,
        MaterialPattern::Checkerboard => Some([count; 2]),
        MaterialPattern::Rows => Some([1, count]),
        MaterialPattern::Columns => Some([count, 1]),
        MaterialPattern::List => None,
    };
    match period.filter(|[columns, rows]| columns * rows <= MAX_PERIOD) {
        Some([columns, rows]) => {
            let places = (0..rows).flat_map(|row| (0..columns).map(move |column| row + column));
            let materials = places.map(|place| &all[place % count]).collect();
            vec![Arrangement { blocks: [columns, rows], materials }]
        }
        None => {
            let rows = if is_shifted { 2 } else { 1 };
            let new = |own| Arrangement { blocks: [1, rows], materials: vec![own; rows] };
            all.iter().map(new).collect()
        }
    }
}

fn plan_medium(
    case: &Case,
    entry: &BlockEntry,
    (index, joints): (usize, [Option<&JointEntry>; 2]),
    arrangement: &Arrangement,
    extent: CheckExtent,
) -> Result<BlocksPlan, InputError> {
    let sides = [0, 1].map(|axis| entry.cells[axis] as f64 * entry.spacing[axis]);
    let mut kinds: Vec<&str> = joints.iter().flatten().map(|own| own.law.kind.title).collect();
    kinds.dedup();
    let shift = (entry.row_shift / entry.spacing[0]).round() as usize;
    let title = format!(
        "blocks of {} × {} m{}, {}",
        sides[0],
        sides[1],
        if shift > 0 { " in shifted rows" } else { "" },
        kinds.join(" and ")
    );
    let experiment = plan_experiment(case, entry, joints, arrangement, extent)?;
    Ok(BlocksPlan { region_key: format!("block[{index}]"), title, experiment })
}

fn plan_experiment(
    case: &Case,
    entry: &BlockEntry,
    joints: [Option<&JointEntry>; 2],
    arrangement: &Arrangement,
    extent: CheckExtent,
) -> Result<Result<BlocksExperiment, String>, InputError> {
    let layers =
        joints.map(|own| own.map(|own| Layer { material: own.law.material, mass: own.law.mass }));
    if let Some(reason) = layers.iter().flatten().find_map(|own| own.linearise().err()) {
        return Ok(Err(reason.to_owned()));
    }
    let (mut materials, mut media) = (Vec::new(), Vec::new());
    for own in &arrangement.materials {
        let law = setup::solid::create_solid(own)?.elastic_law;
        let Some(Isotropic { density, microrotation: None, .. }) = law.downcast::<Isotropic>()
        else {
            return Ok(Err("blocks of solids other than classical isotropic ones".to_owned()));
        };
        let Some(solid) = law.downcast::<Isotropic>() else { continue };
        materials.push(BlockMaterial {
            density: *density,
            longitudinal_speed: ((solid.lambda + 2.0 * solid.mu) / density).sqrt(),
            shear_speed: (solid.mu / density).sqrt(),
        });
        // The waves are too weak for blocks to yield.
        let mut medium = setup::solid::create_medium(own, 2)?;
        medium.yield_set = None;
        media.push(medium);
    }
    let width = entry.cells[0];
    let shift = (entry.row_shift / entry.spacing[0]).round() as usize;
    let Some(cells) = grid_cells(width, shift) else {
        let parts = width / greatest_common_divisor(width, shift);
        return Ok(Err(format!("rows shifted by parts of 1/{parts} of a block: too many cells")));
    };
    let is_short = extent == CheckExtent::Short;
    let courant = case.solid_run.as_ref().map(|own| own.time.courant_number);
    Ok(Ok(BlocksExperiment {
        predicted: BlockyCell {
            sides: [0, 1].map(|axis| entry.cells[axis] as f64 * entry.spacing[axis]),
            blocks: arrangement.blocks,
            row_shift: shift as f64 / width as f64,
            materials,
            layers,
        },
        measured: SolverBlocks {
            media,
            laws: joints.map(|own| own.map(|own| own.law.material.law(own.law.mass))),
        },
        settings: BlockSettings {
            branches: if is_short { 2 } else { 3 },
            phase_shifts: if is_short { 1 } else { 4 },
            wave_vectors: if is_short { 2 } else { 3 },
            cells,
            courant_number: courant.unwrap_or(crate::case::dynamics::DEFAULT_COURANT_NUMBER),
        },
    }))
}

/// Cells of a block on three grids, on which a shift of `shift` of `width` cells is a whole number of cells.
fn grid_cells(width: usize, shift: usize) -> Option<Vec<usize>> {
    let parts = if shift == 0 { 1 } else { width / greatest_common_divisor(width, shift) };
    let coarse = CELLS[0].div_ceil(parts) * parts;
    let factors = CELLS.map(|cells| cells / CELLS[0]);
    (coarse <= MAX_COARSE_CELLS).then(|| factors.map(|factor| factor * coarse).to_vec())
}

fn greatest_common_divisor(one: usize, other: usize) -> usize {
    if other == 0 { one } else { greatest_common_divisor(other, one % other) }
}
