//! Yield sets: what any of them states, and the entry of one in the registry.

pub mod interlayer;
pub mod mises;
pub mod parameters;
pub mod projection;
pub mod return_mapping;
pub mod tangent;

use crate::common::DynEq;
use crate::common::input::{InputError, ensure};
use crate::common::parameter::Parameter;
use crate::solid::parameters::Theory;
use crate::solid::stress::{Component, Stress};
use crate::solid::{ElasticLaw, SolidKind};
use crate::yield_set::parameters::ActiveCondition;
use crate::yield_set::projection::Projection;
use nalgebra::DMatrix;
use std::fmt::{self, Debug};
use std::sync::Arc;

/// A closed convex set of stresses with checked constants.
pub trait YieldConditions: DynEq + Debug + Send + Sync {
    /// Greatest of the f of all conditions, Pa (of couple conditions N/m over 1 m); at most 0 inside.
    fn value(&self, stress: &Stress) -> f64;

    /// The conditions that hold with equality, or are violated, to within `tolerance` relative to the terms that
    /// they compare.
    fn active(&self, stress: &Stress, tolerance: f64) -> Vec<ActiveCondition>;

    /// That the flow is ideal, without hardening, and associated.
    ///
    /// # Errors
    /// The constant that says otherwise.
    fn check_ideal_and_associated(&self) -> Result<(), InputError>;

    /// The greatest s for which `start` + s·`direction` is in the set; infinite if all s are.
    ///
    /// # Errors
    /// [`Unusable`]: the set does not hold `start` with room around it.
    fn reach(&self, start: &Stress, direction: &Stress) -> Result<f64, Unusable>;

    /// The stress of the set next to a trial stress in the norm of the elastic energy of this law, which the set's
    /// [entry](YieldSetModel::admits) admits.
    fn project(&self, law: &ElasticLaw, trial: &Stress) -> Projection<Stress>;

    /// Second derivatives of the condition by the components of the list, 1/Pa, where it is curved.
    ///
    /// While the background flows at the rate Λ (1/s) this times Λ is the relaxation of its
    /// perturbations (Sadovskii & Sadovskaya 2019, "Elastic-plastic Cosserat continuum", for curved sets).
    fn curvature(&self, stress: &Stress, components: &[Component]) -> Option<DMatrix<f64>> {
        let _ = (stress, components);
        None
    }

    /// Its half-spaces n·s ≤ k with their strengths k, if it is a polyhedron.
    fn half_spaces(&self) -> Option<Vec<(ActiveCondition, f64)>> {
        None
    }
}

/// Why no stress from a starting point on can be found that yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unusable {
    /// The set has no strength there.
    NoStrength,
    /// The starting point is outside.
    Outside,
}

/// That a dilatancy of that name is equal to the friction.
///
/// # Errors
/// It is not.
pub fn check_associated(
    key: &'static str,
    dilatancy: f64,
    friction: f64,
) -> Result<(), InputError> {
    ensure(
        dilatancy == friction,
        key,
        format_args!("{dilatancy:?}"),
        format_args!("runs have associated flow: {friction:?}, as the friction"),
    )
}

/// Room of a condition along a ray, as linear as the condition is along it: it uses `used` of `strength` at the start
/// and `rate` per multiple of the direction.
///
/// # Errors
/// See [`Unusable`].
pub fn room(used: f64, strength: f64, rate: f64) -> Result<f64, Unusable> {
    match strength - used {
        room if room > 0.0 => Ok(if rate > 0.0 { room / rate } else { f64::INFINITY }),
        _ if used <= 0.0 => Err(Unusable::NoStrength),
        _ => Err(Unusable::Outside),
    }
}

/// A yield set with checked constants.
#[derive(Clone, Debug)]
pub struct YieldSet(Arc<dyn YieldConditions>);

impl<T: YieldConditions> From<T> for YieldSet {
    fn from(set: T) -> Self {
        Self(Arc::new(set))
    }
}

impl PartialEq for YieldSet {
    fn eq(&self, other: &Self) -> bool {
        self.0.dyn_eq(other.0.as_any())
    }
}

impl std::ops::Deref for YieldSet {
    type Target = dyn YieldConditions;

    fn deref(&self) -> &Self::Target {
        &*self.0
    }
}

impl YieldSet {
    /// The set as this type, if it is of it.
    pub fn downcast<T: YieldConditions>(&self) -> Option<&T> {
        self.0.as_any().downcast_ref()
    }
}

/// A yield set as the [registry](crate::registry) lists it.
pub struct YieldSetModel {
    /// Name in case files, as in `von-mises`.
    pub name: &'static str,
    /// Name in titles.
    pub title: &'static str,
    /// Its constants, and which solids need them. Those named like a constant of another set must have the same unit.
    pub parameters: &'static [(Parameter, Needs)],
    /// Whether it is a set of plane strain alone.
    pub is_plane: bool,
    /// Whether its conditions are curved, so that a rate of plastic flow damps waves.
    pub is_curved: bool,
    /// Names of its conditions, in the order of its half-spaces, by which a case may say what is active: a sign, and
    /// the stress that the condition limits. Empty if a case may not.
    pub conditions: &'static [(&'static str, Needs)],
    /// Whether a solid with this elastic law can have it: what [`YieldConditions::project`] cannot project in the norm
    /// of the law's energy must be refused here.
    pub admits: fn(&ElasticLaw) -> bool,
    /// Checks the constants that a solid of this theory needs, in the order of `parameters`, in SI units.
    pub build: fn(Theory, &[f64]) -> Result<YieldSet, InputError>,
}

/// The solids that need a constant of a yield set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    /// All.
    All,
    /// Those with a rotation of their own.
    Rotation,
    /// Those with couple stress.
    Couples,
}

impl Needs {
    /// Whether a solid of this theory needs it.
    pub fn are_those_of(self, theory: Theory) -> bool {
        match self {
            Self::All => true,
            Self::Rotation => theory != Theory::Classical,
            Self::Couples => theory == Theory::Cosserat,
        }
    }
}

/// An entry of the registry by reference; two are equal if they have the same name.
#[derive(Clone, Copy)]
pub struct YieldSetKind(&'static YieldSetModel);

impl YieldSetKind {
    /// An entry of the registry.
    pub const fn new(model: &'static YieldSetModel) -> Self {
        Self(model)
    }

    /// The constants that a solid of this theory needs.
    pub fn parameters_for(self, theory: Theory) -> impl Iterator<Item = &'static Parameter> {
        let needed = move |own: &&(Parameter, Needs)| own.1.are_those_of(theory);
        self.0.parameters.iter().filter(needed).map(|own| &own.0)
    }

    /// Whether a solid can have the set, by its law with the constants of [`SolidKind::example`].
    pub fn admits(self, solid: SolidKind) -> bool {
        solid.example().is_ok_and(|law| (self.0.admits)(&law))
    }

    /// That a solid with this law, of that kind, can have the set.
    ///
    /// # Errors
    /// It cannot; both are named.
    pub fn check_admits(self, solid: SolidKind, law: &ElasticLaw) -> Result<(), InputError> {
        match (self.0.admits)(law) {
            true => Ok(()),
            false => Err(InputError {
                input: "kind",
                found: format!("{}, which cannot yield by {}", solid.name, self.name),
                allowed: format!("a solid whose elastic law the yield set {} admits", self.name),
            }),
        }
    }

    /// The names of the conditions that a solid of this theory has.
    pub fn conditions_for(self, theory: Theory) -> Vec<&'static str> {
        let has = |own: &&(&str, Needs)| own.1.are_those_of(theory);
        self.0.conditions.iter().filter(has).map(|own| own.0).collect()
    }

    /// The set of a solid of this theory with the constants that it needs, in their order, in SI units.
    ///
    /// # Errors
    /// The constant that is out of range.
    pub fn set(self, theory: Theory, constants: &[f64]) -> Result<YieldSet, InputError> {
        (self.0.build)(theory, constants)
    }
}

impl std::ops::Deref for YieldSetKind {
    type Target = YieldSetModel;

    fn deref(&self) -> &YieldSetModel {
        self.0
    }
}

impl PartialEq for YieldSetKind {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for YieldSetKind {}

impl std::hash::Hash for YieldSetKind {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

impl fmt::Debug for YieldSetKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name)
    }
}
