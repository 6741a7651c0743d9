//! The window's content: panels around a view of the model. It knows egui and a graphics device, but no window, so that
//! tests run it as it is.
//!
//! | file | does |
//! |---|---|
//! | [`running`] | a scene that runs: its session, its model, what was chosen |
//! | [`view`] | the picture, and what the pointer does in it |
//! | [`time_panel`] | play, pause, step, speed, history, reset |
//! | [`look_panel`] | colours, faces, section |
//! | [`touch_panel`] | what the pointer does, the tool, law parameters, gravity, step, damping |
//! | [`numbers_panel`] | times, iterations, energies, warnings |
//! | [`record_panel`] | series, animations, checkpoints |
//! | [`scenes`] | the bundled scenes to choose from |

mod look_panel;
mod numbers_panel;
mod record_panel;
pub mod running;
mod scenes;
mod time_panel;
mod touch_panel;
mod view;

use crate::draw::renderer::Renderer;
use crate::scene_file;
use egui_wgpu::{RenderState, wgpu};
use running::Running;
use souple_simulation::session::{Session, SessionOptions};
use souple_simulation::{RunOptions, Simulation};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
pub use view::point_on_body;

/// What the window shows.
pub enum Stage {
    /// Scenes to choose from.
    Choosing(scenes::Gallery),
    /// A scene is being read.
    Loading {
        /// Which.
        path: PathBuf,
        /// Where it arrives.
        arrival: Receiver<Result<(Simulation, Vec<String>), String>>,
    },
    /// A scene cannot be shown.
    Failed {
        /// Which.
        path: PathBuf,
        /// Why, with its place in the scene.
        message: String,
    },
    /// A scene runs.
    Running(Box<Running>),
}

/// The drawing of the model, shared by all scenes.
pub(crate) struct Canvas {
    pub(crate) state: RenderState,
    pub(crate) renderer: Renderer,
    shown: Option<egui::TextureId>,
}

impl Canvas {
    /// The texture as egui knows it.
    pub(crate) fn texture(&mut self, renewed: bool) -> egui::TextureId {
        let (device, texture) = (&self.state.device, self.renderer.texture());
        let mut egui = self.state.renderer.write();
        match self.shown {
            Some(id) => {
                if renewed {
                    egui.update_egui_texture_from_wgpu_texture(device, texture, wgpu::FilterMode::Linear, id);
                }
                id
            }
            None => *self.shown.insert(egui.register_native_texture(device, texture, wgpu::FilterMode::Linear)),
        }
    }
}

/// The content of a window.
pub struct App {
    /// What is shown.
    pub stage: Stage,
    canvas: Canvas,
    overrides: Vec<String>,
    options: RunOptions,
    session: SessionOptions,
}

impl App {
    /// Opens a scene, or offers the bundled ones.
    pub fn new(
        state: RenderState,
        scene: Option<PathBuf>,
        overrides: Vec<String>,
        options: RunOptions,
        session: SessionOptions,
    ) -> App {
        let renderer = Renderer::new(&state.device, &state.queue);
        let canvas = Canvas { state, renderer, shown: None };
        let stage = Stage::Choosing(scenes::Gallery::find());
        let mut app = App { stage, canvas, overrides, options, session };
        if let Some(path) = scene {
            app.open(path);
        }
        app
    }

    /// Begins to read a scene, in the background.
    pub fn open(&mut self, path: PathBuf) {
        let (sender, arrival) = channel();
        let (file, overrides, options) = (path.clone(), self.overrides.clone(), self.options.clone());
        let reader = std::thread::Builder::new().name("scene".into()).spawn(move || {
            // Nobody waits any more when another scene was opened.
            let _ = sender.send(scene_file::load(&file, &overrides, &options));
        });
        self.stage = match reader {
            Ok(_) => Stage::Loading { path, arrival },
            Err(e) => Stage::Failed { path, message: format!("no thread to read the scene: {e}") },
        };
    }

    /// The scene that runs, if one does.
    pub fn running(&self) -> Option<&Running> {
        match &self.stage {
            Stage::Running(running) => Some(running),
            _ => None,
        }
    }

    /// The same, to be changed.
    pub fn running_mut(&mut self) -> Option<&mut Running> {
        match &mut self.stage {
            Stage::Running(running) => Some(running),
            _ => None,
        }
    }

    fn arrive(&mut self, context: &egui::Context) {
        let Stage::Loading { path, arrival } = &self.stage else { return };
        let path = path.clone();
        let started = match arrival.try_recv() {
            Err(TryRecvError::Empty) => {
                context.request_repaint();
                return;
            }
            Err(TryRecvError::Disconnected) => Err("reading the scene ended without a result".to_owned()),
            Ok(Err(message)) => Err(message),
            Ok(Ok((simulation, warnings))) => {
                let model = crate::model::Model::of(&simulation);
                let regions = running::regions(&simulation);
                let blocks = running::blocks(&simulation);
                let context = context.clone();
                let wake = Box::new(move || context.request_repaint());
                Session::start(simulation, warnings, self.session.clone(), wake)
                    .map(|session| Running::new(path.clone(), session, model, regions, blocks))
            }
        };
        self.stage = match started {
            Ok(running) => Stage::Running(Box::new(running)),
            Err(message) => Stage::Failed { path, message },
        };
    }

    /// One pass of the whole content.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        self.arrive(ui.ctx());
        let mut wish = None;
        match &mut self.stage {
            Stage::Choosing(gallery) => wish = gallery.ui(ui),
            Stage::Loading { path, .. } => {
                egui::CentralPanel::default().show(ui, |ui| {
                    ui.centered_and_justified(|ui| ui.label(format!("Reading {} …", path.display())));
                });
            }
            Stage::Failed { path, message } => {
                let again = egui::CentralPanel::default().show(ui, |ui| failed(ui, path, message)).inner;
                wish = again.then(|| Wish::Open(path.clone()));
                if wish.is_none() && ui.input(|i| i.key_pressed(egui::Key::Escape)) {
                    wish = Some(Wish::Choose);
                }
            }
            Stage::Running(running) => {
                running.renew();
                egui::Panel::bottom("time").show(ui, |ui| wish = time_panel::ui(running, ui));
                egui::Panel::right("choices").default_size(300.0).show(ui, |ui| {
                    egui::ScrollArea::vertical().show(ui, |ui| {
                        look_panel::ui(running, ui);
                        touch_panel::ui(running, ui);
                        record_panel::ui(running, ui);
                    });
                });
                egui::Panel::left("numbers").default_size(260.0).show(ui, |ui| {
                    egui::ScrollArea::vertical().show(ui, |ui| numbers_panel::ui(running, ui));
                });
                egui::CentralPanel::no_frame().show(ui, |ui| view::ui(running, &mut self.canvas, ui));
            }
        }
        match wish {
            None => {}
            Some(Wish::Choose) => self.stage = Stage::Choosing(scenes::Gallery::find()),
            Some(Wish::Open(path)) => self.open(path),
        }
    }
}

/// Gives a control the name that is read out, where no label beside it does.
pub(crate) fn named(ui: &egui::Ui, response: egui::Response, name: &str) -> egui::Response {
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}

/// Where a panel leads.
pub(crate) enum Wish {
    Choose,
    Open(PathBuf),
}

/// What is wrong with a scene; whether to read it again.
fn failed(ui: &mut egui::Ui, path: &std::path::Path, message: &str) -> bool {
    ui.add_space(24.0);
    ui.heading(format!("{} cannot be shown", path.display()));
    ui.add_space(8.0);
    egui::ScrollArea::both().max_height(ui.available_height() - 60.0).show(ui, |ui| {
        ui.label(egui::RichText::new(message).monospace());
    });
    ui.add_space(8.0);
    ui.label("Change the file and read it again; Escape leads to the bundled scenes.");
    ui.button("Read again").clicked()
}
