//! What a reader found in a file, and what it did with it.

use std::collections::BTreeMap;
use std::fmt;

/// Something that was left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// What, in the words of the format.
    pub what: String,
    /// How many.
    pub count: usize,
    /// Why.
    pub why: String,
}

/// A region and its size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundRegion {
    /// Name.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// Number of elements.
    pub elements: usize,
}

/// The account of one import. [`fmt::Display`] prints it for people.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ImportReport {
    /// Format, version and encoding.
    pub format: String,
    /// Nodes in the mesh.
    pub nodes: usize,
    /// Elements in the mesh, by id.
    pub found: BTreeMap<&'static str, usize>,
    /// Elements that are not in the mesh.
    pub skipped: Vec<Skipped>,
    /// Elements whose nodes were put into our order, by id.
    pub reordered: BTreeMap<&'static str, usize>,
    /// Elements of negative measure that were mirrored, by id.
    pub flipped: BTreeMap<&'static str, usize>,
    /// Elements of lower dimension that were turned round because the file marks their group as reversed, by id.
    pub reversed: BTreeMap<&'static str, usize>,
    /// Complete second-order elements read as the element without face and centre nodes, by "from → to".
    pub reduced: BTreeMap<String, usize>,
    /// Polygons and strips split into elements, by "what".
    pub split: BTreeMap<String, usize>,
    /// Face and centre nodes that went with the reduction.
    pub dropped_nodes: usize,
    /// Elements listed more than once (once per group) and kept once.
    pub repeated_elements: usize,
    /// Vertices of a surface without topology that were merged into one node.
    pub welded_nodes: usize,
    /// Nodes of the mesh that are in no element.
    pub unreferenced_nodes: usize,
    /// Nodes of the mesh that lie on an earlier node.
    pub duplicate_nodes: usize,
    /// Regions, by name.
    pub regions: Vec<FoundRegion>,
    /// Sections, keywords and arrays of the file that say nothing about the mesh.
    pub ignored: Vec<String>,
}

impl ImportReport {
    /// Counts something left out, together with earlier ones of the same kind.
    pub(super) fn skip(&mut self, what: &str, count: usize, why: &str) {
        match self.skipped.iter_mut().find(|s| s.what == what && s.why == why) {
            Some(known) => known.count += count,
            None => self.skipped.push(Skipped { what: what.to_owned(), count, why: why.to_owned() }),
        }
    }

    /// Notes a part of the file that was passed over; once is enough.
    pub(super) fn ignore(&mut self, what: String) {
        // A hostile file can hold a million unknown sections; nobody reads a list that long.
        if self.ignored.len() < 1000 && !self.ignored.contains(&what) {
            self.ignored.push(what);
        }
    }
}

fn list<K: fmt::Display>(counts: &BTreeMap<K, usize>) -> String {
    counts.iter().map(|(what, count)| format!("{count} {what}")).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for ImportReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {} nodes, {} elements", self.format, self.nodes, self.found.values().sum::<usize>())?;
        let mut line = |title: &str, text: String| {
            if text.is_empty() { Ok(()) } else { writeln!(f, "  {title:<11}{text}") }
        };
        line("found", list(&self.found))?;
        for s in &self.skipped {
            line("skipped", format!("{} × {}: {}", s.count, s.what, s.why))?;
        }
        let with = |text: String, note: &str| if text.is_empty() { text } else { format!("{text} ({note})") };
        line("reordered", with(list(&self.reordered), "nodes put into VTK's order"))?;
        line("flipped", with(list(&self.flipped), "they were inside out"))?;
        line("reversed", with(list(&self.reversed), "their group is marked as reversed"))?;
        line("reduced", with(list(&self.reduced), "face and centre nodes dropped"))?;
        line("split", list(&self.split))?;
        let counts = [
            (self.dropped_nodes, "dropped with the reduced elements"),
            (self.welded_nodes, "welded to another one"),
            (self.unreferenced_nodes, "in no element"),
            (self.duplicate_nodes, "at the place of another one"),
        ];
        let nodes: Vec<String> = counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} {what}")).collect();
        line("nodes", nodes.join(", "))?;
        if self.repeated_elements > 0 {
            line("repeated", format!("{} elements listed again for another group", self.repeated_elements))?;
        }
        for r in &self.regions {
            line("region", format!("{}: {} nodes, {} elements", r.name, r.nodes, r.elements))?;
        }
        line("ignored", self.ignored.join(", "))
    }
}
