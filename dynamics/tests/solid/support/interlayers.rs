//! Random interlayers, and junctions of saturated ones.

use super::random::NoiseSequence;
use models::interface::elastic::{ElasticComponent, ElasticMaterial};
use models::interface::layer::LayerLaw;
use models::interface::opening_line::LayerMass;
use models::interface::parameters::{
    LayerMaterial, MassDistribution, PlasticConstants, PorousConstants, SaturatedMaterial,
    TangentialConstants, ViscousConstants,
};
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::Problem;
use wellposed_dynamics::solid::interlayers::{
    InterlayerLaw, InterlayerPlane, Interlayers, MAX_PAIRS, PlaneLaws,
};

/// Returns an elastic component with a mass in kg/m² and a compliance in m/Pa.
pub fn elastic_component(mass: f64, compliance: f64) -> ElasticComponent<f64> {
    ElasticComponent { mass: LayerMass::new_box(mass), compliance }
}

/// Returns an elastic law with random constants.
fn random_elastic(random: &mut NoiseSequence) -> InterlayerLaw<f64> {
    let mut size = || 0.2 * 10f64.powf(1.5 * random.uniform_symmetric());
    InterlayerLaw::Elastic([(); MAX_PAIRS].map(|()| elastic_component(size(), size())))
}

/// Returns the material of a random saturated layer whose fluid has a wave speed of at most 0.7 m/s.
fn random_saturated(random: &mut NoiseSequence) -> SaturatedMaterial {
    let mut size = |scale: f64| scale * 10f64.powf(random.uniform_symmetric());
    let without_stiffness = SaturatedMaterial {
        thickness: size(0.05),
        skeleton_density: size(1.0),
        fluid_density: size(0.5),
        added_density: size(0.2),
        undrained_stiffness: size(0.4),
        pores: PorousConstants { collapse_stiffness: size(3.0), porosity: size(0.1).min(0.9) },
        coupling_stiffness: 0.0,
        fluid_stiffness: 1.0,
        instantaneous_compliance: size(3.0),
        viscous: ViscousConstants { delayed_compliance: size(3.0), viscosity: size(0.1) },
    };
    let speed = 0.4 + 0.3 * random.uniform_symmetric();
    let fluid_stiffness = speed * speed * without_stiffness.free_fluid_density();
    let bound = (fluid_stiffness * without_stiffness.undrained_stiffness).sqrt();
    let coupling_stiffness = 0.8 * bound * random.uniform_symmetric();
    SaturatedMaterial { fluid_stiffness, coupling_stiffness, ..without_stiffness }
}

/// Number of kinds of layer materials that [`material_of_kind`] builds.
pub const MATERIAL_KINDS: usize = 10;

/// Material constants of a layer, for stresses of order one.
struct LayerConstants {
    elastic: ElasticMaterial,
    plastic: PlasticConstants,
    viscous: ViscousConstants,
    pores: PorousConstants,
}

fn random_constants(random: &mut NoiseSequence) -> LayerConstants {
    let mut size = |scale: f64| scale * 10f64.powf(random.uniform_symmetric());
    let elastic = ElasticMaterial {
        thickness: size(0.05),
        density: size(1.0),
        longitudinal_speed: size(0.6),
        shear_speed: size(0.3),
    };
    let plastic =
        PlasticConstants { shear_strength: size(0.1), friction: size(0.3), hardening: size(0.3) };
    let viscous = ViscousConstants { delayed_compliance: size(3.0), viscosity: size(0.1) };
    let pores = PorousConstants { collapse_stiffness: size(3.0), porosity: size(0.09) };
    LayerConstants { elastic, plastic, viscous, pores }
}

/// Returns the material of a kind, from 0 to [`MATERIAL_KINDS`] − 1.
fn material_of_kind(
    random: &mut NoiseSequence,
    kind: usize,
    LayerConstants { elastic, plastic, viscous, pores }: LayerConstants,
) -> LayerMaterial {
    let tensile = 0.5 * plastic.shear_strength / plastic.friction;
    let PlasticConstants { shear_strength, hardening, .. } = plastic;
    match kind {
        0 => LayerMaterial::Plastic(elastic, plastic),
        1 => {
            let no_friction = PlasticConstants { friction: 0.0, ..plastic };
            LayerMaterial::Plastic(elastic, no_friction)
        }
        2 => LayerMaterial::Viscous(elastic, viscous),
        3 => LayerMaterial::Porous(elastic, pores, TangentialConstants::Elastic),
        4 => LayerMaterial::Porous(elastic, pores, TangentialConstants::Viscous(viscous)),
        5 => {
            let tangential = TangentialConstants::Plastic { shear_strength, hardening };
            LayerMaterial::Porous(elastic, pores, tangential)
        }
        6 => LayerMaterial::Cracked(elastic, None),
        7 => LayerMaterial::Cracked(elastic, Some(plastic.friction)),
        8 => LayerMaterial::Saturated(random_saturated(random)),
        _ => LayerMaterial::Breaking(elastic, plastic, tensile),
    }
}

/// Returns a layer with random constants of each of the [`MATERIAL_KINDS`] kinds, and of an elastic one, with the mass
/// in a box and lumped.
pub fn layers_of_all_kinds(random: &mut NoiseSequence) -> Vec<LayerLaw<f64>> {
    let mut laws = Vec::new();
    for distribution in [MassDistribution::Box, MassDistribution::Lumped] {
        for kind in 0..MATERIAL_KINDS {
            let constants = random_constants(random);
            let material = material_of_kind(random, kind, constants);
            laws.push(material.check().expect("sound constants").to_law(distribution));
        }
        laws.push(LayerMaterial::Elastic(random_constants(random).elastic).to_law(distribution));
    }
    laws
}

/// Returns a law of a random kind for stresses of order one.
pub fn random_layer(random: &mut NoiseSequence) -> LayerLaw<f64> {
    let constants = random_constants(random);
    let kind = random.uniform_index(MATERIAL_KINDS);
    let material = material_of_kind(random, kind, constants);
    let distribution = [MassDistribution::Box, MassDistribution::Lumped][random.uniform_index(2)];
    material.check().expect("sound constants").to_law(distribution)
}

/// Returns a random law for an axis of a medium: of any kind in a classical solid in the plane, else elastic.
fn random_law(random: &mut NoiseSequence, axis: usize, medium: &Medium) -> InterlayerLaw<f64> {
    match medium.pairs[axis].len() == 2 && !random.is_one_in(4) {
        true => InterlayerLaw::Plane(random_layer(random), axis),
        false => random_elastic(random),
    }
}

/// Returns interlayers normal to an axis of a grid of `cells` cells, at the lower faces of cells `offset`,
/// `offset + block_cells`, …: one law, or a random law, or none, at each face.
pub fn random_interlayers(
    random: &mut NoiseSequence,
    (axis, cells): (usize, &[usize]),
    [offset, block_cells]: [usize; 2],
    medium: &Medium,
) -> Interlayers {
    let law = random_law(random, axis, medium);
    let mut interlayers = Interlayers::new_regular(axis, cells[axis], [offset, block_cells], law);
    interlayers.has_open_ends = random.is_one_in(2);
    if random.is_one_in(2) {
        let count = 1 + random.uniform_index(3);
        interlayers.laws.extend((0..count).map(|_| random_law(random, axis, medium)));
        let faces = cells.iter().product::<usize>() / cells[axis];
        for plane in &mut interlayers.planes {
            let laws = (0..faces).map(|_| {
                let law = random.uniform_index(interlayers.laws.len() + 1);
                (law < interlayers.laws.len()).then_some(law as u16)
            });
            let laws = PlaneLaws::from_faces(laws);
            *plane = InterlayerPlane { cell: plane.cell, laws };
        }
    }
    interlayers
}

/// Gives one in four problems steps of shear waves of their own, if that is possible; coupled laws of interlayers are
/// replaced by random laws with independent components.
pub fn set_shear_interval<const D: usize>(random: &mut NoiseSequence, problem: &mut Problem<D>) {
    let shear_interval = [1, 1, 1, 1, 1, 1, 2, 3][random.uniform_index(8)];
    let mut changed = Problem { shear_interval, ..problem.clone() };
    for own in &mut changed.interlayers {
        let axis = own.axis;
        for law in &mut own.laws {
            while matches!(law, InterlayerLaw::Plane(layer, _) if layer.normal_variable_count().is_none())
            {
                *law = InterlayerLaw::Plane(random_layer(random), axis);
            }
        }
    }
    if shear_interval > 1 && changed.validate().is_ok() {
        *problem = changed;
    }
}

/// Counts the vertices of a grid in the plane where saturated layers along both axes meet.
pub fn count_saturated_junctions<const D: usize>(problem: &Problem<D>) -> usize {
    let cells = &problem.grid.cells;
    // Bit 1: a layer normal to the first axis ends there; bit 2: one normal to the second axis.
    let mut vertices = std::collections::BTreeMap::<[usize; 2], u8>::new();
    for face in problem.interlayer_faces() {
        let interlayers = problem.interlayers.iter().find(|own| own.axis == face.axis);
        let law = interlayers.and_then(|own| own.laws.get(face.law));
        let Some(InterlayerLaw::Plane(LayerLaw::Saturated(_), _)) = law else { continue };
        let along = 1 - face.axis;
        let lower = [face.cell % cells[0], face.cell / cells[0]];
        let mut upper = lower;
        upper[along] += 1;
        if problem.boundaries[along][0] == Boundary::Periodic {
            upper[along] %= cells[along];
        }
        for vertex in [lower, upper] {
            *vertices.entry(vertex).or_default() |= 1 << face.axis;
        }
    }
    vertices.values().filter(|axes| **axes == 3).count()
}
