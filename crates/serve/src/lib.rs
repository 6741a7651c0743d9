//! A simulation that runs here and is seen and touched in browsers: any number of viewers of one simulation.
//!
//! ```text
//! Session ── wake ──► hub ── newest frame ──► client, client, …   each takes it when it has drawn the one before
//!    ▲                 ▲                          │
//!    └── commands ─────┴──────── commands ────────┘
//! ```
//!
//! What it is not: a place where anything is computed (that is `souple_simulation`), nor a web framework. The page is a
//! handful of files in `page/`, embedded in the program; it asks nothing of any other server.
//!
//! Where to look next: [`server`] for what a program calls, [`message`] for what goes over the wire, [`command`] for what
//! comes back, [`gate`] for who may connect.

mod client;
pub mod colours;
pub mod command;
pub mod frame;
pub mod gate;
mod hub;
pub mod message;
mod page;
pub mod scene_message;
pub mod server;
pub mod surface;
