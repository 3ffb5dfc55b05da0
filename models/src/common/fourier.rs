//! Fourier series of periodic fields on a regular grid.

/// Greatest mode numbers of series on so many points along each axis: products of two of them are not mistaken
/// for others (the rule of two thirds, Orszag 1971).
pub fn greatest_modes(points: [usize; 2]) -> [usize; 2] {
    points.map(|points| (points - 1) / 3)
}
