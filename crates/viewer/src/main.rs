//! `souple-view`: arguments in, a window or pictures out. `souple view` finds and starts it.
//!
//! Exit codes are those of `souple`: 0 done, 2 bad input, 3 the simulation failed before the picture.

mod arguments;

use arguments::Arguments;
use clap::Parser as _;
use souple_simulation::RunOptions;
use souple_viewer::draw::studio::Studio;
use souple_viewer::screenshot::take;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let started = Instant::now();
    let arguments = Arguments::parse();
    match run(&arguments, started) {
        Ok(code) => code,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments, started: Instant) -> Result<ExitCode, String> {
    if arguments.screenshot.is_some() { screenshot(arguments) } else { window(arguments, started) }
}

fn screenshot(arguments: &Arguments) -> Result<ExitCode, String> {
    let Some(file) = &arguments.screenshot else { return Err("--screenshot needs a file".into()) };
    let Some(scene) = &arguments.scene else { return Err("--screenshot needs a scene".into()) };
    let wish = arguments.wish()?;
    let options = RunOptions { device: arguments.device.clone(), threads: arguments.threads };
    let (mut simulation, warnings) = souple_viewer::scene_file::load(scene, &arguments.overrides, &options)?;
    warnings.iter().for_each(|w| eprintln!("{w}"));
    let script = arguments.script()?;
    let mut studio = Studio::open().map_err(|e| e.to_string())?;
    let taken = take(&mut simulation, &script, &mut studio, &wish)?;
    if let Some(folder) = file.parent().filter(|f| !f.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|e| format!("cannot make the folder {}: {e}", folder.display()))?;
    }
    std::fs::write(file, &taken.png).map_err(|e| format!("cannot write {}: {e}", file.display()))?;
    if let Some(failure) = taken.failure {
        eprintln!("error: {failure}\n{} shows the last good state, t = {} s", file.display(), taken.time);
        return Ok(ExitCode::from(3));
    }
    eprintln!("{}: t = {} s, drawn by {}", file.display(), taken.time, taken.device);
    Ok(ExitCode::SUCCESS)
}

#[cfg(feature = "window")]
fn window(arguments: &Arguments, started: Instant) -> Result<ExitCode, String> {
    use souple_viewer::trial::TrialOptions;
    use souple_viewer::window::{Opening, open};
    let trial = arguments.frames.map(|frames| TrialOptions {
        frames,
        report: arguments.report.clone(),
        picture: arguments.window_picture.clone(),
        started,
    });
    open(Opening {
        scene: arguments.scene.clone(),
        size: arguments.size.unwrap_or([1400, 860]),
        overrides: arguments.overrides.clone(),
        options: arguments.run_options(),
        session: arguments.session()?,
        rate: arguments.rate()?,
        trial,
    })?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(not(feature = "window"))]
fn window(_: &Arguments, _: Instant) -> Result<ExitCode, String> {
    Err("this souple-view was built without windows: pictures only (--screenshot); \
         build it with `cargo build --release -p souple-viewer --features window`"
        .into())
}
