//! Instant rotation of one block of a blocky medium: tractions at early times against the exact solution, symmetries,
//! angular momentum; rigid rotation of the whole medium.

use crate::support::blocky::{
    BLOCK_LENGTH, ROCK_DENSITY, ROCK_SPEEDS, THICKNESSES, blocky_problem, elastic_layer,
    layer_material,
};
use models::interface::history::{NORMAL_MOTION, SHEAR_MOTION};
use models::solid::waves::SolidField;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::problem::Problem;

const BLOCK_COUNT: usize = 3;
/// Initial angular velocity ω₀ of the block, rad/s.
const ANGULAR_VELOCITY: f64 = 1.0;

/// Blocky medium of 3 × 3 blocks, and its solver.
struct BlockyMedium {
    problem: Problem<2>,
    domain: DecomposedDomain<f64, 2>,
    cells_per_block: usize,
    /// Mass of the interlayers, kg/m².
    layer_mass: f64,
}

impl BlockyMedium {
    /// Creates a medium in which the cells that `rotates` selects, by the indices of their block, rotate about the
    /// centre of the medium; interlayers have the mean velocity of both sides.
    fn new(
        cells_per_block: usize,
        thickness: f64,
        boundary: &Boundary,
        rotates: impl Fn([usize; 2]) -> bool,
    ) -> Self {
        let boundaries = [0, 1].map(|_| [boundary.clone(), boundary.clone()]);
        let law = elastic_layer(thickness);
        let problem = blocky_problem([BLOCK_COUNT; 2], cells_per_block, law, boundaries);
        let mut domain = DecomposedDomain::<f64, 2>::new(&problem, 1).expect("sound");
        let velocity = |axis: usize| -> Vec<f64> {
            let value = |cell| {
                let indices = cell_indices(&problem, cell);
                match rotates(indices.map(|own| own / cells_per_block)) {
                    true => {
                        ANGULAR_VELOCITY
                            * [-1.0, 1.0][axis]
                            * cell_centre(&problem, indices)[1 - axis]
                    }
                    false => 0.0,
                }
            };
            (0..problem.grid.count()).map(value).collect()
        };
        domain.set_field(SolidField::Velocity(0), &velocity(0));
        domain.set_field(SolidField::Velocity(1), &velocity(1));
        domain.initialise_interlayers();
        let layer_mass = layer_material(thickness).mass();
        Self { problem, domain, cells_per_block, layer_mass }
    }

    /// Creates a medium whose central block rotates.
    fn with_rotating_centre(cells_per_block: usize, thickness: f64) -> Self {
        Self::new(cells_per_block, thickness, &Boundary::NonReflecting, |block| block == [1, 1])
    }

    /// Sets the history variables of all interlayers to zero: no velocity and no stress.
    fn set_interlayers_at_rest(&mut self) {
        let mut snapshot = self.domain.snapshot();
        snapshot.interlayer_history.fill(0.0);
        assert!(self.domain.restore(&snapshot));
    }

    fn advance_to(&mut self, time: f64) {
        let steps = ((time - self.domain.time()) / self.problem.step).round() as usize;
        self.domain.advance(steps).expect("threads");
    }

    /// Returns the tractions S₁₂ of the four pairs of faces in the middle of the sides of the central block, mean of
    /// both faces: two sides normal to the first axis, then two normal to the second.
    fn side_tractions(&self) -> [f64; 4] {
        let n = self.cells_per_block;
        let records = self.problem.interlayer_records(&self.domain.interlayer_history());
        let mut sums = [0.0; 4];
        for (face, record) in records {
            let indices = cell_indices(&self.problem, face.cell);
            let index_along = indices[1 - face.axis];
            if index_along == n + n / 2 - 1 || index_along == n + n / 2 {
                let side = indices[face.axis] / n - 1;
                sums[2 * face.axis + side] += 0.5 * record.shear_stress;
            }
        }
        sums
    }

    /// Computes the angular momentum of cells and interlayers about the centre, kg m/s.
    fn angular_momentum(&self) -> f64 {
        let values = |axis| self.domain.values(SolidField::Velocity(axis)).expect("a field");
        let [v1, v2] = [values(0), values(1)];
        let moment = |position: [f64; 2], velocity: [f64; 2]| {
            position[0] * velocity[1] - position[1] * velocity[0]
        };
        let cell_momentum: f64 = (0..self.problem.grid.count())
            .map(|cell| {
                moment(
                    cell_centre(&self.problem, cell_indices(&self.problem, cell)),
                    [v1[cell], v2[cell]],
                )
            })
            .sum();
        let spacing = self.problem.grid.spacing[0];
        let history = self.domain.interlayer_history();
        let mut layer_momentum = 0.0;
        for face in self.problem.interlayer_faces() {
            let mut position = cell_centre(&self.problem, cell_indices(&self.problem, face.cell));
            position[face.axis] -= 0.5 * spacing;
            let variables = &history[face.history];
            let mut velocity = [variables[NORMAL_MOTION], variables[SHEAR_MOTION]];
            if face.axis == 1 {
                velocity.reverse();
            }
            layer_momentum += moment(position, velocity);
        }
        ROCK_DENSITY * spacing * spacing * cell_momentum
            + self.layer_mass * spacing * layer_momentum
    }
}

/// Returns the indices of a cell along both axes.
fn cell_indices(problem: &Problem<2>, cell: usize) -> [usize; 2] {
    [cell % problem.grid.cells[0], cell / problem.grid.cells[0]]
}

/// Returns the centre of a cell relative to that of the medium, m.
fn cell_centre(problem: &Problem<2>, indices: [usize; 2]) -> [f64; 2] {
    std::array::from_fn(|axis| {
        let from_middle = indices[axis] as f64 + 0.5 - 0.5 * problem.grid.cells[axis] as f64;
        problem.grid.spacing[axis] * from_middle
    })
}

/// Returns the shear stiffness K_t of interlayers, Pa/m.
fn shear_stiffness(thickness: f64) -> f64 {
    1.0 / layer_material(thickness).tangential_compliance()
}

/// Computes the traction S₁₂ in the middle of a side normal to the first axis until signals of the corners arrive, for
/// the initial velocity V₁ = −`initial` ω₀x₂ of the interlayer: −¼z₂ω₀h(1 − e^{−2K_tt/z₂}) for ½, where waves of the
/// normal component leave the shear unchanged.
///
/// In general, velocities v₁ and stresses σ₁₁, σ₂₂ are proportional to x₂, while v₂ and σ₁₂ do not depend on it. With
/// V₁ = −½ω₀x₂(1 − f e^{−bt}), b = 2z₁/m and f = 1 − 2·`initial`, the shear waves that arrive at the interlayer differ
/// from those of a rigid block by the integral of f ω₀e^{−bt} times β = (μ − λc₂/c₁)/(1 + c₂/c₁):
///
/// ```text
/// Ṡ/K_t + 2S/z₂ = −½ω₀h + γ(1 − e^{−bt}),    γ = f βω₀m/(2z₁z₂).
/// ```
fn exact_traction(thickness: f64, initial: f64, time: f64) -> f64 {
    let [c1, c2] = ROCK_SPEEDS;
    let [z1, shear_impedance] = [c1, c2].map(|speed| ROCK_DENSITY * speed);
    let [mu, lambda] = [shear_impedance * c2, z1 * c1 - 2.0 * shear_impedance * c2];
    let (mass, stiffness) = (layer_material(thickness).mass(), shear_stiffness(thickness));
    let beta = (mu - lambda * c2 / c1) / (1.0 + c2 / c1);
    let gamma =
        (1.0 - 2.0 * initial) * beta * ANGULAR_VELOCITY * mass / (2.0 * z1 * shear_impedance);
    let [a, b] = [2.0 * stiffness / shear_impedance, 2.0 * z1 / mass];
    let relaxed = 1.0 - (-a * time).exp();
    let fast = ((-b * time).exp() - (-a * time).exp()) / (a - b);
    stiffness * ((gamma - 0.5 * ANGULAR_VELOCITY * BLOCK_LENGTH) * relaxed / a - gamma * fast)
}

/// Returns the impedance z₂ of the rock for S waves, kg/(m²s).
fn shear_impedance() -> f64 {
    ROCK_DENSITY * ROCK_SPEEDS[1]
}

/// Returns the traction scale ¼z₂ω₀h, Pa.
fn traction_scale() -> f64 {
    0.25 * shear_impedance() * ANGULAR_VELOCITY * BLOCK_LENGTH
}

/// Returns the time before which the middle of a side of a block receives no signal of a corner, h/(2c₁), s.
fn corner_time() -> f64 {
    BLOCK_LENGTH / (2.0 * ROCK_SPEEDS[0])
}

/// Computes the largest deviation of the tractions at the sides of the block from the exact ones at 1/5, 2/5 and 3/5 of
/// the corner time, the same times for all grids of a multiple of 20 cells, relative to ¼z₂ω₀h: of the sides normal to
/// each axis. Also checks the sides against each other.
fn traction_errors(cells: usize, thickness: f64, is_at_rest: bool) -> [f64; 2] {
    let mut medium = BlockyMedium::with_rotating_centre(cells, thickness);
    if is_at_rest {
        medium.set_interlayers_at_rest();
    }
    let initial = if is_at_rest { 0.0 } else { 0.5 };
    let mut errors = [0.0f64; 2];
    for fifths in 1..=3 {
        medium.advance_to(0.2 * f64::from(fifths) * corner_time());
        let exact = exact_traction(thickness, initial, medium.domain.time());
        let [left, right, below, above] = medium.side_tractions();
        assert!(left == right && below == above);
        errors[0] = errors[0].max((left - exact).abs() / traction_scale());
        errors[1] = errors[1].max((below + exact).abs() / traction_scale());
    }
    errors
}

/// Verifies the tractions at the sides of a rotating block: they converge to the exact solution at second order,
/// from layers with the mean velocity of both sides and from layers at rest, and are right to 0.3 % with 40
/// cells. The law −¼z₂ω₀h(1 − e^{−2K_tt/z₂}) is exact for the former, and for the latter right to βm/(z₁z₂h).
#[test]
fn side_tractions_of_a_rotating_block_obey_the_early_time_law() {
    for thickness in THICKNESSES {
        for is_at_rest in [false, true] {
            let errors = [20, 40, 80].map(|cells| traction_errors(cells, thickness, is_at_rest));
            println!("δ {thickness}, layers at rest {is_at_rest}: {errors:?}");
            for axis in 0..2 {
                assert!(errors[1][axis] < 3e-3, "{errors:?}");
                let order = (errors[1][axis] / errors[2][axis]).log2();
                assert!(order > 1.7, "{order}: {errors:?}");
            }
        }
        let law =
            1.0 - (-2.0 * shear_stiffness(thickness) / shear_impedance() * corner_time()).exp();
        let deviation = |initial| {
            (exact_traction(thickness, initial, corner_time()) / traction_scale() + law).abs()
        };
        println!("δ {thickness}: deviation from the law {} {}", deviation(0.5), deviation(0.0));
        assert!(deviation(0.5) < 1e-14);
        assert!(deviation(0.0) < 2.3e-3 * thickness / 1e-3);
    }
}

/// Returns the values of the velocities v₁, v₂ and the stresses σ₁₁, σ₁₂, σ₂₂.
fn plane_strain_fields(medium: &BlockyMedium) -> [Vec<f64>; 5] {
    let fields = [
        SolidField::Velocity(0),
        SolidField::Velocity(1),
        SolidField::Stress(0, 0),
        SolidField::Stress(0, 1),
        SolidField::Stress(1, 1),
    ];
    fields.map(|field| medium.domain.values(field).expect("a field"))
}

/// Verifies that the fields are mapped to themselves by half turns and to their opposites by mirror images, to the bit
/// except for signs of zeros: all sweeps are symmetric.
#[test]
fn rotating_block_keeps_half_turns_and_mirror_images_to_the_bit() {
    for thickness in [1e-4, 5e-3] {
        let mut medium = BlockyMedium::with_rotating_centre(10, thickness);
        medium.domain.advance(40).expect("threads");
        let (n, fields) = (BLOCK_COUNT * 10, plane_strain_fields(&medium));
        let cell_fields =
            |indices: [usize; 2]| fields.each_ref().map(|own| own[indices[0] + n * indices[1]]);
        for cell in 0..n * n {
            let [x, y] = [cell % n, cell / n];
            let [v1, v2, s11, s12, s22] = cell_fields([x, y]);
            assert_eq!(cell_fields([n - 1 - x, n - 1 - y]), [-v1, -v2, s11, s12, s22]);
            // A rotation is mapped to its opposite.
            assert_eq!(cell_fields([n - 1 - x, y]), [v1, -v2, -s11, s12, -s22]);
            assert_eq!(cell_fields([x, n - 1 - y]), [-v1, v2, -s11, s12, -s22]);
        }
        assert!(fields.iter().all(|own| own.iter().any(|value| *value != 0.0)));
    }
}

/// Computes the difference of the fields to those of a quarter turn, relative to the fields, of means over squares of
/// `square` × `square` cells.
fn quarter_turn_error(medium: &BlockyMedium, square: usize) -> f64 {
    let cells = BLOCK_COUNT * medium.cells_per_block;
    let n = cells / square;
    let z = ROCK_DENSITY * ROCK_SPEEDS[0];
    let means = plane_strain_fields(medium).map(|values| {
        let mut means = vec![0.0; n * n];
        for (cell, value) in values.iter().enumerate() {
            means[cell % cells / square + n * (cell / cells / square)] += value;
        }
        means
    });
    let cell_fields =
        |indices: [usize; 2]| means.each_ref().map(|own| own[indices[0] + n * indices[1]]);
    let (mut difference, mut size) = (0.0, 0.0);
    for cell in 0..n * n {
        let [x, y] = [cell % n, cell / n];
        let [v1, v2, s11, s12, s22] = cell_fields([x, y]);
        // Components after a quarter turn, which takes (x₁, x₂) to (−x₂, x₁).
        let turned = [-v2, v1, s22, -s12, s11];
        for (index, (own, turned)) in
            cell_fields([n - 1 - y, x]).into_iter().zip(turned).enumerate()
        {
            let unit = if index < 2 { 1.0 } else { z };
            difference += ((own - turned) / unit).powi(2);
            size += (own / unit).powi(2);
        }
    }
    (difference / size).sqrt()
}

/// Verifies that quarter turns are kept at second order in the cell size: sweeps are in the order x y y x. The fields
/// have fronts, behind which neighbouring cells alternate, so that the difference in single cells falls at an order of
/// ½ to 1; means over squares of h/10, of two cells or more, converge at second order.
#[test]
fn rotating_block_keeps_quarter_turns_at_second_order() {
    for thickness in THICKNESSES {
        for fraction in [0.5, 1.0] {
            let time = fraction * BLOCK_LENGTH / ROCK_SPEEDS[0];
            let errors = [20, 40].map(|cells| {
                let mut medium = BlockyMedium::with_rotating_centre(cells, thickness);
                medium.advance_to(time);
                [cells / 10, 1].map(|square| quarter_turn_error(&medium, square))
            });
            let orders = [0, 1].map(|i| (errors[0][i] / errors[1][i]).log2());
            println!("δ {thickness}, time {fraction} h/c₁: {errors:?}, orders {orders:?}");
            assert!(orders[0] > 1.85 && errors[1][0] < 0.011, "{errors:?} {orders:?}");
            assert!(orders[1] > 0.4, "{errors:?} {orders:?}");
        }
    }
}

/// Verifies that the angular momentum ρω₀h⁴/6 of the block and that of its interlayers are constant at second order in
/// the cell size until signals reach the outer sides: stress is symmetric, but sweeps along both axes take their
/// torques from different times.
#[test]
fn angular_momentum_of_a_rotating_block_is_constant_to_second_order() {
    for thickness in THICKNESSES {
        let errors = [10, 20, 40].map(|cells| {
            let mut medium = BlockyMedium::with_rotating_centre(cells, thickness);
            let start = medium.angular_momentum();
            // Cells rotate as points in their centres; interlayers with half the velocity of the outermost cells.
            let (n, h) = (cells as f64, BLOCK_LENGTH);
            let second_moment = h.powi(3) / 12.0 * (1.0 - 1.0 / (n * n));
            let block_momentum = 2.0 * ROCK_DENSITY * h * second_moment;
            let edge_moment = 0.25 * h * h * (1.0 - 1.0 / n);
            let layer_momentum = 2.0 * medium.layer_mass * (h * edge_moment + second_moment);
            let expected = ANGULAR_VELOCITY * (block_momentum + layer_momentum);
            // Both are sums of some thousand terms, equal up to rounding.
            assert!((start / expected - 1.0).abs() < 1e-12, "{start} {expected}");
            let mut error = 0.0f64;
            for fraction in [0.25, 0.5, 0.75, 1.0] {
                medium.advance_to(fraction * BLOCK_LENGTH / ROCK_SPEEDS[0]);
                error = error.max((medium.angular_momentum() / start - 1.0).abs());
            }
            error
        });
        let order = (errors[1] / errors[2]).log2();
        println!("δ {thickness}: {errors:?}, order {order}");
        assert!(order > 1.8 && errors[2] < 1e-3, "{errors:?}");
    }
}

/// Verifies that a rigid rotation of the whole medium causes tractions in the interlayers that vanish with the cell
/// size: at second order in the middle of sides of blocks, at first order at the corners of blocks and on free sides,
/// where cells have interlayers or sides in both directions. They are zero with exact sweeps only: shear waves have a
/// Courant number below 1, and their reconstruction next to an interlayer is one-sided.
#[test]
fn tractions_under_a_rigid_rotation_of_the_medium_vanish_with_the_cell_size() {
    for thickness in THICKNESSES {
        let errors = [10, 20, 40].map(|cells| {
            let mut medium = BlockyMedium::new(cells, thickness, &Boundary::Free, |_| true);
            let [mut shear, mut normal, mut middle] = [0.0f64; 3];
            for tenths in 1..=10 {
                medium.advance_to(0.1 * f64::from(tenths) * BLOCK_LENGTH / ROCK_SPEEDS[0]);
                let history = medium.domain.interlayer_history();
                for (_, record) in medium.problem.interlayer_records(&history) {
                    shear = shear.max(record.shear_stress.abs());
                    normal = normal.max(record.normal_stress.abs());
                }
                for traction in medium.side_tractions() {
                    middle = middle.max(traction.abs());
                }
            }
            [shear, normal, middle].map(|traction| traction / traction_scale())
        });
        let orders = [0, 1, 2].map(|i| (errors[1][i] / errors[2][i]).log2());
        println!("δ {thickness}: {errors:?}, orders {orders:?}");
        assert!(orders[0] > 0.9 && orders[1] > 1.8 && orders[2] > 1.7, "{errors:?}");
        assert!(errors[2][0] < 0.04, "{errors:?}");
    }
}
