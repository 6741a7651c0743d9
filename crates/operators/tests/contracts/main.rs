//! What is promised of every element, law and quadrature: checked over the registries, so that a new file is under
//! test at once. Elements, laws and rules of one test run are those of [`sample`].

#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod averages;
mod backends;
mod blocks;
mod counts;
mod derivatives;
mod determinism;
mod embedded;
mod goldens;
mod invariance;
mod masses;
mod patch;
mod programs;
mod projected;
mod sample;
mod staging;
mod viscosity;
