//! How the model is shown: what a person chooses, plain data.

use crate::colouring::{ColourBy, Scale};
use crate::geometry::{Vector, dot};

/// How light falls on faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shading {
    /// Every face is flat, so that elements are seen.
    Flat,
    /// Faces that meet at less than 50 degrees look like one surface.
    Smooth,
}

/// What is drawn of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Faces {
    /// Faces alone.
    Plain,
    /// Faces with the elements' edges.
    Edged,
    /// Edges alone.
    Wireframe,
}

/// A plane; what lies on the side of its normal is not shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section {
    /// Unit vector towards what is hidden.
    pub normal: Vector,
    /// Distance of the plane from the origin along it, in m.
    pub offset: f32,
}

impl Section {
    /// How far a point lies in what is hidden, in m.
    pub fn depth(&self, point: Vector) -> f32 {
        dot(self.normal, point) - self.offset
    }
}

/// How the model is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// What colours mean.
    pub colour_by: ColourBy,
    /// How numbers become colours.
    pub scale: Scale,
    /// How light falls on faces.
    pub shading: Shading,
    /// What is drawn of the surface.
    pub faces: Faces,
    /// Whether nodes are dotted.
    pub points: bool,
    /// Size of each element about its centre: 1 leaves them together, less pulls them apart.
    pub element_size: f32,
    /// Cut through the volume.
    pub section: Option<Section>,
    /// Whether there is a ground with a shadow.
    pub ground: bool,
    /// Whether held nodes are dotted.
    pub held: bool,
    /// Elements to draw attention to.
    pub marked: Vec<u32>,
}

impl Default for Look {
    fn default() -> Self {
        Look {
            colour_by: ColourBy::Element,
            scale: Scale::default(),
            shading: Shading::Flat,
            faces: Faces::Edged,
            points: false,
            element_size: 1.0,
            section: None,
            ground: true,
            held: true,
            marked: Vec::new(),
        }
    }
}
