//! Names of cases, which their directories have too.

/// The name of a case and of its directory. The letter keeps it text for whoever reads `study.csv`:
/// 0001 would become 1.
pub(super) fn case_id(number: usize, digits: usize) -> String {
    format!("c{number:0digits$}")
}

/// Whether a directory may be that of a case. Earlier versions wrote the number alone.
pub(super) fn is_case_id(name: &str) -> bool {
    let number = name.strip_prefix('c').unwrap_or(name);
    !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
}

/// Directory of the case `id`, relative to the study.
pub(super) fn directory_of(id: &str) -> String {
    format!("cases/{id}")
}
