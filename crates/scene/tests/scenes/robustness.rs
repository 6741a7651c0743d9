//! No text makes the parser panic, and every refusal has a message.

use proptest::prelude::*;
use souple_scene::{canonical_json, parse_with_overrides};

use crate::catalogue::{EXAMPLE, SHORT, catalogue};

/// Parses; what is accepted must also serialise, what is refused must say why.
fn survives(text: &str, overrides: &[&str]) {
    match parse_with_overrides(text, "scene.toml", overrides, &catalogue()) {
        Ok((scene, _)) => assert!(canonical_json(&scene).len() > 100),
        Err(errors) => {
            assert!(!errors.errors.is_empty());
            assert!(errors.errors.iter().all(|error| error.to_line().len() > 10));
        }
    }
}

trait Line {
    fn to_line(&self) -> String;
}

impl Line for souple_scene::SceneError {
    fn to_line(&self) -> String {
        self.in_file("scene.toml")
    }
}

/// Words that a mutation puts in, beside random bytes.
const WORDS: &[&str] = &[
    "\"",
    "[",
    "]",
    "{",
    "}",
    "=",
    ".",
    "\n",
    "#",
    "-",
    "inf",
    "nan",
    "1e999",
    "-1",
    "0",
    "true",
    "[]",
    "{}",
    "\"\"",
    "\"4 kPa\"",
    "\"5 mm\"",
    "99999999999999999999",
    "\u{e9}",
    "\"all\"",
    "body",
    "region",
    "2020-01-01",
    "0x7fffffffffffffff",
    "'''",
    "\"\"\"",
];

fn mutation() -> impl Strategy<Value = (usize, usize, String)> {
    let insert = prop_oneof![
        proptest::sample::select(WORDS).prop_map(str::to_owned),
        proptest::collection::vec(any::<u8>(), 0..4).prop_map(|bytes| String::from_utf8_lossy(&bytes).into_owned()),
    ];
    (any::<usize>(), 0..20_usize, insert)
}

fn mutate(text: &str, mutations: &[(usize, usize, String)]) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for (place, removed, inserted) in mutations {
        let start = place % (bytes.len() + 1);
        let end = (start + removed).min(bytes.len());
        bytes.splice(start..end, inserted.bytes());
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mutated_scenes_never_panic(mutations in proptest::collection::vec(mutation(), 1..5)) {
        survives(&mutate(EXAMPLE, &mutations), &[]);
        survives(&mutate(SHORT, &mutations), &["time.end=2"]);
    }

    #[test]
    fn mutated_overrides_never_panic(mutations in proptest::collection::vec(mutation(), 0..3), which in 0..5_usize) {
        let overrides = ["time.end=0.5", "body.bar.material.0.young=4 kPa", "mesh.size=[1, 2, 3]", "probe.tip.region={ and = [\"all\"] }", "body.0={ name = \"a\" }"];
        survives(EXAMPLE, &[&mutate(overrides[which], &mutations)]);
    }

    #[test]
    fn any_value_anywhere_never_panics(line in 0..60_usize, value in proptest::sample::select(WORDS)) {
        let lines: Vec<String> = EXAMPLE.lines().enumerate().map(|(i, text)| match text.split_once('=') {
            Some((key, _)) if i == line => format!("{key}= {value}"),
            _ => text.to_owned(),
        }).collect();
        survives(&lines.join("\n"), &[]);
    }

    #[test]
    fn any_text_as_a_quantity_never_panics(text in "[-+0-9.eE]{0,6} ?[a-zA-Z%°µ·*/^()0-9⁻² ]{0,14}") {
        let quoted = format!("step = '{text}'");
        survives(&SHORT.replace("step = 0.01", &quoted), &[]);
    }
}

#[test]
fn deep_nesting_is_refused_or_read_without_overflow() {
    for depth in [10, 70, 1_000, 100_000] {
        let region = format!("{}\"all\"{}", "{ not = ".repeat(depth), " }".repeat(depth));
        survives(&SHORT.replace("region = \"all\"", &format!("region = {region}")), &[]);
        survives(SHORT, &[&format!("material.0.region={region}")]);
        survives(SHORT, &[&format!("{}=1", vec!["a"; depth].join("."))]);
        survives(&format!("{}\nx = 1", vec!["a"; depth].join(".") + ".b = 1"), &[]);
        survives(&SHORT.replace("step = 0.01", &format!("step = '4 {}'", "(".repeat(depth))), &[]);
    }
}
