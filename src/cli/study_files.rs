//! The files of a study: their directory, tried before anything is measured, and their contents.

use super::args::StudyArgs;
use super::console::Console;
use super::outputs::{Refusal, check_writable};
use super::{Exit, format};
use crate::output::write_bytes;
use crate::study::experiment::{Ablation, Study};
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
fn contents(study: &Study) -> Vec<(&'static str, Content)> {
    let mut csv = String::from("axis,variant,kind,threads,spp,seed,load,compile,render,rays,e2,e2_se,flip,energy\n");
    for row in &study.rows {
        let v = &study.variants[row.variant];
        let s = row.seconds;
        csv += &format!(
            "{},{},{:?},{},{},{},{},{},{},{},{},{},{},{}\n",
            v.axis,
            v.name,
            v.kind,
            row.threads,
            row.spp,
            row.seed,
            s.load,
            s.compile,
            s.render,
            row.rays,
            row.e2,
            row.e2_se,
            row.flip,
            row.energy
        );
    }
    vec![
        ("study.csv", Ok(csv.into_bytes())),
        ("study.txt", Ok(format!("{study:#?}").into_bytes())),
    ]
}

/// What people see on the terminal.
pub fn summary(study: &Study) -> Vec<String> {
    let notes = study.notes.iter().map(|note| format!("note: {note}"));
    study.ablations.iter().map(effect_line).chain(notes).collect()
}

/// `caustics: 41 % of time, 2.3 % of energy, FLIP 0.020`.
fn effect_line(a: &Ablation) -> String {
    let signed = |share: f64| {
        let sign = if share < 0.0 { "-" } else { "" };
        format!("{sign}{}", format::percent(share.abs()))
    };
    if !a.significant {
        return format!(
            "{}: {} of time, not distinguishable from noise",
            a.effect,
            signed(a.time)
        );
    }
    format!(
        "{}: {} of time, {} of energy, FLIP {:.3}",
        a.effect,
        signed(a.time),
        signed(a.energy),
        a.flip
    )
}
