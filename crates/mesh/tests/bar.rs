//! Bars promise: elements fill exactly the box, no element is inverted, the boundary is a closed surface, what the
//! report says about interfaces is what the topology finds, and a transition layer leaves nothing to find.
//!
//! Everything runs over the element registry, so an element added tomorrow is generated and checked tomorrow.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use souple_elements::{Element, Family, all, by_id};
use souple_mesh::Mesh;
use souple_mesh::bar::{Axis, BarError, BarReport, BarSpec, MismatchKind, Section, Split, Transition, generate};
use souple_mesh::topology::{Interface, Topology, boundary, euler_characteristic, interfaces};

const SOLID_SPLITS: [Split; 8] = [
    Split::Whole,
    Split::Tetrahedra6,
    Split::Tetrahedra6Mirrored,
    Split::Tetrahedra5,
    Split::Prisms(Axis::X),
    Split::Prisms(Axis::Y),
    Split::Prisms(Axis::Z),
    Split::Pyramids,
];

fn family_of(split: Split) -> Family {
    match split {
        Split::Tetrahedra5 | Split::Tetrahedra6 | Split::Tetrahedra6Mirrored => Family::Tetrahedron,
        Split::Prisms(_) => Family::Prism,
        Split::Pyramids => Family::Pyramid,
        _ => Family::Hexahedron,
    }
}

fn linear(family: Family) -> &'static Element {
    all().iter().find(|e| e.family == family && e.degree == 1).expect("every family has a linear element")
}

fn sections(parts: &[(&'static Element, Split)]) -> Vec<Section> {
    let n = parts.len() as f64;
    let section = |(i, &(element, split)): (usize, &(&'static Element, Split))| Section {
        until: (i + 1) as f64 / n,
        element,
        split,
    };
    parts.iter().enumerate().map(section).collect()
}

fn bar(parts: &[(&'static Element, Split)], cells: [usize; 3], transition: Transition) -> BarSpec {
    BarSpec { size: [3.0, 1.25, 0.75], cells, origin: [-0.5, 0.25, 1.0], sections: sections(parts), transition }
}

/// Volume of one linear solid with bilinear faces by the divergence theorem: V = 1/3 ∮ x · n dA, a quadrangle being
/// the mean of its two triangulations. Positive only for outward faces.
fn volume(mesh: &Mesh, block: usize, index: usize) -> f64 {
    let b = &mesh.blocks[block];
    let nodes = b.nodes(index);
    let at = |n: u8| mesh.nodes[nodes[n as usize] as usize];
    let det = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let mut six = 0.0;
    for side in b.element.faces {
        let family = by_id(side.element).unwrap().family;
        let c: Vec<[f64; 3]> = side.nodes[..family.corner_count()].iter().map(|&n| at(n)).collect();
        six += match c.as_slice() {
            [a, b, c] => det(*a, *b, *c),
            [a, b, c, d] => (det(*a, *b, *c) + det(*a, *c, *d) + det(*a, *b, *d) + det(*b, *c, *d)) / 2.0,
            _ => unreachable!(),
        };
    }
    six / 6.0
}

fn check_solid(spec: &BarSpec, mesh: &Mesh, report: &BarReport) {
    let mut total = 0.0;
    for (b, block) in mesh.blocks.iter().enumerate() {
        for e in 0..block.len() {
            let v = volume(mesh, b, e);
            assert!(v > 0.0, "{} {e}: {v}", block.element.id);
            total += v;
        }
    }
    let expected: f64 = spec.size.iter().product();
    assert!((total / expected - 1.0).abs() < 1e-12, "{total} {expected}");

    let topology = Topology::new(mesh).unwrap();
    assert!(topology.non_manifold.is_empty() && topology.folded.is_empty() && topology.collapsed.is_empty());
    let found = interfaces(&topology);
    assert_eq!(found.is_empty(), report.mismatches.is_empty(), "{found:?} {report:?}");
    if found.is_empty() {
        let surface = boundary(mesh, &topology).mesh;
        assert_eq!(euler_characteristic(&surface), 2);
        // Every face without mate lies on the box: so every interior face has exactly two elements.
        for block in &surface.blocks {
            for f in 0..block.len() {
                let on =
                    |a: usize, x: f64| block.nodes(f).iter().all(|&n| (surface.nodes[n as usize][a] - x).abs() < 1e-9);
                let outside = (0..3).any(|a| on(a, spec.origin[a]) || on(a, spec.origin[a] + spec.size[a]));
                assert!(outside, "face {f} of {} is open inside the bar", block.element.id);
            }
        }
        assert_eq!(topology.corner_node, topology.corner_material, "a conforming bar has one node per material node");
    }
}

/// Every ordered pair of solid subdivisions, with a transition layer, is conforming; without it, the report counts
/// exactly the faces that the topology finds.
#[test]
fn every_pair_of_subdivisions_conforms_after_the_transition() {
    for a in SOLID_SPLITS {
        for b in SOLID_SPLITS {
            let parts = [(linear(family_of(a)), a), (linear(family_of(b)), b)];
            let spec = bar(&parts, [5, 3, 2], Transition::InsertPyramids);
            let (mesh, report) = generate(&spec).unwrap();
            assert_eq!(report.mismatched_faces(), 0, "{a:?} {b:?}");
            check_solid(&spec, &mesh, &report);

            let spec = bar(&parts, [5, 3, 2], Transition::Keep);
            let (mesh, report) = generate(&spec).unwrap();
            check_solid(&spec, &mesh, &report);
            let found = interfaces(&Topology::new(&mesh).unwrap());
            assert_eq!(found.len(), report.mismatched_faces(), "{a:?} {b:?}: {found:?}");
            assert_eq!(report.warnings().len(), report.mismatches.len());
            for mismatch in &report.mismatches {
                let same = |i: &&Interface| match i {
                    Interface::QuadrangleAgainstTriangles { .. } => {
                        mismatch.kind == MismatchKind::QuadrangleAgainstTriangles
                    }
                    Interface::CrossedDiagonals { .. } => mismatch.kind == MismatchKind::CrossedDiagonals,
                    Interface::DifferentInterpolation { .. } => mismatch.kind == MismatchKind::DifferentInterpolation,
                };
                assert_eq!(found.iter().filter(same).count(), mismatch.faces, "{a:?} {b:?}");
            }
        }
    }
}

/// Every element of the registry fills a bar whose nodes are all used, distinct and inside the box, and every pair of
/// solids of equal degree with a matching pyramid can be joined.
#[test]
fn every_element_fills_a_bar() {
    for element in all() {
        let spec = bar(&[(element, Split::Usual)], [2, 2, 2], Transition::Keep);
        let (mesh, report) = generate(&spec).unwrap();
        assert!(report.mismatches.is_empty());
        let mut used = vec![false; mesh.nodes.len()];
        mesh.blocks.iter().flat_map(|b| &b.connectivity).for_each(|&n| used[n as usize] = true);
        assert!(used.iter().all(|u| *u), "{}: unused nodes", element.id);
        let mut sorted: Vec<[i64; 3]> = mesh.nodes.iter().map(|p| p.map(|x| (x * 1e9).round() as i64)).collect();
        sorted.sort_unstable();
        assert!(sorted.windows(2).all(|w| w[0] != w[1]), "{}: two nodes at one place", element.id);
        if element.dimension() == 3 {
            check_solid(&spec, &mesh, &report);
        }
        let [x, y, z] = ["x_min", "y_min", "z_min"].map(|r| mesh.regions.get(r).map(|r| r.nodes.len()));
        assert!(x.is_some_and(|n| n > 0));
        assert_eq!(y.is_some(), element.dimension() > 1);
        assert_eq!(z.is_some(), element.dimension() > 2);
    }
}

/// The number of nodes is that of the closed formulas, so shared nodes are shared and no other is.
#[test]
fn node_counts_follow_the_grid() {
    let (i, j, k) = (4, 3, 2);
    let grid = (i + 1) * (j + 1) * (k + 1);
    let edges = i * (j + 1) * (k + 1) + (i + 1) * j * (k + 1) + (i + 1) * (j + 1) * k;
    let faces = i * j * (k + 1) + i * (j + 1) * k + (i + 1) * j * k;
    let cells = i * j * k;
    for (id, count) in [
        ("hex8", grid),
        ("hex20", grid + edges),
        ("hex27", grid + edges + faces + cells),
        ("tet4", grid),
        // Kuhn: the second-order grid of twice the resolution.
        ("tet10", grid + edges + faces + cells),
        ("prism6", grid),
        // Along x: one diagonal per face normal to x.
        ("prism15", grid + edges + (i + 1) * j * k),
        ("pyramid5", grid + cells),
        ("pyramid13", grid + cells + edges + 8 * cells),
    ] {
        let spec = bar(&[(by_id(id).unwrap(), Split::Usual)], [i, j, k], Transition::Keep);
        assert_eq!(generate(&spec).unwrap().0.nodes.len(), count, "{id}");
    }
}

/// The tetrahedra, prisms and hexahedra are those of the reference meshes, node for node (their first cells).
#[test]
fn numbering_is_that_of_the_reference_meshes() {
    let first = |id: &str, cells: [usize; 3], count: usize| -> Vec<Vec<u32>> {
        let sections = sections(&[(by_id(id).unwrap(), Split::Usual)]);
        let spec = BarSpec { size: [8.0, 1.0, 1.0], cells, origin: [0.0; 3], sections, transition: Transition::Keep };
        let mesh = generate(&spec).unwrap().0;
        (0..count).map(|e| mesh.blocks[0].nodes(e).iter().map(|n| n + 1).collect()).collect()
    };
    assert_eq!(
        first("tet4", [32, 4, 4], 7),
        [
            [1, 2, 35, 200],
            [1, 2, 200, 167],
            [1, 34, 200, 35],
            [1, 34, 199, 200],
            [1, 166, 167, 200],
            [1, 166, 200, 199],
            [2, 3, 36, 201]
        ]
    );
    assert_eq!(
        first("prism6", [24, 8, 8], 3),
        [[1, 26, 251, 2, 27, 252], [1, 251, 226, 2, 252, 227], [2, 27, 252, 3, 28, 253]]
    );
    assert_eq!(first("hex8", [48, 8, 8], 1), [[1, 2, 51, 50, 442, 443, 492, 491]]);
    assert_eq!(first("tet10", [32, 4, 4], 2)[1], [1, 2, 200, 167, 826, 838, 832, 830, 836, 1839]);
    assert_eq!(
        first("prism15", [24, 8, 8], 1)[0],
        [1, 26, 251, 2, 27, 252, 2027, 2127, 2029, 2031, 2131, 2033, 2026, 2125, 2966]
    );
}

/// The mixed bar of the scene example has its four sections as regions, which together are everything.
#[test]
fn sections_are_regions() {
    let ids = ["prism6", "pyramid5", "hex8", "tet4"];
    let parts = ids.map(|id| (by_id(id).unwrap(), Split::Usual));
    let spec = bar(&parts, [24, 4, 4], Transition::Keep);
    let (mesh, report) = generate(&spec).unwrap();
    assert_eq!(report.section_cells, [6, 6, 6, 6]);
    let mut all_elements: Vec<souple_mesh::ElementId> = Vec::new();
    for (s, id) in ids.into_iter().enumerate() {
        let region = &mesh.regions[&format!("section_{s}")];
        assert!(region.elements.iter().all(|e| mesh.blocks[e.block as usize].element.id == id));
        all_elements.extend_from_slice(&region.elements);
    }
    all_elements.sort_unstable();
    assert_eq!(all_elements, mesh.element_ids().collect::<Vec<_>>());
    // prism|pyramid and hex|tet do not meet, pyramid|hex does.
    let pairs: Vec<[usize; 2]> = report.mismatches.iter().map(|m| m.sections).collect();
    assert_eq!(pairs, [[0, 1], [2, 3]]);
    assert_eq!(report.mismatched_faces(), 32);
    assert!(report.warnings()[0].contains("prism6") && report.warnings()[0].contains("16 faces"));
}

/// Each wrong field of a specification has its own error, which names it.
#[test]
fn wrong_specifications_are_named() {
    let hex = by_id("hex8").unwrap();
    let good = bar(&[(hex, Split::Usual)], [4, 2, 2], Transition::Keep);
    let with = |change: &dyn Fn(&mut BarSpec)| {
        let mut spec = good.clone();
        change(&mut spec);
        generate(&spec).map(|_| ()).unwrap_err()
    };
    assert_eq!(with(&|s| s.sections.clear()), BarError::NoSection);
    assert_eq!(with(&|s| s.size[1] = 0.0), BarError::Size { axis: 1, value: 0.0 });
    assert!(matches!(with(&|s| s.size[2] = f64::NAN), BarError::Size { axis: 2, .. }));
    assert!(matches!(with(&|s| s.origin[0] = f64::INFINITY), BarError::Origin { axis: 0, .. }));
    assert_eq!(with(&|s| s.cells[2] = 0), BarError::Cells { axis: 2 });
    assert!(matches!(with(&|s| s.cells = [1 << 20; 3]), BarError::TooMany { .. }));
    assert!(matches!(with(&|s| s.cells = [usize::MAX; 3]), BarError::TooMany { .. }));
    assert_eq!(with(&|s| s.sections[0].until = 0.9), BarError::Unfilled { until: 0.9 });
    assert!(matches!(with(&|s| s.sections[0].until = f64::NAN), BarError::Until { section: 0, .. }));
    let second = Section { until: 1.0, ..good.sections[0] };
    assert!(matches!(with(&|s| s.sections.push(second)), BarError::Until { section: 1, .. }));
    let sliver = Section { until: 0.01, ..good.sections[0] };
    let empty = with(&|s| s.sections.insert(0, sliver));
    assert!(matches!(empty, BarError::EmptySection { section: 0, cells: 4, .. }), "{empty}");
    let flat = Section { element: by_id("quad4").unwrap(), ..good.sections[0] };
    assert!(matches!(
        with(&|s| s.sections.insert(0, Section { until: 0.5, ..flat })),
        BarError::MixedDimensions { .. }
    ));
    assert!(matches!(with(&|s| s.sections[0].split = Split::Pyramids), BarError::Split { section: 0, .. }));
}

/// Sections of different degree are reported as such, and cannot be joined by a layer of cells.
#[test]
fn degrees_do_not_join() {
    let parts = ["hex8", "hex20"].map(|id| (by_id(id).unwrap(), Split::Usual));
    let (mesh, report) = generate(&bar(&parts, [4, 2, 2], Transition::Keep)).unwrap();
    assert_eq!(report.mismatches[0].kind, MismatchKind::DifferentInterpolation);
    assert_eq!(report.mismatched_faces(), 4);
    let found = interfaces(&Topology::new(&mesh).unwrap());
    assert!(
        found.iter().all(|i| matches!(i, Interface::DifferentInterpolation { interpolations: ["quad4", "quad8"], .. }))
    );
    assert_eq!(found.len(), 4);
    let error = generate(&bar(&parts, [4, 2, 2], Transition::InsertPyramids)).unwrap_err();
    assert!(matches!(error, BarError::DifferentInterpolation { sections: [0, 1], .. }));

    let parts = ["hex27", "tet10"].map(|id| (by_id(id).unwrap(), Split::Usual));
    let error = generate(&bar(&parts, [4, 2, 2], Transition::InsertPyramids)).unwrap_err();
    assert!(matches!(error, BarError::NoTransition { family: "pyramid", .. }), "{error}");

    let parts = ["hex20", "tet10"].map(|id| (by_id(id).unwrap(), Split::Usual));
    let spec = bar(&parts, [4, 2, 2], Transition::InsertPyramids);
    let (mesh, report) = generate(&spec).unwrap();
    assert_eq!(mesh.blocks.iter().map(|b| b.element.id).collect::<Vec<_>>(), ["hex20", "pyramid13", "tet10"]);
    check_solid(&spec, &mesh, &report);
}

/// Flat bars fill their rectangle, with any mix of triangles and quadrangles.
#[test]
fn flat_bars_fill_their_rectangle() {
    let (tri, quad) = (by_id("tri3").unwrap(), by_id("quad4").unwrap());
    let parts = [
        (tri, Split::Usual),
        (quad, Split::Usual),
        (tri, Split::TrianglesBackward),
        (tri, Split::TrianglesAlternating),
    ];
    let spec = bar(&parts, [9, 3, 1], Transition::Keep);
    let (mesh, report) = generate(&spec).unwrap();
    assert!(report.mismatches.is_empty());
    let area = |e| {
        let c: Vec<[f64; 3]> = mesh.nodes_of(e).iter().map(|&n| mesh.nodes[n as usize]).collect();
        (0..c.len()).map(|i| (c[i], c[(i + 1) % c.len()])).map(|(p, q)| (p[0] * q[1] - p[1] * q[0]) / 2.0).sum::<f64>()
    };
    let areas: Vec<f64> = mesh.element_ids().map(area).collect();
    assert!(areas.iter().all(|a| *a > 0.0));
    assert!((areas.iter().sum::<f64>() - 3.75).abs() < 1e-12);
    let topology = Topology::new(&mesh).unwrap();
    assert_eq!(topology.boundary().len(), 2 * (9 + 3));
    assert!(mesh.nodes.iter().all(|p| p[2] == 1.0));
}

fn split() -> impl Strategy<Value = Split> {
    prop::sample::select(SOLID_SPLITS.to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Random bars: volumes are positive and sum to the box, the boundary is a sphere, interfaces are as reported.
    #[test]
    fn random_bars_are_sound(
        splits in prop::collection::vec(split(), 1..5),
        extra in 0usize..4,
        (ny, nz) in (1usize..4, 1usize..4),
        size in prop::array::uniform3(0.1f64..10.0),
        origin in prop::array::uniform3(-5.0f64..5.0),
        insert in any::<bool>(),
    ) {
        let parts: Vec<_> = splits.iter().map(|&s| (linear(family_of(s)), s)).collect();
        let transition = if insert { Transition::InsertPyramids } else { Transition::Keep };
        let spec = BarSpec { size, origin, ..bar(&parts, [parts.len() + extra, ny, nz], transition) };
        let (mesh, report) = generate(&spec).unwrap();
        prop_assert!(!insert || report.mismatches.is_empty());
        check_solid(&spec, &mesh, &report);
    }
}
