//! How the model is shown: colours, faces, section.

use super::running::Running;
use crate::colouring::{ColourBy, Legend, choices};
use crate::look::{Faces, Shading};
use crate::palette::Map;
use egui::{CollapsingHeader, ComboBox, DragValue, Slider, Ui};

pub(super) fn ui(running: &mut Running, ui: &mut Ui) {
    CollapsingHeader::new("View").default_open(true).show(ui, |ui| {
        let look = &mut running.look;
        ComboBox::new("colour", "Colour").height(480.0).selected_text(look.colour_by.name()).show_ui(ui, |ui| {
            for (by, _, name) in choices() {
                ui.selectable_value(&mut look.colour_by, by, name);
            }
        });
        if matches!(look.colour_by, ColourBy::Displacement | ColourBy::Quality | ColourBy::Field(_)) {
            numbers(running, ui);
        }
        let look = &mut running.look;
        ui.horizontal(|ui| {
            for (faces, name) in [(Faces::Plain, "plain"), (Faces::Edged, "edges"), (Faces::Wireframe, "wireframe")] {
                ui.selectable_value(&mut look.faces, faces, name);
            }
        });
        ui.horizontal_wrapped(|ui| {
            let mut smooth = look.shading == Shading::Smooth;
            ui.checkbox(&mut smooth, "smooth");
            look.shading = if smooth { Shading::Smooth } else { Shading::Flat };
            ui.checkbox(&mut look.points, "nodes");
            ui.checkbox(&mut look.held, "held nodes");
            ui.checkbox(&mut look.ground, "ground");
        });
        ui.add(Slider::new(&mut look.element_size, 0.2..=1.0).text("element size"));
        ui.separator();
        let cut = &mut running.cut;
        ui.horizontal(|ui| {
            ui.checkbox(&mut cut.on, "section");
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                ui.selectable_value(&mut cut.axis, axis, name);
            }
            ui.checkbox(&mut cut.flipped, "other side");
        });
        ui.add_enabled(cut.on, Slider::new(&mut cut.share, 0.0..=1.0).text("place of the section"));
        ui.horizontal(|ui| {
            if ui.button("Show everything").on_hover_text("F, or a double click beside the body").clicked() {
                running.fit = true;
            }
            if !running.look.marked.is_empty() && ui.button("Remove marks").clicked() {
                running.look.marked.clear();
            }
        });
        if !running.probe.is_empty() {
            ui.separator();
            ui.label(&running.probe);
        }
    });
}

/// Map and range of the numbers that are shown.
fn numbers(running: &mut Running, ui: &mut Ui) {
    let scale = &mut running.look.scale;
    ui.horizontal(|ui| {
        for map in Map::ALL {
            ui.selectable_value(&mut scale.map, map, map.name());
        }
        let mut fixed = scale.range.is_some();
        if ui.checkbox(&mut fixed, "fixed range").changed() {
            scale.range = match (&running.legend, fixed) {
                (Legend::Range { ends, .. }, true) => Some(*ends),
                (_, true) => Some([0.0, 1.0]),
                (_, false) => None,
            };
        }
    });
    if let Some([low, high]) = &mut scale.range {
        ui.horizontal(|ui| {
            let speed = (0.01 * (*high - *low).abs()).max(1e-9);
            for (end, name) in [(low, "from"), (high, "to")] {
                let label = ui.label(name);
                ui.add(DragValue::new(end).speed(speed)).labelled_by(label.id);
            }
        });
    }
}
