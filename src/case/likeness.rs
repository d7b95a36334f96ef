//! Words that are like others.

/// The known word most like `name`, unless they have little in common.
pub fn nearest(name: &str, known: &[&str]) -> Option<String> {
    let (best, likeness) = most_like(name, known.iter().copied())?;
    (likeness > 0.75).then(|| best.to_owned())
}

/// The known word most like `name`, and how like it is, up to 1.
pub(super) fn most_like<'k>(name: &str, known: impl Iterator<Item = &'k str>) -> Option<(&'k str, f64)> {
    let name = name.to_lowercase();
    known.map(|key| (key, strsim::jaro_winkler(&name, key))).max_by(|left, right| left.1.total_cmp(&right.1))
}
