//! The window in a page of a browser: [`App`](crate::app::App) on a canvas, drawn by WebGL2.
//!
//! ```text
//! browser: next picture ──► panels and view ──► commands and steps, for as long as `Pace::budget` says ──► browser
//! ```
//!
//! A page has neither threads nor files nor memory that may be executed: the simulation runs between two pictures, on the
//! interpreter of programs, and scenes are those that were built in. What the page shows is also written onto its body,
//! for scripts and tests:
//!
//! | attribute of `body` | says |
//! |---|---|
//! | `data-device` | what draws |
//! | `data-pictures` | pictures so far |
//! | `data-scene` | the scene that runs |
//! | `data-step`, `data-time` | steps made, and the simulated time in s |
//! | `data-playing` | whether steps follow each other |
//! | `data-state` | with `at=` in the address, once that time is reached: the checkpoint, in base 16 |

use crate::address::{self, Asked};
use crate::app::App;
use eframe::WebRunner;
use souple_simulation::RunOptions;
use souple_simulation::session::{Command, SessionOptions};
use std::error::Error;
use web_sys::HtmlElement;

/// Memory for states to go back to, in bytes: a page has less to give than a desktop.
const HISTORY: usize = 64 << 20;

struct Page {
    app: App,
    body: HtmlElement,
    pictures: u64,
    /// The snapshot that was written down last.
    told: Option<u64>,
    /// Where the scene is to stand still.
    at: Option<f64>,
    sent: bool,
    standing: bool,
}

impl eframe::App for Page {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        self.app.ui(ui);
        self.pictures += 1;
        self.write("pictures", &self.pictures.to_string());
        self.stand_still(ui.ctx());
        self.tell();
    }
}

impl Page {
    fn write(&self, name: &str, value: &str) {
        // Refused only for names that no attribute may have.
        let _ = self.body.dataset().set(name, value);
    }

    /// Asks for the time at which the scene stands still, and gives the state away once it does.
    fn stand_still(&mut self, context: &egui::Context) {
        let (Some(at), Some(running)) = (self.at, self.app.running_mut()) else { return };
        let snapshot = &running.snapshot;
        if !self.sent {
            running.session.send(Command::Until(at));
            self.sent = true;
            context.request_repaint();
        } else if !self.standing
            && !snapshot.playing
            && let Some(controls) = &snapshot.controls
            && snapshot.time >= at - 0.5 * controls.step
            && let Some((checkpoint, _)) = running.session.state()
        {
            self.standing = true;
            let text: String = checkpoint.iter().map(|byte| format!("{byte:02x}")).collect();
            self.write("state", &text);
        }
    }

    /// Writes down what is shown, when it is something new.
    fn tell(&mut self) {
        let Some(running) = self.app.running() else { return };
        let snapshot = &running.snapshot;
        if self.told != Some(snapshot.number) {
            self.write("scene", &running.path.display().to_string());
            self.write("step", &snapshot.step.to_string());
            self.write("time", &snapshot.time.to_string());
            self.write("playing", &snapshot.playing.to_string());
            self.told = Some(snapshot.number);
        }
    }
}

/// Shows the window on the canvas `#souple`; what prevents it is written into `#message`.
pub fn start() {
    wasm_bindgen_futures::spawn_local(async {
        let message = web_sys::window().and_then(|w| w.document()).and_then(|d| d.get_element_by_id("message"));
        let text = match run().await {
            Ok(()) => String::new(),
            Err(error) => error,
        };
        if let Some(message) = message {
            message.set_text_content(Some(&text));
        }
    });
}

async fn run() -> Result<(), String> {
    use wasm_bindgen::JsCast as _;
    let window = web_sys::window().ok_or("there is no window to draw to")?;
    let document = window.document().ok_or("the window has no document")?;
    let body = document.body().ok_or("the document has no body")?;
    let canvas = document.get_element_by_id("souple").and_then(|e| e.dyn_into().ok());
    let canvas: web_sys::HtmlCanvasElement = canvas.ok_or("the page has no canvas with the name `souple`")?;
    let Asked { scene, at } = address::read(&window.location().search().unwrap_or_default())?;
    let create =
        move |context: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn Error + Send + Sync>> {
            let state = context.wgpu_render_state.clone().ok_or("the page has no graphics device")?;
            let session = SessionOptions { playing: at.is_none(), history_bytes: HISTORY, ..SessionOptions::default() };
            let options = RunOptions { threads: 1, ..RunOptions::default() };
            let app = App::new(&state, scene, Vec::new(), options, session);
            let page = Page { app, body, pictures: 0, told: None, at, sent: false, standing: false };
            page.write("device", &crate::draw::device::describe(&state));
            Ok(Box::new(page))
        };
    let started = WebRunner::new().start(canvas, eframe::WebOptions::default(), Box::new(create)).await;
    started.map_err(|e| {
        let reason = e.as_string().unwrap_or_else(|| format!("{e:?}"));
        format!("this browser cannot draw the page, which needs WebGL2: {reason}")
    })
}
