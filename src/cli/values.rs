//! The values of flags: each parser turns one word of the command line into a checked number or says what it expected.

use crate::compile::effects::Effect;
use crate::render::technique::Choice;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use std::str::FromStr;

/// Most samples per pixel that can be asked for.
pub const MAX_SPP: u32 = 1 << 31;

/// Most pixels along one side.
const MAX_SIDE: u32 = 65_536;

/// `WIDTHxHEIGHT` in pixels, both from 1 to 65 536.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Resolution {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl FromStr for Resolution {
    type Err = String;

    fn from_str(text: &str) -> Result<Resolution, String> {
        let (width, height) = text
            .split_once(['x', 'X', '×'])
            .ok_or("expected WIDTHxHEIGHT, for example 800x600")?;
        Ok(Resolution {
            width: side(width)?,
            height: side(height)?,
        })
    }
}

/// A number of pixels along one side, from 1 to 65 536.
pub fn side(text: &str) -> Result<u32, String> {
    match text.trim().parse::<u32>() {
        Ok(n) if (1..=MAX_SIDE).contains(&n) => Ok(n),
        _ => Err(format!(
            "`{text}` is not a number of pixels from 1 to {MAX_SIDE} (a resolution is written 800x600)"
        )),
    }
}

/// Seconds, > 0, from `90s`, `10m`, `1h`, `1h30m`, `500ms` or a bare number of seconds.
pub fn duration(text: &str) -> Result<f64, String> {
    let wrong = || format!("`{text}` is not a duration; write 90s, 10m, 1h or 1h30m");
    let mut rest = text.trim();
    if let Ok(seconds) = rest.parse::<f64>() {
        return positive(seconds).ok_or_else(wrong);
    }
    let mut total = 0.0;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !c.is_ascii_digit() && c != '.').ok_or_else(wrong)?;
        let (number, after) = rest.split_at(digits);
        let letters = after.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(after.len());
        let (unit, after) = after.split_at(letters);
        let unit = match unit {
            "ms" => 1e-3,
            "s" | "sec" => 1.0,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            _ => return Err(wrong()),
        };
        total += number.parse::<f64>().map_err(|_| wrong())? * unit;
        rest = after.trim_start();
    }
    positive(total).ok_or_else(wrong)
}

/// An error goal as a fraction in (0, 1), from `2%` or `0.02`. A bare number from 1 on is refused: it may be meant in percent.
pub fn error_goal(text: &str) -> Result<f64, String> {
    let value = percent_or_fraction(text)?;
    if value > 0.0 && value < 1.0 {
        return Ok(value);
    }
    Err(format!(
        "`{text}` is not an error goal between 0 and 100 %; write 2% or 0.02"
    ))
}

/// A share ≥ 0 that may be a threshold, from `2%` or `0.02`. A bare number above 1 is refused: it may be meant in percent.
pub fn share(text: &str) -> Result<f64, String> {
    let value = percent_or_fraction(text)?;
    if value >= 0.0 && value.is_finite() && (value <= 1.0 || text.trim().ends_with('%')) {
        return Ok(value);
    }
    Err(format!("`{text}` is not a share of at least 0 %; write 2% or 0.02"))
}

/// A confidence in (0, 1), from `90`, `90%` or `0.9`.
pub fn confidence(text: &str) -> Result<f64, String> {
    let mut value = percent_or_fraction(text)?;
    if value > 1.0 {
        value /= 100.0;
    }
    if value > 0.0 && value < 1.0 {
        return Ok(value);
    }
    Err(format!(
        "`{text}` is not a confidence between 0 and 100 %; write 90 or 0.9"
    ))
}

fn percent_or_fraction(text: &str) -> Result<f64, String> {
    let (number, scale) = match text.trim().strip_suffix('%') {
        Some(number) => (number.trim_end(), 0.01),
        None => (text.trim(), 1.0),
    };
    let value: f64 = number
        .parse()
        .map_err(|_| format!("`{text}` is not a number or a percentage"))?;
    Ok(value * scale)
}

/// Linear red, green and blue, finite and ≥ 0, from `R,G,B` or one number for grey.
pub fn color(text: &str) -> Result<[f64; 3], String> {
    let wrong = || format!("`{text}` is not a colour; write R,G,B, three numbers of at least 0");
    let parts = text.split(',').map(|part| part.trim().parse::<f64>());
    let parts: Vec<f64> = parts.collect::<Result<_, _>>().map_err(|_| wrong())?;
    if !parts.iter().all(|c| c.is_finite() && *c >= 0.0) {
        return Err(wrong());
    }
    match parts[..] {
        [grey] => Ok([grey; 3]),
        [r, g, b] => Ok([r, g, b]),
        _ => Err(wrong()),
    }
}

/// A factor, finite and ≥ 0.
pub fn factor(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|f| f.is_finite() && *f >= 0.0);
    value.ok_or_else(|| format!("`{text}` is not a finite number of at least 0"))
}

/// A number, finite and > 0.
pub fn above_zero(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|f| f.is_finite() && *f > 0.0);
    value.ok_or_else(|| format!("`{text}` is not a finite number above 0"))
}

/// A limit, finite and > 0.
pub fn limit(text: &str) -> Result<f32, String> {
    let value = text.trim().parse::<f32>().ok().filter(|f| f.is_finite() && *f > 0.0);
    value.ok_or_else(|| format!("`{text}` is not a finite number above 0"))
}

/// One of the words of a technique.
pub fn choice<T: Choice>() -> impl TypedValueParser<Value = T> {
    let words = T::ALL
        .iter()
        .map(|(_, word, about)| PossibleValue::new(*word).help(*about));
    PossibleValuesParser::new(words).try_map(|word| T::from_word(&word).ok_or("unknown word"))
}

/// What `--force-effects` names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Forced {
    /// Every effect.
    All,
    /// One of them.
    One(Effect),
}

/// An effect by its name, or `all`.
pub fn forced() -> impl TypedValueParser<Value = Forced> {
    let words = Effect::ALL.map(|e| PossibleValue::new(e.word()));
    let words = words
        .into_iter()
        .chain([PossibleValue::new("all").help("every effect")]);
    PossibleValuesParser::new(words).try_map(|word| match word.as_str() {
        "all" => Ok(Forced::All),
        _ => Effect::from_word(&word).map(Forced::One).ok_or("unknown effect"),
    })
}

/// An effect by its name.
pub fn effect() -> impl TypedValueParser<Value = Effect> {
    let words = Effect::ALL.map(|e| PossibleValue::new(e.word()).help(e.without()));
    PossibleValuesParser::new(words).try_map(|word| Effect::from_word(&word).ok_or("unknown effect"))
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>().ok().filter(|f| f.is_finite());
    value.ok_or_else(|| format!("`{text}` is not a finite number"))
}

/// `name=value`: the name as an identifier of the scene language, the value as it would be written there.
pub fn define(text: &str) -> Result<(String, String), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| format!("`{text}` is not name=value; write for example -D radius=2"))?;
    let (name, value) = (name.trim(), value.trim());
    let mut letters = name.chars();
    let starts_well = letters.next().is_some_and(|c| c.is_ascii_alphabetic() || c == '_');
    if !starts_well || !letters.all(|c| c.is_ascii_alphanumeric() || c == '_') {
        return Err(format!(
            "`{name}` is not an identifier (letters, digits and _, no digit first)"
        ));
    }
    if value.is_empty() {
        return Err(format!("`{name}` is given no value; write {name}=1"));
    }
    Ok((name.to_owned(), value.to_owned()))
}

fn positive(seconds: f64) -> Option<f64> {
    (seconds > 0.0 && seconds.is_finite()).then_some(seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resolution_is_two_positive_numbers() {
        let resolution = |w, h| Ok(Resolution { width: w, height: h });
        assert_eq!("800x600".parse::<Resolution>(), resolution(800, 600));
        assert_eq!("1X65536".parse::<Resolution>(), resolution(1, 65_536));
        for wrong in ["800", "0x600", "800x", "800x-1", "65537x1", "8e2x600", ""] {
            assert!(wrong.parse::<Resolution>().is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn durations_have_units_or_are_seconds() {
        for (text, seconds) in [
            ("90s", 90.0),
            ("90", 90.0),
            ("10m", 600.0),
            ("1h", 3600.0),
            ("1h30m", 5400.0),
            ("1.5h", 5400.0),
            ("500ms", 0.5),
        ] {
            assert_eq!(duration(text), Ok(seconds), "{text}");
        }
        for wrong in ["", "0", "-1s", "1d", "s", "1h 30", "inf", "nan", "1.2.3s"] {
            assert!(duration(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn an_error_goal_from_one_on_needs_its_percent_sign() {
        assert_eq!(error_goal("2%"), Ok(0.02));
        assert_eq!(error_goal("0.02"), Ok(0.02));
        for wrong in ["2", "0", "-1%", "100%", "x", "nan"] {
            assert!(error_goal(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn a_share_above_one_needs_its_percent_sign() {
        for (text, value) in [("2%", 0.02), ("0.02", 0.02), ("0", 0.0), ("1", 1.0), ("150%", 1.5)] {
            assert_eq!(share(text), Ok(value), "{text}");
        }
        for wrong in ["2", "-1%", "x", "nan", "inf", "inf%", "%"] {
            assert!(share(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn a_confidence_is_a_percentage_or_a_fraction() {
        for text in ["90", "90%", "0.9"] {
            assert_eq!(confidence(text), Ok(0.9), "{text}");
        }
        for wrong in ["0", "1", "100", "-5", "x"] {
            assert!(confidence(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn a_colour_is_three_numbers_or_a_grey() {
        assert_eq!(color("1, 0.5,0"), Ok([1.0, 0.5, 0.0]));
        assert_eq!(color("2"), Ok([2.0; 3]));
        for wrong in ["", "1,2", "1,2,3,4", "1,-1,0", "1,inf,0", "red"] {
            assert!(color(wrong).is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn a_definition_needs_an_identifier_and_a_value() {
        assert_eq!(define("r=2"), Ok(("r".into(), "2".into())));
        assert_eq!(define("name = \"a=b\""), Ok(("name".into(), "\"a=b\"".into())));
        for wrong in ["r", "=2", "2r=1", "a b=1", "r="] {
            assert!(define(wrong).is_err(), "{wrong} was accepted");
        }
    }
}
