//! A law with its parameters as numbers: energy, stress and tangent at any deformation gradient.
//!
//! For checks, curves and tests: it evaluates the law's expressions one by one in plain `f64`. Simulations compile
//! programs instead.

use crate::{Kinematics, Law};
use souple_symbols::{Expr, Graph, Matrix, Time};

/// A 3 × 3 tensor, [row][column].
pub type Tensor = [[f64; 3]; 3];

/// The 3 × 3 identity.
pub const IDENTITY: Tensor = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A law with numbers for its parameters.
#[derive(Clone, Debug)]
pub struct Response {
    graph: Graph,
    /// The nine entries of ∇u, row by row.
    variables: Vec<Expr>,
    parameters: Vec<(Expr, f64)>,
    energy: Expr,
    stress: Vec<Expr>,
    /// [row of the upper triangle of the 9 × 9 matrix].
    tangent: Vec<Expr>,
}

/// As [`Energy`](crate::Energy), for as long as it is looked at.
pub type EnergyRef<'e> = &'e (dyn Fn(&mut Kinematics<'_>) -> Expr + 'e);

/// The parameters do not fit the law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("law `{law}` takes {} parameters ({}), found {found}", expected.len(), expected.join(", "))]
pub struct WrongParameterCount {
    /// Id of the law.
    pub law: &'static str,
    /// Names of its parameters, in order.
    pub expected: Vec<&'static str>,
    /// Number of values.
    pub found: usize,
}

impl Response {
    /// The law with `parameters` in its declared order, in SI units. Ranges are not checked: see
    /// [`Parameter::accepts`](crate::Parameter::accepts).
    pub fn new(law: &Law, parameters: &[f64]) -> Result<Response, WrongParameterCount> {
        if parameters.len() != law.parameters.len() {
            let expected = law.parameters.iter().map(|p| p.name).collect();
            return Err(WrongParameterCount { law: law.id, expected, found: parameters.len() });
        }
        let named = law.parameters.iter().map(|p| p.name.to_owned()).zip(parameters.iter().copied());
        Ok(Response::from_energy(law.energy, &named.collect::<Vec<_>>()))
    }

    /// An energy with the parameters (name, value) that it asks for.
    pub fn from_energy(energy: EnergyRef<'_>, parameters: &[(String, f64)]) -> Response {
        let mut graph = Graph::new();
        let g = &mut graph;
        let variables: Vec<Expr> = (0..9).map(|k| g.symbol(format!("H{}{}", k / 3, k % 3), Time::Step)).collect();
        let named: Vec<(String, Expr)> =
            parameters.iter().map(|p| (p.0.clone(), g.symbol(p.0.as_str(), Time::Setup))).collect();
        let values = named.iter().zip(parameters).map(|(symbol, given)| (symbol.1, given.1)).collect();
        let gradient = Matrix::from_fn(3, |i, j| variables[3 * i + j]);
        let energy = energy(&mut Kinematics::new(g, gradient, named));
        let stress = g.gradient(energy, &variables);
        let one = g.int(1);
        let mut tangent = Vec::with_capacity(45);
        for (k, &variable) in variables.iter().enumerate() {
            tangent.extend(g.directional(&stress[k..], &[(variable, one)]));
        }
        Response { graph, variables, parameters: values, energy, stress, tangent }
    }

    /// Energy density ψ in J/m³ at the deformation gradient `f`.
    pub fn energy(&self, f: &Tensor) -> f64 {
        self.evaluate(&[self.energy], f)[0]
    }

    /// First Piola–Kirchhoff stress P = ∂ψ/∂F in Pa at the deformation gradient `f`.
    pub fn stress(&self, f: &Tensor) -> Tensor {
        let values = self.evaluate(&self.stress, f);
        tensor_from_fn(|i, j| values[3 * i + j])
    }

    /// Tangent ∂P_ij/∂F_kl in Pa at the deformation gradient `f`, [3 i + j][3 k + l]; symmetric by construction.
    pub fn tangent(&self, f: &Tensor) -> [[f64; 9]; 9] {
        let values = self.evaluate(&self.tangent, f);
        let mut tangent = [[0.0; 9]; 9];
        let pairs = (0..9).flat_map(|row| (row..9).map(move |column| (row, column)));
        for ((row, column), value) in pairs.zip(values) {
            tangent[row][column] = value;
            tangent[column][row] = value;
        }
        tangent
    }

    fn evaluate(&self, roots: &[Expr], f: &Tensor) -> Vec<f64> {
        let gradient = (0..9).map(|k| f[k / 3][k % 3] - IDENTITY[k / 3][k % 3]);
        let mut symbols = self.parameters.clone();
        symbols.extend(self.variables.iter().copied().zip(gradient));
        self.graph.evaluate(roots, &symbols)
    }
}

/// A tensor from its entries.
pub fn tensor_from_fn(entry: impl Fn(usize, usize) -> f64) -> Tensor {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// `A B`.
pub fn product(a: &Tensor, b: &Tensor) -> Tensor {
    tensor_from_fn(|i, j| (0..3).map(|k| a[i][k] * b[k][j]).sum())
}

/// `Aᵀ`.
pub fn transpose(a: &Tensor) -> Tensor {
    tensor_from_fn(|i, j| a[j][i])
}

/// `det A`.
pub fn determinant(a: &Tensor) -> f64 {
    let cofactor = |j: usize| {
        let (c, d) = ((j + 1) % 3, (j + 2) % 3);
        a[1][c] * a[2][d] - a[1][d] * a[2][c]
    };
    (0..3).map(|j| a[0][j] * cofactor(j)).sum()
}
