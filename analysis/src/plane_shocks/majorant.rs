//! Least concave majorant of a polyline (upper part of the convex hull, by the scan of Andrew 1979).

use models::uniaxial::DiagramCorner;

/// Returns the vertices of the least concave majorant of points in ascending order of strain. Points on an edge are no
/// vertices.
pub(super) fn least_concave_majorant(points: &[DiagramCorner]) -> Vec<DiagramCorner> {
    let mut hull: Vec<DiagramCorner> = Vec::new();
    for &point in points {
        while let [.., a, b] = hull[..] {
            if is_above_chord(a, b, point) {
                break;
            }
            hull.pop();
        }
        hull.push(point);
    }
    hull
}

/// Returns the vertices of the greatest convex minorant of points in ascending order of strain.
pub(super) fn greatest_convex_minorant(points: &[DiagramCorner]) -> Vec<DiagramCorner> {
    let reflect = |own: &DiagramCorner| DiagramCorner { pressure: -own.pressure, ..*own };
    let reflected: Vec<DiagramCorner> = points.iter().map(reflect).collect();
    least_concave_majorant(&reflected).iter().map(reflect).collect()
}

/// Returns whether `b` lies above the chord from `a` to `c`, by more than rounding: slopes that differ by rounding only
/// belong to one wave.
fn is_above_chord(a: DiagramCorner, b: DiagramCorner, c: DiagramCorner) -> bool {
    const ROUNDING: f64 = 1e-13;
    let left = (b.pressure - a.pressure) * (c.strain - b.strain);
    let right = (c.pressure - b.pressure) * (b.strain - a.strain);
    left - right > ROUNDING * (left.abs() + right.abs())
}
