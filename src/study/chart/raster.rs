//! A page as PNG, through tiny-skia; letters are drawn from the typeface that is compiled in.

use super::font;
use super::shapes::{Anchor, At, Page, Rgb, Shape, Stroke, Text};
use tiny_skia::{FillRule, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform};

/// Pixels per CSS pixel: 16 cm of 680 CSS pixels at about 324 dpi.
const SCALE: f32 = 3.0;

/// Why there is no PNG.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The page is empty, or too large for memory.
    #[error("a page of {0} x {1} pixels cannot be drawn")]
    Size(f64, f64),
    /// The encoder failed.
    #[error("the chart cannot be encoded as PNG: {0}")]
    Encode(String),
}

/// The file.
pub fn write(page: &Page) -> Result<Vec<u8>, PngError> {
    let [width, height] = page.size.map(|v| (v as f32 * SCALE).ceil() as u32);
    let mut canvas = Pixmap::new(width, height).ok_or(PngError::Size(page.size[0], page.size[1]))?;
    canvas.fill(tiny_skia::Color::WHITE);
    page.shapes.iter().for_each(|shape| draw(&mut canvas, shape));
    canvas.encode_png().map_err(|e| PngError::Encode(e.to_string()))
}

fn draw(canvas: &mut Pixmap, shape: &Shape) {
    match shape {
        Shape::Line(points, edge) => stroke(canvas, polyline(points, false), edge),
        Shape::Area(points, color, edge) => area(canvas, polyline(points, true), *color, edge.as_ref()),
        Shape::Disc([x, y], radius, color, edge) => {
            let disc = PathBuilder::from_circle(*x as f32, *y as f32, *radius as f32);
            area(canvas, disc, *color, edge.as_ref());
        }
        Shape::Words(text) => words(canvas, text),
        Shape::Group(_, shapes) => shapes.iter().for_each(|shape| draw(canvas, shape)),
    }
}

fn polyline(points: &[At], closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    let mut finite = points.iter().filter(|p| p.iter().all(|v| v.is_finite()));
    let [x, y] = finite.next()?.map(|v| v as f32);
    path.move_to(x, y);
    finite.for_each(|[x, y]| path.line_to(*x as f32, *y as f32));
    if closed {
        path.close();
    }
    path.finish()
}

fn paint([r, g, b]: Rgb) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, 255);
    paint
}

fn area(canvas: &mut Pixmap, path: Option<Path>, color: Option<Rgb>, edge: Option<&Stroke>) {
    if let (Some(path), Some(color)) = (&path, color) {
        let to_pixels = Transform::from_scale(SCALE, SCALE);
        canvas.fill_path(path, &paint(color), FillRule::Winding, to_pixels, None);
    }
    if let Some(edge) = edge {
        stroke(canvas, path, edge);
    }
}

fn stroke(canvas: &mut Pixmap, path: Option<Path>, edge: &Stroke) {
    let Some(path) = path else { return };
    let style = tiny_skia::Stroke {
        width: edge.width as f32,
        line_join: tiny_skia::LineJoin::Round,
        dash: StrokeDash::new(edge.dash.iter().map(|d| *d as f32).collect(), 0.0),
        ..tiny_skia::Stroke::default()
    };
    let to_pixels = Transform::from_scale(SCALE, SCALE);
    canvas.stroke_path(&path, &paint(edge.color), &style, to_pixels, None);
}

/// Letters in the typeface's units, y up, one after another.
struct Outline {
    path: PathBuilder,
    pen: f32,
}

impl ttf_parser::OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.pen + x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.pen + x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.pen + x1, y1, self.pen + x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path
            .cubic_to(self.pen + x1, y1, self.pen + x2, y2, self.pen + x, y);
    }
    fn close(&mut self) {
        self.path.close();
    }
}

fn words(canvas: &mut Pixmap, text: &Text) {
    let Some(face) = font::face(text.bold) else { return };
    if !text.at.iter().all(|v| v.is_finite()) {
        return;
    }
    let mut outline = Outline {
        path: PathBuilder::new(),
        pen: 0.0,
    };
    for letter in text.words.chars() {
        // Glyph 0 is the box that stands for letters the typeface lacks.
        let glyph = face.glyph_index(letter).unwrap_or(ttf_parser::GlyphId(0));
        face.outline_glyph(glyph, &mut outline);
        outline.pen += match face.glyph_index(letter) {
            Some(glyph) => f32::from(face.glyph_hor_advance(glyph).unwrap_or(0)),
            None => f32::from(face.units_per_em()),
        };
    }
    let Some(path) = outline.path.finish() else { return };
    let before = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5 * outline.pen,
        Anchor::End => outline.pen,
    };
    let scale = text.size as f32 / f32::from(face.units_per_em());
    let [x, y] = text.at.map(|v| v as f32);
    let placed = Transform::from_translate(-before, 0.0)
        .post_scale(scale, -scale)
        .post_rotate(if text.upward { -90.0 } else { 0.0 })
        .post_translate(x, y)
        .post_scale(SCALE, SCALE);
    canvas.fill_path(&path, &paint(text.color), FillRule::Winding, placed, None);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ink(page: &Page) -> usize {
        let png = write(page).unwrap();
        let pixels = Pixmap::decode_png(&png).unwrap();
        pixels.pixels().iter().filter(|p| p.red() < 128).count()
    }

    fn page(shapes: Vec<Shape>) -> Page {
        Page {
            size: [60.0, 60.0],
            title: String::new(),
            description: String::new(),
            shapes,
        }
    }

    /// An area of 20 × 10 CSS pixels is 9 times as many pixels; a line of width 2 and length 20 has 40.
    #[test]
    fn areas_and_lines_cover_their_pixels() {
        let room = super::super::shapes::Room::new([10.0, 10.0], [30.0, 20.0]);
        assert_eq!(ink(&page(vec![Shape::rectangle(room, Some([0; 3]), None)])), 1800);
        let line = Shape::segment([10.0, 30.0], [30.0, 30.0], Stroke::solid([0; 3], 2.0));
        assert_eq!(ink(&page(vec![line])), 360);
        assert_eq!(ink(&page(vec![])), 0);
    }

    #[test]
    fn words_fill_the_room_that_is_measured_for_them() {
        for upward in [false, true] {
            let text = Text {
                upward,
                ..Text::new("Hxg", [30.0, 40.0], 16.0).anchored(Anchor::Middle)
            };
            let room = text.room();
            let pixels = Pixmap::decode_png(&write(&page(vec![Shape::Words(text)])).unwrap()).unwrap();
            let side = pixels.width() as usize;
            let dark = (0..side * side).filter(|i| pixels.pixels()[*i].red() < 128);
            let places: Vec<At> = dark.map(|i| [i % side, i / side].map(|v| v as f64 / 3.0)).collect();
            assert!(places.len() > 200, "{}", places.len());
            assert!(
                places
                    .iter()
                    .all(|p| room.holds(&super::super::shapes::Room::around(*p, 0.0)))
            );
        }
    }

    #[test]
    fn an_empty_page_is_refused() {
        let nothing = Page {
            size: [0.0, 10.0],
            ..page(vec![])
        };
        assert!(matches!(write(&nothing), Err(PngError::Size(..))));
        let dots = page(vec![
            Shape::Line(vec![[f64::NAN; 2]], Stroke::solid([0; 3], 1.0)),
            Shape::Line(vec![], Stroke::dashed([0; 3], 1.0, &[0.0])),
        ]);
        assert_eq!(ink(&dots), 0);
    }
}
