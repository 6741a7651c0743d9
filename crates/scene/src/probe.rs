//! `[[probe]]`: what is measured during the run and reported at its end.

use serde::Serialize;

use crate::choice::{Axis, Named, choices};
use crate::dimension::Dimension;
use crate::location::Spanned;
use crate::reader::{Fields, Reader};
use crate::region::{Region, Selection};
use crate::schema::{Key, Kind, Presence, Section};

choices! {
    /// A quantity that a probe measures on its region.
    pub enum Quantity {
        /// Mean of the nodes' displacements (m); a vector.
        MeanDisplacement = "mean displacement",
        /// The longest displacement of a node (m); a number.
        MaximumDisplacement = "maximum displacement",
        /// Displacement of each node (m); a list of vectors.
        Displacement = "displacement",
        /// Mean of the nodes' positions (m); a vector.
        MeanPosition = "mean position",
        /// Position of each node (m); a list of vectors.
        Position = "position",
        /// Mean of the nodes' velocities (m/s); a vector.
        MeanVelocity = "mean velocity",
        /// Sum of the forces that hold the fixed and moved nodes of the region (N); a vector.
        Reaction = "reaction",
        /// Kinetic energy plus strain energy (J); a number.
        Energy = "energy",
        /// Kinetic energy of the nodes (J); a number.
        KineticEnergy = "kinetic energy",
        /// Strain energy of the elements (J); a number.
        StrainEnergy = "strain energy",
        /// Mean positions of the nodes that share a rest coordinate along `axis`, in its order (m); a list of vectors.
        DeflectionCurve = "deflection curve",
        /// Mean Cauchy stress of the elements, weighted by volume (Pa); a symmetric tensor.
        Stress = "stress",
        /// Mean Green–Lagrange strain of the elements, weighted by rest volume; a symmetric tensor.
        Strain = "strain",
        /// Principal stretches of that mean strain, the largest first; a vector.
        PrincipalStretches = "principal stretches",
        /// Volume of the elements in the deformed shape (m^3); a number.
        Volume = "volume",
        /// Deformed over rest volume of all the elements; a number.
        VolumeRatio = "volume ratio",
        /// Strain energy over rest volume of all the elements (J/m^3); a number.
        EnergyDensity = "energy density",
    }
}

/// What kind of value a quantity is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QuantityShape {
    /// One number.
    Scalar,
    /// Three numbers: x, y, z.
    Vector,
    /// Six numbers: xx, yy, zz, xy, yz, zx.
    Tensor,
    /// Any number of vectors.
    Vectors,
}

impl Quantity {
    /// What kind of value it is.
    pub fn shape(self) -> QuantityShape {
        use Quantity::*;
        match self {
            MaximumDisplacement | Energy | KineticEnergy | StrainEnergy | Volume | VolumeRatio | EnergyDensity => {
                QuantityShape::Scalar
            }
            MeanDisplacement | MeanPosition | MeanVelocity | Reaction | PrincipalStretches => QuantityShape::Vector,
            Stress | Strain => QuantityShape::Tensor,
            Displacement | Position | DeflectionCurve => QuantityShape::Vectors,
        }
    }

    /// Whether it is measured on elements alone, and nodes say nothing of it.
    pub fn of_elements(self) -> bool {
        use Quantity::*;
        matches!(self, StrainEnergy | Stress | Strain | PrincipalStretches | Volume | VolumeRatio | EnergyDensity)
    }

    /// Its physical dimension.
    pub fn dimension(self) -> Dimension {
        use Quantity::*;
        match self {
            MeanDisplacement | MaximumDisplacement | Displacement | MeanPosition | Position | DeflectionCurve => {
                Dimension::LENGTH
            }
            MeanVelocity => Dimension::VELOCITY,
            Reaction => Dimension::FORCE,
            Energy | KineticEnergy | StrainEnergy => Dimension::ENERGY,
            // J/m^3 is Pa.
            Stress | EnergyDensity => Dimension::PRESSURE,
            Strain | PrincipalStretches | VolumeRatio => Dimension::NUMBER,
            Volume => Dimension::VOLUME,
        }
    }
}

/// A measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Probe {
    /// Its name, unlike any other probe's.
    pub name: Spanned<String>,
    /// Index of the body; `None` measures every body in which the region selects something.
    pub body: Option<Spanned<usize>>,
    /// Where (default all).
    pub region: Region,
    /// What; at least one, all different.
    pub quantities: Vec<Spanned<Quantity>>,
    /// Axis of a deflection curve (default x).
    pub axis: Axis,
}

pub(crate) static PROBE: Section = Section {
    header: "[[probe]]",
    about: "something measured during the run and reported at its end",
    keys: &[
        Key {
            name: "name",
            kind: Kind::Text,
            presence: Presence::Required,
            about: "its name, unlike any other probe's: letters, digits, spaces, `_`, `-`, `.`; not a number",
        },
        Key {
            name: "body",
            kind: Kind::Text,
            presence: Presence::Optional("every body in which the region selects something"),
            about: "name of the body",
        },
        Key { name: "region", kind: Kind::Region, presence: Presence::Default("\"all\""), about: "where" },
        Key {
            name: "quantity",
            kind: Kind::OneOrMore(Quantity::CHOICES),
            presence: Presence::Required,
            about: "what is measured",
        },
        Key {
            name: "axis",
            kind: Kind::Choice(Axis::CHOICES),
            presence: Presence::Default("\"x\""),
            about: "axis of a deflection curve",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn probe(&mut self, fields: &Fields<'_>, bodies: &[String]) -> Option<Spanned<Probe>> {
        let name = self.name(fields);
        let body = self.body_named(fields, "body", bodies);
        let region = if fields.has("region") {
            self.region(fields, "region")
        } else {
            Some(Spanned::default_value(Selection::All))
        };
        let quantities = self.choices::<Quantity>(fields, "quantity");
        let axis = self.choice(fields, "axis").map_or(Axis::X, |axis| axis.value);
        if fields.has("body") && body.is_none() {
            return None;
        }
        let probe = Probe { name: name?, body, region: region?, quantities: quantities?, axis };
        if let Some(at) = fields.key_at("axis")
            && !probe.quantities.iter().any(|quantity| quantity.value == Quantity::DeflectionCurve)
        {
            self.warn(at.clone(), "`axis` has no effect without the quantity \"deflection curve\"");
        }
        Some(Spanned::new(probe, fields.at.clone()))
    }
}
