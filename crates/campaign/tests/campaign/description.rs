//! `campaign.toml`.

use souple_campaign::description::parse;
use souple_campaign::group::Group;
use souple_campaign::plan::plan;
use souple_campaign::problem::Problems;
use std::path::Path;

const SCENE: &str = r#"
[time]
step = 0.01
end = 0.1
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [1, 0.1, 0.1], cells = [4, 1, 1], sections = [{ until = 1.0, element = "hex8" }] }
[[body.material]]
law = "hooke"
young = "1 MPa"
poisson = 0.25
"#;

fn read(text: &str) -> Result<Group, Problems> {
    parse(text, "campaign.toml", Path::new("somewhere"), &mut |path| match path.file_name() {
        Some(name) if name == "bar.toml" => Ok(SCENE.to_owned()),
        _ => Err(format!("cannot read {}", path.display())),
    })
}

const FULL: &str = r#"
name = "full"
scene = "bar.toml"
devices = ["cpu", "interpreter"]
[[vary]]
key = "material.*.young"
values = ["1 MPa", 2e6]
[[vary]]
key = "body.0.mesh.cells.0"
from = 4
to = 16
factor = 2
[[vary]]
key = "body.0.density"
low = 900
high = 1100
[[vary]]
key = "time.step"
low = 0.001
high = 0.01
[hypercube]
samples = 5
seed = 7
[[bar]]
name = "mixed"
sections = [
  { until = 0.5, law = "hooke", element = "hex8", quadrature = 1 },
  { until = 1.0, law = "stvk", element = "tet4", poisson = 0.3 },
]
[[bar]]
name = "plain"
sections = [{ until = 1.0, law = "stvk", element = "hex8" }]
"#;

/// Lists, ranges, samples, devices and bars are crossed; every simulation is a valid scene unlike all others.
#[test]
fn everything_is_crossed() {
    use souple_simulation::prepare::catalogue;
    use souple_simulation::scene::{canonical_json, parse_with_overrides};
    let group = read(FULL).unwrap_or_else(|problems| panic!("{problems}"));
    let simulations = plan(&group).unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(simulations.len(), 2 * 3 * 5 * 2 * 2);
    let mut seen = std::collections::BTreeSet::new();
    for simulation in &simulations {
        let overrides: Vec<&str> = simulation.overrides.iter().map(String::as_str).collect();
        let (scene, _) = parse_with_overrides(SCENE, "bar.toml", &overrides, &catalogue())
            .unwrap_or_else(|errors| panic!("{}: {errors}", simulation.number));
        seen.insert((simulation.device.clone(), canonical_json(&scene)));
        let laws: Vec<&str> = scene.bodies[0].value.materials.iter().map(|m| m.law.value.as_str()).collect();
        assert_eq!(laws.len(), group.bars[simulation.bar.unwrap()].sections.len());
    }
    assert_eq!(seen.len(), simulations.len());
    assert_eq!(plan(&read(FULL).unwrap()).unwrap(), simulations, "the same samples every time");
}

/// Everything that is wrong is said at once, with its line, what was expected and what to do.
#[test]
fn everything_wrong_is_said_at_once() {
    let text = r#"nam = "x"
name = 5
scene = "none.toml"
devices = []
[[vary]]
key = "a"
values = []
[[vary]]
values = [1]
[[vary]]
key = "b"
from = 1
to = 2
[[vary]]
key = "c"
low = 1
high = 2
[[vary]]
key = "d"
from = 1
to = inf
step = 1
[hypercube]
sampels = 3
[[bar]]
name = "x"
sections = [{ until = 0.5, law = "hook", element = "hex" }]
"#;
    let problems = read(text).unwrap_err().to_string();
    for said in [
        "campaign.toml:1: unknown key `nam` in the campaign",
        "campaign.toml:2: `name` must be a text in quotes, found 5",
        "campaign.toml:3: cannot read",
        "campaign.toml:4: `devices` must be a list of texts",
        "campaign.toml:7: `values` must be a list with at least one value, found []",
        "campaign.toml:8: [[vary]] needs `key`",
        "campaign.toml:10: [[vary]] needs either",
        "campaign.toml:14: `low` and `high` need [hypercube]",
        "campaign.toml:21: `to` must be a finite number, found inf",
        "campaign.toml:23: [hypercube] needs `samples`",
        "campaign.toml:24: unknown key `sampels`",
        "campaign.toml:27: `until` must increase up to 1.0",
        "unknown law `hook`",
        "unknown element `hex`",
    ] {
        assert!(problems.contains(said), "{said}\nnot in\n{problems}");
    }
    assert!(read("name = ").unwrap_err().to_string().contains("campaign.toml:1: not valid TOML"));
}

/// A bar does not fit into a scene whose body is not a bar of sections, and a group has an upper size.
#[test]
fn what_does_not_fit_is_refused() {
    let bar =
        "scene = \"bar.toml\"\n[[bar]]\nname = \"b\"\nsections = [{until = 1.0, law = \"stvk\", element = \"tet4\"}]";
    let mut group = read(bar).unwrap();
    group.scene.text = SCENE.replace("sections = [{ until = 1.0, element = \"hex8\" }]", "element = \"hex8\"");
    assert!(plan(&group).unwrap_err().to_string().contains("sections = [{ until"));
    let vary = |n: usize| format!("[[vary]]\nkey = \"k{n}\"\nfrom = 1\nto = 9999\nstep = 1\n");
    let group = read(&format!("scene = \"bar.toml\"\n{}{}", vary(0), vary(1))).unwrap();
    assert!(plan(&group).unwrap_err().to_string().contains("more than 1000000 simulations"));
}

/// The changes of a case go together, are crossed with what varies, and their names are the values of `case`.
#[test]
fn cases_change_what_belongs_together() {
    let text = r#"
name = "cases"
scene = "bar.toml"
[[case]]
name = "coarse"
set = { "body.0.mesh.cells" = [2, 1, 1], "time.end" = 0.2 }
[[case]]
name = "refused"
set = { "body.0.density" = -1 }
ends = "invalid"
[[vary]]
key = "time.step"
values = [0.01, 0.02]
"#;
    let group = read(text).unwrap_or_else(|problems| panic!("{problems}"));
    let simulations = plan(&group).unwrap_or_else(|problems| panic!("{problems}"));
    let changes: Vec<Vec<&str>> =
        simulations.iter().map(|s| s.overrides.iter().map(String::as_str).collect()).collect();
    let coarse = ["body.0.mesh.cells=[2, 1, 1]", "time.end=0.2"];
    assert_eq!(
        changes,
        [
            vec![coarse[0], coarse[1], "time.step=0.01"],
            vec!["body.0.density=-1", "time.step=0.01"],
            vec![coarse[0], coarse[1], "time.step=0.02"],
            vec!["body.0.density=-1", "time.step=0.02"],
        ]
    );
    assert_eq!(simulations[1].values[0].to_string(), "\"refused\"");
    let wrong = text.replace("ends = \"invalid\"", "ends = \"well\"").replace("\"refused\"", "\"coarse\"");
    let problems = read(&wrong.replace("time.step", "case")).unwrap_err().to_string();
    for part in ["campaign.toml:7: `ends` must be", "already a case named", "`case` is no key of a scene"] {
        assert!(problems.contains(part), "{part} is missing in\n{problems}");
    }
}
