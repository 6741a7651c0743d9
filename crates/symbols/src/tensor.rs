//! Small square matrices of expressions: the tensor algebra that formulas are written in.

use crate::{Expr, Graph, Number};

/// A square matrix of expressions, [row][column], of dimension 1 to 3.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Matrix {
    /// Entries, [row][column].
    pub entries: Vec<Vec<Expr>>,
}

impl Matrix {
    /// A matrix from its entries.
    pub fn from_fn(dimension: usize, mut entry: impl FnMut(usize, usize) -> Expr) -> Matrix {
        Matrix { entries: (0..dimension).map(|i| (0..dimension).map(|j| entry(i, j)).collect()).collect() }
    }

    /// The identity.
    pub fn identity(g: &mut Graph, dimension: usize) -> Matrix {
        let (zero, one) = (g.int(0), g.int(1));
        Matrix::from_fn(dimension, |i, j| if i == j { one } else { zero })
    }

    /// Number of rows.
    pub fn dimension(&self) -> usize {
        self.entries.len()
    }

    /// The entry in row `i`, column `j`.
    pub fn at(&self, i: usize, j: usize) -> Expr {
        self.entries[i][j]
    }

    /// `Aᵀ`.
    pub fn transpose(&self) -> Matrix {
        Matrix::from_fn(self.dimension(), |i, j| self.at(j, i))
    }

    /// `A + B`.
    pub fn add(&self, g: &mut Graph, other: &Matrix) -> Matrix {
        Matrix::from_fn(self.dimension(), |i, j| g.add(self.at(i, j), other.at(i, j)))
    }

    /// `A − B`.
    pub fn sub(&self, g: &mut Graph, other: &Matrix) -> Matrix {
        Matrix::from_fn(self.dimension(), |i, j| g.sub(self.at(i, j), other.at(i, j)))
    }

    /// `c A` for a constant.
    pub fn scale(&self, g: &mut Graph, c: Number) -> Matrix {
        Matrix::from_fn(self.dimension(), |i, j| g.scale(c, self.at(i, j)))
    }

    /// `x A` for an expression.
    pub fn times(&self, g: &mut Graph, x: Expr) -> Matrix {
        Matrix::from_fn(self.dimension(), |i, j| g.mul(x, self.at(i, j)))
    }

    /// `A B`.
    pub fn matmul(&self, g: &mut Graph, other: &Matrix) -> Matrix {
        let n = self.dimension();
        Matrix::from_fn(n, |i, j| {
            let terms: Vec<Expr> = (0..n).map(|k| g.mul(self.at(i, k), other.at(k, j))).collect();
            g.sum(&terms)
        })
    }

    /// `A x`.
    pub fn apply(&self, g: &mut Graph, x: &[Expr]) -> Vec<Expr> {
        self.entries
            .iter()
            .map(|row| {
                let terms: Vec<Expr> = row.iter().zip(x).map(|(&a, &b)| g.mul(a, b)).collect();
                g.sum(&terms)
            })
            .collect()
    }

    /// Trace.
    pub fn trace(&self, g: &mut Graph) -> Expr {
        let diagonal: Vec<Expr> = (0..self.dimension()).map(|i| self.at(i, i)).collect();
        g.sum(&diagonal)
    }

    /// `A : B`, the sum of the products of the entries.
    pub fn dot(&self, g: &mut Graph, other: &Matrix) -> Expr {
        let mut terms = Vec::new();
        for (a, b) in self.entries.iter().flatten().zip(other.entries.iter().flatten()) {
            terms.push(g.mul(*a, *b));
        }
        g.sum(&terms)
    }

    /// Cofactor matrix: `A⁻¹ = cofᵀ / det`.
    pub fn cofactors(&self, g: &mut Graph) -> Matrix {
        match self.dimension() {
            1 => Matrix::identity(g, 1),
            2 => {
                let a = self.clone();
                Matrix::from_fn(2, |i, j| {
                    let minor = a.at(1 - i, 1 - j);
                    if i == j { minor } else { g.neg(minor) }
                })
            }
            3 => Matrix::from_fn(3, |i, j| {
                let (r, s) = ((i + 1) % 3, (i + 2) % 3);
                let (c, d) = ((j + 1) % 3, (j + 2) % 3);
                let plus = g.mul(self.at(r, c), self.at(s, d));
                let minus = g.mul(self.at(r, d), self.at(s, c));
                g.sub(plus, minus)
            }),
            n => panic!("matrices have dimension 1 to 3, not {n}"),
        }
    }

    /// Determinant.
    pub fn determinant(&self, g: &mut Graph) -> Expr {
        let cofactors = self.cofactors(g);
        let terms: Vec<Expr> = (0..self.dimension()).map(|j| g.mul(self.at(0, j), cofactors.at(0, j))).collect();
        g.sum(&terms)
    }

    /// Inverse, from cofactors.
    pub fn inverse(&self, g: &mut Graph) -> Matrix {
        let cofactors = self.cofactors(g);
        let determinant = self.determinant(g);
        Matrix::from_fn(self.dimension(), |i, j| g.div(cofactors.at(j, i), determinant))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Time;

    /// A⁻¹ A = I in every dimension.
    #[test]
    fn inverse_inverts() {
        for n in 1..=3 {
            let mut g = Graph::new();
            let values: Vec<f64> = (0..n * n)
                .map(|k| ((k * k + 3 * k + 1) % 7) as f64 + if k % (n + 1) == 0 { 9.0 } else { 0.0 })
                .collect();
            let a = Matrix::from_fn(n, |i, j| g.symbol(format!("a{i}{j}"), Time::Step));
            let symbols: Vec<(Expr, f64)> = a.entries.iter().flatten().copied().zip(values).collect();
            let inverse = a.inverse(&mut g);
            let product = inverse.matmul(&mut g, &a);
            for i in 0..n {
                for j in 0..n {
                    let value = g.evaluate(&[product.at(i, j)], &symbols)[0];
                    assert!((value - f64::from(u8::from(i == j))).abs() < 1e-14);
                }
            }
        }
    }
}
