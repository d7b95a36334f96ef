//! A summary for people, at the end of a run.

use std::fmt::Write;

use super::{RunStatus, Summary};

impl Summary {
    /// Lines for forces in the user's units and their errors, if there are any, and the beginning
    /// of one that says where they are: how the run ended, and what it took.
    pub fn brief(&self) -> String {
        let limit = self.f_t_max_limit.map_or_else(String::new, |limit| format!(" (limit {})", significant(limit)));
        let named = [
            ("F_N0", self.f_n0, self.f_n0_error, String::new()),
            ("F_N_slip", self.f_n_slip, None, String::new()),
            ("F_T_max", self.f_t_max, self.f_t_max_error, limit),
            ("a0", self.a0, self.a0_error, String::new()),
        ];
        let there = || named.iter().filter_map(|(name, value, error, more)| value.map(|value| (name, value, error, more)));
        let values: Vec<String> = there().map(|(name, value, _, more)| format!("{name} {}{more}", significant(value))).collect();
        let told = |(name, value, error, _): (&&str, f64, &Option<f64>, &String)| {
            let share = error.filter(|_| value != 0.0)? / value.abs();
            Some(format!("{name} +- {:.1} %", 100.0 * share))
        };
        let errors: Vec<String> = there().filter_map(told).collect();
        let errors = if errors.is_empty() { "not estimated".to_owned() } else { errors.join(", ") };
        let so_far = if self.status == RunStatus::Done { "" } else { "so far: " };
        let mut text = String::new();
        if !values.is_empty() {
            text += &format!("{so_far}{}\nerrors: {errors}\n", values.join("  "));
        }
        text + &format!("{} in {:.1} s, {} steps; ", self.status, self.wall_s, self.steps)
    }

    /// Some lines: what came out, in the user's units, and what it took.
    pub fn report(&self) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: Option<f64>, error: Option<f64>, what: &str| {
            if let Some(value) = value {
                let error =
                    error.filter(|_| value != 0.0).map(|e| format!(" (+- {:.1} %)", 100.0 * e / value.abs())).unwrap_or_default();
                // Writing to a String cannot fail.
                let _ = writeln!(text, "{name:<13} {:<13} {what}{error}", significant(value));
            }
        };
        let pressed = match self.f_t_max {
            Some(_) => "normal force before the shear",
            None => "normal force at the greatest indentation",
        };
        line("F_N0", self.f_n0, self.f_n0_error, pressed);
        line("a0", self.a0, self.a0_error, "contact radius there");
        line("h0", self.h0, None, "indentation there");
        line("F_N_slip", self.f_n_slip, None, "normal force at full slip");
        line("F_T_max", self.f_t_max, self.f_t_max_error, "greatest tangential force");
        line("F_T_max_limit", self.f_t_max_limit, None, "the same in the limit of fine meshes and short steps");
        line(
            "delta_T_90",
            self.delta_t_90,
            self.delta_t_90_error,
            "displacement at which F_T/F_N is 0.90 of the friction coefficient",
        );
        line("delta_T_95", self.delta_t_95, self.delta_t_95_error, "the same at 0.95");
        line("delta_T_slip", self.delta_t_slip, None, "displacement at which F_T/F_N is 0.99 of the friction coefficient");
        line("k_T0", self.k_t0, self.k_t0_error, "initial tangential stiffness");
        let cutbacks = if self.cutbacks > 0 { format!(", {} cut-backs", self.cutbacks) } else { String::new() };
        let _ = writeln!(
            text,
            "{}: {} steps, {} Newton iterations{cutbacks}, {} elements, {} unknowns, {:.1} s on {} in {}",
            self.status,
            self.steps,
            self.newton_iterations,
            self.elements,
            self.unknowns,
            self.wall_s,
            self.device,
            self.precision
        );
        text += &self.time_by_phase.table(self.wall_s, self.cpu_s);
        text
    }
}

/// Six significant digits, without an exponent where that is readable.
fn significant(value: f64) -> String {
    rounded(value, 6)
}

/// So many significant digits, without an exponent where that is readable.
pub(super) fn rounded(value: f64, digits: i32) -> String {
    let place = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    if (-4..6).contains(&place) {
        format!("{value:.*}", (digits - 1 - place).max(0) as usize)
    } else {
        format!("{value:.*e}", (digits - 1) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::RunStatus;

    #[test]
    fn numbers_are_readable() {
        for (value, expected) in
            [(148.812_345, "148.812"), (0.208_7, "0.208700"), (1.5e-9, "1.50000e-9"), (123_456.7, "123457"), (0.0, "0.00000")]
        {
            assert_eq!(significant(value), expected);
        }
    }

    #[test]
    fn the_brief_report_has_what_there_is() {
        let mut summary = Summary { status: RunStatus::Done, steps: 7, wall_s: 2.04, ..Summary::default() };
        assert_eq!(summary.brief(), "done in 2.0 s, 7 steps; ");
        (summary.f_n0, summary.a0) = (Some(150.0), Some(0.2));
        assert_eq!(summary.brief(), "F_N0 150.000  a0 0.200000\nerrors: not estimated\ndone in 2.0 s, 7 steps; ");
        (summary.f_n0_error, summary.f_t_max, summary.f_t_max_limit) = (Some(1.5), Some(30.0), Some(29.5));
        let expected =
            "F_N0 150.000  F_T_max 30.0000 (limit 29.5000)  a0 0.200000\nerrors: F_N0 +- 1.0 %\ndone in 2.0 s, 7 steps; ";
        assert_eq!(summary.brief(), expected);
        summary.status = RunStatus::Interrupted;
        assert!(summary.brief().starts_with("so far: F_N0 150.000 "));
    }

    #[test]
    fn what_is_not_there_is_not_told() {
        let mut summary =
            Summary { f_n0: Some(72.6), status: RunStatus::Done, device: "CPU (1 thread)".into(), ..Summary::default() };
        summary.precision = "f64".into();
        let text = summary.report();
        assert!(text.starts_with("F_N0          72.6000       normal force at the greatest indentation\n"), "{text}");
        assert!(
            text.contains(
                "done: 0 steps, 0 Newton iterations, 0 elements, 0 unknowns, 0.0 s on CPU (1 thread) in f64\ntime by phase "
            ),
            "{text}"
        );
        assert!(!text.contains("F_T_max") && !text.contains("cut-backs"));
        summary.f_t_max = Some(31.0);
        summary.cutbacks = 2;
        let text = summary.report();
        assert!(text.contains("before the shear") && text.contains("F_T_max") && text.contains("2 cut-backs"), "{text}");
    }
}
