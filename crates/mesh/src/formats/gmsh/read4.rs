//! MSH 4.1: entities with their groups, nodes and elements in blocks by entity.

use super::super::error::FormatError;
use super::super::kinds::{gmsh_kind, gmsh_node_count};
use super::super::stream::Encoding;
use super::{Groups, POINT, Reader, called};

impl Reader<'_> {
    pub(super) fn entities4(&mut self) -> Result<(), FormatError> {
        self.entities(|_| Ok(()))?;
        self.end("Entities")
    }

    /// As the entities, with the partitions and the parent entity in front.
    pub(super) fn partitioned_entities4(&mut self) -> Result<(), FormatError> {
        self.stream.size("the number of partitions")?;
        let ghosts = self.stream.size("the number of ghost entities")?;
        let ghosts = self.stream.claim(ghosts, 2, 8, "ghost entities")?;
        for _ in 0..2 * ghosts {
            self.stream.int("a ghost entity")?;
        }
        self.entities(|reader| {
            reader.stream.int("the dimension of the parent")?;
            reader.stream.int("the tag of the parent")?;
            let partitions = reader.stream.size("the number of partitions")?;
            for _ in 0..reader.stream.claim(partitions, 1, 4, "partitions")? {
                reader.stream.int("a partition")?;
            }
            Ok(())
        })?;
        self.end("PartitionedEntities")
    }

    /// Points, curves, surfaces and volumes: tag, (`parent`), box, groups, boundary.
    fn entities(&mut self, parent: fn(&mut Self) -> Result<(), FormatError>) -> Result<(), FormatError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = self.stream.size("the number of entities")?;
        }
        for (dimension, count) in counts.into_iter().enumerate() {
            let numbers = if dimension == 0 { 3 } else { 6 };
            for _ in 0..self.stream.claim(count, 2 + numbers, 12 + 8 * numbers, "entities")? {
                let tag = self.stream.int("the tag of an entity")?;
                parent(self)?;
                for _ in 0..numbers {
                    self.stream.double("the box of an entity")?;
                }
                let mut groups = Groups { regions: Vec::new(), reversed: true };
                let count = self.stream.size("the number of groups of an entity")?;
                let count = self.stream.claim(count, 1, 4, "groups")?;
                for _ in 0..count {
                    let group = self.stream.int("the tag of a physical group")?;
                    groups.reversed &= group < 0;
                    groups.regions.extend(self.group(dimension as i64, group));
                }
                groups.regions.sort_unstable();
                groups.regions.dedup();
                groups.reversed &= count > 0;
                self.entities.insert((dimension as i64, tag), groups);
                if dimension > 0 {
                    let boundary = self.stream.size("the number of bounding entities")?;
                    for _ in 0..self.stream.claim(boundary, 1, 4, "bounding entities")? {
                        self.stream.int("a bounding entity")?;
                    }
                }
            }
        }
        Ok(())
    }

    pub(super) fn nodes4(&mut self) -> Result<(), FormatError> {
        let blocks = self.stream.size("the number of blocks of nodes")?;
        let total = self.stream.size("the number of nodes")?;
        self.stream.size("the lowest node tag")?;
        self.stream.size("the highest node tag")?;
        let blocks = self.stream.claim(blocks, 4, 20, "blocks of nodes")?;
        self.stream.claim(total, 4, 32, "nodes")?;
        let before = self.nodes.len();
        let mut tags = Vec::new();
        for _ in 0..blocks {
            let dimension = self.stream.int("the dimension of an entity")?;
            self.stream.int("the tag of an entity")?;
            // A parametric block gives the node's parameters on the entity after its coordinates.
            let parametric = self.stream.int("0 or 1 (parametric)")? != 0;
            let extra = if parametric { dimension.clamp(0, 3) } else { 0 };
            let count = self.stream.size("the number of nodes in the block")?;
            let count = self.stream.claim(count, 4, 32, "nodes")?;
            tags.clear();
            for _ in 0..count {
                tags.push(self.stream.size("the tag of a node")? as i64);
            }
            for &tag in &tags {
                let [x, y, z] = [0; 3].map(|_| self.stream.double("a coordinate"));
                self.add_node(tag, [x?, y?, z?])?;
                for _ in 0..extra {
                    self.stream.double("a parametric coordinate")?;
                }
            }
        }
        self.check_total("nodes", total, self.nodes.len() - before)?;
        self.end("Nodes")
    }

    fn check_total(&self, what: &str, said: u64, found: usize) -> Result<(), FormatError> {
        if said == found as u64 {
            return Ok(());
        }
        let found = format!("its blocks hold {found}");
        Err(FormatError::Count { place: self.stream.place(), what: what.to_owned(), said, found })
    }

    pub(super) fn elements4(&mut self) -> Result<(), FormatError> {
        let blocks = self.stream.size("the number of blocks of elements")?;
        let total = self.stream.size("the number of elements")?;
        self.stream.size("the lowest element tag")?;
        self.stream.size("the highest element tag")?;
        let blocks = self.stream.claim(blocks, 4, 20, "blocks of elements")?;
        let mut read = 0;
        for _ in 0..blocks {
            read += self.elements_of_entity()?;
        }
        self.check_total("elements", total, read)?;
        self.end("Elements")
    }

    fn elements_of_entity(&mut self) -> Result<usize, FormatError> {
        let dimension = self.stream.int("the dimension of an entity")?;
        let entity = self.stream.int("the tag of an entity")?;
        let number = self.stream.int("the type of the elements")?;
        let count = self.stream.size("the number of elements in the block")?;
        let listed = gmsh_node_count(number).ok_or_else(|| self.unknown(number))?;
        let count = self.stream.claim(count, 1 + listed, 8 * (1 + listed), "elements")?;
        let kind = gmsh_kind(number);
        let name = kind.as_ref().map_or("no element here", called);
        let groups = self.entities.get(&(dimension, entity)).cloned().unwrap_or_default();
        if kind.is_none() && number != POINT {
            self.skip_elements(number, listed, count);
        } else if number == POINT && groups.regions.is_empty() {
            self.draft.report.skip("points", count, "a point is a node, not an element");
        }
        self.draft.claim_memberships(count.saturating_mul(groups.regions.len()))?;
        // Solids are turned by their volume; only a surface or a line can be meant the other way round.
        let reversed = groups.reversed && kind.as_ref().is_some_and(|k| k.element.dimension() < 3);
        let mut row = Vec::new();
        let mut nodes = Vec::with_capacity(listed);
        for _ in 0..count {
            if self.stream.encoding == Encoding::Text {
                self.row(&mut row, "an element: tag and nodes")?;
            } else {
                row.clear();
                for _ in 0..1 + listed {
                    row.push(self.stream.size("the tag of an element or node")? as i64);
                }
            }
            let Some((&tag, tags)) = row.split_first().filter(|(_, tags)| tags.len() == listed) else {
                return Err(FormatError::Count {
                    place: self.stream.place(),
                    what: format!("nodes (as Gmsh type {number}) for element {}", row[0]),
                    said: listed as u64,
                    found: format!("{} follow", row.len() - 1),
                });
            };
            nodes.clear();
            for &node in tags {
                nodes.push(self.node(node, tag, name)?);
            }
            match &kind {
                Some(kind) => {
                    let element = self.draft.element(kind, &nodes);
                    groups.regions.iter().for_each(|&region| self.draft.add_element(region, element));
                    if reversed {
                        self.draft.reverse(element);
                    }
                }
                None if number == POINT => {
                    groups.regions.iter().for_each(|&region| self.draft.add_node(region, nodes[0]));
                }
                None => {}
            }
        }
        Ok(count)
    }
}
