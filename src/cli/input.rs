//! Case and study files as they are given on the command line; `-` is standard input.

use std::path::Path;

use super::CliError;
use crate::bounded;
use crate::case::{Case, CaseError, Document, Value, check_room, mistakes};
use crate::memory;
use crate::quoting::STDIN;
use crate::study::{Study, StudyError};

/// A case or study file, read and not yet parsed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Its text.
    pub text: String,
    /// The name that messages give.
    pub name: String,
}

impl InputFile {
    /// Reads the file.
    ///
    /// # Errors
    /// [`CaseError::Unreadable`].
    pub fn read(file: &Path) -> Result<Self, CliError> {
        let (name, text) = if file == Path::new("-") {
            (STDIN.to_owned(), bounded::to_string(std::io::stdin().lock(), bounded::CASE))
        } else {
            (file.display().to_string(), bounded::read_to_string(file, bounded::CASE))
        };
        match text {
            Ok(text) => Ok(Self { text, name }),
            Err(source) => Err(CaseError::Unreadable { file: name, source }.into()),
        }
    }

    /// The case with these `--set` arguments.
    ///
    /// # Errors
    /// [`CliError::StudyGiven`] for a study; what is wrong with the case.
    pub fn case(&self, settings: &[String]) -> Result<Case, CliError> {
        if self.is_study() {
            return Err(CliError::StudyGiven { file: self.name.clone() });
        }
        let told = |errors| CliError::Mistakes { errors, text: self.text.clone() };
        let mut document = Document::parse(&self.text, &self.name).map_err(|error| told(vec![error]))?;
        document.set_arguments(settings)?;
        Case::from_document(&document).map_err(|first| match mistakes(&document) {
            // Never empty: the parser has just found one.
            errors if errors.is_empty() => first.into(),
            errors => told(errors),
        })
    }

    /// Refuses a case with these `--set` arguments that this machine has no memory for.
    ///
    /// # Errors
    /// What the case takes and what there is, with line and key.
    pub fn check_room(&self, case: &Case, settings: &[String]) -> Result<(), CliError> {
        let mut document = Document::parse(&self.text, &self.name)?;
        document.set_arguments(settings)?;
        let told = |error| CliError::Mistakes { errors: vec![error], text: self.text.clone() };
        check_room(case, Some(&document), &memory::room()).map_err(told)
    }

    /// The study.
    ///
    /// # Errors
    /// [`CliError::CaseGiven`] for a case; what is wrong with the study.
    pub fn study(&self) -> Result<Study, CliError> {
        let is_case = |table: &str| self.has(table);
        if !self.is_study() && ["sphere", "material", "path"].into_iter().any(is_case) {
            return Err(CliError::CaseGiven { file: self.name.clone() });
        }
        Study::parse(&self.text, &self.name).map_err(|error| match error {
            StudyError::File(error) => CliError::Mistakes { errors: vec![error], text: self.text.clone() },
            error => error.into(),
        })
    }

    /// Whether it is meant as a study. What cannot be read as TOML is not.
    pub fn is_study(&self) -> bool {
        self.document().is_some_and(|document| Study::is_study(&document))
    }

    fn document(&self) -> Option<Document> {
        Document::parse(&self.text, &self.name).ok()
    }

    fn has(&self, table: &str) -> bool {
        let document = self.document();
        document.is_some_and(|found| matches!(&found.root.value, Value::Table(root) if root.contains_key(table)))
    }
}
