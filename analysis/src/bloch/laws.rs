//! Joints of a cell from the laws of layers, linearised about the undeformed state.

use super::cell::{BlockRow, Cell, CellBlock, Joint, JointComponent, JointDelay};
use models::interface::opening_line::LayerMass;
use models::interface::parameters::{LayerMaterial, MassDistribution};

impl Joint {
    /// Joint of a layer for waves of small amplitude about its undeformed state: no slip, pores open, cracks closed,
    /// fluid undrained and at rest along the layer ([`LayerMaterial::linearisation_note`]). Viscous shear δa₁ṡ = δ(S −
    /// s)/η: C₁ = δa₁, τ = ηa₁.
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

    /// Joint under slow loads: the stiffness 1/(1/K + C₁) replaces the stiffness K and the delayed compliance C₁.
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

    /// Joint under fast loads: without the delayed opening.
    #[must_use]
    pub const fn instantaneous(&self) -> Self {
        let normal = JointComponent { delay: None, ..self.normal };
        Self { normal, tangential: JointComponent { delay: None, ..self.tangential } }
    }

    /// Whether a component has a delayed opening.
    pub const fn is_viscous(&self) -> bool {
        self.normal.delay.is_some() || self.tangential.delay.is_some()
    }
}

impl Cell {
    /// Copy of the cell in which `map` replaces each joint.
    #[must_use]
    pub fn map_joints(&self, map: impl Fn(&Joint) -> Joint) -> Self {
        let block = |own: &CellBlock| CellBlock {
            right_joint: map(&own.right_joint),
            top_joint: map(&own.top_joint),
            ..*own
        };
        let row = |own: &BlockRow| BlockRow {
            blocks: own.blocks.iter().map(block).collect(),
            ..own.clone()
        };
        Self::from_checked_rows(self.rows().iter().map(row).collect())
    }

    /// Whether a joint is viscous, so that waves are damped.
    pub fn is_viscous(&self) -> bool {
        let mut blocks = self.rows().iter().flat_map(|row| &row.blocks);
        blocks.any(|block| block.right_joint.is_viscous() || block.top_joint.is_viscous())
    }
}
