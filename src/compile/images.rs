//! Images that are used, decoded once.

use crate::diag::{Anomaly, Diagnostic, Diagnostics};
use crate::files::Files;
use crate::math::color::linear_from_srgb;
use crate::pictures::{self, Cost, Limits, Picture, Texels};
use crate::render::texture::ImageData;
use crate::scene::{Image, ImageId, ImageSource};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

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
    /// Bytes of the textures decoded so far, and of their files.
    decoded_bytes: u64,
    encoded_bytes: u64,
}

/// Bytes that the textures of any scene may take, and how many more for each byte of their files. Packed pictures of
/// one colour reach a thousandfold; what artists make stays far below (a smooth JPEG about fiftyfold).
const TEXTURE_BYTES: (u64, u64) = (768 << 20, 64);

/// A texture's file in memory, on the way to being decoded.
struct Encoded<'a> {
    id: ImageId,
    image: &'a Image,
    name: Cow<'a, str>,
    bytes: Arc<[u8]>,
    cost: Cost,
    /// Why it is not the preferred file.
    warning: Option<Diagnostic>,
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
            decoded_bytes: 0,
            encoded_bytes: 0,
        }
    }

    /// Decodes all of these side by side, as many at a time as the bound on their memory allows. What cannot be read costs one warning each.
    pub fn decode_all(&mut self, wanted: &[ImageId], diags: &mut Diagnostics) {
        let mut new: Vec<ImageId> = wanted
            .iter()
            .copied()
            .filter(|id| !self.decoded.contains_key(id))
            .collect();
        new.sort();
        new.dedup();
        let encoded: Vec<_> = new.par_iter().map(|id| (*id, self.encoded(*id))).collect();
        let mut to_do = Vec::new();
        for (id, result) in encoded {
            match result.and_then(|file| self.admit(file)) {
                Ok(file) => to_do.push(file),
                Err(d) => self.fail(id, d, diags),
            }
        }
        while !to_do.is_empty() {
            let mut peak = 0u64;
            let fits = to_do.iter().take_while(|file| {
                peak = peak.saturating_add(file.cost.peak);
                peak <= self.most_bytes()
            });
            let now = fits.count().max(1);
            let batch: Vec<Encoded> = to_do.drain(..now).collect();
            let decoded: Vec<_> = batch
                .into_par_iter()
                .map(|file| (file.id, self.decode_texture(file)))
                .collect();
            for (id, result) in decoded {
                match result {
                    Ok((image, bad, warning)) => {
                        self.tell_bad(id, bad, diags);
                        warning.into_iter().for_each(|d| diags.push(d));
                        self.decoded.insert(id, image);
                    }
                    Err(d) => self.fail(id, d, diags),
                }
            }
        }
    }

    fn fail(&mut self, id: ImageId, d: Diagnostic, diags: &mut Diagnostics) {
        diags.push(d.hint("the picture is made without this image"));
        self.decoded.insert(id, None);
    }

    /// Bytes that the textures may take, by the bytes of their files so far.
    fn most_bytes(&self) -> u64 {
        TEXTURE_BYTES
            .0
            .saturating_add(self.encoded_bytes.saturating_mul(TEXTURE_BYTES.1))
    }

    /// Counts a file among those to be decoded, if their memory is in proportion to their files.
    fn admit<'f>(&mut self, file: Encoded<'f>) -> Result<Encoded<'f>, Diagnostic> {
        self.encoded_bytes += file.bytes.len() as u64;
        let (most, all) = (self.most_bytes(), self.decoded_bytes.saturating_add(file.cost.result));
        if all.max(file.cost.peak) > most {
            let message = format!(
                "the image takes {} MiB to decode; with it the images would take more than {} MiB, \
                 out of proportion to their files of {} MiB",
                file.cost.peak >> 20,
                most >> 20,
                self.encoded_bytes >> 20
            );
            let d = Diagnostic::warning("I0104", message).in_place(file.name.to_string());
            return Err(referred_to(d.hint("scale it down"), file.image));
        }
        self.decoded_bytes = all;
        Ok(file)
    }

    /// The file of a texture: the preferred one, unless its header cannot be read and there is another.
    fn encoded(&self, id: ImageId) -> Result<Encoded<'a>, Diagnostic> {
        let image = self.image(id)?;
        let of = |source| {
            let (name, bytes) = self.file(image, source)?;
            // What has a broken header costs nothing; decoding tells what is wrong with it.
            let cost = pictures::cost(&bytes, &name, Limits::default());
            Ok((name, bytes, cost))
        };
        let first: Result<_, Diagnostic> = of(&image.source);
        let is_sound = matches!(&first, Ok((_, _, Some(_)))) || matches!(image.source, ImageSource::Pixels { .. });
        let (found, warning) = match (&image.fallback, first) {
            (Some(fallback), first) if !is_sound => {
                let why = first.and_then(|(name, bytes, _)| decode_file(image, &name, &bytes).map(|_| ()));
                (of(fallback)?, why.err().map(|d| d.hint(INSTEAD)))
            }
            (_, first) => (first?, None),
        };
        let (name, bytes, cost) = found;
        Ok(Encoded {
            id,
            image,
            name,
            bytes,
            cost: cost.unwrap_or(Cost { result: 0, peak: 0 }),
            warning,
        })
    }

    /// An image with what is known of it, the number of texels that were not finite, and what was wrong with it.
    fn decode_texture(&self, file: Encoded) -> Result<(Option<Decoded>, u64, Option<Diagnostic>), Diagnostic> {
        let mut warning = file.warning;
        let mut picture = match &file.image.source {
            ImageSource::Pixels { .. } => self.decode(file.id)?,
            _ => match (decode_file(file.image, &file.name, &file.bytes), &file.image.fallback) {
                (Err(d), Some(fallback)) if warning.is_none() => {
                    let (name, bytes) = self.file(file.image, fallback)?;
                    warning = Some(d.hint(INSTEAD));
                    decode_file(file.image, &name, &bytes)?
                }
                (result, _) => result?,
            },
        };
        let bad = zero_where(picture.texels.floats_mut(), |v| !v.is_finite());
        let uniform = picture.texels.uniform();
        let is_8_bit = matches!(picture.texels, Texels::Gray8(_) | Texels::Rgb8(_) | Texels::Rgba8(_));
        let bytes = picture.texels.len() as u64 * picture.texels.bytes_per_texel() as u64;
        if uniform == [true; 4] {
            // Any look-up gives the one colour, whatever the size.
            picture.texels.truncate(1);
            (picture.width, picture.height) = (1, 1);
        }
        let image = ImageData::new(picture.width, picture.height, picture.texels).map(|data| {
            let known = |srgb: bool| {
                let first = data.texel(0, 0, srgb).to_array();
                std::array::from_fn(|c| uniform[c].then_some(first[c]))
            };
            Decoded {
                uniform: [known(false), known(true)],
                bytes,
                is_8_bit,
                data: Some(data),
            }
        });
        Ok((image, bad, warning))
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

    fn image(&self, id: ImageId) -> Result<&'a Image, Diagnostic> {
        let missing = || Diagnostic::warning("I0101", format!("image number {} does not exist", id.0));
        self.images.get(id.index()).ok_or_else(missing)
    }

    fn decode(&self, id: ImageId) -> Result<Picture, Diagnostic> {
        let image = self.image(id)?;
        if let ImageSource::Pixels { width, height, data } = &image.source {
            return Ok(Picture {
                width: *width,
                height: *height,
                texels: Texels::RgbF32(data.to_vec()),
            });
        }
        let (name, bytes) = self.file(image, &image.source)?;
        decode_file(image, &name, &bytes)
    }

    /// The encoded bytes of an image, with the name that messages give them; none of one made by the program.
    fn file(&self, image: &'a Image, source: &'a ImageSource) -> Result<(Cow<'a, str>, Arc<[u8]>), Diagnostic> {
        match source {
            ImageSource::Pixels { .. } => Ok((image.name.as_str().into(), Arc::new([]))),
            ImageSource::Bytes(bytes) => Ok((image.name.as_str().into(), bytes.clone())),
            ImageSource::File(path) => match self.files.read(path) {
                Ok(bytes) => Ok((path.to_string_lossy(), bytes)),
                Err(e) => {
                    let message = format!("cannot read image \"{}\": {e}", path.display());
                    let d = Diagnostic::warning("I0102", message);
                    let hint = "check the name and that the file lies where the scene says";
                    Err(referred_to(d.hint(hint), image))
                }
            },
        }
    }
}

const INSTEAD: &str = "the model has the image in another format as well; that is used instead";

fn decode_file(image: &Image, name: &str, bytes: &[u8]) -> Result<Picture, Diagnostic> {
    pictures::decode(bytes, name, Limits::default()).map_err(|d| referred_to(d, image))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::MemoryFiles;

    const KTX2: &[u8] = include_bytes!("../../tests/pictures/ramp-rgb-uastc.ktx2");

    fn png() -> Vec<u8> {
        let mut out = std::io::Cursor::new(Vec::new());
        let picture = image::RgbImage::from_fn(3, 2, |x, y| image::Rgb([x as u8, y as u8, 9]));
        picture.write_to(&mut out, image::ImageFormat::Png).unwrap();
        out.into_inner()
    }

    fn image(source: &[u8], fallback: Option<&[u8]>) -> Image {
        Image {
            name: "skin".to_owned(),
            source: ImageSource::Bytes(source.into()),
            fallback: fallback.map(|b| ImageSource::Bytes(b.into())),
            place: crate::scene::Place::Model("a.gltf: images[0]".to_owned()),
        }
    }

    /// Columns of the picture that the engine gets, and the diagnostics.
    fn decoded(image: Image) -> (Option<u32>, Diagnostics) {
        let (images, files, mut diags) = ([image], MemoryFiles::default(), Diagnostics::default());
        let mut decoder = Images::new(&images, &files);
        decoder.decode_all(&[ImageId(0)], &mut diags);
        let place = decoder.place(ImageId(0));
        let data = decoder.into_data();
        (place.map(|p| data[p as usize].width()), diags)
    }

    #[test]
    fn the_fallback_serves_where_the_preferred_file_is_broken() {
        let png = png();
        let (width, diags) = decoded(image(KTX2, Some(&png)));
        assert_eq!((width, diags.iter().count()), (Some(18), 0));
        let cut_body = &KTX2[..KTX2.len() - 100];
        let cut_header = &KTX2[..30];
        for broken in [cut_body, cut_header, b"RIFF not WebP"] {
            let (width, diags) = decoded(image(broken, Some(&png)));
            assert_eq!((width, diags.iter().count()), (Some(3), 1), "{diags:?}");
            assert!(!diags.has_errors());
            assert_eq!(decoded(image(broken, None)).0, None);
        }
    }

    #[test]
    fn a_picture_of_one_colour_takes_one_texel() {
        let mut out = std::io::Cursor::new(Vec::new());
        let flat = image::RgbImage::from_pixel(64, 64, image::Rgb([1, 2, 3]));
        flat.write_to(&mut out, image::ImageFormat::Png).unwrap();
        assert_eq!(decoded(image(&out.into_inner(), None)).0, Some(1));
    }

    #[test]
    fn pictures_out_of_proportion_to_their_files_are_left_out() {
        let (images, files) = ([image(KTX2, None)], MemoryFiles::default());
        let mut decoder = Images::new(&images, &files);
        let file = |result, peak, bytes: usize| Encoded {
            id: ImageId(0),
            image: &images[0],
            name: "skin".into(),
            bytes: vec![0; bytes].into(),
            cost: Cost { result, peak },
            warning: None,
        };
        let (base, each) = TEXTURE_BYTES;
        assert!(
            decoder.admit(file(base, base, 10)).is_ok(),
            "any scene may have that much"
        );
        let refused = decoder.admit(file(each * 20 + 1, 0, 10)).err().unwrap();
        assert_eq!(refused.code, "I0104");
        assert!(
            decoder.admit(file(each * 20, each * 20, 0)).is_ok(),
            "what the files allow"
        );
        assert!(
            decoder.admit(file(0, base + each * 20 + 1, 0)).is_err(),
            "while it is decoded, too"
        );
    }
}
