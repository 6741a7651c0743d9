//! Explicit vectors: which there are, and how buffers in groups of eight lanes are read as such.
//!
//! A function generic over [`pulp::Simd`] is compiled once per instruction set and entered through [`Vectors::run`].
//! With vectors of eight a group is one vector per place, with vectors of four it is done in two halves, each place
//! being two vectors side by side.

use pulp::{Simd, WithSimd};
use souple_kernels::LANES;

/// An instruction set that this processor was found to have.
#[derive(Clone, Copy, Debug)]
pub enum Vectors {
    /// AVX-512: 8 doubles.
    #[cfg(target_arch = "x86_64")]
    Avx512(pulp::x86::V4),
    /// AVX2 with FMA: 4 doubles.
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
    /// One double at a time, on other processors.
    #[cfg(not(target_arch = "x86_64"))]
    Scalar(pulp::Scalar),
}

impl Vectors {
    /// The instruction sets of this processor, widest first.
    pub fn available() -> Vec<Vectors> {
        #[cfg(target_arch = "x86_64")]
        let found = [pulp::x86::V4::try_new().map(Vectors::Avx512), pulp::x86::V3::try_new().map(Vectors::Avx2)];
        #[cfg(not(target_arch = "x86_64"))]
        let found = [Some(Vectors::Scalar(pulp::Scalar::new()))];
        found.into_iter().flatten().collect()
    }

    /// The widest; none on an x86-64 processor without AVX2.
    pub fn widest() -> Option<Vectors> {
        Vectors::available().first().copied()
    }

    /// The instruction set that a device's name asks for (`"cpu:avx2"`), the widest for any other name.
    pub fn of_device(device: &str) -> Option<Vectors> {
        let named = device.strip_prefix("cpu:");
        Vectors::available().into_iter().find(|v| Some(v.name()) == named).or_else(Vectors::widest)
    }

    /// The name that backends use.
    pub fn name(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Vectors::Avx512(_) => "avx512",
            #[cfg(target_arch = "x86_64")]
            Vectors::Avx2(_) => "avx2",
            #[cfg(not(target_arch = "x86_64"))]
            Vectors::Scalar(_) => "scalar",
        }
    }

    /// Runs work compiled for this instruction set.
    pub fn run<W: WithSimd>(self, work: W) -> W::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Vectors::Avx512(simd) => Simd::vectorize(simd, work),
            #[cfg(target_arch = "x86_64")]
            Vectors::Avx2(simd) => Simd::vectorize(simd, work),
            #[cfg(not(target_arch = "x86_64"))]
            Vectors::Scalar(simd) => Simd::vectorize(simd, work),
        }
    }
}

/// A place of a group: one number per lane.
pub type Row = [f64; LANES];

/// A vector with three axes.
pub(crate) type Vec3<S> = [<S as Simd>::f64s; 3];

/// Three rows of three.
pub(crate) type Mat3<S> = [[<S as Simd>::f64s; 3]; 3];

/// How many vectors a place is.
#[inline(always)]
pub(crate) const fn parts<S: Simd>() -> usize {
    LANES / S::F64_LANES
}

/// One part of a place.
#[inline(always)]
pub(crate) fn load<S: Simd>(row: &Row, part: usize) -> S::f64s {
    S::as_simd_f64s(row).0[part]
}

/// Writes one part of a place.
#[inline(always)]
pub(crate) fn store<S: Simd>(row: &mut Row, part: usize, value: S::f64s) {
    S::as_mut_simd_f64s(row).0[part] = value;
}

/// Three places of one part.
#[inline(always)]
pub(crate) fn load3<S: Simd>(rows: &[Row], part: usize) -> Vec3<S> {
    [load::<S>(&rows[0], part), load::<S>(&rows[1], part), load::<S>(&rows[2], part)]
}

/// Rows of three numbers of a shared array, transposed into lanes: entry `rows[lane]` of `values` becomes lane `lane`.
///
/// The compare of each row with the array's length stands in the way once per lane; the generated code makes the same
/// compare in a pass of its own.
#[inline(always)]
pub(crate) fn gather3<S: Simd>(values: &[[f64; 3]], rows: &[u32; LANES], part: usize) -> Vec3<S> {
    let mut lanes = [[0.0; LANES]; 3];
    for lane in 0..S::F64_LANES {
        let value = values[rows[part * S::F64_LANES + lane] as usize];
        lanes[0][lane] = value[0];
        lanes[1][lane] = value[1];
        lanes[2][lane] = value[2];
    }
    load3::<S>(&lanes, 0)
}
