//! The real window on a display of its own: an X server without a screen (Xvfb).
//!
//! Where there is no Xvfb, or the window was not built, the tests pass and say that they were skipped.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

/// A display that nobody sees; it goes when this is dropped.
struct Display {
    server: Child,
    name: String,
}

impl Drop for Display {
    fn drop(&mut self) {
        // It may have ended by itself; it is gone either way.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Notes why a test could not run.
fn skip(test: &str, why: &str) {
    println!("skipped: {why}");
    if let Some(folder) = std::env::var_os("SOUPLE_SKIPPED") {
        std::fs::write(PathBuf::from(folder).join(format!("desktop-{test}")), why).unwrap();
    }
}

/// A display, or nothing where there can be none.
fn display(test: &str) -> Option<Display> {
    if !cfg!(feature = "window") {
        skip(test, "built without windows; cargo xtask test builds them (--features souple-viewer/window)");
        return None;
    }
    // The server writes the number of its display when it is ready for windows.
    let arguments = ["-displayfd", "1", "-screen", "0", "1440x900x24", "-nolisten", "tcp"];
    let started =
        Command::new("Xvfb").args(arguments).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
    let Ok(mut server) = started else {
        skip(test, "no Xvfb; on Debian and Ubuntu, apt-get install xvfb");
        return None;
    };
    let mut number = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
    let name = format!(":{}", number.trim());
    let display = Display { server, name };
    if number.trim().is_empty() {
        skip(test, "Xvfb does not start here");
        return None;
    }
    Some(display)
}

/// A new folder for a test.
fn folder(test: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("souple-desktop-{}-{test}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn window(display: &Display, scene: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_souple-view"))
        .arg(scene)
        .args(["--threads", "1"])
        .args(arguments)
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

/// The window opens, draws the scene with its panels, is pulled by its pointer, and ends as it was asked to, with what it
/// measured.
#[test]
fn the_window_opens_and_draws() {
    let Some(display) = display("the_window_opens_and_draws") else { return };
    let folder = folder("draws");
    let (report, picture) = (folder.join("report.json"), folder.join("window.png"));
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/mixed_bar.toml");
    let [report_path, picture_path] = [&report, &picture].map(|p| p.to_str().unwrap().to_owned());
    let arguments = ["--frames", "24", "--report", &report_path, "--window-picture", &picture_path];
    let output = window(&display, &scene, &arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{}: {said}", output.status);

    let measured: serde_json::Value = serde_json::from_slice(&std::fs::read(&report).unwrap()).unwrap();
    assert!(measured["frames"].as_u64().is_some_and(|n| n >= 24), "{measured}");
    for number in ["opened_ms", "first_picture_ms", "frames_per_second"] {
        assert!(measured[number].as_f64().is_some_and(|x| x > 0.0), "{number} of {measured}");
    }
    assert!(measured["frames_from_pull_to_motion"].is_u64(), "no pull was seen: {measured}");

    let mut reader = png::Decoder::new(BufReader::new(std::fs::File::open(&picture).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let about = reader.next_frame(&mut bytes).unwrap();
    assert!(about.width > 1000 && about.height > 600, "{} × {}", about.width, about.height);
    // The elements' families have strong colours; panels and text are nearly grey.
    let strong = bytes.chunks_exact(3).filter(|p| p.iter().max().unwrap() - p.iter().min().unwrap() > 60).count();
    let share = strong as f64 / f64::from(about.width * about.height);
    assert!((0.01..0.6).contains(&share), "{share} of the window is coloured");
}

/// A scene that is wrong ends a window that ends itself with the reason and the exit code of bad input.
#[test]
fn an_invalid_scene_ends_with_its_reason() {
    let Some(display) = display("an_invalid_scene_ends_with_its_reason") else { return };
    let scene = folder("invalid").join("wrong.toml");
    std::fs::write(&scene, "gravty = [0.0, -1.0, 0.0]\n").unwrap();
    let output = window(&display, &scene, &["--frames", "3"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("gravty"), "{said}");
}
