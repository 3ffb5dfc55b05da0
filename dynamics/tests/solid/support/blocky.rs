//! Blocky media of rock with thin elastic interlayers.

use models::interface::elastic::ElasticMaterial;
use models::interface::layer::LayerLaw;
use models::interface::parameters::{LayerMaterial, MassDistribution};
use models::solid::parameters::Isotropic;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::solid::interlayers::{InterlayerLaw, Interlayers};

/// Edge length of a block, m.
pub const BLOCK_LENGTH: f64 = 0.05;
/// Density of the rock, kg/m³.
pub const ROCK_DENSITY: f64 = 2700.0;
/// Speeds of P and S waves in the rock, m/s.
pub const ROCK_SPEEDS: [f64; 2] = [5000.0, 3000.0];
/// Thicknesses of interlayers, m.
pub const THICKNESSES: [f64; 3] = [1e-4, 1e-3, 5e-3];

/// Returns the medium of the blocks: rock in plane strain.
pub fn rock() -> Medium {
    let [longitudinal, shear] = ROCK_SPEEDS.map(|speed| ROCK_DENSITY * speed * speed);
    let solid = Isotropic::new(longitudinal - 2.0 * shear, shear, ROCK_DENSITY, None);
    Medium::new(solid.expect("sound moduli"), 2)
}

/// Returns the material of interlayers of a thickness, m.
pub fn layer_material(thickness: f64) -> ElasticMaterial {
    ElasticMaterial { thickness, density: 1500.0, longitudinal_speed: 1000.0, shear_speed: 500.0 }
}

/// Returns the elastic law of interlayers of a thickness, m; their mass is distributed by the box scheme.
pub fn elastic_layer(thickness: f64) -> LayerLaw<f64> {
    LayerMaterial::Elastic(layer_material(thickness)).to_law(MassDistribution::Box)
}

/// Returns a problem of `blocks` blocks of rock of `cells` × `cells` cells, with the same law between all of them; the
/// Courant number of P waves in a sweep is 1. On periodic axes there are interlayers at the boundary, too.
pub fn blocky_problem(
    blocks: [usize; 2],
    cells: usize,
    law: LayerLaw<f64>,
    boundaries: [[Boundary; 2]; 2],
) -> Problem<2> {
    let spacing = BLOCK_LENGTH / cells as f64;
    let grid = Grid { cells: blocks.map(|count| count * cells), spacing: [spacing; 2] };
    let interlayers = [0, 1].map(|axis| {
        let offset = if boundaries[axis][0] == Boundary::Periodic { 0 } else { cells };
        let law = InterlayerLaw::Plane(law, axis);
        Interlayers::new_regular(axis, grid.cells[axis], [offset, cells], law)
    });
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let (media, step) = (vec![rock()], 2.0 * spacing / ROCK_SPEEDS[0]);
    let cell_media = vec![0; grid.count()];
    Problem {
        interlayers: interlayers.to_vec(),
        ..Problem::new(grid, media, cell_media, boundaries, step, scheme)
    }
}
