//! `#while`, `#for`, `#break` and `#end`.

use super::stream::Control;
use super::{Interp, MAX_LOOP_RUNS, MAX_RUNS, Num, Parsed, Stop, Value};
use crate::diag::{Diagnostic, Span};
use crate::lang::syntax::Directive;

/// `#for` counts as ended only beyond this share of a step: sums of steps carry rounding.
const FOR_TOLERANCE: f64 = 1e-6;

impl Interp<'_> {
    /// A `#while` met for the first time or again after its `#end`.
    pub fn run_while(&mut self, pos: u32, d: Directive) -> Parsed<()> {
        let again = match self.frame().and_then(|f| f.controls.last()) {
            Some(Control::While { at, runs }) if *at == pos => Some(*runs),
            _ => None,
        };
        if again.is_some() {
            self.leave();
        }
        let holds = self.directive_condition().inspect_err(|_| self.jump(d.end + 1))?;
        if !holds {
            self.jump(d.end + 1);
            return Ok(());
        }
        let runs = self.count_run(again.unwrap_or(0), pos)?;
        self.control(Control::While { at: pos, runs });
        Ok(())
    }

    fn count_run(&mut self, runs: u64, pos: u32) -> Parsed<u64> {
        if runs >= MAX_LOOP_RUNS {
            let span = self.frame().map_or(self.here(), |f| f.file.span(pos));
            let message = format!("loop does not end: its body ran {MAX_LOOP_RUNS} times");
            let d = Diagnostic::error("P0606", message).at(span, "");
            return Err(self.fatal_report(d.hint("does the loop change what its condition tests?")));
        }
        self.runs += 1;
        if self.runs > MAX_RUNS {
            let span = self.frame().map_or(self.here(), |f| f.file.span(pos));
            return Err(self.fatal("P0606", span, format!("loops run more than {MAX_RUNS} times in all")));
        }
        Ok(runs + 1)
    }

    /// `#for (Name, from, to, step)`: both ends included.
    pub fn run_for(&mut self, pos: u32, span: Span, d: Directive) -> Parsed<()> {
        let end = d.end;
        let head = self.for_head(span).inspect_err(|_| self.jump(end + 1))?;
        let (name, from, last, step) = head;
        if past(from, last, step) {
            self.jump(end + 1);
            return Ok(());
        }
        self.control(Control::For {
            at: pos,
            name,
            value: from,
            last,
            step,
            runs: 1,
        });
        Ok(())
    }

    fn for_head(&mut self, span: Span) -> Parsed<(crate::lang::syntax::Symbol, f64, f64, f64)> {
        self.expect(b'(')?;
        let (name, name_span) = self.raw_name("the loop's variable")?;
        self.check_declarable(name, name_span)?;
        self.comma();
        let from = self.finite("start of the loop")?;
        self.comma();
        let last = self.finite("end of the loop")?;
        let mut step = 1.0;
        if self.eat(b',') {
            step = self.finite("step of the loop")?;
        }
        self.expect(b')')?;
        if step.abs() < 1e-10 {
            return Err(self.error("P0306", span, "step of the loop is 0"));
        }
        let scope = self.frame().map_or(0, |f| f.scope);
        let place = self.scopes.local_place(scope, name);
        self.scopes.set(place, Value::Num(Num::float(from)));
        Ok((name, from, last, step))
    }

    /// `#end`: repeats a loop or leaves the construct.
    pub fn end(&mut self, pos: u32, span: Span) -> Parsed<()> {
        let Some(control) = self.frame().and_then(|f| f.controls.last().cloned()) else {
            return Err(self.error("P0102", span, "this `#end` closes nothing"));
        };
        match control {
            Control::Branch | Control::Switch { .. } => self.leave(),
            Control::While { at, .. } => self.jump(at),
            Control::For {
                at,
                name,
                value,
                last,
                step,
                runs,
            } => {
                self.leave();
                let value = value + step;
                let scope = self.frame().map_or(0, |f| f.scope);
                let place = self.scopes.local_place(scope, name);
                self.scopes.set(place, Value::Num(Num::float(value)));
                if past(value, last, step) {
                    self.jump(pos + 1);
                    return Ok(());
                }
                let runs = self.count_run(runs, at)?;
                self.jump(at + 1);
                self.skip_parentheses();
                self.control(Control::For {
                    at,
                    name,
                    value,
                    last,
                    step,
                    runs,
                });
            }
        }
        Ok(())
    }

    /// Moves behind the `( … )` that comes next, without evaluating it.
    fn skip_parentheses(&mut self) {
        let mut depth = 0usize;
        loop {
            if self.raw_is(0, b'(') {
                depth += 1;
            } else if self.raw_is(0, b')') {
                depth = depth.saturating_sub(1);
            }
            let Some(frame) = self.frame_mut() else { return };
            if frame.pos >= frame.end {
                return;
            }
            frame.pos += 1;
            if depth == 0 {
                return;
            }
        }
    }

    fn leave(&mut self) {
        if let Some(frame) = self.frame_mut() {
            frame.controls.pop();
        }
    }

    /// `#break`: leaves the innermost loop or switch.
    pub fn break_out(&mut self, span: Span) -> Parsed<()> {
        loop {
            let control = self.frame().and_then(|f| f.controls.last().cloned());
            self.leave();
            let opener = match control {
                Some(Control::Branch) => continue,
                Some(Control::Switch { end }) => {
                    self.jump(end + 1);
                    return Ok(());
                }
                Some(Control::While { at, .. } | Control::For { at, .. }) => at,
                None => {
                    self.error("P0102", span, "`#break` stands in no loop and no `#switch`");
                    return Err(Stop);
                }
            };
            let end = self.frame().and_then(|f| f.file.directive(opener)).map(|d| d.end);
            self.jump(end.map_or(u32::MAX, |e| e + 1));
            return Ok(());
        }
    }
}

fn past(value: f64, last: f64, step: f64) -> bool {
    (value - last) / step > FOR_TOLERANCE
}
