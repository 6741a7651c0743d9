//! The commands, one module each: `Arguments` and `run`.

pub(crate) mod bench;
pub(crate) mod campaign;
pub(crate) mod check;
pub(crate) mod check_law;
pub(crate) mod derive;
pub(crate) mod doctor;
pub(crate) mod list;
pub(crate) mod mesh;
mod neighbour;
pub(crate) mod run;
pub(crate) mod serve;
pub(crate) mod view;
