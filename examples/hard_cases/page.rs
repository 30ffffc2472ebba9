//! The parts of docs/numerics.md that are made here, between comments that name them.

use crate::case::Case;
use crate::price::Price;
use std::io::{Error, ErrorKind};
use std::path::Path;

/// Puts `text` between `<!-- name: begin -->` and `<!-- name: end -->`.
pub fn replace(page: &Path, name: &str, text: &str) -> Result<(), Error> {
    let old = std::fs::read_to_string(page)?;
    let [begin, end] = ["begin", "end"].map(|word| format!("<!-- {name}: {word} -->"));
    let missing = || Error::new(ErrorKind::InvalidData, format!("{begin} … {end} is not in the page"));
    let (before, rest) = old.split_once(&begin).ok_or_else(missing)?;
    let (_, after) = rest.split_once(&end).ok_or_else(missing)?;
    std::fs::write(page, format!("{before}{begin}\n{text}{end}{after}"))
}

fn table(head: &str, rows: impl Iterator<Item = String>) -> String {
    let columns = head.matches('|').count() - 1;
    format!("{head}\n|{}\n{}", "---|".repeat(columns), rows.collect::<String>())
}

/// The table of cases.
pub fn cases(cases: &[Case]) -> String {
    table(
        "| item | case | usual formula in f32 | pts | exact | tolerance | |",
        cases.iter().map(|case| format!("| {} |\n", case.columns().join(" | "))),
    )
}

/// The table of prices.
pub fn prices(prices: &[Price]) -> String {
    table(
        "| measure | naive | robust | price |",
        prices.iter().map(|p| {
            let [naive, robust] = [p.naive, p.robust].map(|ns| format!("{ns:.2} ns"));
            format!("| {} | {naive} | {robust} | {:.2} |\n", p.what, p.robust / p.naive)
        }),
    )
}

/// What the columns of the contact sheet show.
pub fn seen(columns: &[&str]) -> String {
    let rows = columns.iter().enumerate();
    rows.map(|(i, what)| format!("{}. {what}\n", i + 1)).collect()
}
