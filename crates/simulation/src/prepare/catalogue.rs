//! The laws that a scene may name, as the scene's reader wants to know them.

use souple_laws::user::{self, UserLaw, UserLawError};
use souple_laws::{Argument, check};
use souple_scene::{Catalogue, LawEntry, LawRefusal, ParameterEntry, ParameterShape, ParameterValue};

/// Every law of the registry with its parameters, ranges and units.
///
/// A user law's energy is read and judged at rest: finite, free of stress, stable.
pub fn catalogue() -> Catalogue {
    let laws = souple_laws::all().iter().map(|law| LawEntry {
        id: law.id.to_owned(),
        parameters: law.arguments().into_iter().map(argument).collect(),
        check: None,
    });
    Catalogue { laws: laws.collect(), user_law: Some(judge) }
}

/// Reads the energy of a user law with the parameters of a scene: numbers, and lists of three as directions.
///
/// # Errors
/// The first thing that is wrong with the text or the parameters.
pub(super) fn read<'v>(
    energy: &str,
    parameters: impl Iterator<Item = (&'v str, &'v ParameterValue)>,
) -> Result<UserLaw, UserLawError> {
    let values: Vec<(&str, user::ParameterValue)> = parameters
        .map(|(name, value)| {
            let value = match value {
                ParameterValue::Number(number) => user::ParameterValue::Number(*number),
                // A list of another length is no direction; as a zero one it is refused with its name.
                ParameterValue::List(list) => user::ParameterValue::Direction(list[..].try_into().unwrap_or([0.0; 3])),
            };
            (name, value)
        })
        .collect();
    UserLaw::parse(energy, &values)
}

fn judge(energy: &str, parameters: &[(&str, &ParameterValue)]) -> Result<(), LawRefusal> {
    let refuse = |message: String| LawRefusal { parameter: None, message };
    let law = read(energy, parameters.iter().copied()).map_err(|e| refuse(format!("{e}\n{}", e.excerpt())))?;
    check::at_rest(&law.response()).map(|_| ()).map_err(|fault| refuse(fault.to_string()))
}

/// A number, or a direction that a scene writes as one list.
fn argument(argument: Argument) -> ParameterEntry {
    match argument {
        Argument::Number(number) => parameter(number),
        Argument::Direction { name, x } => {
            ParameterEntry { name: name.to_owned(), shape: ParameterShape::Direction, ..parameter(x) }
        }
    }
}

fn parameter(parameter: &souple_laws::Parameter) -> ParameterEntry {
    ParameterEntry {
        name: parameter.name.to_owned(),
        unit: parameter.unit.to_owned(),
        shape: ParameterShape::Number,
        minimum: bound(parameter.minimum),
        maximum: bound(parameter.maximum),
        default: parameter.default.map(ParameterValue::Number),
        about: parameter.about.to_owned(),
    }
}

fn bound(bound: souple_laws::Bound) -> Option<souple_scene::Bound> {
    match bound {
        souple_laws::Bound::None => None,
        souple_laws::Bound::NonZero => Some(souple_scene::Bound::NonZero),
        souple_laws::Bound::Open(limit) => Some(souple_scene::Bound::Open(limit)),
        souple_laws::Bound::Closed(limit) => Some(souple_scene::Bound::Closed(limit)),
    }
}
