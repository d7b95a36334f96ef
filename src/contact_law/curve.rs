//! The two forms of f_N(x), of which a law has one.

/// How f_N is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NormalCurve {
    /// f_N = [1 - (1 - x)^M]^N; M is the steep exponent.
    PowerOfComplement,
    /// f_N = 1 - (1 - x^M)^N; N is the steep exponent.
    ComplementOfPower,
}

impl NormalCurve {
    /// f_N(x), x clamped to \[0, 1\]: 0 at 0, 1 at 1, not decreasing.
    pub fn value(self, x: f64, m: f64, n: f64) -> f64 {
        let x = x.clamp(0.0, 1.0);
        match self {
            Self::PowerOfComplement => (1.0 - (1.0 - x).powf(m)).powf(n),
            Self::ComplementOfPower => 1.0 - (1.0 - x.powf(m)).powf(n),
        }
    }

    /// (M, N) from the steep and the gentle exponent.
    pub fn exponents(self, steep: f64, gentle: f64) -> (f64, f64) {
        match self {
            Self::PowerOfComplement => (steep, gentle),
            Self::ComplementOfPower => (gentle, steep),
        }
    }
}
