//! Unit vectors in space.

pub(super) fn dot(x: &[f64; 3], y: &[f64; 3]) -> f64 {
    x[0] * y[0] + x[1] * y[1] + x[2] * y[2]
}

pub(super) fn normalise(x: [f64; 3]) -> [f64; 3] {
    let length = dot(&x, &x).sqrt();
    x.map(|x| x / length)
}

/// Two orthonormal vectors perpendicular to the unit vector `n`.
pub(super) fn tangent_vectors(n: &[f64; 3]) -> [[f64; 3]; 2] {
    let smallest = (0..3).fold(0, |least, i| if n[i].abs() < n[least].abs() { i } else { least });
    let mut first = n.map(|x| -x * n[smallest]);
    first[smallest] += 1.0;
    let first = normalise(first);
    let second = [
        n[1] * first[2] - n[2] * first[1],
        n[2] * first[0] - n[0] * first[2],
        n[0] * first[1] - n[1] * first[0],
    ];
    [first, second]
}
