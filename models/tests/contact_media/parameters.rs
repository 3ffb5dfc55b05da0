//! Refused constants.

use wellposed_models::granular_medium::{GranularMedium, GranularParameters};
use wellposed_models::porous::{PoreContact, PorousMedium, PorousParameters};

#[test]
fn constants_out_of_range_are_named_with_their_values() {
    let sand = GranularParameters {
        density: 1800.0,
        bulk_modulus: 1.5e9,
        shear_modulus: 0.9e9,
        friction: 0.5,
        yield_stress: None,
        intensity_coefficient: 0.375,
    };
    let refused = |own: GranularParameters| {
        let error = GranularMedium::new(own).unwrap_err();
        (error.input, error.rejected_value)
    };
    type Change = (&'static str, fn(&mut GranularParameters, f64), &'static [f64]);
    let changes: [Change; 6] = [
        ("density", |own, x| own.density = x, &[0.0, -1.0, f64::NAN]),
        ("bulk_modulus", |own, x| own.bulk_modulus = x, &[0.0, f64::INFINITY]),
        ("shear_modulus", |own, x| own.shear_modulus = x, &[0.0, -2.0]),
        ("friction", |own, x| own.friction = x, &[-1e-9, f64::NAN]),
        ("yield_stress", |own, x| own.yield_stress = Some(x), &[0.0, -5.0]),
        ("intensity_coefficient", |own, x| own.intensity_coefficient = x, &[0.0, -0.5]),
    ];
    for (name, change, values) in changes {
        for &value in values {
            let mut own = sand;
            change(&mut own, value);
            let (input, found) = refused(own);
            let found: f64 = found.parse().unwrap();
            assert_eq!((input, found.to_bits()), (name, value.to_bits()));
        }
    }
    let frictional = |shear_modulus, friction| PoreContact::Frictional { shear_modulus, friction };
    let foam = PorousParameters {
        density: 2673.0,
        bulk_modulus: 71.58e9,
        shear_modulus: 24.54e9,
        yield_stress: Some(37.8e6),
        intensity_coefficient: 0.375,
        contact_bulk_modulus: 4.256e9,
        porosity: 0.01,
        contact: frictional(1.459e9, 0.0),
    };
    assert!(PorousMedium::new(foam).is_ok());
    for (own, name) in [
        (PorousParameters { porosity: 1.0, ..foam }, "porosity"),
        (PorousParameters { porosity: -0.1, ..foam }, "porosity"),
        (PorousParameters { contact_bulk_modulus: -1.0, ..foam }, "contact_bulk_modulus"),
        (PorousParameters { contact: frictional(0.0, 0.5), ..foam }, "contact_shear_modulus"),
        (PorousParameters { contact: frictional(1e9, -0.5), ..foam }, "friction"),
        (PorousParameters { yield_stress: Some(0.0), ..foam }, "yield_stress"),
    ] {
        assert_eq!(PorousMedium::new(own).unwrap_err().input, name);
    }
}
