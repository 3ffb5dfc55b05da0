//! Fields on a grid: energy and its ledger, boundaries, symmetry, a pushed bar, uniform rotation; invalid domains.

use crate::support::media::{THEORIES, isotropic, rate_equations, unknown_name};
use crate::support::noise;
use models::common::rates::{RateEquations, SymmetricForm};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use models::solid::waves::SolidField;
use nalgebra::DVector;
use std::f64::consts::PI;
use wellposed_dynamics::boundary::{Boundary, Condition};
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{DomainError, Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::reference::Reference;

/// Fills all fields with noise.
fn fill_with_noise(fields: &[SolidField], cells: usize, mut set: impl FnMut(SolidField, &[f64])) {
    for (index, &field) in fields.iter().enumerate() {
        let value = |cell: usize| noise((1000 * index + cell) as u64);
        set(field, &(0..cells).map(value).collect::<Vec<_>>());
    }
}

/// Computes the kinetic and stored energy of a domain, J, from the symmetric form of the medium of each cell.
fn compute_energy<const D: usize>(
    (fields, values): (&[SolidField], &dyn Fn(SolidField) -> Option<Vec<f64>>),
    forms: &[(RateEquations<D>, SymmetricForm<D>)],
    cell_media: &[u16],
    volume: f64,
) -> f64 {
    let unknowns = forms[0].0.unknowns;
    let indices: Vec<usize> = fields
        .iter()
        .map(|f| unknowns.iter().position(|u| u.name == unknown_name(*f)).expect("an unknown"))
        .collect();
    let values: Vec<Vec<f64>> = fields.iter().map(|f| values(*f).expect("a field")).collect();
    (0..cell_media.len())
        .map(|cell| {
            let mut state = DVector::zeros(unknowns.len());
            for (index, values) in indices.iter().zip(&values) {
                state[*index] = values[cell];
            }
            let form = &forms[usize::from(cell_media[cell])].1;
            0.5 * volume * (state.transpose() * &form.a * &state)[(0, 0)]
        })
        .sum()
}

/// Verifies with noise in a domain of two media, for each kind of boundary: the ledger closes, the energy never grows,
/// and fixed and free boundaries do no work.
#[test]
fn ledger_closes_and_energy_does_not_grow() {
    for theory in THEORIES {
        for boundary in
            [Boundary::Periodic, Boundary::Fixed, Boundary::Free, Boundary::NonReflecting]
        {
            let soft = isotropic(theory, 1.0);
            let stiff = Isotropic {
                lambda: 3.0 * soft.lambda,
                mu: 2.0 * soft.mu,
                density: 1.7 * soft.density,
                ..soft
            };
            let cells = [14, 11];
            let spacing = [0.1, 0.13];
            let cell_media: Vec<u16> = (0..14 * 11).map(|i| u16::from(noise(i) > 0.3)).collect();
            let media = [soft, stiff].map(|s| Medium::new(s, 2));
            let speed = media.iter().map(Medium::max_speed).fold(0.0, f64::max);
            let forms = [soft, stiff].map(|s| {
                let equations = rate_equations::<2>(&s);
                let form = equations.symmetric_form().expect("elastic");
                (equations, form)
            });
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let mut solver: Reference<f64, 2> = Reference::new(&Problem::new(
                Grid { cells, spacing },
                media.to_vec(),
                cell_media.clone(),
                std::array::from_fn(|_| [boundary.clone(), boundary.clone()]),
                2.0 * 0.1 / speed,
                scheme,
            ))
            .expect("a sound domain");
            fill_with_noise(&media[0].fields, cell_media.len(), |field, own| {
                solver.set_field(field, own)
            });
            let volume = spacing[0] * spacing[1];
            let energy_of = |solver: &Reference<f64, 2>| {
                compute_energy(
                    (solver.fields(), &|own| solver.values(own)),
                    &forms,
                    &cell_media,
                    volume,
                )
            };
            let start = energy_of(&solver);
            let mut last = start;
            for _ in 0..300 {
                solver.advance(1);
                let now = energy_of(&solver);
                assert!(now <= last * (1.0 + 1e-13), "{theory:?} {boundary:?}: {now} after {last}");
                last = now;
            }
            let account = solver.ledger();
            let residual = last - start - account.energy_change();
            assert!((residual / start).abs() < 1e-12, "{theory:?} {boundary:?} {residual:e}");
            match boundary {
                Boundary::Fixed | Boundary::Free => {
                    assert!(
                        account.boundary_work.abs() < 1e-13 * start,
                        "{:e}",
                        account.boundary_work
                    );
                }
                Boundary::NonReflecting => assert!(account.boundary_work < -0.1 * start),
                _ => {}
            }
            assert!(account.numerical_dissipation > 0.1 * start);
        }
    }
}

#[test]
fn invalid_domains_are_refused() {
    let medium = Medium::new(isotropic(Theory::Classical, 1.0), 2);
    let grid = Grid { cells: [4, 4], spacing: [0.1, 0.1] };
    let create_domain =
        |media: Vec<Medium>, cell_media: Vec<u16>, step: f64, boundaries: [[Boundary; 2]; 2]| {
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
            Domain::<f64, 2>::new(&problem).map(|_| ())
        };
    let free = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    assert_eq!(create_domain(vec![medium.clone()], vec![0; 16], 1e-3, free.clone()), Ok(()));
    assert_eq!(
        create_domain(vec![medium.clone()], vec![0; 15], 1e-3, free.clone()),
        Err(DomainError::CellCount { actual: 15, expected: 16 })
    );
    assert_eq!(create_domain(Vec::new(), vec![0; 16], 1e-3, free.clone()), Err(DomainError::Media));
    let cosserat = Medium::new(isotropic(Theory::Cosserat, 1.0), 2);
    assert_eq!(
        create_domain(vec![medium.clone(), cosserat], vec![0; 16], 1e-3, free.clone()),
        Err(DomainError::Media)
    );
    // A medium in the plane on a three-dimensional grid is refused.
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
    let space = Grid { cells: [2; 3], spacing: [0.1; 3] };
    let problem = Problem::new(space, vec![medium.clone()], vec![0; 8], boundaries, 1e-3, scheme);
    assert_eq!(Domain::<f64, 3>::new(&problem).map(|_| ()), Err(DomainError::Media));
    assert!(matches!(
        create_domain(vec![medium.clone()], vec![1; 16], 1e-3, free.clone()),
        Err(DomainError::UnknownMedium { cell: 0, medium: 1, count: 1 })
    ));
    assert!(matches!(
        create_domain(vec![medium.clone()], vec![0; 16], 1.0, free.clone()),
        Err(DomainError::Courant { axis: 0, .. })
    ));
    let half_periodic = [[Boundary::Periodic, Boundary::Free], [Boundary::Free, Boundary::Free]];
    let result = create_domain(vec![medium.clone()], vec![0; 16], 1e-3, half_periodic);
    assert_eq!(result, Err(DomainError::Periodic(0)));
    let too_few_conditions = Boundary::ByPair(vec![Condition::Traction(0.0)]);
    let boundaries = [[Boundary::Free, Boundary::Free], [too_few_conditions, Boundary::Free]];
    assert_eq!(
        create_domain(vec![medium], vec![0; 16], 1e-3, boundaries),
        Err(DomainError::ConditionCount { axis: 1, actual: 1, expected: 2 })
    );
}

/// Verifies that half of a mirror-symmetric or antisymmetric domain has the bits of the whole domain.
#[test]
fn half_of_a_symmetric_domain_equals_the_whole() {
    for theory in THEORIES {
        for is_even in [true, false] {
            let solid = isotropic(theory, 1.0);
            let medium = Medium::new(solid, 2);
            let step = 1.9 * 0.1 / medium.max_speed();
            let symmetry_boundary = match is_even {
                true => Boundary::new_symmetry(&medium, 0),
                false => Boundary::new_antisymmetry(&medium, 0),
            };
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let create_domain = |length: usize, first: Boundary| -> Domain<f64, 2> {
                let grid = Grid { cells: [length, 6], spacing: [0.1, 0.1] };
                let boundaries = [[first, Boundary::Free], [Boundary::Fixed, Boundary::Free]];
                let media = vec![medium.clone()];
                let cell_media = vec![0; 6 * length];
                let problem = Problem::new(grid, media, cell_media, boundaries, step, scheme);
                Domain::new(&problem).expect("sound")
            };
            let (mut half, mut whole) =
                (create_domain(8, symmetry_boundary), create_domain(16, Boundary::Free));
            for (index, field) in half.fields().to_vec().into_iter().enumerate() {
                // Parity under x₁ → −x₁ of vectors, axial vectors and their stresses.
                let count_normal_indices =
                    |indices: &[usize]| indices.iter().filter(|&&i| i == 0).count() % 2;
                let is_odd = match field {
                    SolidField::Velocity(i) => count_normal_indices(&[i]) == 1,
                    SolidField::Spin(k) => count_normal_indices(&[k]) == 0,
                    SolidField::Stress(i, j) | SolidField::ViscousStrain(i, j) => {
                        count_normal_indices(&[i, j]) == 1
                    }
                    SolidField::Couple(k, j) => count_normal_indices(&[k, j]) == 0,
                    _ => unreachable!("no field of these media"),
                };
                let sign = if is_odd == is_even { -1.0 } else { 1.0 };
                let mut values = [vec![0.0; 48], vec![0.0; 96]];
                for row in 0..6 {
                    for column in 0..8 {
                        let value = noise((100 * index + 10 * row + column) as u64);
                        values[0][8 * row + column] = value;
                        values[1][16 * row + 8 + column] = value;
                        values[1][16 * row + 7 - column] = sign * value;
                    }
                }
                half.set_field(field, &values[0]);
                whole.set_field(field, &values[1]);
            }
            for _ in 0..25 {
                half.advance();
                whole.advance();
            }
            for &field in half.fields() {
                let (half, whole) = (half.values(field), whole.values(field));
                let (half, whole) = (half.expect("a field"), whole.expect("a field"));
                for row in 0..6 {
                    for column in 0..8 {
                        let (a, b) = (half[8 * row + column], whole[16 * row + 8 + column]);
                        assert!(a == b, "{theory:?} {is_even} {field:?}: {a:e} {b:e}");
                    }
                }
            }
        }
    }
}

/// Verifies a bar pushed with the velocity V, or with a traction, against σ = −zV behind the front, with the impedance
/// z; at Courant number 1 the front moves by whole cells. The boundary work equals the energy of the bar.
#[test]
fn pushed_bar_has_the_exact_front() {
    let solid = isotropic(Theory::Classical, 1.0);
    let medium = Medium::new(solid, 2);
    let pair = &medium.pairs[0][0];
    let (z, c) = (pair.impedance(), pair.speed());
    for (condition, velocity, stress) in
        [(Condition::Velocity(0.3), 0.3, -0.3 * z), (Condition::Traction(-0.7), 0.7 / z, -0.7)]
    {
        let push = Boundary::ByPair(vec![condition, Condition::Traction(0.0)]);
        let boundaries = [[push, Boundary::Fixed], [Boundary::Periodic, Boundary::Periodic]];
        let grid = Grid { cells: [40, 1], spacing: [0.1, 0.1] };
        let (scheme, step) =
            (Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection), 2.0 * 0.1 / c);
        let problem =
            Problem::new(grid, vec![medium.clone()], vec![0; 40], boundaries, step, scheme);
        let mut domain: Reference<f64, 2> = Reference::new(&problem).expect("sound");
        domain.advance(15);
        let ledger = domain.ledger();
        let v = domain.values(SolidField::Velocity(0)).expect("a field");
        let s = domain.values(SolidField::Stress(0, 0)).expect("a field");
        for i in 0..40 {
            // A step has two sweeps along x₁, each of which moves the front by one cell.
            let [vi, si] = if i < 30 { [velocity, stress] } else { [0.0, 0.0] };
            assert!(
                (v[i] - vi).abs() < 1e-14 && (s[i] - si).abs() < 1e-14,
                "{i} {} {}",
                v[i],
                s[i]
            );
        }
        // Energy ½ρv² + ½s²/M = ρv² per volume in thirty cells (modulus M); there are no gradients along x₂.
        let expected = 30.0 * 0.01 * (velocity * velocity * z / c);
        assert!(
            (ledger.boundary_work / expected - 1.0).abs() < 1e-13,
            "{} {expected}",
            ledger.boundary_work
        );
        assert!(ledger.numerical_dissipation.abs() < 1e-13 * expected);
    }
}

/// Verifies the frequency of a uniform spin over a thousand periods, for the medium of the unit test
/// `HomogeneousIsotropicCosseratDomain` of SPECFEM++: 194.2009 Hz (quoted value, not confirmed independently).
#[test]
fn uniform_rotation_has_the_natural_frequency() {
    let couple = Some(CoupleModuli { beta: 7.75e8, gamma: 1.5e8, eta: 3e8 });
    let rotation = Microrotation { alpha: 1.005e9, inertia: 2700.0, couple };
    let solid = Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(rotation)).expect("sound moduli");
    let medium = Medium::new(solid, 2);
    let spacing = 0.5;
    let step = 2.0 * spacing / medium.max_speed();
    let boundaries = std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]);
    let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
    let grid = Grid { cells: [4, 4], spacing: [spacing; 2] };
    let mut domain: Domain<f64, 2> =
        Domain::new(&Problem::new(grid, vec![medium], vec![0; 16], boundaries, step, scheme))
            .expect("sound");
    domain.set_field(SolidField::Spin(2), &[1.0; 16]);
    let steps = (1000.0 / 194.2009 / step).round() as usize;
    // Each change of sign from + to − ends a period; its time within the step is interpolated with arccos.
    let (mut ends, mut last) = (Vec::new(), 1.0);
    for index in 1..=steps {
        domain.advance();
        let now = domain.values(SolidField::Spin(2)).expect("spins")[5];
        if last > 0.0 && now <= 0.0 {
            let angle = |value: f64| value.clamp(-1.0, 1.0).acos();
            let before = 0.5 * PI - angle(last);
            let share = before / (angle(now) - angle(last));
            ends.push((index as f64 - 1.0 + share) * step);
        }
        last = now;
    }
    let periods = (ends.len() - 1) as f64;
    let frequency = periods / (ends[ends.len() - 1] - ends[0]);
    assert!(periods > 900.0);
    assert!((frequency / 194.2009 - 1.0).abs() < 1e-6, "{frequency}");
}

/// Verifies that energy does not grow over many steps from noise, with Courant number 1 in each sweep.
#[test]
fn energy_does_not_grow_over_many_steps() {
    for theory in THEORIES {
        for boundary in [Boundary::Periodic, Boundary::Fixed, Boundary::Free] {
            let medium = Medium::new(isotropic(theory, 1.0), 2);
            let step = 2.0 * 0.1 / medium.max_speed();
            let scheme = Scheme::new(Slopes::Limited, PlasticStep::MidpointReflection);
            let grid = Grid { cells: [7, 6], spacing: [0.1, 0.1] };
            let boundaries = std::array::from_fn(|_| [boundary.clone(), boundary.clone()]);
            let problem = Problem::new(grid, vec![medium], vec![0; 42], boundaries, step, scheme);
            let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
            fill_with_noise(&problem.fields(), 42, |field, own| domain.set_field(field, own));
            let equations = rate_equations::<2>(&isotropic(theory, 1.0));
            let forms = [(equations.clone(), equations.symmetric_form().expect("elastic"))];
            let energy_of = |domain: &Domain<f64, 2>| {
                compute_energy((domain.fields(), &|own| domain.values(own)), &forms, &[0; 42], 0.01)
            };
            let mut last = energy_of(&domain);
            for _ in 0..20 {
                for _ in 0..1000 {
                    domain.advance();
                }
                let now = energy_of(&domain);
                assert!(now <= last * (1.0 + 1e-12), "{theory:?} {boundary:?}: {now} after {last}");
                last = now;
            }
        }
    }
}
