//! Slip along layers in plane strain, from the tangent stiffness.

use crate::interval::Interval;
use crate::numbers::{Numbers, Problem};
use crate::polynomial::{DIRECTION, Polynomial};
use crate::quantity::Quantity;

/// Names of the quantities of [`Invariants`].
pub(crate) const QUANTITIES: [&str; 3] = ["discriminant", "product/t²", "sum"];

/// Forms in the wave normal (n, t) along and across the normal of the layers, of which one component is the variable of the
/// direction.
pub(crate) struct Invariants {
    /// Discriminant, product divided by t² and sum of both ρc².
    pub(crate) forms: [Quantity; 3],
    /// h, by which the solid has a response if it is positive.
    pub(crate) stiffness: Quantity,
}

impl Invariants {
    /// For the wave normals (n, t): the second component is the variable s if `first` is given, else the first is.
    ///
    /// Stress σᵢⱼ is the component j of the traction on the face normal to i; γᵢⱼ = ∂ᵢuⱼ. With the stiffness D, the normal
    /// N = κ on σₙₙ and ±1 on σₙₜ, the flow direction M and h = N·DM, the tangent stiffness is D − (DM)(DN)ᵀ/h, and
    /// Γⱼₖ = νᵢ C₍ᵢⱼ₎₍ₗₖ₎ νₗ.
    pub(crate) fn new(
        numbers: &Numbers,
        is_positive: bool,
        first: Option<&Interval>,
    ) -> Result<Self, Problem> {
        let value = |key: &str| numbers.value(key);
        let (lambda, mu) = (value("model.lambda")?, value("model.mu")?);
        let alpha = value("model.alpha")?;
        let zero = Polynomial::whole(0);
        let sign = Polynomial::whole(if is_positive { 1 } else { -1 });
        let (axial, shear, transposed) = (&(&lambda + &mu) + &mu, &mu + &alpha, &mu - &alpha);
        let z = || zero.clone();
        // Components nn, nt, tn, tt.
        let stiffness = [
            [axial.clone(), z(), z(), lambda.clone()],
            [z(), shear.clone(), transposed.clone(), z()],
            [z(), transposed, shear, z()],
            [lambda, z(), z(), axial],
        ];
        let vector = |friction: Polynomial| [friction, sign.clone(), z(), z()];
        let normal = vector(value("yield.shear_friction")?);
        let flow = vector(value("yield.shear_dilatancy")?);
        let dot = |a: &[Polynomial; 4], b: &[Polynomial; 4]| {
            a.iter().zip(b).fold(z(), |sum, (a, b)| &sum + &(a * b))
        };
        let apply = |own: &[Polynomial; 4]| -> [Polynomial; 4] {
            std::array::from_fn(|row| dot(&stiffness[row], own))
        };
        let (by_flow, by_normal) = (apply(&flow), apply(&normal));
        let h = dot(&normal, &by_flow);
        let s = Polynomial::linear(DIRECTION, &Interval::zero(), &Interval::whole(1));
        let wave_normal = match first {
            Some(n) => [Polynomial::constant(n.clone()), s],
            None => [s, Polynomial::whole(1)],
        };
        let acoustic = |j: usize, k: usize| {
            let mut sum = z();
            for i in 0..2 {
                for l in 0..2 {
                    let (row, column) = (2 * i + j, 2 * l + k);
                    let tangent =
                        &(&h * &stiffness[row][column]) - &(&by_flow[row] * &by_normal[column]);
                    sum = &sum + &(&tangent * &(&wave_normal[i] * &wave_normal[l]));
                }
            }
            sum
        };
        let [a, b, c, d] = [acoustic(0, 0), acoustic(0, 1), acoustic(1, 0), acoustic(1, 1)];
        let (sum, product) = (&a + &d, &(&a * &d) - &(&b * &c));
        let discriminant = &(&sum * &sum) - &(&Polynomial::whole(4) * &product);
        let reduced = match first {
            Some(_) => product
                .divide_by_direction_squared()
                .ok_or(Problem::new("the product of both ρc² does not have the factor t²"))?,
            None => product,
        };
        let square = &h * &h;
        let stiffness = Quantity::new(h.clone(), Polynomial::whole(1));
        let forms = [
            Quantity::new(discriminant, square.clone()),
            Quantity::new(reduced, square),
            Quantity::new(sum, h),
        ];
        Ok(Self { forms: forms.map(Quantity::spread), stiffness })
    }
}
