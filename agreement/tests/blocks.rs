//! Verifies that measured frequencies of Bloch waves agree with those of the analysis for all kinds of layers with a
//! linear state, that a factor in the law of a layer that differs by 1e-9 is detected, and that layers without linear
//! state are rejected.

use dynamics::medium::Medium;
use models::interface::elastic::ElasticMaterial;
use models::interface::homogenised::BlockMaterial;
use models::interface::layer::LayerLaw;
use models::interface::opening_line::LayerMass;
use models::interface::parameters::{
    LayerMaterial, MassDistribution, PlasticConstants, PorousConstants, TangentialConstants,
    ViscousConstants,
};
use models::solid::ElasticLaw;
use models::solid::parameters::Isotropic;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use wellposed_agreement::AgreementError;
use wellposed_agreement::blocks::{
    BlochResult, BlockSettings, BlockWave, BlockyCell, Layer, SolverBlocks, compare_blocks,
};

const BLOCK: BlockMaterial =
    BlockMaterial { density: 2700.0, longitudinal_speed: 5000.0, shear_speed: 3000.0 };
const VISCOUS: ViscousConstants =
    ViscousConstants { delayed_compliance: 2.0 / 3.75e8, viscosity: 7500.0 };

/// Elastic layer of a thickness, m.
fn elastic_layer(thickness: f64) -> ElasticMaterial {
    ElasticMaterial { thickness, density: 1500.0, longitudinal_speed: 1000.0, shear_speed: 500.0 }
}

fn build_medium(block: &BlockMaterial) -> Medium {
    let law = Isotropic::new(block.lame_modulus(), block.shear_modulus(), block.density, None);
    Medium::new(ElasticLaw::from(law.expect("a solid")), 2)
}

/// Square blocks with the same layers across both axes.
fn build_square_blocks(material: LayerMaterial, mass: MassDistribution) -> BlockyCell {
    BlockyCell {
        sides: [0.05; 2],
        blocks: [1; 2],
        row_shift: 0.0,
        materials: vec![BLOCK],
        layers: [Some(Layer { material, mass }); 2],
    }
}

fn build_solver_blocks(cell: &BlockyCell) -> SolverBlocks {
    SolverBlocks {
        media: cell.materials.iter().map(build_medium).collect(),
        laws: cell.layers.map(|layer| layer.map(|own| own.material.to_law(own.mass))),
    }
}

/// Waves of the two lowest branches at `phase_shift_count` phase shifts of chains and `wave_vector_count` wave vectors
/// in the plane.
fn wave_settings(phase_shift_count: usize, wave_vector_count: usize) -> BlockSettings {
    BlockSettings {
        branch_count: 2,
        phase_shift_count,
        wave_vector_count,
        cells_per_block: vec![4, 8, 16],
        courant_number: 0.9,
    }
}

fn compare_waves(
    predicted: &BlockyCell,
    measured: &SolverBlocks,
    settings: &BlockSettings,
) -> Vec<BlochResult> {
    let go_on = |_: usize, _: usize| ControlFlow::Continue(());
    compare_blocks(predicted, measured, settings, &go_on).expect("results")
}

/// Prints a result, and returns whether measured and expected rates agree.
fn print_and_check_result(own: &BlochResult) -> bool {
    let agrees = own.is_within_tolerance() == Some(true);
    let Ok(measurement) = &own.measurement else {
        println!("{own:?}");
        return agrees;
    };
    let limit = &measurement.limit;
    let error = own.relative_difference(limit.measured_rate);
    println!(
        "{:?} {:.1?} {}: ω = {:.6e} {:+.2e}i, error {:+.1e} {:+.1e}, off {:.1e} of {:.1e}, order {:.2?}, {agrees}",
        own.wave,
        own.wave_vector,
        own.branch,
        own.predicted_rate.frequency,
        own.predicted_rate.growth_rate,
        error.frequency,
        error.growth_rate,
        (limit.measured_rate - limit.expected_rate).max_norm() / own.predicted_rate.frequency,
        limit.tolerance / own.predicted_rate.frequency,
        own.convergence_order(),
    );
    agrees
}

fn is_chain(own: &BlochResult) -> bool {
    own.wave != BlockWave::Cell
}

/// Verifies that all waves agree, chains at the level of rounding and with order 2.
fn assert_agreement(cell: &BlockyCell, settings: &BlockSettings) {
    let results = compare_waves(cell, &build_solver_blocks(cell), settings);
    assert!(
        results.iter().filter(|own| !print_and_check_result(own)).count() == 0,
        "a disagreement"
    );
    for own in results.iter().filter(|own| is_chain(own)) {
        let tolerance = own.measurement.as_ref().expect("a measurement").limit.tolerance;
        assert!(tolerance < 1e-10 * own.predicted_rate.frequency, "{own:?}");
        let order = own.convergence_order().expect("an order");
        assert!((1.9..2.1).contains(&order), "order {order}");
    }
}

/// Verifies agreement for elastic layers, and precomputed frequencies (kHz) of longitudinal waves of the chain at
/// κh = π/4, π/2 and π.
#[test]
fn elastic_layer_frequencies_agree() {
    for (thickness, expected) in [
        (1e-4, [11.96405, 23.91230, 45.89261]),
        (1e-3, [8.96731, 17.56580, 28.44161]),
        (5e-3, [5.11290, 9.73241, 14.47159]),
    ] {
        let material = LayerMaterial::Elastic(elastic_layer(thickness));
        let cell = build_square_blocks(material, MassDistribution::Box);
        let results = compare_waves(&cell, &build_solver_blocks(&cell), &wave_settings(4, 0));
        let frequency = |index: usize| {
            results[4 * index].predicted_rate.frequency / (2e3 * std::f64::consts::PI)
        };
        for (index, expected) in [1, 0, 3].into_iter().zip(expected) {
            assert!((frequency(index) - expected).abs() < 6e-6, "{}", frequency(index));
        }
        assert_agreement(&cell, &wave_settings(4, 0));
    }
}

#[test]
fn waves_in_the_plane_agree() {
    let material = LayerMaterial::Elastic(elastic_layer(5e-3));
    let cell = build_square_blocks(material, MassDistribution::Box);
    let results = compare_waves(&cell, &build_solver_blocks(&cell), &wave_settings(0, 3));
    assert_eq!(results.len(), 6);
    for own in &results {
        assert!(print_and_check_result(own));
        // Three grids of up to 16 cells give frequencies to 1.3 % at worst, by the difference of their extrapolations.
        let tolerance = own.measurement.as_ref().expect("a measurement").limit.tolerance;
        assert!(tolerance < 1.5e-2 * own.predicted_rate.frequency, "{own:?}");
    }
}

#[test]
fn lumped_masses_and_layers_of_one_axis_agree() {
    let material = LayerMaterial::Elastic(elastic_layer(1e-3));
    let mut cell = build_square_blocks(material, MassDistribution::Lumped);
    assert_agreement(&cell, &wave_settings(2, 1));
    cell.layers[0] = None;
    cell.sides = [0.04, 0.07];
    let results = compare_waves(&cell, &build_solver_blocks(&cell), &wave_settings(1, 3));
    // No waves in the plane: blocks are welded along x₁.
    assert_eq!(results.len(), 4);
    assert!(results.iter().all(|own| print_and_check_result(own) && own.wave_vector[0] == 0.0));
}

/// Verifies that complex frequencies agree for viscous layers, which damp waves.
#[test]
fn damped_waves_of_viscous_layers_agree() {
    let cell = build_square_blocks(
        LayerMaterial::Viscous(elastic_layer(1e-3), VISCOUS),
        MassDistribution::Box,
    );
    let results = compare_waves(&cell, &build_solver_blocks(&cell), &wave_settings(2, 1));
    assert!(
        results.iter().filter(|own| !print_and_check_result(own)).count() == 0,
        "a disagreement"
    );
    let damped =
        |own: &&BlochResult| own.predicted_rate.growth_rate < -1e-3 * own.predicted_rate.frequency;
    assert!(results.iter().filter(damped).count() > results.len() / 3);
}

#[test]
fn weak_waves_in_nonlinear_layers_agree() {
    let own = elastic_layer(1e-3);
    let plastic = PlasticConstants { shear_strength: 1e6, friction: 0.5, hardening: 1e9 };
    let pores = PorousConstants { collapse_stiffness: 1.35e10, porosity: 1e-5 };
    for material in [
        LayerMaterial::Plastic(own, plastic),
        LayerMaterial::Breaking(own, plastic, 5e5),
        LayerMaterial::Porous(own, pores, TangentialConstants::Elastic),
    ] {
        assert_agreement(
            &build_square_blocks(material, MassDistribution::Box),
            &wave_settings(1, 1),
        );
    }
    let viscous = LayerMaterial::Porous(own, pores, TangentialConstants::Viscous(VISCOUS));
    let cell = build_square_blocks(viscous, MassDistribution::Box);
    assert!(
        compare_waves(&cell, &build_solver_blocks(&cell), &wave_settings(1, 0))
            .iter()
            .all(print_and_check_result)
    );
}

/// Verifies agreement for masonry, and for blocks of two materials in a checkerboard.
#[test]
fn masonry_and_two_block_materials_agree_with_bloch_analysis() {
    let material = LayerMaterial::Elastic(elastic_layer(5e-3));
    let mut cell = build_square_blocks(material, MassDistribution::Box);
    cell.row_shift = 0.5;
    cell.blocks = [1, 2];
    cell.materials = vec![BLOCK; 2];
    let results = compare_waves(&cell, &build_solver_blocks(&cell), &wave_settings(0, 1));
    assert!(results.iter().filter(|own| !print_and_check_result(own)).count() == 0, "masonry");
    let soft = BlockMaterial { density: 2300.0, longitudinal_speed: 4000.0, shear_speed: 2500.0 };
    cell.row_shift = 0.0;
    cell.blocks = [2, 1];
    cell.materials = vec![BLOCK, soft];
    let results = compare_waves(&cell, &build_solver_blocks(&cell), &wave_settings(1, 1));
    assert!(
        results.iter().filter(|own| !print_and_check_result(own)).count() == 0,
        "two materials"
    );
}

/// Verifies that chains detect a factor 1 + 1e-9 in mass or compliance of one component, and waves in the plane a
/// factor of 1.05.
#[test]
fn wrong_factors_are_detected() {
    let cell =
        build_square_blocks(LayerMaterial::Elastic(elastic_layer(5e-3)), MassDistribution::Box);
    let change_mass = |mass: &mut LayerMass<f64>, _: &mut f64, factor: f64| mass.mass *= factor;
    let change_compliance =
        |_: &mut LayerMass<f64>, compliance: &mut f64, factor: f64| *compliance *= factor;
    #[allow(clippy::type_complexity, reason = "rows of a table")]
    let changes: [(fn(&mut LayerMass<f64>, &mut f64, f64), f64, BlockSettings); 3] = [
        (change_mass, 1.0 + 1e-9, wave_settings(1, 0)),
        (change_compliance, 1.0 + 1e-9, wave_settings(1, 0)),
        // Waves of the plane medium have tolerances of about a per cent; 5 % of the compliance of one component
        // change some frequencies by more, 5 % of the mass of thin layers do not.
        (change_compliance, 1.05, wave_settings(0, 3)),
    ];
    for component in 0..2 {
        for (change, factor, settings) in &changes {
            let mut solver = build_solver_blocks(&cell);
            for law in solver.laws.iter_mut().flatten() {
                let LayerLaw::Elastic(law) = law else { panic!("elastic layers") };
                let own = &mut law.components[component];
                change(&mut own.mass, &mut own.compliance, *factor);
            }
            let results = compare_waves(&cell, &solver, settings);
            let failed = results.iter().filter(|own| !print_and_check_result(own)).count();
            println!("component {component}, factor {factor}: {failed} of {}", results.len());
            assert!(failed > 0, "component {component}, factor {factor}");
        }
    }
}

#[test]
fn layers_without_linear_state_are_rejected() {
    let own = elastic_layer(1e-3);
    let weak = PlasticConstants { shear_strength: 0.0, friction: 0.5, hardening: 0.0 };
    let closed = PorousConstants { collapse_stiffness: 1.35e10, porosity: 0.0 };
    for (material, expected) in [
        (LayerMaterial::Cracked(own, Some(0.5)), "cracked"),
        (LayerMaterial::Plastic(own, weak), "without strength"),
        (LayerMaterial::Porous(own, closed, TangentialConstants::Elastic), "porosity 0"),
    ] {
        let cell = build_square_blocks(material, MassDistribution::Box);
        let solver = build_solver_blocks(&cell);
        let go_on = |_: usize, _: usize| ControlFlow::Continue(());
        let found = compare_blocks(&cell, &solver, &wave_settings(1, 1), &go_on);
        assert!(
            matches!(found, Err(AgreementError::NotLinear(reason)) if reason.contains(expected))
        );
    }
}

#[test]
fn progress_callback_counts_tasks_and_cancels() {
    let cell =
        build_square_blocks(LayerMaterial::Elastic(elastic_layer(1e-3)), MassDistribution::Box);
    let max_done = AtomicUsize::new(0);
    // Tasks for chains: 8, one for each of 2 branches of 2 polarisations along 2 axes. Tasks for waves in the plane: 1
    // predicts the modes, 6 measure 2 branches on 3 grids.
    let count = |done: usize, total: usize| {
        assert_eq!(total, 8 + 1 + 6);
        max_done.fetch_max(done, Ordering::Relaxed);
        ControlFlow::Continue(())
    };
    compare_blocks(&cell, &build_solver_blocks(&cell), &wave_settings(1, 1), &count)
        .expect("results");
    assert_eq!(max_done.into_inner(), 15);
    let cancel = |_: usize, _: usize| ControlFlow::Break(());
    let found = compare_blocks(&cell, &build_solver_blocks(&cell), &wave_settings(1, 1), &cancel);
    assert_eq!(found, Err(AgreementError::Cancelled));
}
