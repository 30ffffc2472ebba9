//! The buffers of a finished image and their names in OpenEXR files.

use super::OutputError;
use crate::pictures::exr::{ChannelData, NamedChannel};

/// A finished image. All buffers are row by row from the top left and hold `width · height` values; what is
/// `None` was not asked for and is not written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear Rec. 709 radiance; where there is alpha, already multiplied by it.
    pub rgb: Vec<[f32; 3]>,
    /// Coverage in [0, 1]; `None` is 1 everywhere.
    pub alpha: Option<Vec<f32>>,
    /// Standard error of the pixel mean (`stderr.R`, …); NaN where it is not known.
    pub stderr: Option<Vec<[f32; 3]>>,
    /// Samples taken (`samples`, UINT).
    pub samples: Option<Vec<u32>>,
    /// Distance along the view axis (`Z`).
    pub depth: Option<Vec<f32>>,
    /// Mean shading normal in world axes, facing the camera (`N.X`, `N.Y`, `N.Z`).
    pub normal: Option<Vec<[f32; 3]>>,
    /// Mean albedo of the first surface (`albedo.R`, …).
    pub albedo: Option<Vec<[f32; 3]>>,
    /// Relative standard error (`relerr`); NaN where the standard error is not known.
    pub relerr: Option<Vec<f32>>,
    /// Nanoseconds of wall clock per sample (`time`); NaN where it is not known.
    pub time: Option<Vec<f32>>,
    /// Share of the pixel's light that its brightest net has (`tail`), from 1/nets to 1; NaN where it is not known.
    pub tail: Option<Vec<f32>>,
    /// Mean of the even nets (`halfA.R`, …).
    pub half_a: Option<Vec<[f32; 3]>>,
    /// Mean of the odd nets (`halfB.R`, …).
    pub half_b: Option<Vec<[f32; 3]>>,
}

impl Layers {
    /// An image of colour alone.
    pub fn from_rgb(width: u32, height: u32, rgb: Vec<[f32; 3]>) -> Layers {
        Layers {
            width,
            height,
            rgb,
            ..Layers::default()
        }
    }

    /// `width · height`.
    pub fn pixels(&self) -> usize {
        self.width as usize * self.height as usize
    }

    /// Whether every buffer has one value per pixel.
    pub(super) fn check(&self) -> Result<(), OutputError> {
        let expected = self.pixels();
        let lengths = [
            ("rgb", Some(self.rgb.len())),
            ("A", self.alpha.as_ref().map(Vec::len)),
            ("stderr", self.stderr.as_ref().map(Vec::len)),
            ("samples", self.samples.as_ref().map(Vec::len)),
            ("Z", self.depth.as_ref().map(Vec::len)),
            ("N", self.normal.as_ref().map(Vec::len)),
            ("albedo", self.albedo.as_ref().map(Vec::len)),
            ("relerr", self.relerr.as_ref().map(Vec::len)),
            ("time", self.time.as_ref().map(Vec::len)),
            ("tail", self.tail.as_ref().map(Vec::len)),
            ("halfA", self.half_a.as_ref().map(Vec::len)),
            ("halfB", self.half_b.as_ref().map(Vec::len)),
        ];
        for (channel, found) in lengths {
            if let Some(found) = found.filter(|&n| n != expected) {
                return Err(OutputError::Size {
                    channel,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }
}

/// The channels of the OpenEXR file, values untouched. `R G B A` are always there.
pub(super) fn exr_channels(layers: &Layers) -> Vec<NamedChannel> {
    let mut list = Vec::new();
    let mut scalar = |name: &str, values: Vec<f32>| {
        let data = ChannelData::F32(values);
        list.push(NamedChannel {
            name: name.to_owned(),
            data,
        });
    };
    let component = |values: &[[f32; 3]], i: usize| values.iter().map(|v| v[i]).collect::<Vec<f32>>();
    for (i, letter) in ["R", "G", "B"].into_iter().enumerate() {
        scalar(letter, component(&layers.rgb, i));
        for (name, values) in [
            ("stderr", &layers.stderr),
            ("albedo", &layers.albedo),
            ("halfA", &layers.half_a),
            ("halfB", &layers.half_b),
        ] {
            if let Some(values) = values {
                scalar(&format!("{name}.{letter}"), component(values, i));
            }
        }
    }
    if let Some(normal) = &layers.normal {
        for (i, letter) in ["X", "Y", "Z"].into_iter().enumerate() {
            scalar(&format!("N.{letter}"), component(normal, i));
        }
    }
    scalar("A", layers.alpha.clone().unwrap_or_else(|| vec![1.0; layers.pixels()]));
    for (name, values) in [
        ("Z", &layers.depth),
        ("relerr", &layers.relerr),
        ("time", &layers.time),
        ("tail", &layers.tail),
    ] {
        if let Some(values) = values {
            scalar(name, values.clone());
        }
    }
    if let Some(samples) = &layers.samples {
        list.push(NamedChannel {
            name: "samples".to_owned(),
            data: ChannelData::U32(samples.clone()),
        });
    }
    list
}

/// JSON in ASCII: the text of an OpenEXR attribute has no encoding of its own.
pub(super) fn ascii_json(value: &serde_json::Value) -> String {
    let mut out = String::new();
    for c in value.to_string().chars() {
        if c.is_ascii() {
            out.push(c);
        } else {
            // JSON escapes are UTF-16 units; outside of strings JSON is ASCII.
            let mut units = [0; 2];
            out.extend(c.encode_utf16(&mut units).iter().map(|u| format!("\\u{u:04x}")));
        }
    }
    out
}

/// The metadata as keys and texts for formats that have only those: `Software` first, then `pts:key` for every
/// member of the object.
pub(super) fn text_metadata(value: &serde_json::Value) -> Vec<(String, String)> {
    let mut list = vec![(
        "Software".to_owned(),
        concat!("pts ", env!("CARGO_PKG_VERSION")).to_owned(),
    )];
    let text = |v: &serde_json::Value| v.as_str().map_or_else(|| v.to_string(), str::to_owned);
    match value {
        serde_json::Value::Null => {}
        serde_json::Value::Object(members) => {
            list.extend(members.iter().map(|(k, v)| (format!("pts:{k}"), text(v))));
        }
        other => list.push(("pts".to_owned(), text(other))),
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_in_ascii_reads_back_as_the_same_value() {
        let value = serde_json::json!({"scene": "Zürich 🏔 \"q\"", "seed": 1, "ok": [true, null, 0.1]});
        let text = ascii_json(&value);
        assert!(text.is_ascii());
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).expect("valid"), value);
    }
}
