//! Diagnostics as terminal text with the source lines, and as JSON.

use crate::diag::{Diagnostic, Diagnostics, FileId, Fix, Label, Severity, SourceFile, SourceMap, Span};
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Origin, Patch, Renderer, Snippet};
use serde_json::{Value, json};
use std::ops::Range;

/// No more diagnostics of one severity than this are shown as text; the rest is counted.
const MOST_SHOWN: usize = 20;

/// A fix in a longer line is told in words.
const MOST_COLUMNS: usize = 200;

/// Lines shown above and below what is underlined when a source is cut out of its file.
const CONTEXT_LINES: usize = 2;

/// All diagnostics from `least` on as text with terminal codes, ending in a line that counts them; empty if there are none.
pub fn to_text(found: &Diagnostics, sources: &SourceMap, least: Severity) -> String {
    let mut text = String::new();
    let mut hidden = 0;
    for severity in [Severity::Note, Severity::Warning, Severity::Error] {
        if severity < least {
            continue;
        }
        for (i, d) in found.iter().filter(|d| d.severity == severity).enumerate() {
            if i < MOST_SHOWN {
                text += &one_to_text(d, sources);
                text += "\n\n";
            } else {
                hidden += 1;
            }
        }
    }
    if hidden > 0 {
        text += &format!("… and {hidden} more\n");
    }
    let counts = summary(found);
    if found.count(Severity::Error) + found.count(Severity::Warning) > 1 && !counts.is_empty() {
        text += &counts;
        text.push('\n');
    }
    text
}

/// `3 errors, 1 warning`; empty if there are neither.
pub fn summary(found: &Diagnostics) -> String {
    let count = |severity, name: &str| match found.count(severity) {
        0 => None,
        1 => Some(format!("1 {name}")),
        n => Some(format!("{n} {name}s")),
    };
    let parts = [count(Severity::Error, "error"), count(Severity::Warning, "warning")];
    parts.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn one_to_text(d: &Diagnostic, sources: &SourceMap) -> String {
    let level = match d.severity {
        Severity::Note => Level::NOTE,
        Severity::Warning => Level::WARNING,
        Severity::Error => Level::ERROR,
    };
    let mut group = Group::with_title(level.primary_title(d.message.as_str()).id(d.code));
    for (file, labels) in by_file(d) {
        if let Some(source) = sources.get(file) {
            group = snippets(group, source, &labels);
        }
    }
    if let Some(place) = &d.place {
        group = group.element(Origin::path(place.as_str()));
    }
    let fix = d.fix.as_ref().and_then(|fix| Some((fix, sources.get(fix.span.file)?)));
    let (patches, words): (Vec<_>, Vec<_>) = fix.into_iter().partition(|(fix, source)| has_short_lines(fix, source));
    let words = words.into_iter().map(|(fix, source)| {
        let old = &source.text[clamp(fix.span, &source.text)];
        format!("write `{}` instead of `{old}`", fix.replacement)
    });
    let mut helps: Vec<String> = d.hints.iter().cloned().chain(words).collect();
    // `did you mean …?` is the natural title of the change that does it.
    let title = match patches.is_empty() {
        true => None,
        false => helps.pop(),
    };
    let title = title.unwrap_or_else(|| "this would mend it".to_owned());
    let mut report = vec![group];
    report.extend(
        helps
            .into_iter()
            .map(|help| Group::with_title(Level::HELP.secondary_title(help))),
    );
    report.extend(
        patches
            .into_iter()
            .map(|(fix, source)| patch(fix, source, title.clone())),
    );
    if d.labels.is_empty() {
        // Without source lines there is no margin that would have to be drawn through to the help.
        let parts = report.into_iter().map(|group| Renderer::styled().render(&[group]));
        return parts.collect::<Vec<_>>().join("\n");
    }
    Renderer::styled().render(&report)
}

/// The labels by file, the file of the primary label first.
fn by_file(d: &Diagnostic) -> Vec<(FileId, Vec<&Label>)> {
    let mut files: Vec<(FileId, Vec<&Label>)> = Vec::new();
    let ordered = d.labels.iter().filter(|l| l.primary);
    for label in ordered.chain(d.labels.iter().filter(|l| !l.primary)) {
        match files.iter_mut().find(|(file, _)| *file == label.span.file) {
            Some((_, labels)) => labels.push(label),
            None => files.push((label.span.file, vec![label])),
        }
    }
    files
}

/// One snippet of a file with all labels in it. Only the lines around the labels are handed over, so that
/// a mistake in a file of a hundred megabytes is shown as quickly as any other.
fn snippets<'a>(group: Group<'a>, source: &'a SourceFile, labels: &[&'a Label]) -> Group<'a> {
    let ranges: Vec<Range<usize>> = labels.iter().map(|l| clamp(l.span, &source.text)).collect();
    let mut groups: Vec<(Range<usize>, Vec<usize>)> = Vec::new();
    for (i, range) in ranges.iter().enumerate() {
        let window = window(&source.text, range);
        // Labels that lie close together share a window; distant ones get their own.
        match groups
            .iter_mut()
            .find(|(w, _)| w.start <= window.end && window.start <= w.end)
        {
            Some((w, members)) => {
                *w = w.start.min(window.start)..w.end.max(window.end);
                members.push(i);
            }
            None => groups.push((window, vec![i])),
        }
    }
    groups.into_iter().fold(group, |group, (window, members)| {
        let line = source.text[..window.start].bytes().filter(|b| *b == b'\n').count() + 1;
        let annotations = members.into_iter().map(|i| {
            let kind = match labels[i].primary {
                true => AnnotationKind::Primary,
                false => AnnotationKind::Context,
            };
            let range = ranges[i].start - window.start..ranges[i].end - window.start;
            let text = Some(labels[i].text.as_str()).filter(|t| !t.is_empty());
            kind.span(range).label(text)
        });
        let snippet: Snippet<'a, Annotation<'a>> = Snippet::source(&source.text[window.clone()]);
        group.element(
            snippet
                .line_start(line)
                .path(source.name.as_str())
                .annotations(annotations.collect::<Vec<_>>()),
        )
    })
}

/// Whether the changed lines can be shown whole: lines written by machines may have megabytes.
fn has_short_lines(fix: &Fix, source: &SourceFile) -> bool {
    let window = window(&source.text, &clamp(fix.span, &source.text));
    source.text[window].lines().all(|line| line.len() <= MOST_COLUMNS)
}

/// The fix as a change of its lines.
fn patch<'a>(fix: &'a Fix, source: &'a SourceFile, title: String) -> Group<'a> {
    let range = clamp(fix.span, &source.text);
    let window = window(&source.text, &range);
    let line = source.text[..window.start].bytes().filter(|b| *b == b'\n').count() + 1;
    let range = range.start - window.start..range.end - window.start;
    let snippet = Snippet::source(&source.text[window])
        .line_start(line)
        .path(source.name.as_str())
        .patch(Patch::new(range, fix.replacement.as_str()));
    Level::HELP.secondary_title(title).element(snippet)
}

/// The span as a range inside the text, on character boundaries.
fn clamp(span: Span, text: &str) -> Range<usize> {
    let floor = |offset: u32| {
        let mut at = (offset as usize).min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = floor(span.start);
    start..floor(span.end).max(start)
}

/// Whole lines around a range, with some context.
fn window(text: &str, range: &Range<usize>) -> Range<usize> {
    let before = text[..range.start].rmatch_indices('\n').nth(CONTEXT_LINES);
    let after = text[range.end..].match_indices('\n').nth(CONTEXT_LINES);
    before.map_or(0, |(i, _)| i + 1)..after.map_or(text.len(), |(i, _)| range.end + i)
}

/// A diagnostic as a JSON object; lines and columns count from 1, columns in characters, ends are exclusive.
pub fn to_json(d: &Diagnostic, sources: &SourceMap) -> Value {
    let severity = match d.severity {
        Severity::Note => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    let labels = d.labels.iter().map(|label| {
        let mut value = span_to_json(label.span, sources);
        value["text"] = json!(label.text);
        value["primary"] = json!(label.primary);
        value
    });
    let fix = d.fix.as_ref().map(|fix| {
        let mut value = span_to_json(fix.span, sources);
        value["replacement"] = json!(fix.replacement);
        value
    });
    json!({
        "severity": severity,
        "code": d.code,
        "message": d.message,
        "place": d.place.clone().or_else(|| d.primary_span().map(|span| sources.place(span))),
        "labels": labels.collect::<Vec<_>>(),
        "hints": d.hints,
        "fix": fix,
    })
}

fn span_to_json(span: Span, sources: &SourceMap) -> Value {
    let end = Span {
        start: span.end,
        ..span
    };
    let ((line, column), (end_line, end_column)) = (sources.line_col(span), sources.line_col(end));
    json!({
        "file": sources.get(span.file).map(|f| f.name.as_str()),
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(found: &Diagnostics, sources: &SourceMap) -> String {
        anstream::adapter::strip_str(&to_text(found, sources, Severity::Note)).to_string()
    }

    fn span(file: FileId, text: &str, part: &str) -> Span {
        let start = text.find(part).expect("the part is in the text") as u32;
        Span {
            file,
            start,
            end: start + part.len() as u32,
        }
    }

    #[test]
    fn a_mistake_in_an_include_shows_both_files() {
        let (inner, outer) = (
            "sphere { 0, R color C }\n",
            "#include \"balls.inc\"\nBall(3, \"red\")\n",
        );
        let mut sources = SourceMap::default();
        let a = sources.add("lib/balls.inc", inner);
        let b = sources.add("scene.pts", outer);
        let mut found = Diagnostics::default();
        found.push(
            Diagnostic::error("P0308", "`color` needs a colour, found a string")
                .with_context(span(b, outer, "\"red\""), "passed here")
                .at(span(a, inner, "C }"), "this is a string")
                .hint("write `rgb <1,0,0>`"),
        );
        let text = plain(&found, &sources);
        for part in [
            "error[P0308]: `color` needs a colour, found a string",
            "lib/balls.inc:1:21",
            "scene.pts:2:9",
            "this is a string",
            "passed here",
            "help: write `rgb <1,0,0>`",
        ] {
            assert!(text.contains(part), "`{part}` is not in\n{text}");
        }
        assert!(text.find("balls.inc") < text.find("scene.pts"), "{text}");
    }

    #[test]
    fn a_fix_is_shown_as_a_change_of_the_line() {
        let text = "\n\n\n\nsfere { 0, 1 }\n";
        let mut sources = SourceMap::default();
        let file = sources.add("a.pts", text);
        let at = span(file, text, "sfere");
        let mut found = Diagnostics::default();
        found.push(
            Diagnostic::error("P0201", "unknown item `sfere`")
                .at(at, "")
                .with_fix(at, "sphere"),
        );
        let shown = plain(&found, &sources);
        assert!(shown.contains("a.pts:5:1"), "{shown}");
        assert!(
            shown.contains("5 - sfere { 0, 1 }") && shown.contains("5 + sphere { 0, 1 }"),
            "{shown}"
        );
    }

    #[test]
    fn a_fix_in_an_endless_line_is_told_in_words() {
        let text = format!("{} sfere {}", "a ".repeat(100_000), "b ".repeat(100_000));
        let mut sources = SourceMap::default();
        let file = sources.add("a.pts", text.as_str());
        let at = span(file, &text, "sfere");
        let mut found = Diagnostics::default();
        found.push(Diagnostic::error("P0201", "unknown").at(at, "").with_fix(at, "sphere"));
        let shown = plain(&found, &sources);
        assert!(shown.contains("write `sphere` instead of `sfere`"), "{shown}");
        assert!(shown.len() < 1000, "{} bytes are shown", shown.len());
    }

    #[test]
    fn spans_outside_the_text_or_inside_a_character_do_not_panic() {
        let mut sources = SourceMap::default();
        let file = sources.add("a.pts", "ä");
        let mut found = Diagnostics::default();
        for (start, end) in [(0, 1), (1, 1), (1, 2), (2, 2), (5, 9), (2, 0)] {
            found.push(Diagnostic::error("P0001", format!("{start}..{end}")).at(Span { file, start, end }, "x"));
        }
        let nowhere = Span {
            file: FileId(7),
            start: 0,
            end: 1,
        };
        found.push(Diagnostic::error("P0002", "nowhere").at(nowhere, "x"));
        let shown = plain(&found, &sources);
        assert!(shown.contains("nowhere") && shown.contains("7 errors"), "{shown}");
    }

    #[test]
    fn a_place_without_lines_is_an_origin() {
        let mut found = Diagnostics::default();
        found.push(
            Diagnostic::warning("G0104", "no such accessor")
                .in_place("a.glb: meshes[3]")
                .hint("export it again"),
        );
        let shown = plain(&found, &SourceMap::default());
        assert!(shown.ends_with("\nhelp: export it again\n\n"), "{shown:?}");
        assert!(shown.contains("warning[G0104]: no such accessor"), "{shown}");
        assert!(shown.contains("--> a.glb: meshes[3]"), "{shown}");
    }

    #[test]
    fn no_more_than_twenty_errors_are_shown_and_all_are_counted() {
        let mut found = Diagnostics::default();
        for i in 0..50 {
            found.push(Diagnostic::error("P0001", format!("mistake {i}")));
        }
        let shown = plain(&found, &SourceMap::default());
        assert_eq!(shown.matches("error[P0001]").count(), 20);
        assert!(shown.contains("30 more") && shown.contains("50 errors"), "{shown}");
    }

    #[test]
    fn json_places_count_from_one_in_characters() {
        let text = "// ä\nsfere\n";
        let mut sources = SourceMap::default();
        let file = sources.add("a.pts", text);
        let d = Diagnostic::error("P0201", "unknown").at(span(file, text, "sfere"), "here");
        let value = to_json(&d, &sources);
        assert_eq!(value["place"], "a.pts:2:1");
        assert_eq!(value["labels"][0]["end_column"], 6);
        assert_eq!(value["labels"][0]["line"], 2);
        assert_eq!(value["fix"], Value::Null);
    }
}
