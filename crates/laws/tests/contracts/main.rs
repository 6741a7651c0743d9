//! What is promised of every law, of user laws and of their checks.

mod registry;
mod sample;
mod stresses;
