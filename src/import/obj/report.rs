//! Diagnostics with `file:line`, a few of each kind.

use crate::diag::{Diagnostic, Diagnostics, Severity};
use std::collections::BTreeMap;

/// A model of a million bad lines is as well described by its first few.
const SHOWN_PER_CODE: u64 = 5;

/// Collects diagnostics of one model file and of the files it names.
pub(super) struct Report {
    file: String,
    diags: Diagnostics,
    counts: BTreeMap<&'static str, (u64, Severity)>,
    has_errors: bool,
}

impl Report {
    /// A report about the model called `file`.
    pub fn new(file: String) -> Report {
        Report {
            file,
            diags: Diagnostics::default(),
            counts: BTreeMap::new(),
            has_errors: false,
        }
    }

    /// `model.obj:17`.
    pub fn place(&self, line: u32) -> String {
        format!("{}:{line}", self.file)
    }

    /// Reports something about a line of the model.
    pub fn push(&mut self, line: u32, diagnostic: Diagnostic) {
        let place = self.place(line);
        self.push_at(place, diagnostic);
    }

    /// Reports something about another place.
    pub fn push_at(&mut self, place: String, diagnostic: Diagnostic) {
        self.has_errors |= diagnostic.severity == Severity::Error;
        let (count, _) = self.counts.entry(diagnostic.code).or_insert((0, diagnostic.severity));
        *count += 1;
        if *count <= SHOWN_PER_CODE {
            self.diags.push(diagnostic.in_place(place));
        } else if let Some((kind, n)) = diagnostic.counts {
            self.diags.count_anomaly(kind, n);
        }
    }

    /// Whether an error was reported.
    pub fn has_errors(&self) -> bool {
        self.has_errors
    }

    /// All diagnostics, with a line for each kind that was cut short.
    pub fn finish(mut self) -> Diagnostics {
        for (code, (count, severity)) in self.counts {
            if count > SHOWN_PER_CODE {
                let more = count - SHOWN_PER_CODE;
                let message = format!("{more} more of the same kind ({code}) in this model");
                self.diags
                    .push(Diagnostic::new(severity, code, message).in_place(self.file.clone()));
            }
        }
        self.diags
    }
}
