//! The time integration methods: their names, orders and parameters.
//!
//! What each computes is in the private modules `explicit` and `implicit`.

use std::str::FromStr;

/// A way to advance M ü = F(t, u, u̇) by one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// u₁ = u₀ + h v₀, v₁ = v₀ + h a₀. Needs damping to be stable at all.
    ExplicitEuler,
    /// v₁ = v₀ + h a₀, u₁ = u₀ + h v₁. Also called semi-implicit or modified Euler; the energy stays bounded.
    SymplecticEuler,
    /// Explicit midpoint rule.
    Rk2,
    /// Classical Runge–Kutta method of order four.
    Rk4,
    /// v₁ = v₀ + h a₁, u₁ = u₀ + h v₁. Damps.
    ImplicitEuler,
    /// Implicit midpoint rule; conserves quadratic energies.
    ImplicitMidpoint,
    /// Backward differences over two steps, of any two lengths.
    Bdf2,
    /// Newmark's family.
    Newmark {
        /// Weight β of the new acceleration in the displacement.
        beta: f64,
        /// Weight γ of the new acceleration in the velocity.
        gamma: f64,
    },
}

/// Why a method cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MethodError {
    /// No method has that name.
    #[error("no integration method is called '{name}'; there are {}", names())]
    UnknownName {
        /// The name asked for.
        name: String,
    },
    /// Newmark's parameters make every step unstable, or are not numbers.
    #[error("Newmark's parameters must have gamma >= 1/2 and 0 <= beta <= 1, but gamma is {gamma} and beta is {beta}")]
    Newmark {
        /// β
        beta: f64,
        /// γ
        gamma: f64,
    },
}

fn names() -> String {
    Method::ALL.map(|method| method.name()).join(", ")
}

impl Method {
    /// Newmark's method without numerical damping: β = ¼, γ = ½, the average acceleration.
    pub const AVERAGE_ACCELERATION: Self = Self::Newmark { beta: 0.25, gamma: 0.5 };

    /// Every method, Newmark's family by its average acceleration member.
    pub const ALL: [Self; 8] = [
        Self::ExplicitEuler,
        Self::SymplecticEuler,
        Self::Rk2,
        Self::Rk4,
        Self::ImplicitEuler,
        Self::ImplicitMidpoint,
        Self::Bdf2,
        Self::AVERAGE_ACCELERATION,
    ];

    /// The name by which a scene or a command asks for it.
    pub fn name(&self) -> &'static str {
        match self {
            Self::ExplicitEuler => "explicit-euler",
            Self::SymplecticEuler => "symplectic-euler",
            Self::Rk2 => "rk2",
            Self::Rk4 => "rk4",
            Self::ImplicitEuler => "implicit-euler",
            Self::ImplicitMidpoint => "implicit-midpoint",
            Self::Bdf2 => "bdf2",
            Self::Newmark { .. } => "newmark",
        }
    }

    /// Order of convergence of displacement and velocity on smooth problems.
    pub fn order(&self) -> usize {
        match *self {
            Self::ExplicitEuler | Self::SymplecticEuler | Self::ImplicitEuler => 1,
            Self::Rk2 | Self::ImplicitMidpoint | Self::Bdf2 => 2,
            Self::Newmark { gamma, .. } => {
                if gamma == 0.5 {
                    2
                } else {
                    1
                }
            }
            Self::Rk4 => 4,
        }
    }

    /// Whether a step needs forces only, and no linear system with K and D.
    pub fn is_explicit(&self) -> bool {
        matches!(self, Self::ExplicitEuler | Self::SymplecticEuler | Self::Rk2 | Self::Rk4)
    }

    /// Refuses parameters with which no step would be stable.
    ///
    /// # Errors
    /// [`MethodError::Newmark`].
    pub fn validate(&self) -> Result<(), MethodError> {
        match *self {
            Self::Newmark { beta, gamma } if !(gamma >= 0.5 && gamma.is_finite() && (0.0..=1.0).contains(&beta)) => {
                Err(MethodError::Newmark { beta, gamma })
            }
            _ => Ok(()),
        }
    }
}

impl FromStr for Method {
    type Err = MethodError;

    fn from_str(name: &str) -> Result<Self, MethodError> {
        Self::ALL
            .into_iter()
            .find(|method| method.name() == name)
            .ok_or_else(|| MethodError::UnknownName { name: name.to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every method is found by its own name, and an unknown name is answered with the list.
    #[test]
    fn names_round_trip() {
        for method in Method::ALL {
            assert_eq!(method.name().parse(), Ok(method));
        }
        let message = "leapfrog".parse::<Method>().expect_err("no such method").to_string();
        assert!(Method::ALL.iter().all(|method| message.contains(method.name())), "{message}");
    }

    /// Newmark's parameters outside the stable quadrant are refused.
    #[test]
    fn newmark_is_validated() {
        assert!(Method::AVERAGE_ACCELERATION.validate().is_ok());
        assert!(Method::Newmark { beta: 0.0, gamma: 0.5 }.validate().is_ok());
        for (beta, gamma) in [(0.25, 0.4), (-0.1, 0.5), (f64::NAN, 0.5), (0.25, f64::NAN)] {
            assert!(Method::Newmark { beta, gamma }.validate().is_err(), "beta {beta}, gamma {gamma}");
        }
    }
}
