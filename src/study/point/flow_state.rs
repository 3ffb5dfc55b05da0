//! Analysis of a fully deforming state of a flow in one model.

use super::background::{FlowBackground, FlowStress};
use super::order_and_coefficient;
use crate::setup::check::flow::FlowWave;
use crate::study::format::describe_evidence;
use analysis::bound::{self, Supremum, SupremumWaveNumber};
use analysis::characteristics::{self, Characteristics, EquationType};
use analysis::flows::FLOW_ROUTE;
use analysis::flows::growth_curves::GrowthPoint;
use analysis::growth::{Assessment, Verdict};
use analysis::pencil::PencilRoots;
use models::flow::state::{DeformingFlow, YieldRegion};
use models::flow::{Model, Slip};
use num_complex::Complex64;
use serde::Serialize;

/// Analysis of a fully deforming state of a flow in one model.
#[derive(Clone, Debug, Serialize)]
pub struct YieldingState {
    /// Name of the verdict on the well-posedness of the model in this state.
    pub verdict: &'static str,
    /// Order of growth in the wave number k as k → ∞; `None` unless ill-posed, or if growth is unbounded at finite wave
    /// numbers.
    #[serde(rename = "order")]
    pub growth_order: Option<f64>,
    /// Growth coefficient lim Re ς / k^order as k → ∞, m^order/s; `None` without `growth_order`.
    #[serde(rename = "coefficient")]
    pub growth_coefficient: Option<f64>,
    /// Direction of the wave vector of fastest or unbounded growth, from x₁, degrees; `None` unless ill-posed.
    pub direction_deg: Option<f64>,
    /// Order of growth in k, fitted to the largest growth rate over all directions at the largest sampled wave numbers;
    /// `None` unless all growth rates there are finite and positive.
    pub fitted_order: Option<f64>,
    /// Smallest and largest wave number of the fit, 1/m; `None` without `fitted_order`.
    pub fitted_wave_numbers: Option<[f64; 2]>,
    /// Supremum of the growth rate Re ς over all directions and wave numbers k ≥ `gradient_wave_number`, 1/s; `None`
    /// unless well-posed, or if this wave number exceeds the range of the search.
    #[serde(rename = "bound")]
    pub growth_bound: Option<f64>,
    /// Wave vector at which the supremum `growth_bound` is attained or approached; `None` without supremum.
    #[serde(rename = "bound_at")]
    pub supremum_location: Option<SupremumLocation>,
    /// Relative tolerance of `growth_bound`; `None` without it.
    pub bound_tolerance: Option<f64>,
    /// Closed-form bound of the model on the non-coaxiality |Δ|, degrees, below which the leading growth rate is not
    /// positive in any direction.
    pub noncoaxiality_bound_deg: Option<f64>,
    /// Name of the region of the yield conditions in which the state is.
    #[serde(rename = "region")]
    pub yield_region: &'static str,
    /// Internal power of the stress, W/m³.
    #[serde(rename = "power")]
    pub internal_power: f64,
    /// Slip on both families of slip lines; `None` for a coaxial model.
    pub slip: Option<[SlipRate; 2]>,
    /// Wave number and direction given in the case.
    pub wave: FlowWave,
    /// Finite dispersion roots at `wave`, Re ς and Im ς, 1/s; `None` if every ς is a root.
    #[serde(rename = "roots")]
    pub dispersion_roots: Option<Vec<[f64; 2]>>,
    /// Number of infinite dispersion roots, which are due to algebraic equations; `None` if every ς is a root.
    #[serde(rename = "infinite_roots")]
    pub infinite_root_count: Option<usize>,
    /// Real characteristics of the steady equations; `None` if the equations do not determine their unknowns.
    pub characteristics: Option<Vec<CharacteristicDirection>>,
    /// Complex characteristics of the steady equations; `None` as for `characteristics`.
    pub complex_characteristics: Option<Vec<ComplexCharacteristic>>,
    /// Families of fields for which every direction is characteristic, such as convected fields in a material at rest;
    /// `None` as for `characteristics`.
    pub arbitrary_characteristics: Option<Vec<String>>,
    /// Type of the steady equations: hyperbolic, mixed or elliptic; `None` without characteristics.
    pub steady_type: Option<&'static str>,
    /// Evidence on which the verdict is based.
    pub evidence: Evidence,
    /// Background flow: given and derived quantities.
    pub background: FlowBackground,
    /// Stress of the fully deforming state.
    pub stress: FlowStress,
    /// Wave number of the background gradients, 1/m. The frozen-coefficient analysis is valid for wave numbers much
    /// larger than this.
    pub gradient_wave_number: f64,
    /// Background flow, whose quantities have rounding bounds.
    #[serde(skip)]
    pub flow: DeformingFlow,
    /// Verdict with its evidence and the rounding bounds of its quantities.
    #[serde(skip)]
    pub assessment: Assessment,
    /// Rank of the linearised equations if every ς is a root; `None` otherwise.
    #[serde(skip)]
    pub equation_rank: Option<usize>,
    /// Largest Re ς of all roots at the wave number of the case by direction: degrees, 1/s; empty if every ς is a
    /// root.
    #[serde(skip)]
    pub growth_by_direction: Vec<[f64; 2]>,
    /// Growth rates, 1/s, against the wave number, 1/m: in the direction of the case, and the maximum over all
    /// directions.
    #[serde(skip)]
    pub growth_by_wave_number: Vec<GrowthPoint>,
}

impl YieldingState {
    /// Creates the analysis from model, background flow and verdict, without roots, characteristics and supremum.
    pub(super) fn new(
        wave: FlowWave,
        model: &Model,
        flow: DeformingFlow,
        assessment: Assessment,
    ) -> Self {
        let [order, coefficient] = order_and_coefficient(&assessment.verdict);
        let direction_deg = match assessment.verdict {
            Verdict::IllPosed { direction, .. } => Some(direction.to_degrees()),
            _ => None,
        };
        Self {
            verdict: assessment.verdict.name(),
            growth_order: order,
            growth_coefficient: coefficient,
            direction_deg,
            fitted_order: None,
            fitted_wave_numbers: None,
            growth_bound: None,
            supremum_location: None,
            bound_tolerance: None,
            noncoaxiality_bound_deg: model.noncoaxiality_bound().map(f64::to_degrees),
            yield_region: YieldRegion::FullyDeforming.name(),
            internal_power: flow.internal_power,
            slip: model.slips(&flow).map(|slips| slips.map(SlipRate::from)),
            wave,
            dispersion_roots: None,
            infinite_root_count: None,
            characteristics: None,
            complex_characteristics: None,
            arbitrary_characteristics: None,
            steady_type: None,
            evidence: Evidence::from(&assessment),
            background: FlowBackground::from(&flow),
            stress: FlowStress::from(&flow.stress),
            gradient_wave_number: model.gradient_wave_number(&flow),
            flow,
            assessment,
            equation_rank: None,
            growth_by_direction: Vec::new(),
            growth_by_wave_number: Vec::new(),
        }
    }

    /// Adds the dispersion roots at the wave vector of the case.
    pub(super) fn with_roots(self, roots: &PencilRoots) -> Self {
        match roots {
            PencilRoots::Regular { finite, infinite } => Self {
                dispersion_roots: Some(finite.iter().map(to_pair).collect()),
                infinite_root_count: Some(*infinite),
                ..self
            },
            PencilRoots::Singular { rank } => Self { equation_rank: Some(*rank), ..self },
        }
    }

    /// Adds the characteristics of the steady equations.
    pub(super) fn with_characteristics(self, found: Option<Characteristics>) -> Self {
        let Some(Characteristics {
            real,
            complex,
            arbitrary_families: arbitrary,
            equation_type: kind,
        }) = found
        else {
            return self;
        };
        let complex = complex
            .into_iter()
            .map(|(tangent, family)| ComplexCharacteristic { tangent: to_pair(&tangent), family });
        Self {
            characteristics: Some(real.into_iter().map(CharacteristicDirection::from).collect()),
            complex_characteristics: Some(complex.collect()),
            arbitrary_characteristics: Some(arbitrary),
            steady_type: kind.map(equation_type_name),
            ..self
        }
    }

    /// Adds the supremum of the growth rate of all waves.
    pub(super) fn with_supremum(self, supremum: Option<Supremum>) -> Self {
        Self {
            growth_bound: supremum.map(|supremum| supremum.growth_rate),
            supremum_location: supremum.map(SupremumLocation::from),
            bound_tolerance: supremum.map(|_| bound::SUPREMUM_TOLERANCE),
            ..self
        }
    }
}

fn to_pair(z: &Complex64) -> [f64; 2] {
    [z.re, z.im]
}

fn equation_type_name(kind: EquationType) -> &'static str {
    match kind {
        EquationType::Hyperbolic => "hyperbolic",
        EquationType::Mixed => "mixed",
        EquationType::Elliptic => "elliptic",
    }
}

/// Wave vector at which the supremum of the growth rate is attained or approached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SupremumLocation {
    /// Wave number at which the supremum is attained, 1/m; `None` if it is only approached.
    #[serde(rename = "number")]
    pub wave_number: Option<f64>,
    /// Direction of the wave vector from x₁, degrees, in \[0, 180).
    pub direction_deg: f64,
    /// Limit in which the supremum is approached; `None` if it is attained.
    pub limit: Option<WaveLimit>,
}

/// Limit of wave numbers in which a supremum is approached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum WaveLimit {
    /// The longest waves of the searched range of wave numbers.
    #[serde(rename = "longest waves")]
    LongWaves,
    /// Short-wave limit k → ∞.
    #[serde(rename = "shortest waves")]
    ShortWaves,
}

impl From<Supremum> for SupremumLocation {
    fn from(supremum: Supremum) -> Self {
        let (number, limit) = match supremum.wave_number {
            SupremumWaveNumber::Attained(number) => (Some(number), None),
            SupremumWaveNumber::LongWaves => (None, Some(WaveLimit::LongWaves)),
            SupremumWaveNumber::ShortWaves => (None, Some(WaveLimit::ShortWaves)),
        };
        Self { wave_number: number, direction_deg: supremum.direction.to_degrees(), limit }
    }
}

/// Real characteristic direction of the steady equations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CharacteristicDirection {
    /// Angle of the characteristic curve from x₁, degrees, in \[0, 180).
    pub angle_deg: f64,
    /// Multiplicity of the direction as a root of the characteristic determinant.
    pub multiplicity: usize,
    /// Fields that may jump across the characteristic.
    pub family: String,
}

impl From<characteristics::RealCharacteristic> for CharacteristicDirection {
    fn from(found: characteristics::RealCharacteristic) -> Self {
        let characteristics::RealCharacteristic { angle, multiplicity, family, .. } = found;
        Self { angle_deg: angle.to_degrees(), multiplicity, family }
    }
}

/// Slip on a family of slip lines (Harris & Grekova 2005, eq. 38).
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SlipRate {
    /// Angle of the slip lines from x₁, degrees, in \[0, 180).
    pub angle_deg: f64,
    /// Rate of slip, 1/s; negative if reversed, against the shear stress on the lines.
    pub rate: f64,
}

impl From<Slip> for SlipRate {
    fn from(slip: Slip) -> Self {
        let degrees = slip.angle.to_degrees().rem_euclid(180.0);
        // Rates that vanish within rounding have no sign.
        let rate = slip.rate.sign().map_or(0.0, |_| slip.rate.value);
        Self { angle_deg: if degrees < 180.0 { degrees } else { 0.0 }, rate }
    }
}

/// Complex characteristic direction of the steady equations.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComplexCharacteristic {
    /// Tangent of the complex angle: real and imaginary part.
    pub tangent: [f64; 2],
    /// Fields that may jump across the characteristic.
    pub family: String,
}

/// Evidence on which the verdict on a flow is based.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evidence {
    /// Description of the evidence as text.
    #[serde(rename = "words")]
    pub description: String,
    /// Numbers of unbounded dispersion roots in a general direction by their order in k, highest order first.
    pub orders: Vec<OrderCount>,
    /// Directions of the wave vector in which a leading coefficient vanishes, degrees.
    pub degenerate_directions_deg: Vec<f64>,
    /// Method by which the verdict was obtained: closed form or linearised equations.
    pub route: &'static str,
}

/// Number of dispersion roots that grow or decay with the same order of the wave number k.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OrderCount {
    /// Order of growth or decay in the wave number k.
    #[serde(rename = "order")]
    pub growth_order: f64,
    /// Number of dispersion roots of this order.
    #[serde(rename = "roots")]
    pub root_count: usize,
}

impl From<&Assessment> for Evidence {
    fn from(assessment: &Assessment) -> Self {
        let orders = assessment.orders.iter();
        let degenerate = assessment.degenerate_directions.iter();
        Self {
            description: describe_evidence(&assessment.verdict),
            orders: orders
                .map(|&(order, roots)| OrderCount {
                    growth_order: order.to_f64(),
                    root_count: roots,
                })
                .collect(),
            degenerate_directions_deg: degenerate.map(|d| d.angle.to_degrees()).collect(),
            route: FLOW_ROUTE,
        }
    }
}
