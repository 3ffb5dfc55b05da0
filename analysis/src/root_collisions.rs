//! Collisions of the roots c of a face polynomial over its angle, located by Newton's iteration.

use crate::face_polynomial::FacePolynomial;
use crate::list::{StackList, list};
use crate::puiseux::BoundedRoot;
use models::common::elementary::Modulus;
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// An angle at which roots collide.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RootCollision {
    /// Angle α, rad; not reduced to [0, π).
    pub(crate) angle: f64,
    /// The multiple root c at `angle`.
    pub(crate) root: BoundedRoot,
    /// Whether the angle is accurate to rounding; false where branches touch.
    pub(crate) is_accurate: bool,
}

/// Collisions of roots next to `angle` (rad), with refined angles: only multiple roots that split at neighbouring
/// angles.
///
/// Roots that are neutral at angles on both sides of the collision cross; they do not fold. At a crossing of n branches
/// of E(c, α) = 0 all derivatives of order below n vanish. Newton's iteration is applied to the two of highest order in
/// c, ∂ⁿ⁻¹E/∂cⁿ⁻¹ = ∂ⁿ⁻¹E/∂α∂cⁿ⁻² = 0, whose common zero is simple unless two branches touch; it is then located to
/// full accuracy. If `angle` is within 0.01 rad of 0, π/2 or π, the roots at exactly that angle are included too.
pub(crate) fn find_collisions(face: &FacePolynomial, angle: f64) -> StackList<RootCollision> {
    let mut found: StackList<RootCollision> = StackList::new();
    let mut include = |angle: f64, near: Option<Complex64>, is_accurate: bool| {
        for root in face.roots(angle).into_iter().filter(|r| r.multiplicity > 1) {
            let is_meant =
                near.is_none_or(|c| (c - root.value).modulus() <= 1e-3 * root.value.modulus());
            if !is_meant || !is_split_nearby(face, angle, &root) {
                continue;
            }
            let is_same = |c: &&RootCollision| {
                (c.root.value - root.value).modulus() <= 1e-2 * root.value.modulus()
                    && (!is_accurate || (c.angle - angle).abs() < 1e-9)
            };
            if !found.iter().any(|c| is_same(&c)) {
                let bound = root.bound.max(1e-14 * root.value.modulus());
                found.push(RootCollision {
                    angle,
                    root: BoundedRoot { bound, ..root },
                    is_accurate,
                });
            }
        }
    };
    for axis in [0.0, FRAC_PI_2, PI] {
        if (angle - axis).abs() < 1e-2 {
            include(axis, None, true);
        }
    }
    let roots = face.roots(angle);
    let mut is_settled: StackList<bool> = list![false; roots.len()];
    for first in &roots {
        // Groups of one root and its neighbours, the largest group first.
        let mut near: StackList<(f64, usize)> =
            roots.iter().enumerate().map(|(i, r)| ((r.value - first.value).modulus(), i)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        near.retain(|(gap, _)| *gap <= 0.2 * first.value.modulus());
        for end in (0..near.len()).rev() {
            let members = &near[..=end];
            let count = members.iter().map(|(_, i)| roots[*i].multiplicity).sum::<usize>();
            // Skip single roots and groups with a root of a crossing already found.
            if count < 2 || members.iter().any(|(_, i)| is_settled[*i]) {
                continue;
            }
            let weighted = |(_, i): &(f64, usize)| roots[*i].value * roots[*i].multiplicity as f64;
            let start = members.iter().map(weighted).sum::<Complex64>() / count as f64;
            if let Some((place, root, is_accurate)) = locate_crossing(face, angle, start, count) {
                include(place, Some(root), is_accurate);
                members.iter().for_each(|(_, i)| is_settled[*i] = true);
                break;
            }
        }
    }
    found
}

/// Number of Newton steps from a zero of the discriminant; a collision is accurate if the last three are below 1e-12.
const NEWTON_STEPS: usize = 12;

/// Locates the crossing of `count` branches near `angle` and the root c by Newton's iteration: angle, root, and whether
/// convergence was quadratic (branches cross) and not linear (branches touch). `None` if the iteration leaves the
/// neighbourhood or does not converge, or if E does not vanish at its limit.
fn locate_crossing(
    face: &FacePolynomial,
    angle: f64,
    c: Complex64,
    count: usize,
) -> Option<(f64, Complex64, bool)> {
    let (mut place, mut root) = (Complex64::from(angle), c);
    let mut steps = [f64::INFINITY; NEWTON_STEPS];
    let n = count as f64;
    for last in &mut steps {
        // f = ∂c^(n−1) E and g = ∂α ∂c^(n−2) E over factorials, with their derivatives by c and α.
        let [value, by_angle, twice] = face.taylor_coefficients(place, root, count);
        let (f, fc, fa) = (value[count - 1], n * value[count], by_angle[count - 1]);
        let (g, gc, ga) = (by_angle[count - 2], (n - 1.0) * by_angle[count - 1], twice[count - 2]);
        let determinant = fc * ga - fa * gc;
        let step = [(fc * g - f * gc) / determinant, (f * ga - fa * g) / determinant];
        if !step[0].is_finite() || !step[1].is_finite() {
            return None;
        }
        place -= step[0];
        root -= step[1];
        *last = step[0].modulus() + step[1].modulus() / root.modulus();
    }
    // Require several small steps: a single one may be accidental.
    let is_accurate = steps[NEWTON_STEPS - 3..].iter().all(|&step| step < 1e-12);
    let last = steps[NEWTON_STEPS - 1];
    let is_close = (place - angle).modulus() < 1e-2 && (root - c).modulus() < 0.2 * c.modulus();
    if last > 1e-3 || !is_close || place.im.abs() > 1e-3 * last + 1e-9 {
        return None;
    }
    // f = g = 0 also where branches only approach each other: E itself must vanish.
    let [value, ..] = face.taylor_coefficients(place.re.into(), root, 2);
    let tolerance = if is_accurate { 1e-13 } else { 1e-10 };
    let holds = value[0].modulus() <= tolerance * face.sum_of_moduli(root.modulus());
    holds.then_some((place.re, root, is_accurate))
}

/// Whether a multiple root splits: at one of the angles 1e-3 rad away the nearest root has a lower multiplicity.
fn is_split_nearby(face: &FacePolynomial, angle: f64, root: &BoundedRoot) -> bool {
    [1e-3, -1e-3].into_iter().any(|offset| {
        let distance = |r: &BoundedRoot| (r.value - root.value).modulus();
        let beside = face.roots(angle + offset);
        let nearest = beside.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.is_some_and(|nearest| nearest.multiplicity < root.multiplicity)
    })
}
