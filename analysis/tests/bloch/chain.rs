//! Chains of blocks and layers: published frequencies, closed forms, limits, and a scan of complex transfer matrices.

use super::media::{THICKNESSES, build_medium, build_single_block_chain, random_chain_elements};
use models::interface::opening_line::LayerMass;
use nalgebra::Matrix2;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use testkit::random::RandomNumbers;
use wellposed_analysis::bloch::BlochError;
use wellposed_analysis::bloch::chain::{
    BlochPhase, Chain, ChainElement, ChainPolarisation, LayerCompliance,
};

use ChainPolarisation::{Longitudinal, Transverse};

/// Verifies frequencies of longitudinal waves for layers of 0.1, 1 and 5 mm, in kHz at κh = π/4, π/2, π, to the five
/// published digits.
#[test]
fn frequencies_agree_with_published_table() {
    let table = [
        ["11.96405", "23.91230", "45.89261"],
        ["8.96731", "17.56580", "28.44161"],
        ["5.11290", "9.73241", "14.47159"],
    ];
    for (thickness, printed) in THICKNESSES.into_iter().zip(table) {
        let chain = build_single_block_chain(&build_medium(thickness), false, Longitudinal);
        for (shift, printed) in [0.25 * PI, 0.5 * PI, PI].into_iter().zip(printed) {
            let found = chain.frequency(0, shift).expect("a branch") / (1e3 * TAU);
            println!("δ = {thickness} m, κh = {shift:.4}: {found:.7} kHz");
            assert_eq!(format!("{found:.5}"), printed);
        }
    }
}

/// Verifies half the trace of the transfer matrix against closed forms of one block, with a box layer and with lumped
/// masses.
#[test]
fn half_trace_agrees_with_closed_forms() {
    let mut random = RandomNumbers::new(3);
    let mut worst = 0.0f64;
    for _ in 0..1000 {
        let [length, speed, z, m, c, omega] =
            std::array::from_fn(|_| 10f64.powf(random.uniform(-0.7, 0.7)));
        let half_trace = |mass: LayerMass<f64>| {
            let compliance = LayerCompliance::new_elastic(c);
            let chain = Chain::new(vec![
                ChainElement::Block { length, speed, impedance: z },
                ChainElement::Layer { mass, compliance },
            ]);
            chain.expect("valid").half_trace(Complex64::from(omega))[0].re
        };
        let theta = omega * length / speed;
        let (psi, y) = (2.0 * (0.5 * omega * (m * c).sqrt()).atan(), (m / c).sqrt());
        let expected = theta.cos() * psi.cos() - 0.5 * (z / y + y / z) * theta.sin() * psi.sin();
        let size = 1.0 + 0.5 * (z / y + y / z);
        worst = worst.max((half_trace(LayerMass::new_box(m)) - expected).abs() / size);
        let square = m * c * omega * omega;
        let [mass, spring] = [omega * m * (1.0 - 0.25 * square) / z, z * omega * c];
        let expected = (1.0 - 0.5 * square) * theta.cos() - 0.5 * (spring + mass) * theta.sin();
        let size = 1.0 + square + spring + mass.abs();
        worst = worst.max((half_trace(LayerMass::new_lumped(m)) - expected).abs() / size);
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-13, "{worst:e}");
}

/// Half the trace of the product of the complex transfer matrices of (v, σ), solved from the balances of each element.
fn complex_half_trace(elements: &[ChainElement], omega: f64) -> f64 {
    let i = Complex64::i();
    let matrix = |a: Complex64, b: Complex64, c: Complex64, d: Complex64| Matrix2::new(a, b, c, d);
    let one = Complex64::from(1.0);
    let mut product = Matrix2::identity();
    for element in elements {
        let next = match *element {
            ChainElement::Block { length, speed, impedance: z } => {
                // Superposition of two waves e^{∓iθ} with σ = ∓zv.
                let forward = (-i * omega * length / speed).exp();
                let modes = matrix(one, one, -z * one, z * one);
                let advance = Matrix2::from_diagonal(&[forward, forward.inv()].into());
                modes * advance * modes.try_inverse().expect("regular")
            }
            ChainElement::Layer { mass: LayerMass { mass, opening_mass }, compliance } => {
                // σ⁺ − σ⁻ = ½iωm(v⁺ + v⁻),  v⁺ − v⁻ = iωC[½(σ⁺ + σ⁻) − iωn(v⁺ − v⁻)].
                let inertia = 0.5 * i * omega * mass;
                let spring = 0.5 * i * omega * compliance.elastic;
                let diagonal = 1.0 - omega * omega * compliance.elastic * opening_mass;
                let after = matrix(-inertia, one, diagonal * one, -spring);
                let before = matrix(inertia, one, diagonal * one, spring);
                after.try_inverse().expect("regular") * before
            }
        };
        product = next * product;
    }
    0.5 * product.trace().re
}

/// Verifies, for random chains of one to three blocks, that the branches equal the roots of an independent half trace
/// found by a fine scan, and none is missing or found twice.
#[test]
fn branches_equal_a_scan_of_complex_transfer_matrices() {
    compare_branches(60);
}

/// Checks `count` random chains.
fn compare_branches(count: usize) {
    let mut random = RandomNumbers::new(11);
    let (mut worst, mut roots, mut missed) = (0.0f64, 0, 0);
    for _ in 0..count {
        let elements = random_chain_elements(&mut random);
        let chain = Chain::new(elements.clone()).expect("valid");
        let shift: f64 = random.uniform(0.02, PI - 0.02);
        let (max, steps) = (12.0 * chain.long_wave_speed() / chain.period(), 20_000);
        let found = chain.frequencies_below(shift, max).expect("branches");
        assert!(found.is_sorted_by(|a, b| a < b), "{found:?}");
        let difference = |omega: f64| complex_half_trace(&elements, omega) - shift.cos();
        let mut expected = Vec::new();
        let mut before = difference(1e-9);
        for step in 1..=steps {
            let omega = |step: i32| max * f64::from(step) / f64::from(steps);
            let after = difference(omega(step));
            if (before > 0.0) != (after > 0.0) {
                let (mut lower, mut upper) = (omega(step - 1), omega(step));
                for _ in 0..60 {
                    let middle = 0.5 * (lower + upper);
                    match (difference(middle) > 0.0) == (before > 0.0) {
                        true => lower = middle,
                        false => upper = middle,
                    }
                }
                expected.push(upper);
            }
            before = after;
        }
        // Two roots within one step of the scan are missed by the scan, in pairs.
        roots += found.len();
        if found.len() != expected.len() {
            missed += 1;
            assert_eq!((found.len() - expected.len()) % 2, 0);
            continue;
        }
        for (found, expected) in found.iter().zip(&expected) {
            worst = worst.max((found / expected - 1.0).abs());
        }
    }
    println!("{roots} roots, worst {worst:e}, chains with pairs below the scan {missed}");
    assert!(worst < 1e-11 && 40 * missed < count, "{worst:e} {missed}");
}

/// Verifies the band edges of a box layer: tan ½θ = −r^±1 tan ½ψ at κh = 0, tan ½θ tan ½ψ = r^±1 at κh = π, r = z/z′;
/// modes symmetric or antisymmetric about the block.
#[test]
fn band_edges_are_symmetric_and_antisymmetric_modes() {
    let mut worst = 0.0f64;
    for thickness in THICKNESSES {
        for polarisation in [Longitudinal, Transverse] {
            let medium = build_medium(thickness);
            let chain = build_single_block_chain(&medium, false, polarisation);
            let (c, k) = match polarisation {
                Longitudinal => (5000.0, medium.layer_stiffness()[0]),
                Transverse => (3000.0, medium.layer_stiffness()[1]),
            };
            let m = medium.layer.mass();
            let r = 2700.0 * c / (m * k).sqrt();
            for band in 0..6 {
                let [lower, upper] = chain.band_edges(band).expect("a band");
                assert_eq!(
                    upper,
                    chain.frequency(band, if band % 2 == 0 { PI } else { 0.0 }).expect("edge")
                );
                for (edge, shift) in [(lower, band % 2 == 1), (upper, band % 2 == 0)] {
                    let half = 0.5 * edge * medium.period / c;
                    let psi = (0.5 * edge * (m / k).sqrt()).atan();
                    let residual = |power: f64| match shift {
                        true => half.sin() * psi.sin() - r.powf(power) * half.cos() * psi.cos(),
                        false => half.sin() * psi.cos() + r.powf(power) * half.cos() * psi.sin(),
                    };
                    let scale = r.max(1.0 / r) * (1.0 + half);
                    worst = worst.max(residual(1.0).abs().min(residual(-1.0).abs()) / scale);
                }
            }
        }
    }
    println!("worst residual {worst:e}");
    assert!(worst < 1e-14, "{worst:e}");
}

/// Verifies two limits: welded layers give classical waves folded into the Brillouin zone, without gaps; soft massless
/// layers give free blocks.
#[test]
fn welded_and_soft_layers_reach_their_limits() {
    let chain = |compliance: f64, parts: usize| {
        let block =
            ChainElement::Block { length: 0.05 / parts as f64, speed: 5000.0, impedance: 1.35e7 };
        let layer = ChainElement::Layer {
            mass: LayerMass::new_box(0.0),
            compliance: LayerCompliance::new_elastic(compliance),
        };
        let mut elements = vec![block; parts];
        elements.push(layer);
        Chain::new(elements).expect("valid")
    };
    for parts in [1, 3] {
        let welded = chain(0.0, parts);
        for shift in [0.0, 0.3, 1.7, 3.0, PI, -0.3, TAU + 0.3] {
            for branch in 0..40 {
                let reduced = f64::min(shift.rem_euclid(TAU), TAU - shift.rem_euclid(TAU));
                let turns = match branch % 2 {
                    0 => branch as f64 * PI + reduced,
                    _ => (branch + 1) as f64 * PI - reduced,
                };
                let expected = 1e5 * turns;
                let found = welded.frequency(branch, shift).expect("a branch");
                assert!((found - expected).abs() <= 1e-13 * expected, "{found} {expected}");
            }
        }
        assert_eq!(welded.gaps_below(1e7).expect("gaps"), vec![]);
        // Soft: K → 0. Free blocks ω = jπc/h for j ≥ 1; a lattice of rigid masses below.
        let stiffness = 1e6;
        let soft = chain(1.0 / stiffness, parts);
        let lattice = 2.0 * (stiffness / 135.0f64).sqrt() * (0.5f64).sin();
        assert!((soft.frequency(0, 1.0).expect("a branch") / lattice - 1.0).abs() < 1e-5);
        for branch in 1..20 {
            let free = branch as f64 * PI * 1e5;
            let found = soft.frequency(branch, 1.0).expect("a branch");
            assert!((found / free - 1.0).abs() < 1e-5, "{found} {free}");
        }
    }
}

/// Verifies that box and lumped masses agree for long waves to second order and have the long-wave speed, that the
/// group speed is the slope of the branch, and the attenuation in gaps.
#[test]
fn long_waves_agree_and_group_speed_is_the_slope() {
    for thickness in THICKNESSES {
        let chains = [false, true]
            .map(|l| build_single_block_chain(&build_medium(thickness), l, Longitudinal));
        let speed = chains[0].long_wave_speed();
        assert_eq!(speed, chains[1].long_wave_speed());
        assert_eq!(chains[0].phase_speed(0, 0.0), Ok(speed));
        assert!((chains[0].phase_speed(0, -1e-4).expect("a speed") / speed - 1.0).abs() < 1e-9);
        let at = |chain: &Chain, shift: f64| chain.frequency(0, shift).expect("a branch");
        let mut differences = Vec::new();
        for shift in [0.2, 0.1, 0.05] {
            let [boxed, lumped] = chains.each_ref().map(|chain| at(chain, shift) * 0.05 / shift);
            let difference = ((boxed - speed) / speed, (lumped - boxed) / speed);
            println!("δ = {thickness}: κh = {shift}: dispersion and difference {difference:?}");
            differences.push(difference);
        }
        for pair in differences.windows(2) {
            let order = |a: f64, b: f64| (a / b).log2();
            assert!((order(pair[0].0, pair[1].0) - 2.0).abs() < 0.05);
            assert!((order(pair[0].1, pair[1].1) - 2.0).abs() < 0.05);
        }
        for chain in &chains {
            for branch in 0..3 {
                for shift in [0.3, 1.5, 2.9] {
                    let step = 1e-4;
                    let difference = (branch_frequency(chain, branch, shift + step)
                        - branch_frequency(chain, branch, shift - step))
                        / (2.0 * step);
                    let frequency = branch_frequency(chain, branch, shift);
                    let found = chain.group_speed(frequency).expect("a speed");
                    assert!((found / (0.05 * difference.abs()) - 1.0).abs() < 1e-6);
                    let complex = chain.complex_phase_shift(frequency).expect("a phase");
                    assert!((complex - shift).norm() < 1e-9, "{complex} {shift}");
                }
            }
            let gaps = chain.gaps_below(2e6).expect("gaps");
            assert!(gaps.len() >= 2);
            for gap in gaps {
                let middle = 0.5 * (gap.lower + gap.upper);
                let complex = chain.complex_phase_shift(middle).expect("a phase");
                let BlochPhase::Gap { bands_below, attenuation } =
                    chain.bloch_phase(middle).expect("a phase")
                else {
                    panic!("{gap:?}");
                };
                assert_eq!(bands_below, gap.bands_below);
                assert!((complex.im + attenuation).abs() < 1e-12 && attenuation > 0.0);
                assert_eq!(chain.group_speed(middle), Ok(0.0));
            }
        }
    }
}

fn branch_frequency(chain: &Chain, branch: usize, shift: f64) -> f64 {
    chain.frequency(branch, shift).expect("a branch")
}

/// Verifies, for viscous layers, complex wave numbers at real frequencies, damped waves at real wave numbers, and both
/// limits of the retardation time.
#[test]
fn viscous_layers_attenuate_and_damp() {
    let medium = build_medium(1e-3);
    let [elastic, delayed] = [medium.layer.tangential_compliance(); 2];
    let chain = |time: f64| {
        let compliance =
            LayerCompliance { elastic, delayed: 2.0 * delayed, retardation_time: time };
        let mass = LayerMass::new_box(medium.layer.mass());
        Chain::new(vec![
            ChainElement::from_block(&medium.block, medium.period, Transverse),
            ChainElement::Layer { mass, compliance },
        ])
        .expect("valid")
    };
    let viscous = chain(4e-5);
    assert_eq!(viscous.frequency(0, 1.0), Err(BlochError::ViscousLayer { element: 1 }));
    let mut worst = 0.0f64;
    for omega in [1e3, 1e4, 1e5, 3e5, 1e6] {
        let shift = viscous.complex_phase_shift(omega).expect("a phase");
        let compliance = elastic + 2.0 * delayed / Complex64::new(1.0, omega * 4e-5);
        let (m, z, theta) = (medium.layer.mass(), 2700.0 * 3000.0, omega * 0.05 / 3000.0);
        let psi = 2.0 * (0.5 * omega * (m * compliance).sqrt()).atan();
        let y = (m / compliance).sqrt();
        let expected = theta.cos() * psi.cos() - 0.5 * (z / y + y / z) * theta.sin() * psi.sin();
        worst = worst.max((shift.cos() - expected).norm() / expected.norm());
        println!("ω = {omega:e}: κh = {shift}");
        assert!(shift.im < 0.0);
    }
    for branch in 0..4 {
        for shift in [0.3, 1.0, 2.5, PI] {
            let omega = viscous.damped_frequency(branch, shift).expect("a wave");
            let [half_trace, slope] = viscous.half_trace(omega);
            worst = worst.max(((half_trace - shift.cos()) / (slope * omega)).norm());
            // Modes that do not shear the layer are not damped.
            assert!(omega.im > -1e-14 * omega.re, "{omega}");
            // Hardly viscous: frequencies of the instantaneous and of the relaxed compliance.
            let simple = |compliance: f64| {
                let compliance = LayerCompliance::new_elastic(compliance);
                let mass = LayerMass::new_box(medium.layer.mass());
                let block = ChainElement::from_block(&medium.block, medium.period, Transverse);
                Chain::new(vec![block, ChainElement::Layer { mass, compliance }])
                    .and_then(|chain| chain.frequency(branch, shift))
                    .expect("a branch")
            };
            let slow = chain(1e3).damped_frequency(branch, shift).expect("a wave");
            assert!((slow / simple(elastic) - 1.0).norm() < 1e-6, "{slow}");
            let fast = chain(1e-11).damped_frequency(branch, shift).expect("a wave");
            assert!((fast / simple(elastic + 2.0 * delayed) - 1.0).norm() < 1e-4, "{fast}");
        }
    }
    println!("worst {worst:e}");
    assert!(worst < 1e-11, "{worst:e}");
}

/// Verifies, for impedance contrasts of up to twelve decades, that the Bloch phase never decreases with the frequency
/// and that the frequencies of branches are its inverse.
#[test]
fn bloch_phase_is_monotonic_for_extreme_contrasts() {
    let mut random = RandomNumbers::new(5);
    let (mut largest_decrease, mut worst, mut narrow) = (0.0f64, 0.0f64, 0);
    for _ in 0..400 {
        let mut elements = random_chain_elements(&mut random);
        for element in &mut elements {
            let factor = 10f64.powf(random.uniform(-6.0, 6.0));
            match element {
                ChainElement::Block { impedance, .. } => *impedance *= factor.sqrt(),
                ChainElement::Layer { mass, compliance } => {
                    *mass = LayerMass {
                        mass: mass.mass * factor,
                        opening_mass: mass.opening_mass * factor,
                    };
                    compliance.elastic *= 10f64.powf(random.uniform(-6.0, 6.0));
                }
            }
        }
        let chain = Chain::new(elements).expect("valid");
        let total = |omega: f64| match chain.bloch_phase(omega).expect("a phase") {
            BlochPhase::Band { band, phase } => band as f64 + phase / PI,
            BlochPhase::Gap { bands_below, .. } => bands_below as f64,
        };
        let mut before = 0.0;
        for step in 1..=2000 {
            let now = total(0.01 * f64::from(step));
            largest_decrease = largest_decrease.max(before - now);
            before = now;
        }
        let shift = random.uniform(0.1, 3.0);
        let mut last = 0.0;
        for branch in 0..6 {
            let omega = chain.frequency(branch, shift).expect("a branch");
            assert!(omega >= last * (1.0 - 1e-12));
            last = omega;
            let [lower, upper] = chain.band_edges(branch).expect("a band");
            let slack = 1e-12 * omega;
            assert!(
                lower <= omega + slack && omega <= upper + slack,
                "{branch} {lower} {omega} {upper} {chain:?}"
            );
            // In bands narrower than 1e-6 the phase is not resolved by the rounding of the frequency.
            if upper - lower < 1e-6 * upper {
                narrow += 1;
                continue;
            }
            let target = if branch % 2 == 0 { shift } else { PI - shift };
            worst = worst.max((total(omega) - branch as f64 - target / PI).abs());
        }
    }
    println!("largest decrease {largest_decrease:e}, worst phase {worst:e}, narrow bands {narrow}");
    assert!(largest_decrease < 1e-9 && worst < 1e-7);
}

/// Verifies that invalid chains are rejected with typed errors.
#[test]
fn invalid_chains_are_rejected() {
    let block = ChainElement::Block { length: 1.0, speed: 1.0, impedance: 1.0 };
    let layer = |mass: f64, opening_mass: f64, compliance: f64| ChainElement::Layer {
        mass: LayerMass { mass, opening_mass },
        compliance: LayerCompliance::new_elastic(compliance),
    };
    for (elements, expected) in [
        (vec![], "elements"),
        (vec![layer(1.0, 0.0, 1.0)], "elements"),
        (vec![block, layer(1.0, 0.3, 1.0)], "opening_mass"),
        (vec![block, layer(1.0, 0.0, f64::INFINITY)], "compliance"),
        (vec![block, layer(-1.0, 0.0, 1.0)], "mass"),
    ] {
        match Chain::new(elements) {
            Err(BlochError::Input(error)) => assert_eq!(error.input, expected),
            other => panic!("{other:?}"),
        }
    }
    let chain = Chain::new(vec![block]).expect("valid");
    assert!(matches!(chain.frequency(0, f64::NAN), Err(BlochError::Input(_))));
    assert!(matches!(chain.bloch_phase(-1.0), Err(BlochError::Input(_))));
}

#[test]
#[ignore = "takes some seconds"]
fn branches_of_many_chains_equal_a_scan_of_complex_transfer_matrices() {
    compare_branches(200);
}
