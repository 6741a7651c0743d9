//! What a scene's author may rely on: values, defaults, messages, overrides, documentation.

mod catalogue;
mod documentation;
mod errors;
mod example;
mod laws;
mod overrides;
mod robustness;
mod schema;
mod values;
