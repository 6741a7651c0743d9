//! Powers of stretches: right where stretches are equal and where they nearly are, and the laws that they include.

use crate::sample::{Random, largest};
use souple_laws::response::{IDENTITY, Tensor, product, tensor_from_fn, transpose};
use souple_laws::user::{ParameterValue, UserLaw};
use souple_laws::{Response, by_id};

fn ogden(terms: &[(f64, f64)], bulk: f64) -> Response {
    let mut parameters = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, bulk];
    for (k, &(mu, alpha)) in terms.iter().enumerate() {
        (parameters[k], parameters[3 + k]) = (mu, alpha);
    }
    Response::new(by_id("ogden").unwrap(), &parameters).unwrap()
}

/// `R diag(λ) Qᵀ` with random rotations, or with none.
fn deformation(stretches: [f64; 3], random: Option<&mut Random>) -> Tensor {
    let diagonal = tensor_from_fn(|i, j| if i == j { stretches[i] } else { 0.0 });
    let Some(random) = random else { return diagonal };
    let (r, q) = (random.rotation(), random.rotation());
    product(&product(&r, &diagonal), &transpose(&q))
}

/// Stretches that are equal, nearly equal by less and less, and far apart.
fn stretches() -> Vec<[f64; 3]> {
    let mut all =
        vec![[1.0; 3], [1.2; 3], [1.3, 1.3, 0.7], [0.6, 1.4, 1.4], [2.0, 0.5, 0.9], [3.0, 0.4, 0.5], [0.3, 3.0, 1.1]];
    for exponent in 4..=14 {
        let gap = 0.1f64.powi(exponent);
        all.extend([[1.0 + gap, 1.0, 1.0], [1.3, 1.3 + gap, 0.7], [0.8, 1.1, 1.1 - gap], [1.0, 1.0 + gap, 1.0 - gap]]);
    }
    all
}

fn assert_same(place: &str, found: &Response, expected: &Response, f: &Tensor, tolerance: f64) {
    let scale =
        largest(expected.tangent(f).iter().flatten()).max(largest(expected.tangent(&IDENTITY).iter().flatten()));
    let energy = (found.energy(f) - expected.energy(f)).abs();
    assert!(energy <= tolerance * scale, "{place}: energy differs by {energy:e} of {scale:e}");
    let (p, q) = (found.stress(f), expected.stress(f));
    let stress = largest(&tensor_from_fn(|i, j| p[i][j] - q[i][j]).concat());
    assert!(stress <= tolerance * scale, "{place}: stress differs by {stress:e} of {scale:e}");
    let (a, b) = (found.tangent(f).concat(), expected.tangent(f).concat());
    let tangent = a.iter().zip(&b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    assert!(tangent <= tolerance * scale, "{place}: tangent differs by {tangent:e} of {scale:e}");
}

/// The exponents ±2 are Mooney and Rivlin, and ±4 are polynomials of C and its inverse: at equal, nearly equal and far
/// apart stretches, along the axes and turned.
#[test]
fn even_exponents_are_polynomials() {
    let number = |v| ParameterValue::Number(v);
    let text = "a/8*(J^(-4/3)*tr(C*C) - 3) + b/8*(J^(4/3)*tr(inverse(C)*inverse(C)) - 3) + k/2*(J - 1)^2";
    let quartic =
        UserLaw::parse(text, &[("a", number(2.0)), ("b", number(0.7)), ("k", number(5.0))]).unwrap().response();
    let mooney = |c10, c01| Response::new(by_id("mooney-rivlin").unwrap(), &[c10, c01, 5.0]).unwrap();
    let pairs = [
        (ogden(&[(3.0, 2.0)], 5.0), mooney(1.5, 0.0)),
        (ogden(&[(3.0, 2.0), (0.8, -2.0)], 5.0), mooney(1.5, 0.4)),
        (ogden(&[(2.0, 4.0), (0.7, -4.0)], 5.0), quartic),
    ];
    let mut random = Random(12);
    for (k, (found, expected)) in pairs.iter().enumerate() {
        for stretches in stretches() {
            assert_same(&format!("{k}: {stretches:?}"), found, expected, &deformation(stretches, None), 1e-11);
            let turned = deformation(stretches, Some(&mut random));
            assert_same(&format!("{k}: {stretches:?}, turned"), found, expected, &turned, 1e-11);
        }
    }
}

/// With exponents that are not whole, the tangent at stretches a gap apart is that at equal ones up to a multiple of the
/// gap, down to rounding.
#[test]
fn tangents_are_continuous_where_stretches_meet() {
    let law = ogden(&[(3.0, 1.3), (0.4, 5.7), (-0.5, -2.6)], 8.0);
    let mut random = Random(5);
    let (r, q) = (random.rotation(), random.rotation());
    let turned = |f: Tensor| product(&product(&r, &f), &transpose(&q));
    for turn in [false, true] {
        for (middle, sign) in [([1.3, 1.3, 0.7], [1.0, -1.0, 0.0]), ([1.0; 3], [1.0, 0.0, -1.0])] {
            let at = |gap: f64| {
                let f = deformation(std::array::from_fn(|i| middle[i] + gap * sign[i]), None);
                law.tangent(&if turn { turned(f) } else { f }).concat()
            };
            let together = at(0.0);
            assert!(together.iter().all(|v| v.is_finite()));
            let scale = largest(&together);
            for exponent in 4..=16 {
                let gap = 0.1f64.powi(exponent);
                let worst = at(gap).iter().zip(&together).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                assert!(worst <= (30.0 * gap + 1e-13) * scale, "gap {gap:e}: {:e}", worst / scale);
            }
        }
    }
}

/// Tension, equal tension in two directions and pure shear of an incompressible block follow Ogden's formulas with the
/// parameters that he fitted to Treloar's rubber (1972, section 4: α = 1.3, 5, −2 and μ = 6.3, 0.012, −0.1 kg/cm²).
#[test]
fn rubber_stretches_as_in_the_paper() {
    const KG_PER_CM2: f64 = 98_066.5;
    let terms = [(6.3 * KG_PER_CM2, 1.3), (0.012 * KG_PER_CM2, 5.0), (-0.1 * KG_PER_CM2, -2.0)];
    // The paper's energy has μ/α in place of 2μ/α².
    let law = ogden(&terms.map(|(mu, alpha)| (0.5 * mu * alpha, alpha)), 1e9);
    for stretch in [0.4f64, 0.9, 1.0, 1.5, 3.0, 5.0, 7.0] {
        for (sides, free) in [(0.5, -0.5), (1.0, -2.0), (0.0, -1.0)] {
            // The second stretch is λ^(−1/2), λ or 1; the third is free of traction and makes the volume one.
            let second = if free == -0.5 { -0.5 } else { sides };
            let f = deformation([stretch, stretch.powf(second), stretch.powf(free)], None);
            let p = law.stress(&f);
            // An incompressible body has any pressure: that which leaves the third side free.
            let nominal = p[0][0] - p[2][2] * f[2][2] / f[0][0];
            let expected: f64 =
                terms.iter().map(|&(mu, a)| mu * (stretch.powf(a - 1.0) - stretch.powf(free * a - 1.0))).sum();
            let error = (nominal - expected).abs() / expected.abs().max(1e5);
            assert!(error <= 1e-9, "{stretch} {free}: {nominal} Pa instead of {expected} Pa");
        }
    }
}
