//! Tests of converting a case to another kind of model.

use super::full_case::{FULL_CASE, derive_background, parse_full_case_with};
use crate::support::parse_case;
use models::registry;
use wellposed::case::{Case, ModelKind};

#[test]
fn conversion_keeps_keys_used_by_new_kind() {
    let case = parse_case(FULL_CASE).unwrap();
    let other = case.convert_to_kind(ModelKind::Flow(registry::DOUBLE_SHEARING));
    assert_eq!(other.material.kind, ModelKind::Flow(registry::DOUBLE_SHEARING));
    assert_eq!(other.number("background.pressure"), Some(1000.25));
    assert_eq!(
        (other.number("background.spin"), other.number("model.moment_of_inertia")),
        (None, None)
    );
    derive_background(&other).unwrap();
    // Keys of a compared kind are allowed even if the kind of the case does not use them.
    let sets = ["model.kind=double-shearing", "map.x.parameter=wave.number"];
    derive_background(
        &parse_full_case_with(&sets)
            .unwrap()
            .convert_to_kind(ModelKind::Flow(registry::HARRIS_GREKOVA)),
    )
    .unwrap();
}

#[test]
fn conversion_keeps_noncoaxiality_determined_by_spin() {
    let case = parse_case(FULL_CASE).unwrap();
    let delta = |case: &Case| case.material.numbers.background.noncoaxiality_deg;
    // Kinds with a spin keep it to the last bit; the others get the equivalent non-coaxiality.
    for (kind, expected, lost) in [
        (ModelKind::Flow(registry::HARRIS_GREKOVA), None, None),
        (ModelKind::Flow(registry::FREE_ROTATING), None, None),
        (ModelKind::Flow(registry::DOUBLE_SHEARING), Some(7.5), None),
        (ModelKind::Flow(registry::PLASTIC_POTENTIAL), Some(0.0), Some(7.5)),
    ] {
        let converted = case.convert_with_noncoaxiality(kind, Some(7.5));
        assert_eq!(delta(&converted.case), expected, "{kind:?}");
        assert_eq!(converted.lost_noncoaxiality_deg, lost, "{kind:?}");
        assert_eq!(converted.case.number("background.spin").is_some(), expected.is_none());
        derive_background(&converted.case).unwrap();
    }
    // A non-coaxiality given in the case has precedence over the argument.
    let given = parse_case(&FULL_CASE.replace("spin = -0.125", "noncoaxiality_deg = 5")).unwrap();
    let converted =
        given.convert_with_noncoaxiality(ModelKind::Flow(registry::DOUBLE_SHEARING), Some(7.5));
    assert_eq!(converted.case, given.convert_to_kind(ModelKind::Flow(registry::DOUBLE_SHEARING)));
    let converted =
        given.convert_with_noncoaxiality(ModelKind::Flow(registry::PLASTIC_POTENTIAL), None);
    assert_eq!((delta(&converted.case), converted.lost_noncoaxiality_deg), (Some(0.0), Some(5.0)));
    // The conversion of a coaxial case drops no non-coaxiality.
    let coaxial = parse_case(&FULL_CASE.replace("spin = -0.125\n", "")).unwrap();
    let converted =
        coaxial.convert_with_noncoaxiality(ModelKind::Flow(registry::PLASTIC_POTENTIAL), Some(0.0));
    assert_eq!(converted.lost_noncoaxiality_deg, None);
    let converted =
        coaxial.convert_with_noncoaxiality(ModelKind::Flow(registry::DOUBLE_SHEARING), Some(0.0));
    assert_eq!(converted.case, coaxial.convert_to_kind(ModelKind::Flow(registry::DOUBLE_SHEARING)));
}
