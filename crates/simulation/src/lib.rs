//! The one door for applications: from a scene to a model, from a model to states, probes and results.

pub mod prepare;
