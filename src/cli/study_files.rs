//! The files of a study: their directory, tried before anything is measured, and their contents.

use super::Exit;
use super::args::StudyArgs;
use super::console::Console;
use super::outputs::{Refusal, check_writable};
use crate::output::write_bytes;
use crate::study::experiment::Study;
use crate::study::recommend::recommend;
use crate::study::{chart, table};
use std::path::{Path, PathBuf};

/// Where the files go.
pub struct Place {
    directory: PathBuf,
    /// Whether it was made for this study.
    is_new: bool,
}

impl Place {
    /// Makes the directory if it is not there, and tries whether files can be written to it.
    pub fn prepare(args: &StudyArgs) -> Result<Place, Refusal> {
        let directory = args.output.clone().unwrap_or_else(|| default_directory(&args.scene));
        let is_new = !directory.exists();
        let refuse = |reason: String| {
            (
                Exit::Output,
                format!("cannot write to {}: {reason}", directory.display()),
            )
        };
        std::fs::create_dir_all(&directory).map_err(|e| refuse(e.to_string()))?;
        check_writable(&directory.join("study.csv"))?;
        Ok(Place { directory, is_new })
    }

    /// Removes the directory again if it was made for nothing.
    pub fn abandon(&self) {
        if self.is_new {
            // It stays where somebody has put something into it meanwhile.
            let _ = std::fs::remove_dir(&self.directory);
        }
    }

    /// Writes all files and returns their names. What can be written is, also when another file cannot.
    pub fn write(&self, study: &Study, console: &Console) -> Result<Vec<String>, Refusal> {
        let mut written = Vec::new();
        let mut failed = None;
        for (name, content) in contents(study) {
            let path = self.directory.join(name);
            let result = content.and_then(|bytes| write_bytes(&path, &bytes).map_err(|e| e.to_string()));
            match result {
                Ok(()) => written.push(path.display().to_string()),
                Err(reason) => {
                    console.error(&reason);
                    failed = Some((Exit::Output, String::new()));
                }
            }
        }
        failed.map_or(Ok(written), Err)
    }
}

/// `<scene>-study` in the working directory.
fn default_directory(scene: &Path) -> PathBuf {
    let stem = match scene == Path::new("-") {
        true => "stdin".as_ref(),
        false => scene.file_stem().unwrap_or("scene".as_ref()),
    };
    let mut name = stem.to_os_string();
    name.push("-study");
    PathBuf::from(name)
}

type Content = Result<Vec<u8>, String>;

/// Names and contents, the most readable first.
fn contents(study: &Study) -> [(&'static str, Content); 5] {
    let png = chart::png(study).map_err(|e| format!("the chart cannot be drawn: {e}"));
    [
        ("study.md", Ok(table::markdown(study).into_bytes())),
        ("study.svg", Ok(chart::svg(study).into_bytes())),
        ("study.png", png),
        ("study.csv", Ok(table::csv(study).into_bytes())),
        ("study.json", Ok(format!("{:#}\n", table::json(study)).into_bytes())),
    ]
}

/// What people see on the terminal: what effects cost, what was left out, and what is recommended.
pub fn summary(study: &Study) -> Vec<String> {
    let notes = study.notes.iter().map(|note| format!("note: {note}"));
    let effects = study.ablations.iter().map(table::effect);
    let advice = std::iter::once(recommend(study).text);
    effects.chain(notes).chain(advice).collect()
}
