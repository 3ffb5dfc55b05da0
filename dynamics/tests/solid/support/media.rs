//! Solids, their rate equations, and names of fields.

use models::common::rates::RateEquations;
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, PlaneCompliances, Theory};
use models::solid::waves::SolidField;

/// Classical, reduced Cosserat and Cosserat theory.
pub const THEORIES: [Theory; 3] = [Theory::Classical, Theory::Reduced, Theory::Cosserat];

/// Returns the microrotation constants of a theory; moduli are multiplied by `factor`.
fn microrotation(theory: Theory, factor: f64) -> Option<Microrotation> {
    let couple = CoupleModuli { beta: 0.3 * factor, gamma: 0.7 * factor, eta: 0.45 * factor };
    let couple = (theory == Theory::Cosserat).then_some(couple);
    let rotation = Microrotation { alpha: 0.6 * factor, inertia: 0.37, couple };
    (theory != Theory::Classical).then_some(rotation)
}

/// Returns a solid with unequal constants of order one; λ and μ are multiplied by `factor`.
pub fn isotropic(theory: Theory, factor: f64) -> Isotropic {
    let rotation = microrotation(theory, 1.0);
    Isotropic::new(1.4 * factor, 0.9 * factor, 1.2, rotation).expect("sound moduli")
}

/// Returns the solid of [`isotropic`] with all moduli multiplied by `factor`.
pub fn scaled_isotropic(theory: Theory, factor: f64) -> Isotropic {
    let rotation = microrotation(theory, factor);
    Isotropic::new(1.4 * factor, 0.9 * factor, 1.2, rotation).expect("sound moduli")
}

/// Returns a classical solid whose moduli are multiplied by `factor`.
pub fn classical(factor: f64) -> Isotropic {
    Isotropic::new(1.1 * factor, 0.8 * factor, 1.3, None).expect("sound moduli")
}

/// Returns a Cosserat solid whose moduli are multiplied by `factor`.
pub fn cosserat(factor: f64) -> Isotropic {
    let rotation = microrotation(Theory::Cosserat, factor);
    Isotropic::new(1.1 * factor, 0.8 * factor, 1.3, rotation).expect("sound moduli")
}

/// Returns the compliances of a plane Cosserat solid of cubic symmetry.
pub fn cubic_compliances() -> PlaneCompliances {
    PlaneCompliances {
        a1: 0.5,
        b1: -0.1,
        a2: 0.8,
        b2: 0.1,
        alpha2: 0.9,
        density: 1.1,
        inertia: 0.4,
    }
}

/// Returns the name of a field among the unknowns of the rate equations.
pub fn unknown_name(field: SolidField) -> String {
    match field {
        SolidField::Velocity(i) => format!("v{}", i + 1),
        SolidField::Spin(k) => format!("ω{}", k + 1),
        SolidField::Stress(i, j) => format!("σ{}{}", i + 1, j + 1),
        SolidField::Couple(k, j) => format!("m{}{}", k + 1, j + 1),
        SolidField::ViscousStrain(i, j) => format!("e{}{}", i + 1, j + 1),
        SolidField::ExcessStress(..)
        | SolidField::SpringStress(..)
        | SolidField::PlasticStrain(..)
        | SolidField::VolumetricStrain
        | SolidField::PoreClosure => {
            unreachable!("no unknown of the rate equations")
        }
    }
}

/// Returns the rate equations of a solid with all stresses of the domain as unknowns.
pub fn rate_equations<const D: usize>(solid: &Isotropic) -> RateEquations<D> {
    let layout = solid.layout::<D>().with_out_of_plane();
    let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
    layout.rates(&solid.stiffness(layout.all_stresses()), solid.density, inertia)
}
