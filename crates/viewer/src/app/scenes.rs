//! The bundled scenes to choose from, with their pictures.

use super::Wish;
use crate::files;
use egui::Ui;
use std::path::PathBuf;

/// Widest a picture is shown, in points.
const WIDTH: f32 = 300.0;

/// A scene to choose.
struct Entry {
    path: PathBuf,
    name: String,
    picture: Option<egui::ColorImage>,
    texture: Option<egui::TextureHandle>,
}

/// Scenes to choose from.
pub struct Gallery {
    entries: Vec<Entry>,
    typed: String,
}

impl Gallery {
    /// Looks for the bundled scenes and their pictures.
    pub fn find() -> Gallery {
        let entry = |path: PathBuf| Entry {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
            picture: files::picture(&path).and_then(|file| read(&file)),
            texture: None,
            path,
        };
        Gallery { entries: files::scenes().into_iter().map(entry).collect(), typed: String::new() }
    }

    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<Wish> {
        let mut wish = None;
        egui::CentralPanel::default().show(ui, |ui| {
            ui.heading("Scenes");
            if files::DISK {
                ui.horizontal(|ui| {
                    let name = ui.label("Scene file");
                    ui.text_edit_singleline(&mut self.typed).labelled_by(name.id);
                    if ui.button("Open").clicked() && !self.typed.trim().is_empty() {
                        wish = Some(Wish::Open(PathBuf::from(self.typed.trim())));
                    }
                });
            }
            if self.entries.is_empty() {
                ui.label("There is no folder `scenes` here or above; name a scene file, or start in Souple's folder.");
            }
            egui::ScrollArea::vertical().show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    for entry in &mut self.entries {
                        ui.vertical(|ui| {
                            ui.set_width(WIDTH);
                            let mut chosen = false;
                            if let Some(picture) = entry.picture.take() {
                                let options = egui::TextureOptions::LINEAR;
                                entry.texture = Some(ui.ctx().load_texture(&entry.name, picture, options));
                            }
                            if let Some(texture) = &entry.texture {
                                let image = egui::Image::new(texture)
                                    .max_width(WIDTH)
                                    .alt_text(format!("Picture of {}", entry.name));
                                chosen |= ui.add(egui::Button::image(image)).clicked();
                            }
                            chosen |= ui.button(&entry.name).clicked();
                            if chosen {
                                wish = Some(Wish::Open(entry.path.clone()));
                            }
                        });
                    }
                });
            });
        });
        wish
    }
}

/// A picture, if it can be read.
fn read(file: &[u8]) -> Option<egui::ColorImage> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().ok()?;
    let mut bytes = vec![0; reader.output_buffer_size()?];
    let about = reader.next_frame(&mut bytes).ok()?;
    let size = [about.width as usize, about.height as usize];
    match about.color_type {
        png::ColorType::Rgb => Some(egui::ColorImage::from_rgb(size, &bytes[..about.buffer_size()])),
        png::ColorType::Rgba => Some(egui::ColorImage::from_rgba_unmultiplied(size, &bytes[..about.buffer_size()])),
        _ => None,
    }
}
