//! The page: a frame of HTML with its style, its scripts and its data.
//!
//! Scripts are plain JavaScript, one file per concept in `page/`, joined into one function so that they share nothing with
//! whatever else there is. Data stand in a `<script type="application/json">`.

use super::data::{Group, Simulation};
use super::quantities::{Derived, deflection, derive, is_numerical};
use super::scene::value;
use super::units::unit_of_parameter;
use crate::group::Value;
use serde_json::{Value as Json, json};
use souple_simulation::scene::units::quantity_of_any_dimension;

const FRAME: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
const SCRIPTS: &[&str] = &[
    include_str!("page/format.js"),
    include_str!("page/scale.js"),
    include_str!("page/chart.js"),
    include_str!("page/model.js"),
    include_str!("page/filters.js"),
    include_str!("page/views.js"),
    include_str!("page/table.js"),
    include_str!("page/main.js"),
];

/// Points at which beams are drawn.
const BEAM_POINTS: usize = 41;

/// What the page says beside the group itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surroundings {
    /// Address of the folder of results, relative to the page; none: no links.
    pub results: Option<String>,
    /// Address of the data, where they change while one looks.
    pub live: Option<String>,
}

/// The page of a group.
pub fn html(group: &Group, surroundings: &Surroundings) -> String {
    let scripts = SCRIPTS.concat();
    let parts = [
        ("{{title}}", escaped(&group.name)),
        ("{{style}}", STYLE.to_owned()),
        ("{{data}}", embedded(&data(group, surroundings))),
        ("{{script}}", format!("(() => {{\n\"use strict\";\n{scripts}}})();\n")),
    ];
    // One pass: what is put in is not searched again.
    let mut out = String::new();
    let mut rest = FRAME;
    for (mark, text) in parts {
        let (before, after) = rest.split_once(mark).expect("the frame has its marks in this order");
        out.push_str(before);
        out.push_str(&text);
        rest = after;
    }
    out + rest
}

/// Text as it stands between tags and in attributes.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// JSON that no HTML parser takes for the end of its script: `<` occurs in strings only, where it can be escaped.
pub fn embedded(data: &Json) -> String {
    data.to_string().replace('<', "\\u003c")
}

/// Everything that the page shows.
pub fn data(group: &Group, surroundings: &Surroundings) -> Json {
    let derived = derive(group);
    let programs = distinct(group.simulations.iter().filter_map(|s| s.done.as_ref().map(|d| d.program.clone())));
    let simulations: Vec<Json> = group
        .simulations
        .iter()
        .zip(&derived.references)
        .map(|(s, reference)| simulation(s, *reference, surroundings))
        .collect();
    json!({
        "name": group.name,
        "folder": group.folder,
        "source": group.source,
        "scene": group.scene,
        "live": surroundings.live,
        "parameters": group.parameters.iter().map(|p| json!({
            "name": p.name, "unit": unit_of_parameter(&p.name), "variation": p.variation,
            "first": p.first, "last": p.last, "step": p.step, "count": p.count,
        })).collect::<Vec<_>>(),
        "bars": group.bars.iter().map(|b| json!({
            "name": b.name,
            "sections": b.sections.iter().map(|s| json!([s.until, s.law, s.element, s.quadrature])).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "machines": group.machines.iter().map(|m| json!({
            "host": m.host, "processor": m.processor, "cores": m.cores, "system": m.system,
        })).collect::<Vec<_>>(),
        "programs": programs,
        "factors": factors(group),
        "quantities": derived.quantities,
        "simulations": simulations,
        "curves": curves(group, &derived),
        "beams": beams(&derived),
    })
}

fn distinct(values: impl Iterator<Item = String>) -> Vec<String> {
    let mut all: Vec<String> = Vec::new();
    for value in values {
        if !all.contains(&value) {
            all.push(value);
        }
    }
    all
}

fn simulation(s: &Simulation, reference: Option<usize>, surroundings: &Surroundings) -> Json {
    let Some(done) = &s.done else { return json!({ "number": s.number, "status": "to do", "reason": "" }) };
    let elements: Vec<String> = done.elements.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    json!({
        "number": s.number,
        "status": done.status,
        "reason": done.reason,
        "machine": done.machine,
        "program": done.program,
        "threads": done.threads,
        "hash": done.hash,
        "elements": elements.join(", "),
        "reference": reference,
        "link": surroundings.results.as_ref().map(|folder| format!("{folder}/{}/", done.hash)),
    })
}

/// What distinguishes simulations: parameters, and bar, device and machine where there are several.
fn factors(group: &Group) -> Vec<Json> {
    let mut all = Vec::new();
    for (at, p) in group.parameters.iter().enumerate() {
        let values: Vec<Json> = group.simulations.iter().map(|s| json_of(s.values[at].as_deref())).collect();
        all.push(json!({
            "name": p.name, "unit": unit_of_parameter(&p.name), "drawn": p.variation == "latin hypercube",
            "multiplying": p.variation == "multiplying", "numerical": is_numerical(&p.name), "values": values,
        }));
    }
    let mut further = |name: &str, values: Vec<Option<String>>| {
        if distinct(values.iter().flatten().cloned()).len() > 1 {
            all.push(json!({
                "name": name, "unit": "", "drawn": false, "multiplying": false, "numerical": true, "values": values,
            }));
        }
    };
    let of = |each: &dyn Fn(&Simulation) -> Option<String>| group.simulations.iter().map(each).collect::<Vec<_>>();
    further("bar", of(&|s| s.bar.map(|b| group.bars[b].name.clone())));
    further("device", of(&|s| Some(s.device.clone())));
    further("machine", of(&|s| s.done.as_ref().map(|d| group.machines[d.machine].host.clone())));
    all
}

/// A value of a parameter: a number, also where it was written with a unit, or a text.
fn json_of(text: Option<&str>) -> Json {
    let Some(text) = text else { return Json::Null };
    match value(text) {
        Value::Whole(x) => json!(x),
        Value::Number(x) if x.is_finite() => json!(x),
        Value::Number(_) => json!(text),
        Value::Toml(text) => {
            let bare = text.trim_matches(['"', '\'']);
            quantity_of_any_dimension(bare).map_or_else(|_| json!(bare), |x| json!(x))
        }
    }
}

/// Deflection curves: place along the bar and deflection, in the direction of gravity or in the one that moves most.
fn curves(group: &Group, derived: &Derived) -> Vec<Json> {
    let mut all = Vec::new();
    for (at, s) in group.simulations.iter().enumerate() {
        let Some(curve) = s.done.as_ref().filter(|d| d.succeeded()).and_then(deflection) else { continue };
        let first = curve.points[0];
        let reach = |axis: usize| curve.points.iter().map(|p| (p[axis] - first[axis]).abs()).fold(0.0, f64::max);
        let axis = derived.beams[at].map_or(if reach(2) > reach(1) { 2 } else { 1 }, |b| b.axis);
        let x: Vec<f64> = curve.points.iter().map(|p| p[0]).collect();
        let w: Vec<f64> = curve.points.iter().map(|p| p[axis] - first[axis]).collect();
        all.push(json!({ "at": at, "probe": curve.probe, "x": x, "w": w }));
    }
    all
}

/// Each different beam with the simulations that are it.
fn beams(derived: &Derived) -> Vec<Json> {
    let mut all: Vec<(super::cantilever::Cantilever, Vec<usize>)> = Vec::new();
    for (at, beam) in derived.beams.iter().enumerate() {
        let Some(beam) = beam else { continue };
        match all.iter_mut().find(|(b, _)| b == beam) {
            Some((_, simulations)) => simulations.push(at),
            None => all.push((*beam, vec![at])),
        }
    }
    all.into_iter()
        .map(|(beam, simulations)| {
            let x: Vec<f64> = (0..BEAM_POINTS).map(|k| beam.length * k as f64 / (BEAM_POINTS - 1) as f64).collect();
            json!({
                "simulations": simulations,
                "euler_bernoulli": x.iter().map(|&x| beam.euler_bernoulli(x)).collect::<Vec<_>>(),
                "timoshenko": x.iter().map(|&x| beam.timoshenko(x)).collect::<Vec<_>>(),
                "x": x,
                "tip_over_length": (beam.timoshenko(beam.length) / beam.length).abs(),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A text that ends a script in HTML cannot end that of the data, and the data are read back as they were.
    #[test]
    fn data_cannot_leave_their_script() {
        let data = json!({ "reason": "</script><script>alert(1)</script><!-- \u{2028}" });
        let text = embedded(&data);
        assert!(!text.contains('<'), "{text}");
        assert_eq!(serde_json::from_str::<Json>(&text).unwrap(), data);
    }

    /// Values are numbers wherever they can be, units included.
    #[test]
    fn values_are_numbers_where_they_can_be() {
        for (text, expected) in [
            ("3", json!(3)),
            ("2.5e3", json!(2500.0)),
            ("\"1 g/cm^3\"", json!(1000.0)),
            ("\"rk4\"", json!("rk4")),
            ("[5, 1, 1]", json!("[5, 1, 1]")),
            ("inf", json!("inf")),
        ] {
            assert_eq!(json_of(Some(text)), expected, "{text}");
        }
        assert_eq!(json_of(None), Json::Null);
    }
}
