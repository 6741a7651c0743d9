//! Verdicts find what is wrong with a law and nothing else; curves are those of the textbook.

use crate::sample::responses;
use souple_laws::check::{
    AtRest, Check, CurveKind, Inversion, Outcome, Ranges, at_rest, curves, inversion, judge, svg,
};
use souple_laws::user::{ParameterValue, UserLaw};
use souple_laws::{Response, by_id};

fn user(text: &str, parameters: &[(&str, f64)]) -> Response {
    let parameters: Vec<(&str, ParameterValue)> =
        parameters.iter().map(|p| (p.0, ParameterValue::Number(p.1))).collect();
    UserLaw::parse(text, &parameters).unwrap_or_else(|e| panic!("{e}\n{}", e.excerpt())).response()
}

/// Every law of the registry is finite, stable and free of stress at rest; rotations limit just those that say so.
#[test]
fn registry_laws_pass() {
    for (law, parameters, response) in responses() {
        let verdict = judge(&response);
        assert!(verdict.passed(), "{} {parameters:?}: {verdict:#?}", law.id);
        assert_eq!(verdict.findings.iter().map(|f| f.check).collect::<Vec<_>>(), Check::ALL);
        let objective = verdict.findings.iter().find(|f| f.check == Check::Objective).unwrap();
        assert_eq!(objective.outcome == Outcome::Passed, law.objective, "{}", law.id);
        let small = verdict.small_strain.unwrap();
        assert!(small.young.iter().chain(&small.shear).all(|m| *m > 0.0), "{}: {small:?}", law.id);
    }
}

/// Moduli at small strain are Young's modulus and those that follow from it.
#[test]
fn small_strain_has_the_moduli() {
    let response = Response::new(by_id("neo-hookean").unwrap(), &[9.0, 0.25]).unwrap();
    let small = at_rest(&response).unwrap();
    let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
    small.young.iter().for_each(|&young| close(young, 9.0));
    small.shear.iter().for_each(|&shear| close(shear, 3.6));
    close(small.bulk, 6.0);
    small.eigenvalues[..5].iter().for_each(|&e| close(e, 7.2));
    close(small.eigenvalues[5], 18.0);
    let fibres = Response::new(by_id("transverse-stvk").unwrap(), &[9.0, 0.25, 30.0, 0.0, 2.0, 0.0]).unwrap();
    close(at_rest(&fibres).unwrap().young[1], 30.0);
}

/// Laws that cannot be simulated are told apart, each by the check that it fails and by no earlier one.
#[test]
fn faulty_laws_fail() {
    let outcome =
        |response: &Response, check| judge(response).findings.into_iter().find(|f| f.check == check).unwrap().outcome;
    for text in ["mu*ln(I1 - 3)", "mu*(I1 - 3)/(J - 1)", "mu*(I1bar - 3)^1.5 + mu*(J - 1)^2", "mu*sqrt(J - 1)"] {
        let response = user(text, &[("mu", 1.0)]);
        assert!(matches!(at_rest(&response), Err(AtRest::NotFinite { .. })), "{text}");
        assert_eq!(outcome(&response, Check::FiniteAtRest), Outcome::Failed, "{text}");
        assert_eq!(outcome(&response, Check::Derivatives), Outcome::NotJudged, "{text}");
    }
    for text in ["mu/2*(I1 - 3)", "mu*J + mu*tr(E*E)", "mu*F[1,1] + mu*tr(E*E)"] {
        let response = user(text, &[("mu", 1.0)]);
        let error = at_rest(&response).unwrap_err();
        assert!(matches!(error, AtRest::Stressed { .. }), "{text}: {error}");
        assert_eq!(outcome(&response, Check::StressFreeAtRest), Outcome::Failed, "{text}");
    }
    for text in ["mu*(I1bar - 3)", "mu*(J - 1)^2", "-mu*tr(E*E)", "0*mu", "mu*tr(E)^2 - mu*tr(E*E)"] {
        let response = user(text, &[("mu", 1.0)]);
        let error = at_rest(&response).unwrap_err();
        assert!(matches!(error, AtRest::Unstable { .. }), "{text}: {error}");
        assert_eq!(outcome(&response, Check::StableAtRest), Outcome::Failed, "{text}");
        assert!(!judge(&response).passed());
    }
    let small = user("mu*tr(epsilon*epsilon)", &[("mu", 1.0)]);
    assert_eq!(outcome(&small, Check::Objective), Outcome::Limited);
}

/// The energy may have any value at rest.
#[test]
fn a_constant_is_allowed() {
    assert!(judge(&user("7 + mu*tr(E*E)", &[("mu", 1.0)])).passed());
}

/// Uniaxial stress: Hooke's law is the straight line of Young's modulus; an incompressible neo-Hookean bar has
/// P = μ (s − s⁻²), which a large bulk modulus approaches; fibres along the bar carry what they should.
#[test]
fn bars_follow_the_textbook() {
    let uniaxial = |response: &Response| {
        let curve = curves(response, &Ranges::default()).remove(0);
        assert_eq!(curve.kind, CurveKind::Uniaxial);
        assert!(curve.ended.is_empty(), "{:?}", curve.ended);
        curve
    };
    let hooke = uniaxial(&Response::new(by_id("hooke").unwrap(), &[8.0, 0.3]).unwrap());
    assert!((hooke.points[0].abscissa, hooke.points.last().unwrap().abscissa) == (0.5, 2.0));
    for point in &hooke.points {
        assert!((point.ordinate - 8.0 * (point.abscissa - 1.0)).abs() < 1e-10, "{point:?}");
    }
    let (mu, bulk) = (2.0, 2e6);
    let rubber = uniaxial(&Response::new(by_id("mooney-rivlin").unwrap(), &[mu / 2.0, 0.0, bulk]).unwrap());
    for point in &rubber.points {
        let expected = mu * (point.abscissa - point.abscissa.powi(-2));
        assert!((point.ordinate - expected).abs() < 2e-5 * mu, "{point:?}, expected {expected}");
    }
    assert!(rubber.softens_at().is_empty());
    // St.Venant–Kirchhoff: S₁₁ = E E₁₁ with free sides, so P = s E (s² − 1)/2, least at s = 1/√3.
    let fibres = Response::new(by_id("transverse-stvk").unwrap(), &[5.0, 0.3, 8.0, 3.0, 0.0, 0.0]).unwrap();
    let stvk = uniaxial(&fibres);
    for point in &stvk.points {
        let s = point.abscissa;
        assert!((point.ordinate - s * 8.0 * (s * s - 1.0) / 2.0).abs() < 1e-9, "{point:?}");
    }
    let softens = stvk.softens_at();
    assert!(softens.len() == 1 && (softens[0] - 3f64.sqrt().recip()).abs() < 0.02, "{softens:?}");
}

/// A bar whose fibres lie across its axis shears when it is pulled; its sides are free all the same.
#[test]
fn oblique_fibres_leave_the_sides_free() {
    let response = Response::new(by_id("transverse-stvk").unwrap(), &[1.0, 0.3, 5.0, 1.0, 1.0, 0.3]).unwrap();
    let ranges = Ranges { stretch: (0.9, 1.3), ..Ranges::default() };
    let bar = curves(&response, &ranges).remove(0);
    let end = bar.points.last().unwrap();
    assert!(end.f[0][1].abs() > 1e-3, "it shears: {:?}", end.f);
    let stress = response.stress(&end.f);
    for (k, p) in stress.iter().flatten().enumerate().skip(1) {
        assert!(p.abs() < 1e-8, "P[{}][{}] = {p:e}", k / 3, k % 3);
    }
}

/// Shear and change of volume of the neo-Hookean law: P₁₂ = μ γ and tr σ / 3 = (μ (J^(2/3) − 1) + λ ln J) / J.
#[test]
fn shear_and_volume_follow_the_textbook() {
    let response = Response::new(by_id("neo-hookean").unwrap(), &[5.0, 0.25]).unwrap();
    let (lambda, mu) = souple_laws::lame_from_young_poisson(5.0, 0.25);
    let [_, shear, volume] = <[_; 3]>::try_from(curves(&response, &Ranges::default())).unwrap();
    for point in &shear.points {
        assert!((point.ordinate - mu * point.abscissa).abs() < 1e-13, "{point:?}");
    }
    for point in &volume.points {
        let j = point.abscissa;
        let expected = (mu * (j.powf(2.0 / 3.0) - 1.0) + lambda * j.ln()) / j;
        assert!((point.ordinate - expected).abs() < 1e-12, "{point:?}, expected {expected}");
    }
}

/// A law that has no answer somewhere ends its curve there and says so.
#[test]
fn curves_end_where_the_law_does() {
    let locking = user("mu*tr(E*E) - mu*ln(1 - 2*tr(E*E))", &[("mu", 1.0)]);
    let [bar, shear, volume] = <[_; 3]>::try_from(curves(&locking, &Ranges::default())).unwrap();
    assert!(bar.ended.len() == 1 && bar.points.iter().all(|p| p.ordinate.is_finite()), "{:?}", bar.ended);
    // tr E² < 1/2 stops a bar before E₁₁ = √½.
    let last = bar.points.last().unwrap().abscissa;
    assert!(last > 1.4 && last < (1.0 + 2f64.sqrt()).sqrt(), "{last}");
    assert!(shear.ended.len() == 2 && shear.ended[0].contains("energy is not finite"), "{:?}", shear.ended);
    assert!(volume.ended.is_empty());
}

/// Tables hold every point; drawings are well-formed, hold every point, and repeat themselves bit by bit.
#[test]
fn curves_are_written_down() {
    let response = Response::new(by_id("stvk").unwrap(), &[5e4, 0.25]).unwrap();
    for curve in curves(&response, &Ranges::default()) {
        let table = curve.table();
        assert_eq!(table.lines().count(), 1 + curve.points.len());
        let (x, y) = table.lines().nth(1).unwrap().split_once('\t').unwrap();
        assert_eq!((x.parse(), y.parse()), (Ok(curve.points[0].abscissa), Ok(curve.points[0].ordinate)));
        let drawing = svg(&curve);
        let line = drawing.lines().find(|l| l.starts_with("<polyline")).unwrap();
        let points = line.split('"').nth(1).unwrap();
        assert_eq!(points.split(' ').count(), curve.points.len());
        for point in points.split(' ') {
            let (x, y) = point.split_once(',').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!((0.0..=640.0).contains(&x) && (0.0..=400.0).contains(&y), "{point}");
        }
        assert!(drawing.starts_with("<svg") && drawing.ends_with("</svg>\n") && drawing.contains("kPa"));
        assert_eq!(drawing.matches("<text").count(), drawing.matches("</text>").count());
        assert!(drawing.matches("<text").count() > 10, "ticks and titles");
        assert_eq!(drawing, svg(&curve));
        assert!(!drawing.contains("NaN") && !drawing.contains("inf"));
    }
}

/// Laws with logarithms or negative powers of the volume ratio know no inverted state, polynomials of the strain do; a
/// law of I3 = J² has a number for an inverted state and no meaning, because its energy is infinite on the way there.
#[test]
fn inversion_is_fatal_to_laws_whose_energy_is_unbounded_at_zero_volume() {
    for (law, parameters, _) in responses() {
        let expected = match law.id {
            "hooke" | "corotational" | "stvk" | "transverse-stvk" | "stable-neo-hookean" => Inversion::Survivable,
            "neo-hookean" | "mooney-rivlin" | "yeoh" | "arruda-boyce" => Inversion::Fatal,
            // No promise for laws that this test does not know.
            _ => continue,
        };
        assert_eq!(inversion(law, &parameters), expected, "{}", law.id);
    }
    let parameters = [("mu", ParameterValue::Number(1.0)), ("lambda", ParameterValue::Number(2.0))];
    let law = UserLaw::parse("mu/2*(I1 - 3) - mu/2*ln(I3) + lambda/8*ln(I3)^2", &parameters).unwrap();
    let values = law.values();
    assert_eq!(inversion(law.into_law(), &values), Inversion::Fatal);
}
