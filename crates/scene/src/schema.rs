//! The shape of a scene as data: every table, every key, its type, unit, default and range.
//!
//! The parser reads values through these tables and the reference `docs/scene.md` is printed from them, so a key
//! cannot be accepted without being documented, nor documented without being accepted.
//! Each table stands beside the struct that it fills ([`crate::time`], [`crate::body`], …); [`schema`] collects them.

use crate::choice::Choice;
use crate::dimension::Dimension;
use crate::range::Range;

/// A table of the scene.
#[derive(Debug)]
pub struct Section {
    /// As written in a scene: `[time]`, `[[body.fix]]`.
    pub header: &'static str,
    /// What it describes.
    pub about: &'static str,
    /// Its keys, in the order of the documentation.
    pub keys: &'static [Key],
    /// What keys that are not listed mean, where they are allowed.
    pub other_keys: Option<&'static str>,
}

/// A key of a table.
#[derive(Debug)]
pub struct Key {
    /// The key.
    pub name: &'static str,
    /// Type of its value.
    pub kind: Kind,
    /// Whether it must be there, and what holds when it is not.
    pub presence: Presence,
    /// What it means.
    pub about: &'static str,
}

/// Whether a key must be given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// It must.
    Required,
    /// When absent it has this value, written as in a scene.
    Default(&'static str),
    /// When absent, this holds.
    Optional(&'static str),
}

/// Type of the value of a key.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A text.
    Text,
    /// `true` or `false`.
    Boolean,
    /// A whole number, with its least and largest value.
    Whole(u32, u32),
    /// Three whole numbers, each with its least value.
    WholeVector(u32),
    /// A number, or a text with a unit.
    Number(Dimension, Range),
    /// Three numbers.
    Vector(Dimension, Range),
    /// Three numbers, not all zero.
    Direction,
    /// One of some words.
    Choice(&'static [Choice]),
    /// A list of different words.
    Choices(&'static [Choice]),
    /// One word, or a list of different ones.
    OneOrMore(&'static [Choice]),
    /// A region (see [`crate::region`]).
    Region,
    /// A list of regions.
    Regions,
    /// The id of an element.
    Element,
    /// `[[time, value], …]` with increasing times.
    Curve(Dimension),
    /// `[[time, [x, y, z]], …]` with increasing times.
    VectorCurve(Dimension),
    /// A number or a list of numbers whose meaning depends on other keys.
    Values(&'static str),
    /// A table.
    Table(&'static Section),
    /// A list of tables.
    Tables(&'static Section),
}

impl Section {
    /// The key of this name.
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}

/// The unit of the values of a key: `"Pa"`, or empty.
pub fn unit(kind: &Kind) -> &'static str {
    match kind {
        Kind::Number(d, _) | Kind::Vector(d, _) | Kind::Curve(d) | Kind::VectorCurve(d) => d.unit,
        _ => "",
    }
}

/// Every table of a scene, the whole scene first, in the order of the documentation.
pub fn schema() -> Vec<&'static Section> {
    fn collect(section: &'static Section, into: &mut Vec<&'static Section>) {
        if into.iter().any(|known| std::ptr::eq(*known, section)) {
            return;
        }
        into.push(section);
        for key in section.keys {
            if let Kind::Table(inner) | Kind::Tables(inner) = key.kind {
                collect(inner, into);
            }
        }
    }
    let mut sections = Vec::new();
    collect(&crate::scene::SCENE, &mut sections);
    sections
}
