//! `asperity explore`: a page on which a law is looked at, and the server behind it.
//!
//! `request` decides who is answered, `answer` is what goes back, `serve` the connections and their
//! threads. A page's address has all of its fields (`form`), from which comes a case; what a law
//! says of that are `curves` with their `numbers`, drawn by `charts`, and `trust` says how far it
//! goes. `simulate` holds the simulation that the page has started, `results` are those that were
//! there before, `export` (with `tar`) is what can be taken away. `page` puts the fields into the
//! text of the page, whose script draws nothing and computes nothing: it asks.

mod answer;
mod charts;
mod curves;
mod export;
mod form;
mod numbers;
mod page;
mod request;
mod results;
mod serve;
mod simulate;
mod tar;
mod trust;

use std::hash::{BuildHasher, Hasher, RandomState};
use std::sync::{Arc, Mutex, PoisonError};

use serde_json::{Value, json};

use self::answer::{HttpAnswer, HttpStatus};
use self::charts::Overlay;
use self::curves::{LawCurves, to_slip};
use self::form::Form;
use self::request::{HttpMethod, HttpRequest};
use self::results::same_contact;
use self::simulate::{PageSimulator, Stage};
use crate::case::Case;
use crate::contact_law::ContactParameters;
use crate::law::{LawError, LawFile};
use crate::output::plots::plot_slip_frame;

pub use results::{StudyCases, read_run};
pub use serve::{End, Server, Service};
pub use simulate::{Resources, SimulatedRun};

/// Contacts whose parameters are kept: a slider that goes back, and what follows one change of a
/// page (curves, exports), find theirs.
const KEPT: usize = 32;

/// The case that a page begins with where none is given.
pub const FIRST_CASE: &str = include_str!("first.toml");

/// What the page shows and does.
pub struct Explorer {
    law: LawFile,
    base: Case,
    study: StudyCases,
    /// Results that were given with the case.
    earlier: Option<SimulatedRun>,
    simulator: PageSimulator,
    place: Resources,
    contacts: Mutex<Vec<(Case, Arc<ContactParameters>)>>,
    /// Where to say that a simulation was started.
    tell: fn(&str),
}

/// What an [`Explorer`] begins with.
pub struct Beginning {
    /// The law.
    pub law: LawFile,
    /// The case of the page's fields at first.
    pub base: Case,
    /// A study whose cases lie over the law.
    pub study: StudyCases,
    /// A run that lies over the law.
    pub earlier: Option<SimulatedRun>,
    /// Where simulations compute.
    pub place: Resources,
    /// Told of what the user of the terminal should know.
    pub tell: fn(&str),
}

/// A token that nobody can guess: 128 bits of the system's own randomness, with which the standard
/// library keys its hashes, through such a hash.
pub fn token() -> String {
    let half = || {
        let mut hasher = RandomState::new().build_hasher();
        hasher.write_u32(std::process::id());
        hasher.finish()
    };
    format!("{:016x}{:016x}", half(), half())
}

impl Explorer {
    /// A page that has answered nothing yet.
    pub fn new(beginning: Beginning) -> Self {
        let Beginning { law, base, study, earlier, place, tell } = beginning;
        Self { law, base, study, earlier, simulator: PageSimulator::default(), place, contacts: Mutex::default(), tell }
    }

    /// Ends a simulation that runs; whether one did.
    pub fn end(&self) -> bool {
        self.simulator.end()
    }

    /// The simulation that the page has, its own or the one that it was opened with.
    fn run(&self) -> Option<SimulatedRun> {
        self.simulator.run().or_else(|| self.earlier.clone())
    }

    /// The parameters of the update for the contact of a case.
    fn parameters(&self, case: &Case) -> Result<Arc<ContactParameters>, LawError> {
        let held = || self.contacts.lock().unwrap_or_else(PoisonError::into_inner);
        let is_same = |other: &Case| same_contact(other, case) && other.greatest_indentation() == case.greatest_indentation();
        if let Some((_, found)) = held().iter().find(|(other, _)| is_same(other)) {
            return Ok(Arc::clone(found));
        }
        let found = Arc::new(self.law.contact_parameters(case)?);
        let mut contacts = held();
        if contacts.len() >= KEPT {
            contacts.remove(0);
        }
        contacts.push((case.clone(), Arc::clone(&found)));
        Ok(found)
    }

    fn curves(&self, case: Case) -> Result<LawCurves, LawError> {
        let parameters = self.parameters(&case)?;
        LawCurves::new(&self.law, case, &parameters)
    }

    /// The answer to the fields of a page.
    fn told(&self, form: &Form) -> Result<Value, LawError> {
        let case = match form.case(&self.base) {
            Ok(case) => case,
            Err(mistakes) => {
                let list: Vec<Value> =
                    mistakes.iter().map(|mistake| json!({ "field": mistake.field, "what": mistake.what })).collect();
                return Ok(json!({ "mistakes": list }));
            }
        };
        let doubts: Vec<String> = case.doubts().iter().map(ToString::to_string).collect();
        let view = charts::view(&case, form.get("axes"), form.get("width").parse().unwrap_or(f64::INFINITY));
        let run = self.run();
        let curves = self.curves(case)?;
        let case = &curves.case;
        let is_this = |run: &&SimulatedRun| same_contact(&run.case, case) && run.case.greatest_indentation() == curves.h;
        let shown = run.as_ref().filter(is_this);
        let study = self.study.of_contact(case);
        let of_depth = self.study.of_depth(case).map(|one| (one.id.clone(), one.history()));
        let drawn = charts::drawings(&curves, &Overlay { run: shown, study, of_depth }, &view)?;
        // What a part of a path has would be taken for the whole, and another path for the law's.
        let is_whole = |run: &&SimulatedRun| run.stage == Stage::Done && run.case.path.starts_with(&to_slip(curves.h));
        let summary = shown.filter(is_whole).and_then(|run| run.summary.as_ref());
        let warnings: Vec<String> = curves.out_of_range.iter().map(ToString::to_string).collect();
        Ok(json!({
            "mistakes": [],
            "doubts": doubts,
            "warnings": warnings,
            "regime": curves.regime(),
            "drawings": drawn.iter().map(charts::Drawing::json).collect::<Vec<_>>(),
            "numbers": numbers::rows(&curves, summary),
            "simulated": shown.is_some(),
            "other": run.is_some() && shown.is_none(),
        }))
    }

    fn export(&self, name: &str, form: &Form) -> HttpAnswer {
        let case = match form.case(&self.base) {
            Ok(case) => case,
            Err(mistakes) => {
                let list: Vec<String> = mistakes.iter().map(|mistake| format!("{}: {}\n", mistake.field, mistake.what)).collect();
                return HttpAnswer::plain(HttpStatus::Bad, &format!("The fields make no case:\n{}", list.concat()));
            }
        };
        match export::file(name, &self.law, &case, || self.curves(case.clone())) {
            Ok(Some((name, kind, body))) => HttpAnswer::file(name, kind, body),
            Ok(None) => not_found(),
            Err(error) => HttpAnswer::plain(HttpStatus::Bad, &format!("{error}\n")),
        }
    }

    /// How far the simulation is.
    fn simulation(&self) -> Value {
        let Some(run) = self.run() else { return json!({ "stage": "none" }) };
        json!({
            "stage": run.stage.word(),
            "fraction": run.fraction,
            "message": run.message,
            "steps": run.history.len(),
            "seconds": run.seconds,
            "frames": run.frames.len(),
            "query": run.query,
        })
    }

    fn simulate(&self, form: &Form, query: &str) -> HttpAnswer {
        match form.case(&self.base) {
            Err(_) => HttpAnswer::plain(HttpStatus::Bad, "The fields make no case; the page says what is wrong.\n"),
            Ok(case) => match self.simulator.start(case, query.to_owned(), self.place) {
                Ok(()) => {
                    (self.tell)("a simulation was started from the page");
                    HttpAnswer::json(&self.simulation())
                }
                Err(why) => HttpAnswer::plain(HttpStatus::Conflict, &format!("{why}\n")),
            },
        }
    }

    /// A map of the contact at one step of the simulation.
    fn frame(&self, form: &Form) -> HttpAnswer {
        let frame = form.get("frame").parse::<usize>().ok();
        let found = self.run().zip(frame).filter(|(run, frame)| *frame < run.frames.len());
        let Some((run, frame)) = found else { return not_found() };
        let view = charts::view(&run.case, form.get("axes"), form.get("width").parse().unwrap_or(f64::INFINITY));
        match plot_slip_frame(&run.frames, frame, &view) {
            Ok(picture) => HttpAnswer::json(&json!({ "svg": picture.svg, "words": picture.caption })),
            Err(error) => HttpAnswer::plain(HttpStatus::Broken, &format!("{error}\n")),
        }
    }
}

fn not_found() -> HttpAnswer {
    HttpAnswer::plain(HttpStatus::NotFound, "asperity explore: there is nothing of this name.\n")
}

impl Service for Explorer {
    fn answer(&self, request: &HttpRequest) -> HttpAnswer {
        let form = match Form::with(&self.base, &request.query) {
            Ok(form) => form,
            Err(why) => return HttpAnswer::plain(HttpStatus::Bad, &format!("asperity explore: {why}.\n")),
        };
        match (request.method, request.path.as_str()) {
            (HttpMethod::Post, "simulate") => self.simulate(&form, &request.query),
            (HttpMethod::Post, "cancel") => {
                self.simulator.cancel();
                HttpAnswer::json(&self.simulation())
            }
            (HttpMethod::Post, _) | (_, "simulate" | "cancel") => HttpAnswer::plain(
                HttpStatus::Method,
                "asperity explore: POST starts and cancels simulations, and nothing else does.\n",
            ),
            (_, "") => HttpAnswer::text("text/html; charset=utf-8", page::html(&form, &self.base, &self.study, &self.law)),
            (_, "page.css") => HttpAnswer::text("text/css; charset=utf-8", page::STYLE),
            (_, "page.js") => HttpAnswer::text("text/javascript; charset=utf-8", page::SCRIPT),
            (_, "curves") => HttpAnswer::json(
                &self.told(&form).unwrap_or_else(|error| json!({ "mistakes": [], "problem": error.to_string() })),
            ),
            (_, "simulation") => HttpAnswer::json(&self.simulation()),
            (_, "frame") => self.frame(&form),
            (_, path) => match path.strip_prefix("export/") {
                Some(name) => self.export(name, &form),
                None => not_found(),
            },
        }
    }
}
