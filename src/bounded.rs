//! Files read whole, but never more of one than it may have: what is given may be a device or a
//! file of another kind that has no end.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use crate::quoting;

const MIB: u64 = 1 << 20;
/// Most bytes of a case or study file.
pub const CASE: u64 = 16 * MIB;
/// Most bytes of a law, and of what a run or a study wrote as text.
pub const RESULT: u64 = 256 * MIB;
/// Most bytes of a checkpoint: several times that of the finest mesh.
pub const CHECKPOINT: u64 = 4096 * MIB;

/// The bytes of a file that has `most` at most.
///
/// # Errors
/// Those of the system; [`ErrorKind::FileTooLarge`] for a file that has more, of which no more than
/// `most` is read.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    let told = file.metadata()?.len();
    if told > most {
        return Err(too_large(most));
    }
    up_to(file, most, usize::try_from(told).unwrap_or(0))
}

/// What a device or a pipe has is not told beforehand.
fn up_to(source: impl Read, most: u64, expected: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(expected);
    source.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

/// [`read`] for text.
///
/// # Errors
/// As [`read`]; [`ErrorKind::InvalidData`] for what is not UTF-8.
pub fn read_to_string(path: &Path, most: u64) -> io::Result<String> {
    text(read(path, most)?, Some(path))
}

/// [`read_to_string`] for what is open already, such as standard input.
///
/// # Errors
/// As [`read_to_string`].
pub fn to_string(source: impl Read, most: u64) -> io::Result<String> {
    text(up_to(source, most, 0)?, None)
}

/// UTF-8, with or without its mark in front, which is left out.
fn text(bytes: Vec<u8>, path: Option<&Path>) -> io::Result<String> {
    let refuse = |what: &str, encoding: Option<Encoding>| {
        let what = encoding.map_or(what.to_owned(), |encoding| encoding.advice(what, path));
        io::Error::new(ErrorKind::InvalidData, what)
    };
    if let Some(encoding) = Encoding::wide(&bytes) {
        return Err(refuse("it is not text in UTF-8", Some(encoding)));
    }
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..valid].iter().filter(|byte| **byte == b'\n').count();
        refuse(&format!("it is not text in UTF-8, from line {line} on"), Encoding::narrow(error.as_bytes()))
    })?;
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    Ok(text)
}

/// What text is encoded in, if it is not UTF-8.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Encoding {
    /// What people call it.
    name: &'static str,
    /// What `iconv` calls it.
    iconv: &'static str,
}

impl Encoding {
    /// So many bytes are looked at.
    const HEAD: usize = 4096;

    /// Of text with two or four bytes for a letter. Without a mark in front it may be UTF-8 too,
    /// with zeros in it.
    fn wide(bytes: &[u8]) -> Option<Self> {
        let head = &bytes[..bytes.len().min(Self::HEAD)];
        if head.starts_with(b"\xff\xfe\0\0") || head.starts_with(b"\0\0\xfe\xff") {
            return Some(Self { name: "UTF-32", iconv: "UTF-32" });
        }
        if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
            return Some(Self { name: "UTF-16", iconv: "UTF-16" });
        }
        // Every other byte of what is mostly ASCII is zero there.
        let zeros = |first: usize| head.iter().skip(first).step_by(2).filter(|byte| **byte == 0).count();
        let (even, odd) = (zeros(0), zeros(1));
        let many = even.max(odd) * 4 > head.len();
        match (many && even * 10 < odd, many && odd * 10 < even) {
            (true, _) => Some(Self { name: "UTF-16", iconv: "UTF-16LE" }),
            (_, true) => Some(Self { name: "UTF-16", iconv: "UTF-16BE" }),
            _ => None,
        }
    }

    /// Of what is not UTF-8, with a byte for a letter; `None` if it does not look like text.
    fn narrow(bytes: &[u8]) -> Option<Self> {
        let head = &bytes[..bytes.len().min(Self::HEAD)];
        let is_control = |byte: &u8| *byte < b' ' && !b"\t\n\r\x0c".contains(byte);
        let beyond = head.iter().filter(|byte| !byte.is_ascii()).count();
        if head.iter().any(is_control) || beyond * 3 > head.len() {
            return None;
        }
        let windows = bytes.iter().any(|byte| (0x80..0xa0).contains(byte));
        Some(if windows {
            Self { name: "Windows-1252", iconv: "WINDOWS-1252" }
        } else {
            Self { name: "Latin-1 (ISO 8859-1)", iconv: "ISO-8859-1" }
        })
    }

    /// What is wrong, what it looks like, and how it becomes UTF-8.
    fn advice(self, what: &str, path: Option<&Path>) -> String {
        let files = path.map_or(String::new(), |path| {
            let end = path.extension().map_or("utf8".into(), |end| format!("utf8.{}", end.to_string_lossy()));
            format!(" {} > {}", quoting::path(path), quoting::path(path.with_extension(end)))
        });
        format!(
            "{what}; it looks like {}. Save it as UTF-8, or convert it with `iconv -f {} -t UTF-8{files}`",
            self.name, self.iconv
        )
    }
}

fn too_large(most: u64) -> io::Error {
    io::Error::new(ErrorKind::FileTooLarge, format!("it has more than {} MiB, the most that such a file may have", most / MIB))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_much_as_allowed_and_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        std::fs::write(&path, "12345678").unwrap();
        assert_eq!(read_to_string(&path, 8).unwrap(), "12345678");
        assert_eq!(read(&path, 7).unwrap_err().kind(), ErrorKind::FileTooLarge);
        assert_eq!(to_string(&b"12345678"[..], 8).unwrap(), "12345678");
        assert_eq!(to_string(&b"12345678"[..], 7).unwrap_err().kind(), ErrorKind::FileTooLarge);
        std::fs::write(&path, b"\xff\xfe1").unwrap();
        assert!(read_to_string(&path, 8).unwrap_err().to_string().contains("UTF-8"));
        assert_eq!(read(&folder.path().join("none"), 8).unwrap_err().kind(), ErrorKind::NotFound);
    }

    #[test]
    fn what_is_not_utf_8_is_told_with_what_it_looks_like() {
        let ascii = "[sphere]\nradius = 1.0 # 1 mm\n";
        let wide = |bytes: fn(u16) -> [u8; 2]| ascii.encode_utf16().flat_map(bytes).collect::<Vec<u8>>();
        let (little, big) = (wide(u16::to_le_bytes), wide(u16::to_be_bytes));
        for (bytes, name, command) in [
            ([b"\xff\xfe", &little[..]].concat(), "UTF-16", "iconv -f UTF-16 -t UTF-8 'a b.toml' > 'a b.utf8.toml'"),
            ([b"\xfe\xff", &big[..]].concat(), "UTF-16", "iconv -f UTF-16 -t"),
            (little, "UTF-16", "iconv -f UTF-16LE -t"),
            (big, "UTF-16", "iconv -f UTF-16BE -t"),
            (b"a = 1\nb = \"K\xf6rper\"\n".to_vec(), "from line 2 on; it looks like Latin-1", "iconv -f ISO-8859-1 -t"),
            (b"a = 1 # \x93x\x94\n".to_vec(), "Windows-1252", "iconv -f WINDOWS-1252 -t"),
        ] {
            let error = text(bytes, Some(Path::new("a b.toml"))).unwrap_err();
            assert_eq!(error.kind(), ErrorKind::InvalidData);
            let message = error.to_string();
            assert!(message.contains(name) && message.contains(command) && message.contains("UTF-8"), "{message}");
        }
        for other in [&b"\xff"[..], b"\x7fELF\x02\x01\xff", b"\x80\x81\x82\x83"] {
            let message = text(other.to_vec(), None).unwrap_err().to_string();
            assert!(message.contains("UTF-8") && !message.contains("iconv"), "{message}");
        }
        // A mark in front, and zeros at the end of a file that was not brought to the disk.
        assert_eq!(text(b"\xef\xbb\xbfa = 1".to_vec(), None).unwrap(), "a = 1");
        assert_eq!(text("größe".into(), None).unwrap(), "größe");
        assert_eq!(text(b"1,2,3\n\0\0\0\0".to_vec(), None).unwrap().len(), 10);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_device_without_an_end_is_refused() {
        let error = read(Path::new("/dev/zero"), MIB).unwrap_err();
        assert!(error.to_string().contains("more than 1 MiB"), "{error}");
    }
}
