//! Uniaxial diagram of a rheological scheme: its response to a path of strain or stress, with the energies of its
//! elements.

use crate::Error;
use crate::case::{Case, RheologyCase};
use models::rheology::element::Element;
use models::rheology::load_path::{Activity, DiagramSegment, ResponsePoint};
use models::rheology::scheme::{LoadControl, RheologicalScheme};
use serde::Serialize;

/// Response of a rheological scheme to its load path.
#[derive(Clone, Debug, Serialize)]
pub struct DiagramResult {
    /// Kind of the scheme in case files: a name, or `tree`.
    pub scheme: &'static str,
    /// Notation of the tree: `-` in series, `|` in parallel.
    pub tree: String,
    /// Prescribed quantity: `strain` or `stress`.
    pub control: &'static str,
    /// Number of implicit steps.
    pub steps: usize,
    /// Lowest and highest stress, Pa.
    #[serde(rename = "stress")]
    pub stress_range: [f64; 2],
    /// Lowest and highest strain.
    #[serde(rename = "strain")]
    pub strain_range: [f64; 2],
    /// Work of the stress per volume, J/m³.
    pub work: f64,
    /// Energy stored in springs at the end per volume, J/m³.
    pub stored_energy: f64,
    /// Energy dissipated by dampers and hinges per volume, J/m³.
    pub dissipated_energy: f64,
    /// Loss of jumps of the load and of the implicit steps per volume, J/m³; that of steps vanishes with their length.
    pub step_loss: f64,
    /// Largest residual of the energy ledger, relative to the largest energy.
    pub ledger_residual: f64,
    /// Elements at the end of the path.
    pub elements: Vec<ElementResult>,
    /// Parts of the diagram in which no hinge and no contact changes its activity.
    pub segments: Vec<SegmentResult>,
    /// The scheme.
    #[serde(skip)]
    pub rheological_scheme: RheologicalScheme,
    /// States along the path.
    #[serde(skip)]
    pub response: Vec<ResponsePoint>,
}

/// An element at the end of the path.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ElementResult {
    /// Name.
    pub name: String,
    /// Kind, e.g. `spring`.
    pub kind: &'static str,
    /// Strain.
    pub strain: f64,
    /// Stress, Pa.
    pub stress: f64,
    /// Stored energy per volume, J/m³.
    pub stored_energy: f64,
    /// Dissipated energy per volume, J/m³.
    pub dissipated_energy: f64,
    /// Loss of the implicit steps per volume, J/m³.
    pub step_loss: f64,
}

/// A part of the diagram.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SegmentResult {
    /// Times at start and end, s.
    pub time: [f64; 2],
    /// Strains at start and end.
    pub strain: [f64; 2],
    /// Stresses at start and end, Pa.
    pub stress: [f64; 2],
    /// Slope dσ/dε, Pa; `None` where the diagram of a scheme with dampers is curved or the strain constant.
    pub slope: Option<f64>,
    /// Names of the hinges that flow in tension.
    pub tensile_flow: Vec<String>,
    /// Names of the hinges that flow in compression.
    pub compressive_flow: Vec<String>,
    /// Names of the closed contacts.
    pub closed: Vec<String>,
}

/// Computes the response of the rheological scheme of a case to its load path.
///
/// ```
/// use wellposed::case::Case;
///
/// let text = "
/// [rheology]
/// kind = 'porous-elastic'
/// skeleton_modulus = 1e9
/// contact_modulus = 3e9
/// porosity = 0.02
/// [load_path]
/// points = [[0, 0], [1, -0.05]]
/// ";
/// let found = wellposed::compute_diagram(&Case::parse(text, "pores.toml", &[])?)?;
/// let slopes: Vec<_> = found.segments.iter().map(|segment| segment.slope).collect();
/// assert_eq!(slopes, [Some(1e9), Some(4e9)]);
/// // σ = aε + b(ε + θ₀) for ε < −θ₀.
/// assert!((found.stress_range[0] + 1.4e8).abs() < 1.0);
/// # Ok::<(), wellposed::Error>(())
/// ```
///
/// # Errors
/// The case has no rheological scheme, or the scheme cannot follow the path.
pub fn compute_diagram(case: &Case) -> Result<DiagramResult, Error> {
    let rheology = case.require_rheology()?;
    let RheologyCase { scheme, path, .. } = rheology;
    let response =
        scheme.compute_response(path).map_err(|error| rheology.locate_response_error(&error))?;
    let segments = scheme.find_segments(&response);
    let range = |value: fn(&ResponsePoint) -> f64| {
        response
            .iter()
            .map(value)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
    };
    let (mut largest_energy, mut largest_residual): (f64, f64) = (0.0, 0.0);
    for ResponsePoint { state, .. } in &response {
        let energies = [state.stored_energy(scheme), state.dissipated_energy(), state.step_loss()];
        largest_energy = energies.into_iter().fold(largest_energy.max(state.work.abs()), f64::max);
        largest_residual = largest_residual.max(state.ledger_residual(scheme).abs());
    }
    let last = response.last().map_or_else(|| scheme.rest_state(), |point| point.state.clone());
    let element = |(own, state): (&models::rheology::scheme::NamedElement, _)| {
        let state: &models::rheology::element::ElementState = state;
        ElementResult {
            name: own.name.clone(),
            kind: own.element.kind(),
            strain: state.strain,
            stress: state.stress,
            stored_energy: own.element.stored_energy(state),
            dissipated_energy: state.dissipated_energy,
            step_loss: state.step_loss,
        }
    };
    Ok(DiagramResult {
        scheme: rheology.kind,
        tree: scheme.notation(),
        control: match path.control() {
            LoadControl::Strain => "strain",
            LoadControl::Stress => "stress",
        },
        steps: response.len() - 1,
        stress_range: range(|point| point.state.stress),
        strain_range: range(|point| point.state.strain),
        work: last.work,
        stored_energy: last.stored_energy(scheme),
        dissipated_energy: last.dissipated_energy(),
        step_loss: last.step_loss(),
        ledger_residual: match largest_energy > 0.0 {
            true => largest_residual / largest_energy,
            false => 0.0,
        },
        elements: scheme.elements().iter().zip(&last.elements).map(element).collect(),
        segments: segments.iter().map(|own| summarise_segment(scheme, &response, own)).collect(),
        rheological_scheme: scheme.clone(),
        response,
    })
}

fn summarise_segment(
    scheme: &RheologicalScheme,
    response: &[ResponsePoint],
    segment: &DiagramSegment,
) -> SegmentResult {
    let ends = [&response[segment.start], &response[segment.end]];
    let named = |activity: Activity| {
        let pairs = scheme.elements().iter().zip(&segment.activities);
        pairs.filter(|(_, own)| **own == activity).map(|(own, _)| own.name.clone()).collect()
    };
    SegmentResult {
        time: ends.map(|point| point.time),
        strain: ends.map(|point| point.state.strain),
        stress: ends.map(|point| point.state.stress),
        slope: segment
            .slope
            .or_else(|| find_straight_slope(&response[segment.start..=segment.end])),
        tensile_flow: named(Activity::TensileFlow),
        compressive_flow: named(Activity::CompressiveFlow),
        closed: named(Activity::Closed),
    }
}

/// Returns the slope of a part of a response that is straight: whose stresses are on the chord of its ends within 10⁻⁶ of
/// the largest stress.
fn find_straight_slope(part: &[ResponsePoint]) -> Option<f64> {
    const TOLERANCE: f64 = 1e-6;
    let [first, .., last] = part else { return None };
    let slope = (last.state.stress - first.state.stress) / (last.state.strain - first.state.strain);
    let chord = |strain: f64| first.state.stress + slope * (strain - first.state.strain);
    let largest = part.iter().map(|point| point.state.stress.abs()).fold(0.0, f64::max);
    let is_on_chord = |point: &ResponsePoint| {
        (point.state.stress - chord(point.state.strain)).abs() <= TOLERANCE * largest
    };
    (slope.is_finite() && part.iter().all(is_on_chord)).then_some(slope)
}

impl DiagramResult {
    /// Returns whether the scheme has a contact.
    pub fn has_contact(&self) -> bool {
        let elements = self.rheological_scheme.elements();
        elements.iter().any(|own| matches!(own.element, Element::Contact { .. }))
    }
}
