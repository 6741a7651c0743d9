//! Parameters of laws: shapes, pairs of elastic constants, energies written in the scene.

use souple_scene::{Location, ParameterValue};

use crate::catalogue::{SHORT, messages, scene};

/// The short scene with another material from line 10 on.
fn with_material(lines: &str) -> String {
    SHORT.replace("law = \"stvk\"\nyoung = 1e5\npoisson = 0.3\n", lines)
}

fn parameters(lines: &str) -> Vec<(String, ParameterValue)> {
    let scene = scene(&with_material(lines));
    let material = &scene.bodies[0].materials[0];
    material.parameters.iter().map(|p| (p.name.clone(), p.value.value.clone())).collect()
}

#[test]
fn isotropic_laws_accept_three_pairs_of_constants_as_given() {
    for (lines, names, values) in [
        ("law = \"stvk\"\npoisson = 0.3\nyoung = \"10 kPa\"\n", ["young", "poisson"], [1e4, 0.3]),
        ("law = \"stvk\"\nmu = \"1 kPa\"\nlambda = 5\n", ["lambda", "mu"], [5.0, 1e3]),
        ("law = \"hooke\"\nmu = 2\nbulk = \"1 MPa\"\n", ["bulk", "mu"], [1e6, 2.0]),
    ] {
        let found = parameters(lines);
        let expected: Vec<_> =
            names.iter().zip(values).map(|(name, value)| ((*name).to_owned(), ParameterValue::Number(value))).collect();
        assert_eq!(found, expected, "{lines}");
    }
}

#[test]
fn lists_directions_and_defaults_follow_the_catalogue() {
    let found = parameters("law = \"ogden\"\nalpha = [2, -2]\nmu = [\"1 kPa\", 20]\nbulk = 1e6\n");
    assert_eq!(found[0], ("mu".to_owned(), ParameterValue::List(vec![1000.0, 20.0])));
    assert_eq!(found[1], ("alpha".to_owned(), ParameterValue::List(vec![2.0, -2.0])));
    let text = with_material("law = \"transverse-stvk\"\nmu = 1\nlambda = 1\ndirection = [0, 3, 4]\n");
    let scene = scene(&text);
    let material = &scene.bodies[0].materials[0];
    let names: Vec<&str> = material.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["lambda", "mu", "young_fibre", "direction"]);
    assert_eq!(material.parameter("direction").unwrap().value, ParameterValue::List(vec![0.0, 3.0, 4.0]));
    assert_eq!(material.parameter("young_fibre").unwrap().at, Location::Default);
    assert_eq!(material.parameter("nothing"), None);
}

#[test]
fn a_user_law_has_the_parameters_of_its_energy() {
    let lines = "energy = \"k*(I1 - 3) + c_2[1]*ln(J)\"\nk = \"4 kPa\"\nc_2 = [1, \"2 s\"]\n";
    let scene = scene(&with_material(lines));
    let material = &scene.bodies[0].materials[0];
    assert_eq!(material.law.as_str(), "user");
    assert_eq!(material.energy.as_ref().unwrap().as_str(), "k*(I1 - 3) + c_2[1]*ln(J)");
    assert_eq!(material.parameter("k").unwrap().value, ParameterValue::Number(4000.0));
    assert_eq!(material.parameter("c_2").unwrap().value, ParameterValue::List(vec![1.0, 2.0]));
    assert_eq!(material.parameters[0].name, "c_2");
}

#[test]
fn mistakes_in_materials_name_the_line_the_reason_and_the_remedy() {
    let cases: &[(&str, &str)] = &[
        (
            "law = \"stkv\"\nyoung = 1\n",
            "10:7: unknown law `stkv`; did you mean `stvk`?; known: hooke, stvk, transverse-stvk, mooney-rivlin, ogden, fung, user",
        ),
        ("young = 1\n", "8:1: [[body.material]] needs `law`: id of the law"),
        ("law = 3\n", "10:7: `law` must be a text in quotes, found the number 3"),
        (
            "law = \"stvk\"\nyoung = 1\n",
            "8:1: law `stvk` needs `poisson`, the poisson of the test; only `young` is given",
        ),
        (
            "law = \"stvk\"\npoisson = 0.2\n",
            "8:1: law `stvk` needs `young` [Pa], the young of the test; only `poisson` is given",
        ),
        (
            "law = \"stvk\"\n",
            "8:1: law `stvk` needs `young` [Pa] and `poisson`, or `lambda` [Pa] and `mu` [Pa], or `bulk` [Pa] and `mu` [Pa]",
        ),
        (
            "law = \"stvk\"\nyoung = 1\nmu = 1\n",
            "12:1: law `stvk` takes exactly one pair: `young` [Pa] and `poisson`, or",
        ),
        ("law = \"stvk\"\nyoung = 1\npoisson = 0\nbulk = 1\n", "13:1: law `stvk` takes exactly one pair"),
        ("law = \"stvk\"\nlambda = -1\nmu = 1\n", "11:10: `lambda` must be greater than −2/3 mu"),
        ("law = \"stvk\"\nlambda = 1\nmu = 0\n", "12:6: `mu` must be greater than 0 Pa, found 0"),
        ("law = \"stvk\"\nyoung = 0\npoisson = 0\n", "11:9: `young` must be greater than 0 Pa, found 0"),
        (
            "law = \"stvk\"\nyoung = \"-4 kPa\"\npoisson = 0\n",
            "11:9: `young` must be greater than 0 Pa, found \"-4 kPa\"",
        ),
        (
            "law = \"stvk\"\nyoung = 1\npoisson = 0.5\n",
            "12:11: `poisson` must be greater than -1 and less than 0.5, found 0.5; 0.5 means incompressible",
        ),
        (
            "law = \"stvk\"\nyoung = 1\npoisson = -1\n",
            "12:11: `poisson` must be greater than -1 and less than 0.5, found -1",
        ),
        ("law = \"stvk\"\nyoung = nan\npoisson = 0\n", "11:9: `young` must be a finite number, found NaN"),
        (
            "law = \"stvk\"\nyoung = \"4 kg\"\npoisson = 0\n",
            "11:9: `young`: expected a pressure such as \"4 kPa\", found `4 kg`, which is a mass",
        ),
        (
            "law = \"stvk\"\nyoung = [1]\npoisson = 0\n",
            "11:9: `young` must be a number in Pa or a text such as \"4 kPa\", found a list of 1 value",
        ),
        (
            "law = \"stvk\"\nyoung = 1\npoison = 0.1\npoisson = 0\n",
            "12:1: law `stvk` has no parameter `poison`; did you mean `poisson`?; its parameters: young, poisson, lambda, mu, bulk",
        ),
        (
            "law = \"mooney-rivlin\"\nc10 = 1\nc01 = 2\n",
            "8:1: law `mooney-rivlin` needs `bulk` [Pa], the bulk of the test",
        ),
        (
            "law = \"mooney-rivlin\"\nc10 = 1\nc01 = 2\nbulk = 1\nyoung = 2\n",
            "14:1: law `mooney-rivlin` has no parameter `young`",
        ),
        ("law = \"ogden\"\nmu = [1, 2]\nalpha = [1]\nbulk = 1\n", "12:9: `alpha`: must have as many values as `mu`"),
        (
            "law = \"ogden\"\nmu = []\nalpha = [1]\nbulk = 1\n",
            "11:6: `mu` must be a list of numbers, found a list of 0 values",
        ),
        (
            "law = \"fung\"\nc = 1\ncoefficients = [1, 2]\n",
            "12:16: `coefficients` must be a list of 3 numbers, found a list of 2 values",
        ),
        (
            "law = \"transverse-stvk\"\nmu = 1\nlambda = 1\ndirection = [0, 0, 0]\n",
            "13:13: `direction` must be a direction: three numbers, not all zero",
        ),
        (
            "law = \"stvk\"\nyoung = 1\npoisson = 0\nenergy = \"I1\"\n",
            "13:1: `energy` belongs to `law = \"user\"`; the law is \"stvk\"",
        ),
        ("law = \"user\"\n", "8:1: [[body.material]] needs `energy`"),
        ("energy = \"k*J\"\nk = 1\nl = 2\n", "12:1: `l` does not occur in the energy of this material"),
        (
            "energy = \"k*J\"\nk = 1\nregoin = 2\n",
            "12:1: `regoin` does not occur in the energy of this material; did you mean `region`?",
        ),
        (
            "energy = \"k*J\"\nk = true\n",
            "11:5: `k` must be a number, a text with a unit, or a list of these, found true",
        ),
        ("energy = \"k*J\"\nk = \"4 quux\"\n", "11:5: `k`: unknown unit `quux`"),
        ("energy = \"ln(0)\"\n", "10:10: the energy is not finite at rest"),
        ("energy = \"bad*J\"\nbad = 1\n", "11:7: `bad`: is bad"),
        (
            "law = \"stvk\"\nyoung = 1\npoisson = 0\nviscosity = { shear = -1 }\n",
            "13:23: `shear` must be at least 0 Pa s, found -1",
        ),
        (
            "law = \"stvk\"\nyoung = 1\npoisson = 0\nviscosity = { prony = [{ fraction = 0.5, time = 1 }, { fraction = 0.5, time = 2 }] }\n",
            "13:15: the fractions of the Prony series sum to 1",
        ),
    ];
    for (lines, message) in cases {
        let found = messages(&with_material(lines));
        assert_eq!(found.len(), 1, "{lines}: {found:#?}");
        assert!(found[0].starts_with(&format!("scene.toml:{message}")), "{lines}:\n  {}\n  {message}", found[0]);
    }
}
