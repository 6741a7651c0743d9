//! Writing MSH.
//!
//! In version 4.1 the elements keep the order of the mesh, so an entity may come in several blocks; in 2.2 an element
//! of several regions is repeated, as Gmsh does.
//!
//! What MSH cannot say: that a region holds elements but not all of their nodes.

use super::super::error::FormatError;
use super::super::stream::{Encoding, Endian};
use super::POINT;
use super::entities::{Entities, entities};
use crate::{Block, BoundingBox, Mesh};
use std::fmt::Write as _;

/// Version and encoding of a written MSH file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MshVersion {
    /// 4.1, binary.
    #[default]
    V41Binary,
    /// 4.1, text.
    V41Text,
    /// 2.2, text: what the oldest programs read.
    V22Text,
}

/// Text or little-endian bytes.
struct Output {
    bytes: Vec<u8>,
    encoding: Encoding,
}

impl Output {
    fn text(&mut self, text: &str) {
        self.bytes.extend_from_slice(text.as_bytes());
    }

    fn int(&mut self, value: usize) {
        match self.encoding {
            Encoding::Text => self.text(&format!("{value} ")),
            Encoding::Binary(_) => self.bytes.extend_from_slice(&(value as i32).to_le_bytes()),
        }
    }

    fn size(&mut self, value: usize) {
        match self.encoding {
            Encoding::Text => self.text(&format!("{value} ")),
            Encoding::Binary(_) => self.bytes.extend_from_slice(&(value as u64).to_le_bytes()),
        }
    }

    fn double(&mut self, value: f64) {
        match self.encoding {
            Encoding::Text => self.text(&format!("{value:?} ")),
            Encoding::Binary(_) => self.bytes.extend_from_slice(&value.to_le_bytes()),
        }
    }

    /// Ends a row of text; nothing in binary.
    fn end_row(&mut self) {
        if self.encoding == Encoding::Text {
            self.bytes.pop_if(|b| *b == b' ');
            self.bytes.push(b'\n');
        }
    }

    /// Ends a section, on a line of its own.
    fn end(&mut self, section: &str) {
        if self.encoding != Encoding::Text {
            self.text("\n");
        }
        self.text(&format!("$End{section}\n"));
    }
}

/// Writes a mesh.
///
/// # Errors
///
/// [`FormatError::NotWritable`] for a region whose name MSH cannot hold.
pub fn write_msh(mesh: &Mesh, version: MshVersion) -> Result<Vec<u8>, FormatError> {
    let entities = entities(mesh)?;
    let (encoding, format) = match version {
        MshVersion::V41Binary => (Encoding::Binary(Endian::Little), "4.1 1 8"),
        MshVersion::V41Text => (Encoding::Text, "4.1 0 8"),
        MshVersion::V22Text => (Encoding::Text, "2.2 0 8"),
    };
    let mut out = Output { bytes: Vec::new(), encoding };
    out.text(&format!("$MeshFormat\n{format}\n"));
    if version == MshVersion::V41Binary {
        out.int(1);
    }
    out.end("MeshFormat");
    if !entities.names.is_empty() {
        out.text(&format!("$PhysicalNames\n{}\n", entities.names.len()));
        for (dimension, tag, name) in &entities.names {
            out.text(&format!("{dimension} {tag} \"{name}\"\n"));
        }
        out.text("$EndPhysicalNames\n");
    }
    if version == MshVersion::V22Text {
        write2(mesh, &entities, &mut out);
    } else {
        write_entities(mesh, &entities, &mut out);
        write_nodes(mesh, &entities, &mut out);
        write_elements(mesh, &entities, &mut out);
    }
    Ok(out.bytes)
}

/// Tags of an element's nodes, in Gmsh's order.
fn gmsh_nodes(block: &Block, index: usize) -> Vec<usize> {
    let nodes = block.nodes(index);
    let mut tags = vec![0; nodes.len()];
    for (i, &node) in nodes.iter().enumerate() {
        let at = block.element.exchange.gmsh_order.map_or(i, |p| p[i] as usize);
        tags[at] = node as usize + 1;
    }
    tags
}

fn write2(mesh: &Mesh, entities: &Entities, out: &mut Output) {
    let mut text = format!("$Nodes\n{}\n", mesh.nodes.len());
    for (i, [x, y, z]) in mesh.nodes.iter().enumerate() {
        let _ = writeln!(text, "{} {x:?} {y:?} {z:?}", i + 1);
    }
    text.push_str("$EndNodes\n$Elements\n");
    let mut count = 0;
    let mut rows = String::new();
    let mut element = |number: i64, dimension: usize, entity: usize, nodes: &[usize]| {
        let groups = &entities.groups[dimension][entity - 1];
        // Group 0 is none.
        for group in if groups.is_empty() { &[0][..] } else { groups } {
            count += 1;
            let _ = write!(rows, "{count} {number} 2 {group} {entity}");
            nodes.iter().for_each(|node| {
                let _ = write!(rows, " {node}");
            });
            rows.push('\n');
        }
    };
    for (&entity, nodes) in &entities.points {
        nodes.iter().for_each(|&node| element(POINT, 0, entity, &[node as usize + 1]));
    }
    for (block, of) in mesh.blocks.iter().zip(&entities.elements) {
        let (number, dimension) = (i64::from(block.element.exchange.gmsh), block.element.dimension());
        for (index, &entity) in of.iter().enumerate() {
            element(number, dimension, entity, &gmsh_nodes(block, index));
        }
    }
    let _ = write!(text, "{count}\n{rows}$EndElements\n");
    out.text(&text);
}

fn write_entities(mesh: &Mesh, entities: &Entities, out: &mut Output) {
    let bounds = BoundingBox::around(&mesh.nodes).unwrap_or(BoundingBox { min: [0.0; 3], max: [0.0; 3] });
    let bare = entities.groups.iter().all(Vec::is_empty);
    out.text("$Entities\n");
    // The nodes need an entity even where there is no element.
    out.size(if bare { 1 } else { entities.groups[0].len() });
    entities.groups[1..].iter().for_each(|of| out.size(of.len()));
    out.end_row();
    let none = Vec::new();
    for (dimension, of) in entities.groups.iter().enumerate() {
        for (tag, groups) in
            of.iter().chain((bare && dimension == 0).then_some(&none)).enumerate().map(|(i, g)| (i + 1, g))
        {
            out.int(tag);
            if dimension == 0 {
                let node = entities.points.get(&tag).and_then(|nodes| nodes.first()).map_or(0, |&n| n as usize);
                mesh.nodes.get(node).copied().unwrap_or_default().iter().for_each(|&x| out.double(x));
            } else {
                bounds.min.iter().chain(&bounds.max).for_each(|&x| out.double(x));
            }
            out.size(groups.len());
            groups.iter().for_each(|&group| out.int(group));
            if dimension > 0 {
                out.size(0);
            }
            out.end_row();
        }
    }
    out.end("Entities");
}

/// All nodes in one block, which is all that some readers understand, on an entity of the highest dimension.
fn write_nodes(mesh: &Mesh, entities: &Entities, out: &mut Output) {
    let dimension = entities.groups.iter().rposition(|of| !of.is_empty()).unwrap_or(0);
    let count = mesh.nodes.len();
    out.text("$Nodes\n");
    [1, count, count.min(1), count].into_iter().for_each(|n| out.size(n));
    out.end_row();
    [dimension, 1, 0].into_iter().for_each(|n| out.int(n));
    out.size(count);
    out.end_row();
    for tag in 1..=count {
        out.size(tag);
        out.end_row();
    }
    for position in &mesh.nodes {
        position.iter().for_each(|&x| out.double(x));
        out.end_row();
    }
    out.end("Nodes");
}

/// Consecutive elements of one block and one entity.
struct Run {
    block: usize,
    entity: usize,
    elements: std::ops::Range<usize>,
}

fn runs(entities: &Entities) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (block, of) in entities.elements.iter().enumerate() {
        for (index, &entity) in of.iter().enumerate() {
            match runs.last_mut().filter(|r| r.block == block && r.entity == entity) {
                Some(run) => run.elements.end = index + 1,
                None => runs.push(Run { block, entity, elements: index..index + 1 }),
            }
        }
    }
    runs
}

fn write_elements(mesh: &Mesh, entities: &Entities, out: &mut Output) {
    let runs = runs(entities);
    let points: usize = entities.points.values().map(Vec::len).sum();
    let total = points + runs.iter().map(|r| r.elements.len()).sum::<usize>();
    out.text("$Elements\n");
    [entities.points.len() + runs.len(), total, total.min(1), total].into_iter().for_each(|n| out.size(n));
    out.end_row();
    let head = |out: &mut Output, dimension: usize, entity: usize, number: usize, count: usize| {
        [dimension, entity, number].into_iter().for_each(|n| out.int(n));
        out.size(count);
        out.end_row();
    };
    let mut tag = 0;
    let mut row = |out: &mut Output, nodes: &[usize]| {
        tag += 1;
        out.size(tag);
        nodes.iter().for_each(|&n| out.size(n));
        out.end_row();
    };
    for (&entity, nodes) in &entities.points {
        head(out, 0, entity, POINT as usize, nodes.len());
        nodes.iter().for_each(|&n| row(out, &[n as usize + 1]));
    }
    for run in runs {
        let block = &mesh.blocks[run.block];
        let number = block.element.exchange.gmsh as usize;
        head(out, block.element.dimension(), run.entity, number, run.elements.len());
        run.elements.for_each(|index| row(out, &gmsh_nodes(block, index)));
    }
    out.end("Elements");
}
