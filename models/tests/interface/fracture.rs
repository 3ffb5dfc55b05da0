//! Cracked and breaking layers: fracture, contact, and a stack of blocks under a pulse in closed form.

use crate::interface::support::{
    ELASTIC, History, IMPEDANCES, MASS_DISTRIBUTIONS, RandomLoad, initial_history,
    plastic_constants, step_interval,
};
use wellposed_models::interface::elastic::ElasticMaterial;
use wellposed_models::interface::layer::{LayerLaw, MAX_HISTORY_VARIABLES};
use wellposed_models::interface::parameters::LayerMaterial;
use wellposed_models::interface::{FaceLaw, RiemannData, history};

/// A breaking layer that never reaches its tensile strength is bitwise equal to the elastic-plastic layer.
#[test]
fn breaking_layer_below_its_tensile_strength_is_elastic_plastic() {
    for distribution in MASS_DISTRIBUTIONS {
        for plastic in [plastic_constants(0.4, 0.0, 0.0), plastic_constants(0.4, 0.3, 0.01)] {
            let breaking = LayerMaterial::Breaking(ELASTIC, plastic, 1e30).to_law(distribution);
            let without = LayerMaterial::Breaking(ELASTIC, plastic, 0.1).without_fracture();
            let without = without.to_law(distribution);
            let mut load = RandomLoad::new(21);
            let mut histories = [[0.0; MAX_HISTORY_VARIABLES]; 2];
            for number in 0..20_000 {
                let incoming = load.next();
                let time = step_interval(number, 0.21);
                let one = breaking.advance(&incoming, &time, &mut histories[0]);
                let other = without.advance(&incoming, &time, &mut histories[1]);
                assert_eq!(one, other);
            }
            assert_eq!(histories[0], histories[1]);
            assert!(without.to_face_record(&histories[1]).slip > 1.0);
        }
    }
}

/// Load of a normal traction `stress`, without shear.
fn normal_load(stress: f64) -> [RiemannData<f64>; 2] {
    [
        RiemannData { impedance: IMPEDANCES[0], invariant: [-stress, stress] },
        RiemannData { impedance: IMPEDANCES[1], invariant: [0.02, 0.0] },
    ]
}

/// Under slowly growing tension the layer breaks at the tensile strength σ_t and loses the energy ½C_nσ_t². Then it
/// opens and carries no tension; after it has closed it carries compression.
#[test]
fn layer_breaks_at_its_tensile_strength_for_good() {
    let strength = 0.7;
    for distribution in MASS_DISTRIBUTIONS {
        // For σ_t = τ_s/k_s the tractions are at the apex of the yield cone before fracture.
        for plastic in [plastic_constants(1.0, 0.5, 0.0), plastic_constants(0.35, 0.5, 0.0)] {
            let law = LayerMaterial::Breaking(ELASTIC, plastic, strength).to_law(distribution);
            let mut history = initial_history(&law, [[0.0; 2]; 2]);
            let step = 0.01;
            let mut number = 0;
            while law.to_face_record(&history).fracture_time == 0.0 {
                let stress = 0.001 * number as f64;
                assert!(stress < 0.75, "no fracture");
                law.advance(&normal_load(stress), &step_interval(number, step), &mut history);
                number += 1;
            }
            let record = law.to_face_record(&history);
            let energy = law.energy(&history).fracture_energy;
            let expected = 0.5 * ELASTIC.normal_compliance() * strength * strength;
            println!("broken at step {number}: lost {energy}, expected {expected}");
            assert!((energy / expected - 1.0).abs() < 0.01);
            assert_eq!(record.fracture_time, number as f64 * step);
            assert!(record.normal_stress <= 0.0 && record.opening > 0.0);
            for _ in 0..100 {
                law.advance(&normal_load(0.1), &step_interval(number, step), &mut history);
                number += 1;
            }
            let open = law.to_face_record(&history);
            assert!(open.normal_stress == 0.0 && open.shear_stress == 0.0);
            assert!(open.opening > record.opening);
            for _ in 0..2000 {
                law.advance(&normal_load(-0.3), &step_interval(number, step), &mut history);
                number += 1;
            }
            let closed = law.to_face_record(&history);
            println!("{closed:?}");
            assert!((closed.normal_stress + 0.3).abs() < 1e-9 && closed.opening == 0.0);
            assert_eq!(closed.fracture_time, record.fracture_time);
            assert_eq!(law.energy(&history).fracture_energy, energy);
        }
    }
}

/// Without shear a crack that opens and closes is conservative: no energy is released or dissipated.
#[test]
fn cracks_open_and_close_without_loss() {
    for distribution in MASS_DISTRIBUTIONS {
        let law = LayerMaterial::Cracked(ELASTIC, None).to_law(distribution);
        let mut load = RandomLoad::new(22);
        let mut history = initial_history(&law, [[0.0; 2]; 2]);
        let (mut worst, mut switches) = (0.0f64, 0);
        for number in 0..20_000 {
            let mut incoming = load.next();
            incoming[1].invariant = [0.0; 2];
            let before = law.energy(&history);
            let was_open = history[history::NORMAL_STATE] > 0.0;
            let states = law.advance(&incoming, &step_interval(number, 0.21), &mut history);
            let after = law.energy(&history);
            let (work, size) = crate::interface::support::face_work(&states, &incoming, 0.21);
            let gain = after.kinetic + after.stored - before.kinetic - before.stored;
            worst = worst.max((gain - work).abs() / (size + before.total() + after.total()));
            switches += usize::from(was_open != (history[history::NORMAL_STATE] > 0.0));
        }
        println!("{distribution:?}: {worst:e}, {switches} switches");
        assert!(worst < 1e-14 && switches > 100);
        assert_eq!(law.energy(&history).released_energy, 0.0);
    }
}

/// Faces that touch without normal traction carry no shear; under compression they carry it.
#[test]
fn contact_without_compression_carries_no_shear() {
    let law = LayerMaterial::Cracked(ELASTIC, None).to_law(Default::default());
    for (stress, carried) in [(0.0, 0.0), (-1e-6, 0.1)] {
        let mut history = [0.0; MAX_HISTORY_VARIABLES];
        for number in 0..4000 {
            let mut incoming = normal_load(stress);
            incoming[1].invariant = [-0.1, 0.1];
            law.advance(&incoming, &step_interval(number, 0.05), &mut history);
        }
        assert!((law.to_face_record(&history).shear_stress - carried).abs() < 1e-12);
    }
}

/// Number of cells of a block.
const CELLS_PER_BLOCK: usize = 100;
/// Number of blocks of the stack.
const BLOCK_COUNT: usize = 8;
/// Impedance z of the blocks.
const IMPEDANCE: f64 = 1.5;

/// Stack of blocks of [`CELLS_PER_BLOCK`] cells at Courant number 1 with Δt = 1, cracked layers between blocks, a
/// pressure pulse at the lower end and a free upper end.
struct BlockStack {
    /// Riemann invariants of the cells, Pa: zv − σ (towards the upper end) and zv + σ (towards the lower end), with the
    /// impedance z, the velocity v and the normal stress σ.
    cells: Vec<[f64; 2]>,
    law: LayerLaw<f64>,
    joints: Vec<History>,
    step_count: usize,
}

impl BlockStack {
    fn new() -> Self {
        // Thin layers with the impedance of the blocks: mass m = zΔt, compliance C = Δt/z.
        let thickness = 1e-3;
        let speed = thickness;
        let material = ElasticMaterial {
            thickness,
            density: IMPEDANCE / thickness,
            longitudinal_speed: speed,
            shear_speed: speed,
        };
        Self {
            cells: vec![[0.0; 2]; CELLS_PER_BLOCK * BLOCK_COUNT],
            law: LayerMaterial::Cracked(material, None).to_law(Default::default()),
            joints: vec![[0.0; MAX_HISTORY_VARIABLES]; BLOCK_COUNT - 1],
            step_count: 0,
        }
    }

    /// Advances the stack by a step with the pressure p on its lower end.
    fn advance(&mut self, pressure: f64) {
        let count = self.cells.len();
        let mut new = self.cells.clone();
        for face in 0..=count {
            if face == 0 {
                new[0][0] = self.cells[0][1] + 2.0 * pressure;
            } else if face == count {
                new[count - 1][1] = self.cells[count - 1][0];
            } else if face % CELLS_PER_BLOCK == 0 {
                let invariant = [self.cells[face - 1][0], self.cells[face][1]];
                let data = RiemannData { impedance: [IMPEDANCE; 2], invariant };
                let rest = RiemannData { invariant: [0.0; 2], ..data };
                let joint = &mut self.joints[face / CELLS_PER_BLOCK - 1];
                let time = step_interval(self.step_count, 1.0);
                let [[lower, upper], _] = self.law.advance(&[data, rest], &time, joint);
                new[face - 1][1] = IMPEDANCE * lower.velocity + lower.stress;
                new[face][0] = IMPEDANCE * upper.velocity - upper.stress;
            } else {
                new[face - 1][1] = self.cells[face][1];
                new[face][0] = self.cells[face - 1][0];
            }
        }
        self.cells = new;
        self.step_count += 1;
    }

    fn energy(&self) -> f64 {
        let waves = self.cells.iter().flatten().map(|r| r * r / (4.0 * IMPEDANCE)).sum::<f64>();
        waves + self.joints.iter().map(|joint| self.law.energy(joint).total()).sum::<f64>()
    }

    /// Opening of the joint with the index `index`, counted from 1 at the free end.
    fn opening(&self, index: usize) -> f64 {
        self.law.to_face_record(&self.joints[BLOCK_COUNT - 1 - index]).opening
    }

    fn velocity(&self, cell: usize) -> f64 {
        (self.cells[cell][0] + self.cells[cell][1]) / (2.0 * IMPEDANCE)
    }

    /// Runs a pulse of `length` steps with the velocity v₀ = 1 until `time` steps after its arrival at the free end.
    /// Returns for joints 1, 2, … the time after the arrival at which the opening exceeds ½v₀Δt.
    fn run_pulse(&mut self, length: usize, time: usize) -> Vec<Option<usize>> {
        // Each layer delays the pulse by one step.
        let arrival = CELLS_PER_BLOCK * BLOCK_COUNT + BLOCK_COUNT - 1;
        let mut opened = vec![None; BLOCK_COUNT];
        let mut energy = 0.0;
        while self.step_count < arrival + time {
            let loaded = self.step_count < length;
            self.advance(if loaded { IMPEDANCE } else { 0.0 });
            if self.step_count == length {
                energy = self.energy();
            }
            if self.step_count > length {
                assert!((self.energy() / energy - 1.0).abs() < 1e-12);
            }
            for (joint, time) in opened.iter_mut().enumerate().skip(1) {
                if self.step_count > arrival && time.is_none() && self.opening(joint) > 2.0 {
                    *time = Some(self.step_count - arrival);
                }
            }
        }
        opened
    }
}

/// A pulse of length ℓ = 2jh, with the block length h, detaches a slab of j blocks at t = jh/c, which moves with the
/// velocity 2v₀ without stress.
#[test]
fn pulse_of_even_length_detaches_a_slab() {
    for blocks in [1, 2, 3] {
        let mut stack = BlockStack::new();
        let time = blocks * CELLS_PER_BLOCK + 300;
        let opened = stack.run_pulse(2 * blocks * CELLS_PER_BLOCK, time);
        let gap = stack.opening(blocks) / 600.0;
        let velocities: Vec<f64> = (1..=blocks * CELLS_PER_BLOCK)
            .map(|i| stack.velocity(CELLS_PER_BLOCK * BLOCK_COUNT - i))
            .collect();
        let mean = velocities.iter().sum::<f64>() / velocities.len() as f64;
        println!("j = {blocks}: opened {opened:?}, gap {gap} of 2v0t, mean velocity {mean}");
        // Every layer in the slab delays the opening by about three of the 300 steps.
        assert!((gap - 1.0).abs() < 0.01 * blocks as f64);
        assert!((mean - 2.0).abs() < 0.02);
        // Joints in the slab are free of stress; they open only by the delay in the layers.
        assert!((1..BLOCK_COUNT).all(|joint| joint == blocks || stack.opening(joint) < 12.0));
        assert!(opened[blocks].expect("open").abs_diff(blocks * CELLS_PER_BLOCK) < 6);
    }
}

/// A pulse of length ℓ < 2h and duration t₀ detaches the last block, which moves with the mean velocity v₀ℓ/h: the gap
/// grows by 2v₀t₀ in every period 2h/c.
#[test]
fn short_pulse_detaches_the_last_block() {
    let mut stack = BlockStack::new();
    let length = CELLS_PER_BLOCK * 6 / 5;
    stack.run_pulse(length, CELLS_PER_BLOCK);
    let mut last = stack.opening(1);
    for _ in 0..3 {
        for _ in 0..2 * CELLS_PER_BLOCK {
            stack.advance(0.0);
        }
        let gap = stack.opening(1);
        println!("gap grows by {} of {}", gap - last, 2 * length);
        assert!(((gap - last) / (2.0 * length as f64) - 1.0).abs() < 0.02);
        last = gap;
    }
    let end = CELLS_PER_BLOCK * BLOCK_COUNT;
    let mean = (end - CELLS_PER_BLOCK..end).map(|cell| stack.velocity(cell)).sum::<f64>()
        / CELLS_PER_BLOCK as f64;
    println!("mean velocity {mean}");
    assert!((mean / (length as f64 / CELLS_PER_BLOCK as f64) - 1.0).abs() < 0.02);
}

/// For a pulse of length ℓ > 2h that is no multiple of 2h the tension reaches joint j at max(jh, ℓ − jh)/c: the joint
/// nearest to ½ℓ from the free end opens first, its neighbour later.
#[test]
fn long_pulse_opens_two_joints() {
    let mut stack = BlockStack::new();
    let opened = stack.run_pulse(CELLS_PER_BLOCK * 13 / 5, 4 * CELLS_PER_BLOCK);
    println!("{opened:?}");
    let first = opened[1].expect("open");
    assert!(first.abs_diff(CELLS_PER_BLOCK * 8 / 5) < 6);
    assert!(opened[2].expect("open") > first);
}
