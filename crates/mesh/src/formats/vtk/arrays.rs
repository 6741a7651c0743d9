//! Arrays of a VTK file: which are regions, and which are fields.
//!
//! VTK has no groups. A region is an array of zeros and ones, or one label per cell; which arrays hold labels can only
//! be told from their name (and from how few values they hold).

use super::REGION_PREFIX;
use super::cells::CellMap;
use crate::formats::draft::{Draft, Finished};
use crate::formats::field::{Field, Location, Values};
use std::collections::BTreeMap;

/// An array of a file.
pub(super) struct Array {
    pub(super) name: String,
    pub(super) components: usize,
    pub(super) location: Location,
    /// First node or cell that it is about (files come in pieces).
    pub(super) first: usize,
    pub(super) values: Values,
}

/// Words that name labels.
const LABEL_WORDS: [&str; 24] = [
    "region",
    "regions",
    "material",
    "materials",
    "mat",
    "physical",
    "subdomain",
    "domain",
    "part",
    "label",
    "labels",
    "group",
    "groups",
    "zone",
    "tag",
    "tags",
    "entity",
    "ref",
    "refs",
    "block",
    "tissue",
    "segment",
    "object",
    "markers",
];
/// An array with more different values holds numbers, not labels.
const MOST_LABELS: usize = 1000;

/// A field has at most this many numbers per node or element: a tensor.
const MOST_COMPONENTS: usize = 9;

/// Whether a word of the name says that it holds labels: `gmsh:physical`, `CellEntityIds`, `material_id`.
fn names_labels(name: &str) -> bool {
    let mut words = String::new();
    let mut before = ' ';
    for c in name.chars() {
        if !c.is_alphanumeric() || (c.is_uppercase() && before.is_lowercase()) {
            words.push(' ');
        }
        words.extend(c.to_lowercase());
        before = c;
    }
    words.split(|c: char| !c.is_alphanumeric()).any(|word| LABEL_WORDS.contains(&word))
}

/// The values as integers, when they all are.
fn integers(values: &Values) -> Option<Vec<i64>> {
    match values {
        Values::I64(v) => Some(v.clone()),
        Values::F64(v) => v.iter().map(|&x| (x.fract() == 0.0 && x.abs() < 1e15).then_some(x as i64)).collect(),
    }
}

/// Makes regions of an array, or notes that it holds none.
pub(super) fn regions(draft: &mut Draft, map: &CellMap, array: &Array) {
    let own = array.name.strip_prefix(REGION_PREFIX);
    let labels = own.is_none() && names_labels(&array.name);
    let is_integer = matches!(array.values, Values::I64(_));
    let values = if array.components == 1 && (is_integer || labels) { integers(&array.values) } else { None };
    let flags = values.as_ref().is_some_and(|v| v.iter().all(|&x| x == 0 || x == 1));
    // VTK marks ghost cells in an array of flags that says nothing about the body.
    let ghost = array.name.starts_with("vtkGhost");
    match values {
        Some(values) if labels => {
            let mut members: BTreeMap<i64, Vec<usize>> = BTreeMap::new();
            for (at, value) in values.into_iter().enumerate() {
                members.entry(value).or_default().push(at);
                if members.len() > MOST_LABELS {
                    draft.report.ignore(format!("array {} (more than {MOST_LABELS} values)", array.name));
                    return;
                }
            }
            for (value, members) in members {
                add(draft, map, array, &format!("{}_{value}", array.name), members.into_iter());
            }
        }
        Some(values) if flags && !ghost => {
            let members = values.into_iter().enumerate().filter(|(_, v)| *v == 1).map(|(at, _)| at);
            add(draft, map, array, own.unwrap_or(&array.name), members);
        }
        _ => draft.report.ignore(format!("array {}", array.name)),
    }
}

fn add(draft: &mut Draft, map: &CellMap, array: &Array, name: &str, members: impl Iterator<Item = usize>) {
    let region = draft.region(name);
    if array.location == Location::Nodes {
        draft.lists_nodes(region);
    }
    for member in members {
        match array.location {
            Location::Nodes => draft.add_node(region, (array.first + member) as u32),
            Location::Elements => {
                map.elements(array.first + member).iter().for_each(|&e| draft.add_element(region, e));
            }
        }
    }
}

/// The arrays that are not regions, in the order of the finished mesh.
///
/// A node or element that an array says nothing about (the file came in pieces) gets NaN, or 0 in integers.
pub(super) fn fields(finished: &Finished, map: &CellMap, arrays: Vec<Array>) -> Vec<Field> {
    let mut node_to = vec![None; finished.node_from.iter().max().map_or(0, |&m| m as usize + 1)];
    for (new, &old) in finished.node_from.iter().enumerate() {
        node_to[old as usize] = Some(new);
    }
    let mut first_of_block = vec![0];
    for block in &finished.mesh.blocks {
        first_of_block.push(first_of_block.last().copied().unwrap_or(0) + block.len());
    }
    let elements = first_of_block.last().copied().unwrap_or(0);
    let mut fields: Vec<Field> = Vec::new();
    let is_field = |a: &&Array| {
        !a.name.starts_with(REGION_PREFIX) && (1..=MOST_COMPONENTS).contains(&a.components) && !a.values.is_empty()
    };
    for array in arrays.iter().filter(is_field) {
        let count = if array.location == Location::Nodes { finished.mesh.nodes.len() } else { elements };
        let known = fields.iter().position(|f| f.name == array.name && f.location == array.location);
        let at = known.unwrap_or_else(|| {
            let length = count * array.components;
            let values = match array.values {
                Values::F64(_) => Values::F64(vec![f64::NAN; length]),
                Values::I64(_) => Values::I64(vec![0; length]),
            };
            let (name, components, location) = (array.name.clone(), array.components, array.location);
            fields.push(Field { name, components, location, values });
            fields.len() - 1
        });
        let field = &mut fields[at];
        if field.components != array.components {
            continue;
        }
        let to = |tuple: usize| -> Vec<usize> {
            match array.location {
                Location::Nodes => node_to.get(array.first + tuple).copied().flatten().into_iter().collect(),
                Location::Elements => {
                    let ids = map.elements(array.first + tuple).iter().map(|&e| finished.element(e));
                    ids.map(|e| first_of_block[e.block as usize] + e.index as usize).collect()
                }
            }
        };
        match (&mut field.values, &array.values) {
            (Values::F64(to_values), Values::F64(from)) => scatter(to_values, from, array.components, to),
            (Values::I64(to_values), Values::I64(from)) => scatter(to_values, from, array.components, to),
            _ => {}
        }
    }
    fields
}

fn scatter<T: Copy>(to_values: &mut [T], from: &[T], components: usize, to: impl Fn(usize) -> Vec<usize>) {
    for (tuple, values) in from.chunks_exact(components).enumerate() {
        for at in to(tuple) {
            to_values[at * components..(at + 1) * components].copy_from_slice(values);
        }
    }
}
