//! Parameters of a material in the order of its law.
//!
//! Isotropy is two constants, given as one of three pairs; a law may ask for any of the five:
//!
//! | given | Young's modulus E | Poisson's ratio ν |
//! |---|---|---|
//! | λ, μ | μ (3λ + 2μ) / (λ + μ) | λ / (2 (λ + μ)) |
//! | K, μ | 9 K μ / (3K + μ) | (3K − 2μ) / (2 (3K + μ)) |

use super::error::Findings;
use souple_laws::{Bound, Law, Parameter};
use souple_scene::material::Material;
use souple_scene::{Location, ParameterValue};

/// The law's parameters in its declared order; `None` after a problem was noted.
///
/// What the scene gives under the law's own name is passed on to the last bit; the rest is converted or the default.
pub(super) fn parameters(law: &Law, material: &Material, findings: &mut Findings) -> Option<Vec<f64>> {
    let mut values = Vec::with_capacity(law.parameters.len());
    for parameter in law.parameters {
        let (value, at, origin) = match material.parameter(parameter.name) {
            Some(given) => match given.value {
                ParameterValue::Number(value) => (value, &given.at, String::new()),
                ParameterValue::List(_) => {
                    let message = format!("`{}` of law `{}` is one number, found a list", parameter.name, law.id);
                    findings.problem(&given.at, message);
                    continue;
                }
            },
            None => match (
                component(material, parameter.name).or_else(|| converted(material, parameter.name)),
                parameter.default,
            ) {
                (Some((value, at, origin)), _) => (value, at, origin),
                (None, Some(value)) => (value, &material.law.at, String::new()),
                (None, None) => {
                    let message = format!(
                        "law `{}` needs `{}` [{}], {}",
                        law.id, parameter.name, parameter.unit, parameter.about
                    );
                    findings.problem(&material.law.at, message);
                    continue;
                }
            },
        };
        if !parameter.accepts(value) {
            let at = if *at == Location::Default { &material.law.at } else { at };
            let message = format!("`{}` must be {}, found {value}{origin}", parameter.name, expected(parameter));
            findings.problem(at, message);
            continue;
        }
        values.push(value);
    }
    (values.len() == law.parameters.len()).then_some(values)
}

/// A component of a direction that the scene gives as one list: `fibre_y` of `fibre`.
fn component<'m>(material: &'m Material, name: &str) -> Option<(f64, &'m Location, String)> {
    let (base, axis) = name.rsplit_once('_')?;
    let axis = ["x", "y", "z"].iter().position(|a| *a == axis)?;
    let given = material.parameter(base)?;
    match &given.value {
        ParameterValue::List(list) => Some((*list.get(axis)?, &given.at, String::new())),
        ParameterValue::Number(_) => None,
    }
}

/// An elastic constant from the pair that the scene gives, the place of that pair, and the words that say so.
fn converted<'m>(material: &'m Material, name: &str) -> Option<(f64, &'m Location, String)> {
    let number = |name: &str| {
        material.parameter(name).and_then(|given| match given.value {
            ParameterValue::Number(value) => Some((value, &given.at)),
            ParameterValue::List(_) => None,
        })
    };
    // Everything through (λ, μ), except E and ν from K, which lose digits on the way when nearly incompressible.
    let (lambda, mu, bulk, at, pair) =
        if let (Some((young, at)), Some((poisson, _))) = (number("young"), number("poisson")) {
            let (lambda, mu) = souple_laws::lame_from_young_poisson(young, poisson);
            (lambda, mu, young / (3.0 * (1.0 - 2.0 * poisson)), at, "`young` and `poisson`")
        } else if let (Some((lambda, at)), Some((mu, _))) = (number("lambda"), number("mu")) {
            (lambda, mu, lambda + 2.0 / 3.0 * mu, at, "`lambda` and `mu`")
        } else if let (Some((bulk, at)), Some((mu, _))) = (number("bulk"), number("mu")) {
            (bulk - 2.0 / 3.0 * mu, mu, bulk, at, "`bulk` and `mu`")
        } else {
            return None;
        };
    let value = match name {
        "young" if pair == "`bulk` and `mu`" => 9.0 * bulk * mu / (3.0 * bulk + mu),
        "young" => mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu),
        "poisson" if pair == "`bulk` and `mu`" => (3.0 * bulk - 2.0 * mu) / (2.0 * (3.0 * bulk + mu)),
        "poisson" => lambda / (2.0 * (lambda + mu)),
        "lambda" => lambda,
        "mu" => mu,
        "bulk" => bulk,
        _ => return None,
    };
    Some((value, at, format!(" from {pair}")))
}

/// "greater than 0 and less than 0.5 (Poisson's ratio …)".
fn expected(parameter: &Parameter) -> String {
    let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
    let low = match parameter.minimum {
        Bound::None => None,
        Bound::NonZero => Some("other than 0".to_owned()),
        Bound::Open(limit) => Some(format!("greater than {limit}{unit}")),
        Bound::Closed(limit) => Some(format!("at least {limit}{unit}")),
    };
    let high = match parameter.maximum {
        Bound::None => None,
        Bound::NonZero => Some("other than 0".to_owned()),
        Bound::Open(limit) => Some(format!("less than {limit}{unit}")),
        Bound::Closed(limit) => Some(format!("at most {limit}{unit}")),
    };
    match (low, high) {
        (Some(low), Some(high)) => format!("{low} and {high}"),
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => "a finite number".to_owned(),
    }
}
