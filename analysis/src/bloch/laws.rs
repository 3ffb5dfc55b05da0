//! Joints of a cell from laws of layers, linearised about the undeformed state.

use super::cell::{BlockRow, Cell, CellBlock, Joint, JointComponent, JointDelay};
use models::interface::opening_line::LayerMass;
use models::interface::parameters::{LayerMaterial, MassDistribution};

impl Joint {
    /// Joint of a layer for waves of small amplitude about its undeformed state: no slip, pores open, cracks closed, fluid
    /// undrained and at rest along the layer ([`LayerMaterial::linearisation_note`]). Viscous shear δa₁ṡ = δ(S − s)/η:
    /// C₁ = δa₁, τ = ηa₁.
    pub fn from_law(law: &LayerMaterial, mass: MassDistribution) -> Self {
        let [normal, tangential] = law.stiffnesses();
        let [normal_mass, tangential_mass] = law.masses().map(|own| match mass {
            MassDistribution::Box => LayerMass::new_box(own),
            MassDistribution::Lumped => LayerMass::new_lumped(own),
        });
        let delay = law.delayed_shear().map(|viscous| JointDelay {
            compliance: law.thickness() * viscous.delayed_compliance,
            retardation_time: viscous.viscosity * viscous.delayed_compliance,
        });
        Self {
            normal: JointComponent { mass: normal_mass, stiffness: normal, delay: None },
            tangential: JointComponent { mass: tangential_mass, stiffness: tangential, delay },
        }
    }

    /// The joint under slow loads, with the stiffness 1/(1/K + C₁) in place of the delay.
    #[must_use]
    pub fn relaxed(&self) -> Self {
        let component = |own: JointComponent| JointComponent {
            stiffness: match own.delay {
                Some(delay) => 1.0 / (1.0 / own.stiffness + delay.compliance),
                None => own.stiffness,
            },
            delay: None,
            ..own
        };
        Self { normal: component(self.normal), tangential: component(self.tangential) }
    }

    /// The joint under fast loads, without its delay.
    #[must_use]
    pub const fn instantaneous(&self) -> Self {
        let normal = JointComponent { delay: None, ..self.normal };
        Self { normal, tangential: JointComponent { delay: None, ..self.tangential } }
    }

    /// Whether a component is viscous.
    pub const fn is_viscous(&self) -> bool {
        self.normal.delay.is_some() || self.tangential.delay.is_some()
    }
}

impl Cell {
    /// The cell with other joints.
    #[must_use]
    pub fn map_joints(&self, map: impl Fn(&Joint) -> Joint) -> Self {
        let block =
            |own: &CellBlock| CellBlock { right: map(&own.right), top: map(&own.top), ..*own };
        let row = |own: &BlockRow| BlockRow {
            blocks: own.blocks.iter().map(block).collect(),
            ..own.clone()
        };
        Self::from_checked_rows(self.rows().iter().map(row).collect())
    }

    /// Whether a joint is viscous: waves are damped.
    pub fn is_viscous(&self) -> bool {
        let mut blocks = self.rows().iter().flat_map(|row| &row.blocks);
        blocks.any(|block| block.right.is_viscous() || block.top.is_viscous())
    }
}
