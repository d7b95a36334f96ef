//! WGSL files, and what is made of them: one text in one precision.

use std::fmt;

/// The precision in which a kernel is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Precision {
    /// Single.
    F32,
    /// Double: needs SHADER_F64.
    F64,
}

impl Precision {
    /// Both.
    pub const ALL: [Self; 2] = [Self::F32, Self::F64];

    fn prelude(self) -> ShaderSource {
        match self {
            Self::F32 => PRELUDE_F32,
            Self::F64 => PRELUDE_F64,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        })
    }
}

/// One WGSL file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShaderSource {
    /// Path from the repository root.
    pub path: &'static str,
    /// Contents.
    pub text: &'static str,
}

macro_rules! source {
    ($path:literal) => {
        $crate::compute::gpu::source::ShaderSource {
            path: concat!("shaders/", $path),
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
        }
    };
}
pub(super) use source;

const PRELUDE_F32: ShaderSource = source!("prelude_f32.wgsl");
const PRELUDE_F64: ShaderSource = source!("prelude_f64.wgsl");

/// Concatenated sources that know where each line came from.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// The WGSL.
    pub text: String,
    /// The precision it was assembled for.
    pub precision: Precision,
    /// First byte and path of each part; the first part is the prelude.
    parts: Vec<(usize, &'static str)>,
}

impl Assembled {
    /// Concatenates the prelude of a precision and `sources`.
    pub fn with_prelude(precision: Precision, sources: &[ShaderSource]) -> Self {
        Self::new(precision, &[&[precision.prelude()], sources].concat())
    }

    /// Concatenates `parts`, of which the first is the prelude.
    pub fn new(precision: Precision, parts: &[ShaderSource]) -> Self {
        let mut text = String::new();
        let mut starts = Vec::with_capacity(parts.len());
        for part in parts {
            starts.push((text.len(), part.path));
            text.push_str(part.text);
            text.push('\n');
        }
        Self { text, precision, parts: starts }
    }

    /// `file:line` of a byte.
    pub fn place(&self, byte: usize) -> String {
        let byte = byte.min(self.text.len());
        let (start, path) = self.parts.iter().rev().find(|(start, _)| *start <= byte).copied().unwrap_or((0, "shaders"));
        let line = self.text.as_bytes()[start..byte].iter().filter(|&&b| b == b'\n').count() + 1;
        format!("{path}:{line}")
    }

    /// Whether a byte belongs to the prelude, where the precision may be named.
    pub fn in_prelude(&self, byte: usize) -> bool {
        self.parts.get(1).is_none_or(|(start, _)| byte < *start)
    }

    /// First byte after the prelude.
    pub fn shared_start(&self) -> usize {
        self.parts.get(1).map_or(self.text.len(), |(start, _)| *start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_file_and_line() {
        let a = ShaderSource { path: "a.wgsl", text: "one\ntwo\n" };
        let b = ShaderSource { path: "b.wgsl", text: "three\nfour" };
        let assembled = Assembled::new(Precision::F32, &[a, b]);
        assert_eq!(assembled.text, "one\ntwo\n\nthree\nfour\n");
        let place = |word: &str| assembled.place(assembled.text.find(word).unwrap());
        assert_eq!(["one", "two", "three", "four"].map(place), ["a.wgsl:1", "a.wgsl:2", "b.wgsl:1", "b.wgsl:2"]);
        assert!(assembled.in_prelude(5) && !assembled.in_prelude(9));
        assert_eq!(assembled.shared_start(), 9);
    }
}
