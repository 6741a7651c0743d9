//! Units of what varies and of what is measured, from the scene's own schema.

use souple_simulation::prepare::catalogue;
use souple_simulation::scene::probe::Quantity;
use souple_simulation::scene::schema::{Kind, Section, schema, unit};
use souple_simulation::scene::{Catalogue, Named as _};

/// Parameters of a `params.csv` that have a unit.
const FOLDER: &[(&str, &str)] = &[
    ("longueur", "m"),
    ("largeurSection", "m"),
    ("densite", "kg/m^3"),
    ("moduleYoung", "Pa"),
    ("epsilonStable", "J"),
    ("pas", "s"),
    ("tempsEtirement", "s"),
];

/// The unit of a parameter: a key of the scene, or a name in `params.csv`; empty where it has none.
pub fn unit_of_parameter(name: &str) -> String {
    if let Some((_, unit)) = FOLDER.iter().find(|(n, _)| *n == name) {
        return (*unit).to_owned();
    }
    let root = schema().into_iter().find(|s| s.keys.iter().any(|k| k.name == "body"));
    let parts: Vec<&str> = name.split('.').collect();
    let found = root.and_then(|root| walk(root, &parts, &catalogue()));
    // What is not a key of the scene is looked up in the first body.
    let in_body = || {
        let body = root?.keys.iter().find(|k| k.name == "body")?;
        let Kind::Tables(body) = body.kind else { return None };
        walk(body, &parts, &catalogue())
    };
    found.or_else(in_body).unwrap_or_default()
}

fn walk(section: &Section, parts: &[&str], catalogue: &Catalogue) -> Option<String> {
    let (first, rest) = parts.split_first()?;
    let Some(key) = section.key(first) else {
        // A parameter of a law.
        let mut laws = catalogue.laws.iter().flat_map(|law| &law.parameters);
        // Pure numbers have the unit "1" there.
        return laws
            .find(|p| section.header == "[[body.material]]" && p.name == *first)
            .map(|p| if p.unit == "1" { String::new() } else { p.unit.clone() });
    };
    match key.kind {
        Kind::Table(below) => walk(below, rest, catalogue),
        Kind::Tables(below) => walk(below, rest.get(1..)?, catalogue),
        kind => Some(unit(&kind).to_owned()),
    }
}

/// The unit of a probe's quantity; empty where it has none.
pub fn unit_of_quantity(name: &str) -> &'static str {
    Quantity::CHOICES
        .iter()
        .position(|choice| choice.name == name)
        .and_then(|at| Quantity::ALL.get(at))
        .map_or("", |quantity| quantity.dimension().unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keys of scenes, parameters of laws, of folders, and quantities of probes have the units that the scene gives them.
    #[test]
    fn units_are_those_of_the_scene() {
        for (name, unit) in [
            ("body.0.density", "kg/m^3"),
            ("body.bar.density", "kg/m^3"),
            ("time.step", "s"),
            ("gravity.1", "m/s^2"),
            ("body.0.mesh.size", "m"),
            ("body.0.mesh.cells", ""),
            ("material.*.young", "Pa"),
            ("body.0.material.0.poisson", ""),
            ("integrator.method", ""),
            ("moduleYoung", "Pa"),
            ("nonsense.key", ""),
        ] {
            assert_eq!(unit_of_parameter(name), unit, "{name}");
        }
        assert_eq!(unit_of_quantity("mean displacement"), "m");
        assert_eq!(unit_of_quantity("volume ratio"), "");
    }
}
