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

const GRID_CELLS: [usize; 2] = [12, 11];
/// Cells above the planes of interlayers normal to each axis; the second axis is periodic.
const INTERLAYER_COORDINATES: [&[usize]; 2] = [&[4, 8], &[0, 4, 7]];
/// Edge length of a cell, m.
const SPACING: f64 = 0.125;
const STEP_COUNT: usize = 10_000;

/// Returns interlayers normal to an axis, with a random law of `laws`, or rarely none, at each face.
fn random_interlayers_by_face(
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
        let faces = (0..GRID_CELLS[1 - axis]).map(law);
        InterlayerPlane { cell: *cell, laws: PlaneLaws::from_faces(faces) }
    };
    Interlayers {
        axis,
        planes: INTERLAYER_COORDINATES[axis].iter().map(&mut plane).collect(),
        laws: laws.iter().map(|law| InterlayerLaw::Plane(*law, axis)).collect(),
        has_open_ends,
    }
}

/// Returns a medium of random blocks of two materials with a random law of `laws` at each face, tractions that vary in
/// time on one side and a fixed opposite side; `courant`: Courant number of the fastest waves in a sweep.
fn build_loaded_problem(
    seed: u64,
    laws: &[LayerLaw<f64>],
    media: Vec<Medium>,
    courant: f64,
) -> Problem<2> {
    let mut random = NoiseSequence::new(seed << 40);
    let grid = Grid { cells: GRID_CELLS, spacing: [SPACING; 2] };
    let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
    let step = 2.0 * courant * SPACING / speed;
    let block = |coordinate: usize, axis: usize| {
        INTERLAYER_COORDINATES[axis].iter().filter(|plane| coordinate >= **plane).count() as u64
    };
    let cell_media = (0..grid.count())
        .map(|cell| {
            let [x, y] = [cell % GRID_CELLS[0], cell / GRID_CELLS[0]];
            u16::from(noise(seed + 10 * block(x, 0) + block(y, 1) % 3) > 0.0)
        })
        .collect();
    let boundaries = [
        [Boundary::ByPair(vec![Condition::Traction(0.0); 2]), Boundary::Fixed],
        [Boundary::Periodic, Boundary::Periodic],
    ];
    let interlayers = [0, 1]
        .map(|axis| random_interlayers_by_face(&mut random, axis, laws, seed.is_multiple_of(2)));
    let load = |pair: usize, frequency: f64| Load {
        axis: 0,
        end: 0,
        pair,
        faces: (0..GRID_CELLS[1])
            .map(|face| (face, 0.5 + 0.4 * noise(seed + face as u64)))
            .collect(),
        signal: Arc::new(move |time: f64| {
            (frequency * time).sin() + (2.3 * frequency * time).cos()
        }),
    };
    let loads = vec![load(0, 1.3), load(1, 1.9)];
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    let problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
    Problem { interlayers: interlayers.to_vec(), loads, ..problem }
}

/// Returns the law of a face in the list of all laws.
fn face_law<'a>(laws: &'a [LayerLaw<f64>], face: &InterlayerFace) -> &'a LayerLaw<f64> {
    &laws[face.law]
}

/// Returns the name of the kind of a law that has several branches; `None` for linear laws.
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

/// Returns the branch of the law of a face: whether it slipped in the last step, whether pores or the crack are open,
/// and whether it is broken.
fn law_branch(record: &FaceRecord<f64>, old_slip: f64) -> [bool; 3] {
    let is_open = record.opening > 0.0 || record.porosity > 0.0;
    [record.slip > old_slip, is_open, record.fracture_time > 0.0]
}

/// Computes how far the tractions of a face are beyond the admissible set of its law, in units of the rounding of the
/// terms of the condition: |S_t| ≤ τ_s + Hχ − k_s S_n, or |S_t| ≤ −k_s min(S_n, 0) for cracks.
fn traction_excess(law: &LayerLaw<f64>, record: &FaceRecord<f64>) -> Option<f64> {
    let [normal, shear] = [record.normal_stress, record.shear_stress];
    let cone_excess = |cone: &YieldCone<f64>| {
        let strength = cone.hardened_strength(record.slip);
        let terms = [shear.abs(), cone.friction * normal, -strength];
        (terms.iter().sum::<f64>(), terms.iter().map(|term| term.abs()).sum::<f64>())
    };
    let contact_excess = |friction: f64| {
        let limit = -friction * normal.min(0.0);
        (shear.abs() - limit, shear.abs() + limit)
    };
    let (excess, size) = match law {
        LayerLaw::Plastic(law) => cone_excess(&law.cone),
        LayerLaw::Porous(law) => match &law.shear {
            TangentialComponent::Plastic(_, cone) => cone_excess(cone),
            _ => return None,
        },
        LayerLaw::Breaking(law) if record.fracture_time == 0.0 => cone_excess(&law.cone),
        LayerLaw::Breaking(law) => contact_excess(law.cone.friction),
        LayerLaw::Cracked(law) => contact_excess(law.friction?),
        _ => return None,
    };
    Some(if excess > 0.0 { excess / (f64::EPSILON * size) } else { 0.0 })
}

/// Count of the switches between branches of face laws, by kind of law, and largest excess of tractions of a run.
struct FaceMonitor<'a> {
    problem: &'a Problem<2>,
    laws: &'a [LayerLaw<f64>],
    /// By face: slip and branch after the last step.
    last_branches: Vec<(f64, [bool; 3])>,
    switch_counts: std::collections::BTreeMap<&'static str, usize>,
    traction_excess: f64,
}

impl<'a> FaceMonitor<'a> {
    fn new(problem: &'a Problem<2>, laws: &'a [LayerLaw<f64>], history: &[f64]) -> Self {
        let records = problem.interlayer_records(history);
        let last_branches = records.iter().map(|own| (0.0, law_branch(&own.1, 0.0))).collect();
        Self {
            problem,
            laws,
            last_branches,
            switch_counts: Default::default(),
            traction_excess: 0.0,
        }
    }

    fn update(&mut self, history: &[f64]) {
        let records = self.problem.interlayer_records(history);
        for ((face, record), last) in records.iter().zip(&mut self.last_branches) {
            let law = face_law(self.laws, face);
            assert!(record.slip >= last.0, "{law:?}: slip {} after {}", record.slip, last.0);
            let now = (record.slip, law_branch(record, last.0));
            if let Some(kind) = switching_kind(law) {
                let changes = now.1.iter().zip(&last.1).filter(|(a, b)| a != b).count();
                *self.switch_counts.entry(kind).or_default() += changes;
            }
            *last = now;
            self.traction_excess =
                self.traction_excess.max(traction_excess(law, record).unwrap_or(0.0));
        }
    }
}

fn dissipated_energies(ledger: &Ledger) -> [f64; 5] {
    let InterlayerLosses { plastic, viscous, released, fracture, fluid } = ledger.interlayer_losses;
    [plastic, viscous, released, fracture, fluid]
}

/// Record of energy and ledger of a run, with checks after each step.
struct LedgerMonitor {
    start: f64,
    max_energy: f64,
    residual: f64,
    dissipated_energies: [f64; 5],
    numerical: f64,
}

impl LedgerMonitor {
    fn new(energy: &Energy) -> Self {
        let start = energy.total();
        Self {
            start,
            max_energy: start,
            residual: 0.0,
            dissipated_energies: [0.0; 5],
            numerical: 0.0,
        }
    }

    fn update(&mut self, energy: &Energy, ledger: &Ledger) {
        let now = energy.total();
        self.max_energy = self.max_energy.max(now);
        self.residual = self.residual.max((now - self.start - ledger.energy_change()).abs());
        let energies = dissipated_energies(ledger);
        for (loss, old) in energies.iter().zip(self.dissipated_energies) {
            // Sums over faces are rounded once.
            assert!(*loss >= old * (1.0 - f64::EPSILON), "{loss:e} after {old:e}");
        }
        self.dissipated_energies = energies;
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
            self.dissipated_energies, self.numerical, self.start, self.max_energy
        );
        assert!(relative <= 1e-12, "{name}: {relative:e}");
    }
}

/// Verifies the switches and the tractions of a run. Tractions at the end of a step are projected: the condition holds
/// up to the rounding of its own evaluation in a few operations.
fn check_faces(faces: &FaceMonitor<'_>, laws: &[LayerLaw<f64>], name: &str) {
    let total: usize = faces.switch_counts.values().sum();
    println!(
        "{name}: {total} switches, {:?}, excess {} ε",
        faces.switch_counts, faces.traction_excess
    );
    assert!(total >= 10_000, "{name}: {:?}", faces.switch_counts);
    for kind in laws.iter().filter_map(switching_kind) {
        let count = faces.switch_counts.get(kind).copied().unwrap_or(0);
        assert!(count > 300, "{name}: {kind}: {count}");
    }
    assert!(faces.traction_excess <= 8.0, "{name}: {}", faces.traction_excess);
}

fn noise_values(index: usize, seed: u64) -> Vec<f64> {
    let value = |cell| noise(seed * 7919 + (index * 1009 + cell) as u64);
    (0..GRID_CELLS[0] * GRID_CELLS[1]).map(value).collect()
}

/// Verifies the ledger of the reference solver over 10,000 steps with layers of all kinds; rounding errors of a step are
/// a few ε of the energy and of random sign.
#[test]
fn ledger_of_all_kinds_of_layers_closes_over_ten_thousand_steps() {
    check_ledger(81, 0.7);
}

#[test]
#[ignore = "takes four seconds"]
fn ledger_of_all_kinds_of_layers_closes_over_many_steps_at_courant_number_one() {
    check_ledger(80, 1.0);
}

/// Checks the ledger of the reference solver at a Courant number; `seed`: of the layers, media and initial values.
fn check_ledger(seed: u64, courant: f64) {
    let laws = layers_of_all_kinds(&mut NoiseSequence::new((seed + 100) << 40));
    let media = [1.0, 3.0].map(|factor| Medium::new(classical(factor), 2)).to_vec();
    let problem = build_loaded_problem(seed, &laws, media, courant);
    let mut domain = Reference::<f64, 2>::new(&problem).expect("sound");
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        domain.set_field(field, &noise_values(index, seed));
    }
    domain.initialise_interlayers();
    let mut faces = FaceMonitor::new(&problem, &laws, &domain.interlayer_history());
    let mut ledger = LedgerMonitor::new(&domain.energy());
    for _ in 0..STEP_COUNT {
        domain.advance(1);
        faces.update(&domain.interlayer_history());
        ledger.update(&domain.energy(), &domain.ledger());
    }
    let name = format!("Courant number {courant}");
    ledger.check(&name);
    check_faces(&faces, &laws, &name);
    assert!(
        ledger.dissipated_energies.iter().all(|loss| *loss > 0.0),
        "{:?}",
        ledger.dissipated_energies
    );
    assert!(domain.energy().fluid_kinetic > 0.0);
}

/// Returns a reduced Cosserat solid whose P and S waves have the same speed 1 m/s, for α = λ + μ. With powers of two as
/// moduli and impedances the constants of sweeps are exact. In a quarter of a period of the rotation of spins, which
/// is a step, its sine and cosine are 1 and 0 to rounding.
fn equal_speed_medium(factor: f64) -> Medium {
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
    let media = [1.0, 4.0].map(equal_speed_medium).to_vec();
    for pair in media.iter().flat_map(|medium| medium.pairs.iter().flatten()) {
        assert_eq!(pair.speed(), 1.0);
    }
    let problem = build_loaded_problem(seed, &laws, media, 1.0);
    let mut domain = DecomposedDomain::<f64, 2>::new(&problem, 1).expect("sound");
    for (index, field) in domain.fields().to_vec().into_iter().enumerate() {
        domain.set_field(field, &noise_values(index, seed));
    }
    domain.initialise_interlayers();
    let mut faces = FaceMonitor::new(&problem, &laws, &domain.interlayer_history());
    let mut ledger = LedgerMonitor::new(&domain.energy());
    for _ in 0..STEP_COUNT {
        domain.advance(1).expect("threads");
        faces.update(&domain.interlayer_history());
        ledger.update(&domain.energy(), &domain.ledger());
    }
    ledger.check("fused");
    check_faces(&faces, &laws, "fused");
    // Layers that break before they bear tension lose no energy at fracture, as those here.
    let [plastic, viscous, released, _, fluid] = ledger.dissipated_energies;
    assert!([plastic, viscous, released, fluid].iter().all(|loss| *loss > 0.0));
    assert!(domain.energy().fluid_kinetic > 0.0);
}
