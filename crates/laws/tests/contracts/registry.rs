//! Properties of every law, whatever it is.

use crate::sample::{Random, largest, parameters, responses};
use souple_laws::response::{IDENTITY, Tensor, product, tensor_from_fn};
use souple_laws::{Argument, ISOTROPIC, Response, lame_from_young_poisson};

/// Ids are what scenes say: unique, lower case, found again; and every law explains itself.
#[test]
fn laws_are_found_by_their_ids() {
    let laws = souple_laws::all();
    assert!(laws.windows(2).all(|pair| pair[0].id < pair[1].id), "sorted, each once");
    for law in laws {
        assert_eq!(souple_laws::by_id(law.id).unwrap().id, law.id);
        assert!(law.id.chars().all(|c| c.is_ascii_lowercase() || c == '-'), "{}", law.id);
        for text in [law.name, law.about, law.formula] {
            assert!(!text.trim().is_empty(), "{}", law.id);
        }
        assert!(!law.references.is_empty() && !law.parameters.is_empty(), "{}", law.id);
        let mut names: Vec<&str> = law.parameters.iter().map(|p| p.name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{}: parameters twice", law.id);
    }
}

/// Three components are asked for as one direction; everything else is a number.
#[test]
fn directions_are_one_argument() {
    let shown = |id: &str| -> Vec<String> {
        let arguments = souple_laws::by_id(id).unwrap().arguments();
        arguments
            .into_iter()
            .map(|argument| match argument {
                Argument::Number(p) => p.name.to_owned(),
                Argument::Direction { name, x } => format!("{name} from {}", x.name),
            })
            .collect()
    };
    assert_eq!(shown("transverse-stvk"), ["young", "poisson", "young_fibre", "direction from direction_x"]);
    assert_eq!(shown("yeoh"), ["c1", "c2", "c3", "bulk"]);
}

/// Nothing is stored and nothing pulls at rest.
#[test]
fn rest_is_free_of_energy_and_stress() {
    for (law, parameters, response) in responses() {
        let scale = largest(response.tangent(&IDENTITY).iter().flatten());
        let energy = response.energy(&IDENTITY);
        assert!(energy.abs() <= 1e-13 * scale, "{} {parameters:?}: energy {energy:e}", law.id);
        let stress = largest(response.stress(&IDENTITY).iter().flatten());
        assert!(stress <= 1e-13 * scale, "{} {parameters:?}: stress {stress:e}", law.id);
    }
}

/// A law with Young's modulus and Poisson's ratio and nothing else is Hooke's law at small strain, to the last digits.
#[test]
fn isotropic_laws_are_hookes_at_small_strain() {
    let delta = |i: usize, j: usize| f64::from(u8::from(i == j));
    for (law, parameters, response) in responses().filter(|r| r.0.parameters == ISOTROPIC) {
        let (lambda, mu) = lame_from_young_poisson(parameters[0], parameters[1]);
        let tangent = response.tangent(&IDENTITY);
        for (row, column) in (0..9).flat_map(|row| (0..9).map(move |column| (row, column))) {
            let (i, j, k, l) = (row / 3, row % 3, column / 3, column % 3);
            let hooke =
                lambda * delta(i, j) * delta(k, l) + mu * (delta(i, k) * delta(j, l) + delta(i, l) * delta(j, k));
            let difference = (tangent[row][column] - hooke).abs();
            assert!(difference <= 1e-13 * (lambda.abs() + mu), "{} {parameters:?}: [{row}][{column}]", law.id);
        }
    }
}

/// The moduli at small strain are those that the law's file documents.
#[test]
fn documented_moduli_are_those_of_the_tangent() {
    for (law, p, response) in responses() {
        let (bulk, shear) = match law.id {
            "mooney-rivlin" => (p[2], 2.0 * (p[0] + p[1])),
            "yeoh" => (p[3], 2.0 * p[0]),
            "ogden" => (p[6], p[0] + p[1] + p[2]),
            "arruda-boyce" => {
                let c = [0.5, 0.05, 11.0 / 1050.0, 19.0 / 7000.0, 519.0 / 673_750.0];
                let term = |i: i32| f64::from(i) * c[i as usize - 1] * 3f64.powi(i - 1) / p[1].powi(2 * i - 2);
                (p[2], 2.0 * p[0] * (1..=5).map(term).sum::<f64>())
            }
            "fung" => (p[3] + p[0] * (p[2] + p[1] / 3.0), p[0] * p[1] / 2.0),
            _ => continue,
        };
        let t = response.tangent(&IDENTITY);
        assert!((t[1][1] - shear).abs() <= 1e-13 * shear, "{}: shear modulus {} for {shear}", law.id, t[1][1]);
        let found = (t[0][0] + 2.0 * t[0][4]) / 3.0;
        assert!((found - bulk).abs() <= 1e-13 * (bulk + shear), "{}: bulk modulus {found} for {bulk}", law.id);
    }
}

/// The fibres of the transversely isotropic law have the modulus that they are given, whatever their direction.
#[test]
fn fibres_have_their_modulus() {
    let law = souple_laws::by_id("transverse-stvk").unwrap();
    let mut random = Random(5);
    for _ in 0..5 {
        let p = parameters(law, &mut random);
        let (young, poisson, young_fibre) = (p[0], p[1], p[2]);
        let length = p[3..].iter().map(|d| d * d).sum::<f64>().sqrt();
        let a: Vec<f64> = p[3..].iter().map(|d| d / length).collect();
        // Free sides contract by Poisson's ratio of the isotropic part: strain a⊗a − ν (I − a⊗a).
        let strain = tensor_from_fn(|i, j| (1.0 + poisson) * a[i] * a[j] - if i == j { poisson } else { 0.0 });
        let stress = linear_stress(&Response::new(law, &p).unwrap(), &strain);
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            let expected = young_fibre * a[i] * a[j];
            assert!((stress[i][j] - expected).abs() <= 1e-13 * (young + young_fibre), "{p:?}: [{i}][{j}]");
        }
    }
}

fn linear_stress(response: &Response, strain: &Tensor) -> Tensor {
    let tangent = response.tangent(&IDENTITY);
    tensor_from_fn(|i, j| (0..9).map(|k| tangent[3 * i + j][k] * strain[k / 3][k % 3]).sum())
}

/// Every strain from rest costs energy.
#[test]
fn rest_is_stable() {
    let mut random = Random(7);
    for (law, parameters, response) in responses() {
        for _ in 0..50 {
            let f = random.deformation(1.0);
            let strain = tensor_from_fn(|i, j| (f[i][j] + f[j][i]) / 2.0 - IDENTITY[i][j]);
            let stress = linear_stress(&response, &strain);
            let power: f64 = stress.iter().flatten().zip(strain.iter().flatten()).map(|(a, b)| a * b).sum();
            assert!(power > 0.0, "{} {parameters:?}: {strain:?}", law.id);
        }
    }
}

/// A rotation after the deformation changes neither energy nor stress (but for turning it), exactly for the laws that
/// say so.
#[test]
fn laws_are_objective_exactly_when_they_say_so() {
    let mut random = Random(11);
    for (law, parameters, response) in responses() {
        let scale = largest(response.tangent(&IDENTITY).iter().flatten());
        let mut worst = 0f64;
        for _ in 0..8 {
            let (f, rotation) = (random.deformation(0.2), random.rotation());
            let turned = product(&rotation, &f);
            worst = worst.max((response.energy(&turned) - response.energy(&f)).abs());
            let (expected, found) = (product(&rotation, &response.stress(&f)), response.stress(&turned));
            worst = worst.max(largest(&tensor_from_fn(|i, j| found[i][j] - expected[i][j]).concat()));
        }
        assert_eq!(worst <= 1e-10 * scale, law.objective, "{} {parameters:?}: differs by {worst:e}", law.id);
    }
}

/// Stresses are the differences of energies, tangents those of stresses.
#[test]
fn derivatives_agree_with_differences() {
    let mut random = Random(13);
    let step = 1e-5;
    for (law, parameters, response) in responses() {
        let scale = largest(response.tangent(&IDENTITY).iter().flatten());
        for _ in 0..3 {
            let f = random.deformation(0.2);
            let moved = |k: usize, by: f64| {
                let mut g = f;
                g[k / 3][k % 3] += by;
                g
            };
            let (stress, tangent) = (response.stress(&f), response.tangent(&f));
            for k in 0..9 {
                let (plus, minus) = (moved(k, step), moved(k, -step));
                let slope = (response.energy(&plus) - response.energy(&minus)) / (2.0 * step);
                let error = (stress[k / 3][k % 3] - slope).abs();
                assert!(error <= 1e-6 * scale, "{} {parameters:?}: stress {k} is off by {error:e}", law.id);
                let (plus, minus) = (response.stress(&plus), response.stress(&minus));
                for l in 0..9 {
                    let slope = (plus[l / 3][l % 3] - minus[l / 3][l % 3]) / (2.0 * step);
                    let error = (tangent[l][k] - slope).abs();
                    assert!(error <= 1e-6 * scale, "{} {parameters:?}: tangent {l}, {k} is off by {error:e}", law.id);
                }
            }
        }
    }
}

/// The stable neo-Hookean law has finite stresses where elements are flat or inside out, and pushes them open.
#[test]
fn the_stable_law_opens_inverted_elements() {
    let response = Response::new(souple_laws::by_id("stable-neo-hookean").unwrap(), &[1e5, 0.45]).unwrap();
    for height in [0.0, -0.3, -1.0] {
        let f = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, height]];
        assert!(response.energy(&f).is_finite() && response.tangent(&f).iter().flatten().all(|v| v.is_finite()));
        assert!(response.stress(&f)[2][2] < 0.0, "height {height}: less energy when it is higher");
    }
    assert!(response.energy(&[[0.0; 3]; 3]).is_finite());
}

/// A wrong number of parameters is an error that names them.
#[test]
fn parameters_are_counted() {
    let error = Response::new(souple_laws::by_id("yeoh").unwrap(), &[1.0]).unwrap_err();
    assert_eq!(error.to_string(), "law `yeoh` takes 4 parameters (c1, c2, c3, bulk), found 1");
}
