//! Forces are the slope of the energy, tangent products that of the forces, and tangents are symmetric.
//!
//! Slopes are taken by central differences of fourth order along random directions,
//! g' ≈ (8 (g(h) − g(−h)) − (g(2h) − g(−2h))) / 12h: exact for the polynomial energies, and for the others wrong by a
//! multiple of h⁴.

use crate::sample::{assert_close, dot, each, largest, plus};

const H: f64 = 2e-4;

fn slope(mut along: impl FnMut(f64) -> Vec<f64>) -> Vec<f64> {
    let near = plus(&along(H), -1.0, &along(-H));
    let far = plus(&along(2.0 * H), -1.0, &along(-2.0 * H));
    near.iter().zip(&far).map(|(n, f)| (8.0 * n - f) / (12.0 * H)).collect()
}

/// f · d = −dW/dd for random directions d.
#[test]
fn forces_are_minus_the_slope_of_the_energy() {
    each(|sample| {
        let u = sample.displacement();
        let f = sample.force(&u);
        for _ in 0..3 {
            let d = sample.direction();
            let dw = slope(|s| vec![sample.elements.energy(&plus(&u, s, &d))]);
            let scale = f.iter().zip(&d).map(|(a, b)| (a * b).abs()).sum();
            assert_close(&sample.name(), &[-dot(&f, &d)], &dw, 1e-8, scale);
        }
    });
}

/// (∂f/∂u) v is the slope of the forces along v.
#[test]
fn tangent_products_are_the_slope_of_the_forces() {
    each(|sample| {
        let u = sample.displacement();
        sample.elements.linearise(&u);
        for _ in 0..2 {
            let v = sample.direction();
            let product = sample.tangent(&v);
            let df = slope(|s| sample.force(&plus(&u, s, &v)));
            assert_close(&sample.name(), &product, &df, 1e-8, largest(&df));
        }
    });
}

/// vᵀ K w = wᵀ K v.
#[test]
fn tangents_are_symmetric() {
    each(|sample| {
        let u = sample.displacement();
        sample.elements.linearise(&u);
        let (v, w) = (sample.direction(), sample.direction());
        let (kv, kw) = (sample.tangent(&v), sample.tangent(&w));
        let scale: f64 = w.iter().zip(&kv).map(|(a, b)| (a * b).abs()).sum();
        assert_close(&sample.name(), &[dot(&w, &kv)], &[dot(&v, &kw)], 1e-12, scale);
    });
}

/// At rest there is neither energy nor force, and no small motion lowers the energy.
#[test]
fn rest_is_a_minimum_without_force() {
    each(|sample| {
        let rest = vec![0.0; sample.elements.len()];
        assert!(sample.elements.energy(&rest).abs() <= 1e-13, "{}", sample.name());
        assert!(largest(&sample.force(&rest)) <= 1e-13, "{}", sample.name());
        sample.elements.linearise(&rest);
        for _ in 0..3 {
            let v = sample.direction();
            let kv = sample.tangent(&v);
            assert!(dot(&v, &kv) < 0.0, "{}: v·(∂f/∂u)v = {:e} at rest", sample.name(), dot(&v, &kv));
        }
    });
}
