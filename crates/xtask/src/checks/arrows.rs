//! Which crate may depend on which, and where heavy crates may appear at all.
//!
//! The arrow, in one line: symbols → elements, laws → forms, program → kernels → operators → simulation → what people
//! use. A crate that is not in the table may not exist; a crate of the table may be missing.

use crate::stages::Outcome;
use crate::workspace::{DependencyKind, Package, Workspace};

/// Arrows upwards that tests alone may take, each for one reason.
const TEST_ARROWS: &[(&str, &str)] = &[
    // A program is tested by what it computes, which the oracle says.
    ("souple-program", "souple-kernels"),
    // Real programs are run on every backend, where elements and laws are known.
    ("souple-operators", "souple-kernels-cpu"),
];

/// A crate of ours and the crates of ours that it may name. Development dependencies may also name what those name,
/// and so on downwards: a test may look at what its crate stands on.
///
/// [`TEST_ARROWS`] adds what only tests may name.
///
/// `"*"`: everything that stands above it in this table.
const ARROWS: &[(&str, &[&str])] = &[
    ("souple-symbols", &[]),
    ("souple-elements", &["souple-symbols"]),
    ("souple-laws", &["souple-symbols"]),
    ("souple-forms", &["souple-symbols", "souple-elements", "souple-laws"]),
    ("souple-program", &["souple-symbols"]),
    ("souple-kernels", &["souple-program"]),
    ("souple-kernels-cpu", &["souple-kernels", "souple-program"]),
    ("souple-kernels-gpu", &["souple-kernels", "souple-program"]),
    // Shape functions are expressions: integrating one needs the graph that they are written in.
    ("souple-mesh", &["souple-elements", "souple-symbols"]),
    ("souple-solver", &[]),
    // Stands on what it glues together; laws and elements only for their descriptions.
    (
        "souple-operators",
        &[
            "souple-symbols",
            "souple-elements",
            "souple-laws",
            "souple-forms",
            "souple-program",
            "souple-kernels",
            "souple-mesh",
            "souple-solver",
        ],
    ),
    ("souple-scene", &["souple-elements", "souple-laws"]),
    ("souple-simulation", &["*"]),
    // Measures every layer, so that it must see every layer; nothing but the command stands on it.
    ("souple-bench", &["*"]),
    ("souple-campaign", &["souple-simulation"]),
    ("souple-viewer", &["souple-simulation", "souple-campaign"]),
    ("souple-serve", &["souple-simulation"]),
    ("souple-cli", &["souple-simulation", "souple-bench", "souple-campaign", "souple-viewer", "souple-serve"]),
    ("souple-python", &["souple-simulation", "souple-campaign"]),
    ("xtask", &[]),
];

/// Crates of others that are kept behind a fence: the start of their names, who may use them, and why.
const FENCES: &[(&[&str], &[&str], &str)] = &[
    (&["wgpu", "naga"], &["souple-kernels-gpu", "souple-viewer"], "166 CPU-seconds of build, and a driver's whims"),
    (&["egui", "eframe", "winit"], &["souple-viewer"], "windows are for the viewer"),
    (
        &["rusqlite", "postgres", "tokio-postgres", "sqlx", "diesel", "duckdb"],
        &["souple-campaign"],
        "results of many runs live there",
    ),
    (&["pyo3", "numpy"], &["souple-python"], "the bindings are the only crate that knows Python"),
    (
        &["axum", "hyper", "tokio", "tower", "tungstenite", "futures"],
        &["souple-serve"],
        "the network is for the server, and most of what it costs to build",
    ),
    (&["tiny_http", "parquet"], &["souple-campaign"], "reports and exports of many runs are made there"),
    (&["clap"], &["souple-cli", "souple-viewer", "souple-campaign", "souple-serve"], "only programs have arguments"),
    (&["indicatif", "anyhow"], &["souple-cli"], "libraries have typed errors and print nothing"),
];

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let findings: Vec<String> = workspace.packages.iter().flat_map(wrong_arrows).collect();
    Outcome::of(findings, || {
        let edges = workspace.packages.iter().flat_map(|p| &p.dependencies).filter(|d| is_ours(&d.name)).count();
        format!("{} crates, {edges} arrows between them", workspace.packages.len())
    })
}

fn is_ours(name: &str) -> bool {
    name.starts_with("souple-") || ARROWS.iter().any(|(n, _)| *n == name)
}

/// Names that a crate may depend on directly.
fn allowed(name: &str) -> Option<Vec<&'static str>> {
    let at = ARROWS.iter().position(|(n, _)| *n == name)?;
    let above = || ARROWS[..at].iter().map(|(n, _)| *n);
    Some(ARROWS[at].1.iter().flat_map(|&n| if n == "*" { above().collect() } else { vec![n] }).collect())
}

/// Names that a crate's tests may depend on: everything that can be reached downwards.
fn reachable(name: &str) -> Vec<&'static str> {
    let mut found = allowed(name).unwrap_or_default();
    let mut next = 0;
    while next < found.len() {
        for n in allowed(found[next]).unwrap_or_default() {
            if !found.contains(&n) {
                found.push(n);
            }
        }
        next += 1;
    }
    found
}

fn wrong_arrows(package: &Package) -> Vec<String> {
    let name = package.name.as_str();
    let Some(direct) = allowed(name) else {
        return vec![format!(
            "{name} is not in the table of crates: add it to {}, with its reason, or merge it",
            file!()
        )];
    };
    let below = reachable(name);
    let mut findings = Vec::new();
    for dependency in &package.dependencies {
        let to = dependency.name.as_str();
        // Cargo lists a crate that tests itself with a feature as depending on itself.
        if is_ours(to) && to != name {
            let fine = match dependency.kind {
                DependencyKind::Normal | DependencyKind::Build => direct.contains(&to),
                DependencyKind::Development => below.contains(&to) || TEST_ARROWS.contains(&(name, to)),
            };
            if !fine {
                findings.push(format!(
                    "{name} may not depend on {to} ({:?}); it may on: {}",
                    dependency.kind,
                    direct.join(", ")
                ));
            }
        }
        for (heavy, users, reason) in FENCES {
            let fenced =
                heavy.iter().any(|h| to == *h || to.strip_prefix(h).is_some_and(|rest| rest.starts_with(['-', '_'])));
            if fenced && !users.contains(&name) {
                findings.push(format!("{name} may not depend on {to}: only {} may ({reason})", users.join(" and ")));
            }
        }
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::workspace::Dependency;

    fn package(name: &str, kind: DependencyKind, to: &str) -> Package {
        let dependencies = vec![Dependency { name: to.into(), kind }];
        Package { name: name.into(), binaries: Vec::new(), dependencies }
    }

    /// An arrow that the table does not draw is found, one that it draws is not.
    #[test]
    fn wrong_arrows_are_found() {
        use DependencyKind::{Development, Normal};
        for (name, kind, to, count) in [
            ("souple-elements", Normal, "souple-symbols", 0),
            ("souple-elements", Normal, "souple-laws", 1),
            ("souple-kernels", Normal, "souple-symbols", 1),
            ("souple-kernels", Development, "souple-symbols", 0),
            ("souple-kernels", Development, "souple-forms", 1),
            ("souple-solver", Development, "souple-symbols", 1),
            ("souple-simulation", Normal, "souple-mesh", 0),
            ("souple-simulation", Normal, "souple-cli", 1),
            ("souple-mesh", Normal, "wgpu", 1),
            ("souple-viewer", Normal, "egui-wgpu", 0),
            ("souple-mesh", Normal, "clap", 1),
            ("souple-utils", Normal, "serde", 1),
        ] {
            assert_eq!(wrong_arrows(&package(name, kind, to)).len(), count, "{name} → {to} ({kind:?})");
        }
    }

    /// The table draws arrows only between crates that it lists, and never upwards, so it has no cycle.
    #[test]
    fn the_table_goes_one_way() {
        for (at, (name, _)) in ARROWS.iter().enumerate() {
            for to in allowed(name).expect("it is in the table") {
                let below = ARROWS.iter().position(|(n, _)| *n == to);
                assert!(below.is_some_and(|b| b < at), "{name} → {to}");
            }
        }
    }
}
