//! `[[body.fix]]` and `[[body.move]]`: regions that are held or moved as prescribed.

use serde::Serialize;

use crate::choice::{Axis, Named};
use crate::dimension::Dimension;
use crate::keyframes::Keyframe;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::region::Region;
use crate::schema::{Key, Kind, Presence, Section};

/// A region held at its rest position.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fix {
    /// Which nodes.
    pub region: Region,
    /// Along which axes (default all).
    pub axes: [bool; 3],
}

/// A region moved as prescribed: x(t) = R(t) (X − through) + through + translation(t), from the rest position X.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Move {
    /// Which nodes.
    pub region: Region,
    /// Along which axes the motion is prescribed (default all); always all with a rotation.
    pub axes: [bool; 3],
    /// Displacements (m) at given times, or none.
    pub translation: Option<Vec<Keyframe<[f64; 3]>>>,
    /// Rotation, or none; at least one of the two is there.
    pub rotation: Option<Rotation>,
}

/// A rotation about a fixed axis, by the right-hand rule.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rotation {
    /// Direction of the axis, not zero, of any length.
    pub axis: [f64; 3],
    /// A point of the axis (m).
    pub through: [f64; 3],
    /// Angles (degrees) at given times; the angle, not the orientation, is interpolated, so 360 is a full turn.
    pub keys: Vec<Keyframe<f64>>,
}

pub(crate) static FIX: Section = Section {
    header: "[[body.fix]]",
    about: "nodes held at their rest position",
    keys: &[
        Key { name: "region", kind: Kind::Region, presence: Presence::Required, about: "which nodes" },
        Key { name: "axes", kind: Kind::Choices(Axis::CHOICES), presence: AXES, about: "along which axes" },
    ],
    other_keys: None,
};

const AXES: Presence = Presence::Default("[\"x\", \"y\", \"z\"]");

pub(crate) static MOVE: Section = Section {
    header: "[[body.move]]",
    about: "nodes moved as prescribed; `translation`, `rotation` or both (the rotation first)",
    keys: &[
        Key { name: "region", kind: Kind::Region, presence: Presence::Required, about: "which nodes" },
        Key {
            name: "axes",
            kind: Kind::Choices(Axis::CHOICES),
            presence: AXES,
            about: "along which axes a translation is prescribed; the others stay free",
        },
        Key {
            name: "translation",
            kind: Kind::Table(&TRANSLATION),
            presence: Presence::Optional("none"),
            about: "displacements over time",
        },
        Key {
            name: "rotation",
            kind: Kind::Table(&ROTATION),
            presence: Presence::Optional("none"),
            about: "angles about an axis over time",
        },
    ],
    other_keys: None,
};

static TRANSLATION: Section = Section {
    header: "[body.move.translation]",
    about: "displacements from the rest position",
    keys: &[Key {
        name: "keys",
        kind: Kind::VectorCurve(Dimension::LENGTH),
        presence: Presence::Required,
        about: "linear between keys, held outside",
    }],
    other_keys: None,
};

static ROTATION: Section = Section {
    header: "[body.move.rotation]",
    about: "a rotation about a fixed axis, by the right-hand rule",
    keys: &[
        Key { name: "axis", kind: Kind::Direction, presence: Presence::Required, about: "direction of the axis" },
        Key {
            name: "through",
            kind: Kind::Vector(Dimension::LENGTH, Range::ANY),
            presence: Presence::Default("[0.0, 0.0, 0.0]"),
            about: "a point of the axis",
        },
        Key {
            name: "keys",
            kind: Kind::Curve(Dimension::ANGLE),
            presence: Presence::Required,
            about: "linear between keys, held outside; 360 is a full turn",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn fix(&mut self, fields: &Fields<'_>) -> Option<Spanned<Fix>> {
        let (region, axes) = (self.region(fields, "region"), self.axes(fields, "axes"));
        self.some_axis(fields, axes);
        Some(Spanned::new(Fix { region: region?, axes: axes? }, fields.at.clone()))
    }

    pub(crate) fn motion(&mut self, fields: &Fields<'_>) -> Option<Spanned<Move>> {
        let (region, axes) = (self.region(fields, "region"), self.axes(fields, "axes"));
        self.some_axis(fields, axes);
        if !fields.has("translation") && !fields.has("rotation") {
            let message = "[[body.move]] needs `translation` or `rotation`; to hold a region use [[body.fix]]";
            self.conflict(fields.at.clone(), message);
        }
        if fields.has("rotation") && axes.is_some_and(|axes| axes != [true; 3]) {
            let message = "a rotation moves along all axes; remove `axes` or use only a `translation`";
            self.conflict(fields.place("axes"), message);
        }
        let translation = self.table(fields, "translation").map(|table| self.vector_curve(&table, "keys"));
        let rotation = self.table(fields, "rotation").map(|table| self.rotation(&table));
        let (translation, rotation) = (translation.flatten(), rotation.flatten());
        Some(Spanned::new(Move { region: region?, axes: axes?, translation, rotation }, fields.at.clone()))
    }

    fn rotation(&mut self, fields: &Fields<'_>) -> Option<Rotation> {
        let axis = self.vector(fields, "axis");
        let through = self.vector(fields, "through").map_or([0.0; 3], |through| through.value);
        let keys = self.curve(fields, "keys");
        Some(Rotation { axis: axis?.value, through, keys: keys? })
    }

    fn some_axis(&mut self, fields: &Fields<'_>, axes: Option<[bool; 3]>) {
        if axes == Some([false; 3]) {
            self.conflict(fields.place("axes"), "`axes` is empty; name at least one of \"x\", \"y\", \"z\"");
        }
    }
}
