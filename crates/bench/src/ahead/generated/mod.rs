//! Printed programs. Printed by a test, never edited (see the module above).

mod tet4_stvk_force;
mod tet4_stvk_linearise;
mod tet4_stvk_tangent_apply;
mod hex8_stvk_force;
mod hex8_stvk_linearise;
mod hex8_stvk_tangent_apply;

use super::Ahead;

/// Every printed program.
pub(super) const AHEAD: &[Ahead] = &[
    Ahead { element: "tet4", law: "stvk", program: "force", run: tet4_stvk_force::run },
    Ahead { element: "tet4", law: "stvk", program: "linearise", run: tet4_stvk_linearise::run },
    Ahead { element: "tet4", law: "stvk", program: "tangent_apply", run: tet4_stvk_tangent_apply::run },
    Ahead { element: "hex8", law: "stvk", program: "force", run: hex8_stvk_force::run },
    Ahead { element: "hex8", law: "stvk", program: "linearise", run: hex8_stvk_linearise::run },
    Ahead { element: "hex8", law: "stvk", program: "tangent_apply", run: hex8_stvk_tangent_apply::run },
];
