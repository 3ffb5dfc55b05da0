//! Equivalent Cosserat continuum of a blocky medium: published constants, isotropy, and the response of a cell to a
//! uniform displacement gradient.

use nalgebra::{DMatrix, DVector};
use wellposed_models::InputError;
use wellposed_models::interface::elastic::ElasticMaterial;
use wellposed_models::interface::homogenised::{
    BlockMaterial, BlockyMedium, EquivalentConstant, Validity,
};
use wellposed_models::solid::parameters::PlaneCompliances;

/// Blocky medium with layers of the given thickness, m.
fn blocky_medium(thickness: f64) -> BlockyMedium {
    BlockyMedium {
        block: BlockMaterial { density: 2700.0, longitudinal_speed: 5000.0, shear_speed: 3000.0 },
        layer: ElasticMaterial {
            thickness,
            density: 1500.0,
            longitudinal_speed: 1000.0,
            shear_speed: 500.0,
        },
        period: 0.05,
    }
}

/// Asserts that a number, rounded to as many decimals, equals the printed one.
fn assert_digits(found: f64, printed: &str) {
    let decimals = printed.split_once('.').map_or(0, |(_, digits)| digits.len());
    assert_eq!(format!("{found:.decimals$}"), printed);
}

/// The constants for layers of 0.1, 1 and 5 mm equal the values of a table, to all digits printed there.
#[test]
fn constants_equal_the_table_to_the_digits_printed() {
    // δ mm; K_n, K_t 1e11 Pa/m; a₁, b₁, a₂, b₂ 1e-12/Pa; α₂ 1e6 N; ρ₀, J₀; P, long S, short S; f* kHz; K_t h/μ.
    let table = [
        "0.1 150 37.5 17.40844 4.501029 15.6214 -10.28807 11.97 2706 1.12625 4769.6 2670.5 6463.5 91.8 7.7",
        "1 15.0 3.75 29.40844 4.501029 63.6214 -10.28807 7.084 2760 1.1375 3551.9 1565.6 2418.2 28.9 0.77",
        "5 3.0 0.75 82.74177 4.501029 276.9547 -10.28807 2.518 3000 1.1875 2010.1 761.7 1097.8 12.65 0.154",
    ];
    for row in table {
        let printed: Vec<&str> = row.split(' ').collect();
        let medium = blocky_medium(1e-3 * printed[0].parse::<f64>().expect("number"));
        let constants = medium.homogenise().expect("valid");
        let [normal, tangential] = medium.layer_stiffness();
        let PlaneCompliances { a1, b1, a2, b2, alpha2, density, inertia } = constants.solid;
        let frequency = constants.natural_frequency / std::f64::consts::TAU;
        let found = [
            normal * 1e-11,
            tangential * 1e-11,
            a1 * 1e12,
            b1 * 1e12,
            a2 * 1e12,
            b2 * 1e12,
            alpha2 * 1e-6,
            density,
            inertia,
            constants.longitudinal_speed(),
            constants.long_shear_speed(),
            constants.short_shear_speed(),
            frequency * 1e-3,
            constants.stiffness_ratio,
        ];
        for (found, printed) in found.into_iter().zip(&printed[1..]) {
            assert_digits(found, printed);
        }
        // α = 1/[2(a₂ + b₂)], μ = 1/[2(a₂ − b₂)], ω*² = 4α/J₀.
        let close = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-13, "{x} {y}");
        close(constants.alpha, 0.5 / (a2 + b2));
        close(constants.mu, 0.5 / (a2 - b2));
        close(constants.natural_frequency.powi(2), 4.0 * constants.alpha / inertia);
    }
}

/// The equivalent continuum is isotropic exactly if the longitudinal and the shear speed of the layers are equal.
#[test]
fn continuum_is_isotropic_iff_both_speeds_of_the_layers_are_equal() {
    for ratio in [0.3, 0.5, 0.9, 0.999, 1.0, 1.001, 1.5] {
        let mut medium = blocky_medium(1e-3);
        medium.layer.shear_speed = ratio * medium.layer.longitudinal_speed;
        let constants = medium.homogenise().expect("valid");
        let speeds = |angle: f64| constants.long_wave_speeds([angle.cos(), angle.sin()]);
        let spread = (0..90)
            .map(|i| speeds(0.03 * f64::from(i))[1] / speeds(0.0)[1] - 1.0)
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        println!("ratio {ratio}: anisotropy {:e}, spread {spread:e}", constants.solid.anisotropy());
        assert_eq!(constants.solid.isotropic_moduli().is_ok(), ratio == 1.0);
        assert_eq!(spread < 1e-13, ratio == 1.0);
    }
}

/// The compliances give the effective stiffness of a cell: its energy for a given mean displacement gradient, minimised
/// over the gradient of the block; the difference of both gradients opens the joints.
#[test]
fn compliances_equal_those_of_a_cell_under_uniform_gradient() {
    let medium = blocky_medium(2e-3);
    let solid = medium.homogenise().expect("valid").solid;
    let h = medium.period;
    let [normal, tangential] = medium.layer_stiffness();
    let (lambda, mu) = (medium.block.lame_modulus(), medium.block.shear_modulus());
    // Energy per area ½g·Cg + ½(G − g)·J(G − g), gradients (11, 12, 21, 22): effective stiffness J − J(C + J)⁻¹J.
    let stiffness_block = DMatrix::from_row_slice(
        4,
        4,
        &[
            lambda + 2.0 * mu,
            0.0,
            0.0,
            lambda, //
            0.0,
            mu,
            mu,
            0.0, //
            0.0,
            mu,
            mu,
            0.0, //
            lambda,
            0.0,
            0.0,
            lambda + 2.0 * mu,
        ],
    );
    let joints = [normal, tangential, tangential, normal].map(|k| k * h);
    let stiffness_joint = DMatrix::from_diagonal(&DVector::from_row_slice(&joints));
    let sum = (&stiffness_block + &stiffness_joint).try_inverse().expect("regular");
    let effective_stiffness = &stiffness_joint - &stiffness_joint * sum * &stiffness_joint;
    let determinant = (solid.a1 - solid.b1) * (solid.a1 + solid.b1);
    let pairs = [
        (effective_stiffness[(0, 0)], solid.a1 / determinant),
        (effective_stiffness[(0, 3)], solid.b1 / determinant),
        (effective_stiffness[(1, 1)], 0.5 / (solid.a2 - solid.b2)),
        (effective_stiffness[(1, 2)], 0.5 / (solid.a2 - solid.b2)),
    ];
    for (found, expected) in pairs {
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

/// Every constant states its validity; for an invalid medium the error names the constant.
#[test]
fn constants_state_their_validity_and_invalid_media_are_refused() {
    assert_eq!(EquivalentConstant::A1.validity(), Validity::Exact);
    assert_eq!(EquivalentConstant::Alpha.validity(), Validity::LeadingOrder);
    assert_eq!(EquivalentConstant::Alpha2.validity(), Validity::NotUnique);
    let not_unique =
        EquivalentConstant::ALL.iter().filter(|c| c.validity() == Validity::NotUnique).count();
    assert_eq!(not_unique, 1);
    let mut invalid_medium = blocky_medium(1e-3);
    invalid_medium.period = 0.0;
    assert_eq!(
        invalid_medium.homogenise().map_err(|InputError { input, .. }| input),
        Err("period")
    );
    let mut invalid_medium = blocky_medium(1e-3);
    invalid_medium.block.longitudinal_speed = 3400.0;
    assert_eq!(
        invalid_medium.homogenise().map_err(|InputError { input, .. }| input),
        Err("longitudinal_speed")
    );
}
