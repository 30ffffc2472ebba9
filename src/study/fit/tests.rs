use super::super::experiment::Kind;
use super::super::synthetic::{self, BASE, entry};
use super::*;

#[test]
fn the_laws_that_made_the_rows_are_found_again() {
    let study = synthetic::study(2);
    let base = Law::of(&study, 0).unwrap();
    assert!(
        (base.exponent - 0.52).abs() < 0.015 && base.exponent_se < 0.015,
        "{base:?}"
    );
    assert_eq!(base.measured, [4.0, 1024.0]);
    assert!((base.setup - 0.05).abs() < 1e-9);
    let [low, rate, high] = base.per_sample;
    assert!(low < rate && rate < high && (rate / 0.02 - 1.0).abs() < 0.02);
    assert_eq!((base.floor, base.floor_bound), (None, 0.0));
    let independent = Law::of(&study, 1).unwrap();
    assert!((independent.exponent - 0.5).abs() < 0.02, "{independent:?}");
}

#[test]
fn samples_and_errors_are_inverse_to_each_other() {
    let study = synthetic::with(vec![entry("depth", "2", Kind::Bias, 1.0, 0.05, 1.0)]);
    for variant in [0, 1] {
        let law = Law::of(&study, variant).unwrap();
        for n in [1.0, 50.0, 1e5] {
            let back = law.samples_for_error(law.error(n)[1]).unwrap();
            assert!((back / n - 1.0).abs() < 1e-6, "{back} for {n}");
            let [low, middle, high] = law.error(n);
            assert!(low < middle && middle < high);
            let back = law.samples_for_seconds(law.seconds(n)[1]).unwrap();
            assert!((back / n - 1.0).abs() < 1e-9);
        }
        assert_eq!(law.samples_for_seconds(0.04), None, "less than the set-up");
    }
    let law = Law::of(&study, 1).unwrap();
    assert_eq!(law.samples_for_error(0.04), None, "below the floor");
}

/// 60 variants a kind. A floor of a third of the last rung's error must be found and lie within 10 %; where there is
/// none, each alarm has a probability of 1 %: more than 4 of 60 has one of 0.04 %.
#[test]
fn a_floor_is_found_where_there_is_one_and_only_there() {
    let names: [&str; 60] = std::array::from_fn(|_| "x");
    let law = |b: f64| synthetic::Law { a: 0.5, b, ..BASE };
    let level = 0.6 / 16.0 / 3.0;
    let make = |b: f64| synthetic::with(names.iter().map(|name| ("axis", *name, Kind::Bias, law(b))).collect());
    let laws = |study: &Study| -> Vec<Law> { (1..=60).filter_map(|v| Law::of(study, v)).collect() };
    let with = laws(&make(0.05));
    assert!(
        with.iter()
            .all(|l| l.floor.is_some_and(|f| (f / 0.05 - 1.0).abs() < 0.1)),
        "{with:?}"
    );
    let without = laws(&make(0.0));
    let alarms = without.iter().filter(|l| l.floor.is_some()).count();
    assert!(alarms <= 4, "{alarms}");
    // The bound holds at 95 %: fewer than 50 of 60 has a probability of 0.2 %.
    let faint = laws(&make(level));
    let held = faint.iter().filter(|l| l.floor_bound >= level).count();
    assert!(held >= 50, "{held}");
}

/// The law's interval at 16 times the samples measured, against the true law and one run's noise of 3 %. The interval
/// has 90 %; fewer than 45 of 60 would have a probability below 0.1 %.
#[test]
fn what_is_foretold_comes_true() {
    let law = synthetic::Law { a: 0.55, ..BASE };
    let study = synthetic::with((0..60).map(|_| ("axis", "x", Kind::Variance, law)).collect());
    let n = 4096.0;
    let truth = law.c * f64::powf(n, -law.a);
    let held = (1..=60)
        .map(|v| Law::of(&study, v).unwrap().error(n))
        .filter(|[low, _, high]| (low..=high).contains(&&truth))
        .count();
    assert!(held >= 45, "{held}");
}

#[test]
fn one_rung_relies_on_the_prior_and_nothing_gives_nothing() {
    let mut study = synthetic::with(vec![entry("depth", "2", Kind::Bias, 1.0, 0.05, 1.0)]);
    study.rows.retain(|row| row.spp == 64);
    let base = Law::of(&study, 0).unwrap();
    assert!(
        (base.exponent - 0.5).abs() < 1e-12 && (base.exponent_se - 0.1).abs() < 1e-12,
        "{base:?}"
    );
    let biased = Law::of(&study, 1).unwrap();
    assert!(
        biased.floor.is_none() && biased.floor_bound > 0.08,
        "it may be all floor: {biased:?}"
    );
    study.rows.iter_mut().for_each(|row| row.e2 = -1e-9);
    assert_eq!(Law::of(&study, 0), None);
    study.rows.iter_mut().for_each(|row| row.e2 = f64::NAN);
    assert_eq!(Law::of(&study, 0), None);
    assert_eq!(Law::of(&study, 7), None);
}
