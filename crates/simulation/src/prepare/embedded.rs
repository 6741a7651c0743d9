//! Membranes and cables: elements of fewer dimensions than space that deform.
//!
//! A material with a `thickness` makes the faces of its region membranes, one with a `section` makes the edges cables.
//! What no such material claims stays what it was: a solid, or a side of solids that only names a region.

use super::PreparedBody;
use super::error::Findings;
use super::loads::FaceTable;
use super::regions::{Place, all_elements, described};
use souple_elements::Element;
use souple_laws::{Argument, Law};
use souple_mesh::{ElementId, Mesh};
use souple_scene::Location;
use souple_scene::body::Body;
use souple_scene::material::Material;

/// What a material makes of the elements of its region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    /// Elements that fill their space.
    Solid,
    /// Faces in space, with their thickness in m.
    Membrane(f64),
    /// Edges in a plane or in space, with their cross-section in m².
    Cable(f64),
}

impl Form {
    /// What the material's keys say.
    pub(super) fn of(material: &Material) -> Form {
        match (&material.thickness, &material.section) {
            (Some(thickness), _) => Form::Membrane(thickness.value),
            (None, Some(section)) => Form::Cable(section.value),
            (None, None) => Form::Solid,
        }
    }

    /// Dimension of the elements that take this form in a space of `space` dimensions.
    fn dimension(self, space: usize) -> usize {
        match self {
            Form::Solid => space,
            Form::Membrane(_) => 2,
            Form::Cable(_) => 1,
        }
    }

    /// Whether an element takes this form.
    pub(super) fn fits(self, element: &Element, space: usize) -> bool {
        element.dimension() == self.dimension(space) && (self == Form::Solid) == (element.dimension() == space)
    }

    /// What the energy density is multiplied by besides the measure of the element.
    pub(super) fn section(self) -> f64 {
        match self {
            Form::Solid => 1.0,
            Form::Membrane(thickness) => thickness,
            Form::Cable(section) => section,
        }
    }
}

/// Number of dimensions of the space that a body lives in: 3 for membranes, and for cables alone.
pub(super) fn space(body: &Body, mesh: &Mesh) -> usize {
    let has = |wanted: fn(&Material) -> bool| body.materials.iter().any(|material| wanted(&material.value));
    match mesh.dimension() {
        2 if has(|material| material.thickness.is_some()) => 3,
        1 if has(|material| material.thickness.is_some() || material.section.is_some()) => 3,
        highest => highest,
    }
}

/// The elements below the mesh's highest dimension that a material makes membranes or cables, sorted.
///
/// Regions without meaning select nothing here; they are reported where materials are assigned.
pub(super) fn claimed(scene: &Body, body: &PreparedBody) -> Vec<ElementId> {
    let highest = body.mesh.dimension();
    let mut claimed = Vec::new();
    for material in &scene.materials {
        let dimension = match Form::of(material) {
            Form::Solid => continue,
            form => form.dimension(body.dimension),
        };
        let found = all_elements(Place { scene, body }, &material.region).into_iter();
        claimed.extend(found.filter(|&id| dimension < highest && body.element(id).dimension() == dimension));
    }
    claimed.sort_unstable();
    claimed.dedup();
    claimed
}

/// Notes that a material's region holds nothing that takes its form.
pub(super) fn report_misfit(place: Place<'_>, material: &Material, at: &Location, findings: &mut Findings) {
    let found = all_elements(place, &material.region);
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for id in found {
        let kind = place.body.element(id).id;
        match kinds.iter_mut().find(|known| known.0 == kind) {
            Some(known) => known.1 += 1,
            None => kinds.push((kind, 1)),
        }
    }
    let held: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let held = if held.is_empty() { "no element".to_owned() } else { held.join(", ") };
    let region = described(&material.region);
    let space = place.body.dimension;
    let (message, at) = match (&material.thickness, &material.section) {
        (Some(thickness), _) => (
            format!(
                "only faces in space (triangles, quadrangles) have a `thickness`; region {region} holds {held}: choose \
                 another region, or remove `thickness`"
            ),
            &thickness.at,
        ),
        (None, Some(section)) => (
            format!(
                "only edges in a plane or in space have a `section`; region {region} holds {held}: choose another region, \
                 or remove `section`"
            ),
            &section.at,
        ),
        (None, None) => (
            format!(
                "this material is for elements of dimension {space}, and region {region} holds {held}; faces in space need \
                 a `thickness` (\"1 mm\"), edges a `section` (\"2 mm^2\"), to become membranes and cables"
            ),
            at,
        ),
    };
    findings.problem(at, message);
}

/// Whether a law can be used on membranes and cables; if not, that is noted.
pub(super) fn accepts(law: &Law, at: &Location, findings: &mut Findings) -> bool {
    let accepted = law.embeddable();
    if !accepted {
        let message = format!(
            "law `{}` is written in F, which membranes and cables do not have; write its energy in C, E, J or invariants",
            law.id
        );
        findings.problem(at, message);
    }
    accepted
}

/// Part of a direction's length that must be left along the tangents.
const LEAST_PART: f64 = 1e-6;

/// The first direction of a law that is perpendicular to an element somewhere: nothing of it would be left.
pub(super) fn perpendicular<'l>(
    law: &'l Law,
    parameters: &[f64],
    table: &FaceTable,
    positions: &[[f64; 3]],
) -> Option<&'l str> {
    let mut at = 0;
    for argument in law.arguments() {
        let Argument::Direction { name, .. } = argument else {
            at += 1;
            continue;
        };
        let direction = [parameters[at], parameters[at + 1], parameters[at + 2]];
        at += 3;
        let across = |tangents: &Vec<[f64; 3]>| {
            let dot = |a: &[f64; 3], b: &[f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let mut left = 0.0;
            let mut basis: Vec<[f64; 3]> = Vec::new();
            for tangent in tangents {
                let mut t = *tangent;
                for known in &basis {
                    let part = dot(&t, known);
                    (0..3).for_each(|k| t[k] -= part * known[k]);
                }
                let length = dot(&t, &t).sqrt();
                let t = t.map(|x| x / length);
                left += dot(&t, &direction).powi(2);
                basis.push(t);
            }
            left.sqrt() < LEAST_PART * dot(&direction, &direction).sqrt()
        };
        if table.tangents(positions).iter().any(across) {
            return Some(name);
        }
    }
    None
}
