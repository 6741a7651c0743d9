//! Rules integrate: exactly up to their degree, no further than they say, inside the cell, with positive weights.

use crate::interpolation::{monomial, monomials};
use souple_elements::{Family, Rule, all, rules};

fn factorial(n: u32) -> f64 {
    (1..=n).map(f64::from).product()
}

/// ∫ |x|^i over [−1, 1].
fn even(i: u32) -> f64 {
    2.0 / f64::from(i + 1)
}

/// The exact integral of the monomial's absolute value over the cell, and whether the monomial itself integrates to
/// zero because it is odd.
fn moment(family: Family, [i, j, k]: [u32; 3]) -> (f64, bool) {
    let simplex = |exponents: &[u32], dimension: u32| -> f64 {
        let product: f64 = exponents.iter().map(|&e| factorial(e)).product();
        product / factorial(exponents.iter().sum::<u32>() + dimension)
    };
    let odd = |exponents: &[u32]| exponents.iter().any(|e| e % 2 == 1);
    match family {
        Family::Edge => (even(i), odd(&[i])),
        Family::Quadrangle => (even(i) * even(j), odd(&[i, j])),
        Family::Hexahedron => (even(i) * even(j) * even(k), odd(&[i, j, k])),
        Family::Triangle => (simplex(&[i, j], 2), false),
        Family::Tetrahedron => (simplex(&[i, j, k], 3), false),
        Family::Prism => (simplex(&[i, j], 2) * even(k), odd(&[k])),
        // ξ = u w, η = v w, w = 1 − ζ: ∫ ζ^k w^(i + j + 2) dζ is a beta function.
        Family::Pyramid => {
            let along = factorial(k) * factorial(i + j + 2) / factorial(i + j + k + 3);
            (even(i) * even(j) * along, odd(&[i, j]))
        }
    }
}

/// Error of a rule for a monomial, relative to the integral of the monomial's absolute value.
fn error(rule: &Rule, e: [u32; 3]) -> f64 {
    let (absolute, is_odd) = moment(rule.family, e);
    let exact = if is_odd { 0.0 } else { absolute };
    let value: f64 = rule.points.iter().zip(&rule.weights).map(|(&x, w)| w * monomial(x, e)).sum();
    (value - exact).abs() / absolute
}

/// Every monomial up to the rule's degree is integrated to 1e-14, and some monomial of the next degree is not.
#[test]
fn rules_are_exact_up_to_their_degree_and_no_further() {
    for rule in rules() {
        let dimension = rule.family.dimension();
        for degree in 0..=rule.degree {
            for e in monomials(dimension, degree) {
                assert!(error(rule, e) < 1e-14, "{}: exponents {e:?} are off by {:e}", rule.id, error(rule, e));
            }
        }
        let beyond = monomials(dimension, rule.degree + 1).into_iter().map(|e| error(rule, e)).fold(0.0, f64::max);
        assert!(beyond > 1e-7, "{} is exact beyond its stated degree {}", rule.id, rule.degree);
    }
}

/// Weights are positive and sum to the cell's measure; points lie inside the cell, hence never on an apex.
#[test]
fn rules_have_positive_weights_and_inner_points() {
    for rule in rules() {
        let sum: f64 = rule.weights.iter().sum();
        let measure = rule.family.reference_measure();
        assert!((sum / measure - 1.0).abs() < 1e-14, "{}: weights sum to {sum}, not {measure}", rule.id);
        assert!(rule.weights.iter().all(|&w| w > 0.0), "{}: {:?}", rule.id, rule.weights);
        for &[x, y, z] in &rule.points {
            let margin = match rule.family {
                Family::Edge | Family::Quadrangle | Family::Hexahedron => 1.0 - x.abs().max(y.abs()).max(z.abs()),
                Family::Triangle => x.min(y).min(1.0 - x - y),
                Family::Tetrahedron => x.min(y).min(z).min(1.0 - x - y - z),
                Family::Prism => x.min(y).min(1.0 - x - y).min(1.0 - z.abs()),
                Family::Pyramid => z.min(1.0 - z - x.abs().max(y.abs())),
            };
            assert!(margin > 1e-3, "{}: point {:?} is not inside", rule.id, [x, y, z]);
        }
    }
}

/// A rule is called by its family and number of points, and says where its digits come from.
#[test]
fn rules_are_named_for_their_family_and_points() {
    for rule in rules() {
        assert_eq!(rule.id, format!("{}-{}", rule.family.name(), rule.points.len()));
        assert!(!rule.source.is_empty(), "{} names no source", rule.id);
        assert_eq!(rule.weights.len(), rule.points.len(), "{}", rule.id);
    }
}

/// Every rule that an element lists exists, belongs to its family, is listed once, and is found by its id and by its
/// number of points; every element offers a choice, and every rule serves an element.
#[test]
fn listed_rules_exist_and_are_found() {
    for element in all() {
        let fewest = if matches!(element.family, Family::Prism | Family::Pyramid) { 2 } else { 3 };
        assert!(element.quadratures.len() >= fewest, "{} lists {:?}", element.id, element.quadratures);
        for (at, id) in element.quadratures.iter().enumerate() {
            let rule = Rule::by_id(id).unwrap_or_else(|| panic!("{} lists {id}, which is no rule", element.id));
            assert_eq!(rule.family, element.family, "{} lists {id}", element.id);
            assert!(!element.quadratures[..at].contains(id), "{} lists {id} twice", element.id);
            for name in [id.to_string(), rule.points.len().to_string()] {
                assert_eq!(element.rule(&name).map(|r| r.id), Some(*id), "{}: `{name}`", element.id);
            }
        }
        assert_eq!(element.default_rule().id, element.quadratures[0]);
        assert!(element.rule("no such rule").is_none());
    }
    for rule in rules() {
        assert!(all().iter().any(|e| e.quadratures.contains(&rule.id)), "no element uses {}", rule.id);
    }
}
