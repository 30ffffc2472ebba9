//! Images that are used, decoded once.

use crate::diag::{Diagnostic, Diagnostics};
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
        let decoded: Vec<_> = new
            .par_iter()
            .map(|id| self.decode(*id).map(|p| ImageData::new(p.width, p.height, p.texels)))
            .collect();
        for (id, result) in new.into_iter().zip(decoded) {
            let place = match result {
                Ok(Some(data)) => {
                    self.data.push(data);
                    Some(self.data.len() as u32 - 1)
                }
                Ok(None) => None,
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

    /// An image as radiance: floats as they are, integers decoded from sRGB. A failure is an error: without its
    /// environment the picture would not be the scene.
    pub fn radiance(&mut self, id: ImageId, diags: &mut Diagnostics) -> Option<Radiance> {
        match self.decode(id) {
            Ok(picture) => {
                let float = picture.is_float();
                let linear = |v: f32| {
                    if float {
                        v
                    } else {
                        linear_from_srgb(f64::from(v)) as f32
                    }
                };
                let texels = (0..picture.texels.len()).filter_map(|i| picture.texels.rgba(i));
                let texels = texels.map(|[r, g, b, _]| [r, g, b].map(linear)).collect();
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

/// A failed image is a warning, told where it was referred to.
fn referred_to(mut d: Diagnostic, image: &Image) -> Diagnostic {
    d.severity = crate::diag::Severity::Warning;
    if d.place.is_none() || !matches!(image.place, crate::scene::Place::None) {
        d = super::at_place(d, &image.place);
    }
    d
}
