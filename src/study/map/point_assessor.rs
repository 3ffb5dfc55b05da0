//! Assessment of the points of a map.

use super::MapOptions;
use super::samples::WaveSample;
use crate::case::{Case, MapAxes, ModelKind, ParameterSweep, WaveNumbers, degrees_to_radians};
use crate::setup;
use crate::setup::solid::wave_normal;
use analysis::StateError;
use analysis::bound;
use analysis::equations::EquationsWorkspace;
use analysis::flows::{FlowWorkspace, Route};
use analysis::growth::Verdict;
use analysis::pencil::PencilRoots;
use analysis::solids::{AcousticTensorCache, Hyperbolicity, PlaneWaves, SolidAssessor, angles_deg};
use models::InputError;
use models::common::parameter::Parameter;
use models::flow::state::Background;
use models::flow::{FlowKind, Model};
use num_complex::Complex64;
use serde::{Serialize, Serializer};

/// Verdict at one point of a map; absent numbers are NaN, null in JSON.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct MapPoint {
    /// Verdict at the point, or the reason why there is none.
    pub status: PointStatus,
    /// Method by which the verdict was obtained: closed form or linearised equations; `None` without verdict.
    #[serde(serialize_with = "serialize_route")]
    pub route: Option<Route>,
    /// Order of growth in the wave number k if ill-posed, unless growth is unbounded at finite wave numbers.
    #[serde(rename = "order")]
    pub growth_order: f64,
    /// Growth coefficient lim Re ς / k^order as k → ∞, m^order/s; absent without `growth_order`.
    #[serde(rename = "coefficient")]
    pub growth_coefficient: f64,
    /// Direction of the wave vector of fastest or unbounded growth, from x₁, degrees, if ill-posed.
    pub direction_deg: f64,
    /// Elevation of the wave vector of fastest growth above the plane of x₁ and x₂, degrees; solids and models
    /// given as equations in space.
    pub elevation_deg: f64,
    /// Supremum of Re ς over all waves of a well-posed state, for flows over those with at least the wave number of the
    /// background gradients, 1/s; only with [`MapOptions::computes_bound`].
    #[serde(rename = "bound")]
    pub growth_bound: f64,
    /// Largest Re ς at the wave of the case, 1/s; only with [`MapOptions::computes_growth_rate`].
    pub growth_rate: f64,
    /// Closed-form bound of the model on the non-coaxiality |Δ|, degrees, below which the leading growth rate is not
    /// positive in any direction; flows only.
    pub noncoaxiality_bound_deg: f64,
    /// Characteristic speeds; `None` for flows and for points without a state.
    pub speeds: Option<PointSpeeds>,
}

/// Characteristic speeds of a solid at a map point, over all directions.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PointSpeeds {
    /// Type of the characteristic speeds over all directions.
    #[serde(serialize_with = "serialize_hyperbolicity")]
    pub hyperbolicity: Hyperbolicity,
    /// Supremum of |Im c| over the directions with complex c², m/s; 0 without flutter.
    #[serde(rename = "flutter")]
    pub max_imaginary_speed: f64,
    /// Smallest real c² over all directions, m²/s²; 0 if zero within rounding, infinite if no direction has a real c².
    #[serde(rename = "least_squared")]
    pub min_squared_speed: f64,
    /// Normal of the slowest wave: direction in the plane of x₁ and x₂ and elevation above it, degrees.
    #[serde(rename = "least_normal_deg")]
    pub slowest_normal_deg: [f64; 2],
}

/// Verdict at a point of a map, or the reason why there is none; `map.npz` stores the discriminant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointStatus {
    /// Well-posed: growth rates are bounded.
    WellPosed = 0,
    /// Ill-posed: growth rates are unbounded.
    IllPosed = 1,
    /// The quantity that decides the verdict is zero within its rounding bound.
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

/// A status is serialised as its name in results.
impl Serialize for PointStatus {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

fn serialize_route<S: Serializer>(route: &Option<Route>, serializer: S) -> Result<S::Ok, S::Error> {
    route.map(Route::name).serialize(serializer)
}

fn serialize_hyperbolicity<S: Serializer>(
    hyperbolicity: &Hyperbolicity,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(hyperbolicity.name())
}

impl PointStatus {
    /// All statuses in the order of their discriminants.
    pub const ALL: [Self; 7] = [
        Self::WellPosed,
        Self::IllPosed,
        Self::Marginal,
        Self::Indeterminate,
        Self::NotFullyDeforming,
        Self::OutsideModel,
        Self::NoResponse,
    ];

    /// Returns the name of the status in results.
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

    /// Returns whether the point has a state that was assessed.
    pub fn has_state(self) -> bool {
        !matches!(self, Self::NotFullyDeforming | Self::OutsideModel | Self::NoResponse)
    }
}

impl MapPoint {
    /// Creates a point with this status; all numbers are NaN.
    pub(super) fn with_status(status: PointStatus) -> Self {
        Self {
            status,
            route: None,
            growth_order: f64::NAN,
            growth_coefficient: f64::NAN,
            direction_deg: f64::NAN,
            elevation_deg: f64::NAN,
            growth_bound: f64::NAN,
            growth_rate: f64::NAN,
            noncoaxiality_bound_deg: f64::NAN,
            speeds: None,
        }
    }

    /// Returns all numbers of the point, from which [`from_numbers`](Self::from_numbers) restores it; discrete values as
    /// their places in the lists of all.
    pub(super) fn numbers(&self) -> [f64; 14] {
        let route = self.route.map_or(f64::NAN, |own| place_in(&Route::ALL, &own));
        let [kind, flutter, least, direction, elevation] = match self.speeds {
            None => [f64::NAN; 5],
            Some(PointSpeeds {
                hyperbolicity,
                max_imaginary_speed,
                min_squared_speed,
                slowest_normal_deg: [direction, elevation],
            }) => {
                let kind = place_in(&Hyperbolicity::ALL, &hyperbolicity);
                [kind, max_imaginary_speed, min_squared_speed, direction, elevation]
            }
        };
        [
            place_in(&PointStatus::ALL, &self.status),
            route,
            self.growth_order,
            self.growth_coefficient,
            self.direction_deg,
            self.elevation_deg,
            self.growth_bound,
            self.growth_rate,
            self.noncoaxiality_bound_deg,
            kind,
            flutter,
            least,
            direction,
            elevation,
        ]
    }

    /// Creates the point with these numbers.
    pub(super) fn from_numbers(numbers: [f64; 14]) -> Self {
        let [status, route, rest @ ..] = numbers;
        let [
            growth_order,
            growth_coefficient,
            direction_deg,
            elevation_deg,
            growth_bound,
            growth_rate,
            noncoaxiality_bound_deg,
            kind,
            max_imaginary_speed,
            min_squared_speed,
            slowest @ ..,
        ] = rest;
        let kind = value_at(&Hyperbolicity::ALL, kind);
        Self {
            status: value_at(&PointStatus::ALL, status).unwrap_or(PointStatus::OutsideModel),
            route: value_at(&Route::ALL, route),
            growth_order,
            growth_coefficient,
            direction_deg,
            elevation_deg,
            growth_bound,
            growth_rate,
            noncoaxiality_bound_deg,
            speeds: kind.map(|hyperbolicity| PointSpeeds {
                hyperbolicity,
                max_imaginary_speed,
                min_squared_speed,
                slowest_normal_deg: slowest,
            }),
        }
    }

    /// Returns whether two points have the same status, order of growth and type of characteristic speeds.
    pub fn has_verdict_of(&self, other: &Self) -> bool {
        let kind = |point: &Self| (point.status, point.speeds.map(|speeds| speeds.hyperbolicity));
        let order = |point: &Self| Some(point.growth_order).filter(|order| order.is_finite());
        kind(self) == kind(other) && order(self) == order(other)
    }

    /// Sets verdict and route; for ill-posed states also direction, order and coefficient of the growth.
    fn set_verdict(&mut self, verdict: Verdict, route: Route) {
        self.route = Some(route);
        self.status = match verdict {
            Verdict::WellPosed => PointStatus::WellPosed,
            Verdict::IllPosed { growth, direction } => {
                self.direction_deg = direction.to_degrees();
                if let Some(growth) = growth {
                    (self.growth_order, self.growth_coefficient) =
                        (growth.order.to_f64(), growth.coefficient);
                }
                PointStatus::IllPosed
            }
            Verdict::Marginal { .. } => PointStatus::Marginal,
            Verdict::Indeterminate { .. } => PointStatus::Indeterminate,
        };
    }
}

/// Returns the place of a value in the list of all.
fn place_in<V: PartialEq>(all: &[V], value: &V) -> f64 {
    all.iter().position(|own| own == value).map_or(f64::NAN, |place| place as f64)
}

/// Returns the value at a place in the list of all; `None` if the place is NaN.
fn value_at<V: Copy>(all: &[V], place: f64) -> Option<V> {
    (!place.is_nan()).then(|| all.get(place as usize).copied()).flatten()
}

/// Assessor of the points of a map, one instance per thread. From point to point only the swept numbers of `case`
/// change; swept model constants of flows change in `swept_flow` instead.
pub(super) struct PointAssessor<'a> {
    case: Case,
    map: &'a MapAxes,
    options: MapOptions,
    workspace: FlowWorkspace,
    solid_assessor: SolidAssessor<'a>,
    swept_flow: SweptFlow,
    equations_workspace: EquationsWorkspace,
}

/// Model of a flow whose swept constants change from point to point.
struct SweptFlow {
    /// Model with the last valid constants; `None` until constants are in range for the first time.
    model: Option<Model>,
    /// Present constants in the order of the parameters of the model, in SI units and rad.
    constants: Vec<f64>,
    /// Whether the constants differ from those of `model`.
    has_changed_constants: bool,
    /// Index and definition of the model constant that each axis sweeps; `None` if the axis sweeps another parameter.
    /// They are determined once per assessor, since the search compares names.
    swept_constants: [Option<(usize, &'static Parameter)>; 2],
}

impl SweptFlow {
    fn new(case: &Case, map: &MapAxes) -> Self {
        let constant = |sweep: &ParameterSweep| sweep.parameter.model_constant(case.material.kind);
        let swept_constants = [&map.x, &map.y].map(constant);
        Self {
            model: None,
            constants: case.model_constants(),
            has_changed_constants: true,
            swept_constants,
        }
    }

    /// Sets the swept constant of an axis, given in the unit of case files; returns false if the axis does not sweep a
    /// model constant.
    fn set_swept_constant(&mut self, axis: usize, value: f64) -> bool {
        let Some((index, constant)) = self.swept_constants[axis] else { return false };
        let value = constant.to_si(value);
        let own = &mut self.constants[index];
        self.has_changed_constants |= own.to_bits() != value.to_bits();
        *own = value;
        true
    }

    /// Returns the model with the present constants; updates it if they have changed since the last call.
    fn update_model(&mut self, kind: FlowKind) -> Result<&Model, InputError> {
        let Self { model, constants, has_changed_constants: is_stale, .. } = self;
        let model = match model {
            Some(model) => {
                if *is_stale {
                    model.set_constants(constants)?;
                }
                model
            }
            None => model.insert(Model::new(kind, constants)?),
        };
        *is_stale = false;
        Ok(model)
    }
}

impl<'a> PointAssessor<'a> {
    pub(super) fn new(
        case: &Case,
        map: &'a MapAxes,
        options: MapOptions,
        cache: &'a AcousticTensorCache,
    ) -> Self {
        let (workspace, solid_assessor) = (FlowWorkspace::default(), SolidAssessor::new(cache));
        let swept_flow = SweptFlow::new(case, map);
        let equations_workspace = EquationsWorkspace::default();
        Self {
            case: case.clone(),
            map,
            options,
            workspace,
            solid_assessor,
            swept_flow,
            equations_workspace,
        }
    }

    pub(super) fn assess_point(&mut self, x: usize, y: usize) -> Result<MapPoint, StateError> {
        self.assess_position([x as f64, y as f64])
    }

    /// Assesses the state at a position in units of the steps of the axes, which may lie between points.
    pub(super) fn assess_position(&mut self, position: [f64; 2]) -> Result<MapPoint, StateError> {
        self.set_position(position);
        match self.case.material.kind {
            ModelKind::Flow(kind) => self.assess_flow(kind),
            ModelKind::Solid(_) => match self.assess_solid() {
                Err(StateError::NoResponse(_)) => {
                    Ok(MapPoint::with_status(PointStatus::NoResponse))
                }
                assessed => assessed,
            },
            ModelKind::Equations => self.assess_equations(),
            ModelKind::Rheology => {
                Err(StateError::Input(self.case.material.unsuitable_kind_error()))
            }
        }
    }

    /// Sets the swept numbers of a position in units of the steps of the axes.
    fn set_position(&mut self, [x, y]: [f64; 2]) {
        let is_flow = matches!(self.case.material.kind, ModelKind::Flow(_));
        for (axis, (sweep, position)) in
            [(&self.map.x, x), (&self.map.y, y)].into_iter().enumerate()
        {
            let value = sweep.value_at(position);
            if !(is_flow && self.swept_flow.set_swept_constant(axis, value)) {
                self.case.set_number(sweep.parameter, value);
            }
        }
    }

    /// Computes growth rates in all directions, degrees, and the roots at the wave of the case, in the state at a
    /// position in units of the steps of the axes.
    pub(super) fn sample_position(
        &mut self,
        position: [f64; 2],
        directions_deg: &[f64],
    ) -> Result<WaveSample, StateError> {
        self.set_position(position);
        let Self { case, workspace, swept_flow, equations_workspace, .. } = self;
        let wave = case.material.numbers.wave;
        let no_state = || StateError::Input(case.material.unsuitable_kind_error());
        let finite = |roots| match roots {
            PencilRoots::Regular { finite, .. } => finite,
            PencilRoots::Singular { .. } => Vec::new(),
        };
        let roots_of: Box<dyn Fn(WaveNumbers) -> Result<Vec<Complex64>, StateError>> = match case
            .material
            .kind
        {
            ModelKind::Flow(kind) => {
                let model = swept_flow.update_model(kind)?;
                let Background::FullyDeforming(flow) = model.background(&case.to_flow_state())?
                else {
                    return Err(no_state());
                };
                workspace.linearise(model, &flow)?;
                let workspace = &*workspace;
                Box::new(move |wave: WaveNumbers| {
                    let direction = degrees_to_radians(wave.direction_deg);
                    Ok(match workspace.is_in_range(wave.wave_number) {
                        true => finite(workspace.pencil.roots(wave.wave_number, direction)),
                        false => Vec::new(),
                    })
                })
            }
            ModelKind::Solid(_) => {
                let solid = setup::solid::create_solid(&case.material)?;
                let waves = PlaneWaves::new(&solid)?;
                Box::new(move |wave: WaveNumbers| {
                    Ok(waves.roots(wave_normal(&wave), wave.wave_number))
                })
            }
            ModelKind::Equations => {
                let Some(equations) = &case.equations else { return Err(no_state()) };
                let model = &equations.model;
                equations_workspace
                    .linearise(model, &mut equations.state(&case.material.numbers))?;
                let workspace = &*equations_workspace;
                Box::new(move |wave: WaveNumbers| {
                    let [direction, elevation] =
                        [wave.direction_deg, wave.elevation_deg].map(degrees_to_radians);
                    Ok(finite(workspace.roots(model, wave.wave_number, direction, elevation)?))
                })
            }
            ModelKind::Rheology => return Err(no_state()),
        };
        let growth_rates = directions_deg.iter().map(|&direction_deg| {
            let roots = roots_of(WaveNumbers { direction_deg, ..wave })?;
            Ok(roots.iter().map(|root| root.re).fold(f64::NAN, f64::max))
        });
        Ok(WaveSample {
            wave_number: wave.wave_number,
            direction_deg: wave.direction_deg,
            growth_rates: growth_rates.collect::<Result<_, StateError>>()?,
            roots: roots_of(wave)?.iter().map(|root| [root.re, root.im]).collect(),
        })
    }

    fn assess_equations(&mut self) -> Result<MapPoint, StateError> {
        let Self { case, options, equations_workspace: workspace, .. } = self;
        let Some(equations) = &case.equations else {
            return Err(StateError::Input(case.material.unsuitable_kind_error()));
        };
        let (model, numbers) = (&equations.model, &case.material.numbers);
        let found = workspace.assess(model, &mut equations.state(numbers))?;
        let mut point = MapPoint::with_status(PointStatus::WellPosed);
        if options.computes_growth_rate {
            let WaveNumbers { wave_number, direction_deg, elevation_deg, .. } = numbers.wave;
            let [direction, elevation] = [direction_deg, elevation_deg].map(degrees_to_radians);
            let roots = workspace.roots(model, wave_number, direction, elevation)?;
            if let PencilRoots::Regular { finite, .. } = roots {
                point.growth_rate = finite.iter().map(|root| root.re).fold(f64::NAN, f64::max);
            }
        }
        if options.computes_bound {
            let supremum = workspace.locate_supremum(model, &found)?;
            point.growth_bound = supremum.map_or(f64::NAN, |(supremum, _)| supremum.growth_rate);
        }
        point.set_verdict(found.assessment.verdict, Route::ModelBlind);
        match found.direction.as_deref() {
            Some(&[x, y, z]) => {
                [point.direction_deg, point.elevation_deg] = angles_deg([x, y, z]);
            }
            Some([_]) => point.direction_deg = f64::NAN,
            _ => {}
        }
        Ok(point)
    }

    fn assess_solid(&mut self) -> Result<MapPoint, StateError> {
        let solid = setup::solid::create_solid(&self.case.material)?;
        let (assessment, of_polynomial) = self.solid_assessor.assess(&solid)?;
        let mut point = MapPoint::with_status(PointStatus::WellPosed);
        if self.options.computes_growth_rate {
            let wave = &self.case.material.numbers.wave;
            point.growth_rate =
                PlaneWaves::new(&solid)?.growth_rate(wave_normal(wave), wave.wave_number);
        }
        if self.options.computes_bound && assessment.verdict == Verdict::WellPosed {
            let found = of_polynomial.as_ref().and_then(|found| {
                bound::locate_supremum(&self.solid_assessor.plane_workspace.pencil, found, 0.0)
            });
            point.growth_bound = match found {
                Some(supremum) => supremum.growth_rate,
                None if solid.is_symmetric_hyperbolic() => 0.0,
                None => f64::NAN,
            };
        }
        point.speeds = Some(PointSpeeds {
            hyperbolicity: assessment.hyperbolicity,
            max_imaginary_speed: assessment
                .extremes
                .flutter
                .map_or(0.0, |flutter| flutter.max_imaginary_speed),
            min_squared_speed: match assessment.is_stationary() {
                true => 0.0,
                false => assessment.extremes.slowest.squared_speed,
            },
            slowest_normal_deg: angles_deg(assessment.extremes.slowest.normal),
        });
        point.set_verdict(assessment.verdict.clone(), Route::ModelBlind);
        if let Some([direction, elevation]) = assessment.direction_deg() {
            (point.direction_deg, point.elevation_deg) = (direction, elevation);
        }
        Ok(point)
    }

    fn assess_flow(&mut self, kind: FlowKind) -> Result<MapPoint, StateError> {
        let Self { case, options, workspace, swept_flow, .. } = self;
        let mut point = MapPoint::with_status(PointStatus::NotFullyDeforming);
        let model = swept_flow.update_model(kind)?;
        let Background::FullyDeforming(flow) = model.background(&case.to_flow_state())? else {
            return Ok(point);
        };
        point.noncoaxiality_bound_deg =
            model.noncoaxiality_bound().map_or(f64::NAN, f64::to_degrees);
        let (verdict, route) = if options.admits_closed_forms() {
            workspace.decide_verdict(model, &flow)?
        } else {
            let assessment = workspace.assess(model, &flow)?;
            if options.computes_growth_rate && !workspace.pencil.is_singular() {
                let wave = case.material.numbers.wave;
                point.growth_rate =
                    workspace.growth_rate(wave.wave_number, degrees_to_radians(wave.direction_deg));
            }
            if options.computes_bound && assessment.verdict == Verdict::WellPosed {
                let least = model.gradient_wave_number(&flow);
                point.growth_bound = bound::locate_supremum(&workspace.pencil, &assessment, least)
                    .map_or(f64::NAN, |supremum| supremum.growth_rate);
            }
            (assessment.verdict, Route::ModelBlind)
        };
        point.set_verdict(verdict, route);
        Ok(point)
    }
}
