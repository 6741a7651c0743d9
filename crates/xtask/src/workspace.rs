//! The repository as the checks see it: its folder, its text files, its packages.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folders that hold nothing written by a person.
const GENERATED: &[&str] = &["target", "out", "node_modules", "__pycache__", "venv"];
/// Folders with a leading dot that do.
const HIDDEN: &[&str] = &[".cargo", ".ci", ".github", ".config"];

/// What cargo is told so that the desktop's window is checked and tested too.
pub(crate) const WINDOW: &str = "souple-viewer/window";

/// Everything that the checks read.
pub(crate) struct Workspace {
    /// The repository's folder.
    pub(crate) root: PathBuf,
    /// Where cargo puts what it builds.
    pub(crate) target: PathBuf,
    /// The workspace's own packages.
    pub(crate) packages: Vec<Package>,
    /// Every file, relative to the root with `/` between names, sorted.
    pub(crate) files: Vec<String>,
}

/// A package of the workspace.
pub(crate) struct Package {
    /// Its name (`"souple-mesh"`).
    pub(crate) name: String,
    /// Its binaries.
    pub(crate) binaries: Vec<String>,
    /// What its manifest asks for.
    pub(crate) dependencies: Vec<Dependency>,
}

/// A line of a manifest's dependency tables.
pub(crate) struct Dependency {
    /// Name of the package.
    pub(crate) name: String,
    /// Which table it stands in.
    pub(crate) kind: DependencyKind,
}

/// The dependency tables of a manifest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DependencyKind {
    /// `[dependencies]`
    Normal,
    /// `[dev-dependencies]`
    Development,
    /// `[build-dependencies]`
    Build,
}

impl Workspace {
    /// Asks cargo about the workspace that this program belongs to, and lists its files.
    pub(crate) fn load() -> Result<Workspace, String> {
        let output = Command::new(cargo())
            .args(["metadata", "--format-version", "1", "--no-deps"])
            .stderr(Stdio::inherit())
            .output()
            .map_err(|e| format!("cannot start cargo: {e}"))?;
        if !output.status.success() {
            return Err("`cargo metadata` failed".into());
        }
        let metadata: Value =
            serde_json::from_slice(&output.stdout).map_err(|e| format!("`cargo metadata` printed no JSON: {e}"))?;
        let root = PathBuf::from(text(&metadata, "workspace_root")?);
        let target = PathBuf::from(text(&metadata, "target_directory")?);
        let packages = list(&metadata, "packages")?.iter().map(package).collect::<Result<_, _>>()?;
        let files = files_below(&root)?;
        Ok(Workspace { root, target, packages, files })
    }

    /// Content of a text file, given by its path relative to the root.
    pub(crate) fn read(&self, file: &str) -> Result<String, String> {
        std::fs::read_to_string(self.root.join(file)).map_err(|e| format!("{file}: {e}"))
    }

    /// Files below a folder (`"crates/laws/src/laws/"`, `""` for all) with this extension.
    pub(crate) fn files_in<'a>(&'a self, folder: &'a str, extension: &'a str) -> impl Iterator<Item = &'a str> {
        let all = self.files.iter().map(String::as_str);
        all.filter(move |f| f.starts_with(folder) && f.rsplit_once('.').is_some_and(|(_, e)| e == extension))
    }
}

/// The cargo that started us, or the one on the path.
pub(crate) fn cargo() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".into())
}

/// Every file below a folder that a person wrote, relative to it with `/` between names, sorted.
pub(crate) fn files_below(root: &Path) -> Result<Vec<String>, String> {
    let mut files = Vec::new();
    walk(root, root, &mut files)?;
    files.sort();
    Ok(files)
}

fn walk(root: &Path, folder: &Path, files: &mut Vec<String>) -> Result<(), String> {
    let listing = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for entry in listing {
        let entry = entry.map_err(|e| format!("{}: {e}", folder.display()))?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let kind = entry.file_type().map_err(|e| format!("{}: {e}", entry.path().display()))?;
        if kind.is_dir() {
            let hidden = name.starts_with('.') && !HIDDEN.contains(&name.as_str());
            if !hidden && !GENERATED.contains(&name.as_str()) {
                walk(root, &entry.path(), files)?;
            }
        } else if kind.is_file() && !name.ends_with(".tmp") {
            let path = entry.path();
            let relative = path.strip_prefix(root).expect("the walk starts at the root");
            let names: Vec<_> = relative.components().map(|c| c.as_os_str().to_string_lossy()).collect();
            files.push(names.join("/"));
        }
    }
    Ok(())
}

fn package(value: &Value) -> Result<Package, String> {
    let mut binaries = Vec::new();
    for target in list(value, "targets")? {
        if list(target, "kind")?.iter().any(|k| k == "bin") {
            binaries.push(text(target, "name")?);
        }
    }
    let mut dependencies = Vec::new();
    for dependency in list(value, "dependencies")? {
        let kind = match dependency["kind"].as_str() {
            None => DependencyKind::Normal,
            Some("dev") => DependencyKind::Development,
            Some("build") => DependencyKind::Build,
            Some(other) => return Err(format!("`cargo metadata`: unknown kind of dependency `{other}`")),
        };
        dependencies.push(Dependency { name: text(dependency, "name")?, kind });
    }
    Ok(Package { name: text(value, "name")?, binaries, dependencies })
}

fn text(value: &Value, key: &str) -> Result<String, String> {
    value[key].as_str().map(str::to_owned).ok_or_else(|| format!("`cargo metadata`: no text under `{key}`"))
}

fn list<'a>(value: &'a Value, key: &str) -> Result<&'a Vec<Value>, String> {
    value[key].as_array().ok_or_else(|| format!("`cargo metadata`: no list under `{key}`"))
}
