//! Blocks of elements and kernels become one global operator.

mod block;
mod derive;

pub use block::BlockSpec;
pub use derive::{Association, Derived, OUTPUTS, derive};
