//! Verifies that measured and expected rates agree if solver and analysis have the same moduli, that they differ for a
//! modulus that differs by 1e-9, and that invalid problems are rejected.

use dynamics::medium::Medium;
use dynamics::problem::{PlasticStep, Splitting};
use models::elastoplastic::Solid;
use models::solid::ElasticLaw;
use models::solid::parameters::{Isotropic, Microrotation};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use wellposed_agreement::solids::{
    BranchResult, SolverSettings, compare_band_gaps, compare_branches,
};
use wellposed_agreement::{AgreementError, PlaneWave};

const WAVES: [PlaneWave<3>; 2] = [
    PlaneWave { wave_number: 0.3, normal: [0.6, 0.8, 0.0] },
    PlaneWave { wave_number: 2.6, normal: [1.0, 0.0, 0.0] },
];

fn elastic_law(alpha: f64) -> ElasticLaw {
    let microrotation = Microrotation { alpha, inertia: 2700.0, couple: None };
    Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(microrotation)).expect("a solid").into()
}

fn solver_settings() -> SolverSettings {
    SolverSettings {
        cells_per_wavelength: vec![12, 16],
        courant_number: 0.9,
        max_rotation: 0.5,
        plastic_step: PlasticStep::ReturnMapping,
        splitting: Splitting::Alternating,
    }
}

fn compare_with_solver_modulus(measured: f64) -> Vec<BranchResult> {
    let (solid, medium) =
        (Solid::new(elastic_law(1e9), 2, None), Medium::new(elastic_law(measured), 2));
    let go_on = |_: usize, _: usize| ControlFlow::Continue(());
    compare_branches(&solid, &medium, &WAVES, &solver_settings(), &go_on).expect("results")
}

#[test]
fn measured_branches_and_band_gap_agree() {
    let results = compare_with_solver_modulus(1e9);
    assert_eq!(results.len(), 6);
    assert!(results.iter().all(|own| own.is_within_tolerance() == Some(true)), "{results:?}");
    let gaps =
        compare_band_gaps(&Solid::new(elastic_law(1e9), 2, None), &WAVES, &results).expect("gaps");
    assert!(gaps.len() == 1 && gaps[0].is_confirmed, "{gaps:?}");
}

#[test]
fn wrong_modulus_is_detected() {
    let results = compare_with_solver_modulus(1e9 * (1.0 + 1e-9));
    assert!(results.iter().any(|own| own.is_within_tolerance() == Some(false)), "{results:?}");
}

#[test]
fn progress_callback_counts_tasks_and_cancels() {
    let (solid, medium) = (Solid::new(elastic_law(1e9), 2, None), Medium::new(elastic_law(1e9), 2));
    let most = AtomicUsize::new(0);
    let count = |done: usize, total: usize| {
        assert_eq!(total, 12);
        most.fetch_max(done, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    compare_branches(&solid, &medium, &WAVES, &solver_settings(), &count).expect("results");
    assert_eq!(most.into_inner(), 12);
    let cancel = |_: usize, _: usize| ControlFlow::Break(());
    let found = compare_branches(&solid, &medium, &WAVES, &solver_settings(), &cancel);
    assert_eq!(found, Err(AgreementError::Cancelled));
}

#[test]
fn mismatched_input_is_rejected() {
    let solid = Solid::new(elastic_law(1e9), 3, None);
    let go_on = |_: usize, _: usize| ControlFlow::Continue(());
    let refused = |medium: &Medium, settings: &SolverSettings| {
        compare_branches(&solid, medium, &WAVES, settings, &go_on).expect_err("refused")
    };
    let none = SolverSettings { cells_per_wavelength: Vec::new(), ..solver_settings() };
    assert_eq!(refused(&Medium::new(elastic_law(1e9), 3), &none), AgreementError::NoGrids);
    let found = refused(&Medium::new(elastic_law(1e9), 2), &solver_settings());
    assert_eq!(found, AgreementError::DimensionMismatch { solid: 3, medium: 2 });
    let found = refused(
        &Medium::new(elastic_law(1e9), 3),
        &SolverSettings { max_rotation: 1e-9, ..solver_settings() },
    );
    assert!(matches!(found, AgreementError::TooManyCellUpdates { .. }), "{found}");
}
