//! Campaigns as a person meets them.

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

mod browser;
mod chance;
mod compare;
mod description;
mod disturbed;
mod example;
mod export;
mod hyperqueue;
mod place;
mod postgres;
mod report;
mod running;
mod schedulers;
mod serve;
mod shipped;
mod traction;
