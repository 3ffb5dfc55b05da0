//! Flutter and shear bands of a yielding solid in space, over all directions of the wave normal.
//!
//! One active yield condition changes the elastic stiffness D by a matrix of rank one, `D − a bᵀ` with
//! `a = D m/(H + n·Dm)` and `b = D n` (Rudnicki & Rice 1975; Rice 1976). Waves with the unit normal n
//! have the speeds c given by
//!
//! ```text
//! c² ∈ spectrum of Γ(n) = Γₑ(n) − α(n) β(n)ᵀ,   Γₑ = M^(−½) G(n)ᵀ D G(n) M^(−½),
//! α = M^(−½) G(n)ᵀ a,   β = M^(−½) G(n)ᵀ b,   G(n) = Σ nᵢ Gⁱ.
//! ```
//!
//! Γₑ is symmetric. In its eigenbasis, with equal eigenvalues grouped as λ_g, an eigenvalue of multiplicity m remains
//! an eigenvalue m − 1 times; the other eigenvalues solve the secular equation
//!
//! ```text
//! 1 = Σ w_g/(λ_g − λ),   w_g = the part of α·β that lies in the eigenspace of λ_g.
//! ```
//!
//! List the signs of the w_g in the order of the λ_g, preceded by + and followed by −. Between two equal signs next to
//! each other the two sides of the equation cross at least once, so that with a single change of sign all eigenvalues
//! are real. **Flutter requires a negative weight on a slower wave and a positive weight on a faster wave.** Under
//! associated flow all w_g ≥ 0. An isotropic classical solid whose m and n differ by an isotropic tensor only
//! (Drucker–Prager) has w ≥ 0 on the shear waves, which are the slower ones: no flutter either (Loret, Prevost &
//! Harireche 1990).
//!
//! The search starts on a geodesic grid ([`AcousticTensor3::COVERING_RADIUS`]), on which the eigenbases of Γₑ are
//! computed once per elastic solid, and ends with Newton's method in the tangent plane. Short waves grow
//! as Re ς ≈ |Im c| k.
//!
//! Sources: J. W. Rudnicki & J. R. Rice, J. Mech. Phys. Solids 23 (1975) 371–394; J. R. Rice, The
//! localization of plastic deformation, 14th IUTAM Congress (1976); B. Loret, J. H. Prevost &
//! O. Harireche, Eur. J. Mech. A 9 (1990) 225–231; G. H. Golub, SIAM Review 15 (1973) 318–334.

mod eigenbasis;
mod elastic_waves;
mod error;
mod extremes;
mod geodesic_grid;
mod minimise;
mod rank_one;
mod search;
mod secular_equation;
mod secular_roots;
mod speeds;
mod tensor_update;
mod unit_vectors;

pub use elastic_waves::AcousticTensor3;
pub use error::NormalSearchError;
pub use extremes::{Flutter, SlowestSpeed, WaveExtremes};
pub use rank_one::RankOneUpdate;
pub use search::NormalSearchWorkspace;
