//! Schemes and load paths that are refused, with their messages.

use super::build;
use wellposed_models::rheology::element::Element;
use wellposed_models::rheology::load_path::{LoadPath, LoadPathError};
use wellposed_models::rheology::named::find_named_scheme;
use wellposed_models::rheology::scheme::{
    LoadControl, NamedElement, RheologicalScheme, SchemeTree,
};

fn spring() -> Element {
    Element::Spring { modulus: 1.0 }
}

fn elements() -> Vec<NamedElement> {
    let hinge = Element::Hinge { compressive_yield_stress: 1.0, tensile_yield_stress: 2.0 };
    vec![
        NamedElement::new("a", spring()),
        NamedElement::new("b", spring()),
        NamedElement::new("d", Element::Damper { viscosity: 1.0 }),
        NamedElement::new("h", hinge),
        NamedElement::new("c", Element::Contact { gap: 0.1 }),
    ]
}

/// Parses a tree of the elements that it names, and checks it under prescribed strain.
fn refuse(tree: &str) -> String {
    let named =
        |own: &NamedElement| tree.split(|c: char| !c.is_alphanumeric()).any(|n| n == own.name);
    let elements: Vec<NamedElement> = elements().into_iter().filter(named).collect();
    let checked = RheologicalScheme::parse(elements, tree)
        .and_then(|scheme| scheme.check_control(LoadControl::Strain));
    checked.expect_err(tree).to_string()
}

#[test]
fn wrong_notations_are_refused_with_their_position() {
    for (tree, message) in [
        ("", "the name of an element is missing at 'the end'"),
        ("a -", "the name of an element is missing at 'the end'"),
        ("a | - b", "the name of an element is missing at '- b'"),
        ("a | b - c", "- and | without parentheses at '- c'"),
        ("a b", "- or | is missing at 'b'"),
        ("(a - b", "a parenthesis is not closed at 'the end'"),
        ("(a b)", "- or | is missing at 'b)'"),
        ("a - b)", "a parenthesis that closes none at ')'"),
        ("a & b", "- or | is missing at '& b'"),
    ] {
        let found = refuse(tree);
        assert_eq!(found.split(';').next(), Some(message), "{tree}");
        assert!(found.contains("joined by - (series) or | (parallel)"), "{found}");
    }
    assert_eq!(refuse("a - x"), "no element is called 'x'; the elements are a");
    let twice = "the element 'a' occurs twice in the tree; define one element for each place";
    assert_eq!(refuse("a | (b - a)"), twice);
    let deep = "(".repeat(5000) + "a" + &")".repeat(5000);
    assert_eq!(refuse(&deep), "branches are nested more than 100 deep");
}

#[test]
fn trees_without_unique_response_are_refused_naming_the_branch() {
    for (tree, message) in [
        ("h - c", "the chain h - c has neither spring nor damper"),
        ("a | (h - c)", "the chain h - c has neither spring nor damper"),
        ("h | a", "the stress of the branch h at rest is not unique"),
        ("h", "the stress of the branch h at rest is not unique"),
        ("(a | h) - (b | c)", "the stress of the branch (a | h) - (b | c) at rest is not unique"),
        ("c", "the branch c admits no compression beyond its gap"),
        ("a | c", "the branch c admits no compression beyond its gap"),
        ("h | c", "the branch c admits no compression beyond its gap"),
        ("a | ((b | c) - h)", "the stress of the branch (b | c) - h at rest is not unique"),
    ] {
        let found = refuse(tree);
        assert!(found.starts_with(message), "{tree}: {found}");
        assert!(found.contains("put a spring or a damper in series"), "{found}");
    }
    // Accepted under prescribed stress, and with a spring in series.
    for (tree, control) in [
        ("a | h", LoadControl::Stress),
        ("b - (a | h)", LoadControl::Strain),
        ("d - c", LoadControl::Strain),
    ] {
        let named = |own: &NamedElement| tree.contains(&own.name);
        let elements = elements().into_iter().filter(named).collect();
        let scheme = RheologicalScheme::parse(elements, tree).expect("a tree");
        assert_eq!(scheme.check_control(control), Ok(()), "{tree}");
    }
}

#[test]
fn wrong_elements_are_refused() {
    let refuse = |elements: Vec<NamedElement>, tree: &str| {
        RheologicalScheme::parse(elements, tree).expect_err(tree).to_string()
    };
    let named = NamedElement::new;
    let two = || vec![named("a", spring()), named("a", spring())];
    assert_eq!(refuse(two(), "a"), "two elements are called 'a'; each needs a name of its own");
    assert_eq!(
        refuse(vec![named("a", spring()), named("b", spring())], "a"),
        "the element 'b' is not in the tree"
    );
    assert_eq!(
        refuse(vec![named("a", spring()), named("2b", spring())], "a"),
        "'2b' is no name of an element: a letter, then letters, digits and _"
    );
    for (element, message) in [
        (Element::Spring { modulus: -1.0 }, "element 'a': modulus: found -1; must be positive"),
        (Element::Spring { modulus: 0.0 }, "element 'a': modulus: found 0; must be positive"),
        (Element::Damper { viscosity: -2.0 }, "element 'a': viscosity: found -2; must be positive"),
        (
            Element::Hinge { compressive_yield_stress: -1.0, tensile_yield_stress: 1.0 },
            "element 'a': compressive_yield_stress: found -1; must be at least 0",
        ),
        (
            Element::Hinge { compressive_yield_stress: 1.0, tensile_yield_stress: f64::NAN },
            "element 'a': tensile_yield_stress: found NaN; must be at least 0",
        ),
        (Element::Contact { gap: -0.1 }, "element 'a': gap: found -0.1; must be at least 0"),
    ] {
        assert_eq!(refuse(vec![named("a", element)], "a"), message);
    }
    let missing = RheologicalScheme::new(vec![named("a", spring())], SchemeTree::Element(3));
    assert!(missing.is_err());
    let empty = RheologicalScheme::new(Vec::new(), SchemeTree::Series(Vec::new()));
    assert!(empty.is_err());
    let many = (0..1001).map(|index| NamedElement::new(format!("e{index}"), spring())).collect();
    assert_eq!(
        RheologicalScheme::new(many, SchemeTree::Element(0)).expect_err("many").to_string(),
        "the scheme has 1001 elements, more than 1000"
    );
}

#[test]
fn wrong_constants_of_named_schemes_are_refused() {
    let scheme = find_named_scheme("porous-elastic").expect("a scheme");
    let refuse = |constants: &[f64]| scheme.build(constants).expect_err("wrong").to_string();
    assert!(refuse(&[1.0, 2.0]).contains("this model has 3"), "{}", refuse(&[1.0, 2.0]));
    assert_eq!(
        refuse(&[1.0, -2.0, 0.1]),
        "contact_modulus: found -2; modulus b of the spring in series with the contact; > 0"
    );
    assert!(find_named_scheme("porous").is_none());
}

#[test]
fn wrong_paths_are_refused() {
    let new = |points: &[[f64; 2]], steps| {
        LoadPath::new(LoadControl::Strain, points.to_vec(), steps).map(|_| ())
    };
    assert_eq!(new(&[[0.0, 0.0]], 1), Err(LoadPathError::TooFewPoints));
    assert_eq!(new(&[[0.0, 0.0], [f64::NAN, 0.0]], 1), Err(LoadPathError::NotFinite));
    let still = new(&[[0.0, 0.0], [1.0, 0.0], [1.0, 2.0]], 1);
    assert_eq!(still, Err(LoadPathError::TimeNotIncreasing(1.0)));
    assert_eq!(new(&[[0.0, 0.0], [1.0, 0.0]], 0), Err(LoadPathError::StepCount(0)));
    assert_eq!(new(&[[0.0, 0.0], [1.0, 0.0]], 1 << 40), Err(LoadPathError::StepCount(1 << 40)));
    let cycles = |values: &[f64], count, rate| {
        LoadPath::from_cycles(LoadControl::Strain, values, count, rate, 10).map(|_| ())
    };
    assert_eq!(cycles(&[0.1, -0.1], 2, 0.0), Err(LoadPathError::Rate(0.0)));
    assert_eq!(cycles(&[0.1, -0.1], 2, -1.0), Err(LoadPathError::Rate(-1.0)));
    assert_eq!(cycles(&[1e300], 1, 1e-300), Err(LoadPathError::Rate(1e-300)));
    assert_eq!(cycles(&[0.0, 0.0], 2, 1.0), Err(LoadPathError::TooFewPoints));
    assert!(cycles(&[0.1, 0.0], usize::MAX, 1.0).is_err());
    assert_eq!(cycles(&[0.1, 0.1, -0.1], 2, 1.0), Ok(()));
}

/// A stress beyond the limits and a jump of the strain that a damper cannot follow have no end state.
#[test]
fn steps_without_end_state_are_refused() {
    let response_error = |name: &str, constants: &[f64], control, points: &[[f64; 2]]| {
        let path = LoadPath::new(control, points.to_vec(), 10).expect("a path");
        build(name, constants).compute_response(&path).expect_err("no end state").to_string()
    };
    assert_eq!(
        response_error("granular-elastic", &[1.0], LoadControl::Stress, &[[0.0, -1.0], [1.0, 1.0]]),
        "at the time 0.6 s the stress 0.2 Pa is not borne: the stress of this scheme is from −∞ to 0 Pa"
    );
    assert_eq!(
        response_error(
            "granular-plastic",
            &[1.0, 0.5],
            LoadControl::Stress,
            &[[0.0, -1.0], [1.0, 0.0]]
        ),
        "at the time 0 s the stress -1 Pa is not borne: the stress of this scheme is from -0.5 to 0 Pa"
    );
    assert_eq!(
        response_error(
            "granular-kelvin-voigt",
            &[1.0, 1.0],
            LoadControl::Strain,
            &[[0.0, -1.0], [1.0, 0.0]]
        ),
        "at the time 0 s the strain -1 cannot be reached: in this step the strain is from 0 to ∞"
    );
    assert_eq!(
        response_error(
            "granular-elastic",
            &[1e308],
            LoadControl::Strain,
            &[[0.0, -1e3], [1.0, 0.0]]
        ),
        "at the time 0 s strain, stress or energy is not finite"
    );
}
