//! Yield sets: the interface of a yield set, return mapping, tangent stiffness, and registry entries.
//!
//! To add a set, write a file in this folder with a static [`YieldSetModel`] and a type that implements
//! [`YieldConditions`], and list the model in [`registry`](crate::registry). Solvers project stresses onto a set cell
//! by cell; cones and polyhedra have vectorised return mappings in crate `dynamics`.

pub mod interlayer;
pub mod mises;
pub mod parameters;
pub mod projection;
pub mod return_mapping;
pub mod tangent;

use crate::common::DynEq;
use crate::common::input::{InputError, ensure};
use crate::common::kind::{impl_deref_to_entry, impl_kind_by_name, impl_shared_law};
use crate::common::parameter::Parameter;
use crate::solid::parameters::Theory;
use crate::solid::stress::{Stress, StressComponent};
use crate::solid::{ElasticLaw, SolidKind};
use crate::yield_set::parameters::ActiveCondition;
use crate::yield_set::projection::Projection;
use nalgebra::DMatrix;
use std::fmt::Debug;
use std::sync::Arc;

/// A yield set with checked constants: a closed convex set of stresses given by conditions f ≤ 0.
pub trait YieldConditions: DynEq + Debug + Send + Sync {
    /// Yield function: maximum of f over all conditions; ≤ 0 in the set. Conditions on the force stress have f in Pa,
    /// conditions on the couple stress in N/m; the maximum compares the numerical values.
    fn yield_function(&self, stress: &Stress) -> f64;

    /// Active or violated conditions: f ≥ −`tolerance` times the magnitude of the terms of f. Conditions without a
    /// unique normal at `stress`, such as a cone on its axis, are omitted.
    fn active_conditions(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition>;

    /// Checks that plastic flow is ideal (no hardening) and associated, as time-domain runs require.
    ///
    /// # Errors
    /// A constant gives hardening or non-associated flow.
    fn check_ideal_and_associated(&self) -> Result<(), InputError>;

    /// Largest s ≥ 0 for which `start` + s·`direction` is in the set: the exit point of a ray from a hydrostatic stress
    /// `start`; may be infinite.
    ///
    /// # Errors
    /// `start` is not an interior point of the set.
    fn ray_exit(&self, start: &Stress, direction: &Stress) -> Result<f64, RayStartError>;

    /// Return mapping: closest-point projection of the trial stress in the energy norm of `law`, which must be
    /// [compatible with the set](YieldSetModel::is_compatible_law).
    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress>;

    /// Hessian of the yield function with respect to `components` (1/Pa between force stresses); `None` if the
    /// conditions are linear, or where a cone has no unique normal.
    ///
    /// Multiplied by the plastic multiplier rate Λ (1/s) of the background, it is the relaxation matrix R of
    /// perturbations (Sadovskii & Sadovskaya 2019, "Elastic-plastic Cosserat continuum", for curved sets).
    fn curvature(&self, stress: &Stress, components: &[StressComponent]) -> Option<DMatrix<f64>> {
        let _ = (stress, components);
        None
    }

    /// Half-spaces n·s ≤ k of a polyhedral set: conditions with the normals n, and the strengths k; `None` if the set
    /// is not a polyhedron.
    fn half_spaces(&self) -> Option<Vec<(ActiveCondition, f64)>> {
        None
    }
}

/// Error of [`YieldConditions::ray_exit`]: the starting point is not an interior point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayStartError {
    /// A condition has no strength at the starting point: its strength and the value of n·s there are zero.
    NoStrength,
    /// The starting point is outside the set or on its boundary.
    Outside,
}

/// Checks that flow is associated: the dilatancy called `key` equals the friction.
///
/// # Errors
/// Dilatancy and friction differ.
pub fn check_associated(
    key: &'static str,
    dilatancy: f64,
    friction: f64,
) -> Result<(), InputError> {
    ensure(
        dilatancy == friction,
        key,
        dilatancy,
        format_args!(
            "expected {friction}, the friction: the solver has associated flow rules only"
        ),
    )
}

/// Computes the exit point of a ray for a condition that is linear along it: the largest s with
/// `start_value` + s·`rate` ≤ `strength`.
///
/// # Errors
/// `start_value` ≥ `strength`: the starting point is not interior.
pub fn linear_ray_exit(start_value: f64, strength: f64, rate: f64) -> Result<f64, RayStartError> {
    match strength - start_value {
        margin if margin > 0.0 => Ok(if rate > 0.0 { margin / rate } else { f64::INFINITY }),
        _ if start_value <= 0.0 => Err(RayStartError::NoStrength),
        _ => Err(RayStartError::Outside),
    }
}

/// A yield set with checked constants.
#[derive(Clone, Debug)]
pub struct YieldSet(Arc<dyn YieldConditions>);

impl_shared_law!(YieldSet, YieldConditions);

/// A yield set as the [registry](crate::registry) lists it.
pub struct YieldSetModel {
    /// Name of the yield set in case files, e.g. `von-mises`.
    pub name: &'static str,
    /// Name of the yield set in titles.
    pub title: &'static str,
    /// Constants, with the solids that need them. Constants of the same name in different sets must have the same unit.
    pub parameters: &'static [(Parameter, SolidClass)],
    /// Whether the set is defined in plane strain only.
    pub is_plane: bool,
    /// Whether the yield surface is curved, so that plastic flow of the background damps waves.
    pub is_curved: bool,
    /// Names of the conditions in the order of the half-spaces, by which a case file selects active ones: a sign and
    /// the limited stress, as in `+sigma21`. Empty if a case file cannot select conditions.
    pub conditions: &'static [(&'static str, SolidClass)],
    /// Whether the set can be combined with an elastic law; must return false for every law that
    /// [`YieldConditions::project`] does not support.
    pub is_compatible_law: fn(&ElasticLaw) -> bool,
    /// Constructor from the theory of the solid and the constants that a solid of this theory needs, in the order of
    /// `parameters`, in SI units.
    pub constructor: fn(Theory, &[f64]) -> Result<YieldSet, InputError>,
}

/// Solids that need a constant or a condition of a yield set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidClass {
    /// All solids.
    AllSolids,
    /// Solids with microrotation.
    MicrorotationSolids,
    /// Solids with couple stress.
    CoupleStressSolids,
}

impl SolidClass {
    /// Whether solids of `theory` need the constant or condition.
    pub fn includes(self, theory: Theory) -> bool {
        match self {
            Self::AllSolids => true,
            Self::MicrorotationSolids => theory != Theory::Classical,
            Self::CoupleStressSolids => theory == Theory::Cosserat,
        }
    }
}

/// Reference to a registry entry of a yield set; equality compares names.
#[derive(Clone, Copy)]
pub struct YieldSetKind(&'static YieldSetModel);

impl YieldSetKind {
    /// A reference to the registry entry `model`.
    pub const fn new(model: &'static YieldSetModel) -> Self {
        Self(model)
    }

    /// Constants that a solid of `theory` needs.
    pub fn parameters_for(self, theory: Theory) -> impl Iterator<Item = &'static Parameter> {
        let is_needed = move |entry: &&(Parameter, SolidClass)| entry.1.includes(theory);
        self.0.parameters.iter().filter(is_needed).map(|entry| &entry.0)
    }

    /// Whether the set can be combined with `solid`, decided by its example law ([`SolidKind::build_example_law`]).
    pub fn is_compatible(self, solid: SolidKind) -> bool {
        solid.build_example_law().is_ok_and(|law| (self.0.is_compatible_law)(&law))
    }

    /// Checks that the set can be combined with the elastic law `law` of kind `solid`.
    ///
    /// # Errors
    /// The combination is not supported; the error names both.
    pub fn check_compatible(self, solid: SolidKind, law: &ElasticLaw) -> Result<(), InputError> {
        match (self.0.is_compatible_law)(law) {
            true => Ok(()),
            false => Err(InputError {
                input: "kind",
                rejected_value: format!(
                    "{}, which does not admit the yield set {}",
                    solid.name, self.name
                ),
                allowed_values: format!(
                    "a solid whose elastic law the yield set {} admits",
                    self.name
                ),
            }),
        }
    }

    /// Names of the conditions for a solid of `theory`.
    pub fn conditions_for(self, theory: Theory) -> Vec<&'static str> {
        let is_needed = |entry: &&(&str, SolidClass)| entry.1.includes(theory);
        self.0.conditions.iter().filter(is_needed).map(|entry| entry.0).collect()
    }

    /// Builds the yield set for a solid of `theory` with the given constants, in the order of
    /// [`parameters_for`](Self::parameters_for), in SI units.
    ///
    /// # Errors
    /// The number of constants is wrong, or a constant is out of range.
    pub fn build_set(self, theory: Theory, constants: &[f64]) -> Result<YieldSet, InputError> {
        (self.0.constructor)(theory, constants)
    }
}

impl_deref_to_entry!(YieldSetKind, YieldSetModel);
impl_kind_by_name!(YieldSetKind);
