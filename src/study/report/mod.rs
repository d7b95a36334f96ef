//! `report.html`: a study in one file that needs nothing else: what it was, its cases, pictures,
//! and the law that was fitted to it.

mod html;
mod law_section;

use std::fs;
use std::path::PathBuf;

use self::html::{HtmlTable, escape, grid_value, number, percent};
use super::row::{FIRST_COLUMNS, NUMBERS};
use super::{StudyDirectory, StudyError};
use crate::bounded;
use crate::case::PictureFormat;
use crate::law::Law;
use crate::law::data::StudyData;
use crate::law::plots::{NormalContact, greatest_errors, study_pictures};
use crate::law::study_table::{StudyRow, StudyTable};
use crate::output::plots::Sheet;
use crate::output::{OutputDirectory, Picture, write_own};

/// Draws a study into `plots` and `report.html` of its directory and returns their paths, the
/// report last. The report has the pictures as SVG in their own widths, whatever those in `plots`
/// are.
///
/// # Errors
/// A table, case or history that cannot be read; files that cannot be written.
pub fn write_report(
    directory: &StudyDirectory,
    law: Option<&Law>,
    sheet: Sheet,
    format: PictureFormat,
) -> Result<Vec<PathBuf>, StudyError> {
    directory.refuse_links()?;
    let root = directory.root();
    let table = StudyTable::read(&directory.table())?;
    let data = StudyData::read(root)?;
    let mut contacts = Vec::new();
    for row in table.rows.iter().filter(|row| row.is_done()) {
        contacts.extend(NormalContact::read(&OutputDirectory::existing(root.join(&row.directory)))?);
    }
    let pictures = study_pictures(&contacts, &data, law, Sheet::default())?;
    let html = StudyPage { directory, table: &table, data: &data, law }.html(&pictures);
    let mut written = Vec::new();
    let own = (sheet != Sheet::default()).then(|| study_pictures(&contacts, &data, law, sheet)).transpose()?;
    for picture in own.as_ref().unwrap_or(&pictures) {
        let path = directory.plot(picture.name, format);
        picture.write(&path, format)?;
        written.push(path);
    }
    write_own(&directory.report(), |out| out.write_all(html.as_bytes()))?;
    written.push(directory.report());
    Ok(written)
}

struct StudyPage<'a> {
    directory: &'a StudyDirectory,
    table: &'a StudyTable,
    data: &'a StudyData,
    law: Option<&'a Law>,
}

impl StudyPage<'_> {
    fn html(&self, pictures: &[Picture]) -> String {
        let root = self.directory.root();
        let root = fs::canonicalize(root).unwrap_or_else(|_| root.to_owned());
        let name = escape(&root.file_name().map_or_else(|| "study".into(), |name| name.to_string_lossy()));
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, \
             initial-scale=1\"/>\n<title>Study {name}</title>\n<style>\n{}</style>\n</head>\n<body>\n<h1>Study <i>{name}</i></h1>\n",
            include_str!("style.css")
        );
        html.push_str(&self.summary());
        html.push_str("<h2>Pictures</h2>\n");
        if pictures.is_empty() {
            html.push_str("<p>None: no case has been computed to its end.</p>\n");
        }
        for picture in pictures {
            html.push_str(&format!(
                "<figure id=\"{}\">\n{}\n<figcaption>{}</figcaption>\n</figure>\n",
                picture.name,
                picture.svg.trim(),
                html::formula(&picture.caption)
            ));
        }
        html.push_str("<h2>The law</h2>\n");
        html.push_str(&match self.law {
            Some(law) => law_section::law_section(law),
            None => {
                "<p>None yet. <code>asperity law fit</code> determines one; make this report again after it.</p>\n".to_owned()
            }
        });
        html.push_str(&self.not_done());
        html.push_str("<h2>Cases</h2>\n");
        html.push_str(&self.cases());
        if let Ok(text) = bounded::result_to_string(&self.directory.study(), bounded::CASE) {
            html.push_str(&format!("<h2>The study file</h2>\n<pre>{}</pre>\n", escape(&text)));
        }
        html + "</body>\n</html>\n"
    }

    /// The grid's keys: what is between the first and the last columns.
    fn keys(&self) -> Vec<&str> {
        let known = |name: &&str| !FIRST_COLUMNS.contains(name) && !NUMBERS.contains(name);
        self.table.header.iter().map(String::as_str).filter(known).collect()
    }

    fn summary(&self) -> String {
        let rows = &self.table.rows;
        let mut statuses: Vec<(&str, usize)> = Vec::new();
        for row in rows {
            match statuses.iter_mut().find(|(status, _)| *status == row.status) {
                Some((_, count)) => *count += 1,
                None => statuses.push((&row.status, 1)),
            }
        }
        let statuses: Vec<String> = statuses.iter().map(|(status, count)| format!("{count} {}", escape(status))).collect();
        let total = |column: &str| rows.iter().filter_map(|row| self.table.number(row, column)).sum::<f64>();
        let hours = total("cpu_s") / 3600.0;
        let cost = if hours > 0.0 { format!(" They took {hours:.2} hours of processor time.") } else { String::new() };
        let mut html = format!(
            "<p>Elastic-plastic spheres pressed onto a rigid plane and sheared along it, by finite elements. {} cases: {}.{cost} Report by asperity {}.</p>\n",
            rows.len(),
            statuses.join(", "),
            env!("CARGO_PKG_VERSION")
        );
        let keys = self.keys();
        if !keys.is_empty() {
            let mut table = HtmlTable::new(&["varied", "values"], &[0, 1]);
            for key in keys {
                let mut values: Vec<&str> = Vec::new();
                for row in rows {
                    let value = self.table.cell(row, key);
                    if !values.contains(&value) {
                        values.push(value);
                    }
                }
                // Tables, which are long, a line each.
                let separator = if values.iter().any(|value| value.len() > 16) { "<br/>" } else { ", " };
                let values: Vec<String> = values.into_iter().map(grid_value).collect();
                table.row("", &[escape(key), values.join(separator)]);
            }
            html.push_str(&table.html());
        }
        html
    }

    /// The cases that did not end well, with their reasons; nothing if there are none.
    fn not_done(&self) -> String {
        let failed: Vec<&StudyRow> = self.table.rows.iter().filter(|row| !row.is_done() && row.status != "pending").collect();
        if failed.is_empty() {
            return String::new();
        }
        let keys = self.keys();
        let mut header = vec!["case".to_owned()];
        header.extend(keys.iter().map(|key| short(key)));
        header.extend(["status".to_owned(), "reason".to_owned()]);
        let columns: Vec<usize> = (0..header.len()).collect();
        let mut table = HtmlTable::new(&header, &columns);
        for row in failed {
            let mut cells = vec![escape(&row.id)];
            cells.extend(keys.iter().map(|key| grid_value(self.table.cell(row, key))));
            cells.extend([escape(&row.status), escape(self.table.cell(row, "reason"))]);
            table.row("", &cells);
        }
        format!("<h2>Cases that failed</h2>\n{}", table.html())
    }

    fn cases(&self) -> String {
        let keys = self.keys();
        let mut header: Vec<String> = vec!["case".to_owned(), "status".to_owned()];
        header.extend(keys.iter().map(|key| short(key)));
        let names = ["Lambda", "Hbar", "c2", "a_0/R", "F_N0/E R^2", "F_N_slip/F_N0", "delta_T_slip/R"];
        header.extend(names.map(html::formula));
        let errors = self.law.map(|law| greatest_errors(&self.data.samples, law));
        if errors.is_some() {
            header.extend(["F<sub>T</sub> error %".to_owned(), "F<sub>N</sub> error %".to_owned()]);
        }
        header.push("for a law".to_owned());
        let mut text: Vec<usize> = (0..2 + keys.len()).collect();
        text.push(header.len() - 1);
        let mut table = HtmlTable::new(&header, &text);
        for row in &self.table.rows {
            let mut cells = vec![escape(&row.id), escape(&row.status)];
            cells.extend(keys.iter().map(|key| grid_value(self.table.cell(row, key))));
            cells.extend(self.numbers(row).map(number));
            let sample = self.data.samples.iter().position(|sample| sample.id == row.id);
            if let Some((all, _)) = &errors {
                cells.extend(sample.map_or([String::new(), String::new()], |i| all[i].map(percent)));
            }
            let skipped = self.data.skipped.iter().find(|skipped| skipped.id == row.id);
            let reason = skipped.filter(|_| row.is_done()).map_or("", |skipped| &skipped.reason);
            cells.push(if sample.is_some() { "used".to_owned() } else { escape(reason) });
            table.row(if row.is_done() || row.status == "pending" { "" } else { "bad" }, &cells);
        }
        let note = match &errors {
            Some((_, true)) => {
                "<p>The errors are the greatest along each curve, cross-validated, F<sub>N0</sub> and a<sub>0</sub> being known.</p>\n"
            }
            Some((_, false)) => {
                "<p>The errors are the greatest along each curve, F<sub>N0</sub> and a<sub>0</sub> being known.</p>\n"
            }
            None => "",
        };
        format!("{note}{}", table.html())
    }

    /// The normalised numbers of a row, as far as the table has them.
    fn numbers(&self, row: &StudyRow) -> [Option<f64>; 7] {
        let cell = |column: &str| self.table.number(row, column);
        let over = |value: Option<f64>, unit: Option<f64>| Some(value? / unit?);
        let (radius, force) = (cell("R"), cell("F_N0"));
        let unit = cell("E").zip(radius).map(|(modulus, radius)| modulus * radius * radius);
        [
            cell("Lambda"),
            cell("Hbar"),
            cell("c2"),
            over(cell("a0"), radius),
            over(force, unit),
            over(cell("F_N_slip"), force),
            over(cell("delta_T_slip"), radius),
        ]
    }
}

/// The last word of a dotted key.
fn short(key: &str) -> String {
    escape(key.rsplit('.').next().unwrap_or(key))
}
