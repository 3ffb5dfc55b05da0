//! Assessment of the points of a map.

use super::MapOptions;
use crate::case::{Case, Kind, Map, Sweep, radians};
use crate::setup;
use crate::setup::solid::normal;
use analysis::StateError;
use analysis::bound;
use analysis::flows::{Route, Workspace};
use analysis::growth::Verdict;
use analysis::solids::{self, AcousticTensorCache, Hyperbolicity, SolidAssessor, angles_deg};
use models::InputError;
use models::common::parameter::Parameter;
use models::flow::state::Background;
use models::flow::{FlowKind, Model};
use serde::{Serialize, Serializer};

/// Verdict at one point of a map; absent numbers are NaN, null in JSON.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MapPoint {
    /// Verdict, or the reason why there is none.
    pub status: PointStatus,
    /// Method of the verdict; `None` without verdict.
    #[serde(serialize_with = "route_name")]
    pub route: Option<Route>,
    /// Order of growth in k if ill-posed.
    pub order: f64,
    /// lim Re ς / k^order, m^order/s.
    pub coefficient: f64,
    /// Direction of the wave vector of fastest growth, degrees.
    pub direction_deg: f64,
    /// Elevation of that wave vector above the plane of x₁ and x₂, degrees; solids only.
    pub elevation_deg: f64,
    /// Supremum of Re ς over all waves of a well-posed state, 1/s.
    pub bound: f64,
    /// Greatest Re ς at the wave of the case, 1/s.
    pub growth_rate: f64,
    /// Closed-form bound of the model on |Δ| for the leading order of growth, degrees; flows only.
    pub noncoaxiality_bound_deg: f64,
    /// Characteristic speeds; solids only.
    pub speeds: Option<PointSpeeds>,
}

/// Characteristic speeds of a solid.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PointSpeeds {
    /// Type of the characteristic speeds over all directions.
    #[serde(serialize_with = "hyperbolicity_name")]
    pub hyperbolicity: Hyperbolicity,
    /// Greatest |Im c| of complex c², m/s; 0 without flutter.
    pub flutter: f64,
    /// Least real c², m²/s²; 0 if zero within rounding.
    pub least_squared: f64,
    /// Normal of the slowest wave: direction in the plane and elevation, degrees.
    pub least_normal_deg: [f64; 2],
}

/// Status of a point; `map.npz` stores its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// Well-posed.
    WellPosed = 0,
    /// Ill-posed.
    IllPosed = 1,
    /// The decisive quantity is zero within its rounding bound.
    Marginal = 2,
    /// The equations do not determine their unknowns.
    Indeterminate = 3,
    /// Not fully deforming: there are no equations to assess.
    NotFullyDeforming = 4,
    /// Out of range of the model, contradictory, or not representable in double precision.
    OutsideModel = 5,
    /// A yielding solid whose rate equations have no solution.
    NoResponse = 6,
}

/// Serialised as its name in results.
impl Serialize for PointStatus {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

fn route_name<S: Serializer>(route: &Option<Route>, serializer: S) -> Result<S::Ok, S::Error> {
    route.map(Route::name).serialize(serializer)
}

fn hyperbolicity_name<S: Serializer>(
    hyperbolicity: &Hyperbolicity,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(hyperbolicity.name())
}

impl PointStatus {
    /// All statuses in the order of their numbers.
    pub const ALL: [Self; 7] = [
        Self::WellPosed,
        Self::IllPosed,
        Self::Marginal,
        Self::Indeterminate,
        Self::NotFullyDeforming,
        Self::OutsideModel,
        Self::NoResponse,
    ];

    /// Returns the name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::WellPosed => "well-posed",
            Self::IllPosed => "ill-posed",
            Self::Marginal => "marginal",
            Self::Indeterminate => "indeterminate",
            Self::NotFullyDeforming => "not fully deforming",
            Self::OutsideModel => "no such state",
            Self::NoResponse => "no response",
        }
    }

    /// Returns whether there is a state to assess.
    pub fn is_state(self) -> bool {
        !matches!(self, Self::NotFullyDeforming | Self::OutsideModel | Self::NoResponse)
    }
}

impl MapPoint {
    /// Creates a point with this status and no numbers.
    pub(super) fn empty(status: PointStatus) -> Self {
        Self {
            status,
            route: None,
            order: f64::NAN,
            coefficient: f64::NAN,
            direction_deg: f64::NAN,
            elevation_deg: f64::NAN,
            bound: f64::NAN,
            growth_rate: f64::NAN,
            noncoaxiality_bound_deg: f64::NAN,
            speeds: None,
        }
    }

    /// Sets verdict, route, order, coefficient and direction.
    fn decide(&mut self, verdict: Verdict, route: Route) {
        self.route = Some(route);
        self.status = match verdict {
            Verdict::WellPosed => PointStatus::WellPosed,
            Verdict::IllPosed { growth, direction } => {
                self.direction_deg = direction.to_degrees();
                if let Some(growth) = growth {
                    (self.order, self.coefficient) = (growth.order.value(), growth.coefficient);
                }
                PointStatus::IllPosed
            }
            Verdict::Marginal { .. } => PointStatus::Marginal,
            Verdict::Indeterminate { .. } => PointStatus::Indeterminate,
        };
    }
}

/// Assessment of map points, one instance per thread. Per point only the swept numbers of its case change; for flows,
/// swept model constants change in `flow` alone.
pub(super) struct Judge<'a> {
    case: Case,
    map: &'a Map,
    options: MapOptions,
    workspace: Workspace,
    solids: SolidAssessor<'a>,
    flow: SweptFlow,
}

/// Model of a flow with its swept constants.
struct SweptFlow {
    /// `None` until constants are in range for the first time.
    model: Option<Model>,
    /// Constants in the order of the model's parameters, in SI units and rad.
    constants: Vec<f64>,
    /// Whether the constants differ from those of `model`.
    is_stale: bool,
    /// Indices and parameters of swept model constants, by axis; found once per map, since names are compared.
    swept: [Option<(usize, &'static Parameter)>; 2],
}

impl SweptFlow {
    fn new(case: &Case, map: &Map) -> Self {
        let constant = |sweep: &Sweep| sweep.parameter.constant_of(case.material.kind);
        let swept = [&map.x, &map.y].map(constant);
        Self { model: None, constants: case.model_constants(), is_stale: true, swept }
    }

    /// Sets the swept constant of an axis; returns false if the axis does not sweep a model constant.
    fn set(&mut self, axis: usize, value: f64) -> bool {
        let Some((place, constant)) = self.swept[axis] else { return false };
        let value = constant.to_si(value);
        let own = &mut self.constants[place];
        self.is_stale |= own.to_bits() != value.to_bits();
        *own = value;
        true
    }

    /// Returns the model with the present constants.
    fn model(&mut self, kind: FlowKind) -> Result<&Model, InputError> {
        let Self { model, constants, is_stale, .. } = self;
        let model = match model {
            Some(model) => {
                if *is_stale {
                    model.set(constants)?;
                }
                model
            }
            None => model.insert(Model::new(kind, constants)?),
        };
        *is_stale = false;
        Ok(model)
    }
}

impl<'a> Judge<'a> {
    pub(super) fn new(
        case: &Case,
        map: &'a Map,
        options: MapOptions,
        cache: &'a AcousticTensorCache,
    ) -> Self {
        let (workspace, solids) = (Workspace::default(), SolidAssessor::new(cache));
        let flow = SweptFlow::new(case, map);
        Self { case: case.clone(), map, options, workspace, solids, flow }
    }

    pub(super) fn point(&mut self, x: usize, y: usize) -> Result<MapPoint, StateError> {
        let sweeps = [(&self.map.x, x), (&self.map.y, y)];
        match self.case.material.kind {
            Kind::Flow(kind) => {
                for (axis, (sweep, index)) in sweeps.into_iter().enumerate() {
                    let value = sweep.value(index);
                    if !self.flow.set(axis, value) {
                        self.case.set(sweep.parameter, value);
                    }
                }
                self.flow(kind)
            }
            Kind::Solid(_) => {
                for (sweep, index) in sweeps {
                    self.case.set(sweep.parameter, sweep.value(index));
                }
                match self.solid() {
                    Err(StateError::NoResponse(_)) => Ok(MapPoint::empty(PointStatus::NoResponse)),
                    judged => judged,
                }
            }
        }
    }

    fn solid(&mut self) -> Result<MapPoint, StateError> {
        let solid = setup::solid::solid(&self.case.material)?;
        let (assessment, of_polynomial) = self.solids.assess(&solid)?;
        let mut point = MapPoint::empty(PointStatus::WellPosed);
        if self.options.growth_rate {
            let wave = &self.case.material.numbers.wave;
            point.growth_rate = solids::growth_rate(&solid, normal(wave), wave.number)?;
        }
        if self.options.bound && assessment.verdict == Verdict::WellPosed {
            let found = of_polynomial
                .as_ref()
                .and_then(|found| bound::supremum(&self.solids.plane.pencil, found, 0.0));
            point.bound = match found {
                Some(supremum) => supremum.rate,
                None if solid.keeps_energy() => 0.0,
                None => f64::NAN,
            };
        }
        point.speeds = Some(PointSpeeds {
            hyperbolicity: assessment.hyperbolicity,
            flutter: assessment.extremes.flutter.map_or(0.0, |flutter| flutter.growth),
            least_squared: match assessment.is_stationary() {
                true => 0.0,
                false => assessment.extremes.slowest.speed_squared,
            },
            least_normal_deg: angles_deg(assessment.extremes.slowest.normal),
        });
        point.decide(assessment.verdict.clone(), Route::ModelBlind);
        if let Some([direction, elevation]) = assessment.direction_deg() {
            (point.direction_deg, point.elevation_deg) = (direction, elevation);
        }
        Ok(point)
    }

    fn flow(&mut self, kind: FlowKind) -> Result<MapPoint, StateError> {
        let Self { case, options, workspace, flow, .. } = self;
        let mut point = MapPoint::empty(PointStatus::NotFullyDeforming);
        let model = flow.model(kind)?;
        let Background::FullyDeforming(flow) = model.background(&case.state())? else {
            return Ok(point);
        };
        point.noncoaxiality_bound_deg =
            model.noncoaxiality_bound().map_or(f64::NAN, f64::to_degrees);
        let (verdict, route) = if options.admits_closed_forms() {
            workspace.decide(model, &flow)?
        } else {
            let assessment = workspace.assess(model, &flow)?;
            if options.growth_rate && !workspace.pencil.is_singular() {
                let wave = case.material.numbers.wave;
                point.growth_rate = workspace.growth(wave.number, radians(wave.direction_deg));
            }
            if options.bound && assessment.verdict == Verdict::WellPosed {
                let least = model.gradient_wave_number(&flow);
                point.bound = bound::supremum(&workspace.pencil, &assessment, least)
                    .map_or(f64::NAN, |s| s.rate);
            }
            (assessment.verdict, Route::ModelBlind)
        };
        point.decide(verdict, route);
        Ok(point)
    }
}
