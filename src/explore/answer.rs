//! Answers, as they go over the connection.

use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::Duration;

/// Whoever does not take an answer within this time does not get it.
const PATIENCE: Duration = Duration::from_secs(5);

/// What the page may do: show itself, run its own script, and ask this server. Nothing of another
/// place is loaded, nothing that stands in the page itself is run, and no other page shows it.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// How a request went.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // their names say what they are
pub enum HttpStatus {
    Done,
    Bad,
    Forbidden,
    NotFound,
    Method,
    Timeout,
    Conflict,
    TooLarge,
    QueryTooLong,
    Misdirected,
    HeadTooLong,
    Broken,
}

impl HttpStatus {
    /// The number in HTTP.
    pub fn code(self) -> u16 {
        match self {
            Self::Done => 200,
            Self::Bad => 400,
            Self::Forbidden => 403,
            Self::NotFound => 404,
            Self::Method => 405,
            Self::Timeout => 408,
            Self::Conflict => 409,
            Self::TooLarge => 413,
            Self::QueryTooLong => 414,
            Self::Misdirected => 421,
            Self::HeadTooLong => 431,
            Self::Broken => 500,
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Done => "OK",
            Self::Bad => "Bad HttpRequest",
            Self::Forbidden => "Forbidden",
            Self::NotFound => "Not Found",
            Self::Method => "Method Not Allowed",
            Self::Timeout => "HttpRequest Timeout",
            Self::Conflict => "Conflict",
            Self::TooLarge => "Content Too Large",
            Self::QueryTooLong => "URI Too Long",
            Self::Misdirected => "Misdirected HttpRequest",
            Self::HeadTooLong => "HttpRequest Header Fields Too Large",
            Self::Broken => "Internal Server Error",
        }
    }
}

/// An answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HttpAnswer {
    /// How it went.
    pub status: HttpStatus,
    /// Its type, as in HTTP.
    pub kind: &'static str,
    /// The name under which a browser is to keep it, where it is a file.
    pub file: Option<String>,
    /// What it says.
    pub body: Vec<u8>,
}

impl HttpAnswer {
    /// A text that went well.
    pub fn text(kind: &'static str, body: impl Into<Vec<u8>>) -> Self {
        Self { status: HttpStatus::Done, kind, file: None, body: body.into() }
    }

    /// JSON.
    pub fn json(value: &serde_json::Value) -> Self {
        Self::text("application/json", value.to_string())
    }

    /// Plain words.
    pub fn plain(status: HttpStatus, words: &str) -> Self {
        Self { status, ..Self::text("text/plain; charset=utf-8", words) }
    }

    /// A file to be kept. Its name is one of this program's own.
    pub fn file(name: String, kind: &'static str, body: Vec<u8>) -> Self {
        Self { file: Some(name), ..Self::text(kind, body) }
    }

    /// Sends it and ends the connection. Who has gone away does not get it.
    pub fn send(&self, stream: &mut TcpStream, with_body: bool) {
        let _ = stream.set_write_timeout(Some(PATIENCE));
        let mut head = format!(
            "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\n\
             Content-Security-Policy: {POLICY}\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n",
            self.status.code(),
            self.status.words(),
            self.kind,
            self.body.len()
        );
        if let Some(file) = &self.file {
            head += &format!("Content-Disposition: attachment; filename=\"{file}\"\r\n");
        }
        if self.status == HttpStatus::Method {
            head += "Allow: GET, HEAD, POST\r\n";
        }
        head += "\r\n";
        let mut bytes = head.into_bytes();
        if with_body {
            bytes.extend_from_slice(&self.body);
        }
        if stream.write_all(&bytes).and_then(|()| stream.flush()).is_ok() && stream.shutdown(Shutdown::Write).is_ok() {
            drain(stream);
        }
    }
}

/// Takes what was sent and never read, a little of it: if a connection is closed on that, the other
/// side may lose the answer.
fn drain(stream: &mut TcpStream) {
    let mut rest = [0u8; 4096];
    let _ = stream.set_read_timeout(Some(Duration::from_millis(200)));
    for _ in 0..8 {
        match stream.read(&mut rest) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
    }
}
