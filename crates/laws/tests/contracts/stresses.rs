//! Energies and stresses against numbers that this program had no part in.

use crate::sample::largest;
use souple_laws::Response;
use souple_laws::response::{Tensor, tensor_from_fn};
use std::collections::BTreeSet;

/// One line of the data: a law at a deformation.
struct Answer {
    place: String,
    f: Tensor,
    law: String,
    energy: f64,
    stress: Tensor,
    parameters: Vec<(String, f64)>,
}

fn answers() -> Vec<Answer> {
    let mut answers = Vec::new();
    let (mut name, mut f) = (String::new(), [[0.0; 3]; 3]);
    for line in include_str!("../data/stresses.txt").lines().filter(|line| !line.starts_with('#')) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let tensor = |from: usize| tensor_from_fn(|i, j| words[from + 3 * i + j].parse().unwrap());
        if words[0] == "deformation" {
            (name, f) = (words[1].to_owned(), tensor(2));
            continue;
        }
        let parameter = |word: &&str| {
            let (name, value) = word.split_once('=').unwrap();
            (name.to_owned(), value.parse().unwrap())
        };
        answers.push(Answer {
            place: format!("{} at {name}", words[1]),
            f,
            law: words[1].to_owned(),
            energy: words[2].parse().unwrap(),
            stress: tensor(3),
            parameters: words[12..].iter().map(parameter).collect(),
        });
    }
    answers
}

/// Energies and stresses are those of the data, to round-off, for stretches, shears, changes of volume and
/// inversions, at two deformations or more of every law that the data name.
///
/// A law that has just been dropped into the folder has no numbers yet and is left out: `cargo xtask test --only data`
/// asks for them.
#[test]
fn stresses_are_those_of_the_data() {
    let answers = answers();
    let laws: BTreeSet<&str> = answers.iter().map(|answer| answer.law.as_str()).collect();
    for id in laws {
        let law = souple_laws::by_id(id).unwrap_or_else(|| panic!("tests/data/stresses.txt: no law is called `{id}`"));
        let mut compared = 0;
        for answer in answers.iter().filter(|answer| answer.law == law.id) {
            let value = |name: &str| answer.parameters.iter().find(|p| p.0 == name).map(|p| p.1);
            let parameters: Vec<f64> = law.parameters.iter().map(|p| value(p.name).unwrap()).collect();
            let response = Response::new(law, &parameters).unwrap();
            let (energy, stress) = (response.energy(&answer.f), response.stress(&answer.f));
            let scale = 1e5;
            assert!((energy - answer.energy).abs() <= 1e-13 * scale, "{}: energy {energy}", answer.place);
            let error = largest(&tensor_from_fn(|i, j| stress[i][j] - answer.stress[i][j]).concat());
            let size = largest(answer.stress.iter().flatten()).max(scale);
            assert!(error <= 1e-13 * size, "{}: {stress:?} instead of {:?}", answer.place, answer.stress);
            compared += 1;
        }
        assert!(compared >= 2, "tests/data/stresses.txt has one deformation of `{id}`: compute more (see make.py)");
    }
}
