//! `[[expect]]`: what a run of this scene must give, for tests of the simulator with the scene itself.
//!
//! A number v is as expected when |v − value| ≤ max(tolerance, relative_tolerance · |value|).
//! For vectors and tensors the bars are Euclidean norms of all components, unless `component` picks one number.

use serde::Serialize;

use crate::choice::{Named, choices};
use crate::error::Problem;
use crate::location::Spanned;
use crate::node::{Node, Value};
use crate::probe::{Probe, Quantity, QuantityShape};
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::schema::{Key, Kind, Presence, Section};

choices! {
    /// One number of a vector or a symmetric tensor.
    pub enum Component {
        /// First component of a vector.
        X = "x",
        /// Second component of a vector.
        Y = "y",
        /// Third component of a vector.
        Z = "z",
        /// Length of a vector.
        Magnitude = "magnitude",
        /// Component of a tensor.
        Xx = "xx",
        /// Component of a tensor.
        Yy = "yy",
        /// Component of a tensor.
        Zz = "zz",
        /// Component of a tensor.
        Xy = "xy",
        /// Component of a tensor.
        Yz = "yz",
        /// Component of a tensor.
        Zx = "zx",
        /// Von Mises norm of a tensor.
        VonMises = "von mises",
    }
}

impl Component {
    /// Whether it is a component of a vector (and not of a tensor).
    pub fn is_of_vector(self) -> bool {
        matches!(self, Component::X | Component::Y | Component::Z | Component::Magnitude)
    }
}

/// Something that must hold after the run.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Expectation {
    /// A probe's last value.
    Value(ExpectedValue),
    /// No step takes more iterations of the conjugate gradients than this.
    MaxCgIterations(u32),
}

/// The expected value of a probe.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExpectedValue {
    /// Index of the probe.
    pub probe: Spanned<usize>,
    /// One of the probe's quantities.
    pub quantity: Quantity,
    /// The number of a vector or a tensor that is compared; `None` compares all.
    pub component: Option<Component>,
    /// The entry of a quantity that is a list, from 0.
    pub index: Option<u32>,
    /// The value in SI units: 1 number, or 3 for a whole vector, 6 for a whole tensor.
    pub value: Spanned<Vec<f64>>,
    /// Largest absolute difference, in SI units (default 0).
    pub tolerance: f64,
    /// Largest difference relative to the value's norm (default 0); one of the two is positive.
    pub relative_tolerance: f64,
}

pub(crate) static EXPECT: Section = Section {
    header: "[[expect]]",
    about: "what a run must give, for tests: the value of a probe, or a bound on iterations",
    keys: &[
        Key {
            name: "probe",
            kind: Kind::Text,
            presence: Presence::Optional("`max_cg_iterations` is given"),
            about: "name of the probe",
        },
        Key {
            name: "quantity",
            kind: Kind::Choice(Quantity::CHOICES),
            presence: Presence::Optional("the probe's only quantity"),
            about: "which of the probe's quantities",
        },
        Key {
            name: "component",
            kind: Kind::Choice(Component::CHOICES),
            presence: Presence::Optional("all components"),
            about: "the number of a vector or a tensor that is compared",
        },
        Key {
            name: "index",
            kind: Kind::Whole(0, u32::MAX),
            presence: Presence::Optional("required where the quantity is a list"),
            about: "the entry of the list, from 0",
        },
        Key {
            name: "value",
            kind: Kind::Values("a number, or one list of all components; units as the quantity's"),
            presence: Presence::Optional("required with `probe`"),
            about: "the expected value at the end of the run",
        },
        Key {
            name: "tolerance",
            kind: Kind::Values("a number; unit as the quantity's"),
            presence: Presence::Optional("`relative_tolerance` alone decides"),
            about: "largest absolute difference",
        },
        Key {
            name: "relative_tolerance",
            kind: Kind::Number(crate::dimension::Dimension::NUMBER, Range::POSITIVE),
            presence: Presence::Optional("`tolerance` alone decides"),
            about: "largest difference as a fraction of the value; the larger of the two tolerances counts",
        },
        Key {
            name: "max_cg_iterations",
            kind: Kind::Whole(1, u32::MAX),
            presence: Presence::Optional("`probe` is given"),
            about: "no step takes more iterations of the conjugate gradients",
        },
    ],
    other_keys: None,
};

impl Reader<'_> {
    pub(crate) fn expectation(
        &mut self,
        fields: &Fields<'_>,
        probes: &[Spanned<Probe>],
    ) -> Option<Spanned<Expectation>> {
        let limit = self.whole(fields, "max_cg_iterations");
        let expectation = match (fields.has("probe"), fields.has("max_cg_iterations")) {
            (true, false) => Expectation::Value(self.expected_value(fields, probes)?),
            (false, true) => {
                for key in EXPECT.keys.iter().filter(|key| key.name != "max_cg_iterations") {
                    if let Some(at) = fields.key_at(key.name) {
                        self.conflict(at.clone(), format!("`{}` needs `probe`", key.name));
                    }
                }
                Expectation::MaxCgIterations(limit?.value)
            }
            (both, _) => {
                let at = if both { fields.place("max_cg_iterations") } else { fields.at.clone() };
                self.conflict(at, "[[expect]] needs exactly one of `probe` and `max_cg_iterations`; write two of them");
                return None;
            }
        };
        Some(Spanned::new(expectation, fields.at.clone()))
    }

    fn expected_value(&mut self, fields: &Fields<'_>, probes: &[Spanned<Probe>]) -> Option<ExpectedValue> {
        let relative = self.number(fields, "relative_tolerance");
        let component = self.choice::<Component>(fields, "component");
        let index = self.whole(fields, "index");
        if !fields.has("value") {
            self.missing(fields, "value");
        }
        if !fields.has("tolerance") && !fields.has("relative_tolerance") {
            let message = "[[expect]] needs `tolerance`, in the unit of the value, or `relative_tolerance`";
            self.conflict(fields.at.clone(), message);
        }
        let name = self.text(fields, "probe")?;
        let Some(probe) = probes.iter().position(|probe| *probe.name == name.value) else {
            let known = probes.iter().map(|probe| probe.name.value.clone()).collect();
            self.unknown_name("probe", &name, known);
            return None;
        };
        let quantity = self.probed_quantity(fields, &probes[probe])?;
        let dimension = quantity.dimension();
        let count = self.value_count(fields, quantity, component.as_ref())?;
        let value = self.value(fields, quantity, count);
        let tolerance = match fields.node("tolerance") {
            Some(node) => self.number_of("tolerance", node, dimension, Range::NOT_NEGATIVE),
            None => Some(0.0),
        };
        let tolerance = tolerance?;
        let relative_tolerance = if fields.has("relative_tolerance") { relative?.value } else { 0.0 };
        Some(ExpectedValue {
            probe: name.map(|_| probe),
            quantity,
            component: component.map(|component| component.value),
            index: index.map(|index| index.value),
            value: value?,
            tolerance,
            relative_tolerance,
        })
    }

    fn probed_quantity(&mut self, fields: &Fields<'_>, probe: &Probe) -> Option<Quantity> {
        let measured =
            || probe.quantities.iter().map(|quantity| format!("\"{}\"", quantity.value)).collect::<Vec<_>>().join(", ");
        if !fields.has("quantity") {
            return match probe.quantities.as_slice() {
                [only] => Some(only.value),
                _ => {
                    let message =
                        format!("probe \"{}\" measures {}; say which with `quantity`", *probe.name, measured());
                    self.conflict(fields.place("probe"), message);
                    None
                }
            };
        }
        let quantity = self.choice::<Quantity>(fields, "quantity")?;
        if !probe.quantities.contains(&quantity) {
            let message = format!(
                "probe \"{}\" measures {}, not \"{}\"; add it to the probe's `quantity`",
                *probe.name,
                measured(),
                quantity.value
            );
            self.conflict(quantity.at, message);
            return None;
        }
        Some(quantity.value)
    }

    /// How many numbers `value` must have.
    fn value_count(
        &mut self,
        fields: &Fields<'_>,
        quantity: Quantity,
        component: Option<&Spanned<Component>>,
    ) -> Option<usize> {
        let shape = quantity.shape();
        let is_list = shape == QuantityShape::Vectors;
        if is_list != fields.has("index") {
            let message = if is_list {
                format!("\"{quantity}\" is a list; say which entry with `index`, from 0")
            } else {
                format!("\"{quantity}\" is not a list; remove `index`")
            };
            self.conflict(fields.place("index"), message);
            return None;
        }
        if fields.has("component") && component.is_none() {
            return None;
        }
        match (shape, component) {
            (QuantityShape::Scalar, None) => Some(1),
            (QuantityShape::Vector | QuantityShape::Vectors, None) => Some(3),
            (QuantityShape::Tensor, None) => Some(6),
            (QuantityShape::Vector | QuantityShape::Vectors, Some(component)) if component.is_of_vector() => Some(1),
            (QuantityShape::Tensor, Some(component)) if !component.is_of_vector() => Some(1),
            (_, Some(component)) => {
                let expected = match shape {
                    QuantityShape::Scalar => "is a number; remove `component`",
                    QuantityShape::Tensor => "is a tensor; its components are xx, yy, zz, xy, yz, zx, von mises",
                    QuantityShape::Vector | QuantityShape::Vectors => {
                        "is a vector; its components are x, y, z, magnitude"
                    }
                };
                self.conflict(component.at.clone(), format!("\"{quantity}\" {expected}"));
                None
            }
        }
    }

    fn value(&mut self, fields: &Fields<'_>, quantity: Quantity, count: usize) -> Option<Spanned<Vec<f64>>> {
        let node = fields.node("value")?;
        let items: Vec<&Node> = match &node.value {
            Value::Array(items) if count > 1 && items.len() == count => items.iter().collect(),
            Value::Array(_) => {
                let expected =
                    if count == 1 { "a single number".to_owned() } else { format!("a list of {count} numbers") };
                self.wrong_type("value", expected, node);
                return None;
            }
            _ if count == 1 => vec![node],
            Value::Integer(_) | Value::Float(_) | Value::Text(_) => {
                let problem = Problem::WrongType {
                    key: "value".to_owned(),
                    expected: format!("a list of {count} numbers for \"{quantity}\", or give `component`"),
                    found: node.found(),
                };
                self.error(node.at.clone(), problem);
                return None;
            }
            _ => {
                self.wrong_type("value", format!("a list of {count} numbers"), node);
                return None;
            }
        };
        let dimension = quantity.dimension();
        let values: Vec<Option<f64>> =
            items.into_iter().map(|item| self.number_of("value", item, dimension, Range::ANY)).collect();
        Some(Spanned::new(values.into_iter().collect::<Option<_>>()?, node.at.clone()))
    }
}
