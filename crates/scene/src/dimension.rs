//! Physical dimensions of the quantities in a scene.
//!
//! A dimension is a product of powers, kgᵃ mᵇ sᶜ degᵈ.
//! Angles count as a base dimension, so that `30 deg` is accepted only where an angle is meant; their unit in scenes is
//! the degree, everything else is in SI units.

use std::fmt;

/// A physical dimension with the name and the unit that messages and documentation use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimension {
    /// What it is called: `"pressure"`.
    pub name: &'static str,
    /// Unit of a plain number: `"Pa"`; empty for a pure number.
    pub unit: &'static str,
    /// A value with a unit, as one writes it: `"4 kPa"`.
    pub example: &'static str,
    /// Exponents of kg, m, s and degree.
    pub exponents: Exponents,
}

/// Exponents of kilogram, metre, second and degree.
pub type Exponents = [i16; 4];

macro_rules! dimensions {
    ($($constant:ident = $name:literal, $unit:literal, $example:literal, $exponents:expr;)+) => {
        impl Dimension {
            $(#[doc = concat!("The dimension of: ", $name, " (", $unit, ").")]
            pub const $constant: Dimension =
                Dimension { name: $name, unit: $unit, example: $example, exponents: $exponents };)+

            /// Every named dimension; where several share exponents, the more common one is first.
            pub const ALL: &'static [Dimension] = &[$(Dimension::$constant),+];
        }
    };
}

dimensions! {
    NUMBER = "pure number", "", "0.5", [0, 0, 0, 0];
    TIME = "time", "s", "10 ms", [0, 0, 1, 0];
    LENGTH = "length", "m", "5 mm", [0, 1, 0, 0];
    MASS = "mass", "kg", "20 g", [1, 0, 0, 0];
    ANGLE = "angle", "deg", "30 deg", [0, 0, 0, 1];
    AREA = "area", "m^2", "4 mm^2", [0, 2, 0, 0];
    VOLUME = "volume", "m^3", "2 cm^3", [0, 3, 0, 0];
    DENSITY = "density", "kg/m^3", "1 g/cm^3", [1, -3, 0, 0];
    RATE = "rate", "1/s", "3 1/s", [0, 0, -1, 0];
    VELOCITY = "velocity", "m/s", "2 cm/s", [0, 1, -1, 0];
    ACCELERATION = "acceleration", "m/s^2", "9.81 m/s^2", [0, 1, -2, 0];
    FORCE = "force", "N", "5 mN", [1, 1, -2, 0];
    PRESSURE = "pressure", "Pa", "4 kPa", [1, -1, -2, 0];
    ENERGY = "energy", "J", "1 mJ", [1, 2, -2, 0];
    VISCOSITY = "viscosity", "Pa s", "10 Pa s", [1, -1, -1, 0];
    SURFACE_TENSION = "surface tension", "N/m", "72 mN/m", [1, 0, -2, 0];
}

impl Dimension {
    /// "a pressure", "an angle".
    pub fn with_article(&self) -> String {
        let article = if self.name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
        format!("{article} {}", self.name)
    }

    /// Describes any exponents: by name where there is one, else as a product of powers.
    pub fn describe(exponents: Exponents) -> String {
        if let Some(known) = Dimension::ALL.iter().find(|d| d.exponents == exponents) {
            return known.with_article();
        }
        let powers: Vec<String> = ["kg", "m", "s", "deg"]
            .iter()
            .zip(exponents)
            .filter(|(_, power)| *power != 0)
            .map(|(unit, power)| if power == 1 { (*unit).to_owned() } else { format!("{unit}^{power}") })
            .collect();
        format!("a quantity in {}", powers.join(" "))
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.unit.is_empty() { write!(f, "{}", self.name) } else { write!(f, "{} [{}]", self.name, self.unit) }
    }
}
