//! Wavefront OBJ: vertices, faces and lines; groups, objects and materials become regions.
//!
//! An index counts from 1, or back from the latest vertex when it is negative.

use super::draft::{Draft, RegionKey};
use super::error::FormatError;
use super::kinds::{Kind, linear};
use super::polygon;
use super::stream::{Stream, parse_float};
use souple_elements::Family;

/// What the faces that follow belong to.
#[derive(Default)]
struct Current {
    object: Option<RegionKey>,
    groups: Vec<RegionKey>,
    material: Option<RegionKey>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Draft, FormatError> {
    let mut stream = Stream::new(bytes);
    let mut draft = Draft::new("OBJ", bytes.len());
    let mut current = Current::default();
    let mut text = String::new();
    while let Some(line) = stream.full_line() {
        text.push_str(&String::from_utf8_lossy(line));
        if text.ends_with('\\') {
            text.pop();
            continue;
        }
        statement(&stream, &mut draft, &mut current, text.split('#').next().unwrap_or(""))?;
        text.clear();
    }
    if text.is_empty() { Ok(draft) } else { Err(stream.truncated("the continuation of the last line")) }
}

fn statement(stream: &Stream<'_>, draft: &mut Draft, current: &mut Current, text: &str) -> Result<(), FormatError> {
    let mut words = text.split_ascii_whitespace();
    match words.next() {
        None => {}
        Some("v") => {
            // A weight or a colour may follow.
            let numbers: Option<Vec<f64>> = words.take(3).map(parse_float).collect();
            let Some(&[x, y, z]) = numbers.as_deref() else {
                return Err(stream.syntax("v x y z", text));
            };
            let name = draft.nodes.len() + 1;
            draft.node([x, y, z], name, || stream.place())?;
        }
        Some(keyword @ ("f" | "l")) => {
            let corners: Vec<u32> = words.map(|w| corner(stream, draft, w, keyword)).collect::<Result<_, _>>()?;
            let ids = if keyword == "f" {
                polygon::add(draft, &corners)
            } else {
                let kind = Kind { element: linear(Family::Edge), listed: 2, order: None, reduced_from: None };
                corners.windows(2).map(|ends| draft.element(&kind, ends)).collect()
            };
            let regions = current.object.iter().chain(&current.groups).chain(&current.material);
            draft.claim_memberships(ids.len().saturating_mul(current.groups.len() + 2))?;
            for &region in regions {
                ids.iter().for_each(|&id| draft.add_element(region, id));
            }
        }
        Some("o") => current.object = name(words).map(|n| draft.region(&n)),
        Some("g") => {
            current.groups = words.filter(|w| *w != "default").map(|w| draft.region(w)).collect();
            current.groups.sort_unstable();
            current.groups.dedup();
        }
        Some("usemtl") => current.material = name(words).map(|n| draft.region(&format!("material_{n}"))),
        Some(other) => draft.report.ignore(other.chars().take(40).collect()),
    }
    Ok(())
}

fn name<'w>(words: impl Iterator<Item = &'w str>) -> Option<String> {
    Some(words.collect::<Vec<_>>().join(" ")).filter(|n| !n.is_empty())
}

/// The vertex of `v`, `v/t`, `v//n` or `v/t/n`.
fn corner(stream: &Stream<'_>, draft: &Draft, word: &str, keyword: &str) -> Result<u32, FormatError> {
    let known = draft.nodes.len();
    let index: Option<i64> = word.split('/').next().and_then(|w| w.parse().ok());
    let Some(index) = index else {
        return Err(stream.syntax("a vertex number", word));
    };
    let at = if index < 0 { index.saturating_add(known as i64) } else { index - 1 };
    u32::try_from(at).ok().filter(|&at| (at as usize) < known).ok_or_else(|| FormatError::OutOfRange {
        place: stream.place(),
        who: if keyword == "f" { "a face".to_owned() } else { "a line".to_owned() },
        what: format!("vertex {index}"),
        defined: format!("{known} vertices before it"),
    })
}
