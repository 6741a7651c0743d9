//! Tetrahedra with four nodes: one point, constant gradients.

use super::point::{KEPT, add_outer, diagonal, first_stress, first_stress_change, keep, kept, minus, stress, times};
use super::{Handwritten, half_lambda_and_mu, inverse};
use crate::batch::Batch;
use crate::vectors::{Mat3, Row, Vec3, Vectors, gather3, load, load3, parts, store};
use pulp::{Simd, WithSimd};
use souple_kernels::{Aligned, LANES};
use std::ops::Range;

/// Places prepared per element: g₁, g₂, g₃ (the rows of the inverse of the edges' matrix), then w.
const PREPARED: usize = 10;

/// Kernels of a batch of tetrahedra.
#[derive(Clone, Debug)]
pub struct Tet4 {
    /// [group][place].
    prepared: Aligned,
    /// [group][place].
    step: Aligned,
    /// λ/2 and μ in Pa.
    moduli: [f64; 2],
}

impl Tet4 {
    /// Prepares gradients and weights.
    pub(super) fn new(batch: &Batch) -> Tet4 {
        let prepared = (0..batch.groups).map(|group| {
            let mut places = [[0.0; LANES]; PREPARED];
            for lane in 0..LANES {
                let x = batch.rest_of(group, lane);
                // Columns are edges: N₁ … N₃ are the coordinates in their basis, so gₐ is a row of the inverse.
                let edges = std::array::from_fn(|i| std::array::from_fn(|a| x[a + 1][i] - x[0][i]));
                let (inverse, determinant) = inverse(&edges);
                let values = inverse.as_flattened().iter().copied().chain([-determinant / 6.0]);
                places.iter_mut().zip(values).for_each(|(place, value)| place[lane] = value);
            }
            places
        });
        let mut all = Aligned::zeros(batch.groups * PREPARED * LANES);
        grouped_mut(&mut all).iter_mut().zip(prepared).for_each(|(place, prepared)| *place = prepared);
        Tet4 {
            prepared: all,
            step: Aligned::zeros(batch.groups * KEPT * LANES),
            moduli: half_lambda_and_mu(&batch.parameters),
        }
    }
}

/// Places of each group.
fn grouped<const PLACES: usize>(values: &[f64]) -> &[[Row; PLACES]] {
    values.as_chunks().0.as_chunks().0
}

/// The same, to be written.
fn grouped_mut<const PLACES: usize>(values: &mut [f64]) -> &mut [[Row; PLACES]] {
    values.as_chunks_mut().0.as_chunks_mut().0
}

impl Handwritten for Tet4 {
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
        [PREPARED, KEPT]
    }
}

/// A nodal vector, and who reads which of its rows, [group][node][lane].
#[derive(Clone, Copy)]
struct Gathered<'a> {
    values: &'a [[f64; 3]],
    rows: &'a [[[u32; LANES]; 4]],
}

impl<'a> Gathered<'a> {
    fn new(values: &'a [f64], batch: &'a Batch, groups: &Range<usize>) -> Gathered<'a> {
        let rows = batch.rows.as_chunks().0.as_chunks().0;
        Gathered { values: values.as_chunks().0, rows: &rows[groups.clone()] }
    }

    /// Rows of one group relative to the first node.
    #[inline(always)]
    fn differences<S: Simd>(values: &[[f64; 3]], rows: &[[u32; LANES]; 4], simd: S, part: usize) -> [Vec3<S>; 3] {
        let first = gather3::<S>(values, &rows[0], part);
        let relative = |a: usize| minus(simd, gather3::<S>(values, &rows[a], part), first);
        [relative(1), relative(2), relative(3)]
    }
}

/// g₁, g₂, g₃ and w.
#[inline(always)]
fn gradients<S: Simd>(prepared: &[Row; PREPARED], part: usize) -> ([Vec3<S>; 3], S::f64s) {
    let g = [load3::<S>(&prepared[0..3], part), load3::<S>(&prepared[3..6], part), load3::<S>(&prepared[6..9], part)];
    (g, load::<S>(&prepared[9], part))
}

/// Σ dₐ ⊗ gₐ added to `start`.
#[inline(always)]
fn gradient<S: Simd>(simd: S, start: Mat3<S>, d: [Vec3<S>; 3], g: [Vec3<S>; 3]) -> Mat3<S> {
    let first = add_outer(simd, start, d[0], g[0]);
    add_outer(simd, add_outer(simd, first, d[1], g[1]), d[2], g[2])
}

/// Writes P gₐ for each node.
#[inline(always)]
fn scatter<S: Simd>(simd: S, out: &mut [Row; 12], part: usize, p: Mat3<S>, g: [Vec3<S>; 3]) {
    let f = [times(simd, p, g[0]), times(simd, p, g[1]), times(simd, p, g[2])];
    for i in 0..3 {
        let sum = simd.add_f64s(simd.add_f64s(f[0][i], f[1][i]), f[2][i]);
        store::<S>(&mut out[i], part, simd.neg_f64s(sum));
        for a in 0..3 {
            store::<S>(&mut out[3 * (a + 1) + i], part, f[a][i]);
        }
    }
}

/// Places of a nodal vector, [group][node, axis].
fn places(out: &mut [f64]) -> &mut [[Row; 12]] {
    out.as_chunks_mut().0.as_chunks_mut().0
}

struct Force<'a> {
    gathered: Gathered<'a>,
    set: &'a Tet4,
    groups: Range<usize>,
    out: &'a mut [f64],
}

impl WithSimd for Force<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let moduli = self.set.moduli.map(|m| simd.splat_f64s(m));
        let prepared = &grouped(&self.set.prepared)[self.groups];
        for ((rows, prepared), out) in self.gathered.rows.iter().zip(prepared).zip(places(self.out)) {
            for part in 0..parts::<S>() {
                let d = Gathered::differences(self.gathered.values, rows, simd, part);
                let (g, w) = gradients::<S>(prepared, part);
                let f = gradient(simd, diagonal(simd, 1.0), d, g);
                scatter(simd, out, part, first_stress(simd, f, stress(simd, f, moduli, w)), g);
            }
        }
    }
}

struct Linearise<'a> {
    gathered: Gathered<'a>,
    prepared: &'a [[Row; PREPARED]],
    step: &'a mut [[Row; KEPT]],
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
                let (g, w) = gradients::<S>(prepared, part);
                let f = gradient(simd, diagonal(simd, 1.0), d, g);
                let s = stress(simd, f, moduli, w);
                keep::<S>(step, part, f, s);
                scatter(simd, out, part, first_stress(simd, f, s), g);
            }
        }
    }
}

struct Product<'a> {
    gathered: Gathered<'a>,
    set: &'a Tet4,
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
                let (g, w) = gradients::<S>(prepared, part);
                let (f, s) = kept::<S>(step, part);
                let df = gradient(simd, diagonal(simd, 0.0), d, g);
                scatter(simd, out, part, first_stress_change(simd, f, s, df, moduli, w), g);
            }
        }
    }
}
