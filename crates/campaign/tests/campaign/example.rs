//! The example of a thesis of 2014: its files (table 5.1, codes 20 and 21) and what they give (table 5.2).

use souple_campaign::folder::parse;
use souple_campaign::group::Group;
use souple_campaign::plan::plan;
use std::path::Path;

fn read(folder: &Path) -> Group {
    parse("example", "example", &mut |file| {
        std::fs::read_to_string(folder.join(file)).map_err(|e| format!("cannot read {file}: {e}"))
    })
    .unwrap_or_else(|problems| panic!("{problems}"))
}

/// Parameters in the order of table 5.2, and their values where only one is printed for all twelve simulations.
pub(crate) const FIXED: &[(&str, f64)] = &[
    ("longueur", 1.2),
    ("largeurSection", 0.2),
    ("densite", 800.0),
    ("poissonRatio", 0.20),
    ("pourcentage", 0.05),
    ("tempsEtirement", 0.9),
    ("epsilonStable", 0.06),
    ("pas", 0.01),
    ("typeSimulation", 1.0),
    ("typeIntegration", 1.0),
];

/// The files give twelve simulations for each of two bars, with the values of table 5.2, column by column.
#[test]
fn the_example_gives_its_24_simulations() {
    let group = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/example"));
    let simulations = plan(&group).unwrap();
    assert_eq!(simulations.len(), 24);
    let cubes = [40.0, 80.0, 160.0, 320.0];
    for (n, simulation) in simulations.iter().enumerate() {
        let of = |name: &str| {
            let at = group.parameters.iter().position(|p| p.name == name).unwrap();
            simulation.values[at].number().unwrap()
        };
        let column = n % 12;
        assert_eq!((simulation.number, simulation.bar), (n, Some(n / 12)));
        assert_eq!(of("nbCube"), cubes[column % 4], "column {column}");
        assert_eq!(of("moduleYoung"), 1e6 * (1 + column / 4) as f64, "column {column}");
        for (name, value) in FIXED {
            assert_eq!(of(name), *value, "{name} of column {column}");
        }
    }
    assert_eq!(group.parameters.len(), FIXED.len() + 2);
    let bars: Vec<&str> = group.bars.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(bars, ["BarreSimple2D", "HookeSVT3D"]);
}

/// Every scene of the example is valid, flat and solid bars alike, with a number of cells near the one asked for.
#[test]
fn the_example_gives_valid_scenes() {
    use souple_simulation::scene::parse_with_overrides;
    let group = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/example"));
    for simulation in plan(&group).unwrap() {
        let overrides: Vec<&str> = simulation.overrides.iter().map(String::as_str).collect();
        let catalogue = souple_simulation::prepare::catalogue();
        parse_with_overrides(&group.scene.text, "scene", &overrides, &catalogue)
            .unwrap_or_else(|errors| panic!("{}: {errors}", simulation.number));
    }
}

/// Everything that is wrong with such a folder is said at once, with file and line.
#[test]
fn everything_wrong_is_said_at_once() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/example");
    let problems = parse("bad", "bad", &mut |file| match file {
        "params.csv" => {
            let text = std::fs::read_to_string(example.join(file)).unwrap();
            Ok(text
                .replace("densite         1     800", "densite         1     heavy")
                .replace("nbCube          0     40       200      2", "nbCube,0;40,200,1")
                .replace("pas             1", "step            1")
                .replace("0.9      0        1        852    1", "0.9"))
        }
        "barres.csv" => Ok("Good\nBad\n\nNone\nGood".to_owned()),
        "Barre/Good.csv" => Ok("1.0 Hooke Triangle DecoupageNon".to_owned()),
        "Barre/Bad.csv" => Ok("typePU FPGA\n0.5 Hook Triangle X\n0.4 Hooke Quad X\nwhat".to_owned()),
        other => Err(format!("cannot read {other}")),
    })
    .unwrap_err();
    let text = problems.to_string();
    for said in [
        "bad/params.csv:2: `nbCube`: multiplying 40",
        "bad/params.csv:5: the first value of `densite` must be a number, found `heavy`",
        "bad/params.csv:10: unknown parameter `step`",
        "bad/params.csv:13: expected 7 fields",
        "bad/params.csv: `pas` is missing",
        "bad/barres.csv:5: Good is listed twice",
        "bad/Barre/None.csv: cannot read",
        "bad/Barre/Bad.csv:1: typePU must be CPU or GPU",
        "bad/Barre/Bad.csv:2: unknown law `Hook`; known: Hooke, SaintVenant",
        "bad/Barre/Bad.csv:3: a section must end after 0.5",
        "bad/Barre/Bad.csv:4: expected `typePU CPU`",
        "bad/Barre/Bad.csv: the sections end at 0.5",
    ] {
        assert!(text.contains(said), "{said}\nnot in\n{text}");
    }
}
