use super::super::experiment::Kind::{Bias, Variance};
use super::super::synthetic::{self, Entry, entry};
use super::*;

fn with(entries: Vec<Entry>, goal: Goal) -> Recommendation {
    let study = Study {
        goal,
        ..synthetic::with(entries)
    };
    recommend(&study)
}

fn within(truth: f64, band: Band) -> bool {
    band[0] <= truth && truth <= band[2]
}

/// The base line's law: E = 0.6·n^−0.52, t = 0.05 + 0.02·n; its bound is 1.12 times the true error, so that a run
/// that stops at a bound of 2 % has 861 samples.
#[test]
fn an_error_goal_gives_the_command_and_what_it_takes() {
    let choice = with(vec![], Goal::Error(0.02)).choice.unwrap();
    assert_eq!(choice.command, "pts render cornell.pts -r 640x480 --error 2%");
    assert!((choice.spp as f64 / 861.0 - 1.0).abs() < 0.1, "{choice:?}");
    assert!(
        within(0.02 / 1.12, choice.error) && within(0.05 + 0.02 * 861.0, choice.seconds),
        "{choice:?}"
    );
    assert!(choice.seconds[2] / choice.seconds[0] < 2.0, "{choice:?}");
}

#[test]
fn a_time_goal_gives_the_error_to_expect() {
    let found = with(vec![], Goal::Seconds(40.05));
    let choice = found.choice.unwrap();
    assert_eq!(choice.command, "pts render cornell.pts -r 640x480 --time 40.05s");
    assert!((choice.spp as f64 / 2000.0 - 1.0).abs() < 0.05, "{choice:?}");
    assert!(within(0.6 * 2000f64.powf(-0.52), choice.error), "{choice:?}");
    assert!(!found.text.contains("beyond"), "{}", found.text);
}

#[test]
fn a_picture_that_the_study_made_smaller_is_recommended_at_its_full_size() {
    let study = Study {
        goal: Goal::Error(0.02),
        full_size: [1280, 960],
        ..synthetic::with(vec![])
    };
    let found = recommend(&study);
    let choice = found.choice.unwrap();
    assert_eq!(choice.command, "pts render cornell.pts --error 2%");
    assert!(found.text.contains("for 1280 × 960 pixels"), "{}", found.text);
    // Four times the pixels, at the samples of the small picture.
    assert!((choice.spp as f64 / 861.0 - 1.0).abs() < 0.1, "{choice:?}");
    assert!(within(0.05 + 4.0 * 0.02 * 861.0, choice.seconds), "{choice:?}");
}

#[test]
fn a_variant_must_be_clearly_faster_to_be_preferred() {
    let faster = |cost: f64| {
        with(
            vec![entry("build", "best", Variance, 1.0, 0.0, cost)],
            Goal::Error(0.02),
        )
    };
    let much = faster(0.5);
    let choice = much.choice.unwrap();
    assert_eq!(choice.variant, 1);
    assert_eq!(
        choice.command,
        "pts render cornell.pts -r 640x480 --build best --error 2%"
    );
    assert!(
        much.text.contains("times faster than the scene as written"),
        "{}",
        much.text
    );
    let little = faster(0.97);
    assert_eq!(little.choice.unwrap().variant, 0);
    assert!(
        little.text.contains("No other variant is clearly better"),
        "{}",
        little.text
    );
}

#[test]
fn a_biased_variant_must_buy_much_and_lie_well_below_the_goal() {
    let biased = |bias: f64, cost: f64| with(vec![entry("depth", "8", Bias, 1.0, bias, cost)], Goal::Error(0.05));
    let good = biased(0.001, 0.3);
    let choice = good.choice.unwrap();
    assert_eq!(choice.variant, 1);
    // Its own estimate would not see the bias: the sample count says when to stop.
    assert!(
        choice.command.contains("--depth 8 --spp ") && !choice.command.contains("--error"),
        "{choice:?}"
    );
    assert!(good.text.contains("changes the expected picture"), "{}", good.text);
    assert_eq!(biased(0.001, 0.9).choice.unwrap().variant, 0, "buys little");
    assert_eq!(biased(0.04, 0.3).choice.unwrap().variant, 0, "a floor near the goal");
    assert_eq!(biased(0.2, 0.3).choice.unwrap().variant, 0, "a floor above the goal");
}

#[test]
fn where_the_data_cannot_say_it_says_so() {
    for (goal, words) in [
        (Goal::Error(1e-5), "cannot say"),
        (Goal::Seconds(1e6), "cannot say"),
        (Goal::Seconds(0.01), "too short"),
        (Goal::Error(f64::NAN), "not a positive number"),
        (Goal::Seconds(0.0), "not a positive number"),
    ] {
        let found = with(vec![], goal);
        assert_eq!(found.choice, None, "{goal:?}");
        assert!(found.text.contains(words), "{}", found.text);
    }
    let mut study = synthetic::study(3);
    study.rows.clear();
    assert_eq!(recommend(&study).choice, None);
}

#[test]
fn beyond_what_was_measured_is_said() {
    let found = with(vec![], Goal::Error(0.005));
    assert!(
        found.choice.is_some() && found.text.contains("beyond what was measured"),
        "{}",
        found.text
    );
    let easy = with(vec![], Goal::Error(3.0));
    assert_eq!(easy.choice.unwrap().spp, 1);
}

#[test]
fn names_with_blanks_are_quoted() {
    let study = Study {
        scene: "my scene.pts".to_owned(),
        ..synthetic::study(1)
    };
    let command = recommend(&study).choice.unwrap().command;
    assert!(command.starts_with("pts render 'my scene.pts' -r"), "{command}");
}

/// One seed of the fast variant meets a firefly at its last rung: then its five pictures do not speak for it any more,
/// whatever a line through their mean promises.
#[test]
fn a_variant_whose_own_pictures_scatter_is_not_preferred() {
    let mut study = Study {
        goal: Goal::Error(0.02),
        ..synthetic::with(vec![entry("build", "best", Variance, 1.0, 0.0, 0.5)])
    };
    assert_eq!(recommend(&study).choice.unwrap().variant, 1);
    let own = study.rows.iter_mut().filter(|r| r.variant == 1);
    own.max_by_key(|r| r.spp).unwrap().e2 *= 4.0;
    assert_eq!(recommend(&study).choice.unwrap().variant, 0);
}
