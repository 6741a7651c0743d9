//! Reading: first everything as it stands, then the references, because Abaqus lets elements come before nodes.

use super::lines::{Keyword, Lines, fields};
use super::sets::{Set, Sets};
use crate::ElementId;
use crate::formats::Include;
use crate::formats::draft::{Draft, Numbering};
use crate::formats::error::{FormatError, Place};
use crate::formats::kinds::{Kind, abaqus_kind};
use crate::formats::stream::parse_float;

/// Files may include files, but not without end.
const DEEPEST_INCLUDE: usize = 8;
const MOST_INCLUDES: usize = 1000;

/// Keywords that change which nodes and elements there are, or where.
const GENERATORS: [&str; 9] =
    ["NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "TRANSFORM MESH", "SUBSTRUCTURE PATH"];

/// An element as it stands in the file.
struct Listed {
    id: i64,
    kind: usize,
    /// Its first node in `Reader::element_nodes`.
    first: usize,
    place: PlaceMark,
}

/// A line of a file, small enough to be kept for every element.
#[derive(Clone, Copy)]
struct PlaceMark {
    file: u32,
    line: u32,
}

pub(super) struct Reader<'i> {
    draft: Draft,
    nodes: Numbering,
    kinds: Vec<(String, Kind)>,
    elements: Vec<Listed>,
    element_nodes: Vec<i64>,
    sets: Sets,
    include: Option<Include<'i>>,
    included: usize,
    files: Vec<String>,
}

pub(in crate::formats) fn read(bytes: &[u8], include: Option<Include<'_>>) -> Result<Draft, FormatError> {
    let mut reader = Reader {
        draft: Draft::new("Abaqus input", bytes.len()),
        nodes: Numbering::new(),
        kinds: Vec::new(),
        elements: Vec::new(),
        element_nodes: Vec::new(),
        sets: Sets::default(),
        include,
        included: 0,
        files: vec![String::new()],
    };
    reader.file(&mut Lines::new(bytes, None), 0)?;
    let elements = reader.resolve_elements()?;
    let Reader { mut draft, nodes, sets, .. } = reader;
    sets.regions(&mut draft, &nodes, &elements)?;
    Ok(draft)
}

/// The elements that were read, by their ids in the file.
pub(super) struct Elements {
    pub(super) numbering: Numbering,
    pub(super) ids: Vec<ElementId>,
}

impl Reader<'_> {
    fn file(&mut self, lines: &mut Lines<'_>, depth: usize) -> Result<(), FormatError> {
        while let Some(keyword) = lines.keyword()? {
            match keyword.name.as_str() {
                "NODE" => self.with_input(lines, &keyword, depth, Self::nodes)?,
                "ELEMENT" => self.with_input(lines, &keyword, depth, Self::elements)?,
                "NSET" => self.set(lines, &keyword, Set::Nodes)?,
                "ELSET" => self.set(lines, &keyword, Set::Elements)?,
                "INCLUDE" => {
                    let name = keyword.get("INPUT").unwrap_or_default().to_owned();
                    let bytes = self.included(&name, depth, lines.place())?;
                    self.file(&mut Lines::new(&bytes, Some(name)), depth + 1)?;
                }
                name if GENERATORS.contains(&name) => {
                    return Err(FormatError::Unsupported {
                        place: lines.place(),
                        what: format!("*{name}, which makes or moves nodes or elements,"),
                        advice: "write the mesh with all nodes and elements listed".to_owned(),
                    });
                }
                name => {
                    self.draft.report.ignore(format!("*{name}"));
                    while lines.data().is_some() {}
                }
            }
        }
        Ok(())
    }

    fn included(&mut self, name: &str, depth: usize, place: Place) -> Result<Vec<u8>, FormatError> {
        let refuse = |place, why: &str| FormatError::Include { place, name: name.to_owned(), why: why.to_owned() };
        self.included += 1;
        if depth >= DEEPEST_INCLUDE || self.included > MOST_INCLUDES {
            return Err(refuse(place, "files include each other too often"));
        }
        match &mut self.include {
            None => Err(refuse(place, "no source of included files was given")),
            Some(include) => include(name).map_err(|why| refuse(place, &why)),
        }
    }

    /// Data of a keyword stands below it, or in the file that INPUT names.
    fn with_input(
        &mut self,
        lines: &mut Lines<'_>,
        keyword: &Keyword,
        depth: usize,
        read: fn(&mut Self, &mut Lines<'_>, &Keyword) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        if let Some(name) = keyword.get("INPUT") {
            let bytes = self.included(name, depth, lines.place())?;
            read(self, &mut Lines::new(&bytes, Some(name.to_owned())), keyword)?;
        }
        read(self, lines, keyword)
    }

    fn nodes(&mut self, lines: &mut Lines<'_>, keyword: &Keyword) -> Result<(), FormatError> {
        if let Some(system) = keyword.get("SYSTEM").filter(|s| !s.eq_ignore_ascii_case("R") && !s.is_empty()) {
            return Err(FormatError::Unsupported {
                place: lines.place(),
                what: format!("*NODE in coordinates SYSTEM={system}"),
                advice: "write rectangular coordinates".to_owned(),
            });
        }
        let set = keyword.get("NSET").map(|name| self.sets.named(name, Set::Nodes));
        while let Some(data) = lines.data() {
            let text = String::from_utf8_lossy(data);
            let mut words = text.split(',').map(str::trim);
            let expected = "a node: id, x, y, z";
            let id: i64 = words.next().and_then(|w| w.parse().ok()).ok_or_else(|| lines.syntax(expected, &text))?;
            let mut position = [0.0; 3];
            for (x, word) in position.iter_mut().zip(words.by_ref()).filter(|(_, word)| !word.is_empty()) {
                *x = parse_float(word).ok_or_else(|| lines.syntax(expected, &text))?;
            }
            if !self.nodes.push(id) {
                return Err(FormatError::Repeated { place: lines.place(), what: "node", id });
            }
            self.draft.node(position, id, || lines.place())?;
            if let Some(set) = set {
                self.sets.add_id(set, id);
            }
        }
        Ok(())
    }

    fn elements(&mut self, lines: &mut Lines<'_>, keyword: &Keyword) -> Result<(), FormatError> {
        let Some(name) = keyword.get("TYPE").map(str::to_ascii_uppercase).filter(|n| !n.is_empty()) else {
            return Err(lines.syntax("TYPE= in *ELEMENT", "none"));
        };
        let set = keyword.get("ELSET").map(|name| self.sets.named(name, Set::Elements));
        let Some(kind) = abaqus_kind(&name) else {
            return self.skip_elements(lines, &name);
        };
        let listed = kind.listed;
        let at = self.kinds.iter().position(|(n, _)| *n == name).unwrap_or_else(|| {
            self.kinds.push((name.clone(), kind));
            self.kinds.len() - 1
        });
        let mut numbers: Vec<i64> = Vec::with_capacity(listed + 1);
        let mut place = self.mark(lines);
        while let Some(data) = lines.data() {
            if numbers.is_empty() {
                place = self.mark(lines);
            }
            let text = String::from_utf8_lossy(data);
            for word in text.split(',').map(str::trim).filter(|w| !w.is_empty()) {
                numbers.push(word.parse().map_err(|_| lines.syntax("an element: id and nodes", &text))?);
            }
            if numbers.len() > listed + 1 {
                return Err(self.wrong_count(lines.place(), &name, listed, &numbers));
            }
            if numbers.len() == listed + 1 {
                let first = self.element_nodes.len();
                self.elements.push(Listed { id: numbers[0], kind: at, first, place });
                self.element_nodes.extend_from_slice(&numbers[1..]);
                if let Some(set) = set {
                    self.sets.add_id(set, numbers[0]);
                }
                numbers.clear();
            }
        }
        if numbers.is_empty() { Ok(()) } else { Err(self.wrong_count(lines.place(), &name, listed, &numbers)) }
    }

    fn wrong_count(&self, place: Place, name: &str, listed: usize, numbers: &[i64]) -> FormatError {
        FormatError::Count {
            place,
            what: format!("nodes (as TYPE={name}) for element {}", numbers[0]),
            said: listed as u64,
            found: format!("{} follow", numbers.len() - 1),
        }
    }

    /// Elements of a type that is not ours; their ids are kept, so that sets may name them.
    fn skip_elements(&mut self, lines: &mut Lines<'_>, name: &str) -> Result<(), FormatError> {
        let mut count = 0;
        let mut continues = false;
        while let Some(data) = lines.data() {
            let text = String::from_utf8_lossy(data);
            if !continues {
                count += 1;
                if let Some(id) = text.split(',').next().and_then(|w| w.trim().parse().ok()) {
                    self.sets.skip_element(id);
                }
            }
            continues = text.ends_with(',');
        }
        self.draft.report.skip(&format!("TYPE={name}"), count, "no such element here");
        Ok(())
    }

    fn mark(&mut self, lines: &Lines<'_>) -> PlaceMark {
        match lines.place() {
            Place::IncludedLine { file, line } => {
                if self.files.last() != Some(&file) {
                    self.files.push(file);
                }
                PlaceMark { file: self.files.len() as u32 - 1, line: line as u32 }
            }
            Place::Line(line) => PlaceMark { file: 0, line: line as u32 },
            _ => PlaceMark { file: 0, line: 0 },
        }
    }

    /// Gives the elements the nodes that they name.
    fn resolve_elements(&mut self) -> Result<Elements, FormatError> {
        let mut ids = Vec::with_capacity(self.elements.len());
        let mut numbering = Numbering::new();
        let mut nodes = Vec::new();
        for element in &self.elements {
            let place = || match element.place.file {
                0 => Place::Line(element.place.line as usize),
                file => {
                    Place::IncludedLine { file: self.files[file as usize].clone(), line: element.place.line as usize }
                }
            };
            if !numbering.push(element.id) {
                return Err(FormatError::Repeated { place: place(), what: "element", id: element.id });
            }
            let (name, kind) = &self.kinds[element.kind];
            nodes.clear();
            for &node in &self.element_nodes[element.first..element.first + kind.listed] {
                nodes.push(self.nodes.get(node).ok_or_else(|| FormatError::OutOfRange {
                    place: place(),
                    who: format!("element {} ({name})", element.id),
                    what: format!("node {node}"),
                    defined: self.nodes.described("nodes"),
                })?);
            }
            ids.push(self.draft.element(kind, &nodes));
        }
        Ok(Elements { numbering, ids })
    }

    /// `*NSET` and `*ELSET`: ids, ranges, and names of other sets.
    fn set(&mut self, lines: &mut Lines<'_>, keyword: &Keyword, of: Set) -> Result<(), FormatError> {
        let parameter = if of == Set::Nodes { "NSET" } else { "ELSET" };
        let Some(name) = keyword.get(parameter).filter(|n| !n.is_empty()) else {
            return Err(lines.syntax(&format!("{parameter}= in *{parameter}"), "none"));
        };
        let mut set = self.sets.named(name, of);
        if of == Set::Nodes
            && let Some(elements) = keyword.get("ELSET")
        {
            let elements = self.sets.named(elements, Set::Elements);
            self.sets.add_nodes_of(set, elements);
        }
        let generate = keyword.get("GENERATE").is_some();
        while let Some(data) = lines.data() {
            let text = String::from_utf8_lossy(data);
            let words: Vec<String> = fields(&text).into_iter().filter(|w| !w.is_empty()).collect();
            if generate {
                let numbers: Option<Vec<i64>> = words.iter().map(|w| w.parse().ok()).collect();
                match numbers.as_deref() {
                    Some(&[first, last]) => self.sets.add_range(set, first, last, 1),
                    Some(&[first, last, step]) if step > 0 => self.sets.add_range(set, first, last, step),
                    _ => return Err(lines.syntax("first, last and step of a range", &text)),
                }
                continue;
            }
            for word in &words {
                match word.parse() {
                    Ok(id) => self.sets.add_listed(set, id, lines.place()),
                    Err(_) => set = self.sets.add_set(set, word.trim_matches('"'), lines.place()),
                }
            }
        }
        Ok(())
    }
}
