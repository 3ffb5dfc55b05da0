//! Bloch problem of the periodic blocky medium of a case.

use crate::case::{Case, CaseError, PeriodicBlocks};
use analysis::bloch::BlochError;
use analysis::bloch::cell::{BlockRow, Cell, CellBlock, Joint};
use analysis::bloch::chain::{Chain, ChainElement, ChainPolarisation, LayerCompliance};
use models::interface::homogenised::{BlockyMedium, HomogenisedConstants};

/// Periodic blocky medium, its periodic cell and its equivalent continuum, for the analysis of Bloch waves.
#[derive(Clone, Debug)]
pub struct BlochProblem {
    /// Blocks and joints of the case.
    pub periodic_blocks: PeriodicBlocks,
    /// Laws of the joints normal to x₁ and x₂, linearised about the initial state.
    pub joint_laws: [Joint; 2],
    /// Periodic cell: one block, or two rows of blocks if rows are shifted.
    pub periodic_cell: Cell,
    /// Constants of the equivalent continuum under slow loads, or the reason why there is none.
    pub continuum_constants: Result<HomogenisedConstants, String>,
}

impl BlochProblem {
    /// Creates the Bloch problem of a case.
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
        let block = CellBlock {
            width,
            material: blocks.material,
            right_joint: joints[0],
            top_joint: joints[1],
        };
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
                allowed_values: "expected blocks and joints of finite stiffness and mass".into(),
            }),
        })?;
        let continuum = case
            .to_square_blocks()
            .map_err(|error| match error {
                CaseError::Key { key, found, allowed, .. } => format!("{key}: {found}; {allowed}"),
                other => other.to_string(),
            })
            .and_then(|square| {
                with_slow_shear_stiffness(&square.medium, &joints[0])
                    .homogenise()
                    .map_err(|error| error.to_string())
            });
        Ok(Self {
            periodic_blocks: blocks,
            joint_laws: joints,
            periodic_cell: cell,
            continuum_constants: continuum,
        })
    }

    /// Creates the one-dimensional chain of a block and a joint along x₁, without joints normal to x₂; `None` if the
    /// rows are shifted or the joint is viscous in this component.
    pub fn create_chain(&self, polarisation: ChainPolarisation) -> Option<Chain> {
        let component = match polarisation {
            ChainPolarisation::Longitudinal => self.joint_laws[0].normal,
            ChainPolarisation::Transverse => self.joint_laws[0].tangential,
        };
        if self.periodic_blocks.row_shift != 0.0 || component.delay.is_some() {
            return None;
        }
        let compliance = LayerCompliance::new_elastic(1.0 / component.stiffness);
        Chain::new(vec![
            ChainElement::from_block(
                &self.periodic_blocks.material,
                self.periodic_blocks.size[0],
                polarisation,
            ),
            ChainElement::Layer { mass: component.mass, compliance },
        ])
        .ok()
    }
}

/// Returns the medium with the joint shear stiffness that applies under slow loads, i.e. after relaxation.
fn with_slow_shear_stiffness(medium: &BlockyMedium, joint: &Joint) -> BlockyMedium {
    let ratio = joint.relaxed().tangential.stiffness / joint.tangential.stiffness;
    let mut relaxed = *medium;
    relaxed.layer.shear_speed *= ratio.sqrt();
    relaxed
}
