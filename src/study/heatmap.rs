//! Differences as pictures: one colour a pixel, on scales that do not depend on the images, so that two heat maps
//! can be compared.

use super::blocks::{self, NoiseTest};
use super::metrics::{CompareError, Options, Pair, linear, relative_square};
use super::{Image, flip};
use crate::math::color::linear_from_srgb;
use crate::pictures::colormap::{UNKNOWN, magma};

/// What a heat map shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// FLIP of the developed pictures, from 0 (black) over violet and orange to 1 (pale yellow).
    Flip,
    /// HDR-FLIP, the same scale.
    HdrFlip,
    /// The pixel's share of E, sqrt(mean over channels of (x − m)² / (Y² + ε)), logarithmic from 10⁻³ to 1.
    Error,
    /// The scores of the noise test: black where the images agree, red where the first is brighter, blue where it is
    /// darker, full at the threshold; grey where nothing can be tested.
    Z,
}

/// Decades below 1 that [`Kind::Error`] shows.
const DECADES: f64 = 3.0;

/// The heat map in linear colour, one pixel for each of the images' (pixels that are not finite are left out as
/// everywhere, and dark). `Ok(None)` if [`Kind::Z`] is asked for and neither image brings standard errors.
pub fn heatmap(a: &Image, b: &Image, kind: Kind, options: &Options) -> Result<Option<Vec<[f32; 3]>>, CompareError> {
    let pair = Pair::new(a, b)?;
    let width = a.width as usize;
    let colors = match kind {
        Kind::Flip => {
            let [a, b] = [&pair.a, &pair.b].map(|image| linear(&pair.develop(image, options.exposure_ev)));
            magma_of(flip::ldr(&a, &b, width))
        }
        Kind::HdrFlip => match pair.exposures() {
            Some(exposures) => magma_of(flip::hdr(&pair.a, &pair.b, width, exposures)),
            None => magma_of(vec![0.0; pair.a.len()]),
        },
        Kind::Error => {
            let floor = pair.floor();
            let error = |(x, m): (&glam::Vec3, &glam::Vec3)| {
                let square = (x.as_dvec3() - m.as_dvec3()).length_squared();
                let error = (relative_square(square, *m, floor) / 3.0).sqrt();
                magma(1.0 + error.log10() / DECADES)
            };
            pair.a.iter().zip(&pair.b).map(error).collect()
        }
        Kind::Z => match NoiseTest::of(a, b, options.block_side) {
            Some(test) => z_map(a, b, &test),
            None => return Ok(None),
        },
    };
    Ok(Some(colors))
}

fn magma_of(values: Vec<f32>) -> Vec<[f32; 3]> {
    values.into_iter().map(|v| magma(f64::from(v))).collect()
}

fn z_map(a: &Image, b: &Image, test: &NoiseTest) -> Vec<[f32; 3]> {
    let color = |block: &blocks::Block| {
        let code = match block.extreme() {
            None => UNKNOWN.map(f64::from),
            // Red at +1, blue at −1; the green that joins in towards the ends keeps both apart from black.
            Some(z) => {
                let strength = (z / test.threshold).clamp(-1.0, 1.0) * 255.0;
                [strength.max(0.0), 0.4 * strength.abs(), (-strength).max(0.0)]
            }
        };
        code.map(|c| linear_from_srgb(c / 255.0) as f32)
    };
    let colors: Vec<[f32; 3]> = blocks::scores(a, b, test.side).iter().map(color).collect();
    let across = a.width.div_ceil(test.side) as usize;
    let (side, width) = (test.side as usize, a.width as usize);
    let pixel = |i: usize| colors.get(i / width / side * across + i % width / side);
    (0..a.rgb.len())
        .map(|i| pixel(i).copied().unwrap_or_default())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(color: [f32; 3]) -> [u8; 3] {
        color.map(|c| (crate::math::color::srgb_from_linear(f64::from(c)) * 255.0).round() as u8)
    }

    #[test]
    fn an_error_of_a_thousandth_is_black_and_one_of_1_is_pale() {
        // Luminance 1, ε = 0.01: an error of e needs a difference of e·sqrt(1.01).
        let reference = Image::from_rgb(3, 1, vec![[1.0; 3]; 3]);
        let scale = 1.01f32.sqrt();
        let shifted = [0.0, 0.001, 1.0].map(|e| [1.0 + e * scale; 3]);
        let image = Image::from_rgb(3, 1, shifted.to_vec());
        let map = heatmap(&image, &reference, Kind::Error, &Options::default())
            .unwrap()
            .unwrap();
        assert_eq!(code(map[0]), [0, 0, 4]);
        assert_eq!(code(map[1]), [0, 0, 4]);
        assert_eq!(code(map[2]), [252, 253, 191]);
    }

    #[test]
    fn blocks_that_differ_are_red_where_the_first_image_is_brighter_and_blue_where_it_is_darker() {
        let with = |values: [f32; 4]| Image {
            stderr: Some(vec![[0.01; 3], [0.01; 3], [f32::NAN; 3], [0.01; 3]]),
            ..Image::from_rgb(4, 1, values.map(|v| [v; 3]).to_vec())
        };
        let options = Options {
            block_side: 1,
            ..Options::default()
        };
        let (a, b) = (with([2.0, 1.0, 2.0, 1.0]), with([1.0, 2.0, 1.0, 1.0]));
        let map = heatmap(&a, &b, Kind::Z, &options).unwrap().unwrap();
        let codes: Vec<_> = map.into_iter().map(code).collect();
        assert_eq!(codes, [[255, 102, 0], [0, 102, 255], UNKNOWN, [0; 3]]);
        let plain = Image::from_rgb(4, 1, a.rgb);
        assert_eq!(heatmap(&plain, &plain, Kind::Z, &options), Ok(None));
    }
}
