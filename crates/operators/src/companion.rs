//! Programs that a block has beside its elastic ones, with the values that they carry: viscosity, and tangents with
//! positive moduli.

use crate::derive::{Derived, derive_moduli, derive_viscosity};
use souple_kernels::{Aligned, Backend, CompileError, Kernel};
use souple_program::{Costs, LINEARISE, SETUP, Staged};
use std::sync::Arc;

/// Values that programs of one family carry: each pair known once per element, and per point.
#[derive(Default)]
pub(crate) struct Carried {
    /// From the set-up.
    pub(crate) setup: [Aligned; 2],
    /// From the linearisation.
    pub(crate) step: [Aligned; 2],
}

impl Carried {
    /// Room for what a family carries, for this many lanes in all.
    pub(crate) fn sized(staged: &Staged, points: usize, lanes: usize) -> Carried {
        let sized =
            |(once, each): (usize, usize)| [Aligned::zeros(once * lanes), Aligned::zeros(each * points * lanes)];
        Carried { setup: sized(staged.setup_to_step), step: sized(staged.step_to_apply) }
    }
}

/// Which programs of a block run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Family {
    /// Those of the law.
    Elastic,
    /// Those of Kelvin–Voigt viscosity.
    Viscous,
    /// Those with moduli made positive.
    Projected,
}

/// A family of programs that gives a product and blocks.
pub(crate) struct Companion {
    /// What its programs carry.
    pub(crate) carried: Carried,
    /// Prepares set-up values, if there are any.
    pub(crate) setup: Option<Arc<dyn Kernel>>,
    /// Prepares step values, if there are any.
    pub(crate) linearise: Option<Arc<dyn Kernel>>,
    /// The law's own moduli; of the projected family only.
    pub(crate) moduli: Option<Arc<dyn Kernel>>,
    /// The product.
    pub(crate) apply: Arc<dyn Kernel>,
    /// The blocks.
    pub(crate) blocks: Arc<dyn Kernel>,
    /// Moduli made positive, [group][point][entry][lane].
    pub(crate) given: Aligned,
}

impl Companion {
    /// Viscosity of an association.
    ///
    /// # Errors
    /// When the backend refuses a program.
    pub(crate) fn viscous(
        derived: &Derived,
        backend: &dyn Backend,
        costs: Costs,
        lanes: usize,
    ) -> Result<Companion, CompileError> {
        Companion::new(&derive_viscosity(derived, costs), backend, ["damping_apply", "damping_blocks"], lanes)
    }

    /// The tangent of an association with given moduli.
    ///
    /// # Errors
    /// When the backend refuses a program.
    pub(crate) fn projected(
        derived: &Derived,
        backend: &dyn Backend,
        costs: Costs,
        lanes: usize,
    ) -> Result<Companion, CompileError> {
        Companion::new(&derive_moduli(derived, costs), backend, ["moduli_apply", "moduli_blocks"], lanes)
    }

    fn new(
        staged: &Staged,
        backend: &dyn Backend,
        [apply, blocks]: [&str; 2],
        lanes: usize,
    ) -> Result<Companion, CompileError> {
        let compile = |name: &str| backend.compile(staged.program(name).expect("the family has this program"));
        let wanted = |name: &str, any: bool| if any { compile(name).map(Some) } else { Ok(None) };
        let apply = compile(apply)?;
        let points = apply.program().points;
        Ok(Companion {
            carried: Carried::sized(staged, points, lanes),
            setup: wanted(SETUP, staged.setup_to_step != (0, 0))?,
            linearise: wanted(LINEARISE, staged.step_to_apply != (0, 0))?,
            moduli: wanted("moduli", staged.program("moduli").is_some())?,
            blocks: compile(blocks)?,
            apply,
            given: Aligned::default(),
        })
    }
}
