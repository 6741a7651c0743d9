//! Traction tests give back what their material was made of.

use crate::place::{Place, with_souple};

/// Bars of Hooke's law in space and in the plane, stretched at both ends without being held from the sides, give their
/// Young's modulus and Poisson's ratio back: exactly, because the strain is uniform.
#[test]
fn moduli_are_measured() {
    with_souple();
    let scene = r#"
[time]
step = 1.0
end = 1.0
[integrator]
method = "quasi-static"
[linear_solver]
tolerance = 1e-12
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [1, 0.2, 0.3], cells = [4, 1, 1], sections = [{ until = 1.0, element = "hex8" }] }
[[body.material]]
law = "hooke"
young = 2e5
poisson = 0.3
[[body.fix]]
region = "x_min"
axes = ["x"]
[[body.fix]]
region = { box = { min = [0, 0, 0], max = [0, 0, 0] } }
[[body.fix]]
region = { box = { min = [1, 0, 0], max = [1, 0, 0] } }
axes = ["y", "z"]
[[body.fix]]
region = { box = { min = [0, 0.2, 0], max = [0, 0.2, 0] } }
axes = ["z"]
[[body.move]]
region = "x_max"
axes = ["x"]
translation = { keys = [[0.0, [0, 0, 0]], [1.0, [0.02, 0, 0]]] }
[[probe]]
name = "held"
region = "x_min"
quantity = "reaction"
[[probe]]
name = "pulled"
region = "x_max"
quantity = "mean displacement"
[[probe]]
name = "low"
region = "y_min"
quantity = "mean displacement"
[[probe]]
name = "high"
region = "y_max"
quantity = "mean displacement"
"#;
    let campaign = "name = \"traction\"\nscene = \"bar.toml\"\n\
        [[vary]]\nkey = \"material.*.young\"\nvalues = [1e5, 3e5]\n\
        [[vary]]\nkey = \"body.0.mesh.sections.0.element\"\nvalues = [\"hex8\", \"quad4\"]\n";
    let place = Place::new("traction", campaign);
    std::fs::write(place.0.join("bar.toml"), scene).unwrap();
    let (out, err) = place.succeeds("run .");
    assert!(out.contains("4 came to their end"), "{out}{err}");
    let table = place.table();
    let column = |name: &str| table.heads.iter().position(|head| head == name).unwrap_or_else(|| panic!("{name}"));
    for (number, row) in table.rows.iter().enumerate() {
        let of = |name: &str| row[column(name)].parse::<f64>().unwrap();
        let (young, poisson) = ([1e5, 3e5][number % 2], 0.3);
        let expected = if number < 2 { [young, poisson] } else { [young / (1.0 - 0.09), poisson / (1.0 - poisson)] };
        assert!((of("traction Young's modulus") / expected[0] - 1.0).abs() < 1e-6, "{row:?}");
        assert!((of("traction Poisson's ratio") - expected[1]).abs() < 1e-6, "{row:?}");
        assert!(of("traction error of Young's modulus").abs() < 1e-6, "{row:?}");
        assert!(of("traction error of Poisson's ratio").abs() < 1e-6, "{row:?}");
    }
}
