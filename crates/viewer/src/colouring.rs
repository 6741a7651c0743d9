//! What colours mean: a choice, the values that it needs, and the legend that explains it.

use crate::geometry::{length, minus};
use crate::model::Model;
use crate::numbers::with_unit;
use crate::palette::{self, Colour, Map};
use souple_simulation::ElementField;

/// What the surface is coloured by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ColourBy {
    /// One colour.
    Nothing,
    /// Family of the element.
    Element,
    /// Law.
    Law,
    /// Block of like elements: kind, law and parameters.
    Material,
    /// Body.
    Body,
    /// Part of the matrix' rows, as threads share products with it.
    Part,
    /// Length of the displacement.
    Displacement,
    /// Shape quality at rest.
    Quality,
    /// A number per element.
    Field(ElementField),
}

/// Everything that can be chosen, with its name on the command line and what people read.
pub fn choices() -> Vec<(ColourBy, &'static str, &'static str)> {
    let mut all = vec![
        (ColourBy::Nothing, "none", "nothing"),
        (ColourBy::Element, "element", "element"),
        (ColourBy::Law, "law", "law"),
        (ColourBy::Material, "material", "material"),
        (ColourBy::Body, "body", "body"),
        (ColourBy::Part, "part", "part of the matrix"),
        (ColourBy::Displacement, "displacement", "displacement"),
        (ColourBy::Quality, "quality", "shape quality"),
    ];
    for field in ElementField::ALL {
        let key = match field {
            ElementField::VonMises => "von-mises",
            ElementField::VolumeRatio => "volume-ratio",
            ElementField::SmallestJ => "smallest-j",
            ElementField::EnergyDensity => "energy-density",
            ElementField::LargestStretch => "largest-stretch",
            ElementField::SmallestStretch => "smallest-stretch",
            ElementField::LengthChange => "r-l",
            ElementField::VolumeChange => "r-a",
            ElementField::MeanForce => "r-s",
        };
        all.push((ColourBy::Field(field), key, field.name()));
    }
    all
}

impl ColourBy {
    /// What people read.
    pub fn name(self) -> &'static str {
        choices().into_iter().find(|c| c.0 == self).map_or("", |c| c.2)
    }

    /// SI unit of the numbers; empty where there is none.
    pub fn unit(self) -> &'static str {
        match self {
            ColourBy::Displacement => "m",
            ColourBy::Field(field) => field.unit(),
            _ => "",
        }
    }
}

/// Colours of one state.
#[derive(Clone, Debug)]
pub struct Colours {
    /// Of each element.
    pub elements: Vec<Colour>,
    /// Numbers of each node and how they become colours, where they vary inside elements.
    pub nodes: Option<Vec<Colour>>,
    /// What explains them.
    pub legend: Legend,
}

/// What explains the colours.
#[derive(Clone, Debug, PartialEq)]
pub enum Legend {
    /// Nothing to explain.
    None,
    /// Names with their colours.
    Names(Vec<(Colour, String)>),
    /// A map over a range.
    Range {
        /// What it shows.
        name: String,
        /// SI unit.
        unit: &'static str,
        /// Ends of the range.
        ends: [f64; 2],
        /// The map.
        map: Map,
    },
}

/// How numbers become colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The map.
    pub map: Map,
    /// Ends of the range; the least and the largest value there is when `None`.
    pub range: Option<[f64; 2]>,
}

impl Default for Scale {
    fn default() -> Self {
        Scale { map: Map::Viridis, range: None }
    }
}

/// The number of each node or element that colours show, where they show numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Per node.
    Nodes(Vec<f32>),
    /// Per element.
    Elements(Vec<f32>),
}

/// The numbers that colours show; `field` gives those that the simulation computes.
pub fn numbers(model: &Model, by: ColourBy, positions: &[[f32; 3]], field: &[f32]) -> Option<Numbers> {
    match by {
        ColourBy::Displacement => {
            let moved = positions.iter().zip(&model.rest);
            Some(Numbers::Nodes(moved.map(|(&now, &rest)| length(minus(now, rest))).collect()))
        }
        ColourBy::Quality => Some(Numbers::Elements(model.elements.iter().map(|e| e.quality).collect())),
        ColourBy::Field(_) if field.len() == model.elements.len() => Some(Numbers::Elements(field.to_vec())),
        _ => None,
    }
}

/// The colours of a state.
pub fn colours(model: &Model, by: ColourBy, positions: &[[f32; 3]], field: &[f32], scale: Scale) -> Colours {
    if let Some(numbers) = numbers(model, by, positions, field) {
        let (Numbers::Nodes(values) | Numbers::Elements(values)) = &numbers;
        let ends = scale.range.unwrap_or_else(|| range(values));
        let size = (ends[1] - ends[0]).max(f64::MIN_POSITIVE);
        let paint = |v: &f32| scale.map.at(((f64::from(*v) - ends[0]) / size) as f32);
        let painted: Vec<Colour> = values.iter().map(paint).collect();
        let legend = Legend::Range { name: by.name().into(), unit: by.unit(), ends, map: scale.map };
        return match numbers {
            Numbers::Nodes(_) => {
                Colours { elements: vec![palette::PLAIN; model.elements.len()], nodes: Some(painted), legend }
            }
            Numbers::Elements(_) => Colours { elements: painted, nodes: None, legend },
        };
    }
    let named = |index_of: &dyn Fn(usize) -> usize, names: Vec<String>, colour: &dyn Fn(usize) -> Colour| {
        let elements: Vec<Colour> = (0..model.elements.len()).map(|e| colour(index_of(e))).collect();
        let legend = Legend::Names(names.into_iter().enumerate().map(|(k, name)| (colour(k), name)).collect());
        Colours { elements, nodes: None, legend }
    };
    match by {
        ColourBy::Element => {
            let elements = model.elements.iter().map(|e| palette::family(e.kind.family)).collect();
            let names = model.families().into_iter().map(|(family, count)| {
                let mut kinds: Vec<&str> =
                    model.elements.iter().filter(|e| e.kind.family == family).map(|e| e.kind.id).collect();
                kinds.dedup();
                kinds.sort_unstable();
                kinds.dedup();
                (palette::family(family), format!("{count} {}", kinds.join(", ")))
            });
            Colours { elements, nodes: None, legend: Legend::Names(names.collect()) }
        }
        ColourBy::Law => {
            let mut laws: Vec<&str> = Vec::new();
            for material in &model.materials {
                if !laws.contains(&material.law) {
                    laws.push(material.law);
                }
            }
            let at = |e: usize| {
                let law = model.materials[model.elements[e].material as usize].law;
                laws.iter().position(|l| *l == law).unwrap_or(0)
            };
            named(&at, laws.iter().map(|l| (*l).to_owned()).collect(), &palette::category)
        }
        ColourBy::Material => {
            let kind = |k: usize| model.elements.iter().find(|e| e.material as usize == k).map_or("", |e| e.kind.id);
            let names = model.materials.iter().enumerate().map(|(k, m)| format!("{}, {}", kind(k), m.label)).collect();
            named(&|e| model.elements[e].material as usize, names, &palette::category)
        }
        ColourBy::Body => named(&|e| model.elements[e].body as usize, model.bodies.clone(), &palette::category),
        ColourBy::Part => {
            let count = model.elements.iter().map(|e| e.part as usize + 1).max().unwrap_or(0);
            let names = (0..count).map(|part| format!("part {part}")).collect();
            named(&|e| model.elements[e].part as usize, names, &palette::category)
        }
        // Numbers that are not there yet look plain.
        _ => Colours { elements: vec![palette::PLAIN; model.elements.len()], nodes: None, legend: Legend::None },
    }
}

/// Least and largest finite value.
fn range(values: &[f32]) -> [f64; 2] {
    let finite = || values.iter().copied().filter(|v| v.is_finite()).map(f64::from);
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    if low <= high { [low, high] } else { [0.0, 1.0] }
}

/// An end of a legend in words.
pub fn end_text(value: f64, unit: &str) -> String {
    with_unit(value, unit)
}
