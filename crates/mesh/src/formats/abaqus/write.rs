//! Writing Abaqus input: nodes, elements by type, and the regions as sets.

use crate::Mesh;
use crate::formats::error::FormatError;
use souple_elements::Element;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Numbers on one line of a set; Abaqus allows no more.
const PER_LINE: usize = 16;

/// Writes a mesh. Nodes and elements are numbered from 1, in the order of the mesh.
///
/// # Errors
///
/// [`FormatError::NotWritable`] for an element without Abaqus name (a quadratic pyramid), and for regions whose names
/// Abaqus cannot hold or tell apart (it ignores case).
pub fn write_inp(mesh: &Mesh) -> Result<Vec<u8>, FormatError> {
    check_names(mesh)?;
    let mut text = String::from("*HEADING\nmesh\n*NODE\n");
    for (i, [x, y, z]) in mesh.nodes.iter().enumerate() {
        let _ = writeln!(text, "{}, {x:?}, {y:?}, {z:?}", i + 1);
    }
    let mut firsts = Vec::with_capacity(mesh.blocks.len());
    let mut id = 0;
    for block in &mesh.blocks {
        firsts.push(id);
        let _ = writeln!(text, "*ELEMENT, TYPE={}", type_name(block.element, mesh.dimension())?);
        for index in 0..block.len() {
            id += 1;
            let tags = block.nodes(index).iter().map(|&n| n as usize + 1);
            list(&mut text, std::iter::once(id).chain(tags));
        }
    }
    for (name, region) in &mesh.regions {
        // A region without anything is written as an empty node set, so that its name survives.
        if !region.nodes.is_empty() || region.elements.is_empty() {
            let _ = writeln!(text, "*NSET, NSET={}", quoted(name));
            sets(&mut text, region.nodes.iter().map(|&n| n as usize + 1));
        }
        if !region.elements.is_empty() {
            let _ = writeln!(text, "*ELSET, ELSET={}", quoted(name));
            sets(&mut text, region.elements.iter().map(|e| firsts[e.block as usize] + e.index as usize + 1));
        }
    }
    Ok(text.into_bytes())
}

/// The name to write: the registry's first one, but a surface of a solid needs a type with three coordinates, a shell
/// or a membrane.
fn type_name(element: &Element, mesh_dimension: usize) -> Result<&'static str, FormatError> {
    let names = element.exchange.abaqus;
    let starting = |start: &str| names.iter().copied().find(|n| n.starts_with(start));
    let spatial =
        if mesh_dimension == 3 && element.dimension() == 2 { starting("S").or(starting("M3D")) } else { None };
    spatial.or(names.first().copied()).ok_or_else(|| FormatError::NotWritable {
        what: format!("element {}", element.id),
        format: "Abaqus input",
        why: "Abaqus has no such element; write MSH or VTU, or split these elements into tetrahedra".to_owned(),
    })
}

/// One data line, continued where it gets too long.
fn list(text: &mut String, numbers: impl Iterator<Item = usize>) {
    for (at, number) in numbers.enumerate() {
        if at > 0 {
            text.push_str(if at % PER_LINE == 0 { ",\n" } else { ", " });
        }
        let _ = write!(text, "{number}");
    }
    text.push('\n');
}

/// Data lines of a set: here each line stands for itself.
fn sets(text: &mut String, numbers: impl Iterator<Item = usize>) {
    let numbers: Vec<usize> = numbers.collect();
    for line in numbers.chunks(PER_LINE) {
        list(text, line.iter().copied());
    }
}

fn quoted(name: &str) -> String {
    let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.'));
    if plain { name.to_owned() } else { format!("\"{name}\"") }
}

fn check_names(mesh: &Mesh) -> Result<(), FormatError> {
    let mut seen = BTreeSet::new();
    for name in mesh.regions.keys() {
        let refuse = |why: &str| FormatError::NotWritable {
            what: format!("region \"{}\"", name.escape_debug()),
            format: "Abaqus input",
            why: why.to_owned(),
        };
        if name.is_empty() || name.contains('"') || name.chars().any(char::is_control) {
            return Err(refuse("its name is empty or holds quotes or control characters; rename it"));
        }
        if !seen.insert(name.to_ascii_uppercase()) {
            return Err(refuse("another region has the same name but for its case; rename one of them"));
        }
    }
    Ok(())
}
