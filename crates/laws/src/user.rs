//! Laws that are written as text: an energy density of the deformation and of named parameters.
//!
//! `c1*(I1bar - 3) + c2*(I1bar - 3)^2 + k/2*(J - 1)^2`
//!
//! | kind | what may be written |
//! |---|---|
//! | numbers | `2`, `0.5`, `1e-3` |
//! | tensors | `F`, `C`, `E`, `epsilon` (or `ε`), `I` (the unit tensor); entries `F[1, 2]`, counted from 1 |
//! | invariants | `J`, `I1`, `I2`, `I3`, `I1bar`, `I2bar` |
//! | parameters | numbers `mu`; directions `a` with components `a[1]` |
//! | operators | `+`, `-`, `*` (of tensors: the matrix product; of a tensor and a vector: its image), `/`, `^` |
//! | functions | `tr`, `det`, `dot`, `transpose`, `inverse`, `ln`, `exp`, `sqrt`, `pow` |
//! | fibres | `I4(a)` = a·C a / a·a: the squared stretch along `a`, whatever its length |
//!
//! Measures mean what [`Kinematics`] says. Every shape is checked while reading; what is left to check is whether
//! the energy makes a good law: see [`crate::check`].

mod error;
mod formula;
mod nearest;
mod parser;
mod tokens;

pub use error::{Problem, UserLawError};
pub use formula::Shape;

use crate::response::Response;
use crate::{Bound, Kinematics, Law, Parameter, check};
use formula::{FUNCTIONS, Formula, MEASURES, component};
use std::sync::Arc;

/// Most characters of an energy.
const LENGTH: usize = 10_000;

/// The value of a parameter of a user law, in the units that the formula expects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// A number.
    Number(f64),
    /// A vector of any length but zero, such as the direction of fibres.
    Direction([f64; 3]),
}

/// A law read from text, with its parameters.
#[derive(Clone, Debug)]
pub struct UserLaw {
    /// The text.
    pub text: String,
    /// Parameters in the order of the program: a direction `a` is the three numbers `a_x`, `a_y`, `a_z`.
    pub parameters: Vec<(String, f64)>,
    formula: Arc<Formula>,
}

impl UserLaw {
    /// Reads an energy density with the parameters (name, value) that it is given.
    ///
    /// # Errors
    /// The first thing that is wrong, with its place in the text.
    pub fn parse(text: &str, parameters: &[(&str, ParameterValue)]) -> Result<UserLaw, UserLawError> {
        let error = |column: Option<usize>, problem| UserLawError { text: text.to_owned(), column, problem };
        if text.chars().count() > LENGTH {
            return Err(error(None, Problem::TooLong { limit: LENGTH }));
        }
        let numbers = numbers(parameters).map_err(|problem| error(None, problem))?;
        let shapes: Vec<(String, Shape)> = parameters
            .iter()
            .map(|(name, value)| {
                let shape = match value {
                    ParameterValue::Number(_) => Shape::Scalar,
                    ParameterValue::Direction(_) => Shape::Vector,
                };
                ((*name).to_owned(), shape)
            })
            .collect();
        let tokens = tokens::tokens(text).map_err(|(column, problem)| error(Some(column), problem))?;
        let used = vec![false; shapes.len()];
        let mut parser = parser::Parser { tokens, at: 0, depth: 0, parameters: &shapes, used };
        let formula = parser.energy().map_err(|(column, problem)| error(Some(column), problem))?;
        if let Some(unused) = parser.used.iter().position(|used| !used) {
            return Err(error(None, Problem::UnusedParameter { name: shapes[unused].0.clone() }));
        }
        Ok(UserLaw { text: text.to_owned(), parameters: numbers, formula: Arc::new(formula) })
    }

    /// The law with the values of its parameters, for evaluation.
    pub fn response(&self) -> Response {
        let energy = |k: &mut Kinematics<'_>| formula::energy(&self.formula, k);
        Response::from_energy(&energy, &self.parameters)
    }

    /// Values of the parameters in the law's order.
    pub fn values(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.1).collect()
    }

    /// The law as those of the registry are, to be used wherever they are.
    ///
    /// Laws live as long as the program, and so does this one: each call keeps a few hundred bytes for good. Call it
    /// once per law that is simulated, not per law that is looked at.
    /// Its id is made from the text and the names, so that equal energies have equal ids and different ones do not.
    pub fn into_law(self) -> &'static Law {
        let objective = check::rotation_error(&self.response()) <= check::OBJECTIVE;
        let id = format!("user-{:016x}", fingerprint(&self));
        let parameters: Vec<Parameter> = self.parameters.iter().map(|(name, _)| parameter(name)).collect();
        let UserLaw { text, formula, .. } = self;
        let energy: &'static crate::Energy =
            Box::leak(Box::new(move |k: &mut Kinematics<'_>| formula::energy(&formula, k)));
        Box::leak(Box::new(Law {
            id: id.leak(),
            name: "User law",
            about: "An energy density written as text.",
            formula: text.leak(),
            references: &[],
            parameters: parameters.leak(),
            objective,
            energy,
        }))
    }
}

fn parameter(name: &str) -> Parameter {
    Parameter {
        name: name.to_owned().leak(),
        unit: "1",
        minimum: Bound::None,
        maximum: Bound::None,
        default: None,
        about: "a parameter of the energy, in the units that it expects",
    }
}

/// FNV-1a of the text and the names of the parameters.
fn fingerprint(law: &UserLaw) -> u64 {
    let names = law.parameters.iter().flat_map(|p| std::iter::once(0).chain(p.0.bytes()));
    law.text
        .bytes()
        .chain(names)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Parameters as numbers, after checking names and values.
fn numbers(parameters: &[(&str, ParameterValue)]) -> Result<Vec<(String, f64)>, Problem> {
    let mut numbers: Vec<(String, f64)> = Vec::new();
    for &(name, value) in parameters {
        let refused = |reason| Problem::ParameterName { name: name.to_owned(), reason };
        let mut characters = name.chars();
        let starts = characters.next().is_some_and(|c| c.is_alphabetic() || c == '_');
        if !starts || !characters.all(tokens::is_letter_or_digit) {
            return Err(refused("a name is letters, digits and `_`, and starts with a letter"));
        }
        if MEASURES.iter().any(|m| m.0 == name) {
            return Err(refused("it is a measure of deformation in every energy"));
        }
        if FUNCTIONS.iter().any(|f| f.0 == name) {
            return Err(refused("it is a function in every energy"));
        }
        if parameters.iter().filter(|p| p.0 == name).count() > 1 {
            return Err(refused("it is given twice"));
        }
        let wrong = |expected, found| Problem::ParameterValue { name: name.to_owned(), expected, found };
        match value {
            ParameterValue::Number(x) if x.is_finite() => numbers.push((name.to_owned(), x)),
            ParameterValue::Number(x) => return Err(wrong("a finite number", x.to_string())),
            ParameterValue::Direction(v) => {
                let size = v.iter().map(|x| x * x).sum::<f64>();
                if !(size.is_finite() && size > 0.0) {
                    return Err(wrong("three finite numbers, not all zero", format!("{v:?}")));
                }
                let named = ["x", "y", "z"].map(|axis| component(name, axis)).into_iter().zip(v);
                numbers.extend(named);
            }
        }
    }
    let mut names: Vec<&str> = numbers.iter().map(|p| p.0.as_str()).collect();
    names.sort_unstable();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => {
            let reason = "it is the name of a component of a direction";
            Err(Problem::ParameterName { name: pair[0].to_owned(), reason })
        }
        None => Ok(numbers),
    }
}
