//! Blocky media: rates for each kind of joint against the undivided solid, and time per block and step T(N) against the
//! number of blocks N.
//!
//! `cargo bench -p wellposed-dynamics --bench blocks -- kinds` and `… -- count [PICTURE.png]`; blocks have 10 × 10 cells.
//! Rounds of all rows of a table are interleaved, and the fastest of each counts.

use figures::{FigureFormat, GrowthFigure, GrowthPanel, LabelledCurve};
use models::interface::elastic::ElasticMaterial;
use models::interface::layer::LayerLaw;
use models::interface::parameters::{
    LayerMaterial, MassDistribution, PlasticConstants, PorousConstants, SaturatedMaterial,
    TangentialConstants, ViscousConstants,
};
use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use std::time::Instant;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::solid::interlayers::{InterlayerLaw, Interlayers};

/// Number of cells of a block along each axis.
const BLOCK_CELLS: usize = 10;

/// Edge length of a block, m.
const BLOCK_LENGTH: f64 = 0.05;

/// Elastic material of the joints: thickness 1 mm, density 1500 kg/m³, P and S wave speeds 1000 and 500 m/s.
const LAYER_MATERIAL: ElasticMaterial = ElasticMaterial {
    thickness: 1e-3,
    density: 1500.0,
    longitudinal_speed: 1000.0,
    shear_speed: 500.0,
};

/// Constants of plastic joints: the shear strength, Pa, is below the stresses of the random initial state.
const JOINT_CONSTANTS: PlasticConstants =
    PlasticConstants { shear_strength: 1e4, friction: 0.5, hardening: 0.0 };

/// Builds the law of each kind of joint, with the name of the kind; `None` stands for the undivided solid.
fn build_joint_laws() -> Vec<(&'static str, Option<LayerLaw<f64>>)> {
    let law = |material: LayerMaterial| Some(material.to_law(MassDistribution::Box));
    let compliance = 1.0 / (1500.0 * 500.0 * 500.0);
    let viscous =
        ViscousConstants { delayed_compliance: 2.0 * compliance, viscosity: 2e-5 / compliance };
    let pores = PorousConstants { collapse_stiffness: 9.0 * 1.5e9, porosity: 1e-5 };
    let saturated = SaturatedMaterial {
        thickness: 1e-3,
        skeleton_density: 1300.0,
        fluid_density: 250.0,
        added_density: 100.0,
        undrained_stiffness: 1.5e9,
        pores: PorousConstants { collapse_stiffness: 6e9, porosity: 1e-3 },
        coupling_stiffness: 0.45e9,
        fluid_stiffness: 0.7e9,
        instantaneous_compliance: compliance,
        viscous,
    };
    vec![
        ("none", None),
        ("elastic", law(LayerMaterial::Elastic(LAYER_MATERIAL))),
        ("elastic-plastic", law(LayerMaterial::Plastic(LAYER_MATERIAL, JOINT_CONSTANTS))),
        ("viscous", law(LayerMaterial::Viscous(LAYER_MATERIAL, viscous))),
        ("porous", law(LayerMaterial::Porous(LAYER_MATERIAL, pores, TangentialConstants::Elastic))),
        ("saturated", law(LayerMaterial::Saturated(saturated))),
        ("cracked", law(LayerMaterial::Cracked(LAYER_MATERIAL, Some(0.5)))),
        ("breaking", law(LayerMaterial::Breaking(LAYER_MATERIAL, JOINT_CONSTANTS, 1e4))),
    ]
}

/// Builds a domain of `blocks` × `blocks` blocks with random initial velocities; `law` is that of all joints.
fn build_domain(
    blocks: usize,
    law: Option<LayerLaw<f64>>,
    threads: usize,
) -> DecomposedDomain<f64, 2> {
    let medium = Medium::new(Isotropic::new(1.89e10, 2.43e10, 2700.0, None).expect("sound"), 2);
    let count = blocks * BLOCK_CELLS;
    let spacing = BLOCK_LENGTH / BLOCK_CELLS as f64;
    let step = 2.0 * 0.95 * spacing / medium.max_speed();
    let interlayers = law.map_or(Vec::new(), |law| {
        let across = |axis| {
            let law = InterlayerLaw::Plane(law, axis);
            Interlayers::new_regular(axis, count, [BLOCK_CELLS, BLOCK_CELLS], law)
        };
        vec![across(0), across(1)]
    });
    let problem = Problem {
        interlayers,
        ..Problem::new(
            Grid { cells: [count; 2], spacing: [spacing; 2] },
            vec![medium],
            vec![0; count * count],
            [0, 1].map(|_| [Boundary::Free, Boundary::Free]),
            step,
            Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping),
        )
    };
    let mut domain = DecomposedDomain::new(&problem, threads).expect("sound");
    for axis in 0..2 {
        let mut state = 1_u64 + axis as u64;
        let values: Vec<f64> = (0..count * count)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
            })
            .collect();
        domain.set_field(SolidField::Velocity(axis), &values);
    }
    domain.initialise_interlayers();
    domain
}

/// Measures the time of one step, s, as mean over `steps` steps.
fn time_steps(domain: &mut DecomposedDomain<f64, 2>, steps: usize) -> f64 {
    let start = Instant::now();
    domain.advance(steps).expect("threads");
    start.elapsed().as_secs_f64() / steps as f64
}

/// Measures the rate of the solver for each kind of joint in 100 × 100 blocks, on one thread.
fn compare_joint_kinds() {
    let blocks = 100;
    let cells = (blocks * BLOCK_CELLS).pow(2) as f64;
    let mut rows: Vec<_> = build_joint_laws()
        .into_iter()
        .map(|(name, law)| (name, build_domain(blocks, law, 1), f64::INFINITY))
        .collect();
    for _ in 0..9 {
        for (_, domain, fastest) in &mut rows {
            *fastest = fastest.min(time_steps(domain, 6));
        }
    }
    let plain = rows[0].2;
    println!("| joints | ms per step | million cell-updates/s | ratio to undivided |");
    println!("|---|---|---|---|");
    for (name, _, time) in &rows {
        let rate = 2.0 * cells / time * 1e-6;
        println!("| {name} | {:.2} | {rate:.1} | {:.2} |", 1e3 * time, plain / time);
    }
}

/// Measures the time per block and step against the number of blocks, and draws it into a file if there is a `picture`.
fn compare_block_counts(picture: Option<&str>) {
    let mut curves = [Vec::new(), Vec::new()];
    println!("| joints | threads | blocks N | ns per block and step |");
    println!("|---|---|---|---|");
    for (name, law) in
        build_joint_laws().into_iter().filter(|own| ["elastic", "saturated"].contains(&own.0))
    {
        for threads in [1, 2] {
            let mut points = [Vec::new(), Vec::new()];
            for blocks_per_side in [10, 18, 32, 56, 100, 178, 316] {
                let mut domain = build_domain(blocks_per_side, law, threads);
                let count = (blocks_per_side * blocks_per_side) as f64;
                let steps = (40_000.0 / count).ceil().max(2.0) as usize;
                let times = (0..5).map(|_| time_steps(&mut domain, steps));
                let fastest = times.fold(f64::INFINITY, f64::min);
                points[0].push([count, 1e3 * fastest]);
                points[1].push([count, 1e9 * fastest / count]);
                println!(
                    "| {name} | {threads} | {} | {:.0} |",
                    blocks_per_side * blocks_per_side,
                    1e9 * fastest / count
                );
            }
            let label = format!("{name}, {threads} thread{}", if threads == 1 { "" } else { "s" });
            for (curves, points) in curves.iter_mut().zip(points) {
                curves.push(LabelledCurve { label: label.clone(), points });
            }
        }
    }
    let Some(path) = picture else { return };
    let panel = |y_label: &str, curves| GrowthPanel {
        x_label: "number of blocks N".to_owned(),
        y_label: y_label.to_owned(),
        is_x_log: true,
        curves,
        reference_lines: Vec::new(),
        marks: Vec::new(),
        is_measured: true,
    };
    let [steps, blocks] = curves;
    let figure = GrowthFigure {
        title: "Time of a step against the number of blocks".to_owned(),
        subtitle: "blocks of 10 × 10 cells, double precision".to_owned(),
        by_direction: panel("time per step T (ms)", steps),
        by_wave_number: panel("time per block and step (ns)", blocks),
    };
    std::fs::write(path, figure.draw(FigureFormat::Png).expect("fonts")).expect("writable path");
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |table: &str| {
        let is_table = |word: &&String| !word.starts_with("--") && !word.ends_with(".png");
        let mut tables = arguments.iter().filter(is_table).peekable();
        tables.peek().is_none() || tables.any(|word| word == table)
    };
    if is_wanted("kinds") {
        compare_joint_kinds();
    }
    if is_wanted("count") {
        let picture = arguments.iter().find(|word| word.ends_with(".png"));
        compare_block_counts(picture.map(String::as_str));
    }
}
