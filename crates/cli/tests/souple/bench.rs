//! `souple bench`: that figures are there and mean something; how large they are is not for a test.

use crate::command::Place;
use serde_json::Value;

/// Whether a figure is a positive median between its quartiles.
fn is_spread(value: &Value) -> bool {
    let at = |key: &str| value[key].as_f64().unwrap_or(f64::NAN);
    at("median") > 0.0 && at("lower_quartile") <= at("median") && at("median") <= at("upper_quartile")
}

/// Every program of an element is measured in cache and from memory, with all its figures; nothing but JSON is on
/// standard output.
#[test]
fn kernels_are_measured() {
    let place = Place::new("bench_kernels");
    let answer = place.souple("bench kernels --element tri3 --law hooke --elements 64 --rounds 2 --json").ends_with(0);
    assert_eq!(answer.out.lines().count(), 1);
    let report = answer.json();
    assert!(!report["machine"]["processor"].as_str().unwrap().is_empty());
    assert!(is_spread(&report["peak"]["operations_per_ns"]) && is_spread(&report["peak"]["memory_bytes_per_ns"]));
    assert_eq!(report["threads"], 1);
    let rows = report["rows"].as_array().unwrap();
    let programs = ["force", "linearise", "tangent_apply", "tangent_apply_uncached", "tangent_blocks", "energy"];
    for program in programs {
        let found: Vec<&Value> = rows.iter().filter(|r| r["program"] == program).collect();
        let batches: Vec<_> = found.iter().map(|r| r["batch"].as_str().unwrap()).collect();
        assert_eq!(batches, ["cached", "streamed"], "{program}");
        for row in found {
            assert!(is_spread(&row["ns_per_element"]) && is_spread(&row["compile_ms"]), "{row}");
            assert!(row["operations"].as_u64().is_some() && row["bytes"].as_f64().unwrap() > 0.0, "{row}");
            assert!(
                row["percent_of_peak"].as_f64().unwrap() >= 0.0 && !row["isa"].as_str().unwrap().is_empty(),
                "{row}"
            );
            assert!(["arithmetic", "bandwidth"].contains(&row["bound"].as_str().unwrap()), "{row}");
            assert!(row["ratio_to_handwritten"].is_null(), "{row}");
        }
    }
}

/// With `--against` the kernels that exist by hand and ahead are compared, in JSON and as a table.
#[test]
fn kernels_are_compared() {
    let place = Place::new("bench_against");
    let words = "bench kernels --element tet4 --law stvk --elements 64 --rounds 2 --against";
    let report = place.souple(&format!("{words} --json")).ends_with(0).json();
    for program in ["force", "linearise", "tangent_apply"] {
        for row in report["rows"].as_array().unwrap().iter().filter(|r| r["program"] == program) {
            for figure in ["ratio_to_handwritten", "handwritten_ns", "ratio_to_ahead_of_time", "ahead_of_time_ns"] {
                assert!(is_spread(&row[figure]), "{figure}: {row}");
            }
        }
    }
    let text = place.souple(words).ends_with(0).out;
    assert!(text.contains("ratio to handwritten") && text.contains("tangent_apply_uncached"), "{text}");
}

/// What does not exist is refused with what does, before anything is measured.
#[test]
fn unknown_names_are_refused() {
    let place = Place::new("bench_unknown");
    for (words, known) in [
        ("bench kernels --element tet5", "tet4"),
        ("bench kernels --law stvkk", "stvk"),
        ("bench kernels --device gpu:9", "interpreter"),
        ("bench kernels --rounds 0", "at least 1"),
    ] {
        let answer = place.souple(words).ends_with(2);
        assert!(answer.err.contains(known), "{words}: {}", answer.err);
    }
}
