//! Flow of the fluid along saturated layers: junctions, energy balance, stiffness across and wave speeds along a layer.

use crate::interface::support::{History, SATURATED, step_interval};
use testkit::random::RandomNumbers;
use wellposed_models::interface::fluid::{
    ArmSide, FluidConstants, FluidState, JunctionArm, solve_closed_end, solve_junction,
    solve_open_end, solve_riemann,
};
use wellposed_models::interface::layer::{LayerLaw, MAX_HISTORY_VARIABLES};
use wellposed_models::interface::parameters::{LayerMaterial, PorousConstants, SaturatedMaterial};
use wellposed_models::interface::saturated::SaturatedLayer;
use wellposed_models::interface::{FaceLaw, RiemannData, history};

/// Law of a saturated layer with the given constants.
fn saturated_layer(material: SaturatedMaterial) -> SaturatedLayer<f64> {
    match LayerMaterial::Saturated(material).to_law(Default::default()) {
        LayerLaw::Saturated(law) => law,
        other => panic!("{other:?}"),
    }
}

/// Sides of the arms of a junction: the layers normal to x₂ to the left and right, those normal to x₁ below and above.
const ARM_SIDES: [ArmSide; 4] = [ArmSide::Lower, ArmSide::Upper, ArmSide::Lower, ArmSide::Upper];

/// Checks a junction of random arms, and updates the largest relative error of the balances of mass and power.
fn check_junction<const A: usize>(random: &mut RandomNumbers, max_error: &mut f64) {
    let arms: [JunctionArm<f64>; A] = std::array::from_fn(|index| JunctionArm {
        side: ARM_SIDES[index],
        porosity: if random.bernoulli(0.3) { 0.0 } else { random.uniform(0.01, 0.4) },
        thickness: random.log_uniform(0.1, 10.0),
        impedance: random.log_uniform(0.1, 10.0),
        state: FluidState {
            velocity: random.uniform(-1.0, 1.0),
            stress: random.uniform(-1.0, 1.0),
        },
    });
    let (states, pressure) = solve_junction(&arms);
    let (mut mass, mut power, mut size) = (0.0, 0.0, 1e-300);
    for (arm, state) in arms.iter().zip(&states) {
        let sign = if arm.side == ArmSide::Lower { 1.0 } else { -1.0 };
        let flow = sign * arm.thickness * arm.porosity * state.velocity;
        mass += flow;
        power += sign * arm.thickness * state.power();
        let sent = arm.state.invariant(arm.side, arm.impedance);
        size += arm.thickness * arm.porosity * (sent / arm.impedance).abs();
        assert!((state.stress + pressure * arm.porosity).abs() < 1e-15);
        // The invariant that arrives at the junction from the arm is unchanged.
        let sent = arm.state.invariant(arm.side, arm.impedance);
        assert!(
            (state.invariant(arm.side, arm.impedance) - sent).abs() < 1e-14 * (1.0 + sent.abs())
        );
        if arm.porosity == 0.0 {
            assert_eq!(state.power(), 0.0);
        }
    }
    *max_error =
        max_error.max(mass.abs() / size).max(power.abs() / (size * (pressure.abs() + 1e-300)));
    if arms.iter().all(|arm| arm.porosity == 0.0) {
        assert_eq!(pressure, 0.0);
    }
}

#[test]
fn junctions_balance_mass_and_power() {
    let mut random = RandomNumbers::new(11);
    let mut max_error = 0.0;
    for _ in 0..3000 {
        check_junction::<2>(&mut random, &mut max_error);
        check_junction::<3>(&mut random, &mut max_error);
        check_junction::<4>(&mut random, &mut max_error);
    }
    println!("{max_error:e}");
    assert!(max_error < 1e-14);
}

/// The states at a junction of two arms of the same layer are the solution of the Riemann problem.
#[test]
fn junction_of_two_equal_arms_is_the_riemann_problem() {
    let mut random = RandomNumbers::new(12);
    for _ in 0..1000 {
        let mut draw = || random.uniform(-1.0, 1.0);
        let cells: [FluidState<f64>; 2] =
            std::array::from_fn(|_| FluidState { velocity: draw(), stress: draw() });
        let arm = |index: usize| JunctionArm {
            side: ARM_SIDES[index],
            porosity: 0.2,
            thickness: 0.3,
            impedance: 1.7,
            state: cells[index],
        };
        let expected = solve_riemann(cells, [1.7; 2]);
        for state in solve_junction(&[arm(0), arm(1)]).0 {
            assert!((state.velocity - expected.velocity).abs() < 1e-15);
            assert!((state.stress - expected.stress).abs() < 1e-15);
        }
    }
}

/// Number of cells of each layer.
const CELL_COUNT: usize = 16;

/// Advances the fluid in a row of cells with the given states at both ends.
fn advance_row(
    fluid: &FluidConstants<f64>,
    row: &mut [History],
    [first, last]: [FluidState<f64>; 2],
    ratio: f64,
) {
    let states: Vec<FluidState<f64>> = row.iter().map(|cell| fluid.state(cell)).collect();
    let z = fluid.impedance;
    let mut faces = vec![first];
    faces.extend(states.windows(2).map(|pair| solve_riemann([pair[0], pair[1]], [z; 2])));
    faces.push(last);
    for (cell, face) in row.iter_mut().zip(faces.windows(2)) {
        fluid.advance_cell([face[0], face[1]], ratio, cell);
    }
}

/// Four layers that meet at a junction, two with closed and two with open ends, under random loads across them: each
/// stage balances energy, and the energy dissipated by the flow along the layers never decreases.
#[test]
fn layers_that_meet_at_a_junction_balance_energy() {
    let thicknesses = [0.3, 0.5, 0.2, 0.4];
    let laws =
        thicknesses.map(|thickness| saturated_layer(SaturatedMaterial { thickness, ..SATURATED }));
    let mut random = RandomNumbers::new(13);
    let mut rows = [[[0.0; MAX_HISTORY_VARIABLES]; CELL_COUNT]; 4];
    for (law, row) in laws.iter().zip(&mut rows) {
        for cell in row.iter_mut() {
            let mut draw = || random.uniform(-0.4, 0.4);
            let velocities = std::array::from_fn(|_| std::array::from_fn(|_| draw()));
            law.initialise(&velocities, cell);
            cell[history::NORMAL_STATE] = draw();
            cell[history::FLUID_STRAIN] = draw();
            cell[history::FLUID_VELOCITY] = draw();
        }
    }
    let energy = |rows: &[[History; CELL_COUNT]; 4]| {
        let cells = laws.iter().zip(rows).flat_map(|(law, row)| row.iter().map(move |c| (law, c)));
        cells.fold([0.0; 2], |[total, lost], (law, cell)| {
            let energy = law.energy(cell);
            [total + energy.total(), lost + energy.fluid_dissipation]
        })
    };
    let (mut max_error, mut number, mut closed) = (0.0f64, 0, 0);
    for step in [0.03, 0.1, 0.25] {
        let ratio = step / 0.5;
        assert!(laws[0].fluid.speed * ratio <= 1.0);
        for _ in 0..400 {
            // Stages across the layers, with incoming waves.
            let (before, mut supplied) = (energy(&rows), 0.0);
            for (law, row) in laws.iter().zip(&mut rows) {
                for cell in row.iter_mut() {
                    let incoming = std::array::from_fn(|component| RiemannData {
                        impedance: [1.3, 0.6],
                        invariant: std::array::from_fn(|side| {
                            let mean = [[0.3, -0.3], [0.0; 2]][component][side];
                            mean + random.uniform(-1.0, 1.0)
                        }),
                    });
                    let states = law.advance(&incoming, &step_interval(number, step), cell);
                    supplied += crate::interface::support::face_work(&states, &incoming, step).0;
                }
            }
            let middle = energy(&rows);
            max_error = max_error.max((middle[0] - before[0] - supplied).abs() / middle[0]);
            // Stage along the layers.
            let arms: [JunctionArm<f64>; 4] = std::array::from_fn(|arm| {
                let nearest = if ARM_SIDES[arm] == ArmSide::Lower { CELL_COUNT - 1 } else { 0 };
                let cell = &rows[arm][nearest];
                JunctionArm {
                    side: ARM_SIDES[arm],
                    porosity: laws[arm].porosity(cell),
                    thickness: thicknesses[arm],
                    impedance: laws[arm].fluid.impedance,
                    state: laws[arm].fluid.state(cell),
                }
            });
            closed += arms.iter().filter(|arm| arm.porosity == 0.0).count();
            let (states, _) = solve_junction(&arms);
            for arm in 0..4 {
                let fluid = &laws[arm].fluid;
                let z = fluid.impedance;
                let is_lower = ARM_SIDES[arm] == ArmSide::Lower;
                let far = fluid.state(&rows[arm][if is_lower { 0 } else { CELL_COUNT - 1 }]);
                let far_side = if is_lower { ArmSide::Upper } else { ArmSide::Lower };
                let end = match arm < 2 {
                    true => solve_closed_end(far, far_side, z),
                    false => solve_open_end(far, far_side, z),
                };
                let ends = if is_lower { [end, states[arm]] } else { [states[arm], end] };
                advance_row(fluid, &mut rows[arm], ends, ratio);
            }
            let after = energy(&rows);
            max_error = max_error.max((after[0] - middle[0]).abs() / after[0]);
            assert!(after[1] >= middle[1]);
            number += 1;
        }
    }
    println!("{max_error:e}, {closed} closed arms");
    assert!(max_error < 1e-14, "{max_error:e}");
    assert!(closed > 100);
}

/// The stiffness across a layer is b₀ at fixed fluid content and b₀ − b_s²/b_f after the fluid has drained, when the
/// pressure is zero.
#[test]
fn stiffness_is_undrained_at_once_and_drained_at_last() {
    let law = saturated_layer(SATURATED);
    let SaturatedMaterial {
        undrained_stiffness: b0,
        coupling_stiffness: bs,
        fluid_stiffness: bf,
        ..
    } = SATURATED;
    let mut cell = [0.0; MAX_HISTORY_VARIABLES];
    let stress = -0.02;
    let load = RiemannData { impedance: [1.3, 0.6], invariant: [-stress, stress] };
    let rest = RiemannData { impedance: [1.3, 0.6], invariant: [0.0; 2] };
    for number in 0..4000 {
        law.advance(&[load, rest], &step_interval(number, 0.02), &mut cell);
    }
    let undrained = stress / cell[history::NORMAL_STATE];
    let pressure = law.pressure(&cell);
    let z = law.fluid.impedance;
    for number in 0..20_000 {
        law.advance(&[load, rest], &step_interval(number, 0.02), &mut cell);
        let state = law.fluid.state(&cell);
        let ends =
            [solve_open_end(state, ArmSide::Upper, z), solve_open_end(state, ArmSide::Lower, z)];
        law.fluid.advance_cell(ends, 0.05, &mut cell);
    }
    let drained = stress / cell[history::NORMAL_STATE];
    println!("{undrained} ({b0}), {drained} ({}), p {pressure}", b0 - bs * bs / bf);
    assert!((undrained - b0).abs() < 1e-10);
    assert!((drained - (b0 - bs * bs / bf)).abs() < 1e-10);
    assert!(pressure > 0.0 && law.pressure(&cell).abs() < 1e-10);
}

/// Measures the wave speed along a layer by the frequency of a standing wave in a periodic row of one wavelength.
fn measure_speed(
    material: SaturatedMaterial,
    impedances: [f64; 2],
    strain: f64,
    cells: usize,
) -> f64 {
    let law = saturated_layer(material);
    let fluid = &law.fluid;
    let wave_number = 2.0 * std::f64::consts::PI;
    let dx = 1.0 / cells as f64;
    let step = dx / fluid.speed;
    let cosines: Vec<f64> =
        (0..cells).map(|i| (wave_number * (i as f64 + 0.5) * dx).cos()).collect();
    let mut row = vec![[0.0; MAX_HISTORY_VARIABLES]; cells];
    for (cell, cosine) in row.iter_mut().zip(&cosines) {
        cell[history::NORMAL_STATE] = strain;
        // The fluid strain at which the fluid traction is zero at the initial strain ε.
        cell[history::FLUID_STRAIN] = -fluid.coupling_stiffness * strain / fluid.stiffness;
        cell[history::FLUID_VELOCITY] = 1e-3 * cosine;
    }
    let stress = law.normal_stress(&row[0]);
    let incoming = [
        RiemannData { impedance: [impedances[0]; 2], invariant: [-stress, stress] },
        RiemannData { impedance: [impedances[1]; 2], invariant: [0.0; 2] },
    ];
    let amplitude = |row: &[History]| -> f64 {
        row.iter().zip(&cosines).map(|(cell, cosine)| cell[history::FLUID_VELOCITY] * cosine).sum()
    };
    let (mut crossings, mut last) = (vec![], amplitude(&row));
    for number in 0.. {
        for cell in &mut row {
            law.advance(&incoming, &step_interval(number, 0.5 * step), cell);
        }
        let states: Vec<FluidState<f64>> = row.iter().map(|cell| fluid.state(cell)).collect();
        for (i, cell) in row.iter_mut().enumerate() {
            let [before, after] = [(i + cells - 1) % cells, (i + 1) % cells];
            let z = [fluid.impedance; 2];
            let faces = [
                solve_riemann([states[before], states[i]], z),
                solve_riemann([states[i], states[after]], z),
            ];
            fluid.advance_cell(faces, step / dx, cell);
        }
        for cell in &mut row {
            law.advance(&incoming, &step_interval(number, 0.5 * step), cell);
        }
        let new = amplitude(&row);
        if new * last < 0.0 {
            crossings.push((number as f64 + last / (last - new)) * step);
            if crossings.len() == 3 {
                break;
            }
        }
        last = new;
    }
    2.0 * std::f64::consts::PI / (crossings[2] - crossings[0]) / wave_number
}

/// The wave speed along a layer is √(B/ρ*) with the density ρ* = ρ_f + ρ_a (skeleton held) or ρ̂ (skeleton free) and
/// the modulus B = b_f (faces held), b_f − b_s²/b₀ (constant S₂₂) or b_f − b_s²/(b₀ + b₁) (constant S₂₂, pores
/// collapsed).
#[test]
fn speeds_along_a_layer_have_the_closed_forms() {
    let material = SaturatedMaterial {
        pores: PorousConstants { collapse_stiffness: 1.0, porosity: 0.0 },
        ..SATURATED
    };
    let SaturatedMaterial {
        undrained_stiffness: b0,
        coupling_stiffness: bs,
        fluid_stiffness: bf,
        skeleton_density: skeleton,
        fluid_density: fluid,
        added_density: added,
        thickness,
        ..
    } = material;
    let free = fluid + skeleton * added / (skeleton + added);
    let cells = 400;
    let step = 1.0 / cells as f64 / (bf / free).sqrt();
    // Impedances for relaxation of S₂₂ and of V₁ within about a time step.
    let soft_normal = step * (b0 / thickness) * 2.0;
    let held_shear = skeleton * thickness / step;
    for (density, shear) in [(fluid + added, held_shear), (free, 1e-9)] {
        for (stiffness, normal, strain) in [
            (bf, 1e9, 0.1),
            (bf - bs * bs / b0, soft_normal, 0.1),
            (bf - bs * bs / (b0 + 1.0), soft_normal, -0.1),
        ] {
            let expected = (stiffness / density).sqrt();
            let found = measure_speed(material, [normal, shear], strain, cells);
            let error = found / expected - 1.0;
            println!("{found} expected {expected}, relative error {error:e}");
            assert!(error.abs() < 1e-3);
        }
    }
}
