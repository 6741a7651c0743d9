//! The window's content: panels around a view of the model. It knows egui and a graphics device, but no window, so that
//! tests run it as it is, and pages of a browser show it too.
//!
//! | file | does |
//! |---|---|
//! | [`running`] | a scene that runs: its session, its model, what was chosen |
//! | [`view`] | the picture, and what the pointer does in it |
//! | [`pace`] | when the next picture is due |
//! | [`time_panel`] | play, pause, step, speed, history, reset |
//! | [`look_panel`] | colours, faces, section |
//! | [`touch_panel`] | what the pointer does, the tool, law parameters, gravity, step, damping |
//! | [`numbers_panel`] | times, iterations, energies, warnings |
//! | [`record_panel`] | series, animations, checkpoints |
//! | [`scenes`] | the bundled scenes to choose from |

mod look_panel;
mod numbers_panel;
pub mod pace;
mod record_panel;
pub mod running;
mod scenes;
mod time_panel;
mod touch_panel;
mod view;

use crate::draw::backdrop::Backdrop;
use crate::draw::device::{DeviceError, Pixels};
use crate::draw::ink::Ink;
use crate::draw::renderer::{Renderer, Samples};
use crate::{files, scene_file};
use egui_wgpu::RenderState;
use pace::Pace;
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

/// The drawing of the model, shared by all scenes, and how it gets into the window.
pub(crate) struct Canvas {
    pub(crate) renderer: Renderer,
    pub(crate) backdrop: Backdrop,
    ink: Option<Ink>,
}

/// Where scenes are read and steps are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// On threads of their own.
    Threads,
    /// Between two pictures, where there are no threads: in a page.
    Pictures,
}

/// The content of a window.
pub struct App {
    /// What is shown.
    pub stage: Stage,
    /// When the next picture is due.
    pub pace: Pace,
    /// Where scenes that are opened from now on are read and run.
    pub place: Place,
    canvas: Canvas,
    overrides: Vec<String>,
    options: RunOptions,
    session: SessionOptions,
}

impl App {
    /// Opens a scene, or offers the bundled ones.
    pub fn new(
        state: &RenderState,
        scene: Option<PathBuf>,
        overrides: Vec<String>,
        options: RunOptions,
        session: SessionOptions,
    ) -> App {
        let renderer = Renderer::new(&state.device, &state.queue, Samples::for_motion(&state.adapter));
        let canvas = Canvas { renderer, backdrop: Backdrop::new(state), ink: Ink::new(state) };
        let stage = Stage::Choosing(scenes::Gallery::find());
        let pace = Pace::of(&state.adapter, None);
        let place = if cfg!(target_arch = "wasm32") { Place::Pictures } else { Place::Threads };
        let mut app = App { stage, pace, place, canvas, overrides, options, session };
        if let Some(path) = scene {
            app.open(path);
        }
        app
    }

    /// Begins to read a scene, in the background where there are threads.
    pub fn open(&mut self, path: PathBuf) {
        let (sender, arrival) = channel();
        let (file, overrides, options) = (path.clone(), self.overrides.clone(), self.options.clone());
        let read = move || {
            // Nobody waits any more when another scene was opened.
            let _ = sender.send(scene_file::load(&file, &overrides, &options));
        };
        let reader = match self.place {
            Place::Threads => std::thread::Builder::new().name("scene".into()).spawn(read).map(drop),
            Place::Pictures => {
                read();
                Ok(())
            }
        };
        self.stage = match reader {
            Ok(()) => Stage::Loading { path, arrival },
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

    /// The picture of the scene that was drawn last, without what is written over it.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn picture(&self) -> Result<Pixels, DeviceError> {
        self.canvas.renderer.pixels()
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
                let (context, pace) = (context.clone(), self.pace.clone());
                let wake = Box::new(move || pace.next(&context));
                let session = match self.place {
                    Place::Threads => Session::start(simulation, warnings, self.session.clone(), wake),
                    Place::Pictures => Ok(Session::start_here(simulation, warnings, self.session.clone(), wake)),
                };
                session.map(|session| Running::new(path.clone(), session, model, regions, blocks))
            }
        };
        self.stage = match started {
            Ok(running) => Stage::Running(Box::new(running)),
            Err(message) => Stage::Failed { path, message },
        };
    }

    /// One pass of the whole content.
    pub fn ui(&mut self, ui: &mut egui::Ui) {
        self.pace.begin();
        self.arrive(ui.ctx());
        // Panels show the backdrop: what egui itself fills costs many times more on the processor.
        let fill = ui.visuals().panel_fill;
        let behind = self.canvas.backdrop.fill(ui.ctx().content_rect(), fill);
        ui.painter().add(behind);
        ui.visuals_mut().panel_fill = egui::Color32::TRANSPARENT;
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
                        if files::DISK {
                            record_panel::ui(running, ui);
                        }
                    });
                });
                egui::Panel::left("numbers").default_size(260.0).show(ui, |ui| {
                    egui::ScrollArea::vertical().show(ui, |ui| numbers_panel::ui(running, ui));
                });
                egui::CentralPanel::no_frame().show(ui, |ui| view::ui(running, &mut self.canvas, ui));
            }
        }
        if let Some(ink) = &mut self.canvas.ink {
            ink.take_over(ui.ctx(), ui.layer_id());
        }
        match wish {
            None => {}
            Some(Wish::Choose) => self.stage = Stage::Choosing(scenes::Gallery::find()),
            Some(Wish::Open(path)) => self.open(path),
        }
        self.work(ui.ctx());
    }

    /// Gives the simulation its time after a picture, where it has no thread; what was asked for in the picture is done.
    fn work(&mut self, context: &egui::Context) {
        let budget = self.pace.budget();
        if let Some(wait) = self.running_mut().and_then(|running| running.session.work(budget)) {
            self.pace.after(context, wait);
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
    if !files::DISK {
        ui.label("Escape leads to the bundled scenes.");
        return false;
    }
    ui.label("Change the file and read it again; Escape leads to the bundled scenes.");
    ui.button("Read again").clicked()
}
