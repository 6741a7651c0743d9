//! Gmsh's MSH: sections between `$Name` and `$EndName`, numbers in text or binary.
//!
//! Version 2 lists elements one by one, each with its group; version 4.1 lists them by geometric entity, and the
//! entity has the groups. Physical groups become regions of their name, or `physical_TAG_dimD` without one.

mod entities;
mod read2;
mod read4;
mod write;

pub use write::{MshVersion, write_msh};

use super::draft::{Draft, Numbering, RegionKey};
use super::error::{FormatError, Place};
use super::kinds::Kind;
use super::stream::{Encoding, Endian, Stream};
use std::collections::HashMap;

/// Gmsh's number of the element that is a single point.
const POINT: i64 = 15;

/// Name of the group that we write for elements of no region, and do not read as one.
///
/// Gmsh saves only what is in a group once there is one, and meshio wants every entity or none to have one.
const NO_REGION: &str = "(no region)";

/// A file while it is read.
struct Reader<'a> {
    stream: Stream<'a>,
    draft: Draft,
    /// Node tags.
    nodes: Numbering,
    /// Names of the physical groups, by dimension and tag.
    names: HashMap<(i64, i64), String>,
    /// Groups of the geometric entities, by dimension and tag (version 4).
    entities: HashMap<(i64, i64), Groups>,
}

/// The groups of an entity.
#[derive(Clone, Default)]
struct Groups {
    regions: Vec<RegionKey>,
    /// Every group holds the entity reversed.
    reversed: bool,
}

pub(super) fn read(bytes: &[u8]) -> Result<Draft, FormatError> {
    let mut reader = Reader {
        stream: Stream::new(bytes),
        draft: Draft::new("Gmsh MSH", bytes.len()),
        nodes: Numbering::new(),
        names: HashMap::new(),
        entities: HashMap::new(),
    };
    let mut version = None;
    while let Some(line) = reader.stream.full_line() {
        let line = String::from_utf8_lossy(line);
        let Some(section) = line.strip_prefix('$') else {
            return Err(reader.stream.syntax("a section such as $Nodes", &line));
        };
        match (section, version) {
            ("MeshFormat", _) => version = Some(reader.format()?),
            ("PhysicalNames", Some(_)) => reader.physical_names()?,
            ("Nodes", Some(2)) => reader.nodes2()?,
            ("Elements", Some(2)) => reader.elements2()?,
            ("Entities", Some(4)) => reader.entities4()?,
            ("PartitionedEntities", Some(4)) => reader.partitioned_entities4()?,
            ("Nodes", Some(4)) => reader.nodes4()?,
            ("Elements", Some(4)) => reader.elements4()?,
            ("Nodes" | "Elements" | "Entities" | "PhysicalNames", None) => {
                return Err(reader.stream.syntax("$MeshFormat before any other section", &line));
            }
            _ => reader.skip(section)?,
        }
    }
    if version.is_none() {
        return Err(reader.stream.truncated("$MeshFormat"));
    }
    Ok(reader.draft)
}

impl Reader<'_> {
    /// Version, encoding, size of a number, and in binary a 1 that tells the order of bytes.
    fn format(&mut self) -> Result<u32, FormatError> {
        let version = self.stream.word("the version of the format")?;
        let unsupported = |what: String, place: Place| FormatError::Unsupported {
            place,
            what,
            advice: "save it from Gmsh with Mesh.MshFileVersion = 4.1 or 2.2".to_owned(),
        };
        let major = match version {
            v if v == "2" || v.starts_with("2.") => 2,
            "4.1" => 4,
            _ => return Err(unsupported(format!("MSH version {version}"), self.stream.place())),
        };
        let binary = self.stream.int("0 (text) or 1 (binary)")?;
        let size = self.stream.int("the size of a number, 8")?;
        if size != 8 {
            return Err(unsupported(format!("a size of numbers of {size} bytes"), self.stream.place()));
        }
        let mut encoding = "text";
        if binary != 0 {
            self.stream.line();
            let one = self.stream.take(4, "the number 1 in binary")?;
            self.stream.encoding = Encoding::Binary(match one {
                [1, 0, 0, 0] => Endian::Little,
                [0, 0, 0, 1] => Endian::Big,
                _ => return Err(self.stream.syntax("the number 1 in binary", &format!("{one:?}"))),
            });
            encoding = "binary";
        }
        self.draft.report.format = format!("Gmsh MSH {version}, {encoding}");
        self.end("MeshFormat")?;
        Ok(major)
    }

    /// Reads the line that closes a section.
    fn end(&mut self, section: &str) -> Result<(), FormatError> {
        let expected = format!("$End{section}");
        match self.stream.full_line() {
            Some(line) if line == expected.as_bytes() => Ok(()),
            Some(line) => {
                let found = String::from_utf8_lossy(line).into_owned();
                Err(self.stream.syntax(&format!("{expected} (the section holds more than it says)"), &found))
            }
            None => Err(self.stream.truncated(&expected)),
        }
    }

    /// Steps over a section whose content is not known.
    fn skip(&mut self, section: &str) -> Result<(), FormatError> {
        let end = format!("$End{section}");
        let rest = &self.stream.bytes[self.stream.at..];
        let Some(found) = rest.windows(end.len()).position(|w| w == end.as_bytes()) else {
            return Err(self.stream.truncated(&end));
        };
        self.stream.at += found + end.len();
        let shown: String = section.chars().take(40).collect();
        self.draft.report.ignore(format!("${shown}"));
        Ok(())
    }

    /// `dimension tag "name"`, in text whatever the encoding of the rest.
    fn physical_names(&mut self) -> Result<(), FormatError> {
        let encoding = std::mem::replace(&mut self.stream.encoding, Encoding::Text);
        let count = self.stream.size("the number of physical names")?;
        let count = self.stream.claim(count, 3, 0, "physical names")?;
        self.stream.line();
        for _ in 0..count {
            let Some(line) = self.stream.full_line() else {
                return Err(self.stream.truncated("a physical name"));
            };
            let line = String::from_utf8_lossy(line);
            let mut words = line.splitn(3, char::is_whitespace);
            let mut number = || words.next().and_then(|w| w.parse::<i64>().ok());
            let (dimension, tag) = (number(), number());
            let name = words.next().map(|n| n.trim().trim_matches('"'));
            let (Some(dimension), Some(tag), Some(name)) = (dimension, tag, name) else {
                return Err(self.stream.syntax("dimension, tag and \"name\" of a physical group", &line));
            };
            // A group without elements is still a region: selecting it then says that it is empty.
            if name != NO_REGION {
                self.draft.region(name);
            }
            self.names.insert((dimension, tag), name.to_owned());
        }
        self.end("PhysicalNames")?;
        self.stream.encoding = encoding;
        Ok(())
    }

    /// The region of a physical group; the sign of the tag is the orientation.
    fn group(&mut self, dimension: i64, tag: i64) -> Option<RegionKey> {
        let tag = tag.saturating_abs();
        match self.names.get(&(dimension, tag)) {
            Some(name) if name == NO_REGION => None,
            Some(name) => Some(self.draft.region(name)),
            None => Some(self.draft.region(&format!("physical_{tag}_dim{dimension}"))),
        }
    }

    fn add_node(&mut self, tag: i64, position: [f64; 3]) -> Result<(), FormatError> {
        if !self.nodes.push(tag) {
            return Err(FormatError::Repeated { place: self.stream.place(), what: "node", id: tag });
        }
        self.draft.node(position, tag, || self.stream.place())
    }

    /// The position of a node in the mesh.
    fn node(&self, tag: i64, element: i64, kind: &str) -> Result<u32, FormatError> {
        self.nodes.get(tag).ok_or_else(|| FormatError::OutOfRange {
            place: self.stream.place(),
            who: format!("element {element} ({kind})"),
            what: format!("node {tag}"),
            defined: self.nodes.described("nodes"),
        })
    }

    fn unknown(&self, number: i64) -> FormatError {
        FormatError::UnknownElement {
            place: self.stream.place(),
            format: "Gmsh",
            element: number.to_string(),
            advice: "the file is damaged, or written by a newer Gmsh; save it again".to_owned(),
        }
    }

    /// The numbers of the next line, which must be `count` (at least, when `more`).
    fn row(&mut self, numbers: &mut Vec<i64>, what: &str) -> Result<(), FormatError> {
        numbers.clear();
        let Some(line) = self.stream.full_line() else {
            return Err(self.stream.truncated(what));
        };
        for word in line.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty()) {
            let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
            numbers.push(number.ok_or_else(|| self.stream.syntax(what, &String::from_utf8_lossy(line)))?);
        }
        Ok(())
    }

    /// Notes elements that Gmsh knows and the registry does not.
    fn skip_elements(&mut self, number: i64, nodes: usize, count: usize) {
        self.draft.report.skip(&format!("Gmsh type {number} ({nodes} nodes)"), count, "no such element here");
    }
}

/// What to call a kind in a message.
fn called(kind: &Kind) -> &'static str {
    kind.reduced_from.unwrap_or(kind.element.id)
}
