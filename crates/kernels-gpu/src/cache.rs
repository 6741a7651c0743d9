#![expect(unsafe_code, reason = "the interface marks the data of a pipeline cache so, because a driver reads it")]
//! The driver's cache of compiled pipelines.

/// A cache, with what an earlier one gave.
pub(crate) fn open(device: &wgpu::Device, data: Option<&[u8]>) -> wgpu::PipelineCache {
    let descriptor = wgpu::PipelineCacheDescriptor { label: Some("souple"), data, fallback: true };
    // SAFETY: the data comes from `PipelineCache::get_data` of a device with the same adapter and driver: whoever keeps it
    // names it by them. Data of another is noticed by its head, and with `fallback` an empty cache is made instead.
    unsafe { device.create_pipeline_cache(&descriptor) }
}
