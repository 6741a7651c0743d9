//! MEDIT text (`.mesh`): a keyword, a count, and rows of numbers from 1 with an integer reference at the end.
//!
//! References become regions `reference_R_dimD`; where all of a dimension are 0, which is what programs write that
//! know none, there is no region.

use super::draft::{Draft, RegionKey};
use super::error::FormatError;
use super::kinds::medit_kind;
use super::stream::{Scalar, Stream};
use crate::ElementId;
use std::collections::BTreeMap;

/// What has a reference.
enum Item {
    Node(u32),
    Element(ElementId),
}

pub(super) fn read(bytes: &[u8]) -> Result<Draft, FormatError> {
    let mut reader = Reader {
        stream: Stream::new(bytes),
        draft: Draft::new("MEDIT, text", bytes.len()),
        dimension: 3,
        references: BTreeMap::new(),
    };
    let version = reader.word("MeshVersionFormatted")?;
    if version != "MeshVersionFormatted" {
        return Err(reader.stream.syntax("MeshVersionFormatted", version));
    }
    reader.integer("the version of the format")?;
    while let Some(keyword) = reader.keyword()? {
        match keyword {
            "Dimension" => reader.dimension()?,
            "Vertices" => reader.vertices()?,
            "End" => break,
            _ if medit_kind(keyword).is_some() => reader.elements(keyword)?,
            _ => reader.skip(keyword),
        }
    }
    reader.regions();
    Ok(reader.draft)
}

struct Reader<'a> {
    stream: Stream<'a>,
    draft: Draft,
    dimension: usize,
    /// Items by dimension and reference.
    references: BTreeMap<(usize, i64), Vec<Item>>,
}

impl<'a> Reader<'a> {
    /// The next word; what follows a # is a comment.
    fn word(&mut self, expected: &str) -> Result<&'a str, FormatError> {
        loop {
            let word = self.stream.word(expected)?;
            if !word.starts_with('#') {
                return Ok(word);
            }
            self.stream.at -= word.len();
            self.stream.line();
        }
    }

    fn integer(&mut self, expected: &str) -> Result<i64, FormatError> {
        let word = self.word(expected)?;
        word.parse().map_err(|_| self.stream.syntax(expected, word))
    }

    fn keyword(&mut self) -> Result<Option<&'a str>, FormatError> {
        if self.stream.bytes[self.stream.at..].iter().all(u8::is_ascii_whitespace) {
            return Ok(None);
        }
        match self.word("a keyword") {
            Ok(word) if word.starts_with(|c: char| c.is_ascii_alphabetic()) => Ok(Some(word)),
            Ok(word) => Err(self.stream.syntax("a keyword such as Vertices (is the count above right?)", word)),
            // A comment was the last thing in the file.
            Err(FormatError::Truncated { .. }) => Ok(None),
            Err(e) => Err(e),
        }
    }

    fn count(&mut self, what: &str, numbers: usize) -> Result<usize, FormatError> {
        let count = self.integer(&format!("the number of {what}"))?;
        let count = u64::try_from(count).map_err(|_| self.stream.syntax("a positive count", &count.to_string()))?;
        self.stream.claim(count, numbers, 0, what)
    }

    fn dimension(&mut self) -> Result<(), FormatError> {
        match self.integer("the dimension, 2 or 3")? {
            2 => self.dimension = 2,
            3 => self.dimension = 3,
            other => return Err(self.stream.syntax("the dimension, 2 or 3", &other.to_string())),
        }
        Ok(())
    }

    fn vertices(&mut self) -> Result<(), FormatError> {
        for _ in 0..self.count("vertices", self.dimension + 1)? {
            let mut position = [0.0; 3];
            for x in &mut position[..self.dimension] {
                *x = self.stream.float(Scalar::F64, "a coordinate")?;
            }
            let node = self.draft.nodes.len();
            self.draft.node(position, node + 1, || self.stream.place())?;
            let reference = self.integer("the reference of a vertex")?;
            self.references.entry((0, reference)).or_default().push(Item::Node(node as u32));
        }
        Ok(())
    }

    fn elements(&mut self, keyword: &str) -> Result<(), FormatError> {
        let Some(kind) = medit_kind(keyword) else {
            return Ok(());
        };
        let known = self.draft.nodes.len();
        let mut nodes = Vec::with_capacity(kind.listed);
        for row in 1..=self.count(keyword, kind.listed + 1)? {
            nodes.clear();
            for _ in 0..kind.listed {
                let node = self.integer("a node of an element")?;
                let at = usize::try_from(node).ok().filter(|&n| n >= 1 && n <= known);
                nodes.push(
                    at.ok_or_else(|| FormatError::OutOfRange {
                        place: self.stream.place(),
                        who: format!("element {row} of {keyword}"),
                        what: format!("vertex {node}"),
                        defined: format!("vertices 1 to {known}"),
                    })? as u32
                        - 1,
                );
            }
            let reference = self.integer("the reference of an element")?;
            let id = self.draft.element(&kind, &nodes);
            let of = (kind.element.dimension(), reference);
            self.references.entry(of).or_default().push(Item::Element(id));
        }
        Ok(())
    }

    /// Numbers after an unknown keyword belong to it.
    fn skip(&mut self, keyword: &str) {
        let shown: String = keyword.chars().take(40).collect();
        self.draft.report.ignore(shown);
        while self.stream.peek_word().is_some_and(|w| !w.starts_with(|c: char| c.is_ascii_alphabetic())) {
            if self.word("a number").is_err() {
                return;
            }
        }
    }

    fn regions(&mut self) {
        let references = std::mem::take(&mut self.references);
        for dimension in 0..=3 {
            let of = || references.iter().filter(move |((d, _), _)| *d == dimension);
            if of().all(|((_, reference), _)| *reference == 0) {
                continue;
            }
            for ((_, reference), items) in of() {
                let region: RegionKey = self.draft.region(&format!("reference_{reference}_dim{dimension}"));
                for item in items {
                    match *item {
                        Item::Node(node) => self.draft.add_node(region, node),
                        Item::Element(element) => self.draft.add_element(region, element),
                    }
                }
            }
        }
    }
}
