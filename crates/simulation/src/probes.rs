//! Measurements on a state, and their comparison with what a scene expects.

use crate::prepare::ProbeRegion;
use crate::system::System;
use crate::tensor::{principal_stretches, von_mises};
use serde::Serialize;
use souple_operators::Average;
use souple_scene::expect::{Component, ExpectedValue};
use souple_scene::probe::{Probe, Quantity};
use souple_solver::SecondOrder;

/// What a probe measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ProbeValue {
    /// One number.
    Scalar(f64),
    /// Three numbers: x, y, z.
    Vector([f64; 3]),
    /// Six numbers of a symmetric tensor: xx, yy, zz, xy, yz, zx.
    Tensor([f64; 6]),
    /// Any number of vectors.
    Vectors(Vec<[f64; 3]>),
}

/// What of a state a quantity is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reads {
    /// Displacements of the probe's nodes.
    Displacements,
    /// Velocities of the probe's nodes.
    Velocities,
    /// Displacements of whole elements: everything, as far as a device is concerned.
    Everything,
}

/// What a quantity reads.
pub(crate) fn reads(quantity: Quantity) -> Reads {
    match quantity {
        Quantity::MeanDisplacement
        | Quantity::MeanPosition
        | Quantity::MaximumDisplacement
        | Quantity::Displacement
        | Quantity::Position
        | Quantity::DeflectionCurve => Reads::Displacements,
        Quantity::MeanVelocity | Quantity::KineticEnergy => Reads::Velocities,
        Quantity::Reaction
        | Quantity::StrainEnergy
        | Quantity::Energy
        | Quantity::Volume
        | Quantity::VolumeRatio
        | Quantity::EnergyDensity
        | Quantity::Strain
        | Quantity::PrincipalStretches
        | Quantity::Stress => Reads::Everything,
    }
}

/// A state to be measured.
pub(crate) struct Measured<'a> {
    pub(crate) system: &'a mut System,
    pub(crate) t: f64,
    pub(crate) u: &'a [f64],
    pub(crate) v: &'a [f64],
}

impl Measured<'_> {
    fn vector(&self, values: &[f64], node: u32) -> [f64; 3] {
        let d = self.system.dimension;
        std::array::from_fn(|k| if k < d { values[node as usize * d + k] } else { 0.0 })
    }

    fn position(&self, node: u32) -> [f64; 3] {
        let (rest, u) = (self.system.nodes[node as usize], self.vector(self.u, node));
        std::array::from_fn(|k| rest[k] + u[k])
    }

    /// Kinetic energy of some nodes in J.
    pub(crate) fn kinetic(&self, nodes: impl Iterator<Item = u32>) -> f64 {
        let d = self.system.dimension;
        nodes
            .flat_map(|n| n as usize * d..(n as usize + 1) * d)
            .map(|k| 0.5 * self.system.mass[k] * self.v[k] * self.v[k])
            .sum()
    }

    fn strain_energy(&mut self, elements: &[u32]) -> f64 {
        let mut total = 0.0;
        self.system.elements.each_energy(self.u, |id, energy| {
            if elements.binary_search(&id).is_ok() {
                total += energy;
            }
        });
        total
    }

    /// Volume of some elements in m³ at displacement `u`.
    fn volume(&mut self, u: &[f64], elements: &[u32]) -> f64 {
        let mut total = 0.0;
        self.system.elements.each_volume(u, |id, volume| {
            if elements.binary_search(&id).is_ok() {
                total += volume;
            }
        });
        total
    }

    /// Mean stress in Pa or strain, weighted by the volumes that the elements' means are of.
    fn mean(&mut self, average: Average, elements: &[u32]) -> [f64; 6] {
        let mut total = [0.0; 6];
        let mut volume = 0.0;
        self.system.elements.each_mean(average, self.u, |id, mean| {
            if elements.binary_search(&id).is_ok() {
                total.iter_mut().zip(mean.tensor).for_each(|(t, s)| *t += mean.volume * s);
                volume += mean.volume;
            }
        });
        total.map(|t| t / volume)
    }

    /// Forces that hold the prescribed unknowns, [node, axis], in N; zero elsewhere.
    pub(crate) fn reactions(&mut self) -> Vec<f64> {
        let mut force = vec![0.0; self.u.len()];
        // The internal force is defined for every state that a step accepted.
        if SecondOrder::force(self.system, self.t, self.u, self.v, &mut force).is_err() {
            force.fill(f64::NAN);
        }
        for (f, &held) in force.iter_mut().zip(&self.system.prescribed) {
            *f = if held { -*f } else { 0.0 };
        }
        force
    }

    /// One quantity on the nodes and elements of a probe.
    pub(crate) fn measure(&mut self, quantity: Quantity, region: &ProbeRegion, probe: &Probe) -> ProbeValue {
        let nodes = &region.nodes;
        match quantity {
            Quantity::MeanDisplacement => ProbeValue::Vector(mean(nodes.iter().map(|&n| self.vector(self.u, n)))),
            Quantity::MeanVelocity => ProbeValue::Vector(mean(nodes.iter().map(|&n| self.vector(self.v, n)))),
            Quantity::MeanPosition => ProbeValue::Vector(mean(nodes.iter().map(|&n| self.position(n)))),
            Quantity::MaximumDisplacement => {
                let length = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
                ProbeValue::Scalar(nodes.iter().map(|&n| length(self.vector(self.u, n))).fold(0.0, f64::max))
            }
            Quantity::Displacement => ProbeValue::Vectors(nodes.iter().map(|&n| self.vector(self.u, n)).collect()),
            Quantity::Position => ProbeValue::Vectors(nodes.iter().map(|&n| self.position(n)).collect()),
            Quantity::DeflectionCurve => ProbeValue::Vectors(self.curve(nodes, probe.axis.index())),
            Quantity::Reaction => {
                let reactions = self.reactions();
                let total = nodes.iter().map(|&n| self.vector(&reactions, n)).fold([0.0; 3], add);
                ProbeValue::Vector(total)
            }
            Quantity::KineticEnergy => ProbeValue::Scalar(self.kinetic(nodes.iter().copied())),
            Quantity::StrainEnergy => ProbeValue::Scalar(self.strain_energy(&region.elements)),
            Quantity::Energy => {
                ProbeValue::Scalar(self.kinetic(nodes.iter().copied()) + self.strain_energy(&region.elements))
            }
            Quantity::Volume => ProbeValue::Scalar(self.volume(self.u, &region.elements)),
            Quantity::VolumeRatio => {
                let rest = vec![0.0; self.u.len()];
                let (now, then) = (self.volume(self.u, &region.elements), self.volume(&rest, &region.elements));
                ProbeValue::Scalar(now / then)
            }
            Quantity::EnergyDensity => {
                let rest = vec![0.0; self.u.len()];
                ProbeValue::Scalar(self.strain_energy(&region.elements) / self.volume(&rest, &region.elements))
            }
            Quantity::Strain => ProbeValue::Tensor(self.mean(Average::Strain, &region.elements)),
            Quantity::PrincipalStretches => {
                ProbeValue::Vector(principal_stretches(self.mean(Average::Strain, &region.elements)))
            }
            Quantity::Stress => ProbeValue::Tensor(self.mean(Average::Stress, &region.elements)),
        }
    }

    /// Mean positions of the nodes that share a rest coordinate, in its order.
    fn curve(&self, nodes: &[u32], axis: usize) -> Vec<[f64; 3]> {
        let at = |n: u32| self.system.nodes[n as usize][axis];
        let mut sorted = nodes.to_vec();
        sorted.sort_by(|&a, &b| at(a).total_cmp(&at(b)).then(a.cmp(&b)));
        let size = sorted.first().zip(sorted.last()).map_or(0.0, |(&a, &b)| at(b) - at(a));
        sorted
            .chunk_by(|&a, &b| at(b) - at(a) <= 1e-9 * size)
            .map(|group| mean(group.iter().map(|&n| self.position(n))))
            .collect()
    }
}

fn add(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

fn mean(vectors: impl ExactSizeIterator<Item = [f64; 3]>) -> [f64; 3] {
    let count = vectors.len() as f64;
    vectors.fold([0.0; 3], add).map(|x| x / count)
}

/// How a measured value compares with an expected one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExpectationResult {
    /// Probe, quantity and component in words.
    pub name: String,
    /// What the scene expects.
    pub expected: Vec<f64>,
    /// What was measured.
    pub got: Vec<f64>,
    /// How far apart they may be.
    pub tolerance: f64,
    /// How far apart they are.
    pub difference: f64,
    /// Whether that is near enough.
    pub passed: bool,
}

impl ExpectationResult {
    pub(crate) fn new(name: String, expected: Vec<f64>, got: Vec<f64>, tolerance: f64) -> ExpectationResult {
        let norm = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>().sqrt();
        let difference = if expected.len() == got.len() {
            norm(&mut expected.iter().zip(&got).map(|(a, b)| a - b))
        } else {
            f64::NAN
        };
        let passed = difference <= tolerance;
        ExpectationResult { name, expected, got, tolerance, difference, passed }
    }

    /// Compares a probe's value with what the scene says of it.
    pub(crate) fn of(expected: &ExpectedValue, probe: &Probe, value: &ProbeValue) -> ExpectationResult {
        let got = pick(value, expected.component, expected.index);
        let size = expected.value.value.iter().map(|x| x * x).sum::<f64>().sqrt();
        let tolerance = expected.tolerance.max(expected.relative_tolerance * size);
        let component = expected.component.map_or(String::new(), |c| format!(" {c}"));
        let index = expected.index.map_or(String::new(), |i| format!(" [{i}]"));
        let name = format!("{}: {}{index}{component}", probe.name.value, expected.quantity);
        ExpectationResult::new(name, expected.value.value.clone(), got, tolerance)
    }
}

/// The numbers of a value that an expectation names; none where the value has no such part.
fn pick(value: &ProbeValue, component: Option<Component>, index: Option<u32>) -> Vec<f64> {
    let of_vector = |v: [f64; 3]| match component {
        None => v.to_vec(),
        Some(Component::X) => vec![v[0]],
        Some(Component::Y) => vec![v[1]],
        Some(Component::Z) => vec![v[2]],
        Some(Component::Magnitude) => vec![v.iter().map(|x| x * x).sum::<f64>().sqrt()],
        Some(_) => Vec::new(),
    };
    let of_tensor = |t: [f64; 6]| match component {
        None => t.to_vec(),
        Some(Component::Xx) => vec![t[0]],
        Some(Component::Yy) => vec![t[1]],
        Some(Component::Zz) => vec![t[2]],
        Some(Component::Xy) => vec![t[3]],
        Some(Component::Yz) => vec![t[4]],
        Some(Component::Zx) => vec![t[5]],
        Some(Component::VonMises) => vec![von_mises(t)],
        Some(_) => Vec::new(),
    };
    match value {
        ProbeValue::Scalar(x) => vec![*x],
        ProbeValue::Vector(v) => of_vector(*v),
        ProbeValue::Tensor(t) => of_tensor(*t),
        ProbeValue::Vectors(list) => index.and_then(|i| list.get(i as usize)).map_or_else(Vec::new, |v| of_vector(*v)),
    }
}
