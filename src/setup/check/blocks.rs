//! Plans of the checks of blocky media: periodic media formed by the blocks and joints of a case.

use super::CheckExtent;
use crate::case::dynamics::{BlockEntry, Blocks, JointEntry, MaterialPattern};
use crate::case::{Case, Material};
use crate::setup;
use agreement::blocks::{BlockSettings, BlockyCell, Layer, SolverBlocks};
use models::InputError;
use models::interface::homogenised::BlockMaterial;
use models::solid::parameters::Isotropic;

/// Number of cells of a block along each axis on each of the three grids, if rows are not shifted.
const BLOCK_CELLS_BY_GRID: [usize; 3] = [4, 8, 16];
/// Largest number of blocks in a period of the medium.
const MAX_BLOCKS_PER_PERIOD: usize = 4;
/// Largest number of cells of a block along an axis on the coarsest grid.
const MAX_COARSEST_CELLS_PER_BLOCK: usize = 12;

/// Periodic blocky medium, and the waves to be measured in it.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockyMediumPlan {
    /// Key of the section in the case, such as `block[0]`.
    pub section_key: String,
    /// Description of the blocks and of the layers in their joints.
    pub medium_title: String,
    /// Measurement to be made, or the reason why nothing is measured.
    pub experiment: Result<BlockyMediumExperiment, String>,
}

/// Measurement in a blocky medium: its description for analysis and solver, and the waves.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockyMediumExperiment {
    /// Medium as described to the analysis, which predicts the rates.
    pub analysis_medium: BlockyCell,
    /// Medium as described to the solver, which measures the rates.
    pub solver_medium: SolverBlocks,
    /// Waves to be measured, and solver settings.
    pub settings: BlockSettings,
}

/// Plans the checks of the blocky media of a case: each `[[block]]` gives the periodic medium of its copies, once for
/// each kind of joint between them. Empty without joints.
///
/// # Errors
/// A material is invalid.
pub(super) fn plan_blocks(
    case: &Case,
    extent: CheckExtent,
) -> Result<Vec<BlockyMediumPlan>, InputError> {
    let run = case.solid_run.as_ref();
    let Some(blocks) = run.and_then(|own| own.blocks.as_ref()).filter(|own| own.has_joints())
    else {
        return Ok(Vec::new());
    };
    let mut plans: Vec<BlockyMediumPlan> = Vec::new();
    for (index, entry) in blocks.entries.iter().enumerate() {
        let [across1, across2] = [0, 1].map(|axis| collect_distinct_joints(blocks, index, axis));
        let count = across1.len().max(across2.len());
        for joint_number in 0..count {
            let joints = [&across1, &across2].map(|own| {
                own.get(joint_number).or(own.last()).map(|&joint| &blocks.joints[joint])
            });
            for arrangement in create_arrangements(entry) {
                let plan = plan_blocky_medium(case, entry, (index, joints), &arrangement, extent)?;
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

/// Returns the indices of joints normal to an axis between two copies of the block `entry`, one joint for each law; if
/// there are none, of joints between a copy and other blocks.
fn collect_distinct_joints(blocks: &Blocks, entry: usize, axis: usize) -> Vec<usize> {
    let find = |sides: usize| {
        let mut found: Vec<usize> = Vec::new();
        for contact in blocks.contacts.iter().filter(|own| own.axis == axis) {
            let is_own = |block: &&usize| blocks.blocks[**block].entry_index == entry;
            let Some(joint) = contact.joint_index.map(usize::from) else { continue };
            let is_new = |other: &usize| blocks.joints[*other].law != blocks.joints[joint].law;
            if contact.block_indices.iter().filter(is_own).count() >= sides
                && found.iter().all(is_new)
            {
                found.push(joint);
            }
        }
        found
    };
    let own = find(2);
    if own.is_empty() { find(1) } else { own }
}

/// Arrangement of the blocks in a period: their number along each axis, and their materials row by row.
struct PeriodicArrangement<'a> {
    block_counts: [usize; 2],
    materials: Vec<&'a Material>,
}

/// Creates the periodic arrangements of the copies of a block. Copies of a list of materials, in shifted rows of
/// several materials, or of more than [`MAX_BLOCKS_PER_PERIOD`] blocks in a period are replaced by one arrangement for
/// each material.
fn create_arrangements(entry: &BlockEntry) -> Vec<PeriodicArrangement<'_>> {
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
    match period.filter(|[columns, rows]| columns * rows <= MAX_BLOCKS_PER_PERIOD) {
        Some([columns, rows]) => {
            let offsets = (0..rows).flat_map(|row| (0..columns).map(move |column| row + column));
            let materials = offsets.map(|offset| &all[offset % count]).collect();
            vec![PeriodicArrangement { block_counts: [columns, rows], materials }]
        }
        None => {
            let rows = if is_shifted { 2 } else { 1 };
            let new =
                |own| PeriodicArrangement { block_counts: [1, rows], materials: vec![own; rows] };
            all.iter().map(new).collect()
        }
    }
}

fn plan_blocky_medium(
    case: &Case,
    entry: &BlockEntry,
    (index, joints): (usize, [Option<&JointEntry>; 2]),
    arrangement: &PeriodicArrangement,
    extent: CheckExtent,
) -> Result<BlockyMediumPlan, InputError> {
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
    Ok(BlockyMediumPlan { section_key: format!("block[{index}]"), medium_title: title, experiment })
}

fn plan_experiment(
    case: &Case,
    entry: &BlockEntry,
    joints: [Option<&JointEntry>; 2],
    arrangement: &PeriodicArrangement,
    extent: CheckExtent,
) -> Result<Result<BlockyMediumExperiment, String>, InputError> {
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
    let Some(cells) = choose_cells_per_block(width, shift) else {
        let parts = width / greatest_common_divisor(width, shift);
        return Ok(Err(format!("rows shifted by parts of 1/{parts} of a block: too many cells")));
    };
    let is_short = extent == CheckExtent::Short;
    let courant = case.solid_run.as_ref().map(|own| own.time.courant_number);
    Ok(Ok(BlockyMediumExperiment {
        analysis_medium: BlockyCell {
            sides: [0, 1].map(|axis| entry.cells[axis] as f64 * entry.spacing[axis]),
            blocks: arrangement.block_counts,
            row_shift: shift as f64 / width as f64,
            materials,
            layers,
        },
        solver_medium: SolverBlocks {
            media,
            laws: joints.map(|own| own.map(|own| own.law.material.to_law(own.law.mass))),
        },
        settings: BlockSettings {
            branch_count: if is_short { 2 } else { 3 },
            phase_shift_count: if is_short { 1 } else { 4 },
            wave_vector_count: if is_short { 2 } else { 3 },
            cells_per_block: cells,
            courant_number: courant.unwrap_or(crate::case::dynamics::DEFAULT_COURANT_NUMBER),
        },
    }))
}

/// Returns the number of cells of a block along an axis on three grids, such that a row shift by `shift` of `width`
/// cells of the case is a whole number of cells; `None` if that takes more than [`MAX_COARSEST_CELLS_PER_BLOCK`] cells.
fn choose_cells_per_block(width: usize, shift: usize) -> Option<Vec<usize>> {
    let parts = if shift == 0 { 1 } else { width / greatest_common_divisor(width, shift) };
    let coarse = BLOCK_CELLS_BY_GRID[0].div_ceil(parts) * parts;
    let factors = BLOCK_CELLS_BY_GRID.map(|cells| cells / BLOCK_CELLS_BY_GRID[0]);
    (coarse <= MAX_COARSEST_CELLS_PER_BLOCK).then(|| factors.map(|factor| factor * coarse).to_vec())
}

fn greatest_common_divisor(one: usize, other: usize) -> usize {
    if other == 0 { one } else { greatest_common_divisor(other, one % other) }
}
