use super::*;
use crate::math::stats::Pcg;

const NETS: usize = 4;

/// Twelve uniform numbers: mean 0, variance 1.
fn noise(rng: &mut Pcg) -> f64 {
    (0..12).map(|_| rng.next_f64()).sum::<f64>() - 6.0
}

/// Rectangles of 16×16 pixels whose net means `pixel` gives.
fn sums(sheets: usize, wanted: Wanted, mean: f64, mut pixel: impl FnMut(usize) -> [f64; NETS]) -> ErrorSums {
    let of_sheet = |s: usize| {
        let mut sheet = Sheet::new(16, NETS);
        for i in 0..256 {
            sheet.push(&pixel(s * 256 + i).map(|v| [v; 3]));
        }
        ErrorSums::of(&sheet, mean, wanted, 0.9)
    };
    (0..sheets).map(of_sheet).sum()
}

/// Oracle: pixels of mean 2 with net noise σ have E² = σ²/R / (4 + 0.04).
#[test]
fn the_estimate_is_right_for_known_noise() {
    let mut rng = Pcg::new(5);
    let sigma = 0.1; // small, so that weights from half of the nets are as good as true ones
    let wanted = Wanted {
        worst: true,
        display: None,
    };
    let sums = sums(16, wanted, 2.0, |_| [0; NETS].map(|_| 2.0 + sigma * noise(&mut rng)));
    let found = sums.estimate(0.9);
    let want = (sigma * sigma / NETS as f64 / 4.04).sqrt();
    assert!(
        (found.error / want - 1.0).abs() < 0.03,
        "{} instead of {want}",
        found.error
    );
    assert!(
        found.bound > found.error && found.bound < want * 1.06,
        "bound {}",
        found.bound
    );
    // 4096 pixels and thus at least 8192 half estimates: ± 0.02 would be 5 standard errors.
    assert!(
        found.lonely.abs() < 0.06,
        "normal noise is not lonely: {}",
        found.lonely
    );
    assert!(!found.is_doubtful());
    let worst = found.worst.unwrap();
    // Windows of 16 to 49 pixels scatter around the common error.
    assert!(
        worst.value > want && worst.value < 1.5 * want && worst.bound > worst.value,
        "{worst:?}"
    );
}

/// The bound holds as often as it says: in 90 % of 200 images; fewer than 83 % come with p < 0.001.
#[test]
fn the_bound_covers_the_error_that_the_image_really_has() {
    let mut rng = Pcg::new(11);
    let mut covered = 0;
    for _ in 0..200 {
        let mut squares = 0.0;
        let sums = sums(2, Wanted::default(), 1.0, |_| {
            // Three channels move together, so one number is the pixel's error.
            let nets = [0; NETS].map(|_| 1.0 + 0.1 * noise(&mut rng));
            squares += (nets.iter().sum::<f64>() / NETS as f64 - 1.0).powi(2) / 1.01;
            nets
        });
        covered += u32::from(sums.estimate(0.9).bound >= (squares / 512.0).sqrt());
    }
    assert!((166..=196).contains(&covered), "{covered} of 200");
}

/// Oracle: a firefly of 100 in one of 4 nets of one of 512 pixels of mean 1. Its half has the variance
/// 100²/2, so that E² = ½·(5000/4)/(1 + ε)/512, whatever the other pixels (without noise) do.
#[test]
fn a_firefly_does_not_hide_behind_its_own_brightness() {
    let sums = sums(2, Wanted::default(), 1.0, |i| {
        if i == 300 { [1.0, 101.0, 1.0, 1.0] } else { [1.0; 4] }
    });
    let found = sums.estimate(0.9);
    let want = (0.5 * 1250.0 / 1.01 / 512.0f64).sqrt();
    assert!(
        (found.error / want - 1.0).abs() < 1e-12,
        "{} instead of {want}",
        found.error
    );
    assert!(
        (found.lonely - 1.0).abs() < 1e-3 && found.is_doubtful(),
        "{}",
        found.lonely
    );
    assert!((found.top - 1.0).abs() < 1e-12, "{}", found.top);
}

#[test]
fn a_black_image_has_no_error() {
    let found = sums(1, Wanted::default(), 0.0, |_| [0.0; NETS]).estimate(0.9);
    assert_eq!(found, ErrorEstimate::default());
}

/// Oracle: a straight line of slope ½ makes half an error in 8-bit steps of each error of 1/255.
#[test]
fn the_error_on_display_goes_through_the_curve() {
    let mut rng = Pcg::new(3);
    let curve = DisplayCurve::new(|rgb| rgb.map(|v| 0.5 * v));
    let wanted = Wanted {
        worst: false,
        display: Some(&curve),
    };
    let sigma = 0.02;
    let sums = sums(16, wanted, 1.0, |_| [0; NETS].map(|_| 1.0 + sigma * noise(&mut rng)));
    let found = sums.estimate(0.9).display.unwrap();
    let want = 255.0 * 0.5 * sigma / (NETS as f64).sqrt();
    assert!((found.value / want - 1.0).abs() < 0.03, "{found:?} instead of {want}");
}

#[test]
fn the_standard_error_of_one_net_is_unknown() {
    assert!(standard_error(&[[1.0; 3]])[0].is_nan());
    assert_eq!(standard_error(&[[1.0; 3], [3.0; 3]]), [1.0; 3]);
}

#[test]
fn the_largest_terms_are_counted_by_share_of_pixels() {
    let mut sizes = Sizes::default();
    (0..2000).for_each(|i| sizes.add(if i < 2 { 8.0 } else { 1.0 }));
    assert_eq!(sizes.of_the_largest(1e-3), 16.0);
    assert_eq!(sizes.of_the_largest(2e-3), 18.0);
    assert_eq!(sizes.of_the_largest(0.0), 8.0);
}
