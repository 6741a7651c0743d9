//! Triangles and lines as pixels: into a texture of its own, with depth, used alike by the window, by pictures without a
//! window and by tests.
//!
//! ```text
//! ground ── shadow ── surface ── lines ──► one or four samples per pixel ──► texture (sRGB bytes in a linear format)
//! ```
//!
//! Why not egui's own pass? Tests and windows give it no depth buffer.

use super::device::{DeviceError, Pixels, read};
use super::frame::{Corner, Frame, Line};
use crate::camera::Camera;
use crate::geometry::{Vector, dot, length, minus};
use crate::look::Section;
use crate::palette::BACKGROUND;
use bytemuck::{Pod, Zeroable};
use egui_wgpu::wgpu;
use wgpu::util::DeviceExt as _;

/// What egui shows without converting.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// How often each pixel is sampled: edges are smooth with more than one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Samples {
    /// Once: all that the processor can do while it also computes.
    One,
    /// Four times.
    Four,
}

impl Samples {
    /// What a device draws many pictures per second with.
    pub fn for_motion(adapter: &wgpu::Adapter) -> Samples {
        match adapter.get_info().device_type {
            wgpu::DeviceType::Cpu => Samples::One,
            _ => Samples::Four,
        }
    }

    fn count(self) -> u32 {
        match self {
            Samples::One => 1,
            Samples::Four => 4,
        }
    }
}

/// What the shader reads once per picture; see `scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct View {
    clip: [[f32; 4]; 4],
    eye: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    back: [f32; 4],
    section: [f32; 4],
    ground: [f32; 4],
    middle: [f32; 4],
    picture: [f32; 4],
    background: [f32; 4],
}

/// Where and how a frame is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The view.
    pub camera: Camera,
    /// What is cut away.
    pub section: Option<Section>,
    /// Height of the ground along the camera's upward axis in m, if there is one.
    pub ground: Option<f32>,
}

/// Pipelines, buffers and the texture that is drawn to.
pub struct Renderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    surface: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    shadow: wgpu::RenderPipeline,
    ground: wgpu::RenderPipeline,
    view: wgpu::Buffer,
    group: wgpu::BindGroup,
    corners: Growing,
    strokes: Growing,
    loaded: Loaded,
    samples: Samples,
    target: Target,
    /// What the texture shows, unless another frame has come.
    drawn: Option<Shot>,
}

/// What is in the buffers.
#[derive(Clone, Copy, Default)]
struct Loaded {
    corners: u32,
    lines: u32,
    bounds: [Vector; 2],
}

struct Target {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    /// What is drawn to, when that is not the picture itself.
    samples: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

/// A vertex buffer that grows when it must.
struct Growing {
    buffer: wgpu::Buffer,
    label: &'static str,
}

impl Growing {
    fn new(device: &wgpu::Device, label: &'static str, size: u64) -> Growing {
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let descriptor = wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        Growing { buffer: device.create_buffer(&descriptor), label }
    }

    fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, bytes: &[u8]) {
        if bytes.len() as u64 > self.buffer.size() {
            *self = Growing::new(device, self.label, (bytes.len() as u64).next_power_of_two());
        }
        if !bytes.is_empty() {
            queue.write_buffer(&self.buffer, 0, bytes);
        }
    }
}

impl Target {
    fn new(device: &wgpu::Device, [width, height]: [u32; 2], samples: Samples) -> Target {
        let texture = |label, format, samples, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage,
                view_formats: &[],
            })
        };
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let read = drawn | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let resolved = texture("picture", FORMAT, 1, read);
        Target {
            view: view(&resolved),
            texture: resolved,
            samples: (samples != Samples::One).then(|| view(&texture("samples", FORMAT, samples.count(), drawn))),
            depth: view(&texture("depth", DEPTH, samples.count(), drawn)),
        }
    }
}

/// Entry points of a pipeline and what it reads.
struct Stage<'a> {
    label: &'a str,
    vertex: &'a str,
    fragment: &'a str,
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
}

impl Renderer {
    /// Compiles the shader and sets everything up; the first picture makes the texture.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, samples: Samples) -> Renderer {
        let shader = device.create_shader_module(wgpu::include_wgsl!("scene.wgsl"));
        let view = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("view"),
            contents: bytemuck::bytes_of(&View::zeroed()),
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("view"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("view"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: view.as_entire_binding() }],
        });
        let pipelines = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = |stage: Stage<'_>| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(stage.label),
                layout: Some(&pipelines),
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some(stage.vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: stage.buffers,
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(wgpu::CompareFunction::LessEqual),
                    stencil: wgpu::StencilState::default(),
                    bias: wgpu::DepthBiasState::default(),
                }),
                multisample: wgpu::MultisampleState { count: samples.count(), ..wgpu::MultisampleState::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(stage.fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(FORMAT.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        let corner_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4];
        let corners = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &corner_attributes,
        })];
        let line_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32];
        let strokes = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Line>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &line_attributes,
        })];
        let stage = |label, vertex, fragment, buffers| pipeline(Stage { label, vertex, fragment, buffers });
        Renderer {
            surface: stage("surface", "surface_vertex", "surface_fragment", &corners),
            shadow: stage("shadow", "shadow_vertex", "shadow_fragment", &corners),
            lines: stage("lines", "line_vertex", "line_fragment", &strokes),
            ground: stage("ground", "ground_vertex", "ground_fragment", &[]),
            corners: Growing::new(device, "corners", 1 << 16),
            strokes: Growing::new(device, "lines", 1 << 16),
            loaded: Loaded::default(),
            target: Target::new(device, [16, 16], samples),
            samples,
            drawn: None,
            device: device.clone(),
            queue: queue.clone(),
            view,
            group,
        }
    }

    /// Gives a frame to the device; it is drawn until the next one comes.
    pub fn load(&mut self, frame: &Frame) {
        self.corners.write(&self.device, &self.queue, bytemuck::cast_slice(&frame.corners));
        self.strokes.write(&self.device, &self.queue, bytemuck::cast_slice(&frame.lines));
        self.loaded =
            Loaded { corners: frame.corners.len() as u32, lines: frame.lines.len() as u32, bounds: frame.bounds };
        self.drawn = None;
    }

    /// Draws the loaded frame into the texture; whether the texture is another one than before. What the texture shows
    /// already is not drawn again.
    pub fn draw(&mut self, shot: &Shot) -> bool {
        let limit = self.device.limits().max_texture_dimension_2d;
        let size = shot.size.map(|s| s.clamp(1, limit));
        let renewed = [self.target.texture.width(), self.target.texture.height()] != size;
        if renewed {
            self.target = Target::new(&self.device, size, self.samples);
            self.drawn = None;
        }
        if self.drawn == Some(*shot) {
            return renewed;
        }
        self.drawn = Some(*shot);
        let view = view_of(self.loaded.bounds, shot, size);
        self.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("scene") });
        let [r, g, b] = BACKGROUND.map(|c| f64::from(c) / 255.0);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: self.target.samples.as_ref().unwrap_or(&self.target.view),
                depth_slice: None,
                resolve_target: self.target.samples.as_ref().map(|_| &self.target.view),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a: 1.0 }),
                    store: if self.target.samples.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.target.depth,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        });
        pass.set_bind_group(0, &self.group, &[]);
        let Loaded { corners, lines, .. } = self.loaded;
        let camera = &shot.camera;
        // From below, the ground would hide the body.
        let above = shot.ground.filter(|height| dot(camera.eye(), camera.up) > *height);
        if above.is_some() {
            pass.set_pipeline(&self.ground);
            pass.draw(0..6, 0..1);
        }
        if corners > 0 {
            pass.set_vertex_buffer(0, self.corners.buffer.slice(..));
            if above.is_some() {
                pass.set_pipeline(&self.shadow);
                pass.draw(0..corners, 0..1);
            }
            pass.set_pipeline(&self.surface);
            pass.draw(0..corners, 0..1);
        }
        if lines > 0 {
            pass.set_vertex_buffer(0, self.strokes.buffer.slice(..));
            pass.set_pipeline(&self.lines);
            pass.draw(0..6, 0..lines);
        }
        drop(pass);
        self.queue.submit([encoder.finish()]);
        renewed
    }

    /// The texture that was drawn to.
    pub fn texture(&self) -> &wgpu::TextureView {
        &self.target.view
    }

    /// The pixels that were drawn.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn pixels(&self) -> Result<Pixels, DeviceError> {
        read(&self.device, &self.queue, &self.target.texture)
    }
}

/// The box that the camera must show, ground included: its centre and radius.
fn ball([low, high]: [Vector; 2], reach: f32) -> (Vector, f32) {
    let centre: Vector = std::array::from_fn(|k| 0.5 * (low[k] + high[k]));
    (centre, length(minus(high, centre)).max(reach) * 1.5)
}

fn view_of(bounds: [Vector; 2], shot: &Shot, size: [u32; 2]) -> View {
    let camera = &shot.camera;
    let [right, up, back] = camera.axes();
    let wide = |v: Vector, w: f32| [v[0], v[1], v[2], w];
    let extent = length(minus(bounds[1], bounds[0]));
    let reach = 2.2 * extent;
    let (centre, radius) = ball(bounds, if shot.ground.is_some() { reach } else { 0.0 });
    let height = shot.ground.unwrap_or(0.0);
    let lift = height - dot(centre, camera.up);
    let middle: Vector = std::array::from_fn(|k| centre[k] + lift * camera.up[k]);
    let spacing = crate::numbers::round_below(f64::from(extent.max(1e-6)) / 4.0) as f32;
    let [r, g, b] = BACKGROUND.map(|c| f32::from(c) / 255.0);
    View {
        clip: camera.matrix(size[0] as f32 / size[1] as f32, centre, radius),
        eye: wide(camera.eye(), 1.0),
        right: wide(right, 0.0),
        up: wide(up, 0.0),
        back: wide(back, 0.0),
        section: shot.section.map_or([0.0; 4], |s| wide(s.normal, s.offset)),
        ground: wide(camera.up, height),
        middle: wide(middle, reach.max(1e-6)),
        picture: [size[0] as f32, size[1] as f32, spacing, size[1] as f32 / 1000.0],
        background: [r, g, b, 1.0],
    }
}
