//! The pictures of the documents, drawn by `souple-view` as anybody could: `cargo xtask pictures`.
//!
//! Every bundled scene has one in `docs/pictures/scenes`, which the window also shows where scenes are chosen.
//! A scene that is not in the table is drawn with what the table's first line says.

use crate::workspace::{Workspace, cargo};
use std::process::{Command, ExitCode};

/// A scene, the picture's name (with `scenes/` in front where it is the scene's own), and arguments.
const PICTURES: &[(&str, &str, &[&str])] = &[
    ("mixed_bar", "mixed_bar", &["--size", "1400x700"]),
    ("organ", "organ", &["--size", "1400x700", "--camera", "205,18", "--cut", "z=0.5"]),
    ("mixed_bar", "view/apart", &["--element-size", "0.7", "--at", "1", "--camera", "30,15"]),
    ("organ", "view/stress", &["--colour", "von-mises", "--camera", "205,18", "--range", "0,6000", "--smooth"]),
    ("skin_and_tendon", "view/law", &["--colour", "law"]),
    ("skin_and_tendon", "scenes/skin_and_tendon", &["--colour", "law", "--size", SMALL]),
    ("organ", "scenes/organ", &["--camera", "205,18", "--cut", "z=0.5", "--size", SMALL]),
];

/// Large enough to choose a scene by.
const SMALL: &str = "640x400";

pub(crate) fn run(workspace: &Workspace) -> ExitCode {
    let mut build = Command::new(cargo());
    build.current_dir(&workspace.root).args(["build", "--quiet", "--release", "--package", "souple-viewer"]);
    match build.status() {
        Ok(status) if status.success() => {}
        Ok(_) => return ExitCode::FAILURE,
        Err(e) => {
            eprintln!("cannot start cargo: {e}");
            return ExitCode::FAILURE;
        }
    }
    let program = workspace.target.join("release").join(format!("souple-view{}", std::env::consts::EXE_SUFFIX));
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
        let drawn = Command::new(&program)
            .current_dir(&workspace.root)
            .args([&format!("scenes/{scene}.toml"), "--screenshot", &file])
            .args(more)
            .status();
        match drawn {
            Ok(status) if status.success() => {}
            Ok(status) => {
                eprintln!("{file}: {status}");
                failed = true;
            }
            Err(e) => {
                eprintln!("cannot start {}: {e}", program.display());
                return ExitCode::FAILURE;
            }
        }
    }
    if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS }
}
