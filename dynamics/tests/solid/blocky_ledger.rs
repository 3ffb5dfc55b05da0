//! Energy ledger of blocky media with layers of all kinds at single faces, under loads that keep them slipping, opening
//! and closing; admissible tractions of layers that slip.

use crate::support::interlayers::layers_of_all_kinds;
use crate::support::media::classical;
use crate::support::noise;
use crate::support::random::NoiseSequence;
use models::interface::layer::{FaceRecord, LayerLaw};
use models::interface::plastic::YieldCone;
use models::interface::porous::TangentialComponent;
use models::solid::parameters::{Isotropic, Microrotation};
use std::f64::consts::PI;
use std::sync::Arc;
use wellposed_dynamics::boundary::{Boundary, Condition, Load};
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::ledger::{Energy, InterlayerLosses, Ledger};
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;
use wellposed_dynamics::solid::interlayers::{
    InterlayerFace, InterlayerLaw, InterlayerPlane, Interlayers, PlaneLaws,
};

const CELLS: [usize; 2] = [12, 11];
/// Cells above the planes of interlayers normal to each axis; the second axis is periodic.
const PLANES: [&[usize]; 2] = [&[4, 8], &[0, 4, 7]];
/// Edge length of a cell, m.
const SPACING: f64 = 0.125;
const STEPS: usize = 10_000;

/// Returns interlayers normal to an axis, with a random law of `laws`, or rarely none, at each face.
fn random_faces(
    random: &mut NoiseSequence,
    axis: usize,
    laws: &[LayerLaw<f64>],
    has_open_ends: bool,
) -> Interlayers {
    let mut plane = |cell: &usize| {
        let law = |_| {
            let law = random.uniform_index(laws.len() + 1);
            (law < laws.len()).then_some(law as u16)
        };
        let faces = (0..CELLS[1 - axis]).map(law).collect();
        InterlayerPlane { cell: *cell, laws: PlaneLaws::ByFace(faces) }
    };
    Interlayers {
        axis,
        planes: PLANES[axis].iter().map(&mut plane).collect(),
        laws: laws.iter().map(|law| InterlayerLaw::Plane(*law, axis)).collect(),
        has_open_ends,
    }
}

/// Returns a medium of random blocks of two materials with a random law of `laws` at each face, tractions that vary in
/// time on one side and a fixed opposite side; `courant`: Courant number of the fastest waves in a sweep.
fn loaded_medium(
    seed: u64,
    laws: &[LayerLaw<f64>],
    media: Vec<Medium>,
    courant: f64,
) -> Problem<2> {
    let mut random = NoiseSequence::new(seed << 40);
    let grid = Grid { cells: CELLS, spacing: [SPACING; 2] };
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let step = 2.0 * courant * SPACING / speed;
    let block = |coordinate: usize, axis: usize| {
        PLANES[axis].iter().filter(|plane| coordinate >= **plane).count() as u64
    };
    let cell_media = (0..grid.count())
        .map(|cell| {
            let [x, y] = [cell % CELLS[0], cell / CELLS[0]];
            u16::from(noise(seed + 10 * block(x, 0) + block(y, 1) % 3) > 0.0)
        })
        .collect();
    let boundaries = [
        [Boundary::ByPair(vec![Condition::Traction(0.0); 2]), Boundary::Fixed],
        [Boundary::Periodic, Boundary::Periodic],
    ];
    let interlayers =
        [0, 1].map(|axis| random_faces(&mut random, axis, laws, seed.is_multiple_of(2)));
    let load = |pair: usize, frequency: f64| Load {
        axis: 0,
        end: 0,
        pair,
        faces: (0..CELLS[1]).map(|face| (face, 0.5 + 0.4 * noise(seed + face as u64))).collect(),
        signal: Arc::new(move |time: f64| {
            (frequency * time).sin() + (2.3 * frequency * time).cos()
        }),
    };
    let loads = vec![load(0, 1.3), load(1, 1.9)];
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
    Problem { interlayers: interlayers.to_vec(), loads, ..problem }
}

/// Returns the law of a face.
fn law_of<'a>(laws: &'a [LayerLaw<f64>], face: &InterlayerFace) -> &'a LayerLaw<f64> {
    &laws[face.law]
}

/// Name of the kind of a law whose behaviour switches; `None` for linear laws.
fn switching_kind(law: &LayerLaw<f64>) -> Option<&'static str> {
    match law {
        LayerLaw::Elastic(_) | LayerLaw::Viscous(_) => None,
        LayerLaw::Plastic(_) => Some("plastic"),
        LayerLaw::Porous(_) => Some("porous"),
        LayerLaw::Saturated(_) => Some("saturated"),
        LayerLaw::Cracked(_) => Some("cracked"),
        LayerLaw::Breaking(_) => Some("breaking"),
    }
}

/// Branch of the law of a face: whether it slipped in the last step, whether pores or the crack are open, and whether
/// it is broken.
fn branch(record: &FaceRecord<f64>, old_slip: f64) -> [bool; 3] {
    let is_open = record.opening > 0.0 || record.porosity > 0.0;
    [record.slip > old_slip, is_open, record.fracture_time > 0.0]
}

/// Computes how far the tractions of a face are beyond the admissible set of its law, in units of the rounding of the
/// terms of the condition: |S_t| ≤ τ_s + Hχ − k_s S_n, or |S_t| ≤ −k_s min(S_n, 0) for cracks.
fn excess(law: &LayerLaw<f64>, record: &FaceRecord<f64>) -> Option<f64> {
    let [normal, shear] = [record.normal_stress, record.shear_stress];
    let of_cone = |cone: &YieldCone<f64>| {
        let strength = cone.strength_at(record.slip);
        let terms = [shear.abs(), cone.friction * normal, -strength];
        (terms.iter().sum::<f64>(), terms.iter().map(|term| term.abs()).sum::<f64>())
    };
    let of_contact = |friction: f64| {
        let limit = -friction * normal.min(0.0);
        (shear.abs() - limit, shear.abs() + limit)
    };
    let (beyond, size) = match law {
        LayerLaw::Plastic(law) => of_cone(&law.cone),
        LayerLaw::Porous(law) => match &law.shear {
            TangentialComponent::Plastic(_, cone) => of_cone(cone),
            _ => return None,
        },
        LayerLaw::Breaking(law) if record.fracture_time == 0.0 => of_cone(&law.cone),
        LayerLaw::Breaking(law) => of_contact(law.cone.friction),
        LayerLaw::Cracked(law) => of_contact(law.friction?),
        _ => return None,
    };
    Some(if beyond > 0.0 { beyond / (f64::EPSILON * size) } else { 0.0 })
}

/// Watches faces: counts switches by kind and the largest excess of tractions.
struct FaceWatch<'a> {
    problem: &'a Problem<2>,
    laws: &'a [LayerLaw<f64>],
    /// By face: slip and branch after the last step.
    last: Vec<(f64, [bool; 3])>,
    switches: std::collections::BTreeMap<&'static str, usize>,
    excess: f64,
}

impl<'a> FaceWatch<'a> {
    fn new(problem: &'a Problem<2>, laws: &'a [LayerLaw<f64>], history: &[f64]) -> Self {
        let records = problem.interlayer_records(history);
        let last = records.iter().map(|own| (0.0, branch(&own.1, 0.0))).collect();
        Self { problem, laws, last, switches: Default::default(), excess: 0.0 }
    }

    fn watch(&mut self, history: &[f64]) {
        let records = self.problem.interlayer_records(history);
        for ((face, record), last) in records.iter().zip(&mut self.last) {
            let law = law_of(self.laws, face);
            assert!(record.slip >= last.0, "{law:?}: slip {} after {}", record.slip, last.0);
            let now = (record.slip, branch(record, last.0));
            if let Some(kind) = switching_kind(law) {
                let changes = now.1.iter().zip(&last.1).filter(|(a, b)| a != b).count();
                *self.switches.entry(kind).or_default() += changes;
            }
            *last = now;
            self.excess = self.excess.max(excess(law, record).unwrap_or(0.0));
        }
    }
}

fn losses(ledger: &Ledger) -> [f64; 5] {
    let InterlayerLosses { plastic, viscous, released, fracture, fluid } = ledger.interlayer_losses;
    [plastic, viscous, released, fracture, fluid]
}

/// Checks energy and ledger after each step.
struct LedgerWatch {
    start: f64,
    max_energy: f64,
    residual: f64,
    losses: [f64; 5],
    numerical: f64,
}

impl LedgerWatch {
    fn new(energy: &Energy) -> Self {
        let start = energy.total();
        Self { start, max_energy: start, residual: 0.0, losses: [0.0; 5], numerical: 0.0 }
    }

    fn watch(&mut self, energy: &Energy, ledger: &Ledger) {
        let now = energy.total();
        self.max_energy = self.max_energy.max(now);
        self.residual = self.residual.max((now - self.start - ledger.energy_change()).abs());
        let losses = losses(ledger);
        for (loss, old) in losses.iter().zip(self.losses) {
            // Sums over faces are rounded once.
            assert!(*loss >= old * (1.0 - f64::EPSILON), "{loss:e} after {old:e}");
        }
        self.losses = losses;
        // At Courant number 1 the numerical dissipation is rounding of the energy.
        let numerical = ledger.numerical_dissipation;
        let rounding = 1e-15 * self.max_energy;
        assert!(numerical >= self.numerical - rounding, "{numerical:e} after {}", self.numerical);
        self.numerical = numerical;
    }

    fn check(&self, name: &str) {
        let relative = self.residual / self.max_energy;
        println!(
            "{name}: residual {relative:e}, losses {:.2?}, numerical {:.2e}, start {:.2}, max {:.2}",
            self.losses, self.numerical, self.start, self.max_energy
        );
        assert!(relative <= 1e-12, "{name}: {relative:e}");
    }
}

/// Verifies the switches and the tractions of a run. Tractions at the end of a step are projected: the condition holds
/// up to the rounding of its own evaluation in a few operations.
fn check_faces(faces: &FaceWatch<'_>, laws: &[LayerLaw<f64>], name: &str) {
    let total: usize = faces.switches.values().sum();
    println!("{name}: {total} switches, {:?}, excess {} ε", faces.switches, faces.excess);
    assert!(total >= 10_000, "{name}: {:?}", faces.switches);
    for kind in laws.iter().filter_map(switching_kind) {
        let count = faces.switches.get(kind).copied().unwrap_or(0);
        assert!(count > 300, "{name}: {kind}: {count}");
    }
    assert!(faces.excess <= 8.0, "{name}: {}", faces.excess);
}

fn initial_values(index: usize, seed: u64) -> Vec<f64> {
    let value = |cell| noise(seed * 7919 + (index * 1009 + cell) as u64);
    (0..CELLS[0] * CELLS[1]).map(value).collect()
}

/// Verifies the ledger of the reference solver over 10,000 steps with layers of all kinds, at two Courant numbers;
/// rounding errors of a step are a few ε of the energy and of random sign.
#[test]
fn ledger_of_all_kinds_of_layers_closes_over_ten_thousand_steps() {
    for (seed, courant) in [(80, 1.0), (81, 0.7)] {
        let laws = layers_of_all_kinds(&mut NoiseSequence::new((seed + 100) << 40));
        let media = [1.0, 3.0].map(|factor| Medium::new(classical(factor), 2)).to_vec();
        let problem = loaded_medium(seed, &laws, media, courant);
        let mut domain = Reference::<f64, 2>::new(&problem).expect("sound");
        for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
            domain.set(field, &initial_values(index, seed));
        }
        domain.initialise_interlayers();
        let mut faces = FaceWatch::new(&problem, &laws, &domain.interlayer_history());
        let mut ledger = LedgerWatch::new(&domain.energy());
        for _ in 0..STEPS {
            domain.advance(1);
            faces.watch(&domain.interlayer_history());
            ledger.watch(&domain.energy(), &domain.ledger());
        }
        let name = format!("Courant number {courant}");
        ledger.check(&name);
        check_faces(&faces, &laws, &name);
        assert!(ledger.losses.iter().all(|loss| *loss > 0.0), "{:?}", ledger.losses);
        assert!(domain.energy().fluid_kinetic > 0.0);
    }
}

/// Returns a reduced Cosserat solid whose P and S waves have the same speed 1 m/s, for α = λ + μ. With powers of two as
/// moduli and impedances the constants of sweeps are exact. In a quarter of a period of the rotation of spins, which
/// is a step, its sine and cosine are 1 and 0 to rounding.
fn equal_speeds(factor: f64) -> Medium {
    let (lambda, mu, step) = (0.5 * factor, 0.25 * factor, 2.0 * SPACING);
    let alpha = lambda + mu;
    let inertia = alpha * (4.0 * step / PI).powi(2);
    let rotation = Microrotation { alpha, inertia, couple: None };
    let solid = Isotropic::new(lambda, mu, factor, Some(rotation)).expect("sound moduli");
    Medium::new(solid, 2)
}

/// Verifies the ledger of the fused solver, which lacks the numerical dissipation, in blocks without any: reduced
/// Cosserat solids whose P and S waves both have Courant number 1, of unequal impedances.
#[test]
fn ledger_of_the_fused_solver_closes_without_numerical_dissipation() {
    let seed = 82;
    let laws = layers_of_all_kinds(&mut NoiseSequence::new((seed + 100) << 40));
    let media = [1.0, 4.0].map(equal_speeds).to_vec();
    for pair in media.iter().flat_map(|medium| medium.pairs.iter().flatten()) {
        assert_eq!(pair.speed(), 1.0);
    }
    let problem = loaded_medium(seed, &laws, media, 1.0);
    let mut domain = DecomposedDomain::<f64, 2>::new(&problem, 1).expect("sound");
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        domain.set(field, &initial_values(index, seed));
    }
    domain.initialise_interlayers();
    let mut faces = FaceWatch::new(&problem, &laws, &domain.interlayer_history());
    let mut ledger = LedgerWatch::new(&domain.energy());
    for _ in 0..STEPS {
        domain.advance(1).expect("threads");
        faces.watch(&domain.interlayer_history());
        ledger.watch(&domain.energy(), &domain.ledger());
    }
    ledger.check("fused");
    check_faces(&faces, &laws, "fused");
    // Layers that break before they bear tension lose no energy at fracture, as those here.
    let [plastic, viscous, released, _, fluid] = ledger.losses;
    assert!([plastic, viscous, released, fluid].iter().all(|loss| *loss > 0.0));
    assert!(domain.energy().fluid_kinetic > 0.0);
}
