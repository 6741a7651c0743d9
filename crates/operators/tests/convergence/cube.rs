//! Distorted meshes of the unit interval, square or cube, of one element each.

use souple_elements::Element;
use souple_mesh::bar::{BarSpec, Section, Split, Transition, generate};
use souple_mesh::{Mesh, with_elements};
use std::f64::consts::PI;

/// How a regular mesh is distorted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Distortion {
    /// By a smooth map of the domain onto itself that moves points by up to a twelfth of its width. Nodes inside edges and
    /// faces lie on the map, so elements of higher degree are curved; the finer the mesh, the nearer is each element to a
    /// parallelepiped, while its shape differs from that of its neighbours.
    Smooth,
    /// Into congruent trapezoids with parallel sides of ¾ and 5⁄4 of a cell, whatever the size of the cells: elements do not
    /// become parallelograms. For quadrangles, with an even number of cells.
    Trapezoids,
}

/// A mesh of `cells` cells along each axis.
pub(crate) fn mesh(element: &'static Element, cells: usize, distortion: Distortion) -> Mesh {
    let d = element.dimension();
    let regular = |element| {
        let spec = BarSpec {
            size: [1.0; 3],
            cells: [cells; 3],
            origin: [0.0; 3],
            sections: vec![Section { until: 1.0, element, split: Split::Usual }],
            transition: Transition::Keep,
        };
        generate(&spec).unwrap().0
    };
    match distortion {
        Distortion::Smooth => {
            let mut mesh = regular(element);
            mesh.nodes.iter_mut().for_each(|x| *x = moved(*x, d));
            mesh
        }
        Distortion::Trapezoids => {
            assert!(cells.is_multiple_of(2) && d == 2, "trapezoids come in pairs of rows");
            let linear = souple_elements::all().iter().find(|e| e.family == element.family).unwrap();
            let mut mesh = regular(linear);
            for x in &mut mesh.nodes {
                let [column, row] = [0, 1].map(|axis| (x[axis] * cells as f64).round() as usize);
                if !row.is_multiple_of(2) {
                    let up = if column.is_multiple_of(2) { 1.0 } else { -1.0 };
                    x[1] += up * 0.25 / cells as f64;
                }
            }
            with_elements(&mesh, |_| element).unwrap()
        }
    }
}

/// x_i = ξ_i + ⅓ ξ_i (1 − ξ_i) sin(π (ξ_j + ξ_k/2 + (i + 1)/2)): faces of the cube stay where they are.
fn moved(xi: [f64; 3], dimension: usize) -> [f64; 3] {
    let mut x = xi;
    for i in 0..dimension {
        let (j, k) = ((i + 1) % dimension, (i + 2) % dimension);
        let wave = (PI * (xi[j] + 0.5 * xi[k] + 0.5 * (i + 1) as f64)).sin();
        x[i] += xi[i] * (1.0 - xi[i]) * wave / 3.0;
    }
    x
}

/// Indices of the unknowns on the boundary, [node, axis].
pub(crate) fn boundary(mesh: &Mesh, dimension: usize) -> Vec<usize> {
    let outside = |x: &[f64; 3]| x[..dimension].iter().any(|&c| c.abs() < 1e-12 || (c - 1.0).abs() < 1e-12);
    let nodes = mesh.nodes.iter().enumerate().filter(|(_, x)| outside(x));
    nodes.flat_map(|(n, _)| (0..dimension).map(move |axis| dimension * n + axis)).collect()
}

/// Meshes are conforming and right side out, fill the domain, hold nothing but the element, and are distorted.
#[test]
fn meshes_fill_the_domain_and_are_distorted() {
    for element in souple_elements::all() {
        let mesh = mesh(element, 3, Distortion::Smooth);
        assert!(mesh.blocks.len() == 1 && mesh.blocks[0].element.id == element.id, "{}", element.id);
        let report = souple_mesh::check::report(&mesh).unwrap();
        let wrong = [&report.inverted, &report.tangled, &report.degenerate];
        assert!(wrong.iter().all(|w| w.is_empty()), "{}: {report:?}", element.id);
        assert!(report.unreferenced.is_empty() && report.duplicates.is_empty(), "{}: {report:?}", element.id);
        assert!((report.measure - 1.0).abs() < 1e-12, "{}: {} instead of 1", element.id, report.measure);
        if element.dimension() > 1 {
            let best = souple_mesh::check::report(&self::mesh(element, 1, Distortion::Smooth)).unwrap();
            let (regular, distorted) = (best.quality.unwrap().min, report.quality.unwrap().min);
            assert!(distorted < 0.95 * regular, "{}: {distorted} of {regular}", element.id);
        }
    }
}
