//! Texture references: image, sampler, coordinate set and transform become one texture of the scene. Images are
//! found, not decoded.

use super::Loader;
use super::budget::Cost;
use super::document::{extension, index_of};
use super::extension::{FINITE, Fields};
use super::uri::Resolved;
use crate::diag::Diagnostic;
use crate::scene::{Encoding, Image, ImageId, ImageSource, ImageTexture, TexelFilter, Texture, TextureId, Wrap};
use glam::{DAffine2, DMat2, DVec2};
use gltf::json;
use json::texture::{MagFilter, WrappingMode};
use json::validation::Checked;
use serde_json::Value;
use std::sync::Arc;

/// What makes two references the same texture.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Key {
    texture: usize,
    uv_set: u32,
    transform: [u64; 6],
    is_color: bool,
}

/// Extensions whose image is taken before the texture's plain one, the first of them first.
const READ: [&str; 2] = ["KHR_texture_basisu", "EXT_texture_webp"];
/// Extensions for formats that are not read.
const NOT_READ: [&str; 2] = ["EXT_texture_avif", "MSFT_texture_dds"];

/// Most coordinate sets that a mesh of the scene carries.
pub(super) const MAX_UV_SETS: u32 = 4;

impl Loader<'_> {
    /// The texture of a `textureInfo`. `None` if there is none or it cannot be used; then the factor stands alone,
    /// and whatever was wrong has been warned of: a broken texture never costs the model.
    pub(super) fn texture(&mut self, info: Option<&Value>, encoding: Encoding, at: &str) -> Option<TextureId> {
        let info = info?;
        let before = std::mem::replace(&mut self.report.lenient, true);
        let texture = self.read_texture(info, encoding, at);
        self.report.lenient = before;
        texture
    }

    fn read_texture(&mut self, info: &Value, encoding: Encoding, at: &str) -> Option<TextureId> {
        let Some(texture) = index_of(info, "index", at, &mut self.report) else {
            if info.get("index").is_none() {
                self.report.error("G0701", at, "has no `index` of a texture");
            }
            return None;
        };
        let transform = Fields::of_or_empty(info, "KHR_texture_transform", at);
        let report = &mut self.report;
        let offset = transform.numbers("offset", [0.0; 2], FINITE, report);
        let rotation = transform.number("rotation", 0.0, FINITE, report);
        let scale = transform.numbers("scale", [1.0; 2], FINITE, report);
        let own_set = index_of(info, "texCoord", at, report).unwrap_or(0);
        let uv_set = match transform.member("texCoord") {
            Some(set) => set.as_u64().map_or(own_set, |s| s as usize),
            None => own_set,
        };
        if uv_set >= MAX_UV_SETS as usize {
            let message = format!("uses TEXCOORD_{uv_set}; only the sets 0 to 3 are read, the texture is left out");
            self.report.warning("G0702", at, message);
            return None;
        }
        let uv_transform = uv_transform(offset, rotation, scale);
        let key = Key {
            texture,
            uv_set: uv_set as u32,
            transform: uv_transform.to_cols_array().map(f64::to_bits),
            is_color: encoding == Encoding::Srgb,
        };
        if let Some(known) = self.textures.get(&key) {
            return *known;
        }
        let made = self.make_texture(texture, uv_set as u32, uv_transform, encoding, at);
        self.textures.insert(key, made);
        made
    }

    fn make_texture(
        &mut self,
        index: usize,
        uv_set: u32,
        uv_transform: DAffine2,
        encoding: Encoding,
        at: &str,
    ) -> Option<TextureId> {
        let raw = self
            .doc
            .raw("textures", index, &format!("{at}.index"), &mut self.report)?;
        let here = format!("textures[{index}]");
        let image = self.texture_image(raw, &here)?;
        let sampler = match index_of(raw, "sampler", &here, &mut self.report) {
            Some(i) => self.doc.get(i, &format!("{here}.sampler"), &mut self.report)?,
            None => json::texture::Sampler::default(),
        };
        let wrap = |mode: Checked<WrappingMode>| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
        };
        let nearest = matches!(sampler.mag_filter, Some(Checked::Valid(MagFilter::Nearest)));
        let odd = [sampler.wrap_s, sampler.wrap_t].contains(&Checked::Invalid);
        if odd || matches!(sampler.mag_filter, Some(Checked::Invalid)) {
            let message = "its sampler has a filter or wrap mode that glTF does not know; the default is used";
            self.report.warning("G0703", &here, message);
        }
        Some(self.scene.add_texture(Texture::Image(ImageTexture {
            image,
            uv_set,
            uv_transform,
            wrap_u: wrap(sampler.wrap_s),
            wrap_v: wrap(sampler.wrap_t),
            filter: if nearest {
                TexelFilter::Nearest
            } else {
                TexelFilter::Bilinear
            },
            encoding,
        })))
    }

    /// The image of a texture: its alternative in a better format that we read, else its plain source. That serves
    /// also where the alternative cannot be read.
    fn texture_image(&mut self, texture: &Value, at: &str) -> Option<ImageId> {
        let source = |name: &str| extension(texture, name).filter(|e| e.get("source").is_some());
        let plain = index_of(texture, "source", at, &mut self.report);
        for name in READ {
            let Some(better) = source(name) else { continue };
            let at_better = format!("{at}.extensions.{name}");
            let Some(index) = index_of(better, "source", &at_better, &mut self.report) else {
                continue;
            };
            let fallback = plain.map(|index| (index, format!("{at}.source")));
            return self.image((index, format!("{at_better}.source")), fallback);
        }
        if let Some(index) = plain {
            return self.image((index, format!("{at}.source")), None);
        }
        if texture.get("source").is_some() {
            return None; // which was no index
        }
        let message = match NOT_READ.iter().find(|name| source(name).is_some()) {
            Some(name) => format!("has only a {name} image, which cannot be read; the factor is used alone"),
            None => "has no source image; the factor is used alone".to_owned(),
        };
        let d = Diagnostic::warning("G0704", message);
        self.report
            .push(at, d.hint("export the textures as PNG, JPEG, WebP or KTX2"));
        None
    }

    /// An image with its fallback, both given by number and the place that refers to them.
    fn image(&mut self, (index, at): (usize, String), fallback: Option<(usize, String)>) -> Option<ImageId> {
        let key = (index, fallback.as_ref().map(|f| f.0));
        if let Some(known) = self.images.get(&key) {
            return *known;
        }
        // With a fallback, what is wrong with the first choice is no error.
        let first = self.find_image(index, &at);
        let second = fallback.and_then(|(index, at)| self.find_image(index, &at));
        let made = match (first, second) {
            (Some(mut image), second) => {
                image.fallback = second.map(|i| i.source);
                Some(image)
            }
            (None, second) => second,
        };
        let made = made.map(|image| self.scene.add_image(image));
        self.images.insert(key, made);
        made
    }

    /// The bytes of an image in a view.
    fn viewed_image(&mut self, view: usize, at: &str) -> Option<Arc<[u8]>> {
        if let Some(known) = self.viewed_images.get(&view) {
            return Some(known.clone());
        }
        let bytes = self.view(view, at)?.bytes;
        self.afford(Cost::Images, bytes.len() as u64, at)?;
        let bytes: Arc<[u8]> = Arc::from(&bytes[..]);
        self.viewed_images.insert(view, bytes.clone());
        Some(bytes)
    }

    /// The image `index`, found but not decoded.
    fn find_image(&mut self, index: usize, at: &str) -> Option<Image> {
        let raw = self.doc.raw("images", index, at, &mut self.report)?;
        let here = format!("images[{index}]");
        let source = match raw.get("uri") {
            Some(Value::String(uri)) => match self.resolve(uri, &format!("{here}.uri"))? {
                Resolved::Data(data) => ImageSource::Bytes(data.into()),
                Resolved::File(path) => ImageSource::File(path),
                Resolved::Missing(mut why) => {
                    why.severity = crate::diag::Severity::Warning;
                    why.message += "; the colour or factor is used alone";
                    self.report.push(&format!("{here}.uri"), why);
                    return None;
                }
            },
            Some(other) => {
                self.report.error(
                    "G0203",
                    &format!("{here}.uri"),
                    format!("is {other}, expected a string"),
                );
                return None;
            }
            None => {
                let Some(view) = index_of(raw, "bufferView", &here, &mut self.report) else {
                    self.report
                        .warning("G0705", &here, "has neither `uri` nor `bufferView`; it is left out");
                    return None;
                };
                ImageSource::Bytes(self.viewed_image(view, &format!("{here}.bufferView"))?)
            }
        };
        // Messages about the picture itself are clearest with its file name.
        let name = match (&source, raw.get("name").and_then(Value::as_str)) {
            (ImageSource::File(path), _) => path.display().to_string(),
            (_, Some(name)) if !name.is_empty() => name.to_owned(),
            _ => self.report.place(&here),
        };
        Some(Image {
            name,
            source,
            fallback: None,
            place: self.report.origin(&here),
        })
    }
}

/// uv' = T·R·S·uv of `KHR_texture_transform`: the rotation is counter-clockwise as seen with v pointing down.
fn uv_transform(offset: [f64; 2], rotation: f64, scale: [f64; 2]) -> DAffine2 {
    let (sin, cos) = rotation.sin_cos();
    let rotation = DMat2::from_cols(DVec2::new(cos, -sin), DVec2::new(sin, cos));
    let scale = DMat2::from_diagonal(DVec2::from_array(scale));
    DAffine2::from_mat2_translation(rotation * scale, DVec2::from_array(offset))
}
