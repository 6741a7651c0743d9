//! Promise: `souple check-law` says of a wrong law precisely what is wrong, and of a right one that it is right.

use std::process::{Command, Output};

fn souple(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_souple")).args(arguments).output().expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A law of the registry passes every check, in text and in JSON, and its curves are written.
#[test]
fn a_good_law_passes() {
    let folder = std::env::temp_dir().join(format!("souple-check-law-{}", std::process::id()));
    let plot = folder.to_string_lossy().into_owned();
    let law = ["check-law", "mooney-rivlin", "--set", "c10=1 kPa", "--set", "c01=300", "--set", "bulk=1e5"];
    let output = souple(&[&law[..], &["--json", "--plot", &plot]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one line of JSON");
    assert_eq!(report[0]["passed"], true);
    assert_eq!(report[0]["checks"].as_array().map(Vec::len), Some(5));
    assert!(report[0]["curves"].as_array().is_some_and(|c| c.iter().all(|c| c["points"].as_array().is_some())));
    let drawn = std::fs::read_dir(&folder).expect("the folder was made").count();
    assert_eq!(drawn, 3);
    std::fs::remove_dir_all(&folder).expect("the folder can be removed");
}

/// Stress at rest, a stiffness that is not positive, a dependence on rotations and a slip of the pen are each named.
#[test]
fn faults_are_named() {
    for (energy, code, parts) in [
        ("mu/2*(I1 - 3) + mu*J", 2, &["stress at rest (F = I) is not zero"][..]),
        ("-mu/2*(I1 - 3) + mu*ln(J)", 2, &["not stable at rest"]),
        ("mu*tr(epsilon)^2 + mu*dot(epsilon, epsilon)", 0, &["limited", "rotations change"]),
        ("mu/2*(I1 - ", 2, &["column 12", "found the end"]),
        ("mu/2*(I1bat - 3)", 2, &["I1bar"]),
    ] {
        let output = souple(&["check-law", "--energy", energy, "--set", "mu=1e3"]);
        let said = text(&output.stdout) + &text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{energy}: {said}");
        assert!(parts.iter().all(|part| said.contains(part)), "{energy}: {said}");
    }
}

/// Unknown laws, missing parameters and values without a name end with exit 2 and say what was expected.
#[test]
fn bad_arguments_are_explained() {
    for (arguments, part) in [
        (&["check-law", "stvl"][..], "did you mean `stvk`"),
        (&["check-law", "stvk", "--set", "young=1"], "poisson"),
        (&["check-law", "stvk", "--set", "young"], "NAME=VALUE"),
        (&["check-law", "stvk", "--set", "young=-1", "--set", "poisson=0.3"], "greater than 0"),
    ] {
        let output = souple(arguments);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(part) && !said.contains("stvk:7"), "{said}");
    }
}
