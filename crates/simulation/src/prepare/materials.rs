//! Which material each element has, and the blocks of like elements that follow.

use super::embedded::{Form, accepts, perpendicular, report_misfit};
use super::error::Findings;
use super::loads::FaceTable;
use super::parameters::parameters;
use super::regions::{Needs, Place, described, select};
use souple_elements::{Element, Rule};
use souple_laws::{Argument, Law};
use souple_mesh::BoundingBox;
use souple_operators::BlockSpec;
use souple_scene::Spanned;
use souple_scene::material::{Material, USER_LAW};

/// A material of a body, resolved.
struct Resolved {
    law: &'static Law,
    parameters: Vec<f64>,
    viscosity: Option<[f64; 2]>,
    form: Form,
}

/// Appends the body's elements to the blocks, in the order of the mesh.
///
/// Notes elements without material, faulty parameters, and materials that apply nowhere.
pub(super) fn group(place: Place<'_>, blocks: &mut Vec<BlockSpec>, findings: &mut Findings) {
    let (scene, body) = (place.scene, place.body);
    let count = body.elements.len();
    let mut material_of: Vec<Option<usize>> = vec![None; count];
    let mut resolved: Vec<Option<Resolved>> = Vec::with_capacity(scene.materials.len());
    let mut sound = true;
    for (index, material) in scene.materials.iter().enumerate() {
        let form = Form::of(material);
        match select(place, &material.region, Needs::Anything, findings) {
            Some(selected) => {
                let fits = |e: &u32| form.fits(body.element(body.elements[*e as usize]), body.dimension);
                let taken: Vec<u32> = selected.elements.into_iter().filter(fits).collect();
                if taken.is_empty() {
                    report_misfit(place, material, &material.at, findings);
                    sound = false;
                }
                taken.iter().for_each(|&e| material_of[e as usize] = Some(index));
            }
            None => sound = false,
        }
        resolved.push(resolve(material, form, findings));
    }
    if !sound {
        // An element without material would only repeat that a region is wrong.
        return;
    }
    for (index, material) in scene.materials.iter().enumerate() {
        if !material_of.contains(&Some(index)) {
            let message = format!(
                "this material applies to no element: later materials override all of its region {}",
                described(&material.region)
            );
            findings.warning(&material.at, message);
        }
    }
    report_bare(place, &material_of, findings);
    for quadrature in &scene.quadrature {
        let used = body.mesh.blocks.iter().any(|b| b.element.id == quadrature.element && !b.is_empty());
        if !used {
            let message =
                format!("body \"{}\" has no {}; this quadrature has no effect", *scene.name, quadrature.element);
            findings.warning(&quadrature.at, message);
        }
    }
    fill(place, &material_of, &resolved, blocks, findings);
}

/// Appends the elements with a material to the blocks.
fn fill(
    place: Place<'_>,
    material_of: &[Option<usize>],
    resolved: &[Option<Resolved>],
    blocks: &mut Vec<BlockSpec>,
    findings: &mut Findings,
) {
    let (scene, body) = (place.scene, place.body);
    let density = scene.density.value;
    // The mesh's block that an element is of, with its rule and where elements of each material go.
    let mut kind: Option<(u32, &'static Rule, Vec<Option<usize>>)> = None;
    // Points and slopes of embedded elements, for laws with directions.
    let mut table: Option<(&str, FaceTable)> = None;
    for (number, (&id, material)) in (0u32..).zip(body.elements.iter().zip(material_of)) {
        let element = body.element(id);
        if kind.as_ref().is_none_or(|known| known.0 != id.block) {
            let Some(rule) = rule(place, element, findings) else { return };
            kind = Some((id.block, rule, vec![None; resolved.len()]));
        }
        let Some((_, rule, target)) = &mut kind else { unreachable!("set above") };
        let Some(material) = *material else { continue };
        let Some(Resolved { law, parameters, viscosity, form }) = &resolved[material] else { continue };
        let section = form.section();
        let nodes = body.mesh.nodes_of(id);
        if *form != Form::Solid && law.arguments().iter().any(|a| matches!(a, Argument::Direction { .. })) {
            if table.as_ref().is_none_or(|known| known.0 != element.id) {
                table = Some((element.id, FaceTable::new(element)));
            }
            let positions: Vec<[f64; 3]> = nodes.iter().map(|&n| body.mesh.nodes[n as usize]).collect();
            let (_, table) = table.as_ref().expect("made above");
            if let Some(name) = perpendicular(law, parameters, table, &positions) {
                let message = format!(
                    "`{name}` is perpendicular to {}: on membranes and cables the direction is taken along the element, and \
                     nothing is left of it there; turn it, or give these elements another material",
                    super::described(&body.mesh, &body.name, id)
                );
                findings.problem(&scene.materials[material].at, message);
                return;
            }
        }
        let at = *target[material].get_or_insert_with(|| {
            let same = |spec: &BlockSpec| {
                spec.element.id == element.id
                    && spec.law.id == law.id
                    && spec.rule.id == rule.id
                    && bits(&spec.parameters) == bits(parameters)
                    && spec.density.to_bits() == density.to_bits()
                    && spec.viscosity == *viscosity
                    && spec.section.to_bits() == section.to_bits()
            };
            blocks.iter().position(same).unwrap_or_else(|| {
                blocks.push(BlockSpec {
                    element,
                    law,
                    rule,
                    parameters: parameters.clone(),
                    density,
                    viscosity: *viscosity,
                    section,
                    connectivity: Vec::new(),
                    ids: Vec::new(),
                });
                blocks.len() - 1
            })
        });
        blocks[at].connectivity.extend(nodes.iter().map(|&n| body.first_node + n));
        blocks[at].ids.push(body.first_element + number);
    }
}

/// The law of a material with its parameters; `None` after a problem was noted.
fn resolve(material: &Material, form: Form, findings: &mut Findings) -> Option<Resolved> {
    let (law, parameters) = match (material.law.value.as_str(), &material.energy) {
        (USER_LAW, Some(energy)) => user_law(energy, material, findings)?,
        _ => {
            let law = souple_laws::by_id(&material.law);
            if law.is_none() && material.law.value != USER_LAW {
                findings.problem(
                    &material.law.at,
                    format!("there is no law `{}`; `souple list laws` shows them", *material.law),
                );
            }
            (law?, parameters(law?, material, findings)?)
        }
    };
    if form != Form::Solid && !accepts(law, &material.law.at, findings) {
        return None;
    }
    if let (Some(viscosity), false) = (&material.viscosity, form == Form::Solid) {
        let message = "viscosity is for solids: membranes and cables have none yet; remove it here, or damp the motion with \
                       `velocity_damping` or `rayleigh` in [integrator]";
        findings.problem(&viscosity.at, message);
        return None;
    }
    Some(Resolved { law, parameters, viscosity: viscosity(material), form })
}

/// The law that a material's energy describes, with the values of its parameters.
fn user_law(
    energy: &Spanned<String>,
    material: &Material,
    findings: &mut Findings,
) -> Option<(&'static Law, Vec<f64>)> {
    let given = material.parameters.iter().map(|p| (p.name.as_str(), &p.value.value));
    match super::catalogue::read(energy, given) {
        Ok(law) => {
            let parameters = law.values();
            Some((law.into_law(), parameters))
        }
        Err(fault) => {
            findings.problem(&energy.at, format!("{fault}\n{}", fault.excerpt()));
            None
        }
    }
}

/// Shear and bulk viscosity of a material, if it has any.
fn viscosity(material: &Material) -> Option<[f64; 2]> {
    material.viscosity.as_ref().map(|v| [v.shear, v.bulk]).filter(|v| *v != [0.0; 2])
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// The scene's rule for an element, or the element's own.
fn rule(place: Place<'_>, element: &'static Element, findings: &mut Findings) -> Option<&'static Rule> {
    match place.scene.quadrature.iter().find(|quadrature| quadrature.element == element.id) {
        None => Some(element.default_rule()),
        Some(given) => {
            let rule = element.rule(&given.rule);
            if rule.is_none() {
                let known = element.quadratures.join(", ");
                findings
                    .problem(&given.at, format!("{} has no quadrature `{}`; it has {known}", element.id, given.rule));
            }
            rule
        }
    }
}

/// Notes elements without material: how many, of which kinds, and where.
fn report_bare(place: Place<'_>, material_of: &[Option<usize>], findings: &mut Findings) {
    let bare: Vec<u32> = (0u32..).zip(material_of).filter(|(_, material)| material.is_none()).map(|(e, _)| e).collect();
    if bare.is_empty() {
        return;
    }
    let mesh = &place.body.mesh;
    let ids: Vec<_> = bare.iter().filter_map(|&e| place.body.id_in_body(e)).collect();
    let mut kinds: Vec<(&str, usize)> = Vec::new();
    for id in &ids {
        let kind = mesh.blocks[id.block as usize].element.id;
        match kinds.iter_mut().find(|known| known.0 == kind) {
            Some(known) => known.1 += 1,
            None => kinds.push((kind, 1)),
        }
    }
    let corners = ids.iter().flat_map(|&id| mesh.nodes_of(id)).map(|&n| &mesh.nodes[n as usize]);
    let bounds = BoundingBox::around(corners).map_or_else(String::new, |b| b.to_string());
    let kinds: Vec<String> = kinds.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
    let message = format!(
        "{} of {} elements of body \"{}\" have no material ({}, within {bounds}); add a [[body.material]] whose region \
         holds them, for example `region = \"all\"` before the others",
        bare.len(),
        material_of.len(),
        *place.scene.name,
        kinds.join(", ")
    );
    findings.problem(&place.scene.name.at, message);
}
