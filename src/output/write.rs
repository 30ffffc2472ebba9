//! Files: the format by the ending, the content whole or not at all.

use super::channels::{ascii_json, exr_channels, text_metadata};
use super::develop::{AlphaUse, Develop, develop};
use super::{Layers, OutputError};
use crate::pictures::{exr, hdr, jpeg, png, ppm};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The formats we write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// 8 bits, developed.
    Png,
    /// Everything, as floats.
    Exr,
    /// Radiance with a shared exponent.
    Hdr,
    /// 8 bits, developed, lossy.
    Jpeg,
    /// 8 bits, developed, no compression.
    Ppm,
}

impl Format {
    const ENDINGS: [(&'static str, Format); 6] = [
        ("png", Format::Png),
        ("exr", Format::Exr),
        ("hdr", Format::Hdr),
        ("jpg", Format::Jpeg),
        ("jpeg", Format::Jpeg),
        ("ppm", Format::Ppm),
    ];

    /// The format that a file ending (without the dot, in any letter case) stands for.
    pub fn from_extension(extension: &str) -> Option<Format> {
        let known = |(ending, _): &&(&str, Format)| ending.eq_ignore_ascii_case(extension);
        Self::ENDINGS.iter().find(known).map(|(_, f)| *f)
    }

    /// All endings as messages list them.
    pub fn endings() -> String {
        Self::ENDINGS.map(|(e, _)| format!(".{e}")).join(" ")
    }
}

/// The format for an output path, by its ending. Asked before rendering: a wrong name should cost no time.
pub fn format_of(path: &Path) -> Result<Format, OutputError> {
    let path = path.to_owned();
    match path.extension().and_then(|e| e.to_str()) {
        None | Some("") => Err(OutputError::NoExtension { path }),
        Some(extension) => match Format::from_extension(extension) {
            Some(format) => Ok(format),
            None => Err(OutputError::UnknownFormat {
                extension: extension.to_owned(),
                path,
            }),
        },
    }
}

/// Whether a file can probably be written here: the format is known, the directory exists and the path is
/// no directory itself. Asked before rendering.
pub fn check_target(path: &Path) -> Result<Format, OutputError> {
    let format = format_of(path)?;
    check_place(path)?;
    Ok(format)
}

/// Whether a file of any kind can probably be written here: the directory exists and the path is no directory itself.
pub fn check_place(path: &Path) -> Result<(), OutputError> {
    let error = |reason: String| OutputError::Io {
        path: path.to_owned(),
        reason,
    };
    if path.is_dir() {
        return Err(error("it is a directory, expected a file name".to_owned()));
    }
    let directory = directory_of(path);
    if !directory.is_dir() {
        return Err(error(format!("there is no directory {directory:?}; create it first")));
    }
    Ok(())
}

/// The bytes of an image file.
#[derive(Clone, Debug, PartialEq)]
pub struct Encoded {
    /// The file.
    pub bytes: Vec<u8>,
    /// Pixels whose colour was not finite and is shown as black or white. Always 0 for OpenEXR, which holds them
    /// as they are.
    pub non_finite: u64,
}

/// Encodes an image. `metadata` is a JSON object: the attribute `pts` of OpenEXR files, texts `pts:key` elsewhere.
/// The same arguments give the same bytes.
pub fn encode(
    format: Format,
    layers: &Layers,
    how: &Develop,
    metadata: &serde_json::Value,
) -> Result<Encoded, OutputError> {
    layers.check()?;
    let size = [layers.width, layers.height];
    let texts = text_metadata(metadata);
    Ok(match format {
        Format::Exr => {
            let attribute = (!metadata.is_null()).then(|| ascii_json(metadata));
            let attribute = attribute.as_deref().map(|json| ("pts", json));
            let bytes = exr::encode(size, exr_channels(layers), attribute)?;
            Encoded { bytes, non_finite: 0 }
        }
        Format::Hdr => {
            let file = hdr::encode(size, &layers.rgb, &texts)?;
            Encoded {
                bytes: file.bytes,
                non_finite: file.non_finite,
            }
        }
        Format::Png => {
            let pixels = develop(layers, how, AlphaUse::Keep);
            Encoded {
                bytes: png::encode(&pixels, &texts)?,
                non_finite: pixels.non_finite,
            }
        }
        Format::Jpeg => {
            let pixels = develop(layers, how, AlphaUse::OnBlack);
            Encoded {
                bytes: jpeg::encode(&pixels, &texts)?,
                non_finite: pixels.non_finite,
            }
        }
        Format::Ppm => {
            let pixels = develop(layers, how, AlphaUse::OnBlack);
            Encoded {
                bytes: ppm::encode(&pixels, &texts),
                non_finite: pixels.non_finite,
            }
        }
    })
}

/// Writes an image in the format of the path's ending and returns how many pixels were not finite (see
/// [`Encoded::non_finite`]). Until the new file is complete, an old one of the same name stays as it is.
pub fn write(path: &Path, layers: &Layers, how: &Develop, metadata: &serde_json::Value) -> Result<u64, OutputError> {
    let encoded = encode(format_of(path)?, layers, how, metadata)?;
    write_bytes(path, &encoded.bytes)?;
    Ok(encoded.non_finite)
}

/// Puts a file in place whole: the bytes go to a temporary file of the same directory, which is then renamed.
/// Links are followed; what is no regular file (a pipe, a device) is written to directly.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_with(path, |file| file.write_all(bytes))
}

/// As [`write_bytes`], with the bytes written by `fill`.
pub(super) fn write_with(path: &Path, fill: impl Fn(&mut fs::File) -> std::io::Result<()>) -> Result<(), OutputError> {
    let result = match fs::metadata(path) {
        Ok(meta) if meta.is_dir() => Err(std::io::Error::other("it is a directory, expected a file name")),
        Ok(meta) if !meta.is_file() => fs::OpenOptions::new()
            .write(true)
            .open(path)
            .and_then(|mut f| fill(&mut f)),
        Ok(meta) => fs::canonicalize(path).and_then(|real| replace(&real, fill, Some(meta.permissions()))),
        Err(_) => replace(path, fill, None),
    };
    result.map_err(|e| OutputError::Io {
        path: path.to_owned(),
        reason: match e.kind() {
            std::io::ErrorKind::NotFound => format!("there is no directory {:?}; create it first", directory_of(path)),
            _ => e.to_string(),
        },
    })
}

fn replace(
    path: &Path,
    fill: impl Fn(&mut fs::File) -> std::io::Result<()>,
    permissions: Option<fs::Permissions>,
) -> std::io::Result<()> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".").suffix(".pts.tmp");
    #[cfg(unix)]
    {
        // Temporary files are private by default; an image gets what the user's umask says.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(directory_of(path))?;
    fill(file.as_file_mut())?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.persist(path).map(|_| ()).map_err(|e| e.error)
}

fn directory_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::{Limits, decode, read_exr_channels};
    use serde_json::json;

    fn small() -> Layers {
        let rgb: Vec<[f32; 3]> = (0..6).map(|i| [i as f32 * 0.2, 0.5, 0.9]).collect();
        Layers::from_rgb(3, 2, rgb)
    }

    #[test]
    fn every_ending_gives_a_file_that_decodes_to_the_same_size() {
        let dir = tempfile::tempdir().expect("directory");
        for ending in ["png", "exr", "hdr", "jpg", "JPEG", "ppm"] {
            let path = dir.path().join(format!("a.{ending}"));
            assert_eq!(
                write(&path, &small(), &Develop::default(), &json!({"seed": 7})).expect(ending),
                0
            );
            let bytes = fs::read(&path).expect(ending);
            let picture = decode(&bytes, ending, Limits::default()).expect(ending);
            assert_eq!((picture.width, picture.height), (3, 2), "{ending}");
        }
        assert_eq!(
            fs::read_dir(dir.path()).expect("directory").count(),
            6,
            "no temporary file is left"
        );
    }

    #[test]
    fn unknown_endings_name_the_known_ones() {
        let message = |p: &str| format_of(Path::new(p)).expect_err("unknown").to_string();
        assert!(message("a.tiff").contains("`.tiff`") && message("a.tiff").contains(".png .exr .hdr"));
        assert!(message("a").contains("no ending"));
        assert_eq!(format_of(Path::new("x/a.PNG")).expect("known"), Format::Png);
    }

    #[test]
    fn a_missing_directory_is_told_before_and_after() {
        let dir = tempfile::tempdir().expect("directory");
        let path = dir.path().join("none/a.png");
        let before = check_target(&path).expect_err("missing").to_string();
        let after = write_bytes(&path, b"x").expect_err("missing").to_string();
        assert_eq!(before, after);
        assert!(before.contains("create it first"), "{before}");
    }

    #[cfg(unix)]
    #[test]
    fn an_existing_file_keeps_its_permissions_and_its_link() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let dir = tempfile::tempdir().expect("directory");
        let (real, link) = (dir.path().join("real.ppm"), dir.path().join("link.ppm"));
        fs::write(&real, b"old").expect("writes");
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).expect("sets");
        symlink(&real, &link).expect("links");
        write_bytes(&link, b"new").expect("writes");
        assert_eq!(fs::read(&real).expect("reads"), b"new");
        assert_eq!(fs::metadata(&real).expect("there").permissions().mode() & 0o777, 0o640);
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    }

    #[test]
    fn exr_files_have_exactly_the_channels_asked_for_with_their_types() {
        let n = 6;
        let layers = Layers {
            stderr: Some(vec![[f32::NAN; 3]; n]),
            samples: Some(vec![64; n]),
            depth: Some(vec![f32::INFINITY; n]),
            normal: Some(vec![[0.0, 1.0, 0.0]; n]),
            albedo: Some(vec![[0.5; 3]; n]),
            relerr: Some(vec![0.1; n]),
            ..small()
        };
        let meta = json!({"scene": "ä.pts", "seed": 3});
        let file = encode(Format::Exr, &layers, &Develop::default(), &meta).expect("encodes");
        let image = read_exr_channels(&file.bytes, Limits::default()).expect("reads");
        let names: Vec<&str> = image.channels.iter().map(|c| c.name.as_str()).collect();
        let expected = "A B G N.X N.Y N.Z R Z albedo.B albedo.G albedo.R relerr samples stderr.B stderr.G stderr.R";
        assert_eq!(names, expected.split(' ').collect::<Vec<_>>());
        assert_eq!(image.u32_channel("samples"), Some([64; 6].as_slice()));
        assert_eq!(image.f32_channel("A"), Some([1.0; 6].as_slice()));
        assert!(image.f32_channel("stderr.G").expect("FLOAT").iter().all(|v| v.is_nan()));
        let text = image.attribute("pts").expect("attribute");
        assert_eq!(serde_json::from_str::<serde_json::Value>(text).expect("JSON"), meta);
    }

    #[test]
    fn a_buffer_of_the_wrong_length_is_an_error_in_every_format() {
        let layers = Layers {
            depth: Some(vec![1.0; 5]),
            ..small()
        };
        for (_, format) in Format::ENDINGS {
            let error = encode(format, &layers, &Develop::default(), &json!(null)).expect_err("short");
            assert!(matches!(
                error,
                OutputError::Size {
                    channel: "Z",
                    found: 5,
                    expected: 6
                }
            ));
        }
    }
}
