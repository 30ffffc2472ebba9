//! MTL texture statements to images and textures of the scene.

use super::find_file;
use super::mtl::Map;
use super::report::Report;
use crate::diag::Diagnostic;
use crate::files::Files;
use crate::pictures::{Limits, Picture, cost, decode};
use crate::scene::{
    Encoding, Image, ImageId, ImageSource, ImageTexture, Place, Scene, TexelFilter, Texture, TextureId, Wrap,
};
use glam::{DAffine2, DMat2, DVec2};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::PathBuf;

/// Adds textures to a scene, each image file once.
pub(super) struct Textures<'a> {
    files: &'a dyn Files,
    images: HashMap<PathBuf, ImageId>,
    /// What pictures look like, as far as that was asked.
    seen: RefCell<HashMap<PathBuf, Glance>>,
}

/// Most bytes of a picture that is decoded only to tell what it is.
const GLANCE: u64 = 1 << 28;

impl<'a> Textures<'a> {
    /// Textures read through `files`.
    pub fn new(files: &'a dyn Files) -> Textures<'a> {
        Textures {
            files,
            images: HashMap::new(),
            seen: RefCell::default(),
        }
    }

    /// The file of a map; reported and `None` if there is none.
    pub fn locate(&self, map: &Map, report: &mut Report) -> Option<PathBuf> {
        let found = find_file(self.files, &map.directory, &map.file);
        if found.is_none() {
            let message = format!("texture {:?} is missing; the constant value is used", map.file);
            let hint = "put the image beside the .mtl file, or correct the path there";
            report.push_at(map.place.clone(), Diagnostic::warning("O0209", message).hint(hint));
        }
        found
    }

    /// A texture of the scene for this map.
    pub fn add(&mut self, map: &Map, encoding: Encoding, scene: &mut Scene, report: &mut Report) -> Option<TextureId> {
        let path = self.locate(map, report)?;
        let image = *self.images.entry(path).or_insert_with_key(|path| {
            scene.add_image(Image {
                name: path.display().to_string(),
                source: ImageSource::File(path.clone()),
                fallback: None,
                place: Place::Model(map.place.clone()),
            })
        });
        let wrap = if map.clamp { Wrap::Clamp } else { Wrap::Repeat };
        Some(scene.add_texture(Texture::Image(ImageTexture {
            image,
            uv_set: 0,
            uv_transform: uv_transform(map),
            wrap_u: wrap,
            wrap_v: wrap,
            filter: TexelFilter::Bilinear,
            encoding,
        })))
    }

    /// Whether a `bump` map is a normal map in truth, as many programs write it: told by its name, else by its
    /// colours (a normal map is mostly straight up, which is light blue).
    pub fn is_normal_map(&self, map: &Map, report: &mut Report) -> bool {
        let name = map.file.to_ascii_lowercase();
        if ["normal", "nrm", "_nor.", "_n.", "-n.", "_norm", "ddn", "_nm."]
            .iter()
            .any(|s| name.contains(s))
        {
            return true;
        }
        if ["height", "bump", "disp"].iter().any(|s| name.contains(s)) {
            return false;
        }
        let Some(path) = self.locate(map, report) else {
            return false;
        };
        self.glance(path, &map.file).is_light_blue
    }

    /// What a picture looks like, decoded once. What cannot be decoded is reported where it is used.
    fn glance(&self, path: PathBuf, name: &str) -> Glance {
        if let Some(known) = self.seen.borrow().get(&path) {
            return *known;
        }
        let limits = Limits::default();
        let picture = self.files.read(&path).ok().and_then(|bytes| {
            let cost = cost(&bytes, name, limits).filter(|c| c.peak <= GLANCE);
            cost.and_then(|_| decode(&bytes, name, limits).ok())
        });
        let found = picture.as_ref().map_or(Glance::default(), Glance::of);
        self.seen.borrow_mut().insert(path, found);
        found
    }

    /// Whether an image has an alpha channel that is not the same everywhere.
    pub fn has_alpha(&self, map: &Map, report: &mut Report) -> bool {
        let path = self.locate(map, report);
        path.is_some_and(|path| self.glance(path, &map.file).has_alpha)
    }
}

/// What a picture looks like.
#[derive(Clone, Copy, Default)]
struct Glance {
    /// Mostly straight up, as normals are.
    is_light_blue: bool,
    /// Its alpha is not the same everywhere.
    has_alpha: bool,
}

impl Glance {
    fn of(picture: &Picture) -> Glance {
        let count = picture.texels.len();
        let step = (count / 4096).max(1);
        let (mut sum, mut n) = ([0.0_f32; 4], 0.0_f32);
        for texel in (0..count).step_by(step).filter_map(|i| picture.texels.rgba(i)) {
            sum.iter_mut().zip(texel).for_each(|(s, t)| *s += t);
            n += 1.0;
        }
        let [r, g, b, _] = sum.map(|s| s / n);
        Glance {
            is_light_blue: (r - 0.5).abs() < 0.15 && (g - 0.5).abs() < 0.15 && b > 0.75,
            has_alpha: !picture.texels.uniform()[3],
        }
    }
}

/// `-s` and `-o` act on coordinates from the bottom left: (u, v) ↦ (u·s + o, v·s + o). With v turned
/// (v' = 1 − v) that is v' ↦ v'·s + (1 − s − o).
fn uv_transform(map: &Map) -> DAffine2 {
    let ([su, sv], [ou, ov]) = (map.scale, map.offset);
    DAffine2::from_mat2_translation(DMat2::from_diagonal(DVec2::new(su, sv)), DVec2::new(ou, 1.0 - sv - ov))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_and_offset_agree_with_the_bottom_left_convention() {
        let map = Map {
            file: String::new(),
            scale: [2.0, 3.0],
            offset: [0.25, 0.5],
            clamp: false,
            bump: 1.0,
            channel: None,
            gain: 1.0,
            base: 0.0,
            place: String::new(),
            directory: PathBuf::new(),
        };
        for (u, v) in [(0.0, 0.0), (0.3, 0.7), (1.0, 1.0)] {
            let found = uv_transform(&map).transform_point2(DVec2::new(u, 1.0 - v));
            let expected = DVec2::new(u * 2.0 + 0.25, 1.0 - (v * 3.0 + 0.5));
            assert!((found - expected).length() < 1e-12, "{found} for {expected}");
        }
    }
}
