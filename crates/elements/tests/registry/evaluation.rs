//! Numbers from an element's expressions: values and gradients of its shape functions at points, Jacobians, and an
//! integrator that owes nothing to the rule files.

use souple_elements::{Element, Family, all, by_id};
use souple_symbols::{Expr, Graph, Time};

pub(crate) type Point = [f64; 3];

/// The shape functions of one element and their derivatives, ready to evaluate.
pub(crate) struct Interpolation {
    graph: Graph,
    coordinates: [Expr; 3],
    values: Vec<Expr>,
    /// [node, axis].
    gradients: Vec<Expr>,
}

impl Interpolation {
    pub(crate) fn of(element: &Element) -> Interpolation {
        let mut graph = Graph::new();
        let coordinates = ["xi", "eta", "zeta"].map(|name| graph.symbol(name, Time::Apply));
        let values = (element.shape)(&mut graph, coordinates);
        assert_eq!(values.len(), element.node_count(), "{}: one shape function per node", element.id);
        let mut gradients = Vec::new();
        for &value in &values {
            gradients.extend(coordinates.map(|x| graph.derivative(value, x)));
        }
        Interpolation { graph, coordinates, values, gradients }
    }

    pub(crate) fn of_id(id: &str) -> Interpolation {
        Interpolation::of(by_id(id).unwrap_or_else(|| panic!("no element is called {id}")))
    }

    fn evaluate(&self, roots: &[Expr], point: Point) -> Vec<f64> {
        let known: Vec<(Expr, f64)> = self.coordinates.into_iter().zip(point).collect();
        self.graph.evaluate(roots, &known)
    }

    /// N_a, [node].
    pub(crate) fn values(&self, point: Point) -> Vec<f64> {
        self.evaluate(&self.values, point)
    }

    /// ∂N_a/∂ξ_j, [node][axis].
    pub(crate) fn gradients(&self, point: Point) -> Vec<Point> {
        self.evaluate(&self.gradients, point).chunks_exact(3).map(|g| [g[0], g[1], g[2]]).collect()
    }
}

/// Σ N_a x_a.
pub(crate) fn combine(values: &[f64], positions: &[Point]) -> Point {
    let mut sum = [0.0; 3];
    for (value, position) in values.iter().zip(positions) {
        for axis in 0..3 {
            sum[axis] += value * position[axis];
        }
    }
    sum
}

/// ∂x_i/∂ξ_j = Σ x_a,i ∂N_a/∂ξ_j, [i][j]; the axes beyond the element's dimension are those of the identity, so that
/// the determinant is the one of its own dimension.
pub(crate) fn jacobian(dimension: usize, gradients: &[Point], positions: &[Point]) -> [Point; 3] {
    let mut matrix = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for i in 0..dimension {
        for j in 0..dimension {
            matrix[i][j] = gradients.iter().zip(positions).map(|(g, x)| x[i] * g[j]).sum();
        }
    }
    matrix
}

/// Cofactors of a 3 × 3 matrix: cof(J) = det(J) J⁻ᵀ.
pub(crate) fn cofactors(m: &[Point; 3]) -> [Point; 3] {
    let [a, b, c] = *m;
    [cross(b, c), cross(c, a), cross(a, b)]
}

pub(crate) fn determinant(m: &[Point; 3]) -> f64 {
    dot(m[0], cofactors(m)[0])
}

pub(crate) fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn centroid(positions: &[Point]) -> Point {
    combine(&vec![1.0 / positions.len() as f64; positions.len()], positions)
}

/// Node positions of an element whose corners have moved by up to a tenth of its size, each differently, and whose
/// sides are as straight as the linear element of its family keeps them.
pub(crate) fn distorted(element: &Element) -> Vec<Point> {
    let family = element.family;
    let linear = all().iter().find(|e| e.family == family).expect("each family has a linear element");
    let corners: Vec<Point> = element.nodes[..family.corner_count()]
        .iter()
        .enumerate()
        .map(|(node, x)| {
            let mut moved = *x;
            for axis in 0..family.dimension() {
                moved[axis] += 0.1 * (7.3 * node as f64 + 2.1 * axis as f64 + 1.0).sin();
            }
            moved
        })
        .collect();
    let map = Interpolation::of(linear);
    let others = element.nodes[corners.len()..].iter().map(|&node| combine(&map.values(node), &corners));
    let mut positions = corners.clone();
    positions.extend(others);
    positions
}

/// Points and weights of a product of eight-point Gauss rules on a cell, collapsed where the cell is: exact far beyond
/// the degrees in use, also for the rational functions of pyramids.
pub(crate) fn fine_rule(family: Family) -> Vec<(Point, f64)> {
    let line = gauss_legendre(8);
    let unit: Vec<(f64, f64)> = line.iter().map(|(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
    let mut rule = Vec::new();
    for i in 0..8 {
        for j in 0..8 {
            for k in 0..8 {
                let ((x, wx), (y, wy), (z, wz)) = (line[i], line[j], line[k]);
                let ((r, wr), (s, ws), (t, wt)) = (unit[i], unit[j], unit[k]);
                let plane = (r * (1.0 - s), s, wr * ws * (1.0 - s));
                let up = (1.0 - t) * (1.0 - t);
                let (point, weight) = match family {
                    Family::Edge => ([x, 0.0, 0.0], wx * wy * wz / 4.0),
                    Family::Quadrangle => ([x, y, 0.0], wx * wy * wz / 2.0),
                    Family::Hexahedron => ([x, y, z], wx * wy * wz),
                    Family::Triangle => ([plane.0, plane.1, 0.0], plane.2 * wt),
                    Family::Prism => ([plane.0, plane.1, z], plane.2 * wz),
                    Family::Tetrahedron => ([plane.0 * (1.0 - t), plane.1 * (1.0 - t), t], plane.2 * up * wt),
                    Family::Pyramid => ([x * (1.0 - t), y * (1.0 - t), t], wx * wy * wt * up),
                };
                rule.push((point, weight));
            }
        }
    }
    rule
}

/// Gauss-Legendre points and weights on [−1, 1] by Newton's method on the three-term recurrence.
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut before, mut now) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
                }
                slope = n as f64 * (x * now - before) / (x * x - 1.0);
                x -= now / slope;
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}
