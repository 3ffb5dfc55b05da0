//! Plane waves in granular and porous media against exact solutions (Sadovskii & Sadovskaya 2019): spall, compaction
//! shocks, smooth waves in one state of the contacts.

use crate::contacts::{granular, porous, porous_cone};
use models::porous::{PoreContact, PorousMedium, PorousParameters};
use models::solid::waves::SolidField;
use models::yield_set::parameters::Mises;
use polyfit_rs::polyfit_rs::polyfit;
use std::f64::consts::TAU;
use std::sync::Arc;
use wellposed_dynamics::boundary::{Boundary, Condition, Load};
use wellposed_dynamics::contact_law::ContactLaw;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};
use wellposed_dynamics::reference::Reference;

/// Elastic solver of a column of unit length.
type Column = Reference<f64, 2>;

/// Creates the problem of a column of `count` cells along x₁, of unit length.
fn column(medium: Medium, count: usize, courant: f64, ends: [Boundary; 2]) -> Problem<2> {
    let spacing = 1.0 / count as f64;
    let step = courant * 2.0 * spacing / medium.max_speed();
    let scheme = Scheme {
        splitting: Splitting::TwoCyclic,
        ..Scheme::new(Slopes::Limited, PlasticStep::ReturnMapping)
    };
    Problem::new(
        Grid { cells: [count, 1], spacing: [spacing; 2] },
        vec![medium],
        vec![0; count],
        [ends, [Boundary::Periodic, Boundary::Periodic]],
        step,
        scheme,
    )
}

fn solver(problem: &Problem<2>) -> Column {
    Reference::new(problem).expect("a sound problem")
}

fn set(column: &mut Column, field: SolidField, value: impl Fn(usize) -> f64) {
    let values: Vec<f64> = (0..column.grid().count()).map(value).collect();
    column.set_field(field, &values);
}

fn values(column: &Column, field: SolidField) -> Vec<f64> {
    column.values(field).expect("a field of the medium")
}

/// Fits the order of convergence of errors for numbers of cells.
fn fit_order(counts: &[usize], errors: &[f64]) -> f64 {
    let logarithms =
        |values: &mut dyn Iterator<Item = f64>| values.map(f64::ln).collect::<Vec<_>>();
    let x = logarithms(&mut counts.iter().map(|count| *count as f64));
    let y = logarithms(&mut errors.iter().copied());
    -polyfit(&x, &y, 1).expect("a fit")[1]
}

/// Velocity of a rectangular pulse of 20 cells per 100 at the middle of a granular column that runs towards the free end.
fn spall(count: usize, courant: f64) -> (Vec<f64>, f64, f64) {
    // m = μ ≤ æk and æ ≤ ¾: compression is elastic, and extension transmits no stress.
    let medium = granular(0.65, None, 2);
    let (speed, density) = (medium.max_speed(), 1.2);
    let transverse = (1.5 - 0.6) / 2.7;
    let problem = column(medium, count, courant, [Boundary::Free, Boundary::Free]);
    let mut column = solver(&problem);
    let in_pulse = |cell: usize| (count / 2..count / 2 + count / 5).contains(&cell);
    let amplitude = |cell: usize| if in_pulse(cell) { 1.0 } else { 0.0 };
    set(&mut column, SolidField::Velocity(0), amplitude);
    set(&mut column, SolidField::Stress(0, 0), |cell| -density * speed * amplitude(cell));
    for axis in [1, 2] {
        set(&mut column, SolidField::Stress(axis, axis), |cell| {
            -density * speed * transverse * amplitude(cell)
        });
    }
    let steps = (0.9 / speed / problem.step).round() as usize;
    column.advance(steps);
    let stress = values(&column, SolidField::Stress(0, 0));
    let greatest = stress.iter().fold(0.0f64, |greatest, own| greatest.max(own.abs()));
    (
        values(&column, SolidField::Velocity(0)),
        greatest / (density * speed),
        column.energy().total(),
    )
}

#[test]
fn a_rectangular_pulse_of_whole_cells_spalls_exactly() {
    for count in [50, 200] {
        let (velocity, greatest_stress, _) = spall(count, 1.0);
        for (cell, own) in velocity.iter().enumerate() {
            let exact = if cell >= count - count / 10 { 2.0 } else { 0.0 };
            assert!((own - exact).abs() < 1e-14, "{cell} of {count}: {own}");
        }
        assert!(greatest_stress < 1e-15, "{greatest_stress:e}");
    }
}

#[test]
fn momentum_of_a_spalling_column_is_exact() {
    for courant in [1.0, 0.9, 0.5] {
        let (velocity, ..) = spall(100, courant);
        let momentum: f64 = velocity.iter().sum();
        assert!((momentum - 20.0).abs() < 1e-12, "{momentum}");
    }
}

/// Number of times at which the errors of a shock are evaluated.
const SAMPLES: usize = 12;

/// Errors of a compaction shock behind a piston of unit pressure.
struct ShockErrors {
    /// L1 error of the stress over the whole profile, and within 5 % of the travelled distance about the front.
    l1: [f64; 2],
    /// Relative errors of the position of the front, of the mean plateau, and of the dissipation.
    relative: [f64; 3],
    /// Largest deviation on the plateau.
    plateau: f64,
    /// Residual of the ledger relative to the work of the piston.
    residual: f64,
}

/// Runs the shock: k_a = 1.5, μ_a = 0.9, ρ = 1.2, porosity `porosity`.
fn compaction_shock(contact_modulus: f64, porosity: f64, count: usize) -> ShockErrors {
    let (open, closed, density) = (2.7, 2.7 + contact_modulus, 1.2);
    // The secant of the diagram: one shock if it is steeper than the elastic segment.
    let strain = (1.0 + contact_modulus * porosity) / closed;
    let speed = (1.0 / (density * strain)).sqrt();
    assert!(1.0 / strain > open, "one shock");
    let side = Boundary::ByPair(vec![Condition::Traction(0.0), Condition::Velocity(0.0)]);
    let medium = porous(contact_modulus, porosity, false, 2);
    let mut problem = column(medium, count, 0.6, [side.clone(), side]);
    problem.loads.push(Load {
        axis: 0,
        end: 0,
        pair: 0,
        faces: vec![(0, 1.0)],
        signal: Arc::new(|_| -1.0),
    });
    let mut column = solver(&problem);
    // Mean errors over several times: at a single time they depend on the position of the front in its cell.
    let cell_length = 1.0 / count as f64;
    let mut l1 = [0.0; 2];
    let (mut front, mut stress) = (0.0, Vec::new());
    let middle = |cell: usize| (cell as f64 + 0.5) * cell_length;
    for sample in 0..SAMPLES {
        let time = (0.5 + 0.1 * sample as f64 / (SAMPLES - 1) as f64) / speed;
        let steps = (time / problem.step).round() as usize;
        column.advance(steps - (column.time() / problem.step).round() as usize);
        stress = values(&column, SolidField::Stress(0, 0));
        front = speed * column.time();
        for (cell, stress) in stress.iter().enumerate() {
            let loaded = (front / cell_length - cell as f64).clamp(0.0, 1.0);
            let error = (stress + loaded).abs() * cell_length / SAMPLES as f64;
            l1[0] += error;
            if (middle(cell) - front).abs() < 0.05 * front {
                l1[1] += error;
            }
        }
    }
    let plateau: Vec<f64> = (0..count)
        .filter(|cell| (0.1..0.9).contains(&(middle(*cell) / front)))
        .map(|cell| -stress[cell])
        .collect();
    let mean = plateau.iter().sum::<f64>() / plateau.len() as f64;
    let position = -stress.iter().sum::<f64>() * cell_length;
    // Loss per volume: area between the chord and the diagram.
    let stored = 0.5 * open * strain * strain + 0.5 * contact_modulus * (strain - porosity).powi(2);
    let loss = (0.5 * strain - stored) * front * cell_length;
    let ledger = column.ledger();
    ShockErrors {
        l1,
        relative: [position / front - 1.0, mean - 1.0, ledger.numerical_dissipation / loss - 1.0],
        plateau: plateau.iter().map(|own| (own - 1.0).abs()).fold(0.0, f64::max),
        residual: (ledger.boundary_work - ledger.numerical_dissipation - column.energy().total())
            / ledger.boundary_work,
    }
}

#[test]
fn compaction_shocks_converge_to_the_exact_solution() {
    let counts = [100, 160, 250, 400, 640];
    for (contact_modulus, porosity) in [(4.0, 0.1), (9.0, 0.05)] {
        let errors = counts.map(|count| compaction_shock(contact_modulus, porosity, count));
        let order = |which: usize| fit_order(&counts, &errors.each_ref().map(|own| own.l1[which]));
        let orders = [order(0), order(1)];
        println!("{contact_modulus} {porosity}: orders {orders:?}");
        assert!(orders[0] > 0.6 && orders[1] > 0.9, "{contact_modulus}: {orders:?}");
        let finest = &errors[counts.len() - 1];
        println!("{:?} {:e}", finest.relative, finest.plateau);
        // 640 cells: about three times the errors of 2000 cells.
        let [position, mean, loss] = finest.relative.map(f64::abs);
        assert!(position < 3e-3 && mean < 1e-3 && loss < 2e-2, "{:?}", finest.relative);
        assert!(finest.plateau < 1.5e-2, "{}", finest.plateau);
        assert!(errors.iter().all(|own| own.residual.abs() < 1e-13));
    }
}

#[test]
fn pressures_behind_a_shock_into_a_much_softer_medium_stay_bounded() {
    // E₁ = 21 E₀; with the impedance of the present state in every cell the pressure would grow to several times p₀.
    let errors = compaction_shock(54.0, 0.1, 400);
    assert!(errors.plateau < 0.05, "{}", errors.plateau);
    assert!(errors.relative[0].abs() < 5e-3, "{:?}", errors.relative);
}

/// Errors of the velocity of a sinusoidal wave after a period, in a state of constant strain.
fn smooth_wave_error(strain: f64, count: usize, courant: f64) -> f64 {
    let (contact_modulus, porosity, amplitude) = (2.0, 0.1, 0.03);
    let closed = if strain + porosity < 0.0 { contact_modulus } else { 0.0 };
    let speed = ((2.7 + closed) / 1.2f64).sqrt();
    let medium = porous(contact_modulus, porosity, false, 2);
    let problem = column(medium, count, courant, [Boundary::Periodic, Boundary::Periodic]);
    let mut column = solver(&problem);
    // Cell means of a sine.
    let mean = |cell: usize, time: f64| {
        let antiderivative = |x: f64| -(TAU * (x - speed * time)).cos() / TAU;
        let [low, high] = [cell, cell + 1].map(|face| face as f64 / count as f64);
        amplitude * (antiderivative(high) - antiderivative(low)) * count as f64
    };
    let strain_at = |cell: usize| strain + mean(cell, 0.0);
    let closure = |cell: usize| (porosity + strain_at(cell)).min(0.0);
    set(&mut column, SolidField::Velocity(0), |cell| -speed * mean(cell, 0.0));
    for (axis, modulus) in [(0, 2.7), (1, 0.9), (2, 0.9)] {
        set(&mut column, SolidField::Stress(axis, axis), |cell| {
            modulus * strain_at(cell) + contact_modulus * closure(cell)
        });
    }
    set(&mut column, SolidField::VolumetricStrain, strain_at);
    set(&mut column, SolidField::PoreClosure, closure);
    let steps = (1.0 / speed / problem.step).round() as usize;
    column.advance(steps);
    let time = steps as f64 * problem.step;
    let velocity = values(&column, SolidField::Velocity(0));
    let errors =
        velocity.iter().enumerate().map(|(cell, own)| (own + speed * mean(cell, time)).abs());
    errors.sum::<f64>() / count as f64
}

#[test]
fn smooth_waves_in_open_and_collapsed_pores_are_second_order() {
    let counts = [32, 64, 128, 256];
    for strain in [0.0, -0.4] {
        for courant in [1.0, 0.8] {
            let errors = counts.map(|count| smooth_wave_error(strain, count, courant));
            println!("strain {strain}, Courant number {courant}: {errors:?}");
            if strain < -0.1 && courant == 1.0 {
                // Exact at Courant number 1 in the stiffest state.
                assert!(errors.iter().all(|own| *own < 1e-14), "{errors:?}");
                continue;
            }
            assert!(fit_order(&counts, &errors) > 1.9, "{strain} {courant}: {errors:?}");
        }
    }
}

/// Two halves of a column that move towards or away from each other with the velocity v: between the waves the pressure is
/// √(ρE) v, with E = k_a + k_b + 4(μ_a + μ_b)/3 in compression, as μ_b < æk_b, and E = k_a + 4μ_a/3 in tension.
#[test]
fn a_heteromodular_solid_is_stiffer_in_compression() {
    let count = 400;
    for (sign, modulus) in [(1.0, 5.5 + 4.0 / 3.0 * 2.6), (-1.0, 1.5 + 4.0 / 3.0 * 0.9f64)] {
        let medium = porous_cone(0.5, 0.0, None, 2);
        let ends = [Boundary::Free, Boundary::Free];
        let problem = column(medium, count, 0.9, ends);
        let mut column = solver(&problem);
        set(&mut column, SolidField::Velocity(0), |cell| {
            sign * if cell < count / 2 { 0.01 } else { -0.01 }
        });
        let speed = (modulus / 1.2).sqrt();
        column.advance((0.3 / speed / problem.step).round() as usize);
        let stress = values(&column, SolidField::Stress(0, 0));
        let expected = -sign * 0.01 * 1.2 * speed;
        let middle = &stress[count / 2 - 20..count / 2 + 20];
        let error = middle.iter().map(|own| (own / expected - 1.0).abs()).fold(0.0, f64::max);
        assert!(error < 1e-3, "{sign}: {error:e}");
        // Half of the pressure at the position of the waves.
        let end = 0.5 - 0.3;
        let front = stress.iter().position(|own| own / expected > 0.5).unwrap_or(0);
        assert!((front as f64 / count as f64 - end).abs() < 0.01, "{sign}: {front}");
    }
}

#[test]
fn compression_within_the_cone_has_the_bits_of_the_elastic_solid() {
    let side = Boundary::ByPair(vec![Condition::Traction(0.0), Condition::Velocity(0.0)]);
    let elastic = {
        let medium = granular(1e6, None, 2);
        Medium { contact: None, ..medium }
    };
    let runs = [granular(1e6, None, 2), elastic].map(|medium| {
        let mut problem = column(medium, 60, 0.7, [side.clone(), side.clone()]);
        problem.loads.push(Load {
            axis: 0,
            end: 0,
            pair: 0,
            faces: vec![(0, 1.0)],
            signal: Arc::new(|time| -(0.1 + time)),
        });
        let mut column = solver(&problem);
        column.advance(30);
        let fields = [SolidField::Velocity(0), SolidField::Stress(0, 0), SolidField::Stress(2, 2)];
        fields.map(|field| values(&column, field).into_iter().map(f64::to_bits).collect::<Vec<_>>())
    });
    assert_eq!(runs[0], runs[1]);
}

/// Strong foam behind a piston of 120 MPa, in GPa and g/cm³: the elastic precursor must reach the yield limit. With the
/// impedance of open pores ahead of the shock the limited reconstruction keeps a shock behind a precursor of a third of
/// that pressure, on any grid.
#[test]
fn the_precursor_of_a_compaction_shock_reaches_the_yield_limit() {
    let [bulk, shear, limit, density, pressure] = [0.6, 0.25, 0.004, 0.8, 0.12];
    let parameters = PorousParameters {
        density,
        bulk_modulus: bulk,
        shear_modulus: shear,
        yield_stress: None,
        intensity_coefficient: 0.375,
        contact_bulk_modulus: 12.0,
        porosity: 0.15,
        contact: PoreContact::Spherical,
    };
    let law = ContactLaw::from_porous(&PorousMedium::new(parameters).expect("sound constants"));
    let yield_set = Mises::new_von_mises(limit / 0.75f64.sqrt());
    let medium = Medium::with_contact(law, 2).with_yield_set(yield_set);
    let side = Boundary::ByPair(vec![Condition::Traction(0.0), Condition::Velocity(0.0)]);
    let count = 1000;
    let mut problem = column(medium, count, 0.8, [side.clone(), side]);
    problem.loads.push(Load {
        axis: 0,
        end: 0,
        pair: 0,
        faces: vec![(0, 1.0)],
        signal: Arc::new(move |_| -pressure),
    });
    let mut column = solver(&problem);
    // τ = μ e in uniaxial strain for c² = 3/8: yielding at e = τ_s/μ.
    let elastic = bulk + 4.0 / 3.0 * shear;
    let (precursor, exact) = ((elastic / density).sqrt(), elastic * limit / shear);
    // Position of the shock after half of the time and at the end: it starts with a lag of a few cells.
    let mut fronts = [0; 2];
    let mut stress = Vec::new();
    let steps = (0.25 / precursor / problem.step).round() as usize;
    for front in &mut fronts {
        column.advance(steps);
        stress = values(&column, SolidField::Stress(0, 0));
        *front = stress.iter().rposition(|own| -own > 0.5 * pressure).expect("a shock");
    }
    let front = fronts[1];
    let ahead = &stress[front + count / 66..front + count / 33];
    let mean = -ahead.iter().sum::<f64>() / ahead.len() as f64;
    assert!((mean / exact - 1.0).abs() < 0.2, "{mean} instead of {exact}");
    // p₀ − p_f = (k_a + k_b)(ε − ε_f) − k_b(θ₀ − ε_f) behind the shock.
    let yield_strain = limit / shear;
    let strain = yield_strain + (pressure - exact + 12.0 * (0.15 - yield_strain)) / (bulk + 12.0);
    let speed = ((pressure - exact) / (density * (strain - yield_strain))).sqrt();
    let cells = (fronts[1] - fronts[0]) as f64;
    let measured = cells / count as f64 / (0.5 * column.time());
    assert!((measured / speed - 1.0).abs() < 0.01, "{measured} instead of {speed}");
}
