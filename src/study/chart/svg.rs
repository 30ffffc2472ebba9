//! A page as SVG 1.1: text stays text.

use super::font::FAMILIES;
use super::shapes::{Anchor, At, Page, Rgb, Shape, Stroke, Text};
use std::fmt::Write;

/// The document.
pub fn write(page: &Page) -> String {
    let [width, height] = page.size.map(number);
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"title description\" \
         font-family=\"{FAMILIES}\" stroke-linejoin=\"round\">\n\
         <title id=\"title\">{}</title>\n<desc id=\"description\">{}</desc>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n",
        escape(&page.title),
        escape(&page.description),
    );
    page.shapes.iter().for_each(|shape| write_shape(&mut out, shape));
    out.push_str("</svg>\n");
    out
}

fn write_shape(out: &mut String, shape: &Shape) {
    // Writing into a string cannot fail.
    let _ = match shape {
        Shape::Line(points, stroke) => {
            writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\"{}/>",
                path(points),
                edge(Some(stroke))
            )
        }
        Shape::Area(points, fill, stroke) => {
            let (fill, edge) = (paint(*fill), edge(stroke.as_ref()));
            writeln!(out, "<polygon points=\"{}\" fill=\"{fill}\"{edge}/>", path(points))
        }
        Shape::Disc([x, y], radius, fill, stroke) => {
            let (x, y, radius) = (number(*x), number(*y), number(*radius));
            let (fill, edge) = (paint(*fill), edge(stroke.as_ref()));
            writeln!(
                out,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{fill}\"{edge}/>"
            )
        }
        Shape::Words(text) => writeln!(out, "{}", words(text)),
        Shape::Group(label, shapes) => {
            let _ = writeln!(out, "<g>\n<title>{}</title>", escape(label));
            shapes.iter().for_each(|shape| write_shape(out, shape));
            writeln!(out, "</g>")
        }
    };
}

fn words(text: &Text) -> String {
    let [x, y] = text.at.map(number);
    let mut more = String::new();
    match text.anchor {
        Anchor::Start => {}
        Anchor::Middle => more += " text-anchor=\"middle\"",
        Anchor::End => more += " text-anchor=\"end\"",
    }
    if text.bold {
        more += " font-weight=\"bold\"";
    }
    if text.upward {
        more += &format!(" transform=\"rotate(-90 {x} {y})\"");
    }
    let (size, fill, words) = (number(text.size), color(text.color), escape(&text.words));
    format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{fill}\"{more}>{words}</text>")
}

fn path(points: &[At]) -> String {
    let pairs = points.iter().map(|[x, y]| format!("{},{}", number(*x), number(*y)));
    pairs.collect::<Vec<_>>().join(" ")
}

fn edge(stroke: Option<&Stroke>) -> String {
    let Some(stroke) = stroke else { return String::new() };
    let mut text = format!(
        " stroke=\"{}\" stroke-width=\"{}\"",
        color(stroke.color),
        number(stroke.width)
    );
    if !stroke.dash.is_empty() {
        let dash: Vec<String> = stroke.dash.iter().map(|d| number(*d)).collect();
        text += &format!(" stroke-dasharray=\"{}\"", dash.join(" "));
    }
    text
}

fn paint(fill: Option<Rgb>) -> String {
    fill.map_or("none".to_owned(), color)
}

fn color([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Hundredths of a CSS pixel are finer than print; 0 for what is not finite.
fn number(x: f64) -> String {
    if !x.is_finite() {
        return "0".to_owned();
    }
    let text = format!("{x:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" {
        "0".to_owned()
    } else {
        short.to_owned()
    }
}

/// Text for XML 1.0: marks escaped, characters that XML forbids replaced.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\0'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_marks_and_control_characters_stay_well_formed() {
        let name = "a<b>&\"c'\u{0}\u{1b}\u{ffff}\n.pts";
        let page = Page {
            size: [100.0, 50.0],
            title: name.to_owned(),
            description: name.to_owned(),
            shapes: vec![Shape::Group(
                name.to_owned(),
                vec![Shape::Words(Text::new(name, [1.0, f64::NAN], 12.0))],
            )],
        };
        let text = write(&page);
        let parsed = roxmltree::Document::parse(&text).unwrap();
        let words = parsed.descendants().find(|n| n.has_tag_name("text")).unwrap();
        assert_eq!(words.text(), Some("a<b>&\"c'\u{fffd}\u{fffd}\u{fffd} .pts"));
        assert_eq!(words.attribute("y"), Some("0"));
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!(
            [1.0, 0.5, -0.001, 12.346, f64::INFINITY].map(number),
            ["1", "0.5", "0", "12.35", "0"]
        );
    }
}
