//! The typeface: how wide words run, and the outlines of letters. Noto Sans is compiled in, so that a chart looks the
//! same on a machine without fonts.

use std::sync::LazyLock;
use ttf_parser::Face;

/// Families for a reader of the SVG: the one measured here first, then others of about the same width.
pub const FAMILIES: &str = "'Noto Sans', 'Open Sans', Arial, 'Liberation Sans', Helvetica, sans-serif";

static FACES: LazyLock<[Option<Face<'static>>; 2]> =
    LazyLock::new(|| [ttf_noto_sans::REGULAR, ttf_noto_sans::BOLD].map(|data| Face::parse(data, 0).ok()));

/// The typeface, if the library can read it (a test sees to that).
pub fn face(bold: bool) -> Option<&'static Face<'static>> {
    FACES[usize::from(bold)].as_ref()
}

/// Width of a letter in ems; that of a wide one where the typeface lacks it.
fn advance(face: &Face, letter: char) -> f64 {
    let units = face.glyph_index(letter).and_then(|glyph| face.glyph_hor_advance(glyph));
    units.map_or(1.0, |units| f64::from(units) / f64::from(face.units_per_em()))
}

/// Width of words in CSS pixels.
pub fn width(words: &str, size: f64, bold: bool) -> f64 {
    let ems = |face| words.chars().map(|letter| advance(face, letter)).sum::<f64>();
    size * face(bold).map_or(0.6 * words.chars().count() as f64, ems)
}

/// The words in lines no wider than `width`, broken at blanks; a longer word stands alone.
pub fn wrap(words: &str, size: f64, bold: bool, limit: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size, bold) <= limit => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The words, cut with an ellipsis where they would run wider than `limit`.
pub fn cut(words: &str, size: f64, bold: bool, limit: f64) -> String {
    if width(words, size, bold) <= limit {
        return words.to_owned();
    }
    let mut left: Vec<char> = words.chars().collect();
    while left.pop().is_some() {
        let text = format!("{}…", left.iter().collect::<String>().trim_end());
        if width(&text, size, bold) <= limit {
            return text;
        }
    }
    String::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_typeface_has_every_sign_the_charts_use() {
        for bold in [false, true] {
            let face = face(bold).unwrap();
            let missing: String = "Aaz09 %µ×±≤≥√∝–—…²·:,()−→"
                .chars()
                .filter(|&c| face.glyph_index(c).is_none())
                .collect();
            assert_eq!(missing, "");
        }
    }

    #[test]
    fn words_run_as_wide_as_their_letters() {
        let [one, two] = ["n", "nn"].map(|words| width(words, 10.0, false));
        assert!(one > 4.0 && one < 8.0, "{one}");
        assert_eq!(two, 2.0 * one);
        assert!(width("nn", 10.0, true) > two);
    }

    #[test]
    fn wrapped_lines_fit_and_lose_no_word() {
        let words = "the quick brown fox jumps over the lazy dog";
        let lines = wrap(words, 12.0, false, 100.0);
        assert!(lines.len() > 2 && lines.iter().all(|l| width(l, 12.0, false) <= 100.0));
        assert_eq!(lines.join(" "), words);
        let short = cut(words, 12.0, false, 100.0);
        assert!(short.ends_with('…') && width(&short, 12.0, false) <= 100.0, "{short}");
        assert_eq!(cut("x", 12.0, false, 0.0), "");
    }
}
