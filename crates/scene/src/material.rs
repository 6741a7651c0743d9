//! `[[body.material]]`: which law applies where, and its parameters.
//!
//! The parameters of the law stand beside the other keys; which ones there are comes from the [`Catalogue`].
//! An isotropic law accepts (young, poisson), (lambda, mu) or (bulk, mu), kept here as given:
//! λ = E ν / ((1 + ν)(1 − 2ν)), μ = E / (2 (1 + ν)), bulk = λ + 2μ/3.
//! Numbered parameters may be given as one list: `mu = [3, 4]` for `mu1 = 3` and `mu2 = 4`.
//!
//! [`Catalogue`]: crate::Catalogue

use serde::Serialize;

use crate::catalogue::{LawEntry, LawRefusal, ParameterEntry, ParameterShape, ParameterValue};
use crate::dimension::Dimension;
use crate::error::Problem;
use crate::location::{Location, Spanned};
use crate::node::{Entry, Node, Value, shortened};
use crate::range::Range;
use crate::reader::{Fields, Reader};
use crate::region::{Region, Selection};
use crate::schema::{Key, Kind, Presence, Section};
use crate::suggestion::nearest;
use crate::units;
use crate::viscosity::{VISCOSITY, Viscosity};

/// The id of the law whose energy is written in the scene.
pub const USER_LAW: &str = "user";

/// A law on a region of a body; later materials override earlier ones on their region.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Material {
    /// Where (default all).
    pub region: Region,
    /// Id of the law, or [`USER_LAW`].
    pub law: Spanned<String>,
    /// Its parameters, defaults included, in the law's order; of a user law in alphabetical order.
    ///
    /// Of an isotropic law the first two are one of the pairs (`young`, `poisson`), (`lambda`, `mu`), (`bulk`, `mu`).
    pub parameters: Vec<Parameter>,
    /// Energy density of a user law, given exactly when `law` is [`USER_LAW`].
    pub energy: Option<Spanned<String>>,
    /// Thickness in m: the faces of the region become membranes.
    pub thickness: Option<Spanned<f64>>,
    /// Area of the cross-section in m²: the edges of the region become cables.
    pub section: Option<Spanned<f64>>,
    /// Viscous part (default none).
    pub viscosity: Option<Spanned<Viscosity>>,
}

/// A parameter of a law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value in SI units.
    pub value: Spanned<ParameterValue>,
}

impl Material {
    /// The parameter of this name.
    pub fn parameter(&self, name: &str) -> Option<&Spanned<ParameterValue>> {
        self.parameters.iter().find(|parameter| parameter.name == name).map(|parameter| &parameter.value)
    }
}

pub(crate) static MATERIAL: Section = Section {
    header: "[[body.material]]",
    about: "a constitutive law on a region; later entries override earlier ones on their region",
    keys: &[
        Key { name: "region", kind: Kind::Region, presence: Presence::Default("\"all\""), about: "where it applies" },
        Key {
            name: "law",
            kind: Kind::Text,
            presence: Presence::Optional("required, unless `energy` is given: then `\"user\"`"),
            about: "id of the law (`souple list laws`), or \"user\"",
        },
        Key {
            name: "energy",
            kind: Kind::Text,
            presence: Presence::Optional("required with `law = \"user\"`"),
            about: "energy density of a user law [J/m^3], an expression such as \"mu/2*(I1 - 3) - mu*ln(J)\"",
        },
        Key {
            name: "thickness",
            kind: Kind::Number(Dimension::LENGTH, Range::POSITIVE),
            presence: Presence::Optional("no membranes"),
            about: "makes the faces of the region (triangles, quadrangles) membranes in space, this thick at rest",
        },
        Key {
            name: "section",
            kind: Kind::Number(Dimension::AREA, Range::POSITIVE),
            presence: Presence::Optional("no cables"),
            about: "makes the edges of the region cables in the plane or in space, of this cross-section at rest",
        },
        Key {
            name: "viscosity",
            kind: Kind::Table(&VISCOSITY),
            presence: Presence::Optional("purely elastic"),
            about: "a viscous part",
        },
    ],
    other_keys: Some(
        "The parameters of the law, by name: numbers in SI units, texts with units, or lists. \
         Numbered parameters (`mu1`, `mu2`) may be given as one list (`mu = [..]`). \
         Isotropic laws accept `young` and `poisson`, or `lambda` and `mu`, or `bulk` and `mu`. \
         The parameters of a user law are the names in its energy.",
    ),
};

/// The elastic constants that describe isotropy, with unit, range and meaning.
const ISOTROPIC: [(&str, &str, Range, &str); 3] = [
    ("lambda", "Pa", Range::ANY, "first Lamé constant"),
    ("mu", "Pa", Range::POSITIVE, "shear modulus"),
    ("bulk", "Pa", Range::POSITIVE, "bulk modulus"),
];

const PAIRS: [[&str; 2]; 3] = [["young", "poisson"], ["lambda", "mu"], ["bulk", "mu"]];

impl Reader<'_> {
    pub(crate) fn material(&mut self, fields: &Fields<'_>) -> Option<Spanned<Material>> {
        let region = if fields.has("region") {
            self.region(fields, "region")
        } else {
            Some(Spanned::default_value(Selection::All))
        };
        let (law, energy) = (self.text(fields, "law"), self.text(fields, "energy"));
        let viscosity =
            self.table(fields, "viscosity").map(|table| Spanned::new(self.viscosity(&table), table.at.clone()));
        let (thickness, section) = (self.number(fields, "thickness"), self.number(fields, "section"));
        if let (Some(_), Some(section)) = (&thickness, &section) {
            let message = "a material has a `thickness` (membranes) or a `section` (cables), not both: write one \
                           [[body.material]] for the faces and one for the edges";
            self.conflict(section.at.clone(), message.to_owned());
        }
        let law = match law {
            Some(law) => law,
            None if fields.has("law") => return None,
            None if fields.has("energy") => Spanned::new(USER_LAW.to_owned(), fields.place("energy")),
            None => {
                self.missing(fields, "law");
                return None;
            }
        };
        let parameters = if law.value == USER_LAW {
            self.user_parameters(fields, energy.as_ref())
        } else {
            if let Some(at) = fields.key_at("energy") {
                let message = format!("`energy` belongs to `law = \"user\"`; the law is \"{}\"", shortened(&law));
                self.conflict(at.clone(), message);
            }
            self.law_parameters(fields, &law)
        };
        let (region, parameters) = (region?, parameters?);
        let material = Material { region, law, parameters, energy, thickness, section, viscosity };
        Some(Spanned::new(material, fields.at.clone()))
    }

    fn law_parameters(&mut self, fields: &Fields<'_>, law: &Spanned<String>) -> Option<Vec<Parameter>> {
        let catalogue = self.catalogue;
        let Some(entry) = catalogue.laws.iter().find(|entry| entry.id == law.value) else {
            let known = catalogue.laws.iter().map(|entry| entry.id.clone()).chain([USER_LAW.to_owned()]).collect();
            self.unknown_name("law", law, known);
            return None;
        };
        let errors = self.errors.len();
        let isotropic = is_isotropic(entry);
        let mut parameters = Vec::new();
        if isotropic {
            parameters.extend(self.isotropic_pair(fields, entry));
        }
        for parameter in &entry.parameters {
            if isotropic && PAIRS[0].contains(&parameter.name.as_str()) {
                continue;
            }
            let given = fields.others.iter().find(|other| other.name == parameter.name).map(|given| &given.node);
            let in_list = item_of_list(fields, &parameter.name);
            if let (Some(given), Some((list, _))) = (given, in_list) {
                let message =
                    format!("`{}` is also a value of the list `{}`: give one of the two", parameter.name, list.name);
                self.conflict(given.at.clone(), message);
                continue;
            }
            let value = match (given.or(in_list.map(|item| item.1)), &parameter.default) {
                (Some(given), _) => self.parameter(given, parameter),
                (None, Some(default)) => Some(Spanned::default_value(default.clone())),
                (None, None) => {
                    let needed = described(&parameter.name, &parameter.unit, &parameter.about);
                    let problem = Problem::MissingParameter { law: entry.id.clone(), needed, given: Vec::new() };
                    self.error(fields.at.clone(), problem);
                    None
                }
            };
            parameters.extend(value.map(|value| Parameter { name: parameter.name.clone(), value }));
        }
        self.unknown_parameters(fields, entry, isotropic);
        if self.errors.len() > errors {
            return None;
        }
        if let Some(check) = entry.check {
            let values: Vec<(&str, &ParameterValue)> = by_reference(&parameters);
            if let Err(refusal) = check(&values) {
                self.refusal(refusal, &parameters, &law.at);
                return None;
            }
        }
        Some(parameters)
    }

    fn unknown_parameters(&mut self, fields: &Fields<'_>, law: &LawEntry, isotropic: bool) {
        let mut known: Vec<String> = law.parameters.iter().map(|parameter| parameter.name.clone()).collect();
        if isotropic {
            known.extend(ISOTROPIC.iter().map(|constant| constant.0.to_owned()));
        }
        for other in &fields.others {
            if known.contains(&other.name) {
                continue;
            }
            let members = law.parameters.iter().filter(|p| member(&p.name).is_some_and(|m| m.0 == other.name)).count();
            if members > 0 {
                match &other.node.value {
                    Value::Array(items) if (1..=members).contains(&items.len()) => {}
                    _ => {
                        let expected =
                            format!("a list of 1 to {members} numbers, or `{0}1` to `{0}{members}`", other.name);
                        self.wrong_type(&other.name, expected, &other.node);
                    }
                }
                continue;
            }
            let keys = MATERIAL.keys.iter().map(|key| key.name);
            let nearest = nearest(&other.name, known.iter().map(String::as_str).chain(keys)).map(str::to_owned);
            let (law, found) = (law.id.clone(), shortened(&other.name));
            let problem = Problem::UnknownParameter { law, found, nearest, known: known.clone() };
            self.error(other.at.clone(), problem);
        }
    }

    /// The two elastic constants that are given, in the order of their pair; none when something is wrong.
    fn isotropic_pair(&mut self, fields: &Fields<'_>, law: &LawEntry) -> Vec<Parameter> {
        let given: Vec<&Entry> = fields
            .others
            .iter()
            .copied()
            .filter(|other| PAIRS.iter().flatten().any(|name| *name == other.name))
            .collect();
        let pair =
            PAIRS.iter().find(|pair| given.len() == 2 && pair.iter().all(|name| given.iter().any(|g| g.name == *name)));
        let values: Vec<Option<Parameter>> = given
            .iter()
            .map(|entry| {
                let value = match law.parameters.iter().find(|parameter| parameter.name == entry.name) {
                    Some(parameter) => self.parameter(&entry.node, parameter)?,
                    None => {
                        let range = ISOTROPIC.iter().find(|constant| constant.0 == entry.name)?.2;
                        let value = self.number_of(&entry.name, &entry.node, Dimension::PRESSURE, range)?;
                        Spanned::new(ParameterValue::Number(value), entry.node.at.clone())
                    }
                };
                Some(Parameter { name: entry.name.clone(), value })
            })
            .collect();
        let Some(pair) = pair else {
            self.no_pair(fields, law, &given);
            return Vec::new();
        };
        let Some(mut values) = values.into_iter().collect::<Option<Vec<Parameter>>>() else { return Vec::new() };
        values.sort_by_key(|parameter| pair.iter().position(|name| *name == parameter.name));
        if pair == &["lambda", "mu"]
            && let [ParameterValue::Number(lambda), ParameterValue::Number(mu)] =
                [&values[0].value.value, &values[1].value.value]
            && lambda + 2.0 / 3.0 * mu <= 0.0
        {
            let problem = Problem::OutOfRange {
                key: "lambda".to_owned(),
                expected: format!("greater than −2/3 mu = {} Pa, or the bulk modulus is not positive", -2.0 / 3.0 * mu),
                found: lambda.to_string(),
                hint: None,
            };
            self.error(values[0].value.at.clone(), problem);
        }
        values
    }

    fn no_pair(&mut self, fields: &Fields<'_>, law: &LawEntry, given: &[&Entry]) {
        let pairs = "`young` [Pa] and `poisson`, or `lambda` [Pa] and `mu` [Pa], or `bulk` [Pa] and `mu` [Pa]";
        let names: Vec<String> = given.iter().map(|entry| format!("`{}`", entry.name)).collect();
        if let Some(last) = given.get(1) {
            let message = format!("law `{}` takes exactly one pair: {pairs}; found {}", law.id, names.join(", "));
            self.conflict(given.get(2).unwrap_or(last).at.clone(), message);
            return;
        }
        // The usual pair is named first when half of it is there already.
        let missing =
            PAIRS[0].iter().find(|name| given.iter().any(|g| PAIRS[0].contains(&g.name.as_str()) && g.name != **name));
        let needed = match missing {
            Some(name) => match law.parameters.iter().find(|parameter| parameter.name == **name) {
                Some(parameter) => described(&parameter.name, &parameter.unit, &parameter.about),
                None => format!("`{name}`"),
            },
            None => pairs.to_owned(),
        };
        let problem = Problem::MissingParameter { law: law.id.clone(), needed, given: names };
        self.error(fields.at.clone(), problem);
    }

    /// The value of a parameter, of the shape, unit and range that its law declares.
    fn parameter(&mut self, node: &Node, entry: &ParameterEntry) -> Option<Spanned<ParameterValue>> {
        // The law's unit decides the dimension; its scale (a law in kPa) does not: scenes are in SI units.
        let exponents = units::unit(&entry.unit).map(|unit| unit.exponents).unwrap_or_default();
        let known = Dimension::ALL.iter().find(|dimension| dimension.exponents == exponents);
        let dimension =
            known.copied().unwrap_or(Dimension { name: "quantity", unit: "SI units", example: "1", exponents });
        let value = match entry.shape {
            ParameterShape::Number => {
                ParameterValue::Number(self.number_of(&entry.name, node, dimension, entry.range())?)
            }
            ParameterShape::Direction => ParameterValue::List(self.direction_of(&entry.name, node)?.to_vec()),
            ParameterShape::List { length } => {
                let items = match &node.value {
                    Value::Array(items) if length.is_none_or(|length| items.len() == length) && !items.is_empty() => {
                        items
                    }
                    _ => {
                        let count = length.map_or("numbers".to_owned(), |length| format!("{length} numbers"));
                        self.wrong_type(&entry.name, format!("a list of {count}"), node);
                        return None;
                    }
                };
                let values: Vec<Option<f64>> =
                    items.iter().map(|item| self.number_of(&entry.name, item, dimension, entry.range())).collect();
                ParameterValue::List(values.into_iter().collect::<Option<_>>()?)
            }
        };
        Some(Spanned::new(value, node.at.clone()))
    }

    /// The parameters of an energy written in the scene: every key that is not one of a material.
    fn user_parameters(&mut self, fields: &Fields<'_>, energy: Option<&Spanned<String>>) -> Option<Vec<Parameter>> {
        let Some(energy) = energy else {
            if !fields.has("energy") {
                self.missing(fields, "energy");
            }
            return None;
        };
        let words: Vec<&str> = energy.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
        let errors = self.errors.len();
        let mut parameters = Vec::new();
        for other in &fields.others {
            if !words.contains(&other.name.as_str()) {
                let known: Vec<&str> = MATERIAL.keys.iter().map(|key| key.name).collect();
                let hint = crate::error::did_you_mean(nearest(&other.name, known));
                let name = shortened(&other.name);
                self.conflict(
                    other.at.clone(),
                    format!("`{name}` does not occur in the energy of this material{hint}"),
                );
                continue;
            }
            let value = self.user_parameter(&other.name, &other.node);
            parameters.extend(value.map(|value| Parameter { name: other.name.clone(), value }));
        }
        if self.errors.len() > errors {
            return None;
        }
        parameters.sort_by(|a, b| a.name.cmp(&b.name));
        if let Some(check) = self.catalogue.user_law {
            let values = by_reference(&parameters);
            if let Err(refusal) = check(energy, &values) {
                self.refusal(refusal, &parameters, &energy.at);
                return None;
            }
        }
        Some(parameters)
    }

    fn user_parameter(&mut self, name: &str, node: &Node) -> Option<Spanned<ParameterValue>> {
        let value = match &node.value {
            Value::Array(items) if !items.is_empty() => {
                let values: Vec<Option<f64>> =
                    items.iter().map(|item| self.number_of_any_dimension(name, item)).collect();
                ParameterValue::List(values.into_iter().collect::<Option<_>>()?)
            }
            _ => ParameterValue::Number(self.number_of_any_dimension(name, node)?),
        };
        Some(Spanned::new(value, node.at.clone()))
    }

    fn number_of_any_dimension(&mut self, name: &str, node: &Node) -> Option<f64> {
        match &node.value {
            Value::Text(text) => match units::quantity_of_any_dimension(text) {
                Ok(value) => self.checked(name, value, "", Range::ANY, node),
                Err(source) => {
                    self.error(node.at.clone(), Problem::Unit { key: name.to_owned(), source });
                    None
                }
            },
            Value::Integer(_) | Value::Float(_) => self.number_of(name, node, Dimension::NUMBER, Range::ANY),
            _ => {
                self.wrong_type(name, "a number, a text with a unit, or a list of these", node);
                None
            }
        }
    }

    fn refusal(&mut self, refusal: LawRefusal, parameters: &[Parameter], otherwise: &Location) {
        let named = parameters.iter().find(|parameter| refusal.parameter.as_ref() == Some(&parameter.name));
        let at = named.map(|parameter| parameter.value.at.clone()).filter(|at| *at != Location::Default);
        let message = match &refusal.parameter {
            Some(name) => format!("`{name}`: {}", refusal.message),
            None => refusal.message,
        };
        self.error(at.unwrap_or_else(|| otherwise.clone()), Problem::Law(message));
    }
}

/// List and place of a numbered parameter: `mu` and 0 for `mu1`.
fn member(name: &str) -> Option<(&str, usize)> {
    let list = name.trim_end_matches(|c: char| c.is_ascii_digit());
    let number: usize = name[list.len()..].parse().ok()?;
    (!list.is_empty() && (1..=9).contains(&number)).then(|| (list, number - 1))
}

/// The value of a numbered parameter in a list of the scene: that of `mu2` in `mu = [3, 4]`.
fn item_of_list<'f>(fields: &Fields<'f>, name: &str) -> Option<(&'f Entry, &'f Node)> {
    let (list, place) = member(name)?;
    let list = fields.others.iter().copied().find(|other| other.name == list)?;
    match &list.node.value {
        Value::Array(items) => Some((list, items.get(place)?)),
        _ => None,
    }
}

fn is_isotropic(law: &LawEntry) -> bool {
    let has = |name: &str| law.parameters.iter().any(|parameter| parameter.name == name);
    has("young") && has("poisson") && !ISOTROPIC.iter().any(|constant| has(constant.0))
}

fn described(name: &str, unit: &str, about: &str) -> String {
    let unit = if unit.is_empty() || unit == "1" { String::new() } else { format!(" [{unit}]") };
    if about.is_empty() { format!("`{name}`{unit}") } else { format!("`{name}`{unit}, {about}") }
}

fn by_reference(parameters: &[Parameter]) -> Vec<(&str, &ParameterValue)> {
    parameters.iter().map(|parameter| (parameter.name.as_str(), &parameter.value.value)).collect()
}
