//! The description that a person writes: TOML text in, [`Scene`] out.
//!
//! What it is: schema, units, defaults and validation, with the line of everything that is wrong.
//! What it is not: it opens no file, builds no mesh and knows no constitutive law; the laws' names and parameters come
//! in as a [`Catalogue`], elements and quadratures from the registry of `souple-elements`.
//!
//! ```text
//! text ── node::tree ──► tree with places ── overrides::apply ──► tree ── reader, through the schema ──► Scene
//! ```
//!
//! * [`schema::schema`] is the single table of all keys: it drives the parser and prints `docs/scene.md`
//!   ([`reference::markdown`]).
//! * Every struct of a scene stands in the module of its table, beside its part of the schema: [`time`],
//!   [`integrator`], [`linear_solver`], [`body`], [`mesh`], [`material`], [`motion`], [`load`], [`region`], [`tie`],
//!   [`probe`], [`output`], [`expect`].
//! * [`Spanned`] values remember their place, for errors that only later stages can find.
//!
//! # Spelling
//!
//! ```
//! use souple_scene::{Catalogue, parse};
//! let text = r#"
//! [time]
//! step = "10 ms"          # plain numbers are SI units, texts carry their unit
//! end = 1.0
//! [[body]]
//! name = "bar"
//! density = 1000.0
//! mesh = { generator = "bar", size = [1, 0.1, 0.1], cells = [10, 1, 1], element = "hex8" }
//! [[body.material]]
//! energy = "mu/2*(I1 - 3) - mu*ln(J) + lambda/2*ln(J)^2"
//! mu = "4 kPa"
//! lambda = "40 kPa"
//! [[body.fix]]
//! region = "x_min"
//! "#;
//! let (scene, warnings) = parse(text, "scene.toml", &Catalogue::default()).expect("the scene above is valid");
//! assert_eq!(scene.time.step.value, 0.01);
//! assert!(warnings.is_empty());
//! ```

pub mod body;
pub mod canonical;
pub mod catalogue;
pub mod choice;
pub mod conforming;
pub mod dimension;
pub mod error;
pub mod expect;
pub mod integrator;
pub mod keyframes;
pub mod linear_solver;
pub mod load;
pub mod location;
pub mod material;
pub mod mesh;
pub mod motion;
mod node;
pub mod output;
mod overrides;
pub mod probe;
pub mod range;
mod reader;
pub mod reference;
pub mod region;
pub mod scene;
pub mod schema;
pub mod suggestion;
pub mod tie;
pub mod time;
pub mod units;
pub mod viscosity;

use std::sync::Arc;

pub use canonical::canonical_json;
pub use catalogue::{Catalogue, LawEntry, LawRefusal, ParameterEntry, ParameterShape, ParameterValue};
pub use choice::Named;
pub use error::{Problem, SceneError, SceneErrors, Warning};
pub use location::{Location, Spanned};
pub use range::{Bound, Range};
pub use region::{Region, Selection};
pub use scene::Scene;
pub use schema::schema;

/// Reads a scene.
///
/// `file_name` is only used in messages.
///
/// # Errors
///
/// Everything that is wrong, in the order of the text.
/// When the text is not TOML at all, only that.
pub fn parse(text: &str, file_name: &str, catalogue: &Catalogue) -> Result<(Scene, Vec<Warning>), SceneErrors> {
    parse_with_overrides(text, file_name, &[], catalogue)
}

/// Reads a scene after changing single values, each given as `key=value` (see `docs/scene.md`).
///
/// # Errors
///
/// As [`parse`]; an error about an overridden value names the override instead of a line.
pub fn parse_with_overrides(
    text: &str,
    file_name: &str,
    overrides: &[&str],
    catalogue: &Catalogue,
) -> Result<(Scene, Vec<Warning>), SceneErrors> {
    let refused = |errors| SceneErrors { file_name: file_name.to_owned(), errors };
    let mut root = node::tree(text).map_err(refused)?;
    let mut reader = reader::Reader::new(catalogue);
    for text in overrides {
        let at = Location::Override(Arc::from(*text));
        if let Err(message) = overrides::apply(&mut root, text, &at) {
            reader.error(at, Problem::Override(message));
        }
    }
    let scene = reader.scene(&root);
    if reader.errors.is_empty() {
        reader.warnings.sort_by(|a, b| a.location.cmp(&b.location));
        return Ok((scene.expect("a scene is only given up after an error"), reader.warnings));
    }
    reader.errors.sort_by(|a, b| a.location.cmp(&b.location));
    Err(refused(reader.errors))
}
