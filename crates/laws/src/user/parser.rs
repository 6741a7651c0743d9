//! From words to a formula, checking shapes on the way.
//!
//! ```text
//! sum     = ["-" | "+"] product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = ["-"] power
//! power   = primary ["^" signed]
//! primary = number | name | function "(" sum { "," sum } ")" | "(" sum ")", each with ["[" i ["," j] "]"]
//! ```
//!
//! So `-x^2` is −(x²), `2^-1` is ½ and `x^2^3` is x⁸.

use super::error::Problem;
use super::formula::{FUNCTIONS, Formula, Function, MEASURES, Shape};
use super::nearest::nearest;
use super::tokens::Token;

/// Deepest nesting of parentheses, signs and powers.
const DEPTH: usize = 100;
/// Largest exponent that powers inside each other may make.
const EXPONENT: u32 = 1_000_000;
/// An exponent that is a whole number up to this becomes a product; anything else stays a function.
const WHOLE: u32 = 16;
/// What other programs call some functions.
const ALIASES: [(&str, &str); 4] = [("log", "ln"), ("trace", "tr"), ("inv", "inverse"), ("determinant", "det")];

/// A formula with what must be known to put it into a larger one.
struct Part {
    formula: Formula,
    shape: Shape,
    /// An upper limit of the integer exponents that writing it out gives.
    exponent: u32,
}

/// Reads one formula.
pub(super) struct Parser<'p> {
    pub(super) tokens: Vec<(Token, usize)>,
    pub(super) at: usize,
    pub(super) depth: usize,
    /// Parameters: name, and shape.
    pub(super) parameters: &'p [(String, Shape)],
    /// Which of them were read.
    pub(super) used: Vec<bool>,
}

/// Column and problem.
type Failure = (usize, Problem);

impl Parser<'_> {
    /// The formula of a number, to the last word.
    pub(super) fn energy(&mut self) -> Result<Formula, Failure> {
        if *self.peek() == Token::End {
            return Err((self.column(), Problem::Empty));
        }
        let column = self.column();
        let whole = self.sum()?;
        if *self.peek() != Token::End {
            let expected = "an operator such as `+` or `*`, or the end of the energy";
            return Err(self.expected(expected));
        }
        if whole.shape != Shape::Scalar {
            return Err((column, Problem::NotScalar { found: whole.shape }));
        }
        Ok(whole.formula)
    }

    fn peek(&self) -> &Token {
        &self.tokens[self.at].0
    }

    fn column(&self) -> usize {
        self.tokens[self.at].1
    }

    /// Goes past a sign if it is the next word.
    fn takes(&mut self, sign: char) -> bool {
        let found = *self.peek() == Token::Sign(sign);
        // The last word is the end, which is no sign.
        self.at += usize::from(found);
        found
    }

    fn expected(&self, expected: &str) -> Failure {
        (self.column(), Problem::Expected { expected: expected.to_owned(), found: self.peek().shown() })
    }

    fn sum(&mut self) -> Result<Part, Failure> {
        self.nested(|parser| {
            let mut minus = parser.takes('-');
            if !minus {
                parser.takes('+');
            }
            let first = parser.product()?;
            let (shape, mut exponent) = (first.shape, first.exponent);
            let mut terms = vec![(minus, first.formula)];
            loop {
                let column = parser.column();
                minus = parser.takes('-');
                if !minus && !parser.takes('+') {
                    break;
                }
                let next = parser.product()?;
                if next.shape != shape {
                    let operation = if minus { "the difference" } else { "the sum" };
                    let hint = match (shape, next.shape) {
                        (Shape::Tensor, Shape::Scalar) | (Shape::Scalar, Shape::Tensor) => "; `I` is the unit tensor",
                        _ => "",
                    };
                    return Err((column, Problem::Operation { operation, left: shape, right: next.shape, hint }));
                }
                exponent = exponent.max(next.exponent);
                terms.push((minus, next.formula));
            }
            let formula = match <[_; 1]>::try_from(terms) {
                Ok([(false, only)]) => only,
                Ok([only]) => Formula::Sum(vec![only]),
                Err(terms) => Formula::Sum(terms),
            };
            Ok(Part { formula, shape, exponent })
        })
    }

    fn product(&mut self) -> Result<Part, Failure> {
        let first = self.signed()?;
        let (mut shape, mut exponent) = (first.shape, first.exponent);
        let mut factors = vec![(false, first.formula)];
        loop {
            let column = self.column();
            let divides = self.takes('/');
            if !divides && !self.takes('*') {
                break;
            }
            let next = self.signed()?;
            shape = product_shape(shape, next.shape, divides).map_err(|problem| (column, problem))?;
            exponent = limited(exponent.saturating_add(next.exponent), column)?;
            factors.push((divides, next.formula));
        }
        let formula = match <[_; 1]>::try_from(factors) {
            Ok([(_, only)]) => only,
            Err(factors) => Formula::Product(factors),
        };
        Ok(Part { formula, shape, exponent })
    }

    fn signed(&mut self) -> Result<Part, Failure> {
        if !self.takes('-') {
            return self.power();
        }
        let part = self.nested(Self::signed)?;
        Ok(Part { formula: Formula::Sum(vec![(true, part.formula)]), ..part })
    }

    fn power(&mut self) -> Result<Part, Failure> {
        let base = self.primary()?;
        let column = self.column();
        if !self.takes('^') {
            return Ok(base);
        }
        let exponent = self.nested(Self::signed)?;
        if base.shape != Shape::Scalar || exponent.shape != Shape::Scalar {
            let hint = if base.shape == Shape::Tensor { "; write `C*C` for the square of a tensor" } else { "" };
            let problem = Problem::Operation { operation: "the power", left: base.shape, right: exponent.shape, hint };
            return Err((column, problem));
        }
        let limit = limited(base.exponent.saturating_mul(WHOLE), column)?;
        let formula = Formula::Call(Function::Pow, vec![base.formula, exponent.formula]);
        Ok(Part { formula, shape: Shape::Scalar, exponent: limit })
    }

    fn primary(&mut self) -> Result<Part, Failure> {
        let column = self.column();
        let mut part = match self.peek().clone() {
            Token::Number(value) => {
                self.at += 1;
                Part { formula: Formula::Number(value), shape: Shape::Scalar, exponent: 1 }
            }
            Token::Name(name) => {
                self.at += 1;
                if self.takes('(') { self.call(&name, column)? } else { self.name(&name, column)? }
            }
            Token::Sign('(') => {
                self.at += 1;
                let inner = self.sum()?;
                self.close(')', "`)` or an operator")?;
                inner
            }
            _ => return Err(self.expected("a number, a name, a function or `(`")),
        };
        while *self.peek() == Token::Sign('[') {
            part = self.indexed(part)?;
        }
        Ok(part)
    }

    fn close(&mut self, sign: char, expected: &str) -> Result<(), Failure> {
        if self.takes(sign) { Ok(()) } else { Err(self.expected(expected)) }
    }

    fn name(&mut self, name: &str, column: usize) -> Result<Part, Failure> {
        if let Some(&(_, measure, shape)) = MEASURES.iter().find(|m| m.0 == name) {
            // I₃ = J² has the largest exponent of all.
            return Ok(Part { formula: Formula::Measure(measure), shape, exponent: 2 });
        }
        if let Some(position) = self.parameters.iter().position(|p| p.0 == name) {
            self.used[position] = true;
            let shape = self.parameters[position].1;
            let owned = name.to_owned();
            let formula = if shape == Shape::Vector { Formula::Direction(owned) } else { Formula::Parameter(owned) };
            return Ok(Part { formula, shape, exponent: 1 });
        }
        if let Some((name, _, usage)) = FUNCTIONS.iter().find(|f| f.0 == name) {
            let usage = usage.split(" takes").next().unwrap_or(usage).to_owned();
            return Err((column, Problem::FunctionAlone { name: (*name).to_owned(), usage }));
        }
        let parameters = self.parameters.iter().map(|p| p.0.as_str());
        let candidates = MEASURES.iter().map(|m| m.0).chain(parameters.clone());
        let listed: Vec<&str> = parameters.collect();
        let measures = "measures are F, C, E, epsilon, I, J, I1, I2, I3, I1bar, I2bar";
        let known = match listed.len() {
            0 => format!("{measures}, and no parameters are given"),
            _ => format!("{measures}, parameters are {}", listed.join(", ")),
        };
        let nearest = nearest(name, candidates).map(str::to_owned);
        Err((column, Problem::UnknownName { found: name.to_owned(), nearest, known }))
    }

    fn call(&mut self, name: &str, column: usize) -> Result<Part, Failure> {
        let Some(&(_, function, usage)) = FUNCTIONS.iter().find(|f| f.0 == name) else {
            return Err((column, self.no_function(name)));
        };
        let mut arguments = Vec::new();
        if !self.takes(')') {
            loop {
                arguments.push(self.sum()?);
                if self.takes(')') {
                    break;
                }
                self.close(',', "`,`, `)` or an operator")?;
            }
        }
        let shapes: Vec<Shape> = arguments.iter().map(|a| a.shape).collect();
        let Some(shape) = function.result(&shapes) else {
            let found: Vec<String> = shapes.iter().map(Shape::to_string).collect();
            let found = if found.is_empty() { "nothing".to_owned() } else { found.join(", ") };
            return Err((column, Problem::Arguments { usage: usage.to_owned(), found }));
        };
        let largest = arguments.iter().map(|a| a.exponent).max().unwrap_or(1);
        let exponent = match function {
            Function::Ln | Function::Exp | Function::Sqrt => 1,
            Function::Trace | Function::Transpose => largest,
            Function::Dot | Function::I4 => largest.saturating_mul(2),
            Function::Determinant => largest.saturating_mul(3),
            Function::Inverse => largest.saturating_mul(5),
            Function::Pow => largest.saturating_mul(WHOLE),
        };
        let exponent = limited(exponent, column)?;
        Ok(Part {
            formula: Formula::Call(function, arguments.into_iter().map(|a| a.formula).collect()),
            shape,
            exponent,
        })
    }

    fn no_function(&self, name: &str) -> Problem {
        let is_value = MEASURES.iter().any(|m| m.0 == name) || self.parameters.iter().any(|p| p.0 == name);
        if is_value {
            let expected = format!("an operator after `{name}`, such as `*`");
            return Problem::Expected { expected, found: "`(`".to_owned() };
        }
        let aliases = ALIASES.iter().map(|a| a.0);
        let usual = nearest(name, FUNCTIONS.iter().map(|f| f.0).chain(aliases));
        let usual = usual.map(|found| ALIASES.iter().find(|a| a.0 == found).map_or(found, |a| a.1));
        let known: Vec<&str> = FUNCTIONS.iter().map(|f| f.0).collect();
        Problem::UnknownFunction { found: name.to_owned(), nearest: usual.map(str::to_owned), known: known.join(", ") }
    }

    /// `[i]` of a vector or `[i, j]` of a tensor, counted from 1.
    fn indexed(&mut self, part: Part) -> Result<Part, Failure> {
        let column = self.column();
        self.at += 1;
        let mut indices = Vec::new();
        loop {
            match self.peek() {
                Token::Number(value) if [1.0, 2.0, 3.0].contains(value) => indices.push(*value as usize - 1),
                other => {
                    let expected = "an index is 1, 2 or 3";
                    return Err((self.column(), Problem::Index { expected, found: other.shown() }));
                }
            }
            self.at += 1;
            if self.takes(']') {
                break;
            }
            self.close(',', "`,` or `]`")?;
        }
        let formula = Box::new(part.formula);
        let formula = match (part.shape, &indices[..]) {
            (Shape::Vector, &[i]) => Formula::Component(formula, i),
            (Shape::Tensor, &[i, j]) => Formula::Entry(formula, i, j),
            (shape, _) => {
                let expected = match shape {
                    Shape::Scalar => "a number has no indices",
                    Shape::Vector => "a vector has one index, such as `a[1]`",
                    Shape::Tensor => "a tensor has two indices, such as `F[1, 2]`",
                };
                return Err((column, Problem::Index { expected, found: format!("{} of them", indices.len()) }));
            }
        };
        Ok(Part { formula, shape: Shape::Scalar, exponent: part.exponent })
    }

    /// One level deeper, as long as there are levels.
    fn nested(&mut self, read: impl FnOnce(&mut Self) -> Result<Part, Failure>) -> Result<Part, Failure> {
        if self.depth == DEPTH {
            return Err((self.column(), Problem::TooDeep { limit: DEPTH }));
        }
        self.depth += 1;
        let part = read(self);
        self.depth -= 1;
        part
    }
}

fn product_shape(left: Shape, right: Shape, divides: bool) -> Result<Shape, Problem> {
    if divides {
        return match right {
            Shape::Scalar => Ok(left),
            _ => Err(Problem::Operation { operation: "the quotient", left, right, hint: "; multiply by `inverse(A)`" }),
        };
    }
    match (left, right) {
        (Shape::Scalar, other) | (other, Shape::Scalar) => Ok(other),
        (Shape::Tensor, other) => Ok(other),
        (Shape::Vector, _) => {
            let hint =
                if right == Shape::Vector { "; the scalar product is `dot(a, b)`" } else { "; write `transpose(A)*a`" };
            Err(Problem::Operation { operation: "the product", left, right, hint })
        }
    }
}

fn limited(exponent: u32, column: usize) -> Result<u32, Failure> {
    if exponent > EXPONENT { Err((column, Problem::Exponent { limit: EXPONENT })) } else { Ok(exponent) }
}
