//! One point of a map after another.

use super::MapOptions;
use crate::case::{Case, Kind, Map, radians};
use crate::setup;
use crate::setup::solid::normal;
use analysis::StateError;
use analysis::bound;
use analysis::flows::{Route, Workspace};
use analysis::growth::Verdict;
use analysis::solids::{self, AcousticTensorCache, Hyperbolicity, SolidAssessor, angles_deg};
use models::flow::Model;
use models::flow::state::Background;

/// The verdict at one point of a map; numbers are NaN where there is none.
#[derive(Clone, Copy, Debug)]
pub struct MapPoint {
    /// The verdict, or why there is none.
    pub status: PointStatus,
    /// Where there is a verdict: the method.
    pub route: Option<Route>,
    /// Order of growth in k where ill-posed.
    pub order: f64,
    /// lim Re ς / k^order, m^order/s.
    pub coefficient: f64,
    /// Direction of the wave vector of the fastest growth, degrees.
    pub direction_deg: f64,
    /// Its angle above the plane of x₁ and x₂, degrees; solids.
    pub elevation_deg: f64,
    /// Supremum of Re ς over all waves of a well-posed state, 1/s.
    pub bound: f64,
    /// Greatest Re ς at the wave of the case, 1/s.
    pub growth_rate: f64,
    /// The model's own bound on |Δ| for the leading order of growth, degrees; flows.
    pub noncoaxiality_bound_deg: f64,
    /// Characteristic speeds; solids.
    pub speeds: Option<PointSpeeds>,
}

/// The speeds of a solid.
#[derive(Clone, Copy, Debug)]
pub struct PointSpeeds {
    /// Their type over all directions.
    pub hyperbolicity: Hyperbolicity,
    /// Greatest |Im c| of complex c², m/s; 0 without flutter.
    pub flutter: f64,
    /// Least real c², m²/s²; what rounding may have made of zero is 0.
    pub least_squared: f64,
    /// Normal of the slowest wave: in the plane, and above it, degrees.
    pub least_normal_deg: [f64; 2],
}

/// What can be said of a point; the numbers stand in `map.npz`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// Well-posed.
    WellPosed = 0,
    /// Ill-posed.
    IllPosed = 1,
    /// The quantity that decides is zero within its rounding bound.
    Marginal = 2,
    /// The equations do not determine their unknowns.
    Indeterminate = 3,
    /// Not fully deforming: no equations to judge.
    NotFullyDeforming = 4,
    /// Out of the model's range, contradictory, or beyond what doubles hold.
    OutsideModel = 5,
    /// A yielding solid without a rate of response.
    NoResponse = 6,
}

impl PointStatus {
    /// All of them, in the order of their numbers.
    pub const ALL: [Self; 7] = [
        Self::WellPosed,
        Self::IllPosed,
        Self::Marginal,
        Self::Indeterminate,
        Self::NotFullyDeforming,
        Self::OutsideModel,
        Self::NoResponse,
    ];

    /// Name in results.
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

    /// Whether there is a state to judge at all.
    pub fn is_state(self) -> bool {
        !matches!(self, Self::NotFullyDeforming | Self::OutsideModel | Self::NoResponse)
    }
}

impl MapPoint {
    /// A point of which nothing is known but this.
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

    /// Takes a verdict.
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

/// Judges one point after another; one per thread. Only the swept numbers of its case change.
pub(super) struct Judge<'a> {
    case: Case,
    map: &'a Map,
    options: MapOptions,
    workspace: Workspace,
    solids: SolidAssessor<'a>,
    /// The model of a flow, whose constants are set for each point, and the list by way of which they are.
    model: Option<Model>,
    constants: Vec<f64>,
}

impl<'a> Judge<'a> {
    pub(super) fn new(
        case: &Case,
        map: &'a Map,
        options: MapOptions,
        cache: &'a AcousticTensorCache,
    ) -> Self {
        let (workspace, solids) = (Workspace::default(), SolidAssessor::new(cache));
        let (model, constants) = (None, Vec::new());
        Self { case: case.clone(), map, options, workspace, solids, model, constants }
    }

    pub(super) fn point(&mut self, x: usize, y: usize) -> Result<MapPoint, StateError> {
        self.case.set(self.map.x.parameter, self.map.x.value(x));
        self.case.set(self.map.y.parameter, self.map.y.value(y));
        match self.case.material.kind {
            Kind::Flow(_) => self.flow(),
            Kind::Solid(_) => match self.solid() {
                Err(StateError::NoResponse(_)) => Ok(MapPoint::empty(PointStatus::NoResponse)),
                judged => judged,
            },
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

    fn flow(&mut self) -> Result<MapPoint, StateError> {
        let Self { case, options, workspace, model, constants, .. } = self;
        let mut point = MapPoint::empty(PointStatus::NotFullyDeforming);
        let model = match model {
            Some(model) => {
                case.set_constants(model, constants)?;
                model
            }
            None => model.insert(case.flow_model()?),
        };
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
