//! A picture of the state in which a simulation ended, drawn by `souple-view` from the meshes that it left.
//!
//! It is drawn from a scene of those meshes alone, so that nothing is computed a second time. What cannot be drawn is
//! left out: a picture is no result.

use super::last_states;
use super::process::{Process, spawn};
use serde_json::Value as Json;
use std::fs::{self, OpenOptions};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Name of the picture in the folder of its simulation.
pub(super) const FILE: &str = "end.png";
/// Time that a picture may take.
pub(super) const PATIENCE: Duration = Duration::from_secs(60);
/// Name of the scene that is drawn.
const SCENE: &str = "end.toml";

/// Starts to draw; none where there is nothing to draw, or nothing to draw it with.
pub(super) fn start(folder: &Path, view: Option<&Path>, status: ExitStatus) -> Option<(Process, Instant)> {
    let view = view.filter(|_| matches!(status.code(), Some(0 | 1)))?;
    let bodies = last_states(folder).ok().filter(|bodies| !bodies.is_empty())?;
    fs::write(folder.join(SCENE), scene(&bodies)).ok()?;
    let messages = OpenOptions::new().append(true).open(folder.join("messages.txt")).ok()?;
    let mut command = Command::new(view);
    command.arg(folder.join(SCENE)).arg("--screenshot").arg(folder.join(FILE));
    command.args(["--at", "0", "--size", "640x480", "--threads", "1", "--colour", "element"]);
    let process = spawn(command.stdin(Stdio::null()).stderr(messages)).ok()?;
    Some((process, Instant::now()))
}

/// A scene of meshes at rest.
fn scene(bodies: &[(String, String)]) -> String {
    // A text in JSON is one in TOML.
    let quoted = |text: &str| Json::from(text).to_string();
    let mut text = "[time]\nstep = 1.0\nend = 1.0\n".to_owned();
    for (body, file) in bodies {
        text += &format!(
            "[[body]]\nname = {}\ndensity = 1.0\nmesh = {{ file = {} }}\n\
             [[body.material]]\nlaw = \"hooke\"\nyoung = 1.0\npoisson = 0.0\n",
            quoted(body),
            quoted(file)
        );
    }
    text
}
