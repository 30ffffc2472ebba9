use super::super::synthetic;
use super::*;

/// Writes the tables for looking at, into the folder that `PTS_CHARTS` names.
#[test]
fn tables_for_looking_at() {
    let Some(folder) = std::env::var_os("PTS_CHARTS") else {
        return;
    };
    let folder = std::path::PathBuf::from(folder);
    let study = synthetic::study(25);
    std::fs::write(folder.join("all.md"), markdown(&study)).unwrap();
    std::fs::write(folder.join("all.csv"), csv(&study)).unwrap();
    std::fs::write(folder.join("all.json"), format!("{:#}", json(&study))).unwrap();
}

/// Fields of CSV text by the grammar of RFC 4180.
fn parse(text: &str) -> Vec<Vec<String>> {
    let mut lines = vec![vec![String::new()]];
    let mut letters = text.chars().peekable();
    let mut quoted = false;
    while let Some(c) = letters.next() {
        let field = lines.last_mut().unwrap().last_mut().unwrap();
        match c {
            '"' if quoted && letters.peek() == Some(&'"') => field.push(letters.next().unwrap()),
            '"' => quoted = !quoted,
            ',' if !quoted => lines.last_mut().unwrap().push(String::new()),
            '\r' if !quoted => {
                assert_eq!(letters.next(), Some('\n'));
                lines.push(vec![String::new()]);
            }
            c => field.push(c),
        }
    }
    assert_eq!(lines.pop(), Some(vec![String::new()]), "the last line ends too");
    lines
}

#[test]
fn csv_holds_each_row_under_its_names() {
    let mut study = synthetic::study(5);
    study.processor = "A \"fast\" one, 8 cores\nand more".to_owned();
    study.rows[1].e2 = f64::NAN;
    study.rows[2].estimate = None;
    let lines = parse(&csv(&study));
    assert_eq!(lines[0], COLUMNS);
    assert_eq!(lines.len(), study.rows.len() + 1);
    let at = |line: usize, name: &str| lines[line][COLUMNS.iter().position(|c| *c == name).unwrap()].clone();
    for (line, row) in study.rows.iter().enumerate().map(|(i, row)| (i + 1, row)) {
        assert_eq!(lines[line].len(), COLUMNS.len());
        assert_eq!(at(line, "processor"), study.processor);
        assert_eq!(at(line, "variant"), study.variants[row.variant].name);
        assert_eq!(at(line, "seed"), row.seed.to_string());
        assert_eq!(at(line, "seconds").parse(), Ok(row.seconds.total()));
        if row.e2.is_finite() {
            assert_eq!(at(line, "error").parse(), Ok(row.error()));
            assert_eq!(at(line, "error_high").parse(), Ok(row.interval()[1]));
        }
    }
    assert_eq!((at(2, "error"), at(2, "error_squared")), (String::new(), String::new()));
    assert_eq!(at(3, "own_bound"), "");
    let last = study.rows.len();
    assert_eq!(
        (at(1, "kind"), at(last, "kind")),
        ("variance".to_owned(), "bias".to_owned())
    );
}

#[test]
fn json_holds_the_whole_study_and_names_its_format() {
    let mut study = synthetic::study(4);
    study.rows[0].flip = f64::NAN;
    let value = json(&study);
    assert_eq!(value["format"], FORMAT);
    assert_eq!(value["rows"].as_array().unwrap().len(), study.rows.len());
    assert_eq!(value["rows"][0]["flip"], Value::Null);
    for (row, read) in study.rows.iter().zip(value["rows"].as_array().unwrap()) {
        assert_eq!(read["error_squared"].as_f64(), Some(row.e2));
        assert_eq!(read["seconds"]["render"].as_f64(), Some(row.seconds.render));
        assert_eq!(read["variant"], row.variant);
    }
    assert_eq!(value["variants"].as_array().unwrap().len(), 4);
    assert_eq!(value["points"].as_array().unwrap().len(), points(&study).len());
    assert_eq!(value["reference"]["error"].as_f64(), study.reference.error);
    assert_eq!(value["goal"]["error"].as_f64(), Some(0.02));
    assert_eq!(value["ablations"][0]["effect"], "caustics");
    assert!(
        value["recommendation"]["choice"]["command"]
            .as_str()
            .unwrap()
            .starts_with("pts render")
    );
    let text: Value = serde_json::from_str(&value.to_string()).unwrap();
    assert_eq!(text["scene"], "cornell.pts");
    assert_eq!(value["notes"][0].as_str(), Some(study.notes[0].as_str()));
}

#[test]
fn effects_read_as_sentences() {
    let study = synthetic::study(1);
    let lines: Vec<String> = study.ablations.iter().map(effect).collect();
    assert_eq!(lines[0], "caustics: 41 % of time, 2.3 % of energy, FLIP 0.020");
    assert_eq!(lines[1], "roughness: no measurable time, -0.4 % of energy, FLIP 0.008");
    assert_eq!(
        lines[2],
        "textures: no measurable time, picture not distinguishable from noise"
    );
}

#[test]
fn markdown_tables_are_whole() {
    let mut study = synthetic::study(25);
    study.variants[1].name = "a|b\nc".to_owned();
    let text = markdown(&study);
    let mut widths = Vec::new();
    for line in text.lines().filter(|line| line.starts_with('|')) {
        widths.push(line.replace(r"\|", "").matches('|').count() - 1);
    }
    widths.dedup();
    assert_eq!(widths, [10, 5], "points, then the front");
    let front = pareto(&points(&study)).len();
    let rows = text.lines().filter(|line| line.starts_with('|')).count();
    assert_eq!(rows, points(&study).len() + front + 4);
    for words in [
        r"sampler: a\|b c",
        "## Recommendation",
        "--error 2%",
        "E tends to",
        "0.21 %",
        "no fog",
        "pts study cornell.pts",
    ] {
        assert!(text.contains(words), "{words}");
    }
}

#[test]
fn studies_without_numbers_have_tables_too() {
    let mut study = synthetic::study(2);
    study.rows.iter_mut().for_each(|row| row.e2 = -1.0);
    assert!(markdown(&study).contains("below the noise"));
    study.rows.clear();
    study.ablations.clear();
    study.variants.clear();
    study.reference.error = None;
    assert!(markdown(&study).contains("own error is unknown"));
    assert_eq!(csv(&study).lines().count(), 1);
    assert_eq!(json(&study)["rows"], json!([]));
}
