//! The page in a real browser: it draws the body in the colours of its elements, moves with it, pulls it, complains of
//! nothing, and asks nobody but its server.
//!
//! Without a Chromium these tests pass and say that they were skipped. `SOUPLE_BLESS=1` renews the picture of the
//! documentation.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

mod chromium;
mod client;

use chromium::{Browser, Picture, is, pixels, program};
use souple_serve::colours::family;
use souple_simulation::elements::Family;
use std::path::Path;

/// The browser, or a note that there is none.
fn browser(test: &str, size: [u32; 2]) -> Option<Browser> {
    let Some(program) = program() else {
        println!("skipped: no Chromium");
        if let Some(notes) = std::env::var_os("SOUPLE_SKIPPED") {
            std::fs::write(Path::new(&notes).join(format!("serve-{test}")), "no Chromium").unwrap();
        }
        return None;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("chromium-{test}-{}", std::process::id()));
    Some(Browser::start(&program, folder, size))
}

/// Middle of places, and their mean distance from it.
fn middle_and_spread(places: &[[f64; 2]]) -> ([f64; 2], f64) {
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| places.iter().map(of).sum::<f64>() / places.len() as f64;
    let middle = [mean(&|p| p[0]), mean(&|p| p[1])];
    (middle, mean(&|p| (p[0] - middle[0]).hypot(p[1] - middle[1])))
}

/// The place that is nearest to the middle of all.
fn central(places: &[[f64; 2]]) -> [f64; 2] {
    let (middle, _) = middle_and_spread(places);
    let distance = |p: &[f64; 2]| (p[0] - middle[0]).hypot(p[1] - middle[1]);
    *places.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
}

/// Places of the pixels of a family, left of the panel.
fn places(picture: &Picture, width: usize, of: Family) -> Vec<[f64; 2]> {
    let at = |k: usize| [k % picture.width, k / picture.width];
    let found = (0..picture.pixels.len()).filter(|&k| at(k)[0] < width && is(picture.pixels[k], family(of)));
    found.map(|k| at(k).map(|x| x as f64)).collect()
}

/// Keeps a picture where a person can look at it.
fn keep(name: &str, file: &[u8]) {
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join(name), file).unwrap();
}

/// The body is drawn in the colours of its four kinds of elements; it moves when time passes and when it is pulled; the
/// console has no error, and nothing is asked of anybody but the server.
#[test]
fn the_page_shows_and_touches_the_body() {
    let Some(mut browser) = browser("page", [1280, 800]) else { return };
    let server = client::scene("../../scenes/mixed_bar.toml");
    let address = format!("http://{}/", server.address());
    browser.go(&address);
    browser.wait_for("document.body.dataset.step === '0'");
    let file = browser.screenshot();
    keep("serve-rest.png", &file);
    let rest = pixels(&file);
    assert_eq!((rest.width, rest.height), (1280, 800));
    let kinds = [Family::Hexahedron, Family::Prism, Family::Pyramid, Family::Tetrahedron];
    for kind in kinds {
        // The legend's patches have some two hundred.
        let count = places(&rest, 960, kind).len();
        assert!(count > 1500, "{kind:?}: {count} pixels");
    }

    browser.value("document.getElementById('play').click()");
    browser.wait_for("Number(document.body.dataset.step) >= 8");
    browser.value("document.getElementById('play').click()");
    browser.wait_for("document.getElementById('play').textContent === 'Play'");
    let file = browser.screenshot();
    keep("serve-bent.png", &file);
    let bent = pixels(&file);
    let moved = (0..800 * 960).filter(|k| {
        let at = (k / 960) * 1280 + k % 960;
        rest.pixels[at] != bent.pixels[at]
    });
    let moved = moved.count();
    assert!(moved > 3000, "{moved} pixels");

    // The tip is of tetrahedra: a point in the midst of them is taken, and dragged upwards while time passes.
    let start = central(&places(&bent, 960, Family::Tetrahedron));
    browser.mouse("mousePressed", start);
    for share in 1..=4 {
        browser.mouse("mouseMoved", [start[0], start[1] - 40.0 * f64::from(share)]);
    }
    browser.wait_for("document.getElementById('pull').textContent.endsWith('N')");
    browser.value("document.getElementById('play').click()");
    browser.wait_for("Number(document.body.dataset.step) >= 22 && !document.getElementById('force').hidden");
    browser.value("document.getElementById('play').click()");
    browser.wait_for("document.getElementById('play').textContent === 'Play'");
    let file = browser.screenshot();
    keep("serve-pulled.png", &file);
    if std::env::var_os("SOUPLE_BLESS").is_some() {
        std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/pictures/serve.png"), &file).unwrap();
    }
    browser.mouse("mouseReleased", [start[0], start[1] - 160.0]);
    browser.wait_for("document.getElementById('pull').textContent === '–'");

    let (complaints, requests) = browser.complaints_and_requests();
    assert!(complaints.is_empty(), "{complaints:#?}");
    let own = format!("{}/", server.address());
    let foreign: Vec<&String> = requests
        .iter()
        .filter(|url| {
            let ours = [format!("http://{own}"), format!("ws://{own}")];
            !ours.iter().any(|start| url.starts_with(start)) && !url.starts_with("data:") && *url != "about:blank"
        })
        .collect();
    assert!(foreign.is_empty() && requests.len() > 8, "{requests:#?}");
}

/// Fingers do what the mouse does: one on the body pulls it, one beside it turns the view, two move it and zoom; a second
/// finger lets the body go.
#[test]
fn fingers_touch_the_body() {
    let Some(mut browser) = browser("fingers", [1280, 800]) else { return };
    let server = client::scene("../../scenes/mixed_bar.toml");
    browser.go(&format!("http://{}/", server.address()));
    browser.wait_for("document.body.dataset.step === '0'");
    // Of the middle of the bar, which stays in the picture.
    let seen = |browser: &mut Browser| {
        browser.wait_for("true");
        places(&pixels(&browser.screenshot()), 960, Family::Prism)
    };
    let first = seen(&mut browser);
    let (middle, spread) = middle_and_spread(&first);

    // A finger beside the body, upwards: seen from farther below.
    browser.touch("touchStart", &[[480.0, 150.0]]);
    browser.touch("touchMove", &[[480.0, 50.0]]);
    browser.touch("touchEnd", &[]);
    let turned = seen(&mut browser);
    assert_eq!(browser.value("document.getElementById('pull').textContent"), "–");
    assert!(turned != first);
    browser.touch("touchStart", &[[480.0, 50.0]]);
    browser.touch("touchMove", &[[480.0, 150.0]]);
    browser.touch("touchEnd", &[]);
    let (back, _) = middle_and_spread(&seen(&mut browser));
    assert!((back[0] - middle[0]).hypot(back[1] - middle[1]) < 2.0, "{back:?} is not {middle:?}");

    // Two fingers side by side: all moves with them, by as many pixels.
    browser.touch("touchStart", &[[440.0, 150.0]]);
    browser.touch("touchStart", &[[440.0, 150.0], [520.0, 150.0]]);
    browser.touch("touchMove", &[[440.0, 250.0], [520.0, 250.0]]);
    browser.touch("touchEnd", &[]);
    let (moved, same) = middle_and_spread(&seen(&mut browser));
    assert!((moved[1] - middle[1] - 100.0).abs() < 15.0, "{moved:?} after {middle:?}");
    assert!((same / spread - 1.0).abs() < 0.1, "{same} after {spread}");
    // Twice as far apart: twice as large, and what was between the fingers stays there.
    let [x, y] = moved;
    browser.touch("touchStart", &[[x, y - 70.0]]);
    browser.touch("touchStart", &[[x, y - 70.0], [x, y + 70.0]]);
    browser.touch("touchMove", &[[x, y - 140.0], [x, y + 140.0]]);
    browser.touch("touchEnd", &[]);
    let (there, larger) = middle_and_spread(&seen(&mut browser));
    assert!((1.7..2.3).contains(&(larger / same)), "{larger} after {same}");
    assert!((there[0] - x).hypot(there[1] - y) < 25.0, "{there:?} after {moved:?}");
    browser.value("document.body.dispatchEvent(new KeyboardEvent('keydown', { key: 'f', bubbles: true }))");

    let start = central(&seen(&mut browser));
    browser.touch("touchStart", &[start]);
    browser.touch("touchMove", &[[start[0], start[1] - 80.0]]);
    browser.value("document.getElementById('play').click()");
    browser.wait_for("document.getElementById('pull').textContent.endsWith('N')");
    browser.wait_for("!document.getElementById('force').hidden");
    let second = [start[0] + 90.0, start[1] - 80.0];
    browser.touch("touchStart", &[[start[0], start[1] - 80.0], second]);
    browser.wait_for("document.getElementById('pull').textContent === '–'");
    browser.touch("touchEnd", &[]);
    let (complaints, _) = browser.complaints_and_requests();
    assert!(complaints.is_empty(), "{complaints:#?}");
}

/// On a narrow screen nothing is wider than the screen; numbers get a legend with their unit, a cut shows the inside; when
/// the server ends the page says so, and goes on when another one takes its place.
#[test]
fn the_page_fits_and_comes_back() {
    let Some(mut browser) = browser("narrow", [400, 800]) else { return };
    let server = client::scene("../../scenes/mixed_bar.toml");
    let port = server.address().port();
    browser.go(&format!("http://{}/", server.address()));
    browser.wait_for("document.body.dataset.step === '0'");
    let wide = browser.value("document.documentElement.scrollWidth");
    assert!(wide.as_u64().unwrap() <= 400, "{wide}");
    browser.value(
        "document.getElementById('colour').value = 'von-mises'; \
         document.getElementById('colour').onchange(); document.getElementById('step').click()",
    );
    browser.wait_for("document.querySelector('#legend .ends').textContent.includes('Pa')");
    keep("serve-narrow.png", &browser.screenshot());
    let whole = pixels(&browser.screenshot());
    browser.value(
        "document.getElementById('axis').value = 'z'; document.getElementById('axis').oninput(); \
         document.getElementById('colour').value = 'element'; document.getElementById('colour').onchange()",
    );
    browser.wait_for("document.getElementById('legend').textContent.includes('hex8')");
    let file = browser.screenshot();
    keep("serve-cut.png", &file);
    assert!(pixels(&file).pixels != whole.pixels);

    server.stop();
    browser.wait_for("document.querySelector('main').classList.contains('lost')");
    drop(server);
    let again = client::scene_at("../../scenes/mixed_bar.toml", port);
    browser.wait_for("!document.querySelector('main').classList.contains('lost')");
    browser.value("document.getElementById('step').click()");
    browser.wait_for("document.body.dataset.step === '1'");
    drop(again);
}

/// Every scene of the collection is drawn, without a complaint, in all the groups of its legends.
#[test]
fn bundled_scenes_are_drawn() {
    let Some(mut browser) = browser("scenes", [1280, 800]) else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<_> = files.filter(|file| file.extension().is_some_and(|e| e == "toml")).collect();
    scenes.sort();
    assert!(!scenes.is_empty());
    for scene in scenes {
        let name = scene.file_stem().unwrap().to_str().unwrap().to_owned();
        let server = client::scene(scene.to_str().unwrap());
        browser.go(&format!("http://{}/", server.address()));
        browser.wait_for("document.body.dataset.step === '0'");
        let file = browser.screenshot();
        keep(&format!("serve-{name}.png"), &file);
        let picture = pixels(&file);
        let background = picture.pixels[picture.width * 100 + 480];
        let drawn = (0..800 * 960).filter(|k| picture.pixels[(k / 960) * 1280 + k % 960] != background).count();
        assert!(drawn > 30_000, "{name}: {drawn} pixels");
        let groups = client::connect(&server).unwrap().scene.header["legends"]["element"].clone();
        let shown = browser.value("document.querySelectorAll('#legend li').length");
        assert_eq!(shown.as_u64().unwrap() as usize, groups.as_array().unwrap().len(), "{name}");
        let (complaints, _) = browser.complaints_and_requests();
        assert!(complaints.is_empty(), "{name}: {complaints:#?}");
        // The page that lost its server would say so.
        browser.go("about:blank");
    }
}
