//! Documents that point somewhere point at something.
//!
//! README's commands name packages, binaries, subcommands and files that exist, and the test command is among them;
//! relative links in Markdown lead to files, and their `#…` to headings; changelog fragments have a known kind;
//! every identifier of the notation page occurs in the file that its row links to.

use crate::rust_source::identifiers;
use crate::stages::{self, Outcome};
use crate::workspace::Workspace;
use std::path::Path;

/// The command that README promises.
const TEST_COMMAND: &str = "cargo xtask test";

/// The page whose tables give symbols their identifiers.
const NOTATION: &str = "docs/notation.md";

/// Kinds of changelog fragments, as `changelog.d/README.md` explains them.
const KINDS: &[&str] = &["added", "changed", "fixed", "removed", "speed", "accuracy"];

/// Subcommands of cargo that a command in README may use.
const CARGO: &[&str] = &["bench", "build", "check", "clippy", "doc", "fmt", "install", "run", "test"];

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let mut findings = Vec::new();
    let mut commands = Vec::new();
    match workspace.read("README.md") {
        Ok(text) => {
            commands = shell_commands(&text);
            if !commands.iter().any(|c| c == TEST_COMMAND) {
                findings.push(format!("README.md: no `{TEST_COMMAND}` in a ```sh block"));
            }
            if commands.len() < 2 {
                findings.push("README.md: the command that starts Souple is missing in its ```sh blocks".into());
            }
            findings.extend(commands.iter().flat_map(|c| wrong_command(workspace, c)));
        }
        Err(complaint) => findings.push(complaint),
    }

    let mut links = 0;
    for file in workspace.files_in("", "md") {
        match workspace.read(file) {
            Ok(text) => {
                let found = relative_links(&text);
                links += found.len();
                findings.extend(found.iter().filter_map(|(line, link)| {
                    broken(workspace, file, link).map(|why| format!("{file}:{line}: `{link}`: {why}"))
                }));
            }
            Err(complaint) => findings.push(complaint),
        }
    }
    match workspace.read(NOTATION) {
        Ok(text) => {
            for (line, identifier, home) in homes(&text) {
                let path = workspace.root.join("docs").join(&home);
                let found = std::fs::read_to_string(path).is_ok_and(|t| identifiers(&t).any(|w| w == identifier));
                if !found {
                    findings.push(format!(
                        "{NOTATION}:{line}: `{identifier}` is not in {home}: rename it in both, or correct the row"
                    ));
                }
            }
        }
        Err(complaint) => findings.push(complaint),
    }
    findings.extend(
        workspace.files.iter().filter(|f| is_unknown_fragment(f)).map(|file| {
            format!("{file}: a changelog fragment is named `slug.kind.md`, kind one of {}", KINDS.join(", "))
        }),
    );
    Outcome::of(findings, || format!("{} commands, {links} relative links", commands.len()))
}

/// Line, identifier and home of the notation page's rows: back-quoted words of the second column, link in the last.
fn homes(text: &str) -> Vec<(usize, String, String)> {
    let mut homes = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let cells: Vec<&str> = line.trim().trim_matches('|').split('|').map(str::trim).collect();
        let Some((_, link)) = cells.last().and_then(|home| home.split_once("](")) else { continue };
        for identifier in cells.get(1).into_iter().flat_map(|cell| cell.split('`').skip(1).step_by(2)) {
            homes.push((number + 1, identifier.to_owned(), link.trim_end_matches(')').to_owned()));
        }
    }
    homes
}

/// Whether a file lies among the changelog fragments and is none.
fn is_unknown_fragment(file: &str) -> bool {
    let Some(name) = file.strip_prefix("changelog.d/") else { return false };
    let known = |(slug, kind): (&str, &str)| !slug.is_empty() && !slug.contains('.') && KINDS.contains(&kind);
    name != "README.md" && !name.strip_suffix(".md").and_then(|stem| stem.rsplit_once('.')).is_some_and(known)
}

/// Commands of the `sh` blocks, without prompts and comments; a trailing backslash joins lines.
fn shell_commands(text: &str) -> Vec<String> {
    let mut commands = Vec::new();
    let mut inside = false;
    let mut open = String::new();
    for line in text.lines().map(str::trim) {
        if let Some(language) = line.strip_prefix("```") {
            inside = !inside && matches!(language.trim(), "sh" | "bash" | "shell" | "console");
            continue;
        }
        if inside {
            let line = line.split(" #").next().expect("a split has a first part").trim();
            let line = line.strip_prefix("$ ").unwrap_or(line);
            if let Some(start) = line.strip_suffix('\\') {
                open.push_str(start);
            } else if !line.is_empty() && !line.starts_with('#') {
                commands.push(format!("{open}{line}"));
                open.clear();
            }
        }
    }
    commands
}

/// What in a command does not exist.
fn wrong_command(workspace: &Workspace, command: &str) -> Vec<String> {
    let mut findings = Vec::new();
    let words: Vec<&str> = command.split_whitespace().collect();
    let mut find = |what: String| findings.push(format!("README.md: `{command}`: {what}"));
    if let ["cargo", subcommand, rest @ ..] = words.as_slice() {
        if *subcommand == "xtask" {
            if !matches!(rest, [] | ["bless"] | ["test"] | ["test", "--list"])
                && !matches!(rest, ["test", "--only", stage] if stages::ALL.iter().any(|s| s.name == *stage))
            {
                find("xtask has no such command".into());
            }
        } else if !CARGO.contains(subcommand) {
            find(format!("cargo has no `{subcommand}` here"));
        }
        for pair in rest.windows(2) {
            let known = match pair[0] {
                "-p" | "--package" => workspace.packages.iter().any(|p| p.name == pair[1]),
                "--bin" => workspace.packages.iter().any(|p| p.binaries.iter().any(|b| b == pair[1])),
                _ => true,
            };
            if !known {
                find(format!("there is no {}", pair[1]));
            }
        }
    }
    for word in words.iter().filter(|w| is_path(w) && !workspace.root.join(w).exists()) {
        find(format!("there is no {word}"));
    }
    findings
}

/// Whether a word of a command names a file that should be in the repository.
fn is_path(word: &str) -> bool {
    word.contains('/')
        && !word.contains("://")
        && !word.starts_with(['-', '/', '~', '$'])
        && !word.starts_with("target/")
        && !word.starts_with("out/")
}

/// Lines and targets of the links that lead to files here, outside code.
fn relative_links(text: &str) -> Vec<(usize, String)> {
    let mut links = Vec::new();
    let mut inside = false;
    for (number, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            inside = !inside;
        }
        if inside {
            continue;
        }
        // What stands between back-quotes is code.
        let prose: String = line.split('`').step_by(2).collect::<Vec<_>>().join("_");
        for (at, _) in prose.match_indices("](") {
            let target = prose[at + 2..].split([')', ' ']).next().expect("a split has a first part");
            if !target.contains("://") && !target.starts_with("mailto:") && !target.is_empty() {
                links.push((number + 1, target.to_owned()));
            }
        }
    }
    links
}

/// Why a link leads nowhere.
fn broken(workspace: &Workspace, file: &str, link: &str) -> Option<String> {
    let (path, heading) = link.split_once('#').map_or((link, None), |(p, h)| (p, Some(h)));
    let folder = Path::new(file).parent().expect("a file has a folder");
    let relative = if path.is_empty() { Path::new(file).to_owned() } else { folder.join(path) };
    let target = workspace.root.join(relative);
    if !target.exists() {
        return Some("there is no such file".into());
    }
    let heading = heading.filter(|_| target.extension().is_some_and(|e| e == "md"))?;
    match std::fs::read_to_string(&target) {
        Ok(text) if headings(&text).iter().any(|h| h == heading) => None,
        Ok(text) => Some(format!("no such heading; there are {}", headings(&text).join(", "))),
        Err(e) => Some(e.to_string()),
    }
}

/// Headings as links name them: lower case, spaces as hyphens, punctuation dropped.
fn headings(text: &str) -> Vec<String> {
    let lines = text.lines().filter(|l| l.starts_with('#'));
    lines
        .map(|l| {
            let title = l.trim_start_matches('#').trim().to_lowercase();
            title
                .chars()
                .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'))
                .map(|c| if c == ' ' { '-' } else { c })
                .collect()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Commands are read from shell blocks only, joined, and without prompts and comments.
    #[test]
    fn commands_are_read() {
        let text = "```sh\n$ cargo run \\\n  --release # fast\n# nothing\ncargo xtask test\n```\n```toml\nx = 1\n```\ncargo build\n";
        assert_eq!(shell_commands(text), ["cargo run --release", "cargo xtask test"]);
    }

    /// Rows of the notation page are read with their line, every identifier and the link.
    #[test]
    fn notation_rows_are_read() {
        let text = "| s | i | home |\n|---|---|---|\n| β, γ | `beta`, `gamma` | [m.rs](../m.rs) |\n| a | – | [m.rs](../m.rs) |\n";
        let expected = ["beta", "gamma"].map(|i| (3, i.to_owned(), "../m.rs".to_owned()));
        assert_eq!(homes(text), expected);
    }

    /// Only `slug.kind.md` is a changelog fragment.
    #[test]
    fn fragments_are_told_apart() {
        for bad in ["changelog.d/a.md", "changelog.d/a.news.md", "changelog.d/.added.md", "changelog.d/a.added.txt"] {
            assert!(is_unknown_fragment(bad), "{bad}");
        }
        for good in ["changelog.d/mixed-bar.added.md", "changelog.d/README.md", "docs/a.md"] {
            assert!(!is_unknown_fragment(good), "{good}");
        }
    }

    /// Links are read outside code, with their lines; those to other sites are left alone.
    #[test]
    fn links_are_read() {
        let text = "[a](b.md) and `[x](y)` and ![p](c/d.png \"title\")\n```\n[n](o)\n```\n[w](https://a.b) [h](#top)\n";
        let expected = [(1, "b.md"), (1, "c/d.png"), (5, "#top")].map(|(n, l)| (n, l.to_owned()));
        assert_eq!(relative_links(text), expected);
        assert_eq!(headings("# One, two: `three`\ntext\n## A-b"), ["one-two-three", "a-b"]);
    }
}
