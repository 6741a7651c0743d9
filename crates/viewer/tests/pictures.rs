//! Pictures without a window, by their pixels, and animations by what their files hold.
//!
//! Without a graphics adapter, hardware or software, the tests that draw pass and say that they were skipped.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

use souple_simulation::RunOptions;
use souple_simulation::elements::Family;
use souple_viewer::animation::Animation;
use souple_viewer::camera::Camera;
use souple_viewer::colouring::{ColourBy, Legend, Scale, colours};
use souple_viewer::draw::device::Pixels;
use souple_viewer::draw::frame::bounds;
use souple_viewer::draw::renderer::Shot;
use souple_viewer::draw::studio::{Pose, Studio};
use souple_viewer::look::{Faces, Look, Section};
use souple_viewer::model::Model;
use souple_viewer::palette::{BACKGROUND, family};
use souple_viewer::scene_file;
use std::path::{Path, PathBuf};

fn model(scene: &str) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(scene);
    let options = RunOptions { threads: 1, ..RunOptions::default() };
    Model::of(&scene_file::load(&path, &[], &options).unwrap().0)
}

fn studio(test: &str) -> Option<Studio> {
    match Studio::open() {
        Ok(studio) => Some(studio),
        Err(error) => {
            println!("skipped: {error}");
            if let Some(folder) = std::env::var_os("SOUPLE_SKIPPED") {
                std::fs::write(PathBuf::from(folder).join(format!("pictures-{test}")), error.to_string()).unwrap();
            }
            None
        }
    }
}

fn picture(studio: &mut Studio, model: &Model, look: &Look) -> Pixels {
    let all = bounds(&model.rest);
    let camera = Camera::around(all[0], all[1], [0.0, 1.0, 0.0]);
    let shot = Shot { size: [480, 270], camera, section: look.section, ground: None };
    let pose = Pose { positions: &model.rest, field: &[], held: &[], subtitle: "" };
    studio.scene(model, pose, look, shot).unwrap()
}

/// Number of pixels whose hue is nearest to each of these colours; grey ones are of none.
fn counts(pixels: &Pixels, colours: &[[u8; 3]]) -> Vec<usize> {
    // Light changes how bright a colour is, not the ratios of its channels above the least.
    let direction = |c: [u8; 3]| {
        let low = f32::from(*c.iter().min().unwrap());
        let v = c.map(|x| f32::from(x) - low);
        let size = v.iter().map(|x| x * x).sum::<f32>().sqrt();
        (size, v.map(|x| x / size.max(1e-6)))
    };
    let mut counts = vec![0; colours.len()];
    for y in 0..pixels.size[1] {
        for x in 0..pixels.size[0] {
            let (strength, hue) = direction(pixels.at([x, y]));
            if strength < 40.0 {
                continue;
            }
            let likeness = |c: &[u8; 3]| (0..3).map(|k| direction(*c).1[k] * hue[k]).sum::<f32>();
            let best = (0..colours.len()).max_by(|&a, &b| likeness(&colours[a]).total_cmp(&likeness(&colours[b])));
            counts[best.unwrap()] += 1;
        }
    }
    counts
}

/// In the mixed bar all four families of elements are seen, each in its own colour.
#[test]
fn families_are_seen() {
    let Some(mut studio) = studio("families_are_seen") else { return };
    let model = model("mixed_bar.toml");
    let families = [Family::Hexahedron, Family::Prism, Family::Pyramid, Family::Tetrahedron].map(family);
    let seen = counts(&picture(&mut studio, &model, &Look::default()), &families);
    assert!(seen.iter().all(|&n| n > 1500), "{seen:?}");
}

/// A cut through the organ shows the hexahedra and pyramids that its tetrahedra hide.
#[test]
fn sections_show_the_inside() {
    let Some(mut studio) = studio("sections_show_the_inside") else { return };
    let model = model("organ.toml");
    let families = [Family::Hexahedron, Family::Pyramid, Family::Tetrahedron].map(family);
    let faces = Faces::Plain;
    let outside = counts(&picture(&mut studio, &model, &Look { faces, ..Look::default() }), &families);
    assert_eq!((outside[0], outside[1]), (0, 0));
    let [low, high] = bounds(&model.rest);
    let section = Some(Section { normal: [0.0, 0.0, 1.0], offset: 0.5 * (low[2] + high[2]) });
    let inside = counts(&picture(&mut studio, &model, &Look { faces, section, ..Look::default() }), &families);
    assert!(inside[0] > 3000 && inside[1] > 40 && inside[2] > 3000, "{inside:?}");
}

/// The surface of a volume is a small part of it: what is drawn of the organ is faces of one element only, closed.
#[test]
fn the_surface_is_closed_and_small() {
    let model = model("organ.toml");
    let mut edges = std::collections::BTreeMap::new();
    for t in &model.skin.triangles {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            *edges.entry((a.min(b), a.max(b))).or_insert(0) += if a < b { 1 } else { -1 };
        }
    }
    assert!(edges.values().all(|&sum| sum == 0), "the surface has a rim");
    assert!(model.skin.triangles.len() < model.elements.len());
}

/// A membrane that covers a solid is drawn in its place: no two faces share all of their nodes.
#[test]
fn no_face_is_drawn_twice() {
    let model = model("skin_and_tendon.toml");
    let mut triangles: Vec<[u32; 3]> = model.skin.triangles.clone();
    triangles.iter_mut().for_each(|t| t.sort_unstable());
    triangles.sort_unstable();
    assert!(triangles.windows(2).all(|w| w[0] != w[1]));
    let owners = model.skin.owners.iter().filter(|&&e| model.elements[e as usize].kind.dimension() == 2);
    assert!(owners.count() > 0, "the skin is not drawn");
}

/// Every way to colour has an entry for every element, and numbers come with a range.
#[test]
fn every_colouring_is_complete() {
    for scene in ["mixed_bar.toml", "organ.toml", "skin_and_tendon.toml"] {
        let model = model(scene);
        let field: Vec<f32> = (0..model.elements.len()).map(|e| e as f32).collect();
        for (by, name, _) in souple_viewer::colouring::choices() {
            let colours = colours(&model, by, &model.rest, &field, Scale::default());
            assert_eq!(colours.elements.len(), model.elements.len(), "{name}");
            match (by, colours.legend) {
                (ColourBy::Nothing, legend) => assert_eq!(legend, Legend::None),
                (_, Legend::Names(names)) => assert!(!names.is_empty(), "{name}"),
                (_, Legend::Range { ends, .. }) => assert!(ends[0] <= ends[1], "{name}"),
                (_, legend) => panic!("{name}: {legend:?}"),
            }
        }
    }
}

/// An animation holds the pictures that were added, each as long as it was shown, and none too close to another.
#[test]
fn animations_hold_their_pictures() {
    let path = std::env::temp_dir().join(format!("souple-animation-{}.gif", std::process::id()));
    let mut animation = Animation::start(&path).unwrap();
    for (k, time) in [(0u8, 0.0), (1, 0.01), (2, 0.1), (3, 0.3)] {
        let bytes = [40 * k, 0, 255, 255].repeat(12);
        animation.add(&Pixels { size: [4, 3], bytes }, time).unwrap();
    }
    assert_eq!(animation.finish().unwrap(), path);
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut reader = options.read_info(std::fs::File::open(&path).unwrap()).unwrap();
    let mut found = Vec::new();
    while let Some(frame) = reader.read_next_frame().unwrap() {
        found.push((frame.delay, frame.buffer[0]));
    }
    assert_eq!(found, [(10, 0), (20, 80), (10, 120)]);
    std::fs::remove_file(path).unwrap();
}

/// The background is where nothing is, and PNG files hold the pixels.
#[test]
fn pixels_become_files() {
    let Some(mut studio) = studio("pixels_become_files") else { return };
    let pixels = picture(&mut studio, &model("mixed_bar.toml"), &Look::default());
    assert!(pixels.at([0, 0]).iter().zip(BACKGROUND).all(|(a, b)| a.abs_diff(b) <= 1));
    let file = pixels.png().unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let about = reader.next_frame(&mut bytes).unwrap();
    assert_eq!([about.width, about.height], pixels.size);
    assert!(bytes.chunks(3).zip(pixels.bytes.chunks(4)).all(|(a, b)| a == &b[..3]));
}
