//! The law written out with its constants.

use std::fmt::Write;

use super::elastic::BODY;
use super::model::Law;
use super::shear::EXPONENT_SPAN;

impl Law {
    /// The formulas of the law with their constants, a line each, to be read by people; constants
    /// to four digits.
    pub fn formulas(&self) -> String {
        let [fall_a, fall_b, fall_p, fall_q, fall_r, fall_d] = self.constants.fall;
        let [n_c, n_p, n_q, n_d, n_s, n_r] = self.constants.exponent;
        let [body, rate, _, slip_q] = self.constants.slip;
        let [s, t, u, v] = self.constants.curve;
        let mut text = String::new();
        let mut line = |left: &str, right: &str| {
            let _ = writeln!(text, "{left:<15} = {right}");
        };
        line("F_T", "mu F_N_slip [1 - (1 - x)^n], x = delta_T/delta_T_end");
        line("F_N", "F_N0 - (F_N0 - F_N_slip) f_N, f_N = 1 - (1 - x^M)^N");
        line("Lambda_Y", "Lambda at first yield (2.533 at nu = 0.3); g = 1 - (Lambda_Y/Lambda)^2; below it g = z = w = 0");
        line("c2", "a^2/(2 R h)");
        line("z", "g (2 c2 - 1)");
        line("w", "g (2 c2 - 1)/ln(Lambda/Lambda_Y)");
        let size = format!("exp({fall_r:.4} mu w - {fall_d:.4} a/R)");
        line("F_N_slip/F_N0", &format!("1 - tanh({fall_a:.4} mu) tanh[{fall_b:.4} mu^{fall_p:.4} z^{fall_q:.4} {size}]"));
        // z's power is a formula itself.
        let power = format!("{n_q:.4} exp(-{n_s:.4} mu)");
        let size = format!("exp({n_r:.4} mu w - {n_d:.4} a/R)");
        line("n", &format!("1.5 + {EXPONENT_SPAN} tanh[{:.4} mu^{n_p:.4} z^({power}) {size}]", n_c / EXPONENT_SPAN));
        let slip = format!("(2 n/3) (F_N_slip/F_N0) (1 + {body:.4} a/R + {rate:.4} z^{slip_q:.4})");
        line("delta_T_end", &format!("3 mu F_N0 (2 - nu)/(16 G a0) f, f = {slip}"));
        line("N", &format!("{:.4} + {t:.4} (n - 1.5)", 1.0 + s));
        line("M", &format!("1 + {u:.4} mu^{v:.4}"));
        for (left, right) in self.normal_formulas() {
            line(left, &right);
        }
        text
    }

    fn normal_formulas(&self) -> [(&'static str, String); 4] {
        let ([c1, c2, c3, c4], [k1, k2, k3, k4, k5, k6], [b0, b1, b2, b3, b4]) = (self.normal.radius, self.normal.force, BODY);
        let area = format!("1/2 + [1.43 exp(-{c1:.4} e) - 1/2] [1 - exp(-({c2:.4} U)^{c3:.4})]");
        let plastic = format!("[1 + ({k1:.4} (Lambda - Lambda_Y)^{k2:.4})^{k3:.4}]^(-1/{k3:.4})");
        let elastic = format!(
            "S tanh(mu/beta) ({b0} + {b1} a_H/R) + (a_H/R) ({b2} + {b3} a_H/R + {b4} nu), \
             S = (1 - nu) ln(3 - 4 nu)/(1 - 2 nu) - 1, beta = (1 - 2 nu)/(2 - 2 nu)"
        );
        let with = "G = 1 - Lambda_Y/Lambda, U = ln(Lambda/Lambda_Y), e = d ln sigma/d ln eps_p at eps_rep; \
                    Lambda, e at Hertz's a_H = (R h)^(1/2), F_H Hertz's force";
        [
            ("a0^2", format!("2 R h {{{area}}} exp({c4:.4} G a_H/R)")),
            ("F_N0", format!("F_H {plastic} exp{{(1 - G) B + G [({k6:.4} - {k4:.4} U) a_H/R - {k5:.4} e]}}")),
            ("B", elastic),
            ("with", with.to_owned()),
        ]
    }
}
