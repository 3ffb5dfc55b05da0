//! Granular flow in time: SKELETON of the interface; the bodies are being written elsewhere.
#![allow(missing_docs, clippy::todo, dead_code, unused_variables)]

/// What determines the stress angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closure { HarrisGrekova, DoubleShearing, PlasticPotential }

impl Closure {
    /// The field that evolves beside the velocity: the spin ω (Harris–Grekova), the stress angle ψ
    /// (double shearing), or none (plastic potential).
    pub fn inner(self) -> Option<Field> { todo!() }
}

/// A field of the flow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Field {
    /// v − Γx, m/s.
    Velocity(usize),
    /// ω, rad/s (Harris–Grekova alone).
    Spin,
    /// ψ, rad.
    StressAngle,
    /// p, Pa.
    Pressure,
    /// Q_D, 1/s.
    ShearRate,
}

/// What is to be solved.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    pub closure: Closure,
    /// ρ, kg/m³.
    pub density: f64,
    /// φ, rad.
    pub friction_angle: f64,
    /// c, Pa.
    pub cohesion: f64,
    /// Mean of p, Pa.
    pub pressure: f64,
    /// Γ, entry [i][j] = ∂ⱼVᵢ, 1/s; traceless.
    pub velocity_gradient: [[f64; 2]; 2],
    /// Ψ at the beginning, rad.
    pub stress_angle: f64,
    /// Ω at the beginning, rad/s (Harris–Grekova alone).
    pub spin: f64,
    /// DΩ/Dt, rad/s² (Harris–Grekova alone).
    pub spin_acceleration: f64,
    /// Points along each axis of the box that moves with the mean flow; even, at least 8.
    pub points: [usize; 2],
    /// Edges of the box at the beginning, m.
    pub lengths: [f64; 2],
    /// Tolerance of a step relative to the perturbation.
    pub tolerance: f64,
    /// Residual of the pressure equation relative to its right-hand side.
    pub pressure_tolerance: f64,
    /// Least Q_D relative to that of the background (plastic potential alone).
    pub least_shear_rate: f64,
}

/// A problem that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    #[error("{0}")]
    Problem(String),
}

/// A point has left the fully deforming region, or the numbers have ended.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what}")]
pub struct Left {
    /// What happened, with its values.
    pub what: String,
    /// Where, in coordinates of the box at the beginning, m.
    pub at: [f64; 2],
    /// When, s.
    pub time: f64,
}

/// Energy of the perturbation per area of the box, J/m³, and what changed it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// ½ρ⟨|v'|²⟩.
    pub kinetic: f64,
    /// −∫ρ⟨v'·Γv'⟩dt: what the background gave.
    pub background: f64,
    /// −∫⟨s : ∇v'⟩dt, of the deviatoric stress s = qN: what the stress gave.
    pub stress: f64,
    /// Internal power ⟨2Q_D q cos 2Δ⟩ now, W/m³.
    pub power: f64,
}

/// A flow in time.
pub struct Flow {}

/// All that a flow needs to go on with the same bits.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Steps done.
    pub steps: usize,
    /// Numbers by kind, always as many and in the same order.
    pub parts: Vec<Vec<f64>>,
}

impl Flow {
    /// The background alone. Parallel over the threads of the surrounding rayon pool; bits do not depend
    /// on their number.
    pub fn new(problem: &Problem) -> Result<Self, FlowError> { todo!() }
    /// Fields at the points (i + ½)L₁/N₁, (j + ½)L₂/N₂, the first axis running fastest: perturbations of
    /// velocity, and of ω or ψ (ignored by the plastic potential). What is not free of divergence or too short
    /// for the grid is left out.
    pub fn perturb(&mut self, velocity: [&[f64]; 2], inner: &[f64]) { todo!() }
    /// One step, not beyond `until`, s. On error the state is the one before.
    pub fn advance(&mut self, until: f64) -> Result<(), Left> { todo!() }
    /// s.
    pub fn time(&self) -> f64 { todo!() }
    /// Steps done.
    pub fn steps(&self) -> usize { todo!() }
    /// Fields that this closure has, velocities first.
    pub fn fields(&self) -> Vec<Field> { todo!() }
    /// Values of all of these at the points; error where the state has no stress.
    pub fn values(&mut self) -> Result<Vec<Vec<f64>>, Left> { todo!() }
    /// F = exp(Γt): a point y of the box is at Fy.
    pub fn deformation(&self) -> [[f64; 2]; 2] { todo!() }
    pub fn energy(&mut self) -> Result<Energy, Left> { todo!() }
    /// ρ/2 times the power of the velocity in shells n − ½ ≤ |m| < n + ½ of mode numbers m = (m₁, m₂),
    /// n = 1, 2, …, J/m³.
    pub fn spectrum(&self) -> Vec<f64> { todo!() }
    /// Means over the last step, for a line of progress: iterations of the pressure per evaluation, stages.
    pub fn effort(&self) -> (f64, usize) { todo!() }
    pub fn snapshot(&self) -> Snapshot { todo!() }
    /// Whether the snapshot was one of this problem.
    pub fn restore(&mut self, snapshot: &Snapshot) -> bool { todo!() }
}
