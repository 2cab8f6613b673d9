//! What browsers let the page load and do: its own script and style, this server, and nothing else.

use axum::http::HeaderValue;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest as _, Sha256};

const SCRIPT: &str = "<script type=\"module\">";
const STYLE: &str = "<style>";

/// The Content-Security-Policy of a page with one script and one style inside. `self` in `script-src`
/// lets it import the functions of a cube.
pub(super) fn policy(page: &str) -> HeaderValue {
    let script = hash(inside(page, SCRIPT, "</script>"));
    let style = hash(inside(page, STYLE, "</style>"));
    let text = format!(
        "default-src 'none'; script-src 'self' {script}; style-src {style}; img-src data: blob:; \
         connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    HeaderValue::try_from(text).expect("base64 and words are letters of ASCII")
}

/// The text of the first element with this start; empty if there is none.
fn inside<'p>(page: &'p str, start: &str, end: &str) -> &'p str {
    let rest = page.split_once(start).map_or("", |(_, rest)| rest);
    rest.split_once(end).map_or("", |(text, _)| text)
}

fn hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::served_page;

    #[test]
    fn the_hash_is_that_of_browsers() {
        // From the specification of Content Security Policy Level 3, section 7.5.
        let expected = "'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='";
        assert_eq!(hash("alert('Hello, world.');"), expected);
    }

    #[test]
    fn the_page_has_one_script_and_one_style_that_the_policy_allows() {
        let page = served_page();
        for (start, any) in [(SCRIPT, "<script"), (STYLE, "<style")] {
            assert_eq!((page.matches(start).count(), page.matches(any).count()), (1, 1), "{start}");
        }
        assert!(!page.contains(" style=\"") && !page.contains(" onclick="));
        let text = policy(&page);
        let text = text.to_str().unwrap();
        for (start, end) in [(SCRIPT, "</script>"), (STYLE, "</style>")] {
            let content = page.split(start).nth(1).unwrap().split(end).next().unwrap();
            assert!(text.contains(&hash(content)), "{start}");
        }
    }
}
