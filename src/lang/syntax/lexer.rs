//! From text to tokens, slice by slice: the grammar sees at most a slice at a time, so that a file of any size needs
//! little more memory than its tokens.

use super::structure::match_directives;
use super::token::{DIRECTIVES, Directive, DirectiveKind, GE, Interner, LE, NE, NONE, Token, TokenFile, TokenKind};
use crate::diag::FileId;
use pest::Parser;
use std::path::PathBuf;
use std::rc::Rc;

#[derive(pest_derive::Parser)]
#[grammar = "../grammar/pts.pest"]
struct Grammar;

/// Bytes given to the grammar at once.
const SLICE: usize = 64 << 10;

/// A token that ends this close to the end of a slice may continue behind it, so it is read again with the next one.
const MARGIN: usize = 512;

/// Splits a text into tokens and matches its directives. Never fails: what is wrong with a token shows when it is used.
pub fn lex(file: FileId, dir: Option<PathBuf>, text: &str, interner: &mut Interner) -> TokenFile {
    let mut out = TokenFile {
        file,
        dir,
        tokens: Vec::with_capacity(text.len() / 6),
        numbers: Vec::new(),
        texts: Vec::new(),
        directives: Vec::new(),
    };
    let mut at = 0;
    let mut size = SLICE;
    while at < text.len() {
        let mut end = at.saturating_add(size).min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let is_last = end == text.len();
        let slice = text.get(at..end).unwrap_or("");
        match lex_slice(slice, at, is_last, &mut out, interner) {
            Progress::To(next) if next > at => {
                at = next;
                size = SLICE;
            }
            Progress::Comment(start) => match comment_end(text, start) {
                Some(next) => {
                    at = next;
                    size = SLICE;
                }
                None => {
                    push(&mut out, TokenKind::OpenComment, 0, start, (start + 2).min(text.len()));
                    at = text.len();
                }
            },
            // One token (or a line comment) is longer than the slice.
            Progress::To(_) if !is_last => size = size.saturating_mul(2),
            Progress::To(_) => at = text.len(),
        }
    }
    match_directives(&mut out);
    out
}

/// How far a slice was read.
enum Progress {
    /// Up to this byte of the text.
    To(usize),
    /// A block comment starts at this byte.
    Comment(usize),
}

fn lex_slice(slice: &str, base: usize, is_last: bool, out: &mut TokenFile, interner: &mut Interner) -> Progress {
    let Ok(mut runs) = Grammar::parse(Rule::run, slice) else {
        return Progress::To(base + slice.len());
    };
    let Some(run) = runs.next() else {
        return Progress::To(base + slice.len());
    };
    let limit = if is_last {
        slice.len()
    } else {
        slice.len().saturating_sub(MARGIN)
    };
    let mut reached = 0;
    for pair in run.into_inner() {
        let span = pair.as_span();
        if span.end() > limit {
            return Progress::To(base + reached);
        }
        reached = span.end();
        let (start, end) = (base + span.start(), base + span.end());
        let text = span.as_str();
        match pair.as_rule() {
            Rule::number => {
                out.numbers.push(text.parse().unwrap_or(f64::INFINITY));
                push(out, TokenKind::Number, out.numbers.len() - 1, start, end);
            }
            Rule::word => {
                let symbol = interner.intern(text);
                push(out, TokenKind::Name, symbol.0 as usize, start, end);
            }
            Rule::text | Rule::text_block => {
                out.texts.push(unescape(text));
                push(out, TokenKind::Text, out.texts.len() - 1, start, end);
            }
            Rule::directive => {
                let name = text.trim_start_matches('#').trim_start();
                let kind = DIRECTIVES.iter().find(|d| d.0 == name);
                out.directives.push(Directive {
                    kind: kind.map_or(DirectiveKind::Unknown, |d| d.1),
                    next: NONE,
                    end: NONE,
                    opener: NONE,
                });
                push(out, TokenKind::Directive, out.directives.len() - 1, start, end);
            }
            Rule::mark => push(
                out,
                TokenKind::Mark,
                usize::from(text.as_bytes().first().copied().unwrap_or(0)),
                start,
                end,
            ),
            Rule::double => {
                let code = match text {
                    "<=" => LE,
                    ">=" => GE,
                    _ => NE,
                };
                push(out, TokenKind::Mark, usize::from(code), start, end);
            }
            Rule::open_text => push(out, TokenKind::OpenText, 0, start, end),
            Rule::comment_open => return Progress::Comment(start),
            _ => push(out, TokenKind::Stray, 0, start, end),
        }
    }
    // What follows the last token is blank or a line comment; a comment may go on behind the slice.
    Progress::To(
        base + if is_last {
            slice.len()
        } else {
            reached.max(tail_start(slice, reached, limit))
        },
    )
}

/// Where reading may go on when no token follows `reached`: the last line start before the limit, since line comments
/// end with their line.
fn tail_start(slice: &str, reached: usize, limit: usize) -> usize {
    let tail = slice.as_bytes().get(reached..limit).unwrap_or(&[]);
    tail.iter()
        .rposition(|&b| b == b'\n')
        .map_or(reached, |i| reached + i + 1)
}

/// One past the end of the block comment that starts at `start`; comments nest. `None` if it is never closed.
fn comment_end(text: &str, start: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let mut depth = 1usize;
    let mut at = start + 2;
    while at + 1 < bytes.len() {
        match (bytes.get(at), bytes.get(at + 1)) {
            (Some(b'/'), Some(b'*')) => (depth, at) = (depth + 1, at + 2),
            (Some(b'*'), Some(b'/')) => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

fn push(out: &mut TokenFile, kind: TokenKind, data: usize, start: usize, end: usize) {
    out.tokens.push(Token {
        kind,
        data: data as u32,
        start: start as u32,
        end: end as u32,
    });
}

/// The value of a quoted string. An unknown escape keeps its backslash: scenes write `"c:\fonts\arial.ttf"`.
fn unescape(quoted: &str) -> Rc<str> {
    let inner = quoted.get(1..quoted.len().saturating_sub(1)).unwrap_or("");
    if !inner.contains('\\') {
        return inner.into();
    }
    let mut out = String::with_capacity(inner.len());
    let mut chars = inner.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        match chars.next() {
            Some('n') => out.push('\n'),
            Some('t') => out.push('\t'),
            Some('r') => out.push('\r'),
            Some('a') => out.push('\u{7}'),
            Some('b') => out.push('\u{8}'),
            Some('f') => out.push('\u{c}'),
            Some('v') => out.push('\u{b}'),
            Some(c @ ('"' | '\\' | '\'')) => out.push(c),
            Some(c) => {
                out.push('\\');
                out.push(c);
            }
            None => out.push('\\'),
        }
    }
    out.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> (TokenFile, Vec<String>) {
        let file = lex(FileId(0), None, text, &mut Interner::default());
        let texts = file.tokens.iter();
        let texts = texts
            .map(|t| text[t.start as usize..t.end as usize].to_owned())
            .collect();
        (file, texts)
    }

    #[test]
    fn comments_nest_and_leave_no_token() {
        let (_, t) = tokens("a /* b /* c */ d */ e // f\ng/h");
        assert_eq!(t, ["a", "e", "g", "/", "h"]);
    }

    #[test]
    fn a_comment_that_never_ends_is_one_token_and_costs_no_stack() {
        let (file, _) = tokens(&"/*".repeat(200_000));
        assert_eq!(file.tokens.len(), 1);
        assert_eq!(file.tokens[0].kind, TokenKind::OpenComment);
    }

    #[test]
    fn tokens_do_not_depend_on_where_slices_end() {
        let line = "sphere { <1.5e+3, -2, .5>, Radius_1 } // comment\n#declare A = \"x y\"; /* c */\n";
        let (one, _) = tokens(line);
        let many = line.repeat(5000);
        let (all, _) = tokens(&many);
        assert_eq!(all.tokens.len(), one.tokens.len() * 5000);
        let (_, texts) = tokens(&format!("{}{}", " ".repeat(70_000), many));
        assert_eq!(texts.len(), all.tokens.len());
        assert_eq!(texts[texts.len() - 5], "#declare");
    }

    #[test]
    fn a_token_longer_than_a_slice_stays_whole() {
        let name = "a".repeat(300_000);
        assert_eq!(tokens(&format!("x {name} // {name}\ny")).1, ["x", &name, "y"]);
    }

    #[test]
    fn directives_find_their_clauses_and_ends() {
        let (file, _) = tokens("#if(1) a #while(2) b #end #else c #end #end");
        let of = |pos| file.directive(pos).copied().unwrap();
        let outer = of(0);
        assert_eq!((outer.next, outer.end), (11, 13));
        assert_eq!(of(5).end, 10);
        assert_eq!(of(14).opener, NONE);
    }

    #[test]
    fn numbers_keep_their_value_and_escapes_are_resolved() {
        let (file, t) = tokens("1 .5 1. 2e-3 3e \"a\\n\\\"\\q\"");
        assert_eq!(file.numbers, [1.0, 0.5, 1.0, 2e-3, 3.0]);
        assert_eq!(t[5], "e");
        assert_eq!(&*file.texts[0], "a\n\"\\q");
    }
}
