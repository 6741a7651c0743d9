//! Reading the three files.

use super::names::{element, parse_name};
use super::{Association, Problem, Triple, TripleError, finite, lines, parse};
use crate::mesh::{ElementId, Mesh, Region, sorted_set};
use std::collections::BTreeMap;

/// Reads a model from the texts of its three files.
///
/// # Errors
/// The file, the line and what was expected there.
pub fn read(obj: &str, element: &str, info: &str) -> Result<Triple, TripleError> {
    let nodes = read_particles(obj)?;
    let rows = read_elements(element, nodes.len())?;
    let info = read_info(info, rows.len())?;
    build(nodes, rows, info)
}

fn at(file: &'static str, line: usize) -> impl Fn(Problem) -> TripleError {
    move |problem| TripleError { file, line, problem }
}

fn end(file: &'static str, text: &str, problem: Problem) -> TripleError {
    TripleError { file, line: text.lines().count(), problem }
}

/// Positions of a Wavefront file; its other statements (normals, faces, groups, …) describe nothing here.
fn read_particles(text: &str) -> Result<Vec<[f64; 3]>, TripleError> {
    const OTHER: [&str; 9] = ["vn", "vt", "f", "l", "o", "g", "s", "usemtl", "mtllib"];
    let mut nodes = Vec::new();
    for (line, words) in lines(text) {
        let at = at(".obj", line);
        match words[0] {
            "v" if words.len() >= 4 => {
                let mut position = [0.0; 3];
                for (x, word) in position.iter_mut().zip(&words[1..]) {
                    *x = finite(word).map_err(&at)?;
                }
                nodes.push(position);
            }
            "v" => return Err(at(Problem::Words { found: words.len(), expected: "`v x y z`" })),
            other if OTHER.contains(&other) => {}
            word => {
                let expected = "`v x y z`, a comment (`#`) or another Wavefront statement";
                return Err(at(Problem::UnknownWord { word: word.to_owned(), expected }));
            }
        }
    }
    Ok(nodes)
}

/// Line and node indices of each element.
type Row = (usize, Vec<u32>);

fn read_elements(text: &str, node_count: usize) -> Result<Vec<Row>, TripleError> {
    const FILE: &str = ".element";
    let mut stated: Option<(usize, usize)> = None;
    let mut rows: Vec<Row> = Vec::new();
    for (line, words) in lines(text) {
        let at = at(FILE, line);
        if words[0] == "nbElement" {
            let [_, number] = words[..] else {
                return Err(at(Problem::Words { found: words.len(), expected: "`nbElement N`" }));
            };
            if stated.is_some() {
                return Err(at(Problem::Repeated { what: "`nbElement`".to_owned() }));
            }
            stated = Some((line, parse(number, "a number of elements").map_err(&at)?));
            continue;
        }
        if stated.is_none() {
            return Err(at(Problem::UnknownWord { word: words[0].to_owned(), expected: "`nbElement N` first" }));
        }
        let count: usize = parse(words[0], "a number of nodes").map_err(&at)?;
        if words.len() != count + 1 {
            let expected = "a number of nodes followed by that many indices";
            return Err(at(Problem::Words { found: words.len(), expected }));
        }
        let mut nodes = Vec::with_capacity(count);
        for word in &words[1..] {
            let index: usize = parse(word, "an index of a particle").map_err(&at)?;
            if index >= node_count {
                return Err(at(Problem::Index { what: "particle", index, count: node_count }));
            }
            nodes.push(index as u32);
        }
        rows.push((line, nodes));
    }
    match stated {
        None => Err(end(FILE, text, Problem::Missing { expected: "`nbElement N`".to_owned() })),
        Some((line, stated)) if stated != rows.len() => {
            Err(at(FILE, line)(Problem::Count { stated, found: rows.len() }))
        }
        Some(_) => Ok(rows),
    }
}

/// What the `.info` file says.
struct Info {
    dimension: usize,
    /// By element; the line of each.
    associations: Vec<(usize, Association)>,
}

fn read_info(text: &str, element_count: usize) -> Result<Info, TripleError> {
    const FILE: &str = ".info";
    let mut rest = lines(text);
    let mut next =
        |expected: &str| rest.next().ok_or_else(|| end(FILE, text, Problem::Missing { expected: expected.to_owned() }));

    let (line, words) = next("`nbDim d`")?;
    let ["nbDim", number] = words[..] else {
        return Err(at(FILE, line)(Problem::UnknownWord { word: words[0].to_owned(), expected: "`nbDim d` first" }));
    };
    let dimension: usize = parse(number, "a dimension").map_err(at(FILE, line))?;
    if !(1..=3).contains(&dimension) {
        let problem = Problem::Number { word: number.to_owned(), expected: "a dimension from 1 to 3" };
        return Err(at(FILE, line)(problem));
    }
    let (line, words) = next("`$ELEM`")?;
    if words != ["$ELEM"] {
        return Err(at(FILE, line)(Problem::UnknownWord { word: words[0].to_owned(), expected: "`$ELEM`" }));
    }
    let (line, words) = next("the number of elements")?;
    let [number] = words[..] else {
        return Err(at(FILE, line)(Problem::Words { found: words.len(), expected: "the number of elements" }));
    };
    let stated: usize = parse(number, "a number of elements").map_err(at(FILE, line))?;
    if stated != element_count {
        return Err(at(FILE, line)(Problem::Count { stated, found: element_count }));
    }

    let mut found: Vec<Option<(usize, Association)>> = vec![None; element_count];
    loop {
        let (line, words) = next("`$ENDELM`")?;
        let at = at(FILE, line);
        if words == ["$ENDELM"] {
            break;
        }
        let [index, law, element, cutting] = words[..] else {
            return Err(at(Problem::Words { found: words.len(), expected: "`index Loi Element Decoupage`" }));
        };
        let index: usize = parse(index, "an index of an element").map_err(&at)?;
        let association = association(law, element, cutting).map_err(&at)?;
        match found.get_mut(index) {
            None => return Err(at(Problem::Index { what: "element", index, count: element_count })),
            Some(Some(_)) => return Err(at(Problem::Repeated { what: format!("element {index}") })),
            Some(place) => *place = Some((line, association)),
        }
    }
    if let Some(missing) = found.iter().position(Option::is_none) {
        let expected = format!("an association for element {missing}");
        return Err(end(FILE, text, Problem::Missing { expected }));
    }
    Ok(Info { dimension, associations: found.into_iter().flatten().collect() })
}

/// The words of an association; the element's name must be a known one.
pub(super) fn association(law: &str, element: &str, cutting: &str) -> Result<Association, Problem> {
    let integration_points = parse_name(element)?.integration_points;
    let [law, element, cutting] = [law, element, cutting].map(str::to_owned);
    Ok(Association { law, element, cutting, integration_points })
}

fn build(nodes: Vec<[f64; 3]>, rows: Vec<Row>, info: Info) -> Result<Triple, TripleError> {
    let mut mesh = Mesh { nodes, ..Mesh::default() };
    let (mut order, mut associations) = (Vec::new(), Vec::new());
    for ((_, nodes), (line, association)) in rows.into_iter().zip(info.associations) {
        let at = at(".info", line);
        let spelled = &association.element;
        let name = parse_name(spelled).map_err(&at)?;
        let kind = element(spelled, name, Some(nodes.len())).map_err(&at)?;
        if kind.dimension() > info.dimension {
            let (dimension, stated) = (kind.dimension(), info.dimension);
            return Err(at(Problem::Dimension { name: spelled.clone(), dimension, stated }));
        }
        let block = mesh.block_mut(kind);
        let index = block.len() as u32;
        block.connectivity.extend(nodes);
        let block = mesh.blocks.iter().position(|b| b.element.id == kind.id).expect("it was just made") as u32;
        order.push(ElementId { block, index });
        associations.push(association);
    }
    Ok(named(mesh, order, associations))
}

/// The model with these elements in this order; adds one region per law, of the law's name.
pub(super) fn named(mut mesh: Mesh, order: Vec<ElementId>, associations: Vec<Association>) -> Triple {
    let mut laws: BTreeMap<&str, Vec<ElementId>> = BTreeMap::new();
    for (&id, association) in order.iter().zip(&associations) {
        laws.entry(&association.law).or_default().push(id);
    }
    for (law, elements) in laws {
        let elements = sorted_set(elements);
        let nodes = sorted_set(elements.iter().flat_map(|&e| mesh.nodes_of(e)).copied());
        mesh.regions.insert(law.to_owned(), Region { nodes, elements });
    }
    Triple { mesh, order, associations }
}
