//! Independent reference for the face laws: the differential equations of a layer between two half-spaces, with a
//! material law in rate form that switches between modes (elastic, slipping, open), integrated by the classical
//! Runge–Kutta method. Switches are located by bisection.
//!
//! With given R±(t), z̄ = ½(z⁺ + z⁻) and Δz = z⁺ − z⁻: d = (R⁺ − R⁻ − Δz V − 2S)/z̄ and
//! mV̇ = R⁺ + R⁻ − 2z̄V − ½Δz d.

use crate::interface::support::{
    ELASTIC, IMPEDANCES, PORES, SATURATED, VISCOUS, plastic_constants,
};
use wellposed_models::interface::history;
use wellposed_models::interface::layer::{LayerLaw, MAX_HISTORY_VARIABLES};
use wellposed_models::interface::parameters::{LayerMaterial, TangentialConstants};
use wellposed_models::interface::{FaceLaw, Interval, RiemannData};

/// Load: Riemann invariants R⁻ and R⁺ of each component as a function of the time.
type InvariantLoad = fn(f64) -> [[f64; 2]; 2];

/// State of a layer: velocities V_n and V_t, normal state (S_n or ε), S_t, delayed traction s or slip χ, and velocity w
/// of the fluid.
type LayerState = [f64; 6];

/// Duration of every load.
const DURATION: f64 = 4.0;

/// Material law of the reference.
#[derive(Clone, Copy)]
enum ReferenceMaterial {
    Elastic,
    /// Shear strength, friction, hardening.
    Plastic([f64; 3]),
    Viscous,
    Porous,
    Saturated,
    /// Friction.
    Cracked(f64),
}

/// Value of [`RateMode::slip_sign`] at the apex of the yield cone.
const APEX_SLIP: f64 = 2.0;

/// Mode of a material law: sign of the slip (0 without slip, [`APEX_SLIP`] at the apex), and whether pores or crack are
/// open.
#[derive(Clone, Copy, Debug, PartialEq)]
struct RateMode {
    slip_sign: f64,
    is_open: bool,
}

/// A layer under a load, with its differential equations.
struct RateLayer {
    material: ReferenceMaterial,
    mass: [f64; 2],
    load: InvariantLoad,
}

/// Normal modulus ρ′c₁′² of the elastic layer.
fn normal_modulus() -> f64 {
    ELASTIC.density * ELASTIC.longitudinal_speed.powi(2)
}

impl RateLayer {
    /// Tractions S by component.
    fn stress(&self, mode: RateMode, y: &LayerState) -> [f64; 2] {
        let normal = match self.material {
            ReferenceMaterial::Elastic
            | ReferenceMaterial::Plastic(_)
            | ReferenceMaterial::Viscous => y[2],
            ReferenceMaterial::Porous => {
                let collapsed = if mode.is_open { 0.0 } else { PORES.porosity + y[2] };
                normal_modulus() * y[2] + PORES.collapse_stiffness * collapsed
            }
            ReferenceMaterial::Saturated => {
                let pores = SATURATED.pores;
                let collapsed = if mode.is_open { 0.0 } else { pores.porosity + y[2] };
                SATURATED.undrained_stiffness * y[2] + pores.collapse_stiffness * collapsed
            }
            ReferenceMaterial::Cracked(_) => {
                if mode.is_open {
                    0.0
                } else {
                    normal_modulus() * y[2]
                }
            }
        };
        let open_crack = matches!(self.material, ReferenceMaterial::Cracked(_)) && mode.is_open;
        let shear = match self.material {
            ReferenceMaterial::Cracked(friction) if mode.slip_sign != 0.0 => {
                mode.slip_sign * friction * -normal
            }
            _ => y[3],
        };
        [normal, if open_crack { 0.0 } else { shear }]
    }

    /// Opening rates d by component.
    fn opening_rate(&self, mode: RateMode, time: f64, y: &LayerState) -> [f64; 2] {
        let (stress, load) = (self.stress(mode, y), (self.load)(time));
        std::array::from_fn(|i| {
            let [z, x] = IMPEDANCES[i];
            (load[i][1] - load[i][0] - (x - z) * y[i] - 2.0 * stress[i]) / (0.5 * (z + x))
        })
    }

    /// Time derivative of the state.
    fn state_rate(&self, mode: RateMode, time: f64, y: &LayerState) -> LayerState {
        let load = (self.load)(time);
        let d = self.opening_rate(mode, time, y);
        let mut rate = [0.0; 6];
        for i in 0..2 {
            let [z, x] = IMPEDANCES[i];
            rate[i] =
                (load[i][0] + load[i][1] - (z + x) * y[i] - 0.5 * (x - z) * d[i]) / self.mass[i];
        }
        let compliance = [ELASTIC.normal_compliance(), ELASTIC.tangential_compliance()];
        let thickness = ELASTIC.thickness;
        rate[2] = d[0] / compliance[0];
        rate[3] = d[1] / compliance[1];
        match self.material {
            ReferenceMaterial::Elastic => {}
            ReferenceMaterial::Plastic([_, k, _]) if mode.slip_sign == APEX_SLIP => {
                [rate[2], rate[3], rate[4]] = [0.0, 0.0, d[0] / k];
            }
            ReferenceMaterial::Plastic([_, k, h]) if mode.slip_sign != 0.0 => {
                let sign = mode.slip_sign;
                let slip = (k * rate[2] + sign * rate[3])
                    / (k * k / compliance[0] + 1.0 / compliance[1] + h);
                rate[2] -= slip * k / compliance[0];
                rate[3] -= slip * sign / compliance[1];
                rate[4] = slip;
            }
            ReferenceMaterial::Plastic(_) => {}
            ReferenceMaterial::Viscous | ReferenceMaterial::Saturated => {
                let (stress, delayed) = (y[3], y[4]);
                let flow = thickness / VISCOUS.viscosity * (stress - delayed);
                rate[4] = flow / (thickness * VISCOUS.delayed_compliance);
                let instant = match self.material {
                    ReferenceMaterial::Viscous => compliance[1],
                    _ => thickness * SATURATED.instantaneous_compliance,
                };
                rate[3] = (d[1] - flow) / instant;
                if let ReferenceMaterial::Saturated = self.material {
                    rate[2] = d[0] / thickness;
                    let [fluid, added] = [SATURATED.fluid_density, SATURATED.added_density];
                    rate[5] = rate[1] * added / (fluid + added);
                }
            }
            ReferenceMaterial::Porous => rate[2] = d[0] / thickness,
            ReferenceMaterial::Cracked(friction) => {
                rate[2] = d[0] / thickness;
                if mode.is_open {
                    rate[3] = 0.0;
                } else if mode.slip_sign != 0.0 {
                    let normal_rate = normal_modulus() * rate[2];
                    let rate_of_limit = mode.slip_sign * friction * -normal_rate;
                    rate[4] = mode.slip_sign * (d[1] - compliance[1] * rate_of_limit);
                    rate[3] = rate_of_limit;
                }
            }
        }
        rate
    }

    /// Functions that are positive within the mode, each with the mode that follows when it becomes negative.
    fn mode_margins(&self, mode: RateMode, time: f64, y: &LayerState) -> Vec<(f64, RateMode)> {
        let slip_margin = |limit: f64, rate: f64| {
            if mode.slip_sign == 0.0 {
                let slip = if y[3] > 0.0 { 1.0 } else { -1.0 };
                (limit - y[3].abs(), RateMode { slip_sign: slip, ..mode })
            } else {
                (rate, RateMode { slip_sign: 0.0, ..mode })
            }
        };
        let pore_margin = |porosity: f64| {
            let x = porosity + y[2];
            (if mode.is_open { x } else { -x }, RateMode { is_open: !mode.is_open, slip_sign: 0.0 })
        };
        match self.material {
            ReferenceMaterial::Elastic | ReferenceMaterial::Viscous => vec![],
            ReferenceMaterial::Plastic([_, k, _]) if mode.slip_sign == APEX_SLIP => {
                // The opening rate is in the normal cone of the apex.
                let [normal, shear] = self.opening_rate(mode, time, y);
                vec![(normal - k * shear.abs(), RateMode { slip_sign: shear.signum(), ..mode })]
            }
            ReferenceMaterial::Plastic([strength, k, h]) => {
                let rate = self.state_rate(mode, time, y)[4];
                let apex = (mode.slip_sign * y[3], RateMode { slip_sign: APEX_SLIP, ..mode });
                vec![slip_margin(strength + h * y[4] - k * y[2], rate), apex]
            }
            ReferenceMaterial::Porous => vec![pore_margin(PORES.porosity)],
            ReferenceMaterial::Saturated => vec![pore_margin(SATURATED.pores.porosity)],
            ReferenceMaterial::Cracked(friction) => {
                let mut margins = vec![pore_margin(0.0)];
                if friction < 1e6 && !mode.is_open {
                    let rate = self.state_rate(mode, time, y)[4];
                    margins.push(slip_margin(friction * normal_modulus() * -y[2], rate));
                }
                margins
            }
        }
    }

    /// State after a step of length `h` by the classical Runge–Kutta method.
    fn step_runge_kutta(&self, mode: RateMode, time: f64, y: &LayerState, h: f64) -> LayerState {
        let add = |rate: &LayerState, h: f64| std::array::from_fn(|i| y[i] + h * rate[i]);
        let a = self.state_rate(mode, time, y);
        let b = self.state_rate(mode, time + 0.5 * h, &add(&a, 0.5 * h));
        let c = self.state_rate(mode, time + 0.5 * h, &add(&b, 0.5 * h));
        let d = self.state_rate(mode, time + h, &add(&c, h));
        std::array::from_fn(|i| y[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]))
    }

    /// State at [`DURATION`], and the numbers of switches and of switches to the apex.
    fn integrate(&self, mut mode: RateMode, mut y: LayerState) -> (LayerState, [usize; 2]) {
        let (mut time, mut switches, mut apex_switches) = (0.0, 0, 0);
        const TIME_STEP: f64 = 5e-4;
        while time < DURATION {
            let mut h = TIME_STEP.min(DURATION - time);
            let mut next = self.step_runge_kutta(mode, time, &y, h);
            let left = |time: f64, y: &LayerState| {
                self.mode_margins(mode, time, y).into_iter().find(|(margin, _)| *margin < 0.0)
            };
            let mut new_mode = mode;
            if left(time + h, &next).is_some() {
                let (mut low, mut high) = (0.0, h);
                while high - low > 1e-15 {
                    let middle = 0.5 * (low + high);
                    let state = self.step_runge_kutta(mode, time, &y, middle);
                    match left(time + middle, &state) {
                        Some(_) => high = middle,
                        None => low = middle,
                    }
                    if middle == 0.5 * (low + high) {
                        break;
                    }
                }
                h = high;
                next = self.step_runge_kutta(mode, time, &y, h);
                if let Some((_, after)) = left(time + h, &next) {
                    new_mode = after;
                    switches += 1;
                    let opens =
                        matches!(self.material, ReferenceMaterial::Cracked(_)) && after.is_open;
                    if opens || after.slip_sign == APEX_SLIP || mode.slip_sign == APEX_SLIP {
                        next[3] = 0.0;
                    }
                    apex_switches += usize::from(after.slip_sign == APEX_SLIP);
                }
            }
            y = next;
            mode = new_mode;
            time += h;
        }
        (y, [switches, apex_switches])
    }
}

/// Law of the crate for the material of the reference.
fn to_layer_law(material: ReferenceMaterial) -> LayerLaw<f64> {
    let material = match material {
        ReferenceMaterial::Elastic => LayerMaterial::Elastic(ELASTIC),
        ReferenceMaterial::Plastic([strength, friction, hardening]) => {
            LayerMaterial::Plastic(ELASTIC, plastic_constants(strength, friction, hardening))
        }
        ReferenceMaterial::Viscous => LayerMaterial::Viscous(ELASTIC, VISCOUS),
        ReferenceMaterial::Porous => {
            LayerMaterial::Porous(ELASTIC, PORES, TangentialConstants::Elastic)
        }
        ReferenceMaterial::Saturated => LayerMaterial::Saturated(SATURATED),
        ReferenceMaterial::Cracked(friction) => {
            LayerMaterial::Cracked(ELASTIC, (friction < 1e6).then_some(friction))
        }
    };
    material.to_law(Default::default())
}

/// State of the face law at [`DURATION`] after `steps` steps, with the load averaged over each step by the Gauss rule
/// of three points.
fn solve_face(
    material: ReferenceMaterial,
    load: InvariantLoad,
    initial: &LayerState,
    steps: usize,
) -> LayerState {
    let law = to_layer_law(material);
    let mut history = [0.0; MAX_HISTORY_VARIABLES];
    let is_saturated = matches!(material, ReferenceMaterial::Saturated);
    let last = match material {
        ReferenceMaterial::Viscous | ReferenceMaterial::Saturated => history::DELAYED_STRESS,
        _ => history::SLIP,
    };
    let indices = [
        history::NORMAL_MOTION,
        history::SHEAR_MOTION,
        history::NORMAL_STATE,
        history::SHEAR_STRESS,
    ];
    for (value, index) in initial.iter().zip(indices) {
        history[index] = *value;
    }
    history[last] = initial[4];
    let step = DURATION / steps as f64;
    for number in 0..steps {
        let middle = (number as f64 + 0.5) * step;
        let offset = 0.5 * step * 0.6f64.sqrt();
        let loads = [load(middle - offset), load(middle), load(middle + offset)];
        let incoming = std::array::from_fn(|i| RiemannData {
            impedance: IMPEDANCES[i],
            invariant: std::array::from_fn(|side| {
                (5.0 * (loads[0][i][side] + loads[2][i][side]) + 8.0 * loads[1][i][side]) / 18.0
            }),
        });
        let interval = Interval::new((number + 1) as f64 * step, step);
        law.advance(&incoming, &interval, &mut history);
    }
    let fluid = if is_saturated { history[history::FLUID_VELOCITY] } else { 0.0 };
    let [a, b, c, d] = indices.map(|index| history[index]);
    [a, b, c, d, history[last], fluid]
}

/// Largest absolute difference of the components of two states.
fn max_difference(one: &LayerState, other: &LayerState) -> f64 {
    one.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Errors of the face law against the reference for 2^7 … 2^12 steps, the error of Romberg's extrapolation, and the
/// number of switches.
fn compare_with_reference(
    material: ReferenceMaterial,
    load: InvariantLoad,
    mode: RateMode,
    initial: LayerState,
) -> (Vec<f64>, f64, [usize; 2]) {
    let mass = match material {
        ReferenceMaterial::Saturated => [
            SATURATED.thickness * (SATURATED.skeleton_density + SATURATED.fluid_density),
            SATURATED.thickness
                * (SATURATED.skeleton_density
                    + 1.0 / (1.0 / SATURATED.fluid_density + 1.0 / SATURATED.added_density)),
        ],
        _ => [ELASTIC.mass(); 2],
    };
    let (reference, switches) = RateLayer { material, mass, load }.integrate(mode, initial);
    let mut row: Vec<LayerState> =
        (7..13).map(|power| solve_face(material, load, &initial, 1 << power)).collect();
    let errors = row.iter().map(|state| max_difference(state, &reference)).collect();
    let mut factor = 1.0;
    while row.len() > 1 {
        factor *= 4.0;
        row = row
            .windows(2)
            .map(|pair| {
                std::array::from_fn(|i| pair[1][i] + (pair[1][i] - pair[0][i]) / (factor - 1.0))
            })
            .collect();
    }
    (errors, max_difference(&row[0], &reference), switches)
}

/// Mode at rest: no slip, pores open.
const REST_MODE: RateMode = RateMode { slip_sign: 0.0, is_open: true };
/// Initial state: velocities only.
const INITIAL_STATE: LayerState = [0.1, -0.2, 0.0, 0.0, 0.0, 0.0];

fn step_load(_: f64) -> [[f64; 2]; 2] {
    [[0.03, -0.05], [0.04, 0.02]]
}

fn sine_load(t: f64) -> [[f64; 2]; 2] {
    [[0.1 * (2.0 * t).sin(), 0.0], [0.0, 0.1 * (3.0 * t).sin()]]
}

fn random_load(t: f64) -> [[f64; 2]; 2] {
    let waves = |phases: [f64; 3]| {
        0.05 * ((1.3 * t + phases[0]).sin()
            + (2.9 * t + phases[1]).cos()
            + (4.7 * t + phases[2]).sin())
    };
    [
        [waves([0.3, 1.7, 2.9]), waves([4.1, 0.2, 5.5])],
        [waves([1.1, 3.6, 0.8]), waves([2.2, 6.0, 1.9])],
    ]
}

/// Compression and a growing shear, which keeps the layer slipping in one direction.
fn slipping_load(t: f64) -> [[f64; 2]; 2] {
    [[0.5 + 0.1 * (2.0 * t).sin(), -0.4], [-0.9 - 0.2 * t, 0.05 * (3.0 * t).sin()]]
}

fn compressing_load(t: f64) -> [[f64; 2]; 2] {
    [[2.0 + 0.1 * (2.0 * t).sin(), -1.8], [0.3 * (3.0 * t).cos(), 0.2]]
}

/// Tension and shear that take an elastic-plastic layer to the apex of its yield cone and back.
fn apex_load(t: f64) -> [[f64; 2]; 2] {
    [
        [-0.5 * (2.1 * t).sin(), 0.3 * (1.7 * t).sin()],
        [0.3 * (3.3 * t).sin(), 0.1 * (2.0 * t).cos()],
    ]
}

/// Compression with short tensions, so that a crack opens and closes.
fn opening_load(t: f64) -> [[f64; 2]; 2] {
    [[0.2 + 0.6 * (5.9 * t).sin(), -0.2 - 0.1 * (2.7 * t).cos()], switching_load(t)[1]]
}

/// Loads with switches: alternating shear under alternating compression.
fn switching_load(t: f64) -> [[f64; 2]; 2] {
    [
        [0.5 + 0.9 * (1.9 * t).sin(), -0.5 - 0.7 * (2.7 * t).cos()],
        [1.1 * (2.3 * t).sin(), 0.3 * (3.1 * t + 0.4).cos()],
    ]
}

/// Without switches (step, sine and random loads; slip throughout; crack closed throughout) the extrapolated face law
/// agrees with the reference.
#[test]
fn extrapolated_face_law_agrees_with_the_differential_equations() {
    use ReferenceMaterial::{Cracked, Elastic, Plastic, Porous, Saturated, Viscous};
    let sliding = RateMode { slip_sign: 1.0, is_open: false };
    let closed = RateMode { slip_sign: 0.0, is_open: false };
    // Initial velocities for which the layer starts to slip at once, with the shear stress on the yield surface.
    let loaded = |normal: f64, shear: f64| [0.2, 0.3, normal, shear, 0.0, 0.0];
    let (k, strength) = (0.5, 0.2);
    let mut cases: Vec<(&str, ReferenceMaterial, InvariantLoad, RateMode, LayerState)> = vec![
        ("slip", Plastic([strength, k, 0.0]), slipping_load, sliding, loaded(-0.4, 0.4)),
        ("slip, hardening", Plastic([strength, k, 0.1]), slipping_load, sliding, loaded(-0.4, 0.4)),
        (
            "slip, cohesive",
            Plastic([strength, 0.0, 0.0]),
            slipping_load,
            sliding,
            loaded(-0.4, 0.2),
        ),
        ("closed pores", Porous, compressing_load, closed, loaded(-0.4, 0.1)),
        ("closed pores, saturated", Saturated, compressing_load, closed, loaded(-0.45, 0.1)),
        ("closed crack", Cracked(f64::INFINITY), slipping_load, closed, loaded(-0.3, 0.1)),
        (
            "sliding crack",
            Cracked(0.2),
            slipping_load,
            sliding,
            loaded(-0.3, 0.2 * 0.3 * normal_modulus()),
        ),
    ];
    for load in [step_load as InvariantLoad, sine_load, random_load] {
        for (name, material) in [
            ("elastic", Elastic),
            ("elastic-plastic", Plastic([1.0, 0.5, 0.0])),
            ("viscous", Viscous),
            ("porous", Porous),
            ("saturated", Saturated),
        ] {
            cases.push((name, material, load, REST_MODE, INITIAL_STATE));
        }
    }
    for (name, material, load, mode, initial) in cases {
        let (errors, extrapolated, switches) =
            compare_with_reference(material, load, mode, initial);
        let order = (errors[1] / errors[2]).log2();
        println!("{name}: {:e}, order {order:.4}, extrapolated {extrapolated:e}", errors[5]);
        assert_eq!(switches, [0; 2], "{name}");
        assert!((order - 2.0).abs() < 0.05, "{name}: {errors:?}");
        assert!(extrapolated < 1e-10, "{name}: {extrapolated:e}");
    }
}

/// For loads with switches between modes the face law converges to the reference.
#[test]
fn face_law_converges_through_switches() {
    use ReferenceMaterial::{Cracked, Plastic, Porous, Saturated};
    for (name, material, load, least_order) in [
        (
            "elastic-plastic, cohesive",
            Plastic([0.2, 0.0, 0.0]),
            switching_load as InvariantLoad,
            1.5,
        ),
        ("elastic-plastic", Plastic([0.6, 0.2, 0.0]), switching_load, 1.5),
        ("elastic-plastic, apex", Plastic([0.1, 0.5, 0.0]), apex_load, 1.5),
        ("elastic-plastic, hardening", Plastic([0.2, 0.0, 0.2]), switching_load, 1.5),
        ("porous", Porous, switching_load, 1.5),
        ("saturated", Saturated, switching_load, 1.5),
        ("cracked", Cracked(f64::INFINITY), opening_load, 0.9),
        ("cracked, friction", Cracked(0.4), opening_load, 0.9),
    ] {
        let (errors, _, [switches, apex_switches]) =
            compare_with_reference(material, load, REST_MODE, INITIAL_STATE);
        let order = (errors[0] / errors[5]).log2() / 5.0;
        println!("{name}: {errors:?}, mean order {order:.3}, {switches} switches");
        assert!(switches >= 2, "{name}: {switches}");
        assert!(!name.ends_with("apex") || apex_switches > 0);
        assert!(order > least_order, "{name}: {errors:?}");
    }
}
