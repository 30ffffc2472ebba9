//! Where pictures go: checked before rendering, written after it.

use super::Exit;
use super::args::OutputArgs;
use super::choices::{Aov, ToneMapKind, ViewName};
use super::console::Console;
use super::view;
use crate::math::color::luminance_f64;
use crate::output::{self, Develop, Format, Layers, OutputError, ToneMap, View, part};
use crate::render::pixels::Rows;
use crate::render::report::Picture;
use serde_json::Value;
use std::collections::BTreeSet;
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};

/// One place a picture goes to.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// A file, in the format of its extension.
    File(PathBuf, Format),
    /// Standard output.
    Stdout(Format),
}

impl Target {
    /// Its format.
    pub fn format(&self) -> Format {
        match self {
            Target::File(_, format) | Target::Stdout(format) => *format,
        }
    }

    /// What messages call it.
    pub fn name(&self) -> String {
        match self {
            Target::File(path, _) => path.display().to_string(),
            Target::Stdout(_) => "standard output".to_owned(),
        }
    }
}

/// Why outputs are refused before anything is rendered.
pub type Refusal = (Exit, String);

/// Where everything goes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Targets {
    /// Images.
    pub images: Vec<Target>,
    /// Part files.
    pub parts: Vec<PathBuf>,
}

/// All targets, with the default if none is named. Formats are known, directories exist and can be written to. `name`
/// makes the name of a file from the one that was given.
pub fn plan(args: &OutputArgs, scene: &Path, name: &dyn Fn(&Path) -> PathBuf) -> Result<Targets, Refusal> {
    let usage = |message: &str| Err((Exit::Usage, message.to_owned()));
    let default = [default_output(scene)];
    let paths = if args.output.is_empty() {
        &default[..]
    } else {
        &args.output
    };
    if args.format.is_some() && !paths.iter().any(|p| is_stdout(p)) {
        return usage("--format is for standard output (-o -); the format of a file follows from its extension");
    }
    if paths.iter().collect::<BTreeSet<_>>().len() < paths.len() {
        return usage("the same output is named twice");
    }
    let mut targets = Vec::new();
    let mut parts = Vec::new();
    for path in paths {
        let path = &match is_stdout(path) {
            true => path.clone(),
            false => name(path),
        };
        if part::is_part(path) {
            check_writable(path)?;
            parts.push(path.clone());
            continue;
        }
        if !is_stdout(path) {
            let format = output::format_of(path).map_err(|e| {
                let hint = "; or .ptspart for exact sums";
                (Exit::Usage, format!("{e}{hint}"))
            })?;
            check_writable(path)?;
            targets.push(Target::File(path.clone(), format));
            continue;
        }
        let Some(format) = args.format else {
            return usage("-o - needs a format: add --format png (or exr, hdr, jpg, ppm)");
        };
        if std::io::stdout().is_terminal() {
            return usage("standard output is a terminal, which cannot show an image: redirect it, as in -o - > x.png");
        }
        let format = output::format_of(&PathBuf::from(format!("stdout.{}", format.extension())));
        targets.push(Target::Stdout(format.map_err(|e| (Exit::Usage, e.to_string()))?));
    }
    if !args.aov.is_empty() && parts.is_empty() && !targets.iter().any(|t| t.format() == Format::Exr) {
        return usage("--aov needs an OpenEXR output, the only one with layers: add -o name.exr");
    }
    if args.aov.contains(&Aov::Time) && !targets.iter().any(|t| t.format() == Format::Exr) {
        return usage("--aov time needs an OpenEXR output: part files do not hold times");
    }
    if args.view.is_some() && !targets.iter().any(|t| is_display(t.format())) {
        return usage("--view is for images that show what is in them: add -o name.png (or .jpg, .ppm)");
    }
    Ok(Targets { images: targets, parts })
}

impl Targets {
    /// Whether every file is there already.
    pub fn exist(&self) -> bool {
        let is_there = |target: &Target| match target {
            Target::File(path, _) => path.exists(),
            Target::Stdout(_) => false,
        };
        self.images.iter().all(is_there) && self.parts.iter().all(|path| path.exists())
    }

    /// Whether a picture goes to standard output.
    pub fn to_stdout(&self) -> bool {
        self.images.iter().any(|target| matches!(target, Target::Stdout(_)))
    }
}

/// Whether images of this format hold what a display shows, not light.
pub fn is_display(format: Format) -> bool {
    match format {
        Format::Png | Format::Jpeg | Format::Ppm => true,
        Format::Exr | Format::Hdr => false,
    }
}

fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// `<scene>.png` in the working directory.
fn default_output(scene: &Path) -> PathBuf {
    let stem = match is_stdout(scene) {
        true => "stdin".as_ref(),
        false => scene.file_stem().unwrap_or("scene".as_ref()),
    };
    let mut name = stem.to_os_string();
    name.push(".png");
    PathBuf::from(name)
}

/// Tries what writing will do later: makes a file in the directory, and removes it.
pub fn check_writable(path: &Path) -> Result<(), Refusal> {
    let io = |e: OutputError| (Exit::Output, e.to_string());
    output::check_place(path).map_err(io)?;
    if std::fs::metadata(path).is_ok_and(|m| !m.is_file()) {
        return Ok(()); // a pipe or a device: it is written to directly, and opening it has effects
    }
    let directory = path.parent().filter(|d| !d.as_os_str().is_empty());
    let trial = tempfile::Builder::new()
        .prefix(".pts-")
        .tempfile_in(directory.unwrap_or(Path::new(".")));
    match trial {
        Ok(_) => Ok(()),
        Err(e) => Err(io(OutputError::Io {
            path: path.to_owned(),
            reason: e.to_string(),
        })),
    }
}

/// How 8-bit images are developed.
pub fn develop(args: &OutputArgs, tonemap: ToneMapKind, display_is_linear: bool) -> Develop {
    Develop {
        tonemap: match tonemap {
            ToneMapKind::None => ToneMap::None,
            ToneMapKind::Neutral => ToneMap::Neutral,
            ToneMapKind::Agx => ToneMap::Agx,
            ToneMapKind::Aces => ToneMap::Aces,
            ToneMapKind::Reinhard => ToneMap::Reinhard,
        },
        exposure_ev: args.exposure.unwrap_or(0.0),
        display_is_linear,
        dither: !args.no_dither,
    }
}

/// A picture as it is written.
pub struct Finished {
    layers: Layers,
    develop: Develop,
    view: Option<View>,
}

impl Finished {
    /// Gives the layers their names. What was computed only for a view is not written.
    pub fn new(picture: Picture, args: &OutputArgs, develop: Develop) -> Finished {
        let asked = |aov| args.aov.contains(&aov);
        let relerr = (asked(Aov::Relerr) || args.view == Some(ViewName::Error)).then(|| relative_error(&picture));
        let mut layers = Layers {
            width: picture.width,
            height: picture.height,
            rgb: picture.rgb,
            alpha: None,
            stderr: Some(picture.stderr),
            samples: Some(picture.samples),
            depth: picture.depth,
            normal: picture.normal,
            albedo: picture.albedo,
            relerr,
            time: picture.time,
            tail: picture.tail,
            half_a: picture.half_a,
            half_b: picture.half_b,
        };
        let view = args.view.and_then(|name| output::view(view::kind(name), &layers));
        layers.relerr = layers.relerr.filter(|_| asked(Aov::Relerr));
        layers.depth = layers.depth.filter(|_| asked(Aov::Depth));
        layers.normal = layers.normal.filter(|_| asked(Aov::Normal));
        layers.albedo = layers.albedo.filter(|_| asked(Aov::Albedo));
        layers.time = layers.time.filter(|_| asked(Aov::Time));
        Finished { layers, develop, view }
    }

    /// What the view shows, if there is one.
    pub fn about_view(&self) -> Option<String> {
        self.view.as_ref().map(view::about)
    }

    /// What is written in this format.
    fn of(&self, format: Format) -> (&Layers, Develop) {
        match &self.view {
            Some(view) if is_display(format) => {
                let plain = Develop {
                    dither: false,
                    ..Develop::default()
                };
                (&view.layers, plain)
            }
            _ => (&self.layers, self.develop),
        }
    }
}

/// Per pixel, the root mean square over channels of the standard error divided by √(luminance² + ε), with the
/// ε = 10⁻²·(mean luminance)² of the image error: the image error is the root mean square of this layer.
fn relative_error(picture: &Picture) -> Vec<f32> {
    let luminance = |c: &[f32; 3]| luminance_f64(c.map(f64::from));
    // Pixels outside of a region are no part of the picture.
    let sampled = || picture.rgb.iter().zip(&picture.samples).filter(|(_, n)| **n > 0);
    let mean = sampled().map(|(rgb, _)| luminance(rgb)).sum::<f64>() / sampled().count().max(1) as f64;
    let floor = 1e-2 * mean * mean;
    let pixels = picture.rgb.iter().zip(&picture.stderr);
    pixels
        .map(|(rgb, stderr)| {
            let variance = stderr.iter().map(|s| f64::from(*s).powi(2)).sum::<f64>() / 3.0;
            let scale = luminance(rgb).powi(2) + floor;
            match variance == 0.0 {
                true => 0.0, // black without error, also in a black image
                false => (variance / scale).sqrt() as f32,
            }
        })
        .collect()
}

/// Writes every target; a target that fails does not keep the others from being written.
/// `metadata` is made for the target's format. Returns the names written, and whether all were.
pub fn write_all(
    targets: &[Target],
    picture: &Finished,
    metadata: impl Fn(Format) -> Value,
    console: &Console,
) -> (Vec<String>, bool) {
    let mut written = Vec::new();
    for target in targets {
        let (layers, develop) = picture.of(target.format());
        let mut metadata = metadata(target.format());
        if let Some(about) = picture.about_view().filter(|_| is_display(target.format())) {
            metadata["view"] = Value::from(about);
        }
        match write_one(target, layers, &develop, &metadata) {
            Ok(non_finite) => {
                if non_finite > 0 {
                    let name = target.name();
                    console.warn(&format!(
                        "{name}: {non_finite} pixels are not finite and are shown as black or white"
                    ));
                }
                written.push(target.name());
            }
            Err(error) => console.error(&error.to_string()),
        }
    }
    let all = written.len() == targets.len();
    (written, all)
}

/// Writes every part file, as [`write_all`] does.
pub fn write_parts(paths: &[PathBuf], header: &Value, rows: &dyn Rows, console: &Console) -> (Vec<String>, bool) {
    let mut written = Vec::new();
    for path in paths {
        match part::write_part(path, header, rows) {
            Ok(()) => written.push(path.display().to_string()),
            Err(error) => console.error(&error.to_string()),
        }
    }
    let all = written.len() == paths.len();
    (written, all)
}

fn write_one(target: &Target, layers: &Layers, develop: &Develop, metadata: &Value) -> Result<u64, OutputError> {
    match target {
        Target::File(path, _) => output::write(path, layers, develop, metadata),
        Target::Stdout(format) => {
            let encoded = output::encode(*format, layers, develop, metadata)?;
            let mut stdout = std::io::stdout().lock();
            let sent = stdout.write_all(&encoded.bytes).and_then(|()| stdout.flush());
            sent.map_err(|e| OutputError::Io {
                path: PathBuf::from("-"),
                reason: e.to_string(),
            })?;
            Ok(encoded.non_finite)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_output_is_a_png_in_the_working_directory() {
        for (scene, expected) in [
            ("scenes/cornell.pts", "cornell.png"),
            ("/a/b/model.v2.glb", "model.v2.png"),
            ("-", "stdin.png"),
        ] {
            assert_eq!(default_output(Path::new(scene)), Path::new(expected));
        }
    }

    /// The image error is sqrt(mean of stderr² / (m² + ε)); the layer's root mean square must say the same.
    #[test]
    fn the_relative_error_layer_squares_up_to_the_image_error() {
        let picture = Picture {
            width: 2,
            height: 1,
            rgb: vec![[1.0; 3], [0.0; 3]],
            stderr: vec![[0.1, 0.1, 0.1], [0.02, 0.0, 0.0]],
            samples: vec![64; 2],
            ..Picture::default()
        };
        let layer = relative_error(&picture);
        let floor = 1e-2 * 0.25;
        let expected = ((0.01 / (1.0 + floor) + 0.0004 / 3.0 / floor) / 2.0f64).sqrt();
        let found = (layer.iter().map(|e| f64::from(*e).powi(2)).sum::<f64>() / 2.0).sqrt();
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} instead of {expected}");
    }

    #[test]
    fn pixels_outside_of_a_region_do_not_change_the_relative_error() {
        let picture = |pixels: usize| Picture {
            width: pixels as u32,
            height: 1,
            rgb: [vec![[0.5; 3]], vec![[0.0; 3]; pixels - 1]].concat(),
            stderr: [vec![[0.1; 3]], vec![[f32::NAN; 3]; pixels - 1]].concat(),
            samples: [vec![64], vec![0; pixels - 1]].concat(),
            ..Picture::default()
        };
        let [alone, among] = [1, 9].map(|pixels| relative_error(&picture(pixels)));
        assert_eq!(alone[0], among[0]);
        assert!(among[1..].iter().all(|e| e.is_nan()));
    }

    #[test]
    fn a_black_image_without_error_has_no_relative_error() {
        let picture = Picture {
            width: 1,
            height: 1,
            rgb: vec![[0.0; 3]],
            stderr: vec![[0.0; 3]],
            samples: vec![64],
            ..Picture::default()
        };
        assert_eq!(relative_error(&picture), [0.0]);
    }
}
