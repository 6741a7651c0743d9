//! What is wrong with a scene once its meshes are there: everything at once, each with its place in the scene.

use souple_scene::Location;
use std::fmt;

/// A problem, and where in the scene it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct PrepareProblem {
    /// Place in the scene.
    pub at: Location,
    /// What is wrong, what was expected and what to do.
    pub message: String,
}

/// Everything that keeps a scene from being prepared, in the order of the scene's text.
///
/// Displayed one problem a line, as `scene.toml:41:10: message`.
#[derive(Clone, Debug, PartialEq)]
pub struct PrepareError {
    /// Name of the scene file, for messages.
    pub scene_file: String,
    /// At least one.
    pub problems: Vec<PrepareProblem>,
}

impl fmt::Display for PrepareError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> =
            self.problems.iter().map(|p| format!("{}: {}", p.at.in_file(&self.scene_file), p.message)).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for PrepareError {}

/// Problems and warnings found so far.
#[derive(Default)]
pub(super) struct Findings {
    problems: Vec<PrepareProblem>,
    warnings: Vec<PrepareProblem>,
}

impl Findings {
    /// Notes a problem; the same one at the same place counts once.
    pub(super) fn problem(&mut self, at: &Location, message: impl Into<String>) {
        note(&mut self.problems, at, message.into());
    }

    /// Notes something that is allowed but probably not meant.
    pub(super) fn warning(&mut self, at: &Location, message: impl Into<String>) {
        note(&mut self.warnings, at, message.into());
    }

    /// Whether anything keeps the scene from being prepared.
    pub(super) fn any_problem(&self) -> bool {
        !self.problems.is_empty()
    }

    /// The warnings as `scene.toml:12:9: warning: message`, or all problems.
    pub(super) fn outcome(mut self, scene_file: &str) -> Result<Vec<String>, PrepareError> {
        if self.problems.is_empty() {
            self.warnings.sort_by(|a, b| a.at.cmp(&b.at));
            let line = |w: &PrepareProblem| format!("{}: warning: {}", w.at.in_file(scene_file), w.message);
            return Ok(self.warnings.iter().map(line).collect());
        }
        self.problems.sort_by(|a, b| a.at.cmp(&b.at));
        Err(PrepareError { scene_file: scene_file.to_owned(), problems: self.problems })
    }
}

fn note(list: &mut Vec<PrepareProblem>, at: &Location, message: String) {
    let problem = PrepareProblem { at: at.clone(), message };
    if !list.contains(&problem) {
        list.push(problem);
    }
}
