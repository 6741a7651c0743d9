//! Writing legacy VTK as text, in the layout that every version of VTK reads.

use super::{REGION_PREFIX, VtkWedge, cell_type};
use crate::Mesh;
use crate::formats::error::FormatError;
use crate::formats::field::{Field, Location, Values, fitted};
use std::fmt::Write as _;

/// Writes a mesh with fields; regions become arrays of zeros and ones named `region:NAME`.
///
/// # Errors
///
/// [`FormatError::NotWritable`] for a field that does not fit the mesh.
pub fn write_vtk(mesh: &Mesh, fields: &[Field], wedge: VtkWedge) -> Result<Vec<u8>, FormatError> {
    let fields = fitted(mesh, fields, "legacy VTK")?;
    let mut text = String::from("# vtk DataFile Version 4.2\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\n");
    let _ = writeln!(text, "POINTS {} double", mesh.nodes.len());
    for [x, y, z] in &mesh.nodes {
        let _ = writeln!(text, "{x:?} {y:?} {z:?}");
    }
    let cells: usize = mesh.blocks.iter().map(|b| b.len()).sum();
    let numbers: usize = mesh.blocks.iter().map(|b| b.len() + b.connectivity.len()).sum();
    let _ = writeln!(text, "CELLS {cells} {numbers}");
    for block in &mesh.blocks {
        for index in 0..block.len() {
            let nodes = block.nodes(index);
            let _ = write!(text, "{}", nodes.len());
            nodes.iter().for_each(|n| {
                let _ = write!(text, " {n}");
            });
            text.push('\n');
        }
    }
    let _ = writeln!(text, "CELL_TYPES {cells}");
    for block in &mesh.blocks {
        let line = format!("{}\n", cell_type(block.element, wedge));
        text.push_str(&line.repeat(block.len()));
    }
    data(&mut text, mesh, &fields, Location::Nodes, mesh.nodes.len());
    data(&mut text, mesh, &fields, Location::Elements, cells);
    Ok(text.into_bytes())
}

fn data(text: &mut String, mesh: &Mesh, fields: &[Field], location: Location, count: usize) {
    let fields: Vec<&Field> = fields.iter().filter(|f| f.location == location).collect();
    let flags = super::vtu_write::region_flags(mesh, location);
    if count == 0 || fields.len() + flags.len() == 0 {
        return;
    }
    let section = if location == Location::Nodes { "POINT_DATA" } else { "CELL_DATA" };
    let _ = writeln!(text, "{section} {count}\nFIELD FieldData {}", fields.len() + flags.len());
    for field in fields {
        let of = if matches!(field.values, Values::F64(_)) { "double" } else { "long" };
        let _ = writeln!(text, "{} {} {count} {of}", encoded(&field.name), field.components);
        text.push_str(&super::vtu_write::rows(&field.values, field.components));
    }
    for (name, flags) in flags {
        let _ = writeln!(text, "{} 1 {count} unsigned_char", encoded(&format!("{REGION_PREFIX}{name}")));
        flags.iter().for_each(|flag| {
            let _ = writeln!(text, "{flag}");
        });
    }
}

/// Names hold no blanks; VTK reads %20 as one.
fn encoded(name: &str) -> String {
    let mut out = String::new();
    for byte in name.bytes() {
        if byte.is_ascii_graphic() && !matches!(byte, b'%' | b'"') {
            out.push(char::from(byte));
        } else {
            let _ = write!(out, "%{byte:02X}");
        }
    }
    out
}
