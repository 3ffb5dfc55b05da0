//! Tests of refused input, and of spins without couple stress.

use crate::random_solids::{isotropic, search};
use crate::support::states::seeded;
use models::common::rounding::Rounded;
use models::solid::parameters::{Isotropic, Microrotation};
use wellposed_analysis::sphere::{AcousticTensor3, RankOne, SphereError};

#[test]
fn what_cannot_be_searched_is_refused() {
    let random = &mut seeded(12);
    let mut elastic = isotropic(random, false).rates::<3>();
    let normal = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(
        RankOne::new(&elastic, &normal[..5], &normal, 0.0),
        Err(SphereError::Mismatch { given: 5, needed: 6 })
    );
    let backwards = normal.map(|x| -x);
    let refused = RankOne::new(&elastic, &normal, &backwards, 0.0);
    assert!(matches!(refused, Err(SphereError::NoResponse(response)) if response < 0.0));
    let sphere = AcousticTensor3::new(&elastic).unwrap();
    let mut update = RankOne::new(&elastic, &normal, &normal, 0.0).unwrap();
    update.image[0] = f64::NAN;
    let mut workspace = sphere.workspace();
    assert_eq!(sphere.search(&update, &mut workspace), Err(SphereError::NotFinite));
    update.image.clear();
    let refused = sphere.search(&update, &mut workspace);
    assert_eq!(refused, Err(SphereError::Mismatch { given: 0, needed: 6 }));
    elastic.stiffness[(0, 0)] = Rounded::exact(-1.0);
    assert!(matches!(AcousticTensor3::new(&elastic), Err(SphereError::NotElastic { .. })));
    elastic.stiffness[(0, 0)] = Rounded::exact(f64::INFINITY);
    assert!(matches!(AcousticTensor3::new(&elastic), Err(SphereError::NotFinite)));
}

#[test]
fn spins_without_couple_stress_carry_no_waves() {
    let microrotation = Some(Microrotation { alpha: 0.3, inertia: 1.0, couple: None });
    let solid = Isotropic { lambda: 1.0, mu: 1.0, density: 1.0, microrotation };
    let sphere = AcousticTensor3::new(&solid.rates()).unwrap();
    let none = RankOne { image: vec![0.0; 9], covector: vec![0.0; 9] };
    let found = search(&sphere, &none);
    assert!((found.slowest.speed_squared - 1.3).abs() < 1e-14);
    assert_eq!(found.growth(), 0.0);
}
