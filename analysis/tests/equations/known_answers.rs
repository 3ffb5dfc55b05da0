//! Published answers: verdict, order, coefficient and direction of each bundled case, over ranges of its numbers.

use super::linearised::{Assessed, assert_close};
use crate::support::states::seeded_generator;

/// Parameters of the μ(I) law of the bundled case.
const RHO: f64 = 1500.0;
const RHO_S: f64 = 2500.0;
const DIAMETER: f64 = 5e-4;
const MU_S: f64 = 0.342;
const MU_2: f64 = 0.557;
const I_0: f64 = 0.069;
const PRESSURE: f64 = 1000.0;

/// Shear rate at an inertial number and the pressure of the bundled cases.
fn rate_at(inertial: f64) -> f64 {
    inertial / (DIAMETER * (RHO_S / PRESSURE).sqrt())
}

/// μ and n = I μ'/μ of a law, by central differences in ln I of sixth order.
fn friction_and_slope(law: impl Fn(f64) -> f64, inertial: f64) -> [f64; 2] {
    let h = 1e-2;
    let at = |steps: f64| law(inertial * (steps * h).exp()).ln();
    let difference = |steps: f64| at(steps) - at(-steps);
    let n = (45.0 * difference(1.0) - 9.0 * difference(2.0) + difference(3.0)) / (60.0 * h);
    [law(inertial), n]
}

fn granular_law(inertial: f64) -> f64 {
    MU_S + (MU_2 - MU_S) / (1.0 + I_0 / inertial)
}

/// Barker, Schaeffer, Bohorquez & Gray (2015): positive where the shear is ill-posed, for |m| < 1 and n ≪ 1.
fn criterion([mu, n]: [f64; 2]) -> f64 {
    let m = mu * (1.0 - n / 2.0);
    4.0 * n * n - 4.0 * n + m * m
}

/// Coefficient of order 2: −(μp/(ργ̇)) min over x in [−1, 1] of [n − mx + (1 − n)x²]/(1 − mx), by Newton's iteration from
/// the best of a grid.
fn growth_coefficient([mu, n]: [f64; 2], rate: f64) -> f64 {
    let m = mu * (1.0 - n / 2.0);
    let f = |x: f64| (n - m * x + (1.0 - n) * x * x) / (1.0 - m * x);
    let best = (-1000..=1000).map(|i| f64::from(i) / 1000.0).min_by(|a, b| f(*a).total_cmp(&f(*b)));
    let mut x = best.expect("a grid");
    // Stationary where m (n − 1 + ... ) vanishes: numerator of f' is −m(1−n)x² + 2(1−n)x + m(n − 1).
    for _ in 0..50 {
        let numerator = (1.0 - n) * (2.0 * x - m * x * x - m);
        let slope = (1.0 - n) * (2.0 - 2.0 * m * x);
        x -= numerator / slope;
    }
    -(mu * PRESSURE / (RHO * rate)) * f(x)
}

fn shear(case: &str, rate: f64) -> Assessed {
    Assessed::new(case, &[format!("background.v1.d2={rate:?}")])
}

#[test]
fn granular_rheology_is_ill_posed_outside_two_neutral_inertial_numbers() {
    let is_ill = |inertial: f64| shear("mu-of-i", rate_at(inertial)).verdict() == "ill-posed";
    for (low, high, published) in [(1e-3, 1e-2, 0.003_971_782_7), (0.1, 1.0, 0.280_165_77)] {
        let (mut low, mut high): (f64, f64) = (low, high);
        assert_ne!(is_ill(low), is_ill(high));
        let was = is_ill(low);
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if is_ill(middle) == was { low = middle } else { high = middle }
        }
        println!("neutral inertial number {low}");
        assert!((low - published).abs() < 1e-8, "{low}, not {published}");
        // The sign of the criterion changes in the same place.
        let sign = |at: f64| criterion(friction_and_slope(granular_law, at)) > 0.0;
        assert_ne!(sign(low - 1e-8), sign(low + 1e-8));
    }
}

#[test]
fn granular_rheology_grows_at_the_published_rate() {
    let mut random = seeded_generator(1);
    let (mut ill, mut well) = (0, 0);
    for _ in 0..200 {
        let inertial = random.log_uniform(1e-5, 10.0);
        let found = shear("mu-of-i", rate_at(inertial));
        let law = friction_and_slope(granular_law, inertial);
        if criterion(law) > 0.0 {
            let (order, coefficient) = found.growth();
            assert_eq!(order, 2.0);
            assert_close(
                "coefficient",
                coefficient,
                growth_coefficient(law, rate_at(inertial)),
                1e-8,
            );
            ill += 1;
        } else {
            assert_eq!(found.verdict(), "well-posed", "I = {inertial}");
            well += 1;
        }
    }
    assert!(ill > 50 && well > 40, "{ill} ill-posed, {well} well-posed");
    // m ≥ 1: the coefficient of the highest power of ς vanishes in a direction.
    let sets = ["model.parameters.mu_s=1.3".to_owned(), "model.parameters.mu_2=1.5".to_owned()];
    let found = Assessed::new("mu-of-i", &sets);
    let verdict = &found.found.assessment.verdict;
    use wellposed_analysis::growth::Verdict;
    assert!(matches!(verdict, Verdict::IllPosed { growth: None, .. }), "{verdict:?}");
}

#[test]
fn regularised_rheology_is_well_posed_where_the_criterion_says() {
    let (mu_inf, alpha, i_1) = (0.05, 1.9, 0.004);
    let high = |i: f64| (MU_S * I_0 + MU_2 * i + mu_inf * i * i) / (I_0 + i);
    let a = i_1 * f64::exp(alpha / (high(i_1) * high(i_1)));
    let low = |i: f64| (alpha / (a / i).ln()).sqrt();
    assert!((low(i_1) - high(i_1)).abs() < 1e-14);
    let mut random = seeded_generator(2);
    let (mut ill, mut well) = (0, 0);
    let mut largest_well = 0.0f64;
    for _ in 0..200 {
        let inertial = random.log_uniform(1e-7, 100.0);
        if (inertial / i_1).ln().abs() < 0.1 {
            continue; // the differences would cross the joint of both branches
        }
        let law = if inertial < i_1 {
            friction_and_slope(low, inertial)
        } else {
            friction_and_slope(high, inertial)
        };
        let [mu, n] = law;
        let m = mu * (1.0 - n / 2.0);
        let found = shear("barker-gray", rate_at(inertial));
        if m >= 1.0 {
            assert_eq!(found.verdict(), "ill-posed");
            ill += 1;
        } else if criterion(law) > 0.0 && m < 2.0 * (1.0 - n) {
            assert_close(
                "coefficient",
                found.growth().1,
                growth_coefficient(law, rate_at(inertial)),
                1e-8,
            );
            ill += 1;
        } else {
            assert_eq!(found.verdict(), "well-posed", "I = {inertial}, n = {n}, m = {m}");
            largest_well = largest_well.max(inertial);
            well += 1;
        }
    }
    println!("well-posed up to I = {largest_well}; {ill} ill-posed, {well} well-posed");
    assert!(well > 100 && ill > 5, "{ill} ill-posed, {well} well-posed");
}

#[test]
fn viscous_fluids_are_well_posed_and_decay_about_rest() {
    for (name, scale) in [("navier-stokes", 1e-6), ("compressible-navier-stokes", 1e-5)] {
        let found = Assessed::new(name, &[]);
        assert_eq!(found.verdict(), "well-posed", "{name}");
        assert!(found.supremum().abs() < 1e-12 * scale, "{name}: {}", found.supremum());
    }
    // In shear the bound is the growth by the background gradient, half the shear rate at most.
    let found = Assessed::new("navier-stokes", &["background.v1={ value = 0, d2 = 4 }".to_owned()]);
    assert_eq!(found.verdict(), "well-posed");
    assert!(found.supremum() <= 2.0 + 1e-6, "{}", found.supremum());
}

#[test]
fn euler_equations_in_the_spinodal_region_grow_at_the_imaginary_sound_speed() {
    let (rt, a, b) = (8e4, 900.0, 1.7e-3);
    let mut random = seeded_generator(3);
    for _ in 0..50 {
        let rho = random.uniform(10.0, 560.0);
        let found = Assessed::new("euler-spinodal", &[format!("background.rho={rho:?}")]);
        let slope = rt / (1.0 - b * rho).powi(2) - 2.0 * a * rho;
        if slope < 0.0 {
            let (order, coefficient) = found.growth();
            assert_eq!(order, 1.0);
            assert_close("coefficient", coefficient, (-slope).sqrt(), 1e-10);
        } else {
            assert_eq!(found.verdict(), "well-posed", "ρ = {rho}, p' = {slope}");
        }
    }
}

#[test]
fn diffusion_is_ill_posed_for_negative_diffusivities_alone() {
    for kappa in [-3.0, -1e-6, 1e-6, 0.4] {
        let found = Assessed::new("heat", &[format!("model.parameters.kappa={kappa:?}")]);
        if kappa < 0.0 {
            assert_eq!(found.growth().0, 2.0);
            assert_close("coefficient", found.growth().1, -kappa, 1e-12);
        } else {
            assert_eq!(found.verdict(), "well-posed");
        }
    }
}

#[test]
fn phase_separation_has_the_largest_growth_rate_of_cahn() {
    let (mobility, a, kappa) = (2.0, 3.0, 0.05);
    for c in [0.0, 0.1, -0.4] {
        let found = Assessed::new("cahn-hilliard", &[format!("background.c={c:?}")]);
        assert_eq!(found.verdict(), "well-posed");
        let curvature: f64 = a * (3.0 * c * c - 1.0);
        let expected = mobility * curvature * curvature / (4.0 * kappa);
        assert_close("supremum", found.supremum(), expected, 1e-5);
    }
    // Without the gradient energy: backward diffusion of order 2; with a negative one: order 4.
    let sharp = Assessed::new("cahn-hilliard", &["model.parameters.kappa=0".to_owned()]);
    assert_eq!(sharp.growth().0, 2.0);
    assert_close("coefficient", sharp.growth().1, -mobility * a * (0.03 - 1.0), 1e-12);
    let wrong = Assessed::new("cahn-hilliard", &["model.parameters.kappa=-0.05".to_owned()]);
    assert_eq!(wrong.growth().0, 4.0);
    assert_close("coefficient", wrong.growth().1, mobility * kappa, 1e-12);
}

#[test]
fn two_fluids_grow_with_their_slip_velocity() {
    let (rho1, rho2) = (1000.0, 1.2);
    let mut random = seeded_generator(4);
    for _ in 0..50 {
        let [u1, u2] = [random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0)];
        let a1 = random.uniform(0.05, 0.95);
        let sets = [
            format!("background.a1={a1:?}"),
            format!("background.u1={u1:?}"),
            format!("background.u2={u2:?}"),
        ];
        let found = Assessed::new("two-fluids", &sets);
        let r2: f64 = rho2 * a1 / (rho1 * (1.0 - a1));
        assert_eq!(found.growth().0, 1.0);
        let expected = (u1 - u2).abs() * r2.sqrt() / (1.0 + r2);
        assert_close("coefficient", found.growth().1, expected, 1e-9);
    }
    for u in [0.7, -3.3, 1e3] {
        let sets = [format!("background.u1={u:?}"), format!("background.u2={u:?}")];
        assert_eq!(Assessed::new("two-fluids", &sets).verdict(), "marginal", "u = {u}");
    }
}

#[test]
fn layers_under_a_lid_are_ill_posed_above_the_critical_slip() {
    let (rho1, rho2, g, depth) = (1000.0, 1025.0, 9.81, 50.0);
    let mut random = seeded_generator(5);
    let mut ill = 0;
    for _ in 0..100 {
        let [u1, u2] = [random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0)];
        let h1 = random.uniform(5.0, 45.0);
        let h2 = depth - h1;
        let sets = [
            format!("background.h1={h1:?}"),
            format!("background.u1={u1:?}"),
            format!("background.u2={u2:?}"),
        ];
        let found = Assessed::new("two-layers", &sets);
        let slip = (u1 - u2) * (u1 - u2);
        let critical = g * (rho2 - rho1) * (rho1 * h2 + rho2 * h1) / (rho1 * rho2);
        if slip > critical {
            let (a, b) = (rho1 / h1, rho2 / h2);
            let imaginary = (a * b * slip - g * (rho2 - rho1) * (a + b)).sqrt() / (a + b);
            assert_eq!(found.growth().0, 1.0);
            assert_close("coefficient", found.growth().1, imaginary, 1e-9);
            ill += 1;
        } else {
            assert_eq!(found.verdict(), "well-posed", "slip {slip}, critical {critical}");
        }
    }
    assert!((20..=80).contains(&ill), "{ill} ill-posed");
}

#[test]
fn corotational_maxwell_fluid_is_ill_posed_above_half_a_weissenberg_number() {
    let (rho, modulus, time) = (1000.0, 100.0, 2.0);
    for weissenberg in [-0.8, -0.3, 0.2, 0.45, 0.55, 0.7, 3.0] {
        let rate: f64 = weissenberg / time;
        let stress = 2.0 * modulus * weissenberg;
        let sets = [
            format!("background.v1.d1={rate:?}"),
            format!("background.v2.d2={:?}", -rate),
            format!("background.s11={stress:?}"),
            format!("background.s22={:?}", -stress),
        ];
        let found = Assessed::new("corotational-maxwell", &sets);
        if weissenberg.abs() > 0.5 {
            let (order, coefficient) = found.growth();
            assert_eq!(order, 1.0);
            let excess = 2.0 * stress.abs() - 2.0 * modulus;
            assert_close("coefficient", coefficient, (excess / (2.0 * rho)).sqrt(), 1e-9);
            // Along the lesser principal axis.
            let direction = found.found.direction.as_ref().expect("ill-posed");
            let along = if weissenberg > 0.0 { direction[1] } else { direction[0] };
            assert!(along.abs() > 1.0 - 1e-9, "{direction:?}");
        } else {
            assert_eq!(found.verdict(), "well-posed", "{weissenberg}");
        }
    }
    for rate in [0.01, 0.5, 3.0, 100.0] {
        let w = rate * time;
        let s12: f64 = modulus * w / (1.0 + w * w);
        let sets = [
            format!("background.v1={{ value = 0, d2 = {rate:?} }}"),
            "background.v2.d2=0.0".to_owned(),
            format!("background.s12={s12:?}"),
            format!("background.s11={:?}", w * s12),
            format!("background.s22={:?}", -w * s12),
        ];
        let found = Assessed::new("corotational-maxwell", &sets);
        assert_eq!(found.verdict(), "well-posed", "shear rate {rate}");
    }
}

#[test]
fn dissipative_and_elastic_media_are_well_posed() {
    for name in [
        "upper-convected-maxwell",
        "von-mises-flow",
        "biot",
        "kelvin-voigt",
        "zener",
        "typed-cosserat",
    ] {
        let found = Assessed::new(name, &[]);
        assert_eq!(found.verdict(), "well-posed", "{name}: {:?}", found.found.assessment);
    }
    for name in ["biot", "kelvin-voigt", "zener", "typed-cosserat"] {
        let found = Assessed::new(name, &[]);
        // The largest root of the media at rest is 0; the unit is the decay rate of long waves.
        assert!(found.supremum() < 1e-9, "{name}: {}", found.supremum());
    }
    for rate in [0.01, 0.5, 20.0] {
        let w: f64 = 2.0 * rate;
        let sets = [
            format!("background.v1.d2={rate:?}"),
            format!("background.c11={:?}", 1.0 + 2.0 * w * w),
            format!("background.c12={w:?}"),
        ];
        let found = Assessed::new("upper-convected-maxwell", &sets);
        assert_eq!(
            found.verdict(),
            "well-posed",
            "shear rate {rate}: {:?}",
            found.found.assessment
        );
    }
}

/// A conformation tensor that is not positive definite is ill-posed (Rutkevich 1970): waves n with n·c·n < 0 grow as
/// √(−G n·c·n/ρ) k.
#[test]
fn indefinite_conformation_is_ill_posed() {
    // Steady by the sink of the relaxation alone: c at rest is 1, so the rate of change is asked for.
    let sets = [
        "background.v1.d2=0.0".to_owned(),
        "background.c11={ value = -0.5, dt = \"solve\" }".to_owned(),
        "background.c12=0.0".to_owned(),
    ];
    let found = Assessed::new("upper-convected-maxwell", &sets);
    assert_eq!(found.growth().0, 1.0);
    // In the plane an incompressible wave along n moves along t ⊥ n: ρ ς² = −G k² n·c·n.
    assert_close("coefficient", found.growth().1, (100.0f64 * 0.5 / 1000.0).sqrt(), 1e-9);
}

/// Barker, Schaeffer, Shearer & Gray (2017): three conditions suffice. All kept: well-posed; the second or the third broken:
/// ill-posed of order 2; the first, an equation, broken by little: no growth, by much: ill-posed.
#[test]
fn compressible_rheology_is_well_posed_where_the_three_conditions_hold() {
    let assess = |numbers: [f64; 7]| {
        let names = ["alpha0", "alpha1", "beta0", "beta1", "C0"];
        let mut sets: Vec<String> = names
            .iter()
            .zip(numbers)
            .map(|(name, value)| format!("model.parameters.{name}={value:?}"))
            .collect();
        sets.push(format!("background.p={:?}", numbers[5]));
        sets.push(format!("background.v1.d2={:?}", numbers[6]));
        Assessed::try_new("compressible-i-dependent", &sets)
    };
    let mut random = seeded_generator(6);
    let (mut kept, mut broken) = (0, [[0, 0]; 2]);
    for _ in 0..100 {
        let (alpha0, alpha1) = (random.uniform(0.2, 0.6), random.uniform(0.1, 1.0));
        let (c0, rate) = (random.uniform(5e3, 2e4), random.log_uniform(0.1, 100.0));
        // The laws hold where the shear stress Y is positive: p < α₀C, C = C₀φ.
        let pressure = random.uniform(0.05, 0.95) * alpha0 * c0 * 0.6;
        let state = [alpha0, alpha1, alpha0, alpha1 / 4.0, c0, pressure, rate];
        // Dilatancy so large that no shear is left has no state.
        let Ok(found) = assess(state) else { continue };
        assert_eq!(found.verdict(), "well-posed", "{state:?}: {:?}", found.found.assessment);
        kept += 1;
        let falling = [alpha0, -alpha1, alpha0, -alpha1 / 4.0, c0, pressure, rate];
        let unstable = [alpha0, alpha1, alpha0, alpha1 / 4.0, -20.0 * c0, pressure, rate];
        for (state, count) in [falling, unstable].into_iter().zip(&mut broken) {
            if let Ok(found) = assess(state) {
                let is_ill = found.verdict() == "ill-posed";
                count[usize::from(is_ill)] += 1;
                assert!(!is_ill || found.growth().0 == 2.0, "{state:?}");
            }
        }
    }
    let [second, third] = broken;
    println!(
        "{kept} states; second condition broken: {second:?} well-, ill-posed; third: {third:?}"
    );
    assert!(kept > 50, "{kept} states");
    // The conditions suffice and are not necessary.
    assert!(second[1] > 5 * second[0] && third[1] > 5 * third[0], "{broken:?}");
    let near = assess([0.35, 0.6, 0.3, 0.2, 1e4, 1000.0, 10.0]).expect("a state");
    assert_eq!(near.verdict(), "well-posed");
    let far = assess([0.35, 0.6, 2.5, -5.0, 1e4, 1000.0, 10.0]).expect("a state");
    assert_eq!(far.verdict(), "ill-posed");
}

/// Maxwell's fluid in space, ten unknowns: well-posed, and no wave in random directions grows faster than the bound.
#[test]
fn viscoelastic_fluid_in_space_is_well_posed() {
    let start = std::time::Instant::now();
    let found = Assessed::new("viscoelastic-space", &[]);
    assert_eq!(found.verdict(), "well-posed");
    let assessed = start.elapsed();
    let bound = found.supremum();
    println!("verdict in {assessed:.1?}, with the bound {bound} 1/s in {:.1?}", start.elapsed());
    let mut random = seeded_generator(7);
    for _ in 0..50 {
        let k = random.log_uniform(1e-6, 1e6);
        let angles = [random.uniform(0.0, 3.15), random.uniform(-1.57, 1.57)];
        let roots = found.workspace.roots(&found.model, k, angles[0], angles[1]).expect("finite");
        let wellposed_analysis::pencil::PencilRoots::Regular { finite, .. } = roots else {
            panic!("singular")
        };
        // The first root has the largest real part.
        assert!(finite[0].re <= bound + 1e-5 * bound.abs(), "{k} 1/m, {angles:?}: {}", finite[0]);
    }
}
