//! The server of reports, asked over its socket.

use crate::browser::{Browser, chromium};
use crate::place::{Place, densities, with_souple};
use souple_campaign::database::Database;
use souple_campaign::serve::{Answer, Body, Question, Site, answer};
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};

/// A server that ends with the test.
struct Server(Child, String);

impl Drop for Server {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Server {
    fn start(place: &Place) -> Server {
        let mut process = place.command("serve --port 0").stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(process.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").and_then(|a| a.strip_suffix('/')).unwrap().to_owned();
        Server(process, address)
    }

    /// Head and body of an answer.
    fn ask(&self, request: &str, headers: &str) -> (String, String) {
        let mut stream = TcpStream::connect(&self.1).unwrap();
        write!(stream, "{request} HTTP/1.1\r\nConnection: close\r\n{headers}\r\n").unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        (head.to_owned(), body.to_owned())
    }
}

/// The page and its data follow the database; what has not changed is not sent again; nothing can be changed, other
/// machines' names and unknown pages are refused, and a port that is taken is said to be.
#[test]
fn reports_follow_the_database() {
    with_souple();
    let place = Place::new(
        "served",
        "name = \"served\"\nscene = \"bar.toml\"\n[[vary]]\nkey = \"time.step\"\nvalues = [1e-3]\n",
    );
    place.succeeds("run . --jobs 1");
    let server = Server::start(&place);
    let host = "Host: localhost\r\n";
    let (head, page) = server.ask("GET /", host);
    assert!(head.starts_with("HTTP/1.1 200") && head.contains("default-src 'none'"), "{head}");
    assert!(page.contains("\"live\":\"/group/1/data.json\""), "{page}");
    let (head, data) = server.ask("GET /group/1/data.json", host);
    let tag = head.lines().find_map(|line| line.strip_prefix("ETag: ")).unwrap().to_owned();
    assert!(data.contains("\"finished\"") && !data.contains("\"number\":1,"), "{data}");
    let known = format!("{host}If-None-Match: {tag}\r\n");
    let (head, body) = server.ask("GET /group/1/data.json", &known);
    assert!(head.starts_with("HTTP/1.1 304") && body.is_empty(), "{head}\n{body}");

    match chromium() {
        None => eprintln!("skipped: no Chromium"),
        Some(program) => {
            let mut browser = Browser::start(&program, &place.0);
            browser.open(&format!("http://{}/group/1", server.1));
            let live = "new Promise((done) => { const look = () => document.querySelector('.live')?.textContent === 'live' \
                ? done(document.querySelectorAll('#simulations tbody tr').length) : requestAnimationFrame(look); look(); })";
            assert_eq!(browser.value(live), serde_json::json!(1));
            assert_eq!(browser.complaints, Vec::<String>::new());
            let ours = |r: &&String| !r.starts_with(&format!("http://{}/group/1", server.1)) && !r.starts_with("data:");
            assert_eq!(browser.requests.iter().find(ours), None);
        }
    }

    let more = "name = \"served\"\nscene = \"bar.toml\"\n[[vary]]\nkey = \"time.step\"\nvalues = [1e-3, 2e-3]\n";
    std::fs::write(place.0.join("campaign.toml"), more).unwrap();
    place.succeeds("run . --jobs 1");
    let (_, index) = server.ask("GET /", host);
    assert!(index.contains("/group/1") && index.contains("/group/2"), "{index}");
    let (head, data) = server.ask("GET /group/2/data.json", &known);
    assert!(head.starts_with("HTTP/1.1 200") && data.contains("\"number\":1,"), "{head}");

    // What the simulations left can be looked at, and nothing else can.
    let data: serde_json::Value = serde_json::from_str(&server.ask("GET /group/2/data.json", host).1).unwrap();
    let link = data["simulations"][0]["link"].as_str().unwrap();
    let (head, list) = server.ask(&format!("GET {link}"), host);
    assert!(head.starts_with("HTTP/1.1 200") && list.contains(&format!("href=\"{link}summary.json\"")), "{list}");
    let (head, summary) = server.ask(&format!("GET {link}summary.json"), host);
    assert!(head.contains("application/json"), "{head}");
    let lies = place.0.join("campaign.results").join(link.trim_start_matches("/results/")).join("summary.json");
    assert_eq!(summary, std::fs::read_to_string(lies).unwrap());
    let scene = std::fs::read_dir(place.0.join("campaign.results")).unwrap().map(|e| e.unwrap().file_name());
    let scene = scene.map(|n| n.to_string_lossy().into_owned()).find(|n| n.starts_with("scene_")).unwrap();
    for outside in [
        format!("{link}../{scene}"),
        format!("{link}..%2F{scene}"),
        format!("/results/{scene}"),
        "/results/../campaign.db".to_owned(),
        format!("/results/{}/x", "0".repeat(64)),
    ] {
        let (head, _) = server.ask(&format!("GET {outside}"), host);
        assert!(head.starts_with("HTTP/1.1 404"), "{outside}: {head}");
    }

    for (request, headers, status) in [
        ("POST /", host, "405"),
        ("DELETE /group/1", host, "405"),
        ("GET /", "Host: example.org\r\n", "403"),
        ("GET /../campaign.db", host, "404"),
        ("GET /group/9", host, "404"),
    ] {
        let (head, _) = server.ask(request, headers);
        assert!(head.starts_with(&format!("HTTP/1.1 {status}")), "{request}: {head}");
    }
    let port = server.1.rsplit(':').next().unwrap();
    let second = place.command(&format!("serve --port {port}")).output().unwrap();
    let said = String::from_utf8_lossy(&second.stderr).into_owned();
    assert!(second.status.code() == Some(2) && said.contains("cannot listen on"), "{said}");
}

/// What is asked again is not made again, until somebody changes the database.
#[test]
fn data_are_made_once_for_each_change() {
    with_souple();
    let place = Place::new("made_once", &densities(1));
    place.succeeds("run . --jobs 1");
    let mut site = Site::new(place.database(), place.0.join("campaign.results"));
    let address = "127.0.0.1:80".parse().unwrap();
    let question = Question { method: "GET", path: "/group/1/data.json", host: Some("localhost"), known: None };
    let ask = |site: &mut Site| answer(site, &question, address).unwrap();
    let first = ask(&mut site);
    assert!(matches!(&first, Answer { status: 200, body: Body::Bytes(bytes), .. } if !bytes.is_empty()));
    assert_eq!((ask(&mut site), ask(&mut site)), (first.clone(), first.clone()));
    assert_eq!(site.made, 1);
    place.database().execute("UPDATE simulations SET reason = $1", &["another".into()]).unwrap();
    assert_ne!(ask(&mut site), first);
    assert_eq!(site.made, 2);
    stamps_tell_of_changes(&site.database, &place.database());
}

/// The stamp of one connection changes with what another one does, and not with what it reads.
pub(crate) fn stamps_tell_of_changes(ours: &Database, theirs: &Database) {
    let before = ours.stamp().unwrap();
    let count = |database: &Database| database.first::<i64>("SELECT COUNT(*) FROM simulations", &[]).unwrap();
    assert!(count(ours) == count(theirs) && count(ours) > 0);
    assert_eq!(ours.stamp().unwrap(), before);
    theirs.execute("UPDATE simulations SET reason = $1", &["yet another".into()]).unwrap();
    assert_ne!(ours.stamp().unwrap(), before);
}
