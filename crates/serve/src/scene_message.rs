//! The first message to every client: all that does not change while the simulation runs.
//!
//! | array | type | what |
//! |---|---|---|
//! | `rest` | f32 | positions of surface nodes at rest in m, [node][axis] |
//! | `numbers` | u32 | the simulation's number of each surface node |
//! | `triangles` | u32 | surface nodes, [triangle][corner] |
//! | `edges` | u32 | surface nodes, [piece][end] |
//! | `cables` | u32 | surface nodes, [piece][end] |
//! | `groups` | u16 | [triangle, then piece of a cable][grouping], groupings as in the header |

use crate::colours::{VIRIDIS, choices, hexadecimal};
use crate::message::{Array, encode};
use crate::surface::{GROUPINGS, Surface};
use serde_json::{Map, Value, json};
use souple_simulation::Simulation;

/// Number of the protocol: pages of another one reload themselves.
pub const PROTOCOL: u32 = 1;

/// Encodes the message.
pub fn scene_message(simulation: &Simulation, surface: &Surface) -> Vec<u8> {
    let all = &simulation.prepared().nodes;
    let rest: Vec<f32> = surface.nodes.iter().flat_map(|&n| all[n as usize].map(|x| x as f32)).collect();
    let owners = surface.owners.iter().chain(&surface.cable_owners);
    let groups: Vec<u16> = owners.flat_map(|&e| surface.groups_of[e as usize]).collect();
    let legends: Map<String, Value> = GROUPINGS
        .iter()
        .zip(&surface.groups)
        .map(|(name, groups)| {
            let entry = |g: &crate::surface::Group| json!({ "name": g.name, "colour": hexadecimal(g.colour) });
            ((*name).to_owned(), groups.iter().map(entry).collect())
        })
        .collect();
    let colours: Vec<Value> = choices()
        .iter()
        .map(|c| json!({ "key": c.key, "name": c.name, "unit": c.unit, "computed": c.field.is_some() }))
        .collect();
    let gravity = simulation.scene().gravity;
    let header = [
        ("kind", json!("scene")),
        ("protocol", json!(PROTOCOL)),
        ("title", json!(simulation.scene().title)),
        ("nodes", json!(surface.nodes.len())),
        ("elements", json!(surface.element_count)),
        ("all_nodes", json!(all.len())),
        ("dimension", json!(simulation.dimension())),
        ("up", json!(gravity.map(|g| -g))),
        ("closed", json!(surface.closed)),
        ("stiffness", json!(fair_stiffness(simulation))),
        ("groupings", json!(GROUPINGS)),
        ("legends", Value::Object(legends)),
        ("colours", json!(colours)),
        ("map", json!(VIRIDIS.map(|c| format!("#{c:06x}")))),
    ];
    let header = header.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
    let arrays = [
        ("rest", Array::F32(&rest)),
        ("numbers", Array::U32(&surface.nodes)),
        ("triangles", Array::U32(surface.triangles.as_flattened())),
        ("edges", Array::U32(surface.edges.as_flattened())),
        ("cables", Array::U32(surface.cables.as_flattened())),
        ("groups", Array::U16(&groups)),
    ];
    encode(header, &arrays)
}

/// A spring that a body feels and bears, in N/m: at a tenth of the body's length it pulls with the body's weight.
///
/// A soft body that carries its own weight is about as stiff; what has no mass to speak of gets 100 N/m.
fn fair_stiffness(simulation: &Simulation) -> f64 {
    let nodes = &simulation.prepared().nodes;
    let side = |k: usize| {
        let (low, high) = nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), n| (l.min(n[k]), h.max(n[k])));
        high - low
    };
    let length = (0..3).map(|k| side(k).powi(2)).sum::<f64>().sqrt();
    let stiffness = 9.81 * simulation.mass() / (0.1 * length);
    if stiffness.is_finite() && stiffness > 0.0 { stiffness.clamp(1e-6, 1e9) } else { 100.0 }
}
