//! The equation of the return mapping of Mises' sets, over any kind of number: a stress alone, or many side by side.

use crate::common::number::Number;

/// Parts of the stress on which Hooke's law acts by a number: deviator, antisymmetric stress, deviator, mean
/// and antisymmetric part of the couple stress.
pub const PARTS: usize = 5;

/// The root x = λ/2τ̄ of h(x) = τ̄(x)(1 − ax) − r = 0 by Newton's method, where r = k − κσ̄_m ≥ 0 and
/// τ̄(x)² = Σ s/(1 + xD)² over the parts that are `seen`: `squares` are s = ½p|s̄|², `rates` are D times p, `a` = 2κ²K.
///
/// Derived at [`Mises::project`](super::parameters::Mises::project): from zero the iterates rise to the root and never
/// pass it. Zero where τ̄(0) ≤ r.
#[inline(always)]
pub fn multiplier_per_shear<N: Number>(
    squares: [N; PARTS],
    rates: [N; PARTS],
    a: N,
    room: N,
    seen: &[bool; PARTS],
) -> N {
    let mut x = N::ZERO;
    loop {
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in 0..PARTS {
            if seen[part] {
                let fraction = N::ONE / (N::ONE + x * rates[part]);
                let term = squares[part] * fraction * fraction;
                norm = norm + term;
                slope = slope + term * fraction * rates[part];
            }
        }
        // Where there is no stress there is nothing to be found.
        let norm = norm.greatest(N::LEAST);
        let reciprocal = N::ONE / norm.root();
        let slope = slope / norm * reciprocal;
        let more = (N::ONE - a * x - room * reciprocal) / (a + room * slope);
        let next = x + more.greatest(N::ZERO);
        let is_done = !(next - x).exceeds(N::ZERO);
        x = next;
        if is_done {
            return x;
        }
    }
}
