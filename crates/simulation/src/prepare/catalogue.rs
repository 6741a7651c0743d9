//! The laws that a scene may name, as the scene's reader wants to know them.

use souple_scene::{Catalogue, LawEntry, ParameterEntry, ParameterShape, ParameterValue};

/// Every law of the registry with its parameters, ranges and units.
///
/// A user law's energy is accepted as it stands; [`super::prepare`] says what becomes of it.
pub fn catalogue() -> Catalogue {
    let laws = souple_laws::all().iter().map(|law| LawEntry {
        id: law.id.to_owned(),
        parameters: law.parameters.iter().map(parameter).collect(),
        check: None,
    });
    Catalogue { laws: laws.collect(), user_law: None }
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
        souple_laws::Bound::Open(limit) => Some(souple_scene::Bound::Open(limit)),
        souple_laws::Bound::Closed(limit) => Some(souple_scene::Bound::Closed(limit)),
    }
}
