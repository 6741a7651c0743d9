//! Blocks of elements and kernels become one global operator.

mod derive;

pub use derive::{Association, Derived, OUTPUTS, derive};
