//! A build without graphics devices.

use super::{OfNodes, StepError, Stepped, Transfers};
use crate::gpu::report::AdapterReport;
use crate::phases::PhaseTimes;
use crate::prepare::Prepared;
use crate::run::LoadError;
use crate::system::System;
use souple_scene::Scene;
use souple_solver::step::State;

/// Adapters of this machine: none that this build could see.
pub(crate) fn adapters() -> Option<Vec<AdapterReport>> {
    None
}

/// Nodes that are read by themselves: there are none.
pub(crate) enum Rows {}

/// A simulation on a device: there is none.
pub(crate) enum OnDevice {}

impl OnDevice {
    pub(crate) fn load(
        name: &str,
        _: &Scene,
        _: &str,
        _: &System,
        _: &Prepared,
        _: &mut Vec<String>,
    ) -> Result<OnDevice, LoadError> {
        Err(LoadError::Refused(format!(
            "this build has no graphics devices, so there is no `gpu:{name}`: build with the feature `gpu` (it is on unless \
             `--no-default-features` is given), or use --device cpu"
        )))
    }

    pub(crate) fn description(&self) -> String {
        match *self {}
    }

    pub(crate) fn transfers(&self) -> Transfers {
        match *self {}
    }

    pub(crate) fn write(&mut self, _: &State) {
        match *self {}
    }

    pub(crate) fn read(&self) -> Result<State, String> {
        match *self {}
    }

    pub(crate) fn rows(&self, _: &[u32]) -> Result<Rows, String> {
        match *self {}
    }

    pub(crate) fn read_rows(&self, _: &Rows, _: OfNodes) -> Result<Vec<f64>, String> {
        match *self {}
    }

    pub(crate) fn undo(&mut self) -> Result<(), String> {
        match *self {}
    }

    pub(crate) fn watch(&mut self) {
        match *self {}
    }

    pub(crate) fn phases(&self) -> Option<PhaseTimes> {
        match *self {}
    }

    pub(crate) fn lose(&mut self) {
        match *self {}
    }

    pub(crate) fn step(&mut self, _: &Scene, _: &System, _: f64) -> Result<Stepped, StepError> {
        match *self {}
    }
}
