//! stub
use std::path::{Path, PathBuf};
/// stub
#[derive(Clone, Debug, Default, PartialEq)]
#[allow(missing_docs)]
pub struct Layers {
    pub width: u32,
    pub height: u32,
    pub rgb: Vec<[f32; 3]>,
    pub alpha: Option<Vec<f32>>,
    pub stderr: Option<Vec<[f32; 3]>>,
    pub samples: Option<Vec<u32>>,
    pub depth: Option<Vec<f32>>,
    pub normal: Option<Vec<[f32; 3]>>,
    pub albedo: Option<Vec<[f32; 3]>>,
    pub relerr: Option<Vec<f32>>,
    pub time: Option<Vec<f32>>,
}
/// stub
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Develop {
    pub tonemap: ToneMap,
    pub exposure_ev: f64,
    pub display_is_linear: bool,
    pub dither: bool,
}
/// stub
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum ToneMap {
    None,
    Neutral,
    Agx,
    Aces,
    Reinhard,
}
/// stub
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Format {
    Png,
    Exr,
    Hdr,
    Jpeg,
    Ppm,
}
/// stub
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum OutputError {
    #[error("output {path:?} ends in `.{extension}`, expected one of .png .exr .hdr .jpg .ppm")]
    UnknownFormat { path: PathBuf, extension: String },
    #[error("output {path:?} has no ending that tells the format")]
    NoExtension { path: PathBuf },
    #[error("cannot write {path:?}: {reason}")]
    Io { path: PathBuf, reason: String },
}
/// stub
#[allow(missing_docs)]
pub struct Encoded {
    pub bytes: Vec<u8>,
    pub non_finite: u64,
}
/// stub
pub fn format_of(path: &Path) -> Result<Format, OutputError> {
    let path = path.to_owned();
    Ok(match path.extension().and_then(|e| e.to_str()) {
        None | Some("") => return Err(OutputError::NoExtension { path }),
        Some("png") => Format::Png,
        Some("exr") => Format::Exr,
        Some("hdr") => Format::Hdr,
        Some("jpg") => Format::Jpeg,
        Some("ppm") => Format::Ppm,
        Some(other) => {
            let extension = other.to_owned();
            return Err(OutputError::UnknownFormat { path, extension });
        }
    })
}
/// stub
pub fn check_target(path: &Path) -> Result<Format, OutputError> {
    let format = format_of(path)?;
    let error = |reason: String| OutputError::Io {
        path: path.to_owned(),
        reason,
    };
    if path.is_dir() {
        return Err(error("it is a directory, expected a file name".to_owned()));
    }
    let dir = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if !dir.is_dir() {
        return Err(error(format!("there is no directory {dir:?}; create it first")));
    }
    Ok(format)
}
/// stub
pub fn encode(_: Format, layers: &Layers, _: &Develop, _: &serde_json::Value) -> Result<Encoded, OutputError> {
    let mut bytes = Vec::new();
    let mut e = png::Encoder::new(&mut bytes, layers.width, layers.height);
    e.set_color(png::ColorType::Grayscale);
    let data = vec![128; layers.rgb.len()];
    let done = e.write_header().and_then(|mut w| w.write_image_data(&data));
    done.map_err(|e| OutputError::Io {
        path: PathBuf::new(),
        reason: e.to_string(),
    })?;
    Ok(Encoded { bytes, non_finite: 0 })
}
/// stub
pub fn write(path: &Path, layers: &Layers, how: &Develop, metadata: &serde_json::Value) -> Result<u64, OutputError> {
    let encoded = encode(format_of(path)?, layers, how, metadata)?;
    std::fs::write(path, encoded.bytes).map_err(|e| OutputError::Io {
        path: path.to_owned(),
        reason: e.to_string(),
    })?;
    Ok(0)
}
