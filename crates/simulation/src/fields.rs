//! Values of the present state, for whoever draws it: positions per node, one number per element.
//!
//! Elements are numbered as in [`BlockSpec::ids`](souple_operators::BlockSpec): those of all bodies, one after the other.

use crate::run::{RunError, Simulation, open_device};
use crate::tensor::{principal_stretches, von_mises};
use souple_operators::Average;
use souple_program::Costs;

/// What can be computed for every element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementField {
    /// Von Mises stress of the mean Cauchy stress, in Pa.
    VonMises,
    /// Deformed volume over volume at rest: the element's mean J.
    VolumeRatio,
    /// Smallest volume ratio at the quadrature points: not positive where the element is inside out.
    SmallestJ,
    /// Strain energy per volume at rest, in J/m³.
    EnergyDensity,
    /// Largest principal stretch of the mean strain.
    LargestStretch,
    /// Smallest principal stretch of the mean strain.
    SmallestStretch,
    /// R_L: how much the edge that changed most changed its length.
    LengthChange,
    /// R_A: how much the area or volume changed.
    VolumeChange,
    /// R_S: mean over the element of the sizes of its nodal forces, in N.
    MeanForce,
}

impl ElementField {
    /// Every field.
    pub const ALL: [ElementField; 9] = [
        ElementField::VonMises,
        ElementField::VolumeRatio,
        ElementField::SmallestJ,
        ElementField::EnergyDensity,
        ElementField::LargestStretch,
        ElementField::SmallestStretch,
        ElementField::LengthChange,
        ElementField::VolumeChange,
        ElementField::MeanForce,
    ];

    /// What people read.
    pub fn name(self) -> &'static str {
        match self {
            ElementField::VonMises => "von Mises stress",
            ElementField::VolumeRatio => "volume ratio",
            ElementField::SmallestJ => "smallest J",
            ElementField::EnergyDensity => "energy density",
            ElementField::LargestStretch => "largest stretch",
            ElementField::SmallestStretch => "smallest stretch",
            ElementField::LengthChange => "R_L, change of edge length",
            ElementField::VolumeChange => "R_A, change of area or volume",
            ElementField::MeanForce => "R_S, mean nodal force",
        }
    }

    /// SI unit; empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            ElementField::VonMises => "Pa",
            ElementField::EnergyDensity => "J/m³",
            ElementField::MeanForce => "N",
            _ => "",
        }
    }
}

impl Simulation {
    /// Positions of all nodes in m, [node][axis]; axes that the scene does not have stay at rest.
    pub fn positions(&self) -> Vec<[f64; 3]> {
        let d = self.system.dimension;
        let moved = self.prepared.nodes.iter().zip(self.present().u.chunks(d));
        moved.map(|(rest, u)| std::array::from_fn(|k| rest[k] + u.get(k).copied().unwrap_or(0.0))).collect()
    }

    /// One value per element.
    ///
    /// # Errors
    /// When the device refuses the program that computes it.
    pub fn element_field(&mut self, field: ElementField) -> Result<Vec<f64>, RunError> {
        self.fetch();
        match field {
            ElementField::LengthChange => return Ok(self.length_changes()),
            ElementField::MeanForce => return Ok(self.mean_forces()),
            _ => {}
        }
        let mut values = vec![0.0; self.element_count()];
        let average = match field {
            ElementField::VonMises => Some(Average::Stress),
            ElementField::LargestStretch | ElementField::SmallestStretch => Some(Average::Strain),
            _ => None,
        };
        if let Some(average) = average {
            self.prepare_mean(average)?;
        }
        let elements = &mut self.system.elements;
        let (u, rest) = (&self.state.u, vec![0.0; self.state.u.len()]);
        match (field, average) {
            (_, Some(average)) => elements.each_mean(average, u, |id, mean| {
                let stretches = || principal_stretches(mean.tensor);
                values[id as usize] = match field {
                    ElementField::LargestStretch => stretches().into_iter().fold(f64::NEG_INFINITY, f64::max),
                    ElementField::SmallestStretch => stretches().into_iter().fold(f64::INFINITY, f64::min),
                    _ => von_mises(mean.tensor),
                };
            }),
            (ElementField::EnergyDensity, _) => {
                elements.each_energy(u, |id, energy| values[id as usize] = energy);
                elements.each_volume(&rest, |id, volume| values[id as usize] /= volume);
            }
            (ElementField::SmallestJ, _) => {
                elements.crushed(u, f64::INFINITY).into_iter().for_each(|(id, j)| values[id as usize] = j);
            }
            _ => {
                elements.each_volume(u, |id, volume| values[id as usize] = volume);
                elements.each_volume(&rest, |id, volume| values[id as usize] /= volume);
                if field == ElementField::VolumeChange {
                    values.iter_mut().for_each(|v| *v = (*v - 1.0).abs());
                }
            }
        }
        Ok(values)
    }

    /// Which rows of the matrix each element belongs to: the number of the part that its first node's row is in. Parts
    /// are what threads share when they multiply with the matrix; they follow from the mesh alone, not from the number of
    /// threads. Without a matrix there is one part.
    pub fn parts_of_elements(&self) -> Vec<u32> {
        let ends = self.system.ends_of_parts();
        let mut parts = vec![0; self.element_count()];
        for block in &self.prepared.blocks {
            let nodes = block.connectivity.chunks(block.element.node_count());
            for (&id, nodes) in block.ids.iter().zip(nodes) {
                let first = nodes.iter().min().map_or(0, |&n| n as usize);
                parts[id as usize] = ends.partition_point(|&end| end <= first) as u32;
            }
        }
        parts
    }

    /// Strain energy of all elements in J.
    pub fn strain_energy(&mut self) -> f64 {
        self.fetch();
        self.system.elements.energy(&self.state.u)
    }

    /// Elements that are inside out somewhere, by number, worst first.
    pub fn inverted_elements(&mut self) -> Vec<u32> {
        self.fetch();
        self.system.elements.crushed(&self.state.u, 0.0).into_iter().map(|(id, _)| id).collect()
    }

    /// Derives and compiles a mean when it is first asked for.
    fn prepare_mean(&mut self, average: Average) -> Result<(), RunError> {
        if self.prepared_means.contains(&average) {
            return Ok(());
        }
        let refuse = |message: String| RunError { message };
        let device = open_device(&self.device_name).map_err(|e| refuse(e.to_string()))?;
        self.system
            .elements
            .prepare_means(&[average], &*device, Costs::default())
            .map_err(|e| refuse(format!("{average:?} cannot be computed here: {e}")))?;
        self.prepared_means.push(average);
        Ok(())
    }
}
