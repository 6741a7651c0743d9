//! Some rows of the state: what a picture or a measurement needs, without the rest.
//!
//! ```text
//! result[k, axis] = u[rows[k], axis]
//! ```
//!
//! A kernel puts the rows that were asked for side by side in a buffer of their size, and this buffer alone is read.
//! Which rows is said once; reading them again sends nothing.

use super::kernels::{PICK, Slot, WORKGROUP};
use super::step::Resident;
use super::traffic::Purpose;
use super::vectors::Bound;
use crate::device::DeviceError;

/// Rows that can be read by themselves; they belong to the [`Resident`] that made them.
pub struct Rows {
    count: usize,
    result: wgpu::Buffer,
    staging: wgpu::Buffer,
    rounded: Bound,
    whole: Bound,
    velocity: Bound,
}

/// What of each row is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// u in single precision, 4 bytes per unknown: enough for pictures.
    Rounded,
    /// u as exactly as the device has it, 8 bytes per unknown.
    Whole,
    /// v, 4 bytes per unknown.
    Velocity,
}

impl Rows {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
}

impl Resident {
    /// Prepares the reading of some rows.
    ///
    /// # Errors
    /// When the device is lost, or a buffer does not fit.
    ///
    /// # Panics
    /// When a row is not one of the model's.
    pub fn rows(&self, rows: &[u32]) -> Result<Rows, DeviceError> {
        let (gpu, memory, axes) = (&self.gpu, &self.memory, self.axes);
        let known = (memory.len / axes) as u32;
        assert!(rows.iter().all(|&row| row < known), "rows are those of the model");
        let table = |what: &str, values: &[u32]| {
            let content: &[u8] = bytemuck::cast_slice(values);
            self.traffic.sent(Purpose::Rows, content.len());
            gpu.buffer(what, content.len() as u64, Some(content))
        };
        let bytes = 8 * (rows.len() * axes) as u64;
        let result = gpu.buffer("rows to be read", bytes, None)?;
        let numbers = table("numbers of rows to be read", rows)?;
        let groups = (rows.len() * axes).div_ceil(WORKGROUP);
        let bind = |form: Form| -> Result<Bound, DeviceError> {
            let parts = match form {
                Form::Rounded => 0,
                Form::Whole => 1,
                Form::Velocity => 2,
            };
            let about = table("what of rows is read", &[axes as u32, parts])?;
            let mut own = vec![(Slot::Places, &numbers), (Slot::Segment, &about), (Slot::Result, &result)];
            if form == Form::Velocity {
                // Velocities have no second part, and none is looked at.
                own.extend([(Slot::U, memory.get(Slot::V)), (Slot::ULow, memory.get(Slot::V))]);
            }
            Ok(memory.bind(gpu, &PICK, &self.pick, &own, groups))
        };
        let (rounded, whole, velocity) = (bind(Form::Rounded)?, bind(Form::Whole)?, bind(Form::Velocity)?);
        Ok(Rows { count: rows.len(), staging: gpu.staging(bytes), result, rounded, whole, velocity })
    }

    /// Numbers of the rows in the present state, [row, axis] in their order.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn read_rows(&self, rows: &Rows, form: Form) -> Result<Vec<f64>, DeviceError> {
        let count = rows.count * self.axes;
        if count == 0 {
            return Ok(Vec::new());
        }
        let (bound, parts) = match form {
            Form::Rounded => (&rows.rounded, 1),
            Form::Whole => (&rows.whole, 2),
            Form::Velocity => (&rows.velocity, 1),
        };
        self.gpu.alive()?;
        let bytes = (4 * parts * count) as u64;
        let mut encoder = self.gpu.encoder();
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            bound.dispatch(&mut pass);
        }
        encoder.copy_buffer_to_buffer(&rows.result, 0, &rows.staging, 0, bytes);
        self.gpu.inner.queue.submit([encoder.finish()]);
        let values: Vec<f32> = bytemuck::pod_collect_to_vec(&self.gpu.read(&rows.staging, bytes)?);
        self.traffic.came_back(Purpose::Rows, bytes as usize);
        let (first, second) = values.split_at(count);
        Ok(match form {
            Form::Whole => first.iter().zip(second).map(|(&h, &l)| f64::from(h) + f64::from(l)).collect(),
            Form::Rounded | Form::Velocity => first.iter().copied().map(f64::from).collect(),
        })
    }
}
