//! Uniaxial strain of a granular medium.
//!
//! The mean pressure P = kε of the conditional stress has no plastic part; its signed intensity T changes by m dε and is
//! limited by |T| ≤ T_F(P). A path is therefore a piecewise-linear function T(ε), and the stress its projection.

use super::parameters::GranularMedium;
use crate::uniaxial::cone::ConditionalStress;
use crate::uniaxial::{DiagramSegment, SegmentState, SkeletonState, UniaxialDiagram};

/// Linear piece of the path T(ε) between two strains.
#[derive(Clone, Copy, Debug)]
struct PathPiece {
    /// Least and greatest strain of the piece; may be infinite.
    range: [f64; 2],
    /// Strain at which the intensity is given.
    strain: f64,
    /// Intensity T at that strain, Pa.
    intensity: f64,
    /// Derivative dT/dε, Pa.
    rate: f64,
    /// Whether the particles yield.
    is_plastic: bool,
}

impl GranularMedium {
    /// Returns the diagram of monotone loading from the natural state: compression for ε > 0, extension for ε < 0.
    ///
    /// In compression the modulus is k + 4μ/3 if m ≤ æk, else that of the cone,
    /// E_c = k (M + æm)/(M + æ²k) · (1 + æ/r). Yielding particles on the cone have a segment of modulus 0, on which they
    /// yield while they still open, before the modulus k.
    pub fn loading_diagram(&self) -> UniaxialDiagram {
        let cone = self.cone();
        let m = cone.intensity.intensity_modulus;
        let elastic = PathPiece {
            range: [f64::NEG_INFINITY, f64::INFINITY],
            strain: 0.0,
            intensity: 0.0,
            rate: m,
            is_plastic: false,
        };
        let Some((limit, closing)) = self.yield_limit() else { return self.diagram(&[elastic]) };
        let corner_rate = -cone.intensity.energy_modulus / cone.friction;
        let mut pieces = Vec::new();
        // Extension meets the limit only if the cone transmits tension; both lines start at the same pressure.
        let corner_intensity = limit - corner_rate * closing;
        let extension = -corner_intensity / (m + corner_rate);
        let yields_in_extension = m > -corner_rate;
        if yields_in_extension {
            pieces.push(PathPiece {
                range: [f64::NEG_INFINITY, extension],
                strain: extension,
                intensity: m * extension,
                rate: -corner_rate,
                is_plastic: true,
            });
        }
        let low = if yields_in_extension { extension } else { f64::NEG_INFINITY };
        let compression = (corner_intensity / (m - corner_rate)).max(limit / m);
        pieces.push(PathPiece { range: [low, compression], ..elastic });
        if compression < closing {
            pieces.push(PathPiece {
                range: [compression, closing],
                strain: closing,
                intensity: limit,
                rate: corner_rate,
                is_plastic: true,
            });
        }
        pieces.push(PathPiece {
            range: [compression.max(closing), f64::INFINITY],
            strain: closing,
            intensity: limit,
            rate: 0.0,
            is_plastic: true,
        });
        self.diagram(&pieces)
    }

    /// Returns the diagram of monotone unloading from the strain `strain` ≥ 0 of [`loading_diagram`]; for greater
    /// strains it is the elastic continuation.
    ///
    /// [`loading_diagram`]: Self::loading_diagram
    pub fn unloading_diagram(&self, strain: f64) -> UniaxialDiagram {
        let cone = self.cone();
        let m = cone.intensity.intensity_modulus;
        let piece = |range, strain, intensity, rate, is_plastic| PathPiece {
            range,
            strain,
            intensity,
            rate,
            is_plastic,
        };
        let (inf, start) = (f64::INFINITY, strain);
        let Some((limit, closing)) = self.yield_limit() else {
            return self.diagram(&[piece([-inf, inf], 0.0, 0.0, m, false)]);
        };
        let corner_rate = -cone.intensity.energy_modulus / cone.friction;
        let corner_limit = |strain: f64| limit + corner_rate * (strain - closing);
        let limit_at = |strain: f64| if strain >= closing { limit } else { corner_limit(strain) };
        let start_intensity = (m * start).min(limit_at(start));
        let mut pieces = Vec::new();
        // Unloading down to the strain at which the projection enters the corner of cone and yield limit.
        let (mut strain, mut intensity, mut high) = (start, start_intensity, inf);
        if start > closing {
            let reverse = start - (start_intensity + limit) / m;
            if reverse > closing {
                pieces.push(piece([reverse, inf], start, start_intensity, m, false));
                pieces.push(piece([closing, reverse], closing, -limit, 0.0, true));
                (strain, intensity, high) = (closing, -limit, closing);
            }
        }
        // Below that strain the limit rises with the rate M/æ; the elastic intensity meets it only if m is greater.
        let gap = corner_limit(strain) + intensity;
        let reverse = strain - gap / (m + corner_rate);
        let low = if m > -corner_rate { reverse } else { -inf };
        if low < high {
            pieces.push(piece([low, high], strain, intensity, m, false));
        }
        if m > -corner_rate {
            pieces.push(piece([-inf, low], closing, -limit, -corner_rate, true));
        }
        self.diagram(&pieces)
    }

    /// Returns the yield stress, if it can be reached, and the strain above which yielding particles stay closed.
    fn yield_limit(&self) -> Option<(f64, f64)> {
        let own = self.parameters();
        let limit = own.yield_stress.filter(|_| own.friction > 0.0)?;
        Some((limit, limit / (own.friction * own.bulk_modulus)))
    }

    fn diagram(&self, pieces: &[PathPiece]) -> UniaxialDiagram {
        let cone = self.cone();
        let limit = self.yield_limit().map(|own| own.0);
        let piece_at = |strain: f64| {
            let own = pieces.iter().find(|own| strain >= own.range[0] && strain <= own.range[1]);
            *own.unwrap_or(&pieces[0])
        };
        let stress_at = |piece: &PathPiece, strain: f64| ConditionalStress {
            pressure: cone.bulk_modulus * strain,
            intensity: piece.intensity + piece.rate * (strain - piece.strain),
            intensity_rate: piece.rate,
        };
        let mut strains = Vec::new();
        for piece in pieces {
            strains.extend(piece.range);
            // While the particles yield, the contact stays closed or on the cone.
            if piece.is_plastic {
                continue;
            }
            let inside = |strain: &f64| *strain > piece.range[0] && *strain < piece.range[1];
            let transitions = cone.transition_strains(piece.strain, stress_at(piece, piece.strain));
            strains.extend(transitions.into_iter().filter(inside));
        }
        let segment_at = |strain: f64| {
            let piece = piece_at(strain);
            let stress = stress_at(&piece, strain);
            let [_, slope] = cone.front_pressure(stress, limit.filter(|_| piece.is_plastic));
            let skeleton = match piece.is_plastic {
                true => SkeletonState::Plastic,
                false => SkeletonState::Elastic,
            };
            let contact = Some(cone.state(stress));
            DiagramSegment { state: SegmentState { skeleton, contact }, slope }
        };
        let pressure_at = |strain: f64| {
            let piece = piece_at(strain);
            cone.front_pressure(stress_at(&piece, strain), limit.filter(|_| piece.is_plastic))[0]
        };
        UniaxialDiagram::from_functions(strains, segment_at, pressure_at)
    }
}
