//! A window of the desktop around [`App`](crate::app::App).

use crate::app::App;
use crate::app::pace::Pace;
use crate::trial::{Trial, TrialOptions};
use souple_simulation::RunOptions;
use souple_simulation::session::SessionOptions;
use std::error::Error;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};

/// What a window begins with.
#[derive(Clone, Debug)]
pub struct Opening {
    /// The scene; without it, the bundled ones are offered.
    pub scene: Option<PathBuf>,
    /// Width and height in points.
    pub size: [u32; 2],
    /// Values of the scene to change.
    pub overrides: Vec<String>,
    /// Where and how to compute.
    pub options: RunOptions,
    /// How the simulation begins.
    pub session: SessionOptions,
    /// Pictures per second at most, if a person has chosen.
    pub rate: Option<f64>,
    /// What the window does of itself, if anything.
    pub trial: Option<TrialOptions>,
}

struct Window {
    app: App,
    trial: Option<Trial>,
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.app.ui(ui);
        if let Some(trial) = &mut self.trial {
            trial.after(&mut self.app, ui.ctx());
        }
    }

    fn raw_input_hook(&mut self, _: &egui::Context, input: &mut egui::RawInput) {
        if let Some(trial) = &mut self.trial {
            trial.before(&self.app, input);
        }
    }
}

/// Opens a window and returns when it is closed.
///
/// # Errors
/// When there is no display or no graphics device, or when a window that should end itself could not do what it was
/// opened for, in words.
pub fn open(opening: Opening) -> Result<(), String> {
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_title("Souple").with_inner_size(opening.size.map(|s| s as f32)),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };
    let (sender, endings) = channel();
    let create =
        move |context: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn Error + Send + Sync>> {
            let state = context.wgpu_render_state.clone().ok_or("the window has no graphics device")?;
            let device = crate::draw::device::describe(&state);
            let trial = opening.trial.map(|options| {
                let (trial, ended) = Trial::new(options, device);
                // It is received below, when the window is closed.
                let _ = sender.send(ended);
                trial
            });
            let mut app = App::new(&state, opening.scene, opening.overrides, opening.options, opening.session);
            app.pace = Pace::of(&state.adapter, opening.rate);
            Ok(Box::new(Window { app, trial }) as Box<dyn eframe::App>)
        };
    eframe::run_native("souple", native, Box::new(create))
        .map_err(|e| format!("no window can be opened: {e}; pictures need none: --screenshot FILE"))?;
    let ended: Option<Receiver<Result<(), String>>> = endings.try_recv().ok();
    match ended.map(|e| e.try_recv()) {
        None => Ok(()),
        Some(Ok(ending)) => ending,
        Some(Err(_)) => Err("the window was closed before its pictures were drawn".into()),
    }
}
