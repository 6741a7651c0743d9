//! Campaigns: groups of simulations, described in one file, run as processes of their own, kept in a database.
//!
//! ```text
//! campaign.toml ─┐
//!                ├─► Group ── plan ──► Planned, … ── identity ──► Job, … ── queue ──► Outcome, … ──► database
//! params.csv … ──┘                                                  worker: souple run
//! ```
//!
//! What it is not: a simulator. It starts `souple run` for each simulation and keeps what that writes.

mod bar_in_scene;
pub mod campaign;
pub mod compare;
pub mod database;
pub mod description;
pub mod export;
pub mod folder;
pub mod folder_scene;
pub mod group;
pub mod identity;
pub mod owner;
pub mod plan;
pub mod problem;
pub mod queue;
pub mod report;
pub mod scheduler;
pub mod serve;
pub mod spool;
mod toml_table;
pub mod traction;
pub mod values;
pub mod verdict;
pub mod worker;
