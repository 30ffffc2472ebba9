//! Running directives: choice, and the ones that stand alone. Loops are in `loops`, macros in `macros`.

use super::stream::Control;
use super::{Interp, Num, Parsed};
use crate::diag::{Diagnostic, Span};
use crate::lang::syntax::token::DIRECTIVES;
use crate::lang::syntax::{Directive, DirectiveKind, Interner, NONE, Symbol, TokenKind};

impl Interp<'_> {
    /// Runs the directive that comes next in the innermost frame. Errors are reported and skipped over.
    pub fn run_directive(&mut self) {
        let Some((pos, span, directive)) = self.frame().and_then(|f| {
            let d = f.file.directive(f.pos)?;
            Some((f.pos, f.file.span(f.pos), *d))
        }) else {
            self.jump_by_one();
            return;
        };
        let level = self.level();
        self.jump_by_one();
        let depth = self.depth();
        let result = self.nested(span, |s| s.unheld(|s| s.directive(pos, span, directive)));
        if result.is_err() {
            // A block in the directive has skipped itself already; what is left is its line.
            while self.level() > level {
                self.pop_frame();
            }
            self.skip_to_depth(depth);
            self.skip_line(span);
            self.mark_failed();
        }
    }

    fn jump_by_one(&mut self) {
        if let Some(frame) = self.frame_mut() {
            frame.pos += 1;
        }
    }

    /// Moves the innermost frame to a token.
    pub fn jump(&mut self, pos: u32) {
        if let Some(frame) = self.frame_mut() {
            frame.pos = pos.min(frame.end);
        }
    }

    /// Skips what is left of a failed directive: up to a semicolon, the next directive, a closing brace, or a line that
    /// begins with a word which may begin an item.
    fn skip_line(&mut self, from: Span) {
        let text = self.sources.get(from.file).map(|f| f.text.clone());
        let Some(text) = text else { return };
        let mut last = from.end as usize;
        let mut depth = 0usize;
        while let Some((token, span)) = self.raw(0) {
            let new_line = text.get(last..span.start as usize).is_some_and(|t| t.contains('\n'));
            let begins_item = new_line && depth == 0 && token.kind == TokenKind::Name && is_item(token.data);
            let mark = if token.kind == TokenKind::Mark {
                token.data as u8
            } else {
                0
            };
            if token.kind == TokenKind::Directive || begins_item || (mark == b'}' && depth == 0) {
                return;
            }
            match mark {
                b'{' => depth += 1,
                b'}' => depth -= 1,
                _ => {}
            }
            last = span.end as usize;
            self.jump_by_one();
            if mark == b';' && depth == 0 {
                return;
            }
        }
    }

    fn directive(&mut self, pos: u32, span: Span, d: Directive) -> Parsed<()> {
        use DirectiveKind::*;
        match d.kind {
            Declare => self.declare(false),
            Local => self.declare(true),
            Undef => self.undef(),
            Include => self.include(span),
            If | Ifdef | Ifndef | While | For | Switch | Macro if d.end == NONE => {
                let d = Diagnostic::error("P0102", "directive is never closed by `#end`").at(span, "opened here");
                Err(self.fatal_report(d))
            }
            If | Ifdef | Ifndef => self.choose(pos, d),
            While => self.run_while(pos, d),
            For => self.run_for(pos, span, d),
            Switch => self.switch(pos, d),
            Macro => self.define_macro(d),
            End => self.end(pos, span),
            Elseif | Else | Case | Range => self.clause_reached(span, d),
            Break => self.break_out(span),
            Version => self.set_version(),
            Default => self.default_block(),
            Debug | Warning | Error | Statistics | Render => self.message(span, d.kind),
            Fopen | Fclose | Read | Write => self.file_directive(span, d.kind),
            Unknown => Err(self.unknown_directive(span)),
        }
    }

    /// `#if`, `#ifdef`, `#ifndef` and their `#elseif`s: goes to the first branch that holds.
    fn choose(&mut self, pos: u32, first: Directive) -> Parsed<()> {
        let mut clause = (pos, first);
        loop {
            let holds = match clause.1.kind {
                DirectiveKind::If | DirectiveKind::Elseif => self.directive_condition(),
                DirectiveKind::Ifdef => self.defined_test(),
                DirectiveKind::Ifndef => self.defined_test().map(|d| !d),
                _ => Ok(true),
            };
            let Ok(holds) = holds else {
                self.jump(first.end + 1); // neither branch can be trusted
                return Err(super::Stop);
            };
            if holds {
                self.control(Control::Branch);
                return Ok(());
            }
            let next = clause.1.next;
            self.jump(next.saturating_add(1));
            match self.frame().and_then(|f| f.file.directive(next)).copied() {
                Some(d) if d.kind != DirectiveKind::End => clause = (next, d),
                _ => return Ok(()),
            }
        }
    }

    /// Enters a construct.
    pub fn control(&mut self, control: Control) {
        if let Some(frame) = self.frame_mut() {
            frame.controls.push(control);
        }
    }

    /// A clause reached by running into it: the branch before it is done. In a `#switch` running goes on.
    fn clause_reached(&mut self, span: Span, d: Directive) -> Parsed<()> {
        if d.opener == NONE {
            return Err(self.error("P0102", span, "this directive belongs to no `#if` or `#switch`"));
        }
        let in_switch = matches!(
            self.frame().and_then(|f| f.controls.last()),
            Some(Control::Switch { .. })
        );
        match d.kind {
            DirectiveKind::Case => {
                self.case_values(1)?;
            }
            DirectiveKind::Range => {
                self.case_values(2)?;
            }
            DirectiveKind::Else if in_switch => {}
            _ => self.jump(d.end),
        }
        Ok(())
    }

    fn case_values(&mut self, n: usize) -> Parsed<Vec<Num>> {
        self.expect(b'(')?;
        let mut values = Vec::new();
        for _ in 0..n {
            values.push(self.expr()?);
            self.comma();
        }
        self.expect(b')')?;
        Ok(values)
    }

    /// `#switch`: goes behind the first `#case` or `#range` that fits, else to `#else`, else to the end.
    fn switch(&mut self, pos: u32, d: Directive) -> Parsed<()> {
        let end = d.end;
        self.expect(b'(')?;
        let value = self.condition().inspect_err(|_| self.jump(end + 1))?.v[0];
        self.expect(b')')?;
        self.control(Control::Switch { end });
        let mut at = pos;
        loop {
            at = self.frame().and_then(|f| f.file.directive(at)).map_or(NONE, |d| d.next);
            let clause = self.frame().and_then(|f| f.file.directive(at)).map(|d| d.kind);
            self.jump(at.saturating_add(1));
            let near = |a: f64, b: f64| (a - b).abs() < 1e-10 || a == b;
            match clause {
                Some(DirectiveKind::Case) => {
                    let values = self.case_values(1)?;
                    if values.first().is_some_and(|c| near(c.v[0], value)) {
                        return Ok(());
                    }
                }
                Some(DirectiveKind::Range) => {
                    let values = self.case_values(2)?;
                    if let [a, b] = values.as_slice()
                        && value >= a.v[0]
                        && value <= b.v[0]
                    {
                        return Ok(());
                    }
                }
                Some(DirectiveKind::Else) => return Ok(()),
                _ => {
                    self.jump(end);
                    return Ok(());
                }
            }
        }
    }

    fn set_version(&mut self) -> Parsed<()> {
        if self.eat_word_text("unofficial") {
            self.raw_name("a program's name")?; // `#version unofficial megapov 1.0;`
        }
        let at = self.peek().span;
        let version = self.held(|s| s.float("version"))?;
        if !(1.0..=3.8).contains(&version) {
            self.warn(
                "P0307",
                at,
                format!("language version {version} is unknown, reading it as 3.8"),
            );
        }
        if self.raw_is(0, b';') {
            self.jump_by_one();
        }
        self.version = version;
        if self.level() == 1 || self.includes_set_version {
            self.scene_version = version;
        }
        Ok(())
    }

    fn message(&mut self, span: Span, kind: DirectiveKind) -> Parsed<()> {
        let text = self.text("message")?;
        let text = text.trim_end();
        match kind {
            DirectiveKind::Error => Err(self.fatal("P0405", span, format!("the scene reports: {text}"))),
            DirectiveKind::Warning => {
                self.warn("P0406", span, format!("the scene warns: {text}"));
                Ok(())
            }
            _ => {
                self.report(Diagnostic::note("P0407", format!("the scene says: {text}")).at(span, ""));
                Ok(())
            }
        }
    }

    /// Reading and writing files from a scene is switched off: scenes come from strangers.
    fn file_directive(&mut self, span: Span, kind: DirectiveKind) -> Parsed<()> {
        self.warn_once(
            "P0408",
            span,
            "scenes may not read or write files; this directive is skipped",
        );
        if kind == DirectiveKind::Fopen || kind == DirectiveKind::Fclose {
            self.raw_name("a file handle")?;
            if kind == DirectiveKind::Fopen {
                self.text("file name")?;
                for word in ["read", "write", "append"] {
                    self.eat_word_text(word);
                }
            }
            return Ok(());
        }
        self.expect(b'(')?;
        let mut depth = 1;
        while depth > 0 {
            match self.raw(0) {
                Some((t, _)) if t.kind == TokenKind::Mark && t.data == u32::from(b'(') => depth += 1,
                Some((t, _)) if t.kind == TokenKind::Mark && t.data == u32::from(b')') => depth -= 1,
                None => return Ok(()),
                _ => {}
            }
            self.jump_by_one();
        }
        Ok(())
    }

    fn unknown_directive(&mut self, span: Span) -> super::Stop {
        if self.is_silent() {
            return super::Stop;
        }
        let text = self.sources.get(span.file).map(|f| f.text.clone());
        let text = text
            .as_deref()
            .and_then(|t| t.get(span.start as usize..span.end as usize))
            .unwrap_or("");
        let name = text.trim_start_matches('#').trim();
        let mut d = Diagnostic::error("P0203", format!("`#{name}` is not a directive")).at(span, "");
        if let Some(best) = super::errors::nearest(name, DIRECTIVES.iter().map(|d| d.0)) {
            d = d
                .hint(format!("did you mean `#{best}`?"))
                .with_fix(span, format!("#{best}"));
        }
        self.report(d)
    }
}

fn is_item(symbol: u32) -> bool {
    Interner::word(Symbol(symbol)).is_some_and(crate::lang::lower::is_item_word)
}
