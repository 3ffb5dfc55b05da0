//! Conditions in closed form of plane flows.

use crate::interval::{Interval, pi};
use crate::numbers::{Numbers, Problem};
use crate::polynomial::Polynomial;
use crate::quantity::Quantity;
use crate::test::{DILATANCY_ANGLE, FRICTION_ANGLE, NONCOAXIALITY, Test};

/// Quantities that are all positive exactly where the flow is well-posed, with their names.
pub(crate) fn conditions(
    test: Test,
    numbers: &Numbers,
) -> Result<Vec<(&'static str, Quantity)>, Problem> {
    if test == Test::PlasticPotential {
        let difference = &numbers.value(FRICTION_ANGLE)? - &numbers.value(DILATANCY_ANGLE)?;
        // −|φ − ν| in radians: of the sign that it has in all of the box, if it has one.
        let magnitude = match difference.is_positive() {
            true => &Polynomial::whole(0) - &difference,
            false => difference,
        };
        let radians = Polynomial::constant(pi() / &Interval::whole(180));
        let quantity = Quantity::new(&magnitude * &radians, Polynomial::whole(1));
        return Ok(vec![("−|φ − ν|", quantity)]);
    }
    if test == Test::DoubleShearing {
        let (phi, nu) = (numbers.angle(FRICTION_ANGLE)?, numbers.angle(DILATANCY_ANGLE)?);
        let difference = phi.minus(&nu);
        // −cos(φ − 2ν)/(sin(φ − ν) [cos(φ − ν) + sin ν]), with the norms of φ − ν and φ − 2ν, which are products of those of φ
        // and ν, divided out.
        let twice = difference.minus(&nu);
        let sum = &(&difference.cosine * &nu.norm) + &(&nu.sine * &difference.norm);
        let divisor = &difference.sine * &sum;
        let numerator = &Polynomial::whole(0) - &(&twice.cosine * &difference.norm);
        return Ok(vec![(
            "−cos(φ − 2ν)/(sin(φ − ν) (cos(φ − ν) + sin ν))",
            Quantity::new(numerator, divisor),
        )]);
    }
    let delta = numbers.angle(NONCOAXIALITY)?;
    let twice_delta = delta.plus(&delta);
    let coaxiality =
        ("cos 2Δ", Quantity::new(twice_delta.cosine.clone(), twice_delta.norm.clone()));
    if numbers.is_zero(DILATANCY_ANGLE) {
        return Ok(vec![coaxiality]);
    }
    let (phi, nu) = (numbers.angle(FRICTION_ANGLE)?, numbers.angle(DILATANCY_ANGLE)?);
    let difference = phi.minus(&nu);
    // cos²ν cos φ cos(φ − 2ν) cos²2Δ − sin²ν cos²(φ − ν) sin²2Δ
    let square = |own: &Polynomial| own * own;
    let twice = difference.minus(&nu);
    let cosines = &(&phi.cosine * &twice.cosine) * &square(&(&nu.cosine * &twice_delta.cosine));
    let sines = square(&(&(&nu.sine * &difference.cosine) * &twice_delta.sine));
    // Over a common divisor: the product of the norms of φ and φ − 2ν is the square of that of φ − ν.
    let divisor = square(&(&(&difference.norm * &nu.norm) * &twice_delta.norm));
    let ellipticity = Quantity::new(&cosines - &sines, divisor);
    Ok(vec![coaxiality, ("ellipticity", ellipticity)])
}
