//! The fitted law.

/// The law at one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameters {
    /// F_N0.
    pub f_n0: f64,
    /// F_N_slip.
    pub f_n_slip: f64,
    /// delta_T_slip.
    pub delta_t_slip: f64,
    /// k_T0.
    pub k_t0: f64,
    /// n.
    pub n: f64,
    /// M.
    pub m_exponent: f64,
    /// N.
    pub n_exponent: f64,
}
