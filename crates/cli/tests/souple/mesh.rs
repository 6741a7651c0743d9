//! `souple mesh`.

use crate::command::Place;

/// A bar has the nodes, elements and regions that were asked for, in every format that is written, and each of them is
/// read back as the same mesh.
#[test]
fn a_bar_goes_through_every_format() {
    let place = Place::new("mesh_formats");
    let bar = "mesh bar --size 4,1,1 --cells 4,2,2 --section 0.5:hex8 --section 1.0:prism6";
    for file in ["bar.msh", "bar.vtu", "bar.vtk", "bar.inp", "bar.element"] {
        let made = place.souple(&format!("{bar} --json -o {file}")).ends_with(0).json();
        assert_eq!(made["elements"]["hex8"], 8);
        assert_eq!(made["elements"]["prism6"], 16);
        let found = place.souple(&format!("mesh info {file} --json")).ends_with(0).json();
        assert_eq!(found["nodes"], made["nodes"], "{file}");
        assert_eq!(found["elements"], made["elements"], "{file}");
        assert!((found["measure"].as_f64().unwrap() - 4.0).abs() < 1e-12, "{file}");
        assert_eq!(found["inverted"]["count"], 0, "{file}");
    }
}

/// Faces that do not match are reported, a transition layer removes them.
#[test]
fn transitions_make_a_bar_conform() {
    let place = Place::new("mesh_transition");
    let bar = "mesh bar --size 2,1,1 --cells 4,2,2 --section 0.5:hex8 --section 1:tet4 -o bar.vtu --json";
    let kept = place.souple(bar).ends_with(0);
    assert_eq!(kept.json()["mismatched_faces"], 4);
    assert!(kept.err.contains("a quadrangle meets two triangles"), "{}", kept.err);
    let info = place.souple("mesh info bar.vtu --json").ends_with(0).json();
    assert_eq!((&info["nonconforming_interfaces"], &info["fit"]), (&4.into(), &false.into()));

    let joined = place.souple(&format!("{bar} --transition pyramids")).ends_with(0).json();
    assert_eq!(joined["mismatched_faces"], 0);
    assert!(joined["elements"]["pyramid5"].as_u64().unwrap() > 0);
    let info = place.souple("mesh info bar.vtu --json").ends_with(0).json();
    assert_eq!((&info["nonconforming_interfaces"], &info["fit"]), (&0.into(), &true.into()));
}

/// A cell becomes five or six tetrahedra; prisms stand along the axis that was asked for.
#[test]
fn cells_are_subdivided_as_asked() {
    let place = Place::new("mesh_subdivision");
    for (count, option) in [(6, ""), (5, " --tetrahedra 5")] {
        let words = format!("mesh bar --size 1,1,1 --cells 1,1,1 --section 1:tet4 -o t.vtu --json{option}");
        assert_eq!(place.souple(&words).ends_with(0).json()["elements"]["tet4"], count);
    }
    // Prisms along z show triangles on z_min, where prisms along x show quadrangles.
    for axis in ["x", "z"] {
        let words = format!("mesh bar --size 1,1,1 --cells 1,1,1 --section 1:prism6 --prism-axis {axis} -o {axis}.vtk");
        place.souple(&words).ends_with(0);
    }
    assert_ne!(place.read("x.vtk"), place.read("z.vtk"));
}

/// A configuration file of the bar generator gives the three files of a mixed model under the name that it states.
#[test]
fn configurations_are_read() {
    let place = Place::new("mesh_configuration");
    let lines = [
        "nomRepertoire ./",
        "nomMaillage mixed",
        "longueur 6",
        "largeurSection 1",
        "nbCubeLongueur 12",
        "nbCubeLargeurSection 2",
        "0.5 Hooke Triangle DecoupageNon",
        "1.0 SaintVenant Quad DecoupageNon",
    ];
    place.write("bar.txt", &lines.join("\n"));
    place.souple("mesh bar --config bar.txt").ends_with(0);
    assert!(String::from_utf8(place.read("mixed.info")).unwrap().contains("SaintVenant"));
    let info = place.souple("mesh info mixed.obj --json").ends_with(0).json();
    assert_eq!((&info["elements"]["tri3"], &info["elements"]["quad4"]), (&24.into(), &12.into()));
    assert_eq!(info["regions"]["Hooke"]["elements"], 24);

    place.write("wrong.txt", &lines.join("\n").replace("longueur 6", "longueur six"));
    let error = place.souple("mesh bar --config wrong.txt").ends_with(2).err;
    assert!(error.contains("wrong.txt") && error.contains("line 3"), "{error}");
}

/// Converting keeps the mesh, scales it, and writes text or either kind of wedge where that is asked for.
#[test]
fn conversions_take_options() {
    let place = Place::new("mesh_convert");
    place.souple("mesh bar --size 8,1,1 --cells 4,1,1 --section 1:prism6 -o bar.vtu").ends_with(0);
    place.souple("mesh convert bar.vtu small.msh --scale 0.001 --ascii").ends_with(0);
    let text = String::from_utf8(place.read("small.msh")).expect("text was asked for");
    assert!(text.starts_with("$MeshFormat"));
    let info = place.souple("mesh info small.msh --json").ends_with(0).json();
    assert!((info["bounds"]["max"][0].as_f64().unwrap() - 0.008).abs() < 1e-15);
    place.souple("mesh convert bar.vtu plain.vtk").ends_with(0);
    place.souple("mesh convert bar.vtu lagrange.vtk --vtk-wedge lagrange").ends_with(0);
    assert!(String::from_utf8(place.read("lagrange.vtk")).unwrap().contains("\n73\n"));
    assert!(!String::from_utf8(place.read("plain.vtk")).unwrap().contains("\n73\n"));
}

/// What cannot be read or generated ends with exit code 2, what cannot be written with 4, and a sentence names the file or
/// the option.
#[test]
fn mistakes_are_named() {
    let place = Place::new("mesh_mistakes");
    place.souple("mesh bar --size 1,1,1 --cells 1,1,1 --section 1:hex8 -o bar.msh").ends_with(0);
    let bytes = place.read("bar.msh");
    std::fs::write(place.path("cut.msh"), &bytes[..bytes.len() / 2]).unwrap();
    let bar = "mesh bar --cells 2,1,1 -o b.vtu";
    for (words, said) in [
        ("mesh info missing.msh".to_owned(), "missing.msh"),
        ("mesh info cut.msh".to_owned(), "cut.msh"),
        ("mesh convert bar.msh bar.stl".to_owned(), ".vtu"),
        ("mesh convert bar.msh bar.vtu --scale 0".to_owned(), "--scale"),
        (format!("{bar} --size 1,1 --section 1:hex8"), "--size"),
        (format!("{bar} --size 1,1,1 --section 1:hexa8"), "did you mean `hex8`?"),
        (format!("{bar} --size 1,1,1 --section 0.5:hex8"), "expected 1"),
        (format!("{bar} --size 1,1,1 --section hex8"), "UNTIL:ELEMENT"),
        (format!("{bar} --size 0,1,1 --section 1:hex8"), "size[0]"),
    ] {
        let error = place.souple(&words).ends_with(2).err;
        assert!(error.contains(said), "{words}: {error}");
    }
    let error = place.souple("mesh convert bar.msh bar.msh/x.vtu").ends_with(4).err;
    assert!(error.contains("bar.msh"), "{error}");
}
