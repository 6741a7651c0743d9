//! Whether a body's mesh is made to conform where its elements do not meet node by node.

use crate::choice::choices;

choices! {
    /// What happens to nodes in the middle of a side of another element.
    pub enum Conforming {
        /// they follow that side's nodes by its interpolation: `u_m = Σ N_a(ξ_m) u_a`
        Auto = "auto",
        /// they move freely, as along a crack or where two parts of one mesh merely touch
        Off = "off",
    }
}
