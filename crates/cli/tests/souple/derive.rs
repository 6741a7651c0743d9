//! `souple derive`.

use crate::command::Place;

/// The JSON holds the numbers that scripts ask for, and they agree with each other.
#[test]
fn numbers_are_for_machines() {
    let place = Place::new("derive_json");
    for element in ["tet4", "hex8"] {
        let json = place.souple(&format!("derive --element {element} --law stvk --json")).ends_with(0).json();
        assert_eq!((json["element"].as_str(), json["law"].as_str()), (Some(element), Some("stvk")));
        let points = json["points"].as_u64().unwrap();
        for border in ["setup_to_step", "step_to_apply"] {
            let (all, detail) = (json["carried"][border].as_u64().unwrap(), &json["carried"]["detail"][border]);
            let (once, each) = (detail["once"].as_u64().unwrap(), detail["per_point"].as_u64().unwrap());
            assert_eq!(all, once + each);
            assert_eq!(detail["per_element"].as_u64().unwrap(), once + points * each);
        }
        for program in
            ["setup", "energy", "force", "linearise", "tangent_apply", "tangent_apply_uncached", "tangent_blocks"]
        {
            let all = json["operations"][program].as_f64().unwrap();
            let each = json["per_point"][program].as_f64().unwrap();
            assert!(all > 0.0 && each > 0.0 && each * points as f64 <= all, "{program}: {all}, {each}");
        }
        assert!(json["derive_ms"].as_f64().unwrap() > 0.0);
        assert!(json["quadrature"].is_string());
    }
}

/// A quadrature is named by id or by number of points, and changes what is derived.
#[test]
fn quadratures_are_chosen() {
    let place = Place::new("derive_quadrature");
    let derive = |q: &str| place.souple(&format!("derive --element hex8 --law hooke --quadrature {q} --json")).json();
    let (by_points, by_id) = (derive("1"), derive("hexahedron-1"));
    assert_eq!(by_points["quadrature"], "hexahedron-1");
    assert_eq!(by_points["operations"], by_id["operations"]);
    assert!(derive("27")["operations"]["force"].as_u64() > by_id["operations"]["force"].as_u64());
}

/// Each view prints its kind of text: table, formulas, program, LaTeX document.
#[test]
fn views_differ() {
    let place = Place::new("derive_views");
    let show = |view: &str| place.souple(&format!("derive --element tri3 --law stvk {view}")).ends_with(0).out;
    assert!(show("").contains("carried values"));
    assert!(show("--show expressions").contains("\nf_2y = "));
    assert!(show("--show expressions --output energy").trim_end().lines().last().unwrap().starts_with("W = "));
    let program = show("--show program --output tangent_apply");
    assert!(program.starts_with("program tangent_apply\n") && program.ends_with("end\n"));
    let latex = show("--show latex");
    assert!(latex.starts_with("\\documentclass") && latex.ends_with("\\end{document}\n"));
    let json = place.souple("derive --element tri3 --law stvk --show latex --json").ends_with(0).json();
    assert_eq!(json["shown"].as_str().unwrap(), latex);
}

/// The program of a device is printed in two languages, with where it comes from and what it costs in its head.
#[cfg(feature = "gpu")]
#[test]
fn programs_of_devices_are_shown() {
    let place = Place::new("derive_devices");
    let show = |what: &str| place.souple(&format!("derive --element hex8 --law stvk {what}")).ends_with(0).out;
    let wgsl = show("--show wgsl --output tangent_apply");
    assert!(wgsl.starts_with("// Derived from the element hex8 and the law stvk"), "{wgsl}");
    assert!(wgsl.contains("operations per item") && wgsl.contains("@compute @workgroup_size(64)"), "{wgsl}");
    let json = place.souple("derive --element hex8 --law stvk --json").ends_with(0).json();
    let count = json["operations"]["tangent_apply"].as_u64().unwrap();
    assert!(wgsl.contains(&format!(": {count} operations per item")), "{count}");
    assert!(show("--show cuda").contains("__global__"));
}

/// A price that makes carrying dear leaves fewer values to carry; unrolled programs have no loop.
#[test]
fn costs_and_loops_are_options() {
    let place = Place::new("derive_options");
    let carried = |price: u64| {
        let words = format!("derive --element hex8 --law stvk --carry-price {price} --json");
        place.souple(&words).ends_with(0).json()["carried"]["detail"]["step_to_apply"]["per_element"].as_u64().unwrap()
    };
    assert!(carried(1000) < carried(1));
    let text = place.souple("derive --element quad4 --law stvk --show program").ends_with(0).out;
    assert!(text.contains("\nloop\n"));
    let text = place.souple("derive --element quad4 --law stvk --show program --unrolled").ends_with(0).out;
    assert!(!text.contains("\nloop\n"));
}

/// A wrong name ends with exit code 2, the nearest name and the list.
#[test]
fn wrong_names_are_answered() {
    let place = Place::new("derive_names");
    for (words, nearest, listed) in [
        ("--element hexa8 --law stvk", "hex8", "pyramid5"),
        ("--element hex8 --law stkv", "stvk", "hooke"),
        ("--element hex8 --law stvk --quadrature hexahedron-9", "hexahedron-8", "hexahedron-27"),
        ("--element hex8 --law stvk --output forces", "force", "energy"),
    ] {
        let error = place.souple(&format!("derive {words}")).ends_with(2).err;
        assert!(error.contains(&format!("did you mean `{nearest}`?")) && error.contains(listed), "{error}");
    }
}
