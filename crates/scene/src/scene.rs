//! The whole scene.

use serde::Serialize;

use crate::body::{BODY, Body};
use crate::dimension::Dimension;
use crate::expect::{EXPECT, Expectation};
use crate::integrator::{INTEGRATOR, Integrator, Method};
use crate::linear_solver::{LINEAR_SOLVER, LinearSolver};
use crate::location::Spanned;
use crate::node::{Node, Value};
use crate::output::{OUTPUT, Output};
use crate::probe::{PROBE, Probe};
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::region::{self, Region};
use crate::schema::{Key, Kind, Presence, Section};
use crate::tie::{TIE, Tie};
use crate::time::{TIME, Time};

/// Everything that a scene says; all values in SI units, angles in degrees.
///
/// Two scenes are equal when they describe the same simulation, wherever their values were written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Scene {
    /// Title (default empty).
    pub title: String,
    /// Acceleration of gravity (m/s²; default 0, 0, 0).
    pub gravity: [f64; 3],
    /// Steps and end; a quasi-static scene without `[time]` is one step of 1 s.
    pub time: Time,
    /// How a step is done.
    pub integrator: Integrator,
    /// How its linear systems are solved.
    pub linear_solver: LinearSolver,
    /// Bodies, at least one, with different names.
    pub bodies: Vec<Spanned<Body>>,
    /// Nodes glued to surfaces.
    pub ties: Vec<Spanned<Tie>>,
    /// Measurements, with different names.
    pub probes: Vec<Spanned<Probe>>,
    /// What is written.
    pub output: Output,
    /// What a run must give.
    pub expectations: Vec<Spanned<Expectation>>,
}

pub(crate) static SCENE: Section = Section {
    header: "the scene",
    about: "the top of the file, before the first table",
    keys: &[
        Key { name: "title", kind: Kind::Text, presence: Presence::Default("\"\""), about: "title" },
        Key {
            name: "gravity",
            kind: Kind::Vector(Dimension::ACCELERATION, Range::ANY),
            presence: Presence::Default("[0.0, 0.0, 0.0]"),
            about: "acceleration of gravity",
        },
        Key {
            name: "time",
            kind: Kind::Table(&TIME),
            presence: Presence::Optional("required, except with method \"quasi-static\": then one step of 1 s"),
            about: "how long is simulated, and in which steps",
        },
        Key {
            name: "integrator",
            kind: Kind::Table(&INTEGRATOR),
            presence: Presence::Optional("its defaults"),
            about: "how a step is done",
        },
        Key {
            name: "linear_solver",
            kind: Kind::Table(&LINEAR_SOLVER),
            presence: Presence::Optional("its defaults"),
            about: "how linear systems are solved",
        },
        Key {
            name: "body",
            kind: Kind::Tables(&BODY),
            presence: Presence::Required,
            about: "the bodies; at least one",
        },
        Key {
            name: "tie",
            kind: Kind::Tables(&TIE),
            presence: Presence::Optional("none"),
            about: "nodes glued to surfaces",
        },
        Key { name: "probe", kind: Kind::Tables(&PROBE), presence: Presence::Optional("none"), about: "measurements" },
        Key {
            name: "output",
            kind: Kind::Table(&OUTPUT),
            presence: Presence::Optional("its defaults"),
            about: "what is written",
        },
        Key {
            name: "expect",
            kind: Kind::Tables(&EXPECT),
            presence: Presence::Optional("none"),
            about: "what a run must give, for tests",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    /// The scene; `None` only after an error was noted.
    pub(crate) fn scene(&mut self, root: &Node) -> Option<Scene> {
        let fields = self.fields("the scene", root, &SCENE)?;
        let title = self.text(&fields, "title").map_or(String::new(), |title| title.value);
        let gravity = self.vector(&fields, "gravity").map_or([0.0; 3], |gravity| gravity.value);
        let integrator = match self.table(&fields, "integrator") {
            Some(table) => self.integrator(&table),
            None => Integrator::default(),
        };
        let time = self.scene_time(&fields, &integrator);
        let linear_solver = match self.table(&fields, "linear_solver") {
            Some(table) => self.linear_solver(&table),
            None => LinearSolver::default(),
        };
        // A body with errors is left out of `bodies`, but may be referred to all the same.
        let names = self.body_names(&fields);
        let bodies = self.list(&fields, "body", Self::body);
        if let Some(Node { value: Value::Array(items), .. }) = fields.node("body")
            && items.is_empty()
        {
            self.missing(&fields, "body");
        }
        self.unlike("body", bodies.iter().map(|body| &body.name));
        let ties = self.list(&fields, "tie", |reader, table| reader.tie(table, &names));
        let errors = self.errors.len();
        let probes = self.list(&fields, "probe", |reader, table| reader.probe(table, &names));
        self.unlike("probe", probes.iter().map(|probe| &probe.name));
        let output = match self.table(&fields, "output") {
            Some(table) => self.output(&table),
            None => Output::default(),
        };
        // A probe with errors is missing from `probes`; saying that it does not exist would mislead.
        let expectations = if self.errors.len() == errors {
            self.list(&fields, "expect", |reader, table| reader.expectation(table, &probes))
        } else {
            Vec::new()
        };
        let scene = Scene {
            title,
            gravity,
            time: time?,
            integrator,
            linear_solver,
            bodies,
            ties,
            probes,
            output,
            expectations,
        };
        if self.errors.is_empty() {
            self.named_regions(&scene);
        }
        Some(scene)
    }

    fn scene_time(&mut self, fields: &Fields<'_>, integrator: &Integrator) -> Option<Time> {
        if fields.has("time") {
            let table = self.table(fields, "time")?;
            return self.time(&table);
        }
        if integrator.method.value == Method::QuasiStatic {
            let one = Spanned::default_value(1.0);
            return Some(Time { step: one.clone(), end: one, stop: None });
        }
        self.missing(fields, "time");
        None
    }

    /// Names of all bodies in the order of the text, readable ones only.
    fn body_names(&self, fields: &Fields<'_>) -> Vec<String> {
        let Some(Node { value: Value::Array(items), .. }) = fields.node("body") else { return Vec::new() };
        let name = |item: &Node| match &item.value {
            Value::Table(entries) => entries.iter().find_map(|entry| match &entry.node.value {
                Value::Text(text) if entry.name == "name" => Some(text.clone()),
                _ => None,
            }),
            _ => None,
        };
        items.iter().filter_map(name).collect()
    }

    /// Notes cycles among named regions, and warns of those that nothing uses.
    fn named_regions(&mut self, scene: &Scene) {
        for (index, body) in scene.bodies.iter().enumerate() {
            let find = |name: &str| body.regions.iter().position(|region| *region.name == name);
            let edges: Vec<Vec<usize>> = body
                .regions
                .iter()
                .map(|named| region::names(&named.region).iter().filter_map(|name| find(name.value)).collect())
                .collect();
            for (start, named) in body.regions.iter().enumerate() {
                // A circle is reported at its first region only.
                let reported =
                    || (0..start).any(|first| reaches(&edges, first, start) && reaches(&edges, start, first));
                if reaches(&edges, start, start) && !reported() {
                    let message = format!(
                        "region \"{}\" is defined by itself; regions must not refer to each other in a circle",
                        *named.name
                    );
                    self.conflict(named.region.at.clone(), message);
                }
            }
            let used: Vec<usize> = regions_of(scene, index)
                .flat_map(region::names)
                .filter_map(|name| find(name.value))
                .chain(edges.iter().flatten().copied())
                .collect();
            for (at, named) in body.regions.iter().enumerate() {
                if !used.contains(&at) {
                    self.warn(named.name.at.clone(), format!("region \"{}\" is not used", *named.name));
                }
            }
        }
    }
}

/// Whether following edges from `start` leads to `end`, by at least one edge.
fn reaches(edges: &[Vec<usize>], start: usize, end: usize) -> bool {
    let mut seen = vec![false; edges.len()];
    let mut open = edges[start].clone();
    while let Some(next) = open.pop() {
        if next == end {
            return true;
        }
        if !std::mem::replace(&mut seen[next], true) {
            open.extend(&edges[next]);
        }
    }
    false
}

/// Every region that a scene uses on a body, its named regions' own definitions apart.
pub fn regions_of(scene: &Scene, body: usize) -> impl Iterator<Item = &Region> {
    let b = &scene.bodies[body];
    let own = (b.materials.iter().map(|m| &m.region))
        .chain(b.fixes.iter().map(|f| &f.region))
        .chain(b.moves.iter().map(|m| &m.region))
        .chain(b.forces.iter().map(|f| &f.region))
        .chain(b.tractions.iter().map(|t| &t.region))
        .chain(b.pressures.iter().map(|p| &p.region));
    let ties = scene.ties.iter().flat_map(move |tie| {
        let from = (tie.body.value == body).then_some(&tie.region);
        let to = (tie.to_body.value == body).then_some(&tie.to_region);
        from.into_iter().chain(to)
    });
    let probes = scene
        .probes
        .iter()
        .filter(move |probe| probe.body.as_ref().is_none_or(|at| at.value == body))
        .map(|probe| &probe.region);
    own.chain(ties).chain(probes)
}
