//! Tests of rejected input, and of spins without couple stress.

use super::random_solids::{random_isotropic, search_extremes};
use crate::support::states::seeded_generator;
use models::common::rounding::Rounded;
use models::solid::parameters::{Isotropic, Microrotation};
use wellposed_analysis::acoustic_tensor3::{AcousticTensor3, NormalSearchError, RankOneUpdate};

#[test]
fn invalid_input_is_rejected() {
    let random = &mut seeded_generator(12);
    let mut elastic = random_isotropic(random, false).rates::<3>();
    let normal = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(
        RankOneUpdate::new(&elastic, &normal[..5], &normal, 0.0),
        Err(NormalSearchError::LengthMismatch { given: 5, needed: 6 })
    );
    let backwards = normal.map(|x| -x);
    let refused = RankOneUpdate::new(&elastic, &normal, &backwards, 0.0);
    assert!(matches!(refused, Err(NormalSearchError::NoResponse(response)) if response < 0.0));
    let tensor = AcousticTensor3::new(&elastic).unwrap();
    let mut update = RankOneUpdate::new(&elastic, &normal, &normal, 0.0).unwrap();
    update.flow_image[0] = f64::NAN;
    let mut workspace = tensor.new_workspace();
    assert_eq!(tensor.search_extremes(&update, &mut workspace), Err(NormalSearchError::NotFinite));
    update.flow_image.clear();
    let refused = tensor.search_extremes(&update, &mut workspace);
    assert_eq!(refused, Err(NormalSearchError::LengthMismatch { given: 0, needed: 6 }));
    elastic.stiffness[(0, 0)] = Rounded::from_exact(-1.0);
    assert!(matches!(
        AcousticTensor3::new(&elastic),
        Err(NormalSearchError::NotPositiveDefinite { .. })
    ));
    elastic.stiffness[(0, 0)] = Rounded::from_exact(f64::INFINITY);
    assert!(matches!(AcousticTensor3::new(&elastic), Err(NormalSearchError::NotFinite)));
}

#[test]
fn spins_without_couple_stress_carry_no_waves() {
    let microrotation = Some(Microrotation { alpha: 0.3, inertia: 1.0, couple: None });
    let solid = Isotropic { lambda: 1.0, mu: 1.0, density: 1.0, microrotation };
    let tensor = AcousticTensor3::new(&solid.rates()).unwrap();
    let none = RankOneUpdate { flow_image: vec![0.0; 9], normal_image: vec![0.0; 9] };
    let found = search_extremes(&tensor, &none);
    assert!((found.slowest.squared_speed - 1.3).abs() < 1e-14);
    assert_eq!(found.max_imaginary_speed(), 0.0);
}
