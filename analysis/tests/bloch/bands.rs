//! Bloch waves with decay rate and polarisation, joints from laws of layers, plane waves of the equivalent continuum.

use super::media::build_medium;
use models::interface::parameters::{LayerMaterial, MassDistribution, ViscousConstants};
use std::f64::consts::PI;
use wellposed_analysis::bloch::bands::{
    BandSolver, BlochWave, PathPoint, WavesAtWaveVector, follow_branches, sample_path,
};
use wellposed_analysis::bloch::cell::{BlockRow, Cell, CellBlock, CellModel, DegreeControl, Joint};
use wellposed_analysis::bloch::continuum::continuum_frequencies;

const DEGREE_CONTROL: DegreeControl =
    DegreeControl { tolerance: 1e-4, first_degree: 4, largest_degree: 6 };

/// Cell of one block whose joints have the given law.
fn build_cell(law: &LayerMaterial) -> Cell {
    let joint = Joint::from_law(law, MassDistribution::Box);
    let block = CellBlock {
        width: 0.05,
        material: build_medium(5e-3).block,
        right_joint: joint,
        top_joint: joint,
    };
    Cell::new(vec![BlockRow { height: 0.05, offset: 0.0, blocks: vec![block] }]).expect("valid")
}

/// Viscous layer with the instantaneous stiffness of the elastic one, delayed by the time `retardation_time`, s.
fn viscous_law(thickness: f64, retardation_time: f64) -> LayerMaterial {
    let elastic = build_medium(thickness).layer;
    let instantaneous = 1.0 / (elastic.density * elastic.shear_speed.powi(2));
    let delayed_compliance = 2.0 * instantaneous;
    let viscosity = retardation_time / delayed_compliance;
    LayerMaterial::Viscous(elastic, ViscousConstants { delayed_compliance, viscosity })
}

#[test]
fn solver_agrees_with_band_structure() {
    let own = build_medium(5e-3);
    let cell = build_cell(&LayerMaterial::Elastic(own.layer));
    assert_eq!(cell, Cell::from_medium(&own, false).expect("valid"));
    let path = cell.standard_path();
    let solver = BandSolver::new(&cell, &path, 5, &DEGREE_CONTROL).expect("solved");
    let structure = cell.band_structure(&path, 5, 3, &DEGREE_CONTROL).expect("solved");
    let (points, vertices) = sample_path(&path, 3).expect("a path");
    assert_eq!(solver.degree(), structure.degree);
    assert_eq!(solver.frequency_error, structure.frequency_error);
    assert_eq!(vertices.len(), structure.vertices.len());
    for (point, sample) in points.iter().zip(&structure.samples) {
        assert_eq!((point.distance, point.wave_vector), (sample.distance, sample.wave_vector));
        let found = solver.solve(point.wave_vector).expect("solved");
        assert!(found.is_stable());
        for (wave, frequency) in found.waves.iter().zip(&sample.frequencies) {
            // Near zero frequency ω² is rounding.
            assert!((wave.frequency - frequency).abs() <= 1e-6 * sample.frequencies[4]);
            assert_eq!(wave.decay_rate, 0.0);
        }
    }
}

/// Verifies that long waves along an axis and a diagonal are transverse and longitudinal, and that the third branch is
/// the rotation of blocks.
#[test]
fn long_waves_are_transverse_and_longitudinal() {
    let cell = build_cell(&LayerMaterial::Elastic(build_medium(5e-3).layer));
    let solver = BandSolver::new(&cell, &cell.standard_path(), 4, &DEGREE_CONTROL).expect("solved");
    for wave_vector in [[1.0, 0.0], [0.7, 0.7]] {
        let waves = solver.solve(wave_vector).expect("solved").waves;
        let shares: Vec<f64> =
            waves.iter().map(|wave| wave.longitudinal_share.expect("a share")).collect();
        println!("{wave_vector:?}: {shares:?}");
        assert!(shares[0] < 1e-3 && shares[1] > 0.999 && (shares[2] - 0.5).abs() < 0.01);
    }
    let at_rest = solver.solve([0.0; 2]).expect("solved").waves;
    assert!(at_rest.iter().all(|wave| wave.longitudinal_share.is_none()));
}

/// Verifies that all waves in viscous joints decay, and that they have the undamped frequencies of the relaxed
/// stiffness for fast relaxation and of the instantaneous stiffness for slow relaxation.
#[test]
fn viscous_joints_damp_waves() {
    let wave_vector = [0.4 / 0.05, 0.3 / 0.05];
    let frequencies = |cell: &Cell| {
        let modes = CellModel::new(cell, 4).modes(wave_vector, 3, false).expect("solved");
        modes.frequencies()
    };
    for (retardation_time, is_relaxed) in [(1e-7, true), (1.0, false)] {
        let cell = build_cell(&viscous_law(5e-3, retardation_time));
        assert!(cell.is_viscous());
        let limit = match is_relaxed {
            true => cell.map_joints(Joint::relaxed),
            false => cell.map_joints(Joint::instantaneous),
        };
        assert!(!limit.is_viscous());
        let solver =
            BandSolver::new(&cell, &cell.standard_path(), 3, &DEGREE_CONTROL).expect("solved");
        let found = solver.solve(wave_vector).expect("solved");
        assert!(found.is_stable(), "{} {}", found.max_growth_rate, found.growth_rounding);
        for (wave, expected) in found.waves.iter().zip(frequencies(&limit)) {
            let error = wave.frequency / expected - 1.0;
            println!("τ = {retardation_time} s: {wave:?}, {error:e}");
            // The degrees of both solvers differ.
            assert!(error.abs() < 2e-3 && wave.decay_rate > 0.0);
        }
    }
    let cell = build_cell(&viscous_law(5e-3, 2e-5));
    let solver = BandSolver::new(&cell, &cell.standard_path(), 4, &DEGREE_CONTROL).expect("solved");
    let at_rest = solver.solve([0.0; 2]).expect("solved");
    println!("{at_rest:?}");
    let frequencies: Vec<f64> = at_rest.waves.iter().map(|wave| wave.frequency).collect();
    assert!(at_rest.is_stable() && frequencies[..2] == [0.0; 2] && frequencies[2] > 1e4);
    let near: Vec<f64> =
        solver.solve([0.2, 0.0]).expect("solved").waves.iter().map(|wave| wave.frequency).collect();
    assert!((near[2] / frequencies[2] - 1.0).abs() < 1e-2, "{near:?} {frequencies:?}");
}

/// Verifies that two crossing branches with different damping, listed by frequency, are followed through the crossing.
#[test]
fn branches_are_followed_through_crossings() {
    let wave = |frequency: f64, decay_rate: f64| BlochWave {
        frequency,
        decay_rate,
        longitudinal_share: None,
    };
    let points: Vec<PathPoint> = (0..=20)
        .map(|i| PathPoint { distance: f64::from(i), wave_vector: [f64::from(i), 0.0] })
        .collect();
    let mut waves: Vec<WavesAtWaveVector> = points
        .iter()
        .map(|point| {
            let mut waves = vec![wave(2.0 + point.distance, 0.1), wave(12.3, 3.0)];
            waves.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
            WavesAtWaveVector {
                waves,
                min_squared_frequency: None,
                max_growth_rate: 0.0,
                growth_rounding: 0.0,
            }
        })
        .collect();
    follow_branches(&points, &[0.0, 20.0], &mut waves);
    assert!(waves.iter().all(|at| at.waves[0].decay_rate == 0.1 && at.waves[1].frequency == 12.3));
}

#[test]
fn continuum_waves_agree_with_homogenised_speeds() {
    let constants = build_medium(5e-3).homogenise().expect("valid");
    let at_rest = continuum_frequencies(&constants.solid, [0.0; 2]);
    assert_eq!(at_rest[..2], [0.0; 2]);
    assert!((at_rest[2] / constants.natural_frequency - 1.0).abs() < 1e-12);
    let f_star = constants.natural_frequency / (2.0 * PI);
    assert!((f_star / 12.65e3 - 1.0).abs() < 1e-3, "{f_star}");
    for normal in [[1.0, 0.0], [0.6, 0.8], [0.5f64.sqrt(), 0.5f64.sqrt()]] {
        let k = 0.02;
        let found = continuum_frequencies(&constants.solid, normal.map(|x| k * x));
        for (omega, speed) in found.iter().zip(constants.long_wave_speeds(normal)) {
            assert!((omega / k / speed - 1.0).abs() < 1e-5, "{omega} {speed}");
        }
    }
}

/// Writes the band structures of elastic and viscous joints to files for figures.
#[test]
#[ignore = "writes tables for drawings to the folder BANDS"]
fn write_band_structures() {
    let folder = std::env::var("BANDS").expect("a folder");
    let elastic = LayerMaterial::Elastic(build_medium(5e-3).layer);
    for (name, law) in [("elastic", elastic), ("viscous", viscous_law(5e-3, 2e-5))] {
        let cell = build_cell(&law);
        let path = cell.standard_path();
        let solver = BandSolver::new(&cell, &path, 8, &DEGREE_CONTROL).expect("solved");
        let constants = build_medium(5e-3).homogenise().expect("valid");
        let mut text = String::new();
        for point in sample_path(&path, 24).expect("a path").0 {
            let found = solver.solve(point.wave_vector).expect("solved");
            for (branch, wave) in found.waves.iter().enumerate() {
                text += &format!(
                    "wave,{branch},{},{},{},{}\n",
                    point.distance,
                    wave.frequency,
                    wave.decay_rate,
                    wave.longitudinal_share.unwrap_or(f64::NAN)
                );
            }
            let own = continuum_frequencies(&constants.solid, point.wave_vector);
            for (branch, frequency) in own.iter().enumerate() {
                text += &format!("continuum,{branch},{},{frequency},0,0\n", point.distance);
            }
        }
        if name == "elastic" {
            for gap in solver.model().total_gaps(8, 6).expect("solved") {
                text += &format!("gap,0,0,{},{},0\n", gap.lower.0, gap.upper.0);
            }
        }
        std::fs::write(format!("{folder}/{name}.csv"), text).expect("a file");
    }
}
