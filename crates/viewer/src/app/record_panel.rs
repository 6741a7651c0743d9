//! Keeping what was seen: a series for ParaView, an animation, a checkpoint.

use super::running::Running;
use crate::animation::Animation;
use egui::{CollapsingHeader, Ui};
use souple_simulation::session::Command;
use std::path::PathBuf;

pub(super) fn ui(running: &mut Running, ui: &mut Ui) {
    CollapsingHeader::new("Record").show(ui, |ui| {
        ui.horizontal(|ui| {
            let name = ui.label("folder");
            ui.text_edit_singleline(&mut running.folder).labelled_by(name.id);
        });
        let folder = PathBuf::from(&running.folder);
        match running.snapshot.recorded {
            Some(frames) => {
                if ui.button("End the series").clicked() {
                    running.session.send(Command::Record(None));
                }
                ui.label(format!("{frames} frames for ParaView"));
            }
            None => {
                if ui.button("Record a series for ParaView").clicked() {
                    running.session.send(Command::Record(Some((folder.clone(), 1.0 / 25.0))));
                }
            }
        }
        match running.animation.take() {
            Some(animation) => {
                if ui.button("End the animation").clicked() {
                    let frames = animation.frames();
                    running.message = match animation.finish() {
                        Ok(path) => format!("{}: {frames} pictures", path.display()),
                        Err(error) => error,
                    };
                } else {
                    ui.label(format!("{} pictures", animation.frames()));
                    running.animation = Some(animation);
                }
            }
            None => {
                if ui.button("Record an animation (GIF)").clicked() {
                    match Animation::start(&folder.join("animation.gif")) {
                        Ok(animation) => running.animation = Some(animation),
                        Err(error) => running.message = error,
                    }
                }
            }
        }
        let hint = "For `souple run --resume --out` with this folder, with what was changed by hand. \
                    Every change with its time is in checkpoint.json beside it.";
        if ui.button("Save a checkpoint").on_hover_text(hint).clicked() {
            running.session.send(Command::Save(folder.join("checkpoint.bin")));
        }
        if !running.message.is_empty() {
            ui.label(&running.message);
        }
    });
}
