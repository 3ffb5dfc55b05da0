//! Uniaxial strain of media with contacts and yielding: piecewise-linear diagrams of pressure against compression.
//!
//! In a plane wave along x₁ the only strain is ε₁₁. Here ε = −ε₁₁ is the compression strain and p = −σ₁₁ the pressure
//! on the wave front, both compression-positive. A [`UniaxialDiagram`] is p(ε) along one monotone path: loading from
//! the natural state, or unloading from a state on that path. [`FrictionCone`] is the contact of particles or of pore
//! walls in uniaxial strain.

pub(crate) mod cone;
mod diagram;
pub(crate) mod skeleton;

pub use cone::{FrictionCone, StrainIntensity};
pub use diagram::{
    ContactState, DiagramCorner, DiagramSegment, SegmentState, SkeletonState, UniaxialDiagram,
};
pub use skeleton::NO_LIMIT;
