//! A browser without a window, driven by the DevTools protocol over pipes: JSON messages that end with a zero byte.
//!
//! What it is not: a general client. It opens a page, keeps everything that the page asks the network for or complains
//! of, evaluates expressions, and takes pictures.

use serde_json::{Value as Json, json};
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Longer than any answer takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A page in a browser of its own.
pub(crate) struct Browser {
    process: Child,
    to: ChildStdin,
    from: Receiver<Json>,
    folder: PathBuf,
    session: String,
    next: u64,
    /// Addresses that the page asked for.
    pub(crate) requests: Vec<String>,
    /// Errors and exceptions of its scripts, and what the browser complains of.
    pub(crate) complaints: Vec<String>,
    loaded: bool,
}

/// The browser's program, where there is one.
pub(crate) fn chromium() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name))).find(|file| file.is_file())
}

impl Browser {
    /// Starts a browser whose profile lies in a folder of its own.
    pub(crate) fn start(program: &Path, folder: &Path) -> Browser {
        let profile = folder.join("profile");
        std::fs::create_dir_all(&profile).unwrap();
        // The protocol speaks on descriptors 3 and 4; ours are 0 and 1.
        let mut process = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1"])
            .arg(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"])
            .args(["--disable-background-networking", "--disable-component-update", "--disable-sync"])
            .args(["--disable-dev-shm-usage", "--hide-scrollbars", "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", profile.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let to = process.stdin.take().unwrap();
        let mut out = BufReader::new(process.stdout.take().unwrap());
        // A thread reads, so that waiting has an end.
        let (sender, from) = channel();
        std::thread::spawn(move || {
            let mut bytes = Vec::new();
            while out.read_until(0, &mut bytes).is_ok() && bytes.pop() == Some(0) {
                if serde_json::from_slice(&bytes).map(|message: Json| sender.send(message)).is_err() {
                    break;
                }
                bytes.clear();
            }
        });
        let mut browser = Browser {
            process,
            to,
            from,
            folder: profile,
            session: String::new(),
            next: 0,
            requests: Vec::new(),
            complaints: Vec::new(),
            loaded: false,
        };
        let target = browser.call("Target.createTarget", json!({ "url": "about:blank" }));
        let attached =
            browser.call("Target.attachToTarget", json!({ "targetId": target["targetId"], "flatten": true }));
        browser.session = attached["sessionId"].as_str().unwrap().to_owned();
        for domain in ["Page", "Network", "Runtime", "Log"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser.call("Emulation.setEmulatedMedia", json!({ "features": [
            { "name": "prefers-color-scheme", "value": "light" }, { "name": "prefers-reduced-motion", "value": "reduce" },
        ]}));
        browser.requests.clear();
        browser
    }

    /// Opens an address and waits until all of it is loaded.
    pub(crate) fn open(&mut self, address: &str) {
        self.loaded = false;
        let answer = self.call("Page.navigate", json!({ "url": address }));
        assert!(answer["errorText"].is_null(), "{answer}");
        while !self.loaded {
            let message = self.receive();
            self.keep(&message);
        }
    }

    /// The value of an expression of the page.
    pub(crate) fn value(&mut self, expression: &str) -> Json {
        let parameters = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let answer = self.call("Runtime.evaluate", parameters);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].clone()
    }

    /// The size of the page, and whether it is dark.
    pub(crate) fn look(&mut self, width: u32, height: u32, scheme: &str) {
        let metrics = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", metrics);
        let feature = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.call("Emulation.setEmulatedMedia", feature);
        // Two frames: one that sees the new size, one that is drawn with it.
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))");
    }

    /// A picture of the page, as base64 of a PNG.
    pub(crate) fn picture(&mut self) -> String {
        self.call("Page.captureScreenshot", json!({ "format": "png" }))["data"].as_str().unwrap().to_owned()
    }

    fn call(&mut self, method: &str, parameters: Json) -> Json {
        self.next += 1;
        let id = self.next;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.to.write_all(message.to_string().as_bytes()).and_then(|()| self.to.write_all(&[0])).unwrap();
        self.to.flush().unwrap();
        loop {
            let answer = self.receive();
            if answer["id"] == json!(id) {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            self.keep(&answer);
        }
    }

    fn receive(&mut self) -> Json {
        self.from.recv_timeout(PATIENCE).expect("the browser answers")
    }

    fn keep(&mut self, event: &Json) {
        let p = &event["params"];
        match event["method"].as_str().unwrap_or("") {
            "Page.loadEventFired" => self.loaded = true,
            "Network.requestWillBeSent" => self.requests.push(p["request"]["url"].as_str().unwrap_or("").to_owned()),
            "Runtime.exceptionThrown" => self.complaints.push(p["exceptionDetails"].to_string()),
            "Runtime.consoleAPICalled" if ["error", "warning", "assert"].iter().any(|t| p["type"] == *t) => {
                self.complaints.push(p["args"].to_string());
            }
            "Log.entryAdded" => self.complaints.push(p["entry"].to_string()),
            _ => {}
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}
