//! Gauss rules of any degree, which owe nothing to the rule files: products of Gauss–Legendre rules, collapsed where
//! the cell is.

use souple_elements::Family;
use std::f64::consts::PI;

/// Points (reference coordinates) and weights of a rule with `n` points per axis on the family's cell.
pub(crate) fn fine(family: Family, n: usize) -> Vec<([f64; 3], f64)> {
    let line = gauss_legendre(n);
    let unit: Vec<(f64, f64)> = line.iter().map(|&(x, w)| (0.5 * (1.0 + x), 0.5 * w)).collect();
    // An axis that the cell lacks has one point of weight one.
    let one = [(0.0, 1.0)];
    let axis = |k: usize| if k < family.dimension() { &line[..] } else { &one[..] };
    let (first, second, third) = match family {
        Family::Edge | Family::Quadrangle | Family::Hexahedron => (axis(0), axis(1), axis(2)),
        Family::Triangle => (&unit[..], &unit[..], &one[..]),
        Family::Prism => (&unit[..], &unit[..], &line[..]),
        Family::Tetrahedron => (&unit[..], &unit[..], &unit[..]),
        Family::Pyramid => (&line[..], &line[..], &unit[..]),
    };
    let mut rule = Vec::with_capacity(first.len() * second.len() * third.len());
    for &(r, wr) in first {
        for &(s, ws) in second {
            for &(t, wt) in third {
                let w = wr * ws * wt;
                // The triangle is a square collapsed at s = 1; pyramid and tetrahedron shrink towards t = 1.
                let up = (1.0 - t) * (1.0 - t);
                rule.push(match family {
                    Family::Edge | Family::Quadrangle | Family::Hexahedron => ([r, s, t], w),
                    Family::Triangle | Family::Prism => ([r * (1.0 - s), s, t], w * (1.0 - s)),
                    Family::Tetrahedron => ([r * (1.0 - s) * (1.0 - t), s * (1.0 - t), t], w * (1.0 - s) * up),
                    Family::Pyramid => ([r * (1.0 - t), s * (1.0 - t), t], w * up),
                });
            }
        }
    }
    rule
}

/// Points and weights on [−1, 1]: zeros of the Legendre polynomial by Newton's method on its three-term recurrence.
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    let point = |i: usize| {
        let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut before, mut now) = (1.0, x);
            for k in 2..=n {
                let k = k as f64;
                (before, now) = (now, ((2.0 * k - 1.0) * x * now - (k - 1.0) * before) / k);
            }
            slope = n as f64 * (x * now - before) / (x * x - 1.0);
            x -= now / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(point).collect()
}

/// The rules of the tests integrate as the element's own rules do: ∫ (1 + x)² (1 + y)² (1 + z)² agrees with a listed rule
/// of sufficient degree, on every family that has one, and ∫ 1 is the cell.
#[test]
fn fine_rules_agree_with_the_listed_ones() {
    let value = |[x, y, z]: [f64; 3]| ((1.0 + x) * (1.0 + y + x)).powi(2) + z * z * (1.0 + y);
    for rule in souple_elements::rules().iter().filter(|r| r.degree >= 4) {
        let sum = |points: &mut dyn Iterator<Item = ([f64; 3], f64)>| points.map(|(x, w)| w * value(x)).sum::<f64>();
        let listed = sum(&mut rule.points.iter().copied().zip(rule.weights.iter().copied()));
        let fine = fine(rule.family, 5);
        let ours = sum(&mut fine.iter().copied());
        assert!((ours / listed - 1.0).abs() < 1e-13, "{}: {listed} against {ours}", rule.id);
        let measure: f64 = fine.iter().map(|p| p.1).sum();
        assert!((measure / rule.family.reference_measure() - 1.0).abs() < 1e-13, "{}: {measure}", rule.family.name());
    }
}
