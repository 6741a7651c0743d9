//! Blocks of elements and kernels become one global operator.

mod block;
mod derive;
mod elements;
mod threads;

pub use block::BlockSpec;
pub use derive::{Association, Derived, OUTPUTS, derive};
pub use elements::{AssemblyMap, Elements, Masses};
pub use threads::Threads;
