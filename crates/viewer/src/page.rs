//! `souple-page`: what a page runs; `cargo xtask web` builds it. See `souple_viewer::web`.

#[cfg(target_arch = "wasm32")]
fn main() {
    souple_viewer::web::start();
}

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    eprintln!(
        "error: this program runs in pages of a browser: `cargo xtask web` builds them; on a desktop, use souple-view"
    );
    std::process::ExitCode::from(2)
}
