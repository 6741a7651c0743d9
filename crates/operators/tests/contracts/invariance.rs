//! What a motion of the whole body may and may not change.

use crate::sample::{Sample, assert_close, dot, each, largest};

/// Forces of a body that is only moved along are those at rest to the last bit, whose only value is the rounding of
/// the law: differences of displacements are taken first.
#[test]
fn translations_give_no_force() {
    each(|sample| {
        let d = sample.dimension();
        let shift: Vec<f64> = (0..d).map(|_| sample.random.between(-3.0, 3.0)).collect();
        let u: Vec<f64> = (0..sample.elements.len()).map(|k| shift[k % d]).collect();
        let (moved, rest) = (sample.force(&u), sample.force(&vec![0.0; u.len()]));
        assert_eq!(moved, rest, "{}", sample.name());
        assert!(largest(&rest) <= 1e-13, "{}: {:e}", sample.name(), largest(&rest));
    });
}

/// Internal forces sum to zero in any state: momentum is conserved. So do tangent products.
#[test]
fn internal_forces_sum_to_zero() {
    each(|sample| {
        let d = sample.dimension();
        let u = sample.displacement();
        sample.elements.linearise(&u);
        let v = sample.direction();
        for f in [sample.force(&u), sample.tangent(&v)] {
            for axis in 0..d {
                let total: f64 = f.iter().skip(axis).step_by(d).sum();
                assert_close(&sample.name(), &[total], &[0.0], 1e-13 * f.len() as f64, largest(&f));
            }
        }
    });
}

/// A body that is only turned has no force, when its law is objective; scale: the stiffness times the motion.
#[test]
fn rotations_give_no_force_for_objective_laws() {
    each(|sample| {
        if !sample.law.objective || sample.dimension() == 1 {
            return;
        }
        let r = rotation(sample);
        let rest = vec![0.0; sample.elements.len()];
        let u = superposed(sample, &r, &rest);
        sample.elements.linearise(&rest);
        let scale = largest(&sample.tangent(&u)).max(largest(&u));
        let f = sample.force(&u);
        assert_close(&sample.name(), &f, &rest, 1e-10, scale);
    });
}

/// Internal forces of an objective law turn nothing: angular momentum is conserved.
#[test]
fn forces_of_objective_laws_have_no_torque() {
    each(|sample| {
        let d = sample.dimension();
        if !sample.law.objective {
            return;
        }
        let u = sample.displacement();
        let f = sample.force(&u);
        for (i, j) in [(0, 1), (1, 2), (2, 0)].into_iter().filter(|p| p.0.max(p.1) < d) {
            let at = |a: usize, k: usize| sample.nodes[a][k] + u[a * d + k];
            let torque: f64 = (0..sample.nodes.len()).map(|a| at(a, i) * f[a * d + j] - at(a, j) * f[a * d + i]).sum();
            assert_close(&sample.name(), &[torque], &[0.0], 1e-12 * f.len() as f64, largest(&f));
        }
    });
}

/// A rotation of the deformed body leaves the energy of an objective law as it is and turns its forces.
#[test]
fn superposed_rotations_turn_forces_and_keep_the_energy() {
    each(|sample| {
        let d = sample.dimension();
        if !sample.law.objective || d == 1 {
            return;
        }
        let u = sample.displacement();
        let r = rotation(sample);
        let turned = superposed(sample, &r, &u);
        let (w, w_turned) = (sample.elements.energy(&u), sample.elements.energy(&turned));
        // A small energy is the difference of terms of size one, whose rounding it has.
        assert_close(&sample.name(), &[w_turned], &[w], 1e-10, w.max(1e-4));
        let (f, f_turned) = (sample.force(&u), sample.force(&turned));
        let expected: Vec<f64> =
            f.chunks(d).flat_map(|f| (0..d).map(|i| dot(&r[i][..d], f)).collect::<Vec<_>>()).collect();
        assert_close(&sample.name(), &f_turned, &expected, 1e-10, largest(&f));
    });
}

/// The volume ratio of a homogeneous deformation F is det F at every quadrature point of every element.
#[test]
fn homogeneous_deformations_have_one_volume_ratio() {
    each(|sample| {
        if sample.embedded() {
            return;
        }
        let h = sample.gradient();
        let f = |i: usize, j: usize| h[i][j] + if i == j { 1.0 } else { 0.0 };
        let expected = f(0, 0) * (f(1, 1) * f(2, 2) - f(1, 2) * f(2, 1))
            - f(0, 1) * (f(1, 0) * f(2, 2) - f(1, 2) * f(2, 0))
            + f(0, 2) * (f(1, 0) * f(2, 1) - f(1, 1) * f(2, 0));
        let u = sample.homogeneous(&h);
        let program = sample.elements.blocks().next().unwrap().1.staged.program("volume_ratio").unwrap().clone();
        let rest: Vec<f64> = sample.nodes.iter().flat_map(|x| x[..sample.element.dimension()].to_vec()).collect();
        let inputs: Vec<Vec<f64>> = program
            .inputs
            .iter()
            .map(|b| match b.name.as_str() {
                "rest" => rest.clone(),
                "displacement" => u.clone(),
                name => crate::programs::carried_from_setup(sample, &rest, name),
            })
            .collect();
        let ratios = souple_kernels::oracle::run(&program, &inputs).remove(0);
        // One for each point, or one in all where the gradients of the shape functions are constant.
        assert!([1, sample.rule.points.len()].contains(&ratios.len()), "{}: {}", sample.name(), ratios.len());
        for ratio in ratios {
            assert_close(&sample.name(), &[ratio.value], &[expected], 1e-12, expected);
        }
    });
}

/// A random rotation matrix, in the first plane for plane elements.
/// By Rodrigues' formula R = I + s N + (1 − c) N² with N = [n]×.
fn rotation(sample: &mut Sample) -> [[f64; 3]; 3] {
    let angle = sample.random.between(0.3, 3.0);
    let n = if sample.dimension() == 2 {
        [0.0, 0.0, 1.0]
    } else {
        let n: [f64; 3] = std::array::from_fn(|_| sample.random.between(-1.0, 1.0));
        n.map(|c| c / dot(&n, &n).sqrt())
    };
    let (s, c) = angle.sin_cos();
    let cross = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]];
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let one = if i == j { c } else { 0.0 };
            one + s * cross[i][j] + (1.0 - c) * n[i] * n[j]
        })
    })
}

/// `R (X + u) − X + t` with an arbitrary translation.
fn superposed(sample: &Sample, r: &[[f64; 3]; 3], u: &[f64]) -> Vec<f64> {
    let d = sample.dimension();
    let t = [0.4, -0.7, 0.2];
    let mut out = Vec::with_capacity(u.len());
    for (a, x) in sample.nodes.iter().enumerate() {
        let place: Vec<f64> = (0..d).map(|k| x[k] + u[a * d + k]).collect();
        out.extend((0..d).map(|i| dot(&r[i][..d], &place) - x[i] + t[i]));
    }
    out
}
