//! Verdict on the solid of a case, for verbs whose reports do not contain it.

use crate::case::{Case, ModelKind};
use crate::setup;
use analysis::solids::{AcousticTensorCache, SolidAssessor};
use std::io::Write;

/// Prints the verdict on the solid of a case to standard error: nothing for other models, for granular and porous media,
/// or if a yielding solid has no stress.
pub(super) fn print_solid_verdict(case: &Case) {
    if let Some(verdict) = describe_solid_verdict(case) {
        // A closed standard error is ignored.
        let _ = writeln!(std::io::stderr(), "verdict of the analysis: {verdict}");
    }
}

fn describe_solid_verdict(case: &Case) -> Option<String> {
    let ModelKind::Solid(_) = case.material.kind else { return None };
    if case.material.contacts.is_some() {
        return None;
    }
    let solid = setup::solid::create_solid(&case.material).ok()?;
    if solid.is_symmetric_hyperbolic() {
        return Some("well-posed: the equations are symmetric hyperbolic".to_owned());
    }
    let cache = AcousticTensorCache::default();
    let (assessment, _) = SolidAssessor::new(&cache).assess(&solid).ok()?;
    let (verdict, speeds) = (assessment.verdict.name(), assessment.hyperbolicity.description());
    Some(format!("{verdict}: {speeds} (wellposed point has the evidence)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_of_solids_are_stated() {
        let verdict = |name: &str| {
            let (path, text) = crate::case::find_bundled_case(name).unwrap();
            describe_solid_verdict(&Case::parse(text, path, &[]).unwrap())
        };
        let flutter = verdict("flutter").unwrap();
        assert!(flutter.starts_with("ill-posed: flutter"), "{flutter}");
        assert!(verdict("forbidden-band").unwrap().starts_with("well-posed"));
        assert_eq!(verdict("noncoaxiality-bound"), None);
    }
}
