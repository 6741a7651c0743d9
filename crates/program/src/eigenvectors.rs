//! Eigenvalues and eigenvectors of a symmetric 3 × 3 matrix as straight-line arithmetic: Jacobi's rotations, written out.
//!
//! One rotation makes the entry (p, q) vanish. With δ = m_pp − m_qq and β = 2 m_pq its tangent, of at most 45°, is
//!
//! ```text
//! t = β / (δ + sign(δ) √(δ² + β²)) = β δ / (δ² + √(δ² (δ² + β²)))
//! ```
//!
//! in which the second form needs no sign, hence no branch.
//! A number that is too small to matter is added to δ, so that equal diagonal entries turn by 45° and zeros by nothing.
//!
//! Four sweeps over the three entries leave less than 1e-20 of the matrix off the diagonal, whatever its eigenvalues: far
//! apart, nearly equal or equal. (After three it can be 4e-6, after eleven rotations 2e-14: the order of convergence is
//! quadratic or better.)
//! For repeated eigenvalues the rotations give some orthonormal basis of what belongs to them; functions of the matrix
//! do not depend on which.
//!
//! Why not the roots of the characteristic polynomial: where two of them meet they lose half of their digits, and the
//! vectors all of theirs.

use crate::{Dag, Operation, Ref};

/// Rotations: four sweeps.
const ROTATIONS: usize = 12;
/// Entry that each rotation of a sweep removes, and the index that it leaves out.
const SWEEP: [(usize, usize, usize); 3] = [(0, 1, 2), (0, 2, 1), (1, 2, 0)];
/// What is added to a difference of diagonal entries, in units of the size of the matrix.
const NEGLIGIBLE: f64 = 1e-19;

/// Values and unit vectors, in no particular order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eigen {
    /// Eigenvalues.
    pub(crate) values: [Ref; 3],
    /// Components of the eigenvectors, [row][which].
    pub(crate) vectors: [[Ref; 3]; 3],
}

/// Decomposes the matrix with the entries 11, 22, 33, 12, 23, 31. Entries that are zero for sure cost nothing.
pub(crate) fn eigen(dag: &mut Dag, entries: [Ref; 6]) -> Eigen {
    let mut a = Arithmetic::new(dag);
    let [xx, yy, zz, xy, yz, zx] = entries;
    let mut m = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let mut n = [[a.one, a.zero, a.zero], [a.zero, a.one, a.zero], [a.zero, a.zero, a.one]];
    let mut negligible = None;
    for k in 0..ROTATIONS {
        let (p, q, r) = SWEEP[k % 3];
        if m[p][q] == a.zero {
            continue;
        }
        let negligible = *negligible.get_or_insert_with(|| a.negligible(&entries));
        let (t, c, s) = a.rotation(m[p][p], m[q][q], m[p][q], negligible);
        let change = a.mul(t, m[p][q]);
        m[p][p] = a.add(m[p][p], change);
        m[q][q] = a.sub(m[q][q], change);
        (m[p][q], m[q][p]) = (a.zero, a.zero);
        (m[p][r], m[q][r]) = a.turned(m[p][r], m[q][r], c, s);
        (m[r][p], m[r][q]) = (m[p][r], m[q][r]);
        for row in &mut n {
            (row[p], row[q]) = a.turned(row[p], row[q], c, s);
        }
    }
    Eigen { values: [m[0][0], m[1][1], m[2][2]], vectors: n }
}

/// Sums and products that leave out zeros and ones.
struct Arithmetic<'d> {
    dag: &'d mut Dag,
    zero: Ref,
    one: Ref,
    four: Ref,
}

impl Arithmetic<'_> {
    fn new(dag: &mut Dag) -> Arithmetic<'_> {
        let [zero, one, four] = [0.0, 1.0, 4.0].map(|x| dag.constant(x));
        Arithmetic { dag, zero, one, four }
    }

    fn mul(&mut self, x: Ref, y: Ref) -> Ref {
        if x == self.zero || y == self.zero {
            self.zero
        } else if x == self.one {
            y
        } else if y == self.one {
            x
        } else {
            self.dag.add(Operation::Mul(x, y))
        }
    }

    fn add(&mut self, x: Ref, y: Ref) -> Ref {
        if x == self.zero {
            y
        } else if y == self.zero {
            x
        } else {
            self.dag.add(Operation::Add(x, y))
        }
    }

    fn sub(&mut self, x: Ref, y: Ref) -> Ref {
        if y == self.zero {
            x
        } else if x == self.zero {
            self.dag.add(Operation::Neg(y))
        } else {
            self.dag.add(Operation::Sub(x, y))
        }
    }

    /// [`NEGLIGIBLE`] times the root of the sum of squares.
    fn negligible(&mut self, entries: &[Ref; 6]) -> Ref {
        let mut sum = self.zero;
        for &e in entries {
            let square = self.mul(e, e);
            sum = self.add(sum, square);
        }
        let size = self.dag.add(Operation::Sqrt(sum));
        let share = self.dag.constant(NEGLIGIBLE);
        self.mul(share, size)
    }

    /// Tangent, cosine and sine of the rotation for diagonal entries `x`, `y` and the entry `z` between them.
    fn rotation(&mut self, x: Ref, y: Ref, z: Ref, negligible: Ref) -> (Ref, Ref, Ref) {
        let difference = self.sub(x, y);
        let difference = self.add(difference, negligible);
        let between = self.add(z, z);
        let squared = self.mul(difference, difference);
        let quarter = self.mul(z, z);
        let fourfold = self.mul(self.four, quarter);
        let whole = self.add(squared, fourfold);
        let product = self.mul(squared, whole);
        let root = self.dag.add(Operation::Sqrt(product));
        let sum = self.add(squared, root);
        // The zero matrix divides by this instead of by zero.
        let least = self.dag.constant(1e-200);
        let sum = self.add(sum, least);
        let inverse = self.dag.add(Operation::Recip(sum));
        let numerator = self.mul(between, difference);
        let t = self.mul(numerator, inverse);
        let secant = self.mul(t, t);
        let secant = self.add(secant, self.one);
        let secant = self.dag.add(Operation::Sqrt(secant));
        let c = self.dag.add(Operation::Recip(secant));
        let s = self.mul(t, c);
        (t, c, s)
    }

    /// (c x + s y, c y − s x).
    fn turned(&mut self, x: Ref, y: Ref, c: Ref, s: Ref) -> (Ref, Ref) {
        let (cx, sy, cy, sx) = (self.mul(c, x), self.mul(s, y), self.mul(c, y), self.mul(s, x));
        (self.add(cx, sy), self.sub(cy, sx))
    }
}

/// Halvings of the argument of [`sinhc`].
const HALVINGS: usize = 5;

/// sinh(x)/x in sums and products of positive numbers only, so that nothing cancels, at zero neither.
///
/// For y = x/2⁵ the series of w = (cosh y − 1)/y² gives sinh(y)/y = √(w (y² w + 2)); each doubling is
/// sinhc(2y) = sinhc(y) cosh(y), with p = cosh − 1 going on as 2p (p + 2).
/// To rounding for |x| ≤ 32, to 2e-13 for |x| ≤ 64.
pub(crate) fn sinhc(dag: &mut Dag, x: Ref) -> Ref {
    use Operation::{Add, Mul, Sqrt};
    let [one, two, four] = [1.0, 2.0, 4.0].map(|c| dag.constant(c));
    let share = dag.constant(1.0 / f64::from(1u32 << HALVINGS));
    let y = dag.add(Mul(x, share));
    let z = dag.add(Mul(y, y));
    // 2w = 1 + z/(3·4) (1 + z/(5·6) (1 + …)).
    let mut series = one;
    for n in (2..10).rev() {
        let coefficient = dag.constant(1.0 / f64::from((2 * n - 1) * 2 * n));
        let scaled = dag.add(Mul(z, coefficient));
        let term = dag.add(Mul(scaled, series));
        series = dag.add(Add(one, term));
    }
    let half = dag.constant(0.5);
    let w = dag.add(Mul(half, series));
    let mut p = dag.add(Mul(z, w));
    let sum = dag.add(Add(p, two));
    let squared = dag.add(Mul(w, sum));
    let mut value = dag.add(Sqrt(squared));
    for k in 0..HALVINGS {
        let excess = dag.add(Mul(value, p));
        value = dag.add(Add(value, excess));
        if k + 1 < HALVINGS {
            let twice = dag.add(Mul(p, two));
            let outer = dag.add(Add(twice, four));
            p = dag.add(Mul(p, outer));
        }
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value of a node that was made of constants only, which the dag has computed.
    fn value(dag: &Dag, r: Ref) -> f64 {
        match dag.node(r).operation {
            Operation::Constant(bits) => f64::from_bits(bits),
            other => panic!("{other:?} is no constant"),
        }
    }

    type Matrix = [[f64; 3]; 3];

    fn decomposed(m: Matrix) -> ([f64; 3], Matrix) {
        let mut dag = Dag::with_points(1);
        let entries = [m[0][0], m[1][1], m[2][2], m[0][1], m[1][2], m[2][0]].map(|x| dag.constant(x));
        let found = eigen(&mut dag, entries);
        (found.values.map(|r| value(&dag, r)), found.vectors.map(|row| row.map(|r| value(&dag, r))))
    }

    fn matmul(a: &Matrix, b: &Matrix) -> Matrix {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
    }

    /// A rotation from three angles.
    fn rotation(angles: [f64; 3]) -> Matrix {
        let mut r = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for ((p, q, _), angle) in SWEEP.into_iter().zip(angles) {
            let mut turn = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            (turn[p][p], turn[q][q], turn[p][q], turn[q][p]) = (angle.cos(), angle.cos(), -angle.sin(), angle.sin());
            r = matmul(&r, &turn);
        }
        r
    }

    /// Values times vectors give the matrix back and vectors are orthonormal, to a few units in the last place: for
    /// eigenvalues that are apart, equal, nearly equal, of any sign and size.
    #[test]
    fn matrices_are_decomposed() {
        let mut cases =
            vec![[1.0, 1.0, 1.0], [2.0, 2.0, 0.5], [100.0, 1.0, 0.01], [9.0, 4.0, 1.0], [-1.0, 2.0, 3.0], [0.0; 3]];
        for exponent in [1, 4, 8, 12, 15] {
            let gap = 0.1f64.powi(exponent);
            cases.extend([[1.0 + gap, 1.0, 1.0], [3.0, 3.0 - gap, 0.2], [1.0, 1.0 + gap, 1.0 - 2.0 * gap]]);
        }
        let angles = [
            [0.0; 3],
            [0.3, -1.1, 2.0],
            [std::f64::consts::FRAC_PI_4, 0.0, 0.0],
            [1e-9, 2e-9, -1e-9],
            [3.0, 0.4, -0.2],
        ];
        for values in cases {
            for (angle, size) in angles.into_iter().flat_map(|a| [1.0, 1e-30, 1e20].map(|s| (a, s))) {
                let r = rotation(angle);
                let m: Matrix = std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        let (i, j) = (i.min(j), i.max(j));
                        (0..3).map(|k| size * r[i][k] * values[k] * r[j][k]).sum()
                    })
                });
                let (found, n) = decomposed(m);
                let scale = size * values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
                for i in 0..3 {
                    for j in 0..3 {
                        let back: f64 = (0..3).map(|k| n[i][k] * found[k] * n[j][k]).sum();
                        assert!((back - m[i][j]).abs() <= 1e-14 * scale, "{values:?} {angle:?}: {back} {}", m[i][j]);
                        let one: f64 = (0..3).map(|k| n[k][i] * n[k][j]).sum();
                        assert!((one - f64::from(u8::from(i == j))).abs() <= 1e-14, "{values:?} {angle:?}");
                    }
                }
            }
        }
    }

    /// sinh(x)/x over its whole range, and one at zero, from both sides.
    #[test]
    fn hyperbolic_sines_are_divided() {
        for x in [0.0, 1e-300, 1e-9, 1e-3, 0.1, 0.5, 1.0, 3.0, 10.0, 31.9] {
            for x in [x, -x] {
                let mut dag = Dag::with_points(1);
                let argument = dag.constant(x);
                let found = sinhc(&mut dag, argument);
                let found = value(&dag, found);
                let expected = if x.abs() < 1e-4 { 1.0 + x * x / 6.0 } else { x.sinh() / x };
                // The exponential itself loses as many digits as its argument has.
                let tolerance = 1e-15 * (2.0 + x.abs());
                assert!((found / expected - 1.0).abs() <= tolerance, "{x}: {found} instead of {expected}");
            }
        }
    }
}
