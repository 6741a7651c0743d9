//! Forces and tractions as forces on nodes.
//!
//! A traction t on faces does the work of the nodal forces f_a = ∫ N_a t dA over the rest shape; as Σ N_a = 1, they sum
//! to t times the area. The shape functions are those of the face's element, differentiated by the expression graph:
//! dA = |∂x/∂ξ × ∂x/∂η| dξ dη on a face, dA = |∂x/∂ξ| dξ × 1 m on an edge of a plane body. A body of membranes alone is
//! loaded on the membranes themselves.

use super::Load;
use super::error::Findings;
use super::regions::{Needs, Place, described, select};
use souple_elements::Element;
use souple_mesh::topology::Topology;
use souple_scene::keyframes::Keyframe;
use souple_scene::load::ForceAmount;
use souple_symbols::{Expr, Graph, Time};

/// Adds the body's loads.
pub(super) fn load(place: Place<'_>, loads: &mut Vec<Load>, findings: &mut Findings) {
    let first = place.body.first_node;
    for force in &place.scene.forces {
        let Some(selected) = select(place, &force.region, Needs::Nodes, findings) else { continue };
        let each = match force.amount {
            ForceAmount::Total(total) => total.map(|x| x / selected.nodes.len() as f64),
            ForceAmount::PerNode(each) => each,
        };
        let forces = selected.nodes.iter().map(|n| (n + first, each)).collect();
        loads.push(Load { forces, factor: factor(&force.factor) });
    }
    if place.scene.tractions.is_empty() {
        return;
    }
    let skin = if place.body.mesh.dimension() < place.body.dimension {
        Skin::of_membranes(place)
    } else {
        match Topology::new(&place.body.mesh) {
            Ok(topology) => Skin::of_solids(place, &topology),
            Err(error) => {
                findings.problem(&place.scene.mesh.at, format!("mesh of body \"{}\": {error}", *place.scene.name));
                return;
            }
        }
    };
    for traction in &place.scene.tractions {
        let Some(selected) = select(place, &traction.region, Needs::Nodes, findings) else { continue };
        let Some(weights) = skin.weights(&selected.nodes) else {
            let message = format!(
                "region {} selects nothing that a traction could act on: it holds {} nodes of body \"{}\", but all nodes \
                 of no face of its surface; widen the region, or use [[body.force]]",
                described(&traction.region),
                selected.nodes.len(),
                *place.scene.name
            );
            findings.problem(&traction.region.at, message);
            continue;
        };
        let forces = weights.iter().map(|(n, area)| (n + first, traction.traction.map(|t| t * area))).collect();
        loads.push(Load { forces, factor: factor(&traction.factor) });
    }
}

fn factor(keys: &[Keyframe<f64>]) -> Vec<(f64, f64)> {
    keys.iter().map(|key| (key.time, key.value)).collect()
}

/// The faces of a body's surface.
struct Skin<'s> {
    place: Place<'s>,
    /// Element and nodes (numbers in the body) of each face.
    faces: Vec<(&'static Element, Vec<u32>)>,
    tables: Vec<FaceTable>,
}

impl<'s> Skin<'s> {
    /// The membranes themselves; cables have no faces.
    fn of_membranes(place: Place<'s>) -> Skin<'s> {
        let blocks = || place.body.mesh.blocks.iter().filter(|b| b.element.dimension() == 2);
        let faces = blocks().flat_map(|b| (0..b.len()).map(|index| (b.element, b.nodes(index).to_vec())));
        let mut tables: Vec<FaceTable> = Vec::new();
        for block in blocks() {
            if !tables.iter().any(|table| table.id == block.element.id) {
                tables.push(FaceTable::new(block.element));
            }
        }
        Skin { place, faces: faces.collect(), tables }
    }

    fn of_solids(place: Place<'s>, topology: &Topology) -> Skin<'s> {
        let mut faces = Vec::new();
        let mut tables: Vec<FaceTable> = Vec::new();
        // Faces that do not match those that they lie on are inside the body.
        for face in place.body.conformity.skin(topology) {
            let element = topology.run(face.element()).element;
            // Ends of an edge are points, without area.
            let Some(side) = element.faces.get(face.face()) else { continue };
            let Some(side_element) = souple_elements::by_id(side.element) else { continue };
            let of_element = place.body.mesh.nodes_of(topology.id(face.element()));
            faces.push((side_element, side.nodes.iter().map(|&n| of_element[n as usize]).collect()));
            if !tables.iter().any(|table| table.id == side.element) {
                tables.push(FaceTable::new(side_element));
            }
        }
        Skin { place, faces, tables }
    }

    /// ∫ N_a dA (m²) over the faces all of whose nodes are in the sorted list, by node of the body, sorted; `None`
    /// when there is no such face.
    fn weights(&self, nodes: &[u32]) -> Option<Vec<(u32, f64)>> {
        let mut weights = vec![0.0; nodes.len()];
        let mut slots = Vec::new();
        let mut any = false;
        for (element, face) in &self.faces {
            slots.clear();
            slots.extend(face.iter().map_while(|n| nodes.binary_search(n).ok()));
            if slots.len() < face.len() {
                continue;
            }
            any = true;
            let positions: Vec<[f64; 3]> = face.iter().map(|&n| self.place.body.mesh.nodes[n as usize]).collect();
            let table = self.tables.iter().find(|t| t.id == element.id).expect("every face's element has a table");
            for point in &table.points {
                let area = point.weight * point.area_ratio(&positions);
                slots.iter().zip(&point.shape).for_each(|(&slot, shape)| weights[slot] += shape * area);
            }
        }
        any.then(|| nodes.iter().copied().zip(weights).filter(|(_, weight)| *weight != 0.0).collect())
    }
}

/// Shape functions of a face at its quadrature points.
pub(super) struct FaceTable {
    id: &'static str,
    points: Vec<FacePoint>,
}

struct FacePoint {
    weight: f64,
    /// N_a, `[node]`.
    shape: Vec<f64>,
    /// ∂N_a/∂ξ_k, `[axis of the face][node]`.
    slopes: Vec<Vec<f64>>,
}

impl FaceTable {
    pub(super) fn new(element: &'static Element) -> FaceTable {
        let mut graph = Graph::new();
        let xi = ["xi", "eta", "zeta"].map(|name| graph.symbol(name, Time::Derive));
        let shape = (element.shape)(&mut graph, xi);
        let one = graph.int(1);
        let slopes: Vec<Vec<Expr>> =
            xi[..element.dimension()].iter().map(|&axis| graph.directional(&shape, &[(axis, one)])).collect();
        let rule = element.default_rule();
        let points = rule.points.iter().zip(&rule.weights).map(|(point, &weight)| {
            let values: Vec<(Expr, f64)> = xi.into_iter().zip(*point).collect();
            let slopes = slopes.iter().map(|axis| graph.evaluate(axis, &values)).collect();
            FacePoint { weight, shape: graph.evaluate(&shape, &values), slopes }
        });
        FaceTable { id: element.id, points: points.collect() }
    }

    /// ∂x/∂ξ_k at each point, `[point][axis of the face]`.
    pub(super) fn tangents(&self, positions: &[[f64; 3]]) -> Vec<Vec<[f64; 3]>> {
        self.points.iter().map(|point| point.slopes.iter().map(|slopes| tangent(slopes, positions)).collect()).collect()
    }
}

impl FacePoint {
    /// Area (length times 1 m) per area of the reference face.
    fn area_ratio(&self, positions: &[[f64; 3]]) -> f64 {
        let norm = |v: [f64; 3]| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        match self.slopes.as_slice() {
            [along, across] => {
                let (t, s) = (tangent(along, positions), tangent(across, positions));
                norm([t[1] * s[2] - t[2] * s[1], t[2] * s[0] - t[0] * s[2], t[0] * s[1] - t[1] * s[0]])
            }
            [along] => norm(tangent(along, positions)),
            _ => 0.0,
        }
    }
}

/// Σ_a x_a ∂N_a/∂ξ.
fn tangent(slopes: &[f64], positions: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|a| positions.iter().zip(slopes).map(|(x, slope)| x[a] * slope).sum())
}
