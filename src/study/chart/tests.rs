use super::super::experiment::{Goal, Kind, Phases, Study};
use super::super::synthetic::{self, BASE};
use super::labels::Labels;
use super::layout::{self, SIZE, WIDTH};
use super::shapes::{Page, Room, Shape, Text};
use super::*;

/// Studies as they come, and as nobody would want them.
fn studies() -> Vec<(&'static str, Study)> {
    let change = |variants: usize, change: &dyn Fn(&mut Study)| {
        let mut study = synthetic::study(variants);
        change(&mut study);
        study
    };
    let rows = |value: f64| move |study: &mut Study| study.rows.iter_mut().for_each(|row| row.e2 = value);
    let many: Vec<_> = (0..14)
        .map(|i| {
            let names = [
                "1", "2", "4", "8", "16", "32", "64", "128", "256", "512", "a", "b", "c", "d",
            ];
            let law = synthetic::Law {
                c: BASE.c * (1.0 + 0.1 * f64::from(i)),
                ..BASE
            };
            ("depth", names[i as usize], Kind::Variance, law)
        })
        .collect();
    vec![
        ("one", synthetic::study(1)),
        ("four", synthetic::study(4)),
        ("biased", synthetic::with(synthetic::entries().drain(3..8).collect())),
        ("all", synthetic::study(25)),
        ("crowded", synthetic::with(many)),
        ("time", change(6, &|study| study.goal = Goal::Seconds(3.0))),
        ("far", change(2, &|study| study.goal = Goal::Error(1e-6))),
        ("no rows", change(4, &|study| study.rows.clear())),
        (
            "nothing",
            change(1, &|study| {
                study.rows.clear();
                study.variants.clear();
                study.goal = Goal::Error(f64::NAN);
            }),
        ),
        ("one point", change(1, &|study| study.rows.truncate(1))),
        ("zero", change(3, &rows(0.0))),
        (
            "below",
            change(3, &|study| {
                study
                    .rows
                    .iter_mut()
                    .filter(|row| row.spp > 100)
                    .for_each(|row| row.e2 = -1e-6);
            }),
        ),
        ("not a number", change(25, &rows(f64::NAN))),
        ("huge", change(3, &rows(f64::MAX))),
        ("tiny", change(3, &rows(f64::MIN_POSITIVE))),
        (
            "equal",
            change(3, &|study| {
                study.rows.iter_mut().for_each(|row| {
                    row.e2 = 0.01;
                    row.seconds = Phases {
                        render: 1.0,
                        ..Phases::default()
                    };
                });
            }),
        ),
        (
            "heavy tail",
            change(3, &|study| {
                study
                    .rows
                    .iter_mut()
                    .filter(|row| row.seed == 3)
                    .for_each(|row| row.e2 *= 40.0);
            }),
        ),
        (
            "long",
            change(5, &|study| {
                study.scene =
                    "a scene with a name that no one would type twice & <tags> \"quotes\" and more words.pts".into();
                study.processor = "A-processor-name-without-a-single-blank-that-goes-on-and-on-for-ever-and-ever-and-ever-and-ever-and-some".into();
                study.variants[1].name =
                    "with a description that is longer than the chart is wide, which is a lot of letters to fit".into();
            }),
        ),
    ]
}

fn words(shapes: &[Shape], out: &mut Vec<Text>) {
    for shape in shapes {
        match shape {
            Shape::Words(text) => out.push(text.clone()),
            Shape::Group(_, parts) => words(parts, out),
            _ => {}
        }
    }
}

fn words_of(page: &Page) -> Vec<Text> {
    let mut out = Vec::new();
    words(&page.shapes, &mut out);
    out
}

/// Writes the pictures for looking at, into the folder that `PTS_CHARTS` names.
#[test]
fn pictures_for_looking_at() {
    let Some(folder) = std::env::var_os("PTS_CHARTS") else {
        return;
    };
    let folder = std::path::PathBuf::from(folder);
    for (name, study) in studies() {
        std::fs::write(folder.join(format!("{name}.svg")), svg(&study)).unwrap();
        std::fs::write(folder.join(format!("{name}.png")), png(&study).unwrap()).unwrap();
    }
}

#[test]
fn every_study_gives_a_well_formed_page_with_finite_numbers() {
    for (name, study) in studies() {
        let text = svg(&study);
        let document = roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
        let root = document.root_element();
        assert!(root.has_tag_name(("http://www.w3.org/2000/svg", "svg")), "{name}");
        let has = |tag: &str| {
            root.children()
                .any(|n| n.tag_name().name() == tag && n.text().is_some())
        };
        assert!(has("title") && has("desc"), "{name}");
        assert!(!text.contains("NaN") && !text.contains("inf\""), "{name}");
        let known = [
            "svg", "title", "desc", "rect", "g", "polyline", "polygon", "circle", "text",
        ];
        let foreign = root
            .descendants()
            .find(|n| n.is_element() && !known.contains(&n.tag_name().name()));
        assert_eq!(foreign, None, "{name}");
        assert_eq!(text, svg(&study), "{name}: not the same twice");
    }
}

#[test]
fn a_png_has_the_size_of_the_page_and_is_the_same_twice() {
    for (name, study) in studies()
        .into_iter()
        .filter(|(name, _)| ["four", "nothing"].contains(name))
    {
        let file = png(&study).unwrap();
        let pixels = tiny_skia::Pixmap::decode_png(&file).unwrap();
        let page = layout::page(&study);
        assert_eq!(
            [pixels.width(), pixels.height()],
            page.size.map(|v| 3 * v as u32),
            "{name}"
        );
        assert_eq!(file, png(&study).unwrap(), "{name}");
    }
}

/// No word on another, none over the edge; all at least 9 points when the page is 16 cm wide.
#[test]
fn words_neither_overlap_nor_leave_the_page() {
    for (name, study) in studies() {
        let page = layout::page(&study);
        let paper = Room::new([0.0; 2], page.size);
        let texts = words_of(&page);
        assert!(texts.len() > 5, "{name}");
        for (i, text) in texts.iter().enumerate() {
            let room = text.room();
            assert!(paper.holds(&room), "{name}: {text:?}");
            let points = text.size * (16.0 / 2.54 * 72.0) / WIDTH;
            assert!(points >= 9.0, "{name}: {points} points");
            // Letters' true extent is a little less than the line's height, which may touch.
            let tight = Room::new(
                [room.min[0], room.min[1] + 0.1 * SIZE],
                [room.max[0], room.max[1] - 0.1 * SIZE],
            );
            for other in &texts[..i] {
                assert!(!tight.meets(&other.room()), "{name}: {text:?} on {other:?}");
            }
        }
    }
}

#[test]
fn every_variant_is_named_and_drawn() {
    for (name, study) in studies() {
        let page = layout::page(&study);
        let texts = words_of(&page);
        let groups: Vec<&str> = page
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Group(label, _) => Some(label.as_str()),
                _ => None,
            })
            .collect();
        for (index, variant) in study.variants.iter().enumerate() {
            let whole = study.label(index);
            let named = |text: &Text| {
                let words = text.words.trim_end_matches('…');
                words == whole || words == variant.name || (words.len() > 20 && whole.starts_with(words))
            };
            assert!(texts.iter().any(named), "{name}: {whole}");
            assert!(groups.contains(&whole.as_str()), "{name}: {whole}");
        }
    }
}

/// The places of markers: more time is farther right, more error is higher.
#[test]
fn markers_stand_where_their_numbers_say() {
    let study = synthetic::study(1);
    let mut centres = Vec::new();
    for shape in layout::page(&study).shapes {
        if let Shape::Group(label, parts) = shape
            && label.contains(" spp: ")
        {
            let spp: u32 = label
                .split(", ")
                .nth(1)
                .unwrap()
                .split(' ')
                .next()
                .unwrap()
                .parse()
                .unwrap();
            let disc = parts.iter().find_map(|p| match p {
                Shape::Disc(at, ..) => Some(*at),
                _ => None,
            });
            centres.push((spp, disc.unwrap()));
        }
    }
    centres.sort_by_key(|(spp, _)| *spp);
    assert_eq!(centres.len(), synthetic::LADDER.len());
    assert!(
        centres
            .windows(2)
            .all(|w| w[0].1[0] < w[1].1[0] && w[0].1[1] < w[1].1[1]),
        "{centres:?}"
    );
    // E ∝ n^−0.52, four times the samples a rung: equal steps down but for the noise of 3 % / √5.
    let steps: Vec<f64> = centres.windows(2).map(|w| w[1].1[1] - w[0].1[1]).collect();
    let mean = steps.iter().sum::<f64>() / steps.len() as f64;
    assert!(steps.iter().all(|s| (s / mean - 1.0).abs() < 0.1), "{steps:?}");
}

#[test]
fn marks_of_a_study_are_explained() {
    let text = |name: &str| {
        let study = studies().into_iter().find(|(n, _)| *n == name).unwrap().1;
        let words: Vec<String> = words_of(&layout::page(&study)).into_iter().map(|t| t.words).collect();
        words.join(" ").replace('\u{a0}', " ")
    };
    let four = text("four");
    for words in [
        "goal 2 %",
        "Pareto front",
        "1/√time",
        "0.21 %",
        "5 seeds",
        "8 threads",
        "640 × 480",
        "EPYC",
        "1024 spp",
    ] {
        assert!(four.contains(words), "{words} is missing in: {four}");
    }
    assert!(!four.contains("Hollow") && !four.contains("Arrows"));
    assert!(text("biased").contains("Hollow") && text("biased").contains("floor 12"));
    assert!(text("below").contains("Arrows"));
    assert!(text("time").contains("goal 3 s"));
    assert!(text("far").contains("The goal of 0.0001 % lies outside"));
    assert!(text("no rows").contains("Nothing was measured"));
    assert!(text("one point").contains("one picture"));
}

/// `Labels` is what keeps words off lines; the page uses it for all words inside a plot.
#[test]
fn a_label_is_left_out_rather_than_put_on_another() {
    let mut labels = Labels::new(Room::new([0.0; 2], [200.0, 40.0]));
    let text = Text::new("1024 spp", [0.0; 2], SIZE);
    let placed = (0..9)
        .filter_map(|_| labels.place(&text, &super::labels::around([100.0, 20.0], 4.0, SIZE)))
        .count();
    assert!((1..9).contains(&placed), "{placed}");
}
