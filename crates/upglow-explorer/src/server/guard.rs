//! Who may ask: only the page that this server gave out, opened from the address that it printed.
//!
//! The token in the address keeps out other programs and users of the machine. The names of the host keep
//! out pages of other sites whose names lead here; the origin, those that send requests to here.

use std::hint::black_box;
use std::sync::Arc;

use axum::extract::{Request, State};
use axum::http::header::{self, HeaderMap, HeaderName, HeaderValue};
use axum::http::{Method, StatusCode, Uri};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::answer::Refusal;

/// Random bytes of a token: more than can be guessed.
const TOKEN_BYTES: usize = 16;

/// Says from which kind of page a request comes; browsers set it, and scripts cannot.
const SEC_FETCH_SITE: HeaderName = HeaderName::from_static("sec-fetch-site");

/// What every answer carries: it is not kept, guessed at, embedded or passed on.
const HEADERS: [(HeaderName, &str); 5] = [
    (header::CACHE_CONTROL, "no-store"),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
];

/// Decides which requests are carried out.
#[derive(Debug)]
pub(super) struct Guard {
    token: String,
    /// The names by which a browser may know this server, with the port.
    hosts: Vec<String>,
    /// What the page may load and do.
    policy: HeaderValue,
}

impl Guard {
    /// A guard with a new token for a page with this Content-Security-Policy.
    pub(super) fn new(port: u16, policy: HeaderValue) -> Result<Self, getrandom::Error> {
        let mut random = [0; TOKEN_BYTES];
        getrandom::fill(&mut random)?;
        let token = random.iter().map(|byte| format!("{byte:02x}")).collect();
        let names = ["127.0.0.1", "localhost"];
        let mut hosts: Vec<String> = names.map(|name| format!("{name}:{port}")).into();
        if port == 80 {
            // Browsers leave the port of http away.
            hosts.extend(names.map(String::from));
        }
        Ok(Self { token, hosts, policy })
    }

    /// The path of the page.
    pub(super) fn path(&self) -> String {
        format!("/{}/", self.token)
    }

    fn check(&self, method: &Method, uri: &Uri, headers: &HeaderMap) -> Result<(), Refusal> {
        let host = self.host(uri, headers).ok_or_else(|| {
            let error = format!("a foreign host, expected {}", self.hosts.join(" or "));
            Refusal::new(StatusCode::MISDIRECTED_REQUEST, error)
        })?;
        if !self.has_token(uri.path()) {
            return Err(Refusal::not_found("page"));
        }
        let foreign = |what: &str| {
            let error = format!("a foreign {what}, expected the page of this server");
            Refusal::new(StatusCode::FORBIDDEN, error)
        };
        let is_own = |origin: &HeaderValue| {
            origin.as_bytes().strip_prefix(b"http://") == Some(host.as_bytes())
        };
        if !headers.get_all(header::ORIGIN).iter().all(is_own) {
            return Err(foreign("origin"));
        }
        let is_same = |site: &HeaderValue| site == "same-origin";
        if method != Method::GET && !headers.get_all(SEC_FETCH_SITE).iter().all(is_same) {
            return Err(foreign("site"));
        }
        Ok(())
    }

    /// The name that the client knows this server by; `None` for any other name.
    fn host<'g>(&'g self, uri: &Uri, headers: &HeaderMap) -> Option<&'g str> {
        let mut named = headers.get_all(header::HOST).iter();
        let (Some(name), None) = (named.next(), named.next()) else { return None };
        let host = self.hosts.iter().find(|host| name.as_bytes() == host.as_bytes())?;
        let in_address = uri.authority().is_none_or(|authority| authority.as_str() == host);
        in_address.then_some(host)
    }

    /// Whether a path begins with the token; takes as long for any wrong one.
    fn has_token(&self, path: &str) -> bool {
        let found = path.strip_prefix('/').and_then(|rest| rest.split_once('/'));
        let (found, token) =
            (found.map_or("", |(found, _)| found).as_bytes(), self.token.as_bytes());
        let differing = token.iter().zip(found).fold(0, |all, (a, b)| black_box(all | (a ^ b)));
        found.len() == token.len() && differing == 0
    }

    fn seal(&self, response: &mut Response) {
        let headers = response.headers_mut();
        for (name, value) in HEADERS {
            headers.insert(name, HeaderValue::from_static(value));
        }
        headers.insert(header::CONTENT_SECURITY_POLICY, self.policy.clone());
    }
}

/// Refuses foreign requests, and adds to every answer what browsers must heed.
pub(super) async fn guarded(
    State(guard): State<Arc<Guard>>,
    request: Request,
    next: Next,
) -> Response {
    let checked = guard.check(request.method(), request.uri(), request.headers());
    let mut response = match checked {
        Ok(()) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    };
    guard.seal(&mut response);
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    const PORT: u16 = 8123;

    fn guard() -> Guard {
        Guard::new(PORT, HeaderValue::from_static("default-src 'none'")).unwrap()
    }

    fn status(method: Method, uri: &str, headers: &[(HeaderName, &str)]) -> Option<u16> {
        let guard = guard();
        let uri = uri.replace("TOKEN", &guard.token).parse().unwrap();
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.append(name, value.parse().unwrap());
        }
        guard.check(&method, &uri, &map).err().map(|refusal| refusal.status.as_u16())
    }

    const HOST: (HeaderName, &str) = (header::HOST, "127.0.0.1:8123");

    #[test]
    fn tokens_are_long_and_differ() {
        let [a, b] = [guard(), guard()];
        assert_eq!(a.token.len(), 2 * TOKEN_BYTES);
        assert_ne!(a.token, b.token);
    }

    #[test]
    fn only_the_token_opens() {
        let get = |uri| status(Method::GET, uri, &[HOST]);
        assert_eq!(get("/TOKEN/"), None);
        assert_eq!(get("/TOKEN/cube/0.data"), None);
        for uri in ["/", "/TOKEN", "/x/TOKEN/", "/TOKENx/", "/xTOKEN/", "//TOKEN/", "/a/", "*"] {
            assert_eq!(get(uri), Some(404), "{uri}");
        }
    }

    #[test]
    fn only_this_server_is_asked() {
        let get = |hosts: &[&str]| {
            let hosts: Vec<_> = hosts.iter().map(|host| (header::HOST, *host)).collect();
            status(Method::GET, "/TOKEN/", &hosts)
        };
        assert_eq!(get(&["localhost:8123"]), None);
        let foreign = [
            "evil.example:8123",
            "127.0.0.1:8124",
            "127.0.0.1",
            "127.0.0.1:8123.evil",
            "",
            "[::1]:8123",
        ];
        for host in foreign {
            assert_eq!(get(&[host]), Some(421), "{host}");
        }
        assert_eq!(get(&[]), Some(421));
        assert_eq!(get(&["localhost:8123", "evil.example"]), Some(421));
        let absolute = "http://evil.example/TOKEN/";
        assert_eq!(status(Method::GET, absolute, &[HOST]), Some(421));
    }

    #[test]
    fn only_its_own_page_asks() {
        let post =
            |name: HeaderName, value| status(Method::POST, "/TOKEN/color", &[HOST, (name, value)]);
        assert_eq!(status(Method::POST, "/TOKEN/color", &[HOST]), None);
        assert_eq!(post(header::ORIGIN, "http://127.0.0.1:8123"), None);
        let foreign =
            ["null", "http://evil.example", "https://127.0.0.1:8123", "http://localhost:8123"];
        for origin in foreign {
            assert_eq!(post(header::ORIGIN, origin), Some(403), "{origin}");
        }
        assert_eq!(post(SEC_FETCH_SITE, "same-origin"), None);
        for site in ["cross-site", "same-site", "none"] {
            assert_eq!(post(SEC_FETCH_SITE, site), Some(403), "{site}");
        }
    }
}
