//! Random elastic solids given by compliances.

use super::RandomNumbers;
use wellposed_models::solid::parameters::PlaneCompliances;

/// Random compliances of a cubic solid in plane strain with |b₁|/a₁ and |b₂|/a₂ below `max_ratio` < 1.
pub fn random_plane_compliances(random: &mut RandomNumbers, max_ratio: f64) -> PlaneCompliances {
    let (a1, a2) = (random.uniform(0.5, 2.0), random.uniform(0.5, 2.0));
    PlaneCompliances {
        a1,
        b1: a1 * random.uniform(-max_ratio, max_ratio),
        a2,
        b2: a2 * random.uniform(-max_ratio, max_ratio),
        alpha2: random.uniform(0.5, 2.0),
        density: random.uniform(0.5, 2.0),
        inertia: random.uniform(0.5, 2.0),
    }
    .check()
    .unwrap()
}
