//! Analysis of solids: plane waves, verdict, and characteristic speeds over all directions.

mod assessment;
mod branches;
mod plane_waves;
mod speeds;

pub use assessment::{
    AcousticTensorCache, Hyperbolicity, PLANE_ROUTE, SPACE_FORM_ROUTE, SPACE_ROUTE,
    SPACE_SEARCH_ROUTE, SYMMETRIC_ROUTE, SolidAssessment, SolidAssessor,
};
pub use branches::{BranchGroup, BranchPoint, group_branches};
pub use plane_waves::{PlaneWaves, directional_waves};
pub use speeds::{DirectionalSpeeds, ZeroSpeedCause, slowest_speed};

use models::common::elementary::Elementary;

/// Azimuth in [0, 180) and elevation of a normal, degrees; opposite normals are identified, except ±x₃ (elevation ±90).
pub fn angles_deg([x, y, z]: [f64; 3]) -> [f64; 2] {
    // Angles below this, in degrees, are rounding of the search for the direction.
    const ANGLE_TOLERANCE: f64 = 1e-7;
    let clean = |degrees: f64| if degrees.abs() < ANGLE_TOLERANCE { 0.0 } else { degrees };
    let elevation = clean(z.cr_atan2(x.root_sum_square(y)).to_degrees());
    let direction = clean(y.cr_atan2(x).to_degrees());
    // Reversing the normal turns the azimuth by 180° and changes the sign of the elevation.
    match direction {
        d if d < 0.0 => [clean(d + 180.0), -elevation + 0.0],
        d if d >= 180.0 - ANGLE_TOLERANCE => [0.0, -elevation + 0.0],
        d => [d, elevation],
    }
}
