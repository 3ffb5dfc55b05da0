//! Residuals of the optimality conditions of a projection onto a yield set.

/// Tolerance of every optimality condition, relative to the magnitude of its terms.
pub const OPTIMALITY_TOLERANCE: f64 = 1e-12;

/// Residuals of the optimality conditions, of the energy lost and of a second projection, each divided by its scale.
#[derive(Clone, Copy, Debug, Default)]
pub struct OptimalityResiduals {
    pub feasibility: f64,
    pub complementarity: f64,
    pub normality: f64,
    pub energy: f64,
    pub idempotence: f64,
}

impl OptimalityResiduals {
    pub fn accumulate_max(&mut self, other: &Self) {
        self.feasibility = self.feasibility.max(other.feasibility);
        self.complementarity = self.complementarity.max(other.complementarity);
        self.normality = self.normality.max(other.normality);
        self.energy = self.energy.max(other.energy);
        self.idempotence = self.idempotence.max(other.idempotence);
    }

    pub fn assert_below_tolerance(&self, context: impl std::fmt::Debug) {
        let all =
            [self.feasibility, self.complementarity, self.normality, self.energy, self.idempotence];
        assert!(all.iter().all(|r| *r <= OPTIMALITY_TOLERANCE), "{self:?} at {context:?}");
    }
}
