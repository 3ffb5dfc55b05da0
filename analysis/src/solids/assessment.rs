//! Verdict on a solid: hyperbolicity, flutter, shear bands and bounded growth.

use super::angles_deg;
use crate::StateError;
use crate::acoustic_tensor2::AcousticTensor2;
use crate::acoustic_tensor3::{
    self, AcousticTensor3, ExtremesMethod, Flutter, NormalSearchError, RankOneUpdate, SlowestSpeed,
    WaveExtremes,
};
use crate::flows::FlowWorkspace;
use crate::growth::{self, Assessment, Growth, Verdict};
use crate::newton_polygon::GrowthOrder;
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

/// Description of the methods in space, for output on many states.
pub const SPACE_ROUTE: &str = "acoustic tensor over the sphere, by forms with a certified maximum or, \
                               where these do not decide, by search";

/// Description of the method in space by forms, for output.
pub const SPACE_FORM_ROUTE: &str = "acoustic tensor over the sphere: speeds real by signs of \
                                    forms, slowest wave by Newton's method with a certificate \
                                    that no direction has a slower one";

/// Description of the search in space, for output.
pub const SPACE_SEARCH_ROUTE: &str = "acoustic tensor over the sphere, from a start fine enough for a cap \
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
    /// Flutter and shear bands, in the same or in different directions.
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
    pub const fn description(self) -> &'static str {
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

    fn from_extremes(extremes: &WaveExtremes) -> Self {
        let SlowestSpeed { squared_speed, rounding, .. } = extremes.slowest;
        match (extremes.flutter.is_some(), squared_speed < -rounding) {
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
    pub extremes: WaveExtremes,
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
        self.extremes.slowest.squared_speed.abs() <= self.extremes.slowest.rounding
    }
}

/// Cache of acoustic tensors of the last elastic solids in space, shared by all threads: each may take 0.1 s to compute
/// and serves every yield set and stress.
#[derive(Default)]
pub struct AcousticTensorCache {
    tensors: Mutex<VecDeque<(ElasticLaw, Arc<AcousticTensor3>)>>,
}

impl AcousticTensorCache {
    /// Number of cached tensors: a map over a modulus needs one per value, and threads use several at once.
    const MAX_TENSORS: usize = 4;

    fn find_or_compute(
        &self,
        elastic: ElasticLaw,
        rates: &RateEquations<3>,
    ) -> Result<Arc<AcousticTensor3>, NormalSearchError> {
        let lock = || self.tensors.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, tensor)) = lock().iter().find(|(known, _)| *known == elastic) {
            return Ok(Arc::clone(tensor));
        }
        let tensor = Arc::new(AcousticTensor3::new(rates)?);
        let mut tensors = lock();
        tensors.truncate(Self::MAX_TENSORS - 1);
        tensors.push_front((elastic, Arc::clone(&tensor)));
        Ok(tensor)
    }
}

/// Assesses solids one after another, reusing memory; use one per thread.
pub struct SolidAssessor<'a> {
    /// The linearised equations of the plane solid last assessed by the dispersion polynomial.
    pub plane_workspace: FlowWorkspace,
    cache: &'a AcousticTensorCache,
    /// Elastic law, acoustic tensor and workspace of the last solid in space.
    space_workspace:
        Option<(ElasticLaw, Arc<AcousticTensor3>, acoustic_tensor3::NormalSearchWorkspace)>,
}

impl<'a> SolidAssessor<'a> {
    /// Creates an assessor that shares the acoustic tensors in `cache`.
    pub fn new(cache: &'a AcousticTensorCache) -> Self {
        Self { plane_workspace: FlowWorkspace::default(), cache, space_workspace: None }
    }

    /// Verdict on a solid, and the assessment by the dispersion polynomial if that was used.
    ///
    /// # Errors
    /// The rate response is not defined, the elastic solid in space has no positive definite acoustic tensor, or
    /// numbers overflow.
    pub fn assess(
        &mut self,
        solid: &Solid,
    ) -> Result<(SolidAssessment, Option<Assessment>), StateError> {
        match solid.dimensions {
            2 => self.assess_plane(solid),
            _ => Ok((self.assess_space(solid)?, None)),
        }
    }

    fn assess_plane(
        &mut self,
        solid: &Solid,
    ) -> Result<(SolidAssessment, Option<Assessment>), StateError> {
        let rates = solid.rates::<2>()?;
        if solid.is_symmetric_hyperbolic() {
            return Ok((
                assess_symmetric_hyperbolic(AcousticTensor2::new(&rates).search_extremes(&[])),
                None,
            ));
        }
        let FlowWorkspace { system, pencil } = &mut self.plane_workspace;
        rates.linearise(system);
        pencil.update(system)?;
        let mut assessment = growth::assess(pencil);
        let worst = match assessment.verdict {
            Verdict::IllPosed { direction, .. } => Some(direction),
            _ => None,
        };
        let extremes = AcousticTensor2::new(&rates).search_extremes(worst.as_slice());
        let hyperbolicity = Hyperbolicity::from_extremes(&extremes);
        let mut normal = worst.map(|angle| [angle.cr_cos(), angle.cr_sin(), 0.0]);
        // If the polynomial is undecided in one direction, complex or imaginary speeds in another decide: no growth is
        // of a higher order than k.
        let is_open = matches!(assessment.verdict, Verdict::Marginal { .. });
        if is_open && hyperbolicity != Hyperbolicity::Hyperbolic {
            (assessment.verdict, normal) = growth_verdict(&extremes);
        }
        let verdict = assessment.verdict.clone();
        let own = SolidAssessment { verdict, normal, extremes, hyperbolicity, route: PLANE_ROUTE };
        Ok((own, Some(assessment)))
    }

    fn assess_space(&mut self, solid: &Solid) -> Result<SolidAssessment, StateError> {
        let elastic = solid.elastic_rates::<3>();
        // In space every yield set has one condition.
        let active =
            solid.plastic_state.as_ref().and_then(|plastic| plastic.active_conditions.first());
        let (extremes, method) = match active {
            None => (slowest_elastic_wave(&elastic), ExtremesMethod::Certified),
            Some(active) => {
                let stresses = solid.stresses::<3>();
                let components = |gradient| -> Vec<f64> {
                    stresses.iter().map(|component| component.derivative(gradient)).collect()
                };
                let (normal, flow) =
                    (components(&active.normal), components(&active.flow_direction));
                let update = RankOneUpdate::new(&elastic, &normal, &flow, active.hardening)
                    .map_err(|error| match error {
                        NormalSearchError::NoResponse(value) => {
                            NoResponse { condition: active.name, value }.into()
                        }
                        error => StateError::from(error),
                    })?;
                let mut own = match self.space_workspace.take() {
                    Some(own) if own.0 == solid.elastic_law => own,
                    _ => {
                        let tensor =
                            self.cache.find_or_compute(solid.elastic_law.clone(), &elastic)?;
                        (solid.elastic_law.clone(), tensor, Default::default())
                    }
                };
                let found = own.1.find_extremes(&update, &mut own.2);
                self.space_workspace = Some(own);
                found?
            }
        };
        if solid.is_symmetric_hyperbolic() {
            return Ok(assess_symmetric_hyperbolic(extremes));
        }
        let hyperbolicity = Hyperbolicity::from_extremes(&extremes);
        let SlowestSpeed { squared_speed, rounding, .. } = extremes.slowest;
        let (verdict, normal) = match hyperbolicity {
            Hyperbolicity::Hyperbolic if squared_speed <= rounding => {
                let quantity = "least squared speed over all directions".into();
                (Verdict::Marginal { quantity, value: squared_speed, rounding }, None)
            }
            Hyperbolicity::Hyperbolic => (Verdict::WellPosed, None),
            _ => growth_verdict(&extremes),
        };
        let route = match method {
            ExtremesMethod::Certified => SPACE_FORM_ROUTE,
            ExtremesMethod::Search => SPACE_SEARCH_ROUTE,
        };
        Ok(SolidAssessment { verdict, normal, extremes, hyperbolicity, route })
    }
}

/// Verdict from complex or imaginary speeds, with the wave normal of the fastest growth.
fn growth_verdict(extremes: &WaveExtremes) -> (Verdict, Option<[f64; 3]>) {
    let normal = match extremes.flutter {
        Some(Flutter { max_imaginary_speed, normal, .. })
            if max_imaginary_speed >= extremes.max_imaginary_speed() =>
        {
            normal
        }
        _ => extremes.slowest.normal,
    };
    let order = GrowthOrder { numerator: 1, denominator: 1 };
    let growth = Growth { order, coefficient: extremes.max_imaginary_speed() };
    let direction = angles_deg(normal)[0].to_radians();
    (Verdict::IllPosed { growth: Some(growth), direction }, Some(normal))
}

/// Assesses a solid with symmetric-hyperbolic equations, which conserve or dissipate energy: it is well-posed.
fn assess_symmetric_hyperbolic(mut extremes: WaveExtremes) -> SolidAssessment {
    // Every c² is real and nonnegative; values below zero are rounding.
    extremes.flutter = None;
    extremes.slowest.squared_speed = extremes.slowest.squared_speed.max(0.0);
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
fn slowest_elastic_wave(elastic: &RateEquations<3>) -> WaveExtremes {
    let normal = [1.0, 0.0, 0.0];
    let speeds = squared_speeds(elastic, normal);
    let moving = speeds.iter().map(|c| c.re).filter(|&c| c > 1e-13 * speeds[0].re);
    let squared_speed = moving.fold(f64::INFINITY, f64::min);
    WaveExtremes { flutter: None, slowest: SlowestSpeed { squared_speed, normal, rounding: 0.0 } }
}
