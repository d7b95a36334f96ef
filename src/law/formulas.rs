//! The law written out with its constants.

use std::fmt::Write;

use super::Law;
use super::elastic::BODY;
use super::forms::{EXPONENT_SPAN, NormalCurve, SlipForm, Variable};
use super::normal::NormalForm;

impl Law {
    /// The formulas of the law with their constants, a line each, to be read by people; constants
    /// to four digits.
    pub fn formulas(&self) -> String {
        let variable = self.forms.variable;
        let product = |p: f64, q: f64| match variable {
            Variable::FrictionLambda => format!("z^{q:.4}"),
            _ => format!("mu^{p:.4} z^{q:.4}"),
        };
        let z = match variable {
            Variable::Lambda => "ln(Lambda/Lambda_Y)",
            Variable::FrictionLambda => "ln[1 + mu (Lambda - Lambda_Y)]",
            Variable::Stiffness => "g ln[4 Lambda/(3 pi Hbar)]",
            Variable::Area => "g (2 c2 - 1)",
        };
        let [fall_a, fall_b, fall_p, fall_q, fall_r, fall_d] = self.constants.fall;
        let [n_c, n_p, n_q, n_d, n_s, n_r] = self.constants.exponent;
        let [body, rate, slip_p, slip_q] = self.constants.slip;
        let [s, t, u, v] = self.constants.curve;
        let slip = match self.forms.slip_displacement {
            SlipForm::Direct => format!("1 + {body:.4} a/R + {rate:.4} {}", product(slip_p, slip_q)),
            SlipForm::ThroughStiffness => format!("(2 n/3) (F_N_slip/F_N0) (1 + {body:.4} a/R + {rate:.4} z^{slip_q:.4})"),
        };
        let (steep, gentle, curve) = match self.forms.normal_curve {
            NormalCurve::PowerOfComplement => ("M", "N", "[1 - (1 - x)^M]^N"),
            NormalCurve::ComplementOfPower => ("N", "M", "1 - (1 - x^M)^N"),
        };
        let mut text = String::new();
        let mut line = |left: &str, right: &str| {
            let _ = writeln!(text, "{left:<15} = {right}");
        };
        line("F_T", "mu F_N_slip [1 - (1 - x)^n], x = delta_T/delta_T_slip");
        line("F_N", &format!("F_N0 - (F_N0 - F_N_slip) f_N, f_N = {curve}"));
        line("Lambda_Y", "Lambda at first yield (2.533 at nu = 0.3); g = 1 - (Lambda_Y/Lambda)^2; below it g = z = w = 0");
        line("c2", "a^2/(2 R h)");
        line("z", z);
        line("w", "g (2 c2 - 1)/ln(Lambda/Lambda_Y)");
        let size = format!("exp({fall_r:.4} mu w - {fall_d:.4} a/R)");
        line("F_N_slip/F_N0", &format!("1 - tanh({fall_a:.4} mu) tanh[{fall_b:.4} {} {size}]", product(fall_p, fall_q)));
        // z's power is a formula itself.
        let power = format!("{n_q:.4} exp(-{n_s:.4} mu)");
        let friction = if variable == Variable::FrictionLambda { String::new() } else { format!("mu^{n_p:.4} ") };
        let size = format!("exp({n_r:.4} mu w - {n_d:.4} a/R)");
        line("n", &format!("1.5 + {EXPONENT_SPAN} tanh[{:.4} {friction}z^({power}) {size}]", n_c / EXPONENT_SPAN));
        line("delta_T_slip", &format!("3 mu F_N0 (2 - nu)/(16 G a0) f, f = {slip}"));
        line(steep, &format!("{:.4} + {t:.4} (n - 1.5)", 1.0 + s));
        line(gentle, &format!("1 + {u:.4} mu^{v:.4}"));
        for (left, right) in self.normal_formulas() {
            line(left, &right);
        }
        text
    }

    fn normal_formulas(&self) -> Vec<(&'static str, String)> {
        let variables = "G = 1 - Lambda_Y/Lambda, U = ln(Lambda/Lambda_Y), e = d ln sigma/d ln eps_p at eps_rep";
        match (self.normal.form, self.normal.radius.as_slice(), self.normal.force.as_slice()) {
            (NormalForm::Corrected, &[c1, c2], &[d1, d2, d3, d4]) => vec![
                ("a0", format!("a_OL exp[G ({c1:.4} + {c2:.4} U)], a_OL of Olsson & Larsson (2016)")),
                ("F_N0", format!("F_OL exp[G ({d1:.4} + {d2:.4} a/R + {d3:.4} e + {d4:.4} U)]")),
                ("with", variables.to_owned()),
            ],
            (NormalForm::Smooth, &[b1, b2, b3, b4], &[k1, k2, k3, k4, k5, k6]) => vec![
                (
                    "a0^2",
                    format!(
                        "2 R h {{1/2 + [1.43 exp(-{b1:.4} e) - 1/2] [1 - exp(-({b2:.4} U)^{b3:.4})]}} exp({:.4} G a_H/R)",
                        b4
                    ),
                ),
                (
                    "F_N0",
                    format!(
                        "F_H [1 + ({k1:.4} X^{k2:.4})^{k3:.4}]^(-1/{k3:.4}) exp{{G [({k4:.4} - {k5:.4} U) a_H/R - {k6:.4} e]}}"
                    ),
                ),
                (
                    "with",
                    format!("{variables}, X = Lambda/Lambda_Y - 1; Lambda, e at Hertz's a_H = (R h)^(1/2), F_H Hertz's force"),
                ),
            ],
            (NormalForm::Composed, &[c1, c2, c3, c4], &[k1, k2, k3, k4, k5, k6]) => {
                let [b0, b1, b2, b3, b4] = BODY;
                let area = format!("1/2 + [1.43 exp(-{c1:.4} e) - 1/2] [1 - exp(-({c2:.4} U)^{c3:.4})]");
                let plastic = format!("[1 + ({k1:.4} (Lambda - Lambda_Y)^{k2:.4})^{k3:.4}]^(-1/{k3:.4})");
                vec![
                    ("a0^2", format!("2 R h {{{area}}} exp({c4:.4} G a_H/R)")),
                    ("F_N0", format!("F_H {plastic} exp{{(1 - G) B + G [({k6:.4} - {k4:.4} U) a_H/R - {k5:.4} e]}}")),
                    (
                        "B",
                        format!(
                            "S tanh(mu/beta) ({b0} + {b1} a_H/R) + (a_H/R) ({b2} + {b3} a_H/R + {b4} nu), S = (1 - nu) ln(3 - 4 nu)/(1 - 2 nu) - 1, beta = (1 - 2 nu)/(2 - 2 nu)"
                        ),
                    ),
                    ("with", format!("{variables}; Lambda, e at Hertz's a_H = (R h)^(1/2), F_H Hertz's force")),
                ]
            }
            _ => vec![("a0, F_N0", "Olsson & Larsson (2016)".to_owned())],
        }
    }
}
