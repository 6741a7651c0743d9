//! Hexahedra with eight nodes and 2 × 2 × 2 points, gradients prepared at each point.

use super::point::{
    KEPT, add_outer, add_times, diagonal, first_stress, first_stress_change, keep, kept, minus, stress,
};
use super::{Handwritten, half_lambda_and_mu, inverse};
use crate::batch::Batch;
use crate::vectors::{Mat3, Row, Vec3, Vectors, gather3, load, load3, parts, store};
use pulp::{Simd, WithSimd};
use souple_kernels::{Aligned, LANES};
use std::ops::Range;

const NODES: usize = 8;
const POINTS: usize = 8;

/// Nodes but the first, whose gradient follows from the others'.
const OTHERS: usize = NODES - 1;

/// Places prepared per point: g₁ … g₇, then w.
const PREPARED: usize = 3 * OTHERS + 1;

/// What is prepared of a group.
type Prepared = [[Row; PREPARED]; POINTS];

/// What a linearisation keeps of a group.
type Step = [[Row; KEPT]; POINTS];

/// Kernels of a batch of hexahedra.
#[derive(Clone, Debug)]
pub struct Hex8 {
    /// [group][point][place].
    prepared: Aligned,
    /// [group][point][place].
    step: Aligned,
    /// λ/2 and μ in Pa.
    moduli: [f64; 2],
}

impl Hex8 {
    /// Prepares gradients and weights.
    pub(super) fn new(batch: &Batch) -> Hex8 {
        let rule = batch.derived.association.rule;
        let nodes = batch.derived.association.element.nodes;
        let prepare = |group: usize| {
            let mut places = [[[0.0; LANES]; PREPARED]; POINTS];
            for lane in 0..LANES {
                let x = batch.rest_of(group, lane);
                for ((xi, weight), places) in rule.points.iter().zip(&rule.weights).zip(&mut places) {
                    let reference: Vec<[f64; 3]> = nodes.iter().map(|node| shape_gradient(node, xi)).collect();
                    let mut jacobian = [[0.0; 3]; 3];
                    for (x, g) in x.iter().zip(&reference) {
                        for i in 0..3 {
                            for j in 0..3 {
                                jacobian[i][j] += x[i] * g[j];
                            }
                        }
                    }
                    let (inverse, determinant) = inverse(&jacobian);
                    for (a, g) in reference.iter().enumerate().skip(1) {
                        for j in 0..3 {
                            places[3 * (a - 1) + j][lane] = (0..3).map(|k| g[k] * inverse[k][j]).sum();
                        }
                    }
                    places[PREPARED - 1][lane] = -weight * determinant;
                }
            }
            places
        };
        let mut prepared = Aligned::zeros(batch.groups * POINTS * PREPARED * LANES);
        grouped_mut(&mut prepared).iter_mut().enumerate().for_each(|(group, places)| *places = prepare(group));
        Hex8 {
            prepared,
            step: Aligned::zeros(batch.groups * POINTS * KEPT * LANES),
            moduli: half_lambda_and_mu(&batch.parameters),
        }
    }
}

/// Gradient of the trilinear shape function that is 1 at a corner of [−1, 1]³: N = Π (1 + ξₖ cₖ) / 8.
fn shape_gradient(corner: &[f64; 3], xi: &[f64; 3]) -> [f64; 3] {
    let factor = |k: usize| 1.0 + xi[k] * corner[k];
    std::array::from_fn(|k| 0.125 * corner[k] * factor((k + 1) % 3) * factor((k + 2) % 3))
}

/// Places of each point of each group.
fn grouped<const PLACES: usize>(values: &[f64]) -> &[[[Row; PLACES]; POINTS]] {
    values.as_chunks().0.as_chunks().0.as_chunks().0
}

/// The same, to be written.
fn grouped_mut<const PLACES: usize>(values: &mut [f64]) -> &mut [[[Row; PLACES]; POINTS]] {
    values.as_chunks_mut().0.as_chunks_mut().0.as_chunks_mut().0
}

impl Handwritten for Hex8 {
    fn force(&self, vectors: Vectors, batch: &Batch, groups: Range<usize>, out: &mut [f64]) {
        vectors.run(Force { gathered: Gathered::new(&batch.displacement, batch, &groups), set: self, groups, out });
    }

    fn linearise(&mut self, vectors: Vectors, batch: &Batch, groups: Range<usize>, out: &mut [f64]) {
        let gathered = Gathered::new(&batch.displacement, batch, &groups);
        let prepared = &grouped(&self.prepared)[groups.clone()];
        let step = &mut grouped_mut(&mut self.step)[groups];
        vectors.run(Linearise { gathered, prepared, step, moduli: self.moduli, out });
    }

    fn tangent_apply(&self, vectors: Vectors, batch: &Batch, groups: Range<usize>, out: &mut [f64]) {
        vectors.run(Product { gathered: Gathered::new(&batch.direction, batch, &groups), set: self, groups, out });
    }

    fn carried(&self) -> [usize; 2] {
        [POINTS * PREPARED, POINTS * KEPT]
    }
}

/// A nodal vector, and who reads which of its rows, [group][node][lane].
#[derive(Clone, Copy)]
struct Gathered<'a> {
    values: &'a [[f64; 3]],
    rows: &'a [[[u32; LANES]; NODES]],
}

impl<'a> Gathered<'a> {
    fn new(values: &'a [f64], batch: &'a Batch, groups: &Range<usize>) -> Gathered<'a> {
        let rows = batch.rows.as_chunks().0.as_chunks().0;
        Gathered { values: values.as_chunks().0, rows: &rows[groups.clone()] }
    }

    /// Rows of one group relative to the first node.
    #[inline(always)]
    fn differences<S: Simd>(
        values: &[[f64; 3]],
        rows: &[[u32; LANES]; NODES],
        simd: S,
        part: usize,
    ) -> [Vec3<S>; OTHERS] {
        let first = gather3::<S>(values, &rows[0], part);
        let mut out = [first; OTHERS];
        for (a, out) in out.iter_mut().enumerate() {
            *out = minus(simd, gather3::<S>(values, &rows[a + 1], part), first);
        }
        out
    }
}

/// Σ dₐ ⊗ gₐ added to `start`.
#[inline(always)]
fn gradient<S: Simd>(
    simd: S,
    start: Mat3<S>,
    d: &[Vec3<S>; OTHERS],
    prepared: &[Row; PREPARED],
    part: usize,
) -> Mat3<S> {
    let mut out = start;
    for (a, d) in d.iter().enumerate() {
        out = add_outer(simd, out, *d, load3::<S>(&prepared[3 * a..3 * a + 3], part));
    }
    out
}

/// Adds P gₐ to each node's sum.
#[inline(always)]
fn add_forces<S: Simd>(simd: S, sums: &mut [Vec3<S>; OTHERS], p: Mat3<S>, prepared: &[Row; PREPARED], part: usize) {
    for (a, sum) in sums.iter_mut().enumerate() {
        *sum = add_times(simd, *sum, p, load3::<S>(&prepared[3 * a..3 * a + 3], part));
    }
}

/// Writes the sums, and at the first node what balances them.
#[inline(always)]
fn write<S: Simd>(simd: S, out: &mut [Row; 3 * NODES], part: usize, sums: &[Vec3<S>; OTHERS]) {
    for i in 0..3 {
        let mut total = sums[0][i];
        for sum in &sums[1..] {
            total = simd.add_f64s(total, sum[i]);
        }
        store::<S>(&mut out[i], part, simd.neg_f64s(total));
    }
    for (a, sum) in sums.iter().enumerate() {
        for i in 0..3 {
            store::<S>(&mut out[3 * (a + 1) + i], part, sum[i]);
        }
    }
}

/// Places of a nodal vector, [group][node, axis].
fn places(out: &mut [f64]) -> &mut [[Row; 3 * NODES]] {
    out.as_chunks_mut().0.as_chunks_mut().0
}

/// Sums to start from.
#[inline(always)]
fn nothing<S: Simd>(simd: S) -> [Vec3<S>; OTHERS] {
    [[simd.splat_f64s(0.0); 3]; OTHERS]
}

struct Force<'a> {
    gathered: Gathered<'a>,
    set: &'a Hex8,
    groups: Range<usize>,
    out: &'a mut [f64],
}

impl WithSimd for Force<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let moduli = self.set.moduli.map(|m| simd.splat_f64s(m));
        let prepared: &[Prepared] = &grouped(&self.set.prepared)[self.groups];
        for ((rows, prepared), out) in self.gathered.rows.iter().zip(prepared).zip(places(self.out)) {
            for part in 0..parts::<S>() {
                let d = Gathered::differences(self.gathered.values, rows, simd, part);
                let mut sums = nothing(simd);
                for point in prepared {
                    let w = load::<S>(&point[PREPARED - 1], part);
                    let f = gradient(simd, diagonal(simd, 1.0), &d, point, part);
                    let p = first_stress(simd, f, stress(simd, f, moduli, w));
                    add_forces(simd, &mut sums, p, point, part);
                }
                write(simd, out, part, &sums);
            }
        }
    }
}

struct Linearise<'a> {
    gathered: Gathered<'a>,
    prepared: &'a [Prepared],
    step: &'a mut [Step],
    moduli: [f64; 2],
    out: &'a mut [f64],
}

impl WithSimd for Linearise<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let moduli = self.moduli.map(|m| simd.splat_f64s(m));
        let carried = self.prepared.iter().zip(self.step);
        for ((rows, (prepared, step)), out) in self.gathered.rows.iter().zip(carried).zip(places(self.out)) {
            for part in 0..parts::<S>() {
                let d = Gathered::differences(self.gathered.values, rows, simd, part);
                let mut sums = nothing(simd);
                for (point, step) in prepared.iter().zip(&mut *step) {
                    let w = load::<S>(&point[PREPARED - 1], part);
                    let f = gradient(simd, diagonal(simd, 1.0), &d, point, part);
                    let s = stress(simd, f, moduli, w);
                    keep::<S>(step, part, f, s);
                    add_forces(simd, &mut sums, first_stress(simd, f, s), point, part);
                }
                write(simd, out, part, &sums);
            }
        }
    }
}

struct Product<'a> {
    gathered: Gathered<'a>,
    set: &'a Hex8,
    groups: Range<usize>,
    out: &'a mut [f64],
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let moduli = self.set.moduli.map(|m| simd.splat_f64s(m));
        let carried =
            grouped(&self.set.prepared)[self.groups.clone()].iter().zip(&grouped(&self.set.step)[self.groups]);
        for ((rows, (prepared, step)), out) in self.gathered.rows.iter().zip(carried).zip(places(self.out)) {
            for part in 0..parts::<S>() {
                let d = Gathered::differences(self.gathered.values, rows, simd, part);
                let mut sums = nothing(simd);
                for (point, step) in prepared.iter().zip(step) {
                    let w = load::<S>(&point[PREPARED - 1], part);
                    let df = gradient(simd, diagonal(simd, 0.0), &d, point, part);
                    let (f, s) = kept::<S>(step, part);
                    add_forces(simd, &mut sums, first_stress_change(simd, f, s, df, moduli, w), point, part);
                }
                write(simd, out, part, &sums);
            }
        }
    }
}
