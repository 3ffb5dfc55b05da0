//! Tests of converting a case to another kind of model.

use crate::support::{CASE, check, parse, parse_with};
use models::registry;
use wellposed::case::{Case, Kind};

#[test]
fn another_kind_takes_what_it_uses() {
    let case = parse(CASE).unwrap();
    let other = case.for_kind(Kind::Flow(registry::DOUBLE_SHEARING));
    assert_eq!(other.material.kind, Kind::Flow(registry::DOUBLE_SHEARING));
    assert_eq!(other.get("background.pressure"), Some(1000.25));
    assert_eq!((other.get("background.spin"), other.get("model.moment_of_inertia")), (None, None));
    check(&other).unwrap();
    // Keys of a compared kind are allowed even if the kind of the case does not use them.
    let sets = ["model.kind=double-shearing", "map.x.parameter=wave.number"];
    check(&parse_with(&sets).unwrap().for_kind(Kind::Flow(registry::HARRIS_GREKOVA))).unwrap();
}

#[test]
fn another_kind_keeps_the_noncoaxiality_that_a_spin_stands_for() {
    let case = parse(CASE).unwrap();
    let delta = |case: &Case| case.material.numbers.background.noncoaxiality_deg;
    // Kinds with a spin keep it to the last bit; the others get the equivalent non-coaxiality.
    for (kind, expected, lost) in [
        (Kind::Flow(registry::HARRIS_GREKOVA), None, None),
        (Kind::Flow(registry::FREE_ROTATING), None, None),
        (Kind::Flow(registry::DOUBLE_SHEARING), Some(7.5), None),
        (Kind::Flow(registry::PLASTIC_POTENTIAL), Some(0.0), Some(7.5)),
    ] {
        let converted = case.for_kind_with(kind, Some(7.5));
        assert_eq!(delta(&converted.case), expected, "{kind:?}");
        assert_eq!(converted.lost_noncoaxiality_deg, lost, "{kind:?}");
        assert_eq!(converted.case.get("background.spin").is_some(), expected.is_none());
        check(&converted.case).unwrap();
    }
    // A given non-coaxiality has precedence.
    let given = parse(&CASE.replace("spin = -0.125", "noncoaxiality_deg = 5")).unwrap();
    let converted = given.for_kind_with(Kind::Flow(registry::DOUBLE_SHEARING), Some(7.5));
    assert_eq!(converted.case, given.for_kind(Kind::Flow(registry::DOUBLE_SHEARING)));
    let converted = given.for_kind_with(Kind::Flow(registry::PLASTIC_POTENTIAL), None);
    assert_eq!((delta(&converted.case), converted.lost_noncoaxiality_deg), (Some(0.0), Some(5.0)));
    // A coaxial case loses nothing.
    let coaxial = parse(&CASE.replace("spin = -0.125\n", "")).unwrap();
    let converted = coaxial.for_kind_with(Kind::Flow(registry::PLASTIC_POTENTIAL), Some(0.0));
    assert_eq!(converted.lost_noncoaxiality_deg, None);
    let converted = coaxial.for_kind_with(Kind::Flow(registry::DOUBLE_SHEARING), Some(0.0));
    assert_eq!(converted.case, coaxial.for_kind(Kind::Flow(registry::DOUBLE_SHEARING)));
}
