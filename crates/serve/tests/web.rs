//! The window as a page of its own (`cargo xtask web`), in a real browser: it draws the body, time goes on, and it computes
//! what the interpreter computes on this machine.
//!
//! The page takes minutes to build, so that these tests look at the folder that `SOUPLE_WEB` names; without it, or
//! without a Chromium, they pass and say that they were skipped:
//!
//! ```text
//! cargo xtask web && SOUPLE_WEB=target/web/page cargo test -p souple-serve --test web
//! ```
//!
//! `SOUPLE_BLESS=1` renews the picture of the documentation.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

#[expect(dead_code, reason = "this page is looked at, the other one is touched too")]
mod chromium;

use chromium::{Browser, is, pixels, program};
use souple_serve::colours::{Colour, family};
use souple_simulation::elements::Family;
use souple_simulation::{RunOptions, Simulation};
use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::path::{Path, PathBuf};

/// The folder and a browser, or a note that there is none.
fn page(test: &str) -> Option<(SocketAddr, Browser)> {
    let skipped = |why: &str| {
        println!("skipped: {why}");
        if let Some(notes) = std::env::var_os("SOUPLE_SKIPPED") {
            std::fs::write(Path::new(&notes).join(format!("serve-web-{test}")), why).unwrap();
        }
    };
    let Some(folder) = std::env::var_os("SOUPLE_WEB").map(PathBuf::from) else {
        skipped("SOUPLE_WEB names no page that `cargo xtask web` has built");
        return None;
    };
    let Some(program) = program() else {
        skipped("no Chromium");
        return None;
    };
    // Tests run in their package's folder, and people name folders from the repository's.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(folder);
    assert!(folder.join("index.html").is_file(), "{} holds no page", folder.display());
    let profile = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("chromium-web-{test}-{}", std::process::id()));
    Some((serve(folder), Browser::start(&program, profile, [1280, 800])))
}

/// Serves the files of a folder for as long as the test runs.
fn serve(folder: PathBuf) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    std::thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            // A browser that goes away in the midst of an answer needs none.
            let _ = answer(stream, &folder);
        }
    });
    address
}

fn answer(mut stream: TcpStream, folder: &Path) -> std::io::Result<()> {
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let request = lines.next().transpose()?.unwrap_or_default();
    lines.map_while(Result::ok).take_while(|line| !line.is_empty()).for_each(drop);
    let path = request.split(' ').nth(1).unwrap_or("/").split('?').next().unwrap_or("/");
    let name = if path == "/" { "index.html" } else { &path[1..] };
    let kind = match name.rsplit_once('.').map(|n| n.1) {
        Some("html") => "text/html",
        Some("js") => "text/javascript",
        _ => "application/wasm",
    };
    let (status, bytes) = match std::fs::read(folder.join(name)) {
        Ok(bytes) => ("200 OK", bytes),
        Err(_) => ("404 Not Found", Vec::new()),
    };
    let length = bytes.len();
    write!(
        stream,
        "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
    )?;
    stream.write_all(&bytes)
}

/// The spring in a hand, as the window draws it.
const HAND: Colour = [0xd8, 0x1b, 0x60];

/// What was done before this is seen after it: in one picture it is asked for, and after the next it is shown.
fn a_picture_later(browser: &mut Browser) {
    let now = browser.value("document.body.dataset.pictures");
    let now: u64 = now.as_str().unwrap().parse().unwrap();
    browser.wait_for(&format!("Number(document.body.dataset.pictures) > {}", now + 2));
}

/// Nothing was wrong in the page, and nobody but its server was asked.
fn no_complaints(browser: &Browser, address: SocketAddr) {
    let (complaints, requests) = browser.complaints_and_requests();
    assert!(complaints.is_empty(), "{complaints:#?}");
    let own = format!("http://{address}/");
    let foreign = |url: &&String| !url.starts_with(&own) && !url.starts_with("data:") && *url != "about:blank";
    assert!(requests.iter().find(foreign).is_none() && requests.len() >= 3, "{requests:#?}");
}

/// The body of the mixed bar is drawn in the colours of its four kinds of elements, it moves, and time goes on; pulled at
/// its tip, it follows.
#[test]
fn the_page_draws_and_runs() {
    let Some((address, mut browser)) = page("runs") else { return };
    browser.go(&format!("http://{address}/?scene=mixed_bar"));
    browser.wait_for("Number(document.body.dataset.time) > 0.02");
    let first = browser.screenshot();
    browser.wait_for("Number(document.body.dataset.time) > 0.3");
    let file = browser.screenshot();
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("web-runs.png"), &file).unwrap();
    if std::env::var_os("SOUPLE_BLESS").is_some() {
        std::fs::write("../../docs/pictures/view/page.png", &file).unwrap();
    }
    let (before, after) = (pixels(&first), pixels(&file));
    assert_eq!((after.width, after.height), (1280, 800));
    // Between the panels there is nothing but the view, whose legend has patches of some two hundred pixels.
    let view: Vec<usize> = (0..800 * 1280).filter(|k| (280..960).contains(&(k % 1280))).collect();
    for kind in [Family::Hexahedron, Family::Prism, Family::Pyramid, Family::Tetrahedron] {
        let count = view.iter().filter(|&&k| is(after.pixels[k], family(kind))).count();
        assert!(count > 1000, "{kind:?}: {count} pixels");
    }
    let moved = view.iter().filter(|&&k| before.pixels[k] != after.pixels[k]).count();
    assert!(moved > 2000, "{moved} pixels differ");

    // A point in the midst of the hexahedra is taken and dragged upwards: the spring in the hand is drawn until it is let
    // go.
    let at = |k: usize| [k % 1280, k / 1280].map(|x| x as f64);
    let body: Vec<[f64; 2]> =
        view.iter().filter(|&&k| is(after.pixels[k], family(Family::Hexahedron))).map(|&k| at(k)).collect();
    let mean: [f64; 2] = std::array::from_fn(|k| body.iter().map(|p| p[k]).sum::<f64>() / body.len() as f64);
    let distance = |p: &[f64; 2]| (p[0] - mean[0]).hypot(p[1] - mean[1]);
    let start = *body.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap();
    let hand = |browser: &mut Browser| {
        let picture = pixels(&browser.screenshot());
        view.iter().filter(|&&k| is(picture.pixels[k], HAND)).count()
    };
    assert_eq!(hand(&mut browser), 0);
    browser.mouse("mouseMoved", start);
    browser.mouse("mousePressed", start);
    for share in 1..=4 {
        browser.mouse("mouseMoved", [start[0], start[1] - 25.0 * f64::from(share)]);
        a_picture_later(&mut browser);
    }
    let pulled = hand(&mut browser);
    assert!(pulled > 100, "{pulled} pixels of the hand's spring");
    browser.mouse("mouseReleased", [start[0], start[1] - 100.0]);
    a_picture_later(&mut browser);
    assert_eq!(hand(&mut browser), 0);
    no_complaints(&browser, address);
}

/// A page that stands still at a time has the state that the interpreter reaches here by then. Not to the last bit: the
/// linear solver multiplies and adds in one rounding where the processor can, which pages cannot.
#[test]
fn the_page_computes_what_the_interpreter_computes() {
    let Some((address, mut browser)) = page("state") else { return };
    browser.go(&format!("http://{address}/?scene=mixed_bar&at=0.5"));
    browser.wait_for("document.body.dataset.state");
    assert_eq!(browser.value("document.body.dataset.playing"), "false");
    let state = browser.value("document.body.dataset.state");
    let state = state.as_str().unwrap().as_bytes();
    let byte = |digits: &[u8]| u8::from_str_radix(std::str::from_utf8(digits).unwrap(), 16).unwrap();
    let checkpoint: Vec<u8> = state.chunks(2).map(byte).collect();
    no_complaints(&browser, address);

    let (mut here, mut there) = (mixed_bar(), mixed_bar());
    let rest = here.positions();
    let mut step = 0;
    while here.time() < 0.5 - 0.5 * here.controls().step {
        step = here.advance().unwrap().step;
    }
    assert_eq!(browser.value("document.body.dataset.step"), step.to_string());
    there.restore(&checkpoint).unwrap();
    assert_eq!(there.time(), here.time());
    let largest = |a: &[[f64; 3]], b: &[[f64; 3]]| {
        a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let (moved, apart) = (largest(&here.positions(), &rest), largest(&here.positions(), &there.positions()));
    println!("moved {moved:e} m, apart {apart:e} m");
    assert!(moved > 0.1, "{moved} m");
    assert!(apart < 1e-9 * moved, "{apart} m apart after {moved} m");
}

/// The mixed bar on the interpreter that pages have too.
fn mixed_bar() -> Simulation {
    let text = std::fs::read_to_string("../../scenes/mixed_bar.toml").unwrap();
    let mut read = |file: &str| Err(format!("no file {file}"));
    let options = RunOptions { device: "cpu:baseline".into(), threads: 1 };
    let mut simulation = Simulation::load(&text, "scenes/mixed_bar.toml", &[], &mut read, &options).unwrap().0;
    simulation.run_on();
    simulation
}

/// What an address asks for and cannot have is said in the page.
#[test]
fn mistakes_of_the_address_are_said() {
    let Some((address, mut browser)) = page("mistakes") else { return };
    browser.go(&format!("http://{address}/?scene=mixed_bar&at=soon"));
    browser.wait_for("document.getElementById('message').textContent.includes('at=soon')");
}
