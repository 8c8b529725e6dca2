//! A served page and requests to it, by a plain connection.

#![allow(dead_code)] // Each test binary uses its own part.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::{Value, json};
use tempfile::TempDir;

/// A train of four couplers under a load.
pub const TRAIN: &str = r#"# A comment that stays.
name = "Five"

[coupler]            # all alike
stiffness  = "30 MN/m"
rated_load = "1.5 MN"

[[vehicle]]
count = 5
mass  = "160 t"

[load]
uniform = "0.6 MN"   # and so does this

[[scenario]]
kind    = "break"
coupler = 2

[[scenario]]
name     = "hit"
kind     = "pulse"
at       = "tail"
force    = "-1.2 MN"
duration = "60 ms"
"#;

/// `trainsafe serve` on a train file in a folder of its own; ended when it is dropped.
pub struct Served {
    pub child: Child,
    pub folder: TempDir,
    pub port: u16,
    pub token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl Answer {
    pub fn json(&self) -> Value {
        assert_eq!(self.status, 200, "{}", self.body);
        serde_json::from_str(&self.body).expect("JSON")
    }
}

impl Served {
    pub fn new(text: &str) -> Served {
        let folder = tempfile::tempdir().expect("a folder");
        fs::create_dir(folder.path().join("trains")).expect("a folder");
        fs::write(folder.path().join("trains/five.toml"), text).expect("written");
        let mut child = Command::new(env!("CARGO_BIN_EXE_trainsafe"))
            .args(["serve", "trains/five.toml", "--no-open"])
            .current_dir(folder.path())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("it runs");
        let mut address = String::new();
        BufReader::new(child.stdout.take().expect("a pipe")).read_line(&mut address).expect("the address");
        let rest = address.trim().strip_prefix("http://127.0.0.1:").expect("loopback");
        let (port, token) = rest.trim_end_matches('/').split_once('/').expect("a token");
        assert!(token.len() >= 32, "{token}");
        Served { child, port: port.parse().expect("a port"), token: token.to_owned(), folder }
    }

    pub fn file(&self) -> PathBuf {
        self.folder.path().join("trains/five.toml")
    }

    pub fn text(&self) -> String {
        fs::read_to_string(self.file()).expect("the file")
    }

    pub fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).expect("a connection");
        stream.set_read_timeout(Some(Duration::from_secs(120))).expect("a time limit");
        stream
    }

    /// Sends bytes as they are, and reads until the connection is closed.
    pub fn raw(&self, bytes: &[u8]) -> Answer {
        let mut stream = self.connect();
        // A request that is refused early may find the connection closed while it is sent.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let answer = String::from_utf8_lossy(&answer).into_owned();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((&answer, ""));
        let status = head.split(' ').nth(1).and_then(|s| s.parse().ok()).unwrap_or(0);
        Answer { status, head: head.to_lowercase(), body: body.to_owned() }
    }

    /// A request to a path, with this Host.
    pub fn request(&self, method: &str, path: &str, host: &str, body: &str) -> Answer {
        let length = body.len();
        let head = format!("{method} {path} HTTP/1.1\r\n{host}Connection: close\r\nContent-Length: {length}\r\n\r\n");
        self.raw((head + body).as_bytes())
    }

    pub fn host(&self) -> String {
        format!("Host: 127.0.0.1:{}\r\n", self.port)
    }

    pub fn post(&self, what: &str, body: &str) -> Answer {
        self.request("POST", &format!("/{}/{what}", self.token), &self.host(), body)
    }

    pub fn get(&self) -> Answer {
        self.request("GET", &format!("/{}/", self.token), &self.host(), "")
    }

    pub fn analyze(&self, request: &Value) -> Value {
        self.post("analyze", &request.to_string()).json()
    }

    /// The text with one change in it, and the whole reply.
    pub fn changed(&self, text: &str, change: Value) -> (String, Value) {
        let reply = self.analyze(&json!({ "text": text, "changes": [change] }));
        (reply["text"].as_str().expect("a text").to_owned(), reply)
    }

    /// The train file on the page: its text and digest.
    pub fn on_disk(&self) -> Value {
        let page = self.get();
        assert_eq!(page.status, 200);
        let from = page.body.split("id=\"file\">").nth(1).expect("the file");
        serde_json::from_str(from.split("</script>").next().expect("its end")).expect("JSON")
    }
}
