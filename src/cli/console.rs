//! What is told while a command runs: text or JSON lines on standard error, never on standard output.

use super::args::TerminalArgs;
use super::choices::{ColorKind, ProgressKind};
use super::diagnostics;
use crate::diag::{Diagnostics, Severity, SourceMap};
use anstream::{AutoStream, ColorChoice};
use serde_json::{Value, json};
use std::io::{IsTerminal, Write};

/// Standard error with what the user wants to see of it. Failing writes (a closed pipe) are ignored:
/// nobody listens, and the picture matters more.
#[derive(Clone, Copy, Debug)]
pub struct Console {
    color: ColorChoice,
    quiet: u8,
    verbose: u8,
    progress: ProgressKind,
    /// The frame that is rendered, and the last one.
    frame: Option<[u32; 2]>,
}

impl Console {
    /// The console for these flags; `progress` is resolved so that `auto` never remains.
    pub fn new(args: &TerminalArgs, progress: Option<ProgressKind>) -> Console {
        let color = match args.color {
            Some(ColorKind::Always) => ColorChoice::Always,
            Some(ColorKind::Never) => ColorChoice::Never,
            Some(ColorKind::Auto) | None => ColorChoice::Auto,
        };
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let interactive = std::io::stderr().is_terminal() && !dumb;
        let progress = match progress.unwrap_or(ProgressKind::Auto) {
            ProgressKind::Json => ProgressKind::Json,
            _ if args.quiet > 0 => ProgressKind::None,
            ProgressKind::Auto if interactive => ProgressKind::Bar,
            ProgressKind::Auto => ProgressKind::Plain,
            // A bar rewrites its line, which only a terminal can do.
            ProgressKind::Bar if !interactive => ProgressKind::Plain,
            chosen => chosen,
        };
        Console {
            color,
            quiet: args.quiet,
            verbose: args.verbose,
            progress,
            frame: None,
        }
    }

    /// The console for one frame of an animation that ends with `last`: progress and events tell which.
    pub fn for_frame(self, number: u32, last: u32) -> Console {
        Console {
            frame: Some([number, last]),
            ..self
        }
    }

    /// `frame 3/120  ` before what is told of its progress; nothing for a still.
    pub fn frame_prefix(&self) -> String {
        match self.frame {
            Some([number, last]) => format!("frame {number}/{last}  "),
            None => String::new(),
        }
    }

    /// How progress is shown; never `Auto`.
    pub fn progress(&self) -> ProgressKind {
        self.progress
    }

    /// Whether everything is told as JSON.
    pub fn is_json(&self) -> bool {
        self.progress == ProgressKind::Json
    }

    /// Whether colours and other terminal codes are wanted.
    pub fn is_colored(&self) -> bool {
        let resolved = match self.color {
            ColorChoice::Auto => AutoStream::choice(&std::io::stderr()),
            chosen => chosen,
        };
        resolved != ColorChoice::Never
    }

    /// Whether only warnings and errors are told as text, or less.
    pub fn is_quiet(&self) -> bool {
        self.quiet > 0 && !self.is_json()
    }

    /// Writes one line (or several); terminal codes in it are removed where they are not wanted.
    pub fn line(&self, text: &str) {
        let mut stream = AutoStream::new(std::io::stderr().lock(), self.color);
        let _ = writeln!(stream, "{text}");
    }

    /// Tells something worth knowing, unless `-q`. In JSON mode the events speak for themselves.
    pub fn say(&self, text: &str) {
        if self.quiet == 0 && !self.is_json() {
            self.line(text);
        }
    }

    /// Tells a detail, with `-v`.
    pub fn detail(&self, text: &str) {
        if self.verbose > 0 && !self.is_json() {
            self.line(text);
        }
    }

    /// Tells something that is wrong but did not stop the work, unless `-qq`.
    pub fn warn(&self, message: &str) {
        if self.is_json() {
            self.event(&json!({"event": "diagnostic", "severity": "warning", "message": message}));
        } else if self.quiet < 2 {
            self.line(&format!("\x1b[1;33mwarning\x1b[0m\x1b[1m: {message}\x1b[0m"));
        }
    }

    /// Tells why there is no picture.
    pub fn error(&self, message: &str) {
        if self.is_json() {
            self.event(&json!({"event": "diagnostic", "severity": "error", "message": message}));
        } else {
            self.line(&format!("\x1b[1;31merror\x1b[0m\x1b[1m: {message}\x1b[0m"));
        }
    }

    /// One JSON object on a line of its own; of an animation it tells the frame.
    pub fn event(&self, event: &Value) {
        if let (Some([number, _]), Some(fields)) = (self.frame, event.as_object()) {
            let mut fields = fields.clone();
            fields.insert("frame".to_owned(), number.into());
            let _ = writeln!(std::io::stderr().lock(), "{}", Value::Object(fields));
            return;
        }
        let _ = writeln!(std::io::stderr().lock(), "{event}");
    }

    /// Tells what the front ends and the compiler found, as far as it is wanted.
    pub fn diagnostics(&self, found: &Diagnostics, sources: &SourceMap) {
        let least = match self.quiet {
            0 => Severity::Note,
            1 => Severity::Warning,
            _ => Severity::Error,
        };
        if self.is_json() {
            for d in found.iter().filter(|d| d.severity >= least) {
                let mut event = json!({"event": "diagnostic"});
                if let (Some(event), Value::Object(fields)) = (event.as_object_mut(), diagnostics::to_json(d, sources))
                {
                    event.extend(fields);
                }
                self.event(&event);
            }
            return;
        }
        let text = diagnostics::to_text(found, sources, least);
        if !text.is_empty() {
            self.line(text.trim_end());
        }
    }
}
