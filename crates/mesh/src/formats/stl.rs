//! STL: triangles without topology. Vertices at the same place become one node.

use super::draft::{Draft, RegionKey};
use super::error::FormatError;
use super::kinds::{Kind, linear};
use super::stream::{Encoding, Endian, Scalar, Stream};
use crate::BoundingBox;
use crate::check::first_at_same_place;
use souple_elements::Family;

/// Bytes in front of the count of a binary file.
const HEADER: usize = 80;
/// Bytes of a triangle: normal, three vertices, two bytes of attributes.
const TRIANGLE: usize = 50;
/// Vertices of 32-bit numbers agree to about seven digits; relative to the size of the surface.
const WELD_TOLERANCE: f64 = 1e-7;

/// Whether the length is exactly what the count of a binary file says.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let Some(count) = bytes.get(HEADER..HEADER + 4).and_then(|b| b.try_into().ok()) else {
        return false;
    };
    let count = u64::from(u32::from_le_bytes(count));
    bytes.len() as u64 == HEADER as u64 + 4 + count * TRIANGLE as u64
}

/// Triangles as they stand in the file.
struct Soup {
    points: Vec<[f64; 3]>,
    /// First triangle of each named solid.
    solids: Vec<(String, usize)>,
    format: &'static str,
}

pub(super) fn read(bytes: &[u8]) -> Result<Draft, FormatError> {
    let text = !is_binary(bytes) && bytes.trim_ascii_start().starts_with(b"solid");
    // The draft checks the vertices; the welded nodes go into the draft that is returned.
    let mut check = Draft::new("", 0);
    let soup = if text { text_soup(bytes, &mut check)? } else { binary_soup(bytes, &mut check)? };
    let mut draft = Draft::new(soup.format, bytes.len());
    let diagonal = BoundingBox::around(&soup.points).map_or(0.0, |b| b.diagonal());
    let first = first_at_same_place(&soup.points, WELD_TOLERANCE * diagonal);
    let mut node_of = vec![0; soup.points.len()];
    for (at, &representative) in first.iter().enumerate() {
        if representative as usize == at {
            node_of[at] = draft.nodes.len() as u32;
            draft.nodes.push(soup.points[at]);
        } else {
            node_of[at] = node_of[representative as usize];
        }
    }
    draft.report.welded_nodes = soup.points.len() - draft.nodes.len();
    let element = linear(Family::Triangle);
    let kind = Kind { element, listed: 3, order: None, reduced_from: None };
    let mut solids = soup.solids.into_iter().peekable();
    let mut region: Option<RegionKey> = None;
    for (at, nodes) in node_of.chunks_exact(3).enumerate() {
        while let Some((name, _)) = solids.next_if(|(_, first)| *first <= at) {
            region = (!name.is_empty()).then(|| draft.region(&name));
        }
        if nodes[0] == nodes[1] || nodes[1] == nodes[2] || nodes[2] == nodes[0] {
            draft.report.skip("triangles", 1, "two corners are at the same place");
            continue;
        }
        let id = draft.element(&kind, nodes);
        if let Some(region) = region {
            draft.add_element(region, id);
        }
    }
    Ok(draft)
}

fn binary_soup(bytes: &[u8], check: &mut Draft) -> Result<Soup, FormatError> {
    let mut stream = Stream::new(bytes);
    stream.encoding = Encoding::Binary(Endian::Little);
    stream.take(HEADER, "the header of a binary STL file (80 bytes)")?;
    let count = stream.integer(Scalar::U32, "the number of triangles")? as u64;
    let count = stream.claim(count, 0, TRIANGLE, "triangles")?;
    for triangle in 0..count {
        stream.take(12, "the normal of a triangle")?;
        for corner in 0..3 {
            let [x, y, z] = [0; 3].map(|_| stream.float(Scalar::F32, "a coordinate"));
            check.node([x?, y?, z?], format_args!("{corner} of triangle {triangle}"), || stream.place())?;
        }
        stream.take(2, "the attributes of a triangle")?;
    }
    Ok(Soup { points: std::mem::take(&mut check.nodes), solids: Vec::new(), format: "STL, binary" })
}

/// `solid NAME`, then facets, of which only the vertices matter.
fn text_soup(bytes: &[u8], check: &mut Draft) -> Result<Soup, FormatError> {
    let mut stream = Stream::new(bytes);
    let mut solids = Vec::new();
    let mut ended = true;
    while let Some(line) = stream.full_line() {
        let line = String::from_utf8_lossy(line).into_owned();
        let mut words = line.split_ascii_whitespace();
        match words.next().map(str::to_ascii_lowercase).as_deref() {
            Some("solid") => {
                solids.push((words.collect::<Vec<_>>().join(" "), check.nodes.len() / 3));
                ended = false;
            }
            Some("vertex") => {
                let numbers: Option<Vec<f64>> = words.map(|w| w.parse().ok()).collect();
                let Some(&[x, y, z]) = numbers.as_deref() else {
                    return Err(stream.syntax("vertex x y z", &line));
                };
                let (triangle, corner) = (check.nodes.len() / 3, check.nodes.len() % 3);
                check.node([x, y, z], format_args!("{corner} of triangle {triangle}"), || stream.place())?;
            }
            Some("endfacet") if !check.nodes.len().is_multiple_of(3) => {
                return Err(stream.syntax("three vertices in a facet", &line));
            }
            Some("endsolid") => ended = true,
            Some("facet" | "endfacet" | "outer" | "endloop") | None => {}
            Some(_) => return Err(stream.syntax("facet, vertex or endsolid", &line)),
        }
    }
    if !ended || !check.nodes.len().is_multiple_of(3) {
        return Err(stream.truncated("endsolid"));
    }
    Ok(Soup { points: std::mem::take(&mut check.nodes), solids, format: "STL, text" })
}
