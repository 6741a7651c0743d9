//! Regions promise: geometric selectors include their border whatever the size of the mesh, combinations act on nodes
//! and elements, and an empty or unknown region says what there is.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use souple_elements::by_id;
use souple_mesh::bar::{BarSpec, Section, Split, Transition, generate};
use souple_mesh::region::{RegionError, RegionSpec, SurfaceDistance, elements, evaluate, nodes, select};
use souple_mesh::topology::{Topology, boundary};
use souple_mesh::{ElementId, Mesh};

fn bar(scale: f64) -> Mesh {
    let section = |until, id: &str| Section { until, element: by_id(id).unwrap(), split: Split::Usual };
    let sections = vec![section(0.5, "hex8"), section(1.0, "tet4")];
    let size = [8.0 * scale, scale, scale];
    let spec = BarSpec { size, cells: [16, 3, 3], origin: [scale / 3.0; 3], sections, transition: Transition::Keep };
    generate(&spec).unwrap().0
}

/// A box, a plane and a sphere that touch the end face select exactly its nodes, for bars of micrometres to kilometres.
#[test]
fn borders_are_inside_at_every_scale() {
    for scale in [1e-6, 1.0, 1e3] {
        let mesh = bar(scale);
        let end = &mesh.regions["x_max"].nodes;
        let x = scale / 3.0 + 8.0 * scale;
        let plane = RegionSpec::Plane { point: [x, 0.0, 0.0], normal: [5.0, 0.0, 0.0] };
        assert_eq!(&nodes(&mesh, &plane).unwrap(), end);
        let shape = RegionSpec::Box { min: [x, -1e9, -1e9], max: [1e9; 3] };
        assert_eq!(&nodes(&mesh, &shape).unwrap(), end);
        let corner = mesh.nodes[end[0] as usize];
        let cell = scale / 3.0;
        let ball = RegionSpec::Sphere { centre: corner, radius: cell };
        assert_eq!(nodes(&mesh, &ball).unwrap().len(), 3, "the corner and its neighbours along y and z");
    }
}

/// Kinds, names, and combinations: each identity of sets holds on nodes and on elements.
#[test]
fn combinations_are_set_algebra() {
    let mesh = bar(1.0);
    let hexahedra = RegionSpec::Element("hex8".to_owned());
    let section = RegionSpec::Named("section_0".to_owned());
    assert_eq!(select(&mesh, &hexahedra).unwrap(), select(&mesh, &section).unwrap());

    let left = RegionSpec::Plane { point: [2.0, 0.0, 0.0], normal: [-1.0, 0.0, 0.0] };
    let all = evaluate(&mesh, &RegionSpec::All).unwrap();
    assert_eq!(all.nodes.len(), mesh.nodes.len());
    assert_eq!(all.elements.len(), mesh.element_count());
    let not = |spec: &RegionSpec| RegionSpec::Not(Box::new(spec.clone()));
    let value = |spec: &RegionSpec| evaluate(&mesh, spec).unwrap();
    assert_eq!(value(&not(&not(&left))), value(&left));
    let nothing = RegionSpec::And(vec![left.clone(), not(&left)]);
    assert!(value(&nothing).nodes.is_empty() && value(&nothing).elements.is_empty());
    assert_eq!(value(&RegionSpec::Or(vec![left.clone(), not(&left)])), all);
    let de_morgan = RegionSpec::Not(Box::new(RegionSpec::Or(vec![not(&left), not(&hexahedra)])));
    assert_eq!(value(&de_morgan), value(&RegionSpec::And(vec![left, hexahedra])));
    assert_eq!(value(&RegionSpec::And(vec![])), all);
    assert!(value(&RegionSpec::Or(vec![])).nodes.is_empty());
}

/// Depth below the surface is the distance to the nearest side of the bar.
#[test]
fn depth_is_distance_to_the_nearest_side() {
    let mesh = bar(1.0);
    let skin = elements(&mesh, &RegionSpec::DistanceToSurface { below: 0.2 }).unwrap();
    let depth = |e: ElementId| {
        let c = mesh.centroid(e);
        let side = |a: usize, l: f64| (c[a] - 1.0 / 3.0).min(1.0 / 3.0 + l - c[a]);
        side(0, 8.0).min(side(1, 1.0)).min(side(2, 1.0))
    };
    let expected: Vec<ElementId> = mesh.element_ids().filter(|&e| depth(e) <= 0.2).collect();
    assert!(skin == expected, "{} elements, expected {}", skin.len(), expected.len());
    assert!(expected.len() < mesh.element_count());
    let on_it = nodes(&mesh, &RegionSpec::DistanceToSurface { below: 0.0 }).unwrap();
    // Hexahedra and tetrahedra do not meet in the middle of this bar; the faces between them are no surface.
    let inner = mesh.nodes.len() - on_it.len();
    assert_eq!(inner, (17 - 2) * 2 * 2);
}

/// A flat mesh has an outline to be distant from.
#[test]
fn flat_meshes_have_an_outline() {
    let sections = vec![Section { until: 1.0, element: by_id("quad4").unwrap(), split: Split::Usual }];
    let spec = BarSpec { size: [1.0; 3], cells: [10, 10, 1], origin: [0.0; 3], sections, transition: Transition::Keep };
    let mesh = generate(&spec).unwrap().0;
    let rim = elements(&mesh, &RegionSpec::DistanceToSurface { below: 0.1 }).unwrap();
    assert_eq!(rim.len(), 36);
}

/// Unknown names suggest the nearest; empty regions tell where the mesh is; senseless shapes say which number.
#[test]
fn failures_say_what_there_is() {
    let mesh = bar(1.0);
    let error = select(&mesh, &RegionSpec::Named("xmax".to_owned())).unwrap_err();
    assert!(matches!(&error, RegionError::UnknownName { nearest: Some(n), .. } if n == "x_max"), "{error}");
    assert!(error.to_string().contains("did you mean `x_max`?") && error.to_string().contains("`section_1`"));
    let far = select(&mesh, &RegionSpec::Named("liver".to_owned())).unwrap_err();
    assert!(matches!(far, RegionError::UnknownName { nearest: None, .. }), "{far}");
    let error = select(&mesh, &RegionSpec::Element("tet10".to_owned())).unwrap_err();
    assert!(matches!(&error, RegionError::UnknownElement { nearest: Some(n), .. } if n == "tet4"), "{error}");

    let outside = RegionSpec::Sphere { centre: [100.0; 3], radius: 1.0 };
    let error = select(&mesh, &outside).unwrap_err();
    assert!(matches!(error, RegionError::Empty { .. }));
    assert!(error.to_string().contains("[0.3333333333333333, 0.3333333333333333, 0.3333333333333333] to"), "{error}");
    let error = elements(&mesh, &RegionSpec::Named("x_min".to_owned())).unwrap_err();
    assert!(matches!(error, RegionError::Empty { what: "element", .. }), "x_min is a set of nodes");
    assert!(matches!(select(&Mesh::default(), &RegionSpec::All), Err(RegionError::Empty { .. })));

    for spec in [
        RegionSpec::Box { min: [1.0; 3], max: [0.0; 3] },
        RegionSpec::Box { min: [f64::NAN; 3], max: [0.0; 3] },
        RegionSpec::Sphere { centre: [0.0; 3], radius: -1.0 },
        RegionSpec::Sphere { centre: [0.0; 3], radius: f64::NAN },
        RegionSpec::Plane { point: [0.0; 3], normal: [0.0; 3] },
        RegionSpec::DistanceToSurface { below: f64::NAN },
    ] {
        assert!(matches!(evaluate(&mesh, &spec), Err(RegionError::Shape { .. })), "{spec:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The tree finds the distance to a box that a formula gives, inside and outside.
    #[test]
    fn distance_to_a_box(p in prop::array::uniform3(-2.0f64..3.0)) {
        let sections = vec![Section { until: 1.0, element: by_id("hex8").unwrap(), split: Split::Usual }];
        let spec = BarSpec { size: [1.0; 3], cells: [3, 4, 5], origin: [0.0; 3], sections, transition: Transition::Keep };
        let mesh = generate(&spec).unwrap().0;
        let tree = SurfaceDistance::new(&boundary(&mesh, &Topology::new(&mesh).unwrap()).mesh);
        let outside = p.map(|x| (-x).max(x - 1.0).max(0.0));
        let distance = match outside.iter().any(|d| *d > 0.0) {
            true => outside.iter().map(|d| d * d).sum::<f64>().sqrt(),
            false => p.iter().map(|x| x.min(1.0 - x)).fold(f64::INFINITY, f64::min),
        };
        prop_assert!((tree.distance(p) - distance).abs() < 1e-12);
        prop_assert!(tree.within(p, distance + 1e-9));
        prop_assert!(!tree.within(p, distance - 1e-9));
    }
}
