//! Fourier series of periodic fields on a regular grid.

/// Largest mode number along each axis that is free of aliasing on a grid with n = `points` ≥ 1 points along the axis,
/// ⌊(n − 1)/3⌋: products of two retained modes do not alias onto retained modes (two-thirds rule, Orszag 1971).
pub fn max_dealiased_modes(points: [usize; 2]) -> [usize; 2] {
    points.map(|points| (points - 1) / 3)
}
