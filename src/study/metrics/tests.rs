use super::*;
use crate::math::stats::Pcg;

fn grey(values: &[f32]) -> Image {
    Image::from_rgb(values.len() as u32, 1, values.iter().map(|v| [*v; 3]).collect())
}

fn random(seed: u64, size: [u32; 2]) -> Image {
    let mut rng = Pcg::new(seed);
    let pixels = (0..size[0] * size[1]).map(|_| [0; 3].map(|_| 4.0 * rng.next_f32().powi(3)));
    Image::from_rgb(size[0], size[1], pixels.collect())
}

#[track_caller]
fn assert_close(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 1e-6 * expected.abs(),
        "{found} instead of {expected}"
    );
}

/// By hand: m = 1 and 3, mean 2, ε = 0.04; (0.1²·1/1.04 + 0.3²/9.04)/2.
#[test]
fn e_of_two_grey_pixels_is_that_worked_out_by_hand() {
    let m = compare(&grey(&[1.125, 2.75]), &grey(&[1.0, 3.0])).unwrap();
    let square = (0.125f64.powi(2) / 1.04 + 0.25f64.powi(2) / 9.04) / 2.0;
    assert_close(m.rel_rmse, square.sqrt());
    assert_close(m.rel_mse(), square);
    assert_close(m.rmse, ((0.125f64.powi(2) + 0.25f64.powi(2)) / 2.0).sqrt());
    assert_eq!((m.largest.x, m.largest.y, m.largest.value), (1, 0, 0.25));
    assert_eq!(m.largest.colors, [[2.75; 3], [3.0; 3]]);
    assert_close(m.energy_ratio(), 3.875 / 4.0);
    assert_eq!(m.pixels, 2);
}

/// By hand: only green differs, by 0.5; Y = 0.7152, ε = 10⁻²·0.7152²: E² = 0.25 / (3·1.01·0.7152²).
#[test]
fn e_weighs_each_channel_by_the_luminance_of_its_pixel() {
    let of = |g: f32| Image::from_rgb(1, 1, vec![[0.0, g, 0.0]]);
    let m = compare(&of(1.5), &of(1.0)).unwrap();
    assert_close(m.rel_mse(), 0.25 / (3.0 * 1.01 * 0.7152f64.powi(2)));
    assert_close(m.mean_rgb[0][1], 1.5);
    assert_close(m.energy[1], 0.7152);
}

/// By hand: one of two pixels is off by one code (128 and 129) in all channels: 10·log10(255² / 0.5).
#[test]
fn psnr_is_that_of_the_8_bit_pictures() {
    let code = |c: u8| linear_from_srgb(f64::from(c) / 255.0) as f32;
    let m = compare(&grey(&[code(128), code(7)]), &grey(&[code(129), code(7)])).unwrap();
    assert_close(m.psnr_db, 10.0 * (255.0f64.powi(2) / 0.5).log10());
    // What the display cannot show makes no difference there, but in the radiance.
    let m = compare(&grey(&[2.0]), &grey(&[3.0])).unwrap();
    assert_eq!((m.psnr_db, m.flip), (f64::INFINITY, 0.0));
    assert!(m.hdr_flip > 0.1 && m.rmse == 1.0, "{m:?}");
    let darker = Options {
        exposure_ev: -2.0,
        ..Options::default()
    };
    assert!(compare_with(&grey(&[2.0]), &grey(&[3.0]), &darker).unwrap().flip > 0.1);
}

#[test]
fn an_image_does_not_differ_from_itself_and_black_not_from_black() {
    for image in [random(1, [17, 9]), grey(&[0.0; 5])] {
        let m = compare(&image, &image).unwrap();
        assert_eq!([m.rel_rmse, m.rmse, m.flip, m.hdr_flip, m.largest.value], [0.0; 5]);
        assert_eq!((m.psnr_db, m.energy_ratio(), m.noise), (f64::INFINITY, 1.0, None));
    }
}

#[test]
fn against_a_black_reference_e_is_infinite_and_nothing_else() {
    let m = compare(&grey(&[1.0, 0.0]), &grey(&[0.0, 0.0])).unwrap();
    assert_eq!((m.rel_rmse, m.energy_ratio()), (f64::INFINITY, f64::INFINITY));
    assert!(
        [m.rmse, m.psnr_db, m.flip, m.hdr_flip]
            .iter()
            .all(|v| v.is_finite() && *v > 0.0),
        "{m:?}"
    );
}

#[test]
fn e_does_not_change_by_a_bit_with_the_exposure() {
    let (a, b) = (random(1, [16, 8]), random(2, [16, 8]));
    let e = compare(&a, &b).unwrap().rel_rmse;
    assert!(e > 0.5, "{e}");
    for k in [-40, -20, -1, 1, 20, 40] {
        let scaled = |image: &Image| {
            let gain = (k as f32).exp2();
            Image::from_rgb(16, 8, image.rgb.iter().map(|c| c.map(|v| v * gain)).collect())
        };
        let found = compare(&scaled(&a), &scaled(&b)).unwrap().rel_rmse;
        assert_eq!(found.to_bits(), e.to_bits(), "2^{k}: {found} instead of {e}");
    }
}

#[test]
fn what_is_symmetric_is_the_same_the_other_way_round() {
    let (a, b) = (random(1, [16, 8]), random(2, [16, 8]));
    let (there, back) = (compare(&a, &b).unwrap(), compare(&b, &a).unwrap());
    assert_eq!(there.rmse, back.rmse);
    assert_eq!(there.psnr_db, back.psnr_db);
    assert_eq!(there.flip, back.flip);
    assert_eq!(
        (there.largest.x, there.largest.y, there.largest.value),
        (back.largest.x, back.largest.y, back.largest.value)
    );
    assert_eq!(there.energy[0], back.energy[1]);
}

/// A pixel that is not finite changes nothing: not the means, and not what filters make of its neighbours.
#[test]
fn pixels_that_are_not_finite_are_counted_and_left_out() {
    let (mut a, mut b) = (random(1, [9, 9]), random(1, [9, 9]));
    a.rgb[40] = [f32::NAN, 1.0, 1.0];
    a.rgb[0] = [0.0, f32::INFINITY, 0.0];
    b.rgb[41] = [1.0, 1.0, f32::NEG_INFINITY];
    let m = compare(&a, &b).unwrap();
    assert_eq!((m.pixels, m.non_finite), (78, [2, 1]));
    assert_eq!([m.rel_rmse, m.rmse, m.flip, m.hdr_flip], [0.0; 4]);
    let nothing = grey(&[f32::NAN]);
    assert_eq!(compare(&nothing, &grey(&[1.0])), Err(CompareError::NothingFinite));
}

#[test]
fn images_of_different_size_are_refused_by_name_of_both_sizes() {
    let error = compare(&grey(&[1.0; 6]), &Image::from_rgb(2, 3, vec![[1.0; 3]; 6])).unwrap_err();
    assert_eq!(error.to_string(), "the images differ in size: 6x1 and 2x3 pixels");
    let short = Image::from_rgb(4, 1, vec![[1.0; 3]; 3]);
    assert_eq!(compare(&short, &grey(&[1.0; 4])), Err(CompareError::Incomplete([4, 1])));
}
