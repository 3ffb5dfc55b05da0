//! Contour lines on a rectangular grid, by marching squares.

use std::collections::HashMap;

use crate::picture::Point;

/// An edge between neighbouring grid points: its lower point (i, j) and whether it is along y.
pub(crate) type GridEdge = (usize, usize, bool);

/// Computes the contour lines at `level` in units of the grid spacing: grid point (i, j) is at [i, j]. Values between
/// grid points are interpolated linearly; squares with a non-finite corner have no lines. Closed lines end at their
/// first point.
pub(crate) fn trace_contours(
    columns: usize,
    rows: usize,
    value: impl Fn(usize, usize) -> f64,
    level: f64,
) -> Vec<Vec<Point>> {
    let mut segments: Vec<[GridEdge; 2]> = Vec::new();
    for j in 1..rows {
        for i in 1..columns {
            add_square_segments(i - 1, j - 1, &value, level, &mut segments);
        }
    }
    let place = |(i, j, along_y): GridEdge| {
        let from = value(i, j);
        let to = if along_y { value(i, j + 1) } else { value(i + 1, j) };
        let share = (level - from) / (to - from);
        let (x, y) = (i as f64, j as f64);
        if along_y { [x, y + share] } else { [x + share, y] }
    };
    let joined = join_segments(&segments);
    joined.into_iter().map(|line| line.into_iter().map(place).collect()).collect()
}

/// Adds the line segments in the square with lower corner (i, j).
fn add_square_segments(
    i: usize,
    j: usize,
    value: impl Fn(usize, usize) -> f64,
    level: f64,
    segments: &mut Vec<[GridEdge; 2]>,
) {
    let corners = [value(i, j), value(i + 1, j), value(i + 1, j + 1), value(i, j + 1)];
    if !corners.iter().all(|corner| corner.is_finite()) {
        return;
    }
    let above = corners.map(|corner| corner >= level);
    let edges = [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)];
    let crossed: Vec<usize> = (0..4).filter(|&edge| above[edge] != above[(edge + 1) % 4]).collect();
    match crossed[..] {
        [a, b] => segments.push([edges[a], edges[b]]),
        // Saddle: the mean of the corner values determines which two corners are connected.
        [_, _, _, _] => {
            let middle = 0.25 * corners.iter().sum::<f64>() >= level;
            let pairs = if middle == above[0] { [[0, 1], [2, 3]] } else { [[3, 0], [1, 2]] };
            segments.extend(pairs.map(|pair| pair.map(|edge: usize| edges[edge])));
        }
        _ => {}
    }
}

/// Joins segments that share an edge into lines; at most two segments meet on an edge.
pub(crate) fn join_segments(segments: &[[GridEdge; 2]]) -> Vec<Vec<GridEdge>> {
    let mut at: HashMap<GridEdge, [Option<usize>; 2]> = HashMap::with_capacity(segments.len() + 1);
    for (index, piece) in segments.iter().enumerate() {
        for edge in piece {
            let meeting = at.entry(*edge).or_default();
            meeting[usize::from(meeting[0].is_some())] = Some(index);
        }
    }
    let mut used = vec![false; segments.len()];
    // Open lines first, starting at one of their ends; the remaining lines are closed.
    let starts = |open: bool| {
        let at = &at;
        segments.iter().enumerate().flat_map(move |(index, piece)| {
            piece
                .iter()
                .filter(move |edge| !open || at[*edge][1].is_none())
                .map(move |e| (index, *e))
        })
    };
    let mut joined = Vec::new();
    for (first, start) in starts(true).chain(starts(false)) {
        if used[first] {
            continue;
        }
        let (mut line, mut next) = (vec![start], Some(first));
        let mut here = start;
        while let Some(index) = next {
            used[index] = true;
            let [a, b] = segments[index];
            here = if a == here { b } else { a };
            line.push(here);
            next = at[&here].iter().flatten().copied().find(|&other| !used[other]);
        }
        joined.push(line);
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_has_straight_contours() {
        let lines = trace_contours(6, 5, |i, j| 2.0 * i as f64 + j as f64, 4.5);
        assert_eq!(lines.len(), 1);
        assert!(lines[0].iter().all(|[x, y]| (2.0 * x + y - 4.5).abs() < 1e-12));
        // The line connects the lower and the upper edge.
        let mut ends = [lines[0][0][1], lines[0].last().unwrap()[1]];
        ends.sort_by(f64::total_cmp);
        assert_eq!(ends, [0.0, 4.0]);
    }

    #[test]
    fn a_hill_has_closed_contours_on_the_circle() {
        let radius = |x: f64, y: f64| (x - 20.0).hypot(y - 20.0);
        let lines = trace_contours(41, 41, |i, j| radius(i as f64, j as f64), 12.3);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        assert!(lines[0].len() > 60);
        assert!(lines[0].iter().all(|[x, y]| (radius(*x, *y) - 12.3).abs() < 0.02));
        let length: f64 =
            lines[0].windows(2).map(|p| (p[0][0] - p[1][0]).hypot(p[0][1] - p[1][1])).sum();
        assert!((length - std::f64::consts::TAU * 12.3).abs() < 0.1, "{length}");
    }

    #[test]
    fn gaps_stay_empty_and_saddles_do_not_cross() {
        let holed = |i: usize, j: usize| if i == 2 { f64::NAN } else { j as f64 };
        let parts = trace_contours(6, 3, holed, 0.5);
        assert_eq!(parts.len(), 2);
        assert!(parts.iter().flatten().all(|[x, _]| *x <= 1.0 || *x >= 3.0));
        let saddle = trace_contours(2, 2, |i, j| ((i + j) % 2) as f64, 0.5);
        assert_eq!(saddle.len(), 2);
        assert!(trace_contours(1, 5, |_, j| j as f64, 0.5).is_empty());
        assert!(trace_contours(4, 4, |_, _| 1.0, 1.0).is_empty());
    }
}
