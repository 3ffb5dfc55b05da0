//! Geodesic grids on the half-sphere.

use super::unit_vectors::{dot, normalise};
use std::collections::HashMap;

/// Number of subdivisions of an edge of the icosahedron in the fine grid.
pub(super) const FINE_SUBDIVISIONS: usize = 51;
/// Number of subdivisions of an edge of the icosahedron in the coarse grid, on which all roots are computed.
pub(super) const COARSE_SUBDIVISIONS: usize = 17;
/// Maximum number of neighbours of a point of the geodesic grid.
pub(super) const MAX_NEIGHBOURS: usize = 6;

/// Geodesic grid: each face of an icosahedron is divided into `frequency`² triangles, which are projected onto the unit
/// sphere; of each pair n, −n one point is kept. Returns points and triangles (as indices of points).
fn build_geodesic_grid(frequency: usize) -> (Vec<[f64; 3]>, Vec<[usize; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::with_capacity(12);
    for axis in 0..3 {
        for (one, other) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
            let mut corner = [0.0; 3];
            corner[(axis + 1) % 3] = one;
            corner[(axis + 2) % 3] = other;
            corners.push(corner);
        }
    }
    let is_edge =
        |p: &[f64; 3], q: &[f64; 3]| (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>() < 5.0;
    let (mut points, mut places, mut triangles) = (Vec::new(), HashMap::new(), Vec::new());
    let divisions = frequency as f64;
    for first in 0..12 {
        for second in first + 1..12 {
            for third in second + 1..12 {
                let [p, q, r] = [&corners[first], &corners[second], &corners[third]];
                if !(is_edge(p, q) && is_edge(q, r) && is_edge(p, r)) {
                    continue;
                }
                let mut place = |i: usize, j: usize| {
                    let (u, v) = (i as f64 / divisions, j as f64 / divisions);
                    let w = (frequency - i - j) as f64 / divisions;
                    let mut point: [f64; 3] =
                        std::array::from_fn(|axis| u * p[axis] + v * q[axis] + w * r[axis]);
                    // One of n and −n: the last non-zero component is positive.
                    let leading = point.iter().rev().find(|x| x.abs() > 1e-9).copied();
                    if leading.is_some_and(|x| x < 0.0) {
                        point = point.map(|x| -x);
                    }
                    let point = normalise(point);
                    let key = point.map(|x| (x * 1e7).round() as i64);
                    *places.entry(key).or_insert_with(|| {
                        points.push(point);
                        points.len() - 1
                    })
                };
                for i in 0..frequency {
                    for j in 0..frequency - i {
                        triangles.push([place(i, j), place(i + 1, j), place(i, j + 1)]);
                        if i + j + 2 <= frequency {
                            triangles.push([place(i + 1, j + 1), place(i + 1, j), place(i, j + 1)]);
                        }
                    }
                }
            }
        }
    }
    (points, triangles)
}

/// Fine grid and coarse grid, as [`build_grid_pair`] returns them.
type GridPair = (Vec<[f64; 3]>, Vec<u32>, Vec<[u32; MAX_NEIGHBOURS]>, Vec<u32>);

/// Returns the fine grid, the coarse grid as indices into the fine grid, the neighbours of each coarse point (if fewer
/// than six, the first is repeated), and the nearest coarse point of each fine point, both as indices of coarse points.
pub(super) fn build_grid_pair() -> GridPair {
    let (fine, _) = build_geodesic_grid(FINE_SUBDIVISIONS);
    let (coarse, triangles) = build_geodesic_grid(COARSE_SUBDIVISIONS);
    let nearest = |grid: &[[f64; 3]], n: &[f64; 3]| {
        let distance = |place: usize| dot(&grid[place], n).abs();
        let closer = |best, place| if distance(place) > distance(best) { place } else { best };
        (0..grid.len()).fold(0, closer) as u32
    };
    let parents = fine.iter().map(|n| nearest(&coarse, n)).collect();
    let places = coarse.iter().map(|n| nearest(&fine, n)).collect();
    let mut neighbours_by_point: Vec<Vec<u32>> = vec![Vec::new(); coarse.len()];
    for triangle in triangles {
        for i in 0..3 {
            for j in (0..3).filter(|&j| j != i) {
                let other = triangle[j] as u32;
                if !neighbours_by_point[triangle[i]].contains(&other) {
                    neighbours_by_point[triangle[i]].push(other);
                }
            }
        }
    }
    let neighbours = neighbours_by_point
        .iter()
        .map(|list| std::array::from_fn(|i| list.get(i).or(list.first()).copied().unwrap_or(0)))
        .collect();
    (fine, places, neighbours, parents)
}
