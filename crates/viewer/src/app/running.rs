//! A scene that runs in the window: its session, its model, and what a person has chosen.

use crate::camera::Camera;
use crate::colouring::{ColourBy, Legend};
use crate::draw::frame::{Faceted, bounds};
use crate::geometry::Vector;
use crate::look::Look;
use crate::model::Model;
use souple_simulation::session::{Change, Command, Sample, Session, Snapshot};
use souple_simulation::{ElementField, Simulation};
use std::collections::VecDeque;
use std::path::PathBuf;

/// Steps whose numbers are kept for plots.
const SAMPLES: usize = 2000;

/// What the left button does on the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hand {
    /// Takes a point and pulls.
    Pull,
    /// Moves the tool.
    Push,
    /// Holds the face.
    Hold,
    /// Lets the face go.
    Free,
}

/// A spring in the hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Grip {
    /// Nodes with weights.
    pub anchor: Vec<(u32, f64)>,
    /// Where the other end is, in m.
    pub target: Vector,
}

/// A block of like elements, for sliders.
#[derive(Clone, Debug)]
pub struct Block {
    /// Kind of elements and law.
    pub name: String,
    /// Parameters of the law: name, unit.
    pub parameters: Vec<(&'static str, &'static str)>,
}

/// The named regions of a simulation, with their nodes.
pub fn regions(simulation: &Simulation) -> Vec<(String, Vec<u32>)> {
    let mut regions = Vec::new();
    for body in &simulation.prepared().bodies {
        for (name, region) in &body.mesh.regions {
            let mut nodes: Vec<u32> = region.nodes.iter().map(|n| n + body.first_node).collect();
            for &element in &region.elements {
                nodes.extend(body.mesh.nodes_of(element).iter().map(|n| n + body.first_node));
            }
            nodes.sort_unstable();
            nodes.dedup();
            if !nodes.is_empty() {
                regions.push((format!("{name} of {}", body.name), nodes));
            }
        }
    }
    regions
}

/// The blocks of a simulation.
pub fn blocks(simulation: &Simulation) -> Vec<Block> {
    let describe = |block: &_| -> Block { described(block) };
    simulation.prepared().blocks.iter().map(describe).collect()
}

fn described(block: &souple_simulation::BlockSpec) -> Block {
    Block {
        name: format!("{}, {}", block.element.id, block.law.id),
        parameters: block.law.parameters.iter().map(|p| (p.name, p.unit)).collect(),
    }
}

/// A scene that runs.
pub struct Running {
    /// Its file.
    pub path: PathBuf,
    /// The simulation's thread.
    pub session: Session,
    /// What there is to draw.
    pub model: Model,
    /// The newest snapshot.
    pub snapshot: Snapshot,
    /// Numbers of the last steps.
    pub samples: VecDeque<Sample>,
    /// How the model is shown.
    pub look: Look,
    /// From where.
    pub camera: Camera,
    /// Ratio of width to height of the view.
    pub aspect: f32,
    /// Where the view is in the window.
    pub(crate) area: egui::Rect,
    /// What the left button does.
    pub hand: Hand,
    /// The spring in the hand.
    pub grip: Option<Grip>,
    /// Stiffness of the spring in the hand in N/m.
    pub pull_stiffness: f64,
    /// The tool, when it is out.
    pub tool: Option<souple_simulation::interaction::Tool>,
    /// Time in s of the last move of the tool, for its velocity.
    pub(crate) tool_moved: f64,
    /// Whether the tool is a capsule.
    pub(crate) capsule: bool,
    /// Section: axis, share of the box, whether it is on, and which side is hidden.
    pub cut: Cut,
    /// Named regions with their nodes.
    pub(crate) regions: Vec<(String, Vec<u32>)>,
    pub(crate) region: usize,
    pub(crate) blocks: Vec<Block>,
    /// What explains the colours.
    pub(crate) legend: Legend,
    /// What is under the pointer, in words.
    pub(crate) probe: String,
    pub(crate) whole: Faceted,
    pub(crate) apart: Option<Faceted>,
    /// What the device holds.
    pub(crate) drawn: Option<FrameKey>,
    /// The view must be drawn whole once its size is known.
    pub(crate) fit: bool,
    /// Height of the ground along the camera's upward axis.
    pub(crate) ground: f32,
    /// Time the last picture took in ms.
    pub(crate) draw_ms: f64,
    /// An animation that is being recorded.
    pub(crate) animation: Option<crate::animation::Animation>,
    pub(crate) message: String,
    pub(crate) folder: String,
    /// The chosen speed in words.
    pub(crate) speed: &'static str,
    watched: Option<ElementField>,
}

/// What a drawn frame follows from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameKey {
    pub(crate) snapshot: u64,
    pub(crate) look: Look,
    pub(crate) tool: Option<souple_simulation::interaction::Tool>,
}

/// The section as people turn it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    /// Whether there is one.
    pub on: bool,
    /// Across which axis.
    pub axis: usize,
    /// Where along the body, from 0 to 1.
    pub share: f32,
    /// Whether what lies towards the lower end is hidden.
    pub flipped: bool,
}

impl Running {
    /// A session as it starts.
    pub fn new(
        path: PathBuf,
        session: Session,
        model: Model,
        regions: Vec<(String, Vec<u32>)>,
        blocks: Vec<Block>,
    ) -> Running {
        let all = bounds(&model.rest);
        let camera = Camera::around(all[0], all[1], model.up);
        let whole = Faceted::whole(&model);
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Running {
            ground: crate::draw::studio::ground_below(&model.rest, &camera),
            snapshot: Snapshot { positions: model.rest.clone(), ..Snapshot::default() },
            path,
            session,
            model,
            samples: VecDeque::new(),
            look: Look::default(),
            camera,
            aspect: 1.0,
            area: egui::Rect::NOTHING,
            hand: Hand::Pull,
            grip: None,
            pull_stiffness: 100.0,
            tool: None,
            tool_moved: 0.0,
            capsule: false,
            cut: Cut { on: false, axis: 2, share: 0.5, flipped: false },
            regions,
            region: 0,
            blocks,
            legend: Legend::None,
            probe: String::new(),
            whole,
            apart: None,
            drawn: None,
            fit: true,
            draw_ms: 0.0,
            animation: None,
            message: String::new(),
            folder: format!("out/{name}"),
            speed: "real time",
            watched: None,
        }
    }

    pub(crate) fn speed_name(&self) -> &'static str {
        self.speed
    }

    /// Asks the simulation to change something.
    pub fn change(&self, change: Change) {
        self.session.send(Command::Change(change));
    }

    /// Takes what the simulation has for the window, and tells it which field is wanted.
    pub(crate) fn renew(&mut self) {
        let newest = self.session.snapshot();
        let unset = newest.positions.is_empty();
        if !unset && newest.number != self.snapshot.number {
            self.snapshot.clone_from(newest);
        }
        self.samples.extend(self.session.samples());
        let surplus = self.samples.len().saturating_sub(SAMPLES);
        self.samples.drain(..surplus);
        let wanted = match self.look.colour_by {
            ColourBy::Field(field) => Some(field),
            _ => None,
        };
        if wanted != self.watched {
            self.session.send(Command::Watch(wanted.into_iter().collect()));
            self.watched = wanted;
        }
    }

    /// The values that colours show, one per element; none when they show no field, or it has not come yet.
    pub(crate) fn field(&self) -> &[f32] {
        let ColourBy::Field(field) = self.look.colour_by else { return &[] };
        self.snapshot.field(field).unwrap_or(&[])
    }

    /// The nodes that are held now: those of the scene that were not let go, and those that were held by hand.
    pub(crate) fn held(&self) -> Vec<u32> {
        let Some(controls) = &self.snapshot.controls else { return self.model.fixed.clone() };
        let fixed = self.model.fixed.iter().copied().filter(|n| !controls.freed.contains(n));
        fixed.chain(controls.held.keys().copied()).collect()
    }

    /// Diagonal of the box around the model at rest, in m.
    pub(crate) fn extent(&self) -> f32 {
        let [low, high] = bounds(&self.model.rest);
        crate::geometry::length(crate::geometry::minus(high, low)).max(1e-9)
    }
}
