//! Faces: corners with one to three indices, checked and made absolute.

use super::clean::Pass;
use super::lines::{text, words};
use crate::diag::Diagnostic;

impl Pass<'_> {
    /// `f`: at least three corners.
    pub fn face(&mut self, statement: &[u8]) {
        self.corners.clear();
        for word in words(statement).skip(1) {
            match self.corner(word) {
                // A corner given twice in a row adds no edge.
                Some(corner) if self.corners.last().is_some_and(|last| last[0] == corner[0]) => {}
                Some(corner) => self.corners.push(corner),
                None => return,
            }
        }
        if self.corners.len() > 1 && self.corners.first().map(|c| c[0]) == self.corners.last().map(|c| c[0]) {
            self.corners.pop();
        }
        if self.corners.len() < 3 {
            let message = format!(
                "face `f` has {} different corners, expected at least 3; it is left out",
                self.corners.len()
            );
            self.push(Diagnostic::warning("O0106", message));
            return;
        }
        self.out.obj.push(b'f');
        for corner in &self.corners {
            for (kind, index) in corner.iter().enumerate() {
                self.out.obj.push(if kind == 0 { b' ' } else { b'/' });
                push_number(&mut self.out.obj, *index);
            }
        }
        self.out.obj.push(b'\n');
        self.out.faces.push(self.state);
    }

    /// `v`, `v/vt`, `v//vn` or `v/vt/vn`; each counts from 1, or backwards from the last one if negative.
    fn corner(&mut self, word: &[u8]) -> Option<[u64; 3]> {
        let counts = self.out.counts;
        let mut corner = [0, 1, 1];
        for (kind, part) in word.split(|&b| b == b'/').enumerate() {
            let (Some(&count), Some(target)) = (counts.get(kind), corner.get_mut(kind)) else {
                self.malformed_corner(word);
                return None;
            };
            if part.is_empty() && kind > 0 {
                continue;
            }
            let Some(index) = std::str::from_utf8(part).ok().and_then(|p| p.parse::<i64>().ok()) else {
                self.malformed_corner(word);
                return None;
            };
            let absolute = if index < 0 {
                (count as i64).checked_add(index).map_or(0, |i| i.max(-1) + 1)
            } else {
                index
            };
            if absolute >= 1 && absolute as u64 <= count {
                // The first texture coordinate and normal of the text are ours.
                *target = absolute as u64 + u64::from(kind > 0);
                continue;
            }
            let name = ["vertex", "texture coordinate", "normal"][kind];
            let zero = if index == 0 { "; indices count from 1" } else { "" };
            let message = format!("face `f` refers to {name} {index}, there are {count} so far{zero}");
            if kind == 0 {
                let hint = "a vertex must stand above the faces that use it; the file may be incomplete";
                self.push(Diagnostic::error("O0107", message).hint(hint));
                return None;
            }
            let message = format!("{message}; the corner is taken without one");
            self.push(Diagnostic::warning("O0108", message));
        }
        Some(corner)
    }

    fn malformed_corner(&mut self, word: &[u8]) {
        let message = format!(
            "face `f` has a malformed corner: found `{}`, expected v, v/vt, v//vn or v/vt/vn",
            text(word)
        );
        let hint = "indices are whole numbers, at most three to a corner";
        self.push(Diagnostic::error("O0109", message).hint(hint));
    }
}

/// Appends a number in decimal. A model has millions of them, and the standard formatting takes thrice the time.
fn push_number(out: &mut Vec<u8>, mut number: u64) {
    let start = out.len();
    loop {
        out.push(b'0' + (number % 10) as u8);
        number /= 10;
        if number == 0 {
            break;
        }
    }
    if let Some(digits) = out.get_mut(start..) {
        digits.reverse();
    }
}
