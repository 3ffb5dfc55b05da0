//! States of models given as equations, read from the bundled cases.

use cases::Case;
use models::equations::{ModelText, TextModel};
use wellposed_analysis::StateError;
use wellposed_analysis::equations::{EquationsAssessment, EquationsWorkspace};
use wellposed_analysis::growth::Verdict;

/// A bundled case with other numbers.
pub fn read_case(name: &str, sets: &[String]) -> Case {
    let path = format!("cases/equations/{name}.toml");
    let (_, text) = cases::CASES.iter().find(|(own, _)| *own == path).expect("a bundled case");
    Case::parse(text, &path, sets).unwrap_or_else(|error| panic!("{error}"))
}

/// The model text of a bundled case.
pub fn model_text(name: &str) -> ModelText {
    read_case(name, &[]).require_equations().expect("equations").model.text().clone()
}

/// A state of a bundled case: model, workspace and assessment.
pub struct Assessed {
    pub model: std::sync::Arc<TextModel>,
    pub workspace: EquationsWorkspace,
    pub found: EquationsAssessment,
}

impl Assessed {
    pub fn try_new(name: &str, sets: &[String]) -> Result<Self, StateError> {
        let case = read_case(name, sets);
        let equations = case.require_equations().expect("equations");
        let (model, mut state) = (equations.model.clone(), equations.state(&case.material.numbers));
        let mut workspace = EquationsWorkspace::default();
        let found = workspace.assess(&model, &mut state)?;
        Ok(Self { model, workspace, found })
    }

    pub fn new(name: &str, sets: &[String]) -> Self {
        Self::try_new(name, sets).unwrap_or_else(|error| panic!("{name} {sets:?}: {error}"))
    }

    pub fn verdict(&self) -> &'static str {
        self.found.assessment.verdict.name()
    }

    /// Order and coefficient of an ill-posed state.
    pub fn growth(&self) -> (f64, f64) {
        match &self.found.assessment.verdict {
            Verdict::IllPosed { growth: Some(growth), .. } => {
                (growth.order.to_f64(), growth.coefficient)
            }
            other => panic!("{other:?}"),
        }
    }

    /// Supremum of the growth rate of a well-posed state.
    pub fn supremum(&self) -> f64 {
        let found = self.workspace.locate_supremum(&self.model, &self.found).expect("finite");
        found.expect("well-posed").0.growth_rate
    }
}

/// Asserts that two numbers agree to a relative tolerance.
pub fn assert_close(what: &str, found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance * expected.abs(),
        "{what}: {found}, not {expected}"
    );
}
