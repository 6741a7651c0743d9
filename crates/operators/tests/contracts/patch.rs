//! The patch test: a mesh that mixes hexahedra, prisms, pyramids and tetrahedra reproduces homogeneous deformations.
//!
//! Its quadrangles are parallelograms, so that every rule integrates its forces exactly; `data/affine-patch.txt` holds
//! the mesh and the answers.

use crate::sample::{assert_close, largest};
use souple_elements::Element;
use souple_kernels::Interpreter;
use souple_laws::Law;
use souple_laws::response::{determinant, product, tensor_from_fn, transpose};
use souple_operators::{Average, BlockSpec, Elements, Threads};
use souple_program::Costs;
use std::sync::Arc;

#[derive(Default)]
struct Patch {
    nodes: Vec<[f64; 3]>,
    /// ∫∇N_a, [node][axis] in m².
    g: Vec<[f64; 3]>,
    /// Elements with their nodes, one entry per kind.
    kinds: Vec<(&'static Element, Vec<u32>)>,
    deformations: Vec<Deformation>,
}

struct Deformation {
    name: String,
    /// Deformation gradient, row by row.
    f: Vec<f64>,
    answers: Vec<Answer>,
}

struct Answer {
    law: String,
    energy: f64,
    /// First Piola–Kirchhoff stress in Pa, row by row.
    stress: Vec<f64>,
    parameters: Vec<(String, f64)>,
}

fn patch() -> Patch {
    let mut patch = Patch::default();
    for line in include_str!("../data/affine-patch.txt").lines().filter(|l| !l.starts_with('#')) {
        let words: Vec<&str> = line.split(' ').collect();
        let reals = |words: &[&str]| -> Vec<f64> { words.iter().map(|w| w.parse().unwrap()).collect() };
        match words[0] {
            "node" => {
                let v = reals(&words[1..]);
                patch.nodes.push([v[0], v[1], v[2]]);
                patch.g.push([v[3], v[4], v[5]]);
            }
            "element" => {
                let element = souple_elements::by_id(words[1]).unwrap();
                if patch.kinds.last().is_none_or(|k| k.0.id != element.id) {
                    patch.kinds.push((element, Vec::new()));
                }
                let nodes = words[2..].iter().map(|w| w.parse::<u32>().unwrap());
                patch.kinds.last_mut().unwrap().1.extend(nodes);
            }
            "deformation" => {
                let (name, f) = (words[1].into(), reals(&words[2..]));
                patch.deformations.push(Deformation { name, f, answers: Vec::new() });
            }
            _ => {
                let parameter = |w: &&str| {
                    let (name, value) = w.split_once('=').unwrap();
                    (name.to_string(), value.parse().unwrap())
                };
                let answer = Answer {
                    law: words[1].into(),
                    energy: words[2].parse().unwrap(),
                    stress: reals(&words[3..12]),
                    parameters: words[12..].iter().map(parameter).collect(),
                };
                patch.deformations.last_mut().unwrap().answers.push(answer);
            }
        }
    }
    patch
}

/// The mesh with one law, and with rule number `rule` of each element (its last one where it has fewer).
fn model(patch: &Patch, law: &'static Law, parameters: &[f64], rule: usize) -> Elements {
    let specs = patch.kinds.iter().map(|(element, connectivity)| {
        let name = element.quadratures[rule.min(element.quadratures.len() - 1)];
        BlockSpec {
            element,
            law,
            rule: element.rule(name).unwrap(),
            parameters: parameters.to_vec(),
            density: 1000.0,
            viscosity: None,
            section: 1.0,
            connectivity: connectivity.clone(),
            ids: (0..(connectivity.len() / element.node_count()) as u32).collect(),
        }
    });
    let threads = Arc::new(Threads::new(1).unwrap());
    Elements::new(3, &patch.nodes, specs.collect(), &Interpreter::default(), threads, Costs::default()).unwrap().0
}

/// Energy, nodal forces and stresses of homogeneous deformations are exact to round-off with every listed rule, and
/// interior nodes have no force.
#[test]
fn mixed_mesh_reproduces_homogeneous_deformations() {
    let patch = patch();
    assert_eq!(patch.kinds.len(), 4, "the four solids");
    let rules = patch.kinds.iter().map(|k| k.0.quadratures.len()).max().unwrap();
    let mut compared = 0;
    for law in souple_laws::all() {
        // A law has the same parameters in all deformations; one that the data do not know is tested elsewhere.
        let Some(known) = patch.deformations[0].answers.iter().find(|a| a.law == law.id) else { continue };
        let value = |name: &str| known.parameters.iter().find(|p| p.0 == name).map(|p| p.1);
        let parameters: Option<Vec<f64>> = law.parameters.iter().map(|p| value(p.name).or(p.default)).collect();
        let parameters = parameters.unwrap_or_else(|| panic!("data/affine-patch.txt lacks a parameter of {}", law.id));
        for rule in 0..rules {
            let mut elements = model(&patch, law, &parameters, rule);
            elements.prepare_means(&[Average::Stress], &Interpreter::default(), Costs::default()).unwrap();
            for case in &patch.deformations {
                let answer = case.answers.iter().find(|a| a.law == law.id).unwrap();
                check(&patch, &mut elements, case, answer, rule);
                compared += 1;
            }
        }
    }
    assert!(compared >= 2 * 4 * rules, "Hooke and St.Venant–Kirchhoff at least");
}

fn check(patch: &Patch, elements: &mut Elements, case: &Deformation, answer: &Answer, rule: usize) {
    let what = format!("{}, {}, rule {rule}", answer.law, case.name);
    let gradient = |i: usize, j: usize| case.f[3 * i + j] - if i == j { 1.0 } else { 0.0 };
    let move_by = |x: &[f64; 3], i: usize| (0..3).map(|j| gradient(i, j) * x[j]).sum::<f64>();
    let u: Vec<f64> = patch.nodes.iter().flat_map(|x| (0..3).map(move |i| move_by(x, i))).collect();
    let expected: Vec<f64> = patch
        .g
        .iter()
        .flat_map(|g| (0..3).map(move |i| -(0..3).map(|j| answer.stress[3 * i + j] * g[j]).sum::<f64>()))
        .collect();
    let scale = largest(&expected);
    let mut force = vec![0.0; u.len()];
    elements.add_force(&u, &mut force);
    assert_close(&what, &force, &expected, 1e-12, scale);
    assert_close(&what, &[elements.energy(&u)], &[answer.energy], 1e-12, answer.energy);
    // Every element shows the Cauchy stress P Fᵀ/J; of Hooke's law, P itself.
    let f = tensor_from_fn(|i, j| case.f[3 * i + j]);
    let piola = tensor_from_fn(|i, j| answer.stress[3 * i + j]);
    let objective = souple_laws::by_id(&answer.law).unwrap().objective;
    let stress =
        if objective { product(&piola, &transpose(&f)).map(|row| row.map(|s| s / determinant(&f))) } else { piola };
    let stress = [stress[0][0], stress[1][1], stress[2][2], stress[0][1], stress[1][2], stress[2][0]];
    elements.each_mean(Average::Stress, &u, |id, mean| {
        assert_close(&format!("{what}, element {id}"), &mean.tensor, &stress, 1e-12, largest(&stress));
    });
    let inner: Vec<usize> = (0..patch.g.len()).filter(|&a| patch.g[a] == [0.0; 3]).collect();
    assert_eq!(inner.len(), 6, "interior nodes");
    for a in inner {
        assert_close(&what, &force[3 * a..3 * a + 3], &[0.0; 3], 1e-12, scale);
    }
}
