//! What no file of the repository may contain, whatever it is about.
//!
//! Sizes, texts left for later, sleeping and ignored tests, paths of one machine, exceptions without a reason, and
//! `unsafe` outside the crates that exist for it.

use crate::rust_source::{code_only, identifiers};
use crate::stages::Outcome;
use crate::workspace::Workspace;

/// Above this a file holds more than one concept.
const LINES: usize = 800;

/// Files that may be longer, and why.
const LONG: &[(&str, &str)] = &[];

/// Folders where raw memory is touched, and why.
const UNSAFE: &[(&str, &str)] = &[
    ("crates/kernels-cpu/", "vector lanes and machine code"),
    ("crates/kernels-gpu/", "mapped device memory"),
    ("crates/python/", "borrowed arrays of another language"),
];

/// Files that contain forbidden texts on purpose.
const SPEAKS_OF_THEM: &[(&str, &str)] = &[("crates/xtask/src/checks/text.rs", "this list")];

/// Starts of absolute paths that exist on one machine only.
const MACHINE_PATHS: &[&str] = &["/home/", "/root/", "/Users/", "/work/", "/tmp/", "/mnt/", "/opt/", "C:\\"];

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let mut findings = Vec::new();
    let mut count = 0;
    for extension in ["rs", "wgsl", "py", "toml", "md", "sh", "yml", "yaml", "prog", "rule"] {
        for file in workspace.files_in("", extension) {
            count += 1;
            match workspace.read(file) {
                Ok(text) => findings.extend(check(file, &text)),
                Err(complaint) => findings.push(complaint),
            }
        }
    }
    for (file, _) in LONG.iter().chain(SPEAKS_OF_THEM).filter(|(f, _)| !workspace.files.iter().any(|g| g == f)) {
        findings.push(format!("{file} is listed as an exception and does not exist: remove it from {}", file!()));
    }
    Outcome::of(findings, || format!("{count} files, {} over {LINES} lines", LONG.len()))
}

fn check(file: &str, text: &str) -> Vec<String> {
    let mut findings = Vec::new();
    let rust = file.ends_with(".rs");
    let program = rust || file.ends_with(".wgsl") || file.ends_with(".py");
    let lines = text.lines().count();
    if program && lines > LINES && !LONG.iter().any(|(f, _)| *f == file) {
        findings.push(format!("{file}: {lines} lines; split it by concept, or list it in {} with a reason", file!()));
    }
    if !SPEAKS_OF_THEM.iter().any(|(f, _)| *f == file) {
        for (number, line) in text.lines().enumerate() {
            findings.extend(left_for_later(line).map(|why| format!("{file}:{}: {why}", number + 1)));
            if let Some(path) = MACHINE_PATHS.iter().find(|p| names_path(line, p)) {
                findings
                    .push(format!("{file}:{}: `{path}…` exists on one machine only; use a relative path", number + 1));
            }
        }
    }
    if rust {
        findings.extend(check_code(file, text));
    }
    findings
}

/// What only code can contain.
fn check_code(file: &str, text: &str) -> Vec<String> {
    let mut findings = Vec::new();
    let code = code_only(text);
    let originals: Vec<&str> = text.lines().collect();
    for (number, line) in code.lines().enumerate() {
        let mut find = |what: &str| findings.push(format!("{file}:{}: {what}", number + 1));
        for (forbidden, why) in [
            ("todo!(", "`todo!` is a promise, not code"),
            (
                "unimplemented!(",
                "`unimplemented!` is a promise, not code; refuse with a typed error that says what is missing",
            ),
            ("#[ignore", "an ignored test shows nothing; make it quick, or make it a bench"),
            ("thread::sleep", "sleeping makes slow machines fail; wait for what you wait for"),
        ] {
            if line.contains(forbidden) {
                find(why);
            }
        }
        if identifiers(line).any(|w| w == "unsafe") {
            match UNSAFE.iter().any(|(folder, _)| file.starts_with(folder)) {
                false => find("`unsafe` is for the crates listed in the check, which exist for it"),
                true if !is_argued(line, &originals[..=number]) => find("say with `// SAFETY:` why this holds"),
                true => {}
            }
        }
    }
    findings.extend(
        reasonless(&code, text).into_iter().map(|n| format!("{file}:{n}: an exception without `reason = \"…\"`")),
    );
    findings
}

fn left_for_later(line: &str) -> Option<&'static str> {
    let word = identifiers(line).find(|w| matches!(*w, "TODO" | "FIXME" | "XXX" | "HACK"))?;
    let after = line.split_once(word)?.1;
    let issue = after.strip_prefix("(#").and_then(|rest| rest.split_once(')')).map(|(issue, _)| issue);
    match (word, issue) {
        ("TODO", Some(issue)) if !issue.is_empty() && issue.chars().all(|c| c.is_ascii_digit()) => None,
        _ => Some("left for later: do it, or write `TODO(#issue)`"),
    }
}

/// Whether a line names a path that starts so, and not one in which the same letters occur further on.
fn names_path(line: &str, start: &str) -> bool {
    line.match_indices(start).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        !before.is_some_and(|c| c.is_alphanumeric() || matches!(c, '.' | '_' | '-' | '/' | '}' | ')' | ':' | '~' | '*'))
    })
}

/// Whether an `unsafe` block or implementation has its argument on its own line or in the comment right above.
fn is_argued(code: &str, originals: &[&str]) -> bool {
    let after = code.split_once("unsafe").map_or("", |(_, rest)| rest.trim_start());
    // `unsafe fn` and function types ask it of their callers: the compiler wants a block there.
    if !(after.starts_with('{') || after.starts_with("impl")) {
        return true;
    }
    let (line, above) = originals.split_last().expect("the line itself is there");
    line.contains("SAFETY:")
        || above
            .iter()
            .rev()
            .take_while(|l| l.trim_start().starts_with("//") || l.trim_start().starts_with("#["))
            .any(|l| l.contains("SAFETY:"))
}

/// Lines of `allow` and `expect` attributes that give no reason.
fn reasonless(code: &str, text: &str) -> Vec<usize> {
    let mut found = Vec::new();
    let mut line_starts = vec![0];
    line_starts.extend(code.match_indices('\n').map(|(at, _)| at + 1));
    for start in ["[allow(", "[expect("] {
        for (at, _) in code.match_indices(start) {
            let end = code[at..].find(")]").map_or(code.len(), |n| at + n);
            if !identifiers(&code[at..end]).any(|w| w == "reason") {
                let line = line_starts.partition_point(|&s| s <= at);
                debug_assert!(line <= text.lines().count());
                found.push(line);
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each forbidden thing is found in a text that has it, on its line, and not in one that only looks like it.
    #[test]
    fn forbidden_texts_are_found() {
        for bad in [
            "// TODO later",
            "// FIXME(#3)",
            "fn f() { todo!() }",
            "#[ignore]",
            "std::thread::sleep(d);",
            "let p = \"/home/me/x\";",
            "open(/tmp/x)",
            "#[allow(dead_code)]",
            "#![expect(\n  clippy::all,\n)]",
            "unsafe { f() }",
        ] {
            let findings = check("crates/mesh/src/a.rs", &format!("\n{bad}\n"));
            assert_eq!(findings.len(), 1, "{bad}: {findings:?}");
            assert!(findings[0].starts_with("crates/mesh/src/a.rs:2: "), "{findings:?}");
        }
        for good in [
            "// TODO(#12): later",
            "// todo!() is forbidden",
            "let p = \"scenes/tmp/x\"; // https://a.org/home/b",
            "#[allow(dead_code, reason = \"why\")]",
            "#![expect(\n  clippy::all,\n  reason = \"why\"\n)]",
            "#![deny(unsafe_code)] // unsafe",
        ] {
            assert_eq!(check("crates/mesh/src/a.rs", good), [""; 0], "{good}");
        }
    }

    /// In the crates that exist for it, `unsafe` is fine when it is argued, and only then.
    #[test]
    fn unsafe_code_argues() {
        let file = "crates/kernels-cpu/src/lanes.rs";
        assert_eq!(check(file, "fn f() {\n    unsafe { g() }\n}").len(), 1);
        for argued in [
            "    // SAFETY: g is total\n    unsafe { g() }",
            "let x = unsafe { g() }; // SAFETY: total",
            "unsafe fn g() {}",
        ] {
            assert_eq!(check(file, argued), [""; 0], "{argued}");
        }
    }

    /// A file that outgrows the limit is found.
    #[test]
    fn long_files_are_found() {
        assert_eq!(check("crates/mesh/src/a.rs", &"\n".repeat(LINES)).len(), 0);
        assert_eq!(check("crates/mesh/src/a.rs", &"\n".repeat(LINES + 1)).len(), 1);
    }
}
