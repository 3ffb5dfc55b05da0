//! Tests of certificates: names, numbers and their ranges.

use num_rational::BigRational;
use num_traits::{Signed, Zero};
use serde::{Deserialize, Serialize};

/// Friction angle, degrees.
pub(crate) const FRICTION_ANGLE: &str = "model.friction_angle_deg";
/// Dilatancy angle, degrees.
pub(crate) const DILATANCY_ANGLE: &str = "model.dilatancy_angle_deg";
/// Non-coaxiality, degrees.
pub(crate) const NONCOAXIALITY: &str = "background.noncoaxiality_deg";
/// Rotational strength, Pa.
const ROTATIONAL_STRENGTH: &str = "model.rotational_strength";

/// Test whose signs decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Test {
    /// Conditions in closed form of the Harris–Grekova model.
    HarrisGrekova,
    /// Condition in closed form of double shearing.
    DoubleShearing,
    /// Condition in closed form of the plastic potential.
    PlasticPotential,
    /// Sum, product and discriminant of both ρc² of a solid whose layers slip under positive shear stress, in the plane.
    SlippingLayersPositive,
    /// The same under negative shear stress.
    SlippingLayersNegative,
    /// Copositivity of the form of the determinant of the acoustic tensor of a classical solid with a yield cone, in space.
    YieldCone,
}

impl Test {
    /// Keys of the numbers on which the verdict depends: each is a constant of the certificate or runs over the box.
    pub fn keys(self) -> &'static [&'static str] {
        match self {
            Self::HarrisGrekova => {
                &[FRICTION_ANGLE, DILATANCY_ANGLE, NONCOAXIALITY, ROTATIONAL_STRENGTH]
            }
            Self::DoubleShearing | Self::PlasticPotential => &[FRICTION_ANGLE, DILATANCY_ANGLE],
            Self::SlippingLayersPositive | Self::SlippingLayersNegative => &[
                "model.lambda",
                "model.mu",
                "model.alpha",
                "yield.shear_friction",
                "yield.shear_dilatancy",
            ],
            Self::YieldCone => &[
                "model.lambda",
                "model.mu",
                "yield.friction",
                "yield.dilatancy",
                "yield.hardening",
                "stress.deviatoric_stress",
                "stress.out_of_plane_stress",
            ],
        }
    }

    /// The material, in words.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::HarrisGrekova => "Harris-Grekova flow",
            Self::DoubleShearing => "double shearing",
            Self::PlasticPotential => "plastic potential",
            Self::SlippingLayersPositive => "a solid whose layers slip under positive shear stress",
            Self::SlippingLayersNegative => "a solid whose layers slip under negative shear stress",
            Self::YieldCone => "a classical solid with a yield cone in space",
        }
    }

    /// Key of the number that must be zero for terms of lower order to change no well-posed verdict, and what is presumed if it
    /// is not.
    pub(crate) fn lower_order_condition(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::HarrisGrekova => Some((DILATANCY_ANGLE, " in a uniform background")),
            Self::SlippingLayersPositive | Self::SlippingLayersNegative => {
                Some(("model.alpha", ""))
            }
            _ => None,
        }
    }

    /// Checks that the model of the test takes all numbers between these ends; the lists of ends have the order of
    /// [`keys`](Self::keys). Returns what is allowed if it does not.
    pub(crate) fn check_ranges(self, ends: &[[BigRational; 2]]) -> Result<(), &'static str> {
        let degrees = |own: i64| BigRational::from_integer(own.into());
        let is_exactly_zero = |[low, high]: &[BigRational; 2]| low.is_zero() && high.is_zero();
        match ends {
            [[phi, most_phi], [nu, most_nu], ..] if self.keys()[0] == FRICTION_ANGLE => {
                if !phi.is_positive() || *most_phi >= degrees(90) || nu.is_negative() {
                    return Err(
                        "expected a friction angle between 0 and 90 and a dilatancy angle from 0 on",
                    );
                }
                let is_associated = self == Self::PlasticPotential && most_nu == phi;
                if most_nu >= phi && !is_associated {
                    return Err("expected a dilatancy angle below the friction angle");
                }
                match ends {
                    [_, dilatancy, _, strength]
                        if !is_exactly_zero(dilatancy) && !is_exactly_zero(strength) =>
                    {
                        Err("with dilatancy the rotational strength must be 0")
                    }
                    _ => Ok(()),
                }
            }
            [[lambda, _], [mu, _], rest @ ..] => {
                let (two, three) = (degrees(2), degrees(3));
                if !mu.is_positive() || !(three * lambda + two * mu).is_positive() {
                    return Err("expected mu > 0 and 3 lambda + 2 mu > 0");
                }
                // α and friction of layers, friction of cones.
                let count = if self == Self::YieldCone { 1 } else { 2 };
                match rest.iter().take(count).any(|own| own[0].is_negative()) {
                    true => Err("expected alpha and friction from 0 on"),
                    false => Ok(()),
                }
            }
            _ => Err("expected all numbers of the test"),
        }
    }
}
