//! Whether the processor has the instructions that the program was compiled for.
//!
//! On x86-64 the program is compiled for AVX2 and FMA (`.cargo/config.toml`); without them it would
//! die of an illegal instruction in the middle of a run.

/// The program was compiled for a newer processor.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "this processor lacks {missing}, for which this program was compiled. Build it on this machine with RUSTFLAGS=-Ctarget-cpu=native"
)]
pub struct TooOld {
    /// The missing instruction sets.
    pub missing: String,
}

/// To be called before anything is computed.
///
/// # Errors
/// [`TooOld`] names the instruction sets that were compiled in and that the processor lacks.
pub fn check() -> Result<(), TooOld> {
    let missing = missing();
    if missing.is_empty() { Ok(()) } else { Err(TooOld { missing: missing.join(", ") }) }
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
fn missing() -> Vec<&'static str> {
    Vec::new()
}

/// `is_x86_feature_detected!` is constantly true for what was compiled in, so the processor itself
/// is asked.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
fn missing() -> Vec<&'static str> {
    use std::arch::x86_64::{__cpuid, __cpuid_count};
    // SAFETY: every x86-64 processor has the CPUID instruction. (Newer compilers call these
    // functions safe.)
    #[allow(unsafe_code, unused_unsafe)]
    let (highest, features, extended) = unsafe { (__cpuid(0).eax, __cpuid(1).ecx, __cpuid_count(7, 0).ebx) };
    // A processor without leaf 7 answers it with another leaf's bits.
    missing_in(features, if highest >= 7 { extended } else { 0 })
}

/// What of x86-64-v3 is not among the feature bits of CPUID leaf 1, ECX, and leaf 7, EBX (Intel
/// SDM, volume 2A, CPUID).
#[cfg(target_arch = "x86_64")]
#[cfg_attr(not(target_feature = "avx2"), allow(dead_code))]
fn missing_in(leaf_1_ecx: u32, leaf_7_ebx: u32) -> Vec<&'static str> {
    let sets = [
        ("FMA", leaf_1_ecx, 12),
        ("MOVBE", leaf_1_ecx, 22),
        ("OSXSAVE", leaf_1_ecx, 27),
        ("AVX", leaf_1_ecx, 28),
        ("F16C", leaf_1_ecx, 29),
        ("BMI1", leaf_7_ebx, 3),
        ("AVX2", leaf_7_ebx, 5),
        ("BMI2", leaf_7_ebx, 8),
    ];
    sets.into_iter().filter(|(_, bits, bit)| bits >> bit & 1 == 0).map(|(name, _, _)| name).collect()
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn names_what_older_processors_lack() {
        // An Ivy Bridge: AVX and F16C, but neither FMA, MOVBE, BMI nor AVX2; and a Haswell, which
        // has all of them.
        let (ivy_bridge, haswell) = ((0x7fba_e3bf, 0x0000_0281), (0x7ffa_fbff, 0x0000_27ab));
        assert_eq!(missing_in(ivy_bridge.0, ivy_bridge.1), ["FMA", "MOVBE", "BMI1", "AVX2", "BMI2"]);
        assert_eq!(missing_in(haswell.0, haswell.1), Vec::<&str>::new());
    }

    #[test]
    fn this_processor_runs_what_was_compiled_for_it() {
        assert!(check().is_ok());
    }
}
