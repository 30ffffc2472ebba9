//! Bytes to statements: comments, continuation lines, blanks, and names in any encoding.

use std::borrow::Cow;

/// The statements of an OBJ or MTL text with the number (from 1) of the line each begins on. Comments are cut off
/// from an unquoted `#` that begins a word, a `\` before the end of a line continues it, lines end with LF, CR LF or CR.
pub(super) fn statements(bytes: &[u8]) -> impl Iterator<Item = (u32, Cow<'_, [u8]>)> {
    let mut rest = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut line = 0_u32;
    std::iter::from_fn(move || {
        loop {
            if rest.is_empty() {
                return None;
            }
            line = line.saturating_add(1);
            let first = line;
            let mut statement = Cow::Borrowed(without_comment(next_line(&mut rest)));
            if let Some(mut head) = continued(&statement) {
                // Each line is looked at once: a file may consist of nothing else.
                let mut joined = Vec::new();
                loop {
                    joined.extend_from_slice(head);
                    joined.push(b' ');
                    line = line.saturating_add(1);
                    let next = without_comment(next_line(&mut rest));
                    match continued(next) {
                        Some(more) => head = more,
                        None => {
                            joined.extend_from_slice(next);
                            break;
                        }
                    }
                }
                statement = Cow::Owned(joined);
            }
            if !statement.trim_ascii().is_empty() {
                return Some((first, statement));
            }
        }
    })
}

/// What stands before the backslash of a line that goes on in the next.
fn continued(line: &[u8]) -> Option<&[u8]> {
    line.trim_ascii_end().strip_suffix(b"\\")
}

/// Cuts one line off the front.
fn next_line<'a>(rest: &mut &'a [u8]) -> &'a [u8] {
    let end = rest
        .iter()
        .position(|b| matches!(b, b'\n' | b'\r'))
        .unwrap_or(rest.len());
    let (line, tail) = rest.split_at(end);
    *rest = match tail {
        [b'\r', b'\n', tail @ ..] | [_, tail @ ..] => tail,
        [] => tail,
    };
    line
}

/// A `#` inside a word stays: names such as `wall#2` are in use.
fn without_comment(line: &[u8]) -> &[u8] {
    let starts = |(i, b): (usize, &u8)| *b == b'#' && (i == 0 || line.get(i - 1).is_some_and(u8::is_ascii_whitespace));
    match line.iter().enumerate().position(starts) {
        Some(at) => line.get(..at).unwrap_or_default(),
        None => line,
    }
}

/// The words of a statement.
pub(super) fn words(statement: &[u8]) -> impl Iterator<Item = &[u8]> {
    statement.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
}

/// What follows the first word, without blanks around it.
pub(super) fn after_keyword(statement: &[u8]) -> &[u8] {
    let trimmed = statement.trim_ascii();
    let end = trimmed
        .iter()
        .position(u8::is_ascii_whitespace)
        .unwrap_or(trimmed.len());
    trimmed.get(end..).unwrap_or_default().trim_ascii()
}

/// Bytes as text: UTF-8 where they are, Latin-1 otherwise.
pub(super) fn text(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
    }
}

/// A number as C programs write it; `nan(ind)` and `1.#QNAN` are NaN. `None` for anything else.
pub(super) fn number(word: &[u8]) -> Option<f64> {
    let word = std::str::from_utf8(word).ok()?;
    match word.parse::<f64>() {
        Ok(v) => Some(v),
        Err(_) => {
            let lower = word.to_ascii_lowercase();
            let is_nan = lower.contains("nan") || lower.contains("#ind");
            is_nan.then_some(f64::NAN)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn continuations_comments_and_all_line_ends_give_statements_with_their_line() {
        let source = b"\xef\xbb\xbfv 1 2 3 # corner\r\n\r\nf 1 2 \\\n 3\rusemtl a#b\n# all comment\n  \ng x \\";
        let found: Vec<(u32, String)> = statements(source).map(|(n, s)| (n, text(s.trim_ascii()))).collect();
        let expected = [(1, "v 1 2 3"), (3, "f 1 2   3"), (5, "usemtl a#b"), (8, "g x")];
        assert_eq!(found, expected.map(|(n, s)| (n, s.to_owned())));
    }

    #[test]
    fn names_are_utf8_or_latin1() {
        assert_eq!(text("Stühle".as_bytes()), "Stühle");
        assert_eq!(text(b"St\xfchle"), "Stühle");
        assert_eq!(text(after_keyword(b"  usemtl \t two words ")), "two words");
    }

    #[test]
    fn numbers_of_c_programs_are_read() {
        assert_eq!(number(b"1e-3"), Some(1e-3));
        assert_eq!(number(b"+.5"), Some(0.5));
        assert!(number(b"-nan(ind)").is_some_and(f64::is_nan) && number(b"1.#QNAN").is_some_and(f64::is_nan));
        assert_eq!(number(b"1,5"), None);
    }
}
