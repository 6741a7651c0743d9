//! Blocks of elements and kernels become one global operator.

mod assembly;
mod averages;
mod block;
mod companion;
mod derive;
mod diagonal;
mod elements;
mod parts;
mod projection;
mod tangent;
mod threads;

pub use assembly::AssemblyMap;
pub use averages::{Average, Mean};
pub use block::BlockSpec;
pub use derive::{Association, Derived, OUTPUTS, derive, derive_averages, derive_moduli, derive_viscosity};
pub use diagonal::derive_diagonal;
pub use elements::{Elements, Masses};
pub use parts::Part;
pub use tangent::Tangent;
pub use threads::Threads;
