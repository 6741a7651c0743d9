//! Node and element sets while they are collected.
//!
//! Names are the same whatever their case. A node set and an element set of one name become one region.

use super::read::Elements;
use crate::formats::draft::{Draft, Numbering, RegionKey};
use crate::formats::error::{FormatError, Place};
use std::collections::{HashMap, HashSet};

/// What a set holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Set {
    Nodes,
    Elements,
}

/// A part of a set.
enum Member {
    /// An id that is known to exist.
    Id(i64),
    /// An id that a line lists.
    Listed(i64, Place),
    /// first, last, step; those that exist.
    Range(i64, i64, i64),
    /// All of another set.
    Set(usize),
    /// The nodes of an element set.
    NodesOf(usize),
    /// A name that no earlier set has.
    Unknown(String, Place),
}

struct Named {
    name: String,
    of: Set,
    members: Vec<Member>,
}

/// All sets of a file.
#[derive(Default)]
pub(super) struct Sets {
    sets: Vec<Named>,
    known: HashMap<(String, Set), usize>,
    /// Ids of elements that were not read.
    skipped: HashSet<i64>,
}

impl Sets {
    /// The set of this name, made when there is none yet.
    pub(super) fn named(&mut self, name: &str, of: Set) -> usize {
        let key = (name.to_ascii_uppercase(), of);
        if let Some(&at) = self.known.get(&key) {
            return at;
        }
        self.sets.push(Named { name: name.to_owned(), of, members: Vec::new() });
        self.known.insert(key, self.sets.len() - 1);
        self.sets.len() - 1
    }

    pub(super) fn skip_element(&mut self, id: i64) {
        self.skipped.insert(id);
    }

    pub(super) fn add_id(&mut self, set: usize, id: i64) {
        self.sets[set].members.push(Member::Id(id));
    }

    pub(super) fn add_listed(&mut self, set: usize, id: i64, place: Place) {
        self.sets[set].members.push(Member::Listed(id, place));
    }

    pub(super) fn add_range(&mut self, set: usize, first: i64, last: i64, step: i64) {
        self.sets[set].members.push(Member::Range(first, last, step));
    }

    pub(super) fn add_nodes_of(&mut self, set: usize, elements: usize) {
        self.sets[set].members.push(Member::NodesOf(elements));
    }

    /// Adds all of another set as it is now, and returns where the set continues.
    ///
    /// A set only ever refers to sets in front of it: one that takes in a later set continues as a new entry behind
    /// that, which starts with the old one. So sets cannot hold each other, and one pass resolves them.
    pub(super) fn add_set(&mut self, set: usize, name: &str, place: Place) -> usize {
        let key = (name.to_ascii_uppercase(), self.sets[set].of);
        let Some(&other) = self.known.get(&key) else {
            self.sets[set].members.push(Member::Unknown(name.to_owned(), place));
            return set;
        };
        if other < set {
            self.sets[set].members.push(Member::Set(other));
        } else if other > set {
            let (name, of) = (self.sets[set].name.clone(), self.sets[set].of);
            self.known.insert((name.to_ascii_uppercase(), of), self.sets.len());
            self.sets.push(Named { name, of, members: vec![Member::Set(set), Member::Set(other)] });
            return self.sets.len() - 1;
        }
        set
    }

    /// Makes a region of every set.
    pub(super) fn regions(self, draft: &mut Draft, nodes: &Numbering, elements: &Elements) -> Result<(), FormatError> {
        let mut positions: Vec<Vec<u32>> = vec![Vec::new(); self.sets.len()];
        // A node set can take in the nodes of any element set, so those come first.
        for of in [Set::Elements, Set::Nodes] {
            let numbering = if of == Set::Nodes { nodes } else { &elements.numbering };
            let sorted = numbering.sorted();
            for (at, set) in self.sets.iter().enumerate().filter(|(_, s)| s.of == of) {
                positions[at] = self.members(set, &positions, numbering, &sorted, draft, elements)?;
                draft.claim_memberships(positions[at].len())?;
            }
        }
        let mut regions: HashMap<String, RegionKey> = HashMap::new();
        for (at, set) in self.sets.iter().enumerate() {
            let upper = set.name.to_ascii_uppercase();
            let current = self.known.get(&(upper.clone(), set.of)) == Some(&at);
            let region = *regions.entry(upper).or_insert_with(|| draft.region(&set.name));
            let positions = std::mem::take(&mut positions[at]);
            match set.of {
                _ if !current => {}
                Set::Nodes => {
                    draft.lists_nodes(region);
                    positions.into_iter().for_each(|node| draft.add_node(region, node));
                }
                Set::Elements => {
                    positions.into_iter().for_each(|e| draft.add_element(region, elements.ids[e as usize]));
                }
            }
        }
        Ok(())
    }

    /// Positions of the members of a set, sorted; `positions` holds those of the sets in front of it, `sorted` all ids
    /// with their positions.
    fn members(
        &self,
        set: &Named,
        positions: &[Vec<u32>],
        numbering: &Numbering,
        sorted: &[(i64, u32)],
        draft: &Draft,
        elements: &Elements,
    ) -> Result<Vec<u32>, FormatError> {
        let refuse = |place: &Place, what: String, defined: String| FormatError::OutOfRange {
            place: place.clone(),
            who: format!("set {}", set.name),
            what,
            defined,
        };
        let what = if set.of == Set::Nodes { "node" } else { "element" };
        let mut found = Vec::new();
        for member in &set.members {
            match member {
                Member::Id(id) => found.extend(numbering.get(*id)),
                Member::Listed(id, place) => match numbering.get(*id) {
                    Some(at) => found.push(at),
                    None if set.of == Set::Elements && self.skipped.contains(id) => {}
                    None => {
                        return Err(refuse(place, format!("{what} {id}"), numbering.described(&format!("{what}s"))));
                    }
                },
                Member::Range(first, last, step) => {
                    let from = sorted.partition_point(|(id, _)| id < first);
                    let inside = sorted[from..].iter().take_while(|(id, _)| id <= last);
                    found.extend(inside.filter(|(id, _)| id.wrapping_sub(*first) % step == 0).map(|(_, at)| *at));
                }
                Member::Set(other) => found.extend_from_slice(&positions[*other]),
                Member::NodesOf(other) => {
                    for &element in &positions[*other] {
                        let id = elements.ids[element as usize];
                        found.extend_from_slice(draft.blocks[id.block as usize].nodes(id.index as usize));
                    }
                }
                Member::Unknown(name, place) => {
                    return Err(refuse(place, format!("the set {name}"), "no such set before it".to_owned()));
                }
            }
            // A thousand ranges over everything are not a thousand times everything.
            if found.len() > 4 * sorted.len() + 1024 {
                found.sort_unstable();
                found.dedup();
            }
        }
        found.sort_unstable();
        found.dedup();
        Ok(found)
    }
}
