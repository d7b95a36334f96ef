//! What a kernel takes, as naga reads it in its WGSL: the variables that its entry point uses, and
//! its workgroups. Arguments go to variables by name; the numbers of bindings are the file's own.

use super::arguments::Argument;
use super::error::{ArgumentFlaw, GpuError};
use super::source::Assembled;
use super::validate::{ValidSource, validate};
use naga::valid::GlobalUse;
use naga::{AddressSpace, StorageAccess};

/// How a kernel sees an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// `var<uniform>`.
    Uniform,
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    ReadWrite,
}

/// A variable that arguments go to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its number in group 0.
    pub binding: u32,
    /// How it is declared.
    pub kind: Binding,
    /// Whether the entry point reads it.
    pub reads: bool,
    /// Whether the entry point writes it.
    pub writes: bool,
}

/// What a kernel takes.
#[derive(Clone, Debug)]
pub struct KernelInterface {
    /// The variables that its entry point uses, in the order of their numbers.
    pub variables: Vec<Variable>,
    /// What files that it shares with others declare and its entry point does not use.
    unused: Vec<String>,
    /// Threads of a workgroup (all along x).
    pub workgroup: u32,
    /// Bytes of its largest uniform block.
    pub uniform_bytes: u64,
    /// Bytes that the threads of a workgroup share.
    pub shared_bytes: u64,
}

impl KernelInterface {
    /// That of the one entry point of a source.
    ///
    /// # Errors
    /// [`GpuError::Shader`] if it does not compile, or has none.
    pub fn of(source: &Assembled) -> Result<Self, GpuError> {
        let ValidSource { module, info } = validate(source)?;
        let Some(entry) = module.entry_points.first() else {
            return Err(GpuError::Shader { place: source.place(0), message: "there is no entry point".to_owned() });
        };
        let threads = entry.workgroup_size.iter().product();
        let mut out = Self { variables: Vec::new(), unused: Vec::new(), workgroup: threads, uniform_bytes: 0, shared_bytes: 0 };
        for (handle, variable) in module.global_variables.iter() {
            let used = info.get_entry_point(0)[handle];
            let bytes = || u64::from(module.types[variable.ty].inner.try_size(module.to_ctx()).unwrap_or(u32::MAX));
            if variable.space == AddressSpace::WorkGroup && !used.is_empty() {
                out.shared_bytes += bytes();
            }
            let Some(place) = variable.binding else { continue };
            let name = variable.name.clone().unwrap_or_default();
            if used.is_empty() {
                out.unused.push(name);
                continue;
            }
            let kind = match variable.space {
                AddressSpace::Uniform => Binding::Uniform,
                AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => Binding::ReadWrite,
                _ => Binding::Read,
            };
            if kind == Binding::Uniform {
                out.uniform_bytes = out.uniform_bytes.max(bytes());
            }
            let (reads, writes) = (used.contains(GlobalUse::READ), used.contains(GlobalUse::WRITE));
            out.variables.push(Variable { name, binding: place.binding, kind, reads, writes });
        }
        out.variables.sort_by_key(|variable| variable.binding);
        Ok(out)
    }

    /// The arguments in the order of the variables that they go to. Those that go to variables of a
    /// shared file which this kernel does not use are left out.
    ///
    /// # Errors
    /// [`GpuError::Argument`] for the first that is missing, unknown or there twice.
    pub fn in_order<'a, 'b>(
        &self,
        kernel: &'static str,
        arguments: &'a [Argument<'b>],
    ) -> Result<Vec<&'a Argument<'b>>, GpuError> {
        let wrong = |name: &str, flaw| GpuError::Argument { kernel, name: name.to_owned(), flaw };
        for (at, argument) in arguments.iter().enumerate() {
            let name = argument.name;
            if !self.variables.iter().map(|variable| &variable.name).chain(&self.unused).any(|known| known == name) {
                return Err(wrong(name, ArgumentFlaw::Unknown));
            }
            if arguments[..at].iter().any(|earlier| earlier.name == name) {
                return Err(wrong(name, ArgumentFlaw::Doubled));
            }
        }
        let argument_of = |variable: &Variable| {
            let found = arguments.iter().find(|argument| argument.name == variable.name);
            found.ok_or_else(|| wrong(&variable.name, ArgumentFlaw::Missing))
        };
        self.variables.iter().map(argument_of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::kernel::Kernel;
    use super::super::source::{Precision, ShaderSource};
    use super::*;

    const TEXT: &str = "
@group(0) @binding(4) var<storage, read_write> to: array<real>;
@group(0) @binding(0) var<uniform> shape: vec4<u32>;
@group(0) @binding(2) var<storage, read> given: array<real>;
@group(0) @binding(3) var<storage, read> spare: array<real>;
var<workgroup> shared_numbers: array<real, 8>;
@compute @workgroup_size(8)
fn moving(@builtin(local_invocation_index) i: u32) {
    shared_numbers[i] = given[i + shape.x];
    to[i] = shared_numbers[i];
}
";
    static MOVING: Kernel = Kernel::new("moving", &[ShaderSource { path: "tests", text: TEXT }]);

    /// The places of arguments with these names among the kernel's variables.
    fn places(names: &[&'static str]) -> Result<Vec<&'static str>, (String, ArgumentFlaw)> {
        let resource = || wgpu::BindingResource::BufferArray(&[]);
        let argument = |&name: &&'static str| Argument { name, resource: resource(), array: Default::default() };
        let arguments: Vec<Argument<'_>> = names.iter().map(argument).collect();
        let ordered = MOVING.interface().unwrap().in_order("moving", &arguments);
        let names = ordered.map(|ordered| ordered.iter().map(|argument| argument.name).collect());
        names.map_err(|error| match error {
            GpuError::Argument { kernel: "moving", name, flaw } => (name, flaw),
            other => panic!("{other}"),
        })
    }

    #[test]
    fn an_entry_point_takes_what_it_uses() {
        let KernelInterface { variables, unused, workgroup, uniform_bytes, shared_bytes } = MOVING.interface().unwrap();
        let of = |name: &str, binding, kind, reads, writes| Variable { name: name.to_owned(), binding, kind, reads, writes };
        let expected = [
            of("shape", 0, Binding::Uniform, true, false),
            of("given", 2, Binding::Read, true, false),
            of("to", 4, Binding::ReadWrite, false, true),
        ];
        assert_eq!(variables, &expected);
        assert_eq!((&unused[..], *workgroup, *uniform_bytes, *shared_bytes), (&["spare".to_owned()][..], 8, 16, 64));
        let no_entry = Assembled::with_prelude(Precision::F32, &[ShaderSource { path: "tests", text: "const A = 1;" }]);
        assert!(matches!(KernelInterface::of(&no_entry), Err(GpuError::Shader { .. })));
    }

    #[test]
    fn arguments_go_to_the_variables_of_their_names_in_any_order() {
        let ordered = Ok(vec!["shape", "given", "to"]);
        assert_eq!(places(&["shape", "given", "to"]), ordered);
        assert_eq!(places(&["to", "shape", "given"]), ordered);
        // A shared file's, which this kernel does not use.
        assert_eq!(places(&["spare", "to", "given", "shape"]), ordered);
    }

    #[test]
    fn a_variable_without_an_argument_is_an_error() {
        assert_eq!(places(&["shape", "to"]), Err(("given".to_owned(), ArgumentFlaw::Missing)));
        assert_eq!(places(&[]), Err(("shape".to_owned(), ArgumentFlaw::Missing)));
    }

    #[test]
    fn an_argument_without_a_variable_is_an_error() {
        // What threads share is no argument.
        for name in ["from", "shared_numbers", "moving", ""] {
            assert_eq!(places(&["shape", "given", "to", name]), Err((name.to_owned(), ArgumentFlaw::Unknown)));
        }
    }

    #[test]
    fn two_arguments_of_one_name_are_an_error() {
        assert_eq!(places(&["shape", "given", "to", "given"]), Err(("given".to_owned(), ArgumentFlaw::Doubled)));
        assert_eq!(places(&["spare", "spare", "shape", "given", "to"]), Err(("spare".to_owned(), ArgumentFlaw::Doubled)));
    }

    #[test]
    fn a_flaw_names_kernel_and_argument() {
        for (flaw, said) in [
            (ArgumentFlaw::Missing, "kernel moving: no argument is given for its variable `given`"),
            (ArgumentFlaw::Unknown, "kernel moving: it has no variable for the argument `given`"),
            (ArgumentFlaw::Doubled, "kernel moving: there are two arguments for its variable `given`"),
        ] {
            let error = GpuError::Argument { kernel: "moving", name: "given".to_owned(), flaw };
            assert!(error.to_string().starts_with(said), "{error}");
        }
    }
}
