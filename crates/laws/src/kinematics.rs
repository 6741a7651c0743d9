//! What an energy may be written in: measures of the deformation at one point, and the law's parameters.
//!
//! The displacement gradient is always 3 × 3. In lower dimensions the missing entries are zero, so that a plane
//! problem is one of plane strain and nothing in a law depends on the dimension.
//!
//! On a surface or a line in space there is no displacement gradient, only the strain in a frame of tangents and the
//! stretch across it ([`TangentStrain`]). A law cannot tell the difference as long as it does not ask for F.

use souple_symbols::{Expr, Graph, Matrix, Number};

/// The deformation at one point, and the parameters of a law.
pub struct Kinematics<'g> {
    /// The graph in which everything is built.
    pub graph: &'g mut Graph,
    deformation: Deformation,
    parameters: Vec<(String, Expr)>,
}

/// The deformation of a surface or a line in space, in an orthonormal frame at rest whose first axes are tangent to it.
#[expect(non_snake_case, reason = "docs/notation.md: E and J keep their usual names")]
#[derive(Clone, Debug)]
pub struct TangentStrain {
    /// Green–Lagrange strain, 3 × 3; nothing but the diagonal across the tangents.
    pub E: Matrix,
    /// Small strain likewise.
    pub epsilon: Matrix,
    /// Volume ratio, the stretches across the tangents included.
    pub J: Expr,
    /// The tangents in space, unit vectors, [tangent][axis]; one or two.
    pub tangents: Vec<[Expr; 3]>,
}

enum Deformation {
    /// Displacement gradient ∂u_i/∂X_j, 3 × 3.
    Gradient(Matrix),
    Tangent {
        strain: TangentStrain,
        /// Whether somebody asked for what is not there.
        gradient_missed: bool,
    },
}

#[expect(non_snake_case, reason = "docs/notation.md: F, C, E, J and the invariants keep their usual names")]
impl<'g> Kinematics<'g> {
    /// Measures of `displacement_gradient` (3 × 3) with named parameters.
    pub fn new(graph: &'g mut Graph, displacement_gradient: Matrix, parameters: Vec<(String, Expr)>) -> Kinematics<'g> {
        assert_eq!(displacement_gradient.dimension(), 3, "plane problems pass zeros");
        Kinematics { graph, deformation: Deformation::Gradient(displacement_gradient), parameters }
    }

    /// Measures of a surface or a line in space, with named parameters.
    pub fn in_tangent_frame(
        graph: &'g mut Graph,
        strain: TangentStrain,
        parameters: Vec<(String, Expr)>,
    ) -> Kinematics<'g> {
        Kinematics { graph, deformation: Deformation::Tangent { strain, gradient_missed: false }, parameters }
    }

    /// Whether F was asked for in a tangent frame, which does not know it: what was built since means nothing.
    pub fn gradient_missed(&self) -> bool {
        matches!(self.deformation, Deformation::Tangent { gradient_missed: true, .. })
    }

    /// A parameter by name.
    ///
    /// # Panics
    /// When the law did not declare it.
    pub fn parameter(&self, name: &str) -> Expr {
        let found = self.parameters.iter().find(|p| p.0 == name);
        found.unwrap_or_else(|| panic!("the law does not declare the parameter `{name}`")).1
    }

    /// Lamé's first constant λ = Eν/((1+ν)(1−2ν)) from `young` and `poisson`.
    pub fn lambda(&mut self) -> Expr {
        let (young, poisson) = (self.parameter("young"), self.parameter("poisson"));
        let one = self.graph.int(1);
        let stretch = self.graph.add(one, poisson);
        let squeeze = self.graph.linear(&[(Number::ONE, one), (Number::Rational(-2, 1), poisson)]);
        let value = self.graph.scaled_powers(Number::ONE, &[(young, 1), (poisson, 1), (stretch, -1), (squeeze, -1)]);
        self.graph.named("lambda", value)
    }

    /// Shear modulus μ = E/(2(1+ν)) from `young` and `poisson`.
    pub fn mu(&mut self) -> Expr {
        let (young, poisson) = (self.parameter("young"), self.parameter("poisson"));
        let one = self.graph.int(1);
        let stretch = self.graph.add(one, poisson);
        let value = self.graph.scaled_powers(Number::rational(1, 2), &[(young, 1), (stretch, -1)]);
        self.graph.named("mu", value)
    }

    /// Deformation gradient F = I + ∇u.
    ///
    /// In a tangent frame it is not known: see [`Kinematics::gradient_missed`].
    pub fn F(&mut self) -> Matrix {
        let identity = Matrix::identity(self.graph, 3);
        match &mut self.deformation {
            Deformation::Gradient(gradient) => identity.add(self.graph, gradient),
            Deformation::Tangent { gradient_missed, .. } => {
                *gradient_missed = true;
                identity
            }
        }
    }

    /// Right Cauchy–Green tensor C = FᵀF.
    pub fn C(&mut self) -> Matrix {
        if let Deformation::Tangent { strain, .. } = &self.deformation {
            let doubled = strain.E.scale(self.graph, Number::Rational(2, 1));
            let identity = Matrix::identity(self.graph, 3);
            return identity.add(self.graph, &doubled);
        }
        let f = self.F();
        f.transpose().matmul(self.graph, &f)
    }

    /// Green–Lagrange strain E = (C − I)/2.
    pub fn E(&mut self) -> Matrix {
        if let Deformation::Tangent { strain, .. } = &self.deformation {
            return strain.E.clone();
        }
        let identity = Matrix::identity(self.graph, 3);
        let difference = self.C().sub(self.graph, &identity);
        difference.scale(self.graph, Number::rational(1, 2))
    }

    /// Small strain ε = (∇u + ∇uᵀ)/2.
    pub fn epsilon(&mut self) -> Matrix {
        let h = match &self.deformation {
            Deformation::Gradient(gradient) => gradient,
            Deformation::Tangent { strain, .. } => return strain.epsilon.clone(),
        };
        let doubled = h.add(self.graph, &h.transpose());
        doubled.scale(self.graph, Number::rational(1, 2))
    }

    /// Volume ratio J = det F.
    pub fn J(&mut self) -> Expr {
        if let Deformation::Tangent { strain, .. } = &self.deformation {
            return strain.J;
        }
        let f = self.F();
        f.determinant(self.graph)
    }

    /// First invariant I₁ = tr C.
    pub fn I1(&mut self) -> Expr {
        let c = self.C();
        c.trace(self.graph)
    }

    /// Second invariant I₂ = ½(I₁² − tr C²).
    pub fn I2(&mut self) -> Expr {
        let c = self.C();
        let trace = c.trace(self.graph);
        let squared = self.graph.powi(trace, 2);
        let quadratic = c.dot(self.graph, &c);
        let half = Number::rational(1, 2);
        self.graph.linear(&[(half, squared), (-half, quadratic)])
    }

    /// Third invariant I₃ = det C = J².
    pub fn I3(&mut self) -> Expr {
        let j = self.J();
        self.graph.powi(j, 2)
    }

    /// Isochoric first invariant Ī₁ = J^(−2/3) I₁; for J > 0 only.
    pub fn I1bar(&mut self) -> Expr {
        let (j, i1) = (self.J(), self.I1());
        let exponent = self.graph.rational(-2, 3);
        let scale = self.graph.pow(j, exponent);
        // The name keeps powers of it powers of one number, and readers see what a law is written in.
        let value = self.graph.mul(scale, i1);
        self.graph.named("I1bar", value)
    }

    /// Isochoric second invariant Ī₂ = J^(−4/3) I₂; for J > 0 only.
    pub fn I2bar(&mut self) -> Expr {
        let (j, i2) = (self.J(), self.I2());
        let exponent = self.graph.rational(-2, 3);
        // The square of the power that Ī₁ has: one power for both.
        let scale = self.graph.pow(j, exponent);
        let value = self.graph.scaled_powers(Number::ONE, &[(scale, 2), (i2, 1)]);
        self.graph.named("I2bar", value)
    }

    /// Isochoric right Cauchy–Green tensor C̄ = J^(−2/3) C, of determinant one; for J > 0 only.
    pub fn Cbar(&mut self) -> Matrix {
        let (j, c) = (self.J(), self.C());
        let exponent = self.graph.rational(-2, 3);
        let scale = self.graph.pow(j, exponent);
        c.times(self.graph, scale)
    }

    /// Volumetric energy κ/2 (J − 1)² from `bulk`.
    pub fn volumetric(&mut self) -> Expr {
        let (bulk, j) = (self.parameter("bulk"), self.J());
        let one = self.graph.int(1);
        let change = self.graph.sub(j, one);
        self.graph.scaled_powers(Number::rational(1, 2), &[(bulk, 1), (change, 2)])
    }

    /// The vector given by the parameters `name_x`, `name_y`, `name_z`; in a tangent frame its components along the
    /// tangents, and nothing across.
    pub fn vector(&mut self, name: &str) -> [Expr; 3] {
        let given = ["x", "y", "z"].map(|axis| self.parameter(&format!("{name}_{axis}")));
        let Deformation::Tangent { strain, .. } = &self.deformation else { return given };
        let mut along = [self.graph.int(0); 3];
        for (component, tangent) in along.iter_mut().zip(&strain.tangents) {
            let products: Vec<Expr> = tangent.iter().zip(given).map(|(&t, x)| self.graph.mul(t, x)).collect();
            *component = self.graph.sum(&products);
        }
        along
    }

    /// The direction given by the parameters `name_x`, `name_y`, `name_z`, made a unit vector; in a tangent frame what
    /// is left of it along the tangents, made one.
    pub fn unit_vector(&mut self, name: &str) -> [Expr; 3] {
        let given = self.vector(name);
        let squares = given.map(|component| self.graph.powi(component, 2));
        let squared = self.graph.sum(&squares);
        let length = self.graph.sqrt(squared);
        given.map(|component| self.graph.div(component, length))
    }

    /// `a·M a` of a symmetric matrix.
    pub fn quadratic_form(graph: &mut Graph, matrix: &Matrix, a: &[Expr; 3]) -> Expr {
        let image = matrix.apply(graph, a);
        let terms: Vec<Expr> = a.iter().zip(image).map(|(&x, y)| graph.mul(x, y)).collect();
        graph.sum(&terms)
    }
}
