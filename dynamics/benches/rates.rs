//! Million cell-updates per second of the sweeps, beside the bandwidth of the memory in the same minutes.
//!
//! A cell-update is one cell advanced by one Courant unit in every direction; a step is two of them.
//! `cargo bench -p wellposed-dynamics --bench rates -- [quick]`

use models::cosserat::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use models::plasticity::parameters::{Mises, YieldSet};
use std::time::Instant;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::kernel::Instructions;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Detail, Grid, Placement, Problem, Scheme};
use wellposed_dynamics::real::Real;
use wellposed_dynamics::split::Split;

fn medium(theory: Theory, dimensions: usize) -> Medium {
    let couple =
        (theory == Theory::Cosserat).then_some(CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 });
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let rotation = (theory != Theory::Classical).then_some(rotation);
    let solid = Isotropic::new(1.4, 0.9, 1.2, rotation).expect("sound moduli");
    Medium::isotropic(&solid, dimensions)
}

/// A row of the table.
struct Row {
    name: &'static str,
    theory: Theory,
    /// Cells along each axis.
    count: usize,
    threads: usize,
    detail: Detail,
    yields: bool,
    instructions: Instructions,
}

fn rate<T: Real, const D: usize>(row: &Row) -> f64 {
    let mut medium = medium(row.theory, D);
    if row.yields {
        medium = medium.yielding(YieldSet::Mises(Mises::von_mises(0.5)));
    }
    let count = row.count.pow(D as u32);
    let step = 2.0 * 0.1 / medium.greatest_speed();
    let scheme = Scheme { detail: row.detail, ..Scheme::new(Slopes::Limited, Placement::Last) };
    let sides = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let grid = Grid { cells: [row.count; D], spacing: [0.1; D] };
    let problem = Problem::new(grid, vec![medium], vec![0; count], sides, step, scheme);
    let mut split: Split<T, D> = Split::new(&problem, row.threads).expect("sound");
    split.set_instructions(row.instructions);
    for (index, field) in split.fields().to_vec().into_iter().enumerate() {
        let value = |i: usize| T::of(((i * 7919 + 31 * index) % 1000) as f64 / 1000.0 - 0.5);
        split.set(field, &(0..count).map(value).collect::<Vec<_>>());
    }
    split.advance(2);
    // Medians of several rounds of about half a second.
    let probe = Instant::now();
    split.advance(2);
    let steps = ((0.5 * 2.0 / probe.elapsed().as_secs_f64()) as usize).clamp(2, 1000);
    let mut rates: Vec<f64> = (0..3)
        .map(|_| {
            let start = Instant::now();
            split.advance(steps);
            2.0 * (steps * count) as f64 / start.elapsed().as_secs_f64() / 1e6
        })
        .collect();
    rates.sort_by(f64::total_cmp);
    rates[1]
}

/// Bandwidth of a = b + 3c on arrays of that many bytes in all, GB/s.
fn triad(bytes: usize, threads: usize) -> f64 {
    let length = bytes / 24 / threads;
    let mut arrays: Vec<[Vec<f64>; 3]> =
        (0..threads).map(|_| [vec![0.0; length], vec![1.0; length], vec![2.0; length]]).collect();
    let rounds = (2_000_000_000 / bytes).max(3);
    let mut best = 0.0f64;
    for _ in 0..3 {
        let start = Instant::now();
        std::thread::scope(|scope| {
            for [a, b, c] in &mut arrays {
                scope.spawn(move || {
                    for _ in 0..rounds {
                        for ((a, b), c) in a.iter_mut().zip(b.iter()).zip(c.iter()) {
                            *a = b + 3.0 * c;
                        }
                        std::hint::black_box(&mut *a);
                    }
                });
            }
        });
        best = best.max((rounds * bytes) as f64 / start.elapsed().as_secs_f64() / 1e9);
    }
    best
}

fn main() {
    let is_quick = std::env::args().any(|argument| argument == "quick");
    let [plane, space] = if is_quick { [1000, 100] } else { [4000, 150] };
    for threads in [1, 2] {
        println!("triad {threads} threads: {:.1} GB/s from memory", triad(1 << 30, threads));
    }
    let best = Instructions::best();
    let row = |name, theory, count, threads| Row {
        name,
        theory,
        count,
        threads,
        detail: Detail::Light,
        yields: false,
        instructions: best,
    };
    println!("plain reference, with the full ledger:");
    let plain = Row { detail: Detail::Full, ..row("2D f64", Theory::Cosserat, 500, 1) };
    println!("  2D Cosserat f64 500², 1 thread: {:.1}", rate::<f64, 2>(&plain));
    for instructions in Instructions::available() {
        let row = Row { instructions, ..row("2D f64", Theory::Cosserat, 1000, 1) };
        println!(
            "  2D Cosserat f64 1000², 1 thread, {instructions:?}: {:.1}",
            rate::<f64, 2>(&row)
        );
    }
    for threads in [1, 2] {
        for theory in [Theory::Cosserat, Theory::Classical] {
            let row = row("2D f64", theory, plane, threads);
            let yielding = Row { name: "2D f64 yielding", yields: true, ..row };
            let rates = [rate::<f64, 2>(&row), rate::<f32, 2>(&row), rate::<f64, 2>(&yielding)];
            println!(
                "  {theory:?} {plane}², {threads} threads: f64 {:.1}, f32 {:.1}, yielding {:.1} ({})",
                rates[0], rates[1], rates[2], yielding.name
            );
        }
        for theory in [Theory::Classical, Theory::Cosserat] {
            let row = row("3D f64", theory, space, threads);
            let rates = [rate::<f64, 3>(&row), rate::<f32, 3>(&row)];
            println!(
                "  {theory:?} {space}³, {threads} threads: f64 {:.1}, f32 {:.1} ({})",
                rates[0], rates[1], row.name
            );
        }
    }
}
