//! Writing the three files.

use super::names::element_name;
use super::read::named;
use super::{Association, Triple};
use crate::mesh::{ElementId, Mesh};
use std::fmt::Write;

/// The texts of the three files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TripleText {
    /// `.obj`.
    pub obj: String,
    /// `.element`.
    pub element: String,
    /// `.info`.
    pub info: String,
}

/// A model of a mesh whose elements follow the law that `law` gives, uncut; elements are in the order of the blocks.
pub fn associate(mesh: Mesh, law: impl Fn(ElementId) -> String) -> Triple {
    let order: Vec<ElementId> = mesh.element_ids().collect();
    let associations = order
        .iter()
        .map(|&id| {
            let element = element_name(mesh.blocks[id.block as usize].element);
            let integration_points = super::names::parse_name(&element).ok().and_then(|name| name.integration_points);
            Association { law: law(id), element, cutting: "DecoupageNon".to_owned(), integration_points }
        })
        .collect();
    named(mesh, order, associations)
}

/// The texts of a model, laid out as in the thesis. Reading them gives the same model: numbers are written with as
/// many digits as their value needs.
///
/// Regions other than those of the laws have no place in these files.
pub fn write(triple: &Triple) -> TripleText {
    let mesh = &triple.mesh;
    let mut obj = String::new();
    for [x, y, z] in &mesh.nodes {
        line(&mut obj, format_args!("v {x} {y} {z}"));
    }

    let mut element = String::new();
    line(&mut element, format_args!("nbElement {}", triple.order.len()));
    let widest = triple.order.iter().map(|&id| mesh.nodes_of(id).len()).max().unwrap_or(0);
    let names: String = (1..=widest).map(|i| format!(" i{i}")).collect();
    line(&mut element, format_args!("#indices{names}"));
    for &id in &triple.order {
        let nodes = mesh.nodes_of(id);
        let indices: String = nodes.iter().map(|n| format!(" {n}")).collect();
        line(&mut element, format_args!("{}{indices}", nodes.len()));
    }

    let mut info = String::new();
    line(&mut info, format_args!("nbDim {}", mesh.dimension().max(1)));
    line(&mut info, format_args!("$ELEM\n#nbElement\n{}", triple.order.len()));
    line(&mut info, format_args!("#indices Loi Element Decoupage"));
    for (index, a) in triple.associations.iter().enumerate() {
        line(&mut info, format_args!("{index} {} {} {}", a.law, a.element, a.cutting));
    }
    line(&mut info, format_args!("$ENDELM"));
    TripleText { obj, element, info }
}

fn line(text: &mut String, content: std::fmt::Arguments<'_>) {
    writeln!(text, "{content}").expect("writing to a string does not fail");
}
