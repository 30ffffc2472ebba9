//! Watching a render and ending it when one likes: here after two seconds, keeping the picture so far.
//! `cargo run --release --example custom_progress` writes `custom_progress.png`.

use pts::diag::{Diagnostics, SourceMap};
use pts::files::DiskFiles;
use pts::load::{LoadOptions, load};
use pts::output::{Develop, Layers, write};
use pts::render::report::{Observer, Progress, StopReason};
use pts::render::{driver::render, settings::Settings};
use std::path::Path;
use std::time::{Duration, Instant};

struct Patience {
    begun: Instant,
}

impl Observer for Patience {
    fn progress(&self, now: &Progress) {
        let error = now
            .error
            .map_or("unknown".to_owned(), |e| format!("{:.1} %", 100.0 * e.bound));
        eprint!(
            "\r{:3.0} %, {} samples a pixel, error at most {error}   ",
            100.0 * now.fraction,
            now.spp
        );
    }

    fn should_stop(&self) -> bool {
        self.begun.elapsed() > Duration::from_secs(2)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (files, mut sources, mut diags) = (DiskFiles::default(), SourceMap::default(), Diagnostics::default());
    let path = Path::new("scenes/cornell.pts");
    let scene = load(path, &files, &LoadOptions::default(), &mut sources, &mut diags).ok_or("the scene has errors")?;
    let compiled = pts::compile::compile(&scene, &files, 320, 240, &mut diags).ok_or("it cannot be drawn")?;
    let patience = Patience { begun: Instant::now() };
    let (picture, report) = render(&compiled, &Settings::new(320, 240, 4096), &patience);
    let how = if report.stop == StopReason::Interrupted {
        "patience ran out"
    } else {
        "done"
    };
    eprintln!("\n{how} after {:.1} s", report.seconds);
    let layers = Layers::from_rgb(320, 240, picture.rgb);
    write(
        Path::new("custom_progress.png"),
        &layers,
        &Develop::default(),
        &serde_json::Value::Null,
    )?;
    Ok(())
}
