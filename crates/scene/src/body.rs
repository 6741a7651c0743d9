//! `[[body]]`: a meshed body with its materials, boundary conditions and loads.

use serde::Serialize;

use crate::choice::Named as _;
use crate::conforming::Conforming;
use crate::dimension::Dimension;
use crate::error::Problem;
use crate::load::{FORCE, Force, PRESSURE, Pressure, TRACTION, Traction};
use crate::location::Spanned;
use crate::material::{MATERIAL, Material};
use crate::mesh::{MESH, Mesh};
use crate::motion::{FIX, Fix, MOVE, Move};
use crate::node::{Node, Value, shortened};
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::region::Region;
use crate::schema::{Key, Kind, Presence, Section};

/// A body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Its name, unlike any other body's.
    pub name: Spanned<String>,
    /// Mass per rest volume (kg/m³), positive.
    pub density: Spanned<f64>,
    /// Velocity of every node at the start (m/s; default 0, 0, 0).
    pub initial_velocity: [f64; 3],
    /// Where its mesh comes from.
    pub mesh: Spanned<Mesh>,
    /// Whether nodes in the middle of a side of another element follow that side (default: they do).
    pub conforming: Conforming,
    /// Quadratures other than the elements' defaults, in the order of the elements' ids.
    pub quadrature: Vec<Spanned<Quadrature>>,
    /// Regions defined in the scene; they may refer to each other, without cycles.
    pub regions: Vec<Spanned<NamedRegion>>,
    /// Materials, at least one; later ones override earlier ones.
    pub materials: Vec<Spanned<Material>>,
    /// Held regions.
    pub fixes: Vec<Spanned<Fix>>,
    /// Moved regions.
    pub moves: Vec<Spanned<Move>>,
    /// Forces on nodes.
    pub forces: Vec<Spanned<Force>>,
    /// Dead loads on faces.
    pub tractions: Vec<Spanned<Traction>>,
    /// Pressures that follow the surface.
    pub pressures: Vec<Spanned<Pressure>>,
}

/// The quadrature of an element in this body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quadrature {
    /// Id of the element.
    pub element: String,
    /// Id of one of its rules (`"hexahedron-8"`), also where the scene gives the number of points.
    pub rule: String,
}

/// A region with a name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NamedRegion {
    /// Its name, unlike any other region's of the body.
    pub name: Spanned<String>,
    /// What it is.
    pub region: Region,
}

pub(crate) static BODY: Section = Section {
    header: "[[body]]",
    about: "a meshed body with its materials, boundary conditions and loads",
    keys: &[
        Key {
            name: "name",
            kind: Kind::Text,
            presence: Presence::Required,
            about: "its name, unlike any other body's: letters, digits, spaces, `_`, `-`, `.`; not a number",
        },
        Key {
            name: "density",
            kind: Kind::Number(Dimension::DENSITY, Range::POSITIVE),
            presence: Presence::Required,
            about: "mass per volume of the rest shape",
        },
        Key {
            name: "initial_velocity",
            kind: Kind::Vector(Dimension::VELOCITY, Range::ANY),
            presence: Presence::Default("[0.0, 0.0, 0.0]"),
            about: "velocity of every node at the start",
        },
        Key { name: "mesh", kind: Kind::Table(&MESH), presence: Presence::Required, about: "the mesh" },
        Key {
            name: "conforming",
            kind: Kind::Choice(Conforming::CHOICES),
            presence: Presence::Default("\"auto\""),
            about: "what nodes do that lie in the middle of a side of another element of this body",
        },
        Key {
            name: "quadrature",
            kind: Kind::Table(&QUADRATURE),
            presence: Presence::Optional("each element's default"),
            about: "quadratures other than the elements' defaults",
        },
        Key {
            name: "region",
            kind: Kind::Tables(&NAMED_REGION),
            presence: Presence::Optional("none"),
            about: "regions with a name",
        },
        Key {
            name: "material",
            kind: Kind::Tables(&MATERIAL),
            presence: Presence::Required,
            about: "materials; at least one",
        },
        Key { name: "fix", kind: Kind::Tables(&FIX), presence: NONE, about: "held regions" },
        Key { name: "move", kind: Kind::Tables(&MOVE), presence: NONE, about: "moved regions" },
        Key { name: "force", kind: Kind::Tables(&FORCE), presence: NONE, about: "forces on nodes" },
        Key { name: "traction", kind: Kind::Tables(&TRACTION), presence: NONE, about: "dead loads on faces" },
        Key { name: "pressure", kind: Kind::Tables(&PRESSURE), presence: NONE, about: "pressures on faces" },
    ],
    other_keys: None,
};

const NONE: Presence = Presence::Optional("none");

static QUADRATURE: Section = Section {
    header: "[body.quadrature]",
    about: "quadratures other than the elements' defaults",
    keys: &[],
    other_keys: Some(
        "Each key is the id of an element, its value one of the element's rules: the number of points (`8` or `\"8\"`) \
         or the rule's id (`\"hexahedron-8\"`).",
    ),
};

static NAMED_REGION: Section = Section {
    header: "[[body.region]]",
    about: "a region with a name, for use wherever this body has a region",
    keys: &[
        Key {
            name: "name",
            kind: Kind::Text,
            presence: Presence::Required,
            about: "its name; hides a region of the mesh with the same name",
        },
        Key { name: "region", kind: Kind::Region, presence: Presence::Required, about: "what it is" },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn body(&mut self, fields: &Fields<'_>) -> Option<Spanned<Body>> {
        let (name, density) = (self.name(fields), self.number(fields, "density"));
        let initial_velocity = self.vector(fields, "initial_velocity").map_or([0.0; 3], |velocity| velocity.value);
        let mesh = self.table(fields, "mesh").and_then(|table| self.mesh(&table));
        let conforming = self.choice(fields, "conforming").map_or(Conforming::Auto, |choice| choice.value);
        let quadrature = self.table(fields, "quadrature").map_or(Vec::new(), |table| self.quadrature(&table));
        let regions = self.list(fields, "region", Self::named_region);
        let materials = self.list(fields, "material", Self::material);
        let fixes = self.list(fields, "fix", Self::fix);
        let moves = self.list(fields, "move", Self::motion);
        let forces = self.list(fields, "force", Self::force);
        let tractions = self.list(fields, "traction", Self::traction);
        let pressures = self.list(fields, "pressure", Self::pressure);
        if let Some(Node { value: Value::Array(items), .. }) = fields.node("material")
            && items.is_empty()
        {
            self.missing(fields, "material");
        }
        self.unlike("region", regions.iter().map(|region| &region.name));
        let body = Body {
            name: name?,
            density: density?,
            initial_velocity,
            mesh: mesh?,
            conforming,
            quadrature,
            regions,
            materials,
            fixes,
            moves,
            forces,
            tractions,
            pressures,
        };
        Some(Spanned::new(body, fields.at.clone()))
    }

    /// Every table of a list through `read`; those with errors are left out.
    pub(crate) fn list<T>(
        &mut self,
        fields: &Fields<'_>,
        name: &str,
        mut read: impl FnMut(&mut Self, &Fields<'_>) -> Option<T>,
    ) -> Vec<T> {
        self.tables(fields, name).iter().filter_map(|table| read(self, table)).collect()
    }

    /// The name of a body or a probe: usable in file names, and not a number, which overrides use for positions.
    pub(crate) fn name(&mut self, fields: &Fields<'_>) -> Option<Spanned<String>> {
        let name = self.text(fields, "name")?;
        let allowed = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '_' | '-' | '.');
        let is_number = name.chars().all(|c| c.is_ascii_digit());
        if !is_number && name.chars().all(allowed) && name.starts_with(char::is_alphanumeric) {
            return Some(name);
        }
        let problem = Problem::OutOfRange {
            key: "name".to_owned(),
            expected: "letters, digits, spaces, `_`, `-`, `.`, starting with a letter or digit, and not only digits"
                .to_owned(),
            found: format!("\"{}\"", shortened(&name)),
            hint: None,
        };
        self.error(name.at, problem);
        None
    }

    /// Notes every name that was used before.
    pub(crate) fn unlike<'s>(&mut self, what: &'static str, names: impl Iterator<Item = &'s Spanned<String>>) {
        let mut seen: Vec<&Spanned<String>> = Vec::new();
        for name in names {
            match seen.iter().find(|first| first.value == name.value) {
                Some(first) => {
                    let problem = Problem::Duplicate { what, name: name.value.clone(), first: first.at.clone() };
                    self.error(name.at.clone(), problem);
                }
                None => seen.push(name),
            }
        }
    }

    fn named_region(&mut self, fields: &Fields<'_>) -> Option<Spanned<NamedRegion>> {
        let (name, region) = (self.text(fields, "name"), self.region(fields, "region"));
        let name = name?;
        if name.trim().is_empty() || name.value == "all" {
            let message = format!("a region cannot be named \"{}\"; give it another name", shortened(&name));
            self.conflict(name.at, message);
            return None;
        }
        Some(Spanned::new(NamedRegion { name, region: region? }, fields.at.clone()))
    }

    fn quadrature(&mut self, fields: &Fields<'_>) -> Vec<Spanned<Quadrature>> {
        let mut result: Vec<Spanned<Quadrature>> = Vec::new();
        for entry in &fields.others {
            let Some(element) = self.known_element(Spanned::new(entry.name.clone(), entry.at.clone())) else {
                continue;
            };
            let element = souple_elements::by_id(&element).expect("known_element found it");
            let name = match &entry.node.value {
                Value::Text(name) => name.clone(),
                Value::Integer(points) => points.to_string(),
                _ => {
                    self.wrong_type(&entry.name, "a number of points or the id of a rule", &entry.node);
                    continue;
                }
            };
            match element.rule(&name) {
                Some(rule) => {
                    let quadrature = Quadrature { element: element.id.to_owned(), rule: rule.id.to_owned() };
                    result.push(Spanned::new(quadrature, entry.node.at.clone()));
                }
                None => {
                    let known = element.quadratures.iter().map(|id| (*id).to_owned()).collect();
                    let what = format!("quadrature of {}", element.id);
                    self.unknown_name(&what, &Spanned::new(name, entry.node.at.clone()), known);
                }
            }
        }
        result.sort_by(|a, b| a.element.cmp(&b.element));
        result
    }
}
