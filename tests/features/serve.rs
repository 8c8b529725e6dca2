//! `trainsafe serve`: what a page is answered, who is answered at all, and that nothing bad ends it.

use std::fs;
use std::io::Write;
use std::path::Path;

use crate::served::{Served, TRAIN};
use serde_json::{Value, json};
use trainsafe::{Options, analyze, consist};

/// The couplers that a reply draws.
fn drawn(reply: &Value) -> Vec<Value> {
    assert_eq!(reply["problems"], json!([]));
    assert_eq!(reply["messages"], json!([]));
    let data: Value = serde_json::from_str(reply["data"].as_str().expect("data")).expect("JSON");
    data[0]["couplers"].as_array().expect("couplers").clone()
}

/// What the library finds for the first scenario of a text, as the page has it.
fn found(text: &str) -> Vec<[Value; 3]> {
    let train = consist::parse(text, Path::new("five.toml")).expect("a train");
    let analysis = analyze(&train, &Options::default()).expect("an analysis");
    let of = |c: &trainsafe::findings::CouplerFindings| [json!(c.coupler), json!(c.peak_draft_n), json!(c.peak_buff_n)];
    analysis.scenarios[0].cases[0].couplers.iter().map(of).collect()
}

fn shown(couplers: &[Value]) -> Vec<[Value; 3]> {
    couplers.iter().map(|c| [c["coupler"].clone(), c["peak_draft_n"].clone(), c["peak_buff_n"].clone()]).collect()
}

fn messages(reply: &Value) -> String {
    reply["messages"].as_array().expect("messages").iter().map(|m| m.as_str().expect("text")).collect()
}

#[test]
fn the_page_has_the_file_and_an_analysis_has_the_numbers_of_the_library() {
    let served = Served::new(TRAIN);
    let page = served.get();
    assert_eq!(page.status, 200);
    for header in ["cache-control: no-store", "referrer-policy: no-referrer", "x-frame-options: deny"] {
        assert!(page.head.contains(header), "{}", page.head);
    }
    assert!(page.body.contains("connect-src 'self'") && page.body.contains("<textarea"));
    assert_eq!(served.on_disk()["text"], TRAIN);
    let reply = served.analyze(&json!({ "text": TRAIN }));
    assert_eq!(shown(&drawn(&reply)), found(TRAIN));
    assert!(reply["body"].as_str().is_some_and(|b| b.contains("class=\"verdict")));
    assert_eq!(reply["scenarios"][1], "hit");
    let [alone, whole] = ["analysis_ms", "total_ms"].map(|key| reply[key].as_f64().expect("a number"));
    assert!(0.0 < alone && alone < whole, "{alone} {whole}");
    let losses = |reply: &Value| reply["body"].as_str().is_some_and(|b| b.contains("with dashpots in every coupler"));
    assert!(!losses(&reply) && losses(&served.analyze(&json!({ "text": TRAIN, "losses": true }))));
    let pulse = served.analyze(&json!({ "text": TRAIN, "scenario": 1 }));
    assert_eq!(drawn(&pulse).len(), 4);
    let controls = pulse["controls"].as_array().expect("controls").iter();
    let keys: Vec<&str> =
        controls.filter(|c| !c["value"].is_null()).map(|c| c["key"].as_str().expect("a key")).collect();
    let given =
        ["coupler.stiffness", "coupler.rated_load", "load.uniform", "scenario[1].force", "scenario[1].duration"];
    assert_eq!(keys, given);
}

#[test]
fn any_coupler_is_broken_by_the_readers_rules() {
    let served = Served::new(TRAIN);
    for coupler in [1, 3, 4] {
        let reply = served.analyze(&json!({ "text": TRAIN, "break": coupler }));
        let file = TRAIN.replace("coupler = 2", &format!("coupler = {coupler}"));
        assert_eq!(shown(&drawn(&reply)), found(&file), "coupler {coupler}");
        // Also out of a scenario in which nothing breaks.
        assert_eq!(drawn(&served.analyze(&json!({ "text": TRAIN, "scenario": 1, "break": coupler }))), drawn(&reply));
        assert_eq!(reply["text"], TRAIN, "the text stays");
    }
    let beyond = served.analyze(&json!({ "text": TRAIN, "break": 9 }));
    assert!(messages(&beyond).contains("the train has no coupler 9"), "{beyond}");
    let buff = TRAIN.replace("0.6 MN", "-0.6 MN").replace("coupler = 2", "coupler = 2\nbuff_breaks = true");
    let pushed = served.analyze(&json!({ "text": buff.replace("\nbuff_breaks = true", ""), "break": 1 }));
    assert!(pushed["problems"].to_string().contains("buff"), "{pushed}");
}

#[test]
fn without_the_token_or_by_another_host_nobody_is_answered() {
    let served = Served::new(TRAIN);
    let mut wrong = served.token.clone().into_bytes();
    wrong[31] ^= 1;
    let wrong = String::from_utf8(wrong).expect("text");
    let short = &served.token[..31];
    let paths = [
        "/",
        "/analyze",
        "/favicon.ico",
        &format!("/{wrong}/"),
        &format!("/{wrong}/save"),
        &format!("/{short}/"),
        "//",
    ];
    for path in paths {
        for method in ["GET", "POST", "PUT", "OPTIONS", "DELETE"] {
            let answer = served.request(method, path, &served.host(), "{}");
            assert_eq!(answer.status, 403, "{method} {path}: {}", answer.body);
            assert!(!answer.body.contains(&served.token));
        }
    }
    let path = format!("/{}/", served.token);
    let good = served.host();
    let hosts = [
        "Host: example.com\r\n",
        "Host: 127.0.0.1.example.com\r\n",
        "Host: localhost.example.com:80\r\n",
        "Host: \r\n",
    ];
    let twice = format!("{good}Host: example.com\r\n");
    for host in hosts.into_iter().chain([twice.as_str()]) {
        let answer = served.request("GET", &path, host, "");
        assert!([400, 403].contains(&answer.status), "{host}: {}", answer.status);
    }
    let none = served.raw(format!("GET {path} HTTP/1.0\r\n\r\n").as_bytes());
    assert_eq!(none.status, 403);
    for host in [good.as_str(), &format!("Host: localhost:{}\r\n", served.port), "Host: LOCALHOST\r\n"] {
        assert_eq!(served.request("GET", &path, host, "").status, 200, "{host}");
    }
}

#[test]
fn it_listens_on_loopback_alone() {
    let served = Served::new(TRAIN);
    let Ok(sockets) = fs::read_to_string("/proc/net/tcp") else { return };
    let port = format!(":{:04X}", served.port);
    let listening: Vec<&str> = sockets
        .lines()
        .filter_map(|line| line.split_whitespace().nth(1).zip(line.split_whitespace().nth(3)))
        .filter_map(|(local, state)| local.strip_suffix(port.as_str()).filter(|_| state == "0A"))
        .collect();
    assert_eq!(listening, ["0100007F"]);
}

#[test]
fn bad_requests_are_answered_and_survived() {
    let served = Served::new(TRAIN);
    let path = |what: &str| format!("/{}/{what}", served.token);
    let text = json!(TRAIN).to_string();
    for body in [
        "",
        "{",
        "null",
        "[]",
        "\u{fffd}",
        "{\"text\":1}",
        "{\"text\":\"\",\"unknown\":1}",
        &format!("{{\"text\":{text},\"break\":-1}}"),
        &format!("{{\"text\":{text},\"changes\":[{{\"key\":\"load.uniform\"}}]}}"),
        &format!("{{\"text\":{text},\"changes\":[{{\"key\":\"load.uniform\",\"value\":null}}]}}"),
        &"[".repeat(1 << 20),
    ] {
        let answer = served.post("analyze", body);
        assert_eq!(answer.status, 400, "{}", answer.body);
        assert_eq!(served.post("save", body).status, 400);
    }
    for (method, what, status) in
        [("GET", "analyze", 405), ("PUT", "save", 405), ("POST", "", 405), ("GET", "x", 404), ("GET", "../x", 404)]
    {
        assert_eq!(served.request(method, &path(what), &served.host(), "").status, status, "{method} {what}");
    }
    let huge = "x".repeat(9 << 20);
    assert_eq!(served.post("analyze", &huge).status, 413);
    assert_eq!(served.post("save", &huge).status, 413);
    // Without a length said beforehand.
    let head = format!(
        "POST {} HTTP/1.1\r\n{}Connection: close\r\nTransfer-Encoding: chunked\r\n\r\n",
        path("analyze"),
        served.host()
    );
    let chunk = format!("{:x}\r\n{huge}\r\n0\r\n\r\n", huge.len());
    assert_eq!(served.raw((head + &chunk).as_bytes()).status, 413);
    for garbage in [
        &b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"[..],
        b"GET\r\n\r\n",
        b"\0\0\0\0\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
    ] {
        assert!([0, 400, 403, 505].contains(&served.raw(garbage).status));
    }
    // Connections that send half a request, or leave before the answer.
    let half: Vec<_> = (0..50)
        .map(|n| {
            let mut stream = served.connect();
            let part = if n % 2 == 0 {
                "POST /".to_owned()
            } else {
                format!("POST {} HTTP/1.1\r\n{}Content-Length: 99\r\n\r\n{{", path("analyze"), served.host())
            };
            stream.write_all(part.as_bytes()).expect("sent");
            stream
        })
        .collect();
    assert_eq!(drawn(&served.analyze(&json!({ "text": TRAIN }))).len(), 3);
    drop(half);
    for text in ["", "\0", "[", "[[vehicle]]", "a = 1\n".repeat(2000).as_str(), "x = [[[[[[[[", "\u{feff}"] {
        let reply = served.analyze(&json!({ "text": text }));
        assert!(!reply["problems"].as_array().expect("problems").is_empty() && reply["body"] == "", "{text:?}");
    }
    assert_eq!(drawn(&served.analyze(&json!({ "text": TRAIN }))).len(), 3);
    assert_eq!(served.text(), TRAIN);
}
