//! Laws, and contacts that follow them.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity::Canceller;
use asperity::case::Segment;
use asperity::contact_law::path::PathPoint;
use asperity::law::check::{CheckedPath, check, protocol};
use asperity::law::export::{Language, law_files, law_source};
use asperity::law::formulas::fit::fit;
use asperity::law::formulas::predict::{NormalSource, predict};
use asperity::law::formulas::prior::Prior;
use asperity::law::interpolated::{self, Interpolated};
use asperity::law::range::OutOfRange;
use asperity::law::table::{build, depths, study_text};
use asperity::law::{Law, LawError, LawFile};
use asperity::output::{StepRecord, write_own};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arguments::{self, whole};
use crate::case::NativeCase;
use crate::contacts::Contacts;
use crate::errors::{failed, refused};
use crate::pictures::{NativePicture, law_picture};
use crate::process::compute;
use crate::wait::wait;

/// A law of either kind.
#[pyclass(name = "NativeLaw", frozen)]
pub struct NativeLaw {
    law: Arc<LawFile>,
}

/// Fits formulas to the study in a directory, and writes `law.json` there.
#[pyfunction]
pub fn fit_law(py: Python<'_>, dir: PathBuf, prior: &str) -> PyResult<NativeLaw> {
    let law = compute(py, || -> Result<Law, LawError> {
        let law = fit(&dir, &Prior::from_option(prior)?)?;
        law.write(&dir.join("law.json"))?;
        Ok(law)
    })?;
    law.map(NativeLaw::formulas_of).map_err(failed)
}

/// Makes a law by interpolation between the contacts of the study in a directory, and writes
/// `law.json` there. `reversal`: the law that knows reversals and unloadings where the study has
/// none.
#[pyfunction]
#[pyo3(signature = (dir, reversal=None))]
pub fn interpolate_law(py: Python<'_>, dir: PathBuf, reversal: Option<&NativeLaw>) -> PyResult<NativeLaw> {
    let reversal = match reversal.map(|law| law.law.as_ref()) {
        None => None,
        Some(LawFile::Interpolated(law)) => Some(law.as_ref()),
        Some(_) => return Err(refused("reversal: is no law by interpolation. Allowed: one, as Law.built_in() is")),
    };
    let law = compute(py, || -> Result<Interpolated, LawError> {
        let law = interpolated::fit(&dir, reversal)?;
        law.write(&dir.join("law.json"))?;
        Ok(law)
    })?;
    law.map(|law| NativeLaw::of(LawFile::Interpolated(Box::new(law)))).map_err(failed)
}

/// The study file of a table of a case's material and friction, up to its depth.
#[pyfunction]
pub fn table_study(case: &NativeCase, elements: &Bound<'_, PyAny>) -> PyResult<String> {
    let elements = arguments::elements(elements)?;
    Ok(study_text(&case.case, elements, &depths(&case.case).map_err(refused)?))
}

/// Makes the table of that study, which lies in a directory, and writes `law.json` there; and the
/// depths that were not reached, with the reasons.
#[pyfunction]
pub fn table_law(
    py: Python<'_>,
    dir: PathBuf,
    case: &NativeCase,
    elements: &Bound<'_, PyAny>,
) -> PyResult<(NativeLaw, Vec<String>)> {
    let elements = arguments::elements(elements)?;
    let built = compute(py, || build(&dir, &case.case, elements))?.map_err(failed)?;
    let missing = built.missing.iter().map(|missing| format!("{} ended with: {}", missing.id, missing.reason)).collect();
    let law = LawFile::Table(Box::new(built.table));
    law.write(&dir.join("law.json")).map_err(failed)?;
    Ok((NativeLaw::of(law), missing))
}

#[pymethods]
impl NativeLaw {
    /// Reads a `law.json`.
    #[staticmethod]
    fn load(file: PathBuf) -> PyResult<Self> {
        LawFile::read(&file).map(Self::of).map_err(failed)
    }

    /// Of the text of a `law.json`.
    #[staticmethod]
    #[pyo3(signature = (text, pair=None))]
    fn from_json(text: &str, pair: Option<&str>) -> PyResult<Self> {
        let mut law = LawFile::parse(text, "law").map_err(failed)?;
        let pair = pair.map(|pair| LawFile::parse(pair, "law of equal spheres")).transpose().map_err(failed)?;
        if let (LawFile::Interpolated(law), Some(LawFile::Interpolated(pair))) = (&mut law, pair) {
            law.pair = Some(pair);
        }
        Ok(Self::of(law))
    }

    /// The law that comes with the program, by interpolation.
    #[staticmethod]
    fn built_in() -> PyResult<Self> {
        LawFile::built_in().map(Self::of).map_err(failed)
    }

    /// The formulas of the study wear-2014.
    #[staticmethod]
    fn wear_2014() -> PyResult<Self> {
        Law::wear_2014().map(Self::formulas_of).map_err(failed)
    }

    /// The table of a case's contact, of a law by interpolation; another law as it is.
    fn table(&self, py: Python<'_>, case: &NativeCase) -> PyResult<Self> {
        let law = compute(py, || self.law.of_case(Some(&case.case)).map(std::borrow::Cow::into_owned))?;
        law.map(Self::of).map_err(failed)
    }

    /// Writes a `law.json`.
    fn save(&self, file: PathBuf) -> PyResult<()> {
        self.law.write(&file).map_err(failed)
    }

    /// The text of `law.json`, and that of the law of equal spheres that the built-in one has
    /// beside it.
    fn to_json(&self) -> PyResult<(String, Option<String>)> {
        let pair = match self.law.as_ref() {
            LawFile::Interpolated(law) => law.pair.as_ref().map(serde_json::to_string).transpose().map_err(failed)?,
            LawFile::Formulas(_) | LawFile::Table(_) => None,
        };
        let text = match self.law.as_ref() {
            LawFile::Formulas(law) => serde_json::to_string(law),
            LawFile::Table(table) => serde_json::to_string(table),
            LawFile::Interpolated(law) => serde_json::to_string(law),
        };
        Ok((text.map_err(failed)?, pair))
    }

    /// The formulas with their constants, as `law fit` prints them; a table has none.
    fn formulas(&self) -> PyResult<String> {
        match self.law.as_ref() {
            LawFile::Formulas(law) => Ok(law.formulas()),
            LawFile::Table(_) => Err(failed("the law is a table of one material, which has no formulas. Fit a law to a study")),
            LawFile::Interpolated(_) => Err(failed("the law interpolates between contacts, and has no formulas")),
        }
    }

    /// segment, h, delta_T, F_N, F_T along the path of a case, and what of it lies outside of the
    /// law's range. With `press` one shear of a simulated press.
    fn predict<'py>(&self, py: Python<'py>, case: &NativeCase, press: bool) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
        let case = &case.case;
        let (points, outside) = compute(py, || if press { self.pressed(case) } else { self.law.follow(case).map_err(failed) })??;
        let columns = PyDict::new(py);
        let column = |of: fn(&PathPoint) -> f64| PyArray1::from_iter(py, points.iter().map(of));
        columns.set_item("segment", PyArray1::from_iter(py, points.iter().map(|point| point.segment as i64)))?;
        columns.set_item("h", column(|point| point.h))?;
        columns.set_item("delta_T", column(|point| point.delta_t))?;
        columns.set_item("F_N", column(|point| point.f_n))?;
        columns.set_item("F_T", column(|point| point.f_t))?;
        if case.path.iter().any(Segment::leaves_x) {
            columns.set_item("delta_T_y", column(|point| point.delta_t_y))?;
            columns.set_item("F_T_y", column(|point| point.f_t_y))?;
        }
        if case.turns() {
            for (k, about) in ["twist", "roll_x", "roll_y"].into_iter().enumerate() {
                columns.set_item(about, points.iter().map(|point| point.turned[k]).collect::<Vec<_>>())?;
            }
            for (k, moment) in ["M_twist", "M_roll_x", "M_roll_y"].into_iter().enumerate() {
                columns.set_item(moment, points.iter().map(|point| point.moments[k]).collect::<Vec<_>>())?;
            }
        }
        Ok((columns, outside.iter().map(ToString::to_string).collect()))
    }

    /// A picture of what it predicts along the path of a case.
    fn plot(
        &self,
        py: Python<'_>,
        case: &NativeCase,
        name: Option<&str>,
        width: Option<&str>,
        title: bool,
    ) -> PyResult<(NativePicture, Vec<String>)> {
        let case = &case.case;
        let (points, outside) = compute(py, || self.law.follow(case).map_err(failed))??;
        Ok((law_picture(&points, case, name, width, title)?, outside.iter().map(ToString::to_string).collect()))
    }

    /// Simulates the paths of `law check` for the material, the friction and the depth of a case
    /// (without one, of the table) and follows them with the law: a dictionary a path; and the
    /// exception that interrupted it.
    #[pyo3(signature = (case, elements))]
    fn check<'py>(
        &self,
        py: Python<'py>,
        case: Option<&NativeCase>,
        elements: &Bound<'py, PyAny>,
    ) -> PyResult<(Bound<'py, PyList>, Option<PyErr>)> {
        let elements = arguments::elements(elements)?;
        let case = match (case, self.law.as_ref()) {
            (Some(case), _) => case.case.clone(),
            (None, LawFile::Table(table)) => table.deepest_case().map_err(failed)?,
            (None, LawFile::Formulas(_) | LawFile::Interpolated(_)) => {
                return Err(refused("case: is missing, and the law is for all materials. Allowed: the case to check it for"));
            }
        };
        let stop = Arc::new(AtomicBool::new(false));
        let canceller = Canceller::on_signal(stop.clone());
        let law = self.law.clone();
        let work = move |news| {
            let _news: std::sync::mpsc::Sender<_> = news;
            let paths = protocol(&case, &law.contact_parameters(&case)?, elements);
            check(&law, &paths, &stop)
        };
        let (checked, raised) = wait(py, None, &canceller, None, work)?;
        let paths = checked.map_err(failed)?.iter().map(|one| path(py, one)).collect::<PyResult<Vec<_>>>()?;
        Ok((PyList::new(py, paths)?, raised))
    }

    /// The law as source; for C of the material and the friction of a case.
    #[pyo3(signature = (format, case=None))]
    fn source(&self, py: Python<'_>, format: &str, case: Option<&NativeCase>) -> PyResult<String> {
        let language = language(format)?;
        compute(py, || law_source(&self.law, language, case.map(|case| &case.case)))?.map_err(failed)
    }

    /// The law as source with its test vectors in a directory.
    #[pyo3(signature = (format, dir, case=None))]
    fn export(&self, py: Python<'_>, format: &str, dir: PathBuf, case: Option<&NativeCase>) -> PyResult<Vec<PathBuf>> {
        let language = language(format)?;
        let files = compute(py, || law_files(&self.law, language, case.map(|case| &case.case)))?.map_err(failed)?;
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
    fn contacts(&self, py: Python<'_>, case: &NativeCase, number: &Bound<'_, PyAny>) -> PyResult<Contacts> {
        let number = whole("number", number, 0..=isize::MAX as usize, "a number of contacts, 0 or more")?;
        let states = Contacts::room(number)?;
        let parameters = compute(py, || self.law.contact_parameters(&case.case))?.map_err(failed)?;
        Ok(Contacts::new(parameters, states))
    }
}

impl NativeLaw {
    /// The law itself.
    pub fn file(&self) -> &LawFile {
        &self.law
    }

    fn of(law: LawFile) -> Self {
        Self { law: Arc::new(law) }
    }

    fn formulas_of(law: Law) -> Self {
        Self::of(LawFile::Formulas(Box::new(law)))
    }

    fn pressed(&self, case: &asperity::Case) -> PyResult<(Vec<PathPoint>, Vec<OutOfRange>)> {
        let LawFile::Formulas(law) = self.law.as_ref() else {
            return Err(refused("press: is True, and the law has no formulas that take F_N0 and a0. Allowed: False"));
        };
        let prediction = predict(law, case, NormalSource::Press).map_err(failed)?;
        Ok((prediction.points(), prediction.out_of_range))
    }
}

/// One checked path for Python.
fn path<'py>(py: Python<'py>, checked: &CheckedPath) -> PyResult<Bound<'py, PyDict>> {
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
    answer.set_item("within", checked.within())?;
    answer.set_item("counts", checked.counts())?;
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
