//! Faces of surface formats: three or four corners are an element, more are cut into triangles from the first corner.

use super::draft::Draft;
use super::kinds::{Kind, linear};
use crate::ElementId;
use souple_elements::Family;

/// The elements of one face.
pub(super) fn add(draft: &mut Draft, corners: &[u32]) -> Vec<ElementId> {
    let kind = |family: Family| Kind {
        element: linear(family),
        listed: family.corner_count(),
        order: None,
        reduced_from: None,
    };
    match corners {
        [] | [_] | [_, _] => {
            draft.report.skip("faces", 1, "fewer than three corners");
            Vec::new()
        }
        [_, _, _] => vec![draft.element(&kind(Family::Triangle), corners)],
        [_, _, _, _] => vec![draft.element(&kind(Family::Quadrangle), corners)],
        [first, rest @ ..] => {
            *draft.report.split.entry("polygons into triangles".to_owned()).or_default() += 1;
            let kind = kind(Family::Triangle);
            rest.windows(2).map(|pair| draft.element(&kind, &[*first, pair[0], pair[1]])).collect()
        }
    }
}
