//! A mesh with every element of the registry, to be written and read back.

use souple_elements::{Element, all};
use souple_mesh::{ElementId, Mesh, Region};

/// Two of each element that `wanted` lets through, apart from each other, positively oriented and not axis-parallel;
/// one node that no element has; regions of every sort.
pub(crate) fn menagerie(wanted: impl Fn(&Element) -> bool) -> Mesh {
    let mut mesh = Mesh { nodes: vec![[-1.5, 1.0 / 3.0, 1e-7]], ..Mesh::default() };
    for (at, element) in all().iter().copied().filter(|e| wanted(e)).enumerate() {
        for copy in 0..2 {
            let first = mesh.nodes.len() as u32;
            mesh.nodes.extend(element.nodes.iter().map(|[x, y, z]| {
                let (dx, dy) = (4.0 * at as f64, 4.0 * f64::from(copy));
                [dx + x + 0.1 * y, dy + y + 0.2 * z, z - 0.1 * x]
            }));
            let end = mesh.nodes.len() as u32;
            mesh.block_mut(element).connectivity.extend(first..end);
        }
    }
    let id = |block: usize, index: u32| ElementId { block: block as u32, index };
    let all_of = |elements: Vec<ElementId>| {
        let mut nodes: Vec<u32> =
            elements.iter().flat_map(|e| mesh.blocks[e.block as usize].nodes(e.index as usize)).copied().collect();
        nodes.sort_unstable();
        Region { nodes, elements }
    };
    let solids = (0..mesh.blocks.len()).filter(|&b| mesh.blocks[b].element.dimension() == 3);
    let others = (0..mesh.blocks.len()).filter(|&b| mesh.blocks[b].element.dimension() < 3);
    let regions = [
        // One element is in no region at all.
        ("nearly all", all_of((0..mesh.blocks.len()).flat_map(|b| [id(b, 0), id(b, 1)]).skip(1).collect())),
        ("solids", all_of(solids.flat_map(|b| [id(b, 0), id(b, 1)]).collect())),
        // Every second element, so that memberships alternate inside a block.
        ("second ones", all_of((0..mesh.blocks.len()).map(|b| id(b, 1)).collect())),
        ("skin", all_of(others.flat_map(|b| [id(b, 0), id(b, 1)]).skip(1).collect())),
        ("some nodes", Region { nodes: vec![0, 3, 4, 11], elements: Vec::new() }),
        ("more_nodes", Region { nodes: vec![3, 12], elements: Vec::new() }),
        ("nothing", Region::default()),
    ];
    let mut with_extra = all_of(vec![id(1, 0)]);
    with_extra.nodes.insert(0, 0);
    mesh.regions = regions.into_iter().map(|(name, region)| (name.to_owned(), region)).collect();
    mesh.regions.insert("an element & <a node>".to_owned(), with_extra);
    mesh
}
