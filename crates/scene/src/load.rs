//! `[[body.force]]`, `[[body.traction]]` and `[[body.pressure]]`: external loads.
//!
//! Each may have a `factor` over time that multiplies it; without one it acts in full from the start.

use serde::Serialize;

use crate::dimension::Dimension;
use crate::keyframes::Keyframe;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::region::Region;
use crate::schema::{Key, Kind, Presence, Section};

/// A force on the nodes of a region.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Force {
    /// Which nodes.
    pub region: Region,
    /// How much.
    pub amount: ForceAmount,
    /// Multiplies it over time; empty means 1 at all times.
    pub factor: Vec<Keyframe<f64>>,
}

/// How a force is shared among nodes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ForceAmount {
    /// This much (N) over the region, in equal parts.
    Total([f64; 3]),
    /// This much (N) on every node.
    PerNode([f64; 3]),
}

/// A dead load on faces: force per area of the rest shape, of constant direction.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Traction {
    /// Which faces of the surface: those whose nodes all lie in the region.
    pub region: Region,
    /// Force per rest area (Pa).
    pub traction: [f64; 3],
    /// Multiplies it over time; empty means 1 at all times.
    pub factor: Vec<Keyframe<f64>>,
}

/// A pressure that follows the deformed surface, pushing inwards where positive.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pressure {
    /// Which faces of the surface: those whose nodes all lie in the region.
    pub region: Region,
    /// Pressure (Pa).
    pub pressure: f64,
    /// Multiplies it over time; empty means 1 at all times.
    pub factor: Vec<Keyframe<f64>>,
}

const FACTOR: Key = Key {
    name: "factor",
    kind: Kind::Curve(Dimension::NUMBER),
    presence: Presence::Optional("1 at all times"),
    about: "multiplies the load over time; linear between keys, held outside",
};

const FACES: Key = Key {
    name: "region",
    kind: Kind::Region,
    presence: Presence::Required,
    about: "which faces of the surface: those whose nodes all lie in it",
};

pub(crate) static FORCE: Section = Section {
    header: "[[body.force]]",
    about: "a force on nodes; either `total` or `per_node`",
    keys: &[
        Key { name: "region", kind: Kind::Region, presence: Presence::Required, about: "which nodes" },
        Key {
            name: "total",
            kind: Kind::Vector(Dimension::FORCE, Range::ANY),
            presence: Presence::Optional("`per_node` is given"),
            about: "force on the whole region, in equal parts on its nodes",
        },
        Key {
            name: "per_node",
            kind: Kind::Vector(Dimension::FORCE, Range::ANY),
            presence: Presence::Optional("`total` is given"),
            about: "force on every node of the region",
        },
        FACTOR,
    ],
    other_keys: None,
};

pub(crate) static TRACTION: Section = Section {
    header: "[[body.traction]]",
    about: "a dead load on faces: force per area of the rest shape, of constant direction",
    keys: &[
        FACES,
        Key {
            name: "traction",
            kind: Kind::Vector(Dimension::PRESSURE, Range::ANY),
            presence: Presence::Required,
            about: "force per area of the rest shape",
        },
        FACTOR,
    ],
    other_keys: None,
};

pub(crate) static PRESSURE: Section = Section {
    header: "[[body.pressure]]",
    about: "a pressure that follows the deformed surface",
    keys: &[
        FACES,
        Key {
            name: "pressure",
            kind: Kind::Number(Dimension::PRESSURE, Range::ANY),
            presence: Presence::Required,
            about: "pushes inwards where positive",
        },
        FACTOR,
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn force(&mut self, fields: &Fields<'_>) -> Option<Spanned<Force>> {
        let region = self.region(fields, "region");
        let (total, per_node) = (self.vector(fields, "total"), self.vector(fields, "per_node"));
        let factor = self.factor(fields);
        let amount = match (fields.has("total"), fields.has("per_node")) {
            (true, false) => total.map(|force| ForceAmount::Total(force.value)),
            (false, true) => per_node.map(|force| ForceAmount::PerNode(force.value)),
            (both, _) => {
                let at = if both { fields.place("per_node") } else { fields.at.clone() };
                self.conflict(at, "[[body.force]] needs exactly one of `total` and `per_node`");
                None
            }
        };
        Some(Spanned::new(Force { region: region?, amount: amount?, factor: factor? }, fields.at.clone()))
    }

    pub(crate) fn traction(&mut self, fields: &Fields<'_>) -> Option<Spanned<Traction>> {
        let (region, traction) = (self.region(fields, "region"), self.vector(fields, "traction"));
        let factor = self.factor(fields);
        let traction = Traction { region: region?, traction: traction?.value, factor: factor? };
        Some(Spanned::new(traction, fields.at.clone()))
    }

    pub(crate) fn pressure(&mut self, fields: &Fields<'_>) -> Option<Spanned<Pressure>> {
        let (region, pressure) = (self.region(fields, "region"), self.number(fields, "pressure"));
        let factor = self.factor(fields);
        let pressure = Pressure { region: region?, pressure: pressure?.value, factor: factor? };
        Some(Spanned::new(pressure, fields.at.clone()))
    }

    fn factor(&mut self, fields: &Fields<'_>) -> Option<Vec<Keyframe<f64>>> {
        if fields.has("factor") { self.curve(fields, "factor") } else { Some(Vec::new()) }
    }
}
