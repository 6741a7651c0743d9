//! Expressions as text and as LaTeX.
//!
//! A named node is written as its name. A shared node that is worth a name gets one: [`definitions`] lists them in order, so that a printed formula has the
//! size of the graph and not that of its expansion.

use crate::{Expr, Function, Graph, Node, Number};
use std::collections::HashMap;

/// How to write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Plain text that reads like code.
    Text,
    /// LaTeX mathematics.
    Latex,
}

/// An expression in full, down to its symbols.
pub fn expression(g: &Graph, e: Expr, style: Style) -> String {
    Printer { g, style, names: HashMap::new() }.print(e, 0)
}

/// `name = formula` lines for `roots` (given with their names), with every sub-expression that is used more than once
/// and costs more than one operation named `t0`, `t1`, … before its use.
pub fn definitions(g: &Graph, roots: &[(String, Expr)], style: Style) -> Vec<(String, String)> {
    let targets: Vec<Expr> = roots.iter().map(|r| r.1).collect();
    let order = g.reachable(&targets);
    let mut uses: HashMap<Expr, usize> = HashMap::new();
    for &e in &order {
        for o in g.operands(e) {
            *uses.entry(o).or_default() += 1;
        }
    }
    let mut printer = Printer { g, style, names: HashMap::new() };
    let mut lines = Vec::new();
    for &e in &order {
        if let Node::Named(name, inner) = *g.node(e) {
            lines.push((printer.symbol(g.symbol_name(name)), printer.print(inner, 0)));
            continue;
        }
        let leaf = g.operands(e).is_empty();
        let scaled = matches!(g.node(e), Node::Product(c, f) if !c.is_one() && f.len() == 1 && f[0].1 == 1);
        let named = order.iter().any(|&u| matches!(g.node(u), Node::Named(_, inner) if *inner == e));
        if leaf || scaled || named || uses.get(&e).copied().unwrap_or(0) < 2 || targets.contains(&e) {
            continue;
        }
        let formula = printer.print(e, 0);
        let number = printer.names.len();
        let name = if style == Style::Latex { format!("t_{{{number}}}") } else { format!("t{number}") };
        printer.names.insert(e, name.clone());
        lines.push((name, formula));
    }
    for (name, e) in roots {
        lines.push((name.clone(), printer.print(*e, 0)));
    }
    lines
}

struct Printer<'g> {
    g: &'g Graph,
    style: Style,
    names: HashMap<Expr, String>,
}

impl Printer<'_> {
    /// `level`: 0 anything goes, 1 inside a product, 2 under a power.
    fn print(&self, e: Expr, level: u8) -> String {
        if let Some(name) = self.names.get(&e) {
            return name.clone();
        }
        let (text, binds) = match self.g.node(e) {
            Node::Constant(c) => (self.number(*c), if c.is_negative() { 0 } else { 1 }),
            Node::Symbol(s) | Node::Named(s, _) => (self.symbol(self.g.symbol_name(*s)), 2),
            Node::Table(t) => match self.style {
                Style::Text => (format!("table{t}"), 2),
                Style::Latex => (format!("\\tau_{{{t}}}"), 2),
            },
            Node::Sum(c, terms) => (self.sum(*c, terms), 0),
            Node::Product(c, factors) => (self.product(*c, factors), if c.is_negative() { 0 } else { 1 }),
            Node::Function(f, operands) => (self.function(*f, operands), 2),
            Node::PointSum(o) => match self.style {
                Style::Text => (format!("sum_points({})", self.print(*o, 0)), 2),
                Style::Latex => (format!("\\sum_q {}", self.print(*o, 1)), 0),
            },
        };
        if binds >= level {
            text
        } else if self.style == Style::Latex {
            format!("\\left({text}\\right)")
        } else {
            format!("({text})")
        }
    }

    fn symbol(&self, name: &str) -> String {
        if self.style == Style::Text {
            return name.to_string();
        }
        const GREEK: [&str; 10] = ["lambda", "mu", "kappa", "alpha", "beta", "rho", "xi", "eta", "zeta", "nu"];
        match name.split_once('_') {
            Some((base, index)) => format!("{}_{{{}}}", self.symbol(base), index.replace('_', ",")),
            None if GREEK.contains(&name) => format!("\\{name}"),
            None if name.chars().count() > 1 => format!("\\mathrm{{{name}}}"),
            None => name.to_string(),
        }
    }

    fn number(&self, c: Number) -> String {
        match (self.style, c) {
            (Style::Latex, Number::Rational(n, d)) if d != 1 => {
                format!("{}\\tfrac{{{}}}{{{d}}}", if n < 0 { "-" } else { "" }, n.unsigned_abs())
            }
            _ => c.to_string(),
        }
    }

    fn sum(&self, constant: Number, terms: &[(Number, Expr)]) -> String {
        let mut parts: Vec<(bool, String)> = Vec::new();
        for &(c, e) in terms {
            let text = if c.abs().is_one() {
                self.print(e, 1)
            } else {
                format!("{}{}{}", self.number(c.abs()), self.times(), self.print(e, 1))
            };
            parts.push((c.is_negative(), text));
        }
        if !constant.is_zero() {
            parts.push((constant.is_negative(), self.number(constant.abs())));
        }
        let mut out = String::new();
        for (k, (negative, text)) in parts.into_iter().enumerate() {
            match (k, negative) {
                (0, false) => {}
                (0, true) => out.push('-'),
                (_, false) => out.push_str(" + "),
                (_, true) => out.push_str(" - "),
            }
            out.push_str(&text);
        }
        out
    }

    fn times(&self) -> &'static str {
        match self.style {
            Style::Text => "*",
            Style::Latex => "\\,",
        }
    }

    fn product(&self, c: Number, factors: &[(Expr, i32)]) -> String {
        let power = |&(e, n): &(Expr, i32)| {
            let n = n.unsigned_abs();
            match (self.style, n) {
                (_, 1) => self.print(e, 1),
                (Style::Text, n) => format!("{}^{n}", self.print(e, 2)),
                (Style::Latex, n) => format!("{}^{{{n}}}", self.print(e, 2)),
            }
        };
        let mut over: Vec<String> = factors.iter().filter(|f| f.1 > 0).map(power).collect();
        let under: Vec<String> = factors.iter().filter(|f| f.1 < 0).map(power).collect();
        if !c.abs().is_one() || over.is_empty() {
            over.insert(0, self.number(c.abs()));
        }
        let sign = if c.is_negative() { "-" } else { "" };
        match (self.style, under.len()) {
            (_, 0) => format!("{sign}{}", over.join(self.times())),
            (Style::Latex, _) => {
                format!("{sign}\\frac{{{}}}{{{}}}", over.join(self.times()), under.join(self.times()))
            }
            (Style::Text, 1) => format!("{sign}{}/{}", over.join("*"), under[0]),
            (Style::Text, _) => format!("{sign}{}/({})", over.join("*"), under.join("*")),
        }
    }

    fn function(&self, function: Function, operands: &[Expr]) -> String {
        let list = |operands: &[Expr]| operands.iter().map(|&o| self.print(o, 0)).collect::<Vec<_>>().join(", ");
        let a = self.print(operands[0], 0);
        match (self.style, function) {
            (Style::Text, Function::Sinhc) => format!("sinhc({a})"),
            (Style::Text, Function::Eigenvalue(k)) => format!("eigenvalue{}({})", k + 1, list(operands)),
            (Style::Text, Function::Eigenvector(i, k)) => {
                format!("eigenvector{}{}({})", i + 1, k + 1, list(operands))
            }
            // What they are powers of, and not how they are computed.
            (Style::Text, Function::PowerTrace) => format!("powertrace({})", list(&operands[1..])),
            (Style::Text, Function::PowerEntry(i, j, s)) => {
                format!("powerentry{}{}less{s}({})", i + 1, j + 1, list(&operands[1..]))
            }
            (Style::Latex, Function::Sinhc) => format!("\\mathrm{{sinhc}}\\left({a}\\right)"),
            (Style::Latex, Function::Eigenvalue(k)) => {
                format!("\\lambda_{{{}}}\\left({}\\right)", k + 1, list(operands))
            }
            (Style::Latex, Function::Eigenvector(i, k)) => {
                format!("n_{{{}{}}}\\left({}\\right)", i + 1, k + 1, list(operands))
            }
            (Style::Latex, Function::PowerTrace | Function::PowerEntry(..)) => {
                let matrix: Vec<String> = operands[1..7].iter().map(|&o| self.print(o, 0)).collect();
                let [xx, yy, zz, xy, yz, zx] = &matrix[..] else { unreachable!("six entries were taken") };
                let matrix =
                    format!("\\begin{{pmatrix}}{xx}&{xy}&{zx}\\\\{xy}&{yy}&{yz}\\\\{zx}&{yz}&{zz}\\end{{pmatrix}}");
                let less = if let Function::PowerEntry(_, _, s) = function { s } else { 0 };
                let terms: Vec<String> = operands[7..]
                    .chunks_exact(2)
                    .map(|pair| {
                        let exponent = self.print(pair[1], 0);
                        let exponent = if less == 0 { exponent } else { format!("{exponent} - {less}") };
                        format!("{}\\,{matrix}^{{{exponent}}}", self.print(pair[0], 1))
                    })
                    .collect();
                let sum = format!("\\left({}\\right)", terms.join(" + "));
                match function {
                    Function::PowerEntry(i, j, _) => format!("{sum}_{{{}{}}}", i + 1, j + 1),
                    _ => format!("\\mathrm{{tr}}{sum}"),
                }
            }
            (Style::Text, Function::Sqrt) => format!("sqrt({a})"),
            (Style::Text, Function::Ln) => format!("ln({a})"),
            (Style::Text, Function::Exp) => format!("exp({a})"),
            (Style::Text, Function::RootSum) => {
                format!("rootsum({a}, {}, {})", self.print(operands[1], 0), self.print(operands[2], 0))
            }
            (Style::Latex, Function::RootSum) => {
                let (b, c) = (self.print(operands[1], 0), self.print(operands[2], 0));
                format!("\\sigma_{{\\Sigma}}\\left({a},\\,{b},\\,{c}\\right)")
            }
            // The value is the first operand: the steps that lead to it are what is computed, and are printed in full.
            (_, Function::Root(_)) => a,
            (Style::Text, Function::Pow) => format!("pow({a}, {})", self.print(operands[1], 0)),
            (Style::Latex, Function::Sqrt) => format!("\\sqrt{{{a}}}"),
            (Style::Latex, Function::Ln) => format!("\\ln\\left({a}\\right)"),
            (Style::Latex, Function::Exp) => format!("e^{{{a}}}"),
            (Style::Latex, Function::Pow) => {
                format!("{}^{{{}}}", self.print(operands[0], 2), self.print(operands[1], 0))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Time;

    /// Text and LaTeX of one formula, with signs, powers, fractions and nesting.
    #[test]
    fn formulas_read_well() {
        let mut g = Graph::new();
        let x = g.symbol("x_0", Time::Step);
        let lambda = g.symbol("lambda", Time::Setup);
        let two = g.int(2);
        let s = g.sub(x, two);
        let squared = g.powi(s, 2);
        let p = g.scaled_powers(Number::rational(-1, 2), &[(lambda, 1), (squared, 1), (x, -1)]);
        assert_eq!(expression(&g, p, Style::Text), "-1/2*lambda*(x_0 - 2)^2/x_0");
        assert_eq!(
            expression(&g, p, Style::Latex),
            "-\\frac{\\tfrac{1}{2}\\,\\lambda\\,\\left(x_{0} - 2\\right)^{2}}{x_{0}}"
        );
    }

    /// A shared sub-expression is defined once, before its use.
    #[test]
    fn shared_parts_are_named() {
        let mut g = Graph::new();
        let x = g.symbol("x", Time::Step);
        let y = g.symbol("y", Time::Step);
        let s = g.add(x, y);
        let (a, b) = (g.exp(s), g.ln(s));
        let lines = definitions(&g, &[("a".into(), a), ("b".into(), b)], Style::Text);
        let lines: Vec<String> = lines.into_iter().map(|(n, f)| format!("{n} = {f}")).collect();
        assert_eq!(lines, ["t0 = x + y", "a = exp(t0)", "b = ln(t0)"]);
    }
}
