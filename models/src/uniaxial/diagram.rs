//! Piecewise-linear diagram of the pressure against the compression strain.

/// State of the elastic-plastic skeleton, or of the particles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SkeletonState {
    /// No plastic flow.
    Elastic,
    /// Plastic flow at the yield stress.
    Plastic,
}

/// State of the contact between particles, or between the walls of pores.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ContactState {
    /// The contact transmits no stress.
    Open,
    /// The stress of the contact is on the friction cone: the contact transmits stress and opens at the same time.
    Sliding,
    /// The contact transmits the elastic stress.
    Closed,
}

/// State of the medium on a segment of a diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SegmentState {
    /// State of the skeleton.
    pub skeleton: SkeletonState,
    /// State of the contact; `None` in media without contact.
    pub contact: Option<ContactState>,
}

impl SegmentState {
    /// Returns the name of the state for tables and legends, such as `plastic, closed`.
    pub const fn name(self) -> &'static str {
        use ContactState::{Closed, Open, Sliding};
        match (self.skeleton, self.contact) {
            (SkeletonState::Elastic, None) => "elastic",
            (SkeletonState::Elastic, Some(Open)) => "elastic, open",
            (SkeletonState::Elastic, Some(Sliding)) => "elastic, on the cone",
            (SkeletonState::Elastic, Some(Closed)) => "elastic, closed",
            (SkeletonState::Plastic, None) => "plastic",
            (SkeletonState::Plastic, Some(Open)) => "plastic, open",
            (SkeletonState::Plastic, Some(Sliding)) => "plastic, on the cone",
            (SkeletonState::Plastic, Some(Closed)) => "plastic, closed",
        }
    }

    /// Returns whether the skeleton yields.
    pub fn is_plastic(self) -> bool {
        self.skeleton == SkeletonState::Plastic
    }
}

/// Linear segment of a diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagramSegment {
    /// State of the medium.
    pub state: SegmentState,
    /// Tangent modulus dp/dε ≥ 0, Pa.
    pub slope: f64,
}

/// Corner between two segments of a diagram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiagramCorner {
    /// Compression strain ε.
    pub strain: f64,
    /// Pressure p, Pa.
    pub pressure: f64,
}

/// Piecewise-linear, non-decreasing diagram p(ε). The first and the last segment are unbounded.
#[derive(Clone, Debug, PartialEq)]
pub struct UniaxialDiagram {
    corners: Vec<DiagramCorner>,
    segments: Vec<DiagramSegment>,
    /// Index of the segment through the natural state, if the diagram passes it; the pressure there is exactly 0.
    natural_segment: Option<usize>,
}

impl UniaxialDiagram {
    /// Builds the diagram from the strains of its corners in any order, `segment_at`, which returns the segment of a
    /// strain between two corners, and the pressure `pressure_at` of a strain. Corners between equal segments are
    /// omitted. If no corner is given, the natural state is taken as the reference point.
    pub(crate) fn from_functions(
        mut strains: Vec<f64>,
        segment_at: impl Fn(f64) -> DiagramSegment,
        pressure_at: impl Fn(f64) -> f64,
    ) -> Self {
        strains.retain(|strain| strain.is_finite());
        strains.sort_by(f64::total_cmp);
        strains.dedup();
        if strains.is_empty() {
            strains.push(0.0);
        }
        let (first, last) = (strains[0], strains[strains.len() - 1]);
        let margin = 1.0 + first.abs() + last.abs();
        let mut segments = vec![segment_at(first - margin)];
        let mut corners: Vec<DiagramCorner> = Vec::new();
        for (index, &strain) in strains.iter().enumerate() {
            let next = strains.get(index + 1).copied();
            let inside = next.map_or(last + margin, |next| 0.5 * (strain + next));
            let segment = segment_at(inside);
            let is_last_anchor = index + 1 == strains.len() && corners.is_empty();
            if segments.last() != Some(&segment) || is_last_anchor {
                corners.push(DiagramCorner { strain, pressure: pressure_at(strain) });
                segments.push(segment);
            }
        }
        let natural_segment = (pressure_at(0.0) == 0.0)
            .then(|| corners.partition_point(|corner| corner.strain <= 0.0));
        Self { corners, segments, natural_segment }
    }

    /// Builds the diagram from a first segment and pairs of a corner and the segment above it, in ascending order of
    /// strain.
    ///
    /// Returns `None` if there is no corner, a strain does not ascend, a slope is negative or infinite, or the pressures
    /// of the corners do not follow from the slopes within 1e-9 of the largest pressure.
    pub fn from_corners(
        first: DiagramSegment,
        corners_and_segments: &[(DiagramCorner, DiagramSegment)],
    ) -> Option<Self> {
        let corners: Vec<DiagramCorner> = corners_and_segments.iter().map(|own| own.0).collect();
        let segments: Vec<DiagramSegment> =
            std::iter::once(first).chain(corners_and_segments.iter().map(|own| own.1)).collect();
        let is_modulus = |own: &DiagramSegment| own.slope >= 0.0 && own.slope.is_finite();
        let scale = corners.iter().map(|own| own.pressure.abs()).fold(0.0, f64::max);
        let is_joined = |(pair, segment): (&[DiagramCorner], &DiagramSegment)| {
            let [low, high] = [pair[0], pair[1]];
            let rise = segment.slope * (high.strain - low.strain);
            high.strain > low.strain && (high.pressure - low.pressure - rise).abs() <= 1e-9 * scale
        };
        let is_valid = !corners.is_empty()
            && segments.iter().all(is_modulus)
            && corners.iter().all(|own| own.strain.is_finite() && own.pressure.is_finite())
            && corners.windows(2).zip(&segments[1..]).all(is_joined);
        let natural_segment = None;
        is_valid.then_some(Self { corners, segments, natural_segment })
    }

    /// Returns the corners, in ascending order of strain; at least one.
    pub fn corners(&self) -> &[DiagramCorner] {
        &self.corners
    }

    /// Returns the segments, in ascending order of strain; one more than corners.
    pub fn segments(&self) -> &[DiagramSegment] {
        &self.segments
    }

    /// Returns the index of the segment just above a strain: at a corner the upper segment.
    pub fn segment_index_above(&self, strain: f64) -> usize {
        self.corners.partition_point(|corner| corner.strain <= strain)
    }

    /// Returns the index of the segment just below a strain: at a corner the lower segment.
    pub fn segment_index_below(&self, strain: f64) -> usize {
        self.corners.partition_point(|corner| corner.strain < strain)
    }

    /// Returns the pressure p(ε), Pa.
    pub fn pressure(&self, strain: f64) -> f64 {
        let index = self.segment_index_above(strain);
        if self.natural_segment == Some(index) {
            return self.segments[index].slope * strain;
        }
        // The corner below is the reference, so that its pressure is exact.
        let corner = self.corners[index.saturating_sub(1)];
        corner.pressure + self.segments[index].slope * (strain - corner.strain)
    }

    /// Returns the least strain of at least `from` at which the pressure reaches `pressure`; `None` if it never does.
    pub fn strain_at_pressure(&self, pressure: f64, from: f64) -> Option<f64> {
        if pressure <= self.pressure(from) {
            return Some(from);
        }
        let mut low = DiagramCorner { strain: from, pressure: self.pressure(from) };
        for index in self.segment_index_above(from)..self.segments.len() {
            let slope = self.segments[index].slope;
            match self.corners.get(index) {
                Some(corner) if corner.pressure < pressure => low = *corner,
                Some(corner) if corner.pressure == pressure => return Some(corner.strain),
                _ if slope > 0.0 => return Some(low.strain + (pressure - low.pressure) / slope),
                _ => {}
            }
        }
        None
    }

    /// Returns the greatest strain of at most `from` at which the pressure has fallen to `pressure`; `None` if it never
    /// does.
    pub fn strain_at_pressure_below(&self, pressure: f64, from: f64) -> Option<f64> {
        if pressure >= self.pressure(from) {
            return Some(from);
        }
        let mut high = DiagramCorner { strain: from, pressure: self.pressure(from) };
        for index in (0..=self.segment_index_below(from)).rev() {
            let slope = self.segments[index].slope;
            let corner = index.checked_sub(1).map(|index| self.corners[index]);
            match corner {
                Some(corner) if corner.pressure > pressure => high = corner,
                Some(corner) if corner.pressure == pressure => return Some(corner.strain),
                _ if slope > 0.0 => return Some(high.strain - (high.pressure - pressure) / slope),
                _ => {}
            }
        }
        None
    }

    /// Returns the points of the diagram between two strains, with the ends.
    pub fn points_between(&self, low: f64, high: f64) -> Vec<DiagramCorner> {
        let end = |strain| DiagramCorner { strain, pressure: self.pressure(strain) };
        let inside =
            self.corners.iter().copied().filter(|own| own.strain > low && own.strain < high);
        std::iter::once(end(low)).chain(inside).chain([end(high)]).collect()
    }

    /// Returns the work ∫p dε per unit volume from one strain to a greater one, J/m³.
    pub fn work(&self, low: f64, high: f64) -> f64 {
        let points = self.points_between(low, high);
        let trapezoid = |pair: &[DiagramCorner]| {
            0.5 * (pair[0].pressure + pair[1].pressure) * (pair[1].strain - pair[0].strain)
        };
        points.windows(2).map(trapezoid).sum()
    }
}
