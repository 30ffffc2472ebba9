//! What a chart is made of: lines, areas and words on a page, before they become SVG or pixels.

use super::font;

/// A place on the page, in CSS pixels (1/96 inch) from the top left.
pub type At = [f64; 2];

/// A colour, sRGB.
pub type Rgb = [u8; 3];

/// How a line is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    pub color: Rgb,
    pub width: f64,
    /// Lengths of dashes and gaps, in turn; empty for a solid line.
    pub dash: Vec<f64>,
}

impl Stroke {
    pub fn solid(color: Rgb, width: f64) -> Self {
        Self {
            color,
            width,
            dash: Vec::new(),
        }
    }

    pub fn dashed(color: Rgb, width: f64, dash: &[f64]) -> Self {
        Self {
            color,
            width,
            dash: dash.to_vec(),
        }
    }
}

/// Where a text's place is in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of words.
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    pub words: String,
    /// The anchor on the base line.
    pub at: At,
    pub anchor: Anchor,
    /// Height of an em.
    pub size: f64,
    pub bold: bool,
    pub color: Rgb,
    /// Runs upward instead of to the right.
    pub upward: bool,
}

impl Text {
    pub fn new(words: impl Into<String>, at: At, size: f64) -> Self {
        Self {
            words: words.into(),
            at,
            anchor: Anchor::Start,
            size,
            bold: false,
            color: [0; 3],
            upward: false,
        }
    }

    pub fn anchored(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub fn colored(self, color: Rgb) -> Self {
        Self { color, ..self }
    }

    /// The room it takes.
    pub fn room(&self) -> Room {
        let width = font::width(&self.words, self.size, self.bold);
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let (up, down) = (0.78 * self.size, 0.24 * self.size);
        let [x, y] = self.at;
        match self.upward {
            false => Room::new([x - before, y - up], [x - before + width, y + down]),
            true => Room::new([x - up, y + before - width], [x + down, y + before]),
        }
    }
}

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    pub min: At,
    pub max: At,
}

impl Room {
    pub fn new(min: At, max: At) -> Self {
        Self { min, max }
    }

    pub fn around(at: At, radius: f64) -> Self {
        Self::new(at.map(|v| v - radius), at.map(|v| v + radius))
    }

    pub fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    pub fn middle(&self) -> At {
        [0, 1].map(|k| 0.5 * (self.min[k] + self.max[k]))
    }

    pub fn meets(&self, other: &Self) -> bool {
        (0..2).all(|k| self.min[k] < other.max[k] && other.min[k] < self.max[k])
    }

    pub fn holds(&self, other: &Self) -> bool {
        (0..2).all(|k| self.min[k] <= other.min[k] && other.max[k] <= self.max[k])
    }

    /// Whether a piece of the segment lies inside (slab test).
    pub fn meets_segment(&self, a: At, b: At) -> bool {
        let (mut near, mut far) = (0.0f64, 1.0f64);
        for k in 0..2 {
            let d = b[k] - a[k];
            if d == 0.0 {
                if a[k] <= self.min[k] || a[k] >= self.max[k] {
                    return false;
                }
                continue;
            }
            let (s, t) = ((self.min[k] - a[k]) / d, (self.max[k] - a[k]) / d);
            near = near.max(s.min(t));
            far = far.min(s.max(t));
        }
        near < far
    }
}

/// A piece of the drawing.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A line through points.
    Line(Vec<At>, Stroke),
    /// An area with a margin of its own: points, fill, edge.
    Area(Vec<At>, Option<Rgb>, Option<Stroke>),
    /// A disc: centre, radius, fill, edge.
    Disc(At, f64, Option<Rgb>, Option<Stroke>),
    /// Words.
    Words(Text),
    /// Shapes that belong together, and what they show, for readers that point at them or cannot see them.
    Group(String, Vec<Shape>),
}

impl Shape {
    pub fn segment(a: At, b: At, stroke: Stroke) -> Self {
        Self::Line(vec![a, b], stroke)
    }

    pub fn rectangle(room: Room, fill: Option<Rgb>, edge: Option<Stroke>) -> Self {
        let ([x0, y0], [x1, y1]) = (room.min, room.max);
        Self::Area(vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]], fill, edge)
    }
}

/// A finished page.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Columns and rows, CSS pixels.
    pub size: [f64; 2],
    /// What it is, in a few words.
    pub title: String,
    /// What it shows, for those who cannot see it.
    pub description: String,
    /// Its parts, from back to front.
    pub shapes: Vec<Shape>,
}
