//! Cells of blocks: symmetries, chains, finite elements, rigid blocks, long waves, band structure.

use super::finite_elements;
use super::media::{THICKNESSES, build_medium, build_single_block_chain};
use models::interface::homogenised::BlockMaterial;
use models::interface::opening_line::LayerMass;
use std::f64::consts::PI;
use wellposed_analysis::bloch::BlochError;
use wellposed_analysis::bloch::cell::{
    BlockRow, Cell, CellBlock, CellModel, DegreeControl, Joint, JointComponent,
};
use wellposed_analysis::bloch::chain::ChainPolarisation::{Longitudinal, Transverse};

/// Three wave vectors in different directions, in units of 1/h.
const WAVE_VECTORS: [[f64; 2]; 3] = [[1.3, 0.0], [1.1, 1.1], [2.2, 0.9]];

/// Wave vector, 1/m, of the phase shifts per period.
fn wave_vector_from_shifts(shifts: [f64; 2], period: f64) -> [f64; 2] {
    shifts.map(|shift| shift / period)
}

/// Masonry of two rows with blocks of different widths and media and one cracked joint.
fn build_masonry(offset: f64) -> Cell {
    let [soft, stiff] = [build_medium(5e-3), build_medium(1e-3)];
    let joint = Joint::from_layer(&soft.layer, false);
    let lumped = Joint::from_layer(&stiff.layer, true);
    let open = JointComponent { mass: LayerMass::new_box(0.0), stiffness: 0.0, delay: None };
    let cracked = Joint { normal: open, tangential: open };
    let other = BlockMaterial { density: 2000.0, longitudinal_speed: 4000.0, shear_speed: 2000.0 };
    let block = |width, material, right_joint, top_joint| CellBlock {
        width,
        material,
        right_joint,
        top_joint,
    };
    Cell::new(vec![
        BlockRow {
            height: 0.05,
            offset: 0.0,
            blocks: vec![
                block(0.06, soft.block, joint, lumped),
                block(0.04, other, cracked, joint),
            ],
        },
        BlockRow { height: 0.04, offset, blocks: vec![block(0.1, soft.block, lumped, joint)] },
    ])
    .expect("valid")
}

/// Verifies that the matrices are Hermitian, frequencies even in κ, periodic in the reciprocal lattice, and do not
/// depend on a common offset of the rows.
#[test]
fn frequencies_have_the_symmetries_of_the_cell() {
    let model = CellModel::new(&build_masonry(0.03), 4);
    let [width, height] = [0.1, 0.09];
    let squares = |model: &CellModel, at: [f64; 2]| {
        model.modes(at, 10, false).expect("modes").squared_frequencies
    };
    let mut worst = [0.0f64; 4];
    for [x, y] in [[10.0, 3.0], [-20.0, 31.0], [5.0, 0.0]] {
        for matrix in model.matrices([x, y]) {
            let difference = (&matrix - matrix.adjoint()).norm();
            worst[0] = worst[0].max(difference / matrix.norm());
        }
        let expected = squares(&model, [x, y]);
        let change = |found: Vec<f64>| {
            let pairs = found.into_iter().zip(&expected);
            pairs.map(|(a, b)| (a - b).abs() / expected[9]).fold(0.0, f64::max)
        };
        worst[1] = worst[1].max(change(squares(&model, [-x, -y])));
        let other = [x + 2.0 * PI / width, y - 4.0 * PI / height];
        worst[2] = worst[2].max(change(squares(&model, other)));
        // Both rows moved by 0.07, the second also by a period.
        let mut rows = build_masonry(0.03).rows().to_vec();
        rows[0].offset += 0.07;
        rows[1].offset += 0.17;
        let moved = CellModel::new(&Cell::new(rows).expect("valid"), 4);
        worst[3] = worst[3].max(change(squares(&moved, [x, y])));
    }
    println!("Hermitian, inversion, periodicity, offset: {worst:?}");
    assert!(worst.iter().all(|&error| error < 1e-11), "{worst:?}");
}

/// Verifies that along an axis, with welded joints normal to the other, the branches include those of the chain for
/// longitudinal and transverse waves. Welded joints are massless, with stiffnesses K of 1000, 2000 and 4000 times that
/// of the block, extrapolated in 1/K.
#[test]
fn cell_along_an_axis_equals_the_chain() {
    let mut worst = 0.0f64;
    for (thickness, is_lumped) in [(1e-4, false), (1e-3, false), (1e-3, true), (5e-3, false)] {
        let medium = build_medium(thickness);
        let h = medium.period;
        let layer = Joint::from_layer(&medium.layer, is_lumped);
        let models = [1e3, 2e3, 4e3].map(|factor| {
            let stiffness = factor * medium.block.shear_modulus() / h;
            let weld = JointComponent { mass: LayerMass::new_box(0.0), stiffness, delay: None };
            let weld = Joint { normal: weld, tangential: weld };
            let block =
                CellBlock { width: h, material: medium.block, right_joint: layer, top_joint: weld };
            let row = BlockRow { height: h, offset: 0.0, blocks: vec![block] };
            CellModel::new(&Cell::new(vec![row]).expect("valid"), 9)
        });
        for shift in [0.7, 2.0, PI] {
            let [a, b, c] = models
                .each_ref()
                .map(|model| model.modes([shift / h, 0.0], 6, false).expect("modes").frequencies());
            let found: Vec<f64> = (0..6)
                .map(|i| {
                    let (x, y) = (2.0 * b[i] - a[i], 2.0 * c[i] - b[i]);
                    y + (y - x) / 3.0
                })
                .collect();
            for (polarisation, branches) in [(Transverse, 2), (Longitudinal, 1)] {
                let chain = build_single_block_chain(&medium, is_lumped, polarisation);
                for branch in 0..branches {
                    let expected = chain.frequency(branch, shift).expect("a branch");
                    let error = |found: &f64| (found / expected - 1.0).abs();
                    let error = found.iter().map(error).fold(f64::INFINITY, f64::min);
                    println!(
                        "δ = {thickness}, κh = {shift:.2}, {polarisation:?} {branch}: {error:.1e}"
                    );
                    worst = worst.max(error);
                }
            }
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-9, "{worst:e}");
}

/// Verifies the six lowest branches in three directions against bilinear finite elements, extrapolated in the mesh
/// width, for box and lumped masses.
#[test]
fn cell_equals_finite_elements_in_three_directions() {
    let meshes = [6, 8, 12, 16];
    let mut worst = 0.0f64;
    for (thickness, is_lumped) in [(1e-3, false), (5e-3, true)] {
        let medium = build_medium(thickness);
        let cell = Cell::from_medium(&medium, is_lumped).expect("valid");
        let share = if is_lumped { 0.25 } else { 0.0 };
        for shifts in WAVE_VECTORS {
            let at = wave_vector_from_shifts(shifts, medium.period);
            let found = cell.solve(at, 4, &DegreeControl::default()).expect("modes");
            let elements =
                meshes.map(|n| finite_elements::squared_frequencies(&medium, at, (n, 0), share, 4));
            for (branch, frequency) in found.frequencies().into_iter().enumerate() {
                let values = elements.each_ref().map(|values| values[branch]);
                let expected = finite_elements::extrapolate(meshes, values).sqrt();
                let raw = values[3].sqrt() / frequency - 1.0;
                let error = frequency / expected - 1.0;
                println!(
                    "δ = {thickness}, κh = {shifts:?}, branch {branch}: {frequency:.3} rad/s, finite elements raw {raw:.1e}, extrapolated {error:.1e}"
                );
                worst = worst.max(error.abs());
            }
            println!("degree {}, achieved {:.1e}", found.degree, found.frequency_error);
            assert!(found.frequency_error <= 1e-6);
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-4, "{worst:e}");
}

/// Verifies, for running bond (each row shifted by half a block), that the cell of two rows has the frequencies of
/// finite elements on the lattice (h, 0), (h/2, h) at κ and κ + (0, π/h), where κ₂ of both rows differs by the
/// reciprocal lattice.
#[test]
fn running_bond_equals_finite_elements_on_an_oblique_lattice() {
    let meshes = [6, 8, 12, 16];
    let medium = build_medium(5e-3);
    let h = medium.period;
    let joint = Joint::from_layer(&medium.layer, false);
    let block =
        CellBlock { width: h, material: medium.block, right_joint: joint, top_joint: joint };
    let row = |offset| BlockRow { height: h, offset, blocks: vec![block] };
    let cell = Cell::new(vec![row(0.0), row(0.5 * h)]).expect("valid");
    let at = wave_vector_from_shifts([1.2, 0.8], h);
    let control = DegreeControl { tolerance: 1e-9, first_degree: 4, largest_degree: 10 };
    let found = cell.solve(at, 5, &control).expect("modes");
    let mut expected = Vec::new();
    for second in [at[1], at[1] + PI / h] {
        let elements = meshes.map(|n| {
            finite_elements::squared_frequencies(&medium, [at[0], second], (n, n / 2), 0.0, 4)
        });
        for branch in 0..4 {
            let values = elements.each_ref().map(|values| values[branch]);
            expected.push(finite_elements::extrapolate(meshes, values).sqrt());
        }
    }
    expected.sort_by(f64::total_cmp);
    let mut worst = 0.0f64;
    for ((best, raw), expected) in
        found.frequencies().iter().zip(found.modes.frequencies()).zip(&expected)
    {
        let [error, raw] = [best, &raw].map(|frequency| frequency / expected - 1.0);
        println!("{best:.3} rad/s: {error:.1e}, without extrapolation {raw:.1e}");
        worst = worst.max(error.abs());
    }
    println!("degree {}, achieved {:.1e}, worst {worst:.1e}", found.degree, found.frequency_error);
    assert!(worst < found.frequency_error && found.frequency_error < 1e-4);
}

/// Verifies the speeds of long waves in three directions against the homogenised Cosserat constants.
#[test]
fn long_wave_speeds_agree_with_homogenised_constants() {
    let mut worst = 0.0f64;
    for thickness in THICKNESSES {
        for is_lumped in [false, true] {
            let medium = build_medium(thickness);
            let cell = Cell::from_medium(&medium, is_lumped).expect("valid");
            let constants = medium.homogenise().expect("valid");
            for degrees in [0.0f64, 20.0, 45.0] {
                let (sin, cos) = degrees.to_radians().sin_cos();
                let found = cell.long_wave_speeds([cos, sin], 7).expect("speeds");
                let expected = constants.long_wave_speeds([cos, sin]);
                let error: Vec<f64> = (0..2).map(|i| found.speeds[i] / expected[i] - 1.0).collect();
                println!(
                    "δ = {thickness}, {degrees}°: {:?} m/s, errors {error:?}, stated {:.1e}",
                    found.speeds, found.error
                );
                worst = error.iter().fold(worst, |a, b| a.max(b.abs()));
            }
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-7, "{worst:e}");
}

/// Verifies that the transverse wave along x₁ in almost rigid blocks has the frequencies of a lattice of rigid blocks,
/// to first order in K_t h/μ (tangential stiffness K_t, side h, shear modulus μ).
#[test]
fn nearly_rigid_blocks_agree_with_the_lattice_model() {
    let (normal, tangential) = (4.0, 1.0);
    let joint =
        |stiffness| JointComponent { mass: LayerMass::new_box(0.0), stiffness, delay: None };
    let joint = Joint { normal: joint(normal), tangential: joint(tangential) };
    let mut errors = Vec::new();
    for speed in [30.0, 100.0, 300.0] {
        let material = BlockMaterial {
            density: 1.0,
            longitudinal_speed: 5.0 / 3.0 * speed,
            shear_speed: speed,
        };
        let block = CellBlock { width: 1.0, material, right_joint: joint, top_joint: joint };
        let row = BlockRow { height: 1.0, offset: 0.0, blocks: vec![block] };
        let model = CellModel::new(&Cell::new(vec![row]).expect("valid"), 6);
        let mut worst = 0.0f64;
        for shift in [0.5f64, 1.5, PI] {
            let (s, c) = (0.5 * shift).sin_cos();
            let (inertia, diagonal) =
                (1.0 / 6.0, tangential * (1.0 + c * c) + normal * s * s / 3.0);
            // det [4K_t s² − ω², 2K_t sc; 2K_t sc, K_t(1 + c²) + K_n s²/3 − Jω²] = 0.
            let (a, b) = (4.0 * tangential * s * s, diagonal / inertia);
            let off = (2.0 * tangential * s * c).powi(2) / inertia;
            let root = (0.25 * (a - b) * (a - b) + off).sqrt();
            let squares = model.modes([shift, 0.0], 3, false).expect("modes").squared_frequencies;
            for expected in [0.5 * (a + b) - root, 0.5 * (a + b) + root] {
                let error = |square: &f64| (square / expected - 1.0).abs();
                worst = worst.max(squares.iter().map(error).fold(f64::INFINITY, f64::min));
            }
        }
        println!("K_t h/μ = {:e}: {worst:e}", tangential / (speed * speed));
        errors.push(worst * speed * speed);
    }
    // First order: error times μ tends to a constant.
    assert!((errors[1] / errors[2] - 1.0).abs() < 0.02, "{errors:?}");
}

/// Verifies the band structure along Γ–X–M–Γ, a total band gap below the vibrations inside blocks for thick soft layers
/// (also at wave vectors that were not sampled), stability, and instability for negative stiffness.
#[test]
fn band_structure_has_a_gap_and_shows_instability() {
    let medium = build_medium(5e-3);
    let cell = Cell::from_medium(&medium, true).expect("valid");
    let control = DegreeControl { tolerance: 1e-3, first_degree: 3, largest_degree: 9 };
    let structure = cell.band_structure(&cell.standard_path(), 6, 4, &control).expect("bands");
    assert_eq!(structure.samples.len(), 13);
    let names: Vec<&str> = structure.vertices.iter().map(|(_, point)| point.name).collect();
    assert_eq!(names, ["Γ", "X", "M", "Γ"]);
    assert_eq!(build_masonry(0.0).standard_path().last().map(|point| point.name), Some("Y"));
    assert!(structure.is_stable && structure.frequency_error < 1e-2);
    let model = CellModel::new(&cell, 5);
    let gaps = model.total_gaps(6, 4).expect("gaps");
    println!(
        "degree {}, achieved {:e}, gaps {gaps:?}",
        structure.degree, structure.frequency_error
    );
    let gap = gaps.iter().find(|gap| gap.bands_below == 3).expect("a gap above the rigid modes");
    for i in 0..60 {
        let at = wave_vector_from_shifts(
            [(f64::from(i) * 0.7548).fract(), (f64::from(i) * 0.5698).fract()]
                .map(|x| PI * (2.0 * x - 1.0)),
            0.05,
        );
        let frequencies = model.modes(at, 4, false).expect("modes").frequencies();
        assert!(frequencies[2] <= gap.lower.0 * (1.0 + 1e-9));
        assert!(frequencies[3] >= gap.upper.0 * (1.0 - 1e-9));
    }
    // Softening joints: the verdict is unstable.
    let mut rows = cell.rows().to_vec();
    rows[0].blocks[0].top_joint.tangential.stiffness *= -0.5;
    let softening = CellModel::new(&Cell::new(rows).expect("valid"), 4);
    assert!(!softening.modes([0.0, 30.0], 4, false).expect("modes").is_stable());
}

/// Verifies that modes satisfy K u = ω² M u and are orthonormal, and that a missing block has zero displacement.
#[test]
fn eigenvectors_solve_the_eigenproblem() {
    let model = CellModel::new(&build_masonry(0.03), 4);
    let at = [12.0, -7.0];
    let modes = model.modes(at, 6, true).expect("modes");
    let [stiffness, mass] = model.matrices(at);
    let gram = modes.eigenvectors.adjoint() * &mass * &modes.eigenvectors;
    let energy = modes.eigenvectors.adjoint() * &stiffness * &modes.eigenvectors;
    let scale = modes.squared_frequencies[5];
    for i in 0..6 {
        for j in 0..6 {
            let unit = f64::from(u8::from(i == j));
            assert!((gram[(i, j)] - unit).norm() < 1e-11);
            let expected = unit * modes.squared_frequencies[i];
            assert!((energy[(i, j)] - expected).norm() < 1e-8 * scale);
        }
    }
    let vector: Vec<_> = modes.eigenvectors.column(0).iter().copied().collect();
    assert!(model.displacement(&vector, 0, [0.3, -0.2])[0].norm() > 0.0);
    assert_eq!(model.displacement(&vector, 7, [0.0; 2])[1].norm(), 0.0);
}

/// Verifies that invalid cells are rejected with typed errors.
#[test]
fn invalid_cells_are_rejected() {
    let is_rejected = |rows: Vec<BlockRow>, name: &str| match Cell::new(rows) {
        Err(BlochError::Input(error)) => error.input == name,
        _ => false,
    };
    let rows = build_masonry(0.0).rows().to_vec();
    assert!(is_rejected(vec![], "rows"));
    let mut bad = rows.clone();
    bad[0].blocks[0].width = 0.07;
    assert!(is_rejected(bad, "width"));
    let mut bad = rows.clone();
    bad[1].blocks[0].top_joint.normal.stiffness = f64::INFINITY;
    assert!(is_rejected(bad, "stiffness"));
    let model = CellModel::new(&build_masonry(0.0), 2);
    assert!(model.modes([f64::NAN, 0.0], 2, false).is_err());
}
