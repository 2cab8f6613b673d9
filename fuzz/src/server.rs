//! Requests to the explorer's server, over the loopback interface.

use std::collections::BTreeMap;
use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::OnceLock;
use std::time::Duration;

use upglow::{Cube, Edge, FitRecord, Fluorescence, Model, Node};
use upglow_color::Contract;
use upglow_explorer::{Planner, Server};

/// No request takes longer.
const TIME: Duration = Duration::from_secs(20);
/// A longer body of a request is cut.
const MOST_BODY_BYTES: usize = 1 << 16;

struct Running {
    address: SocketAddr,
    path: String,
}

fn server() -> &'static Running {
    static SERVER: OnceLock<Running> = OnceLock::new();
    SERVER.get_or_init(|| {
        let gray = Edge { edge_nm: 550.0, level: 0.0, slope_per_nm: 0.0 };
        let nodes = vec![Node::new(gray, Fluorescence::None, 0.0); 8];
        let record = FitRecord::default();
        let cube = Cube::new(Contract::default(), Model::Reflectance, record, 2, nodes);
        let plan = |_: &BTreeMap<String, String>| Err("builds nothing".to_owned());
        let planner = Planner { options: Vec::new(), plan: Box::new(plan) };
        let server = Server::new(cube.expect("a gray cube"), "gray", planner, 0);
        let server = server.expect("a port of this machine");
        let address = server.address().strip_prefix("http://").expect("it begins so");
        let (host, path) = address.split_once('/').expect("a path");
        let (address, path) = (host.parse().expect("an address"), format!("/{path}"));
        std::thread::spawn(move || server.run(|| false));
        Running { address, path }
    })
}

/// A request: a line with its method and its path behind that of the page, then its body. If the first byte is a
/// zero, what follows is all that is sent.
pub(crate) fn explorer(bytes: &[u8]) {
    let Running { address, path } = server();
    let mut stream = TcpStream::connect(address).expect("the server is there");
    stream.set_read_timeout(Some(TIME)).expect("a time");
    let request = match bytes {
        [0, raw @ ..] => raw.to_vec(),
        _ => request(bytes, *address, path),
    };
    // The server may have refused and closed before all is sent.
    let _ = stream.write_all(&request);
    let _ = stream.shutdown(std::net::Shutdown::Write);
    let mut answer = Vec::new();
    let ended = stream.read_to_end(&mut answer);
    let is_timeout = ended.is_err_and(|error| {
        matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut)
    });
    assert!(!is_timeout, "no answer in {} s", TIME.as_secs());
    let status = answer.get(9..12).unwrap_or_default();
    assert!(answer.is_empty() || answer.starts_with(b"HTTP/1."), "an answer that is not HTTP");
    assert!(!status.starts_with(b"500"), "{}", String::from_utf8_lossy(&answer));
}

fn request(bytes: &[u8], address: SocketAddr, path: &str) -> Vec<u8> {
    let end = bytes.iter().position(|byte| *byte == b'\n').unwrap_or(bytes.len());
    let (line, body) = bytes.split_at(end);
    let body = body.get(1..).unwrap_or_default();
    let body = &body[..body.len().min(MOST_BODY_BYTES)];
    let space = line.iter().position(|byte| *byte == b' ').unwrap_or(line.len());
    let (method, rest) = line.split_at(space);
    let head = format!(
        " HTTP/1.1\r\nHost: {address}\r\nOrigin: http://{address}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n",
        body.len()
    );
    [method, b" ", path.as_bytes(), rest.get(1..).unwrap_or_default(), head.as_bytes(), body]
        .concat()
}
