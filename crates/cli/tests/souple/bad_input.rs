//! What a person gets wrong, and what the command says: exit code 2, the place, what was expected. Nothing panics, and
//! nothing is computed.

use crate::command::Place;

/// A scene that is right; each test spoils one thing.
pub(crate) const SCENE: &str = r#"title = "Small bar"
gravity = [0.0, -9.81, 0.0]
[time]
step = 0.02
end = 0.2
[[body]]
name = "bar"
density = 1000.0
[body.mesh]
generator = "bar"
size = [1.0, 0.2, 0.2]
cells = [4, 1, 1]
sections = [{ until = 0.5, element = "hex8" }, { until = 1.0, element = "tet4" }]
transition = "pyramids"
[[body.material]]
law = "stvk"
young = 1e5
poisson = 0.3
[[body.fix]]
region = "x_min"
[[probe]]
name = "tip"
region = "x_max"
quantity = "mean displacement"
[output]
every = 0.1
"#;

/// The scene with a mesh file in place of the generator.
fn with_file(file: &str) -> String {
    let start = SCENE.find("generator").unwrap();
    let end = SCENE.find("[[body.material]]").unwrap();
    format!("{}file = \"{file}\"\n{}", &SCENE[..start], &SCENE[end..])
}

/// A hexahedron in text, with the coordinates of one node to be spoilt.
fn hexahedron(last: &str) -> String {
    format!(
        "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,{last}\n\
         *ELEMENT, TYPE=C3D8, ELSET=x_max\n1,1,2,3,4,5,6,7,8\n*NSET, NSET=x_min\n1,4,5\n"
    )
}

/// Every spoilt value of a scene is reported with file, line and the way out, by `check` and by `run` alike.
#[test]
fn scenes_are_refused_with_their_line() {
    let place = Place::new("bad_scenes");
    for (right, wrong, said) in [
        ("law = \"stvk\"", "law = \"stkv\"", vec!["bad.toml:16", "did you mean `stvk`?"]),
        ("poisson = 0.3", "poisson = 0.5", vec!["bad.toml:18", "less than 0.5", "incompressible"]),
        ("poisson = 0.3", "poison = 0.3", vec!["bad.toml:18", "did you mean `poisson`?"]),
        ("young = 1e5", "young = -1e5", vec!["bad.toml:17", "greater than 0"]),
        ("region = \"x_min\"", "region = \"x_mni\"", vec!["bad.toml:20", "did you mean \"x_min\"?"]),
        (
            "region = \"x_min\"",
            "region = { box = { min = [5, 5, 5], max = [6, 6, 6] } }",
            vec!["bad.toml:20", "selects nothing"],
        ),
        ("end = 0.2", "ned = 0.2", vec!["bad.toml:5", "did you mean `end`?"]),
        ("element = \"hex8\"", "element = \"hexa8\"", vec!["bad.toml:13", "did you mean `hex8`?"]),
        ("step = 0.02", "step = 0.02 = 3", vec!["bad.toml:4", "TOML"]),
        ("step = 0.02", "step = \"fast\"", vec!["bad.toml:4", "step"]),
    ] {
        assert!(SCENE.contains(right), "{right}");
        place.write("bad.toml", &SCENE.replacen(right, wrong, 1));
        for command in ["check", "run"] {
            let error = place.souple(&format!("{command} bad.toml")).ends_with(2).err;
            for part in &said {
                assert!(error.contains(part), "{wrong}: {error}");
            }
        }
    }
    assert!(!place.path("out").exists(), "a refused scene leaves no folder");
}

/// All mistakes are reported at once.
#[test]
fn mistakes_are_reported_together() {
    let place = Place::new("bad_together");
    place.write("bad.toml", &SCENE.replace("stvk", "stkv").replace("end =", "ned ="));
    let error = place.souple("check bad.toml").ends_with(2).err;
    assert!(error.contains("bad.toml:5") && error.contains("bad.toml:16"), "{error}");
}

/// A mesh file that cannot be computed with is refused, with the file or the element and what is wrong.
#[test]
fn meshes_are_refused() {
    let place = Place::new("bad_meshes");
    place.write("scene.toml", &with_file("mesh.inp"));
    let whole = hexahedron("0,1,1");
    let truncated = &whole[..whole.find("7,8\n").unwrap()];
    for (mesh, said) in [
        (hexahedron("nan,1,1"), vec!["mesh.inp", "finite"]),
        (hexahedron("0.9,0.1,0.1"), vec!["hex8", "inverted"]),
        (truncated.to_owned(), vec!["mesh.inp"]),
        (whole.replace("1,1,2,3,4,5,6,7,8", "1,1,2,3,4,5,6,7,88"), vec!["88"]),
    ] {
        place.write("mesh.inp", &mesh);
        let error = place.souple("check scene.toml").ends_with(2).err;
        for part in said {
            assert!(error.contains(part), "{mesh}: {error}");
        }
    }
    std::fs::remove_file(place.path("mesh.inp")).unwrap();
    let error = place.souple("run scene.toml").ends_with(2).err;
    assert!(error.contains("mesh.inp") && error.contains("scene.toml:"), "{error}");
}

/// A node of no element is warned of and the scene runs without it.
#[test]
fn unreferenced_nodes_are_warned_of() {
    let place = Place::new("bad_nodes");
    place.write("scene.toml", &with_file("mesh.inp"));
    place.write("mesh.inp", &hexahedron("0,1,1").replace("*ELEMENT", "9,5,5,5\n*ELEMENT"));
    let answer = place.souple("check scene.toml --json").ends_with(0).json();
    assert_eq!(answer["nodes"], 8);
    let warnings = answer["warnings"].to_string();
    assert!(warnings.contains("belong to no element"), "{warnings}");
}

/// Options are checked like scenes: device, overrides, a folder that cannot be made, a missing checkpoint.
#[test]
fn options_are_refused() {
    let place = Place::new("bad_options");
    place.write("scene.toml", SCENE);
    place.write("taken", "a file where a folder should be");
    for (words, said) in [
        ("run scene.toml --device abacus", "abacus"),
        ("run scene.toml --set time.ned=1", "did you mean `end`?"),
        ("run scene.toml --set time.end", "time.end"),
        ("run scene.toml --out taken/here", "taken"),
        ("run scene.toml --resume", "--checkpoint-every"),
        ("run scene.toml --checkpoint-every 0", "positive"),
        ("run missing.toml", "missing.toml"),
        ("check missing.toml", "missing.toml"),
        ("runn scene.toml", "run"),
    ] {
        let error = place.souple(words).ends_with(2).err;
        assert!(error.contains(said), "{words}: {error}");
    }
    std::fs::create_dir_all(place.path("out/scene")).unwrap();
    place.write("out/scene/checkpoint.bin", "not one");
    let error = place.souple("run scene.toml --resume").ends_with(2).err;
    assert!(error.contains("checkpoint.bin"), "{error}");
}
