//! What the pointer does to the body, and the knobs of the simulation: parameters, gravity, step, damping.

use super::named;
use super::running::{Hand, Running};
use super::view::size_of_force;
use crate::draw::frame::bounds;
use crate::geometry::along;
use crate::numbers::with_unit;
use egui::{CollapsingHeader, ComboBox, DragValue, Slider, Ui};
use souple_simulation::interaction::Tool;
use souple_simulation::session::Change;

pub(super) fn ui(running: &mut Running, ui: &mut Ui) {
    CollapsingHeader::new("Touch").default_open(true).show(ui, |ui| {
        ui.horizontal(|ui| {
            for (hand, name, key) in [
                (Hand::Pull, "pull", "P"),
                (Hand::Push, "push", "T"),
                (Hand::Hold, "hold", "H"),
                (Hand::Free, "free", "G"),
            ] {
                ui.selectable_value(&mut running.hand, hand, name).on_hover_text(key);
            }
        });
        match running.hand {
            Hand::Pull => pull(running, ui),
            Hand::Push => push(running, ui),
            Hand::Hold | Hand::Free => region(running, ui),
        }
    });
    CollapsingHeader::new("World").default_open(true).show(ui, |ui| world(running, ui));
    CollapsingHeader::new("Materials").default_open(true).show(ui, |ui| materials(running, ui));
}

fn pull(running: &mut Running, ui: &mut Ui) {
    let slider = Slider::new(&mut running.pull_stiffness, 0.1..=1e7).logarithmic(true).text("spring in N/m");
    ui.add(slider);
    match running.snapshot.pulls.first() {
        Some((_, pull)) => ui.label(format!("force {}", with_unit(size_of_force(pull.force), "N"))),
        None => ui.label("drag a point of the body"),
    };
}

fn push(running: &mut Running, ui: &mut Ui) {
    let mut out = running.tool.is_some();
    let mut changed = ui.checkbox(&mut out, "tool").changed();
    if changed {
        running.tool = out.then(|| new_tool(running));
    }
    let extent = f64::from(running.extent());
    let capsule = &mut running.capsule;
    if let Some(tool) = &mut running.tool {
        let turned = ui.checkbox(capsule, "capsule").changed();
        if turned {
            let half = if *capsule { 2.0 * tool.radius } else { 0.0 };
            let centre: [f64; 3] = std::array::from_fn(|k| 0.5 * (tool.ends[0][k] + tool.ends[1][k]));
            let up = running.camera.axes()[1].map(f64::from);
            tool.ends = [-half, half].map(|s| std::array::from_fn(|k| centre[k] + s * up[k]));
        }
        let radius = Slider::new(&mut tool.radius, 1e-3 * extent..=0.5 * extent).logarithmic(true).text("radius in m");
        let sized = ui.add(radius).changed();
        let stiffness = Slider::new(&mut tool.stiffness, 1.0..=1e10).logarithmic(true).text("stiffness in N/m^1.5");
        let stiffened = ui.add(stiffness).changed();
        let damped = ui.add(Slider::new(&mut tool.damping, 0.0..=10.0).text("damping in s/m")).changed();
        changed |= turned || sized || stiffened || damped;
        ui.label(format!("force {}", with_unit(size_of_force(running.snapshot.tool_force), "N")));
        ui.label("drag to move it in the plane of the picture");
    }
    if changed {
        running.change(Change::Tool(running.tool.clone()));
    }
}

/// A sphere above the body, stiff enough for its weight.
fn new_tool(running: &Running) -> Tool {
    let [low, high] = bounds(&running.snapshot.positions);
    let radius = 0.08 * running.extent();
    let middle: [f32; 3] = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    let up = running.camera.up;
    let height: f32 = (0..3).map(|k| up[k].abs() * 0.5 * (high[k] - low[k])).sum();
    let centre = along(middle, height + 1.5 * radius, up).map(f64::from);
    let radius = f64::from(radius);
    // A sphere pressed in by a tenth of its radius feels what a hundred springs of the hand would give.
    let stiffness = 100.0 * running.pull_stiffness / (0.1 * radius).sqrt();
    Tool { ends: [centre; 2], velocity: [0.0; 3], radius, stiffness, damping: 0.5 }
}

fn region(running: &mut Running, ui: &mut Ui) {
    ui.label("click a face, or take a named region");
    if running.regions.is_empty() {
        return;
    }
    let at = running.region.min(running.regions.len() - 1);
    ComboBox::new("region", "Region").selected_text(&running.regions[at].0).show_ui(ui, |ui| {
        for (number, (name, _)) in running.regions.iter().enumerate() {
            ui.selectable_value(&mut running.region, number, name);
        }
    });
    ui.horizontal(|ui| {
        let nodes = || running.regions[at].1.clone();
        if ui.button("Hold region").clicked() {
            running.change(Change::Hold(nodes()));
        }
        if ui.button("Free region").clicked() {
            running.change(Change::Free(nodes()));
        }
    });
}

fn world(running: &mut Running, ui: &mut Ui) {
    let Some(controls) = running.snapshot.controls.clone() else { return };
    ui.horizontal(|ui| {
        ui.label("gravity");
        let mut gravity = controls.gravity;
        let mut changed = false;
        for (g, axis) in gravity.iter_mut().zip(["x", "y", "z"]) {
            let drag = ui.add(DragValue::new(g).speed(0.1).prefix(format!("{axis} ")));
            changed |= named(ui, drag, &format!("gravity along {axis} in m/s²")).changed();
        }
        ui.label("m/s²");
        if changed {
            running.change(Change::Gravity(gravity));
        }
    });
    let mut step = controls.step;
    let slider = Slider::new(&mut step, 1e-5..=0.1).logarithmic(true).clamping(egui::SliderClamping::Never);
    if ui.add(slider.text("step in s")).changed() && step > 0.0 {
        running.change(Change::TimeStep(step));
    }
    let mut damping = controls.velocity_damping;
    if ui.add(Slider::new(&mut damping, 0.0..=20.0).text("damping in 1/s")).changed() {
        running.change(Change::VelocityDamping(damping));
    }
}

fn materials(running: &mut Running, ui: &mut Ui) {
    let Some(controls) = running.snapshot.controls.clone() else { return };
    for (block, (about, values)) in running.blocks.iter().zip(&controls.parameters).enumerate() {
        ui.label(&about.name);
        for (parameter, (&(name, unit), &value)) in about.parameters.iter().zip(values).enumerate() {
            let mut changed = value;
            let unit = if unit == "1" { String::new() } else { format!(" in {unit}") };
            let label = format!("{name}{unit}");
            let id = (block, parameter);
            let response = ui.push_id(id, |ui| {
                // Ratios lie between −1 and 1; moduli spread over powers of ten about their value.
                if value.abs() < 1.0 && unit.is_empty() {
                    ui.add(Slider::new(&mut changed, -0.5..=0.499).clamping(egui::SliderClamping::Never).text(label))
                } else {
                    let speed = 0.01 * value.abs().max(1e-12);
                    let drag = DragValue::new(&mut changed).speed(speed);
                    ui.horizontal(|ui| {
                        let name = ui.label(label);
                        ui.add(drag).labelled_by(name.id)
                    })
                    .inner
                }
            });
            if response.inner.changed() && changed != value {
                running.change(Change::Parameter { block, parameter, value: changed });
            }
        }
    }
}
