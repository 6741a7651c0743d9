//! Every law and every element of the repository has the data that its tests compare it with.
//!
//! Why not in these tests? They run over the registries, and a law or an element that someone has just dropped into the
//! folder is in the registry. It must work at once, without numbers that nobody has computed yet; so the tests compare
//! what has data, and this check asks for the data of everything that is to be committed.

use crate::stages::Outcome;
use crate::workspace::Workspace;
use std::collections::BTreeSet;

/// Folders of what has data.
const LAWS: &str = "crates/laws/src/laws/";
const ELEMENTS: &str = "crates/elements/src/elements/";
/// Energies and stresses computed without this program; two deformations of each law at least.
const STRESSES: &str = "crates/laws/tests/data/stresses.txt";
/// Operations of every law on the elements: a file per law, a paragraph per element.
const COUNTS: &str = "crates/operators/tests/goldens/counts/";
/// Observed orders of convergence, a row per element.
const ORDERS: &str = "docs/validation.md";

pub(crate) fn run(workspace: &Workspace) -> Outcome {
    let stem = |path: &str| path.rsplit(['/']).next().and_then(|name| name.split('.').next()).map(str::to_owned);
    let laws: Vec<String> = workspace.files_in(LAWS, "rs").filter_map(stem).map(|s| s.replace('_', "-")).collect();
    let elements: BTreeSet<String> = workspace.files_in(ELEMENTS, "rs").filter_map(stem).collect();
    if laws.is_empty() || elements.is_empty() {
        return Outcome::failed(format!("no file in {LAWS} or in {ELEMENTS}: they moved, and this check with them"));
    }
    let stresses = match workspace.read(STRESSES) {
        Ok(text) => text,
        Err(complaint) => return Outcome::failed(complaint),
    };
    let mut findings = without_stresses(&laws, &stresses);
    let counts: Vec<(&str, Option<String>)> =
        laws.iter().map(|law| (law.as_str(), workspace.read(&format!("{COUNTS}{law}.txt")).ok())).collect();
    findings.extend(without_counts(&counts, &elements));
    match workspace.read(ORDERS) {
        Ok(text) => findings.extend(without_orders(&elements, &text)),
        Err(complaint) => findings.push(complaint),
    }
    Outcome::of(findings, || format!("{} laws, {} elements", laws.len(), elements.len()))
}

/// Laws with fewer than two reference stresses.
fn without_stresses(laws: &[String], stresses: &str) -> Vec<String> {
    let lines = |law: &str| {
        stresses
            .lines()
            .filter(|line| line.strip_prefix("law ").is_some_and(|l| l.split(' ').next() == Some(law)))
            .count()
    };
    let lacking = laws.iter().filter(|law| lines(law) < 2);
    lacking
        .map(|law| {
            format!(
                "{STRESSES}: `{law}` has {} deformations of at least 2: compute them (see make.py beside it)",
                lines(law)
            )
        })
        .collect()
}

/// Laws without a table of counts, and tables that lack elements.
fn without_counts(counts: &[(&str, Option<String>)], elements: &BTreeSet<String>) -> Vec<String> {
    const ADVICE: &str = "run `SOUPLE_BLESS=1 cargo test -p souple-operators` and read the difference";
    let listed = |text: &str| -> BTreeSet<String> {
        let heads = text.split("\n\n").skip(1).filter_map(|paragraph| paragraph.split_whitespace().next());
        heads.map(str::to_owned).collect()
    };
    let mut findings: Vec<String> = counts
        .iter()
        .filter(|(_, text)| text.is_none())
        .map(|(law, _)| format!("{COUNTS}{law}.txt is missing: {ADVICE}"))
        .collect();
    let tables = counts.iter().filter_map(|(law, text)| Some((*law, listed(text.as_deref()?))));
    for (law, found) in tables {
        let missing: Vec<&str> = elements.difference(&found).map(String::as_str).collect();
        let unknown: Vec<&str> = found.difference(elements).map(String::as_str).collect();
        if !missing.is_empty() {
            findings.push(format!("{COUNTS}{law}.txt lacks {}: {ADVICE}", missing.join(", ")));
        }
        if !unknown.is_empty() {
            findings.push(format!("{COUNTS}{law}.txt has {}, which is no element here: {ADVICE}", unknown.join(", ")));
        }
    }
    findings
}

/// Elements without a row in the table of orders.
fn without_orders(elements: &BTreeSet<String>, page: &str) -> Vec<String> {
    let lacking = elements.iter().filter(|e| !page.contains(&format!("\n| {e} | Hooke | smooth |")));
    lacking
        .map(|e| {
            format!("{ORDERS}: no row for `{e}`: `cargo test -p souple-operators --test convergence -- --nocapture` prints it")
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An element needs a row of its own with Hooke's law.
    #[test]
    fn missing_orders_are_found() {
        let elements: BTreeSet<String> = ["quad4", "quad8"].map(str::to_owned).into();
        let page = "text\n| quad8 | Hooke | smooth | 8, 16 |\n| quad4 | Hooke | trapezoids | 8, 16 |\n";
        let found = without_orders(&elements, page);
        assert!(found.len() == 1 && found[0].contains("`quad4`"), "{found:?}");
    }

    /// A law needs two lines of its own name, not of a name that begins like it.
    #[test]
    fn laws_without_stresses_are_found() {
        let laws = ["yeoh".to_owned(), "ogden".to_owned()];
        let text = "# law ogden 1\nlaw yeoh 1 2\nlaw yeoh 3 4\nlaw ogden 1\nlaw ogden-two 2\n";
        let found = without_stresses(&laws, text);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].contains("`ogden` has 1"), "{found:?}");
    }

    /// A missing table, a missing element and one that is gone are found.
    #[test]
    fn gaps_in_the_counts_are_found() {
        let elements: BTreeSet<String> = ["edge2", "tet4", "hex27"].map(str::to_owned).into();
        let table = |names: &[&str]| {
            Some(names.iter().fold("# head\n".to_owned(), |text, n| format!("{text}\n{n} law rule: 1\n  force 1\n")))
        };
        let complete = [
            ("hooke", table(&["edge2", "tet4", "hex27"])),
            ("stvk", table(&["edge2", "tet4", "hex27"])),
            ("yeoh", table(&["edge2", "tet4", "hex27"])),
        ];
        assert_eq!(without_counts(&complete, &elements), Vec::<String>::new());
        let gaps = [
            ("hooke", table(&["edge2", "tet4", "hex27", "hex64"])),
            ("stvk", table(&["edge2", "tet4"])),
            ("fung", table(&["tet4", "hex27"])),
            ("ogden", None),
        ];
        let found = without_counts(&gaps, &elements);
        assert_eq!(found.len(), 4, "{found:?}");
        for (finding, words) in found.iter().zip(["ogden.txt is missing", "has hex64", "lacks hex27", "lacks edge2"]) {
            assert!(finding.contains(words), "{found:?}");
        }
    }
}
