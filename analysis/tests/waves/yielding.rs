//! Random yielding solids, and the growth of their symmetric-hyperbolic form.

use crate::support::states::RandomNumbers;
use models::common::rates::{RateEquations, SymmetricForm};
use models::solid::parameters::{Isotropic, Theory};
use models::solid::stress::Stress;
use models::yield_set::YieldSet;
use models::yield_set::parameters::{ActiveCondition, InterlayerYieldSet, Mises};
use models::yield_set::tangent::tangent_stiffness;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex64;

use super::random_solids::random_solid_of_order_one;

/// Random stress on the yield surface, by scaling from zero; with `corners` half of the stresses lie on an edge of the
/// interlayer set.
pub fn random_stress_on_yield_surface(
    random: &mut RandomNumbers,
    set: &YieldSet,
    corners: bool,
) -> Stress {
    loop {
        let mut stress = Stress::default();
        for i in 0..3 {
            for j in 0..3 {
                stress.force[i][j] = random.uniform(-1.0, 1.0);
                stress.couple[i][j] = random.uniform(-1.0, 1.0);
            }
        }
        let scaled = |factor: f64| Stress {
            force: stress.force.map(|row| row.map(|x| factor * x)),
            couple: stress.couple.map(|row| row.map(|x| factor * x)),
        };
        let (mut low, mut high) = (0.0, 1.0);
        while set.yield_function(&scaled(high)) < 0.0 && high < 1e6 {
            high *= 2.0;
        }
        if high >= 1e6 {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if set.yield_function(&scaled(middle)) < 0.0 { low = middle } else { high = middle }
        }
        let mut stress = scaled(high);
        if let (Some(set), true) =
            (set.downcast::<InterlayerYieldSet>(), corners && random.bernoulli(0.5))
        {
            // Stress at which both layers slip and, if the set limits the couple stress, in half of the cases its limit
            // is reached.
            stress.force[1][0] = set.shear_strength - set.shear_friction * stress.force[0][0];
            stress.force[0][1] = set.shear_friction * stress.force[1][1] - set.shear_strength;
            if let (Some(couple), true) = (set.couple, random.bernoulli(0.5)) {
                stress.couple[2][0] = couple.strength - couple.friction * stress.force[0][0];
            }
            if YieldSet::from(*set).yield_function(&stress) > 1e-9 {
                continue;
            }
        }
        return stress;
    }
}

/// Mises-type yield set with friction and dilatancy, and its active condition at a random stress on it.
pub fn random_mises_condition(
    random: &mut RandomNumbers,
    friction: f64,
    dilatancy: f64,
) -> (Mises, Stress, ActiveCondition) {
    let set = Mises {
        antisymmetric_weight: random.uniform(0.2, 2.0),
        symmetric_internal_length: Some(0.8),
        antisymmetric_internal_length: Some(0.6),
        ..Mises::new_drucker_prager(1.0, friction, dilatancy)
    };
    let stress = random_stress_on_yield_surface(random, &YieldSet::from(set), false);
    let condition = set.condition(&stress).expect("off the axis");
    (set, stress, condition)
}

/// Orthonormal basis of the vectors U with n·U = 0 for all normals n.
pub fn tangent_basis(size: usize, normals: &[DVector<f64>]) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let orthogonal = |columns: &[DVector<f64>], v: &DVector<f64>| {
        let mut v = v.clone();
        // Two passes of Gram–Schmidt orthogonalisation are enough (Kahan).
        for _ in 0..2 {
            for c in columns {
                v -= c * c.dot(&v);
            }
        }
        v
    };
    for normal in normals {
        let rest = orthogonal(&columns, normal);
        if rest.norm() > 1e-9 * normal.norm() {
            columns.push(rest.normalize());
        }
    }
    let rank = columns.len();
    for i in 0..size {
        let rest = orthogonal(&columns, &DVector::from_fn(size, |r, _| f64::from(r == i)));
        if rest.norm() > 1e-6 {
            columns.push(rest.normalize());
        }
    }
    assert_eq!(columns.len(), size);
    DMatrix::from_columns(&columns[rank..])
}

/// Largest Re ς and largest entry of the Hermitian part of the symbol of a symmetric-hyperbolic system at the wave
/// vector κ = `wave`, relative to the largest entry: with A = LLᵀ the roots are the eigenvalues of L⁻¹(iΣκᵢBⁱ + Q)L⁻ᵀ,
/// whose Hermitian part bounds every Re ς.
pub fn growth_and_bound<const D: usize>(form: &SymmetricForm<D>, wave: [f64; D]) -> (f64, f64) {
    let factor = form.a.clone().cholesky().expect("positive definite");
    let half = |m: &DMatrix<f64>| {
        let left = factor.l().solve_lower_triangular(m).expect("regular");
        factor.l().solve_lower_triangular(&left.transpose()).expect("regular").transpose()
    };
    let mut k = half(&form.q).map(|x| Complex64::new(x, 0.0));
    for (b, component) in form.b.iter().zip(wave) {
        k += half(b).map(|x| Complex64::new(0.0, component * x));
    }
    let size = k.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let hermitian = (&k + k.adjoint()).scale(0.5);
    let bound = hermitian.iter().map(|x| x.norm()).fold(0.0, f64::max);
    let roots = k.schur().unpack().1.diagonal();
    (roots.iter().map(|r| r.re).fold(f64::NEG_INFINITY, f64::max) / size, bound / size)
}

/// Rate equations of an elastic solid with the out-of-plane stresses among the unknowns.
pub fn equations_with_out_of_plane_stresses<const D: usize>(solid: &Isotropic) -> RateEquations<D> {
    let layout = solid.layout::<D>().with_out_of_plane();
    let inertia = solid.microrotation.map_or(0.0, |m| m.inertia);
    layout.rates(&solid.stiffness(layout.all_stresses()), solid.density, inertia)
}

/// Rate equations of a random yielding Cosserat solid in plane strain, with constants of order one; `dilatancy` maps
/// friction to dilatancy.
pub fn random_yielding_equations(
    random: &mut RandomNumbers,
    dilatancy: impl Fn(f64) -> f64,
) -> RateEquations<2> {
    loop {
        let solid = random_solid_of_order_one(random, Theory::Cosserat);
        let layout = solid.layout::<2>();
        let list: Vec<_> = layout.all_stresses().collect();
        let friction = random.uniform(0.0, 1.0);
        let (_, _, condition) = random_mises_condition(random, friction, dilatancy(friction));
        let stiffness =
            tangent_stiffness(&solid.stiffness(layout.all_stresses()), &list, &[condition]);
        if let (Ok(stiffness), Some(rotation)) = (stiffness, solid.microrotation) {
            return layout.rates(&stiffness, 1.0, rotation.inertia);
        }
    }
}

/// Reverses time in a symmetric-hyperbolic system.
pub fn reverse_time<const D: usize>(form: &SymmetricForm<D>) -> SymmetricForm<D> {
    SymmetricForm { a: form.a.clone(), b: form.b.each_ref().map(|b| -b), q: -&form.q }
}
