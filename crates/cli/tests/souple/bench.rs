//! `souple bench`: that figures are there and mean something; how large they are is not for a test.

use crate::command::Place;
use serde_json::Value;

/// Whether a figure is a positive median between its quartiles.
fn is_spread(value: &Value) -> bool {
    let at = |key: &str| value[key].as_f64().unwrap_or(f64::NAN);
    at("median") > 0.0
        && at("least") <= at("lower_quartile")
        && at("lower_quartile") <= at("median")
        && at("median") <= at("upper_quartile")
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

/// Forces, products and assembly are measured for each element with each law.
#[test]
fn operators_are_measured() {
    let place = Place::new("bench_operators");
    let words = "bench operators --element quad4,tri3 --law hooke --elements 40 --rounds 2";
    let report = place.souple(&format!("{words} --json")).ends_with(0).json();
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.iter().map(|r| r["element"].as_str().unwrap()).collect::<Vec<_>>(), ["quad4", "tri3"]);
    for row in rows {
        for figure in ["force", "linearise", "matrix_free_product", "assembled_product", "assembly"] {
            assert!(is_spread(&row[figure]), "{figure}: {row}");
        }
        assert_eq!(row["elements"], 40);
    }
    assert!(place.souple(words).ends_with(0).out.contains("assembled product"));
}

/// Steps of a bar make the iterations that were asked for, of a mixture as well as of one element; the parts of a step
/// are there, and the products of an iterative solve took some time.
#[test]
fn steps_are_measured() {
    let place = Place::new("bench_step");
    for element in ["tet4", "mixed"] {
        let words = format!("bench step --cells 60 --element {element} --cg 5 --steps 3");
        let report = place.souple(&format!("{words} --json")).ends_with(0).json();
        assert_eq!(report["iterations"], 5.0, "{report}");
        assert_eq!(report["step_ms"]["rounds"], 3);
        assert!(is_spread(&report["step_ms"]) && report["step_ms_p99"].as_f64().unwrap() > 0.0, "{report}");
        for phase in ["force", "linearise", "product", "rest_of_solve"] {
            assert!(is_spread(&report["phases_ms"][phase]), "{phase}: {report}");
        }
        assert!(place.souple(&words).ends_with(0).out.contains("rest of solve"));
    }
}

/// A scene's own steps are measured; one that ends too soon is refused with what to do.
#[test]
fn steps_of_a_scene_are_measured() {
    let place = Place::new("bench_scene");
    place.write("bar.toml", BAR);
    let report = place.souple("bench step --scene bar.toml --steps 2 --json").ends_with(0).json();
    assert_eq!(report["elements"], 2);
    let answer = place.souple("bench step --scene bar.toml --steps 50").ends_with(2);
    assert!(answer.err.contains("set time.end"), "{}", answer.err);
}

const BAR: &str = r#"
[time]
step = 0.01
end = 0.05

[[body]]
name = "bar"
density = 1000.0
[body.mesh]
generator = "bar"
size = [2.0, 1.0, 1.0]
cells = [2, 1, 1]
sections = [{ until = 1.0, element = "hex8" }]
[[body.material]]
region = "all"
law = "hooke"
young = 1e6
poisson = 0.3
[[body.fix]]
region = "x_min"
"#;

/// Loading is measured as a whole and by phase, with memory where the system tells.
#[test]
fn setups_are_measured() {
    let place = Place::new("bench_setup");
    let report = place.souple("bench setup --cells 100 --json").ends_with(0).json();
    for phase in ["load_s", "parse_s", "prepare_s", "elements_s", "pattern_s"] {
        assert!(report[phase].as_f64().unwrap() > 0.0, "{phase}: {report}");
    }
    if cfg!(target_os = "linux") {
        assert!(report["peak_memory_bytes"].as_u64() >= report["memory_before_bytes"].as_u64());
        assert!(report["peak_memory_bytes"].as_u64().unwrap() > 1 << 20, "{report}");
    }
    assert!(place.souple("bench setup --cells 100").ends_with(0).out.contains("MiB"));
}

/// What does not exist is refused with what does, before anything is measured.
#[test]
fn unknown_names_are_refused() {
    let place = Place::new("bench_unknown");
    for (words, known) in [
        ("bench kernels --element tet5", "tet4"),
        ("bench kernels --law stvkk", "stvk"),
        ("bench kernels --device cpu:9", "interpreter"),
        ("bench kernels --device gpu:nosuchcard", "--device cpu"),
        ("bench kernels --rounds 0", "at least 1"),
        ("bench step --element tet5", "tet4"),
        ("bench step --law stvkk", "stvk"),
        ("bench step --scene nowhere.toml", "nowhere.toml"),
        ("bench setup --cells 0", "at least 1"),
    ] {
        let answer = place.souple(words).ends_with(2);
        assert!(answer.err.contains(known), "{words}: {}", answer.err);
    }
}
