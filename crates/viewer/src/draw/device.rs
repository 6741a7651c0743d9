//! A graphics device without a window, and pixels back from it.
//!
//! Software devices (lavapipe of Mesa) are good enough for all of it.

use egui_wgpu::{RenderState, RendererOptions, WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew, wgpu};
use std::sync::mpsc::channel;
use std::time::Duration;

/// Longest wait for pixels: software devices draw large pictures slowly, but not this slowly.
const PATIENCE: Duration = Duration::from_secs(60);

/// Why there is nothing to draw with, or nothing came back.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DeviceError {
    /// No graphics device can be opened.
    #[error(
        "no graphics device can be opened ({0}); a software one is enough: on Debian and Ubuntu, \
         `apt-get install mesa-vulkan-drivers`"
    )]
    None(String),
    /// The device did not give pixels back.
    #[error("the graphics device gave no pixels back: {0}")]
    Lost(String),
}

/// Opens a device without a window; with equal rights, a hardware one before a software one.
///
/// # Errors
/// When this machine has none.
pub fn open() -> Result<RenderState, DeviceError> {
    let setup = WgpuSetup::CreateNew(WgpuSetupCreateNew::without_display_handle());
    let configuration = WgpuConfiguration { wgpu_setup: setup, ..WgpuConfiguration::default() };
    let instance = pollster::block_on(configuration.wgpu_setup.new_instance());
    let options = RendererOptions::PREDICTABLE;
    let opened = pollster::block_on(RenderState::create(&configuration, &instance, None, options));
    opened.map_err(|e| DeviceError::None(e.to_string()))
}

/// What draws, in words: "llvmpipe (LLVM 15.0.6, 256 bits) (Cpu, Vulkan)".
pub fn describe(state: &RenderState) -> String {
    let about = state.adapter.get_info();
    format!("{} ({:?}, {:?})", about.name, about.device_type, about.backend)
}

/// Pixels in rows from the top, [row, column, red green blue alpha], in sRGB.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Width and height.
    pub size: [u32; 2],
    /// Four bytes per pixel.
    pub bytes: Vec<u8>,
}

impl Pixels {
    /// Red, green and blue at a column and row.
    pub fn at(&self, [column, row]: [u32; 2]) -> [u8; 3] {
        let first = 4 * (row * self.size[0] + column) as usize;
        std::array::from_fn(|k| self.bytes[first + k])
    }

    /// As a PNG file.
    ///
    /// # Errors
    /// When the encoder refuses, in its words.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.size[0], self.size[1]);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        // Opaque pictures need no fourth channel.
        let opaque: Vec<u8> = self.bytes.chunks_exact(4).flat_map(|p| &p[..3]).copied().collect();
        let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&opaque));
        written.map_err(|e| e.to_string())?;
        Ok(file)
    }
}

/// The pixels of an RGBA texture that may be copied from.
///
/// # Errors
/// When the device is lost or takes a minute.
pub fn read(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Result<Pixels, DeviceError> {
    let lost = |e: &dyn std::fmt::Display| DeviceError::Lost(e.to_string());
    let (width, height) = (texture.width(), texture.height());
    let row = (4 * width).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("pixels"),
        size: u64::from(row) * u64::from(height),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("pixels") });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
    let submitted = queue.submit([encoder.finish()]);
    let (sender, receiver) = channel();
    buffer.slice(..).map_async(wgpu::MapMode::Read, move |mapped| {
        // The receiver is gone only when the wait below failed, and then nobody asks.
        let _ = sender.send(mapped);
    });
    let wait = wgpu::PollType::Wait { submission_index: Some(submitted), timeout: Some(PATIENCE) };
    device.poll(wait).map_err(|e| lost(&e))?;
    receiver.recv().map_err(|e| lost(&e))?.map_err(|e| lost(&e))?;
    let mapped = buffer.slice(..).get_mapped_range().map_err(|e| lost(&e))?;
    let rows = mapped.chunks_exact(row as usize).flat_map(|r| &r[..4 * width as usize]);
    let bytes: Vec<u8> = rows.copied().collect();
    Ok(Pixels { size: [width, height], bytes })
}
