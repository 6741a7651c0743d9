#![expect(unsafe_code, reason = "the interface marks the data of a pipeline cache so, because a driver reads it")]
//! The driver's cache of compiled pipelines, and how it lies in a file.
//!
//! ```text
//! file:  "SOUPLEPC", version │ sum of what follows │ what device it is of, '\0' │ data of the driver
//! ```
//!
//! A driver reads its data as it is: what a fault of a disk or another program left there must not reach it, so the file
//! is summed (FNV-1a, 64 bits), which finds accidents and stops nobody who means harm. Inside the data the driver finds a
//! pipeline by its program; data of another device, driver or version is refused here by the words in front.
//! What it is not: files. Who opens the device reads and writes them.

use crate::adapters::Description;
use thiserror::Error;

/// A cache, with what an earlier one gave.
pub(crate) fn open(device: &wgpu::Device, data: Option<&[u8]>) -> wgpu::PipelineCache {
    let descriptor = wgpu::PipelineCacheDescriptor { label: Some("souple"), data, fallback: true };
    // SAFETY: the data comes from `PipelineCache::get_data` of a device with the same adapter and driver: whoever keeps it
    // names it by them, and `unpack` compares. Data of another is noticed by its head too, and with `fallback` an empty
    // cache is made instead.
    unsafe { device.create_pipeline_cache(&descriptor) }
}

/// Why the bytes of a file are not used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum CacheError {
    /// It is no such file, or one of another version of this program.
    #[error("it is no file of pipelines of this version")]
    Foreign,
    /// It was cut or changed.
    #[error("it was damaged")]
    Damaged,
    /// It is of another device or driver.
    #[error("it is of `{found}`, not of `{expected}`")]
    Another {
        /// What it is of.
        found: String,
        /// What the device is.
        expected: String,
    },
}

/// What a file begins with; the last byte is its version.
const HEAD: [u8; 9] = *b"SOUPLEPC\x01";
/// Bytes of the sum behind it.
const SUM: usize = 8;

/// What data is kept by: adapter, interface, driver and its version.
pub fn key(d: &Description) -> String {
    [&d.interface, &d.name, &d.driver, &d.driver_version].map(String::as_str).join("-")
}

/// Content of a file for data of [`crate::Gpu::cache_data`].
pub fn pack(device: &Description, data: &[u8]) -> Vec<u8> {
    let mut content = key(device).into_bytes();
    content.push(0);
    content.extend_from_slice(data);
    let mut file = HEAD.to_vec();
    file.extend_from_slice(&sum(&content).to_le_bytes());
    file.extend_from_slice(&content);
    file
}

/// The data in a file, to be given to [`crate::Gpu::with`].
///
/// # Errors
/// When it is damaged, or of another device or version.
pub fn unpack<'a>(device: &Description, file: &'a [u8]) -> Result<&'a [u8], CacheError> {
    let rest = file.strip_prefix(&HEAD).ok_or(CacheError::Foreign)?;
    let (told, content) = rest.split_first_chunk::<SUM>().ok_or(CacheError::Damaged)?;
    if sum(content) != u64::from_le_bytes(*told) {
        return Err(CacheError::Damaged);
    }
    let end = content.iter().position(|b| *b == 0).ok_or(CacheError::Damaged)?;
    let (found, expected) = (String::from_utf8_lossy(&content[..end]).into_owned(), key(device));
    if found != expected {
        return Err(CacheError::Another { found, expected });
    }
    Ok(&content[end + 1..])
}

/// FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo, 1991).
fn sum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |sum, b| (sum ^ u64::from(*b)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Features, Limits};

    fn device(name: &str) -> Description {
        Description {
            name: name.into(),
            driver: "driver".into(),
            driver_version: "1.2".into(),
            interface: "vulkan".into(),
            kind: "discrete".into(),
            limits: Limits { buffer_bytes: 1, binding_bytes: 1, bindings: 1, workgroups: 1, invocations: 1 },
            features: Features { doubles: false, pipeline_cache: true, timestamps: false },
        }
    }

    /// What is packed comes back, whatever is in it; a changed byte anywhere, a cut or another device is found.
    #[test]
    fn only_whole_files_of_the_same_device_are_used() {
        let (card, other) = (device("card"), device("another card"));
        let data: Vec<u8> = (0..=255).collect();
        let file = pack(&card, &data);
        assert_eq!(unpack(&card, &file), Ok(&data[..]));
        assert_eq!(unpack(&card, &pack(&card, &[])), Ok(&[][..]));
        for at in 0..file.len() {
            let mut changed = file.clone();
            changed[at] ^= 0x10;
            assert!(unpack(&card, &changed).is_err(), "byte {at}");
            assert!(unpack(&card, &file[..at]).is_err(), "the first {at} bytes");
        }
        assert!(matches!(unpack(&other, &file), Err(CacheError::Another { .. })));
        assert_eq!(unpack(&card, b"WGPUPLCH and so on"), Err(CacheError::Foreign));
    }
}
