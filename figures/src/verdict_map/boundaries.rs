//! Boundaries between the categories of neighbouring cells, and sets of cells that are lines.

use std::collections::HashMap;

use super::colour_map::LINE_SET_RIM;
use super::raster::VerdictRaster;
use crate::contour::{GridEdge, join_segments};
use crate::picture::{Colour, INK, Picture, Point, Rectangle, circle_points};

/// Part of a square between four neighbouring points that belongs to one category, in units of the square.
pub(super) struct Piece {
    pub(super) category: u8,
    pub(super) polygon: Vec<Point>,
}

/// Corners of a square as offsets from its lower left point, anticlockwise.
const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// Width of the line that stands for a set of cells without area, pixels.
const LINE_SET_WIDTH: f64 = 5.0;
/// Radius of the disc that stands for a single point, as a multiple of the width of lines.
const POINT_SET_SCALE: f64 = 1.0;

/// Squares between neighbouring points of a raster that belong to several categories.
pub(super) struct Boundaries {
    pieces: HashMap<[usize; 2], Vec<Piece>>,
    /// Lines between categories, in units of the point spacing.
    pub(super) lines: Vec<Vec<Point>>,
}

impl Boundaries {
    pub(super) fn new(raster: &VerdictRaster) -> Self {
        let (mut pieces, mut segments) = (HashMap::new(), Vec::<[GridEdge; 2]>::new());
        let mut lines = Vec::new();
        for j in 1..raster.rows {
            for i in 1..raster.columns {
                let square = [i - 1, j - 1];
                let crossings = find_crossings(raster, square);
                match crossings[..] {
                    [] => continue,
                    [(a, _), (b, _)] => {
                        segments.push([a, b].map(|edge| grid_edge(square, edge)));
                    }
                    _ => {
                        let middle = mean(&crossings);
                        let place = |[x, y]: Point| [x + square[0] as f64, y + square[1] as f64];
                        lines.extend(
                            crossings.iter().map(|(_, at)| vec![place(*at), place(middle)]),
                        );
                    }
                }
                pieces.insert(square, split_square(raster, square, &crossings));
            }
        }
        let place = |edge: GridEdge| {
            let (x, y, share) = (edge.0 as f64, edge.1 as f64, raster.boundary_share(edge));
            if edge.2 { [x, y + share] } else { [x + share, y] }
        };
        let joined = join_segments(&segments);
        lines
            .extend(joined.into_iter().map(|line| line.into_iter().map(place).collect::<Vec<_>>()));
        Self { pieces, lines }
    }

    /// Returns the pieces of the square with this lower left point; `None` if it belongs to one category.
    pub(super) fn pieces(&self, square: [usize; 2]) -> Option<&[Piece]> {
        self.pieces.get(&square).map(Vec::as_slice)
    }

    pub(super) fn squares(&self) -> Vec<[usize; 2]> {
        let mut squares: Vec<_> = self.pieces.keys().copied().collect();
        squares.sort_unstable();
        squares
    }

    /// Returns the category at a position in units of the point spacing.
    pub(super) fn category_at(&self, raster: &VerdictRaster, [x, y]: Point) -> u8 {
        let square = [
            (x.max(0.0) as usize).min(raster.columns.saturating_sub(2)),
            (y.max(0.0) as usize).min(raster.rows.saturating_sub(2)),
        ];
        let at = [x - square[0] as f64, y - square[1] as f64];
        let piece = self
            .pieces(square)
            .and_then(|pieces| pieces.iter().find(|piece| is_inside(&piece.polygon, at)));
        match piece {
            Some(piece) => piece.category,
            None => {
                raster.categories[raster.cell_index(
                    (x.round() as usize).min(raster.columns - 1),
                    (y.round() as usize).min(raster.rows - 1),
                )]
            }
        }
    }

    /// Returns whether a square belongs to several categories or is at most two squares away from such a square.
    pub(super) fn is_near(&self, [i, j]: [usize; 2]) -> bool {
        let around = |at: usize| at.saturating_sub(2)..=at + 2;
        around(i).any(|i| around(j).any(|j| self.pieces.contains_key(&[i, j])))
    }
}

fn grid_edge([i, j]: [usize; 2], edge: usize) -> GridEdge {
    [(i, j, false), (i + 1, j, true), (i, j + 1, false), (i, j, true)][edge]
}

/// Finds the edges of a square on which the category changes, each with the place of the change.
fn find_crossings(raster: &VerdictRaster, square: [usize; 2]) -> Vec<(usize, Point)> {
    let category = |corner: usize| {
        let [x, y] = CORNERS[corner % 4];
        raster.categories[raster.cell_index(square[0] + x, square[1] + y)]
    };
    let changed = (0..4).filter(|&edge| category(edge) != category(edge + 1));
    changed
        .map(|edge| {
            let share = raster.boundary_share(grid_edge(square, edge));
            (edge, [[share, 0.0], [1.0, share], [share, 1.0], [0.0, share]][edge])
        })
        .collect()
}

fn mean(crossings: &[(usize, Point)]) -> Point {
    let count = crossings.len() as f64;
    [0, 1].map(|axis| crossings.iter().map(|(_, at)| at[axis]).sum::<f64>() / count)
}

/// Splits a square at the changes of category on its edges: by a straight line between two of them, and by lines to
/// their mean if there are more.
fn split_square(
    raster: &VerdictRaster,
    square: [usize; 2],
    crossings: &[(usize, Point)],
) -> Vec<Piece> {
    let middle = (crossings.len() > 2).then(|| mean(crossings));
    let pieces = crossings.iter().enumerate().map(|(index, (edge, from))| {
        let (last, to) = crossings[(index + 1) % crossings.len()];
        let count = (last + 4 - edge - 1) % 4 + 1;
        let corners: Vec<usize> = (1..=count).map(|step| (edge + step) % 4).collect();
        let places = corners.iter().map(|&corner| CORNERS[corner].map(|part| part as f64));
        let polygon = [*from].into_iter().chain(places).chain([to]).chain(middle).collect();
        let [x, y] = CORNERS[corners[0]];
        let cell = raster.cell_index(square[0] + x, square[1] + y);
        Piece { category: raster.categories[cell], polygon }
    });
    pieces.collect()
}

/// Returns whether a point is inside a polygon (even–odd rule).
pub(crate) fn is_inside(polygon: &[Point], [x, y]: Point) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = sides.filter(|&(&[x0, y0], &[x1, y1])| {
        (y0 > y) != (y1 > y) && x < x0 + (y - y0) / (y1 - y0) * (x1 - x0)
    });
    crossed.count() % 2 == 1
}

/// Cuts off the part of a polygon where `distance` is negative (Sutherland and Hodgman 1974).
fn cut_polygon(polygon: &[Point], distance: impl Fn(Point) -> f64) -> Vec<Point> {
    let mut kept = Vec::new();
    for (from, to) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let (a, b) = (distance(*from), distance(*to));
        if a >= 0.0 {
            kept.push(*from);
        }
        if (a < 0.0) != (b < 0.0) {
            let share = a / (a - b);
            kept.push([0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis])));
        }
    }
    kept
}

/// Returns the part of a polygon in a rectangle from its lower left to its upper right corner; empty if it has no area.
pub(super) fn cut_to_area(polygon: &[Point], low: Point, high: Point) -> Vec<Point> {
    let part = [0, 1].into_iter().fold(polygon.to_vec(), |part, axis| {
        cut_polygon(&cut_polygon(&part, |at| at[axis] - low[axis]), |at| high[axis] - at[axis])
    });
    if part.len() < 3 { Vec::new() } else { part }
}

/// Draws the boundaries between categories.
pub(super) fn draw_borders(
    picture: &mut Picture,
    frame: Rectangle,
    raster: &VerdictRaster,
    boundaries: &Boundaries,
) {
    // The line width is limited, so that cells a few pixels wide remain visible.
    let [width, height] = raster.spacing(frame);
    let thickness = (0.3 * width.min(height)).clamp(0.7, 2.4);
    for line in &boundaries.lines {
        let places: Vec<Point> = line.iter().map(|&at| raster.place(frame, at)).collect();
        picture.draw_line(places, thickness, INK);
    }
}

/// Returns the area of a line segment of a width, with square ends.
fn segment_area([from, to]: [Point; 2], width: f64) -> Vec<Point> {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    let half = 0.5 * width / length;
    let [along_x, along_y] = [half * (to[0] - from[0]), half * (to[1] - from[1])];
    vec![
        [from[0] - along_x + along_y, from[1] - along_y - along_x],
        [to[0] + along_x + along_y, to[1] + along_y - along_x],
        [to[0] + along_x - along_y, to[1] + along_y + along_x],
        [from[0] - along_x - along_y, from[1] - along_y + along_x],
    ]
}

/// Draws the sets of cells without area as lines through their points, in the colours of their categories, and points
/// without neighbours in the set as discs.
pub(super) fn draw_line_sets(
    picture: &mut Picture,
    frame: Rectangle,
    raster: &VerdictRaster,
    colour: impl Fn(u8) -> Colour,
) {
    let category = |[i, j]: [usize; 2]| {
        let cell = raster.cell_index(i, j);
        raster.is_line[cell].then(|| raster.categories[cell])
    };
    let mut segments: Vec<([Point; 2], u8)> = Vec::new();
    let mut is_joined = vec![false; raster.is_line.len()];
    for (i, j) in (0..raster.rows).flat_map(|j| (0..raster.columns).map(move |i| (i, j))) {
        let Some(own) = category([i, j]) else { continue };
        let is_same = |at: [usize; 2]| {
            at[0] < raster.columns && at[1] < raster.rows && category(at) == Some(own)
        };
        let mut next = Vec::new();
        for at in [[i + 1, j], [i, j + 1]] {
            next.extend(is_same(at).then_some(at));
        }
        // Diagonal neighbours are joined unless a common neighbour joins them.
        if is_same([i + 1, j + 1]) && !is_same([i + 1, j]) && !is_same([i, j + 1]) {
            next.push([i + 1, j + 1]);
        }
        if i > 0 && is_same([i - 1, j + 1]) && !is_same([i - 1, j]) && !is_same([i, j + 1]) {
            next.push([i - 1, j + 1]);
        }
        for [i, j] in next.iter().copied().chain((!next.is_empty()).then_some([i, j])) {
            is_joined[raster.cell_index(i, j)] = true;
        }
        let here = raster.place(frame, [i as f64, j as f64]);
        let place = |[i, j]: [usize; 2]| raster.place(frame, [i as f64, j as f64]);
        segments.extend(next.into_iter().map(|at| ([here, place(at)], own)));
    }
    for (rim, width) in [(true, LINE_SET_WIDTH + 2.0 * LINE_SET_RIM), (false, LINE_SET_WIDTH)] {
        let mut fill = |area: Vec<Point>, category: u8| {
            let area = cut_to_area(&area, [frame.left, frame.top], [frame.right, frame.bottom]);
            if !area.is_empty() {
                picture.fill_polygon(area, if rim { INK } else { colour(category) });
            }
        };
        for (ends, category) in &segments {
            fill(segment_area(*ends, width), *category);
        }
        for (i, j) in (0..raster.rows).flat_map(|j| (0..raster.columns).map(move |i| (i, j))) {
            let Some(own) = category([i, j]).filter(|_| !is_joined[raster.cell_index(i, j)]) else {
                continue;
            };
            let centre = raster.place(frame, [i as f64, j as f64]);
            fill(circle_points(centre, POINT_SET_SCALE * width, 24), own);
        }
    }
}

/// Draws the swatch of a set of cells without area; `is_point` for single points.
pub(super) fn draw_line_set_swatch(
    picture: &mut Picture,
    area: Rectangle,
    colour: Colour,
    is_point: bool,
) {
    let y = 0.5 * (area.top + area.bottom);
    if is_point {
        let centre = [0.5 * (area.left + area.right), y];
        let rim = POINT_SET_SCALE * (LINE_SET_WIDTH + 2.0 * LINE_SET_RIM);
        picture.fill_disc(centre, rim, INK);
        picture.fill_disc(centre, POINT_SET_SCALE * LINE_SET_WIDTH, colour);
        return;
    }
    let ends = [[area.left, y], [area.right, y]];
    picture.draw_line(ends, LINE_SET_WIDTH + 2.0 * LINE_SET_RIM, INK);
    picture.draw_line(ends, LINE_SET_WIDTH, colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(polygon: &[Point]) -> f64 {
        let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
        0.5 * sides.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    }

    fn raster(columns: usize, categories: &[u8], shares: [Vec<f64>; 2]) -> VerdictRaster {
        VerdictRaster {
            columns,
            rows: categories.len() / columns,
            categories: categories.to_vec(),
            levels: vec![1.0; categories.len()],
            boundaries: shares,
            is_line: vec![false; categories.len()],
        }
    }

    /// The pieces of a square and their parts in a grid have its area, whatever the categories of its corners are.
    #[test]
    fn pieces_cover_the_square() {
        for code in 0..81_u32 {
            let categories = [0, 1, 2, 3].map(|place| (code / 3_u32.pow(place) % 3) as u8);
            let shares = [vec![0.3, 0.5, 0.8, 0.5], vec![0.1, 0.6, 0.5, 0.5]];
            let raster = raster(2, &categories, shares);
            let found = Boundaries::new(&raster);
            let is_mixed = categories.iter().any(|&category| category != categories[0]);
            assert_eq!(found.pieces([0, 0]).is_some(), is_mixed);
            if let Some(pieces) = found.pieces([0, 0]) {
                let areas = pieces.iter().map(|piece| area(&piece.polygon));
                assert!((areas.sum::<f64>() - 1.0).abs() < 1e-12, "{categories:?}");
                let parts = pieces.iter().flat_map(|piece| {
                    (0..15).map(|index| {
                        let low = [f64::from(index % 5) / 5.0, f64::from(index / 5) / 3.0];
                        let high = [low[0] + 0.2, low[1] + 1.0 / 3.0];
                        area(&cut_to_area(&piece.polygon, low, high))
                    })
                });
                assert!((parts.sum::<f64>() - 1.0).abs() < 1e-12, "{categories:?}");
            }
        }
    }

    /// The boundary of a half plane is straight if its places on the edges are exact.
    #[test]
    fn boundary_of_a_half_plane_is_straight() {
        let (columns, rows) = (9, 7);
        let height = |i: f64, j: f64| i + 2.3 * j - 8.1;
        let at = |cell: usize| ((cell % columns) as f64, (cell / columns) as f64);
        let cells = || (0..columns * rows).map(at);
        let shares = [(1.0, 0.0), (0.0, 1.0)].map(|(dx, dy)| {
            let share = |(i, j)| height(i, j) / (height(i, j) - height(i + dx, j + dy));
            cells().map(share).collect()
        });
        let categories: Vec<u8> = cells().map(|(i, j)| u8::from(height(i, j) > 0.0)).collect();
        let raster = raster(columns, &categories, shares);
        let found = Boundaries::new(&raster);
        assert_eq!(found.lines.len(), 1);
        assert!(found.lines[0].iter().all(|&[x, y]| height(x, y).abs() < 1e-12));
        for (x, y) in cells().map(|(x, y)| ((x + 0.37).min(8.0), (y + 0.61).min(6.0))) {
            assert_eq!(found.category_at(&raster, [x, y]), u8::from(height(x, y) > 0.0));
        }
    }
}
