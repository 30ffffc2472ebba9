//! Colours, dashes and markers: each tells variants apart alone, for the colour-blind and for grey print.

use super::shapes::{At, Rgb, Room, Shape, Stroke};

/// The base line, axes and words.
pub const BLACK: Rgb = [0; 3];
/// The base line where it stands behind others.
pub const BEHIND: Rgb = [150; 3];
/// Guides and frames.
pub const GUIDE: Rgb = [110; 3];
/// Lines of the grid.
pub const GRID: Rgb = [230; 3];
/// The Pareto front, a broad line behind everything.
pub const FRONT: Rgb = [212; 3];
/// The goal: Okabe and Ito's vermilion, darkened for words.
pub const GOAL: Rgb = [170, 60, 0];

/// Colours that people with any colour vision tell apart (M. Okabe and K. Ito, "Color Universal Design", 2008), in an
/// order in which neighbours differ in lightness too; their yellow is too pale for lines on white.
const COLORS: [Rgb; 6] = [
    [0, 114, 178],
    [230, 159, 0],
    [0, 158, 115],
    [213, 94, 0],
    [86, 180, 233],
    [204, 121, 167],
];

const DASHES: [&[f64]; 6] = [
    &[9.0, 3.5],
    &[2.2, 2.8],
    &[9.0, 3.0, 2.2, 3.0],
    &[5.0, 2.5],
    &[14.0, 3.5],
    &[9.0, 3.0, 2.2, 3.0, 2.2, 3.0],
];

/// Corners of a marker, on a circle of radius 1: how many, the turn, and every second one's radius.
const MARKERS: [(usize, f64, f64); 6] = [
    (4, 0.125, 1.0),  // square
    (3, 0.25, 1.0),   // triangle
    (4, 0.0, 1.0),    // diamond
    (3, 0.75, 1.0),   // triangle on its tip
    (10, 0.25, 0.42), // star
    (6, 0.0, 1.0),    // hexagon
];

/// How a variant looks.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    pub line: Stroke,
    /// `None` for the disc of the base line.
    marker: Option<usize>,
    hollow: bool,
}

impl Style {
    /// The base line; in grey where it stands behind.
    pub fn base(behind: bool) -> Self {
        let (color, width) = if behind { (BEHIND, 1.5) } else { (BLACK, 2.2) };
        Self {
            line: Stroke::solid(color, width),
            marker: None,
            hollow: false,
        }
    }

    /// The variant of an index within its panel; hollow markers for biased ones. Up to 36 differ.
    pub fn variant(index: usize, biased: bool) -> Self {
        let count = COLORS.len();
        Self {
            line: Stroke::dashed(COLORS[index % count], 2.0, DASHES[(index + index / count) % count]),
            marker: Some(index % count),
            hollow: biased,
        }
    }

    /// The marker at a place.
    pub fn marker(&self, [x, y]: At) -> Shape {
        let color = self.line.color;
        let fill = Some(if self.hollow { [255; 3] } else { color });
        let edge = Some(Stroke::solid(color, 1.4));
        let Some(&(corners, turn, inner)) = self.marker.and_then(|m| MARKERS.get(m)) else {
            return Shape::Disc([x, y], self.radius(), fill, edge);
        };
        let corner = |i: usize| {
            let radius = self.radius() * if i % 2 == 1 { inner } else { 1.0 };
            let (sin, cos) = ((turn + i as f64 / corners as f64) * std::f64::consts::TAU).sin_cos();
            [x + radius * cos, y - radius * sin]
        };
        Shape::Area((0..corners).map(corner).collect(), fill, edge)
    }

    /// Half the width of its marker.
    pub fn radius(&self) -> f64 {
        match (self.marker, self.line.color == BEHIND) {
            (None, true) => 2.2,
            (None, false) => 3.8,
            _ => 5.2,
        }
    }

    /// A piece of line with the marker, for a legend; as wide as `room`, at its middle.
    pub fn sample(&self, room: Room) -> Vec<Shape> {
        let middle = room.middle();
        let ends = [[room.min[0], middle[1]], [room.max[0], middle[1]]];
        vec![Shape::Line(ends.to_vec(), self.line.clone()), self.marker(middle)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_differ_by_dash_and_marker_not_by_colour_alone() {
        let styles: Vec<Style> = (0..36).map(|i| Style::variant(i, false)).collect();
        for (i, a) in styles.iter().enumerate() {
            for b in &styles[..i] {
                let dash = a.line.dash == b.line.dash;
                assert!(!(dash && a.marker == b.marker), "{a:?} {b:?}");
            }
        }
        // The six of one panel differ in each alone.
        for (i, a) in styles[..6].iter().enumerate() {
            for b in &styles[..i] {
                assert!(a.line.dash != b.line.dash && a.marker != b.marker && a.line.color != b.line.color);
            }
        }
    }

    /// Contrast of at least 2 with white (WCAG's luminance formula): visible as lines of 2 pixels.
    #[test]
    fn colours_stand_out_from_the_paper() {
        for color in COLORS {
            let linear = color.map(|c| crate::math::color::linear_from_srgb(f64::from(c) / 255.0));
            let luminance = 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
            assert!(1.05 / (luminance + 0.05) > 2.0, "{color:?}");
        }
    }
}
