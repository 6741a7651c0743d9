//! `souple list`: what can be chosen.

use crate::failure::Failure;
use crate::terminal::{say, say_json, table};
use crate::{files, terminal};
use anyhow::Context as _;
use clap::{Args, Subcommand};
use serde::Serialize;
use souple_simulation::lists::{self, DeviceEntry, ElementEntry, IntegratorEntry, LawEntry};
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(after_help = "Example: souple list laws --json")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    /// Finite elements with their quadratures and their names in mesh formats
    #[command(after_help = "Example: souple list elements")]
    Elements(Form),
    /// Constitutive laws with their formulas and parameters
    #[command(after_help = "Example: souple list laws")]
    Laws(Form),
    /// Time integrators with order and stability
    #[command(after_help = "Example: souple list integrators")]
    Integrators(Form),
    /// What kernels can run on, here
    #[command(after_help = "Example: souple list devices")]
    Devices(Form),
    /// Scene files of a folder, with their titles
    #[command(after_help = "Example: souple list scenes --folder scenes")]
    Scenes(Scenes),
}

#[derive(Debug, Args)]
struct Form {
    /// One line of JSON instead of a table
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
struct Scenes {
    /// Where to look, folders in it included
    #[arg(long, default_value = "scenes")]
    folder: PathBuf,
    /// One line of JSON instead of a table
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.what {
        What::Elements(form) => show(form.json, &lists::elements(), element_table),
        What::Laws(form) => show(form.json, &lists::laws(), law_texts),
        What::Integrators(form) => show(form.json, &lists::integrators(), integrator_table),
        What::Devices(form) => show(form.json, &lists::devices(), device_table),
        What::Scenes(scenes) => show(scenes.json, &scenes_in(&scenes.folder)?, scene_table),
    }
}

fn show<T: Serialize>(json: bool, entries: &[T], text: impl Fn(&[T]) -> String) -> Result<(), Failure> {
    if json { say_json(entries) } else { say(&text(entries)) }
}

fn element_table(entries: &[ElementEntry]) -> String {
    let rows: Vec<Vec<String>> = entries
        .iter()
        .map(|e| {
            let rules: Vec<String> = e.quadratures.iter().map(|q| format!("{} (degree {})", q.id, q.degree)).collect();
            let mut names = vec![format!("vtk {}", e.exchange.vtk), format!("gmsh {}", e.exchange.gmsh)];
            if !e.exchange.abaqus.is_empty() {
                names.push(format!("abaqus {}", e.exchange.abaqus.join("/")));
            }
            names.extend(e.exchange.medit.map(|m| format!("medit {m}")));
            let embedded = match (e.dimension, e.embedded.is_empty()) {
                (_, true) => String::from("–"),
                (1, _) => String::from("cable in 2D, 3D"),
                _ => String::from("membrane in 3D"),
            };
            let cells = [e.id, e.family, &e.nodes.to_string(), &e.degree.to_string(), &embedded].map(str::to_owned);
            cells.into_iter().chain([rules.join(", "), names.join(", ")]).collect()
        })
        .collect();
    let heads =
        ["element", "family", "nodes", "degree", "embedded", "quadratures, the default first", "names in formats"];
    table(&heads, &rows)
}

fn law_texts(entries: &[LawEntry]) -> String {
    let mut out = String::new();
    for law in entries {
        out.push_str(&format!("{}  ({})\n  {}\n  ψ = {}\n", law.id, law.name, law.about, law.formula));
        for p in &law.parameters {
            let unit = if p.unit == "1" { String::new() } else { format!(" {}", p.unit) };
            let default = p.default.map(|d| format!(", default {d}")).unwrap_or_default();
            out.push_str(&format!("    {:10} {}{unit}{default}: {}\n", p.name, p.range, p.about));
        }
        for reference in law.references {
            out.push_str(&format!("  see {reference}\n"));
        }
        out.push('\n');
    }
    out
}

fn integrator_table(entries: &[IntegratorEntry]) -> String {
    let rows: Vec<Vec<String>> = entries
        .iter()
        .map(|i| {
            let order = i.order.map_or_else(|| "-".to_owned(), |o| o.to_string());
            let kind = if i.explicit { "explicit" } else { "implicit" };
            vec![i.id.to_owned(), order, kind.to_owned(), i.stability.to_owned(), i.about.to_owned()]
        })
        .collect();
    let note = "h is the step, ω the largest angular frequency of the mesh.";
    format!("{}{note}\n", table(&["integrator", "order", "kind", "stability", "about"], &rows))
}

fn device_table(entries: &[DeviceEntry]) -> String {
    let rows: Vec<Vec<String>> = entries
        .iter()
        .map(|d| {
            let state = match (d.available, d.default) {
                (true, true) => "default",
                (true, false) => "available",
                (false, _) => "not here",
            };
            vec![d.id.clone(), state.to_owned(), d.about.clone()]
        })
        .collect();
    table(&["device", "state", "about"], &rows)
}

/// A scene file.
#[derive(Debug, Serialize)]
struct SceneEntry {
    file: String,
    title: String,
}

/// Scene files under a folder, sorted by path. A `.toml` file is a scene when it has a `[[body]]`.
fn scenes_in(folder: &Path) -> Result<Vec<SceneEntry>, Failure> {
    let mut entries = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let listing = std::fs::read_dir(&folder)
            .with_context(|| format!("cannot list the folder {}; name another one with --folder", folder.display()))?;
        for entry in listing {
            let path = entry.with_context(|| format!("cannot list the folder {}", folder.display()))?.path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "toml") {
                let Ok(text) = files::read_text(&path) else {
                    terminal::note(&format!("warning: {} is not readable text; skipped", path.display()));
                    continue;
                };
                if text.lines().any(|l| l.trim_start().starts_with("[[body]]")) {
                    entries.push(SceneEntry { file: path.display().to_string(), title: title(&text) });
                }
            }
        }
    }
    entries.sort_by(|a, b| a.file.cmp(&b.file));
    Ok(entries)
}

/// The value of the `title` key at the top of a scene, empty where there is none.
///
/// Read by line and not as TOML: a list shows files that are not valid too.
fn title(text: &str) -> String {
    let top = text.lines().take_while(|l| !l.trim_start().starts_with('['));
    let value = top.filter_map(|l| l.trim_start().strip_prefix("title")?.trim_start().strip_prefix('=')).next();
    let quoted = value.map(str::trim).and_then(|v| {
        let quote = v.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        v[1..].split(quote).next()
    });
    quoted.unwrap_or_default().to_owned()
}

fn scene_table(entries: &[SceneEntry]) -> String {
    let rows: Vec<Vec<String>> = entries.iter().map(|s| vec![s.file.clone(), s.title.clone()]).collect();
    table(&["scene", "title"], &rows)
}

#[cfg(test)]
mod tests {
    use super::title;

    /// The title is the one at the top, with either kind of quotes; other tables' keys do not count.
    #[test]
    fn titles_are_found() {
        assert_eq!(title("# a\ntitle = \"A bar\" # b\n"), "A bar");
        assert_eq!(title("gravity=[0,0,0]\ntitle='x'"), "x");
        assert_eq!(title("[time]\ntitle = \"no\""), "");
        assert_eq!(title("titled = \"no\""), "");
    }
}
