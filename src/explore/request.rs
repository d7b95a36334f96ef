//! What a browser asks for: one request is read, up to limits, and held against the rules of who
//! may ask.
//!
//! The server is on the loopback address, where every page that the user has open may send requests
//! to it. So a request has to know the token of the address, has to call the server by its own name
//! (or a name that somebody else has pointed at 127.0.0.1 would do), and must not come from a page
//! of another origin.

use std::io::Read;
use std::net::TcpStream;
use std::time::{Duration, Instant};

use super::answer::{HttpAnswer, HttpStatus};

/// Longest head of a request, bytes; browsers send some 700 without the query.
const LONGEST_HEAD: usize = 64 * 1024;
/// Longest query, bytes: a table of some thousand measured points.
pub const LONGEST_QUERY: usize = 48 * 1024;
/// Most headers.
const MOST_HEADERS: usize = 64;
/// A request has to be there within this time, however slowly it is sent,
const PATIENCE: Duration = Duration::from_secs(5);
/// and to begin within this: browsers open connections beforehand, which others should not wait
/// for.
const SILENCE: Duration = Duration::from_secs(1);

/// How a request is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HttpMethod {
    /// Asks, and changes nothing.
    Get,
    /// The same without the body of the answer.
    Head,
    /// Starts or ends something.
    Post,
}

/// A request that may be answered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpRequest {
    /// How it is meant.
    pub method: HttpMethod,
    /// The path below the token, without a slash at the start: empty for the page itself.
    pub path: String,
    /// What stands after the question mark, as it came.
    pub query: String,
}

/// Who may ask.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gate {
    token: String,
    port: u16,
}

impl Gate {
    /// For a server on this port of the loopback address.
    pub fn new(token: String, port: u16) -> Self {
        Self { token, port }
    }

    /// The address that opens the page.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// The names by which the server may be called.
    fn names(&self) -> [String; 2] {
        // Browsers leave out the port that HTTP has by itself.
        let port = if self.port == 80 { String::new() } else { format!(":{}", self.port) };
        ["127.0.0.1", "localhost"].map(|name| format!("{name}{port}"))
    }

    /// Reads a request from a connection and judges it; `None` where nobody asks anything.
    pub fn receive(&self, stream: &mut TcpStream) -> Option<Result<HttpRequest, HttpAnswer>> {
        match read_head(stream) {
            RequestHead::Nothing => None,
            RequestHead::TooSlow => Some(Err(refused(HttpStatus::Timeout, "the request was not complete after 5 seconds"))),
            RequestHead::TooLong => Some(Err(refused(HttpStatus::HeadTooLong, &longer("head of the request", LONGEST_HEAD)))),
            RequestHead::Whole(bytes) => Some(self.judge(&bytes)),
        }
    }

    /// A request from its head, or why it is not answered.
    ///
    /// # Errors
    /// The answer that says what is wrong.
    pub fn judge(&self, head: &[u8]) -> Result<HttpRequest, HttpAnswer> {
        let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
        let mut parsed = httparse::Request::new(&mut headers);
        match parsed.parse(head) {
            Ok(httparse::Status::Complete(_)) => {}
            Ok(httparse::Status::Partial) => return Err(refused(HttpStatus::Bad, "the request ends in its head")),
            Err(error) => return Err(refused(HttpStatus::Bad, &format!("this is no HTTP request: {error}"))),
        }
        let header = |name: &str| -> Result<Option<&str>, HttpAnswer> {
            let mut found = parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
            let Some(first) = found.next() else { return Ok(None) };
            let text = std::str::from_utf8(first.value).ok().filter(|_| found.next().is_none());
            text.map(Some).ok_or_else(|| refused(HttpStatus::Bad, &format!("the header {name} is no text, or is there twice")))
        };
        if !header("host")?.is_some_and(|host| self.names().iter().any(|name| name.eq_ignore_ascii_case(host))) {
            return Err(refused(
                HttpStatus::Misdirected,
                "this server is called 127.0.0.1 or localhost, with its port, and by no other name",
            ));
        }
        let origin = header("origin")?;
        if origin.is_some_and(|origin| !self.names().iter().any(|name| origin == format!("http://{name}"))) {
            return Err(refused(HttpStatus::Forbidden, "the request comes from a page of another origin"));
        }
        let method = match parsed.method {
            Some("GET") => HttpMethod::Get,
            Some("HEAD") => HttpMethod::Head,
            Some("POST") if origin.is_none() => {
                return Err(refused(HttpStatus::Forbidden, "a POST has to say from which page it comes"));
            }
            Some("POST") => HttpMethod::Post,
            _ => return Err(refused(HttpStatus::Method, "GET, HEAD and POST are answered, nothing else")),
        };
        let has_body =
            header("content-length")?.is_some_and(|length| length.trim() != "0") || header("transfer-encoding")?.is_some();
        if has_body {
            return Err(refused(HttpStatus::TooLarge, "requests have no body here"));
        }
        self.place(method, parsed.path.unwrap_or_default(), header("sec-fetch-site")?, header("sec-fetch-mode")?)
    }

    /// Holds the path against the token.
    fn place(&self, method: HttpMethod, target: &str, site: Option<&str>, mode: Option<&str>) -> Result<HttpRequest, HttpAnswer> {
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        if query.len() > LONGEST_QUERY || path.len() > LONGEST_QUERY {
            return Err(refused(HttpStatus::QueryTooLong, &longer("query", LONGEST_QUERY)));
        }
        let parts = path.strip_prefix('/').and_then(|path| path.split_once('/'));
        let Some((_, rest)) = parts.filter(|(token, _)| same(token.as_bytes(), self.token.as_bytes())) else {
            let why = "the address has not the token of this server; open the one that `asperity explore` printed";
            return Err(refused(HttpStatus::Forbidden, why));
        };
        // A picture or a script on a page of somebody else's; a link there may be followed.
        if site == Some("cross-site") && mode != Some("navigate") {
            return Err(refused(HttpStatus::Forbidden, "the request comes from a page of another site"));
        }
        Ok(HttpRequest { method, path: rest.to_owned(), query: query.to_owned() })
    }
}

fn longer(what: &str, bytes: usize) -> String {
    format!("the {what} is longer than {} KiB", bytes / 1024)
}

fn refused(status: HttpStatus, why: &str) -> HttpAnswer {
    HttpAnswer::plain(status, &format!("asperity explore: {why}.\n"))
}

/// Whether two words are the same, in a time that tells nothing of where they differ.
fn same(one: &[u8], other: &[u8]) -> bool {
    one.len() == other.len() && one.iter().zip(other).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

/// What came over a connection.
enum RequestHead {
    Nothing,
    TooSlow,
    TooLong,
    Whole(Vec<u8>),
}

fn read_head(stream: &mut TcpStream) -> RequestHead {
    let begun = Instant::now();
    let mut head = Vec::new();
    let mut part = [0u8; 2048];
    loop {
        let left = if head.is_empty() { SILENCE } else { PATIENCE }.saturating_sub(begun.elapsed());
        if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
            return if head.is_empty() { RequestHead::Nothing } else { RequestHead::TooSlow };
        }
        match stream.read(&mut part) {
            Ok(0) => return RequestHead::Nothing,
            Ok(count) => head.extend_from_slice(&part[..count]),
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(_) => return if head.is_empty() { RequestHead::Nothing } else { RequestHead::TooSlow },
        }
        if head.windows(4).any(|end| end == b"\r\n\r\n") {
            return RequestHead::Whole(head);
        }
        if head.len() > LONGEST_HEAD {
            return RequestHead::TooLong;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN: &str = "0123456789abcdef0123456789abcdef";

    fn judged(text: &str) -> Result<HttpRequest, u16> {
        let head = text.replace('\n', "\r\n") + "\r\n\r\n";
        Gate::new(TOKEN.to_owned(), 8123).judge(head.as_bytes()).map_err(|answer| answer.status.code())
    }

    fn get(path: &str, more: &str) -> Result<HttpRequest, u16> {
        judged(&format!("GET {path} HTTP/1.1\nHost: 127.0.0.1:8123{more}"))
    }

    #[test]
    fn who_has_the_address_is_answered() {
        let request = get(&format!("/{TOKEN}/curves?E=1&nu=0.3"), "").unwrap();
        assert_eq!((request.method, request.path.as_str(), request.query.as_str()), (HttpMethod::Get, "curves", "E=1&nu=0.3"));
        assert_eq!(get(&format!("/{TOKEN}/"), "").unwrap().path, "");
        assert!(judged(&format!("GET /{TOKEN}/ HTTP/1.1\nHost: localhost:8123")).is_ok());
    }

    #[test]
    fn another_token_is_refused() {
        for path in ["/", "/curves", "/0123456789abcdef0123456789abcdeg/", "/0123456789abcdef/", &format!("//{TOKEN}/"), TOKEN] {
            assert_eq!(get(path, ""), Err(403), "{path}");
        }
        // Case matters, and so does what stands before the token.
        assert_eq!(get(&format!("/{}/", TOKEN.to_uppercase()), ""), Err(403));
        assert_eq!(get(&format!("http://127.0.0.1:8123/{TOKEN}/"), ""), Err(403));
    }

    #[test]
    fn a_name_that_was_pointed_at_the_loopback_address_is_refused() {
        for host in ["evil.example:8123", "evil.example", "127.0.0.1", "127.0.0.1:80", "127.0.0.1:8123.evil.example", ""] {
            assert_eq!(judged(&format!("GET /{TOKEN}/ HTTP/1.1\nHost: {host}")), Err(421), "{host}");
        }
        assert_eq!(judged(&format!("GET /{TOKEN}/ HTTP/1.1\nAccept: */*")), Err(421));
        assert_eq!(get(&format!("/{TOKEN}/"), "\nHost: evil.example"), Err(400));
    }

    #[test]
    fn a_foreign_origin_is_refused() {
        let path = format!("/{TOKEN}/curves");
        for origin in ["http://evil.example", "https://127.0.0.1:8123", "http://127.0.0.1:8124", "null", "http://127.0.0.1:8123/"]
        {
            assert_eq!(get(&path, &format!("\nOrigin: {origin}")), Err(403), "{origin}");
        }
        for origin in ["http://127.0.0.1:8123", "http://localhost:8123"] {
            assert!(get(&path, &format!("\nOrigin: {origin}")).is_ok());
        }
        assert_eq!(get(&path, "\nSec-Fetch-Site: cross-site\nSec-Fetch-Mode: no-cors"), Err(403));
        assert!(get(&path, "\nSec-Fetch-Site: cross-site\nSec-Fetch-Mode: navigate").is_ok());
    }

    #[test]
    fn only_the_page_itself_starts_something() {
        let post = |more: &str| judged(&format!("POST /{TOKEN}/simulate HTTP/1.1\nHost: 127.0.0.1:8123{more}"));
        assert_eq!(post(""), Err(403));
        assert_eq!(post("\nOrigin: http://evil.example"), Err(403));
        assert_eq!(post("\nOrigin: http://127.0.0.1:8123\nContent-Length: 0").unwrap().method, HttpMethod::Post);
        assert_eq!(post("\nOrigin: http://127.0.0.1:8123\nContent-Length: 5"), Err(413));
        assert_eq!(post("\nOrigin: http://127.0.0.1:8123\nTransfer-Encoding: chunked"), Err(413));
    }

    #[test]
    fn what_is_too_long_or_no_request_is_refused() {
        let path = format!("/{TOKEN}/curves?{}", "a".repeat(LONGEST_QUERY + 1));
        assert_eq!(get(&path, ""), Err(414));
        assert_eq!(get(&format!("/{TOKEN}/"), &"\nA: b".repeat(100)), Err(400));
        assert_eq!(judged("PUT / HTTP/1.1\nHost: 127.0.0.1:8123"), Err(405));
        for wrong in ["", "GET", "GET / HTTP/9.9", "\0\0\0", "GET / HTTP/1.1\nHost : x"] {
            assert_eq!(judged(wrong), Err(400), "{wrong:?}");
        }
    }
}
