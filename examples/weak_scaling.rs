//! Draws `gallery/weak-scaling.png`: a model of the efficiency with which runs of Cosserat solids use 1 to 10⁵ cores of a
//! cluster, for a constant number of cells per core, on three interconnects.
//!
//! `cargo run --release --example weak_scaling -- gallery/weak-scaling.png`
//!
//! Numbers and sizes of messages are those of the decomposition that runs use. The time of a step of the rank with the
//! longest is
//!
//!     T = cells·t_cell + 2·values·t_copy + messages·t_latency + bytes/bandwidth
//!
//! with the cells of its part and of its halos, the values that it copies into messages and from them cell by cell (those
//! along all axes but the last one), and the messages that it sends. No transfer is assumed to overlap with computation,
//! and none to meet others in the network. Constants of the computation are measured ones; latencies and bandwidths are
//! published measurements between two machines, of which one core each uses the network. Only the points are measurements
//! of runs, with two threads of one machine.

use std::error::Error;
use wellposed::dynamics::boundary::Boundary;
use wellposed::dynamics::decomposition::communicator::SingleProcess;
use wellposed::dynamics::decomposition::{RankCounts, RankPart, RankPlan};
use wellposed::dynamics::line::Slopes;
use wellposed::dynamics::medium::Medium;
use wellposed::dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed::figures::{CurvePanel, FigureFormat, LabelledCurve, PanelsFigure};
use wellposed::models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};

/// Interconnect with a published latency, s, and bandwidth, bytes/s, of MPI or TCP messages between two machines.
struct Interconnect {
    name: &'static str,
    latency: f64,
    bandwidth: f64,
}

/// Sources:
/// - InfiniBand: OSU benchmarks, MPICH with UCX: latency of empty messages, bandwidth with 32 KiB
///   (<https://gist.github.com/jfgrimm/3af692a5475bdd4ed836b5a18197a209>, 2021);
/// - Cray Aries: reference values of the OSU benchmarks on Piz Daint, multicore partition
///   (<https://github.com/reframe-hpc/reframe/pull/1232>, 2020);
/// - 10 Gb Ethernet: cloud machines, half of the round trip of 92 to 100 μs, and 95 % of 10 Gb/s
///   (<http://blogs.scalablelogic.com/2014/01/enhanced-networking-in-aws-cloud-part-2.html>, 2014).
const INTERCONNECTS: [Interconnect; 3] = [
    Interconnect { name: "InfiniBand: 0.95 μs, 10.3 GB/s", latency: 0.95e-6, bandwidth: 10.3e9 },
    Interconnect { name: "Cray Aries: 1.61 μs, 9.65 GB/s", latency: 1.61e-6, bandwidth: 9.65e9 },
    Interconnect { name: "10 Gb Ethernet: 48 μs, 1.19 GB/s", latency: 48e-6, bandwidth: 1.19e9 },
];

/// Greatest number of ranks, as power of two: 131 072.
const LARGEST_POWER: u32 = 17;

/// Times to copy a value of a halo into a message or from it, s, along the first axis and along the second of three: from
/// the rates with one cut of 100³ cells in BENCHMARKS.md ("Decomposition along other axes"), 44.8 and 61.4 against 67.2
/// million cell-updates/s.
const COPY_TIMES: [f64; 2] = [9.4e-9, 1.5e-9];

/// Runs whose efficiency is drawn.
struct Scenario {
    title: &'static str,
    /// Number of cells per rank along each axis.
    cells: usize,
    /// Rate of one thread in BENCHMARKS.md, cell-updates/s, of which a step has two per cell.
    rate: f64,
    /// Measured rate of two threads by that of two single ones.
    measured_efficiency: f64,
}

const PLANE: Scenario = Scenario {
    title: "plane, 1000² cells per rank",
    cells: 1000,
    rate: 163e6,
    measured_efficiency: 303.2 / (2.0 * 159.3),
};

const SPACE: Scenario = Scenario {
    title: "space, 100³ cells per rank",
    cells: 100,
    rate: 38.9e6,
    measured_efficiency: 67.8 / (2.0 * 38.9),
};

/// Plans the parts of `ranks` ranks with a constant number of cells each.
fn plan_parts<const D: usize>(
    cells: usize,
    ranks: usize,
) -> Result<Vec<RankPart<D>>, Box<dyn Error>> {
    let couple = CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 };
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple: Some(couple) };
    let medium = Medium::new(Isotropic::new(1.4, 0.9, 1.2, Some(rotation))?, D);
    // A cube of ranks as far as powers of two allow.
    let mut parts = [1; D];
    let mut rest = ranks;
    for axis in (0..D).rev().cycle() {
        if rest == 1 {
            break;
        }
        parts[axis] *= 2;
        rest /= 2;
    }
    let grid = Grid { cells: parts.map(|count| count * cells), spacing: [0.1; D] };
    let step = 0.18 / medium.max_speed();
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let problem = Problem {
        medium_function: Some(std::sync::Arc::new(|_| 0)),
        ..Problem::new(grid, vec![medium], Vec::new(), boundaries, step, scheme)
    };
    let counts = RankCounts { ranks, threads: 1, parts: None };
    let plan = RankPlan::new(problem.first_axis(), &problem, &counts, &SingleProcess)?;
    Ok(plan.parts::<f64>(&problem)?)
}

/// Returns the time of a step of the rank with the longest, s.
fn step_time<const D: usize>(parts: &[RankPart<D>], rate: f64, network: &Interconnect) -> f64 {
    let time = |part: &RankPart<D>| {
        let copied = part.copied_bytes_per_step.iter().zip(COPY_TIMES);
        let copied = copied.map(|(bytes, time)| bytes / size_of::<f64>() as f64 * time);
        2.0 * part.stored_cells as f64 / rate
            + 2.0 * copied.sum::<f64>()
            + part.messages_per_step * network.latency
            + part.bytes_per_step / network.bandwidth
    };
    parts.iter().map(time).fold(0.0, f64::max)
}

fn draw_panel<const D: usize>(scenario: &Scenario) -> Result<CurvePanel, Box<dyn Error>> {
    let mut curves: Vec<LabelledCurve> = INTERCONNECTS
        .iter()
        .map(|own| LabelledCurve { label: own.name.to_owned(), points: Vec::new() })
        .collect();
    for power in 0..=LARGEST_POWER {
        let parts = plan_parts::<D>(scenario.cells, 1 << power)?;
        for (curve, network) in curves.iter_mut().zip(&INTERCONNECTS) {
            let single = 2.0 * (scenario.cells as f64).powi(D as i32) / scenario.rate;
            let efficiency = 100.0 * single / step_time(&parts, scenario.rate, network);
            curve.points.push([f64::from(power) * 2f64.log10(), efficiency]);
        }
        if [0, 3, 10, LARGEST_POWER].contains(&power) {
            let greatest =
                |value: fn(&RankPart<D>) -> f64| parts.iter().map(value).fold(0.0, f64::max);
            println!(
                "{}, {} ranks: at most {} messages and {:.3e} bytes per step, efficiencies {:.1?} %",
                scenario.title,
                1 << power,
                greatest(|own| own.messages_per_step),
                greatest(|own| own.bytes_per_step),
                curves.iter().map(|own| own.points[power as usize][1]).collect::<Vec<_>>(),
            );
        }
    }
    Ok(CurvePanel {
        x_label: format!("{}: number of ranks", scenario.title),
        y_label: "efficiency T(1)/T(P) (%)".to_owned(),
        curves,
        points: vec![[2f64.log10(), 100.0 * scenario.measured_efficiency]],
        point_label: "measured: two threads of one machine".to_owned(),
        is_x_log: true,
        y_values: Some([0.0, 100.0]),
        ..CurvePanel::default()
    })
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("the path of the picture is missing")?;
    let figure = PanelsFigure {
        title: "Weak scaling of Cosserat solids: a model, not measured on clusters".to_owned(),
        subtitle: "curves: model with the messages of the program; points: measured, two threads"
            .to_owned(),
        panels: vec![draw_panel::<2>(&PLANE)?, draw_panel::<3>(&SPACE)?],
    };
    std::fs::write(path, figure.draw(FigureFormat::Png)?)?;
    Ok(())
}
