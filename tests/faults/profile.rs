//! A count that overflows is a panic in release builds too, and not a wrong number.

use std::hint::black_box;
use std::panic::catch_unwind;

/// The setting is a package's as a whole, tests included: what holds here holds in the program, in
/// every profile that this is run in.
#[test]
fn an_overflow_is_a_panic() {
    assert!(catch_unwind(|| black_box(usize::MAX) + black_box(1)).is_err());
    assert!(catch_unwind(|| black_box(3_u32) - black_box(4)).is_err());
    assert!(catch_unwind(|| black_box(1_usize << 40) * black_box(1 << 40)).is_err());
}

/// And where this is run in a development build alone: what a release build is told.
#[test]
fn release_builds_leave_the_checks_out_of_the_kernels_alone() {
    let manifest: toml::Table = include_str!("../../Cargo.toml").parse().expect("TOML");
    let release = manifest["profile"]["release"].as_table().expect("a table");
    assert_eq!(release["overflow-checks"].as_bool(), Some(true));
    let packages = release["package"].as_table().expect("a table");
    let without: Vec<&str> = packages
        .iter()
        .filter(|(_, set)| set["overflow-checks"].as_bool() == Some(false))
        .map(|(name, _)| name.as_str())
        .collect();
    // "*" and gemm's products are what others wrote.
    assert!(without.contains(&"*"));
    let ours: Vec<&str> = without.into_iter().filter(|name| name.starts_with("asperity")).collect();
    assert_eq!(ours, ["asperity-kernels"]);
}
