//! Orders promise: they are permutations, they change numbers and nothing else, and they make the band narrow.

#![expect(clippy::unwrap_used, reason = "a panic is how a test fails")]

use proptest::prelude::*;
use souple_elements::by_id;
use souple_mesh::Mesh;
use souple_mesh::bar::{BarSpec, Section, Split, Transition, generate};
use souple_mesh::numbering::{OrderError, bandwidth, renumber_nodes, reverse_cuthill_mckee, sort_elements};

fn bar() -> Mesh {
    let section = |until, id: &str| Section { until, element: by_id(id).unwrap(), split: Split::Usual };
    let sections = vec![section(0.5, "prism6"), section(1.0, "tet4")];
    let spec =
        BarSpec { size: [5.0, 1.0, 1.0], cells: [40, 2, 3], origin: [0.0; 3], sections, transition: Transition::Keep };
    generate(&spec).unwrap().0
}

/// Elements as positions, and regions as positions: what no renumbering may change.
fn shape(mesh: &Mesh) -> (Vec<String>, Vec<String>) {
    let mut elements: Vec<String> = mesh
        .element_ids()
        .map(|e| format!("{:?}", mesh.nodes_of(e).iter().map(|&n| mesh.nodes[n as usize]).collect::<Vec<_>>()))
        .collect();
    elements.sort();
    let mut regions = Vec::new();
    for (name, region) in &mesh.regions {
        let mut nodes: Vec<String> = region.nodes.iter().map(|&n| format!("{:?}", mesh.nodes[n as usize])).collect();
        let mut centres: Vec<String> = region.elements.iter().map(|&e| format!("{:.9?}", mesh.centroid(e))).collect();
        nodes.sort();
        centres.sort();
        assert!(region.nodes.is_sorted() && region.elements.is_sorted());
        regions.push(format!("{name} {nodes:?} {centres:?}"));
    }
    (elements, regions)
}

/// Nodes of one slice of the bar.
const SLICE: u32 = 3 * 4;

/// A bar numbered along its length is renumbered in waves that run along it: the band is that of three slices at most
/// (a wave starts at a corner and is skewed by one slice).
#[test]
fn bands_become_narrow() {
    let mut mesh = bar();
    let wide = bandwidth(&mesh);
    let order = reverse_cuthill_mckee(&mesh);
    renumber_nodes(&mut mesh, &order).unwrap();
    assert_eq!(wide, 41 * 4 + 1);
    assert!(bandwidth(&mesh) <= 3 * SLICE, "{}", bandwidth(&mesh));
}

/// Nodes of nothing come last, separate pieces follow each other, and an empty mesh has an empty order.
#[test]
fn pieces_and_loose_nodes() {
    let mut mesh = Mesh { nodes: vec![[0.0; 3]; 6], ..Mesh::default() };
    mesh.block_mut(by_id("edge2").unwrap()).connectivity.extend([1, 5, 2, 4]);
    let order = reverse_cuthill_mckee(&mesh);
    assert_eq!(&order[4..], [0, 3]);
    renumber_nodes(&mut mesh, &order).unwrap();
    assert_eq!(bandwidth(&mesh), 1);
    assert!(reverse_cuthill_mckee(&Mesh::default()).is_empty());
}

/// An order that is not one is refused and changes nothing.
#[test]
fn wrong_orders_are_refused() {
    let mut mesh = bar();
    let count = mesh.nodes.len();
    assert_eq!(renumber_nodes(&mut mesh, &[0, 1]), Err(OrderError::Length { given: 2, expected: count }));
    let mut order: Vec<u32> = (0..count as u32).collect();
    order[5] = 4;
    assert_eq!(renumber_nodes(&mut mesh, &order), Err(OrderError::Entry { position: 5, node: 4 }));
    order[5] = count as u32;
    assert_eq!(renumber_nodes(&mut mesh, &order), Err(OrderError::Entry { position: 5, node: count as u32 }));
    assert_eq!(shape(&mesh), shape(&bar()));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]

    /// From any numbering, both orders keep the shape, and the band never exceeds three slices.
    #[test]
    fn shapes_are_kept(order in Just((0..492u32).collect::<Vec<u32>>()).prop_shuffle()) {
        let original = bar();
        prop_assert_eq!(original.nodes.len(), 492);
        let mut mesh = original.clone();
        renumber_nodes(&mut mesh, &order).unwrap();
        prop_assert_eq!(shape(&mesh), shape(&original));
        let back = reverse_cuthill_mckee(&mesh);
        renumber_nodes(&mut mesh, &back).unwrap();
        let orders = sort_elements(&mut mesh);
        prop_assert_eq!(shape(&mesh), shape(&original));
        prop_assert!(bandwidth(&mesh) <= 3 * SLICE);
        for (block, order) in mesh.blocks.iter().zip(&orders) {
            let lowest: Vec<u32> = (0..block.len()).filter_map(|e| block.nodes(e).iter().copied().min()).collect();
            prop_assert!(lowest.is_sorted());
            let mut sorted = order.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..block.len() as u32).collect::<Vec<_>>());
        }
    }
}
