//! Malformed input of every kind through the binary: a message with a place, exit code 1, never a panic or a hang.
//! Files that only cost a part of the picture (a broken texture) may render with a warning instead.

use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Much longer than any of them takes.
const LIMIT: Duration = Duration::from_secs(20);

fn files(folder: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad").join(folder);
    let mut to_do = vec![root];
    let mut found = Vec::new();
    while let Some(dir) = to_do.pop() {
        for entry in std::fs::read_dir(dir).expect("a folder of cases").flatten() {
            match entry.path() {
                p if p.is_dir() => to_do.push(p),
                p => found.push(p),
            }
        }
    }
    found.sort();
    found
}

struct Outcome {
    code: Option<i32>,
    stderr: String,
}

/// Renders 8 × 6 pixels of a scene; `None` when it takes too long.
fn render(scene: &Path) -> Option<Outcome> {
    let out = tempfile::tempdir().expect("a scratch folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_pts"))
        .args([
            "render",
            "-r",
            "8x6",
            "--spp",
            "1",
            "--progress",
            "none",
            "-j",
            "1",
            "-o",
        ])
        .arg(out.path().join("x.png"))
        .arg(scene)
        .stdout(Stdio::null())
        .stderr(Stdio::from(
            std::fs::File::create(out.path().join("stderr")).expect("a file"),
        ))
        .spawn()
        .expect("the binary runs");
    let begun = Instant::now();
    loop {
        if let Some(status) = child.try_wait().expect("a child to wait for") {
            let stderr = std::fs::read(out.path().join("stderr")).expect("what it said");
            return Some(Outcome {
                code: status.code(),
                stderr: String::from_utf8_lossy(&stderr).into_owned(),
            });
        }
        if begun.elapsed() > LIMIT {
            child.kill().ok();
            child.wait().ok();
            return None;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Whether some line names the file; a text scene also by line and column.
fn has_place(stderr: &str, file: &Path) -> bool {
    let name = file.file_name().expect("a name").to_string_lossy().into_owned();
    let is_text = file.extension().is_some_and(|e| e == "pts" || e == "pov" || e == "inc");
    let mut after = stderr.match_indices(&name).map(|(at, _)| &stderr[at + name.len()..]);
    let line_and_column = |rest: &str| {
        let mut numbers = rest.strip_prefix(':').unwrap_or("").splitn(3, ':');
        let mut number = || {
            numbers
                .next()
                .is_some_and(|n| n.starts_with(|c: char| c.is_ascii_digit()))
        };
        number() && number()
    };
    if is_text {
        after.any(line_and_column)
    } else {
        after.next().is_some()
    }
}

fn judge(file: &Path, may_warn: bool) -> Result<(), String> {
    let Some(outcome) = render(file) else {
        return Err(format!("{}: no end within {LIMIT:?}", file.display()));
    };
    let told = outcome.stderr.contains("error[") || outcome.stderr.contains("error:");
    let warned = outcome.stderr.contains("warning");
    let fine = match outcome.code {
        Some(1) => told && has_place(&outcome.stderr, file),
        Some(0) => may_warn && warned,
        _ => false,
    };
    if fine && !outcome.stderr.contains("panicked") {
        return Ok(());
    }
    Err(format!(
        "{}: exit {:?}\n{}",
        file.display(),
        outcome.code,
        outcome.stderr
    ))
}

fn judge_all(folder: &str, endings: &[&str], at_least: usize, may_warn: bool) {
    let wanted = |p: &PathBuf| p.extension().is_some_and(|e| endings.iter().any(|w| e == *w));
    let cases: Vec<PathBuf> = files(folder).into_iter().filter(wanted).collect();
    assert!(cases.len() >= at_least, "only {} cases in {folder}", cases.len());
    let wrong: Vec<String> = cases.par_iter().filter_map(|f| judge(f, may_warn).err()).collect();
    assert!(
        wrong.is_empty(),
        "{} of {}:\n{}",
        wrong.len(),
        cases.len(),
        wrong.join("\n---\n")
    );
}

#[test]
fn malformed_scenes_are_refused_with_a_place() {
    judge_all("text", &["pts", "pov", "inc"], 25, false);
}

#[test]
fn malformed_gltf_is_refused_or_warned_about() {
    judge_all("gltf", &["gltf", "glb"], 25, true);
}

#[test]
fn malformed_obj_is_refused_or_warned_about() {
    judge_all("obj", &["obj"], 10, true);
}

/// A broken image costs the picture its texture and one warning; as an environment it is an error.
#[test]
fn malformed_images_cost_a_warning_or_are_refused() {
    let cases = files("images");
    assert!(cases.len() >= 10);
    let out = tempfile::tempdir().expect("a scratch folder");
    let scene = |i: usize, image: &Path| {
        let path = out.path().join(format!("scene{i}.pts"));
        let image = image.display().to_string();
        let text =
            format!("environment {{ image \"{image}\" }}\nsphere {{ 0, 1 }}\ncamera {{ location -5*z look_at 0 }}\n");
        std::fs::write(&path, text).expect("a scene");
        path
    };
    let scenes: Vec<(PathBuf, &PathBuf)> = cases.iter().enumerate().map(|(i, c)| (scene(i, c), c)).collect();
    let wrong: Vec<String> = scenes
        .par_iter()
        .filter_map(|(scene, image)| {
            let Some(outcome) = render(scene) else {
                return Some(format!("{}: no end within {LIMIT:?}", image.display()));
            };
            let named = has_place(&outcome.stderr, image) || has_place(&outcome.stderr, scene);
            let fine = outcome.code == Some(1) && named && !outcome.stderr.contains("panicked");
            (!fine).then(|| format!("{}: exit {:?}\n{}", image.display(), outcome.code, outcome.stderr))
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n---\n"));
}
