//! Bloch problem of the periodic blocky medium of a case.

use crate::case::{Case, CaseError, PeriodicBlocks};
use analysis::bloch::BlochError;
use analysis::bloch::cell::{BlockRow, Cell, CellBlock, Joint};
use analysis::bloch::chain::{Chain, ChainElement, ChainPolarisation, LayerCompliance};
use models::interface::homogenised::{BlockyMedium, HomogenisedConstants};

/// Periodic blocky medium with its cell.
#[derive(Clone, Debug)]
pub struct BlochProblem {
    /// Blocks and joints of the case.
    pub blocks: PeriodicBlocks,
    /// Joints normal to x₁ and x₂, linearised.
    pub joints: [Joint; 2],
    /// Cell: one block, or two rows if rows are shifted.
    pub cell: Cell,
    /// Constants of the equivalent continuum under slow loads, or the reason why there is none.
    pub continuum: Result<HomogenisedConstants, String>,
}

impl BlochProblem {
    /// Creates the problem of a case.
    ///
    /// # Errors
    /// The case is not a periodic blocky medium (see [`Case::to_periodic_blocks`]), or its numbers are out of range.
    pub fn new(case: &Case) -> Result<Self, CaseError> {
        let blocks = case.to_periodic_blocks()?;
        let joints = [0, 1].map(|axis| {
            let law = &blocks.joints[axis];
            Joint::from_law(&law.material, law.mass)
        });
        let [width, height] = blocks.size;
        let block =
            CellBlock { width, material: blocks.material, right: joints[0], top: joints[1] };
        let row = |offset: f64| BlockRow { height, offset, blocks: vec![block] };
        let rows = match blocks.row_shift == 0.0 {
            true => vec![row(0.0)],
            false => vec![row(0.0), row(blocks.row_shift)],
        };
        let cell = Cell::new(rows).map_err(|error| match error {
            BlochError::Input(error) => case.locate_error(error),
            other => case.locate_error(models::InputError {
                input: "block",
                rejected_value: other.to_string(),
                allowed_values: "blocks and joints of finite stiffness and mass".into(),
            }),
        })?;
        let continuum = case
            .to_square_blocks()
            .map_err(|error| match error {
                CaseError::Key { key, found, allowed, .. } => format!("{key}: {found}; {allowed}"),
                other => other.to_string(),
            })
            .and_then(|square| {
                relax(&square.medium, &joints[0]).homogenise().map_err(|error| error.to_string())
            });
        Ok(Self { blocks, joints, cell, continuum })
    }

    /// Chain of a block and a joint along x₁, without joints across x₂; `None` if the rows are shifted or the joint is
    /// viscous in this component.
    pub fn chain(&self, polarisation: ChainPolarisation) -> Option<Chain> {
        let component = match polarisation {
            ChainPolarisation::Longitudinal => self.joints[0].normal,
            ChainPolarisation::Transverse => self.joints[0].tangential,
        };
        if self.blocks.row_shift != 0.0 || component.delay.is_some() {
            return None;
        }
        let compliance = LayerCompliance::new_elastic(1.0 / component.stiffness);
        Chain::new(vec![
            ChainElement::from_block(&self.blocks.material, self.blocks.size[0], polarisation),
            ChainElement::Layer { mass: component.mass, compliance },
        ])
        .ok()
    }
}

/// The medium with the shear stiffness of slow loads.
fn relax(medium: &BlockyMedium, joint: &Joint) -> BlockyMedium {
    let ratio = joint.relaxed().tangential.stiffness / joint.tangential.stiffness;
    let mut relaxed = *medium;
    relaxed.layer.shear_speed *= ratio.sqrt();
    relaxed
}
