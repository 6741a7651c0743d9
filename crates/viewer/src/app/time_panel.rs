//! Time: play, pause, step, speed, history, reset.

use super::Wish;
use super::running::Running;
use crate::numbers::with_unit;
use egui::Ui;
use souple_simulation::Ending;
use souple_simulation::session::Command;

/// Speeds to choose from, simulated seconds per second.
const SPEEDS: [(Option<f64>, &str); 6] = [
    (Some(0.1), "0.1 × real time"),
    (Some(0.25), "0.25 × real time"),
    (Some(1.0), "real time"),
    (Some(2.0), "2 × real time"),
    (Some(5.0), "5 × real time"),
    (None, "as fast as it goes"),
];

pub(super) fn ui(running: &mut Running, ui: &mut Ui) -> Option<Wish> {
    let mut wish = None;
    let mut reset = false;
    let mut chosen = None;
    let snapshot = &running.snapshot;
    ui.horizontal_wrapped(|ui| {
        let (label, command) = if snapshot.playing { ("Pause", Command::Pause) } else { ("Play", Command::Play) };
        if ui.button(label).on_hover_text("Space").clicked() {
            running.session.send(command);
        }
        if ui.button("Step").on_hover_text("One step, then a pause; full stop").clicked() {
            running.session.send(Command::Step(1));
        }
        if ui.button("Reset").on_hover_text("Back to the beginning, all changes undone; R").clicked() {
            running.session.send(Command::Reset);
            reset = true;
        }
        egui::ComboBox::new("speed", "Speed").selected_text(running.speed_name()).show_ui(ui, |ui| {
            for (speed, name) in SPEEDS {
                if ui.selectable_label(running.speed_name() == name, name).clicked() {
                    chosen = Some((speed, name));
                }
            }
        });
        ui.separator();
        ui.label(format!("t = {}, step {}", with_unit(snapshot.time, "s"), snapshot.step));
        ui.label(format!("{:.2} × real time", snapshot.real_time_factor));
        match snapshot.ending {
            Some(Ending::Failed) => {
                ui.colored_label(ui.visuals().error_fg_color, "failed; go back, or reset");
            }
            Some(Ending::AtRest) => {
                ui.label("at rest");
            }
            Some(Ending::Finished) => {
                ui.label("finished");
            }
            None => {}
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if ui.button("Scenes").on_hover_text("Choose another scene").clicked() {
                wish = Some(Wish::Choose);
            }
        });
    });
    let history = snapshot.history;
    let mut step = snapshot.step;
    ui.horizontal(|ui| {
        let name = ui.label("History");
        ui.spacing_mut().slider_width = (ui.available_width() - 80.0).max(60.0);
        let slider = ui.add(egui::Slider::new(&mut step, 0..=history.last.max(1))).labelled_by(name.id);
        let kept = format!(
            "{} in memory, one state every {} steps; what lies between is computed again",
            megabytes(history.bytes),
            history.stride
        );
        if slider.on_hover_text(kept).changed() && step != snapshot.step {
            running.session.send(Command::Pause);
            running.session.send(Command::Seek(step));
        }
    });
    if let Some(error) = &snapshot.error {
        ui.colored_label(ui.visuals().error_fg_color, error);
    }
    if let Some((speed, name)) = chosen {
        running.session.send(Command::Speed(speed));
        running.speed = name;
    }
    if reset {
        running.tool = None;
    }
    wish
}

fn megabytes(bytes: usize) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}
