//! Laws and elements type no derivative: they state an energy, shape functions, and nothing that follows from them.
//!
//! What can be checked by name is checked by name; that the derivatives are right is the tests' part, and they derive.

use crate::checks::format::{NEWCOMERS, SCANNED};
use crate::rust_source::{code_only, identifiers, words};
use crate::stages::Outcome;
use crate::workspace::Workspace;

/// Words of names that promise something derived.
const DERIVED: &[&str] = &[
    "stress",
    "traction",
    "gradient",
    "grad",
    "hessian",
    "tangent",
    "stiffness",
    "derivative",
    "derivatives",
    "jacobian",
    "differential",
    "diff",
    "linearized",
    "linearised",
    "piola",
    "force",
    "moduli",
];

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let mut findings = Vec::new();
    let mut count = 0;
    for folder in SCANNED.iter().chain([&NEWCOMERS]) {
        for file in workspace.files_in(folder, "rs") {
            count += 1;
            match workspace.read(file) {
                Ok(text) => findings.extend(derived(&text).into_iter().map(|(line, name)| {
                    format!("{file}:{line}: `{name}` sounds like a derivative; state the energy or the shape functions only, the rest is derived")
                })),
                Err(complaint) => findings.push(complaint),
            }
        }
    }
    if count == 0 {
        findings.push(format!("no file in {}: the folders moved, and this check with them", SCANNED.join(" nor in ")));
    }
    Outcome::of(findings, || format!("{count} files"))
}

/// Functions, constants and closures outside tests whose name promises a derivative, with their lines.
fn derived(text: &str) -> Vec<(usize, String)> {
    let code = code_only(text);
    let code = code.split("#[cfg(test)]").next().expect("a split has a first part");
    let mut found = Vec::new();
    for (number, line) in code.lines().enumerate() {
        let names: Vec<&str> = identifiers(line).collect();
        for pair in names.windows(2) {
            if matches!(pair[0], "fn" | "const" | "static") && promises_derivative(pair[1]) {
                found.push((number + 1, pair[1].to_owned()));
            }
        }
        // A closure is a function by another name.
        if let ["let", name, ..] = names[..]
            && line.contains("= |")
            && promises_derivative(name)
        {
            found.push((number + 1, name.to_owned()));
        }
    }
    found
}

fn promises_derivative(name: &str) -> bool {
    // dN, dW_dF, d2W; but not `d`, `degree`, `depth`.
    let second = name.strip_prefix('d').and_then(|rest| rest.chars().next());
    let differential = second.is_some_and(|c| c.is_uppercase() || c.is_ascii_digit() || c == '_') && name.len() > 1;
    differential || words(name).iter().any(|w| DERIVED.contains(&w.as_str()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names of derivatives are found in functions, constants and closures, and nowhere else.
    #[test]
    fn derivatives_are_found_by_name() {
        let text = "fn energy() {}\nfn first_piola_stress() {}\npub const dN: u8 = 0;\n// fn hessian()\nlet tangent = |x| x;\n\
                    let gradient = kinematics.f();\nfn degree() {}\nfn dW_dF() {}\n#[cfg(test)]\nmod t { fn stress_is_zero() {} }";
        let lines: Vec<usize> = derived(text).into_iter().map(|(line, _)| line).collect();
        assert_eq!(lines, [2, 3, 5, 8]);
    }
}
