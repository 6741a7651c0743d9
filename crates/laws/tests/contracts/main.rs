//! What is promised of every law, of user laws and of their checks.

#![allow(clippy::unwrap_used, reason = "a test that cannot unwrap has failed")]

mod check;
mod ogden;
mod registry;
mod sample;
mod stresses;
mod user;
