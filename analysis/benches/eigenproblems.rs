//! Complex generalised eigenproblems per second on one core: the pencils of all models at random
//! states, and larger random ones. `eigenproblems.py` beside this file hands the same matrices to
//! SciPy and LAPACK in the same run and describes the command line.
//!
//! `eigenproblems FILE`: writes the matrices to FILE, then, for each line `SET` on standard input, prints the problems
//! per second of this crate (equilibration included) and of faer (equilibrated matrices, reused buffers) for that set.
//!
//! FILE: 64-bit little-endian words. Number of sets; for each, the size n and the number of
//! problems as integers, then for each problem L and R, by columns, as (re, im) doubles.

#[path = "../tests/support/mod.rs"]
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
use support::states::{VARIANTS, seeded, wild};
use wellposed_analysis::pencil::Pencil;
use wellposed_analysis::qz::Qz;

const PROBLEMS: usize = 256;
const SECONDS: f64 = 0.5;

/// Eigenproblem in the form in which this crate receives it.
enum Problem {
    Model { pencil: Box<Pencil>, k: f64, direction: f64 },
    Matrices { size: usize, left: Vec<Complex64>, right: Vec<Complex64> },
}

impl Problem {
    fn equilibrate(&self, qz: &mut Qz) {
        match self {
            Self::Model { pencil, k, direction } => pencil.equilibrate(qz, *k, *direction),
            Self::Matrices { size, left, right } => {
                qz.equilibrate(*size, |i, j| left[i + size * j], |i, j| right[i + size * j]);
            }
        }
    }

    fn solve(&self, qz: &mut Qz) -> usize {
        match self {
            Self::Model { pencil, k, direction } => {
                pencil.generalised_eigenvalues_in(qz, *k, *direction).len()
            }
            Self::Matrices { .. } => {
                self.equilibrate(qz);
                qz.solve().map_or(0, |values| values.len())
            }
        }
    }

    fn size(&self) -> usize {
        match self {
            Self::Model { pencil, .. } => pencil.scaled.system.equations.len(),
            Self::Matrices { size, .. } => *size,
        }
    }
}

/// Pencils of the models with `size` equations at random states, wave numbers and directions.
fn models(size: usize) -> Vec<Problem> {
    let mut problems = Vec::new();
    let random = &mut seeded(size as u64);
    while problems.len() < PROBLEMS {
        let (kind, dilatancy) = VARIANTS[(random.unit() * VARIANTS.len() as f64) as usize];
        let sample = wild(random, kind, dilatancy);
        if sample.system.equations.len() == size {
            let mut pencil = Box::<Pencil>::default();
            pencil.update(&sample.system).expect("finite coefficients");
            let (k, direction) =
                (random.decades(1e-2, 1e8), random.within(0.0, std::f64::consts::TAU));
            problems.push(Problem::Model { pencil, k, direction });
        }
    }
    problems
}

/// Dense pencils of random entries, complex L and real R, with `rank` rows of R that are not zero.
fn dense(size: usize, rank: usize) -> Vec<Problem> {
    let random = &mut seeded((100 * size + rank) as u64);
    let problem = |_| {
        let mut part = || random.within(-1.0, 1.0);
        let left = (0..size * size).map(|_| Complex64::new(part(), part())).collect();
        let right = (0..size * size)
            .map(|at| if at % size < rank { part().into() } else { Complex64::ZERO })
            .collect();
        Problem::Matrices { size, left, right }
    };
    (0..PROBLEMS).map(problem).collect()
}

/// Workspace of faer with reused buffers.
struct Faer {
    left: Mat<Complex64>,
    right: Mat<Complex64>,
    alpha: Diag<Complex64>,
    beta: Diag<Complex64>,
    memory: MemBuffer,
}

impl Faer {
    fn new(n: usize) -> Self {
        let scratch = gevd_scratch::<Complex64>(n, No, No, Par::Seq, Default::default());
        Self {
            left: Mat::zeros(n, n),
            right: Mat::zeros(n, n),
            alpha: Diag::zeros(n),
            beta: Diag::zeros(n),
            memory: MemBuffer::new(scratch),
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
            MemStack::new(&mut self.memory),
            Default::default(),
        )
        .expect("faer converges");
        self.alpha[0]
    }
}

/// Problems per second of `all`, which solves every problem of a set once.
fn rate(mut all: impl FnMut()) -> f64 {
    let (start, mut passes) = (Instant::now(), 0);
    loop {
        all();
        passes += 1;
        let elapsed = start.elapsed().as_secs_f64();
        if elapsed > SECONDS {
            return (passes * PROBLEMS) as f64 / elapsed;
        }
    }
}

fn main() -> std::io::Result<()> {
    // `cargo bench` appends --bench.
    let Some(path) = std::env::args().nth(1).filter(|path| !path.starts_with("--")) else {
        eprintln!("usage: eigenproblems FILE");
        return Ok(());
    };
    let sets = [models(4), models(5), models(6), dense(9, 6), dense(10, 10)];
    let qz = &mut Qz::default();
    let mut bytes = Vec::from((sets.len() as u64).to_le_bytes());
    let mut matrices: Vec<Vec<[Mat<Complex64>; 2]>> = Vec::new();
    for problems in &sets {
        let n = problems[0].size();
        bytes.extend([n, problems.len()].map(|x| (x as u64).to_le_bytes()).concat());
        let mut own = Vec::new();
        for problem in problems {
            problem.equilibrate(qz);
            let pair = [0, 1].map(|which| Mat::from_fn(n, n, |i, j| qz.entry(i, j)[which]));
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
        let own = rate(|| {
            for problem in problems {
                black_box(problem.solve(qz));
            }
        });
        let mut workspace = Faer::new(problems[0].size());
        let faer = rate(|| {
            for pair in matrices {
                black_box(workspace.solve(pair));
            }
        });
        writeln!(out, "{own} {faer}")?;
    }
    Ok(())
}
