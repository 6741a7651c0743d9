//! The thesis' files promise: what it prints is read as it means and written back as printed, and a wrong line is named.

use souple_elements::by_id;
use souple_mesh::Mesh;
use souple_mesh::bar::{BarSpec, Section, Split, Transition, generate};
use souple_mesh::triple::{Problem, TripleError, associate, bar_config, read, write};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n";
const ELEMENT: &str = "nbElement 2\n#indices i1 i2 i3\n3 0 1 3\n3 0 3 2\n";
const INFO: &str = "nbDim 2\n$ELEM\n#nbElement\n2\n#indices Loi Element Decoupage\n\
                    0 Hooke Triangle DecoupageNon\n1 SaintVenant Triangle DecoupageNon\n$ENDELM\n";
const CONFIG: &str = "nomRepertoire ./\nnomMaillage barreMixte\nlongueur 6\nlargeurSection 1\nnbCubeLongueur 12\n\
                      nbCubeLargeurSection 2\n0.5 Hooke Triangle DecoupageNon\n1.0 SaintVenant Quad DecoupageNon\n";

/// Codes 15 and 16, with the particles of figure 5.4: read, and written back letter by letter.
#[test]
fn printed_files_come_back() {
    let triple = read(OBJ, ELEMENT, INFO).unwrap();
    assert_eq!(triple.mesh.nodes[3], [1.0, 1.0, 0.0]);
    assert_eq!(triple.mesh.blocks.len(), 1);
    assert_eq!(triple.mesh.blocks[0].element.id, "tri3");
    assert_eq!(triple.mesh.blocks[0].connectivity, [0, 1, 3, 0, 3, 2]);
    let laws: Vec<&str> = triple.associations.iter().map(|a| a.law.as_str()).collect();
    assert_eq!(laws, ["Hooke", "SaintVenant"]);
    assert_eq!(triple.mesh.regions["Hooke"].elements, [triple.order[0]]);
    assert_eq!(triple.mesh.regions["SaintVenant"].nodes, [0, 2, 3]);
    let text = write(&triple);
    assert_eq!((text.obj.as_str(), text.element.as_str(), text.info.as_str()), (OBJ, ELEMENT, INFO));
}

/// Code 19: the bar of figure 5.5, and its three files.
#[test]
fn printed_configuration_generates() {
    let config = bar_config::read(CONFIG).unwrap();
    assert_eq!((config.directory.as_str(), config.mesh_name.as_str()), ("./", "barreMixte"));
    assert_eq!((config.spec.size, config.spec.cells), ([6.0, 1.0, 1.0], [12, 2, 2]));
    let (triple, report) = bar_config::model(&config).unwrap();
    assert!(report.mismatches.is_empty());
    assert_eq!(triple.mesh.dimension(), 2);
    assert_eq!(triple.mesh.nodes.len(), 13 * 3);
    assert_eq!(triple.associations.iter().filter(|a| a.law == "Hooke").count(), 6 * 2 * 2);
    assert_eq!(triple.associations.iter().filter(|a| a.law == "SaintVenant").count(), 6 * 2);
    let text = write(&triple);
    let again = read(&text.obj, &text.element, &text.info).unwrap();
    assert_eq!(again.associations, triple.associations);
    assert_eq!(again.mesh.nodes, triple.mesh.nodes);
    assert_eq!(write(&again), text);
}

/// Code 23's associations: one section of each solid family, with the integration points that the names state.
#[test]
fn solid_sections_are_understood() {
    let text = CONFIG.replace(
        "0.5 Hooke Triangle DecoupageNon\n1.0 SaintVenant Quad DecoupageNon\n",
        "0.25 SaintVenant Prism6I DecoupageNon\n0.50 SaintVenant Pyramid5I DecoupageNon\n\
         0.75 SaintVenant Cube8I DecoupageG\n1.00 SaintVenant Tetra DecoupageNon\n",
    );
    let config = bar_config::read(&text).unwrap();
    let ids: Vec<&str> = config.spec.sections.iter().map(|s| s.element.id).collect();
    assert_eq!(ids, ["prism6", "pyramid5", "hex8", "tet4"]);
    let points: Vec<Option<usize>> = config.associations.iter().map(|a| a.integration_points).collect();
    assert_eq!(points, [Some(6), Some(5), Some(8), None]);
    let (triple, _) = bar_config::model(&config).unwrap();
    let text = write(&triple);
    let again = read(&text.obj, &text.element, &text.info).unwrap();
    let kinds = |m: &Mesh| m.blocks.iter().map(|b| (b.element.id, b.connectivity.clone())).collect::<Vec<_>>();
    assert_eq!(kinds(&again.mesh), kinds(&triple.mesh));
    assert_eq!(again.associations[0].cutting, "DecoupageNon");
    assert!(again.associations.iter().any(|a| a.cutting == "DecoupageG"));
}

/// Any mixed mesh of ours, quadratic elements included, survives the three files bit by bit.
#[test]
fn our_meshes_come_back() {
    let section = |until, id: &str| Section { until, element: by_id(id).unwrap(), split: Split::Usual };
    let sections = vec![section(0.3, "hex20"), section(0.6, "tet10"), section(1.0, "prism6")];
    let spec = BarSpec {
        size: [1.1, 0.3, 0.7],
        cells: [6, 2, 2],
        origin: [-0.1, 1e-7, 3e5],
        sections,
        transition: Transition::Keep,
    };
    let mesh = generate(&spec).unwrap().0;
    let triple = associate(mesh.clone(), |id| if id.block == 0 { "Hooke" } else { "SaintVenant" }.to_owned());
    let text = write(&triple);
    let again = read(&text.obj, &text.element, &text.info).unwrap();
    assert_eq!(again.mesh.nodes, mesh.nodes);
    for (a, b) in again.mesh.blocks.iter().zip(&mesh.blocks) {
        assert_eq!((a.element.id, &a.connectivity), (b.element.id, &b.connectivity));
    }
    assert_eq!(again.associations, triple.associations);
}

/// Each kind of wrong line is named with its file and number.
#[test]
fn wrong_lines_are_named() {
    let fails = |obj: &str, element: &str, info: &str| -> (&'static str, usize, Problem) {
        let TripleError { file, line, problem } = read(obj, element, info).unwrap_err();
        (file, line, problem)
    };
    let in_obj = |text: &str| fails(text, ELEMENT, INFO);
    assert!(matches!(in_obj("v 0 0\n"), (".obj", 1, Problem::Words { .. })));
    assert!(matches!(in_obj("# x\nv 0 0 zero\n"), (".obj", 2, Problem::Number { .. })));
    assert!(matches!(in_obj("v 0 0 nan\n"), (".obj", 1, Problem::Number { .. })));
    assert!(matches!(in_obj("vertex 0 0 0\n"), (".obj", 1, Problem::UnknownWord { .. })));

    let in_element = |from: &str, to: &str| fails(OBJ, &ELEMENT.replace(from, to), INFO);
    assert!(matches!(in_element("nbElement 2", "nbElement 3"), (_, 1, Problem::Count { stated: 3, found: 2 })));
    assert!(matches!(in_element("nbElement 2", "nbElement deux"), (_, 1, Problem::Number { .. })));
    assert!(matches!(in_element("nbElement 2\n", ""), (".element", 2, Problem::UnknownWord { .. })));
    assert!(matches!(in_element("0 1 3", "0 1"), (_, 3, Problem::Words { .. })));
    assert!(matches!(in_element("0 1 3", "0 1 4"), (_, 3, Problem::Index { index: 4, count: 4, .. })));
    assert!(matches!(in_element("0 1 3", "0 1 -3"), (_, 3, Problem::Number { .. })));
    assert!(matches!(fails(OBJ, "", INFO), (".element", 0, Problem::Missing { .. })));

    let in_info = |from: &str, to: &str| fails(OBJ, ELEMENT, &INFO.replace(from, to));
    assert!(matches!(in_info("0 Hooke Triangle", "0 Hooke Trianglle"), (".info", 6, Problem::UnknownElement { .. })));
    assert!(matches!(in_info("0 Hooke Triangle", "0 Hooke Quad"), (".info", 6, Problem::NodeCount { count: 3, .. })));
    assert!(matches!(in_info("1 SaintVenant", "0 SaintVenant"), (".info", 7, Problem::Repeated { .. })));
    assert!(matches!(in_info("1 SaintVenant", "2 SaintVenant"), (".info", 7, Problem::Index { index: 2, .. })));
    assert!(matches!(in_info("$ENDELM\n", ""), (".info", 7, Problem::Missing { .. })));
    assert!(matches!(in_info("nbDim 2", "nbDim 1"), (".info", 6, Problem::Dimension { dimension: 2, stated: 1, .. })));
    assert!(matches!(in_info("nbDim 2", "nbDim 4"), (".info", 1, Problem::Number { .. })));
    assert!(matches!(in_info("1 SaintVenant Triangle DecoupageNon\n", ""), (".info", 7, Problem::Missing { .. })));
    let message = read(OBJ, ELEMENT, &INFO.replace("0 Hooke Triangle", "0 Hooke Tri")).unwrap_err().to_string();
    assert!(message.starts_with(".info line 6: no element is called `Tri`; known are Arete"), "{message}");

    let in_config = |from: &str, to: &str| {
        let error = bar_config::read(&CONFIG.replace(from, to)).unwrap_err();
        (error.line, error.problem)
    };
    assert!(matches!(in_config("longueur 6\n", ""), (7, Problem::Missing { .. })));
    assert!(matches!(in_config("longueur 6", "longueur six"), (3, Problem::Number { .. })));
    assert!(matches!(in_config("longueur 6", "longeur 6"), (3, Problem::UnknownWord { .. })));
    assert!(matches!(in_config("nomMaillage barreMixte", "longueur 6"), (3, Problem::Repeated { .. })));
    assert!(matches!(in_config("Hooke Triangle DecoupageNon", "Hooke Triangle"), (7, Problem::Words { .. })));
    assert!(matches!(in_config("Hooke Triangle", "Hooke Dreieck"), (7, Problem::UnknownElement { .. })));
}
