//! What lies under a window's panels and text: their colour, and the picture of the model.
//!
//! Why not with egui's own shader? It samples a texture, filters, dithers and blends for every pixel. A graphics card does
//! not notice; on the processor (lavapipe) it took four fifths of the time of a picture. These pixels need none of it:
//!
//! ```text
//! colour of the panels ─► whole window        picture ─► its part of the window, pixel for pixel
//! ```
//!
//! Not here: how the picture comes about (see [`renderer`](super::renderer)).

use egui::{Color32, Rect};
use egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState, wgpu};
use wgpu::util::DeviceExt as _;

/// Pipelines for backdrops in the pass in which egui draws: one sample per pixel, no depth.
pub struct Backdrop {
    device: wgpu::Device,
    colours: wgpu::RenderPipeline,
    pictures: wgpu::RenderPipeline,
    colour: Option<(Color32, wgpu::BindGroup)>,
    picture: Option<(wgpu::TextureView, wgpu::BindGroup)>,
}

/// One draw within egui's pass.
struct Cover {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
}

impl CallbackTrait for Cover {
    fn paint(&self, _: egui::PaintCallbackInfo, pass: &mut wgpu::RenderPass<'static>, _: &CallbackResources) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl Backdrop {
    /// Compiles what is needed for the window that `state` draws to.
    pub fn new(state: &RenderState) -> Backdrop {
        let device = &state.device;
        let shader = device.create_shader_module(wgpu::include_wgsl!("backdrop.wgsl"));
        let constants = [("linear_target", f64::from(u8::from(state.target_format.is_srgb())))];
        let options = wgpu::PipelineCompilationOptions { constants: &constants, ..Default::default() };
        let pipeline = |label, fragment| {
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: None,
                vertex: wgpu::VertexState {
                    module: &shader,
                    entry_point: Some("cover"),
                    compilation_options: options.clone(),
                    buffers: &[],
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: None,
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &shader,
                    entry_point: Some(fragment),
                    compilation_options: options.clone(),
                    targets: &[Some(state.target_format.into())],
                }),
                multiview_mask: None,
                cache: None,
            })
        };
        Backdrop {
            colours: pipeline("backdrop of one colour", "show_colour"),
            pictures: pipeline("backdrop with a picture", "show_picture"),
            device: device.clone(),
            colour: None,
            picture: None,
        }
    }

    /// An area of one opaque colour.
    pub fn fill(&mut self, area: Rect, colour: Color32) -> egui::Shape {
        let group = match &self.colour {
            Some((now, group)) if *now == colour => group.clone(),
            _ => {
                let [r, g, b, _] = colour.to_array().map(|c| f32::from(c) / 255.0);
                let buffer = self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                    label: Some("colour"),
                    contents: bytemuck::bytes_of(&[r, g, b, 1.0_f32]),
                    usage: wgpu::BufferUsages::UNIFORM,
                });
                let entry = wgpu::BindGroupEntry { binding: 1, resource: buffer.as_entire_binding() };
                let group = self.group(&self.colours, entry);
                self.colour.insert((colour, group)).1.clone()
            }
        };
        Callback::new_paint_callback(area, Cover { pipeline: self.colours.clone(), group }).into()
    }

    /// A picture that has as many pixels as the area.
    pub fn picture(&mut self, area: Rect, picture: &wgpu::TextureView) -> egui::Shape {
        let group = match &self.picture {
            Some((now, group)) if now == picture => group.clone(),
            _ => {
                let resource = wgpu::BindingResource::TextureView(picture);
                let group = self.group(&self.pictures, wgpu::BindGroupEntry { binding: 0, resource });
                self.picture.insert((picture.clone(), group)).1.clone()
            }
        };
        Callback::new_paint_callback(area, Cover { pipeline: self.pictures.clone(), group }).into()
    }

    fn group(&self, pipeline: &wgpu::RenderPipeline, entry: wgpu::BindGroupEntry<'_>) -> wgpu::BindGroup {
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("backdrop"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[entry],
        })
    }
}
