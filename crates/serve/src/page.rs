//! The page, embedded in the program: a handful of files that ask nothing of any other server.

use axum::http::header::{self, HeaderName};

/// A file of the page.
pub(crate) struct File {
    /// Its path in the address.
    pub(crate) path: &'static str,
    /// What it is.
    pub(crate) kind: &'static str,
    /// What is in it.
    pub(crate) text: &'static str,
}

const SCRIPT: &str = "text/javascript; charset=utf-8";

/// All files.
pub(crate) const FILES: &[File] = &[
    File { path: "/", kind: "text/html; charset=utf-8", text: include_str!("../page/index.html") },
    File { path: "/page.css", kind: "text/css; charset=utf-8", text: include_str!("../page/page.css") },
    File { path: "/main.js", kind: SCRIPT, text: include_str!("../page/main.js") },
    File { path: "/connection.js", kind: SCRIPT, text: include_str!("../page/connection.js") },
    File { path: "/message.js", kind: SCRIPT, text: include_str!("../page/message.js") },
    File { path: "/camera.js", kind: SCRIPT, text: include_str!("../page/camera.js") },
    File { path: "/picture.js", kind: SCRIPT, text: include_str!("../page/picture.js") },
    File { path: "/pick.js", kind: SCRIPT, text: include_str!("../page/pick.js") },
    File { path: "/pointer.js", kind: SCRIPT, text: include_str!("../page/pointer.js") },
    File { path: "/panel.js", kind: SCRIPT, text: include_str!("../page/panel.js") },
    File { path: "/legend.js", kind: SCRIPT, text: include_str!("../page/legend.js") },
    File { path: "/numbers.js", kind: SCRIPT, text: include_str!("../page/numbers.js") },
];

/// Headers of every answer: the page may load from this server only, and nobody may frame it or keep it.
pub(crate) const HEADERS: [(HeaderName, &str); 5] = [
    (
        header::CONTENT_SECURITY_POLICY,
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (header::CACHE_CONTROL, "no-store"),
];
