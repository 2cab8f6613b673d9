//! `upglow explore`: the server as a user starts it, asks it and ends it.
#![cfg(all(feature = "explore", target_os = "linux"))]
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod support;

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt as _;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use support::{Folder, dye, stoppable};
use upglow_color::RgbSpace;
use upglow_image::{ExrDescription, ExrWriter};

/// Far longer than the program takes to stop on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// The program `upglow explore`, killed at the end of a test that fails.
struct Explorer {
    child: Child,
    stdout: BufReader<ChildStdout>,
    host: String,
    path: String,
}

impl Drop for Explorer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Explorer {
    /// Starts the program in a folder; its temporary files are in the folder `temporary` there.
    fn start(folder: &Folder, words: &str) -> Self {
        let temporary = folder.path().join("temporary");
        std::fs::create_dir_all(&temporary).unwrap();
        let mut child = stoppable()
            .args(["explore", "--no-open"])
            .args(words.split_whitespace())
            .current_dir(folder.path())
            .env("TMPDIR", temporary)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut stdout = BufReader::new(child.stdout.take().unwrap());
        let mut address = String::new();
        stdout.read_line(&mut address).unwrap();
        let (host, path) = address.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
        let (host, path) = (host.into(), format!("/{path}"));
        Self { child, stdout, host, path }
    }

    /// The status and the body of an answer.
    fn ask(&self, method: &str, path: &str, body: &[u8]) -> (u16, Vec<u8>) {
        let Self { host, path: root, .. } = self;
        let length = body.len();
        let head = format!(
            "{method} {root}{path} HTTP/1.1\r\nHost: {host}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n"
        );
        let mut stream = TcpStream::connect(host).unwrap();
        stream.write_all(&[head.as_bytes(), body].concat()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let status = std::str::from_utf8(&answer[9..12]).unwrap().parse().unwrap();
        (status, answer[end + 4..].to_vec())
    }

    fn json(&self, method: &str, path: &str, body: &[u8]) -> Value {
        let (status, body) = self.ask(method, path, body);
        assert_eq!(status, 200, "{path}: {}", String::from_utf8_lossy(&body));
        serde_json::from_slice(&body).unwrap()
    }

    /// Ends the program by a signal, and returns its status and the rest of its output.
    fn end(mut self, signal: &str) -> (Option<i32>, String) {
        let start = Instant::now();
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        let status = self.child.wait().unwrap();
        assert!(start.elapsed() < PATIENCE, "it took too long to stop");
        let mut rest = String::new();
        self.stdout.read_to_string(&mut rest).unwrap();
        self.child.stderr.take().unwrap().read_to_string(&mut rest).unwrap();
        (status.code(), rest)
    }
}

fn folder_with_cube() -> Folder {
    let folder = Folder::new();
    folder.done("build --resolution 9 -o cube.safetensors");
    folder
}

/// Four colors that materials match, as linear ACEScg; halves hold them exactly.
const COLORS: [[f32; 3]; 4] =
    [[0.5, 0.375, 0.25], [0.875, 0.0, 0.875], [0.25, 0.25, 0.25], [0.125, 0.75, 0.5]];

fn write_picture(folder: &Folder) {
    let channel = |k: usize| COLORS.map(|rgb| rgb[k]);
    let description = ExrDescription::new([2, 2], ["R", "G", "B"]).with_space(&RgbSpace::default());
    let mut writer = ExrWriter::create(folder.path().join("four.exr"), description).unwrap();
    let channels = [0, 1, 2].map(channel);
    writer.write_band(&channels.each_ref().map(|channel| &channel[..])).unwrap();
    writer.finish().unwrap();
}

fn floats(bytes: &[u8]) -> Vec<f32> {
    bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect()
}

#[test]
fn ctrl_c_and_termination_end_it_and_its_files_are_gone() {
    let folder = folder_with_cube();
    write_picture(&folder);
    for signal in ["-INT", "-TERM"] {
        let explorer = Explorer::start(&folder, "cube.safetensors");
        assert_eq!(explorer.ask("GET", "", b"").0, 200);
        // A dropped file is there, a build runs, and a browser keeps its connection.
        explorer.json("POST", "dye?name=a.csv", dye(400).as_bytes());
        let options = json!({ "options": { "--resolution": "64", "--preset": "konig2020" } });
        explorer.json("POST", "build", options.to_string().as_bytes());
        let _kept = TcpStream::connect(&explorer.host).unwrap();
        let temporary = folder.path().join("temporary");
        let folders: Vec<_> = temporary.read_dir().unwrap().flatten().collect();
        assert_eq!(folders.len(), 1);
        // For nobody else to read.
        assert_eq!(folders[0].metadata().unwrap().permissions().mode() & 0o777, 0o700);
        assert_eq!(explorer.end(signal), (Some(0), String::new()));
        assert_eq!(temporary.read_dir().unwrap().count(), 0, "{signal}");
    }
}

#[test]
fn pictures_come_back_as_their_colors_and_baked_spectra_too() {
    // The greatest difference of a channel, for reflectances and for the magenta one, whose dyes move some
    // light to shorter wavelengths, for which the layout has no channels.
    const BANDS: [(&str, [f32; 2]); 2] =
        [("--bands 300:830:5 --compact", [1e-5, 0.05]), ("--bands 300:820:20", [0.02, 0.1])];
    const MAGENTA: usize = 1;
    let folder = folder_with_cube();
    write_picture(&folder);
    folder.done(
        "bake cube.safetensors four.exr -o light.exr --as radiance --light D65 --sample float",
    );
    for (i, (bands, _)) in BANDS.iter().enumerate() {
        let words = format!("-o spectral{i}.exr --as spectral {bands} --sample float");
        folder.done(&format!("bake cube.safetensors four.exr {words}"));
    }
    let explorer = Explorer::start(&folder, "cube.safetensors");
    let colors = |path: &str, file: &str| {
        let told = explorer.json("POST", &format!("{path}?name={file}"), &folder.read(file));
        (floats(&explorer.ask("GET", &format!("drop/{}.data", told["id"]), b"").1), told)
    };
    assert_eq!(colors("picture", "four.exr").0, COLORS.concat());
    let (baked, _) = colors("picture", "light.exr");
    for (i, (bands, most)) in BANDS.iter().enumerate() {
        let (spectral, told) = colors("spectral", &format!("spectral{i}.exr"));
        assert_eq!(told["kind"], "bispectral", "{told}");
        let off = |(a, b): (&f32, &f32)| (a - b).abs();
        for (texel, (a, b)) in spectral.chunks(3).zip(baked.chunks(3)).enumerate() {
            let greatest = a.iter().zip(b).map(off).fold(0.0, f32::max);
            let most = most[usize::from(texel == MAGENTA)];
            assert!(greatest < most, "{bands}, texel {texel}: {a:?}, expected {b:?}");
        }
        let pixel = explorer.json("GET", &format!("drop/{}/pixel?x=1&y=0", told["id"]), b"");
        assert_eq!(pixel["fluoresces"], true);
    }
    assert_eq!(explorer.end("-INT").0, Some(0));
}

#[test]
fn a_direct_fit_is_that_of_the_command_color() {
    /// Single precision, and XYZ in place of RGB.
    const ROUNDING: f64 = 1e-5;
    let folder = folder_with_cube();
    let explorer = Explorer::start(&folder, "cube.safetensors");
    for rgb in ["0.5 0.4 0.3", "0.9 0 0.9", "0 1 0"] {
        let told = folder.json(&format!("color cube.safetensors {rgb} --direct"));
        let question = json!({ "cube": 0, "xyz": told["xyz"] }).to_string();
        let found = explorer.json("POST", "color", question.as_bytes());
        let numbers = |value: &Value| -> Vec<f64> {
            value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
        };
        let curves = [&found["fitted"]["reflectance"], &told["curves"]["reflectance"]];
        let [ours, theirs] = curves.map(numbers);
        assert_eq!(ours.len(), theirs.len());
        let off = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < ROUNDING, "{rgb}: {off}");
        assert_eq!(found["standing"], told["standing"]["kind"]);
        assert_eq!(found["fitted"]["kind"], told["kind"]);
        let text = folder.done(&format!("color cube.safetensors {rgb} --direct"));
        let sentence = found["sentence"].as_str().unwrap().trim_start_matches("Reachable ");
        assert!(text.contains(sentence.trim_end_matches('.')), "{sentence}: {text}");
    }
}

#[test]
fn a_port_in_use_and_a_cube_that_is_none_are_refused() {
    let folder = folder_with_cube();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let words = format!("explore cube.safetensors --no-open --port {port}");
    let line = folder.refused(2, &words);
    assert!(line.starts_with(&format!("--port: port {port} of this machine, expected")), "{line}");
    assert!(folder.refused(1, "explore none --no-open").starts_with("none: no such file"));
    assert!(folder.refused(2, "explore --port 70000").starts_with("--port: \"70000\", expected"));
}
