//! `[output]`: which results are written, and how often.

use serde::Serialize;

use crate::choice::{Named, choices};
use crate::dimension::Dimension;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

choices! {
    /// A format of results.
    pub enum Format {
        /// VTK XML files, one per written state, and a `.pvd` time series that ParaView opens.
        Vtu = "vtu",
        /// No files; probes are reported all the same.
        None = "none",
    }
}

choices! {
    /// A field of the written states; positions are always written.
    pub enum Field {
        /// Displacement of each node (m).
        Displacement = "displacement",
        /// Velocity of each node (m/s).
        Velocity = "velocity",
        /// Internal force on each node (N).
        Force = "force",
        /// Force that holds each fixed or moved node (N).
        Reaction = "reaction",
        /// Mean Cauchy stress of each element (Pa); of a small-strain law, the stress that it states. Nine numbers, row by row.
        Stress = "stress",
        /// Von Mises stress of each element's mean stress (Pa).
        VonMisesStress = "von mises stress",
        /// Mean Green–Lagrange strain of each element. Nine numbers, row by row.
        Strain = "strain",
        /// Principal stretches of each element's mean strain, the largest first. Three numbers.
        PrincipalStretches = "principal stretches",
        /// Strain energy per rest volume of each element (J/m^3).
        EnergyDensity = "energy density",
        /// Deformed over rest volume of each element (mean det F).
        VolumeRatio = "volume ratio",
        /// Index of the material of each element.
        Material = "material",
    }
}

/// Which results are written.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Output {
    /// Time between two written states (s); `None` writes the first and the last.
    pub every: Option<Spanned<f64>>,
    /// Format of the files (default vtu).
    pub format: Format,
    /// Fields, all different (default displacement, velocity).
    pub fields: Vec<Field>,
}

impl Default for Output {
    fn default() -> Self {
        Output { every: None, format: Format::Vtu, fields: vec![Field::Displacement, Field::Velocity] }
    }
}

pub(crate) static OUTPUT: Section = Section {
    header: "[output]",
    about: "which results are written, and how often",
    keys: &[
        Key {
            name: "every",
            kind: Kind::Number(Dimension::TIME, Range::POSITIVE),
            presence: Presence::Optional("only the first and the last state"),
            about: "time between two written states",
        },
        Key {
            name: "format",
            kind: Kind::Choice(Format::CHOICES),
            presence: Presence::Default("\"vtu\""),
            about: "format of the files",
        },
        Key {
            name: "fields",
            kind: Kind::Choices(Field::CHOICES),
            presence: Presence::Default("[\"displacement\", \"velocity\"]"),
            about: "fields of the written states; positions are always written",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn output(&mut self, fields: &Fields<'_>) -> Output {
        let default = Output::default();
        let list = self.choices::<Field>(fields, "fields");
        Output {
            every: self.number(fields, "every"),
            format: self.choice(fields, "format").map_or(default.format, |format| format.value),
            fields: list.map_or(default.fields, |list| list.into_iter().map(|field| field.value).collect()),
        }
    }
}
