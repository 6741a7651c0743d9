//! Where scenes and their meshes come from: the disk, or, in a page, what was built into the program.
//!
//! | where | scenes | pictures of them |
//! |---|---|---|
//! | [`disk`] | any file; the folder `scenes` here or above is offered | `docs/pictures/scenes` beside it |
//! | [`embedded`] | those of this repository's folder `scenes` | the same |
//!
//! Both answer the same three questions: `read`, `scenes` and `picture`. Nothing here knows what a scene means.

#[cfg(not(target_arch = "wasm32"))]
mod disk;
#[cfg(any(target_arch = "wasm32", test))]
mod embedded;

#[cfg(not(target_arch = "wasm32"))]
pub(crate) use disk::{picture, read, scenes};
#[cfg(target_arch = "wasm32")]
pub(crate) use embedded::{picture, read, scenes};

/// Whether there is a disk, to choose files of and to write to.
pub(crate) const DISK: bool = cfg!(not(target_arch = "wasm32"));
