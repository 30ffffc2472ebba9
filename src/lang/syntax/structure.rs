//! The nesting of directives: every `#if`, loop, switch and macro finds its clauses and its `#end`.
//!
//! A construct that is not closed, or a clause that belongs to nothing, keeps [`NONE`] and is reported only when it is
//! run: what stands in a skipped branch must not fail.

use super::token::{DirectiveKind, NONE, TokenFile, TokenKind};

/// Fills in `next`, `end` and `opener` of all directives of a file.
pub fn match_directives(file: &mut TokenFile) {
    // Token positions of the clauses of each open construct, opener first.
    let mut open: Vec<Vec<u32>> = Vec::new();
    let positions: Vec<(u32, u32)> = file
        .tokens
        .iter()
        .enumerate()
        .filter(|(_, t)| t.kind == TokenKind::Directive)
        .map(|(pos, t)| (pos as u32, t.data))
        .collect();
    for &(pos, index) in &positions {
        use DirectiveKind::*;
        let Some(kind) = file.directives.get(index as usize).map(|d| d.kind) else {
            continue;
        };
        match kind {
            If | Ifdef | Ifndef | While | For | Switch | Macro => open.push(vec![pos]),
            Elseif | Else | Case | Range => {
                if let Some(clauses) = open.last_mut() {
                    clauses.push(pos);
                }
            }
            End => {
                if let Some(mut clauses) = open.pop() {
                    clauses.push(pos);
                    link(file, &clauses, pos);
                }
            }
            _ => {}
        }
    }
}

/// Links the clauses of one closed construct.
fn link(file: &mut TokenFile, clauses: &[u32], end: u32) {
    let opener = clauses.first().copied().unwrap_or(NONE);
    for (i, &pos) in clauses.iter().enumerate() {
        let Some(token) = file.tokens.get(pos as usize) else {
            continue;
        };
        if let Some(d) = file.directives.get_mut(token.data as usize) {
            d.next = clauses.get(i + 1).copied().unwrap_or(NONE);
            d.end = end;
            d.opener = opener;
        }
    }
}
