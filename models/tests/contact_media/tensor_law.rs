//! Diagrams against the tensor laws in principal stresses, in which Clarabel computes every projection.

use clarabel::algebra::CscMatrix;
use clarabel::solver::SupportedConeT::SecondOrderConeT;
use clarabel::solver::{DefaultSettingsBuilder, DefaultSolver, IPSolver};
use testkit::random::RandomNumbers;
use wellposed_models::granular_medium::{GranularMedium, GranularParameters};
use wellposed_models::porous::{PoreContact, PorousMedium, PorousParameters};
use wellposed_models::uniaxial::{SkeletonState, UniaxialDiagram};

pub(super) type Principal = [f64; 3];

/// Isotropic elasticity and the limits of a projection. Moduli and stresses are in units of the bulk modulus and of a
/// stress of the path, so that the conic program is of order one.
#[derive(Clone, Copy)]
pub(super) struct ProjectionLaw {
    pub(super) bulk_modulus: f64,
    pub(super) shear_modulus: f64,
    pub(super) intensity_coefficient: f64,
    pub(super) friction: Option<f64>,
    pub(super) yield_stress: Option<f64>,
}

/// Projection of a stress, and the plastic strain that belongs to the yield limit.
pub(super) struct Projected {
    pub(super) stress: Principal,
    plastic_strain: Principal,
    /// Bound of the error of the stress: the objective is strongly convex, so that |σ − σ*|² ≤ 2 gap × stiffness.
    pub(super) error_bound: f64,
}

impl ProjectionLaw {
    fn stress(&self, strain: Principal) -> Principal {
        let mean = strain.iter().sum::<f64>() / 3.0;
        strain.map(|own| 3.0 * self.bulk_modulus * mean + 2.0 * self.shear_modulus * (own - mean))
    }

    fn compliance(&self) -> [[f64; 3]; 3] {
        let mean = 1.0 / (9.0 * self.bulk_modulus);
        let deviatoric = 1.0 / (2.0 * self.shear_modulus);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| mean + deviatoric * (f64::from(u8::from(i == j)) - 1.0 / 3.0))
        })
    }

    /// Minimises ½(σ − σ̄):a:(σ − σ̄) over the stresses in the cone and within the yield limit.
    pub(super) fn project(&self, trial: Principal) -> Projected {
        if self.friction.is_none() && self.yield_stress.is_none() {
            let (plastic_strain, error_bound) = ([0.0; 3], 0.0);
            return Projected { stress: trial, plastic_strain, error_bound };
        }
        let a = self.compliance();
        let q: Vec<f64> =
            a.iter().map(|row| -(0..3).map(|j| row[j] * trial[j]).sum::<f64>()).collect();
        let (mut rows, mut b, mut cones): (Vec<Vec<f64>>, Vec<f64>, _) = (vec![], vec![], vec![]);
        let mut add_cone = |bound: f64, of_pressure: f64| {
            rows.push(vec![of_pressure / 3.0; 3]);
            b.extend([bound, 0.0, 0.0, 0.0]);
            let c = self.intensity_coefficient.sqrt();
            for i in 0..3 {
                let unit = |j| f64::from(u8::from(i == j)) - 1.0 / 3.0;
                rows.push((0..3).map(|j| -c * unit(j)).collect());
            }
            cones.push(SecondOrderConeT(4));
        };
        if let Some(limit) = self.yield_stress {
            add_cone(limit, 0.0);
        }
        if let Some(friction) = self.friction {
            add_cone(0.0, friction);
        }
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .tol_gap_abs(1e-13)
            .tol_gap_rel(1e-13)
            .tol_feas(1e-13)
            .build()
            .unwrap();
        let p = CscMatrix::from(&a);
        let p = p.to_triu();
        let mut solver =
            DefaultSolver::new(&p, &q, &CscMatrix::from(&rows), &b, &cones, settings).unwrap();
        solver.solve();
        let (x, z) = (&solver.solution.x, &solver.solution.z);
        // Optimality: a:(σ̄ − σ) = Aᵀz; the rows of the yield limit come first.
        let yield_rows = if self.yield_stress.is_some() { 4 } else { 0 };
        let plastic = |j: usize| (0..yield_rows).map(|row| rows[row][j] * z[row]).sum::<f64>();
        let gap = (solver.solution.obj_val - solver.solution.obj_val_dual).abs();
        let stiffness = (3.0 * self.bulk_modulus).max(2.0 * self.shear_modulus);
        Projected {
            stress: [x[0], x[1], x[2]],
            plastic_strain: std::array::from_fn(plastic),
            error_bound: (2.0 * gap * stiffness).sqrt() + 2.0 * solver.solution.r_prim,
        }
    }
}

/// Compression strains from `from` to `to` in equal steps, without the first, and the corners of a diagram between them:
/// a step across the strain at which yielding ends would flow as its end prescribes, an error of first order.
pub(super) fn ramp(from: f64, to: f64, diagram: &UniaxialDiagram) -> Vec<f64> {
    const STEPS: usize = 24;
    let equal = (1..=STEPS).map(|step| from + (to - from) * step as f64 / STEPS as f64);
    let corners = diagram.corners().iter().map(|own| own.strain);
    let inside = corners.filter(|strain| (strain - from) * (strain - to) < 0.0);
    let mut strains: Vec<f64> = equal.chain(inside).collect();
    strains.sort_by(f64::total_cmp);
    if to < from {
        strains.reverse();
    }
    strains
}

/// Pressures on the front along a path, and the bound of their errors: those of all steps add.
pub(super) struct PathPressures {
    pub(super) pressures: Vec<f64>,
    pub(super) error_bound: f64,
}

/// Integrates a spring with limits along compression strains.
fn integrate(law: ProjectionLaw, offset: f64, strains: &[f64]) -> PathPressures {
    // `offset` is the conditional strain of the natural state: q⁰ = k_bθ₀δ is a mean strain of θ₀/3.
    let mut conditional = law.stress([offset / 3.0; 3]);
    let mut before = 0.0;
    let (mut pressures, mut error_bound) = (Vec::new(), 1e-12);
    for &strain in strains {
        let step = law.stress([before - strain, 0.0, 0.0]);
        let trial = std::array::from_fn(|i| conditional[i] + step[i]);
        let projected = law.project(trial);
        let flow = law.stress(projected.plastic_strain);
        conditional = std::array::from_fn(|i| trial[i] - flow[i]);
        pressures.push(-projected.stress[0]);
        error_bound += projected.error_bound;
        before = strain;
    }
    PathPressures { pressures, error_bound }
}

/// Compares loading to `peak`, unloading to `end`, and loading from the natural state to `end` with the diagrams; returns
/// the largest error and its bound.
pub(super) fn compare_paths(
    integrate: impl Fn(&[f64]) -> PathPressures,
    loading: &UniaxialDiagram,
    unloading: &UniaxialDiagram,
    [peak, end]: [f64; 2],
) -> [f64; 2] {
    let up = ramp(0.0, peak, loading);
    let cycle: Vec<f64> = up.iter().copied().chain(ramp(peak, end, unloading)).collect();
    let extension = ramp(0.0, end, loading);
    let (of_cycle, of_extension) = (integrate(&cycle), integrate(&extension));
    let loaded = up.iter().map(|&strain| loading.pressure(strain));
    let unloaded = cycle[up.len()..].iter().map(|&strain| unloading.pressure(strain));
    let extended = extension.iter().map(|&strain| loading.pressure(strain));
    let integrated = of_cycle.pressures.iter().chain(&of_extension.pressures);
    let pairs = integrated.zip(loaded.chain(unloaded).chain(extended));
    let error = pairs.map(|(own, exact)| (own - exact).abs()).fold(0.0, f64::max);
    [error, of_cycle.error_bound.max(of_extension.error_bound)]
}

/// Largest bound with which a comparison counts; the pressures are of order one.
const MAX_BOUND: f64 = 5e-3;

#[test]
fn granular_diagrams_agree_with_the_tensor_law() {
    let mut random = RandomNumbers::new(5);
    let mut between = |low: f64, high: f64| random.uniform(low, high);
    let mut seen = std::collections::BTreeSet::new();
    for index in 0..120 {
        let parameters = GranularParameters {
            density: 1800.0,
            bulk_modulus: 1.0,
            shear_modulus: between(0.2, 1.6),
            friction: between(0.05, 2.0),
            yield_stress: (index % 4 != 0).then(|| between(0.2, 0.8)),
            intensity_coefficient: between(0.2, 0.6),
        };
        let law = ProjectionLaw {
            bulk_modulus: 1.0,
            shear_modulus: parameters.shear_modulus,
            intensity_coefficient: parameters.intensity_coefficient,
            friction: Some(parameters.friction),
            yield_stress: parameters.yield_stress,
        };
        let medium = GranularMedium::new(parameters).unwrap();
        let range = [between(0.3, 4.0), -between(0.1, 4.0)];
        let loading = medium.loading_diagram();
        let unloading = medium.unloading_diagram(range[0]);
        let [error, bound] =
            compare_paths(|strains| integrate(law, 0.0, strains), &loading, &unloading, range);
        assert!(error <= bound && bound < MAX_BOUND, "{index}: {error:e} {bound:e} {parameters:?}");
        seen.extend(loading.segments().iter().map(|own| own.state.name()));
        seen.extend(unloading.segments().iter().map(|own| own.state.name()));
    }
    // All states occurred.
    assert_eq!(
        seen.into_iter().collect::<Vec<_>>(),
        [
            "elastic, closed",
            "elastic, on the cone",
            "elastic, open",
            "plastic, closed",
            "plastic, on the cone",
        ]
    );
}

#[test]
fn porous_diagrams_agree_with_the_tensor_law() {
    let mut random = RandomNumbers::new(6);
    let mut between = |low: f64, high: f64| random.uniform(low, high);
    let mut states = std::collections::BTreeSet::new();
    for index in 0..120 {
        let (contact_modulus, contact_shear) = (between(0.1, 3.0), between(0.1, 2.0));
        let contact = match index % 3 {
            0 => PoreContact::Spherical,
            _ => PoreContact::Frictional {
                shear_modulus: contact_shear,
                friction: between(0.05, 1.5),
            },
        };
        let parameters = PorousParameters {
            density: 2673.0,
            bulk_modulus: 1.0,
            shear_modulus: between(0.2, 1.6),
            yield_stress: (index % 5 != 0).then(|| between(0.2, 0.8)),
            intensity_coefficient: between(0.2, 0.6),
            contact_bulk_modulus: contact_modulus,
            porosity: between(0.0, 0.9),
            contact,
        };
        let skeleton = ProjectionLaw {
            bulk_modulus: 1.0,
            shear_modulus: parameters.shear_modulus,
            intensity_coefficient: parameters.intensity_coefficient,
            friction: None,
            yield_stress: parameters.yield_stress,
        };
        let pressures = |strains: &[f64]| {
            let of_skeleton = integrate(skeleton, 0.0, strains);
            let spherical =
                |strain: &f64| -contact_modulus * (parameters.porosity - strain).min(0.0);
            let of_pores = match contact {
                PoreContact::Spherical => PathPressures {
                    pressures: strains.iter().map(spherical).collect(),
                    error_bound: 0.0,
                },
                PoreContact::Frictional { shear_modulus, friction } => {
                    let law = ProjectionLaw {
                        bulk_modulus: contact_modulus,
                        shear_modulus,
                        intensity_coefficient: parameters.intensity_coefficient,
                        friction: Some(friction),
                        yield_stress: None,
                    };
                    integrate(law, parameters.porosity, strains)
                }
            };
            let parts = of_skeleton.pressures.iter().zip(&of_pores.pressures);
            PathPressures {
                pressures: parts.map(|(a, b)| a + b).collect(),
                error_bound: of_skeleton.error_bound + of_pores.error_bound,
            }
        };
        let medium = PorousMedium::new(parameters).unwrap();
        let range = [between(0.3, 4.0), -between(0.0, 2.0)];
        let (loading, unloading) = (medium.loading_diagram(), medium.unloading_diagram(range[0]));
        let [error, bound] = compare_paths(pressures, &loading, &unloading, range);
        assert!(error <= bound && bound < MAX_BOUND, "{index}: {error:e} {bound:e} {parameters:?}");
        let of_path = loading.segments().iter().chain(unloading.segments());
        states.extend(of_path.map(|own| own.state.name()));
        assert_eq!(
            loading.segments().iter().any(|own| own.state.skeleton == SkeletonState::Plastic),
            parameters.yield_stress.is_some()
        );
    }
    assert_eq!(states.len(), 6, "{states:?}");
}
