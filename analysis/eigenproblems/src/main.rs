//! Complex generalised eigenproblems per second on one core: the pencils of all models at random
//! states, and larger random ones. `eigenproblems.py` in this package hands the same matrices to
//! SciPy and LAPACK in the same run and describes the command line.
//!
//! `eigenproblems FILE`: writes the matrices to FILE, then, for each line on standard input with the index of a set
//! (from 0), prints the problems per second of this crate (equilibration included) and of faer (equilibrated matrices,
//! reused buffers) for that set.
//!
//! FILE: 64-bit little-endian words. Number of sets; for each, the size n and the number of problems as integers, then
//! for each problem the equilibrated matrices L and R of L x = λ R x, by columns, as (re, im) doubles.

#[path = "../../tests/support/mod.rs"]
mod support;

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::ComputeEigenvectors::No;
use faer::linalg::gevd::{gevd_cplx, gevd_scratch};
use faer::{Mat, Par};
use num_complex::Complex64;
use std::hint::black_box;
use std::io::{BufRead, Write};
use std::time::Instant;
use support::states::{sample_wide_range, seeded_generator};
use testkit::flows::SQUARE_MODEL_CASES;
use wellposed_analysis::pencil::Pencil;
use wellposed_analysis::qz::Qz;

/// Number of problems of one size.
const PROBLEMS_PER_SET: usize = 256;
/// Minimum duration of a measurement, s.
const MIN_MEASURED_SECONDS: f64 = 0.5;

/// Eigenproblem in the form in which this crate receives it.
enum Eigenproblem {
    ModelPencil { pencil: Box<Pencil>, k: f64, direction: f64 },
    DenseMatrices { size: usize, left: Vec<Complex64>, right: Vec<Complex64> },
}

impl Eigenproblem {
    fn equilibrate(&self, qz: &mut Qz) {
        match self {
            Self::ModelPencil { pencil, k, direction } => pencil.equilibrate(qz, *k, *direction),
            Self::DenseMatrices { size, left, right } => {
                qz.equilibrate(*size, |i, j| left[i + size * j], |i, j| right[i + size * j]);
            }
        }
    }

    fn solve(&self, qz: &mut Qz) -> usize {
        match self {
            Self::ModelPencil { pencil, k, direction } => {
                pencil.compute_generalised_eigenvalues(qz, *k, *direction).len()
            }
            Self::DenseMatrices { .. } => {
                self.equilibrate(qz);
                qz.solve().map_or(0, |values| values.len())
            }
        }
    }

    fn size(&self) -> usize {
        match self {
            Self::ModelPencil { pencil, .. } => pencil.scaled.system.equations.len(),
            Self::DenseMatrices { size, .. } => *size,
        }
    }
}

/// Pencils of the models with `size` equations at random states, wave numbers and directions.
fn model_pencils(size: usize) -> Vec<Eigenproblem> {
    let mut problems = Vec::new();
    let random = &mut seeded_generator(size as u64);
    while problems.len() < PROBLEMS_PER_SET {
        let (kind, dilatancy) =
            SQUARE_MODEL_CASES[(random.unit_interval() * SQUARE_MODEL_CASES.len() as f64) as usize];
        let sample = sample_wide_range(random, kind, dilatancy);
        if sample.system.equations.len() == size {
            let mut pencil = Box::<Pencil>::default();
            pencil.update(&sample.system).expect("finite coefficients");
            let (k, direction) =
                (random.log_uniform(1e-2, 1e8), random.uniform(0.0, std::f64::consts::TAU));
            problems.push(Eigenproblem::ModelPencil { pencil, k, direction });
        }
    }
    problems
}

/// Dense pencils L − λR of random entries, complex in L and real in R; `rank` rows of R are not zero.
fn dense_pencils(size: usize, rank: usize) -> Vec<Eigenproblem> {
    let random = &mut seeded_generator((100 * size + rank) as u64);
    let problem = |_| {
        let mut part = || random.uniform(-1.0, 1.0);
        let left = (0..size * size).map(|_| Complex64::new(part(), part())).collect();
        let right = (0..size * size)
            .map(|at| if at % size < rank { part().into() } else { Complex64::ZERO })
            .collect();
        Eigenproblem::DenseMatrices { size, left, right }
    };
    (0..PROBLEMS_PER_SET).map(problem).collect()
}

/// Workspace of faer with reused buffers.
struct FaerWorkspace {
    left: Mat<Complex64>,
    right: Mat<Complex64>,
    alpha: Diag<Complex64>,
    beta: Diag<Complex64>,
    buffer: MemBuffer,
}

impl FaerWorkspace {
    fn new(n: usize) -> Self {
        let scratch = gevd_scratch::<Complex64>(n, No, No, Par::Seq, Default::default());
        Self {
            left: Mat::zeros(n, n),
            right: Mat::zeros(n, n),
            alpha: Diag::zeros(n),
            beta: Diag::zeros(n),
            buffer: MemBuffer::new(scratch),
        }
    }

    fn solve(&mut self, matrices: &[Mat<Complex64>; 2]) -> Complex64 {
        self.left.copy_from(&matrices[0]);
        self.right.copy_from(&matrices[1]);
        gevd_cplx(
            self.left.as_mut(),
            self.right.as_mut(),
            self.alpha.as_mut(),
            self.beta.as_mut(),
            None,
            None,
            Par::Seq,
            MemStack::new(&mut self.buffer),
            Default::default(),
        )
        .expect("faer converges");
        self.alpha[0]
    }
}

/// Problems per second of `all`, which solves every problem of a set once.
fn measure_rate(mut all: impl FnMut()) -> f64 {
    let (start, mut passes) = (Instant::now(), 0);
    loop {
        all();
        passes += 1;
        let elapsed = start.elapsed().as_secs_f64();
        if elapsed > MIN_MEASURED_SECONDS {
            return (passes * PROBLEMS_PER_SET) as f64 / elapsed;
        }
    }
}

fn main() -> std::io::Result<()> {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: eigenproblems FILE");
        return Ok(());
    };
    let sets = [
        model_pencils(4),
        model_pencils(5),
        model_pencils(6),
        dense_pencils(9, 6),
        dense_pencils(10, 10),
    ];
    let qz = &mut Qz::default();
    let mut bytes = Vec::from((sets.len() as u64).to_le_bytes());
    let mut matrices: Vec<Vec<[Mat<Complex64>; 2]>> = Vec::new();
    for problems in &sets {
        let n = problems[0].size();
        bytes.extend([n, problems.len()].map(|x| (x as u64).to_le_bytes()).concat());
        let mut own = Vec::new();
        for problem in problems {
            problem.equilibrate(qz);
            let pair =
                [0, 1].map(|which| Mat::from_fn(n, n, |i, j| qz.equilibrated_entries(i, j)[which]));
            for matrix in &pair {
                for j in 0..n {
                    for i in 0..n {
                        bytes.extend(matrix[(i, j)].re.to_le_bytes());
                        bytes.extend(matrix[(i, j)].im.to_le_bytes());
                    }
                }
            }
            own.push(pair);
        }
        matrices.push(own);
    }
    std::fs::write(path, bytes)?;

    let mut out = std::io::stdout();
    writeln!(out, "ready")?;
    for line in std::io::stdin().lock().lines() {
        let Ok(set) = line?.trim().parse::<usize>() else { break };
        let (problems, matrices) = (&sets[set], &matrices[set]);
        let own = measure_rate(|| {
            for problem in problems {
                black_box(problem.solve(qz));
            }
        });
        let mut workspace = FaerWorkspace::new(problems[0].size());
        let faer = measure_rate(|| {
            for pair in matrices {
                black_box(workspace.solve(pair));
            }
        });
        writeln!(out, "{own} {faer}")?;
    }
    Ok(())
}
