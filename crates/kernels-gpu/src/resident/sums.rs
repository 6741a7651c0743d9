//! The sum of contributions per row by itself, as a step takes it: for measurements.

use super::kernels::{GATHER, WORKGROUP};
use super::segments::{Contributors, segments};
use crate::device::{DeviceError, Gpu};
use crate::measure::Loaded;

/// Sums of contributions of items to rows, `width` numbers per row; output 0 is [row][number].
///
/// `rows` is [item][place]; `contributions` is [group][place][number][lane] with [`crate::measure::LANES`] lanes.
///
/// # Errors
/// When a buffer does not fit: all contributions are one.
///
/// # Panics
/// When there are no items.
pub fn row_sums(
    gpu: &Gpu,
    rows: &[u32],
    places: usize,
    row_count: usize,
    width: usize,
    contributions: &[f32],
) -> Result<Loaded, DeviceError> {
    let contributors = [Contributors { items: rows.len() / places, places, rows }];
    let made = segments(gpu, "contributions", &contributors, row_count, width)?;
    let segment = made.first().expect("there are items");
    gpu.write(&segment.contributions, bytemuck::cast_slice(contributions));
    let result = gpu.buffer("sums", 4 * (row_count * width) as u64, None)?;
    let pipeline = GATHER.compile(gpu)?;
    let buffers = [&segment.contributions, &segment.starts, &segment.places, &segment.about, &result];
    Ok(Loaded::of(gpu, &pipeline, &buffers, vec![result.clone()], (row_count * width).div_ceil(WORKGROUP)))
}
