//! Cables and membranes: what is promised of them beside what is promised of every element, that is, their kinematics
//! and that there is no stress across them.

use crate::sample::{SECTION, Sample, assert_close, dot, each, largest, one_element, parameters};
use souple_elements::Element;
use souple_kernels::Interpreter;
use souple_kernels::conformance::Random;
use souple_laws::response::Tensor;
use souple_laws::{Law, Response};
use souple_operators::{Average, BlockSpec, Elements, Threads};
use souple_program::Costs;
use std::sync::Arc;

/// A rotation by Euler angles.
fn rotation(random: &mut Random) -> Tensor {
    let turn = |a: f64, i: usize, j: usize| {
        let mut r = [[0.0; 3]; 3];
        (0..3).for_each(|k| r[k][k] = 1.0);
        (r[i][i], r[i][j], r[j][i], r[j][j]) = (a.cos(), -a.sin(), a.sin(), a.cos());
        r
    };
    let product = |a: &Tensor, b: &Tensor| -> Tensor {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    };
    let [a, b, c] = [0, 1, 2].map(|_| random.between(-3.0, 3.0));
    product(&product(&turn(a, 0, 1), &turn(b, 1, 2)), &turn(c, 2, 0))
}

fn turned(r: &Tensor, x: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| dot(&r[i], x))
}

/// A law without a direction: what it says does not depend on where space points.
fn isotropic(law: &Law) -> bool {
    law.arguments().iter().all(|a| matches!(a, souple_laws::Argument::Number(_)))
}

/// The rest shape turned as a whole, with displacements turned likewise, has the same energy and turned forces: for every
/// isotropic law, small-strain laws included.
#[test]
fn a_turned_rest_shape_has_turned_forces() {
    let compared = std::cell::Cell::new(0);
    each(|sample| {
        if !sample.embedded() || sample.space < 3 || !isotropic(sample.law) {
            return;
        }
        let r = rotation(&mut sample.random);
        let nodes: Vec<[f64; 3]> = sample.nodes.iter().map(|x| turned(&r, x)).collect();
        let Sample { element, law, rule, density, .. } = *sample;
        let (mut other, _) = one_element(element, law, rule, 3, &nodes, density);
        let u = sample.displacement();
        let turn = |v: &[f64]| -> Vec<f64> { v.chunks(3).flat_map(|x| turned(&r, &[x[0], x[1], x[2]])).collect() };
        let mut forces = vec![0.0; u.len()];
        other.add_force(&turn(&u), &mut forces);
        let expected = turn(&sample.force(&u));
        assert_close(&sample.name(), &forces, &expected, 1e-11, largest(&expected));
        let (w, v) = (sample.elements.energy(&u), other.energy(&turn(&u)));
        assert_close(&sample.name(), &[v], &[w], 1e-10, w.max(1e-4));
        compared.set(compared.get() + 1);
    });
    assert!(compared.get() >= 20, "{} elements", compared.get());
}

/// One flat element in the plane of x and y (an edge along x) under stretches along the axes: the volume ratio tells the
/// stretch across, and at it the law, evaluated on its own in three dimensions, has no stress across and the energy
/// density of the element; its mean stress is the law's.
#[test]
fn there_is_no_stress_across_at_large_stretches() {
    let cases = [("tri3", 2), ("edge2", 1)];
    for &law in souple_laws::all() {
        for (element, d) in cases {
            let element = souple_elements::by_id(element).unwrap();
            let given = parameters(law);
            // A direction along the element, so that the axes stay principal.
            let given: Vec<f64> = law.parameters.iter().zip(given).map(|(p, v)| along_x(p.name, v)).collect();
            let nodes = element.nodes.to_vec();
            let mut elements = one(element, law, &nodes, &given);
            elements.prepare_means(&[Average::Stress], &Interpreter::default(), Costs::default()).unwrap();
            let response = Response::new(law, &given).unwrap();
            let volume = element.family.reference_measure() * SECTION;
            for stretches in [[1.0, 1.0], [1.3, 0.9], [0.7, 0.75], [1.8, 1.1], [0.95, 1.6]] {
                let [x, y] = stretches;
                let u: Vec<f64> = nodes.iter().flat_map(|p| [(x - 1.0) * p[0], (y - 1.0) * p[1], 0.0]).collect();
                let mut deformed = f64::NAN;
                elements.each_volume(&u, |_, v| deformed = v);
                let ratio = deformed / volume;
                // A law whose strain across is linear in that along can ask for less than no thickness: that is told.
                if ["stvk", "transverse-stvk"].contains(&law.id) && stretches == [1.8, 1.1] && d == 2 {
                    assert_eq!(elements.crushed(&u, 0.0).len(), 1, "{} / {}: {ratio}", element.id, law.id);
                    continue;
                }
                let f = if d == 2 {
                    [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, ratio / (x * y)]]
                } else {
                    let across = (ratio / x).sqrt();
                    [[x, 0.0, 0.0], [0.0, across, 0.0], [0.0, 0.0, across]]
                };
                let what = format!("{} / {} at {stretches:?}", element.id, law.id);
                let stress = response.stress(&f);
                // The slope of the normal stress, about Young's modulus, times the stretch: what a residual is compared with.
                let size = 1.0 + stress[0][0].abs();
                assert!(stress[2][2].abs() < 1e-9 * size, "{what}: stress across {:e}", stress[2][2]);
                assert_close(&what, &[elements.energy(&u)], &[volume * response.energy(&f)], 1e-11, volume);
                let mut mean = [f64::NAN; 6];
                elements.each_mean(Average::Stress, &u, |_, m| mean = m.tensor);
                // Cauchy: σ_xx = P_xx F_xx / J; a small-strain law's stress is P.
                let along = if law.objective { stress[0][0] * x / ratio } else { stress[0][0] };
                assert_close(&what, &[mean[0], mean[2]], &[along, 0.0], 1e-9, size);
            }
        }
    }
}

fn along_x(name: &str, value: f64) -> f64 {
    match name {
        "direction_x" => 1.0,
        "direction_y" | "direction_z" => 0.0,
        _ => value,
    }
}

fn one(element: &'static Element, law: &'static Law, nodes: &[[f64; 3]], parameters: &[f64]) -> Elements {
    let spec = BlockSpec {
        element,
        law,
        rule: element.default_rule(),
        parameters: parameters.to_vec(),
        density: 1.0,
        viscosity: None,
        section: SECTION,
        connectivity: (0..nodes.len() as u32).collect(),
        ids: vec![0],
    };
    let threads = Arc::new(Threads::new(1).unwrap());
    Elements::new(3, nodes, vec![spec], &Interpreter::default(), threads, Costs::default()).unwrap().0
}

/// For Hooke and St.Venant–Kirchhoff the elimination is the closed one: energies of a membrane are
/// ½ E/(1 − ν²) ((1 − ν) ε : ε + ν (tr ε)²) of the strain along it, those of a cable ½ E ε².
#[test]
fn linear_laws_have_their_closed_plane_stress() {
    let (young, poisson) = (3.0, 0.3);
    for id in ["hooke", "stvk"] {
        let law = souple_laws::by_id(id).unwrap();
        for element in ["tri3", "edge2"].map(|e| souple_elements::by_id(e).unwrap()) {
            let mut elements = one(element, law, element.nodes, &[young, poisson]);
            let h = [[0.2, 0.1], [-0.15, -0.1], [0.3, 0.05]];
            let u: Vec<f64> =
                element.nodes.iter().flat_map(|p| (0..3).map(move |i| h[i][0] * p[0] + h[i][1] * p[1])).collect();
            let strain = |i: usize, j: usize| {
                let square: f64 = (0..3).map(|k| h[k][i] * h[k][j]).sum();
                0.5 * (h[i][j] + h[j][i] + if id == "stvk" { square } else { 0.0 })
            };
            let density = if element.dimension() == 1 {
                0.5 * young * strain(0, 0).powi(2)
            } else {
                let trace = strain(0, 0) + strain(1, 1);
                let squares = strain(0, 0).powi(2) + strain(1, 1).powi(2) + 2.0 * strain(0, 1).powi(2);
                0.5 * young / (1.0 - poisson * poisson) * ((1.0 - poisson) * squares + poisson * trace * trace)
            };
            let expected = density * SECTION * element.family.reference_measure();
            assert_close(&format!("{} / {id}", element.id), &[elements.energy(&u)], &[expected], 1e-13, expected);
        }
    }
}

/// Patch test: a flat patch of distorted quadrangles and triangles, anywhere in space, under one homogeneous deformation
/// of its plane and out of it has no force at its inner node, and every element the same stress.
#[test]
fn a_flat_patch_anywhere_in_space_has_no_force_inside() {
    let flat: [[f64; 2]; 9] =
        [[0.0, 0.0], [1.1, 0.0], [2.0, 0.0], [0.0, 0.9], [0.8, 1.2], [2.0, 1.0], [0.0, 2.0], [1.2, 2.0], [2.0, 2.0]];
    let kinds: [(&str, Vec<u32>); 2] =
        [("quad4", vec![0, 1, 4, 3, 1, 2, 5, 4]), ("tri3", vec![3, 4, 7, 3, 7, 6, 4, 5, 8, 4, 8, 7])];
    let mut random = Random::new(31);
    for &law in souple_laws::all().iter().filter(|l| isotropic(l)) {
        let r = rotation(&mut random);
        let nodes: Vec<[f64; 3]> = flat.iter().map(|p| turned(&r, &[p[0], p[1], 0.4])).collect();
        let specs = kinds.iter().map(|(id, connectivity)| {
            let element = souple_elements::by_id(id).unwrap();
            BlockSpec {
                element,
                law,
                rule: element.default_rule(),
                parameters: parameters(law),
                density: 1.0,
                viscosity: None,
                section: SECTION,
                connectivity: connectivity.clone(),
                ids: (0..(connectivity.len() / element.node_count()) as u32).collect(),
            }
        });
        let threads = Arc::new(Threads::new(1).unwrap());
        let backend = Interpreter::default();
        let (mut elements, _) = Elements::new(3, &nodes, specs.collect(), &backend, threads, Costs::default()).unwrap();
        let h: Tensor = std::array::from_fn(|_| std::array::from_fn(|_| random.between(-0.15, 0.15)));
        let u: Vec<f64> = nodes.iter().flat_map(|x| turned(&h, x)).collect();
        let mut force = vec![0.0; u.len()];
        elements.add_force(&u, &mut force);
        assert!(largest(&force) > 1e-3, "{}: the patch is deformed", law.id);
        assert_close(law.id, &force[12..15], &[0.0; 3], 1e-12, largest(&force));
        elements.prepare_means(&[Average::Stress], &backend, Costs::default()).unwrap();
        let mut stresses: Vec<[f64; 6]> = Vec::new();
        elements.each_mean(Average::Stress, &u, |_, m| stresses.push(m.tensor));
        assert_eq!(stresses.len(), 6);
        for stress in &stresses {
            assert_close(law.id, stress, &stresses[0], 1e-11, largest(&stresses[0]));
        }
    }
}

/// At rest the strain across is none, whatever the law: volumes are those of the rest shape.
#[test]
fn rest_has_its_volume() {
    each(|sample| {
        if !sample.embedded() {
            return;
        }
        let rest = vec![0.0; sample.elements.len()];
        let mut volume = f64::NAN;
        sample.elements.each_volume(&rest, |_, v| volume = v);
        let mass: f64 = sample.masses.shape.iter().sum();
        assert_close(&sample.name(), &[sample.density * volume], &[mass], 1e-13, mass);
    });
}
