//! The server, asked over plain TCP: what it answers, and what it refuses.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use upglow::{Cube, DyeModel, DyeOptions, DyeSet, Model};
use upglow_color::{Contract, Illuminant, LinearRgb, RgbSpace};
use upglow_explorer::{BuildOption, Plan, Planner, Server};
use upglow_fit::{Fitter, Preset, Unwatched, build_cube};
use upglow_image::{ExrDescription, ExrWriter, Picture, SpectralPicture};

/// A server that ends with the test.
struct Running {
    address: SocketAddr,
    path: String,
    is_stopped: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

/// What the server answered.
#[derive(Clone, Debug, PartialEq)]
struct Answer {
    status: u16,
    headers: BTreeMap<String, String>,
    body: Vec<u8>,
}

impl Answer {
    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or(Value::Null)
    }

    fn error(&self) -> String {
        self.json()["error"].as_str().unwrap_or_default().to_owned()
    }

    fn floats(&self) -> Vec<f32> {
        self.body.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect()
    }
}

fn cube(preset: Preset) -> Cube {
    let contract = Contract::default();
    build_cube(&contract, &preset.model(), preset.options(), 4, &Unwatched).unwrap()
}

/// Understands four options as `upglow build` does.
fn planner() -> Planner {
    let option = |name: &str| BuildOption {
        name: name.into(),
        heading: String::new(),
        help: String::new(),
        default: None,
        words: Vec::new(),
        has_value: true,
    };
    let names = ["--preset", "--space", "--resolution", "--illuminant", "--dyes"];
    let plan = |given: &BTreeMap<String, String>| {
        let text = |name: &str| given.get(name).map(String::as_str);
        let preset: Preset = text("--preset").unwrap_or("jakob2019").parse().unwrap_or_default();
        let mut contract = Contract::default();
        if let Some(space) = text("--space") {
            contract.space = RgbSpace::named(space).map_err(|error| format!("--space: {error}"))?;
        }
        if let Some(light) = text("--illuminant") {
            contract.illuminant = match std::fs::read_to_string(light) {
                Ok(csv) => Illuminant::from_csv_file(Path::new(light), &csv, None),
                Err(_) => Illuminant::named(light),
            }
            .map_err(|error| error.to_string())?;
        }
        let model = match text("--dyes") {
            Some(folder) => {
                let set = DyeSet::from_folder(Path::new(folder)).map_err(|e| e.to_string())?;
                Model::Dyes(DyeModel::new(set, DyeOptions::default()).map_err(|e| e.to_string())?)
            }
            None => preset.model(),
        };
        let resolution = text("--resolution").map_or(Ok(4), str::parse);
        let resolution = resolution.map_err(|error| format!("--resolution: {error}"))?;
        Ok(Plan { contract, model, options: preset.options(), resolution })
    };
    Planner { options: names.map(option).into(), plan: Box::new(plan) }
}

fn start(preset: Preset) -> Running {
    let server = Server::new(cube(preset), "tiny <cube>", planner(), 0).unwrap();
    let (host, path) = server.address().strip_prefix("http://").unwrap().split_once('/').unwrap();
    let (address, path) = (host.parse().unwrap(), format!("/{path}"));
    let is_stopped = Arc::new(AtomicBool::new(false));
    let stop = is_stopped.clone();
    let thread = std::thread::spawn(move || server.run(|| stop.load(Ordering::Relaxed)).unwrap());
    Running { address, path, is_stopped, thread: Some(thread) }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.is_stopped.store(true, Ordering::Relaxed);
        let ended = self.thread.take().unwrap().join();
        assert!(ended.is_ok() || std::thread::panicking());
    }
}

impl Running {
    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        stream
    }

    /// Sends bytes and reads one answer.
    fn exchange(&self, request: &[u8]) -> Answer {
        let mut stream = self.connect();
        stream.write_all(request).unwrap();
        read(&mut BufReader::new(stream)).expect("an answer")
    }

    fn head(&self, method: &str, path: &str, headers: &str) -> String {
        let (host, root) = (self.address, &self.path);
        format!("{method} {root}{path} HTTP/1.1\r\nHost: {host}\r\n{headers}\r\n")
    }

    fn get(&self, path: &str) -> Answer {
        self.exchange(self.head("GET", path, "").as_bytes())
    }

    fn post(&self, path: &str, body: &[u8]) -> Answer {
        let head = self.head("POST", path, &format!("Content-Length: {}\r\n", body.len()));
        self.exchange(&[head.as_bytes(), body].concat())
    }

    fn ask(&self, path: &str, question: &Value) -> Answer {
        self.post(path, question.to_string().as_bytes())
    }

    /// Asks until a build has ended.
    fn built(&self, id: &Value) -> Value {
        let start = Instant::now();
        loop {
            let state = self.get(&format!("build/{id}")).json();
            if state["state"] != "running" {
                return state;
            }
            assert!(start.elapsed() < Duration::from_secs(120), "{state}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

/// Reads an answer; `None` if the connection ends before one.
fn read(stream: &mut impl BufRead) -> Option<Answer> {
    let mut line = String::new();
    let mut next = |stream: &mut dyn BufRead| {
        line.clear();
        stream
            .read_line(&mut line)
            .ok()
            .filter(|read| *read > 0)
            .map(|_| line.trim_end().to_owned())
    };
    let status = next(stream)?.split(' ').nth(1)?.parse().ok()?;
    let mut headers = BTreeMap::new();
    loop {
        let line = next(stream)?;
        let Some((name, value)) = line.split_once(": ") else { break };
        headers.insert(name.to_lowercase(), value.to_owned());
    }
    let length = headers.get("content-length").map_or(0, |length| length.parse().unwrap());
    let mut body = vec![0; length];
    stream.read_exact(&mut body).ok()?;
    Some(Answer { status, headers, body })
}

#[test]
fn the_page_comes_with_what_browsers_must_heed() {
    let server = start(Preset::Jakob2019);
    let page = server.get("");
    assert_eq!(page.status, 200);
    assert!(page.body.starts_with(b"<!doctype html>"));
    let header = |name: &str| page.headers[name].as_str();
    assert_eq!(header("cache-control"), "no-store");
    assert_eq!(header("x-content-type-options"), "nosniff");
    assert_eq!(header("referrer-policy"), "no-referrer");
    assert_eq!(header("cross-origin-resource-policy"), "same-origin");
    assert_eq!(header("cross-origin-opener-policy"), "same-origin");
    assert!(
        header("content-security-policy").starts_with("default-src 'none'; script-src 'self' ")
    );
    assert!(!header("content-security-policy").contains("unsafe"));
    assert!(page.headers.keys().all(|name| !name.starts_with("access-control")));
}

#[test]
fn the_first_cube_is_number_0() {
    let server = start(Preset::Jakob2019);
    let data = server.get("cube/0.data");
    assert_eq!(data.status, 200);
    let length = u64::from_le_bytes(data.body[..8].try_into().unwrap());
    let header: Value =
        serde_json::from_slice(&data.body[8..8 + usize::try_from(length).unwrap()]).unwrap();
    let about = header["__metadata__"]["explorer"].as_str().unwrap();
    let about: Value = serde_json::from_str(about).unwrap();
    assert_eq!((&about["name"], &about["resolution"]), (&json!("tiny <cube>"), &json!(4)));
    let script = server.get("cube/0.js");
    assert_eq!(script.headers["content-type"], "text/javascript; charset=utf-8");
    assert_eq!(server.get("cube/0.wgsl").status, 200);
    let borders = server.get("cube/0.borders");
    let shape: Vec<usize> = serde_json::from_value(about["borders"].clone()).unwrap();
    assert_eq!(borders.body.len(), 4 * shape.iter().product::<usize>());
}

#[test]
fn foreign_requests_are_refused() {
    let server = start(Preset::Jakob2019);
    let (host, path) = (server.address, &server.path);
    let status = |request: String| server.exchange(request.as_bytes()).status;
    let token = path.trim_matches('/');
    for (line, expected) in [
        (format!("GET {path} HTTP/1.1\r\nHost: {host}"), 200),
        (format!("GET / HTTP/1.1\r\nHost: {host}"), 404),
        (format!("GET /{} HTTP/1.1\r\nHost: {host}", token.to_uppercase()), 404),
        (format!("GET /{}/ HTTP/1.1\r\nHost: {host}", &token[1..]), 404),
        (format!("GET /{token}0/ HTTP/1.1\r\nHost: {host}"), 404),
        (format!("GET /{}/color HTTP/1.1\r\nHost: {host}", "0".repeat(32)), 404),
        (format!("GET {path} HTTP/1.1\r\nHost: evil.example:{}", host.port()), 421),
        (format!("GET {path} HTTP/1.1\r\nHost: {}", host.ip()), 421),
        (format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nHost: evil.example"), 421),
        (format!("GET {path} HTTP/1.1\r\nX: y"), 421),
        (format!("GET {path} HTTP/1.0"), 421),
        (format!("GET http://evil.example{path} HTTP/1.1\r\nHost: {host}"), 421),
        (format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://evil.example"), 403),
        (format!("GET {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: null"), 403),
        (format!("POST {path}color HTTP/1.1\r\nHost: {host}\r\nSec-Fetch-Site: cross-site"), 403),
        (format!("POST {path}build HTTP/1.1\r\nHost: {host}\r\nSec-Fetch-Site: same-site"), 403),
        (format!("POST {path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: 0"), 405),
        (format!("GET {path}color HTTP/1.1\r\nHost: {host}"), 405),
        (format!("DELETE {path}build/1 HTTP/1.1\r\nHost: {host}"), 405),
        (format!("OPTIONS {path}color HTTP/1.1\r\nHost: {host}"), 405),
        (format!("TRACE {path} HTTP/1.1\r\nHost: {host}"), 405),
    ] {
        assert_eq!(status(format!("{line}\r\n\r\n")), expected, "{line}");
    }
    let origin =
        format!("Origin: http://{host}\r\nSec-Fetch-Site: same-origin\r\nContent-Length: 2\r\n");
    let own = server.exchange(format!("{}{{}}", server.head("POST", "color", &origin)).as_bytes());
    assert_eq!(own.status, 400);
}

#[test]
fn no_path_leads_out() {
    let server = start(Preset::Jakob2019);
    for path in [
        "../../etc/passwd",
        "cube/../../../etc/passwd",
        "cube/..%2f..%2fetc%2fpasswd",
        "cube/%2e%2e/0.data",
        "cube/0.data/../../x",
        "cube/0.data%00.js",
        "cube/-1.data",
        "cube/0",
        "cube/0.",
        "cube/0.exe",
        "cube/4294967296.data",
        "cube/1.data",
        "drop/1.data",
        "drop/..%2f1.data",
        "build/1",
        "build/x",
        "cube/%ff.data",
    ] {
        let found = server.get(path);
        assert!(matches!(found.status, 400 | 404), "{path}: {}", found.status);
    }
    assert_eq!(server.get("drop/1/pixel?x=0&y=0").status, 404);
    assert_eq!(server.get("drop/1/pixel?x=-1&y=0").status, 400);
}

#[test]
fn large_bodies_are_refused_and_the_limit_is_not() {
    const JSON: usize = 64 << 10;
    const TABLE: usize = 1 << 20;
    let server = start(Preset::Jakob2019);
    let chunked = |path: &str, length: usize| {
        let head = server.head("POST", path, "Transfer-Encoding: chunked\r\n");
        let chunk = format!("{:x}\r\n{}\r\n", 4096, "x".repeat(4096));
        let body = chunk.repeat(length / 4096) + "0\r\n\r\n";
        server.exchange((head + &body).as_bytes())
    };
    for (path, limit) in
        [("color", JSON), ("build", JSON), ("light?name=a.csv", TABLE), ("dye?name=a.csv", TABLE)]
    {
        let whole = server.post(path, &vec![b'x'; limit]);
        assert!(matches!(whole.status, 400 | 422), "{path}: {whole:?}");
        assert_eq!(server.post(path, &vec![b'x'; limit + 1]).status, 413, "{path}");
        assert_ne!(chunked(path, limit).status, 413, "{path}");
        let large = chunked(path, limit + 4096);
        assert_eq!(large.status, 413, "{path}");
        assert_eq!(large.error(), format!("a body of more than {limit} bytes"));
    }
    // Stated, and never sent.
    for path in ["picture?name=a.exr", "spectral?name=a.exr", "color"] {
        let head = server.head("POST", path, "Content-Length: 99999999999\r\n");
        assert_eq!(server.exchange(head.as_bytes()).status, 413, "{path}");
    }
    assert_eq!(server.get("").status, 200);
}

#[test]
fn garbage_harms_nothing() {
    let server = start(Preset::Jakob2019);
    let mut garbage: Vec<Vec<u8>> = vec![
        b"\0\0\0\0\r\n\r\n".to_vec(),
        b"GET".to_vec(),
        b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03".to_vec(),
        b"GET / HTTP/9.9\r\n\r\n".to_vec(),
        b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n".to_vec(),
        server.head("POST", "color", "Content-Length: -1\r\n").into_bytes(),
        server.head("POST", "color", "Content-Length: 1\r\nContent-Length: 2\r\n").into_bytes(),
        server.head("POST", "color", "Transfer-Encoding: chunked\r\n").into_bytes(),
        (server.head("POST", "color", "Transfer-Encoding: chunked\r\n") + "zz\r\n").into_bytes(),
        format!("GET / HTTP/1.1\r\nHost: {}\r\n\r\n", "x".repeat(1 << 20)).into_bytes(),
        "X: y\r\n".repeat(100_000).into_bytes(),
    ];
    // The same numbers in each run: a linear congruence.
    let mut state = 1_u32;
    garbage.extend((0..200).map(|length| {
        let next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state.to_be_bytes()[0]
        };
        std::iter::repeat_with(next).take(length).collect()
    }));
    for bytes in garbage {
        let mut stream = server.connect();
        // The server may end the connection while we write.
        let _ = stream.write_all(&bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let mut found = Vec::new();
        let _ = stream.read_to_end(&mut found);
        assert!(!found.starts_with(b"HTTP/1.1 2"), "{:?}", String::from_utf8_lossy(&bytes));
    }
    for bad in
        ["{}", "[]", "{\"cube\":0,\"xyz\":[1,2]}", "{\"cube\":0,\"xyz\":[1e999,0,0]}", "\u{0}"]
    {
        assert_eq!(server.post("color", bad.as_bytes()).status, 400, "{bad}");
    }
    assert_eq!(server.ask("color", &json!({"cube": 0, "xyz": [1e300, 0, 0]})).status, 400);
    assert_eq!(server.ask("color", &json!({"cube": 9, "xyz": [0, 0, 0]})).status, 404);
    assert_eq!(server.get("").status, 200);
}

#[test]
fn ten_thousand_quick_requests_get_the_right_answers() {
    const THREADS: usize = 8;
    const REQUESTS: usize = 10_000;
    let server = start(Preset::Jakob2019);
    let script = server.get("cube/0.js").body;
    let question = json!({ "cube": 0, "xyz": [0.2, 0.3, 0.25] }).to_string();
    let answer = server.post("color", question.as_bytes()).body;
    let length = format!("Content-Length: {}\r\n", question.len());
    let requests = [
        (server.head("GET", "cube/0.js", ""), 200, Some(&script)),
        (server.head("GET", "cube/9.js", ""), 404, None),
        (server.head("POST", "color", &length) + &question, 200, Some(&answer)),
        (format!("GET /x/ HTTP/1.1\r\nHost: {}\r\n\r\n", server.address), 404, None),
        (format!("GET {} HTTP/1.1\r\nHost: evil\r\n\r\n", server.path), 421, None),
    ];
    std::thread::scope(|scope| {
        for thread in 0..THREADS {
            let (server, requests) = (&server, &requests);
            scope.spawn(move || {
                let mut stream = BufReader::new(server.connect());
                for number in 0..REQUESTS / THREADS {
                    // Every tenth on a connection of its own.
                    if number % 10 == 9 {
                        stream = BufReader::new(server.connect());
                    }
                    let (request, status, body) = &requests[(thread + number) % requests.len()];
                    stream.get_mut().write_all(request.as_bytes()).unwrap();
                    let found = read(&mut stream).expect("an answer");
                    assert_eq!(found.status, *status, "{request}");
                    assert!(body.is_none_or(|body| *body == found.body), "{request}");
                }
            });
        }
    });
}

#[test]
fn silent_and_slow_clients_hold_up_nobody() {
    let server = start(Preset::Jakob2019);
    let silent: Vec<TcpStream> = (0..40).map(|_| server.connect()).collect();
    let mut slow = server.connect();
    let head = server.head("GET", "", "");
    for letter in head.as_bytes().chunks(16) {
        slow.write_all(letter).unwrap();
        assert_eq!(server.get("cube/0.wgsl").status, 200);
    }
    assert_eq!(read(&mut BufReader::new(slow)).map(|found| found.status), Some(200));
    drop(silent);
}

#[test]
#[ignore = "slow: silent connections are closed after 15 s"]
fn slow_more_silent_clients_than_places_are_waited_for_and_closed() {
    let server = start(Preset::Jakob2019);
    let silent: Vec<TcpStream> = (0..200).map(|_| server.connect()).collect();
    let start = Instant::now();
    assert_eq!(server.get("").status, 200);
    // 200 connections in turns of 64, of 15 s each.
    assert!(start.elapsed() < Duration::from_secs(60));
    let ended = (&silent[0]).read(&mut [0]);
    assert!(
        matches!(ended, Ok(0)) || ended.is_err_and(|e| e.kind() != std::io::ErrorKind::WouldBlock)
    );
}

#[test]
fn colors_are_explained_by_the_library() {
    let server = start(Preset::Konig2020);
    let contract = Contract::default();
    let preset = Preset::Konig2020;
    let fitter = Fitter::new(&contract, &preset.model(), preset.options()).unwrap();
    let colorimetry = fitter.model().colorimetry();
    for (rgb, standing) in [
        ([0.5, 0.4, 0.3], "reflectance"),
        ([0.9, 0.0, 0.9], "needs_fluorescence"),
        ([0.0, 1.0, 0.0], "unreachable"),
    ] {
        let xyz = colorimetry.xyz_from_rgb(LinearRgb(rgb));
        let found = server.ask("color", &json!({ "cube": 0, "xyz": xyz.0 })).json();
        assert_eq!(found["standing"], standing, "{found}");
        let sentence = found["sentence"].as_str().unwrap();
        assert!(sentence.starts_with("Reachable ") && sentence.ends_with('.'), "{sentence}");
        let fit = fitter.fit(LinearRgb(rgb)).unwrap();
        let close = |a: &Value, b: f64| (a.as_f64().unwrap() - b).abs() < 1e-6;
        assert!(close(&found["fitted"]["de2000"], fit.de2000), "{found}");
        let reflectance = fit.reflectance.to_sigmoid();
        assert!(close(&found["fitted"]["base"][250], reflectance.at(550.0)));
        assert!(found["passive"]["de2000"].as_f64() >= found["reflectance"]["de2000"].as_f64());
        assert_eq!(found["passive"]["fluoresces"], false);
    }
    // Outside the cube's space.
    let found = server.ask("color", &json!({ "cube": 0, "xyz": [0.1, 0.8, 0.0] })).json();
    assert_eq!(found["fitted"], Value::Null);
    assert!(found["fitted_refusal"].as_str().unwrap().contains("expected"), "{found}");
}

#[test]
fn a_new_build_stops_the_one_before() {
    let server = start(Preset::Jakob2019);
    let order = |resolution: &str| {
        let options = json!({ "--preset": "konig2020", "--resolution": resolution });
        server.ask("build", &json!({ "options": options })).json()
    };
    let first = order("64");
    assert_eq!(first["state"], "running");
    let second = order("5");
    assert_eq!(
        second["command"],
        "upglow build -o cube.safetensors --preset konig2020 --resolution 5"
    );
    assert_eq!(server.built(&first["id"])["state"], "stopped");
    let built = server.built(&second["id"]);
    assert_eq!((&built["state"], &built["share"]), (&json!("done"), &json!(1.0)));
    assert_eq!(server.get(&format!("cube/{}.js", built["cube"])).status, 200);
    // By hand.
    let third = order("64");
    assert_eq!(server.post(&format!("build/{}/stop", third["id"]), b"").status, 200);
    assert_eq!(server.built(&third["id"])["state"], "stopped");
    assert_eq!(server.get(&format!("cube/{}.js", third["id"])).status, 404);
}

#[test]
fn the_first_cube_and_the_last_four_are_kept() {
    let server = start(Preset::Jakob2019);
    for number in 1..=6 {
        let job = server.ask("build", &json!({ "options": {} })).json();
        assert_eq!(job["id"], json!(number));
        assert_eq!(server.built(&job["id"])["state"], "done");
    }
    let there = |id: u32| server.get(&format!("cube/{id}.wgsl")).status == 200;
    assert_eq!([0, 1, 2, 3, 4, 5, 6].map(there), [true, false, false, true, true, true, true]);
    assert_eq!(server.get("choices").json()["cubes"].as_array().unwrap().len(), 5);
}

#[test]
fn builds_take_no_path_and_no_other_option() {
    let server = start(Preset::Jakob2019);
    let folder = tempfile::tempdir().unwrap();
    let light = folder.path().join("lamp.csv");
    std::fs::write(&light, lamp()).unwrap();
    let light = light.to_str().unwrap();
    for (name, value, line) in [
        ("--output", "x", "\"--output\", expected an option of --preset"),
        ("-o", "x", "\"-o\", expected"),
        ("--illuminant", light, "--illuminant: unknown illuminant"),
        ("--illuminant", "dropped:../lamp", "--illuminant: dropped:../lamp was not dropped"),
        ("--dyes", folder.path().to_str().unwrap(), "--dyes: unknown dye set"),
        ("--dyes", "dropped", "--dyes: dropped was not dropped"),
        ("--dyes", "dropped/../..", "--dyes: dropped/../.. was not dropped"),
        ("--resolution", "65", "--resolution: 65, expected 2 to 64 in the explorer"),
        ("--space", "x", "--space: "),
    ] {
        let found = server.ask("build", &json!({ "options": { name: value } }));
        assert_eq!(found.status, 400, "{name} {value}");
        assert!(found.error().starts_with(line), "{}", found.error());
    }
}

/// A light as a table.
fn lamp() -> String {
    let rows: String = (300..=830).step_by(5).map(|nm| format!("{nm},{}\n", 1 + nm % 7)).collect();
    format!("wavelength_nm,power\n{rows}")
}

/// A dye as a table.
fn dye(peak: usize) -> String {
    let bell = |nm: usize, at: usize| (-(nm.abs_diff(at) as f64 / 30.0).powi(2)).exp();
    let rows: String = (300..=830)
        .step_by(5)
        .map(|nm| format!("{nm},{:.4},{:.4}\n", bell(nm, peak), bell(nm, peak + 40)))
        .collect();
    format!("wavelength_nm,absorption,emission\n{rows}")
}

#[test]
fn dropped_lights_and_dyes_can_be_built_with() {
    let server = start(Preset::Jakob2019);
    let light = server.post("light?name=..%2Fmy%20lamp.csv", lamp().as_bytes());
    let told = light.json();
    assert_eq!((&told["name"], &told["option"]), (&json!("my lamp"), &json!("dropped:my lamp")));
    assert_eq!(told["nm"].as_array().unwrap().len(), 107);
    assert_eq!(told["weights"].as_array().unwrap().len(), 107);
    let wrong = server.post("light?name=x.csv", b"wavelength_nm,power\n300,-1\n");
    assert_eq!(wrong.status, 422);
    assert!(wrong.error().starts_with("x.csv: ") && !wrong.error().contains("upglow-explore"));
    for (name, peak) in [("blue.csv", 400), ("green.csv", 480)] {
        let found = server.post(&format!("dye?name={name}"), dye(peak).as_bytes());
        assert_eq!(found.status, 200, "{}", found.error());
        assert_eq!(found.json()["option"], "dropped");
    }
    let wrong = server.post("dye?name=y.csv", b"wavelength_nm,absorption\n");
    assert_eq!(wrong.status, 422);
    assert!(
        wrong.error().starts_with("y.csv: header") && !wrong.error().contains("upglow-explore")
    );
    let options =
        json!({ "--illuminant": "dropped:my lamp", "--dyes": "dropped", "--preset": "konig2020" });
    let job = server.ask("build", &json!({ "options": options })).json();
    let line = "upglow build -o cube.safetensors --dyes my-dyes --illuminant 'my lamp.csv' --preset konig2020";
    assert_eq!(job["command"], line);
    let built = server.built(&job["id"]);
    assert_eq!(built["state"], "done", "{built}");
    let data = server.get(&format!("cube/{}.data", built["cube"])).body;
    let text = String::from_utf8_lossy(&data);
    assert!(text.contains("my lamp") && text.contains("green"));
}

/// An OpenEXR file of these channels.
fn exr(size: [usize; 2], channels: &[(&str, &[f32])], space: Option<&str>) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let mut description = ExrDescription::new(size, channels.iter().map(|(name, _)| *name));
    if let Some(space) = space {
        description = description.with_space(&RgbSpace::named(space).unwrap());
    }
    let mut writer = ExrWriter::create(&path, description).unwrap();
    let bands: Vec<&[f32]> = channels.iter().map(|(_, values)| *values).collect();
    writer.write_band(&bands).unwrap();
    writer.finish().unwrap();
    std::fs::read(path).unwrap()
}

#[test]
fn pictures_come_back_in_the_space_of_the_cube() {
    let server = start(Preset::Jakob2019);
    let (width, height) = (1030, 3);
    let ramp: Vec<f32> = (0..width * height).map(|i| i as f32).collect();
    let file = exr([width, height], &[("B", &ramp), ("G", &ramp), ("R", &ramp)], Some("acescg"));
    let told = server.post("picture?name=%3Cramp%3E.exr", &file).json();
    let part = |name: &str| told[name].as_u64().unwrap();
    assert_eq!([part("width"), part("height"), part("step")], [1030, 3, 3]);
    assert_eq!([part("columns"), part("rows")], [344, 1]);
    assert_eq!(told["name"], "<ramp>.exr");
    assert!(told["sentence"].as_str().unwrap().starts_with("RGB space acescg"));
    let colors = server.get(&format!("drop/{}.data", told["id"])).floats();
    assert_eq!((colors.len(), colors[3 * 5]), (3 * 344, 15.0));
    let unstated = exr([1, 1], &[("B", &[0.5]), ("G", &[0.5]), ("R", &[0.5])], None);
    assert_eq!(server.post("picture?name=x.exr", &unstated).status, 422);
    let declared = server.post("picture?name=x.exr&space=srgb&encoding=linear", &unstated);
    assert_eq!(declared.status, 200, "{}", declared.error());
    assert_eq!(server.post("picture?name=x.exr&space=none", &unstated).status, 400);
}

#[test]
fn damaged_pictures_are_refused_with_the_sentence_of_the_library() {
    let server = start(Preset::Jakob2019);
    let ramp = [0.5; 64];
    let whole = exr([8, 8], &[("B", &ramp), ("G", &ramp), ("R", &ramp)], Some("acescg"));
    let folder = tempfile::tempdir().unwrap();
    let mut flipped = whole.clone();
    flipped[20] ^= 0xff;
    let damaged: [(&str, &[u8]); 5] = [
        ("a.exr", &[]),
        ("a.exr", b"no picture at all"),
        ("a.exr", &whole[..100]),
        ("a.png", b"\x89PNG\r\n\x1a\n\0\0\0\0"),
        ("a.exr", &flipped),
    ];
    for (name, bytes) in damaged {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let expected = Picture::open(&path).unwrap_err().to_string();
        let found = server.post(&format!("picture?name={name}"), bytes);
        assert_eq!((found.status, found.error()), (422, format!("{name}: {expected}")));
    }
    // The header is whole, the rows are not.
    let cut = server.post("picture?name=a.exr", &whole[..whole.len() - 10]);
    assert_eq!(cut.status, 422);
    for bytes in [&b"no picture at all"[..], &whole[..100]] {
        let path = folder.path().join("s.exr");
        std::fs::write(&path, bytes).unwrap();
        let expected = SpectralPicture::open(&path).unwrap_err().to_string();
        let found = server.post("spectral?name=s.exr", bytes);
        assert_eq!((found.status, found.error()), (422, format!("s.exr: {expected}")));
    }
    let rgb = server.post("spectral?name=s.exr", &whole);
    assert!(rgb.error().contains("no spectral channel"), "{}", rgb.error());
}

#[test]
fn spectra_of_a_file_come_as_curves_and_colors() {
    let server = start(Preset::Jakob2019);
    let channels: [(&str, &[f32]); 3] = [
        // Halves hold these numbers exactly.
        ("T.400,000000nm", &[0.25, 0.0]),
        ("T.500,000000nm", &[0.5, 0.0]),
        ("T.600,000000nm", &[0.75, 0.0]),
    ];
    let told = server.post("spectral?name=s.exr", &exr([2, 1], &channels, None)).json();
    assert_eq!((&told["kind"], &told["width"]), (&json!("reflectance"), &json!(2)), "{told}");
    assert!(told["notes"][0].as_str().unwrap().starts_with("The file has 400 to 600 nm"));
    let id = told["id"].clone();
    let pixel = server.get(&format!("drop/{id}/pixel?x=0&y=0")).json();
    let at = |nm: usize| pixel["reflectance"][nm - 300].as_f64().unwrap();
    for (nm, expected) in
        [(300, 0.25), (400, 0.25), (450, 0.375), (575, 0.6875), (600, 0.75), (830, 0.75)]
    {
        assert!((at(nm) - expected).abs() < 1e-6, "{nm}: {}", at(nm));
    }
    assert_eq!((&pixel["fluoresces"], &pixel["moved"]), (&json!(false), &Value::Null));
    let colors = server.get(&format!("drop/{id}.data")).floats();
    assert!(colors[0] > colors[2] && colors[3..] == [0.0; 3], "{colors:?}");
    assert_eq!(server.get(&format!("drop/{id}/pixel?x=2&y=0")).status, 400);
    let light: [(&str, &[f32]); 1] = [("S0.500,000000nm", &[0.4])];
    let refused = server.post("spectral?name=s.exr", &exr([1, 1], &light, None));
    assert!(refused.error().contains("spectra of light"), "{}", refused.error());
}

#[test]
fn re_radiation_of_a_file_has_the_unit_it_states_or_is_declared_to_have() {
    let server = start(Preset::Jakob2019);
    // A tenth of the light at 400 nm leaves in the band of 500 nm.
    let channels: [(&str, &[f32]); 4] = [
        ("T.400,000000nm", &[0.2]),
        ("T.400,000000nm.500,000000nm", &[0.1]),
        ("T.450,000000nm", &[0.3]),
        ("T.500,000000nm", &[0.4]),
    ];
    let file = exr([1, 1], &channels, None);
    let unstated = server.post("spectral?name=s.exr", &file).json();
    assert_eq!((&unstated["kind"], &unstated["unit"]), (&json!("reflectance"), &Value::Null));
    let notes = unstated["notes"].to_string();
    assert!(notes.contains("the file does not state the unit"), "{notes}");
    let told = server.post("spectral?name=s.exr&unit=per%20nm", &file).json();
    assert_eq!((&told["kind"], &told["unit"]), (&json!("bispectral"), &json!("per nm")), "{told}");
    let pixel = server.get(&format!("drop/{}/pixel?x=0&y=0", told["id"])).json();
    assert_eq!(pixel["fluoresces"], true);
    let moved = pixel["response"].as_array().unwrap();
    let y = |nm: usize| moved[3 * (nm - 300) + 1].as_f64().unwrap();
    assert!(y(400) > 0.0 && y(330) == 0.0 && y(700) == 0.0);
    assert_eq!(server.post("spectral?name=s.exr&unit=x", &file).status, 400);
}
