//! Closed forms of moduli and corners.

use wellposed_models::granular_medium::{GranularContact, GranularMedium, GranularParameters};
use wellposed_models::porous::{PoreContact, PorousMedium, PorousParameters};

fn assert_close(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-13 * expected.abs(), "{found:e} {expected:e}");
}

const SAND: GranularParameters = GranularParameters {
    density: 1800.0,
    bulk_modulus: 1.5e9,
    shear_modulus: 0.9e9,
    friction: 0.5,
    yield_stress: Some(5e6),
    intensity_coefficient: 0.375,
};

const FOAM: PorousParameters = PorousParameters {
    density: 2673.0,
    bulk_modulus: 71.58e9,
    shear_modulus: 24.54e9,
    yield_stress: Some(37.8e6),
    intensity_coefficient: 0.375,
    contact_bulk_modulus: 4.256e9,
    porosity: 0.01,
    contact: PoreContact::Spherical,
};

/// Sand on the cone: E_c = kμ(3 + 4æ)²/(3(3μ + 4æ²k)) = 2.678571 GPa, no tension.
#[test]
fn sand_has_the_modulus_of_the_cone_and_transmits_no_tension() {
    let medium = GranularMedium::new(SAND).unwrap();
    assert!(!medium.transmits_tension());
    let diagram = medium.loading_diagram();
    let (k, mu, friction) = (1.5e9, 0.9e9, 0.5);
    let cone = k * mu * f64::powi(3.0 + 4.0 * friction, 2)
        / (3.0 * (3.0 * mu + 4.0 * friction * friction * k));
    assert_close(cone, 2.678_571_428_571_429e9);
    let slopes: Vec<f64> = diagram.segments().iter().map(|own| own.slope).collect();
    assert_eq!((slopes[0], slopes[2]), (0.0, 0.0));
    assert_close(slopes[1], cone);
    assert_close(slopes[3], k);
    // The particles yield at p = τ_s/æ and open no more at ε = τ_s/(æk).
    let corners = diagram.corners();
    assert_close(corners[1].pressure, 5e6 / friction * (1.0 + friction / 0.75));
    assert_close(corners[2].strain, 5e6 / (friction * k));
    assert_close(corners[1].strain, corners[1].pressure / cone);
}

/// With more friction the particles stay elastic, k + 4μ/3, and a great friction transmits tension with the modulus
/// E_t = k (æm − M)/(M + æ²k) · (æ/r − 1).
#[test]
fn stiffness_with_great_friction_is_elastic_in_compression_and_positive_in_extension() {
    let own = GranularParameters { friction: 0.9, yield_stress: None, ..SAND };
    let medium = GranularMedium::new(own).unwrap();
    assert!(medium.transmits_tension());
    let diagram = medium.loading_diagram();
    let (k, mu, friction) = (1.5e9, 0.9e9, 0.9);
    let (m, big) = (mu, 0.75 * mu);
    let tension =
        k * (friction * m - big) / (big + friction * friction * k) * (friction / 0.75 - 1.0);
    assert_close(diagram.segments()[0].slope, tension);
    assert_close(diagram.segments()[1].slope, k + 4.0 / 3.0 * mu);
    assert_eq!(diagram.segments().len(), 2);
}

#[test]
fn aluminium_foam_has_the_published_speeds_and_corners() {
    let medium = PorousMedium::new(FOAM).unwrap();
    assert_close(medium.yield_strain(), 37.8e6 / 24.54e9);
    let diagram = medium.loading_diagram();
    let slope = |index: usize| diagram.segments()[index].slope;
    assert_close(slope(1), 71.58e9 + 4.0 / 3.0 * 24.54e9);
    assert_close(slope(2), 71.58e9);
    assert_close(slope(3), 71.58e9 + 4.256e9);
    assert_eq!(diagram.corners()[2].strain, 0.01);
    // 6247 m/s, the speed of aluminium: the moduli are in GPa, not in MPa as printed.
    let speed = (slope(1) / 2673.0).sqrt();
    assert!((speed - 6247.0).abs() < 0.5, "{speed}");
    // The frozen deviator contributes 4τ_s/3.
    let collapsed = diagram.pressure(0.02);
    assert_close(collapsed, 71.58e9 * 0.02 + 4.0 / 3.0 * 37.8e6 + 4.256e9 * 0.01);
}

/// Contact with friction closes at θ₀/(1 + 4æ/3), slides with the modulus of the cone and closes fully at
/// θ₀/(1 − m_b/(æk_b)).
#[test]
fn frictional_pores_begin_to_collapse_earlier() {
    let friction = 0.6;
    let contact = PoreContact::Frictional { shear_modulus: 1.459e9, friction };
    let own = PorousParameters { contact, yield_stress: None, ..FOAM };
    let diagram = PorousMedium::new(own).unwrap().loading_diagram();
    let corners = diagram.corners();
    assert_eq!(corners.len(), 2, "{diagram:?}");
    assert_close(corners[0].strain, 0.01 / (1.0 + 4.0 / 3.0 * friction));
    assert_close(corners[1].strain, 0.01 / (1.0 - 1.459e9 / (friction * 4.256e9)));
    let (k, mu) = (4.256e9, 1.459e9);
    let cone = k * mu * f64::powi(3.0 + 4.0 * friction, 2)
        / (3.0 * (3.0 * mu + 4.0 * friction * friction * k));
    let open = 71.58e9 + 4.0 / 3.0 * 24.54e9;
    assert_close(diagram.segments()[1].slope, open + cone);
    assert_close(diagram.segments()[2].slope, open + k + 4.0 / 3.0 * mu);
}

/// Unloading of a collapsed elastic-plastic foam: elastic until the deviator has the opposite sign, after 2θ_f.
#[test]
fn foam_yields_in_reverse_after_twice_the_yield_strain() {
    let medium = PorousMedium::new(FOAM).unwrap();
    let diagram = medium.unloading_diagram(0.02);
    let limit = medium.yield_strain();
    let reverse = diagram.corners().iter().find(|own| own.strain > 0.01).unwrap();
    assert_close(reverse.strain, 0.02 - 2.0 * limit);
    assert_close(diagram.pressure(0.02), medium.loading_diagram().pressure(0.02));
    let names: Vec<&str> = diagram.segments().iter().map(|own| own.state.name()).collect();
    assert_eq!(names, ["plastic, open", "plastic, closed", "elastic, closed", "plastic, closed"]);
}

/// The greatest shear stress on a plane under the pressure 1, from the cone by a search over the normal stresses along the
/// plane; a cone that transmits tension has no limit.
#[test]
fn tractions_are_limited_by_the_cone() {
    for (friction, intensity_coefficient) in
        [(0.0, 0.375), (0.3, 0.375), (0.5, 0.375), (0.7, 0.375), (0.5, 0.5), (0.86, 0.5)]
    {
        let parameters = GranularParameters { friction, intensity_coefficient, ..SAND };
        let law = GranularContact::new(&GranularMedium::new(parameters).unwrap());
        let mut greatest = 0.0f64;
        // Pressures Q₂, Q₃ along the plane, and what the cone leaves for the shear stress.
        for [i, j] in (0..600).flat_map(|i| (0..600).map(move |j| [i, j])) {
            let [second, third] = [i, j].map(|own| (0.012 * f64::from(own)).exp() - 1.0);
            let pressure = (1.0 + second + third) / 3.0;
            let deviator = [1.0, second, third].map(|own| (own - pressure).powi(2));
            let squares = (friction * pressure).powi(2) / intensity_coefficient;
            let shear = 0.5 * (squares - deviator.iter().sum::<f64>());
            greatest = greatest.max(shear.max(0.0).sqrt());
        }
        let found = law.traction_friction().unwrap();
        assert!(
            greatest <= found * (1.0 + 1e-12) && greatest >= 0.999 * found,
            "{greatest} {found}"
        );
    }
    let parameters = GranularParameters { friction: 0.76, ..SAND };
    let law = GranularContact::new(&GranularMedium::new(parameters).unwrap());
    assert_eq!(law.traction_friction(), None);
}
