//! Definitions of element × law × quadrature evaluated as expressions, before any staging: closed forms per law, and
//! what every law and element must satisfy.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use souple_elements::{Element, Rule};
use souple_forms::{Definition, Loops, define};
use souple_laws::{Bound, Law, lame_from_young_poisson};
use souple_symbols::Expr;

fn solid() -> &'static Element {
    souple_elements::by_id("tet4").unwrap()
}

/// Parameters well inside their ranges.
fn parameters(law: &Law) -> Vec<f64> {
    let limit = |b: Bound| match b {
        Bound::None | Bound::NonZero => None,
        Bound::Open(v) | Bound::Closed(v) => Some(v),
    };
    let inside = |low: Option<f64>, high: Option<f64>| match (low, high) {
        (Some(low), Some(high)) => low + 0.87 * (high - low),
        (Some(low), None) => low + 1.25,
        (None, Some(high)) => high - 1.25,
        (None, None) => 0.75,
    };
    law.parameters.iter().map(|p| p.default.unwrap_or_else(|| inside(limit(p.minimum), limit(p.maximum)))).collect()
}

/// Energy density and first Piola–Kirchhoff stress (row by row) at a displacement gradient, row by row.
fn density_and_stress(law: &Law, parameters: &[f64], h: [f64; 9]) -> (f64, Vec<f64>) {
    let d = define(solid(), law, solid().default_rule(), Loops::Rolled, 3);
    let mut symbols: Vec<(Expr, f64)> = d.parameters.iter().copied().zip(parameters.iter().copied()).collect();
    symbols.extend(d.displacement_gradient.entries.iter().flatten().copied().zip(h));
    let roots: Vec<Expr> = std::iter::once(d.energy_density).chain(d.stress.iter().copied()).collect();
    let values = d.graph.evaluate(&roots, &symbols);
    (values[0], values[1..].to_vec())
}

fn assert_close(what: &str, got: &[f64], want: &[f64]) {
    let scale = want.iter().fold(1e-12_f64, |m, w| m.max(w.abs()));
    for (k, (g, w)) in got.iter().zip(want).enumerate() {
        assert!((g - w).abs() <= 1e-13 * scale, "{what}: entry {k} is {g:e}, expected {w:e}");
    }
    assert_eq!(got.len(), want.len(), "{what}");
}

/// Closed forms of Hooke's law: P = σ = λ tr(ε) I + 2με.
#[test]
fn hooke_has_its_closed_forms() {
    let law = souple_laws::by_id("hooke").unwrap();
    let (young, poisson) = (2.0, 0.3);
    let (lambda, mu) = lame_from_young_poisson(young, poisson);
    let e = 0.2;
    // Uniaxial stress gives Young's modulus: the bar thins by Poisson's ratio.
    let thin = -poisson * e;
    let bar = [e, 0.0, 0.0, 0.0, thin, 0.0, 0.0, 0.0, thin];
    let (w, p) = density_and_stress(law, &[young, poisson], bar);
    assert_close("uniaxial", &p, &[young * e, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_close("uniaxial energy", &[w], &[0.5 * young * e * e]);
    let shear = [0.0, e, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let (w, p) = density_and_stress(law, &[young, poisson], shear);
    assert_close("shear", &p, &[0.0, mu * e, 0.0, mu * e, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_close("shear energy", &[w], &[0.5 * mu * e * e]);
    let swell = [e, 0.0, 0.0, 0.0, e, 0.0, 0.0, 0.0, e];
    let pressure = (3.0 * lambda + 2.0 * mu) * e;
    let (_, p) = density_and_stress(law, &[young, poisson], swell);
    assert_close("swelling", &p, &[pressure, 0.0, 0.0, 0.0, pressure, 0.0, 0.0, 0.0, pressure]);
}

/// Closed forms of St.Venant–Kirchhoff: P = F (λ tr(E) I + 2μE).
#[test]
fn stvk_has_its_closed_forms() {
    let law = souple_laws::by_id("stvk").unwrap();
    let (lambda, mu) = lame_from_young_poisson(2.0, 0.3);
    // Uniaxial strain by a stretch s: E_xx = (s² − 1)/2.
    let s = 1.3_f64;
    let e = 0.5 * (s * s - 1.0);
    let (w, p) = density_and_stress(law, &[2.0, 0.3], [s - 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let (along, across) = (s * (lambda + 2.0 * mu) * e, lambda * e);
    assert_close("uniaxial strain", &p, &[along, 0.0, 0.0, 0.0, across, 0.0, 0.0, 0.0, across]);
    assert_close("uniaxial strain energy", &[w], &[0.5 * (lambda + 2.0 * mu) * e * e]);
    // Simple shear γ: E = [[0, γ/2], [γ/2, γ²/2]], S = λ γ²/2 I + 2μE, P = F S.
    let c = 0.4_f64;
    let (_, p) = density_and_stress(law, &[2.0, 0.3], [0.0, c, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let (t, s_xy, s_yy) = (0.5 * lambda * c * c, mu * c, (0.5 * lambda + mu) * c * c);
    assert_close("simple shear", &p, &[t + c * s_xy, s_xy + c * s_yy, 0.0, s_xy, s_yy, 0.0, 0.0, 0.0, t]);
    // A stretch in all directions.
    let p_all = s * (3.0 * lambda + 2.0 * mu) * e;
    let (_, p) = density_and_stress(law, &[2.0, 0.3], [s - 1.0, 0.0, 0.0, 0.0, s - 1.0, 0.0, 0.0, 0.0, s - 1.0]);
    assert_close("swelling", &p, &[p_all, 0.0, 0.0, 0.0, p_all, 0.0, 0.0, 0.0, p_all]);
}

/// Every law is without energy and stress at rest, and agrees with Hooke's to first order when it has his parameters.
#[test]
fn laws_start_from_rest() {
    let hooke = souple_laws::by_id("hooke").unwrap();
    let h = [0.3, -0.2, 0.5, 0.1, 0.4, -0.6, 0.2, -0.1, 0.7];
    for law in souple_laws::all() {
        let parameters = parameters(law);
        let (w, p) = density_and_stress(law, &parameters, [0.0; 9]);
        assert!(w.abs() < 1e-15, "{}: energy {w:e} at rest", law.id);
        assert!(p.iter().all(|p| p.abs() < 1e-14), "{}: stress {p:?} at rest", law.id);
        if law.parameters.iter().map(|p| p.name).eq(["young", "poisson"]) {
            let small = 1e-5;
            let (_, p) = density_and_stress(law, &parameters, h.map(|h| small * h));
            let (_, linear) = density_and_stress(hooke, &parameters, h.map(|h| small * h));
            for (a, b) in p.iter().zip(&linear) {
                assert!((a - b).abs() < 20.0 * small * small, "{}: {a:e}, Hooke {b:e}", law.id);
            }
        }
    }
}

/// τ = P Fᵀ is symmetric for every objective law: the material takes no torque.
#[test]
fn stresses_of_objective_laws_are_symmetric() {
    let h = [0.1, -0.2, 0.05, 0.15, 0.2, -0.1, 0.02, 0.12, -0.08];
    for law in souple_laws::all().iter().filter(|l| l.objective) {
        let (_, p) = density_and_stress(law, &parameters(law), h);
        let f = |i: usize, j: usize| h[3 * i + j] + if i == j { 1.0 } else { 0.0 };
        let tau = |i: usize, j: usize| (0..3).map(|k| p[3 * i + k] * f(j, k)).sum::<f64>();
        let scale = p.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            assert!((tau(i, j) - tau(j, i)).abs() <= 1e-13 * scale, "{}: τ_{i}{j} ≠ τ_{j}{i}", law.id);
        }
    }
}

/// Values of a definition on the reference element with a fixed pattern of displacements.
fn evaluate(d: &Definition, element: &Element, law: &Law) -> Vec<(&'static str, Vec<f64>)> {
    let mut symbols: Vec<(Expr, Vec<f64>)> = Vec::new();
    let mut give = |leaves: &[Expr], value: &dyn Fn(usize) -> f64| {
        symbols.extend(leaves.iter().enumerate().map(|(k, &e)| (e, vec![value(k)])));
    };
    let pattern = |k: usize| ((k * k * 7 + 3 * k) % 11) as f64 / 11.0 - 0.5;
    let axes = d.dimension;
    give(&d.rest, &|k| element.nodes[k / axes][k % axes] * (1.0 + 0.2 * (k % axes) as f64) + 0.01 * pattern(k + 5));
    give(&d.displacement, &|k| 0.02 * pattern(k));
    give(&d.direction, &|k| pattern(k + 3));
    let values = parameters(law);
    give(&d.parameters, &|k| values[k]);
    give(&[d.density], &|_| 1.5);
    let of = |roots: &[Expr]| -> Vec<f64> {
        d.graph.evaluate_at_points(roots, &symbols).into_iter().map(|v| v[0]).collect()
    };
    vec![
        ("energy", of(&[d.energy])),
        ("force", of(&d.force)),
        ("tangent_apply", of(&d.tangent_apply)),
        ("tangent_blocks", of(&d.tangent_blocks)),
        ("deformed_volume", of(&[d.deformed_volume])),
        ("shape_mass", of(&d.shape_mass)),
        ("lumped_mass", of(&d.lumped_mass)),
    ]
}

/// Rolled and unrolled definitions are the same functions, for every element and law with the default rule.
#[test]
fn rolled_and_unrolled_definitions_agree() {
    for element in souple_elements::all() {
        let rule: &Rule = element.default_rule();
        // Unrolled definitions grow with nodes × points; the larger elements differ in numbers only.
        if element.node_count() * rule.points.len() > 80 {
            continue;
        }
        for law in souple_laws::all() {
            let values = |loops| evaluate(&define(element, law, rule, loops, element.dimension()), element, law);
            for ((name, rolled), (_, unrolled)) in values(Loops::Rolled).into_iter().zip(values(Loops::Unrolled)) {
                let scale = rolled.iter().fold(1e-300_f64, |m, v| m.max(v.abs()));
                assert_eq!(rolled.len(), unrolled.len(), "{} {} {name}", element.id, law.id);
                for (r, u) in rolled.iter().zip(&unrolled) {
                    assert!((r - u).abs() <= 1e-12 * scale, "{} {} {name}: {r:e} and {u:e}", element.id, law.id);
                }
            }
        }
    }
}

/// Only leaves that are known at its time appear in a value: Hooke's tangent knows nothing of the state.
#[test]
fn values_have_the_time_of_their_leaves() {
    use souple_symbols::Time;
    for element in souple_elements::all().iter().filter(|e| e.degree == 1) {
        for law in souple_laws::all() {
            let d = define(element, law, element.default_rule(), Loops::Rolled, element.dimension());
            let latest = |roots: &[Expr]| roots.iter().map(|&e| d.graph.time(e)).max().unwrap();
            assert!(latest(&d.shape_mass) <= Time::Setup && latest(&d.lumped_mass) <= Time::Setup, "{}", element.id);
            assert_eq!(latest(&d.force), Time::Step, "{} {}", element.id, law.id);
            assert_eq!(latest(&d.tangent_apply), Time::Apply, "{} {}", element.id, law.id);
            let blocks = if law.id == "hooke" { Time::Setup } else { Time::Step };
            assert_eq!(latest(&d.tangent_blocks), blocks, "{} {}", element.id, law.id);
        }
    }
}
