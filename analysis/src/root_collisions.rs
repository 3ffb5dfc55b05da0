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
    /// Bound on the error of an accurate angle, rad.
    pub(crate) angle_bound: f64,
    /// The multiple root c at `angle`.
    pub(crate) root: BoundedRoot,
    /// Whether angle and root are accurate to [`ACCURATE_BOUND`]; false where branches touch.
    pub(crate) is_accurate: bool,
}

/// Error bound of the angle (rad) and of the root relative to its modulus up to which a collision is accurate. Where
/// branches touch, no point qualifies: at a distance ε the Jacobian of Newton's iteration is of order ε², so that the step
/// is of order ε and the rounding error of the step of order 1e-16/ε².
const ACCURATE_BOUND: f64 = 1e-10;

/// Least error bound of an angle, rad, and of a root relative to its modulus.
const LEAST_ANGLE_BOUND: f64 = 4e-15;
const LEAST_ROOT_BOUND: f64 = 1e-14;

/// A crossing of branches and its error bounds.
struct Crossing {
    angle: f64,
    angle_bound: f64,
    root: Complex64,
    root_bound: f64,
}

impl Crossing {
    /// Whether both bounds are at most [`ACCURATE_BOUND`]; false for bounds that are not numbers.
    fn is_accurate(&self) -> bool {
        self.angle_bound <= ACCURATE_BOUND
            && self.root_bound <= ACCURATE_BOUND * self.root.modulus()
    }
}

/// Collisions of roots next to `angle` (rad), with refined angles: only multiple roots that split at neighbouring
/// angles.
///
/// Roots that are neutral at angles on both sides of the collision cross; they do not fold. At a crossing of n branches
/// of E(c, α) = 0 all derivatives of order below n vanish. Newton's iteration is applied to the two of highest order in
/// c, ∂ⁿ⁻¹E/∂cⁿ⁻¹ = ∂ⁿ⁻¹E/∂α∂cⁿ⁻² = 0, whose common zero is simple unless two branches touch. If `angle` is within 0.01 rad of 0, π/2 or π, the roots at exactly that angle are included too.
pub(crate) fn find_collisions(face: &FacePolynomial, angle: f64) -> StackList<RootCollision> {
    let mut found: StackList<RootCollision> = StackList::new();
    let mut include = |angle: f64, crossing: Option<&Crossing>| {
        let is_accurate = crossing.is_none_or(Crossing::is_accurate);
        for root in face.roots(angle).into_iter().filter(|r| r.multiplicity > 1) {
            let is_meant = crossing
                .is_none_or(|c| (c.root - root.value).modulus() <= 1e-3 * root.value.modulus());
            if !is_meant || !is_split_nearby(face, angle, &root) {
                continue;
            }
            let is_same = |c: &&RootCollision| {
                (c.root.value - root.value).modulus() <= 1e-2 * root.value.modulus()
                    && (!is_accurate || (c.angle - angle).abs() < 1e-9)
            };
            if !found.iter().any(|c| is_same(&c)) {
                let [angle_bound, root_bound] =
                    crossing.map_or([0.0; 2], |c| [c.angle_bound, c.root_bound]);
                let least = root_bound.max(LEAST_ROOT_BOUND * root.value.modulus());
                found.push(RootCollision {
                    angle,
                    angle_bound: angle_bound.max(LEAST_ANGLE_BOUND),
                    root: BoundedRoot { bound: root.bound.max(least), ..root },
                    is_accurate,
                });
            }
        }
    };
    for axis in [0.0, FRAC_PI_2, PI] {
        if (angle - axis).abs() < 1e-2 {
            include(axis, None);
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
            if let Some(crossing) = locate_crossing(face, angle, start, count) {
                include(crossing.angle, Some(&crossing));
                members.iter().for_each(|(_, i)| is_settled[*i] = true);
                break;
            }
        }
    }
    found
}

/// Number of Newton steps from a zero of the discriminant.
const NEWTON_STEPS: usize = 12;

/// The equations f = ∂ⁿ⁻¹E/∂cⁿ⁻¹ = 0 and g = ∂ⁿ⁻¹E/∂α∂cⁿ⁻² = 0 of a crossing of n branches, over factorials, linearised.
struct CrossingEquations {
    /// [f, g].
    values: [Complex64; 2],
    /// Derivatives [f_c, f_α] and [g_c, g_α].
    jacobian: [[Complex64; 2]; 2],
}

impl CrossingEquations {
    fn new(face: &FacePolynomial, angle: Complex64, c: Complex64, count: usize) -> Self {
        let n = count as f64;
        let [value, by_angle, twice] = face.taylor_coefficients(angle, c, count);
        let f = [n * value[count], by_angle[count - 1]];
        let g = [(n - 1.0) * by_angle[count - 1], twice[count - 2]];
        Self { values: [value[count - 1], by_angle[count - 2]], jacobian: [f, g] }
    }

    /// Newton's step [α, c], to be subtracted, by Cramer's rule.
    fn step(&self) -> [Complex64; 2] {
        let ([f, g], [[fc, fa], [gc, ga]]) = (self.values, self.jacobian);
        let determinant = fc * ga - fa * gc;
        [(fc * g - f * gc) / determinant, (f * ga - fa * g) / determinant]
    }

    /// Bounds on the errors of the step for `errors` of [f, g].
    fn step_errors(&self, errors: [f64; 2]) -> [f64; 2] {
        let [[fc, fa], [gc, ga]] = self.jacobian;
        let determinant = (fc * ga - fa * gc).modulus();
        let [f, g] = errors;
        [[gc, fc], [ga, fa]].map(|[a, b]| (a.modulus() * f + b.modulus() * g) / determinant)
    }
}

/// Locates the crossing of `count` branches near `angle` and the root c by Newton's iteration. `None` if the iteration
/// leaves the neighbourhood or does not converge, or if E does not vanish at its limit.
///
/// The bounds are twice the sum of the next step and of its rounding error: the steps become small also where the
/// rounding errors of f and g happen to cancel, and the rounding error of a step is large where branches touch. The factor
/// covers the quadratic terms and the rounding of the Jacobian, which are small parts at an accurate crossing.
fn locate_crossing(
    face: &FacePolynomial,
    angle: f64,
    c: Complex64,
    count: usize,
) -> Option<Crossing> {
    let (mut place, mut root) = (Complex64::from(angle), c);
    let mut last = f64::INFINITY;
    for _ in 0..NEWTON_STEPS {
        let equations = CrossingEquations::new(face, place, root, count);
        let step = equations.step();
        if !step[0].is_finite() || !step[1].is_finite() {
            return None;
        }
        place -= step[0];
        root -= step[1];
        last = step[0].modulus() + step[1].modulus() / root.modulus();
    }
    let is_close = (place - angle).modulus() < 1e-2 && (root - c).modulus() < 0.2 * c.modulus();
    if last > 1e-3 || !is_close || place.im.abs() > 1e-3 * last + 1e-9 {
        return None;
    }
    let place = place.re;
    let equations = CrossingEquations::new(face, place.into(), root, count);
    let errors = equations.step_errors(face.taylor_errors(place, root.modulus(), count));
    let step = equations.step();
    let [angle_bound, root_bound] = std::array::from_fn(|i| 2.0 * (step[i].modulus() + errors[i]));
    let crossing = Crossing { angle: place, angle_bound, root, root_bound };
    // f = g = 0 also where branches only approach each other: E itself must vanish.
    let [value, ..] = face.taylor_coefficients(place.into(), root, 0);
    let tolerance = if crossing.is_accurate() { 1e-13 } else { 1e-10 };
    let holds = value[0].modulus() <= tolerance * face.sum_of_moduli(root.modulus());
    holds.then_some(crossing)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rounded_complex::RoundedComplex;
    use models::common::elementary::Elementary;

    /// Coefficients [i][l] of cⁱ x^(r−l) yˡ, and their moduli before cancellation.
    type Product = Vec<Vec<[f64; 2]>>;

    /// c + a x + b y.
    fn linear(a: f64, b: f64) -> Product {
        vec![vec![[a, a.abs()], [b, b.abs()]], vec![[1.0; 2]]]
    }

    fn multiply(first: &Product, second: &Product) -> Product {
        let degree = first.len() + second.len() - 2;
        let mut product: Product = (0..=degree).map(|i| vec![[0.0; 2]; degree - i + 1]).collect();
        for (i, f) in first.iter().enumerate() {
            for (j, g) in second.iter().enumerate() {
                for (l, [u, size]) in f.iter().enumerate() {
                    for (m, [v, other]) in g.iter().enumerate() {
                        let [value, modulus] = &mut product[i + j][l + m];
                        *value += u * v;
                        *modulus += size * other;
                    }
                }
            }
        }
        product
    }

    fn face(product: &Product) -> FacePolynomial {
        let rounded =
            |[value, modulus]: &[f64; 2]| RoundedComplex::new((*value).into(), 2e-15 * modulus);
        FacePolynomial::new(product.iter().map(|form| form.iter().map(rounded).collect()).collect())
    }

    fn distance(angle: f64, other: f64) -> f64 {
        let gap = (angle - other).rem_euclid(PI);
        gap.min(PI - gap)
    }

    /// The branches c = 2x − y and the smaller root of (c − 2x − 2y)(c − 2x + y) = 4x² touch at x = 0: no angle near it is
    /// called accurate, in axes turned by any angle.
    #[test]
    fn touching_branches_are_never_an_accurate_crossing() {
        let mut count = 0;
        for turn in 1..1000 {
            let (sin, cos) = (1e-3 * f64::from(turn) * FRAC_PI_2).cr_sin_cos();
            let turned = |a: f64, b: f64| linear(a * cos + b * sin, b * cos - a * sin);
            let mut quadratic = multiply(&turned(-2.0, -2.0), &turned(-2.0, 1.0));
            let square = [4.0 * cos * cos, -8.0 * cos * sin, 4.0 * sin * sin];
            for ([value, modulus], own) in quadratic[0].iter_mut().zip(square) {
                (*value, *modulus) = (*value - own, *modulus + own.abs());
            }
            let face = face(&multiply(&quadratic, &turned(-2.0, 1.0)));
            for &angle in face.collision_angles() {
                for collision in find_collisions(&face, angle) {
                    assert!(!collision.is_accurate, "turn {turn}: {collision:?}");
                    count += 1;
                }
            }
        }
        assert!(count > 1000, "{count}");
    }

    /// The crossings of four planes c = −ax − by are at known angles.
    #[test]
    fn crossings_of_planes_are_within_their_bounds() {
        let mut state = 5u32;
        let mut draw = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 23) - 1.0
        };
        let (mut accurate, mut total) = (0, 0);
        for round in 0..200 {
            let planes: Vec<[f64; 2]> = (0..4).map(|_| [draw(), draw()]).collect();
            let product = planes[1..].iter().fold(linear(planes[0][0], planes[0][1]), |all, p| {
                multiply(&all, &linear(p[0], p[1]))
            });
            let face = face(&product);
            let crossings: Vec<f64> = (0..4)
                .flat_map(|i| (0..i).map(move |j| (i, j)))
                .map(|(i, j)| (planes[j][0] - planes[i][0]).cr_atan2(planes[i][1] - planes[j][1]))
                .collect();
            total += crossings.len();
            let mut known: Vec<f64> = Vec::new();
            for &angle in face.collision_angles() {
                // Within the small triangle of three almost concurrent planes lies another zero of both equations, where E
                // is below rounding: only the bound of the root is large there.
                let is_meant = |c: &&RootCollision| {
                    c.is_accurate && c.root.bound <= 1e-7 * c.root.value.modulus()
                };
                for found in find_collisions(&face, angle).iter().filter(is_meant) {
                    let error =
                        crossings.iter().map(|own| distance(found.angle, *own)).fold(PI, f64::min);
                    assert!(error <= found.angle_bound, "round {round}: {error:e} in {found:?}");
                    if known.iter().all(|own| distance(*own, found.angle) > 1e-9) {
                        known.push(found.angle);
                    }
                }
            }
            accurate += known.len();
        }
        assert!(10 * accurate > 9 * total, "{accurate} of {total}");
    }
}
