//! The kernel language and its compiler, tested through the crate's public functions.

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod associate;
mod files;
mod stage;
mod text;
mod verify;
