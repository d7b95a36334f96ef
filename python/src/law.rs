//! Laws, and contacts that follow them.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity::Canceller;
use asperity::contact_law::path::PathPoint;
use asperity::contact_law::{ContactParameters, ContactState};
use asperity::law::check::{Checked, check_until};
use asperity::law::data::Point;
use asperity::law::export::{Language, law_files, law_source};
use asperity::law::interpolated::{self, Interpolated};
use asperity::law::model::OutOfRange;
use asperity::law::predict::{NormalSource, Prediction, predict};
use asperity::law::prior::{self, Prior};
use asperity::law::tabulated::{build, depths, study_text};
use asperity::law::{Law, LawError, LawFile, fit};
use asperity::output::{StepRecord, write_own};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;

use crate::case::NativeCase;
use crate::errors::{failed, refused};
use crate::wait::wait;

/// A law of either kind.
#[pyclass(name = "NativeLaw", frozen)]
pub struct NativeLaw {
    law: LawFile,
}

/// Fits formulas to the study in a directory, and writes `law.json` there.
#[pyfunction]
pub fn fit_law(py: Python<'_>, dir: PathBuf, prior: &str) -> PyResult<NativeLaw> {
    let law = py.detach(|| -> Result<Law, LawError> {
        let law = fit::fit(&dir, &Prior::from_option(prior)?)?;
        law.write(&dir.join("law.json"))?;
        Ok(law)
    });
    law.map(NativeLaw::formulas_of).map_err(failed)
}

/// Makes a law by interpolation between the contacts of the study in a directory, and writes
/// `law.json` there. `reversal`: the law that knows reversals and unloadings where the study has
/// none.
#[pyfunction]
#[pyo3(signature = (dir, reversal=None))]
pub fn interpolate_law(py: Python<'_>, dir: PathBuf, reversal: Option<&NativeLaw>) -> PyResult<NativeLaw> {
    let reversal = match reversal.map(|law| &law.law) {
        None => None,
        Some(LawFile::Interpolated(law)) => Some(law.as_ref()),
        Some(_) => return Err(refused("reversal: is no law by interpolation. Allowed: one, as Law.built_in() is")),
    };
    let law = py.detach(|| -> Result<Interpolated, LawError> {
        let law = interpolated::fit(&dir, reversal)?;
        law.write(&dir.join("law.json"))?;
        Ok(law)
    });
    law.map(|law| NativeLaw { law: LawFile::Interpolated(Box::new(law)) }).map_err(failed)
}

/// The study file of a table of a case's material and friction, up to its depth.
#[pyfunction]
pub fn table_study(case: &NativeCase, elements: usize) -> PyResult<String> {
    check_elements(elements)?;
    Ok(study_text(&case.case, elements, &depths(&case.case).map_err(refused)?))
}

/// Makes the table of that study, which lies in a directory, and writes `law.json` there; and the
/// depths that were not reached, with the reasons.
#[pyfunction]
pub fn table_law(dir: PathBuf, case: &NativeCase, elements: usize) -> PyResult<(NativeLaw, Vec<String>)> {
    let built = build(&dir, &case.case, elements).map_err(failed)?;
    let missing = built.missing.iter().map(|missing| format!("{} ended with: {}", missing.id, missing.reason)).collect();
    let law = LawFile::Table(Box::new(built.table));
    law.write(&dir.join("law.json")).map_err(failed)?;
    Ok((NativeLaw { law }, missing))
}

fn check_elements(elements: usize) -> PyResult<()> {
    if (4..=32).contains(&elements) { Ok(()) } else { Err(refused(format!("elements: is {elements}. Allowed: 4 to 32"))) }
}

#[pymethods]
impl NativeLaw {
    /// Reads a `law.json`.
    #[staticmethod]
    fn load(file: PathBuf) -> PyResult<Self> {
        LawFile::read(&file).map(|law| Self { law }).map_err(failed)
    }

    /// The law that comes with the program: by interpolation, or the formulas.
    #[staticmethod]
    fn built_in(formulas: bool) -> PyResult<Self> {
        if formulas {
            return prior::built_in().map(Self::formulas_of).map_err(failed);
        }
        Interpolated::built_in().map(|law| Self { law: LawFile::Interpolated(Box::new(law)) }).map_err(failed)
    }

    /// The table of a case's contact, of a law by interpolation; another law as it is.
    fn table(&self, py: Python<'_>, case: &NativeCase) -> PyResult<Self> {
        let law = py.detach(|| self.law.of_case(Some(&case.case)).map(std::borrow::Cow::into_owned));
        law.map(|law| Self { law }).map_err(failed)
    }

    /// Writes a `law.json`.
    fn save(&self, file: PathBuf) -> PyResult<()> {
        self.law.write(&file).map_err(failed)
    }

    /// The text of `law.json`.
    fn to_json(&self) -> PyResult<String> {
        match &self.law {
            LawFile::Formulas(law) => serde_json::to_string(law),
            LawFile::Table(table) => serde_json::to_string(table),
            LawFile::Interpolated(law) => serde_json::to_string(law),
        }
        .map_err(failed)
    }

    /// The formulas with their constants, as `law fit` prints them; a table has none.
    fn formulas(&self) -> PyResult<String> {
        match &self.law {
            LawFile::Formulas(law) => Ok(law.formulas()),
            LawFile::Table(_) => Err(failed("the law is a table of one material, which has no formulas. Fit a law to a study")),
            LawFile::Interpolated(_) => Err(failed("the law interpolates between contacts, and has no formulas")),
        }
    }

    /// segment, h, delta_T, F_N, F_T along the path of a case, and what of it lies outside of the
    /// law's range. With `press` one shear of a simulated press.
    fn predict<'py>(&self, py: Python<'py>, case: &NativeCase, press: bool) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
        let case = &case.case;
        let (points, outside) = py.detach(|| if press { self.pressed(case) } else { self.law.follow(case).map_err(failed) })?;
        let columns = PyDict::new(py);
        let column = |of: fn(&PathPoint) -> f64| PyArray1::from_iter(py, points.iter().map(of));
        columns.set_item("segment", PyArray1::from_iter(py, points.iter().map(|point| point.segment as i64)))?;
        columns.set_item("h", column(|point| point.h))?;
        columns.set_item("delta_T", column(|point| point.delta_t))?;
        columns.set_item("F_N", column(|point| point.f_n))?;
        columns.set_item("F_T", column(|point| point.f_t))?;
        Ok((columns, outside.iter().map(ToString::to_string).collect()))
    }

    /// Simulates the paths of `law check` for the material, the friction and the depth of a case
    /// (without one, of the table) and follows them with the law: a dictionary a path; and the
    /// exception that interrupted it.
    #[pyo3(signature = (case, elements))]
    fn check<'py>(
        &self,
        py: Python<'py>,
        case: Option<&NativeCase>,
        elements: usize,
    ) -> PyResult<(Bound<'py, PyList>, Option<PyErr>)> {
        check_elements(elements)?;
        let case = match (case, &self.law) {
            (Some(case), _) => case.case.clone(),
            (None, LawFile::Table(table)) => table.deepest_case().map_err(failed)?,
            (None, LawFile::Formulas(_) | LawFile::Interpolated(_)) => {
                return Err(refused("case: is missing, and the law is for all materials. Allowed: the case to check it for"));
            }
        };
        let stop = Arc::new(AtomicBool::new(false));
        let canceller = Canceller::on_signal(stop.clone());
        let work = |news| {
            let _news: std::sync::mpsc::Sender<_> = news;
            check_until(&self.law, &case, elements, &stop)
        };
        let (checked, raised) = wait(py, None, &canceller, work)?;
        let paths = checked.map_err(failed)?.iter().map(|one| path(py, one)).collect::<PyResult<Vec<_>>>()?;
        Ok((PyList::new(py, paths)?, raised))
    }

    /// The law as source; for C of the material and the friction of a case.
    #[pyo3(signature = (format, case=None))]
    fn source(&self, format: &str, case: Option<&NativeCase>) -> PyResult<String> {
        law_source(&self.law, language(format)?, case.map(|case| &case.case)).map_err(failed)
    }

    /// The law as source with its test vectors in a directory.
    #[pyo3(signature = (format, dir, case=None))]
    fn export(&self, format: &str, dir: PathBuf, case: Option<&NativeCase>) -> PyResult<Vec<PathBuf>> {
        let files = law_files(&self.law, language(format)?, case.map(|case| &case.case)).map_err(failed)?;
        std::fs::create_dir_all(&dir)?;
        let mut written = Vec::new();
        for file in files {
            let path = dir.join(file.name);
            write_own(&path, |out| out.write_all(file.content.as_bytes())).map_err(failed)?;
            written.push(path);
        }
        Ok(written)
    }

    /// `number` contacts of a case's sphere, before first touch.
    fn contacts(&self, case: &NativeCase, number: usize) -> PyResult<Contacts> {
        let parameters = self.law.contact_parameters(&case.case).map_err(failed)?;
        Ok(Contacts { parameters: Box::new(parameters), states: vec![ContactState::default(); number] })
    }
}

impl NativeLaw {
    fn formulas_of(law: Law) -> Self {
        Self { law: LawFile::Formulas(Box::new(law)) }
    }

    fn pressed(&self, case: &asperity::Case) -> PyResult<(Vec<PathPoint>, Vec<OutOfRange>)> {
        let LawFile::Formulas(law) = &self.law else {
            return Err(refused("press: is True, and the law has no formulas that take F_N0 and a0. Allowed: False"));
        };
        let Prediction { curve, out_of_range, inputs, .. } = predict(law, case, NormalSource::Press).map_err(failed)?;
        let point = |p: &Point| PathPoint { segment: 1, h: inputs.h, delta_t: p.delta_t, f_n: p.f_n, f_t: p.f_t };
        Ok((curve.iter().map(point).collect(), out_of_range))
    }
}

/// One checked path for Python.
fn path<'py>(py: Python<'py>, checked: &Checked) -> PyResult<Bound<'py, PyDict>> {
    let answer = PyDict::new(py);
    let column = |of: fn(&StepRecord) -> f64| PyArray1::from_iter(py, checked.rows.iter().map(of));
    let law = |i: usize| PyArray1::from_iter(py, checked.law.iter().map(|forces| forces[i]));
    let columns = PyDict::new(py);
    columns.set_item("segment", PyArray1::from_iter(py, checked.rows.iter().map(|row| row.segment as i64)))?;
    columns.set_item("h", column(|row| row.h))?;
    columns.set_item("delta_T", column(|row| row.delta_t))?;
    columns.set_item("F_N", column(|row| row.f_n))?;
    columns.set_item("F_T", column(|row| row.f_t))?;
    columns.set_item("law_F_N", law(0))?;
    columns.set_item("law_F_T", law(1))?;
    let [tangential, normal] = checked.errors();
    answer.set_item("path", checked.name)?;
    answer.set_item("columns", columns)?;
    answer.set_item("F_T_rms", tangential.rms)?;
    answer.set_item("F_T_worst", tangential.worst)?;
    answer.set_item("F_N_rms", normal.rms)?;
    answer.set_item("F_N_worst", normal.worst)?;
    answer.set_item("dissipated", checked.dissipated[0])?;
    answer.set_item("law_dissipated", checked.dissipated[1])?;
    answer.set_item("within", tangential.within() && normal.within())?;
    answer.set_item("failure", checked.failure.as_deref().unwrap_or_default())?;
    Ok(answer)
}

fn language(word: &str) -> PyResult<Language> {
    match word {
        "c" => Ok(Language::C),
        "python" => Ok(Language::Python),
        other => Err(refused(format!("format: is {other:?}. Allowed: \"c\", \"python\""))),
    }
}

/// The memory of contacts of one pair of materials.
#[pyclass(name = "NativeContacts")]
#[derive(Clone)]
pub struct Contacts {
    parameters: Box<ContactParameters>,
    states: Vec<ContactState>,
}

/// Contacts that a thread takes at a time: some hundred microseconds of work.
const CHUNK: usize = 256;

#[pymethods]
impl Contacts {
    fn __len__(&self) -> usize {
        self.states.len()
    }

    fn copy(&self) -> Self {
        self.clone()
    }

    /// Numbers that a contact keeps.
    #[staticmethod]
    fn width() -> usize {
        size_of::<ContactState>() / size_of::<f64>()
    }

    /// The memory as an array, a row a contact.
    fn to_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let numbers: Vec<f64> = self.states.iter().flat_map(row).collect();
        PyArray1::from_vec(py, numbers).reshape([self.states.len(), Self::width()])
    }

    /// Puts back what `to_array` gave.
    fn set_array(&mut self, memory: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let memory = memory.as_array();
        if memory.shape() != [self.states.len(), Self::width()] {
            let (found, rows, width) = (memory.shape(), self.states.len(), Self::width());
            return Err(refused(format!("state: has the shape {found:?}. Allowed: ({rows}, {width})")));
        }
        for (state, row) in self.states.iter_mut().zip(memory.rows()) {
            *state = of_row(&row.to_vec());
        }
        Ok(())
    }

    /// Turns the tangential memory of each contact into axes that are turned by an angle with that
    /// cosine and sine.
    fn rotate(&mut self, cosine: PyReadonlyArray1<'_, f64>, sine: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        let number = self.states.len();
        check_length("cosine", cosine.len(), number)?;
        check_length("sine", sine.len(), number)?;
        for ((state, &c), &s) in self.states.iter_mut().zip(cosine.as_array()).zip(sine.as_array()) {
            state.rotate(c, s);
        }
        Ok(())
    }

    /// Moves every contact to `h` and along the plane by `delta`; forces and tangents.
    fn update<'py>(
        &mut self,
        py: Python<'py>,
        h: PyReadonlyArray1<'py, f64>,
        delta: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let number = self.states.len();
        check_length("h", h.len(), number)?;
        if delta.shape() != [number, 2] {
            return Err(refused(format!("delta: has the shape {:?}. Allowed: ({number}, 2)", delta.shape())));
        }
        let (h, delta) = (h.as_array(), delta.as_array());
        let Self { parameters, states } = self;
        let responses: Vec<_> = py.detach(|| {
            let move_one = |(i, state): (usize, &mut ContactState)| {
                let (next, response) = parameters.update(state, h[i], [delta[[i, 0]], delta[[i, 1]]]);
                *state = next;
                response
            };
            states.par_iter_mut().enumerate().with_min_len(CHUNK).map(move_one).collect()
        });
        let out = PyDict::new(py);
        let flat = |numbers: Vec<f64>| PyArray1::from_vec(py, numbers);
        out.set_item("F_N", flat(responses.iter().map(|r| r.f_n).collect()))?;
        out.set_item("F_T", flat(responses.iter().flat_map(|r| r.f_t).collect()).reshape([number, 2])?)?;
        out.set_item("a", flat(responses.iter().map(|r| r.a).collect()))?;
        out.set_item("dF_N_dh", flat(responses.iter().map(|r| r.df_n_dh).collect()))?;
        out.set_item("dF_N_ddelta", flat(responses.iter().flat_map(|r| r.df_n_ddelta).collect()).reshape([number, 2])?)?;
        let tangents = responses.iter().flat_map(|r| r.df_t_ddelta).flatten().collect();
        out.set_item("dF_T_ddelta", flat(tangents).reshape([number, 2, 2])?)?;
        Ok(out)
    }
}

fn check_length(name: &str, found: usize, wanted: usize) -> PyResult<()> {
    if found == wanted { Ok(()) } else { Err(refused(format!("{name}: has {found} numbers. Allowed: {wanted}, one a contact"))) }
}

/// The numbers of a state in a row, as they lie in memory.
fn row(state: &ContactState) -> impl Iterator<Item = f64> {
    let ContactState { h, h_max, approach, reach, x, sheared, reversed, deflection } = *state;
    [h, h_max, approach, reach, x, sheared, reversed].into_iter().chain(deflection.into_iter().flatten())
}

/// The state of a row, which is long enough.
fn of_row(row: &[f64]) -> ContactState {
    let mut state = ContactState {
        h: row[0],
        h_max: row[1],
        approach: row[2],
        reach: row[3],
        x: row[4],
        sheared: row[5],
        reversed: row[6],
        ..ContactState::default()
    };
    state.deflection.iter_mut().flatten().zip(&row[7..]).for_each(|(to, from)| *to = *from);
    state
}
