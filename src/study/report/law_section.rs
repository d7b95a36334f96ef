//! The law in the report: formulas with their constants, what they were compared with, errors,
//! range.

use super::html::{HtmlTable, escape, formula, number, percent};
use crate::law::Law;
use crate::law::report::{Errors, RegionError};

/// All that is to be said of a law.
pub fn law_section(law: &Law) -> String {
    let p = &law.provenance;
    let (coarsest, finest) = p.elements_per_contact_radius;
    let elements = if coarsest == finest { format!("{coarsest}") } else { format!("{coarsest} to {finest}") };
    let mut html = format!(
        "<p>Fitted by {} to the study <i>{}</i>: {} cases of {} materials, with {elements} elements per contact radius; {} cases left out. Its input is \
         the axisymmetric contact before the shear, (h, a<sub>0</sub>, F<sub>N0</sub>, σ<sub>rep</sub>), and μ; F<sub>N0</sub> and a<sub>0</sub> \
         may themselves come from the formulas in h.</p>\n",
        escape(&p.program),
        escape(&p.study),
        p.cases,
        p.materials,
        p.left_out.len()
    );
    if let Some(prior) = &p.prior {
        html.push_str(&format!(
            "<p>What these cases leave open was drawn to the constants of the law of the study <i>{}</i>.</p>\n",
            escape(&prior.study)
        ));
    }
    html.push_str("<div class=\"wide\"><table class=\"formulas\"><tbody>\n");
    for line in law.formulas().lines() {
        let (left, right) = line.split_once('=').unwrap_or(("", line));
        html.push_str(&format!("<tr><td>{}</td><td>=</td><td>{}</td></tr>\n", formula(left.trim()), formula(right.trim())));
    }
    html.push_str("</tbody></table></div>\n");

    html.push_str("<h3>Where it holds</h3>\n<p>The range of the cases that it was fitted to. Below first yield it is Cattaneo and Mindlin's law.</p>\n");
    html.push_str(&validity(law));

    html.push_str(&format!(
        "<h3>How well it holds</h3>\n<p>Errors in per cent, of F<sub>T</sub> as a share of its peak and of F<sub>N</sub> as a share of F<sub>N0</sub>: \
         rms over points and cases, and the greatest of all. They are cross-validated in {} folds: every case is predicted by constants that saw \
         nothing of its material.</p>\n",
        p.folds
    ));
    html.push_str("<p>With F<sub>N0</sub> and a<sub>0</sub> known:</p>\n");
    html.push_str(&regions(&law.errors));
    html.push_str("<p>With F<sub>N0</sub> and a<sub>0</sub> predicted from h as well:</p>\n");
    html.push_str(&regions(&law.errors_predicted));

    html.push_str(
        "<h3>What was compared</h3>\n<p>Fits to the study alone, and fits drawn to the prior with a weight \
         (of the normal problem two, for a0 and F_N0). In bold what was kept; the baselines have no constants.</p>\n",
    );
    let mut table = HtmlTable::new(
        &["fitted from", "constants", "F<sub>T</sub> rms", "F<sub>T</sub> max", "F<sub>N</sub> rms", "F<sub>N</sub> max"],
        &[0],
    );
    for candidate in &law.candidates {
        let mut cells = vec![formula(&candidate.name), candidate.constants.to_string()];
        cells.extend(errors(&candidate.errors));
        table.row(if candidate.kept { "kept" } else { "" }, &cells);
    }
    html.push_str(&table.html());
    let mut table = HtmlTable::new(
        &["normal problem", "constants", "a<sub>0</sub> rms", "a<sub>0</sub> max", "F<sub>N0</sub> rms", "F<sub>N0</sub> max"],
        &[0],
    );
    for c in &law.normal_candidates {
        let errors = [c.a_rms, c.a_max, c.f_n_rms, c.f_n_max].map(percent);
        let mut cells = vec![escape(&c.name), c.constants.to_string()];
        cells.extend(errors);
        table.row(if c.kept { "kept" } else { "" }, &cells);
    }
    html + &table.html()
}

fn validity(law: &Law) -> String {
    let v = &law.validity;
    let mut table = HtmlTable::new(&["quantity", "from", "to"], &[0]);
    for (name, range) in [
        ("Lambda", v.lambda),
        ("mu", v.friction),
        ("a_0/R", v.relative_radius),
        ("c^2", v.c_squared),
        ("nu", v.poissons_ratio),
        ("hardening exponent d ln sigma/d ln eps_p at eps_rep", v.hardening_exponent),
    ] {
        table.row("", &[formula(name), number(Some(range.from)), number(Some(range.to))]);
    }
    table.html()
}

fn errors(errors: &Errors) -> [String; 4] {
    [errors.f_t_rms, errors.f_t_max, errors.f_n_rms, errors.f_n_max].map(percent)
}

fn regions(rows: &[RegionError]) -> String {
    let header = ["region", "cases", "F<sub>T</sub> rms", "F<sub>T</sub> max", "F<sub>N</sub> rms", "F<sub>N</sub> max"];
    let mut table = HtmlTable::new(&header, &[0]);
    for row in rows {
        let mut cells = vec![formula(&row.region), row.errors.cases.to_string()];
        cells.extend(errors(&row.errors));
        table.row(if row.region == "all" { "kept" } else { "" }, &cells);
    }
    table.html()
}
