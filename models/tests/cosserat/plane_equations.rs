//! Plane-strain equations against Sadovskii & Sadovskaya (2019).

use crate::cosserat::random_solids::{random_cubic_solid, random_solid};
use crate::support::RandomNumbers;
use nalgebra::DMatrix;
use wellposed_models::LinearisedSystem;
use wellposed_models::common::rates::SymmetricForm;
use wellposed_models::solid::parameters::{Isotropic, Microrotation, PlaneCompliances};

/// Symmetric form written out by hand from Sadovskii & Sadovskaya (2019, "Plane strain state") for the unknowns
/// (v₁, v₂, ω₃, σ₁₁, σ₂₂, σ₂₁, σ₁₂, μ₃₁, μ₃₂) with the couple stresses μ₃₁ and μ₃₂: the balances
/// ρ₀v̇₁ = σ₁₁,₁ + σ₁₂,₂; ρ₀v̇₂ = σ₂₁,₁ + σ₂₂,₂; J₀ω̇₃ = μ₃₁,₁ + μ₃₂,₂ + σ₂₁ − σ₁₂; then the constitutive laws.
fn published_symmetric_form(c: &PlaneCompliances) -> SymmetricForm<2> {
    let PlaneCompliances { a1, b1, a2, b2, alpha2, density: r, inertia: i } = *c;
    let k = 1.0 / alpha2;
    #[rustfmt::skip]
    let a = DMatrix::from_row_slice(9, 9, &[
        r,   0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, r,   0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, i,   0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, a1,  -b1, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, -b1, a1,  0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, a2,  -b2, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, -b2, a2,  0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, k,   0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, k,
    ]);
    #[rustfmt::skip]
    let b1 = DMatrix::from_row_slice(9, 9, &[
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0,
        1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]);
    #[rustfmt::skip]
    let b2 = DMatrix::from_row_slice(9, 9, &[
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,
    ]);
    let mut q = DMatrix::zeros(9, 9);
    (q[(2, 5)], q[(2, 6)], q[(5, 2)], q[(6, 2)]) = (1.0, -1.0, -1.0, 1.0);
    SymmetricForm { a, b: [b1, b2], q }
}

fn assert_close(own: &DMatrix<f64>, published: &DMatrix<f64>, tolerance: f64, name: &str) {
    assert_eq!(own.shape(), published.shape(), "{name}");
    let error = (own - published).amax();
    assert!(
        error <= tolerance * published.amax().max(1.0),
        "{name}: {error:e}\n{own}\n{published}"
    );
}

/// Tolerance for matrices inverted twice, with condition numbers up to 10.
const INVERSION_TOLERANCE: f64 = 1e-14;

/// The rate equations of random cubic and isotropic Cosserat solids in plane strain equal the published equations.
#[test]
fn plane_equations_agree_with_the_published_equations() {
    let mut random = RandomNumbers::new(1);
    for number in 0..200 {
        let (compliances, rates) = if number % 2 == 0 {
            let c = random_cubic_solid(&mut random);
            (c, c.rates())
        } else {
            let solid = random_solid(&mut random, 2);
            (PlaneCompliances::from_isotropic(&solid).unwrap(), solid.rates::<2>())
        };
        let expected = published_symmetric_form(&compliances);
        let own = rates.symmetric_form().unwrap();
        assert_close(&own.a, &expected.a, 10.0 * INVERSION_TOLERANCE, "A");
        assert_eq!((&own.b, &own.q), (&expected.b, &expected.q));

        // The linearised system is solved for the stress rates: its matrices are A′ = diag(ρ₀, ρ₀, J₀, 1, …), −A′A⁻¹Bⁱ
        // and −A′A⁻¹Q with A, Bⁱ and Q of the symmetric form.
        let mut linear = LinearisedSystem::default();
        rates.linearise(&mut linear);
        let value =
            |m: &wellposed_models::common::system::RoundedMatrix| m.map(|entry| entry.value);
        let mut a = DMatrix::identity(9, 9);
        (a[(0, 0)], a[(1, 1)]) = (compliances.density, compliances.density);
        a[(2, 2)] = compliances.inertia;
        assert_eq!(value(&linear.a), a);
        let solve = &a * expected.a.clone().try_inverse().unwrap();
        for axis in 0..2 {
            let expected = -&solve * &expected.b[axis];
            assert_close(&value(&linear.b[axis]), &expected, 10.0 * INVERSION_TOLERANCE, "B");
        }
        assert_close(&value(&linear.c), &(-&solve * &expected.q), 10.0 * INVERSION_TOLERANCE, "C");
        assert_eq!(linear.velocity, [0.0; 2]);
    }
}

/// The linearised plane-strain equations agree with the equations in terms of the moduli, written out by hand:
/// σ̇₁₁ = (λ + 2μ)v₁,₁ + λv₂,₂, σ̇₂₁ = (μ + α)(v₂,₁ − ω₃) + (μ − α)(v₁,₂ + ω₃), …
#[test]
fn plane_equations_in_terms_of_moduli_agree_with_hookes_law() {
    let mut random = RandomNumbers::new(2);
    let solid = random_solid(&mut random, 2);
    let (l, m) = (solid.lambda, solid.mu);
    let Microrotation { alpha, inertia, couple } = solid.microrotation.unwrap();
    let bending = couple.unwrap().gamma + couple.unwrap().eta;
    let mut linear = LinearisedSystem::default();
    solid.rates::<2>().linearise(&mut linear);
    let mut b = [DMatrix::zeros(9, 9), DMatrix::zeros(9, 9)];
    (b[0][(0, 3)], b[1][(0, 6)]) = (-1.0, -1.0);
    (b[0][(1, 5)], b[1][(1, 4)]) = (-1.0, -1.0);
    (b[0][(2, 7)], b[1][(2, 8)]) = (-1.0, -1.0);
    (b[0][(3, 0)], b[1][(3, 1)]) = (-(l + 2.0 * m), -l);
    (b[0][(4, 0)], b[1][(4, 1)]) = (-l, -(l + 2.0 * m));
    (b[0][(5, 1)], b[1][(5, 0)]) = (-(m + alpha), -(m - alpha));
    (b[0][(6, 1)], b[1][(6, 0)]) = (-(m - alpha), -(m + alpha));
    (b[0][(7, 2)], b[1][(8, 2)]) = (-bending, -bending);
    let mut c = DMatrix::zeros(9, 9);
    (c[(2, 5)], c[(2, 6)]) = (-1.0, 1.0);
    (c[(5, 2)], c[(6, 2)]) = (2.0 * alpha, -2.0 * alpha);
    for axis in 0..2 {
        assert_close(&linear.b[axis].map(|x| x.value), &b[axis], 1e-15, "B");
        // Exactly the coefficients that are zero in the equations are structural zeros.
        for (own, published) in linear.b[axis].iter().zip(b[axis].iter()) {
            assert_eq!(own.is_structural_zero(), *published == 0.0);
        }
    }
    assert_close(&linear.c.map(|x| x.value), &c, 1e-15, "C");
    assert_eq!(linear.a[(2, 2)].value, inertia);

    // The reduced Cosserat solid has the first seven unknowns; the classical solid has no spin and one shear stress.
    let reduced =
        Isotropic { microrotation: Some(Microrotation { alpha, inertia, couple: None }), ..solid };
    reduced.rates::<2>().linearise(&mut linear);
    for axis in 0..2 {
        let block = b[axis].view((0, 0), (7, 7)).into_owned();
        assert_close(&linear.b[axis].map(|x| x.value), &block, 1e-15, "B of the reduced solid");
    }
    let block = c.view((0, 0), (7, 7)).into_owned();
    assert_close(&linear.c.map(|x| x.value), &block, 1e-15, "C of the reduced solid");
    Isotropic { microrotation: None, ..solid }.rates::<2>().linearise(&mut linear);
    #[rustfmt::skip]
    let b = [
        DMatrix::from_row_slice(5, 5, &[
            0.0, 0.0, -1.0, 0.0, 0.0,
            0.0, 0.0, 0.0, 0.0, -1.0,
            -(l + 2.0 * m), 0.0, 0.0, 0.0, 0.0,
            -l, 0.0, 0.0, 0.0, 0.0,
            0.0, -m, 0.0, 0.0, 0.0,
        ]),
        DMatrix::from_row_slice(5, 5, &[
            0.0, 0.0, 0.0, 0.0, -1.0,
            0.0, 0.0, 0.0, -1.0, 0.0,
            0.0, -l, 0.0, 0.0, 0.0,
            0.0, -(l + 2.0 * m), 0.0, 0.0, 0.0,
            -m, 0.0, 0.0, 0.0, 0.0,
        ]),
    ];
    for axis in 0..2 {
        assert_close(&linear.b[axis].map(|x| x.value), &b[axis], 1e-15, "B of the classical solid");
    }
    assert_eq!(linear.c.map(|x| x.value), DMatrix::zeros(5, 5));
}
