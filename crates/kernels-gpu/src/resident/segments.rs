//! Contributions of items to rows, and the sum per row in a fixed order.
//!
//! Every item writes what it adds to each of its rows to places of its own; then each row adds its items' contributions
//! in their order. So no two invocations write the same number, nothing is atomic, and the bits of a sum depend on the
//! numbering alone.
//!
//! A *segment* is one buffer of contributions: as many chunks of items as fit into what a program may see. With more
//! than one, the later ones add to what the earlier ones gave.

use crate::device::{DeviceError, Gpu};
use crate::kernel::WORKGROUP as LANES;

/// What a chunk of items adds to: rows of each item.
pub(super) struct Contributors<'a> {
    /// Number of items.
    pub(super) items: usize,
    /// Rows of an item.
    pub(super) places: usize,
    /// Row numbers, [item][place].
    pub(super) rows: &'a [u32],
}

impl Contributors<'_> {
    /// Numbers that its contributions of `width` per row take, lanes that are left over included.
    pub(super) fn len(&self, width: usize) -> usize {
        self.items.div_ceil(LANES) * LANES * self.places * width
    }
}

/// One buffer of contributions, with the tables of the sum.
pub(super) struct Segment {
    /// The contributions.
    pub(super) contributions: wgpu::Buffer,
    /// Chunks that write to it, with the place of their first number.
    pub(super) chunks: Vec<(usize, u64)>,
    pub(super) starts: wgpu::Buffer,
    pub(super) places: wgpu::Buffer,
    /// Width, number of rows, whether earlier segments are added to.
    pub(super) about: wgpu::Buffer,
}

/// Makes the segments for contributions of `width` numbers per row.
pub(super) fn segments(
    gpu: &Gpu,
    what: &str,
    chunks: &[Contributors<'_>],
    rows: usize,
    width: usize,
) -> Result<Vec<Segment>, DeviceError> {
    let limits = gpu.description().limits;
    let most = (limits.binding_bytes.min(limits.buffer_bytes) / 4) as usize;
    let mut groups: Vec<(usize, Vec<(usize, usize)>)> = Vec::new();
    for (number, chunk) in chunks.iter().enumerate() {
        let len = chunk.len(width);
        match groups.last_mut() {
            Some((used, members)) if *used + len <= most => {
                members.push((number, *used));
                *used += len;
            }
            _ => groups.push((len, vec![(number, 0)])),
        }
    }
    let mut segments = Vec::new();
    for (len, members) in groups {
        let mut starts = vec![0u32; rows + 1];
        for &(number, _) in &members {
            for &row in chunks[number].rows {
                starts[row as usize + 1] += 1;
            }
        }
        for row in 0..rows {
            starts[row + 1] += starts[row];
        }
        let mut next = starts.clone();
        let mut places = vec![0u32; starts[rows] as usize];
        for &(number, first) in &members {
            let chunk = &chunks[number];
            for (item, own) in chunk.rows.chunks(chunk.places).enumerate() {
                let (group, lane) = (item / LANES, item % LANES);
                for (place, &row) in own.iter().enumerate() {
                    let at = first + (group * chunk.places + place) * width * LANES + lane;
                    // Buffers are below 2³² numbers: a binding has less than 2³⁴ bytes on any device.
                    places[next[row as usize] as usize] = at as u32;
                    next[row as usize] += 1;
                }
            }
        }
        let about = [width as u32, rows as u32, u32::from(!segments.is_empty())];
        let table = |name: &str, values: &[u32]| {
            let content: &[u8] = bytemuck::cast_slice(values);
            gpu.buffer(name, content.len() as u64, Some(content))
        };
        segments.push(Segment {
            contributions: gpu.buffer(what, 4 * len as u64, None)?,
            chunks: members.iter().map(|&(number, first)| (number, 4 * first as u64)).collect(),
            starts: table("starts of rows", &starts)?,
            places: table("places of contributions", &places)?,
            about: table("segment", &about)?,
        });
    }
    Ok(segments)
}
