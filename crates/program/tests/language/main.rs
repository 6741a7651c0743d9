//! The kernel language and its compiler, tested through the crate's public functions.

mod associate;
mod files;
mod stage;
mod text;
mod verify;
