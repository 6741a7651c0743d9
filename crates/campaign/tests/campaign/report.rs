//! The page of a group, as a browser shows it.

use crate::browser::{Browser, chromium};
use serde_json::{Value as Json, json};
use souple_campaign::report::cantilever::{Cantilever, cantilever};
use souple_campaign::report::data::{
    Bar, Curve, Done, Group, Machine, Material, Measurement, Parameter, Section, Simulation,
};
use souple_campaign::report::page::{Surroundings, data, html};
use souple_campaign::report::scene::Scenes;
use std::path::Path;

const SCENE: &str = r#"
gravity = [0, -9.81, 0]
integrator = { method = "quasi-static" }
[[body]]
name = "bar"
density = 1000.0
mesh = { generator = "bar", size = [1, 0.2, 0.2], cells = [5, 1, 1], sections = [{ until = 1.0, element = "hex8" }] }
material = [{ law = "hooke", young = 1e7, poisson = 0.3 }]
fix = [{ region = "x_min" }]
"#;
const CELLS: [&str; 4] = ["[5, 1, 1]", "[10, 2, 2]", "[20, 4, 4]", "[40, 8, 8]"];
const MATERIAL: &str = r#"[{"name":"young","value":1e7},{"name":"poisson","value":POISSON}]"#;

/// Two bars × two Poisson's ratios × four resolutions whose tips err by h² and h³, then one that failed, one that is
/// invalid and one to do.
pub(crate) fn group() -> Group {
    let parameter = |name: &str, variation: &str, count| Parameter {
        name: name.to_owned(),
        variation: variation.to_owned(),
        first: None,
        last: None,
        step: None,
        count,
    };
    let bar = |name: &str| Bar {
        name: name.to_owned(),
        sections: vec![Section { until: 1.0, law: "hooke".to_owned(), element: name.to_owned(), quadrature: None }],
    };
    let mut group = Group {
        name: "bars </script> & more".to_owned(),
        folder: "bars".to_owned(),
        source: "campaign.toml".to_owned(),
        scene: SCENE.to_owned(),
        parameters: vec![
            parameter("body.0.mesh.cells", "list", CELLS.len()),
            parameter("body.0.material.0.poisson", "list", 2),
        ],
        bars: vec![bar("hex8"), bar("tet10")],
        machines: vec![Machine {
            host: "here".to_owned(),
            processor: "a processor".to_owned(),
            cores: 2,
            system: "linux".to_owned(),
        }],
        simulations: Vec::new(),
    };
    for bar in 0..2usize {
        for poisson in ["0.3", "0.45"] {
            for (k, cells) in CELLS.iter().enumerate() {
                let h = 0.2 / f64::from(1 << k);
                let error = if bar == 0 { h * h } else { h * h * h };
                let simulation = Simulation {
                    number: group.simulations.len(),
                    bar: Some(bar),
                    device: "cpu".to_owned(),
                    values: vec![Some((*cells).to_owned()), Some(poisson.to_owned())],
                    done: None,
                };
                let done = done(&group, &simulation, k, error);
                group.simulations.push(Simulation { done: Some(done), ..simulation });
            }
        }
    }
    for (status, reason) in [
        ("failed", "failed after t = 0.1 s: <b>inverted</b> & </script>\nin element 3"),
        ("invalid", "density"),
        ("to do", ""),
    ] {
        let mut last = group.simulations[0].clone();
        last.number = group.simulations.len();
        last.done = last.done.filter(|_| status != "to do").map(|d| Done {
            hash: format!("hash of {status}"),
            status: status.to_owned(),
            reason: reason.to_owned(),
            steps: None,
            nodes: None,
            timings: Vec::new(),
            measurements: Vec::new(),
            curves: Vec::new(),
            ..d
        });
        group.simulations.push(last);
    }
    group
}

fn done(group: &Group, simulation: &Simulation, k: usize, error: f64) -> Done {
    let poisson = simulation.values[1].clone().unwrap();
    let materials = vec![Material { law: "hooke".to_owned(), parameters: MATERIAL.replace("POISSON", &poisson) }];
    let beam: Cantilever = cantilever(&Scenes::of(group).scene(simulation).unwrap(), &materials).unwrap();
    let points: Vec<[f64; 3]> =
        (0..=10).map(|i| 0.1 * f64::from(i)).map(|x| [x, 0.1 + beam.timoshenko(x) * (1.0 + error), 0.1]).collect();
    let tip = points[10][1] - 0.1;
    let measurement = |component: &str, value| Measurement {
        probe: "tip".to_owned(),
        quantity: "mean displacement".to_owned(),
        component: component.to_owned(),
        value,
    };
    let elements = 5 * 8i64.pow(k as u32);
    Done {
        hash: format!("hash {}", simulation.number),
        status: "finished".to_owned(),
        reason: String::new(),
        program: "program".to_owned(),
        threads: 1,
        machine: 0,
        wall_s: 0.01 * elements as f64,
        steps: Some(1),
        simulated_s: Some(1.0),
        nodes: Some(3 * elements),
        elements: vec![(group.bars[simulation.bar.unwrap()].name.clone(), elements)],
        timings: vec![("step".to_owned(), 2.0 * elements as f64)],
        measurements: vec![measurement("x", 0.0), measurement("y", tip), measurement("z", 0.0)],
        curves: vec![Curve { probe: "bar".to_owned(), quantity: "deflection curve".to_owned(), points }],
        expectations: Vec::new(),
        materials,
    }
}

fn quantity(data: &Json, name: &str) -> Vec<Option<f64>> {
    let all = data["quantities"].as_array().unwrap();
    let found = all.iter().find(|q| q["name"] == name).unwrap_or_else(|| panic!("{name}"));
    found["values"].as_array().unwrap().iter().map(Json::as_f64).collect()
}

/// Errors are those that the simulations were made with; the finest has none against itself, failed ones have none at
/// all and keep their places.
#[test]
fn errors_are_against_the_beam_and_the_finest() {
    let data = data(&group(), &Surroundings::default());
    let beam = quantity(&data, "tip against Timoshenko");
    let finest = quantity(&data, "tip mean displacement against the finest");
    let count = group().simulations.len();
    assert_eq!((beam.len(), finest.len(), data["simulations"].as_array().unwrap().len()), (count, count, count));
    for at in 0..16 {
        let h = 0.2 / f64::from(1 << (at % 4));
        let error = if at < 8 { h * h } else { h * h * h };
        assert!((beam[at].unwrap() / error - 1.0).abs() < 1e-9, "{at}: {:?}", beam[at]);
        // Both bars solve one problem, of which the first of the finest is the reference.
        let against = 0.025f64.powi(2);
        match at {
            3 | 7 => assert_eq!(finest[at], None),
            _ => assert!((finest[at].unwrap() - (error - against).abs() / (1.0 + against)).abs() < 1e-12, "{at}"),
        }
    }
    assert_eq!((&beam[16..], &finest[16..]), (&[None; 3][..], &[None; 3][..]));
    assert_eq!(quantity(&data, "cell size")[1].map(|h| (h * 1e9).round()), Some(1e8));
}

/// The page opens in a browser from a file: it draws every graph with finite coordinates and the expected curves, asks the
/// network for nothing, complains of nothing, sorts by a click, filters, and tells values to the keyboard.
#[test]
fn a_browser_shows_the_report() {
    let Some(program) = chromium() else {
        eprintln!("skipped: no Chromium");
        return;
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report");
    std::fs::create_dir_all(&folder).unwrap();
    let page = folder.join("report.html");
    std::fs::write(&page, html(&group(), &Surroundings::default())).unwrap();
    let address = format!("file://{}", page.display());
    let mut browser = Browser::start(&program, &folder);
    browser.look(1280, 900, "light");
    browser.open(&address);
    let lines = browser.value("[...document.querySelectorAll('.graph')].map((g) => [...g.querySelectorAll('svg[tabindex]')].map((s) => s.querySelectorAll('g.series').length))");
    // Time per step by bar and Poisson's ratio; both with two beams of each ratio; error twice.
    assert_eq!(lines, json!([[4], [8], [4, 4]]));
    let finite = browser.value(
        "[...document.querySelectorAll('svg [d], svg [transform], svg [cx]')].every((e) => \
         !/NaN|Infinity|undefined/.test((e.getAttribute('d') ?? '') + (e.getAttribute('transform') ?? '') + (e.getAttribute('cx') ?? '')))",
    );
    assert_eq!(finite, json!(true));
    let points = browser.value("document.querySelectorAll('.graph')[0].querySelectorAll('g.series .marker').length");
    assert_eq!(points, json!(16));
    // Against the beam the orders are those that the simulations were made with.
    let choose = "(() => { const s = document.querySelectorAll('.card')[3].querySelector('select');\
         s.value = 'tip against Timoshenko'; s.dispatchEvent(new Event('change')); return s.value })()";
    assert_eq!(browser.value(choose), json!("tip against Timoshenko"));
    let slopes = browser.value("[...document.querySelectorAll('.slope')].map((s) => s.textContent)");
    assert_eq!(slopes, json!(["slope 2", "slope 2", "slope 3", "slope 3"]));
    let text = browser.value("document.body.innerText");
    let text = text.as_str().unwrap();
    for said in [
        "3 of 19 simulations are not drawn",
        "failed: #16",
        "invalid: #17",
        "to do: #18",
        "<b>inverted</b> & </script>",
        "Pareto front",
    ] {
        assert!(text.contains(said), "{said} is missing in {text}");
    }
    // A click on a head sorts, a second one the other way; missing values stay last.
    let click = "document.querySelector('th[data-column=\"wall time\"] button').click()";
    let column = "(() => { const k = [...document.querySelectorAll('#simulations th')].findIndex((t) => t.dataset.column === 'wall time');\
         return [...document.querySelectorAll('#simulations tbody tr')].map((r) => Number(r.children[k].textContent.replace('–', 'NaN'))) })()";
    for descending in [false, true] {
        browser.value(click);
        let walls: Vec<Option<f64>> = browser.value(column).as_array().unwrap().iter().map(Json::as_f64).collect();
        let (known, missing) = walls.split_at(16);
        assert!(missing.iter().all(Option::is_none), "{walls:?}");
        assert!(known.windows(2).all(|w| if descending { w[0] >= w[1] } else { w[0] <= w[1] }), "{walls:?}");
        assert!(known[0] != known[15]);
    }
    // A filter takes curves and rows away; a legend entry hides its curve.
    browser.value("[...document.querySelectorAll('.filters button')].find((b) => b.textContent === 'tet10').click()");
    let left = browser.value("[document.querySelectorAll('.graph')[0].querySelectorAll('g.series').length, document.querySelectorAll('#simulations tbody tr').length]");
    assert_eq!(left, json!([2, 8]));
    browser.value("document.querySelector('.legend button').click()");
    assert_eq!(browser.value("document.querySelectorAll('.graph')[0].querySelectorAll('g.series').length"), json!(1));
    // The keyboard goes from point to point, and what it finds is said.
    let key = "(() => { const s = document.querySelector('svg[tabindex]'); s.focus();\
         s.dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowRight' })); return document.querySelector('[aria-live]').textContent })()";
    let said = browser.value(key);
    assert!(said.as_str().unwrap().contains("step"), "{said}");
    let unnamed = browser.value("[...document.querySelectorAll('button, select, input')].filter((e) => !(e.textContent.trim() || e.getAttribute('aria-label') || e.closest('label'))).length");
    assert_eq!(unnamed, json!(0));
    // Narrow, nothing but tables is wider than the page.
    for scheme in ["light", "dark"] {
        browser.look(390, 844, scheme);
        assert_eq!(browser.value("document.documentElement.scrollWidth"), json!(390));
        assert!(browser.picture().len() > 1000);
    }
    assert_eq!(
        browser.requests.iter().filter(|r| **r != address && !r.starts_with("data:")).count(),
        0,
        "{:?}",
        browser.requests
    );
    assert_eq!(browser.complaints, Vec::<String>::new());
    drop(browser);
    std::fs::remove_dir_all(&folder).unwrap();
}
