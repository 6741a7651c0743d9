//! Means of stress and strain: what an element shows of a homogeneous deformation is that deformation's stress.

use crate::sample::{Sample, assert_close, each, largest, one_element, parameters};
use souple_kernels::Interpreter;
use souple_kernels_cpu::Cpu;
use souple_laws::Response;
use souple_laws::response::{IDENTITY, Tensor, determinant, product, tensor_from_fn, transpose};
use souple_operators::{Average, Elements, Mean};
use souple_program::Costs;

/// xx, yy, zz, xy, yz, zx of the symmetric part.
fn symmetric(a: &Tensor) -> [f64; 6] {
    [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)].map(|(i, j)| 0.5 * (a[i][j] + a[j][i]))
}

fn mean(elements: &mut Elements, average: Average, u: &[f64]) -> Mean {
    let mut means = Vec::new();
    elements.each_mean(average, u, |id, mean| means.push((id, mean)));
    assert_eq!(means.len(), 1, "one element");
    assert_eq!(means[0].0, 0, "its number");
    means[0].1
}

fn prepare(sample: &mut Sample) {
    let both = [Average::Stress, Average::Strain];
    sample.elements.prepare_means(&both, &Interpreter::default(), Costs::default()).unwrap();
}

/// Every element with every law and rule, distorted at rest and deformed homogeneously, shows σ = P Fᵀ/J over its
/// deformed volume (a law that is not objective: P over its volume at rest) and E = (FᵀF − I)/2 over its volume at rest,
/// the stresses across a plane included.
#[test]
fn homogeneous_deformations_show_their_stress_and_strain() {
    each(|sample| {
        // Elsewhere: what the deformation across is has to be found there.
        if sample.embedded() {
            return;
        }
        prepare(sample);
        let what = sample.name();
        let h = sample.gradient();
        let u = sample.homogeneous(&h);
        let f = tensor_from_fn(|i, j| h[i][j] + IDENTITY[i][j]);
        let j = determinant(&f);
        let piola = Response::new(sample.law, &parameters(sample.law)).unwrap().stress(&f);
        let kirchhoff = product(&piola, &transpose(&f));
        let stress = if sample.law.objective { tensor_from_fn(|r, c| kirchhoff[r][c] / j) } else { piola };
        let strain = product(&transpose(&f), &f);
        let strain = tensor_from_fn(|r, c| 0.5 * (strain[r][c] - IDENTITY[r][c]));
        let mut volume_at = |u: &[f64]| {
            let mut volume = f64::NAN;
            sample.elements.each_volume(u, |_, v| volume = v);
            volume
        };
        let (rest, deformed) = (volume_at(&vec![0.0; u.len()]), volume_at(&u));
        assert_close(&what, &[deformed], &[j * rest], 1e-12, rest);

        let expected = symmetric(&stress);
        let found = mean(&mut sample.elements, Average::Stress, &u);
        assert!(largest(&expected) > 1e-3, "{what}: stress {expected:?} shows nothing");
        assert_close(&format!("{what}: stress"), &found.tensor, &expected, 1e-11, largest(&expected).max(1.0));
        let volume = if sample.law.objective { deformed } else { rest };
        assert_close(&format!("{what}: volume of the stress"), &[found.volume], &[volume], 1e-12, rest);

        let found = mean(&mut sample.elements, Average::Strain, &u);
        assert_close(&format!("{what}: strain"), &found.tensor, &symmetric(&strain), 1e-12, 1.0);
        assert_close(&format!("{what}: volume of the strain"), &[found.volume], &[rest], 1e-12, rest);
    });
}

/// Rest shows no stress and no strain, whatever the shape.
#[test]
fn rest_shows_nothing() {
    each(|sample| {
        prepare(sample);
        let zero = vec![0.0; sample.elements.len()];
        for average in [Average::Stress, Average::Strain] {
            let found = mean(&mut sample.elements, average, &zero);
            assert_close(&sample.name(), &found.tensor, &[0.0; 6], 1e-13, 1.0);
        }
    });
}

/// The stress across a plane of Hooke's law is ν (σ_xx + σ_yy), of inhomogeneous deformations too, and shears across it
/// are zero.
#[test]
fn plane_strain_has_a_stress_across() {
    let compared = std::cell::Cell::new(0);
    each(|sample| {
        if sample.embedded() || sample.dimension() != 2 || sample.law.id != "hooke" {
            return;
        }
        prepare(sample);
        let u = sample.displacement();
        let poisson = parameters(sample.law)[1];
        let [xx, yy, zz, xy, yz, zx] = mean(&mut sample.elements, Average::Stress, &u).tensor;
        assert!(zz.abs() > 1e-3 && xy.abs() > 1e-6, "{}: {zz} and {xy} show nothing", sample.name());
        assert_close(&sample.name(), &[zz, yz, zx], &[poisson * (xx + yy), 0.0, 0.0], 1e-12, 1.0);
        compared.set(compared.get() + 1);
    });
    assert!(compared.get() >= 3, "{} planes", compared.get());
}

/// The processor gives what the interpreter gives, for inhomogeneous deformations.
#[test]
fn backends_agree_on_means() {
    each(|sample| {
        // One rule of each element and law is enough: others differ in numbers only.
        if sample.rule.id != sample.element.default_rule().id {
            return;
        }
        prepare(sample);
        let u = sample.displacement();
        let (mut other, _) =
            one_element(sample.element, sample.law, sample.rule, sample.space, &sample.nodes, sample.density);
        let both = [Average::Stress, Average::Strain];
        other.prepare_means(&both, &Cpu::open(), Costs::default()).unwrap();
        for average in both {
            let (a, b) = (mean(&mut sample.elements, average, &u), mean(&mut other, average, &u));
            let scale = largest(&a.tensor).max(1.0);
            assert_close(&sample.name(), &b.tensor, &a.tensor, 1e-11, scale);
            assert_close(&sample.name(), &[b.volume], &[a.volume], 1e-12, a.volume);
        }
    });
}
