//! The algebra of one quadrature point on vectors of elements: stress from strain, and their derivatives.

use crate::vectors::{Mat3, Row, Vec3, load, store};
use pulp::Simd;

/// Places kept per point by a linearisation: F by rows, then wS as xx, yy, zz, yz, xz, xy.
pub(super) const KEPT: usize = 15;

/// Which entry of the upper triangle stands at [row][column].
const ENTRY: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// A symmetric matrix: xx, yy, zz, yz, xz, xy.
pub(super) type Symmetric<S> = [<S as Simd>::f64s; 6];

/// Σ aₖ bₖ.
#[inline(always)]
fn dot<S: Simd>(simd: S, a: Vec3<S>, b: Vec3<S>) -> S::f64s {
    simd.mul_add_f64s(a[2], b[2], simd.mul_add_f64s(a[1], b[1], simd.mul_f64s(a[0], b[0])))
}

/// Column of a matrix.
#[inline(always)]
fn column<S: Simd>(m: Mat3<S>, j: usize) -> Vec3<S> {
    [m[0][j], m[1][j], m[2][j]]
}

/// m + a ⊗ b.
#[inline(always)]
pub(super) fn add_outer<S: Simd>(simd: S, m: Mat3<S>, a: Vec3<S>, b: Vec3<S>) -> Mat3<S> {
    let mut out = m;
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = simd.mul_add_f64s(a[i], b[j], m[i][j]);
        }
    }
    out
}

/// m b.
#[inline(always)]
pub(super) fn times<S: Simd>(simd: S, m: Mat3<S>, b: Vec3<S>) -> Vec3<S> {
    [dot(simd, m[0], b), dot(simd, m[1], b), dot(simd, m[2], b)]
}

/// a + m b.
#[inline(always)]
pub(super) fn add_times<S: Simd>(simd: S, a: Vec3<S>, m: Mat3<S>, b: Vec3<S>) -> Vec3<S> {
    let mut out = a;
    for i in 0..3 {
        for j in 0..3 {
            out[i] = simd.mul_add_f64s(m[i][j], b[j], out[i]);
        }
    }
    out
}

/// a − b.
#[inline(always)]
pub(super) fn minus<S: Simd>(simd: S, a: Vec3<S>, b: Vec3<S>) -> Vec3<S> {
    [simd.sub_f64s(a[0], b[0]), simd.sub_f64s(a[1], b[1]), simd.sub_f64s(a[2], b[2])]
}

/// Every entry the same.
#[inline(always)]
pub(super) fn diagonal<S: Simd>(simd: S, value: f64) -> Mat3<S> {
    let (zero, value) = (simd.splat_f64s(0.0), simd.splat_f64s(value));
    [[value, zero, zero], [zero, value, zero], [zero, zero, value]]
}

/// m s, s being symmetric.
#[inline(always)]
fn times_symmetric<S: Simd>(simd: S, m: Mat3<S>, s: Symmetric<S>) -> Mat3<S> {
    let mut out = m;
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = dot(simd, m[i], [s[ENTRY[0][j]], s[ENTRY[1][j]], s[ENTRY[2][j]]]);
        }
    }
    out
}

/// wS from F, with `moduli` = (λ/2, μ) and the negative weight w.
#[inline(always)]
pub(super) fn stress<S: Simd>(simd: S, f: Mat3<S>, moduli: [S::f64s; 2], w: S::f64s) -> Symmetric<S> {
    let [x, y, z] = [column::<S>(f, 0), column::<S>(f, 1), column::<S>(f, 2)];
    let [l, m] = [simd.mul_f64s(w, moduli[0]), simd.mul_f64s(w, moduli[1])];
    let [xx, yy, zz] = [dot(simd, x, x), dot(simd, y, y), dot(simd, z, z)];
    let excess = simd.sub_f64s(simd.add_f64s(simd.add_f64s(xx, yy), zz), simd.splat_f64s(3.0));
    let pressure = simd.sub_f64s(simd.mul_f64s(l, excess), m);
    [
        simd.mul_add_f64s(m, xx, pressure),
        simd.mul_add_f64s(m, yy, pressure),
        simd.mul_add_f64s(m, zz, pressure),
        simd.mul_f64s(m, dot(simd, y, z)),
        simd.mul_f64s(m, dot(simd, x, z)),
        simd.mul_f64s(m, dot(simd, x, y)),
    ]
}

/// w P = F wS.
#[inline(always)]
pub(super) fn first_stress<S: Simd>(simd: S, f: Mat3<S>, s: Symmetric<S>) -> Mat3<S> {
    times_symmetric(simd, f, s)
}

/// w dP = dF wS + F w dS.
#[inline(always)]
pub(super) fn first_stress_change<S: Simd>(
    simd: S,
    f: Mat3<S>,
    s: Symmetric<S>,
    df: Mat3<S>,
    moduli: [S::f64s; 2],
    w: S::f64s,
) -> Mat3<S> {
    let [l, m] = [simd.mul_f64s(w, moduli[0]), simd.mul_f64s(w, moduli[1])];
    let [twice_l, twice_m] = [simd.add_f64s(l, l), simd.add_f64s(m, m)];
    let a = |i: usize, j: usize| dot(simd, column::<S>(f, i), column::<S>(df, j));
    let [xx, yy, zz] = [a(0, 0), a(1, 1), a(2, 2)];
    let pressure = simd.mul_f64s(twice_l, simd.add_f64s(simd.add_f64s(xx, yy), zz));
    let shear = |i: usize, j: usize| {
        let [fi, fj, di, dj] = [column::<S>(f, i), column::<S>(f, j), column::<S>(df, i), column::<S>(df, j)];
        let mut sum = dot(simd, fi, dj);
        for k in 0..3 {
            sum = simd.mul_add_f64s(fj[k], di[k], sum);
        }
        simd.mul_f64s(m, sum)
    };
    let ds = [
        simd.mul_add_f64s(twice_m, xx, pressure),
        simd.mul_add_f64s(twice_m, yy, pressure),
        simd.mul_add_f64s(twice_m, zz, pressure),
        shear(1, 2),
        shear(0, 2),
        shear(0, 1),
    ];
    let mut out = times_symmetric(simd, df, s);
    for i in 0..3 {
        for j in 0..3 {
            for k in 0..3 {
                out[i][j] = simd.mul_add_f64s(f[i][k], ds[ENTRY[k][j]], out[i][j]);
            }
        }
    }
    out
}

/// Writes F and wS.
#[inline(always)]
pub(super) fn keep<S: Simd>(rows: &mut [Row; KEPT], part: usize, f: Mat3<S>, s: Symmetric<S>) {
    for i in 0..3 {
        for j in 0..3 {
            store::<S>(&mut rows[3 * i + j], part, f[i][j]);
        }
    }
    for (k, s) in s.into_iter().enumerate() {
        store::<S>(&mut rows[9 + k], part, s);
    }
}

/// Reads F and wS.
#[inline(always)]
pub(super) fn kept<S: Simd>(rows: &[Row; KEPT], part: usize) -> (Mat3<S>, Symmetric<S>) {
    let at = |k: usize| load::<S>(&rows[k], part);
    let f = [[at(0), at(1), at(2)], [at(3), at(4), at(5)], [at(6), at(7), at(8)]];
    (f, [at(9), at(10), at(11), at(12), at(13), at(14)])
}
