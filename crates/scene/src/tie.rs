//! `[[tie]]`: nodes of one body glued to the surface of another, or of the same.

use serde::Serialize;

use crate::dimension::Dimension;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::region::Region;
use crate::schema::{Key, Kind, Presence, Section};

/// Each node of `region` keeps its place on the nearest face of `to_region`: x = Σ Nᵢ xᵢ with the face's shape
/// functions N at its foot point in the rest shape.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tie {
    /// Index of the body whose nodes are tied.
    pub body: Spanned<usize>,
    /// Which of its nodes.
    pub region: Region,
    /// Index of the body that they are tied to.
    pub to_body: Spanned<usize>,
    /// Which of its surface: faces whose nodes all lie in the region.
    pub to_region: Region,
    /// Nodes farther than this (m) from the faces are not tied.
    pub within: f64,
}

pub(crate) static TIE: Section = Section {
    header: "[[tie]]",
    about: "nodes glued to a surface: each keeps its place on the face nearest to it in the rest shape",
    keys: &[
        Key {
            name: "body",
            kind: Kind::Text,
            presence: Presence::Required,
            about: "name of the body whose nodes are tied",
        },
        Key { name: "region", kind: Kind::Region, presence: Presence::Required, about: "which of its nodes" },
        Key {
            name: "to_body",
            kind: Kind::Text,
            presence: Presence::Required,
            about: "name of the body that they are tied to",
        },
        Key {
            name: "to_region",
            kind: Kind::Region,
            presence: Presence::Required,
            about: "which faces of its surface: those whose nodes all lie in it",
        },
        Key {
            name: "within",
            kind: Kind::Number(Dimension::LENGTH, Range::NOT_NEGATIVE),
            presence: Presence::Required,
            about: "nodes farther than this from the faces are not tied",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn tie(&mut self, fields: &Fields<'_>, bodies: &[String]) -> Option<Spanned<Tie>> {
        let (body, to_body) = (self.body_named(fields, "body", bodies), self.body_named(fields, "to_body", bodies));
        let (region, to_region) = (self.region(fields, "region"), self.region(fields, "to_region"));
        let within = self.number(fields, "within");
        let tie = Tie { body: body?, region: region?, to_body: to_body?, to_region: to_region?, within: within?.value };
        Some(Spanned::new(tie, fields.at.clone()))
    }

    /// The index of the body that a key names.
    pub(crate) fn body_named(&mut self, fields: &Fields<'_>, key: &str, bodies: &[String]) -> Option<Spanned<usize>> {
        let name = self.text(fields, key)?;
        match bodies.iter().position(|body| *body == name.value) {
            Some(index) => Some(name.map(|_| index)),
            None => {
                self.unknown_name("body", &name, bodies.to_vec());
                None
            }
        }
    }
}
