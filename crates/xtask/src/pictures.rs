//! The pictures of the documents, drawn by `souple-view` as anybody could: `cargo xtask pictures`.
//!
//! Every bundled scene has one in `docs/pictures/scenes`, which the window also shows where scenes are chosen; of the
//! scenes for validation, those that show most have one in `docs/pictures/validation`. A scene that is not in the table is
//! drawn with what is usual. The program is built as the tests build it, so that whoever ran them does not wait.

use crate::workspace::{WINDOW, Workspace, cargo};
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Command, ExitCode, Stdio};

/// A scene, the picture's name (with `scenes/` in front where it is the scene's own), and arguments.
const PICTURES: &[(&str, &str, &[&str])] = &[
    ("mixed_bar", "mixed_bar", &["--size", "1400x700"]),
    ("organ", "organ", &["--size", "1400x700", "--camera", "205,18", "--cut", "z=0.5"]),
    ("mixed_bar", "view/apart", &["--element-size", "0.7", "--at", "1", "--camera", "30,15"]),
    ("organ", "view/stress", &["--colour", "von-mises", "--camera", "205,18", "--range", "0,6000", "--smooth"]),
    ("mixed_bar", "view/criterion", &["--colour", "r-l", "--at", "1"]),
    ("skin_and_tendon", "view/law", &["--colour", "law"]),
    ("skin_and_tendon", "scenes/skin_and_tendon", &["--colour", "law", "--size", SMALL]),
    ("organ", "scenes/organ", &["--camera", "205,18", "--cut", "z=0.5", "--size", SMALL]),
    ("validation/torsion", "validation/torsion", &["--colour", "von-mises", "--size", SMALL]),
    ("validation/bending_hex20_neo_hookean", "validation/bending", &["--colour", "von-mises", "--size", SMALL]),
    ("validation/cantilever_hex8_stvk", "validation/cantilever", &["--colour", "r-l", "--size", SMALL]),
    ("validation/cook_neo_hookean", "validation/cook", &["--colour", "von-mises", "--camera", "0,0", "--size", SMALL]),
    ("validation/traction_conforming_hooke", "validation/traction", &["--colour", "displacement", "--size", SMALL]),
    ("validation/membrane_strip_stvk", "validation/membrane", &["--colour", "von-mises", "--size", SMALL]),
    ("validation/hanging_cable", "validation/cable", &["--camera", "0,5", "--size", SMALL]),
    ("validation/cube_top", "validation/cube", &["--colour", "volume-ratio", "--size", SMALL]),
];

/// Large enough to choose a scene by.
const SMALL: &str = "640x400";

pub(crate) fn run(workspace: &Workspace) -> ExitCode {
    let mut build = Command::new(cargo());
    build.current_dir(&workspace.root).args(["build", "--package", "souple-viewer", "--features", WINDOW]);
    match build.status() {
        Ok(status) if status.success() => {}
        Ok(_) => return ExitCode::FAILURE,
        Err(e) => {
            eprintln!("cannot start cargo: {e}");
            return ExitCode::FAILURE;
        }
    }
    let program = workspace.target.join("debug").join(format!("souple-view{}", std::env::consts::EXE_SUFFIX));
    let scenes = workspace.files_in("scenes/", "toml").filter_map(|file| {
        let name = file.strip_prefix("scenes/")?.strip_suffix(".toml")?;
        (!name.contains('/')).then_some(name)
    });
    let own = |name: &str| format!("scenes/{name}");
    let others: Vec<(&str, String)> =
        scenes.map(|name| (name, own(name))).filter(|(_, o)| !PICTURES.iter().any(|p| p.1 == o)).collect();
    let small: &[&str] = &["--size", SMALL];
    let all = PICTURES.iter().map(|&(scene, picture, more)| (scene, picture.to_owned(), more));
    let mut failed = false;
    for (scene, picture, more) in all.chain(others.into_iter().map(|(scene, picture)| (scene, picture, small))) {
        let file = format!("docs/pictures/{picture}.png");
        let mut draw = Command::new(&program);
        draw.current_dir(&workspace.root).args([&format!("scenes/{scene}.toml"), "--screenshot", &file]).args(more);
        failed |= !drawn(&mut draw, &file);
    }
    failed |= !window(workspace, &program);
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}

fn drawn(command: &mut Command, file: &str) -> bool {
    match command.status() {
        Ok(status) if status.success() => true,
        Ok(status) => {
            eprintln!("{file}: {status}");
            false
        }
        Err(e) => {
            eprintln!("{file}: cannot start {}: {e}", Path::new(command.get_program()).display());
            false
        }
    }
}

/// The window itself, on a display without a screen; without one its picture stays as it is. Whether nothing failed.
fn window(workspace: &Workspace, program: &Path) -> bool {
    let file = "docs/pictures/view/window.png";
    let arguments = ["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"];
    let server = Command::new("Xvfb").args(arguments).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
    let Ok(mut server) = server else {
        eprintln!("{file}: skipped: no Xvfb; on Debian and Ubuntu, apt-get install xvfb");
        return true;
    };
    let number = display(&mut server);
    let mut draw = Command::new(program);
    draw.current_dir(&workspace.root).env("DISPLAY", format!(":{number}")).env_remove("WAYLAND_DISPLAY");
    draw.args(["scenes/organ.toml", "--size", "1180x720", "--frames", "30", "--window-picture", file]);
    let done = drawn(&mut draw, file);
    // It may have ended by itself; it is gone either way.
    let _ = server.kill();
    let _ = server.wait();
    done
}

/// The number of a server's display, once it is ready.
fn display(server: &mut Child) -> String {
    let mut number = String::new();
    if let Some(out) = server.stdout.take() {
        // Without a number no window opens there, which is told.
        let _ = BufReader::new(out).read_line(&mut number);
    }
    number.trim().to_owned()
}
