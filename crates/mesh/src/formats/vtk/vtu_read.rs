//! Reading VTU.
//!
//! Appended raw data makes a file that is not XML; the part in front of it, closed by hand, is.

use super::arrays::{self, Array};
use super::cells::{self, CellMap, Cells};
use super::vtu_data::{Appended, Storage};
use crate::Mesh;
use crate::formats::draft::Draft;
use crate::formats::error::{FormatError, Place};
use crate::formats::field::{Field, Location, Values};
use crate::formats::report::ImportReport;
use crate::formats::stream::{Endian, Scalar};
use crate::formats::{CompleteElements, ReadOptions};
use roxmltree::Node;

/// What a file holds before the steps that are common to all formats.
struct Contents {
    draft: Draft,
    map: CellMap,
    arrays: Vec<Array>,
}

pub(in crate::formats) fn read(bytes: &[u8]) -> Result<Draft, FormatError> {
    let mut contents = contents(bytes)?;
    for array in &contents.arrays {
        arrays::regions(&mut contents.draft, &contents.map, array);
    }
    Ok(contents.draft)
}

/// Reads a VTU file with its point and cell data.
///
/// Fields are in the order of the mesh that is returned; arrays that are our own regions are not among them.
///
/// # Errors
///
/// As [`crate::formats::read`].
pub fn read_vtu_with_fields(
    bytes: &[u8],
    options: ReadOptions<'_>,
) -> Result<(Mesh, Vec<Field>, ImportReport), FormatError> {
    let complete: CompleteElements = options.complete;
    let mut contents = contents(bytes)?;
    for array in &contents.arrays {
        arrays::regions(&mut contents.draft, &contents.map, array);
    }
    let finished = contents.draft.finish(complete)?;
    let fields = arrays::fields(&finished, &contents.map, contents.arrays);
    Ok((finished.mesh, fields, finished.report))
}

fn find(bytes: &[u8], needle: &[u8]) -> Option<usize> {
    bytes.windows(needle.len()).position(|w| w == needle)
}

/// The XML in front of the appended data, and that data.
fn split(bytes: &[u8]) -> Result<(String, Option<Appended<'_>>), FormatError> {
    let text = |bytes: &[u8]| match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.trim_start_matches('\u{feff}').to_owned()),
        Err(e) => Err(FormatError::Syntax {
            place: Place::Byte(e.valid_up_to()),
            expected: "text in UTF-8".to_owned(),
            found: "other bytes".to_owned(),
        }),
    };
    let Some(tag) = find(bytes, b"<AppendedData") else {
        return Ok((text(bytes)?, None));
    };
    let mut head = text(&bytes[..tag])?;
    head.push_str("</VTKFile>");
    let truncated = || FormatError::Truncated { place: Place::Byte(bytes.len()), expected: "appended data".to_owned() };
    let open = tag + find(&bytes[tag..], b">").ok_or_else(truncated)? + 1;
    let start = open + find(&bytes[open..], b"_").ok_or_else(truncated)? + 1;
    let close = b"</AppendedData";
    let end = bytes[start..].windows(close.len()).rposition(|w| w == close).map_or(bytes.len(), |at| start + at);
    let raw = !String::from_utf8_lossy(&bytes[tag..open]).contains("base64");
    let data = if raw { &bytes[start..end] } else { bytes[start..end].trim_ascii_end() };
    Ok((head, Some(Appended { raw, data, at: start })))
}

fn contents(bytes: &[u8]) -> Result<Contents, FormatError> {
    let (head, appended) = split(bytes)?;
    let document = roxmltree::Document::parse(&head).map_err(|e| FormatError::Syntax {
        place: Place::Line(e.pos().row as usize),
        expected: "well-formed XML".to_owned(),
        found: e.to_string(),
    })?;
    let root = document.root_element();
    let unsupported =
        |what: String, advice: &str| FormatError::Unsupported { place: line_of(root), what, advice: advice.to_owned() };
    let kind = root.attribute("type").unwrap_or("none");
    let grid = child(root, "UnstructuredGrid");
    let (true, Some(grid)) = (kind == "UnstructuredGrid", grid) else {
        return Err(unsupported(format!("a VTK file of type {kind}"), "save it as an unstructured grid (.vtu)"));
    };
    let zlib = match root.attribute("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => return Err(unsupported(format!("compressor {other}"), "save it with zlib or uncompressed")),
    };
    let header = match root.attribute("header_type") {
        Some("UInt64") => Scalar::U64,
        _ => Scalar::U32,
    };
    let endian = if root.attribute("byte_order") == Some("BigEndian") { Endian::Big } else { Endian::Little };
    let encoding = match &appended {
        Some(a) if a.raw => "appended raw",
        Some(_) => "appended base64",
        None => "inline",
    };
    let format = format!("VTU, {encoding}{}", if zlib { ", zlib" } else { "" });
    let version = root.attribute("version").unwrap_or("0.1");
    let mut numbers = version.split('.').map(|n| n.parse::<u32>().unwrap_or(0));
    let version = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
    let mut reader = Reader {
        storage: Storage { appended, header, endian, zlib, budget: Storage::budget_of(bytes.len()) },
        contents: Contents { draft: Draft::new(format, bytes.len()), map: CellMap::default(), arrays: Vec::new() },
        old_lagrange: version < (2, 2),
    };
    for piece in grid.children().filter(|n| n.has_tag_name("Piece")) {
        reader.piece(piece)?;
    }
    Ok(reader.contents)
}

fn line_of(node: Node<'_, '_>) -> Place {
    Place::Line(node.document().text_pos_at(node.range().start).row as usize)
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|n| n.has_tag_name(name))
}

struct Reader<'a> {
    storage: Storage<'a>,
    contents: Contents,
    old_lagrange: bool,
}

impl Reader<'_> {
    fn piece(&mut self, piece: Node<'_, '_>) -> Result<(), FormatError> {
        let count = |name: &str| {
            let value = piece.attribute(name);
            value.and_then(|v| v.trim().parse::<usize>().ok()).ok_or_else(|| FormatError::Syntax {
                place: line_of(piece),
                expected: format!("{name}=\"a count\" of the piece"),
                found: format!("\"{}\"", value.unwrap_or("none")),
            })
        };
        let (points, cell_count) = (count("NumberOfPoints")?, count("NumberOfCells")?);
        let first_node = self.contents.draft.nodes.len();
        let first_cell = self.contents.map.len();
        self.points(piece, points)?;
        if cell_count > 0 {
            let cells = self.cells(piece, cell_count)?;
            let place = || child(piece, "Cells").map_or(Place::File, line_of);
            let range = (first_node, points);
            cells::add(&mut self.contents.draft, &mut self.contents.map, &cells, range, &place)?;
        }
        self.data(piece, "PointData", Location::Nodes, first_node, points)?;
        self.data(piece, "CellData", Location::Elements, first_cell, cell_count)
    }

    fn points(&mut self, piece: Node<'_, '_>, count: usize) -> Result<(), FormatError> {
        let array = child(piece, "Points").and_then(|p| child(p, "DataArray"));
        let values = match array {
            Some(array) => self.checked(array, "the points", count, 3)?,
            None if count == 0 => return Ok(()),
            None => return Err(missing(piece, "<Points> with a <DataArray>")),
        };
        let place = || array.map_or(Place::File, line_of);
        let values = match values {
            Values::F64(v) => v,
            Values::I64(v) => v.into_iter().map(|x| x as f64).collect(),
        };
        for x in values.chunks_exact(3) {
            let name = self.contents.draft.nodes.len();
            self.contents.draft.node([x[0], x[1], x[2]], name, place)?;
        }
        Ok(())
    }

    /// An array that must hold `count × components` numbers.
    fn checked(
        &mut self,
        array: Node<'_, '_>,
        what: &str,
        count: usize,
        components: usize,
    ) -> Result<Values, FormatError> {
        let values = self.storage.array(array, what)?;
        if count.checked_mul(components) == Some(values.len()) {
            return Ok(values);
        }
        Err(FormatError::Count {
            place: line_of(array),
            what: format!("values of {components} numbers in {what}"),
            said: count as u64,
            found: format!("there are {} numbers", values.len()),
        })
    }

    fn cells(&mut self, piece: Node<'_, '_>, count: usize) -> Result<Cells, FormatError> {
        let node = child(piece, "Cells").ok_or_else(|| missing(piece, "<Cells>"))?;
        let named = |name: &str| {
            node.children()
                .find(|n| n.has_tag_name("DataArray") && n.attribute("Name") == Some(name))
                .ok_or_else(|| missing(node, &format!("<DataArray Name=\"{name}\">")))
        };
        let whole = |values: Values, name: &str| match values {
            Values::I64(v) => Ok(v),
            Values::F64(_) => Err(missing(node, &format!("integers in \"{name}\""))),
        };
        let connectivity = whole(self.storage.array(named("connectivity")?, "the connectivity")?, "connectivity")?;
        let ends = whole(self.checked(named("offsets")?, "the cell offsets", count, 1)?, "offsets")?;
        let types = whole(self.checked(named("types")?, "the cell types", count, 1)?, "types")?;
        Ok(Cells { types, ends, connectivity, old_lagrange: self.old_lagrange })
    }

    fn data(
        &mut self,
        piece: Node<'_, '_>,
        section: &str,
        location: Location,
        first: usize,
        count: usize,
    ) -> Result<(), FormatError> {
        let Some(section) = child(piece, section) else {
            return Ok(());
        };
        for node in section.children().filter(Node::is_element) {
            let name = node.attribute("Name").unwrap_or("unnamed").to_owned();
            let numbers = node.has_tag_name("DataArray") && !matches!(node.attribute("type"), Some("String" | "Bit"));
            if !numbers {
                self.contents.draft.report.ignore(format!("array {name} (not numbers)"));
                continue;
            }
            let components = node.attribute("NumberOfComponents").and_then(|c| c.trim().parse().ok()).unwrap_or(1);
            let values = self.checked(node, &format!("array \"{name}\""), count, components)?;
            self.contents.arrays.push(Array { name, components, location, first, values });
        }
        Ok(())
    }
}

fn missing(node: Node<'_, '_>, expected: &str) -> FormatError {
    FormatError::Syntax {
        place: line_of(node),
        expected: expected.to_owned(),
        found: format!("a <{}> without it", node.tag_name().name()),
    }
}
