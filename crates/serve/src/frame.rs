//! What is to be seen at one moment, as it goes over the wire: one message, so that numbers and positions belong together.
//!
//! | array | type | what |
//! |---|---|---|
//! | `positions` | f32 | positions of surface nodes in m, [node][axis] |
//! | `values` | f32 | the field that this client watches, one per surface node; missing without one |

use crate::colours::key;
use crate::message::{Array, encode};
use crate::surface::Surface;
use serde_json::{Map, Value, json};
use souple_simulation::ElementField;
use souple_simulation::session::{Sample, Snapshot};

/// What a frame says beside its snapshot.
#[derive(Clone, Debug, Default)]
pub struct Beside {
    /// Steps per second of the last second.
    pub steps_per_second: f64,
    /// Numbers of the last step.
    pub sample: Option<Sample>,
    /// Clients that look.
    pub clients: usize,
    /// Simulated seconds per second that were asked for; `None` is as fast as it goes.
    pub speed: Option<f64>,
}

/// Encodes a frame for those that watch a field, or none.
pub fn frame_message(surface: &Surface, snapshot: &Snapshot, field: Option<ElementField>, beside: &Beside) -> Vec<u8> {
    let positions: Vec<f32> = surface.nodes.iter().flat_map(|&n| snapshot.positions[n as usize]).collect();
    let mut values = None;
    let mut field_header = Value::Null;
    if let Some(field) = field
        && let Some(of_elements) = snapshot.field(field)
        && of_elements.len() == surface.element_count
    {
        let at_nodes = surface.at_nodes(of_elements);
        let [low, high] = range(&at_nodes);
        field_header = json!({ "key": key(field), "low": low, "high": high });
        values = Some(at_nodes);
    }
    let hand = |(number, pull): &(u32, souple_simulation::interaction::PullState)| json!({ "hand": number, "point": pull.point, "target": pull.target, "force": pull.force });
    let controls = snapshot.controls.as_deref();
    let header = [
        ("kind", json!("frame")),
        ("step", json!(snapshot.step)),
        ("time", json!(snapshot.time)),
        ("playing", json!(snapshot.playing && snapshot.ending.is_none())),
        ("ending", json!(snapshot.ending)),
        ("speed", json!(beside.speed)),
        ("real_time_factor", json!(snapshot.real_time_factor)),
        ("steps_per_second", json!(beside.steps_per_second)),
        ("cg_iterations", json!(beside.sample.map(|s| s.cg_iterations))),
        ("step_milliseconds", json!(beside.sample.map(|s| s.milliseconds))),
        ("kinetic_energy", json!(beside.sample.map(|s| s.kinetic_energy))),
        ("strain_energy", json!(beside.sample.map(|s| s.strain_energy))),
        ("pulls", snapshot.pulls.iter().map(hand).collect()),
        ("gravity", json!(controls.map(|c| c.gravity))),
        ("damping", json!(controls.map(|c| c.velocity_damping))),
        ("time_step", json!(controls.map(|c| c.step))),
        ("field", field_header),
        ("inverted", json!(snapshot.inverted.len())),
        ("error", json!(snapshot.error)),
        ("warning", json!(snapshot.warnings.last())),
        ("clients", json!(beside.clients)),
    ];
    let header: Map<String, Value> = header.into_iter().map(|(k, v)| (k.to_owned(), v)).collect();
    match &values {
        Some(values) => encode(header, &[("positions", Array::F32(&positions)), ("values", Array::F32(values))]),
        None => encode(header, &[("positions", Array::F32(&positions))]),
    }
}

/// Least and largest finite value.
fn range(values: &[f32]) -> [f32; 2] {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let (low, high) = (finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max));
    if low <= high { [low, high] } else { [0.0, 1.0] }
}
