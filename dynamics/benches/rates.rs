//! Rate of the solvers, million cell-updates per second, and memory bandwidth measured at the same time.
//!
//! A cell-update advances one cell by half a time step, with one sweep along every axis; a step consists of two
//! cell-updates. `cargo bench -p wellposed-dynamics --bench rates -- [word…]` runs the rows whose names contain all
//! these words.

#[path = "../tests/solid/support/noise.rs"]
mod noise;

use models::granular_medium::{GranularMedium, GranularParameters};
use models::porous::{PoreContact, PorousMedium, PorousParameters};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use models::solid::waves::SolidField;
use models::yield_set::YieldSet;
use models::yield_set::parameters::Mises;
use std::time::Instant;
use wellposed_dynamics::SolverReal;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::contact_law::ContactLaw;
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::ledger::Energy;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::simd::InstructionSet;
use wellposed_dynamics::solid::metric::Metric;

/// Distribution of the media in the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
enum MediaDistribution {
    Elastic,
    /// All cells yield in all steps.
    Yielding,
    /// All cells have a yield set that no stress reaches.
    Strong,
    /// Twenty layers normal to the last axis, alternating between two media.
    Layers,
    /// Fifty circles or spheres of a second medium at random places.
    Inclusions,
    /// One of two media at random in each cell.
    EachCell,
    /// Elastic; the sweeps do not alternate, as in a polar block.
    TwoCyclic,
    /// Elastic polar block, the circle along the first axis.
    Polar,
    /// Porous medium in a polar block.
    PolarPorous,
    /// Granular medium with plastic particles.
    Granular,
    /// Porous medium with an elastic skeleton.
    Porous,
    /// Elastic; initial fields decay exponentially along the last axis down to subnormal values.
    Tails,
}

/// Shape of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// As many cells along each axis.
    Cube,
    /// All cells along one axis, one cell across, with periodic sides there.
    Line(usize),
    /// The same with free sides.
    Bar(usize),
}

#[derive(Clone, Copy, Debug)]
struct BenchmarkRow {
    dimensions: usize,
    theory: Theory,
    /// Number of cells along each axis that has more than one.
    cells_per_axis: usize,
    shape: Shape,
    media: MediaDistribution,
    is_single_precision: bool,
    threads: usize,
    is_reference: bool,
    instructions: InstructionSet,
}

impl BenchmarkRow {
    fn name(&self) -> String {
        let Self {
            dimensions,
            theory,
            cells_per_axis,
            shape,
            media,
            threads,
            is_reference,
            instructions,
            ..
        } = self;
        let bits = if self.is_single_precision { "f32" } else { "f64" };
        let plain = if *is_reference { " reference" } else { "" };
        let shape = match shape {
            Shape::Cube => String::new(),
            Shape::Line(axis) => format!(" along-x{}", axis + 1),
            Shape::Bar(axis) => format!(" bar-x{}", axis + 1),
        };
        let name =
            format!("{dimensions}D {theory:?} {cells_per_axis}{shape} {media:?} {bits} {threads}t");
        format!("{name} {instructions:?}{plain}").to_lowercase()
    }

    /// Returns the number of cells along each axis.
    fn cells<const D: usize>(&self) -> [usize; D] {
        std::array::from_fn(|axis| match self.shape {
            Shape::Line(long) | Shape::Bar(long) if axis != long => 1,
            _ => self.cells_per_axis,
        })
    }
}

fn build_medium(theory: Theory, dimensions: usize, factor: f64) -> Medium {
    let couple =
        (theory == Theory::Cosserat).then_some(CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 });
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let rotation = (theory != Theory::Classical).then_some(rotation);
    let solid = Isotropic::new(1.4 * factor, 0.9 * factor, 1.2, rotation).expect("sound moduli");
    Medium::new(solid, dimensions)
}

fn granular_medium(dimensions: usize) -> Medium {
    let parameters = GranularParameters {
        density: 1.2,
        bulk_modulus: 2.0,
        shear_modulus: 0.9,
        friction: 0.5,
        yield_stress: Some(0.1),
        intensity_coefficient: GranularParameters::DEFAULT_INTENSITY_COEFFICIENT,
    };
    let medium = GranularMedium::new(parameters).expect("sound constants");
    Medium::with_contact(ContactLaw::from(&medium), dimensions)
}

fn porous_medium(dimensions: usize) -> Medium {
    let parameters = PorousParameters {
        density: 1.2,
        bulk_modulus: 2.0,
        shear_modulus: 0.9,
        yield_stress: None,
        intensity_coefficient: PorousParameters::DEFAULT_INTENSITY_COEFFICIENT,
        contact_bulk_modulus: 1.0,
        porosity: 0.05,
        contact: PoreContact::Spherical,
    };
    let medium = PorousMedium::new(parameters).expect("sound constants");
    let law = ContactLaw::from_porous(&medium);
    Medium::with_contact(law, dimensions)
}

/// Returns a pseudo-random number in [0, 1).
fn unit_noise(index: usize) -> f64 {
    0.5 * noise::noise(index as u64) + 0.5
}

fn build_media_and_cells<const D: usize>(row: &BenchmarkRow) -> (Vec<Medium>, Vec<u16>) {
    let count = row.cells::<D>().iter().product();
    let medium = build_medium(row.theory, D, 1.0);
    let two_media = vec![medium.clone(), build_medium(row.theory, D, 0.6)];
    let yielding = |strength: f64| {
        vec![medium.clone().with_yield_set(YieldSet::from(Mises::new_von_mises(strength)))]
    };
    let single_medium = vec![0; count];
    let layer = row.cells_per_axis.pow(D as u32 - 1);
    match row.media {
        MediaDistribution::Elastic
        | MediaDistribution::Tails
        | MediaDistribution::TwoCyclic
        | MediaDistribution::Polar => (vec![medium], single_medium),
        MediaDistribution::Granular => (vec![granular_medium(D)], single_medium),
        MediaDistribution::Porous | MediaDistribution::PolarPorous => {
            (vec![porous_medium(D)], single_medium)
        }
        MediaDistribution::Yielding => (yielding(1e-3), single_medium),
        MediaDistribution::Strong => (yielding(1e3), single_medium),
        MediaDistribution::Layers => {
            let layer_medium = |cell: usize| (cell / layer * 20 / row.cells_per_axis % 2) as u16;
            (two_media, (0..count).map(layer_medium).collect())
        }
        MediaDistribution::Inclusions => {
            let mut cell_media = single_medium;
            let radius = 0.04 * row.cells_per_axis as f64;
            for inclusion in 0..50 {
                let middle: [f64; D] = std::array::from_fn(|axis| {
                    unit_noise(3 * inclusion + axis) * row.cells_per_axis as f64
                });
                for (cell, medium) in cell_media.iter_mut().enumerate() {
                    let mut rest = cell;
                    let square: f64 = middle
                        .iter()
                        .map(|middle| {
                            let index = (rest % row.cells_per_axis) as f64;
                            rest /= row.cells_per_axis;
                            (index - middle) * (index - middle)
                        })
                        .sum();
                    if square < radius * radius {
                        *medium = 1;
                    }
                }
            }
            (two_media, cell_media)
        }
        MediaDistribution::EachCell => {
            (two_media, (0..count).map(|i| u16::from(unit_noise(i) < 0.5)).collect())
        }
    }
}

/// Returns the CPU time of this process, s, where the operating system provides it.
fn process_cpu_time() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let mut fields = stat.rsplit(')').next()?.split_whitespace().skip(11);
    let ticks = |field: Option<&str>| field?.parse::<f64>().ok();
    Some((ticks(fields.next())? + ticks(fields.next())?) / 100.0)
}

/// Measured quantities of one row of the table.
struct Measurement {
    /// Median over all rounds, million cell-updates per second.
    rate: f64,
    /// Rate at the first decile of the round times, million cell-updates per second; of fewer than ten rounds, the
    /// fastest.
    first_decile_rate: f64,
    /// CPU time divided by wall time and by the number of threads; `None` where the CPU time is not available.
    cpu_share: Option<f64>,
    /// Time of one evaluation of the energy, relative to the time of one step.
    energy_cost: f64,
    /// Memory traffic per cell-update, bytes; `None` for the reference solver.
    bytes_per_update: Option<f64>,
    /// Size of all fields, bytes.
    field_bytes: usize,
}

/// Solver to be measured.
enum MeasuredSolver<T: SolverReal, const D: usize> {
    Fused(DecomposedDomain<T, D>),
    Reference(Box<Reference<T, D>>),
}

impl<T: SolverReal, const D: usize> MeasuredSolver<T, D> {
    fn new(problem: &Problem<D>, row: &BenchmarkRow) -> Self {
        if row.is_reference {
            return Self::Reference(Box::new(Reference::new(problem).expect("sound")));
        }
        let mut split =
            DecomposedDomain::with_first_axis(problem.first_axis(), problem, row.threads)
                .expect("sound");
        split.set_instructions(row.instructions);
        Self::Fused(split)
    }

    fn set_field(&mut self, field: SolidField, values: &[T]) {
        match self {
            Self::Fused(own) => own.set_field(field, values),
            Self::Reference(own) => own.set_field(field, values),
        }
    }

    fn advance(&mut self, steps: usize) {
        match self {
            Self::Fused(own) => own.advance(steps).expect("threads"),
            Self::Reference(own) => own.advance(steps),
        }
    }

    fn energy(&self) -> Energy {
        match self {
            Self::Fused(own) => own.energy(),
            Self::Reference(own) => own.energy(),
        }
    }
}

fn measure_row<T: SolverReal, const D: usize>(row: &BenchmarkRow) -> Measurement {
    let (media, cell_media) = build_media_and_cells::<D>(row);
    let count = cell_media.len();
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    // Slopes and splitting are the defaults of case files.
    let has_contacts = media.iter().any(|medium| medium.contact.is_some());
    let is_elastic = media.iter().all(|medium| medium.yield_set.is_none()) && !has_contacts;
    let slopes = if is_elastic { Slopes::FourthOrder } else { Slopes::Limited };
    let scheme = Scheme {
        splitting: match row.media {
            MediaDistribution::TwoCyclic | MediaDistribution::Polar => Splitting::TwoCyclic,
            _ if has_contacts => Splitting::TwoCyclic,
            _ => Splitting::Alternating,
        },
        ..Scheme::new(slopes, PlasticStep::ReturnMapping)
    };
    let boundaries = std::array::from_fn(|axis| match row.shape {
        Shape::Line(long) if axis != long => [Boundary::Periodic, Boundary::Periodic],
        _ => [Boundary::Free, Boundary::Free],
    });
    let grid = Grid { cells: row.cells(), spacing: [0.1; D] };
    let mut problem =
        Problem::new(grid, media, cell_media, boundaries, 0.9 * 2.0 * 0.1 / speed, scheme);
    if matches!(row.media, MediaDistribution::Polar | MediaDistribution::PolarPorous) {
        // Cells are squares at the inner radius.
        let angle = std::f64::consts::TAU / row.cells_per_axis as f64;
        problem.grid.spacing[0] = angle;
        problem.metric = Some(Metric::new_polar(0.1 / angle, row.cells_per_axis, [angle, 0.1]));
        problem.boundaries[0] = [Boundary::Periodic, Boundary::Periodic];
    }
    let mut solver = MeasuredSolver::new(&problem, row);
    let fields = problem.media[0].fields.clone();
    let layer = row.cells_per_axis.pow(D as u32 - 1);
    for (index, field) in fields.iter().enumerate() {
        let value = |i: usize| {
            let tail = (i / layer) as f64 / row.cells_per_axis as f64 - 0.1;
            let size = if row.media == MediaDistribution::Tails {
                (-2000.0 * tail.max(0.0)).exp()
            } else {
                1.0
            };
            T::from_f64(size * (unit_noise(i + 31 * index) - 0.5))
        };
        solver.set_field(*field, &(0..count).map(value).collect::<Vec<_>>());
    }
    solver.advance(2);
    // Rounds are short, so that some run without disturbance by other processes, yet long compared with starting the
    // threads, which every round does anew.
    let probe = Instant::now();
    solver.advance(2);
    let probe = probe.elapsed().as_secs_f64();
    let steps = 2 * ((0.05 / probe) as usize).max(1);
    let rounds = ((5.0 / probe) as usize / (steps / 2)).max(5);
    let start_times = (Instant::now(), process_cpu_time());
    let mut seconds: Vec<f64> = (0..rounds)
        .map(|_| {
            let start = Instant::now();
            solver.advance(steps);
            start.elapsed().as_secs_f64() / steps as f64
        })
        .collect();
    let wall = start_times.0.elapsed().as_secs_f64() * row.threads as f64;
    let share =
        start_times.1.zip(process_cpu_time()).map(|(before, after)| (after - before) / wall);
    seconds.sort_by(f64::total_cmp);
    let start = Instant::now();
    std::hint::black_box(solver.energy());
    let [first_decile_rate, middle] = [10, 2].map(|share| seconds[rounds / share]);
    let energies = start.elapsed().as_secs_f64() / middle;
    let fields = fields.len();
    let rate = |seconds: f64| 2.0 * count as f64 / seconds / 1e6;
    Measurement {
        rate: rate(middle),
        first_decile_rate: rate(first_decile_rate),
        cpu_share: share,
        energy_cost: energies,
        // Each pass of several steps reads and writes all fields once; a step consists of two cell-updates.
        bytes_per_update: match solver {
            MeasuredSolver::Fused(split) => {
                Some((fields * size_of::<T>()) as f64 / split.max_pass_steps() as f64)
            }
            MeasuredSolver::Reference(_) => None,
        },
        field_bytes: fields * size_of::<T>() * count,
    }
}

/// Measures the memory bandwidth of the triad a = b + 3c on arrays of `bytes` bytes in total, GB/s.
fn measure_triad(bytes: usize, threads: usize) -> f64 {
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

/// Returns all rows of the table, by number of dimensions and then by grid size.
fn benchmark_rows() -> Vec<BenchmarkRow> {
    let instructions = InstructionSet::widest();
    let (is_reference, is_single_precision, threads, media) =
        (false, false, 1, MediaDistribution::Elastic);
    let mut rows = Vec::new();
    let sizes = [(2, 500), (2, 1000), (2, 4000), (3, 64), (3, 150), (3, 158), (3, 256)];
    for (dimensions, cells_per_axis) in sizes {
        for theory in [Theory::Classical, Theory::Cosserat] {
            let row = BenchmarkRow {
                dimensions,
                theory,
                cells_per_axis,
                shape: Shape::Cube,
                media,
                is_single_precision,
                threads,
                is_reference,
                instructions,
            };
            // 158 cells and the ghosts of a row fill all SIMD lanes in single and in double precision.
            if cells_per_axis == 158 {
                rows.extend(
                    [false, true]
                        .map(|is_single_precision| BenchmarkRow { is_single_precision, ..row }),
                );
                continue;
            }
            let is_middle = [1000, 150].contains(&cells_per_axis);
            if cells_per_axis == 500 || cells_per_axis == 64 {
                rows.push(BenchmarkRow { is_reference: true, ..row });
            }
            if is_middle {
                let sets = InstructionSet::available_sets().filter(|set| *set != instructions);
                rows.extend(sets.map(|instructions| BenchmarkRow { instructions, ..row }));
            }
            for threads in [1, 2] {
                rows.push(BenchmarkRow { threads, ..row });
                if cells_per_axis == 500 || cells_per_axis == 64 {
                    continue;
                }
                rows.push(BenchmarkRow { threads, is_single_precision: true, ..row });
                rows.push(BenchmarkRow { threads, media: MediaDistribution::Strong, ..row });
                rows.push(BenchmarkRow { threads, media: MediaDistribution::Yielding, ..row });
                if theory == Theory::Classical && cells_per_axis != 256 {
                    let others = [MediaDistribution::Granular, MediaDistribution::Porous];
                    rows.extend(others.map(|media| BenchmarkRow { threads, media, ..row }));
                }
                if theory == Theory::Classical && dimensions == 2 {
                    let others = [
                        MediaDistribution::TwoCyclic,
                        MediaDistribution::Polar,
                        MediaDistribution::PolarPorous,
                    ];
                    rows.extend(others.map(|media| BenchmarkRow { threads, media, ..row }));
                }
                if cells_per_axis != 256 {
                    rows.push(BenchmarkRow { threads, media: MediaDistribution::EachCell, ..row });
                }
                if is_middle && threads == 1 {
                    let others = [MediaDistribution::Layers, MediaDistribution::Inclusions];
                    rows.extend(others.map(|media| BenchmarkRow { media, ..row }));
                    rows.push(BenchmarkRow {
                        is_single_precision: true,
                        media: MediaDistribution::Tails,
                        ..row
                    });
                }
            }
        }
    }
    for (dimensions, theory) in
        [2, 3].into_iter().flat_map(|own| [(own, Theory::Classical), (own, Theory::Cosserat)])
    {
        for axis in 0..dimensions {
            for shape in [Shape::Line(axis), Shape::Bar(axis)] {
                rows.extend([1, 2].map(|threads| BenchmarkRow {
                    dimensions,
                    theory,
                    cells_per_axis: 1_000_000,
                    shape,
                    media,
                    is_single_precision,
                    threads,
                    is_reference,
                    instructions,
                }));
            }
        }
    }
    rows
}

/// Measures the speed-up of pure register arithmetic from one to two threads: the upper bound of scaling on this
/// machine.
fn measure_arithmetic_scaling() -> f64 {
    let work = || {
        let mut values: [f64; 16] = std::array::from_fn(|i| 1.0 + i as f64);
        for _ in 0..20_000_000 {
            for value in &mut values {
                *value = *value * 0.999_999 + 1e-6;
            }
        }
        std::hint::black_box(values);
    };
    let seconds = |threads: usize| {
        let clock = Instant::now();
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(work);
            }
        });
        clock.elapsed().as_secs_f64()
    };
    let mut ratios: Vec<f64> = (0..5).map(|_| 2.0 * seconds(1) / seconds(2)).collect();
    ratios.sort_by(f64::total_cmp);
    ratios[2]
}

fn main() {
    println!("arithmetic alone: two threads {:.2} times one\n", measure_arithmetic_scaling());
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    println!(
        "| row | Mcu/s | fastest tenth | B per update | GB/s | triad GB/s | energies / step | |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for row in benchmark_rows() {
        let name = row.name();
        if !words.iter().all(|word| name.split(' ').any(|own| own == word)) {
            continue;
        }
        let mut best: Option<(Measurement, f64)> = None;
        for _ in 0..3 {
            let found = match (row.dimensions, row.is_single_precision) {
                (2, false) => measure_row::<f64, 2>(&row),
                (2, true) => measure_row::<f32, 2>(&row),
                (_, false) => measure_row::<f64, 3>(&row),
                (_, true) => measure_row::<f32, 3>(&row),
            };
            let triad = measure_triad(found.field_bytes.clamp(1 << 20, 1 << 30), row.threads);
            let is_undisturbed = found.cpu_share.is_none_or(|share| share > 0.95);
            if best.as_ref().is_none_or(|best| found.rate > best.0.rate) {
                best = Some((found, triad));
            }
            if is_undisturbed {
                break;
            }
        }
        let Some((found, triad)) = best else { continue };
        let note = match found.cpu_share {
            Some(share) if share <= 0.95 => format!("disturbed, {:.0} %", 100.0 * share),
            _ => String::new(),
        };
        println!(
            "| {name} | {:.1} | {:.1} | {} | {} | {triad:.1} | {:.2} | {note} |",
            found.rate,
            found.first_decile_rate,
            found.bytes_per_update.map_or(String::new(), |bytes| format!("{bytes:.0}")),
            found
                .bytes_per_update
                .map_or(String::new(), |bytes| format!("{:.1}", found.rate * bytes / 1e3)),
            found.energy_cost
        );
    }
}
