//! `[body.mesh]`: a generated bar or a mesh file.

use serde::Serialize;

use crate::choice::{Axis, Named, choices};
use crate::dimension::Dimension;
use crate::error::Problem;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

choices! {
    /// A mesh generator.
    pub enum Generator {
        /// A box of cells along x, in sections of different elements; its regions are `x_min` to `z_max` and
        /// `section_0`, `section_1`, ….
        Bar = "bar",
    }
}

choices! {
    /// What a generator does where quadrilateral faces of one section meet triangular faces of the next.
    pub enum Transition {
        /// Keep the elements as asked for, and report the faces that do not match.
        Keep = "keep",
        /// Put a layer of cells with pyramids between them, so that all faces match.
        Pyramids = "pyramids",
    }
}

/// Where the mesh of a body comes from.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mesh {
    /// Read from a file.
    File(MeshFile),
    /// Generated.
    Bar(Bar),
}

/// A mesh file; its format is recognised by whoever opens it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshFile {
    /// Path, relative to the scene's folder.
    pub path: Spanned<String>,
    /// Length of the file's unit in metres: 1e-3 for a file in millimetres (default 1).
    pub scale: f64,
}

/// A box of `cells[0] × cells[1] × cells[2]` cells whose sections follow each other along x.
///
/// Its elements are all of one dimension; with surface elements it is a rectangle in the plane of x and y, with edges a
/// line along x, and the other sizes and cells are not looked at.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bar {
    /// Edge lengths (m), positive.
    pub size: Spanned<[f64; 3]>,
    /// Cells along each axis, at least 1.
    pub cells: Spanned<[u32; 3]>,
    /// Corner with the least coordinates (m; default 0, 0, 0).
    pub origin: [f64; 3],
    /// Sections; `until` increases and ends at 1.
    pub sections: Vec<Spanned<BarSection>>,
    /// What happens where the faces of two sections do not match (default keep).
    pub transition: Transition,
    /// Tetrahedra per cell, 5 or 6 (default 6).
    pub tetrahedra: u32,
    /// Axis along which the prisms of a cell are extruded (default x).
    pub prism_axis: Axis,
}

/// A part of a bar made of one element.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BarSection {
    /// Where it ends, as a fraction of the length along x.
    pub until: f64,
    /// Id of the element.
    pub element: Spanned<String>,
}

pub(crate) static MESH: Section = Section {
    header: "[body.mesh]",
    about: "the mesh: either `file` or `generator`",
    keys: &[
        Key {
            name: "file",
            kind: Kind::Text,
            presence: Presence::Optional("`generator` is given"),
            about: "path of a mesh file, relative to the scene",
        },
        Key {
            name: "scale",
            kind: Kind::Number(Dimension::LENGTH, Range::POSITIVE),
            presence: Presence::Default("1.0"),
            about: "with `file`: length of the file's unit, as in \"1 mm\"",
        },
        Key {
            name: "generator",
            kind: Kind::Choice(Generator::CHOICES),
            presence: Presence::Optional("`file` is given"),
            about: "the generator; all keys below belong to it",
        },
        Key {
            name: "size",
            kind: Kind::Vector(Dimension::LENGTH, Range::POSITIVE),
            presence: Presence::Optional("required with `generator`"),
            about: "edge lengths of the bar",
        },
        Key {
            name: "cells",
            kind: Kind::WholeVector(1),
            presence: Presence::Optional("required with `generator`"),
            about: "number of cells along each axis",
        },
        Key {
            name: "origin",
            kind: Kind::Vector(Dimension::LENGTH, Range::ANY),
            presence: Presence::Default("[0.0, 0.0, 0.0]"),
            about: "corner with the least coordinates",
        },
        Key {
            name: "element",
            kind: Kind::Element,
            presence: Presence::Optional("`sections` is given"),
            about: "the element of a bar that has only one",
        },
        Key {
            name: "sections",
            kind: Kind::Tables(&SECTION),
            presence: Presence::Optional("`element` is given"),
            about: "parts of different elements, along x",
        },
        Key {
            name: "transition",
            kind: Kind::Choice(Transition::CHOICES),
            presence: Presence::Default("\"keep\""),
            about: "what happens where quadrilateral faces of one section meet triangular faces of the next",
        },
        Key {
            name: "tetrahedra",
            kind: Kind::Whole(5, 6),
            presence: Presence::Default("6"),
            about: "tetrahedra per cell",
        },
        Key {
            name: "prism_axis",
            kind: Kind::Choice(Axis::CHOICES),
            presence: Presence::Default("\"x\""),
            about: "axis along which the prisms of a cell are extruded",
        },
    ],
    other_keys: None,
};

static SECTION: Section = Section {
    header: "[[body.mesh.sections]]",
    about: "a part of a bar; usually written inline: `{ until = 0.5, element = \"hex8\" }`",
    keys: &[
        Key {
            name: "until",
            kind: Kind::Number(Dimension::NUMBER, Range::FRACTION),
            presence: Presence::Required,
            about: "where it ends, as a fraction of the length; increases, and the last one is 1.0",
        },
        Key { name: "element", kind: Kind::Element, presence: Presence::Required, about: "its element" },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn mesh(&mut self, fields: &Fields<'_>) -> Option<Spanned<Mesh>> {
        let generator = self.choice::<Generator>(fields, "generator");
        let mesh = match (fields.has("file"), fields.has("generator")) {
            (true, true) => {
                let message = "a mesh comes from a file or from a generator; remove either `file` or `generator`";
                self.conflict(fields.place("generator"), message);
                None
            }
            (false, false) => {
                let message = "[body.mesh] needs `file = \"…\"` or `generator = \"bar\"`";
                self.conflict(fields.at.clone(), message);
                None
            }
            (true, false) => self.mesh_file(fields).map(Mesh::File),
            (false, true) => match generator.map(|generator| generator.value) {
                Some(Generator::Bar) => self.bar(fields).map(Mesh::Bar),
                None => None,
            },
        };
        Some(Spanned::new(mesh?, fields.at.clone()))
    }

    fn mesh_file(&mut self, fields: &Fields<'_>) -> Option<MeshFile> {
        for name in ["size", "cells", "origin", "element", "sections", "transition", "tetrahedra", "prism_axis"] {
            if let Some(at) = fields.key_at(name) {
                self.conflict(at.clone(), format!("`{name}` belongs to a generator and has no meaning with `file`"));
            }
        }
        let (path, scale) = (self.text(fields, "file"), self.number(fields, "scale"));
        let path = path?;
        if path.trim().is_empty() {
            self.conflict(path.at, "`file` is empty; write the path of a mesh file");
            return None;
        }
        Some(MeshFile { path, scale: scale.map_or(1.0, |scale| scale.value) })
    }

    fn bar(&mut self, fields: &Fields<'_>) -> Option<Bar> {
        if let Some(at) = fields.key_at("scale") {
            self.conflict(at.clone(), "`scale` belongs to a mesh file; a bar has its `size` in metres");
        }
        for name in ["size", "cells"] {
            if !fields.has(name) {
                self.missing(fields, name);
            }
        }
        let (size, cells) = (self.vector(fields, "size"), self.whole_vector(fields, "cells"));
        let origin = self.vector(fields, "origin").map_or([0.0; 3], |origin| origin.value);
        let sections = self.bar_sections(fields);
        let transition = self.choice(fields, "transition").map_or(Transition::Keep, |choice| choice.value);
        let tetrahedra = self.whole(fields, "tetrahedra").map_or(6, |count| count.value);
        let prism_axis = self.choice(fields, "prism_axis").map_or(Axis::X, |axis| axis.value);
        Some(Bar { size: size?, cells: cells?, origin, sections: sections?, transition, tetrahedra, prism_axis })
    }

    fn bar_sections(&mut self, fields: &Fields<'_>) -> Option<Vec<Spanned<BarSection>>> {
        match (fields.has("element"), fields.has("sections")) {
            (true, true) => {
                self.conflict(fields.place("element"), "give either `element` or `sections`, not both");
                return None;
            }
            (false, false) => {
                let message = "a bar needs `element = \"hex8\"` or `sections = [{ until = 1.0, element = \"hex8\" }]`";
                self.conflict(fields.at.clone(), message);
                return None;
            }
            (true, false) => {
                let element = self.element(fields, "element")?;
                let at = element.at.clone();
                return Some(vec![Spanned::new(BarSection { until: 1.0, element }, at)]);
            }
            (false, true) => {}
        }
        let errors = self.errors.len();
        let tables = self.tables(fields, "sections");
        let mut sections = Vec::new();
        for section in &tables {
            let (until, element) = (self.number(section, "until"), self.element(section, "element"));
            if let (Some(until), Some(element)) = (until, element) {
                sections.push(Spanned::new(BarSection { until: until.value, element }, section.at.clone()));
            }
        }
        if self.errors.len() > errors {
            return None;
        }
        let Some(last) = sections.last() else {
            self.conflict(fields.place("sections"), "`sections` is empty; a bar has at least one section");
            return None;
        };
        let dimension =
            |section: &BarSection| souple_elements::by_id(&section.element).map(|element| element.dimension());
        if let Some(other) = sections.iter().find(|section| dimension(section) != dimension(&sections[0])) {
            let message = format!(
                "the elements of a bar are all solids, all surface elements or all edges; `{}` and `{}` are not alike",
                sections[0].element.value, other.element.value
            );
            self.conflict(other.element.at.clone(), message);
            return None;
        }
        for pair in sections.windows(2) {
            if pair[1].until <= pair[0].until {
                let problem = Problem::OutOfRange {
                    key: "until".to_owned(),
                    expected: format!("greater than {}, where the section before it ends", pair[0].until),
                    found: pair[1].until.to_string(),
                    hint: None,
                };
                self.error(pair[1].at.clone(), problem);
                return None;
            }
        }
        if last.until != 1.0 {
            let problem = Problem::OutOfRange {
                key: "until".to_owned(),
                expected: "1.0 in the last section, the end of the bar".to_owned(),
                found: last.until.to_string(),
                hint: None,
            };
            self.error(last.at.clone(), problem);
            return None;
        }
        Some(sections)
    }
}
