//! A formula after reading: a tree that is known to make sense, and the expressions that it stands for.

use crate::Kinematics;
use souple_symbols::{Expr, Graph, Matrix, Number};
use std::fmt;

/// Number, vector or tensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One number.
    Scalar,
    /// Three components.
    Vector,
    /// 3 × 3.
    Tensor,
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Shape::Scalar => "a number",
            Shape::Vector => "a vector",
            Shape::Tensor => "a tensor",
        })
    }
}

/// A measure of deformation that formulas can name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measure {
    F,
    C,
    E,
    Epsilon,
    Identity,
    J,
    I1,
    I2,
    I3,
    I1bar,
    I2bar,
}

/// Name of each measure, and its shape.
pub(super) const MEASURES: [(&str, Measure, Shape); 12] = [
    ("F", Measure::F, Shape::Tensor),
    ("C", Measure::C, Shape::Tensor),
    ("E", Measure::E, Shape::Tensor),
    ("epsilon", Measure::Epsilon, Shape::Tensor),
    ("ε", Measure::Epsilon, Shape::Tensor),
    ("I", Measure::Identity, Shape::Tensor),
    ("J", Measure::J, Shape::Scalar),
    ("I1", Measure::I1, Shape::Scalar),
    ("I2", Measure::I2, Shape::Scalar),
    ("I3", Measure::I3, Shape::Scalar),
    ("I1bar", Measure::I1bar, Shape::Scalar),
    ("I2bar", Measure::I2bar, Shape::Scalar),
];

/// A function that formulas can call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Trace,
    Determinant,
    Dot,
    Transpose,
    Inverse,
    I4,
    Ln,
    Exp,
    Sqrt,
    Pow,
}

/// Name of each function, and what it takes, as a sentence.
pub(super) const FUNCTIONS: [(&str, Function, &str); 10] = [
    ("tr", Function::Trace, "`tr(A)` takes one tensor"),
    ("det", Function::Determinant, "`det(A)` takes one tensor"),
    ("dot", Function::Dot, "`dot(a, b)` takes two vectors or two tensors"),
    ("transpose", Function::Transpose, "`transpose(A)` takes one tensor"),
    ("inverse", Function::Inverse, "`inverse(A)` takes one tensor"),
    ("I4", Function::I4, "`I4(a)` takes one vector, the direction of the fibres"),
    ("ln", Function::Ln, "`ln(x)` takes one number"),
    ("exp", Function::Exp, "`exp(x)` takes one number"),
    ("sqrt", Function::Sqrt, "`sqrt(x)` takes one number"),
    ("pow", Function::Pow, "`pow(x, y)` takes two numbers"),
];

impl Function {
    /// Shape of the result for arguments of these shapes; none if it does not take them.
    pub(super) fn result(self, arguments: &[Shape]) -> Option<Shape> {
        use Shape::{Scalar, Tensor, Vector};
        match (self, arguments) {
            (Function::Trace | Function::Determinant, [Tensor]) => Some(Scalar),
            (Function::Dot, [Vector, Vector] | [Tensor, Tensor]) => Some(Scalar),
            (Function::Transpose | Function::Inverse, [Tensor]) => Some(Tensor),
            (Function::I4, [Vector]) => Some(Scalar),
            (Function::Ln | Function::Exp | Function::Sqrt, [Scalar]) => Some(Scalar),
            (Function::Pow, [Scalar, Scalar]) => Some(Scalar),
            _ => None,
        }
    }
}

/// A formula whose parts have fitting shapes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Formula {
    Number(f64),
    Parameter(String),
    Direction(String),
    Measure(Measure),
    /// Each summand with its sign (true for minus).
    Sum(Vec<(bool, Formula)>),
    /// Each factor, and whether it divides.
    Product(Vec<(bool, Formula)>),
    Component(Box<Formula>, usize),
    Entry(Box<Formula>, usize, usize),
    Call(Function, Vec<Formula>),
}

/// What a formula stands for.
enum Value {
    Scalar(Expr),
    Vector([Expr; 3]),
    Tensor(Matrix),
}

impl Value {
    fn scalar(self) -> Expr {
        let Value::Scalar(e) = self else { unreachable!("shapes were checked when the formula was read") };
        e
    }

    fn vector(self) -> [Expr; 3] {
        let Value::Vector(v) = self else { unreachable!("shapes were checked when the formula was read") };
        v
    }

    fn tensor(self) -> Matrix {
        let Value::Tensor(m) = self else { unreachable!("shapes were checked when the formula was read") };
        m
    }
}

/// The energy density that a formula stands for.
pub(super) fn energy(formula: &Formula, k: &mut Kinematics<'_>) -> Expr {
    value(formula, k).scalar()
}

fn value(formula: &Formula, k: &mut Kinematics<'_>) -> Value {
    match formula {
        Formula::Number(number) => Value::Scalar(k.graph.real(*number)),
        Formula::Parameter(name) => Value::Scalar(k.parameter(name)),
        Formula::Direction(name) => Value::Vector(k.vector(name)),
        Formula::Measure(measure) => measured(*measure, k),
        Formula::Sum(terms) => {
            let values: Vec<(Number, Value)> = terms
                .iter()
                .map(|(minus, term)| (if *minus { Number::MINUS_ONE } else { Number::ONE }, value(term, k)))
                .collect();
            sum(k.graph, values)
        }
        Formula::Product(factors) => {
            let values: Vec<(i32, Value)> =
                factors.iter().map(|(divides, factor)| (if *divides { -1 } else { 1 }, value(factor, k))).collect();
            product(k.graph, values)
        }
        Formula::Component(vector, i) => Value::Scalar(value(vector, k).vector()[*i]),
        Formula::Entry(tensor, i, j) => Value::Scalar(value(tensor, k).tensor().at(*i, *j)),
        Formula::Call(function, arguments) => {
            let values = arguments.iter().map(|argument| value(argument, k)).collect();
            call(*function, values, k)
        }
    }
}

/// Name of the parameter that holds one component of a direction.
pub(super) fn component(direction: &str, axis: &str) -> String {
    format!("{direction}_{axis}")
}

fn measured(measure: Measure, k: &mut Kinematics<'_>) -> Value {
    match measure {
        Measure::F => Value::Tensor(k.F()),
        Measure::C => Value::Tensor(k.C()),
        Measure::E => Value::Tensor(k.E()),
        Measure::Epsilon => Value::Tensor(k.epsilon()),
        Measure::Identity => Value::Tensor(Matrix::identity(k.graph, 3)),
        Measure::J => Value::Scalar(k.J()),
        Measure::I1 => Value::Scalar(k.I1()),
        Measure::I2 => Value::Scalar(k.I2()),
        Measure::I3 => Value::Scalar(k.I3()),
        Measure::I1bar => Value::Scalar(k.I1bar()),
        Measure::I2bar => Value::Scalar(k.I2bar()),
    }
}

fn sum(g: &mut Graph, values: Vec<(Number, Value)>) -> Value {
    let (mut scalars, mut vectors, mut tensors) = (Vec::new(), Vec::new(), Vec::new());
    for (sign, value) in values {
        match value {
            Value::Scalar(e) => scalars.push((sign, e)),
            Value::Vector(v) => vectors.push((sign, v)),
            Value::Tensor(m) => tensors.push((sign, m)),
        }
    }
    if !vectors.is_empty() {
        return Value::Vector(std::array::from_fn(|i| {
            let terms: Vec<(Number, Expr)> = vectors.iter().map(|(sign, v)| (*sign, v[i])).collect();
            g.linear(&terms)
        }));
    }
    if !tensors.is_empty() {
        return Value::Tensor(Matrix::from_fn(3, |i, j| {
            let terms: Vec<(Number, Expr)> = tensors.iter().map(|(sign, m)| (*sign, m.at(i, j))).collect();
            g.linear(&terms)
        }));
    }
    Value::Scalar(g.linear(&scalars))
}

fn product(g: &mut Graph, values: Vec<(i32, Value)>) -> Value {
    let mut scalars = Vec::new();
    let mut rest: Option<Value> = None;
    for (exponent, value) in values {
        rest = match (rest, value) {
            (rest, Value::Scalar(e)) => {
                scalars.push((e, exponent));
                rest
            }
            (None, other) => Some(other),
            (Some(Value::Tensor(a)), Value::Tensor(b)) => Some(Value::Tensor(a.matmul(g, &b))),
            (Some(Value::Tensor(a)), Value::Vector(v)) => Some(Value::Vector(applied(g, &a, &v))),
            _ => unreachable!("shapes were checked when the formula was read"),
        };
    }
    let scalar = g.scaled_powers(Number::ONE, &scalars);
    match rest {
        None => Value::Scalar(scalar),
        Some(Value::Vector(v)) => Value::Vector(v.map(|c| g.mul(scalar, c))),
        Some(Value::Tensor(m)) => Value::Tensor(m.times(g, scalar)),
        Some(Value::Scalar(_)) => unreachable!("scalars are collected apart"),
    }
}

fn applied(g: &mut Graph, a: &Matrix, v: &[Expr; 3]) -> [Expr; 3] {
    let image = a.apply(g, v);
    std::array::from_fn(|i| image[i])
}

fn call(function: Function, arguments: Vec<Value>, k: &mut Kinematics<'_>) -> Value {
    let mut arguments = arguments.into_iter();
    let mut next = || arguments.next().expect("the number of arguments was checked when the formula was read");
    match function {
        Function::Trace => Value::Scalar(next().tensor().trace(k.graph)),
        Function::Determinant => Value::Scalar(next().tensor().determinant(k.graph)),
        Function::Transpose => Value::Tensor(next().tensor().transpose()),
        Function::Inverse => Value::Tensor(next().tensor().inverse(k.graph)),
        Function::Dot => Value::Scalar(match (next(), next()) {
            (Value::Tensor(a), Value::Tensor(b)) => a.dot(k.graph, &b),
            (a, b) => dot(k.graph, &a.vector(), &b.vector()),
        }),
        Function::I4 => {
            let a = next().vector();
            let c = k.C();
            let along = Kinematics::quadratic_form(k.graph, &c, &a);
            let squared = dot(k.graph, &a, &a);
            Value::Scalar(k.graph.div(along, squared))
        }
        Function::Ln => Value::Scalar(k.graph.ln(next().scalar())),
        Function::Exp => Value::Scalar(k.graph.exp(next().scalar())),
        Function::Sqrt => Value::Scalar(k.graph.sqrt(next().scalar())),
        Function::Pow => {
            let (base, exponent) = (next().scalar(), next().scalar());
            Value::Scalar(k.graph.pow(base, exponent))
        }
    }
}

fn dot(g: &mut Graph, a: &[Expr; 3], b: &[Expr; 3]) -> Expr {
    let terms: Vec<Expr> = a.iter().zip(b).map(|(&x, &y)| g.mul(x, y)).collect();
    g.sum(&terms)
}
