//! Texts, panels and plots of a window on devices that are the processor itself.
//!
//! egui's shader chooses among several ways of filtering and dithering. A graphics card takes the chosen one; lavapipe
//! computes all of them for every pixel and drops what was not chosen, which took most of the time of a picture. Here the
//! shapes of a layer are taken from egui before it draws them, and drawn by a shader with one way:
//!
//! ```text
//! shapes of the layer ── egui's tessellation ──► triangles ──► colour × coverage of letters, blended over what is there
//! ```
//!
//! Layers above (menus, tooltips), pictures in panels, and whatever is not certain to come out the same stay with egui.

use bytemuck::{Pod, Zeroable};
use egui::epaint::{ClippedPrimitive, ClippedShape, Primitive};
use egui::layers::ShapeIdx;
use egui::{LayerId, Shape, TextureId};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, wgpu};
use wgpu::util::DeviceExt as _;

/// A corner of a triangle: place in clip space, place in the texture of letters, premultiplied sRGB.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Corner {
    clip: [f32; 2],
    at: [f32; 2],
    colour: [u8; 4],
}

/// Draws what egui would, cheaper.
pub struct Ink {
    state: RenderState,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    letters: Option<(wgpu::Texture, wgpu::BindGroup)>,
}

/// Triangles within one rectangle of the window.
struct Run {
    /// Left, top, right and bottom in pixels.
    clip: [u32; 4],
    /// First index and the one after the last.
    indices: std::ops::Range<u32>,
}

/// All triangles of a layer.
struct Drawing {
    pipeline: wgpu::RenderPipeline,
    letters: wgpu::BindGroup,
    corners: wgpu::Buffer,
    indices: wgpu::Buffer,
    runs: Vec<Run>,
}

impl CallbackTrait for Drawing {
    fn paint(&self, info: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.letters, &[]);
        pass.set_vertex_buffer(0, self.corners.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        let [width, height] = info.screen_size_px;
        for run in &self.runs {
            let [left, top, right, bottom] = run.clip;
            let (right, bottom) = (right.min(width), bottom.min(height));
            if left < right && top < bottom {
                pass.set_scissor_rect(left, top, right - left, bottom - top);
                pass.draw_indexed(run.indices.clone(), 0, 0..1);
            }
        }
    }
}

impl Ink {
    /// For a window on this device; nothing where egui's own way is as good (graphics cards), or where colours of the
    /// window are linear.
    pub fn new(state: &RenderState) -> Option<Ink> {
        let slow = state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        (slow && !state.target_format.is_srgb()).then(|| Ink::with(state))
    }

    fn with(state: &RenderState) -> Ink {
        let device = &state.device;
        let shader = device.create_shader_module(wgpu::include_wgsl!("ink.wgsl"));
        let attributes = wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Unorm8x4];
        let buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Corner>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &attributes,
        })];
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("ink"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("place"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &buffers,
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some("ink"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: state.target_format,
                    blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("letters"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..wgpu::SamplerDescriptor::default()
        });
        Ink { state: state.clone(), pipeline, sampler, letters: None }
    }

    /// Takes over what a layer holds so far; whether it did. What was taken over lies above the callbacks of the layer.
    ///
    /// Leaves everything to egui while its texture of letters is on its way to the device.
    pub fn take_over(&mut self, context: &egui::Context, layer: LayerId) -> bool {
        let Some(letters) = self.letters(context) else { return false };
        let ours = |entry: &ClippedShape| !matches!(entry.shape, Shape::Noop | Shape::Callback(_));
        let shapes: Vec<ClippedShape> = context.graphics(|layers| {
            let entries = layers.get(layer).map(|list| list.all_entries().filter(|e| ours(e)).cloned().collect());
            entries.unwrap_or_default()
        });
        let scale = context.pixels_per_point();
        let screen = context.content_rect();
        let Some(drawing) = self.drawing(&context.tessellate(shapes, scale), letters, screen, scale) else {
            return false;
        };
        context.graphics_mut(|layers| {
            let list = layers.entry(layer);
            let taken: Vec<usize> = list.all_entries().enumerate().filter(|(_, e)| ours(e)).map(|(k, _)| k).collect();
            taken.into_iter().for_each(|k| list.reset_shape(ShapeIdx(k)));
            list.add(screen, Callback::new_paint_callback(screen, drawing).into());
        });
        true
    }

    /// The texture of letters, when the device has it as the tessellation expects it.
    fn letters(&mut self, context: &egui::Context) -> Option<wgpu::BindGroup> {
        let renderer = self.state.renderer.read();
        let texture = renderer.texture(&TextureId::default())?.texture.as_ref()?;
        let wanted = context.fonts(|fonts| fonts.font_image_size());
        if [texture.width() as usize, texture.height() as usize] != wanted {
            return None;
        }
        if let Some((now, group)) = &self.letters
            && now == texture
        {
            return Some(group.clone());
        }
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let group = self.state.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("letters"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(&self.sampler) },
            ],
        });
        Some(self.letters.insert((texture.clone(), group)).1.clone())
    }

    /// Triangles on the device; nothing when some need another texture than that of letters, or when there are none.
    fn drawing(
        &self,
        primitives: &[ClippedPrimitive],
        letters: wgpu::BindGroup,
        screen: egui::Rect,
        scale: f32,
    ) -> Option<Drawing> {
        let (mut corners, mut indices, mut runs) = (Vec::new(), Vec::new(), Vec::new());
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else { return None };
            if mesh.texture_id != TextureId::default() {
                return None;
            }
            let (first, start) = (corners.len() as u32, indices.len() as u32);
            corners.extend(mesh.vertices.iter().map(|v| {
                let at = (v.pos - screen.min) / screen.size();
                Corner { clip: [2.0 * at.x - 1.0, 1.0 - 2.0 * at.y], at: v.uv.into(), colour: v.color.to_array() }
            }));
            indices.extend(mesh.indices.iter().map(|i| first + i));
            let pixels = |x: f32| (x * scale).round().max(0.0) as u32;
            let clip = [clip_rect.min.x, clip_rect.min.y, clip_rect.max.x, clip_rect.max.y].map(pixels);
            runs.push(Run { clip, indices: start..indices.len() as u32 });
        }
        if indices.is_empty() {
            return None;
        }
        let buffer = |label, contents: &[u8], usage| {
            let descriptor = wgpu::util::BufferInitDescriptor { label: Some(label), contents, usage };
            self.state.device.create_buffer_init(&descriptor)
        };
        Some(Drawing {
            pipeline: self.pipeline.clone(),
            letters,
            corners: buffer("corners of ink", bytemuck::cast_slice(&corners), wgpu::BufferUsages::VERTEX),
            indices: buffer("triangles of ink", bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX),
            runs,
        })
    }
}
