//! The picture, and what the pointer does in it.
//!
//! | pointer | does |
//! |---|---|
//! | left drag on the body | what was chosen: pull, push, hold, free |
//! | left drag beside it, right drag | turns |
//! | middle drag, or with Shift | moves the view |
//! | wheel | nearer, farther |
//! | double click beside the body | shows everything |
//!
//! Keys do all but what needs a point of the body.

use super::Canvas;
use super::running::{FrameKey, Grip, Hand, Running};
use crate::colouring::{Numbers, colours, numbers};
use crate::draw::frame::{Corner, Extras, Faceted, Line, bounds, frame};
use crate::draw::overlay::{Overlay, paint};
use crate::draw::renderer::Shot;
use crate::geometry::{Vector, along, dot, length, minus, ray_meets_triangle, unit};
use crate::look::Section;
use crate::numbers::with_unit;
use crate::palette::HAND;
use egui::{PointerButton, Pos2, Rect, Response, Sense, Ui};
use souple_simulation::interaction::{Pull, Tool};
use souple_simulation::session::Change;
use web_time::Instant;

/// What a ray met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Met {
    pub(super) triangle: usize,
    pub(super) weights: [f32; 3],
    pub(super) point: Vector,
}

pub(super) fn ui(running: &mut Running, canvas: &mut Canvas, ui: &mut Ui) {
    let area = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(area, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "View of the bodies"));
    running.aspect = area.width() / area.height().max(1.0);
    running.area = area;
    if running.fit {
        let [low, high] = bounds(&running.snapshot.positions);
        running.camera.fit(low, high, running.aspect);
        running.fit = false;
    }
    point(running, ui, &response, area);
    keys(running, ui, &response);
    section(running);
    let started = Instant::now();
    let scale = ui.ctx().pixels_per_point();
    let size = [(area.width() * scale).round().max(1.0) as u32, (area.height() * scale).round().max(1.0) as u32];
    draw(running, canvas, size);
    let painter = ui.painter_at(area);
    painter.add(canvas.backdrop.picture(area, canvas.renderer.texture()));
    let snapshot = &running.snapshot;
    let subtitle = format!("t = {}", with_unit(snapshot.time, "s"));
    let overlay =
        Overlay { title: &running.model.title, subtitle: &subtitle, legend: &running.legend, camera: &running.camera };
    paint(&painter, area, &overlay);
    for (_, pull) in &snapshot.pulls {
        let at = on_screen(running, area, pull.target.map(|x| x as f32));
        let text = with_unit(size_of_force(pull.force), "N");
        let [r, g, b] = HAND;
        let colour = egui::Color32::from_rgb(r, g, b);
        painter.text(
            at + egui::vec2(10.0, -10.0),
            egui::Align2::LEFT_BOTTOM,
            text,
            egui::FontId::proportional(16.0),
            colour,
        );
    }
    running.draw_ms = started.elapsed().as_secs_f64() * 1e3;
    if let Some(animation) = &mut running.animation {
        // Pixels that cannot be read back end the recording with its reason.
        let added = canvas.renderer.pixels().map_err(|e| e.to_string()).and_then(|p| animation.add(&p, snapshot.time));
        if let Err(error) = added {
            running.message = error;
            running.animation = None;
        }
    }
}

/// Size of a force in N.
pub(super) fn size_of_force(force: [f64; 3]) -> f64 {
    force.iter().map(|f| f * f).sum::<f64>().sqrt()
}

fn on_screen(running: &Running, area: Rect, point: Vector) -> Pos2 {
    let [x, y] = running.camera.place(point, running.aspect);
    egui::pos2(area.center().x + 0.5 * x * area.width(), area.center().y - 0.5 * y * area.height())
}

fn place(area: Rect, at: Pos2) -> [f32; 2] {
    [2.0 * (at.x - area.center().x) / area.width(), -2.0 * (at.y - area.center().y) / area.height()]
}

fn section(running: &mut Running) {
    let cut = running.cut;
    running.look.section = cut.on.then(|| {
        let [low, high] = bounds(&running.model.rest);
        let mut normal = [0.0; 3];
        normal[cut.axis] = if cut.flipped { -1.0 } else { 1.0 };
        let at = low[cut.axis] + cut.share * (high[cut.axis] - low[cut.axis]);
        Section { normal, offset: normal[cut.axis] * at }
    });
}

/// Draws into the canvas. What is drawn is made anew only when the state or the way it is shown has changed: turning a
/// large model costs no more than its pixels.
fn draw(running: &mut Running, canvas: &mut Canvas, size: [u32; 2]) {
    let key = FrameKey { snapshot: running.snapshot.number, look: running.look.clone(), tool: running.tool.clone() };
    if running.drawn.as_ref() != Some(&key) {
        load(running, canvas);
        running.drawn = Some(key);
    }
    let ground = running.look.ground.then_some(running.ground);
    canvas.renderer.draw(&Shot { size, camera: running.camera, section: running.look.section, ground });
}

fn load(running: &mut Running, canvas: &mut Canvas) {
    if running.look.element_size < 0.999 && running.apart.is_none() {
        running.apart = Some(Faceted::apart(&running.model));
    }
    let positions = &running.snapshot.positions;
    let field = running.field();
    let colours = colours(&running.model, running.look.colour_by, positions, field, running.look.scale);
    let faceted = match &running.apart {
        Some(apart) if running.look.element_size < 0.999 => apart,
        _ => &running.whole,
    };
    let extras = extras(running);
    let frame = frame(&running.model, faceted, positions, &colours, &running.look, &running.held(), &extras);
    canvas.renderer.load(&frame);
    running.legend = colours.legend;
}

/// Springs in hands and the tool.
fn extras(running: &Running) -> Extras {
    let mut extras = Extras::default();
    let [r, g, b] = HAND;
    for (_, pull) in &running.snapshot.pulls {
        let ends = [pull.point, pull.target].map(|p| p.map(|x| x as f32));
        extras.lines.push(Line { ends, colour: [r, g, b, 0], width: 4.0 });
        for end in ends {
            extras.lines.push(Line { ends: [end, end], colour: [r, g, b, 0], width: 10.0 });
        }
    }
    if let Some(tool) = &running.tool {
        ball(tool, &mut extras.corners);
    }
    extras
}

/// The tool's surface: a sphere, drawn out along its axis.
fn ball(tool: &Tool, corners: &mut Vec<Corner>) {
    const AROUND: usize = 24;
    const UP: usize = 12;
    let [a, b] = tool.ends.map(|e| e.map(|x| x as f32));
    let axis = minus(b, a);
    let direction = if length(axis) > 0.0 { unit(axis) } else { [0.0, 1.0, 0.0] };
    let helper = if direction[0].abs() < 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let side = unit(crate::geometry::cross(direction, helper));
    let other = crate::geometry::cross(direction, side);
    let corner = |i: usize, j: usize| -> Corner {
        // The equator belongs to both halves, one at each end.
        let latitude = std::f32::consts::PI * (j as f32 / UP as f32 - 0.5);
        let longitude = std::f32::consts::TAU * i as f32 / AROUND as f32;
        let normal = along(
            along(side.map(|x| x * latitude.cos() * longitude.cos()), latitude.cos() * longitude.sin(), other),
            latitude.sin(),
            direction,
        );
        let end = if 2 * j > UP { b } else { a };
        Corner { position: along(end, tool.radius as f32, normal), normal, colour: [0x7a, 0x86, 0x94, 0] }
    };
    for j in 0..UP {
        for i in 0..AROUND {
            let [p, q, r, s] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
            corners.extend([p, q, r, p, r, s]);
        }
    }
}

/// A point of the window that shows the body, the nearest to the middle of the view of those on a grid.
pub fn point_on_body(running: &Running) -> Option<Pos2> {
    const GRID: i32 = 8;
    let mut places: Vec<[i32; 2]> = (-GRID..=GRID).flat_map(|i| (-GRID..=GRID).map(move |j| [i, j])).collect();
    places.sort_by_key(|[i, j]| i * i + j * j);
    let found =
        places.into_iter().map(|p| p.map(|k| k as f32 / (GRID + 1) as f32)).find(|&p| pick(running, p).is_some());
    let area = running.area;
    found.map(|[x, y]| area.center() + egui::vec2(0.5 * x * area.width(), -0.5 * y * area.height()))
}

/// The nearest visible triangle on the ray through a point of the view.
pub(super) fn pick(running: &Running, at: [f32; 2]) -> Option<Met> {
    let (from, direction) = running.camera.ray(at, running.aspect);
    let positions = &running.snapshot.positions;
    let mut best: Option<(f32, Met)> = None;
    for (t, triangle) in running.model.skin.triangles.iter().enumerate() {
        let corners = triangle.map(|n| positions[n as usize]);
        let Some((distance, weights)) = ray_meets_triangle(from, direction, corners) else { continue };
        let point = along(from, distance, direction);
        let hidden = running.look.section.is_some_and(|s| s.depth(point) > 0.0);
        if !hidden && best.is_none_or(|b| distance < b.0) {
            best = Some((distance, Met { triangle: t, weights, point }));
        }
    }
    best.map(|b| b.1)
}

fn point(running: &mut Running, ui: &Ui, response: &Response, area: Rect) {
    let pointer = response.interact_pointer_pos();
    let shift = ui.input(|i| i.modifiers.shift);
    let press = ui.input(|i| i.pointer.press_origin()).or(pointer);
    if response.drag_started_by(PointerButton::Primary)
        && !shift
        && let Some(at) = press
        && let Some(met) = pick(running, place(area, at))
    {
        take(running, met);
    }
    if response.clicked_by(PointerButton::Primary)
        && let Some(at) = pointer
        && let Some(met) = pick(running, place(area, at))
        && matches!(running.hand, Hand::Hold | Hand::Free)
    {
        take(running, met);
    }
    let delta = response.drag_delta();
    let turning = response.dragged_by(PointerButton::Secondary)
        || (response.dragged_by(PointerButton::Primary) && running.grip.is_none() && !shift && !pushing(running));
    let moving = response.dragged_by(PointerButton::Middle) || (response.dragged_by(PointerButton::Primary) && shift);
    if turning {
        running.camera.turn(-0.4 * delta.x, 0.4 * delta.y);
    } else if moving {
        running.camera.pan(-delta.x / area.height(), delta.y / area.height());
    }
    if let Some(at) = pointer.filter(|_| response.dragged_by(PointerButton::Primary)) {
        drag(running, place(area, at), ui.input(|i| i.time));
    }
    let let_go = response.drag_stopped_by(PointerButton::Primary);
    if let_go {
        if running.grip.take().is_some() {
            running.change(Change::Release { number: 0 });
        }
        rest_tool(running);
    }
    if let Some(at) = response.hover_pos() {
        let scroll = ui.input(|i| i.smooth_scroll_delta().y);
        let pinch = ui.input(|i| i.zoom_delta());
        running.camera.distance *= (-0.002 * scroll).exp() / pinch;
        let met = pick(running, place(area, at));
        running.probe = met.map_or(String::new(), |met| probe(running, met));
        if response.double_clicked() && met.is_none() {
            running.fit = true;
        }
    }
}

fn pushing(running: &Running) -> bool {
    running.hand == Hand::Push && running.tool.is_some()
}

fn take(running: &mut Running, met: Met) {
    let triangle = running.model.skin.triangles[met.triangle];
    match running.hand {
        Hand::Pull => {
            let anchor = triangle.iter().zip(met.weights).map(|(&n, w)| (n, f64::from(w))).collect();
            running.grip = Some(Grip { anchor, target: met.point });
            send_pull(running);
        }
        Hand::Push => {}
        Hand::Hold | Hand::Free => {
            let face = running.model.skin.faces[met.triangle];
            let skin = &running.model.skin;
            let of_face = skin.triangles.iter().zip(&skin.faces).filter(|(_, f)| **f == face);
            let mut nodes: Vec<u32> = of_face.flat_map(|(t, _)| *t).collect();
            nodes.sort_unstable();
            nodes.dedup();
            let change = if running.hand == Hand::Hold { Change::Hold(nodes) } else { Change::Free(nodes) };
            running.change(change);
        }
    }
}

/// Moves what the hand holds to the pointer, in the plane through it that faces the eye.
fn drag(running: &mut Running, at: [f32; 2], time: f64) {
    let (from, direction) = running.camera.ray(at, running.aspect);
    let back = running.camera.axes()[2];
    let in_plane = |through: Vector| along(from, dot(minus(through, from), back) / dot(direction, back), direction);
    if let Some(grip) = &running.grip {
        let target = in_plane(grip.target);
        if target != grip.target {
            running.grip = Some(Grip { anchor: grip.anchor.clone(), target });
            send_pull(running);
        }
    } else if let (Hand::Push, Some(tool)) = (running.hand, &running.tool) {
        let centre: Vector = std::array::from_fn(|k| 0.5 * (tool.ends[0][k] + tool.ends[1][k]) as f32);
        let moved = minus(in_plane(centre), centre).map(f64::from);
        let seconds = (time - running.tool_moved).clamp(1e-3, 0.2);
        let ends = tool.ends.map(|e| std::array::from_fn(|k| e[k] + moved[k]));
        let tool = Tool { ends, velocity: moved.map(|x| x / seconds), ..tool.clone() };
        running.tool_moved = time;
        if running.tool.as_ref() != Some(&tool) {
            running.tool = Some(tool.clone());
            running.change(Change::Tool(Some(tool)));
        }
    }
}

fn send_pull(running: &Running) {
    if let Some(grip) = &running.grip {
        let sum: f64 = grip.anchor.iter().map(|a| a.1).sum();
        let anchor = grip.anchor.iter().map(|&(n, w)| (n, w / sum)).collect();
        let pull = Pull { anchor, target: grip.target.map(f64::from), stiffness: running.pull_stiffness };
        running.change(Change::Pull { number: 0, pull });
    }
}

/// A tool that nobody moves does not move.
fn rest_tool(running: &mut Running) {
    if let Some(tool) = &mut running.tool
        && tool.velocity != [0.0; 3]
    {
        tool.velocity = [0.0; 3];
        let tool = tool.clone();
        running.change(Change::Tool(Some(tool)));
    }
}

/// What is under the pointer, in words.
fn probe(running: &Running, met: Met) -> String {
    let element = running.model.skin.owners[met.triangle];
    let field = running.field();
    let by = running.look.colour_by;
    let value = match numbers(&running.model, by, &running.snapshot.positions, field) {
        Some(Numbers::Elements(values)) => values.get(element as usize).copied(),
        Some(Numbers::Nodes(values)) => {
            let nodes = running.model.skin.triangles[met.triangle];
            Some(nodes.iter().zip(met.weights).map(|(&n, w)| w * values[n as usize]).sum())
        }
        None => None,
    };
    let element = running.model.describe(element);
    match value {
        Some(value) => format!("{}: {}\n{element}", by.name(), with_unit(f64::from(value), by.unit())),
        None => element,
    }
}

fn keys(running: &mut Running, ui: &Ui, view: &Response) {
    // A control that was reached by the keyboard keeps its keys; the view leaves none to the way from control to control.
    if view.has_focus() {
        let filter = egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(view.id, filter));
    } else if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    use egui::Key;
    use souple_simulation::session::Command;
    let pressed = |key| ui.input(|i| i.key_pressed(key) && !i.modifiers.any());
    if pressed(Key::Space) {
        running.session.send(if running.snapshot.playing { Command::Pause } else { Command::Play });
    }
    if pressed(Key::Period) {
        running.session.send(Command::Step(1));
    }
    if pressed(Key::R) {
        running.session.send(Command::Reset);
        running.tool = None;
    }
    if pressed(Key::F) {
        running.fit = true;
    }
    for (key, hand) in [(Key::P, Hand::Pull), (Key::T, Hand::Push), (Key::H, Hand::Hold), (Key::G, Hand::Free)] {
        if pressed(key) {
            running.hand = hand;
        }
    }
    let arrows = [
        (Key::ArrowLeft, [-1.0, 0.0]),
        (Key::ArrowRight, [1.0, 0.0]),
        (Key::ArrowUp, [0.0, 1.0]),
        (Key::ArrowDown, [0.0, -1.0]),
    ];
    for (key, [x, y]) in arrows {
        if pressed(key) {
            running.camera.turn(5.0 * x, 5.0 * y);
        } else if ui.input(|i| i.key_pressed(key) && i.modifiers.shift_only()) {
            running.camera.pan(0.05 * x, 0.05 * y);
        }
    }
    for (keys, factor) in [([Key::Plus, Key::Equals], 0.9), ([Key::Minus, Key::Minus], 1.0 / 0.9)] {
        if ui.input(|i| keys.iter().any(|k| i.key_pressed(*k))) {
            running.camera.distance *= factor;
        }
    }
}
