//! Work on pictures one after the other, where a bad one does not end the work on the rest.

use std::path::{Path, PathBuf};

use serde::Serialize;
use upglow_image::Interpretation;
use upglow_terminal::{Console, Failure, Report};

use crate::output::{Lines, failed};

/// What became of the pictures of a command. It is the one document of `--json`.
#[derive(Debug, Serialize)]
pub(crate) struct Batch<R> {
    /// What the command does with a picture, in the past tense.
    #[serde(skip)]
    verb: &'static str,
    #[serde(skip)]
    total: usize,
    pictures: Vec<R>,
    /// Pictures that an earlier run has already done.
    unchanged: Vec<String>,
    failed: Vec<FailedPicture>,
    /// What the given folders hold beside pictures.
    left_out: Vec<String>,
    /// What was written about all pictures together.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    documents: Vec<String>,
}

/// What is reported of a picture.
pub(crate) trait Interpreted {
    /// How its numbers were understood.
    fn interpretation(&self) -> &Interpretation;
    /// The picture.
    fn picture(&self) -> &str;
}

#[derive(Debug, Serialize)]
struct FailedPicture {
    file: String,
    error: String,
}

impl<R: Report + Interpreted> Batch<R> {
    /// No picture of `total`; the given folders hold these others.
    pub(crate) fn new(verb: &'static str, total: usize, left_out: &[PathBuf]) -> Self {
        let left_out = left_out.iter().map(|path| path.display().to_string()).collect();
        Self {
            verb,
            total,
            pictures: Vec::new(),
            unchanged: Vec::new(),
            failed: Vec::new(),
            left_out,
            documents: Vec::new(),
        }
    }

    /// Adds a picture that is done; as text it is printed at once.
    pub(crate) fn add(&mut self, console: &Console, report: R) -> Result<(), Failure> {
        if !console.json {
            console.print(&report)?;
        }
        self.pictures.push(report);
        Ok(())
    }

    /// Adds a picture that an earlier run has already done.
    pub(crate) fn add_unchanged(&mut self, input: &Path) {
        self.unchanged.push(input.display().to_string());
    }

    /// Adds files that were written about all pictures together.
    pub(crate) fn add_documents(&mut self, files: Vec<String>) {
        self.documents.extend(files);
    }

    /// Adds a picture that could not be done, and names it.
    ///
    /// # Errors
    ///
    /// The failure itself, if it is not that of a picture: work then ends.
    pub(crate) fn add_failure(&mut self, input: &Path, failure: Failure) -> Result<(), Failure> {
        let Failure::Input(error) = failure else { return Err(failure) };
        if self.total > 1 {
            failed(&error);
        }
        self.failed.push(FailedPicture { file: input.display().to_string(), error });
        Ok(())
    }

    /// Prints the summary, or the document. Work that `ended` early is reported as that.
    ///
    /// # Errors
    ///
    /// [`Failure`] if a picture could not be done, or work ended early.
    pub(crate) fn finish(
        self,
        console: &Console,
        ended: Result<(), Failure>,
    ) -> Result<(), Failure> {
        let has_summary = self.total > 1
            || !self.unchanged.is_empty()
            || !self.left_out.is_empty()
            || !self.documents.is_empty();
        if console.json || has_summary {
            console.print(&self)?;
        }
        ended?;
        match &self.failed[..] {
            [] => Ok(()),
            [only] if self.total == 1 => Err(Failure::Input(only.error.clone())),
            failed => {
                let (count, total, verb) = (failed.len(), self.total, self.verb);
                let message = format!("{count} of {total} pictures were not {verb}, named above");
                Err(Failure::Input(message + ", expected none"))
            }
        }
    }
}

impl<R: Report + Interpreted> Report for Batch<R> {
    fn text(&self) -> String {
        /// Most names that are listed; `--json` lists all.
        const NAMES: usize = 12;
        let Self { verb, pictures, unchanged, failed, left_out, documents, .. } = self;
        let mut counts = vec![format!("{} {verb}", pictures.len())];
        if !unchanged.is_empty() {
            counts.push(format!("{} unchanged", unchanged.len()));
        }
        if !failed.is_empty() {
            counts.push(format!("{} failed", failed.len()));
        }
        let mut lines = Lines::default();
        lines.add("pictures", counts.join(", "));
        let mut list = |label: &str, what: &str, names: &[&str]| {
            let count = names.len();
            if count > 0 {
                let more = if count > NAMES { ", …" } else { "" };
                let names = names[..count.min(NAMES)].join(", ");
                lines.add(label, format_args!("{count} {what}: {names}{more}"));
            }
        };
        let overruled = pictures.iter().filter(|report| report.interpretation().is_overruled());
        let mut overruled: Vec<&str> = overruled.map(Interpreted::picture).collect();
        // One picture under several lights has several reports.
        overruled.dedup();
        list("overruled", "whose files state another space or encoding than declared", &overruled);
        let left_out: Vec<&str> = left_out.iter().map(String::as_str).collect();
        list("left out", "that are no pictures", &left_out);
        for document in documents {
            lines.add("document", document);
        }
        lines.to_string()
    }
}
