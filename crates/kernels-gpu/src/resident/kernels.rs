//! The kernels of vectors: texts with what they are given. Programs of items have their own.

use crate::device::{DeviceError, Gpu, Pipeline};
use std::fmt::Write as _;

/// Invocations of a workgroup of these kernels.
pub(super) const WORKGROUP: usize = 256;
/// Workgroups that a sum is split into, at most: enough to fill a device, few enough for one workgroup to add their parts.
pub(super) const MOST_GROUPS: usize = 1024;
/// Unknowns that each invocation of a sum has at least, if there are enough: every workgroup costs whoever adds them.
pub(super) const PER_INVOCATION: usize = 4;
/// Sums that are kept apart.
const SLOTS: usize = 6;
/// Bytes of the parts of all sums.
pub(super) const SUM_BYTES: u64 = (SLOTS * MOST_GROUPS * 8) as u64;
/// Numbers of the record of a solve.
pub(super) const CONTROL_WORDS: usize = 16;

/// Something that a kernel reads or writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Slot {
    Parameters,
    Control,
    Sums,
    U,
    ULow,
    V,
    A,
    R,
    P,
    Q,
    S,
    Mass,
    Constant,
    Inverse,
    Blocks,
    Contributions,
    Starts,
    Places,
    Segment,
    Result,
    Moved,
    Targets,
    Loaded,
    LoadValues,
    LoadFactor,
    Values,
    Judged,
}

impl Slot {
    fn declaration(self) -> (&'static str, &'static str) {
        match self {
            Slot::Parameters => ("parameters", "Parameters"),
            Slot::Control => ("control", "Control"),
            Slot::Sums => ("sums", "array<vec2<f32>>"),
            Slot::U => ("u", "array<f32>"),
            Slot::ULow => ("u_low", "array<f32>"),
            Slot::V => ("v", "array<f32>"),
            Slot::A => ("a", "array<f32>"),
            Slot::R => ("r", "array<f32>"),
            Slot::P => ("p", "array<f32>"),
            Slot::Q => ("q", "array<f32>"),
            Slot::S => ("s", "array<f32>"),
            Slot::Mass => ("mass", "array<f32>"),
            Slot::Constant => ("constant_force", "array<f32>"),
            Slot::Inverse => ("inverse", "array<f32>"),
            Slot::Blocks => ("blocks", "array<f32>"),
            Slot::Contributions => ("contributions", "array<f32>"),
            Slot::Starts => ("starts", "array<u32>"),
            Slot::Places => ("places", "array<u32>"),
            Slot::Segment => ("segment", "array<u32>"),
            Slot::Result => ("result", "array<f32>"),
            Slot::Moved => ("moved", "array<u32>"),
            Slot::Targets => ("targets", "array<f32>"),
            Slot::Loaded => ("loaded", "array<u32>"),
            Slot::LoadValues => ("load_values", "array<f32>"),
            Slot::LoadFactor => ("load_factor", "array<f32>"),
            Slot::Values => ("values", "array<f32>"),
            Slot::Judged => ("judged", "array<f32>"),
        }
    }
}

/// A kernel: its name, what it reads, what it writes, its text, and whether it sums or preconditions.
pub(super) struct Text {
    pub(super) name: &'static str,
    pub(super) reads: &'static [Slot],
    pub(super) writes: &'static [Slot],
    body: &'static str,
}

macro_rules! text {
    ($name:literal, [$($reads:ident)*], [$($writes:ident)*]) => {
        Text {
            name: $name,
            reads: &[$(Slot::$reads),*],
            writes: &[$(Slot::$writes),*],
            body: include_str!(concat!("kernels/", $name, ".wgsl")),
        }
    };
}

pub(super) const GATHER: Text = text!("gather", [Contributions Starts Places Segment], [Result]);
pub(super) const PRODUCT: Text = text!("product", [Contributions Starts Places Segment Parameters P Mass], [Q Sums]);
pub(super) const BEGIN: Text = text!("begin", [Parameters V Mass], [P S]);
pub(super) const MOVED: Text = text!("moved", [Parameters Moved Targets U ULow], [P S]);
pub(super) const MOVED_END: Text = text!("moved_end", [Moved Targets Control], [U ULow V]);
pub(super) const LOAD: Text = text!("load", [Loaded LoadValues LoadFactor], [R]);
pub(super) const RIGHT: Text = text!("right", [Parameters Constant Mass Q], [R S Sums]);
pub(super) const EXPLICIT: Text = text!("explicit", [Parameters R Mass], [A Control]);
pub(super) const INVERSE: Text = text!("inverse", [Parameters Segment Blocks Mass], [Inverse]);
pub(super) const RESIDUAL: Text = text!("residual", [Parameters Q], [R]);
pub(super) const DIRECTION: Text = text!("direction", [Parameters R Inverse], [P Sums]);
pub(super) const OPEN: Text = text!("open", [Parameters Sums], [Control]);
pub(super) const DESCEND: Text = text!("descend", [Parameters P Q Inverse], [A R Sums Control]);
pub(super) const ADVANCE: Text = text!("advance", [Parameters R Inverse Sums], [P Control]);
pub(super) const FINISH: Text = text!("finish", [Parameters Control Mass S Inverse], [A U ULow V]);
pub(super) const ENERGY: Text = text!("energy", [Parameters Mass U V], [Sums]);
pub(super) const JUDGE: Text = text!("judge", [Values], [Result]);
pub(super) const PICK: Text = text!("pick", [Places Segment U ULow], [Result]);
pub(super) const CLOSE: Text = text!("close", [Parameters Sums], [Control Judged]);

impl Text {
    /// The whole text, with only what it needs.
    fn source(&self) -> String {
        let mut out = String::from(include_str!("kernels/common.wgsl"));
        let _ = writeln!(out, "\nconst LANES: u32 = {}u;\n", crate::kernel::WORKGROUP);
        for (number, slot) in self.reads.iter().chain(self.writes).enumerate() {
            let access = if number < self.reads.len() { "read" } else { "read_write" };
            let (name, kind) = slot.declaration();
            let _ = writeln!(out, "@group(0) @binding({number}) var<storage, {access}> {name}: {kind};");
        }
        let uses = |slot: Slot| self.reads.contains(&slot) || self.writes.contains(&slot);
        if self.writes.contains(&Slot::Sums) {
            out.push_str(include_str!("kernels/leave.wgsl"));
        }
        if uses(Slot::Sums) && uses(Slot::Parameters) {
            out.push_str(include_str!("kernels/collect.wgsl"));
        }
        if uses(Slot::Inverse) && uses(Slot::R) {
            out.push_str(include_str!("kernels/precondition.wgsl"));
        }
        match self.body.split_once(") {\n") {
            // Every kernel begins with its only function of this form.
            Some((head, rest)) if uses(Slot::Parameters) && self.name != "inverse" => {
                let _ = write!(out, "{head}) {{\n    nothing = parameters.nothing;\n{rest}");
            }
            _ => out.push_str(self.body),
        }
        out
    }

    /// Compiles it.
    pub(super) fn compile(&self, gpu: &Gpu) -> Result<Pipeline, DeviceError> {
        let writable: Vec<bool> = (0..self.reads.len() + self.writes.len()).map(|k| k >= self.reads.len()).collect();
        gpu.compile(self.name, &self.source(), Some("main"), &writable)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::OpenError;

    /// Every kernel of vectors is accepted by the device's compiler.
    #[expect(clippy::disallowed_macros, reason = "a test that finds no adapter says so")]
    #[test]
    fn every_kernel_compiles() {
        let gpu = match Gpu::open("", None) {
            Ok(gpu) => gpu,
            Err(OpenError::None) => return println!("skipped: no adapter"),
            Err(error) => panic!("{error}"),
        };
        let all = [
            GATHER, PRODUCT, BEGIN, MOVED, MOVED_END, LOAD, RIGHT, EXPLICIT, INVERSE, RESIDUAL, DIRECTION, OPEN,
            DESCEND, ADVANCE, FINISH, ENERGY, JUDGE, PICK, CLOSE,
        ];
        for text in all {
            if let Err(error) = text.compile(&gpu) {
                panic!("{error}\n{}", text.source());
            }
        }
    }
}
