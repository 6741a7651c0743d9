//! Scenes of the kind that people write, right and wrong: what they become, and what they are told.

use super::*;

const HEAD: &str = "[time]\nstep = 0.01\nend = 1.0\n";

/// A bar of 4 × 2 × 2 cubes of edge 0.5 m; `[[body.material]]` stands on line 8.
const BODY: &str = r#"[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [2, 1, 1], cells = [4, 2, 2], element = "hex8" }
"#;
const STVK: &str = "[[body.material]]\nlaw = \"stvk\"\nyoung = 1e6\npoisson = 0.25\n";

fn no_files(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("no file {name} in this test"))
}

fn prepared_with(
    text: &str,
    read: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<(Prepared, Vec<String>), PrepareError> {
    let (scene, _) = souple_scene::parse(text, "scene.toml", &catalogue()).expect("the scene itself is well written");
    prepare(&scene, "scene.toml", read)
}

fn prepared(text: &str) -> (Prepared, Vec<String>) {
    prepared_with(text, &mut no_files).expect("nothing is wrong with this scene")
}

/// The message for a scene with one problem.
fn refused(text: &str) -> String {
    let error = prepared_with(text, &mut no_files).expect_err("something is wrong with this scene");
    assert_eq!(error.problems.len(), 1, "{error}");
    error.to_string()
}

/// The line (from 1) on which a text first stands.
fn line_of(scene: &str, text: &str) -> usize {
    scene.lines().position(|line| line.contains(text)).expect("the text is in the scene") + 1
}

fn assert_says(message: &str, scene: &str, line: &str, parts: &[&str]) {
    let start = format!("scene.toml:{}:", line_of(scene, line));
    assert!(message.starts_with(&start), "{message} should start with {start}");
    for part in parts {
        assert!(message.contains(part), "{message} should contain {part}");
    }
}

/// Gmsh 2.2 text of these nodes and elements (type number, one-based nodes).
fn msh(nodes: &[[f64; 3]], elements: &[(u32, &[u32])]) -> Vec<u8> {
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", nodes.len());
    for (at, [x, y, z]) in nodes.iter().enumerate() {
        text.push_str(&format!("{} {x} {y} {z}\n", at + 1));
    }
    text.push_str(&format!("$EndNodes\n$Elements\n{}\n", elements.len()));
    for (at, (kind, nodes)) in elements.iter().enumerate() {
        let nodes: Vec<String> = nodes.iter().map(u32::to_string).collect();
        text.push_str(&format!("{} {kind} 2 1 1 {}\n", at + 1, nodes.join(" ")));
    }
    text.push_str("$EndElements\n");
    text.into_bytes()
}

const CORNERS: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn file_scene() -> String {
    format!("{HEAD}[[body]]\nname = \"lump\"\ndensity = 1.0\nmesh = {{ file = \"lump.msh\" }}\n{STVK}")
}

fn with_file(bytes: Vec<u8>) -> Result<(Prepared, Vec<String>), PrepareError> {
    prepared_with(&file_scene(), &mut |name| {
        assert_eq!(name, "lump.msh");
        Ok(bytes.clone())
    })
}

/// The mixed bar becomes one block per element and law, in the order of the sections; the prisms follow Hooke's law.
#[test]
fn the_mixed_bar_becomes_its_four_blocks() {
    let text = r#"
[time]
step = 0.01
end = 10.0
[[body]]
name = "bar"
density = 1000.0
[body.mesh]
generator = "bar"
size = [8.0, 1.0, 1.0]
cells = [24, 4, 4]
sections = [
  { until = 0.25, element = "prism6" },
  { until = 0.50, element = "pyramid5" },
  { until = 0.75, element = "hex8" },
  { until = 1.00, element = "tet4" },
]
[[body.material]]
region = "all"
law = "stvk"
young = 1e8
poisson = 0.0
[[body.material]]
region = { element = "prism6" }
law = "hooke"
young = 1e8
poisson = 0.0
[[body.fix]]
region = "x_min"
[[probe]]
name = "tip"
region = "x_max"
quantity = "mean displacement"
"#;
    let (model, warnings) = prepared(text);
    let found: Vec<_> = model.blocks.iter().map(|b| (b.element.id, b.law.id, b.len())).collect();
    let cells = 6 * 4 * 4;
    let expected = [
        ("prism6", "hooke", 2 * cells),
        ("pyramid5", "stvk", 6 * cells),
        ("hex8", "stvk", cells),
        ("tet4", "stvk", 6 * cells),
    ];
    assert_eq!(found, expected);
    let ids: Vec<u32> = model.blocks.iter().flat_map(|b| b.ids.clone()).collect();
    assert_eq!(ids, (0..ids.len() as u32).collect::<Vec<_>>(), "elements are numbered in the order of the mesh");
    for block in &model.blocks {
        assert_eq!(block.rule.id, block.element.default_rule().id);
        assert_eq!(block.connectivity.len(), block.len() * block.element.node_count());
        assert_eq!((block.parameters.as_slice(), block.density), ([1e8, 0.0].as_slice(), 1000.0));
    }
    assert_eq!(model.dimension, 3);
    assert_eq!(model.fixed.len(), 1);
    assert_eq!((model.fixed[0].0.len(), model.fixed[0].1), (25, [true; 3]));
    assert_eq!(model.probes[0].nodes.len(), 25);
    assert!(model.probes[0].nodes.iter().all(|&n| model.nodes[n as usize][0] == 8.0));

    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert_says(&warnings[0], text, "pyramid5", &["warning", "16 faces", "transition = \"pyramids\""]);
    assert_says(&warnings[1], text, "tet4", &["16 faces", "a quadrangle meets two triangles"]);

    let inserted = text.replace("cells = [24", "transition = \"pyramids\"\ncells = [24");
    assert_eq!(prepared(&inserted).1, Vec::<String>::new());
}

/// Later materials override earlier ones on their region; elements of equal material share a block across bodies.
#[test]
fn later_materials_override_and_equal_ones_share_a_block() {
    let soft = "[[body.material]]\nregion = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\nlaw = \"stvk\"\nyoung = 5e5\npoisson = 0.25\n";
    let second = BODY.replace("\"bar\"\nd", "\"rod\"\nd");
    let (model, warnings) = prepared(&format!("{HEAD}{BODY}{STVK}{soft}{second}{STVK}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    let found: Vec<_> = model.blocks.iter().map(|b| (b.parameters.clone(), b.len())).collect();
    assert_eq!(found, [(vec![5e5, 0.25], 8), (vec![1e6, 0.25], 8 + 16)]);
    let centre = |b: &BlockSpec, e: usize| -> f64 {
        b.connectivity[8 * e..8 * (e + 1)].iter().map(|&n| model.nodes[n as usize][0]).sum::<f64>() / 8.0
    };
    assert!((0..8).all(|e| centre(&model.blocks[0], e) < 1.0));
    assert!((0..8).all(|e| centre(&model.blocks[1], e) > 1.0));
    assert_eq!(model.bodies[1].first_node, 45);
    assert_eq!(model.bodies[1].first_element, 16);
    assert!(model.blocks[1].connectivity[8 * 8..].iter().all(|&n| (45..90).contains(&n)));

    let warnings = prepared(&format!("{HEAD}{BODY}{soft}{STVK}")).1;
    assert!(warnings[0].contains("applies to no element"), "{warnings:?}");
}

/// A scene's quadrature replaces the element's default; for elements that the body lacks it is said to do nothing.
#[test]
fn the_scene_chooses_the_quadrature() {
    let default = prepared(&format!("{HEAD}{BODY}{STVK}")).0.blocks[0].rule.id;
    let hex8 = souple_elements::by_id("hex8").expect("hex8 is registered");
    let other = hex8.quadratures.iter().find(|id| **id != default).expect("hex8 has several rules");
    let (model, warnings) = prepared(&format!("{HEAD}{BODY}quadrature = {{ hex8 = \"{other}\", tet4 = 1 }}\n{STVK}"));
    assert_eq!(model.blocks[0].rule.id, *other);
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("has no tet4"), "{warnings:?}");
}

/// The three pairs of elastic constants describe the same material; constants that no law takes are refused.
#[test]
fn isotropic_pairs_agree_and_are_checked_after_conversion() {
    let parameters = |constants: &str| {
        let text = format!("{HEAD}{BODY}[[body.material]]\nlaw = \"stvk\"\n{constants}\n");
        prepared(&text).0.blocks[0].parameters.clone()
    };
    assert_eq!(parameters("young = 1e6\npoisson = 0.25"), [1e6, 0.25]);
    for pair in ["lambda = 4e5\nmu = 4e5", "bulk = 666666.6666666666\nmu = 4e5"] {
        let [young, poisson] = parameters(pair)[..] else { panic!("two constants") };
        assert!((young / 1e6 - 1.0).abs() < 1e-14 && (poisson / 0.25 - 1.0).abs() < 1e-14, "{pair}: {young} {poisson}");
    }
    let text = format!("{HEAD}{BODY}[[body.material]]\nlaw = \"stvk\"\nlambda = 1e25\nmu = 1.0\n");
    assert_says(
        &refused(&text),
        &text,
        "lambda = 1e25",
        &["`poisson` must be greater than -1 and less than 0.5, found 0.5 from `lambda` and `mu`"],
    );
}

/// Elements without material are counted, named by kind and located.
#[test]
fn elements_without_material_are_an_error() {
    let text = format!("{HEAD}{BODY}{STVK}")
        .replace("law = \"stvk\"", "region = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\nlaw = \"stvk\"");
    let parts = ["8 of 16 elements of body \"bar\" have no material (8 hex8, within [1, 0, 0] to [2, 1, 1])"];
    assert_says(&refused(&text), &text, "name = \"bar\"", &parts);
}

/// A region that selects nothing is reported at its place, with the nearest name, the box of the mesh and its names.
#[test]
fn a_region_that_selects_nothing_is_an_error() {
    let text = format!("{HEAD}{BODY}{STVK}[[body.fix]]\nregion = \"x_mx\"\n");
    let message = refused(&text);
    assert!(message.starts_with("scene.toml:13:10: region \"x_mx\" selects nothing"), "{message}");
    let parts = ["did you mean \"x_max\"?", "[0, 0, 0] to [2, 1, 1]", "\"section_0\", \"x_max\", \"x_min\""];
    assert_says(&message, &text, "x_mx", &parts);

    for region in ["{ box = { min = [5, 0, 0], max = [6, 1, 1] } }", "{ not = \"all\" }", "{ element = \"tet4\" }"] {
        let text = format!("{HEAD}{BODY}{STVK}[[body.fix]]\nregion = {region}\n");
        assert_says(&refused(&text), &text, "region =", &["selects nothing", "\"bar\""]);
    }
    let text = format!("{HEAD}{BODY}{STVK}[[probe]]\nname = \"tip\"\nregion = \"tip\"\nquantity = \"reaction\"\n");
    assert_says(&refused(&text), &text, "region = \"tip\"", &["probe \"tip\"", "selects nothing"]);
    let text = format!("{HEAD}{BODY}{STVK}[[probe]]\nname = \"v\"\nregion = \"x_max\"\nquantity = \"volume\"\n");
    assert_says(&refused(&text), &text, "region = \"x_max\"", &["no element that deforms"]);
}

/// A region of the body hides one of the mesh with its name, and may refer to others.
#[test]
fn regions_of_the_scene_come_before_those_of_the_mesh() {
    let regions = "region = [{ name = \"x_max\", region = \"end\" }, { name = \"end\", region = \"x_min\" }]\n";
    let fix = "[[body.fix]]\nregion = \"x_max\"\naxes = [\"y\"]\n";
    let (model, _) = prepared(&format!("{HEAD}{BODY}{regions}{STVK}{fix}"));
    let (nodes, axes) = &model.fixed[0];
    assert_eq!((nodes.len(), *axes), (9, [false, true, false]));
    assert!(nodes.iter().all(|&n| model.nodes[n as usize][0] == 0.0));
}

/// A probe without body looks at every body that has its region.
#[test]
fn a_probe_covers_every_body_that_has_its_region() {
    let second = BODY.replace("\"bar\"\nd", "\"rod\"\nd");
    let regions = "region = [{ name = \"mine\", region = \"x_max\" }]\n";
    let probe = "[[probe]]\nname = \"p\"\nregion = \"mine\"\nquantity = \"reaction\"\n";
    let all = "[[probe]]\nname = \"q\"\nquantity = \"volume\"\n";
    let (model, _) = prepared(&format!("{HEAD}{BODY}{STVK}{second}{regions}{STVK}{probe}{all}"));
    assert_eq!(model.probes[0].nodes.len(), 9);
    assert!(model.probes[0].nodes.iter().all(|&n| n >= 45));
    assert_eq!(model.probes[1].elements, (0..32).collect::<Vec<_>>());
    assert_eq!(model.velocities.len(), 90);
}

/// A law written in the scene that has stress at rest, is not stable there or cannot be read is refused at its line.
#[test]
fn bad_user_laws_are_refused() {
    for (energy, part) in [
        ("mu/2*(I1 - 3) + mu*J", "stress"),
        ("-mu/2*(I1 - 3) + mu*ln(J)", "stable"),
        ("mu/2*(I1 - ) + J", "expected"),
        ("mu/2*(I1bat - 3)", "I1bar"),
    ] {
        let text = format!("{HEAD}{BODY}[[body.material]]\nenergy = \"{energy}\"\nmu = 1e5\n");
        let fault = souple_scene::parse(&text, "scene.toml", &catalogue()).expect_err(energy).to_string();
        assert!(fault.contains("scene.toml:") && fault.contains(part), "{energy}: {fault}");
    }
}

/// What the engine cannot do is refused where it is written, all at once.
#[test]
fn what_is_not_supported_is_refused() {
    let text = format!(
        r#"{HEAD}{BODY}{STVK}[[body.material.viscosity.prony]]
fraction = 0.5
time = 0.1
[[body.pressure]]
region = "x_max"
pressure = 1e3
"#
    );
    let error = prepared_with(&text, &mut no_files).expect_err("two things are not supported");
    let lines: Vec<String> = error.to_string().lines().map(str::to_owned).collect();
    assert_eq!(lines.len(), 2, "{error}");
    let places = ["[[body.material.viscosity.prony]]", "[[body.pressure]]"];
    for (line, place) in lines.iter().zip(places) {
        assert_says(line, &text, place, &["not supported yet"]);
    }
}

/// A traction's nodal forces sum to traction times area whatever the element, and a uniform one is shared as the
/// shape functions say.
#[test]
fn a_traction_sums_to_traction_times_area() {
    for element in souple_elements::all().iter().filter(|e| e.dimension() == 3) {
        let text = format!("{HEAD}{BODY}{STVK}[[body.traction]]\nregion = \"x_max\"\ntraction = [1.5, -3, 2]\n");
        let (model, _) = prepared(&text.replace("hex8", element.id));
        let load = &model.loads[0];
        for axis in 0..3 {
            let total: f64 = load.forces.iter().map(|(_, f)| f[axis]).sum();
            assert!((total - [1.5, -3.0, 2.0][axis]).abs() < 1e-12, "{}: {total}", element.id);
        }
        assert!(load.forces.iter().all(|(n, _)| model.nodes[*n as usize][0] == 2.0), "{}", element.id);
        if element.id == "hex8" {
            let share = |at: [f64; 3]| {
                let found = load.forces.iter().find(|(n, _)| model.nodes[*n as usize] == at);
                found.expect("the node is loaded").1[0] / 1.5
            };
            assert!((share([2.0, 0.5, 0.5]) - 0.25).abs() < 1e-14);
            assert!((share([2.0, 0.0, 0.5]) - 0.125).abs() < 1e-14);
            assert!((share([2.0, 1.0, 1.0]) - 0.0625).abs() < 1e-14);
        }
    }
}

/// On a plane body a traction acts on edges one metre deep; loads out of the plane are refused.
#[test]
fn a_plane_body_is_loaded_on_its_edges_and_in_its_plane() {
    let text = format!("{HEAD}{BODY}{STVK}[[body.traction]]\nregion = \"x_max\"\ntraction = [7, 0, 0]\n");
    for element in souple_elements::all().iter().filter(|e| e.dimension() == 2) {
        let (model, _) = prepared(&text.replace("hex8", element.id));
        let total: f64 = model.loads[0].forces.iter().map(|(_, f)| f[0]).sum();
        assert!(model.dimension == 2 && (total - 7.0).abs() < 1e-12, "{}: {total}", element.id);
    }
    let tilted = text.replace("hex8", "quad4").replace("[7, 0, 0]", "[7, 0, 1]");
    assert_says(&refused(&tilted), &tilted, "[[body.traction]]", &["along z", "dimension 2"]);
}

/// A traction whose region holds no whole face is an error, not no load.
#[test]
fn a_traction_needs_a_face() {
    let region = "{ and = [\"x_max\", \"y_max\"] }";
    let text = format!("{HEAD}{BODY}{STVK}[[body.traction]]\nregion = {region}\ntraction = [1, 0, 0]\n");
    assert_says(&refused(&text), &text, "region = {", &["no face of its surface", "[[body.force]]"]);
}

/// A total force is split in equal parts; a force per node is put on each; factors over time come along.
#[test]
fn forces_are_total_or_per_node() {
    let loads = "[[body.force]]\nregion = \"x_max\"\ntotal = [9, 0, 0]\nfactor = [[0, 0], [1, 2]]\n\
                 [[body.force]]\nregion = \"x_max\"\nper_node = [0, 9, 0]\n";
    let (model, _) = prepared(&format!("{HEAD}{BODY}{STVK}{loads}"));
    let forces: Vec<_> = model.loads.iter().map(|l| (l.forces.len(), l.forces[0].1, l.factor.clone())).collect();
    assert_eq!(forces, [(9, [1.0, 0.0, 0.0], vec![(0.0, 0.0), (1.0, 2.0)]), (9, [0.0, 9.0, 0.0], vec![])]);
}

/// Nodes that are held and moved along the same axis are a contradiction.
#[test]
fn nodes_cannot_be_held_and_moved() {
    let motion = "[[body.move]]\nregion = \"all\"\ntranslation.keys = [[0, [0, 0, 0]], [1, [1, 0, 0]]]\n";
    let text = format!("{HEAD}{BODY}{STVK}[[body.fix]]\nregion = \"x_min\"\n{motion}");
    assert_says(&refused(&text), &text, "region = \"all\"", &["9 nodes", "already held"]);
    let apart = text.replace("region = \"all\"", "region = \"x_max\"");
    let (model, _) = prepared(&apart);
    assert_eq!((model.moved[0].nodes.len(), model.moved[0].source), (9, (0, 0)));
}

/// An element folded through itself is an error that names it, its nodes and the line of the mesh.
#[test]
fn an_element_that_no_order_of_nodes_helps_is_an_error() {
    let mut nodes: Vec<[f64; 3]> = souple_elements::by_id("hex8").expect("hex8 is registered").nodes.to_vec();
    // One corner pushed past the centre: negative there, positive at the others.
    nodes[6] = [-0.5, -0.5, -0.5];
    let error = with_file(msh(&nodes, &[(5, &[1, 2, 3, 4, 5, 6, 7, 8])])).expect_err("the element is folded");
    let parts = ["inverted elements", "hex8 number 0 of body `lump` (nodes 0, 1, 2, 3, 4, 5, 6, 7)"];
    assert_says(&error.to_string(), &file_scene(), "lump.msh", &parts);

    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let error = with_file(msh(&flat, &[(4, &[1, 2, 3, 5]), (4, &[1, 2, 3, 4])])).expect_err("one element is flat");
    assert!(error.to_string().contains("tet4 number 1"), "{error}");
}

/// Elements listed inside out are turned and counted; nodes of nothing are dropped and counted.
#[test]
fn harmless_faults_of_a_file_are_mended_and_counted() {
    let mut nodes = CORNERS.to_vec();
    nodes.insert(0, [9.0, 9.0, 9.0]);
    let (model, warnings) = with_file(msh(&nodes, &[(4, &[2, 4, 3, 5])])).expect("both faults have an obvious cure");
    assert_eq!(model.nodes, CORNERS);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("1 elements were inside out")), "{warnings:?}");
    assert!(warnings.iter().any(|w| w.contains("1 nodes belong to no element")), "{warnings:?}");
}

/// A surface element that hangs on nodes of no solid is dropped with these nodes: they would have no mass.
#[test]
fn sides_of_nothing_are_dropped() {
    let mut nodes = CORNERS.to_vec();
    nodes.push([1.0, 1.0, 0.0]);
    let elements: [(u32, &[u32]); 3] = [(2, &[1, 3, 2]), (2, &[2, 3, 5]), (4, &[1, 2, 3, 4])];
    let (model, warnings) = with_file(msh(&nodes, &elements)).expect("the solid element is sound");
    assert_eq!(model.nodes, CORNERS);
    assert!(warnings.iter().any(|w| w.contains("1 elements of lower dimension")), "{warnings:?}");
    assert_eq!(model.blocks.len(), 1);
    assert_eq!(model.describe_element(0), "tet4 number 0 of body `lump` (nodes 0, 1, 2, 3)");
}

/// Coordinates that are no numbers, surfaces in space, unreadable files and files of another format say so.
#[test]
fn meshes_that_cannot_be_used_are_errors_at_the_mesh() {
    let far = [[0.0; 3], [f64::NAN, 0.0, 0.0], CORNERS[2], CORNERS[3]];
    let shell: [(u32, &[u32]); 2] = [(2, &[1, 2, 3]), (2, &[1, 2, 4])];
    for (bytes, part) in [
        (msh(&far, &[(4, &[1, 2, 3, 4])]), "every coordinate must be finite"),
        (msh(&CORNERS, &shell), "a `thickness` in their [[body.material]]"),
        (msh(&CORNERS, &[]), "has no element"),
        (b"nonsense".to_vec(), "lump.msh"),
    ] {
        let error = with_file(bytes).expect_err(part);
        assert_says(&error.to_string(), &file_scene(), "lump.msh", &[part]);
    }
    let error = prepared_with(&file_scene(), &mut no_files).expect_err("there is no such file");
    assert_says(&error.to_string(), &file_scene(), "lump.msh", &["cannot be read", "no file lump.msh in this test"]);
}

/// A file in millimetres is suspected, and `scale` turns it into metres.
#[test]
fn units_are_guessed_and_scaled() {
    let large = msh(&CORNERS.map(|p| p.map(|x| 100.0 * x)), &[(4, &[1, 2, 3, 4])]);
    let (_, warnings) = with_file(large.clone()).expect("the mesh is sound");
    assert!(warnings[0].contains("scale = \"1 mm\""), "{warnings:?}");
    let scaled = file_scene().replace("\"lump.msh\"", "\"lump.msh\", scale = \"1 mm\"");
    let (model, warnings) = prepared_with(&scaled, &mut |_| Ok(large.clone())).expect("the mesh is sound");
    assert!(warnings.is_empty(), "{warnings:?}");
    assert!((model.nodes[1][0] - 0.1).abs() < 1e-15);
}

/// Bodies of different dimension cannot share a scene.
#[test]
fn all_bodies_have_one_dimension() {
    let plane = BODY.replace("\"bar\"\nd", "\"sheet\"\nd").replace("hex8", "quad4");
    let text = format!("{HEAD}{BODY}{STVK}{plane}{STVK}");
    let parts = ["body \"sheet\" has elements of dimension 2", "body \"bar\" (line 7) of dimension 3"];
    assert_says(&refused(&text), &text, "quad4", &parts);
}

/// Every law of the registry can be named in a scene, with its parameters.
#[test]
fn the_catalogue_holds_every_law() {
    let catalogue = catalogue();
    for law in souple_laws::all() {
        let entry = catalogue.laws.iter().find(|entry| entry.id == law.id).expect("the law is listed");
        let arguments = law.arguments();
        assert_eq!(entry.parameters.len(), arguments.len(), "{}", law.id);
        for (entry, argument) in entry.parameters.iter().zip(arguments) {
            let parameter = match argument {
                souple_laws::Argument::Number(parameter) => parameter,
                souple_laws::Argument::Direction { name, .. } => {
                    assert_eq!(entry.name, name);
                    continue;
                }
            };
            assert_eq!(entry.name, parameter.name);
            for value in [-2.0, -1.0, 0.0, 0.25, 0.5, 1.0, 1e9] {
                assert_eq!(entry.range().contains(value), parameter.accepts(value), "{} {value}", parameter.name);
            }
        }
    }
}

/// A direction is one list in a scene and three parameters of the law; a zero one is refused at its line.
#[test]
fn directions_are_lists() {
    let material = "[[body.material]]\nlaw = \"transverse-stvk\"\nyoung = 1e5\npoisson = 0.3\nyoung_fibre = 3e5\n";
    let (model, _) = prepared(&format!("{HEAD}{BODY}{material}direction = [0, 3, 4]\n"));
    assert_eq!(model.blocks[0].parameters, [1e5, 0.3, 3e5, 0.0, 3.0, 4.0]);
    let text = format!("{HEAD}{BODY}{material}direction = [0, 0, 0]\n");
    let fault = souple_scene::parse(&text, "scene.toml", &catalogue()).expect_err("no direction").to_string();
    assert!(fault.contains("direction"), "{fault}");
}

/// Numbered parameters can be one list; too long a list, the same twice and an exponent of zero are refused at their
/// lines.
#[test]
fn numbered_parameters_are_lists_or_single() {
    let material = "[[body.material]]\nlaw = \"ogden\"\nbulk = \"2 MPa\"\n";
    let (model, _) = prepared(&format!("{HEAD}{BODY}{material}mu = [\"3 kPa\", 20]\nalpha = [2, -1.5]\n"));
    assert_eq!(model.blocks[0].parameters, [3e3, 20.0, 0.0, 2.0, -1.5, 5.0, 2e6]);
    let (single, _) = prepared(&format!("{HEAD}{BODY}{material}mu1 = 3000\nmu2 = 20\nalpha1 = 2\nalpha2 = -1.5\n"));
    assert_eq!(model.blocks[0].parameters, single.blocks[0].parameters);
    for (lines, says) in [
        ("mu = [1, 2, 3, 4]\nalpha = [2]\n", "a list of 1 to 3 numbers"),
        ("mu = []\nalpha = [2]\n", "a list of 1 to 3 numbers"),
        ("mu = 5\nalpha = [2]\n", "`mu1` to `mu3`"),
        ("mu = [1]\nmu1 = 2\nalpha = [2]\n", "give one of the two"),
        ("mu = [1]\nalpha = [0]\n", "other than 0"),
        ("mu = [1]\nalpha1 = 0.0\n", "other than 0"),
        ("mu = [1]\n", "alpha1"),
    ] {
        let text = format!("{HEAD}{BODY}{material}{lines}");
        let fault = souple_scene::parse(&text, "scene.toml", &catalogue()).expect_err(lines).to_string();
        assert!(fault.contains(says), "{lines}: {fault}");
    }
}

/// The same scene gives the same blocks, nodes and loads, bit by bit.
#[test]
fn preparation_repeats_itself() {
    let text = format!("{HEAD}{BODY}{STVK}[[body.traction]]\nregion = \"x_max\"\ntraction = [1, 2, 3]\n");
    assert_eq!(format!("{:?}", prepared(&text).0), format!("{:?}", prepared(&text).0));
}
