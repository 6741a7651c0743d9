//! What a block of like elements is made of.

use souple_elements::{Element, Rule};
use souple_laws::Law;

/// Elements of one kind with one law, one rule and one set of parameters.
#[derive(Clone, Debug)]
pub struct BlockSpec {
    /// The element.
    pub element: &'static Element,
    /// The law.
    pub law: &'static Law,
    /// The quadrature.
    pub rule: &'static Rule,
    /// The law's parameters in its declared order, SI units.
    pub parameters: Vec<f64>,
    /// Density in kg/m³.
    pub density: f64,
    /// Shear viscosity η and bulk viscosity ζ of Kelvin–Voigt in Pa s, if there is any.
    pub viscosity: Option<[f64; 2]>,
    /// Thickness in m of surfaces in space, cross-section in m² of lines in a plane or in space; 1 for elements that fill
    /// their space.
    pub section: f64,
    /// Global node indices, [element, local node].
    pub connectivity: Vec<u32>,
    /// Number of each element in the caller's own order, for messages and fields.
    pub ids: Vec<u32>,
}

impl BlockSpec {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether the block is empty.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }
}
