//! Characteristic speeds of a solid against the direction in a plane, elastic and while yielding.

use crate::acoustic_tensor2::AcousticTensor2;
use crate::line_search::find_sectors;
use crate::waves::squared_speeds;
use models::common::elementary::{Elementary, Modulus};
use models::common::rates::RateEquations;
use models::elastoplastic::Solid;
use models::solid::stress::Stress;
use models::yield_set::tangent::NoResponse;
use num_complex::Complex64;

/// Number of directions over half a turn, both ends included.
const DIRECTIONS: usize = 721;
/// Bisection steps for the end of a sector.
const BISECTION_STEPS: usize = 45;
/// Threshold of zero for the real part of c², relative to the largest c².
const ZERO_SPEED_TOLERANCE: f64 = 1e-12;
/// Threshold of zero for the imaginary part of c², relative to the largest c²: a double root is perturbed by the square
/// root of the rounding.
const COMPLEX_SPEED_TOLERANCE: f64 = 1e-6;

/// Squared speeds in one direction, m²/s², by descending real part.
type SquaredSpeeds = Vec<Complex64>;

/// Squared speeds of the elastic and of the yielding solid, at an angle in degrees.
type SquaredSpeedFunction = dyn Fn(f64) -> (SquaredSpeeds, SquaredSpeeds);

/// Squared characteristic speeds over half a turn in the plane of x₁ and x₂, or on a cone about x₃, with the sectors of
/// flutter, imaginary and vanishing speeds.
#[derive(Clone, Debug)]
pub struct DirectionalSpeeds {
    /// Direction (degrees) with the squared speeds of the elastic and of the yielding solid, m²/s², by descending real
    /// part.
    pub curves: Vec<(f64, Vec<Complex64>, Vec<Complex64>)>,
    /// Sectors of complex speeds (flutter), degrees.
    pub flutter_sectors: Vec<[f64; 2]>,
    /// Sectors of imaginary speeds, c² < 0, degrees.
    pub imaginary_sectors: Vec<[f64; 2]>,
    /// Directions in which a speed vanishes, degrees, with the cause; in space, the ends of the imaginary sectors.
    pub zero_speeds: Vec<(f64, ZeroSpeedCause)>,
    /// Whether a speed vanishes in all directions; false in space, where this is not tested.
    pub is_always_stationary: bool,
    /// Largest real part of the elastic c², m²/s².
    pub max_squared_speed: f64,
}

/// The cause of a vanishing speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZeroSpeedCause {
    /// Slip of the layers normal to the wave normal.
    Slip,
    /// Stationary discontinuity: the onset of a shear band.
    StationaryDiscontinuity,
}

impl ZeroSpeedCause {
    /// Name of the cause in output.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Slip => "slip along the layer",
            Self::StationaryDiscontinuity => "stationary discontinuity",
        }
    }
}

impl DirectionalSpeeds {
    /// Number of directions in [`curves`](Self::curves), over half a turn with both ends.
    pub const DIRECTIONS: usize = DIRECTIONS;

    /// Computes the speeds of a solid; in space, for wave normals at `elevation` (rad) above the plane of x₁ and x₂.
    ///
    /// # Errors
    /// The rate response of the yielding solid is not defined.
    pub fn new(solid: &Solid, elevation: f64) -> Result<Self, NoResponse> {
        // Elastic and yielding squared speeds at an angle in degrees.
        let (at, tensor): (Box<SquaredSpeedFunction>, _) = if solid.dimensions == 2 {
            let (elastic, tensor) = (
                AcousticTensor2::new(&solid.elastic_rates()),
                AcousticTensor2::new(&solid.rates()?),
            );
            let yielding = tensor.clone();
            let at = move |degrees: f64| {
                let angle = degrees.to_radians();
                (elastic.squared_speeds(angle), yielding.squared_speeds(angle))
            };
            (Box::new(at), Some(tensor))
        } else {
            let (elastic, rates) = (solid.elastic_rates::<3>(), solid.rates::<3>()?);
            let (up, along) = elevation.cr_sin_cos();
            let at = move |degrees: f64| {
                let (sin, cos) = degrees.to_radians().cr_sin_cos();
                let normal = [along * cos, along * sin, up];
                (squared_speeds(&elastic, normal), squared_speeds(&rates, normal))
            };
            (Box::new(at), None)
        };
        let curves: Vec<(f64, SquaredSpeeds, SquaredSpeeds)> = (0..DIRECTIONS)
            .map(|i| {
                let degrees = 180.0 * i as f64 / (DIRECTIONS - 1) as f64;
                let (elastic, yielding) = at(degrees);
                (degrees, elastic, yielding)
            })
            .collect();
        let max_squared_speed =
            curves.iter().flat_map(|(_, e, _)| e).map(|c| c.re).fold(0.0, f64::max);
        let step = 180.0 / (DIRECTIONS - 1) as f64;
        let sectors = |is_such: &dyn Fn(&Complex64) -> bool| {
            let samples = (0..DIRECTIONS - 1).map(|i| step * i as f64);
            let holds = |degrees: f64| at(degrees).1.iter().any(is_such);
            find_sectors(samples, step, 180.0, BISECTION_STEPS, holds)
        };
        let flutter_sectors = match &tensor {
            Some(tensor) => {
                tensor.flutter_sectors().into_iter().map(|s| s.map(f64::to_degrees)).collect()
            }
            None => sectors(&|c| is_complex(c, max_squared_speed)),
        };
        let imaginary_sectors = sectors(&|c| {
            !is_complex(c, max_squared_speed) && c.re < -ZERO_SPEED_TOLERANCE * max_squared_speed
        });
        let zero_speeds = match &tensor {
            Some(tensor) => {
                let angles = tensor.zero_speed_directions().into_iter();
                angles.map(|angle| (angle.to_degrees(), zero_speed_cause(solid, angle))).collect()
            }
            // In space: the ends of the sectors of imaginary speeds.
            None => {
                let ends = imaginary_sectors.iter().flatten().map(|end| end.rem_euclid(180.0));
                ends.map(|end| (end, ZeroSpeedCause::StationaryDiscontinuity)).collect()
            }
        };
        let is_always_stationary = tensor.is_some_and(|tensor| tensor.is_always_stationary());
        Ok(Self {
            curves,
            flutter_sectors,
            imaginary_sectors,
            zero_speeds,
            is_always_stationary,
            max_squared_speed,
        })
    }

    /// Whether a squared speed is complex beyond rounding.
    pub fn is_complex(&self, c: &Complex64) -> bool {
        is_complex(c, self.max_squared_speed)
    }

    /// Whether the real part of a squared speed is nonnegative up to rounding.
    pub fn is_nonnegative(&self, c: &Complex64) -> bool {
        c.re >= -ZERO_SPEED_TOLERANCE * self.max_squared_speed
    }
}

fn is_complex(c: &Complex64, largest: f64) -> bool {
    c.im.abs() > COMPLEX_SPEED_TOLERANCE * largest
}

/// Cause of a vanishing speed whose wave normal has the angle `angle` (rad).
fn zero_speed_cause(solid: &Solid, angle: f64) -> ZeroSpeedCause {
    const AXIS_TOLERANCE: f64 = 1e-5; // a double zero is located to the square root of the rounding
    let active = solid.plastic_state.iter().flat_map(|plastic| &plastic.active_conditions);
    let (sin, cos) = angle.cr_sin_cos();
    let slips = |normal: &Stress| {
        // Layers normal to x₁ slip if the condition limits σ₂₁, layers normal to x₂ if it limits σ₁₂.
        let sheared = |i: usize, j: usize| normal.force[i][j] != 0.0 || normal.couple[2][j] != 0.0;
        (sin.abs() < AXIS_TOLERANCE && sheared(1, 0))
            || (cos.abs() < AXIS_TOLERANCE && sheared(0, 1))
    };
    let is_layered =
        solid.plastic_state.as_ref().is_some_and(|plastic| plastic.set.half_spaces().is_some());
    match is_layered && active.map(|condition| &condition.normal).any(slips) {
        true => ZeroSpeedCause::Slip,
        false => ZeroSpeedCause::StationaryDiscontinuity,
    }
}

/// Speed of the slowest wave that travels along the unit vector `normal`, m/s; NaN if some c² is complex or negative,
/// infinite if all are zero.
pub fn slowest_speed(equations: &RateEquations<3>, normal: [f64; 3]) -> f64 {
    let squares = squared_speeds(equations, normal);
    let largest = squares.iter().map(|c| c.modulus()).fold(0.0, f64::max);
    if squares.iter().any(|c| is_complex(c, largest) || c.re < -ZERO_SPEED_TOLERANCE * largest) {
        return f64::NAN;
    }
    let travelling = squares.iter().map(|c| c.re).filter(|&c| c > ZERO_SPEED_TOLERANCE * largest);
    travelling.fold(f64::INFINITY, f64::min).sqrt()
}
