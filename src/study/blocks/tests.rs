use super::*;
use crate::math::stats::Pcg;

fn normal(rng: &mut Pcg) -> f64 {
    normal_quantile(rng.next_f64())
}

/// An image of `nets` independent estimates a pixel around `mean`, with the standard error that they show.
/// The noise grows by a factor of 8 from left to right.
fn noisy(rng: &mut Pcg, size: [u32; 2], mean: f64, nets: u32) -> Image {
    let n = f64::from(nets);
    let mut image = Image::from_rgb(size[0], size[1], Vec::new());
    let mut errors = Vec::new();
    for i in 0..size[0] * size[1] {
        let sigma = 0.05 * (3.0 * f64::from(i % size[0]) / f64::from(size[0])).exp2();
        let (mut rgb, mut stderr) = ([0.0; 3], [0.0; 3]);
        for c in 0..3 {
            let x: Vec<f64> = (0..nets).map(|_| mean + sigma * normal(rng)).collect();
            let center = x.iter().sum::<f64>() / n;
            let squares: f64 = x.iter().map(|x| (x - center).powi(2)).sum();
            rgb[c] = center as f32;
            stderr[c] = (squares / (n - 1.0) / n).sqrt() as f32;
        }
        image.rgb.push(rgb);
        errors.push(stderr);
    }
    image.stderr = Some(errors);
    image.nets = Some(nets);
    image
}

/// Šidák: with α = 0.01, 1 score is compared with the two-sided 1 % point; 10 with that of 1 − 0.99^0.1 = 0.0010045.
#[test]
fn the_threshold_rises_with_the_number_of_scores() {
    assert!((threshold(1) - 2.575_829).abs() < 1e-5, "{}", threshold(1));
    assert!((threshold(10) - 3.289_278).abs() < 1e-4, "{}", threshold(10));
    assert!(threshold(1_000_000) > 5.0);
}

/// Of 300 pairs that differ by noise alone 3 may show a differing block; 10 or more would have p < 0.001 (binomial).
/// The scores themselves must be standard normal: their mean square is 1 within 4 standard errors, √(2/n).
#[test]
fn noise_alone_is_rarely_called_a_difference() {
    for (nets, side) in [(4, 8), (4, 4), (16, 8)] {
        let mut rng = Pcg::new(11);
        let (mut alarms, mut squares, mut scores, mut biased) = (0, 0.0, 0.0f64, 0);
        let pairs = 300;
        for _ in 0..pairs {
            let [a, b] = [0, 1].map(|_| noisy(&mut rng, [24, 16], 1.0, nets));
            let test = NoiseTest::of(&a, &b, side).unwrap();
            alarms += u32::from(test.differing > 0);
            biased += u32::from(extreme(test.bias_z).abs() > threshold(3));
            for z in super::scores(&a, &b, side).iter().flat_map(|b| b.z.unwrap()) {
                squares += z * z;
                scores += 1.0;
            }
        }
        assert!(
            alarms < 10 && biased < 10,
            "{nets} nets, side {side}: {alarms} alarms, {biased} biased"
        );
        let mean_square = squares / scores;
        let allowed = 4.0 * (2.0 / scores).sqrt() + 0.02; // pooled variances are known to a few percent only
        assert!(
            (mean_square - 1.0).abs() < allowed,
            "{nets} nets, side {side}: mean square {mean_square}"
        );
    }
}

/// A pixel of rare bright samples: each is 100 with probability 1/100 and 0 otherwise, all channels alike, in 4 nets.
fn rare(rng: &mut Pcg, size: [u32; 2], samples: u32) -> Image {
    let mut image = Image::from_rgb(size[0], size[1], Vec::new());
    let mut errors = Vec::new();
    for _ in 0..size[0] * size[1] {
        let per_net = samples / 4;
        let nets = [0; 4].map(|_| {
            let hits = (0..per_net).filter(|_| rng.next_u32().is_multiple_of(100)).count();
            100.0 * hits as f64 / f64::from(per_net)
        });
        let mean = nets.iter().sum::<f64>() / 4.0;
        let squares: f64 = nets.iter().map(|x| (x - mean).powi(2)).sum();
        image.rgb.push([mean as f32; 3]);
        errors.push([(squares / 12.0).sqrt() as f32; 3]);
    }
    image.stderr = Some(errors);
    image.samples = Some(vec![samples; image.rgb.len()]);
    image
}

/// Without the other's variance, the image of 16 samples is called too dark in nearly every pair: a block without a hit knows no noise.
#[test]
fn few_samples_that_missed_rare_light_are_no_difference() {
    let mut rng = Pcg::new(7);
    let (mut alarms, mut naive_alarms) = (0, 0);
    for _ in 0..60 {
        let (mut few, many) = (rare(&mut rng, [32, 32], 16), rare(&mut rng, [32, 32], 512));
        alarms += u32::from(NoiseTest::of(&few, &many, 4).unwrap().differing > 0);
        few.samples = None;
        naive_alarms += u32::from(NoiseTest::of(&few, &many, 4).unwrap().differing > 0);
    }
    assert!(alarms <= 4, "{alarms} of 60");
    assert!(
        naive_alarms > 4 * alarms.max(1),
        "{naive_alarms} without the other's variance, {alarms} with it"
    );
}

#[test]
fn developed_pictures_are_not_tested_for_noise() {
    let noisy = noisy(&mut Pcg::new(1), [8, 8], 1.0, 4);
    let developed = Image {
        is_developed: true,
        ..Image::from_rgb(8, 8, noisy.rgb.clone())
    };
    assert_eq!(NoiseTest::of(&noisy, &developed, 8), None);
}

/// σ ≤ 0.2 a pixel from 4 nets of σ ≤ 0.4: a block of 64 knows its difference to 0.035; 0.5 is 14 of them.
#[test]
fn a_difference_in_one_block_is_found_where_it_is() {
    let mut rng = Pcg::new(3);
    let [mut a, b] = [0, 1].map(|_| noisy(&mut rng, [40, 24], 1.0, 4));
    for y in 8..16 {
        for x in 16..24 {
            a.rgb[y * 40 + x][1] -= 0.5;
        }
    }
    let test = NoiseTest::of(&a, &b, 8).unwrap();
    assert_eq!((test.blocks, test.differing), (15, 1));
    assert_eq!((test.worst.x, test.worst.y), (16, 8));
    assert!(test.worst.extreme().unwrap() < -test.threshold, "{:?}", test.worst);
    let back = NoiseTest::of(&b, &a, 8).unwrap();
    assert_eq!(
        back.worst.z,
        test.worst.z.map(|z| z.map(|z| -z)),
        "the test is symmetric"
    );
}

#[test]
fn a_bias_too_small_for_any_block_is_found_in_the_whole() {
    let mut rng = Pcg::new(5);
    let [a, b] = [1.007, 1.0].map(|mean| noisy(&mut rng, [96, 96], mean, 4));
    let test = NoiseTest::of(&a, &b, 8).unwrap();
    assert_eq!(test.differing, 0);
    assert!(test.bias_z.iter().all(|z| *z > threshold(3)), "{:?}", test.bias_z);
}

#[test]
fn what_is_unknown_is_left_out_and_what_is_exact_may_not_differ() {
    let exact = Image::from_rgb(2, 1, vec![[1.0; 3], [2.0; 3]]);
    assert_eq!(NoiseTest::of(&exact, &exact, 8), None);
    let unknown = Image {
        stderr: Some(vec![[f32::NAN; 3]; 2]),
        ..exact.clone()
    };
    assert_eq!(NoiseTest::of(&unknown, &exact, 8), None);
    let half = Image {
        stderr: Some(vec![[0.0; 3], [f32::NAN; 3]]),
        ..exact.clone()
    };
    let test = NoiseTest::of(&half, &exact, 1).unwrap();
    assert_eq!((test.blocks, test.differing, test.untested), (1, 0, 1));
    assert_eq!(test.has_noise, [true, false]);
    let mut off = half.clone();
    off.rgb[0][2] = 1.001;
    assert_eq!(
        NoiseTest::of(&off, &exact, 1).unwrap().worst.z,
        Some([0.0, 0.0, f64::INFINITY])
    );
    // One step of rounding is no difference.
    off.rgb[0][2] = 1.0f32.next_up();
    assert_eq!(NoiseTest::of(&off, &exact, 1).unwrap().differing, 0);
}

/// Table values: the two-sided 5 % points of Student's t (NIST/SEMATECH e-Handbook 1.3.6.7.2) have the score 1.95996.
#[test]
fn scores_of_few_degrees_of_freedom_are_those_of_students_t() {
    for (freedom, t) in [(3.0, 3.182), (10.0, 2.228), (100.0, 1.984)] {
        let z = normal_score(t, freedom);
        assert!((z - 1.95996).abs() < 0.015, "{freedom}: {z}");
        assert_eq!(normal_score(-t, freedom), -z);
    }
}
