//! Verdict on the solid of a case, for studies whose results do not contain it otherwise.

use crate::case::{Case, ModelKind};
use crate::setup;
use analysis::solids::{AcousticTensorCache, SolidAssessor};
use serde::Serialize;

/// Verdict of the analysis on the solid of a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct SolidVerdict {
    /// Name of the verdict: `well-posed`, `ill-posed` or `marginal`.
    pub verdict: &'static str,
    /// Reason of the verdict: the structure of the equations, or the character of the wave speeds.
    #[serde(rename = "verdict_reason")]
    pub reason: String,
}

impl std::fmt::Display for SolidVerdict {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}: {}", self.verdict, self.reason)
    }
}

/// Decides the verdict on the solid of a case; `None` for other models, for granular and porous media, and if a yielding
/// solid has no stress.
pub fn decide_solid_verdict(case: &Case) -> Option<SolidVerdict> {
    let ModelKind::Solid(_) = case.material.kind else { return None };
    if case.material.contacts.is_some() {
        return None;
    }
    let solid = setup::solid::create_solid(&case.material).ok()?;
    if solid.is_symmetric_hyperbolic() {
        let reason = "the equations are symmetric hyperbolic".to_owned();
        return Some(SolidVerdict { verdict: "well-posed", reason });
    }
    let cache = AcousticTensorCache::default();
    let (assessment, _) = SolidAssessor::new(&cache).assess(&solid).ok()?;
    let reason = assessment.hyperbolicity.description().to_owned();
    Some(SolidVerdict { verdict: assessment.verdict.name(), reason })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_of_solids_are_stated() {
        let verdict = |name: &str| {
            let (path, text) = crate::case::find_bundled_case(name).unwrap();
            let verdict = decide_solid_verdict(&Case::parse(text, path, &[]).unwrap());
            verdict.map(|own| own.to_string())
        };
        let flutter = verdict("flutter").unwrap();
        assert!(flutter.starts_with("ill-posed: flutter"), "{flutter}");
        assert!(verdict("forbidden-band").unwrap().starts_with("well-posed"));
        assert_eq!(verdict("noncoaxiality-bound"), None);
    }
}
