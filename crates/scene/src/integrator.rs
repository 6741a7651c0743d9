//! `[integrator]`: how positions and velocities advance by one step.

use serde::Serialize;

use crate::choice::{Named, choices};
use crate::dimension::Dimension;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

choices! {
    /// A time integrator, or the quasi-static sequence of equilibria.
    pub enum Method {
        /// Explicit Euler; first order, unstable without damping, for comparison only.
        ExplicitEuler = "explicit-euler",
        /// Velocities first, then positions with the new velocities; explicit.
        SymplecticEuler = "symplectic-euler",
        /// Runge–Kutta of second order (midpoint); explicit.
        Rk2 = "rk2",
        /// Runge–Kutta of fourth order; explicit.
        Rk4 = "rk4",
        /// Implicit Euler: stable with large steps, dissipates.
        ImplicitEuler = "implicit-euler",
        /// Implicit midpoint: second order, conserves energy well.
        ImplicitMidpoint = "implicit-midpoint",
        /// Backward differences over two steps: second order, dissipates little.
        Bdf2 = "bdf2",
        /// Newmark with `newmark.beta` and `newmark.gamma`.
        Newmark = "newmark",
        /// A sequence of equilibria without inertia; time only drives loads and moved regions.
        QuasiStatic = "quasi-static",
    }
}

choices! {
    /// The derivative of the forces that implicit and quasi-static steps use.
    pub enum Tangent {
        /// The derivative itself: few Newton iterations, but the matrix may have negative curvature.
        Exact = "exact",
        /// Made positive at every quadrature point: more iterations, which always lead downhill.
        Projected = "projected",
    }
}

impl Method {
    /// Whether a step needs no solution of a system, and so has a critical step size.
    pub fn is_explicit(self) -> bool {
        matches!(self, Method::ExplicitEuler | Method::SymplecticEuler | Method::Rk2 | Method::Rk4)
    }
}

/// How positions and velocities advance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Integrator {
    /// The method (default implicit Euler).
    pub method: Spanned<Method>,
    /// Largest number of Newton iterations per step (per load step when quasi-static); default 1, or 50 when quasi-static.
    ///
    /// 1 means linearised once per step.
    pub newton_iterations: u32,
    /// Newton has converged when the residual is this fraction of the first one (default 1e-6).
    pub newton_tolerance: f64,
    /// The derivative of the forces that is used (default exact).
    pub tangent: Tangent,
    /// Shorten Newton's step until the residual decreases (default true).
    pub line_search: bool,
    /// Quasi-static: equal parts in which each step's loads and motions are applied (default 1).
    pub load_steps: u32,
    /// Damping of velocities by exp(−d h) per step, d in 1/s (default 0).
    pub velocity_damping: f64,
    /// Rayleigh damping (default none).
    pub rayleigh: Rayleigh,
    /// Parameters of Newmark's method (default average acceleration).
    pub newmark: Newmark,
    /// Go on with an explicit step larger than the critical one (default false).
    pub allow_unstable_step: bool,
}

/// Damping matrix `D = mass · M + stiffness · K`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Rayleigh {
    /// Coefficient of the mass matrix (1/s).
    pub mass: f64,
    /// Coefficient of the stiffness matrix (s).
    pub stiffness: f64,
}

/// Newmark's β and γ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Newmark {
    /// Share of the new acceleration in the displacement.
    pub beta: f64,
    /// Share of the new acceleration in the velocity.
    pub gamma: f64,
}

impl Default for Newmark {
    /// Average acceleration: second order, no dissipation.
    fn default() -> Self {
        Newmark { beta: 0.25, gamma: 0.5 }
    }
}

impl Integrator {
    /// A method with the defaults of its other values.
    pub fn with_method(method: Method) -> Self {
        Integrator {
            method: Spanned::default_value(method),
            newton_iterations: if method == Method::QuasiStatic { 50 } else { 1 },
            newton_tolerance: 1e-6,
            tangent: Tangent::Exact,
            line_search: true,
            load_steps: 1,
            velocity_damping: 0.0,
            rayleigh: Rayleigh::default(),
            newmark: Newmark::default(),
            allow_unstable_step: false,
        }
    }
}

impl Default for Integrator {
    fn default() -> Self {
        Integrator::with_method(Method::ImplicitEuler)
    }
}

pub(crate) static INTEGRATOR: Section = Section {
    header: "[integrator]",
    about: "how positions and velocities advance by one step",
    keys: &[
        Key {
            name: "method",
            kind: Kind::Choice(Method::CHOICES),
            presence: Presence::Default("\"implicit-euler\""),
            about: "the method",
        },
        Key {
            name: "newton_iterations",
            kind: Kind::Whole(1, 10_000),
            presence: Presence::Default("1"),
            about: "largest number of Newton iterations per step; 1 linearises once per step; default 50 when quasi-static",
        },
        Key {
            name: "newton_tolerance",
            kind: Kind::Number(Dimension::NUMBER, Range::INSIDE_UNIT),
            presence: Presence::Default("1e-6"),
            about: "Newton has converged when the residual is this fraction of the first one",
        },
        Key {
            name: "tangent",
            kind: Kind::Choice(Tangent::CHOICES),
            presence: Presence::Default("\"exact\""),
            about: "the derivative of the forces that Newton and implicit steps use",
        },
        Key {
            name: "line_search",
            kind: Kind::Boolean,
            presence: Presence::Default("true"),
            about: "shorten Newton's step until the residual decreases",
        },
        Key {
            name: "load_steps",
            kind: Kind::Whole(1, 1_000_000),
            presence: Presence::Default("1"),
            about: "quasi-static only: equal parts in which each step's loads and motions are applied",
        },
        Key {
            name: "velocity_damping",
            kind: Kind::Number(Dimension::RATE, Range::NOT_NEGATIVE),
            presence: Presence::Default("0.0"),
            about: "velocities are multiplied by exp(−d h) in each step of size h",
        },
        Key {
            name: "rayleigh",
            kind: Kind::Table(&RAYLEIGH),
            presence: Presence::Optional("no Rayleigh damping"),
            about: "Rayleigh damping",
        },
        Key {
            name: "newmark",
            kind: Kind::Table(&NEWMARK),
            presence: Presence::Optional("average acceleration"),
            about: "parameters of `newmark`",
        },
        Key {
            name: "allow_unstable_step",
            kind: Kind::Boolean,
            presence: Presence::Default("false"),
            about: "explicit methods only: go on with a step larger than the critical one instead of refusing it",
        },
    ],
    other_keys: None,
};

static RAYLEIGH: Section = Section {
    header: "[integrator.rayleigh]",
    about: "damping matrix D = mass · M + stiffness · K",
    keys: &[
        Key {
            name: "mass",
            kind: Kind::Number(Dimension::RATE, Range::NOT_NEGATIVE),
            presence: Presence::Default("0.0"),
            about: "coefficient of the mass matrix",
        },
        Key {
            name: "stiffness",
            kind: Kind::Number(Dimension::TIME, Range::NOT_NEGATIVE),
            presence: Presence::Default("0.0"),
            about: "coefficient of the stiffness matrix",
        },
    ],
    other_keys: None,
};

static NEWMARK: Section = Section {
    header: "[integrator.newmark]",
    about: "parameters of `newmark`: u₁ = u + h v + h² ((½ − β) a + β a₁), v₁ = v + h ((1 − γ) a + γ a₁)",
    keys: &[
        Key {
            name: "beta",
            kind: Kind::Number(Dimension::NUMBER, Range::closed(0.0, 0.5)),
            presence: Presence::Default("0.25"),
            about: "β",
        },
        Key {
            name: "gamma",
            kind: Kind::Number(Dimension::NUMBER, Range::closed(0.0, 1.0)),
            presence: Presence::Default("0.5"),
            about: "γ",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn integrator(&mut self, fields: &Fields<'_>) -> Integrator {
        let method = self.choice::<Method>(fields, "method");
        let mut result = Integrator::with_method(method.as_ref().map_or(Method::ImplicitEuler, |method| method.value));
        if let Some(method) = method {
            result.method = method;
        }
        if let Some(value) = self.whole(fields, "newton_iterations") {
            result.newton_iterations = value.value;
        }
        if let Some(value) = self.number(fields, "newton_tolerance") {
            result.newton_tolerance = value.value;
        }
        if let Some(value) = self.choice(fields, "tangent") {
            result.tangent = value.value;
        }
        if let Some(value) = self.boolean(fields, "line_search") {
            result.line_search = value.value;
        }
        if let Some(value) = self.whole(fields, "load_steps") {
            result.load_steps = value.value;
        }
        if let Some(value) = self.number(fields, "velocity_damping") {
            result.velocity_damping = value.value;
        }
        if let Some(rayleigh) = self.table(fields, "rayleigh") {
            result.rayleigh.mass = self.number(&rayleigh, "mass").map_or(0.0, |value| value.value);
            result.rayleigh.stiffness = self.number(&rayleigh, "stiffness").map_or(0.0, |value| value.value);
        }
        if let Some(newmark) = self.table(fields, "newmark") {
            let default = Newmark::default();
            result.newmark.beta = self.number(&newmark, "beta").map_or(default.beta, |value| value.value);
            result.newmark.gamma = self.number(&newmark, "gamma").map_or(default.gamma, |value| value.value);
        }
        if let Some(value) = self.boolean(fields, "allow_unstable_step") {
            result.allow_unstable_step = value.value;
        }
        self.warn_of_idle_keys(fields, &result);
        result
    }

    /// Keys that the chosen method ignores are allowed, so that `--set integrator.method=…` alone can compare methods.
    fn warn_of_idle_keys(&mut self, fields: &Fields<'_>, integrator: &Integrator) {
        let method = integrator.method.value;
        let statics = method == Method::QuasiStatic;
        let idle: &[(&str, bool)] = &[
            ("newton_iterations", method.is_explicit()),
            ("newton_tolerance", method.is_explicit()),
            ("tangent", method.is_explicit()),
            ("line_search", method.is_explicit()),
            ("load_steps", !statics),
            ("velocity_damping", statics),
            ("rayleigh", statics),
            ("newmark", method != Method::Newmark),
            ("allow_unstable_step", !method.is_explicit()),
        ];
        for (name, is_idle) in idle {
            if let Some(at) = fields.key_at(name).filter(|_| *is_idle) {
                self.warn(at.clone(), format!("`{name}` has no effect with method \"{method}\""));
            }
        }
    }
}
