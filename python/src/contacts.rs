//! Contacts that follow a law.

use std::sync::{Mutex, MutexGuard, TryLockError};

use asperity::contact_law::{ContactParameters, ContactResponse, ContactState};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;

use crate::errors::{failed, refused};
use crate::memory;
use crate::process::compute;

/// The memory of contacts of one pair of materials.
#[pyclass(name = "NativeContacts", frozen)]
pub struct Contacts {
    parameters: Box<ContactParameters>,
    number: usize,
    /// Never waited for: of two threads the second is refused, and a child of `fork` that has it
    /// locked as well.
    states: Mutex<Vec<ContactState>>,
}

/// Contacts that a thread takes at a time: some hundred microseconds of work.
const CHUNK: usize = 256;
/// Bytes of the answer for a contact.
const ANSWER: usize = 13 * size_of::<f64>();

impl Contacts {
    /// So many contacts before first touch, if there is memory for them.
    pub fn room(number: usize) -> PyResult<Vec<ContactState>> {
        memory::check("number", number, memory::CONTACT)?;
        memory::filled("number", number, ContactState::default())
    }

    /// Contacts with what they remember.
    pub fn new(parameters: ContactParameters, states: Vec<ContactState>) -> Self {
        Self { parameters: Box::new(parameters), number: states.len(), states: Mutex::new(states) }
    }

    fn states(&self) -> PyResult<MutexGuard<'_, Vec<ContactState>>> {
        match self.states.try_lock() {
            Ok(states) => Ok(states),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => {
                Err(failed("state: another thread is moving these contacts. Wait for it, or give each thread a copy"))
            }
        }
    }
}

#[pymethods]
impl Contacts {
    fn __len__(&self) -> usize {
        self.number
    }

    fn copy(&self) -> PyResult<Self> {
        let states = self.states()?;
        memory::check("copy", self.number, memory::CONTACT)?;
        let mut copied = memory::reserved("copy", self.number)?;
        copied.extend_from_slice(&states);
        Ok(Self::new(self.parameters.as_ref().clone(), copied))
    }

    /// Numbers that a contact keeps.
    #[staticmethod]
    fn width() -> usize {
        memory::CONTACT / size_of::<f64>()
    }

    /// What the update knows of the pair of materials, as numbers.
    fn parameters<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.parameters.to_numbers())
    }

    /// Contacts with the parameters and the memory that others had.
    #[staticmethod]
    fn restore(parameters: PyReadonlyArray1<'_, f64>, memory: PyReadonlyArray2<'_, f64>) -> PyResult<Self> {
        let numbers: Vec<f64> = parameters.as_array().to_vec();
        let other = || failed("these contacts were pickled by a version of asperity that keeps them otherwise. Make them anew");
        let parameters = ContactParameters::from_numbers(&numbers).ok_or_else(other)?;
        let contacts = Self::new(parameters, Self::room(memory.as_array().nrows())?);
        contacts.set_array(memory).map_err(|_| other())?;
        Ok(contacts)
    }

    /// The memory as an array, a row a contact.
    fn to_array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let states = self.states()?;
        memory::check("array", self.number, memory::CONTACT)?;
        let mut numbers = memory::reserved("array", self.number * Self::width())?;
        numbers.extend(states.iter().flat_map(|state| state.to_numbers()));
        PyArray1::from_vec(py, numbers).reshape([self.number, Self::width()])
    }

    /// Puts back what `to_array` gave.
    fn set_array(&self, memory: PyReadonlyArray2<'_, f64>) -> PyResult<()> {
        let memory = memory.as_array();
        if memory.shape() != [self.number, Self::width()] {
            let (found, rows, width) = (memory.shape(), self.number, Self::width());
            return Err(refused(format!("state: has the shape {found:?}. Allowed: ({rows}, {width})")));
        }
        for (state, row) in self.states()?.iter_mut().zip(memory.rows()) {
            *state = ContactState::from_numbers(std::array::from_fn(|i| row[i]));
        }
        Ok(())
    }

    /// Turns the tangential memory of each contact into axes that are turned by an angle with that
    /// cosine and sine.
    fn rotate(&self, cosine: PyReadonlyArray1<'_, f64>, sine: PyReadonlyArray1<'_, f64>) -> PyResult<()> {
        check_length("cosine", cosine.len(), self.number)?;
        check_length("sine", sine.len(), self.number)?;
        for ((state, &c), &s) in self.states()?.iter_mut().zip(cosine.as_array()).zip(sine.as_array()) {
            state.rotate(c, s);
        }
        Ok(())
    }

    /// Moves every contact to `h` and along the plane by `delta`; forces and tangents. Where there
    /// is no memory for the answer nothing has moved.
    fn update<'py>(
        &self,
        py: Python<'py>,
        h: PyReadonlyArray1<'py, f64>,
        delta: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let number = self.number;
        check_length("h", h.len(), number)?;
        if delta.shape() != [number, 2] {
            return Err(refused(format!("delta: has the shape {:?}. Allowed: ({number}, 2)", delta.shape())));
        }
        let (h, delta) = (h.as_array(), delta.as_array());
        memory::check("update", number, ANSWER)?;
        let room = |components: usize| memory::filled("update", number * components, 0.0_f64);
        let (mut f_n, mut f_t, mut a) = (room(1)?, room(2)?, room(1)?);
        let (mut df_n_dh, mut df_n_ddelta, mut df_t_ddelta, mut df_t_dh) = (room(1)?, room(2)?, room(4)?, room(2)?);
        let mut states = self.states()?;
        let (parameters, states) = (&self.parameters, states.as_mut_slice());
        let forces = (&mut f_n[..], &mut f_t[..], &mut a[..]);
        let slopes = (&mut df_n_dh[..], &mut df_n_ddelta[..], &mut df_t_ddelta[..], &mut df_t_dh[..]);
        let work = move || {
            let ((f_n, f_t, a), (df_n_dh, df_n_ddelta, df_t_ddelta, df_t_dh)) = (forces, slopes);
            let normal = (f_n.par_iter_mut(), df_n_dh.par_iter_mut(), df_n_ddelta.par_chunks_exact_mut(2));
            let tangential = (f_t.par_chunks_exact_mut(2), df_t_ddelta.par_chunks_exact_mut(4), a.par_iter_mut());
            let normal = (normal.into_par_iter(), df_t_dh.par_chunks_exact_mut(2)).into_par_iter();
            let all = (states.par_iter_mut(), normal, tangential.into_par_iter()).into_par_iter();
            all.enumerate().with_min_len(CHUNK).for_each(|(i, (state, (normal, df_t_dh), tangential))| {
                let response = moved(parameters, state, h[i], [delta[[i, 0]], delta[[i, 1]]]);
                (*normal.0, *normal.1, *tangential.2) = (response.f_n, response.df_n_dh, response.a);
                normal.2.copy_from_slice(&response.df_n_ddelta);
                df_t_dh.copy_from_slice(&response.df_t_dh);
                tangential.0.copy_from_slice(&response.f_t);
                tangential.1.copy_from_slice(response.df_t_ddelta.as_flattened());
            });
        };
        compute(py, work)?;
        let out = PyDict::new(py);
        let flat = |numbers: Vec<f64>| PyArray1::from_vec(py, numbers);
        out.set_item("F_N", flat(f_n))?;
        out.set_item("F_T", flat(f_t).reshape([number, 2])?)?;
        out.set_item("a", flat(a))?;
        out.set_item("dF_N_dh", flat(df_n_dh))?;
        out.set_item("dF_N_ddelta", flat(df_n_ddelta).reshape([number, 2])?)?;
        out.set_item("dF_T_dh", flat(df_t_dh).reshape([number, 2])?)?;
        out.set_item("dF_T_ddelta", flat(df_t_ddelta).reshape([number, 2, 2])?)?;
        Ok(out)
    }
}

/// Moves one contact. Where numbers overflow it stays as it was, and nothing in the answer is a
/// number, as for an `h` that is not finite.
fn moved(parameters: &ContactParameters, state: &mut ContactState, h: f64, delta: [f64; 2]) -> ContactResponse {
    let (next, response) = parameters.update(state, h, delta);
    let answer = [response.f_n, response.f_t[0], response.f_t[1], response.a];
    if next.to_numbers().into_iter().chain(answer).all(f64::is_finite) {
        *state = next;
        return response;
    }
    parameters.update(state, f64::NAN, delta).1
}

fn check_length(name: &str, found: usize, wanted: usize) -> PyResult<()> {
    if found == wanted { Ok(()) } else { Err(refused(format!("{name}: has {found} numbers. Allowed: {wanted}, one a contact"))) }
}
