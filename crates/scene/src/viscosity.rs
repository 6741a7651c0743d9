//! `[body.material.viscosity]`: the viscous part of a material, added to its elastic law.
//!
//! Kelvin–Voigt: σᵥ = 2 η dev(ε̇) + ζ tr(ε̇) I, with the shear viscosity η and the bulk viscosity ζ.
//! Prony series: the elastic stress relaxes as g(t) = 1 − Σ gᵢ (1 − exp(−t/τᵢ)).

use serde::Serialize;

use crate::dimension::Dimension;
use crate::location::Spanned;
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

/// The viscous part of a material.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Viscosity {
    /// Shear viscosity η (Pa s; default 0).
    pub shear: f64,
    /// Bulk viscosity ζ (Pa s; default 0).
    pub bulk: f64,
    /// Terms of a Prony series (default none).
    pub prony: Vec<Spanned<PronyTerm>>,
}

/// A term of a Prony series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PronyTerm {
    /// Share g of the instantaneous stress that relaxes, between 0 and 1.
    pub fraction: f64,
    /// Relaxation time τ (s).
    pub time: f64,
}

pub(crate) static VISCOSITY: Section = Section {
    header: "[body.material.viscosity]",
    about: "a viscous part, added to the elastic law",
    keys: &[
        Key {
            name: "shear",
            kind: Kind::Number(Dimension::VISCOSITY, Range::NOT_NEGATIVE),
            presence: Presence::Default("0.0"),
            about: "shear viscosity η of Kelvin–Voigt",
        },
        Key {
            name: "bulk",
            kind: Kind::Number(Dimension::VISCOSITY, Range::NOT_NEGATIVE),
            presence: Presence::Default("0.0"),
            about: "bulk viscosity ζ of Kelvin–Voigt",
        },
        Key {
            name: "prony",
            kind: Kind::Tables(&PRONY),
            presence: Presence::Optional("no relaxation"),
            about: "terms of a Prony series",
        },
    ],
    other_keys: None,
};

static PRONY: Section = Section {
    header: "[[body.material.viscosity.prony]]",
    about: "a term of g(t) = 1 − Σ gᵢ (1 − exp(−t/τᵢ))",
    keys: &[
        Key {
            name: "fraction",
            kind: Kind::Number(Dimension::NUMBER, Range::INSIDE_UNIT),
            presence: Presence::Required,
            about: "gᵢ; all of them together stay below 1",
        },
        Key {
            name: "time",
            kind: Kind::Number(Dimension::TIME, Range::POSITIVE),
            presence: Presence::Required,
            about: "τᵢ",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn viscosity(&mut self, fields: &Fields<'_>) -> Viscosity {
        let mut result = Viscosity {
            shear: self.number(fields, "shear").map_or(0.0, |value| value.value),
            bulk: self.number(fields, "bulk").map_or(0.0, |value| value.value),
            prony: Vec::new(),
        };
        for term in self.tables(fields, "prony") {
            let (fraction, time) = (self.number(&term, "fraction"), self.number(&term, "time"));
            if let (Some(fraction), Some(time)) = (fraction, time) {
                let term_value = PronyTerm { fraction: fraction.value, time: time.value };
                result.prony.push(Spanned::new(term_value, term.at.clone()));
            }
        }
        let total: f64 = result.prony.iter().map(|term| term.fraction).sum();
        if total >= 1.0 {
            let message = format!(
                "the fractions of the Prony series sum to {total}; they must stay below 1, or nothing elastic is left"
            );
            self.conflict(fields.place("prony"), message);
        }
        result
    }
}
