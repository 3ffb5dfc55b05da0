//! Media and diagrams of the tests.

use models::granular_medium::{GranularMedium, GranularParameters};
use models::porous::{PoreContact, PorousMedium, PorousParameters};
use models::uniaxial::{
    ContactState, DiagramCorner, DiagramSegment, SegmentState, SkeletonState, UniaxialDiagram,
};
use testkit::random::RandomNumbers;

/// Yield stress of the aluminium foam, Pa.
pub const FOAM_YIELD_STRESS: f64 = 37.8e6;

/// Aluminium foam of Sadovskii & Sadovskaya (2019) with the density 2700(1 − θ₀) kg/m³.
pub fn aluminium_foam(porosity: f64) -> PorousParameters {
    PorousParameters {
        density: 2700.0 * (1.0 - porosity),
        bulk_modulus: 71.58e9,
        shear_modulus: 24.54e9,
        yield_stress: Some(FOAM_YIELD_STRESS),
        intensity_coefficient: 0.375,
        contact_bulk_modulus: 4.256e9,
        porosity,
        contact: PoreContact::Spherical,
    }
}

/// Foam whose collapsed pores are stiffer than its skeleton.
pub fn strong_foam() -> PorousParameters {
    PorousParameters {
        density: 800.0,
        bulk_modulus: 0.6e9,
        shear_modulus: 0.25e9,
        yield_stress: Some(4e6),
        intensity_coefficient: 0.375,
        contact_bulk_modulus: 12e9,
        porosity: 0.15,
        contact: PoreContact::Spherical,
    }
}

/// Sand without yield stress.
pub fn sand() -> GranularMedium {
    GranularMedium::new(GranularParameters {
        density: 1800.0,
        bulk_modulus: 1.5e9,
        shear_modulus: 0.9e9,
        friction: 0.5,
        yield_stress: None,
        intensity_coefficient: 0.375,
    })
    .unwrap()
}

/// Diagram of a porous medium.
pub fn diagram(parameters: PorousParameters) -> UniaxialDiagram {
    PorousMedium::new(parameters).unwrap().loading_diagram()
}

/// Diagram through the natural state with `count` corners and random moduli, of the order of one: convex and concave
/// corners, also a modulus of zero.
pub fn random_diagram(random: &mut RandomNumbers, count: usize) -> UniaxialDiagram {
    let mut segment = || {
        let state =
            SegmentState { skeleton: SkeletonState::Elastic, contact: Some(ContactState::Closed) };
        let slope = if random.bernoulli(0.1) { 0.0 } else { random.uniform(0.2, 2.0) };
        (DiagramSegment { state, slope }, random.uniform(0.2, 1.0))
    };
    let (first, _) = segment();
    let mut corner = DiagramCorner { strain: 0.0, pressure: 0.0 };
    let mut all = Vec::new();
    for index in 0..=count {
        let (mut own, length) = segment();
        if index == count {
            own.slope = own.slope.max(0.3);
        }
        all.push((corner, own));
        corner.strain += length;
        corner.pressure += own.slope * length;
    }
    UniaxialDiagram::from_corners(first, &all).unwrap()
}

/// Asserts that two numbers agree to a relative tolerance.
#[track_caller]
pub fn assert_close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found:e} {expected:e}");
}
