//! Known values: made with the authors' own program, `flip-evaluator` 1.7 (Python, float32), on the pictures that are
//! computed here, with its default of 67.02 pixels per degree.

use super::*;
use crate::math::color::linear_from_srgb;

const WIDTH: usize = 48;
const HEIGHT: usize = 32;

/// How far float32 results may be apart.
const CLOSE: f64 = 1e-4;

fn picture(color: impl Fn(i32, i32) -> Vec3) -> Vec<Vec3> {
    let pixels = (0..WIDTH * HEIGHT).map(|i| color((i % WIDTH) as i32, (i / WIDTH) as i32));
    pixels.collect()
}

fn from_codes(codes: [i32; 3]) -> Vec3 {
    Vec3::from_array(codes.map(|c| linear_from_srgb(f64::from(c) / 255.0) as f32))
}

fn mean(map: &[f32]) -> f64 {
    map.iter().map(|e| f64::from(*e)).sum::<f64>() / map.len() as f64
}

#[track_caller]
fn assert_mean(map: &[f32], expected: f64) {
    let found = mean(map);
    assert!((found - expected).abs() < CLOSE, "mean {found}, expected {expected}");
}

fn stripes() -> Vec<Vec3> {
    picture(|x, y| from_codes([(7 * x + 3 * y) % 256, (5 * x + 11 * y) % 256, (2 * x + 13 * y) % 256]))
}

fn noisy_stripes() -> Vec<Vec3> {
    picture(|x, y| {
        let noise = (73 * x + 151 * y + (x * y) % 17 * 29) % 61 - 30;
        let codes = [
            (7 * x + 3 * y) % 256 + noise,
            (5 * x + 11 * y) % 256 + (3 * noise).rem_euclid(41) - 20,
            (2 * x + 13 * y) % 256 - noise,
        ];
        from_codes(codes.map(|c| c.clamp(0, 255)))
    })
}

/// Two stops of light every eight columns, from 2⁻⁶ to almost 2⁶.
fn bright() -> Vec<Vec3> {
    picture(|x, y| {
        let light = ((x - 24) as f32 / 4.0).exp2();
        let green = 0.25 + (y * 5 % 16) as f32 / 16.0;
        let blue = 0.125 + ((3 * x + y) % 8) as f32 / 8.0;
        light * Vec3::new(1.0, green, blue)
    })
}

fn noisy_bright() -> Vec<Vec3> {
    let factor = picture(|x, y| Vec3::splat(1.0 + ((73 * x + 151 * y) % 61 - 30) as f32 / 64.0));
    bright().iter().zip(factor).map(|(c, f)| *c * f).collect()
}

#[test]
fn noise_is_seen_as_the_authors_program_sees_it_and_in_both_directions() {
    let (a, b) = (stripes(), noisy_stripes());
    assert_mean(&ldr(&a, &b, WIDTH), 0.109_609);
    assert_eq!(ldr(&a, &b, WIDTH), ldr(&b, &a, WIDTH));
}

#[test]
fn plain_colours_differ_by_the_authors_figures() {
    let [black, white, green, blue] = [Vec3::ZERO, Vec3::ONE, Vec3::Y, Vec3::Z].map(|c| picture(|_, _| c));
    assert_mean(&ldr(&black, &white, WIDTH), 0.967_399);
    assert_mean(&ldr(&green, &blue, WIDTH), 1.0);
    let [a, b] = [128, 129].map(|code| picture(|_, _| from_codes([code; 3])));
    assert_mean(&ldr(&a, &b, WIDTH), 0.029_863);
}

#[test]
fn a_shifted_edge_is_seen_where_it_is() {
    let edge = |at: i32| picture(|x, _| if x < at { Vec3::ZERO } else { Vec3::ONE });
    let map = ldr(&edge(24), &edge(25), WIDTH);
    assert_mean(&map, 0.068_976);
    let middle = &map[16 * WIDTH + 20..][..10];
    let expected = [
        0.07848, 0.35757, 0.69337, 0.77292, 0.53826, 0.49755, 0.24793, 0.09447, 0.01928, 0.00209,
    ];
    for (found, expected) in middle.iter().zip(expected) {
        assert!((f64::from(*found) - expected).abs() < 3e-4, "{middle:?}");
    }
}

#[test]
fn a_single_white_pixel_is_seen() {
    let point = picture(|x, y| if (x, y) == (24, 16) { Vec3::ONE } else { Vec3::ZERO });
    assert_mean(&ldr(&picture(|_, _| Vec3::ZERO), &point, WIDTH), 0.009_316);
}

#[test]
fn the_exposures_of_the_reference_are_those_of_the_authors_program() {
    for (image, start, stop, count) in [
        (bright(), -4.765_560, 1.649_556, 7),
        (noisy_bright(), -5.113_838, 1.653_035, 7),
        (vec![Vec3::ONE; 9], 1.083_297, 1.083_297, 2),
    ] {
        let found = Exposures::of(&image).expect("it shines");
        assert!(
            (found.start - start).abs() < 1e-4 && (found.stop - stop).abs() < 1e-4,
            "{found:?}"
        );
        assert_eq!(found.count, count);
    }
    // More than half of it is black.
    let mut dark = bright();
    dark[..20 * WIDTH].fill(Vec3::ZERO);
    let found = Exposures::of(&dark).expect("it shines");
    assert!((found.stop - 24.083_298).abs() < 1e-4, "{found:?}");
    assert_eq!(found.count, 29);
    assert_eq!(Exposures::of(&[Vec3::ZERO]), None);
    assert_eq!(Exposures::of(&[]), None);
}

#[test]
fn high_dynamic_range_is_seen_as_the_authors_program_sees_it() {
    let (r, t) = (bright(), noisy_bright());
    let of = |test: &[Vec3], reference: &[Vec3]| hdr(test, reference, WIDTH, Exposures::of(reference).expect("light"));
    assert_mean(&of(&t, &r), 0.084_855);
    assert_mean(&of(&r, &t), 0.085_690);
    let [r8, t8] = [&r, &t].map(|image| image.iter().map(|c| *c * 8.0).collect::<Vec<_>>());
    assert_mean(&of(&t8, &r8), 0.084_855);
    let [mut rb, mut tb] = [r, t];
    rb[..20 * WIDTH].fill(Vec3::ZERO);
    tb[..20 * WIDTH].fill(Vec3::ZERO);
    assert_mean(&of(&tb, &rb), 0.043_229);
    let ones = vec![Vec3::ONE; WIDTH * HEIGHT];
    assert_mean(&of(&vec![Vec3::splat(1.5); WIDTH * HEIGHT], &ones), 0.109_181);
}

#[test]
fn the_same_picture_is_exactly_the_same() {
    for image in [stripes(), bright(), vec![Vec3::ZERO; 48]] {
        assert!(ldr(&image, &image, WIDTH).iter().all(|e| *e == 0.0));
    }
}

#[test]
fn pictures_smaller_than_the_filters_are_compared_too() {
    for (width, n) in [(1, 1), (1, 5), (5, 5), (3, 6)] {
        let map = ldr(&vec![Vec3::Y; n], &vec![Vec3::Z; n], width);
        assert_eq!(map.len(), n);
        assert!(map.iter().all(|e| (e - 1.0).abs() < 1e-4), "{map:?}");
    }
}
