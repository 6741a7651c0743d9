//! The configuration file of the thesis' bar generator.
//!
//! ```text
//! nomRepertoire ./
//! nomMaillage barreMixte
//! longueur 6
//! largeurSection 1
//! nbCubeLongueur 12
//! nbCubeLargeurSection 2
//! 0.5 Hooke Triangle DecoupageNon
//! 1.0 SaintVenant Quad DecoupageNon
//! ```
//!
//! Length and width in metres, number of cubes along and across, then one line per section: the fraction of the length
//! where it ends, and its association. The section is square in 3D; the dimension is that of the elements.

use super::names::{element, parse_name};
use super::read::{association, named};
use super::{Association, Problem, Triple, TripleError, finite, lines, parse};
use crate::bar::{BarError, BarReport, BarSpec, Section, Split, Transition, generate};

/// What the file says.
#[derive(Clone, Debug)]
pub struct BarConfig {
    /// Where the three files would go.
    pub directory: String,
    /// The name of the three files without extension.
    pub mesh_name: String,
    /// The bar.
    pub spec: BarSpec,
    /// The association of each section.
    pub associations: Vec<Association>,
}

const FILE: &str = "bar configuration";
const EXPECTED: &str = "nomRepertoire, nomMaillage, longueur, largeurSection, nbCubeLongueur, nbCubeLargeurSection, \
                        or a section `fraction Loi Element Decoupage`";

/// Reads a configuration. Keys come in any order, sections in order of the length.
///
/// # Errors
/// The line and what was expected there.
pub fn read(text: &str) -> Result<BarConfig, TripleError> {
    let (mut directory, mut mesh_name, mut length, mut width) = (None, None, None, None);
    let (mut cells_along, mut cells_across) = (None, None);
    let (mut sections, mut associations) = (Vec::new(), Vec::new());
    for (line, words) in lines(text) {
        let at = |problem| TripleError { file: FILE, line, problem };
        let key = words[0];
        let known = matches!(
            key,
            "nomRepertoire" | "nomMaillage" | "longueur" | "largeurSection" | "nbCubeLongueur" | "nbCubeLargeurSection"
        );
        if known {
            let [_, value] = words[..] else {
                return Err(at(Problem::Words { found: words.len(), expected: "a key and its value" }));
            };
            let repeated = match key {
                "nomRepertoire" => directory.replace(value.to_owned()).is_some(),
                "nomMaillage" => mesh_name.replace(value.to_owned()).is_some(),
                "longueur" => length.replace(finite(value).map_err(at)?).is_some(),
                "largeurSection" => width.replace(finite(value).map_err(at)?).is_some(),
                "nbCubeLongueur" => cells_along.replace(parse(value, "a number of cubes").map_err(at)?).is_some(),
                _ => cells_across.replace(parse(value, "a number of cubes").map_err(at)?).is_some(),
            };
            if repeated {
                return Err(at(Problem::Repeated { what: format!("`{key}`") }));
            }
            continue;
        }
        let until = finite(key).map_err(|_| at(Problem::UnknownWord { word: key.to_owned(), expected: EXPECTED }))?;
        let [_, law, spelled, cutting] = words[..] else {
            return Err(at(Problem::Words { found: words.len(), expected: "`fraction Loi Element Decoupage`" }));
        };
        let name = parse_name(spelled).map_err(at)?;
        sections.push(Section { until, element: element(spelled, name, None).map_err(at)?, split: Split::Usual });
        associations.push(association(law, spelled, cutting).map_err(at)?);
    }
    let missing = |key: &str| TripleError {
        file: FILE,
        line: text.lines().count(),
        problem: Problem::Missing { expected: format!("`{key}`") },
    };
    let length = length.ok_or_else(|| missing("longueur"))?;
    let width = width.ok_or_else(|| missing("largeurSection"))?;
    let along = cells_along.ok_or_else(|| missing("nbCubeLongueur"))?;
    let across = cells_across.ok_or_else(|| missing("nbCubeLargeurSection"))?;
    let spec = BarSpec {
        size: [length, width, width],
        cells: [along, across, across],
        origin: [0.0; 3],
        sections,
        transition: Transition::Keep,
    };
    let directory = directory.ok_or_else(|| missing("nomRepertoire"))?;
    let mesh_name = mesh_name.ok_or_else(|| missing("nomMaillage"))?;
    Ok(BarConfig { directory, mesh_name, spec, associations })
}

/// Generates the model of a configuration: what the thesis' generator wrote into its three files, in our numbering.
///
/// # Errors
/// Those of [`generate`]: the geometry is checked there.
pub fn model(config: &BarConfig) -> Result<(Triple, BarReport), BarError> {
    let (mesh, report) = generate(&config.spec)?;
    let (mut order, mut associations) = (Vec::new(), Vec::new());
    for (s, association) in config.associations.iter().enumerate() {
        let Some(section) = mesh.regions.get(&format!("section_{s}")) else { continue };
        order.extend_from_slice(&section.elements);
        associations.resize(order.len(), association.clone());
    }
    Ok((named(mesh, order, associations), report))
}
