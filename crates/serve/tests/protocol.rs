//! A real server on a free port, and clients that speak the protocol: what they see is what the simulation computes, what
//! they do reaches it, and what they must not do is refused.
//!
//! Out of scope: the page ([`browser.rs`](browser.rs)).

#![allow(clippy::unwrap_used, reason = "a test that unwraps says with its line number what it expected")]

mod client;

use client::{Client, Refused, connect, get, scene, serve, simulation};
use serde_json::json;
use souple_serve::server::{ServeError, Server, ServerOptions};

/// Topology and positions arrive, and are those of a run without a server at the same step, bit for bit.
#[test]
fn positions_are_those_of_a_run_without_server() {
    let server = serve(ServerOptions::default());
    let mut client = connect(&server).unwrap();
    client.send(json!({ "do": "step", "count": 5 }));
    let frame = client.frame_where(|h| h["step"] == 5 && h["playing"] == false);
    let mut alone = simulation();
    (0..5).for_each(|_| drop(alone.advance().unwrap()));
    let numbers = client.scene.u32("numbers").unwrap();
    let positions = alone.positions();
    let bits = |values: &[f32]| values.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
    let expected: Vec<f32> = numbers.iter().flat_map(|&n| positions[n as usize].map(|x| x as f32)).collect();
    assert_eq!(bits(&frame.f32("positions").unwrap()), bits(&expected));
    assert_eq!(frame.header["time"], alone.time());

    let rest: Vec<f32> = numbers.iter().flat_map(|&n| alone.prepared().nodes[n as usize].map(|x| x as f32)).collect();
    assert_eq!(client.scene.f32("rest").unwrap(), rest);
    assert_ne!(rest, expected, "the bar bends");
    let triangles = client.scene.u32("triangles").unwrap();
    assert!(triangles.iter().all(|&n| (n as usize) < numbers.len()));
    // The surface of a bar of 4 × 2 × 2 cells: 40 quadrangles of two triangles.
    assert_eq!(triangles.len(), 3 * 2 * 40);
    assert_eq!(numbers.len(), 5 * 3 * 3 - 3, "all nodes but those inside");
}

/// The triangles of a closed body turn outwards: the volume that they enclose is the body's.
#[test]
fn the_surface_encloses_the_body() {
    let server = serve(ServerOptions::default());
    let client = connect(&server).unwrap();
    let rest = client.scene.f32("rest").unwrap();
    let at = |n: u32| -> [f64; 3] { std::array::from_fn(|k| f64::from(rest[3 * n as usize + k])) };
    let volume: f64 = client
        .scene
        .u32("triangles")
        .unwrap()
        .chunks(3)
        .map(|t| {
            let [a, b, c] = [at(t[0]), at(t[1]), at(t[2])];
            let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
            (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6.0
        })
        .sum();
    assert!((volume - 0.004).abs() < 1e-8, "{volume}");
}

/// A field that is chosen comes with every frame, one value per node, within the range that the header says.
#[test]
fn values_come_with_positions() {
    let server = serve(ServerOptions::default());
    let mut client = connect(&server).unwrap();
    client.send(json!({ "do": "colour", "by": "energy-density" }));
    client.send(json!({ "do": "step", "count": 3 }));
    let frame = client.frame_where(|h| h["step"] == 3 && h["field"]["key"] == "energy-density");
    let values = frame.f32("values").unwrap();
    assert_eq!(values.len(), client.scene.u32("numbers").unwrap().len());
    let [low, high] = ["low", "high"].map(|end| frame.header["field"][end].as_f64().unwrap());
    assert!(values.iter().all(|&v| f64::from(v) >= low && f64::from(v) <= high) && low < high, "{low} {high}");
}

/// Each client gets the field that it chose, also while time stands still and whatever others choose, and none when it
/// chose none.
#[test]
fn each_client_chooses_its_field() {
    let server = serve(ServerOptions::default());
    let mut clients = [connect(&server).unwrap(), connect(&server).unwrap(), connect(&server).unwrap()];
    clients[0].send(json!({ "do": "colour", "by": "energy-density" }));
    clients[1].send(json!({ "do": "colour", "by": "von-mises" }));
    clients[2].send(json!({ "do": "colour", "by": "displacement" }));
    clients[0].send(json!({ "do": "step", "count": 2 }));
    let keys = [json!("energy-density"), json!("von-mises"), serde_json::Value::Null];
    let mut values = Vec::new();
    for (client, key) in clients.iter_mut().zip(&keys) {
        let frame = client.frame_where(|h| h["step"] == 2 && h["playing"] == false && h["field"]["key"] == *key);
        values.push(frame.f32("values"));
    }
    assert!(values[0].is_some() && values[1].is_some() && values[0] != values[1]);
    assert!(values[2].is_none());
    // One joins another, and the third goes on alone with what the first had.
    clients[0].send(json!({ "do": "colour", "by": "von-mises" }));
    let same = clients[0].frame_where(|h| h["field"]["key"] == "von-mises");
    assert_eq!(same.f32("values"), values[1]);
    clients[2].send(json!({ "do": "colour", "by": "energy-density" }));
    let taken = clients[2].frame_where(|h| h["field"]["key"] == "energy-density");
    assert_eq!(taken.f32("values"), values[0]);
}

/// While it plays, time passes; after `pause` has been seen, it does not; one `step` makes one step.
#[test]
fn pause_stops_time() {
    let server = serve(ServerOptions::default());
    let mut client = connect(&server).unwrap();
    client.send(json!({ "do": "play" }));
    let frame = client.frame_where(|h| h["step"].as_u64() >= Some(2));
    assert_eq!(frame.header["playing"], true);
    client.send(json!({ "do": "pause" }));
    let stopped = client.frame_where(|h| h["playing"] == false).header["step"].as_u64().unwrap();
    client.send(json!({ "do": "step" }));
    // Had time passed meanwhile, this step would have another number.
    let next = client.frame_where(|h| h["step"].as_u64() > Some(stopped) && h["playing"] == false);
    assert_eq!(next.header["step"], stopped + 1);
    client.send(json!({ "do": "reset" }));
    assert_eq!(client.frame_where(|h| h["step"] == 0).header["time"], 0.0);
}

/// A pull moves the body towards the hand and tells its force, which is that of the spring; when its client goes away, the
/// hand lets go.
#[test]
fn pulls_move_the_body_and_report_their_force() {
    let server = serve(ServerOptions::default());
    let mut client = connect(&server).unwrap();
    let mut other = connect(&server).unwrap();
    let rest = client.scene.f32("rest").unwrap();
    let tip = (0..rest.len() / 3).find(|n| rest[3 * n] > 0.399 && rest[3 * n + 1] > 0.099).unwrap();
    let place = |at: &[f32]| f64::from(at[3 * tip + 1]);
    client.send(json!({
        "do": "pull-begin", "nodes": [tip], "weights": [1.0], "target": [0.4, 0.1, 0.0], "stiffness": 50.0
    }));
    client.send(json!({ "do": "pull-move", "target": [0.4, 0.3, 0.0] }));
    client.send(json!({ "do": "step", "count": 20 }));
    let pulled = client.frame_where(|h| h["step"] == 20);
    let pull = pulled.header["pulls"][0].clone();
    assert_eq!(pull["hand"], client.number);
    assert_eq!(pull["target"][1], 0.3);
    let force = pull["force"][1].as_f64().unwrap();
    let expected = 50.0 * (0.3 - pull["point"][1].as_f64().unwrap());
    assert!(force > 1.0 && (force - expected).abs() < 1e-9 * force, "{force} N, the spring says {expected} N");
    let mut free = simulation();
    (0..20).for_each(|_| drop(free.advance().unwrap()));
    let node = client.scene.u32("numbers").unwrap()[tip] as usize;
    assert!(place(&pulled.f32("positions").unwrap()) > free.positions()[node][1] + 1e-3);
    drop(client);
    other.frame_where(|h| h["pulls"].as_array().is_some_and(Vec::is_empty) && h["clients"] == 1);
}

/// Knobs reach the simulation and come back in frames.
#[test]
fn gravity_damping_and_step_are_turned() {
    let server = serve(ServerOptions::default());
    let mut client = connect(&server).unwrap();
    client.send(json!({ "do": "gravity", "value": [0.0, 0.0, 1.5] }));
    client.send(json!({ "do": "damping", "value": 2.5 }));
    client.send(json!({ "do": "time-step", "value": 0.005 }));
    let frame = client.frame_where(|h| h["time_step"] == 0.005);
    assert_eq!((&frame.header["gravity"], &frame.header["damping"]), (&json!([0.0, 0.0, 1.5]), &json!(2.5)));
}

/// What cannot be read or cannot be is answered with what was expected, and the connection lives on.
#[test]
fn mistakes_are_answered() {
    let server = serve(ServerOptions::default());
    let mut client = connect(&server).unwrap();
    for (bad, says) in [
        ("{", "EOF"),
        (r#"{"do":"fly"}"#, "pull-begin"),
        (r#"{"do":"colour","by":"mood"}"#, "von-mises"),
        (r#"{"do":"pull-begin","nodes":[9999],"weights":[1],"target":[0,0,0],"stiffness":1}"#, "no surface node 9999"),
    ] {
        client.send_text(bad);
        let answer = client.error();
        assert!(answer.contains(says), "{bad}: {answer}");
    }
    client.send_binary(&[1, 2, 3]);
    assert!(client.error().contains("text messages"));
    client.send(json!({ "do": "step" }));
    client.frame_where(|h| h["step"] == 1);
}

/// A message of more than the limit ends the connection of who sent it, and nobody else's.
#[test]
fn long_messages_are_cut_off() {
    let server = serve(ServerOptions::default());
    let mut client = connect(&server).unwrap();
    let mut other = connect(&server).unwrap();
    client.send_text(&" ".repeat(souple_serve::command::LONGEST + 1));
    assert!(client.ends(), "the connection is closed");
    other.send(json!({ "do": "step" }));
    other.frame_where(|h| h["step"] == 1 && h["clients"] == 1);
}

/// Two clients see the same; what one does, the other sees.
#[test]
fn all_see_the_same() {
    let server = serve(ServerOptions::default());
    let (mut one, mut two) = (connect(&server).unwrap(), connect(&server).unwrap());
    assert_eq!(one.scene, two.scene);
    one.send(json!({ "do": "step", "count": 4 }));
    let last = |h: &serde_json::Value| h["step"] == 4 && h["clients"] == 2;
    let (a, b) = (one.frame_where(last), two.frame_where(last));
    assert_eq!(a.f32("positions"), b.f32("positions"));
}

/// A client that does not say `more` gets two frames and no third; when it does, it gets the newest and none of those in
/// between.
#[test]
fn slow_clients_skip_frames() {
    let server = serve(ServerOptions::default());
    let (mut slow, mut quick) = (connect(&server).unwrap(), connect(&server).unwrap());
    slow.hungry = false;
    for step in 1..=10 {
        quick.send(json!({ "do": "step" }));
        quick.frame_where(|h| h["step"] == step);
    }
    // Answers come in order, so that nothing but what was sent before can be ahead of this one.
    slow.send_text("{");
    let frames = slow.frames_before_error();
    assert!(frames.len() <= 2, "{} frames", frames.len());
    assert!(frames.iter().all(|f| f.header["step"].as_u64() < Some(10)));
    slow.send(json!({ "do": "more" }));
    assert_eq!(slow.frame().header["step"], 10);
}

/// Pages of other sites, and this server under a name that it does not have, are refused before anything is said.
#[test]
fn strangers_are_refused() {
    let server = serve(ServerOptions::default());
    let own = format!("http://{}", server.address());
    assert!(Client::open(&server, None, Some(&own)).is_ok());
    for (host, origin) in [(None, "http://evil.example"), (None, "null"), (Some("evil.example"), "http://evil.example")]
    {
        match Client::open(&server, host, Some(origin)) {
            Err(Refused::Status(403, text)) => {
                assert!(text.contains("evil.example") || text.contains("null"), "{text}")
            }
            other => panic!("{host:?} {origin}: {:?}", other.err()),
        }
    }
    let named = serve(ServerOptions { hosts: vec!["sim.example".into()], ..ServerOptions::default() });
    assert!(Client::open(&named, Some("sim.example"), Some("https://sim.example")).is_ok());
}

/// One client more than the limit is refused with the reason; a place that becomes free is given again.
#[test]
fn too_many_are_refused() {
    let server = serve(ServerOptions { clients: 2, ..ServerOptions::default() });
    let one = connect(&server).unwrap();
    let mut two = connect(&server).unwrap();
    match connect(&server) {
        Err(Refused::Status(503, text)) => assert!(text.contains('2') && text.contains("--clients"), "{text}"),
        other => panic!("{:?}", other.err()),
    }
    assert!(get(&server, "/status").contains(r#"{"clients":2,"limit":2}"#));
    drop(one);
    two.frame_where(|h| h["clients"] == 1);
    client::until(|| connect(&server).ok());
}

/// The page and its scripts are there, load from nowhere else, and name only files that are there.
#[test]
fn the_page_is_self_contained() {
    let server = serve(ServerOptions::default());
    let mut waiting = vec!["/".to_owned()];
    let mut seen = Vec::new();
    while let Some(path) = waiting.pop() {
        let answer = get(&server, &path);
        assert!(answer.starts_with("HTTP/1.1 200"), "{path}: {answer}");
        assert!(answer.to_lowercase().contains("content-security-policy: default-src 'none'"), "{path}");
        assert!(!answer.contains("http://") && !answer.contains("https://"), "{path} names another server");
        for start in ["src=\"", "href=\"/", "from \"./"] {
            for (at, _) in answer.match_indices(start) {
                let name = answer[at + start.len()..].split('"').next().unwrap();
                let name = format!("/{}", name.trim_start_matches('/'));
                if !seen.contains(&name) {
                    seen.push(name.clone());
                    waiting.push(name);
                }
            }
        }
    }
    assert!(seen.len() >= 8, "{seen:?}");
    assert!(get(&server, "/nowhere").starts_with("HTTP/1.1 404"));
    assert!(get(&server, "/socket").starts_with("HTTP/1.1 400"));
}

/// A port in use gives an error that says so and what to do; clients of a server that ends are told.
#[test]
fn ports_and_ends() {
    let server = serve(ServerOptions::default());
    let options = ServerOptions { port: server.address().port(), ..ServerOptions::default() };
    let error = Server::start(simulation(), Vec::new(), options).err().unwrap();
    assert!(matches!(error, ServeError::PortInUse(_)) && error.to_string().contains("--port"), "{error}");
    let mut client = connect(&server).unwrap();
    server.stop();
    assert!(client.ends());
}

/// A scene of several bodies, elements and cables has legends for all of them.
#[test]
fn legends_name_what_there_is() {
    let server = scene("../../scenes/skin_and_tendon.toml");
    let client = connect(&server).unwrap();
    let names = |of: &str| -> Vec<String> {
        let groups = client.scene.header["legends"][of].as_array().unwrap();
        groups.iter().map(|g| g["name"].as_str().unwrap().to_owned()).collect()
    };
    assert!(names("element").contains(&"edge2".to_owned()), "{:?}", names("element"));
    assert!(names("law").len() >= 2 && names("material").len() >= 2);
    assert!(!client.scene.u32("cables").unwrap().is_empty());
    assert_eq!(client.scene.header["closed"], false);
}
