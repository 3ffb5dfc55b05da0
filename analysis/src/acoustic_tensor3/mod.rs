//! Acoustic tensor of a yielding solid in space over all directions of the wave normal: flutter and shear bands.
//!
//! One active yield condition with normal n, flow direction m and plastic modulus H changes the elastic stiffness D by
//! a matrix of rank one, `D − a bᵀ` with `a = D m/(H + n·Dm)` and `b = D n` (Rudnicki & Rice 1975; Rice 1976). With the
//! diagonal inertia matrix M and the gradient operators Gⁱ of the rate equations, waves with the unit wave normal ν
//! have the speeds c given by
//!
//! ```text
//! c² ∈ spectrum of Γ(ν) = Γₑ(ν) − α(ν) β(ν)ᵀ,   Γₑ = M^(−½) G(ν)ᵀ D G(ν) M^(−½),
//! α = M^(−½) G(ν)ᵀ a,   β = M^(−½) G(ν)ᵀ b,   G(ν) = Σ νᵢ Gⁱ.
//! ```
//!
//! Γₑ is symmetric. In its eigenbasis, with equal eigenvalues grouped as λ_g, an eigenvalue of multiplicity k of Γₑ
//! remains an eigenvalue of Γ k − 1 times; the other eigenvalues λ of Γ solve the secular equation
//!
//! ```text
//! 1 = Σ w_g/(λ_g − λ),   w_g = Σ (α·e)(β·e) over the unit eigenvectors e of λ_g.
//! ```
//!
//! Consider the signs +, sign w₁, sign w₂, …, − in the order of ascending λ_g. If two successive signs are equal, the
//! secular equation has a root in the interval between the two poles (below the first or above the last pole for the
//! added signs); hence with a single change of sign all eigenvalues are real. **Flutter requires a negative weight on a
//! slower wave and a positive weight on a faster wave.** Under associated flow all w_g ≥ 0. An isotropic classical
//! solid whose m and n differ by an isotropic tensor only (Drucker–Prager) has w ≥ 0 on the shear waves, which are the
//! slower ones: no flutter either (Loret, Prevost & Harireche 1990).
//!
//! Forms over the sphere with a certificate decide isotropic solids in which m and n differ by an isotropic tensor, except
//! where flutter occurs or is near (`deviatoric_associativity.rs`, `secular_form.rs`). Else a search decides, limited to
//! the directions that the forms leave open. The search starts on a geodesic grid ([`AcousticTensor3::COVERING_RADIUS`]), on which the eigenbases of Γₑ are
//! computed once per anisotropic elastic solid, and ends with Newton's method in the tangent plane. Short waves grow
//! as Re ς ≈ |Im c| k.
//!
//! Sources: J. W. Rudnicki & J. R. Rice, J. Mech. Phys. Solids 23 (1975) 371–394; J. R. Rice, The
//! localization of plastic deformation, 14th IUTAM Congress (1976); B. Loret, J. H. Prevost &
//! O. Harireche, Eur. J. Mech. A 9 (1990) 225–231; G. H. Golub, SIAM Review 15 (1973) 318–334.

mod certified_extremes;
mod deviatoric_associativity;
mod eigenbasis;
mod elastic_waves;
mod error;
mod extremes;
mod geodesic_grid;
mod isotropic_waves;
mod minimise;
mod rank_one;
mod search;
mod secular_equation;
mod secular_form;
mod secular_roots;
mod speeds;
mod tensor_update;
mod unit_vectors;
mod wave_grid;

pub use certified_extremes::ExtremesMethod;
pub use elastic_waves::AcousticTensor3;
pub use error::NormalSearchError;
pub use extremes::{Flutter, SlowestSpeed, WaveExtremes};
pub use rank_one::RankOneUpdate;
pub use search::NormalSearchWorkspace;
