//! Parameters of laws: declared once, with all that scenes, checks and documents need to know about them.

/// End of a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// No limit.
    None,
    /// No limit, but zero itself is excluded.
    NonZero,
    /// The limit itself is excluded.
    Open(f64),
    /// The limit itself is allowed.
    Closed(f64),
}

/// A parameter of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name in scenes and expressions.
    pub name: &'static str,
    /// SI unit; `"1"` for a pure number.
    pub unit: &'static str,
    /// Lower end of its range.
    pub minimum: Bound,
    /// Upper end of its range.
    pub maximum: Bound,
    /// Value when a scene gives none; without one it must be given.
    pub default: Option<f64>,
    /// What it means.
    pub about: &'static str,
}

impl Parameter {
    /// Whether a value is in range. NaN never is.
    pub fn accepts(&self, value: f64) -> bool {
        let above = match self.minimum {
            Bound::None => true,
            Bound::NonZero => value != 0.0,
            Bound::Open(limit) => value > limit,
            Bound::Closed(limit) => value >= limit,
        };
        let below = match self.maximum {
            Bound::None => true,
            Bound::NonZero => value != 0.0,
            Bound::Open(limit) => value < limit,
            Bound::Closed(limit) => value <= limit,
        };
        above && below && value.is_finite()
    }
}

/// Young's modulus.
pub const YOUNG: Parameter = Parameter {
    name: "young",
    unit: "Pa",
    minimum: Bound::Open(0.0),
    maximum: Bound::None,
    default: None,
    about: "Young's modulus: stress over strain of a thin bar under small traction",
};

/// Poisson's ratio.
pub const POISSON: Parameter = Parameter {
    name: "poisson",
    unit: "1",
    minimum: Bound::Open(-1.0),
    maximum: Bound::Open(0.5),
    default: None,
    about: "Poisson's ratio: lateral contraction over axial extension of that bar; 0.5 would be incompressible",
};

/// Bulk modulus of a volumetric energy κ/2 (J − 1)².
pub const BULK: Parameter = Parameter {
    name: "bulk",
    unit: "Pa",
    minimum: Bound::Open(0.0),
    maximum: Bound::None,
    default: None,
    about: "bulk modulus κ: pressure over relative loss of volume",
};

/// The parameters of an isotropic law that agrees with Hooke's at small strain.
pub const ISOTROPIC: [Parameter; 2] = [YOUNG, POISSON];

/// Lamé's constants (λ, μ) in pascals: λ = Eν/((1+ν)(1−2ν)), μ = E/(2(1+ν)).
pub fn lame_from_young_poisson(young: f64, poisson: f64) -> (f64, f64) {
    (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)))
}
