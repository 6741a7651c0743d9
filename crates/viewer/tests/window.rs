//! The window as a person uses it: found by what a screen reader says, and by its pixels.
//!
//! Without a graphics adapter, hardware or software, these tests pass and say that they were skipped.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use egui_kittest::wgpu::WgpuTestRenderer;
use egui_kittest::{Harness, Node};
use egui_wgpu::RenderState;
use souple_simulation::RunOptions;
use souple_simulation::session::{SessionOptions, replay};
use souple_viewer::app::{App, Place, Stage};
use souple_viewer::draw::device::Pixels;
use souple_viewer::draw::ink::Ink;
use souple_viewer::scene_file;
use std::io::BufReader;
use std::path::PathBuf;
use std::time::{Duration, Instant};

type Window = Harness<'static, App>;

/// A soft bar without weight, held at one end.
const BAR: &str = r#"
title = "Bar"
GRAVITY
time = { step = 0.01, end = 1.0 }
integrator = { method = "implicit-euler", velocity_damping = 5.0 }
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [0.4, 0.1, 0.1], cells = [4, 2, 2], sections = [{ until = 0.5, element = "hex8" }, { until = 1.0, element = "prism6" }] }
material = [{ law = "stvk", young = "50 kPa", poisson = 0.3 }]
fix = [{ region = "x_min" }]
"#;

/// A scene in a file of its own.
fn scene(test: &str, text: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("souple-window-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join(format!("{test}.toml"));
    std::fs::write(&path, text).unwrap();
    path
}

/// The window with a scene, or nothing where there is no adapter.
fn window(test: &str, scene: Option<PathBuf>, playing: bool) -> Option<Window> {
    let state = match souple_viewer::draw::device::open() {
        Ok(state) => state,
        Err(error) => {
            println!("skipped: {error}");
            if let Some(folder) = std::env::var_os("SOUPLE_SKIPPED") {
                std::fs::write(PathBuf::from(folder).join(format!("window-{test}")), error.to_string()).unwrap();
            }
            return None;
        }
    };
    let options = RunOptions { threads: 1, ..RunOptions::default() };
    let session = SessionOptions { playing, speed: None, ..SessionOptions::default() };
    let app = App::new(&state, scene, Vec::new(), options, session);
    let harness = Harness::builder()
        .with_size([1200.0, 800.0])
        .with_pixels_per_point(1.0)
        .renderer(WgpuTestRenderer::from_render_state(state))
        .build_ui_state(|ui, app: &mut App| app.ui(ui), app);
    Some(harness)
}

/// Goes on until the window is as wanted; what never comes fails after a minute.
fn until(window: &mut Window, what: &str, wanted: impl Fn(&App) -> bool) {
    let started = Instant::now();
    while !wanted(window.state()) {
        assert!(started.elapsed() < Duration::from_secs(60), "{what} did not come");
        window.step();
    }
    window.step();
}

fn step(app: &App) -> u64 {
    app.running().map_or(0, |r| r.snapshot.step)
}

fn arrived(app: &App) -> bool {
    app.running().is_some_and(|r| r.snapshot.controls.is_some())
}

fn view<'a>(window: &'a Window) -> Node<'a> {
    window.get_by_label("View of the bodies")
}

/// Where a point of space is in the window.
fn on_screen(window: &Window, point: [f32; 3]) -> egui::Pos2 {
    let area = view(window).rect();
    let running = window.state().running().unwrap();
    let [x, y] = running.camera.place(point, running.aspect);
    egui::pos2(area.center().x + 0.5 * x * area.width(), area.center().y - 0.5 * y * area.height())
}

/// Dragging a point of the body up moves it up, and the force is shown in newtons; let go, the spring is gone. The same
/// inputs without a window give the same trajectory to the last bit.
#[test]
fn grab_and_pull() {
    let path = scene("pull", &BAR.replace("GRAVITY", ""));
    let Some(mut window) = window("grab_and_pull", Some(path.clone()), true) else { return };
    until(&mut window, "the scene", |app| arrived(app) && step(app) > 3);
    // A point of the free end's upper front edge, a little inside its face.
    let start = on_screen(&window, [0.37, 0.08, 0.1]);
    window.drag_at(start);
    window.step();
    for k in 1..=10 {
        window.hover_at(start - egui::vec2(0.0, 8.0 * k as f32));
        window.step();
    }
    until(&mut window, "a pull", |app| {
        app.running().is_some_and(|r| r.snapshot.pulls.first().is_some_and(|(_, pull)| pull.force[1] > 0.01))
    });
    let now = step(window.state());
    until(&mut window, "motion", |app| step(app) > now + 20);
    let shown = window.query_all_by_label_contains("force ").next().is_some();
    assert!(shown, "no force is shown");
    let highest = |app: &App| {
        let r = app.running().unwrap();
        let moved = r.snapshot.positions.iter().zip(&r.model.rest).map(|(now, rest)| now[1] - rest[1]);
        moved.fold(f32::NEG_INFINITY, f32::max)
    };
    assert!(highest(window.state()) > 1e-3, "the body did not follow: {}", highest(window.state()));
    window.drop_at(start - egui::vec2(0.0, 80.0));
    until(&mut window, "the release", |app| app.running().is_some_and(|r| r.snapshot.pulls.is_empty()));
    window.get_by_label("Pause").click();
    until(&mut window, "the pause", |app| app.running().is_some_and(|r| !r.snapshot.playing));

    let (checkpoint, script) = window.state_mut().running_mut().unwrap().session.state().unwrap();
    assert!(script.len() > 2);
    let options = RunOptions { threads: 1, ..RunOptions::default() };
    let (mut headless, _) = scene_file::load(&path, &[], &options).unwrap();
    headless.run_on();
    replay(&mut headless, &script, step(window.state())).unwrap();
    assert!(headless.checkpoint() == checkpoint, "another trajectory");
}

/// Where there are no threads, a scene is read and runs between the pictures, and obeys as everywhere.
#[test]
fn a_scene_runs_between_pictures() {
    let path = scene("between", &BAR.replace("GRAVITY", "gravity = [0.0, -9.81, 0.0]"));
    let Some(mut window) = window("a_scene_runs_between_pictures", None, true) else { return };
    window.state_mut().place = Place::Pictures;
    window.state_mut().open(path);
    // One picture begins the scene, and each that follows shows what was computed after the one before.
    for _ in 0..3 {
        window.step();
    }
    let begun = step(window.state());
    window.step();
    assert!(step(window.state()) > begun);
    window.get_by_label("Pause").click();
    until(&mut window, "the pause", |app| app.running().is_some_and(|r| !r.snapshot.playing));
    let then = step(window.state());
    window.step();
    assert_eq!(step(window.state()), then);
    window.get_by_label("Step").click();
    until(&mut window, "a step", |app| step(app) == then + 1);
}

/// Paused, time stands still however often the window is drawn; a step makes exactly one.
#[test]
fn pause_stops_time() {
    let path = scene("pause", &BAR.replace("GRAVITY", "gravity = [0.0, -9.81, 0.0]"));
    let Some(mut window) = window("pause_stops_time", Some(path), true) else { return };
    until(&mut window, "motion", |app| step(app) > 3);
    window.get_by_label("Pause").click();
    until(&mut window, "the pause", |app| app.running().is_some_and(|r| !r.snapshot.playing));
    let stopped = step(window.state());
    window.run_steps(20);
    assert_eq!(step(window.state()), stopped);
    window.get_by_label("Step").click();
    until(&mut window, "a step", |app| step(app) > stopped);
    window.run_steps(5);
    assert_eq!(step(window.state()), stopped + 1);
    window.key_press(egui::Key::Space);
    until(&mut window, "motion again", |app| step(app) > stopped + 5);
}

/// A softer material, given in the panel, sags further.
#[test]
fn parameters_take_effect() {
    let path = scene("parameter", &BAR.replace("GRAVITY", "gravity = [0.0, -1.0, 0.0]"));
    let Some(mut window) = window("parameters_take_effect", Some(path), true) else { return };
    let lowest = |app: &App| {
        let r = app.running().unwrap();
        r.snapshot.positions.iter().map(|p| p[1]).fold(f32::INFINITY, f32::min)
    };
    until(&mut window, "rest", |app| step(app) > 150);
    let before = lowest(window.state());
    // The first block is that of the hexahedra, at the clamp.
    let field = window.get_all_by_role_and_label(egui::accesskit::Role::SpinButton, "young in Pa").next().unwrap();
    field.set_value_accesskit(1e4);
    until(&mut window, "the parameter", |app| {
        app.running().is_some_and(|r| r.snapshot.controls.as_ref().is_some_and(|c| c.parameters[0][0] == 1e4))
    });
    let now = step(window.state());
    until(&mut window, "sagging", |app| step(app) > now + 150);
    assert!(lowest(window.state()) < before - 1e-3, "{before} and {}", lowest(window.state()));
}

/// A section takes away what is in front of it: pixels of the view change, and those of the panels beside do not vanish.
#[test]
fn sections_change_the_picture() {
    let path = scene("section", &BAR.replace("GRAVITY", ""));
    let Some(mut window) = window("sections_change_the_picture", Some(path), false) else { return };
    until(&mut window, "the scene", arrived);
    window.run_steps(3);
    let area = view(&window).rect();
    let before = window.render().unwrap();
    window.get_by_label("section").click();
    window.run_steps(3);
    assert!(window.state().running().unwrap().look.section.is_some());
    let after = window.render().unwrap();
    let mut changed = 0;
    let mut shown = 0;
    for y in area.top() as u32 + 1..area.bottom() as u32 {
        for x in area.left() as u32 + 1..area.right() as u32 {
            let (a, b) = (before.get_pixel(x, y), after.get_pixel(x, y));
            changed += u32::from((0..3).any(|k| a[k].abs_diff(b[k]) > 24));
            // The hexahedra's and the prisms' colours are far from grey.
            let spread = (0..3).map(|k| b[k]).max().unwrap() - (0..3).map(|k| b[k]).min().unwrap();
            shown += u32::from(spread > 60);
        }
    }
    assert!(changed > 1000, "{changed} pixels changed");
    assert!(shown > 1000, "only {shown} pixels show the body");
}

/// The view holds the drawn picture pixel for pixel, and panels have their colour, though egui fills neither.
#[test]
fn the_backdrop_is_the_picture() {
    let path = scene("backdrop", &BAR.replace("GRAVITY", ""));
    let Some(mut window) = window("the_backdrop_is_the_picture", Some(path), false) else { return };
    until(&mut window, "the scene", arrived);
    window.run_steps(3);
    let area = view(&window).rect();
    let shown = window.render().unwrap();
    let drawn = window.state().picture().unwrap();
    assert_eq!(drawn.size, [area.width().round() as u32, area.height().round() as u32]);
    let corner = [area.left().round() as u32, area.top().round() as u32];
    let (mut equal, mut body) = (0, 0);
    for y in 0..drawn.size[1] {
        for x in 0..drawn.size[0] {
            let (a, b) = (drawn.at([x, y]), shown.get_pixel(corner[0] + x, corner[1] + y));
            equal += u32::from(a[..] == b.0[..3]);
            body += u32::from(a.iter().max().unwrap() - a.iter().min().unwrap() > 60);
        }
    }
    let all = drawn.size[0] * drawn.size[1];
    // Title, legend, axes and scale are written over it.
    assert!(equal > all / 10 * 9, "{equal} of {all} pixels are the picture's");
    assert!(body > 1000, "only {body} pixels show the body");
    let fill = window.ctx.global_style().visuals.panel_fill;
    let below_the_panels = shown.get_pixel(area.left() as u32 / 2, area.bottom() as u32 - 4);
    assert_eq!(below_the_panels.0, fill.to_array());
}

/// The window of a scene that has not begun looks as it did when its picture was kept: panels, names, colours, body.
///
/// `SOUPLE_BLESS=1` keeps a new picture; look at it.
#[test]
fn the_window_looks_as_kept() {
    let matching = BAR.replace("sections = [", r#"transition = "pyramids", sections = ["#);
    let path = scene("kept", &matching.replace("GRAVITY", ""));
    let Some(mut window) = window("the_window_looks_as_kept", Some(path), false) else { return };
    until(&mut window, "the scene", arrived);
    window.run_steps(3);
    let now = window.render().unwrap();
    let kept = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots/window.png");
    if std::env::var_os("SOUPLE_BLESS").is_some() {
        let pixels = Pixels { size: [now.width(), now.height()], bytes: now.into_raw() };
        std::fs::create_dir_all(kept.parent().unwrap()).unwrap();
        std::fs::write(&kept, pixels.png().unwrap()).unwrap();
        return;
    }
    let mut reader = png::Decoder::new(BufReader::new(std::fs::File::open(&kept).unwrap())).read_info().unwrap();
    let mut then = vec![0; reader.output_buffer_size().unwrap()];
    let about = reader.next_frame(&mut then).unwrap();
    assert_eq!([about.width, about.height], [now.width(), now.height()]);
    // Devices round and sample edges differently: one in a hundred pixels may.
    let differs = |a: &[u8], b: &[u8]| (0..3).any(|k| a[k].abs_diff(b[k]) > 32);
    let different = then.chunks_exact(3).zip(now.as_raw().chunks_exact(4)).filter(|(a, b)| differs(a, b)).count();
    let all = (now.width() * now.height()) as usize;
    assert!(different * 100 < all, "{different} of {all} pixels are others than in {}", kept.display());
}

/// Where the processor draws, texts, controls and plots look as egui itself draws them, to a step or two of 255.
#[test]
fn ink_is_what_egui_draws() {
    let inked = |state: &_| Ink::new(state);
    let plain = |_: &_| None;
    let content = |ui: &mut egui::Ui| {
        ui.heading("Souple");
        ui.label("Forces, tangents, and letters with accents: é à ü");
        ui.add(egui::Slider::new(&mut 0.4, 0.0..=1.0).text("poisson"));
        let _ = ui.button("Play");
        ui.checkbox(&mut true, "edges");
        egui::ScrollArea::vertical().max_height(60.0).show(ui, |ui| {
            (0..30).for_each(|k| drop(ui.label(format!("line {k}"))));
        });
        let points: Vec<[f64; 2]> = (0..40).map(|k| [f64::from(k), f64::from(k * k)]).collect();
        egui_plot::Plot::new("plot").height(100.0).show(ui, |plot| plot.line(egui_plot::Line::new("line", points)));
    };
    let picture = |of: &dyn Fn(&RenderState) -> Option<Ink>| {
        let state = souple_viewer::draw::device::open().ok()?;
        let mut ink = of(&state);
        let mut taken = 0;
        let builder = Harness::builder().with_size([400.0, 400.0]).with_pixels_per_point(1.25);
        let mut harness = builder.renderer(WgpuTestRenderer::from_render_state(state)).build_ui(|ui| {
            content(ui);
            taken += usize::from(ink.as_mut().is_some_and(|ink| ink.take_over(ui.ctx(), ui.layer_id())));
        });
        // The texture of letters comes with the first picture.
        harness.render().unwrap();
        harness.run_steps(2);
        let picture = harness.render().unwrap();
        drop(harness);
        Some((picture, taken))
    };
    let (Some((theirs, _)), Some((ours, taken))) = (picture(&plain), picture(&inked)) else {
        println!("skipped: there is no graphics device");
        return;
    };
    if taken == 0 {
        println!("skipped: a graphics card draws what egui draws");
        return;
    }
    let farthest = theirs.as_raw().iter().zip(ours.as_raw()).map(|(a, b)| a.abs_diff(*b)).max().unwrap();
    assert!(farthest <= 2, "a pixel differs by {farthest}");
    let painted = theirs.pixels().filter(|p| p[0] > 100).count();
    assert!(painted > 1000, "the picture is empty");
}

/// A scene that is wrong shows why in the window, which goes on, and reads it again when it is right.
#[test]
fn invalid_scenes_show_their_error() {
    let path = scene("invalid", &BAR.replace("GRAVITY", "gravty = [0.0, -1.0, 0.0]"));
    let Some(mut window) = window("invalid_scenes_show_their_error", Some(path), false) else { return };
    until(&mut window, "the error", |app| matches!(app.stage, Stage::Failed { .. }));
    assert!(window.query_by_label_contains("cannot be shown").is_some());
    assert!(window.query_by_label_contains("gravty").is_some(), "the message does not name the key");
    scene("invalid", &BAR.replace("GRAVITY", ""));
    window.get_by_label("Read again").click();
    until(&mut window, "the scene", arrived);
}

/// Without a scene the window offers the bundled ones, and opens the one that is chosen.
#[test]
fn scenes_are_offered() {
    let Some(mut window) = window("scenes_are_offered", None, false) else { return };
    window.run_steps(2);
    assert!(window.query_by_label("organ").is_some());
    window.get_by_label("mixed_bar").click();
    until(&mut window, "the scene", arrived);
    assert_eq!(window.state().running().unwrap().model.title, "Mixed bar under gravity");
}

/// Keys and panels lead to what they say: wireframe, pulled apart, field, marks.
#[test]
fn looks_are_chosen() {
    let path = scene("looks", &BAR.replace("GRAVITY", "gravity = [0.0, -9.81, 0.0]"));
    let Some(mut window) = window("looks_are_chosen", Some(path), true) else { return };
    until(&mut window, "motion", |app| step(app) > 3);
    let mut pictures = vec![window.render().unwrap().into_raw()];
    window.get_by_label("wireframe").click();
    window.run_steps(3);
    pictures.push(window.render().unwrap().into_raw());
    window.get_by_label("edges").click();
    window.state_mut().running_mut().unwrap().look.element_size = 0.7;
    window.run_steps(3);
    pictures.push(window.render().unwrap().into_raw());
    let field = souple_simulation::ElementField::VonMises;
    window.state_mut().running_mut().unwrap().look.colour_by = souple_viewer::colouring::ColourBy::Field(field);
    until(&mut window, "the field", |app| app.running().is_some_and(|r| r.snapshot.field(field).is_some()));
    pictures.push(window.render().unwrap().into_raw());
    for (k, a) in pictures.iter().enumerate() {
        for b in &pictures[..k] {
            let apart = a.iter().zip(b).filter(|(a, b)| a.abs_diff(**b) > 24).count();
            assert!(apart > 3000, "two looks differ in {apart} bytes only");
        }
    }
}

/// Roles of what can be used.
const CONTROLS: [Role; 10] = [
    Role::Button,
    Role::CheckBox,
    Role::RadioButton,
    Role::Slider,
    Role::SpinButton,
    Role::ComboBox,
    Role::TextInput,
    Role::MultilineTextInput,
    Role::Link,
    Role::DisclosureTriangle,
];

/// Controls that are shown: number, role, label, whether they are disabled.
fn controls(window: &Window) -> Vec<(String, Role, String, bool)> {
    let nodes = window.root().children_recursive();
    nodes
        .map(|node| node.accesskit_node())
        .filter(|node| CONTROLS.contains(&node.role()))
        .map(|node| (format!("{:?}", node.id()), node.role(), node.label().unwrap_or_default(), node.is_disabled()))
        .collect()
}

/// Every control of a window has a name that is read out, and the keyboard reaches each that is not disabled.
fn all_named_and_reached(window: &mut Window, shown: &str) {
    window.run_steps(2);
    let found = controls(window);
    assert!(!found.is_empty(), "{shown}: no controls");
    let unnamed: Vec<_> = found.iter().filter(|c| c.2.trim().is_empty()).collect();
    assert!(unnamed.is_empty(), "{shown}: without a name: {unnamed:?}");
    let mut reached = std::collections::BTreeSet::new();
    for _ in 0..2 * found.len() + 10 {
        if found.iter().all(|c| c.3 || reached.contains(&c.0)) {
            break;
        }
        window.key_press(egui::Key::Tab);
        window.step();
        let focused = window.root().children_recursive().find(|n| n.is_focused());
        reached.extend(focused.map(|n| format!("{:?}", n.accesskit_node().id())));
    }
    let missed: Vec<_> = found.iter().filter(|c| !c.3 && !reached.contains(&c.0)).collect();
    assert!(missed.is_empty(), "{shown}: the keyboard does not reach {missed:?}");
}

/// Everything that can be used has a name and is reached by the Tab key: while scenes are chosen, when one is wrong, and
/// with each of the hands while one runs.
#[test]
fn controls_have_names_and_keys() {
    let Some(mut choosing) = window("controls_have_names_and_keys", None, false) else { return };
    all_named_and_reached(&mut choosing, "choosing");
    let path = scene("unnamed", "gravty = 1");
    let Some(mut failed) = window("controls_have_names_and_keys", Some(path), false) else { return };
    until(&mut failed, "the error", |app| matches!(app.stage, Stage::Failed { .. }));
    all_named_and_reached(&mut failed, "failed");
    let path = scene("named", &BAR.replace("GRAVITY", ""));
    let Some(mut running) = window("controls_have_names_and_keys", Some(path), false) else { return };
    until(&mut running, "the scene", arrived);
    running.get_by_label("Record").click();
    running.get_by_label("section").click();
    for hand in ["pull", "push", "hold", "free"] {
        running.get_by_label(hand).click();
        running.run_steps(2);
        if hand == "push" {
            running.get_by_label("tool").click();
        }
        running.state_mut().running_mut().unwrap().look.colour_by = souple_viewer::colouring::ColourBy::Quality;
        all_named_and_reached(&mut running, hand);
    }
}
