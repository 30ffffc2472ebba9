//! Numbers as people read them: shares, durations, counts; and words as a shell takes them.

/// A number of bytes: `512 bytes`, `5.1 kB`, `12.4 MB`; thousands, not 1024s.
pub fn bytes(n: u64) -> String {
    match n {
        0..1000 => format!("{n} bytes"),
        1000..1_000_000 => format!("{} kB", significant(n as f64 / 1e3, 3)),
        1_000_000..1_000_000_000 => format!("{} MB", significant(n as f64 / 1e6, 3)),
        _ => format!("{} GB", significant(n as f64 / 1e9, 3)),
    }
}

/// A number with so many significant digits, without an exponent from 10⁻⁶ to 10⁹ and without trailing zeros after
/// the point.
pub fn significant(x: f64, digits: i32) -> String {
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
pub fn percent(fraction: f64) -> String {
    match fraction.is_finite() {
        true => format!("{} %", significant(100.0 * fraction, 3)),
        false => "unknown".to_owned(),
    }
}

/// The nearest number with so many digits, 1 to 17: 1234 has two of them as 1200.
fn rounded(x: f64, digits: i32) -> f64 {
    let decimals = (digits - 1).max(0) as usize;
    format!("{x:.decimals$e}").parse().unwrap_or(x)
}

/// `2.3 %`, `1200 %`: two digits, for what is only roughly known.
pub fn rough_percent(fraction: f64) -> String {
    match fraction.is_finite() {
        true => format!("{} %", significant(rounded(100.0 * fraction, 2), 2)),
        false => "unknown".to_owned(),
    }
}

/// The same as [`duration`] with two digits.
pub fn rough_duration(seconds: f64) -> String {
    with_digits(seconds, 2)
}

/// `312 ns`, `85 µs`, `120 ms`, `1.5 s`, `2.5 min`, `3.2 h`, `4.5 days`: three digits.
pub fn duration(seconds: f64) -> String {
    with_digits(seconds, 3)
}

fn with_digits(seconds: f64, digits: i32) -> String {
    if !seconds.is_finite() {
        return "unknown".to_owned();
    }
    let (size, unit) = match seconds.abs() {
        s if s == 0.0 || (0.9995..99.95).contains(&s) => (1.0, "s"),
        s if s < 0.9995e-6 => (1e-9, "ns"),
        s if s < 0.9995e-3 => (1e-6, "µs"),
        s if s < 0.9995 => (1e-3, "ms"),
        s if s < 5997.0 => (60.0, "min"),
        s if s < 172_800.0 => (3600.0, "h"),
        _ => (86_400.0, "days"),
    };
    format!("{} {unit}", significant(rounded(seconds / size, digits), digits))
}

/// As a clock that runs shows it: `0.4 s`, `12 s`, `3:05 min`, `1:02:03 h`.
pub fn clock(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "?".to_owned();
    }
    if seconds < 9.95 {
        return format!("{:.1} s", seconds.max(0.0));
    }
    let whole = seconds.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    match (hours, minutes) {
        (0, 0) => format!("{rest} s"),
        (0, _) => format!("{minutes}:{rest:02} min"),
        _ => format!("{hours}:{minutes:02}:{rest:02} h"),
    }
}

/// `950`, `12.3 k`, `4.56 M`, `7.89 G`: three digits.
pub fn count(n: f64) -> String {
    let (scaled, unit) = [(1e9, " G"), (1e6, " M"), (1e3, " k")]
        .into_iter()
        .find(|(size, _)| n >= *size)
        .map_or((n, ""), |(size, unit)| (n / size, unit));
    match scaled {
        _ if unit.is_empty() => format!("{scaled:.0}"),
        s if s >= 100.0 => format!("{s:.0}{unit}"),
        s if s >= 10.0 => format!("{s:.1}{unit}"),
        s => format!("{s:.2}{unit}"),
    }
}

/// `1 234 567`: all digits, in groups of three.
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() * 2);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// `1.3–1.9 %`, `120–140 s`: two values in the unit of the greater; one if both read the same.
pub fn range(low: f64, high: f64, show: fn(f64) -> String) -> String {
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
pub fn shell_word(word: &str) -> String {
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
            (3.12e-7, "312 ns"),
            (0.00005, "50 µs"),
            (0.12, "120 ms"),
            (0.99999, "1 s"),
            (75.0, "75 s"),
            (150.0, "2.5 min"),
            (9000.0, "2.5 h"),
            (400_000.0, "4.63 days"),
            (f64::INFINITY, "unknown"),
        ] {
            assert_eq!(duration(seconds), text);
        }
        assert_eq!(rough_duration(13.47), "13 s");
        assert_eq!(rough_duration(0.604), "600 ms");
        assert_eq!(rough_percent(0.0234), "2.3 %");
        assert_eq!(rough_percent(11.55), "1200 %");
    }

    #[test]
    fn a_range_names_its_unit_once() {
        assert_eq!(range(0.012, 0.019, percent), "1.2–1.9 %");
        assert_eq!(range(40.0, 150.0, duration), "40 s – 2.5 min");
        assert_eq!(range(2.0, 2.0, duration), "2 s");
    }

    #[test]
    fn clocks_carry_into_the_next_unit() {
        for (seconds, text) in [
            (0.04, "0.0 s"),
            (9.94, "9.9 s"),
            (9.96, "10 s"),
            (59.6, "1:00 min"),
            (3599.9, "1:00:00 h"),
            (3723.0, "1:02:03 h"),
            (f64::NAN, "?"),
        ] {
            assert_eq!(clock(seconds), text);
        }
    }

    #[test]
    fn counts_have_three_digits() {
        for (n, text) in [(7.0, "7"), (1500.0, "1.50 k"), (12.34e6, "12.3 M"), (456e9, "456 G")] {
            assert_eq!(count(n), text);
        }
    }

    #[test]
    fn words_with_blanks_or_quotes_are_quoted() {
        assert_eq!(shell_word("a/b-1.pts"), "a/b-1.pts");
        assert_eq!(shell_word("a b"), "'a b'");
        assert_eq!(shell_word("it's"), r"'it'\''s'");
        assert_eq!(shell_word(""), "''");
    }
}
