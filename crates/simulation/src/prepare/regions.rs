//! From regions of a scene to nodes and elements of a body.
//!
//! Names are looked up among the body's own regions first, then among those of its mesh.
//! A selection's elements are those that deform: not the sides of others that only name regions.

use super::PreparedBody;
use super::error::Findings;
use souple_mesh::region::{RegionSpec, evaluate};
use souple_mesh::{BoundingBox, ElementId};
use souple_scene::body::Body;
use souple_scene::suggestion::nearest;
use souple_scene::{Location, Region, Selection};

/// Names in a message before the rest is counted.
const LISTED: usize = 20;

/// Nodes and deformable elements of a body, by their numbers in the body, sorted.
#[derive(Clone, Debug, Default)]
pub(super) struct Selected {
    pub(super) nodes: Vec<u32>,
    pub(super) elements: Vec<u32>,
}

/// What a region must hold to make sense where it is used.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Needs {
    /// At least one node.
    Nodes,
    /// At least one element that deforms.
    Elements,
    /// Either.
    Anything,
}

/// A body of the scene with its mesh.
#[derive(Clone, Copy)]
pub(super) struct Place<'s> {
    pub(super) scene: &'s Body,
    pub(super) body: &'s PreparedBody,
}

/// What a region selects; `None` after a problem was noted.
pub(super) fn select(place: Place<'_>, region: &Region, needs: Needs, findings: &mut Findings) -> Option<Selected> {
    let at = |location: &Location| {
        if *location == Location::Default { place.scene.mesh.at.clone() } else { location.clone() }
    };
    match find(place, region) {
        Err((location, message)) => {
            findings.problem(&at(&location), message);
            None
        }
        Ok(selected) if selected.lacks(needs) => {
            findings.problem(&at(&region.at), nothing(place, region, needs));
            None
        }
        Ok(selected) => Some(selected),
    }
}

impl Selected {
    pub(super) fn lacks(&self, needs: Needs) -> bool {
        match needs {
            Needs::Nodes => self.nodes.is_empty(),
            Needs::Elements => self.elements.is_empty(),
            Needs::Anything => self.nodes.is_empty() && self.elements.is_empty(),
        }
    }
}

/// What a region selects, be it nothing; an error names a part of the region that has no meaning in this body.
pub(super) fn find(place: Place<'_>, region: &Region) -> Result<Selected, (Location, String)> {
    let spec = spec(place, region, 0)?;
    let found = evaluate(&place.body.mesh, &spec).map_err(|error| (region.at.clone(), error.to_string()))?;
    let numbers = place.body.numbers();
    let number = |id: &ElementId| numbers.binary_search_by_key(id, |n| n.0).ok().map(|at| numbers[at].1);
    let mut elements: Vec<u32> = found.elements.iter().filter_map(number).collect();
    elements.sort_unstable();
    Ok(Selected { nodes: found.nodes, elements })
}

/// All elements of the mesh in a region, those that do not deform included; none when the region has no meaning.
pub(super) fn all_elements(place: Place<'_>, region: &Region) -> Vec<ElementId> {
    let found = spec(place, region, 0).ok().and_then(|spec| evaluate(&place.body.mesh, &spec).ok());
    found.map(|found| found.elements).unwrap_or_default()
}

/// The region in the words of the mesh, the body's own regions put in.
fn spec(place: Place<'_>, region: &Region, depth: usize) -> Result<RegionSpec, (Location, String)> {
    let here = |message: String| (region.at.clone(), message);
    let inner = |parts: &[Region]| parts.iter().map(|part| spec(place, part, depth)).collect::<Result<Vec<_>, _>>();
    Ok(match &region.value {
        Selection::All => RegionSpec::All,
        Selection::Name(name) => match place.scene.regions.iter().find(|own| own.name.value == *name) {
            // Every name leads to another region of the body, so a longer chain is a circle.
            Some(_) if depth > place.scene.regions.len() => {
                return Err(here(format!("region \"{name}\" is defined by itself")));
            }
            Some(own) => spec(place, &own.region, depth + 1)?,
            None if place.body.mesh.regions.contains_key(name) => RegionSpec::Named(name.clone()),
            None => return Err(here(unknown_name(place, name))),
        },
        Selection::Element(id) => {
            let present: Vec<&str> =
                place.body.mesh.blocks.iter().filter(|b| !b.is_empty()).map(|b| b.element.id).collect();
            if !present.contains(&id.as_str()) {
                let message = format!(
                    "region {} selects nothing: the mesh of body \"{}\" has no {id}, only {}",
                    described(region),
                    *place.scene.name,
                    present.join(", ")
                );
                return Err(here(message));
            }
            RegionSpec::Element(id.clone())
        }
        Selection::Box { min, max } => RegionSpec::Box { min: *min, max: *max },
        Selection::Sphere { centre, radius } => RegionSpec::Sphere { centre: *centre, radius: *radius },
        Selection::Plane { point, normal } => RegionSpec::Plane { point: *point, normal: *normal },
        Selection::NearSurface(below) => RegionSpec::DistanceToSurface { below: *below },
        Selection::And(parts) => RegionSpec::And(inner(parts)?),
        Selection::Or(parts) => RegionSpec::Or(inner(parts)?),
        Selection::Not(part) => RegionSpec::Not(Box::new(spec(place, part, depth)?)),
    })
}

fn unknown_name(place: Place<'_>, name: &str) -> String {
    let names = names(place);
    let hint = nearest(name, names.iter().copied()).map_or_else(String::new, |n| format!(" (did you mean \"{n}\"?)"));
    format!(
        "region \"{name}\" selects nothing: body \"{}\" has no region of this name{hint}; {}",
        *place.scene.name,
        surroundings(place)
    )
}

/// The message for a region that is empty where it is used.
pub(super) fn nothing(place: Place<'_>, region: &Region, needs: Needs) -> String {
    let what = match needs {
        Needs::Nodes => "no node",
        Needs::Elements => "no element that deforms",
        Needs::Anything => "neither nodes nor elements",
    };
    format!(
        "region {} selects nothing: {what} of body \"{}\" lies in it; {}",
        described(region),
        *place.scene.name,
        surroundings(place)
    )
}

/// The body's own regions, then those of its mesh.
fn names<'s>(place: Place<'s>) -> Vec<&'s str> {
    let own = place.scene.regions.iter().map(|region| region.name.as_str());
    let hidden = |name: &&str| !place.scene.regions.iter().any(|region| region.name.value == *name);
    own.chain(place.body.mesh.regions.keys().map(String::as_str).filter(hidden)).collect()
}

fn surroundings(place: Place<'_>) -> String {
    let bounds = BoundingBox::around(&place.body.mesh.nodes).map_or_else(|| "no space".to_owned(), |b| b.to_string());
    let all = names(place);
    let mut shown: Vec<String> = all.iter().take(LISTED).map(|name| format!("\"{name}\"")).collect();
    if all.len() > LISTED {
        shown.push(format!("and {} more", all.len() - LISTED));
    }
    let shown = if shown.is_empty() { "none".to_owned() } else { shown.join(", ") };
    format!("its mesh fills {bounds} and its regions are {shown}")
}

/// A region in words, short enough for a message.
pub(super) fn described(region: &Region) -> String {
    match &region.value {
        Selection::All => "\"all\"".to_owned(),
        Selection::Name(name) => format!("\"{name}\""),
        Selection::Element(id) => format!("{{ element = \"{id}\" }}"),
        Selection::Box { min, max } => format!("{{ box = {{ min = {min:?}, max = {max:?} }} }}"),
        Selection::Sphere { centre, radius } => {
            format!("{{ sphere = {{ centre = {centre:?}, radius = {radius} }} }}")
        }
        Selection::Plane { point, normal } => format!("{{ plane = {{ point = {point:?}, normal = {normal:?} }} }}"),
        Selection::NearSurface(below) => format!("{{ near_surface = {below} }}"),
        Selection::And(_) => "{ and = … }".to_owned(),
        Selection::Or(_) => "{ or = … }".to_owned(),
        Selection::Not(_) => "{ not = … }".to_owned(),
    }
}
