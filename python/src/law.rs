//! Laws, and contacts that follow them.

use std::path::PathBuf;

use asperity::law::contact::{ContactParameters, ContactState};
use asperity::law::export::{Language, law_files, law_source};
use asperity::law::predict::{NormalSource, predict};
use asperity::law::prior::{Prior, built_in};
use asperity::law::variables::Body;
use asperity::law::{Law, LawError, LawFile, fit};
use asperity::output::write_atomically;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::case::NativeCase;
use crate::errors::{failed, refused};

/// A fitted law.
#[pyclass(name = "NativeLaw", frozen)]
pub struct NativeLaw {
    law: Law,
}

/// Fits a law to the study in a directory, and writes `law.json` there.
#[pyfunction]
pub fn fit_law(py: Python<'_>, dir: PathBuf, prior: &str) -> PyResult<NativeLaw> {
    let law = py.detach(|| -> Result<Law, LawError> {
        let law = fit::fit(&dir, &Prior::from_option(prior)?)?;
        law.write(&dir.join("law.json"))?;
        Ok(law)
    });
    law.map(|law| NativeLaw { law }).map_err(failed)
}

#[pymethods]
impl NativeLaw {
    /// Reads a `law.json`.
    #[staticmethod]
    fn load(file: PathBuf) -> PyResult<Self> {
        Law::read(&file).map(|law| Self { law }).map_err(failed)
    }

    /// The law that comes with the program.
    #[staticmethod]
    fn built_in() -> PyResult<Self> {
        built_in().map(|law| Self { law }).map_err(failed)
    }

    /// Writes a `law.json`.
    fn save(&self, file: PathBuf) -> PyResult<()> {
        self.law.write(&file).map_err(failed)
    }

    /// The text of `law.json`.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.law).map_err(failed)
    }

    /// The formulas with their constants, as `law fit` prints them.
    fn formulas(&self) -> String {
        self.law.formulas()
    }

    /// delta_T, F_T, F_N of a case, and what of it lies outside of the law's range.
    fn predict<'py>(&self, py: Python<'py>, case: &NativeCase, press: bool) -> PyResult<(Bound<'py, PyDict>, Vec<String>)> {
        let source = if press { NormalSource::Press } else { NormalSource::Formulas };
        let prediction = py.detach(|| predict(&self.law, &case.case, source)).map_err(failed)?;
        let columns = PyDict::new(py);
        let column = |of: fn(&asperity::law::data::Point) -> f64| PyArray1::from_iter(py, prediction.curve.iter().map(of));
        columns.set_item("delta_T", column(|point| point.delta_t))?;
        columns.set_item("F_T", column(|point| point.f_t))?;
        columns.set_item("F_N", column(|point| point.f_n))?;
        Ok((columns, prediction.out_of_range.iter().map(ToString::to_string).collect()))
    }

    /// The law as source; for C of the material and the friction of a case.
    #[pyo3(signature = (format, case=None))]
    fn source(&self, format: &str, case: Option<&NativeCase>) -> PyResult<String> {
        law_source(&self.file(), language(format)?, case.map(|case| &case.case)).map_err(failed)
    }

    /// The law as source with its test vectors in a directory.
    #[pyo3(signature = (format, dir, case=None))]
    fn export(&self, format: &str, dir: PathBuf, case: Option<&NativeCase>) -> PyResult<Vec<PathBuf>> {
        let files = law_files(&self.file(), language(format)?, case.map(|case| &case.case)).map_err(failed)?;
        std::fs::create_dir_all(&dir)?;
        let mut written = Vec::new();
        for file in files {
            let path = dir.join(file.name);
            write_atomically(&path, |out| out.write_all(file.content.as_bytes())).map_err(failed)?;
            written.push(path);
        }
        Ok(written)
    }

    /// `number` contacts of a case's sphere, before first touch.
    fn contacts(&self, case: &NativeCase, number: usize) -> PyResult<Contacts> {
        let friction = match case.case.contact.friction {
            asperity::case::Friction::Coefficient(mu) => mu,
            asperity::case::Friction::Stick => {
                return Err(failed(
                    "the case has friction = \"stick\", and the law describes slip. Give contact.friction a number",
                ));
            }
        };
        let body = Body::from_case(&case.case).map_err(refused)?;
        let parameters = ContactParameters::new(&self.law, &body, friction).map_err(failed)?;
        Ok(Contacts { parameters: Box::new(parameters), states: vec![ContactState::default(); number] })
    }
}

impl NativeLaw {
    fn file(&self) -> LawFile {
        LawFile::Formulas(Box::new(self.law.clone()))
    }
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

    /// Turns the tangential memory of each contact into axes that are turned by an angle with that cosine and sine.
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
    let ContactState { h, h_max, approach, x, deflection } = *state;
    [h, h_max, approach, x].into_iter().chain(deflection.into_iter().flatten())
}

/// The state of a row, which is long enough.
fn of_row(row: &[f64]) -> ContactState {
    let mut state = ContactState { h: row[0], h_max: row[1], approach: row[2], x: row[3], ..ContactState::default() };
    state.deflection.iter_mut().flatten().zip(&row[4..]).for_each(|(to, from)| *to = *from);
    state
}
