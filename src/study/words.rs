//! Numbers as charts, tables and recommendations write them.

/// A number with so many significant digits, without an exponent from 10⁻⁶ to 10⁹ and without trailing zeros after
/// the point.
pub(crate) fn significant(x: f64, digits: i32) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !x.is_finite() {
        return "?".to_owned();
    }
    let magnitude = x.abs().log10().floor();
    if !(-6.0..9.0).contains(&magnitude) {
        return format!("{x:.*e}", (digits - 1).max(0) as usize);
    }
    let decimals = (digits - 1 - magnitude as i32).max(0) as usize;
    let text = format!("{x:.decimals$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// `2.34 %`: three digits.
pub(crate) fn percent(fraction: f64) -> String {
    match fraction.is_finite() {
        true => format!("{} %", significant(100.0 * fraction, 3)),
        false => "unknown".to_owned(),
    }
}

/// `2.3 %`: two digits, for what is only roughly known.
pub(crate) fn rough_percent(fraction: f64) -> String {
    match fraction.is_finite() {
        true => format!("{} %", significant(100.0 * fraction, 2)),
        false => "unknown".to_owned(),
    }
}

/// The same as [`duration`] with two digits.
pub(crate) fn rough_duration(seconds: f64) -> String {
    with_digits(seconds, 2)
}

/// `85 µs`, `120 ms`, `1.5 s`, `2.5 min`, `3.2 h`: three digits.
pub(crate) fn duration(seconds: f64) -> String {
    with_digits(seconds, 3)
}

fn with_digits(seconds: f64, digits: i32) -> String {
    if !seconds.is_finite() {
        return "unknown".to_owned();
    }
    let (size, unit) = match seconds.abs() {
        s if s == 0.0 || (0.9995..99.95).contains(&s) => (1.0, "s"),
        s if s < 0.9995e-3 => (1e-6, "µs"),
        s if s < 0.9995 => (1e-3, "ms"),
        s if s < 5997.0 => (60.0, "min"),
        _ => (3600.0, "h"),
    };
    format!("{} {unit}", significant(seconds / size, digits))
}

/// `1.3–1.9 %`, `120–140 s`: two values in the unit of the greater; one if both read the same.
pub(crate) fn range(low: f64, high: f64, show: fn(f64) -> String) -> String {
    let [low, high] = [show(low), show(high)];
    let unit = |text: &str| text.split_once(' ').map(|(_, unit)| unit.to_owned());
    match (unit(&low), unit(&high)) {
        _ if low == high => low,
        (Some(a), Some(b)) if a == b => {
            let number = low.split(' ').next().unwrap_or_default().to_owned();
            format!("{number}–{high}")
        }
        _ => format!("{low} – {high}"),
    }
}

/// A word as a POSIX shell takes it.
pub(crate) fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,@%+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_digits() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (12.345, "12.3"),
            (1234.6, "1235"),
            (0.001234, "0.00123"),
            (1e-9, "1.00e-9"),
            (f64::NAN, "?"),
        ] {
            assert_eq!(significant(x, 3), text);
        }
    }

    #[test]
    fn durations_change_unit_where_a_reader_would() {
        for (seconds, text) in [
            (0.00005, "50 µs"),
            (0.12, "120 ms"),
            (0.99999, "1 s"),
            (75.0, "75 s"),
            (150.0, "2.5 min"),
            (9000.0, "2.5 h"),
            (f64::INFINITY, "unknown"),
        ] {
            assert_eq!(duration(seconds), text);
        }
        assert_eq!(rough_duration(13.47), "13 s");
        assert_eq!(rough_percent(0.0234), "2.3 %");
    }

    #[test]
    fn a_range_names_its_unit_once() {
        assert_eq!(range(0.012, 0.019, percent), "1.2–1.9 %");
        assert_eq!(range(40.0, 150.0, duration), "40 s – 2.5 min");
        assert_eq!(range(2.0, 2.0, duration), "2 s");
    }
}
