//! What is printed for somebody to type: words of a command line as a shell reads them.

use std::ffi::OsStr;
use std::path::Path;

/// One argument: as it is where a shell takes it for one word that means itself, else in quotes. It
/// has no line breaks.
pub fn word(argument: impl AsRef<OsStr>) -> String {
    let argument = argument.as_ref();
    match argument.to_str() {
        Some(text) if !text.is_empty() && !text.starts_with('=') && text.chars().all(is_plain) => text.to_owned(),
        Some(text) if !text.chars().any(char::is_control) => format!("'{}'", text.replace('\'', "'\\''")),
        _ => escaped(argument.as_encoded_bytes()),
    }
}

/// A path as an argument that no program takes for an option.
pub fn path(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    if path.as_os_str().as_encoded_bytes().starts_with(b"-") { word(Path::new(".").join(path)) } else { word(path) }
}

/// The name of an input as an argument: `-` where it was standard input.
pub fn input(name: &str) -> String {
    if name == STDIN { "-".to_owned() } else { path(name) }
}

/// What standard input is called in messages.
pub const STDIN: &str = "<stdin>";

/// What has no meaning of its own in any common shell.
fn is_plain(c: char) -> bool {
    c.is_alphanumeric() || "-_./,:=+@%".contains(c)
}

/// For line breaks, and for what is no text, as bash, zsh and ksh have it.
fn escaped(bytes: &[u8]) -> String {
    let mut word = "$'".to_owned();
    for &byte in bytes {
        match byte {
            b'\'' | b'\\' => word.extend(['\\', char::from(byte)]),
            b' '..=b'~' => word.push(char::from(byte)),
            _ => word += &format!("\\{byte:03o}"),
        }
    }
    word + "'"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_needs_no_quotes_has_none() {
        for plain in ["run", "--out", "a/b_c-1.toml", "contact.friction=0.1", "größe", "50%@x"] {
            assert_eq!(word(plain), plain);
        }
        assert_eq!((path("-x"), path("a b"), path("/-x")), ("./-x".into(), "'a b'".into(), "/-x".into()));
        assert_eq!((input(STDIN), input("it's")), ("-".into(), "'it'\\''s'".into()));
    }

    /// A shell makes of each word what it was made of.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_shell_reads_each_word_as_it_was() {
        use std::os::unix::ffi::OsStrExt;
        let words: [&[u8]; 16] = [
            b"",
            b"a b",
            b"it's",
            b"\"$HOME\" `x` \\n",
            b"@PROGRAM@",
            b"~",
            b"#no comment",
            b"a;b&c|d>e<f",
            b"*?[a]{b,c}!",
            b"=ls",
            b"two\nlines\tand 'quotes' \\",
            b"\xff\xfe1",
            "größe 1\u{a0}2".as_bytes(),
            b"-n",
            b"$(exit 3)",
            b"%",
        ];
        for bytes in words {
            let quoted = word(OsStr::from_bytes(bytes));
            assert!(!quoted.contains('\n'), "{quoted}");
            let script = format!("printf %s {quoted}");
            let output = std::process::Command::new("bash").args(["-c", &script]).output().expect("bash runs");
            // `-n` is read as it is by printf.
            assert_eq!(output.stdout, bytes, "{quoted}");
        }
    }
}
