//! Images that are used, decoded once.

use crate::diag::{Anomaly, Diagnostic, Diagnostics};
use crate::files::Files;
use crate::math::color::linear_from_srgb;
use crate::pictures::{self, Limits, Picture, Texels};
use crate::render::texture::ImageData;
use crate::scene::{Image, ImageId, ImageSource, Scene};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A decoded environment: width, height, linear radiance row by row from the top left.
pub type Radiance = (u32, u32, Vec<[f32; 3]>);

/// Gives the engine its images: each is decoded once, and only if something asks for it.
pub struct Images<'a> {
    scene: &'a Scene,
    files: &'a dyn Files,
    /// Place of each used image among the engine's; `None` for one that could not be read.
    places: BTreeMap<ImageId, Option<u32>>,
    data: Vec<ImageData>,
}

impl<'a> Images<'a> {
    /// Nothing decoded yet.
    pub fn new(scene: &'a Scene, files: &'a dyn Files) -> Images<'a> {
        Images {
            scene,
            files,
            places: BTreeMap::new(),
            data: Vec::new(),
        }
    }

    /// Decodes all of these side by side. What cannot be read costs one warning each.
    pub fn decode_all(&mut self, wanted: &[ImageId], diags: &mut Diagnostics) {
        let mut new: Vec<ImageId> = wanted
            .iter()
            .copied()
            .filter(|id| !self.places.contains_key(id))
            .collect();
        new.sort();
        new.dedup();
        let decoded: Vec<_> = new.par_iter().map(|id| self.decode(*id)).collect();
        for (id, result) in new.into_iter().zip(decoded) {
            let place = match result {
                Ok(mut picture) => {
                    let numbers = picture.texels.floats_mut();
                    self.tell_bad(id, zero_where(numbers, |v| !v.is_finite()), diags);
                    ImageData::new(picture.width, picture.height, picture.texels).map(|data| {
                        self.data.push(data);
                        self.data.len() as u32 - 1
                    })
                }
                Err(d) => {
                    diags.push(d.hint("the picture is made without this image"));
                    None
                }
            };
            self.places.insert(id, place);
        }
    }

    /// The place of an image among the engine's, if it was decoded.
    pub fn place(&self, id: ImageId) -> Option<u32> {
        self.places.get(&id).copied().flatten()
    }

    /// Mean of the linear colour of a decoded image.
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

    /// An image as radiance, times `strength`: floats as they are, integers decoded from sRGB. A failure is an error: without its
    /// environment the picture would not be the scene.
    pub fn radiance(&mut self, id: ImageId, strength: f64, diags: &mut Diagnostics) -> Option<Radiance> {
        match self.decode(id) {
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
        if let (1.., Some(image)) = (bad, self.scene.images.get(id.index())) {
            let message = format!("{bad} texels are no light or not finite; they count as 0");
            let told = Diagnostic::warning("I0103", message).in_place(image.name.clone());
            diags.push(referred_to(told.counting(Anomaly::BadTexel, bad), image));
        }
    }

    fn decode(&self, id: ImageId) -> Result<Picture, Diagnostic> {
        let Some(image) = self.scene.images.get(id.index()) else {
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
