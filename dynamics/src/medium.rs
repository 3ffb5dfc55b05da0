//! What a solid is to the sweeps.

use models::cosserat::parameters::{Isotropic, PlaneCompliances, Theory};
use models::cosserat::stress::Stress;
use models::cosserat::waves::{Field, Pair, Rotation, fields};
use models::plasticity::parameters::{Interlayer, Mises};
use models::plasticity::projection::PlaneMetric;

/// An elastic solid as pairs of waves along the axes and a rotation.
#[derive(Clone, Debug, PartialEq)]
pub struct Medium {
    /// The components of its state.
    pub fields: Vec<Field>,
    /// Pairs by axis; the same velocities and stresses in the same order for all media of a theory.
    pub pairs: Vec<Vec<Pair>>,
    /// Coupling of spins and antisymmetric stress.
    pub rotation: Option<Rotation>,
    /// What keeps the stress in its yield set.
    pub correction: Option<Correction>,
}

/// The projection onto a yield set, in the norm of the energy: associated flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Correction {
    /// von Mises, Drucker–Prager, Cosserat–Mises.
    Mises(Mises, Isotropic),
    /// Slip along layers, in plane strain.
    Interlayer(Interlayer, Isotropic),
}

impl Correction {
    /// The stress in the yield set next to `trial`, with the energy of the difference, J/m³, and the
    /// energy lost.
    pub fn project(&self, trial: &Stress) -> Corrected {
        let (stress, energy_lost, solid) = match self {
            Self::Mises(set, solid) => {
                let found = set.project(solid, trial);
                (found.stress, found.energy_lost, solid)
            }
            Self::Interlayer(set, solid) => {
                const PLACES: [(usize, usize); 4] = [(0, 0), (1, 1), (1, 0), (0, 1)];
                let force = |stress: &Stress| PLACES.map(|(i, j)| stress.force[i][j]);
                let [a, b, c, d] = force(trial);
                let own = [a, b, c, d, trial.couple[2][0], trial.couple[2][1]];
                let found = set.project(&PlaneMetric::from(solid), &own);
                let mut stress = *trial;
                for ((i, j), value) in PLACES.into_iter().zip(found.stress) {
                    stress.force[i][j] = value;
                }
                // Across the plane as elasticity has it: nothing is strained there, nothing flows.
                let normal = (found.stress[0] - a) + (found.stress[1] - b);
                stress.force[2][2] += solid.lambda / (2.0 * (solid.lambda + solid.mu)) * normal;
                let ratio = solid.couple().map_or(0.0, |m| (m.gamma - m.eta) / (m.gamma + m.eta));
                for axis in 0..2 {
                    let change = found.stress[4 + axis] - trial.couple[2][axis];
                    stress.couple[2][axis] = found.stress[4 + axis];
                    stress.couple[axis][2] += ratio * change;
                }
                (stress, found.energy_lost, solid)
            }
        };
        let part = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
            std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] - b[i][j]))
        };
        let difference = Stress {
            force: part(trial.force, stress.force),
            couple: part(trial.couple, stress.couple),
        };
        Corrected { stress, energy_lost, distance: solid.stored_energy(&difference) }
    }
}

/// What a correction does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corrected {
    /// P(s̄).
    pub stress: Stress,
    /// Energy of s̄ less that of P(s̄), J/m³.
    pub energy_lost: f64,
    /// Energy of s̄ − P(s̄), J/m³.
    pub distance: f64,
}

impl Medium {
    /// An isotropic solid in 2 (plane strain) or 3 dimensions.
    pub fn isotropic(solid: &Isotropic, dimensions: usize) -> Self {
        Self {
            fields: fields(solid.theory(), dimensions),
            pairs: (0..dimensions).map(|axis| solid.pairs(dimensions, axis)).collect(),
            rotation: solid.rotation(),
            correction: None,
        }
    }

    /// A solid by its compliances in plane strain; stresses across the plane stay zero.
    pub fn compliances(solid: &PlaneCompliances) -> Self {
        Self {
            fields: fields(Theory::Cosserat, 2),
            pairs: (0..2).map(|axis| solid.pairs(axis)).collect(),
            rotation: Some(solid.rotation()),
            correction: None,
        }
    }

    /// The greatest speed, m/s.
    pub fn greatest_speed(&self) -> f64 {
        self.pairs.iter().flatten().map(Pair::speed).fold(0.0, f64::max)
    }
}
