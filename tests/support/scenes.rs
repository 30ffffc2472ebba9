//! From a scene's text to an estimate: the renderer under test, called as the program calls it. Every render here
//! must be free of non-finite samples and of paths that were cut because media were nested too deep.

use super::estimate::Estimate;
use pts::compile::compile_with;
use pts::diag::{Diagnostics, SourceMap};
use pts::files::DiskFiles;
use pts::import::framing;
use pts::load::{LoadOptions, load};
use pts::render::driver;
use pts::render::report::{Picture, Report, Silent};
use pts::render::scene::CompiledScene;
use pts::render::settings::{Filter, Settings};
use pts::render::technique::Technique;
use std::path::{Path, PathBuf};

/// A file of the repository.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// A scene ready to render at one size.
pub struct Ready {
    /// What the engine sees.
    pub compiled: CompiledScene,
    /// Its name, for messages.
    pub name: String,
    size: [u32; 2],
}

/// What came out.
pub struct Shot {
    /// The picture itself.
    pub picture: Picture,
    /// What the renderer says about it.
    pub report: Report,
    /// Means and variances.
    pub estimate: Estimate,
}

/// Settings of the suites: box filter, 16 nets (variances from 4 would have heavy tails), fixed seed.
pub fn settings(size: [u32; 2], spp: u32, seed: u64) -> Settings {
    Settings {
        filter: Filter::Box,
        nets: 16,
        seed,
        ..Settings::new(size[0], size[1], spp)
    }
}

/// Loads and compiles a scene file of the repository with values declared before it is read. A model is framed first.
pub fn ready(name: &str, defines: &[(&str, &str)], size: [u32; 2]) -> Ready {
    ready_for(&Technique::default(), name, defines, size)
}

/// As [`ready`], for a technique; settings must name the same.
pub fn ready_for(technique: &Technique, name: &str, defines: &[(&str, &str)], size: [u32; 2]) -> Ready {
    let (files, mut sources, mut diags) = (DiskFiles::default(), SourceMap::default(), Diagnostics::default());
    let options = LoadOptions {
        defines: defines
            .iter()
            .map(|(n, v)| ((*n).to_owned(), (*v).to_owned()))
            .collect(),
        width: Some(size[0]),
        height: Some(size[1]),
        ..LoadOptions::default()
    };
    let path = path(name);
    let mut scene = load(&path, &files, &options, &mut sources, &mut diags);
    let is_model = path.extension().is_some_and(|e| e != "pts" && e != "pov");
    if let Some(scene) = scene.as_mut().filter(|_| is_model) {
        framing::frame(scene, f64::from(size[0]) / f64::from(size[1]));
    }
    let compiled = scene.and_then(|s| compile_with(&s, &files, size[0], size[1], technique, &mut diags));
    let name = format!("{name} {defines:?}");
    let told: Vec<String> = diags.iter().map(|d| format!("{} {}", d.code, d.message)).collect();
    let compiled = compiled.unwrap_or_else(|| panic!("{name} is refused:\n{}", told.join("\n")));
    Ready { compiled, name, size }
}

impl Ready {
    /// Renders with these settings, whose size must be the scene's.
    pub fn shoot(&self, settings: &Settings) -> Shot {
        assert_eq!(
            [settings.width, settings.height],
            self.size,
            "{}: the size differs",
            self.name
        );
        let (picture, report) = driver::render(&self.compiled, settings, &Silent);
        assert!(report.anomalies.is_empty(), "{}: {:?}", self.name, report.anomalies);
        Shot {
            estimate: estimate(&picture),
            picture,
            report,
        }
    }

    /// Renders with the settings of the suites.
    pub fn estimate(&self, spp: u32, seed: u64) -> Estimate {
        self.shoot(&settings(self.size, spp, seed)).estimate
    }
}

/// Loads, compiles and renders in one go.
pub fn estimate_of(name: &str, defines: &[(&str, &str)], size: [u32; 2], spp: u32) -> Estimate {
    ready(name, defines, size).estimate(spp, 1)
}

/// A picture as statistics see it.
pub fn estimate(picture: &Picture) -> Estimate {
    let wide = |v: &[f32; 3]| v.map(f64::from);
    Estimate {
        width: picture.width as usize,
        height: picture.height as usize,
        mean: picture.rgb.iter().map(wide).collect(),
        variance: picture.stderr.iter().map(|v| wide(v).map(|s| s * s)).collect(),
    }
}

/// The picture's bits: two pictures are the same only if these are.
pub fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    picture
        .rgb
        .iter()
        .chain(&picture.stderr)
        .map(|v| v.map(f32::to_bits))
        .collect()
}
