//! A window of the desktop around [`App`](crate::app::App).

use crate::app::App;
use souple_simulation::RunOptions;
use souple_simulation::session::SessionOptions;
use std::error::Error;
use std::path::PathBuf;

struct Window(App);

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.0.ui(ui);
    }
}

/// Opens a window and returns when it is closed.
///
/// # Errors
/// When there is no display or no graphics device, in words.
pub fn open(scene: Option<PathBuf>, overrides: Vec<String>, options: RunOptions) -> Result<(), String> {
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default().with_title("Souple").with_inner_size([1400.0, 860.0]),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };
    let create =
        move |context: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn Error + Send + Sync>> {
            let state = context.wgpu_render_state.clone().ok_or("the window has no graphics device")?;
            let app = App::new(state, scene, overrides, options, SessionOptions::default());
            Ok(Box::new(Window(app)) as Box<dyn eframe::App>)
        };
    eframe::run_native("souple", native, Box::new(create))
        .map_err(|e| format!("no window can be opened: {e}; pictures need none: --screenshot FILE"))
}
