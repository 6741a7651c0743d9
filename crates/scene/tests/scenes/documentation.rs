//! The reference says what the parser does.

use crate::catalogue::read;

#[test]
#[expect(clippy::disallowed_methods, reason = "the test compares a file of the repository, and rewrites it when asked")]
fn the_reference_in_docs_is_printed_from_the_schema() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scene.md");
    let expected = souple_scene::reference::markdown();
    if std::env::var_os("SOUPLE_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(path, &expected).unwrap();
    }
    let found = std::fs::read_to_string(path).unwrap_or_default();
    let difference = expected.lines().zip(found.lines()).position(|(a, b)| a != b);
    assert!(
        expected == found,
        "docs/scene.md differs from the schema (line {difference:?}); SOUPLE_BLESS=1 rewrites it"
    );
}

#[test]
fn every_key_of_the_schema_is_in_the_reference() {
    let text = souple_scene::reference::markdown();
    for section in souple_scene::schema() {
        let heading = section.header.trim_start_matches(|c: char| c.is_lowercase());
        assert!(text.contains(heading), "{}", section.header);
        for key in section.keys {
            assert!(text.contains(&format!("| `{}` |", key.name)), "{} {}", section.header, key.name);
        }
    }
}

#[test]
fn the_example_of_the_reference_is_a_valid_scene() {
    let text = souple_scene::reference::markdown();
    let example = text.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    read(example).unwrap();
}
