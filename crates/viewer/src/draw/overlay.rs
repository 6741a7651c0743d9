//! What is written over the picture: title and time, legend, scale bar, axes. The same in windows and in pictures.

use crate::camera::Camera;
use crate::colouring::{Legend, end_text};
use crate::geometry::dot;
use crate::numbers::{round_below, with_unit};
use crate::palette::Colour;
use egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

/// Dark enough on the background of pictures, whatever the theme of the window.
const INK: Color32 = Color32::from_rgb(0x2b, 0x2f, 0x36);
const MARGIN: f32 = 14.0;

/// What to write.
#[derive(Clone, Copy, Debug)]
pub struct Overlay<'a> {
    /// Upper left, in larger letters.
    pub title: &'a str,
    /// Below it.
    pub subtitle: &'a str,
    /// Explains the colours.
    pub legend: &'a Legend,
    /// What the picture shows.
    pub camera: &'a Camera,
}

fn ink([r, g, b]: Colour) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Writes over the picture that fills a rectangle.
pub fn paint(painter: &Painter, area: Rect, overlay: &Overlay<'_>) {
    let corner = area.min + vec2(MARGIN, MARGIN);
    let written = painter.text(corner, Align2::LEFT_TOP, overlay.title, FontId::proportional(18.0), INK);
    let below = pos2(corner.x, written.bottom() + 3.0);
    painter.text(below, Align2::LEFT_TOP, overlay.subtitle, FontId::proportional(13.0), INK);
    legend(painter, area, overlay.legend);
    scale_bar(painter, area, overlay.camera);
    axes(painter, area, overlay.camera);
}

fn legend(painter: &Painter, area: Rect, legend: &Legend) {
    let font = FontId::proportional(14.0);
    match legend {
        Legend::None => {}
        Legend::Names(names) => {
            let room = ((0.6 * area.height() / 22.0) as usize).max(3);
            let shown = if names.len() > room { room - 1 } else { names.len() };
            if shown < names.len() {
                let text = pos2(area.right() - MARGIN - 24.0, area.top() + MARGIN + 22.0 * shown as f32);
                let more = format!("and {} more", names.len() - shown);
                painter.text(text, Align2::RIGHT_TOP, more, font.clone(), INK);
            }
            for (k, (colour, name)) in names.iter().take(shown).enumerate() {
                let y = area.top() + MARGIN + 22.0 * k as f32;
                let text = pos2(area.right() - MARGIN - 24.0, y);
                painter.text(text, Align2::RIGHT_TOP, name, font.clone(), INK);
                let box_at = Rect::from_min_size(pos2(area.right() - MARGIN - 16.0, y + 1.0), vec2(16.0, 16.0));
                painter.rect_filled(box_at, 3.0, ink(*colour));
            }
        }
        Legend::Range { name, unit, ends, map } => {
            let size = vec2(16.0, (0.4 * area.height()).clamp(60.0, 220.0));
            let top = area.top() + MARGIN + 26.0;
            let bar = Rect::from_min_size(pos2(area.right() - MARGIN - size.x, top), size);
            painter.text(pos2(bar.right(), top - 26.0), Align2::RIGHT_TOP, name, FontId::proportional(15.0), INK);
            let mut mesh = Mesh::default();
            const STEPS: u32 = 40;
            for k in 0..=STEPS {
                let share = k as f32 / STEPS as f32;
                let y = bar.bottom() - share * bar.height();
                let colour = ink(map.at(share));
                mesh.colored_vertex(pos2(bar.left(), y), colour);
                mesh.colored_vertex(pos2(bar.right(), y), colour);
                if k > 0 {
                    let n = 2 * k;
                    mesh.add_triangle(n - 2, n - 1, n);
                    mesh.add_triangle(n - 1, n + 1, n);
                }
            }
            painter.add(Shape::mesh(mesh));
            const TICKS: u32 = 4;
            for k in 0..=TICKS {
                let share = f64::from(k) / f64::from(TICKS);
                let y = bar.bottom() - share as f32 * bar.height();
                let text = end_text(ends[0] + share * (ends[1] - ends[0]), unit);
                painter.text(pos2(bar.left() - 6.0, y), Align2::RIGHT_CENTER, text, font.clone(), INK);
            }
        }
    }
}

/// A bar of a round length in the plane through the middle of what is looked at.
fn scale_bar(painter: &Painter, area: Rect, camera: &Camera) {
    let metres_per_point = f64::from(camera.height_at(camera.target) / area.height());
    let metres = round_below(140.0 * metres_per_point);
    let points = (metres / metres_per_point) as f32;
    if !(points.is_finite() && points > 1.0) {
        return;
    }
    let right = pos2(area.right() - MARGIN, area.bottom() - MARGIN - 4.0);
    let left = pos2(right.x - points, right.y);
    let stroke = Stroke::new(2.0, INK);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 4.0), end + vec2(0.0, 4.0)], stroke);
    }
    let middle = pos2(0.5 * (left.x + right.x), right.y - 6.0);
    painter.text(middle, Align2::CENTER_BOTTOM, with_unit(metres, "m"), FontId::proportional(13.0), INK);
}

/// The three axes as they lie in the picture.
fn axes(painter: &Painter, area: Rect, camera: &Camera) {
    const LENGTH: f32 = 34.0;
    let centre = pos2(area.left() + MARGIN + 40.0, area.bottom() - MARGIN - 40.0);
    let [right, up, back] = camera.axes();
    let mut arms: Vec<(usize, Pos2, f32)> = (0..3)
        .map(|k| {
            let mut axis = [0.0; 3];
            axis[k] = 1.0;
            (k, centre + LENGTH * vec2(dot(axis, right), -dot(axis, up)), dot(axis, back))
        })
        .collect();
    // The nearest last.
    arms.sort_by(|a, b| a.2.total_cmp(&b.2));
    for (k, tip, _) in arms {
        let colour = [[0xc0, 0x39, 0x2b], [0x2e, 0x8b, 0x57], [0x2b, 0x6c, 0xb0]][k];
        painter.line_segment([centre, tip], Stroke::new(2.5, ink(colour)));
        let beyond = centre + 1.28 * (tip - centre);
        painter.text(beyond, Align2::CENTER_CENTER, ["x", "y", "z"][k], FontId::proportional(13.0), ink(colour));
    }
}
