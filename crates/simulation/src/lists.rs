//! What can be chosen, for people and machines: elements, laws, integrators and devices, read from their registries,
//! and the search by name that answers a slip of the keys with the nearest name.
//!
//! There is no list kept here: a new element or law appears by itself.

use serde::Serialize;
use souple_elements::{Element, Rule};
use souple_kernels::{Backend as _, Interpreter};
use souple_kernels_cpu::{Cpu, InstructionSet};
use souple_laws::{Bound, Law};
use souple_scene::Named as _;
use souple_scene::integrator::Method;
use souple_scene::suggestion::nearest;

/// A name that is none of those that exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} `{found}`{}; known: {}", hint(.nearest.as_deref()), .known.join(", "))]
pub struct UnknownName {
    /// What it should name: "element".
    pub what: String,
    /// The name.
    pub found: String,
    /// The most similar name.
    pub nearest: Option<String>,
    /// All names.
    pub known: Vec<String>,
}

fn hint(nearest: Option<&str>) -> String {
    nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

fn unknown<'n>(what: &str, found: &str, known: impl Iterator<Item = &'n str> + Clone) -> UnknownName {
    UnknownName {
        what: what.to_owned(),
        found: found.to_owned(),
        nearest: nearest(found, known.clone()).map(str::to_owned),
        known: known.map(str::to_owned).collect(),
    }
}

/// The element with this id.
///
/// # Errors
/// The nearest id, and all of them.
pub fn find_element(id: &str) -> Result<&'static Element, UnknownName> {
    let ids = souple_elements::all().iter().map(|e| e.id);
    souple_elements::by_id(id).ok_or_else(|| unknown("element", id, ids))
}

/// The law with this id.
///
/// # Errors
/// The nearest id, and all of them.
pub fn find_law(id: &str) -> Result<&'static Law, UnknownName> {
    souple_laws::by_id(id).ok_or_else(|| unknown("law", id, souple_laws::all().iter().map(|l| l.id)))
}

/// A quadrature of an element, by id or number of points; its default without a name.
///
/// # Errors
/// The nearest id, and all of the element's.
pub fn find_rule(element: &Element, name: Option<&str>) -> Result<&'static Rule, UnknownName> {
    let Some(name) = name else { return Ok(element.default_rule()) };
    let what = format!("quadrature of {}", element.id);
    element.rule(name).ok_or_else(|| unknown(&what, name, element.quadratures.iter().copied()))
}

/// An element or a law that cannot be put into a space of more dimensions.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotEmbedded {
    /// The element fills such a space, or does not fit into it.
    #[error("{element} has dimension {dimension} and cannot be embedded in {space}: {expected}")]
    Space {
        /// Its id.
        element: &'static str,
        /// Its dimension.
        dimension: usize,
        /// The dimension that was asked for.
        space: usize,
        /// What would do.
        expected: String,
    },
    /// The law asks for F.
    #[error("law `{law}` is written in F, which membranes and cables do not have")]
    Law {
        /// Its id.
        law: &'static str,
    },
}

/// The number of space dimensions when an element with a law is to be a cable or a membrane in it.
///
/// # Errors
/// When it fills the space or does not fit into it, or the law cannot be embedded.
pub fn embedding(element: &Element, law: &Law, space: usize) -> Result<usize, NotEmbedded> {
    let dimension = element.dimension();
    if space <= dimension || space > 3 {
        let expected = match dimension {
            1 => "edges fit into 2 or 3".to_owned(),
            2 => "faces fit into 3".to_owned(),
            _ => "solids fill space".to_owned(),
        };
        return Err(NotEmbedded::Space { element: element.id, dimension, space, expected });
    }
    if !law.embeddable() {
        return Err(NotEmbedded::Law { law: law.id });
    }
    Ok(space)
}

/// A name among others of one kind, for choices that belong to no registry.
///
/// # Errors
/// The nearest name, and all of them.
pub fn find_name<'n>(what: &str, name: &str, known: &[&'n str]) -> Result<&'n str, UnknownName> {
    known.iter().copied().find(|k| *k == name).ok_or_else(|| unknown(what, name, known.iter().copied()))
}

/// One element.
#[derive(Clone, Debug, Serialize)]
pub struct ElementEntry {
    /// Id in scenes and commands.
    pub id: &'static str,
    /// Shape of the reference cell.
    pub family: &'static str,
    /// Number of space dimensions.
    pub dimension: usize,
    /// Dimensions of the spaces that it can be embedded in, as a cable or a membrane.
    pub embedded: Vec<usize>,
    /// Number of nodes.
    pub nodes: usize,
    /// Degree of the polynomials that it interpolates exactly.
    pub degree: u32,
    /// Its quadratures, the default first.
    pub quadratures: Vec<QuadratureEntry>,
    /// What it is called in mesh formats.
    pub exchange: ExchangeEntry,
}

/// One quadrature of an element.
#[derive(Clone, Debug, Serialize)]
pub struct QuadratureEntry {
    /// Id in scenes and commands; the number of points does as well.
    pub id: &'static str,
    /// Number of points.
    pub points: usize,
    /// Total degree of the polynomials that it integrates exactly.
    pub degree: u32,
    /// Whether it is used when a scene names none.
    pub default: bool,
}

/// An element's names in mesh formats.
#[derive(Clone, Debug, Serialize)]
pub struct ExchangeEntry {
    /// VTK cell type.
    pub vtk: u8,
    /// Gmsh element type.
    pub gmsh: u32,
    /// Abaqus and CalculiX names.
    pub abaqus: &'static [&'static str],
    /// MEDIT keyword.
    pub medit: Option<&'static str>,
}

/// Every element, by dimension, family and number of nodes.
pub fn elements() -> Vec<ElementEntry> {
    souple_elements::all().iter().map(|e| element_entry(e)).collect()
}

fn element_entry(e: &Element) -> ElementEntry {
    let rules = e.quadratures.iter().filter_map(|id| Rule::by_id(id)).enumerate();
    ElementEntry {
        id: e.id,
        family: e.family.name(),
        dimension: e.dimension(),
        embedded: (e.dimension() + 1..=3).collect(),
        nodes: e.node_count(),
        degree: e.degree,
        quadratures: rules
            .map(|(k, r)| QuadratureEntry { id: r.id, points: r.points.len(), degree: r.degree, default: k == 0 })
            .collect(),
        exchange: ExchangeEntry {
            vtk: e.exchange.vtk,
            gmsh: e.exchange.gmsh,
            abaqus: e.exchange.abaqus,
            medit: e.exchange.medit,
        },
    }
}

/// One law.
#[derive(Clone, Debug, Serialize)]
pub struct LawEntry {
    /// Id in scenes and commands.
    pub id: &'static str,
    /// Name in full.
    pub name: &'static str,
    /// What it is good for.
    pub about: &'static str,
    /// Energy density as people write it.
    pub formula: &'static str,
    /// Where it comes from.
    pub references: &'static [&'static str],
    /// Whether a rotation of the body leaves its energy unchanged.
    pub objective: bool,
    /// Its parameters.
    pub parameters: Vec<ParameterEntry>,
}

/// One parameter of a law.
#[derive(Clone, Debug, Serialize)]
pub struct ParameterEntry {
    /// Key in scenes.
    pub name: &'static str,
    /// SI unit; "1" for a pure number.
    pub unit: &'static str,
    /// Range as an interval: `(0, ∞)`, `(-1, 0.5)`, `[0, 1]`, `(-∞, ∞) but 0`.
    pub range: String,
    /// Value of a scene that does not give it.
    pub default: Option<f64>,
    /// What it means.
    pub about: &'static str,
}

/// Every law, by id.
pub fn laws() -> Vec<LawEntry> {
    let parameters = |law: &Law| -> Vec<ParameterEntry> {
        law.parameters
            .iter()
            .map(|p| ParameterEntry {
                name: p.name,
                unit: p.unit,
                range: interval(p.minimum, p.maximum),
                default: p.default,
                about: p.about,
            })
            .collect()
    };
    souple_laws::all()
        .iter()
        .map(|law| LawEntry {
            id: law.id,
            name: law.name,
            about: law.about,
            formula: law.formula,
            references: law.references,
            objective: law.objective,
            parameters: parameters(law),
        })
        .collect()
}

fn interval(minimum: Bound, maximum: Bound) -> String {
    let low = match minimum {
        Bound::None | Bound::NonZero => "(-∞".to_owned(),
        Bound::Open(limit) => format!("({limit}"),
        Bound::Closed(limit) => format!("[{limit}"),
    };
    let high = match maximum {
        Bound::None | Bound::NonZero => "∞)".to_owned(),
        Bound::Open(limit) => format!("{limit})"),
        Bound::Closed(limit) => format!("{limit}]"),
    };
    let zero = if [minimum, maximum].contains(&Bound::NonZero) { " but 0" } else { "" };
    format!("{low}, {high}{zero}")
}

/// One way to advance in time.
#[derive(Clone, Debug, Serialize)]
pub struct IntegratorEntry {
    /// Name in scenes.
    pub id: &'static str,
    /// Order of convergence; none for a sequence of equilibria.
    pub order: Option<usize>,
    /// Whether a step needs no solution of a system.
    pub explicit: bool,
    /// Which steps are stable.
    pub stability: &'static str,
    /// What it is.
    pub about: &'static str,
}

/// Every integrator, in the order of the scenes' documentation.
pub fn integrators() -> Vec<IntegratorEntry> {
    let entry = |(&method, choice): (&Method, &souple_scene::choice::Choice)| IntegratorEntry {
        id: method.name(),
        order: method.name().parse::<souple_solver::Method>().ok().map(|m| m.order()),
        explicit: method.is_explicit(),
        stability: stability(method),
        about: choice.about.trim(),
    };
    Method::ALL.iter().zip(Method::CHOICES).map(entry).collect()
}

/// For M ü + K u = 0 with largest frequency ω: which steps h leave the motion bounded.
fn stability(method: Method) -> &'static str {
    match method {
        Method::ExplicitEuler => "unstable at any step without damping",
        Method::SymplecticEuler => "stable up to h = 2/ω",
        Method::Rk2 => "unstable without damping, slowly: the energy grows by (hω)⁴/4 per step",
        Method::Rk4 => "stable up to h = 2√2/ω",
        Method::ImplicitEuler => "stable at any step, damps strongly",
        Method::ImplicitMidpoint => "stable at any step, does not damp",
        Method::Bdf2 => "stable at any step, damps little",
        Method::Newmark => "stable at any step when 2β ≥ γ ≥ 1/2, as with the defaults, which do not damp",
        Method::QuasiStatic => "no inertia: every state is an equilibrium",
    }
}

/// One device.
#[derive(Clone, Debug, Serialize)]
pub struct DeviceEntry {
    /// The name by which a command opens it.
    pub id: String,
    /// What it runs on.
    pub about: String,
    /// Whether this machine has it.
    pub available: bool,
    /// Whether it is used when a command names none.
    pub default: bool,
}

/// Every device that this build knows, whether this machine has it or not.
pub fn devices() -> Vec<DeviceEntry> {
    let cpu = Cpu::open();
    let mut entries = vec![DeviceEntry {
        id: cpu.about().name.clone(),
        about: format!("{}: the widest of this processor", cpu.about().description),
        available: true,
        default: true,
    }];
    for set in InstructionSet::ALL {
        let opened = Cpu::with(set);
        let lacking = || format!("{}: this processor lacks it", set.description());
        entries.push(DeviceEntry {
            id: format!("cpu:{}", set.name()),
            about: opened.as_ref().map_or_else(lacking, |c| c.about().description.clone()),
            available: opened.is_some(),
            default: false,
        });
    }
    let interpreter = Interpreter::default();
    let about = interpreter.about();
    entries.push(DeviceEntry {
        id: about.name.clone(),
        about: about.description.clone(),
        available: true,
        default: false,
    });
    entries.extend(graphics_devices());
    entries
}

/// Graphics devices: the first one by the short name, then each by its number.
fn graphics_devices() -> Vec<DeviceEntry> {
    let entry =
        |id: &str, about: String, available| DeviceEntry { id: id.to_owned(), about, available, default: false };
    let Some(adapters) = crate::gpu::adapters() else {
        return vec![entry("gpu", "this build has no graphics devices (feature `gpu`)".to_owned(), false)];
    };
    let Some(first) = adapters.first() else {
        return vec![entry("gpu", "no graphics adapter answered; see: souple doctor".to_owned(), false)];
    };
    let mut entries = vec![entry("gpu", format!("{}: the first of the adapters", first.name), first.refused.is_none())];
    entries.extend(adapters.iter().map(|a| {
        let what = match &a.refused {
            Some(why) => why.clone(),
            None => format!(
                "steps in single precision, buffers of {} MiB{}",
                a.max_buffer_bytes >> 20,
                if a.timestamps { "" } else { ", no time stamps" }
            ),
        };
        let about = format!("{} through {} ({}), {}: {what}", a.name, a.interface, a.driver, a.kind);
        entry(&a.id, about, a.refused.is_none())
    }));
    entries
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every entry of every list is found by the id that it shows.
    #[test]
    fn what_is_listed_is_found() {
        for e in elements() {
            let element = find_element(e.id).unwrap();
            assert!(e.quadratures.iter().filter(|q| q.default).count() == 1, "{}", e.id);
            for q in &e.quadratures {
                assert_eq!(find_rule(element, Some(q.id)).unwrap().points.len(), q.points);
            }
        }
        for l in laws() {
            assert_eq!(find_law(l.id).unwrap().parameters.len(), l.parameters.len());
        }
    }

    /// A misspelt name is answered with the nearest one and with all of them.
    #[test]
    fn slips_are_answered() {
        let error = find_element("hexa8").expect_err("no such element");
        assert_eq!(error.nearest.as_deref(), Some("hex8"));
        assert_eq!(error.known.len(), souple_elements::all().len());
        assert!(error.to_string().contains("did you mean `hex8`?"), "{error}");
        assert_eq!(find_law("stvkk").expect_err("no such law").nearest.as_deref(), Some("stvk"));
        let hex8 = find_element("hex8").unwrap();
        let error = find_rule(hex8, Some("hexahedron-9")).expect_err("no such rule");
        assert!(error.to_string().contains("hexahedron-8"), "{error}");
    }

    /// Every integrator of the scenes has an order, except the sequence of equilibria, and says which steps are stable.
    #[test]
    fn integrators_are_described() {
        for i in integrators() {
            assert_eq!(i.order.is_none(), i.id == "quasi-static", "{}", i.id);
            assert!(!i.stability.is_empty() && !i.about.is_empty(), "{}", i.id);
        }
    }

    /// Exactly one device is the default, and it can be used here.
    #[test]
    fn one_device_is_the_default() {
        let defaults: Vec<_> = devices().into_iter().filter(|d| d.default).collect();
        assert!(matches!(&defaults[..], [d] if d.available), "{defaults:?}");
    }

    /// Ranges read as intervals.
    #[test]
    fn ranges_are_intervals() {
        assert_eq!(interval(Bound::Open(-1.0), Bound::Open(0.5)), "(-1, 0.5)");
        assert_eq!(interval(Bound::Closed(0.0), Bound::None), "[0, ∞)");
    }
}
