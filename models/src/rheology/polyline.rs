//! Monotone polylines: graphs of stress against strain increment, and their sums.
//!
//! The graph of one implicit step of an element or of a branch is a maximal monotone polyline: vertices in ascending
//! order, segments between them, and a ray at either end. Each segment and ray has its own stiffness, 0 for a
//! horizontal and infinite for a vertical one. The stiffnesses of a sum follow from those of its terms, not from
//! differences of its vertices: a ray through two distant points would lose the digits of its slope.

/// Coordinate of a polyline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinate {
    /// Strain increment of the step.
    Strain,
    /// Stress at the end of the step, Pa.
    Stress,
}

impl Coordinate {
    const fn index(self) -> usize {
        match self {
            Self::Strain => 0,
            Self::Stress => 1,
        }
    }

    /// Returns the slope d(other coordinate)/d(this coordinate) of a stiffness, or the stiffness of such a slope.
    fn convert_slope(self, slope: f64) -> f64 {
        match self {
            Self::Strain => slope,
            Self::Stress => 1.0 / slope,
        }
    }
}

/// Maximal monotone polyline in the plane of strain increment and stress.
#[derive(Clone, Debug)]
pub(super) struct MonotonePolyline {
    /// Vertices [strain increment, stress], ascending in both coordinates; at least one.
    vertices: Vec<[f64; 2]>,
    /// Stiffnesses, Pa: of the ray before the first vertex, of the segments, and of the ray after the last vertex.
    stiffnesses: Vec<f64>,
}

impl MonotonePolyline {
    /// Creates the straight line through a point; an infinite stiffness makes it vertical.
    pub(super) fn from_line(point: [f64; 2], stiffness: f64) -> Self {
        Self { vertices: vec![point], stiffnesses: vec![stiffness; 2] }
    }

    /// Creates a polyline from its vertices and the stiffnesses of its rays and segments, one more than vertices.
    pub(super) fn from_vertices(vertices: Vec<[f64; 2]>, stiffnesses: Vec<f64>) -> Self {
        debug_assert!(!vertices.is_empty() && stiffnesses.len() == vertices.len() + 1);
        Self { vertices, stiffnesses }
    }

    /// Returns the interval of the other coordinate at the value `x` of the coordinate `along`, with infinite ends on
    /// rays; `None` if the polyline does not reach `x`.
    pub(super) fn interval_at(&self, along: Coordinate, x: f64) -> Option<[f64; 2]> {
        let (a, b) = (along.index(), 1 - along.index());
        let vertices = &self.vertices;
        let first = vertices.partition_point(|vertex| vertex[a] < x);
        let end = vertices.partition_point(|vertex| vertex[a] <= x);
        if first < end {
            let is_ray = |piece: usize| self.slope(along, piece).is_infinite();
            let low = if first == 0 && is_ray(0) { f64::NEG_INFINITY } else { vertices[first][b] };
            let is_high_ray = end == vertices.len() && is_ray(end);
            let high = if is_high_ray { f64::INFINITY } else { vertices[end - 1][b] };
            return Some([low, high]);
        }
        let slope = self.slope(along, first);
        if slope.is_infinite() {
            return None;
        }
        let before = first.checked_sub(1).map(|index| vertices[index]);
        let after = vertices.get(first).copied();
        let from = |vertex: [f64; 2]| vertex[b] + slope * (x - vertex[a]);
        // From the nearer vertex: its rounding error is the smaller one.
        let value = match (before, after) {
            (Some(p), Some(q)) if x - p[a] <= q[a] - x => from(p),
            (_, Some(q)) => from(q),
            (Some(p), None) => from(p),
            (None, None) => return None,
        };
        let low = before.map_or(f64::NEG_INFINITY, |p| p[b]);
        let high = after.map_or(f64::INFINITY, |q| q[b]);
        let value = value.max(low).min(high);
        Some([value, value])
    }

    /// Returns the range of the other coordinate on the piece at the value `x` of the coordinate `along`: between the
    /// vertices on either side, or the [interval](Self::interval_at) at a vertex.
    pub(super) fn piece_range(&self, along: Coordinate, x: f64) -> [f64; 2] {
        let (a, b) = (along.index(), 1 - along.index());
        let first = self.vertices.partition_point(|vertex| vertex[a] < x);
        match self.vertices.get(first) {
            Some(vertex) if vertex[a] == x => self.interval_at(along, x).unwrap_or([f64::NAN; 2]),
            after => {
                let before = first.checked_sub(1).map(|index| self.vertices[index][b]);
                let after = after.map_or(f64::INFINITY, |vertex| vertex[b]);
                [before.unwrap_or(f64::NEG_INFINITY), after]
            }
        }
    }

    /// Returns the slope d(other)/d(along) next to `x`: on the side of smaller values if `is_before`, else of larger.
    pub(super) fn slope_beside(&self, along: Coordinate, x: f64, is_before: bool) -> f64 {
        let a = along.index();
        self.slope(
            along,
            match is_before {
                true => self.vertices.partition_point(|vertex| vertex[a] < x),
                false => self.vertices.partition_point(|vertex| vertex[a] <= x),
            },
        )
    }

    /// Returns the range of a coordinate, with infinite ends where the polyline is unbounded.
    pub(super) fn range(&self, along: Coordinate) -> [f64; 2] {
        let (a, last) = (along.index(), self.vertices.len());
        let end = |piece: usize, vertex: usize, infinity: f64| {
            let is_vertical = self.slope(along, piece).is_infinite();
            if is_vertical { self.vertices[vertex][a] } else { infinity }
        };
        [end(0, 0, f64::NEG_INFINITY), end(last, last - 1, f64::INFINITY)]
    }

    /// Adds polylines along a coordinate: at each of its values their intervals of the other coordinate are added.
    /// Elements in parallel are added along the strain, elements in series along the stress. All polylines must have a
    /// value of the coordinate in common; all graphs of elements reach the stress 0, and all strains from 0 on.
    pub(super) fn sum(graphs: &[&Self], along: Coordinate) -> Self {
        let a = along.index();
        let [mut low, mut high] = [f64::NEG_INFINITY, f64::INFINITY];
        for graph in graphs {
            let [own_low, own_high] = graph.range(along);
            (low, high) = (low.max(own_low), high.min(own_high));
        }
        let mut corners: Vec<f64> = graphs
            .iter()
            .flat_map(|graph| graph.vertices.iter().map(|vertex| vertex[a]))
            .filter(|x| (low..=high).contains(x))
            .collect();
        corners.sort_by(f64::total_cmp);
        corners.dedup();
        let total_slope = |slope_of: &dyn Fn(&Self) -> f64| {
            along.convert_slope(graphs.iter().map(|graph| slope_of(graph)).sum::<f64>())
        };
        let vertical = along.convert_slope(f64::INFINITY);
        let point = |x: f64, y: f64| match along {
            Coordinate::Strain => [x, y],
            Coordinate::Stress => [y, x],
        };
        let mut vertices = Vec::with_capacity(2 * corners.len());
        let mut stiffnesses = Vec::with_capacity(2 * corners.len() + 1);
        for (index, &x) in corners.iter().enumerate() {
            stiffnesses.push(match index {
                0 if low.is_finite() => vertical,
                0 => total_slope(&|graph| graph.slope(along, 0)),
                _ => total_slope(&|graph| graph.slope_beside(along, corners[index - 1], false)),
            });
            let intervals = graphs.iter().map(|graph| graph.interval_at(along, x));
            let [bottom, top] = intervals.fold([0.0, 0.0], |[bottom, top], interval| {
                let [low, high] = interval.unwrap_or([f64::NAN; 2]);
                [bottom + low, top + high]
            });
            match (bottom.is_finite(), top.is_finite()) {
                (true, true) => {
                    vertices.push(point(x, bottom));
                    if bottom < top {
                        stiffnesses.push(vertical);
                        vertices.push(point(x, top));
                    }
                }
                (true, false) => vertices.push(point(x, bottom)),
                (false, true) => vertices.push(point(x, top)),
                // A straight line along the other coordinate: any of its points.
                (false, false) => vertices.push(point(x, 0.0)),
            }
        }
        stiffnesses.push(match high.is_finite() {
            true => vertical,
            false => {
                let last = |graph: &Self| graph.slope(along, graph.vertices.len());
                total_slope(&last)
            }
        });
        Self { vertices, stiffnesses }
    }

    fn slope(&self, along: Coordinate, piece: usize) -> f64 {
        along.convert_slope(self.stiffnesses[piece])
    }
}
