use super::*;
use crate::math::stats::Pcg;

const SIZE: u32 = 64;

/// A standard normal number (Box–Muller).
fn normal(rng: &mut Pcg) -> f64 {
    let (u, v) = (1.0 - rng.next_f64(), rng.next_f64());
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// The true picture: a ramp from 0.5 to 1.5, far from black, so that weights are hardly touched by noise.
fn truth(i: usize) -> f64 {
    0.5 + (i % SIZE as usize) as f64 / f64::from(SIZE)
}

/// The mean of `nets` estimates with standard deviation `sigma` each, and its standard error from their spread.
fn noisy(rng: &mut Pcg, sigma: f64, nets: usize) -> Image {
    let mut image = Image::from_rgb(SIZE, SIZE, Vec::new());
    let mut stderr = Vec::new();
    for i in 0..(SIZE * SIZE) as usize {
        let channel = |rng: &mut Pcg| {
            let values: Vec<f64> = (0..nets).map(|_| truth(i) + sigma * normal(rng)).collect();
            let mean = values.iter().sum::<f64>() / nets as f64;
            let square: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
            (mean as f32, (square / ((nets - 1) * nets) as f64).sqrt() as f32)
        };
        let [r, g, b] = [(); 3].map(|()| channel(rng));
        image.rgb.push([r.0, g.0, b.0]);
        stderr.push([r.1, g.1, b.1]);
    }
    image.stderr = Some(stderr);
    image
}

/// E² of pictures with independent noise of variance `v` in every channel: mean of v / (m² + ε).
fn expected(v: f64) -> f64 {
    let n = (SIZE * SIZE) as usize;
    let energy = (0..n).map(truth).sum::<f64>() / n as f64;
    let floor = 1e-2 * energy * energy;
    (0..n).map(|i| v / (truth(i).powi(2) + floor)).sum::<f64>() / n as f64
}

/// A picture as noisy as the reference: without the subtraction its E² comes out twice as large. 100 pairs; the mean
/// of their scores has the standard error 1/10, and 4 of these are the limit (false alarms: 6e-5).
#[test]
fn the_noise_of_the_reference_is_subtracted() {
    let mut rng = Pcg::new(7);
    let (mut scores, mut inside) = (Vec::new(), 0);
    for _ in 0..100 {
        let yardstick = Yardstick::new(noisy(&mut rng, 0.04, 4)).expect("a reference");
        let found = yardstick.measure(&noisy(&mut rng, 0.04, 4)).expect("the same size");
        let true_e2 = expected(0.04f64.powi(2) / 4.0);
        let score = (found.e2 - true_e2) / found.e2_se;
        scores.push(score);
        inside += u32::from(score.abs() < 1.645);
        let error = yardstick.error().expect("it has standard errors");
        assert!((error / true_e2.sqrt() - 1.0).abs() < 0.05, "{error}");
    }
    let mean = scores.iter().sum::<f64>() / 100.0;
    assert!(mean.abs() < 0.4, "mean score {mean}");
    // An interval of 90 % holds 90 ± 3 of 100; below 78 by chance in 1e-4 of all seeds.
    assert!(inside >= 78, "{inside} of 100 intervals hold the truth");
}

#[test]
fn without_standard_errors_nothing_is_subtracted() {
    let mut rng = Pcg::new(8);
    let reference = Image {
        stderr: None,
        ..noisy(&mut rng, 0.04, 4)
    };
    let yardstick = Yardstick::new(reference).expect("a reference");
    assert_eq!(yardstick.error(), None);
    let found = yardstick.measure(&noisy(&mut rng, 0.04, 4)).expect("the same size");
    let both = expected(2.0 * 0.04f64.powi(2) / 4.0);
    // Six standard errors: false alarms 2e-9.
    assert!((found.e2 - both).abs() < 6.0 * found.e2_se, "{found:?} for {both}");
}

#[test]
fn a_perfect_picture_may_come_out_below_zero() {
    let mut rng = Pcg::new(9);
    let exact: Vec<[f32; 3]> = (0..(SIZE * SIZE) as usize).map(|i| [truth(i) as f32; 3]).collect();
    let exact = Image::from_rgb(SIZE, SIZE, exact);
    let found: Vec<f64> = (0..20)
        .map(|_| {
            let yardstick = Yardstick::new(noisy(&mut rng, 0.1, 4)).expect("a reference");
            yardstick.measure(&exact).expect("the same size").e2
        })
        .collect();
    // The sign is a coin: all alike in 2e-6 of all seeds.
    assert!(
        found.iter().any(|e| *e < 0.0) && found.iter().any(|e| *e > 0.0),
        "{found:?}"
    );
}

#[test]
fn a_known_difference_without_noise_is_exact() {
    let image = |v: f32| Image::from_rgb(16, 8, vec![[v; 3]; 128]);
    let found = Yardstick::new(image(2.0)).unwrap().measure(&image(3.0)).unwrap();
    // (3 − 2)² / (2² + 0.01·2²)
    assert!((found.e2 - 1.0 / 4.04).abs() < 1e-12, "{found:?}");
    assert_eq!((found.energy, found.non_finite), (1.5, 0));
    assert!(found.e2_se < 1e-12, "{found:?}");
}

#[test]
fn what_is_not_finite_is_counted_and_left_out() {
    let mut reference = Image::from_rgb(16, 16, vec![[1.0; 3]; 256]);
    reference.rgb[0] = [f32::NAN; 3];
    let mut picture = Image::from_rgb(16, 16, vec![[1.0; 3]; 256]);
    picture.rgb[1] = [f32::INFINITY; 3];
    let found = Yardstick::new(reference).unwrap().measure(&picture).unwrap();
    assert_eq!((found.e2, found.non_finite), (0.0, 1));
    assert!(Yardstick::new(Image::from_rgb(1, 1, vec![[f32::NAN; 3]])).is_err());
    assert!(Yardstick::new(Image::default()).is_err());
}

#[test]
fn black_pictures_agree() {
    let black = Image::from_rgb(8, 8, vec![[0.0; 3]; 64]);
    let found = Yardstick::new(black.clone()).unwrap().measure(&black).unwrap();
    assert_eq!((found.e2, found.energy), (0.0, 1.0));
}

#[test]
fn small_pictures_have_blocks_enough() {
    let ramp = |n: u32| {
        let rgb = (0..n * n).map(|i| [1.0 + i as f32 * 0.01; 3]).collect();
        Image::from_rgb(n, n, rgb)
    };
    for n in [2, 4, 8, 9, 64] {
        let flat = Image::from_rgb(n, n, vec![[1.0; 3]; (n * n) as usize]);
        let found = Yardstick::new(flat).unwrap().measure(&ramp(n)).unwrap();
        assert!(found.e2_se.is_finite() && found.e2_se > 0.0, "{n}: {found:?}");
    }
    let dot = Image::from_rgb(1, 1, vec![[1.0; 3]]);
    assert_eq!(
        Yardstick::new(dot.clone()).unwrap().measure(&dot).unwrap().e2_se,
        f64::INFINITY
    );
}
