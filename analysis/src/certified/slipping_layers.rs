//! Slip along layers in plane strain: signs of forms over all wave normals.

use super::direction_form::DirectionForm;
use super::{BoxProof, BoxVerdict, claim};
use models::common::scalar::Scalar;
use models::common::taylor_model::TaylorModel;

/// An isotropic solid, classical or reduced Cosserat, whose layers normal to one axis slip: one active condition
/// ±σ_t + κ σ_n ≤ τ₀ with the flow direction ±σ_t + κ̂ σ_n, the normal stress σ_n and the shear stress σ_t on the layers.
#[derive(Clone, Copy, Debug)]
pub struct SlippingLayers {
    /// First Lamé modulus λ, Pa.
    pub lambda: TaylorModel,
    /// Shear modulus μ, Pa.
    pub mu: TaylorModel,
    /// Cosserat modulus α, Pa; zero in a classical solid.
    pub alpha: TaylorModel,
    /// Friction κ.
    pub friction: TaylorModel,
    /// Dilatancy κ̂.
    pub dilatancy: TaylorModel,
    /// Whether the condition is that of positive shear stress.
    pub is_positive: bool,
}

impl SlippingLayers {
    /// The sum and the product of both ρc² as forms in the wave normal (n along the layers' normal, t along the layers), of
    /// degrees 2 and 4, and the product divided by t².
    ///
    /// With N and M the normal and the flow direction, D the elastic stiffness and h = N·DM, the acoustic tensor is
    /// Γ = Γₑ − a bᵀ/h with aᵢ = (DM)ᵢⱼ νⱼ and bᵢ = (DN)ᵢⱼ νⱼ, so that tr Γ = tr Γₑ − a·b/h and
    /// det Γ = det Γₑ − a·adj(Γₑ) b/h. N and M act on the traction of the layers only, and without hardening the tangent
    /// stiffness annihilates both: Γ vanishes on one vector from either side for t = 0, hence det Γ has the factor t².
    fn invariants(&self) -> Option<Invariants> {
        let Self { lambda, mu, alpha, friction, dilatancy, is_positive } = *self;
        let (zero, two) = (TaylorModel::ZERO, TaylorModel::from_exact(2.0));
        let sign = TaylorModel::from_exact(if is_positive { 1.0 } else { -1.0 });
        let (pressure, shear) = (lambda + two * mu, mu + alpha);
        let denominator = friction * dilatancy * pressure + shear;
        if denominator.certain_sign() != Some(1) {
            return None;
        }
        // Components of the traction D M ν along the layers' normal and along the layers, linear in (n, t).
        let image = |own: TaylorModel| {
            let along_normal = DirectionForm::new(vec![own * pressure, sign * (mu - alpha)]);
            let along_layers = DirectionForm::new(vec![sign * shear, own * lambda]);
            [along_normal, along_layers]
        };
        let (a, b) = (image(dilatancy), image(friction));
        let elastic = [
            DirectionForm::new(vec![pressure, zero, shear]),
            DirectionForm::new(vec![zero, lambda + mu - alpha, zero]),
            DirectionForm::new(vec![shear, zero, pressure]),
        ];
        let [first, mixed, last] = &elastic;
        let inverse = TaylorModel::from_exact(1.0) / denominator;
        let sum = &(first + last) - &(inverse * &(&(&a[0] * &b[0]) + &(&a[1] * &b[1])));
        // a·adj(Γₑ) b
        let adjugate = &(&(&(&a[0] * &b[0]) * last) + &(&(&a[1] * &b[1]) * first))
            - &(mixed * &(&(&a[0] * &b[1]) + &(&a[1] * &b[0])));
        let product = &(&(first * last) - &(mixed * mixed)) - &(inverse * &adjugate);
        let reduced_product = product.clone().divide_by_second_squared();
        Some(Invariants { sum, product, reduced_product })
    }

    /// Verdict on all states of the box.
    ///
    /// Well-posed if both c² are real, different and positive in all directions but for the normal of the layers, where one
    /// vanishes: sum, discriminant and reduced product positive. Ill-posed if in one direction c² is complex (flutter:
    /// negative discriminant) or negative (shear band).
    pub fn prove(&self) -> BoxProof {
        let Some(Invariants { sum, product, reduced_product }) = self.invariants() else {
            return BoxProof::NONE;
        };
        let four = TaylorModel::from_exact(4.0);
        let discriminant = &(&sum * &sum) - &(four * &product);
        let forms =
            [("discriminant", &discriminant), ("product/t²", &reduced_product), ("sum", &sum)];
        for (name, form) in forms {
            if let Some((direction, range)) = form.prove_negative() {
                let claims = vec![claim(name, Some(direction), range)];
                return BoxProof { verdict: BoxVerdict::IllPosed, claims };
            }
        }
        let mut claims = Vec::new();
        for (name, form) in forms {
            let Some(found) = form.prove_positive() else { return BoxProof::NONE };
            claims.extend(found.into_iter().map(|(own, range)| claim(name, Some(own), range)));
        }
        BoxProof { verdict: BoxVerdict::WellPosed, claims }
    }
}

/// Forms of [`SlippingLayers::invariants`].
struct Invariants {
    sum: DirectionForm,
    product: DirectionForm,
    reduced_product: DirectionForm,
}
