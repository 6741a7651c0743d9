//! From a definition to programs.

use souple_elements::{Element, Rule};
use souple_forms::{Averages, Definition, Dissipation, Loops, Moduli, averages, define, dissipation, moduli};
use souple_laws::Law;
use souple_program::{BufferRequest, Costs, LINEARISE, OutputRequest, SETUP, Staged, stage};
use souple_symbols::Time;

/// An element with a law and a quadrature.
#[derive(Clone, Copy, Debug)]
pub struct Association {
    /// The element.
    pub element: &'static Element,
    /// The law.
    pub law: &'static Law,
    /// The quadrature.
    pub rule: &'static Rule,
    /// Loops over points, or not.
    pub loops: Loops,
    /// Number of space dimensions; more than the element's make it a cable or a membrane.
    pub dimension: usize,
}

impl Association {
    /// An element that fills its space, with its default quadrature.
    pub fn new(element: &'static Element, law: &'static Law) -> Association {
        let (rule, dimension) = (element.default_rule(), element.dimension());
        Association { element, law, rule, loops: Loops::Rolled, dimension }
    }
}

/// What can be derived: name of the output and of the program that gives it.
///
/// Programs read the buffers `rest`, `parameters`, `density`, `section` (set-up), `displacement` (step), `direction`
/// (application) and the carried values of earlier programs; all arrays are as in [`Definition`].
pub const OUTPUTS: [&str; 8] =
    ["energy", "force", "tangent_apply", "tangent_blocks", "volume_ratio", "volume", "shape_mass", "lumped_mass"];

/// Programs of an association, with the definition that they come from.
#[derive(Clone, Debug)]
pub struct Derived {
    /// What was derived.
    pub association: Association,
    /// The expressions.
    pub definition: Definition,
    /// The programs: `setup` (carried values, `shape_mass`, `lumped_mass`), `energy`, `force`, `linearise` (forces and
    /// the values carried to applications), `tangent_apply`, `tangent_apply_uncached`, `tangent_blocks`,
    /// `volume_ratio` and `volume`.
    pub staged: Staged,
}

/// Derives all programs of an association.
pub fn derive(association: Association, costs: Costs) -> Derived {
    let Association { element, law, rule, loops, dimension } = association;
    let d = define(element, law, rule, loops, dimension);
    let inputs = leaves(&d);
    let output = |program: &str, time, name: &str, values: &[_], cached| OutputRequest {
        program: program.into(),
        time,
        name: name.into(),
        values: values.to_vec(),
        cached,
    };
    let outputs = [
        output(SETUP, Time::Setup, "shape_mass", &d.shape_mass, true),
        output(SETUP, Time::Setup, "lumped_mass", &d.lumped_mass, true),
        output("energy", Time::Step, "energy", &[d.energy], true),
        output("force", Time::Step, "force", &d.force, true),
        output(LINEARISE, Time::Step, "force", &d.force, true),
        output("tangent_apply", Time::Apply, "tangent_apply", &d.tangent_apply, true),
        output("tangent_apply_uncached", Time::Apply, "tangent_apply", &d.tangent_apply, false),
        output("volume_ratio", Time::Step, "volume_ratio", &d.volume_ratio, false),
        output("volume", Time::Step, "volume", &[d.deformed_volume], false),
        output("tangent_blocks", Time::Step, "tangent_blocks", &d.tangent_blocks, false),
    ];
    let staged = stage(&d.graph, &inputs, &outputs, costs);
    Derived { association, definition: d, staged }
}

/// Derives what an element shows of its stress and strain ([`Averages`]): the programs `stress` and `strain`, each with
/// one output of that name, a symmetric tensor and the volume that it is the mean of.
///
/// They are no part of [`Derived::staged`]: few simulations want them, and they carry nothing from the set-up, so that
/// they change neither what is stored nor what is computed for forces.
pub fn derive_averages(derived: &Derived, costs: Costs) -> Staged {
    let Averages { graph, stress, strain } = averages(&derived.definition, derived.association.law);
    let outputs = [("stress", stress), ("strain", strain)].map(|(name, values)| OutputRequest {
        program: name.into(),
        time: Time::Step,
        name: name.into(),
        values,
        cached: false,
    });
    stage(&graph, &leaves(&derived.definition), &outputs, costs)
}

/// Derives Kelvin–Voigt viscosity ([`Dissipation`]): the programs `damping_apply` (C v) and `damping_blocks`, with the
/// `setup` and `linearise` that carry values to them. They read the buffer `viscosity` (η, ζ) besides.
///
/// A family of its own: the programs of purely elastic materials stay what they are.
pub fn derive_viscosity(derived: &Derived, costs: Costs) -> Staged {
    let Dissipation { graph, viscosity, product, blocks } = dissipation(&derived.definition);
    let mut inputs = leaves(&derived.definition).to_vec();
    inputs.push(BufferRequest { name: "viscosity".into(), leaves: viscosity.to_vec() });
    let outputs = [("damping_apply", Time::Apply, product, true), ("damping_blocks", Time::Step, blocks, false)].map(
        |(name, time, values, cached)| OutputRequest { program: name.into(), time, name: name.into(), values, cached },
    );
    stage(&graph, &inputs, &outputs, costs)
}

/// Derives tangents with given moduli ([`Moduli`]): the programs `moduli` (the law's own, per point), `moduli_apply` and
/// `moduli_blocks`, which read the buffer `moduli` (per point) and what `setup` carries.
///
/// # Panics
/// When the loops of the association are written out.
pub fn derive_moduli(derived: &Derived, costs: Costs) -> Staged {
    let Moduli { graph, given, own, tangent_apply, tangent_blocks } = moduli(&derived.definition);
    let mut inputs = leaves(&derived.definition).to_vec();
    inputs.push(BufferRequest { name: "moduli".into(), leaves: given });
    let outputs = [
        ("moduli", Time::Step, own, false),
        ("moduli_apply", Time::Apply, tangent_apply, true),
        ("moduli_blocks", Time::Apply, tangent_blocks, true),
    ]
    .map(|(name, time, values, cached)| OutputRequest {
        program: name.into(),
        time,
        name: name.into(),
        values,
        cached,
    });
    stage(&graph, &inputs, &outputs, costs)
}

/// The buffers that programs read leaves from.
pub(crate) fn leaves(d: &Definition) -> [BufferRequest; 6] {
    [
        ("rest", d.rest.clone()),
        ("parameters", d.parameters.clone()),
        ("density", vec![d.density]),
        ("section", vec![d.section]),
        ("displacement", d.displacement.clone()),
        ("direction", d.direction.clone()),
    ]
    .map(|(name, leaves)| BufferRequest { name: name.into(), leaves })
}
