//! Reports: a group as one page that opens in a browser, without a network.
//!
//! ```text
//! database ── read ──► Group ── quantities ──► Derived ── page ──► one HTML file, data and scripts inside
//!                        └────── scene ── cantilever ──┘
//! ```
//!
//! The page is a function of the database alone: no date, no clock, so that the same results give the same bytes.

pub mod cantilever;
pub mod data;
pub mod page;
pub mod quantities;
pub mod read;
pub mod scene;
pub mod units;

/// The name under which what solvers say of themselves stands among the probes.
pub const SOLVER: &str = "solver";
