//! Campaigns as a person meets them.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

mod browser;
mod compare;
mod description;
mod example;
mod export;
mod report;
mod running;
mod serve;
mod shipped;
