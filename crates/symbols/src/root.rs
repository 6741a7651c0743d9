//! Roots of equations: a number that an expression defines only implicitly, as a node that can be evaluated and
//! differentiated.
//!
//! ```text
//! R(s, x) = 0                                      the equation that defines s(x)
//! s₀(x) given,  sₖ₊₁ = sₖ − R(sₖ, x) / R_s(sₖ, x)     what is computed: a fixed number of Newton's steps, written out
//! ∂s/∂x = −R_x(s, x) / R_s(s, x)                    what it is differentiated by: never the steps
//! ```
//!
//! Why the implicit derivative? It is exact at the root, where the derivative of the steps is only as good as they are;
//! it costs one division instead of a chain through every step; and derivatives of it of any order follow by the same
//! rule, because the root stands in it as a node.
//!
//! Where R is linear in s there is nothing to iterate: the root is written in closed form.

use crate::{Expr, Function, Graph};

/// An equation of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RootId(u32);

/// What is zero at a root, written in symbols of its own for the unknown and for what it depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Equation {
    /// The unknown s: a symbol.
    pub unknown: Expr,
    /// Symbols that stand for what s depends on and is differentiated by.
    pub arguments: Vec<Expr>,
    /// R, in these symbols and in leaves that are the same wherever the equation is solved.
    pub residual: Expr,
}

impl Graph {
    /// The root of an equation with `operands` for its arguments, by `steps` of Newton's method from `start`.
    ///
    /// The start is an expression of the operands; how many steps are enough is the caller's to know.
    ///
    /// # Panics
    /// When the operands are not as many as the arguments.
    pub fn root(&mut self, equation: &Equation, operands: &[Expr], start: Expr, steps: usize) -> Expr {
        assert_eq!(operands.len(), equation.arguments.len(), "every argument has an operand");
        let Equation { unknown, ref arguments, residual } = *equation;
        let slope = self.derivative(residual, unknown);
        let mut replaced: Vec<(Expr, Expr)> = arguments.iter().copied().zip(operands.iter().copied()).collect();
        let linear = !self.reachable(&[slope]).contains(&unknown);
        let from = if linear { self.int(0) } else { start };
        replaced.push((unknown, from));
        let mut value = from;
        for _ in 0..if linear { 1 } else { steps } {
            replaced.last_mut().expect("the unknown was put last").1 = value;
            let here = self.substitute(&[residual, slope], &replaced);
            let step = self.div(here[0], here[1]);
            value = self.sub(value, step);
        }
        if linear {
            return value;
        }
        let known = self.equations.iter().position(|other| other == equation);
        let id = known.unwrap_or_else(|| {
            self.equations.push(equation.clone());
            self.equations.len() - 1
        });
        let id = RootId(u32::try_from(id).expect("a graph has less than 2³² equations"));
        let all: Vec<Expr> = std::iter::once(value).chain(operands.iter().copied()).collect();
        self.function(Function::Root(id), &all)
    }

    /// The operands of a root `e` after its value, with −R_x / R_s.
    pub(crate) fn root_partials(&mut self, e: Expr, id: RootId, operands: &[Expr]) -> Vec<(Expr, Expr)> {
        let Equation { unknown, arguments, residual } = self.equations[id.0 as usize].clone();
        let by: Vec<Expr> = std::iter::once(unknown).chain(arguments.iter().copied()).collect();
        let gradient = self.gradient(residual, &by);
        let mut replaced: Vec<(Expr, Expr)> = arguments.into_iter().zip(operands.iter().copied()).collect();
        replaced.push((unknown, e));
        let here = self.substitute(&gradient, &replaced);
        let partials: Vec<Expr> = here[1..].iter().map(|&slope| self.div(slope, here[0])).collect();
        operands.iter().copied().zip(partials).map(|(operand, partial)| (operand, self.neg(partial))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Time;

    /// The root of s e^s = x y against its definition, and its first and second derivatives against the closed ones:
    /// s′ = s / (z (1 + s)) for z = x y, and s″ = −s² (s + 2) / (z² (1 + s)³).
    #[test]
    fn a_root_and_its_derivatives_are_exact() {
        let mut g = Graph::new();
        let [x, y, s, z] = ["x", "y", "s", "z"].map(|name| g.symbol(name, Time::Step));
        let exponential = g.exp(s);
        let left = g.mul(s, exponential);
        let residual = g.sub(left, z);
        let product = g.mul(x, y);
        let start = g.real(0.5);
        let equation = Equation { unknown: s, arguments: vec![z], residual };
        let root = g.root(&equation, &[product], start, 12);
        assert_eq!(root, g.root(&equation, &[product], start, 12), "equal roots are one node");
        let first = g.gradient(root, &[x, y]);
        let second = g.derivative(first[0], x);
        let twice = g.named("doubled", root);
        let doubled = g.add(twice, root);
        for (vx, vy) in [(0.3, 1.0), (2.0, 0.7), (1.0, 5.0)] {
            let at = [(x, vx), (y, vy)];
            let value = g.evaluate(&[root], &at)[0];
            let z = vx * vy;
            assert!((value * value.exp() - z).abs() < 1e-14 * z, "{value}");
            assert_eq!(g.evaluate(&[doubled], &at)[0], 2.0 * value);
            let slope = value / (z * (1.0 + value));
            let found = g.evaluate(&first, &at);
            assert!((found[0] - slope * vy).abs() < 1e-13 && (found[1] - slope * vx).abs() < 1e-13, "{found:?}");
            let curve = -value * value * (value + 2.0) / (z * z * (1.0 + value).powi(3));
            let found = g.evaluate(&[second], &at)[0];
            assert!((found - curve * vy * vy).abs() < 1e-12, "{found}");
        }
    }

    /// The derivative is that of the equation even where the steps are too few to reach the root.
    #[test]
    fn the_steps_are_not_differentiated() {
        let mut g = Graph::new();
        let [x, s] = ["x", "s"].map(|name| g.symbol(name, Time::Step));
        let square = g.powi(s, 2);
        let residual = g.sub(square, x);
        let start = g.int(3);
        let root = g.root(&Equation { unknown: s, arguments: vec![x], residual }, &[x], start, 1);
        let slope = g.derivative(root, x);
        let value = g.evaluate(&[root, slope], &[(x, 4.0)]);
        assert_eq!(value[0], 3.0 - 5.0 / 6.0);
        assert!((value[1] - 0.5 / value[0]).abs() < 1e-15, "{value:?}");
    }

    /// An equation that is linear in its unknown is solved exactly, whatever the start, without a root in the graph.
    #[test]
    fn linear_equations_are_solved_in_closed_form() {
        let mut g = Graph::new();
        let [x, s] = ["x", "s"].map(|name| g.symbol(name, Time::Step));
        let product = g.mul(s, x);
        let one = g.int(1);
        let residual = g.sub(product, one);
        let start = g.int(77);
        let root = g.root(&Equation { unknown: s, arguments: vec![x], residual }, &[x], start, 5);
        assert_eq!(root, g.powi(x, -1));
    }
}
