//! What no shader compiler checks: WGSL that is valid and computes the wrong thing.
//!
//! naga accepts transcendental functions of f64 and writes SPIR-V that no driver has to understand;
//! NaN tests are optimised away; a literal with a suffix, or a `select` between two literals, is
//! f32 in a source that is meant for both precisions. All of these are found here without a device,
//! on naga's intermediate representation and on the text.

use asperity::internals::compute::gpu::GpuError;
use asperity::internals::compute::gpu::source::{Assembled, Precision};
use asperity::internals::compute::gpu::validate::{ValidSource, validate};
use naga::proc::TypeResolution;
use naga::valid::FunctionInfo;
use naga::{BinaryOperator, Expression, Function, Handle, MathFunction, Module, ScalarKind, Span, TypeInner};
use std::fmt;

/// What is wrong with a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// A function of f64 other than those known to be right.
    DoublePrecisionFunction,
    /// `x != x` or `x == x`: an ordered comparison, false (true) for a NaN too.
    SelfComparison,
    /// `select` between two literals: f32 in either precision.
    LiteralSelect,
    /// An f32 value in the f64 variant of a shared source.
    SinglePrecision,
    /// `f32`, `f64` or a literal with a suffix in a shared source.
    NamedPrecision,
}

impl fmt::Display for Rule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::DoublePrecisionFunction => "this function is miscompiled in f64: use math.wgsl",
            Self::SelfComparison => "a comparison with itself finds no NaN: use is_finite",
            Self::LiteralSelect => "select between two literals is f32 in either precision: use if, or real(...)",
            Self::SinglePrecision => "an f32 value in the f64 variant: write `: real` or real(...)",
            Self::NamedPrecision => "a shared source names a precision: write real, and literals without a suffix",
        })
    }
}

/// One violation.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Finding {
    /// `file:line`.
    pub place: String,
    /// What is wrong.
    pub rule: Rule,
}

/// Every violation in a source, in the order of the source.
///
/// # Errors
/// [`GpuError::Shader`] if it does not compile at all.
pub fn lint(source: &Assembled) -> Result<Vec<Finding>, GpuError> {
    let ValidSource { module, info } = validate(source)?;
    let mut found: Vec<(usize, Rule)> = named_precisions(source);
    let functions = module.functions.iter().map(|(handle, function)| (function, &info[handle]));
    let entries = module.entry_points.iter().enumerate().map(|(i, entry)| (&entry.function, info.get_entry_point(i)));
    for (function, info) in functions.chain(entries) {
        for (handle, expression) in function.expressions.iter() {
            let byte = start(function.expressions.get_span(handle));
            let rule = Walk { module: &module, function, info }.violation(source, handle, expression, byte);
            found.extend(rule.map(|rule| (byte, rule)));
        }
        for (handle, variable) in function.local_variables.iter() {
            let byte = start(function.local_variables.get_span(handle));
            let single = float_width(&module, &module.types[variable.ty].inner) == Some(4);
            if source.precision == Precision::F64 && single && !source.in_prelude(byte) {
                found.push((byte, Rule::SinglePrecision));
            }
        }
    }
    found.sort_unstable();
    let mut findings: Vec<Finding> = found.into_iter().map(|(byte, rule)| Finding { place: source.place(byte), rule }).collect();
    findings.dedup();
    Ok(findings)
}

/// Bytes of local variables in each function, largest first: drivers spill them to memory, and
/// compile for minutes where they are large.
pub fn private_bytes(checked: &ValidSource) -> Vec<(String, u32)> {
    let module = &checked.module;
    let functions = module.functions.iter().map(|(_, f)| (f.name.clone().unwrap_or_default(), f));
    let entries = module.entry_points.iter().map(|e| (e.name.clone(), &e.function));
    let bytes = |f: &Function| f.local_variables.iter().map(|(_, v)| module.types[v.ty].inner.size(module.to_ctx())).sum();
    let mut all: Vec<(String, u32)> = functions.chain(entries).map(|(name, f)| (name, bytes(f))).collect();
    all.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    all
}

fn start(span: Span) -> usize {
    span.to_range().map_or(0, |range| range.start)
}

/// Width in bytes of the floats in a scalar, vector, matrix or array type.
fn float_width(module: &Module, inner: &TypeInner) -> Option<u8> {
    match *inner {
        TypeInner::Scalar(scalar) | TypeInner::Vector { scalar, .. } | TypeInner::Matrix { scalar, .. } => {
            (scalar.kind == ScalarKind::Float).then_some(scalar.width)
        }
        TypeInner::Array { base, .. } => float_width(module, &module.types[base].inner),
        _ => None,
    }
}

/// One function under inspection.
struct Walk<'a> {
    module: &'a Module,
    function: &'a Function,
    info: &'a FunctionInfo,
}

impl Walk<'_> {
    fn float_width(&self, handle: Handle<Expression>) -> Option<u8> {
        let inner = match &self.info[handle].ty {
            TypeResolution::Handle(ty) => &self.module.types[*ty].inner,
            TypeResolution::Value(inner) => inner,
        };
        float_width(self.module, inner)
    }

    fn violation(&self, source: &Assembled, handle: Handle<Expression>, expression: &Expression, byte: usize) -> Option<Rule> {
        let double = source.precision == Precision::F64;
        match *expression {
            Expression::Math { fun, arg, .. } if self.float_width(arg) == Some(8) && !right_in_f64(fun) => {
                return Some(Rule::DoublePrecisionFunction);
            }
            Expression::Binary { op: BinaryOperator::Equal | BinaryOperator::NotEqual, left, right }
                if self.float_width(left).is_some() && self.same(left, right) =>
            {
                return Some(Rule::SelfComparison);
            }
            Expression::Select { accept, reject, .. }
                if self.float_width(accept).is_some() && self.is_literal(accept) && self.is_literal(reject) =>
            {
                return Some(Rule::LiteralSelect);
            }
            _ => {}
        }
        let single = double && !source.in_prelude(byte) && self.float_width(handle) == Some(4);
        single.then_some(Rule::SinglePrecision)
    }

    fn is_literal(&self, handle: Handle<Expression>) -> bool {
        match self.function.expressions[handle] {
            Expression::Literal(_) => true,
            Expression::Splat { value, .. } => self.is_literal(value),
            _ => false,
        }
    }

    /// Whether two expressions are the same value: the same handle, or loads and accesses of the
    /// same thing.
    fn same(&self, left: Handle<Expression>, right: Handle<Expression>) -> bool {
        if left == right {
            return true;
        }
        match (&self.function.expressions[left], &self.function.expressions[right]) {
            (Expression::Load { pointer: a }, Expression::Load { pointer: b }) => self.same(*a, *b),
            (Expression::AccessIndex { base: a, index: i }, Expression::AccessIndex { base: b, index: j }) => {
                i == j && self.same(*a, *b)
            }
            (Expression::Access { base: a, index: i }, Expression::Access { base: b, index: j }) => {
                self.same(*a, *b) && self.same(*i, *j)
            }
            (a, b) => {
                let leaf = matches!(
                    a,
                    Expression::LocalVariable(_)
                        | Expression::GlobalVariable(_)
                        | Expression::FunctionArgument(_)
                        | Expression::Constant(_)
                        | Expression::Literal(_)
                );
                leaf && a == b
            }
        }
    }
}

/// The functions that were seen to be right in f64, on lavapipe and in the SPIR-V specification.
/// All others are refused.
fn right_in_f64(fun: MathFunction) -> bool {
    use MathFunction as M;
    matches!(
        fun,
        M::Abs
            | M::Min
            | M::Max
            | M::Clamp
            | M::Floor
            | M::Round
            | M::Ldexp
            | M::Dot
            | M::Cross
            | M::Length
            | M::Fma
            | M::Mix
            | M::Sqrt
            | M::InverseSqrt
            | M::Transpose
            | M::Determinant
    )
}

/// `f32`, `f64` and suffixed literals outside the prelude; comments are skipped.
fn named_precisions(source: &Assembled) -> Vec<(usize, Rule)> {
    let mut found = Vec::new();
    let mut line_start = source.shared_start();
    for line in source.text[line_start..].split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or_default();
        let mut at = 0;
        for word in code.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_')) {
            if names_precision(word) {
                found.push((line_start + at, Rule::NamedPrecision));
            }
            at += word.len() + 1;
        }
        line_start += line.len();
    }
    found
}

/// Whether a word of WGSL is a precision, a vector or matrix of one, or (the end of) a literal with
/// its suffix.
fn names_precision(word: &str) -> bool {
    let vector = |stem: &str| {
        word.strip_suffix(['f', 'h'])
            .is_some_and(|w| w.starts_with(stem) && w[3..].bytes().all(|b| b.is_ascii_digit() || b == b'x'))
    };
    let literal = word.starts_with(|c: char| c.is_ascii_digit())
        && !word.starts_with("0x")
        && (word.ends_with('f') || word.ends_with('h') || word.ends_with("lf"));
    matches!(word, "f16" | "f32" | "f64") || vector("vec") || vector("mat") || literal
}

#[test]
fn words_that_name_a_precision() {
    for word in ["f32", "f64", "0f", "5f", "0lf", "1h", "vec3f", "mat3x3f", "1e5f"] {
        assert!(names_precision(word), "{word}");
    }
    for word in ["real", "vec3", "vec3u", "vec2i", "0u", "12i", "0xff", "half", "f", "of", "1e5", "", "matf_x", "vector_f"] {
        assert!(!names_precision(word), "{word}");
    }
}
