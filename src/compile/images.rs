//! Images that are used, decoded once.

use crate::diag::{Anomaly, Diagnostic, Diagnostics};
use crate::files::Files;
use crate::math::color::linear_from_srgb;
use crate::pictures::{self, Limits, Picture, Texels};
use crate::render::texture::ImageData;
use crate::scene::{Image, ImageId, ImageSource};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A decoded environment: width, height, linear radiance row by row from the top left.
pub type Radiance = (u32, u32, Vec<[f32; 3]>);

/// Gives the engine its images: each is decoded once, and only if something asks for it. What was decoded and is not
/// asked for by [`Images::place`] does not become the engine's.
pub struct Images<'a> {
    images: &'a [Image],
    files: &'a dyn Files,
    /// `None` for one that could not be read.
    decoded: BTreeMap<ImageId, Option<Decoded>>,
    /// Place of each used image among the engine's.
    places: BTreeMap<ImageId, u32>,
    data: Vec<ImageData>,
    /// The environment's picture.
    sky: Option<(ImageId, Picture)>,
}

/// A decoded image that the engine does not have yet, and what is known of it.
struct Decoded {
    data: Option<ImageData>,
    /// Channels that are the same everywhere, as colour or as data.
    uniform: [[Option<f32>; 4]; 2],
    bytes: u64,
    is_8_bit: bool,
}

impl<'a> Images<'a> {
    /// Nothing decoded yet.
    pub fn new(images: &'a [Image], files: &'a dyn Files) -> Images<'a> {
        Images {
            images,
            files,
            decoded: BTreeMap::new(),
            places: BTreeMap::new(),
            data: Vec::new(),
            sky: None,
        }
    }

    /// Decodes all of these side by side. What cannot be read costs one warning each.
    pub fn decode_all(&mut self, wanted: &[ImageId], diags: &mut Diagnostics) {
        let mut new: Vec<ImageId> = wanted
            .iter()
            .copied()
            .filter(|id| !self.decoded.contains_key(id))
            .collect();
        new.sort();
        new.dedup();
        let decoded: Vec<_> = new.par_iter().map(|id| self.decode_texture(*id)).collect();
        for (id, result) in new.into_iter().zip(decoded) {
            let place = match result {
                Ok((image, bad)) => {
                    self.tell_bad(id, bad, diags);
                    image
                }
                Err(d) => {
                    diags.push(d.hint("the picture is made without this image"));
                    None
                }
            };
            self.decoded.insert(id, place);
        }
    }

    /// An image with what is known of it, and the number of texels that were not finite.
    fn decode_texture(&self, id: ImageId) -> Result<(Option<Decoded>, u64), Diagnostic> {
        let mut picture = self.decode(id)?;
        let bad = zero_where(picture.texels.floats_mut(), |v| !v.is_finite());
        let uniform = picture.texels.uniform();
        let is_8_bit = matches!(picture.texels, Texels::Gray8(_) | Texels::Rgb8(_) | Texels::Rgba8(_));
        let image = ImageData::new(picture.width, picture.height, picture.texels).map(|data| {
            let known = |srgb: bool| {
                let first = data.texel(0, 0, srgb).to_array();
                std::array::from_fn(|c| uniform[c].then_some(first[c]))
            };
            Decoded {
                uniform: [known(false), known(true)],
                bytes: data.bytes(),
                is_8_bit,
                data: Some(data),
            }
        });
        Ok((image, bad))
    }

    /// The place of an image among the engine's, if it was decoded; from now on the engine has it.
    pub fn place(&mut self, id: ImageId) -> Option<u32> {
        if let Some(known) = self.places.get(&id) {
            return Some(*known);
        }
        let data = self.decoded.get_mut(&id)?.as_mut()?.data.take()?;
        self.data.push(data);
        let place = self.data.len() as u32 - 1;
        self.places.insert(id, place);
        Some(place)
    }

    /// The linear values of the channels (R, G, B, A) that are the same all over a decoded image, so that any look-up
    /// gives exactly them; `None` for channels that vary, and for images that were not decoded.
    pub fn uniform(&self, id: ImageId, srgb: bool) -> [Option<f32>; 4] {
        let known = self.decoded.get(&id).and_then(Option::as_ref);
        known.map_or([None; 4], |image| image.uniform[usize::from(srgb)])
    }

    /// Whether a decoded image, read as a normal map, leaves all normals as they are: red and green are everywhere one
    /// half. Eight bits have no half; 127 and 128 stand for it if they fill the channel.
    pub fn is_flat(&self, id: ImageId) -> bool {
        let Some(image) = self.decoded.get(&id).and_then(Option::as_ref) else {
            return false;
        };
        let is_half = |v: f32| v == 0.5 || image.is_8_bit && [127.0, 128.0].contains(&(v * 255.0).round());
        image.uniform[0][..2].iter().all(|v| v.is_some_and(is_half))
    }

    /// Whether an image was read at all, and how many bytes its texels take.
    pub fn decoded_bytes(&self, id: ImageId) -> Option<u64> {
        self.decoded.get(&id)?.as_ref().map(|image| image.bytes)
    }

    /// Mean of the linear colour of one of the engine's images.
    pub fn mean(&self, place: u32, srgb: bool) -> [f64; 3] {
        let image = &self.data[place as usize];
        let mut sum = [0.0; 3];
        for y in 0..image.height() {
            for x in 0..image.width() {
                let t = image.texel(x, y, srgb);
                sum.iter_mut()
                    .zip([t.x, t.y, t.z])
                    .for_each(|(s, v)| *s += f64::from(v));
            }
        }
        let n = f64::from(image.width()) * f64::from(image.height());
        sum.map(|s| s / n)
    }

    /// Whether an image is no light at all: no number of its colours is above 0. `None` if it cannot be read, which
    /// [`Images::radiance`] tells.
    pub fn is_black(&mut self, id: ImageId) -> Option<bool> {
        let picture = self.sky_picture(id).ok()?;
        let is_dark = |i| {
            picture
                .texels
                .rgba(i)
                .is_some_and(|[r, g, b, _]| ![r, g, b].iter().any(|v| *v > 0.0))
        };
        let black = (0..picture.texels.len()).all(is_dark);
        self.sky = Some((id, picture));
        Some(black)
    }

    /// The picture of the environment, which is not kept.
    fn sky_picture(&mut self, id: ImageId) -> Result<Picture, Diagnostic> {
        match self.sky.take() {
            Some((known, picture)) if known == id => Ok(picture),
            _ => self.decode(id),
        }
    }

    /// An image as radiance, times `strength`: floats as they are, integers decoded from sRGB. A failure is an error: without its
    /// environment the picture would not be the scene.
    pub fn radiance(&mut self, id: ImageId, strength: f64, diags: &mut Diagnostics) -> Option<Radiance> {
        match self.sky_picture(id) {
            Ok(picture) => {
                let float = picture.is_float();
                let linear = |v: f32| {
                    let v = f64::from(v);
                    (strength * if float { v } else { linear_from_srgb(v) }) as f32
                };
                let texels = (0..picture.texels.len()).filter_map(|i| picture.texels.rgba(i));
                let mut texels: Vec<_> = texels.map(|[r, g, b, _]| [r, g, b].map(linear)).collect();
                let is_no_light = |v: f32| !(v >= 0.0 && v.is_finite());
                self.tell_bad(
                    id,
                    zero_where(texels.iter_mut().map(|t| &mut t[..]), is_no_light),
                    diags,
                );
                Some((picture.width, picture.height, texels))
            }
            Err(mut d) => {
                d.severity = crate::diag::Severity::Error;
                diags.push(d);
                None
            }
        }
    }

    /// The engine's images.
    pub fn into_data(self) -> Vec<ImageData> {
        self.data
    }

    fn tell_bad(&self, id: ImageId, bad: u64, diags: &mut Diagnostics) {
        if let (1.., Some(image)) = (bad, self.images.get(id.index())) {
            let message = format!("{bad} texels are no light or not finite; they count as 0");
            let told = Diagnostic::warning("I0103", message).in_place(image.name.clone());
            diags.push(referred_to(told.counting(Anomaly::BadTexel, bad), image));
        }
    }

    fn decode(&self, id: ImageId) -> Result<Picture, Diagnostic> {
        let Some(image) = self.images.get(id.index()) else {
            return Err(Diagnostic::warning(
                "I0101",
                format!("image number {} does not exist", id.0),
            ));
        };
        let result = match &image.source {
            ImageSource::Pixels { width, height, data } => Ok(Picture {
                width: *width,
                height: *height,
                texels: Texels::RgbF32(data.to_vec()),
            }),
            ImageSource::Bytes(bytes) => pictures::decode(bytes, &image.name, Limits::default()),
            ImageSource::File(path) => match self.files.read(path) {
                Ok(bytes) => pictures::decode(&bytes, &path.to_string_lossy(), Limits::default()),
                Err(e) => Err(
                    Diagnostic::warning("I0102", format!("cannot read image \"{}\": {e}", path.display()))
                        .hint("check the name and that the file lies where the scene says"),
                ),
            },
        };
        result.map_err(|d| referred_to(d, image))
    }
}

/// Sets numbers that are `bad` to 0. Returns how many texels had one.
fn zero_where<'t>(texels: impl Iterator<Item = &'t mut [f32]>, bad: impl Fn(f32) -> bool) -> u64 {
    let mut found = 0;
    for texel in texels {
        found += u64::from(texel.iter().any(|v| bad(*v)));
        texel.iter_mut().filter(|v| bad(**v)).for_each(|v| *v = 0.0);
    }
    found
}

/// A failed image is a warning, told where it was referred to.
fn referred_to(mut d: Diagnostic, image: &Image) -> Diagnostic {
    d.severity = crate::diag::Severity::Warning;
    if d.place.is_none() || !matches!(image.place, crate::scene::Place::None) {
        d = super::at_place(d, &image.place);
    }
    d
}
