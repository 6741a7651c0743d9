//! What people see: a window in which a simulation runs and can be touched, and pictures without a window.
//!
//! ```text
//! scene ── souple_simulation ──► Session (own thread) ── snapshots ──► Model + Look + Camera ── draw ──► pixels
//!                                       ▲                                                    │
//!                                       └──────────────── commands ◄── panels, hand ─────────┘
//! ```
//!
//! Nothing below knows this crate, and nothing here computes a force: what a hand does to a body is a
//! [command](souple_simulation::session::Command) of the simulation.

pub mod address;
pub mod animation;
pub mod app;
pub mod camera;
pub mod colouring;
pub mod draw;
mod files;
pub mod geometry;
pub mod look;
pub mod model;
pub mod numbers;
pub mod palette;
pub mod scene_file;
pub mod screenshot;
#[cfg(feature = "window")]
pub mod trial;
pub mod triangles;
#[cfg(all(feature = "web", target_arch = "wasm32"))]
pub mod web;
#[cfg(feature = "window")]
pub mod window;
