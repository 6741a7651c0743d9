//! Pictures without a window: the renderer's texture with the overlay written over it by egui, as a window would.

use super::device::{DeviceError, Pixels, describe, open, read};
use super::frame::{Extras, Faceted, frame};
use super::overlay::{Overlay, paint};
use super::renderer::{Renderer, Samples, Shot};
use crate::camera::Camera;
use crate::colouring::colours;
use crate::geometry::{Vector, dot};
use crate::look::Look;
use crate::model::Model;
use egui_wgpu::{RenderState, ScreenDescriptor, wgpu};

/// One state of a model, as positions and the field that its look asks for.
#[derive(Clone, Copy, Debug)]
pub struct Pose<'a> {
    /// Positions in m, [node][axis].
    pub positions: &'a [Vector],
    /// Values per element, if the colours need them.
    pub field: &'a [f32],
    /// Nodes that are held.
    pub held: &'a [u32],
    /// What is written below the title.
    pub subtitle: &'a str,
}

/// A graphics device with all that pictures need.
pub struct Studio {
    state: RenderState,
    renderer: Renderer,
    context: egui::Context,
    shown: Option<egui::TextureId>,
}

impl Studio {
    /// Opens a graphics device without a window.
    ///
    /// # Errors
    /// When there is none.
    pub fn open() -> Result<Studio, DeviceError> {
        Ok(Studio::with(open()?))
    }

    /// On a device that is open.
    pub fn with(state: RenderState) -> Studio {
        let renderer = Renderer::new(&state.device, &state.queue, Samples::Four);
        Studio { renderer, state, context: egui::Context::default(), shown: None }
    }

    /// What it draws with, in words.
    pub fn device(&self) -> String {
        describe(&self.state)
    }

    /// Pixels of the model alone.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn scene(&mut self, model: &Model, pose: Pose<'_>, look: &Look, shot: Shot) -> Result<Pixels, DeviceError> {
        self.draw(model, pose, look, shot);
        self.renderer.pixels()
    }

    fn draw(&mut self, model: &Model, pose: Pose<'_>, look: &Look, shot: Shot) -> crate::colouring::Legend {
        let faceted = if look.element_size < 0.999 { Faceted::apart(model) } else { Faceted::whole(model) };
        let colours = colours(model, look.colour_by, pose.positions, pose.field, look.scale);
        let frame = frame(model, &faceted, pose.positions, &colours, look, pose.held, &Extras::default());
        self.renderer.load(&frame);
        let renewed = self.renderer.draw(&shot);
        let mut egui = self.state.renderer.write();
        let filter = wgpu::FilterMode::Linear;
        match self.shown {
            None => {
                let id = egui.register_native_texture(&self.state.device, self.renderer.texture(), filter);
                self.shown = Some(id);
            }
            Some(id) if renewed => {
                let texture = self.renderer.texture();
                egui.update_egui_texture_from_wgpu_texture(&self.state.device, texture, filter, id);
            }
            Some(_) => {}
        }
        colours.legend
    }

    /// Pixels of the model with title, legend, scale bar and axes.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn picture(&mut self, model: &Model, pose: Pose<'_>, look: &Look, shot: Shot) -> Result<Pixels, DeviceError> {
        let legend = self.draw(model, pose, look, shot);
        let Some(shown) = self.shown else { return self.renderer.pixels() };
        // Letters keep their size relative to the picture.
        let scale = (shot.size[1] as f32 / 720.0).max(0.6);
        let points = egui::vec2(shot.size[0] as f32, shot.size[1] as f32) / scale;
        let area = egui::Rect::from_min_size(egui::Pos2::ZERO, points);
        let overlay = Overlay { title: &model.title, subtitle: pose.subtitle, legend: &legend, camera: &shot.camera };
        let mut pixels = None;
        // Fonts are laid out in the first pass and drawn in the second.
        for _ in 0..2 {
            let mut input = egui::RawInput { screen_rect: Some(area), ..egui::RawInput::default() };
            input.viewports.entry(egui::ViewportId::ROOT).or_default().native_pixels_per_point = Some(scale);
            let output = self.context.run_ui(input, |ui| {
                let painter = ui.ctx().layer_painter(egui::LayerId::background());
                let whole = egui::Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                painter.image(shown, area, whole, egui::Color32::WHITE);
                paint(&painter, area, &overlay);
            });
            pixels = Some(self.render(output, shot.size, scale)?);
        }
        pixels.ok_or_else(|| DeviceError::Lost("nothing was drawn".into()))
    }

    /// What egui drew, as pixels.
    fn render(&mut self, output: egui::FullOutput, size: [u32; 2], scale: f32) -> Result<Pixels, DeviceError> {
        let (device, queue) = (&self.state.device, &self.state.queue);
        let mut egui = self.state.renderer.write();
        let mut changes = output.textures_delta;
        for (id, images) in changes.set.drain() {
            for image in images {
                egui.update_texture(device, queue, id, &image);
            }
        }
        let shapes = self.context.tessellate(output.shapes, scale);
        let screen = ScreenDescriptor { size_in_pixels: size, pixels_per_point: scale };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("overlay") });
        let more = egui.update_buffers(device, queue, &mut encoder, &shapes, &screen);
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("overlay"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.state.target_format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut pass = encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("overlay"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..wgpu::RenderPassDescriptor::default()
            })
            .forget_lifetime();
        egui.render(&mut pass, &shapes, &screen);
        drop(pass);
        queue.submit(more.into_iter().chain([encoder.finish()]));
        for (id, ()) in changes.free.drain().map(|id| (id, ())) {
            egui.free_texture(&id);
        }
        drop(egui);
        read(device, queue, &texture)
    }
}

/// Height of a ground just below the lowest point, along the camera's upward axis.
pub fn ground_below(positions: &[Vector], camera: &Camera) -> f32 {
    let heights = || positions.iter().map(|&p| dot(p, camera.up)).filter(|h| h.is_finite());
    let (low, high) = heights().fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    if low <= high { low - 0.08 * (high - low).max(1e-6) } else { 0.0 }
}
