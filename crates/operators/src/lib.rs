//! Blocks of elements and kernels become one global operator.

mod averages;
mod block;
mod derive;
mod elements;
mod threads;

pub use averages::{Average, Mean};
pub use block::BlockSpec;
pub use derive::{Association, Derived, OUTPUTS, derive, derive_averages};
pub use elements::{AssemblyMap, Elements, Masses};
pub use threads::Threads;
