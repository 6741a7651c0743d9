//! A headless Chromium, driven through its DevTools protocol: JSON over a WebSocket, one tab.
//!
//! Only what the tests of the page need. Everything waits for an answer or an event, with a deadline.

use base64::Engine as _;
use serde_json::{Value, json};
use souple_serve::colours::Colour;
use std::io::{BufRead as _, BufReader};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use tungstenite::client::IntoClientRequest as _;
use tungstenite::{Message, WebSocket};

const DEADLINE: Duration = Duration::from_secs(90);

/// A picture: width, height, and red, green, blue of each pixel, row by row.
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<[u8; 3]>,
}

/// A browser with one tab.
pub(crate) struct Browser {
    child: Child,
    folder: PathBuf,
    socket: WebSocket<TcpStream>,
    session: String,
    next: u64,
    /// Events that came meanwhile.
    pub(crate) events: Vec<Value>,
}

/// The program, if this machine has one.
pub(crate) fn program() -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&path).flat_map(|folder| names.map(|n| folder.join(n))).find(|file| file.is_file())
}

impl Browser {
    /// Starts a browser with an empty tab of this size.
    pub(crate) fn start(program: &Path, folder: PathBuf, size: [u32; 2]) -> Browser {
        let mut child = Command::new(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--enable-unsafe-swiftshader", "--disable-background-networking", "--disable-component-update"])
            .args(["--disable-sync", "--remote-debugging-port=0", "about:blank"])
            .arg(format!("--user-data-dir={}", folder.display()))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program is there");
        // It says on which port it listens, once it does.
        let lines = BufReader::new(child.stderr.take().expect("it is piped")).lines();
        let address = lines
            .map_while(Result::ok)
            .find_map(|line| line.split_once("DevTools listening on ").map(|(_, address)| address.to_owned()))
            .expect("Chromium says where it listens");
        let request = address.clone().into_client_request().expect("Chromium knows its address");
        let stream = TcpStream::connect(request.uri().authority().expect("an address has one").as_str())
            .expect("Chromium listens where it says");
        stream.set_read_timeout(Some(DEADLINE)).expect("a positive time is allowed");
        let (socket, _) = tungstenite::client(request, stream).expect("Chromium speaks WebSocket");
        let mut browser = Browser { child, folder, socket, session: String::new(), next: 0, events: Vec::new() };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attached = json!({ "targetId": target["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", attached);
        browser.session = session["sessionId"].as_str().expect("a session has a name").to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser.resize(size);
        browser
    }

    /// Gives the tab a size.
    pub(crate) fn resize(&mut self, [width, height]: [u32; 2]) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
    }

    fn read(&mut self) -> Value {
        loop {
            match self.socket.read().expect("Chromium answers in time") {
                Message::Text(text) => return serde_json::from_str(&text).expect("it speaks JSON"),
                Message::Close(_) => panic!("Chromium ended"),
                _ => {}
            }
        }
    }

    /// Calls a method and waits for its answer; events on the way are kept.
    pub(crate) fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.next += 1;
        let mut message = json!({ "id": self.next, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.socket.send(Message::Text(message.to_string().into())).expect("Chromium listens");
        loop {
            let answer = self.read();
            if answer["id"] == self.next {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.events.push(answer);
        }
    }

    /// Goes to an address.
    pub(crate) fn go(&mut self, address: &str) {
        self.call("Page.navigate", json!({ "url": address }));
    }

    /// The value of an expression in the page; promises are waited for.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let asked = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    /// Waits until a condition holds in the page, and until that has been drawn.
    pub(crate) fn wait_for(&mut self, condition: &str) {
        let seconds = DEADLINE.as_secs() / 2;
        let outcome = self.value(&format!(
            "new Promise((done) => {{
               const late = performance.now() + {seconds}e3;
               const look = () => {{
                 let holds = false;
                 try {{ holds = {condition}; }} catch {{ /* not there yet */ }}
                 if (holds) requestAnimationFrame(() => requestAnimationFrame(() => done('')));
                 else if (performance.now() > late) done(document.body.innerText);
                 else requestAnimationFrame(look);
               }};
               look();
             }})"
        ));
        assert_eq!(outcome, "", "waited in vain for `{condition}`; the page says this");
    }

    /// Moves, presses or releases the left button.
    pub(crate) fn mouse(&mut self, kind: &str, [x, y]: [f64; 2]) {
        let event = json!({ "type": kind, "x": x, "y": y, "button": "left", "buttons": 1, "clickCount": 1 });
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Fingers on the screen from now on; an event of this kind tells the page.
    pub(crate) fn touch(&mut self, kind: &str, fingers: &[[f64; 2]]) {
        let point = |(id, [x, y]): (usize, &[f64; 2])| json!({ "x": x, "y": y, "id": id });
        let points: Vec<Value> = fingers.iter().enumerate().map(point).collect();
        self.call("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points }));
    }

    /// What the tab shows, as a PNG file.
    pub(crate) fn screenshot(&mut self) -> Vec<u8> {
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }));
        let text = answer["data"].as_str().expect("a picture is text in base 64");
        base64::engine::general_purpose::STANDARD.decode(text).expect("it is base 64")
    }

    /// Messages of the console that tell of a mistake, and addresses that were asked for.
    pub(crate) fn complaints_and_requests(&self) -> (Vec<String>, Vec<String>) {
        let mut complaints = Vec::new();
        let mut requests = Vec::new();
        for event in &self.events {
            let parameters = &event["params"];
            match event["method"].as_str().unwrap_or_default() {
                "Runtime.exceptionThrown" => complaints.push(parameters.to_string()),
                "Log.entryAdded" if parameters["entry"]["level"] == "error" => complaints.push(parameters.to_string()),
                "Runtime.consoleAPICalled" if parameters["type"] == "error" => complaints.push(parameters.to_string()),
                "Network.requestWillBeSent" => {
                    requests.push(parameters["request"]["url"].as_str().unwrap_or("?").into())
                }
                "Network.webSocketCreated" => requests.push(parameters["url"].as_str().unwrap_or("?").into()),
                _ => {}
            }
        }
        (complaints, requests)
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself; its folder may still be written to by one of its processes, and lies in `target`.
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// Whether a pixel is a colour under some light.
pub(crate) fn is(pixel: [u8; 3], colour: Colour) -> bool {
    let (p, c) = (pixel.map(f64::from), colour.map(f64::from));
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let light = dot(p, c) / dot(c, c);
    let left: f64 = (0..3).map(|k| (p[k] - light * c[k]).powi(2)).sum();
    (0.3..1.1).contains(&light) && left.sqrt() < 12.0
}

/// Takes a PNG file apart.
pub(crate) fn pixels(file: &[u8]) -> Picture {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("it is a PNG file");
    let mut bytes = vec![0; reader.output_buffer_size().expect("it fits into memory")];
    let info = reader.next_frame(&mut bytes).expect("it is whole");
    let samples = info.color_type.samples();
    let pixels = bytes[..info.buffer_size()].chunks(samples).map(|p| [p[0], p[1], p[2]]).collect();
    Picture { width: info.width as usize, height: info.height as usize, pixels }
}
