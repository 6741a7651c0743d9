//! What the address of a page asks for: `?scene=mixed_bar&at=0.5`.
//!
//! Nothing here knows a browser.

use std::path::PathBuf;

/// What a page begins with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Asked {
    /// The scene; without it, the bundled ones are offered.
    pub scene: Option<PathBuf>,
    /// Simulated time in s at which the scene stands still; without it, it goes on.
    pub at: Option<f64>,
}

/// Reads what follows the address, with or without its question mark.
///
/// # Errors
/// Which part is not understood, what was expected, and what there is.
pub fn read(query: &str) -> Result<Asked, String> {
    let mut asked = Asked::default();
    for part in query.trim_start_matches('?').split('&').filter(|p| !p.is_empty()) {
        let (key, value) = part.split_once('=').unwrap_or((part, ""));
        match key {
            // A name, not a path: the bundled scenes lie in one folder.
            "scene" if !value.is_empty() && value.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') => {
                asked.scene = Some(PathBuf::from(format!("scenes/{value}.toml")));
            }
            "scene" => {
                return Err(format!("expected the name of a bundled scene, like scene=mixed_bar, found `{part}`"));
            }
            "at" => {
                let time = value.parse().ok().filter(|t: &f64| t.is_finite() && *t >= 0.0);
                let expected = || format!("expected a simulated time in s, at least 0, like at=0.5, found `{part}`");
                asked.at = Some(time.ok_or_else(expected)?);
            }
            _ => return Err(format!("`{key}` says nothing to this page; what it knows is scene=NAME and at=SECONDS")),
        }
    }
    if asked.at.is_some() && asked.scene.is_none() {
        return Err("at=SECONDS needs a scene, like scene=mixed_bar&at=0.5".into());
    }
    Ok(asked)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene and a time are read, in any order, and nothing is an empty wish.
    #[test]
    fn scene_and_time_are_read() {
        let bar = Some(PathBuf::from("scenes/mixed_bar.toml"));
        assert_eq!(read(""), Ok(Asked::default()));
        assert_eq!(read("?scene=mixed_bar"), Ok(Asked { scene: bar.clone(), at: None }));
        assert_eq!(read("?at=0.5&scene=mixed_bar"), Ok(Asked { scene: bar, at: Some(0.5) }));
    }

    /// What is not understood is named, with what was expected.
    #[test]
    fn mistakes_are_named() {
        for (query, word) in [
            ("?scene=../secret", "mixed_bar"),
            ("?scene", "mixed_bar"),
            ("?scene=organ&at=soon", "at=soon"),
            ("?scene=organ&at=-1", "at least 0"),
            ("?scene=organ&at=inf", "at=inf"),
            ("?speed=2", "`speed`"),
            ("?at=1", "needs a scene"),
        ] {
            let message = read(query).unwrap_err();
            assert!(message.contains(word), "{query}: {message}");
        }
    }
}
