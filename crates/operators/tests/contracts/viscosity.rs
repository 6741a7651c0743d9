//! What is promised of viscous forces, for every element and each of its rules.

use crate::sample::{assert_close, distorted, dot, largest, parameters};
use souple_elements::{Element, Rule};
use souple_kernels::Interpreter;
use souple_kernels::conformance::Random;
use souple_operators::{BlockSpec, Elements, Threads};
use souple_program::Costs;
use souple_solver::LinearOperator as _;
use std::sync::Arc;

const ETA: f64 = 0.7;
const ZETA: f64 = 1.9;

/// One distorted, viscous element, and its volume in m³ (in fewer dimensions m², m).
struct Viscous {
    element: &'static Element,
    nodes: Vec<[f64; 3]>,
    elements: Elements,
    volume: f64,
    random: Random,
}

impl Viscous {
    fn new(element: &'static Element, rule: &'static Rule, seed: u64) -> Viscous {
        let mut random = Random::new(seed);
        let nodes = distorted(element, element.dimension(), &mut random);
        // The elastic law is one for small strains: viscosity must not need one that is not.
        let law = souple_laws::by_id("hooke").unwrap();
        let spec = BlockSpec {
            element,
            law,
            rule,
            parameters: parameters(law),
            density: 1.0,
            viscosity: Some([ETA, ZETA]),
            section: 1.0,
            connectivity: (0..nodes.len() as u32).collect(),
            ids: vec![0],
        };
        let threads = Arc::new(Threads::new(1).unwrap());
        let (elements, masses) =
            Elements::new(element.dimension(), &nodes, vec![spec], &Interpreter::default(), threads, Costs::default())
                .unwrap();
        let volume = masses.lumped.iter().sum();
        Viscous { element, nodes, elements, volume, random }
    }

    /// `C(u) v`.
    fn product(&mut self, u: &[f64], v: &[f64]) -> Vec<f64> {
        self.elements.linearise_damping(u);
        let mut out = vec![0.0; v.len()];
        self.elements.add_damping(1.0, v, &mut out);
        out
    }

    /// A random 3 × 3 matrix, zero beyond the dimension.
    fn gradient(&mut self) -> [[f64; 3]; 3] {
        let d = self.element.dimension();
        let mut h = [[0.0; 3]; 3];
        for row in &mut h[..d] {
            row[..d].iter_mut().for_each(|entry| *entry = self.random.between(-0.3, 0.3));
        }
        h
    }

    /// Nodal values of the field `H X`.
    fn homogeneous(&self, h: &[[f64; 3]; 3]) -> Vec<f64> {
        let d = self.element.dimension();
        self.nodes.iter().flat_map(|x| (0..d).map(move |i| (0..3).map(|j| h[i][j] * x[j]).sum())).collect()
    }
}

fn each(check: impl Fn(&mut Viscous, &str)) {
    for (k, &element) in souple_elements::all().iter().enumerate() {
        for id in element.quadratures {
            let mut viscous = Viscous::new(element, Rule::by_id(id).unwrap(), k as u64);
            check(&mut viscous, &format!("{} / {id}", element.id));
        }
    }
}

/// In a homogeneous motion the power that is lost is the volume times that of the strain rate sym(FᵀḢ), computed here
/// without any element: 2η dev:dev + ζ tr².
#[test]
fn homogeneous_motions_lose_the_power_of_the_closed_form() {
    each(|viscous, name| {
        let (h, rate) = (viscous.gradient(), viscous.gradient());
        let (u, v) = (viscous.homogeneous(&h), viscous.homogeneous(&rate));
        let mut strain_rate = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                for k in 0..3 {
                    let f = |a: usize, b: usize| h[a][b] + f64::from(u8::from(a == b));
                    strain_rate[i][j] += 0.5 * (f(k, i) * rate[k][j] + f(k, j) * rate[k][i]);
                }
            }
        }
        let trace = strain_rate[0][0] + strain_rate[1][1] + strain_rate[2][2];
        let squares: f64 = strain_rate.iter().flatten().map(|e| e * e).sum();
        let want = viscous.volume * (2.0 * ETA * (squares - trace * trace / 3.0) + ZETA * trace * trace);
        let got = dot(&v, &viscous.product(&u, &v));
        assert_close(name, &[got], &[want], 1e-11, want);
    });
}

/// Motions that only turn and shift a deformed element meet no viscous force.
#[test]
fn rigid_motions_are_not_damped() {
    each(|viscous, name| {
        let d = viscous.element.dimension();
        let h = viscous.gradient();
        let u = viscous.homogeneous(&h);
        let turn = viscous.gradient();
        let shift: Vec<f64> = (0..d).map(|_| viscous.random.between(-1.0, 1.0)).collect();
        // v = (W − Wᵀ)(X + u) + shift.
        let v: Vec<f64> = viscous
            .nodes
            .iter()
            .zip(u.chunks(d))
            .flat_map(|(x, u)| {
                let place: Vec<f64> = (0..d).map(|k| x[k] + u[k]).collect();
                let turned = |i: usize| (0..d).map(|j| (turn[i][j] - turn[j][i]) * place[j]).sum::<f64>();
                (0..d).map(|i| turned(i) + shift[i]).collect::<Vec<_>>()
            })
            .collect();
        let f = viscous.product(&u, &v);
        assert_close(name, &f, &vec![0.0; f.len()], 1e-12, 1.0 + largest(&v));
    });
}

/// The matrix is symmetric, gives the product, and loses energy in every direction.
#[test]
fn the_matrix_is_symmetric_positive_and_gives_the_product() {
    each(|viscous, name| {
        let h = viscous.gradient();
        let u = viscous.homogeneous(&h);
        let len = u.len();
        let mut random_vector = || -> Vec<f64> { (0..len).map(|_| viscous.random.between(-1.0, 1.0)).collect() };
        let (a, b) = (random_vector(), random_vector());
        let (ca, cb) = (viscous.product(&u, &a), viscous.product(&u, &b));
        assert!(dot(&a, &ca) > -1e-12 * largest(&ca), "{name}");
        assert_close(name, &[dot(&b, &ca)], &[dot(&a, &cb)], 1e-12, len as f64 * largest(&ca));
        let (mut matrix, map) = viscous.elements.pattern();
        viscous.elements.assemble_damping(&u, &map, &mut matrix);
        let mut assembled = vec![0.0; len];
        matrix.apply(&a, &mut assembled);
        assert_close(name, &assembled, &ca, 1e-12, largest(&ca));
    });
}
