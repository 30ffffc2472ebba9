//! Textures in code: planks with a painted word, their bumps, and worn paint. Smooth, so that the PNGs stay small.

use image::{Rgb, RgbImage};

/// The letters P, T, S, five columns by seven rows, top row first: readable one way round only.
const LETTERS: [[u8; 7]; 3] = [
    [0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000, 0b10000],
    [0b11111, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100],
    [0b01111, 0b10000, 0b10000, 0b01110, 0b00001, 0b00001, 0b11110],
];

/// Whether the painted word covers (x, y) in [0, 1]², from the top left.
fn lettered(x: f64, y: f64) -> bool {
    // 17 columns (three letters and two gaps) by 7 rows of square cells.
    let cell = 0.7 / 17.0;
    let (column, row) = (((x - 0.15) / cell).floor(), ((y - 0.36) / cell).floor());
    if !(0.0..17.0).contains(&column) || !(0.0..7.0).contains(&row) {
        return false;
    }
    let (letter, bit) = ((column / 6.0) as usize, (column % 6.0) as u32);
    bit < 5 && LETTERS[letter][row as usize] >> (4 - bit) & 1 == 1
}

/// Height of the planks' surface: 1 on the planks, 0 in the gaps between them, a frame around.
fn height(x: f64, y: f64) -> f64 {
    let groove = |d: f64| (d / 0.012).clamp(0.0, 1.0);
    let edge = x.min(1.0 - x).min(y).min(1.0 - y);
    if edge < 0.1 {
        return 0.4 + 0.6 * groove(edge.min(0.1 - edge));
    }
    let plank = (y - 0.1) / 0.8 * 4.0;
    0.7 * groove((plank - plank.round()).abs() * 0.2)
}

/// Grain: stretched rings, different on each plank.
fn grain(x: f64, y: f64) -> f64 {
    let plank = (y * 5.0).floor();
    let wave = (9.0 * x + 2.3 * plank + 0.8 * (3.0 * x + plank).sin()).sin();
    0.5 + 0.5 * (34.0 * (y + 0.016 * wave) + 5.0 * plank).sin()
}

fn paint(size: u32, f: &dyn Fn(f64, f64) -> [f64; 3]) -> RgbImage {
    RgbImage::from_fn(size, size, |x, y| {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(size);
        // Steps of 4 keep the file small.
        Rgb(f(at(x), at(y)).map(|v| ((v.clamp(0.0, 1.0) * 63.0).round() * 4.0) as u8 + 1))
    })
}

/// Colour of a side of the crate, sRGB.
pub fn crate_color(size: u32) -> RgbImage {
    paint(size, &|x, y| {
        let (dark, light) = ([0.42, 0.27, 0.15], [0.72, 0.52, 0.32]);
        let (g, h) = (grain(x, y), 0.45 + 0.55 * height(x, y));
        if lettered(x, y) && height(x, y) > 0.5 {
            return [0.86, 0.82, 0.72].map(|c| c * (0.88 + 0.12 * g));
        }
        [0, 1, 2].map(|c| (dark[c] + (light[c] - dark[c]) * g) * h)
    })
}

/// Normals of the planks, tangent space, +y up.
pub fn crate_normals(size: u32) -> RgbImage {
    RgbImage::from_fn(size, size, |x, y| {
        let at = |i: u32| (f64::from(i) + 0.5) / f64::from(size);
        let (x, y, h) = (at(x), at(y), 1.0 / f64::from(size));
        let slope_x = (height(x + h, y) - height(x - h, y)) / (2.0 * h) * 0.012;
        let slope_down = (height(x, y + h) - height(x, y - h)) / (2.0 * h) * 0.012;
        let n = glam::DVec3::new(-slope_x, slope_down, 1.0).normalize();
        Rgb((n * 127.0 + 128.0).to_array().map(|v| v as u8))
    })
}

/// glTF's packing: green is roughness, blue is metallic.
pub fn roughness(size: u32) -> RgbImage {
    paint(size, &|x, y| {
        let rough = if lettered(x, y) { 0.35 } else { 0.6 + 0.25 * grain(x, y) };
        [0.0, rough, 0.0]
    })
}
