//! What the thesis calls elements.
//!
//! A name is a family, then optionally a number: with `I` after it the number of integration points (`Prism6I`),
//! without it the number of nodes (`Tetra10`). The number of nodes in the `.element` file decides which element of the
//! family is meant.

use super::Problem;
use souple_elements::{Element, Family, all};

/// Spellings by family; the first one is written.
const SPELLINGS: [(Family, &[&str]); 7] = [
    (Family::Edge, &["Arete", "Arête", "Edge"]),
    (Family::Triangle, &["Triangle"]),
    (Family::Quadrangle, &["Quad", "Quadrangle"]),
    (Family::Tetrahedron, &["Tetra", "Tetraedre", "Tetraèdre", "Tétraèdre", "Tetrahedron"]),
    (Family::Hexahedron, &["Cube", "Hexa", "Hexaedre", "Hexaèdre", "Hexahedron"]),
    (Family::Prism, &["Prism", "Prisme"]),
    (Family::Pyramid, &["Pyramid", "Pyramide"]),
];

/// A name taken apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Name {
    pub family: Family,
    pub nodes: Option<usize>,
    pub integration_points: Option<usize>,
}

pub(super) fn parse_name(name: &str) -> Result<Name, Problem> {
    let unknown = || {
        let known: Vec<&str> = SPELLINGS.iter().flat_map(|(_, names)| *names).copied().collect();
        Problem::UnknownElement { name: name.to_owned(), known: known.join(", ") }
    };
    let (stem, points) = match name.strip_suffix('I') {
        Some(stem) if stem.ends_with(|c: char| c.is_ascii_digit()) => (stem, true),
        _ => (name, false),
    };
    let word = stem.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = match &stem[word.len()..] {
        "" => None,
        digits => Some(digits.parse().map_err(|_| unknown())?),
    };
    let found = SPELLINGS.iter().find(|(_, names)| names.contains(&word));
    let (family, _) = found.ok_or_else(unknown)?;
    let (nodes, integration_points) = if points { (None, number) } else { (number, None) };
    Ok(Name { family: *family, nodes, integration_points })
}

/// The element that a name means, given its number of nodes where a file states it.
pub(super) fn element(spelled: &str, name: Name, count: Option<usize>) -> Result<&'static Element, Problem> {
    let family = || all().iter().copied().filter(|e| e.family == name.family);
    let wanted = count.or(name.nodes).unwrap_or(name.family.corner_count());
    // A name that states another number of nodes than the file fits nothing either.
    let consistent = name.nodes.is_none_or(|n| n == wanted);
    family().find(|e| e.node_count() == wanted && consistent).ok_or_else(|| {
        let known: Vec<String> = family().map(|e| e.node_count().to_string()).collect();
        let (family, count) = (name.family.name(), wanted);
        Problem::NodeCount { name: spelled.to_owned(), family, count, known: known.join(", ") }
    })
}

/// The name that is written for an element, as the thesis spells it: `Triangle`, `Quad`, `Tetra`, `Cube8I`, `Prism6I`,
/// `Pyramid5I`; elements that it does not spell get their family and number of nodes (`Tetra10`).
pub fn element_name(element: &Element) -> String {
    let stem = SPELLINGS.iter().find(|(family, _)| *family == element.family).map_or("", |(_, names)| names[0]);
    match (element.family, element.degree) {
        (Family::Edge | Family::Triangle | Family::Quadrangle | Family::Tetrahedron, 1) => stem.to_owned(),
        (Family::Hexahedron, 1) => format!("{stem}8I"),
        (Family::Prism, 1) => format!("{stem}6I"),
        (Family::Pyramid, 1) => format!("{stem}5I"),
        _ => format!("{stem}{}", element.node_count()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every element of the registry has a name that leads back to it.
    #[test]
    fn names_lead_back() {
        for e in all() {
            let spelled = element_name(e);
            let name = parse_name(&spelled).unwrap();
            assert_eq!(element(&spelled, name, Some(e.node_count())).unwrap().id, e.id);
            assert_eq!(element(&spelled, name, None).unwrap().id, e.id);
        }
    }

    /// The spellings printed in the thesis are understood, with their integration points.
    #[test]
    fn printed_spellings() {
        for (spelled, id, points) in [
            ("Triangle", "tri3", None),
            ("Quad", "quad4", None),
            ("Tetra", "tet4", None),
            ("Tetraedre", "tet4", None),
            ("Prism6I", "prism6", Some(6)),
            ("Pyramid5I", "pyramid5", Some(5)),
            ("Cube8I", "hex8", Some(8)),
            ("Hexa27I", "hex8", Some(27)),
        ] {
            let name = parse_name(spelled).unwrap();
            assert_eq!(element(spelled, name, None).unwrap().id, id, "{spelled}");
            assert_eq!(name.integration_points, points, "{spelled}");
        }
        for wrong in ["Tetrahedra", "triangle", "I", "8I", "", "Cube99999999999999999999999I"] {
            assert!(matches!(parse_name(wrong), Err(Problem::UnknownElement { .. })), "{wrong}");
        }
        let name = parse_name("Tetra7").unwrap();
        assert!(matches!(element("Tetra7", name, None), Err(Problem::NodeCount { count: 7, .. })));
    }
}
