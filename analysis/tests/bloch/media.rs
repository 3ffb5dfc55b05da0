//! Blocky media of the tests: granite-like blocks of 50 mm with soft layers.

use models::interface::elastic::ElasticMaterial;
use models::interface::homogenised::{BlockMaterial, BlockyMedium};
use models::interface::opening_line::LayerMass;
use testkit::random::RandomNumbers;
use wellposed_analysis::bloch::chain::{Chain, ChainElement, ChainPolarisation, LayerCompliance};

/// Thicknesses of layers, m.
pub const THICKNESSES: [f64; 3] = [1e-4, 1e-3, 5e-3];

pub fn build_medium(thickness: f64) -> BlockyMedium {
    BlockyMedium {
        block: BlockMaterial { density: 2700.0, longitudinal_speed: 5000.0, shear_speed: 3000.0 },
        layer: ElasticMaterial {
            thickness,
            density: 1500.0,
            longitudinal_speed: 1000.0,
            shear_speed: 500.0,
        },
        period: 0.05,
    }
}

/// Chain of a block and a layer.
pub fn build_single_block_chain(
    medium: &BlockyMedium,
    is_lumped: bool,
    polarisation: ChainPolarisation,
) -> Chain {
    Chain::new(vec![
        ChainElement::from_block(&medium.block, medium.period, polarisation),
        ChainElement::from_layer(&medium.layer, is_lumped, polarisation),
    ])
    .expect("valid")
}

/// One to three random blocks, each followed by a layer; masses and compliances of layers between 0.01 and 10, some
/// layers lumped, massless or without compliance.
pub fn random_chain_elements(random: &mut RandomNumbers) -> Vec<ChainElement> {
    let count = 1 + (3.0 * random.uniform(0.0, 1.0)) as usize;
    let mut elements = Vec::new();
    for _ in 0..count {
        elements.push(ChainElement::Block {
            length: random.uniform(0.2, 2.0),
            speed: random.uniform(0.5, 2.0),
            impedance: random.uniform(0.3, 3.0),
        });
        let mass = match random.uniform(0.0, 1.0) {
            x if x < 0.2 => 0.0,
            _ => 10f64.powf(random.uniform(-2.0, 0.5)),
        };
        let opening_mass = mass * 0.25 * (2.0 * random.uniform(0.0, 1.0)).min(1.0).floor();
        let compliance = match random.uniform(0.0, 1.0) {
            x if x < 0.2 => 0.0,
            _ => 10f64.powf(random.uniform(-2.0, 1.0)),
        };
        elements.push(ChainElement::Layer {
            mass: LayerMass { mass, opening_mass },
            compliance: LayerCompliance::new_elastic(compliance),
        });
    }
    elements
}
