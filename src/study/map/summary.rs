//! Result of a map and its summary: counts, intervals, fastest growth.

use super::{
    CertifiedMap, MapBoundaries, MapNumber, MapOptions, MapPoints, MapSamples, PointStatus,
};
use crate::case::{Case, MapAxes, ModelKind, ParameterSweep, SweepSpacing};
use analysis::flows::Route;
use analysis::solids::Hyperbolicity;
use serde::{Serialize, Serializer};

/// Result of a map: verdicts over two parameters, and their summary.
#[derive(Clone, Debug, Serialize)]
pub struct MapResult {
    /// Title of the case.
    pub title: String,
    /// Kind of the model, as named in case files.
    pub model: &'static str,
    /// Swept parameter of the horizontal axis.
    pub x: MapAxis,
    /// Swept parameter of the vertical axis.
    pub y: MapAxis,
    /// Number of points by the name of their [`PointStatus`], in the order of [`PointStatus::ALL`].
    #[serde(rename = "points", serialize_with = "serialize_as_object")]
    pub status_counts: [(&'static str, usize); 7],
    /// Number of ill-posed points without order: growth is unbounded at finite wave numbers.
    pub unbounded_at_finite_wave_number: usize,
    /// Fraction of well-posed states among all assessed states; `None` if none was assessed.
    #[serde(rename = "well_posed_share")]
    pub well_posed_fraction: Option<f64>,
    /// Well-posed intervals of x at up to five values of y, from the first to the last.
    pub well_posed_intervals: Vec<WellPosedIntervals>,
    /// Point of the fastest growth of short waves: highest order, then largest coefficient; `None` if no point has an
    /// order.
    #[serde(rename = "worst")]
    pub fastest_growth_point: Option<FastestGrowthPoint>,
    /// Number of verdicts by the name of their [`Route`], in the order of [`Route::ALL`].
    #[serde(rename = "route", serialize_with = "serialize_as_object")]
    pub route_counts: [(&'static str, usize); 2],
    /// Summary of the quantities that only solids have; `None` for flows.
    #[serde(flatten)]
    pub solid: Option<SolidMapSummary>,
    /// Results at all points of the map, with x varying fastest.
    #[serde(skip)]
    pub points: MapPoints,
    /// Verdicts proved over cells, only with [`MapOptions::is_certified`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub certified: Option<CertifiedMap>,
    /// Places where the verdict changes between neighbouring points.
    #[serde(skip)]
    pub boundaries: MapBoundaries,
    /// Requested options, with growth rates if the map sweeps the wave.
    #[serde(skip)]
    pub options: MapOptions,
    /// Growth curves and roots at a coarse grid of points, if they were [sampled](super::sample_map), for the report page.
    #[serde(skip)]
    pub samples: Option<MapSamples>,
}

/// Serialises pairs of names and numbers as an object.
pub(in crate::study) fn serialize_as_object<S: Serializer, N: Copy + Serialize>(
    pairs: &[(&'static str, N)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().copied())
}

/// Axis of a map: a swept parameter and its values.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapAxis {
    /// Name of the swept parameter in case files.
    pub parameter: String,
    /// Unit of the swept parameter in case files.
    pub unit: &'static str,
    /// First value of the swept parameter.
    #[serde(rename = "from")]
    pub first_value: f64,
    /// Last value of the swept parameter.
    #[serde(rename = "to")]
    pub last_value: f64,
    /// Number of values of the swept parameter.
    #[serde(rename = "points")]
    pub point_count: usize,
    /// Name of the spacing of the values in case files; `None` if it is linear.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<&'static str>,
    /// Axis label: quantity and symbol.
    #[serde(skip)]
    pub label: String,
    /// All values of the swept parameter.
    #[serde(skip)]
    pub values: Vec<f64>,
}

impl From<&ParameterSweep> for MapAxis {
    fn from(sweep: &ParameterSweep) -> Self {
        let ParameterSweep { parameter, first_value, last_value, point_count: points, spacing } =
            *sweep;
        Self {
            parameter: parameter.name(),
            unit: parameter.unit(),
            first_value,
            last_value,
            point_count: points,
            spacing: (spacing != SweepSpacing::Linear).then(|| spacing.name()),
            label: parameter.label(),
            values: (0..points).map(|index| sweep.sweep_value(index)).collect(),
        }
    }
}

/// Well-posed intervals of x at one value of y.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WellPosedIntervals {
    /// Value of the swept parameter on the vertical axis.
    pub y: f64,
    /// First and last value of x of each run of adjacent well-posed points.
    pub x: Vec<[f64; 2]>,
}

/// Point of a map with the fastest growth of short waves: highest order, then largest coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FastestGrowthPoint {
    /// Value of the swept parameter on the horizontal axis.
    pub x: f64,
    /// Value of the swept parameter on the vertical axis.
    pub y: f64,
    /// Order of growth in the wave number k.
    #[serde(rename = "order")]
    pub growth_order: f64,
    /// Growth coefficient lim Re ς / k^order as k → ∞, m^order/s.
    #[serde(rename = "coefficient")]
    pub growth_coefficient: f64,
    /// Direction of the wave vector of fastest growth, degrees.
    pub direction_deg: f64,
    /// Elevation of the wave vector of fastest growth above the plane of x₁ and x₂, degrees; solids only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub elevation_deg: Option<f64>,
}

/// Part of the summary that only maps of solids have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SolidMapSummary {
    /// Name of the yield set; `None` for elastic solids.
    #[serde(rename = "yield")]
    pub yield_set: Option<&'static str>,
    /// Number of states by the name of their [`Hyperbolicity`], in the order of [`Hyperbolicity::ALL`].
    #[serde(serialize_with = "serialize_as_object")]
    #[serde(rename = "hyperbolicity")]
    pub hyperbolicity_counts: [(&'static str, usize); 4],
}

impl MapResult {
    pub(super) fn new(
        case: &Case,
        map: &MapAxes,
        options: MapOptions,
        points: MapPoints,
        boundaries: MapBoundaries,
        certified: Option<CertifiedMap>,
    ) -> Self {
        let mut counts = PointStatus::ALL.map(|status| (status, 0));
        let mut route_counts = Route::ALL.map(|route| (route.name(), 0));
        let mut hyperbolicity_counts = Hyperbolicity::ALL.map(|own| (own.name(), 0));
        let mut unbounded_count = 0;
        for point in points.iter() {
            let of_place = |place: usize| usize::from(place == point.status as usize);
            counts.iter_mut().enumerate().for_each(|(place, own)| own.1 += of_place(place));
            if let Some(route) = point.route {
                route_counts[route as usize].1 += 1;
            }
            if let Some(speeds) = point.speeds {
                hyperbolicity_counts[speeds.hyperbolicity as usize].1 += 1;
            }
            let is_unbounded = point.status == PointStatus::IllPosed && point.growth_order.is_nan();
            unbounded_count += usize::from(is_unbounded);
        }
        let states: usize =
            counts.iter().filter(|(status, _)| status.has_state()).map(|(_, count)| count).sum();
        let well_posed = counts[PointStatus::WellPosed as usize].1;
        let is_solid = matches!(case.material.kind, ModelKind::Solid(_));
        Self {
            title: case.title.clone(),
            model: case.material.kind.name(),
            x: MapAxis::from(&map.x),
            y: MapAxis::from(&map.y),
            status_counts: counts.map(|(status, count)| (status.name(), count)),
            unbounded_at_finite_wave_number: unbounded_count,
            well_posed_fraction: (states > 0).then(|| well_posed as f64 / states as f64),
            well_posed_intervals: sample_intervals(map, &points),
            fastest_growth_point: find_fastest_growth_point(map, &points, is_solid),
            route_counts,
            solid: is_solid.then(|| SolidMapSummary {
                yield_set: case.material.yield_set.map(|set| set.name),
                hyperbolicity_counts,
            }),
            points,
            certified,
            boundaries,
            options,
            samples: None,
        }
    }
}

fn find_fastest_growth_point(
    map: &MapAxes,
    points: &MapPoints,
    is_solid: bool,
) -> Option<FastestGrowthPoint> {
    let mut worst: Option<(usize, (f64, f64))> = None;
    for index in 0..points.len() {
        let key = [MapNumber::GrowthOrder, MapNumber::GrowthCoefficient]
            .map(|which| points.number(which, index));
        let key = (key[0], key[1]);
        if key.0.is_finite() && worst.is_none_or(|(_, other)| key > other) {
            worst = Some((index, key));
        }
    }
    let index = worst?.0;
    let point = points.get(index);
    Some(FastestGrowthPoint {
        x: map.x.sweep_value(index % map.x.point_count),
        y: map.y.sweep_value(index / map.x.point_count),
        growth_order: point.growth_order,
        growth_coefficient: point.growth_coefficient,
        direction_deg: point.direction_deg,
        elevation_deg: is_solid.then_some(point.elevation_deg),
    })
}

fn sample_intervals(map: &MapAxes, points: &MapPoints) -> Vec<WellPosedIntervals> {
    let last = map.y.point_count - 1;
    let mut rows = vec![0, last / 4, last / 2, 3 * last / 4, last];
    rows.dedup();
    let intervals = rows.into_iter().map(|row| {
        let is_well_posed = |column: usize| {
            points.has_status(row * map.x.point_count + column, PointStatus::WellPosed)
        };
        WellPosedIntervals {
            y: map.y.sweep_value(row),
            x: find_well_posed_intervals(&map.x, is_well_posed),
        }
    });
    intervals.collect()
}

/// Returns the first and last value of x of each run of adjacent well-posed points.
fn find_well_posed_intervals(
    x: &ParameterSweep,
    is_well_posed: impl Fn(usize) -> bool,
) -> Vec<[f64; 2]> {
    let mut intervals: Vec<[f64; 2]> = Vec::new();
    let mut was_well = false;
    for i in 0..x.point_count {
        let is_well = is_well_posed(i);
        match intervals.last_mut() {
            Some(last) if is_well && was_well => last[1] = x.sweep_value(i),
            _ if is_well => intervals.push([x.sweep_value(i); 2]),
            _ => {}
        }
        was_well = is_well;
    }
    intervals
}
