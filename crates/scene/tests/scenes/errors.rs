//! Every mistake gives one message at its place that says what was expected.

use crate::catalogue::{EXAMPLE, SHORT, messages, read};

/// Asserts for each (from, to, message) that replacing the first `from` by `to` gives exactly one message.
///
/// The message starts with its place, `line:column: `; or the place is the `¦` in `to`, which is taken out.
fn each_replaced(text: &str, cases: &[(&str, &str, &str)]) {
    let mut failures = Vec::new();
    for (from, to, message) in cases {
        assert!(text.contains(from), "the test's scene lacks {from:?}");
        let marked = text.replacen(from, to, 1);
        let place = marked.split_once('¦').map_or(String::new(), |(before, _)| {
            let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
            format!("{}:{column}: ", before.matches('\n').count() + 1)
        });
        let expected = format!("scene.toml:{place}{message}");
        let found = messages(&marked.replacen('¦', "", 1));
        if found.len() != 1 || !found[0].starts_with(&expected) {
            failures.push(format!("{to}\n  expected {expected}\n  found {found:#?}"));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// As [`each_replaced`], for (lines after the short scene, message).
fn each_added(cases: &[(String, &str)]) {
    let text = format!("{SHORT}+");
    let cases: Vec<(&str, &str, &str)> = cases.iter().map(|(lines, message)| ("+", lines.as_str(), *message)).collect();
    each_replaced(&text, &cases);
}

#[test]
fn unknown_keys_and_words_are_met_with_the_nearest_that_exist() {
    each_replaced(
        SHORT,
        &[
            (
                "density = 1000.0",
                "density = 1000.0\ndensty = 1",
                "7:1: unknown key `densty` in [[body]]; did you mean `density`?",
            ),
            (
                "step = 0.01",
                "step = 0.01\ntitle = \"x\"",
                "3:1: unknown key `title` in [time]; it belongs to the scene",
            ),
            ("step = 0.01", "step = 0.01\nqqqqq = 1", "3:1: unknown key `qqqqq` in [time]; its keys: step, end, stop"),
            (
                "[time]",
                "[integrator]\nmethod = \"implict-euler\"\n[time]",
                "2:10: unknown method `implict-euler`; did you mean `implicit-euler`?; known: explicit-euler, symplectic-euler, rk2, rk4, implicit-euler, implicit-midpoint, bdf2, newmark, quasi-static",
            ),
            (
                "[time]",
                "[linear_solver]\nmethod = \"cgg\"\n[time]",
                "2:10: unknown method `cgg`; did you mean `cg`?; known: cg, direct",
            ),
            (
                "[time]",
                "[linear_solver]\npreconditioner = \"jacobbi\"\n[time]",
                "2:18: unknown preconditioner `jacobbi`; did you mean `jacobi`?",
            ),
            (
                "[time]",
                "[output]\nformat = \"vtk\"\n[time]",
                "2:10: unknown format `vtk`; did you mean `vtu`?; known: vtu, none",
            ),
            (
                "[time]",
                "[output]\nfields = [\"displacement\", \"stres\"]\n[time]",
                "2:27: unknown word in `fields`: `stres`; did you mean `stress`?",
            ),
            ("\"hex8\"", "¦\"hexa8\"", "unknown element `hexa8`; did you mean `hex8`?; known: edge2, "),
            ("\"bar\", size", "¦\"baar\", size", "unknown generator `baar`; did you mean `bar`?; known: bar"),
            (
                "region = \"all\"",
                "region = { element = \"hex9\" }",
                "9:22: unknown element `hex9`; did you mean `hex8`?",
            ),
            (
                "region = \"all\"",
                "region = { ball = 1 }",
                "9:12: unknown key `ball` in a region; its keys: element, box, sphere, plane, near_surface, and, or, not",
            ),
        ],
    );
    each_replaced(
        EXAMPLE,
        &[(
            "\"mean displacement\"",
            "¦\"mean displacment\"",
            "unknown quantity `mean displacment`; did you mean `mean displacement`?; known: ",
        )],
    );
}

#[test]
fn values_of_the_wrong_type_say_what_was_expected_and_found() {
    each_replaced(
        SHORT,
        &[
            ("step = 0.01", "step = true", "2:8: `step` must be a number in s or a text such as \"10 ms\", found true"),
            (
                "step = 0.01",
                "step = \"5 mm\"",
                "2:8: `step`: expected a time such as \"10 ms\", found `5 mm`, which is a length",
            ),
            (
                "step = 0.01",
                "step = \"10\"",
                "2:8: `step`: `10` has no unit; write the number without quotes for s, or with its unit as in \"10 ms\"",
            ),
            ("step = 0.01", "step = \"10 mss\"", "2:8: `step`: unknown unit `mss`"),
            (
                "step = 0.01",
                "step = 2020-01-01",
                "2:8: `step` must be a number in s or a text such as \"10 ms\", found the date or time 2020-01-01",
            ),
            ("\"bar\"\n", "3\n", "5:8: `name` must be a text in quotes, found the number 3"),
            ("[2, 2, 2]", "¦[2, 2]", "`cells` must be a list of three whole numbers, found a list of 2 values"),
            ("[2, 2, 2]", "[2, ¦2.5, 2]", "`cells` must be a whole number, found the number 2.5"),
            ("[1, 1, 1]", "¦1", "`size` must be a list of three numbers (length [m]), found the number 1"),
            (
                "[1, 1, 1]",
                "[1, 1, ¦\"2 s\"]",
                "`size`: expected a length such as \"5 mm\", found `2 s`, which is a time",
            ),
            ("region = \"all\"", "region = 3", "9:10: `region` must be a region: \"all\", a name, or a table"),
            ("[[body]]", "[body]", "4:1: `body` must be a list of tables, each starting with [[body]], found a table"),
            ("[time]", "[output]\nfields = \"stress\"\n[time]", "2:10: `fields` must be a list of \"displacement\""),
            (
                "[time]",
                "[integrator]\nline_search = 1\n[time]",
                "2:15: `line_search` must be true or false, found the number 1",
            ),
            ("[time]", "[integrator]\nrayleigh = 1\n[time]", "2:12: `rayleigh` must be a table (damping matrix"),
        ],
    );
}

#[test]
fn values_out_of_range_say_the_range() {
    each_replaced(
        SHORT,
        &[
            ("step = 0.01", "step = 0", "2:8: `step` must be greater than 0 s, found 0"),
            ("step = 0.01", "step = -0.01", "2:8: `step` must be greater than 0 s, found -0.01"),
            ("step = 0.01", "step = inf", "2:8: `step` must be a finite number, found inf"),
            ("step = 0.01", "step = nan", "2:8: `step` must be a finite number, found NaN"),
            ("step = 0.01", "step = \"1e999 s\"", "2:8: `step` must be a finite number, found \"1e999 s\""),
            ("end = 1.0", "end = 0.001", "3:7: `end` must be at least one step of 0.01 s, found 0.001 s"),
            ("1000.0", "-1000.0", "6:11: `density` must be greater than 0 kg/m^3, found -1000"),
            ("[2, 2, 2]", "[2, ¦0, 2]", "`cells` must be at least 1, found 0"),
            ("[2, 2, 2]", "[2, ¦99999999999, 2]", "`cells` must be at least 1, found 99999999999"),
            ("[1, 1, 1]", "[1, ¦-1, 1]", "`size` must be greater than 0 m, found -1"),
            ("\"hex8\"", "\"hex8\", tetrahedra = ¦7", "`tetrahedra` must be from 5 to 6, found 7"),
            ("\"hex8\"", "\"hex8\", origin = [0, ¦inf, 0]", "`origin` must be a finite number, found inf"),
            (
                "[time]",
                "[linear_solver]\ntolerance = 1\n[time]",
                "2:13: `tolerance` must be at least 0 and less than 1, found 1",
            ),
            ("\"bar\"\n", "\"1\"\n", "5:8: `name` must be letters, digits"),
            ("\"bar\"\n", "\"a/b\"\n", "5:8: `name` must be letters, digits"),
            ("\"bar\"\n", "\"\"\n", "5:8: `name` must be letters, digits"),
        ],
    );
}

#[test]
fn what_is_missing_is_named_where_it_is_missing() {
    each_replaced(
        SHORT,
        &[
            ("step = 0.01\n", "", "1:1: [time] needs `step`: time step"),
            ("[time]\nstep = 0.01\nend = 1.0\n", "", "1:1: the scene needs `time`: how long is simulated"),
            ("name = \"bar\"\n", "", "4:1: [[body]] needs `name`"),
            ("density = 1000.0\n", "", "4:1: [[body]] needs `density`"),
            (", size = [1, 1, 1]", "", "7:8: [body.mesh] needs `size`: edge lengths of the bar"),
            (", element = \"hex8\"", "", "7:8: a bar needs `element = \"hex8\"` or `sections = "),
            ("generator = \"bar\", ", "", "7:8: [body.mesh] needs `file = \"…\"` or `generator = \"bar\"`"),
            (
                "[[body.material]]\nregion = \"all\"\nlaw = \"stvk\"\nyoung = 1e5\npoisson = 0.3\n",
                "",
                "4:1: [[body]] needs `material`: materials; at least one",
            ),
        ],
    );
    assert_eq!(
        messages("[time]\nstep = 1\nend = 1\n"),
        ["scene.toml:1:1: the scene needs `body`: the bodies; at least one"]
    );
    assert_eq!(
        messages("body = []\n[time]\nstep = 1\nend = 1\n"),
        ["scene.toml:1:1: the scene needs `body`: the bodies; at least one"]
    );
}

#[test]
fn values_that_exclude_each_other_are_both_named() {
    each_replaced(
        SHORT,
        &[
            (
                "generator = \"bar\"",
                "file = \"a.vtu\", ¦generator = \"bar\"",
                "a mesh comes from a file or from a generator; remove either `file` or `generator`",
            ),
            (
                "element = \"hex8\"",
                "¦element = \"hex8\", sections = []",
                "give either `element` or `sections`, not both",
            ),
            ("element = \"hex8\"", "element = \"hex8\", ¦scale = 1", "`scale` belongs to a mesh file"),
            ("element = \"hex8\"", "¦sections = []", "`sections` is empty"),
            ("region = \"all\"", "region = {}", "9:10: a region needs exactly one of element, box"),
            (
                "region = \"all\"",
                "region = { element = \"hex8\", ¦near_surface = 1 }",
                "a region has exactly one key, found `element` and `near_surface`",
            ),
            ("region = \"all\"", "region = { and = ¦[] }", "`and` must be a list of at least one region"),
            (
                "region = \"all\"",
                "region = { box = { min = ¦[0, 2, 0], max = [1, 1, 1] } }",
                "the box is empty: along y, `min` is 2 and `max` is 1",
            ),
            (
                "[time]",
                "[linear_solver]\npreconditioner = \"incomplete-cholesky\"\noperator = \"matrix-free\"\n[time]",
                "2:1: an incomplete Cholesky factorisation needs the matrix",
            ),
            (
                "[time]",
                "[linear_solver]\ntolerance = 0\n[time]",
                "2:1: `tolerance` and `absolute_tolerance` are both 0",
            ),
            ("[time]", "[output]\nfields = [\"stress\", \"stress\"]\n[time]", "2:21: `fields` names \"stress\" twice"),
        ],
    );
}

#[test]
fn sections_increase_to_the_end_of_the_bar() {
    each_replaced(
        EXAMPLE,
        &[
            (
                "until = 0.50",
                "until = 0.25",
                "30:3: `until` must be greater than 0.25, where the section before it ends, found 0.25",
            ),
            (
                "until = 1.00",
                "until = 0.90",
                "32:3: `until` must be 1.0 in the last section, the end of the bar, found 0.9",
            ),
            ("until = 0.25", "until = ¦0", "`until` must be greater than 0 and at most 1, found 0"),
            (
                "\"tet4\" },",
                "¦\"quad4\" },",
                "the elements of a bar are all solids, all surface elements or all edges; `prism6` and `quad4`",
            ),
            ("\"tet4\" },", "¦\"tet5\" },", "unknown element `tet5`; did you mean `tet4`?"),
        ],
    );
}

#[test]
fn additions_that_do_not_fit_say_why() {
    let probe = "[[probe]]\nname = \"p\"\nquantity = [\"energy\", \"stress\", \"position\"]\n";
    let cases: Vec<(String, &str)> = vec![
        ("[[body.fix]]\nregion = \"x_min\"\naxes = []\n".into(), "15:1: `axes` is empty"),
        ("[[body.fix]]\nregion = \"x_min\"\naxes = [\"x\", \"w\"]\n".into(), "15:14: unknown word in `axes`: `w`; known: x, y, z"),
        ("[[body.move]]\nregion = \"x_min\"\n".into(), "13:1: [[body.move]] needs `translation` or `rotation`"),
        ("[[body.move]]\nregion = \"x_min\"\naxes = [\"x\"]\nrotation = { axis = [1, 0, 0], keys = [[0, 0]] }\n".into(), "15:1: a rotation moves along all axes"),
        ("[[body.move]]\nregion = \"x_min\"\nrotation = { axis = [0, 0, 0], keys = [[0, 0]] }\n".into(), "15:21: `axis` must be a direction: three numbers, not all zero"),
        ("[[body.move]]\nregion = \"x_min\"\nrotation = { axis = [1, 0, 0], keys = [[1, 0], [¦1, 2]] }\n".into(), "`keys` must be a list whose times increase: after 1 s comes a later one, found 1 s"),
        ("[[body.move]]\nregion = \"x_min\"\ntranslation = { keys = [[0, 1]] }\n".into(), "15:29: `keys` must be a list of three numbers (length [m]), found the number 1"),
        ("[[body.move]]\nregion = \"x_min\"\ntranslation = { keys = [[0]] }\n".into(), "15:25: `keys` must be a list of pairs [time, value], found a list of 1 value"),
        ("[[body.force]]\nregion = \"x_min\"\n".into(), "13:1: [[body.force]] needs exactly one of `total` and `per_node`"),
        ("[[body.force]]\nregion = \"x_min\"\ntotal = [1, 0, 0]\nper_node = [1, 0, 0]\n".into(), "16:1: [[body.force]] needs exactly one of"),
        ("[[body.region]]\nname = \"all\"\nregion = \"x_min\"\n".into(), "14:8: a region cannot be named \"all\""),
        ("[[body.region]]\nname = \"a\"\nregion = \"x_min\"\n[[body.region]]\nname = \"a\"\nregion = \"x_max\"\n".into(), "17:8: there is already a region named \"a\" (line 14); give this one another name"),
        ("[[body.region]]\nname = \"a\"\nregion = { not = \"b\" }\n[[body.region]]\nname = \"b\"\nregion = { or = [\"x_min\", \"a\"] }\n[[body.fix]]\nregion = \"a\"\n".into(), "15:10: region \"a\" is defined by itself"),
        ("[body.quadrature]\nhex8 = 5\n".into(), "14:8: unknown quadrature of hex8 `5`; known: hexahedron-"),
        ("[body.quadrature]\nhexa8 = 5\n".into(), "14:1: unknown element `hexa8`; did you mean `hex8`?"),
        ("[[tie]]\nbody = \"bar\"\nregion = \"x_min\"\nto_body = \"baar\"\nto_region = \"x_max\"\nwithin = 1\n".into(), "16:11: unknown body `baar`; did you mean `bar`?; known: bar"),
        ("[[probe]]\nname = \"p\"\nquantity = []\n".into(), "15:12: `quantity` must be one or a list of \"mean displacement\""),
        ("[[probe]]\nname = \"p\"\nbody = \"q\"\nquantity = \"energy\"\n".into(), "15:8: unknown body `q`; known: bar"),
        (format!("{probe}{probe}"), "17:8: there is already a probe named \"p\" (line 14)"),
        (format!("{probe}[[expect]]\nprobe = \"q\"\nvalue = 1\ntolerance = 1\n"), "17:9: unknown probe `q`; known: p"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nvalue = 1\ntolerance = 1\n"), "17:1: probe \"p\" measures \"energy\", \"stress\", \"position\"; say which with `quantity`"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"volume\"\nvalue = 1\ntolerance = 1\n"), "18:12: probe \"p\" measures \"energy\", \"stress\", \"position\", not \"volume\""),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"energy\"\ntolerance = 1\n"), "16:1: [[expect]] needs `value`"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"energy\"\nvalue = 1\n"), "16:1: [[expect]] needs `tolerance`, in the unit of the value, or `relative_tolerance`"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"energy\"\ncomponent = \"x\"\nvalue = 1\ntolerance = 1\n"), "19:13: \"energy\" is a number; remove `component`"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"stress\"\ncomponent = \"x\"\nvalue = 1\ntolerance = 1\n"), "19:13: \"stress\" is a tensor; its components are xx"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"stress\"\nvalue = 1\ntolerance = 1\n"), "19:9: `value` must be a list of 6 numbers for \"stress\", or give `component`"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"energy\"\nvalue = [1, 2]\ntolerance = 1\n"), "19:9: `value` must be a single number, found a list of 2 values"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"energy\"\nvalue = \"1 m\"\ntolerance = 1\n"), "19:9: `value`: expected an energy such as \"1 mJ\""),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"position\"\nvalue = [1, 2, 3]\ntolerance = 1\n"), "16:1: \"position\" is a list; say which entry with `index`, from 0"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nquantity = \"energy\"\nindex = 0\nvalue = 1\ntolerance = 1\n"), "19:1: \"energy\" is not a list; remove `index`"),
        (format!("{probe}[[expect]]\nprobe = \"p\"\nmax_cg_iterations = 3\n"), "18:1: [[expect]] needs exactly one of `probe` and `max_cg_iterations`"),
        ("[[expect]]\nmax_cg_iterations = 3\ntolerance = 1\n".into(), "15:1: `tolerance` needs `probe`"),
        ("[[expect]]\ntolerance = 1\n".into(), "13:1: [[expect]] needs exactly one of"),
    ];
    each_added(&cases);
}

#[test]
fn bodies_with_the_same_name_are_refused() {
    let body = SHORT.split_once("[[body]]").unwrap().1;
    let found = messages(&format!("{SHORT}[[body]]{body}"));
    assert_eq!(found, ["scene.toml:14:8: there is already a body named \"bar\" (line 5); give this one another name"]);
}

#[test]
fn a_mesh_file_refuses_the_keys_of_a_generator_one_by_one() {
    let text = SHORT.replace(
        "generator = \"bar\", size = [1, 1, 1], cells = [2, 2, 2], element = \"hex8\"",
        "file = \"a.vtu\", size = [1, 1, 1], cells = [2, 2, 2]",
    );
    let found = messages(&text);
    assert_eq!(
        found,
        [
            "scene.toml:7:26: `size` belongs to a generator and has no meaning with `file`",
            "scene.toml:7:44: `cells` belongs to a generator and has no meaning with `file`",
        ]
    );
    let empty =
        SHORT.replace("generator = \"bar\", size = [1, 1, 1], cells = [2, 2, 2], element = \"hex8\"", "file = \" \"");
    assert!(messages(&empty)[0].contains("`file` is empty"));
}

#[test]
fn all_mistakes_are_reported_at_once_in_the_order_of_the_text() {
    let text = SHORT
        .replace("step = 0.01", "step = -1")
        .replace("density = 1000.0", "densiti = 1000.0")
        .replace("hex8", "hex7")
        .replace("stvk", "stvkk")
        .replace("[2, 2, 2]", "[0, 2, \"a\"]");
    let found = messages(&format!("{text}[[probe]]\nname = \"p\"\nquantity = \"enrgy\"\n[outptu]\nevery = 1\n"));
    let places: Vec<&str> = found.iter().map(|line| line.split(':').nth(1).unwrap()).collect();
    assert_eq!(places, ["2", "4", "6", "7", "7", "7", "10", "15", "16"], "{found:#?}");
}

#[test]
fn text_that_is_not_toml_names_the_line() {
    for (text, message) in [
        ("[time]\nstep = \n", "2:8: not valid TOML: "),
        ("[time]\nstep = 1\nstep = 2\n", "3:1: not valid TOML: duplicate key"),
        ("a = [1,\nb = 2\n", "2:1: not valid TOML: "),
        ("title = \"abc\n", "1:13: not valid TOML: "),
    ] {
        let found = messages(text);
        assert!(found[0].starts_with(&format!("scene.toml:{message}")), "{found:#?}");
        assert!(found.len() <= 3, "{found:#?}");
    }
    // Two separate slips are both reported.
    let found = messages("[time]\nstep = 0.1s\n\nend = one\n");
    assert_eq!(found.len(), 2, "{found:#?}");
}

#[test]
fn the_file_name_of_the_caller_is_the_one_in_messages() {
    let errors = souple_scene::parse("x = 1", "dir/a b.toml", &crate::catalogue::catalogue()).unwrap_err();
    assert!(errors.to_string().starts_with("dir/a b.toml:1:1: "), "{errors}");
    assert!(read(SHORT).is_ok());
}
