//! Bloch waves of a doubly periodic blocky medium in plane strain, by a Galerkin method.
//!
//! A cell H₁ × H₂ consists of rows of rectangular elastic blocks. Along every face a joint (interlayer) connects two
//! blocks. In each direction, normal and tangential, with the mean V and the difference d of the velocities of both
//! faces, it has kinetic energy ½mV² + ½nd² and elastic energy ½K times the square of the opening, per area. The
//! displacement of each block is a sum of products of Legendre polynomials of degree ≤ p in x₁ and x₂ (a spectral
//! element; no continuity is imposed, joints couple the blocks), and with u(x + a) = e^{−iκ·a}u(x) for lattice vectors
//! a the energies give
//!
//! ```text
//! K(κ) u = ω² M(κ) u,
//! ```
//!
//! with Hermitian K and positive definite M; with viscous joints a first-order system with complex ω. By the principle
//! of Rayleigh and Ritz every ω² decreases to its exact value as p increases; [`Cell::solve`] raises p until the
//! frequencies no longer change.
//!
//! For a nonlinear law the stiffness of the joint is the tangent stiffness of its state: zero for an open crack, that
//! of open or collapsed pores for porous layers. It may be negative; if some ω² < 0 the state is unstable.

mod assembly;
mod damped;
pub mod legendre;
mod modes;

pub use assembly::CellModel;
pub use damped::DampedModes;
pub use modes::{BlochModes, ConvergedModes, DegreeControl};

use super::{BlochError, ensure};
use models::interface::elastic::ElasticMaterial;
use models::interface::homogenised::{BlockMaterial, BlockyMedium};
use models::interface::opening_line::LayerMass;

/// Law of a joint for one traction component, normal or tangential.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointComponent {
    /// Mass per area, kg/m².
    pub mass: LayerMass<f64>,
    /// Stiffness K, Pa/m: traction per opening; the instantaneous stiffness of a viscous joint.
    pub stiffness: f64,
    /// Delayed opening of a viscous joint.
    pub delay: Option<JointDelay>,
}

/// Delayed part e of the opening d of a viscous joint under the traction S: τė + e = C₁S and S = K(d − e) (standard
/// linear solid).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointDelay {
    /// Delayed compliance C₁, m/Pa; positive.
    pub compliance: f64,
    /// Retardation time τ, s; positive.
    pub retardation_time: f64,
}

/// Joint (interlayer) between two blocks: linear law of both traction components.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Law of the traction normal to the face.
    pub normal: JointComponent,
    /// Law of the traction along the face.
    pub tangential: JointComponent,
}

impl Joint {
    /// Joint of an elastic layer, with the mass distributed as in the box scheme or lumped.
    pub fn from_layer(material: &ElasticMaterial, is_lumped: bool) -> Self {
        let mass = match is_lumped {
            true => LayerMass::new_lumped(material.mass()),
            false => LayerMass::new_box(material.mass()),
        };
        Self {
            normal: JointComponent {
                mass,
                stiffness: 1.0 / material.normal_compliance(),
                delay: None,
            },
            tangential: JointComponent {
                mass,
                stiffness: 1.0 / material.tangential_compliance(),
                delay: None,
            },
        }
    }

    fn check(&self) -> Result<(), BlochError> {
        for JointComponent { mass: LayerMass { mass, opening_mass }, stiffness, delay } in
            [self.normal, self.tangential]
        {
            let is_nonnegative = |x: f64| x >= 0.0 && x.is_finite();
            ensure(is_nonnegative(mass), "mass", mass, "at least 0")?;
            ensure(is_nonnegative(opening_mass), "opening_mass", opening_mass, "at least 0")?;
            let allowed = "a finite number; blocks that are welded are one block";
            ensure(stiffness.is_finite(), "stiffness", stiffness, allowed)?;
            if let Some(JointDelay { compliance, retardation_time }) = delay {
                let is_positive = |x: f64| x > 0.0 && x.is_finite();
                ensure(is_positive(stiffness), "stiffness", stiffness, "positive if viscous")?;
                ensure(is_positive(compliance), "delayed_compliance", compliance, "positive")?;
                let is_valid = is_positive(retardation_time);
                ensure(is_valid, "retardation_time", retardation_time, "positive")?;
            }
        }
        Ok(())
    }
}

/// Block of a cell with the joints on its faces of greater x₁ and x₂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellBlock {
    /// Side along x₁, m.
    pub width: f64,
    /// Elastic material.
    pub material: BlockMaterial,
    /// Joint to the next block of the row, on the face normal to x₁.
    pub right_joint: Joint,
    /// Joint to the blocks of the next row, on the face normal to x₂.
    pub top_joint: Joint,
}

/// Row of blocks along x₁.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockRow {
    /// Side of the blocks along x₂, m.
    pub height: f64,
    /// Coordinate x₁ of the left face of the first block, m; different in neighbouring rows of masonry.
    pub offset: f64,
    /// Blocks in the order of x₁.
    pub blocks: Vec<CellBlock>,
}

/// Period of a doubly periodic blocky medium.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    rows: Vec<BlockRow>,
}

/// Largest allowed difference in width between rows, relative to the width.
const WIDTH_TOLERANCE: f64 = 1e-12;

impl Cell {
    /// Creates a cell from its rows in the order of x₂.
    ///
    /// # Errors
    /// There is no block; a length, material or joint is rejected; rows differ in width.
    pub fn new(rows: Vec<BlockRow>) -> Result<Self, BlochError> {
        ensure(!rows.is_empty(), "rows", "no row", "at least one row of blocks")?;
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        for row in &rows {
            ensure(is_positive(row.height), "height", row.height, "a positive number")?;
            ensure(row.offset.is_finite(), "offset", row.offset, "a finite number")?;
            ensure(!row.blocks.is_empty(), "blocks", "an empty row", "at least one block")?;
            for block in &row.blocks {
                ensure(is_positive(block.width), "width", block.width, "a positive number")?;
                block.material.check()?;
                block.right_joint.check()?;
                block.top_joint.check()?;
            }
        }
        let cell = Self { rows };
        let [width, _] = cell.periods();
        for row in &cell.rows {
            let other = row.width();
            let is_same = (other - width).abs() <= WIDTH_TOLERANCE * width;
            ensure(is_same, "width", other, "rows of the same width")?;
        }
        Ok(cell)
    }

    /// Cell of one block h × h with the layers of a medium.
    ///
    /// # Errors
    /// A constant of the medium is rejected.
    pub fn from_medium(medium: &BlockyMedium, is_lumped: bool) -> Result<Self, BlochError> {
        medium.check()?;
        let joint = Joint::from_layer(&medium.layer, is_lumped);
        let block = CellBlock {
            width: medium.period,
            material: medium.block,
            right_joint: joint,
            top_joint: joint,
        };
        Self::new(vec![BlockRow { height: medium.period, offset: 0.0, blocks: vec![block] }])
    }

    /// Creates a cell from rows whose sides and materials have been checked.
    pub(super) const fn from_checked_rows(rows: Vec<BlockRow>) -> Self {
        Self { rows }
    }

    /// Rows of blocks in the order of x₂.
    pub fn rows(&self) -> &[BlockRow] {
        &self.rows
    }

    /// Periods H₁ and H₂, m.
    pub fn periods(&self) -> [f64; 2] {
        [self.rows[0].width(), self.rows.iter().map(|row| row.height).sum()]
    }
}

impl BlockRow {
    /// Sum of the widths of the blocks, m.
    pub fn width(&self) -> f64 {
        self.blocks.iter().map(|block| block.width).sum()
    }
}
