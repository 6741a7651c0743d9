//! Properties of every key of the schema, whatever keys there are.

use souple_scene::schema::{Kind, Presence, Section};
use souple_scene::{Scene, SceneErrors, parse_with_overrides, schema};

use crate::catalogue::{SHORT, catalogue};

/// One scene with an entry in every table, in variants where keys exclude each other.
fn full_scenes() -> [String; 3] {
    let full = format!(
        r#"{SHORT}
viscosity = {{ prony = [{{ fraction = 0.5, time = 1 }}] }}
[body.quadrature]
hex8 = 8
[[body.region]]
name = "r"
region = "x_min"
[[body.fix]]
region = "r"
[[body.move]]
region = "x_max"
translation = {{ keys = [[0, [0, 0, 0]]] }}
[[body.move]]
region = "x_max"
rotation = {{ axis = [1, 0, 0], keys = [[0, 0]] }}
[[body.force]]
region = "x_max"
total = [1, 0, 0]
[[body.traction]]
region = "x_max"
traction = [1, 0, 0]
[[body.pressure]]
region = "x_max"
pressure = 1
[[tie]]
body = "bar"
region = "x_min"
to_body = "bar"
to_region = "x_max"
within = 1
[[probe]]
name = "p"
quantity = "volume"
[output]
[integrator]
[integrator.rayleigh]
[integrator.newmark]
[linear_solver]
[time.stop]
mean_kinetic_energy = 1
[[expect]]
probe = "p"
value = 1
tolerance = 1
"#
    );
    let file = full.replace(
        "{ generator = \"bar\", size = [1, 1, 1], cells = [2, 2, 2], element = \"hex8\" }",
        "{ file = \"a\" }",
    );
    let swapped = "[[body.move]]\nregion = \"x_max\"\nrotation = { axis = [1, 0, 0], keys = [[0, 0]] }\n";
    let file = file.replacen("[[body.move]]", &format!("{swapped}[[body.move]]"), 1);
    let sections = "sections = [{ until = 1.0, element = \"hex8\" }]";
    let bar = full.replace("element = \"hex8\" }\n[[body.material]]", &format!("{sections} }}\n[[body.material]]"));
    [full, bar, file]
}

/// The dotted path of a table: `[[body.fix]]` is `body.0.fix.0`.
fn path(section: &Section) -> String {
    let lists = [
        "body", "material", "region", "fix", "move", "force", "traction", "pressure", "tie", "probe", "expect",
        "prony", "sections",
    ];
    let name = section.header.trim_matches(['[', ']']);
    if name == "the scene" {
        return String::new();
    }
    let parts: Vec<String> = name
        .split('.')
        .map(|part| if lists.contains(&part) { format!("{part}.0.") } else { format!("{part}.") })
        .collect();
    parts.concat()
}

fn parse(text: &str, set: &str) -> Result<Scene, SceneErrors> {
    parse_with_overrides(text, "scene.toml", &[set], &catalogue()).map(|(scene, _)| scene)
}

#[test]
fn every_default_in_the_reference_is_what_leaving_the_key_out_gives() {
    let mut checked = 0;
    for section in schema() {
        for key in section.keys {
            let Presence::Default(value) = key.presence else { continue };
            let set = format!("{}{}={value}", path(section), key.name);
            let results: Vec<_> = full_scenes()
                .iter()
                .filter_map(|text| {
                    let without =
                        souple_scene::parse(text, "scene.toml", &catalogue()).unwrap_or_else(|e| panic!("{e}"));
                    Some((without.0, parse(text, &set).ok()?))
                })
                .collect();
            assert!(!results.is_empty(), "{set} is refused: {:?}", full_scenes().map(|text| parse(&text, &set).err()));
            for (without, with) in results {
                assert_eq!(without, with, "{set}");
            }
            checked += 1;
        }
    }
    assert!(checked > 25, "{checked}");
}

#[test]
fn every_key_refuses_a_value_of_another_type_at_its_place() {
    for section in schema() {
        let path = path(section);
        for key in section.keys {
            let set = format!("{path}{}=2001-02-03", key.name);
            // A scene in which the key has a meaning at all.
            let refusals: Vec<String> = full_scenes()
                .iter()
                .filter_map(|text| parse(text, &set).err())
                .map(|errors| errors.to_string())
                .collect();
            assert_eq!(refusals.len(), 3, "{set}");
            assert!(
                refusals.iter().any(|text| text.contains("found the date or time 2001-02-03")),
                "{set}: {refusals:#?}"
            );
            assert!(
                refusals.iter().any(|text| text.lines().any(|line| line.starts_with(&format!("--set {set}: ")))),
                "{refusals:#?}"
            );
        }
    }
}

#[test]
fn every_number_refuses_infinity_and_every_number_with_a_unit_refuses_another_dimension() {
    let mut checked = 0;
    for section in schema() {
        for key in section.keys {
            let (infinite, other) = match key.kind {
                Kind::Number(dimension, _) => ("inf", if dimension.name == "time" { "1 kg" } else { "1 s" }),
                Kind::Vector(dimension, _) => {
                    ("[1, inf, 1]", if dimension.name == "time" { "[1, 1, \"1 kg\"]" } else { "[1, 1, \"1 s\"]" })
                }
                _ => continue,
            };
            for (value, part) in [(infinite, "must be a finite number, found inf"), (other, "expected a")] {
                let set = format!("{}{}={value}", path(section), key.name);
                let found: Vec<String> = full_scenes()
                    .iter()
                    .filter_map(|text| parse(text, &set).err())
                    .map(|errors| errors.to_string())
                    .collect();
                assert!(found.iter().any(|text| text.contains(part)), "{set}: {found:?}");
                checked += 1;
            }
        }
    }
    assert!(checked > 50, "{checked}");
}

#[test]
fn sections_and_keys_have_names_of_their_own_and_say_what_they_are() {
    let mut headers = Vec::new();
    for section in schema() {
        assert!(!headers.contains(&section.header), "{}", section.header);
        headers.push(section.header);
        assert!(!section.about.is_empty());
        for (index, key) in section.keys.iter().enumerate() {
            assert!(
                section.keys[..index].iter().all(|other| other.name != key.name),
                "{} {}",
                section.header,
                key.name
            );
            assert!(!key.about.is_empty(), "{} {}", section.header, key.name);
            assert!(key.name.chars().all(|c| c.is_ascii_lowercase() || c == '_'), "{}", key.name);
        }
    }
}
