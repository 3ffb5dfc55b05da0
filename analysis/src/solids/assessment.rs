//! Verdict on a solid: hyperbolicity, flutter, shear bands and bounded growth.

use super::angles_deg;
use crate::StateError;
use crate::circle::AcousticTensor2;
use crate::flows::Workspace;
use crate::growth::{self, Assessment, Growth, Verdict};
use crate::newton::Order;
use crate::sphere::{self, AcousticTensor3, Extremes, Flutter, RankOne, Slowest, SphereError};
use crate::waves::squared_speeds;
use models::common::elementary::Elementary;
use models::common::rates::RateEquations;
use models::elastoplastic::Solid;
use models::solid::ElasticLaw;
use models::yield_set::tangent::NoResponse;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Description of the method for plane strain, for output.
pub const PLANE_ROUTE: &str = "exact dispersion polynomial of the rate equations, all directions; \
                               speeds from the acoustic tensor every half degree, then refined";

/// Description of the method in space, for output.
pub const SPACE_ROUTE: &str = "acoustic tensor over the sphere, from a start fine enough for a cap \
                               of flutter of 1°, then refined by Newton's method";

/// Description of the method for elastic solids and associated flow without softening, for output.
pub const SYMMETRIC_ROUTE: &str =
    "symmetric tangent stiffness: the rate equations are symmetric-hyperbolic";

/// Type of the characteristic speeds of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hyperbolicity {
    /// All speeds are real; some may be zero.
    Hyperbolic,
    /// Flutter: complex speeds in some directions.
    Flutter,
    /// Shear bands: imaginary speeds in some directions, c² < 0.
    ShearBand,
    /// Flutter in some directions and shear bands in others.
    FlutterAndShearBand,
}

impl Hyperbolicity {
    /// All types, in the order of listings.
    pub const ALL: [Self; 4] =
        [Self::Hyperbolic, Self::Flutter, Self::ShearBand, Self::FlutterAndShearBand];

    /// Name of the type of the speeds in output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hyperbolic => "hyperbolic",
            Self::Flutter => "flutter",
            Self::ShearBand => "shear-band",
            Self::FlutterAndShearBand => "flutter-and-shear-band",
        }
    }

    /// Description for output.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Hyperbolic => "real speeds in all directions",
            Self::Flutter => "flutter: complex speeds",
            Self::ShearBand => "shear bands: c² < 0",
            Self::FlutterAndShearBand => "flutter and shear bands",
        }
    }

    /// Cause of unbounded growth, for output.
    pub const fn cause(self) -> &'static str {
        match self {
            Self::Hyperbolic => "terms of lower order",
            Self::Flutter => "flutter",
            Self::ShearBand => "shear bands",
            Self::FlutterAndShearBand => "flutter and shear bands",
        }
    }

    fn from_extremes(extremes: &Extremes) -> Self {
        let Slowest { speed_squared, rounding, .. } = extremes.slowest;
        match (extremes.flutter.is_some(), speed_squared < -rounding) {
            (false, false) => Self::Hyperbolic,
            (true, false) => Self::Flutter,
            (false, true) => Self::ShearBand,
            (true, true) => Self::FlutterAndShearBand,
        }
    }
}

/// Verdict on a solid with its evidence.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidAssessment {
    /// The verdict.
    pub verdict: Verdict,
    /// Wave normal of the fastest growth if ill-posed.
    pub normal: Option<[f64; 3]>,
    /// Strongest flutter and slowest wave over all directions.
    pub extremes: Extremes,
    /// Type of the characteristic speeds.
    pub hyperbolicity: Hyperbolicity,
    /// Description of the method.
    pub route: &'static str,
}

impl SolidAssessment {
    /// Direction of the fastest growth: azimuth in the plane of x₁ and x₂ and elevation above it, degrees.
    pub fn direction_deg(&self) -> Option<[f64; 2]> {
        self.normal.map(angles_deg)
    }

    /// Whether the slowest speed is zero within rounding: a stationary discontinuity, or slip along layers.
    pub fn is_stationary(&self) -> bool {
        self.extremes.slowest.speed_squared.abs() <= self.extremes.slowest.rounding
    }
}

/// Cache of acoustic tensors of the last elastic solids in space, shared by all threads: each takes 0.1 s to compute
/// and serves every yield set and stress.
#[derive(Default)]
pub struct AcousticTensorCache {
    latest: Mutex<VecDeque<(ElasticLaw, Arc<AcousticTensor3>)>>,
}

impl AcousticTensorCache {
    /// Number of cached tensors: a map over a modulus needs one per value, and threads use several at once.
    const KEPT: usize = 4;

    fn get(
        &self,
        elastic: ElasticLaw,
        rates: &RateEquations<3>,
    ) -> Result<Arc<AcousticTensor3>, SphereError> {
        let lock = || self.latest.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, sphere)) = lock().iter().find(|(known, _)| *known == elastic) {
            return Ok(Arc::clone(sphere));
        }
        let sphere = Arc::new(AcousticTensor3::new(rates)?);
        let mut latest = lock();
        latest.truncate(Self::KEPT - 1);
        latest.push_front((elastic, Arc::clone(&sphere)));
        Ok(sphere)
    }
}

/// Assesses solids one after another, reusing memory; use one per thread.
pub struct SolidAssessor<'a> {
    /// The linearised equations of the plane solid assessed last.
    pub plane: Workspace,
    cache: &'a AcousticTensorCache,
    /// Elastic law, acoustic tensor and workspace of the last solid in space.
    space: Option<(ElasticLaw, Arc<AcousticTensor3>, sphere::Workspace)>,
}

impl<'a> SolidAssessor<'a> {
    /// Creates an assessor that shares the acoustic tensors in `cache`.
    pub fn new(cache: &'a AcousticTensorCache) -> Self {
        Self { plane: Workspace::default(), cache, space: None }
    }

    /// Verdict on a solid, and the assessment by the dispersion polynomial if that was used.
    ///
    /// # Errors
    /// The rate response is not defined, or numbers overflow.
    pub fn assess(
        &mut self,
        solid: &Solid,
    ) -> Result<(SolidAssessment, Option<Assessment>), StateError> {
        match solid.dimensions {
            2 => self.plane(solid),
            _ => Ok((self.space(solid)?, None)),
        }
    }

    fn plane(
        &mut self,
        solid: &Solid,
    ) -> Result<(SolidAssessment, Option<Assessment>), StateError> {
        let rates = solid.rates::<2>()?;
        if solid.keeps_energy() {
            return Ok((energetic(AcousticTensor2::new(&rates).search(&[])), None));
        }
        let Workspace { system, pencil } = &mut self.plane;
        rates.linearise(system);
        pencil.update(system)?;
        let mut assessment = growth::assess(pencil);
        let worst = match assessment.verdict {
            Verdict::IllPosed { direction, .. } => Some(direction),
            _ => None,
        };
        let extremes = AcousticTensor2::new(&rates).search(worst.as_slice());
        let hyperbolicity = Hyperbolicity::from_extremes(&extremes);
        let mut normal = worst.map(|angle| [angle.cr_cos(), angle.cr_sin(), 0.0]);
        // If the polynomial is undecided in one direction, complex or imaginary speeds in another decide: no growth is
        // of a higher order than k.
        let is_open = matches!(assessment.verdict, Verdict::Marginal { .. });
        if is_open && hyperbolicity != Hyperbolicity::Hyperbolic {
            (assessment.verdict, normal) = grows(&extremes);
        }
        let verdict = assessment.verdict.clone();
        let own = SolidAssessment { verdict, normal, extremes, hyperbolicity, route: PLANE_ROUTE };
        Ok((own, Some(assessment)))
    }

    fn space(&mut self, solid: &Solid) -> Result<SolidAssessment, StateError> {
        let elastic = solid.elastic_rates::<3>();
        // In space every yield set has one condition.
        let active = solid.plastic.as_ref().and_then(|plastic| plastic.active.first());
        let extremes = match active {
            None => slowest_elastic(&elastic),
            Some(active) => {
                let stresses = solid.stresses::<3>();
                let components = |gradient| -> Vec<f64> {
                    stresses.iter().map(|component| component.derivative(gradient)).collect()
                };
                let (normal, flow) = (components(&active.normal), components(&active.flow));
                let update =
                    RankOne::new(&elastic, &normal, &flow, active.hardening).map_err(|error| {
                        match error {
                            SphereError::NoResponse(value) => {
                                NoResponse { condition: active.name, value }.into()
                            }
                            error => StateError::from(error),
                        }
                    })?;
                let mut own = match self.space.take() {
                    Some(own) if own.0 == solid.elastic => own,
                    _ => {
                        let sphere = self.cache.get(solid.elastic.clone(), &elastic)?;
                        let workspace = sphere.workspace();
                        (solid.elastic.clone(), sphere, workspace)
                    }
                };
                let found = own.1.search(&update, &mut own.2);
                self.space = Some(own);
                found?
            }
        };
        if solid.keeps_energy() {
            return Ok(energetic(extremes));
        }
        let hyperbolicity = Hyperbolicity::from_extremes(&extremes);
        let Slowest { speed_squared, rounding, .. } = extremes.slowest;
        let (verdict, normal) = match hyperbolicity {
            Hyperbolicity::Hyperbolic if speed_squared <= rounding => {
                let quantity = "least squared speed over all directions".into();
                (Verdict::Marginal { quantity, value: speed_squared, rounding }, None)
            }
            Hyperbolicity::Hyperbolic => (Verdict::WellPosed, None),
            _ => grows(&extremes),
        };
        Ok(SolidAssessment { verdict, normal, extremes, hyperbolicity, route: SPACE_ROUTE })
    }
}

/// Verdict from complex or imaginary speeds, with the wave normal of the fastest growth.
fn grows(extremes: &Extremes) -> (Verdict, Option<[f64; 3]>) {
    let normal = match extremes.flutter {
        Some(Flutter { growth, normal, .. }) if growth >= extremes.growth() => normal,
        _ => extremes.slowest.normal,
    };
    let order = Order { numerator: 1, denominator: 1 };
    let growth = Growth { order, coefficient: extremes.growth() };
    let direction = angles_deg(normal)[0].to_radians();
    (Verdict::IllPosed { growth: Some(growth), direction }, Some(normal))
}

/// Verdict on a solid that conserves or dissipates energy (symmetric-hyperbolic).
fn energetic(mut extremes: Extremes) -> SolidAssessment {
    // Every c² is real and nonnegative; values below zero are rounding.
    extremes.flutter = None;
    extremes.slowest.speed_squared = extremes.slowest.speed_squared.max(0.0);
    SolidAssessment {
        verdict: Verdict::WellPosed,
        normal: None,
        extremes,
        hyperbolicity: Hyperbolicity::Hyperbolic,
        route: SYMMETRIC_ROUTE,
    }
}

/// Slowest wave of an isotropic elastic solid, from one direction. Zero speeds of the spins of a reduced Cosserat solid
/// are not counted.
fn slowest_elastic(elastic: &RateEquations<3>) -> Extremes {
    let normal = [1.0, 0.0, 0.0];
    let speeds = squared_speeds(elastic, normal);
    let moving = speeds.iter().map(|c| c.re).filter(|&c| c > 1e-13 * speeds[0].re);
    let speed_squared = moving.fold(f64::INFINITY, f64::min);
    Extremes { flutter: None, slowest: Slowest { speed_squared, normal, rounding: 0.0 } }
}
