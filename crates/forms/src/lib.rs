//! Where an element meets a law: the definitions of energy, force, tangent and mass of an association
//! (element × law × quadrature), as expressions.
//!
//! The whole definition is a few lines of mathematics:
//!
//! ```text
//! H = Σ_a u_a ⊗ ∇N_a                      displacement gradient at a quadrature point
//! W(u) = Σ_q w_q det(∂X/∂ξ) ψ(H)          energy
//! f = −∂W/∂u                              force
//! df = (∂f/∂u) v                          tangent product
//! K_ab = −∂f_a/∂u_b                       tangent blocks
//! m_a = Σ_q w_q det(∂X/∂ξ) ρ N_a          mass and consistent load per unit of acceleration
//! ```
//!
//! Everything else follows by differentiation here, and by staging in `souple-program`. Written apart, because few
//! simulations want them: what an element shows of its stress and strain ([`averages()`]), viscosity
//! ([`dissipation()`]), and tangents with moduli changed from outside ([`moduli()`]).

mod averages;
mod definition;
mod dissipation;
mod moduli;
mod plane_stress;
mod tangent_frame;

pub use averages::{Averages, SYMMETRIC, averages};
pub use definition::{Definition, Embedding, Loops, define};
pub use dissipation::{Dissipation, dissipation};
pub use moduli::{Moduli, moduli};
