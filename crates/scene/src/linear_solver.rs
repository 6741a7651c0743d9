//! `[linear_solver]`: how the system of an implicit step is solved.

use serde::Serialize;

use crate::choice::{Named, choices};
use crate::dimension::Dimension;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

choices! {
    /// A linear solver.
    pub enum LinearMethod {
        /// Conjugate gradients.
        Cg = "cg",
        /// A sparse factorisation; for quasi-static and small problems.
        Direct = "direct",
    }
}

choices! {
    /// A preconditioner of the conjugate gradients.
    pub enum Preconditioner {
        /// None.
        None = "none",
        /// The diagonal.
        Jacobi = "jacobi",
        /// The 3×3 block of each node.
        BlockJacobi = "block-jacobi",
        /// An incomplete factorisation with the matrix's own pattern; needs an assembled operator.
        IncompleteCholesky = "incomplete-cholesky",
    }
}

choices! {
    /// How the matrix is applied.
    pub enum Operator {
        /// The assembled matrix; `souple run --explain` measures both ways.
        Auto = "auto",
        /// Element by element, never stored.
        MatrixFree = "matrix-free",
        /// Assembled once per linearisation into sparse rows of 3×3 blocks.
        Assembled = "assembled",
    }
}

choices! {
    /// What the matrix of a product is kept in.
    pub enum Precision {
        /// Double precision.
        Double = "double",
        /// A copy in single precision, corrected with the true matrix until the tolerance is met.
        Mixed = "mixed",
    }
}

/// How linear systems are solved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinearSolver {
    /// The solver (default conjugate gradients).
    pub method: Spanned<LinearMethod>,
    /// Preconditioner of the conjugate gradients (default block-Jacobi).
    pub preconditioner: Spanned<Preconditioner>,
    /// How the matrix is applied (default auto).
    pub operator: Spanned<Operator>,
    /// What the matrix of a product is kept in (default double).
    pub precision: Spanned<Precision>,
    /// Stop when the residual is this fraction of the right-hand side (default 1e-6).
    pub tolerance: f64,
    /// Stop when the norm of the residual is below this (default 0 N).
    pub absolute_tolerance: f64,
    /// Largest number of iterations (default 1000).
    pub max_iterations: u32,
    /// Start from the last step's solution (default true).
    pub warm_start: bool,
}

impl Default for LinearSolver {
    fn default() -> Self {
        LinearSolver {
            method: Spanned::default_value(LinearMethod::Cg),
            preconditioner: Spanned::default_value(Preconditioner::BlockJacobi),
            operator: Spanned::default_value(Operator::Auto),
            precision: Spanned::default_value(Precision::Double),
            tolerance: 1e-6,
            absolute_tolerance: 0.0,
            max_iterations: 1000,
            warm_start: true,
        }
    }
}

pub(crate) static LINEAR_SOLVER: Section = Section {
    header: "[linear_solver]",
    about: "how the linear system of an implicit or quasi-static step is solved",
    keys: &[
        Key {
            name: "method",
            kind: Kind::Choice(LinearMethod::CHOICES),
            presence: Presence::Default("\"cg\""),
            about: "the solver",
        },
        Key {
            name: "preconditioner",
            kind: Kind::Choice(Preconditioner::CHOICES),
            presence: Presence::Default("\"block-jacobi\""),
            about: "preconditioner of the conjugate gradients",
        },
        Key {
            name: "operator",
            kind: Kind::Choice(Operator::CHOICES),
            presence: Presence::Default("\"auto\""),
            about: "how the matrix is applied",
        },
        Key {
            name: "precision",
            kind: Kind::Choice(Precision::CHOICES),
            presence: Presence::Default("\"double\""),
            about: "what an assembled matrix is kept in for products; results meet the same tolerance",
        },
        Key {
            name: "tolerance",
            kind: Kind::Number(Dimension::NUMBER, Range { maximum: Range::INSIDE_UNIT.maximum, ..Range::NOT_NEGATIVE }),
            presence: Presence::Default("1e-6"),
            about: "stop when the residual is this fraction of the right-hand side",
        },
        Key {
            name: "absolute_tolerance",
            kind: Kind::Number(Dimension::FORCE, Range::NOT_NEGATIVE),
            presence: Presence::Default("0.0"),
            about: "stop when the norm of the residual, as a force, is below this",
        },
        Key {
            name: "max_iterations",
            kind: Kind::Whole(1, u32::MAX),
            presence: Presence::Default("1000"),
            about: "largest number of iterations",
        },
        Key {
            name: "warm_start",
            kind: Kind::Boolean,
            presence: Presence::Default("true"),
            about: "start from the last step's solution",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn linear_solver(&mut self, fields: &Fields<'_>) -> LinearSolver {
        let default = LinearSolver::default();
        let solver = LinearSolver {
            method: self.choice(fields, "method").unwrap_or(default.method),
            preconditioner: self.choice(fields, "preconditioner").unwrap_or(default.preconditioner),
            operator: self.choice(fields, "operator").unwrap_or(default.operator),
            precision: self.choice(fields, "precision").unwrap_or(default.precision),
            tolerance: self.number(fields, "tolerance").map_or(default.tolerance, |value| value.value),
            absolute_tolerance: self
                .number(fields, "absolute_tolerance")
                .map_or(default.absolute_tolerance, |value| value.value),
            max_iterations: self.whole(fields, "max_iterations").map_or(default.max_iterations, |value| value.value),
            warm_start: self.boolean(fields, "warm_start").map_or(default.warm_start, |value| value.value),
        };
        if solver.method.value == LinearMethod::Direct {
            for name in [
                "preconditioner",
                "operator",
                "precision",
                "tolerance",
                "absolute_tolerance",
                "max_iterations",
                "warm_start",
            ] {
                if let Some(at) = fields.key_at(name) {
                    self.warn(at.clone(), format!("`{name}` has no effect with method \"direct\""));
                }
            }
        } else if solver.preconditioner.value == Preconditioner::IncompleteCholesky
            && solver.operator.value == Operator::MatrixFree
        {
            let message = "an incomplete Cholesky factorisation needs the matrix; use operator = \"assembled\" or \
                \"auto\", or preconditioner = \"block-jacobi\"";
            self.conflict(fields.place("preconditioner"), message);
        } else if solver.precision.value == Precision::Mixed && solver.operator.value == Operator::MatrixFree {
            let message = "only a matrix can be kept in single precision; use operator = \"assembled\" or \"auto\", or \
                precision = \"double\"";
            self.conflict(fields.place("precision"), message);
        } else if solver.tolerance == 0.0 && solver.absolute_tolerance == 0.0 {
            let message = "`tolerance` and `absolute_tolerance` are both 0, which is never reached; give one of them";
            self.conflict(fields.place("tolerance"), message);
        }
        solver
    }
}
