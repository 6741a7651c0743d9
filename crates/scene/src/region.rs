//! Regions: which nodes and elements a condition, a material or a probe applies to.
//!
//! ```toml
//! region = "all"
//! region = "x_max"                                            # a region of this body, or of its mesh
//! region = { box = { min = [0, 0, 0], max = [1, 1, 1] } }
//! region = { and = ["x_max", { not = { element = "tet4" } }] }
//! ```
//!
//! Which names a mesh has is not known here: whoever builds the mesh reports a region that selects nothing, with the
//! place that each [`Region`] carries.

use serde::Serialize;

use crate::dimension::Dimension;
use crate::location::Spanned;
use crate::node::{Node, Value};
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

/// A selection and where it was written.
pub type Region = Spanned<Selection>;

/// What is selected. Points are rest positions.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Selection {
    /// Everything.
    All,
    /// A region defined in the body, a face of a generator, or a group of the mesh file, looked up in this order.
    Name(String),
    /// Elements with this id, and their nodes.
    Element(String),
    /// An axis-aligned box, its surface included.
    Box {
        /// Least coordinates (m).
        min: [f64; 3],
        /// Largest coordinates (m).
        max: [f64; 3],
    },
    /// A ball, its surface included.
    Sphere {
        /// Centre (m).
        centre: [f64; 3],
        /// Radius (m).
        radius: f64,
    },
    /// The half-space that the normal points to, the plane included: (x − point) · normal ≥ 0.
    Plane {
        /// A point of the plane (m).
        point: [f64; 3],
        /// Its normal, not zero, of any length.
        normal: [f64; 3],
    },
    /// Whatever is at most this far (m) from the body's surface.
    NearSurface(f64),
    /// In every one of these; at least one.
    And(Vec<Region>),
    /// In any of these; at least one.
    Or(Vec<Region>),
    /// Not in this one.
    Not(Box<Region>),
}

/// The forms of a region that are tables; exactly one key is given.
pub(crate) static REGION: Section = Section {
    header: "a region",
    about: "`\"all\"`, a name, or a table with exactly one of these keys",
    keys: &[
        Key { name: "element", kind: Kind::Element, presence: ONE, about: "elements of this type, and their nodes" },
        Key { name: "box", kind: Kind::Table(&BOX), presence: ONE, about: "what lies in an axis-aligned box" },
        Key { name: "sphere", kind: Kind::Table(&SPHERE), presence: ONE, about: "what lies in a ball" },
        Key {
            name: "plane",
            kind: Kind::Table(&PLANE),
            presence: ONE,
            about: "what lies on the side of a plane that its normal points to",
        },
        Key {
            name: "near_surface",
            kind: Kind::Number(Dimension::LENGTH, Range::NOT_NEGATIVE),
            presence: ONE,
            about: "what is at most this far from the body's surface",
        },
        Key { name: "and", kind: Kind::Regions, presence: ONE, about: "what is in all of these regions" },
        Key { name: "or", kind: Kind::Regions, presence: ONE, about: "what is in any of these regions" },
        Key { name: "not", kind: Kind::Region, presence: ONE, about: "what is not in this region" },
    ],
    other_keys: None,
};

const ONE: Presence = Presence::Optional("another key is given");

static BOX: Section = Section {
    header: "{ box = … }",
    about: "an axis-aligned box in the rest shape, its surface included",
    keys: &[
        Key {
            name: "min",
            kind: Kind::Vector(Dimension::LENGTH, Range::ANY),
            presence: Presence::Required,
            about: "the corner with the least coordinates",
        },
        Key {
            name: "max",
            kind: Kind::Vector(Dimension::LENGTH, Range::ANY),
            presence: Presence::Required,
            about: "the opposite corner",
        },
    ],
    other_keys: None,
};

static SPHERE: Section = Section {
    header: "{ sphere = … }",
    about: "a ball in the rest shape, its surface included",
    keys: &[
        Key {
            name: "centre",
            kind: Kind::Vector(Dimension::LENGTH, Range::ANY),
            presence: Presence::Required,
            about: "the centre",
        },
        Key {
            name: "radius",
            kind: Kind::Number(Dimension::LENGTH, Range::POSITIVE),
            presence: Presence::Required,
            about: "the radius",
        },
    ],
    other_keys: None,
};

static PLANE: Section = Section {
    header: "{ plane = … }",
    about: "a half-space of the rest shape, its plane included",
    keys: &[
        Key {
            name: "point",
            kind: Kind::Vector(Dimension::LENGTH, Range::ANY),
            presence: Presence::Required,
            about: "a point of the plane",
        },
        Key {
            name: "normal",
            kind: Kind::Direction,
            presence: Presence::Required,
            about: "points to the side that is selected; any length",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    /// The region of a key.
    pub(crate) fn region(&mut self, fields: &Fields<'_>, name: &str) -> Option<Region> {
        debug_assert!(matches!(fields.section.key(name).map(|key| key.kind), Some(Kind::Region)));
        self.region_of(name, fields.node(name)?)
    }

    fn region_of(&mut self, name: &str, node: &Node) -> Option<Region> {
        let selection = match &node.value {
            Value::Text(text) if text == "all" => Selection::All,
            Value::Text(text) if !text.trim().is_empty() => Selection::Name(text.clone()),
            Value::Table(_) => self.selection(node)?,
            _ => {
                self.wrong_type(name, "a region: \"all\", a name, or a table such as { element = \"hex8\" }", node);
                return None;
            }
        };
        Some(Spanned::new(selection, node.at.clone()))
    }

    /// A region that is a table: exactly one key.
    fn selection(&mut self, node: &Node) -> Option<Selection> {
        let errors = self.errors.len();
        let fields = self.fields("region", node, &REGION)?;
        let mut given = REGION.keys.iter().filter(|key| fields.has(key.name));
        let Some(key) = given.next() else {
            // An unknown key was reported already.
            if self.errors.len() == errors {
                let known: Vec<&str> = REGION.keys.iter().map(|key| key.name).collect();
                self.conflict(node.at.clone(), format!("a region needs exactly one of {}", known.join(", ")));
            }
            return None;
        };
        if let Some(second) = given.next() {
            let message = format!(
                "a region has exactly one key, found `{}` and `{}`; combine them with {{ and = [{{ {} = … }}, {{ {} = … }}] }}",
                key.name, second.name, key.name, second.name
            );
            self.conflict(fields.place(second.name), message);
            return None;
        }
        match key.name {
            "element" => Some(Selection::Element(self.element(&fields, "element")?.value)),
            "box" => self.region_box(&fields),
            "sphere" => {
                let sphere = self.table(&fields, "sphere")?;
                let (centre, radius) = (self.vector(&sphere, "centre"), self.number(&sphere, "radius"));
                Some(Selection::Sphere { centre: centre?.value, radius: radius?.value })
            }
            "plane" => {
                let plane = self.table(&fields, "plane")?;
                let (point, normal) = (self.vector(&plane, "point"), self.vector(&plane, "normal"));
                Some(Selection::Plane { point: point?.value, normal: normal?.value })
            }
            "near_surface" => Some(Selection::NearSurface(self.number(&fields, "near_surface")?.value)),
            "and" => Some(Selection::And(self.regions(&fields, "and")?)),
            "or" => Some(Selection::Or(self.regions(&fields, "or")?)),
            "not" => Some(Selection::Not(Box::new(self.region(&fields, "not")?))),
            other => unreachable!("the schema of regions lists `{other}`, which nobody reads"),
        }
    }

    fn region_box(&mut self, fields: &Fields<'_>) -> Option<Selection> {
        let corners = self.table(fields, "box")?;
        let (min, max) = (self.vector(&corners, "min"), self.vector(&corners, "max"));
        let (min, max) = (min?, max?);
        if let Some(axis) = (0..3).find(|&axis| min[axis] > max[axis]) {
            let name = ["x", "y", "z"][axis];
            let message = format!("the box is empty: along {name}, `min` is {} and `max` is {}", min[axis], max[axis]);
            self.conflict(min.at, message);
            return None;
        }
        Some(Selection::Box { min: min.value, max: max.value })
    }

    fn regions(&mut self, fields: &Fields<'_>, name: &str) -> Option<Vec<Region>> {
        let node = fields.node(name)?;
        match &node.value {
            Value::Array(items) if !items.is_empty() => {
                let regions: Vec<Option<Region>> = items.iter().map(|item| self.region_of(name, item)).collect();
                regions.into_iter().collect()
            }
            _ => {
                self.wrong_type(name, "a list of at least one region", node);
                None
            }
        }
    }
}

/// The names that a region refers to, with their places, in the order of the text.
pub fn names(region: &Region) -> Vec<Spanned<&str>> {
    match &region.value {
        Selection::Name(name) => vec![Spanned::new(name.as_str(), region.at.clone())],
        Selection::And(parts) | Selection::Or(parts) => parts.iter().flat_map(names).collect(),
        Selection::Not(part) => names(part),
        _ => Vec::new(),
    }
}
