//! Yield cones of classical solids in space: a quadratic form in the squared components of the wave normal.

use crate::interval::Interval;
use crate::numbers::{Numbers, Problem};
use crate::polynomial::Polynomial;
use crate::quantity::Quantity;
use num_bigint::BigInt;
use num_rational::BigRational;

/// Largest number of triangles in a proof that a form is positive.
const MAX_TRIANGLE_COUNT: usize = 1 << 10;

/// The form xᵀAx over a common positive divisor.
pub(crate) struct Form {
    /// Entries of A by the divisor.
    entries: [[Polynomial; 3]; 3],
    divisor: Polynomial,
    /// Quantities that must be positive: h, λ + μ, μ, and τ̄ + κσ_m of the direction of stress, by which it reaches the cone.
    pub(crate) premises: [Quantity; 4],
}

impl Form {
    /// With a = μs̃ + Kκ̂ and b = μs̃ + Kκ (principal values; s̃ deviator by τ̄, K bulk modulus), the acoustic tensor of a wave
    /// normal ν in the principal axes is Γ = μ + (λ + μ)ννᵀ − (aν)(bν)ᵀ/h. By the determinant of a rank-one change,
    /// det Γ/(μ²(λ + 2μ)) h = h − Σaᵢbᵢxᵢ/μ + (λ + μ)(Σaᵢxᵢ)(Σbᵢxᵢ)/(μ(λ + 2μ)) with xᵢ = νᵢ² and Σxᵢ = 1.
    pub(crate) fn new(numbers: &Numbers) -> Result<Self, Problem> {
        let (lambda, mu) = (numbers.value("model.lambda")?, numbers.value("model.mu")?);
        let friction = numbers.value("yield.friction")?;
        let dilatancy = numbers.value("yield.dilatancy")?;
        let hardening = numbers.value("yield.hardening")?;
        let whole = Polynomial::whole;
        // Principal stresses (q, −q, σ₃₃), as enclosures of numbers.
        let q = numbers.enclosure("stress.deviatoric_stress")?;
        let third = numbers.enclosure("stress.out_of_plane_stress")?;
        // The deviator is (q − σ₃₃/3, −q − σ₃₃/3, 2σ₃₃/3), and τ̄² = q² + σ₃₃²/3.
        let (one, three) = (Interval::whole(1), Interval::whole(3));
        let mean = &third / &three;
        let root = (&q.square() + &(&third.square() / &three)).sqrt();
        let shear = root.filter(Interval::is_positive).ok_or(Problem::UNSIGNED_STRESS)?;
        let deviator = [&q - &mean, &-&q - &mean, &mean + &mean];
        let direction = deviator.map(|own| Polynomial::constant(&own / &shear));
        let pressure = Polynomial::constant(&mean / &shear);
        let bulk = &lambda + &(&mu * &Polynomial::constant(&(&one + &one) / &three));
        let longitudinal = &(&lambda + &mu) + &mu;
        let h = &(&hardening + &mu) + &(&bulk * &(&friction * &dilatancy));
        let values =
            |slope: &Polynomial| direction.each_ref().map(|own| &(&mu * own) + &(&bulk * slope));
        let (a, b) = (values(&dilatancy), values(&friction));
        // Both by 2μ(λ + 2μ).
        let divisor = &(&whole(2) * &mu) * &longitudinal;
        let sum = &lambda + &mu;
        let entry = |i: usize, j: usize| {
            let own = &(&a[i] * &b[i]) + &(&a[j] * &b[j]);
            let mixed = &(&a[i] * &b[j]) + &(&a[j] * &b[i]);
            &(&(&h * &divisor) - &(&longitudinal * &own)) + &(&sum * &mixed)
        };
        let entries = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        let reach = &whole(1) + &(&friction * &pressure);
        let premises = [h, sum, mu, reach].map(|own| Quantity::new(own, whole(1)));
        Ok(Self { entries, divisor, premises })
    }

    /// The bilinear form xᵀAy.
    fn value(&self, x: &[BigRational; 3], y: &[BigRational; 3]) -> Polynomial {
        let mut sum = Polynomial::whole(0);
        for (row, x) in self.entries.iter().zip(x) {
            for (entry, y) in row.iter().zip(y) {
                let weight = Polynomial::constant(Interval::Exact(x * y));
                sum = &sum + &(&weight * entry);
            }
        }
        sum
    }

    /// The form at a point of the triangle xᵢ ≥ 0.
    pub(crate) fn at(&self, point: &[BigRational; 3]) -> Quantity {
        Quantity::new(self.value(point, point), self.divisor.clone())
    }

    /// Whether the form is positive on the whole triangle xᵢ ≥ 0, Σxᵢ = 1: on each part with vertices v it is, if all vᵢᵀAvⱼ are
    /// positive; else the longest edge is halved (Bundfuss & Dür 2008, Linear Algebra Appl. 428, 1511–1523).
    pub(crate) fn is_positive(&self) -> bool {
        let unit = |i: usize| {
            std::array::from_fn(|j| BigRational::from_integer(BigInt::from(i32::from(i == j))))
        };
        let mut open: Vec<[[BigRational; 3]; 3]> = vec![[unit(0), unit(1), unit(2)]];
        let mut count = 0;
        while let Some(vertices) = open.pop() {
            count += 1;
            let is_vertex_positive = vertices.iter().all(|v| self.value(v, v).is_positive());
            if count > MAX_TRIANGLE_COUNT || !is_vertex_positive {
                return false;
            }
            let pairs = [(0, 1), (0, 2), (1, 2)];
            if pairs.iter().all(|&(i, j)| self.value(&vertices[i], &vertices[j]).is_positive()) {
                continue;
            }
            let length = |&(i, j): &(usize, usize)| {
                let squares = (0..3).map(|k| {
                    let difference = &vertices[i][k] - &vertices[j][k];
                    &difference * &difference
                });
                squares.sum::<BigRational>()
            };
            let longest = pairs.into_iter().max_by(|a, b| length(a).cmp(&length(b)));
            let (i, j) = longest.unwrap_or((0, 1));
            let half = BigRational::new(1.into(), 2.into());
            let middle: [BigRational; 3] =
                std::array::from_fn(|k| (&vertices[i][k] + &vertices[j][k]) * &half);
            for replaced in [i, j] {
                let mut own = vertices.clone();
                own[replaced] = middle.clone();
                open.push(own);
            }
        }
        true
    }

    /// At u = v = 0 the quantities of Hadeler (1983), by name, whose signs tell whether the form is positive; `None` if one
    /// does not exist.
    pub(crate) fn copositivity(&self) -> Option<[(&'static str, Interval); 7]> {
        let entry = |i: usize, j: usize| {
            Quantity::new(self.entries[i][j].clone(), self.divisor.clone()).at_origin()
        };
        let diagonal = [entry(0, 0)?, entry(1, 1)?, entry(2, 2)?];
        let [r1, r2, r3] = [diagonal[0].sqrt()?, diagonal[1].sqrt()?, diagonal[2].sqrt()?];
        let [a12, a13, a23] = [entry(0, 1)?, entry(0, 2)?, entry(1, 2)?];
        let [e12, e13, e23] = [&a12 + &(&r1 * &r2), &a13 + &(&r1 * &r3), &a23 + &(&r2 * &r3)];
        let product = &(&(&Interval::whole(2) * &e12) * &e13) * &e23;
        let terms = [&(&r1 * &r2) * &r3, &a12 * &r3, &a13 * &r2, &a23 * &r1, product.sqrt()?];
        let sum = terms.iter().fold(Interval::zero(), |sum, own| &sum + own);
        let [a11, a22, a33] = diagonal;
        Some([
            ("a11", a11),
            ("a22", a22),
            ("a33", a33),
            ("a12 + √(a11 a22)", e12),
            ("a13 + √(a11 a33)", e13),
            ("a23 + √(a22 a33)", e23),
            ("√(a11 a22 a33) + a12 √a33 + a13 √a22 + a23 √a11 + √(2 e12 e13 e23)", sum),
        ])
    }
}
