//! Image files of the suites: our EXR files into estimates and back, and a strip of pictures for a failed comparison.

use super::estimate::Estimate;
use exr::prelude::*;
use std::path::{Path, PathBuf};

/// All float channels of an EXR by name, with the picture's size.
pub struct Planes {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Channel name and values, row by row from the top left.
    pub channels: Vec<(String, Vec<f32>)>,
}

impl Planes {
    /// The values of a channel; panics with the names that exist if it is not there.
    pub fn channel(&self, name: &str) -> &[f32] {
        let found = self.channels.iter().find(|(n, _)| n == name);
        let names: Vec<&str> = self.channels.iter().map(|(n, _)| n.as_str()).collect();
        &found.unwrap_or_else(|| panic!("no channel {name} among {names:?}")).1
    }
}

/// Reads the first layer of an EXR.
pub fn read_planes(path: &Path) -> Planes {
    let image = read_first_flat_layer_from_file(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let layer = image.layer_data;
    let channels = layer.channel_data.list.iter();
    Planes {
        width: layer.size.0,
        height: layer.size.1,
        channels: channels
            .map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect()))
            .collect(),
    }
}

/// Reads `R G B` and, as standard errors, `stderr.R …` or one plane `stderr` for all channels.
pub fn read_estimate(path: &Path) -> Estimate {
    let planes = read_planes(path);
    let rgb = ["R", "G", "B"].map(|c| planes.channel(c));
    let shared = planes.channels.iter().any(|(n, _)| n == "stderr");
    let names = ["stderr.R", "stderr.G", "stderr.B"];
    let errors = names.map(|n| planes.channel(if shared { "stderr" } else { n }));
    let pixels = 0..planes.width * planes.height;
    Estimate {
        width: planes.width,
        height: planes.height,
        mean: pixels
            .clone()
            .map(|i| [0, 1, 2].map(|c| f64::from(rgb[c][i])))
            .collect(),
        variance: pixels
            .map(|i| [0, 1, 2].map(|c| f64::from(errors[c][i]).powi(2)))
            .collect(),
    }
}

/// Writes floats: `R G B` and one `stderr` plane (root mean square over the channels). A 32×32 file stays
/// below 20 KiB; halves would round plain backgrounds, which have no noise to hide it.
pub fn write_estimate(path: &Path, estimate: &Estimate) {
    let plane = |name: &str, f: &dyn Fn(usize) -> f64| {
        let values: Vec<f32> = (0..estimate.mean.len()).map(|i| f(i) as f32).collect();
        AnyChannel::new(name, FlatSamples::F32(values))
    };
    let mut channels: Vec<_> = ["R", "G", "B"]
        .iter()
        .enumerate()
        .map(|(c, name)| plane(name, &|i| estimate.mean[i][c]))
        .collect();
    channels.push(plane("stderr", &|i| {
        (estimate.variance[i].iter().sum::<f64>() / 3.0).sqrt()
    }));
    let layer = Layer::new(
        (estimate.width, estimate.height),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.into()),
    );
    let written = Image::from_layer(layer).write().to_file(path);
    written.unwrap_or_else(|e| panic!("{}: {e}", path.display()));
}

/// Writes `expected | found | difference × 4 about grey` as a PNG into the build folder and returns its path.
pub fn write_strip(name: &str, expected: &Estimate, found: &Estimate) -> PathBuf {
    let (w, h) = (expected.width as u32, expected.height as u32);
    let encode = |v: f64| (255.0 * v.clamp(0.0, 1.0).powf(1.0 / 2.2)).round() as u8;
    let picture = image::RgbImage::from_fn(3 * w, h, |x, y| {
        let i = (y * w + x % w) as usize;
        let (a, b) = (expected.mean[i], found.mean[i]);
        image::Rgb([0, 1, 2].map(|c| match x / w {
            0 => encode(a[c]),
            1 => encode(b[c]),
            _ => (127.5 + 255.0 * 4.0 * (b[c] - a[c])).clamp(0.0, 255.0) as u8,
        }))
    });
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("failed");
    std::fs::create_dir_all(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let path = folder.join(format!("{name}.png"));
    picture
        .save(&path)
        .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    path
}
