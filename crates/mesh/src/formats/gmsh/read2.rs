//! MSH 2: one line or record per element, with its group and its entity.
//!
//! Gmsh writes an element once for each group that it is in, one directly after the other, turned where the group
//! holds it reversed; these are put together again.

use super::super::error::FormatError;
use super::super::kinds::{Kind, gmsh_kind, gmsh_node_count};
use super::super::stream::Encoding;
use super::{POINT, Reader, called};
use crate::ElementId;

/// The element added last, to recognise its repetition.
struct Last {
    id: ElementId,
    number: i64,
    entity: i64,
    group: i64,
    /// Sorted tags of its nodes.
    nodes: Vec<i64>,
}

impl Reader<'_> {
    pub(super) fn nodes2(&mut self) -> Result<(), FormatError> {
        let count = self.leading_count("the number of nodes")?;
        let count = self.stream.claim(count, 4, 28, "nodes")?;
        for _ in 0..count {
            let tag = self.stream.int("the tag of a node")?;
            let position = [0; 3].map(|_| self.stream.double("a coordinate"));
            let [x, y, z] = position;
            self.add_node(tag, [x?, y?, z?])?;
        }
        self.end("Nodes")
    }

    /// The number of nodes or elements is text even in a binary file.
    fn leading_count(&mut self, what: &str) -> Result<u64, FormatError> {
        let encoding = std::mem::replace(&mut self.stream.encoding, Encoding::Text);
        let count = self.stream.size(what);
        self.stream.line();
        self.stream.encoding = encoding;
        count
    }

    pub(super) fn elements2(&mut self) -> Result<(), FormatError> {
        let count = self.leading_count("the number of elements")?;
        let count = self.stream.claim(count, 4, 4, "elements")?;
        let mut last = None;
        let mut numbers = Vec::new();
        if self.stream.encoding == Encoding::Text {
            for _ in 0..count {
                self.row(&mut numbers, "an element: number, type, tags and nodes")?;
                let tags = numbers.get(2).and_then(|&n| usize::try_from(n).ok()).filter(|&n| n <= numbers.len() - 3);
                let Some(tags) = tags else {
                    return Err(self.stream.syntax("number, type, number of tags and tags", &format!("{numbers:?}")));
                };
                let (head, nodes) = numbers.split_at(3 + tags);
                self.element2(head[1], head[0], &head[3..], nodes, &mut last)?;
            }
        } else {
            let mut read = 0;
            while read < count {
                let number = self.stream.int("the type of the next elements")?;
                let here = self.stream.int("the number of elements of this type")?;
                let tags = self.stream.int("the number of tags")?;
                let Some(nodes) = gmsh_node_count(number) else {
                    return Err(self.unknown(number));
                };
                let (Ok(here), Ok(tags)) = (u64::try_from(here), usize::try_from(tags)) else {
                    return Err(self.stream.syntax("a positive count", &format!("{here} elements, {tags} tags")));
                };
                let tags = self.stream.claim(tags as u64, 1, 4, "tags")?;
                let here = self.stream.claim(here.max(1), 1, 4 * (1 + tags + nodes), "elements")?;
                for _ in 0..here {
                    let id = self.stream.int("the number of an element")?;
                    numbers.clear();
                    for _ in 0..tags + nodes {
                        numbers.push(self.stream.int("a node of an element")?);
                    }
                    let (tags, nodes) = numbers.split_at(tags);
                    self.element2(number, id, tags, nodes, &mut last)?;
                }
                read += here;
            }
        }
        self.end("Elements")
    }

    fn element2(
        &mut self,
        number: i64,
        id: i64,
        tags: &[i64],
        nodes: &[i64],
        last: &mut Option<Last>,
    ) -> Result<(), FormatError> {
        let listed = gmsh_node_count(number).ok_or_else(|| self.unknown(number))?;
        if nodes.len() != listed {
            return Err(FormatError::Count {
                place: self.stream.place(),
                what: format!("nodes (as Gmsh type {number}) for element {id}"),
                said: listed as u64,
                found: format!("{} follow", nodes.len()),
            });
        }
        let (group, entity) = (tags.first().copied().unwrap_or(0), tags.get(1).copied().unwrap_or(0));
        if number == POINT {
            let node = self.node(nodes[0], id, "point")?;
            if group == 0 {
                self.draft.report.skip("points", 1, "a point is a node, not an element");
            } else if let Some(region) = self.group(0, group) {
                self.draft.add_node(region, node);
            }
            return Ok(());
        }
        let Some(kind) = gmsh_kind(number) else {
            self.skip_elements(number, listed, 1);
            return Ok(());
        };
        let mut sorted = nodes.to_vec();
        sorted.sort_unstable();
        let again = last
            .as_ref()
            .filter(|l| l.number == number && l.entity == entity && l.group.abs() != group.abs() && l.nodes == sorted);
        let element = match again {
            Some(known) => {
                self.draft.report.repeated_elements += 1;
                known.id
            }
            None => self.new_element2(&kind, id, nodes)?,
        };
        if group != 0
            && let Some(region) = self.group(kind.element.dimension() as i64, group)
        {
            self.draft.add_element(region, element);
        }
        *last = Some(Last { id: element, number, entity, group, nodes: sorted });
        Ok(())
    }

    fn new_element2(&mut self, kind: &Kind, id: i64, tags: &[i64]) -> Result<ElementId, FormatError> {
        let nodes: Vec<u32> = tags.iter().map(|&tag| self.node(tag, id, called(kind))).collect::<Result<_, _>>()?;
        Ok(self.draft.element(kind, &nodes))
    }
}
