//! How a number stands in a table.

/// The shortest digits that give the same number back, always with a point or an exponent: a column
/// of such numbers is read as one of floating point, and squares of it do not overflow as those of
/// whole numbers do. The tables that are written row by row have the same form from their writer.
pub fn decimal(number: f64) -> String {
    format!("{number:?}")
}

#[cfg(test)]
mod tests {
    use super::decimal;

    #[test]
    fn no_number_looks_whole_and_all_come_back() {
        for number in [0.0, -0.0, 1.0, -3.0, 0.1, 200e9, 1e15, 1e16, 123_456_789_012_345_680.0, f64::MAX, 5e-324, 1.0 / 3.0] {
            let text = decimal(number);
            assert!(text.contains(['.', 'e']), "{text}");
            assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(number.to_bits()), "{text}");
        }
    }
}
