//! What can be drawn: a number of each simulation for each quantity, with its unit.
//!
//! | kind | quantities |
//! |---|---|
//! | size | nodes, elements, edge of a cell |
//! | time | of the process, of a step and its phases, steps per second |
//! | measure | single numbers of probes |
//! | error | tip against Timoshenko; each probe against the finest simulation of the same problem; `[[expect]]` |
//!
//! The finest simulation of a problem is the one with the most nodes among those that came to their end and differ only
//! in how they compute: mesh, element, time step, integrator, linear solver, device.

use super::cantilever::{Cantilever, bar, cantilever};
use super::data::{Curve, Done, Group, Simulation};
use super::scene::{Scenes, value};
use super::units::unit_of_quantity;
use serde::Serialize;
use souple_simulation::scene::Scene;
use souple_simulation::scene::integrator::Method;
use std::collections::{BTreeMap, BTreeSet};

/// What a quantity is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// How much there is to compute.
    Size,
    /// How long it takes.
    Time,
    /// What a probe measured.
    Measure,
    /// How far a result is from a better one.
    Error,
}

/// A number of each simulation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// What it is about.
    pub kind: Kind,
    /// Where it comes from.
    pub about: String,
    /// Of each simulation; none where it is missing.
    pub values: Vec<Option<f64>>,
}

/// Everything that is computed from a group for its report.
#[derive(Clone, Debug)]
pub struct Derived {
    /// All quantities, those that no simulation has left out.
    pub quantities: Vec<Quantity>,
    /// Of each simulation, the beam that it is.
    pub beams: Vec<Option<Cantilever>>,
    /// Of each simulation, the number of the one that its errors are measured against.
    pub references: Vec<Option<usize>>,
}

/// Computes the quantities of a group.
pub fn derive(group: &Group) -> Derived {
    let scenes = Scenes::of(group);
    let all: Vec<Option<Scene>> = group.simulations.iter().map(|s| scenes.scene(s)).collect();
    let beams: Vec<Option<Cantilever>> = group
        .simulations
        .iter()
        .zip(&all)
        .map(|(s, scene)| {
            let (scene, done) = (scene.as_ref()?, s.done.as_ref()?);
            // What still moves at its end is compared with no balance.
            let balanced = done.status == "at rest" || scene.integrator.method.value == Method::QuasiStatic;
            cantilever(scene, &done.materials).filter(|_| balanced)
        })
        .collect();
    let cells: Vec<Option<f64>> = all.iter().map(|scene| cell_edge(scene.as_ref()?)).collect();
    let references = references(group);
    let mut quantities = sizes_and_times(group, &cells);
    quantities.extend(measures(group));
    quantities.extend(errors(group, &beams, &references));
    quantities.retain(|q| q.values.iter().any(Option::is_some));
    Derived { quantities, beams, references }
}

/// Edge (m) of a cube (in the plane: a square) as large as a cell of the bar.
fn cell_edge(scene: &Scene) -> Option<f64> {
    let (bar, dimension) = bar(scene)?;
    let edges = (0..dimension).map(|k| bar.size.value[k] / f64::from(bar.cells.value[k]));
    Some(edges.product::<f64>().powf(1.0 / dimension as f64))
}

fn of_done(group: &Group, each: impl Fn(&Done) -> Option<f64>) -> Vec<Option<f64>> {
    group.simulations.iter().map(|s| s.done.as_ref().and_then(&each).filter(|x| x.is_finite())).collect()
}

fn sizes_and_times(group: &Group, cells: &[Option<f64>]) -> Vec<Quantity> {
    let quantity = |name: &str, unit: &str, kind, about: &str, values| Quantity {
        name: name.to_owned(),
        unit: unit.to_owned(),
        kind,
        about: about.to_owned(),
        values,
    };
    let phase = |d: &Done, name: &str| d.timings.iter().find(|(phase, _)| phase == name).map(|(_, ms)| *ms);
    let mut all = vec![
        quantity("nodes", "", Kind::Size, "nodes of all bodies", of_done(group, |d| Some(d.nodes? as f64))),
        quantity(
            "elements",
            "",
            Kind::Size,
            "deformable elements of all kinds",
            of_done(group, |d| (!d.elements.is_empty()).then(|| d.elements.iter().map(|(_, n)| *n as f64).sum())),
        ),
        quantity("cell size", "m", Kind::Size, "edge of a cube as large as a cell of the bar", cells.to_vec()),
        quantity(
            "wall time",
            "s",
            Kind::Time,
            "of the process, with its start and its output",
            of_done(group, |d| d.steps.map(|_| d.wall_s)),
        ),
        quantity(
            "steps per second",
            "1/s",
            Kind::Time,
            "of the steps alone",
            of_done(group, |d| phase(d, "step").filter(|&ms| ms > 0.0).map(|ms| 1000.0 / ms)),
        ),
        quantity("time per step", "ms", Kind::Time, "mean of all steps", of_done(group, |d| phase(d, "step"))),
    ];
    let phases: BTreeSet<&str> = dones(group).flat_map(|d| d.timings.iter().map(|(p, _)| p.as_str())).collect();
    for name in phases.into_iter().filter(|&p| p != "step") {
        let shown = format!("time per step: {}", name.replace('_', " "));
        all.push(quantity(&shown, "ms", Kind::Time, "part of a step", of_done(group, |d| phase(d, name))));
    }
    let steps = of_done(group, |d| Some(d.steps? as f64));
    all.push(quantity("steps", "", Kind::Measure, "steps made", steps));
    all.push(quantity("simulated time", "s", Kind::Measure, "when it ended", of_done(group, |d| d.simulated_s)));
    all
}

fn dones(group: &Group) -> impl Iterator<Item = &Done> {
    group.simulations.iter().filter_map(|s| s.done.as_ref())
}

fn measures(group: &Group) -> Vec<Quantity> {
    let names: BTreeSet<(&str, &str, &str)> = dones(group)
        .flat_map(|d| &d.measurements)
        .map(|m| (m.probe.as_str(), m.quantity.as_str(), m.component.as_str()))
        .collect();
    names
        .into_iter()
        .map(|(probe, quantity, component)| Quantity {
            name: [probe, quantity, component].join(" ").trim_end().to_owned(),
            unit: unit_of_quantity(quantity).to_owned(),
            kind: Kind::Measure,
            about: format!("probe \"{probe}\""),
            values: of_done(group, |d| {
                let same = |m: &&super::data::Measurement| {
                    (m.probe.as_str(), m.quantity.as_str(), m.component.as_str()) == (probe, quantity, component)
                };
                d.measurements.iter().find(same).map(|m| m.value)
            }),
        })
        .collect()
}

/// Whether a parameter says how something is computed, and not what.
pub fn is_numerical(parameter: &str) -> bool {
    let folder = ["nbCube", "typeIntegration", "pas", "epsilonStable"];
    let starts = ["time.step", "time.stop", "integrator", "linear_solver", "output"];
    let parts =
        [".mesh.cells", ".mesh.sections", ".mesh.element", ".mesh.tetrahedra", ".mesh.prism_axis", ".mesh.path"];
    folder.contains(&parameter)
        || starts.iter().any(|s| parameter.starts_with(s))
        || parts.iter().any(|p| parameter.contains(p))
        || parameter.contains(".quadrature")
}

/// What a simulation computes, without how: values of the other parameters, and the laws of its bar.
fn problem(group: &Group, simulation: &Simulation) -> String {
    let mut words: Vec<String> = group
        .parameters
        .iter()
        .zip(&simulation.values)
        .filter(|(p, _)| !is_numerical(&p.name))
        .map(|(_, v)| v.as_deref().map_or(String::new(), |v| value(v).to_string()))
        .collect();
    let mut laws: Vec<(String, &str)> = Vec::new();
    for section in simulation.bar.iter().flat_map(|&b| &group.bars[b].sections) {
        // Sections of one law are one, whatever their elements.
        match laws.last_mut() {
            Some(last) if last.1 == section.law => last.0 = format!("{:?}", section.until),
            _ => laws.push((format!("{:?}", section.until), &section.law)),
        }
    }
    words.extend(laws.into_iter().map(|(until, law)| format!("{until} {law}")));
    words.join("\n")
}

/// Of each simulation, the finest one of its problem, unless it is that one.
fn references(group: &Group) -> Vec<Option<usize>> {
    let mut finest: BTreeMap<String, (i64, usize)> = BTreeMap::new();
    let problems: Vec<String> = group.simulations.iter().map(|s| problem(group, s)).collect();
    for (s, problem) in group.simulations.iter().zip(&problems) {
        let Some(nodes) = s.done.as_ref().filter(|d| d.succeeded()).and_then(|d| d.nodes) else { continue };
        let best = finest.entry(problem.clone()).or_insert((nodes, s.number));
        if nodes > best.0 {
            *best = (nodes, s.number);
        }
    }
    let of = |(s, problem): (&Simulation, &String)| {
        finest.get(problem).map(|&(_, number)| number).filter(|&number| number != s.number)
    };
    group.simulations.iter().zip(&problems).map(of).collect()
}

/// The list of positions that is a deflection curve.
pub fn deflection(done: &Done) -> Option<&Curve> {
    done.curves.iter().find(|c| c.quantity == "deflection curve" && c.points.len() > 1)
}

/// |a − b| / |b|; none where there is nothing to compare.
fn relative(a: &[f64], b: &[f64]) -> Option<f64> {
    let norm = |v: &mut dyn Iterator<Item = f64>| v.map(|x| x * x).sum::<f64>().sqrt();
    let size = norm(&mut b.iter().copied());
    (a.len() == b.len() && size > 0.0).then(|| norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / size)
}

fn errors(group: &Group, beams: &[Option<Cantilever>], references: &[Option<usize>]) -> Vec<Quantity> {
    let done = |at: usize| group.simulations[at].done.as_ref().filter(|d| d.succeeded());
    let each = |f: &dyn Fn(usize) -> Option<f64>| -> Vec<Option<f64>> {
        (0..group.simulations.len()).map(|at| f(at).filter(|x| x.is_finite())).collect()
    };
    let mut all = vec![Quantity {
        name: "tip against Timoshenko".to_owned(),
        unit: String::new(),
        kind: Kind::Error,
        about: "|tip − Timoshenko| / |Timoshenko|; beam theory itself holds for small deflections of slender beams"
            .to_owned(),
        values: each(&|at| {
            let (beam, done) = (beams[at]?, done(at)?);
            let points = &deflection(done)?.points;
            let tip = points.last()?[beam.axis] - points.first()?[beam.axis];
            relative(&[tip], &[beam.timoshenko(beam.length)])
        }),
    }];
    let by_number: BTreeMap<usize, usize> =
        group.simulations.iter().enumerate().map(|(at, s)| (s.number, at)).collect();
    let finest = |at: usize| done(*by_number.get(&references[at]?)?);
    let names: BTreeSet<(&str, &str)> = dones(group)
        .flat_map(|d| &d.measurements)
        .filter(|m| m.probe != super::SOLVER)
        .map(|m| (m.probe.as_str(), m.quantity.as_str()))
        .collect();
    let about = "relative to the simulation with the most nodes among those of the same problem";
    for (probe, quantity) in names {
        let vector = |d: &Done| -> Vec<f64> {
            let of = d.measurements.iter().filter(|m| (m.probe.as_str(), m.quantity.as_str()) == (probe, quantity));
            of.map(|m| m.value).collect()
        };
        all.push(Quantity {
            name: format!("{probe} {quantity} against the finest"),
            unit: String::new(),
            kind: Kind::Error,
            about: about.to_owned(),
            values: each(&|at| relative(&vector(done(at)?), &vector(finest(at)?))),
        });
    }
    all.push(Quantity {
        name: "tip of the curve against the finest".to_owned(),
        unit: String::new(),
        kind: Kind::Error,
        about: about.to_owned(),
        values: each(&|at| {
            let way = |d: &Done| {
                let points = &deflection(d)?.points;
                let (first, last) = (points.first()?, points.last()?);
                Some([last[1] - first[1], last[2] - first[2]])
            };
            relative(&way(done(at)?)?, &way(finest(at)?)?)
        }),
    });
    let expected: BTreeSet<&str> = dones(group).flat_map(|d| d.expectations.iter().map(|e| e.name.as_str())).collect();
    for name in expected {
        all.push(Quantity {
            name: format!("expected: {name}"),
            unit: String::new(),
            kind: Kind::Error,
            about: "what the scene's [[expect]] compared, in the units of its probe".to_owned(),
            values: of_done(group, |d| d.expectations.iter().find(|e| e.name == name).and_then(|e| e.difference)),
        });
    }
    all
}
