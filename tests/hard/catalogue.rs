//! The catalogue of hard cases in docs/numerics.md is whole, and every test that it names exists.

use crate::support::scenes::path;
use std::collections::BTreeMap;
use std::fs;

/// Cases in the catalogue.
const CASES: u32 = 90;

/// Whether a file of the repository has a test of this name.
fn has_test(file: &str, name: &str) -> bool {
    let text = fs::read_to_string(path(file)).unwrap_or_default();
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let is_it = |line: &str| {
        line.strip_prefix("fn ")
            .is_some_and(|rest| rest.starts_with(&format!("{name}(")))
    };
    let at = lines.iter().position(|line| is_it(line));
    // Attributes and comments stand between the mark and the function.
    at.is_some_and(|at| {
        let above = lines[..at].iter().rev();
        let mut marks = above.take_while(|line| line.starts_with("#[") || line.starts_with("//"));
        marks.any(|line| *line == "#[test]")
    })
}

#[test]
fn every_case_is_listed_and_every_test_named_exists() {
    let page = fs::read_to_string(path("docs/numerics.md")).expect("the page");
    let (_, catalogue) = page.split_once("## The catalogue").expect("the catalogue");
    let mut seen = BTreeMap::new();
    let mut wrong = Vec::new();
    for line in catalogue.lines() {
        let columns: Vec<&str> = line.split('|').map(str::trim).collect();
        let Some(number) = columns.get(1).and_then(|c| c.parse::<u32>().ok()) else {
            continue;
        };
        let [_, _, what, how, tests, _] = columns[..] else {
            wrong.push(format!("{number}: {} columns", columns.len()));
            continue;
        };
        *seen.entry(number).or_insert(0) += 1;
        let named: Vec<&str> = tests.split('`').skip(1).step_by(2).collect();
        if what.is_empty() || how.is_empty() || (named.is_empty() && !how.starts_with("does not apply:")) {
            wrong.push(format!("{number}: no test, and no `does not apply: reason`"));
        }
        for test in named {
            let (file, name) = test.split_once("::").unwrap_or((test, ""));
            if !has_test(file, name) {
                wrong.push(format!("{number}: there is no test {test}"));
            }
        }
    }
    let counts = (1..=CASES).map(|n| (n, seen.get(&n).copied().unwrap_or(0)));
    wrong.extend(
        counts
            .filter(|(_, k)| *k != 1)
            .map(|(n, k)| format!("{n}: listed {k} times")),
    );
    assert!(wrong.is_empty(), "docs/numerics.md:\n{}", wrong.join("\n"));
}

/// The check above can fail.
#[test]
fn what_is_no_test_is_not_taken_for_one() {
    let file = "tests/hard/catalogue.rs";
    assert!(has_test(file, "what_is_no_test_is_not_taken_for_one"));
    assert!(!has_test(file, "has_test") && !has_test(file, "nothing") && !has_test("nowhere.rs", "has_test"));
}
