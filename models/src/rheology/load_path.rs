//! Response of a rheological scheme to a path of strain or stress against time: the uniaxial diagram.

use super::element::{Element, ElementState};
use super::scheme::{LoadControl, RheologicalScheme, SchemeError};
use super::step::{SchemeState, StepError};
use crate::common::decimal::{format_exact, format_rounded};

/// Maximum number of steps of a load path.
pub const MAX_STEPS: usize = 100_000;

/// Strain or stress prescribed against time, linear between points. The scheme is at rest before the first point; a
/// first value other than 0 is applied as a jump.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadPath {
    control: LoadControl,
    points: Vec<[f64; 2]>,
    steps_per_segment: usize,
}

/// Reason why a load path is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LoadPathError {
    /// There are fewer than two points.
    #[error("a path needs at least two points")]
    TooFewPoints,
    /// A number is not finite.
    #[error("a time, strain or stress is not finite")]
    NotFinite,
    /// A time is not above that of the point before.
    #[error("the time {} s is not above that of the point before", format_exact(*.0))]
    TimeNotIncreasing(f64),
    /// The rate of a cyclic path is not positive, or a segment would take no or infinite time.
    #[error(
        "the rate {} is not positive, or so small or large that a segment has no finite duration",
        format_exact(*.0)
    )]
    Rate(f64),
    /// There are no steps, or too many.
    #[error("{0} steps in total; expected 1 to {MAX_STEPS}")]
    StepCount(usize),
}

/// Reason why a diagram cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ResponseError {
    /// The control of the path does not determine strain and stress of the scheme.
    #[error(transparent)]
    Scheme(#[from] SchemeError),
    /// A step has no end state.
    #[error("at the time {} s {error}", format_rounded(*.time))]
    Step {
        /// Time at the end of the step, s.
        time: f64,
        /// Reason.
        error: StepError,
    },
}

/// State at a time of a load path.
#[derive(Clone, Debug, PartialEq)]
pub struct ResponsePoint {
    /// Time, s.
    pub time: f64,
    /// Segment of the load path that ends or continues here, counted from 0; `None` before the first segment.
    pub path_segment: Option<usize>,
    /// State at the end of the step.
    pub state: SchemeState,
    /// Activity of each element in the step that ends here.
    pub activities: Vec<Activity>,
}

/// Activity of an element in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Spring or damper.
    Regular,
    /// Hinge that does not flow.
    Locked,
    /// Hinge that flows in tension, σ = σ⁺.
    TensileFlow,
    /// Hinge that flows in compression, σ = −σ⁻.
    CompressiveFlow,
    /// Contact that is open at the end of the step.
    Open,
    /// Contact that is closed at the end of the step.
    Closed,
}

/// Part of a diagram in which no element changes its activity.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagramSegment {
    /// Index of the point of the response at which the part starts.
    pub start: usize,
    /// Index of the point at which it ends.
    pub end: usize,
    /// Slope dσ/dε, Pa; `None` in schemes with dampers, whose diagrams are curved.
    pub slope: Option<f64>,
    /// Activity of each element.
    pub activities: Vec<Activity>,
}

impl LoadPath {
    /// Creates a path through points of time (s) and strain or stress (Pa), with equal steps between two points.
    ///
    /// # Errors
    /// There are fewer than two points, the times do not increase, a number is not finite, or the number of steps is
    /// out of range.
    pub fn new(
        control: LoadControl,
        points: Vec<[f64; 2]>,
        steps_per_segment: usize,
    ) -> Result<Self, LoadPathError> {
        if points.len() < 2 {
            return Err(LoadPathError::TooFewPoints);
        }
        if !points.iter().flatten().all(|value| value.is_finite()) {
            return Err(LoadPathError::NotFinite);
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[0][0] >= pair[1][0]) {
            return Err(LoadPathError::TimeNotIncreasing(pair[1][0]));
        }
        let count = steps_per_segment.saturating_mul(points.len() - 1);
        if !(1..=MAX_STEPS).contains(&count) {
            return Err(LoadPathError::StepCount(count));
        }
        Ok(Self { control, points, steps_per_segment })
    }

    /// Creates a path from rest through `turning_values` of strain or stress (Pa), `cycles` times in turn, with the
    /// rate `rate` > 0 of the value (1/s or Pa/s). Equal values in succession are one.
    ///
    /// # Errors
    /// The rate is not positive, or an error of [`new`](Self::new).
    pub fn from_cycles(
        control: LoadControl,
        turning_values: &[f64],
        cycles: usize,
        rate: f64,
        steps_per_segment: usize,
    ) -> Result<Self, LoadPathError> {
        let count = turning_values.len().saturating_mul(cycles);
        if count > MAX_STEPS {
            return Err(LoadPathError::StepCount(count.saturating_mul(steps_per_segment)));
        }
        let mut points = vec![[0.0, 0.0]];
        let mut last = [0.0, 0.0];
        for &value in turning_values.iter().cycle().take(count) {
            if !value.is_finite() {
                return Err(LoadPathError::NotFinite);
            }
            if value == last[1] {
                continue;
            }
            let time = last[0] + (value - last[1]).abs() / rate;
            if !(rate > 0.0 && time.is_finite() && time > last[0]) {
                return Err(LoadPathError::Rate(rate));
            }
            last = [time, value];
            points.push(last);
        }
        Self::new(control, points, steps_per_segment)
    }

    /// Returns the control of the path.
    pub fn control(&self) -> LoadControl {
        self.control
    }

    /// Returns the points of time (s) and strain or stress (Pa).
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Returns the number of steps between two points.
    pub fn steps_per_segment(&self) -> usize {
        self.steps_per_segment
    }
}

impl RheologicalScheme {
    /// Computes the states along a load path, from rest: the state at rest, the state after a jump to the first value
    /// if it is not 0, and the state at the end of every step.
    ///
    /// # Errors
    /// The control does not determine strain and stress of the scheme, or a step has no end state.
    pub fn compute_response(&self, path: &LoadPath) -> Result<Vec<ResponsePoint>, ResponseError> {
        self.check_control(path.control)?;
        let [start, first] = path.points[0];
        let mut state = self.rest_state();
        let mut response = Vec::with_capacity(path.steps_per_segment * path.points.len());
        response.push(self.create_point(start, None, &state, &state));
        let mut step = |state: &mut SchemeState, time, duration, target, path_segment| {
            let last = state.clone();
            self.advance(state, path.control, target, duration)
                .map_err(|error| ResponseError::Step { time, error })?;
            response.push(self.create_point(time, path_segment, &last, state));
            Ok::<(), ResponseError>(())
        };
        if first != 0.0 {
            step(&mut state, start, 0.0, first, None)?;
        }
        for (index, pair) in path.points.windows(2).enumerate() {
            let [[from_time, from], [to_time, to]] = [pair[0], pair[1]];
            let count = path.steps_per_segment;
            let duration = (to_time - from_time) / count as f64;
            for number in 1..=count {
                // The ends of the segment are exact.
                let at = |from: f64, to: f64| {
                    if number == count {
                        return to;
                    }
                    let share = number as f64 / count as f64;
                    from * (1.0 - share) + to * share
                };
                step(&mut state, at(from_time, to_time), duration, at(from, to), Some(index))?;
            }
        }
        Ok(response)
    }

    /// Divides a response into parts in which no element changes its activity. A new part starts at each point of the
    /// load path. A change inside a step counts from the start of that step.
    pub fn find_segments(&self, response: &[ResponsePoint]) -> Vec<DiagramSegment> {
        let has_damper = self.has_damper();
        let mut segments: Vec<DiagramSegment> = Vec::new();
        for (index, pair) in response.windows(2).enumerate() {
            let [last, point] = [&pair[0], &pair[1]];
            // The activities determine the slope; that of the first step may belong to the part before.
            let slope = (!has_damper).then_some(point.state.tangent_modulus);
            let continued = segments.last_mut().filter(|own| {
                own.activities == point.activities && last.path_segment == point.path_segment
            });
            match continued {
                Some(own) => (own.end, own.slope) = (index + 1, slope),
                None => segments.push(DiagramSegment {
                    start: index,
                    end: index + 1,
                    slope,
                    activities: point.activities.clone(),
                }),
            }
        }
        segments
    }

    fn create_point(
        &self,
        time: f64,
        path_segment: Option<usize>,
        last: &SchemeState,
        state: &SchemeState,
    ) -> ResponsePoint {
        let increment = |index: usize| state.elements[index].strain - last.elements[index].strain;
        let count = state.elements.len();
        let largest = |value: &dyn Fn(usize) -> f64| {
            (0..count).map(|index| value(index).abs()).fold(0.0, f64::max)
        };
        let scales = [largest(&increment), largest(&|index| state.elements[index].stress)];
        let activity = |index: usize| {
            let element = &self.elements()[index].element;
            find_activity(element, &state.elements[index], increment(index), scales)
        };
        let activities = (0..count).map(activity).collect();
        ResponsePoint { time, path_segment, state: state.clone(), activities }
    }
}

/// Returns the activity of an element in a step to `state`; strain increments and stresses below 1e-9 of the largest
/// ones of the step are rounding errors.
fn find_activity(
    element: &Element,
    state: &ElementState,
    strain_increment: f64,
    [largest_increment, largest_stress]: [f64; 2],
) -> Activity {
    let has_moved = strain_increment.abs() > 1e-9 * largest_increment;
    match *element {
        Element::Spring { .. } | Element::Damper { .. } => Activity::Regular,
        Element::Hinge { .. } if !has_moved => Activity::Locked,
        Element::Hinge { .. } if strain_increment > 0.0 => Activity::TensileFlow,
        Element::Hinge { .. } => Activity::CompressiveFlow,
        Element::Contact { .. } if state.stress < -1e-9 * largest_stress => Activity::Closed,
        // A contact that touches without stress has closed if it is at rest.
        Element::Contact { gap } if has_moved || state.strain > -gap => Activity::Open,
        Element::Contact { .. } => Activity::Closed,
    }
}
