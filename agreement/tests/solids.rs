//! Verifies that consistent solids agree, that inconsistent ones do not, and that invalid problems are rejected.

use dynamics::medium::Medium;
use dynamics::problem::{PlasticStep, Splitting};
use models::elastoplastic::Solid;
use models::solid::ElasticLaw;
use models::solid::parameters::{Isotropic, Microrotation};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use wellposed_agreement::solids::{BranchResult, SolverSettings, band_gaps, branch_results};
use wellposed_agreement::{AgreementError, PlaneWave};

const WAVES: [PlaneWave<3>; 2] = [
    PlaneWave { number: 0.3, normal: [0.6, 0.8, 0.0] },
    PlaneWave { number: 2.6, normal: [1.0, 0.0, 0.0] },
];

fn law(alpha: f64) -> ElasticLaw {
    let microrotation = Microrotation { alpha, inertia: 2700.0, couple: None };
    Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(microrotation)).expect("a solid").into()
}

fn settings() -> SolverSettings {
    SolverSettings {
        cells: vec![12, 16],
        courant: 0.9,
        rotation: 0.5,
        plastic_step: PlasticStep::ReturnMapping,
        splitting: Splitting::Alternating,
    }
}

fn results(measured: f64) -> Vec<BranchResult> {
    let (solid, medium) = (Solid::new(law(1e9), 2, None), Medium::new(law(measured), 2));
    let go_on = |_: usize, _: usize| ControlFlow::Continue(());
    branch_results(&solid, &medium, &WAVES, &settings(), &go_on).expect("results")
}

#[test]
fn branches_and_their_band_gap_agree() {
    let results = results(1e9);
    assert_eq!(results.len(), 6);
    assert!(results.iter().all(|own| own.agrees() == Some(true)), "{results:?}");
    let gaps = band_gaps(&Solid::new(law(1e9), 2, None), &WAVES, &results).expect("gaps");
    assert!(gaps.len() == 1 && gaps[0].agrees, "{gaps:?}");
}

#[test]
fn a_wrong_modulus_is_caught() {
    let results = results(1e9 * (1.0 + 1e-9));
    assert!(results.iter().any(|own| own.agrees() == Some(false)), "{results:?}");
}

#[test]
fn the_callback_counts_and_cancels() {
    let (solid, medium) = (Solid::new(law(1e9), 2, None), Medium::new(law(1e9), 2));
    let most = AtomicUsize::new(0);
    let count = |done: usize, total: usize| {
        assert_eq!(total, 12);
        most.fetch_max(done, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    branch_results(&solid, &medium, &WAVES, &settings(), &count).expect("results");
    assert_eq!(most.into_inner(), 12);
    let cancel = |_: usize, _: usize| ControlFlow::Break(());
    let found = branch_results(&solid, &medium, &WAVES, &settings(), &cancel);
    assert_eq!(found, Err(AgreementError::Cancelled));
}

#[test]
fn what_does_not_fit_is_refused() {
    let solid = Solid::new(law(1e9), 3, None);
    let go_on = |_: usize, _: usize| ControlFlow::Continue(());
    let refused = |medium: &Medium, settings: &SolverSettings| {
        branch_results(&solid, medium, &WAVES, settings, &go_on).expect_err("refused")
    };
    let none = SolverSettings { cells: Vec::new(), ..settings() };
    assert_eq!(refused(&Medium::new(law(1e9), 3), &none), AgreementError::NoGrids);
    let found = refused(&Medium::new(law(1e9), 2), &settings());
    assert_eq!(found, AgreementError::Dimensions { solid: 3, medium: 2 });
    let found =
        refused(&Medium::new(law(1e9), 3), &SolverSettings { rotation: 1e-9, ..settings() });
    assert!(matches!(found, AgreementError::TooLong { .. }), "{found}");
}
